//! One dispatch for each invocation, whose inputs are in a uniform buffer.

use super::Job;
use super::gpu::{Gpu, GpuOutputs, as_bytes};
use crate::{Actual, LaneError, Runner};
use base::value::Batch;
use program::{ENTRY_POINT, binding, uniform_blocks};

/// Most invocations of a batch: each is a dispatch.
const MOST: u64 = 4096;

pub(super) struct UniformsRunner {
    gpu: Gpu,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    /// A block for each invocation: its index, its inputs and its uniforms.
    blocks: wgpu::Buffer,
    /// Distance between neighbouring blocks, in bytes.
    stride: u32,
    outputs: GpuOutputs,
    capacity: usize,
}

impl UniformsRunner {
    pub fn new(gpu: &Gpu, job: &Job, capacity: usize) -> Result<Self, LaneError> {
        let limits = gpu.device.limits();
        let bytes = 4 * (1 + job.invocation.words() + job.case.words()).next_multiple_of(4) as u64;
        if bytes > limits.max_uniform_buffer_binding_size {
            let most = limits.max_uniform_buffer_binding_size;
            return Err(LaneError::Unsupported(format!("{bytes} bytes of inputs in a uniform buffer; {most} fit")));
        }
        let stride = bytes.next_multiple_of(u64::from(limits.min_uniform_buffer_offset_alignment));
        let words = job.output.words() as u64;
        let fit = (gpu.storage_words() / words.max(1)).min(limits.max_buffer_size / stride).min(MOST);
        let capacity = (capacity as u64).min(fit).max(1) as usize;
        gpu.checked(|| {
            let buffer = |binding, ty, dynamic| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: dynamic, min_binding_size: None },
                count: None,
            };
            let uniform = wgpu::BufferBindingType::Uniform;
            let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: None,
                entries: &[
                    buffer(binding::PARAMS, uniform, false),
                    buffer(binding::OUTPUTS, wgpu::BufferBindingType::Storage { read_only: false }, false),
                    buffer(binding::BLOCK, uniform, true),
                ],
            });
            let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            });
            let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: None,
                layout: Some(&pipeline_layout),
                module: &gpu.shader(job),
                entry_point: Some(ENTRY_POINT),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
            let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
            let blocks = gpu.buffer(stride * capacity as u64, usage);
            let outputs = GpuOutputs::new(gpu, &job.output, capacity);
            let block = wgpu::BufferBinding { buffer: &blocks, offset: 0, size: std::num::NonZeroU64::new(bytes) };
            let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: binding::PARAMS, resource: outputs.params.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: binding::OUTPUTS, resource: outputs.storage.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: binding::BLOCK, resource: wgpu::BindingResource::Buffer(block) },
                ],
            });
            Self { gpu: gpu.clone(), pipeline, group, blocks, stride: stride as u32, outputs, capacity }
        })
    }
}

impl Runner for UniformsRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = self.count_of(batch, "invocations")?;
        let gpu = self.gpu.clone();
        gpu.checked(|| {
            let words = uniform_blocks(batch, self.stride as usize / 4);
            gpu.queue.write_buffer(&self.blocks, 0, as_bytes(&words));
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let marks = self.outputs.begin(&mut encoder, count, batch.per_case);
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&self.pipeline);
                for index in 0..count as u32 {
                    pass.set_bind_group(0, &self.group, &[self.stride * index]);
                    pass.dispatch_workgroups(1, 1, 1);
                }
            }
            self.outputs.finish(encoder, count, marks)
        })?
    }
}
