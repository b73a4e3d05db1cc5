//! What a file is written in, by its name.

use base::text::SourceFile;
use syntax::Stage;

use crate::marks::{self, stage_of_file};
use crate::paths::extension;
use crate::script::SCRIPT_EXTENSIONS;

/// Endings of shader files that a folder is searched for.
pub const SHADER_EXTENSIONS: &[&str] = &[
    "vert",
    "frag",
    "geom",
    "glsl",
    "vs",
    "fs",
    "gs",
    "comp",
    "tesc",
    "tese",
    "tcs",
    "tes",
    "vsh",
    "fsh",
    "gsh",
    "csh",
    "vertexshader",
    "fragmentshader",
    "geometryshader",
    "vshader",
    "fshader",
    "gshader",
    "glslv",
    "glslf",
    "glslg",
    "vp",
    "fp",
    "cont",
    "eval",
    "rgen",
    "rint",
    "rahit",
    "rchit",
    "rmiss",
    "rcall",
    "shader",
    "wgsl",
    "wesl",
];

/// Endings of host files that a folder is searched for.
pub const HOST_EXTENSIONS: &[&str] = &["cpp", "cc", "cxx", "c", "h", "hpp", "hxx", "hh"];

/// What a file is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// GLSL, of this stage.
    Shader(Stage),
    /// WGSL.
    Wgsl,
    /// C or C++.
    Host,
    /// A language whose strings may be shaders.
    Script,
}

/// The language that a file's name says; none when it says neither shader nor C or C++.
pub fn language_of(name: &str) -> Option<Language> {
    let ending = extension(name).to_ascii_lowercase();
    if HOST_EXTENSIONS.contains(&ending.as_str()) {
        return Some(Language::Host);
    }
    if SCRIPT_EXTENSIONS.contains(&ending.as_str()) {
        return Some(Language::Script);
    }
    if ["wgsl", "wesl"].contains(&ending.as_str()) {
        return Some(Language::Wgsl);
    }
    // Several shaders in one file; the ending says no stage.
    let stage = if ending == "shader" { Some(Stage::Library) } else { Stage::from_path(name) };
    stage.map(Language::Shader)
}

/// The same of a file, whose text may be WGSL where its name says GLSL.
pub fn language_of_file(file: &SourceFile) -> Option<Language> {
    let named = language_of(file.name());
    let is_wgsl = matches!(named, Some(Language::Shader(_))) && syntax::is_wgsl(file.text());
    if is_wgsl { Some(Language::Wgsl) } else { named }
}

/// The stage of a shader's file: what its ending says, or else what its text uses, or a word of its name. A library when
/// nothing says it; none for a file that is no shader.
pub fn stage_of(file: &SourceFile) -> Option<Stage> {
    let Some(Language::Shader(stage)) = language_of_file(file) else { return None };
    let told = || stage_of_file(file.name(), file.text()).unwrap_or(Stage::Library);
    match stage {
        Stage::Library => Some(told()),
        // `cs` in a name may mean another thing: what has no work group and the marks of another stage is of that.
        Stage::Compute => Some(marks::stage(file.text()).ok().flatten().unwrap_or(stage)),
        stage => Some(stage),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_give_the_language() {
        assert_eq!(language_of("a/b.vert"), Some(Language::Shader(Stage::Vertex)));
        assert_eq!(language_of("b.CPP"), Some(Language::Host));
        assert_eq!(language_of("README.md"), None);
        assert_eq!(language_of(".h"), None);
        assert_eq!(language_of("vert"), None);
    }
}
