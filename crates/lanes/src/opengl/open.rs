//! Which drivers there are, and how each is chosen.
//!
//! libglvnd offers the driver of a graphics card first: the lanes of Mesa try again with Mesa named, and
//! `opengl-hardware` takes what comes.

use std::path::Path;

use super::context::{Context, REMEDY};
use super::remote::Remote;
use super::{Here, OpenGl};
use crate::worker::{self, Worker};
use crate::{Api, Candidate, Description, Lane, Stage, Unavailable};
use base::text::printable;

/// A driver of OpenGL.
struct Driver {
    name: &'static str,
    about: &'static str,
    /// What chooses it when a process starts.
    environment: &'static [(&'static str, &'static str)],
    /// What `GL_RENDERER` begins with, in small letters: Mesa may silently take another driver. Empty for that of a graphics
    /// card, whatever it is called.
    renderer: &'static str,
}

const SOFTWARE: (&str, &str) = ("LIBGL_ALWAYS_SOFTWARE", "1");

/// What of libglvnd, which has EGL from several vendors, names the one that is taken; without it, that of a graphics card is.
const VENDOR: (&str, &str) = ("__EGL_VENDOR_LIBRARY_FILENAMES", "/usr/share/glvnd/egl_vendor.d/50_mesa.json");

/// What `GL_RENDERER` of drivers without a device begins with.
const SOFTWARE_RENDERERS: [&str; 4] = ["llvmpipe", "softpipe", "swrast", "zink (llvmpipe"];

/// The drivers that are looked for; the last one only where there is a graphics card.
static DRIVERS: [Driver; 4] = [
    Driver {
        name: "opengl",
        about: "Mesa's llvmpipe through OpenGL: the author's own text, real vertex and geometry stages",
        environment: &[SOFTWARE, ("GALLIUM_DRIVER", "llvmpipe")],
        renderer: "llvmpipe",
    },
    Driver {
        name: "opengl-softpipe",
        about: "Mesa's interpreter through OpenGL",
        environment: &[SOFTWARE, ("GALLIUM_DRIVER", "softpipe")],
        renderer: "softpipe",
    },
    Driver {
        name: "opengl-zink",
        about: "OpenGL on a Vulkan driver, through Mesa's zink",
        environment: &[SOFTWARE, ("MESA_LOADER_DRIVER_OVERRIDE", "zink")],
        renderer: "zink",
    },
    Driver {
        name: "opengl-hardware",
        about: "OpenGL of a graphics card, by the driver of its vendor",
        environment: &[],
        renderer: "",
    },
];

/// True where the system has a graphics card with a driver.
fn has_card() -> bool {
    // The kernel counts them from 128 on.
    (128..144).any(|node| Path::new(&format!("/dev/dri/renderD{node}")).exists())
        || ["/dev/nvidiactl", "/dev/dxg"].iter().any(|device| Path::new(device).exists())
}

impl Driver {
    /// True for a driver that Mesa has without any device.
    fn of_mesa(&self) -> bool {
        !self.renderer.is_empty()
    }
}

/// The lanes of OpenGL drivers.
pub fn candidates() -> Vec<Candidate> {
    let candidate = |driver: &'static Driver| Candidate {
        name: driver.name,
        about: driver.about,
        open: Box::new(move || open(driver)),
        stand_in: false,
        named_only: false,
        extra: false,
    };
    let card = has_card();
    DRIVERS.iter().filter(|driver| card || driver.of_mesa()).map(candidate).collect()
}

fn missing(why: impl Into<String>) -> Unavailable {
    Unavailable { why: why.into(), remedy: REMEDY.to_owned() }
}

/// Opens a driver in a process of its own, or the usual one in this process where there is no program for that.
fn open(driver: &'static Driver) -> Result<Box<dyn Lane>, Unavailable> {
    if !cfg!(target_os = "linux") {
        let remedy = "run it on Linux, or in a container".to_owned();
        return Err(Unavailable { why: "Mesa's surfaceless OpenGL is there on Linux alone".to_owned(), remedy });
    }
    let Some(program) = worker::program() else {
        if driver.name != "opengl" {
            return Err(Unavailable {
                why: "this driver runs in a process of its own".to_owned(),
                remedy: "run the program `shadercheck`, which starts one".to_owned(),
            });
        }
        // The driver of this process is whatever its environment says.
        let context = Context::open().map_err(missing)?;
        let description = describe(driver, &context.renderer, &context.version)?;
        return Ok(Box::new(OpenGl { description, backend: Here(context), guarded: true }));
    };
    let opened = |environment: &[(&'static str, &'static str)]| -> Result<_, Unavailable> {
        let remote = Remote::open(Worker::new(&program.with(super::SIDE), environment))?;
        Ok((describe(driver, &remote.renderer, &remote.version), remote))
    };
    let (mut described, mut remote) = opened(driver.environment)?;
    if described.is_err() && driver.of_mesa() && Path::new(VENDOR.1).exists() {
        // It is another vendor's.
        (described, remote) = opened(&[driver.environment, &[VENDOR]].concat())?;
    }
    Ok(Box::new(OpenGl { description: described?, backend: remote, guarded: false }))
}

/// What a driver is, by what it says of itself.
fn describe(driver: &Driver, renderer: &str, version: &str) -> Result<Description, Unavailable> {
    let known = |name: &str| renderer.to_lowercase().starts_with(name);
    if driver.of_mesa() && !known(driver.renderer) {
        return Err(missing(format!("OpenGL here is `{renderer}` and not Mesa's {}", driver.renderer)));
    }
    if !driver.of_mesa() && SOFTWARE_RENDERERS.into_iter().any(known) {
        let remedy = "install the driver of the graphics card, with its EGL".to_owned();
        return Err(Unavailable { why: format!("OpenGL here is `{renderer}`, without the graphics card"), remedy });
    }
    // `zink (llvmpipe (LLVM 15.0.6, 256 bits))` is that Vulkan driver, with another API in front.
    let (device, through) = match renderer.split_once('(').filter(|_| driver.renderer == "zink") {
        Some((_, inner)) => (inner.strip_suffix(')').unwrap_or(inner), "zink, "),
        None => (renderer, ""),
    };
    // `NVIDIA H200/PCIe/SSE2`: bus and processor are no part of what computes.
    let device = if driver.of_mesa() { device } else { device.split('/').next().unwrap_or(device) };
    // `4.6.0 NVIDIA 580.159.04`, `4.5 (Core Profile) Mesa 22.3.6`.
    let compiler = match version.split_whitespace().find(|word| word.starts_with(char::is_alphabetic)) {
        Some(vendor) if !version.contains("Mesa") => printable(vendor),
        _ => "Mesa".to_owned(),
    };
    Ok(Description {
        name: driver.name,
        driver: printable(&format!("{device}, {through}OpenGL {version}")),
        executor: if driver.of_mesa() { executor(device) } else { printable(device_name(device)) },
        front_end: compiler,
        api: Api::OpenGl,
        stages: vec![Stage::Vertex, Stage::Geometry],
    })
}

/// What runs the shaders of a device: llvmpipe makes machine code with gallivm, whatever API it is reached through.
fn executor(renderer: &str) -> String {
    let name = device_name(renderer).split(' ').next().unwrap_or(renderer).to_lowercase();
    if name == "llvmpipe" { "gallivm".to_owned() } else { name }
}

/// The name of a device, without the versions behind it; the Vulkan lane of the device has the same.
fn device_name(renderer: &str) -> &str {
    renderer.split(['(', ',']).next().unwrap_or(renderer).trim()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn described(driver: usize, renderer: &str) -> Result<(String, String), Unavailable> {
        describe(&DRIVERS[driver], renderer, "4.5 (Core Profile) Mesa 22.3.6").map(|d| (d.executor, d.driver))
    }

    #[test]
    fn a_driver_is_known_by_what_runs_its_shaders() {
        let (executor, name) = described(0, "llvmpipe (LLVM 15.0.6, 256 bits)").unwrap();
        assert_eq!(executor, "gallivm");
        assert_eq!(name, "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5 (Core Profile) Mesa 22.3.6");
        assert_eq!(described(1, "softpipe").unwrap().0, "softpipe");
        let (executor, name) = described(2, "zink (llvmpipe (LLVM 15.0.6, 256 bits))").unwrap();
        assert_eq!(executor, "gallivm");
        assert_eq!(name, "llvmpipe (LLVM 15.0.6, 256 bits), zink, OpenGL 4.5 (Core Profile) Mesa 22.3.6");
    }

    #[test]
    fn another_driver_than_the_one_asked_for_is_no_lane() {
        let error = described(1, "llvmpipe (LLVM 15.0.6, 256 bits)").unwrap_err();
        assert!(error.why.contains("not Mesa's softpipe"), "{error}");
        let error = described(0, "NVIDIA H200/PCIe/SSE2").unwrap_err();
        assert!(error.why.contains("not Mesa's llvmpipe"), "{error}");
        // A machine with a card whose driver is missing has Mesa's software alone.
        let error = described(3, "llvmpipe (LLVM 15.0.6, 256 bits)").unwrap_err();
        assert!(error.why.contains("without the graphics card"), "{error}");
    }

    #[test]
    fn a_card_is_called_as_by_its_vulkan_driver() {
        let lane = describe(&DRIVERS[3], "NVIDIA H200/PCIe/SSE2", "4.6.0 NVIDIA 580.159.04").unwrap();
        assert_eq!(lane.driver, "NVIDIA H200, OpenGL 4.6.0 NVIDIA 580.159.04");
        assert_eq!((lane.executor.as_str(), lane.front_end.as_str()), ("NVIDIA H200", "NVIDIA"));
        let (renderer, version) =
            ("AMD Radeon RX 580 (radeonsi, polaris10, LLVM 15)", "4.6 (Core Profile) Mesa 22.3.6");
        let lane = describe(&DRIVERS[3], renderer, version).unwrap();
        assert_eq!((lane.executor.as_str(), lane.front_end.as_str()), ("AMD Radeon RX 580", "Mesa"));
    }
}
