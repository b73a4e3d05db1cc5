//! The author's compute stage as whole dispatches, one after the other, with buffers that are filled anew and a canary
//! behind each of them.

#![expect(unsafe_code, reason = "Vulkan is a C interface")]

use std::rc::Rc;

use ::spirv::{Decoration, StorageClass};
use ash::vk;

use super::Job;
use super::gpu::{Gpu, GpuBuffer};
use super::spirv::{Reflection, Type, Variable};
use crate::{Actual, LaneError, Marks, Runner, buffers};
use base::value::Batch;
use program::{BoundBuffer, OutputLayout, Program};

/// Dispatches of one batch at most.
const MOST: usize = 64;

pub(super) struct DispatchRunner {
    gpu: Rc<Gpu>,
    layout: OutputLayout,
    groups: [u32; 3],
    buffers: Vec<(BoundBuffer, GpuBuffer)>,
    set_layouts: Vec<vk::DescriptorSetLayout>,
    pool: vk::DescriptorPool,
    sets: Vec<vk::DescriptorSet>,
    pipeline_layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
    capacity: usize,
}

fn api(error: vk::Result) -> LaneError {
    LaneError::Api(error.to_string())
}

fn unsupported<T>(what: String) -> Result<T, LaneError> {
    Err(LaneError::Unsupported(what))
}

fn kind(about: &BoundBuffer) -> vk::DescriptorType {
    if about.uniform { vk::DescriptorType::UNIFORM_BUFFER } else { vk::DescriptorType::STORAGE_BUFFER }
}

impl DispatchRunner {
    pub fn new(
        gpu: &Rc<Gpu>,
        job: &Job,
        (groups, size, all): ([u32; 3], [u32; 3], &[BoundBuffer]),
        capacity: usize,
    ) -> Result<Self, LaneError> {
        fits(gpu, groups, size, all)?;
        fed(&Reflection::of(&job.module), all)?;
        let mut this = Self {
            gpu: gpu.clone(),
            layout: job.output.clone(),
            groups,
            buffers: Vec::new(),
            set_layouts: Vec::new(),
            pool: vk::DescriptorPool::null(),
            sets: Vec::new(),
            pipeline_layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
            capacity: capacity.clamp(1, MOST),
        };
        for about in all {
            let usage = match about.uniform {
                true => vk::BufferUsageFlags::UNIFORM_BUFFER,
                false => vk::BufferUsageFlags::STORAGE_BUFFER,
            };
            this.buffers.push((about.clone(), GpuBuffer::new(gpu, buffers::words(about), usage)?));
        }
        this.describe()?;
        this.compile(&job.module)?;
        Ok(this)
    }

    /// Layouts and sets of the buffers.
    fn describe(&mut self) -> Result<(), LaneError> {
        let device = &self.gpu.device;
        let sets = self.buffers.iter().map(|(about, _)| about.group + 1).max().unwrap_or(0);
        for set in 0..sets {
            let own = self.buffers.iter().filter(|(about, _)| about.group == set);
            let binding = |(about, _): &(BoundBuffer, GpuBuffer)| {
                let at = vk::DescriptorSetLayoutBinding::default().binding(about.binding).descriptor_count(1);
                at.descriptor_type(kind(about)).stage_flags(vk::ShaderStageFlags::COMPUTE)
            };
            let bindings: Vec<_> = own.map(binding).collect();
            let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            // SAFETY: the device is alive, here and below, and structures live until the calls return.
            self.set_layouts.push(unsafe { device.create_descriptor_set_layout(&create, None) }.map_err(api)?);
        }
        let create = vk::PipelineLayoutCreateInfo::default().set_layouts(&self.set_layouts);
        // SAFETY: the layouts of the sets are alive.
        self.pipeline_layout = unsafe { device.create_pipeline_layout(&create, None) }.map_err(api)?;
        if sets == 0 {
            return Ok(());
        }
        let count = self.buffers.len() as u32;
        let sizes = [vk::DescriptorType::UNIFORM_BUFFER, vk::DescriptorType::STORAGE_BUFFER]
            .map(|ty| vk::DescriptorPoolSize::default().ty(ty).descriptor_count(count));
        let create = vk::DescriptorPoolCreateInfo::default().max_sets(sets).pool_sizes(&sizes);
        // SAFETY: as above.
        self.pool = unsafe { device.create_descriptor_pool(&create, None) }.map_err(api)?;
        let allocate =
            vk::DescriptorSetAllocateInfo::default().descriptor_pool(self.pool).set_layouts(&self.set_layouts);
        // SAFETY: the pool has room for these sets.
        self.sets = unsafe { device.allocate_descriptor_sets(&allocate) }.map_err(api)?;
        for (about, buffer) in &self.buffers {
            // The canary is behind what is bound.
            let range = u64::from(about.bytes);
            let infos = [vk::DescriptorBufferInfo::default().buffer(buffer.handle).range(range)];
            let write = vk::WriteDescriptorSet::default()
                .dst_set(self.sets[about.group as usize])
                .dst_binding(about.binding)
                .descriptor_type(kind(about))
                .buffer_info(&infos);
            // SAFETY: set and buffer are alive, and no commands use the set yet.
            unsafe { device.update_descriptor_sets(&[write], &[]) };
        }
        Ok(())
    }

    fn compile(&mut self, words: &[u32]) -> Result<(), LaneError> {
        let device = &self.gpu.device;
        let create = vk::ShaderModuleCreateInfo::default().code(words);
        // SAFETY: the words come from a translator.
        let module = unsafe { device.create_shader_module(&create, None) }.map_err(api)?;
        let stage = vk::PipelineShaderStageCreateInfo::default().stage(vk::ShaderStageFlags::COMPUTE);
        let stage = stage.module(module).name(c"main");
        let create = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(self.pipeline_layout)];
        // SAFETY: all handles are of this device and alive, and what is pointed to lives until the call returns.
        let made = unsafe { device.create_compute_pipelines(vk::PipelineCache::null(), &create, None) };
        // SAFETY: a pipeline does without its module once it is made.
        unsafe { device.destroy_shader_module(module, None) };
        let failed = |(_, error)| LaneError::Api(format!("the creation of the compute pipeline: {error}"));
        self.pipeline = made.map_err(failed)?.first().copied().unwrap_or_default();
        Ok(())
    }

    /// One dispatch, with what the buffers hold.
    fn dispatch(&self) -> Result<(), LaneError> {
        let device = &self.gpu.device;
        self.gpu.submit(|commands| {
            let [x, y, z] = self.groups;
            let barrier = vk::MemoryBarrier::default()
                .src_access_mask(vk::AccessFlags::SHADER_WRITE)
                .dst_access_mask(vk::AccessFlags::HOST_READ);
            // SAFETY: commands are being recorded, and all handles are alive until `submit` returns.
            unsafe {
                let point = vk::PipelineBindPoint::COMPUTE;
                device.cmd_bind_pipeline(commands, point, self.pipeline);
                device.cmd_bind_descriptor_sets(commands, point, self.pipeline_layout, 0, &self.sets, &[]);
                device.cmd_dispatch(commands, x, y, z);
                let (from, to) = (vk::PipelineStageFlags::COMPUTE_SHADER, vk::PipelineStageFlags::HOST);
                device.cmd_pipeline_barrier(commands, from, to, vk::DependencyFlags::empty(), &[barrier], &[], &[]);
            }
        })
    }
}

/// Refuses what the device has no room for.
fn fits(gpu: &Gpu, groups: [u32; 3], size: [u32; 3], all: &[BoundBuffer]) -> Result<(), LaneError> {
    let limits = &gpu.limits;
    let of = |axis: usize| ["x", "y", "z"][axis];
    for axis in 0..3 {
        let most = limits.max_compute_work_group_count[axis];
        if groups[axis] > most {
            return unsupported(format!("{} workgroups along {}; the device has {most}", groups[axis], of(axis)));
        }
        let most = limits.max_compute_work_group_size[axis];
        if size[axis] > most {
            return unsupported(format!("{} invocations along {}; the device has {most}", size[axis], of(axis)));
        }
    }
    let (invocations, most) = (size.iter().product::<u32>(), limits.max_compute_work_group_invocations);
    if invocations > most {
        return unsupported(format!("a workgroup of {invocations} invocations; the device has {most}"));
    }
    for about in all {
        let most = if about.uniform { limits.max_uniform_buffer_range } else { limits.max_storage_buffer_range };
        if about.bytes > most {
            return unsupported(format!("a buffer of {} bytes; the device has {most}", about.bytes));
        }
    }
    Ok(())
}

/// The buffers where the translator bound them, by the names of their blocks.
///
/// # Errors
/// [`LaneError::Unsupported`] for a buffer that is no block of the module.
pub(super) fn bound(program: &Program, module: &[u32], all: &[BoundBuffer]) -> Result<Vec<BoundBuffer>, LaneError> {
    let reflection = Reflection::of(module);
    let one = |about: &BoundBuffer| {
        let name = buffers::block(program, about);
        let class = if about.uniform { StorageClass::Uniform } else { StorageClass::StorageBuffer };
        let own = |v: &Variable| reflection.block_of(*v).is_some_and(|ty| reflection.name(ty) == name);
        let Some(variable) = reflection.of_storage(class).find(own).filter(|_| !name.is_empty()) else {
            return unsupported(format!("the buffer `{name}`, which is no block of what glslang gives"));
        };
        if reflection.block_of(variable).is_some_and(|block| is_spread(&reflection, block)) {
            return unsupported(format!("a matrix of two rows in `{name}`, whose columns std140 lays 16 bytes apart"));
        }
        let of = |what| reflection.decoration(variable.id, what).unwrap_or(0);
        let (group, binding) = (of(Decoration::DescriptorSet), of(Decoration::Binding));
        Ok(BoundBuffer { group, binding, ..about.clone() })
    };
    all.iter().map(one).collect()
}

/// True for a structure with a matrix whose columns of two rows have gaps between them. The module from which buffers are
/// filled has no word for such a matrix.
fn is_spread(reflection: &Reflection, structure: u32) -> bool {
    let Some(Type::Struct(members)) = reflection.types.get(&structure) else { return false };
    members.iter().zip(0..).any(|(&member, k)| {
        let mut ty = member;
        while let Some(&Type::Array { element, .. }) = reflection.types.get(&ty) {
            ty = element;
        }
        match reflection.types.get(&ty) {
            Some(&Type::Matrix { column, .. }) => {
                let stride = reflection.member_decoration(structure, k, Decoration::MatrixStride);
                reflection.words(column) == 2 && stride.is_some_and(|stride| stride != 8)
            }
            Some(Type::Struct(_)) => is_spread(reflection, ty),
            _ => false,
        }
    })
}

/// Refuses a module with something that no buffer is bound to.
fn fed(reflection: &Reflection, all: &[BoundBuffer]) -> Result<(), LaneError> {
    let outside = [StorageClass::Input, StorageClass::Private, StorageClass::Workgroup].map(|class| class as u32);
    for variable in reflection.variables.iter().filter(|v| !outside.contains(&v.storage)) {
        let of = |what| reflection.decoration(variable.id, what).unwrap_or(0);
        let at = (of(Decoration::DescriptorSet), of(Decoration::Binding));
        if !all.iter().any(|about| (about.group, about.binding) == at) {
            return unsupported(format!(
                "the resource `{}`; buffers with a binding are fed",
                reflection.name(variable.id)
            ));
        }
    }
    Ok(())
}

impl Runner for DispatchRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = self.count_of(batch, "dispatches")?;
        let marks = Marks::random();
        let (size, header) = (self.layout.words(), self.layout.header_words());
        let mut words = vec![marks.sentinel; size * count];
        for (k, record) in words.chunks_exact_mut(size).enumerate() {
            for (about, buffer) in &mut self.buffers {
                buffers::before(about, batch, k, marks.sentinel, &mut buffer.words()[..buffers::words(about)]);
            }
            self.dispatch()?;
            // A dispatch that came back has run: its buffers hold what it left there.
            record[0] = marks.canary ^ k as u32;
            for (about, buffer) in &mut self.buffers {
                let content = &buffer.words()[..buffers::words(about)];
                buffers::after(about, content, marks.sentinel, &mut record[header..])?;
            }
        }
        Actual::accept(&self.layout, words, count, marks)
    }
}

impl Drop for DispatchRunner {
    fn drop(&mut self) {
        // SAFETY: the device is at rest and no command buffer that names these is left. Null handles are ignored.
        self.gpu.free(|device| unsafe {
            device.destroy_pipeline(self.pipeline, None);
            device.destroy_pipeline_layout(self.pipeline_layout, None);
            device.destroy_descriptor_pool(self.pool, None);
            self.set_layouts.iter().for_each(|&layout| device.destroy_descriptor_set_layout(layout, None));
        });
    }
}
