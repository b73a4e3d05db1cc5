//! The content of the textbook chapter on shape deformation and of the note on hair: reference formulas, relations between
//! outputs, generators of inputs, scenes, and suites. It is submitted to [`engine::catalogue`], as content of anyone else is.

pub mod exact;
pub mod formula;
pub mod generators;
pub mod relations;
pub mod scene;
mod suites;
#[cfg(test)]
mod tests;

use engine::catalogue::Catalogue;

pub use suites::SUITES;

inventory::submit! {
    Catalogue {
        formulas: formula::ALL,
        relations: relations::ALL,
        generators: generators::ALL,
        scenes: scene::ALL,
        suites: SUITES,
        expectations: Some((
            "shaders/expectations.toml",
            include_str!(concat!(env!("SHADERCHECK_SHADERS"), "/expectations.toml")),
        )),
    }
}
