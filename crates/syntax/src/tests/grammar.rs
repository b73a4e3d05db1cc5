//! Trees, types and values of expressions.

use super::*;
use crate::ast::{BinaryOp, ExprId, ExprKind, ItemKind, StmtKind, UnaryOp};
use crate::symbols::CallTarget;
use crate::{Const, Fit, TokenPlace};

/// The expression with this text, the outermost one.
#[track_caller]
fn find(shader: &Shader, wanted: &str) -> ExprId {
    let found = shader.arena().iter().filter(|(id, _)| shader.text_of(*id) == wanted).last();
    found.unwrap_or_else(|| panic!("no expression `{wanted}`")).0
}

#[track_caller]
fn value(text: &str) -> Option<Const> {
    let source = format!("#version 400\nconst int N = 3; const float F = 0.5;\nvoid f() {{ {text}; }}");
    let shader = clean(&source, Stage::Library);
    shader.fold(find(&shader, text))
}

#[test]
fn precedence_and_association_follow_the_specification() {
    let shader = clean(
        &in_main("float x = 1.0; bool b = x + 2.0 * -x < 3.0 || x == 4.0 && !(x > 5.0);\nx = x - 6.0 - 7.0;"),
        Stage::Vertex,
    );
    let ExprKind::Binary { op: BinaryOp::Or, left, right, .. } =
        &shader.expr(find(&shader, "x + 2.0 * -x < 3.0 || x == 4.0 && !(x > 5.0)")).kind
    else {
        panic!("|| binds least")
    };
    assert_eq!(shader.text_of(*left), "x + 2.0 * -x < 3.0");
    assert_eq!(shader.text_of(*right), "x == 4.0 && !(x > 5.0)");
    let ExprKind::Binary { left, .. } = &shader.expr(find(&shader, "x - 6.0 - 7.0")).kind else { panic!() };
    assert_eq!(shader.text_of(*left), "x - 6.0");
    let ExprKind::Unary { op: UnaryOp::Not, operand, .. } = &shader.expr(find(&shader, "!(x > 5.0)")).kind else {
        panic!()
    };
    assert!(matches!(shader.expr(*operand).kind, ExprKind::Paren(_)), "parentheses stay");
}

#[test]
fn expressions_have_types() {
    let shader = clean(SKINNING, Stage::Vertex);
    for (text, ty) in [
        ("modelViewMatrix * position", "vec4"),
        ("dot(v1, v1)", "float"),
        ("p1[i] - p0[i]", "vec4"),
        ("pow(length(v2) + 1.0, exponent) * blendMatrix[i] * p", "vec4"),
        ("pow(length(v2) + 1.0, exponent) * blendMatrix[i]", "mat4"),
        ("l > 0.0", "bool"),
        ("blendMatrix[i]", "mat4"),
    ] {
        assert_eq!(shader.type_of(find(&shader, text)).to_string(), ty, "{text}");
    }
    let shader = clean(GRAMMAR, Stage::Fragment);
    for (text, ty) in [
        ("m32 * transpose(m32)", "mat2"),
        ("product[0][1]", "float"),
        ("texelFetch(ids, size - 1, 0)", "uvec4"),
        ("pairs[0].a", "vec2"),
        ("pairs", "Pair[1]"),
        ("grid[rows - 1]", "float[3]"),
        ("7u << 2", "uint"),
        ("both ? vec4(uv, 0, 1) : vec4(0.5)", "vec4"),
        ("c.yx", "vec2"),
        ("(c, c)", "vec4"),
        ("items[0]", "float"),
    ] {
        assert_eq!(shader.type_of(find(&shader, text)).to_string(), ty, "{text}");
    }
    assert_eq!(shader.interface().constant("rows").unwrap().value, Some(Const::Int(2)));
    assert_eq!(shader.interface().constant("last").unwrap().value, Some(Const::Int(2)));
    assert_eq!(shader.interface().constant("table").unwrap().ty.to_string(), "float[3]");
}

#[test]
fn constants_are_folded() {
    assert_eq!(value("N * (2 + 1) % 4"), Some(Const::Int(1)));
    assert_eq!(value("-N << 1"), Some(Const::Int(-6)));
    assert_eq!(value("F * 3"), Some(Const::Float(1.5)));
    assert_eq!(value("float(N) / 2"), Some(Const::Float(1.5)));
    assert_eq!(value("N > 2 ? 10 : 20"), Some(Const::Int(10)));
    assert_eq!(value("int(2.9) + N"), Some(Const::Int(5)));
    assert_eq!(value("max(N, 7)"), Some(Const::Int(7)));
    assert_eq!(value("radians(180.0)"), Some(Const::Float(std::f32::consts::PI)));
    assert_eq!(value("1 / 0"), None);
    assert_eq!(value("vec2(1.0)"), None, "only scalars");
}

#[test]
fn literals_keep_their_digits() {
    let shader = clean(&in_main("float th = 6.28125 * p.x;"), Stage::Vertex);
    let id = find(&shader, "6.28125");
    assert_eq!(shader.expr(id).kind, ExprKind::Literal(crate::ast::Literal::Float(6.28125)));
    assert_eq!(shader.fold(id), Some(Const::Float(6.28125)));
}

#[test]
fn calls_know_what_they_call() {
    let shader = clean(PHONG, Stage::Fragment);
    let id = find(&shader, "shade(lights[i], n, base.rgb, specular)");
    let Some(CallTarget::User(f)) = shader.callee(id) else { panic!() };
    assert_eq!(shader.function_info(*f).name.name, "shade");
    assert!(matches!(shader.callee(find(&shader, "dot(n, h)")), Some(CallTarget::Builtin(_))));
    assert!(matches!(shader.callee(find(&shader, "vec4(sum, base.a)")), Some(CallTarget::Constructor(_))));
}

#[test]
fn constructors_are_counted() {
    let shader = parse(&in_main("vec4 q = vec3(p.x, p.yz, 2.0, 1.0);"), Stage::Vertex).shader;
    let c = shader.constructor(find(&shader, "vec3(p.x, p.yz, 2.0, 1.0)")).unwrap();
    assert_eq!((c.needs, c.given.as_slice()), (3, [Some(1), Some(2), Some(1), Some(1)].as_slice()));
    assert_eq!((c.fit, c.ty.to_string().as_str()), (Fit::TooMany { first_extra: 2 }, "vec3"));
    assert_eq!(shader.constructor(find(&shader, "p.x")), None);
}

#[test]
fn own_functions_come_before_built_in_ones() {
    let source = "#version 150\nfloat mix(float a) { return a; }\nfloat f() { return mix(1.0) + mix(1.0, 2.0, 0.5); }";
    let shader = clean(source, Stage::Library);
    assert!(matches!(shader.callee(find(&shader, "mix(1.0)")), Some(CallTarget::User(_))));
    assert!(matches!(shader.callee(find(&shader, "mix(1.0, 2.0, 0.5)")), Some(CallTarget::Builtin(_))));
}

#[test]
fn late_keywords_are_names_in_old_versions() {
    clean(
        "#version 150\nvec4 f(sampler2D buffer) { vec4 sample = texture(buffer, vec2(0)); return sample; }",
        Stage::Library,
    );
    let new = errors("#version 430\nvoid f() { float sample = 1.0; }", Stage::Library);
    assert_eq!(new, ["E001 2:18 `sample` is a keyword and cannot be a name"].map(str::to_owned), "{new:?}");
}

#[test]
fn statements_are_kept_with_their_spans() {
    let shader = clean(GRAMMAR, Stage::Fragment);
    let main = shader.function_syntax(shader.function("main").unwrap()).unwrap();
    let body = main.body.as_ref().unwrap();
    let find = |wanted: fn(&StmtKind) -> bool| body.statements.iter().find(|s| wanted(&s.kind)).unwrap();
    assert_eq!(text(&shader, find(|k| matches!(k, StmtKind::For { .. })).span), "for (;;) { break; }");
    assert_eq!(text(&shader, find(|k| matches!(k, StmtKind::DoWhile { .. })).span), "do { m -= 1; } while (m > 0);");
    let StmtKind::Switch { body, .. } = &find(|k| matches!(k, StmtKind::Switch { .. })).kind else { panic!() };
    assert_eq!(body.statements.iter().filter(|s| matches!(s.kind, StmtKind::Case(_))).count(), 2);
    assert!(shader.unit().items.iter().any(|i| matches!(i.kind, ItemKind::Precision(_))));
    assert!(shader.unit().items.iter().all(|i| !matches!(i.kind, ItemKind::Error)));
}

#[test]
fn tokens_are_those_of_the_text() {
    let source =
        "#version 150\n#define OUT gl_Position // 出力\n#if 0\nx gl_Position\n#endif\nvoid main() { OUT = vec4(1); }";
    let shader = clean(source, Stage::Vertex);
    let places: Vec<_> = shader
        .tokens()
        .iter()
        .filter(|t| text(&shader, t.span) == "gl_Position")
        .map(|t| (t.place, shader.file().position(t.span.start).to_string()))
        .collect();
    assert_eq!(places, [(TokenPlace::Directive, "2:13".to_owned()), (TokenPlace::Inactive, "4:3".to_owned())]);
    assert_eq!(shader.comments().len(), 1);
    let joined: String = shader.tokens().iter().map(|t| text(&shader, t.span)).collect();
    let squeezed: String = source.replace("// 出力", "").split_whitespace().collect();
    assert_eq!(joined, squeezed);
}

#[test]
fn names_from_macros_have_the_span_of_the_invocation() {
    let source = "#version 150\n#define OUT gl_Position\n#define SET(x) OUT = x\nvoid main() { SET(vec4(1.0)); }";
    let shader = clean(source, Stage::Vertex);
    let position = shader.builtin("gl_Position").unwrap();
    let uses: Vec<_> = shader.uses_of(position).map(|u| (text(&shader, u.span), u.from_macro)).collect();
    assert_eq!(uses, [("SET(vec4(1.0))", true)]);
}

#[test]
fn array_forms_agree() {
    for declaration in ["float[2] a[3]", "float a[3][2]", "float[3][2] a"] {
        let shader = clean(&format!("#version 430\n{declaration};"), Stage::Library);
        assert_eq!(shader.interface().globals[0].ty.to_string(), "float[3][2]", "{declaration}");
    }
}

#[test]
fn an_array_of_arrays_of_structures_is_made_of_its_elements() {
    let text = "#version 450\nstruct S { float a; };\nfloat f(float x) {\n    S[2][3] v = S[2][3](S[3](S(x), S(x), S(x)), S[3](S(x), S(x), S(x)));\n    \
                S[2][2] w = S[][2](S[2](S(x), S(x)), S[2](S(x), S(x)));\n    return v[1][2].a + w[0][1].a;\n}\n";
    let file = SourceFile::new("a.glsl", text);
    let parsed = Shader::parse(&file, Stage::Library);
    assert!(parsed.diagnostics.is_empty(), "{:?}", parsed.diagnostics);
}
