//! Blocks of reference data.

use std::ops::Range;

use rayon::prelude::*;
use thiserror::Error;

use super::array::{Array, Per, Role};
use super::digest::Digest;
use super::document::{
    Document, ExpectedSource, NO_DIGEST, ProfileSource, SCHEMA, SCHEMA_VERSION, SuiteSource, Tool, flag_bits,
};
use super::flags::{Flag, Flags};
use super::layout::{arrays, domain, equations};
use super::number::upward;
use crate::bound::profile::Profile;
use crate::bound::profile::grid::MIN_NORMAL;
use crate::exact::{Exact, Words};
use crate::formula::{Param, Rule};
use crate::interp::LANES;
use crate::lane::Stage;
use crate::math::twofold::{Twofold, WIDTH};
use crate::math::wide;
use crate::property::{Sampler, encode};
use crate::suite::Expect;
use crate::suite::run::Prepared;
use crate::value::{Batch, Field, Record, Scalar};
use crate::verdict::{Limiter, Limits, Meant, Reason};

/// Samples of a block, as far as whole cases fit.
const BLOCK_ROWS: u64 = 1 << 16;
/// Words of the largest array of a block: 32 MiB.
const BLOCK_WORDS: u64 = 1 << 23;
/// A bound of this part of the size of an output makes it ill-conditioned.
const USELESS: f64 = 1.0 / 1024.0;

/// Why a suite gives no reference data.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum Unfit {
    /// Recorded rows are reference data already.
    #[error("suite `{0}` has recorded values, which are reference data already")]
    Recorded(String),
    /// The number of vertices depends on the inputs.
    #[error(
        "suite `{0}` has a geometry stage without a formula: how many vertices it emits depends on the inputs, and \
         arrays of reference data have one size"
    )]
    Emits(String),
}

/// One block: the bytes of its part of each array, the least significant first.
#[derive(Clone, Debug)]
pub struct Block {
    /// Number of its first sample.
    pub first: u64,
    /// Samples.
    pub rows: usize,
    /// Number of its first case.
    pub first_case: u64,
    /// Cases.
    pub cases: usize,
    /// Samples of one case.
    pub per_case: usize,
    /// Bytes by array.
    pub arrays: Vec<Vec<u8>>,
    /// Their digest.
    pub digest: [u8; 32],
}

/// Makes the blocks of a suite.
pub struct Generator<'a> {
    prepared: &'a Prepared,
    profile: Option<&'a Profile>,
    sampler: Sampler,
    samples: u64,
    per_case: usize,
    block_cases: u64,
    source: Source,
    arrays: Vec<Array>,
    outputs: Outputs,
    /// Words of a sample and of a case that are real numbers.
    real: [Vec<usize>; 2],
}

/// What gives expected values.
enum Source {
    Formula { exact: Exact, routes: Vec<Route> },
    Meaning,
}

/// Where a word of a formula's inputs comes from.
#[derive(Clone, Copy)]
struct Route {
    from_case: bool,
    word: usize,
    scalar: Scalar,
}

/// The outputs of one sample.
pub(super) struct Outputs {
    pub vertices: usize,
    /// Words of all outputs of a vertex that the data hold, as places in the record of the program.
    words: Vec<usize>,
    /// The variables: their words among `words`, and their types.
    pub fields: Vec<(Field, Range<usize>)>,
    /// Types of all words of the record.
    scalars: Vec<Scalar>,
    /// Words of a vertex in the program.
    width: usize,
}

impl Outputs {
    fn words_of_sample(&self) -> usize {
        self.vertices * self.words.len()
    }
}

impl<'a> Generator<'a> {
    /// For a number of samples of a suite; without a profile there are no bounds.
    ///
    /// # Errors
    /// [`Unfit`] for suites whose outputs are no arrays.
    pub fn new(prepared: &'a Prepared, profile: Option<&'a Profile>, samples: u64, seed: u64) -> Result<Self, Unfit> {
        let suite = &prepared.suite;
        if matches!(suite.expect, Expect::Recorded(_)) {
            return Err(Unfit::Recorded(suite.name.clone()));
        }
        let layout = prepared.program.output_layout();
        let record = &layout.vertex;
        let formula = prepared.reference.formula();
        let exact = formula.and_then(|formula| Exact::by_name(formula.name));
        let emits = layout.max_vertices.is_some();
        let sides = [&*prepared.plan.invocation_record().clone(), &*prepared.plan.case_record().clone()];
        let (source, names): (_, Vec<&str>) = match (formula, exact) {
            (Some(formula), Some(exact)) => {
                let routes = formula.inputs.iter().flat_map(|param| routes(param, sides)).collect();
                (Source::Formula { exact, routes }, formula.outputs.iter().map(|p| p.name).collect())
            }
            _ if emits => return Err(Unfit::Emits(suite.name.clone())),
            _ => (Source::Meaning, record.fields().iter().map(|f| f.name.as_str()).collect()),
        };
        let (mut words, mut fields) = (Vec::new(), Vec::new());
        for index in names.iter().filter_map(|name| record.index_of(name)) {
            let at = words.len();
            words.extend(record.range(index));
            fields.push((record.fields()[index].clone(), at..words.len()));
        }
        let vertices = match (&source, formula.map(|f| &f.rule)) {
            (Source::Formula { exact, .. }, Some(Rule::Emission(_))) => exact.outputs() / words.len().max(1),
            _ => 1,
        };
        let scalars = (0..record.words()).map(|word| record.scalar_of(word)).collect();
        let outputs = Outputs { vertices, words, fields, scalars, width: record.words() };
        let per_case = suite.strands.map_or(suite.per_case, |s| s.primitives()).max(1);
        let widest = sides[0].words().max(outputs.words_of_sample()).max(1) as u64;
        let rows = BLOCK_ROWS.min(BLOCK_WORDS / widest).max(1);
        let arrays = arrays(sides, &outputs, emits, profile.is_some());
        Ok(Self {
            prepared,
            profile,
            sampler: Sampler::new(prepared.plan.clone(), seed),
            samples,
            per_case,
            block_cases: (rows / per_case as u64).max(1),
            source,
            arrays,
            outputs,
            real: sides
                .map(|record| (0..record.words()).filter(|&word| record.scalar_of(word) == Scalar::F32).collect()),
        })
    }

    /// The arrays of a block, in their order.
    pub fn arrays(&self) -> &[Array] {
        &self.arrays
    }

    /// Samples of a block; the last one may have fewer.
    pub fn block_rows(&self) -> u64 {
        self.block_cases * self.per_case as u64
    }

    /// Number of blocks.
    pub fn blocks(&self) -> u64 {
        self.samples.div_ceil(self.block_rows())
    }

    /// Samples of these blocks.
    pub fn rows_of(&self, blocks: &Range<u64>) -> u64 {
        let end = |block: u64| (block * self.block_rows()).min(self.samples);
        end(blocks.end) - end(blocks.start)
    }

    /// The provenance of a file with these blocks, without its digest.
    pub fn document(&self, blocks: &Range<u64>) -> Document {
        let Prepared { suite, .. } = self.prepared;
        let formula = self.prepared.reference.formula();
        let by = match &self.source {
            Source::Formula { .. } => "formula",
            Source::Meaning => "meaning",
        };
        let formula = formula.filter(|_| matches!(self.source, Source::Formula { .. }));
        Document {
            schema: SCHEMA.into(),
            schema_version: SCHEMA_VERSION.into(),
            tool: Tool { name: env!("CARGO_PKG_NAME").into(), version: env!("CARGO_PKG_VERSION").into() },
            suite: SuiteSource {
                name: suite.name.clone(),
                title: suite.title.clone(),
                shader: self.prepared.shader.rsplit(['/', '\\']).next().unwrap_or_default().to_owned(),
                stage: suite.stage.name().into(),
                defines: suite.chosen.iter().map(|(name, value)| (name.clone(), value.clone())).collect(),
                suite_sha256: Digest::of_text(suite.file.text()),
                shader_sha256: Digest::of_text(self.prepared.program.lowered.file.text()),
            },
            expected: ExpectedSource {
                by: by.into(),
                formula: formula.map(|f| f.name.to_owned()),
                source: formula.map(|f| f.source.to_owned()),
                equations: formula.map_or_else(Vec::new, |f| equations(f.source)),
            },
            domain: domain(suite),
            seed: self.sampler.seed().to_string(),
            per_case: self.per_case as u64,
            samples: self.samples,
            first: (blocks.start * self.block_rows()).min(self.samples),
            rows: self.rows_of(blocks),
            block_rows: self.block_rows(),
            profile: self.profile.map(|profile| ProfileSource {
                name: profile.name.clone(),
                revision: profile.revision.clone(),
                stage: "compute".into(),
                rearranged: profile.rearrangement,
            }),
            flags: flag_bits(),
            arrays: self.arrays.clone(),
            sha256: NO_DIGEST.into(),
        }
    }

    /// The block with this number.
    pub fn block(&self, number: u64) -> Block {
        let first = number * self.block_rows();
        let rows = self.block_rows().min(self.samples.saturating_sub(first)) as usize;
        let first_case = number * self.block_cases;
        let cases = rows.div_ceil(self.per_case);
        let batch = self.sampler.batch(first_case, cases, self.per_case);
        let width = self.outputs.words_of_sample();
        let mut expected = vec![0.0_f64; rows * width];
        let mut nearest = vec![0_u32; rows * width];
        let mut bound = vec![0.0_f32; if self.profile.is_some() { rows * width } else { 0 }];
        let mut flags = vec![Flags::default(); rows];
        let bounds = if bound.is_empty() { width } else { 0 };
        // Without bounds every chunk gets an empty slice in their place.
        let mut unbounded: Vec<&mut [f32]> = (0..rows.div_ceil(LANES)).map(|_| &mut [][..]).collect();
        let mut bounded: Vec<&mut [f32]> = bound.chunks_mut((LANES * width).max(1)).collect();
        let bound_chunks = if bounds == 0 { &mut bounded } else { &mut unbounded };
        expected
            .par_chunks_mut(LANES * width)
            .zip(nearest.par_chunks_mut(LANES * width))
            .zip(bound_chunks.par_iter_mut())
            .zip(flags.par_chunks_mut(LANES))
            .enumerate()
            .for_each_init(
                || Worker::new(self),
                |worker, (chunk, (((expected, nearest), bound), flags))| {
                    worker.fill(&batch, chunk * LANES, Part { expected, nearest, bound, flags });
                },
            );
        let arrays = self.bytes(&batch, rows, (&expected, &nearest, &bound, &flags));
        let digest = Digest::of_block(&arrays);
        Block { first, rows, first_case, cases, per_case: self.per_case, arrays, digest }
    }

    /// The arrays as bytes.
    fn bytes(
        &self,
        batch: &Batch,
        rows: usize,
        (expected, nearest, bound, flags): (&[f64], &[u32], &[f32], &[Flags]),
    ) -> Vec<Vec<u8>> {
        let sides = [&*batch.invocation_record, &*batch.case_record];
        let stride = self.outputs.words_of_sample();
        self.arrays
            .par_iter()
            .map(|array| {
                let output = || self.outputs.fields.iter().find(|(field, _)| field.name == array.variable);
                let range = output().map_or(0..0, |(_, range)| range.clone());
                // The words of one variable of all vertices of a sample.
                let (vertices, width) = (self.outputs.vertices, self.outputs.words.len());
                let at = |vertex: usize| vertex * width + range.start..vertex * width + range.end;
                let at: Vec<Range<usize>> = (0..vertices).map(at).collect();
                match array.role {
                    Role::Input => {
                        let (words, record, count) = match array.per {
                            Per::Sample => (&batch.invocations, sides[0], rows),
                            Per::Case => (&batch.cases, sides[1], batch.case_count()),
                        };
                        let range = record.index_of(&array.variable).map_or(0..0, |index| record.range(index));
                        gather(&words[..count * record.words()], record.words(), &[range])
                    }
                    Role::Expected => gather(expected, stride, &at),
                    Role::Nearest => gather(nearest, stride, &at),
                    Role::Bound => gather(bound, stride, &at),
                    Role::Flags => flags.iter().flat_map(|flags| flags.0.to_le_bytes()).collect(),
                }
            })
            .collect()
    }
}

/// The bytes of these places of each row, the least significant first.
fn gather<X: bytemuck::Pod>(values: &[X], stride: usize, ranges: &[Range<usize>]) -> Vec<u8> {
    let words: usize = ranges.iter().map(ExactSizeIterator::len).sum();
    let mut out = if words == stride {
        bytemuck::cast_slice(values).to_vec()
    } else {
        let mut out = Vec::with_capacity(values.len() / stride.max(1) * words * size_of::<X>());
        for row in values.chunks_exact(stride.max(1)) {
            for range in ranges {
                out.extend_from_slice(bytemuck::cast_slice(&row[range.clone()]));
            }
        }
        out
    };
    if cfg!(target_endian = "big") {
        out.chunks_exact_mut(size_of::<X>()).for_each(<[u8]>::reverse);
    }
    out
}

/// Where a chunk of samples is written to.
struct Part<'b> {
    expected: &'b mut [f64],
    nearest: &'b mut [u32],
    bound: &'b mut [f32],
    flags: &'b mut [Flags],
}

/// What one thread computes with.
struct Worker<'g, 'a> {
    generator: &'g Generator<'a>,
    limiter: Option<Limiter<'g>>,
    limits: Limits,
    meant: Option<Meant<'g>>,
    values: Vec<f64>,
    out: Vec<Twofold>,
}

impl<'g, 'a> Worker<'g, 'a> {
    fn new(generator: &'g Generator<'a>) -> Self {
        let oracle = &generator.prepared.oracle;
        Self {
            limiter: generator.profile.map(|profile| Limiter::new(oracle, profile, Stage::Compute)),
            limits: Limits::default(),
            meant: matches!(generator.source, Source::Meaning).then(|| Meant::new(oracle)),
            values: Vec::new(),
            out: vec![Twofold::of([0.0; WIDTH]); generator.outputs.words_of_sample()],
            generator,
        }
    }

    fn fill(&mut self, batch: &Batch, first: usize, mut part: Part<'_>) {
        let rows = part.flags.len();
        match &self.generator.source {
            Source::Formula { exact, routes } => {
                let width = self.out.len();
                for at in (0..rows).step_by(WIDTH) {
                    let inputs = Inputs::new(batch, routes, first + at);
                    let out = &mut self.out;
                    let lanes = WIDTH.min(rows - at);
                    let mut nearest = [0; WIDTH];
                    let exact = *exact;
                    let marks = wide(
                        #[inline(always)]
                        || exact.evaluate(&inputs, out),
                    );
                    for (word, column) in out.iter().enumerate() {
                        column.rounded_32(&mut nearest);
                        for lane in 0..lanes {
                            let to = (at + lane) * width + word;
                            let value = column.rounded()[lane];
                            part.expected[to] = if value.is_nan() { f64::NAN } else { value };
                            part.nearest[to] = if value.is_nan() { f32::NAN.to_bits() } else { nearest[lane] };
                        }
                    }
                    for lane in 0..lanes {
                        let flags = &mut part.flags[at + lane];
                        if marks.segment_end[lane] {
                            flags.set(Flag::SegmentEnd);
                        }
                        if marks.degenerate[lane] {
                            flags.set(Flag::Degenerate);
                        }
                    }
                }
            }
            Source::Meaning => self.meaning(batch, first, &mut part),
        }
        self.inputs(batch, first, part.flags);
        self.outputs(&part.expected[..], part.flags);
        self.bounds(batch, first, &mut part);
    }

    fn meaning(&mut self, batch: &Batch, first: usize, part: &mut Part<'_>) {
        let outputs = &self.generator.outputs;
        let Some(meant) = &mut self.meant else { return };
        meant.look(batch, first, &outputs.scalars, &mut self.values);
        let width = outputs.words.len();
        for row in 0..part.flags.len() {
            for (k, &word) in outputs.words.iter().enumerate() {
                let value = self.values[word * LANES + row];
                let scalar = outputs.scalars[word];
                part.expected[row * width + k] = if value.is_nan() { f64::NAN } else { value };
                part.nearest[row * width + k] =
                    if value.is_nan() && scalar == Scalar::F32 { f32::NAN.to_bits() } else { encode(value, scalar) };
            }
        }
    }

    /// Flags that follow from the inputs.
    fn inputs(&self, batch: &Batch, first: usize, flags: &mut [Flags]) {
        let [own, shared] = &self.generator.real;
        let mut of_case = (usize::MAX, Flags::default());
        for (k, flags) in flags.iter_mut().enumerate() {
            let invocation = first + k;
            let case = invocation / batch.per_case;
            if of_case.0 != case {
                of_case = (case, Flags::default());
                let words = batch.case(case);
                shared.iter().for_each(|&word| of_case.1.input(words[word]));
            }
            flags.0 |= of_case.1.0;
            let words = batch.invocation(invocation);
            own.iter().for_each(|&word| flags.input(words[word]));
        }
    }

    /// Flags that follow from what is expected.
    fn outputs(&self, expected: &[f64], flags: &mut [Flags]) {
        let outputs = &self.generator.outputs;
        let stride = outputs.words_of_sample();
        for (values, flags) in expected.chunks_exact(stride).zip(flags) {
            for vertex in values.chunks_exact(outputs.words.len()) {
                for (field, range) in &outputs.fields {
                    let values = &vertex[range.clone()];
                    let scale = values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                    if values.iter().any(|x| x.is_nan()) {
                        flags.set(Flag::NoValue);
                    }
                    if field.shape.scalar != Scalar::F32 {
                        continue;
                    }
                    if scale == f64::INFINITY {
                        flags.set(Flag::Infinite);
                    } else if scale > f64::from(f32::MAX) {
                        flags.set(Flag::Overflow);
                    } else if scale > 0.0 && scale < MIN_NORMAL {
                        flags.set(Flag::Underflow);
                    }
                }
            }
        }
    }

    /// Bounds, and the flags that follow from them.
    fn bounds(&mut self, batch: &Batch, first: usize, part: &mut Part<'_>) {
        let outputs = &self.generator.outputs;
        let Some(limiter) = &mut self.limiter else { return };
        limiter.look(batch, first, &mut self.limits);
        let Limits { values, bounds, reasons, .. } = &self.limits;
        let stride = outputs.words_of_sample();
        for (row, flags) in part.flags.iter_mut().enumerate() {
            if let Some(reason) = reasons[row] {
                flags.set(match reason {
                    Reason::Domain => Flag::NoValue,
                    Reason::NoPromise => Flag::NoPromise,
                    Reason::IllConditioned => Flag::IllConditioned,
                    Reason::Branch | Reason::TexelEdge => Flag::Branch,
                    Reason::Underflow => Flag::Underflow,
                    Reason::Overflow => Flag::Overflow,
                });
            }
            let vector = largest_input(batch, first + row);
            for vertex in 0..outputs.vertices {
                for (field, range) in &outputs.fields {
                    let at = row * stride + vertex * outputs.words.len();
                    let expected = &part.expected[at..][range.clone()];
                    let scale = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs())).max(vector);
                    for (k, &expected) in range.clone().zip(expected) {
                        let from = (vertex * outputs.width + outputs.words[k]) * LANES + row;
                        // What the tape starts from is not what is expected to the last bit.
                        let apart =
                            if field.shape.scalar == Scalar::F32 { (values[from] - expected).abs() } else { 0.0 };
                        let bound = bounds[from] + apart;
                        let bound = if expected.is_finite() { upward(bound) } else { f32::INFINITY };
                        part.bound[at + k] = bound;
                        if bound.is_finite() && f64::from(bound) > USELESS * scale.max(MIN_NORMAL) {
                            flags.set(Flag::IllConditioned);
                        }
                    }
                }
            }
        }
    }
}

/// The largest component of the vectors among the inputs, which outputs are measured against.
fn largest_input(batch: &Batch, invocation: usize) -> f64 {
    let sides =
        [(&batch.invocation_record, batch.invocation(invocation)), (&batch.case_record, batch.case_of(invocation))];
    let mut most = 0.0_f64;
    for (record, words) in sides {
        for (k, field) in record.fields().iter().enumerate() {
            if field.shape.scalar == Scalar::F32 && field.shape.columns == 1 && field.shape.rows > 1 {
                let part = &words[record.range(k)];
                most = part.iter().fold(most, |most, &w| most.max(f64::from(f32::from_bits(w)).abs()));
            }
        }
    }
    most
}

/// The inputs of a formula for samples side by side.
struct Inputs<'b> {
    batch: &'b Batch,
    routes: &'b [Route],
    first: usize,
    /// The last sample of the batch.
    last: usize,
    /// The case of all these samples, where it is one.
    case: Option<usize>,
}

impl<'b> Inputs<'b> {
    fn new(batch: &'b Batch, routes: &'b [Route], first: usize) -> Self {
        let one = first.is_multiple_of(batch.per_case) && batch.per_case.is_multiple_of(WIDTH);
        let last = batch.invocation_count().saturating_sub(1);
        Self { batch, routes, first, last, case: one.then(|| first / batch.per_case) }
    }
}

impl Words<Twofold> for Inputs<'_> {
    #[inline(always)]
    fn word(&self, index: usize) -> Twofold {
        let Route { from_case, word, scalar } = self.routes[index];
        let Batch { per_case, .. } = *self.batch;
        let (words, stride) = if from_case {
            (&self.batch.cases, self.batch.case_record.words())
        } else {
            (&self.batch.invocations, self.batch.invocation_record.words())
        };
        let mut out = [0.0; WIDTH];
        if let (true, Some(case)) = (from_case, self.case) {
            out = [number(words[case * stride + word], scalar); WIDTH];
            return Twofold::of(out);
        }
        for (lane, out) in out.iter_mut().enumerate() {
            // Beyond the end of a block the last sample is computed again.
            let row = (self.first + lane).min(self.last);
            let row = if from_case { row / per_case } else { row };
            *out = number(words[row * stride + word], scalar);
        }
        Twofold::of(out)
    }
}

#[inline(always)]
fn number(word: u32, scalar: Scalar) -> f64 {
    match scalar {
        Scalar::F32 => f64::from(f32::from_bits(word)),
        Scalar::I32 => f64::from(word.cast_signed()),
        Scalar::U32 | Scalar::Bool => f64::from(word),
    }
}

fn routes(param: &Param, sides: [&Record; 2]) -> Vec<Route> {
    for (side, record) in sides.into_iter().enumerate() {
        if let Some(index) = record.index_of(param.name) {
            let scalar = record.fields()[index].shape.scalar;
            return record.range(index).map(|word| Route { from_case: side == 1, word, scalar }).collect();
        }
    }
    // The formula was bound to these records, so each of its inputs is in one.
    Vec::new()
}
