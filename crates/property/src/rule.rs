//! How the relations of this folder are written: a table of functions, inputs by name, claims.

use crate::ball::Ball;
use crate::{Claim, Observed, Relation, Sample};

/// How many words an input must have for a relation to speak of it.
#[derive(Clone, Copy, Debug)]
pub enum Words {
    /// A point: four words, or three where the host feeds three and w is filled with 1.
    Point,
    /// Exactly this number.
    Exactly(usize),
    /// A multiple of so many, and not zero: an array.
    Each(usize),
}

/// A relation as data.
pub struct Rule {
    /// Name, as suites write it.
    pub name: &'static str,
    /// What it says, as one sentence without a full stop.
    pub statement: &'static str,
    /// Inputs that a sample must have; without them the relation says nothing.
    pub needs: &'static [(&'static str, Words)],
    /// The inputs to run; `None` where the relation says nothing.
    pub inputs: fn(&Sample) -> Option<Vec<Sample>>,
    /// The claims on the outputs of these inputs.
    pub claims: fn(&[Sample], &[Observed], &mut Claims<'_>),
}

impl Relation for Rule {
    fn name(&self) -> &str {
        self.name
    }

    fn statement(&self) -> &str {
        self.statement
    }

    fn inputs(&self, sample: &Sample) -> Vec<Sample> {
        let fits = self.needs.iter().all(|(name, words)| {
            let len = sample.words(name).map_or(0, <[u32]>::len);
            match *words {
                Words::Point => len == 3 || len == 4,
                Words::Exactly(wanted) => len == wanted,
                Words::Each(part) => len > 0 && len.is_multiple_of(part),
            }
        });
        if fits { (self.inputs)(sample).unwrap_or_default() } else { Vec::new() }
    }

    fn claims(&self, inputs: &[Sample], outputs: &[Observed], claims: &mut Vec<Claim>) {
        // A relation that says nothing has no inputs.
        if !inputs.is_empty() && inputs.len() == outputs.len() {
            (self.claims)(inputs, outputs, &mut Claims(claims));
        }
    }
}

/// The claims of one relation on one sample.
pub struct Claims<'a>(pub &'a mut Vec<Claim>);

impl Claims<'_> {
    /// Claims that two numbers are equal; nothing when one of them is unknown.
    pub fn equal(&mut self, what: impl Into<String>, left: Ball, right: Ball) {
        if left.is_unknown() || right.is_unknown() {
            return;
        }
        // The relation itself is evaluated in binary64, with some dozens of roundings.
        let rounding = 1e-12 * left.mid.abs().max(right.mid.abs());
        let slack = left.rad + right.rad + rounding;
        self.0.push(Claim { what: what.into(), left: left.mid, right: right.mid, slack });
    }

    /// Claims that a number is no more than another.
    pub fn at_most(&mut self, what: impl Into<String>, left: Ball, right: Ball) {
        // f64::max would drop a NaN on the left.
        let mid = if left.mid <= right.mid { right.mid } else { left.mid };
        self.equal(what, Ball { mid, ..left }, right);
    }

    /// Claims that two vectors are equal.
    pub fn equal_vec<const N: usize>(&mut self, what: &str, left: [Ball; N], right: [Ball; N]) {
        for (k, (left, right)) in left.into_iter().zip(right).enumerate() {
            self.equal(format!("{what}.{}", ["x", "y", "z", "w"].get(k).unwrap_or(&"?")), left, right);
        }
    }

    /// Claims what has no slack: a sign, a count.
    pub fn holds(&mut self, what: impl Into<String>, holds: bool) {
        self.0.push(Claim { what: what.into(), left: f64::from(u8::from(holds)), right: 1.0, slack: 0.0 });
    }
}

/// Identity matrix, column by column.
pub const IDENTITY: [f64; 16] = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];

/// Finest step of the grid that points are put on where sums and differences have to be exact in
/// binary32: coordinates below 2^13 then have a step to spare.
const GRID: f64 = 1024.0;

/// A number moved to the grid.
pub fn on_grid(x: f64) -> f64 {
    (x * GRID).round() / GRID
}

/// A copy of the sample with `change` made to it.
pub fn with(sample: &Sample, change: impl FnOnce(&mut Sample) -> Option<()>) -> Option<Sample> {
    let mut copy = sample.clone();
    change(&mut copy)?;
    Some(copy)
}

/// A copy of the sample in which the outer matrices are the identity, so that the outputs are the
/// positions themselves.
pub fn plain(sample: &Sample) -> Option<Sample> {
    with(sample, |s| {
        for name in ["mc", "projectionMatrix"] {
            if s.words(name).is_some() {
                put(s, name, &IDENTITY)?;
            }
        }
        Some(())
    })
}

/// Sets an input; `None` when a value is not one that the input can hold exactly.
pub fn put(sample: &mut Sample, name: &str, values: &[f64]) -> Option<()> {
    if sample.words(name)?.len() != values.len() {
        return None;
    }
    sample.set(name, values);
    (sample.get(name) == values).then_some(())
}

/// A number among the inputs.
pub fn number(sample: &Sample, name: &str) -> Option<f64> {
    sample.get(name).first().copied()
}

/// A point among the inputs, w = 1 when it has three components.
pub fn point(sample: &Sample, name: &str) -> Option<[f64; 4]> {
    match sample.get(name)[..] {
        [x, y, z] => Some([x, y, z, 1.0]),
        [x, y, z, w] => Some([x, y, z, w]),
        _ => None,
    }
}

/// Sets a point; `None` when it cannot be held exactly, or has another w than the 1 that a
/// three-component input is filled with.
pub fn put_point(sample: &mut Sample, name: &str, value: [f64; 4]) -> Option<()> {
    let len = sample.words(name)?.len();
    if len == 3 && value[3] != 1.0 {
        return None;
    }
    put(sample, name, &value[..len.min(4)])
}

/// A point among the inputs, moved to the grid.
pub fn grid_point(sample: &Sample, name: &str) -> Option<[f64; 4]> {
    Some(point(sample, name)?.map(on_grid))
}

/// A number made of all words of the sample, to choose one of several variants by.
pub fn hash(sample: &Sample) -> u64 {
    let words = sample.invocation.iter().chain(&sample.case);
    // FNV-1a, then the high half, whose bits depend on all words.
    words.fold(0xcbf2_9ce4_8422_2325_u64, |h, &w| (h ^ u64::from(w)).wrapping_mul(0x0000_0100_0000_01b3)) >> 32
}

/// An affine map that binary32 carries out exactly on a grid: axes exchanged and reversed, a scale
/// that is a power of two, a shift by integers.
#[derive(Clone, Copy, Debug)]
pub struct Exact {
    axes: [usize; 3],
    signs: [f64; 3],
    shift: [f64; 3],
}

impl Exact {
    /// A rotation, possibly with a reflection.
    pub fn turn(choice: u64) -> Self {
        let axes = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]][(choice % 6) as usize];
        let signs = std::array::from_fn(|k| if ((choice / 6) >> k) & 1 == 1 { -1.0 } else { 1.0 });
        Self { axes, signs, shift: [0.0; 3] }
    }

    /// A rotation followed by a shift.
    pub fn rigid(choice: u64) -> Self {
        let shift = std::array::from_fn(|k| ((choice >> (8 + 3 * k)) % 7) as f64 - 3.0);
        Self { shift, ..Self::turn(choice) }
    }

    /// The same without a reflection.
    pub fn proper(self) -> Self {
        // Exchanging two axes is a reflection, and so is each change of sign.
        let exchanges = (0..3).flat_map(|i| (i + 1..3).map(move |j| (i, j)));
        let odd = exchanges.filter(|&(i, j)| self.axes[i] > self.axes[j]).count();
        let negative = self.signs.iter().filter(|s| **s < 0.0).count();
        let mut signs = self.signs;
        if (odd + negative) % 2 == 1 {
            signs[0] = -signs[0];
        }
        Self { signs, ..self }
    }

    /// A rotation with a scale of 1/2 or 2, followed by a shift.
    pub fn affine(choice: u64) -> Self {
        let scale = if choice >> 20 & 1 == 1 { 2.0 } else { 0.5 };
        let rigid = Self::rigid(choice);
        Self { signs: rigid.signs.map(|s| s * scale), ..rigid }
    }

    /// The image of a homogeneous column.
    pub fn apply(&self, p: [f64; 4]) -> [f64; 4] {
        let [x, y, z] = std::array::from_fn(|k| self.signs[k] * p[self.axes[k]] + self.shift[k] * p[3]);
        [x, y, z, p[3]]
    }

    /// The image of an output.
    pub fn apply_ball(&self, p: [Ball; 4]) -> [Ball; 4] {
        let [x, y, z] = std::array::from_fn(|k| p[self.axes[k]] * self.signs[k] + p[3] * self.shift[k]);
        [x, y, z, p[3]]
    }

    /// The matrix, column by column.
    pub fn matrix(&self) -> [f64; 16] {
        self.after(IDENTITY)
    }

    /// The matrix of this map after another one.
    pub fn after(&self, matrix: [f64; 16]) -> [f64; 16] {
        let mut product = [0.0; 16];
        for (column, image) in matrix.chunks_exact(4).zip(product.chunks_exact_mut(4)) {
            image.copy_from_slice(&self.apply([column[0], column[1], column[2], column[3]]));
        }
        product
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inequality_fails_above_and_for_nan_only() {
        let mut list = Vec::new();
        let mut claims = Claims(&mut list);
        for x in [0.5, 1.0, 1.5, f64::NAN] {
            claims.at_most("x", Ball { mid: x, rad: 0.1 }, Ball::from(1.0));
        }
        claims.at_most("x", Ball::from(0.0), Ball::from(f64::NAN));
        let holds: Vec<bool> = list.iter().map(|c| (c.left - c.right).abs() <= c.slack).collect();
        assert_eq!(holds, [true, true, false, false, false]);
    }

    #[test]
    fn nothing_is_claimed_of_the_unknown() {
        let mut list = Vec::new();
        let mut claims = Claims(&mut list);
        for mid in [0.0, f64::NAN] {
            claims.equal("x", Ball { mid, rad: f64::INFINITY }, Ball::from(1.0));
            claims.at_most("x", Ball::from(2.0), Ball { mid, rad: f64::INFINITY });
        }
        assert!(list.is_empty());
    }

    #[test]
    fn exact_maps_multiply_as_matrices() {
        let map = Exact::affine(0x0012_3457);
        let p = [1.0, 2.0, 4.0, 1.0];
        let m = map.matrix();
        let product: [f64; 4] = std::array::from_fn(|r| (0..4).map(|c| m[4 * c + r] * p[c]).sum());
        assert_eq!(product, map.apply(p));
        assert_eq!(map.apply_ball(p.map(Ball::from)).map(|b| b.mid), product);
    }

    #[test]
    fn maps_differ_and_keep_the_grid() {
        let images: Vec<_> = (0..48).map(|i| Exact::turn(i).apply([1.0, 2.0, 4.0, 1.0])).collect();
        for (i, image) in images.iter().enumerate() {
            assert!(!images[..i].contains(image), "{image:?}");
        }
        let p = [on_grid(0.3), on_grid(-1.7), on_grid(1e-9), 1.0];
        for choice in 0..1000 {
            let image = Exact::affine(choice * 7919).apply(p);
            assert!(image.iter().all(|&x| f64::from(x as f32) == x));
        }
    }
}
