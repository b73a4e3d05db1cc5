//! Constant expressions in real numbers: literals count as they are written, and nothing is rounded.
//!
//! Front ends fold such expressions, each in its own way: in binary32 after every operation, or in binary64 with one
//! rounding at the end, with functions of their own. Beside the number that the author means stands how far apart they
//! may be.

use std::sync::Arc;

use super::Shader;
use super::ast::{BinaryOp, ExprId, ExprKind, Literal};
use super::builtin::BuiltinFunction as F;
use super::fold::Const;
use super::known::{self, Known};
use super::symbols::CallTarget;
use super::types::{ScalarType, Type};

/// Distance between numbers of binary32 next to 1.
const ULP: f64 = f32::EPSILON as f64;

/// The value of a constant expression.
#[derive(Clone, Debug)]
pub struct Real {
    meant: Known,
    /// With every operation rounded to binary32.
    single: Known,
    /// How far the functions of a front end may be off, for each component.
    slack: Vec<f64>,
    /// True for what an operation rounded: what uses it may be left to a device, which rounds either way.
    rounded: bool,
}

impl Real {
    /// Type of the expression in GLSL; each component has a real number.
    pub fn ty(&self) -> &Type {
        &self.meant.ty
    }

    /// Components in order, columns of a matrix behind each other, as near as binary64 comes to them.
    pub fn values(&self) -> &[f64] {
        &self.meant.parts
    }

    /// For each component, how far from `value` a front end may be that folds the expression, where `value` is what
    /// one of them gives.
    #[expect(clippy::cast_possible_truncation, reason = "front ends round at the end")]
    pub fn spread(&self, component: usize, value: f64) -> f64 {
        let of = |known: &Known| known.parts.get(component).copied().unwrap_or(value);
        let apart = |other: f64| (value - other).abs();
        let once = f64::from(of(&self.meant) as f32);
        apart(once).max(apart(of(&self.single))) + self.slack.get(component).copied().unwrap_or(0.0)
    }

    /// True when a front end may have folded a component to `value`.
    #[expect(clippy::cast_possible_truncation, reason = "front ends round at the end")]
    pub fn is_near(&self, component: usize, value: f64) -> bool {
        let (once, single) = (f64::from(self.meant.parts[component] as f32), self.single.parts[component]);
        let room = self.slack[component] + 2.0 * ULP * value.abs();
        once.min(single) - room <= value && value <= once.max(single) + room
    }

    fn exact(value: Known) -> Self {
        let slack = vec![0.0; value.parts.len()];
        Self { single: value.clone(), meant: value, slack, rounded: false }
    }

    fn literal(value: f64) -> Self {
        let meant = Known { ty: Type::FLOAT, parts: vec![value] };
        Self { single: known::rounded(meant.clone()), meant, slack: vec![0.0], rounded: false }
    }

    /// What an operation gives, which itself may be off by `own` of its value.
    fn of(args: &[&Self], own: impl Fn(f64) -> f64, op: impl Fn(&[Known]) -> Option<Known>) -> Option<Self> {
        let singles: Vec<Known> = args.iter().map(|arg| arg.single.clone()).collect();
        let unrounded = op(&singles)?;
        let rounded = known::rounded(unrounded.clone()).parts != unrounded.parts || args.iter().any(|arg| arg.rounded);
        let single = known::rounded(unrounded);
        if single.ty.scalar().is_some_and(|scalar| scalar != ScalarType::Float) {
            // Whole numbers and truth values are those that the language makes of binary32.
            return Some(Self::exact(single));
        }
        let mut moved: Vec<Known> = args.iter().map(|arg| arg.meant.clone()).collect();
        let meant = op(&moved)?;
        let mut slack: Vec<f64> = meant.parts.iter().map(|&v| own(v)).collect();
        for (k, arg) in args.iter().enumerate() {
            for (part, &by) in arg.slack.iter().enumerate().filter(|(_, by)| **by > 0.0) {
                let mut reach = vec![0.0_f64; slack.len()];
                for sign in [-1.0, 1.0] {
                    moved[k].parts[part] = arg.meant.parts[part] + sign * by;
                    let there = op(&moved)?;
                    let all = reach.iter_mut().zip(there.parts.iter().zip(&meant.parts));
                    all.for_each(|(reach, (a, b))| *reach = reach.max((a - b).abs()));
                }
                moved[k].parts[part] = arg.meant.parts[part];
                slack.iter_mut().zip(reach).for_each(|(slack, reach)| *slack += reach);
            }
        }
        Some(Self { meant, single, slack, rounded })
    }
}

/// Values of all constant expressions of a shader.
#[derive(Clone, Debug, Default)]
pub struct Reals(Vec<Option<Arc<Real>>>);

impl Reals {
    /// Of a shader. `literal` says what a literal of `float` is meant to be, by its expression and the number as it is
    /// written.
    pub fn new(shader: &Shader, literal: &dyn Fn(ExprId, f64) -> f64) -> Self {
        let mut all = Self(Vec::with_capacity(shader.arena().len()));
        // Operands come before their users, and declarations before their uses.
        for (id, _) in shader.arena().iter() {
            let value = all.evaluate(shader, id, literal);
            all.0.push(value);
        }
        all
    }

    /// The value of an expression; `None` where it is no constant, or none that is known here.
    pub fn get(&self, id: ExprId) -> Option<&Real> {
        self.arc(id).map(|real| &**real)
    }

    fn arc(&self, id: ExprId) -> Option<&Arc<Real>> {
        self.0.get(id.index())?.as_ref()
    }

    fn evaluate(&self, shader: &Shader, id: ExprId, literal: &dyn Fn(ExprId, f64) -> f64) -> Option<Arc<Real>> {
        if let Some(value) = shader.fold(id) {
            let number = match value {
                Const::Bool(v) => Some(f64::from(u8::from(v))),
                Const::Int(_) | Const::Uint(_) => value.as_f64(),
                Const::Float(_) | Const::Double(_) => None,
            };
            if let Some(number) = number {
                return Some(Arc::new(Real::exact(Known { ty: value.ty(), parts: vec![number] })));
            }
        }
        let of = |id: ExprId| self.get(id);
        let none = |_: f64| 0.0;
        let value = match &shader.expr(id).kind {
            ExprKind::Literal(Literal::Float(v)) => Some(Real::literal(literal(id, *v))),
            ExprKind::Name(_) => return self.constant(shader, id),
            ExprKind::Paren(inner) => return self.arc(*inner).cloned(),
            ExprKind::Unary { op, operand, .. } => {
                Real::of(&[of(*operand)?], none, |args| known::unary(*op, args[0].clone()))
            }
            ExprKind::Binary { op, left, right, .. } => {
                let sides = [of(*left)?, of(*right)?];
                let size = largest(&sides);
                let summed = *op == BinaryOp::Mul && sides.iter().any(|side| matches!(side.ty(), Type::Matrix(..)));
                // x - y*trunc(x / y) loses digits of x.
                let chained = sides.iter().any(|side| side.rounded);
                let own = move |value: f64| match op {
                    BinaryOp::Rem => 2.0 * ULP * size,
                    _ if summed => 4.0 * ULP * size.max(size * size),
                    _ if chained => ULP * value.abs(),
                    _ => 0.0,
                };
                Real::of(&sides, own, |args| known::binary(*op, args[0].clone(), args[1].clone()))
            }
            ExprKind::Ternary { condition, yes, no } => {
                let sides = [of(*condition)?, of(*yes)?, of(*no)?];
                Real::of(&sides, none, |args| known::chosen(&args[0], &args[1], &args[2]))
            }
            ExprKind::Index { base, index } => {
                let k = usize::try_from(shader.fold(*index)?.as_integer()?).ok()?;
                Real::of(&[of(*base)?], none, |args| known::element(&args[0], k))
            }
            ExprKind::Field { base, field } => {
                Real::of(&[of(*base)?], none, |args| known::field(&args[0], &field.name))
            }
            ExprKind::Call { args, .. } => {
                let values: Option<Vec<&Real>> = args.iter().map(|&arg| of(arg)).collect();
                let values = values?;
                match shader.callee(id)? {
                    CallTarget::Constructor(ty) => Real::of(&values, none, |args| known::constructed(ty, args)),
                    // At a tie each implementation takes the side that it likes.
                    CallTarget::Builtin(call) if call.function == F::Round && is_tie(&values) => None,
                    CallTarget::Builtin(call) => {
                        let round = is_round(&values);
                        let size = largest(&values);
                        let own = |value: f64| error_of(call.function, round, value, size);
                        Real::of(&values, own, |args| known::function(call.function, args.to_vec()))
                    }
                    CallTarget::User(_) => None,
                }
            }
            ExprKind::Literal(_)
            | ExprKind::Method { .. }
            | ExprKind::Postfix { .. }
            | ExprKind::Assign { .. }
            | ExprKind::Comma { .. }
            | ExprKind::List(_)
            | ExprKind::Error => None,
        };
        value.map(Arc::new)
    }

    /// The value of a constant by its name.
    fn constant(&self, shader: &Shader, id: ExprId) -> Option<Arc<Real>> {
        let symbol = shader.symbol(shader.symbol_of(id)?);
        let initializer = symbol.initializer?;
        let value = self.initial(shader, initializer, &symbol.ty)?;
        let same = value.ty().scalar() == symbol.ty.scalar();
        if same {
            Some(value)
        } else {
            Real::of(&[&value], |_| 0.0, |args| known::converted(args[0].clone(), &symbol.ty)).map(Arc::new)
        }
    }

    /// The value of an initialiser for a variable of a type, lists in braces included.
    fn initial(&self, shader: &Shader, id: ExprId, ty: &Type) -> Option<Arc<Real>> {
        let ExprKind::List(items) = &shader.expr(id).kind else { return self.arc(id).cloned() };
        let part = |k: usize| match ty {
            Type::Struct(s) => s.fields.get(k).map(|field| field.ty.clone()),
            _ => ty.indexed(),
        };
        let values: Option<Vec<Arc<Real>>> =
            items.iter().enumerate().map(|(k, &item)| self.initial(shader, item, &part(k)?)).collect();
        let values = values?;
        let values: Vec<&Real> = values.iter().map(|value| &**value).collect();
        Real::of(&values, |_| 0.0, |args| known::constructed(ty, args)).map(Arc::new)
    }
}

/// The size of the largest component.
fn largest(args: &[&Real]) -> f64 {
    args.iter().flat_map(|arg| arg.values()).fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// True for arguments at which the inverse functions of angles have values that every front end knows.
fn is_round(args: &[&Real]) -> bool {
    args.iter().flat_map(|arg| arg.values()).all(|v| [-1.0, 0.0, 1.0].contains(v))
}

/// True where a number lies halfway between two whole ones.
fn is_tie(args: &[&Real]) -> bool {
    args.iter().flat_map(|arg| arg.values()).any(|v| (v - v.floor() - 0.5).abs() == 0.0)
}

/// How far the functions of a front end may be off, for arguments of this size. Most take those of a library in C; Mesa
/// approximates the inverse functions of angles as it does on a device, and makes the hyperbolic functions of exponentials,
/// which cancel near 0. Sums of products cancel as well.
fn error_of(name: F, round: bool, value: f64, size: f64) -> f64 {
    match name {
        F::Abs
        | F::Sign
        | F::Floor
        | F::Ceil
        | F::Trunc
        | F::Round
        | F::RoundEven
        | F::Min
        | F::Max
        | F::Clamp
        | F::Step
        | F::Transpose => 0.0,
        F::Asin | F::Acos | F::Atan | F::Asinh | F::Acosh | F::Atanh if !round => value.abs().max(1.0) / 2048.0,
        F::Sinh | F::Tanh => 4.0 * ULP * value.abs().max(1.0),
        F::Dot | F::Cross | F::Mix | F::Reflect | F::Refract | F::Fma | F::Mod => {
            4.0 * ULP * value.abs().max(size).max(size * size)
        }
        _ => 4.0 * ULP * value.abs(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Stage;
    use super::*;
    use base::text::SourceFile;

    /// The value of `x` in `const TYPE x = …;`.
    fn value(text: &str) -> Option<Real> {
        let file = SourceFile::new("a.glsl", format!("#version 450\n{text}\nfloat f() {{ return float(x); }}\n"));
        let parsed = Shader::parse(&file, Stage::Library);
        assert!(parsed.diagnostics.is_empty(), "{text}: {:?}", parsed.diagnostics);
        let shader = parsed.shader;
        let reals = Reals::new(&shader, &|_, v| v);
        let (id, _) = shader.arena().iter().find(|(_, e)| e.kind == ExprKind::Name("x".into()))?;
        reals.get(id).cloned()
    }

    #[test]
    fn a_tie_of_round_is_known_to_no_front_end() {
        assert!(value("const float x = round(0.5);").is_none());
        assert_eq!(value("const float x = round(0.75);").unwrap().values(), [1.0]);
    }

    #[test]
    fn functions_that_cancel_may_be_off_by_what_was_cancelled() {
        // Mesa makes `tanh` of exponentials: 9.83e-7 in place of 1e-6.
        for (text, off) in [
            ("const float x = tanh(1e-6);", 1.6e-8),
            ("const float x = dot(vec2(1.0, 1.0), vec2(1.0, -0.99999994));", 1e-7),
            ("const float x = fma(-2.5, asin(1.0), 4.0);", 1.2e-7),
        ] {
            let real = value(text).unwrap();
            let exact = real.values()[0];
            assert!(real.is_near(0, exact + off), "{text}: {real:?}");
        }
        // What no front end computes otherwise stays what it is.
        let real = value("const float x = tan(1e-6);").unwrap();
        assert!(!real.is_near(0, real.values()[0] + 1.6e-8), "{real:?}");
    }

    #[test]
    fn constants_are_the_numbers_that_are_written() {
        let pi = std::f64::consts::PI;
        let declared = "const float PI = 3.14159265358979323846; struct S { int n; vec2 v[2]; };";
        for (text, wanted) in [
            ("const float x = 0.1;", 0.1),
            ("const float x = PI * 0.5;", pi / 2.0),
            ("const float x = 2 * PI / 3;", 2.0 * pi / 3.0),
            ("const float x = radians(180.0);", pi),
            ("const float x = acos(-1.0);", pi),
            ("const float x = 4.0 * atan(1.0);", pi),
            ("const float x = atan(0.0, -1.0);", pi),
            ("const float x = sqrt(2.0);", std::f64::consts::SQRT_2),
            ("const float x = exp(1.0);", std::f64::consts::E),
            ("const float y = -PI; const float x = -(+y);", pi),
            ("const vec3 v = vec3(1.0, PI, 2.0) * 2.0; const float x = v.zy.y;", 2.0 * pi),
            ("const float a[2] = float[](1.0, PI); const float x = a[1];", pi),
            ("const float a[2] = { 1.0, PI }; const float x = a[1];", pi),
            ("const S s = S(1, vec2[](vec2(0.0), vec2(1.0, PI))); const float x = s.v[1].y;", pi),
            ("const S s = { 1, { vec2(0.0), vec2(1.0, PI) } }; const float x = s.v[1][1];", pi),
            ("const mat2 m = mat2(PI); const float x = (m * vec2(0.0, 2.0)).y;", 2.0 * pi),
            ("const float x = PI > 3.0 ? PI : 1.0;", pi),
            ("const int n = 3; const float x = n;", 3.0),
        ] {
            let real = value(&format!("{declared}\n{text}")).unwrap_or_else(|| panic!("{text}"));
            let found = real.values()[0];
            assert!((found - wanted).abs() <= 4e-16 * wanted.abs(), "{text}: {found} {wanted}");
        }
    }

    #[test]
    fn whole_numbers_are_those_of_binary32() {
        // In real numbers it is less than 29.
        assert_eq!(value("const int n = int(0.29 * 100.0); const float x = float(n);").unwrap().values(), [29.0]);
    }

    #[test]
    fn what_is_no_constant_has_no_value() {
        for text in ["uniform float x;", "float x = 1.0;", "in float y; const float x = 1.0 * float(y > 0.0);"] {
            let file = SourceFile::new("a.glsl", format!("#version 450\n{text}\nfloat f() {{ return x; }}\n"));
            let shader = Shader::parse(&file, Stage::Library).shader;
            let reals = Reals::new(&shader, &|_, v| v);
            let (id, _) = shader.arena().iter().find(|(_, e)| e.kind == ExprKind::Name("x".into())).unwrap();
            assert!(reals.get(id).is_none(), "{text}");
        }
    }

    #[test]
    fn front_ends_agree_about_one_operation_and_not_about_chains_and_functions() {
        let spread = |text: &str| {
            let real = value(text).unwrap();
            real.spread(0, f64::from(real.values()[0] as f32))
        };
        assert_eq!(spread("const float x = 2.0 * 3.14159265358979;"), 0.0);
        // What is left to a device may be rounded either way.
        assert!(spread("const float x = 0.7 * 0.5 + 0.001 + 10.0;") >= f64::from(f32::EPSILON) * 10.0);
        // In which order products are summed is open, and how the remainder is made.
        assert!(spread("const float x = (vec2(1.0, 1.0) * mat2(16777216.0, 1.0, 1.0, 1.0)).x;") >= 2.0);
        assert!(spread("const float x = (mat2(1.0) * vec2(0.1, 0.2)).x;") > 0.0);
        // 2^24 + 1 is no number of binary32.
        assert!((spread("const float x = 16777216.0 + 1.0 - 16777216.0;") - 1.0).abs() < 1e-6);
        assert!(spread("const float x = acos(-1.0);") < 2e-6);
        assert!(spread("const float x = acos(0.3);") > 2e-4);
        assert!(spread("const float x = 1000.0 * acos(0.3);") > 2e-1);
    }
}
