//! A Vulkan device that captures what vertex and geometry stages give, and memory that it shares with us.

#![expect(unsafe_code, reason = "Vulkan is a C interface")]

use std::cell::Cell;
use std::ffi::CStr;
use std::rc::Rc;

use ash::vk;

use crate::{LaneError, PATIENCE, vulkan};

/// A device with its queue.
pub(super) struct Gpu {
    /// Device, driver and version in a line, as the other lanes of the same device write it.
    pub driver: String,
    /// Name of the device.
    pub name: String,
    /// True when it has geometry stages.
    pub geometry: bool,
    pub limits: vk::PhysicalDeviceLimits,
    pub feedback_limits: vk::PhysicalDeviceTransformFeedbackPropertiesEXT<'static>,
    pub feedback: ash::ext::transform_feedback::Device,
    pub device: ash::Device,
    memory: vk::PhysicalDeviceMemoryProperties,
    queue: vk::Queue,
    pool: vk::CommandPool,
    /// True while the device works on something that does not end: nothing that it uses may be freed then.
    hung: Cell<bool>,
    instance: ash::Instance,
    /// The library of the loader, which everything above points into.
    _entry: ash::Entry,
}

fn failed(what: &'static str) -> impl Fn(vk::Result) -> String {
    move |error| format!("{what}: {error}")
}

impl Gpu {
    /// Opens the first device that captures by transform feedback; the error says what is missing.
    pub fn open() -> Result<Rc<Self>, String> {
        // SAFETY: the loader is a library whose initialisers do nothing but set it up, and it is kept in `_entry`.
        let entry = unsafe { ash::Entry::load() }.map_err(|_| "the Vulkan loader was not found".to_owned())?;
        let application =
            vk::ApplicationInfo::default().application_name(c"shadercheck").api_version(vk::API_VERSION_1_1);
        let create = vk::InstanceCreateInfo::default().application_info(&application);
        // SAFETY: the structure and what it points to live until the call returns.
        let instance = unsafe { entry.create_instance(&create, None) }.map_err(|error| match error {
            vk::Result::ERROR_INCOMPATIBLE_DRIVER => "no Vulkan driver was found".to_owned(),
            error => failed("Vulkan cannot be started")(error),
        })?;
        match Self::on(&instance) {
            Ok(opened) => Ok(Rc::new(opened.with(entry, instance))),
            Err(why) => {
                // SAFETY: nothing that was made with the instance is left.
                unsafe { instance.destroy_instance(None) };
                Err(why)
            }
        }
    }

    fn on(instance: &ash::Instance) -> Result<Opened, String> {
        // SAFETY: the instance is alive.
        let devices = unsafe { instance.enumerate_physical_devices() };
        let mut devices = devices.map_err(failed("Vulkan shows no device"))?;
        if devices.is_empty() {
            return Err("no Vulkan driver was found".to_owned());
        }
        let order = |physical: &vk::PhysicalDevice| {
            // SAFETY: the device is one of the instance.
            let properties = unsafe { instance.get_physical_device_properties(*physical) };
            let name = properties.device_name_as_c_str().unwrap_or_default().to_string_lossy();
            vulkan::order(properties.device_type == vk::PhysicalDeviceType::CPU, &name)
        };
        devices.sort_by_key(order);
        let mut why = "no Vulkan device here has VK_EXT_transform_feedback".to_owned();
        for physical in devices {
            match Opened::new(instance, physical) {
                Ok(Some(opened)) => return Ok(opened),
                Ok(None) => {}
                Err(error) => why = error,
            }
        }
        Err(why)
    }

    /// Runs commands and waits for their end.
    pub fn submit(&self, record: impl FnOnce(vk::CommandBuffer)) -> Result<(), LaneError> {
        let api = |error: vk::Result| LaneError::Api(error.to_string());
        if self.hung.get() {
            return Err(LaneError::Api("the device is still busy with a shader that does not end".to_owned()));
        }
        let allocate = vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(1);
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: pool and device are alive and used by one thread, for they are shared by `Rc`.
        let commands = unsafe { self.device.allocate_command_buffers(&allocate) }.map_err(api)?;
        // SAFETY: as above.
        let fence = unsafe { self.device.create_fence(&vk::FenceCreateInfo::default(), None) }.map_err(api)?;
        // SAFETY: the buffer is new.
        let result = unsafe { self.device.begin_command_buffer(commands[0], &begin) }.and_then(|()| {
            record(commands[0]);
            let submits = [vk::SubmitInfo::default().command_buffers(&commands)];
            // SAFETY: what was recorded refers to objects that the caller keeps until this function returns, or for
            // good when the device hangs.
            unsafe {
                self.device.end_command_buffer(commands[0])?;
                self.device.queue_submit(self.queue, &submits, fence)?;
                self.device.wait_for_fences(&[fence], true, PATIENCE.as_nanos() as u64)
            }
        });
        if result == Err(vk::Result::TIMEOUT) {
            self.hung.set(true);
            return Err(LaneError::Api(format!("the device did not finish within {} s", PATIENCE.as_secs())));
        }
        // SAFETY: the device has finished with both, or has never begun.
        unsafe {
            self.device.destroy_fence(fence, None);
            self.device.free_command_buffers(self.pool, &commands);
        }
        result.map_err(api)
    }

    /// Frees something of the device, unless the device may still use it.
    pub fn free(&self, free: impl FnOnce(&ash::Device)) {
        if !self.hung.get() {
            free(&self.device);
        }
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        if self.hung.get() {
            return;
        }
        // SAFETY: everything that was made with the device holds an `Rc` of it and is gone; no work is under way,
        // for `submit` waits. The instance goes after its device.
        unsafe {
            self.device.destroy_command_pool(self.pool, None);
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}

/// A device without the instance that it belongs to.
struct Opened {
    driver: String,
    name: String,
    geometry: bool,
    limits: vk::PhysicalDeviceLimits,
    feedback_limits: vk::PhysicalDeviceTransformFeedbackPropertiesEXT<'static>,
    feedback: ash::ext::transform_feedback::Device,
    device: ash::Device,
    memory: vk::PhysicalDeviceMemoryProperties,
    queue: vk::Queue,
    pool: vk::CommandPool,
}

impl Opened {
    /// Opens a physical device; `None` when it cannot capture.
    fn new(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Result<Option<Self>, String> {
        // SAFETY: the physical device is one of the instance, here and below.
        let extensions = unsafe { instance.enumerate_device_extension_properties(physical) };
        let extensions = extensions.map_err(failed("a Vulkan device does not tell its extensions"))?;
        let named = |name: &CStr| extensions.iter().any(|e| e.extension_name_as_c_str() == Ok(name));
        if !named(ash::ext::transform_feedback::NAME) {
            return Ok(None);
        }
        let mut drivers = vk::PhysicalDeviceDriverProperties::default();
        let mut feedback_limits = vk::PhysicalDeviceTransformFeedbackPropertiesEXT::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut feedback_limits);
        if named(ash::khr::driver_properties::NAME) {
            properties = properties.push_next(&mut drivers);
        }
        // SAFETY: the chain is made of structures that live here.
        unsafe { instance.get_physical_device_properties2(physical, &mut properties) };
        let properties = properties.properties;
        if properties.api_version < vk::API_VERSION_1_1 {
            return Ok(None);
        }
        let mut feedback = vk::PhysicalDeviceTransformFeedbackFeaturesEXT::default();
        let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut feedback);
        // SAFETY: as above.
        unsafe { instance.get_physical_device_features2(physical, &mut features) };
        let has = features.features;
        if feedback.transform_feedback == vk::FALSE || feedback_limits.transform_feedback_queries == vk::FALSE {
            return Ok(None);
        }
        // SAFETY: as above.
        let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
        let Some(family) = families.iter().position(|f| f.queue_flags.contains(vk::QueueFlags::GRAPHICS)) else {
            return Ok(None);
        };
        let priorities = [1.0];
        let queues =
            [vk::DeviceQueueCreateInfo::default().queue_family_index(family as u32).queue_priorities(&priorities)];
        let enabled = vk::PhysicalDeviceFeatures::default()
            .geometry_shader(has.geometry_shader == vk::TRUE)
            .shader_tessellation_and_geometry_point_size(has.shader_tessellation_and_geometry_point_size == vk::TRUE)
            .shader_clip_distance(has.shader_clip_distance == vk::TRUE);
        let mut feedback = vk::PhysicalDeviceTransformFeedbackFeaturesEXT::default().transform_feedback(true);
        let names = [ash::ext::transform_feedback::NAME.as_ptr()];
        let create = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&names)
            .enabled_features(&enabled)
            .push_next(&mut feedback);
        // SAFETY: what is asked for was just found to be there, and the structures live until the call returns.
        let device = unsafe { instance.create_device(physical, &create, None) };
        let device = device.map_err(failed("the Vulkan device cannot be opened"))?;
        let create = vk::CommandPoolCreateInfo::default().queue_family_index(family as u32);
        // SAFETY: the family is the one of the device's queue.
        let pool = match unsafe { device.create_command_pool(&create, None) } {
            Ok(pool) => pool,
            Err(error) => {
                // SAFETY: nothing was made with the device.
                unsafe { device.destroy_device(None) };
                return Err(failed("the Vulkan device takes no commands")(error));
            }
        };
        let text = |name: Result<&CStr, _>| name.map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let name = text(properties.device_name_as_c_str());
        let parts = [name.clone(), text(drivers.driver_name_as_c_str()), text(drivers.driver_info_as_c_str())];
        let parts: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        feedback_limits.p_next = std::ptr::null_mut();
        Ok(Some(Self {
            driver: parts.join(", "),
            name,
            geometry: has.geometry_shader == vk::TRUE,
            limits: properties.limits,
            feedback_limits: plain(feedback_limits),
            feedback: ash::ext::transform_feedback::Device::new(instance, &device),
            // SAFETY: the queue was asked for above.
            queue: unsafe { device.get_device_queue(family as u32, 0) },
            // SAFETY: the physical device is one of the instance.
            memory: unsafe { instance.get_physical_device_memory_properties(physical) },
            device,
            pool,
        }))
    }

    fn with(self, entry: ash::Entry, instance: ash::Instance) -> Gpu {
        let Self { driver, name, geometry, limits, feedback_limits, feedback, device, memory, queue, pool } = self;
        Gpu {
            driver,
            name,
            geometry,
            limits,
            feedback_limits,
            feedback,
            device,
            memory,
            queue,
            pool,
            hung: Cell::new(false),
            instance,
            _entry: entry,
        }
    }
}

/// The numbers of a structure, without the chain that it was part of.
fn plain(
    from: vk::PhysicalDeviceTransformFeedbackPropertiesEXT<'_>,
) -> vk::PhysicalDeviceTransformFeedbackPropertiesEXT<'static> {
    vk::PhysicalDeviceTransformFeedbackPropertiesEXT::default()
        .max_transform_feedback_buffer_size(from.max_transform_feedback_buffer_size)
        .max_transform_feedback_stream_data_size(from.max_transform_feedback_stream_data_size)
        .max_transform_feedback_buffer_data_size(from.max_transform_feedback_buffer_data_size)
        .max_transform_feedback_buffer_data_stride(from.max_transform_feedback_buffer_data_stride)
}

/// A buffer in memory that both sides see.
pub(super) struct GpuBuffer {
    gpu: Rc<Gpu>,
    pub handle: vk::Buffer,
    memory: vk::DeviceMemory,
    at: *mut u32,
    words: usize,
}

impl GpuBuffer {
    /// A buffer of so many words, at least four.
    pub fn new(gpu: &Rc<Gpu>, words: usize, usage: vk::BufferUsageFlags) -> Result<Self, LaneError> {
        let api = |error: vk::Result| LaneError::Api(error.to_string());
        let words = words.max(4);
        let create = vk::BufferCreateInfo::default().size(4 * words as u64).usage(usage);
        // SAFETY: the device is alive.
        let handle = unsafe { gpu.device.create_buffer(&create, None) }.map_err(api)?;
        let mut this =
            Self { gpu: gpu.clone(), handle, memory: vk::DeviceMemory::null(), at: std::ptr::null_mut(), words };
        // SAFETY: the buffer was made with this device.
        let needs = unsafe { gpu.device.get_buffer_memory_requirements(handle) };
        let wanted = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let types = &gpu.memory.memory_types[..gpu.memory.memory_type_count as usize];
        let fits = |flags: vk::MemoryPropertyFlags| {
            let fit = |(k, ty): &(u32, &vk::MemoryType)| {
                needs.memory_type_bits >> k & 1 == 1 && ty.property_flags.contains(flags)
            };
            (0..).zip(types).find(fit).map(|(k, _)| k)
        };
        // What is read back is read faster from memory that the processor caches.
        let index = fits(wanted | vk::MemoryPropertyFlags::HOST_CACHED).or_else(|| fits(wanted));
        let index = index.ok_or_else(|| LaneError::Api("the device shares no memory for buffers".to_owned()))?;
        let allocate = vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(index);
        // SAFETY: size and type are those that the device asked for. The memory is mapped once and as long as it is
        // there; it has room for `words` words, for the buffer has.
        unsafe {
            this.memory = gpu.device.allocate_memory(&allocate, None).map_err(api)?;
            gpu.device.bind_buffer_memory(handle, this.memory, 0).map_err(api)?;
            this.at =
                gpu.device.map_memory(this.memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty()).map_err(api)?.cast();
        }
        Ok(this)
    }

    /// The contents; the device is at rest while they are looked at, for [`Gpu::submit`] waits.
    pub fn words(&mut self) -> &mut [u32] {
        // SAFETY: the memory is mapped, aligned to more than a word, has `words` words, and is borrowed by this
        // buffer alone; after a device that hangs, `submit` gives an error and nobody reads.
        unsafe { std::slice::from_raw_parts_mut(self.at, self.words) }
    }
}

impl Drop for GpuBuffer {
    fn drop(&mut self) {
        // SAFETY: the device is at rest and no command buffer that names the buffer is left. Null handles are ignored.
        self.gpu.free(|device| unsafe {
            device.destroy_buffer(self.handle, None);
            device.free_memory(self.memory, None);
        });
    }
}
