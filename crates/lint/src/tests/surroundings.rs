//! What hosts put in the place of comments, branches and holes, and what they define for a text.

use super::open::{by_default, found, only_on_request};

/// Nothing at any level.
fn silent(files: &[(&str, &str)]) {
    let (default, strict) = found(files);
    assert!(default.is_empty() && strict.is_empty(), "{files:?}: {default:?}, {strict:?}");
}

#[test]
fn a_comment_that_is_a_path_is_filled_in() {
    let text = |mark: &str| {
        format!(
            "#define most {mark}\n#if most > 0\nvec2 k[most];\n#endif\nvoid main() {{\n  for (int i = 0; i < most; ++i) {{ }}\n}}\n"
        )
    };
    assert!(found(&[("a.vert", &text("//Host::Most"))]).0.is_empty());
    assert!(found(&[("a.vert", &text("// Host::Counts::Most"))]).0.is_empty());
    by_default(&[("a.vert", &text("// see Host::Most"))], "E012");
}

#[test]
fn an_error_of_a_variant_rests_on_what_stands_in_front_as_any_other() {
    let text = "uniform sampler2DShadow map;\nvarying vec3 v;\nvoid main() {\n  float lit = 1.0;\n#ifdef FILTERED\n  \
        lit = shadow2D(map, v);\n#endif\n  gl_FragColor = vec4(lit);\n}\n";
    assert!(found(&[("a.frag", text)]).0.is_empty());
    by_default(&[("a.frag", &format!("#version 120\n{text}"))], "T003");
}

#[test]
fn branches_of_a_material_system_exclude_each_other() {
    let text = |property: &str| {
        format!(
            "#version 330\n{property}\nlayout(location = 0) out vec4 tint;\n@end\nlayout(location = 0) out float tint;\n\
             void main() {{ tint.xyz = vec3(1.0); }}\n"
        )
    };
    assert!(found(&[("a.frag", &text("@property( !caster )"))]).0.is_empty());
}

#[test]
fn host_code_may_declare_names_of_its_own_for_those_of_the_language() {
    let text = "#version 330\nout vec4 t;\nvoid main() { t = gl_Color; gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex; }\n";
    let host = |line: &str| {
        format!(
            "void f(osg::State* state) {{ {line} }}\nconst char* shader = \"a.vert\"; void g() {{ glUseProgram(1); }}\n"
        )
    };
    only_on_request(&[("a.vert", text), ("a.cpp", &host("state->setUseVertexAttributeAliasing(true);"))], "E020");
    by_default(&[("a.vert", text), ("a.cpp", &host("state->apply();"))], "E020");
}

#[test]
fn what_is_filled_in_has_a_name_for_each_variable() {
    let text = |second: &str| {
        format!(
            "const vs = `\nattribute float ${{A.INDEX}};\nuniform sampler2D ${{U.MAP}};\nvarying vec2 v;\nvoid main() {{\n  \
             vec4 c = texture2D(${{U.MAP}}, vec2(${{A.INDEX}} / 2.0, ${{A.INDEX}}));\n  v = vec2(c.r + c.b, {second});\n  \
             gl_Position = vec4(v, 0.0, 1.0);\n}}\n`;\n"
        )
    };
    assert!(found(&[("a.js", &text("c.g + c.a"))]).0.is_empty());
    by_default(&[("a.js", &text("c.g, c.a"))], "T001");
}

#[test]
fn what_a_document_leaves_out_may_be_the_return() {
    let text = |body: &str| {
        format!("A function:\n\n```glsl\n#version 300 es\nvec2 at(vec2 size, float id) {{\n{body}\n}}\n```\n")
    };
    silent(&[("a.md", &text("  ..."))]);
}

#[test]
fn a_comment_that_names_a_macro_is_no_switch_where_conditions_compute_with_it() {
    let text = |condition: &str| {
        format!(
            "#version 330\n// #define BITS\nout vec4 c;\nvoid main() {{\n#{condition}\n  c = vec4(1.0);\n#else\n  c = vec3(0.0);\n#endif\n}}\n"
        )
    };
    assert!(!found(&[("a.frag", &text("if BITS == 8"))]).0.iter().any(|code| code == "E012"));
    let switched = text("ifndef BITS").replace("vec3(0.0)", "vec2(0.0)");
    by_default(&[("a.frag", &switched)], "T003");
}

#[test]
fn three_puts_chunks_in_front_also_where_its_file_stands_in_the_project() {
    let page = |material: &str| {
        format!(
            "<script src=\"build/three.js\"></script>\n<script id=\"vs\" type=\"x-shader/x-vertex\">\n#include <common>\n\
             varying vec3 n;\nvoid main() {{\n  n = position;\n  gl_Position = projectionMatrix * vec4(position, 1.0);\n}}\n</script>\n\
             <script>\nvar m = new {material}({{ vertexShader: document.getElementById('vs').textContent }});\n</script>\n"
        )
    };
    let library = ("build/three.js", "function make(gl, shader, string) { gl.shaderSource( shader, string ); }\n");
    assert!(found(&[("a.html", &page("THREE.ShaderMaterial")), library]).0.is_empty());
}

#[test]
fn gl_frag_color_may_be_defined_in_front_as_an_output() {
    let text = "varying vec2 v;\nlayout(location = 1) out vec4 n;\nvoid main() { gl_FragColor = vec4(v, 0.0, 1.0); n = vec4(1.0); }\n";
    assert!(!found(&[("a.frag", text)]).0.iter().any(|code| code == "E049"));
    by_default(&[("a.frag", &format!("#version 330 compatibility\n{}", text.replace("varying", "in")))], "E049");
}

#[test]
fn a_text_without_main_is_no_stage_before_the_vertex_stage() {
    let vertex = "#version 110\nattribute vec2 position;\nvarying vec2 at;\nvoid main() { at = position; gl_Position = vec4(position, 0.0, 1.0); }\n";
    let fragment = "#version 110\nvarying vec2 at;\nvec3 tint(vec3 v);\nvoid main() { gl_FragColor = vec4(tint(vec3(at, 1.0)), 1.0); }\n";
    let host = "class A { void p() {\n  int program = glCreateProgram();\n  int v = createShader(\"edge-vs.glsl\", GL_VERTEX_SHADER);\n  \
        int f = createShader(\"edge-fs.glsl\", GL_FRAGMENT_SHADER);\n  int g = createShader(\"color.glsl\", GL_FRAGMENT_SHADER);\n  \
        glAttachShader(program, v);\n  glAttachShader(program, f);\n  glAttachShader(program, g);\n  \
        glBindAttribLocation(program, 0, \"position\");\n  glLinkProgram(program);\n} }\n";
    let files = |vertex: &'static str| {
        [
            ("A.java", host),
            ("edge-vs.glsl", vertex),
            ("edge-fs.glsl", fragment),
            ("color.glsl", "#version 110\nvec3 tint(vec3 c) { return c * 0.5; }\n"),
        ]
    };
    assert_eq!(found(&files(vertex)).0, [""; 0]);
}

#[test]
fn the_prose_of_a_function_in_python_is_no_shader() {
    let text = "\"\"\"Loads a shader.\n\n    .. code:: glsl\n\n        #version 330\n        out vec4 c;\n        \
        void main() { c = vec3(1.0); }\n    \"\"\"\n";
    assert!(found(&[("a.py", &format!("def load(self):\n    {text}    return 1\n"))]).0.is_empty());
    let given = "\"\"\"#version 330\nout vec4 c;\nvoid main() { c = vec3(1.0); }\n\"\"\"\n";
    by_default(&[("a.py", &format!("program = ctx.program(\n    fragment_shader=\n    {given})\n"))], "T003");
}

#[test]
fn a_macro_of_the_host_may_be_several_arguments() {
    let text = |argument: &str| {
        format!(
            "#version 330\n#pragma {{{{DEFINES}}}}\nconst float all[4] = float[4]({argument});\nout vec4 c;\n\
             void main() {{ c = vec4(all[int(gl_FragCoord.x) & 3]); }}\n"
        )
    };
    assert!(found(&[("a.frag", &text("AO_FACTORS"))]).0.is_empty());
    by_default(&[("a.frag", &text("1.0").replace("#pragma {{DEFINES}}\n", ""))], "E040");
}

#[test]
fn a_comment_that_a_host_has_in_quotes_is_filled_in() {
    let text = "#version 330\nout vec4 c;\nvoid main() {\n  // PLACEHOLDER: colour\n  c = vec4(r, g, b, 1.0);\n}\n";
    let host =
        |mark: &str| format!("std::string find(std::string name) {{ return {mark} + name; }} // glUseProgram(1)\n");
    let files = |host: &str| found(&[("a.frag", text), ("a.cpp", host)]).0;
    assert_eq!(files(&host("\"// PLACEHOLDER: \"")), [""; 0]);
    assert_eq!(files(&host("\"// placeholder \"")), ["E020", "E020", "E020"]);
    assert_eq!(files(&host("\"// OTHER: \"")), ["E020", "E020", "E020"]);
}
