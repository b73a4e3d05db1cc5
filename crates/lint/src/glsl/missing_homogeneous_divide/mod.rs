//! N019: homogeneous coordinates used without care for `w`.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::{CallTarget, SymbolId, SymbolKind};
use syntax::types::Type;

use super::walk::{declarators, expressions};
use analysis::forms::product;
use analysis::names::has_word;
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N019"),
    name: "missing-homogeneous-divide",
    severity: Severity::Info,
    level: Level::Heuristic,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    undivided(file, findings);
    wrong_w(file, findings);
}

fn undivided(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut projected: Vec<(SymbolId, ExprId)> = Vec::new();
    declarators(shader, |d| {
        let Some((matrix, _)) = d.initializer.as_ref().and_then(|i| product(shader, i.value)) else { return };
        let projects = expressions(shader, matrix).into_iter().any(|e| match &shader.expr(e).kind {
            ExprKind::Name(name) => has_word(name, &["proj", "mvp", "clip"]),
            ExprKind::Field { base: _, field } => has_word(&field.name, &["proj", "mvp", "clip"]),
            _ => false,
        });
        let inverse = expressions(shader, matrix).into_iter().any(|e| shader.text_of(e).to_lowercase().contains("inv"));
        let symbol = shader.symbols().find(|(_, s)| s.span == Some(d.name.span) && s.kind == SymbolKind::Local);
        if let (Some((symbol, info)), true) = (symbol, projects && !inverse)
            && info.ty == Type::VEC4
        {
            projected.push((symbol, matrix));
        }
    });
    for (symbol, _) in projected {
        let mut fields = Vec::new();
        for (id, expr) in shader.arena().iter() {
            if let ExprKind::Field { base, field } = &expr.kind
                && shader.symbol_of(bare(shader, *base)) == Some(symbol)
            {
                fields.push((id, field));
            }
        }
        let uses = shader.uses_of(symbol).count();
        let has_w = fields.iter().any(|(_, f)| f.name.contains(['w', 'q', 'a']));
        let Some((first, _)) = fields.first().filter(|_| uses == fields.len() && !has_w) else { continue };
        let name = &shader.symbol(symbol).name;
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(*first).span,
                    message!(
                        "`{name}` is projected, but never divided by its `w`",
                        "`{name}` は射影されていますが、`w` で割られていません"
                    ),
                )
                .with_label(message!("not yet a place", "まだ位置ではありません"))
                .with_why(message!(
                    "behind a perspective projection, components are to be divided by `w`",
                    "透視射影の後では、成分を `w` で割る必要があります"
                ))
                .with_help(message!("divide by `{name}.w`", "`{name}.w` で割ってください")),
        );
    }
}

fn wrong_w(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for (id, _) in shader.arena().iter() {
        let Some((_, vector)) = product(shader, id).filter(|_| bare(shader, id) == id) else { continue };
        let vector = bare(shader, vector);
        let (ExprKind::Call { callee: _, args }, Some(CallTarget::Constructor(Type::Vector(_, 4)))) =
            (&shader.expr(vector).kind, shader.callee(vector))
        else {
            continue;
        };
        let [three, w] = args.as_slice() else { continue };
        let name = match &shader.expr(bare(shader, *three)).kind {
            ExprKind::Name(name) => name,
            ExprKind::Field { base: _, field } if field.name.len() > 4 => &field.name,
            _ => continue,
        };
        if constant(shader, *w) != Some(0.0) || !has_word(name, &["position", "pos", "vertex", "vert"]) {
            continue;
        }
        let message = message!(
            "`{name}` looks like a position, but has `w = 0`",
            "`{name}` は位置のようですが、`w = 0` になっています"
        );
        findings.push(
            findings
                .at(&file.file, shader.expr(vector).span, message)
                .with_label(message!("`w` does not fit", "`w` が合っていません"))
                .with_why(message!(
                    "a matrix moves what has `w = 1` and only turns and scales what has `w = 0`",
                    "行列による平行移動は `w = 1` のものだけに働き、`w = 0` のものは回転と拡大縮小だけを受けます"
                ))
                .with_help(message!("use 1.0 for positions", "位置には 1.0 を使ってください")),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{lint, shader};
    use super::*;

    fn count(body: &str) -> usize {
        let before = "uniform mat4 projection;\nuniform mat4 model;\nin vec3 normal;\nin vec3 position;";
        let text = shader(before, body);
        assert!(lint("N019", Level::Strict, &text).is_empty());
        lint("N019", Level::Heuristic, &text).len()
    }

    #[test]
    fn undivided_and_mismatched_coordinates_are_reported() {
        assert_eq!(count("vec4 c = projection * vec4(p, 1.0); v = c.xyz;"), 1);
        assert_eq!(count("vec4 c = projection * model * vec4(p, 1.0); v.xy = c.xy;"), 1);
        assert_eq!(count("v = (model * vec4(position, 0.0)).xyz;"), 1);
    }

    #[test]
    fn others_are_not() {
        for body in [
            "vec4 c = projection * vec4(p, 1.0); v = c.xyz / c.w;",
            "vec4 c = projection * vec4(p, 1.0); color = c; v.x = c.x;",
            "vec4 c = model * vec4(p, 1.0); v = c.xyz;",
            "vec4 c = inverse(projection) * vec4(p, 1.0); v = c.xyz;",
            "v = (model * vec4(normal, 0.0)).xyz;",
            "v = (model * vec4(position, 1.0)).xyz;",
            "v = (model * vec4(p, 0.0)).xyz;",
        ] {
            assert_eq!(count(body), 0, "{body}");
        }
    }
}
