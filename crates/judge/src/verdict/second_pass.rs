//! The second look at samples: every operation on the tape, with what each may be off by.

use std::collections::HashSet;

use super::follow::{self, scales};
use super::judge::{Blame, Deviation, Doubt, Promise, Reason, Verdict, What};
use super::open::{cut, fork};
use super::oracle::JudgeContext;
use super::reading::{LiteralReader, may_be_read};
use super::reference::{Evaluator, Expected};
use super::scan::OpenSample;
use super::shape::{shape_of_lane, shape_of_shader};
use super::words::{Aim, SampleVerdict, SlotsToJudge, WordOfSample, open_words, told, word_of_shader};
use crate::tape::{Model, Tape};
use base::value::Batch;
use program::OutputLayout;
use program::interp::{Binary64, Flags, HazardKind, Machine, SLOTS};
use program::lane::Actual;

/// An error of this part of the values' size is no test any more, even if it is allowed.
pub(super) const USELESS: f64 = 1.0 / 1024.0;

/// The same for two evaluations in binary64.
pub(super) const USELESS_64: f64 = 1.0 / (1_u64 << 30) as f64;

/// Formula and shader are two ways to compute the same; each may be off by what binary64 does to it.
pub(super) const TWO_WAYS: f64 = 8.0;

/// Judges samples with the tape. The machines are made when they are first needed.
pub(super) struct SecondPass<'a> {
    context: JudgeContext<'a>,
    /// For a shader with loops: which invocations end. A tape of one that does not would take all memory.
    ends: Option<Machine<'a, Binary64>>,
    ideal: Option<Machine<'a, Tape<'a>>>,
    tiers: Vec<Tier<'a>>,
    evaluator: Evaluator<'a>,
    max_ulp: f64,
    /// Invocations in which a comparison could go either way in the order of the source.
    forked: HashSet<usize>,
    /// The shader with the constants that its literals stand for.
    readers: Vec<LiteralReader<'a>>,
    /// Invocations that are right in one of these readings alone.
    reread: u64,
    /// Invocations that agree beside the value at the start of what has faded out in them.
    faded: HashSet<usize>,
}

struct Tier<'a> {
    promise: Promise,
    model: Model<'a>,
    machine: Option<Machine<'a, Tape<'a>>>,
}

impl<'a> SecondPass<'a> {
    pub(super) fn new(context: &JudgeContext<'a>) -> Self {
        let tier = |(promise, model)| Tier { promise, model, machine: None };
        Self {
            context: *context,
            ends: None,
            ideal: None,
            tiers: context.tiers().into_iter().map(tier).collect(),
            evaluator: Evaluator::bounded(context.reference),
            max_ulp: 0.0,
            forked: HashSet::new(),
            readers: LiteralReader::all(context),
            reread: 0,
            faded: HashSet::new(),
        }
    }

    /// Invocations since the last call that are right only where literals stand for constants.
    pub(super) fn take_reread(&mut self) -> u64 {
        std::mem::take(&mut self.reread)
    }

    /// The largest error of invocations that agree since the last call, in ULP.
    pub(super) fn take_max_ulp(&mut self) -> f64 {
        std::mem::take(&mut self.max_ulp)
    }

    /// Invocations since the last call whose outputs have faded out, and are judged by the scale of their start.
    pub(super) fn take_faded(&mut self) -> u64 {
        std::mem::take(&mut self.faded).len() as u64
    }

    /// Verdicts on samples, in their order.
    pub(super) fn judge(&mut self, batch: &Batch, actual: &Actual, samples: &[OpenSample]) -> Vec<(usize, Verdict)> {
        self.forked.clear();
        let mut verdicts: Vec<Option<Verdict>> = vec![None; samples.len()];
        let shaders: Vec<usize> = (0..samples.len()).filter(|&k| samples[k].shader).collect();
        for group in shaders.chunks(SLOTS) {
            let invocations: Vec<usize> = group.iter().map(|&k| samples[k].invocation).collect();
            for (&k, verdict) in group.iter().zip(self.shader(batch, actual.layout(), Some(actual), &invocations)) {
                verdicts[k] = verdict;
            }
        }
        self.release();
        // A lane is judged by the shader as it is, where that is not what is wrong.
        let wrong = |verdict: &Option<Verdict>| matches!(verdict, Some(Verdict::Deviate(_)));
        let mut lanes: Vec<usize> = (0..samples.len()).filter(|&k| samples[k].lane && !wrong(&verdicts[k])).collect();
        let mut measurable: Vec<usize> = Vec::new();
        let mut permitted = HashSet::new();
        for tier in 0..self.tiers.len() {
            let mut open = Vec::new();
            for group in lanes.chunks(SLOTS) {
                let invocations: Vec<usize> = group.iter().map(|&k| samples[k].invocation).collect();
                for (&k, found) in group.iter().zip(self.lane(tier, batch, actual, &invocations)) {
                    // What is not promised is not held against a lane that is not as it was measured.
                    let measured = self.tiers[tier].promise == Promise::Measured;
                    match found {
                        Verdict::Agree(_) | Verdict::Undetermined(Doubt { reason: Reason::Domain, .. }) => {}
                        _ => open.push(k),
                    }
                    // What one promise permits, however little that says, no other one makes a fault.
                    let excused = permitted.contains(&k) && matches!(found, Verdict::Deviate(_));
                    if matches!(&found, Verdict::Undetermined(doubt) if doubt.reason.permits()) {
                        permitted.insert(k);
                    }
                    if !excused && (!measured || matches!(found, Verdict::Agree(_))) {
                        verdicts[k] = Some(Verdict::worse(verdicts[k].take(), found, tier));
                    }
                }
            }
            self.release();
            // The conformance suite of a text, and another order, promise nothing beyond its domains.
            if tier == 0 {
                let (unpromised, rest): (Vec<usize>, Vec<usize>) = open.iter().partition(|&&k| {
                    matches!(&verdicts[k], Some(Verdict::Undetermined(Doubt { reason: Reason::NoPromise, .. })))
                });
                (measurable, open) = (unpromised, rest);
            }
            // Measurements decide where nothing is promised, and nowhere else.
            let next = self.tiers.get(tier + 1).map(|next| next.promise);
            if next == Some(Promise::Measured) {
                open.retain(|&k| {
                    matches!(&verdicts[k], Some(Verdict::Undetermined(Doubt { reason: Reason::NoPromise, .. })))
                });
                open.append(&mut measurable);
            }
            lanes = open;
        }
        let agree = Verdict::Agree(Promise::Text);
        samples.iter().zip(verdicts).map(|(s, v)| (s.invocation, v.unwrap_or(agree.clone()))).collect()
    }

    /// Gives back what very long loops took: one tape at a time has much.
    fn release(&mut self) {
        if self.context.oracle.executable().has_loops() {
            let tapes = self.tiers.iter_mut().filter_map(|tier| tier.machine.as_mut());
            self.ideal.iter_mut().chain(tapes).for_each(|machine| machine.domain().release());
        }
    }

    /// Whether the shader means what the formula says; `None` where it does.
    /// `actual` is only asked for the words that a report shows.
    pub(super) fn shader(
        &mut self,
        batch: &Batch,
        layout: &OutputLayout,
        actual: Option<&Actual>,
        invocations: &[usize],
    ) -> Vec<Option<Verdict>> {
        let endless = self.endless(batch, invocations);
        let Some(sound) = endless.iter().position(Option::is_none) else { return endless };
        let stand_in = |(&invocation, endless): (&usize, &Option<_>)| {
            if endless.is_some() { invocations[sound] } else { invocation }
        };
        let ending: Vec<usize> = invocations.iter().zip(&endless).map(stand_in).collect();
        let mut verdicts = self.of_shader(batch, layout, actual, &ending);
        for (verdict, endless) in verdicts.iter_mut().zip(endless).filter(|(_, endless)| endless.is_some()) {
            *verdict = endless;
        }
        self.reread(batch, layout, invocations, &mut verdicts);
        verdicts
    }

    /// Puts verdicts in the place of deviations that are none where literals stand for the constants that they round.
    fn reread(
        &mut self,
        batch: &Batch,
        layout: &OutputLayout,
        invocations: &[usize],
        verdicts: &mut [Option<Verdict>],
    ) {
        let Self { context, readers, reread, .. } = self;
        for reader in readers {
            let wrong: Vec<usize> = (0..verdicts.len()).filter(|&k| may_be_read(&verdicts[k])).collect();
            if wrong.is_empty() {
                return;
            }
            let open: Vec<usize> = wrong.iter().map(|&k| invocations[k]).collect();
            for (k, found) in wrong.into_iter().zip(reader.look(context, batch, layout, &open)) {
                if let Some(verdict) = found {
                    *reread += u64::from(verdict.is_none());
                    verdicts[k] = verdict;
                }
            }
        }
    }

    /// For each invocation, what follows where a loop of the shader goes on without end, or was given up; at most [`SLOTS`]
    /// of them.
    fn endless(&mut self, batch: &Batch, invocations: &[usize]) -> Vec<Option<Verdict>> {
        let oracle = self.context.oracle;
        if !oracle.executable().has_loops() {
            return vec![None; invocations.len().min(SLOTS)];
        }
        let machine = self.ends.get_or_insert_with(|| oracle.ideal_or_meaning());
        let slots = machine.run_some(batch, invocations);
        let end = Deviation { blame: Blame::Shader, what: What::Endless };
        let verdict = |flags: &Flags| match flags.is_stopped() {
            true if flags.has(HazardKind::GivenUp) => Some(Verdict::Undetermined(Doubt::of(Reason::LongLoop))),
            true => Some(Verdict::Deviate(end.clone())),
            false => None,
        };
        machine.flags()[..slots].iter().map(verdict).collect()
    }

    /// The same for invocations that end.
    fn of_shader(
        &mut self,
        batch: &Batch,
        layout: &OutputLayout,
        actual: Option<&Actual>,
        invocations: &[usize],
    ) -> Vec<Option<Verdict>> {
        let forked = self.decided_by_rounding(batch, invocations);
        let Self { context, ideal, evaluator, .. } = self;
        let reference = context.reference;
        let machine = ideal.get_or_insert_with(|| context.oracle.ideal_tape());
        let slots = machine.run_some(batch, invocations);
        let mut verdicts = vec![None; slots];
        let mut expected = vec![Expected::default(); slots];
        evaluator.turn_to(batch, &invocations[..slots]);
        for slot in 0..slots {
            evaluator.expected(batch, invocations[slot], slot, &mut expected[slot]);
            verdicts[slot] = match cut(machine.domain(), slot) {
                Some(doubt) => Some(Verdict::Undetermined(doubt)),
                None => shape_of_shader(machine, context, &expected[slot], slot).map(Verdict::Deviate),
            };
        }
        let known: Vec<bool> = (0..slots).map(|slot| machine.domain().given_up(slot).is_none()).collect();
        for vertex in 0..machine.room() {
            for output in &reference.outputs {
                let base = vertex * reference.vertex_words;
                let scale = |slot: usize| {
                    let values = expected[slot].words.get(base + output.expected.start..base + output.expected.end);
                    values.map_or(0.0, |values| values.iter().fold(0.0_f64, |m, v| m.max(v.abs())))
                };
                let scales: Vec<f64> = (0..slots).map(scale).collect();
                for k in 0..output.expected.len() {
                    let at = base + output.expected.start + k;
                    let target = |slot: usize| expected[slot].words.get(at).copied();
                    let slack = |slot: usize| expected[slot].slack(at);
                    let open: Vec<usize> = (0..slots)
                        .filter(|&slot| known[slot] && target(slot).is_some())
                        .filter(|&slot| !matches!(verdicts[slot], Some(Verdict::Deviate(_))))
                        .collect();
                    let word = output.actual.start + k;
                    let found = word_of_shader(
                        machine,
                        vertex,
                        word,
                        output,
                        &open,
                        &Aim { target: &target, slack: &slack, scales: &scales },
                    );
                    for (slot, verdict) in found {
                        let verdict = match verdict {
                            Err(doubt) => Verdict::Undetermined(doubt),
                            Ok(meant) => {
                                let word = WordOfSample { layout, actual, reference, output, vertex, word };
                                let what = word.what(meant, target(slot), invocations[slot]);
                                Verdict::Deviate(Deviation { blame: Blame::Shader, what })
                            }
                        };
                        verdicts[slot] = Some(Verdict::worse(verdicts[slot].take(), verdict, 0));
                    }
                }
            }
        }
        self.shader_on_paths(batch, layout, actual, invocations, &mut verdicts);
        for (verdict, forked) in verdicts.iter_mut().zip(forked) {
            if let (None, Some(doubt)) = (&verdict, forked) {
                *verdict = Some(Verdict::Undetermined(doubt));
            }
        }
        verdicts
    }

    /// Puts verdicts in the place of doubts that come from decisions which may go either way, in the shader or in what is
    /// expected, where all sides of them can be seen.
    fn shader_on_paths(
        &mut self,
        batch: &Batch,
        layout: &OutputLayout,
        actual: Option<&Actual>,
        invocations: &[usize],
        verdicts: &mut [Option<Verdict>],
    ) {
        let Self { context, ideal, evaluator, .. } = self;
        let Some(machine) = ideal else { return };
        let open = |slot: &usize| match &verdicts[*slot] {
            Some(Verdict::Undetermined(doubt)) if follow::may_be_settled(doubt) => {
                follow::is_open(machine.as_domain(), *slot) || evaluator.is_open(*slot)
            }
            _ => false,
        };
        let slots: Vec<usize> = (0..verdicts.len()).filter(open).collect();
        if slots.is_empty() {
            return;
        }
        let some: Vec<usize> = slots.iter().map(|&slot| invocations[slot]).collect();
        let expected = evaluator.on_all_paths(batch, &some);
        let found = follow::shader(machine, context, (batch, layout, actual), &some, &expected);
        for (slot, found) in slots.into_iter().zip(found) {
            match found {
                Some(Verdict::Agree(_)) => verdicts[slot] = None,
                Some(verdict) => verdicts[slot] = Some(verdict),
                None => {}
            }
        }
    }

    /// For each invocation, whether the rounding of a literal to binary32 decides a comparison.
    fn decided_by_rounding(&mut self, batch: &Batch, invocations: &[usize]) -> Vec<Option<Doubt>> {
        if !self.context.oracle.has_rounded_literals() {
            return vec![None; invocations.len()];
        }
        let mut machine = self.context.oracle.rounded_tape();
        let slots = machine.run_some(batch, invocations);
        let tape = machine.domain();
        (0..slots).map(|slot| tape.fork(slot).map(|_| fork(tape, slot))).collect()
    }

    /// Whether a lane is within what a tier allows.
    fn lane(&mut self, tier: usize, batch: &Batch, actual: &Actual, invocations: &[usize]) -> Vec<Verdict> {
        let Self { context, tiers, max_ulp, forked, faded, .. } = self;
        let Tier { promise, model, machine } = &mut tiers[tier];
        let machine = machine.get_or_insert_with(|| context.oracle.tape(*model));
        let slots = machine.run_some(batch, invocations);
        let invocations = &invocations[..slots];
        // Sums may be regrouped; what a comparison sees is taken to be in the order of the source.
        let regrouped = *promise == Promise::Rearranged;
        for slot in (0..slots).filter(|_| !regrouped) {
            if machine.domain().fork(slot).is_some() {
                forked.insert(invocations[slot]);
            }
        }
        let decided: Vec<bool> = invocations.iter().map(|i| regrouped && !forked.contains(i)).collect();
        let begin = |slot: usize| {
            let verdict = by_shape(machine, actual, invocations[slot], slot, decided[slot]);
            SampleVerdict::new(verdict.unwrap_or(Verdict::Agree(*promise)))
        };
        let mut standings: Vec<SampleVerdict> = (0..slots).map(begin).collect();
        let sizes: Vec<f64> = invocations.iter().map(|&i| context.reference.vector_size(batch, i)).collect();
        by_words(machine, actual, invocations, &decided, &sizes, &mut standings);
        let open = |slot: &usize| match &standings[*slot].verdict {
            Verdict::Undetermined(doubt) if follow::may_be_settled(doubt) => {
                follow::is_open(machine.as_domain(), *slot)
            }
            _ => false,
        };
        let open: Vec<usize> = (0..slots).filter(open).collect();
        if !open.is_empty() {
            let some: Vec<usize> = open.iter().map(|&slot| invocations[slot]).collect();
            let found = follow::lane(machine, context.reference, *promise, (batch, actual), &some);
            for (slot, found) in open.into_iter().zip(found) {
                if let Some(standing) = found {
                    standings[slot] = standing;
                }
            }
        }
        for (standing, &invocation) in standings.iter().zip(invocations) {
            if matches!(standing.verdict, Verdict::Agree(_)) {
                *max_ulp = max_ulp.max(standing.ulp);
                if standing.faded {
                    faded.insert(invocation);
                }
            }
        }
        standings.into_iter().map(|standing| standing.verdict).collect()
    }
}

/// The verdict on a sample of a lane by its shape alone; `None` where its words decide.
fn by_shape(
    machine: &mut Machine<'_, Tape<'_>>,
    actual: &Actual,
    invocation: usize,
    slot: usize,
    decided: bool,
) -> Option<Verdict> {
    if let Some(doubt) = cut(machine.domain(), slot) {
        return Some(Verdict::Undetermined(doubt));
    }
    let deviation = shape_of_lane(machine, actual, invocation, slot)?;
    let tape = machine.domain();
    let open = !decided && tape.fork(slot).is_some();
    Some(if open { Verdict::Undetermined(fork(tape, slot)) } else { Verdict::Deviate(deviation) })
}

/// Takes in all words of a lane. `decided` holds where no comparison is in doubt; `sizes` are those of the vectors among the
/// inputs.
fn by_words(
    machine: &mut Machine<'_, Tape<'_>>,
    actual: &Actual,
    invocations: &[usize],
    decided: &[bool],
    sizes: &[f64],
    standings: &mut [SampleVerdict],
) {
    let record = actual.layout().vertex.clone();
    let known: Vec<bool> = (0..standings.len()).map(|slot| machine.domain().given_up(slot).is_none()).collect();
    let places = (0..machine.room()).flat_map(|vertex| (0..record.fields().len()).map(move |field| (vertex, field)));
    for (vertex, field) in places {
        let scale = scales(machine, vertex, record.range(field));
        for word in record.range(field) {
            let open: Vec<usize> = (0..standings.len())
                .filter(|&slot| known[slot] && !matches!(standings[slot].verdict, Verdict::Deviate(_)))
                .filter(|&slot| vertex < actual.stored(invocations[slot]))
                .collect();
            // Of two doubts on a sample the first is kept: no cause is looked for again.
            let mut doubted = [false; SLOTS];
            for &slot in &open {
                doubted[slot] = matches!(standings[slot].verdict, Verdict::Undetermined(_));
            }
            let known = SlotsToJudge { open: &open, decided, doubted: &doubted };
            for (slot, outcome, error) in open_words(machine, actual, invocations, &known, vertex, word) {
                let sizes = (scale[slot], scale[slot].max(sizes[slot]));
                let known = (outcome, error, doubted[slot]);
                let told = told(machine, actual, invocations[slot], (vertex, word, slot), known, sizes);
                standings[slot].tell(told, Blame::Lane);
            }
        }
    }
}
