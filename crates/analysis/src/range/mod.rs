//! Which values an expression can take: abstract interpretation of a shader over intervals (Cousot and
//! Cousot 1977), one a component of scalars and vectors.
//!
//! Calls are followed with the ranges of their arguments, conditions narrow what they compare, and
//! loops are widened until nothing changes. An interval holds every value that is possible. That its
//! ends are met is another question, and told apart by [`Evidence`]: rules speak of a hazard where the
//! text shows it, and not where nothing is known.

mod bits;
mod builtin;
mod eval;
mod exec;
mod key;
mod operator;
mod refine;
mod start;
mod state;
#[cfg(test)]
mod tests;
mod transfer;
mod value;

use std::collections::BTreeMap;

pub use start::specialized;
pub use transfer::UNIT_SLACK;
pub use value::{Evidence, Range, Value};

use syntax::Shader;
use syntax::ast::ExprId;
use syntax::symbols::{CallTarget, SymbolId};

/// Values that a uniform, attribute or other input takes, in every component.
#[derive(Clone, Debug, PartialEq)]
pub struct Stated {
    /// Name of the variable, members behind a point (`material.shininess`).
    pub name: String,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
}

/// The stated range of a variable, the first of that name.
pub fn stated(all: &[Stated], name: &str) -> Option<(f64, f64)> {
    all.iter().find(|r| r.name == name).map(|r| (r.min, r.max))
}

/// The operands of a call or operator at one visit.
#[derive(Clone, Debug, PartialEq)]
pub struct Visit {
    /// Values of the operands, in the order of the text.
    pub operands: Vec<Value>,
}

/// What came up at the calls of built-in functions, at the infix operators and at the indices of a shader.
#[derive(Clone, Debug, Default)]
pub struct Observed {
    visits: BTreeMap<ExprId, Vec<Visit>>,
}

/// Visits of one place that are kept apart; those beyond are not kept.
const MOST_VISITS: usize = 12;

impl Observed {
    /// Follows a shader from `main`, then the functions that `main` does not reach with arguments
    /// of which nothing is known.
    pub fn new(shader: &Shader, stated: &[Stated]) -> Self {
        let mut machine = eval::Machine::new(shader, stated);
        machine.run();
        Self { visits: machine.visits }
    }

    /// For the parameters of functions that the text calls, one range over all components and calls; those of which
    /// nothing is known are left out, as are those of functions that no call reaches.
    pub fn passed(&self, shader: &Shader) -> BTreeMap<SymbolId, [f64; 2]> {
        let mut all: BTreeMap<SymbolId, [f64; 2]> = BTreeMap::new();
        for (&id, visits) in &self.visits {
            let Some(CallTarget::User(function)) = shader.callee(id) else { continue };
            for (k, param) in shader.function_info(*function).params.iter().enumerate() {
                let Some(symbol) = param.symbol else { continue };
                let hull =
                    |visit: &Visit| visit.operands.get(k).and_then(Value::hull).map(|range| [range.lo, range.hi]);
                let unknown = [f64::NEG_INFINITY, f64::INFINITY];
                // Of those beyond the last one that is kept, nothing is known.
                let cut_off = visits.len() >= MOST_VISITS;
                let here = visits.iter().map(|visit| hull(visit).filter(|_| !cut_off).unwrap_or(unknown));
                let before = all.get(&symbol).copied();
                let joined = before.into_iter().chain(here).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
                all.extend(joined.map(|range| (symbol, range)));
            }
        }
        all.retain(|_, range| range.iter().any(|end| end.is_finite()));
        all
    }

    /// The visits of a call, operator or element; none when it is never reached.
    pub fn visits(&self, id: ExprId) -> &[Visit] {
        self.visits.get(&id).map_or(&[], Vec::as_slice)
    }
}

/// The range of each component of an expression, over all ways that lead to it; none where it is never reached, or is
/// no number. `stated` has the ranges of inputs.
pub fn of_expression(shader: &Shader, stated: &[Stated], id: ExprId) -> Option<Vec<Derived>> {
    let mut machine = eval::Machine::new(shader, stated);
    machine.watched = Some((id, None));
    machine.run();
    let (_, gave) = machine.watched?;
    let derived = |part: &Range| Derived { lo: part.lo, hi: part.hi, nan: part.nan };
    gave.map(|value| value.parts.iter().map(derived).collect()).filter(|parts: &Vec<Derived>| !parts.is_empty())
}

/// Every value that one component of an expression can have lies between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derived {
    /// Least value; minus infinity where nothing is known.
    pub lo: f64,
    /// Greatest value; infinity where nothing is known.
    pub hi: f64,
    /// True when it may be NaN as well.
    pub nan: bool,
}

/// The spelling of an expression without side effects by which equal ones are recognised.
pub fn key(shader: &Shader, id: ExprId) -> Option<String> {
    key::of(shader, id)
}
