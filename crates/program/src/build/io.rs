//! What goes in and comes out: locations, and the ports through which the harness feeds and reads.

use std::sync::Arc;

use naga::{Binding, FunctionArgument, GlobalVariable, Handle, Interpolation, Sampling, ScalarKind, TypeInner};

use super::types::has_data;
use super::{Build, Result};
use crate::UNSUPPORTED;
use crate::memory::{LENGTH, Memory};
use crate::read::Elements;
use crate::{Port, PortAt};
use base::diagnostic::{Diagnostic, Severity};
use base::text::Span;
use base::value::Field;
use syntax::Stage;
use syntax::ast::{AuxiliaryQualifier, Interpolation as Written, MemoryQualifier, QualifierKind, Qualifiers};
use syntax::interface::{self, Storage};
use syntax::types::{ArraySize, ScalarType, Type};

/// An argument of the entry point, and where it is kept.
#[derive(Clone, Debug)]
pub(super) struct Incoming {
    pub argument: FunctionArgument,
    pub to: Handle<GlobalVariable>,
    pub path: Vec<u32>,
    /// Type of the part of the variable that it fills.
    pub ty: Type,
}

/// A member of what the entry point returns, and where it comes from.
#[derive(Clone, Debug)]
pub(super) struct Outgoing {
    pub name: String,
    pub binding: Binding,
    pub from: Handle<GlobalVariable>,
    pub path: Vec<u32>,
    /// Type of the part of the variable that is handed on.
    pub ty: Type,
}

/// A value that the harness feeds or reads word by word.
pub(super) struct PortPart {
    pub name: String,
    pub path: Vec<u32>,
    pub ty: Type,
}

/// Locations that are taken.
#[derive(Clone, Debug, Default)]
pub(super) struct Locations {
    taken: Vec<u32>,
}

impl Locations {
    fn take(&mut self, count: u32) -> u32 {
        let mut first = 0;
        while (first..first + count).any(|l| self.taken.contains(&l)) {
            first += 1;
        }
        self.reserve(first, count);
        first
    }

    fn reserve(&mut self, first: u32, count: u32) {
        self.taken.extend(first..first.saturating_add(count));
    }
}

/// Vectors and numbers inside of a value, with the way to each.
pub(super) fn leaves(ty: &Type) -> Vec<(Vec<u32>, Type)> {
    let children: Vec<Type> = match ty {
        Type::Matrix(s, columns, rows) => vec![Type::Vector(*s, *rows); usize::from(*columns)],
        Type::Array(element, ArraySize::Known(n)) => vec![element.as_ref().clone(); *n as usize],
        Type::Struct(s) => s.fields.iter().filter(|f| has_data(&f.ty)).map(|f| f.ty.clone()).collect(),
        _ => return vec![(Vec::new(), ty.clone())],
    };
    let mut all = Vec::new();
    for (k, child) in children.iter().enumerate() {
        for (mut path, ty) in leaves(child) {
            path.insert(0, u32::try_from(k).unwrap_or(0));
            all.push((path, ty));
        }
    }
    all
}

/// True for memory as long as its buffer.
fn is_open(module: &naga::Module, ty: Handle<naga::Type>) -> bool {
    match &module.types[ty].inner {
        TypeInner::Array { size: naga::ArraySize::Dynamic, .. } => true,
        TypeInner::Struct { members, .. } => members.last().is_some_and(|m| is_open(module, m.ty)),
        _ => false,
    }
}

/// The type with some elements where it has an open end.
fn closed(ty: &Type) -> Type {
    match ty {
        Type::Array(element, ArraySize::Unsized) => closed(element).array(LENGTH),
        Type::Array(element, size) => Type::Array(Arc::new(closed(element)), *size),
        Type::Struct(s) => {
            let mut s = s.as_ref().clone();
            for field in &mut s.fields {
                field.ty = closed(&field.ty);
            }
            Type::Struct(Arc::new(s))
        }
        _ => ty.clone(),
    }
}

/// Structures of an array that are taken apart.
const MOST_ELEMENTS: u32 = 64;

/// The largest parts of a value that are fed word by word; others are named in `unfed`.
pub(super) fn parts(name: &str, ty: &Type, path: &[u32], found: &mut Vec<PortPart>, unfed: &mut Vec<String>) {
    parts_of((name, ty), path, Elements::AtMost(MOST_ELEMENTS), (found, unfed));
}

fn parts_of(
    (name, ty): (&str, &Type),
    path: &[u32],
    most: Elements,
    (found, unfed): (&mut Vec<PortPart>, &mut Vec<String>),
) {
    if ty.shape().is_some() {
        found.push(PortPart { name: name.to_owned(), path: path.to_vec(), ty: ty.clone() });
        return;
    }
    let step = |k: usize| [path, &[u32::try_from(k).unwrap_or(0)]].concat();
    match ty {
        Type::Struct(s) => {
            for (k, field) in s.fields.iter().filter(|f| has_data(&f.ty)).enumerate() {
                let name = if name.is_empty() { field.name.clone() } else { format!("{name}.{}", field.name) };
                parts_of((&name, &field.ty), &step(k), most, (found, unfed));
            }
        }
        Type::Array(element, ArraySize::Known(n)) if most.of(*n).is_some() => {
            for k in 0..most.of(*n).unwrap_or(0) as usize {
                parts_of((&format!("{name}[{k}]"), element), &step(k), most, (found, unfed));
            }
        }
        _ => unfed.push(format!("`{name}` of type `{ty}`")),
    }
}

fn interpolation(qualifiers: &[&Qualifiers], ty: &Type) -> (Option<Interpolation>, Option<Sampling>) {
    let written = qualifiers.iter().rev().find_map(|q| q.interpolation());
    if ty.scalar() != Some(ScalarType::Float) || matches!(written, Some((Written::Flat, _))) {
        return (Some(Interpolation::Flat), None);
    }
    let kind = match written {
        Some((Written::NoPerspective, _)) => Interpolation::Linear,
        _ => Interpolation::Perspective,
    };
    let has = |q| qualifiers.iter().any(|all| all.list.iter().any(|k| k.kind == QualifierKind::Auxiliary(q)));
    let sampling = if has(AuxiliaryQualifier::Centroid) {
        Sampling::Centroid
    } else if has(AuxiliaryQualifier::Sample) {
        Sampling::Sample
    } else {
        Sampling::Center
    };
    (Some(kind), Some(sampling))
}

impl<'s> Build<'s> {
    pub(super) fn written(&self, qualifiers: &Qualifiers, key: &str) -> Option<u32> {
        let value = qualifiers.layout_entry(key)?.value?;
        u32::try_from(self.shader.fold(value)?.as_integer()?).ok()
    }

    pub(super) fn not_fed(&mut self, what: Vec<String>, span: Span) {
        self.ports.unfed.extend(what.into_iter().map(|what| (what, span)));
    }

    /// Keeps the locations that the text gives.
    pub(super) fn reserve_locations(&mut self) {
        self.shared_locations();
        let interface = self.shader.interface();
        for (variables, input) in [(&interface.inputs, true), (&interface.outputs, false)] {
            for v in variables {
                if let Some(first) = self.written(&v.qualifiers, "location") {
                    let count = u32::try_from(leaves(&v.ty).len()).unwrap_or(1);
                    if input { &mut self.ports.in_locations } else { &mut self.ports.out_locations }
                        .reserve(first, count);
                }
            }
        }
        for (index, block) in interface.blocks.iter().enumerate() {
            let ty = self.block_type(index).unwrap_or(Type::Error);
            let locations = match block.storage {
                Storage::In => &mut self.ports.in_locations,
                Storage::Out => &mut self.ports.out_locations,
                _ => continue,
            };
            let at = |q: &Qualifiers| {
                let value = q.layout_entry("location")?.value?;
                u32::try_from(self.shader.fold(value)?.as_integer()?).ok()
            };
            // Members count on from the block or the member before.
            let mut next = at(&block.qualifiers);
            let fields = match &ty {
                Type::Struct(s) => s.fields.as_slice(),
                _ => &[],
            };
            for (k, member) in block.members.iter().enumerate() {
                let ty = fields.get(k).map_or(&member.ty, |f| &f.ty);
                let count = u32::try_from(leaves(ty).len()).unwrap_or(1);
                let first = at(&member.qualifiers).or(next);
                next = first.map(|first| first + count);
                if let Some(first) = first {
                    locations.reserve(first, count);
                }
            }
        }
    }

    pub(super) fn location(&mut self, ty: &Type, first: u32, input: bool, qualifiers: &[&Qualifiers]) -> Binding {
        // Only what goes from one stage to the next is interpolated.
        let between = input == (self.shader.stage() == Stage::Fragment);
        let (interpolation, sampling) = if between { interpolation(qualifiers, ty) } else { (None, None) };
        Binding::Location { location: first, interpolation, sampling, blend_src: None, per_primitive: false }
    }

    /// An input with locations of its own.
    pub(super) fn located_input(
        &mut self,
        name: &str,
        ty: &Type,
        (handle, path): (Handle<GlobalVariable>, &[u32]),
        first: Option<u32>,
        qualifiers: &[&Qualifiers],
        span: Span,
    ) -> Result<()> {
        let leaves = leaves(ty);
        let count = u32::try_from(leaves.len()).unwrap_or(1);
        let first = first.unwrap_or_else(|| self.ports.in_locations.take(count));
        if self.is_shared(true, first, count) {
            let pieces = leaves.into_iter().map(|(inner, leaf)| ([path, &inner].concat(), leaf)).collect();
            self.share(true, handle, pieces, first, qualifiers, span)?;
            self.not_fed(vec![format!("`{name}`, which shares a location,")], span);
            return Ok(());
        }
        let start = u32::try_from(self.ports.incoming.len()).unwrap_or(0);
        for (k, (inner, leaf)) in leaves.into_iter().enumerate() {
            let binding = self.location(&leaf, first + u32::try_from(k).unwrap_or(0), true, qualifiers);
            let argument = FunctionArgument {
                name: Some(name.to_owned()),
                ty: self.value_type(&leaf, span)?,
                binding: Some(binding),
            };
            let path = [path, &inner].concat();
            self.ports.incoming.push(Incoming { argument, to: handle, path, ty: leaf });
        }
        let (mut found, mut unfed) = (Vec::new(), Vec::new());
        parts(name, ty, &[], &mut found, &mut unfed);
        let mut at = start;
        for part in found {
            let count = u32::try_from(self::leaves(&part.ty).len()).unwrap_or(1);
            // An array of one element is no number of its own.
            let whole = count == 1 && !matches!(part.ty, Type::Array(..));
            let place = if whole { PortAt::Argument(at) } else { PortAt::Arguments { first: at, count } };
            at += count;
            self.port_in(&part.name, &part.ty, place, span)?;
        }
        self.not_fed(unfed, span);
        Ok(())
    }

    pub(super) fn port_in(&mut self, name: &str, ty: &Type, at: PortAt, span: Span) -> Result<()> {
        if let Some(shape) = ty.shape() {
            let ty = self.value_type(ty, span)?;
            self.ports.inputs.push(Port { field: Field { name: name.to_owned(), shape }, ty, at, backing: None });
        }
        Ok(())
    }

    /// An output with locations of its own.
    pub(super) fn located_output(
        &mut self,
        name: &str,
        ty: &Type,
        (handle, path): (Handle<GlobalVariable>, &[u32]),
        first: Option<u32>,
        qualifiers: &[&Qualifiers],
        span: Span,
    ) -> Result<()> {
        let leaves = leaves(ty);
        let count = u32::try_from(leaves.len()).unwrap_or(1);
        let first = first.unwrap_or_else(|| self.ports.out_locations.take(count));
        if self.is_shared(false, first, count) {
            let pieces = leaves.into_iter().map(|(inner, leaf)| ([path, &inner].concat(), leaf)).collect();
            return self.share(false, handle, pieces, first, qualifiers, span);
        }
        for (k, (inner, leaf)) in leaves.into_iter().enumerate() {
            let mut binding = self.location(&leaf, first + u32::try_from(k).unwrap_or(0), false, qualifiers);
            if let (Binding::Location { blend_src, .. }, Some(index)) =
                (&mut binding, qualifiers.iter().find_map(|q| self.written(q, "index")))
            {
                *blend_src = Some(index);
            }
            let path = [path, &inner].concat();
            self.ports.outgoing.push(Outgoing { name: name.to_owned(), binding, from: handle, path, ty: leaf });
        }
        Ok(())
    }

    /// An output that is a built-in value.
    pub(super) fn built_in_output(
        &mut self,
        name: &str,
        ty: &Type,
        handle: Handle<GlobalVariable>,
        path: Vec<u32>,
        built_in: naga::BuiltIn,
    ) {
        let binding = Binding::BuiltIn(built_in);
        self.ports.outgoing.push(Outgoing { name: name.to_owned(), binding, from: handle, path, ty: ty.clone() });
    }

    /// Ports of an output variable.
    pub(super) fn port_out(
        &mut self,
        name: &str,
        ty: &Type,
        handle: Handle<GlobalVariable>,
        span: Span,
    ) -> Result<Vec<Port>> {
        let (mut found, mut unfed) = (Vec::new(), Vec::new());
        parts(name, ty, &[], &mut found, &mut unfed);
        let mut ports = Vec::new();
        for part in found {
            let Some(shape) = part.ty.shape() else { continue };
            let at = self.at(handle, &part.path);
            let ty = self.value_type(&part.ty, span)?;
            ports.push(Port { field: Field { name: part.name, shape }, ty, at, backing: None });
        }
        self.not_fed(unfed, span);
        Ok(ports)
    }

    fn at(&self, handle: Handle<GlobalVariable>, path: &[u32]) -> PortAt {
        match path {
            [] => PortAt::Global(handle),
            [index]
                if matches!(
                    self.module.types[self.module.global_variables[handle].ty].inner,
                    TypeInner::Struct { .. }
                ) =>
            {
                PortAt::Member(handle, *index)
            }
            _ => PortAt::Part { global: handle, path: path.to_vec() },
        }
    }

    /// Ports of a uniform, whose types are those of its memory.
    pub(super) fn uniform_ports(
        &mut self,
        handle: Handle<GlobalVariable>,
        host: Handle<naga::Type>,
        name: &str,
        ty: &Type,
        span: Span,
    ) {
        let (mut found, mut unfed) = (Vec::new(), Vec::new());
        // A host that fills fewer elements leaves zeros.
        parts_of((name, ty), &[], Elements::First(MOST_ELEMENTS), (&mut found, &mut unfed));
        for part in found {
            let Some(shape) = part.ty.shape() else { continue };
            let mut inner = host;
            for &k in &part.path {
                inner = match &self.module.types[inner].inner {
                    TypeInner::Struct { members, .. } => members[k as usize].ty,
                    _ => self.element(inner),
                };
            }
            let at = self.at(handle, &part.path);
            self.ports.uniforms.push(Port { field: Field { name: part.name, shape }, ty: inner, at, backing: None });
        }
        self.not_fed(unfed, span);
    }

    /// Ports of a storage block, for a run of one invocation. Arrays with an open end have some elements.
    pub(super) fn memory_of(&mut self, index: usize, global: Handle<GlobalVariable>, ty: &Type) {
        let block = &self.shader.interface().blocks[index];
        let prefix = block.instance.as_ref().map_or(String::new(), |i| i.name.clone());
        let read_only = QualifierKind::Memory(MemoryQualifier::ReadOnly);
        let written = !block.qualifiers.list.iter().any(|q| q.kind == read_only);
        self.memory_behind(&prefix, global, &closed(ty), written, block.name.span);
        if let (Type::Array(..), Some(last)) = (ty, self.ports.memory.last_mut()) {
            // Each is bound by itself.
            last.partial = true;
        }
    }

    /// Ports of a variable in memory.
    pub(super) fn memory_behind(
        &mut self,
        name: &str,
        global: Handle<GlobalVariable>,
        ty: &Type,
        written: bool,
        span: Span,
    ) {
        let (mut found, mut unfed) = (Vec::new(), Vec::new());
        parts(name, ty, &[], &mut found, &mut unfed);
        let shaped = |part: PortPart| part.ty.shape().map(|shape| (part.name, part.path, shape));
        let message = "memory that is written or read by index cannot be fed or read".to_owned();
        let reported = Diagnostic::new(UNSUPPORTED, Severity::Error, self.shader.file(), span, message);
        self.ports.memory.push(Memory {
            global,
            parts: found.into_iter().filter_map(shaped).collect(),
            written,
            partial: !unfed.is_empty(),
            open: is_open(&self.module, self.module.global_variables[global].ty),
            diagnostic: reported.with_help("it can be translated; a stage whose invocations need no other can be run"),
        });
    }

    pub(super) fn declare_input(&mut self, v: &'s interface::Variable) -> Result<()> {
        if v.name.starts_with("gl_") || self.made.globals.contains_key(&v.symbol) {
            return Ok(());
        }
        let mut ty = self.with_size(v.symbol, &self.with_dims(&v.ty, &self.dims_of(v)));
        if let Some(n) = self.vertices_of(Storage::In, &v.qualifiers) {
            ty = super::statement::with_length(&v.ty, n);
        }
        let handle = self.private(&v.name, &ty, v.name_span)?;
        self.ports.stage_inputs.push((v.name.clone(), handle, v.name_span));
        if self.takes_vertices() {
            self.vertices(&v.name, &ty, handle, v.name_span)?;
        } else if self.shader.stage() != Stage::Library {
            let first = self.declarator_location(v);
            self.located_input(&v.name, &ty, (handle, &[]), first, &[&v.qualifiers], v.name_span)?;
        }
        self.made.globals.insert(v.symbol, super::global::Global::Whole { handle, ty });
        Ok(())
    }

    /// `layout(location = n) in vec4 a, b;` counts on.
    pub(super) fn declarator_location(&self, v: &interface::Variable) -> Option<u32> {
        let first = self.written(&v.qualifiers, "location")?;
        let interface = self.shader.interface();
        let before =
            interface.inputs.iter().chain(&interface.outputs).filter(|o| o.item == v.item && o.position < v.position);
        Some(first + before.map(|o| u32::try_from(leaves(&o.ty).len()).unwrap_or(1)).sum::<u32>())
    }

    pub(super) fn declare_output(&mut self, v: &'s interface::Variable) -> Result<()> {
        if v.name.starts_with("gl_") || self.made.globals.contains_key(&v.symbol) {
            return Ok(());
        }
        let mut ty = self.with_size(v.symbol, &self.with_dims(&v.ty, &self.dims_of(v)));
        if let Some(n) = self.vertices_of(Storage::Out, &v.qualifiers) {
            ty = super::statement::with_length(&v.ty, n);
        }
        let handle = self.private(&v.name, &ty, v.name_span)?;
        if !self.takes_vertices() && self.shader.stage() != Stage::Library {
            let first = self.declarator_location(v);
            self.located_output(&v.name, &ty, (handle, &[]), first, &[&v.qualifiers], v.name_span)?;
        }
        let ports = self.port_out(&v.name, &ty, handle, v.name_span)?;
        self.ports.outputs.extend(ports);
        self.made.globals.insert(v.symbol, super::global::Global::Whole { handle, ty });
        Ok(())
    }

    pub(super) fn block_input(
        &mut self,
        index: usize,
        handle: Handle<GlobalVariable>,
        prefix: &str,
        ty: &Type,
    ) -> Result<()> {
        let block = &self.shader.interface().blocks[index];
        self.ports.stage_inputs.push((block.name.name.clone(), handle, block.name.span));
        if self.takes_vertices() {
            return self.vertices(prefix, ty, handle, block.name.span);
        }
        self.each_member(
            index,
            ty,
            |b, member, path, name, ty, first| {
                let qualifiers = [&block.qualifiers, &member.qualifiers];
                b.located_input(&name, &ty, (handle, &path), first, &qualifiers, member.name.span)
            },
            prefix,
        )
    }

    pub(super) fn block_output(
        &mut self,
        index: usize,
        handle: Handle<GlobalVariable>,
        prefix: &str,
        ty: &Type,
    ) -> Result<()> {
        let block = &self.shader.interface().blocks[index];
        if !self.takes_vertices() {
            self.each_member(
                index,
                ty,
                |b, member, path, name, ty, first| {
                    let qualifiers = [&block.qualifiers, &member.qualifiers];
                    b.located_output(&name, &ty, (handle, &path), first, &qualifiers, member.name.span)
                },
                prefix,
            )?;
        }
        let ports = self.port_out(prefix, ty, handle, block.name.span)?;
        self.ports.outputs.extend(ports);
        Ok(())
    }

    /// The members of a block, or of each element of an array of blocks, with their locations.
    fn each_member(
        &mut self,
        index: usize,
        ty: &Type,
        mut work: impl FnMut(&mut Self, &interface::BlockMember, Vec<u32>, String, Type, Option<u32>) -> Result<()>,
        prefix: &str,
    ) -> Result<()> {
        let block = &self.shader.interface().blocks[index];
        let copies: Vec<(Vec<u32>, String, &Type)> = match ty {
            Type::Array(element, ArraySize::Known(n)) => {
                (0..*n).map(|k| (vec![k], format!("{prefix}[{k}]"), element.as_ref())).collect()
            }
            _ => vec![(Vec::new(), prefix.to_owned(), ty)],
        };
        let mut at = self.written(&block.qualifiers, "location");
        for (path, prefix, ty) in copies {
            let Type::Struct(s) = ty else { continue };
            for (k, (member, field)) in block.members.iter().zip(&s.fields).enumerate() {
                let first = self.written(&member.qualifiers, "location").or(at);
                let count = u32::try_from(leaves(&field.ty).len()).unwrap_or(1);
                at = first.map(|l| l + count);
                let name = if prefix.is_empty() { field.name.clone() } else { format!("{prefix}.{}", field.name) };
                let path = [&path[..], &[u32::try_from(k).unwrap_or(0)]].concat();
                work(self, member, path, name, field.ty.clone(), first)?;
            }
        }
        Ok(())
    }

    /// An argument of the entry point that is a built-in value.
    pub(super) fn built_in_input(
        &mut self,
        name: &str,
        given: &Type,
        kept: &Type,
        (handle, path): (Handle<GlobalVariable>, Vec<u32>),
        built_in: naga::BuiltIn,
        span: Span,
    ) -> Result<()> {
        let ty = self.value_type(given, span)?;
        let binding = Some(Binding::BuiltIn(built_in));
        let index = u32::try_from(self.ports.incoming.len()).unwrap_or(0);
        let argument = FunctionArgument { name: Some(name.to_owned()), ty, binding };
        self.ports.incoming.push(Incoming { argument, to: handle, path, ty: kept.clone() });
        // A compute stage is dispatched alone, and a host decides for itself.
        if !self.run || !matches!(self.shader.stage(), Stage::Vertex | Stage::Fragment) {
            self.ports.built_ins.push((index, built_in));
            return Ok(());
        }
        let before = self.ports.inputs.len();
        self.port_in(name, kept, PortAt::Argument(index), span)?;
        for port in &mut self.ports.inputs[before..] {
            port.ty = ty;
        }
        if self.shader.stage() == Stage::Vertex {
            self.ports.drawn.extend(self.ports.inputs.drain(before..));
        }
        Ok(())
    }
}

/// The kind to which an argument is turned before it is kept.
pub(super) fn kind_of(ty: &Type) -> Option<ScalarKind> {
    ty.scalar().map(|s| super::types::scalar(s).kind)
}
