//! A stage bound as a host binds it: attributes, varyings and built-in values by location and name, buffers by binding
//! and the places of their words.
//!
//! The shader's own module and each translation are bound in the same way to the same inputs. What the program takes
//! comes from its batch; what only a device or a buffer would give is made up, the same for every module.

use std::collections::HashMap;

use naga::valid::GlobalUse;
use naga::{
    AddressSpace, Binding, BuiltIn, Function, GlobalVariable, Handle, Module, ResourceBinding, Type, TypeInner,
};

use super::alone::{Alone, alone};
use super::feed::Feed;
use super::{Place, ReadBack};
use crate::capture::shape_of;
use crate::layout::{byte_offsets, words};
use crate::lower::Role;
use crate::read::flat_if_needed;
use crate::{DISCARD, Entry, Language, PortAt, Program, TranslateError};
use base::value::{Field, Record, Scalar, Shape};

/// What GLSL adds to the number of an instance; a host of OpenGL leaves it at 0.
const FIRST_INSTANCE: &str = "naga_vs_first_instance";

/// Where a value goes in or out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum At {
    /// Location, and which of two sources of blending.
    Location(u32, u32),
    BuiltIn(std::mem::Discriminant<BuiltIn>),
}

impl At {
    fn of(binding: &Binding) -> Self {
        match *binding {
            Binding::Location { location, blend_src, .. } => Self::Location(location, blend_src.unwrap_or(0)),
            Binding::BuiltIn(built_in) => Self::BuiltIn(std::mem::discriminant(&built_in)),
        }
    }
}

/// Group and binding; languages without groups have the first one alone.
type Key = (u32, u32);
/// Words of a buffer by byte.
type Words = HashMap<u32, (Scalar, Feed)>;

/// The stage in the shader's own module.
struct OwnStage<'p> {
    program: &'p Program,
    grouped: bool,
    module: Module,
    alone: Alone,
    info: naga::valid::ModuleInfo,
    inputs: HashMap<At, (Handle<Type>, Vec<Feed>)>,
    outputs: Vec<(At, String, Handle<Type>)>,
    buffers: HashMap<Key, Words>,
}

/// The stage as the shader has it, bound like a translation to this language.
pub(super) fn own(program: &Program, language: Language) -> Result<ReadBack, TranslateError> {
    let own = OwnStage::new(program, language)?;
    let (module, alone, info) = (own.module.clone(), own.alone.clone(), own.info.clone());
    own.bind(language, module, alone, info)
}

/// A translation of the stage.
pub(super) fn resolve(program: &Program, language: Language, mut module: Module) -> Result<ReadBack, TranslateError> {
    let own = OwnStage::new(program, language)?;
    flat_if_needed(&mut module);
    let (alone, info) = alone(&mut module)?;
    own.bind(language, module, alone, info)
}

impl<'p> OwnStage<'p> {
    fn new(program: &'p Program, language: Language) -> Result<Self, TranslateError> {
        let host = program.stage_module.as_deref().map_or(&program.module, |(module, _)| module);
        let mut module = host.clone();
        flat_if_needed(&mut module);
        let (alone, info) = alone(&mut module)?;
        let grouped = !language.is_glsl();
        let (inputs, outputs, buffers) = (HashMap::new(), Vec::new(), HashMap::new());
        let mut own = Self { program, grouped, module, alone, info, inputs, outputs, buffers };
        let unbound = |reason: String| TranslateError::ReadBack { language, reason };
        own.find_inputs().map_err(unbound)?;
        own.find_outputs();
        own.find_buffers().map_err(unbound)?;
        Ok(own)
    }

    fn entry(module: &Module) -> Result<&Function, String> {
        module.entry_points.first().map(|point| &point.function).ok_or_else(|| "it has no entry point".to_owned())
    }

    fn find_inputs(&mut self) -> Result<(), String> {
        let fed = fed(self.program);
        let mut seed = 0;
        for argument in &Self::entry(&self.module)?.arguments {
            let Some(binding) = &argument.binding else { continue };
            let at = At::of(binding);
            let shape = shape_of(&self.module, argument.ty);
            let shape = shape.ok_or("it takes a value of a type that is not interpreted")?;
            let words = (0..shape.words()).map(|k| match fed.get(&at).and_then(|words| words.get(k)) {
                Some(&word) => Feed::Invocation(word),
                None => {
                    seed += 1;
                    Feed::MadeUp(seed, shape.scalar)
                }
            });
            let words = words.collect();
            self.inputs.insert(at, (argument.ty, words));
        }
        Ok(())
    }

    fn find_outputs(&mut self) {
        let Ok(Some(result)) = Self::entry(&self.module).map(|entry| entry.result.as_ref()) else { return };
        let port = |at: PortAt| self.program.outputs.iter().find(|port| port.at == at).map(|p| p.field.name.clone());
        let reported = |at: At, name: &Option<String>| match (name, at) {
            (Some(name), _) => name.clone(),
            (None, At::Location(location, _)) => format!("location {location}"),
            (None, At::BuiltIn(_)) => "a built-in value".to_owned(),
        };
        let mut all = Vec::new();
        if let Some(binding) = &result.binding {
            let at = At::of(binding);
            all.push((at, reported(at, &port(PortAt::Result)), result.ty));
        } else if let TypeInner::Struct { members, .. } = &self.module.types[result.ty].inner {
            for (k, member) in (0..).zip(members) {
                let Some(binding) = &member.binding else { continue };
                let at = At::of(binding);
                let name = port(PortAt::ResultMember(k)).or_else(|| member.name.clone());
                all.push((at, reported(at, &name), member.ty));
            }
        }
        self.outputs = all;
    }

    fn find_buffers(&mut self) -> Result<(), String> {
        let fed = uniforms(self.program)?;
        let storage = self.alone.storage.iter().map(|&(handle, binding)| (handle, binding));
        let uniform = self.module.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::Uniform);
        let all: Vec<_> = uniform.filter_map(|(handle, v)| Some((handle, v.binding?))).chain(storage).collect();
        for (handle, binding) in all {
            let name = name_of(&self.module, handle);
            let ty = self.module.global_variables[handle].ty;
            let words =
                words(&self.module, ty, 0).ok_or_else(|| format!("`{name}` has a type that is not interpreted"))?;
            let word = |(byte, scalar): (u32, Scalar)| {
                let from = fed.get(&(binding, byte)).map(|&word| Feed::Case(word));
                let seed = binding.group.wrapping_mul(31).wrapping_add(binding.binding).wrapping_mul(1 << 20) + byte;
                (byte, (scalar, from.unwrap_or(Feed::MadeUp(seed, scalar))))
            };
            let words = words.into_iter().map(word).collect();
            self.buffers.insert(self.key(binding), words);
        }
        Ok(())
    }

    fn key(&self, binding: ResourceBinding) -> Key {
        (if self.grouped { binding.group } else { 0 }, binding.binding)
    }

    /// Binds a module to the inputs and outputs of this stage.
    fn bind(
        &self,
        language: Language,
        module: Module,
        alone: Alone,
        info: naga::valid::ModuleInfo,
    ) -> Result<ReadBack, TranslateError> {
        let other = |reason: String| TranslateError::Interface { language, reason };
        let mut bound = Bound::new(self, &module);
        bound.inputs().map_err(other)?;
        bound.outputs().map_err(other)?;
        bound.buffers(&alone).map_err(other)?;
        bound.discarded(&alone);
        let Bound { inputs, uniforms, outputs, built_ins, invocation, case, fields, .. } = bound;
        Ok(ReadBack {
            language,
            entry: Entry::Point(0),
            inputs,
            uniforms,
            outputs,
            built_ins,
            textures: super::textures(self.program, &module, self.grouped),
            max_vertices: None,
            record: Record::new(fields).into(),
            invocation,
            case,
            module,
            info,
        })
    }
}

/// A module while it is bound.
struct Bound<'o> {
    own: &'o OwnStage<'o>,
    module: &'o Module,
    inputs: Vec<Place>,
    uniforms: Vec<Place>,
    outputs: Vec<Place>,
    built_ins: Vec<(u32, BuiltIn)>,
    invocation: Vec<Feed>,
    case: Vec<Feed>,
    fields: Vec<Field>,
}

impl<'o> Bound<'o> {
    fn new(own: &'o OwnStage<'o>, module: &'o Module) -> Self {
        Self {
            own,
            module,
            inputs: Vec::new(),
            uniforms: Vec::new(),
            outputs: Vec::new(),
            built_ins: Vec::new(),
            invocation: Vec::new(),
            case: Vec::new(),
            fields: Vec::new(),
        }
    }

    fn inputs(&mut self) -> Result<(), String> {
        let kind = if self.own.program.role == Role::Vertex { "an attribute" } else { "an input" };
        for (k, argument) in (0..).zip(&OwnStage::entry(self.module)?.arguments) {
            let Some(binding) = &argument.binding else {
                return Err(format!("argument {k} of its entry point has no location"));
            };
            match (self.own.inputs.get(&At::of(binding)), binding) {
                (Some((ty, words)), _) => {
                    let place = Place { name: format!("argument {k}"), ty: argument.ty, at: PortAt::Argument(k) };
                    let name = argument.name.as_deref().unwrap_or(&place.name);
                    same_shape(name, &self.own.module, *ty, self.module, argument.ty)?;
                    self.invocation.extend(words);
                    self.inputs.push(place);
                }
                (None, Binding::BuiltIn(built_in)) => self.built_ins.push((k, *built_in)),
                (None, Binding::Location { location, .. }) => {
                    return Err(format!("it takes {kind} at location {location}, which the shader does not"));
                }
            }
        }
        Ok(())
    }

    fn outputs(&mut self) -> Result<(), String> {
        let entry = OwnStage::entry(self.module)?;
        for (at, name, own) in &self.own.outputs {
            let (ty, at) = result(self.module, entry, *at).ok_or_else(|| format!("it does not give `{name}`"))?;
            same_shape(name, &self.own.module, *own, self.module, ty)?;
            let shape = shape_of(self.module, ty).ok_or_else(|| format!("`{name}` is not interpreted"))?;
            self.fields.push(Field { name: name.clone(), shape });
            self.outputs.push(Place { name: name.clone(), ty, at });
        }
        Ok(())
    }

    fn buffers(&mut self, alone: &Alone) -> Result<(), String> {
        let uniform = self.module.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::Uniform);
        let uniform = uniform.map(|(handle, v)| (handle, v.binding, false));
        let storage = alone.storage.iter().map(|&(handle, binding)| (handle, Some(binding), true));
        let mut written: HashMap<Key, Handle<GlobalVariable>> = HashMap::new();
        for (handle, binding, stored) in uniform.chain(storage) {
            let name = name_of(self.module, handle);
            let ty = self.module.global_variables[handle].ty;
            let mut bytes = Vec::new();
            byte_offsets(self.module, ty, 0, &mut bytes);
            let place = Place { name: name.clone(), ty, at: PortAt::Global(handle) };
            let key = binding.map(|binding| self.own.key(binding));
            let Some((key, words)) = key.and_then(|key| Some((key, self.own.buffers.get(&key)?))) else {
                if name.contains(FIRST_INSTANCE) {
                    self.case.extend(bytes.iter().map(|_| Feed::Zero));
                    self.uniforms.push(place);
                    continue;
                }
                return Err(format!("it takes `{name}`, at whose binding the shader takes nothing"));
            };
            let feed = bytes.iter().map(|byte| words.get(byte).map_or(Feed::Padding, |(_, feed)| *feed));
            if stored {
                self.invocation.extend(feed);
                self.inputs.push(place);
                written.insert(key, handle);
            } else {
                self.case.extend(feed);
                self.uniforms.push(place);
            }
        }
        self.stored(&written)
    }

    /// What storage buffers hold in the end.
    fn stored(&mut self, written: &HashMap<Key, Handle<GlobalVariable>>) -> Result<(), String> {
        for &(own, binding) in &self.own.alone.storage {
            if !self.own.info.get_entry_point(0)[own].contains(GlobalUse::WRITE) {
                continue;
            }
            let name = name_of(&self.own.module, own);
            let own = self.own.module.global_variables[own].ty;
            let handle = *written.get(&self.own.key(binding)).ok_or_else(|| format!("it does not take `{name}`"))?;
            let ty = self.module.global_variables[handle].ty;
            let bytes = |module: &Module, ty| {
                let mut bytes = Vec::new();
                byte_offsets(module, ty, 0, &mut bytes);
                bytes
            };
            let words = bytes(self.module, ty);
            if words != bytes(&self.own.module, own) {
                return Err(format!("`{name}` has its members at other places there"));
            }
            let shape = Shape::vector(Scalar::U32, 1).array_of(u32::try_from(words.len()).unwrap_or(u32::MAX));
            self.fields.push(Field { name: name.clone(), shape });
            self.outputs.push(Place { name, ty, at: PortAt::Global(handle) });
        }
        Ok(())
    }

    fn discarded(&mut self, alone: &Alone) {
        if self.own.program.role == Role::Fragment {
            let ty = self.module.global_variables[alone.discarded].ty;
            let shape = Shape::vector(Scalar::U32, 1);
            self.fields.push(Field { name: DISCARD.to_owned(), shape });
            self.outputs.push(Place { name: DISCARD.to_owned(), ty, at: PortAt::Global(alone.discarded) });
        }
    }
}

/// The words of the program's invocation record that go in at each place.
fn fed(program: &Program) -> HashMap<At, Vec<u32>> {
    let mut all = HashMap::new();
    let Entry::Point(index) = program.entry else { return all };
    let arguments = &program.module.entry_points[index].function.arguments;
    let mut word = 0_u32;
    for port in &program.inputs {
        let words = u32::try_from(port.field.shape.words()).unwrap_or(0);
        let (first, count) = match port.at {
            PortAt::Argument(k) => (k, 1),
            PortAt::Arguments { first, count } => (first, count),
            _ => (0, 0),
        };
        for k in 0..count {
            let binding = arguments.get((first + k) as usize).and_then(|argument| argument.binding.as_ref());
            let Some(binding) = binding else { continue };
            let each = words / count.max(1);
            all.insert(At::of(binding), (word + k * each..word + (k + 1) * each).collect());
        }
        word += words;
    }
    all
}

/// The words of the program's case record by the bytes at which a host puts them.
fn uniforms(program: &Program) -> Result<HashMap<(ResourceBinding, u32), u32>, String> {
    let module = &program.module;
    let mut fed = HashMap::new();
    let mut word = 0;
    for port in &program.uniforms {
        let (global, path): (_, &[u32]) = match &port.at {
            PortAt::Global(global) => (*global, &[]),
            PortAt::Member(global, member) => (*global, std::slice::from_ref(member)),
            PortAt::Part { global, path } => (*global, path),
            at => return Err(format!("`{}` lies at {at:?}", port.field.name)),
        };
        let (mut start, mut ty) = (0, module.global_variables[global].ty);
        for &k in path {
            (start, ty) = match &module.types[ty].inner {
                TypeInner::Struct { members, .. } => (start + members[k as usize].offset, members[k as usize].ty),
                TypeInner::Array { base, stride, .. } => (start + k * stride, *base),
                _ => return Err(format!("`{}` lies in no block", port.field.name)),
            };
        }
        let binding = module.global_variables[global].binding;
        let binding = binding.ok_or_else(|| format!("`{}` has no binding", port.field.name))?;
        let mut bytes = Vec::new();
        byte_offsets(module, port.ty, start, &mut bytes);
        for byte in bytes {
            fed.insert((binding, byte), word);
            word += 1;
        }
    }
    Ok(fed)
}

fn name_of(module: &Module, handle: Handle<GlobalVariable>) -> String {
    let variable = &module.global_variables[handle];
    let member = || match &module.types[variable.ty].inner {
        TypeInner::Struct { members, .. } => members.first().and_then(|member| member.name.clone()),
        _ => None,
    };
    variable.name.clone().or_else(member).unwrap_or_else(|| "a buffer".to_owned())
}

fn same_shape(name: &str, own: &Module, ty: Handle<Type>, there: &Module, other: Handle<Type>) -> Result<(), String> {
    let shape = shape_of(own, ty);
    if shape_of(there, other) == shape {
        return Ok(());
    }
    let reported = shape.map_or_else(|| "of another type".to_owned(), |shape| format!("`{shape}`"));
    Err(format!("`{name}` is {reported} in the shader and of another type there"))
}

/// Where an entry point gives what goes out there.
fn result(module: &Module, function: &Function, at: At) -> Option<(Handle<Type>, PortAt)> {
    let result = function.result.as_ref()?;
    let fits = |binding: &Option<Binding>| binding.as_ref().is_some_and(|here| At::of(here) == at);
    if fits(&result.binding) {
        return Some((result.ty, PortAt::Result));
    }
    let TypeInner::Struct { members, .. } = &module.types[result.ty].inner else { return None };
    let k = members.iter().position(|member| fits(&member.binding))?;
    Some((members[k].ty, PortAt::ResultMember(u32::try_from(k).ok()?)))
}
