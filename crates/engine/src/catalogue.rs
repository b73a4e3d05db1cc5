//! What suites may name: formulas, relations, and the suites that come with a program.
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

use judge::formula::Formula;
use property::Relation;

use crate::suite::ShippedSuite;

/// The content of one crate, each list in the order of the manual.
#[derive(Clone, Copy)]
pub struct Catalogue {
    /// Reference formulas, for `[expect] formula`.
    pub formulas: &'static [&'static Formula],
    /// Relations between outputs, for `relations`.
    pub relations: &'static [&'static dyn Relation],
    /// Suites that run when none is named.
    pub suites: &'static [ShippedSuite],
    /// Name and text of the file of expected failures that belongs to these suites.
    pub expectations: Option<(&'static str, &'static str)>,
}

inventory::collect!(Catalogue);

impl Catalogue {
    /// One with nothing in it.
    pub const EMPTY: Self = Self { formulas: &[], relations: &[], suites: &[], expectations: None };
}

fn all() -> impl Iterator<Item = &'static Catalogue> {
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

/// All suites that come with the program.
pub fn suites() -> impl Iterator<Item = &'static ShippedSuite> {
    all().flat_map(|catalogue| catalogue.suites)
}

/// Name and text of the expected failures of the suites that come with the program.
pub fn expectations() -> Option<(&'static str, &'static str)> {
    all().find_map(|catalogue| catalogue.expectations)
}
