//! What relations get to see: a lane's values with how far each may be off.

use super::judge::real;
use super::oracle::JudgeContext;
use super::parallel::parts;
use super::passes::Passes;
use crate::profile::{Flush, Profile, Promises};
use crate::tape::{Cell, Model, Tape};
use base::value::{Batch, Scalar};
use program::interp::group::Ran;
use program::interp::{InterpError, Machine, Number, OutputColumn, SLOTS};
use program::lane::{Actual, Api, Stage};
use property::Observed;

/// How far each word of an output may be off, for every invocation: by vertex, then by word of the record.
pub type Slack = Vec<Vec<f64>>;

/// How far the outputs of each invocation of a batch may be from what the author wrote: what the most lenient promise
/// allows, and the rounding of literals; infinite where nothing is promised. It depends on the program, its inputs and the
/// [`Lenience`] alone, and on no lane.
pub fn slack(context: &JudgeContext<'_>, batch: &Batch) -> Slack {
    let chunks = parts(
        batch.invocation_count().div_ceil(SLOTS),
        || context.oracle.authored_tape(context.lenient()),
        |machine, chunk| slack_of(machine, batch, chunk * SLOTS),
    );
    chunks.into_iter().flatten().collect()
}

/// What a [`slack`] rests on beside program and inputs. Equal ones give equal slack.
#[derive(Clone, Copy, Debug)]
pub struct Lenience {
    profile: &'static Profile,
    flush: Flush,
}

impl PartialEq for Lenience {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.profile, other.profile) && self.flush == other.flush
    }
}

impl JudgeContext<'_> {
    /// What the most lenient promise is.
    pub fn lenience(&self) -> Lenience {
        let profile = self.promises.lenient();
        Lenience { profile, flush: profile.flush(self.stage) }
    }
}

/// The outputs of every invocation of a batch as numbers, each with how far it may be off: `slack` gives that by the number
/// of the invocation. The words are those of the formula's outputs, in their order, and then all others; nothing else of
/// the formula is used.
pub fn observe<'s>(context: &JudgeContext<'_>, actual: &Actual, slack: impl Fn(usize) -> &'s [f64]) -> Vec<Observed> {
    (0..actual.count()).map(|i| observed(context, actual, i, slack(i))).collect()
}

/// What was observed, as another [`slack`] of the same inputs has it.
pub fn observe_again(context: &JudgeContext<'_>, seen: &Observed, slack: &[f64]) -> Observed {
    let absent = seen.words.iter().all(|word| word.is_nan()) && seen.slack.iter().all(|slack| slack.is_infinite());
    let slack = if absent { seen.slack.clone() } else { slack_of_words(context, seen.vertices, slack) };
    Observed { slack, ..seen.clone() }
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
    let (vertices, absent) = (actual.stored(invocation), actual.is_absent(invocation));
    let mut words = Vec::new();
    for vertex in 0..vertices {
        let found = actual.vertex(invocation, vertex);
        for output in &context.reference.seen {
            let value = |word: usize| if absent { f64::NAN } else { real(found[word], output.scalar) };
            words.extend(output.actual.clone().map(value));
        }
    }
    let slack = if absent { vec![f64::INFINITY; words.len()] } else { slack_of_words(context, vertices, slack) };
    Observed { vertices, words, slack }
}

/// The slack of the words that relations see, of all words of so many vertices.
fn slack_of_words(context: &JudgeContext<'_>, vertices: usize, slack: &[f64]) -> Vec<f64> {
    let width = context.oracle.executable.outputs().len();
    let seen = || context.reference.seen.iter().flat_map(|output| output.actual.clone());
    let all = (0..vertices).flat_map(|vertex| seen().map(move |word| vertex * width + word));
    all.map(|at| slack.get(at).copied().unwrap_or(f64::INFINITY)).collect()
}
