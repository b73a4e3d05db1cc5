//! Bit fields, packing and unpacking.

use super::super::code::{Field, Guarded, Inst, Register, Word2};
use super::super::domain::{Binary, FromWords, Site, ToWords, Unary};
use super::Compiler;
use super::math::Args;
use base::value::Scalar;

impl Compiler<'_> {
    /// `site` is `None` where the bits lie inside of the word by construction.
    pub(super) fn field(&mut self, site: Option<Site>, op: Field, args: [Register; 4]) -> Register {
        let to = self.temporary();
        self.push(Inst::Field { op, to, args: args.map(|register| register.reg), site });
        Register { reg: to, ..args[0] }
    }

    /// Puts the lower `width` bits of words behind each other, the first one lowest.
    pub(super) fn pack(&mut self, words: &[Register], width: u32) -> Register {
        let mut packed = self.word(0, Scalar::U32);
        for (k, &word) in words.iter().enumerate() {
            let (offset, count) = (self.word(k as u32 * width, Scalar::U32), self.word(width, Scalar::U32));
            packed = self.field(None, Field::Insert, [packed, word, offset, count]);
        }
        Register { scalar: Scalar::U32, ..packed }
    }

    /// The bit fields of a word, the lowest one first.
    pub(super) fn unpack(&mut self, word: Register, width: u32, op: Field, scalar: Scalar) -> Vec<Register> {
        let mut all = Vec::new();
        for k in 0..32 / width {
            let (offset, count) = (self.word(k * width, Scalar::U32), self.word(width, Scalar::U32));
            let field = self.field(None, op, [word, offset, count, count]);
            all.push(Register { scalar, ..field });
        }
        all
    }

    /// WGSL, 17.9: ⌊½ + s·clamp(x)⌋ with s = 2^(width − 1) − 1 and [−1, 1], or 2^width − 1 and [0, 1].
    ///
    /// GLSL (4.60, 8.4) and SPIR-V (`PackSnorm4x8`) say `round(s·clamp(x))`, and leave the direction of halves to the
    /// implementation. What WGSL is translated to says so too: its lanes get a function that is open there.
    pub(super) fn pack_fractions(&mut self, site: Site, args: &Args, width: u32, signed: bool) -> Vec<Register> {
        let low = self.real(if signed { -1.0 } else { 0.0 }, None);
        let (one, half) = (self.real(1.0, None), self.real(0.5, None));
        let scale = self.real(largest(width, signed), None);
        let words: Vec<Register> = args[0]
            .iter()
            .map(|&x| {
                let raised = self.real2(site, Binary::Max, x, low);
                let clamped = self.real2(site, Binary::Min, raised, one);
                let scaled = self.real2(site, Binary::Multiply, clamped, scale);
                let shifted = self.real2(site, Binary::Add, scaled, half);
                let rounded = self.real1(site.open_at_ties(), Unary::Floor, shifted);
                self.words_of(site, ToWords::Signed, rounded, Scalar::I32)
            })
            .collect();
        vec![self.pack(&words, width)]
    }

    /// max(v/s, −1), or v/s.
    pub(super) fn unpack_fractions(&mut self, site: Site, args: &Args, width: u32, signed: bool) -> Vec<Register> {
        let scale = self.real(largest(width, signed), None);
        let low = self.real(-1.0, None);
        let (field, from, scalar) = if signed {
            (Field::ExtractSigned, FromWords::Signed, Scalar::I32)
        } else {
            (Field::ExtractUnsigned, FromWords::Unsigned, Scalar::U32)
        };
        let words = self.unpack(args[0][0], width, field, scalar);
        let value = |word: Register| {
            let number = self.reals_of(site, from, word);
            let ratio = self.real2(site, Binary::Divide, number, scale);
            if signed { self.real2(site, Binary::Max, ratio, low) } else { ratio }
        };
        words.into_iter().map(value).collect()
    }

    pub(super) fn pack_halves(&mut self, site: Site, args: &Args) -> Vec<Register> {
        let words: Vec<Register> = args[0]
            .iter()
            .map(|&x| {
                let x = self.guard(site, Guarded::Half, x, [x, x]);
                self.words_of(site, ToWords::HalfBits, x, Scalar::U32)
            })
            .collect();
        vec![self.pack(&words, 16)]
    }

    pub(super) fn unpack_halves(&mut self, site: Site, args: &Args) -> Vec<Register> {
        let words = self.unpack(args[0][0], 16, Field::ExtractUnsigned, Scalar::U32);
        words.into_iter().map(|word| self.reals_of(site, FromWords::HalfBits, word)).collect()
    }

    pub(super) fn pack_clamped(&mut self, site: Site, args: &Args, low: i32, high: i32) -> Vec<Register> {
        let scalar = args[0][0].scalar;
        let (least, greatest) = match scalar {
            Scalar::I32 => (Word2::MinSigned, Word2::MaxSigned),
            Scalar::U32 | Scalar::F32 | Scalar::Bool => (Word2::MinUnsigned, Word2::MaxUnsigned),
        };
        let (low, high) = (self.word(low.cast_unsigned(), scalar), self.word(high.cast_unsigned(), scalar));
        let words: Vec<Register> = args[0]
            .iter()
            .map(|&x| {
                let raised = self.word2(site, greatest, x, low, scalar);
                self.word2(site, least, raised, high, scalar)
            })
            .collect();
        vec![self.pack(&words, 8)]
    }

    pub(super) fn packed_dot(&mut self, site: Site, args: &Args, op: Field, scalar: Scalar) -> Vec<Register> {
        let (multiply, add) = match scalar {
            Scalar::I32 => (Word2::MultiplySigned, Word2::AddSigned),
            Scalar::U32 | Scalar::F32 | Scalar::Bool => (Word2::MultiplyUnsigned, Word2::AddUnsigned),
        };
        let (a, b) = (self.unpack(args[0][0], 8, op, scalar), self.unpack(args[1][0], 8, op, scalar));
        let mut sum = self.word(0, scalar);
        for (a, b) in a.into_iter().zip(b) {
            let product = self.word2(site, multiply, a, b, scalar);
            sum = self.word2(site, add, sum, product, scalar);
        }
        vec![sum]
    }
}

/// What stands for 1.
fn largest(width: u32, signed: bool) -> f32 {
    ((1_u32 << (width - u32::from(signed))) - 1) as f32
}
