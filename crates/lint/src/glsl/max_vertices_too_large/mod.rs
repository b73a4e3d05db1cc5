//! G002: more vertices declared than a geometry stage can emit.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::Stage;

use analysis::emission;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G002"),
    name: "max-vertices-too-large",
    severity: Severity::Info,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if shader.stage() != Stage::Geometry || !file.is_sound() {
        return;
    }
    let layouts = &shader.interface().stage_layouts;
    let mut entries = layouts.iter().filter_map(|l| l.qualifiers.layout_entry("max_vertices"));
    let (Some(entry), None) = (entries.next(), entries.next()) else { return };
    let Some(declared) = shader.interface().geometry.max_vertices else { return };
    let Some(emitted) = emission::most(shader) else { return };
    // A stage that emits nothing has another fault.
    if emitted == 0 || emitted >= u64::from(declared.value) {
        return;
    }
    let (are, value) = (if emitted == 1 { "is" } else { "are" }, declared.value);
    let mut found = findings
        .at(
            &file.file,
            declared.span,
            message!(
                "{value} vertices are declared, at most {emitted} {are} emitted",
                "{value} 頂点が宣言されていますが、出力されるのは最大 {emitted} 頂点です"
            ),
        )
        .with_label(message!("{emitted} would do", "{emitted} で足りる"))
        .with_why(message!(
            "output space is set aside by the declared number, so that fewer primitives are worked on at a time",
            "出力領域は宣言した数だけ確保されるため、同時に処理できるプリミティブが減ります"
        ))
        .with_help(message!("declare `max_vertices = {emitted}`", "`max_vertices = {emitted}` と宣言してください"));
    if let Some(value) = entry.value.map(|v| shader.expr(v)).filter(|v| !v.from_macro) {
        let edit = Edit::replace(value.span, emitted.to_string());
        found = found.with_fix(message!("declare {emitted}", "{emitted} と宣言する"), Safety::Unsafe, vec![edit]);
    }
    findings.push(found);
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    /// The message for a geometry stage with 20 declared vertices and this body.
    fn lint(before: &str, body: &str) -> Option<String> {
        let text = format!(
            "#version 150 core\nlayout (points) in;\nlayout (points, max_vertices = 20) out;\nuniform int n;\n{before}\nvoid main(void)\n{{\n  gl_Position = gl_in[0].gl_Position;\n  {body}\n}}\n"
        );
        messages("G002", "a.geom", &text).into_iter().next()
    }

    fn reported(n: u32) -> Option<String> {
        let are = if n == 1 { "is" } else { "are" };
        Some(format!("20 vertices are declared, at most {n} {are} emitted"))
    }

    #[test]
    fn counts_what_can_be_emitted() {
        assert_eq!(lint("", "EmitVertex();"), reported(1));
        assert_eq!(lint("const int division = 4;", "for (int i = 0; i <= division; ++i) EmitVertex();"), reported(5));
        assert_eq!(lint("", "for (int i = 6; i > 0; i -= 2) { EmitVertex(); EmitVertex(); }"), reported(6));
        assert_eq!(lint("", "if (n > 0) { EmitVertex(); EmitVertex(); } else EmitVertex();"), reported(2));
        assert_eq!(lint("void two() { EmitVertex(); EmitVertex(); }", "two(); two();"), reported(4));
        assert_eq!(
            lint(
                "",
                "for (int i = 0; i < 3; ++i) { for (int j = 0; j < 3; j++) { if (j == n) break; EmitVertex(); } }"
            ),
            reported(9)
        );
    }

    #[test]
    fn is_silent_when_the_number_is_not_known_or_fits() {
        for body in [
            "for (int i = 0; i < n; ++i) EmitVertex();",
            "while (true) { EmitVertex(); break; }",
            "for (int i = 0; i < 4; ++i) { EmitVertex(); --i; }",
            "for (int i = 0; i < 20; ++i) EmitVertex();",
            "for (int i = 0; i < 30; ++i) EmitVertex();",
            "for (int i = 0; i != 4; ++i) EmitVertex();",
            "EndPrimitive();",
        ] {
            assert_eq!(lint("", body), None, "{body}");
        }
    }
}
