//! Whole dispatches of a compute stage (OpenGL 4.3): one after the other, each with buffers that are filled anew and a
//! canary behind each of them.

#![expect(unsafe_code, reason = "every function of OpenGL is one of C")]

use glow::HasContext;

use super::ask::unsupported;
use super::context::Context;
use super::job::{CaptureKind, Captured, Inputs, Job, StorageBuffer};
use super::prepare::Ready;
use crate::LaneError;

/// Bytes behind a buffer that nobody may write.
const BEHIND: usize = 256;

/// Bytes of buffers in one run at most, as many times as there are dispatches.
const BYTES: usize = 1 << 28;

/// Dispatches of one run at most.
const MOST: usize = 64;

/// The buffers of a dispatch, made once.
#[derive(Default)]
pub struct Buffers(Vec<glow::Buffer>);

impl Buffers {
    /// Binds the blocks of a program to buffers, in the order of the job. The context must be current.
    pub unsafe fn new(context: &Context, program: glow::Program, job: &Job) -> Result<Self, LaneError> {
        let CaptureKind::Dispatch { groups } = job.stage else { return Ok(Self::default()) };
        let gl = &context.gl;
        let mut this = Self::default();
        // SAFETY: the caller has made the context current; an index of a block is one that the driver gives.
        unsafe {
            for (axis, &count) in groups.iter().enumerate() {
                let most = gl.get_parameter_indexed_i32(glow::MAX_COMPUTE_WORK_GROUP_COUNT, axis as u32);
                if i64::from(count) > i64::from(most) {
                    let axis = ["x", "y", "z"][axis];
                    return Err(unsupported(format!("{count} workgroups along {axis}; the device has {most}")));
                }
            }
            let most = context.number(glow::MAX_SHADER_STORAGE_BLOCK_SIZE);
            for (k, about) in job.buffers.iter().enumerate() {
                if about.bytes > most {
                    let (name, bytes) = (&about.block, about.bytes);
                    return Err(unsupported(format!("the buffer `{name}` of {bytes} bytes; the device has {most}")));
                }
                // A block that the driver does not find is one that the stage does not use.
                if let Some(index) = gl.get_shader_storage_block_index(program, &about.block) {
                    gl.shader_storage_block_binding(program, index, k as u32);
                }
                this.0.push(gl.create_buffer().map_err(LaneError::Api)?);
            }
        }
        Ok(this)
    }

    pub unsafe fn free(&self, gl: &glow::Context) {
        // SAFETY: the caller has made the context current, and nobody else uses the buffers.
        self.0.iter().for_each(|&buffer| unsafe { gl.delete_buffer(buffer) });
    }
}

impl Job {
    /// Dispatches that fit into one run.
    pub fn most_dispatches(&self) -> usize {
        let bytes: usize = self.buffers.iter().map(|buffer| buffer.bytes + BEHIND).sum();
        MOST.min(BYTES / bytes.max(1)).max(1)
    }
}

impl StorageBuffer {
    /// What it holds before, with the canary behind it; what nothing feeds holds the sentinel as well.
    fn before(&self, record: &[u32], sentinel: u32) -> Vec<u32> {
        let mut words = vec![sentinel; (self.bytes + BEHIND) / 4];
        for &(word, byte) in &self.before {
            words[byte as usize / 4] = record[word as usize];
        }
        words
    }

    /// Takes what it holds behind into the record of outputs.
    ///
    /// # Errors
    /// [`LaneError::Api`] where something was written behind it.
    fn after(&self, words: &[u32], sentinel: u32, record: &mut [u32]) -> Result<(), LaneError> {
        for &(word, byte) in &self.after {
            record[word as usize] = words[byte as usize / 4];
        }
        match words[self.bytes / 4..].iter().position(|&word| word != sentinel) {
            Some(at) => Err(LaneError::Api(format!(
                "the dispatch wrote {} bytes behind the end of `{}`, which has {} bytes",
                4 * at,
                self.block,
                self.bytes
            ))),
            None => Ok(()),
        }
    }
}

impl Ready {
    /// Runs the dispatches and gives the words of their outputs. `begins` is told each one before it is run, where they
    /// are run one by one.
    ///
    /// # Errors
    /// [`LaneError::Api`] for an error of OpenGL, and for a buffer behind which something was written.
    pub(super) fn dispatched(
        &mut self,
        groups: [u32; 3],
        inputs: &Inputs<'_>,
        begins: &mut dyn FnMut(usize),
    ) -> Result<Captured, LaneError> {
        let width: usize = self.job.buffers.iter().map(|buffer| buffer.after.len()).sum();
        let mut words = vec![0; width * inputs.count];
        let (of_invocation, of_case) = (self.job.invocation_words, self.job.case_words);
        let gl = &self.context.gl;
        // SAFETY: the context is current; what is read back is as long as what was uploaded.
        unsafe {
            gl.use_program(Some(self.program));
            self.textures.bind(gl);
            self.uniforms.upload(gl, inputs.cases, of_case);
            for (k, record) in words.chunks_exact_mut(width.max(1)).enumerate() {
                if inputs.one_by_one {
                    begins(k);
                }
                if of_case > 0 {
                    let case = k / inputs.per_case;
                    self.uniforms.set(gl, case, &inputs.cases[case * of_case..][..of_case]);
                }
                let invocation = &inputs.invocations[k * of_invocation..][..of_invocation];
                for (at, (about, &buffer)) in self.job.buffers.iter().zip(&self.buffers.0).enumerate() {
                    let before = about.before(invocation, inputs.sentinel);
                    gl.bind_buffer(glow::SHADER_STORAGE_BUFFER, Some(buffer));
                    let bytes = bytemuck::cast_slice(&before);
                    gl.buffer_data_u8_slice(glow::SHADER_STORAGE_BUFFER, bytes, glow::DYNAMIC_READ);
                    let size = about.bytes as i32;
                    gl.bind_buffer_range(glow::SHADER_STORAGE_BUFFER, at as u32, Some(buffer), 0, size);
                }
                gl.dispatch_compute(groups[0], groups[1], groups[2]);
                gl.memory_barrier(glow::BUFFER_UPDATE_BARRIER_BIT);
                gl.finish();
                for (about, &buffer) in self.job.buffers.iter().zip(&self.buffers.0) {
                    let mut read = vec![0_u32; (about.bytes + BEHIND) / 4];
                    gl.bind_buffer(glow::SHADER_STORAGE_BUFFER, Some(buffer));
                    gl.get_buffer_sub_data(glow::SHADER_STORAGE_BUFFER, 0, bytemuck::cast_slice_mut(&mut read));
                    about.after(&read, inputs.sentinel, record)?;
                }
            }
        }
        self.context.checked("the dispatches").map_err(LaneError::Api)?;
        Ok(Captured { words, primitives: Vec::new() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENTINEL: u32 = 0x7fc0_1111;

    fn buffer() -> StorageBuffer {
        StorageBuffer { block: "B".to_owned(), bytes: 16, before: vec![(0, 0), (1, 4)], after: vec![(0, 4), (1, 8)] }
    }

    #[test]
    fn a_buffer_holds_its_words_and_a_canary() {
        let words = buffer().before(&[5, 6], SENTINEL);
        assert_eq!((words.len(), &words[..3]), (4 + BEHIND / 4, &[5, 6, SENTINEL][..]));
        let mut record = [0; 2];
        buffer().after(&words, SENTINEL, &mut record).unwrap();
        assert_eq!(record, [6, SENTINEL]);
    }

    #[test]
    fn a_write_behind_a_buffer_is_an_error() {
        let mut words = buffer().before(&[5, 6], SENTINEL);
        words[5] = 1;
        let error = buffer().after(&words, SENTINEL, &mut [0; 2]).unwrap_err().to_string();
        assert!(error.contains("wrote 4 bytes behind the end of `B`, which has 16 bytes"), "{error}");
    }
}
