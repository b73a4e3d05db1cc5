//! The `vulkan` lanes: every device that the Vulkan loader shows, through wgpu, in the compute and in the vertex stage.

mod compute;
mod dispatch;
mod gpu;
mod texture;
mod uniforms;
mod vertex;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use super::remote::{self, Engine, Front, Here, Work};
use super::{
    Api, Candidate, Description, Lane, LaneError, LaneName, Runner, Stage, Unavailable, check_asked, interned, worker,
};
use base::text::printable;
use base::value::Record;
use program::{Form, Kernel, OutputLayout, Texture, contain};

use gpu::Gpu;

/// What to do when no driver is found.
pub(super) const REMEDY: &str =
    "install one, for example `apt-get install mesa-vulkan-drivers libvulkan1` on Debian or Ubuntu";

/// How there come to be more lanes of Vulkan devices.
pub const MORE: &str = "every driver that the Vulkan loader finds is a lane; SwiftShader, for one, comes with Debian's \
     package chromium-common and is found with VK_ADD_DRIVER_FILES=/usr/lib/chromium/vk_swiftshader_icd.json";

/// Executor of SwiftShader's lane.
pub const SWIFTSHADER: &str = "subzero";

/// Name of the lane of the first device.
const FIRST: &str = "vulkan";

/// The lanes of Vulkan devices: `vulkan` for the first that the loader shows, and `vulkan-` with the name of the device
/// for each further one. Each runs in a process of its own where there is a program for that, and so does the search.
pub fn candidates() -> Vec<Candidate> {
    let mut all = match worker::program() {
        None => here(),
        Some(program) => match remote::devices(program) {
            Ok(away) => away,
            Err(why) => vec![absent(why)],
        },
    };
    if all.is_empty() {
        all.push(absent("no Vulkan driver was found".to_owned()));
    }
    all
}

/// The lanes of devices in this process.
fn here() -> Vec<Candidate> {
    let candidate = |device: Device| Candidate {
        name: device.name,
        about: about(device.first),
        open: Box::new(move || Ok(Box::new(Here::new((device.open)()?, Box::new(Naga))))),
        stand_in: false,
        named_only: false,
        extra: false,
    };
    match devices() {
        Ok(devices) => devices.into_iter().map(candidate).collect(),
        Err(why) => vec![absent(why)],
    }
}

/// What a lane of a device is.
pub(super) fn about(first: bool) -> &'static str {
    if first { "the first Vulkan device, through wgpu" } else { "a Vulkan device, through wgpu" }
}

/// Opens an engine.
type Open = Box<dyn Fn() -> Result<Box<dyn Engine>, Unavailable> + Send + Sync>;

/// A device that is found in this process.
pub struct Device {
    /// Name of its lane.
    pub name: LaneName,
    /// True for the first.
    pub first: bool,
    /// Makes a device of its own; says what is missing where that fails.
    pub open: Open,
}

/// The devices that the Vulkan loader shows in this process.
///
/// # Errors
/// What is wrong with a driver that brings wgpu to panic: that is a missing lane, not the end of the run.
pub fn devices() -> Result<Vec<Device>, String> {
    let adapters = contain(gpu::adapters).map_err(|panic| format!("the Vulkan driver fails: {panic}"))?;
    let mut names: Vec<String> = Vec::new();
    let mut all = Vec::new();
    for adapter in adapters {
        let name = unique(&names, &adapter.get_info().name);
        let known = interned(&name);
        names.push(name);
        let open = Box::new(move || open_adapter(known, &adapter));
        all.push(Device { name: known, first: all.is_empty(), open });
    }
    Ok(all)
}

/// The lane of a driver that is not there.
fn absent(why: String) -> Candidate {
    let missing = Unavailable { why, remedy: REMEDY.to_owned() };
    let about = "any Vulkan device, through wgpu";
    Candidate {
        name: FIRST,
        about,
        open: Box::new(move || Err(missing.clone())),
        stand_in: false,
        named_only: false,
        extra: false,
    }
}

/// A name for the lane of a device that no other lane has.
fn unique(names: &[String], device: &str) -> String {
    if names.is_empty() {
        return FIRST.to_owned();
    }
    let slug = format!("{FIRST}-{}", slug(device));
    let numbered = (2..).map(|k| format!("{slug}-{k}"));
    std::iter::once(slug.clone()).chain(numbered).find(|name| !names.contains(name)).unwrap_or(slug)
}

/// The name of a device in small letters, digits and hyphens, without what stands in parentheses.
fn slug(device: &str) -> String {
    let short = device.split(['(', ',']).next().unwrap_or(device).to_lowercase();
    let letters: String = short.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { ' ' }).collect();
    let words: Vec<&str> = letters.split_whitespace().filter(|word| *word != "device").collect();
    // A name of a lane has at most 64 letters.
    let slug: String = words.join("-").chars().take(40).collect();
    if slug.is_empty() { "unnamed".to_owned() } else { slug }
}

/// Where a device stands among others: real ones come first, and among drivers for the processor Mesa's. The loader's
/// own order turns round when a driver is added.
pub(super) fn order(processor: bool, device: &str) -> (bool, bool) {
    (processor, processor && !device.to_lowercase().contains("llvmpipe"))
}

/// What executes shaders on a device: Mesa's drivers for processors share one compiler, whatever API they are reached
/// through.
pub(super) fn executor(device: &str) -> String {
    let name = device.to_lowercase();
    match () {
        () if name.contains("llvmpipe") => "gallivm".to_owned(),
        () if name.contains("swiftshader") => SWIFTSHADER.to_owned(),
        () => printable(device),
    }
}

/// Opens the first Vulkan device that the loader shows.
///
/// # Errors
/// [`Unavailable`] with the command that installs a software driver.
pub fn open() -> Result<Box<dyn Lane>, Unavailable> {
    candidates().first().map_or_else(|| (absent(String::new()).open)(), |first| (first.open)())
}

fn open_adapter(name: LaneName, adapter: &wgpu::Adapter) -> Result<Box<dyn Engine>, Unavailable> {
    let missing = |why: String| Unavailable { why, remedy: REMEDY.to_owned() };
    let gpu = contain(|| Gpu::open(adapter)).map_err(|panic| missing(format!("the Vulkan driver fails: {panic}")))?;
    let gpu = gpu.map_err(missing)?;
    let description = Description {
        name,
        driver: printable(&gpu.driver()),
        executor: executor(gpu.name()),
        front_end: "naga".to_owned(),
        api: Api::Vulkan,
        stages: gpu.stages(),
    };
    Ok(Box::new(Vulkan { gpu, description }))
}

struct Vulkan {
    gpu: Gpu,
    description: Description,
}

impl Engine for Vulkan {
    fn description(&self) -> &Description {
        &self.description
    }

    fn prepare(&self, work: &Work, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        let Work::Wgpu(job) = work else { return Err(LaneError::Api("work of another lane".to_owned())) };
        match &job.form {
            Form::Uniforms => Ok(Box::new(uniforms::UniformsRunner::new(&self.gpu, job, capacity)?)),
            Form::Compute | Form::Constants => Ok(Box::new(compute::ComputeRunner::new(&self.gpu, job, capacity)?)),
            Form::Vertex { .. } if !self.description.stages.contains(&Stage::Vertex) => {
                Err(LaneError::Unsupported("this device cannot write storage buffers in the vertex stage".to_owned()))
            }
            Form::Dispatch { groups, buffers } => {
                Ok(Box::new(dispatch::DispatchRunner::new(&self.gpu, job, *groups, buffers, capacity)?))
            }
            Form::Geometry => Err(LaneError::Unsupported("geometry stages; they run as compute".to_owned())),
            Form::Vertex { attributes, blocks, drawn } => {
                Ok(Box::new(vertex::VertexRunner::new(&self.gpu, job, (attributes, blocks, drawn), capacity)?))
            }
        }
    }
}

/// A kernel without the program that it was made of: what a device has to know.
#[derive(Clone, Debug)]
pub struct Job {
    /// The shader with outputs captured, as naga has it.
    pub module: naga::Module,
    /// How it runs.
    pub form: Form,
    /// What one invocation gets.
    pub invocation: Arc<Record>,
    /// What one case gets.
    pub case: Arc<Record>,
    /// What one invocation writes.
    pub output: OutputLayout,
    /// What samplers of the module are bound to.
    pub textures: Vec<Texture>,
}

/// Gives modules of naga as they are.
pub(super) struct Naga;

impl Front for Naga {
    fn dispatches(&self) -> bool {
        true
    }

    fn work(&self, kernel: &Kernel) -> Result<Work, LaneError> {
        check_asked(kernel)?;
        if matches!(kernel.form, Form::Geometry) {
            return Err(LaneError::Unsupported("geometry stages; they run as compute".to_owned()));
        }
        Ok(Work::Wgpu(Box::new(Job {
            module: kernel.module.clone(),
            form: kernel.form.clone(),
            invocation: kernel.invocation.clone(),
            case: kernel.case.clone(),
            output: kernel.output.clone(),
            textures: kernel.program.textures.clone(),
        })))
    }
}

#[cfg(test)]
mod names {
    use super::{executor, order, unique};

    #[test]
    fn every_device_has_a_name_of_its_own() {
        let mut names = Vec::new();
        for (device, expected) in [
            ("llvmpipe (LLVM 15.0.6, 256 bits)", "vulkan"),
            ("SwiftShader Device (Subzero)", "vulkan-swiftshader"),
            ("NVIDIA GeForce RTX 4090", "vulkan-nvidia-geforce-rtx-4090"),
            ("llvmpipe (LLVM 19.1.7, 256 bits)", "vulkan-llvmpipe"),
            ("llvmpipe (LLVM 19.1.7, 256 bits)", "vulkan-llvmpipe-2"),
            ("Intel(R) Graphics", "vulkan-intel"),
            ("\u{30c7}\u{30d0}\u{30a4}\u{30b9}", "vulkan-unnamed"),
        ] {
            let name = unique(&names, device);
            assert_eq!(name, expected);
            names.push(name);
        }
    }

    #[test]
    fn a_driver_that_is_added_takes_no_name_from_another_one() {
        let mut devices =
            [(true, "SwiftShader Device (Subzero)"), (true, "llvmpipe (LLVM 15.0.6)"), (false, "NVIDIA H100")];
        devices.sort_by_key(|&(processor, device)| order(processor, device));
        assert_eq!(devices.map(|(_, device)| &device[..4]), ["NVID", "llvm", "Swif"]);
    }

    #[test]
    fn executors_are_known_by_their_compiler() {
        assert_eq!(executor("llvmpipe (LLVM 15.0.6, 256 bits)"), "gallivm");
        assert_eq!(executor("SwiftShader Device (Subzero)"), "subzero");
        assert_eq!(executor("NVIDIA H100"), "NVIDIA H100");
    }
}
