//! Texts as compilers of OpenGL ES read them: phones, and browsers.
//!
//! Rules about precisions see this reading alone, and `fuzz`, `tune` and `improve` run it.

use base::diagnostic::Severity;
use base::text::SourceFile;
use syntax::{Parsed, Profile, Shader, Stage, Version};

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

/// What compilers define that have `highp` in fragment stages, and a name of that length which none defines.
const HIGH: [&str; 2] = ["GL_FRAGMENT_PRECISION_HIGH", "NO_FRAGMENT_PRECISION_HIGH"];

/// The text as a device reads it that has no `highp` in fragment stages, where it asks for that: places are the same.
pub fn without_highp(shader: &Shader) -> Option<Parsed> {
    let file = shader.file();
    if shader.stage() != Stage::Fragment || !file.text().contains(HIGH[0]) {
        return None;
    }
    let mut defines = vec![("GL_ES".to_owned(), "1".to_owned())];
    defines.extend(shader.defines().iter().filter(|(name, _)| name != "GL_ES").cloned());
    let text = SourceFile::new(file.name(), file.text().replace(HIGH[0], HIGH[1]));
    let parsed = Shader::parse_with(&text, shader.stage(), &defines);
    parsed.shader.has_precisions().then_some(parsed)
}

/// The same for commands that run shaders: none where the text does not hold so.
pub fn reading(shader: &Shader) -> Option<Parsed> {
    let holds = |parsed: &Parsed| !parsed.diagnostics.iter().any(|d| d.severity == Severity::Error);
    let found = parsed(shader).filter(holds)?;
    // What is run is read from its text, which says its version then.
    let version = found.shader.version().clone();
    let text = (version.number > 100).then(|| syntax::stated(shader, &version));
    Some(text.map_or(found, |text| Shader::parse_with(&text, shader.stage(), shader.defines())))
}
