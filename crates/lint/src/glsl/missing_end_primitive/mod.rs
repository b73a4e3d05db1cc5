//! G003: strips of a loop that are never ended.

use analysis::flow::vertices_needed;
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Stage;
use syntax::ast::StmtKind;

use super::walk::statements;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::emission;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G003"),
    name: "missing-end-primitive",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let (shader, flow) = (&file.shader, file.flow());
    let Some(needed) = vertices_needed(shader).filter(|n| *n > 1) else { return };
    if shader.stage() != Stage::Geometry || flow.emits != Some(true) || flow.ends {
        return;
    }
    let mut loops = Vec::new();
    statements(shader, |statement| {
        if let StmtKind::For { init, condition, step, body, head_span } = &statement.kind {
            let rounds = emission::rounds(shader, init, condition.as_ref(), *step, body);
            let each = emission::least_of(shader, body);
            if rounds != Some(1) && each >= u64::from(needed) {
                loops.push((*head_span, each));
            }
        }
    });
    for (span, each) in loops {
        findings.push(
            findings
                .at(
                    &file.file,
                    span,
                    message!(
                        "each round emits {each} vertices, and `EndPrimitive` is never called",
                        "各回で {each} 頂点を出力していますが、`EndPrimitive` がどこにもありません"
                    ),
                )
                .with_label(message!("the strips of the rounds are joined", "各回のストリップがつながる"))
                .with_why(message!(
                    "a strip goes on until `EndPrimitive`, so that the rounds are connected with each other",
                    "ストリップは `EndPrimitive` まで続くため、各回の図形が互いにつながります"
                ))
                .with_help(message!(
                    "call `EndPrimitive()` at the end of each round if the pieces are separate",
                    "別々の図形なら、各回の最後で `EndPrimitive()` を呼んでください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(primitive: &str, body: &str) -> usize {
        let text = format!(
            "#version 150 core\nlayout (points) in;\nlayout ({primitive}, max_vertices = 20) out;\nvoid v() {{ gl_Position = gl_in[0].gl_Position; EmitVertex(); }}\nvoid main(void)\n{{\n  {body}\n}}\n"
        );
        messages("G003", "a.geom", &text).len()
    }

    #[test]
    fn whole_primitives_in_a_loop_are_reported() {
        assert_eq!(reported("line_strip", "for (int i = 0; i < 4; ++i) { v(); v(); }"), 1);
        assert_eq!(reported("triangle_strip", "for (int i = 0; i < 4; ++i) { v(); v(); v(); }"), 1);
    }

    #[test]
    fn one_strip_is_not() {
        for (primitive, body) in [
            ("line_strip", "for (int i = 0; i < 4; ++i) { v(); }"),
            ("line_strip", "for (int i = 0; i < 4; ++i) { v(); v(); EndPrimitive(); }"),
            ("triangle_strip", "for (int i = 0; i < 4; ++i) { v(); v(); }"),
            ("triangle_strip", "for (int i = 0; i < 1; ++i) { v(); v(); v(); }"),
            ("triangle_strip", "v(); v(); v(); v();"),
            ("points", "for (int i = 0; i < 4; ++i) { v(); }"),
        ] {
            assert_eq!(reported(primitive, body), 0, "{body}");
        }
    }
}
