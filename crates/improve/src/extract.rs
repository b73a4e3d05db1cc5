//! Which terms of a graph are likely to lose least: for each class the node whose estimated errors at the points are least.

use std::collections::HashMap;
use std::rc::Rc;

use egg::{Id, Language, RecExpr};

use crate::error::{self, bits};
use crate::graph::Graph;
use crate::term::{Binary, Node, Term, Unary};

/// What an operation costs beside the bits that it loses: enough to choose between terms of one accuracy.
const OPERATION: f64 = 0.004;

/// Passes over the nodes that changed.
const PASSES: usize = 24;

/// Terms of one choice of weights: the nodes of the root with the best below them.
const OF_ROOT: usize = 4;

/// The best of a class, as it was when it was chosen; so it never contains itself.
struct Best {
    node: Node,
    operands: Vec<Rc<Best>>,
    errors: Vec<f64>,
    cost: f64,
    operations: f64,
}

/// Terms of the class `root` that lose least at the points, each of which counts by its weight.
pub fn extract(graph: &Graph, root: Id, weights: &[f64], allowed: &dyn Fn(&Node) -> bool) -> Vec<Term> {
    let root = graph.find(root);
    let index: HashMap<Id, usize> = graph.classes().enumerate().map(|(k, class)| (class.id, k)).collect();
    let classes: Vec<_> = graph.classes().collect();
    let mut best: Vec<Option<Rc<Best>>> = vec![None; classes.len()];
    let mut dirty = vec![true; classes.len()];
    for pass in 0..PASSES {
        let mut changed = vec![false; classes.len()];
        for (k, class) in classes.iter().enumerate() {
            for node in class.nodes.iter().filter(|node| allowed(node)) {
                let operand = |id: &Id| index[&graph.find(*id)];
                let touched =
                    if node.is_leaf() { pass == 0 } else { node.children().iter().any(|id| dirty[operand(id)]) };
                if !touched {
                    continue;
                }
                let operands: Option<Vec<Rc<Best>>> =
                    node.children().iter().map(|id| best[operand(id)].clone()).collect();
                let Some(operands) = operands else { continue };
                let new = of(graph, class.id, *node, operands, weights);
                if best[k].as_ref().is_none_or(|old| new.cost < old.cost - 1e-9) {
                    best[k] = Some(Rc::new(new));
                    changed[k] = true;
                }
            }
        }
        if !changed.contains(&true) {
            break;
        }
        dirty = changed;
    }
    let mut tops: Vec<Best> = Vec::new();
    for node in graph[root].nodes.iter().filter(|node| allowed(node)) {
        let operands: Option<Vec<Rc<Best>>> =
            node.children().iter().map(|id| best[index[&graph.find(*id)]].clone()).collect();
        tops.extend(operands.map(|operands| of(graph, root, *node, operands, weights)));
    }
    tops.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    tops.iter().take(OF_ROOT).map(term).collect()
}

fn of(graph: &Graph, class: Id, node: Node, operands: Vec<Rc<Best>>, weights: &[f64]) -> Best {
    let values = &graph[class].data.near;
    let inner: Vec<&[f64]> = node.children().iter().map(|id| &*graph[*id].data.near).collect();
    let errors: Vec<f64> = (0..values.len())
        .map(|k| {
            let of: [(f64, f64); 2] = std::array::from_fn(|n| match operands.get(n) {
                Some(operand) => (inner[n][k], operand.errors[k]),
                None => (0.0, 0.0),
            });
            error::of(&node, values[k], &of[..operands.len()])
        })
        .collect();
    let operations = operations(&node) + operands.iter().map(|operand| operand.operations).sum::<f64>();
    let total: f64 = weights.iter().sum();
    let lost: f64 = errors.iter().zip(values.iter()).zip(weights).map(|((e, v), w)| bits(*e, *v) * w).sum();
    Best { node, operands, cost: lost / total.max(1e-9) + OPERATION * operations, errors, operations }
}

/// What a node costs, in additions.
pub fn operations(node: &Node) -> f64 {
    match node {
        // `x - 1.0` is nicer to read than `x + -1.0`.
        Node::Number(c) if c.value() < 0.0 => 0.125,
        Node::Number(_) | Node::Pi | Node::Leaf(_) => 0.0,
        Node::Unary(Unary::Neg | Unary::Abs, _) => 0.25,
        Node::Unary(Unary::Sqrt | Unary::InverseSqrt | Unary::SafeSqrt, _) | Node::Binary(Binary::Div, _) => 4.0,
        Node::Unary(Unary::Sin | Unary::Cos | Unary::Exp2 | Unary::Log2 | Unary::Exp | Unary::Log, _) => 6.0,
        Node::Unary(..) | Node::Binary(Binary::Pow | Binary::Atan2, _) => 12.0,
        Node::Binary(..) => 1.0,
    }
}

fn term(best: &Best) -> Term {
    let mut nodes = RecExpr::default();
    let mut known = HashMap::new();
    add(best, &mut nodes, &mut known);
    nodes
}

fn add(best: &Best, nodes: &mut Term, known: &mut HashMap<Node, Id>) -> Id {
    let mut node = best.node;
    let ids: Vec<Id> = best.operands.iter().map(|operand| add(operand, nodes, known)).collect();
    node.children_mut().copy_from_slice(&ids);
    *known.entry(node).or_insert_with(|| nodes.add(node))
}
