//! Functions of a host that read and write a buffer: a macro that gets the array itself can hardly mean anything else.

use syntax::Shader;
use syntax::ast::{Callee, ExprKind};
use syntax::types::{ArraySize, ScalarType, Type};

/// What stands for a function that nothing declares, as a macro with its parameters, where each call gives it an array as long
/// as its buffer, an index into it, and what is written there: a value, or another array with an index.
pub(super) fn access(shader: &Shader, name: &str) -> Option<(String, String)> {
    let mut kinds: Option<Vec<Argument>> = None;
    for (_, expr) in shader.arena().iter() {
        let ExprKind::Call { callee: Callee::Name(own), args } = &expr.kind else { continue };
        if own.name != name {
            continue;
        }
        let found: Vec<Argument> = args.iter().map(|arg| Argument::of(shader.type_of(*arg))).collect();
        match &kinds {
            Some(known) if *known != found => return None,
            _ => kinds = Some(found),
        }
    }
    use Argument::{Index, Memory, Value};
    let (parameters, body) = match kinds?.as_slice() {
        [Memory, Index] => ("from,at", "from[at]"),
        [Memory, Index, Value | Index] => ("to,at,value", "to[at] = (value)"),
        [Memory, Index, Memory, Index] => ("to,at,from,of", "to[at] = from[of]"),
        _ => return None,
    };
    Some((format!("{name}({parameters})"), format!("({body})")))
}

/// What a call gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Argument {
    /// An array that is as long as its buffer.
    Memory,
    /// A whole number.
    Index,
    /// Anything else, also what has no type yet.
    Value,
}

impl Argument {
    fn of(ty: &Type) -> Self {
        match ty {
            Type::Array(_, ArraySize::Unsized) => Self::Memory,
            Type::Scalar(ScalarType::Int | ScalarType::Uint) => Self::Index,
            _ => Self::Value,
        }
    }
}
