//! Keywords, which differ between versions (GLSL 4.60 specification, section 3.6).

use std::collections::HashMap;
use std::sync::LazyLock;

use super::super::builtin::type_since;
use super::super::language::{Language, NEVER, Since};
use super::super::types::Type;

/// Words that became keywords late and are used as names in older shaders: the first desktop
/// version, the first ES version, and extensions that bring them, without `GL_`. Names of types have a
/// table of their own.
const LATE: &[(&str, Since)] = &[
    ("sample", (400, 320, &["ARB_gpu_shader5", "OES_shader_multisample_interpolation"])),
    ("patch", (400, 320, &["ARB_tessellation_shader", "OES_tessellation_shader", "EXT_tessellation_shader"])),
    ("subroutine", (400, NEVER, &["ARB_shader_subroutine"])),
    ("precise", (400, 320, &["ARB_gpu_shader5", "EXT_gpu_shader5", "OES_gpu_shader5"])),
    ("coherent", (420, 310, &["ARB_shader_image_load_store", "ARB_shader_storage_buffer_object"])),
    ("volatile", (420, 310, &["ARB_shader_image_load_store", "ARB_shader_storage_buffer_object"])),
    ("restrict", (420, 310, &["ARB_shader_image_load_store", "ARB_shader_storage_buffer_object"])),
    ("devicecoherent", SCOPES),
    ("queuefamilycoherent", SCOPES),
    ("workgroupcoherent", SCOPES),
    ("subgroupcoherent", SCOPES),
    ("shadercallcoherent", SCOPES),
    ("nonprivate", SCOPES),
    ("readonly", (420, 310, &["ARB_shader_image_load_store", "ARB_shader_storage_buffer_object"])),
    ("writeonly", (420, 310, &["ARB_shader_image_load_store", "ARB_shader_storage_buffer_object"])),
    ("buffer", (430, 310, &["ARB_shader_storage_buffer_object"])),
    ("shared", (430, 310, &["ARB_compute_shader"])),
    ("smooth", (130, 300, &["EXT_gpu_shader4"])),
    ("flat", (130, 300, &["EXT_gpu_shader4"])),
    ("noperspective", (130, NEVER, &["EXT_gpu_shader4", "NV_shader_noperspective_interpolation"])),
    ("switch", (130, 300, &[])),
    ("case", (130, 300, &[])),
    ("default", (130, 300, &[])),
    ("centroid", (120, 300, &["EXT_gpu_shader4"])),
    ("invariant", (120, 100, &[])),
    ("lowp", (130, 100, &["ARB_ES2_compatibility", "ARB_ES3_compatibility"])),
    ("mediump", (130, 100, &["ARB_ES2_compatibility", "ARB_ES3_compatibility"])),
    ("highp", (130, 100, &["ARB_ES2_compatibility", "ARB_ES3_compatibility"])),
    ("precision", (130, 100, &["ARB_ES2_compatibility", "ARB_ES3_compatibility"])),
    (
        "layout",
        (
            140,
            300,
            &[
                "ARB_explicit_attrib_location",
                "ARB_explicit_uniform_location",
                "ARB_uniform_buffer_object",
                "ARB_fragment_coord_conventions",
                "ARB_conservative_depth",
                "AMD_conservative_depth",
                "ARB_separate_shader_objects",
                "EXT_separate_shader_objects",
                "ARB_shading_language_420pack",
            ],
        ),
    ),
];

/// Of the qualifiers that say for whom memory is ordered: no version has them.
const SCOPES: Since = (NEVER, NEVER, &["KHR_memory_scope_semantics"]);

/// The first and the last version.
type Versions = (u32, u32);

/// When each reserved word is one: every name of a shader is looked up.
static RESERVED_WORDS: LazyLock<HashMap<&'static str, Vec<(Versions, Versions)>>> = LazyLock::new(|| {
    let mut found: HashMap<&str, Vec<(Versions, Versions)>> = HashMap::new();
    for (words, desktop, es) in RESERVED {
        words.split_whitespace().for_each(|word| found.entry(word).or_default().push((*desktop, *es)));
    }
    found
});

/// Words kept for later, which no name may be: the desktop versions and the ES versions, from the first to
/// the last one.
const RESERVED: &[(&str, Versions, Versions)] = &[
    (
        "asm class union enum typedef template this goto inline noinline public static extern external interface \
         long short half fixed unsigned input output hvec2 hvec3 hvec4 fvec2 fvec3 fvec4 sampler3DRect sizeof cast \
         namespace using",
        (110, 460),
        (100, 320),
    ),
    ("packed", (110, 130), (100, 100)),
    ("double dvec2 dvec3 dvec4", (110, 330), (100, 320)),
    ("volatile", (110, 410), (100, 300)),
    ("switch default", (110, 120), (100, 100)),
    ("sampler2DRect sampler2DRectShadow", (110, 130), (100, 320)),
    ("sampler1D sampler1DShadow", NO, (100, 320)),
    ("sampler2DShadow sampler3D", NO, (100, 100)),
    ("lowp mediump highp precision", (120, 120), NO),
    ("flat", NO, (100, 100)),
    ("superp", (130, 460), (100, 320)),
    ("common partition active filter", (130, 460), (300, 320)),
    ("row_major", (130, 130), NO),
    ("resource", (420, 460), (300, 320)),
    ("attribute varying noperspective subroutine", NO, (300, 320)),
    ("coherent restrict readonly writeonly atomic_uint", NO, (300, 300)),
    ("patch sample", NO, (300, 310)),
    (
        "image1D image2D image3D imageCube iimage1D iimage2D iimage3D iimageCube uimage1D uimage2D uimage3D \
         uimageCube image1DArray image2DArray iimage1DArray iimage2DArray uimage1DArray uimage2DArray imageBuffer \
         iimageBuffer uimageBuffer",
        (130, 410),
        (300, 300),
    ),
    ("image1DShadow image2DShadow image1DArrayShadow image2DArrayShadow", (130, 410), (300, 300)),
];

const NO: (u32, u32) = (1, 0);

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
    "devicecoherent",
    "queuefamilycoherent",
    "workgroupcoherent",
    "subgroupcoherent",
    "shadercallcoherent",
    "nonprivate",
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
    language: Language,
    /// Words of [`LATE`] that are names here.
    names: Vec<&'static str>,
}

impl Words {
    pub(crate) fn new(language: &Language) -> Self {
        let names = LATE.iter().filter(|(_, since)| !language.since(*since)).map(|(word, _)| *word).collect();
        Self { language: language.clone(), names }
    }

    /// True when the word cannot be a name.
    pub(crate) fn keyword(&self, word: &str) -> bool {
        is_keyword(word) && !self.is_late(word)
    }

    /// True for a qualifier.
    pub(crate) fn qualifier(&self, word: &str) -> bool {
        QUALIFIERS.contains(&word) && !self.is_late(word)
    }

    /// True for the name of a built-in type.
    pub(crate) fn built_in_type(&self, word: &str) -> bool {
        Type::from_name(word).is_some() && !self.is_late(word)
    }

    /// True for a word that the version keeps for itself without a meaning.
    pub(crate) fn reserved(&self, word: &str) -> bool {
        let number = self.language.number();
        let inside = |(first, last): (u32, u32)| (first..=last).contains(&number);
        let mut rows = RESERVED_WORDS.get(word).into_iter().flatten();
        rows.any(|(desktop, es)| inside(if self.language.es() { *es } else { *desktop })) && !self.keyword(word)
    }

    pub(crate) fn language(&self) -> &Language {
        &self.language
    }

    /// Makes words keywords that a later version has, after that has been told.
    pub(crate) fn enable(&mut self, words: &[&str]) {
        self.names.retain(|n| !words.contains(n));
    }

    /// When a qualifier came that is a name in this version; none when it is no such word.
    pub(crate) fn late_qualifier(&self, word: &str) -> Option<Since> {
        let known = QUALIFIERS.contains(&word) && self.is_late(word);
        LATE.iter().find(|(late, _)| known && *late == word).map(|(_, since)| *since)
    }

    fn is_late(&self, word: &str) -> bool {
        self.names.contains(&word) || type_since(word).is_some_and(|since| !self.language.since(since))
    }
}

/// True for a word that became a keyword in a later version than the first.
pub fn is_late_keyword(word: &str) -> bool {
    LATE.iter().any(|(late, _)| *late == word)
}

/// True when a word is a keyword in some version.
pub fn is_keyword(word: &str) -> bool {
    STATEMENTS.contains(&word)
        || QUALIFIERS.contains(&word)
        || matches!(word, "struct" | "precision" | "true" | "false")
        || Type::from_name(word).is_some()
}

/// All words with a meaning of their own in a language: keywords, and names of types.
pub(crate) fn all(language: &Language) -> Vec<String> {
    let words = Words::new(language);
    let keywords = STATEMENTS.iter().chain(QUALIFIERS).chain(&["struct", "precision", "true", "false"]);
    let mut all: Vec<String> = keywords.map(|word| (*word).to_owned()).collect();
    let parts = |text: &'static str| text.split(' ');
    all.extend(parts("void bool int uint float double atomic_uint").map(str::to_owned));
    for prefix in ["", "b", "i", "u", "d"] {
        all.extend(parts("vec2 vec3 vec4").map(|name| format!("{prefix}{name}")));
        let sizes = parts("2 3 4 2x2 2x3 2x4 3x2 3x3 3x4 4x2 4x3 4x4");
        all.extend(sizes.map(|size| format!("{prefix}mat{size}")));
        for (kind, dimension) in
            ["sampler", "image"].iter().flat_map(|k| parts("1D 2D 3D Cube 2DRect Buffer").map(move |d| (k, d)))
        {
            let ends = parts("MS MSArray Array Shadow ArrayShadow").chain([""]);
            all.extend(ends.map(|end| format!("{prefix}{kind}{dimension}{end}")));
        }
    }
    for (kind, long, bits) in [("f", "float", "16 32 64"), ("i", "int", "8 16 32 64"), ("u", "uint", "8 16 32 64")] {
        for bits in parts(bits) {
            all.push(format!("{long}{bits}_t"));
            all.extend(parts("vec2 vec3 vec4").map(|vector| format!("{kind}{bits}{vector}")));
            let sizes = parts("2 3 4 2x2 2x3 2x4 3x2 3x3 3x4 4x2 4x3 4x4").filter(|_| kind == "f");
            all.extend(sizes.map(|size| format!("{kind}{bits}mat{size}")));
        }
    }
    all.retain(|word| is_keyword(word) && !words.is_late(word));
    all
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
