//! Shaders without `#version`: hosts often put a version, and more, in front of a text.

use base::text::SourceFile;
use syntax::{Parsed, Profile, Shader, Stage, Version, errors};

use crate::open;

/// What a host may state, the oldest first.
const STATED: [(u32, Profile); 5] = [
    (100, Profile::Es),
    (120, Profile::Compatibility),
    (330, Profile::Core),
    (300, Profile::Es),
    (460, Profile::Compatibility),
];

/// Reads a shader. One without `#version` is GLSL 1.10, unless it uses what came later and a host that puts
/// another version in front of it leaves fewer errors: then it is read as such, and names may be declared in
/// front as well.
pub fn read(file: &SourceFile, stage: Stage) -> Parsed {
    read_as(file, stage, false)
}

/// The same for a host that knows OpenGL ES alone, where `es` says so.
pub fn read_as(file: &SourceFile, stage: Stage, es: bool) -> Parsed {
    let oldest = Version { number: 100, profile: Profile::Es, span: None };
    let es = es && !file.text().contains("#version");
    let plain = if es { Shader::parse_behind(file, stage, oldest) } else { Shader::parse(file, stage) };
    let later = [errors::NEEDS_VERSION, errors::EXTENSION, errors::FLOAT_SUFFIX];
    if plain.shader.version().span.is_some() || !plain.diagnostics.iter().any(|d| later.contains(&d.code)) {
        return plain;
    }
    // Names that are not declared say nothing about the version.
    let weight = |p: &Parsed| p.diagnostics.iter().filter(|d| !open::is_name(d.code)).count();
    let mut best = plain;
    for (number, profile) in STATED.into_iter().filter(|(_, profile)| !es || *profile == Profile::Es) {
        let before = Version { number, profile, span: None };
        let parsed = Shader::parse_behind(file, stage, before);
        if weight(&parsed) < weight(&best) {
            best = parsed;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reported(stage: Stage, text: &str) -> Vec<String> {
        let parsed = read(&SourceFile::new("a", text), stage);
        parsed.diagnostics.iter().map(|d| format!("{} {}", d.code, d.message)).collect()
    }

    #[test]
    fn a_version_that_the_host_puts_in_front_is_found_out() {
        let modern = "in vec3 n;\nout vec4 c;\nuniform sampler2D t;\n\
            void main() { float h = 1.0f; h += 1; c = texture(t, n.xy) * h * TINT; }\n";
        assert_eq!(reported(Stage::Fragment, modern), [""; 0]);
        let embedded =
            "precision mediump float;\nvarying vec2 uv;\nvoid main() { gl_FragColor = vec4(uv, 0.0, 1.0); }\n";
        assert_eq!(reported(Stage::Fragment, embedded), [""; 0]);
        let blocks = "layout(std430, binding = 0) buffer B { float v[]; };\nlayout(local_size_x = 64) in;\n\
            void main() { v[gl_GlobalInvocationID.x] *= 2; }\n";
        assert_eq!(reported(Stage::Compute, blocks), [""; 0]);
    }

    #[test]
    fn a_host_of_opengl_es_leaves_its_versions() {
        let file = |text: &str| SourceFile::new("a", text);
        let codes = |text: &str| -> Vec<&str> {
            read_as(&file(text), Stage::Fragment, true).diagnostics.iter().map(|d| d.code.0).collect()
        };
        let text = "precision highp float;\nin vec2 uv;\nout vec4 c;\nvoid main() { vec4 sample = vec4(uv, 0.0, 1.0); c = sample; }\n";
        assert_eq!(codes(text)[0], "V002");
        assert!(read(&file(text), Stage::Fragment).diagnostics.is_empty(), "OpenGL 3.30 has it");
        assert_eq!(codes("precision highp float;\nvoid main() { gl_FragColor = vec4(2 * 1.5); }\n"), ["T006"]);
        let stated = "#version 300 es\nprecision highp float;\nvoid main() { gl_FragColor = vec4(1.0); }\n";
        assert_eq!(codes(stated), ["E020"], "what is stated is believed");
    }

    #[test]
    fn what_is_wrong_in_every_version_is_reported() {
        let wrong = "in vec3 n;\nout vec4 c;\nvoid main() { c = n; }\n";
        assert_eq!(reported(Stage::Fragment, wrong).len(), 1);
        let old = "varying vec3 n;\nvoid main() { gl_FragColor = vec4(m, 1.0); }\n";
        assert_eq!(reported(Stage::Fragment, old).len(), 1);
        // Nothing here came later than 1.10, which has no such conversion.
        let converted = "varying float x;\nvoid main() { gl_FragColor = vec4(x * 2); }\n";
        assert_eq!(reported(Stage::Fragment, converted).len(), 1);
        // A version that is stated is believed.
        let stated = "#version 110\nvoid main() { gl_FragColor = vec4(1.0f); }\n";
        assert_eq!(reported(Stage::Fragment, stated).len(), 1);
    }
}
