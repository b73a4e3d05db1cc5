//! N013: degrees given to a function that takes radians.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{ExprId, ExprKind};

use analysis::numeric::{around, bare, calls, constant, is_literal};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N013"),
    name: "degrees-as-radians",
    severity: Severity::Info,
    level: Level::Heuristic,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Angles that people write in degrees.
const USUAL: [f64; 11] = [30.0, 45.0, 60.0, 90.0, 120.0, 135.0, 150.0, 180.0, 225.0, 270.0, 360.0];

fn in_degrees(shader: &Shader, arg: ExprId) -> bool {
    let arg = bare(shader, arg);
    if let Some(value) = constant(shader, arg) {
        return is_literal(shader, arg) && USUAL.contains(&value.abs());
    }
    let name = match &shader.expr(arg).kind {
        ExprKind::Name(name) => name,
        ExprKind::Field { base: _, field } => &field.name,
        _ => return false,
    };
    let lower = name.to_ascii_lowercase();
    lower.contains("degree") || lower == "deg" || lower.ends_with("_deg") || name.ends_with("Deg")
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for call in calls(shader, &["sin", "cos", "tan"]) {
        let [arg] = call.args else { continue };
        if !in_degrees(shader, *arg) {
            continue;
        }
        let (name, text) = (call.name, shader.text_of(*arg));
        let mut found = findings
            .at(
                &file.file,
                shader.expr(*arg).span,
                message!(
                    "`{text}` looks like degrees, and `{name}` takes radians",
                    "`{text}` は度のようですが、`{name}` の引数はラジアンです"
                ),
            )
            .with_label(message!("degrees?", "度？"))
            .with_why(message!(
                "trigonometric functions take radians: a quarter turn is 1.5707963, not 90",
                "三角関数の引数はラジアンです。四分の一回転は 90 ではなく 1.5707963 です"
            ))
            .with_help(message!("convert with `radians`", "`radians` で変換してください"));
        if let Some(edits) = around(shader, call.id, *arg, "radians(", ")") {
            found = found.with_fix(message!("convert to radians", "ラジアンに変換する"), Safety::Unsafe, edits);
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, lint, macro_has_no_fix, rings, shader, silent};
    use super::*;

    #[test]
    fn degrees_are_reported() {
        rings(
            "N013",
            Level::Heuristic,
            &["r = sin(90.0);", "r = tan(-45.0);", "float angleDeg = s; r = cos(angleDeg);"],
        );
        let text = shader("uniform float rotation_degrees;", "r = cos(rotation_degrees);");
        assert_eq!(lint("N013", Level::Heuristic, &text).len(), 1);
    }

    #[test]
    fn radians_are_not() {
        silent(
            "N013",
            Level::Heuristic,
            &[
                "r = sin(1.5707963);",
                "r = sin(radians(90.0));",
                "r = cos(10.0);",
                "r = sin(90.0 * s);",
                "float degenerate = s; r = sin(degenerate);",
            ],
        );
    }

    #[test]
    fn the_fix_converts() {
        assert_eq!(fixed("N013", "r = sin(90.0);"), "r = sin(radians(90.0));");
        macro_has_no_fix("N013", "(a * sin(90.0))");
    }
}
