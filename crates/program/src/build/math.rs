//! Built-in functions of numbers (GLSL 4.60, 8.1 to 8.8 and 8.14).

use naga::{
    BinaryOperator as B, DerivativeAxis, DerivativeControl, Expression, MathFunction as M, PredeclaredType,
    RelationalFunction, ScalarKind, UnaryOperator,
};

use super::function::{Fun, Val};
use super::types::{scalar, size};
use super::{Expr, Result};
use base::text::Span;
use syntax::BuiltinFunction as F;
use syntax::ast::{BinaryOp, ExprId};
use syntax::types::{ScalarType, Type};

/// The name in GLSL of a function that takes each component of one argument to a number.
pub(crate) fn name_of_each(fun: M) -> Option<&'static str> {
    let exact = F::ALL.iter().filter(|f| **f != F::Round);
    exact.copied().find(|&f| each(f) == Some(fun)).map(F::name)
}

/// Functions that take each component of one argument to a number, which naga has under another name or the same.
fn each(function: F) -> Option<M> {
    Some(match function {
        F::Sin => M::Sin,
        F::Cos => M::Cos,
        F::Tan => M::Tan,
        F::Asin => M::Asin,
        F::Acos => M::Acos,
        F::Sinh => M::Sinh,
        F::Cosh => M::Cosh,
        F::Tanh => M::Tanh,
        F::Asinh => M::Asinh,
        F::Acosh => M::Acosh,
        F::Atanh => M::Atanh,
        F::Radians => M::Radians,
        F::Degrees => M::Degrees,
        F::Exp => M::Exp,
        F::Log => M::Log,
        F::Exp2 => M::Exp2,
        F::Log2 => M::Log2,
        F::Sqrt => M::Sqrt,
        F::Inversesqrt => M::InverseSqrt,
        F::Abs => M::Abs,
        F::Sign => M::Sign,
        F::Floor => M::Floor,
        F::Ceil => M::Ceil,
        F::Trunc => M::Trunc,
        // Where a half goes is up to the implementation; `roundEven` is one choice for both.
        F::Round | F::RoundEven => M::Round,
        F::Fract => M::Fract,
        _ => return None,
    })
}

/// The other functions of one argument that naga has.
fn one(function: F) -> Option<M> {
    Some(match function {
        F::Transpose => M::Transpose,
        F::Determinant => M::Determinant,
        F::Inverse => M::Inverse,
        F::BitfieldReverse => M::ReverseBits,
        F::PackSnorm4x8 => M::Pack4x8snorm,
        F::PackUnorm4x8 => M::Pack4x8unorm,
        F::PackSnorm2x16 => M::Pack2x16snorm,
        F::PackUnorm2x16 => M::Pack2x16unorm,
        F::PackHalf2x16 => M::Pack2x16float,
        F::UnpackSnorm4x8 => M::Unpack4x8snorm,
        F::UnpackUnorm4x8 => M::Unpack4x8unorm,
        F::UnpackSnorm2x16 => M::Unpack2x16snorm,
        F::UnpackUnorm2x16 => M::Unpack2x16unorm,
        F::UnpackHalf2x16 => M::Unpack2x16float,
        _ => return None,
    })
}

/// The type of a function's value, with the component type of its argument where they go together: not where bits are
/// packed.
fn kept(ty: &Type, argument: &Type, fun: M) -> Type {
    let packs = matches!(fun, M::Pack4x8snorm | M::Pack4x8unorm | M::Pack2x16snorm | M::Pack2x16unorm)
        || matches!(fun, M::Pack2x16float | M::Unpack2x16float | M::Unpack4x8snorm | M::Unpack4x8unorm)
        || matches!(fun, M::Unpack2x16snorm | M::Unpack2x16unorm);
    match (ty.scalar(), argument.scalar()) {
        (Some(_), Some(s)) if !packs => ty.with_scalar(s),
        _ => ty.clone(),
    }
}

impl Fun<'_, '_> {
    pub(super) fn math(&mut self, fun: M, args: &[Expr]) -> Expr {
        let at = |k: usize| args.get(k).copied();
        self.add(Expression::Math { fun, arg: args[0], arg1: at(1), arg2: at(2), arg3: at(3) })
    }

    fn op(&mut self, op: B, left: Expr, right: Expr) -> Expr {
        self.add(Expression::Binary { op, left, right })
    }

    /// A built-in function; none for one without a value.
    pub(super) fn builtin(&mut self, id: ExprId, function: F, args: &[ExprId], span: Span) -> Result<Option<Val>> {
        if let Some(value) = self.texture_call(id, function, args, span)? {
            return Ok(value);
        }
        if let Some(value) = self.effect(function, args, span)? {
            return Ok(value);
        }
        if let Some(value) = self.subgroup(function, args, span)? {
            return Ok(value);
        }
        let ty = self.shader.type_of(id).clone();
        let mut values = Vec::new();
        for &arg in args {
            values.push(self.expression(arg)?);
        }
        self.function_of_numbers(function, &ty, values, span).map(Some)
    }

    /// All values with the widest component type, scalars in every component.
    fn alike(&mut self, values: Vec<Val>) -> Result<Vec<Val>> {
        let to = values.iter().filter_map(|v| v.ty.scalar()).max().unwrap_or(ScalarType::Float);
        let widest = values.iter().map(|v| v.ty.with_scalar(to)).max_by_key(|t| t.components().unwrap_or(1));
        let widest = widest.unwrap_or(Type::FLOAT);
        let mut all = Vec::new();
        for value in values {
            let from = value.ty.scalar().unwrap_or(to);
            let value = self.cast(value, from, to)?;
            all.push(self.widened(value, &widest));
        }
        Ok(all)
    }

    /// Numbers as `float`, or as what the widest of them is that is no whole number.
    fn floating(&mut self, values: Vec<Val>) -> Result<Vec<Val>> {
        let kinds = values.iter().filter_map(|v| v.ty.scalar()).filter(|s| s.is_floating());
        let to = kinds.max().unwrap_or(ScalarType::Float);
        let mut all = Vec::new();
        for value in values {
            let from = value.ty.scalar().unwrap_or(to);
            all.push(self.cast(value, from, to)?);
        }
        Ok(all)
    }

    /// A number as `float`.
    fn as_float(&mut self, value: Val) -> Result<Val> {
        let from = value.ty.scalar().unwrap_or(ScalarType::Float);
        self.cast(value, from, ScalarType::Float)
    }

    /// Whole numbers as `uint`.
    fn words(&mut self, values: Vec<Val>) -> Result<Vec<Val>> {
        values
            .into_iter()
            .map(|value| {
                let from = value.ty.scalar().unwrap_or(ScalarType::Uint);
                self.cast(value, from, ScalarType::Uint)
            })
            .collect()
    }

    fn function_of_numbers(&mut self, function: F, ty: &Type, values: Vec<Val>, span: Span) -> Result<Val> {
        if let Some(value) = self.bits(function, &values)? {
            return Ok(value);
        }
        if let Some(value) = self.repacked(function, ty, &values)? {
            return Ok(value);
        }
        if let Some(value) = self.comparison(function, &values)? {
            return Ok(value);
        }
        if let Some(fun) = each(function).or_else(|| one(function)) {
            return self.of_one(function, fun, ty, values);
        }
        match function {
            F::Mix if values[2].ty.scalar() == Some(ScalarType::Bool) => {
                let pair = self.alike(values[..2].to_vec())?;
                let (condition, accept, reject) = (values[2].e, pair[1].e, pair[0].e);
                let e = self.add(Expression::Select { condition, accept, reject });
                Ok(Val { e, ty: pair[0].ty.clone() })
            }
            F::Min | F::Max | F::Clamp | F::Pow | F::Mix | F::Step | F::Smoothstep | F::Fma => {
                let (fun, whole) = match function {
                    F::Min => (M::Min, true),
                    F::Max => (M::Max, true),
                    F::Clamp => (M::Clamp, true),
                    F::Pow => (M::Pow, false),
                    F::Mix => (M::Mix, false),
                    F::Step => (M::Step, false),
                    F::Smoothstep => (M::SmoothStep, false),
                    _ => (M::Fma, false),
                };
                let values = if whole { values } else { self.floating(values)? };
                let values = self.alike(values)?;
                let e: Vec<Expr> = values.iter().map(|v| v.e).collect();
                Ok(Val { e: self.math(fun, &e), ty: values[0].ty.clone() })
            }
            F::Ldexp => {
                let exponent = values[1].e;
                let value = self.floating(vec![values[0].clone()])?.remove(0);
                Ok(Val { e: self.math(M::Ldexp, &[value.e, exponent]), ty: value.ty })
            }
            F::Atan => {
                let values = self.floating(values)?;
                let e: Vec<Expr> = values.iter().map(|v| v.e).collect();
                let fun = if e.len() == 2 { M::Atan2 } else { M::Atan };
                Ok(Val { e: self.math(fun, &e), ty: values[0].ty.clone() })
            }
            // x − y⌊x/y⌋ (GLSL 4.60, 8.3).
            F::Mod => {
                let values = self.floating(values)?;
                let values = self.alike(values)?;
                let (x, y) = (values[0].e, values[1].e);
                let ratio = self.op(B::Divide, x, y);
                let floor = self.math(M::Floor, &[ratio]);
                let whole = self.op(B::Multiply, y, floor);
                Ok(Val { e: self.op(B::Subtract, x, whole), ty: values[0].ty.clone() })
            }
            F::Isnan | F::Isinf => {
                let fun = if function == F::Isnan { RelationalFunction::IsNan } else { RelationalFunction::IsInf };
                let value = self.floating(values)?.remove(0);
                let e = self.add(Expression::Relational { fun, argument: value.e });
                Ok(Val { e, ty: value.ty.with_scalar(ScalarType::Bool) })
            }
            F::MatrixCompMult => {
                let Type::Matrix(s, columns, rows) = values[0].ty else {
                    return Err(self.build.unsupported(span, "`matrixCompMult` of this", "use matrices"));
                };
                let mut parts = Vec::new();
                for k in 0..u32::from(columns) {
                    let (l, r) = (self.part(values[0].e, k), self.part(values[1].e, k));
                    parts.push(self.op(B::Multiply, l, r));
                }
                self.compose(&Type::Matrix(s, columns, rows), parts)
            }
            F::OuterProduct => {
                let values = self.floating(values)?;
                let (&Type::Vector(s, rows), &Type::Vector(_, columns)) = (&values[0].ty, &values[1].ty) else {
                    return Err(self.build.unsupported(span, "`outerProduct` of this", "use vectors"));
                };
                let mut parts = Vec::new();
                for k in 0..u32::from(columns) {
                    let factor = self.part(values[1].e, k);
                    parts.push(self.op(B::Multiply, values[0].e, factor));
                }
                self.compose(&Type::Matrix(s, columns, rows), parts)
            }
            F::Ftransform => {
                let matrix = self.state("gl_ModelViewProjectionMatrix", span)?;
                let vertex = self.state("gl_Vertex", span)?;
                self.binary(BinaryOp::Mul, matrix, vertex)
            }
            F::Dot | F::Length | F::Distance | F::Normalize | F::Cross | F::Reflect | F::Refract | F::Faceforward => {
                self.geometric(function, values)
            }
            _ => self.derivative(function, values, span),
        }
    }

    /// A function of one argument that naga has.
    fn of_one(&mut self, function: F, fun: M, ty: &Type, values: Vec<Val>) -> Result<Val> {
        let whole = matches!(function, F::Abs | F::Sign) && values[0].ty.scalar().is_some_and(ScalarType::is_signed);
        let values = match fun {
            M::ReverseBits => values,
            // The packed word is a `uint`, to which an `int` is converted.
            M::Unpack4x8snorm | M::Unpack4x8unorm | M::Unpack2x16snorm | M::Unpack2x16unorm | M::Unpack2x16float => {
                self.words(values)?
            }
            _ if whole => values,
            M::Pack4x8snorm | M::Pack4x8unorm | M::Pack2x16snorm | M::Pack2x16unorm | M::Pack2x16float => {
                vec![self.as_float(values[0].clone())?]
            }
            _ => self.floating(values)?,
        };
        let e = self.math(fun, &[values[0].e]);
        let ty = if ty.is_error() { values[0].ty.clone() } else { kept(ty, &values[0].ty, fun) };
        if whole { self.wrapped(Val { e, ty }) } else { Ok(Val { e, ty }) }
    }

    /// How much a value differs between neighbours (GLSL 4.60, 8.14).
    fn derivative(&mut self, function: F, values: Vec<Val>, span: Span) -> Result<Val> {
        let (axis, ctrl) = match function {
            F::DFdx => (DerivativeAxis::X, DerivativeControl::None),
            F::DFdxCoarse => (DerivativeAxis::X, DerivativeControl::Coarse),
            F::DFdxFine => (DerivativeAxis::X, DerivativeControl::Fine),
            F::DFdy => (DerivativeAxis::Y, DerivativeControl::None),
            F::DFdyCoarse => (DerivativeAxis::Y, DerivativeControl::Coarse),
            F::DFdyFine => (DerivativeAxis::Y, DerivativeControl::Fine),
            F::Fwidth => (DerivativeAxis::Width, DerivativeControl::None),
            F::FwidthCoarse => (DerivativeAxis::Width, DerivativeControl::Coarse),
            F::FwidthFine => (DerivativeAxis::Width, DerivativeControl::Fine),
            _ => return Err(self.build.unsupported(span, format!("the function `{function}`"), "write it out")),
        };
        let value = self.floating(values)?.remove(0);
        if self.build.makes_quads() {
            return self.quad_derivative(axis, value, span);
        }
        if self.build.run {
            self.build.differs = true;
            self.build.ports.unfed.push((format!("`{function}` outside of the `main` of a fragment shader"), span));
        }
        Ok(Val { e: self.add(Expression::Derivative { axis, ctrl, expr: value.e }), ty: value.ty })
    }

    /// Functions of vectors, which take numbers too (GLSL 4.60, 8.5).
    fn geometric(&mut self, function: F, values: Vec<Val>) -> Result<Val> {
        let values = self.floating(values)?;
        let first = values[0].ty.clone();
        let scalar = Type::Scalar(first.scalar().unwrap_or(ScalarType::Float));
        let e: Vec<Expr> = values.iter().map(|v| v.e).collect();
        if !first.is_scalar() {
            let (fun, ty) = match function {
                F::Dot => (M::Dot, scalar),
                F::Length => (M::Length, scalar),
                F::Distance => (M::Distance, scalar),
                F::Normalize => (M::Normalize, first),
                F::Cross => (M::Cross, first),
                F::Reflect => (M::Reflect, first),
                F::Refract => (M::Refract, first),
                _ => (M::FaceForward, first),
            };
            return Ok(Val { e: self.math(fun, &e), ty });
        }
        let value = match function {
            F::Dot => self.op(B::Multiply, e[0], e[1]),
            F::Length => self.math(M::Abs, &[e[0]]),
            F::Distance => {
                let difference = self.op(B::Subtract, e[0], e[1]);
                self.math(M::Abs, &[difference])
            }
            // x/|x|, which is not a number for 0.
            F::Normalize => {
                let length = self.math(M::Abs, &[e[0]]);
                self.op(B::Divide, e[0], length)
            }
            F::Reflect => {
                let dot = self.op(B::Multiply, e[1], e[0]);
                let two = self.all(&scalar, 2.0)?.e;
                let twice = self.op(B::Multiply, two, dot);
                let part = self.op(B::Multiply, twice, e[1]);
                self.op(B::Subtract, e[0], part)
            }
            F::Faceforward => {
                let dot = self.op(B::Multiply, e[2], e[1]);
                let zero = self.all(&scalar, 0.0)?.e;
                let condition = self.op(B::Less, dot, zero);
                let reject = self.add(Expression::Unary { op: UnaryOperator::Negate, expr: e[0] });
                self.add(Expression::Select { condition, accept: e[0], reject })
            }
            // k = 1 − η²(1 − (N·I)²); 0 where k < 0, else ηI − (η(N·I) + √k)N.
            _ => {
                let (one, zero) = (self.all(&scalar, 1.0)?.e, self.all(&scalar, 0.0)?.e);
                let dot = self.op(B::Multiply, e[1], e[0]);
                let square = self.op(B::Multiply, dot, dot);
                let rest = self.op(B::Subtract, one, square);
                let eta2 = self.op(B::Multiply, e[2], e[2]);
                let product = self.op(B::Multiply, eta2, rest);
                let k = self.op(B::Subtract, one, product);
                let condition = self.op(B::Less, k, zero);
                let safe = self.math(M::Max, &[k, zero]);
                let root = self.math(M::Sqrt, &[safe]);
                let along = self.op(B::Multiply, e[2], dot);
                let sum = self.op(B::Add, along, root);
                let normal = self.op(B::Multiply, sum, e[1]);
                let incident = self.op(B::Multiply, e[2], e[0]);
                let reject = self.op(B::Subtract, incident, normal);
                self.add(Expression::Select { condition, accept: zero, reject })
            }
        };
        Ok(Val { e: value, ty: scalar })
    }

    /// Comparisons of vectors, and what is made of them (GLSL 4.60, 8.7).
    fn comparison(&mut self, function: F, values: &[Val]) -> Result<Option<Val>> {
        let op = match function {
            F::LessThan => B::Less,
            F::LessThanEqual => B::LessEqual,
            F::GreaterThan => B::Greater,
            F::GreaterThanEqual => B::GreaterEqual,
            F::Equal => B::Equal,
            F::NotEqual => B::NotEqual,
            F::Any | F::All => {
                let fun = if function == F::Any { RelationalFunction::Any } else { RelationalFunction::All };
                let e = self.add(Expression::Relational { fun, argument: values[0].e });
                return Ok(Some(Val { e, ty: Type::BOOL }));
            }
            F::Not => {
                let e = self.add(Expression::Unary { op: UnaryOperator::LogicalNot, expr: values[0].e });
                return Ok(Some(Val { e, ty: values[0].ty.clone() }));
            }
            _ => return Ok(None),
        };
        let pair = self.alike(values.to_vec())?;
        let e = self.op(op, pair[0].e, pair[1].e);
        Ok(Some(Val { e, ty: pair[0].ty.with_scalar(ScalarType::Bool) }))
    }

    /// Bits and integers (GLSL 4.60, 8.3 and 8.8).
    fn bits(&mut self, function: F, values: &[Val]) -> Result<Option<Val>> {
        let value = match function {
            F::FloatBitsToInt | F::FloatBitsToUint | F::IntBitsToFloat | F::UintBitsToFloat => {
                let to = match function {
                    F::FloatBitsToInt => ScalarType::Int,
                    F::FloatBitsToUint => ScalarType::Uint,
                    _ => ScalarType::Float,
                };
                // A whole number becomes a `float` first.
                let value = match function {
                    F::FloatBitsToInt | F::FloatBitsToUint => self.as_float(values[0].clone())?,
                    _ => values[0].clone(),
                };
                let e = self.add(Expression::As { expr: value.e, kind: scalar(to).kind, convert: None });
                Val { e, ty: value.ty.with_scalar(to) }
            }
            F::BitCount | F::FindLSB | F::FindMSB => {
                let fun = match function {
                    F::BitCount => M::CountOneBits,
                    F::FindLSB => M::FirstTrailingBit,
                    _ => M::FirstLeadingBit,
                };
                let first = values[0].ty.clone();
                let e = self.math(fun, &[values[0].e]);
                let from = first.scalar().unwrap_or(ScalarType::Int);
                self.cast(Val { e, ty: first }, from, ScalarType::Int)?
            }
            F::BitfieldExtract | F::BitfieldInsert => {
                let split = values.len() - 2;
                let parts = self.alike(values[..split].to_vec())?;
                let mut e: Vec<Expr> = parts.iter().map(|v| v.e).collect();
                for value in &values[split..] {
                    e.push(self.cast(value.clone(), ScalarType::Int, ScalarType::Uint)?.e);
                }
                let fun = if split == 1 { M::ExtractBits } else { M::InsertBits };
                Val { e: self.math(fun, &e), ty: parts[0].ty.clone() }
            }
            _ => return Ok(None),
        };
        Ok(Some(value))
    }

    /// Functions that write through their arguments: `modf`, `frexp`, carries and wide products.
    pub(super) fn several_values(&mut self, function: F, args: &[ExprId]) -> Result<Option<Val>> {
        match function {
            F::Modf | F::Frexp => {
                let value = self.expression(args[0])?;
                let value = self.floating(vec![value])?.remove(0);
                let target = self.target(args[1])?;
                let (vector, number) = match &value.ty {
                    Type::Vector(s, n) => (Some(size(*n)), *s),
                    other => (None, other.scalar().unwrap_or(ScalarType::Float)),
                };
                let number = scalar(number);
                let (fun, structure) = if function == F::Modf {
                    (M::Modf, PredeclaredType::ModfResult { size: vector, scalar: number })
                } else {
                    (M::Frexp, PredeclaredType::FrexpResult { size: vector, scalar: number })
                };
                self.build.module.generate_predeclared_type(structure);
                let both = self.math(fun, &[value.e]);
                let (fraction, second) = (
                    self.add(Expression::AccessIndex { base: both, index: 0 }),
                    self.add(Expression::AccessIndex { base: both, index: 1 }),
                );
                let second_ty =
                    if function == F::Modf { value.ty.clone() } else { value.ty.with_scalar(ScalarType::Int) };
                let second = self.convert(Val { e: second, ty: second_ty }, &target.ty)?;
                self.store(&target, &second)?;
                Ok(Some(Val { e: fraction, ty: value.ty }))
            }
            F::UaddCarry | F::UsubBorrow => {
                let values = vec![self.expression(args[0])?, self.expression(args[1])?];
                let values = self.words(values)?;
                let (x, y) = (&values[0], &values[1]);
                let target = self.target(args[2])?;
                let (op, compare) =
                    if function == F::UaddCarry { (B::Add, (None, x.e)) } else { (B::Subtract, (Some(x.e), y.e)) };
                let result = self.op(op, x.e, y.e);
                // A sum that is smaller than its part has wrapped, and so has x − y where x < y.
                let over = self.op(B::Less, compare.0.unwrap_or(result), compare.1);
                let carry = self.add(Expression::As { expr: over, kind: ScalarKind::Uint, convert: Some(4) });
                self.store(&target, &Val { e: carry, ty: x.ty.clone() })?;
                Ok(Some(Val { e: result, ty: x.ty.clone() }))
            }
            F::UmulExtended | F::ImulExtended => {
                let mut values = vec![self.expression(args[0])?, self.expression(args[1])?];
                if function == F::UmulExtended {
                    values = self.words(values)?;
                }
                let (x, y) = (&values[0], &values[1]);
                let (high, low) = (self.target(args[2])?, self.target(args[3])?);
                let (h, l) = self.wide_product(x, y)?;
                self.store(&high, &h)?;
                self.store(&low, &l)?;
                Ok(None)
            }
            _ => Ok(None),
        }
    }

    /// Upper and lower 32 bits of a product, from products of 16 bits.
    fn wide_product(&mut self, x: &Val, y: &Val) -> Result<(Val, Val)> {
        let signed = x.ty.scalar() == Some(ScalarType::Int);
        let ty = x.ty.with_scalar(ScalarType::Uint);
        let from = x.ty.scalar().unwrap_or(ScalarType::Uint);
        let a = self.cast(x.clone(), from, ScalarType::Uint)?.e;
        let b = self.cast(y.clone(), from, ScalarType::Uint)?.e;
        let (half, mask) = (self.all(&ty, 16.0)?.e, self.all(&ty, 65535.0)?.e);
        let (al, bl) = (self.op(B::And, a, mask), self.op(B::And, b, mask));
        let (ah, bh) = (self.op(B::ShiftRight, a, half), self.op(B::ShiftRight, b, half));
        let ll = self.op(B::Multiply, al, bl);
        let lh = self.op(B::Multiply, al, bh);
        let hl = self.op(B::Multiply, ah, bl);
        let hh = self.op(B::Multiply, ah, bh);
        // No sum exceeds 32 bits: (2¹⁶−1)² + 2(2¹⁶−1) = 2³² − 1.
        let carry = self.op(B::ShiftRight, ll, half);
        let middle = self.op(B::Add, lh, carry);
        let middle_low = self.op(B::And, middle, mask);
        let middle = self.op(B::ShiftRight, middle, half);
        let second = self.op(B::Add, hl, middle_low);
        let second = self.op(B::ShiftRight, second, half);
        let high = self.op(B::Add, hh, middle);
        let mut high = self.op(B::Add, high, second);
        let low = self.op(B::Multiply, a, b);
        if signed {
            // A negative factor counts 2³² too much: the other one is taken off the upper half.
            let zero = self.all(&x.ty, 0.0)?.e;
            let none = self.all(&ty, 0.0)?.e;
            for (factor, other) in [(x.e, b), (y.e, a)] {
                let condition = self.op(B::Less, factor, zero);
                let part = self.add(Expression::Select { condition, accept: other, reject: none });
                high = self.op(B::Subtract, high, part);
            }
        }
        let back = |f: &mut Self, e| f.cast(Val { e, ty: ty.clone() }, ScalarType::Uint, from);
        Ok((back(self, high)?, back(self, low)?))
    }
}
