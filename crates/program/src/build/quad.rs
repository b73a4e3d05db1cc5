//! Derivatives in the module that is run: those of a quad that the entry point makes.
//!
//! The four members of the quad are the sample itself and its neighbours in x, in y and in both. `main` is
//! run for them again and again: in pass p each stops at the p-th derivative of the text, or the first one
//! behind it that it comes to, whose operand is kept. So every operand depends on derivatives alone that are
//! known before. In the last run, of the sample itself, a derivative is the difference of the operands of two
//! neighbours. Where one of these did not come by, control flow is not uniform, and the derivative has no
//! value (GLSL 4.60, 8.14.1).

use naga::{
    AddressSpace, ArraySize, BinaryOperator as B, DerivativeAxis, Expression, GlobalVariable, Handle, Literal,
    MathFunction, ScalarKind, Statement, TypeInner, VectorSize,
};

use super::function::{Fun, Val};
use super::io::Incoming;
use super::{Build, Expr, Result};
use crate::capture;
use base::text::Span;
use syntax::Stage;
use syntax::types::{ScalarType, Type};

/// Derivatives that one invocation may come to.
pub(crate) const MOST: u32 = 16;
/// Bits of a NaN.
const NAN: u32 = 0x7fc0_0000;

/// The variables of a quad.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quad {
    /// Which of the four members runs.
    member: Handle<GlobalVariable>,
    /// At or behind which derivative it stops, counted from 1.
    pass: Handle<GlobalVariable>,
    /// Derivatives of the text before the function that runs.
    at: Handle<GlobalVariable>,
    /// The operands of each member.
    values: Handle<GlobalVariable>,
    /// Which of them are known.
    known: Handle<GlobalVariable>,
}

impl Build<'_> {
    /// True where a quad can be made.
    pub(super) fn makes_quads(&self) -> bool {
        self.run && matches!(self.shader.stage(), Stage::Fragment | Stage::Library)
    }

    fn quad(&mut self) -> Quad {
        if let Some(quad) = self.leaving.quad {
            return quad;
        }
        let word = self.insert(None, TypeInner::Scalar(naga::Scalar::U32));
        let vector = TypeInner::Vector { size: VectorSize::Quad, scalar: naga::Scalar::F32 };
        let vector = self.insert(None, vector);
        let size = ArraySize::Constant(std::num::NonZeroU32::MIN.saturating_add(4 * MOST - 1));
        let values = self.insert(None, TypeInner::Array { base: vector, size, stride: 16 });
        let known = self.insert(None, TypeInner::Array { base: word, size, stride: 4 });
        let mut add = |name: &str, ty| capture::add_global(&mut self.module, name, AddressSpace::Private, None, ty);
        let quad = Quad {
            member: add("sc_member", word),
            pass: add("sc_pass", word),
            at: add("sc_at", word),
            values: add("sc_values", values),
            known: add("sc_known", known),
        };
        self.leaving.quad = Some(quad);
        quad
    }
}

/// How far the inputs of a neighbour are away, for the n-th number that is interpolated: in x and in y.
/// All differ from each other, so that a wrong one shows, and are powers of two and small multiples of them.
pub(crate) fn steps(n: u32) -> [f64; 2] {
    let n = f64::from(n % 8);
    [(n + 1.0) / 256.0, (2.0 * n + 3.0) / 512.0 * if n % 2.0 == 0.0 { -1.0 } else { 1.0 }]
}

impl Fun<'_, '_> {
    pub(super) fn word(&mut self, value: u32) -> Expr {
        self.add(Expression::Literal(Literal::U32(value)))
    }

    fn get_word(&mut self, global: Handle<GlobalVariable>) -> Expr {
        let pointer = self.add(Expression::GlobalVariable(global));
        self.add(Expression::Load { pointer })
    }

    fn set(&mut self, global: Handle<GlobalVariable>, value: Expr) {
        let pointer = self.add(Expression::GlobalVariable(global));
        self.push(Statement::Store { pointer, value });
    }

    fn two(&mut self, op: B, left: Expr, right: Expr) -> Expr {
        self.add(Expression::Binary { op, left, right })
    }

    /// `dFdx`, `dFdy` or `fwidth` of a value.
    pub(super) fn quad_derivative(&mut self, axis: DerivativeAxis, value: Val, span: Span) -> Result<Val> {
        self.build.differs = true;
        let quad = self.build.quad();
        let before = self.sites;
        self.sites += 1;
        if self.in_loop {
            self.build.ports.unfed.push(("a derivative in a loop".to_owned(), span));
        }
        let n = value.ty.components().unwrap_or(1);
        let zero = self.number(ScalarType::Float, 0.0);
        let parts = (0..4_u32).map(|k| match (n, k) {
            (1, 0) => value.e,
            (1, _) => zero,
            (n, k) if (k as usize) < n => self.add(Expression::AccessIndex { base: value.e, index: k }),
            _ => zero,
        });
        let parts: Vec<Expr> = parts.collect();
        let operand = self.compose(&Type::VEC4, parts)?.e;
        let (at, member) = (self.get_word(quad.at), self.get_word(quad.member));
        let before = self.word(before);
        let at = self.two(B::Add, at, before);
        let (most, one) = (self.word(MOST), self.word(1));
        let index = |f: &mut Self, member: Expr| {
            let first = f.two(B::Multiply, member, most);
            f.two(B::Add, first, at)
        };
        let own = index(self, member);
        for (array, value) in [(quad.values, operand), (quad.known, one)] {
            let base = self.add(Expression::GlobalVariable(array));
            let pointer = self.add(Expression::Access { base, index: own });
            self.push(Statement::Store { pointer, value });
        }
        let next = self.two(B::Add, at, one);
        let pass = self.get_word(quad.pass);
        let stops = self.two(B::GreaterEqual, next, pass);
        self.branch(stops, |f| f.stop(span), |_| Ok(()))?;
        // The neighbours on both sides along an axis: bit 0 of a member is x, bit 1 is y.
        let along = |f: &mut Self, bit: u32| {
            let (set, unset) = (f.word(bit), f.word(3 - bit));
            let ends = [f.two(B::And, member, unset), f.two(B::InclusiveOr, member, set)];
            let mut values = Vec::new();
            let mut same = None;
            for end in ends {
                let at = index(f, end);
                let element = |f: &mut Self, array| {
                    let base = f.add(Expression::GlobalVariable(array));
                    let pointer = f.add(Expression::Access { base, index: at });
                    f.add(Expression::Load { pointer })
                };
                values.push(element(f, quad.values));
                let here = element(f, quad.known);
                let here = f.two(B::Equal, here, one);
                same = Some(same.map_or(here, |before| f.two(B::LogicalAnd, before, here)));
            }
            (f.two(B::Subtract, values[1], values[0]), same)
        };
        let (difference, known) = match axis {
            DerivativeAxis::X => along(self, 1),
            DerivativeAxis::Y => along(self, 2),
            DerivativeAxis::Width => {
                let (x, x_known) = along(self, 1);
                let (y, y_known) = along(self, 2);
                let (x, y) = (self.math(MathFunction::Abs, &[x]), self.math(MathFunction::Abs, &[y]));
                let known = x_known.zip(y_known).map(|(x, y)| self.two(B::LogicalAnd, x, y));
                (self.two(B::Add, x, y), known)
            }
        };
        let nan = self.word(NAN);
        let nan = self.add(Expression::As { expr: nan, kind: ScalarKind::Float, convert: None });
        let nan = self.add(Expression::Splat { size: VectorSize::Quad, value: nan });
        let difference = match known {
            Some(condition) => self.add(Expression::Select { condition, accept: difference, reject: nan }),
            None => difference,
        };
        let whole = Val { e: difference, ty: Type::VEC4 };
        let picked: Vec<u8> = (0..n as u8).collect();
        let part = self.swizzle(&whole, &picked)?;
        Ok(Val { e: part.e, ty: value.ty })
    }

    /// Calls a function that comes to derivatives with the number of those before it.
    pub(super) fn before_call(&mut self, sites: u32, forth: bool) {
        let Some(quad) = self.build.leaving.quad.filter(|_| sites > 0) else { return };
        let at = self.get_word(quad.at);
        let before = self.word(self.sites);
        let at = self.two(if forth { B::Add } else { B::Subtract }, at, before);
        self.set(quad.at, at);
    }

    /// Runs a function for the members of quads, and in the end for the sample itself. `call` sets the inputs
    /// of a member and calls it.
    pub(super) fn run_quads(
        &mut self,
        sites: u32,
        span: Span,
        call: &mut dyn FnMut(&mut Self, Expr) -> Result<()>,
    ) -> Result<()> {
        let quad = self.build.quad();
        if sites > MOST {
            self.build.ports.unfed.push((format!("a shader with more than {MOST} derivatives"), span));
        }
        let runs = 4 * sites.min(MOST);
        let known = self.build.module.global_variables[quad.known].ty;
        let none = self.add(Expression::ZeroValue(known));
        self.set(quad.known, none);
        let turn = self.local("sc_turn", &Type::UINT)?;
        let zero = self.word(0);
        self.push(Statement::Store { pointer: turn.ptr, value: zero });
        let (body, ()) = self.block(|f| {
            let number = f.add(Expression::Load { pointer: turn.ptr });
            let (zero, one, three, runs, never) = (f.word(0), f.word(1), f.word(3), f.word(runs), f.word(u32::MAX));
            let member = f.two(B::And, number, three);
            f.set(quad.member, member);
            let four = f.word(4);
            let pass = f.two(B::Divide, number, four);
            let pass = f.two(B::Add, pass, one);
            let records = f.two(B::Less, number, runs);
            let pass = f.add(Expression::Select { condition: records, accept: pass, reject: never });
            f.set(quad.pass, pass);
            f.set(quad.at, zero);
            call(f, member)
        })?;
        let (continuing, stop) = self.block(|f| {
            let number = f.add(Expression::Load { pointer: turn.ptr });
            let (one, runs) = (f.word(1), f.word(runs));
            let next = f.two(B::Add, number, one);
            f.push(Statement::Store { pointer: turn.ptr, value: next });
            Ok(f.two(B::Greater, next, runs))
        })?;
        self.push(Statement::Loop { body, continuing, break_if: Some(stop) });
        Ok(())
    }

    /// The inputs of a member.
    pub(super) fn step_inputs(&mut self, member: Expr) -> Result<()> {
        let incoming: Vec<Incoming> = self.build.ports.incoming.clone();
        let mut number = 0;
        for (k, input) in incoming.iter().enumerate() {
            let at_pixel =
                matches!(input.argument.binding, Some(naga::Binding::BuiltIn(naga::BuiltIn::Position { .. })));
            let flat = match input.argument.binding {
                Some(naga::Binding::Location { interpolation, .. }) => interpolation == Some(naga::Interpolation::Flat),
                _ => !at_pixel,
            };
            let Some(n) = input.ty.components().filter(|_| !flat && input.ty.scalar() == Some(ScalarType::Float))
            else {
                continue;
            };
            let mut parts: [Vec<Expr>; 2] = [Vec::new(), Vec::new()];
            for c in 0..n {
                let step = match (at_pixel, c) {
                    // Pixels lie side by side; depth is that of a plane parallel to the screen.
                    (true, 0) => [1.0, 0.0],
                    (true, 1) => [0.0, 1.0],
                    (true, _) => [0.0, 0.0],
                    (false, _) => steps(number),
                };
                number += u32::from(!at_pixel);
                for (parts, step) in parts.iter_mut().zip(step) {
                    parts.push(self.number(ScalarType::Float, step));
                }
            }
            let value = self.add(Expression::FunctionArgument(u32::try_from(k).unwrap_or(0)));
            let value = self.stepped(member, value, &input.ty, parts)?;
            let mut pointer = self.add(Expression::GlobalVariable(input.to));
            for &index in &input.path {
                pointer = self.add(Expression::AccessIndex { base: pointer, index });
            }
            self.push(Statement::Store { pointer, value });
        }
        Ok(())
    }
}

impl Fun<'_, '_> {
    /// A value of a member, which is `parts` away in x and in y.
    fn stepped(&mut self, member: Expr, mut value: Expr, ty: &Type, parts: [Vec<Expr>; 2]) -> Result<Expr> {
        for (bit, parts) in [1_u32, 2].into_iter().zip(parts) {
            let step = match parts[..] {
                [one] => one,
                _ => self.compose(ty, parts)?.e,
            };
            let moved = self.two(B::Add, value, step);
            let bit = self.word(bit);
            let (set, zero) = (self.two(B::And, member, bit), self.word(0));
            let set = self.two(B::NotEqual, set, zero);
            let condition = match ty {
                Type::Vector(_, n) => self.add(Expression::Splat { size: super::types::size(*n), value: set }),
                _ => set,
            };
            // The sample itself keeps its inputs, without a rounding.
            value = self.add(Expression::Select { condition, accept: moved, reject: value });
        }
        Ok(value)
    }

    /// The value of a parameter for a member; `number` counts the numbers that are interpolated.
    pub(super) fn stepped_parameter(&mut self, member: Expr, value: Expr, ty: &Type, number: &mut u32) -> Result<Expr> {
        let plain = matches!(ty, Type::Scalar(ScalarType::Float) | Type::Vector(ScalarType::Float, _));
        let Some(n) = ty.components().filter(|_| plain) else { return Ok(value) };
        let mut parts: [Vec<Expr>; 2] = [Vec::new(), Vec::new()];
        for _ in 0..n {
            for (parts, step) in parts.iter_mut().zip(steps(*number)) {
                parts.push(self.number(ScalarType::Float, step));
            }
            *number += 1;
        }
        self.stepped(member, value, ty, parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_eight_numbers_differ() {
        let mut all: Vec<f64> = (0..8).flat_map(steps).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        assert_eq!(all.len(), 16, "{all:?}");
        assert_eq!(steps(0), [1.0 / 256.0, -3.0 / 512.0]);
    }
}
