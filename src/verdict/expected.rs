//! What the formula says, bound to the inputs and outputs of a program.

use std::sync::Arc;

use thiserror::Error;

use crate::formula::{Args, Emission, Formula, Kind, Param, Rule};
use crate::program::{OutputLayout, Program};
use crate::value::{Batch, Record, Scalar};

/// Why a formula does not fit a program.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ReferenceError {
    /// The shader lacks an input of the formula.
    #[error("the formula `{formula}` needs an input `{name}` of type `{ty}`; the shader has {has}")]
    MissingInput {
        /// Name of the formula.
        formula: &'static str,
        /// Name of the input.
        name: &'static str,
        /// Its type.
        ty: String,
        /// What the shader has.
        has: String,
    },
    /// The shader lacks an output of the formula.
    #[error("the formula `{formula}` gives an output `{name}` of type `{ty}`; the shader has {has}")]
    MissingOutput {
        /// Name of the formula.
        formula: &'static str,
        /// Name of the output.
        name: &'static str,
        /// Its type.
        ty: String,
        /// What the shader has.
        has: String,
    },
    /// One side emits vertices, the other gives one set of outputs.
    #[error("the formula `{formula}` {gives}, which a {stage} does not")]
    Stage {
        /// Name of the formula.
        formula: &'static str,
        /// What the formula gives.
        gives: &'static str,
        /// Stage of the shader.
        stage: &'static str,
    },
}

/// Values that the formula gives for one sample: binary64, one vertex after the other.
///
/// Only a [`Reference`] makes one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expected {
    pub(super) words: Vec<f64>,
    /// For each vertex of a geometry stage, its strip.
    pub(super) strips: Vec<u32>,
}

impl Expected {
    /// The values, one vertex after the other.
    pub fn words(&self) -> &[f64] {
        &self.words
    }

    /// The strip of each vertex; empty for a pointwise formula.
    pub fn strips(&self) -> &[u32] {
        &self.strips
    }
}

/// Where the words of a formula's inputs come from.
#[derive(Clone, Debug)]
struct Copy {
    to: usize,
    from: std::ops::Range<usize>,
    scalar: Scalar,
}

/// A formula bound to a program: which input goes where, and which outputs are judged.
#[derive(Clone)]
pub struct Reference {
    formula: &'static Formula,
    invocation: Vec<Copy>,
    case: Vec<Copy>,
    input_words: usize,
    /// Which words belong to vectors.
    vectors: Arc<[bool]>,
    /// For each judged variable: its words in the formula's outputs and in the vertex record.
    pub(super) outputs: Vec<Output>,
    pub(super) vertex_words: usize,
}

/// A judged output variable.
#[derive(Clone, Debug)]
pub(super) struct Output {
    pub expected: std::ops::Range<usize>,
    pub actual: std::ops::Range<usize>,
    pub scalar: Scalar,
}

impl Reference {
    /// Binds `formula` to `program` by name.
    ///
    /// # Errors
    /// [`ReferenceError`] when an input or output is missing or of another type.
    pub fn new(formula: &'static Formula, program: &Program) -> Result<Self, ReferenceError> {
        let layout = program.output_layout();
        let gives = match formula.rule {
            Rule::Pointwise(_) => "gives one set of outputs",
            Rule::Emission(_) => "emits vertices",
        };
        if matches!(formula.rule, Rule::Emission(_)) != layout.max_vertices.is_some() {
            let stage = if layout.max_vertices.is_some() { "geometry stage" } else { "vertex stage or function" };
            return Err(ReferenceError::Stage { formula: formula.name, gives, stage });
        }
        let records = (program.invocation_record(), program.case_record());
        let mut this = Self {
            formula,
            invocation: Vec::new(),
            case: Vec::new(),
            input_words: formula.inputs.iter().map(Param::words).sum(),
            vectors: formula.inputs.iter().flat_map(|p| std::iter::repeat_n(is_vector(p.kind), p.words())).collect(),
            outputs: Vec::new(),
            vertex_words: formula.outputs.iter().map(Param::words).sum(),
        };
        let mut to = 0;
        for param in formula.inputs {
            this.bind_input(param, to, &records)?;
            to += param.words();
        }
        this.bind_outputs(&layout)?;
        Ok(this)
    }

    /// No formula: every output is judged by what the shader itself means, and nothing is expected of it.
    pub fn without_formula() -> Self {
        static NOTHING: Formula =
            Formula { name: "", source: "", inputs: &[], outputs: &[], rule: Rule::Pointwise(|_, _| {}) };
        Self {
            formula: &NOTHING,
            invocation: Vec::new(),
            case: Vec::new(),
            input_words: 0,
            vectors: Arc::default(),
            outputs: Vec::new(),
            vertex_words: 0,
        }
    }

    fn bind_input(
        &mut self,
        param: &Param,
        to: usize,
        (invocation, case): &(Record, Record),
    ) -> Result<(), ReferenceError> {
        for (record, copies) in [(invocation, &mut self.invocation), (case, &mut self.case)] {
            if let Some(index) = record.index_of(param.name)
                && fits(param, record, index)
            {
                let scalar = record.fields()[index].shape.scalar;
                copies.push(Copy { to, from: record.range(index), scalar });
                return Ok(());
            }
        }
        let names: Vec<String> =
            invocation.fields().iter().chain(case.fields()).map(|f| format!("`{} {}`", f.shape, f.name)).collect();
        Err(ReferenceError::MissingInput {
            formula: self.formula.name,
            name: param.name,
            ty: type_name(param),
            has: list(&names),
        })
    }

    fn bind_outputs(&mut self, layout: &OutputLayout) -> Result<(), ReferenceError> {
        let record = &layout.vertex;
        let mut at = 0;
        for param in self.formula.outputs {
            let index = record.index_of(param.name).filter(|&i| fits(param, record, i));
            let Some(index) = index else {
                let names: Vec<String> = record.fields().iter().map(|f| format!("`{} {}`", f.shape, f.name)).collect();
                return Err(ReferenceError::MissingOutput {
                    formula: self.formula.name,
                    name: param.name,
                    ty: type_name(param),
                    has: list(&names),
                });
            };
            self.outputs.push(Output {
                expected: at..at + param.words(),
                actual: record.range(index),
                scalar: record.fields()[index].shape.scalar,
            });
            at += param.words();
        }
        Ok(())
    }

    /// The formula.
    pub fn formula(&self) -> &'static Formula {
        self.formula
    }

    /// True for a formula that emits vertices.
    pub(super) fn emits(&self) -> bool {
        matches!(self.formula.rule, Rule::Emission(_))
    }

    /// Room for the inputs of one evaluation.
    pub(super) fn scratch(&self) -> Vec<f64> {
        vec![0.0; self.input_words]
    }

    /// Reads the uniforms of a case.
    pub(super) fn read_case(&self, batch: &Batch, case: usize, inputs: &mut [f64]) {
        read(&self.case, batch.case(case), inputs);
    }

    /// Reads the inputs of an invocation.
    pub(super) fn read_invocation(&self, batch: &Batch, invocation: usize, inputs: &mut [f64]) {
        read(&self.invocation, batch.invocation(invocation), inputs);
    }

    /// Evaluates the formula.
    pub(super) fn eval(&self, inputs: &[f64], expected: &mut Expected) {
        let args = Args::new(self.formula.inputs, inputs);
        match self.formula.rule {
            Rule::Pointwise(rule) => {
                expected.words.resize(self.vertex_words, 0.0);
                rule(&args, &mut expected.words);
            }
            Rule::Emission(rule) => {
                let mut emission = Emission::default();
                rule(&args, &mut emission);
                expected.words = std::mem::take(&mut emission.words);
                expected.strips = std::mem::take(&mut emission.strips);
            }
        }
    }

    /// The largest component of all vectors among the inputs.
    pub(super) fn vector_size(&self, inputs: &[f64]) -> f64 {
        let vectors = inputs.iter().zip(self.vectors.iter()).filter(|(_, vector)| **vector);
        vectors.fold(0.0, |m, (x, _)| m.max(x.abs()))
    }
}

fn is_vector(kind: Kind) -> bool {
    match kind {
        Kind::Vec2 | Kind::Vec3 | Kind::Vec4 => true,
        Kind::Int | Kind::Float | Kind::Mat4 => false,
    }
}

fn read(copies: &[Copy], words: &[u32], inputs: &mut [f64]) {
    for copy in copies {
        let to = &mut inputs[copy.to..copy.to + copy.from.len()];
        let from = &words[copy.from.clone()];
        match copy.scalar {
            Scalar::F32 => to.iter_mut().zip(from).for_each(|(to, &w)| *to = f64::from(f32::from_bits(w))),
            Scalar::I32 => to.iter_mut().zip(from).for_each(|(to, &w)| *to = f64::from(w as i32)),
            Scalar::U32 | Scalar::Bool => to.iter_mut().zip(from).for_each(|(to, &w)| *to = f64::from(w)),
        }
    }
}

/// True when the field with this index has the type of `param`.
fn fits(param: &Param, record: &Record, index: usize) -> bool {
    let shape = record.fields()[index].shape;
    let real = shape.scalar == Scalar::F32;
    let (columns, rows) = match param.kind {
        Kind::Float | Kind::Int => (1, 1),
        Kind::Vec2 => (1, 2),
        Kind::Vec3 => (1, 3),
        Kind::Vec4 => (1, 4),
        Kind::Mat4 => (4, 4),
    };
    let array = shape.array.map(|n| n as usize);
    real != (param.kind == Kind::Int) && (shape.columns, shape.rows) == (columns, rows) && array == param.array
}

fn type_name(param: &Param) -> String {
    let name = match param.kind {
        Kind::Float => "float",
        Kind::Int => "int",
        Kind::Vec2 => "vec2",
        Kind::Vec3 => "vec3",
        Kind::Vec4 => "vec4",
        Kind::Mat4 => "mat4",
    };
    param.array.map_or_else(|| name.to_owned(), |n| format!("{name}[{n}]"))
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
