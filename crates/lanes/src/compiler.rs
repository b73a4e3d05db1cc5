//! Compilers of HLSL and Slang: the programs `slangc` and `glslangValidator`, as child processes with pipes and without
//! files. What a compiler makes of a text is its reading of it: lanes that run the module share that reading.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use thiserror::Error;

use crate::worker::tool;

/// Longest time for a text, which takes a second where nothing is wrong.
const LIMIT: Duration = Duration::from_secs(60);

/// Bytes of the name of what was read, which glslang prints.
const LONGEST_NAME: usize = 8;

/// Characters of its words that are shown where it neither compiles nor says why.
const LONGEST: usize = 160;

/// Which compiler it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `slangc`, of HLSL and Slang.
    Slang,
    /// `glslangValidator` or `glslang`, of HLSL.
    Glslang,
}

/// A compiler.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Compiler {
    /// Which one it is.
    pub kind: Kind,
    /// The program.
    pub program: PathBuf,
}

/// Stage of an entry point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointStage {
    /// A vertex stage.
    Vertex,
    /// A fragment stage.
    Fragment,
    /// A compute stage.
    Compute,
}

/// A text and what is made of it.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The text.
    pub text: &'a str,
    /// True for Slang, false for HLSL.
    pub slang: bool,
    /// Entry points with their stages.
    pub points: &'a [(String, PointStage)],
    /// Values of macros.
    pub defines: &'a [(String, String)],
    /// Folders in which other files are looked for.
    pub folders: &'a [PathBuf],
}

/// What a compiler says about a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// The file; none for the text itself.
    pub file: Option<String>,
    /// Line, from 1; 0 where it names none.
    pub line: usize,
    /// Column, from 1; 0 where it names none.
    pub column: usize,
    /// What is wrong.
    pub text: String,
}

/// Why there is no module.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum CompileError {
    /// The text is wrong.
    #[error("{}", .0.first().map_or("", |message| message.text.as_str()))]
    Refused(Vec<Message>),
    /// The compiler is not there, or failed.
    #[error("{0}")]
    Failed(String),
}

impl Compiler {
    /// Its name in messages.
    pub fn name(&self) -> &'static str {
        match self.kind {
            Kind::Slang => "slangc",
            Kind::Glslang => "glslang",
        }
    }

    /// What it calls its version.
    ///
    /// # Errors
    /// [`CompileError::Failed`] when it cannot be started or prints none.
    pub fn version(&self) -> Result<String, CompileError> {
        let mut command = Command::new(&self.program);
        command.arg(match self.kind {
            Kind::Slang => "-v",
            Kind::Glslang => "--version",
        });
        let output = tool::run(command, &[], LIMIT).map_err(|loss| self.failed(&loss.to_string()))?;
        let said = [output.out, output.err].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
        let line = match self.kind {
            Kind::Slang => said.lines().next(),
            Kind::Glslang => said.lines().find_map(|line| line.strip_prefix("Glslang Version: ")),
        };
        let version = line.map(str::trim).filter(|line| line.starts_with(|c: char| c.is_ascii_digit() || c == 'v'));
        version.map(base::text::printable).ok_or_else(|| self.failed("tells no version"))
    }

    /// The module of a text, with debugging information and with its functions as they are. `glslang` takes one entry
    /// point at a time.
    ///
    /// # Errors
    /// [`CompileError`]: the text is wrong, or the program is not there, crashes, hangs or prints no module.
    pub fn compile(&self, source: &Source<'_>) -> Result<Vec<u32>, CompileError> {
        let mut command = Command::new(&self.program);
        command.args(self.arguments(source));
        self.run(command, source.text)
    }

    fn arguments(&self, source: &Source<'_>) -> Vec<String> {
        let mut all: Vec<String> = Vec::new();
        let mut add = |words: &[&str]| all.extend(words.iter().map(|word| (*word).to_owned()));
        match self.kind {
            Kind::Slang => {
                add(&["-lang", if source.slang { "slang" } else { "hlsl" }, "-target", "spirv"]);
                // A later version copies structures between layouts by an instruction that naga does not read. Without
                // optimisation, functions stay what they are, and no further library is needed.
                add(&["-profile", "spirv_1_3", "-O0", "-g2", "-fvk-use-entrypoint-name"]);
                add(&["-disable-non-essential-validations"]);
                for (name, value) in source.defines {
                    add(&[&format!("-D{name}={value}")]);
                }
                for folder in source.folders {
                    add(&["-I", &folder.display().to_string()]);
                }
                for (name, stage) in source.points {
                    let stage = match stage {
                        PointStage::Vertex => "vertex",
                        PointStage::Fragment => "fragment",
                        PointStage::Compute => "compute",
                    };
                    add(&["-entry", name, "-stage", stage]);
                }
                add(&["-o", "-", "--", "-"]);
            }
            Kind::Glslang => {
                add(&["-D", "-V", "--stdin", "-g", "-Od", "--keep-uncalled", "--amb", "--target-env", "vulkan1.1"]);
                add(&["-o", "/dev/stdout"]);
                for (name, value) in source.defines {
                    add(&[&format!("-D{name}={value}")]);
                }
                for folder in source.folders {
                    add(&[&format!("-I{}", folder.display())]);
                }
                for (name, stage) in source.points {
                    let stage = match stage {
                        PointStage::Vertex => "vert",
                        PointStage::Fragment => "frag",
                        PointStage::Compute => "comp",
                    };
                    add(&["-e", name, "-S", stage]);
                }
            }
        }
        all
    }

    fn failed(&self, how: &str) -> CompileError {
        let program = base::text::printable(&self.program.display().to_string());
        CompileError::Failed(format!("`{program}` {how}"))
    }

    fn run(&self, command: Command, text: &str) -> Result<Vec<u32>, CompileError> {
        let output = tool::run(command, text.as_bytes(), LIMIT).map_err(|loss| self.failed(&loss.to_string()))?;
        let said = [&output.err, &output.out].map(|bytes| String::from_utf8_lossy(bytes).into_owned()).join("\n");
        if output.code != 0 {
            let messages = match self.kind {
                Kind::Slang => of_slang(&said),
                Kind::Glslang => of_glslang(&said),
            };
            if messages.is_empty() {
                let how = format!("ended with status {}; {}", output.code, words(&said));
                return Err(self.failed(&how));
            }
            return Err(CompileError::Refused(messages));
        }
        module_in(&output.out).ok_or_else(|| self.failed(&format!("gave no whole module; {}", words(&said))))
    }
}

/// The words of the module in what a program printed, which may name its input before and behind it.
fn module_in(out: &[u8]) -> Option<Vec<u32>> {
    let start = out.windows(4).position(|bytes| bytes == spirv::MAGIC_NUMBER.to_le_bytes())?;
    let words: Vec<u32> = out[start..].chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    let (mut at, mut end) = (5, None);
    while let Some(length) = words.get(at).map(|first| (first >> 16) as usize) {
        if length == 0 || at + length > words.len() {
            break;
        }
        at += length;
        if words[at - length] & 0xffff == spirv::Op::FunctionEnd as u32 {
            end = Some(at);
        }
    }
    // A module ends with a function; behind it may stand `stdin`.
    let end = end?;
    (out.len() - start - 4 * end <= LONGEST_NAME).then(|| words[..end].to_vec())
}

/// The first line that was printed, as far as it is text.
fn words(said: &str) -> String {
    let said = said.lines().map(str::trim).find(|line| !line.is_empty() && *line != "stdin");
    let Some(said) = said else { return "it printed nothing".to_owned() };
    let said: String = said.chars().take(LONGEST).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    format!("it printed `{said}`")
}

/// The file of a message; none for the text itself.
fn file(name: &str) -> Option<String> {
    let name = name.trim();
    (!matches!(name, "<stdin>" | "stdin" | "0" | "-" | "")).then(|| name.to_owned())
}

/// The errors in what slangc says: a line with a number, one with the place, and under the author's line what is wrong;
/// or all in one line, as older versions have it.
fn of_slang(said: &str) -> Vec<Message> {
    let mut found: Vec<Message> = Vec::new();
    let mut open: Option<Message> = None;
    for line in said.lines() {
        let head = ["error", "fatal error", "internal error"].iter().find_map(|word| line.strip_prefix(word));
        if let Some(rest) = head.filter(|rest| rest.starts_with(['[', ':', ' '])) {
            found.extend(open.take());
            let text = rest.split_once(']').map_or(rest, |(_, text)| text).trim_start_matches([':', ' ']);
            open = Some(Message { file: None, line: 0, column: 0, text: plain(text) });
        } else if line.starts_with("warning") || line.starts_with("note") {
            found.extend(open.take());
        } else if let Some(message) = open.as_mut() {
            if let Some(place) = line.trim_start().strip_prefix("--> ") {
                let mut parts = place.rsplitn(3, ':');
                message.column = parts.next().and_then(|n| n.trim().parse().ok()).unwrap_or(0);
                message.line = parts.next().and_then(|n| n.parse().ok()).unwrap_or(0);
                message.file = parts.next().and_then(file);
            } else if let Some((_, under)) = line.split_once('|')
                && let Some(more) = under.trim_start().strip_prefix('^')
            {
                let more = more.trim_start_matches('^').trim();
                if !more.is_empty() {
                    message.text = plain(more);
                }
            }
        } else if let Some((place, rest)) = line.split_once("): error ")
            && let Some((name, at)) = place.rsplit_once('(')
            && let Ok(at) = at.parse()
        {
            let text = rest.split_once(": ").map_or(rest, |(_, text)| text);
            found.push(Message { file: file(name), line: at, column: 0, text: plain(text) });
        }
    }
    found.extend(open);
    found
}

/// The errors in what glslang says: `ERROR: stdin:2: 'y' : unknown variable`, with the column in a line of its own.
fn of_glslang(said: &str) -> Vec<Message> {
    let mut found: Vec<Message> = Vec::new();
    for line in said.lines() {
        if let Some(rest) = line.strip_prefix("ERROR: ") {
            let mut parts = rest.splitn(3, ':');
            let (name, at, text) = (parts.next(), parts.next(), parts.next());
            let at = at.and_then(|at| at.parse().ok());
            if let (Some(name), Some(at), Some(text)) = (name, at, text) {
                let text = text.trim().trim_start_matches("'' : ");
                found.push(Message { file: file(name), line: at, column: 0, text: plain(text) });
            } else if !rest.contains("compilation errors") {
                found.push(Message { file: None, line: 0, column: 0, text: plain(rest) });
            }
        } else if let Some((place, rest)) = line.split_once("): error at column ")
            && let Some((_, at)) = place.rsplit_once('(')
        {
            let column = rest.split(',').next().and_then(|n| n.trim().parse().ok()).unwrap_or(0);
            let at: usize = at.parse().unwrap_or(0);
            found.iter_mut().filter(|message| message.line == at).for_each(|message| message.column = column);
        }
    }
    // What follows the first error of a place is what the parser then missed.
    found.dedup_by(|later, first| {
        later.line == first.line && later.file == first.file && later.text.ends_with("Expected")
    });
    found
}

fn plain(text: &str) -> String {
    base::text::printable(text.trim().trim_end_matches('.'))
}

/// A compiler of this path, if its name is that of one.
pub fn named(program: &Path) -> Option<Compiler> {
    let name = program.file_stem()?.to_string_lossy().to_ascii_lowercase();
    let kind = match () {
        () if name.starts_with("slangc") => Kind::Slang,
        () if name.starts_with("glslang") => Kind::Glslang,
        () => return None,
    };
    Some(Compiler { kind, program: program.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(line: usize, column: usize, text: &str) -> Message {
        Message { file: None, line, column, text: text.to_owned() }
    }

    #[test]
    fn what_slangc_says_is_told_with_its_place() {
        let said = "warning[E39019]: implicit\n --> <stdin>:2:7\n  |\n2 | float loose;\n  |       ^^^^^ 'loose' is\n--'\n\
                    error[E30019]: type mismatch in expression\n --> <stdin>:3:41\n  |\n3 | float3 u = v;\n  |            ^ expected \
                    an expression of type 'A', got 'B'\n--'\nerror[E15300]: include file not found\n --> lib/a.slang:1:10\n";
        let mut include = message(1, 10, "include file not found");
        include.file = Some("lib/a.slang".to_owned());
        assert_eq!(of_slang(said), [message(3, 41, "expected an expression of type 'A', got 'B'"), include]);
        let old = "f.slang(7): error 30015: undefined identifier 'y'.\n";
        assert_eq!(of_slang(old)[0].line, 7);
        assert_eq!(of_slang("Segmentation fault"), []);
    }

    #[test]
    fn what_glslang_says_is_told_with_its_place() {
        let said = "stdin\nERROR: stdin:2: 'y' : unknown variable \nERROR: stdin:2: 'expression' : Expected \n\
                    stdin(2): error at column 12, HLSL parsing failed.\nERROR: 2 compilation errors.  No code generated.\n";
        assert_eq!(of_glslang(said), [message(2, 12, "'y' : unknown variable")]);
        assert_eq!(of_glslang("stdin\n"), []);
    }

    /// What comes of a text through a line of shell in place of a compiler.
    fn through(script: &str) -> String {
        let compiler = Compiler { kind: Kind::Glslang, program: "glslang".into() };
        let mut command = Command::new("/bin/sh");
        command.args(["-c", script]);
        compiler.run(command, "").unwrap_err().to_string()
    }

    #[test]
    fn a_compiler_that_neither_refuses_nor_compiles_has_failed() {
        assert!(through("kill -SEGV $$").contains("signal 11"));
        assert!(through("exit 0").contains("gave no whole module; it printed nothing"));
        assert!(through("echo what; exit 3").contains("status 3; it printed `what`"));
        // Half a module: an instruction of three words, of which two are there.
        let half =
            "printf '\\003\\002\\043\\007\\0\\0\\1\\0\\0\\0\\0\\0\\1\\0\\0\\0\\0\\0\\0\\0\\016\\0\\003\\0\\0\\0\\0\\0'";
        assert!(through(half).contains("gave no whole module"), "{}", through(half));
        assert_eq!(through("echo stdin; echo 'ERROR: stdin:1: bad'; exit 2"), "bad");
    }

    #[test]
    fn each_compiler_is_asked_in_its_own_words() {
        let points = [("main".to_owned(), PointStage::Fragment)];
        let (defines, folders) = ([("A".to_owned(), "1".to_owned())], [PathBuf::from("lib")]);
        let source = Source { text: "", slang: true, points: &points, defines: &defines, folders: &folders };
        let asked = |name: &str| named(Path::new(name)).unwrap().arguments(&source).join(" ");
        let slang = asked("/opt/slangc");
        assert!(
            slang.starts_with("-lang slang -target spirv")
                && slang.contains("-DA=1 -I lib -entry main -stage fragment")
        );
        let glslang = asked("glslangValidator");
        assert!(glslang.starts_with("-D -V --stdin") && glslang.ends_with("-DA=1 -Ilib -e main -S frag"), "{glslang}");
        assert_eq!(named(Path::new("/usr/bin/fxc")), None);
    }
}
