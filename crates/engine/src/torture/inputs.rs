//! What fills the inputs of programs: ordinary numbers, corners of binary32 and of integers, and inputs that showed
//! something before.

use std::collections::BTreeMap;
use std::sync::Arc;

use base::value::{Scalar, Shape};
use property::generators::{Generator, Group, Options, Place, RangeRule};
use property::{InputGroup, Own, Stream};

/// One word in so many is a corner.
const CORNER: usize = 5;
/// One sample in so many is made anew where one is kept.
const ANEW: usize = 6;

/// Numbers in binary32 at which built-in functions have their edges: zeros, ties of rounding and of packing, the first
/// numbers that are subnormal, and numbers without a fraction.
const FLOATS: [f32; 26] = [
    0.0,
    -0.0,
    0.5,
    -0.5,
    1.0,
    -1.0,
    1.5,
    -1.5,
    2.0,
    2.5,
    3.0,
    -2.5,
    0.25,
    4.0,
    1e-3,
    -1e-3,
    1e-8,
    -1e-8,
    1e-20,
    1e-30,
    6.1e-5,
    3e-6,
    0.499_999_97,
    0.999_999_94,
    255.0,
    1024.0,
];
const INTS: [i32; 12] = [0, 1, -1, 2, -2, 31, 32, 255, 65_535, i32::MAX, i32::MIN, 0x5555_5555];

/// The generator of one input.
struct Corners {
    /// Words that showed something before.
    kept: Option<Vec<u32>>,
}

impl Generator for Corners {
    fn name(&self) -> &'static str {
        "corners"
    }

    fn about(&self) -> &'static str {
        "numbers of ordinary size, and those at which functions have their edges"
    }

    fn range(&self) -> RangeRule {
        RangeRule::None
    }

    fn check(&self, _: &[Shape], _: &Options) -> Result<(), String> {
        Ok(())
    }

    fn fill(&self, group: &Group, _: Place, stream: &mut Stream, out: &mut [u32]) {
        let anew = stream.one_in(ANEW);
        if let Some(kept) = self.kept.as_ref().filter(|kept| !anew && kept.len() == out.len()) {
            out.copy_from_slice(kept);
            return;
        }
        for (word, scalar) in out.iter_mut().zip(group.scalars()) {
            let corner = stream.one_in(CORNER);
            *word = match scalar {
                Scalar::F32 if corner => FLOATS[stream.below(FLOATS.len())].to_bits(),
                Scalar::F32 => (stream.between(-4.0, 4.0) as f32).to_bits(),
                Scalar::I32 | Scalar::U32 if corner => INTS[stream.below(INTS.len())] as u32,
                Scalar::I32 => (stream.below(200) as i32 - 100) as u32,
                Scalar::U32 => stream.below(200) as u32,
                Scalar::Bool => u32::from(stream.one_in(2)),
            };
        }
    }

    fn admits(&self, _: &Group, _: &[u32]) -> bool {
        true
    }

    fn simplest(&self, _: &Group, out: &mut [u32]) {
        out.fill(0);
    }

    fn edges(&self, _: &Group, _: &[u32]) -> Vec<Vec<u32>> {
        Vec::new()
    }
}

/// The groups of a suite with these generators in place of what its file names.
pub fn groups(groups: &[InputGroup], kept: &BTreeMap<String, Vec<u32>>) -> Vec<InputGroup> {
    let own = |group: &InputGroup| {
        let kept = group.names.first().and_then(|name| kept.get(name)).cloned();
        InputGroup { generator: Own::Shared(Arc::new(Corners { kept })), options: Options::default(), ..group.clone() }
    };
    groups.iter().map(own).collect()
}
