//! Numbers taken apart into smaller ones and put together (GL_EXT_shader_explicit_arithmetic_types, 8.4).

use naga::{BinaryOperator as B, Expression, MathFunction as M, ScalarKind};

use super::function::{Fun, Val};
use super::{Expr, Result};
use syntax::BuiltinFunction as F;
use syntax::types::{ScalarType, Type};

impl Fun<'_, '_> {
    /// A function that keeps all bits: `None` when it is no such function.
    pub(super) fn repacked(&mut self, function: F, ty: &Type, values: &[Val]) -> Result<Option<Val>> {
        let float2 = Type::VEC2;
        Ok(Some(match function {
            F::Pack16 | F::Pack32 => self.put_together(ty, &values[0])?,
            F::Unpack8 | F::Unpack16 => self.taken_apart(ty, &values[0])?,
            F::PackFloat2x16 => {
                let wide = self.cast(values[0].clone(), ScalarType::Half, ScalarType::Float)?;
                Val { e: self.math(M::Pack2x16float, &[wide.e]), ty: Type::UINT }
            }
            F::UnpackFloat2x16 => {
                let e = self.math(M::Unpack2x16float, &[values[0].e]);
                self.cast(Val { e, ty: float2 }, ScalarType::Float, ScalarType::Half)?
            }
            F::Float16BitsToInt16
            | F::Float16BitsToUint16
            | F::HalfBitsToInt16
            | F::HalfBitsToUint16
            | F::Int16BitsToFloat16
            | F::Int16BitsToHalf
            | F::Uint16BitsToFloat16
            | F::Uint16BitsToHalf => {
                let n = values[0].ty.components().unwrap_or(1);
                let mut parts = Vec::new();
                for k in 0..n {
                    let part = if n == 1 { values[0].e } else { self.part(values[0].e, u32::try_from(k).unwrap_or(0)) };
                    let from = Val { e: part, ty: Type::Scalar(values[0].ty.scalar().unwrap_or(ScalarType::Half)) };
                    parts.push(self.same_bits(from, ty.scalar().unwrap_or(ScalarType::Half))?);
                }
                match parts[..] {
                    [only] => Val { e: only, ty: ty.clone() },
                    _ => self.compose(ty, parts)?,
                }
            }
            _ => return Ok(None),
        }))
    }

    /// A number of binary16 as a whole number, or the other way round, by way of a word that holds two.
    fn same_bits(&mut self, from: Val, to: ScalarType) -> Result<Expr> {
        let kind = from.ty.scalar().unwrap_or(ScalarType::Half);
        if to == ScalarType::Half {
            let word = self.cast(from, kind, ScalarType::Uint)?.e;
            let both = self.math(M::Unpack2x16float, &[word]);
            let e = self.part(both, 0);
            return Ok(self.cast(Val { e, ty: Type::FLOAT }, ScalarType::Float, to)?.e);
        }
        let wide = self.cast(from, kind, ScalarType::Float)?.e;
        let zero = self.number(ScalarType::Float, 0.0);
        let pair = self.compose(&Type::VEC2, vec![wide, zero])?.e;
        let word = self.math(M::Pack2x16float, &[pair]);
        Ok(self.cast(Val { e: word, ty: Type::UINT }, ScalarType::Uint, to)?.e)
    }

    /// The components of a vector behind each other, the first one lowest.
    fn put_together(&mut self, ty: &Type, vector: &Val) -> Result<Val> {
        let kind = vector.ty.scalar().unwrap_or(ScalarType::Uint8);
        let words = self.cast(vector.clone(), kind, ScalarType::Uint)?;
        let mut all = self.word(0);
        let count = self.word(kind.bits());
        for k in 0..u32::try_from(vector.ty.components().unwrap_or(1)).unwrap_or(1) {
            let (part, offset) = (self.part(words.e, k), self.word(k * kind.bits()));
            all = self.math(M::InsertBits, &[all, part, offset, count]);
        }
        self.cast(Val { e: all, ty: Type::UINT }, ScalarType::Uint, ty.scalar().unwrap_or(ScalarType::Uint))
    }

    /// The parts of a number, the lowest one first.
    fn taken_apart(&mut self, ty: &Type, number: &Val) -> Result<Val> {
        let (kind, bits) = (ty.scalar().unwrap_or(ScalarType::Uint8), ty.scalar().map_or(8, ScalarType::bits));
        let mut word = number.e;
        if number.ty.scalar().is_some_and(ScalarType::is_signed) {
            word = self.add(Expression::As { expr: word, kind: ScalarKind::Uint, convert: Some(4) });
        }
        let mut parts = Vec::new();
        for k in 0..u32::try_from(ty.components().unwrap_or(1)).unwrap_or(1) {
            let places = self.word(k * bits);
            let moved = self.add(Expression::Binary { op: B::ShiftRight, left: word, right: places });
            parts.push(self.cast(Val { e: moved, ty: Type::UINT }, ScalarType::Uint, kind)?.e);
        }
        self.compose(ty, parts)
    }
}
