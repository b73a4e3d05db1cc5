//! Places that hold values: variables and their parts, read and written.

use naga::{BinaryOperator, Expression, Handle, ScalarKind, Statement, SwizzleComponent, Type as NagaType, TypeInner};

use super::function::{Fun, Val};
use super::texture::Opaque;
use super::types::{count, same, size};
use super::{Build, Expr, Result};
use crate::front::VALIDATOR;
use base::diagnostic::{Diagnostic, Severity};
use base::text::Span;
use syntax::ast::{Callee, ExprId, ExprKind};
use syntax::swizzle::component;
use syntax::symbols::SymbolId;
use syntax::types::{ScalarType, Type};

/// What a name stands for.
#[derive(Clone, Debug)]
pub(super) enum Var {
    /// A place in memory.
    Place(Lvalue),
    /// A value that is never written.
    Value(Val),
    /// A sampler or image, or a structure with one inside.
    Opaque(Opaque),
}

/// A place in memory.
#[derive(Clone, Debug)]
pub(super) struct Lvalue {
    pub ptr: Expr,
    /// Type of the value in GLSL, with the swizzle taken.
    pub ty: Type,
    /// Type of the memory behind the pointer.
    pub host: Handle<NagaType>,
    /// Components of a vector in the order in which they are taken.
    pub swizzle: Option<Vec<u8>>,
}

/// Components that a swizzle names.
pub(super) fn components(field: &str) -> Option<Vec<u8>> {
    field.chars().map(|c| component(c).and_then(|k| u8::try_from(k).ok())).collect()
}

impl Fun<'_, '_> {
    /// The place that an expression names; none when it is a value.
    pub(super) fn place(&mut self, id: ExprId) -> Result<Option<Lvalue>> {
        let expr = self.shader.expr(id);
        let found = match &expr.kind {
            ExprKind::Name(name) => match self.variable(id, name, expr.span)? {
                Var::Place(place) => Some(place),
                Var::Value(_) => None,
                Var::Opaque(opaque) => self.data_place(&opaque),
            },
            ExprKind::Paren(inner) => self.place(*inner)?,
            ExprKind::Field { base, field } => match self.place(*base)? {
                Some(place) => self.field(place, &field.name, field.span)?,
                None => None,
            },
            ExprKind::Index { base, index } => match self.place(*base)? {
                Some(place) => self.index(place, *index)?,
                None => None,
            },
            ExprKind::Literal(_)
            | ExprKind::Method { .. }
            | ExprKind::Call { .. }
            | ExprKind::Unary { .. }
            | ExprKind::Postfix { .. }
            | ExprKind::Binary { .. }
            | ExprKind::Assign { .. }
            | ExprKind::Ternary { .. }
            | ExprKind::Comma { .. }
            | ExprKind::List(_)
            | ExprKind::Error => None,
        };
        Ok(found)
    }

    /// The place that an expression names, which must be one.
    pub(super) fn target(&mut self, id: ExprId) -> Result<Lvalue> {
        // `(a = b).x = c` and the like are no part of GLSL.
        match self.place(id)? {
            Some(place) => Ok(place),
            None => Err(self.build.unsupported(
                self.shader.expr(id).span,
                "writing to something that is no variable",
                "assign to a variable",
            )),
        }
    }

    /// What a name means here.
    pub(super) fn variable(&mut self, id: ExprId, name: &str, span: Span) -> Result<Var> {
        let Some(symbol) = self.shader.symbol_of(id) else {
            return Err(self.build.unsupported(span, format!("`{name}`, which is not known"), "declare it"));
        };
        self.symbol(symbol, span)
    }

    pub(super) fn symbol(&mut self, symbol: SymbolId, span: Span) -> Result<Var> {
        if let Some(var) = self.names.get(&symbol) {
            return Ok(var.clone());
        }
        if let Some(var) = self.global(symbol, span)? {
            return Ok(var);
        }
        // A variable of a `switch` whose declaration is jumped over.
        let info = self.shader.symbol(symbol);
        let place = self.local(&info.name, &info.ty)?;
        self.names.insert(symbol, Var::Place(place.clone()));
        Ok(Var::Place(place))
    }

    /// A member or components of a place.
    pub(super) fn field(&mut self, place: Lvalue, name: &str, span: Span) -> Result<Option<Lvalue>> {
        match &place.ty {
            Type::Struct(s) => {
                let Some((index, field)) =
                    Build::member_index(s, name).zip(s.fields.iter().find(|f| f.name == name).map(|f| f.ty.clone()))
                else {
                    return Err(self.build.unsupported(span, format!("the member `{name}`"), "declare it"));
                };
                let host = self.build.members(place.host)[index as usize];
                let ty = self.build.sized(&field, host);
                let ptr = self.add(Expression::AccessIndex { base: place.ptr, index });
                Ok(Some(Lvalue { ptr, ty, host, swizzle: None }))
            }
            Type::Vector(scalar, _) => {
                let Some(mut picked) = components(name) else { return Ok(None) };
                if let Some(before) = &place.swizzle {
                    picked = picked.iter().filter_map(|&k| before.get(usize::from(k)).copied()).collect();
                }
                let ty = Type::vector(*scalar, u8::try_from(picked.len()).unwrap_or(4));
                Ok(Some(self.components(place, ty, picked)))
            }
            // Components of a scalar are values.
            _ => Ok(None),
        }
    }

    /// Components of a vector; one alone is a place of its own.
    fn components(&mut self, place: Lvalue, ty: Type, picked: Vec<u8>) -> Lvalue {
        let [only] = picked[..] else {
            return Lvalue { ty, swizzle: Some(picked), ..place };
        };
        let host = self.build.element(place.host);
        let ptr = self.add(Expression::AccessIndex { base: place.ptr, index: u32::from(only) });
        Lvalue { ptr, ty, host, swizzle: None }
    }

    /// An element, column or component of a place.
    fn index(&mut self, place: Lvalue, index: ExprId) -> Result<Option<Lvalue>> {
        let Some(ty) = place.ty.indexed() else { return Ok(None) };
        let at = self.shader.expr(index).span;
        if let Some(k) = self.constant_index(index) {
            if place.ty.index_count().is_some_and(|n| k >= n) {
                return Err(self.out_of_bounds(k, at));
            }
            if let Some(picked) = &place.swizzle {
                let one = picked.get(k as usize).copied().into_iter().collect();
                return Ok(Some(self.components(place, ty, one)));
            }
            let host = self.build.element(place.host);
            let ptr = self.add(Expression::AccessIndex { base: place.ptr, index: k });
            return Ok(Some(Lvalue { ptr, ty, host, swizzle: None }));
        }
        if place.swizzle.is_some() {
            return Ok(None);
        }
        let index = self.expression(index)?.e;
        let host = self.build.element(place.host);
        let ptr = self.add(Expression::Access { base: place.ptr, index });
        Ok(Some(Lvalue { ptr, ty, host, swizzle: None }))
    }

    fn out_of_bounds(&self, k: u32, span: Span) -> Box<Diagnostic> {
        let message = format!("index {k} is out of bounds");
        Box::new(Diagnostic::new(VALIDATOR, Severity::Error, self.shader.file(), span, message))
    }

    /// An index that is known now.
    pub(super) fn constant_index(&self, index: ExprId) -> Option<u32> {
        if let Some(k) = self.chosen.get(&index) {
            return Some(*k);
        }
        self.shader.fold(index)?.as_integer().and_then(|n| u32::try_from(n).ok())
    }

    pub(super) fn load(&mut self, place: &Lvalue) -> Result<Val> {
        if let Some(parts) = self.parts_with_atomics(place)? {
            let ty = self.ty(&place.ty)?;
            let components = parts.iter().map(|part| Ok(self.load(part)?.e)).collect::<Result<_>>()?;
            return Ok(Val { e: self.add(Expression::Compose { ty, components }), ty: place.ty.clone() });
        }
        let e = self.add(Expression::Load { pointer: place.ptr });
        let Some(picked) = &place.swizzle else {
            let e = self.decoded(e, place.host, &place.ty)?;
            return self.byte_of(Val { e, ty: place.ty.clone() });
        };
        let whole = self.wider(&place.ty, place.host);
        let e = self.decoded(e, place.host, &whole)?;
        let picked = self.swizzle(&Val { e, ty: whole }, picked)?;
        self.byte_of(picked)
    }

    /// Where numbers of 8 bits take the place of those of 32, a host may have filled in more.
    fn byte_of(&mut self, value: Val) -> Result<Val> {
        let byte = value.ty.scalar().is_some_and(|s| s.bits() == 8);
        if byte && !self.build.widened.is_empty() { self.wrapped(value) } else { Ok(value) }
    }

    /// The parts of a structure or array that holds atomic integers: it is no value, but each of them is one.
    fn parts_with_atomics(&mut self, place: &Lvalue) -> Result<Option<Vec<Lvalue>>> {
        if self.build.is_atomic(place.host) || !self.build.holds_atomics(place.host) {
            return Ok(None);
        }
        let parts = self.parts_of(place.host, &place.ty)?;
        let part = |(index, (host, ty)): (u32, (Handle<NagaType>, Type))| {
            let ptr = self.add(Expression::AccessIndex { base: place.ptr, index });
            Lvalue { ptr, ty, host, swizzle: None }
        };
        Ok(Some((0..).zip(parts).map(part).collect()))
    }

    /// Type of the vector that a swizzle is taken of.
    fn wider(&self, ty: &Type, host: Handle<NagaType>) -> Type {
        let n = match self.build.module.types[host].inner {
            TypeInner::Vector { size, .. } => size as u8,
            _ => 1,
        };
        Type::vector(ty.scalar().unwrap_or(ScalarType::Float), n)
    }

    /// Writes a value of the place's type.
    pub(super) fn store(&mut self, place: &Lvalue, value: &Val) -> Result<()> {
        if let Some(parts) = self.parts_with_atomics(place)? {
            for (k, part) in (0..).zip(parts) {
                let e = self.part(value.e, k);
                self.store(&part, &Val { e, ty: part.ty.clone() })?;
            }
            return Ok(());
        }
        let Some(picked) = place.swizzle.clone() else {
            let value = self.encoded(value.e, place.host, &place.ty)?;
            self.push(Statement::Store { pointer: place.ptr, value });
            return Ok(());
        };
        let host = self.build.element(place.host);
        let scalar = Type::Scalar(place.ty.scalar().unwrap_or(ScalarType::Float));
        for (k, &c) in picked.iter().enumerate() {
            let part = self.part(value.e, u32::try_from(k).unwrap_or(0));
            let part = self.encoded(part, host, &scalar)?;
            let pointer = self.add(Expression::AccessIndex { base: place.ptr, index: u32::from(c) });
            self.push(Statement::Store { pointer, value: part });
        }
        Ok(())
    }

    /// Components of a value.
    pub(super) fn swizzle(&mut self, value: &Val, picked: &[u8]) -> Result<Val> {
        let scalar = value.ty.scalar().unwrap_or(ScalarType::Float);
        let n = u8::try_from(picked.len()).unwrap_or(4);
        let ty = Type::vector(scalar, n);
        if value.ty.is_scalar() {
            let e = if n == 1 { value.e } else { self.add(Expression::Splat { size: size(n), value: value.e }) };
            return Ok(Val { e, ty });
        }
        if let [only] = picked {
            return Ok(Val { e: self.part(value.e, u32::from(*only)), ty });
        }
        if picked.iter().enumerate().all(|(k, &c)| k == usize::from(c)) && n == count_u8(&value.ty) {
            return Ok(value.clone());
        }
        let mut pattern = [SwizzleComponent::X; 4];
        for (slot, &c) in pattern.iter_mut().zip(picked) {
            *slot = SwizzleComponent::XYZW[usize::from(c.min(3))];
        }
        let e = self.add(Expression::Swizzle { size: size(n), vector: value.e, pattern });
        Ok(Val { e, ty })
    }

    /// A value of memory as a value of the language: `bool` is stored as a number, and arrays may
    /// have other strides.
    fn decoded(&mut self, e: Expr, host: Handle<NagaType>, ty: &Type) -> Result<Expr> {
        let want = self.ty(ty)?;
        if host == want || (self.build.is_atomic(host) && ty.scalar() != Some(ScalarType::Bool)) {
            return Ok(e);
        }
        match ty {
            Type::Scalar(s) | Type::Vector(s, _) if s.is_small_integer() => {
                let kind = super::types::scalar(*s).kind;
                Ok(self.add(Expression::As { expr: e, kind, convert: Some(4) }))
            }
            Type::Scalar(ScalarType::Bool) | Type::Vector(ScalarType::Bool, _) => {
                let zero = self.all(&ty.with_scalar(ScalarType::Uint), 0.0)?.e;
                Ok(self.add(Expression::Binary { op: BinaryOperator::NotEqual, left: e, right: zero }))
            }
            _ => self.rebuild(e, host, ty, want, Self::decoded),
        }
    }

    fn encoded(&mut self, e: Expr, host: Handle<NagaType>, ty: &Type) -> Result<Expr> {
        let have = self.ty(ty)?;
        if host == have || (self.build.is_atomic(host) && ty.scalar() != Some(ScalarType::Bool)) {
            return Ok(e);
        }
        match ty {
            Type::Scalar(s) | Type::Vector(s, _) if s.is_small_integer() => {
                let kind = super::types::scalar(*s).kind;
                Ok(self.add(Expression::As { expr: e, kind, convert: Some(2) }))
            }
            Type::Scalar(ScalarType::Bool) | Type::Vector(ScalarType::Bool, _) => {
                Ok(self.add(Expression::As { expr: e, kind: ScalarKind::Uint, convert: Some(4) }))
            }
            _ => self.rebuild(e, host, ty, host, Self::encoded),
        }
    }

    /// Takes an array or structure apart and puts it together as another type.
    fn rebuild(
        &mut self,
        e: Expr,
        host: Handle<NagaType>,
        ty: &Type,
        result: Handle<NagaType>,
        each: fn(&mut Self, Expr, Handle<NagaType>, &Type) -> Result<Expr>,
    ) -> Result<Expr> {
        let mut components = Vec::new();
        for (k, (host, ty)) in self.parts_of(host, ty)?.into_iter().enumerate() {
            let part = self.add(Expression::AccessIndex { base: e, index: u32::try_from(k).unwrap_or(0) });
            components.push(each(self, part, host, &ty)?);
        }
        Ok(self.add(Expression::Compose { ty: result, components }))
    }

    /// The elements or members of a type in memory: as they lie there, and in the language.
    fn parts_of(&mut self, host: Handle<NagaType>, ty: &Type) -> Result<Vec<(Handle<NagaType>, Type)>> {
        match ty {
            Type::Array(element, _) => {
                let host = self.build.element(host);
                Ok(vec![(host, element.as_ref().clone()); count(ty) as usize])
            }
            Type::Struct(s) => {
                let members = self.build.members(host);
                let data = s.fields.iter().filter(|f| !f.ty.contains_opaque() || super::types::has_data(&f.ty));
                Ok(members.into_iter().zip(data.map(|f| f.ty.clone())).collect())
            }
            _ => {
                let message = format!("`{ty}` in memory of another layout");
                Err(self.build.unsupported(self.at, message, "copy its parts"))
            }
        }
    }

    /// A value in a variable of its own, so that a computed index can reach into it.
    pub(super) fn spill(&mut self, value: &Val) -> Result<Lvalue> {
        let place = self.local("sc_value", &value.ty)?;
        self.store(&place, value)?;
        Ok(place)
    }

    /// The value of `base.field`, `base[index]` or a name.
    pub(super) fn read(&mut self, id: ExprId) -> Result<Val> {
        if let Some(place) = self.place(id)? {
            return self.load(&place);
        }
        let expr = self.shader.expr(id);
        match &expr.kind {
            ExprKind::Name(name) => match self.variable(id, name, expr.span)? {
                Var::Value(value) => Ok(value),
                Var::Place(place) => self.load(&place),
                Var::Opaque(_) => Err(self.build.unsupported(
                    expr.span,
                    "a sampler or image as a value",
                    "pass it to a function that reads it",
                )),
            },
            ExprKind::Field { base, field } => {
                let value = self.expression(*base)?;
                if let Type::Struct(s) = &value.ty {
                    let found = Build::member_index(s, &field.name)
                        .zip(s.fields.iter().find(|f| f.name == field.name).map(|f| f.ty.clone()));
                    let Some((index, ty)) = found else {
                        return Err(self.build.unsupported(field.span, "an unknown member", "declare it"));
                    };
                    return Ok(Val { e: self.part(value.e, index), ty });
                }
                let Some(picked) = components(&field.name) else {
                    return Err(self.build.unsupported(field.span, "unknown components", "use `xyzw`"));
                };
                self.swizzle(&value, &picked)
            }
            ExprKind::Index { base, index } => {
                let value = self.expression(*base)?;
                let Some(ty) = value.ty.indexed() else {
                    return Err(self.build.unsupported(expr.span, "an index into this", "index an array"));
                };
                if let Some(k) = self.constant_index(*index) {
                    if k >= count(&value.ty) {
                        return Err(self.out_of_bounds(k, expr.span));
                    }
                    return Ok(Val { e: self.part(value.e, k), ty });
                }
                let place = self.spill(&value)?;
                match self.index(place, *index)? {
                    Some(place) => self.load(&place),
                    None => Err(self.build.unsupported(expr.span, "an index into this", "index an array")),
                }
            }
            _ => self.expression(id),
        }
    }

    /// The length of an array that is as long as its buffer.
    pub(super) fn array_length(&mut self, array: Expr) -> Expr {
        self.add(Expression::ArrayLength(array))
    }

    /// `base.length()`.
    pub(super) fn length(&mut self, base: ExprId) -> Result<Val> {
        let expr = self.shader.expr(base);
        let ty = match &expr.kind {
            ExprKind::Call { callee: Callee::Type(_), .. } => self.expression(base)?.ty,
            _ => match self.place(base)? {
                Some(place) => {
                    if matches!(
                        &self.build.module.types[place.host].inner,
                        TypeInner::Array { size: naga::ArraySize::Dynamic, .. }
                    ) {
                        let n = self.array_length(place.ptr);
                        let e = self.add(Expression::As { expr: n, kind: ScalarKind::Sint, convert: Some(4) });
                        return Ok(Val { e, ty: Type::INT });
                    }
                    place.ty
                }
                None => match self.opaque(base)? {
                    Some(opaque) => opaque.ty,
                    None => self.expression(base)?.ty,
                },
            },
        };
        let e = self.i32(i32::try_from(count(&ty)).unwrap_or(i32::MAX));
        Ok(Val { e, ty: Type::INT })
    }

    /// A value of another type, as an implicit conversion makes it.
    pub(super) fn convert(&mut self, value: Val, want: &Type) -> Result<Val> {
        if same(&value.ty, want) {
            return Ok(value);
        }
        let (Some(from), Some(to)) = (value.ty.scalar(), want.scalar()) else {
            let message = format!("`{}` where `{want}` is wanted", value.ty);
            return Err(self.build.unsupported(self.at, message, "convert it by a constructor"));
        };
        if value.ty.with_scalar(to) != *want {
            let message = format!("`{}` where `{want}` is wanted", value.ty);
            return Err(self.build.unsupported(self.at, message, "convert it by a constructor"));
        }
        self.cast(value, from, to)
    }

    /// Another component type; the size stays.
    pub(super) fn cast(&mut self, value: Val, from: ScalarType, to: ScalarType) -> Result<Val> {
        if from == to {
            return Ok(value);
        }
        let scalar = super::types::scalar(to);
        let ty = value.ty.with_scalar(to);
        if to.is_small_integer() || super::types::scalar(from) == scalar {
            // With 32 bits first.
            let plain = if to.is_signed() { ScalarType::Int } else { ScalarType::Uint };
            let same = super::types::scalar(from) == scalar;
            let e = if same { value.e } else { self.cast(value, from, plain)?.e };
            return self.wrapped(Val { e, ty });
        }
        if let Type::Matrix(_, columns, rows) = value.ty {
            let mut parts = Vec::new();
            for k in 0..columns {
                let e = self.part(value.e, u32::from(k));
                parts.push(self.cast(Val { e, ty: Type::Vector(from, rows) }, from, to)?.e);
            }
            return self.compose(&ty, parts);
        }
        let convert = Some(scalar.width);
        let e = self.add(Expression::As { expr: value.e, kind: scalar.kind, convert });
        Ok(Val { e, ty })
    }
}

fn count_u8(ty: &Type) -> u8 {
    u8::try_from(count(ty)).unwrap_or(4)
}
