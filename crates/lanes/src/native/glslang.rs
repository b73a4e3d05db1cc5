//! The translator: the program `glslangValidator`, as a child process with pipes and without files.
//!
//! A text that it refuses is not supported on the lane. A translator that crashes, hangs or prints no module is at
//! fault itself, and fails the lane.

use std::collections::HashMap;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::spirv;
use crate::LaneError;
use crate::worker::tool;

/// Name of the program.
const PROGRAM: &str = "glslangValidator";

/// What makes the loose uniforms, the names of built-ins and the missing locations of OpenGL's GLSL ones of Vulkan.
const OPTIONS: [&str; 7] = ["-V", "-R", "--aml", "--amb", "--target-env", "vulkan1.1", "--stdin"];

/// Exit statuses of a program that refuses a text: it does not compile, or does not link.
const REFUSED: [i32; 2] = [2, 3];

/// Characters of its words that are shown.
const LONGEST: usize = 120;

/// Longest time for a text, which takes 50 ms where nothing is wrong.
const LIMIT: Duration = Duration::from_secs(30);
/// The same once it did not end in that time.
const AFTER_A_HANG: Duration = Duration::from_secs(2);

/// Stage of a text, as the program calls it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum TextStage {
    Vertex,
    Geometry,
    Compute,
}

type Key = (TextStage, String, Vec<(String, String)>);
type Translated = Result<Arc<[u32]>, LaneError>;

/// Translates, and remembers what it translated.
pub(super) struct Translator {
    pub version: String,
    known: Mutex<HashMap<Key, Translated>>,
    /// It did not end in its time once.
    hung: AtomicBool,
}

impl Translator {
    /// Looks whether the program is there.
    pub fn find() -> Result<Self, String> {
        if !cfg!(unix) {
            return Err(
                "its translator writes into a pipe by the name `/dev/stdout`, which this system lacks".to_owned()
            );
        }
        let mut command = Command::new(PROGRAM);
        command.arg("--version");
        let output = tool::run(command, &[], LIMIT).map_err(|loss| format!("`{PROGRAM} --version` {loss}"))?;
        let text = String::from_utf8_lossy(&output.out);
        let version = text.lines().find_map(|line| line.strip_prefix("Glslang Version: "));
        let version = version.ok_or_else(|| format!("`{PROGRAM} --version` tells no version of glslang"))?;
        Ok(Self { version: version.trim().to_owned(), known: Mutex::default(), hung: AtomicBool::new(false) })
    }

    /// A text as SPIR-V for Vulkan 1.1.
    ///
    /// # Errors
    /// [`LaneError::Unsupported`] with the words of a translator that refuses the text, and [`LaneError::Translator`]
    /// for one that neither refuses nor translates it.
    pub fn translate(&self, kind: TextStage, text: &str, defines: &[(String, String)]) -> Translated {
        let key = (kind, text.to_owned(), defines.to_vec());
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = known().get(&key) {
            return known.clone();
        }
        let limit = if self.hung.load(Ordering::Relaxed) { AFTER_A_HANG } else { LIMIT };
        let begun = std::time::Instant::now();
        let translated = translate(command(PROGRAM, kind, defines), text, limit);
        if begun.elapsed() >= limit {
            self.hung.store(true, Ordering::Relaxed);
        }
        known().insert(key, translated.clone());
        translated
    }
}

/// The program with its arguments for a text.
fn command(program: &str, kind: TextStage, defines: &[(String, String)]) -> Command {
    let stage = match kind {
        TextStage::Vertex => "vert",
        TextStage::Geometry => "geom",
        TextStage::Compute => "comp",
    };
    let mut command = Command::new(program);
    command.args(OPTIONS).args(["-S", stage, "-o", "/dev/stdout"]);
    command.args(defines.iter().map(|(name, value)| format!("-D{name}={value}")));
    command
}

fn translate(command: Command, text: &str, limit: Duration) -> Translated {
    let failed = |how: String| Err(LaneError::Translator(format!("`{PROGRAM}` {how}")));
    let output = match tool::run(command, text.as_bytes(), limit) {
        Ok(output) => output,
        Err(loss) => return failed(loss.to_string()),
    };
    let said = || words(&output.out, &output.err);
    match (output.code, refusal(&output.out, &output.err)) {
        (0, _) => match spirv::module_in(&output.out) {
            Some(words) => Ok(words.into()),
            None => failed(format!("gave no whole module; {}", said())),
        },
        (code, Some(refusal)) if REFUSED.contains(&code) => Err(LaneError::Unsupported(refusal)),
        (code, _) => failed(format!("ended with status {code}; {}", said())),
    }
}

/// Why the translator refuses a text, in its own words; `None` where it does not say so.
fn refusal(out: &[u8], err: &[u8]) -> Option<String> {
    let text = [out, err].map(String::from_utf8_lossy).join("\n");
    let said = text.lines().find_map(|line| line.strip_prefix("ERROR: "))?;
    // Its name of a text is a number, or what it is read from.
    let place = ["0:", "stdin:"].iter().find_map(|name| said.strip_prefix(name));
    Some(match place.and_then(|rest| rest.split_once(": ")) {
        Some((line, what)) if line.chars().all(|c| c.is_ascii_digit()) => {
            format!("glslang, line {line}: {}", what.trim_end())
        }
        _ => format!("glslang: {said}"),
    })
}

/// The first line that the translator printed, as far as it is text.
fn words(out: &[u8], err: &[u8]) -> String {
    let text = [out, err].map(String::from_utf8_lossy).join("\n");
    let said = text.lines().map(str::trim).find(|line| !line.is_empty() && *line != "stdin");
    let Some(said) = said else { return "it printed nothing".to_owned() };
    let said: String = said.chars().take(LONGEST).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    format!("it printed `{said}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_is_reported_with_its_line() {
        let out =
            b"stdin\nERROR: 0:3: 'x' : undeclared identifier \nERROR: 1 compilation errors.  No code generated.\n";
        assert_eq!(refusal(out, b"").unwrap(), "glslang, line 3: 'x' : undeclared identifier");
        assert_eq!(refusal(b"ERROR: stdin:7: '' : bad \n", b"").unwrap(), "glslang, line 7: '' : bad");
        assert_eq!(refusal(b"stdin\n", b"Segmentation fault\n"), None);
    }

    /// What comes of a text through a line of shell in place of the translator.
    fn through(script: &str) -> Translated {
        let mut command = Command::new("/bin/sh");
        command.args(["-c", script]);
        translate(command, "void main() { }", Duration::from_secs(2))
    }

    fn fails(script: &str, how: &str) {
        assert_eq!(through(script), Err(LaneError::Translator(format!("`{PROGRAM}` {how}"))), "{script}");
    }

    #[test]
    fn a_translator_that_neither_refuses_nor_translates_is_at_fault() {
        fails("kill -SEGV $$", "was ended by signal 11 (segmentation fault)");
        fails("echo 'Segmentation fault' >&2; exit 139", "ended with status 139, as a shell does after signal 11");
        fails("exec sleep 60", "did not end within 2 s");
        fails("exit 0", "gave no whole module; it printed nothing");
        fails("exit 2", "ended with status 2; it printed nothing");
        fails("echo; echo what; exit 2", "ended with status 2; it printed `what`");
        fails("echo 'ERROR: usage'; exit 1", "ended with status 1; it printed `ERROR: usage`");
        fails("printf '\\003\\002\\043\\007'", "gave no whole module; it printed `\u{fffd}\u{fffd}#\u{fffd}`");
        let refused = through("echo stdin; echo 'ERROR: 0:1: bad'; exit 2");
        assert_eq!(refused, Err(LaneError::Unsupported("glslang, line 1: bad".to_owned())));
    }

    #[test]
    fn a_module_that_is_cut_off_is_none() {
        let translator = Translator::find().expect("these tests need glslangValidator");
        let text = "#version 450\nfloat f(float x) { return x * x; }\nvoid main() { gl_Position = vec4(f(2.0)); }\n";
        let whole = translator.translate(TextStage::Vertex, text, &[]).unwrap();
        for length in 0..whole.len() {
            assert_eq!(spirv::module_in(bytemuck::cast_slice(&whole[..length])), None, "{length} words");
        }
        assert_eq!(spirv::module_in(bytemuck::cast_slice(&whole)), Some(whole.to_vec()));
    }
}
