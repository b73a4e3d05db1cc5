//! `node_run`: consecutive nodes of strands, as strips with adjacency hand them to a geometry stage.

use base::value::Shape;
use glam::DVec3;

use property::generators::{
    Generator, Group, Nodes, Options, Place, Range, RangeRule, Role, SPECIAL, View, is_vector, spatial, word,
};
use property::{Stream, mix};

/// Windows of strands: primitive k of a case sees the nodes k to k + N - 1 of the case's run, so that
/// neighbouring primitives share nodes. With `[strands]` the run consists of strands of that many
/// nodes, with their ends as the host draws them.
///
/// Special strands: all nodes at one place, two neighbours at one place, all on a line (exactly), to
/// and fro between two places, all in the origin. Special nodes: lattice points and edge values.
pub struct NodeRun;

/// What is special about the nodes of a strand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StrandKind {
    /// All are at one place.
    OnePlace,
    /// Two neighbours are at one place.
    Pair,
    /// All are on a line.
    Line,
    /// They go to and fro between two places.
    ToAndFro,
    /// All are in the origin.
    Origin,
    Ordinary,
}

impl StrandKind {
    /// The special ones, which are as likely as each other.
    const SPECIAL: [Self; 5] = [Self::OnePlace, Self::Pair, Self::Line, Self::ToAndFro, Self::Origin];
}

/// One strand, as a function from the index of a node to its place.
struct Strand {
    seed: u64,
    kind: StrandKind,
    /// The first of the two neighbours.
    pair: usize,
}

impl Strand {
    fn new(case_seed: u64, strand: usize) -> Self {
        let seed = mix(mix(case_seed, u64::MAX), strand as u64);
        let mut stream = Stream::new(seed);
        let special = stream.one_in(SPECIAL);
        let kind =
            if special { StrandKind::SPECIAL[stream.below(StrandKind::SPECIAL.len())] } else { StrandKind::Ordinary };
        Self { seed, kind, pair: stream.below(4) }
    }

    /// Component `c` of node `n`.
    fn component(&self, group: &Group, n: usize, c: usize) -> f64 {
        let range = group.range();
        let bits = |n: usize| mix(mix(self.seed, n as u64), c as u64);
        let end = |n: usize| f64::from(range.on_grid(bits(n)));
        match self.kind {
            StrandKind::OnePlace => end(0),
            StrandKind::Line => {
                // Eighths of the way between two places, there and back.
                let step = n % 16;
                let step = if step > 8 { 16 - step } else { step };
                end(0) + (end(1) - end(0)) * step as f64 / 8.0
            }
            StrandKind::ToAndFro => end(n % 2),
            StrandKind::Origin => f64::from(range.clamp(0.0)),
            StrandKind::Pair | StrandKind::Ordinary => {
                let n = if self.kind == StrandKind::Pair && n == self.pair + 1 { self.pair } else { n };
                let choice = mix(mix(self.seed, n as u64), u64::MAX);
                f64::from(match choice % 16 {
                    0 => range.lattice(bits(n)),
                    1 => range.special(bits(n)),
                    _ => range.ordinary(bits(n)),
                })
            }
        }
    }
}

/// Node number `node` of `nodes` of a strand that hangs down.
fn hanging(range: &Range, (strand, strands): (usize, usize), (node, nodes): (usize, usize)) -> DVec3 {
    let (center, half) = range.middle();
    let part = |k: usize, n: usize| 2.0 * k as f64 / (n.max(2) - 1) as f64 - 1.0;
    let (across, down) = (part(strand, strands), part(node, nodes));
    let swing = 0.16 * (1.0 + down) * (2.2 * down + 4.0 * across).sin();
    DVec3::splat(center) + half * DVec3::new(0.8 * across + 0.6 * swing, -0.9 * down, 0.35 * across * across + swing)
}

impl Generator for NodeRun {
    fn name(&self) -> &str {
        "node_run"
    }

    fn about(&self) -> &str {
        "consecutive nodes of strands with coordinates in `range`; neighbouring primitives share nodes"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Default(-2.0, 2.0)
    }

    fn check(&self, shapes: &[Shape], options: &Options) -> Result<(), String> {
        let [shape] = shapes else {
            return Err(format!("generator `node_run` fills one array of points, not {} inputs", shapes.len()));
        };
        if !is_vector(shape) || shape.array.is_none_or(|n| n == 0) {
            return Err(format!("generator `node_run` fills an array of vec2, vec3 or vec4, not {shape}"));
        }
        match (options.strands, shape.elements()) {
            (Some(_), n) if n != 4 => {
                Err(format!("strips with adjacency hand over 4 nodes a primitive; `{shape}` has {n}"))
            }
            _ => Ok(()),
        }
    }

    fn fill(&self, group: &Group, place: Place, _stream: &mut Stream, out: &mut [u32]) {
        let strands = group.options().strands;
        let per_strand = strands.map_or(usize::MAX, |s| s.primitives().max(1));
        let strand = Strand::new(place.case_seed, place.invocation / per_strand);
        let primitive = place.invocation % per_strand;
        for (corner, element) in group.elements().iter().enumerate() {
            let n = strands.map_or(primitive + corner, |s| s.node(primitive, corner));
            for (c, at) in element.clone().enumerate().take(3) {
                out[at] = word(strand.component(group, n, c));
            }
        }
        spatial::set_w(group, 1.0, out);
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        spatial::admits(group, 1.0, words)
    }

    fn role(&self) -> Role {
        Role::Strand
    }

    fn arrange(&self, group: &Group, view: &View, out: &mut [u32]) {
        let Some(strands) = group.options().strands else { return };
        for (corner, element) in group.elements().iter().enumerate() {
            let node = (strands.node(view.primitive, corner), strands.nodes);
            for (at, c) in element.clone().zip(hanging(group.range(), view.strand, node).to_array()) {
                out[at] = word(c);
            }
        }
        spatial::set_w(group, 1.0, out);
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        spatial::simplest(group, 1.0, out);
    }

    fn simpler(&self, group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        Nodes.simpler(group, words, k, out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strands_of_a_picture_stay_in_the_range() {
        for range in [Range::new(-2.0, 2.0), Range::new(0.5, 4.0)] {
            for (u, v) in (0..25).flat_map(|u| (0..25).map(move |v| (u, v))) {
                let node = hanging(&range, (u, 25), (v, 25));
                assert!(node.to_array().iter().all(|&c| range.contains(c as f32)), "{u} {v}");
            }
        }
    }
}
