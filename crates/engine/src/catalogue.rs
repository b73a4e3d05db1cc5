//! What suites may name: formulas, relations, generators of inputs, and the suites that come with a program.
//!
//! The engine has none of its own. A crate with such content submits one [`Catalogue`], and every program that links the
//! crate finds what is in it:
//!
//! ```
//! use engine::catalogue::{Catalogue, formulas};
//!
//! inventory::submit! { Catalogue::EMPTY }
//!
//! assert!(formulas().next().is_none());
//! ```
//!
//! A program that does not link a crate has none of its content: code that loops over the suites of the chapter
//! without being part of the program names `chapter::SUITES`.

use judge::formula::Formula;
use property::Relation;
use property::generators::{self, Generator};
use serde_json::Value;

use crate::suite::ShippedSuite;

/// The content of one crate, each list in the order of the manual.
#[derive(Clone, Copy)]
pub struct Catalogue {
    /// Reference formulas, for `[expect] formula`.
    pub formulas: &'static [&'static Formula],
    /// Relations between outputs, for `relations`.
    pub relations: &'static [&'static dyn Relation],
    /// Generators of inputs, for `generator`, beside those that are no content: [`generators::all`].
    pub generators: &'static [&'static dyn Generator],
    /// Scenes of formulas that are geometry.
    pub scenes: &'static [Scene],
    /// Suites that run when none is named.
    pub suites: &'static [ShippedSuite],
    /// Name and text of the file of expected failures that belongs to these suites.
    pub expectations: Option<(&'static str, &'static str)>,
}

/// What shows a formula that is geometry.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// Name of the formula.
    pub formula: &'static str,
    /// Makes the bytes of a GLB file (glTF 2.0) with about this many vertices, and with this `asset`.
    pub glb: fn(vertices: u64, asset: Value) -> Vec<u8>,
}

inventory::collect!(Catalogue);

impl Catalogue {
    /// One with nothing in it.
    pub const EMPTY: Self =
        Self { formulas: &[], relations: &[], generators: &[], scenes: &[], suites: &[], expectations: None };
}

fn all() -> impl Iterator<Item = &'static Catalogue> + Clone {
    inventory::iter::<Catalogue>.into_iter()
}

/// All formulas.
pub fn formulas() -> impl Iterator<Item = &'static Formula> {
    all().flat_map(|catalogue| catalogue.formulas).copied()
}

/// The formula called `name`.
pub fn formula(name: &str) -> Option<&'static Formula> {
    formulas().find(|formula| formula.name == name)
}

/// All relations.
pub fn relations() -> impl Iterator<Item = &'static dyn Relation> {
    all().flat_map(|catalogue| catalogue.relations).copied()
}

/// The relation called `name`.
pub fn relation(name: &str) -> Option<&'static dyn Relation> {
    relations().find(|relation| relation.name() == name)
}

/// All generators: those that any suite needs, then those of content.
pub fn generators() -> impl Iterator<Item = &'static dyn Generator> + Clone {
    generators::all().iter().chain(all().flat_map(|catalogue| catalogue.generators)).copied()
}

/// The generator called `name`.
pub fn generator(name: &str) -> Option<&'static dyn Generator> {
    generators().find(|generator| generator.name() == name)
}

/// All scenes.
pub fn scenes() -> impl Iterator<Item = &'static Scene> {
    all().flat_map(|catalogue| catalogue.scenes)
}

/// All suites that come with the program.
pub fn suites() -> impl Iterator<Item = &'static ShippedSuite> {
    all().flat_map(|catalogue| catalogue.suites)
}

/// Name and text of the expected failures of the suites that come with the program.
pub fn expectations() -> Option<(&'static str, &'static str)> {
    all().find_map(|catalogue| catalogue.expectations)
}
