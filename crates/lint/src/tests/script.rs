//! Shaders in strings of scripts.

use base::text::SourceFile;
use hosts::script::Script;
use syntax::Stage;

use crate::{Input, run};

fn found(name: &str, text: &str) -> Vec<(String, Stage, bool)> {
    let file = SourceFile::new(name, text);
    Script::read(&file).shaders.into_iter().map(|f| (f.name, f.stage, f.partial)).collect()
}

fn reported(name: &str, text: &str) -> Vec<String> {
    let found = run(&[Input::new(SourceFile::new(name, text))]);
    found.iter().map(|d| format!("{} {}", d.code, d.file.locate(d.span.start))).collect()
}

const VERTEX: &str = "attribute vec4 p;\nvoid main() {\n  gl_Position = p * 2.0;\n}\n";

/// The shader as lines of strings that `join` joins.
fn lines(join: &str) -> String {
    VERTEX.lines().map(|line| format!("'{line}\\n'")).collect::<Vec<_>>().join(join)
}

#[test]
fn strings_of_each_language_are_read() {
    let escaped = VERTEX.replace('\n', "\\n");
    for (name, text, called) in [
        ("a.py", format!("vs = \"\"\"\n{VERTEX}\"\"\""), "a.py#vs"),
        ("a.py", format!("vs = (\n{}\n)", lines("\n  ")), "a.py#vs"),
        ("a.py", format!("make(vertex_shader='''{VERTEX}''')"), "a.py#vertex_shader"),
        ("a.js", format!("const vs = `{VERTEX}`;"), "a.js#vs"),
        ("a.ts", format!("const vs: string = /* glsl */ `{VERTEX}`;"), "a.ts#vs"),
        ("a.ts", format!("export default {{ vertexShader: glsl`{VERTEX}` }};"), "a.ts#vertexShader"),
        ("a.js", format!("var vs = [{}].join('\\n');", lines(",\n")), "a.js#vs"),
        ("a.js", format!("var x = s.replace(/['`]/g, ''); var vs = {};", lines(" +\n")), "a.js#vs"),
        ("A.java", format!("String VS = {};", lines(" + ").replace('\'', "\"")), "A.java#VS"),
        ("A.java", format!("char c = '\"'; String VS = \"\"\"\n{VERTEX}\"\"\";"), "A.java#VS"),
        ("a.kt", format!("val vs = \"\"\"\n{VERTEX}\"\"\".trimIndent()"), "a.kt#vs"),
        ("a.rs", format!("fn f<'a>(x: &'a str) {{}} const VS: &'static str = r#\"{VERTEX}\"#;"), "a.rs#VS"),
        ("a.rs", format!("let vs = \"{escaped}\";"), "a.rs#vs"),
    ] {
        assert_eq!(found(name, &text), [(called.to_owned(), Stage::Vertex, false)], "{text}");
        let wrong = reported(name, &text.replace("p * 2.0", "p * 2"));
        assert!(wrong.len() == 1 && wrong[0].starts_with(&format!("T006 {name}:")), "{text}: {wrong:?}");
        assert_eq!(reported(name, &text), [""; 0], "{text}");
    }
}

#[test]
fn braces_of_formats_are_filled_in_or_stand_for_one() {
    let format = |start: &str, body: &str, end: &str| {
        format!(
            "{start}QQQ\nvec4 effect(vec4 color, vec2 at)\n{{{{\n  float dt = {{size}};\n  return {body};\n}}}}\nQQQ{end}\n"
        )
        .replace("QQQ", "\"\"\"")
    };
    for (start, end) in [("s = ", ".format(size=2)"), ("s = f", ""), ("s = ", "")] {
        assert_eq!(reported("a.py", &format(start, "vec4(color.xyz, dt)", end)), [""; 0]);
        assert_eq!(reported("a.py", &format(start, "vec4(color.xys, dt)", end)), ["T009 a.py:5:21"]);
    }
}

#[test]
fn texts_for_the_web_are_of_opengl_es() {
    let chunk = |body: &str| format!("export const fs = `\nvec4 tint(sampler2D map, vec2 at) {{\n  {body}\n}}\n`;\n");
    assert_eq!(reported("a.ts", &chunk("return texture2D(map, at * 2);")), ["T006 a.ts:3:30"]);
    assert_eq!(reported("a.ts", &chunk("vec4 value = texture(map, at);\n  return value;")), [""; 0]);
}

#[test]
fn findings_stand_at_their_line() {
    assert_eq!(
        reported("a.py", "# glsl\nvs = \"\"\"\nattribute vec4 p;\nvoid main() { gl_Position = p.xyzr; }\n\"\"\"\n"),
        ["T009 a.py:4:31"]
    );
    let joined = "x = [\n  'attribute vec4 p;',\n  'void main() { gl_Position = p.xyzr; }',\n].join('\\n');\n";
    assert_eq!(reported("a.js", joined), ["T009 a.js:3:34"]);
}

#[test]
fn what_a_host_adds_is_no_error() {
    for (name, text) in [
        // Engines declare attributes and uniforms, and put their chunks in.
        (
            "a.js",
            "const vs = `\nvoid main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }\n`;",
        ),
        ("a.ts", "const fs = `#version 300 es\nout vec4 c;\nvoid main() { c = lighting_getColor(geometry.uv); }\n`;"),
        ("a.js", "const fs = `\n#include <fog>\nvoid main() {\n#include <map>\ngl_FragColor = fog(c);\n}`;"),
        // Templates fill in names, numbers and lines.
        ("a.py", "vs = \"\"\"\nvoid main() { gl_Position = $transform(vec4($pos, 1)); }\n\"\"\""),
        ("a.py", "vs = \"\"\"\nvoid main() { gl_Position = <transform(position)>; }\n\"\"\""),
        ("a.py", "vs = \"\"\"\nvoid main() { gl_Position = vec4(%d); }\n\"\"\" % n"),
        ("a.py", "vs = f\"\"\"\nvoid main() {{ gl_Position = vec4({n}); }}\n\"\"\""),
        (
            "a.js",
            "const vs = `\n${head}\nvoid main() {\n  ${body}\n  gl_Position = vec4(${x}, ${n + `${m}`}.0, 0, 1);\n}`;",
        ),
        (
            "a.ts",
            "const vs = `\nuniform mat4 ${n.m};\nattribute float ${n.size};\nvoid main() {\n  gl_PointSize = ${n.size};\n}`;",
        ),
        (
            "a.ts",
            "const chunk = (body) => `\nfloat density(vec3 at, float scale) {\n  ${body}\n}\nfloat twice(float x) { return x * 2.0; }\n`;",
        ),
        // Version 3.00 in front of a chunk brings functions of integers.
        (
            "a.ts",
            "const chunk = `\nfloat texel(ivec2 c) {\n  return texelFetch(u_dem, clamp(c + ivec2(1), ivec2(0), ivec2(8)), 0).r;\n}\n`;",
        ),
        // What a test expects of a compiler.
        ("a.spec.ts", "expect(out).toContain(`vec3 d() {\n  vec3 a = vec3(1.0).xyz;\n  a.a = 1.0; return a;\n}`);"),
        // An argument beside another says nothing of its stage.
        (
            "a.ts",
            "make(screenVS, `#version 300 es\nprecision highp float;\nin vec2 t;\nlayout (location = 0) out vec4 c;\n\
             void main() { c = vec4(t, 0.0, 1.0); }`);",
        ),
        // Joined to something else.
        ("a.js", "const vs = 'attribute vec4 ' + name + '; void main() { gl_Position = ' + name + '; }';"),
        // No GLSL.
        ("a.js", "const s = 'void main() { gl_Position = vec4(1; }'.length; // don't"),
        ("a.ts", "const s = `float4 main(float4 p : SV_Position) { return float4(1, 2, 3, 4 } vec2`;"),
        ("a.rs", "/// A \"vec2\" that isn't.\nfn main() { let x = 'a'; let y: &'static str = \"void main( { vec2\"; }"),
    ] {
        assert_eq!(reported(name, text), [""; 0], "{text}");
    }
}

#[test]
fn parts_are_held_to_what_is_sure() {
    let chunk =
        |body: &str| format!("const chunk = `\nvec4 effect(vec4 color, vec2 at) {{\n  return {body};\n}}\n`;\n");
    assert_eq!(reported("a.js", &chunk("vec4(color.xys, 1.0)")), ["T009 a.js:3:21"]);
    assert_eq!(reported("a.js", &chunk("vec4(tint(color.xyz), time)")), [""; 0]);
    assert_eq!(reported("a.py", "s = \"\"\"\nvoid main() { gl_Position = $map(p).xys; }\n\"\"\""), [""; 0]);
    let unfilled = "const chunk = `\nfloat density(vec3 at, float scale) {\n  scale *= 2.0;\n}\nfloat f(float x) {\n${body}\n}\n`;";
    assert_eq!(reported("a.ts", unfilled), ["E038 a.ts:2:7"]);
    let hooked = "s = \"\"\"\nattribute vec4 p;\nvoid main() { gl_Position = $map(p) + p.xyzr; }\n\"\"\"";
    assert_eq!(reported("a.py", hooked), ["T009 a.py:3:41"]);
}

#[test]
fn a_text_that_breaks_off_anywhere_does_no_harm() {
    let text = "x = f'{a}' r'''頂 ''' `${a + `${b}`}` \"\"\"void main() { gl_Position = vec4(1, $a); }\"\"\" r#\"void main() { 頂 }\"# \
                /[/'`]/ ['vec2 a;', 'void main() { gl_FragColor = 頂; }'].join('\\n') + 'vec3 \\x' // don't\n\
                !.a?.b!: T = q({uniforms: {a, ...b, 'c': [1]}, vertexShader: `void main() {}`, frag }) ; p['x'].getUniformLocation(p!, `a[${i}]`)\n\
                def f(a, b): u = vertex_array(p, [(b, '2f', 'x')]) ) ] } ('n', f4.float32, 2) {% {{ } '{}{x}'.format(1)\n";
    for name in ["a.py", "a.js", "A.java", "a.kt", "a.rs"] {
        for (end, _) in text.char_indices() {
            for d in run(&[Input::new(SourceFile::new(name, &text[..end]))]) {
                assert!(d.file.text().get(d.span.range()).is_some(), "{name} cut at {end}: {d:#?}");
            }
        }
    }
}

#[test]
fn data_with_quoted_texts_is_no_shader() {
    let json = "{ \"NAME\": \"plain\", \"FRAGMENT\": \"void main() { gl_FragColor = vec4(1.0); }\" }";
    assert!(found("a.rs", &format!("const ISF: &str = r#\"{json}\"#;")).is_empty());
    assert!(found("a.js", &format!("const isf = '{json}';")).is_empty());
}

#[test]
fn values_between_strings_leave_one_text() {
    let vertex = |value: &str, precision: &str| {
        format!(
            "class A {{\n  final static double DIV = 1.0 / Other.SCALE;\n  private final static String vs = \"\"\n    + \
             \"precision {precision} float;\"\n    + \"attribute vec4 vertex;\"\n    + \"const float scale = \" + {value} + \
             \";\"\n    + \"void main() {{\"\n    + \" gl_Position = vec4(mod(vertex.x, 2.0) * scale);\"\n    + \"}}\";\n}}\n"
        )
    };
    for value in ["DIV", "Other.div(2, 3)", "(1.0 / SIZE)"] {
        let text = vertex(value, "mediump");
        assert_eq!(found("A.java", &text), [("A.java#vs".to_owned(), Stage::Vertex, true)], "{text}");
        assert_eq!(reported("A.java", &text), ["N041 A.java:8:28"], "{text}");
        assert_eq!(reported("A.java", &vertex(value, "highp")), [""; 0]);
    }
    // Lines that are put in front are lines.
    let common =
        "const fs = 'precision highp float;\\n' + common.noise + 'void main() { gl_FragColor = vec4(1.0); }';\n";
    assert_eq!(found("a.js", common), [("a.js#fs".to_owned(), Stage::Fragment, true)]);
    assert_eq!(reported("a.js", common), [""; 0]);
}

#[test]
fn a_program_with_a_stage_that_is_not_read_may_have_any_uniform() {
    let text = |key: &str, body: &str| {
        format!(
            "prog = ctx.program(\n    {key}=\"\"\"\n        #version 460\n        {body}\n    \"\"\",\n    fragment_shader=\"\"\"\n\
             \x20       #version 460\n        out vec4 c;\n        void main() {{ c = vec4(1.0); }}\n    \"\"\",\n)\ncam = prog[\"mvp\"]\n"
        )
    };
    let mesh = "#extension GL_NV_mesh_shader : require\n        layout(local_size_x = 1) in;\n        \
                layout(triangles, max_vertices = 3, max_primitives = 1) out;\n        uniform mat4 mvp;\n        \
                void main() { gl_MeshVerticesNV[0].gl_Position = mvp * vec4(1.0); gl_PrimitiveCountNV = 0; }";
    assert_eq!(reported("a.py", &text("mesh_shader", mesh)), [""; 0]);
    let vertex = "in vec4 p;\n        void main() { gl_Position = p; }";
    let told = reported("a.py", &text("vertex_shader", vertex));
    assert!(told.len() == 1 && told[0].starts_with("H003 a.py:13:"), "{told:?}");
}
