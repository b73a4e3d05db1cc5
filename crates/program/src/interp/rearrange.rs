//! The same sums and products in another order, as Vulkan and WGSL let an implementation compute them.
//!
//! Chains of additions, subtractions, negations and products whose intermediate results nothing else
//! reads are taken apart and put together again. In real numbers the value stays; in binary32 it
//! does not. Divisions and functions are left alone, and so is what another statement stored.

use std::collections::HashMap;
use std::mem::take;
use std::sync::Arc;

use super::allocate::allocate;
use super::code::{Executable, File, Inst, Reg, Register, TEMPORARY, Touch};
use super::domain::{Binary, Site, Unary};
use base::value::Scalar;

/// By which laws expressions are rearranged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Laws {
    /// Associativity and commutativity: every product and every term stays.
    Order,
    /// These, and distributivity in both directions.
    Distribution,
}

/// Operations of one chain; a chain that is longer is rearranged in parts.
const MAX_CHAIN: usize = 64;

/// Operations that distribution over one sum may lead to.
const MAX_DISTRIBUTED: usize = 4 * MAX_CHAIN;

/// A body in which every temporary has a register of its own.
#[derive(Clone, Debug, Default)]
pub(super) struct Draft {
    pub body: Vec<Inst>,
    /// Registers of variables and constants in the two files.
    pub fixed: (u32, u32),
    /// The first register that is no temporary yet.
    pub temporaries: Reg,
}

impl Executable {
    /// An executable with another body.
    pub(super) fn with_body(self, draft: Draft) -> Self {
        let mut body = draft.body.clone();
        let (reals, words) = allocate(&mut body, draft.fixed);
        Self { body, reals: reals as usize, words: words as usize, draft: Arc::new(draft), ..self }
    }

    /// The same program with its sums and products rearranged. `choose(n)` is asked for a number
    /// below `n` for each decision.
    #[must_use]
    pub fn rearranged(&self, laws: Laws, choose: &mut dyn FnMut(usize) -> usize) -> Self {
        let mut draft = (*self.draft).clone();
        let mut uses = HashMap::new();
        count(&mut draft.body, &mut uses);
        let mut pass = Rearrangement { laws, choose, uses, next: draft.temporaries };
        pass.block(&mut draft.body);
        draft.temporaries = pass.next;
        self.clone().with_body(draft)
    }
}

/// How often each real temporary is read.
fn count(body: &mut [Inst], uses: &mut HashMap<Reg, usize>) {
    for inst in body {
        inst.registers(&mut |touch, file, reg| {
            if (touch, file) == (Touch::Read, File::Real) && *reg >= TEMPORARY {
                *uses.entry(*reg).or_default() += 1;
            }
        });
        each_block(inst, &mut |block| count(block, uses));
    }
}

/// Calls `f` for each block inside an instruction.
fn each_block(inst: &mut Inst, f: &mut dyn FnMut(&mut Vec<Inst>)) {
    match inst {
        Inst::If { accept, reject, .. } => [accept, reject].into_iter().for_each(f),
        Inst::Switch { cases, .. } => cases.iter_mut().for_each(|case| f(&mut case.body)),
        Inst::Loop { body, continuing, .. } => [body, continuing].into_iter().for_each(f),
        Inst::Call { body } => f(body),
        _ => {}
    }
}

/// True for what ends a run of instructions that are all carried out, one after the other.
fn is_control(inst: &Inst) -> bool {
    matches!(
        inst,
        Inst::If { .. }
            | Inst::Switch { .. }
            | Inst::Loop { .. }
            | Inst::Call { .. }
            | Inst::Barrier { .. }
            | Inst::Fence { .. }
            | Inst::Subgroup(_)
            | Inst::Break
            | Inst::Continue
            | Inst::Return
            | Inst::Kill
            | Inst::EmitVertex
            | Inst::EndPrimitive
    )
}

/// A sum of products of sums …
#[derive(Clone, Debug, PartialEq)]
enum SumNode {
    Leaf(Reg),
    /// Terms; true for those that are subtracted.
    Sum(Vec<(bool, SumNode)>, Site),
    Product(Vec<SumNode>, Site),
}

impl SumNode {
    /// Operations that it takes.
    fn operations(&self) -> usize {
        match self {
            Self::Leaf(_) => 0,
            Self::Sum(terms, _) => terms.iter().map(|(_, term)| 1 + term.operations()).sum::<usize>() - 1,
            Self::Product(factors, _) => factors.iter().map(|factor| 1 + factor.operations()).sum::<usize>() - 1,
        }
    }
}

/// Instructions without control between them.
struct InstRun {
    insts: Vec<Inst>,
    /// Where each temporary that one of the operations gives comes from.
    made: HashMap<Reg, usize>,
    /// Where each variable is written.
    stored: HashMap<Reg, Vec<usize>>,
    /// Operations that became part of a later one.
    absorbed: Vec<bool>,
}

struct Rearrangement<'c> {
    laws: Laws,
    choose: &'c mut dyn FnMut(usize) -> usize,
    uses: HashMap<Reg, usize>,
    next: Reg,
}

impl Rearrangement<'_> {
    fn block(&mut self, body: &mut Vec<Inst>) {
        let mut run = Vec::new();
        for mut inst in take(body) {
            if is_control(&inst) {
                self.rewrite(take(&mut run), body);
                each_block(&mut inst, &mut |block| self.block(block));
                body.push(inst);
            } else {
                run.push(inst);
            }
        }
        self.rewrite(run, body);
    }

    /// Rearranges a run and adds it to `body`.
    fn rewrite(&mut self, insts: Vec<Inst>, body: &mut Vec<Inst>) {
        let mut run = InstRun::new(insts);
        let mut replaced: Vec<Option<Vec<Inst>>> = vec![None; run.insts.len()];
        for at in (0..run.insts.len()).rev() {
            if run.absorbed[at] || result_of(&run.insts[at]).is_none() || is_precise(&run.insts[at]) {
                continue;
            }
            let mut room = MAX_CHAIN;
            let (negative, tree) = self.tree(&mut run, at, at, &mut room);
            // A single operation has no other order.
            if room < MAX_CHAIN {
                let tree = self.shaken(tree);
                replaced[at] = Some(self.emitted(&run.insts[at], negative, &tree));
            }
        }
        for (at, inst) in run.insts.into_iter().enumerate() {
            match replaced[at].take() {
                Some(insts) => body.extend(insts),
                None if run.absorbed[at] => {}
                None => body.push(inst),
            }
        }
    }

    /// The operation at `at` with the operations that only it needs, and whether to negate it all. Its
    /// leaves will be read at `root`.
    fn tree(&self, run: &mut InstRun, at: usize, root: usize, room: &mut usize) -> (bool, SumNode) {
        match run.insts[at] {
            Inst::Real1 { a, .. } => {
                let (negative, node) = self.operand(run, a, root, room);
                (!negative, node)
            }
            Inst::Real2 { op: Binary::Multiply, a, b, site, .. } => {
                let mut negative = false;
                let mut factors = Vec::new();
                for reg in [a, b] {
                    let (minus, node) = self.operand(run, reg, root, room);
                    negative ^= minus;
                    match node {
                        SumNode::Product(inner, _) => factors.extend(inner),
                        node => factors.push(node),
                    }
                }
                (negative, SumNode::Product(factors, site))
            }
            Inst::Real2 { op, a, b, site, .. } => {
                let mut terms = Vec::new();
                for (reg, minus) in [(a, false), (b, op == Binary::Subtract)] {
                    let (negative, node) = self.operand(run, reg, root, room);
                    add_term(&mut terms, negative ^ minus, node);
                }
                (false, SumNode::Sum(terms, site))
            }
            // Not reached: `made` names none of these.
            ref other => (false, SumNode::Leaf(result_of(other).unwrap_or_default())),
        }
    }

    fn operand(&self, run: &mut InstRun, reg: Reg, root: usize, room: &mut usize) -> (bool, SumNode) {
        match run.made.get(&reg) {
            Some(&at) if *room > 0 && self.uses.get(&reg) == Some(&1) && run.can_move(at, root) => {
                run.absorbed[at] = true;
                *room -= 1;
                self.tree(run, at, root, room)
            }
            _ => (false, SumNode::Leaf(reg)),
        }
    }

    /// The same value by the laws of distribution, where they are allowed.
    fn shaken(&mut self, node: SumNode) -> SumNode {
        if self.laws == Laws::Order {
            return node;
        }
        match node {
            SumNode::Leaf(_) => node,
            SumNode::Sum(old, site) => {
                let mut terms = Vec::new();
                for (minus, term) in old {
                    add_term(&mut terms, minus, self.shaken(term));
                }
                self.factored(terms, site)
            }
            SumNode::Product(factors, site) => {
                let mut factors: Vec<SumNode> = factors.into_iter().map(|factor| self.shaken(factor)).collect();
                let sums: Vec<usize> = (0..factors.len()).filter(|&k| matches!(factors[k], SumNode::Sum(..))).collect();
                if sums.is_empty() || (self.choose)(2) == 0 {
                    return SumNode::Product(factors, site);
                }
                let chosen = sums[(self.choose)(sums.len())];
                let others: usize = factors.iter().map(|factor| 1 + factor.operations()).sum();
                match factors.swap_remove(chosen) {
                    // Each term gets its own copy of the other factors.
                    SumNode::Sum(terms, sum_site) if terms.len() * others <= MAX_DISTRIBUTED => {
                        let product = |(minus, term)| {
                            let mut all = factors.clone();
                            match term {
                                SumNode::Product(inner, _) => all.extend(inner),
                                term => all.push(term),
                            }
                            (minus, SumNode::Product(all, site))
                        };
                        SumNode::Sum(terms.into_iter().map(product).collect(), sum_site)
                    }
                    factor => {
                        factors.push(factor);
                        SumNode::Product(factors, site)
                    }
                }
            }
        }
    }

    /// A sum in which two products with a common factor may have become one.
    fn factored(&mut self, mut terms: Vec<(bool, SumNode)>, site: Site) -> SumNode {
        let pairs = (0..terms.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
        let common: Vec<(usize, usize, Reg)> =
            pairs.filter_map(|(i, j)| Some((i, j, common_factor(&terms[i].1, &terms[j].1)?))).collect();
        if !common.is_empty() && (self.choose)(2) == 0 {
            let (i, j, factor) = common[(self.choose)(common.len())];
            // `j` is the greater.
            let (second, first) = (terms.swap_remove(j), terms.swap_remove(i));
            let rest = |(minus, node)| (minus, without(node, factor));
            let sum = SumNode::Sum(vec![rest(first), rest(second)], site);
            terms.push((false, SumNode::Product(vec![SumNode::Leaf(factor), sum], site)));
        }
        match terms.pop() {
            Some((false, only)) if terms.is_empty() => only,
            last => {
                terms.extend(last);
                SumNode::Sum(terms, site)
            }
        }
    }

    /// Instructions that give the value to what `root` gave it to.
    fn emitted(&mut self, root: &Inst, negative: bool, tree: &SumNode) -> Vec<Inst> {
        let (Some(to), Inst::Real1 { site, .. } | Inst::Real2 { site, .. }) = (result_of(root), root) else {
            return vec![root.clone()];
        };
        let mut code = Vec::new();
        let (minus, from) = self.emit(tree, &mut code);
        if minus ^ negative {
            code.push(Inst::Real1 { op: Unary::Negate, to, a: from, site: *site });
        } else {
            code.push(Inst::Copy { to: Register { scalar: Scalar::F32, reg: to }, from });
        }
        code
    }

    /// Gives the register of the value, and whether it has to be negated.
    fn emit(&mut self, node: &SumNode, code: &mut Vec<Inst>) -> (bool, Reg) {
        let (mut parts, product, site) = match node {
            SumNode::Leaf(reg) => return (false, *reg),
            SumNode::Sum(terms, site) => {
                let part = |(minus, term): &(bool, SumNode)| {
                    let (negative, reg) = self.emit(term, code);
                    (minus ^ negative, reg)
                };
                (terms.iter().map(part).collect::<Vec<_>>(), false, *site)
            }
            SumNode::Product(factors, site) => {
                (factors.iter().map(|factor| self.emit(factor, code)).collect::<Vec<_>>(), true, *site)
            }
        };
        while parts.len() > 1 {
            let (left, a) = parts.swap_remove((self.choose)(parts.len()));
            let (right, b) = parts.swap_remove((self.choose)(parts.len()));
            let to = self.next;
            self.next += 1;
            let (minus, op, a, b) = match (product, left, right) {
                (true, _, _) => (left ^ right, Binary::Multiply, a, b),
                (false, false, false) => (false, Binary::Add, a, b),
                (false, true, true) => (true, Binary::Add, a, b),
                (false, false, true) => (false, Binary::Subtract, a, b),
                (false, true, false) => (false, Binary::Subtract, b, a),
            };
            code.push(Inst::Real2 { op, to, a, b, site });
            parts.push((minus, to));
        }
        // Sums and products have at least one part.
        parts.pop().unwrap_or_default()
    }
}

impl InstRun {
    fn new(mut insts: Vec<Inst>) -> Self {
        let mut made = HashMap::new();
        let mut stored: HashMap<Reg, Vec<usize>> = HashMap::new();
        for (at, inst) in insts.iter_mut().enumerate() {
            if let Some(to) = result_of(inst).filter(|&to| to >= TEMPORARY && !is_precise(inst)) {
                made.insert(to, at);
            }
            inst.registers(&mut |touch, file, reg| {
                if (touch, file) == (Touch::Write, File::Real) && *reg < TEMPORARY {
                    stored.entry(*reg).or_default().push(at);
                }
            });
        }
        let absorbed = vec![false; insts.len()];
        Self { insts, made, stored, absorbed }
    }

    /// True when the operands of an operation still hold the same values later on.
    fn can_move(&self, at: usize, to: usize) -> bool {
        let holds = |reg: &Reg| self.stored.get(reg).is_none_or(|places| !places.iter().any(|p| (at..to).contains(p)));
        match &self.insts[at] {
            Inst::Real1 { a, .. } => holds(a),
            Inst::Real2 { a, b, .. } => holds(a) && holds(b),
            _ => false,
        }
    }
}

/// The result of an operation that can be part of a chain.
fn result_of(inst: &Inst) -> Option<Reg> {
    match inst {
        Inst::Real1 { op: Unary::Negate, to, .. }
        | Inst::Real2 { op: Binary::Add | Binary::Subtract | Binary::Multiply, to, .. } => Some(*to),
        _ => None,
    }
}

/// True for an operation that stays as it is written.
fn is_precise(inst: &Inst) -> bool {
    matches!(inst, Inst::Real1 { site, .. } | Inst::Real2 { site, .. } if site.is_precise())
}

/// Adds a term; the terms of a sum one by one.
fn add_term(terms: &mut Vec<(bool, SumNode)>, minus: bool, node: SumNode) {
    match node {
        SumNode::Sum(inner, _) => terms.extend(inner.into_iter().map(|(negative, term)| (negative ^ minus, term))),
        node => terms.push((minus, node)),
    }
}

/// A leaf that both products have, if something else is left of each of them.
fn common_factor(a: &SumNode, b: &SumNode) -> Option<Reg> {
    let (SumNode::Product(a, _), SumNode::Product(b, _)) = (a, b) else { return None };
    a.iter().find_map(|factor| match factor {
        SumNode::Leaf(reg) if a.len() > 1 && b.len() > 1 && b.contains(factor) => Some(*reg),
        _ => None,
    })
}

/// A product without one of its factors.
fn without(node: SumNode, factor: Reg) -> SumNode {
    let SumNode::Product(mut factors, site) = node else { return node };
    if let Some(k) = factors.iter().position(|f| *f == SumNode::Leaf(factor)) {
        factors.remove(k);
    }
    match factors.pop() {
        Some(only) if factors.is_empty() => only,
        last => {
            factors.extend(last);
            SumNode::Product(factors, site)
        }
    }
}
