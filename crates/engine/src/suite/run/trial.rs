//! A prepared suite on an open lane.

use base::value::Batch;
use judge::profile::Promises;
use judge::verdict::{Deviation, Fence, Fenced, JudgeContext, Oracle, Verdict, judge_each};
use lanes::{Actual, Lane, LaneError, Runner, Stage};
use program::{Form, InputSource, Kernel, Program};
use property::Sample;

use super::Prepared;

/// Invocations of one batch: full dispatches at little memory.
const BATCH: usize = 1 << 17;
/// Words of the largest buffer of a batch: 32 MiB.
const BATCH_WORDS: usize = 1 << 23;

/// The stage in which inputs from a source are taken.
pub fn stage_of(source: InputSource) -> Stage {
    match source {
        InputSource::Constants | InputSource::Uniforms | InputSource::Storage => Stage::Compute,
        InputSource::Attributes => Stage::Vertex,
    }
}

/// Samples whose inputs are literals of one module: each is a copy of the shader for the compiler.
const LITERALS: usize = 16;
/// Expressions of all copies in one module.
const COPIED: usize = 4096;

/// Expressions of a program: how much a compiler has to do for each copy of it.
pub fn weight(program: &Program) -> usize {
    let functions = program.module.functions.iter().map(|(_, f)| f);
    let all = functions.chain(program.module.entry_points.iter().map(|point| &point.function));
    // What emits vertices does so in loops, which compilers unroll where inputs are constants.
    let rounds = program.output_layout().max_vertices.unwrap_or(1).max(1) as usize;
    all.map(|f| f.expressions.len()).sum::<usize>().max(1) * rounds
}

/// The kernel of a program for a source.
pub fn kernel_from(program: &Program, source: InputSource, batch: &Batch) -> Result<Kernel, LaneError> {
    program.kernel_from(source, batch).map_err(|error| LaneError::Unsupported(error.to_string()))
}

/// A runner that makes a module of its own for every batch, with the inputs as literals.
struct Literals<'a> {
    lane: &'a dyn Lane,
    program: &'a Program,
    capacity: usize,
}

impl Runner for Literals<'_> {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let kernel = kernel_from(self.program, InputSource::Constants, batch)?;
        self.lane.prepare(&kernel, batch.invocation_count())?.run(batch)
    }
}

/// Of a large dispatch the judge of whole dispatches alone says anything: see `super::large`.
fn refuse_large(prepared: &Prepared) -> Result<(), LaneError> {
    match prepared.program.is_large() {
        true => Err(LaneError::Unsupported(
            "single samples of a dispatch of 4,096 words or more; name a smaller size".to_owned(),
        )),
        false => Ok(()),
    }
}

/// Copies of a sample that are run beside others where each is a dispatch.
const FEW: usize = 3;

/// Other invocations in the batch of some samples.
#[derive(Clone, Copy, Debug)]
pub struct Among {
    /// Before them.
    pub before: usize,
    /// Behind them.
    pub behind: usize,
}

impl Among {
    /// At both ends of a batch, near them, and between: each in other work groups than most others.
    pub const ALL: [Self; 5] = [
        Self { before: 0, behind: 1024 },
        Self { before: 1024, behind: 0 },
        Self { before: 3, behind: 1021 },
        Self { before: 581, behind: 443 },
        Self { before: 67, behind: 957 },
    ];
}

/// A kernel of a suite on a lane.
pub struct Trial<'a> {
    /// The suite.
    pub prepared: &'a Prepared,
    /// What the lane is held against.
    promises: &'a Promises,
    stage: Stage,
    oracle: &'a Oracle,
    runner: Fence<'a>,
    /// Where inputs come from, when it is not what the stage says.
    pub source: Option<InputSource>,
}

impl<'a> Trial<'a> {
    /// Makes the kernel ready for large batches.
    ///
    /// # Errors
    /// [`LaneError`] when the lane refuses the kernel.
    pub fn new(
        prepared: &'a Prepared,
        lane: &dyn Lane,
        kernel: &Kernel,
        promises: &'a Promises,
    ) -> Result<Self, LaneError> {
        Self::with_capacity(prepared, lane, kernel, promises, BATCH)
    }

    /// Makes the kernel ready for batches of at most `most` invocations.
    ///
    /// # Errors
    /// [`LaneError`] when the lane refuses the kernel.
    pub fn with_capacity(
        prepared: &'a Prepared,
        lane: &dyn Lane,
        kernel: &Kernel,
        promises: &'a Promises,
        most: usize,
    ) -> Result<Self, LaneError> {
        refuse_large(prepared)?;
        let widest = kernel.output.words().max(kernel.invocation.words()).max(kernel.case.words()).max(1);
        let capacity = most.min(BATCH_WORDS / widest).max(1);
        let stage = match kernel.form {
            Form::Compute | Form::Uniforms | Form::Constants | Form::Dispatch { .. } => Stage::Compute,
            Form::Vertex { .. } => Stage::Vertex,
            Form::Geometry => Stage::Geometry,
        };
        let oracle = prepared.oracle_of(lane);
        let runner = Fence::new(lane.prepare(kernel, capacity)?, oracle, &kernel.output);
        Ok(Self { prepared, promises, stage, oracle, runner, source: None })
    }

    /// Makes a kernel ready whose inputs come from a source, for batches of at most `most` invocations.
    ///
    /// # Errors
    /// [`LaneError`] when there is no such kernel, or the lane refuses it.
    pub fn from_source(
        prepared: &'a Prepared,
        lane: &'a dyn Lane,
        source: InputSource,
        promises: &'a Promises,
        most: usize,
    ) -> Result<Self, LaneError> {
        refuse_large(prepared)?;
        let stage = stage_of(source);
        let runner: Box<dyn Runner + 'a> = match (source, &prepared.vertex) {
            (InputSource::Constants, _) => {
                // A lane that takes no literals says so before anything is run.
                let program = &prepared.program;
                let (invocation, case) = (&prepared.compute.invocation, &prepared.compute.case);
                let zero = Sample {
                    invocation: vec![0; invocation.words()],
                    case: vec![0; case.words()],
                    invocation_record: invocation.clone(),
                    case_record: case.clone(),
                };
                lane.prepare(&kernel_from(program, source, &Sample::batch(&[zero]))?, 1)?;
                Box::new(Literals {
                    lane,
                    program,
                    capacity: most.min(LITERALS).min((COPIED / weight(program)).max(1)),
                })
            }
            (InputSource::Storage, _) => {
                return Ok(Self {
                    source: Some(source),
                    ..Self::with_capacity(prepared, lane, &prepared.compute, promises, most)?
                });
            }
            (InputSource::Attributes, Some(vertex)) => {
                return Ok(Self {
                    source: Some(source),
                    ..Self::with_capacity(prepared, lane, vertex, promises, most)?
                });
            }
            (InputSource::Uniforms | InputSource::Attributes, _) => {
                let (invocation, case) = (prepared.compute.invocation.clone(), prepared.compute.case.clone());
                let none = Batch::with_capacity(invocation, case, 1, 0);
                lane.prepare(&kernel_from(&prepared.program, source, &none)?, most)?
            }
        };
        let oracle = prepared.oracle_of(lane);
        let runner = Fence::new(runner, oracle, &prepared.compute.output);
        Ok(Self { prepared, promises, stage, oracle, runner, source: Some(source) })
    }

    /// The same in a stage that the kernel does not tell: functions run in any.
    pub(super) fn in_stage(self, stage: Stage) -> Self {
        Self { stage, ..self }
    }

    /// What verdicts on the lane's outputs need.
    pub fn context(&self) -> JudgeContext<'a> {
        let (oracle, reference) = (self.oracle, &self.prepared.reference);
        JudgeContext { oracle, reference, promises: self.promises, stage: self.stage }
    }

    /// The failure of the executor since which invocations with undefined behaviour are left out.
    pub(super) fn fenced(&self) -> Option<&Fenced> {
        self.runner.found()
    }

    /// Most invocations of one batch.
    pub fn capacity(&self) -> usize {
        self.runner.capacity()
    }

    /// Runs a batch in one dispatch.
    ///
    /// # Errors
    /// [`LaneError`]; the outputs are then gone.
    pub fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        self.runner.run(batch)
    }

    /// Runs samples, each with uniforms of its own, in as few dispatches as fit, and hands each
    /// dispatch to `each` with the index of its first sample.
    ///
    /// # Errors
    /// [`LaneError`]; the outputs of the failing dispatch are then gone.
    pub fn run_samples(
        &mut self,
        samples: &[Sample],
        mut each: impl FnMut(usize, &Batch, &Actual),
    ) -> Result<(), LaneError> {
        let capacity = self.capacity();
        for (k, chunk) in samples.chunks(capacity).enumerate() {
            let batch = Sample::batch(chunk);
            let actual = self.run(&batch)?;
            each(k * capacity, &batch, &actual);
        }
        Ok(())
    }

    /// Samples with copies of the first of them at both ends, and how many stand before them.
    pub(super) fn among(&self, samples: &[Sample], Among { before, behind }: Among) -> (Vec<Sample>, usize) {
        // A shader without inputs has one invocation.
        let constant = samples.first().is_none_or(|s| s.invocation.is_empty() && s.case.is_empty());
        let alone = matches!(self.source, Some(InputSource::Constants | InputSource::Uniforms));
        let (before, behind) = match (constant, alone) {
            (true, _) => (0, 0),
            (false, true) => (before.min(FEW), 0),
            (false, false) => (before, behind),
        };
        let copies = |many: usize| samples.first().into_iter().cycle().take(many);
        (copies(before).chain(samples).chain(copies(behind)).cloned().collect(), before)
    }

    /// Runs samples behind and before copies of the first of them, and hands each to `each` with its index and its
    /// place in its dispatch. Where each sample takes a dispatch or a copy of the shader, there are few copies.
    ///
    /// # Errors
    /// [`LaneError`]; the outputs of the failing dispatch are then gone.
    pub fn run_among(
        &mut self,
        samples: &[Sample],
        among: Among,
        mut each: impl FnMut(usize, usize, &Batch, &Actual),
    ) -> Result<(), LaneError> {
        let (all, before) = self.among(samples, among);
        self.run_samples(&all, |first, batch, actual| {
            for place in 0..batch.invocation_count() {
                if let Some(sample) = (first + place).checked_sub(before).filter(|&k| k < samples.len()) {
                    each(sample, place, batch, actual);
                }
            }
        })
    }

    /// For each sample, whether it deviates in a way that counts.
    ///
    /// # Errors
    /// [`LaneError`]; there is no verdict then.
    pub fn deviates(
        &mut self,
        samples: &[Sample],
        counts: &dyn Fn(&Deviation) -> bool,
    ) -> Result<Vec<bool>, LaneError> {
        let mut verdicts = Vec::with_capacity(samples.len());
        let context = self.context();
        self.run_samples(samples, |_, batch, actual| {
            let deviates = |verdict: Verdict| matches!(verdict, Verdict::Deviate(deviation) if counts(&deviation));
            verdicts.extend(judge_each(&context, batch, actual).into_iter().map(deviates));
        })?;
        Ok(verdicts)
    }
}
