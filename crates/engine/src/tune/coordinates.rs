//! Variables that carry coordinates of textures: those of the interpreter are a few texels wide, and those of a program are not.

use std::collections::{BTreeSet, HashMap};

use crate::guess::{self, Role, TEXTURE_COORDINATES};
use base::value::Field;
use syntax::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, SymbolId, SymbolKind};
use syntax::types::{OpaqueKind, TextureDim, Type};
use syntax::{Shader, Stage};

/// Texels that a number of 11 bits between 0 and 1 tells apart: its step is 2^-10 of it.
pub const TOLD_APART: u32 = 1024;

/// Variables that are followed, one from the other.
const MOST: usize = 8;

/// Inputs, parameters and local variables whose value goes to the coordinate of a texel as it is, or with something added:
/// in a texture of 1024 texels it needs more digits than `mediump` has. `declared` are initialisers.
pub fn coordinates(shader: &Shader, declared: &[(SymbolId, ExprId)]) -> BTreeSet<SymbolId> {
    let mut finder = CoordinateFinder { shader, given: HashMap::new(), found: BTreeSet::new() };
    for (symbol, value) in declared {
        finder.given.entry(*symbol).or_default().push(*value);
    }
    for (_, expr) in shader.arena().iter() {
        if let ExprKind::Assign { target, value, .. } = &expr.kind
            && let Some(symbol) = shader.symbol_of(*target)
        {
            finder.given.entry(symbol).or_default().push(*value);
        }
    }
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Call { args, .. } = &expr.kind else { continue };
        let (Some(CallTarget::Builtin(call)), [sampler, at, ..]) = (shader.callee(id), args.as_slice()) else {
            continue;
        };
        let flat = matches!(shader.type_of(*sampler), Type::Opaque(of) if of.kind == OpaqueKind::Sampler && of.dim == TextureDim::D2);
        if flat && !call.function.name().starts_with("texelFetch") {
            finder.carries(*at, 0);
        }
    }
    // A vertex stage hands coordinates on: what takes them is in another text, and their name says so.
    for (_, expr) in shader.arena().iter().filter(|_| shader.stage() == Stage::Vertex) {
        if let ExprKind::Assign { target, value, .. } = &expr.kind
            && let Some(symbol) = shader.symbol_of(*target)
            && is_handed_on(shader, symbol)
            && finder.carries(*value, 0)
        {
            finder.found.insert(symbol);
        }
    }
    finder.found
}

/// True for an output of two numbers or more whose name says that it is a coordinate of textures.
fn is_handed_on(shader: &Shader, symbol: SymbolId) -> bool {
    let own = shader.symbol(symbol);
    let (SymbolKind::Global(Storage::Out), Some(shape)) = (&own.kind, own.ty.shape()) else { return false };
    let field = Field { name: own.name.clone(), shape };
    shape.words() > 1 && guess::of(&field, Role::Varying).taken_for == TEXTURE_COORDINATES
}

struct CoordinateFinder<'s> {
    shader: &'s Shader,
    given: HashMap<SymbolId, Vec<ExprId>>,
    found: BTreeSet<SymbolId>,
}

impl CoordinateFinder<'_> {
    /// True where the value has a term that varies from one pixel to the next, which is noted with what carries it.
    fn carries(&mut self, id: ExprId, depth: usize) -> bool {
        let shader = self.shader;
        if depth > MOST {
            return false;
        }
        match &shader.expr(id).kind {
            ExprKind::Name(_) => {
                let Some(symbol) = shader.symbol_of(id) else { return false };
                let carries = match shader.symbol(symbol).kind {
                    SymbolKind::Global(Storage::In) | SymbolKind::Param(_) => true,
                    SymbolKind::Local => {
                        let given = self.given.get(&symbol).cloned().unwrap_or_default();
                        self.any_carries(&given, depth + 1)
                    }
                    _ => false,
                };
                if carries {
                    self.found.insert(symbol);
                }
                carries
            }
            ExprKind::Paren(inner)
            | ExprKind::Field { base: inner, .. }
            | ExprKind::Unary { op: UnaryOp::Plus | UnaryOp::Minus, operand: inner, .. } => self.carries(*inner, depth),
            ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub, left, right, .. } => {
                let first = self.carries(*left, depth);
                self.carries(*right, depth) || first
            }
            ExprKind::Call { args, .. } if matches!(shader.callee(id), Some(CallTarget::Constructor(_))) => {
                self.any_carries(args, depth)
            }
            _ => false,
        }
    }

    /// The same of several: each is looked at.
    fn any_carries(&mut self, all: &[ExprId], depth: usize) -> bool {
        let mut any = false;
        for &one in all {
            any |= self.carries(one, depth);
        }
        any
    }
}
