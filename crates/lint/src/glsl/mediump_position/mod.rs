//! N045: a position that has 11 bits: that of a vertex, or numbers of pixels that one stage hands on to the next.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::{Project, ShaderFile};
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::interface::Storage;
use syntax::precision::{Precisions, is_lower};
use syntax::symbols::SymbolKind;
use syntax::types::Type;
use syntax::{Shader, Stage};

use super::pixel_stages;
use super::walk::expressions;
use analysis::forms::Forms;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N045"),
    name: "mediump-position",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::ShaderWith(check),
};

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !shader.has_precisions() {
        return;
    }
    let precisions = Precisions::of(shader);
    match shader.stage() {
        Stage::Vertex => vertex(file, &precisions, findings),
        Stage::Fragment => fragment(file, project, &precisions, findings),
        _ => {}
    }
}

fn vertex(file: &ShaderFile, precisions: &Precisions, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let forms = Forms::new(shader);
    let found = shader.arena().iter().find_map(|(_, expr)| {
        let ExprKind::Assign { op: None, target, value, .. } = &expr.kind else { return None };
        let position = matches!(&shader.expr(*target).kind, ExprKind::Name(name) if name == "gl_Position");
        (position && transforms(shader, precisions, forms.value(*value))).then_some(expr.span)
    });
    let Some(span) = found else { return };
    findings.push(
        findings
            .at(
                &file.file,
                span,
                message!(
                    "`gl_Position` is computed at `mediump`: 11 bits place a vertex to whole pixels of a screen of 2048",
                    "`gl_Position` を `mediump` で計算しています。11 ビットでは、2048 画素の画面で頂点の位置が 1 画素単位になります"
                ),
            )
            .with_label(message!("a product with a matrix at `mediump`", "`mediump` での行列との積"))
            .with_why(message!(
                "floats of a vertex stage are `highp` unless the text lowers them: vertices of phones jitter and miss each other",
                "頂点ステージの float は、精度を下げなければ `highp` です。下げると、携帯端末では頂点が震え、隙間が生じます"
            ))
            .with_help(message!(
                "leave `precision` out of the vertex stage, or declare the matrix and the position `highp`",
                "頂点ステージから `precision` を除くか、行列と位置を `highp` で宣言してください"
            )),
    );
}

/// True for a product with a matrix that may be computed with less than binary32.
fn transforms(shader: &Shader, precisions: &Precisions, value: ExprId) -> bool {
    let is_matrix = |id: ExprId| matches!(shader.type_of(id), Type::Matrix(..));
    expressions(shader, value).into_iter().any(|id| match shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Mul, left, right, .. } => {
            precisions.is_lowered(id) && (is_matrix(left) || is_matrix(right))
        }
        _ => false,
    })
}

fn fragment(file: &ShaderFile, project: &Project, precisions: &Precisions, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let before = pixel_stages::before(file, project);
    for (id, symbol) in shader.symbols() {
        let taken = matches!(symbol.kind, SymbolKind::Global(Storage::In)) && shader.uses_of(id).next().is_some();
        let counts = before.get(&symbol.name) == Some(&(1, false));
        let Some(span) = symbol.span.filter(|_| taken && counts && precisions.of_symbol(id).is_some_and(is_lower))
        else {
            continue;
        };
        let name = &symbol.name;
        findings.push(
            findings
                .at(
                    &file.file,
                    span,
                    message!(
                        "`{name}` counts pixels at `mediump`, which beyond 1024 has no fraction, and beyond 2048 no odd number",
                        "`{name}` は `mediump` の画素数です。1024 を超えると小数部がなく、2048 を超えると奇数がありません"
                    ),
                )
                .with_label(message!("the vertex stage hands pixels on", "頂点ステージが画素単位で渡しています"))
                .with_why(message!(
                    "GLSL ES promises 11 bits of `mediump`: edges on the right of a large screen become steps",
                    "GLSL ES が `mediump` に保証するのは 11 ビットです。大きな画面の右側では縁が階段状になります"
                ))
                .with_help(message!(
                    "declare it `highp`, or hand on a share of the size",
                    "`highp` で宣言するか、大きさに対する割合を渡してください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::glsl::testing::messages;

    fn vertex(precision: &str, position: &str) -> usize {
        let text = format!(
            "precision {precision} float;\nattribute vec4 p;\nuniform mat4 m;\nuniform highp mat4 h;\n\
             void main() {{ {position} }}\n"
        );
        messages("N045", "a.vert", &text).len()
    }

    #[test]
    fn a_vertex_at_mediump_is_found() {
        assert_eq!(vertex("mediump", "gl_Position = m * p;"), 1);
        assert_eq!(vertex("mediump", "vec4 at = m * p; gl_Position = at;"), 1);
        assert_eq!(vertex("highp", "gl_Position = m * p;"), 0);
        assert_eq!(vertex("mediump", "gl_Position = h * p;"), 0, "the product is of the higher precision");
        assert_eq!(vertex("mediump", "gl_Position = p;"), 0, "a corner of the screen");
    }

    #[test]
    fn pixels_that_are_handed_on_at_mediump_are_found() {
        let both = |p: &str, of: &str| {
            format!(
                "#type vertex\nattribute vec2 vertex;\nuniform vec2 viewSize;\nvarying vec2 fpos;\n\
                 void main() {{ fpos = vertex{of}; gl_Position = vec4(2.0 * vertex / viewSize - 1.0, 0.0, 1.0); }}\n\
                 #type fragment\nprecision {p} float;\nvarying vec2 fpos;\n\
                 void main() {{ gl_FragColor = vec4(fpos, 0.0, 1.0); }}\n"
            )
        };
        assert_eq!(messages("N045", "a.glsl", &both("mediump", "")).len(), 1);
        assert_eq!(messages("N045", "a.glsl", &both("highp", "")).len(), 0);
        assert_eq!(messages("N045", "a.glsl", &both("mediump", " / viewSize")).len(), 0);
    }
}
