//! From captured words to the records in which every lane gives its outputs.

use super::ask::unsupported;
use super::job::{Captured, Output};
use crate::strips::{self, Meant};
use crate::{LaneError, Marks};
use program::OutputLayout;
use program::interp::Meaning;

/// Records of a vertex stage: one captured vertex each.
pub fn points(layout: &OutputLayout, captured: &Captured, count: usize, marks: Marks) -> Result<Vec<u32>, LaneError> {
    let width = layout.vertex_words();
    if captured.words.len() != count * width {
        return Err(LaneError::Api(format!("{} words captured for {count} vertices", captured.words.len())));
    }
    let mut words = Vec::with_capacity(count * layout.words());
    for (invocation, vertex) in captured.words.chunks_exact(width).enumerate() {
        words.push(marks.canary ^ invocation as u32);
        words.extend_from_slice(vertex);
    }
    Ok(words)
}

/// Records of a geometry stage: strips, put together again.
pub fn strips(
    layout: &OutputLayout,
    (output, captured): (Output, &Captured),
    count: usize,
    meaning: Option<&Meaning<u32>>,
    marks: Marks,
) -> Result<Vec<u32>, LaneError> {
    let width = layout.vertex.words();
    let most = layout.max_vertices.unwrap_or(1) as usize;
    let total: usize = captured.primitives.iter().map(|&n| n as usize * output.vertices() * width).sum();
    if captured.primitives.len() != count || captured.words.len() != total {
        let (words, draws) = (captured.words.len(), captured.primitives.len());
        return Err(LaneError::Api(format!("{words} words captured of {draws} primitives, for {count}")));
    }
    let mut words = vec![marks.sentinel; layout.words() * count];
    let mut first = 0;
    for (invocation, record) in words.chunks_exact_mut(layout.words()).enumerate() {
        let primitives = captured.primitives[invocation] as usize;
        let vertex = |v: usize| &captured.words[(first + v) * width..][..width];
        let stored: Vec<u32> =
            meaning.map_or_else(Vec::new, |m| (0..m.stored(invocation)).map(|v| m.strip(invocation, v)).collect());
        let meant = meaning.map(|m| Meant { count: m.emitted(invocation), strips: &stored });
        let found = strips::emitted(output.vertices(), primitives, &vertex, meant).map_err(|lost| {
            unsupported(format!(
                "vertex {} of primitive {invocation}, in a strip of {}: transform feedback captures whole primitives alone",
                lost.vertex, lost.of
            ))
        })?;
        record[0] = marks.canary ^ invocation as u32;
        record[1] = found.count;
        record[2] = found.strips.last().map_or(0, |last| last + 1);
        let size = layout.vertex_words();
        let places = record[layout.header_words()..].chunks_exact_mut(size).take(most);
        for (place, (&strip, &copy)) in places.zip(found.strips.iter().zip(&found.copies)) {
            place[0] = strip;
            place[1..].copy_from_slice(vertex(copy));
        }
        first += primitives * output.vertices();
    }
    Ok(words)
}
