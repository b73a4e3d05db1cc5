//! What is told of branches that macros from outside switch on.

use base::text::SourceFile;

use crate::{Input, Level, Selection, Settings, run_with};

fn reported(text: &str, level: Level) -> Vec<String> {
    let selection = Selection::new(&["E".to_owned(), "T".to_owned()], &[]).unwrap().at(level);
    let input = Input::new(SourceFile::new("a.frag", text));
    let found = run_with(&[input], &Settings { selection, ..Settings::default() });
    found.iter().map(|d| format!("{} {}", d.code, d.file.locate(d.span.start))).collect()
}

fn cutoff(ty: &str) -> String {
    format!(
        "#version 330\nuniform {ty} cutoff;\nout vec4 c;\nvoid main() {{\n  c = vec4(1.0);\n#ifdef CUTOFF\n  if (c.a < cutoff) discard;\n#endif\n}}\n"
    )
}

#[test]
fn errors_behind_a_macro_from_outside_are_told() {
    assert_eq!(reported(&cutoff("vec4"), Level::Default), ["T010 a.frag:7:11"]);
    assert_eq!(reported(&cutoff("float"), Level::Default), [""; 0]);
}

#[test]
fn a_name_that_is_the_macro_around_it_is_told_on_request_since_a_host_may_define_it_as_a_name() {
    let text = |name: &str| {
        format!(
            "#version 330\n#ifdef HAS_MAP\nuniform sampler2D {name};\n#endif\nout vec4 c;\nvoid main() {{ c = vec4(1.0); }}\n"
        )
    };
    assert_eq!(reported(&text("HAS_MAP"), Level::Default), [""; 0]);
    assert_eq!(reported(&text("HAS_MAP"), Level::Strict), ["E001 a.frag:3:19"]);
    let whole = text("HAS_MAP").replace("vec4(1.0)", "texture(HAS_MAP, vec2(0.5))");
    assert_eq!(reported(&whole, Level::Default), [""; 0]);
    assert_eq!(reported(&text("map"), Level::Default), [""; 0]);
}

#[test]
fn what_another_macro_repairs_is_no_error() {
    let text = "#version 330\n#ifdef B\nin vec3 n;\n#else\nin vec2 n;\n#endif\nout vec4 c;\n\
        void main() {\n  c = vec4(1.0);\n#ifdef A\n  c.rgb = n;\n#endif\n}\n";
    assert_eq!(reported(text, Level::Default), [""; 0]);
    let name = "#version 330\n#ifdef A\nconst float edge = 1.0;\n#endif\nout vec4 c;\nvoid main() {\n  c = vec4(1.0);\n\
        #ifdef B\n  c.r = edge + rim;\n#endif\n}\n";
    assert_eq!(reported(name, Level::Default), [""; 0]);
    assert_eq!(reported(name, Level::Strict), ["E020 a.frag:9:16"]);
}
