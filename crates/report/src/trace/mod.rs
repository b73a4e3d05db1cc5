//! Traces: a case of a function, expression after expression.

mod json;
mod text;

pub use json::json;
pub use text::text;

use engine::trace::{Mark, TraceReport};

/// The traces of a run.
#[derive(Debug)]
pub struct Summary {
    /// Functions that were traced.
    pub traces: Vec<TraceReport>,
    /// Functions that were not, with the reason.
    pub not_traced: Vec<(String, String)>,
}

/// A mark in words. `profile` is the one of the bounds.
fn words(mark: &Mark, profile: &str) -> String {
    match mark {
        Mark::NoValue(why) | Mark::Lost(why) => why.clone(),
        Mark::Parts => "real numbers go another way from here on".to_owned(),
        Mark::Lane(lane) => format!("`{lane}` is farther off than {profile} allows"),
        Mark::Loses(bits) => format!("loses most: {bits:.1} bits beside those that its operands had lost"),
    }
}

/// The name of a mark for programs.
fn key(mark: &Mark) -> &'static str {
    match mark {
        Mark::NoValue(_) => "no_value",
        Mark::Lost(_) => "lost",
        Mark::Parts => "parts",
        Mark::Lane(_) => "lane",
        Mark::Loses(_) => "loses_most",
    }
}
