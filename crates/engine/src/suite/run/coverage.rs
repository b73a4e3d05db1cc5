//! Which segments of a strand a geometry stage draws, seen from what it emits.

use serde::{Deserialize, Serialize};
use std::fmt;

use super::trial::Trial;
use base::value::Shape;
use lanes::LaneError;
use property::generators::{Ends, Strands};
use property::{Sample, Sampler};

/// Strands that are looked at.
const STRANDS: usize = 64;
/// How near an end of a curve must be to its node, relative to the strand's size: far below any
/// distance between neighbouring nodes that differ, far above rounding.
const NEAR: f64 = 1e-4;

/// Segments between neighbouring nodes of strands, and how many of them are drawn.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Coverage {
    /// Nodes of one strand.
    pub nodes: usize,
    /// For each segment of a strand, whether every strand draws it.
    pub drawn: Vec<bool>,
    /// How the host feeds the ends.
    pub ends: Ends,
}

impl Coverage {
    /// True when every segment is drawn.
    pub fn is_complete(&self) -> bool {
        self.drawn.iter().all(|&d| d)
    }

    /// Segments of a strand that are not drawn.
    pub fn missing(&self) -> usize {
        self.drawn.iter().filter(|&&d| !d).count()
    }
}

impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (all, drawn) = (self.drawn.len(), self.drawn.len() - self.missing());
        write!(f, "strands of {} nodes: {drawn} of {all} segments are drawn", self.nodes)?;
        let missing: Vec<usize> = (0..all).filter(|&k| !self.drawn[k]).collect();
        if missing.is_empty() {
            return Ok(());
        }
        // Neighbouring segments that are missing are told as one gap.
        let gaps: Vec<&[usize]> = missing.chunk_by(|a, b| a + 1 == *b).collect();
        let list: Vec<String> = gaps.iter().map(|gap| format!("{}–{}", gap[0], gap[gap.len() - 1] + 1)).collect();
        write!(f, "; missing between nodes {}", list.join(" and "))?;
        if self.ends == Ends::AsDrawn && missing == [0, all - 1] {
            write!(
                f,
                " (a line strip with adjacency of m nodes gives m − 3 primitives; repeat the end nodes, which gives m − 1)"
            )?;
        }
        Ok(())
    }
}

/// Runs strands with every matrix uniform set to the identity and looks which segments come out.
///
/// # Errors
/// [`LaneError`] when the lane fails.
pub fn check(trial: &mut Trial<'_>, strands: Strands, seed: u64) -> Result<Coverage, LaneError> {
    let prepared = trial.prepared;
    let primitives = strands.primitives().max(1);
    let batch = Sampler::new(prepared.plan.clone(), seed).batch(0, STRANDS, primitives);
    let mut samples: Vec<_> = (0..batch.invocation_count()).map(|i| Sample::of(&batch, i)).collect();
    let identity: Vec<f64> = (0..16).map(|k| if k % 5 == 0 { 1.0 } else { 0.0 }).collect();
    for sample in &mut samples {
        let matrices: Vec<String> =
            sample.case_record.fields().iter().filter(|f| f.shape == Shape::MAT4).map(|f| f.name.clone()).collect();
        for name in matrices {
            sample.set(&name, &identity);
        }
    }
    let batch = Sample::batch(&samples);
    let actual = trial.run(&batch)?;
    let position = actual.layout().vertex.index_of("gl_Position").map(|i| actual.layout().vertex.range(i));
    let mut drawn = vec![true; strands.nodes.saturating_sub(1)];
    for strand in 0..STRANDS {
        let mut here = vec![false; drawn.len()];
        for primitive in 0..strands.primitives() {
            let invocation = strand * primitives + primitive;
            let nodes = samples[invocation].get("gl_Position");
            let (Some(position), stored @ 1..) = (position.clone(), actual.stored(invocation)) else { continue };
            let emitted = |vertex: usize| {
                let words = &actual.vertex(invocation, vertex)[position.clone()];
                words.iter().map(|&w| f64::from(f32::from_bits(w))).collect::<Vec<_>>()
            };
            let size = nodes.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
            let node = |corner: usize| &nodes[4 * corner..4 * corner + 4];
            let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= NEAR * size);
            let segment = strands.node(primitive, 1);
            let from_to = near(&emitted(0), node(1)) && near(&emitted(stored - 1), node(2));
            if from_to && segment < here.len() && strands.node(primitive, 2) == segment + 1 {
                here[segment] = true;
            }
        }
        drawn.iter_mut().zip(here).for_each(|(all, here)| *all &= here);
    }
    Ok(Coverage { nodes: strands.nodes, drawn, ends: strands.ends })
}
