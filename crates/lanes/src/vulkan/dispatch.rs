//! Whole dispatches of a compute stage: one for each invocation of a batch, with buffers of its own and a canary behind each.

use super::Job;
use super::gpu::{Gpu, as_bytes};
use crate::{Actual, LaneError, Marks, PATIENCE, Runner, buffers};
use base::value::Batch;
use program::BoundBuffer;

/// Dispatches of one submission at most.
const MOST: usize = 64;

/// Bytes of all buffers of one submission that are still made.
const BYTES: usize = 1 << 28;

pub(super) struct DispatchRunner {
    gpu: Gpu,
    job: Job,
    groups: [u32; 3],
    pipeline: wgpu::ComputePipeline,
    buffers: Vec<Slices>,
    /// For each dispatch, its bind groups.
    bound: Vec<Vec<(u32, wgpu::BindGroup)>>,
    capacity: usize,
}

/// A buffer of the shader, once for each dispatch of a submission.
struct Slices {
    about: BoundBuffer,
    /// Bytes from one to the next.
    stride: usize,
    buffer: wgpu::Buffer,
    readback: Option<wgpu::Buffer>,
}

impl DispatchRunner {
    pub fn new(gpu: &Gpu, job: &Job, groups: [u32; 3], all: &[BoundBuffer], most: usize) -> Result<Self, LaneError> {
        use wgpu::BufferUsages as Usage;
        if !job.textures.is_empty() {
            return Err(LaneError::Unsupported("textures in a whole dispatch".to_owned()));
        }
        let limits = gpu.device.limits();
        let lies = limits.min_storage_buffer_offset_alignment.max(limits.min_uniform_buffer_offset_alignment).max(4);
        let stride = |about: &BoundBuffer| (4 * buffers::words(about)).next_multiple_of(lies as usize);
        let each: usize = all.iter().map(stride).sum();
        let largest = all.iter().map(stride).max().unwrap_or(1);
        let room = BYTES.min(usize::try_from(limits.max_buffer_size).unwrap_or(usize::MAX));
        let capacity = most.min(MOST).min(BYTES / each.max(1)).min(room / largest.max(1)).max(1);
        for (axis, &count) in groups.iter().enumerate() {
            if count > limits.max_compute_workgroups_per_dimension {
                let most = limits.max_compute_workgroups_per_dimension;
                let axis = ["x", "y", "z"][axis];
                return Err(LaneError::Unsupported(format!("{count} workgroups along {axis}; the device has {most}")));
            }
        }
        gpu.checked(|| {
            let mut numbers: Vec<u32> = all.iter().map(|about| about.group).collect();
            numbers.sort_unstable();
            numbers.dedup();
            let layouts: Vec<(u32, wgpu::BindGroupLayout)> = numbers
                .iter()
                .map(|&group| {
                    let entries: Vec<_> = all.iter().filter(|about| about.group == group).map(entry).collect();
                    let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
                    (group, gpu.device.create_bind_group_layout(&descriptor))
                })
                .collect();
            let of = |group: u32| layouts.iter().find(|(own, _)| *own == group).map(|(_, layout)| layout);
            let last = numbers.last().map_or(0, |&last| last + 1);
            let listed: Vec<_> = (0..last).map(of).collect();
            let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &listed,
                immediate_size: 0,
            });
            let point = job.module.entry_points.first().map(|point| point.name.as_str());
            let module = gpu.shader(job);
            let pipeline = gpu.at("the creation of the compute pipeline", || {
                gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: None,
                    layout: Some(&layout),
                    module: &module,
                    entry_point: point,
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    cache: None,
                })
            });
            let buffers: Vec<Slices> = all
                .iter()
                .map(|about| {
                    let bytes = (stride(about) * capacity) as u64;
                    let usage = if about.uniform { Usage::UNIFORM } else { Usage::STORAGE | Usage::COPY_SRC };
                    let readback =
                        (!about.after.is_empty()).then(|| gpu.buffer(bytes, Usage::MAP_READ | Usage::COPY_DST));
                    let buffer = gpu.buffer(bytes, usage | Usage::COPY_DST);
                    Slices { about: about.clone(), stride: stride(about), buffer, readback }
                })
                .collect();
            let bound = (0..capacity)
                .map(|k| {
                    let groups = layouts.iter().map(|(group, layout)| {
                        let entries: Vec<_> =
                            buffers.iter().filter(|b| b.about.group == *group).map(|b| b.bound(k)).collect();
                        let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
                        (*group, gpu.device.create_bind_group(&descriptor))
                    });
                    groups.collect()
                })
                .collect();
            Self { gpu: gpu.clone(), job: job.clone(), groups, pipeline, buffers, bound, capacity }
        })
    }
}

fn entry(about: &BoundBuffer) -> wgpu::BindGroupLayoutEntry {
    let ty = match about.uniform {
        true => wgpu::BufferBindingType::Uniform,
        false => wgpu::BufferBindingType::Storage { read_only: !about.writable },
    };
    wgpu::BindGroupLayoutEntry {
        binding: about.binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}

impl Slices {
    /// What is bound for a dispatch.
    fn bound(&self, dispatch: usize) -> wgpu::BindGroupEntry<'_> {
        wgpu::BindGroupEntry {
            binding: self.about.binding,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &self.buffer,
                offset: (dispatch * self.stride) as u64,
                size: wgpu::BufferSize::new(u64::from(self.about.bytes)),
            }),
        }
    }

    /// What the buffers hold before. What nothing feeds, and what lies behind each, holds the sentinel.
    fn before(&self, batch: &Batch, count: usize, sentinel: u32) -> Vec<u32> {
        let mut words = vec![0; self.stride / 4 * count];
        for (k, own) in words.chunks_exact_mut(self.stride / 4).enumerate() {
            buffers::before(&self.about, batch, k, sentinel, own);
        }
        words
    }
}

impl Runner for DispatchRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = self.count_of(batch, "dispatches")?;
        let gpu = self.gpu.clone();
        let api = |e: &dyn std::fmt::Display| LaneError::Api(e.to_string());
        let marks = Marks::random();
        gpu.checked(|| {
            for slices in &self.buffers {
                gpu.queue.write_buffer(&slices.buffer, 0, as_bytes(&slices.before(batch, count, marks.sentinel)));
            }
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            for groups in &self.bound[..count] {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&self.pipeline);
                for (group, bound) in groups {
                    pass.set_bind_group(*group, bound, &[]);
                }
                let [x, y, z] = self.groups;
                pass.dispatch_workgroups(x, y, z);
            }
            for slices in &self.buffers {
                if let Some(readback) = &slices.readback {
                    let bytes = (slices.stride * count) as u64;
                    encoder.copy_buffer_to_buffer(&slices.buffer, 0, readback, 0, Some(bytes));
                }
            }
            gpu.queue.submit([encoder.finish()]);
            let (send, receive) = std::sync::mpsc::channel();
            let mut asked = 0;
            for slices in &self.buffers {
                if let Some(readback) = &slices.readback {
                    let send = send.clone();
                    asked += 1;
                    readback.slice(..(slices.stride * count) as u64).map_async(wgpu::MapMode::Read, move |result| {
                        // The receiver waits below; a send cannot fail before.
                        let _ = send.send(result);
                    });
                }
            }
            let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(PATIENCE) };
            match gpu.device.poll(wait) {
                Ok(_) => {}
                Err(wgpu::PollError::Timeout) => return Err(gpu.give_up()),
                Err(error) => return Err(api(&error)),
            }
            for _ in 0..asked {
                receive.recv().map_err(|e| api(&e))?.map_err(|e| api(&e))?;
            }
            let (layout, size) = (&self.job.output, self.job.output.words());
            let mut words = vec![marks.sentinel; size * count];
            for (k, record) in words.chunks_exact_mut(size).enumerate() {
                // A dispatch that came back has run: its buffers hold what it left there.
                record[0] = marks.canary ^ k as u32;
            }
            for slices in &self.buffers {
                let Some(readback) = &slices.readback else { continue };
                {
                    let view =
                        readback.slice(..(slices.stride * count) as u64).get_mapped_range().map_err(|e| api(&e))?;
                    let mut found = vec![0_u32; view.len() / 4];
                    bytemuck::cast_slice_mut(&mut found).copy_from_slice(&view);
                    for (own, record) in found.chunks_exact(slices.stride / 4).zip(words.chunks_exact_mut(size)) {
                        buffers::after(&slices.about, own, marks.sentinel, &mut record[layout.header_words()..])?;
                    }
                }
                readback.unmap();
            }
            Actual::accept(layout, words, count, marks)
        })?
    }
}
