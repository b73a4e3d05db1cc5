use base::text::{Assembly, SourceFile, Span};

use super::*;
use crate::{Composer, Config, Input, Project, Variant};

const HEAD: &str = "#version 330 core\nuniform float t;\nout vec4 c;\n";

fn told_of(input: Input) -> Vec<String> {
    told_with(input, &[])
}

fn told_with(input: Input, variants: &[Variant]) -> Vec<String> {
    let config = Config { variants: variants.to_vec(), ..Config::default() };
    let project = Project::new(&[input], &config);
    let shader = project.shaders().next().expect("a shader");
    assert!(shader.front_end.is_empty(), "as it stands: {:?}", shader.front_end);
    let found = errors(std::iter::once(shader), &config, &AtomicBool::new(false)).into_iter();
    let told = |(level, d): (Level, Diagnostic)| {
        (level == Level::Default).then(|| format!("{} {}", d.file.locate(d.span.start), &*d.message))
    };
    found.filter_map(told).collect()
}

fn told(options: &str, body: &str) -> Vec<String> {
    let text = format!("{HEAD}{options}\nvoid main() {{\n{body}\n}}\n");
    told_of(Input::new(SourceFile::new("a.frag", text)))
}

#[test]
fn a_line_that_is_commented_out_is_switched_on() {
    let found = told("//#define GLOW", "#ifdef GLOW\nc = vec4(glow(t));\n#else\nc = vec4(t);\n#endif");
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("a.frag:7:10 where `GLOW` is defined: ") && found[0].contains("`glow`"), "{found:?}");
    assert!(told("//#define GLOW", "#ifdef GLOW\nc = vec4(sin(t));\n#else\nc = vec4(t);\n#endif").is_empty());
}

#[test]
fn a_line_without_a_value_is_switched_off() {
    let body = "#ifdef FOG\nfloat fog = t;\n#endif\nc = vec4(fog);";
    let found = told("#define FOG\n#define RAYS 2 // [1 2]", body);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains("where `FOG` is not defined: ") && found[0].contains("`fog`"), "{found:?}");
    // In a text that states no option, the line may be there for good.
    assert!(told("#define FOG", body).is_empty());
    assert!(
        told("#define FOG\n#define RAYS 2 // [1 2]", "float fog = 0.0;\n#ifdef FOG\nfog = t;\n#endif\nc = vec4(fog);")
            .is_empty()
    );
}

#[test]
fn values_of_a_list_are_tried() {
    let of = |last: &str| {
        format!("#if QUALITY == 0\nc = vec4(0.0);\n#elif QUALITY < 3\nc = vec4(t);\n#else\nc = {last};\n#endif")
    };
    let found = told("#define QUALITY 1 // [0 1 2 3]", &of("vec3(t)"));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains("where `QUALITY` is 3: "), "{found:?}");
    assert!(told("#define QUALITY 1 // [0 1 2 3]", &of("vec4(t)")).is_empty());
    // Without the list nothing says that the value is to be changed.
    assert!(told("#define QUALITY 1", &of("vec3(t)")).is_empty());
}

#[test]
fn the_smallest_set_of_several_is_told_once() {
    let options = "//#define A\n//#define B\n#define C\n//#define D";
    let body = "#if defined A && defined B\nc = vec3(t);\n#else\nc = vec4(t);\n#endif\n#ifdef C\nc += 1.0;\n#endif\n#ifdef D\nc += t;\n#endif";
    let found = told(options, body);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains("where `A` is defined and `B` is defined: "), "{found:?}");
}

#[test]
fn settings_that_a_text_refuses_are_left_alone() {
    let options = "//#define A\n//#define B\n//#define OFF\n#if defined A && defined B\n#error one of them\n#endif";
    let body = "#if defined A && defined B\nc = vec3(t);\n#else\nc = vec4(t);\n#endif";
    assert!(told(options, body).is_empty());
    // A fault beside them is found all the same.
    let found = told(options, "c = vec4(t);\n#ifdef OFF\nc = off;\n#endif");
    assert_eq!(found.len(), 1, "{found:?}");
    let text = format!("{HEAD}#define ON\n#ifdef ON\nvoid main() {{ c = vec4(t); }}\n#endif\n");
    assert!(told_of(Input::new(SourceFile::new("a.frag", text))).is_empty(), "nothing is compiled without it");
}

#[test]
fn what_no_author_changes_is_no_option() {
    let uses = "#ifdef A\nc = vec4(x);\n#endif\nc = vec4(y);";
    for options in [
        "#ifndef A_H\n#define A_H\nfloat x, y;\n#endif",
        "/*\n#define A\n*/\nfloat y;",
        "// use #define A to see more\nfloat y;",
        "#ifdef GL_ES\n#define A\n#else\n#define A\n#endif\n#ifdef A\nfloat x, y;\n#endif",
        "#define A\n#ifdef A\nfloat x, y;\n#endif\n#undef A\n#define B",
        "//#define B\n#ifndef B\n#define A\n#endif\n#if defined A || defined B\nfloat x, y;\n#endif",
    ] {
        assert!(told(options, uses).is_empty(), "{options}");
    }
}

#[test]
fn options_of_an_included_file_are_told_where_the_fault_stands() {
    let (settings, library) = (
        "#define STAGE_SETTINGS\n//#define GLOW\n",
        "float lit() {\n#ifdef GLOW\nreturn glow;\n#endif\nreturn t;\n}\n",
    );
    let composer = Composer::new(move |root: &SourceFile| {
        let mut joined = Assembly::new();
        for (at, line) in
            root.text().split_inclusive('\n').scan(0, |at, line| Some((std::mem::replace(at, *at + line.len()), line)))
        {
            match line.trim() {
                "#include \"settings\"" => {
                    let file = SourceFile::new("settings.glsl", settings);
                    joined.copy(&file, Span::new(0, settings.len()));
                }
                "#include \"library\"" => {
                    let file = SourceFile::new("library.glsl", library);
                    joined.copy(&file, Span::new(0, library.len()));
                }
                _ => joined.copy(root, Span::new(at, at + line.len())),
            }
        }
        Some(crate::Composed { file: joined.finish(root.name()), refused: Vec::new() })
    });
    // What the root defines for what it includes is no option.
    let text = format!(
        "{HEAD}#define ROOT\n#include \"settings\"\n#include \"library\"\nvoid main() {{ c = vec4(lit()); }}\n"
    );
    let found = told_of(Input::new(SourceFile::new("a.frag", text)).composed_by(composer));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("library.glsl:3:8 where `GLOW` is defined: "), "{found:?}");
}

#[test]
fn options_that_the_project_states_are_tried_as_those_of_the_text() {
    let body = "#if MODE == 2\nc = vec4(fog);\n#elif defined(MODE)\nc = vec4(t);\n#else\nc = vec4(0.0);\n#endif";
    let variant = |values: &[&str]| {
        let values = values.iter().map(|value| Some((*value).to_owned())).collect();
        [Variant { name: "MODE".to_owned(), values }]
    };
    for defined in ["", "#define MODE 1\n"] {
        let text = format!("{HEAD}{defined}void main() {{\n{body}\n}}\n");
        let input = Input::new(SourceFile::new("a.frag", text));
        let found = told_with(input.clone(), &variant(&["1", "2", "3"]));
        assert!(found.len() == 1 && found[0].contains("where `MODE` is 2: "), "{found:?}");
        assert!(told_with(input, &variant(&["1", "3"])).is_empty());
    }
}

#[test]
fn one_of_several_is_a_choice_and_no_fault() {
    let uses = "#ifdef TWO\nfloat phase = 2.0;\n#elif defined(THREE)\nfloat phase = 3.0;\n#endif\nc = vec4(phase);";
    assert!(told("#define TWO", uses).is_empty());
    let twice = "#ifdef A\nfloat f() { return t; }\n#endif\n#ifdef B\nfloat f() { return 1.0; }\n#endif";
    assert!(told(&format!("//#define A\n#define B\n{twice}"), "c = vec4(f());").is_empty());
    // Without another declaration nothing is to be chosen.
    let found = told(
        "#define TWO\n//#define DUSK",
        &format!("{}\n#ifdef DUSK\nc *= t;\n#endif", uses.replace("phase = 3.0", "other = 3.0")),
    );
    assert_eq!(found.len(), 1, "{found:?}");
}

#[test]
fn the_stage_and_what_a_host_asks_before_it_compiles_are_no_options() {
    let uses = "#ifdef VERTEX\nc = vec4(vertex);\n#endif\n#ifdef SKY\nc = vec4(sky);\n#endif\nc = vec4(t);";
    let text = format!("{HEAD}//#define VERTEX\n//#define SKY\nvoid main() {{\n{uses}\n}}\n");
    let input = Input::new(SourceFile::new("a.frag", text));
    assert_eq!(told_of(input.clone()).len(), 1);
    let project = Project::new(&[input], &Config::default());
    let asked = [("a.frag".to_owned(), vec!["SKY".to_owned()])];
    let config = Config { asked_before: asked.into_iter().collect(), ..Config::default() };
    assert!(errors(project.shaders(), &config, &AtomicBool::new(false)).is_empty());
}

#[test]
fn the_same_code_at_another_place_is_told_with_its_own_smallest_set() {
    let text = |branch: &str| {
        format!(
            "{HEAD}//#define OTHER\n//#define SKY\n#define {branch} 1\nvoid main() {{\n#ifdef SKY\n#ifdef FIRST\nc = sky;\n#else\nc = sky;\n#endif\n#endif\n#ifdef OTHER\nc += t;\n#endif\n}}\n"
        )
    };
    let input = |name: &str, branch| Input::new(SourceFile::new(name, text(branch)));
    let config = Config::default();
    let project = Project::new(&[input("a.frag", "FIRST"), input("b.frag", "LATER")], &config);
    let found = errors(project.shaders(), &config, &AtomicBool::new(false));
    let told: Vec<&str> = found.iter().map(|(_, d)| &*d.message).collect();
    assert_eq!(told, ["where `SKY` is defined: `sky` is not declared"; 2]);
}
