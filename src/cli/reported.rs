//! How the result of a command that finds faults is printed: for people, for programs, or for services that show findings
//! beside the lines of a change.

use std::path::Path;

use anyhow::Context;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::cli::check::Format;
use base::text::Shown;
use disk::fresh;
use report::ci::{self, Run};

/// A format.
#[derive(Clone, Copy, Debug, Default)]
pub enum Reported {
    /// For people.
    #[default]
    Text,
    /// For programs.
    Json,
    /// For services.
    Service(&'static ci::Format),
}

impl From<Format> for Reported {
    fn from(format: Format) -> Self {
        match format {
            Format::Text => Self::Text,
            Format::Json => Self::Json,
        }
    }
}

/// Their names, as options take them.
pub fn names() -> PossibleValuesParser {
    let own = [("text", "For people"), ("json", "For programs")];
    let own = own.into_iter().map(|(name, help)| PossibleValue::new(name).help(help));
    let services = ci::FORMATS.iter().map(|format| PossibleValue::new(format.name).help(format.summary));
    PossibleValuesParser::new(own.chain(services))
}

/// The format that an option names.
pub fn parser() -> impl TypedValueParser<Value = Reported> {
    names().map(|name| Reported::named(&name))
}

impl Reported {
    /// The format of a name that [`names`] has.
    pub fn named(name: &str) -> Self {
        match ci::by_name(name) {
            Some(service) => Self::Service(service),
            None if name == "json" => Self::Json,
            None => Self::Text,
        }
    }

    /// True where people read the result as it comes.
    pub fn is_text(self) -> bool {
        matches!(self, Self::Text)
    }

    /// The result for programs and services; none for people.
    ///
    /// # Errors
    /// When a service's format cannot hold it.
    pub fn of(self, run: impl FnOnce() -> Run, json: impl FnOnce() -> String) -> anyhow::Result<Option<String>> {
        match self {
            Self::Text => Ok(None),
            Self::Json => Ok(Some(json())),
            Self::Service(service) => (service.write)(&run()).map(Some).map_err(anyhow::Error::msg),
        }
    }
}

/// Writes a run in every format for services, and for programs, to a folder, each file in one step.
///
/// # Errors
/// When the folder cannot be made, or a file cannot be written.
pub fn write_all(folder: &Path, run: &Run, json: &str) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder `{}`", folder.shown()))?;
    let write = |file: &str, text: &str| {
        let path = folder.join(file);
        fresh::write(&path, text.as_bytes()).with_context(|| format!("cannot write `{}`", path.shown()))
    };
    write("report.json", json)?;
    for format in ci::FORMATS {
        let text = (format.write)(run).map_err(anyhow::Error::msg);
        write(format.file, &text.with_context(|| format!("cannot write `{}`", format.file))?)?;
    }
    Ok(())
}
