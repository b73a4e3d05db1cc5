//! W003: a private variable that nothing writes.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::wgsl::Module;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W003"),
    name: "private-variable-never-set",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Wgsl(check),
};

fn check(file: &ShaderFile, module: &Module, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    // What is not in this text may write it.
    if module.composed || module.entry_points.is_empty() || !file.is_sound() {
        return;
    }
    for (variable, symbol) in module.globals() {
        let private = variable.space.first().is_some_and(|s| s.name == "private");
        let mut uses = shader.uses_of(symbol).peekable();
        if !private || variable.value.is_some() || uses.peek().is_none() || uses.any(|u| u.access.writes()) {
            continue;
        }
        let name = &variable.name.name;
        findings.push(
            findings
                .at(
                    &file.file,
                    variable.name.span,
                    message!(
                        "`{name}` is read, and never written",
                        "`{name}` は読まれますが、どこでも書かれていません"
                    ),
                )
                .with_label(message!("always 0", "常に 0"))
                .with_why(message!(
                    "a private variable without initialiser begins as 0 in each invocation",
                    "初期化子のないプライベート変数は、各インベケーションで 0 から始まります"
                ))
                .with_help(message!(
                    "write it in the entry point, or declare a `const`",
                    "エントリポイントで書き込むか、`const` で宣言してください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::count;

    #[test]
    fn what_nothing_writes_is_reported() {
        let of = |before: &str, body: &str| {
            count(
                "W003",
                &format!(
                    "{before}\nfn set(p: ptr<private, u32>) {{ *p = 1; }}\n@compute @workgroup_size(1) fn main() {{ {body} }}\n"
                ),
            )
        };
        assert_eq!(of("var<private> a: u32;", "_ = a + 1;"), 1);
        assert_eq!(of("var<private> a: u32;", "a = 2; _ = a;"), 0);
        assert_eq!(of("var<private> a: u32;", "set(&a); _ = a;"), 0);
        assert_eq!(of("var<private> a: u32;", "let p = &a; *p = 1; _ = a;"), 0);
        assert_eq!(of("var<private> a = 3u;", "_ = a;"), 0);
        assert_eq!(of("#import b\nvar<private> a: u32;", "_ = a;"), 0);
    }
}
