//! What the two sides say to each other. The script has the same names.

use serde::{Deserialize, Serialize};

/// What the script is asked.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Ask {
    /// For a device, with the package in this folder.
    Open { folder: String },
    /// To make a kernel ready. The texels of its textures come behind.
    Prepare(Box<Job>),
    /// To run a kernel. The words of its inputs come behind, each as long as it says.
    Run { id: u64, run: u64, count: usize, per_case: usize, canary: u32, lengths: Vec<usize> },
    /// To forget a kernel.
    Drop { id: u64 },
}

/// A kernel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Its number.
    pub id: u64,
    /// The text in WGSL.
    pub code: String,
    /// Name of the entry point.
    pub entry: String,
    /// Most invocations of a run.
    pub capacity: usize,
    /// Invocations of a workgroup.
    pub workgroup: u32,
    /// Words of an output record.
    pub record: usize,
    /// What outputs hold before they are written.
    pub sentinel: u32,
    /// For a dispatch for each invocation, words from one uniform block to the next; else 0.
    pub stride: usize,
    /// Buffers that are read.
    pub inputs: Vec<Input>,
    /// Textures that the shader samples, with where they are bound.
    pub textures: Vec<Bound>,
    /// For whole dispatches of a compute stage, how each is made; `record` is then what is read back of each.
    pub dispatch: Option<Dispatching>,
}

/// A dispatch.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Dispatching {
    /// Workgroups along x, y and z.
    pub groups: [u32; 3],
    /// Its buffers, in the order in which their words come.
    pub buffers: Vec<Storage>,
}

/// A buffer of a dispatch.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Storage {
    /// Its group.
    pub group: u32,
    /// Its binding in the group.
    pub binding: u32,
    /// Bytes that are bound.
    pub bytes: u32,
    /// Words of the buffer, with the canary behind what is bound.
    pub words: usize,
    /// True for a uniform buffer.
    pub uniform: bool,
    /// True for a storage buffer that the shader may write.
    pub writable: bool,
    /// True where it is read back.
    pub read: bool,
}

/// A buffer that is read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Its binding in group 0.
    pub binding: u32,
    /// Words for each invocation, or of a uniform block.
    pub words: usize,
    /// True for the uniform block of one invocation.
    pub dynamic: bool,
}

/// A texture, with names of the API.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Bound {
    /// Binding of the image in the group of textures.
    pub image: u32,
    /// Binding of the sampler.
    pub sampler: Option<u32>,
    /// Dimension of the texture: `2d`.
    pub dimension: String,
    /// Dimension of the view: `cube-array`.
    pub view: String,
    /// What a texel holds: `float`, `sint`, `uint` or `depth`.
    pub texel: String,
    /// Width, height, and depth or layers.
    pub size: [u32; 3],
}

/// What the script answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// The device.
    Opened(Box<Adapter>),
    /// There is none.
    Missing { why: String, driver: bool },
    /// The kernel is ready.
    Ready { id: u64 },
    /// It is refused: by Tint at a place of the text, or by Dawn, without one.
    Refused { id: u64, line: usize, column: usize, why: String },
    /// What the kernel wrote; its words come behind.
    Done { run: u64 },
    /// The run failed.
    Failed { run: u64, why: String },
}

/// What Dawn says of its device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adapter {
    /// Whose it is.
    pub vendor: String,
    /// Its family.
    pub architecture: String,
    /// The device, in small letters and hyphens.
    pub device: String,
    /// The driver.
    pub description: String,
    /// Version of the package.
    pub version: String,
    /// What it can do.
    pub limits: Limits,
}

/// Limits, by the names that the API has.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Limits {
    pub max_storage_buffer_binding_size: u64,
    pub max_buffer_size: u64,
    pub max_compute_workgroups_per_dimension: u64,
    pub max_uniform_buffer_binding_size: u64,
    pub min_uniform_buffer_offset_alignment: u64,
}

/// Why there is no device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Missing {
    /// The process does not run.
    Process(String),
    /// The package is not what it should be.
    Package(String),
    /// Dawn takes no driver.
    Driver(String),
}
