//! Functions that are run alone: a `main` behind the author's text that feeds the function and hands on what it gives, in a
//! vertex stage.

use std::sync::Arc;

use crate::LaneError;
use crate::opengl::call::{OTHER_MAIN, call};
use base::value::{Field, Record, Shape};
use program::{Attribute, Kernel};
use syntax::Shader;

/// A stage that calls a function.
pub(super) struct Function {
    /// The author's text with a `main` of the harness behind it.
    pub text: String,
    /// Macros that are defined in front of it, beside those of the program.
    pub defines: Vec<(String, String)>,
    /// What it takes.
    pub attributes: Vec<Attribute>,
    /// The words of an invocation as its attributes call them.
    pub invocation: Arc<Record>,
    /// The words of what it writes as its outputs call them.
    pub captured: Arc<Record>,
}

/// The stage that calls the function of a kernel.
///
/// # Errors
/// [`LaneError::Unsupported`] for parameters that are no numbers, vectors, matrices or arrays of them, and for a program of
/// several texts.
pub(super) fn function(kernel: &Kernel, name: &str) -> Result<Function, LaneError> {
    let program = &*kernel.program;
    let unsupported = |what: &str| Err(LaneError::Unsupported(what.to_owned()));
    if program.texts.len() != 1 {
        return unsupported("a function in a program of several texts");
    }
    let shader = Shader::parse_with(&program.file, program.stage, &program.defines).shader;
    let inputs = program.invocation_record();
    let call = call(&shader, name, &inputs, &kernel.output.vertex)?;
    if !call.fed.iter().copied().eq(0..inputs.words() as u32) {
        return unsupported("parameters in another order than their words");
    }
    let other = shader.function(OTHER_MAIN.0).is_some();
    let own = |(name, value): (&str, &str)| (name.to_owned(), value.to_owned());
    let defines = if other { vec![own(OTHER_MAIN)] } else { Vec::new() };
    let undefined = if other { format!("#undef {}\n", OTHER_MAIN.0) } else { String::new() };
    let text = format!("{}\n{undefined}{}", program.file.text(), call.behind);
    let fields: Vec<Field> = call
        .attributes
        .iter()
        .map(|a| Field { name: a.name.clone(), shape: Shape::vector(a.scalar, a.components) })
        .collect();
    let attribute = |(k, field): (usize, &Field)| Attribute {
        field: field.clone(),
        location: k as u32,
        components: field.shape.rows,
    };
    let attributes = fields.iter().enumerate().map(attribute).collect();
    let captured = call.outputs.iter().map(|o| Field { name: o.name.clone(), shape: o.shape }).collect();
    let (invocation, captured) = (Arc::new(Record::new(fields)), Arc::new(Record::new(captured)));
    Ok(Function { text, defines, attributes, invocation, captured })
}
