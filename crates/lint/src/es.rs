//! Texts as compilers of OpenGL ES read them: phones, and browsers.

use base::diagnostic::Severity;
use syntax::{Parsed, Profile, Shader, Version};

use crate::conditions;

/// The text read as OpenGL ES, where it names no version, asks whether it is read so, and states precisions then: as 1.00, or
/// as 3.00 where that leaves fewer errors.
pub fn parsed(shader: &Shader) -> Option<Parsed> {
    let mut defines = conditions::of_es(shader)?;
    defines.extend(shader.defines().iter().cloned());
    let (file, stage) = (shader.file(), shader.stage());
    let errors = |parsed: &Parsed| parsed.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    let mut best = Shader::parse_with(file, stage, &defines);
    if errors(&best) > 0 && defines.len() == 1 {
        let later = Shader::parse_behind(file, stage, Version { number: 300, profile: Profile::Es, span: None });
        if errors(&later) < errors(&best) {
            best = later;
        }
    }
    best.shader.has_precisions().then_some(best)
}

/// The same for commands that run shaders: none where the text does not hold so.
pub fn reading(shader: &Shader) -> Option<Parsed> {
    let holds = |parsed: &Parsed| !parsed.diagnostics.iter().any(|d| d.severity == Severity::Error);
    parsed(shader).filter(holds)
}
