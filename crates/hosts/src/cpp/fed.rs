//! Which attributes the host code of a project gives values.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use tree_sitter::Node;

use super::index::Index;
use super::lookup::LookupKind;
use super::tree::{arguments, bare, callee, descendants, plain_string};
use crate::HostFile;

/// The locations that calls of `glVertexAttrib…` name, and the names that host code has in quotation marks.
#[derive(Debug, Default)]
pub struct Fed {
    floats: BTreeSet<i64>,
    integers: BTreeSet<i64>,
    /// True when a location is computed, so that any may be meant.
    open: bool,
    quoted: HashSet<String>,
    /// True when host code is printed in pieces: what is not there may stand elsewhere.
    printed: bool,
}

/// What a call does with its location.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Gives {
    Floats,
    Integers,
    /// It enables an array, or says how often it steps.
    Nothing,
}

impl Fed {
    /// What the files of a project feed.
    pub fn of<'p>(hosts: impl Iterator<Item = &'p HostFile>) -> Self {
        let hosts = hosts.filter(|h| h.concerns_shaders() && h.file.text().contains("ttrib"));
        // On one thread: a rule asks first, and a thread that waited for others would take up one that asks again.
        hosts.map(Self::of_host).fold(Self::default(), Self::joined)
    }

    fn of_host(host: &HostFile) -> Self {
        let mut fed = Self { printed: host.place.is_some() || host.is_fragment(), ..Self::default() };
        let Some(index) = Index::new(host) else { return fed };
        let literals = descendants(index.root).filter_map(|n| plain_string(n, &host.file));
        fed.quoted.extend(literals.map(|(s, _)| s.to_owned()));
        fed.quoted.extend(index.macros().iter().flat_map(|m| m.split('"').map(str::to_owned)));
        let numbers = numbers(&index);
        for &call in &index.calls {
            let Some((gives, location)) = given(&index, call) else { continue };
            match number(host, &numbers, location) {
                Some(n) if gives == Gives::Floats => fed.floats.insert(n),
                Some(n) if gives == Gives::Integers => fed.integers.insert(n),
                Some(_) => continue,
                None => {
                    fed.open |= gives != Gives::Nothing && !is_looked_up(&index, location);
                    continue;
                }
            };
        }
        fed
    }

    fn joined(mut self, other: Self) -> Self {
        self.floats.extend(other.floats);
        self.integers.extend(other.integers);
        self.quoted.extend(other.quoted);
        self.open |= other.open;
        self.printed |= other.printed;
        self
    }

    /// True when the whole host code is there, and some of it feeds attributes.
    pub fn is_known(&self) -> bool {
        !self.printed && (self.open || !self.quoted.is_empty() || self.any())
    }

    /// True when this location gets values, or may get them.
    pub fn location(&self, location: i64) -> bool {
        self.open || self.floats.contains(&location) || self.integers.contains(&location)
    }

    /// True when this location is given values as floats alone.
    pub fn only_floats(&self, location: i64) -> bool {
        !self.open && self.floats.contains(&location) && !self.integers.contains(&location)
    }

    /// True when some location is given values.
    pub fn any(&self) -> bool {
        !self.floats.is_empty() || !self.integers.is_empty()
    }

    /// True when host code that feeds attributes has this name in quotation marks.
    pub fn quotes(&self, name: &str) -> bool {
        self.quoted.contains(name)
    }
}

/// What a call gives, with the expression for the location.
fn given<'t>(index: &Index<'t>, call: Node<'t>) -> Option<(Gives, Node<'t>)> {
    let (function, _) = callee(call, &index.host.file)?;
    let rest = function.strip_prefix("glVertexA")?;
    let (rest, at) = match rest.strip_prefix("rrayAttrib") {
        Some(rest) => (rest, 1),
        None => (rest.strip_prefix("ttrib")?, 0),
    };
    let gives = match rest {
        "Binding" | "Divisor" => Gives::Nothing,
        _ if rest.starts_with('I') => Gives::Integers,
        _ => Gives::Floats,
    };
    arguments(call).get(at).map(|n| (gives, bare(*n)))
}

/// Names that stand for one number each: macros, constants and enumerators with a value.
fn numbers<'t>(index: &Index<'t>) -> BTreeMap<&'t str, Option<i64>> {
    let host = index.host;
    let mut found: BTreeMap<&str, Option<i64>> = BTreeMap::new();
    let mut add = |name: &'t str, value: &str| {
        let Ok(number) = value.trim().trim_matches(['(', ')', 'u', 'U']).parse() else { return };
        found.entry(name).and_modify(|n| *n = n.filter(|n| *n == number)).or_insert(Some(number));
    };
    for node in descendants(index.root) {
        let (name, value) = match node.kind() {
            "preproc_def" | "enumerator" => (node.child_by_field_name("name"), node.child_by_field_name("value")),
            "init_declarator" if is_constant(host, node) => {
                (super::tree::declared_name(node), node.child_by_field_name("value"))
            }
            _ => continue,
        };
        if let (Some(name), Some(value)) = (name, value) {
            add(host.text(name), host.text(bare(value)));
        }
    }
    // What is written again is no constant.
    for write in index.writes.iter().filter(|w| !w.declares) {
        found.insert(host.text(write.target), None);
    }
    found
}

/// True for a declaration with `const` or `constexpr`.
fn is_constant(host: &HostFile, declarator: Node<'_>) -> bool {
    let head = |d: Node<'_>| host.text(d).get(..declarator.start_byte() - d.start_byte()).map(str::to_owned);
    declarator.parent().and_then(head).is_some_and(|h| h.split_whitespace().any(|w| w.starts_with("const")))
}

fn number(host: &HostFile, numbers: &BTreeMap<&str, Option<i64>>, location: Node<'_>) -> Option<i64> {
    let text = host.text(location);
    let last = text.rsplit("::").next().unwrap_or(text);
    text.trim_end_matches(['u', 'U']).parse().ok().or_else(|| *numbers.get(last)?)
}

/// True for a location that the file asks for by name.
fn is_looked_up(index: &Index<'_>, location: Node<'_>) -> bool {
    let asks = |node: Node<'_>| {
        let lookups = index.host.lookups().iter().filter(|l| l.kind == LookupKind::Attribute);
        lookups.into_iter().any(|l| node.start_byte() <= l.function.start && l.function.end <= node.end_byte())
    };
    let mut values = index.values(index.root, index.host.text(location)).peekable();
    asks(location) || (values.peek().is_some() && values.all(|w| asks(w.value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;

    fn fed(text: &str) -> Fed {
        let host = HostFile::new(&SourceFile::new("m.cpp", text), true);
        Fed::of([&host].into_iter())
    }

    #[test]
    fn locations_are_numbers_and_constants() {
        let fed = fed(
            "#define UV 2\nenum { BONES = 3 };\nvoid f() { glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, 0);\n\
                       glVertexAttribPointer(UV, 2, GL_FLOAT, GL_FALSE, 0, 0); glVertexAttribIPointer(BONES, 4, GL_INT, 0, 0);\n\
                       GLint l = glGetAttribLocation(p, \"place\"); glVertexAttribPointer(l, 2, GL_FLOAT, GL_FALSE, 0, 0); }",
        );
        assert!([0, 2, 3].into_iter().all(|n| fed.location(n)) && !fed.location(1));
        assert!(fed.only_floats(2) && !fed.only_floats(3) && !fed.only_floats(1));
        assert!(fed.quotes("place") && !fed.quotes("other"));
    }

    #[test]
    fn a_computed_location_may_be_any() {
        for text in [
            "void f() { for (int i = 0; i < 3; i++) glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, 0, 0); }",
            "void f(GLuint at) { glVertexAttribPointer(at, 3, GL_FLOAT, GL_FALSE, 0, 0); }",
        ] {
            assert!(fed(text).location(7), "{text}");
        }
        let enabled = "void f(GLuint at) { glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, 0); glEnableVertexAttribArray(at); }";
        assert!(!fed(enabled).location(7), "an array that is enabled needs a pointer too");
    }
}
