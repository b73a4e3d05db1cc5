//! Texts in which a template engine, or another preprocessor, fills something in.

use super::*;

/// Messages of a fragment shader with this text in front of one with a fault, and of the same without it.
#[track_caller]
fn found(before: &str) -> (Vec<String>, Vec<String>) {
    let text = |value: &str| {
        format!(
            "#version 330\nout vec4 c;\n{before}\nvec3 own() {{ vec3 p = vec3({value}); return p; }}\nvoid main() {{ c = vec4(own(), 1.0); }}\n"
        )
    };
    (errors(&text("1.0, 2.0, 3.0, 4.0"), Stage::Fragment), errors(&text("1.0, 2.0, 3.0"), Stage::Fragment))
}

#[test]
fn a_hole_stands_for_what_is_needed_and_the_rest_is_read() {
    for before in [
        "const float a = ${PI};",
        "const float a = ${2 * PI} * 2.0;",
        "const float a[2] = float[2](${x}, {{ y }});",
        "const float a = ${n}.0 + 2.0 * {{n}}f;",
        "{{ uniforms }}",
        "{{{ uniforms }}}",
        "[[UNIFORMS]];",
        "##UNIFORMS##",
        "@import ./light.glsl;",
        "${declare(B, \"vec4\", 0)}",
        "$declare(B, 0)",
        "$constant FlagOutline FLAGOUTLINE",
        "<light.uniforms>",
        "$type x;",
        "uniform $type x;",
        "uniform ${PRECISION} float x;",
        "${in} vec4 x;",
        "flat $in vec4 x;",
        "in vec%N% v;",
        "in %Bones% b;",
        "float w[[[COUNT]]];",
        "float w[{COUNT}];\nfloat f() { float s = 0.0; for (int i = 0; i < {COUNT}; i++) s += w[i]; return s; }",
        "float w[${COUNT}];\nfloat f() { return w[2]; }",
        "vec3 f(vec4 raw) { vec3 a = {decode}(raw); a += {decode}(raw.wzyx); return a; }",
        "layout(location = ${n}) in vec4 x;",
        "layout(location = %ws) in vec4 x;",
        "const float a = 2.0 * %s + %d;",
        "layout(${key}) in vec4 x;",
        "float f(float x) { return <moved(x)> + x; }",
        "float f(float x) { return $moved(x) * $gain; }",
        "float f(float x) { float d = arrow_<kind>(x, 1.0); return d; }",
        "float f(float x) { return x ${op} 2.0; }",
        "float f(vec4 x) { return x.${axis} + x.{{axis}}; }",
        "float f(float x) { {{ body }} }",
        "float f(float x) {\n${body}\nreturn x; }",
        "vec2 f(vec2 x) { x = <moved(x)>; $BODY; return x; }",
        "$type f($type x) { return x; }",
        "float ${name}(float x) { return x; }\nfloat g() { return ${name}(1.0) + input_${n}; }",
        "{% if wide %}\nuniform vec4 a;\n{% else %}\nuniform vec2 b;\n{% endif %}",
        "{% if wide %}uniform vec4 a;{% endif %}",
        "float f(float x) {\n{% for i in (1, 2) -%}\nx += {{ i }}.0;\n{%- endfor %}\nreturn x; }",
        "$if WIDE == \"yes\":\nuniform vec4 a;",
        "$WIDE = (any([name in NAMES for name in [\"a\", \"b\"]]))",
        "struct S { vec4 a; ${members} };",
        "struct S { vec4 a;\n{{ members }}\nvec2 b; };",
        "#if ${WIDE}\nuniform vec4 a;\n#endif",
        "#define SIZE ${size}\nconst int n = SIZE;",
        "#define SIZE #{size}\nconst int n = SIZE;",
        "#define WIDE #{wide}\n#if WIDE\nuniform vec4 a;\n#endif",
        "const float a = #{gray};",
        "%1",
        "{UNIFORMS}",
        "float f(float x) {\n{BODY}\nreturn x; }",
        "float f(float x) { return x * %1; }",
        "float f(float x) { if (${fast}) { return 1.0; } return x; }",
        "float f(float x) { return f_{{ kind }}(x) + %GAIN%; }",
        "const float a = {% if wide %} 1.0 {% else %} 2.0 {% endif %};",
    ] {
        let (wrong, right) = found(before);
        assert!(right.len() == 1 && right[0].starts_with("E002 "), "{before}: {right:?}");
        assert!(wrong.iter().any(|error| error.starts_with("T001 ")), "{before}: {wrong:?}");
    }
}

#[test]
fn a_hole_in_front_may_be_nothing() {
    let found = errors("${license}\n#version 330\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n", Stage::Fragment);
    assert_eq!(found, ["E002 1:1 `${license}` is not part of GLSL"]);
}

#[test]
fn what_the_language_has_is_no_hole() {
    for text in [
        "#pragma glslify: g = require(@own/lib/g);\nfloat f(float x) { return x; }",
        "int f(int a, int b, int c) { return a%b%c + a % b %c; }",
        "float f(float a[2], int b[2], int c[2]) { return a[b[c[0]]]; }",
        "struct S { float a[2]; }; float f(float x) { S s = {{x, 2.0}}; S t[1] = {{{x, x}}}; return s.a[0] + t[0].a[0]; }",
        "struct S { float a[1]; }; float f(float x) { S s = {{x}}; return s.a[0]; }",
        "float f(float x) { {{ x += 1.0; }} return x; }",
        "float f(float x) { float a[1] = {x}; if (x > 0.0) {x;} (x); return a[0]; }",
        "#define PASTE(a, b) a##b\nfloat f() { float xy = 1.0; return PASTE(x, y); }",
        "#define BODY return 1.0;\nfloat f() {BODY}",
        "#define BODY return 1.0;\nfloat f()\n{BODY}",
        "int f(int a) { return a %1 + a% 2; }",
        "bool f(int a, int b, int c) { return a <b && (b> c); }",
    ] {
        let shader = clean(&format!("#version 460\n{text}\n"), Stage::Library);
        assert!(shader.holes().is_empty(), "{text}");
    }
}
