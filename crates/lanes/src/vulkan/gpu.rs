//! Device, buffers and error scopes.

use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::{Actual, LaneError, Marks, PATIENCE, Stage};
use program::OutputLayout;

use super::Job;

/// A device with its queue. Cheap to clone.
#[derive(Clone)]
pub(super) struct Gpu {
    info: wgpu::AdapterInfo,
    /// True once it works on something that does not end.
    hung: Arc<AtomicBool>,
    /// How the device was lost, and at what.
    lost: Arc<Mutex<Lost>>,
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
}

/// What a device does, and how it was lost.
#[derive(Default)]
struct Lost {
    /// The call that is under way, in words.
    doing: Option<&'static str>,
    /// What was lost at which call.
    how: Option<String>,
}

/// The devices that the Vulkan loader shows, in the order of [`super::order`].
pub(super) fn adapters() -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    // Debug layers and markers cost time and print; what is validated is validated by wgpu itself.
    descriptor.flags = wgpu::InstanceFlags::empty();
    let found = wgpu::Instance::new(descriptor).enumerate_adapters(wgpu::Backends::VULKAN);
    let mut found = pollster::block_on(found);
    found.sort_by_key(|adapter| {
        let info = adapter.get_info();
        super::order(info.device_type == wgpu::DeviceType::Cpu, &info.name)
    });
    found
}

impl Gpu {
    /// Opens a device; the error says what is missing.
    pub fn open(adapter: &wgpu::Adapter) -> Result<Self, String> {
        let wanted = wgpu::Features::VERTEX_WRITABLE_STORAGE;
        let description = wgpu::DeviceDescriptor {
            label: Some("shadercheck"),
            required_features: adapter.features() & wanted,
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&description))
            .map_err(|e| format!("the Vulkan device cannot be opened: {e}"))?;
        let lost: Arc<Mutex<Lost>> = Arc::default();
        let noted = lost.clone();
        device.set_device_lost_callback(move |reason, message| {
            // A device that is dropped is no loss.
            if reason == wgpu::DeviceLostReason::Unknown {
                let mut lost = noted.lock().unwrap_or_else(PoisonError::into_inner);
                let at = lost.doing.map_or_else(String::new, |doing| format!("{doing}: "));
                lost.how.get_or_insert_with(|| format!("{at}{message}; the device is lost from there on"));
            }
        });
        Ok(Self { info: adapter.get_info(), hung: Arc::default(), lost, device, queue })
    }

    /// Device, driver and version in a line.
    pub fn driver(&self) -> String {
        let info = &self.info;
        let parts = [info.name.as_str(), info.driver.as_str(), info.driver_info.as_str()];
        let parts: Vec<&str> = parts.into_iter().filter(|p| !p.is_empty()).collect();
        parts.join(", ")
    }

    /// Name of the device.
    pub fn name(&self) -> &str {
        &self.info.name
    }

    /// Stages in which this device can write storage.
    pub fn stages(&self) -> Vec<Stage> {
        let vertex = self.device.features().contains(wgpu::Features::VERTEX_WRITABLE_STORAGE);
        if vertex { vec![Stage::Compute, Stage::Vertex] } else { vec![Stage::Compute] }
    }

    /// Leaves a device alone that works on something that does not end. It is never freed: that would wait as well.
    pub fn give_up(&self) -> LaneError {
        if !self.hung.swap(true, Ordering::Relaxed) {
            std::mem::forget(self.clone());
        }
        LaneError::Api(format!("the device did not finish within {} s", PATIENCE.as_secs()))
    }

    /// Runs a call of the driver; where the device is lost at it, that is said in these words.
    pub fn at<T>(&self, call: &'static str, work: impl FnOnce() -> T) -> T {
        let doing = |doing| self.lost.lock().unwrap_or_else(PoisonError::into_inner).doing = doing;
        doing(Some(call));
        let value = work();
        doing(None);
        value
    }

    /// How the device was lost, if it was: what fails behind that fails because of it.
    fn loss(&self) -> Option<LaneError> {
        let lost = self.lost.lock().unwrap_or_else(PoisonError::into_inner);
        lost.how.clone().map(LaneError::Api)
    }

    /// Runs `work` and gives the API error that it caused, if any.
    pub fn checked<T>(&self, work: impl FnOnce() -> T) -> Result<T, LaneError> {
        if self.hung.load(Ordering::Relaxed) {
            return Err(LaneError::Api("the device is still busy with a shader that does not end".to_owned()));
        }
        let scopes = [wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation]
            .map(|filter| self.device.push_error_scope(filter));
        let value = work();
        // Scopes are a stack: the last one opened is popped first, and all of them are, whatever they say. Where a call fails in
        // the driver or for want of memory, what it should have made is invalid for the calls behind it: they say less.
        let errors: Vec<_> = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop())).collect();
        match (self.loss(), errors.last()) {
            (Some(loss), _) => Err(loss),
            (None, Some(error)) => Err(LaneError::Api(error.to_string())),
            (None, None) => Ok(value),
        }
    }

    pub fn shader(&self, job: &Job) -> wgpu::ShaderModule {
        self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Naga(Cow::Owned(job.module.clone())),
        })
    }

    /// A buffer of at least 16 bytes: bindings must not be empty.
    pub fn buffer(&self, bytes: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let size = bytes.max(16).next_multiple_of(4);
        self.device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    }

    /// Most words that one storage buffer can hold.
    pub fn storage_words(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) / 4
    }
}

/// The output buffer of a kernel with what is needed to fill it with the sentinel and to read it.
pub(super) struct GpuOutputs {
    gpu: Gpu,
    layout: OutputLayout,
    pub storage: wgpu::Buffer,
    pub params: wgpu::Buffer,
    blank: wgpu::Buffer,
    readback: wgpu::Buffer,
    sentinel: u32,
    spare: Vec<u32>,
}

impl GpuOutputs {
    pub fn new(gpu: &Gpu, layout: &OutputLayout, capacity: usize) -> Self {
        use wgpu::BufferUsages as Usage;
        let bytes = 4 * (layout.words() * capacity) as u64;
        // The sentinel is random for each runner; the canary is random for each dispatch.
        let sentinel = Marks::random().sentinel;
        let blank = gpu.buffer(bytes, Usage::COPY_SRC | Usage::COPY_DST);
        let words = vec![sentinel; (bytes / 4) as usize];
        gpu.queue.write_buffer(&blank, 0, as_bytes(&words));
        Self {
            storage: gpu.buffer(bytes, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST),
            readback: gpu.buffer(bytes, Usage::MAP_READ | Usage::COPY_DST),
            params: gpu.buffer(16, Usage::UNIFORM | Usage::COPY_DST),
            gpu: gpu.clone(),
            layout: layout.clone(),
            blank,
            sentinel,
            spare: words,
        }
    }

    /// Uploads the parameters of a dispatch of `count` invocations and fills the outputs with the
    /// sentinel.
    pub fn begin(&self, encoder: &mut wgpu::CommandEncoder, count: usize, per_case: usize) -> Marks {
        let marks = Marks { sentinel: self.sentinel, ..Marks::random() };
        let params = [count as u32, per_case as u32, marks.canary, marks.sentinel];
        self.gpu.queue.write_buffer(&self.params, 0, as_bytes(&params));
        encoder.copy_buffer_to_buffer(&self.blank, 0, &self.storage, 0, Some(self.bytes(count)));
        marks
    }

    fn bytes(&self, count: usize) -> u64 {
        4 * (self.layout.words() * count) as u64
    }

    /// Copies the outputs back, waits and takes them.
    pub fn finish(
        &mut self,
        mut encoder: wgpu::CommandEncoder,
        count: usize,
        marks: Marks,
    ) -> Result<Actual, LaneError> {
        let bytes = self.bytes(count);
        encoder.copy_buffer_to_buffer(&self.storage, 0, &self.readback, 0, Some(bytes));
        self.gpu.at("the submission of the work", || self.gpu.queue.submit([encoder.finish()]));
        let slice = self.readback.slice(..bytes);
        let (send, receive) = std::sync::mpsc::channel();
        slice.map_async(wgpu::MapMode::Read, move |result| {
            // The receiver waits below; a send cannot fail before.
            let _ = send.send(result);
        });
        let api = |e: &dyn std::fmt::Display| LaneError::Api(e.to_string());
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(PATIENCE) };
        match self.gpu.device.poll(wait) {
            Ok(_) => {}
            Err(wgpu::PollError::Timeout) => return Err(self.gpu.give_up()),
            Err(error) => return Err(api(&error)),
        }
        receive.recv().map_err(|e| api(&e))?.map_err(|e| api(&e))?;
        let mut words = std::mem::take(&mut self.spare);
        {
            let view = slice.get_mapped_range().map_err(|e| api(&e))?;
            words.resize(view.len() / 4, 0);
            bytemuck::cast_slice_mut(&mut words).copy_from_slice(&view);
        }
        self.readback.unmap();
        Actual::accept(&self.layout, words, count, marks)
    }
}

/// The bytes of words, in the byte order of the device.
pub(super) fn as_bytes(words: &[u32]) -> &[u8] {
    bytemuck::cast_slice(words)
}
