//! Terms as text of a shader.

use egg::Id;

use crate::lift;
use crate::regimes::Split;
use crate::single::folded;
use crate::term::{Binary, Node, Term, Unary};

/// An input of a term, as it is written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeafText {
    /// Its text.
    pub text: String,
    /// The vector that it is a component of.
    pub of: Option<Component>,
}

/// A component of a vector.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Component {
    /// The text of the vector.
    pub vector: String,
    /// Which component, from 0.
    pub index: usize,
    /// How many there are.
    pub count: usize,
}

impl From<String> for LeafText {
    fn from(text: String) -> Self {
        Self { text, of: None }
    }
}

/// The language of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// GLSL with hyperbolic functions: from 1.30, and ES from 3.00.
    Glsl,
    /// WGSL.
    Wgsl,
}

/// How tightly an operator binds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Level {
    Sum,
    Product,
    Sign,
    Whole,
}

/// A choice of terms as an expression, where `leaves` are the texts of the inputs. A leaf that is no name, call or part of
/// one is put in parentheses. What is done to all components of a vector is written for the vector.
pub fn written(split: &Split, terms: &[Term], leaves: &[LeafText], dialect: Dialect) -> String {
    match split {
        Split::Term(k) => text(&folded(&terms[*k]), leaves, dialect),
        Split::At { leaf, absolute, threshold, below, above } => {
            let leaf = wrapped(&leaves[*leaf as usize].text);
            let key = if *absolute { format!("abs({})", bare(&leaf)) } else { leaf };
            let number = number(f64::from(*threshold));
            let side = |side: &Split| match side {
                Split::Term(_) => written(side, terms, leaves, dialect),
                Split::At { .. } => format!("({})", written(side, terms, leaves, dialect)),
            };
            match dialect {
                Dialect::Glsl => format!("{key} < {number} ? {} : {}", side(below), side(above)),
                Dialect::Wgsl => {
                    let [below, above] = [below, above].map(|side| written(side, terms, leaves, dialect));
                    format!("select({above}, {below}, {key} < {number})")
                }
            }
        }
    }
}

fn text(term: &Term, leaves: &[LeafText], dialect: Dialect) -> String {
    match term.len().checked_sub(1) {
        Some(root) => Writer { term, leaves, dialect }.node(Id::from(root)).0,
        None => String::new(),
    }
}

pub(crate) struct Writer<'a> {
    pub(crate) term: &'a Term,
    pub(crate) leaves: &'a [LeafText],
    dialect: Dialect,
}

impl Writer<'_> {
    pub(crate) fn node(&self, id: Id) -> (String, Level) {
        if let Some(text) = lift::reduction(self, id) {
            return (text, Level::Whole);
        }
        match self.term[id] {
            Node::Number(c) => (number(c.value()), if c.value() < 0.0 { Level::Sign } else { Level::Whole }),
            Node::Pi => (number(std::f64::consts::PI), Level::Whole),
            Node::Leaf(k) => (wrapped(&self.leaves[k as usize].text), Level::Whole),
            Node::Unary(Unary::Neg, x) => (format!("-{}", self.at_least(x, Level::Whole)), Level::Sign),
            Node::Unary(f, x) => (self.call(f, &self.node(x).0), Level::Whole),
            Node::Binary(op, [a, b]) => {
                let (sign, level) = match op {
                    Binary::Add => ("+", Level::Sum),
                    Binary::Sub => ("-", Level::Sum),
                    Binary::Mul => ("*", Level::Product),
                    Binary::Div => ("/", Level::Product),
                    Binary::Pow | Binary::Atan2 | Binary::Min | Binary::Max => {
                        let name = match (op, self.dialect) {
                            (Binary::Pow, _) => "pow",
                            (Binary::Min, _) => "min",
                            (Binary::Max, _) => "max",
                            (_, Dialect::Glsl) => "atan",
                            (_, Dialect::Wgsl) => "atan2",
                        };
                        return (format!("{name}({}, {})", bare(&self.node(a).0), bare(&self.node(b).0)), Level::Whole);
                    }
                };
                // The order of operations is the one that was measured.
                (joined(self.node(a), sign, self.node(b), level), level)
            }
        }
    }

    fn at_least(&self, id: Id, least: Level) -> String {
        at_least(self.node(id), least)
    }

    fn call(&self, f: Unary, x: &str) -> String {
        let x = bare(x);
        let name = match f {
            Unary::SafeSqrt => return format!("sqrt(max({x}, 0.0))"),
            Unary::SafeAsin => return format!("asin(clamp({x}, -1.0, 1.0))"),
            Unary::SafeAcos => return format!("acos(clamp({x}, -1.0, 1.0))"),
            Unary::InverseSqrt if self.dialect == Dialect::Wgsl => "inverseSqrt",
            _ => f.name(),
        };
        format!("{name}({x})")
    }
}

/// An operator between two operands; what stands on its right binds more tightly.
pub(crate) fn joined(left: (String, Level), sign: &str, right: (String, Level), level: Level) -> String {
    let above = if level == Level::Sum { Level::Product } else { Level::Sign };
    format!("{} {sign} {}", at_least(left, level), at_least(right, above))
}

pub(crate) fn at_least((text, level): (String, Level), least: Level) -> String {
    if level < least { format!("({text})") } else { text }
}

/// A leaf as an operand.
pub(crate) fn wrapped(leaf: &str) -> String {
    let mut depth = 0_i32;
    let plain = leaf.chars().all(|c| {
        depth += i32::from("([".contains(c)) - i32::from(")]".contains(c));
        depth > 0 || c.is_alphanumeric() || "_.)]".contains(c)
    });
    if plain { leaf.to_owned() } else { format!("({leaf})") }
}

/// An argument of a function needs no parentheses around it.
pub(crate) fn bare(text: &str) -> &str {
    let Some(inside) = text.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) else { return text };
    let mut depth = 0_i32;
    let closes = inside.chars().any(|c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        depth < 0
    });
    if closes || inside.contains(',') { text } else { inside }
}

/// A literal of binary32 with as few digits as give the number; one that is nearest to a number of binary64 with as many as
/// show which.
#[expect(clippy::cast_possible_truncation, reason = "a literal of binary32")]
pub fn number(value: f64) -> String {
    let single = value as f32;
    let exact = f64::from(single) == value;
    let short = if exact {
        format!("{single:?}")
    } else {
        format!("{:?}", format!("{value:.10e}").parse::<f64>().unwrap_or(value))
    };
    if short.contains(['.', 'e']) { short } else { format!("{short}.0") }
}
