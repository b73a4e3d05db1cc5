//! Which shaders printed host code is about: it names none, and they stand around it.

use std::collections::BTreeSet;

use super::Program;
use crate::project::{Project, ShaderFile};

use hosts::HostFile;
use hosts::marks::without_comments;
use hosts::suggest::nearest;

/// How well a set of shaders fits a host listing; the greater the better.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Fit {
    /// Names that the listing has in common with the interface.
    names: usize,
    /// True when every look-up finds its name.
    all: bool,
    /// Headings in common.
    section: usize,
    /// True for shaders that are printed before the listing.
    before: bool,
    /// Blocks between, less is more.
    near: std::cmp::Reverse<usize>,
}

/// The program of a host listing that names no shader which is there: of several, the nearest that fits.
pub fn around<'p>(host: &HostFile, project: &'p Project) -> Option<Program<'p>> {
    let sets = project.around(host);
    let single = sets.len() == 1;
    let code = without_comments(host.file.text());
    let words: BTreeSet<&str> = code.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
    let best = sets.into_iter().map(|set| (fit(host, &set, &words), set)).max_by_key(|(fit, _)| *fit);
    let (fit, set) = best?;
    let named_together = single && host.place.is_none();
    let is_slip = || single && host.lookups().iter().any(|l| nearest(l.base_name(), names(&set)).is_some());
    if fit.names == 0 && !named_together && !is_slip() {
        return None;
    }
    Program::new(set, true)
}

/// Names of the attributes and uniforms of a set.
fn names<'p>(set: &[&'p ShaderFile]) -> impl Iterator<Item = &'p str> {
    let vertex = set.iter().copied().filter(|s| s.shader.stage() == syntax::Stage::Vertex);
    let inputs = vertex.flat_map(|s| s.shader.interface().inputs.iter());
    let uniforms = set.iter().copied().flat_map(|s| s.shader.interface().uniforms.iter());
    inputs.chain(uniforms).map(|v| v.name.as_str()).collect::<Vec<_>>().into_iter()
}

fn fit(host: &HostFile, set: &[&ShaderFile], words: &BTreeSet<&str>) -> Fit {
    let known: BTreeSet<&str> = names(set).collect();
    let in_block = |name: &str| {
        set.iter().any(|s| s.shader.interface().blocks.iter().any(|b| b.members.iter().any(|m| m.name.name == name)))
    };
    let looked_up: BTreeSet<&str> = host.lookups().iter().map(|l| l.base_name()).collect();
    let found = looked_up.iter().filter(|n| known.contains(**n) || in_block(n)).count();
    // A variable for a location says best what is meant: `parameterLoc`.
    let speaking = known.iter().filter(|n| words.iter().any(|w| is_location_of(w, n))).count();
    let same = known.iter().filter(|n| n.len() > 2 && words.contains(**n)).count();
    let order = |s: &&ShaderFile| s.place.as_ref().map(|p| p.order);
    let (first, last) = (set.iter().filter_map(order).min(), set.iter().filter_map(order).max());
    let place = host.place.as_ref();
    let at = place.map_or(0, |p| p.order);
    let shared = |s: &&ShaderFile| Some(s.place.as_ref()?.shared(place?));
    Fit {
        names: found + 2 * speaking + same,
        all: found == looked_up.len(),
        section: set.iter().filter_map(shared).max().unwrap_or(0),
        before: last.is_some_and(|l| l < at),
        near: std::cmp::Reverse(first.map_or(0, |f| f.abs_diff(at)).min(last.map_or(0, |l| l.abs_diff(at)))),
    }
}

/// True for the name of a variable that keeps the location of `name`.
fn is_location_of(word: &str, name: &str) -> bool {
    let (word, name) = (word.to_ascii_lowercase(), name.to_ascii_lowercase());
    let around = word.strip_prefix(&name).or_else(|| word.strip_suffix(&name));
    around.is_some_and(|rest| ["loc", "location", "locationof", "locof"].contains(&rest.trim_matches('_')))
}
