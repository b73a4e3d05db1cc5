//! What is expected of the samples of a batch, by one thread.

use super::model::Model;
use super::{Expected, Reference, ReferenceKind, given};
use crate::tape::Tape;
use crate::verdict::follow::{self, OnPath};
use crate::verdict::second_pass::{TWO_WAYS, USELESS_64};
use base::value::{Batch, Scalar};
use program::interp::{Binary64, Domain, InterpError, Machine, Number, OutputColumn, POISON, SLOTS};

/// Gives what is expected, for up to [`SLOTS`] invocations at a time.
pub(in crate::verdict) struct Evaluator<'a> {
    reference: &'a Reference,
    /// Inputs of a formula, and the case whose uniforms they hold.
    inputs: Vec<f64>,
    case: usize,
    model: Option<ModelRun<'a>>,
    /// Whether what binary64 does to the reference counts as its slack.
    bounded: bool,
}

/// A model and what it gave last.
struct ModelRun<'a> {
    model: &'a Model,
    machine: Interpreter<'a>,
    given: Gave,
}

/// What a model gave in a run: values by vertex, word and slot.
struct Gave {
    values: Vec<f64>,
    slack: Vec<f64>,
    emitted: Vec<u32>,
    strips: Vec<u32>,
    /// Slots in which a loop does not end: there is nothing to compare with.
    endless: [bool; SLOTS],
}

enum Interpreter<'a> {
    Plain(Box<Machine<'a, Binary64>>),
    Bounded(Box<Machine<'a, Tape<'a>>>),
}

impl<'a> Evaluator<'a> {
    /// For a first look.
    pub fn new(reference: &'a Reference) -> Self {
        Self::with(reference, false)
    }

    /// With how far the expectation itself may be off.
    pub fn bounded(reference: &'a Reference) -> Self {
        Self::with(reference, true)
    }

    fn with(reference: &'a Reference, bounded: bool) -> Self {
        let inputs = match &reference.source {
            ReferenceKind::Formula(bound) => bound.scratch(),
            ReferenceKind::Model(_) | ReferenceKind::Given(_) | ReferenceKind::Recorded(_) | ReferenceKind::Nothing => {
                Vec::new()
            }
        };
        Self { reference, inputs, case: usize::MAX, model: None, bounded }
    }

    /// Turns to these invocations of a batch, at most [`SLOTS`] of them.
    pub fn turn_to(&mut self, batch: &Batch, invocations: &[usize]) {
        self.case = usize::MAX;
        if let ReferenceKind::Model(model) = &self.reference.source {
            let bounded = self.bounded;
            self.model.get_or_insert_with(|| ModelRun::new(model, bounded)).run(batch, invocations);
        }
    }

    /// What is expected of the invocation in place `slot` of those that were turned to.
    pub fn expected(&mut self, batch: &Batch, invocation: usize, slot: usize, expected: &mut Expected) {
        match &self.reference.source {
            ReferenceKind::Formula(bound) => {
                let case = invocation / batch.per_case;
                if case != self.case {
                    bound.read_case(batch, case, &mut self.inputs);
                    self.case = case;
                }
                bound.eval(batch, invocation, &mut self.inputs, self.reference.vertex_words, expected);
            }
            ReferenceKind::Model(_) => {
                if let Some(running) = &self.model {
                    running.given.expected(running.model, slot, expected);
                }
            }
            ReferenceKind::Given(rules) => given::eval(rules, &self.reference.outputs, (batch, invocation), expected),
            ReferenceKind::Recorded(recorded) => recorded.eval(batch, invocation, expected),
            ReferenceKind::Nothing => expected.clear(),
        }
    }

    /// Whether a decision of a reference that was turned to may go either way in a slot.
    pub fn is_open(&self, slot: usize) -> bool {
        match self.model.as_ref().map(|running| &running.machine) {
            Some(Interpreter::Bounded(machine)) => follow::is_open(machine.as_domain(), slot),
            Some(Interpreter::Plain(_)) | None => false,
        }
    }

    /// What is expected of invocations on each path through decisions of the reference; `None` where these are too many. What
    /// was turned to is forgotten.
    pub fn on_all_paths(&mut self, batch: &Batch, invocations: &[usize]) -> Vec<Option<Vec<Expected>>> {
        if let Some(running) = &mut self.model {
            return running.on_all_paths(batch, invocations);
        }
        self.turn_to(batch, invocations);
        let mut of = |(slot, &invocation): (usize, &usize)| {
            let mut expected = Expected::default();
            self.expected(batch, invocation, slot, &mut expected);
            Some(vec![expected])
        };
        invocations.iter().enumerate().map(&mut of).collect()
    }
}

impl Reference {
    /// What is expected of an invocation that is a large dispatch; `bounded` with how far that may be off: infinitely where a
    /// decision may go either way, or a loop does not end.
    ///
    /// # Errors
    /// [`InterpError`] for a reference that is no large dispatch.
    pub(in crate::verdict) fn expect_whole(
        &self,
        batch: &Batch,
        invocation: usize,
        bounded: bool,
    ) -> Result<Expected, InterpError> {
        let mut expected = Expected::default();
        let ReferenceKind::Model(model) = &self.source else {
            let mut evaluator = Evaluator::with(self, bounded);
            evaluator.turn_to(batch, &[invocation]);
            evaluator.expected(batch, invocation, 0, &mut expected);
            return Ok(expected);
        };
        let own = model.batch(batch, &[invocation]);
        let words = || model.outputs.iter().cloned().flatten();
        let exact = |ran: &[u32], word: usize| <f64 as Number>::exact(ran[word], model.scalar_of(word));
        let is_real = |word: usize| model.scalar_of(word) == Scalar::F32;
        if !bounded {
            let ran = model.oracle.plain_whole(&own, 0)?;
            let value = |word| if is_real(word) { ran.cells[word] } else { exact(&ran.words, word) };
            expected.words = words().map(value).collect();
            return Ok(expected);
        }
        let ran = model.oracle.ideal_whole(&own, 0)?;
        for word in words() {
            let cell = ran.cells[word];
            let (value, radius) = match is_real(word) {
                true => (cell.value, TWO_WAYS * cell.radius),
                false => (exact(&ran.words, word), 0.0),
            };
            expected.words.push(value);
            expected.slack.push(if ran.open[word] || !ran.whole { f64::INFINITY } else { radius });
        }
        Ok(expected)
    }

    /// Rounds of loops that it takes to say what is expected of an invocation that is a large dispatch.
    ///
    /// # Errors
    /// [`InterpError`] for a reference that is no large dispatch.
    pub(in crate::verdict) fn rounds_of_whole(&self, batch: &Batch, invocation: usize) -> Result<u64, InterpError> {
        let ReferenceKind::Model(model) = &self.source else { return Ok(0) };
        Ok(model.oracle.plain_whole(&model.batch(batch, &[invocation]), 0)?.rounds)
    }
}

impl<'a> ModelRun<'a> {
    fn new(model: &'a Model, bounded: bool) -> Self {
        let machine = if bounded {
            Interpreter::Bounded(Box::new(model.oracle.ideal_tape()))
        } else {
            Interpreter::Plain(Box::new(model.oracle.ideal_or_meaning()))
        };
        let (values, slack, emitted, strips) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { model, machine, given: Gave { values, slack, emitted, strips, endless: [false; SLOTS] } }
    }

    fn run(&mut self, batch: &Batch, invocations: &[usize]) {
        let own = self.model.batch(batch, invocations);
        match &mut self.machine {
            Interpreter::Plain(machine) => machine.run(&own, 0),
            Interpreter::Bounded(machine) => machine.run(&own, 0),
        };
        self.machine.read(self.model, &mut self.given);
    }

    /// What is expected of invocations on each path through decisions that may go either way; `None` where they are too many.
    fn on_all_paths(&mut self, batch: &Batch, invocations: &[usize]) -> Vec<Option<Vec<Expected>>> {
        let own = self.model.batch(batch, invocations);
        let (model, given) = (self.model, &mut self.given);
        let Interpreter::Bounded(machine) = &mut self.machine else { return vec![None; invocations.len()] };
        let mut all: Vec<Vec<Expected>> = vec![Vec::new(); invocations.len()];
        let samples: Vec<usize> = (0..invocations.len()).collect();
        let known = follow::on_all_paths(machine, &own, &samples, &mut |machine, _, seen| {
            given.read_bounded(machine, model);
            for &OnPath { slot, sample, .. } in seen {
                let mut expected = Expected::default();
                given.expected(model, slot, &mut expected);
                all[sample].push(expected);
            }
            Vec::new()
        });
        all.into_iter().zip(known).map(|(all, known)| known.then_some(all)).collect()
    }
}

impl Interpreter<'_> {
    /// What the last run gave.
    fn read(&mut self, model: &Model, given: &mut Gave) {
        match self {
            Self::Plain(machine) => given.read_plain(machine, model),
            Self::Bounded(machine) => given.read_bounded(machine, model),
        }
    }
}

impl Gave {
    fn read_plain(&mut self, machine: &mut Machine<'_, Binary64>, model: &Model) {
        let Self { values, slack, emitted, strips, endless } = self;
        values.clear();
        slack.clear();
        each_word(machine, model, |machine, (vertex, word)| {
            values.extend_from_slice(&match machine.output(vertex, word) {
                OutputColumn::Real(column) => *column.values(),
                OutputColumn::Word(words) => exact(words, model, word),
            });
        });
        *endless = shape(machine, emitted, strips);
    }

    fn read_bounded(&mut self, machine: &mut Machine<'_, Tape<'_>>, model: &Model) {
        let Self { values, slack, emitted, strips, endless } = self;
        values.clear();
        slack.clear();
        each_word(machine, model, |machine, (vertex, word)| match machine.output(vertex, word) {
            OutputColumn::Real(&column) => {
                let tape = machine.domain();
                values.extend_from_slice(tape.values(column));
                let bounds = tape.bounds(column, &mut |_| false);
                // Where a comparison could go either way, or binary64 is too coarse, it may be any.
                let values = *tape.values(column);
                slack.extend((0..SLOTS).map(|slot| {
                    let bound = TWO_WAYS * bounds.bound[slot];
                    let known = tape.fork(slot).is_none() && bound <= USELESS_64 * values[slot].abs().max(1.0);
                    if known { bound } else { f64::INFINITY }
                }));
            }
            OutputColumn::Word(words) => {
                values.extend_from_slice(&exact(words, model, word));
                let tape = machine.domain();
                slack.extend((0..SLOTS).map(|slot| tape.fork(slot).map_or(0.0, |_| f64::INFINITY)));
            }
        });
        *endless = shape(machine, emitted, strips);
    }

    fn expected(&self, model: &Model, slot: usize, expected: &mut Expected) {
        expected.clear();
        let words: usize = model.outputs.iter().map(ExactSizeIterator::len).sum();
        let stored = if model.emits() { self.emitted[slot] as usize } else { 1 };
        let room = self.strips.len() / SLOTS;
        for vertex in 0..stored {
            // Vertices past the limit are counted and have no values.
            let at = (vertex < room && !self.endless[slot]).then_some(vertex * words);
            let pick = |list: &[f64], k: usize| at.and_then(|at| list.get((at + k) * SLOTS + slot).copied());
            expected.words.extend((0..words).map(|k| pick(&self.values, k).unwrap_or(f64::NAN)));
            if !self.slack.is_empty() {
                expected.slack.extend((0..words).map(|k| pick(&self.slack, k).unwrap_or(0.0)));
            }
            if model.emits() {
                expected.strips.push(self.strips.get(vertex * SLOTS + slot).copied().unwrap_or_default());
            }
        }
    }
}

/// Calls `each` for every vertex and word that is judged, in order.
fn each_word<D: Domain>(
    machine: &mut Machine<'_, D>,
    model: &Model,
    mut each: impl FnMut(&mut Machine<'_, D>, (usize, usize)),
) {
    for vertex in 0..machine.room() {
        for word in model.outputs.iter().cloned().flatten() {
            each(machine, (vertex, word));
        }
    }
}

/// How many vertices each slot emitted, and their strips; whether its loops do not end.
fn shape<D: Domain>(machine: &Machine<'_, D>, emitted: &mut Vec<u32>, strips: &mut Vec<u32>) -> [bool; SLOTS] {
    emitted.clear();
    emitted.extend_from_slice(machine.emitted());
    strips.clear();
    for vertex in 0..machine.room() {
        match machine.is_emitting() {
            true => strips.extend_from_slice(machine.strip(vertex)),
            false => strips.extend_from_slice(&[0; SLOTS]),
        }
    }
    std::array::from_fn(|slot| machine.flags()[slot].is_stopped())
}

/// Whole numbers; NaN where none was written.
fn exact(words: &[u32; SLOTS], model: &Model, word: usize) -> [f64; SLOTS] {
    let scalar = model.scalar_of(word);
    words.map(|word| if word == POISON { f64::NAN } else { <f64 as Number>::exact(word, scalar) })
}
