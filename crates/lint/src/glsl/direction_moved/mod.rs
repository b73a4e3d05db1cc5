//! N028: a direction that a matrix moves, because its `w` is 1.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};
use syntax::types::Type;
use syntax::words::words;

use analysis::forms::{Forms, builtin, constructed, product};
use analysis::names::{self, has_word};
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N028"),
    name: "direction-moved",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// The name of the direction that an expression is: the name itself, or what is turned, scaled or normalised.
fn direction(shader: &Shader, id: ExprId) -> Option<&str> {
    let id = bare(shader, id);
    if let Some(name) = names::of(shader, id) {
        let says = names::is_normal(name)
            || has_word(name, &["tangent", "bitangent", "binormal", "direction"])
            || words(name).iter().any(|w| w == "dir");
        let place = has_word(name, &["position", "pos", "vertex", "vert", "point", "coord", "light"]);
        // The direction of a light is one.
        let lamp = words(name).iter().any(|w| w == "dir" || w.starts_with("direction"));
        return (says && (!place || lamp) && !has_word(name, &["pos"])).then_some(name);
    }
    match shader.expr(id).kind {
        ExprKind::Unary { op: UnaryOp::Minus, op_span: _, operand } => direction(shader, operand),
        ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } => {
            let matrix = matches!(shader.type_of(left), Type::Matrix(..));
            direction(shader, right).or_else(|| direction(shader, left).filter(|_| !matrix))
        }
        _ => match builtin(shader, id, &["normalize"])? {
            (_, [inner]) => direction(shader, *inner),
            _ => None,
        },
    }
}

/// The vector of which an expression takes components.
fn whole(shader: &Shader, id: ExprId) -> ExprId {
    match shader.expr(bare(shader, id)).kind {
        ExprKind::Field { base, field: _ } => base,
        _ => id,
    }
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut forms = None;
    for (id, _) in shader.arena().iter() {
        let Some((matrix, vector)) = product(shader, id).filter(|_| bare(shader, id) == id) else { continue };
        let Some([three, w]) = constructed(shader, vector, &Type::VEC4) else { continue };
        let Some(name) = direction(shader, *three).filter(|_| constant(shader, *w) == Some(1.0)) else { continue };
        // Rotations and transposed inverses move nothing, and what becomes a position is drawn as one.
        let text = shader.text_of(matrix).to_lowercase();
        let inverse = words(shader.text_of(matrix)).iter().any(|word| word == "it");
        let still = inverse || ["rot", "norm", "transpose"].iter().any(|word| text.contains(word));
        if *shader.type_of(*three) != Type::VEC3 || still {
            continue;
        }
        let forms = forms.get_or_insert_with(|| Forms::new(shader));
        let drawn = forms.around(id).any(|p| match shader.expr(p).kind {
            ExprKind::Assign { op: _, op_span: _, target, value: _ } => shader.text_of(target).contains("gl_Position"),
            _ => false,
        });
        // A point beside another, along a direction: its difference to the other is the direction.
        let summed = matches!(
            shader.expr(forms.value(*three)).kind,
            ExprKind::Binary { op: BinaryOp::Add, op_span: _, left: _, right: _ }
        );
        // What a matrix moved before is a point, whatever its name is.
        let moved = product(shader, forms.value(whole(shader, *three)))
            .and_then(|(_, vector)| constructed(shader, vector, &Type::VEC4))
            .is_some_and(|parts| parts.last().is_some_and(|w| constant(shader, *w) == Some(1.0)));
        if drawn || summed || moved {
            continue;
        }
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(vector).span,
                    message!(
                        "`{name}` is a direction by its name, but has `w = 1`",
                        "`{name}` は名前によれば方向ですが、`w = 1` になっています"
                    ),
                )
                .with_label(message!("is moved as a point", "点として平行移動されます"))
                .with_why(message!(
                    "a matrix moves what has `w = 1` and only turns and scales what has `w = 0`",
                    "行列による平行移動は `w = 1` のものだけに働き、`w = 0` のものは回転と拡大縮小だけを受けます"
                ))
                .with_help(message!("use 0.0 for directions", "方向には 0.0 を使ってください")),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;
    use super::*;

    fn count(body: &str) -> usize {
        let text = format!(
            "#version 330 core\nin vec3 place;\nin vec3 aNormal;\nuniform vec3 lightDir;\nuniform vec3 lightPos;\n\
             uniform mat4 model;\nuniform mat4 rotation;\nuniform mat3 turn;\nout vec3 n;\nvoid main()\n{{\n  \
             gl_Position = model * vec4(place, 1.0);\n  {body}\n}}\n"
        );
        messages(RULE.code.0, "a.vert", &text).len()
    }

    #[test]
    fn directions_with_w_of_one_are_reported() {
        for body in [
            "n = (model * vec4(aNormal, 1.0)).xyz;",
            "n = vec3(model * vec4(turn * aNormal, 1.0));",
            "n = vec3(model * vec4(normalize(-lightDir), 1));",
            "n = vec3(model * vec4(2.0 * aNormal, 1.0));",
            "vec3 dir = lightPos - place; n = vec3(model * vec4(dir, 1.0));",
        ] {
            assert_eq!(count(body), 1, "{body}");
        }
    }

    #[test]
    fn others_are_not() {
        for body in [
            "n = (model * vec4(aNormal, 0.0)).xyz;",
            "n = (model * vec4(place, 1.0)).xyz;",
            "n = (model * vec4(lightPos, 1.0)).xyz;",
            "n = (rotation * vec4(aNormal, 1.0)).xyz;",
            "mat4 worldIT = model; n = (worldIT * vec4(aNormal, 1.0)).xyz;",
            "n = (transpose(inverse(model)) * vec4(aNormal, 1.0)).xyz;",
            "n = (model * vec4(place + aNormal, 1.0)).xyz;",
            "gl_Position = model * vec4(aNormal, 1.0);",
            "vec4 dir = rotation * vec4(place, 1.0); n = (model * vec4(dir.xyz, 1.0)).xyz;",
            "vec3 normalEnd = place + aNormal; n = (model * vec4(normalEnd, 1.0)).xyz - (model * vec4(place, 1.0)).xyz;",
        ] {
            assert_eq!(count(body), 0, "{body}");
        }
    }
}
