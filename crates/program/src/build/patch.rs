//! What tessellation stages take and give. naga has no such stages: one invocation becomes a function over the vertices
//! of a patch, as a geometry stage does over those of a primitive.

use naga::{GlobalVariable, Handle};

use super::io::parts;
use super::{Build, Result};
use crate::PortAt;
use base::text::Span;
use syntax::Stage;
use syntax::ast::{AuxiliaryQualifier, ExprId, ExprKind, QualifierKind, Qualifiers};
use syntax::interface::Storage;
use syntax::symbols::{SymbolId, SymbolKind};
use syntax::types::{ArraySize, Type};

/// The most vertices that a patch has: the least that an implementation allows (GLSL 4.60, 7.3, `gl_MaxPatchVertices`).
const MOST: u32 = 32;

impl Build<'_> {
    /// True for the stages that take an array over vertices: their outputs are captured from variables.
    pub(super) fn takes_vertices(&self) -> bool {
        matches!(self.shader.stage(), Stage::Geometry | Stage::TessControl | Stage::TessEvaluation)
    }

    /// Ports of an array over the vertices of a primitive.
    pub(super) fn vertices(&mut self, name: &str, ty: &Type, handle: Handle<GlobalVariable>, span: Span) -> Result<()> {
        if ty.shape().is_some() {
            return self.port_in(name, ty, PortAt::Global(handle), span);
        }
        if let Type::Array(element, ArraySize::Known(count)) = ty
            && let Type::Struct(s) = element.as_ref()
        {
            for (k, field) in s.fields.iter().enumerate() {
                let whole = field.ty.clone().array(*count);
                let member = u32::try_from(k).unwrap_or(0);
                if whole.shape().is_none() {
                    // What is no number in each vertex is fed vertex by vertex.
                    let (mut found, mut unfed) = (Vec::new(), Vec::new());
                    for vertex in 0..*count {
                        let name = format!("{name}[{vertex}].{}", field.name);
                        parts(&name, &field.ty, &[vertex, member], &mut found, &mut unfed);
                    }
                    for part in found {
                        let at = PortAt::Part { global: handle, path: part.path };
                        self.port_in(&part.name, &part.ty, at, span)?;
                    }
                    self.not_fed(unfed, span);
                    continue;
                }
                let at = PortAt::Vertices { global: handle, member, count: *count };
                let name = if name == "gl_in" { field.name.clone() } else { format!("{name}.{}", field.name) };
                self.port_in(&name, &whole, at, span)?;
            }
            return Ok(());
        }
        self.not_fed(vec![format!("`{name}` of type `{ty}`")], span);
        Ok(())
    }

    /// Length of an array over vertices that is declared without one; `None` for what is no such array.
    pub(super) fn vertices_of(&self, storage: Storage, qualifiers: &Qualifiers) -> Option<u32> {
        let patch = QualifierKind::Auxiliary(AuxiliaryQualifier::Patch);
        if qualifiers.list.iter().any(|q| q.kind == patch) {
            return None;
        }
        match (storage, self.shader.stage()) {
            (Storage::In, _) if self.takes_vertices() => Some(self.vertices_taken()),
            (Storage::Out, Stage::TessControl) => Some(self.vertices_given()),
            _ => None,
        }
    }

    /// Vertices of the primitive or patch that the stage takes. A host states those of a patch: they are as many as the
    /// text reads.
    pub(super) fn vertices_taken(&self) -> u32 {
        if self.shader.stage() == Stage::Geometry {
            return self.input_primitive().vertices();
        }
        let control = self.shader.stage() == Stage::TessControl;
        let mut most = if control { self.vertices_given() } else { 1 };
        for (_, expr) in self.shader.arena().iter() {
            match expr.kind {
                ExprKind::Index { base, index } if self.is_over_vertices(base) => match self.shader.fold(index) {
                    Some(k) => most = most.max(k.as_integer().and_then(|k| u32::try_from(k).ok()).unwrap_or(0) + 1),
                    // Each invocation has a vertex of its own, and there are as many of them as vertices that come out.
                    None if control && self.is_own(index) => {}
                    None => return MOST,
                },
                ExprKind::Method { base, .. } if self.is_over_vertices(base) => return MOST,
                _ => {}
            }
        }
        most.min(MOST)
    }

    /// Vertices that the invocations of a control stage write: `layout(vertices = 3) out;`.
    pub(super) fn vertices_given(&self) -> u32 {
        let mut layouts = self.shader.interface().stage_layouts.iter();
        layouts.find_map(|l| self.written(&l.qualifiers, "vertices")).unwrap_or(MOST).clamp(1, MOST)
    }

    fn named(&self, id: ExprId) -> Option<SymbolId> {
        match &self.shader.expr(id).kind {
            ExprKind::Name(_) => self.shader.symbol_of(id),
            ExprKind::Paren(inner) => self.named(*inner),
            _ => None,
        }
    }

    /// True for the name of an input that has an element for each vertex.
    fn is_over_vertices(&self, id: ExprId) -> bool {
        let Some(symbol) = self.named(id).map(|symbol| self.shader.symbol(symbol)) else { return false };
        match symbol.kind {
            SymbolKind::Global(storage) => storage == Storage::In,
            SymbolKind::BlockInstance(block) => self.shader.interface().blocks[block].storage == Storage::In,
            _ => symbol.name == "gl_in",
        }
    }

    /// True for `gl_InvocationID`.
    fn is_own(&self, id: ExprId) -> bool {
        self.named(id).is_some_and(|symbol| self.shader.symbol(symbol).name == "gl_InvocationID")
    }

    /// True when a built-in array is copied as a whole.
    pub(super) fn taken_whole(&self, name: &str) -> bool {
        let arena = self.shader.arena();
        let named = |id: ExprId| match &self.shader.expr(id).kind {
            ExprKind::Name(n) => n == name,
            ExprKind::Field { field, .. } => field.name == name,
            _ => false,
        };
        let part = |of: ExprId| {
            arena.iter().any(|(_, e)| match e.kind {
                ExprKind::Index { base, .. } | ExprKind::Method { base, .. } => base == of,
                _ => false,
            })
        };
        arena.iter().any(|(id, _)| named(id) && !part(id))
    }
}
