//! G001: a geometry stage emits more vertices than it declares.

use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::Stage;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::emission;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G001"),
    name: "max-vertices-too-small",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    // A wrong type somewhere does not change how often a vertex is emitted.
    if shader.stage() != Stage::Geometry || !file.is_plain() {
        return;
    }
    let layouts = &shader.interface().stage_layouts;
    let mut entries = layouts.iter().filter_map(|l| l.qualifiers.layout_entry("max_vertices"));
    let (Some(entry), None) = (entries.next(), entries.next()) else { return };
    let Some(declared) = shader.interface().geometry.max_vertices else { return };
    let emitted = emission::least(shader);
    let value = declared.value;
    if emitted <= u64::from(value) {
        return;
    }
    let wanted = emission::most(shader).unwrap_or(emitted).max(emitted);
    let mut found = findings
        .at(
            &file.file,
            declared.span,
            message!(
                "{value} vertices are declared, at least {emitted} are emitted",
                "{value} 頂点が宣言されていますが、少なくとも {emitted} 頂点が出力されます"
            ),
        )
        .with_label(message!("too few", "足りない"))
        .with_why(message!(
            "what is emitted beyond the declared number is undefined, and is usually dropped",
            "宣言した数を超える出力は未定義で、多くの場合は捨てられます"
        ))
        .with_help(message!("declare `max_vertices = {wanted}`", "`max_vertices = {wanted}` と宣言してください"));
    if let Some(value) = entry.value.map(|v| shader.expr(v)).filter(|v| !v.from_macro) {
        let edit = Edit::replace(value.span, wanted.to_string());
        found = found.with_fix(message!("declare {wanted}", "{wanted} と宣言する"), Safety::Unsafe, vec![edit]);
    }
    findings.push(found);
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(before: &str, body: &str) -> Vec<String> {
        let text = format!(
            "#version 150 core\nlayout (points) in;\nlayout (points, max_vertices = 3) out;\nuniform int n;\n{before}\nvoid main(void)\n{{\n  gl_Position = gl_in[0].gl_Position;\n  {body}\n}}\n"
        );
        messages("G001", "a.geom", &text)
    }

    #[test]
    fn more_than_declared_is_reported() {
        let message = |n: u32| vec![format!("3 vertices are declared, at least {n} are emitted")];
        assert_eq!(reported("", "for (int i = 0; i < 4; ++i) EmitVertex();"), message(4));
        assert_eq!(reported("void two() { EmitVertex(); EmitVertex(); }", "two(); two(); two();"), message(6));
        assert_eq!(
            reported(
                "",
                "for (int i = 0; i < 4; ++i) { if (i == n) EmitVertex(); else { EmitVertex(); EmitVertex(); } }"
            ),
            message(4)
        );
        let twice = "for (int i = 0; i < 6; ++i) { EmitVertex(); i++; EmitVertex(); }";
        assert_eq!(reported("", twice), message(6), "three rounds of two");
        let either = "for (int i = 0; i < 8; ++i) { if (i == n) { i++; EmitVertex(); } else { EmitVertex(); i++; } }";
        assert_eq!(reported("", either), message(4), "both ways go on by two");
        assert_eq!(
            reported(
                "",
                "for (int i = 0; i < gl_in.length(); ++i) { EmitVertex(); EmitVertex(); EmitVertex(); EmitVertex(); }"
            ),
            message(4)
        );
    }

    #[test]
    fn what_fits_or_is_not_certain_is_not() {
        for body in [
            "for (int i = 0; i < 3; ++i) EmitVertex();",
            "for (int i = 0; i < 4; ++i) if (i != n) EmitVertex();",
            "for (int i = 0; i < 4; ++i) { if (i == n) break; EmitVertex(); }",
            "for (int i = 0; i < n; ++i) EmitVertex();",
            "for (int i = 0; i < 6; ++i) { EmitVertex(); i++; }",
            "for (int i = 0; i < 6; ++i) { if (i == n) i++; EmitVertex(); }",
            "if (n > 3) return; for (int i = 0; i < 4; ++i) EmitVertex();",
            "if (n > 3) { EmitVertex(); EmitVertex(); } if (n <= 3) { EmitVertex(); EmitVertex(); }",
        ] {
            assert_eq!(reported("", body), [""; 0], "{body}");
        }
    }
}
