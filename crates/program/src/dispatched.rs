//! A compute stage as one whole dispatch: what its buffers hold before goes in, and what they hold behind it comes out.
//!
//! The number of workgroups and the lengths of the buffers are fixed. All invocations then make one pointwise program,
//! from the words of all buffers to the words of those that are written, which is judged like any other.

use std::num::NonZeroU32;
use std::sync::Arc;

use naga::valid::{Capabilities, GlobalUse, ModuleInfo, ValidationFlags, Validator};
use naga::{
    AddressSpace, ArraySize, Expression, Function, Handle, Literal, Module, Span, StructMember, Type, TypeInner,
};

use super::memory::{inside, without_atomics};
use super::{Entry, Port, PortAt, Program, ProgramError, Written};
use crate::contain::contain;
use crate::read::{Elements, parts_of};
use base::value::Field;

/// Bytes of a buffer at most.
const MOST_BYTES: u64 = 1 << 26;

/// Structures of an array that are fed one by one.
const MOST_ELEMENTS: u32 = 1 << 12;

/// How a stage is dispatched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dispatch {
    /// Workgroups along x, y and z.
    pub groups: [u32; 3],
    /// Elements of the arrays that are as long as their buffers, by the name of the buffer.
    pub lengths: Vec<(String, u32)>,
}

/// The module of the author's, and how it is dispatched.
#[derive(Clone, Debug)]
pub struct Dispatched {
    /// Workgroups along x, y and z.
    pub groups: [u32; 3],
    /// The module before its buffers got lengths, with what the validator found out about it.
    pub host: Arc<(Module, ModuleInfo)>,
    /// Its buffers hold so much that its invocations are run side by side, and what is known of a word goes with the word,
    /// in place of one program whose code is written for each invocation.
    pub large: bool,
}

/// Words of all buffers from which on a dispatch is large. Below, bounds are as tight as for any other program, and a failure
/// is shrunk; the work grows with the product of invocations and outputs.
const LARGE: usize = 1 << 12;

/// A storage buffer that a dispatch takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostBuffer {
    /// The author's name.
    pub name: String,
    /// True for one that is as long as its host makes it.
    pub open: bool,
    /// True where the stage reads what it holds.
    pub read: bool,
    /// Number of its variable, as of [`Port::global`].
    pub global: usize,
}

impl Port {
    /// For a value that lies in a global variable, the number of that variable in its module.
    pub fn global(&self) -> Option<usize> {
        match self.at {
            PortAt::Global(global) | PortAt::Member(global, _) | PortAt::Part { global, .. } => Some(global.index()),
            PortAt::Argument(_)
            | PortAt::Reference(_)
            | PortAt::Arguments { .. }
            | PortAt::Result
            | PortAt::ResultMember(_)
            | PortAt::Vertices { .. } => None,
        }
    }
}

impl Program {
    /// The storage buffers that a dispatch takes, in order.
    pub fn buffers(&self) -> Vec<HostBuffer> {
        let of = |memory: &super::memory::Memory| HostBuffer {
            name: self.buffer_name(memory),
            open: memory.open,
            read: match self.entry {
                Entry::Point(point) => self.info.get_entry_point(point)[memory.global].contains(GlobalUse::READ),
                Entry::Function(_) => true,
            },
            global: memory.global.index(),
        };
        self.memory.iter().map(of).collect()
    }

    /// The author's name of a buffer: of a block of GLSL without a name for its members, that of the array at its end.
    fn buffer_name(&self, memory: &super::memory::Memory) -> String {
        let variable = &self.module.global_variables[memory.global];
        let last = self.bare_members(memory).filter(|_| memory.open).and_then(|members| members.last());
        last.and_then(|member| member.name.clone()).or_else(|| variable.name.clone()).unwrap_or_default()
    }

    /// Members of a block of GLSL that its author uses without a name before them.
    fn bare_members(&self, memory: &super::memory::Memory) -> Option<&[StructMember]> {
        let variable = &self.module.global_variables[memory.global];
        let ty = &self.module.types[variable.ty];
        // The type of a block with atomic members has a name of its own.
        let block = ty.name.as_deref().map(|name| name.strip_suffix("_atomic").unwrap_or(name));
        let bare = self.written == Written::Glsl && (variable.name.is_none() || variable.name.as_deref() == block);
        match &ty.inner {
            TypeInner::Struct { members, .. } if bare => Some(members),
            _ => None,
        }
    }

    /// The program as one whole dispatch.
    ///
    /// # Errors
    /// [`ProgramError::Unsupported`] for what is no compute stage, a buffer without a length or with one too many, and what
    /// cannot be fed; [`ProgramError::Internal`] for a module that does not come out valid.
    pub fn dispatched(mut self, dispatch: &Dispatch) -> Result<Self, ProgramError> {
        let refuse = |what: String| Err(ProgramError::Unsupported { what });
        let (Entry::Point(_), Some(_)) = (self.entry, self.workgroup_size()) else {
            return refuse("a dispatch of what is no compute stage".to_owned());
        };
        if dispatch.groups.contains(&0) {
            return refuse("a dispatch without workgroups, which does nothing".to_owned());
        }
        self.inputs.clear();
        self.built_ins.clear();
        let names = self.buffers();
        let open: Vec<&str> = names.iter().filter(|buffer| buffer.open).map(|buffer| &buffer.name[..]).collect();
        if let Some((name, _)) = dispatch.lengths.iter().find(|(name, _)| !open.contains(&&name[..])) {
            let of = if open.is_empty() { "none is".to_owned() } else { format!("these are: {}", open.join(", ")) };
            return refuse(format!(
                "a length of `{name}`, which is no buffer that is as long as its host makes it; {of}"
            ));
        }
        let host = Arc::new((self.module.clone(), self.info.clone()));
        let mut module = self.module.clone();
        for (memory, HostBuffer { name, open, .. }) in std::mem::take(&mut self.memory).into_iter().zip(names) {
            let len = match dispatch.lengths.iter().find(|(of, _)| *of == name) {
                Some(&(_, len)) => len,
                None if open => {
                    let how = format!("lengths = {{ {name} = 64 }}");
                    return refuse(format!(
                        "the buffer `{name}` without a length; say how many elements it has: {how}"
                    ));
                }
                None => 1,
            };
            let Some(len) = NonZeroU32::new(len) else {
                return refuse(format!("the buffer `{name}` without an element: a binding holds one at least"));
            };
            let stride = stride(&module, module.global_variables[memory.global].ty).unwrap_or(0);
            let bytes = u64::from(stride) * u64::from(len.get());
            if bytes > MOST_BYTES {
                return refuse(format!(
                    "the buffer `{name}` of {bytes} bytes; {MOST_BYTES} at most are judged: take a smaller size, at which \
                     a kernel goes wrong alike"
                ));
            }
            let bare = self.bare_members(&memory).is_some();
            let ty = sized(&mut module, self.module.global_variables[memory.global].ty, len);
            module.global_variables[memory.global].ty = ty;
            let (mut found, mut unfed) = (Vec::new(), Vec::new());
            parts_of(&module, ty, (&name, &[]), Elements::AtMost(MOST_ELEMENTS), (&mut found, &mut unfed));
            if let Some(what) = unfed.first() {
                return refuse(format!("{what} in a buffer"));
            }
            for part in found {
                let inner = part.path.iter().fold(ty, |ty, &k| inside(&mut module, ty, k));
                let at = match part.path[..] {
                    [] => PortAt::Global(memory.global),
                    _ => PortAt::Part { global: memory.global, path: part.path.clone() },
                };
                let own = part.name.strip_prefix(&name).and_then(|rest| rest.strip_prefix('.')).filter(|_| bare);
                let field = Field { name: own.map_or(part.name.clone(), str::to_owned), shape: part.shape };
                let port = Port { field, ty: inner, at, backing: None };
                self.inputs.push(port.clone());
                if memory.written {
                    self.outputs.push(port);
                }
            }
        }
        let workgroup: Vec<_> = module
            .global_variables
            .iter()
            .filter(|(_, v)| v.space == AddressSpace::WorkGroup)
            .map(|(h, _)| h)
            .collect();
        for global in workgroup {
            let ty = sized(&mut module, self.module.global_variables[global].ty, NonZeroU32::MIN);
            module.global_variables[global].ty = ty;
        }
        let shape = module.clone();
        for (_, function) in module.functions.iter_mut() {
            settle(&shape, function)?;
        }
        for point in &mut module.entry_points {
            settle(&shape, &mut point.function)?;
        }
        // Invocations of a subgroup see each other's values: they go side by side.
        let subgroups = super::memory::uses_subgroups(&module);
        self.info = checked(&module)?;
        self.module = module;
        self.instrumented = true;
        let words: usize =
            [&self.inputs, &self.outputs].into_iter().flatten().map(|port| port.field.shape.words()).sum();
        self.dispatch =
            Some(Arc::new(Dispatched { groups: dispatch.groups, host, large: words >= LARGE || subgroups }));
        Ok(self)
    }

    /// True for a dispatch whose invocations are run side by side: see [`Dispatched::large`].
    pub fn is_large(&self) -> bool {
        self.dispatch.as_ref().is_some_and(|dispatch| dispatch.large)
    }

    /// A dispatch that is compared with a large one, or with one that is not, is run in the same way.
    #[must_use]
    pub fn run_as(mut self, other: &Self) -> Self {
        if let Some(dispatch) = &mut self.dispatch {
            Arc::make_mut(dispatch).large = other.is_large();
        }
        self
    }
}

/// Types of a module in which numbers stand in places where lengths are told: the rules about places do not matter here.
fn checked(module: &Module) -> Result<ModuleInfo, ProgramError> {
    let mut validator = Validator::new(ValidationFlags::empty(), Capabilities::all());
    contain(|| validator.validate(module).map_err(Box::new))
        .map_err(|panic| ProgramError::internal(format!("naga panicked: {panic}")))?
        .map_err(|error| ProgramError::internal(format!("{:?}", error.into_inner())))
}

/// Bytes from one element to the next of the array that is as long as its buffer.
fn stride(module: &Module, ty: Handle<Type>) -> Option<u32> {
    match &module.types[ty].inner {
        TypeInner::Array { size: ArraySize::Dynamic, stride, .. } => Some(*stride),
        TypeInner::Struct { members, .. } => stride(module, members.last()?.ty),
        _ => None,
    }
}

/// The type without atomic numbers, and with so many elements where it has an open end.
fn sized(module: &mut Module, ty: Handle<Type>, len: NonZeroU32) -> Handle<Type> {
    let old = module.types[ty].clone();
    let inner = match old.inner {
        TypeInner::Atomic(scalar) => {
            return module.types.insert(Type { name: None, inner: TypeInner::Scalar(scalar) }, Span::UNDEFINED);
        }
        TypeInner::Array { base, size, stride } => {
            let size = if size == ArraySize::Dynamic { ArraySize::Constant(len) } else { size };
            TypeInner::Array { base: sized(module, base, len), size, stride }
        }
        TypeInner::Struct { members, span } => {
            let mut end = span;
            let mut changed = Vec::new();
            for member in &members {
                let ty = sized(module, member.ty, len);
                end = end.max(member.offset + module.types[ty].inner.size(module.to_ctx()));
                changed.push(StructMember { ty, ..member.clone() });
            }
            // Values of the type keep it.
            if changed.iter().zip(&members).all(|(new, old)| new.ty == old.ty) {
                return ty;
            }
            TypeInner::Struct { members: changed, span: if end > span { end.next_multiple_of(16) } else { span } }
        }
        _ => return ty,
    };
    module.types.insert(Type { name: old.name, inner }, Span::UNDEFINED)
}

/// Where a part lies in its variable, in bytes.
pub(crate) fn offset(module: &Module, mut ty: Handle<Type>, path: &[u32]) -> u32 {
    let mut at = 0;
    for &index in path {
        match &module.types[ty].inner {
            TypeInner::Struct { members, .. } => {
                let Some(member) = members.get(index as usize) else { return at };
                (at, ty) = (at + member.offset, member.ty);
            }
            TypeInner::Array { base, stride, .. } => (at, ty) = (at + index * stride, *base),
            _ => return at,
        }
    }
    at
}

/// Places of the scalars of a value in bytes, in the order of its words.
pub(crate) fn places(module: &Module, ty: Handle<Type>, at: u32, all: &mut Vec<u32>) {
    match module.types[ty].inner {
        TypeInner::Vector { size, scalar } => {
            all.extend((0..size as u32).map(|k| at + u32::from(scalar.width) * k));
        }
        TypeInner::Matrix { columns, rows, scalar } => {
            let width = u32::from(scalar.width);
            let stride = if rows == naga::VectorSize::Bi { 2 * width } else { 4 * width };
            for column in 0..columns as u32 {
                all.extend((0..rows as u32).map(|row| at + stride * column + width * row));
            }
        }
        TypeInner::Array { base, size: ArraySize::Constant(len), stride } => {
            (0..len.get()).for_each(|k| places(module, base, at + k * stride, all));
        }
        TypeInner::Struct { ref members, .. } => {
            members.iter().for_each(|member| places(module, member.ty, at + member.offset, all));
        }
        _ => all.push(at),
    }
}

/// Lengths become numbers, and atomic functions ordinary ones: one invocation runs after the other.
fn settle(module: &Module, function: &mut Function) -> Result<(), ProgramError> {
    let questions: Vec<(Handle<Expression>, Handle<Expression>)> = function
        .expressions
        .iter()
        .filter_map(|(handle, e)| match e {
            Expression::ArrayLength(array) => Some((handle, *array)),
            _ => None,
        })
        .collect();
    for (handle, array) in questions {
        let len = length(module, function, array).ok_or_else(|| ProgramError::Unsupported {
            what: "a dispatch of a shader that asks for the length of a buffer which it got by a pointer".to_owned(),
        })?;
        function.expressions[handle] = Expression::Literal(Literal::U32(len));
    }
    without_atomics(function)
}

/// Elements of the array that an expression points to.
fn length(module: &Module, function: &Function, mut at: Handle<Expression>) -> Option<u32> {
    let mut path = Vec::new();
    let mut ty = loop {
        match function.expressions[at] {
            Expression::AccessIndex { base, index } => {
                path.push(index);
                at = base;
            }
            Expression::GlobalVariable(global) => break module.global_variables[global].ty,
            _ => return None,
        }
    };
    for &index in path.iter().rev() {
        let TypeInner::Struct { members, .. } = &module.types[ty].inner else { return None };
        ty = members.get(index as usize)?.ty;
    }
    match module.types[ty].inner {
        TypeInner::Array { size: ArraySize::Constant(len), .. } => Some(len.get()),
        _ => None,
    }
}
