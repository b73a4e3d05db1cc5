//! Locations that several variables share by `layout(component)` (GLSL 4.60, 4.4.1): one vector goes in or
//! out, and each variable is a part of it.

use std::collections::{BTreeMap, HashSet};

use naga::{Binding, Expression, FunctionArgument, GlobalVariable, Handle, Statement, StructMember};

use super::function::{Fun, Val};
use super::io::leaves;
use super::types::count;
use super::{Build, Result};
use base::text::Span;
use syntax::Stage;
use syntax::ast::Qualifiers;
use syntax::interface::Storage;
use syntax::types::{ScalarType, Type};

/// Shared locations of a stage.
#[derive(Clone, Debug, Default)]
pub(super) struct Shared {
    /// Locations at which a component is written, for inputs (`true`) and outputs.
    at: HashSet<(bool, u32)>,
    inputs: BTreeMap<u32, Vector>,
    outputs: BTreeMap<u32, Vector>,
}

/// What lies in one location.
#[derive(Clone, Debug)]
struct Vector {
    binding: Binding,
    scalar: ScalarType,
    pieces: Vec<SharedPiece>,
}

#[derive(Clone, Debug)]
struct SharedPiece {
    variable: Handle<GlobalVariable>,
    path: Vec<u32>,
    ty: Type,
    first: u32,
}

impl Vector {
    fn width(&self) -> u32 {
        self.pieces.iter().map(|p| p.first + components(&p.ty)).max().unwrap_or(1).min(4)
    }
}

fn components(ty: &Type) -> u32 {
    if ty.is_scalar() { 1 } else { count(ty) }
}

impl Build<'_> {
    /// Finds the locations at which a component is written.
    pub(super) fn shared_locations(&mut self) {
        let interface = self.shader.interface();
        let mut found = Vec::new();
        for (variables, input) in [(&interface.inputs, true), (&interface.outputs, false)] {
            for v in variables {
                let location = self.written(&v.qualifiers, "location");
                if let (Some(first), Some(_)) = (location, self.written(&v.qualifiers, "component")) {
                    found.push((input, first, leaves(&v.ty).len()));
                }
            }
        }
        for block in &interface.blocks {
            let input = match block.storage {
                Storage::In => true,
                Storage::Out => false,
                _ => continue,
            };
            for member in &block.members {
                let location = self.written(&member.qualifiers, "location");
                if let (Some(first), Some(_)) = (location, self.written(&member.qualifiers, "component")) {
                    found.push((input, first, leaves(&member.ty).len()));
                }
            }
        }
        for (input, first, count) in found {
            self.ports.shared.at.extend((first..).take(count).map(|l| (input, l)));
        }
        // Attributes may stand at one location, of which one is read (OpenGL 4.6, 11.1.1).
        if self.shader.stage() == Stage::Vertex {
            let mut seen = HashSet::new();
            for v in &interface.inputs {
                let Some(first) = self.declarator_location(v) else { continue };
                let all = (first..).take(leaves(&v.ty).len());
                self.ports.shared.at.extend(all.filter(|l| !seen.insert(*l)).map(|l| (true, l)));
            }
        }
    }

    /// True when one of these locations is shared.
    pub(super) fn is_shared(&self, input: bool, first: u32, count: u32) -> bool {
        (first..first.saturating_add(count)).any(|l| self.ports.shared.at.contains(&(input, l)))
    }

    /// Puts the parts of a variable into its locations, one after the other.
    pub(super) fn share(
        &mut self,
        input: bool,
        variable: Handle<GlobalVariable>,
        pieces: Vec<(Vec<u32>, Type)>,
        first: u32,
        qualifiers: &[&Qualifiers],
        span: Span,
    ) -> Result<()> {
        let component = qualifiers.iter().rev().find_map(|q| self.written(q, "component")).unwrap_or(0);
        for (location, (path, ty)) in (first..).zip(pieces) {
            let (Some(scalar), true) = (ty.scalar(), component + components(&ty) <= 4) else {
                return Err(self.unsupported(span, "`layout(component)` of this type", "use a location of its own"));
            };
            if scalar == ScalarType::Double {
                return Err(self.unsupported(span, "a `double` in a shared location", "use a location of its own"));
            }
            let binding = self.location(&ty, location, input, qualifiers);
            let all = if input { &mut self.ports.shared.inputs } else { &mut self.ports.shared.outputs };
            let vector = all.entry(location).or_insert(Vector { binding, scalar, pieces: Vec::new() });
            vector.pieces.push(SharedPiece { variable, path, ty, first: component });
        }
        Ok(())
    }

    /// Arguments of the entry point behind all others.
    pub(super) fn shared_arguments(&mut self, span: Span) -> Result<Vec<FunctionArgument>> {
        let mut arguments = Vec::new();
        for (location, vector) in self.ports.shared.inputs.clone() {
            let width = u8::try_from(vector.width()).unwrap_or(4);
            let ty = self.value_type(&Type::vector(vector.scalar, width), span)?;
            let name = Some(format!("sc_location_{location}"));
            arguments.push(FunctionArgument { name, ty, binding: Some(vector.binding.clone()) });
        }
        Ok(arguments)
    }
}

impl Fun<'_, '_> {
    fn piece(&mut self, piece: &SharedPiece) -> naga::Handle<Expression> {
        let mut pointer = self.add(Expression::GlobalVariable(piece.variable));
        for &index in &piece.path {
            pointer = self.add(Expression::AccessIndex { base: pointer, index });
        }
        pointer
    }

    /// Numbers of another kind with the same bits.
    fn as_bits(&mut self, value: Val, to: ScalarType) -> Val {
        if value.ty.scalar() == Some(to) {
            return value;
        }
        let kind = super::types::scalar(to).kind;
        let e = self.add(Expression::As { expr: value.e, kind, convert: None });
        Val { e, ty: value.ty.with_scalar(to) }
    }

    /// Fills the variables from the arguments from index `first` on.
    pub(super) fn fill_shared(&mut self, first: usize) -> Result<()> {
        for (k, vector) in self.build.ports.shared.inputs.clone().into_values().enumerate() {
            let index = u32::try_from(first + k).unwrap_or(u32::MAX);
            let e = self.add(Expression::FunctionArgument(index));
            let width = u8::try_from(vector.width()).unwrap_or(4);
            let whole = Val { e, ty: Type::vector(vector.scalar, width) };
            for piece in &vector.pieces {
                let end = piece.first + components(&piece.ty);
                let picked: Vec<u8> = (piece.first..end).filter_map(|c| u8::try_from(c).ok()).collect();
                let value = self.swizzle(&whole, &picked)?;
                let value = self.as_bits(value, piece.ty.scalar().unwrap_or(vector.scalar)).e;
                let pointer = self.piece(piece);
                self.push(Statement::Store { pointer, value });
            }
        }
        Ok(())
    }

    /// Adds the shared locations to what the entry point returns.
    pub(super) fn hand_on_shared(
        &mut self,
        components_of: &mut Vec<naga::Handle<Expression>>,
        members: &mut Vec<StructMember>,
        mut offset: u32,
    ) -> Result<u32> {
        for (location, vector) in self.build.ports.shared.outputs.clone() {
            let width = u8::try_from(vector.width()).unwrap_or(4);
            let mut parts = vec![self.number(vector.scalar, 0.0); usize::from(width)];
            for piece in &vector.pieces {
                let pointer = self.piece(piece);
                let e = self.add(Expression::Load { pointer });
                let value = self.as_bits(Val { e, ty: piece.ty.clone() }, vector.scalar);
                for c in 0..components(&piece.ty) {
                    let part = if piece.ty.is_scalar() { value.e } else { self.part(value.e, c) };
                    parts[(piece.first + c) as usize] = part;
                }
            }
            let ty = Type::vector(vector.scalar, width);
            let value = if width == 1 { parts[0] } else { self.compose(&ty, parts)?.e };
            let ty = self.ty(&ty)?;
            components_of.push(value);
            let name = Some(format!("sc_location_{location}"));
            members.push(StructMember { name, ty, binding: Some(vector.binding.clone()), offset });
            offset += 32;
        }
        Ok(offset)
    }

    /// True when something goes out through a shared location.
    pub(super) fn shares_outputs(&self) -> bool {
        !self.build.ports.shared.outputs.is_empty()
    }
}
