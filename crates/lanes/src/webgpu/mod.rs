//! The lane `webgpu`: the compute kernel as WGSL, through Tint, on a device of Dawn. Both come with the package `webgpu`
//! of npm, so that the other side is a script that Node runs ([`worker`](super::worker)).
//!
//! Tint reads the text that naga writes of the module: what it refuses, and what it takes in another sense, shows here.
//! Of a shader in WGSL it reads the author's own text.
//!
//! Dawn is reached through Node because it comes as a package there and needs no build.

mod dispatch;
mod messages;
mod remote;
mod runner;

#[cfg(test)]
mod tests;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::worker::{Program, Worker};
use super::{Api, Candidate, Description, Lane, LaneError, Runner, Stage, Unavailable, check_asked, vulkan};
use base::text::printable;
use program::{Form, Kernel, Program as Shader};

use messages::{Adapter, Missing};
use remote::Remote;

/// Name of the lane.
pub const NAME: &str = "webgpu";

/// Name of the program that runs the script.
const NODE: &str = "node";

const PEER: &str = include_str!("peer.mjs");

static FOLDER: OnceLock<Option<PathBuf>> = OnceLock::new();

/// States where the package `webgpu` is, once; whoever has a working directory knows. `None` where it is not.
pub fn set_folder(folder: Option<PathBuf>) {
    // The first one counts.
    let _ = FOLDER.set(folder);
}

/// The lane, whether or not it is available.
pub fn candidates() -> Vec<Candidate> {
    let about = "Dawn and Tint through Node: WGSL on a Vulkan device that Dawn takes";
    vec![Candidate { name: NAME, about, open: Box::new(open), stand_in: false, named_only: false, extra: true }]
}

fn open() -> Result<Box<dyn Lane>, Unavailable> {
    match FOLDER.get() {
        None => Err(Unavailable {
            why: "the package `webgpu` is looked for by the program alone".to_owned(),
            remedy: "run the program `shadercheck`".to_owned(),
        }),
        Some(None) => Err(Unavailable {
            why: "there is no package `webgpu` in a `node_modules` of this folder or of one above, nor in NODE_PATH"
                .to_owned(),
            remedy: "run `npm install webgpu` in this folder; it needs Node.js".to_owned(),
        }),
        Some(Some(folder)) => open_at(folder, &node()),
    }
}

/// Node with the script.
fn node() -> Program {
    let arguments = ["--input-type=module", "-e", PEER].map(OsString::from).to_vec();
    Program { path: NODE.into(), arguments }
}

fn open_at(folder: &Path, program: &Program) -> Result<Box<dyn Lane>, Unavailable> {
    let remote = Remote::open(Box::new(Worker::new(program, &[])), folder).map_err(unavailable)?;
    let description = describe(&remote.adapter);
    Ok(Box::new(WebGpu { remote, description }))
}

fn unavailable(missing: Missing) -> Unavailable {
    let (why, remedy) = match missing {
        Missing::Process(why) => (why, "install Node.js, for example `apt-get install nodejs npm` on Debian or Ubuntu"),
        Missing::Package(why) => (why, "run `npm install webgpu` once more"),
        Missing::Driver(why) => (
            why,
            "give it one: SwiftShader is in Debian's package chromium-common and is found with \
             VK_ADD_DRIVER_FILES=/usr/lib/chromium/vk_swiftshader_icd.json; Mesa's lavapipe is taken from Mesa 25 on",
        ),
    };
    Unavailable { why, remedy: remedy.to_owned() }
}

/// What the lane is, by what Dawn says of its device.
fn describe(adapter: &Adapter) -> Description {
    let device = device(&adapter.device);
    let parts = [device.as_str(), adapter.description.as_str()];
    let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    Description {
        name: NAME,
        driver: printable(&format!("{}, Dawn of webgpu {}", parts.join(", "), adapter.version)),
        executor: vulkan::executor(&device),
        front_end: "Tint".to_owned(),
        api: Api::WebGpu,
        stages: vec![Stage::Compute],
    }
}

/// The name of a device as its driver has it: Dawn makes small letters and hyphens of everything.
fn device(name: &str) -> String {
    if let Some(compiler) = name.strip_prefix("swiftshader-device-") {
        let compiler = compiler.trim_end_matches('-');
        let (first, rest) = compiler.split_at_checked(1).unwrap_or_default();
        return format!("SwiftShader Device ({}{rest})", first.to_uppercase());
    }
    match name.split_once('-') {
        Some(("llvmpipe", _)) => "llvmpipe".to_owned(),
        _ => name.to_owned(),
    }
}

struct WebGpu {
    remote: Remote,
    description: Description,
}

impl Lane for WebGpu {
    fn description(&self) -> &Description {
        &self.description
    }

    fn dispatches(&self) -> bool {
        true
    }

    fn front_end(&self, program: &Shader) -> String {
        // Elsewhere it reads what naga writes, and shares naga's reading of the author's text.
        let own = dispatch::reads_author(program) || program.author_kernel().is_some();
        if own {
            format!("{} on the author's WGSL", self.description.front_end)
        } else {
            self.description.front_end.clone()
        }
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        check_asked(kernel)?;
        let unsupported = |what: &str| Err(LaneError::Unsupported(what.to_owned()));
        match kernel.form {
            Form::Compute | Form::Uniforms => {}
            Form::Constants => return unsupported("inputs as constants: WGSL has no literal for NaN and infinities"),
            Form::Vertex { .. } => return unsupported("WebGPU writes no storage in the vertex stage"),
            Form::Dispatch { groups, ref buffers } => {
                let how = (groups, &buffers[..]);
                return Ok(Box::new(dispatch::DispatchRunner::new(&self.remote, kernel, how, capacity)?));
            }
            Form::Geometry => return unsupported("geometry stages; they run as compute"),
        }
        Ok(Box::new(runner::WgslRunner::new(&self.remote, kernel, capacity)?))
    }
}
