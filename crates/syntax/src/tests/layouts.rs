//! Rules of layouts and of the interface as a whole: each broken once, beside the nearest text that is right.

use super::*;

/// The faults of a text behind a version, each with its code.
fn found(stage: Stage, version: &str, body: &str) -> Vec<String> {
    let main = if body.contains("void main") { "" } else { "void main() {}" };
    let parsed = parse(&format!("#version {version}\n{body}\n{main}\n"), stage);
    parsed.diagnostics.iter().map(|d| format!("{} {}", d.code, d.message)).collect()
}

/// Version, what is wrong, what is right, and what is told.
type Case = (Stage, &'static str, &'static str, &'static str, &'static str);

#[track_caller]
fn told(cases: &[Case]) {
    for (stage, version, wrong, right, want) in cases {
        assert_eq!(found(*stage, version, wrong), [*want], "{wrong}");
        assert_eq!(found(*stage, version, right), Vec::<String>::new(), "{right}");
    }
}

#[test]
fn values_of_layouts() {
    use Stage::{Compute, Fragment, Geometry, TessControl, Vertex};
    told(&[
        (
            Vertex,
            "440",
            "uniform int n;\nlayout(location = n) in vec4 a;",
            "const int n = 2;\nlayout(location = n) in vec4 a;",
            "E043 `layout(location)` cannot stand here",
        ),
        (
            Vertex,
            "430",
            "layout(location = 1 + 1) in vec4 a;",
            "layout(location = (2)) in vec4 a;",
            "V002 an expression as a layout value needs GLSL 4.40 or `GL_ARB_enhanced_layouts`",
        ),
        (
            Compute,
            "430",
            "layout(local_size_x = 0) in;",
            "layout(local_size_x = 1) in;",
            "E043 `layout(local_size_x)` cannot stand here",
        ),
        (
            Compute,
            "430",
            "layout(local_size_x = 4) in;\nlayout(local_size_x = 8) in;",
            "layout(local_size_x = 4) in;\nlayout(local_size_x = 4, local_size_y = 8) in;",
            "E043 another `local_size_x` than above",
        ),
        (
            TessControl,
            "400",
            "layout(vertices = 3) out;\nlayout(vertices = 4) out;",
            "layout(vertices = 3) out;\nlayout(vertices = 3) out;",
            "E043 another `vertices` than above",
        ),
        (
            Geometry,
            "440",
            "layout(points) in;\nlayout(points, max_vertices = 2) out;\nlayout(max_vertices = 3) out;",
            "layout(points) in;\nlayout(points, max_vertices = 2, max_vertices = 3) out;\nlayout(max_vertices = 3) out;",
            "E043 another `max_vertices` than above",
        ),
        (
            Fragment,
            "330",
            "layout(location = 0, index = 2) out vec4 c;",
            "layout(location = 0, index = 1) out vec4 c;",
            "E043 `layout(index)` cannot stand here",
        ),
        (
            Fragment,
            "330",
            "layout(index = 0) out vec4 c;",
            "layout(location = 0, index = 0) out vec4 c;",
            "E043 `layout(index)` cannot stand here",
        ),
        (
            Vertex,
            "440",
            "layout(std140, align = 24) uniform B { vec4 a; };",
            "layout(std140, align = 32) uniform B { vec4 a; };",
            "E043 `layout(align)` cannot stand here",
        ),
    ]);
}

#[test]
fn values_are_checked_behind_extensions_of_which_nothing_is_known() {
    let text =
        |value: &str| format!("#extension GL_NV_whatever : require\nlayout(local_size_x = {value}, strange = 1) in;");
    assert_eq!(found(Stage::Compute, "430", &text("-1")), ["E043 `layout(local_size_x)` cannot stand here"]);
    assert_eq!(found(Stage::Compute, "430", &text("8")), Vec::<String>::new());
}

#[test]
fn locations_and_components() {
    use Stage::{Fragment, Vertex};
    told(&[
        (
            Vertex,
            "410",
            "layout(location = 0) out mat2 m;\nlayout(location = 1) out vec4 b;",
            "layout(location = 0) out mat2 m;\nlayout(location = 2) out vec4 b;",
            "E043 location 1 of `b` is taken already",
        ),
        (
            Fragment,
            "440",
            "layout(location = 1) in vec3 a;\nlayout(location = 1, component = 2) in float b;",
            "layout(location = 1) in vec3 a;\nlayout(location = 1, component = 3) in float b;",
            "E043 location 1 of `b` is taken already",
        ),
        (
            Vertex,
            "410",
            "layout(location = 0) out B { vec4 a; vec4 b; } o;\nlayout(location = 1) out vec4 c;",
            // Attributes may share one, of which one is read.
            "layout(location = 0) in vec4 a;\nlayout(location = 0) in vec4 b;\nlayout(location = 0) out vec4 c;",
            "E043 location 1 of `c` is taken already",
        ),
        (
            Vertex,
            "440",
            "layout(location = 0, component = 2) out vec3 a;",
            "layout(location = 0, component = 1) out vec3 a;",
            "E043 `layout(component)` cannot stand here",
        ),
        (
            Vertex,
            "440",
            "layout(location = 0, component = 1) out mat2 a;",
            "layout(location = 0, component = 0) out dvec2 a;",
            "E043 `layout(component)` cannot stand here",
        ),
        (
            Vertex,
            "440",
            "out B { layout(location = 1) vec4 a; vec4 b; } o;",
            "layout(location = 3) out B { layout(location = 1) vec4 a; vec4 b; } o;",
            "E043 `layout(location)` cannot stand here",
        ),
    ]);
}

#[test]
fn offsets_of_members() {
    use Stage::Vertex;
    let wrong = "E043 `layout(offset)` cannot stand here";
    told(&[
        (
            Vertex,
            "440",
            "layout(std140) uniform B { layout(offset = 8) vec4 a; };",
            "layout(std140) uniform B { layout(offset = 16) vec4 a; };",
            wrong,
        ),
        (
            Vertex,
            "440",
            "layout(std430) buffer B { layout(offset = 0) vec3 a; layout(offset = 8) float b; };",
            "layout(std430) buffer B { layout(offset = 0) vec3 a; layout(offset = 12) float b; };",
            wrong,
        ),
        // An element of an array of `std140` is as long as a `vec4`.
        (
            Vertex,
            "440",
            "layout(std140) uniform B { float a[2]; layout(offset = 16) float b; };",
            "layout(std430) buffer B { float a[2]; layout(offset = 16) float b; };",
            wrong,
        ),
        (
            Vertex,
            "440",
            "uniform B { layout(offset = 16) vec4 a; };",
            "layout(std140) uniform;\nuniform B { layout(offset = 16) vec4 a; };",
            wrong,
        ),
    ]);
    // Descriptions of Vulkan have packings of their own.
    let push = "layout(push_constant) uniform B { layout(offset = 16) vec4 a; } b;";
    assert_eq!(found(Vertex, "450", push), Vec::<String>::new());
}

#[test]
fn what_is_captured() {
    use Stage::{Geometry, Vertex};
    told(&[
        (
            Vertex,
            "440",
            "layout(xfb_offset = 0) out vec4 a;\nlayout(xfb_offset = 12) out vec4 b;",
            "layout(xfb_offset = 0) out vec4 a;\nlayout(xfb_offset = 16) out vec4 b;",
            "E043 `layout(xfb_offset)` cannot stand here",
        ),
        (
            Vertex,
            "440",
            "layout(xfb_stride = 20) out;\nlayout(xfb_buffer = 0, xfb_stride = 32) out vec4 a;",
            "layout(xfb_stride = 20) out;\nlayout(xfb_buffer = 1, xfb_stride = 32) out vec4 a;",
            "E043 `layout(xfb_stride)` cannot stand here",
        ),
        (
            Vertex,
            "440",
            "layout(xfb_stride = 16) out;\nlayout(xfb_offset = 4) out vec4 a;",
            "layout(xfb_stride = 20) out;\nlayout(xfb_offset = 4) out vec4 a;",
            "E043 this is captured beyond `xfb_stride`",
        ),
        (
            Vertex,
            "440",
            "layout(xfb_offset = 4) out double a;",
            "layout(xfb_offset = 8) out double a;",
            "E043 `layout(xfb_offset)` cannot stand here",
        ),
        (
            Geometry,
            "440",
            "layout(points) in;\nlayout(points, max_vertices = 1) out;\nout B { layout(stream = 1) vec4 a; } b;",
            "layout(points) in;\nlayout(points, max_vertices = 1) out;\nlayout(stream = 1) out B { layout(stream = 1) vec4 a; } b;",
            "E043 `layout(stream)` cannot stand here",
        ),
    ]);
}

#[test]
fn limits_of_built_in_arrays() {
    use Stage::{Fragment, Geometry, Vertex};
    told(&[
        (
            Vertex,
            "130",
            "out float gl_ClipDistance[gl_MaxClipDistances + 1];",
            "out float gl_ClipDistance[gl_MaxClipDistances];",
            "E048 `gl_ClipDistance` has at most `gl_MaxClipDistances` elements",
        ),
        (
            Fragment,
            "120",
            "void main() { gl_FragData[gl_MaxDrawBuffers] = vec4(1.0); }",
            "void main() { gl_FragData[gl_MaxDrawBuffers - 1] = vec4(1.0); }",
            "T016 there is no element `gl_MaxDrawBuffers`",
        ),
        (
            Geometry,
            "150",
            "layout(points) in;\nlayout(points, max_vertices = 1) out;\n\
             void main() { gl_Position = vec4(gl_in[0].gl_ClipDistance[gl_MaxClipDistances]); EmitVertex(); }",
            // A built-in array is copied as a whole.
            "layout(points) in;\nlayout(points, max_vertices = 1) out;\n\
             void main() { gl_ClipDistance = gl_in[0].gl_ClipDistance; EmitVertex(); }",
            "T016 there is no element `gl_MaxClipDistances`",
        ),
        (
            Vertex,
            "150",
            "out gl_PerVertex { vec4 gl_Position; };\nout float gl_ClipDistance[2];",
            "out gl_PerVertex { vec4 gl_Position; float gl_ClipDistance[2]; };",
            "E049 `gl_ClipDistance` is declared again behind a block of `gl_PerVertex`",
        ),
        (
            Fragment,
            "150",
            "in vec4 gl_FragCoord;\nlayout(origin_upper_left) in vec4 gl_FragCoord;",
            "layout(origin_upper_left) in vec4 gl_FragCoord;\nlayout(origin_upper_left) in vec4 gl_FragCoord;",
            "E049 `gl_FragCoord` has other layouts above",
        ),
    ]);
}

#[test]
fn tessellation_stages() {
    use Stage::{TessControl, TessEvaluation};
    told(&[
        (
            TessControl,
            "400",
            "layout(vertices = 3) out;\nout vec4 c;",
            "layout(vertices = 3) out;\nout vec4 c[];\npatch out vec4 d;",
            "E048 `c` has no element for each vertex of the patch",
        ),
        (
            TessControl,
            "400",
            "layout(vertices = 3) out;\nout vec4 c[4];",
            "layout(vertices = 3) out;\nout vec4 c[3];",
            "E048 `c` has 4 elements, but 3 vertices are written",
        ),
        (
            TessEvaluation,
            "400",
            "layout(quads) in;\nin B { vec4 c; } b;",
            "layout(quads) in;\nin B { vec4 c; } b[];\nout vec4 d;\nvoid main() { float n[gl_in.length()]; }",
            "E048 `b` has no element for each vertex of the patch",
        ),
        (
            TessControl,
            "400",
            "layout(vertices = 3) out;\nuniform bool u;\nvoid main() { if (u) barrier(); }",
            "layout(vertices = 3) out;\nvoid main() { { barrier(); } barrier(); }",
            "E045 `barrier` cannot stand here",
        ),
        (
            TessControl,
            "400",
            "layout(vertices = 3) out;\nuniform bool u;\nvoid main() { if (u) return; barrier(); }",
            "layout(vertices = 3) out;\nuniform bool u;\nvoid main() { barrier(); if (u) return; }",
            "E045 `barrier` cannot stand here",
        ),
    ]);
}

#[test]
fn the_interlock_and_compute_stages() {
    use Stage::{Compute, Fragment};
    let lock = "#extension GL_ARB_fragment_shader_interlock : require\nvoid main() {";
    let wrong = [
        (
            "endInvocationInterlockARB(); beginInvocationInterlockARB(); }",
            "E045 `endInvocationInterlockARB` cannot stand here",
        ),
        ("for (;;) { beginInvocationInterlockARB(); } }", "E045 `beginInvocationInterlockARB` cannot stand here"),
        (
            "beginInvocationInterlockARB(); beginInvocationInterlockARB(); }",
            "E045 `beginInvocationInterlockARB` cannot stand here",
        ),
    ];
    for (body, want) in wrong {
        assert_eq!(found(Fragment, "420", &format!("{lock}{body}")), [want]);
    }
    let right = format!("{lock}beginInvocationInterlockARB(); endInvocationInterlockARB(); }}");
    assert_eq!(found(Fragment, "420", &right), Vec::<String>::new());
    told(&[
        (
            Compute,
            "430",
            "layout(local_size_x = 1) in;\nout vec4 o;",
            "layout(local_size_x = 1) in;\nshared vec4 o;",
            "E042 a compute shader has no inputs and outputs",
        ),
        (
            Compute,
            "430",
            "uint n() { return gl_WorkGroupSize.x; }\nlayout(local_size_x = 1) in;",
            "layout(local_size_x = 1) in;\nuint n() { return gl_WorkGroupSize.x; }",
            "E043 `gl_WorkGroupSize` is used before the size is declared",
        ),
    ]);
}

#[test]
fn functions_and_overloads() {
    use Stage::{Fragment, Vertex};
    told(&[
        (
            Vertex,
            "400",
            "void f(float a) {}\nvoid f(uint a) {}\nvoid main() { f(1); }",
            "void f(float a) {}\nvoid f(double a) {}\nvoid main() { f(1); }",
            "E022 which `f` is meant is not certain",
        ),
        (
            Vertex,
            "130",
            "vec4 f(out vec4 a) { a = vec4(0.0); return a; }\nvec4 f(out ivec4 a) { a = ivec4(0); return vec4(a); }\n\
             vec4 g(vec4 a, out vec4 b) { return f(b); }\nvec4 g(vec4 a, out ivec4 b) { b = ivec4(1); return a; }\n\
             void main() { vec4 r; gl_Position = g(ivec4(1), r); }",
            "vec4 g(vec4 a, out vec4 b) { b = a; return a; }\nvec4 g(vec4 a, out ivec4 b) { b = ivec4(1); return a; }\n\
             void main() { vec4 r; gl_Position = g(vec4(1), r); }",
            "E022 which `g` is meant is not certain",
        ),
        (
            Vertex,
            "150",
            "void f(const in int a);\nvoid f(in int a) {}",
            "void f(const in int a);\nvoid f(const int a) {}",
            "E024 `f` has other `in`, `out` and `const` parameters here than before",
        ),
        (
            Vertex,
            "150",
            "float f(float a[2]) { return a[0]; }\nvoid main() { float a[]; a[1] = 1.0; float b = f(a); }",
            "float f(float a[2]) { return a[0]; }\nvoid main() { float a[2]; a[1] = 1.0; float b = f(a); }",
            "E048 an array without a size cannot be passed as a whole",
        ),
        (
            Vertex,
            "150",
            "void f(vec4[2] a[2]) {}",
            "void f(vec4 a[2]) {}",
            "V002 an array of arrays needs GLSL 4.30 or `GL_ARB_arrays_of_arrays`",
        ),
        (
            Fragment,
            "150",
            "void main() { while (float f = 5.0) {} }",
            "void main() { while (bool f = false) {} }",
            "E037 the condition of `while` must be a `bool`, not a `float`",
        ),
        (
            Vertex,
            "150",
            "vec4 b() { return vec4(0.0); }\nout b { vec4 a; } o;",
            "vec4 c() { return vec4(0.0); }\nout b { vec4 a; } o;",
            "E024 `b` is declared twice in this scope",
        ),
        (
            Vertex,
            "150",
            "uniform B { vec4 a; } b[];",
            "uniform B { vec4 a; } b[2];",
            "E048 an array of uniform blocks needs a size",
        ),
    ]);
    assert_eq!(
        found(Vertex, "100", "float f();\nfloat f();"),
        ["E024 `f` is declared twice, which this version does not allow"]
    );
    assert_eq!(found(Vertex, "300 es", "float f();\nfloat f();"), Vec::<String>::new());
}

#[test]
fn subroutines_and_their_types() {
    use Stage::Vertex;
    let ty = "subroutine float shape(float x);\n";
    for (body, want) in [
        ("subroutine(shape) float a(int x) { return 1.0; }", "E046 `a` is no `shape`: its types differ"),
        ("subroutine(form) float a(float x) { return x; }", "E023 there is no subroutine type `form`"),
        ("subroutine(shape) float a(float x);", "E042 `subroutine(shape)` cannot stand here"),
        ("subroutine int n;", "E042 `subroutine` cannot stand here"),
        ("void main() { float a = shape(1.0); }", "E021 `shape` is a subroutine type and cannot be called"),
    ] {
        assert_eq!(found(Vertex, "400", &format!("{ty}{body}")), [want]);
    }
    let right = "subroutine(shape) float a(float x) { return x; }\nsubroutine uniform shape s;\nvoid main() { float b = s(1.0); }";
    assert_eq!(found(Vertex, "400", &format!("{ty}{right}")), Vec::<String>::new());
}

#[test]
fn handles_of_samplers_are_values() {
    let text = |extension: &str| {
        format!(
            "{extension}\nin flat sampler2D t;\nuniform sampler2D u;\nout vec4 c;\n\
             sampler2D f(sampler2D a) {{ return a; }}\n\
             void main() {{ sampler2D s = f(t); uvec2 h = uvec2(u); c = texture(s, vec2(h)); }}"
        )
    };
    assert_eq!(
        found(Stage::Fragment, "430", &text("#extension GL_ARB_bindless_texture : require")),
        Vec::<String>::new()
    );
    assert_ne!(found(Stage::Fragment, "430", &text("")), Vec::<String>::new());
}

#[test]
fn the_first_version_has_prototypes_in_functions() {
    let text = "void main() { float f(float x); gl_Position = vec4(f(0.5)); }\nfloat f(float x) { return x; }";
    assert_eq!(found(Stage::Vertex, "110", text), Vec::<String>::new());
    assert_ne!(found(Stage::Vertex, "120", text), Vec::<String>::new());
}

#[test]
fn foreign_characters_in_a_macro_count_where_it_is_used() {
    let text = |body: &str| format!("#define NAME \u{7bb8}\nvoid main() {{ {body} }}");
    assert_eq!(found(Stage::Vertex, "300 es", &text("")), Vec::<String>::new());
    assert_eq!(found(Stage::Vertex, "300 es", &text("int a = 1 NAME;")), ["E002 `\u{7bb8}` is not part of GLSL"]);
    assert_eq!(found(Stage::Vertex, "330", &text("")), ["E002 `\u{7bb8}` is not part of GLSL"]);
}

#[test]
fn a_library_may_be_included_by_any_stage() {
    let texts = [
        "layout(depth_greater) out float gl_FragDepth;",
        "layout(early_fragment_tests) in;",
        "layout(local_size_x = 8) in;",
        "layout(triangles) in;\nlayout(line_strip, max_vertices = 2) out;",
        "layout(triangles, equal_spacing) in;",
        "layout(vertices = 3) out;",
    ];
    for text in texts {
        assert_eq!(found(Stage::Library, "430", text), Vec::<String>::new(), "{text}");
    }
    for text in ["layout(depth_greater) out float depth;", "layout(local_size_x = 8) out;", "layout(vertices = 3) in;"]
    {
        assert!(found(Stage::Library, "430", text)[0].starts_with("E043"), "{text}");
    }
}
