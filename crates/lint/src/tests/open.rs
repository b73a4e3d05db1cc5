//! What a host may take away, and what stays.

use base::text::SourceFile;

use crate::{Input, Level, Selection, Settings, run_with};

/// Codes of what is found by default in files, and of what is found beyond it.
pub(super) fn found(files: &[(&str, &str)]) -> (Vec<String>, Vec<String>) {
    let inputs: Vec<Input> = files.iter().map(|(name, text)| Input::new(SourceFile::new(*name, *text))).collect();
    let codes = |level: Level| -> Vec<String> {
        let selection = Selection::new(&[], &[]).unwrap().at(level);
        let found = run_with(&inputs, &Settings { selection, ..Settings::default() });
        found.iter().filter(|d| d.severity == base::diagnostic::Severity::Error).map(|d| d.code.0.to_owned()).collect()
    };
    let default = codes(Level::Default);
    let mut strict = codes(Level::Strict);
    for code in &default {
        strict.remove(strict.iter().position(|c| c == code).unwrap());
    }
    (default, strict)
}

pub(super) fn only_on_request(files: &[(&str, &str)], code: &str) {
    let (default, strict) = found(files);
    assert!(default.is_empty() && strict.iter().any(|c| c == code), "{files:?}: {default:?}, {strict:?}");
}

pub(super) fn by_default(files: &[(&str, &str)], code: &str) {
    let (default, _) = found(files);
    assert!(default.iter().any(|c| c == code), "{files:?}: {default:?}");
}

#[test]
fn a_piece_is_judged_where_it_is_whole() {
    only_on_request(&[("light.glsl", "color += shade(n, l) * lamps[i].color;\n")], "E001");
    only_on_request(&[("noise.glsl", "float f(vec2 p) { return hash(p); }\n")], "E021");
    only_on_request(&[("facade.vert", "#define varying out\n")], "E025");
    let overload = "float ao(vec2 p, float x) { return min(x, ao(p)); }\n";
    only_on_request(&[("ao.glsl", overload)], "E022");
    by_default(&[("ao.glsl", &overload.replace("ao(p)", "dot(p)"))], "E022");
    only_on_request(&[("surface.frag", "vec3 main() { return vec3(1.0); }\n")], "E046");
    by_default(&[("noise.glsl", "vec2 f(vec2 p) { vec3 q = p; return q.xy; }\n")], "T003");
    by_default(&[("junk.frag", "placeholder")], "E001");
}

#[test]
fn an_error_directive_asks_its_host_for_a_macro() {
    let of = |otherwise: &str| {
        format!(
            "#version 330\n#ifdef FLAT\nin vec2 p;\n#elif defined(DEEP)\nin vec4 p;\n#else\n{otherwise}\n#endif\n\
             void main() {{ gl_Position = vec4(p.xy, 0.0, 1.0); }}\n"
        )
    };
    let (default, _) = found(&[("a.vert", &of("#error FLAT or DEEP"))]);
    assert!(!default.contains(&"E013".to_owned()), "{default:?}");
    by_default(&[("a.vert", "#version 330\n#error no\nvoid main() { gl_Position = vec4(0.0); }\n")], "E013");
    let old = "#version 120\n#if __VERSION__ < 130\n#error old\n#endif\nvoid main() { gl_Position = vec4(0.0); }\n";
    by_default(&[("a.vert", old)], "E013");
}

#[test]
fn a_version_that_is_filled_in_is_none() {
    let text = "#version __CONTEXT__\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n";
    only_on_request(&[("a.frag", text)], "E002");
    by_default(&[("a.frag", &text.replace("vec4(1.0)", "vec4(1.0, 2.0)"))], "T002");
}

#[test]
fn texts_for_another_reader_are_left_to_it() {
    let shader = |line: &str, body: &str| format!("#version 450\n{line}\nout vec4 c;\nvoid main() {{ c = {body}; }}\n");
    only_on_request(&[("a.frag", &shader("AppInclude(include/Light.glsl)", "light()"))], "E001");
    let matrix = "#extension GL_KHR_cooperative_matrix : enable";
    only_on_request(&[("a.frag", &shader(matrix, "vec4(1.0); coopmat<float, 3> m; c += m"))], "E020");
    by_default(&[("a.frag", &shader(matrix, "vec4(1.0) * missing"))], "E020");
    by_default(&[("a.frag", &shader("light(c.rgb);", "vec4(1.0)"))], "E001");
    // Macros of whoever puts a version in front.
    let unversioned = "layout(FORMAT, binding = 0) writeonly uniform PRECISION image2D o;\nvoid main() { imageStore(o, ivec2(0), vec4(1.0)); }\n";
    assert_eq!(found(&[("a.comp", unversioned)]).0, Vec::<String>::new());
    by_default(&[("a.comp", &format!("#version 450\n{unversioned}"))], "E001");
}

#[test]
fn what_another_preprocessor_reads_is_left_to_it() {
    let shader = |line: &str, body: &str| format!("#version 330\n{line}\nout vec4 c;\nvoid main() {{ c = {body}; }}\n");
    only_on_request(&[("a.frag", &shader("@import light;", "light()"))], "E002");
    only_on_request(&[("a.frag", &shader("#pragma glslify: light = require('light')", "light()"))], "E021");
    let passes = "@pass(noise)\nuniform float time;\n@pass_end\nuniform float time;";
    only_on_request(&[("a.frag", &shader(passes, "vec4(time)"))], "E024");
    by_default(&[("a.frag", &shader("uniform float time;\nuniform float time;", "vec4(time)"))], "E024");
    only_on_request(&[("a.frag", &shader("[[INPUTS]]", "vec4(1.0)"))], "E002");
    only_on_request(&[("a.frag", &shader("##INPUTS##", "vec4(1.0)"))], "E002");
    only_on_request(&[("a.frag", &shader("in %Bones% b;", "vec4(1.0)"))], "E002");
    by_default(&[("a.frag", &shader("in % b;", "vec4(1.0)"))], "E001");
    only_on_request(&[("a.frag", &shader("#include \"light.glsl\"\nHIGH_PRECISION;", "vec4(1.0)"))], "E001");
    only_on_request(&[("a.frag", &shader("const int n = $COUNT;", "vec4(n)"))], "E002");
    by_default(&[("a.frag", &shader("#include \"light.glsl\"", "vec3(1.0)"))], "T003");
    by_default(&[("a.frag", &shader("", "light()"))], "E021");
    by_default(&[("a.frag", &shader("#include \"light.glsl\"\nout vec2 d", "vec4(1.0)"))], "E001");
    by_default(&[("a.frag", &shader("#include \"light.glsl\"\nconst int n = 10", "vec4(n)"))], "E001");
    let handle = "#include \"light.glsl\"\nuniform uvec2 handle;";
    only_on_request(&[("a.frag", &shader(handle, "texture(sampler2D(handle), vec2(0.5))"))], "E040");
    let sampler = "#include \"light.glsl\"\nuniform sampler2D shadow;";
    by_default(&[("a.frag", &shader(sampler, "vec4(shadow)"))], "E040");
}

#[test]
fn an_error_that_a_definition_from_outside_takes_away_is_told_on_request() {
    let shader = |condition: &str| {
        format!("#version 330\n{condition}\nin vec3 t;\n#endif\nout vec4 c;\nvoid main() {{ c = vec4(t, 1.0); }}\n")
    };
    only_on_request(&[("a.frag", &shader("#ifdef TANGENTS"))], "E020");
    by_default(&[("a.frag", &shader("#define TANGENTS 0\n#if TANGENTS"))], "E020");
    // Another definition may leave the place out.
    let two = shader("#ifdef TANGENTS")
        .replace("void main() {", "#ifdef DEPTH\nvoid main() { c = vec4(0.0); }\n#else\nvoid main() {");
    only_on_request(&[("a.frag", &format!("{two}#endif\n"))], "E020");
    // What the definition leaves out stays wrong.
    let other =
        "#version 330\nout vec4 c;\nvoid main() {\n#ifdef FLAT\nc = vec4(1.0);\n#else\nc = vec3(1.0);\n#endif\n}\n";
    by_default(&[("a.frag", other)], "T003");
}

#[test]
fn names_of_pieces_and_of_texts_in_host_code_may_stand_in_front() {
    let shader = "#version 330\nout vec4 c;\n//%lamps%\nvoid main() { c = vec4(ambient); }\n";
    by_default(&[("a.frag", shader)], "E020");
    only_on_request(&[("a.frag", shader), ("lamps.glsl", "uniform float ambient;\n")], "E020");
    only_on_request(&[("a.frag", shader), ("lamps.glsl", "#version 330\nuniform float ambient;\n")], "E020");
    let host = "void f() { text = \"uniform float ambient;\\n\" + text; }\n";
    only_on_request(&[("a.frag", shader), ("a.cpp", host)], "E020");
    // Another whole shader declares its names for itself, in a file or in a literal.
    let whole = "#version 330\nuniform float ambient;\nvoid main() { gl_Position = vec4(ambient); }\n";
    by_default(&[("a.frag", shader), ("b.vert", whole)], "E020");
    let literal = format!("const char* t = R\"({whole})\";\nvoid f() {{ glShaderSource(s, 1, &t, 0); }}\n");
    by_default(&[("a.frag", shader), ("b.cpp", &literal)], "E020");
}

#[test]
fn a_text_in_another_language_is_left_to_its_tool() {
    let shader = |line: &str| format!("#version 330\n{line}\nout vec4 c;\nvoid main() {{ c = vec3(1.0); }}\n");
    for line in [
        "const vec3 tint = #9CF0C0;",
        "struct Sun { const mat4* matrix; };",
        "uniform Sun* const sun = suns;",
        "[FragmentShader]",
        "Texture2D map : register(t0);",
        "vec4 shade(vec2 t) : COLOR0 { return t.xyxy; }",
        "uniform tensorARM<float, 4> weights;",
        "void load() { coopmat<float, ROWS, 16> tile = zero(); }",
    ] {
        only_on_request(&[("a.frag", &shader(line))], "T003");
    }
    only_on_request(&[("a.frag", "float4 main(float2 t : TEXCOORD0) : COLOR\n{ return t.xyxy; }\n")], "E001");
    by_default(&[("a.frag", &shader("float f(float x) { return x * * x; }"))], "T003");
    by_default(&[("a.frag", &shader("float f(bool b) { return b ? 1.0 : ; }"))], "E001");
    by_default(&[("a.frag", &shader("float f[2] = [1.0, 2.0];"))], "E001");
}

#[test]
fn an_unknown_extension_may_bring_types_and_rules() {
    let shader = |extension: &str, body: &str| {
        format!("#version 460\n{extension}\nout vec4 c;\nvoid main() {{ float f[2]; c = {body}; }}\n")
    };
    let (unknown, length) = ("#extension GL_NV_gpu_shader5 : require", "vec4(f.length)");
    only_on_request(&[("a.frag", &shader(unknown, length))], "E034");
    by_default(&[("a.frag", &shader("", length))], "E034");
    // What is only enabled may be missing.
    by_default(&[("a.frag", &shader(&unknown.replace("require", "enable"), length))], "E034");
    by_default(&[("a.frag", &shader(unknown, "vec4(1.0).xyz"))], "T003");
}

#[test]
fn a_host_may_define_a_qualifier_that_is_used_once() {
    let image = "layout(FORMAT, binding = 0) writeonly uniform PRECISION image2D target;\n\
        layout(local_size_x = 4) in;\nvoid main() { imageStore(target, ivec2(0), vec4(1.0)); }\n";
    only_on_request(&[("a.comp", image)], "E001");
    // A version says that nothing comes in front, and a slip is one.
    by_default(&[("a.comp", &format!("#version 310 es\n{image}"))], "E001");
    by_default(&[("a.comp", &image.replace("PRECISION", "Precision").replace("FORMAT", "rgba8"))], "E001");
    // Generators fill in what is behind a macro.
    let filled = "#version 450 core\n#define PRECISION ${PRECISION}\n#define op(x) ${OPERATOR}\n\
        layout(push_constant) uniform PRECISION restrict Block { int n; };\nlayout(location = 0) out vec4 c;\n\
        void main() { c = vec4(op(n)); }\n";
    only_on_request(&[("a.frag", filled)], "E002");
}

#[test]
fn who_defines_a_macro_says_what_it_stands_for() {
    let text = |value: &str| {
        format!(
            "#version 330\n{value}uniform sampler2D s;\nin vec2 p;\nout vec4 c;\nvoid main() {{\n  c = texture(s, p);\n\
             #ifdef SHADOW\n  vec2 moved = SHADOW * 0.5;\n  c = texture(s, p + moved);\n#endif\n}}\n"
        )
    };
    only_on_request(&[("a.frag", &text(""))], "T003");
    by_default(&[("a.frag", &text("#define SHADOW 1.0\n"))], "T003");
    by_default(&[("a.frag", &text("").replace("SHADOW * 0.5", "0.5"))], "T003");
}

#[test]
fn what_stands_beside_a_hole_is_told() {
    let shader = |line: &str, value: &str| {
        format!(
            "#version 330\n{line}\nout vec4 c;\nvec4 own() {{ vec4 p = {value}; return p; }}\nvoid main() {{ c = own(); }}\n"
        )
    };
    for line in [
        "const float a = ${PI};",
        "{{ uniforms }}",
        "$type x;",
        "in vec%N% v;",
        "float w[[[COUNT]]];",
        "@import light;",
        "[[INPUTS]]",
        "${declare(B, 0)}",
        "vec2 f(vec2 p) { return <moved(p)>; }",
        "$if HALF == \"yes\":\n#define T float",
        "{% if half %}\nuniform vec2 t;\n{% else %}\nuniform vec4 t;\n{% endif %}",
    ] {
        only_on_request(&[("a.frag", &shader(line, "vec4(1.0)"))], "E002");
        by_default(&[("a.frag", &shader(line, "vec3(1.0)"))], "T003");
        by_default(&[("a.frag", &shader(line, "vec4(1.0, 2.0)"))], "T002");
    }
    // What stands for declarations may bring names; what stands for a value does not.
    only_on_request(&[("a.frag", &shader("{{ uniforms }}", "vec4(light)"))], "E020");
    by_default(&[("a.frag", &shader("const float a = {{ pi }};", "vec4(light)"))], "E020");
}

#[test]
fn names_in_braces_are_filled_in() {
    let text = "varying vec2 v;\nuniform float weight[{SAMPLES}];\nvoid main() {\n  float sum = 0.0;\n  \
        for (int i = 0; i < {SAMPLES}; i++) { sum += weight[i]; }\n  gl_FragColor = vec4(sum);\n}\n";
    only_on_request(&[("a.frag", text)], "E002");
    by_default(&[("a.frag", &text.replace("{SAMPLES}", "{1, 2}"))], "E001");
}

#[test]
fn geometry_stages_of_glsl_120_have_words_of_their_own() {
    let text = |enabled: &str| {
        format!(
            "#version 120\n{enabled}varying in vec4 tint[];\nvarying out vec4 own;\nvoid main() {{\n  own = tint[0];\n  \
             gl_Position = gl_PositionIn[0]; EmitVertex();\n}}\n"
        )
    };
    only_on_request(&[("a.geom", &text("#extension GL_EXT_geometry_shader4 : enable\n"))], "E042");
    by_default(&[("a.geom", &text(""))], "E042");
}

#[test]
fn a_qualifier_in_capitals_may_be_defined_in_front() {
    let text = |first: &str| format!("{first}FUNC float a() {{ return 1.0; }}\nFUNC float b() {{ return a(); }}\n");
    let shader = |first: &str| format!("#version 330\n{}void main() {{}}\n", text(first));
    only_on_request(&[("a.frag", &shader(""))], "E001");
    only_on_request(
        &[("a.frag", "#version 330\nFUNC_END\n/* A ray */\nstruct Ray { vec3 at; };\nFUNC_END\nvoid main() {}\n")],
        "E001",
    );
    assert!(found(&[("a.frag", &shader("#define FUNC\n"))]).0.is_empty());
    by_default(&[("a.frag", "#version 330\nHELLO WORLD\nin vec3 p;\nvoid main() {}\n")], "E001");
    let missing = "#version 330\n#define TINT vec4(1.0)\nout vec4 c;\nvoid main() { c = TINT c += c; }\n";
    by_default(&[("a.frag", missing)], "E001");
    let unknown = "#version 330\n#define STACK STACK_OF(vec3)\nSTACK s;\nvoid main() {}\n";
    only_on_request(&[("a.frag", unknown)], "E001");
}

#[test]
fn a_text_without_a_version_may_be_of_either_language() {
    let constant = "const vec3 LIGHT = normalize(vec3(1.0, 2.0, 3.0));\nvoid main() { gl_FragColor = LIGHT.xyzz; }\n";
    only_on_request(&[("a.frag", constant)], "E044");
    by_default(&[("a.frag", &format!("#version 110\n{constant}"))], "E044");
    let varying = "varying float x;\nconst float y = x;\nvoid main() { gl_FragColor = vec4(y); }\n";
    by_default(&[("a.frag", varying)], "E044");
}

#[test]
fn what_a_newer_version_has_is_no_error_of_a_piece() {
    let piece = "vec3 screen(vec3 a, vec3 b) {\n  bvec3 m = lessThan(a, vec3(0.5));\n  return mix(a, b, m);\n}\n";
    only_on_request(&[("lib/a.glsl", piece)], "E022");
    by_default(&[("a.glsl", &format!("#version 120\n{piece}void main() {{}}\n"))], "E022");
    by_default(&[("lib/a.glsl", &piece.replace("mix(a, b, m)", "dot(a, b.xy)"))], "E022");
    by_default(&[("a.geom", "#version 150\nin vec3 v;\nvec3 f(vec3 p) { return p + v; }\n")], "G007");
    let stated = format!("#version 330\n{}", piece.replace("mix(a, b, m)", "a * b * half3(1.0) + shade(m)"));
    only_on_request(&[("lib/a.glsl", &stated)], "E021");
}

#[test]
fn a_name_that_many_texts_lack_is_supplied_by_their_host() {
    let text =
        |n: usize, name: &str| format!("#version 330\nout vec4 c;\nvoid main() {{ c = vec4({name} * {n}.0); }}\n");
    let texts: Vec<String> = (1..=3).map(|n| text(n, "og_oneOverPi * og_sunDirection.z")).collect();
    let other = text(4, "sun_strength");
    let named = [("a.frag", &texts[0]), ("b.frag", &texts[1]), ("c.frag", &texts[2]), ("d.frag", &other)];
    let files: Vec<(&str, &str)> = named.iter().map(|(name, text)| (*name, text.as_str())).collect();
    only_on_request(&files, "E020");
    by_default(&files[..2], "E020");
    let copies = [("a.frag", texts[0].as_str()), ("b.frag", &texts[0]), ("c.frag", &texts[0])];
    by_default(&copies, "E020");
    // One mistake can stand in several copies of a text.
    let one: Vec<String> = (1..=3).map(|n| text(n, "depthMap")).collect();
    by_default(&[("a.frag", one[0].as_str()), ("b.frag", &one[1]), ("c.frag", &one[2])], "E020");
    // A slip is told all the same.
    let slip = "#version 330\nuniform float gain;\nout vec4 c;\nvoid main() { c = vec4(gian); }\n";
    by_default(&[files[0], files[1], files[2], ("e.frag", slip)], "E020");
}

#[test]
fn templates_in_directives_are_filled_in() {
    let shader = |line: &str| format!("#version 330\n{line}\nout vec4 c;\nvoid main() {{ c = vec4(1.0); }}\n");
    only_on_request(&[("a.frag", &shader("#define MODE ${mode}\n#if MODE == 1\n#endif"))], "E002");
    only_on_request(&[("a.frag", &shader("").replace("330", "$version core"))], "E002");
    by_default(&[("a.frag", &shader("").replace("330", "33o"))], "E012");
    let half = "#ifdef GL_NV_gpu_shader5\n#extension GL_NV_gpu_shader5 : enable\n#endif\nf16vec3 n;";
    only_on_request(&[("a.frag", &shader(half))], "V010");
}

#[test]
fn a_type_of_an_extension_is_enabled_where_the_version_is_stated() {
    let text = |head: &str, tail: &str| {
        format!(
            "{head}layout(std430, binding = 0) buffer B {{ uint64_t a[]; }};\n\
             uint64_t f(uint64_t x) {{ return atomicAdd(a[0], x) + atomicMax(a[1], 1ul); }}\n\
             float16_t g(f16vec3 a, f16vec3 b) {{ f16vec3 c = normalize(a); return dot(c, mix(a, b, c)); }}\n{tail}"
        )
    };
    let main = "layout(local_size_x = 1) in;\nvoid main() { a[2] = f(a[0]) + uint64_t(g(f16vec3(1), f16vec3(2))); }\n";
    only_on_request(&[("a.glsl", &text("", ""))], "V010");
    only_on_request(&[("a.comp", &text("", main))], "V010");
    for version in ["#version 310 es\nprecision highp float;\n", "#version 450\n"] {
        let (default, _) = found(&[("a.comp", &text(version, main))]);
        assert!(!default.is_empty() && default.iter().all(|code| code == "V010"), "{default:?}");
    }
    // What no extension mends is told.
    by_default(&[("a.comp", &text("", &main.replace("a[2]", "vec2 q = vec3(1.0); a[2]")))], "T003");
}

#[test]
fn a_shader_without_main_may_be_joined_to_others() {
    let text = |name: &str| format!("#version 330\nout vec4 c;\nvoid {name}() {{ c = vec4(1.0); }}\n");
    only_on_request(&[("a.frag", &text("shade"))], "E025");
    by_default(&[("a.frag", &text("mian"))], "E025");
}

#[test]
fn a_file_of_raw_strings_is_host_code() {
    let shader = |value: &str| {
        format!("static const char a_frag[] = R\"(\n#version 330\nout vec4 c;\nvoid main() {{ c = {value}; }}\n)\";\n")
    };
    let two = shader("vec4(1.0)").repeat(2);
    assert!(found(&[("shaders.glsl", &two)]).0.is_empty());
    assert!(
        found(&[("shader.frag", "R\"zz(\nvarying vec2 p;\nvoid main() { gl_FragColor = vec4(p, p); }\n)zz\"\n")])
            .0
            .is_empty()
    );
    by_default(&[("quoted.frag", "#version 330\nout vec4 c;\nvoid main() { c = R\"; }\n")], "E002");
}

#[test]
fn a_macro_may_be_defined_in_front_and_a_slip_in_one_is_told() {
    let text =
        |name: &str| format!("#version 330\n#define LAMP_COUNT 4\nout vec4 c;\nvoid main() {{ c = vec4({name}); }}\n");
    only_on_request(&[("a.frag", &text("FOG_LIMIT"))], "E020");
    by_default(&[("a.frag", &text("LAMP_COUNTS"))], "E020");
}

#[test]
fn nothing_is_said_that_depends_on_an_unknown_stage() {
    let text = "#version 330\nlayout(location = 0) in vec3 p;\nout vec3 q;\nvoid main() { q = p; }\n";
    only_on_request(&[("shader.glsl", text)], "V002");
    by_default(&[("shader_fs.glsl", text)], "V002");
    assert!(found(&[("shader_vs.glsl", text)]).0.is_empty());
}

#[test]
fn a_name_in_a_text_without_a_version_is_told_where_it_is_a_slip() {
    let text = |name: &str| format!("varying vec3 normal;\nvoid main() {{ gl_FragColor = vec4({name}, 1.0); }}\n");
    only_on_request(&[("a.frag", &text("sceneTint"))], "E020");
    by_default(&[("a.frag", &text("normol"))], "E020");
    // Who puts other names in front puts those there that are like one of the text.
    only_on_request(&[("a.frag", &text("normals * sceneTint"))], "E020");
    let local = text("tangnet * sceneTint").replace("gl_FragColor", "vec3 tangent = normal.yzx; gl_FragColor");
    by_default(&[("a.frag", &local)], "E020");
    // A slip happens once; what stands further down is meant however often.
    only_on_request(&[("a.frag", &text("normol * normol"))], "E020");
    let below =
        "varying float x;\nvoid main() { gl_FragColor = vec4(lit(x) + lit(1.0)); }\nfloat lit(float y) { return y; }\n";
    by_default(&[("a.frag", below)], "E021");
}

#[test]
fn an_include_is_a_part_of_the_language_where_an_extension_has_it() {
    let text = |line: &str| {
        format!(
            "#version 450\n{line}#include \"part.h\"\nlayout(location = 0) out vec4 c;\nvoid main() {{ c = vec4(1.0); }}\n"
        )
    };
    only_on_request(&[("a.frag", &text(""))], "E015");
    for name in ["GL_GOOGLE_include_directive", "GL_ARB_shading_language_include"] {
        let text = text(&format!("#extension {name} : require\n"));
        let inputs = [crate::Input::new(base::text::SourceFile::new("a.frag", text))];
        let selection = crate::Selection::default().at(crate::Level::Heuristic);
        let found = crate::run_with(&inputs, &crate::Settings { selection, ..crate::Settings::default() });
        assert!(found.iter().all(|d| d.code.0 != "E015"), "{found:?}");
    }
}

#[test]
fn a_mark_that_a_project_repeats_is_of_another_tool() {
    let hook = |name: &str| {
        format!(
            "#version 330\nin vec2 p;\nout vec4 c;\nvoid main() {{\n  vec2 q = *{name}(p);\n  c = vec3(q, 1.0);\n}}\n"
        )
    };
    let (a, b, c) = (hook("moved"), hook("turned"), hook("scaled"));
    only_on_request(&[("a.frag", a.as_str()), ("b.frag", &b), ("c.frag", &c)], "E001");
    only_on_request(&[("a.frag", a.as_str()), ("b.frag", &b), ("c.frag", &c)], "T003");
    // A slip happens once, and copies of a text have one mistake.
    by_default(&[("a.frag", a.as_str()), ("b.frag", &b)], "E001");
    by_default(&[("a.frag", a.as_str()), ("b.frag", &a), ("c.frag", &a)], "E001");
    // Something is missing in front of what ends a statement, however often.
    let missing = |at: &str| format!("#version 330\nin vec2 p;\nout vec4 c;\nvoid main() {{ c = vec4(p, {at}; }}\n");
    let (a, b, c) = (missing("0.0, 1.0"), missing("p"), missing("0.5, 0.5"));
    by_default(&[("a.frag", a.as_str()), ("b.frag", &b), ("c.frag", &c)], "E001");
}

#[test]
fn a_name_that_the_text_has_in_quotes_is_known_to_its_host() {
    let text =
        |head: &str| format!("{head}varying float radios;\nvoid main() {{ gl_FragColor = vec4(radius * radios); }}\n");
    by_default(&[("a.frag", &text(""))], "E020");
    only_on_request(&[("a.frag", &text("/* settings: \"radius\" = 0.5 */\n"))], "E020");
    by_default(&[("a.frag", &text("/* The radius of the lamp. */\n"))], "E020");
}

#[test]
fn what_does_not_fit_a_host_that_is_guessed_shows_another_host() {
    let text = |at: &str| {
        format!(
            "vec4 noise(float x) {{ return IMG_NORM_PIXEL(noiseImage, vec2(x){at}); }}\nvoid main() {{ gl_FragColor = noise(TIME + RENDERSIZE.x); }}\n"
        )
    };
    only_on_request(&[("a.fs", &text(", 0.0"))], "E014");
    assert!(found(&[("a.fs", &text(""))]).0.is_empty());
}

#[test]
fn what_follows_from_a_macro_in_the_grammar_is_told_with_it() {
    let text = |name: &str| {
        format!(
            "#version 450\n#include <engine.h>\n{name}\n{{\n  vec4 tint;\n}} own;\nlayout(location = 0) out vec4 c;\nvoid main() {{ c = vec4(1.0); }}\n"
        )
    };
    let (default, strict) = found(&[("a.frag", &text("PROPERTIES"))]);
    assert!(default.is_empty() && strict.iter().filter(|code| *code == "E001").count() > 1, "{default:?} {strict:?}");
    by_default(&[("a.frag", &text("uniform Own : properties"))], "E001");
}

#[test]
fn two_mains_are_two_shaders_in_one_file() {
    let notes = "in vec3 p;\nout vec2 q;\nvoid main() { q = p.xy; gl_Position = vec4(p, 1.0); }\n\n\
        in vec2 q;\nout vec4 c;\nvoid main() { c = vec4(q, 0.0, 1.0); }\n";
    only_on_request(&[("notes.glsl", notes)], "E024");
    by_default(&[("notes.glsl", &notes.replace("void main() { q", "void first() { q"))], "E024");
}

#[test]
fn a_handle_may_be_enabled_where_a_variant_uses_it() {
    let text = |include: &str| {
        format!(
            "#version 460\n{include}uniform uvec2 handle;\nin vec2 p;\nout vec4 c;\nvoid main() {{\n  c = vec4(1.0);\n#ifdef MAP\n  c = texture(sampler2D(handle), p);\n#endif\n}}\n"
        )
    };
    only_on_request(&[("a.frag", &text("#include \"bindless.glsl\"\n"))], "E040");
    // What stands in every variant, and beside no include, is told.
    by_default(&[("a.frag", &text("").replace("#ifdef MAP\n", "").replace("#endif\n", ""))], "E040");
}

#[test]
fn shaders_in_a_block_of_a_file_end_with_it() {
    let stage = |out: &str| format!("#version 450\nlayout(location = 0) {out}\n");
    let file = |vertex: &str| {
        format!(
            "[Name(\"Ground\")]\nShader\n{{\n  #stage vertex\n{{\n{}void main() {{ {vertex}; }}\n}}\n#stage fragment\n{{\n{}void main() {{ c = vec4(1.0); }}\n}}\n}}\n",
            stage("in vec3 p;"),
            stage("out vec4 c;")
        )
    };
    assert_eq!(found(&[("ground.glsl", &file("gl_Position = vec4(p, 1.0)"))]).0, Vec::<String>::new());
    by_default(&[("ground.glsl", &file("gl_Position = vec3(p)"))], "T003");
}

#[test]
fn assembly_is_no_glsl() {
    let program = "!!ARBfp1.0\nMOV result.color, fragment.color;\nEND\n";
    assert!(found(&[("a.fs", program)]).0.is_empty());
    by_default(&[("a.fs", &program[2..])], "E001");
}

#[test]
fn what_an_include_may_define_or_hold_is_told_on_request() {
    let text = |body: &str| format!("#version 450\n#include \"missing.h\"\n{body}\nlayout(location = 0) out vec4 c;\n");
    let of = |body: &str, main: &str| text(body) + "void main() {\n" + main + "\n}\n";
    let inline = of("inline float half_of(const float x,\n    const float y)\n{ return x * y; }", "c = vec4(1.0);");
    only_on_request(&[("a.frag", &inline)], "E001");
    only_on_request(&[("a.frag", &inline)], "E044");
    let block = of("uniform U {\n#include \"members.h\"\n vec4 own;\n} u;", "c = u.own * u.other;");
    only_on_request(&[("a.frag", &block)], "E034");
    // A block of which every member is seen has no more.
    let seen = of("uniform U {\n vec4 own;\n} u;", "c = u.own * u.other;");
    by_default(&[("a.frag", &seen)], "E034");
    // Without an include, nothing is left open.
    let whole = |text: &str| text.lines().filter(|line| !line.starts_with("#include")).collect::<Vec<_>>().join("\n");
    by_default(&[("a.frag", &whole(&inline))], "E001");
    by_default(&[("a.frag", &whole(&block))], "E034");
}

#[test]
fn a_value_of_another_type_is_an_error_in_any_piece_of_wgsl() {
    let piece = |result: &str| format!("fn shade(v: vec3f, i: u32) -> f32 {{\n  return {result};\n}}\n");
    for (result, code) in [
        ("dot(v, tint) + f32(any(v < vec3f() || v > vec3f(1)))", "E031"),
        ("v", "E038"),
        ("gain * shade(v.xy, 1)", "E022"),
    ] {
        by_default(&[("a.wgsl", &piece(result))], code);
        // What stands in another variant is wrong in that one, and has the types of that one.
        by_default(&[("a.wgsl", &format!("#ifdef A\n{}#endif\n", piece(result)))], code);
        let typed = "#ifdef A\nalias V = vec3f;\n#else\nalias V = f32;\n#endif\n";
        let varied = format!(
            "{typed}fn half(v: V) -> V {{ return v; }}\n#ifndef A\nfn f() -> f32 {{ return half(1.0); }}\n#endif\n"
        );
        assert!(found(&[("a.wgsl", &varied)]).0.is_empty());
    }
    for result in ["gain", "v.x * 2", "other(v.xy, i) + gain"] {
        let told = found(&[("a.wgsl", &piece(result))]).0;
        assert!(told.is_empty(), "{result}: {told:?}");
    }
}

#[test]
fn a_host_may_put_a_precision_behind_a_version() {
    let text = "#version 300 es\nuniform float k;\nout vec4 c;\nvoid main() { c = vec4(k); }\n";
    let host = |between: &str| {
        format!(
            "import src from './a.frag';\nconst text = src.slice(0, 15) + \"{between}\" + src.slice(15);\n\
             gl.shaderSource(s, text);\n"
        )
    };
    by_default(&[("a.frag", text)], "V009");
    by_default(&[("a.frag", text), ("a.js", &host("\\n#define FOG 1"))], "V009");
    only_on_request(&[("a.frag", text), ("a.js", &host("\\nprecision highp float;"))], "V009");
}

#[test]
fn a_name_in_capitals_on_its_own_line_is_filled_in() {
    let text = "attribute vec4 p;\nvoid main() {\n\tVERTEX_SUPPORT\n\tgl_Position = p;\n}\n";
    only_on_request(&[("a.vert", text)], "E001");
    by_default(&[("a.vert", &text.replace("= p", "= vec4(p, 1.0)"))], "T001");
}

#[test]
fn missing_parentheses_hide_no_other_error_of_a_piece() {
    let text =
        "fn f(s: u32, c: u32) -> u32 { return s % c & (c - 1u); }\nfn g() -> i32 { let q: i32 = 1.5; return q; }\n";
    by_default(&[("a.wgsl", text)], "E051");
    by_default(&[("a.wgsl", text)], "E030");
}
