//! Operators, and the scalar operations from which everything else is built.

use naga::{BinaryOperator, Expression, Handle, TypeInner, UnaryOperator};

use super::super::code::{Inst, Register, Word1, Word2};
use super::super::domain::{Binary, Comparison, Site, Unary};
use super::wide::{is_wide, words};
use super::{Compiler, Frame, InterpError, unsupported};
use base::value::Scalar;

/// An operator on scalars of one type.
enum Operator {
    Real(Binary),
    Compare(Comparison),
    Word(Word2, Scalar),
    /// With the operands exchanged.
    Swapped(Word2, Scalar),
}

impl<'m> Compiler<'m> {
    pub(super) fn real1(&mut self, site: Site, op: Unary, a: Register) -> Register {
        let to = self.temporary();
        self.push(Inst::Real1 { op, to, a: a.reg, site });
        Register { scalar: Scalar::F32, reg: to }
    }

    pub(super) fn real2(&mut self, site: Site, op: Binary, a: Register, b: Register) -> Register {
        let to = self.temporary();
        self.push(Inst::Real2 { op, to, a: a.reg, b: b.reg, site });
        Register { scalar: Scalar::F32, reg: to }
    }

    pub(super) fn compare(&mut self, site: Site, op: Comparison, a: Register, b: Register) -> Register {
        let to = self.temporary();
        self.push(Inst::Compare { op, to, a: a.reg, b: b.reg, site });
        Register { scalar: Scalar::Bool, reg: to }
    }

    pub(super) fn word1(&mut self, site: Site, op: Word1, a: Register, scalar: Scalar) -> Register {
        if let Some(known) = self.known_word1(op, a) {
            return self.word(known, scalar);
        }
        let to = self.temporary();
        self.push(Inst::Word1 { op, to, a: a.reg, site });
        Register { scalar, reg: to }
    }

    pub(super) fn word2(&mut self, site: Site, op: Word2, a: Register, b: Register, scalar: Scalar) -> Register {
        if let Some(known) = self.known_word2(op, a.reg, b.reg) {
            return self.word(known, scalar);
        }
        let to = self.temporary();
        self.push(Inst::Word2 { op, to, a: a.reg, b: b.reg, site });
        Register { scalar, reg: to }
    }

    pub(super) fn unary_operator(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        op: UnaryOperator,
        expr: Handle<Expression>,
    ) -> Result<Vec<Register>, InterpError> {
        let registers = self.registers(frame, expr)?;
        if is_wide(self.numbers(frame, expr)) {
            let halves = |pair: &[Register]| [pair[0], pair[1]];
            let each = registers.chunks_exact(2).map(|pair| self.wide_unary(site, op, halves(pair)));
            let all: Option<Vec<Vec<Register>>> = each.collect();
            return all.map(|all| all.concat()).ok_or_else(|| unsupported(format!("{op:?} of this type"), frame.span));
        }
        let one = |this: &mut Self, a: Register| match (op, a.scalar) {
            (UnaryOperator::Negate, Scalar::F32) => Some(this.real1(site, Unary::Negate, a)),
            (UnaryOperator::Negate, Scalar::I32) => Some(this.word1(site, Word1::Negate, a, Scalar::I32)),
            (UnaryOperator::LogicalNot, Scalar::Bool) => Some(this.word1(site, Word1::LogicalNot, a, Scalar::Bool)),
            (UnaryOperator::BitwiseNot, Scalar::I32 | Scalar::U32) => Some(this.word1(site, Word1::Not, a, a.scalar)),
            (UnaryOperator::Negate, Scalar::U32 | Scalar::Bool)
            | (UnaryOperator::LogicalNot, Scalar::F32 | Scalar::I32 | Scalar::U32)
            | (UnaryOperator::BitwiseNot, Scalar::F32 | Scalar::Bool) => None,
        };
        let all: Option<Vec<Register>> = registers.iter().map(|&a| one(self, a)).collect();
        all.ok_or_else(|| unsupported(format!("{op:?} of this type"), frame.span))
    }

    pub(super) fn binary_operator(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        op: BinaryOperator,
        left: Handle<Expression>,
        right: Handle<Expression>,
    ) -> Result<Vec<Register>, InterpError> {
        let (a, b) = (self.registers(frame, left)?, self.registers(frame, right)?);
        if op == BinaryOperator::Multiply {
            let inner = |handle: Handle<Expression>| frame.info[handle].ty.inner_with(&self.module.types);
            let size = |inner: &TypeInner| match *inner {
                TypeInner::Matrix { columns, rows, .. } => Some((columns as usize, rows as usize)),
                _ => None,
            };
            let vector = |inner: &TypeInner| matches!(inner, TypeInner::Vector { .. });
            let (l, r) = (inner(left), inner(right));
            match (size(l), size(r)) {
                (Some((_, rows)), Some((columns, inner))) => {
                    return Ok(self.matrix_product(site, &a, &b, rows, inner, columns));
                }
                (Some((columns, rows)), None) if vector(r) => {
                    return Ok(self.matrix_product(site, &a, &b, rows, columns, 1));
                }
                // A row from the left: one row of a matrix with as many columns as it has components.
                (None, Some((columns, rows))) if vector(l) => {
                    return Ok(self.matrix_product(site, &a, &b, 1, rows, columns));
                }
                _ => {}
            }
        }
        let (own, other) = (self.numbers(frame, left), self.numbers(frame, right));
        if is_wide(own) {
            let signed = own.is_some_and(|scalar| scalar.kind == naga::ScalarKind::Sint);
            let (step, n) = (words(other), (a.len() / 2).max(b.len() / words(other)));
            let mut all = Vec::new();
            for k in 0..n {
                let (at, by) = (if a.len() == 2 { 0 } else { 2 * k }, if b.len() == step { 0 } else { step * k });
                let found = self.wide_operator(site, op, signed, [a[at], a[at + 1]], &b[by..by + step]);
                all.extend(found.ok_or_else(|| unsupported(format!("{op:?} of this type"), frame.span))?);
            }
            return Ok(all);
        }
        let n = a.len().max(b.len());
        let mut all = Vec::with_capacity(n);
        for k in 0..n {
            // A scalar on one side stands for a vector of it.
            let (a, b) = (if a.len() == 1 { a[0] } else { a[k] }, if b.len() == 1 { b[0] } else { b[k] });
            let operator = operator(op, a.scalar);
            let operator = operator.ok_or_else(|| unsupported(format!("{op:?} of this type"), frame.span))?;
            all.push(match operator {
                Operator::Real(op) => self.real2(site, op, a, b),
                Operator::Compare(op) => self.compare(site, op, a, b),
                Operator::Word(op, scalar) => self.word2(site, op, a, b, scalar),
                Operator::Swapped(op, scalar) => self.word2(site, op, b, a, scalar),
            });
        }
        Ok(all)
    }

    /// The product of a matrix of `rows` × `inner` and one of `inner` × `columns`, both column by
    /// column; sums run from the first term to the last.
    pub(super) fn matrix_product(
        &mut self,
        site: Site,
        a: &[Register],
        b: &[Register],
        rows: usize,
        inner: usize,
        columns: usize,
    ) -> Vec<Register> {
        let mut all = Vec::with_capacity(rows * columns);
        for column in 0..columns {
            for row in 0..rows {
                let mut sum = None;
                for k in 0..inner {
                    let term = self.real2(site, Binary::Multiply, a[k * rows + row], b[column * inner + k]);
                    sum = Some(match sum {
                        None => term,
                        Some(sum) => self.real2(site, Binary::Add, sum, term),
                    });
                }
                all.extend(sum);
            }
        }
        all
    }
}

fn operator(op: BinaryOperator, scalar: Scalar) -> Option<Operator> {
    use BinaryOperator as Op;
    use Scalar::{Bool, F32, I32, U32};
    let real = |op| Some(Operator::Real(op));
    let compare = |op| Some(Operator::Compare(op));
    let word = |op| Some(Operator::Word(op, scalar));
    let ask = |op| Some(Operator::Word(op, Bool));
    let swapped = |op| Some(Operator::Swapped(op, Bool));
    match (op, scalar) {
        (Op::Add, F32) => real(Binary::Add),
        (Op::Add, I32) => word(Word2::AddSigned),
        (Op::Add, U32) => word(Word2::AddUnsigned),
        (Op::Subtract, F32) => real(Binary::Subtract),
        (Op::Subtract, I32) => word(Word2::SubtractSigned),
        (Op::Subtract, U32) => word(Word2::SubtractUnsigned),
        (Op::Multiply, F32) => real(Binary::Multiply),
        (Op::Multiply, I32) => word(Word2::MultiplySigned),
        (Op::Multiply, U32) => word(Word2::MultiplyUnsigned),
        (Op::Divide, F32) => real(Binary::Divide),
        (Op::Divide, I32) => word(Word2::DivideSigned),
        (Op::Divide, U32) => word(Word2::DivideUnsigned),
        (Op::Modulo, F32) => real(Binary::Remainder),
        (Op::Modulo, I32) => word(Word2::RemainderSigned),
        (Op::Modulo, U32) => word(Word2::RemainderUnsigned),
        (Op::Equal, F32) => compare(Comparison::Equal),
        (Op::Equal, I32 | U32 | Bool) => ask(Word2::Equal),
        (Op::NotEqual, F32) => compare(Comparison::NotEqual),
        (Op::NotEqual, I32 | U32 | Bool) => ask(Word2::NotEqual),
        (Op::Less, F32) => compare(Comparison::Less),
        (Op::Less, I32) => ask(Word2::LessSigned),
        (Op::Less, U32) => ask(Word2::LessUnsigned),
        (Op::LessEqual, F32) => compare(Comparison::LessEqual),
        (Op::LessEqual, I32) => ask(Word2::LessEqualSigned),
        (Op::LessEqual, U32) => ask(Word2::LessEqualUnsigned),
        (Op::Greater, F32) => compare(Comparison::Greater),
        (Op::Greater, I32) => swapped(Word2::LessSigned),
        (Op::Greater, U32) => swapped(Word2::LessUnsigned),
        (Op::GreaterEqual, F32) => compare(Comparison::GreaterEqual),
        (Op::GreaterEqual, I32) => swapped(Word2::LessEqualSigned),
        (Op::GreaterEqual, U32) => swapped(Word2::LessEqualUnsigned),
        (Op::And, I32 | U32 | Bool) => word(Word2::And),
        (Op::ExclusiveOr, I32 | U32 | Bool) => word(Word2::Xor),
        (Op::InclusiveOr, I32 | U32 | Bool) => word(Word2::Or),
        (Op::LogicalAnd, Bool) => word(Word2::And),
        (Op::LogicalOr, Bool) => word(Word2::Or),
        (Op::ShiftLeft, I32 | U32) => word(Word2::ShiftLeft),
        (Op::ShiftRight, I32) => word(Word2::ShiftRightSigned),
        (Op::ShiftRight, U32) => word(Word2::ShiftRightUnsigned),
        (Op::And | Op::ExclusiveOr | Op::InclusiveOr | Op::ShiftLeft | Op::ShiftRight, F32)
        | (Op::ShiftLeft | Op::ShiftRight, Bool)
        | (Op::LogicalAnd | Op::LogicalOr, F32 | I32 | U32)
        | (Op::Add | Op::Subtract | Op::Multiply | Op::Divide | Op::Modulo, Bool)
        | (Op::Less | Op::LessEqual | Op::Greater | Op::GreaterEqual, Bool) => None,
    }
}
