//! Draws whose vertices are captured and whose pixels are not made.

#![expect(unsafe_code, reason = "Vulkan is a C interface")]

use std::rc::Rc;

use ash::vk;

use super::capture::Feed;
use super::gpu::{Gpu, GpuBuffer};
use super::interface::DescriptorBlock;
use crate::LaneError;
use base::value::Batch;

/// A stage with its module.
pub(super) type Module<'a> = (vk::ShaderStageFlags, &'a [u32]);

/// A vertex attribute: its location and format. Attributes stand side by side in a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DrawAttribute {
    pub location: u32,
    pub format: vk::Format,
    pub words: u32,
}

/// What is common to all passes of a kernel.
pub(super) struct Setting<'a> {
    pub attributes: &'a [DrawAttribute],
    pub topology: vk::PrimitiveTopology,
    /// Uniform blocks of the stage under test.
    pub blocks: Vec<DescriptorBlock>,
    pub feed: Feed,
    pub stage: vk::ShaderStageFlags,
    /// Most vertices, and most cases, of a batch.
    pub most: (usize, usize),
    /// Every vertex is a draw of its own, whose numbers are its own.
    pub alone: bool,
}

/// One pipeline of a kernel, and what it captures.
pub(super) struct Pass<'a> {
    pub modules: &'a [Module<'a>],
    /// Words of a captured vertex.
    pub words: usize,
    /// Most captured vertices.
    pub most: usize,
    /// Most draws that are counted by themselves.
    pub counted: usize,
}

/// Vertices of one draw, all of one case.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn {
    pub case: usize,
    pub first: usize,
    pub count: usize,
    /// The first vertex and the first instance as the stage sees them, for a vertex that is drawn alone.
    pub numbers: Option<(u32, u32)>,
}

/// What a device says of the primitives of a draw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct PrimitiveCounts {
    pub written: u64,
    pub needed: u64,
}

struct Uniforms {
    block: DescriptorBlock,
    buffer: GpuBuffer,
    /// Distance between the blocks of neighbouring cases, in words.
    stride: usize,
}

struct Pipeline {
    handle: vk::Pipeline,
    captured: GpuBuffer,
    words: usize,
    queries: vk::QueryPool,
    counted: usize,
}

/// Pipelines with their buffers.
pub(super) struct Draws {
    gpu: Rc<Gpu>,
    uniforms: Vec<Uniforms>,
    vertices: GpuBuffer,
    set_layouts: Vec<vk::DescriptorSetLayout>,
    sets: Vec<vk::DescriptorSet>,
    pool: vk::DescriptorPool,
    layout: vk::PipelineLayout,
    render_pass: vk::RenderPass,
    frame: vk::Framebuffer,
    passes: Vec<Pipeline>,
    attributes: Vec<DrawAttribute>,
    topology: vk::PrimitiveTopology,
    alone: bool,
}

fn api(error: vk::Result) -> LaneError {
    LaneError::Api(error.to_string())
}

impl Draws {
    pub fn new(gpu: &Rc<Gpu>, setting: Setting<'_>) -> Result<Self, LaneError> {
        let limits = &gpu.limits;
        let (dynamic, range, align, fed_by) = match setting.feed {
            Feed::Uniform => (
                limits.max_descriptor_set_uniform_buffers_dynamic as usize,
                limits.max_uniform_buffer_range,
                limits.min_uniform_buffer_offset_alignment,
                vk::BufferUsageFlags::UNIFORM_BUFFER,
            ),
            Feed::Storage => (
                limits.max_descriptor_set_storage_buffers_dynamic as usize,
                limits.max_storage_buffer_range,
                limits.min_storage_buffer_offset_alignment,
                vk::BufferUsageFlags::STORAGE_BUFFER,
            ),
        };
        let refuse = |what: String| Err(LaneError::Unsupported(what));
        if setting.blocks.len() > dynamic {
            return refuse(format!("{} uniform blocks; the device takes {dynamic}", setting.blocks.len()));
        }
        if let Some(block) = setting.blocks.iter().find(|block| block.bytes > range) {
            return refuse(format!("{} bytes of uniforms in a block; the device takes {range}", block.bytes));
        }
        if setting.attributes.iter().any(|a| a.location >= limits.max_vertex_input_attributes) {
            return refuse(format!("more than {} vertex attributes", limits.max_vertex_input_attributes));
        }
        let vertex: usize = setting.attributes.iter().map(|a| a.words as usize).sum();
        let usage = vk::BufferUsageFlags::VERTEX_BUFFER;
        let mut this = Self {
            vertices: GpuBuffer::new(gpu, vertex * setting.most.0, usage)?,
            gpu: gpu.clone(),
            uniforms: Vec::new(),
            set_layouts: Vec::new(),
            sets: Vec::new(),
            pool: vk::DescriptorPool::null(),
            layout: vk::PipelineLayout::null(),
            render_pass: vk::RenderPass::null(),
            frame: vk::Framebuffer::null(),
            passes: Vec::new(),
            attributes: setting.attributes.to_vec(),
            topology: setting.topology,
            alone: setting.alone,
        };
        let align = align.max(16) as u32;
        let mut blocks = setting.blocks;
        // Offsets are given in the order of sets and bindings.
        blocks.sort_by_key(|block| (block.set, block.binding));
        for block in blocks {
            let stride = block.bytes.next_multiple_of(align) as usize / 4;
            let buffer = GpuBuffer::new(gpu, stride * setting.most.1, fed_by)?;
            this.uniforms.push(Uniforms { block, buffer, stride });
        }
        this.describe(setting.stage, setting.feed)?;
        this.target()?;
        Ok(this)
    }

    /// Layouts and sets of the uniform buffers.
    fn describe(&mut self, stage: vk::ShaderStageFlags, feed: Feed) -> Result<(), LaneError> {
        let device = &self.gpu.device;
        let kind = match feed {
            Feed::Uniform => vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC,
            Feed::Storage => vk::DescriptorType::STORAGE_BUFFER_DYNAMIC,
        };
        let sets = self.uniforms.iter().map(|u| u.block.set + 1).max().unwrap_or(0);
        for set in 0..sets {
            let binding = |u: &Uniforms| {
                let at = vk::DescriptorSetLayoutBinding::default().binding(u.block.binding).stage_flags(stage);
                at.descriptor_type(kind).descriptor_count(1)
            };
            let bindings: Vec<_> = self.uniforms.iter().filter(|u| u.block.set == set).map(binding).collect();
            let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            // SAFETY: the device is alive, here and below, and structures live until the calls return.
            self.set_layouts.push(unsafe { device.create_descriptor_set_layout(&create, None) }.map_err(api)?);
        }
        let create = vk::PipelineLayoutCreateInfo::default().set_layouts(&self.set_layouts);
        // SAFETY: the layouts of the sets are alive.
        self.layout = unsafe { device.create_pipeline_layout(&create, None) }.map_err(api)?;
        if sets == 0 {
            return Ok(());
        }
        let sizes = [vk::DescriptorPoolSize::default().ty(kind).descriptor_count(self.uniforms.len() as u32)];
        let create = vk::DescriptorPoolCreateInfo::default().max_sets(sets).pool_sizes(&sizes);
        // SAFETY: as above.
        self.pool = unsafe { device.create_descriptor_pool(&create, None) }.map_err(api)?;
        let allocate =
            vk::DescriptorSetAllocateInfo::default().descriptor_pool(self.pool).set_layouts(&self.set_layouts);
        // SAFETY: the pool has room for these sets.
        self.sets = unsafe { device.allocate_descriptor_sets(&allocate) }.map_err(api)?;
        for uniforms in &self.uniforms {
            let buffers = [vk::DescriptorBufferInfo::default()
                .buffer(uniforms.buffer.handle)
                .range(u64::from(uniforms.block.bytes))];
            let write = vk::WriteDescriptorSet::default()
                .dst_set(self.sets[uniforms.block.set as usize])
                .dst_binding(uniforms.block.binding)
                .descriptor_type(kind)
                .buffer_info(&buffers);
            // SAFETY: set and buffer are alive, and no commands use the set yet.
            unsafe { device.update_descriptor_sets(&[write], &[]) };
        }
        Ok(())
    }

    /// A target without any picture.
    fn target(&mut self) -> Result<(), LaneError> {
        let device = &self.gpu.device;
        let passes = [vk::SubpassDescription::default().pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)];
        let create = vk::RenderPassCreateInfo::default().subpasses(&passes);
        // SAFETY: the device is alive, and the structures live until the calls return.
        self.render_pass = unsafe { device.create_render_pass(&create, None) }.map_err(api)?;
        let create = vk::FramebufferCreateInfo::default().render_pass(self.render_pass).width(1).height(1).layers(1);
        // SAFETY: as above.
        self.frame = unsafe { device.create_framebuffer(&create, None) }.map_err(api)?;
        Ok(())
    }

    /// Adds a pipeline.
    pub fn add(&mut self, pass: &Pass<'_>) -> Result<(), LaneError> {
        let most = self.gpu.feedback_limits.max_transform_feedback_buffer_data_size;
        if 4 * pass.words as u64 > u64::from(most) {
            return Err(LaneError::Unsupported(format!("{} bytes of a vertex; {most} are captured", 4 * pass.words)));
        }
        let usage = vk::BufferUsageFlags::TRANSFORM_FEEDBACK_BUFFER_EXT;
        // One vertex of room behind them shows what is written there.
        let captured = GpuBuffer::new(&self.gpu, pass.words * (pass.most + 1), usage)?;
        let device = &self.gpu.device;
        let mut modules = Vec::new();
        let mut made = Ok(vk::Pipeline::null());
        for (stage, words) in pass.modules {
            let create = vk::ShaderModuleCreateInfo::default().code(words);
            // SAFETY: the words come from a translator, and a pass of ours that keeps modules valid, which a test
            // holds with spirv-val.
            match unsafe { device.create_shader_module(&create, None) } {
                Ok(module) => modules.push((*stage, module)),
                Err(error) => made = Err(error),
            }
        }
        if made.is_ok() {
            made = self.pipeline(&modules);
        }
        for (_, module) in modules {
            // SAFETY: a pipeline does without its modules once it is made.
            unsafe { device.destroy_shader_module(module, None) };
        }
        let failed = |error| LaneError::Api(format!("the creation of the graphics pipeline: {error}"));
        let handle = made.map_err(failed)?;
        let create = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::TRANSFORM_FEEDBACK_STREAM_EXT)
            .query_count(pass.counted.max(1) as u32);
        // The pipeline is freed with the others, whatever comes next.
        let queries = vk::QueryPool::null();
        self.passes.push(Pipeline { handle, captured, words: pass.words, queries, counted: pass.counted.max(1) });
        // SAFETY: the device has these queries, which was asked when it was opened.
        let queries = unsafe { self.gpu.device.create_query_pool(&create, None) }.map_err(api)?;
        if let Some(last) = self.passes.last_mut() {
            last.queries = queries;
        }
        Ok(())
    }

    fn pipeline(&self, modules: &[(vk::ShaderStageFlags, vk::ShaderModule)]) -> Result<vk::Pipeline, vk::Result> {
        let stage =
            |&(stage, module)| vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(c"main");
        let stages: Vec<_> = modules.iter().map(stage).collect();
        let mut offset = 0;
        let mut described = Vec::new();
        for attribute in &self.attributes {
            let at = vk::VertexInputAttributeDescription::default().location(attribute.location).offset(offset);
            described.push(at.format(attribute.format));
            offset += 4 * attribute.words;
        }
        // Whatever the number of a vertex that is drawn alone, its attributes are at the start of what is bound.
        let stride = if self.alone { 0 } else { offset };
        let bindings = [vk::VertexInputBindingDescription::default().stride(stride)];
        let bindings = if self.attributes.is_empty() { &[][..] } else { &bindings };
        let input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(bindings)
            .vertex_attribute_descriptions(&described);
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default().topology(self.topology);
        let viewports = [vk::Viewport { width: 1.0, height: 1.0, max_depth: 1.0, ..vk::Viewport::default() }];
        let scissors = [vk::Rect2D { extent: vk::Extent2D { width: 1, height: 1 }, ..vk::Rect2D::default() }];
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewports(&viewports).scissors(&scissors);
        let raster =
            vk::PipelineRasterizationStateCreateInfo::default().rasterizer_discard_enable(true).line_width(1.0);
        let samples =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let create = vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .layout(self.layout)
            .render_pass(self.render_pass);
        // SAFETY: all handles are of this device and alive, and what is pointed to lives until the call returns.
        let made = unsafe { self.gpu.device.create_graphics_pipelines(vk::PipelineCache::null(), &[create], None) };
        made.map(|pipelines| pipelines[0]).map_err(|(_, error)| error)
    }

    /// Fills the vertex buffer, `fed` words for a vertex, and the uniform buffers.
    pub fn upload(&mut self, vertices: impl Iterator<Item = u32>, batch: &Batch) {
        for (to, word) in self.vertices.words().iter_mut().zip(vertices) {
            *to = word;
        }
        for uniforms in &mut self.uniforms {
            let blocks = uniforms.buffer.words().chunks_exact_mut(uniforms.stride);
            for (case, block) in blocks.enumerate().take(batch.case_count()) {
                let values = batch.case(case);
                for &(word, byte) in &uniforms.block.places {
                    block[byte as usize / 4] = values[word];
                }
            }
        }
    }

    /// True when nothing differs between cases, so that one draw does for all.
    pub fn is_uniform(&self) -> bool {
        self.uniforms.is_empty()
    }

    /// Draws, and gives what the device counted: for each draw by itself, or for all of them together. What is
    /// captured overwrites `blank`, a word of this run alone.
    pub fn run(
        &mut self,
        pass: usize,
        draws: &[Drawn],
        each: bool,
        blank: u32,
    ) -> Result<Vec<PrimitiveCounts>, LaneError> {
        let (device, feedback) = (&self.gpu.device, self.gpu.feedback.fp());
        let Pipeline { handle, captured, queries, counted, .. } = &mut self.passes[pass];
        let queries = *queries;
        captured.words().fill(blank);
        let count = if each { draws.len() } else { 1 };
        if count > *counted {
            return Err(LaneError::Unsupported(format!("{count} draws that are counted; {counted} are")));
        }
        let whole = vk::Rect2D { extent: vk::Extent2D { width: 1, height: 1 }, ..vk::Rect2D::default() };
        let begin =
            vk::RenderPassBeginInfo::default().render_pass(self.render_pass).framebuffer(self.frame).render_area(whole);
        let done = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFORM_FEEDBACK_WRITE_EXT)
            .dst_access_mask(vk::AccessFlags::HOST_READ);
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        let bytes: u64 = self.attributes.iter().map(|a| 4 * u64::from(a.words)).sum();
        self.gpu.submit(|to| {
            // SAFETY: the commands are being recorded, everything that they name belongs to `self`, which outlives
            // their execution, and draws stay inside of the buffers, which their sizes see to.
            unsafe {
                device.cmd_reset_query_pool(to, queries, 0, count as u32);
                device.cmd_begin_render_pass(to, &begin, vk::SubpassContents::INLINE);
                device.cmd_bind_pipeline(to, graphics, *handle);
                device.cmd_bind_vertex_buffers(to, 0, &[self.vertices.handle], &[0]);
                (feedback.cmd_bind_transform_feedback_buffers_ext)(to, 0, 1, &captured.handle, &0, &vk::WHOLE_SIZE);
                (feedback.cmd_begin_transform_feedback_ext)(to, 0, 0, std::ptr::null(), std::ptr::null());
                let mut bound = None;
                for (draw, k) in draws.iter().zip(0..) {
                    if !self.sets.is_empty() && bound != Some(draw.case) {
                        let offsets: Vec<u32> =
                            self.uniforms.iter().map(|u| (4 * u.stride * draw.case) as u32).collect();
                        device.cmd_bind_descriptor_sets(to, graphics, self.layout, 0, &self.sets, &offsets);
                        bound = Some(draw.case);
                    }
                    if each || k == 0 {
                        (feedback.cmd_begin_query_indexed_ext)(to, queries, k, vk::QueryControlFlags::empty(), 0);
                    }
                    let (first, instance) = draw.numbers.unwrap_or((draw.first as u32, 0));
                    if draw.numbers.is_some() {
                        device.cmd_bind_vertex_buffers(to, 0, &[self.vertices.handle], &[bytes * draw.first as u64]);
                    }
                    device.cmd_draw(to, draw.count as u32, 1, first, instance);
                    if each {
                        (feedback.cmd_end_query_indexed_ext)(to, queries, k, 0);
                    }
                }
                if !each && !draws.is_empty() {
                    (feedback.cmd_end_query_indexed_ext)(to, queries, 0, 0);
                }
                (feedback.cmd_end_transform_feedback_ext)(to, 0, 0, std::ptr::null(), std::ptr::null());
                device.cmd_end_render_pass(to);
                let (from, until) = (vk::PipelineStageFlags::TRANSFORM_FEEDBACK_EXT, vk::PipelineStageFlags::HOST);
                device.cmd_pipeline_barrier(to, from, until, vk::DependencyFlags::empty(), &[done], &[], &[]);
            }
        })?;
        let mut counts = vec![[0_u64; 2]; if draws.is_empty() { 0 } else { count }];
        if !counts.is_empty() {
            let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
            // SAFETY: the commands have ended, so that every query that was begun has a result of two numbers.
            unsafe { device.get_query_pool_results(queries, 0, &mut counts, flags) }.map_err(api)?;
        }
        Ok(counts.into_iter().map(|[written, needed]| PrimitiveCounts { written, needed }).collect())
    }

    /// Proves that the last run wrote so many vertices and nothing behind them. Gives the first one that it did not.
    ///
    /// # Errors
    /// [`LaneError::Api`] where something stands behind the last one.
    pub fn unwritten(&mut self, pass: usize, vertices: usize, blank: u32) -> Result<Option<usize>, LaneError> {
        let Pipeline { captured, words, .. } = &mut self.passes[pass];
        unwritten(captured.words(), *words, vertices, blank)
    }

    /// The vertices that a pass captured in its last run, one behind the other.
    pub fn captured(&mut self, pass: usize) -> std::slice::ChunksExact<'_, u32> {
        let Pipeline { captured, words, .. } = &mut self.passes[pass];
        let words = (*words).max(1);
        captured.words().chunks_exact(words)
    }
}

/// The first of so many vertices with a word that was there before.
fn unwritten(captured: &[u32], size: usize, vertices: usize, blank: u32) -> Result<Option<usize>, LaneError> {
    let size = size.max(1);
    let (written, behind) = captured.split_at((vertices * size).min(captured.len()));
    if let Some(at) = behind.iter().take(size).position(|&word| word != blank) {
        let at = vertices * size + at;
        return Err(LaneError::Api(format!("the driver wrote behind what it captured, at word {at}")));
    }
    Ok(written.chunks(size).position(|vertex| vertex.contains(&blank)))
}

impl Drop for Draws {
    fn drop(&mut self) {
        // SAFETY: the device is at rest, and no command buffer that names any of these is left. Null handles are
        // ignored.
        self.gpu.free(|device| unsafe {
            for pass in &self.passes {
                device.destroy_query_pool(pass.queries, None);
                device.destroy_pipeline(pass.handle, None);
            }
            device.destroy_framebuffer(self.frame, None);
            device.destroy_render_pass(self.render_pass, None);
            device.destroy_pipeline_layout(self.layout, None);
            device.destroy_descriptor_pool(self.pool, None);
            for &layout in &self.set_layouts {
                device.destroy_descriptor_set_layout(layout, None);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::unwritten;

    const BLANK: u32 = 0x7fc1_2345;

    #[test]
    fn a_vertex_that_the_driver_left_is_found_in_whatever_word() {
        let captured = [1, 2, 3, 4, BLANK, BLANK];
        assert_eq!(unwritten(&captured, 2, 2, BLANK).unwrap(), None);
        // One that it counts and did not write, and one of which a word is left.
        assert_eq!(unwritten(&captured, 2, 3, BLANK).unwrap(), Some(2));
        assert_eq!(unwritten(&[1, 2, 3, BLANK, BLANK, BLANK], 2, 2, BLANK).unwrap(), Some(1));
    }

    #[test]
    fn what_the_driver_writes_behind_the_last_vertex_is_an_error() {
        let error = unwritten(&[1, 2, 3, 4, BLANK, 9], 2, 2, BLANK).unwrap_err().to_string();
        assert!(error.ends_with("the driver wrote behind what it captured, at word 5"), "{error}");
    }
}
