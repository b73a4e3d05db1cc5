//! What hosts put in the place of comments, branches and holes, and what they define for a text.

use base::diagnostic::Severity;
use base::text::SourceFile;

use super::open::{by_default, found, only_on_request};
use crate::{Input, Settings, run_with};

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
fn host_code_may_define_a_name_whose_value_it_works_out() {
    let text = "#version 330\nout vec4 t;\nvoid main() { t = vec4(plane); }\n";
    let host = |line: &str| format!("void g() {{ {line} load(\"a.frag\"); glUseProgram(1); }}\n");
    for line in ["DefineConst4f(&all, \"plane\", p);", "defines[\"plane\"] = to_string(n);"] {
        only_on_request(&[("a.frag", text), ("a.cpp", &host(line))], "E020");
    }
    by_default(&[("a.frag", text), ("a.cpp", &host("glGetUniformLocation(1, \"plane\");"))], "E020");
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

#[test]
fn a_module_that_a_script_fills_in_is_read_where_it_is_known() {
    let text = |name: &str, value: &str| {
        format!(
            "import {{ scale }} from './scale';\nconst NAME = 'blit';\nexport const code = /* wgsl */ `\n\
             fn f(x: f32) -> f32 {{\n  let z: f32 = {value};\n  return x * z * ${{scale}};\n}}\n@fragment\n\
             fn ${{{name}}}() -> @location(0) vec4f {{ return vec4f(f(1.0)); }}\n`;\n"
        )
    };
    let scale = ("a/scale.ts", "export const scale = 2.5;\n");
    by_default(&[("a/b.ts", &text("NAME", "vec2f(1.0)")), scale], "E030");
    silent(&[("a/b.ts", &text("NAME", "1.0")), scale]);
    // What the program alone knows may be of any type.
    by_default(&[("a/b.ts", &text("name()", "vec2f(1.0)")), scale], "E030");
    let open = text("NAME", "vec2f(1.0) + ${rest(1)}");
    assert!(found(&[("a/b.ts", &open), scale]).0.is_empty());
}

#[test]
fn what_is_found_in_a_text_that_is_filled_in_is_told_where_it_is_written() {
    let part = "export const part = `\nfn g(x: f32) -> f32 {\n  let z: f32 = vec2f(x);\n  return z;\n}\n`;\n";
    let root = "import { part } from './part';\nexport const code = `\n${part}\n@compute @workgroup_size(1)\n\
                fn main() { let a = g(1.0); }\n`;\n";
    let inputs = [("a/part.ts", part), ("a/root.ts", root)];
    let inputs: Vec<Input> = inputs.iter().map(|(name, text)| Input::new(SourceFile::new(*name, *text))).collect();
    let found = run_with(&inputs, &Settings::default());
    let told: Vec<String> = found.iter().map(|d| format!("{} {}", d.code.0, d.file.locate(d.span.start))).collect();
    assert!(told.contains(&"E030 a/part.ts:3:16".to_owned()), "{told:?}");
}

#[test]
fn sizes_are_formats_of_images() {
    let text = |format: &str| {
        format!(
            "#version 420\n#extension GL_EXT_shader_image_load_store : require\n{format}uniform uimage1D n;\nout vec4 c;\n\
             void main() {{ imageStore(n, 1, uvec4(0u)); c = vec4(0.0); }}\n"
        )
    };
    silent(&[("a.frag", &text("layout(size1x32) "))]);
    by_default(&[("a.frag", &text(""))], "T019");
}

#[test]
fn what_an_engine_leaves_out_hides_nothing_else() {
    let text = |inside: &str, conditions: &str| {
        format!(
            "#define_import_path a::b\n@group(0) @binding(0) var t: texture_2d<f32>;\n@group(0) @binding(1) var s: sampler;\n\
             @fragment\nfn fs(@location(0) p: vec2<f32>) -> @location(0) vec4<f32> {{\n  var c = vec4<f32>(0.0);\n  \
             if p.x > 0.5 {{ {inside} }}\n{conditions}\n  return c;\n}}\n"
        )
    };
    let tint = "#ifdef TINT\n  c *= vec4<f32>(1.0, 0.5, 0.5, 1.0);\n#endif";
    by_default(&[("a.wgsl", &text("c = textureSample(t, s, p);", tint))], "W001");
    by_default(&[("a.wgsl", &text("c.x = vec2<f32>(1.0);", tint))], "E030");
    silent(&[("a.wgsl", &text("c = textureSampleLevel(t, s, p, 0.0);", tint))]);
    // Both parts are never there together, and each of them is in order.
    let either = "#ifdef WIDE\n  let w = vec2<f32>(1.0);\n  c.x = w.y;\n#else\n  let w = 1.0;\n  c.x = w;\n#endif";
    silent(&[("a.wgsl", &text("c.x = 0.0;", either))]);
    let apart = "#ifdef WIDE\n  let w = vec2<f32>(1.0);\n#endif\n#ifndef WIDE\n  let w = 1.0;\n  c.x = w;\n#endif";
    silent(&[("a.wgsl", &text("c.x = 0.0;", apart))]);
    by_default(&[("a.wgsl", &text("c.x = 0.0;", &apart.replace("c.x = w;", "c.x = vec2<f32>(w);")))], "E030");
}

#[test]
fn a_word_in_marks_that_a_host_replaces_is_filled_in() {
    let text = |mark: &str| {
        format!(
            "export const f = `#version 300 es\nprecision {mark} float;\nuniform sampler2D t;\nout vec4 o;\n\
             void main() {{ o = textureLod(t, gl_FragCoord.xy, 0.0); }}\n`;\n"
        )
    };
    let host = ("b.ts", "import { f } from './a';\nexport const g = f.replaceAll('{PRECISION}', 'mediump');\n");
    assert!(found(&[("a.ts", &text("{PRECISION}")), host]).0.is_empty());
    by_default(&[("a.ts", &text("{PRECISION}"))], "E001");
}

#[test]
fn an_include_that_is_not_there_may_define_macros_that_are_called() {
    let text = |head: &str| {
        format!(
            "#version 460\n{head}\nlayout(location = 0) out vec4 c;\nDeclare(1)\nvoid main() {{ c = vec4(1.0); }}\n"
        )
    };
    only_on_request(&[("a.frag", &text("#include <common/material.glsl>"))], "E001");
    by_default(&[("a.frag", &text(""))], "E001");
    let asks = |head: &str| {
        format!("#version 430\n{head}\n#if HAS(ao)\n#endif\nout vec4 r;\nvoid main() {{ r = vec4(1.0); }}\n")
    };
    only_on_request(&[("a.frag", &asks("#pragma include \"base.glsl\""))], "E012");
    by_default(&[("a.frag", &asks(""))], "E012");
}

#[test]
fn what_a_guessed_host_has_may_be_otherwise_in_every_variant() {
    let text = |call: &str| {
        format!(
            "//#define LOW\nvoid mainImage(out vec4 fragColor, in vec2 fragCoord) {{\n  vec3 d = vec3(fragCoord, 1.0);\n\
             #ifdef LOW\n  d *= 2.0;\n#endif\n  fragColor = {call};\n}}\n"
        )
    };
    for call in ["textureLod(iChannel0, d, 0.0)", "vec4(box_dist(d))"] {
        assert!(found(&[("a.glsl", &text(call))]).0.is_empty(), "{call}");
    }
    by_default(&[("a.glsl", &text("vec3(d)"))], "T003");
    // What a condition asks for has the value that whoever defines it gives it.
    let valued = "void mainImage(out vec4 fragColor, in vec2 fragCoord) {\n  float w = fragCoord.x;\n#ifdef FLOW\n  \
                  w = min(FLOW, w);\n#endif\n  fragColor = vec4(w);\n}\n";
    assert!(found(&[("a.glsl", valued)]).0.is_empty());
}

#[test]
fn a_macro_that_one_text_defines_and_another_has_in_a_comment_is_no_option() {
    let text = |head: &str, call: &str| {
        format!(
            "#version 450\n{head}\nfloat f(\n#ifdef MAP\nfloat m,\n#endif\nfloat x) {{ return x; }}\nout vec4 c;\nvoid main() {{ c = vec4({call}); }}\n"
        )
    };
    let (off, on) = (text("//#define MAP", "f(1.0)"), text("#define MAP", "f(1.0, 2.0)"));
    by_default(&[("a.frag", &off)], "E022");
    assert!(found(&[("a.frag", &off), ("b.frag", &on)]).0.is_empty());
}

#[test]
fn a_name_with_the_mark_of_a_stage_is_read_as_its_text_says() {
    let vertex = "#version 450\nlayout(location = 0) in vec3 p;\nlayout(location = 0) out vec3 o;\n\
                  void main() { o = p; gl_Position = vec4(p, 1.0); }\n";
    silent(&[("vert.mrt.cs.glsl", vertex)]);
    // F# has the ending of fragment shaders.
    silent(&[(
        "Program.fs",
        "open Aardvark.Base\n[<EntryPoint>]\nlet main argv =\n    let c = [| C4b.Red |]\n    0\n",
    )]);
    by_default(&[("a.fs", "vec4 shade(vec3 n) {\n  return vec4(n, 1.0)\n}\nfloat g() { return 1.0; }\n")], "E001");
    only_on_request(
        &[("a.fs", "vec4 shade(vec3 n) {\n  return vec4(n, 1.0) HOST\n}\nfloat g() { return 1.0; }\n")],
        "E001",
    );
}

#[test]
fn declarations_that_an_engine_rewrites_are_of_no_language() {
    let text = |head: &str, gain: &str| {
        format!("{head}\n@fragment\nfn fs() -> @location(0) vec4f {{ return vec4f({gain}); }}\n")
    };
    let engine = text("uniform gain: f32;\nvarying uv: vec2f;", "uniform.gain");
    assert!(found(&[("a.wgsl", &engine)]).0.is_empty());
    silent(&[("a.wgsl", &text("var<private> gain: f32;", "gain"))]);
}

#[test]
fn numbers_that_stand_for_what_a_template_fills_in_say_nothing() {
    let text = |index: &str| {
        format!(
            "var<workgroup> mask: array<atomic<u32>, {{{{ count }}}}u>;\n@compute @workgroup_size(8)\n\
             fn main(@builtin(local_invocation_index) i: u32) {{\n  if i == 0u {{ atomicStore(&mask[{index}u], 0u); }}\n}}\n"
        )
    };
    assert!(warned(&text("{{ w }}")).is_empty());
    assert_eq!(warned(&text("7").replace("{{ count }}", "7")), ["K010"]);
}

/// Codes of warnings about a module in WGSL.
fn warned(text: &str) -> Vec<&'static str> {
    let found = run_with(&[Input::new(SourceFile::new("a.wgsl", text))], &Settings::default());
    found.iter().filter(|d| d.severity == Severity::Warning).map(|d| d.code.0).collect()
}
