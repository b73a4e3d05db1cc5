//! Kernels that apply one operation, made the way that every shader goes.

use crate::profile::Op;
use base::text::SourceFile;

use program::lane;
use program::lower::Target;
use program::{Kernel, Program, ProgramError};
use syntax::Stage;

/// Values that one invocation of a sweep computes.
pub const SWEEP: usize = 16;

/// The operation in GLSL, with arguments x, y and z; `None` for what GLSL cannot write as one
/// operation.
pub fn expression(op: Op) -> Option<String> {
    let arguments = ["x", "x, y", "x, y, z"];
    let call = |name: &str| op.arity().map(|n| format!("{name}({})", arguments[n - 1]));
    match op {
        Op::Add => Some("x + y".to_owned()),
        Op::Sub => Some("x - y".to_owned()),
        Op::Mul => Some("x * y".to_owned()),
        Op::Div => Some("x / y".to_owned()),
        Op::Neg => Some("-x".to_owned()),
        Op::Atan2 => call("atan"),
        Op::Rem => None,
        _ => call(op.name()),
    }
}

/// A kernel with one result for each invocation: the arguments are the invocation's record.
///
/// # Errors
/// [`ProgramError`]; of our own making, since the text is.
pub fn pointwise(op: Op) -> Result<Kernel, ProgramError> {
    let (expression, arity) = expression(op).zip(op.arity()).ok_or_else(|| unsupported(op))?;
    let parameters = ["float x", "float x, float y", "float x, float y, float z"][arity - 1];
    function(op, &format!("float f({parameters}) {{ return {expression}; }}\n"))
}

/// A kernel with one result for each invocation in a stage of the device; the output is called
/// [`result_name`].
///
/// # Errors
/// [`ProgramError`]; of our own making, since the text is.
pub fn in_stage(op: Op, stage: lane::Stage) -> Result<Kernel, ProgramError> {
    match stage {
        lane::Stage::Compute => pointwise(op),
        lane::Stage::Vertex => vertex(op),
        lane::Stage::Geometry => {
            Err(ProgramError::Unsupported { what: "single operations in a geometry stage".to_owned() })
        }
    }
}

/// Name of the output of the kernels of [`in_stage`].
pub fn result_name(stage: lane::Stage) -> &'static str {
    match stage {
        lane::Stage::Compute => "return",
        lane::Stage::Vertex | lane::Stage::Geometry => "result",
    }
}

fn vertex(op: Op) -> Result<Kernel, ProgramError> {
    let (expression, arity) = expression(op).zip(op.arity()).ok_or_else(|| unsupported(op))?;
    let attribute = |(k, name): (usize, &&str)| format!("layout(location = {k}) in float {name};\n");
    let attributes: String = ["x", "y", "z"][..arity].iter().enumerate().map(attribute).collect();
    let text = format!(
        "#version {}\n{attributes}out float result;\n\
         void main() {{ result = {expression}; gl_Position = vec4(0.0); }}\n",
        version(op)
    );
    let file = SourceFile::new(format!("calibrate-{}.vert", op.name()), text);
    program(&file, Stage::Vertex, &Target::Stage)?.vertex_kernel(&vec![1; arity])
}

/// A kernel for a function of one argument in which each invocation takes a word and computes the
/// results for it and the [`SWEEP`] − 1 words behind it: inputs need no upload.
///
/// # Errors
/// [`ProgramError`]; of our own making, since the text is.
pub fn sweep(op: Op) -> Result<Kernel, ProgramError> {
    let expression = expression(op).filter(|_| op.arity() == Some(1)).ok_or_else(|| unsupported(op))?;
    let call = expression.replace("(x)", "(at(first + OFFSET))").replace("-x", "-at(first + OFFSET)");
    let part = |name: &str, k: usize| format!("    {name} = {};\n", call.replace("OFFSET", &format!("{k}u")));
    let body: String = ["a", "b", "c", "d"].iter().zip((0..).step_by(4)).map(|(name, k)| part(name, k)).collect();
    let at = "vec4 at(uint n) { return uintBitsToFloat(uvec4(n, n + 1u, n + 2u, n + 3u)); }\n";
    function(op, &format!("{at}void f(uint first, out vec4 a, out vec4 b, out vec4 c, out vec4 d) {{\n{body}}}\n"))
}

/// The oldest version of GLSL that has the operation and everything around it: not every driver has the newest.
fn version(op: Op) -> u32 {
    if op == Op::Fma { 400 } else { 330 }
}

fn unsupported(op: Op) -> ProgramError {
    ProgramError::Unsupported { what: format!("`{}` as a single operation of GLSL", op.name()) }
}

fn function(op: Op, body: &str) -> Result<Kernel, ProgramError> {
    let name = format!("calibrate-{}.glsl", op.name());
    let file = SourceFile::new(name, format!("#version {}\n{body}", version(op)));
    program(&file, Stage::Library, &Target::Function("f".to_owned()))?.compute_kernel()
}

/// A program from a text of our own.
pub fn program(file: &SourceFile, stage: Stage, target: &Target) -> Result<Program, ProgramError> {
    Program::from_source(file, stage, |_| Ok(target.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scalar_operation_of_glsl_has_kernels() {
        for op in Op::ALL {
            let pointwise = pointwise(op);
            assert_eq!(pointwise.is_ok(), expression(op).is_some(), "{op:?}: {:?}", pointwise.err());
            let vertex = in_stage(op, lane::Stage::Vertex);
            assert_eq!(vertex.is_ok(), expression(op).is_some(), "{op:?}: {:?}", vertex.err());
            let unary = expression(op).is_some() && op.arity() == Some(1);
            let sweep = sweep(op);
            assert_eq!(sweep.is_ok(), unary, "{op:?}: {:?}", sweep.err());
            if let Ok(kernel) = sweep {
                assert_eq!(kernel.output.vertex.words(), SWEEP);
                assert_eq!(kernel.invocation.words(), 1);
            }
        }
    }

    #[test]
    fn what_can_be_measured_has_an_exact_value() {
        for op in Op::ALL.into_iter().filter(|op| expression(*op).is_some()) {
            assert!(op.exact(&[0.5, 0.25, 2.0]).is_finite() || op == Op::Acosh, "{op:?}");
        }
    }
}
