//! The assembler of SPIR-V: the program `spirv-as`, as a child process with pipes and without files.

use std::process::Command;
use std::time::Duration;

use thiserror::Error;

use crate::worker::tool;

/// Name of the program.
const PROGRAM: &str = "spirv-as";
/// Longest time for a text, which takes some milliseconds where nothing is wrong.
const LIMIT: Duration = Duration::from_secs(30);

/// Why there is no module.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum AssembleError {
    /// The text is wrong.
    #[error("line {line}: {why}")]
    Refused {
        /// Line, from 1.
        line: usize,
        /// What the assembler says.
        why: String,
    },
    /// The assembler is not there, or failed.
    #[error("{0}")]
    Failed(String),
}

/// The words of a text in assembly.
///
/// # Errors
/// [`AssembleError`]: the text is wrong, or the program is not there, crashes, hangs or prints no module.
pub fn assemble(text: &str) -> Result<Vec<u32>, AssembleError> {
    let mut command = Command::new(PROGRAM);
    command.args(["--preserve-numeric-ids", "-o", "-", "-"]);
    run(command, text)
}

fn run(command: Command, text: &str) -> Result<Vec<u32>, AssembleError> {
    let failed = |how: String| AssembleError::Failed(format!("`{PROGRAM}` {how}; it comes with SPIRV-Tools"));
    let output = tool::run(command, text.as_bytes(), LIMIT).map_err(|loss| failed(loss.to_string()))?;
    if output.code != 0 {
        let said = String::from_utf8_lossy(&output.err).into_owned();
        return Err(refusal(&said).unwrap_or_else(|| failed(format!("ended with status {}: {said}", output.code))));
    }
    let words = output.out.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let words: Vec<u32> = words.collect();
    match words.first() {
        Some(&spirv::MAGIC_NUMBER) if output.out.len().is_multiple_of(4) => Ok(words),
        _ => Err(failed("gave no whole module".to_owned())),
    }
}

/// What it says of a line: `error: 12: Unknown opcode`.
fn refusal(said: &str) -> Option<AssembleError> {
    let line = said.lines().find_map(|line| line.strip_prefix("error: "))?;
    let (line, why) = line.split_once(": ")?;
    Some(AssembleError::Refused { line: line.trim().parse().ok()?, why: base::text::printable(why.trim()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_said_of_a_line_is_told_with_it() {
        let found = refusal("error: 12: Expected operand, found end of stream.\n");
        let why = "Expected operand, found end of stream.".to_owned();
        assert_eq!(found, Some(AssembleError::Refused { line: 12, why }));
        assert_eq!(refusal("Segmentation fault"), None);
    }

    #[test]
    fn a_program_that_gives_no_module_has_failed() {
        let said = |script: &str| {
            let mut command = Command::new("/bin/sh");
            command.args(["-c", script]);
            run(command, "").unwrap_err().to_string()
        };
        assert!(said("printf abcdefgh").contains("gave no whole module"));
        assert!(said("exit 3").contains("status 3"));
        assert!(said("kill -SEGV $$").contains("signal 11"));
    }
}
