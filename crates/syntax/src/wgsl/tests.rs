//! What the front end reads from modules.

use super::super::ast::{ExprKind, ItemKind, StmtKind};
use super::super::symbols::CallTarget;
use super::*;

fn parsed(text: &str) -> super::super::Parsed {
    Shader::parse_wgsl(&SourceFile::new("a.wgsl", text))
}

fn errors(text: &str) -> Vec<String> {
    let parsed = parsed(text);
    parsed.diagnostics.iter().map(|d| format!("{} {}", parsed.shader.file().locate(d.span.start), d.message)).collect()
}

/// The types of the expressions with this text.
fn type_of(text: &str, part: &str) -> String {
    let parsed = parsed(text);
    assert!(parsed.diagnostics.is_empty(), "{:?}", errors(text));
    let shader = parsed.shader;
    let found = shader.arena().iter().filter(|(id, _)| shader.text_of(*id) == part).last();
    let (id, _) = found.unwrap_or_else(|| panic!("no `{part}`"));
    spelling(shader.type_of(id))
}

const MODULE: &str = "
struct Light { @location(0) position: vec3<f32>, intensity: f32, flags: array<atomic<u32>, N * 2>, }
@group(0) @binding(1) var<storage, read_write> lights: array<Light>;
@group(0) @binding(2) var image: texture_2d<f32>;
@group(0) @binding(3) var filtering: sampler;
override scale: f32 = 1.0;
const N = 2;
alias Row = vec4f;
fn helper(p: ptr<function, vec3f>, a: i32) -> Row { (*p).x = 1; return vec4(*p, 1); }
@compute @workgroup_size(8, N)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
  var v = lights[id.x].position;
  let r = helper(&v, 3);
  let s = 2 * v.x / f32(id.y);
  let c = textureSampleLevel(image, filtering, v.xy, 0);
  let n = select(0.0, s, s > 1 && r.w < 2.0);
  let m = mat3x3<f32>(v, v, v) * v;
  let b = v < vec3(1);
  loop { if (n > 1) { break; } continuing { v.x += 1; break if v.x >= f32(arrayLength(&lights)); } }
  switch id.x { case 0, 1u: { v.y = 1; } default { return; } }
  for (var i = 0u; i < 4; i++) { v[i] -= saturate(n); }
}
";

#[test]
fn types_of_expressions_are_known() {
    for (part, ty) in [
        ("lights[id.x].position", "vec3f"),
        ("helper(&v, 3)", "vec4f"),
        ("2 * v.x / f32(id.y)", "f32"),
        ("textureSampleLevel(image, filtering, v.xy, 0)", "vec4f"),
        ("select(0.0, s, s > 1 && r.w < 2.0)", "f32"),
        ("mat3x3<f32>(v, v, v) * v", "vec3f"),
        ("v < vec3(1)", "vec3<bool>"),
        ("vec3(1)", "vec3f"),
        ("arrayLength(&lights)", "u32"),
        ("vec4(*p, 1)", "vec4f"),
        ("i < 4", "bool"),
        ("saturate(n)", "f32"),
    ] {
        assert_eq!(type_of(MODULE, part), ty, "{part}");
    }
}

#[test]
fn a_module_says_its_interface() {
    let parsed = parsed(MODULE);
    let module = parsed.shader.wgsl().unwrap();
    assert_eq!(module.entry_points[0].workgroup, Some([8, 2, 1]));
    assert!(!module.composed && !parsed.shader.has_unknown_names());
    let names: Vec<&str> = module.globals().map(|(v, _)| v.name.name.as_str()).collect();
    assert_eq!(names, ["lights", "image", "filtering", "scale", "N"]);
    let light = &module.layouts["Light"];
    let offsets: Vec<u64> = light.members.iter().map(|m| m.offset).collect();
    assert_eq!((offsets, light.extent), (vec![0, 12, 16], Extent { align: 16, size: 32 }));
}

#[test]
fn what_glsl_has_is_in_the_tree_as_in_glsl() {
    let shader = parsed(MODULE).shader;
    let kinds: Vec<&ExprKind> = shader.arena().iter().map(|(_, e)| &e.kind).collect();
    assert!(kinds.iter().any(|k| matches!(k, ExprKind::Ternary { .. })));
    let clamps = shader.arena().iter().filter(
        |(id, _)| matches!(shader.callee(*id), Some(CallTarget::Builtin(call)) if call.function.name() == "clamp"),
    );
    assert_eq!(clamps.count(), 1);
    let ItemKind::Function(main) = &shader.unit().items.last().unwrap().kind else { panic!() };
    let statements = &main.body.as_ref().unwrap().statements;
    assert!(statements.iter().any(|s| matches!(s.kind, StmtKind::DoWhile { .. })));
    let v = shader.symbols().find(|(_, s)| s.name == "v").unwrap().0;
    assert!(shader.is_written(v), "by the pointer, too");
}

#[test]
fn errors_have_places_and_reading_goes_on() {
    let text =
        "fn a() { let x = ; }\nfn b() -> f32 { return 1.0 }\nfn c() { let y = 1 & 2 * 3; }\nvar<private z: f32;\n";
    let found = errors(text);
    assert_eq!(found.len(), 4, "{found:#?}");
    assert!(found[0].starts_with("a.wgsl:1:18"), "{found:?}");
    assert!(found[2].contains("`*` and `&`"), "{found:?}");
    assert_eq!(parsed(text).shader.functions().count(), 3);
    assert!(errors("#import a\nfn a() { let x = {{ b }}; }").is_empty(), "an engine completes it");
}

#[test]
fn operators_need_the_parentheses_that_the_grammar_asks_for() {
    for right in
        ["a + b * c - d", "a < b && c < d", "a && b && c", "a | b | c", "a << b < c", "(a & b) == c", "-a + !b"]
    {
        assert!(errors(&format!("fn f() {{ x = {right}; }}")).is_empty(), "{right}");
    }
    for wrong in ["a & b == c", "a && b || c", "a | b & c", "a << b + c", "a < b < c", "a << b << c", "a & b && c"] {
        assert_eq!(errors(&format!("fn f() {{ x = {wrong}; }}")).len(), 1, "{wrong}");
    }
}

#[test]
fn constant_indices_and_old_attributes_are_reported_once() {
    let text = "const n = 3;\nfn f() -> f32 { let a = array<f32, 3>(); return a[n] + a[2]; }\n";
    assert_eq!(errors(text), ["a.wgsl:2:51 there is no element 3"]);
    let old = "[[stage(fragment)]] fn f([[location(0)]] a: f32) -> [[location(0)]] f32 { return a; }\n";
    assert_eq!(errors(old).len(), 1);
}

#[test]
fn any_text_is_read_without_a_panic() {
    let cut = (0..MODULE.len()).step_by(3).map(|n| MODULE[..n].to_owned());
    let holes = (0..MODULE.len() - 5).step_by(7).map(|n| format!("{}{}", &MODULE[..n], &MODULE[n + 5..]));
    let deep = ["(", "-", "a[", "vec3<", "{", "f(", "&", "if x {"].map(|t| format!("fn f() {{ x = {}", t.repeat(5000)));
    let long = format!("fn f() {{ x = 1{}; }}", " + 1".repeat(5000));
    let chain = (0..20_000).map(|n| format!("const c{n} = c{} + 1;\nalias A{n} = A{};\n", n + 1, n + 1)).collect();
    let own = "struct S { s: S, a: A, b: array<S, 2> } alias A = B; alias B = A;".to_owned();
    for text in cut.chain(holes).chain(deep).chain([long, own, chain]) {
        parsed(&text);
    }
}

/// What is told of a function with this body, which gives back an `f32`.
fn misfits(body: &str) -> Vec<String> {
    errors(&format!(
        "const K = 3; const TABLE = array(1, 2, 3); const HALF = vec2(1, 2);\n\
         fn twice(x: f32) -> f32 {{ return 2 * x; }}\n\
         fn f(v: vec3f, u: u32, i: i32, b: bool, m: mat3x3f) -> f32 {{ {body} return 0; }}\n"
    ))
}

#[test]
fn values_of_another_type_than_their_place_takes_are_told() {
    let operands = |a: &str, op: &str, b: &str| format!("`{op}` does not take `{a}` and `{b}`");
    for (body, told) in [
        ("let x = any(v < vec3f() || v > vec3f(1));", operands("vec3<bool>", "||", "vec3<bool>")),
        ("let x = v + vec2f(1, 1);", operands("vec3f", "+", "vec2f")),
        ("let x = u + i;", operands("u32", "+", "i32")),
        ("let x = u * 1.5;", operands("u32", "*", "f32")),
        ("let x = m * vec4f();", operands("mat3x3f", "*", "vec4f")),
        ("let x = v < 0.0;", operands("vec3f", "<", "f32")),
        ("let x = 1u << i;", operands("u32", "<<", "i32")),
        ("let x = v & vec3f();", operands("vec3f", "&", "vec3f")),
        ("var x = u; x += i;", operands("u32", "+", "i32")),
        ("let x: f32 = u;", "a value of type `u32` does not go into a `f32`".to_owned()),
        ("var x = v; x = v.xy;", "a value of type `vec2f` does not go into a `vec3f`".to_owned()),
        ("let x: i32 = 1.5;", "a value of type `f32` does not go into a `i32`".to_owned()),
        ("if b { return v; }", "the function returns `f32`, and this value is `vec3f`".to_owned()),
        ("if u { return 1; }", "a condition is a `bool`, not a `u32`".to_owned()),
        ("let x = twice(v);", "`twice` takes a `f32` here, not a `vec3f`".to_owned()),
    ] {
        let found = misfits(body);
        assert!(found.len() == 1 && found[0].ends_with(&told), "{body}: {found:?}");
    }
}

#[test]
fn numbers_that_are_written_out_take_the_type_of_their_place() {
    for body in [
        "let x = u + K; let y = v.x * K; let z: u32 = min(K, 2) + 1; let w = 1u << K;",
        "let x = u * TABLE[1]; let y = v.x + HALF.y; let z: vec2f = HALF; let w = u + max(1, 2);",
        "let x = all(v < vec3(1)) && b; let y = m * v; let z = v * m; let w = 2 * m; let k = v / 2;",
        "let p = &TABLE; let x = select(0, 1, b); let y: u32 = x_of(u); let z: f32 = unseen;",
        "var x = u; x += 1; x <<= 2; x |= 1u << u; let y = -(1) + i; let z = u % 2 == 0;",
        "var a: array<u32, 4>; a[K] = 1; let y = a[i] & 0xff; for (var k = 0; k < K; k++) { let q = i + k; }",
        "let x: u32 = ~0xffffffff & (0x100000000 - 1); let y = u ^ 0x9e3779b9; let z = vec2u(u) * 0x9e3779b9;",
        "var x = i64(5); x += 31li - 1002003004005006li; let y = u64(u) + 0x7fffffffffffffffli;",
        "let x = b & (u > 1); let y = (v < vec3f()) | (v > vec3f(1)); let z = twice(1);",
    ] {
        let found = misfits(body);
        assert!(found.is_empty(), "{body}: {found:?}");
    }
    // Of texts that an engine puts together, each has its own types.
    assert!(
        errors("#ifdef A\nalias T = f32;\n#else\nalias T = u32;\n#endif\nfn f(x: u32) -> T { return x; }\n").is_empty()
    );
}

#[test]
fn an_atomic_is_written_by_a_function_alone() {
    let of = |body: &str| {
        errors(&format!(
            "struct H {{ n: atomic<u32>, m: u32 }}\n@group(0) @binding(0) var<storage, read_write> hs: array<H>;\n\
             var<workgroup> own: atomic<i32>; var<workgroup> all: array<atomic<u32>, 4>;\nfn f(i: u32) {{ {body} }}\n"
        ))
    };
    for wrong in ["hs[i].n = 0u;", "own = 1;", "all[i] += 2u;"] {
        let found = of(wrong);
        assert!(found.len() == 1 && found[0].ends_with("an atomic is written by `atomicStore`"), "{wrong}: {found:?}");
    }
    let right = "hs[i].m = 0u; atomicStore(&hs[i].n, 1u); var own = 1; own = 2; let x = atomicAdd(&all[i], 1u);";
    assert!(of(right).is_empty(), "{:?}", of(right));
}

#[test]
fn template_lists_are_told_from_comparisons() {
    let of = |expression: &str| {
        let text = format!("fn f(a: i32, b: i32, c: i32, g: i32) {{ let x = {expression}; }}");
        let parsed = parsed(&text);
        let lists = parsed.shader.arena().iter().filter(|(_, e)| matches!(e.kind, ExprKind::Call { .. }));
        (lists.count(), parsed.diagnostics.iter().filter(|d| d.code == errors::SYNTAX).count())
    };
    for list in ["load<mat<f32, A>>(a)", "load<A>(a)", "vec2<i32>(a, b)", "load<(a > b)>(c)", "array<i32, (2 >> 1)>(a)"]
    {
        assert_eq!(of(list), (1, 0), "{list}");
    }
    for compared in
        ["a < b && c > (g)", "(a < b) == (c > (g))", "a < b", "(a < b) || c >> 1u > (2)", "a <= b", "a << 2u"]
    {
        assert_eq!(of(compared), (0, 0), "{compared}");
    }
    assert_eq!(of("load(a < b, c)"), (1, 0));
}
