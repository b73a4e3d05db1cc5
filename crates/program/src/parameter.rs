//! Parameters of functions in words that all languages share, so that functions of two texts can be told apart by them.

use naga::{ArraySize, Handle, Module, TypeInner};

use crate::capture::shape_of;
use syntax::symbols::{Direction, ParamInfo};
use syntax::types::{self, Type};

/// A parameter of a function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Its type as GLSL writes it; `{vec3, float}` for a structure, whatever it is called, and that of what a pointer
    /// points to.
    pub ty: String,
    /// Which way it carries its value; both ways for a pointer.
    pub direction: Direction,
}

impl Parameter {
    /// Of a function in GLSL.
    pub fn of(info: &ParamInfo) -> Self {
        Self { ty: of_tree(&info.ty), direction: info.direction }
    }

    /// Of a function of a module.
    pub(crate) fn of_module(module: &Module, ty: Handle<naga::Type>) -> Self {
        match module.types[ty].inner {
            TypeInner::Pointer { base, .. } => Self { ty: of_module(module, base), direction: Direction::InOut },
            _ => Self { ty: of_module(module, ty), direction: Direction::In },
        }
    }
}

fn of_tree(ty: &Type) -> String {
    match ty {
        Type::Struct(structure) => {
            let members: Vec<String> = structure.fields.iter().map(|field| of_tree(&field.ty)).collect();
            format!("{{{}}}", members.join(", "))
        }
        Type::Array(element, types::ArraySize::Known(n)) => format!("{}[{n}]", of_tree(element)),
        Type::Array(element, _) => format!("{}[]", of_tree(element)),
        other => other.to_string(),
    }
}

fn of_module(module: &Module, ty: Handle<naga::Type>) -> String {
    if let Some(shape) = shape_of(module, ty) {
        return shape.to_string();
    }
    match &module.types[ty].inner {
        TypeInner::Struct { members, .. } => {
            let members: Vec<String> = members.iter().map(|member| of_module(module, member.ty)).collect();
            format!("{{{}}}", members.join(", "))
        }
        TypeInner::Array { base, size: ArraySize::Constant(n), .. } => format!("{}[{n}]", of_module(module, *base)),
        TypeInner::Array { base, .. } => format!("{}[]", of_module(module, *base)),
        TypeInner::Image { .. } => "texture".to_owned(),
        TypeInner::Sampler { .. } => "sampler".to_owned(),
        _ => module.types[ty].name.clone().unwrap_or_else(|| "another type".to_owned()),
    }
}
