//! One text is read in one way, whichever command reads it.

use std::path::Path;

use base::diagnostic::Severity;
use base::text::SourceFile;
use syntax::{Profile, Shader, Stage};

/// All shaders in GLSL below a folder, with their stages.
fn shaders(folder: &Path, found: &mut Vec<(SourceFile, Stage)>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            shaders(&path, found);
        } else if let Ok(text) = std::fs::read_to_string(&path) {
            let file = SourceFile::new(path.to_string_lossy(), text);
            if let Some(stage) = hosts::stage_of(&file) {
                found.push((file, stage));
            }
        }
    }
}

/// The version under which the linter and the server read a text, and the one under which it runs, each with true for
/// OpenGL ES; none where the linter finds an error.
fn versions(file: &SourceFile, stage: Stage) -> Option<[(u32, bool); 2]> {
    let read = Shader::parse_fitting(file, stage, &[], false);
    if read.diagnostics.iter().any(|d| d.severity == Severity::Error) {
        return None;
    }
    let run = Shader::parse_with(&syntax::fitting(file, stage, &[], || None), stage, &[]);
    Some([read, run].map(|parsed| {
        let version = parsed.shader.version();
        (version.number, version.profile == Profile::Es)
    }))
}

#[test]
fn what_the_linter_reads_is_what_runs() {
    let mut all = Vec::new();
    for folder in ["fixtures", "shaders"] {
        shaders(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut all);
    }
    // Most of these state a version; without it, each is a text that leaves it open.
    let plain: Vec<(SourceFile, Stage)> = all
        .iter()
        .map(|(file, stage)| {
            let lines = file.text().lines().filter(|line| !line.trim_start().starts_with("#version"));
            (SourceFile::new(file.name(), lines.map(|line| format!("{line}\n")).collect::<String>()), *stage)
        })
        .collect();
    all.extend(plain);
    let mut looked = 0;
    for (file, stage) in &all {
        let Some([read, run]) = versions(file, *stage) else { continue };
        assert_eq!(read, run, "{}:\n{}", file.name(), file.text());
        looked += 1;
    }
    assert!(looked > 200, "{looked} of {}", all.len());
}

#[test]
fn a_text_that_needs_a_version_is_read_under_the_first_that_has_it() {
    let of = |text: &str| versions(&SourceFile::new("a.frag", text), Stage::Fragment);
    let old = "varying vec2 p;\nvoid main() { gl_FragColor = vec4(p, 0.0, 1.0); }\n";
    assert_eq!(of(old).unwrap()[0].0, 110);
    let new = "in vec2 p;\nout vec4 c;\nvoid main() { c = vec4(p, 0.0, 1.0f); }\n";
    let [read, run] = of(new).unwrap();
    assert_eq!(read, run);
    assert_eq!(read.0, 130);
    assert_eq!(of(&format!("#version 450\n{new}")).unwrap(), [(450, false); 2]);
    assert!(of("varying vec2 p;\nvoid main() { gl_FragColor = p; }\n").is_none(), "wrong in every version");
}
