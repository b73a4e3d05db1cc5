//! Which outputs have the same bits on every conforming device.

mod json;
mod text;

pub(crate) use json::Place;
pub use json::json;
pub use text::text;

use crate::word::shortened;
use engine::reproducible::{BitsReport, FreePlace, OutputBits, Standing};
use judge::tape::Freedom;
use judge::verdict::diagnosis::in_one_line;

/// Characters of an expression that are shown.
const EXPRESSION: usize = 48;

/// What came of a run.
#[derive(Debug)]
pub struct Summary {
    /// Functions that were looked at, each with the file that it stands in.
    pub functions: Vec<BitsReport>,
    /// Functions that were not, with the reason.
    pub not_run: Vec<(String, String)>,
}

impl Summary {
    /// True where some output is not fixed, or a lane has other bits where no device may.
    pub fn has_findings(&self) -> bool {
        let open = |output: &OutputBits| {
            matches!(output.standing(), Standing::Free | Standing::FixedByPrecise)
                || output.apart.iter().any(|apart| apart.fixed > 0)
        };
        self.functions.iter().flat_map(|function| &function.outputs).any(open)
    }

    /// Outputs of each standing, in the order of [`STANDINGS`].
    fn counts(&self) -> [usize; 5] {
        let all = || self.functions.iter().flat_map(|function| &function.outputs);
        STANDINGS.map(|standing| all().filter(|output| output.standing() == standing).count())
    }
}

const STANDINGS: [Standing; 5] =
    [Standing::Fixed, Standing::FixedButForEdges, Standing::FixedByPrecise, Standing::Free, Standing::Unknown];

/// The name of a standing for programs.
fn key(standing: Standing) -> &'static str {
    match standing {
        Standing::Fixed => "fixed",
        Standing::FixedButForEdges => "fixed_but_for_edges",
        Standing::FixedByPrecise => "fixed_by_precise",
        Standing::Free => "free",
        Standing::Unknown => "unknown",
    }
}

/// The name of a freedom for programs.
fn kind(freedom: Freedom) -> &'static str {
    match freedom {
        Freedom::Contraction => "contraction",
        Freedom::Order => "order",
        Freedom::Inside => "inside",
        Freedom::Function(_) => "function",
        Freedom::Subnormal => "subnormal",
        Freedom::NotFinite => "not_finite",
        Freedom::Decision => "decision",
    }
}

/// A freedom in words, behind the text of the expression.
fn words(place: &FreePlace) -> String {
    match place.freedom {
        Freedom::Contraction => "a product and a sum may be rounded once, as one operation".to_owned(),
        Freedom::Order => "another order of its terms or factors is allowed".to_owned(),
        Freedom::Inside => "the order of its sums and products is not stated".to_owned(),
        Freedom::Function(op) => format!("`{}` is promised within an error", op.name()),
        Freedom::Subnormal => "a subnormal number may become zero".to_owned(),
        Freedom::NotFinite => "infinite, or no number: nothing is promised".to_owned(),
        Freedom::Decision => "decides by numbers that differ already".to_owned(),
    }
}

/// Where a place stands, what the author wrote there, and what is left to devices.
pub(crate) fn of_place(place: &FreePlace) -> String {
    match &place.place {
        Some(there) => format!("{} `{}`: {}", there.at, shortened(&in_one_line(&there.text), EXPRESSION), words(place)),
        None => format!("an input: {}", words(place)),
    }
}
