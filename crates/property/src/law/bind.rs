//! Fitting a law to the inputs and outputs of a shader.

use std::sync::Arc;

use thiserror::Error;

use super::bound::{Aim, BoundLaw};
use super::{Law, LawKind};
use crate::{Own, Relation};
use base::nearest;
use base::value::{Field, Record, Scalar, Shape};

/// Why a law does not fit a shader.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{at}: {message}")]
pub struct LawError {
    /// Where the suite states the law.
    pub at: String,
    /// What is wrong and what would be right.
    pub message: String,
}

pub(super) fn bind(
    law: &Law,
    seen: &[Field],
    records: [&Record; 2],
    range: &dyn Fn(&str) -> Option<[f64; 2]>,
) -> Result<Own<dyn Relation>, LawError> {
    let binder = Binder { law, seen, inputs: records.iter().flat_map(|r| r.fields()).collect() };
    let outputs = binder.outputs()?;
    let (name, statement) = (binder.name(), binder.statement());
    binder.check()?;
    let range = match &law.kind {
        LawKind::Monotone { input, .. } => range(input),
        LawKind::Odd { .. }
        | LawKind::Even { .. }
        | LawKind::Periodic { .. }
        | LawKind::Range { .. }
        | LawKind::Unit
        | LawKind::Symmetric { .. }
        | LawKind::Rigid { .. }
        | LawKind::Scales { .. }
        | LawKind::Unordered { .. }
        | LawKind::Prefix { .. }
        | LawKind::Sorts { .. }
        | LawKind::Sums { .. }
        | LawKind::Additive { .. } => None,
    };
    let width = seen.iter().map(|f| f.shape.words()).sum();
    Ok(Own::Shared(Arc::new(BoundLaw { kind: law.kind.clone(), name, statement, outputs, width, range })))
}

struct Binder<'a> {
    law: &'a Law,
    seen: &'a [Field],
    inputs: Vec<&'a Field>,
}

impl Binder<'_> {
    fn wrong<T>(&self, message: String) -> Result<T, LawError> {
        Err(LawError { at: self.law.at.clone(), message: format!("the law `{}` {message}", self.law.kind.name()) })
    }

    fn input(&self, name: &str) -> Result<&Field, LawError> {
        match self.inputs.iter().find(|f| f.name == name) {
            Some(field) => Ok(field),
            None => self.unknown("input", name, self.inputs.iter().copied()),
        }
    }

    fn unknown<'f, T>(
        &self,
        what: &str,
        name: &str,
        all: impl Iterator<Item = &'f Field> + Clone,
    ) -> Result<T, LawError> {
        let hint = match nearest(name, all.clone().map(|f| f.name.as_str())) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("{what}s are {}", all.map(|f| format!("`{}`", f.name)).collect::<Vec<_>>().join(", ")),
        };
        self.wrong(format!("names an {what} `{name}` that the shader does not have; {hint}"))
    }

    /// The outputs that the law is about, with what is claimed of each.
    fn outputs(&self) -> Result<Vec<(Field, usize, Aim)>, LawError> {
        let mut all = Vec::new();
        let mut at = 0;
        for field in self.seen {
            let aim = self.aim(field);
            let asked = self.law.outputs.contains(&field.name);
            match aim {
                Some(aim) if asked || self.law.outputs.is_empty() => all.push((field.clone(), at, aim)),
                None if asked => {
                    let wanted = match &self.law.kind {
                        LawKind::Unit => "float vectors".to_owned(),
                        LawKind::Unordered { .. } => "numbers".to_owned(),
                        LawKind::Prefix { .. } => "arrays with as many elements as its inputs".to_owned(),
                        LawKind::Sorts { input, .. } => format!("arrays of the type of `{input}`"),
                        LawKind::Sums { rows, .. } => format!("arrays that make {rows} equal rows"),
                        _ => "floats".to_owned(),
                    };
                    return self.wrong(format!("is about {wanted}, and `{} {}` is none", field.shape, field.name));
                }
                Some(_) | None => {}
            }
            at += field.shape.words();
        }
        for name in &self.law.outputs {
            if self.seen.iter().all(|f| f.name != *name) {
                return self.unknown("output", name, self.seen.iter());
            }
        }
        if all.is_empty() {
            return self.wrong("is about none of the shader's outputs".to_owned());
        }
        Ok(all)
    }

    fn aim(&self, field: &Field) -> Option<Aim> {
        let Shape { scalar, columns, rows, .. } = field.shape;
        let real = scalar == Scalar::F32;
        match &self.law.kind {
            LawKind::Unit => (real && columns == 1 && rows > 1).then_some(Aim::Plain),
            LawKind::Rigid { points, .. } if points.contains(&field.name) => Some(Aim::Point),
            LawKind::Rigid { directions, .. } if directions.contains(&field.name) => Some(Aim::Direction),
            LawKind::Odd { .. }
            | LawKind::Even { .. }
            | LawKind::Periodic { .. }
            | LawKind::Monotone { .. }
            | LawKind::Range { .. }
            | LawKind::Symmetric { .. }
            | LawKind::Rigid { .. }
            | LawKind::Scales { .. }
            | LawKind::Additive { .. } => real.then_some(Aim::Plain),
            // Whole numbers are elements too.
            LawKind::Unordered { .. } => (scalar != Scalar::Bool).then_some(Aim::Plain),
            LawKind::Prefix { inputs } => (self.elements(inputs) == Some(field.shape.elements())).then_some(Aim::Plain),
            LawKind::Sorts { input, .. } => {
                let sorted = self.inputs.iter().find(|of| of.name == *input);
                sorted.is_some_and(|of| of.shape == field.shape).then_some(Aim::Plain)
            }
            LawKind::Sums { rows, .. } => field.shape.words().is_multiple_of(*rows).then_some(Aim::Plain),
        }
    }

    /// Elements of the first of these inputs.
    fn elements(&self, inputs: &[String]) -> Option<usize> {
        let name = inputs.first()?;
        self.inputs.iter().find(|field| field.name == *name).map(|field| field.shape.elements())
    }

    /// Refuses inputs that the law cannot be about.
    fn check(&self) -> Result<(), LawError> {
        match &self.law.kind {
            LawKind::Odd { inputs }
            | LawKind::Even { inputs }
            | LawKind::Periodic { inputs, .. }
            | LawKind::Scales { inputs, .. }
            | LawKind::Additive { inputs } => {
                for name in inputs {
                    let Field { name, shape } = self.input(name)?;
                    if shape.scalar != Scalar::F32 {
                        return self.wrong(format!("is about inputs of floats, and `{shape} {name}` is none"));
                    }
                }
            }
            LawKind::Monotone { input, .. } => {
                let Field { name, shape } = self.input(input)?;
                if *shape != Shape::FLOAT {
                    return self.wrong(format!("is about one `float` of the inputs, and `{shape} {name}` is none"));
                }
            }
            LawKind::Symmetric { inputs } => {
                let first = self.input(&inputs[0])?.shape;
                for name in inputs {
                    let Field { name, shape } = self.input(name)?;
                    if *shape != first {
                        let other = &inputs[0];
                        let message = format!("exchanges inputs of one type; `{other}` is {first}, `{name}` {shape}");
                        return self.wrong(message);
                    }
                }
            }
            LawKind::Rigid { points, directions, .. } => return self.rigid(points, directions),
            LawKind::Unordered { inputs } | LawKind::Prefix { inputs } => {
                let len = self.input(&inputs[0])?.shape.elements();
                for name in inputs {
                    let Field { name, shape } = self.input(name)?;
                    if shape.array.is_none() || shape.elements() != len {
                        let other = &inputs[0];
                        let message = format!(
                            "is about arrays with as many elements as `{other}`, which has {len}; `{name}` is {shape}"
                        );
                        return self.wrong(message);
                    }
                }
            }
            LawKind::Sorts { input, .. } => {
                let Field { name, shape } = self.input(input)?;
                if shape.array.is_none() || shape.element_words() != 1 {
                    return self.wrong(format!("is about an array of numbers, and `{shape} {name}` is none"));
                }
            }
            LawKind::Range { .. } | LawKind::Unit | LawKind::Sums { .. } => {}
        }
        Ok(())
    }

    fn rigid(&self, points: &[String], directions: &[String]) -> Result<(), LawError> {
        let mut moved = false;
        for name in points.iter().chain(directions) {
            let found: Vec<&Field> = self.inputs.iter().copied().chain(self.seen).filter(|f| f.name == *name).collect();
            moved |= self.inputs.iter().any(|f| f.name == *name);
            if found.is_empty() {
                return self.unknown("input or output", name, self.inputs.iter().copied().chain(self.seen));
            }
            for Field { name, shape } in found {
                let element = shape.element();
                if ![Shape::vector(Scalar::F32, 3), Shape::VEC4].contains(&element) {
                    return self.wrong(format!("moves vec3, vec4 and arrays of them, and `{shape} {name}` is none"));
                }
            }
        }
        if moved { Ok(()) } else { self.wrong("moves no input; name those that are points or directions".to_owned()) }
    }

    /// `odd(x)`, `range(color)`: one law can be stated of several inputs or outputs.
    fn name(&self) -> String {
        let of = match &self.law.kind {
            LawKind::Odd { inputs }
            | LawKind::Even { inputs }
            | LawKind::Periodic { inputs, .. }
            | LawKind::Symmetric { inputs }
            | LawKind::Scales { inputs, .. }
            | LawKind::Unordered { inputs }
            | LawKind::Prefix { inputs }
            | LawKind::Additive { inputs } => inputs.join(", "),
            LawKind::Monotone { input, .. } | LawKind::Sorts { input, .. } => input.clone(),
            LawKind::Rigid { points, directions, .. } => [points.as_slice(), directions].concat().join(", "),
            LawKind::Range { .. } | LawKind::Unit | LawKind::Sums { .. } => self.law.outputs.join(", "),
        };
        let name = self.law.kind.name();
        if of.is_empty() { name.to_owned() } else { format!("{name}({of})") }
    }

    fn statement(&self) -> String {
        let list = |names: &[String]| names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
        match &self.law.kind {
            LawKind::Odd { inputs } => format!("changing the sign of {} changes the sign of the output", list(inputs)),
            LawKind::Even { inputs } => format!("changing the sign of {} changes nothing", list(inputs)),
            LawKind::Periodic { inputs, period } => format!("{period:?} added to {} changes nothing", list(inputs)),
            LawKind::Monotone { input, rising: true } => format!("the output does not fall where `{input}` grows"),
            LawKind::Monotone { input, rising: false } => format!("the output does not grow where `{input}` grows"),
            LawKind::Range { range: [lo, hi] } => format!("the output lies in [{lo:?}, {hi:?}]"),
            LawKind::Unit => "the output has length one".to_owned(),
            LawKind::Symmetric { inputs } => format!("exchanging {} changes nothing", list(inputs)),
            LawKind::Rigid { .. } => "turning and shifting the inputs turns and shifts the output with them".to_owned(),
            LawKind::Scales { inputs, degree } => {
                format!("scaling {} by k scales the output by k to the power of {degree}", list(inputs))
            }
            LawKind::Unordered { inputs } => format!("the order of the elements of {} changes nothing", list(inputs)),
            LawKind::Prefix { inputs } => {
                format!("the first elements of the output depend on as many first ones of {} alone", list(inputs))
            }
            LawKind::Sorts { input, rising: true } => format!("the output is `{input}` in ascending order"),
            LawKind::Sorts { input, rising: false } => format!("the output is `{input}` in descending order"),
            LawKind::Sums { total, rows: 1 } => format!("the elements of the output add up to {total:?}"),
            LawKind::Sums { total, rows } => {
                format!("the elements of each of {rows} rows of the output add up to {total:?}")
            }
            LawKind::Additive { inputs } => {
                format!("the output of a sum of {} is the sum of the outputs", list(inputs))
            }
        }
    }
}
