//! Terms as text of a shader.

use egg::Id;

use crate::regimes::Split;
use crate::single::folded;
use crate::term::{Binary, Node, Term, Unary};

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
enum Level {
    Sum,
    Product,
    Sign,
    Whole,
}

/// A choice of terms as an expression, where `leaves` are the texts of the inputs. A leaf that is no name, call or part of
/// one is put in parentheses.
pub fn written(split: &Split, terms: &[Term], leaves: &[String], dialect: Dialect) -> String {
    match split {
        Split::Term(k) => text(&folded(&terms[*k]), leaves, dialect),
        Split::At { leaf, absolute, threshold, below, above } => {
            let leaf = wrapped(&leaves[*leaf as usize]);
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

fn text(term: &Term, leaves: &[String], dialect: Dialect) -> String {
    match term.len().checked_sub(1) {
        Some(root) => Writer { term, leaves, dialect }.node(Id::from(root)).0,
        None => String::new(),
    }
}

struct Writer<'a> {
    term: &'a Term,
    leaves: &'a [String],
    dialect: Dialect,
}

impl Writer<'_> {
    fn node(&self, id: Id) -> (String, Level) {
        match self.term[id] {
            Node::Number(c) => (number(c.value()), if c.value() < 0.0 { Level::Sign } else { Level::Whole }),
            Node::Pi => (number(std::f64::consts::PI), Level::Whole),
            Node::Leaf(k) => (wrapped(&self.leaves[k as usize]), Level::Whole),
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
                let above = if level == Level::Sum { Level::Product } else { Level::Sign };
                (format!("{} {sign} {}", self.at_least(a, level), self.at_least(b, above)), level)
            }
        }
    }

    fn at_least(&self, id: Id, least: Level) -> String {
        let (text, level) = self.node(id);
        if level < least { format!("({text})") } else { text }
    }

    fn call(&self, f: Unary, x: &str) -> String {
        let x = bare(x);
        let name = match f {
            Unary::SafeSqrt => return format!("sqrt(max({x}, 0.0))"),
            Unary::SafeAsin => return format!("asin(clamp({x}, -1.0, 1.0))"),
            Unary::SafeAcos => return format!("acos(clamp({x}, -1.0, 1.0))"),
            Unary::InverseSqrt if self.dialect == Dialect::Wgsl => "inverseSqrt",
            _ => crate::term::UNARY.iter().find(|(of, _)| *of == f).map_or("", |(_, name)| name),
        };
        format!("{name}({x})")
    }
}

/// A leaf as an operand.
fn wrapped(leaf: &str) -> String {
    let mut depth = 0_i32;
    let plain = leaf.chars().all(|c| {
        depth += i32::from("([".contains(c)) - i32::from(")]".contains(c));
        depth > 0 || c.is_alphanumeric() || "_.)]".contains(c)
    });
    if plain { leaf.to_owned() } else { format!("({leaf})") }
}

/// An argument of a function needs no parentheses around it.
fn bare(text: &str) -> &str {
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
