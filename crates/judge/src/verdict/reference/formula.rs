//! A formula, bound to the inputs and outputs of a program by name.

use super::{Expected, ReferenceError};
use crate::formula::{Args, Emission, Formula, Kind, Param, Rule};
use base::value::{Batch, Record, Scalar};
use program::Program;

/// A formula with the places of its inputs.
#[derive(Clone)]
pub(super) struct BoundFormula {
    pub formula: &'static Formula,
    invocation: Vec<Copy>,
    case: Vec<Copy>,
    input_words: usize,
}

/// Where the words of a formula's inputs come from.
#[derive(Clone, Debug)]
struct Copy {
    to: usize,
    from: std::ops::Range<usize>,
    scalar: Scalar,
}

/// Binds a formula to a program; with the indices of the outputs that it gives.
pub(super) fn bind(formula: &'static Formula, program: &Program) -> Result<(BoundFormula, Vec<usize>), ReferenceError> {
    let layout = program.output_layout();
    let by = || format!("the formula `{}`", formula.name);
    let gives = match formula.rule {
        Rule::Pointwise(_) => "gives one set of outputs",
        Rule::Emission(_) => "emits vertices",
    };
    if matches!(formula.rule, Rule::Emission(_)) != layout.max_vertices.is_some() {
        let stage = if layout.max_vertices.is_some() { "geometry stage" } else { "vertex stage or function" };
        return Err(ReferenceError::Stage { by: by(), gives, stage });
    }
    let records = [program.invocation_record(), program.case_record()];
    let input_words = formula.inputs.iter().map(Param::words).sum();
    let mut bound = BoundFormula { formula, invocation: Vec::new(), case: Vec::new(), input_words };
    let mut to = 0;
    for param in formula.inputs {
        let sides = records.iter().zip([&mut bound.invocation, &mut bound.case]);
        let mut found = sides.filter_map(|(record, copies)| {
            let index = record.index_of(param.name).filter(|&index| fits(param, record, index))?;
            Some((record.range(index), record.fields()[index].shape.scalar, copies))
        });
        let Some((from, scalar, copies)) = found.next() else {
            let has = list(program, records.iter().flat_map(Record::fields));
            return Err(ReferenceError::MissingInput { by: by(), name: param.name.into(), ty: type_name(param), has });
        };
        copies.push(Copy { to, from, scalar });
        to += param.words();
    }
    let record = &layout.vertex;
    let output = |param: &Param| {
        let index = program.output_called(param.name).filter(|&index| fits(param, record, index));
        index.ok_or_else(|| ReferenceError::MissingOutput {
            by: by(),
            name: param.name.into(),
            ty: type_name(param),
            has: list(program, record.fields()),
        })
    };
    let judged = formula.outputs.iter().map(output).collect::<Result<_, _>>()?;
    Ok((bound, judged))
}

impl BoundFormula {
    /// Room for the inputs of one evaluation.
    pub fn scratch(&self) -> Vec<f64> {
        vec![0.0; self.input_words]
    }

    /// Reads the uniforms of a case.
    pub fn read_case(&self, batch: &Batch, case: usize, inputs: &mut [f64]) {
        read(&self.case, batch.case(case), inputs);
    }

    /// Evaluates the formula for an invocation whose uniforms have been read.
    pub fn eval(&self, batch: &Batch, invocation: usize, inputs: &mut [f64], words: usize, expected: &mut Expected) {
        read(&self.invocation, batch.invocation(invocation), inputs);
        let args = Args::new(self.formula.inputs, inputs);
        match self.formula.rule {
            Rule::Pointwise(rule) => {
                expected.words.resize(words, 0.0);
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
}

fn read(copies: &[Copy], words: &[u32], inputs: &mut [f64]) {
    for copy in copies {
        let to = &mut inputs[copy.to..copy.to + copy.from.len()];
        to.iter_mut().zip(&words[copy.from.clone()]).for_each(|(to, &word)| *to = super::number(word, copy.scalar));
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
    // A uniform of WGSL is no array of numbers, and a vector of as many stands for one.
    if param.kind == Kind::Float && shape.columns == 1 && shape.array.is_none() && shape.rows > 1 {
        return real && param.array == Some(usize::from(shape.rows));
    }
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

/// Fields of a program as messages name them.
pub(super) fn list<'f>(program: &Program, fields: impl IntoIterator<Item = &'f base::value::Field>) -> String {
    let name = |f: &base::value::Field| format!("`{}`", program.written.declaration(&f.name, f.shape));
    let names: Vec<String> = fields.into_iter().map(name).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
