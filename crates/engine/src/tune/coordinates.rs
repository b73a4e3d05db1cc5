//! Variables that carry coordinates of textures: those of the interpreter are a few texels wide, and those of a program are not.
//!
//! All that reaches a coordinate counts, through sums, products, functions and other variables: a factor of 7.3 that is off by
//! one part in 2000 moves the last texel of 2048 by several.

use std::collections::BTreeMap;
use std::collections::HashMap;

use crate::guess::{self, Role, TEXTURE_COORDINATES};
use base::value::Field;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, FunctionId, SymbolId, SymbolKind};
use syntax::types::{OpaqueKind, TextureDim, Type};
use syntax::{Const, Shader, Stage};

/// Texels that a number of 11 bits between 0 and 1 tells apart: its step is 2^-10 of it.
pub const TOLD_APART: u32 = 1024;

/// How often a texture is taken to be repeated by a coordinate that is multiplied by what nobody states.
pub const REPEATS: u32 = 16;

/// Variables that are followed, one from the other.
const MOST: usize = 24;

/// Functions that give one of their arguments, or what lies between.
const BETWEEN: [&str; 10] = ["min", "max", "clamp", "mix", "abs", "fract", "mod", "floor", "ceil", "round"];

/// What carries coordinates; true for those that are multiplied, or whose range is unknown.
#[derive(Default)]
pub struct Coordinates {
    /// Variables.
    pub symbols: BTreeMap<SymbolId, bool>,
    /// Results of functions.
    pub functions: BTreeMap<FunctionId, bool>,
    /// Members of structures, by name.
    pub members: BTreeMap<String, bool>,
}

/// What reaches the coordinate of a texel. `declared` are initialisers, `returned` what functions return.
pub fn coordinates(shader: &Shader, declared: &[(SymbolId, ExprId)], returned: &[(FunctionId, ExprId)]) -> Coordinates {
    let mut finder =
        CoordinateFinder { shader, given: HashMap::new(), returned, passed: Vec::new(), found: Coordinates::default() };
    for (symbol, value) in declared {
        finder.given.entry(*symbol).or_default().push((*value, false));
    }
    let mut handed_on = Vec::new();
    for (id, expr) in shader.arena().iter() {
        match &expr.kind {
            ExprKind::Assign { op, target, value, .. } => {
                let Some(symbol) = root(shader, *target) else { continue };
                let scales = matches!(op, Some(BinaryOp::Mul | BinaryOp::Div));
                finder.given.entry(symbol).or_default().push((*value, scales));
                handed_on.push((symbol, *value));
            }
            ExprKind::Call { args, .. } => {
                if let Some(CallTarget::User(function)) = shader.callee(id) {
                    finder.passed.push((*function, args));
                }
            }
            _ => {}
        }
    }
    for (id, expr) in shader.arena().iter() {
        if let ExprKind::Call { args, .. } = &expr.kind
            && let (Some(CallTarget::Builtin(_)), [sampler, at, ..]) = (shader.callee(id), args.as_slice())
            && matches!(shader.type_of(*sampler), Type::Opaque(of) if of.kind == OpaqueKind::Sampler && of.dim == TextureDim::D2)
        {
            finder.reach(*at, false, 0);
        }
    }
    // A vertex stage hands coordinates on: what takes them is in another text, and their name or their source says so.
    for (symbol, value) in handed_on.into_iter().filter(|_| shader.stage() == Stage::Vertex) {
        if matches!(shader.symbol(symbol).kind, SymbolKind::Global(Storage::Out))
            && (names_coordinates(shader, symbol) || finder.is_of_coordinates(value))
        {
            finder.variable(symbol, false, 0);
        }
    }
    finder.found
}

/// The variable that an expression is, or is a part of.
fn root(shader: &Shader, id: ExprId) -> Option<SymbolId> {
    match &shader.expr(id).kind {
        ExprKind::Paren(inner) | ExprKind::Field { base: inner, .. } | ExprKind::Index { base: inner, .. } => {
            root(shader, *inner)
        }
        _ => shader.symbol_of(id),
    }
}

/// True for a variable of two numbers or more whose name says that it is a coordinate of textures.
fn names_coordinates(shader: &Shader, symbol: SymbolId) -> bool {
    let own = shader.symbol(symbol);
    let Some(shape) = own.ty.shape() else { return false };
    let field = Field { name: own.name.clone(), shape };
    shape.words() > 1 && guess::of(&field, Role::Varying).taken_for == TEXTURE_COORDINATES
}

struct CoordinateFinder<'s> {
    shader: &'s Shader,
    /// What variables are set to, and whether they are multiplied by it.
    given: HashMap<SymbolId, Vec<(ExprId, bool)>>,
    returned: &'s [(FunctionId, ExprId)],
    /// Calls of functions with their arguments.
    passed: Vec<(FunctionId, &'s Vec<ExprId>)>,
    found: Coordinates,
}

impl CoordinateFinder<'_> {
    /// Notes what a coordinate is made of; `scaled` where that is multiplied on its way. True where the value itself is a
    /// product, or of unknown size.
    fn reach(&mut self, id: ExprId, scaled: bool, depth: usize) -> bool {
        let shader = self.shader;
        if depth > MOST {
            return true;
        }
        match &shader.expr(id).kind {
            ExprKind::Name(_) => shader.symbol_of(id).is_some_and(|symbol| self.variable(symbol, scaled, depth)),
            ExprKind::Field { base, field } => {
                if matches!(shader.type_of(*base), Type::Struct(_)) {
                    note(&mut self.found.members, field.name.clone(), scaled);
                }
                self.reach(*base, scaled, depth)
            }
            ExprKind::Index { base, .. } => self.reach(*base, scaled, depth),
            ExprKind::Binary { op: op @ (BinaryOp::Mul | BinaryOp::Div), left, right, .. } => {
                let factor = |id: ExprId| match shader.fold(id) {
                    Some(Const::Float(factor)) => Some(factor.abs()),
                    _ => None,
                };
                let shrinks = match op {
                    BinaryOp::Mul => factor(*left).or(factor(*right)).is_some_and(|factor| factor <= 1.0),
                    _ => factor(*right).is_some_and(|factor| factor >= 1.0),
                };
                let both = self.all([*left, *right], scaled || !shrinks, depth);
                both || !shrinks
            }
            ExprKind::Binary { left, right, .. } => self.all([*left, *right], scaled, depth),
            ExprKind::Ternary { yes, no, .. } => self.all([*yes, *no], scaled, depth),
            ExprKind::Call { args, .. } => self.call(id, args, scaled, depth),
            ExprKind::Literal(_) | ExprKind::Method { .. } => false,
            _ => self.all(shader.expr(id).children(), scaled, depth),
        }
    }

    fn call(&mut self, id: ExprId, args: &[ExprId], scaled: bool, depth: usize) -> bool {
        match self.shader.callee(id) {
            Some(CallTarget::Constructor(_)) | None => self.all(args.iter().copied(), scaled, depth),
            Some(CallTarget::User(function)) => {
                note(&mut self.found.functions, *function, scaled);
                let of = |(one, value): &(FunctionId, ExprId)| (one == function).then_some(*value);
                let values: Vec<ExprId> = self.returned.iter().filter_map(of).collect();
                let below = self.all(values, scaled, depth + 1);
                note(&mut self.found.functions, *function, below);
                below
            }
            // What a texture holds has the precision of its sampler.
            Some(CallTarget::Builtin(_))
                if args.first().is_some_and(|first| matches!(self.shader.type_of(*first), Type::Opaque(_))) =>
            {
                false
            }
            Some(CallTarget::Builtin(call)) if BETWEEN.contains(&call.function.name()) => {
                self.all(args.iter().copied(), scaled, depth)
            }
            Some(CallTarget::Builtin(_)) => {
                self.all(args.iter().copied(), true, depth);
                true
            }
        }
    }

    /// The same of several: each is looked at.
    fn all(&mut self, all: impl IntoIterator<Item = ExprId>, scaled: bool, depth: usize) -> bool {
        let mut any = false;
        for one in all {
            any |= self.reach(one, scaled, depth);
        }
        any
    }

    fn variable(&mut self, symbol: SymbolId, scaled: bool, depth: usize) -> bool {
        let kind = &self.shader.symbol(symbol).kind;
        // What a host sets may be of any size.
        let host = matches!(kind, SymbolKind::Global(Storage::Uniform) | SymbolKind::BlockMember(_));
        let scaled = scaled || (host && !names_coordinates(self.shader, symbol));
        if let Some(known) = self.found.symbols.get(&symbol).copied()
            && (known || !scaled)
        {
            return known;
        }
        note(&mut self.found.symbols, symbol, scaled);
        let mut below = host && scaled;
        let given = self.given.get(&symbol).cloned().unwrap_or_default();
        let scales = given.iter().any(|(_, scales)| *scales);
        for (value, _) in given {
            below |= self.reach(value, scaled || scales, depth + 1) || scales;
        }
        for value in self.arguments(symbol) {
            below |= self.reach(value, scaled, depth + 1);
        }
        note(&mut self.found.symbols, symbol, below);
        below
    }

    /// What is passed for a parameter.
    fn arguments(&self, symbol: SymbolId) -> Vec<ExprId> {
        if !matches!(self.shader.symbol(symbol).kind, SymbolKind::Param(_)) {
            return Vec::new();
        }
        let of = |(function, args): &(FunctionId, &Vec<ExprId>)| {
            let info = self.shader.function_info(*function);
            let at = info.params.iter().position(|param| param.symbol == Some(symbol))?;
            args.get(at).copied()
        };
        self.passed.iter().filter_map(of).collect()
    }

    /// True where an input goes in whose name says that it is a coordinate of textures.
    fn is_of_coordinates(&self, id: ExprId) -> bool {
        let shader = self.shader;
        let input = |symbol: &SymbolId| matches!(shader.symbol(*symbol).kind, SymbolKind::Global(Storage::In));
        match shader.symbol_of(id) {
            Some(symbol) => input(&symbol) && names_coordinates(shader, symbol),
            None => shader.expr(id).children().into_iter().any(|child| self.is_of_coordinates(child)),
        }
    }
}

/// Notes a carrier; once multiplied, it stays so.
fn note<K: Ord>(found: &mut BTreeMap<K, bool>, key: K, scaled: bool) {
    *found.entry(key).or_default() |= scaled;
}
