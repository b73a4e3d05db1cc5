//! Tests of the front end as a whole.

mod diagnostics;
mod grammar;
mod holes;
mod interface;
mod layouts;
mod mutation;
mod precision;
mod preprocessor;
mod rules;

use super::{Parsed, Shader, Stage};
use base::text::{SourceFile, Span};

const SKINNING: &str = include_str!("shaders/skinning.vert");
const HAIR: &str = include_str!("shaders/hair.geom");
const PHONG: &str = include_str!("shaders/phong.frag");
const LEGACY: &str = include_str!("shaders/legacy.vert");
const GRAMMAR: &str = include_str!("shaders/grammar.frag");
const PARTICLES: &str = include_str!("shaders/particles.geom");

/// All shaders of the folder.
const SHADERS: &[(&str, Stage)] = &[
    (SKINNING, Stage::Vertex),
    (HAIR, Stage::Geometry),
    (PHONG, Stage::Fragment),
    (LEGACY, Stage::Vertex),
    (GRAMMAR, Stage::Fragment),
    (PARTICLES, Stage::Geometry),
];

fn parse(text: &str, stage: Stage) -> Parsed {
    Shader::parse(&SourceFile::new("t", text), stage)
}

/// `E001 3:5 message`, one for each diagnostic.
fn errors(text: &str, stage: Stage) -> Vec<String> {
    let parsed = parse(text, stage);
    let file = parsed.shader.file();
    parsed.diagnostics.iter().map(|d| format!("{} {} {}", d.code, file.position(d.span.start), d.message)).collect()
}

/// A shader without diagnostics.
#[track_caller]
fn clean(text: &str, stage: Stage) -> Shader {
    assert_eq!(errors(text, stage), Vec::<String>::new(), "{text}");
    parse(text, stage).shader
}

/// A vertex shader with this body of `main`.
fn in_main(body: &str) -> String {
    format!("#version 150 core\nin vec4 p;\nuniform mat4 m;\nvoid main() {{\n{body}\n}}\n")
}

fn text(shader: &Shader, span: Span) -> &str {
    shader.file().slice(span)
}

#[test]
fn shaders_in_the_style_of_textbooks_are_clean() {
    for (source, stage) in SHADERS {
        clean(source, *stage);
    }
}

#[test]
fn file_names_say_the_stage() {
    for (name, stage) in [
        ("a/b.vert", Some(Stage::Vertex)),
        ("b.FS", Some(Stage::Fragment)),
        ("c.geom.glsl", Some(Stage::Geometry)),
        ("d.gs", Some(Stage::Geometry)),
        ("e.comp", Some(Stage::Compute)),
        ("f.glsl", Some(Stage::Library)),
        ("noise.v2.glsl", Some(Stage::Library)),
        ("vs.glsl", Some(Stage::Library)),
        ("x.tesc", Some(Stage::TessControl)),
        ("x.cpp", None),
        ("vert", None),
        (r"dir.d\x", None),
    ] {
        assert_eq!(Stage::from_path(name), stage, "{name}");
    }
}

#[test]
fn every_code_is_listed_once_and_in_order() {
    let codes: Vec<_> = super::errors::all().map(|(c, _)| c.0).collect();
    let mut sorted = codes.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(codes, sorted);
}

#[test]
fn every_code_is_planted_in_a_test() {
    let own = [include_str!("diagnostics.rs"), include_str!("preprocessor.rs"), include_str!("rules.rs")].concat();
    let composing = include_str!("../../../compose/src/tests.rs");
    let tests = [own.as_str(), include_str!("../preprocess/plain.rs"), composing].concat();
    for (code, _) in super::errors::all() {
        assert!(tests.contains(&format!("\"{code} ")), "{code}");
    }
}
