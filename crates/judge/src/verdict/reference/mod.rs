//! What is expected of a program, bound to its inputs and outputs: by a formula, by another program, by
//! recorded values, by functions of the caller, or by nothing at all.
//!
//! A reference in GLSL or WGSL goes through the same tape as the shader; where it is too coarse itself, a sample is
//! inconclusive. Recorded values state how exact the record is, which is a property of the data and no tolerance of
//! the shader.

mod error;
mod evaluator;
mod formula;
mod given;
mod model;
mod recorded;

use std::ops::Range;
use std::sync::Arc;

use crate::formula::{Formula, Rule};
use base::value::{Batch, Field, Record, Scalar};
use program::Program;

pub use error::ReferenceError;
pub(super) use evaluator::Evaluator;
use formula::BoundFormula;
pub use given::{Given, GivenRule};
use model::Model;
pub use recorded::{Recorded, RecordedRow};

/// What a shader without a reference is compared with: what it means itself. A word of [`Reference::noun`].
pub const MEANING: &str = "meaning";

/// Values that are expected of one sample: binary64, one vertex after the other.
///
/// Only a [`Reference`] makes one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expected {
    pub(super) words: Vec<f64>,
    /// For each vertex of a geometry stage, its strip.
    pub(super) strips: Vec<u32>,
    /// How far each word may be from what is meant; empty where that is not known to be anything.
    pub(super) slack: Vec<f64>,
}

impl Expected {
    /// The values, one vertex after the other; empty where nothing is expected.
    pub fn words(&self) -> &[f64] {
        &self.words
    }

    /// The strip of each vertex; empty for what gives one set of outputs.
    pub fn strips(&self) -> &[u32] {
        &self.strips
    }

    /// How far a word may be from what is meant.
    pub(super) fn slack(&self, word: usize) -> f64 {
        self.slack.get(word).copied().unwrap_or(0.0)
    }

    fn clear(&mut self) {
        self.words.clear();
        self.strips.clear();
        self.slack.clear();
    }
}

/// What is expected of a program: where its inputs come from, and which outputs are judged.
#[derive(Clone)]
pub struct Reference {
    source: ReferenceKind,
    /// For each judged variable: its words in what is expected and in the vertex record.
    pub(super) outputs: Vec<JudgedOutput>,
    pub(super) vertex_words: usize,
    /// What relations see: the judged variables in their order, then all others.
    pub(super) seen: Vec<JudgedOutput>,
    fields: Vec<Field>,
    /// Where vectors lie among the inputs of an invocation and of a case.
    vectors: [Arc<[Range<usize>]>; 2],
}

#[derive(Clone)]
enum ReferenceKind {
    Formula(BoundFormula),
    Model(Arc<Model>),
    Given(Arc<[Given]>),
    Recorded(Arc<Recorded>),
    Nothing,
}

/// A judged output variable.
#[derive(Clone, Debug)]
pub(super) struct JudgedOutput {
    pub expected: Range<usize>,
    pub actual: Range<usize>,
    pub scalar: Scalar,
}

impl Reference {
    /// Binds `formula` to `program` by name.
    ///
    /// # Errors
    /// [`ReferenceError`] when an input or output is missing or of another type.
    pub fn new(formula: &'static Formula, program: &Program) -> Result<Self, ReferenceError> {
        let (bound, judged) = formula::bind(formula, program)?;
        Ok(Self::of(ReferenceKind::Formula(bound), &judged, program))
    }

    /// Expects what another program means, which is found by the names of inputs and outputs. `by` names
    /// it in messages, and `output` says which output the value of a function stands for.
    ///
    /// # Errors
    /// [`ReferenceError`] when the other program has an input that this one lacks, gives no output of it,
    /// emits vertices where this one does not, or cannot be interpreted.
    pub fn model(model: &Program, by: &str, output: Option<&str>, program: &Program) -> Result<Self, ReferenceError> {
        let (model, judged) = model::bind(model, by, output, program)?;
        Ok(Self::of(ReferenceKind::Model(Arc::new(model)), &judged, program))
    }

    /// The same, where loops of a model may go through another number of rounds.
    #[must_use]
    pub fn with_fuel(mut self, fuel: u32) -> Self {
        if let ReferenceKind::Model(model) = &mut self.source {
            *model = Arc::new(model.with_fuel(fuel));
        }
        self
    }

    /// Expects what functions of the caller give, one for each judged output.
    ///
    /// # Errors
    /// [`ReferenceError`] when the program has no such output, or emits vertices.
    pub fn given(rules: Vec<Given>, program: &Program) -> Result<Self, ReferenceError> {
        let judged = given::bind(&rules, program)?;
        Ok(Self::of(ReferenceKind::Given(rules.into()), &judged, program))
    }

    /// Expects recorded values where the inputs are those of a row, and nothing elsewhere.
    ///
    /// # Errors
    /// [`ReferenceError`] when the program has no such output, or emits vertices.
    pub fn recorded(recorded: Recorded, program: &Program) -> Result<Self, ReferenceError> {
        let judged = recorded.bind(program)?;
        Ok(Self::of(ReferenceKind::Recorded(Arc::new(recorded)), &judged, program))
    }

    /// Expects nothing: lanes are held against what the program means, and relations see its outputs.
    pub fn nothing(program: &Program) -> Self {
        Self::of(ReferenceKind::Nothing, &[], program)
    }

    /// Of another program: the invocations of a batch as it gets them, each with a case of its own.
    pub fn fed(&self, batch: &Batch, invocations: &[usize]) -> Option<Batch> {
        match &self.source {
            ReferenceKind::Model(model) => Some(model.batch(batch, invocations)),
            _ => None,
        }
    }

    /// Of another program: for each judged variable, its words among the outputs of the program and among those of the other.
    pub fn pairs(&self) -> Vec<(Range<usize>, Range<usize>)> {
        let ReferenceKind::Model(model) = &self.source else { return Vec::new() };
        self.outputs.iter().zip(&model.outputs).map(|(own, other)| (own.actual.clone(), other.clone())).collect()
    }

    /// A reference that judges the outputs with these indices.
    fn of(source: ReferenceKind, judged: &[usize], program: &Program) -> Self {
        let record = program.output_layout().vertex;
        let rest = (0..record.fields().len()).filter(|index| !judged.contains(index));
        let (mut seen, mut fields, mut at) = (Vec::new(), Vec::new(), 0);
        for index in judged.iter().copied().chain(rest) {
            let field = &record.fields()[index];
            let words = field.shape.words();
            seen.push(JudgedOutput {
                expected: at..at + words,
                actual: record.range(index),
                scalar: field.shape.scalar,
            });
            fields.push(field.clone());
            at += words;
        }
        let outputs: Vec<JudgedOutput> = seen[..judged.len()].to_vec();
        let vectors = [program.invocation_record(), program.case_record()].map(|record| vectors(&record));
        Self { source, vertex_words: outputs.last().map_or(0, |o| o.expected.end), outputs, seen, fields, vectors }
    }

    /// The formula, where it is one.
    pub fn formula(&self) -> Option<&'static Formula> {
        match &self.source {
            ReferenceKind::Formula(bound) => Some(bound.formula),
            ReferenceKind::Model(_) | ReferenceKind::Given(_) | ReferenceKind::Recorded(_) | ReferenceKind::Nothing => {
                None
            }
        }
    }

    /// What the shader is compared with, in a word: `formula`, `reference`, `record`.
    pub fn noun(&self) -> &'static str {
        match &self.source {
            ReferenceKind::Formula(_) => "formula",
            ReferenceKind::Model(_) | ReferenceKind::Given(_) => "reference",
            ReferenceKind::Recorded(_) => "record",
            ReferenceKind::Nothing => MEANING,
        }
    }

    /// The outputs that relations see, in their order: the words of [`property::Observed`].
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// The outputs that something is expected of, in the order of what is expected.
    pub fn judged(&self) -> &[Field] {
        &self.fields[..self.outputs.len()]
    }

    /// True for what emits vertices.
    pub(super) fn emits(&self) -> bool {
        match &self.source {
            ReferenceKind::Formula(bound) => matches!(bound.formula.rule, Rule::Emission(_)),
            ReferenceKind::Model(model) => model.emits(),
            ReferenceKind::Given(_) | ReferenceKind::Recorded(_) | ReferenceKind::Nothing => false,
        }
    }

    /// The largest component of all vectors among the inputs of an invocation and its case.
    pub(super) fn vector_size(&self, batch: &Batch, invocation: usize) -> f64 {
        let sides = [batch.invocation(invocation), batch.case_of(invocation)];
        let words = sides.iter().zip(&self.vectors).flat_map(|(side, at)| at.iter().flat_map(|r| &side[r.clone()]));
        words.fold(0.0, |most, &word| most.max(f64::from(f32::from_bits(word)).abs()))
    }
}

fn vectors(record: &Record) -> Arc<[Range<usize>]> {
    let vector = |index: &usize| {
        let shape = record.fields()[*index].shape;
        shape.scalar == Scalar::F32 && shape.columns == 1 && shape.rows > 1
    };
    (0..record.fields().len()).filter(vector).map(|index| record.range(index)).collect()
}

/// A word as a number.
fn number(word: u32, scalar: Scalar) -> f64 {
    property::decode(word, scalar)
}
