//! Rules of versions, stages and declarations: each broken once, and the nearest text that is right.

use super::*;

/// The only error of a text of that stage.
#[track_caller]
fn one(stage: Stage, source: &str, want: &str) {
    let parsed = parse(source, stage);
    let found: Vec<String> = parsed.diagnostics.iter().map(|d| format!("{} {}", d.code, d.message)).collect();
    assert_eq!(found, [want], "{source}");
    assert!(parsed.diagnostics[0].message.is_translated() || want.starts_with("E0"), "{source}");
}

#[test]
fn features_belong_to_versions() {
    use Stage::{Fragment, Vertex};
    for (stage, old, new, body, want) in [
        (
            Vertex,
            "120",
            "130",
            "int f(int a) { return a % 2; }",
            "V002 this integer operator needs GLSL 1.30 or `GL_EXT_gpu_shader4`",
        ),
        (
            Vertex,
            "110",
            "120",
            "float f() { float a[2]; return float(a.length()); }",
            "V002 `.length()` needs GLSL 1.20",
        ),
        (Vertex, "130", "400", "double d;", "V002 `double` needs GLSL 4.00 or `GL_ARB_gpu_shader_fp64`"),
        (
            Vertex,
            "150",
            "330",
            "layout(location = 1) in vec4 p;",
            "V002 `layout(location)` needs GLSL 3.30 or `GL_ARB_explicit_attrib_location`",
        ),
        (Vertex, "110", "120", "mat2x3 m;", "V002 `mat2x3` needs GLSL 1.20"),
        (
            Vertex,
            "120",
            "130",
            "in vec4 p;",
            "V002 `in` or `out` at file scope needs GLSL 1.30 or `GL_ARB_explicit_attrib_location`",
        ),
        (Vertex, "120", "140", "mat4 f(mat4 m) { return inverse(m); }", "V002 `inverse` needs GLSL 1.40"),
        (Fragment, "130", "420", "layout(binding = 1) uniform sampler2D s;", ""),
        (
            Vertex,
            "150",
            "430",
            "float a[2][3];",
            "V002 an array of arrays needs GLSL 4.30 or `GL_ARB_arrays_of_arrays`",
        ),
        (Vertex, "110", "120", "float f() { return 1; }", "T006 `int` does not become `float` by itself"),
        (Vertex, "110", "120", "float f() { return 1.0f; }", "T007 GLSL 1.10 has no suffix `f`"),
    ] {
        let text = |version: &str| format!("#version {version}\n{body}\nvoid main() {{}}\n");
        if !want.is_empty() {
            one(stage, &text(old), want);
        }
        clean(&text(new), stage);
    }
}

#[test]
fn stages_have_their_functions_and_variables() {
    let shader = |body: &str| format!("#version 330 core\nvoid main() {{ {body} }}\n");
    one(Stage::Vertex, &shader("float x = dFdx(1.0);"), "E020 a vertex shader does not have `dFdx`");
    one(Stage::Vertex, &shader("vec4 p = gl_Vertex;"), "E020 GLSL 3.30 core does not have `gl_Vertex`");
    one(Stage::Vertex, &shader("discard;"), "E045 `discard` cannot stand here");
    one(Stage::Fragment, &shader("break;"), "E045 `break` cannot stand here");
    clean(&shader("float x = dFdx(1.0); if (x > 0.0) discard;"), Stage::Fragment);
    clean("#version 330 compatibility\nvoid main() { gl_Position = gl_Vertex; }\n", Stage::Vertex);
}

#[test]
fn only_variables_that_may_be_written_are() {
    let shader = |body: &str| {
        format!("#version 150\nin vec3 n;\nuniform float u;\nconst int c = 1;\nout vec4 o;\nvoid main() {{ {body} }}\n")
    };
    for (body, want) in [
        ("n = normalize(n);", "T018 `n` can only be read"),
        ("u += 1.0;", "T018 `u` can only be read"),
        ("int k = c; c = k;", "T018 `c` can only be read"),
        ("gl_FragCoord.x = 1.0;", "T018 `gl_FragCoord` can only be read"),
        ("1.0 = u;", "E041 only a variable or a part of one can be written"),
        ("float x; float y = frexp(1.0, 3);", ""),
        ("float x; ++x = 1.0;", "E041 only a variable or a part of one can be written"),
    ] {
        if !want.is_empty() {
            one(Stage::Fragment, &shader(body), want);
        }
    }
    clean(&shader("vec3 m = n; m.xy = m.yx; o = vec4(m * u, float(c)); o.x += 1.0; int i = 0; i++;"), Stage::Fragment);
}

#[test]
fn swizzles_indices_and_constructors() {
    let shader = |body: &str| format!("#version 150\nvoid main() {{ {body} }}\n");
    one(Stage::Vertex, &shader("float f = 1.0; vec3 v = f.xxx;"), "T008 `.xxx` is taken of a `float`, a scalar");
    one(Stage::Vertex, &shader("vec3 v; float x = v[3];"), "T016 there is no element 3");
    one(Stage::Vertex, &shader("float a[2]; a[-1] = 0.0;"), "T016 there is no element -1");
    one(Stage::Vertex, &shader("mat2 m = mat2(1.0, 2.0);"), "T002 `mat2` needs 4 components, but gets 2");
    clean(&shader("vec3 v = vec3(1.0); float x = v[2]; mat2 m = mat2(1.0); m[1][0] = x;"), Stage::Vertex);
    clean("#version 420\nvoid main() { float f = 1.0; vec3 v = f.xxx; }\n", Stage::Vertex);
}

#[test]
fn reserved_names_are_reported() {
    one(Stage::Vertex, "void main() { float input = 1.0; }", "V004 `input` is a reserved word");
    one(Stage::Vertex, "float gl_mine; void main() {}", "V004 `gl_mine` is a name of the language");
    one(Stage::Vertex, "#define GL_x 1\nvoid main() {}", "V004 the language defines `GL_x` itself");
    clean("void main() { float filter = 1.0; float sample = 1.0; float __a = 1.0; }", Stage::Vertex);
    one(Stage::Vertex, "#version 130\nvoid main() { float filter = 1.0; }", "V004 `filter` is a reserved word");
}

#[test]
fn directives_have_their_place() {
    one(Stage::Vertex, "float x;\n#version 150\nvoid main() {}", "V001 `#version` must be the first thing in the text");
    clean("/* c */\n\n#version 150\nvoid main() {}", Stage::Vertex);
    one(Stage::Vertex, "#extension GL_FOO_x : require\nvoid main() {}", "V010 there is no extension `GL_FOO_x`");
    clean("#extension GL_NV_whatever : require\n#extension GL_FOO_x : enable\nvoid main() {}", Stage::Vertex);
    one(
        Stage::Fragment,
        "#version 120\nuniform sampler2DArray s;\nvoid main() {}",
        "V002 `sampler2DArray` needs GLSL 1.30 or `GL_EXT_texture_array`",
    );
    one(
        Stage::Fragment,
        "#version 100\nprecision mediump float;\nvoid main() { float x = dFdx(1.0); }",
        "V002 `dFdx` needs GLSL ES 3.00 or `GL_OES_standard_derivatives`",
    );
}

#[test]
fn qualifiers_and_layouts_have_their_place() {
    let v = |line: &str| format!("#version 150\n{line}\nvoid main() {{}}\n");
    one(Stage::Vertex, &v("in out vec4 a;"), "E042 `in out` cannot stand here");
    one(Stage::Vertex, &v("flat in vec4 a;"), "E042 `flat` cannot stand here");
    one(Stage::Vertex, &v("layout(nothing) out vec4 a;"), "E043 `layout(nothing)` cannot stand here");
    one(Stage::Vertex, &v("const float a;"), "E044 the constant `a` has no value");
    one(Stage::Vertex, &v("uniform float u; const float a = u;"), "E044 the initialiser of `a` must be constant");
    one(Stage::Vertex, &v("in bool b;"), "E047 `bool` cannot be the type of this variable");
    one(Stage::Vertex, &v("sampler2D s;"), "E047 `sampler2D` can only be a uniform or a parameter");
    one(Stage::Vertex, &v("float f(float a[]) { return a[0]; }"), "E048 an array parameter needs a size");
    one(Stage::Vertex, &v("in B { vec4 a; };"), "E049 this stage has no `in` block");
    one(Stage::Fragment, &v("in int a;"), "I005 a `int` input of a fragment shader must be `flat`");
    let ordered = |version: &str, line: &str| format!("#version {version}\n{line}\nvoid main() {{}}\n");
    let order = "V002 this order of qualifiers needs GLSL 4.20 or `GL_ARB_shading_language_420pack`";
    one(Stage::Vertex, &ordered("330", "in layout(location = 0) vec4 a;"), order);
    clean(&ordered("420", "in layout(location = 0) vec4 a;"), Stage::Vertex);
    clean(&ordered("330", "layout(location = 0) in vec4 a;"), Stage::Vertex);
    clean(&v("flat in int a; smooth in vec4 b; centroid in vec2 c;"), Stage::Fragment);
    clean(&v("in vec4 a; uniform mat4 m[3]; out B { vec4 c; flat int d; } b; uniform U { vec4 e; };"), Stage::Vertex);
}

#[test]
fn functions_have_their_rules() {
    let v = |line: &str| format!("#version 150\n{line}\nvoid main() {{}}\n");
    one(
        Stage::Vertex,
        &v("float f(float x);\nfloat g(float x) { return f(x); }\nfloat f(float x) { return g(x); }"),
        "E046 `g` calls itself",
    );
    // The function of that name that takes what is not known may be another one.
    let other = v("float f(float x) { Light l = lights(x); return f(l); }");
    let found = parse(&other, Stage::Vertex).diagnostics;
    assert!(!found.is_empty() && found.iter().all(|d| d.code.0 != "E046"), "{found:?}");
    one(Stage::Vertex, &v("void f(const out float x) {}"), "E042 `const` cannot stand here");
    one(Stage::Vertex, "#version 150\nint main() { return 1; }\n", "E046 `main` is `void main()`");
    one(Stage::Vertex, &v("float f() { }"), "E038 `f` never returns a value");
    let switch = |body: &str| format!("#version 150\nvoid main() {{ int i = 0; switch (i) {{ {body} }} }}\n");
    one(Stage::Vertex, &switch("case 1: break; case 1: break;"), "E045 a second `case 1`");
    one(Stage::Vertex, &switch("case 1: { case 2: break; }"), "E045 `case` cannot stand here");
    one(Stage::Vertex, &switch("i = 1;"), "E045 a statement stands before the first label");
    clean(&switch("case 0: i = 1; break; case 1: case 2: { int k = 1; } break; default: break;"), Stage::Vertex);
}

#[test]
fn geometry_stages_declare_their_primitives() {
    let g = |lines: &str| format!("#version 150\n{lines}\nvoid main() {{ EmitVertex(); }}\n");
    let whole = "layout(triangles) in;\nlayout(triangle_strip, max_vertices = 3) out;";
    clean(&g(whole), Stage::Geometry);
    clean(&g(&format!("in vec3 n[];\n{whole}")), Stage::Geometry);
    one(Stage::Geometry, &g(&format!("in vec3 n;\n{whole}")), "G007 the geometry input `n` is no array");
    one(
        Stage::Geometry,
        &g("layout(triangle_strip, max_vertices = 3) out;"),
        "G008 this geometry shader does not say its input primitive",
    );
    one(
        Stage::Geometry,
        &g("layout(triangles) in;\nlayout(triangles, max_vertices = 3) out;"),
        "G009 `triangles` is no output primitive",
    );
}

#[test]
fn es_has_rules_of_its_own() {
    let f = |lines: &str| format!("#version 300 es\n{lines}\nvoid main() {{}}\n");
    one(Stage::Fragment, &f("out vec4 c;"), "V009 `vec4` has no precision here");
    clean(&f("precision mediump float;\nout vec4 c;"), Stage::Fragment);
    clean(&f("out highp vec4 c;"), Stage::Fragment);
    clean(&f("out vec4 c;"), Stage::Vertex);
    let one_of = |body: &str| format!("#version 300 es\nprecision highp float;\nvoid main() {{ {body} }}\n");
    one(Stage::Fragment, &one_of("float x = 1;"), "T006 `int` does not become `float` by itself");
    clean(&one_of("float x = 1.0; x *= 2.0; vec2 v = vec2(1, 2);"), Stage::Fragment);
}

#[test]
fn a_local_constant_may_get_its_value_when_the_shader_runs() {
    let text = |version: &str, body: &str| format!("#version {version}\nuniform float u;\nvoid main() {{ {body} }}\n");
    let reported = "E044 the initialiser of `a` must be constant";
    one(Stage::Vertex, &text("410", "const float a = u;"), reported);
    one(Stage::Vertex, &text("310 es", "const float a = u;"), reported);
    for right in [
        text("420", "const float a = u; const float b = a + 1.0; float c = b;"),
        text("150\n#extension GL_ARB_shading_language_420pack : enable", "const float a = u;"),
    ] {
        assert_eq!(parse(&right, Stage::Vertex).diagnostics, [], "{right}");
    }
    // It is no constant expression, and still nothing can be written to it.
    one(Stage::Vertex, &text("460", "const int n = int(u); float a[n];"), "E039 the size of an array must be constant");
    let written = parse(&text("460", "const float a = u; a = 1.0;"), Stage::Vertex).diagnostics;
    assert_eq!(written.len(), 1, "{written:?}");
    one(Stage::Vertex, "#version 460\nuniform float u;\nconst float a = u;\nvoid main() {}\n", reported);
}

/// GL_KHR_memory_scope_semantics, GL_EXT_null_initializer and GL_EXT_shared_memory_block.
#[test]
fn extensions_of_kernels_bring_qualifiers_zeros_and_shared_blocks() {
    let of = |extension: &str, rest: &str| {
        format!("#version 460\n#extension GL_{extension} : enable\nlayout(local_size_x = 64) in;\n{rest}")
    };
    let scopes = "struct P { float x; };\nlayout(binding = 0) workgroupcoherent buffer B { float f[]; };\n\
                  layout(binding = 1) nonprivate devicecoherent buffer C { P p[]; };\n\
                  void main() { nonprivate P q = p[0]; f[2] = q.x; }\n";
    clean(&of("KHR_memory_scope_semantics", scopes), Stage::Compute);
    let zeros = "struct P { float x; vec3 v[4]; };\nshared float s[4] = {};\nshared P t = { };\n\
                 void main() { P q = {}; s[0] = q.x + t.x; }\n";
    clean(&of("EXT_null_initializer", zeros), Stage::Compute);
    let one_value = "shared float s = 1.0;\nvoid main() { s = 2.0; }\n";
    one(Stage::Compute, &of("EXT_null_initializer", one_value), "E044 `s` cannot have an initialiser");
    let block = "shared S { uint a[64]; };\nvoid main() { a[gl_LocalInvocationIndex] = 0u; }\n";
    clean(&of("EXT_shared_memory_block", block), Stage::Compute);
    one(Stage::Compute, &of("EXT_control_flow_attributes", block), "E049 this stage has no `shared` block");
    // Elsewhere they are names.
    clean(
        "#version 460\nlayout(local_size_x = 1) in;\nvoid main() { float nonprivate = 1.0; nonprivate += 1.0; }\n",
        Stage::Compute,
    );
}

#[test]
fn what_an_extension_may_bring_is_no_error_and_a_slip_is_one() {
    let of = |name: &str, body: &str| {
        format!(
            "#version 460\n#extension GL_{name} : require\nlayout(location = 0) out vec4 c;\nvoid main() {{ {body} }}\n"
        )
    };
    let bary = "EXT_fragment_shader_barycentric";
    clean(&of(bary, "c = vec4(gl_BaryCoordEXT, 1.0);"), Stage::Fragment);
    let text = of(bary, "c = v[0];").replace("void", "layout(location = 1) pervertexEXT in vec4 v[];\nvoid");
    clean(&text, Stage::Fragment);
    clean(&of("EXT_ray_query", "c = vec4(0.0); if (gl_RayFlagsOpaqueEXT != 0u) c.x = 1.0;"), Stage::Fragment);
    clean(
        &of("EXT_ray_flags_primitive_culling", "c = vec4(0.0);").replace("void", "layout(primitive_culling);\nvoid"),
        Stage::Fragment,
    );
    // Two letters away from a name that there is.
    one(Stage::Fragment, &of(bary, "c = gl_FragCord;"), "E020 `gl_FragCord` is not declared");
    one(Stage::Fragment, &of(bary, "c = baryCoord;"), "E020 `baryCoord` is not declared");
    // With extensions that are known, nothing else comes.
    one(Stage::Fragment, &of("ARB_cull_distance", "c = gl_Whatever;"), "E020 `gl_Whatever` is not declared");
}

#[test]
fn texts_in_quotes_come_with_an_extension() {
    let of = |name: &str, call: &str| {
        format!(
            "#version 460\n#extension GL_{name} : enable\nlayout(location = 0) out vec4 c;\nvoid main() {{ c = vec4(1.0); {call} }}\n"
        )
    };
    for call in
        ["debugPrintfEXT(\"x %f, y @ %d\\n\", c.x, 1);", "debugPrintfEXT(\"\");", "debugPrintfEXT(\"a\"); c.y = 2.0;"]
    {
        clean(&of("EXT_debug_printf", call), Stage::Fragment);
    }
    let text = of("EXT_debug_printf", "SHOW(c.x);");
    clean(&text.replace("layout", "#define SHOW(x) debugPrintfEXT(\"v %f\", x)\nlayout"), Stage::Fragment);
    // A text is no number, and what stands behind it is read.
    one(Stage::Fragment, &of("EXT_debug_printf", "debugPrintfEXT(\"a\"); c = q;"), "E020 `q` is not declared");
    // Without the extension, and where it is never closed, a quote is told at its place.
    for (name, call) in [("ARB_cull_distance", "debugPrintfEXT(\"a\");"), ("EXT_debug_printf", "debugPrintfEXT(\"a);")]
    {
        let errors = errors(&of(name, call), Stage::Fragment);
        assert!(errors.iter().any(|e| e.starts_with("E002")), "{errors:?}");
    }
}

#[test]
fn offsets_of_texels_are_constant() {
    let text = |body: &str| {
        format!(
            "#version 330\nuniform sampler2D t;\nuniform ivec2 u;\nout vec4 c;\n\
            const ivec2 all[] = ivec2[](ivec2(1, 0), ivec2(0, 1));\n\
            void main() {{ const ivec2 o = ivec2(1); int i = 1; c = {body}; }}\n"
        )
    };
    let told = "E050 the offset of `textureOffset` must be a constant expression";
    one(Stage::Fragment, &text("textureOffset(t, vec2(0.5), all[i])"), told);
    for wrong in [
        "textureOffset(t, vec2(0.5), u)",
        "texelFetchOffset(t, ivec2(1), 0, ivec2(i))",
        "textureGradOffset(t, vec2(0.5), vec2(0.0), vec2(0.0), u)",
        "textureLodOffset(t, vec2(0.5), 1.0, u)",
    ] {
        let found = parse(&text(wrong), Stage::Fragment).diagnostics;
        let told: Vec<&str> = found.iter().map(|d| d.code.0).collect();
        assert_eq!(told, ["E050"], "{wrong}: {found:?}");
    }
    for right in [
        "textureOffset(t, vec2(0.5), all[1])",
        "textureOffset(t, vec2(0.5), o)",
        "textureOffset(t, vec2(0.5), ivec2(-1, 1), 0.5)",
        "texelFetchOffset(t, ivec2(i), i, ivec2(1))",
        "texture(t, vec2(0.5) + vec2(u))",
    ] {
        assert_eq!(parse(&text(right), Stage::Fragment).diagnostics, [], "{right}");
    }
    let gathered = "#version 400\nuniform sampler2D t;\nuniform ivec2 u;\nout vec4 c;\n\
        void main() { c = textureGatherOffset(t, vec2(0.5), u); }\n";
    assert_eq!(parse(gathered, Stage::Fragment).diagnostics, []);
}

#[test]
fn hints_of_control_flow_are_passed_over() {
    let shader = |extension: &str, hint: &str| {
        format!(
            "#version 450\n{extension}\nout vec4 c;\nvoid main() {{ c = vec4(0.0);\n{hint} for (int i = 0; i < 3; i++) c += 1.0;\n}}\n"
        )
    };
    let on = "#extension GL_EXT_control_flow_attributes : require";
    for hint in ["[[unroll]]", "[[dependency_length(1 + 3), loop]]", "[[flatten]] [[dont_unroll]]"] {
        clean(&shader(on, hint), Stage::Fragment);
    }
    one(Stage::Fragment, &shader(on, "[[unroll]"), "E001 expected `]]` behind the attributes, found `for`");
    one(Stage::Fragment, &shader(on, "[[]]"), "E001 expected the name of an attribute, found `]`");
    one(Stage::Fragment, &shader("", "[[unroll]]"), "V010 `[[unroll]]` needs `GL_EXT_control_flow_attributes`");
}

#[test]
fn atomic_functions_on_64_bits_need_an_extension_of_their_own() {
    let stated = "#version 450\nlayout(local_size_x = 8) in;\nlayout(std430) buffer B { uint64_t a[]; };\n\
        void main() { atomicAdd(a[0], 1ul); }\n";
    let told: Vec<String> = parse(stated, Stage::Compute).diagnostics.iter().map(|d| d.message.to_string()).collect();
    assert!(told.contains(&"`atomicAdd` on 64 bits needs `GL_EXT_shader_atomic_int64`".to_owned()), "{told:?}");
}

#[test]
fn a_loop_that_is_written_out_in_the_text_has_constant_indices() {
    let shader = |open: &str, index: &str, close: &str| {
        format!(
            "#version 300 es\nprecision highp float;\n#define NUM 4\nuniform sampler2D maps[NUM];\nin vec2 uv;\n\
             out vec4 c;\nvoid main() {{\n  c = vec4(0.0);\n{open}\n  for ( int i = 0; i < NUM; i ++ ) {{\n    \
             c += texture( maps[ {index} ], uv );\n  }}\n{close}\n}}\n"
        )
    };
    let varies = "V002 an index that varies into samplers needs GLSL ES 3.20 or `GL_EXT_gpu_shader5`";
    clean(&shader("#pragma unroll_loop_start", "i", "#pragma unroll_loop_end"), Stage::Fragment);
    clean(&shader("#pragma unroll_loop", "i", ""), Stage::Fragment);
    for (open, index, close) in [
        ("", "i", ""),
        ("#pragma unroll_loop_start", "i", ""),
        ("#pragma unroll_loop_start", "i + 1", "#pragma unroll_loop_end"),
        ("#pragma unroll_loop_end", "i", "#pragma unroll_loop_start"),
        ("#pragma unroll_loop_start\nfor (int j = 0; j < 2; j++)", "i", "#pragma unroll_loop_end"),
    ] {
        one(Stage::Fragment, &shader(open, index, close), varies);
    }
}

/// What is told of a compute shader for Vulkan with these lines and this body.
fn vulkan(head: &str, body: &str) -> Vec<String> {
    let extensions = "#extension GL_EXT_buffer_reference : require\n#extension GL_EXT_nonuniform_qualifier : require\n\
        #extension GL_EXT_samplerless_texture_functions : require\n";
    let text = format!(
        "#version 460\n{extensions}layout(local_size_x = 8) in;\nlayout(binding = 0) buffer D {{ uint d[]; }};\n{head}\n\
         void main() {{ uint i = gl_LocalInvocationIndex; {body} }}\n"
    );
    let parsed = Shader::parse(&SourceFile::new("a.comp", text), Stage::Compute);
    parsed.diagnostics.iter().map(|d| format!("{} {}", d.code, d.message)).collect()
}

#[test]
fn a_buffer_reference_is_a_type_that_points_elsewhere() {
    let keys = "layout(buffer_reference, std430) buffer Keys { uint keys[]; };\n";
    let pushed = format!("{keys}layout(push_constant) uniform P {{ restrict Keys to; Keys all[2]; uint n; }} p;\n");
    assert_eq!(vulkan(&pushed, "p.to.keys[i] = i; p.all[1].keys[i] += i; atomicAdd(p.to.keys[0], 1u);"), [""; 0]);
    let open = format!("{keys}layout(push_constant) uniform P {{ Keys to; uint n; }};\n");
    assert_eq!(vulkan(&open, "to.keys[i] = n;"), [""; 0]);
    let locked = format!("{keys}layout(binding = 1) readonly buffer R {{ Keys to; uint n; }};\n");
    assert_eq!(vulkan(&locked, "to.keys[i] = n;"), [""; 0]);
    assert_eq!(vulkan(&open, "n = 1u;"), ["T018 `n` can only be read"], "the block itself stays");
    let two = format!("{keys}layout(buffer_reference, std430) buffer Other {{ vec4 keys[]; }};\nuint keys = 1u;\n");
    assert_eq!(vulkan(&two, "d[i] = keys;"), [""; 0], "members are no globals");
    let forward = format!("layout(buffer_reference) buffer Keys;\n{pushed}");
    assert_eq!(vulkan(&forward, "p.to.keys[i] = i;"), [""; 0]);
    let twice = "layout(buffer_reference, std430) buffer A { uint x; vec4 x; };\n";
    assert_eq!(vulkan(twice, ""), ["E024 `x` is declared twice in this scope"]);
    let plain = "layout(binding = 1) buffer A { uint x; };\nlayout(binding = 2) buffer B { uint x; };\n";
    assert_eq!(vulkan(plain, ""), ["E024 `x` is declared twice in this scope"]);
}

#[test]
fn resources_without_a_sampler_and_without_a_size() {
    let two = "layout(binding = 1) uniform usampler2D a;\nlayout(binding = 2) uniform utexture2D b;\n\
        uint f(usampler2D t) { return texelFetch(t, ivec2(0), 0).x; }\nuvec2 f(utexture2D t) { return texelFetch(t, ivec2(0), 0).xy; }\n";
    assert_eq!(vulkan(two, "d[i] = f(a) + f(b).y;"), [""; 0]);
    assert_eq!(
        vulkan(&format!("{two}uint f(utexture2D t) {{ return 1u; }}\n"), "").len(),
        1,
        "the same parameter twice"
    );
    let arrays = "layout(set = 1, binding = 0) uniform texture3D vols[];\nlayout(set = 1, binding = 1) uniform sampler smp;\n\
        layout(set = 1, binding = 2) buffer B { uint x; } all[];\n";
    let body = "d[i] = all[i].x + uint(textureLod(nonuniformEXT(sampler3D(vols[i], smp)), vec3(0.0), 0.0).x);";
    assert_eq!(vulkan(arrays, body), [""; 0]);
    assert_eq!(vulkan(arrays, "d[i] = nonuniformEXT(vec2(1.0));"), ["E030 `vec2` cannot be assigned to `uint`"]);
    assert_eq!(
        vulkan("uint local[];\n", "d[i] = local[i];"),
        ["E048 an array without a size takes constant indices only"]
    );
}

#[test]
fn barriers_and_atomic_functions_have_a_scope_with_an_extension() {
    let told = |extension: &str, body: &str| {
        let text = format!(
            "#version 450\n{extension}\nlayout(local_size_x = 8) in;\nlayout(binding = 0) buffer D {{ uint d[]; }};\n\
             void main() {{ {body} }}\n"
        );
        let parsed = Shader::parse(&SourceFile::new("a.comp", text), Stage::Compute);
        parsed.diagnostics.iter().map(|d| d.code.to_string()).collect::<Vec<_>>()
    };
    let all = [
        "memoryBarrier(gl_ScopeDevice, gl_StorageSemanticsBuffer | gl_StorageSemanticsShared, gl_SemanticsAcquireRelease);",
        "controlBarrier(gl_ScopeWorkgroup, gl_ScopeDevice, gl_StorageSemanticsBuffer, gl_SemanticsRelease);",
        "atomicAdd(d[0], 1u, gl_ScopeDevice, gl_StorageSemanticsBuffer, gl_SemanticsRelaxed);",
        "d[1] = atomicLoad(d[0], gl_ScopeDevice, gl_StorageSemanticsBuffer, gl_SemanticsAcquire);",
        "atomicStore(d[0], 1u, gl_ScopeDevice, gl_StorageSemanticsBuffer, gl_SemanticsRelease);",
    ];
    for body in all {
        assert_eq!(told("#extension GL_KHR_memory_scope_semantics : require", body), [""; 0], "{body}");
        assert!(!told("", body).is_empty(), "{body}");
    }
    assert_eq!(told("#extension GL_KHR_memory_scope_semantics : require", "memoryBarrier(gl_ScopeDevice);"), ["E022"]);
    assert_eq!(told("", "memoryBarrier();"), [""; 0]);
}

#[test]
fn operators_of_wgsl_without_parentheses_hide_nothing_behind_them() {
    let text =
        "fn f(s: u32, c: u32) -> u32 { return s % c & (c - 1u); }\nfn g() -> i32 { let q: i32 = 1.5; return q; }\n";
    let found = Shader::parse_wgsl(&SourceFile::new("a.wgsl", text)).diagnostics;
    let told: Vec<String> = found.iter().map(|d| format!("{} {}", d.code, d.message)).collect();
    let wanted =
        ["E051 `%` and `&` stand together without parentheses", "E030 a value of type `f32` does not go into a `i32`"];
    assert_eq!(told, wanted);
}
