//! A job made ready in a context: compiled, linked, and compared with what the driver says about it.

#![expect(unsafe_code, reason = "every function of OpenGL is one of C")]

use std::rc::Rc;

use glow::HasContext;
use serde::{Deserialize, Serialize};

use super::context::Context;
use super::dispatch::Buffers;
use super::job::{CaptureKind, Input, Job, Output};
use super::textures::Textures;
use super::uniforms::Uniforms;
use super::{types, unsupported};
use crate::LaneError;

/// Why a job is not made ready.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// As of every lane.
    Lane(LaneError),
    /// The driver does not compile a text.
    Text {
        /// Index of the text.
        text: usize,
        /// What the driver says.
        log: String,
    },
    /// The driver does not link the stage.
    Link(String),
}

impl From<LaneError> for Refusal {
    fn from(error: LaneError) -> Self {
        Self::Lane(error)
    }
}

/// Bytes of one buffer.
const BYTES: usize = 1 << 25;
/// Invocations of a geometry stage in one run: each is a draw and a query of its own.
const DRAWS: usize = 1 << 14;

/// A program with its buffers.
pub struct Ready {
    pub(super) context: Rc<Context>,
    pub(super) job: Job,
    pub(super) program: glow::Program,
    pub(super) array: glow::VertexArray,
    pub(super) vertices: glow::Buffer,
    pub(super) captured: glow::Buffer,
    pub(super) uniforms: Uniforms,
    pub(super) textures: Textures,
    pub(super) buffers: Buffers,
    /// Attributes that the program reads: location, components, type, and byte in the record of a vertex.
    pub(super) pointers: Vec<(u32, i32, u32, i32)>,
    pub(super) queries: Vec<glow::Query>,
    /// Invocations that fit into one run.
    pub capacity: usize,
}

impl Ready {
    /// Compiles and links a job for at most `capacity` invocations.
    ///
    /// # Errors
    /// [`Refusal`]: what the driver lacks, or its word on the text.
    pub fn new(context: &Rc<Context>, job: &Job, capacity: usize) -> Result<Self, Refusal> {
        context.make_current().map_err(LaneError::Api)?;
        limits(context, job)?;
        // SAFETY: the context is current; objects are those that it made, and are freed with `Ready`.
        unsafe {
            let gl = &context.gl;
            let program = compiled(gl, job)?;
            let make =
                || -> Result<_, String> { Ok((gl.create_vertex_array()?, gl.create_buffer()?, gl.create_buffer()?)) };
            let (array, vertices, captured) = make().map_err(LaneError::Api)?;
            let mut ready = Self {
                context: context.clone(),
                job: job.clone(),
                program,
                array,
                vertices,
                captured,
                uniforms: Uniforms::default(),
                textures: Textures::default(),
                buffers: Buffers::default(),
                pointers: Vec::new(),
                queries: Vec::new(),
                capacity: 0,
            };
            ready.check_outputs()?;
            ready.attributes()?;
            ready.textures = Textures::new(gl, job)?;
            ready.uniforms = Uniforms::new(context, program, job, &ready.textures)?;
            ready.buffers = Buffers::new(context, program, job)?;
            let bytes = 4 * job.most_words().max(job.vertices() * job.fed.first().map_or(0, Vec::len)).max(1);
            let mut most = (BYTES / bytes).min(BYTES / ready.uniforms.case_bytes().max(1));
            if matches!(job.stage, CaptureKind::Geometry { .. }) || job.reads_numbers() {
                most = most.min(DRAWS);
            }
            if matches!(job.stage, CaptureKind::Dispatch { .. }) {
                most = most.min(job.most_dispatches());
            }
            ready.capacity = capacity.min(most).max(1);
            context.checked("the preparation").map_err(LaneError::Api)?;
            Ok(ready)
        }
    }

    /// What transform feedback captures must be what the harness reads.
    unsafe fn check_outputs(&self) -> Result<(), LaneError> {
        for (k, output) in self.job.outputs.iter().enumerate() {
            // SAFETY: the context is current, and the program is its own.
            let found = unsafe { self.context.gl.get_transform_feedback_varying(self.program, k as u32) };
            let fits = found.as_ref().is_some_and(|f| {
                types::of(output.shape.element()) == Some(f.tftype) && f.size as usize == output.shape.elements()
            });
            if !fits {
                let found = found.map_or_else(String::new, |f| format!(": type 0x{:04x}, size {}", f.tftype, f.size));
                return Err(unsupported(format!("the output `{}` of type `{}`{found}", output.name, output.shape)));
            }
        }
        Ok(())
    }

    /// Binds attributes to the vertex buffer, and refuses those that nothing feeds.
    unsafe fn attributes(&mut self) -> Result<(), LaneError> {
        let gl = &self.context.gl;
        // SAFETY: as above; offsets are inside of the record that `draw` uploads for each vertex.
        unsafe {
            for k in 0..gl.get_active_attributes(self.program) {
                let Some(active) = gl.get_active_attribute(self.program, k) else { continue };
                let known = self.job.attributes.iter().any(|a| a.name == active.name);
                // What has no location is no attribute: `gl_VertexID` and the like.
                if !known && gl.get_attrib_location(self.program, &active.name).is_some() {
                    return Err(unsupported(format!("the attribute `{}`", active.name)));
                }
            }
            gl.bind_vertex_array(Some(self.array));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(self.vertices));
            let mut offset = 0;
            let mut pointers = Vec::new();
            for attribute in &self.job.attributes {
                let components = i32::from(attribute.components);
                if let Some(at) = gl.get_attrib_location(self.program, &attribute.name) {
                    gl.enable_vertex_attrib_array(at);
                    pointers.push((at, components, types::base(attribute.scalar), offset));
                    if self.job.reads_numbers() {
                        // Whatever its numbers, a vertex that is drawn alone has the attributes that are pointed at.
                        gl.vertex_attrib_divisor(at, i32::MAX as u32);
                    }
                }
                offset += 4 * components;
            }
            self.pointers = pointers;
            self.point(0);
        }
        Ok(())
    }

    /// Points the attributes at those of a vertex. The context must be current, with the buffer of the vertices bound.
    pub(super) unsafe fn point(&self, vertex: usize) {
        let gl = &self.context.gl;
        let stride = 4 * self.job.fed.first().map_or(0, Vec::len) as i32;
        for &(at, components, base, offset) in &self.pointers {
            let offset = offset + stride * vertex as i32;
            // SAFETY: as above.
            unsafe {
                match base {
                    glow::FLOAT => gl.vertex_attrib_pointer_f32(at, components, base, false, stride, offset),
                    _ => gl.vertex_attrib_pointer_i32(at, components, base, stride, offset),
                }
            }
        }
    }
}

impl Drop for Ready {
    fn drop(&mut self) {
        if self.context.make_current().is_err() {
            return;
        }
        let gl = &self.context.gl;
        // SAFETY: the context is current, and all of these are its own and used nowhere else.
        unsafe {
            gl.delete_program(self.program);
            gl.delete_vertex_array(self.array);
            gl.delete_buffer(self.vertices);
            gl.delete_buffer(self.captured);
            self.queries.iter().for_each(|&query| gl.delete_query(query));
            self.textures.free(gl);
            self.uniforms.free(gl);
            self.buffers.free(gl);
        }
    }
}

/// Refuses what the driver has no room for, by name.
fn limits(context: &Context, job: &Job) -> Result<(), LaneError> {
    if let Some(text) = job.texts.iter().find(|t| !t.es && t.version > context.glsl) {
        let of = |n: u32| format!("{}.{:02}", n / 100, n % 100);
        return Err(unsupported(format!("GLSL {}; the driver has {}", of(text.version), of(context.glsl))));
    }
    if matches!(job.stage, CaptureKind::Dispatch { .. }) {
        // OpenGL 4.3 brings compute stages with GLSL 4.30.
        if context.glsl < 430 {
            return Err(unsupported("compute stages, which OpenGL has from 4.3 on"));
        }
    } else if job.width() == 0 {
        return Err(unsupported("a stage that writes no output: transform feedback captures nothing".to_owned()));
    }
    let most = context.number(glow::MAX_VERTEX_ATTRIBS);
    if job.attributes.len() > most {
        return Err(unsupported(format!("{} vertex attributes; the driver takes {most}", job.attributes.len())));
    }
    let most = context.number(glow::MAX_TRANSFORM_FEEDBACK_INTERLEAVED_COMPONENTS);
    if job.width() > most {
        let width = job.width();
        return Err(unsupported(format!("{width} components of outputs; transform feedback takes {most}")));
    }
    Ok(())
}

/// Compiles and links. The context must be current.
unsafe fn compiled(gl: &glow::Context, job: &Job) -> Result<glow::Program, Refusal> {
    let stage = match job.stage {
        CaptureKind::Vertex => glow::VERTEX_SHADER,
        CaptureKind::Geometry { .. } => glow::GEOMETRY_SHADER,
        CaptureKind::Dispatch { .. } => glow::COMPUTE_SHADER,
    };
    let api = |error: String| Refusal::Lane(LaneError::Api(error));
    // SAFETY: the caller has made the context current; shaders live until the program is deleted.
    unsafe {
        let program = gl.create_program().map_err(api)?;
        let fail = |refusal: Refusal| {
            gl.delete_program(program);
            Err(refusal)
        };
        let add = |kind: u32, text: &str| -> Result<(), String> {
            let shader = gl.create_shader(kind)?;
            gl.shader_source(shader, text);
            gl.compile_shader(shader);
            let log = (!gl.get_shader_compile_status(shader)).then(|| gl.get_shader_info_log(shader));
            gl.attach_shader(program, shader);
            gl.delete_shader(shader);
            log.map_or(Ok(()), Err)
        };
        for (k, text) in job.texts.iter().enumerate() {
            if let Err(log) = add(stage, &text.text) {
                return fail(match text.es {
                    true => unsupported(format!("this text in GLSL ES: {}", log.trim())).into(),
                    false if log.contains("extension") && log.contains("unsupported") => {
                        unsupported(log.trim().to_owned()).into()
                    }
                    false => Refusal::Text { text: k, log },
                });
            }
        }
        if let Some(Err(log)) = job.pass.as_deref().map(|text| add(glow::VERTEX_SHADER, text)) {
            return fail(LaneError::Api(format!("the vertex stage in front is refused: {}", log.trim())).into());
        }
        let names: Vec<&str> = job.outputs.iter().map(|o| o.name.as_str()).collect();
        if !names.is_empty() {
            gl.transform_feedback_varyings(program, &names, glow::INTERLEAVED_ATTRIBS);
        }
        gl.link_program(program);
        if !gl.get_program_link_status(program) {
            let log = gl.get_program_info_log(program);
            if log.to_ascii_lowercase().contains("transform feedback") {
                return fail(unsupported(format!("outputs that are not captured: {}", log.trim())).into());
            }
            return fail(Refusal::Link(log));
        }
        Ok(program)
    }
}

/// What is drawn.
pub(super) fn mode(input: Input) -> u32 {
    match input {
        Input::Points => glow::POINTS,
        Input::Lines => glow::LINES,
        Input::LinesAdjacency => glow::LINES_ADJACENCY,
        Input::Triangles => glow::TRIANGLES,
        Input::TrianglesAdjacency => glow::TRIANGLES_ADJACENCY,
    }
}

/// What is captured.
pub(super) fn captured_as(output: Output) -> u32 {
    match output {
        Output::Points => glow::POINTS,
        Output::Lines => glow::LINES,
        Output::Triangles => glow::TRIANGLES,
    }
}
