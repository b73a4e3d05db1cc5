//! The e-graph: every class knows its value in real numbers at each of the points.

use std::sync::Arc;

use egg::{Analysis, DidMerge, EGraph, Id, Language};

use crate::real::{self, Computer, Real, is_finite, near, same};
use crate::term::{Binary, Node, Unary};

/// The graph.
pub type Graph = EGraph<Node, Reals>;

/// Values of the leaves, leaf by leaf and point by point.
#[derive(Clone, Debug, Default)]
pub struct Points {
    leaves: Vec<Vec<f32>>,
    count: usize,
}

impl Points {
    /// Points of which each has a number for each leaf; those of binary32 that are neither NaN nor infinite.
    pub fn new(points: &[Vec<f32>]) -> Self {
        let width = points.first().map_or(0, Vec::len);
        let leaves = (0..width).map(|leaf| points.iter().map(|point| point[leaf]).collect()).collect();
        Self { leaves, count: points.len() }
    }

    /// Points by the values of their leaves, as many for each.
    pub fn of_columns(leaves: Vec<Vec<f32>>) -> Self {
        let count = leaves.first().map_or(0, Vec::len);
        Self { leaves, count }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.count
    }

    /// True without any.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The values of a leaf.
    pub fn leaf(&self, k: u32) -> &[f32] {
        self.leaves.get(k as usize).map_or(&[], Vec::as_slice)
    }

    /// The numbers of one point.
    pub fn point(&self, k: usize) -> Vec<f32> {
        self.leaves.iter().map(|leaf| leaf[k]).collect()
    }

    /// How many leaves there are.
    pub fn width(&self) -> usize {
        self.leaves.len()
    }

    /// Some of the points.
    pub fn chosen(&self, which: &[usize]) -> Self {
        let leaves = self.leaves.iter().map(|leaf| which.iter().map(|&k| leaf[k]).collect()).collect();
        Self { leaves, count: which.len() }
    }
}

/// Computes the values of classes.
pub struct Reals {
    points: Points,
    computer: Computer,
    /// Times that two nodes of a class turned out to have different values at a point.
    pub conflicts: usize,
}

/// What is known of a class.
#[derive(Clone, Debug)]
pub struct Known {
    /// The value at each point.
    pub reals: Arc<[Real]>,
    /// The same in binary64.
    pub near: Arc<[f64]>,
    /// The number of binary64 that it is everywhere.
    pub constant: Option<f64>,
}

impl Reals {
    /// # Errors
    /// When there is no memory.
    pub fn new(points: Points) -> Result<Self, String> {
        Ok(Self { points, computer: Computer::new()?, conflicts: 0 })
    }

    /// The points.
    pub fn points(&self) -> &Points {
        &self.points
    }

    fn known(&mut self, node: &Node, operands: &[Known]) -> Known {
        let constant = constant(node, operands);
        let count = self.points.len();
        let reals: Arc<[Real]> = match node {
            Node::Leaf(k) => self.points.leaf(*k).iter().map(|x| real::exact(f64::from(*x))).collect(),
            // The same at each point.
            _ if constant.is_some() => std::iter::repeat_n(real::exact(constant.unwrap_or(0.0)), count).collect(),
            _ => (0..count)
                .map(|k| {
                    let values: Vec<&Real> = operands.iter().map(|known| &known.reals[k]).collect();
                    self.computer.node(node, &values)
                })
                .collect(),
        };
        let near = reals.iter().map(near).collect();
        Known { reals, near, constant }
    }
}

/// The value of a term at points, node by node.
///
/// # Errors
/// When there is no memory.
pub fn values(term: &[Node], points: &Points) -> Result<Vec<Known>, String> {
    let mut reals = Reals::new(points.clone())?;
    let mut all: Vec<Known> = Vec::with_capacity(term.len());
    for node in term {
        let operands: Vec<Known> = node.children().iter().map(|id| all[usize::from(*id)].clone()).collect();
        all.push(reals.known(node, &operands));
    }
    Ok(all)
}

impl Analysis<Node> for Reals {
    type Data = Known;

    fn make(graph: &mut Graph, node: &Node, _: Id) -> Known {
        let operands: Vec<Known> = node.children().iter().map(|id| graph[*id].data.clone()).collect();
        graph.analysis.known(node, &operands)
    }

    fn merge(&mut self, to: &mut Known, from: Known) -> DidMerge {
        let mut taken: Vec<usize> = Vec::new();
        for (k, (a, b)) in to.reals.iter().zip(from.reals.iter()).enumerate() {
            match (is_finite(a), is_finite(b)) {
                (false, true) => taken.push(k),
                (true, true) if !same(a, b) => self.conflicts += 1,
                _ => {}
            }
        }
        let constant = to.constant.is_none() && from.constant.is_some();
        to.constant = to.constant.or(from.constant);
        if !taken.is_empty() {
            let mut all: Vec<Real> = to.reals.to_vec();
            taken.iter().for_each(|&k| all[k] = from.reals[k].clone());
            to.near = all.iter().map(near).collect();
            to.reals = all.into();
        }
        DidMerge(constant || !taken.is_empty(), true)
    }

    fn modify(graph: &mut Graph, id: Id) {
        if let Some(value) = graph[id].data.constant {
            let number = graph.add(Node::number(value));
            graph.union(id, number);
        }
    }
}

/// The value of a node of constants, where binary64 has it exactly.
fn constant(node: &Node, operands: &[Known]) -> Option<f64> {
    let of = |k: usize| operands.get(k).and_then(|known| known.constant);
    let value = match node {
        Node::Number(c) => c.value(),
        Node::Unary(Unary::Neg, _) => -of(0)?,
        Node::Unary(Unary::Abs, _) => of(0)?.abs(),
        Node::Unary(Unary::Sqrt, _) => {
            Some(of(0)?.sqrt()).filter(|root| of(0) == Some(root * root) && root.fract() == 0.0)?
        }
        Node::Binary(Binary::Add, _) => exact_sum(of(0)?, of(1)?)?,
        Node::Binary(Binary::Sub, _) => exact_sum(of(0)?, -of(1)?)?,
        Node::Binary(Binary::Mul, _) => {
            Some(of(0)? * of(1)?).filter(|p| of(0).unwrap_or(0.0).mul_add(of(1).unwrap_or(0.0), -p) == 0.0)?
        }
        Node::Binary(Binary::Div, _) => {
            let (a, b) = (of(0)?, of(1)?);
            Some(a / b).filter(|q| b != 0.0 && q.mul_add(b, -a) == 0.0)?
        }
        Node::Pi | Node::Leaf(_) | Node::Unary(..) | Node::Binary(..) => return None,
    };
    value.is_finite().then_some(value)
}

fn exact_sum(a: f64, b: f64) -> Option<f64> {
    let sum = a + b;
    let part = sum - a;
    ((a - (sum - part)) + (b - part) == 0.0).then_some(sum)
}
