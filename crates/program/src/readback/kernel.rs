//! A geometry stage or a function, found inside the kernel that was translated, or in naga's module of the author's
//! text.

use naga::valid::ModuleInfo;
use naga::{AddressSpace, Function, GlobalVariable, Handle, Module, Type, TypeInner};

use super::feed::Feed;
use super::names::nearest;
use super::{Place, ReadBack};
use crate::capture::{ENTRY_FUNCTION, shape_of};
use crate::lower::Role;
use crate::{Entry, Language, Port, PortAt, Program, TranslateError};

/// Functions and variables of a geometry stage that mean something by their name.
const EMISSION: [&str; 2] = ["EmitVertex", "EndPrimitive"];

pub(super) fn resolve(
    program: &Program,
    language: Language,
    module: Module,
    info: ModuleInfo,
) -> Result<ReadBack, TranslateError> {
    // Nothing here is the interface of the translation: what is not found by its name is no fault of it.
    let lost = |reason: String| TranslateError::ReadBack { language, reason };
    let mut back = KernelSearch { program, language, module }.all(info).map_err(lost)?;
    if let Role::Geometry(primitives) = program.role {
        back.max_vertices = Some(primitives.max_vertices);
        for name in EMISSION {
            // One that nothing calls is not there.
            if let Ok(function) = function(&back.module, name) {
                back.module.functions[function].name = Some(name.to_owned());
            }
        }
    }
    Ok(back)
}

fn function(module: &Module, name: &str) -> Result<Handle<Function>, String> {
    nearest(module.functions.iter().map(|(handle, f)| (handle, f.name.as_deref())), name)
        .ok_or_else(|| format!("it has no function `{name}`"))
}

fn privates(module: &Module) -> impl Iterator<Item = (Handle<GlobalVariable>, Option<&str>)> {
    let globals = module.global_variables.iter();
    globals.filter(|(_, v)| v.space == AddressSpace::Private).map(|(handle, v)| (handle, v.name.as_deref()))
}

struct KernelSearch<'p> {
    program: &'p Program,
    language: Language,
    module: Module,
}

impl KernelSearch<'_> {
    fn all(self, info: ModuleInfo) -> Result<ReadBack, String> {
        let (program, language) = (self.program, self.language);
        let wanted = match (&program.role, program.entry) {
            (Role::Function { name }, _) => name.as_str(),
            (_, Entry::Point(_)) if language == Language::NagaGlsl => "main",
            (_, Entry::Point(_)) => ENTRY_FUNCTION,
            (role, entry) => return Err(format!("{role:?} with {entry:?}")),
        };
        let entry = function(&self.module, wanted)?;
        let place = |port: &Port| self.place(&self.module.functions[entry], port);
        let inputs = program.inputs.iter().map(place).collect::<Result<Vec<_>, _>>()?;
        let outputs = program.outputs.iter().map(place).collect::<Result<Vec<_>, _>>()?;
        let uniforms = program.uniforms.iter().map(place).collect::<Result<Vec<_>, _>>()?;
        // Each takes its words as the program does.
        let words = |ports: &[Port]| 0..ports.iter().map(|port| port.field.shape.words() as u32).sum::<u32>();
        Ok(ReadBack {
            language,
            entry: Entry::Function(entry),
            inputs,
            uniforms,
            outputs,
            built_ins: Vec::new(),
            textures: super::textures(self.program, &self.module, !language.is_glsl()),
            max_vertices: None,
            record: program.output_layout().vertex,
            invocation: words(&program.inputs).map(Feed::Invocation).collect(),
            case: words(&program.uniforms).map(Feed::Case).collect(),
            module: self.module,
            info,
        })
    }

    fn place(&self, entry: &Function, port: &Port) -> Result<Place, String> {
        let (module, program, name) = (&self.module, self.program, &port.field.name);
        let argument = |k: u32| entry.arguments.get(k as usize).map(|argument| argument.ty);
        let (ty, at) = match port.at {
            PortAt::Part { global, ref path } => {
                let global = self.global(global, name)?;
                let whole = module.global_variables[global].ty;
                let ty = path.iter().try_fold(whole, |ty, &k| self.inside(ty, k));
                (ty, PortAt::Part { global, path: path.clone() })
            }
            PortAt::Argument(k) => (argument(k), PortAt::Argument(k)),
            PortAt::Reference(k) => {
                let pointer = argument(k).map(|ty| &module.types[ty].inner);
                let Some(&TypeInner::Pointer { base, .. }) = pointer else {
                    return Err(format!("`{name}` is no reference there"));
                };
                (Some(base), PortAt::Reference(k))
            }
            PortAt::Result => (entry.result.as_ref().map(|result| result.ty), PortAt::Result),
            PortAt::Global(own) => {
                let global = self.global(own, name)?;
                let ty = module.global_variables[global].ty;
                // A uniform that stands by itself here, and in a block there.
                let is_block = |module: &Module, ty| matches!(module.types[ty].inner, TypeInner::Struct { .. });
                let wrapped =
                    is_block(module, ty) && !is_block(&program.module, program.module.global_variables[own].ty);
                if wrapped {
                    (self.member(ty, 0), PortAt::Member(global, 0))
                } else {
                    (Some(ty), PortAt::Global(global))
                }
            }
            PortAt::Member(global, member) => {
                let global = self.global(global, name)?;
                (self.member(module.global_variables[global].ty, member), PortAt::Member(global, member))
            }
            PortAt::Vertices { global, member, count } => {
                let global = self.global(global, name)?;
                let TypeInner::Array { base, .. } = module.types[module.global_variables[global].ty].inner else {
                    return Err(format!("`{name}` lies in no array there"));
                };
                let ty = self.member(base, member).ok_or_else(|| format!("`{name}` is not there"))?;
                let found = shape_of(module, ty).map(|shape| shape.array_of(count));
                if found != Some(port.field.shape) {
                    return Err(format!("`{name}` is of another type there"));
                }
                return Ok(Place { name: name.clone(), ty, at: PortAt::Vertices { global, member, count } });
            }
            PortAt::ResultMember(_) | PortAt::Arguments { .. } => {
                return Err(format!("`{name}` lies at {:?}", port.at));
            }
        };
        let ty = ty.ok_or_else(|| format!("`{name}` is not there"))?;
        if shape_of(module, ty) != shape_of(&self.program.module, port.ty) {
            return Err(format!("`{name}` is `{}` in the shader and of another type there", port.field.shape));
        }
        Ok(Place { name: name.clone(), ty, at })
    }

    fn member(&self, ty: Handle<Type>, member: u32) -> Option<Handle<Type>> {
        match &self.module.types[ty].inner {
            TypeInner::Struct { members, .. } => members.get(member as usize).map(|member| member.ty),
            _ => None,
        }
    }

    /// The type of a member or an element.
    fn inside(&self, ty: Handle<Type>, k: u32) -> Option<Handle<Type>> {
        match self.module.types[ty].inner {
            TypeInner::Array { base, .. } => Some(base),
            _ => self.member(ty, k),
        }
    }

    /// The variable that stands for a global of the program: one with its binding for a uniform of the
    /// author's text, else a private variable by its name.
    /// Uniform blocks without a name of their own are known by the names of their members.
    fn global(&self, own: Handle<GlobalVariable>, of: &str) -> Result<Handle<GlobalVariable>, String> {
        let (module, variable) = (&self.module, &self.program.module.global_variables[own]);
        if variable.space == AddressSpace::Uniform && self.language == Language::NagaGlsl {
            let bound = |v: &GlobalVariable| v.space == AddressSpace::Uniform && v.binding == variable.binding;
            let found = module.global_variables.iter().find(|(_, v)| bound(v)).map(|(handle, _)| handle);
            return found.ok_or_else(|| format!("nothing there has the binding of `{of}`"));
        }
        let found = match (&variable.name, &self.program.module.types[variable.ty].inner) {
            (Some(name), _) => nearest(privates(module), name),
            (None, TypeInner::Struct { members, .. }) => {
                let first = members.first().and_then(|member| member.name.as_deref());
                let blocks = privates(module).filter_map(|(handle, _)| {
                    match &module.types[module.global_variables[handle].ty].inner {
                        TypeInner::Struct { members: here, .. } if here.len() == members.len() => {
                            Some((handle, here[0].name.as_deref()))
                        }
                        _ => None,
                    }
                });
                first.and_then(|first| nearest(blocks, first))
            }
            (None, _) => None,
        };
        found.ok_or_else(|| format!("the variable that holds `{of}` is not to be found there by its name"))
    }
}
