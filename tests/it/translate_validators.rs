//! Translations as the validators of Khronos see them, where they are installed.

use std::path::Path;
use std::process::Command;

use base::text::SourceFile;
use program::lower::{Role, Target};
use program::{Language, Program};
use syntax::Stage;
use test_record::not_run;

use crate::binary::say;
use crate::lowering::{UNIFORMS, names, shipped, stage};

/// Environment of `spirv-val`: Vulkan 1.1 takes SPIR-V up to 1.3.
const ENVIRONMENT: &str = "vulkan1.1";

/// How a validator is called for a file; `None` when it does not read the language.
fn command(language: Language, role: &Role, file: &Path) -> Option<Command> {
    let mut command;
    match language {
        Language::SpirV => {
            command = Command::new("spirv-val");
            command.args(["--target-env", ENVIRONMENT]);
        }
        Language::Glsl330 | Language::Glsl450 | Language::GlslEs310 => {
            command = Command::new("glslangValidator");
            command.args(["-S", if *role == Role::Vertex { "vert" } else { "comp" }]);
        }
        Language::Wgsl | Language::Msl | Language::Hlsl | Language::NagaGlsl => return None,
    }
    command.arg(file);
    Some(command)
}

/// True when the validator is there and accepts the bytes, false when it is not installed.
///
/// # Errors
/// What the validator says.
fn validate(language: Language, role: &Role, bytes: &[u8]) -> Result<bool, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("translation");
    std::fs::write(&file, bytes).unwrap();
    let Some(mut command) = command(language, role, &file) else { return Ok(false) };
    match command.output() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error.to_string()),
        Ok(output) if output.status.success() => Ok(true),
        Ok(output) => {
            Err(format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr)))
        }
    }
}

fn installed(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

fn checks(tool: &str, languages: &[Language]) {
    if !installed(tool) {
        return not_run(&format!("{tool} is not on PATH: no translation was checked by it"));
    }
    let mut done = 0;
    let uniforms = std::iter::once(("uniforms", stage("uniforms.vert", UNIFORMS)));
    for (name, case) in names().into_iter().map(|name| (name, shipped(name))).chain(uniforms) {
        let program = case.program();
        for &language in languages {
            let Ok(translation) = program.translate(language) else { continue };
            let checked = validate(language, &program.role, &translation.into_bytes());
            assert_eq!(checked, Ok(true), "{name} as {language}");
            done += 1;
        }
    }
    say(&format!("{tool}: {done} translations checked"));
    // One of each shader at the least; GLSL 3.30 alone has no compute stage.
    assert!(done >= names().len(), "{done}");
}

#[test]
fn spirv_val_accepts_every_module() {
    checks("spirv-val", &[Language::SpirV]);
}

#[test]
fn spirv_val_accepts_the_parameters_of_a_draw_and_refuses_them_undeclared() {
    if !installed("spirv-val") {
        return not_run("spirv-val is not on PATH: no module was checked by it");
    }
    let text = "#version 460 core\nlayout(location = 0) flat out int id;\n\
                void main() { id = gl_BaseVertex + gl_BaseInstance; gl_Position = vec4(0.0); }\n";
    let file = SourceFile::new("draw.vert", text);
    let program = Program::from_source(&file, Stage::Vertex, |_| Ok(Target::Stage)).unwrap();
    let words = program.translate(Language::SpirV).unwrap().into_bytes();
    assert_eq!(validate(Language::SpirV, &program.role, &words), Ok(true));
    // OpCapability DrawParameters, taken out.
    let declared = [17, 0, 2, 0, 75, 17, 0, 0];
    let at = words.windows(8).position(|w| w == declared).unwrap();
    let without = [&words[..at], &words[at + 8..]].concat();
    assert!(validate(Language::SpirV, &program.role, &without).unwrap_err().contains("DrawParameters"));
}

#[test]
fn glslang_accepts_every_glsl() {
    checks("glslangValidator", &[Language::Glsl330, Language::Glsl450, Language::GlslEs310]);
}

#[test]
fn a_broken_translation_fails_with_the_validators_words() {
    if installed("spirv-val") {
        let mut words = shipped("sphere").program().translate(Language::SpirV).unwrap().into_bytes();
        words.truncate(words.len() - 4);
        let said = validate(Language::SpirV, &Role::Vertex, &words).unwrap_err();
        assert!(said.contains("error"), "{said}");
    }
    if installed("glslangValidator") {
        let text = b"#version 450 core\nvoid main() { gl_Position = sphere; }\n";
        let said = validate(Language::Glsl450, &Role::Vertex, text).unwrap_err();
        assert!(said.contains("'sphere' : undeclared identifier"), "{said}");
    }
}
