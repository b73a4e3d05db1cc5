//! Look-alikes of the rules on programs that are right.

use reading::ProgramEntry;

use crate::{Config, Input, Settings, run, run_with};
use base::text::SourceFile;

fn inputs(files: &[(&str, &str)]) -> Vec<Input> {
    files.iter().map(|(name, text)| Input::new(SourceFile::new(*name, *text))).collect()
}

/// Codes of the rules on programs.
fn codes(files: &[(&str, &str)]) -> Vec<&'static str> {
    run(&inputs(files)).iter().map(|d| d.code.0).filter(|c| c.starts_with('I')).collect()
}

fn vertex(out: &str, body: &str) -> String {
    format!("#version 410 core\nin vec4 p;\n{out}\nvoid main() {{ {body} gl_Position = p; }}\n")
}

fn fragment(input: &str, value: &str) -> String {
    format!("#version 410 core\n{input}\nout vec4 c;\nvoid main() {{ c = vec4({value}); }}\n")
}

#[test]
fn outputs_and_inputs_meet_by_location_or_name() {
    for (out, body, input, value) in [
        ("out vec3 a;", "a = p.xyz;", "in vec3 a;", "a, 1.0"),
        ("layout(location = 1) out vec3 a;", "a = p.xyz;", "layout(location = 1) in vec3 b;", "b, 1.0"),
        ("layout(location = 1) out vec3 a;", "a = p.xyz;", "in vec3 a;", "a, 1.0"),
        ("out B { vec3 a; } x;", "x.a = p.xyz;", "in B { vec3 a; } y;", "y.a, 1.0"),
        ("flat out int a;", "a = 1;", "flat in int a;", "a"),
        ("out vec3 a[2];", "a[0] = a[1] = p.xyz;", "in vec3 a[2];", "a[0], 1.0"),
        ("struct S { vec3 v; }; out S a;", "a.v = p.xyz;", "struct T { vec3 v; }; in T a;", "a.v, 1.0"),
        ("", "", "in vec3 unused;", "1.0"),
        ("", "", "", "gl_FragCoord.x"),
        ("uniform float g;", "", "uniform float g;", "g"),
        ("uniform U { vec4 v; } one;", "", "uniform U { vec4 v; } two;", "two.v"),
        ("uniform U { vec4 v; } one;", "", "uniform vec4 v;", "v"),
        ("uniform U { vec4 v; };", "", "uniform U { vec4 v; };", "v"),
        ("uniform U { vec4 v; };", "", "uniform vec4 v;", "1.0"),
    ] {
        let found = codes(&[("a.vert", &vertex(out, body)), ("a.frag", &fragment(input, value))]);
        assert!(found.is_empty(), "{out} {input}: {found:?}");
    }
}

#[test]
fn what_does_not_meet_is_reported_once() {
    for (out, body, input, value, expected) in [
        ("", "", "in vec3 a;", "a, 1.0", "I001"),
        ("out vec3 aa;", "aa = p.xyz;", "in vec3 a;", "a, 1.0", "I001"),
        ("layout(location = 1) out vec3 a;", "a = p.xyz;", "layout(location = 1) in vec4 b;", "b", "I002"),
        ("out vec3 a[2];", "a[0] = a[1] = p.xyz;", "in vec3 a[3];", "a[0], 1.0", "I002"),
        ("out C { vec3 a; } x;", "x.a = p.xyz;", "in B { vec3 a; } y;", "y.a, 1.0", "I001"),
        ("out B { vec3 a; } x;", "x.a = p.xyz;", "in B { vec4 a; } y;", "y.a", "I009"),
        ("out vec3 a;", "a = p.xyz;", "", "1.0", "I003"),
        ("out vec3 a;", "a = p.xyz;", "noperspective in vec3 a;", "a, 1.0", "I004"),
        ("uniform float g;", "", "uniform vec2 g;", "g, g", "I006"),
        ("uniform U { vec4 v; } one;", "", "uniform U { vec4 w; } two;", "two.w", "I009"),
        ("uniform U { vec4 v; };", "", "uniform vec4 v;", "v", "I006"),
        ("uniform vec4 v;", "gl_Position.x = v.x;", "uniform U { vec4 v; };", "v", "I006"),
    ] {
        let found = codes(&[("a.vert", &vertex(out, body)), ("a.frag", &fragment(input, value))]);
        assert_eq!(found, [expected], "{out} {input}");
    }
}

#[test]
fn an_input_that_only_a_function_without_calls_reads_is_left_alone() {
    let f = |main: &str| {
        format!(
            "#version 330 core\nin vec3 a;\nout vec4 c;\nvec4 f() {{ return vec4(a, 1.0); }}\nvec4 g() {{ return f(); }}\nvoid main() {{ c = {main}; }}\n"
        )
    };
    let reported = |main: &str| codes(&[("a.vert", &vertex("", "")), ("a.frag", &f(main))]);
    assert!(reported("vec4(1.0)").is_empty());
    assert_eq!(reported("g()"), ["I001"]);
}

#[test]
fn a_program_is_known_for_certain_or_not_at_all() {
    let v = vertex("", "");
    let f = fragment("in vec3 a;", "a, 1.0");
    let reported = |files: &[(&str, &str)]| codes(files).len();
    assert_eq!(reported(&[("a.vert", &v), ("a.frag", &f)]), 1);
    assert_eq!(reported(&[("a.vert", &v), ("b.frag", &f)]), 0, "two names");
    assert_eq!(reported(&[("x/a.vert", &v), ("y/a.frag", &f)]), 0, "two folders");
    assert_eq!(reported(&[("a.vert", &v), ("a.vs", &v), ("a.frag", &f)]), 0, "two vertex stages");
    let host = |text: &str| format!("void f() {{ {text} }}");
    for (text, expected) in [
        ("GLuint p = load(\"a.vert\", \"b.frag\");", 1),
        ("load(\"a.vert\", \"b.frag\", nullptr);", 1),
        ("load(\"a.vert\", \"b.frag\", geometry);", 0),
        ("use({ \"a.vert\", \"b.frag\" });", 0),
        (
            "GLuint p = glCreateProgram(); glAttachShader(p, compile(\"a.vert\")); glAttachShader(p, compile(\"b.frag\")); glLinkProgram(p);",
            1,
        ),
        (
            "GLuint p = glCreateProgram(); glAttachShader(p, compile(\"a.vert\")); glAttachShader(p, other()); glLinkProgram(p);",
            0,
        ),
        ("compile(\"a.vert\"); compile(\"b.frag\"); GLuint p = glCreateProgram(); attach(p); glLinkProgram(p);", 0),
        (
            "GLuint p = glCreateProgram(); glAttachShader(p, compile(\"a.vert\")); glAttachShader(p, compile(\"b.frag\")); glAttachShader(p, third); glLinkProgram(p);",
            0,
        ),
        ("prog.compileShader(\"a.vert\"); prog.compileShader(\"b.frag\"); prog.link();", 1),
        ("prog.compileShader(\"a.vert\"); prog.compileShader(name); prog.link();", 0),
        ("glProgramParameteri(p, GL_PROGRAM_SEPARABLE, 1); load(\"a.vert\", \"b.frag\");", 0),
    ] {
        assert_eq!(reported(&[("a.vert", &v), ("b.frag", &f), ("m.cpp", &host(text))]), expected, "{text}");
    }
    // A shader that a host file uses otherwise is not taken for part of a program by its name.
    assert_eq!(reported(&[("a.vert", &v), ("a.frag", &f), ("m.cpp", &host("load(\"a.vert\", other);"))]), 0);
}

#[test]
fn the_configuration_states_programs() {
    let (v, f) = (vertex("", ""), fragment("in vec3 a;", "a, 1.0"));
    let entry = ProgramEntry { shaders: vec!["s/a.vert".into(), "s/b.frag".into()], hosts: Vec::new() };
    let config = Config { programs: vec![entry], ..Config::default() };
    let files = inputs(&[("s/a.vert", &v), ("s/b.frag", &f)]);
    let found = run_with(&files, &Settings { config, ..Settings::default() });
    assert_eq!(found.iter().map(|d| d.code.0).collect::<Vec<_>>(), ["I001"]);
    assert!(run(&files).is_empty());
}

#[test]
fn shaders_in_literals_are_programs_too() {
    let text = r##"const char *vs = "#version 330 core\n" "in vec4 p;\n" "void main() { gl_Position = p; }\n";
const char *fs = "#version 330 core\n"
  "in vec3 a;\n"
  "out vec4 c;\n" "void main() { c = vec4(a, 1.0); }\n";
void f() {
  GLuint v = glCreateShader(GL_VERTEX_SHADER); glShaderSource(v, 1, &vs, 0);
  GLuint g = glCreateShader(GL_FRAGMENT_SHADER); glShaderSource(g, 1, &fs, 0);
  GLuint p = glCreateProgram(); glAttachShader(p, v); glAttachShader(p, g); glLinkProgram(p);
}
"##;
    let found = run(&inputs(&[("m.cpp", text)]));
    let reported: Vec<String> = found.iter().map(|d| format!("{} {}", d.file.locate(d.span.start), d.code)).collect();
    assert_eq!(reported, ["m.cpp:3:12 I001"]);
}

#[test]
fn a_geometry_stage_takes_arrays() {
    let v = vertex("out vec3 n;", "n = p.xyz;");
    let g = |declaration: &str, element: &str| {
        format!(
            "#version 330 core\nlayout(points) in;\nlayout(points, max_vertices = 1) out;\n{declaration}\nout vec3 m;\n\
             void main() {{ m = {element}; gl_Position = gl_in[0].gl_Position; EmitVertex(); EndPrimitive(); }}\n"
        )
    };
    let f = fragment("in vec3 m;", "m, 1.0");
    let host = "void f() { load(\"a.vert\", \"a.geom\", \"a.frag\"); }";
    let reported = |g: &str| codes(&[("a.vert", &v), ("a.geom", g), ("a.frag", &f), ("m.cpp", host)]);
    assert!(reported(&g("in vec3 n[];", "n[0]")).is_empty());
    assert!(reported(&g("in vec3 n[1];", "n[0]")).is_empty());
    assert_eq!(reported(&g("in vec4 n[];", "n[0].xyz")), ["I002"]);
    assert_eq!(reported(&g("in vec3 k[];", "k[0]")), ["I001"]);
}

#[test]
fn a_stage_of_another_name_may_lie_between() {
    let pass = "#version 410 core\nlayout(triangles) in;\nlayout(points, max_vertices = 1) out;\nin vec3 a[];\nOUT\n\
                void main() { b = a[0]; gl_Position = gl_in[0].gl_Position; EmitVertex(); EndPrimitive(); }\n";
    let (vertex, fragment) = (vertex("out vec3 a;", "a = p.xyz;"), fragment("in vec3 b;", "b, 1.0"));
    let of = |geometry: &str, out: &str| {
        let geometry = (geometry, pass.replace("OUT", out));
        let files = [("s/a.vert", vertex.as_str()), (geometry.0, geometry.1.as_str()), ("s/a.frag", fragment.as_str())];
        codes(&files).into_iter().filter(|code| *code == "I001").count()
    };
    assert_eq!(of("s/lines.geom", "out vec3 b;"), 0);
    let (placed, writes) =
        (fragment.replace("in vec3 b", "layout(location = 2) in vec3 b"), "layout(location = 2) out vec3 c;");
    let pass = pass.replace("OUT", writes).replace("b = ", "c = ");
    assert_eq!(codes(&[("s/a.vert", &vertex), ("s/lines.geom", &pass), ("s/a.frag", &placed)]), [""; 0]);
    // One that does not write it, one of another folder, and none.
    assert_eq!(of("s/lines.geom", "out vec3 b_; vec3 b;"), 1);
    assert_eq!(of("t/lines.geom", "out vec3 b;"), 1);
    assert_eq!(codes(&[("s/a.vert", &vertex), ("s/a.frag", &fragment)]), ["I001"]);
}

#[test]
fn blocks_of_vulkan_are_told_apart_by_their_bindings() {
    let of = |first: &str, second: &str| {
        let vertex = vertex(&format!("layout({first}) uniform U {{ vec4 v; }} one;"), "");
        let fragment = fragment(&format!("layout({second}) uniform U {{ vec4 w; }} two;"), "two.w");
        let found =
            codes(&[("a.vert", &vertex.replace("410 core", "450")), ("a.frag", &fragment.replace("410 core", "450"))]);
        found.contains(&"I009")
    };
    assert!(!of("set = 0, binding = 0", "set = 0, binding = 1"));
    assert!(!of("set = 0, binding = 0", "set = 1, binding = 0"));
    assert!(!of("push_constant", "push_constant"));
    assert!(of("set = 0, binding = 0", "set = 0, binding = 0"));
    // A stage that needs no more may end a block early; what it has lies where the other has it.
    let ends = |first: &str, members: &str| {
        let vertex = vertex(&format!("layout({first}) uniform U {{ vec4 v; vec4 w; }} one;"), "");
        let fragment = fragment(&format!("layout({first}) uniform U {{ {members} }} two;"), "two.v");
        let files = [vertex, fragment].map(|text| text.replace("410 core", "450"));
        codes(&[("a.vert", &files[0]), ("a.frag", &files[1])]).contains(&"I009")
    };
    assert!(!ends("set = 0, binding = 0", "vec4 v;") && !ends("set = 0, binding = 0", "vec4 v; vec4 w; vec4 x;"));
    assert!(ends("set = 0, binding = 0", "vec4 v; float w;") && ends("std140, binding = 0", "vec4 v;"));
    // Without a set it may be OpenGL as well, where a linker would tell.
    assert!(!of("std140, binding = 0", "std140, binding = 1"));
    assert!(of("std140, binding = 0", "std140") && of("std140", "std140"));
}
