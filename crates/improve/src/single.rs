//! Terms in binary32, as a device gives them that rounds every operation correctly, and what they lose.

use egg::{Id, Language};

use crate::error::WORST;
use crate::graph::{Points, values};
use crate::term::{Binary, Node, Term, Unary, rooted};

/// What a term is in real numbers at each point, rounded to binary64.
///
/// # Errors
/// When there is no memory for numbers of many bits.
pub fn reference(term: &Term, points: &Points) -> Result<Vec<f64>, String> {
    let all = values(term, points)?;
    Ok(all.last().map_or_else(Vec::new, |root| root.near.to_vec()))
}

/// What a term gives in binary32 at each point.
pub fn run(term: &Term, points: &Points) -> Vec<f32> {
    let columns = ColumnsOf { number: single, leaf: |x| x, unary, binary };
    columns.run(term, points)
}

/// What a term gives in binary64, which is what it is in real numbers where little cancels.
pub fn wide(term: &Term, points: &Points) -> Vec<f64> {
    let columns = ColumnsOf { number: |x| x, leaf: f64::from, unary: wide_unary, binary: wide_binary };
    columns.run(term, points)
}

/// Operations on numbers of a kind.
struct ColumnsOf<T> {
    number: fn(f64) -> T,
    leaf: fn(f32) -> T,
    unary: fn(Unary, T) -> T,
    binary: fn(Binary, T, T) -> T,
}

impl<T: Copy> ColumnsOf<T> {
    fn run(&self, term: &Term, points: &Points) -> Vec<T> {
        let mut columns: Vec<Vec<T>> = Vec::with_capacity(term.len());
        for node in term {
            let column = match node {
                Node::Number(c) => vec![(self.number)(c.value()); points.len()],
                Node::Pi => vec![(self.number)(std::f64::consts::PI); points.len()],
                Node::Leaf(k) => points.leaf(*k).iter().map(|x| (self.leaf)(*x)).collect(),
                Node::Unary(f, x) => columns[usize::from(*x)].iter().map(|x| (self.unary)(*f, *x)).collect(),
                Node::Binary(f, [a, b]) => {
                    let (a, b) = (&columns[usize::from(*a)], &columns[usize::from(*b)]);
                    a.iter().zip(b).map(|(a, b)| (self.binary)(*f, *a, *b)).collect()
                }
            };
            columns.push(column);
        }
        columns.pop().unwrap_or_default()
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounded once")]
fn single(x: f64) -> f32 {
    x as f32
}

/// Square roots and what is exact are done in binary32; everything else is rounded once.
fn unary(f: Unary, x: f32) -> f32 {
    match f {
        Unary::Neg => -x,
        Unary::Abs => x.abs(),
        Unary::Sqrt => x.sqrt(),
        _ => single(wide_unary(f, f64::from(x))),
    }
}

fn binary(f: Binary, a: f32, b: f32) -> f32 {
    match f {
        Binary::Add => a + b,
        Binary::Sub => a - b,
        Binary::Mul => a * b,
        Binary::Div => a / b,
        Binary::Pow | Binary::Atan2 | Binary::Min | Binary::Max => single(wide_binary(f, f64::from(a), f64::from(b))),
    }
}

fn wide_unary(f: Unary, x: f64) -> f64 {
    match f {
        Unary::Neg => -x,
        Unary::Abs => x.abs(),
        Unary::Sqrt => x.sqrt(),
        Unary::SafeSqrt => x.max(0.0).sqrt(),
        Unary::InverseSqrt => 1.0 / x.sqrt(),
        Unary::Sin => x.sin(),
        Unary::Cos => x.cos(),
        Unary::Tan => x.tan(),
        Unary::Asin => x.asin(),
        Unary::Acos => x.acos(),
        Unary::SafeAsin => x.clamp(-1.0, 1.0).asin(),
        Unary::SafeAcos => x.clamp(-1.0, 1.0).acos(),
        Unary::Atan => x.atan(),
        Unary::Sinh => x.sinh(),
        Unary::Cosh => x.cosh(),
        Unary::Tanh => x.tanh(),
        Unary::Asinh => x.asinh(),
        Unary::Acosh => x.acosh(),
        Unary::Atanh => x.atanh(),
        Unary::Exp => x.exp(),
        Unary::Log => x.ln(),
        Unary::Exp2 => x.exp2(),
        Unary::Log2 => x.log2(),
    }
}

fn wide_binary(f: Binary, a: f64, b: f64) -> f64 {
    match f {
        Binary::Add => a + b,
        Binary::Sub => a - b,
        Binary::Mul => a * b,
        Binary::Div => a / b,
        Binary::Pow if a < 0.0 => f64::NAN,
        Binary::Pow => a.powf(b),
        Binary::Atan2 => a.atan2(b),
        Binary::Min => a.min(b),
        Binary::Max => a.max(b),
    }
}

/// Bits that are lost at each point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Losses(pub Vec<f64>);

impl Losses {
    /// Of what binary32 gives and what is right.
    pub fn of(found: &[f32], exact: &[f64]) -> Self {
        Self(found.iter().zip(exact).map(|(found, exact)| lost(*found, *exact)).collect())
    }

    /// The mean.
    pub fn mean(&self) -> f64 {
        if self.0.is_empty() { 0.0 } else { self.0.iter().sum::<f64>() / self.0.len() as f64 }
    }

    /// The most at one point.
    pub fn worst(&self) -> f64 {
        self.0.iter().copied().fold(0.0, f64::max)
    }
}

/// log2(1 + d) for numbers of binary32 that are d apart; [`WORST`] for what is no number.
fn lost(found: f32, exact: f64) -> f64 {
    let right = single(exact);
    if found.is_nan() || right.is_nan() {
        return WORST;
    }
    let place = |x: f32| {
        let bits = i64::from(x.to_bits() & 0x7fff_ffff);
        if x.is_sign_negative() { -bits } else { bits }
    };
    (1.0 + (place(found) - place(right)).unsigned_abs() as f64).log2().min(WORST)
}

/// A term with its constant parts as numbers: what a front end gives a device.
pub fn folded(term: &Term) -> Term {
    let mut folded = Term::default();
    let mut ids: Vec<Id> = Vec::with_capacity(term.len());
    let mut constants: Vec<Option<f64>> = Vec::with_capacity(term.len());
    for node in term {
        let operands: Option<Vec<f64>> = node.children().iter().map(|id| constants[usize::from(*id)]).collect();
        let constant = operands.and_then(|operands| constant(node, &operands));
        let new = match constant {
            Some(value) => Node::number(value),
            None => node.map_children(|id| ids[usize::from(id)]),
        };
        ids.push(folded.add(new));
        constants.push(constant);
    }
    reachable(&folded)
}

/// A term without the nodes that its root does not need.
fn reachable(term: &Term) -> Term {
    let Some(root) = term.len().checked_sub(1) else { return Term::default() };
    rooted(term, Id::from(root))
}

fn constant(node: &Node, of: &[f64]) -> Option<f64> {
    let value = match (node, of) {
        (Node::Number(c), _) => c.value(),
        (Node::Pi, _) => std::f64::consts::PI,
        (Node::Unary(Unary::Neg, _), [x]) => -x,
        (Node::Unary(Unary::Sqrt, _), [x]) => x.sqrt(),
        (Node::Unary(Unary::InverseSqrt, _), [x]) => 1.0 / x.sqrt(),
        (Node::Unary(Unary::Log, _), [x]) => x.ln(),
        (Node::Unary(Unary::Exp, _), [x]) => x.exp(),
        (Node::Binary(Binary::Add, _), [a, b]) => a + b,
        (Node::Binary(Binary::Sub, _), [a, b]) => a - b,
        (Node::Binary(Binary::Mul, _), [a, b]) => a * b,
        (Node::Binary(Binary::Div, _), [a, b]) => a / b,
        _ => return None,
    };
    value.is_finite().then_some(value)
}
