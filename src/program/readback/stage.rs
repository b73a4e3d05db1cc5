//! A vertex stage that was read back, bound as a host binds it.

use std::collections::HashMap;

use naga::valid::ModuleInfo;
use naga::{AddressSpace, Binding, Function, Handle, Module, Type, TypeInner};

use super::{Place, ReadBack};
use crate::program::capture::shape_of;
use crate::program::layout::byte_offsets;
use crate::program::{Entry, Language, Port, PortAt, Program, ProgramError, TranslateError};

pub(super) fn resolve(
    program: &Program,
    language: Language,
    module: Module,
    info: ModuleInfo,
) -> Result<ReadBack, TranslateError> {
    let other = |reason: String| TranslateError::Interface { language, reason };
    let Entry::Point(index) = program.entry else {
        return Err(ProgramError::internal("a vertex program without entry point".to_owned()).into());
    };
    let own = &program.module.entry_points[index].function;
    let Some(entry) = module.entry_points.first() else { return Err(other("it has no entry point".to_owned())) };
    let (mut inputs, mut invocation) = (Vec::new(), Vec::new());
    let mut arguments = entry.function.arguments.iter().enumerate();
    let of_argument = |(k, argument): (usize, &naga::FunctionArgument)| -> Result<(), String> {
        match &argument.binding {
            Some(Binding::BuiltIn(built_in)) => match input(program, own, &Binding::BuiltIn(*built_in)) {
                Some((port, first)) => {
                    invocation.push(Some(first as u32));
                    let at = PortAt::Argument(k as u32);
                    inputs.push(Place { name: port.field.name.clone(), ty: argument.ty, at });
                }
                None => return Err(format!("it takes {built_in:?}, which the shader does not")),
            },
            Some(Binding::Location { location, .. }) => {
                let found = argument.binding.as_ref().and_then(|binding| input(program, own, binding));
                let (port, first) = found.ok_or_else(|| {
                    format!("it takes an attribute at location {location}, which the shader does not")
                })?;
                same_shape(program, port, &module, argument.ty)?;
                invocation.extend((first..).take(port.field.shape.words()).map(|word| Some(word as u32)));
                inputs.push(Place { name: port.field.name.clone(), ty: argument.ty, at: PortAt::Argument(k as u32) });
            }
            None => return Err(format!("argument {k} of its entry point has no location")),
        }
        Ok(())
    };
    arguments.try_for_each(of_argument).map_err(other)?;
    let output = |port: &Port| -> Result<Place, String> {
        let binding = result_binding(&program.module, own, &port.at);
        let found = binding.and_then(|binding| result(&module, &entry.function, binding));
        let (ty, at) = found.ok_or_else(|| format!("it does not give `{}`", port.field.name))?;
        same_shape(program, port, &module, ty)?;
        Ok(Place { name: port.field.name.clone(), ty, at })
    };
    let outputs = program.outputs.iter().map(output).collect::<Result<_, _>>().map_err(other)?;
    let (uniforms, case) = uniforms(program, &module, language).map_err(other)?;
    Ok(ReadBack {
        language,
        entry: Entry::Point(0),
        inputs,
        uniforms,
        outputs,
        built_ins: Vec::new(),
        textures: super::textures(program, &module),
        max_vertices: None,
        invocation,
        case,
        module,
        info,
    })
}

/// The attribute at a location, or the number of the draw, with its first word in the invocation record.
fn input<'p>(program: &'p Program, own: &Function, binding: &Binding) -> Option<(&'p Port, usize)> {
    let mut word = 0;
    for port in &program.inputs {
        if let PortAt::Argument(k) = port.at
            && own.arguments[k as usize].binding.as_ref().is_some_and(|here| same_binding(here, binding))
        {
            return Some((port, word));
        }
        word += port.field.shape.words();
    }
    None
}

fn same_shape(program: &Program, port: &Port, module: &Module, ty: Handle<Type>) -> Result<(), String> {
    if shape_of(module, ty) == shape_of(&program.module, port.ty) {
        return Ok(());
    }
    Err(format!("`{}` is `{}` in the shader and of another type there", port.field.name, port.field.shape))
}

/// The binding of an output in the result of an entry point.
fn result_binding<'m>(module: &'m Module, function: &'m Function, at: &PortAt) -> Option<&'m Binding> {
    let result = function.result.as_ref()?;
    match *at {
        PortAt::Result => result.binding.as_ref(),
        PortAt::ResultMember(k) => match &module.types[result.ty].inner {
            TypeInner::Struct { members, .. } => members.get(k as usize)?.binding.as_ref(),
            _ => None,
        },
        _ => None,
    }
}

/// Where an entry point gives the output with this binding.
fn result(module: &Module, function: &Function, binding: &Binding) -> Option<(Handle<Type>, PortAt)> {
    let result = function.result.as_ref()?;
    if result.binding.as_ref().is_some_and(|here| same_binding(here, binding)) {
        return Some((result.ty, PortAt::Result));
    }
    let TypeInner::Struct { members, .. } = &module.types[result.ty].inner else { return None };
    let fits = |binding_here: &Option<Binding>| binding_here.as_ref().is_some_and(|here| same_binding(here, binding));
    let k = members.iter().position(|member| fits(&member.binding))?;
    Some((members[k].ty, PortAt::ResultMember(k as u32)))
}

/// The same place, however it is interpolated.
fn same_binding(a: &Binding, b: &Binding) -> bool {
    match (a, b) {
        (Binding::Location { location: a, .. }, Binding::Location { location: b, .. }) => a == b,
        (Binding::BuiltIn(a), Binding::BuiltIn(b)) => std::mem::discriminant(a) == std::mem::discriminant(b),
        _ => false,
    }
}

/// The uniform buffers of the translation, and for each of their words the word of the case that a
/// host puts at its byte.
fn uniforms(program: &Program, module: &Module, language: Language) -> Result<(Vec<Place>, Vec<Option<u32>>), String> {
    // GLSL has no groups.
    let key = |group: u32, binding: u32| if language == Language::Glsl450 { (0, binding) } else { (group, binding) };
    let mut fed = HashMap::new();
    let mut word = 0;
    for port in &program.uniforms {
        let (global, start) = match port.at {
            PortAt::Global(global) => (global, 0),
            PortAt::Member(global, member) => {
                let ty = program.module.global_variables[global].ty;
                let TypeInner::Struct { members, .. } = &program.module.types[ty].inner else {
                    return Err(format!("`{}` lies in no block", port.field.name));
                };
                (global, members[member as usize].offset)
            }
            ref at => return Err(format!("`{}` lies at {at:?}", port.field.name)),
        };
        let binding = program.module.global_variables[global].binding;
        let binding = binding.ok_or_else(|| format!("`{}` has no binding", port.field.name))?;
        let mut bytes = Vec::new();
        byte_offsets(&program.module, port.ty, start, &mut bytes);
        for byte in bytes {
            fed.insert((key(binding.group, binding.binding), byte), word);
            word += 1;
        }
    }
    let (mut places, mut case) = (Vec::new(), Vec::new());
    for (handle, global) in module.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::Uniform) {
        let name = global.name.clone().unwrap_or_else(|| "a uniform buffer".to_owned());
        let at = global.binding.map(|b| key(b.group, b.binding));
        let at = at.filter(|at| fed.keys().any(|(there, _)| there == at));
        let at = at.ok_or_else(|| format!("it takes `{name}`, at whose binding the shader takes nothing"))?;
        let mut bytes = Vec::new();
        byte_offsets(module, global.ty, 0, &mut bytes);
        case.extend(bytes.into_iter().map(|byte| fed.get(&(at, byte)).copied()));
        places.push(Place { name, ty: global.ty, at: PortAt::Global(handle) });
    }
    Ok((places, case))
}
