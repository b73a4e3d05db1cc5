//! From primitives, which are what transform feedback captures of a strip, back to emitted vertices.
//!
//! OpenGL captures a strip taken apart: a strip of n vertices gives n - 1 lines or n - 2 triangles, and a strip too short
//! for one gives nothing (OpenGL 4.6, 13.3). Two strips that meet in the same bits look like one. Among the structures
//! that the capture cannot tell apart, that of the shader's own meaning is taken where it is one of them; otherwise
//! strips are as long as they can be. The vertices are the driver's in any case.

use super::job::Output;

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

/// The vertices of captured primitives. `vertex` gives the words of a captured vertex.
///
/// # Errors
/// [`Incomplete`] for a vertex that is emitted and belongs to no primitive: its outputs are nowhere.
pub fn emitted<'w>(
    output: Output,
    primitives: usize,
    vertex: &dyn Fn(usize) -> &'w [u32],
    meant: Option<Meant<'_>>,
) -> Result<Emitted, Incomplete> {
    if let Some(meant) = meant
        && let Some(copies) = copies_of(output, primitives, vertex, meant.strips)
    {
        let strips = meant.strips.to_vec();
        let lost = copies.iter().position(Option::is_none);
        if let Some(at) = lost {
            return Err(Incomplete { vertex: at, of: strips.iter().filter(|s| **s == strips[at]).count() });
        }
        return Ok(Emitted { count: meant.count, strips, copies: copies.into_iter().flatten().collect() });
    }
    Ok(longest(output, primitives, vertex))
}

/// The emitted vertices of the primitives that strips are taken apart into, in the order of the capture.
fn apart(output: Output, strips: &[u32]) -> Vec<usize> {
    let mut drawn = Vec::new();
    let mut first = 0;
    for v in 0..strips.len() {
        if v > 0 && strips[v] != strips[v - 1] {
            first = v;
        }
        let place = v - first;
        match output {
            Output::Points => drawn.push(v),
            Output::Lines if place >= 1 => drawn.extend([v - 1, v]),
            Output::Triangles if place >= 2 && place % 2 == 0 => drawn.extend([v - 2, v - 1, v]),
            // Every other triangle is turned round, so that all have the same orientation.
            Output::Triangles if place >= 2 => drawn.extend([v - 1, v - 2, v]),
            Output::Lines | Output::Triangles => {}
        }
    }
    drawn
}

/// For each vertex of these strips its first copy, when the capture is that of such strips.
fn copies_of<'w>(
    output: Output,
    primitives: usize,
    vertex: &dyn Fn(usize) -> &'w [u32],
    strips: &[u32],
) -> Option<Vec<Option<usize>>> {
    let drawn = apart(output, strips);
    if drawn.len() != primitives * output.vertices() {
        return None;
    }
    let mut copies: Vec<Option<usize>> = vec![None; strips.len()];
    for (at, v) in drawn.into_iter().enumerate() {
        match copies[v] {
            None => copies[v] = Some(at),
            Some(first) if vertex(first) == vertex(at) => {}
            Some(_) => return None,
        }
    }
    Some(copies)
}

/// The same where nothing is known: a primitive belongs to the strip before it where it can.
fn longest<'w>(output: Output, primitives: usize, vertex: &dyn Fn(usize) -> &'w [u32]) -> Emitted {
    let mut all = Emitted { count: 0, strips: Vec::new(), copies: Vec::new() };
    let (mut strip, mut first) = (0, 0);
    for primitive in 0..primitives {
        let at = primitive * output.vertices();
        let count = all.copies.len();
        let same = |v: usize, copy: usize| vertex(all.copies[v]) == vertex(copy);
        let joins = match output {
            Output::Points => true,
            Output::Lines => count > first && same(count - 1, at),
            Output::Triangles if count >= first + 3 => {
                let (last, before) = (count - 1, count - 2);
                let (a, b) = if (count - first).is_multiple_of(2) { (before, last) } else { (last, before) };
                same(a, at) && same(b, at + 1)
            }
            Output::Triangles => false,
        };
        if !joins {
            strip += u32::from(count > 0);
            first = count;
        }
        let new = if joins { output.vertices() - 1 } else { 0 };
        for copy in at + new..at + output.vertices() {
            all.copies.push(copy);
            all.strips.push(strip);
        }
    }
    all.count = all.copies.len() as u32;
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(
        output: Output,
        words: &[u32],
        meant: Option<(u32, &[u32])>,
    ) -> Result<(u32, Vec<u32>, Vec<u32>), Incomplete> {
        let vertex = |v: usize| &words[v..=v];
        let meant = meant.map(|(count, strips)| Meant { count, strips });
        let all = emitted(output, words.len() / output.vertices(), &vertex, meant)?;
        let values = all.copies.iter().map(|&c| words[c]).collect();
        Ok((all.count, all.strips, values))
    }

    #[test]
    fn a_line_strip_comes_back_from_its_lines() {
        let lines = [10, 11, 11, 12, 12, 13];
        for meant in [None, Some((4, &[0, 0, 0, 0][..]))] {
            assert_eq!(found(Output::Lines, &lines, meant).unwrap(), (4, vec![0; 4], vec![10, 11, 12, 13]));
        }
    }

    #[test]
    fn a_triangle_strip_comes_back_from_triangles_of_which_every_other_is_turned() {
        let triangles = [0, 1, 2, 2, 1, 3, 2, 3, 4];
        for meant in [None, Some((5, &[0, 0, 0, 0, 0][..]))] {
            assert_eq!(found(Output::Triangles, &triangles, meant).unwrap(), (5, vec![0; 5], vec![0, 1, 2, 3, 4]));
        }
    }

    #[test]
    fn several_strips_stay_apart() {
        let lines = [1, 2, 3, 4, 4, 5];
        assert_eq!(found(Output::Lines, &lines, None).unwrap(), (5, vec![0, 0, 1, 1, 1], vec![1, 2, 3, 4, 5]));
        let triangles = [0, 1, 2, 5, 6, 7, 7, 6, 8];
        let strips = vec![0, 0, 0, 1, 1, 1, 1];
        assert_eq!(found(Output::Triangles, &triangles, None).unwrap(), (7, strips, vec![0, 1, 2, 5, 6, 7, 8]));
    }

    #[test]
    fn strips_that_meet_are_told_apart_by_what_the_shader_means() {
        // Two lines that share an end: one strip of three, or two strips of two.
        let lines = [1, 2, 2, 3];
        assert_eq!(found(Output::Lines, &lines, None).unwrap().0, 3);
        let apart = found(Output::Lines, &lines, Some((4, &[0, 0, 1, 1]))).unwrap();
        assert_eq!(apart, (4, vec![0, 0, 1, 1], vec![1, 2, 2, 3]));
    }

    #[test]
    fn what_the_shader_means_does_not_hide_what_the_driver_drew() {
        // The last vertex is missing, an odd triangle is not turned, a shared vertex has other bits.
        assert_eq!(found(Output::Lines, &[1, 2, 2, 3], Some((4, &[0; 4]))).unwrap().0, 3);
        let (count, strips, _) = found(Output::Triangles, &[0, 1, 2, 1, 2, 3], Some((4, &[0; 4]))).unwrap();
        assert_eq!((count, strips), (6, vec![0, 0, 0, 1, 1, 1]));
        assert_eq!(found(Output::Lines, &[1, 2, 9, 3], Some((3, &[0; 3]))).unwrap().0, 4);
    }

    #[test]
    fn a_vertex_of_an_incomplete_strip_is_named() {
        // A strip of two lines, and one vertex by itself.
        let error = found(Output::Lines, &[1, 2, 2, 3], Some((4, &[0, 0, 0, 1]))).unwrap_err();
        assert_eq!(error, Incomplete { vertex: 3, of: 1 });
        let error = found(Output::Triangles, &[], Some((2, &[0, 0]))).unwrap_err();
        assert_eq!(error, Incomplete { vertex: 0, of: 2 });
    }

    #[test]
    fn vertices_past_the_limit_are_counted() {
        let (count, strips, _) = found(Output::Points, &[1, 2], Some((9, &[0, 0]))).unwrap();
        assert_eq!((count, strips.len()), (9, 2));
    }
}
