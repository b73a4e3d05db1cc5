//! Finds each variable of the author's interface in the module.

use naga::valid::ModuleInfo;
use naga::{
    AddressSpace, ArraySize, Binding, BuiltIn, Function, GlobalVariable, Handle, Module, Span, Type, TypeInner,
};

use super::capture::shape_of;
use super::{Entry, Port, PortAt, Program, ProgramError};
use crate::lower::{Lowered, Role, Variable};
use base::value::Shape;

/// Name of the array of vertices that a geometry stage reads.
const GL_IN: &str = "gl_in";

pub(super) fn resolve(mut module: Module, info: ModuleInfo, lowered: Lowered) -> Result<Program, ProgramError> {
    let entry = entry(&module, &lowered.role)?;
    let uniforms = lowered.uniforms.iter().map(|v| uniform(&module, v)).collect::<Result<Vec<_>, _>>()?;
    let (inputs, outputs) = match (&lowered.role, entry) {
        (Role::Vertex, Entry::Point(index)) => {
            let function = &module.entry_points[index].function;
            (
                lowered
                    .inputs
                    .iter()
                    .filter_map(|v| attribute(&module, function, v).transpose())
                    .collect::<Result<_, _>>()?,
                lowered.outputs.iter().map(|v| varying(&module, function, v)).collect::<Result<_, _>>()?,
            )
        }
        (Role::Geometry(_), _) => {
            let outputs = lowered.outputs.iter().map(|v| private(&module, v)).collect::<Result<_, _>>()?;
            let mut inputs = Vec::new();
            for v in &lowered.inputs {
                inputs.push(primitive_input(&mut module, v)?);
            }
            (inputs, outputs)
        }
        (Role::Function { .. }, Entry::Function(handle)) => {
            let function = &module.functions[handle];
            (
                lowered.inputs.iter().map(|v| parameter(&module, function, v)).collect::<Result<_, _>>()?,
                lowered.outputs.iter().map(|v| parameter_or_result(&module, function, v)).collect::<Result<_, _>>()?,
            )
        }
        (role, entry) => return Err(ProgramError::internal(format!("{role:?} with {entry:?}"))),
    };
    // A type that was added for an input changes what the validator knows.
    let info = if matches!(lowered.role, Role::Geometry(_)) { super::validate(&module)? } else { info };
    Ok(Program {
        module,
        info,
        entry,
        role: lowered.role.clone(),
        inputs,
        uniforms,
        outputs,
        built_ins: Vec::new(),
        textures: Vec::new(),
        stage_module: None,
        unfed: Vec::new(),
        ranges: Vec::new(),
        memory: Vec::new(),
        lowered,
        texts: Vec::new(),
        constants: std::sync::Arc::default(),
    })
}

fn entry(module: &Module, role: &Role) -> Result<Entry, ProgramError> {
    match role {
        Role::Vertex | Role::Fragment | Role::Compute | Role::Geometry(_) => {
            if module.entry_points.is_empty() {
                return Err(ProgramError::internal("the lowered text has no entry point".to_owned()));
            }
            Ok(Entry::Point(0))
        }
        Role::Function { name } => {
            let mut found = module.functions.iter().filter(|(_, f)| f.name.as_deref() == Some(name));
            match (found.next(), found.next()) {
                (Some((handle, _)), None) => Ok(Entry::Function(handle)),
                (None, _) => Err(ProgramError::internal(format!("the lowered text has no function `{name}`"))),
                (Some(_), Some(_)) => {
                    Err(ProgramError::Unsupported { what: format!("`{name}` is overloaded; rename the one to test") })
                }
            }
        }
    }
}

fn port(module: &Module, variable: &Variable, ty: Handle<Type>, at: PortAt) -> Result<Port, ProgramError> {
    match shape_of(module, ty) {
        Some(shape) if shape == variable.shape => Ok(Port { field: variable.field(), ty, at, backing: None }),
        // Front end and module must agree on every type, else words would be fed to the wrong place.
        shape => Err(ProgramError::internal(format!(
            "`{}` is `{}` in the text and {shape:?} in the module",
            variable.name, variable.shape
        ))),
    }
}

fn uniform(module: &Module, variable: &Variable) -> Result<Port, ProgramError> {
    // `block.member` when the author's block has an instance name.
    let (instance, name) = match variable.name.split_once('.') {
        Some((instance, name)) => (Some(instance), name),
        None => (None, variable.name.as_str()),
    };
    for (handle, global) in module.global_variables.iter() {
        if global.space != AddressSpace::Uniform || instance.is_some_and(|i| global.name.as_deref() != Some(i)) {
            continue;
        }
        if let TypeInner::Struct { ref members, .. } = module.types[global.ty].inner {
            let member = members.iter().position(|m| m.name.as_deref() == Some(name));
            if let Some(k) = member {
                return port(module, variable, members[k].ty, PortAt::Member(handle, k as u32));
            }
        } else if global.name.as_deref() == Some(&variable.name) {
            return port(module, variable, global.ty, PortAt::Global(handle));
        }
    }
    Err(missing("uniform", variable))
}

/// `None` for an attribute that the module does not take: naga leaves out what is never declared used.
fn attribute(module: &Module, function: &Function, variable: &Variable) -> Result<Option<Port>, ProgramError> {
    let number = |built_in: &BuiltIn| match variable.name.as_str() {
        "gl_VertexID" | "gl_VertexIndex" => *built_in == BuiltIn::VertexIndex,
        "gl_InstanceID" | "gl_InstanceIndex" => *built_in == BuiltIn::InstanceIndex,
        "gl_BaseVertex" => *built_in == BuiltIn::BaseVertex,
        "gl_BaseInstance" => *built_in == BuiltIn::BaseInstance,
        "gl_DrawID" => *built_in == BuiltIn::DrawIndex,
        _ => false,
    };
    for (k, argument) in function.arguments.iter().enumerate() {
        if matches!(&argument.binding, Some(Binding::BuiltIn(built_in)) if number(built_in)) {
            // Without sign there, and below the sign here: the same bits.
            let at = PortAt::Argument(k as u32);
            return Ok(Some(Port { field: variable.field(), ty: argument.ty, at, backing: None }));
        }
        if let Some(Binding::Location { location, .. }) = argument.binding
            && Some(location) == variable.location
        {
            return port(module, variable, argument.ty, PortAt::Argument(k as u32)).map(Some);
        }
    }
    Err(missing("attribute", variable))
}

fn varying(module: &Module, function: &Function, variable: &Variable) -> Result<Port, ProgramError> {
    let backing = named_private(module, &variable.name);
    let fits = |binding: &Option<Binding>| match binding {
        Some(Binding::BuiltIn(BuiltIn::Position { .. })) => variable.name == "gl_Position",
        Some(Binding::BuiltIn(BuiltIn::PointSize)) => variable.name == "gl_PointSize",
        Some(Binding::Location { location, .. }) => variable.location == Some(*location),
        Some(Binding::BuiltIn(_)) | None => false,
    };
    let found = function.result.as_ref().and_then(|result| {
        if fits(&result.binding) {
            return Some((result.ty, PortAt::Result));
        }
        let TypeInner::Struct { ref members, .. } = module.types[result.ty].inner else { return None };
        let k = members.iter().position(|m| fits(&m.binding))?;
        Some((members[k].ty, PortAt::ResultMember(k as u32)))
    });
    let (ty, at) = found.ok_or_else(|| missing("output", variable))?;
    Ok(Port { backing, ..port(module, variable, ty, at)? })
}

fn named_private(module: &Module, name: &str) -> Option<Handle<GlobalVariable>> {
    let mut globals = module.global_variables.iter();
    globals.find(|(_, g)| g.space == AddressSpace::Private && g.name.as_deref() == Some(name)).map(|(h, _)| h)
}

fn private(module: &Module, variable: &Variable) -> Result<Port, ProgramError> {
    let handle = named_private(module, &variable.name).ok_or_else(|| missing("output", variable))?;
    port(module, variable, module.global_variables[handle].ty, PortAt::Global(handle))
}

/// An input of a geometry stage: an array of the user's, or a member of `gl_in`.
fn primitive_input(module: &mut Module, variable: &Variable) -> Result<Port, ProgramError> {
    if let Some(handle) = named_private(module, &variable.name).filter(|_| variable.name != "gl_Position") {
        return port(module, variable, module.global_variables[handle].ty, PortAt::Global(handle));
    }
    let global = named_private(module, GL_IN).ok_or_else(|| missing("input", variable))?;
    let not_array = || ProgramError::internal(format!("`{GL_IN}` is no array of structures"));
    let TypeInner::Array { base, size: ArraySize::Constant(count), .. } =
        module.types[module.global_variables[global].ty].inner
    else {
        return Err(not_array());
    };
    let TypeInner::Struct { ref members, .. } = module.types[base].inner else { return Err(not_array()) };
    let member = members.iter().position(|m| m.name.as_deref() == Some(&variable.name));
    let member = member.ok_or_else(|| missing("input", variable))?;
    let element = members[member].ty;
    let stride = shape_of(module, element).map_or(4, |s: Shape| 4 * s.words() as u32).next_multiple_of(16);
    let inner = TypeInner::Array { base: element, size: ArraySize::Constant(count), stride };
    let ty = module.types.insert(Type { name: None, inner }, Span::UNDEFINED);
    port(module, variable, ty, PortAt::Vertices { global, member: member as u32, count: count.get() })
}

fn parameter(module: &Module, function: &Function, variable: &Variable) -> Result<Port, ProgramError> {
    for (k, argument) in function.arguments.iter().enumerate() {
        if argument.name.as_deref() != Some(&variable.name) {
            continue;
        }
        let (ty, at) = match module.types[argument.ty].inner {
            TypeInner::Pointer { base, .. } => (base, PortAt::Reference(k as u32)),
            _ => (argument.ty, PortAt::Argument(k as u32)),
        };
        return port(module, variable, ty, at);
    }
    Err(missing("parameter", variable))
}

fn parameter_or_result(module: &Module, function: &Function, variable: &Variable) -> Result<Port, ProgramError> {
    match &function.result {
        Some(result) if variable.name == "return" => port(module, variable, result.ty, PortAt::Result),
        _ => parameter(module, function, variable),
    }
}

fn missing(kind: &str, variable: &Variable) -> ProgramError {
    ProgramError::internal(format!("{kind} `{}` is not in the lowered module", variable.name))
}
