//! The content of the textbook chapter on shape deformation and of the note on hair: reference formulas, relations between
//! outputs, and suites. It is submitted to [`engine::catalogue`], as content of anyone else is.

pub mod exact;
pub mod formula;
pub mod relations;
mod suites;
#[cfg(test)]
mod tests;

use engine::catalogue::Catalogue;

pub use suites::SUITES;

inventory::submit! {
    Catalogue {
        formulas: formula::ALL,
        relations: relations::ALL,
        suites: SUITES,
        expectations: Some(("shaders/expectations.toml", include_str!("../../../shaders/expectations.toml"))),
    }
}
