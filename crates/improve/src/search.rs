//! The search: from a term and points to terms that lose fewer bits.

use std::collections::HashSet;
use std::time::Duration;

use egg::{AstSize, EGraph, Extractor, Id, Rewrite, Runner};

use crate::error::WORST;
use crate::extract::{extract, operations};
use crate::graph::{Graph, Points, Reals, values};
use crate::proof::ROUNDED;
use crate::real::{Real, is_finite, near, same};
use crate::regimes::{self, Split};
use crate::single::{Losses, folded, run};
use crate::term::{Binary, Node, Term, Unary};
use crate::{normal, rules, series};

/// Bits in the mean by which a proposal has to be better.
const LEAST_GAIN: f64 = 0.05;

/// What binary32 has no number for, between numbers of many bits.
const NOTHING: f64 = 1e-46;

/// Points at which classes are computed.
const LOOKED_AT: usize = 32;

/// Terms between which thresholds choose.
const KEPT: usize = 14;

/// Proposals, of which some may be refused by a proof.
const CANDIDATES: usize = 5;

/// Classes whose normal form is computed.
const NORMALISED: usize = 160;

/// Terms that are made shorter, and nodes of a graph for it.
const POLISHED: usize = 6;
const POLISHED_NODES: usize = 1500;

/// How a search is limited.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Nodes of the graph.
    pub nodes: usize,
    /// What the saturation of the graph may take.
    pub time: Duration,
    /// Whether the language has `sinh` and its kind.
    pub hyperbolic: bool,
    /// The rules.
    pub rules: Vec<rules::Rule>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { nodes: 6000, time: Duration::from_secs(3), hyperbolic: true, rules: rules::all() }
    }
}

/// A proposal.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Which term is used where.
    pub split: Split,
    /// What it loses at each point.
    pub losses: Losses,
    /// What it costs, in additions.
    pub operations: f64,
}

/// What a search found.
#[derive(Clone, Debug)]
pub struct Improved {
    /// The points at which the original has a value that binary32 can hold.
    pub points: Points,
    /// How many points it has none at.
    pub without_value: usize,
    /// What the original loses at each point.
    pub original: Losses,
    /// What the original costs.
    pub operations: f64,
    /// Terms that proposals are made of.
    pub terms: Vec<Term>,
    /// Proposals, the one that loses least first.
    pub candidates: Vec<Candidate>,
    /// Terms that were thrown away: in real numbers they are not what the original is.
    pub unequal: usize,
    /// Applications of rules that were refused, since both sides have different values at a point.
    pub conflicts: usize,
}

/// Measures terms that are known beforehand against `meant`, which the original stands for: with vectors of length 1, say,
/// that binary32 has rounded. Nothing is searched for.
///
/// # Errors
/// When the original has a value at no point.
pub fn measure(original: &Term, meant: &Term, others: &[Term], points: &Points) -> Result<Improved, String> {
    let Defined { mut found, exact, right } = defined(original, meant, points)?;
    let mut all = vec![found.original.clone()];
    for term in others {
        let reals = values(term, &found.points)?;
        // An arc cosine beside 1 has half of the digits of its argument.
        let alike = |(a, b): (&Real, &Real)| !is_finite(a) || same(a, b) || (near(a) - near(b)).abs() <= NOTHING;
        if reals.last().is_some_and(|root| root.reals.iter().zip(&right).all(alike)) {
            all.push(Losses::of(&run(&folded(term), &found.points), &exact));
            found.terms.push(term.clone());
        } else {
            found.unequal += 1;
        }
    }
    let mut order: Vec<usize> = (1..all.len()).collect();
    order.sort_by(|a, b| all[*a].mean().total_cmp(&all[*b].mean()));
    let better = order.into_iter().filter(|k| all[0].mean() - all[*k].mean() >= LEAST_GAIN);
    found.candidates = better
        .map(|k| Candidate {
            split: Split::Term(k),
            losses: all[k].clone(),
            operations: cost(&folded(&found.terms[k])),
        })
        .collect();
    Ok(found)
}

/// The points at which a term has a value.
struct Defined {
    found: Improved,
    /// What is meant there, in binary64 and in many bits.
    exact: Vec<f64>,
    right: Vec<Real>,
}

fn defined(original: &Term, meant: &Term, points: &Points) -> Result<Defined, String> {
    let known = values(meant, points)?;
    let root = known.last().ok_or("the expression is empty")?;
    let fits = |k: &usize| is_finite(&root.reals[*k]) && root.near[*k].abs() <= f64::from(f32::MAX);
    let defined: Vec<usize> = (0..points.len()).filter(fits).collect();
    if defined.is_empty() {
        return Err("the expression has no value at any point of the domain".to_owned());
    }
    let without_value = points.len() - defined.len();
    let points = points.chosen(&defined);
    let exact: Vec<f64> = defined.iter().map(|k| root.near[*k]).collect();
    let right: Vec<_> = defined.iter().map(|k| root.reals[*k].clone()).collect();
    let found = Improved {
        without_value,
        operations: cost(&folded(original)),
        terms: vec![original.clone()],
        candidates: Vec::new(),
        unequal: 0,
        conflicts: 0,
        original: Losses::of(&run(&folded(original), &points), &exact),
        points,
    };
    Ok(Defined { found, exact, right })
}

/// Looks for terms that lose fewer bits in the mean of the points.
///
/// # Errors
/// When the original has a value at no point, or a rule cannot be read.
pub fn search(term: &Term, points: &Points, settings: &Settings) -> Result<Improved, String> {
    let Defined { mut found, exact, right } = defined(term, term, points)?;
    let (points, original) = (found.points.clone(), found.original.clone());
    let losses = |term: &Term| Losses::of(&run(&folded(term), &points), &exact);
    let which = looked_at(&points, &original);
    let rewrites = settings.rules.iter().map(rules::Rule::rewrite).collect::<Result<Vec<_>, _>>()?;
    let (graph, id) = saturated(term, &points.chosen(&which), &rewrites, settings)?;
    found.conflicts = graph.analysis.conflicts;
    let allowed = |node: &Node| settings.hyperbolic || !is_hyperbolic(node);
    let mut seen: HashSet<String> = HashSet::from([folded(term).to_string()]);
    let mut all = vec![original.clone()];
    for weights in weights(&points, &which) {
        for new in extract(&graph, id, &weights, &allowed) {
            if !seen.insert(folded(&new).to_string()) {
                continue;
            }
            if is_equal(&new, &points, &right)? {
                all.push(losses(&new));
                found.terms.push(new);
            } else {
                found.unequal += 1;
            }
        }
    }
    polish(&mut found, &mut all, &mut seen, &right, &exact, &rewrites, settings)?;
    let leaves: HashSet<u32> =
        term.iter().filter_map(|node| if let Node::Leaf(k) = node { Some(*k) } else { None }).collect();
    if let (1, Some(leaf)) = (leaves.len(), leaves.iter().next()) {
        for new in series::of(term, *leaf, points.width()) {
            all.push(near_zero(losses(&new), &new, &points, &right)?);
            found.terms.push(new);
        }
    }
    propose(&mut found, &all);
    Ok(found)
}

/// The losses of a series, which is of no use where what it leaves out shows: so far a threshold must not let it go.
fn near_zero(losses: Losses, series: &Term, points: &Points, right: &[Real]) -> Result<Losses, String> {
    let reals = values(series, points)?;
    let Some(root) = reals.last() else { return Ok(losses) };
    // Half of what the proof admits, since thresholds lie between points.
    let holds = |k: usize| (near(&root.reals[k]) - near(&right[k])).abs() <= 0.5 * ROUNDED * near(&right[k]).abs();
    let kept = |(k, lost): (usize, f64)| if holds(k) { lost } else { WORST };
    Ok(Losses(losses.0.iter().copied().enumerate().map(kept).collect()))
}

/// True where a term has the values of the original, or none.
fn is_equal(term: &Term, points: &Points, right: &[Real]) -> Result<bool, String> {
    let reals = values(term, points)?;
    Ok(reals.last().is_some_and(|root| root.reals.iter().zip(right).all(|(a, b)| !is_finite(a) || same(a, b))))
}

/// Makes the best terms shorter: each is the start of a small graph, from which the shortest comes that loses no more.
fn polish(
    found: &mut Improved,
    all: &mut Vec<Losses>,
    seen: &mut HashSet<String>,
    right: &[Real],
    exact: &[f64],
    rewrites: &[Rewrite<Node, Reals>],
    settings: &Settings,
) -> Result<(), String> {
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|a, b| all[*a].mean().total_cmp(&all[*b].mean()));
    let small = Settings { nodes: POLISHED_NODES, time: settings.time / 10, ..settings.clone() };
    for k in order.into_iter().take(POLISHED) {
        let which = looked_at(&found.points, &all[k]);
        let (graph, id) = saturated(&found.terms[k], &found.points.chosen(&which), rewrites, &small)?;
        let allowed = |node: &Node| settings.hyperbolic || !is_hyperbolic(node);
        for new in extract(&graph, id, &vec![1.0; which.len()], &allowed) {
            if seen.insert(folded(&new).to_string()) && is_equal(&new, &found.points, right)? {
                all.push(Losses::of(&run(&folded(&new), &found.points), exact));
                found.terms.push(new);
            }
        }
    }
    Ok(())
}

/// Proposals out of terms with their losses: the best alone, and the best with thresholds.
fn propose(found: &mut Improved, all: &[Losses]) {
    let points = found.points.clone();
    let costs: Vec<f64> = found.terms.iter().map(|term| cost(&folded(term))).collect();
    let mut order: Vec<usize> = (0..all.len()).collect();
    let rank = |k: &usize| all[*k].mean() + 0.004 * costs[*k];
    order.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
    let mut kept: Vec<usize> = order.iter().copied().take(KEPT).collect();
    // What is best somewhere, however bad it is elsewhere.
    for k in 0..points.len() {
        let best = order.iter().copied().min_by(|a, b| all[*a].0[k].total_cmp(&all[*b].0[k]));
        kept.extend(best.filter(|best| !kept.contains(best)));
    }
    let chosen: Vec<Losses> = kept.iter().map(|k| all[*k].clone()).collect();
    let split = renumbered(regimes::best(&points, &chosen), &kept);
    let singles = order.iter().copied().take(KEPT).map(Split::Term);
    let mut candidates: Vec<Candidate> = Vec::new();
    for split in singles.chain([split]) {
        let used: Vec<usize> = (0..points.len()).map(|k| split.chosen(&points, k)).collect();
        let losses = Losses(used.iter().enumerate().map(|(k, term)| all[*term].0[k]).collect());
        let terms: HashSet<usize> = split.terms().into_iter().collect();
        let operations = terms.iter().map(|k| costs[*k]).sum::<f64>() + split.thresholds() as f64;
        // A longer form of what is there loses the same everywhere.
        let new = !candidates.iter().any(|known| known.losses == losses);
        if losses.mean() < found.original.mean() - LEAST_GAIN && new {
            candidates.push(Candidate { split, losses, operations });
        }
    }
    candidates.sort_by(|a, b| a.losses.mean().total_cmp(&b.losses.mean()));
    candidates.truncate(CANDIDATES);
    found.candidates = candidates;
}

fn renumbered(split: Split, names: &[usize]) -> Split {
    match split {
        Split::Term(k) => Split::Term(names[k]),
        Split::At { leaf, absolute, threshold, below, above } => Split::At {
            leaf,
            absolute,
            threshold,
            below: renumbered(*below, names).into(),
            above: renumbered(*above, names).into(),
        },
    }
}

/// What a term costs, in additions; what it has twice is computed once.
pub fn cost(term: &Term) -> f64 {
    term.iter().map(operations).sum()
}

fn is_hyperbolic(node: &Node) -> bool {
    use Unary as U;
    matches!(node, Node::Unary(U::Sinh | U::Cosh | U::Tanh | U::Asinh | U::Acosh | U::Atanh, _))
}

/// The points that lose most, and some of the others.
fn looked_at(points: &Points, losses: &Losses) -> Vec<usize> {
    let mut worst: Vec<usize> = (0..points.len()).collect();
    worst.sort_by(|a, b| losses.0[*b].total_cmp(&losses.0[*a]).then(a.cmp(b)));
    let spread = |from: &[usize], count: usize| -> Vec<usize> {
        (0..count.min(from.len())).map(|k| from[k * from.len() / count.min(from.len()).max(1)]).collect()
    };
    // Evenly over the order of losses, so that all kinds of points are there.
    let mut chosen = spread(&worst, LOOKED_AT);
    chosen.sort_unstable();
    chosen
}

/// Weights of the points: all alike, then each half of an input.
fn weights(points: &Points, which: &[usize]) -> Vec<Vec<f64>> {
    let mut all = vec![vec![1.0; which.len()]];
    for leaf in 0..points.width() as u32 {
        let column: Vec<f32> = which.iter().map(|k| points.leaf(leaf)[*k]).collect();
        for absolute in [false, true] {
            let key = |x: f32| if absolute { x.abs() } else { x };
            let mut sorted: Vec<f32> = column.iter().map(|x| key(*x)).collect();
            sorted.sort_by(f32::total_cmp);
            let middle = if !absolute && sorted[0] < 0.0 && sorted[sorted.len() - 1] > 0.0 {
                0.0
            } else {
                sorted[sorted.len() / 2]
            };
            for below in [true, false] {
                let weights: Vec<f64> =
                    column.iter().map(|x| if (key(*x) < middle) == below { 1.0 } else { 0.0 }).collect();
                let some = weights.iter().sum::<f64>();
                if some > 0.0 && some < which.len() as f64 && !all.contains(&weights) {
                    all.push(weights);
                }
            }
        }
    }
    all
}

/// The graph of a term: rules, then normal forms of what is there, then rules once more.
fn saturated(
    term: &Term,
    points: &Points,
    rewrites: &[Rewrite<Node, Reals>],
    settings: &Settings,
) -> Result<(Graph, Id), String> {
    let mut graph: Graph = EGraph::new(Reals::new(points.clone())?);
    let root = graph.add_expr(term);
    graph.rebuild();
    normalise(&mut graph);
    let (mut nodes, mut iterations) = (settings.nodes / 3, 4);
    for round in 0..2 {
        let runner: Runner<Node, Reals> = Runner::new(Reals::new(points.clone())?)
            .with_egraph(graph)
            .with_node_limit(nodes)
            .with_iter_limit(iterations)
            .with_time_limit(settings.time / 2)
            .run(rewrites);
        graph = runner.egraph;
        if round == 0 {
            normalise(&mut graph);
        }
        (nodes, iterations) = (settings.nodes, 5);
    }
    Ok((graph, root))
}

/// Adds the normal forms of sums and quotients.
fn normalise(graph: &mut Graph) {
    let sums = |node: &Node| matches!(node, Node::Binary(Binary::Add | Binary::Sub | Binary::Div, _));
    let mut ids: Vec<Id> = graph
        .classes()
        .filter(|class| class.nodes.iter().any(sums) && class.data.constant.is_none())
        .map(|class| class.id)
        .collect();
    ids.sort_unstable();
    ids.truncate(NORMALISED);
    let extractor = Extractor::new(graph, AstSize);
    let terms: Vec<(Id, Term)> = ids.iter().map(|id| (*id, extractor.find_best(*id).1)).collect();
    for (id, term) in terms {
        let Some(new) = normal::of(&term).filter(|new| *new != term && new.len() <= 3 * term.len() + 8) else {
            continue;
        };
        let added = graph.add_expr(&new);
        let (a, b) = (graph[id].data.reals.clone(), graph[added].data.reals.clone());
        if a.iter().zip(b.iter()).all(|(a, b)| !is_finite(a) || !is_finite(b) || same(a, b)) {
            graph.union(id, added);
        }
    }
    graph.rebuild();
}
