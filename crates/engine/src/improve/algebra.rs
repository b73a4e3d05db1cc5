//! Vectors as terms: what is done to each component, and what reduces vectors to numbers.

use ::improve::{Binary, Id, Node, Term, Unary};

/// The smallest number of binary32 with all of its digits.
const LEAST: f64 = f32::MIN_POSITIVE as f64;

/// A node, which is there already or is put at the end.
pub(super) fn add(term: &mut Term, node: Node) -> Id {
    match term.iter().position(|known| *known == node) {
        Some(k) => Id::from(k),
        None => term.add(node),
    }
}

pub(super) fn unary(term: &mut Term, of: Unary, x: Id) -> Id {
    add(term, Node::Unary(of, x))
}

pub(super) fn binary(term: &mut Term, of: Binary, a: Id, b: Id) -> Id {
    add(term, Node::Binary(of, [a, b]))
}

/// An operation on each component; a number is taken for all of them. None for vectors of different sizes.
pub(super) fn zip(term: &mut Term, of: Binary, a: &[Id], b: &[Id]) -> Option<Vec<Id>> {
    let count = a.len().max(b.len());
    let fits = |side: &[Id]| side.len() == count || side.len() == 1;
    (fits(a) && fits(b))
        .then(|| (0..count).map(|k| binary(term, of, a[k.min(a.len() - 1)], b[k.min(b.len() - 1)])).collect())
}

/// a · b, added up from the first component on.
pub(super) fn dot(term: &mut Term, a: &[Id], b: &[Id]) -> Id {
    let products: Vec<Id> = a.iter().zip(b).map(|(a, b)| binary(term, Binary::Mul, *a, *b)).collect();
    let sum = products.into_iter().reduce(|sum, next| binary(term, Binary::Add, sum, next));
    sum.unwrap_or_else(|| add(term, Node::number(0.0)))
}

/// √(a · a)
pub(super) fn length(term: &mut Term, a: &[Id]) -> Id {
    let square = dot(term, a, a);
    unary(term, Unary::Sqrt, square)
}

/// a ÷ √(a · a)
pub(super) fn normalized(term: &mut Term, a: &[Id]) -> Vec<Id> {
    let length = length(term, a);
    a.iter().map(|x| binary(term, Binary::Div, *x, length)).collect()
}

/// a × b, of three components.
pub(super) fn cross(term: &mut Term, a: &[Id], b: &[Id]) -> Option<Vec<Id>> {
    (a.len() == 3 && b.len() == 3).then(|| {
        (0..3)
            .map(|k| {
                let (next, last) = ((k + 1) % 3, (k + 2) % 3);
                let (p, q) = (binary(term, Binary::Mul, a[next], b[last]), binary(term, Binary::Mul, a[last], b[next]));
                binary(term, Binary::Sub, p, q)
            })
            .collect()
    })
}

/// The largest size of a component, and no less than the smallest normal number, with the vector over it: its squares
/// neither overflow nor vanish.
pub(super) fn scaled(term: &mut Term, a: &[Id]) -> (Id, Vec<Id>) {
    let sizes: Vec<Id> = a.iter().map(|x| unary(term, Unary::Abs, *x)).collect();
    let least = add(term, Node::number(LEAST));
    let most = sizes.into_iter().reduce(|most, next| binary(term, Binary::Max, most, next));
    let most = most.map_or(least, |most| binary(term, Binary::Max, most, least));
    let over = a.iter().map(|x| binary(term, Binary::Div, *x, most)).collect();
    (most, over)
}
