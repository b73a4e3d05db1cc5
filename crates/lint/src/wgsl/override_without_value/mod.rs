//! W006: a pipeline constant without a value.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::wgsl::{DeclarationKind, Module};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W006"),
    name: "override-without-value",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Wgsl(check),
};

fn check(file: &ShaderFile, module: &Module, findings: &mut Findings<'_>) {
    for (variable, symbol) in module.globals() {
        let open = variable.kind == DeclarationKind::Override && variable.value.is_none();
        // What stands in for a placeholder has the value that the template engine gives it.
        let own = !file.file.is_assembled() || file.file.copied(variable.name.span).is_some();
        if !open || !own || file.shader.uses_of(symbol).next().is_none() {
            continue;
        }
        let name = &variable.name.name;
        findings.push(
            findings
                .at(&file.file, variable.name.span, message!("`{name}` has no value", "`{name}` に値がありません"))
                .with_label(message!("the pipeline must state it", "パイプラインで指定が必要"))
                .with_why(message!(
                    "a pipeline that does not state it is refused",
                    "これを指定しないパイプラインは拒否されます"
                ))
                .with_help(message!("write a value behind `=`", "`=` の後に値を書いてください")),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::count;

    #[test]
    fn a_value_or_no_use_is_enough() {
        let of = |line: &str| count("W006", &format!("{line}\n@compute @workgroup_size(1) fn main() {{ _ = n; }}\n"));
        assert_eq!(of("override n: u32;"), 1);
        assert_eq!(of("@id(3) override n: u32 = 4;"), 0);
        assert_eq!(of("const n = 4; override unused: f32;"), 0);
    }
}
