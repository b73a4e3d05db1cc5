//! Directives and macros.

use super::*;

fn types(source: &str) -> Vec<String> {
    let shader = clean(source, Stage::Library);
    shader.interface().globals.iter().map(|v| format!("{} {}", v.ty, v.name)).collect()
}

#[test]
fn macros_are_expanded() {
    let source = "#define TWO 2\n#define ADD(a, b) (a + b)\n#define NEST(x) ADD(x, TWO)\n#define CAT(a, b) a##b\n\
                  #define EMPTY\n#define NONE() 3\n#define f(x) f(x)\n#define LONG(a) \\\n  a + \\\n  1\n\
                  float a[NEST(ADD(1, TWO))];\nfloat CAT(b, 1)[NONE()] EMPTY;\nfloat c[LONG(1)];\n\
                  float f(float x) { return x; }\nfloat g() { return f(f(1.0)); }";
    assert_eq!(types(source), ["float[5] a", "float[3] b1", "float[2] c"]);
}

#[test]
fn conditions_choose_lines() {
    let source = "#version 330\n#define A 3\n#if A == 3 && defined(A) && !defined B && (A << 1) > 5\nint yes1;\n#else\nint no1 = \"broken;\n#endif\n\
                  #ifdef B\nint no2;\n#elif A > 2\nint yes2;\n#elif 1\nint no3;\n#else\nint no4;\n#endif\n\
                  #ifndef B\n#if 0\n# if 1\nint no5;\n# else\nint no6;\n# endif\n#endif\nint yes3;\n#endif\n\
                  #if __VERSION__ >= 330 && defined(GL_core_profile)\nint yes4;\n#endif\n#undef A\n#ifdef A\nint no7;\n#endif\n\
                  #ifdef GL_ES\nint no8;\n#endif\n#pragma optimize(on) \"free text\"\n#\n";
    assert_eq!(types(source), ["int yes1", "int yes2", "int yes3", "int yes4"]);
}

#[test]
fn predefined_macros_follow_the_version() {
    assert_eq!(types("#ifdef GL_core_profile\nint no;\n#endif\nint a[__VERSION__];"), ["int[110] a"]);
    assert_eq!(types("#version 300 es\n#ifdef GL_ES\nint a[__LINE__];\n#endif"), ["int[3] a"]);
    let source = "#version 150\n#extension GL_ARB_gpu_shader5 : enable\n#ifdef GL_ARB_gpu_shader5\nint yes;\n#endif";
    assert_eq!(types(source), ["int yes"]);
}

#[test]
fn a_function_like_macro_without_parenthesis_is_a_name() {
    assert_eq!(types("#define F(x) x\nint F;"), ["int F"]);
    assert_eq!(types("#define F (3)\nint a[F];"), ["int[3] a"]);
}

#[test]
fn macro_calls_may_span_lines() {
    assert_eq!(types("#define F(a, b) a + b\nint x[F(1, // 一\n  2)];"), ["int[3] x"]);
}

#[test]
fn recursive_macros_end() {
    assert_eq!(types("#define A B\n#define B A\nint A;\n#define g(x) g(x) x(x)\nint c[2];").len(), 2);
    let bomb: String = (0..40).map(|i| format!("#define M{} M{i} M{i}\n", i + 1)).collect();
    let found = errors(&format!("#define M0 +\n{bomb}int x = 1 M40 1;"), Stage::Library);
    assert!(
        found.len() == 1 && found[0].starts_with("E004") && found[0].contains("more than 2000000 tokens"),
        "{found:?}"
    );
    let deep = format!("#define F(x) (x)\nint x = {}1{};", "F(".repeat(5000), ")".repeat(5000));
    assert!(!errors(&deep, Stage::Library).is_empty());
}

#[test]
fn wrong_directives_are_reported_at_their_place() {
    for (source, want) in [
        ("#include \"a.glsl\"\nvoid f() { g(); }", "E015 1:1 `#include` is not part of GLSL"),
        ("#defin A 1", "E010 1:2 `#defin` is no directive of GLSL"),
        ("/* 頂点 */ #ifdef A\nint x;", "E011 1:10 this `#if` has no `#endif`"),
        ("int x;\n#endif", "E011 2:1 `#endif` without `#if`"),
        ("#else", "E011 1:1 `#else` without `#if`"),
        ("#if 1\n#else\n#else\n#endif", "E011 3:1 a second `#else` for one `#if`"),
        ("#if 1 +\n#endif", "E012 1:1 a value is missing at the end of this condition"),
        ("#if (1\n#endif", "E012 1:1 expected `)` in this condition"),
        ("#if 1.0\n#endif", "E012 1:5 a condition takes integers only"),
        ("#if 1 / 0\n#endif", "E012 1:9 this condition divides by zero"),
        ("#if 1 2\n#endif", "E012 1:7 `2` is not expected in this condition"),
        ("#ifdef 1\n#endif", "E012 1:1 `#ifdef` takes one name"),
        ("#define 1", "E012 1:1 `#define` needs a name"),
        ("#define F(a b) a", "E012 1:1 the parameters of a macro are names separated by commas"),
        ("#version 151", "E012 1:10 this is no version of GLSL"),
        ("#version 150 pro", "E012 1:14 `pro` is no profile of version 150"),
        ("#extension GL_X enable", "E012 1:1 `#extension` is written as `#extension NAME : enable`"),
        ("#extension GL_X : on", "E012 1:19 `on` is no behaviour of an extension"),
        ("#ifdef A\n#endif A", "E012 2:8 nothing may follow `#endif`"),
        ("#error 未対応 version", "E013 1:1 #error: 未対応 version"),
        ("#define F(x) x\nint a[F(1, 2)];", "E014 2:7 macro `F` takes 1 argument, not 2"),
        ("#define A 1\n#define A 2", "E014 2:9 macro `A` is defined twice with different bodies"),
    ] {
        assert_eq!(errors(source, Stage::Library), [want], "{source}");
    }
    let unclosed = errors("#define F(x) x\nint a = F(1;", Stage::Library);
    assert_eq!(unclosed[0], "E014 2:9 the call of macro `F` has no closing `)`");
}

#[test]
fn what_a_condition_leaves_out_is_not_checked() {
    clean("#if 0\n@@ 1.0.0 #bogus ' unclosed \"\n#error no\n#version 9\n#endif\n", Stage::Library);
}

#[test]
fn line_directives_move_line_numbers_only_for_macros() {
    assert_eq!(types("#line 7\nint a[__LINE__];"), ["int[7] a"]);
    assert_eq!(errors("#line 70\nint a = b;", Stage::Library), ["E020 2:9 `b` is not declared"]);
}
