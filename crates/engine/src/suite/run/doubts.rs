//! Undetermined samples, with the places that bring them about.

use serde::{Deserialize, Serialize};
use std::fmt;

use super::Prepared;
use base::text::Location;
use judge::profile::Op;
use judge::verdict::diagnosis::in_one_line;
use judge::verdict::{Doubts, Reason};
use program::interp::author_span;

/// Undetermined samples with one reason and one place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Doubtful {
    /// Why they are undetermined.
    pub reason: Reason,
    /// Name of the operation, as profiles list it.
    pub op: Option<Op>,
    /// File, line and column of the operation.
    pub at: Option<Location>,
    /// The author's text there.
    pub text: String,
    /// The macro that is used there, where the operation is in what it expands to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expansion: Option<String>,
    /// Arguments of the operation in one of the samples.
    #[serde(with = "base::value::exact::list")]
    pub args: Vec<f64>,
    /// Number of samples.
    pub count: u64,
}

impl fmt::Display for Doubtful {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} undetermined, {}", self.count, self.reason)?;
        if let Some(op) = self.op {
            write!(f, ": {}", op.name())?;
            if !self.args.is_empty() {
                let args: Vec<String> = self.args.iter().map(|x| format!("{x:?}")).collect();
                write!(f, " of {} for one", args.join(", "))?;
            }
        }
        match (&self.at, self.text.as_str()) {
            (Some(at), "") => write!(f, ", at {at}"),
            (Some(at), text) => write!(f, ", `{}` at {at}", in_one_line(text)),
            (None, _) => Ok(()),
        }?;
        self.expansion.as_ref().map_or(Ok(()), |name| write!(f, ", in the expansion of `{name}`"))
    }
}

/// Doubts in words.
pub(super) fn doubtful(prepared: &Prepared, doubts: &Doubts) -> Doubtful {
    let Doubts { reason, op, site, args, count, first: _ } = doubts;
    let (program, executable) = (&prepared.program, prepared.oracle.executable());
    let span = site.and_then(|site| author_span(program, &executable.place(site)));
    let file = &program.file;
    Doubtful {
        reason: *reason,
        op: *op,
        at: span.map(|span| file.location(span.start)),
        text: span.map_or_else(String::new, |span| file.slice(span).to_owned()),
        expansion: span.and_then(|span| file.expansion(span)).map(|expansion| expansion.name.to_string()),
        args: args.clone(),
        count: *count,
    }
}
