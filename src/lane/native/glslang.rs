//! The translator: the program `glslangValidator`, as a child process with pipes and without files.

use std::cell::RefCell;
use std::collections::HashMap;
use std::io::Write as _;
use std::process::{Command, Stdio};
use std::rc::Rc;

use super::spirv;
use crate::lane::LaneError;

/// Name of the program.
const PROGRAM: &str = "glslangValidator";

/// What makes the loose uniforms, the names of built-ins and the missing locations of OpenGL's GLSL ones of Vulkan.
const OPTIONS: [&str; 7] = ["-V", "-R", "--aml", "--amb", "--target-env", "vulkan1.1", "--stdin"];

/// Stage of a text, as the program calls it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Vertex,
    Geometry,
}

type Key = (Kind, String, Vec<(String, String)>);
type Translated = Result<Rc<[u32]>, LaneError>;

/// Translates, and remembers what it translated.
pub(super) struct Translator {
    pub version: String,
    known: RefCell<HashMap<Key, Translated>>,
}

impl Translator {
    /// Looks whether the program is there.
    pub fn find() -> Result<Self, String> {
        if !cfg!(unix) {
            return Err(
                "its translator writes into a pipe by the name `/dev/stdout`, which this system lacks".to_owned()
            );
        }
        let output = Command::new(PROGRAM).arg("--version").stdin(Stdio::null()).output();
        let output = output.map_err(|error| format!("`{PROGRAM}` cannot be started ({error})"))?;
        let text = String::from_utf8_lossy(&output.stdout);
        let version = text.lines().find_map(|line| line.strip_prefix("Glslang Version: "));
        let version = version.ok_or_else(|| format!("`{PROGRAM} --version` tells no version of glslang"))?;
        Ok(Self { version: version.trim().to_owned(), known: RefCell::default() })
    }

    /// A text as SPIR-V for Vulkan 1.1.
    ///
    /// # Errors
    /// [`LaneError::Unsupported`] with the words of the translator.
    pub fn translate(&self, kind: Kind, text: &str, defines: &[(String, String)]) -> Translated {
        let key = (kind, text.to_owned(), defines.to_vec());
        if let Some(known) = self.known.borrow().get(&key) {
            return known.clone();
        }
        let translated = translate(kind, text, defines);
        self.known.borrow_mut().insert(key, translated.clone());
        translated
    }
}

fn translate(kind: Kind, text: &str, defines: &[(String, String)]) -> Translated {
    let api = |what: std::io::Error| LaneError::Api(format!("`{PROGRAM}`: {what}"));
    let stage = match kind {
        Kind::Vertex => "vert",
        Kind::Geometry => "geom",
    };
    let mut command = Command::new(PROGRAM);
    command.args(OPTIONS).args(["-S", stage, "-o", "/dev/stdout"]);
    command.args(defines.iter().map(|(name, value)| format!("-D{name}={value}")));
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().map_err(api)?;
    if let Some(mut stdin) = child.stdin.take() {
        // It reads everything before it writes. One that gives up early says so itself.
        let _ = stdin.write_all(text.as_bytes());
    }
    let output = child.wait_with_output().map_err(api)?;
    if !output.status.success() {
        return Err(LaneError::Unsupported(complaint(&output.stdout, &output.stderr)));
    }
    match spirv::module_in(&output.stdout) {
        Some(words) => Ok(words.into()),
        None => {
            Err(LaneError::Api(format!("`{PROGRAM}` gave no module; {}", complaint(&output.stdout, &output.stderr))))
        }
    }
}

/// The first complaint, in the translator's own words.
fn complaint(out: &[u8], err: &[u8]) -> String {
    let text = [out, err].map(String::from_utf8_lossy).join("\n");
    let told = text.lines().find_map(|line| line.strip_prefix("ERROR: "));
    let told = told.or_else(|| text.lines().find(|line| !line.trim().is_empty() && *line != "stdin"));
    let told = told.unwrap_or("it says nothing");
    // Its name of a text is a number, or what it is read from.
    let place = ["0:", "stdin:"].iter().find_map(|name| told.strip_prefix(name));
    match place.and_then(|rest| rest.split_once(": ")) {
        Some((line, what)) if line.chars().all(|c| c.is_ascii_digit()) => {
            format!("glslang, line {line}: {}", what.trim_end())
        }
        _ => format!("glslang: {told}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn complaints_are_told_with_their_line() {
        let out =
            b"stdin\nERROR: 0:3: 'x' : undeclared identifier \nERROR: 1 compilation errors.  No code generated.\n";
        assert_eq!(complaint(out, b""), "glslang, line 3: 'x' : undeclared identifier");
        assert_eq!(complaint(b"ERROR: stdin:7: '' : bad \n", b""), "glslang, line 7: '' : bad");
        assert_eq!(complaint(b"stdin\n", b"Segmentation fault\n"), "glslang: Segmentation fault");
        assert_eq!(complaint(b"", b""), "glslang: it says nothing");
    }
}
