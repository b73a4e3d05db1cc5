//! Blocks of reference data.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;
use thiserror::Error;

use super::array::{Array, Per, Role};
use super::bytes::{Bytes, Held, least_first};
use super::digest::Digest;
use super::document::{Document, ExpectedSource, NO_DIGEST, ProfileSource, SCHEMA, SCHEMA_VERSION, Tool, flag_bits};
use super::flags::Flags;
use super::inputs::{Route, Run, routes, runs};
use super::layout::{arrays, equations};
use super::subject::{Samples, Subject};
use super::worker::{Part, Worker};
use base::value::{Batch, Field, Scalar};
use chapter::exact::Exact;
use chapter::exact::quick::Quick;
use engine::suite::{Expect, RecordedFile};
use judge::formula::Rule;
use judge::profile::Profile;
use program::interp::SLOTS;

/// Samples of a block, as far as whole cases fit.
const BLOCK_ROWS: u64 = 1 << 16;
/// Words of the largest array of a block: 32 MiB.
const BLOCK_WORDS: u64 = 1 << 23;

/// Why a suite gives no reference data.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum Unfit {
    /// More samples than there are.
    #[error("suite `{name}` has {rows} recorded rows, which are its samples; ask for --samples {rows} or fewer")]
    Recorded {
        /// The suite.
        name: String,
        /// How many rows it has.
        rows: u64,
    },
    /// The number of vertices depends on the inputs.
    #[error(
        "`{0}` has a geometry stage without a formula: how many vertices it emits depends on the inputs, and arrays of \
         reference data have one size; write data for a function that it calls (`refdata generate FILE --function \
         NAME`), or give its suite one of the formulas that emit (`shadercheck explain suite`)"
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
    /// Cases in the block: groups of samples that share uniforms.
    pub cases: usize,
    /// Samples of one case.
    pub per_case: usize,
    /// Bytes by array.
    pub arrays: Vec<Bytes>,
    /// Their digest.
    pub digest: [u8; 32],
}

/// Makes the blocks of a suite.
pub struct Generator<'a> {
    pub(super) subject: Subject<'a>,
    pub(super) profile: Option<&'a Profile>,
    /// The profile without rearrangement, where it is to give the bounds that there are not with it.
    pub(super) in_order: Option<Profile>,
    inputs: Samples<'a>,
    seed: u64,
    samples: u64,
    per_case: usize,
    block_cases: u64,
    pub(super) source: ExpectedFrom,
    arrays: Vec<Array>,
    pub(super) outputs: Outputs,
    /// Words of a sample and of a case that are real numbers.
    pub(super) real: [Vec<Range<usize>>; 2],
    /// Samples for which the shader is farther from what is expected than any device may be.
    pub(super) apart: AtomicU64,
}

/// What gives expected values.
pub(super) enum ExpectedFrom {
    Formula(ByFormula),
    /// Another shader, or a record.
    Reference,
    /// The shader itself.
    Meaning,
}

/// A formula and its inputs.
pub(super) struct ByFormula {
    pub exact: Exact,
    /// Its quick phase, for samples of one case.
    pub quick: Option<Quick>,
    /// Where each word comes from.
    pub routes: Vec<Route>,
    /// The same for many at once.
    pub runs: Vec<Run>,
}

/// The outputs of one sample.
pub(super) struct Outputs {
    pub vertices: usize,
    /// Words of all outputs of a vertex that the data hold, as places in the record of the program.
    pub words: Vec<usize>,
    /// The variables: their words among `words`, and their types.
    pub fields: Vec<(Field, Range<usize>)>,
    /// Types of all words of the record.
    pub scalars: Vec<Scalar>,
    /// Words of a vertex in the program.
    pub width: usize,
}

impl Outputs {
    pub fn words_of_sample(&self) -> usize {
        self.vertices * self.words.len()
    }
}

impl<'a> Generator<'a> {
    /// For a number of samples of a suite, or of a function without one; without a profile there are no bounds.
    ///
    /// # Errors
    /// [`Unfit`] where outputs are no arrays, or there are not so many samples.
    pub fn new(
        subject: impl Into<Subject<'a>>,
        profile: Option<&'a Profile>,
        samples: u64,
        seed: u64,
    ) -> Result<Self, Unfit> {
        let subject: Subject<'a> = subject.into();
        let name = || subject.name().to_owned();
        if let Some(rows) = subject.given().map(|rows| rows.len() as u64).filter(|rows| *rows < samples) {
            return Err(Unfit::Recorded { name: name(), rows });
        }
        let layout = subject.program().output_layout();
        let record = &layout.vertex;
        let formula = subject.reference().formula();
        let exact = formula.and_then(|formula| Exact::by_name(formula.name));
        let emits = layout.max_vertices.is_some();
        let sides = subject.records();
        let (source, names): (_, Vec<&str>) = match (formula, exact) {
            (Some(formula), Some(exact)) => {
                let routes: Vec<Route> = formula.inputs.iter().flat_map(|param| routes(param, sides)).collect();
                let quick = Quick::of(exact, routes.iter().map(|route| route.from_case));
                let runs = runs(&routes);
                let by = ByFormula { exact, quick, routes, runs };
                (ExpectedFrom::Formula(by), formula.outputs.iter().map(|p| p.name).collect())
            }
            _ if emits => return Err(Unfit::Emits(name())),
            _ => match subject.expect() {
                Expect::Reference(_) | Expect::Recorded(_) => {
                    (ExpectedFrom::Reference, subject.reference().judged().iter().map(|f| f.name.as_str()).collect())
                }
                Expect::Formula(_) | Expect::Nothing => {
                    (ExpectedFrom::Meaning, record.fields().iter().map(|f| f.name.as_str()).collect())
                }
            },
        };
        let (mut words, mut fields) = (Vec::new(), Vec::new());
        for index in names.iter().filter_map(|name| record.index_of(name)) {
            let at = words.len();
            words.extend(record.range(index));
            fields.push((record.fields()[index].clone(), at..words.len()));
        }
        let vertices = match (&source, formula.map(|f| &f.rule)) {
            (ExpectedFrom::Formula(by), Some(Rule::Emission(_))) => by.exact.outputs() / words.len().max(1),
            _ => 1,
        };
        let scalars = (0..record.words()).map(|word| record.scalar_of(word)).collect();
        let outputs = Outputs { vertices, words, fields, scalars, width: record.words() };
        let per_case = subject.per_case();
        let widest = sides[0].words().max(outputs.words_of_sample()).max(1) as u64;
        let rows = BLOCK_ROWS.min(BLOCK_WORDS / widest).max(1);
        let arrays = arrays(sides, &outputs, emits, profile.is_some());
        Ok(Self {
            subject,
            profile,
            in_order: profile
                .filter(|profile| profile.in_order_where_unbounded && profile.rearrangement)
                .map(Profile::in_order),
            inputs: subject.samples(seed),
            seed,
            samples,
            per_case,
            block_cases: (rows / per_case as u64).max(1),
            source,
            arrays,
            outputs,
            real: sides.map(|record| {
                let real = |word: &usize| record.scalar_of(*word) == Scalar::F32;
                joined((0..record.words()).filter(real))
            }),
            apart: AtomicU64::new(0),
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
        let formula = self.subject.reference().formula();
        let formula = formula.filter(|_| matches!(self.source, ExpectedFrom::Formula(_)));
        let (by, accuracy) = self.accuracy();
        Document {
            schema: SCHEMA.into(),
            schema_version: SCHEMA_VERSION.into(),
            tool: Tool { name: "shadercheck".into(), version: env!("CARGO_PKG_VERSION").into() },
            suite: self.subject.source(),
            expected: ExpectedSource {
                by: by.into(),
                accuracy,
                formula: formula.map(|f| f.name.to_owned()),
                source: formula.map(|f| f.source.to_owned()),
                equations: formula.map_or_else(Vec::new, |f| equations(f.source)),
            },
            domain: self.subject.domain(),
            seed: self.seed.to_string(),
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

    /// What gives the expected values, and how exact they are.
    fn accuracy(&self) -> (&'static str, String) {
        let rounded = "in binary64, each operation rounded: no formula, and not within 1 ULP as a whole; ";
        let counted = match self.profile {
            Some(_) => "what that moves a value by is part of its bound",
            None => "nothing here says by how much that moves a value",
        };
        match (&self.source, self.subject.expect()) {
            (ExpectedFrom::Formula(_), _) => (
                "formula",
                "real numbers, rounded once: within 1 ULP of binary64, or within 2^-90 of the largest term where terms \
                 cancel to less than 2^-37 of it"
                    .to_owned(),
            ),
            (ExpectedFrom::Reference, Expect::Recorded(recorded)) => {
                let RecordedFile { file, relative_error, absolute_error, .. } = recorded;
                let counted = if self.profile.is_some() { ", which is part of the bound" } else { "" };
                let within = format!("within {relative_error:e} of the largest component and {absolute_error:e}");
                ("recorded", format!("as recorded in {file}: {within}, and the digits that are written{counted}"))
            }
            (ExpectedFrom::Reference, expect) => {
                let file = match expect {
                    Expect::Reference(reference) => reference.file.as_str(),
                    Expect::Formula(_) | Expect::Recorded(_) | Expect::Nothing => "",
                };
                ("reference", format!("what the shader {file} means {rounded}{counted}"))
            }
            (ExpectedFrom::Meaning, _) => ("meaning", format!("what the shader itself means {rounded}{counted}")),
        }
    }

    /// Samples so far for which the shader means something else than is expected, by more than its bound.
    /// Of a right shader there are none.
    pub fn apart(&self) -> u64 {
        self.apart.load(Ordering::Relaxed)
    }

    /// The block with this number from its arrays, one after the other, and their digest; none where they do not
    /// fit.
    pub fn restored(&self, number: u64, digest: [u8; 32], bytes: &[u8]) -> Option<Block> {
        let first = number * self.block_rows();
        let rows = self.block_rows().min(self.samples.saturating_sub(first)) as usize;
        let cases = rows.div_ceil(self.per_case);
        let (mut arrays, mut rest) = (Vec::new(), bytes);
        for array in &self.arrays {
            let count = if array.per == Per::Case { cases } else { rows };
            let (part, behind) = rest.split_at_checked(count * array.stride())?;
            arrays.push(Bytes::from(part.to_vec()));
            rest = behind;
        }
        let first_case = number * self.block_cases;
        let whole = rest.is_empty() && Digest::of_block(&arrays) == digest;
        whole.then_some(Block { first, rows, first_case, cases, per_case: self.per_case, arrays, digest })
    }

    /// The block with this number.
    pub fn block(&self, number: u64) -> Block {
        let first = number * self.block_rows();
        let rows = self.block_rows().min(self.samples.saturating_sub(first)) as usize;
        let first_case = number * self.block_cases;
        let cases = rows.div_ceil(self.per_case);
        let batch = self.inputs.batch(first_case, cases, self.per_case);
        let width = self.outputs.words_of_sample();
        let mut expected = vec![0.0_f64; rows * width];
        let mut nearest = vec![0_u32; rows * width];
        let mut bound = vec![0.0_f32; if self.profile.is_some() { rows * width } else { 0 }];
        let mut flags = vec![Flags::default(); rows];
        let bounds = if bound.is_empty() { width } else { 0 };
        // Without bounds every chunk gets an empty slice in their place.
        let mut unbounded: Vec<&mut [f32]> = (0..rows.div_ceil(SLOTS)).map(|_| &mut [][..]).collect();
        let mut bounded: Vec<&mut [f32]> = bound.chunks_mut((SLOTS * width).max(1)).collect();
        let bound_chunks = if bounds == 0 { &mut bounded } else { &mut unbounded };
        expected
            .par_chunks_mut(SLOTS * width)
            .zip(nearest.par_chunks_mut(SLOTS * width))
            .zip(bound_chunks.par_iter_mut())
            .zip(flags.par_chunks_mut(SLOTS))
            .enumerate()
            .for_each_init(
                || Worker::new(self),
                |worker, (chunk, (((expected, nearest), bound), flags))| {
                    worker.fill(&batch, chunk * SLOTS, Part { expected, nearest, bound, flags });
                },
            );
        let arrays = self.bytes(batch, rows, Made { expected, nearest, bound, flags });
        let digest = Digest::of_block(&arrays);
        Block { first, rows, first_case, cases, per_case: self.per_case, arrays, digest }
    }

    /// The arrays as bytes.
    fn bytes(&self, batch: Batch, rows: usize, made: Made) -> Vec<Bytes> {
        let sides = [batch.invocation_record.clone(), batch.case_record.clone()];
        let stride = self.outputs.words_of_sample();
        let Made { mut expected, mut nearest, mut bound, flags } = made;
        let mut flags: Vec<u16> = flags.into_iter().map(|flags| flags.0).collect();
        let (cases, Batch { mut invocations, cases: mut of_cases, .. }) = (batch.case_count(), batch);
        invocations.truncate(rows * sides[0].words());
        of_cases.truncate(cases * sides[1].words());
        self.arrays
            .iter()
            .map(|array| {
                let output = || self.outputs.fields.iter().find(|(field, _)| field.name == array.variable);
                let range = output().map_or(0..0, |(_, range)| range.clone());
                // The words of one variable of all vertices of a sample.
                let (vertices, width) = (self.outputs.vertices, self.outputs.words.len());
                let at = |vertex: usize| vertex * width + range.start..vertex * width + range.end;
                let at: Vec<Range<usize>> = (0..vertices).map(at).collect();
                match array.role {
                    Role::Input => {
                        let (words, record) = match array.per {
                            Per::Sample => (&mut invocations, &sides[0]),
                            Per::Case => (&mut of_cases, &sides[1]),
                        };
                        let range = record.index_of(&array.variable).map_or(0..0, |index| record.range(index));
                        gather(words, record.words(), &[range])
                    }
                    Role::Expected => gather(&mut expected, stride, &at),
                    Role::Nearest => gather(&mut nearest, stride, &at),
                    Role::Bound => gather(&mut bound, stride, &at),
                    Role::Flags => Bytes::of(std::mem::take(&mut flags)),
                }
            })
            .collect()
    }
}

/// Neighbouring words as ranges.
fn joined(words: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for word in words {
        match runs.last_mut() {
            Some(run) if run.end == word => run.end += 1,
            Some(_) | None => runs.push(word..word + 1),
        }
    }
    runs
}

/// What is computed of a block.
struct Made {
    expected: Vec<f64>,
    nearest: Vec<u32>,
    bound: Vec<f32>,
    flags: Vec<Flags>,
}

/// The bytes of these places of each row. Where they are the whole row, no other array has a part of it, and the
/// numbers are taken as they are.
fn gather<X: Held>(values: &mut Vec<X>, stride: usize, ranges: &[Range<usize>]) -> Bytes {
    let words: usize = ranges.iter().map(ExactSizeIterator::len).sum();
    if words == stride {
        return Bytes::of(std::mem::take(values));
    }
    let mut out = Vec::with_capacity(values.len() / stride.max(1) * words * size_of::<X>());
    for row in values.chunks_exact(stride.max(1)) {
        for range in ranges {
            out.extend_from_slice(bytemuck::cast_slice(&row[range.clone()]));
        }
    }
    least_first::<X>(&mut out);
    Bytes::Plain(out)
}
