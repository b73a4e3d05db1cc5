//! Repairs of `lint` leave a shader that compiles: every fix of every shader of the project and of its fixtures, and of texts
//! in which words of the language mean something else.

use std::path::{Path, PathBuf};

use base::diagnostic::{Safety, Severity};
use base::text::SourceFile;
use lint::fix::fix;
use lint::{Input, Level, Selection, Settings};
use program::Program;
use program::lower::Target;
use syntax::{Shader, Stage};

use crate::binary::root;

/// Texts in which a word is a name of another kind than where a rule renames it.
const OTHER_MEANINGS: [(&str, &str); 4] = [
    // Types of GLSL for Vulkan, beside the functions of old.
    (
        "separate.frag",
        "#version 450\nlayout(set = 0, binding = 0) uniform texture2D image;\nlayout(set = 0, binding = 1) uniform sampler s;\n\
         layout(location = 0) in vec2 uv;\nlayout(location = 0) out vec4 c;\n\
         vec4 at(texture2D t, vec2 p) { return texture(sampler2D(t, s), p); }\nvoid main() { c = at(image, uv); }\n",
    ),
    (
        "separate.comp",
        "#version 460\nlayout(local_size_x = 8) in;\nlayout(set = 0, binding = 0) uniform texture3D grid;\n\
         layout(set = 0, binding = 1) buffer D { float d[]; };\nfloat at(texture3D t, ivec3 p) { return texelFetch(t, p, 0).x; }\n\
         void main() { d[gl_LocalInvocationID.x] = at(grid, ivec3(0)); }\n",
    ),
    // Members and parameters with the names of old functions and types of another language.
    (
        "members.frag",
        "#version 330 core\nstruct Layer { float texture2D; float lerp; };\nuniform Layer layer;\nout vec4 c;\n\
         float frac(float saturate) { return fract(saturate); }\nvoid main() { c = vec4(layer.texture2D, layer.lerp, frac(2.5), 1.0); }\n",
    ),
    (
        "macros.frag",
        "#version 330 core\n#define lerp mix\n#define float3 vec3\nin vec3 n;\nout vec4 c;\n\
         void main() { float3 a = lerp(n, float3(1.0), 0.5); c = vec4(a, 1.0); }\n",
    ),
];

/// Errors of a shader, and whether it can be translated as a stage.
fn state(name: &str, text: &str) -> (usize, bool) {
    let stage = Stage::from_path(name).unwrap_or(Stage::Library);
    let parsed = Shader::parse(&SourceFile::new(name, text), stage);
    let errors = parsed.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    (errors, errors == 0 && Program::build(&parsed.shader, &Target::Stage).is_ok())
}

/// Fixes a text up to a safety, and holds it against what it was; gives whether anything was fixed.
fn repaired(name: &str, text: &str, up_to: Safety) -> bool {
    let inputs = [Input::new(SourceFile::new(name, text))];
    let settings = Settings { selection: Selection::default().at(Level::Heuristic), ..Settings::default() };
    let outcome = fix(&inputs, &settings, up_to);
    let Some(file) = outcome.files.first() else { return false };
    let (before, after) = (state(name, text), state(name, file.after.text()));
    assert!(after.0 <= before.0, "{name}: {} errors after, {} before\n{}", after.0, before.0, file.after.text());
    assert!(after.1 || !before.1, "{name} cannot be translated any more\n{}", file.after.text());
    true
}

fn shaders_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let ending = path.extension().map(|e| e.to_string_lossy().into_owned()).unwrap_or_default();
        if path.is_dir() {
            shaders_below(&path, found);
        } else if ["vert", "frag", "geom", "comp", "tesc", "tese", "glsl"].contains(&ending.as_str()) {
            found.push(path);
        }
    }
}

#[test]
fn every_fix_leaves_a_shader_that_compiles() {
    let mut files = Vec::new();
    for folder in ["fixtures", "shaders"] {
        shaders_below(&root().join(folder), &mut files);
    }
    let mut fixed = 0;
    for path in &files {
        let Ok(text) = std::fs::read_to_string(path) else { continue };
        let name = path.strip_prefix(root()).unwrap().display().to_string();
        for safety in [Safety::Safe, Safety::Unsafe] {
            fixed += usize::from(repaired(&name, &text, safety));
        }
    }
    assert!(files.len() > 100 && fixed > 10, "{} files, {fixed} fixed", files.len());
}

#[test]
fn words_with_another_meaning_are_not_renamed() {
    for (name, text) in OTHER_MEANINGS {
        let (errors, _) = state(name, text);
        assert_eq!(errors, 0, "{name}");
        repaired(name, text, Safety::Unsafe);
    }
    // What is checked can fail: this is what renaming the type does.
    let (name, text) = OTHER_MEANINGS[0];
    assert!(state(name, text).1 && !state(name, &text.replace("texture2D", "texture")).1);
}
