//! A finding as a folder: the program, the suite that runs it, and a text that is ready to be filed once a person has read
//! it.

use serde::{Deserialize, Serialize};

use super::cause::{Event, EventKind};
use super::print::Printed;

/// The files of a finding, each with its name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Folder {
    /// Its name.
    pub name: String,
    /// Names of files and what is in them.
    pub files: Vec<(String, String)>,
}

impl Folder {
    /// The folder of an event of a small program.
    pub fn of(printed: &Printed, event: &Event, operations: &str) -> Self {
        let name = name(event, operations);
        let files = vec![
            (printed.file.clone(), printed.text.clone()),
            ("repro.suite.toml".to_owned(), printed.suite.clone()),
            ("report.md".to_owned(), report(printed, event, operations)),
        ];
        Self { name, files }
    }

    /// The program.
    pub fn text(&self) -> &str {
        self.files.first().map_or("", |(_, text)| text)
    }
}

/// `vulkan-deviation-packsnorm4x8`.
fn name(event: &Event, operations: &str) -> String {
    let about = match operations {
        "" => event.origin.as_str(),
        operations => operations,
    };
    let words = format!("{} {} {about}", event.on, event.kind.name());
    let mut name = String::new();
    for c in words.chars() {
        match c {
            c if c.is_ascii_alphanumeric() => name.push(c.to_ascii_lowercase()),
            _ if !name.ends_with('-') => name.push('-'),
            _ => {}
        }
    }
    let cut: String = name.chars().take(60).collect();
    cut.trim_matches('-').to_owned()
}

fn report(printed: &Printed, event: &Event, operations: &str) -> String {
    let language = printed.file.rsplit('.').next().filter(|ending| *ending == "wgsl").unwrap_or("glsl");
    let about = if operations.is_empty() { String::new() } else { format!(" ({operations})") };
    let title = format!("{}: {}{about}", event.on, title(event.kind));
    let command = match &event.reproduce {
        Some(command) => command.clone(),
        None => format!("shadercheck check repro.suite.toml --lane {}", event.on),
    };
    let mut text = format!("# {title}\n\nTo see it in this folder:\n\n```sh\n{command}\n```\n\n## Text to file\n\n");
    text.push_str(&format!("The smallest text that shows it:\n\n```{language}\n{}```\n\n", printed.text));
    if !event.inputs.is_empty() {
        text.push_str("With these inputs:\n\n```text\n");
        for input in &event.inputs {
            let bits: Vec<String> = input.bits.iter().map(|bits| format!("0x{bits:08x}")).collect();
            text.push_str(&format!("{} = {} ({})\n", input.shown(), input.values(), bits.join(", ")));
        }
        text.push_str("```\n\n");
    }
    let expected = match event.kind {
        EventKind::Lost | EventKind::Panic | EventKind::Failed => {
            "The program is valid; it is taken and run, or refused with a message that says why."
        }
        EventKind::Deviation => "What the language says of the program, within the errors that the API allows.",
        EventKind::Flaky => "The same outputs for the same inputs.",
        EventKind::Translation => "A translation that means what the program means.",
    };
    text.push_str(&format!("**Expected.** {expected}\n\n**Actual.** {}.", event.message.trim_end_matches('.')));
    for part in [&event.diagnosis, &event.blamed].into_iter().filter(|part| !part.is_empty()) {
        text.push_str(&format!(" {part}."));
    }
    text.push('\n');
    text
}

fn title(kind: EventKind) -> &'static str {
    match kind {
        EventKind::Lost => "the driver or translator crashes or hangs",
        EventKind::Panic => "a panic",
        EventKind::Deviation => "a wrong result",
        EventKind::Flaky => "other results for the same inputs",
        EventKind::Translation => "a translation of another meaning",
        EventKind::Failed => "a call fails",
    }
}
