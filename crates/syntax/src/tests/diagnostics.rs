//! Each diagnostic, planted once, at its exact place; and that one cause gives one diagnostic.

use super::*;

/// The only error of a vertex shader with this line in `main`, on line 5.
#[track_caller]
fn one(body: &str, want: &str) {
    assert_eq!(errors(&in_main(body), Stage::Vertex), [want], "{body}");
}

#[track_caller]
fn whole(source: &str, want: &str) {
    assert_eq!(errors(source, Stage::Library), [want], "{source}");
}

#[test]
fn syntax_errors_say_what_is_expected() {
    one("float x = ;", "E001 5:11 expected an expression after `=`, found `;`");
    one("float x = 1.0", "E001 5:14 expected `;` after this declaration");
    one("gl_Position = p", "E001 5:16 expected `;` after this statement");
    one("float y = sin(1.0;", "E001 5:18 expected `)`, found `;`");
    one("if (true { }", "E001 5:10 expected `)`, found `{`");
    one("float if = 1.0;", "E001 5:7 `if` is a keyword and cannot be a name");
    one("else { }", "E001 5:1 expected a statement: this `else` belongs to no `if`, found `else`");
    one("float a = 1.0 +* 2.0;", "E001 5:16 expected an expression after `+`, found `*`");
    one("float a = 1.0 2.0;", "E001 5:14 expected `;` after this declaration");
    whole("foo(float x) { }", "E001 1:1 expected a return type before `foo`, found `foo`");
    whole("uniform color;", "E001 1:9 expected a type before `color`, found `color`");
    whole("int f() { return 1; } }", "E001 1:23 this `}` closes nothing");
    whole("int f() { return 1;", "E001 1:9 this `{` is never closed");
    whole("x = 1;", "E001 1:1 expected a declaration, found `x`");
    whole("return 1;", "E001 1:1 `return` stands outside any function");
    whole("struct S { float x; } float f() { return 1.0; }", "E001 1:22 expected `;` after this structure");
}

#[test]
fn a_text_in_another_language_has_this_one_error() {
    whole(
        "@fragment fn f() -> @location(0) vec4f { return vec4f(); }",
        "E077 1:1 the text looks like WGSL, and is read as GLSL",
    );
    whole(
        "float4 f(float4 p : POSITION) : SV_Position { return p; }",
        "E077 1:31 the text looks like HLSL, and is read as GLSL",
    );
}

#[test]
fn columns_are_right_behind_a_japanese_comment() {
    one("/* 頂点の座標 */ float x = ;", "E001 5:23 expected an expression after `=`, found `;`");
    one("/* 球 */ gl_Position = q1;", "E020 5:23 `q1` is not declared");
    one("/* 円柱 */ vec3 a = p; // 説明", "T003 5:19 `vec4` cannot initialise `vec3 a`");
}

#[test]
fn reading_goes_on_behind_an_error() {
    let source = in_main(
        "float a = ;\nfloat b = a + 1.0;\nfloat c = @1.0;\nfloat d = c + undefinedThing;\nvec4 q = (p;\nvec4 r = q;",
    );
    assert_eq!(
        errors(&source, Stage::Vertex),
        [
            "E001 5:11 expected an expression after `=`, found `;`",
            "E002 7:11 `@` is not part of GLSL",
            "E020 8:15 `undefinedThing` is not declared",
            "E001 9:12 expected `)`, found `;`",
        ]
    );
    // A missing bracket does not swallow the next line.
    let source = in_main("vec4 a = vec4(1.0\nfloat b = 2.0;\ngl_Position = a * b;");
    assert_eq!(errors(&source, Stage::Vertex), ["E001 6:1 expected `)`, found `float`"]);
}

#[test]
fn characters_and_comments_outside_the_language_are_reported() {
    one("float x = 1.0;\u{3000}// 全角", "E002 5:15 a blank that is not ASCII stands here");
    one("float x = 1.0 $ 2.0;", "E002 5:15 `$` is not part of GLSL");
    whole("float x; /* open", "E002 1:10 this comment is never closed");
}

#[test]
fn a_full_width_blank_has_a_fix() {
    let parsed = parse(&in_main("float x =\u{3000}1.0;"), Stage::Vertex);
    let fix = parsed.diagnostics[0].fix.as_ref().unwrap();
    let fixed = fix.edits.iter().cloned().collect::<base::text::EditList>().apply(parsed.shader.file().text()).unwrap();
    clean(&fixed.text, Stage::Vertex);
}

#[test]
fn bad_literals_are_reported() {
    one("float x = 1.0.0;", "E003 5:11 `1.0.0` is no number");
    one("int x = 08;", "E003 5:9 `08` is no octal number, which is what a leading 0 announces");
    one("int x = 4294967296;", "E003 5:9 `4294967296` does not fit into 32 bits");
    one("float x = 1.5x;", "E003 5:11 `1.5x` is no number");
}

#[test]
fn unknown_names_are_reported_once_with_the_nearest() {
    let parsed = parse(&in_main("vec4 position = p;\nvec4 a = positon + positon;\nvec4 b = positon;"), Stage::Vertex);
    let [d] = parsed.diagnostics.as_slice() else { panic!("{:?}", parsed.diagnostics) };
    assert_eq!(d.help.as_deref(), Some("did you mean `position`?"));
    let parsed = parse("void main() { gl_FragCoord; }", Stage::Vertex);
    let why = parsed.diagnostics[0].why.as_deref();
    assert_eq!(why, Some("it belongs to the fragment stage, and this is a vertex shader"));
}

#[test]
fn functions_and_overloads_are_reported() {
    one("float x = sine(1.0);", "E021 5:11 function `sine` is not declared");
    one("float x = pow(1.0, 2.0, 3.0);", "E022 5:11 `pow` takes 2 arguments, not 3");
    one("vec4 x = mix(p, p.xyz, 0.5);", "E022 5:10 `mix` does not take (vec4, vec3, float)");
    one("p(1.0);", "E021 5:1 `p` is a variable and cannot be called");
    let below = "float g() { return f(1.0); }\nfloat f(float x) { return x; }";
    let parsed = parse(below, Stage::Library);
    assert_eq!(parsed.diagnostics.len(), 1);
    assert_eq!(parsed.diagnostics[0].related[0].message, "it is defined here");
}

#[test]
fn unknown_types_are_reported() {
    one("vec5 x;", "E023 5:1 type `vec5` is not declared");
    one("retrun x;", "E023 5:1 type `retrun` is not declared");
    let parsed = parse(&in_main("retrun x;"), Stage::Vertex);
    assert_eq!(parsed.diagnostics[0].help.as_deref(), Some("did you mean `return`?"));
    one("void x;", "E023 5:6 `x` cannot be `void`");
    one("void x[3];", "E023 5:6 `x` cannot be `void`");
}

#[test]
fn redefinitions_are_reported() {
    one("float a; float a;", "E024 5:16 `a` is declared twice in this scope");
    whole("int f(int a) { float a = 1.0; return 1; }", "E024 1:22 `a` is declared twice in this scope");
    // The head of a loop and its body are one scope.
    one("for (int k = 0; k < 2; k++) { float k; }", "E024 5:37 `k` is declared twice in this scope");
    whole("void f() {}\nvoid f() {}", "E024 2:6 `f` has two bodies for the same parameters");
    whole("int f();\nfloat f();", "E024 2:7 `f` returns `float` here and `int` before");
    whole("struct S { int a; };\nstruct S { int a; };", "E024 2:8 `S` is declared twice in this scope");
    whole("struct S { int a; float a; };", "E024 1:25 `a` is declared twice in this scope");
    // Inner scopes may use a name again.
    clean(&in_main("float a; { float a; } for (int a = 0; a < 1; a++) { int b = a; }"), Stage::Vertex);
}

#[test]
fn a_stage_without_main_is_reported() {
    assert_eq!(errors("", Stage::Vertex), ["E025 1:1 this vertex shader has no function `main`"]);
    assert_eq!(errors("// 空\n", Stage::Fragment), ["E025 1:1 this fragment shader has no function `main`"]);
    let parsed = parse("void mian() {}", Stage::Vertex);
    assert_eq!(parsed.diagnostics[0].help.as_deref(), Some("is `mian` meant to be `main`?"));
    assert_eq!(errors("", Stage::Library), Vec::<String>::new());
}

#[test]
fn type_mismatches_are_reported_in_words() {
    one("vec4 q = p.xyz;", "T003 5:10 `vec3` cannot initialise `vec4 q`");
    one("gl_Position = p.xyz;", "T003 5:15 `vec3` cannot be assigned to `gl_Position`, which is `vec4`");
    one("vec3 v; v.xy = p;", "T003 5:16 `vec4` cannot be assigned to `vec2`");
    one("int i = 1.0;", "E030 5:9 `float` cannot initialise `int i`");
    one("uint u = 1;", "E030 5:10 `int` cannot initialise `uint u`");
    one("float a[2] = float[3](1.0, 2.0, 3.0);", "E030 5:14 `float[3]` cannot initialise `float[2] a`");
    one("p + 1.0 = p;", "E041 5:1 only a variable or a part of one can be written");
    clean("#version 400\nvoid main() { uint u = 1; double d = 1.0; }", Stage::Vertex);
}

#[test]
fn an_ill_formed_constructor_is_reported_once() {
    // The printed defect: four components for three, and that assigned to four. Nothing follows from it.
    let four = "T001 5:10 `vec3` has 3 components, but is given 4";
    one("vec4 q = vec3(cos(1.0), 0.0, sin(1.0), 1.0);", four);
    one("float q = float(1.0, 2.0);", "T001 5:11 `float` has 1 component, but is given 2");
    one("vec3 a = vec3(1.0, 1.0, 1.0, undefinedThing);", "E020 5:30 `undefinedThing` is not declared");
    clean(
        &in_main("vec3 a = vec3(p); vec3 b = vec3(1.0, p); mat2 c = mat2(p); mat2 d = mat2(mat3(1.0));"),
        Stage::Vertex,
    );
    one("vec4 q = 2.0 * vec4(1.0, 1.0, 1.0);", "T002 5:16 `vec4` needs 4 components, but gets 3");
    one("gl_Position = m * vec3(1.0, 2.0);", "T002 5:19 `vec3` needs 3 components, but gets 2");
    one("vec3 a = vec3(undefinedThing, 1.0);", "E020 5:15 `undefinedThing` is not declared");
}

#[test]
fn constructors_that_cannot_be_built_are_reported() {
    let sampler = "#version 150\nuniform sampler2D s;\nvec4 f() { return vec4(s); }";
    whole(sampler, "E040 3:24 a `sampler2D` has no components to build a `vec4` from");
    whole("struct S { int a; };\nS f() { return S(1, 2); }", "E040 2:16 `S` has 1 members, but 2 are given");
    one("float a[2] = float[2](1.0);", "E040 5:14 `float[2]` has 2 elements, but 1 are given");
    one("bool b[1] = bool[1](1.0);", "E040 5:21 a `float` stands where `bool[1]` needs a `bool`");
}

#[test]
fn operands_are_reported() {
    one("vec4 q = p + p.xyz;", "E031 5:12 `+` cannot combine a `vec4` and a `vec3`");
    one("bool b = !1.0;", "E031 5:10 `!` does not take a `float`");
    one("bool b = p < p;", "T010 5:12 `<` compares scalars, not `vec4` and `vec4`");
    one("int i = 1 && 2;", "E031 5:11 `&&` cannot combine an `int` and an `int`");
    one("bool b; b++;", "E031 5:10 `++` does not take a `bool`");
    one("float x = true ? 1.0 : p;", "E031 5:24 the two sides of `:` differ: a `float` and a `vec4`");
    one("float x = 3.0 % 2.0;", "T012 5:15 `%` takes integers, not `float` and `float`");
    one("vec3 v = m * p.xyz;", "T004 5:12 `mat4` cannot be multiplied by `vec3`");
}

#[test]
fn fields_and_swizzles_are_reported() {
    one("float x = p.xyz.w;", "T009 5:17 a `vec3` has no component `w`");
    one("vec2 x = p.xg;", "T009 5:12 `.xg` mixes `xyzw` with other names of components");
    one("vec4 x = p.xyzzy;", "T009 5:12 `.xyzzy` takes more than four components");
    one("float x = p.k;", "T009 5:13 a `vec4` has no member `k`");
    one("vec4 q; q.xx = p.xy;", "T009 5:11 `.xx` names a component twice and cannot be written");
    one("float x = m.x;", "E034 5:13 a `mat4` has no member `x`");
    one("float a[2]; int n = a.length;", "E034 5:23 a `float[2]` has no member `length`");
    one("int n = p.size();", "E034 5:11 `.size()` is no method; there is only `.length()`");
    whole("struct S { int count; };\nint f(S s) { return s.cuont; }", "E034 2:23 `S` has no member `cuont`");
}

#[test]
fn indices_conditions_and_returns_are_reported() {
    one("float x = p[1.0];", "E036 5:13 an index must be an integer, not a `float`");
    one("float x = 1.0; x[0] = 2.0;", "E036 5:16 a `float` has no elements to index");
    one("if (1) { }", "E037 5:5 the condition of `if` must be a `bool`, not an `int`");
    one("for (int i = 0; i; i++) { }", "E037 5:17 the condition of `for` must be a `bool`, not an `int`");
    one("switch (p) { }", "E037 5:9 `switch` needs an integer, not a `vec4`");
    one("return p;", "E038 5:8 `main` returns nothing, but a value is returned");
    whole("float f() { return; }", "E038 1:13 `return` without a value in `f`, which returns a `float`");
    whole("vec2 f() { return vec3(1.0); }", "E038 1:19 a `vec3` is returned from `f`, which returns a `vec2`");
}

#[test]
fn array_sizes_are_reported() {
    one("int n = 2; float a[n];", "E039 5:20 the size of an array must be constant");
    one("float a[0];", "E039 5:9 the size of an array must be positive");
    one("float a[2.0];", "E039 5:9 the size of an array must be an integer, not a `float`");
    clean(&in_main("const int n = 2; float a[n * 2]; float b[gl_MaxTextureImageUnits];"), Stage::Vertex);
    let source =
        "#version 150\nuniform int n;\nlayout(triangles) in;\nlayout(points, max_vertices = n) out;\nvoid main() {}";
    assert_eq!(errors(source, Stage::Geometry), ["E039 4:31 `max_vertices` must be a constant integer"]);
}

#[test]
fn what_is_nested_too_deeply_is_reported_once() {
    let deep = |open: &str, close: &str| format!("float x = {}1.0{};", open.repeat(10_000), close.repeat(10_000));
    for body in [
        deep("(", ")"),
        deep("-", ""),
        deep("sin(", ")"),
        format!("{}{}", "{".repeat(10_000), "}".repeat(10_000)),
        format!("{} ;", "if (true) ".repeat(10_000)),
        format!("float x = 1.0{};", " + 1.0".repeat(10_000)),
        format!("float x = {} 1.0;", "true ? 1.0 : ".repeat(10_000)),
        format!("float x; {} 1.0;", "x = ".repeat(10_000)),
    ] {
        let found = errors(&in_main(&body), Stage::Vertex);
        let deep = found.iter().filter(|e| e.starts_with("E004 5:")).count();
        assert!(deep == 1, "{} {found:?}", &body[..20]);
    }
}

#[test]
fn garbage_gives_diagnostics_and_ends() {
    let garbage: String = (0..5000_u32).filter_map(|i| char::from_u32(i * 7919 % 0x3000)).collect();
    assert!(!errors(&garbage, Stage::Vertex).is_empty());
    assert!(errors(&"}".repeat(10_000), Stage::Vertex).len() <= 200);
    assert!(!errors(&"[".repeat(10_000), Stage::Vertex).is_empty());
    assert!(!errors(&"struct S {".repeat(10_000), Stage::Vertex).is_empty());
    assert!(!errors("\0\0\u{1}#", Stage::Vertex).is_empty());
}

#[test]
fn a_function_whose_head_cannot_be_read_is_not_missed_where_it_is_called() {
    let text = "#version 330\nout vec4 c;\nfloat depth(float z, float near = 0.1) { return near / z; }\n\
        void main() { c = vec4(depth(gl_FragCoord.z)); }\n";
    let found = parse(text, Stage::Fragment).diagnostics;
    assert_eq!(found.iter().map(|d| d.code.0).collect::<Vec<_>>(), ["E001"], "{found:#?}");
}

#[test]
fn patches_have_as_many_vertices_as_the_host_says() {
    let text = "#version 400\nlayout(vertices = 3) out;\nin vec4 p[];\nout vec4 q[];\n\
        void main() { q[gl_InvocationID] = p[gl_InvocationID]; }\n";
    assert!(parse(text, Stage::TessControl).diagnostics.is_empty());
    let text = "#version 400\nlayout(triangles) in;\nin vec4 p[];\nvoid main() { for (int i = 0; i < 3; i++) gl_Position += p[i]; }\n";
    assert!(parse(text, Stage::TessEvaluation).diagnostics.is_empty());
}

#[test]
fn a_type_that_doubles_is_a_limit_and_nothing_follows_from_it() {
    let doubling = |count: usize, member: &dyn Fn(usize) -> String| -> String { (1..=count).map(member).collect() };
    let glsl = |count| {
        let all = doubling(count, &|k| format!("struct S{k} {{ S{0} a; S{0} b; }};\n", k - 1));
        format!(
            "#version 330 core\nstruct S0 {{ float a; }};\n{all}float f(float x) {{ S{count} s; return s.a.b.nothing + x; }}\n"
        )
    };
    let codes = |name: &str, text: String| -> Vec<String> {
        let file = SourceFile::new(name, text);
        let parsed =
            if name.ends_with("wgsl") { Shader::parse_wgsl(&file) } else { Shader::parse(&file, Stage::Library) };
        parsed.diagnostics.iter().map(|d| d.code.to_string()).collect()
    };
    assert_eq!(codes("a.glsl", glsl(30)), ["E004"]);
    assert_eq!(codes("a.glsl", glsl(10)), ["E034"], "a member that is not there");
    let wgsl = |count| {
        let all = doubling(count, &|k| format!("struct S{k} {{ a: S{0}, b: S{0} }}\n", k - 1));
        format!("struct S0 {{ a: f32 }}\n{all}fn f(x: f32) -> f32 {{ var s: S{count}; return x; }}\n")
    };
    assert_eq!(codes("a.wgsl", wgsl(30)), ["E004"]);
    assert_eq!(codes("a.wgsl", wgsl(10)), [""; 0]);
    // Deep and not large.
    let chain = |count| {
        let all = doubling(count, &|k| format!("struct S{k} {{ S{} a; }};\n", k - 1));
        format!("#version 330 core\nstruct S0 {{ float a; }};\n{all}float f(float x) {{ S{count} s; return x; }}\n")
    };
    assert_eq!(codes("a.glsl", chain(5000)), ["E004"]);
    assert_eq!(codes("a.glsl", chain(100)), [""; 0]);
}

#[test]
fn where_many_names_are_unknown_none_is_taken_for_a_slip() {
    let helped = |count: usize| {
        let lines: String = (0..count).map(|i| format!("float value{i} = valeu{i};\n")).collect();
        let text = format!("#version 330\nvoid main() {{\n{lines}}}\n");
        let found = Shader::parse(&SourceFile::new("a.vert", text), Stage::Vertex).diagnostics;
        assert_eq!(found.len(), count);
        found.iter().filter(|d| d.help.is_some()).count()
    };
    assert!(helped(40) >= 39);
    assert!(helped(100) < 100);
}
