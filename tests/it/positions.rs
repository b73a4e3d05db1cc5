//! What is said about a wrong shader, and where: at the author's line and column, in words about the
//! author's text, behind Japanese comments and although naga reads another text.

use std::path::{Path, PathBuf};
use std::process::Command;

use base::text::SourceFile;
use program::lower::Target;
use program::{Language, Program, Translation};
use shadercheck::cli::status::ExitStatus;
use shadercheck::cli::translate::{TranslateArgs, run};
use syntax::Stage;

use crate::lowering::compare_snapshot;

/// Relative, so that messages name no folder of this machine. Tests run in the folder of the package.
const FOLDER: &str = "fixtures/errors";

/// Each fixture with the text at which its first diagnostic stands.
const PLACES: [(&str, &str); 7] = [
    ("index_array.vert", "3] = velocity"),
    ("index_component.vert", "4]"),
    ("recursion.vert", "half_until_small(0.5"),
    ("syntax.vert", ";\n}"),
    ("texture_integer.vert", "texture(heights, position.xy)"),
    ("type.vert", "+ normal"),
    ("unknown_function.vert", "normalise("),
];

/// On these naga's reader panics, and nobody knows where.
const PANICS: [&str; 2] = ["naga_panic.vert", "naga_panic_size.vert"];
const PANIC_FOLDER: &str = "fixtures/panics";

fn fixture(name: &str) -> SourceFile {
    let folder = if PANICS.contains(&name) { PANIC_FOLDER } else { FOLDER };
    let path = format!("{folder}/{name}");
    SourceFile::from_bytes(&path, &std::fs::read(&path).unwrap()).unwrap()
}

/// What `shadercheck translate` says.
fn said(name: &str) -> (ExitStatus, String) {
    let file = Path::new(FOLDER).join(name);
    let args = TranslateArgs {
        file,
        stage: None,
        to: Language::Wgsl,
        entry: None,
        define: Vec::new(),
        include: Vec::new(),
        prelude: None,
        lenient: false,
        output: None,
        compose: Default::default(),
    };
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = run(&args, &mut out, &mut err).unwrap();
    assert!(out.is_empty(), "nothing is translated");
    (status, String::from_utf8(err).unwrap())
}

fn files() -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(FOLDER).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn every_wrong_shader_is_reported_as_its_snapshot_says() {
    for name in files() {
        let (status, text) = said(&name);
        assert_eq!(status, ExitStatus::Findings, "{name}");
        compare_snapshot("errors", &name, &text);
    }
}

#[test]
fn every_fixture_has_its_place() {
    let mut listed: Vec<&str> = PLACES.iter().map(|(name, _)| *name).collect();
    listed.sort_unstable();
    assert_eq!(files(), listed);
}

#[test]
fn errors_stand_at_the_authors_line_and_column() {
    for (name, text) in PLACES {
        let file = fixture(name);
        let at = file.locate(file.text().find(text).unwrap());
        let (_, said) = said(name);
        assert!(said.contains(&format!("--> {at}\n")), "{at} is not in\n{said}");
    }
}

#[test]
fn wide_characters_stand_before_every_place_on_its_line() {
    for (name, text) in PLACES {
        let file = fixture(name);
        let offset = file.text().find(text).unwrap();
        let line = file.line_text(file.position(offset).line);
        let bytes = offset - file.text()[..offset].rfind('\n').map_or(0, |n| n + 1);
        // A column in bytes would be another one.
        assert_ne!(file.position(offset).column, bytes + 1, "{name}: {line}");
    }
}

/// Texts that our front end takes and naga's reader refuses, and the text at which it does.
const REFUSED_BY_NAGA: [(&str, &str); 2] = [
    (
        "in uint a; void main() { /* 桁上げ */ uint c = 0u; uint b = uaddCarry(a, 7u, c); gl_Position = vec4(b, c, 0u, 1u); }",
        "uaddCarry",
    ),
    ("in vec4 a; void main() { /* 行列 */ gl_Position = matrixCompMult(mat4(a.x), mat4(a.y)) * a; }", "matrixCompMult"),
];

#[test]
fn what_nagas_reader_refuses_stands_at_the_authors_place() {
    for (text, at) in REFUSED_BY_NAGA {
        let file = SourceFile::new("a.vert", format!("#version 450\n{text}\n"));
        let program = Program::from_source(&file, Stage::Vertex, |_| Ok(Target::Stage)).unwrap();
        let reported = program.retranslate(Language::NagaGlsl).unwrap_err().to_string();
        let place = file.locate(file.text().find(at).unwrap());
        assert!(reported.contains(&format!("{place}: ")), "{place} is not in {reported}");
        // Without the way back, it would stand somewhere else.
        let Ok(Translation::Text(lowered)) = program.translate(Language::NagaGlsl) else { panic!("{text}") };
        let lowered = SourceFile::new("a.vert", lowered);
        assert_ne!(place, lowered.locate(lowered.text().find(at).unwrap()));
    }
}

#[test]
fn messages_do_not_speak_of_nagas_data() {
    for name in files() {
        let (_, said) = said(&name);
        let words: Vec<&str> =
            said.lines().filter(|l| l.starts_with("error") || l.trim_start().starts_with("= ")).collect();
        for word in ["expression [", "Handle", "naga::", "wgsl", "StructMember", "@builtin"] {
            assert!(!words.iter().any(|line| line.contains(word)), "{name}: `{word}` in\n{said}");
        }
        let index = |line: &str| {
            line.match_indices('[').any(|(at, _)| line[at + 1..].starts_with(|c: char| c.is_ascii_digit()))
        };
        assert!(!words.iter().any(|line| index(line)), "{name}: an index in\n{said}");
    }
}

fn panicking(name: &str) -> Program {
    let program = Program::from_source(&fixture(name), Stage::Vertex, |_| Ok(Target::Stage));
    program.unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn a_panic_of_naga_is_a_refusal() {
    for name in PANICS {
        let reported = panicking(name).retranslate(Language::NagaGlsl).unwrap_err().to_string();
        assert!(reported.contains("naga panicked"), "{name}: {reported}");
    }
}

#[test]
fn what_naga_panics_on_is_translated_and_nothing_else_is_printed() {
    for name in PANICS {
        let output = Command::new(env!("CARGO_BIN_EXE_shadercheck"))
            .args(["translate", "--to", "wgsl"])
            .arg(PathBuf::from(PANIC_FOLDER).join(name))
            .env("RUST_BACKTRACE", "1")
            .output()
            .unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), text.as_str()), (Some(0), ""), "{name}");
        assert!(String::from_utf8(output.stdout).unwrap().contains("@vertex"), "{name}");
    }
}

#[test]
fn naga_still_panics_on_these() {
    // When it no longer does, the fixtures show nothing, and others have to be found.
    for name in PANICS {
        let Ok(Translation::Text(text)) = panicking(name).translate(Language::NagaGlsl) else { panic!("{name}") };
        let options = naga::front::glsl::Options::from(naga::ShaderStage::Vertex);
        let parse = move || naga::front::glsl::Frontend::default().parse(&options, &text).is_ok();
        assert!(std::thread::spawn(parse).join().is_err(), "{name}");
    }
}
