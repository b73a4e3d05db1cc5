//! Constructors (GLSL 4.60, 5.4).

use naga::Expression;

use super::expression::{inner_sizes, sized_by};
use super::function::{Fun, Val};
use super::types::size;
use super::{Expr, Result};
use syntax::ast::ExprId;
use syntax::types::{ScalarType, Type};

impl Fun<'_, '_> {
    pub(super) fn constructor(&mut self, ty: &Type, args: &[ExprId]) -> Result<Val> {
        match ty {
            Type::Array(element, _) => {
                let ty = sized_by(ty, args.len());
                let mut values = Vec::new();
                for &arg in args {
                    values.push(self.initial(arg, element)?);
                }
                let ty = inner_sizes(ty, &values);
                self.compose(&ty, values.into_iter().map(|v| v.e).collect())
            }
            Type::Struct(s) => {
                let mut components = Vec::new();
                for (field, &arg) in s.fields.iter().zip(args) {
                    components.push(self.initial(arg, &field.ty)?.e);
                }
                self.compose(ty, components)
            }
            Type::Scalar(_) | Type::Vector(..) | Type::Matrix(..) => {
                let mut values = Vec::new();
                for &arg in args {
                    values.push(self.expression(arg)?);
                }
                self.numbers(ty, values)
            }
            Type::Opaque(_) | Type::Void | Type::Error => {
                Err(self.build.unsupported(self.at, format!("a constructor of `{ty}`"), "use another type"))
            }
        }
    }

    /// A scalar, vector or matrix out of numbers.
    pub(super) fn numbers(&mut self, ty: &Type, values: Vec<Val>) -> Result<Val> {
        let scalar = ty.scalar().unwrap_or(ScalarType::Float);
        let mut cast = Vec::new();
        for value in values {
            let Some(from) = value.ty.scalar() else {
                let message = format!("`{ty}` out of `{}`", value.ty);
                return Err(self.build.unsupported(self.at, message, "use numbers"));
            };
            if let (Type::Matrix(_, columns, rows), false) = (&value.ty, scalar.is_floating()) {
                // There are no matrices of whole numbers: the columns are turned one by one.
                for k in 0..*columns {
                    let column = Val { e: self.part(value.e, u32::from(k)), ty: Type::Vector(from, *rows) };
                    cast.push(self.cast(column, from, scalar)?);
                }
                continue;
            }
            cast.push(self.cast(value, from, scalar)?);
        }
        if let ([only], false) = (&cast[..], matches!(ty, Type::Scalar(_))) {
            match (ty, &only.ty) {
                (Type::Vector(_, n), Type::Scalar(_)) => {
                    let e = self.add(Expression::Splat { size: size(*n), value: only.e });
                    return Ok(Val { e, ty: ty.clone() });
                }
                (Type::Vector(_, n), Type::Vector(..)) => {
                    return self.swizzle(&only.clone(), &(0..*n).collect::<Vec<_>>());
                }
                (Type::Matrix(_, columns, rows), Type::Scalar(_)) => return self.diagonal(*columns, *rows, only),
                (Type::Matrix(_, columns, rows), Type::Matrix(..)) => return self.resized(*columns, *rows, only),
                _ => {}
            }
        }
        // Vectors go in as they are when nothing is left over.
        let whole: usize = cast.iter().filter_map(|v| v.ty.components()).sum();
        if let Type::Vector(_, n) = ty
            && whole == usize::from(*n)
            && cast.iter().all(|v| !matches!(v.ty, Type::Matrix(..)))
        {
            return self.compose(ty, cast.into_iter().map(|v| v.e).collect());
        }
        let wanted = ty.components().unwrap_or(1);
        let mut parts: Vec<Expr> = Vec::new();
        for value in &cast {
            self.flatten(value, wanted, &mut parts);
        }
        if parts.len() < wanted {
            let message = format!("`{ty}` out of {} numbers", parts.len());
            return Err(self.build.unsupported(self.at, message, "give the missing components"));
        }
        match ty {
            Type::Scalar(_) => Ok(Val { e: parts[0], ty: ty.clone() }),
            Type::Matrix(_, _, rows) => {
                let column = Type::Vector(scalar, *rows);
                let mut columns = Vec::new();
                for chunk in parts.chunks(usize::from(*rows)) {
                    columns.push(self.compose(&column, chunk.to_vec())?.e);
                }
                self.compose(ty, columns)
            }
            _ => self.compose(ty, parts),
        }
    }

    /// The components of a value in order, until `wanted` are there.
    fn flatten(&mut self, value: &Val, wanted: usize, parts: &mut Vec<Expr>) {
        let (columns, rows) = match value.ty {
            Type::Matrix(_, columns, rows) => (columns, rows),
            Type::Vector(_, n) => (1, n),
            _ => (1, 1),
        };
        for c in 0..columns {
            for r in 0..rows {
                if parts.len() >= wanted {
                    return;
                }
                let column =
                    if matches!(value.ty, Type::Matrix(..)) { self.part(value.e, u32::from(c)) } else { value.e };
                parts.push(if value.ty.is_scalar() { column } else { self.part(column, u32::from(r)) });
            }
        }
    }

    fn diagonal(&mut self, columns: u8, rows: u8, value: &Val) -> Result<Val> {
        let scalar = value.ty.scalar().unwrap_or(ScalarType::Float);
        let zero = self.number(scalar, 0.0);
        let mut all = Vec::new();
        for c in 0..columns {
            let parts = (0..rows).map(|r| if r == c { value.e } else { zero }).collect();
            all.push(self.compose(&Type::Vector(scalar, rows), parts)?.e);
        }
        self.compose(&Type::Matrix(scalar, columns, rows), all)
    }

    /// A matrix of another size: what is missing comes from the identity.
    fn resized(&mut self, columns: u8, rows: u8, value: &Val) -> Result<Val> {
        let Type::Matrix(scalar, have_columns, have_rows) = value.ty else { return Ok(value.clone()) };
        let mut all = Vec::new();
        for c in 0..columns {
            let column = (c < have_columns).then(|| self.part(value.e, u32::from(c)));
            let mut parts = Vec::new();
            for r in 0..rows {
                parts.push(match column.filter(|_| r < have_rows) {
                    Some(column) => self.part(column, u32::from(r)),
                    None => self.number(scalar, if r == c { 1.0 } else { 0.0 }),
                });
            }
            all.push(self.compose(&Type::Vector(scalar, rows), parts)?.e);
        }
        self.compose(&Type::Matrix(scalar, columns, rows), all)
    }
}
