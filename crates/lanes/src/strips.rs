//! From the primitives that transform feedback captures back to the vertices that a geometry stage emitted.
//!
//! A device cuts strips into lines or triangles and captures these, each with vertices of its own: a strip of n vertices
//! gives n - 1 lines or n - 2 triangles, and a strip that is too short for one gives nothing (OpenGL 4.6, 13.3). Primitives
//! are counted in the order of the capture, and `corners` is 1 for points, 2 for lines and 3 for triangles.
//!
//! A lane that can mark each vertex asks [`are_cut_from`]. One that cannot has the words of the vertices alone, by which two
//! strips that meet in the same bits look like one. Among the structures that [`emitted`] cannot tell apart, that of the
//! shader's own meaning is taken where it is one of them; otherwise strips are as long as they can be. The vertices are the
//! driver's in any case.

/// A captured vertex: number of its primitive, and corner in it.
pub type Corner = (usize, usize);

/// At which corner a captured triangle may begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begin {
    /// At the one that the strip says.
    First,
    /// At any.
    Any,
}

impl Begin {
    fn turns(self) -> usize {
        match self {
            Self::First => 1,
            Self::Any => 3,
        }
    }
}

/// Emitted vertices of one invocation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Emitted {
    /// How many there were, those past the limit included where that is known.
    pub count: u32,
    /// For each stored vertex, the number of its strip.
    pub strips: Vec<u32>,
    /// For each stored vertex, one of its copies among the captured ones.
    pub copies: Vec<usize>,
}

/// What cannot be told from captured primitives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Incomplete {
    /// Index of the vertex in its strip.
    pub vertex: usize,
    /// Vertices of its strip.
    pub of: usize,
}

/// What a shader means to emit: number of vertices, and the strip of each that is stored.
#[derive(Clone, Copy, Debug)]
pub struct Meant<'a> {
    /// Number of vertices, those past the limit included.
    pub count: u32,
    /// The strip of each stored vertex.
    pub strips: &'a [u32],
}

/// The emitted vertices of the primitives that strips are cut into, in the order of the capture; `strips` has the number of
/// the strip of each emitted vertex.
fn cut(corners: usize, strips: &[u32]) -> Vec<[usize; 3]> {
    let mut cuts = Vec::new();
    let mut first = 0;
    for v in 0..strips.len() {
        // A point is a primitive, whatever strip it is in.
        if corners == 1 || (v > 0 && strips[v] != strips[v - 1]) {
            first = v;
        }
        if let Some(begin) = (v + 1).checked_sub(corners).filter(|&begin| begin >= first) {
            // Every second triangle of a strip is turned, so that all face the same way.
            let turned = corners == 3 && (begin - first) % 2 == 1;
            let [a, b] = if turned { [begin + 1, begin] } else { [begin, begin + 1] };
            cuts.push([a, b, begin + 2]);
        }
    }
    cuts
}

/// True when the captured primitives are those into which these strips are cut, triangles beginning at any corner. `is` tells
/// whether a captured vertex is that emitted one.
pub fn are_cut_from(corners: usize, strips: &[u32], captured: usize, is: impl Fn(Corner, usize) -> bool) -> bool {
    let cuts = cut(corners, strips);
    let fits = |(primitive, vertices): (usize, &[usize; 3])| {
        let turned = |by: usize| (0..corners).all(|c| is((primitive, c), vertices[(c + by) % corners]));
        (0..corners).any(|by| (by == 0 || corners == 3) && turned(by))
    };
    cuts.len() == captured && cuts.iter().enumerate().all(fits)
}

/// The emitted vertices, each with its strip, from the captured primitives alone: a primitive goes on with the strip
/// before it when it shares all but one vertex with the primitive before. Vertices of strips that are too short are
/// not there.
pub fn joined(
    corners: usize,
    captured: usize,
    begin: Begin,
    same: impl Fn(Corner, Corner) -> bool,
) -> Vec<(Corner, u32)> {
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
                // The new vertex is the one that is left.
                _ => (0..begin.turns()).any(|c| {
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

/// The vertices of captured primitives. `vertex` gives the words of a captured vertex.
///
/// # Errors
/// [`Incomplete`] for a vertex that is emitted and belongs to no primitive: its outputs are nowhere.
pub fn emitted<'w>(
    corners: usize,
    primitives: usize,
    vertex: &dyn Fn(usize) -> &'w [u32],
    meant: Option<Meant<'_>>,
) -> Result<Emitted, Incomplete> {
    if let Some(meant) = meant
        && let Some(copies) = copies_of(corners, primitives, vertex, meant.strips)
    {
        let strips = meant.strips.to_vec();
        let lost = copies.iter().position(Option::is_none);
        if let Some(at) = lost {
            return Err(Incomplete { vertex: at, of: strips.iter().filter(|s| **s == strips[at]).count() });
        }
        return Ok(Emitted { count: meant.count, strips, copies: copies.into_iter().flatten().collect() });
    }
    let at = |(primitive, corner): Corner| primitive * corners + corner;
    let all = joined(corners, primitives, Begin::First, |a, b| vertex(at(a)) == vertex(at(b)));
    let (copies, strips): (Vec<usize>, Vec<u32>) = all.into_iter().map(|(corner, strip)| (at(corner), strip)).unzip();
    Ok(Emitted { count: copies.len() as u32, strips, copies })
}

/// For each vertex of these strips its first copy, when the capture is that of such strips.
fn copies_of<'w>(
    corners: usize,
    primitives: usize,
    vertex: &dyn Fn(usize) -> &'w [u32],
    strips: &[u32],
) -> Option<Vec<Option<usize>>> {
    let cuts = cut(corners, strips);
    if cuts.len() != primitives {
        return None;
    }
    let mut copies: Vec<Option<usize>> = vec![None; strips.len()];
    for (at, v) in cuts.iter().flat_map(|cut| &cut[..corners]).copied().enumerate() {
        match copies[v] {
            None => copies[v] = Some(at),
            Some(first) if vertex(first) == vertex(at) => {}
            Some(_) => return None,
        }
    }
    Some(copies)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a device captures of strips of vertices with these names; the odd triangles begin at corner `turn`.
    fn capture(corners: usize, strips: &[&[u32]], turn: usize) -> Vec<Vec<u32>> {
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
                let captured = capture(corners, strips, turn);
                let (names, expected) = numbers(strips);
                let is = |(p, c): Corner, v: usize| captured[p][c] == names[v];
                assert!(are_cut_from(corners, &expected, captured.len(), is), "{corners} {turn} {strips:?}");
                let same = |(p, c): Corner, (q, d): Corner| captured[p][c] == captured[q][d];
                let found = joined(corners, captured.len(), Begin::Any, same);
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
            let whole = capture(corners, strips, 1);
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
        let captured = capture(2, strips, 0);
        let (names, numbers) = numbers(strips);
        let is = |(p, c): Corner, v: usize| captured[p][c] == names[v];
        assert!(are_cut_from(2, &numbers, 1, is));
        assert_eq!(joined(2, 1, Begin::Any, |a, b| a == b).len(), 2);
    }

    #[test]
    fn points_are_primitives_whatever_strip_they_are_in() {
        let is = |(p, _): Corner, v: usize| p == v;
        assert!(are_cut_from(1, &[0, 1, 1], 3, is));
        assert!(!are_cut_from(1, &[0, 0], 3, is));
    }

    fn found(
        corners: usize,
        words: &[u32],
        meant: Option<(u32, &[u32])>,
    ) -> Result<(u32, Vec<u32>, Vec<u32>), Incomplete> {
        let vertex = |v: usize| &words[v..=v];
        let meant = meant.map(|(count, strips)| Meant { count, strips });
        let all = emitted(corners, words.len() / corners, &vertex, meant)?;
        let values = all.copies.iter().map(|&c| words[c]).collect();
        Ok((all.count, all.strips, values))
    }

    #[test]
    fn a_line_strip_comes_back_from_its_lines() {
        let lines = [10, 11, 11, 12, 12, 13];
        for meant in [None, Some((4, &[0, 0, 0, 0][..]))] {
            assert_eq!(found(2, &lines, meant).unwrap(), (4, vec![0; 4], vec![10, 11, 12, 13]));
        }
    }

    #[test]
    fn a_triangle_strip_comes_back_from_triangles_of_which_every_other_is_turned() {
        let triangles = [0, 1, 2, 2, 1, 3, 2, 3, 4];
        for meant in [None, Some((5, &[0, 0, 0, 0, 0][..]))] {
            assert_eq!(found(3, &triangles, meant).unwrap(), (5, vec![0; 5], vec![0, 1, 2, 3, 4]));
        }
    }

    #[test]
    fn several_strips_stay_apart() {
        let lines = [1, 2, 3, 4, 4, 5];
        assert_eq!(found(2, &lines, None).unwrap(), (5, vec![0, 0, 1, 1, 1], vec![1, 2, 3, 4, 5]));
        let triangles = [0, 1, 2, 5, 6, 7, 7, 6, 8];
        let strips = vec![0, 0, 0, 1, 1, 1, 1];
        assert_eq!(found(3, &triangles, None).unwrap(), (7, strips, vec![0, 1, 2, 5, 6, 7, 8]));
    }

    #[test]
    fn strips_that_meet_are_told_apart_by_what_the_shader_means() {
        // Two lines that share an end: one strip of three, or two strips of two.
        let lines = [1, 2, 2, 3];
        assert_eq!(found(2, &lines, None).unwrap().0, 3);
        let apart = found(2, &lines, Some((4, &[0, 0, 1, 1]))).unwrap();
        assert_eq!(apart, (4, vec![0, 0, 1, 1], vec![1, 2, 2, 3]));
    }

    #[test]
    fn what_the_shader_means_does_not_hide_what_the_driver_drew() {
        // The last vertex is missing, an odd triangle is not turned, a shared vertex has other bits.
        assert_eq!(found(2, &[1, 2, 2, 3], Some((4, &[0; 4]))).unwrap().0, 3);
        let (count, strips, _) = found(3, &[0, 1, 2, 1, 2, 3], Some((4, &[0; 4]))).unwrap();
        assert_eq!((count, strips), (6, vec![0, 0, 0, 1, 1, 1]));
        assert_eq!(found(2, &[1, 2, 9, 3], Some((3, &[0; 3]))).unwrap().0, 4);
    }

    #[test]
    fn a_vertex_of_an_incomplete_strip_is_named() {
        // A strip of two lines, and one vertex by itself.
        let error = found(2, &[1, 2, 2, 3], Some((4, &[0, 0, 0, 1]))).unwrap_err();
        assert_eq!(error, Incomplete { vertex: 3, of: 1 });
        let error = found(3, &[], Some((2, &[0, 0]))).unwrap_err();
        assert_eq!(error, Incomplete { vertex: 0, of: 2 });
    }

    #[test]
    fn vertices_past_the_limit_are_counted() {
        let (count, strips, _) = found(1, &[1, 2], Some((9, &[0, 0]))).unwrap();
        assert_eq!((count, strips.len()), (9, 2));
    }
}
