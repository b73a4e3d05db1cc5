//! H005: a name that the shaders do not use.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use hosts::cpp::lookup::LookupKind;
use reading::Project;
use reading::ShaderFile;
use reading::program::Program;
use reading::program::resolve;
use syntax::interface::Variable;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H005"),
    name: "inactive-name",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for lookup in host.lookups().iter().filter(|l| !l.is_reserved() && l.kind != LookupKind::BindAttribute) {
        let Some(program) = resolve(host, project, &lookup.source).filter(Program::is_complete) else { continue };
        let name = lookup.base_name();
        let declared: Vec<(&ShaderFile, &Variable)> = match lookup.kind {
            LookupKind::Uniform => {
                program.shaders().iter().filter_map(|s| s.shader.interface().uniform(name).map(|v| (*s, v))).collect()
            }
            LookupKind::Attribute | LookupKind::BindAttribute => program.attribute(name).into_iter().collect(),
            LookupKind::Name => program.uniform(name).or_else(|| program.attribute(name)).into_iter().collect(),
        };
        let used = declared.iter().any(|(s, v)| s.shader.uses_of(v.symbol).next().is_some());
        let Some((shader, variable)) = declared.first().filter(|_| !used) else { continue };
        findings.push(
            findings
                .at(
                    &host.file,
                    lookup.literal_span(),
                    message!(
                        "`{name}` is declared, but no stage uses it",
                        "`{name}` は宣言されていますが、どのステージでも使われません"
                    ),
                )
                .with_label(lookup.missing.label())
                .with_related(&shader.file, variable.name_span, message!("declared here", "ここで宣言されています"))
                .with_why(message!(
                    "a variable that is not used is not active and has no location; this raises no GL error",
                    "使われない変数は有効でなく、位置がありません。GL エラーにもなりません"
                ))
                .with_help(message!(
                    "use `{name}` in a shader, or remove the look-up",
                    "シェーダで `{name}` を使うか、この問い合わせを消してください"
                )),
        );
    }
}
