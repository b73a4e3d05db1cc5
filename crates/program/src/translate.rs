//! Translation of a program to the languages that naga writes, without coordinate flips.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

use naga::back::{glsl, hlsl, msl, spv, wgsl};
use naga::compact::KeepUnused;
use naga::proc::BoundsCheckPolicies;
use naga::valid::ModuleInfo;
use naga::{Module, ShaderStage};
use thiserror::Error;

use super::strides::{self, Gaps};
use super::{Entry, Program, ProgramError, capabilities, contain, lacks, readback, supply, validate, validator};
use crate::lower::Role;

/// A target language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Language {
    /// SPIR-V 1.1, binary.
    SpirV,
    /// WGSL.
    Wgsl,
    /// GLSL 3.30 core.
    Glsl330,
    /// GLSL 4.50 core.
    Glsl450,
    /// GLSL ES 3.10.
    GlslEs310,
    /// Metal Shading Language 2.0.
    Msl,
    /// HLSL, shader model 5.1.
    Hlsl,
    /// The author's own text in the dialect of naga's GLSL reader, which is compared as a front end: nothing is
    /// translated to it.
    NagaGlsl,
}

impl Language {
    /// All languages that programs are translated to.
    pub const ALL: [Self; 7] =
        [Self::SpirV, Self::Wgsl, Self::Glsl330, Self::Glsl450, Self::GlslEs310, Self::Msl, Self::Hlsl];

    /// Those that are read back, by naga or as GLSL by our own front end.
    pub const READ_BACK: [Self; 5] = [Self::SpirV, Self::Wgsl, Self::Glsl330, Self::Glsl450, Self::GlslEs310];

    /// Those in which suites compare their shaders: the others are the same text with fewer words.
    pub const READABLE: [Self; 3] = [Self::SpirV, Self::Wgsl, Self::Glsl450];

    /// True for the versions of GLSL, which have no groups of bindings.
    pub fn is_glsl(self) -> bool {
        matches!(self, Self::Glsl330 | Self::Glsl450 | Self::GlslEs310)
    }

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::SpirV => "spirv",
            Self::Wgsl => "wgsl",
            Self::Glsl330 => "glsl330",
            Self::Glsl450 => "glsl450",
            Self::GlslEs310 => "glsl-es310",
            Self::Msl => "msl",
            Self::Hlsl => "hlsl",
            Self::NagaGlsl => "naga-glsl",
        }
    }
}

impl fmt::Display for Language {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Language {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        // `glsl` alone means the version nearest to what people write by hand for the desktop.
        if text == "glsl" {
            return Ok(Self::Glsl330);
        }
        Self::ALL.into_iter().find(|l| l.name() == text).ok_or_else(|| {
            let names: Vec<&str> = Self::ALL.iter().map(|l| l.name()).collect();
            format!("unknown language `{text}`; known are {} and glsl (for glsl330)", names.join(", "))
        })
    }
}

/// A translated program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Translation {
    /// Words of a SPIR-V module.
    Words(Vec<u32>),
    /// Text in any other language.
    Text(String),
}

impl Translation {
    /// The bytes of a file: SPIR-V in little endian, text in UTF-8.
    pub fn into_bytes(self) -> Vec<u8> {
        match self {
            Self::Words(words) => words.into_iter().flat_map(u32::to_le_bytes).collect(),
            Self::Text(text) => text.into_bytes(),
        }
    }
}

/// Why there is no translation.
#[derive(Debug, Error)]
pub enum TranslateError {
    /// The language cannot express the program.
    #[error("{language} cannot express this shader: {reason}")]
    Inexpressible {
        /// Language of the translation.
        language: Language,
        /// What naga says.
        reason: String,
    },
    /// It is not read back.
    #[error("{}: {reason}", unread(*language))]
    ReadBack {
        /// Language of the translation.
        language: Language,
        /// What naga says.
        reason: String,
    },
    /// The translation takes or gives something else than the shader.
    #[error("the {language} translation has another interface: {reason}")]
    Interface {
        /// Language of the translation.
        language: Language,
        /// What differs.
        reason: String,
    },
    /// There is nothing to translate.
    #[error(transparent)]
    Program(#[from] ProgramError),
}

impl Program {
    /// Translates the program. A vertex stage stays a vertex stage. A geometry or tessellation stage and a function
    /// have no counterpart in naga: what is translated is the compute kernel that runs them.
    ///
    /// # Errors
    /// [`TranslateError`]: what the language lacks.
    pub fn translate(&self, language: Language) -> Result<Translation, TranslateError> {
        if language == Language::NagaGlsl {
            let inexpressible = |reason| TranslateError::Inexpressible { language, reason };
            return self.in_dialect().map(|edited| Translation::Text(edited.text)).map_err(inexpressible);
        }
        if let Some(what) = &self.untranslatable {
            return Err(ProgramError::Source(vec![(**what).clone()]).into());
        }
        match self.role {
            Role::Vertex | Role::Fragment | Role::Compute => {
                let host = self.stage_module.as_deref();
                let (module, info) = host.map_or((&self.module, &self.info), |(module, info)| (module, info));
                let padded = match (language, self.entry) {
                    (Language::Wgsl, Entry::Point(index)) => strides::natural(module, index, Gaps::Nobody)?,
                    (Language::Msl, Entry::Point(index)) => strides::natural(module, index, Gaps::Writer)?,
                    _ => None,
                };
                let (module, info) = padded.as_ref().map_or((module, info), |(module, info)| (module, info));
                let stage = match self.role {
                    Role::Vertex => ShaderStage::Vertex,
                    Role::Fragment => ShaderStage::Fragment,
                    _ => ShaderStage::Compute,
                };
                let narrowed = match language {
                    Language::Wgsl | Language::GlslEs310 => lacks::narrowed(module, info, stage),
                    _ => None,
                };
                let (module, info) = narrowed.as_ref().map_or((module, info), |(module, info)| (module, info));
                if let Some(reason) = lacks::lacks(module, info, stage, language) {
                    return Err(TranslateError::Inexpressible { language, reason });
                }
                translate(module, info, stage, language)
            }
            Role::Geometry(_) | Role::Function { .. } => {
                // Storage blocks stay what a host binds.
                let mut module = Self { memory: Vec::new(), ..self.clone() }.compute_kernel()?.module;
                // What the kernel has taken over is left without use, `main` of a library for one.
                naga::compact::compact(&mut module, KeepUnused::No);
                let info = validate(&module)?;
                translate(&module, &info, ShaderStage::Compute, language)
            }
        }
    }
}

fn translate(
    module: &Module,
    info: &ModuleInfo,
    stage: ShaderStage,
    language: Language,
) -> Result<Translation, TranslateError> {
    let fails = |reason: String| TranslateError::Inexpressible { language, reason };
    let supplied = supply::supplied(module, info, language)?;
    let (module, info) = supplied.as_ref().map_or((module, info), |(module, info)| (module, info));
    contain(|| match language {
        Language::SpirV => spirv(module, info).map(Translation::Words),
        Language::Wgsl => wgsl_text(module, info),
        Language::Glsl330 => glsl_text(module, info, stage, glsl::Version::Desktop(330)),
        Language::Glsl450 => glsl_text(module, info, stage, glsl::Version::Desktop(450)),
        Language::GlslEs310 => {
            let version = glsl::Version::Embedded { version: 310, is_webgl: false };
            glsl_text(module, info, stage, version)
        }
        Language::Msl => msl_text(module, info),
        Language::Hlsl => {
            let mut text = String::new();
            let options = hlsl::Options::default();
            let pipeline = hlsl::PipelineOptions::default();
            hlsl::Writer::new(&mut text, &options, &pipeline).write(module, info, None).map_err(|e| e.to_string())?;
            Ok(Translation::Text(text))
        }
        Language::NagaGlsl => Err("a module has no text of its author's".to_owned()),
    })
    .map_err(|panic| fails(format!("naga panicked: {panic}")))?
    .map_err(fails)
}

fn spirv(module: &Module, info: &ModuleInfo) -> Result<Vec<u32>, String> {
    // No coordinate flip: `gl_Position` is the author's. Names stay, so that people can read it.
    let options = spv::Options { lang_version: (1, 1), flags: spv::WriterFlags::DEBUG, ..spv::Options::default() };
    spv::write_vec(module, info, &options, None).map(capabilities::declared).map_err(|e| e.to_string())
}

fn wgsl_text(module: &Module, info: &ModuleInfo) -> Result<Translation, String> {
    let text = wgsl::write_string(module, info, wgsl::WriterFlags::empty()).map_err(|e| e.to_string())?;
    // Where neighbours take other branches, GLSL has a derivative undefined, and WGSL refuses it unless it is told so.
    let reported = if lacks::derives_in_branches(module) { "diagnostic(off, derivative_uniformity);\n" } else { "" };
    Ok(Translation::Text(format!("{reported}{text}")))
}

fn msl_text(module: &Module, info: &ModuleInfo) -> Result<Translation, String> {
    // Buffers keep the numbers that they have elsewhere; the sizes that naga asks for come behind them.
    let bindings: Vec<_> = module.global_variables.iter().filter_map(|(_, v)| v.binding).collect();
    let index = |binding: u32| u8::try_from(binding).map_err(|_| format!("there is no buffer {binding}"));
    let mut resources = msl::EntryPointResources::default();
    for binding in &bindings {
        let target =
            msl::BindTarget { buffer: Some(index(binding.binding)?), mutable: true, ..msl::BindTarget::default() };
        resources.resources.insert(*binding, target);
    }
    let behind = bindings.iter().map(|b| b.binding + 1).max().unwrap_or(0);
    resources.sizes_buffer = Some(index(behind)?);
    let options = msl::Options {
        lang_version: (2, 0),
        per_entry_point_map: module.entry_points.iter().map(|e| (e.name.clone(), resources.clone())).collect(),
        fake_missing_bindings: false,
        ..msl::Options::default()
    };
    msl::write_string(module, info, &options, &msl::PipelineOptions::default())
        .map(|(text, _)| Translation::Text(text))
        .map_err(|e| e.to_string())
}

fn glsl_text(
    module: &Module,
    info: &ModuleInfo,
    stage: ShaderStage,
    version: glsl::Version,
) -> Result<Translation, String> {
    let entry = module.entry_points.iter().find(|e| e.stage == stage).ok_or("there is no entry point")?;
    // Without explicit bindings, GLSL 4.50 blocks all stand at binding 0. Older versions drop the numbers.
    let bound = module.global_variables.iter().filter_map(|(_, v)| v.binding);
    let binding_map = bound.filter_map(|b| Some((b, u8::try_from(b.binding).ok()?))).collect();
    let options =
        glsl::Options { version, writer_flags: glsl::WriterFlags::empty(), binding_map, ..glsl::Options::default() };
    let pipeline = glsl::PipelineOptions { shader_stage: stage, entry_point: entry.name.clone(), multiview: None };
    let mut text = String::new();
    glsl::Writer::new(&mut text, module, info, &options, &pipeline, BoundsCheckPolicies::default())
        .map_err(|e| glsl_reason(&e))?
        .write()
        .map_err(|e| glsl_reason(&e))?;
    Ok(Translation::Text(mended(text)))
}

/// Extensions by their right names, and those that the writer leaves out.
fn mended(text: String) -> String {
    let text = text.replace("#extension ARB_", "#extension GL_ARB_");
    let (mut draw, mut out) = (false, text.clone());
    for name in ["gl_DrawID", "gl_BaseVertex", "gl_BaseInstance"] {
        // Before GLSL 4.60 they are those of GL_ARB_shader_draw_parameters.
        draw |= text.contains(name);
        out = out.replace(name, &format!("{name}ARB")).replace("ARBARB", "ARB");
    }
    match out.split_once('\n') {
        Some((version, rest)) if draw => {
            format!("{version}\n#extension GL_ARB_shader_draw_parameters : require\n{rest}")
        }
        _ => out,
    }
}

/// What a version of GLSL lacks, in words.
fn glsl_reason(error: &glsl::Error) -> String {
    let glsl::Error::MissingFeatures(missing) = error else { return error.to_string() };
    let names = missing.iter_names().map(|(name, _)| name.to_lowercase().replace('_', " "));
    format!("it lacks {}", names.collect::<Vec<_>>().join(", "))
}

/// Reads a translation back: SPIR-V and WGSL by naga, GLSL by our own front end. `None` for the others.
///
/// # Errors
/// [`TranslateError::ReadBack`] when the reader refuses what was written.
pub fn read_back(translation: &Translation, language: Language, role: &Role) -> Result<Option<Module>, TranslateError> {
    let fails = |reason: String| TranslateError::ReadBack { language, reason };
    let parsed = contain(|| match (translation, language) {
        (Translation::Words(words), Language::SpirV) if capabilities::asks_for_layers(words) => Ok(None),
        (Translation::Words(words), Language::SpirV) => {
            let options = naga::front::spv::Options { adjust_coordinate_space: false, ..Default::default() };
            naga::front::spv::Frontend::new(capabilities::known_to_reader(words).into_iter(), &options)
                .parse()
                .map(Some)
                .map_err(|e| e.to_string())
        }
        (Translation::Text(text), Language::Wgsl) => {
            naga::front::wgsl::parse_str(text).map(Some).map_err(|e| e.emit_to_string(text))
        }
        (Translation::Text(text), Language::Glsl330 | Language::Glsl450 | Language::GlslEs310) => {
            readback::glsl::module(text, role).map(Some)
        }
        (Translation::Words(_) | Translation::Text(_), _) => Ok(None),
    });
    let Some(module) = parsed.map_err(|panic| fails(format!("naga panicked: {panic}")))?.map_err(fails)? else {
        return Ok(None);
    };
    contain(|| validator().validate(&module).map_err(Box::new))
        .map_err(|panic| fails(format!("naga panicked: {panic}")))?
        .map_err(|e| fails(chain(e.as_inner())))?;
    Ok(Some(module))
}

fn unread(language: Language) -> String {
    match language {
        Language::NagaGlsl => "naga's GLSL reader refuses the text".to_owned(),
        _ => format!("the {language} translation does not read back"),
    }
}

/// An error and its causes in one line. The validator's places are those of a text that nobody has seen.
pub(super) fn chain(error: &dyn std::error::Error) -> String {
    std::iter::successors(Some(error), |e| e.source()).map(ToString::to_string).collect::<Vec<_>>().join(": ")
}
