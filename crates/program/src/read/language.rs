//! Languages in which shaders are written.

use base::text::SourceFile;

/// The language of a text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Written {
    /// GLSL or GLSL ES, one stage or a library in a text.
    #[default]
    Glsl,
    /// WGSL.
    Wgsl,
    /// A binary module of SPIR-V, as the list of its instructions.
    SpirV,
    /// SPIR-V in assembly.
    SpirVAssembly,
    /// HLSL, which a compiler makes SPIR-V of.
    Hlsl,
    /// Slang, which a compiler makes SPIR-V of.
    Slang,
}

impl Written {
    /// By the ending of a name. What is not known by its ending is GLSL, whose files have any.
    pub fn of_path(name: &str) -> Self {
        let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
        match ending.to_ascii_lowercase().as_str() {
            // WESL is WGSL with imports, which are done before it is read.
            "wgsl" | "wesl" => Self::Wgsl,
            "spv" => Self::SpirV,
            "spvasm" => Self::SpirVAssembly,
            "hlsl" | "hlsli" => Self::Hlsl,
            "slang" => Self::Slang,
            _ => Self::Glsl,
        }
    }

    /// By the name of a file, and by its text. Vulkan's GLSL has files called `.slang` as well, which begin with their
    /// version, and WGSL has any ending that GLSL has.
    pub fn of(file: &SourceFile) -> Self {
        match Self::of_path(file.name()) {
            Self::Slang if file.text().lines().any(|line| line.trim_start().starts_with("#version ")) => Self::Glsl,
            Self::Glsl if syntax::is_wgsl(file.text()) => Self::Wgsl,
            written => written,
        }
    }

    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Glsl => "GLSL",
            Self::Wgsl => "WGSL",
            Self::SpirV | Self::SpirVAssembly => "SPIR-V",
            Self::Hlsl => "HLSL",
            Self::Slang => "Slang",
        }
    }

    /// True for a language that a compiler makes SPIR-V of before the text is read.
    pub fn is_compiled(self) -> bool {
        matches!(self, Self::Hlsl | Self::Slang)
    }
}
