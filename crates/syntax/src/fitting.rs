//! A version for a text that states none.

use super::{Parsed, Profile, Shader, Stage, Version};
use base::diagnostic::Severity;
use base::text::{Assembly, SourceFile, Span};

/// Versions that are tried, the oldest of each profile first.
const TRIED: [(u32, Profile); 9] = [
    (120, Profile::Compatibility),
    (130, Profile::Compatibility),
    (150, Profile::Core),
    (330, Profile::Core),
    (430, Profile::Core),
    (460, Profile::Core),
    (460, Profile::Compatibility),
    (100, Profile::Es),
    (310, Profile::Es),
];

/// The text under the version that fits: as it is where it states one, or is in order as GLSL 1.10, which it is without
/// one; else under `first`, or the first of those that are tried, with the fewest errors.
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
    let (mut best, mut least) = (file.clone(), errors(&plain));
    let tried = TRIED.map(|(number, profile)| Version { number, profile, span: None });
    // No earlier version has compute stages.
    let computes = |v: &Version| v.number >= if v.profile == Profile::Es { 310 } else { 430 };
    let fits = |v: &Version| stage != Stage::Compute || computes(v);
    for version in first().into_iter().chain(tried).filter(fits) {
        let text = stated(&plain.shader, &version);
        let found = errors(&Shader::parse_with(&text, stage, defines));
        if found < least {
            (best, least) = (text, found);
        }
    }
    best
}

/// The text of a shader under another version. Positions lead back to the file.
pub(super) fn stated(shader: &Shader, version: &Version) -> SourceFile {
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
}
