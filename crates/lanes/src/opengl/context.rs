//! A context of OpenGL without a window: EGL on Mesa's surfaceless platform.

#![expect(unsafe_code, reason = "EGL and OpenGL are C interfaces that are loaded when the lane is opened")]

use std::rc::Rc;

use glow::HasContext;
use khronos_egl as egl;

type Egl = egl::DynamicInstance<egl::EGL1_5>;

/// `EGL_PLATFORM_SURFACELESS_MESA`.
const SURFACELESS: egl::Enum = 0x31DD;

/// Versions that are asked for, in this order: Mesa gives the newest that it has whatever it is asked for, NVIDIA that one.
const VERSIONS: [(egl::Int, egl::Int); 6] = [(4, 6), (4, 5), (4, 4), (4, 3), (4, 0), (3, 3)];

/// The oldest one that will do.
const LEAST: (egl::Int, egl::Int) = (3, 2);

/// What to install.
pub const REMEDY: &str = "install Mesa, for example `apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri` on Debian or \
                          Ubuntu";

/// A context with its functions. Everything that is made in it keeps it alive.
pub struct Context {
    pub gl: glow::Context,
    egl: Egl,
    display: egl::Display,
    context: egl::Context,
    /// Nothing is drawn to it, but without one every draw is an error.
    _target: (glow::Framebuffer, glow::Renderbuffer),
    /// `GL_RENDERER`.
    pub renderer: String,
    /// `GL_VERSION`.
    pub version: String,
    /// Version of GLSL: 330 for 3.30.
    pub glsl: u32,
}

impl Context {
    /// Opens the driver that the environment chooses.
    ///
    /// # Errors
    /// Why there is none, without a full stop.
    pub fn open() -> Result<Rc<Self>, String> {
        // SAFETY: the library is libEGL of the system, loaded for as long as the process runs, and called as EGL 1.5
        // says; handles are used with the display that they come from.
        unsafe {
            let egl = Egl::load_required().map_err(|error| format!("libEGL.so.1 cannot be loaded: {error}"))?;
            let display = egl
                .get_platform_display(SURFACELESS, egl::DEFAULT_DISPLAY, &[egl::ATTRIB_NONE])
                .map_err(|error| format!("EGL has no surfaceless platform: {error}"))?;
            egl.initialize(display).map_err(|error| format!("EGL does not start: {error}"))?;
            egl.bind_api(egl::OPENGL_API).map_err(|error| format!("EGL has no OpenGL: {error}"))?;
            let wanted = [egl::SURFACE_TYPE, 0, egl::RENDERABLE_TYPE, egl::OPENGL_BIT, egl::NONE];
            let config = egl
                .choose_first_config(display, &wanted)
                .map_err(|error| format!("EGL has no configuration for OpenGL: {error}"))?
                .ok_or("EGL has no configuration for OpenGL")?;
            let made = |(major, minor): (egl::Int, egl::Int)| {
                let attributes = [
                    egl::CONTEXT_MAJOR_VERSION,
                    major,
                    egl::CONTEXT_MINOR_VERSION,
                    minor,
                    egl::CONTEXT_OPENGL_PROFILE_MASK,
                    egl::CONTEXT_OPENGL_CORE_PROFILE_BIT,
                    egl::NONE,
                ];
                egl.create_context(display, config, None, &attributes)
            };
            let newest = VERSIONS.into_iter().find_map(|version| made(version).ok());
            let context = newest
                .map_or_else(|| made(LEAST), Ok)
                .map_err(|error| format!("the driver makes no context of OpenGL 3.2: {error}"))?;
            egl.make_current(display, None, None, Some(context))
                .map_err(|error| format!("the driver needs a surface: {error}"))?;
            let gl = glow::Context::from_loader_function(|name| {
                egl.get_proc_address(name).map_or(std::ptr::null(), |f| f as *const _)
            });
            let target = target(&gl)?;
            let renderer = gl.get_parameter_string(glow::RENDERER);
            let version = gl.get_parameter_string(glow::VERSION);
            let glsl = number(&gl.get_parameter_string(glow::SHADING_LANGUAGE_VERSION));
            let context = Self { gl, egl, display, context, _target: target, renderer, version, glsl };
            context.checked("the context").map_err(|error| error.to_string())?;
            Ok(Rc::new(context))
        }
    }

    /// Makes this context the one of the thread.
    pub fn make_current(&self) -> Result<(), String> {
        self.egl.make_current(self.display, None, None, Some(self.context)).map_err(|error| error.to_string())
    }

    /// The errors that OpenGL keeps, if any.
    pub fn checked(&self, at: &str) -> Result<(), String> {
        let mut found = Vec::new();
        // A lost context reports without end.
        for _ in 0..8 {
            // SAFETY: the context is current.
            match unsafe { self.gl.get_error() } {
                glow::NO_ERROR => break,
                code => found.push(name_of(code)),
            }
        }
        if found.is_empty() { Ok(()) } else { Err(format!("OpenGL reports {} at {at}", found.join(", "))) }
    }

    /// A limit or another number of the driver.
    pub fn number(&self, name: u32) -> usize {
        // SAFETY: the context is current, and `name` is that of one integer.
        usize::try_from(unsafe { self.gl.get_parameter_i32(name) }).unwrap_or(0)
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        // The display stays: other contexts of the process may use it.
        let _ = self.egl.make_current(self.display, None, None, None);
        let _ = self.egl.destroy_context(self.display, self.context);
    }
}

/// A framebuffer of one pixel.
unsafe fn target(gl: &glow::Context) -> Result<(glow::Framebuffer, glow::Renderbuffer), String> {
    // SAFETY: the caller has made the context of these functions current.
    unsafe {
        let (frame, render) = (gl.create_framebuffer()?, gl.create_renderbuffer()?);
        gl.bind_renderbuffer(glow::RENDERBUFFER, Some(render));
        gl.renderbuffer_storage(glow::RENDERBUFFER, glow::RGBA8, 1, 1);
        gl.bind_framebuffer(glow::FRAMEBUFFER, Some(frame));
        gl.framebuffer_renderbuffer(glow::FRAMEBUFFER, glow::COLOR_ATTACHMENT0, glow::RENDERBUFFER, Some(render));
        Ok((frame, render))
    }
}

/// `4.50` as 450.
fn number(text: &str) -> u32 {
    let word = text.split_whitespace().next().unwrap_or_default();
    word.chars().filter(char::is_ascii_digit).collect::<String>().parse().unwrap_or(0)
}

fn name_of(code: u32) -> String {
    match code {
        glow::INVALID_ENUM => "GL_INVALID_ENUM".to_owned(),
        glow::INVALID_VALUE => "GL_INVALID_VALUE".to_owned(),
        glow::INVALID_OPERATION => "GL_INVALID_OPERATION".to_owned(),
        glow::INVALID_FRAMEBUFFER_OPERATION => "GL_INVALID_FRAMEBUFFER_OPERATION".to_owned(),
        glow::OUT_OF_MEMORY => "GL_OUT_OF_MEMORY".to_owned(),
        _ => format!("the error 0x{code:04x}"),
    }
}
