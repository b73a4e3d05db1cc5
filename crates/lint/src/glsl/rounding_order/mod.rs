//! N042: an error-free transformation that nothing keeps from being regrouped.

use std::collections::{BTreeMap, BTreeSet};

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Message, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{Declaration, ItemKind, StmtKind, TypeKind};
use syntax::precision::Precisions;
use syntax::symbols::{FunctionId, SymbolId};
use syntax::vanishing::Vanishing;

use super::walk::statements;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N042"),
    name: "rounding-order",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let all = shader.vanishing();
    if all.is_empty() {
        return;
    }
    let precisions = Precisions::of(shader);
    let mut functions: BTreeMap<FunctionId, Vec<Vanishing>> = BTreeMap::new();
    for one in all.into_iter().filter(|one| !precisions.is_precise(one.sum)) {
        functions.entry(one.function).or_default().push(one);
    }
    let has_precise = shader.wgsl().is_none() && shader.offered_words().iter().any(|word| word == "precise");
    for (function, sums) in functions {
        let Some(first) = sums.first() else { continue };
        let (text, name) = (shader.text_of(first.sum), &shader.function_info(function).name.name);
        let mut found = findings
            .at(
                &file.file,
                shader.expr(first.sum).span,
                message!(
                    "`{name}` relies on the order of roundings: `{text}` is 0 in real numbers",
                    "`{name}` は丸めの順序に頼っています: `{text}` は実数では 0 です"
                ),
            )
            .with_label(message!("the error of a rounding in binary32", "binary32 では丸め誤差"))
            .with_why(message!(
                "a device may regroup sums and products that are not `precise`, and then nothing of it is left: pairs of \
                 numbers carry 24 bits instead of 48",
                "`precise` でない和や積は装置が組み替えることがあり、そのとき何も残りません。2 数の組の精度は 48 ビットから 24 ビットに落ちます"
            ))
            .with_help(help(shader, has_precise));
        for other in sums.iter().skip(1).take(3) {
            let span = shader.expr(other.sum).span;
            found = found.with_related(&file.file, span, message!("0 in real numbers as well", "これも実数では 0"));
        }
        let edits = if has_precise { edits(shader, &sums) } else { None };
        if let Some(edits) = edits {
            let title = message!("declare it `precise`", "`precise` で宣言する");
            found = found.with_fix(title, Safety::Safe, edits);
        }
        findings.push(found);
    }
}

fn help(shader: &Shader, has_precise: bool) -> Message {
    if shader.wgsl().is_some() {
        return message!(
            "WGSL has no `precise`: multiply the sums by a uniform that is 1, which no compiler can know, or compute in integers",
            "WGSL には `precise` がありません。コンパイラの知らない 1 の uniform を和に掛けるか、整数で計算してください"
        );
    }
    if has_precise {
        return message!(
            "declare `precise` what takes the value, here and in the functions that use it",
            "値を受け取る変数を、使う側の関数でも `precise` で宣言してください"
        );
    }
    message!(
        "`precise` came with GLSL 4.00, GLSL ES 3.20 and the extensions `GL_ARB_gpu_shader5` and `GL_EXT_gpu_shader5`; without \
         it, multiply the sums by a uniform that is 1, which no compiler can know",
        "`precise` は GLSL 4.00、GLSL ES 3.20、拡張 `GL_ARB_gpu_shader5` と `GL_EXT_gpu_shader5` からです。使えないときは、コンパイラの知らない 1 の uniform を和に掛けてください"
    )
}

/// Edits that declare `precise` what takes these sums; none where one of them goes elsewhere.
fn edits(shader: &Shader, sums: &[Vanishing]) -> Option<Vec<Edit>> {
    let plain = sums.iter().all(|one| !shader.expr(one.sum).from_macro);
    let targets: Option<BTreeSet<SymbolId>> = sums.iter().map(|one| one.goes_to).collect();
    let mut places = BTreeSet::new();
    for target in targets.filter(|_| plain)? {
        places.insert(declared(shader, shader.symbol(target).span?)?);
    }
    Some(places.into_iter().map(|at| Edit::insert(at, "precise ".to_owned())).collect())
}

/// Where the declaration of a local variable or a parameter begins, which is called so at `name`.
fn declared(shader: &Shader, name: Span) -> Option<usize> {
    let mut found = None;
    statements(shader, |statement| {
        let declaration = match &statement.kind {
            StmtKind::Declaration(declaration) => declaration,
            StmtKind::For { init, .. } => match &init.kind {
                StmtKind::Declaration(declaration) => declaration,
                _ => return,
            },
            _ => return,
        };
        if declaration.declarators.iter().any(|one| one.name.span == name) && is_plain(shader, declaration) {
            found = Some(declaration.span.start);
        }
    });
    let params = shader.unit().items.iter().filter_map(|item| match &item.kind {
        ItemKind::Function(function) => Some(&function.params),
        _ => None,
    });
    let param = params.flatten().find(|param| param.name.as_ref().is_some_and(|own| own.span == name));
    found.or_else(|| param.map(|param| param.span.start))
}

/// True where the type stands in the text as it is: in no macro.
fn is_plain(shader: &Shader, declaration: &Declaration) -> bool {
    match &declaration.ty.kind {
        TypeKind::Named(name) => shader.file().slice(declaration.ty.name_span) == name,
        TypeKind::Struct(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use crate::glsl::testing::{found, messages};

    fn count(text: &str) -> usize {
        messages("N042", "a.glsl", text).len()
    }

    fn function(body: &str) -> usize {
        count(&format!(
            "#version 450\nuniform float one;\nfloat g(float x) {{ return x; }}\nvec2 f(float a, float b, vec2 p, vec2 q) {{ {body} }}\n"
        ))
    }

    #[test]
    fn error_free_transformations_are_found() {
        let all = [
            "float s = a + b; float bb = s - a; float e = (a - (s - bb)) + (b - bb); return vec2(s, e);",
            "float s = a + b; float e = b - (s - a); return vec2(s, e);",
            "float s = b + a; return vec2(s, (a - s) + b);",
            "float t = 4097.0 * a; float h = t - (t - a); float l = a - h; return vec2(h, l);",
            "float p0 = a * b; float e = fma(a, b, -p0); return vec2(p0, e);",
            "vec2 s; s.x = p.x + q.x; float t = s.x - p.x; s.y = (p.x - (s.x - t)) + (q.x - t); return s;",
            "vec2 s = vec2(p.x + q.x, 0.0); float t = s.x - p.x; s.y = q.x - t; return s;",
            "float s = 0.0, c = 0.0; for (int i = 0; i < 8; i++) { float y = a - c; float t = s + y; c = (t - s) - y; s = t; } \
             return vec2(s);",
            "vec2 s = p + q; vec2 e = q - (s - p); return e;",
        ];
        for body in all {
            assert_eq!(function(body), 1, "{body}");
        }
    }

    #[test]
    fn precise_keeps_them_and_other_sums_are_none() {
        let all = [
            "precise float s = a + b; precise float e = b - (s - a); return vec2(s, e);",
            "float s = a + b; precise float e = b - (s - a); return vec2(s, e);",
            "float s = a + b * one; float e = b - (s - a); return vec2(s, e);",
            "float s = a + b; s = g(s); float e = b - (s - a); return vec2(s, e);",
            "float s = a + b; if (a > b) s = a; float e = b - (s - a); return vec2(s, e);",
            "float s = a; for (int i = 0; i < 4; i++) { float e = s - a; s += b + e; } return vec2(s);",
            "float c = a; float d = c - a; return vec2(c, d);",
            "float c = a + b; float d = c; float e = abs(c - d); return vec2(d, e);",
            "vec2 d = p - q; return q + d * 0.5;",
            "float s = p.x + q.x; return vec2(q.y - (s - p.x));",
        ];
        for body in all {
            assert_eq!(function(body), 0, "{body}");
        }
    }

    #[test]
    fn the_fix_declares_what_takes_the_value_and_needs_the_keyword() {
        let body = "vec2 f(float a, float b) { float s = a + b; float e = b - (s - a); return vec2(s, e); }\n";
        let fixed = |head: &str| {
            let text = format!("{head}\n{body}");
            let all = found("N042", "a.frag", &text);
            all[0]
                .fix
                .clone()
                .map(|fix| fix.edits.into_iter().collect::<base::text::EditList>().apply(&text).unwrap().text)
        };
        let after = fixed("#version 400").unwrap();
        assert!(after.contains("precise float e = b") && after.contains("{ float s"), "{after}");
        assert_eq!(count(&after), 0);
        assert_eq!(fixed("#version 330"), None);
        assert!(fixed("#version 330\n#extension GL_ARB_gpu_shader5 : enable").is_some());
        assert_eq!(fixed("#version 310 es\nprecision highp float;"), None);
        assert!(fixed("#version 320 es\nprecision highp float;").is_some());
    }

    #[test]
    fn wgsl_is_told_without_a_fix() {
        let text = "fn f(a: f32, b: f32) -> vec2f { let s = a + b; let e = b - (s - a); return vec2f(s, e); }\n";
        let all = found("N042", "a.wgsl", text);
        assert_eq!((all.len(), all[0].fix.is_none()), (1, true));
        let plain = "fn f(a: f32, b: f32) -> f32 { let s = a + b; return s - a * b; }\n";
        assert_eq!(messages("N042", "a.wgsl", plain).len(), 0);
    }
}
