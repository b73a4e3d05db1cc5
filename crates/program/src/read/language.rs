//! Languages in which shaders are written.

use base::text::SourceFile;

use syntax::wgsl::tokens;

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

    /// By the name of a file. Vulkan's GLSL has files called `.slang` as well, which begin with their version.
    pub fn of(file: &SourceFile) -> Self {
        match Self::of_path(file.name()) {
            Self::Slang if file.text().lines().any(|line| line.trim_start().starts_with("#version ")) => Self::Glsl,
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

    /// The language that a text looks like whose own language refuses it, by declarations that no other has.
    pub fn guessed(text: &str) -> Option<Self> {
        let all = tokens(text);
        let word = |k: usize| all.get(k).map_or("", |token| &text[token.span.range()]);
        (0..all.len()).find_map(|k| match (word(k), word(k + 1), word(k + 2)) {
            ("#", "version", _) | ("void", "main", "(") => Some(Self::Glsl),
            ("@", "vertex" | "fragment" | "compute" | "group" | "builtin", _) => Some(Self::Wgsl),
            ("cbuffer" | "float4x4" | "float3x3", _, _) | ("numthreads", "(", _) => Some(Self::Hlsl),
            ("float2" | "float3" | "float4", name, _) if name.starts_with(|c: char| c.is_alphabetic()) => {
                Some(Self::Hlsl)
            }
            ("fn", name, "(") if name.starts_with(|c: char| c.is_alphabetic() || c == '_') => Some(Self::Wgsl),
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_tells_its_language() {
        assert_eq!(Written::guessed("// fn f(\n#version 330\n"), Some(Written::Glsl));
        assert_eq!(Written::guessed("void main() {}"), Some(Written::Glsl));
        assert_eq!(Written::guessed("fn f(x: f32) -> f32 { return x; }"), Some(Written::Wgsl));
        assert_eq!(Written::guessed("float3 f(float3 x) { return x; }"), Some(Written::Hlsl));
        assert_eq!(Written::guessed("float f(float x) { return x; }"), None);
    }
}
