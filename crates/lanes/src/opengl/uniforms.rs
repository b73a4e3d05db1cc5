//! Uniforms: one call for each outside of blocks, and a buffer with the blocks of all cases.

#![expect(unsafe_code, reason = "every function of OpenGL is one of C")]

use glow::HasContext;

use super::context::Context;
use super::job::{Job, Named};
use super::textures::Textures;
use super::{types, unsupported};
use crate::LaneError;
use base::value::{Scalar, Shape};

/// How the uniforms of a program are set.
#[derive(Default)]
pub struct Uniforms {
    plain: Vec<PlainUniform>,
    blocks: Vec<UniformBlock>,
    buffer: Option<glow::Buffer>,
}

/// A uniform outside of blocks.
struct PlainUniform {
    location: glow::UniformLocation,
    shape: Shape,
    /// First word in the record of a case.
    first: usize,
    /// Elements that the driver keeps.
    elements: usize,
}

/// A uniform block.
struct UniformBlock {
    /// Bytes from the block of one case to that of the next.
    stride: usize,
    /// Bytes of the block.
    bytes: usize,
    /// Word of the record of a case, and where in the block it goes, in words.
    places: Vec<(usize, usize)>,
}

impl Uniforms {
    /// Finds every active uniform in the job, and refuses those that nothing feeds. The context must be current.
    pub unsafe fn new(
        context: &Context,
        program: glow::Program,
        job: &Job,
        textures: &Textures,
    ) -> Result<Self, LaneError> {
        let gl = &context.gl;
        let mut this = Self::default();
        let align = context.number(glow::UNIFORM_BUFFER_OFFSET_ALIGNMENT).max(4);
        // SAFETY: the caller has made the context current; indices are below the counts that the driver gives.
        unsafe {
            gl.use_program(Some(program));
            for k in 0..gl.get_program_parameter_i32(program, glow::ACTIVE_UNIFORM_BLOCKS) as u32 {
                let name = gl.get_active_uniform_block_name(program, k);
                if name.contains('[') {
                    return Err(unsupported(format!("the array of uniform blocks `{name}`")));
                }
                let bytes =
                    gl.get_active_uniform_block_parameter_i32(program, k, glow::UNIFORM_BLOCK_DATA_SIZE) as usize;
                gl.uniform_block_binding(program, k, k);
                let bytes = bytes.next_multiple_of(16);
                this.blocks.push(UniformBlock { stride: bytes.next_multiple_of(align), bytes, places: Vec::new() });
            }
            for k in 0..gl.get_active_uniforms(program) {
                let Some(active) = gl.get_active_uniform(program, k) else { continue };
                let base = active.name.strip_suffix("[0]").unwrap_or(&active.name);
                if types::is_sampler(active.utype) {
                    textures.assign(gl, program, base, active.size as usize)?;
                    continue;
                }
                let (uniform, first) = find(job, &active.name, base)
                    .ok_or_else(|| unsupported(format!("the uniform `{}`, which nothing feeds", active.name)))?;
                if types::of(uniform.shape.element()) != Some(active.utype) {
                    let (name, shape, found) = (&uniform.name, uniform.shape, active.utype);
                    return Err(LaneError::Api(format!("`{name}` is `{shape}`, and 0x{found:04x} to the driver")));
                }
                let elements = uniform.shape.elements().min(active.size.max(1) as usize);
                let parameter = |name| gl.get_active_uniforms_parameter(program, &[k], name)[0];
                match usize::try_from(parameter(glow::UNIFORM_BLOCK_INDEX)) {
                    Err(_) => {
                        let Some(location) = gl.get_uniform_location(program, &active.name) else { continue };
                        this.plain.push(PlainUniform { location, shape: uniform.shape, first, elements });
                    }
                    Ok(block) => {
                        let layout = MemberLayout {
                            offset: parameter(glow::UNIFORM_OFFSET) as usize,
                            array: parameter(glow::UNIFORM_ARRAY_STRIDE).max(0) as usize,
                            matrix: parameter(glow::UNIFORM_MATRIX_STRIDE).max(0) as usize,
                            rows_first: parameter(glow::UNIFORM_IS_ROW_MAJOR) != 0,
                        };
                        let places = &mut this.blocks[block].places;
                        places.extend(layout.words(uniform.shape, elements).map(|(word, at)| (first + word, at)));
                    }
                }
            }
            if !this.blocks.is_empty() {
                this.buffer = Some(gl.create_buffer().map_err(LaneError::Api)?);
            }
        }
        Ok(this)
    }

    /// Bytes of the blocks of one case.
    pub fn case_bytes(&self) -> usize {
        self.blocks.iter().map(|b| b.stride).sum()
    }

    /// Uploads the blocks of all cases. The context must be current.
    pub unsafe fn upload(&self, gl: &glow::Context, cases: &[u32], case_words: usize) {
        let Some(buffer) = self.buffer else { return };
        let stride = self.case_bytes() / 4;
        let count = cases.len() / case_words.max(1);
        let mut words = vec![0_u32; stride * count];
        for (case, to) in cases.chunks_exact(case_words.max(1)).zip(words.chunks_exact_mut(stride)) {
            let mut start = 0;
            for block in &self.blocks {
                block.places.iter().for_each(|&(word, at)| to[start + at] = case[word]);
                start += block.stride / 4;
            }
        }
        // SAFETY: the caller has made the context current.
        unsafe {
            gl.bind_buffer(glow::UNIFORM_BUFFER, Some(buffer));
            gl.buffer_data_u8_slice(glow::UNIFORM_BUFFER, bytemuck::cast_slice(&words), glow::STREAM_DRAW);
        }
    }

    /// Sets the uniforms of one case. The context must be current, with the program in use.
    pub unsafe fn set(&self, gl: &glow::Context, case: usize, words: &[u32]) {
        let mut start = case * self.case_bytes();
        for (k, block) in self.blocks.iter().enumerate() {
            // SAFETY: the range is inside of the buffer that `upload` has filled.
            unsafe {
                let (at, bytes) = (start as i32, block.bytes as i32);
                gl.bind_buffer_range(glow::UNIFORM_BUFFER, k as u32, self.buffer, at, bytes);
            }
            start += block.stride;
        }
        for uniform in &self.plain {
            let words = &words[uniform.first..][..uniform.elements * uniform.shape.element_words()];
            // SAFETY: shape and number of elements are those that the driver told.
            unsafe { set(gl, &uniform.location, uniform.shape, words) };
        }
    }

    /// Deletes what was made. The context must be current.
    pub unsafe fn free(&self, gl: &glow::Context) {
        if let Some(buffer) = self.buffer {
            // SAFETY: the buffer is used nowhere else.
            unsafe { gl.delete_buffer(buffer) };
        }
    }
}

/// The uniform of a name with its first word.
fn find<'j>(job: &'j Job, name: &str, base: &str) -> Option<(&'j Named, usize)> {
    let mut first = 0;
    for uniform in &job.uniforms {
        if uniform.name == name || uniform.name == base {
            return Some((uniform, first));
        }
        first += uniform.shape.words();
    }
    None
}

/// Where a uniform lies in its block, in bytes.
struct MemberLayout {
    offset: usize,
    array: usize,
    matrix: usize,
    rows_first: bool,
}

impl MemberLayout {
    /// Words of the value, and where in the block each goes, in words.
    fn words(&self, shape: Shape, elements: usize) -> impl Iterator<Item = (usize, usize)> {
        let (columns, rows) = (usize::from(shape.columns), usize::from(shape.rows));
        let (offset, array, matrix, rows_first) = (self.offset, self.array, self.matrix, self.rows_first);
        (0..elements * columns * rows).map(move |word| {
            let (element, within) = (word / (columns * rows), word % (columns * rows));
            let (column, row) = (within / rows, within % rows);
            let inside = match (columns > 1, rows_first) {
                (true, true) => row * matrix + 4 * column,
                (true, false) => column * matrix + 4 * row,
                (false, _) => 4 * row,
            };
            (word, (offset + element * array + inside) / 4)
        })
    }
}

unsafe fn set(gl: &glow::Context, location: &glow::UniformLocation, shape: Shape, words: &[u32]) {
    let at = Some(location);
    let real: &[f32] = bytemuck::cast_slice(words);
    let whole: &[i32] = bytemuck::cast_slice(words);
    // SAFETY: the caller gives as many words as the shape has in each element.
    unsafe {
        match (shape.scalar, shape.columns, shape.rows) {
            (Scalar::F32, 1, 1) => gl.uniform_1_f32_slice(at, real),
            (Scalar::F32, 1, 2) => gl.uniform_2_f32_slice(at, real),
            (Scalar::F32, 1, 3) => gl.uniform_3_f32_slice(at, real),
            (Scalar::F32, 1, _) => gl.uniform_4_f32_slice(at, real),
            (Scalar::I32, _, 1) => gl.uniform_1_i32_slice(at, whole),
            (Scalar::I32, _, 2) => gl.uniform_2_i32_slice(at, whole),
            (Scalar::I32, _, 3) => gl.uniform_3_i32_slice(at, whole),
            (Scalar::I32, _, _) => gl.uniform_4_i32_slice(at, whole),
            // Truth values are set by any kind of number.
            (Scalar::U32 | Scalar::Bool, _, 1) => gl.uniform_1_u32_slice(at, words),
            (Scalar::U32 | Scalar::Bool, _, 2) => gl.uniform_2_u32_slice(at, words),
            (Scalar::U32 | Scalar::Bool, _, 3) => gl.uniform_3_u32_slice(at, words),
            (Scalar::U32 | Scalar::Bool, _, _) => gl.uniform_4_u32_slice(at, words),
            (Scalar::F32, 2, 2) => gl.uniform_matrix_2_f32_slice(at, false, real),
            (Scalar::F32, 2, 3) => gl.uniform_matrix_2x3_f32_slice(at, false, real),
            (Scalar::F32, 2, _) => gl.uniform_matrix_2x4_f32_slice(at, false, real),
            (Scalar::F32, 3, 2) => gl.uniform_matrix_3x2_f32_slice(at, false, real),
            (Scalar::F32, 3, 3) => gl.uniform_matrix_3_f32_slice(at, false, real),
            (Scalar::F32, 3, _) => gl.uniform_matrix_3x4_f32_slice(at, false, real),
            (Scalar::F32, _, 2) => gl.uniform_matrix_4x2_f32_slice(at, false, real),
            (Scalar::F32, _, 3) => gl.uniform_matrix_4x3_f32_slice(at, false, real),
            (Scalar::F32, _, _) => gl.uniform_matrix_4_f32_slice(at, false, real),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_go_where_the_driver_says() {
        let at = |layout: &MemberLayout, shape, n| layout.words(shape, n).map(|(_, at)| at).collect::<Vec<_>>();
        let matrix = Shape { scalar: Scalar::F32, columns: 2, rows: 3, array: None, half: false };
        let columns = MemberLayout { offset: 16, array: 0, matrix: 16, rows_first: false };
        assert_eq!(at(&columns, matrix, 1), [4, 5, 6, 8, 9, 10]);
        // In rows, the first column is the first word of each row.
        let rows = MemberLayout { rows_first: true, ..columns };
        assert_eq!(at(&rows, matrix, 1), [4, 8, 12, 5, 9, 13]);
        let array = MemberLayout { offset: 0, array: 16, matrix: 0, rows_first: false };
        assert_eq!(at(&array, Shape::FLOAT.array_of(3), 3), [0, 4, 8]);
    }
}
