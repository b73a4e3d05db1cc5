//! The rules: what else an expression is in real numbers.
//!
//! A rule holds wherever its left side has a value and its guards hold, but for single points at which the right side has
//! none. Guards are looked up at the points of the graph, all of which must keep them, and so is whether both sides have one
//! value there: a rule that is wrong at a point changes nothing. What is proposed is proved apart from the rules.

mod algebra;
mod exponential;
mod trigonometric;

use egg::{Applier, Id, Pattern, PatternAst, Rewrite, Subst, Symbol, Var};

use crate::graph::{Graph, Reals};
use crate::real::{is_finite, same};
use crate::term::Node;

/// A rule as it is written.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// Its name.
    pub name: &'static str,
    /// The pattern that it finds.
    pub from: &'static str,
    /// What that is as well.
    pub to: &'static str,
    /// What must hold of variables: `?a>0 ?b!=0`; the numbers before the signs are variables of the left side.
    pub guards: &'static str,
}

/// Shorthand for tables.
const fn rule(name: &'static str, from: &'static str, to: &'static str, guards: &'static str) -> Rule {
    Rule { name, from, to, guards }
}

/// All rules.
pub fn all() -> Vec<Rule> {
    [algebra::RULES, trigonometric::RULES, exponential::RULES].concat()
}

/// A condition on the value of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// x > 0
    Positive,
    /// x ≥ 0
    NonNegative,
    /// x ≤ 0
    NonPositive,
    /// x ≠ 0
    NonZero,
    /// |x| ≤ 1
    Unit,
    /// |x| < 1
    InsideUnit,
    /// x ≥ 1
    AtLeastOne,
    /// |x| ≤ π/2
    QuarterTurn,
    /// A number that is the same everywhere.
    Constant,
    /// No number that is the same everywhere.
    Varying,
}

/// Signs of conditions, longer ones first.
const SIGNS: [(&str, Condition); 10] = [
    (">=0", Condition::NonNegative),
    ("<=0", Condition::NonPositive),
    ("!=0", Condition::NonZero),
    (">=1", Condition::AtLeastOne),
    (">0", Condition::Positive),
    ("in[-1,1]", Condition::Unit),
    ("in(-1,1)", Condition::InsideUnit),
    ("in[-pi/2,pi/2]", Condition::QuarterTurn),
    (":constant", Condition::Constant),
    (":varying", Condition::Varying),
];

impl Condition {
    /// True for a number that keeps it. Whether something varies no number tells.
    pub fn holds(self, x: f64) -> bool {
        match self {
            Self::Positive => x > 0.0,
            Self::NonNegative => x >= 0.0,
            Self::NonPositive => x <= 0.0,
            Self::NonZero => x != 0.0 && !x.is_nan(),
            Self::Unit => x.abs() <= 1.0,
            Self::InsideUnit => x.abs() < 1.0,
            Self::AtLeastOne => x >= 1.0,
            Self::QuarterTurn => x.abs() <= std::f64::consts::FRAC_PI_2,
            Self::Constant | Self::Varying => true,
        }
    }
}

impl Rule {
    /// The conditions, each with its variable.
    ///
    /// # Errors
    /// A guard that cannot be read.
    pub fn conditions(&self) -> Result<Vec<(Var, Condition)>, String> {
        let one = |guard: &str| {
            let bad = || format!("rule `{}`: guard `{guard}` cannot be read", self.name);
            let (sign, condition) = SIGNS.iter().find(|(sign, _)| guard.ends_with(sign)).ok_or_else(bad)?;
            let var = guard.strip_suffix(sign).and_then(|name| name.parse().ok()).ok_or_else(bad)?;
            Ok((var, *condition))
        };
        self.guards.split_whitespace().map(one).collect()
    }

    /// The rule for the graph.
    ///
    /// # Errors
    /// A side or guard that cannot be read.
    pub fn rewrite(&self) -> Result<Rewrite<Node, Reals>, String> {
        let pattern = |text: &str| -> Result<Pattern<Node>, String> {
            text.parse().map_err(|error: egg::RecExprParseError<_>| format!("rule `{}`: {error}", self.name))
        };
        let (from, to, conditions) = (pattern(self.from)?, pattern(self.to)?, self.conditions()?);
        Rewrite::new(self.name, from, Checked { to, conditions })
    }
}

/// The right side, which must have the values of the left side at the points.
struct Checked {
    to: Pattern<Node>,
    conditions: Vec<(Var, Condition)>,
}

impl Checked {
    fn allows(&self, graph: &Graph, subst: &Subst) -> bool {
        self.conditions.iter().all(|(var, condition)| {
            let known = &graph[subst[*var]].data;
            match condition {
                Condition::Constant => known.constant.is_some(),
                Condition::Varying => known.constant.is_none(),
                _ => known.near.iter().all(|x| condition.holds(*x)),
            }
        })
    }
}

impl Applier<Node, Reals> for Checked {
    fn apply_one(
        &self,
        graph: &mut Graph,
        class: Id,
        subst: &Subst,
        _: Option<&PatternAst<Node>>,
        _: Symbol,
    ) -> Vec<Id> {
        if !self.allows(graph, subst) {
            return Vec::new();
        }
        let new = graph.add_instantiation(&self.to.ast, subst);
        let (from, to) = (&graph[class].data.reals, &graph[new].data.reals);
        let (mut left, mut both) = (false, false);
        for (a, b) in from.iter().zip(to.iter()) {
            left |= is_finite(a);
            if is_finite(a) && is_finite(b) {
                both = true;
                if !same(a, b) {
                    graph.analysis.conflicts += 1;
                    return Vec::new();
                }
            }
        }
        // What has no value anywhere, such as 0 ÷ 0, is equal to nothing.
        if left && !both {
            return Vec::new();
        }
        if graph.union(class, new) { vec![new] } else { Vec::new() }
    }

    fn vars(&self) -> Vec<Var> {
        self.to.vars()
    }
}
