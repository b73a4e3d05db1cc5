//! Draws of the vertex kernel: one draw a case, points that are clipped away.

use super::Job;
use super::gpu::{Gpu, GpuOutputs, as_bytes};
use super::texture::Textures;
use crate::{Actual, LaneError, Runner};
use base::value::{Batch, Scalar};
use program::{Attribute, Count, Drawn, ENTRY_POINT, UniformBlock, binding};

/// Size of the target that nothing is drawn to.
const TARGET: u32 = 4;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

pub(super) struct VertexRunner {
    gpu: Gpu,
    pipeline: wgpu::RenderPipeline,
    harness: wgpu::BindGroup,
    uniforms: wgpu::BindGroup,
    textures: Option<Textures>,
    target: wgpu::TextureView,
    /// One vertex buffer with all attributes side by side.
    vertices: wgpu::Buffer,
    /// For each word of the vertex buffer, the word of the invocation record that it holds.
    fed: Vec<usize>,
    record_words: usize,
    blocks: Vec<Uniforms>,
    outputs: GpuOutputs,
    /// The number of the draw that the shader reads: each vertex is a draw of its own.
    number: Option<Drawn>,
    capacity: usize,
}

/// A uniform buffer that holds a block for each case.
struct Uniforms {
    buffer: wgpu::Buffer,
    block: UniformBlock,
    /// Distance between the blocks of neighbouring cases, in bytes.
    stride: u32,
}

impl VertexRunner {
    pub fn new(
        gpu: &Gpu,
        job: &Job,
        (attributes, blocks, drawn): (&[Attribute], &[UniformBlock], &[Drawn]),
        capacity: usize,
    ) -> Result<Self, LaneError> {
        let number = number(drawn)?;
        let limits = gpu.device.limits();
        if blocks.len() > limits.max_dynamic_uniform_buffers_per_pipeline_layout as usize {
            return Err(LaneError::Unsupported(format!(
                "{} uniform blocks; the device takes {}",
                blocks.len(),
                limits.max_dynamic_uniform_buffers_per_pipeline_layout
            )));
        }
        let align = limits.min_uniform_buffer_offset_alignment;
        let stride = |block: &UniformBlock| block.bytes.next_multiple_of(align);
        let largest = blocks.iter().map(stride).max().unwrap_or(16);
        let words = job.output.words().max(job.invocation.words()) as u64;
        let fit = (gpu.storage_words() / words.max(1)).min(limits.max_buffer_size / u64::from(largest));
        let capacity = (capacity as u64).min(fit).max(1) as usize;

        if attributes.len() > limits.max_vertex_attributes as usize {
            let (found, most) = (attributes.len(), limits.max_vertex_attributes);
            return Err(LaneError::Unsupported(format!("{found} vertex attributes; the device takes {most}")));
        }
        let mut fed = Vec::new();
        let mut wgpu_attributes = Vec::new();
        for (k, attribute) in attributes.iter().enumerate() {
            let start = job.invocation.range(k).start;
            let missing = attribute.components > attribute.field.shape.rows;
            if missing {
                return Err(LaneError::Unsupported(format!(
                    "{} components for attribute `{}` of type `{}`",
                    attribute.components, attribute.field.name, attribute.field.shape
                )));
            }
            wgpu_attributes.push(wgpu::VertexAttribute {
                format: format(attribute.field.shape.scalar, attribute.components),
                offset: 4 * fed.len() as u64,
                shader_location: attribute.location,
            });
            fed.extend((0..attribute.components as usize).map(|c| start + c));
        }
        if 4 * fed.len() > limits.max_vertex_buffer_array_stride as usize {
            let most = limits.max_vertex_buffer_array_stride;
            return Err(LaneError::Unsupported(format!("{} bytes of a vertex; {most} fit", 4 * fed.len())));
        }
        gpu.checked(|| -> Result<Self, LaneError> {
            let textures = Textures::new(gpu, job, wgpu::ShaderStages::VERTEX)?;
            let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
            let blocks: Vec<Uniforms> = blocks
                .iter()
                .map(|block| Uniforms {
                    buffer: gpu.buffer(u64::from(stride(block)) * capacity as u64, usage),
                    stride: stride(block),
                    block: block.clone(),
                })
                .collect();
            let outputs = GpuOutputs::new(gpu, &job.output, capacity);
            let (harness_layout, uniform_layout) = layouts(gpu, &blocks);
            let mut groups = vec![Some(&harness_layout), Some(&uniform_layout)];
            groups.extend(textures.as_ref().map(|textures| Some(&textures.layout)));
            let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &groups,
                immediate_size: 0,
            });
            let buffer_layout = wgpu::VertexBufferLayout {
                array_stride: 4 * fed.len() as u64,
                step_mode: match &number {
                    Some(Drawn { count: Count::Vertex, .. }) => wgpu::VertexStepMode::Instance,
                    Some(_) | None => wgpu::VertexStepMode::Vertex,
                },
                attributes: &wgpu_attributes,
            };
            let module = gpu.shader(job);
            let pipeline = pipeline(gpu, &layout, &module, (!fed.is_empty()).then_some(buffer_layout));
            let harness = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &harness_layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: binding::PARAMS, resource: outputs.params.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: binding::OUTPUTS, resource: outputs.storage.as_entire_binding() },
                ],
            });
            let entries: Vec<_> = blocks
                .iter()
                .zip(0..)
                .map(|(uniforms, binding)| wgpu::BindGroupEntry {
                    binding,
                    resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                        buffer: &uniforms.buffer,
                        offset: 0,
                        size: std::num::NonZeroU64::new(u64::from(uniforms.block.bytes)),
                    }),
                })
                .collect();
            let uniforms = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &uniform_layout,
                entries: &entries,
            });
            let vertex_usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
            Ok(Self {
                textures,
                vertices: gpu.buffer(4 * (fed.len() * capacity) as u64, vertex_usage),
                target: target(gpu),
                record_words: job.invocation.words(),
                gpu: gpu.clone(),
                pipeline,
                harness,
                uniforms,
                fed,
                blocks,
                outputs,
                number,
                capacity,
            })
        })?
    }

    fn upload(&self, batch: &Batch, count: usize) {
        if !self.fed.is_empty() {
            let mut words = Vec::with_capacity(count * self.fed.len());
            for record in batch.invocations.chunks_exact(self.record_words) {
                words.extend(self.fed.iter().map(|&k| record[k]));
            }
            self.gpu.queue.write_buffer(&self.vertices, 0, as_bytes(&words));
        }
        for uniforms in &self.blocks {
            let stride = uniforms.stride as usize / 4;
            let mut words = vec![0; stride * batch.case_count()];
            for (case, block) in words.chunks_exact_mut(stride).enumerate() {
                let values = batch.case(case);
                for place in &uniforms.block.places {
                    block[place.byte as usize / 4] = values[place.word as usize];
                }
            }
            self.gpu.queue.write_buffer(&uniforms.buffer, 0, as_bytes(&words));
        }
    }
}

impl Runner for VertexRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = self.count_of(batch, "vertices")?;
        let gpu = self.gpu.clone();
        let of = |number: &Drawn| -> Result<Numbers, LaneError> {
            let all = (0..count).map(|k| number.of(batch.invocation(k))).collect::<Result<_, _>>();
            Ok((number.count, all.map_err(LaneError::Unsupported)?))
        };
        let numbers = self.number.as_ref().map(of).transpose()?;
        gpu.checked(|| {
            self.upload(batch, count);
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let marks = self.outputs.begin(&mut encoder, count, batch.per_case);
            {
                let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                        view: &self.target,
                        depth_ops: Some(wgpu::Operations {
                            load: wgpu::LoadOp::Clear(1.0),
                            store: wgpu::StoreOp::Discard,
                        }),
                        stencil_ops: None,
                    }),
                    ..wgpu::RenderPassDescriptor::default()
                });
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, &self.harness, &[]);
                if let Some(textures) = &self.textures {
                    pass.set_bind_group(binding::TEXTURES, &textures.group, &[]);
                }
                if !self.fed.is_empty() {
                    pass.set_vertex_buffer(0, self.vertices.slice(..));
                }
                if self.blocks.is_empty() {
                    pass.set_bind_group(1, &self.uniforms, &[]);
                    draw(&mut pass, &numbers, 0..count as u32);
                }
                let cases = if self.blocks.is_empty() { 0 } else { batch.case_count() };
                for case in 0..cases as u32 {
                    let offsets: Vec<u32> = self.blocks.iter().map(|u| u.stride * case).collect();
                    pass.set_bind_group(1, &self.uniforms, &offsets);
                    let first = case * batch.per_case as u32;
                    draw(&mut pass, &numbers, first..first + batch.per_case as u32);
                }
            }
            self.outputs.finish(encoder, count, marks)
        })?
    }
}

/// For each vertex of a batch, the number that the shader reads.
type Numbers = (Count, Vec<u32>);

/// Draws vertices, each by itself where the shader reads a number: one of vertex and instance is what the sample says,
/// and the other one the place of the record.
fn draw(pass: &mut wgpu::RenderPass<'_>, numbers: &Option<Numbers>, vertices: std::ops::Range<u32>) {
    let Some((count, numbers)) = numbers else { return pass.draw(vertices, 0..1) };
    for k in vertices {
        let number = numbers[k as usize];
        let (number, place) = (number..number + 1, k..k + 1);
        match count {
            Count::Vertex => pass.draw(number, place),
            _ => pass.draw(place, number),
        }
    }
}

/// The number of the draw that a shader reads.
///
/// # Errors
/// [`LaneError::Unsupported`] by name for what the draws here do not set.
fn number(drawn: &[Drawn]) -> Result<Option<Drawn>, LaneError> {
    if let Some(other) = drawn.iter().find(|d| !matches!(d.count, Count::Vertex | Count::Instance)) {
        return Err(LaneError::Unsupported(other.refusal()));
    }
    match drawn {
        [] => Ok(None),
        [one] => Ok(Some(one.clone())),
        [one, other, ..] => Err(LaneError::Unsupported(format!(
            "`{}` and `{}` at once: one of them tells where the outputs go",
            one.name, other.name
        ))),
    }
}

fn layouts(gpu: &Gpu, blocks: &[Uniforms]) -> (wgpu::BindGroupLayout, wgpu::BindGroupLayout) {
    let buffer = |binding, ty, dynamic| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: dynamic, min_binding_size: None },
        count: None,
    };
    let storage = wgpu::BufferBindingType::Storage { read_only: false };
    let make = |entries: &[wgpu::BindGroupLayoutEntry]| {
        gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries })
    };
    let uniform = wgpu::BufferBindingType::Uniform;
    let uniforms: Vec<_> = (0..blocks.len() as u32).map(|k| buffer(k, uniform, true)).collect();
    let harness = [buffer(binding::PARAMS, uniform, false), buffer(binding::OUTPUTS, storage, false)];
    (make(&harness), make(&uniforms))
}

fn pipeline(
    gpu: &Gpu,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    buffer: Option<wgpu::VertexBufferLayout<'_>>,
) -> wgpu::RenderPipeline {
    let buffers: Vec<_> = buffer.into_iter().map(Some).collect();
    gpu.at("the creation of the vertex pipeline", || {
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(ENTRY_POINT),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState {
                topology: wgpu::PrimitiveTopology::PointList,
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(false),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        })
    })
}

fn target(gpu: &Gpu) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: TARGET, height: TARGET, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn format(scalar: Scalar, components: u8) -> wgpu::VertexFormat {
    use wgpu::VertexFormat as F;
    match (scalar, components) {
        (Scalar::F32, 1) => F::Float32,
        (Scalar::F32, 2) => F::Float32x2,
        (Scalar::F32, 3) => F::Float32x3,
        (Scalar::F32, _) => F::Float32x4,
        (Scalar::I32, 1) => F::Sint32,
        (Scalar::I32, 2) => F::Sint32x2,
        (Scalar::I32, 3) => F::Sint32x3,
        (Scalar::I32, _) => F::Sint32x4,
        // `bool` attributes do not exist in GLSL; the front end refuses them.
        (Scalar::U32 | Scalar::Bool, 1) => F::Uint32,
        (Scalar::U32 | Scalar::Bool, 2) => F::Uint32x2,
        (Scalar::U32 | Scalar::Bool, 3) => F::Uint32x3,
        (Scalar::U32 | Scalar::Bool, _) => F::Uint32x4,
    }
}
