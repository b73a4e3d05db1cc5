//! The interface of what is chosen: what goes in and comes out, and what the harness binds.

use std::sync::Arc;

use naga::{AddressSpace, Binding, BuiltIn, GlobalVariable, Handle, Module, ResourceBinding, Type, TypeInner};

use super::ModuleText;
use super::sampled;
use super::wgsl::span_in;
use crate::capture::{binding, shape_of};
use crate::front::UNSUPPORTED;
use crate::memory::{LENGTH, Memory};
use crate::texture::{Image, Texture, TextureKind};
use crate::{Port, PortAt};
use base::diagnostic::{Diagnostic, Severity};
use base::text::Span;
use base::value::{Field, Shape};

/// Elements of an array that are taken apart.
const MOST_ELEMENTS: u32 = 64;

/// What becomes of arrays of structures that are long.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Elements {
    /// One of more elements is not taken apart.
    AtMost(u32),
    /// Of one of more elements some come first, and the others are left as they are.
    First(u32),
}

/// Elements of a long array that are inputs: each is a few numbers of every record.
const FIRST_ELEMENTS: u32 = 16;

impl Elements {
    /// How many of `n` elements are taken apart; none where the array is too long.
    pub(crate) fn of(self, n: u32) -> Option<u32> {
        match self {
            Self::AtMost(most) => (n <= most).then_some(n),
            Self::First(most) => Some(if n <= most { n } else { FIRST_ELEMENTS }),
        }
    }
}

/// A part of a value that is fed or read word by word.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub name: String,
    pub path: Vec<u32>,
    pub ty: Handle<Type>,
    pub shape: Shape,
}

/// The interface while it is collected.
pub(super) struct Ports<'t> {
    pub text: &'t ModuleText,
    pub uniforms: Vec<Port>,
    pub memory: Vec<Memory>,
    pub textures: Vec<Texture>,
    pub unfed: Vec<Diagnostic>,
}

/// The largest parts of a value that have a shape; what has none is named in `unfed`.
pub(crate) fn parts(
    module: &Module,
    ty: Handle<Type>,
    (name, path): (&str, &[u32]),
    found: &mut Vec<Part>,
    unfed: &mut Vec<String>,
) {
    parts_of(module, ty, (name, path), Elements::AtMost(MOST_ELEMENTS), (found, unfed));
}

/// The same, with so many structures of an array.
pub(crate) fn parts_of(
    module: &Module,
    ty: Handle<Type>,
    (name, path): (&str, &[u32]),
    most: Elements,
    (found, unfed): (&mut Vec<Part>, &mut Vec<String>),
) {
    if let Some(shape) = shape_of(module, ty) {
        found.push(Part { name: name.to_owned(), path: path.to_vec(), ty, shape });
        return;
    }
    let step = |k: u32| [path, &[k]].concat();
    match &module.types[ty].inner {
        // What slangc puts around an array.
        TypeInner::Struct { members, .. } if is_wrapper(module, ty) && members.len() == 1 => {
            parts_of(module, members[0].ty, (name, &step(0)), most, (found, unfed));
        }
        TypeInner::Struct { members, .. } => {
            for (k, member) in (0..).zip(members) {
                let own = member.name.clone().unwrap_or_else(|| k.to_string());
                let name = if name.is_empty() { own } else { format!("{name}.{own}") };
                parts_of(module, member.ty, (&name, &step(k)), most, (found, unfed));
            }
        }
        TypeInner::Array { base, size: naga::ArraySize::Constant(n), .. } if most.of(n.get()).is_some() => {
            for k in 0..most.of(n.get()).unwrap_or(0) {
                parts_of(module, *base, (&format!("{name}[{k}]"), &step(k)), most, (found, unfed));
            }
        }
        // As long as its buffer: as many elements as it gets here.
        TypeInner::Array { base, size: naga::ArraySize::Dynamic, .. } => {
            let shape = shape_of(module, *base).filter(|shape| shape.array.is_none());
            if let Some(shape) = shape {
                let shape = shape.array_of(LENGTH);
                found.push(Part { name: name.to_owned(), path: path.to_vec(), ty, shape });
                return;
            }
            for k in 0..LENGTH {
                parts_of(module, *base, (&format!("{name}[{k}]"), &step(k)), most, (found, unfed));
            }
        }
        TypeInner::Atomic(scalar) => {
            let plain = module.types.get(&Type { name: None, inner: TypeInner::Scalar(*scalar) });
            match plain.and_then(|plain| shape_of(module, plain)) {
                Some(shape) => found.push(Part { name: name.to_owned(), path: path.to_vec(), ty, shape }),
                None => unfed.push(format!("`{name}`, an atomic number,")),
            }
        }
        inner => unfed.push(format!("`{name}`, {}", described(module, ty, inner, most))),
    }
}

/// True for the structure that slangc puts around an array of a buffer.
fn is_wrapper(module: &Module, ty: Handle<Type>) -> bool {
    module.types[ty].name.as_deref().is_some_and(|name| name.starts_with("_Array_std"))
}

/// A type that is not fed, in words.
fn described(module: &Module, ty: Handle<Type>, inner: &TypeInner, most: Elements) -> String {
    let named = module.types[ty].name.as_ref().map_or_else(String::new, |name| format!(" `{name}`"));
    match inner {
        TypeInner::Scalar(scalar) | TypeInner::Vector { scalar, .. } | TypeInner::Matrix { scalar, .. } => {
            format!("whose numbers have {} bits,", 8 * u32::from(scalar.width))
        }
        TypeInner::Array { .. } => {
            let (Elements::AtMost(most) | Elements::First(most)) = most;
            format!("an array of more than {most} elements,")
        }
        TypeInner::Struct { .. } => format!("a structure{named},"),
        TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. } => "a pointer,".to_owned(),
        TypeInner::Image { .. } => "a texture,".to_owned(),
        TypeInner::Sampler { .. } => "a sampler,".to_owned(),
        TypeInner::BindingArray { .. } => "an array of bindings,".to_owned(),
        _ => format!("of a type{named} that has no numbers,"),
    }
}

/// Where a part of a variable lies.
pub(super) fn at(module: &Module, global: Handle<GlobalVariable>, path: &[u32]) -> PortAt {
    let whole = &module.types[module.global_variables[global].ty].inner;
    match *path {
        [] => PortAt::Global(global),
        [index] if matches!(whole, TypeInner::Struct { .. }) => PortAt::Member(global, index),
        _ => PortAt::Part { global, path: path.to_vec() },
    }
}

impl Ports<'_> {
    /// Says that something cannot be fed or read.
    pub(super) fn not_fed(&mut self, what: &str, span: Span) {
        let help = "it can be translated; to run it, pass numbers, vectors, matrices and arrays of them";
        let message = format!("{what} cannot be fed or read");
        let found = Diagnostic::new(UNSUPPORTED, Severity::Error, self.text.file(), span, message).with_help(help);
        self.unfed.push(found.at_origin());
    }

    /// Resources: uniforms, storage, textures and samplers. Images and samplers of the module get the bindings that a
    /// kernel hands on.
    pub(super) fn resources(&mut self, module: &mut Module) {
        let all: Vec<Handle<GlobalVariable>> = module.global_variables.iter().map(|(handle, _)| handle).collect();
        // Buffers of the author's may lie in that group as well.
        let taken = module.global_variables.iter().filter(|(_, v)| v.space != AddressSpace::Handle);
        let taken = taken.filter_map(|(_, v)| v.binding.filter(|b| b.group == binding::TEXTURES));
        let mut next = taken.map(|b| b.binding + 1).max().unwrap_or(0);
        for &handle in &all {
            let variable = module.global_variables[handle].clone();
            let name = variable.name.clone().unwrap_or_else(|| "a variable".to_owned());
            let span = span_in(self.text.file(), module.global_variables.get_span(handle)).unwrap_or_default();
            let (mut found, mut unfed) = (Vec::new(), Vec::new());
            match variable.space {
                AddressSpace::Uniform => {
                    // A host that fills fewer elements leaves zeros.
                    let most = Elements::First(MOST_ELEMENTS);
                    parts_of(module, variable.ty, (&name, &[]), most, (&mut found, &mut unfed));
                    for part in found {
                        let field = Field { name: part.name, shape: part.shape };
                        let at = at(module, handle, &part.path);
                        self.uniforms.push(Port { field, ty: part.ty, at, backing: None });
                    }
                    unfed.iter().for_each(|what| self.not_fed(what, span));
                }
                AddressSpace::Storage { access } => {
                    parts(module, variable.ty, (&name, &[]), &mut found, &mut unfed);
                    let message = format!("`{name}`, storage that is read or written by index, cannot be fed or read");
                    let told = Diagnostic::new(UNSUPPORTED, Severity::Error, self.text.file(), span, message);
                    let help = "it can be translated; a stage whose invocations need no other can be run";
                    self.memory.push(Memory {
                        global: handle,
                        parts: found.into_iter().map(|part| (part.name, part.path, part.shape)).collect(),
                        written: access.contains(naga::StorageAccess::STORE),
                        diagnostic: told.with_help(help).at_origin(),
                        partial: !unfed.is_empty(),
                        open: module.types[variable.ty].inner.is_dynamically_sized(&module.types),
                    });
                }
                AddressSpace::Handle => {
                    let place = ResourceBinding { group: binding::TEXTURES, binding: next };
                    next += 1;
                    module.global_variables[handle].binding = Some(place);
                    self.texture(module, handle, &name, span);
                }
                AddressSpace::Immediate => self.not_fed(&format!("`{name}`, immediate data,"), span),
                AddressSpace::TaskPayload | AddressSpace::RayPayload | AddressSpace::IncomingRayPayload => {
                    self.not_fed(&format!("`{name}`, a payload,"), span);
                }
                AddressSpace::Private | AddressSpace::Function | AddressSpace::WorkGroup => {}
            }
        }
        self.samplers(module, &all);
    }

    fn texture(&mut self, module: &Module, handle: Handle<GlobalVariable>, name: &str, span: Span) {
        match module.types[module.global_variables[handle].ty].inner {
            TypeInner::Image { dim, arrayed, class } => match TextureKind::of(dim, arrayed, class) {
                Some(kind) => {
                    let contents = Arc::new(Image::procedural(name, kind));
                    self.textures.push(Texture { name: name.to_owned(), kind, image: handle, sampler: None, contents });
                }
                None => self.not_fed(&format!("`{name}`, a texture of a kind that is not supplied,"), span),
            },
            TypeInner::Sampler { .. } => {}
            _ => self.not_fed(&format!("`{name}`"), span),
        }
    }

    /// Each sampler goes with an image that it samples; the lane binds both. An image that is sampled in several ways
    /// stands in the list once for each of its samplers.
    fn samplers(&mut self, module: &Module, all: &[Handle<GlobalVariable>]) {
        let is_sampler = |handle: &&Handle<GlobalVariable>| {
            matches!(module.types[module.global_variables[**handle].ty].inner, TypeInner::Sampler { .. })
        };
        let pairs = sampled::pairs(module);
        for &sampler in all.iter().filter(is_sampler) {
            let mut images = pairs.iter().filter(|(_, by)| *by == Some(sampler)).map(|(image, _)| *image);
            let free = images
                .find(|image| self.textures.iter().any(|texture| texture.image == *image && texture.sampler.is_none()));
            let first = pairs.iter().find(|(_, by)| *by == Some(sampler)).map(|(image, _)| *image);
            if let Some(image) = free {
                let texture = self.textures.iter_mut().find(|texture| texture.image == image);
                texture.into_iter().for_each(|texture| texture.sampler = Some(sampler));
            } else if let Some(texture) = first.and_then(|image| self.textures.iter().find(|t| t.image == image)) {
                let again = Texture { sampler: Some(sampler), ..texture.clone() };
                self.textures.push(again);
            }
        }
    }
}

/// A built-in value that is an input of its stage, other than a number of the draw.
pub(super) fn is_fed(binding: &Binding) -> bool {
    matches!(
        binding,
        Binding::Location { .. }
            | Binding::BuiltIn(
                BuiltIn::Position { .. } | BuiltIn::FrontFacing | BuiltIn::PointCoord | BuiltIn::Barycentric { .. }
            )
    )
}

/// The largest value that is tried of a number of the draw where nothing is stated, before arrays bound it. Each value
/// comes up many times in a run.
pub(super) fn most(built_in: BuiltIn) -> Option<u32> {
    Some(match built_in {
        BuiltIn::VertexIndex | BuiltIn::BaseVertex | BuiltIn::BaseInstance | BuiltIn::PrimitiveIndex => 1023,
        BuiltIn::InstanceIndex | BuiltIn::DrawIndex => 63,
        BuiltIn::SampleIndex => 3,
        BuiltIn::SampleMask => 15,
        BuiltIn::ViewIndex => 7,
        _ => return None,
    })
}
