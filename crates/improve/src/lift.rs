//! What is done to each component of a vector, written for the vector: `dot`, `length`, `cross`.

use egg::Id;

use crate::term::{Binary, Node, Unary};
use crate::write::{Level, Writer, at_least, bare, joined, wrapped};

/// A sum of products of components as `dot`, and its root as `length`.
pub(crate) fn reduction(writer: &Writer<'_>, id: Id) -> Option<String> {
    let (sum, root) = match writer.term[id] {
        Node::Unary(Unary::Sqrt, under) => (under, true),
        _ => (id, false),
    };
    let products = summands(writer, sum)?;
    let side = |k: usize| -> Option<String> {
        let ids: Vec<Id> = products.iter().map(|pair| pair[k]).collect();
        vector(writer, &ids).map(|(text, _)| bare(&text).to_owned())
    };
    let (a, b) = (side(0)?, side(1)?);
    match (root, a == b) {
        (true, true) => Some(format!("length({a})")),
        (true, false) => None,
        (false, _) => Some(format!("dot({a}, {b})")),
    }
}

/// The factors of two to four products that are added up from the left.
fn summands(writer: &Writer<'_>, sum: Id) -> Option<Vec<[Id; 2]>> {
    let mut products = Vec::new();
    let mut rest = sum;
    loop {
        match writer.term[rest] {
            Node::Binary(Binary::Add, [before, last]) if products.len() < 3 => {
                let Node::Binary(Binary::Mul, factors) = writer.term[last] else { return None };
                products.push(factors);
                rest = before;
            }
            Node::Binary(Binary::Mul, factors) if !products.is_empty() => {
                products.push(factors);
                products.reverse();
                return Some(products);
            }
            _ => return None,
        }
    }
}

/// Nodes that are the components of one vector, in their order, as that vector; scalars may scale it.
fn vector(writer: &Writer<'_>, ids: &[Id]) -> Option<(String, Level)> {
    if let Some(name) = whole(writer, ids) {
        return Some((wrapped(&name), Level::Whole));
    }
    if let Some(text) = cross(writer, ids) {
        return Some((text, Level::Whole));
    }
    let first = writer.term[*ids.first()?];
    let sides = |k: usize| -> Option<Vec<Id>> {
        ids.iter()
            .map(|id| match (first, writer.term[*id]) {
                (Node::Binary(op, _), Node::Binary(own, sides)) if op == own => Some(sides[k]),
                _ => None,
            })
            .collect()
    };
    let (sign, level) = match first {
        Node::Unary(Unary::Neg, _) => {
            let of = |id: &Id| match writer.term[*id] {
                Node::Unary(Unary::Neg, x) => Some(x),
                _ => None,
            };
            let under: Vec<Id> = ids.iter().map(of).collect::<Option<_>>()?;
            return Some((format!("-{}", at_least(vector(writer, &under)?, Level::Whole)), Level::Sign));
        }
        Node::Binary(Binary::Add, _) => ("+", Level::Sum),
        Node::Binary(Binary::Sub, _) => ("-", Level::Sum),
        Node::Binary(Binary::Mul, _) => ("*", Level::Product),
        Node::Binary(Binary::Div, _) => ("/", Level::Product),
        _ => return None,
    };
    let (left, right) = (sides(0)?, sides(1)?);
    let scales = level == Level::Product;
    let operand = |ids: &[Id]| {
        // A number that is the same for all components.
        let same = scales && ids.iter().all(|id| *id == ids[0]);
        if same { Some(writer.node(ids[0])) } else { vector(writer, ids) }
    };
    let is_vector = |ids: &[Id]| ids.iter().any(|id| *id != ids[0]);
    (is_vector(&left) || is_vector(&right))
        .then(|| Some((joined(operand(&left)?, sign, operand(&right)?, level), level)))
        .flatten()
}

/// The vector of which these are all components.
fn whole(writer: &Writer<'_>, ids: &[Id]) -> Option<String> {
    let component = |id: Id| match writer.term[id] {
        Node::Leaf(k) => writer.leaves[k as usize].of.as_ref(),
        _ => None,
    };
    let first = component(*ids.first()?)?;
    let fits = |(k, id): (usize, &Id)| {
        component(*id).is_some_and(|c| c.vector == first.vector && c.index == k && c.count == ids.len())
    };
    ids.iter().enumerate().all(fits).then(|| first.vector.clone())
}

/// The components of a cross product.
fn cross(writer: &Writer<'_>, ids: &[Id]) -> Option<String> {
    if ids.len() != 3 {
        return None;
    }
    // The first component has the second and third of both vectors, the others name the first.
    let parts: Vec<[[Id; 2]; 2]> = ids
        .iter()
        .map(|id| match writer.term[*id] {
            Node::Binary(Binary::Sub, [p, q]) => match (writer.term[p], writer.term[q]) {
                (Node::Binary(Binary::Mul, p), Node::Binary(Binary::Mul, q)) => Some([p, q]),
                _ => None,
            },
            _ => None,
        })
        .collect::<Option<_>>()?;
    let (a, b): (Vec<Id>, Vec<Id>) = (0..3).map(|k| (parts[(k + 2) % 3][0][0], parts[(k + 1) % 3][0][1])).unzip();
    let fits = |k: usize| {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        parts[k] == [[a[next], b[last]], [a[last], b[next]]]
    };
    if !(0..3).all(fits) {
        return None;
    }
    let (a, b) = (vector(writer, &a)?, vector(writer, &b)?);
    Some(format!("cross({}, {})", bare(&a.0), bare(&b.0)))
}
