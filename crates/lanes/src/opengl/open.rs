//! Which drivers there are, and how each is chosen.

use super::context::{Context, REMEDY};
use super::remote::Remote;
use super::{Here, OpenGl};
use crate::worker::{self, Worker};
use crate::{Api, Candidate, Description, Lane, Stage, Unavailable};
use base::text::printable;

/// A driver of Mesa.
struct Driver {
    name: &'static str,
    about: &'static str,
    /// What chooses it when a process starts.
    environment: &'static [(&'static str, &'static str)],
    /// What `GL_RENDERER` begins with, in small letters: Mesa may silently take another driver.
    renderer: &'static str,
}

const SOFTWARE: (&str, &str) = ("LIBGL_ALWAYS_SOFTWARE", "1");

/// The drivers that are looked for.
static DRIVERS: [Driver; 3] = [
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
];

/// The lanes of OpenGL drivers.
pub fn candidates() -> Vec<Candidate> {
    let candidate = |driver: &'static Driver| Candidate {
        name: driver.name,
        about: driver.about,
        open: Box::new(move || open(driver)),
        stand_in: false,
        named_only: false,
    };
    DRIVERS.iter().map(candidate).collect()
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
        return Ok(Box::new(OpenGl { description, backend: Box::new(Here(context)), guarded: true }));
    };
    let worker = Worker::new(&program.with(super::SIDE), driver.environment);
    let remote = Remote::open(worker)?;
    let description = describe(driver, &remote.renderer, &remote.version)?;
    Ok(Box::new(OpenGl { description, backend: Box::new(remote), guarded: false }))
}

/// What a driver is, by what it says of itself.
fn describe(driver: &Driver, renderer: &str, version: &str) -> Result<Description, Unavailable> {
    if !renderer.to_lowercase().starts_with(driver.renderer) {
        let why = format!("Mesa gives `{renderer}` in place of {}", driver.renderer);
        return Err(missing(why));
    }
    // `zink (llvmpipe (LLVM 15.0.6, 256 bits))` is that Vulkan driver, with another API in front.
    let (device, through) = match renderer.split_once('(').filter(|_| driver.renderer == "zink") {
        Some((_, inner)) => (inner.strip_suffix(')').unwrap_or(inner), "zink, "),
        None => (renderer, ""),
    };
    Ok(Description {
        name: driver.name,
        driver: printable(&format!("{device}, {through}OpenGL {version}")),
        executor: executor(device),
        front_end: "Mesa".to_owned(),
        api: Api::OpenGl,
        stages: vec![Stage::Vertex, Stage::Geometry],
    })
}

/// What runs the shaders of a device: llvmpipe makes machine code with gallivm, whatever API it is reached through.
fn executor(renderer: &str) -> String {
    let name = renderer.split([' ', '(', ',']).next().unwrap_or(renderer).to_lowercase();
    if name == "llvmpipe" { "gallivm".to_owned() } else { name }
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
        assert!(error.why.contains("in place of softpipe"), "{error}");
    }
}
