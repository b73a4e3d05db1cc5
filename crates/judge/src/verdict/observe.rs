//! What relations get to see: a lane's values with how far each may be off.

use super::judge::real;
use super::oracle::JudgeContext;
use super::parallel::parts;
use super::passes::Passes;
use crate::profile::Promises;
use crate::tape::{Cell, Model, Tape};
use base::value::{Batch, Scalar};
use program::interp::group::Ran;
use program::interp::{InterpError, Machine, Number, OutputColumn, SLOTS};
use program::lane::{Actual, Api, Stage};
use property::Observed;

/// The outputs of every invocation of a batch as numbers, each with how far it may be from what the
/// author wrote: what the most lenient promise allows, and the rounding of literals; infinite where
/// nothing is promised. The words are those of the formula's outputs, in
/// their order, and then all others; nothing else of the formula is used.
pub fn observe(context: &JudgeContext<'_>, batch: &Batch, actual: &Actual) -> Vec<Observed> {
    let slack = slack(context, batch);
    (0..batch.invocation_count()).map(|i| observed(context, actual, i, &slack[i])).collect()
}

/// How far each word may be off, for every invocation: by vertex, then by word of the record.
pub(super) type Slack = Vec<Vec<f64>>;

/// The slack of the outputs of a batch; it depends on the program and its inputs alone.
fn slack(context: &JudgeContext<'_>, batch: &Batch) -> Slack {
    let count = batch.invocation_count();
    let chunks = parts(
        count.div_ceil(SLOTS),
        || context.oracle.authored_tape(context.lenient()),
        |machine, chunk| slack_of(machine, batch, chunk * SLOTS),
    );
    chunks.into_iter().flatten().collect()
}

/// The slack of the invocations from `first` on, as many as the machine takes. It is infinite where
/// nothing is promised, where the shader has no value, and where a decision could go either way.
pub(super) fn slack_of(machine: &mut Machine<'_, Tape<'_>>, batch: &Batch, first: usize) -> Slack {
    let slots = machine.run(batch, first);
    let width = machine.width();
    let mut slack = vec![vec![0.0; machine.room() * width]; slots];
    for vertex in 0..machine.room() {
        for word in 0..width {
            let at = vertex * width + word;
            let OutputColumn::Real(&column) = machine.output(vertex, word) else { continue };
            let tape = machine.domain();
            let bounds = tape.bounds(column, &mut |_| false);
            for (slot, slack) in slack.iter_mut().enumerate() {
                let open = tape.fork(slot).is_some() || !tape.values(column)[slot].is_finite();
                slack[at] = if open { f64::INFINITY } else { bounds.bound[slot] };
            }
        }
    }
    slack
}

/// What the shader means for every invocation of a batch, with its literals as they were written: a
/// relation such as "a whole turn leads back" is about 2π and not about the binary32 beside it. The
/// slack is what a device that rounds every operation correctly would be off: related inputs are
/// binary32 numbers, and related to each other no better than that. No lane and no promise has a say
/// in it.
pub fn meaning(context: &JudgeContext<'_>, batch: &Batch) -> Vec<Observed> {
    let count = batch.invocation_count();
    let chunks = parts(
        count.div_ceil(SLOTS),
        || context.oracle.ideal_device_tape(strict()),
        |machine, chunk| {
            let slack = slack_of(machine, batch, chunk * SLOTS);
            let see = |(slot, slack): (usize, &Vec<f64>)| meant(context, machine, slot, slack);
            slack.iter().enumerate().map(see).collect::<Vec<_>>()
        },
    );
    chunks.into_iter().flatten().collect()
}

/// What [`observe`] gives of a large dispatch: how far a word may be off is the radius that goes with it through memory.
///
/// # Errors
/// [`InterpError`] for what is no large dispatch.
pub fn observe_whole(passes: &Passes<'_>, actual: &Actual) -> Result<Observed, InterpError> {
    let context = passes.context();
    let ran = passes.authored(context.lenient())?;
    let words = actual.vertex(0, 0);
    let absent = actual.is_absent(0);
    let value = |word: usize, scalar| if absent { f64::NAN } else { real(words[word], scalar) };
    Ok(of_words(context, &ran, |word, scalar| (value(word, scalar), absent)))
}

/// What [`meaning`] gives of a large dispatch.
///
/// # Errors
/// [`InterpError`] for what is no large dispatch.
pub fn meaning_whole(passes: &Passes<'_>) -> Result<Observed, InterpError> {
    let ran = passes.ideal_device(strict())?;
    Ok(of_words(passes.context(), &ran, |word, scalar| match scalar {
        Scalar::F32 => (ran.cells[word].value, false),
        scalar => (real(ran.words[word], scalar), false),
    }))
}

/// The outputs of a large dispatch. `value` gives a word with whether nothing is known of it.
fn of_words(context: &JudgeContext<'_>, ran: &Ran<Cell>, value: impl Fn(usize, Scalar) -> (f64, bool)) -> Observed {
    let mut observed = Observed { vertices: 1, words: Vec::new(), slack: Vec::new() };
    for output in &context.reference.seen {
        for word in output.actual.clone() {
            let (seen, unknown) = value(word, output.scalar);
            let Cell { value, radius, .. } = ran.cells[word];
            let open = unknown || ran.open[word] || !ran.whole;
            observed.words.push(seen);
            observed.slack.push(match output.scalar {
                _ if open => f64::INFINITY,
                Scalar::F32 if !value.is_finite() => f64::INFINITY,
                Scalar::F32 => radius,
                _ => 0.0,
            });
        }
    }
    observed
}

/// A device without an error of its own.
fn strict() -> Model<'static> {
    let profile = Promises::of_api(Api::Binary32).text;
    Model::Device { profile, stage: Stage::Compute, rearranged: false }
}

fn meant(context: &JudgeContext<'_>, machine: &mut Machine<'_, Tape<'_>>, slot: usize, slack: &[f64]) -> Observed {
    let stored = if machine.is_emitting() { machine.emitted()[slot] as usize } else { 1 };
    let vertices = stored.min(machine.room());
    let mut observed = Observed { vertices, words: Vec::new(), slack: Vec::new() };
    for vertex in 0..vertices {
        for output in &context.reference.seen {
            for word in output.actual.clone() {
                let value = match machine.output(vertex, word) {
                    OutputColumn::Real(&column) => machine.domain().values(column)[slot],
                    OutputColumn::Word(words) => <f64 as Number>::exact(words[slot], output.scalar),
                };
                observed.words.push(value);
                observed.slack.push(slack[vertex * machine.width() + word]);
            }
        }
    }
    observed
}

/// One invocation, with the slack of its words.
fn observed(context: &JudgeContext<'_>, actual: &Actual, invocation: usize, slack: &[f64]) -> Observed {
    let vertices = actual.stored(invocation);
    let mut observed = Observed { vertices, words: Vec::new(), slack: Vec::new() };
    let width = context.oracle.executable.outputs().len();
    for vertex in 0..vertices {
        let words = actual.vertex(invocation, vertex);
        for output in &context.reference.seen {
            for word in output.actual.clone() {
                if actual.is_absent(invocation) {
                    observed.words.push(f64::NAN);
                    observed.slack.push(f64::INFINITY);
                    continue;
                }
                observed.words.push(real(words[word], output.scalar));
                observed.slack.push(slack.get(vertex * width + word).copied().unwrap_or(f64::INFINITY));
            }
        }
    }
    observed
}
