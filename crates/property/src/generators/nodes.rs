//! `nodes`: several points that may coincide or lie on a line.

use base::value::{Scalar, Shape};

use super::{
    Generator, Group, Options, Place, RangeRule, Role, SPECIAL, Stream, every_shape, float, is_vector, spatial, word,
};

/// Points of a curve or the ends of a segment with a point beside it. Special: all at one place, two
/// neighbours at one place, two neighbours some thousandths of the range apart, all on a line
/// (exactly), the last on the segment of the first two or at one of its ends (exactly), lattice
/// points, edge values.
pub struct Nodes;

/// Eighths at which special nodes lie between two ends.
fn eighths(stream: &mut Stream) -> f64 {
    [0.0, 0.125, 0.25, 0.5, 0.5, 0.75, 0.875, 1.0][stream.below(8)]
}

fn special(group: &Group, stream: &mut Stream, out: &mut [u32]) {
    let (range, elements) = (group.range(), group.elements());
    let kind = stream.below(7);
    if kind == 4 || kind == 5 {
        for word in out.iter_mut() {
            *word = if kind == 4 { range.lattice(stream.bits()) } else { range.special(stream.bits()) }.to_bits();
        }
        return;
    }
    // Ends on a coarse grid: points between them at eighths are exact.
    let mut ends = [[0.0_f64; 4]; 2];
    for c in ends.as_flattened_mut() {
        *c = f64::from(range.on_grid(stream.bits()));
    }
    let last = elements.len() - 1;
    let pair = stream.below(last);
    for (i, element) in elements.iter().enumerate() {
        let on_segment = match (kind, i) {
            (0, _) => Some(0.0),
            (2, _) => Some(eighths(stream)),
            (3, 0) => Some(0.0),
            (3, 1) => Some(1.0),
            (3, i) if i == last => Some(eighths(stream)),
            _ => None,
        };
        for (c, at) in element.clone().enumerate() {
            let value = match on_segment {
                Some(t) => ends[0][c] + (ends[1][c] - ends[0][c]) * t,
                None => f64::from(range.ordinary(stream.bits())),
            };
            out[at] = word(value);
        }
    }
    if kind == 1 {
        let (from, to) = (elements[pair].clone(), elements[pair + 1].start);
        out.copy_within(from, to);
    }
    if kind == 6 {
        // Between coincidence and ordinary distances: a threshold on the distance must not hide.
        for (from, to) in elements[pair].clone().zip(elements[pair + 1].clone()) {
            let (near, far) = (f64::from(float(out[from])), f64::from(float(out[to])));
            out[to] = word(near + (far - near) / 1024.0);
        }
    }
}

impl Generator for Nodes {
    fn name(&self) -> &str {
        "nodes"
    }

    fn about(&self) -> &str {
        "points with coordinates in `range` that may coincide or lie on a line; the fourth component is 1"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Default(-2.0, 2.0)
    }

    fn takes_components(&self) -> bool {
        true
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "floats, vec2, vec3, vec4 and arrays of them", |s| {
            is_vector(s) || s.element() == Shape::vector(Scalar::F32, 1)
        })?;
        if shapes.iter().any(|s| s.rows != shapes[0].rows) {
            return Err("generator `nodes` needs inputs that all have the same number of components".into());
        }
        match shapes.iter().map(|s| s.elements()).sum() {
            0 | 1 => Err("generator `nodes` needs at least two points; use `point` for one".into()),
            _ => Ok(()),
        }
    }

    fn fill(&self, group: &Group, _place: Place, stream: &mut Stream, out: &mut [u32]) {
        if stream.one_in(SPECIAL) {
            special(group, stream, out);
        } else {
            for word in out.iter_mut() {
                *word = group.range().ordinary(stream.bits()).to_bits();
            }
        }
        spatial::set_w(group, 1.0, out);
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        spatial::admits(group, 1.0, words)
    }

    fn role(&self) -> Role {
        Role::Place
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        spatial::simplest(group, 1.0, out);
    }

    fn simpler(&self, group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        // All nodes moved so that node `k` is the origin: what matters is often only how they lie to
        // each other.
        let Some(origin) = group.elements().get(k) else { return false };
        for element in group.elements() {
            for (c, at) in element.clone().enumerate().take(3) {
                out[at] = (float(words[at]) - float(words[origin.start + c])).to_bits();
            }
        }
        true
    }
}
