//! Conversions and reinterpretations.

use naga::{Expression, Handle, ScalarKind};

use super::super::code::{Field, Inst, Register, Word2};
use super::super::domain::{Comparison, FromWords, Site, ToWords, Unary};
use super::wide::is_wide;
use super::{Compiler, Frame, InterpError, types, unsupported};
use base::value::Scalar;

impl<'m> Compiler<'m> {
    pub(super) fn cast(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        expr: Handle<Expression>,
        kind: ScalarKind,
        convert: Option<u8>,
    ) -> Result<Vec<Register>, InterpError> {
        let registers = self.registers(frame, expr)?;
        let own = self.numbers(frame, expr);
        let aimed = convert.map(|width| naga::Scalar { kind, width }).or(own.filter(|_| is_wide(own)));
        if is_wide(own) || is_wide(aimed) {
            let span = frame.function.expressions.get_span(expr);
            return self
                .wide_cast(site, &registers, own, (kind, convert))
                .ok_or_else(|| unsupported("conversion of real numbers to 64-bit integers".to_owned(), span));
        }
        // A whole number of 16 bits, as memory keeps it: see `expression`.
        let whole = matches!(kind, ScalarKind::Sint | ScalarKind::Uint);
        let (short, convert) = if convert == Some(2) && whole { (true, Some(4)) } else { (false, convert) };
        let span = frame.function.expressions.get_span(expr);
        let width = convert.unwrap_or(4);
        let target = types::scalar(naga::Scalar { kind, width }).map_err(|what| unsupported(what, span))?;
        Ok(registers
            .iter()
            .map(|&a| match convert {
                // To binary16 a conversion rounds, from whatever type.
                Some(2) => {
                    let converted = self.convert(site, a, target);
                    self.real1(site, Unary::Narrow, converted)
                }
                Some(_) if short => {
                    let op = if kind == ScalarKind::Sint { Field::ExtractSigned } else { Field::ExtractUnsigned };
                    let converted = self.convert(site, a, target);
                    let (offset, count) = (self.word(0, Scalar::U32), self.word(16, Scalar::U32));
                    self.field(None, op, [converted, offset, count, count])
                }
                Some(_) => self.convert(site, a, target),
                None => self.reinterpret(site, a, target),
            })
            .collect())
    }

    /// A conversion from or to whole numbers of 64 bits; `None` where it is from real numbers.
    fn wide_cast(
        &mut self,
        site: Site,
        registers: &[Register],
        own: Option<naga::Scalar>,
        (kind, convert): (ScalarKind, Option<u8>),
    ) -> Option<Vec<Register>> {
        let aimed = naga::Scalar { kind, width: convert.unwrap_or(8) };
        match (is_wide(own), is_wide(Some(aimed))) {
            // The same bits.
            (true, true) => Some(registers.to_vec()),
            (true, false) => {
                let target = types::scalar(aimed).ok()?;
                let signed = own.is_some_and(|scalar| scalar.kind == ScalarKind::Sint);
                let halves = registers.chunks_exact(2);
                Some(halves.map(|pair| self.narrowed_to(site, signed, [pair[0], pair[1]], target)).collect())
            }
            (false, _) => {
                let all: Option<Vec<Vec<Register>>> = registers.iter().map(|&a| self.widened(site, a)).collect();
                all.map(|all| all.concat())
            }
        }
    }

    pub(super) fn words_of(&mut self, site: Site, op: ToWords, a: Register, scalar: Scalar) -> Register {
        let to = self.temporary();
        self.push(Inst::ToWords { op, to, a: a.reg, site });
        Register { scalar, reg: to }
    }

    pub(super) fn reals_of(&mut self, site: Site, op: FromWords, a: Register) -> Register {
        let to = self.temporary();
        self.push(Inst::FromWords { op, to, a: a.reg, site });
        Register { scalar: Scalar::F32, reg: to }
    }

    fn convert(&mut self, site: Site, a: Register, target: Scalar) -> Register {
        match (a.scalar, target) {
            (Scalar::F32, Scalar::F32) => a,
            (Scalar::F32, Scalar::I32) => self.words_of(site, ToWords::Signed, a, target),
            (Scalar::F32, Scalar::U32) => self.words_of(site, ToWords::Unsigned, a, target),
            (Scalar::F32, Scalar::Bool) => {
                let zero = self.real(0.0, None);
                self.compare(site, Comparison::NotEqual, a, zero)
            }
            (Scalar::I32, Scalar::F32) => self.reals_of(site, FromWords::Signed, a),
            (Scalar::U32 | Scalar::Bool, Scalar::F32) => self.reals_of(site, FromWords::Unsigned, a),
            (Scalar::I32 | Scalar::U32, Scalar::Bool) => {
                let zero = self.word(0, a.scalar);
                self.word2(site, Word2::NotEqual, a, zero, Scalar::Bool)
            }
            // The same bits, read differently; a boolean is 0 or 1.
            (Scalar::I32 | Scalar::U32 | Scalar::Bool, Scalar::I32 | Scalar::U32) | (Scalar::Bool, Scalar::Bool) => {
                Register { scalar: target, ..a }
            }
        }
    }

    /// The bits of a real number are those of the nearest binary32, in every domain.
    fn reinterpret(&mut self, site: Site, a: Register, target: Scalar) -> Register {
        match (a.scalar, target) {
            (Scalar::F32, Scalar::F32) => a,
            (Scalar::F32, Scalar::I32 | Scalar::U32 | Scalar::Bool) => self.words_of(site, ToWords::Bits, a, target),
            (Scalar::I32 | Scalar::U32 | Scalar::Bool, Scalar::F32) => self.reals_of(site, FromWords::Bits, a),
            (Scalar::I32 | Scalar::U32 | Scalar::Bool, Scalar::I32 | Scalar::U32 | Scalar::Bool) => {
                Register { scalar: target, ..a }
            }
        }
    }
}
