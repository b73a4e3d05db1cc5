//! A version for a text that states none.

use super::preprocess::InFront;
use super::{Parsed, Profile, Shader, Stage, Version, errors};
use base::diagnostic::Severity;
use base::text::{Assembly, SourceFile, Span};

/// What a host may state in front of a text, the oldest of what it may use first.
const STATED: [(u32, Profile); 9] = [
    (100, Profile::Es),
    (120, Profile::Compatibility),
    (130, Profile::Compatibility),
    (150, Profile::Core),
    (330, Profile::Core),
    (300, Profile::Es),
    (430, Profile::Core),
    (310, Profile::Es),
    (460, Profile::Compatibility),
];

/// True for a version that has a stage: no earlier one has compute stages.
fn has(version: &Version, stage: Stage) -> bool {
    stage != Stage::Compute || version.number >= if version.profile == Profile::Es { 310 } else { 430 }
}

/// What a host may state in front of a text of this stage.
fn stated_for(stage: Stage) -> impl Iterator<Item = Version> {
    let versions = STATED.into_iter().map(|(number, profile)| Version { number, profile, span: None });
    versions.filter(move |version| has(version, stage))
}

impl Shader {
    /// Reads a text as its host is taken to compile it. One without `#version` is GLSL 1.10, unless it uses what came later
    /// and a host that puts another version in front of it leaves fewer errors: then it is read as such. A host that knows OpenGL ES alone states its versions, where `es` says so.
    pub fn parse_fitting(file: &SourceFile, stage: Stage, defines: &[(String, String)], es: bool) -> Parsed {
        let before = |version| InFront { version, names: false };
        let oldest = || before(Version { number: 100, profile: Profile::Es, span: None });
        let es = es && !file.text().contains("#version");
        let plain = Self::read(file, stage, (defines, &[]), es.then(oldest));
        let later = [errors::NEEDS_VERSION, errors::EXTENSION, errors::FLOAT_SUFFIX];
        if plain.shader.version().span.is_some() || !plain.diagnostics.iter().any(|d| later.contains(&d.code)) {
            return plain;
        }
        // Names that are not declared say nothing about the version, but those that other versions of the language have.
        let weight = |p: &Parsed| p.diagnostics.iter().filter(|d| !errors::is_name(d.code)).count() + p.shader.absent();
        let mut best = plain;
        for version in stated_for(stage).filter(|version| !es || version.profile == Profile::Es) {
            let parsed = Self::read(file, stage, (defines, &[]), Some(before(version)));
            if weight(&parsed) < weight(&best) {
                best = parsed;
            }
        }
        best
    }
}

/// The text under a version in which it is in order, for whoever compiles it: as it is where it states one, or is in order
/// as GLSL 1.10, which it is without one; else under `first`, under that which it is read as, or under the first that a host
/// may state, with the fewest errors.
pub fn fitting(
    file: &SourceFile,
    stage: Stage,
    defines: &[(String, String)],
    first: impl FnOnce() -> Option<Version>,
) -> SourceFile {
    let errors = |p: &Parsed| p.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    let plain = Shader::parse_with(file, stage, defines);
    if plain.shader.version().span.is_some() || errors(&plain) == 0 {
        return file.clone();
    }
    let read = Shader::parse_fitting(file, stage, defines, false).shader.version().clone();
    let (mut best, mut least) = (file.clone(), errors(&plain));
    let proposed = first().into_iter().chain([read]).filter(|version| has(version, stage));
    for version in proposed.chain(stated_for(stage)) {
        let text = stated(&plain.shader, &version);
        let found = errors(&Shader::parse_with(&text, stage, defines));
        if found < least {
            (best, least) = (text, found);
        }
    }
    best
}

/// The text of a shader under another version. Positions lead back to the file.
pub fn stated(shader: &Shader, version: &Version) -> SourceFile {
    let number = version.number;
    let line = match version.profile {
        Profile::Core => format!("#version {number}\n"),
        Profile::Compatibility if number < 150 => format!("#version {number}\n"),
        Profile::Compatibility => format!("#version {number} compatibility\n"),
        Profile::Es if number == 100 => "#version 100\n".to_owned(),
        Profile::Es => format!("#version {number} es\n"),
    };
    let file = shader.file();
    let mut assembly = Assembly::new();
    assembly.insert(&line, file, 0);
    let end = shader.version().span.map_or(0, |s| s.end);
    assembly.copy(file, Span::new(end, file.text().len()));
    assembly.finish(file.name())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn version(text: &str, stage: Stage, first: Option<(u32, Profile)>) -> String {
        let file = SourceFile::new("a", text);
        let first = || first.map(|(number, profile)| Version { number, profile, span: None });
        let fitted = fitting(&file, stage, &[], first);
        let whole = fitted.text().strip_suffix(text).unwrap_or_else(|| panic!("{}", fitted.text()));
        assert_eq!(fitted.locate(fitted.text().len()), file.locate(text.len()));
        whole.trim_end().to_owned()
    }

    #[test]
    fn the_version_follows_from_what_is_used() {
        let vertex = |text: &str| version(text, Stage::Vertex, None);
        assert_eq!(vertex("attribute vec4 p; void main() { gl_Position = p; }"), "", "it is in order as it is");
        assert_eq!(vertex("#version 330\nin vec4 p; void main() { gl_Position = p * q; }"), "", "it states one");
        assert_eq!(vertex("in vec4 p; out vec4 q; void main() { q = p; gl_Position = p; }"), "#version 130");
        let block = "in vec4 p; layout(std140) uniform B { mat4 m; }; void main() { gl_Position = m * p; }";
        assert_eq!(vertex(block), "#version 150");
        assert_eq!(vertex("layout(location = 0) in vec4 p; void main() { gl_Position = p; }"), "#version 330");
        let buffer = "layout(std430, binding = 0) buffer B { vec4 p; }; void main() { gl_Position = p; }";
        assert_eq!(vertex(buffer), "#version 430");
        let library = "float f(float x) { return x * 2 + 1.0f; }";
        assert_eq!(version(library, Stage::Library, None), "#version 120");
    }

    #[test]
    fn compute_stages_have_a_version_that_has_them() {
        let text = "layout(FORMAT) writeonly uniform HINT image2D t;\nuniform mediump sampler2D s;\n\
                    layout(local_size_x = 8) in;\nvoid main() { vec4 c = texelFetch(s, ivec2(0), 0); }\n";
        assert_eq!(version(text, Stage::Compute, None), "#version 430");
        assert_eq!(version(text, Stage::Compute, Some((100, Profile::Es))), "#version 430");
        assert_eq!(version(text, Stage::Compute, Some((310, Profile::Es))), "#version 310 es");
    }

    #[test]
    fn a_version_that_is_proposed_comes_first() {
        let text = "in vec4 p; out vec4 q; void main() { q = p; gl_Position = p; }";
        assert_eq!(version(text, Stage::Vertex, Some((450, Profile::Core))), "#version 450");
        // What it does not have is no reason to take it.
        let text = "layout(location = 0) in vec4 p; void main() { gl_Position = p; }";
        assert_eq!(version(text, Stage::Vertex, Some((150, Profile::Core))), "#version 330");
    }

    fn reported(stage: Stage, text: &str) -> Vec<String> {
        let parsed = Shader::parse_fitting(&SourceFile::new("a", text), stage, &[], false);
        parsed.diagnostics.iter().map(|d| format!("{} {}", d.code, d.message)).collect()
    }

    #[test]
    fn a_version_that_the_host_puts_in_front_is_found_out() {
        let modern = "in vec3 n;\nout vec4 c;\nuniform sampler2D t;\n\
            void main() { float h = 1.0f; h += 1; c = texture(t, n.xy) * h * TINT; }\n";
        assert_eq!(reported(Stage::Fragment, modern), ["E020 `TINT` is not declared"], "names are told in any version");
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
            Shader::parse_fitting(&file(text), Stage::Fragment, &[], true)
                .diagnostics
                .iter()
                .map(|d| d.code.0)
                .collect()
        };
        let text = "precision highp float;\nin vec2 uv;\nout vec4 c;\nvoid main() { vec4 sample = vec4(uv, 0.0, 1.0); c = sample; }\n";
        assert_eq!(codes(text)[0], "V002");
        assert!(
            Shader::parse_fitting(&file(text), Stage::Fragment, &[], false).diagnostics.is_empty(),
            "OpenGL 3.30 has it"
        );
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
