//! V006: a global variable gets a value that is not constant.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::ShaderFile;
use syntax::Profile;
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, SymbolKind};
use syntax::types::Type;

use super::walk::expressions;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V006"),
    name: "non-constant-global-init",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    // OpenGL ES 3.00 refuses it; WebGL leaves it to texts of 1.00.
    let version = shader.version();
    let refused = version.profile == Profile::Es && version.number >= 300;
    let level = if refused { Level::Default } else { RULE.level };
    for variable in &shader.interface().globals {
        let Some(value) = variable.initializer else { continue };
        let varies = expressions(shader, value).into_iter().any(|id| {
            let reads = shader.symbol_of(id).is_some_and(|s| {
                matches!(
                    shader.symbol(s).kind,
                    SymbolKind::Global(Storage::In | Storage::Uniform | Storage::Global)
                        | SymbolKind::BlockMember(_)
                        | SymbolKind::BlockInstance(_)
                )
            });
            reads || matches!(shader.callee(id), Some(CallTarget::User(_)))
        });
        if !varies {
            continue;
        }
        let name = &variable.name;
        let expr = shader.expr(value);
        let found = findings
            .at(
                &file.file,
                expr.span,
                message!("the initial value of `{name}` is not constant", "`{name}` の初期値が定数ではありません"),
            )
            .with_label(message!("depends on other variables", "他の変数に依存します"))
            .with_why(message!(
                "GLSL ES forbids it, and some translators drop the value",
                "GLSL ES では禁じられ、変換器によっては値が失われます"
            ))
            .with_help(message!("assign it at the start of `main`", "`main` の先頭で代入してください"));
        let main = shader.function("main").and_then(|f| shader.function_syntax(f)).and_then(|f| f.body.as_ref());
        let plain = !expr.from_macro && !matches!(variable.ty, Type::Array(..)) && variable.siblings == 1;
        findings.push_at(
            level,
            match main.filter(|_| plain) {
                None => found,
                Some(body) => {
                    let text = shader.text_of(value);
                    let end = variable.name_span.end;
                    let edits = vec![
                        Edit::delete(Span::new(end, expr.span.end)),
                        Edit::insert(body.span.start + 1, format!("\n  {name} = {text};")),
                    ];
                    found.with_fix(message!("assign it in `main`", "`main` の中で代入する"), Safety::Safe, edits)
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::glsl::testing::strict_count;

    /// Findings of this rule at the strict level.
    fn count(name: &str, text: &str) -> usize {
        strict_count(super::RULE.code, name, text)
    }

    #[test]
    fn constants_are_silent() {
        let text = |i: &str| {
            format!(
                "#version 150\nuniform float u;\nconst float c = 2.0;\nfloat g = {i};\nvoid main() {{ gl_Position = vec4(g * u); }}\n"
            )
        };
        assert_eq!(count("a.vert", &text("u")), 1);
        assert_eq!(count("a.vert", &text("sin(u) + c")), 1);
        for right in ["c", "sin(c) * 2.0", "1.0"] {
            assert_eq!(count("a.vert", &text(right)), 0, "{right}");
        }
    }
}
