//! Operations that round a number to another one than its nearest binary32.

use super::Tape;
use super::arena::{Id, Slots};
use super::lowered::SMALLEST;
use super::model::Model;
use crate::profile::Op;
use crate::profile::grid::MIN_NORMAL;

use program::interp::{FromWords, SLOTS, Site, Words};

impl Tape<'_> {
    /// True where a device may round a half either way.
    pub(super) fn is_open_at_ties(&self, site: Site) -> bool {
        site.is_open_at_ties() && matches!(self.model, Model::Device { .. })
    }

    /// Numbers out of the bits of binary16: a device may take subnormal ones for zero.
    pub(super) fn halves(&mut self, site: Site, id: Id) {
        let at = id as usize;
        let flushed = self.arena.value.get(at).map(|v| if v.abs() < SMALLEST { v.abs() } else { 0.0 });
        if flushed.iter().all(|error| *error == 0.0) {
            return;
        }
        self.err_by(Some(site), id, &flushed);
    }

    /// Numbers out of the bits of binary32: a device may take subnormal ones for zero (WGSL, 15.7.2, intermediate results of
    /// reinterpreted bits; GLSL 4.60, 4.7.1).
    pub(super) fn flush_bits(&mut self, site: Site, id: Id) {
        let at = id as usize;
        let tiny = |v: f64| v != 0.0 && v.abs() < MIN_NORMAL;
        if !self.model.flushes() || !self.arena.value.get(at).iter().any(|v| tiny(*v)) {
            return;
        }
        let flushed = self.arena.value.get(at).map(|v| if tiny(v) { v.abs() } else { 0.0 });
        self.err_by(Some(site), id, &flushed);
    }

    /// Leaves open what a device makes of numbers that are infinite or none, where it need not expect them.
    pub(super) fn open_special(&mut self, site: Option<Site>, words: &Words, id: Id) {
        let special = |word: u32| word & 0x7f80_0000 == 0x7f80_0000;
        // One look at all slots without branches: hardly ever there are any.
        let any = words.iter().fold(false, |any, &word| any | special(word));
        if !any || !self.model.assumes_finite() {
            return;
        }
        let at = id as usize;
        let known = self.arena.radius.get(at);
        let radius = std::array::from_fn(|slot| if special(words[slot]) { f64::INFINITY } else { known[slot] });
        self.err_by(site, id, &radius);
    }

    fn err_by(&mut self, site: Option<Site>, id: Id, error: &Slots) {
        let at = id as usize;
        *self.arena.radius.get_mut(at) = *error;
        *self.arena.local.get_mut(at) = *error;
        let meta = &mut self.arena.nodes[at];
        (meta.exact, meta.site) = (false, site);
        self.bracket(id);
    }

    /// The nearest binary16.
    pub(super) fn half(&mut self, site: Site, a: Id) -> Id {
        if self.leaves_half_out(site) {
            return a;
        }
        let before = *self.arena.value.get(a as usize);
        let mut values = before;
        program::interp::to_half(&mut values);
        let device = matches!(self.model, Model::Device { .. });
        let radius = self.arena.radius.get(a as usize);
        // To either neighbour, of the exact value or of the device's. What is subnormal in binary16 may become zero on any
        // device (WGSL, 17.5, `quantizeToF16`; SPIR-V, `OpQuantizeToF16`).
        let error: Slots = std::array::from_fn(|slot| {
            let size = before[slot].abs();
            let kept = values[slot] == before[slot] && radius[slot] == 0.0;
            let rounded = (values[slot] - before[slot]).abs() + 2f64.powi(-10) * size + 2f64.powi(-24);
            let rounded = if kept { 0.0 } else { rounded };
            let flushed = device && size - radius[slot] - rounded < SMALLEST;
            if flushed { rounded.max(values[slot].abs()) } else { rounded }
        });
        let id = self.identity(Some(site), Some(Op::Convert), a, &error);
        *self.arena.value.get_mut(id as usize) = values;
        self.bracket(id);
        id
    }

    /// x·2^-e with the exponent of the exact value; a device may have the neighbouring one.
    pub(super) fn frexp_fraction(&mut self, site: Site, a: Id) -> Id {
        let at = a as usize;
        let (x, e) = (*self.arena.value.get(at), *self.arena.radius.get(at));
        let exponent = |x: f64| if x == 0.0 || !x.is_finite() { 0.0 } else { x.abs().log2().floor() + 1.0 };
        let factor = self.leaf(|v| {
            for (v, x) in v.iter_mut().zip(&x) {
                *v = (-exponent(*x)).exp2();
            }
        });
        let id = self.product(site, Op::Ldexp, a, factor);
        let doubt: Slots = std::array::from_fn(|slot| {
            let same = exponent(x[slot] - e[slot]) == exponent(x[slot] + e[slot]);
            if same { 0.0 } else { 1.0 }
        });
        self.identity(Some(site), Some(Op::Ldexp), id, &doubt)
    }
}

/// Radii that reach to both sides of a jump: what rounds halves either way takes a number at the jump for one of either
/// side. Binary32 numbers and their sums with ½ lie farther from a jump than this, or on it.
pub(super) fn either_side(x: &Slots, ex: &Slots) -> Slots {
    std::array::from_fn(|slot| ex[slot].max(x[slot].abs().max(1.0) * 2f64.powi(-50)))
}

/// Moves the bits of the nearest binary16 on to the neighbour in a direction, where they lie on the other side of their number.
pub(super) fn half_outward(x: &Slots, bits: &mut Words, direction: f64) {
    let mut nearest = [0.0; SLOTS];
    program::interp::from_words(FromWords::HalfBits, bits, &mut nearest);
    for ((bits, nearest), x) in bits.iter_mut().zip(nearest).zip(x) {
        if (nearest - x) * direction < 0.0 {
            // Bits grow with the size of the number; next to zero lies the smallest one of the other sign.
            let away = nearest == 0.0 || (nearest > 0.0) == (direction > 0.0);
            let sign = if nearest == 0.0 && direction < 0.0 { 0x8000 } else { 0 };
            *bits = if nearest == 0.0 {
                sign + 1
            } else if away {
                *bits + 1
            } else {
                *bits - 1
            };
        }
    }
}

/// True when a number within `reach` of x that becomes one of binary16, as the bits of its ends joined say, may be
/// subnormal there, and a device may take it for zero: for conversions of 16 bits that is left to devices (GLSL 4.60, 4.7.1;
/// WGSL, 15.7.2; Vulkan without `shaderDenormPreserveFloat16`).
pub(super) fn may_flush(model: &Model<'_>, x: f64, reach: f64, bits: u32) -> bool {
    matches!(model, Model::Device { .. }) && x.abs() - reach < SMALLEST && bits & 0x7fff != 0
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::Tape;
    use super::super::tests::device;
    use base::text::SourceFile;
    use base::value::Batch;
    use program::Program;
    use program::interp::{self, FUEL, Machine, OutputColumn};
    use program::lower::Target;

    /// Value and bound of `float f(float x)` at x, and whether a decision is open on the way.
    fn of(profile: &str, body: &str, x: f32) -> (f64, f64, bool) {
        let file = SourceFile::new("f.glsl", format!("#version 450 core\nfloat f(float x) {{ return {body}; }}\n"));
        let program =
            Program::from_source(&file, syntax::Stage::Library, |_| Ok(Target::Function("f".into()))).unwrap();
        let batch = Batch {
            invocation_record: Arc::new(program.invocation_record()),
            case_record: Arc::new(program.case_record()),
            per_case: 1,
            invocations: vec![x.to_bits()],
            cases: Vec::new(),
        };
        let executable = interp::compile(&program).unwrap();
        let mut machine = Machine::new(&executable, Tape::new(device(profile, false)), FUEL);
        machine.run(&batch, 0);
        let OutputColumn::Real(&column) = machine.output(0, 0) else { panic!("a real number") };
        let tape = machine.domain();
        let bound = tape.bounds(column, &mut |_| false).bound[0];
        (tape.values(column)[0], bound, tape.fork(0).is_some())
    }

    #[test]
    fn a_half_goes_either_way_where_the_language_leaves_it_open_and_nowhere_else() {
        for profile in ["vulkan-1.4", "glsl-4.60", "binary32"] {
            for (body, x, open) in [
                ("round(x)", 0.5, true),
                ("round(x)", -3.5, true),
                ("round(x)", 0.75, false),
                ("round(x)", 0.5_f32.next_up(), false),
                ("round(x)", 2.0, false),
                ("roundEven(x)", 0.5, false),
                ("floor(x)", 2.0, false),
            ] {
                let (value, bound, _) = of(profile, body, x);
                assert_eq!(bound >= 1.0, open, "{profile} {body} at {x}: {value} ± {bound}");
                assert!(open || bound == 0.0, "{profile} {body} at {x}: {value} ± {bound}");
            }
            for (pack, x, open) in [
                ("unpackSnorm4x8(packSnorm4x8(vec4(x))).y", 0.5, true),
                ("unpackSnorm4x8(packSnorm4x8(vec4(x))).y", -0.5, true),
                ("unpackSnorm4x8(packSnorm4x8(vec4(x))).y", 0.3, false),
                ("unpackSnorm4x8(packSnorm4x8(vec4(x))).y", 1.0, false),
                ("unpackUnorm4x8(packUnorm4x8(vec4(x))).y", 0.5, true),
                ("unpackUnorm2x16(packUnorm2x16(vec2(x))).y", 0.5, true),
                ("unpackSnorm2x16(packSnorm2x16(vec2(x))).y", -0.5, true),
                ("unpackSnorm2x16(packSnorm2x16(vec2(x))).y", -0.25, false),
            ] {
                assert_eq!(of(profile, pack, x).2, open, "{profile} {pack} at {x}");
            }
        }
    }

    #[test]
    fn what_is_subnormal_in_binary16_may_be_zero() {
        let pack = "unpackHalf2x16(packHalf2x16(vec2(x, x))).x";
        for (x, open) in [(3e-5, true), (-6e-8, true), (1e-9, false), (0.0, false), (6.2e-5, false), (0.3, false)] {
            assert_eq!(of("llvmpipe-22.3.6", pack, x).2, open, "{x}");
        }
        // Where the direction of rounding is open as well, so is every number that binary16 does not have.
        for (x, open) in [(1e-9, true), (0.0, false), (0.25, false), (0.3, true), (-0.3, true), (65_504.0, false)] {
            assert_eq!(of("vulkan-1.4", pack, x).2, open, "{x}");
        }
        // 0x0200 is 2^-15.
        let (value, bound, _) = of("vulkan-1.4", "unpackHalf2x16(0x0200u).x", 0.0);
        assert_eq!((value, bound), (2f64.powi(-15), 2f64.powi(-15)));
        let (value, bound, _) = of("vulkan-1.4", "unpackHalf2x16(0x3c00u).x", 0.0);
        assert_eq!((value, bound), (1.0, 0.0));
    }

    #[test]
    fn a_true_value_that_binary64_takes_for_a_number_of_binary32_is_not_that_number() {
        // A device may give either neighbour of the true value; `below` is the one on the other side of it from 1.
        let below = f64::from(1.0_f32.next_down());
        for profile in ["vulkan-1.4", "vulkan-cts", "wgsl", "glsl-4.60"] {
            for (body, x) in [
                ("fract(x)", -1e-20),
                ("x - floor(x)", -1e-20),
                ("1.0 + x", -1e-20),
                ("1.0 - x", 1e-30),
                ("mod(x, 1.0)", -1e-20),
                ("sqrt(1.0 + x)", -1e-20),
                ("exp(x)", -1e-20),
            ] {
                let (value, bound, _) = of(profile, body, x);
                assert_eq!(value, 1.0, "{body}");
                assert!(value - bound <= below, "{profile} {body} at {x}: ± {bound:e}");
                assert!(bound < 1e-4 || profile == "glsl-4.60", "{profile} {body} at {x}: ± {bound:e}");
            }
            for (body, x) in [("1.0 + x", 0.5), ("fract(x)", -0.25), ("x - floor(x)", 1.75), ("1.0 - x", 1.0)] {
                assert_eq!(of(profile, body, x).1, 0.0, "{profile} {body} at {x}: nothing is lost");
            }
        }
    }
}
