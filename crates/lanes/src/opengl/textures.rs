//! Textures with their samplers: nearest texel, clamped to the edge, one level.

#![expect(unsafe_code, reason = "every function of OpenGL is one of C")]

use glow::HasContext;

use super::job::{Bound, Job};
use super::unsupported;
use crate::LaneError;
use program::texture::{Dimension, Texel};

/// The textures of a job, each at the unit of its index.
#[derive(Default)]
pub struct Textures {
    all: Vec<(String, u32, glow::Texture)>,
}

impl Textures {
    /// Makes the textures. The context must be current.
    pub unsafe fn new(gl: &glow::Context, job: &Job) -> Result<Self, LaneError> {
        let mut this = Self::default();
        for bound in &job.textures {
            // SAFETY: the caller has made the context current.
            let (target, texture) = unsafe { made(gl, bound) }?;
            this.all.push((bound.name.clone(), target, texture));
        }
        Ok(this)
    }

    /// Tells a sampler of the program its unit, or each of its elements. The program must be in use.
    pub unsafe fn assign(
        &self,
        gl: &glow::Context,
        program: glow::Program,
        base: &str,
        size: usize,
    ) -> Result<(), LaneError> {
        for element in 0..size {
            let indexed = format!("{base}[{element}]");
            let known = |name: &str| self.all.iter().position(|(known, ..)| known == name);
            let unit = known(&indexed).or_else(|| known(base).filter(|_| size == 1));
            let unit = unit.ok_or_else(|| unsupported(format!("the sampler `{base}`, which nothing feeds")))?;
            let name = if size == 1 { base } else { &indexed };
            // SAFETY: the caller has made the context current and the program the one in use.
            unsafe {
                let location = gl.get_uniform_location(program, name);
                gl.uniform_1_i32(location.as_ref(), unit as i32);
            }
        }
        Ok(())
    }

    /// Binds all of them. The context must be current.
    pub unsafe fn bind(&self, gl: &glow::Context) {
        for (unit, (_, target, texture)) in self.all.iter().enumerate() {
            // SAFETY: units are as many as samplers, which the driver has linked.
            unsafe {
                gl.active_texture(glow::TEXTURE0 + unit as u32);
                gl.bind_texture(*target, Some(*texture));
            }
        }
    }

    /// Deletes them. The context must be current.
    pub unsafe fn free(&self, gl: &glow::Context) {
        // SAFETY: they are used nowhere else.
        self.all.iter().for_each(|&(_, _, texture)| unsafe { gl.delete_texture(texture) });
    }
}

unsafe fn made(gl: &glow::Context, bound: &Bound) -> Result<(u32, glow::Texture), LaneError> {
    let target = match (bound.kind.dimension, bound.kind.arrayed) {
        (Dimension::D1, false) => glow::TEXTURE_1D,
        (Dimension::D2, false) => glow::TEXTURE_2D,
        (Dimension::D2, true) => glow::TEXTURE_2D_ARRAY,
        (Dimension::D3, false) => glow::TEXTURE_3D,
        (Dimension::Cube, false) => glow::TEXTURE_CUBE_MAP,
        (Dimension::Cube, true) => glow::TEXTURE_CUBE_MAP_ARRAY,
        (Dimension::D1 | Dimension::D3, true) => return Err(unsupported(format!("layers of `{}`", bound.name))),
    };
    let (internal, format, kind) = match bound.kind.texel {
        Texel::Float => (glow::RGBA32F, glow::RGBA, glow::FLOAT),
        Texel::Int => (glow::RGBA32I, glow::RGBA_INTEGER, glow::INT),
        Texel::Uint => (glow::RGBA32UI, glow::RGBA_INTEGER, glow::UNSIGNED_INT),
        Texel::Depth => (glow::DEPTH_COMPONENT16, glow::DEPTH_COMPONENT, glow::FLOAT),
    };
    // Of a depth the first word of a texel counts.
    let channels = if bound.kind.texel == Texel::Depth { 1 } else { 4 };
    let words: Vec<u32> = bound.words.chunks_exact(4).flat_map(|texel| &texel[..channels]).copied().collect();
    let [width, height, layers] = bound.size.map(|n| n as i32);
    let image = |words: &[u32]| bytemuck::cast_slice::<u32, u8>(words).to_vec();
    let internal = internal as i32;
    // SAFETY: the caller has made the context current; each image has as many words as its size says.
    unsafe {
        let texture = gl.create_texture().map_err(LaneError::Api)?;
        gl.bind_texture(target, Some(texture));
        let parameters = [
            (glow::TEXTURE_MIN_FILTER, glow::NEAREST),
            (glow::TEXTURE_MAG_FILTER, glow::NEAREST),
            (glow::TEXTURE_WRAP_S, glow::CLAMP_TO_EDGE),
            (glow::TEXTURE_WRAP_T, glow::CLAMP_TO_EDGE),
            (glow::TEXTURE_WRAP_R, glow::CLAMP_TO_EDGE),
            (glow::TEXTURE_BASE_LEVEL, 0),
            (glow::TEXTURE_MAX_LEVEL, 0),
        ];
        parameters.iter().for_each(|&(name, value)| gl.tex_parameter_i32(target, name, value as i32));
        if bound.kind.texel == Texel::Depth {
            gl.tex_parameter_i32(target, glow::TEXTURE_COMPARE_MODE, glow::COMPARE_REF_TO_TEXTURE as i32);
            gl.tex_parameter_i32(target, glow::TEXTURE_COMPARE_FUNC, glow::LEQUAL as i32);
        }
        let pixels = image(&words);
        let data = glow::PixelUnpackData::Slice(Some(&pixels));
        match (bound.kind.dimension, bound.kind.arrayed) {
            (Dimension::D1, _) => gl.tex_image_1d(target, 0, internal, width, 0, format, kind, data),
            (Dimension::D2, false) => gl.tex_image_2d(target, 0, internal, width, height, 0, format, kind, data),
            (Dimension::Cube, false) => {
                let face = words.len() / 6;
                for (side, words) in (0..).zip(words.chunks_exact(face.max(1))) {
                    let (to, pixels) = (glow::TEXTURE_CUBE_MAP_POSITIVE_X + side, image(words));
                    let data = glow::PixelUnpackData::Slice(Some(&pixels));
                    gl.tex_image_2d(to, 0, internal, width, height, 0, format, kind, data);
                }
            }
            (Dimension::D2 | Dimension::D3 | Dimension::Cube, _) => {
                gl.tex_image_3d(target, 0, internal, width, height, layers, 0, format, kind, data);
            }
        }
        Ok((target, texture))
    }
}
