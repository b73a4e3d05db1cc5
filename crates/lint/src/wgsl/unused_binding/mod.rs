//! W005: a resource that nothing uses.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::wgsl::Module;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W005"),
    name: "unused-binding",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Wgsl(check),
};

fn check(file: &ShaderFile, module: &Module, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if module.composed || module.entry_points.is_empty() || !file.is_sound() {
        return;
    }
    for (variable, symbol) in module.globals() {
        let bound = Module::attribute(&variable.attributes, "binding").is_some();
        if !bound || shader.uses_of(symbol).next().is_some() {
            continue;
        }
        let name = &variable.name.name;
        findings.push(
            findings
                .at(&file.file, variable.name.span, message!("`{name}` is not used", "`{name}` は使われていません"))
                .with_label(message!("bound and never used", "束縛されるだけ"))
                .with_why(message!(
                    "a layout that is derived from the shader does not have it",
                    "シェーダから導かれる配置に含まれません"
                ))
                .with_help(message!("use `{name}`, or remove it", "`{name}` を使うか、削除してください")),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::count;

    #[test]
    fn uses_of_any_kind_count() {
        let of = |body: &str| {
            count(
                "W005",
                &format!(
                    "@group(0) @binding(0) var<storage, read_write> a: array<u32>;\n@compute @workgroup_size(1) fn main() {{ {body} }}\n"
                ),
            )
        };
        assert_eq!(of(""), 1);
        assert_eq!(of("a[0] = 1;"), 0);
        assert_eq!(of("_ = arrayLength(&a);"), 0);
        assert_eq!(of("let p = &a[1]; *p = 2;"), 0);
    }
}
