//! From the primitives that transform feedback captures back to the vertices that a geometry stage emitted.
//!
//! A device cuts strips into lines or triangles and captures these, each with vertices of its own; of a strip
//! that is too short for one it captures nothing. Here primitives are counted in the order of the capture, and
//! a captured vertex is named by its primitive and its corner there.

use crate::{Actual, LaneError, Marks};
use program::OutputLayout;

/// A captured vertex: number of its primitive, and corner in it.
pub(super) type Corner = (usize, usize);

/// The emitted vertices at the corners of primitive `k` of a strip that begins at vertex `first`.
fn corners_of(corners: usize, first: usize, k: usize) -> [usize; 3] {
    let v = first + k;
    // Every second triangle of a strip is turned, so that all face the same way.
    if corners == 3 && k % 2 == 1 { [v + 1, v, v + 2] } else { [v, v + 1, v + 2] }
}

/// True when a captured primitive has these vertices: triangles may begin at any corner.
fn fits(corners: usize, primitive: usize, vertices: [usize; 3], is: &impl Fn(Corner, usize) -> bool) -> bool {
    let turned = |by: usize| (0..corners).all(|c| is((primitive, c), vertices[(c + by) % corners]));
    if corners == 3 { (0..3).any(turned) } else { turned(0) }
}

/// True when the captured primitives are those into which these strips are cut. `corners` is 1 for points, 2 for
/// lines and 3 for triangles, `strips` has the number of the strip of each emitted vertex, and `is` tells whether
/// a captured vertex is that emitted one.
pub(super) fn are_cut_from(
    corners: usize,
    strips: &[u32],
    captured: usize,
    is: impl Fn(Corner, usize) -> bool,
) -> bool {
    let (mut first, mut primitive) = (0, 0);
    while first < strips.len() {
        let rest = &strips[first..];
        // A point is a primitive, whatever strip it is in.
        let length = if corners == 1 { 1 } else { rest.iter().take_while(|&&s| s == rest[0]).count() };
        for k in 0..(length + 1).saturating_sub(corners) {
            if primitive == captured || !fits(corners, primitive, corners_of(corners, first, k), &is) {
                return false;
            }
            primitive += 1;
        }
        first += length;
    }
    primitive == captured
}

/// The emitted vertices, each with its strip, from the captured primitives alone: a primitive goes on with the strip
/// before it when it shares all but one vertex with the primitive before. Vertices of strips that are too short are
/// not there.
pub(super) fn joined(corners: usize, captured: usize, same: impl Fn(Corner, Corner) -> bool) -> Vec<(Corner, u32)> {
    let mut vertices: Vec<(Corner, u32)> = Vec::new();
    let (mut strip, mut length) = (0, 0);
    for primitive in 0..captured {
        let known = vertices.len();
        // Of the strip so far, the vertices that the next primitive of it must have.
        let goes_on = corners > 1 && length >= corners && {
            let (a, b) = (vertices[known + 1 - corners].0, vertices[known - 1].0);
            let turned = length % 2 == 0;
            let at = |c: usize| (primitive, c % 3);
            match corners {
                2 => same((primitive, 0), b),
                // The new vertex is the one that is left; triangles may begin at any corner.
                _ => (0..3).any(|c| {
                    let (x, y) = if turned { (at(c), at(c + 1)) } else { (at(c + 1), at(c)) };
                    same(x, a) && same(y, b)
                }),
            }
        };
        if goes_on {
            let last = match corners {
                2 => 1,
                _ => {
                    let (a, b) = (vertices[known - 2].0, vertices[known - 1].0);
                    (0..3).find(|&c| !same((primitive, c), a) && !same((primitive, c), b)).unwrap_or(2)
                }
            };
            vertices.push(((primitive, last), strip));
            length += 1;
        } else {
            strip += u32::from(corners > 1 && !vertices.is_empty());
            vertices.extend((0..corners).map(|c| ((primitive, c), strip)));
            length = corners;
        }
    }
    vertices
}

/// Records of a batch that a lane puts together itself, as [`OutputLayout`] has them.
///
/// A record gets its canary when it is ended; a lane ends it when the device has said that it wrote it.
pub(super) struct Records<'a> {
    layout: &'a OutputLayout,
    words: Vec<u32>,
    count: usize,
    marks: Marks,
}

impl<'a> Records<'a> {
    /// Records of `count` invocations in which nothing is written.
    pub fn new(layout: &'a OutputLayout, count: usize, marks: Marks) -> Self {
        Self { layout, words: vec![marks.sentinel; layout.words() * count], count, marks }
    }

    /// The words of a vertex; `None` for one past the limit, which is counted and not stored. A pointwise program
    /// has one.
    pub fn vertex(&mut self, invocation: usize, vertex: usize, strip: u32) -> Option<&mut [u32]> {
        if vertex >= self.layout.max_vertices.unwrap_or(1) as usize {
            return None;
        }
        let at = invocation * self.layout.words() + self.layout.header_words() + vertex * self.layout.vertex_words();
        let words = &mut self.words[at..][..self.layout.vertex_words()];
        if self.layout.max_vertices.is_none() {
            return Some(words);
        }
        words[0] = strip;
        Some(&mut words[1..])
    }

    /// Ends the record of an invocation that emitted so many vertices and ended so many strips.
    pub fn end(&mut self, invocation: usize, emitted: u32, ended: u32) {
        let at = invocation * self.layout.words();
        self.words[at] = self.marks.canary ^ invocation as u32;
        if self.layout.max_vertices.is_some() {
            self.words[at + 1..][..2].copy_from_slice(&[emitted, ended]);
        }
    }

    /// The outputs, when all records were ended.
    ///
    /// # Errors
    /// [`LaneError::NotWritten`] otherwise.
    pub fn accept(self) -> Result<Actual, LaneError> {
        Actual::accept(self.layout, self.words, self.count, self.marks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a device captures of strips of vertices with these names; the odd triangles begin at corner `turn`.
    fn cut(corners: usize, strips: &[&[u32]], turn: usize) -> Vec<Vec<u32>> {
        let mut captured = Vec::new();
        for strip in strips {
            for k in 0..(strip.len() + 1).saturating_sub(corners) {
                let mut primitive = strip[k..k + corners].to_vec();
                if corners == 3 && k % 2 == 1 {
                    primitive.swap(0, 1);
                    primitive.rotate_left(turn);
                }
                captured.push(primitive);
            }
        }
        captured
    }

    fn numbers(strips: &[&[u32]]) -> (Vec<u32>, Vec<u32>) {
        let numbers = strips.iter().zip(0..).flat_map(|(strip, k)| strip.iter().map(move |_| k)).collect();
        (strips.concat(), numbers)
    }

    const STRIPS: [&[&[u32]]; 4] =
        [&[&[1, 2, 3, 4, 5, 6]], &[&[1, 2, 3], &[4, 5, 6, 7]], &[], &[&[1, 2, 3, 4], &[5, 6, 7], &[8, 9, 10, 11, 12]]];

    #[test]
    fn strips_come_back_from_lines_and_triangles() {
        for (corners, turn) in [(2, 0), (3, 0), (3, 1), (3, 2)] {
            for strips in STRIPS {
                let captured = cut(corners, strips, turn);
                let (names, expected) = numbers(strips);
                let is = |(p, c): Corner, v: usize| captured[p][c] == names[v];
                assert!(are_cut_from(corners, &expected, captured.len(), is), "{corners} {turn} {strips:?}");
                let same = |(p, c): Corner, (q, d): Corner| captured[p][c] == captured[q][d];
                let found = joined(corners, captured.len(), same);
                assert_eq!(found.iter().map(|&((p, c), _)| captured[p][c]).collect::<Vec<_>>(), names);
                assert_eq!(found.iter().map(|&(_, strip)| strip).collect::<Vec<_>>(), expected);
            }
        }
    }

    #[test]
    fn a_dropped_an_exchanged_and_an_added_primitive_are_noticed() {
        for corners in [2, 3] {
            let strips: &[&[u32]] = &[&[1, 2, 3, 4], &[5, 6, 7]];
            let (names, numbers) = numbers(strips);
            let whole = cut(corners, strips, 1);
            let fits = |captured: &[Vec<u32>]| {
                are_cut_from(corners, &numbers, captured.len(), |(p, c), v| captured[p][c] == names[v])
            };
            assert!(fits(&whole));
            for k in 0..whole.len() {
                let mut planted = whole.clone();
                planted.remove(k);
                assert!(!fits(&planted), "without {k}");
                let mut planted = whole.clone();
                planted.insert(k, whole[k].clone());
                assert!(!fits(&planted), "{k} twice");
                let mut planted = whole.clone();
                planted[k].swap(0, 1);
                assert!(!fits(&planted), "{k} turned over");
            }
        }
    }

    #[test]
    fn strips_that_are_too_short_are_known_by_their_vertices_alone() {
        let strips: &[&[u32]] = &[&[1], &[2, 3], &[4]];
        let captured = cut(2, strips, 0);
        let (names, numbers) = numbers(strips);
        let is = |(p, c): Corner, v: usize| captured[p][c] == names[v];
        assert!(are_cut_from(2, &numbers, 1, is));
        assert_eq!(joined(2, 1, |a, b| a == b).len(), 2);
    }

    #[test]
    fn points_are_primitives_whatever_strip_they_are_in() {
        let is = |(p, _): Corner, v: usize| p == v;
        assert!(are_cut_from(1, &[0, 1, 1], 3, is));
        assert!(!are_cut_from(1, &[0, 0], 3, is));
    }
}
