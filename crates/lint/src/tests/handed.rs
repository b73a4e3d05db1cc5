//! Texts of scripts and pages: what they lack is told where their host puts nothing in front.

use crate::{Input, run};
use base::text::SourceFile;

/// A script that compiles `vertex` and `fragment` itself.
fn script(vertex: &str, fragment: &str) -> String {
    format!(
        "const gl = canvas.getContext('webgl');\nconst vs = `{vertex}`;\nconst fs = `{fragment}`;\n\
         function compile(kind, text) {{\n  const s = gl.createShader(kind);\n  gl.shaderSource(s, text);\n  \
         gl.compileShader(s);\n  return s;\n}}\nconst p = gl.createProgram();\n\
         gl.attachShader(p, compile(gl.VERTEX_SHADER, vs));\ngl.attachShader(p, compile(gl.FRAGMENT_SHADER, fs));\n\
         gl.linkProgram(p);\n"
    )
}

const VERTEX: &str = "attribute vec4 p;\nvoid main() { gl_Position = mv * p; }\n";
const FRAGMENT: &str = "precision mediump float;\nvoid main() { gl_FragColor = vec4(1.0); }\n";

fn told(files: &[(&str, &str)]) -> Vec<String> {
    let inputs: Vec<Input> = files.iter().map(|(name, text)| Input::new(SourceFile::new(*name, *text))).collect();
    let errors = run(&inputs).into_iter().filter(|d| d.severity == base::diagnostic::Severity::Error);
    errors.map(|d| format!("{} {}", d.file.locate(d.span.start), d.code)).collect()
}

const LACKS: &str = "a.js:3:29 E020";

#[test]
fn a_script_that_compiles_its_texts_puts_nothing_in_front() {
    assert_eq!(told(&[("a.js", &script(VERTEX, FRAGMENT))]), [LACKS]);
    // A missing precision as well.
    let bare = FRAGMENT.replace("precision mediump float;\n", "varying vec2 t;\n");
    let whole = VERTEX.replace("mv * ", "");
    assert_eq!(told(&[("a.js", &script(&whole, &bare))]), ["a.js:5:21 V009"]);
    assert!(told(&[("a.js", &script(&whole, FRAGMENT))]).is_empty());
}

#[test]
fn what_stands_in_other_strings_may_be_in_front() {
    let text = script(VERTEX, FRAGMENT);
    for more in [
        "const head = 'uniform mat4 mv;\\n';\n",
        "const lines = ['uniform mat4 mv;', 'uniform float t;'];\n",
        "const declare = (type, name) => 'uniform ' + type + ' ' + name + ';';\n",
        "const declare = (type, name) => `uniform ${type} ${name};`;\n",
    ] {
        assert!(told(&[("a.js", &format!("{text}{more}"))]).is_empty(), "{more}");
    }
    // A look-up and a message declare nothing.
    let more = "gl.getUniformLocation(p, 'mv');\nconsole.log('could not find uniform ' + name, 'in mv');\n";
    assert_eq!(told(&[("a.js", &format!("{text}{more}"))]), [LACKS]);
    let precise = "const head = 'precision highp float;\\n';\n";
    let bare = script(&VERTEX.replace("mv * ", ""), "varying vec2 t;\nvoid main() { gl_FragColor = vec4(1.0); }\n");
    assert!(told(&[("a.js", &format!("{bare}{precise}"))]).is_empty());
}

#[test]
fn a_library_may_put_anything_in_front() {
    let text = script(VERTEX, FRAGMENT);
    assert!(told(&[("a.js", &format!("import {{ assemble }} from 'engine';\n{text}"))]).is_empty());
    assert_eq!(
        told(&[("a.js", &format!("import {{ f }} from './f.js';\n{text}")), ("f.js", "export const f = 1;\n")]).len(),
        1
    );
    // Nobody in sight takes the text.
    let alone = format!("export const vs = `{VERTEX}`;\n");
    assert!(told(&[("a.js", &alone)]).is_empty());
    let utilities = ("gl.js", "export function compile(gl, s, text) { gl.shaderSource(s, text); }\n");
    // Whoever takes it is a script of the project, unless one of them uses a library.
    assert_eq!(told(&[("a.js", &alone), utilities]), ["a.js:2:29 E020"]);
    let uses = ("b.js", "import * as engine from 'engine';\n");
    assert!(told(&[("a.js", &alone), utilities, uses]).is_empty());
    let page =
        ("b.html", "<script src=\"https://cdn.example/engine.js\"></script>\n<script>const v = 'vec3 f';</script>\n");
    assert!(told(&[("a.js", &alone), utilities, page]).is_empty());
    let with = format!("import {{ compile }} from './gl.js';\n{alone}");
    assert_eq!(told(&[("a.js", &with), utilities]), ["a.js:3:29 E020"]);
}

#[test]
fn scripts_of_a_page_are_read() {
    let page = |script: &str| format!("<!doctype html>\n<canvas></canvas>\n<script>\n{script}</script>\n");
    assert_eq!(told(&[("a.html", &page(&script(VERTEX, FRAGMENT)))]), ["a.html:6:29 E020"]);
    let module = page(&script(VERTEX, FRAGMENT)).replace("<script>", "<script type=\"module\">");
    assert_eq!(told(&[("a.html", &module)]), ["a.html:6:29 E020"]);
    let data = page(&script(VERTEX, FRAGMENT)).replace("<script>", "<script type=\"text/plain\">");
    assert!(told(&[("a.html", &data)]).is_empty());
    // A shader in an element of its own, and a script that takes it.
    let takes = "<script>gl.shaderSource(s, document.getElementById('v').text);</script>\n";
    let element = format!("<script id=\"v\" type=\"x-shader/x-vertex\">\n{VERTEX}</script>\n{takes}");
    assert_eq!(told(&[("a.html", &element)]), ["a.html:3:29 E020"]);
    let through = element.replace("<script>gl", "<script src=\"https://cdn.example/engine.js\"></script>\n<script>gl");
    assert!(told(&[("a.html", &through)]).is_empty());
}

#[test]
fn shaders_in_scripts_of_a_page_can_be_run() {
    let page = format!("<!doctype html>\n<script>\n{}</script>\n", script(VERTEX, FRAGMENT));
    let printed = hosts::document::printed_shaders(&SourceFile::new("a.html", page));
    assert_eq!(printed.iter().map(|p| p.stage).collect::<Vec<_>>(), [syntax::Stage::Vertex, syntax::Stage::Fragment]);
    let at = printed[0].file.text().find("gl_Position").unwrap();
    assert_eq!(printed[0].file.locate(at).to_string(), "a.html:5:15");
}

#[test]
fn names_of_other_pages_do_not_stand_in_front() {
    let page = |script: &str| format!("<script>\n{script}</script>\n");
    let other = page("const head = 'uniform mat4 mv;\\n';\nconst more = 'vec4 f() { return vec4(1.0); }';\n");
    assert_eq!(told(&[("a.html", &page(&script(VERTEX, FRAGMENT))), ("b.html", &other)]), ["a.html:4:29 E020"]);
}

#[test]
fn a_host_that_renames_names_of_the_language_may_declare_them() {
    let text = script("attribute vec4 gl_Vertex;\nvoid main() { gl_Position = gl_Vertex; }\n", FRAGMENT);
    assert_eq!(told(&[("a.js", &text)]), ["a.js:2:28 V004"]);
    let renames = format!("{text}vs.replace(/\\bgl_\\w+\\b/g, 'own_$&');\n");
    assert!(told(&[("a.js", &renames)]).is_empty());
}

#[test]
fn a_version_in_another_string_decides_over_types() {
    let text = |head: &str| {
        format!(
            "const VS: &str = r#\"\nattribute vec4 p;\nvoid main() {{ float x = 1; gl_Position = p * x * m; }}\n\"#;\n\
             {head}fn make(gl: &Gl) {{ gl.shader_source(s, VS); }}\n"
        )
    };
    assert_eq!(told(&[("a.rs", &text(""))]), ["a.rs:3:25 T006", "a.rs:3:50 E020"]);
    let headed = text("const HEAD: &str = \"#version 330 compatibility\\n\";\n");
    assert_eq!(told(&[("a.rs", &headed)]), ["a.rs:3:50 E020"]);
}

#[test]
fn shader_files_of_a_project_without_libraries_are_whole() {
    let utilities = ("gl.js", "export function compile(gl, s, text) { gl.shaderSource(s, text); }\n");
    assert!(told(&[("a.vert", VERTEX)]).is_empty());
    assert_eq!(told(&[("a.vert", VERTEX), utilities]), ["a.vert:2:29 E020"]);
    for more in [
        ("b.js", "import { engine } from 'engine';\n"),
        ("b.js", "const head = 'uniform mat4 mv;\\n';\n"),
        ("b.js", "const declare = (type, name) => 'uniform ' + type + ' ' + name + ';';\n"),
        ("b.glsl", "uniform mat4 mv;\n"),
        ("b.cpp", "void f(GLuint p) { glGetUniformLocation(p, \"mv\"); }\n"),
    ] {
        assert!(told(&[("a.vert", VERTEX), utilities, more]).is_empty(), "{}", more.1);
    }
}

#[test]
fn a_call_of_moderngl_takes_texts_as_they_are() {
    let text = |head: &str| {
        format!(
            "{head}prog = ctx.program(\n    vertex_shader=\"\"\"\n#version 330\nin vec2 p;\n\
             void main() {{ gl_Position = mv * vec4(p, 0.0, 1.0); }}\n\"\"\")\n"
        )
    };
    assert_eq!(told(&[("a.py", &text(""))]), ["a.py:5:29 E020"]);
    assert!(told(&[("a.py", &text("HEAD = 'uniform mat4 mv;'\n"))]).is_empty());
}
