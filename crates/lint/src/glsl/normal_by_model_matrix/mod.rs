//! N020: a normal that the model matrix transforms.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{ExprId, ExprKind};
use syntax::types::{ScalarType, Type};
use syntax::words::words;

use super::walk::expressions;
use analysis::forms::{Forms, builtin, constructed, product};
use analysis::names;
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N020"),
    name: "normal-by-model-matrix",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

/// The upper left part of a matrix of four columns.
const MAT3: Type = Type::Matrix(ScalarType::Float, 3, 3);

/// Words of matrices that scale.
const SCALES: [&str; 8] = ["model", "world", "object", "mv", "mvp", "modelview", "local", "transform"];

/// True when a matrix is made of the model matrix by products alone.
fn scales(shader: &Shader, matrix: ExprId) -> bool {
    let all = expressions(shader, matrix);
    let text = shader.text_of(matrix).to_lowercase();
    let treated = ["norm", "inv", "transpose", "rot", "tbn", "bone", "joint", "skin"].iter().any(|w| text.contains(w));
    let named = |id: &ExprId| match &shader.expr(*id).kind {
        ExprKind::Name(name) => words(name).iter().any(|w| SCALES.iter().any(|s| w.starts_with(s))),
        ExprKind::Field { base: _, field } => words(&field.name).iter().any(|w| SCALES.contains(&w.as_str())),
        _ => false,
    };
    !treated && all.iter().any(named)
}

/// The normal in what a matrix is multiplied with.
fn normal(shader: &Shader, vector: ExprId) -> Option<&str> {
    let vector = bare(shader, vector);
    if let Some(name) = names::of(shader, vector) {
        return Some(name).filter(|n| *shader.type_of(vector) == Type::VEC3 && names::is_normal(n));
    }
    if let Some((_, [inner])) = builtin(shader, vector, &["normalize"]) {
        return normal(shader, *inner);
    }
    match constructed(shader, vector, &Type::VEC4)? {
        [three, w] if constant(shader, *w) == Some(0.0) => normal(shader, *three),
        _ => None,
    }
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut products = shader
        .arena()
        .iter()
        .filter_map(|(id, _)| product(shader, id).filter(|_| bare(shader, id) == id).map(|p| (id, p)))
        .peekable();
    if products.peek().is_none() {
        return;
    }
    let forms = Forms::new(shader);
    for (id, (matrix, vector)) in products {
        let whole = match constructed(shader, forms.value(matrix), &MAT3) {
            Some([whole]) if matches!(shader.type_of(*whole), Type::Matrix(_, 4, 4)) => *whole,
            None if matches!(shader.type_of(matrix), Type::Matrix(_, 4, 4)) => matrix,
            _ => continue,
        };
        let Some(name) = normal(shader, vector).filter(|_| scales(shader, whole)) else { continue };
        let matrix = shader.text_of(whole);
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(id).span,
                    message!(
                        "the normal `{name}` is transformed by `{matrix}`",
                        "法線 `{name}` が `{matrix}` で変換されています"
                    ),
                )
                .with_label(message!("wrong where the matrix scales unevenly", "不均一に拡大する行列では誤りです"))
                .with_why(message!(
                    "a matrix that scales its axes differently turns a normal away from its surface",
                    "軸ごとに倍率が異なる行列は、法線を面に垂直でない向きに変えてしまいます"
                ))
                .with_help(message!(
                    "multiply with the transposed inverse: `transpose(inverse(mat3(m))) * n`, best from the host",
                    "逆行列の転置 `transpose(inverse(mat3(m))) * n` を掛けてください。できればホスト側で計算します"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::strict_count;
    use super::*;

    fn count(body: &str) -> usize {
        let text = format!(
            "#version 330 core\nin vec3 place;\nin vec3 aNormal;\nuniform mat4 model;\nuniform mat4 view;\n\
             uniform mat3 normalMatrix;\nuniform mat4 modelRotation;\nout vec3 n;\nvoid main()\n{{\n  \
             n = {body};\n  gl_Position = view * vec4(place, 1.0);\n}}\n"
        );
        strict_count(RULE.code, "a.vert", &text)
    }

    #[test]
    fn normals_that_follow_the_model_matrix_are_reported() {
        for body in [
            "mat3(model) * aNormal",
            "normalize(mat3(model) * normalize(aNormal))",
            "(model * vec4(aNormal, 0.0)).xyz",
            "mat3(view * model) * aNormal",
            "vec3(view * model * vec4(aNormal, 0.0))",
        ] {
            assert_eq!(count(body), 1, "{body}");
        }
    }

    #[test]
    fn others_are_not() {
        for body in [
            "normalMatrix * aNormal",
            "mat3(transpose(inverse(model))) * aNormal",
            "transpose(inverse(mat3(model))) * aNormal",
            "mat3(view) * aNormal",
            "mat3(modelRotation) * aNormal",
            "mat3(model) * place",
        ] {
            assert_eq!(count(body), 0, "{body}");
        }
    }
}
