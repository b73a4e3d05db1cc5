//! Opaque types: samplers, textures, images, input attachments and atomic counters (GLSL 4.60 specification, section 4.1.7,
//! and GL_KHR_vulkan_glsl).

use std::fmt;

use super::scalar::ScalarType;

/// Dimension of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TextureDim {
    /// `1D`
    D1,
    /// `2D`
    D2,
    /// `3D`
    D3,
    /// `Cube`
    Cube,
    /// `2DRect`
    Rect,
    /// `Buffer`
    Buffer,
    /// What an earlier part of a render pass wrote to the pixel: `subpassInput` (GL_KHR_vulkan_glsl).
    Subpass,
}

/// Kind of an opaque type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OpaqueKind {
    /// `sampler…`
    Sampler,
    /// `image…`
    Image,
    /// `atomic_uint`
    AtomicCounter,
}

/// A sampler, image or atomic counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OpaqueType {
    /// What it is.
    pub kind: OpaqueKind,
    /// Component type of the texels.
    pub scalar: ScalarType,
    /// Dimension.
    pub dim: TextureDim,
    /// `…Array`
    pub arrayed: bool,
    /// `…Shadow`
    pub shadow: bool,
    /// `…MS`
    pub multisampled: bool,
    /// `texture2D`: texels without a sampler (GL_KHR_vulkan_glsl), of the kind `Sampler`.
    pub separate: bool,
}

impl OpaqueType {
    /// Number of texture coordinates without layer and reference value.
    pub fn coordinates(self) -> u8 {
        match self.dim {
            TextureDim::D1 | TextureDim::Buffer => 1,
            TextureDim::D2 | TextureDim::Rect | TextureDim::Subpass => 2,
            TextureDim::D3 | TextureDim::Cube => 3,
        }
    }

    /// True where GLSL ES has a default precision of it, and for what GLSL ES has only with Vulkan.
    pub(crate) fn has_default_precision(self) -> bool {
        let plain = self.scalar == ScalarType::Float && !self.arrayed && !self.shadow && !self.multisampled;
        match self.kind {
            OpaqueKind::Sampler => {
                self.separate || (plain && matches!(self.dim, TextureDim::D2 | TextureDim::Cube | TextureDim::Rect))
            }
            OpaqueKind::Image => false,
            OpaqueKind::AtomicCounter => true,
        }
    }

    /// Reads a spelling such as `usampler2DArray` or `image3D`.
    pub fn from_name(name: &str) -> Option<Self> {
        if name == "atomic_uint" {
            return Some(Self {
                kind: OpaqueKind::AtomicCounter,
                scalar: ScalarType::Uint,
                dim: TextureDim::Buffer,
                arrayed: false,
                shadow: false,
                multisampled: false,
                separate: false,
            });
        }
        let (scalar, rest) = match name.as_bytes().first()? {
            b'i' if !name.starts_with("image") => (ScalarType::Int, &name[1..]),
            b'u' => (ScalarType::Uint, &name[1..]),
            _ => (ScalarType::Float, name),
        };
        let (kind, rest) = match rest.strip_prefix("sampler") {
            Some(rest) => (OpaqueKind::Sampler, rest),
            None => (OpaqueKind::Image, rest.strip_prefix("image")?),
        };
        let (rest, shadow) = rest.strip_suffix("Shadow").map_or((rest, false), |r| (r, true));
        let (rest, arrayed) = rest.strip_suffix("Array").map_or((rest, false), |r| (r, true));
        let (rest, multisampled) = rest.strip_suffix("MS").map_or((rest, false), |r| (r, true));
        let dim = match rest {
            "1D" => TextureDim::D1,
            "2D" => TextureDim::D2,
            "3D" => TextureDim::D3,
            "Cube" => TextureDim::Cube,
            "2DRect" => TextureDim::Rect,
            "Buffer" => TextureDim::Buffer,
            _ => return None,
        };
        let sampler = kind == OpaqueKind::Sampler;
        let valid = match dim {
            TextureDim::D1 => !multisampled,
            TextureDim::D2 => !(multisampled && shadow),
            TextureDim::Cube => !multisampled,
            TextureDim::Rect => !multisampled && !arrayed,
            TextureDim::D3 | TextureDim::Buffer => !multisampled && !arrayed && !shadow,
            // No sampler has it: see `of_vulkan`.
            TextureDim::Subpass => false,
        };
        (valid && !(shadow && (!sampler || scalar != ScalarType::Float))).then_some(Self {
            kind,
            scalar,
            dim,
            arrayed,
            shadow,
            multisampled,
            separate: false,
        })
    }
}

impl OpaqueType {
    /// A texture without a sampler, such as `utexture3D`, or a `subpassInput` (GL_KHR_vulkan_glsl).
    pub fn of_vulkan(name: &str) -> Option<Self> {
        let (base, multisampled) = name.strip_suffix("MS").map_or((name, false), |base| (base, true));
        let scalar = match base {
            "subpassInput" => Some(ScalarType::Float),
            "isubpassInput" => Some(ScalarType::Int),
            "usubpassInput" => Some(ScalarType::Uint),
            _ => None,
        };
        if let Some(scalar) = scalar {
            let dim = TextureDim::Subpass;
            let kind = OpaqueKind::Sampler;
            return Some(Self { kind, scalar, dim, arrayed: false, shadow: false, multisampled, separate: true });
        }
        let at = name.find("texture").filter(|at| *at <= 1)?;
        let name = format!("{}sampler{}", &name[..at], &name[at + "texture".len()..]);
        Self::from_name(&name).filter(|ty| !ty.shadow).map(|ty| Self { separate: true, ..ty })
    }

    /// The sampler with the same texels, as which built-in functions take a texture without a sampler.
    #[must_use]
    pub fn sampled(self) -> Self {
        Self { separate: false, ..self }
    }
}

impl fmt::Display for OpaqueType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let base = match self.kind {
            OpaqueKind::AtomicCounter => return f.write_str("atomic_uint"),
            OpaqueKind::Sampler if self.dim == TextureDim::Subpass => "subpassInput",
            OpaqueKind::Sampler if self.separate => "texture",
            OpaqueKind::Sampler => "sampler",
            OpaqueKind::Image => "image",
        };
        let dim = match self.dim {
            TextureDim::D1 => "1D",
            TextureDim::D2 => "2D",
            TextureDim::D3 => "3D",
            TextureDim::Cube => "Cube",
            TextureDim::Rect => "2DRect",
            TextureDim::Buffer => "Buffer",
            TextureDim::Subpass => "",
        };
        let ms = if self.multisampled { "MS" } else { "" };
        let array = if self.arrayed { "Array" } else { "" };
        let shadow = if self.shadow { "Shadow" } else { "" };
        write!(f, "{}{base}{dim}{ms}{array}{shadow}", self.scalar.prefix())
    }
}
