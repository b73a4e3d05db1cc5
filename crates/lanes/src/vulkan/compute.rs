//! One dispatch of the compute kernel for a batch.

use super::Job;
use super::gpu::{Gpu, GpuOutputs, as_bytes};
use super::texture::Textures;
use crate::{Actual, LaneError, Runner};
use base::value::Batch;
use program::{ENTRY_POINT, WORKGROUP, binding};

pub(super) struct ComputeRunner {
    gpu: Gpu,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    textures: Option<Textures>,
    invocations: wgpu::Buffer,
    cases: wgpu::Buffer,
    outputs: GpuOutputs,
    capacity: usize,
}

impl ComputeRunner {
    pub fn new(gpu: &Gpu, job: &Job, capacity: usize) -> Result<Self, LaneError> {
        let words = job.output.words().max(job.invocation.words()).max(job.case.words()) as u64;
        let groups = u64::from(gpu.device.limits().max_compute_workgroups_per_dimension) * u64::from(WORKGROUP);
        let capacity = (capacity as u64).min(gpu.storage_words() / words.max(1)).min(groups).max(1) as usize;
        gpu.checked(|| -> Result<Self, LaneError> {
            let textures = Textures::new(gpu, job, wgpu::ShaderStages::COMPUTE)?;
            let (read, written) = (Some(true), Some(false));
            let mut bindings = vec![(binding::PARAMS, None), (binding::OUTPUTS, written)];
            // A kernel has no binding for a buffer that it never reads.
            if job.invocation.words() > 0 {
                bindings.push((binding::INVOCATIONS, read));
            }
            if job.case.words() > 0 {
                bindings.push((binding::CASES, read));
            }
            let bindings: Vec<_> = bindings
                .into_iter()
                .map(|(binding, storage)| wgpu::BindGroupLayoutEntry {
                    binding,
                    visibility: wgpu::ShaderStages::COMPUTE,
                    ty: wgpu::BindingType::Buffer {
                        ty: match storage {
                            None => wgpu::BufferBindingType::Uniform,
                            Some(read_only) => wgpu::BufferBindingType::Storage { read_only },
                        },
                        has_dynamic_offset: false,
                        min_binding_size: None,
                    },
                    count: None,
                })
                .collect();
            let buffers = gpu
                .device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &bindings });
            let groups: Vec<_> = match &textures {
                Some(textures) => vec![Some(&buffers), None, Some(&textures.layout)],
                None => vec![Some(&buffers)],
            };
            let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &groups,
                immediate_size: 0,
            });
            let module = gpu.shader(job);
            let pipeline = gpu.at("the creation of the compute pipeline", || {
                gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: None,
                    layout: Some(&layout),
                    module: &module,
                    entry_point: Some(ENTRY_POINT),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    cache: None,
                })
            });
            let input = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
            let size = |words: usize| 4 * (words * capacity) as u64;
            let invocations = gpu.buffer(size(job.invocation.words()), input);
            let cases = gpu.buffer(size(job.case.words()), input);
            let outputs = GpuOutputs::new(gpu, &job.output, capacity);
            let entry = |at, buffer: &wgpu::Buffer| (at, buffer.clone());
            let mut bound = vec![entry(binding::PARAMS, &outputs.params), entry(binding::OUTPUTS, &outputs.storage)];
            if job.invocation.words() > 0 {
                bound.push(entry(binding::INVOCATIONS, &invocations));
            }
            if job.case.words() > 0 {
                bound.push(entry(binding::CASES, &cases));
            }
            let entries: Vec<_> = bound
                .iter()
                .map(|(at, buffer)| wgpu::BindGroupEntry { binding: *at, resource: buffer.as_entire_binding() })
                .collect();
            let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &buffers,
                entries: &entries,
            });
            Ok(Self { gpu: gpu.clone(), pipeline, group, textures, invocations, cases, outputs, capacity })
        })?
    }
}

impl Runner for ComputeRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = self.count_of(batch, "invocations")?;
        let gpu = self.gpu.clone();
        gpu.checked(|| {
            gpu.queue.write_buffer(&self.invocations, 0, as_bytes(&batch.invocations));
            gpu.queue.write_buffer(&self.cases, 0, as_bytes(&batch.cases));
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let marks = self.outputs.begin(&mut encoder, count, batch.per_case);
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, &self.group, &[]);
                if let Some(textures) = &self.textures {
                    pass.set_bind_group(binding::TEXTURES, &textures.group, &[]);
                }
                pass.dispatch_workgroups((count as u32).div_ceil(WORKGROUP), 1, 1);
            }
            self.outputs.finish(encoder, count, marks)
        })?
    }
}
