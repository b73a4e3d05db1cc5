//! Keywords, which differ between versions (GLSL 4.60 specification, section 3.6).

use super::super::types::Type;
use super::super::{Extension, Profile, Version};

/// Words that became keywords late and are used as names in older shaders: the first desktop
/// version, the first ES version, and a part of the name of extensions that bring them.
const LATE: &[(&str, u32, u32, &str)] = &[
    ("sample", 400, 320, "gpu_shader5"),
    ("patch", 400, 320, "tessellation_shader"),
    ("subroutine", 400, 1000, "shader_subroutine"),
    ("precise", 400, 320, "gpu_shader5"),
    ("coherent", 420, 310, "shader_image_load_store"),
    ("volatile", 420, 310, "shader_image_load_store"),
    ("restrict", 420, 310, "shader_image_load_store"),
    ("readonly", 420, 310, "shader_image_load_store"),
    ("writeonly", 420, 310, "shader_image_load_store"),
    ("buffer", 430, 310, "shader_storage_buffer_object"),
    ("shared", 430, 310, "compute_shader"),
    ("atomic_uint", 420, 310, "shader_atomic_counters"),
    ("double", 400, 1000, "fp64"),
    ("uint", 130, 300, "gpu_shader4"),
    ("smooth", 130, 300, "gpu_shader4"),
    ("flat", 130, 300, "gpu_shader4"),
    ("noperspective", 130, 1000, "gpu_shader4"),
    ("switch", 130, 300, "gpu_shader4"),
    ("case", 130, 300, "gpu_shader4"),
    ("default", 130, 300, "gpu_shader4"),
    ("layout", 130, 300, "layout"),
];

const STATEMENTS: &[&str] =
    &["if", "else", "for", "while", "do", "switch", "case", "default", "return", "break", "continue", "discard"];

const QUALIFIERS: &[&str] = &[
    "const",
    "in",
    "out",
    "inout",
    "attribute",
    "varying",
    "uniform",
    "buffer",
    "shared",
    "centroid",
    "sample",
    "patch",
    "smooth",
    "flat",
    "noperspective",
    "lowp",
    "mediump",
    "highp",
    "invariant",
    "precise",
    "coherent",
    "volatile",
    "restrict",
    "readonly",
    "writeonly",
    "subroutine",
    "layout",
];

/// The keywords of one shader.
#[derive(Debug)]
pub(crate) struct Words {
    /// Words of [`LATE`] that are names here.
    names: Vec<&'static str>,
}

impl Words {
    pub(crate) fn new(version: &Version, extensions: &[Extension]) -> Self {
        let names = LATE
            .iter()
            .filter(|(_, desktop, es, extension)| {
                let first = if version.profile == Profile::Es { es } else { desktop };
                version.number < *first && !extensions.iter().any(|e| e.name.contains(extension))
            })
            .map(|(word, ..)| *word)
            .collect();
        Self { names }
    }

    /// True when the word cannot be a name.
    pub(crate) fn keyword(&self, word: &str) -> bool {
        is_keyword(word) && !self.names.contains(&word)
    }

    /// True for a qualifier.
    pub(crate) fn qualifier(&self, word: &str) -> bool {
        QUALIFIERS.contains(&word) && !self.names.contains(&word)
    }

    /// True for the name of a built-in type.
    pub(crate) fn built_in_type(&self, word: &str) -> bool {
        Type::from_name(word).is_some() && !self.names.contains(&word)
    }
}

/// True when a word is a keyword in some version.
fn is_keyword(word: &str) -> bool {
    STATEMENTS.contains(&word)
        || QUALIFIERS.contains(&word)
        || matches!(word, "struct" | "precision" | "true" | "false")
        || Type::from_name(word).is_some()
}

/// True for a word that starts a statement and nothing else.
pub(crate) fn is_statement_word(word: &str) -> bool {
    STATEMENTS.contains(&word)
}

/// Words that may be meant where an unknown type stands.
pub(crate) fn suggestions() -> impl Iterator<Item = &'static str> {
    const TYPES: &[&str] = &[
        "void",
        "bool",
        "int",
        "uint",
        "float",
        "double",
        "vec2",
        "vec3",
        "vec4",
        "bvec2",
        "bvec3",
        "bvec4",
        "ivec2",
        "ivec3",
        "ivec4",
        "uvec2",
        "uvec3",
        "uvec4",
        "mat2",
        "mat3",
        "mat4",
        "sampler1D",
        "sampler2D",
        "sampler3D",
        "samplerCube",
        "sampler2DShadow",
        "sampler2DArray",
        "struct",
    ];
    TYPES.iter().chain(STATEMENTS).chain(QUALIFIERS).copied()
}
