//! Readings that are kept from one run to the next.

use base::text::SourceFile;

use crate::{Input, Settings, run_with};

fn inputs(vertex: &str) -> Vec<Input> {
    let host = "void f() { GLuint p = load(\"a.vert\", \"a.frag\"); glGetUniformLocation(p, \"tint\"); }";
    let files = [
        ("a.vert", vertex),
        ("a.frag", "#version 330 core\nout vec4 c;\nuniform vec4 tint;\nvoid main() { c = tint; }\n"),
        ("m.cpp", host),
    ];
    files.map(|(name, text)| Input::new(SourceFile::new(name, text)).kept()).to_vec()
}

#[test]
fn a_run_over_what_was_kept_finds_what_a_first_run_finds() {
    let right = "#version 330 core\nin vec4 p;\nvoid main() { gl_Position = p; }\n";
    let wrong = "#version 330 core\nin vec4 p;\nvoid main() { gl_Position = vec3(p); }\n";
    let settings = Settings::default();
    let mut now = inputs(right);
    assert_eq!(run_with(&now, &settings).len(), 0);
    now[0] = now[0].with_file(SourceFile::new("a.vert", wrong));
    let found = run_with(&now, &settings);
    assert_eq!(found, run_with(&inputs(wrong), &settings));
    assert_eq!(found.len(), 1, "{found:?}");
    // The host looks a name up that is gone.
    now[0] = now[0].with_file(SourceFile::new("a.vert", right));
    now[1] = now[1].with_file(SourceFile::new("a.frag", now[1].file.text().replace("tint", "tone")));
    assert!(run_with(&now, &settings).iter().any(|d| d.file.name() == "m.cpp" && d.code.0 == "H003"));
}
