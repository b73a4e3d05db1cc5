//! What a text passes to the functions that it has.

use std::collections::BTreeMap;

use super::Guess;
use analysis::range::{Observed, UNIT_SLACK};
use syntax::symbols::SymbolId;
use syntax::{Shader, Stage};

/// Ranges of the arguments of all calls in a text that has the entry points of its functions. Others may call those of a
/// library with anything.
#[derive(Debug, Default)]
pub struct Passed {
    ranges: BTreeMap<SymbolId, [f64; 2]>,
}

impl Passed {
    /// Of a text.
    pub fn of(shader: &Shader) -> Self {
        let entered = match shader.wgsl() {
            Some(module) => !module.entry_points.is_empty(),
            None => shader.stage() != Stage::Library && shader.functions().any(|(_, info)| info.name.name == "main"),
        };
        let calls = shader.functions().count() > 1;
        let ranges = if entered && calls { Observed::new(shader, &[]).passed(shader) } else { BTreeMap::new() };
        Self { ranges }
    }

    /// A guess about a parameter, with what it gets.
    pub fn narrowed(&self, guess: Guess, parameter: Option<SymbolId>) -> Guess {
        match parameter.and_then(|parameter| self.to(parameter)) {
            Some(ends) => guess.passed(ends),
            None => guess,
        }
    }

    /// Both ends of what a parameter gets, in any component; infinite where nothing is known.
    fn to(&self, parameter: SymbolId) -> Option<[f64; 2]> {
        // The length of a unit vector is 1 but for its rounding, which is no value of its own.
        let plain = |end: f64| if (end.abs() - 1.0).abs() <= 2.0 * UNIT_SLACK { end.signum() } else { end };
        self.ranges.get(&parameter).map(|range| range.map(plain))
    }
}
