//! The relations that suites can name, one family a file.

use super::Relation;

/// All relations.
pub fn all() -> &'static [&'static dyn Relation] {
    &[]
}

/// The relation called `name`.
pub fn by_name(name: &str) -> Option<&'static dyn Relation> {
    all().iter().copied().find(|r| r.name() == name)
}
