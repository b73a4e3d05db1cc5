//! One run: draws into transform feedback, and the proof that the driver wrote what is read back.

#![expect(unsafe_code, reason = "every function of OpenGL is one of C")]

use glow::HasContext;

use super::job::{CaptureKind, Captured, Inputs};
use super::prepare::{Ready, captured_as, mode};
use crate::LaneError;

impl Ready {
    /// Draws every invocation and reads what was captured. `begins` is told each invocation before it is drawn, where
    /// they are drawn one by one.
    ///
    /// # Errors
    /// [`LaneError::Api`] for an error of OpenGL, or where the driver's own counts say that something is missing;
    /// [`LaneError::NotWritten`] for a vertex that holds what the buffer held before.
    pub fn run(&mut self, inputs: &Inputs<'_>, begins: &mut dyn FnMut(usize)) -> Result<Captured, LaneError> {
        self.context.make_current().map_err(LaneError::Api)?;
        let words = inputs.invocations.len();
        let wanted = inputs.count * self.job.invocation_words;
        if inputs.count > self.capacity || words != wanted || inputs.per_case == 0 {
            return Err(LaneError::Api(format!("{words} words for {} invocations", inputs.count)));
        }
        let cases = inputs.count.div_ceil(inputs.per_case);
        if inputs.cases.len() != cases * self.job.case_words && self.job.case_words > 0 {
            return Err(LaneError::Api(format!("{} words for {cases} cases", inputs.cases.len())));
        }
        if let CaptureKind::Dispatch { groups } = self.job.stage {
            return self.dispatched(groups, inputs, begins);
        }
        let vertices = self.vertices_of(inputs)?;
        let room = self.room(vertices.unwrap_or(inputs.count));
        // SAFETY: the context is current; the buffers are sized below for what is drawn.
        let (captured, read) = unsafe {
            self.upload(inputs, room);
            let done = self.draw(inputs, begins)?;
            let mut read = vec![0_u32; room];
            let gl = &self.context.gl;
            gl.bind_buffer(glow::TRANSFORM_FEEDBACK_BUFFER, Some(self.captured));
            gl.get_buffer_sub_data(glow::TRANSFORM_FEEDBACK_BUFFER, 0, bytemuck::cast_slice_mut(&mut read));
            (done, read)
        };
        self.context.checked("the draws").map_err(LaneError::Api)?;
        let captured = proven(self.job.width(), captured, vertices, read, inputs)?;
        Ok(if vertices.is_some() { self.last_instances(captured, inputs) } else { captured })
    }

    /// Vertices that are captured of all invocations, where an instance is drawn together with all before it.
    fn vertices_of(&self, inputs: &Inputs<'_>) -> Result<Option<usize>, LaneError> {
        if self.job.instance.is_none() {
            return Ok(None);
        }
        let vertices: usize = (0..inputs.count).map(|k| self.number(inputs, k, self.job.instance) as usize + 1).sum();
        if vertices.saturating_mul(4 * self.job.width()) > CAPTURED {
            let what =
                format!("instances of {vertices} vertices, which OpenGL draws to reach those of `gl_InstanceID`");
            return Err(LaneError::Unsupported(what));
        }
        Ok(Some(vertices))
    }

    /// A number of the draw for an invocation; 0 for one that the stage does not read.
    fn number(&self, inputs: &Inputs<'_>, invocation: usize, word: Option<u32>) -> u32 {
        let at = |word: u32| invocation * self.job.invocation_words + word as usize;
        word.and_then(|word| inputs.invocations.get(at(word))).copied().unwrap_or(0)
    }

    /// Keeps of each invocation the instance that is meant: the last one.
    fn last_instances(&self, captured: Captured, inputs: &Inputs<'_>) -> Captured {
        let width = self.job.width();
        let mut words = Vec::with_capacity(width * inputs.count);
        let mut end = 0;
        for k in 0..inputs.count {
            end += (self.number(inputs, k, self.job.instance) as usize + 1) * width;
            words.extend_from_slice(&captured.words[end - width..end]);
        }
        Captured { words, ..captured }
    }

    /// Words of the buffer: what can be captured, and one vertex more that must stay as it is.
    fn room(&self, count: usize) -> usize {
        self.job.most_words() * count + self.job.width()
    }

    unsafe fn upload(&self, inputs: &Inputs<'_>, room: usize) {
        let gl = &self.context.gl;
        let mut words = Vec::with_capacity(inputs.count * self.job.fed.iter().map(Vec::len).sum::<usize>());
        for invocation in 0..inputs.count {
            let record = &inputs.invocations[invocation * self.job.invocation_words..];
            self.job.fed.iter().for_each(|fed| words.extend(fed.iter().map(|&k| record[k as usize])));
        }
        let blank = vec![inputs.sentinel; room];
        // SAFETY: the context is current.
        unsafe {
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(self.vertices));
            gl.buffer_data_u8_slice(glow::ARRAY_BUFFER, bytemuck::cast_slice(&words), glow::STREAM_DRAW);
            gl.bind_buffer(glow::TRANSFORM_FEEDBACK_BUFFER, Some(self.captured));
            gl.buffer_data_u8_slice(glow::TRANSFORM_FEEDBACK_BUFFER, bytemuck::cast_slice(&blank), glow::STREAM_READ);
            self.uniforms.upload(gl, inputs.cases, self.job.case_words);
        }
    }

    unsafe fn draw(&mut self, inputs: &Inputs<'_>, begins: &mut dyn FnMut(usize)) -> Result<Drawn, LaneError> {
        let (draws, draw_as, capture_as) = match self.job.stage {
            CaptureKind::Vertex | CaptureKind::Dispatch { .. } => (1, glow::POINTS, glow::POINTS),
            CaptureKind::Geometry { input, output, .. } => (inputs.count, mode(input), captured_as(output)),
        };
        let geometry = matches!(self.job.stage, CaptureKind::Geometry { .. });
        // SAFETY: the context is current, and the vertices drawn are those that `upload` made.
        unsafe {
            // One query for each draw of a geometry stage, and one for what the stage made of all of them.
            while self.queries.len() < draws + 1 {
                self.queries.push(self.context.gl.create_query().map_err(LaneError::Api)?);
            }
            let gl = &self.context.gl;
            // A query keeps the target that it was first begun with.
            let (generated, written) = (self.queries[0], &self.queries[1..=draws]);
            gl.use_program(Some(self.program));
            gl.bind_vertex_array(Some(self.array));
            self.textures.bind(gl);
            gl.enable(glow::RASTERIZER_DISCARD);
            gl.bind_buffer_base(glow::TRANSFORM_FEEDBACK_BUFFER, 0, Some(self.captured));
            gl.begin_query(glow::PRIMITIVES_GENERATED, generated);
            if !geometry {
                gl.begin_query(glow::TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, written[0]);
            }
            gl.begin_transform_feedback(capture_as);
            let vertices = self.job.vertices() as i32;
            let alone = geometry || inputs.one_by_one || self.job.reads_numbers();
            if self.job.reads_numbers() {
                gl.bind_buffer(glow::ARRAY_BUFFER, Some(self.vertices));
            }
            let varies = self.job.case_words > 0;
            let cases = if varies || alone { inputs.count.div_ceil(inputs.per_case) } else { 1 };
            let per_case = if varies || alone { inputs.per_case } else { inputs.count };
            for case in 0..cases {
                if varies {
                    let words = &inputs.cases[case * self.job.case_words..][..self.job.case_words];
                    self.uniforms.set(gl, case, words);
                }
                let first = case * per_case;
                let last = (first + per_case).min(inputs.count);
                if !alone {
                    gl.draw_arrays(draw_as, first as i32, (last - first) as i32);
                    continue;
                }
                for k in first..last {
                    if inputs.one_by_one {
                        begins(k);
                    }
                    if geometry {
                        gl.begin_query(glow::TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, written[k]);
                    }
                    if self.job.reads_numbers() {
                        self.point(k);
                        let [first, instance] = [self.job.vertex, self.job.instance].map(|w| self.number(inputs, k, w));
                        gl.draw_arrays_instanced(draw_as, first as i32, 1, instance as i32 + 1);
                    } else {
                        gl.draw_arrays(draw_as, k as i32 * vertices, vertices);
                    }
                    if geometry {
                        gl.end_query(glow::TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
                    }
                    if inputs.one_by_one {
                        gl.finish();
                    }
                }
            }
            gl.end_transform_feedback();
            if !geometry {
                gl.end_query(glow::TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
            }
            gl.end_query(glow::PRIMITIVES_GENERATED);
            gl.disable(glow::RASTERIZER_DISCARD);
            gl.finish();
            let result = |query| gl.get_query_parameter_u32(query, glow::QUERY_RESULT);
            Ok(Drawn {
                generated: result(generated) as usize,
                written: written.iter().map(|&q| result(q)).collect(),
                vertices: match self.job.stage {
                    CaptureKind::Vertex | CaptureKind::Dispatch { .. } => 1,
                    CaptureKind::Geometry { output, .. } => output.vertices(),
                },
                geometry,
            })
        }
    }
}

/// Bytes of captured instances.
const CAPTURED: usize = 1 << 27;

/// What the driver counted.
struct Drawn {
    generated: usize,
    written: Vec<u32>,
    vertices: usize,
    geometry: bool,
}

/// Takes the captured words when driver and buffer agree on what was written: as many primitives as were made, no vertex
/// that still holds what the buffer held before, and nothing behind the last one.
/// `vertices` of them are drawn where that is not one for each invocation.
fn proven(
    width: usize,
    drawn: Drawn,
    vertices: Option<usize>,
    read: Vec<u32>,
    inputs: &Inputs<'_>,
) -> Result<Captured, LaneError> {
    let written: usize = drawn.written.iter().map(|&n| n as usize).sum();
    if written != drawn.generated {
        let made = drawn.generated;
        return Err(LaneError::Api(format!("transform feedback wrote {written} primitives of {made}")));
    }
    let count = inputs.count;
    let points = vertices.unwrap_or(count);
    if !drawn.geometry && written != points {
        return Err(LaneError::Api(format!("{points} points were drawn, and {written} captured")));
    }
    let words = written * drawn.vertices * width;
    if words > read.len() {
        return Err(LaneError::Api(format!("the driver says that it wrote {words} words into {}", read.len())));
    }
    let untouched = |vertex: &[u32]| vertex.iter().all(|&word| word == inputs.sentinel);
    if let Some(vertex) = read[..words].chunks_exact(width).position(untouched) {
        let mut ends = drawn.written.iter().scan(0, |sum, &n| {
            *sum += n as usize * drawn.vertices;
            Some(*sum)
        });
        let invocation = if drawn.geometry { ends.position(|end| vertex < end).unwrap_or(count) } else { vertex };
        let found = inputs.sentinel;
        return Err(LaneError::NotWritten { invocation, count, found, expected: !found });
    }
    if let Some(at) = read[words..].iter().position(|&word| word != inputs.sentinel) {
        return Err(LaneError::Api(format!("the driver wrote behind what it captured, at word {}", words + at)));
    }
    let mut read = read;
    read.truncate(words);
    Ok(Captured { words: read, primitives: if drawn.geometry { drawn.written } else { Vec::new() } })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENTINEL: u32 = 0x7fc0_1111;

    fn inputs(count: usize) -> Inputs<'static> {
        Inputs { invocations: &[], cases: &[], count, per_case: 1, sentinel: SENTINEL, one_by_one: false }
    }

    fn points(written: u32, generated: usize) -> Drawn {
        Drawn { generated, written: vec![written], vertices: 1, geometry: false }
    }

    #[test]
    fn what_was_written_is_taken() {
        let read = vec![1, 2, 3, SENTINEL, SENTINEL, SENTINEL];
        // One word that happens to be the sentinel is an output like any other.
        let taken = proven(2, points(2, 2), None, read, &inputs(2)).unwrap();
        assert_eq!(taken.words, [1, 2, 3, SENTINEL]);
    }

    #[test]
    fn a_vertex_that_was_not_written_is_an_error() {
        let read = vec![1, 2, SENTINEL, SENTINEL, 5, 6, SENTINEL, SENTINEL];
        let error = proven(2, points(3, 3), None, read, &inputs(3)).unwrap_err();
        assert!(matches!(error, LaneError::NotWritten { invocation: 1, count: 3, .. }));
        let lines = Drawn { generated: 2, written: vec![1, 1], vertices: 2, geometry: true };
        let error = proven(1, lines, None, vec![1, 2, 3, SENTINEL, SENTINEL], &inputs(2)).unwrap_err();
        assert!(matches!(error, LaneError::NotWritten { invocation: 1, .. }));
    }

    #[test]
    fn a_buffer_that_is_too_small_or_written_too_far_is_an_error() {
        for (drawn, read) in [
            (points(1, 2), vec![1, SENTINEL, SENTINEL]),
            (points(1, 1), vec![1, SENTINEL, SENTINEL]),
            (points(2, 2), vec![1, 2, 3]),
            (points(2, 2), vec![1]),
        ] {
            assert!(matches!(proven(1, drawn, None, read, &inputs(2)), Err(LaneError::Api(_))));
        }
    }
}
