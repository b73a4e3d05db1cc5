//! `text`: with excerpts, for people.

use std::fmt::Write;

use crate::diagnostics;
use base::diagnostic::Diagnostic;

use super::{Context, Format};

/// The format.
pub const FORMAT: Format = Format { name: "text", summary: "With excerpts of the text", write };

fn write(found: &[Diagnostic], context: &Context) -> String {
    found.iter().fold(String::new(), |mut out, diagnostic| {
        // Writing into a String does not fail.
        let _ = writeln!(out, "{}", diagnostics::text(diagnostic, context.lang, context.color));
        out
    })
}
