//! What a program computes on the way for one sample, one expression after the other: strictly in binary32, in real
//! numbers, with how far a conforming device may be off, and how many bits each expression loses of what it is given.

use crate::profile::Profile;
use crate::tape::{Cause, Column, Feeds, Model, Tape};
use crate::verdict::agrees;
use base::value::{Batch, Scalar, ulp_distance};
use program::Probed;
use program::interp::{self, Binary32, Executable, FUEL, InterpError, Machine, Number, OutputColumn};
use program::lane::Stage;
use program::probe::{OperandSource, Step, Trace, TraceError, What};

/// Bits that are lost where nothing is left: a number of binary32 has no more.
pub const ALL_BITS: f64 = 24.0;

/// A probed program in real numbers, with a bound on what each of its steps may be off.
pub struct Meant<'e, 'p> {
    machine: Machine<'e, Tape<'p>>,
    /// Its steps.
    pub trace: Trace<f64>,
    /// The output word in which the trace begins.
    first: usize,
}

impl<'e, 'p> Meant<'e, 'p> {
    /// Runs the one sample of a batch.
    ///
    /// # Errors
    /// [`TraceError`] where the words that were written are no trace.
    pub fn of(
        probed: &Probed,
        executable: &'e Executable,
        model: Model<'p>,
        batch: &Batch,
    ) -> Result<Self, TraceError> {
        let mut machine = Machine::new(executable, Tape::new(model), FUEL);
        machine.run_some(batch, &[0]);
        let words: Vec<f64> = executable
            .outputs()
            .enumerate()
            .map(|(word, scalar)| match machine.output(0, word) {
                OutputColumn::Real(&column) => machine.as_domain().values(column)[0],
                OutputColumn::Word(words) => <f64 as Number>::exact(words[0], scalar),
            })
            .collect();
        let trace = probed.trace::<f64>(&words)?;
        // The trace stands before its length, which is the last word.
        let first = words.len() - 1 - probed.words as usize;
        Ok(Self { machine, trace, first })
    }

    /// The output word of the first value of each step.
    pub fn words(&self) -> impl Iterator<Item = usize> + use<'_, 'e, 'p> {
        self.trace.steps.iter().scan(self.first, |at, step| {
            let own = *at + 1;
            *at = own + step.values.len() + step.leaves.len();
            Some(own)
        })
    }

    /// The column of an output word; `None` for a whole number.
    pub fn column(&self, word: usize) -> Option<Column> {
        match self.machine.output(0, word) {
            OutputColumn::Real(&column) => Some(column),
            OutputColumn::Word(_) => None,
        }
    }

    /// A number with the bound of its column; a whole number has none.
    fn real(&mut self, value: f64, column: Option<Column>) -> TracedReal {
        let tape = self.machine.domain();
        let bound = match column {
            _ if !value.is_finite() => f64::INFINITY,
            Some(column) => tape.bounds(column, &mut |_| false).bound[0],
            None => 0.0,
        };
        TracedReal { value, bound }
    }

    /// The tape.
    pub fn tape(&mut self) -> &mut Tape<'p> {
        self.machine.domain()
    }
}

/// How a program comes to its outputs for one sample.
#[derive(Clone, Debug)]
pub struct Traced {
    /// The steps of strict binary32, in the order in which it takes them.
    pub steps: Vec<TracedStep>,
    /// True when steps at the end did not fit.
    pub cut: bool,
    /// The first step that real numbers do not take: a decision fell otherwise. None behind it has real numbers beside it.
    pub parted: Option<usize>,
    /// True where a decision may fall either way on a device, so that bounds hold on this way alone.
    pub forked: bool,
    /// True where a loop went on for more than [`FUEL`] rounds and was left.
    pub endless: bool,
    /// The output words that were asked for; of whole numbers the bits.
    pub outputs: Vec<TracedValue>,
}

/// One expression, run once.
#[derive(Clone, Debug)]
pub struct TracedStep {
    /// Index of the point of the probed program.
    pub point: usize,
    /// How many times the point has run with this one.
    pub round: usize,
    /// Its values, matrices column by column; of a comparison the two operands.
    pub values: Vec<TracedValue>,
    /// The most bits that a number is off that it takes, of those that are seen.
    pub given: f64,
    /// True where the outputs that were asked for depend on it, and for comparisons, which decide what is done.
    pub feeds: bool,
    /// Why it has no finite value in real numbers, where it has none and its operands have.
    pub cause: Option<Cause>,
    /// Of what it takes from outside the expression, the first that is no finite number: an index of the leaves of the point.
    pub broken_leaf: Option<usize>,
}

impl TracedStep {
    /// The bits that its value lost, the most of all components.
    pub fn lost(&self) -> f64 {
        self.values.iter().map(TracedValue::lost).fold(0.0, f64::max)
    }

    /// The bits that it lost beside those that its operands had lost.
    pub fn own_loss(&self) -> f64 {
        (self.lost() - self.given).max(0.0)
    }

    /// True where a value is no finite number in binary32.
    pub fn is_broken(&self) -> bool {
        self.values.iter().any(|value| !f32::from_bits(value.binary32).is_finite())
    }
}

/// A number of a step.
#[derive(Clone, Copy, Debug)]
pub struct TracedValue {
    /// What strict binary32 has, as bits.
    pub binary32: u32,
    /// What real numbers have; `None` where they went another way.
    pub real: Option<TracedReal>,
}

/// A real number, and how far a conforming device may be off.
#[derive(Clone, Copy, Debug)]
pub struct TracedReal {
    /// The number, in binary64.
    pub value: f64,
    /// The largest error; infinite where nothing is promised.
    pub bound: f64,
}

impl TracedReal {
    /// True for a number that a conforming device may have here.
    pub fn allows(self, found: f32) -> bool {
        !self.value.is_finite() || !self.bound.is_finite() || agrees(f64::from(found), self.value, self.bound)
    }
}

impl TracedValue {
    /// False where nothing was ever written.
    pub fn is_written(&self) -> bool {
        !f32::from_bits(self.binary32).is_poison()
    }

    /// True for a number that binary32 has, in real numbers too.
    pub fn fits(&self) -> bool {
        let fits = |real: TracedReal| real.value.abs() <= f64::from(f32::MAX);
        f32::from_bits(self.binary32).is_finite() && self.real.is_none_or(fits)
    }

    /// The bits that strict binary32 lost: log2 (1 + distance in ULP).
    pub fn lost(&self) -> f64 {
        self.real.map_or(0.0, |real| lost(f32::from_bits(self.binary32), real.value))
    }
}

/// log2 (1 + distance in ULP), at most [`ALL_BITS`]; 0 where neither is a number.
fn lost(found: f32, exact: f64) -> f64 {
    match (found.is_nan(), exact.is_nan()) {
        (true, true) => 0.0,
        (false, false) => (1.0 + ulp_distance(exact, found)).log2().min(ALL_BITS),
        _ => ALL_BITS,
    }
}

/// Why a program cannot be traced.
#[derive(Debug, thiserror::Error)]
pub enum NoTrace {
    /// The interpreter does not run it.
    #[error(transparent)]
    Interp(#[from] InterpError),
    /// What it wrote is no trace.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// Traces the one sample of a batch. Bounds are those of a profile in a stage. What the output words `outputs` depend on is
/// marked.
///
/// # Errors
/// [`NoTrace`] where the interpreter does not run the program.
pub fn trace(
    probed: &Probed,
    (profile, stage): (&Profile, Stage),
    outputs: &[usize],
    batch: &Batch,
) -> Result<Traced, NoTrace> {
    let executable = interp::compile(&probed.program)?;
    let mut strict = Machine::new(&executable, Binary32::default(), FUEL);
    strict.run_some(batch, &[0]);
    let scalars: Vec<Scalar> = executable.outputs().collect();
    let words: Vec<u32> = (0..scalars.len())
        .map(|word| match strict.output(0, word) {
            OutputColumn::Real(column) => column.values()[0].to_bits(),
            OutputColumn::Word(words) => words[0],
        })
        .collect();
    let found = probed.trace::<u32>(&words)?;
    let model = Model::Device { profile, stage, rearranged: profile.rearrangement };
    let mut meant = Meant::of(probed, &executable, model, batch)?;
    let feeds = feeds(&meant, outputs);
    let places: Vec<usize> = meant.words().collect();
    let parted = found.first_difference(&meant.trace, |_, _| true);
    let mut rounds = vec![0; probed.points.len()];
    // The last values of each point.
    let mut last: Vec<Vec<TracedValue>> = vec![Vec::new(); probed.points.len()];
    let mut steps = Vec::new();
    for (at, step) in found.steps.iter().enumerate() {
        let beside = places.get(at).copied().filter(|_| parted.is_none_or(|parted| at < parted));
        let real = beside.map(|_| meant.trace.steps[at].clone());
        let point = &probed.points[step.point];
        rounds[step.point] += 1;
        let operands = operands(point.operands.iter().flatten(), step, real.as_ref(), &last);
        let given = operands.iter().map(TracedValue::lost).fold(0.0, f64::max);
        let begins = operands.iter().all(TracedValue::fits);
        let mut values = Vec::new();
        let (mut feeding, mut cause) = (point.what == What::Comparison, None);
        for (k, &binary32) in step.values.iter().enumerate() {
            let column = beside.and_then(|first| meant.column(first + k));
            let real = real.as_ref().map(|real| real.values[k]);
            if let Some(column) = column {
                feeding |= feeds.as_ref().is_none_or(|feeds| feeds.has(meant.tape(), column));
                // What has no value because of its operands says so at these.
                if begins && cause.is_none() {
                    cause = meant.tape().culprit(column, 0, f64::INFINITY).map(|(cause, _)| cause);
                }
            }
            let real = real.map(|value| meant.real(value, column));
            values.push(TracedValue { binary32, real });
        }
        last[step.point].clone_from(&values);
        let feeds = feeding || beside.is_none();
        let broken_leaf = step.leaves.iter().position(|&leaf| !f32::from_bits(leaf).is_finite());
        let (point, round) = (step.point, rounds[step.point]);
        steps.push(TracedStep { point, round, values, given, feeds, cause, broken_leaf });
    }
    let outputs = outputs.iter().map(|&word| {
        let column = meant.column(word);
        let real = column.map(|column| meant.real(meant.machine.as_domain().values(column)[0], Some(column)));
        // What a loop left out has no number.
        TracedValue { binary32: words[word], real: real.filter(|real| !real.value.is_poison()) }
    });
    let outputs = outputs.collect();
    let forked = meant.machine.as_domain().fork(0).is_some();
    let endless = strict.flags()[0].is_stopped();
    Ok(Traced { steps, cut: found.cut, parted, forked, endless, outputs })
}

/// The columns that outputs depend on; `None` where there are no outputs, or one is a whole number, of which no column tells.
fn feeds(meant: &Meant<'_, '_>, outputs: &[usize]) -> Option<Feeds> {
    let columns: Option<Vec<Column>> = outputs.iter().map(|&word| meant.column(word)).collect();
    let columns = columns.filter(|columns| !columns.is_empty())?;
    Some(meant.machine.as_domain().feeds(&columns, 0))
}

/// The numbers that a step takes, of those that are seen.
fn operands<'s>(
    sources: impl Iterator<Item = &'s OperandSource>,
    step: &Step<u32>,
    real: Option<&Step<f64>>,
    last: &[Vec<TracedValue>],
) -> Vec<TracedValue> {
    let of = |source: &OperandSource| match *source {
        OperandSource::Point { point, component } => last[point].get(component as usize).copied(),
        OperandSource::Leaf(k) => {
            let real = real.and_then(|real| real.leaves.get(k)).map(|&value| TracedReal { value, bound: 0.0 });
            Some(TracedValue { binary32: *step.leaves.get(k)?, real })
        }
        OperandSource::Literal(_) | OperandSource::Operation(_) | OperandSource::Untraced => None,
    };
    sources.filter_map(of).collect()
}
