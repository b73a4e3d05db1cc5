//! A shader read with the constants that its literals stand for, where it deviates with their digits.

use super::judge::{Blame, Deviation, Verdict};
use super::oracle::{JudgeContext, Oracle};
use super::rounded::Rounded;
use super::second_pass::SecondPass;
use base::value::Batch;
use program::OutputLayout;
use program::interp::{OutputColumn, SLOTS};

/// The program with each literal as a function gives it.
type Read<'r> = dyn Fn(&dyn Fn(f64) -> f64) -> Oracle + 'r;

/// A program with some of its literals as the constants that they stand for.
#[derive(Clone, Debug)]
pub(super) struct Reading {
    /// The program, so read.
    pub oracle: Oracle,
    /// True where all of these literals have as many digits as binary32 carries. Otherwise the reading counts only
    /// where it moves no output farther than a conforming device may be off.
    pub precise: bool,
}

impl Reading {
    /// The readings of a program, the one that takes less for granted first.
    pub(super) fn all(rounded: &[Rounded], read: &Read<'_>) -> Vec<Self> {
        let sets: [Vec<&Rounded>; 2] = [rounded.iter().filter(|r| r.is_precise()).collect(), rounded.iter().collect()];
        let mut all: Vec<Self> = Vec::new();
        for set in sets {
            let precise = set.iter().all(|r| r.is_precise());
            if set.is_empty() || precise && !all.is_empty() {
                continue;
            }
            let literal = |v: f64| set.iter().find(|r| r.written == v).map_or(v, |r| r.meant);
            all.push(Self { oracle: read(&literal), precise });
        }
        all
    }
}

/// A reading with what it takes to judge by it.
pub(super) struct LiteralReader<'a> {
    reading: &'a Reading,
    open: Box<SecondPass<'a>>,
}

impl<'a> LiteralReader<'a> {
    /// For all readings of a context's program.
    pub(super) fn all(context: &JudgeContext<'a>) -> Vec<Self> {
        let oracle: &'a Oracle = context.oracle;
        let reader = |reading: &'a Reading| {
            let context = JudgeContext { oracle: &reading.oracle, ..*context };
            Self { reading, open: Box::new(SecondPass::new(&context)) }
        };
        oracle.readings.iter().map(reader).collect()
    }

    /// What the reading makes of invocations in which the shader deviates as it is written, at most [`SLOTS`] of them:
    /// the verdict that takes the place of the deviation, where there is one.
    pub(super) fn look(
        &mut self,
        context: &JudgeContext<'_>,
        batch: &Batch,
        layout: &OutputLayout,
        invocations: &[usize],
    ) -> Vec<Option<Option<Verdict>>> {
        let found = self.open.shader(batch, layout, None, invocations);
        let near = if self.reading.precise {
            vec![true; found.len()]
        } else {
            within_device(context, &self.reading.oracle, batch, invocations)
        };
        let wrong = |verdict: &Option<Verdict>| matches!(verdict, Some(Verdict::Deviate(_)));
        found.into_iter().zip(near).map(|(verdict, near)| (near && !wrong(&verdict)).then_some(verdict)).collect()
    }
}

/// True for a deviation that another reading of the literals may explain.
pub(super) fn may_be_read(verdict: &Option<Verdict>) -> bool {
    matches!(verdict, Some(Verdict::Deviate(Deviation { blame: Blame::Shader, .. })))
}

/// For each invocation, whether the reading moves no output farther than a conforming device may be off.
pub(super) fn within_device(
    context: &JudgeContext<'_>,
    read: &Oracle,
    batch: &Batch,
    invocations: &[usize],
) -> Vec<bool> {
    let (mut written, mut meant) = (context.oracle.ideal_or_meaning(), read.ideal_or_meaning());
    let mut device = context.oracle.tape(context.lenient());
    let slots = written.run_some(batch, invocations);
    meant.run_some(batch, invocations);
    device.run_some(batch, invocations);
    let mut near: [bool; SLOTS] = std::array::from_fn(|slot| written.emitted()[slot] == meant.emitted()[slot]);
    for vertex in 0..written.room() {
        for word in 0..written.width() {
            match (written.output(vertex, word), meant.output(vertex, word), device.output(vertex, word)) {
                (OutputColumn::Real(a), OutputColumn::Real(b), OutputColumn::Real(&column)) => {
                    let bounds = device.domain().bounds(column, &mut |_| false);
                    let moved = a.values().iter().zip(b.values()).map(|(a, b)| (a - b).abs());
                    for (slot, moved) in moved.enumerate().take(slots) {
                        // An infinite bound says nothing, and NaN does not pass.
                        near[slot] &= moved == 0.0 || bounds.bound[slot].is_finite() && moved <= bounds.bound[slot];
                    }
                }
                (OutputColumn::Word(a), OutputColumn::Word(b), _) => {
                    near.iter_mut().zip(a.iter().zip(b)).for_each(|(near, (a, b))| *near &= a == b);
                }
                _ => near = [false; SLOTS],
            }
        }
    }
    near[..slots].to_vec()
}
