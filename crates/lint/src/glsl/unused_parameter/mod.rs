//! D016: a parameter that its function does not use.

use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;

use super::unused_variable::hidden_words;
use crate::rule::{Check, Findings, Level, Pages, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D016"),
    name: "unused-parameter",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !file.is_sound() {
        return;
    }
    let hidden = hidden_words(file);
    for (_, function) in shader.functions().filter(|(_, f)| f.definition.is_some()) {
        for param in &function.params {
            let (Some(symbol), Some(name)) = (param.symbol, &param.name) else { continue };
            let (span, name, function) = (name.span, &name.name, &function.name.name);
            let foreign = hidden.contains(name.as_str()) || file.file.slice(span) != name;
            // What is only out and never written is told by D009.
            let out = param.direction == syntax::symbols::Direction::Out;
            if foreign || out || shader.uses_of(symbol).next().is_some() {
                continue;
            }
            findings.push(
                findings
                    .at(
                        &file.file,
                        span,
                        message!(
                            "`{function}` does not use its parameter `{name}`",
                            "`{function}` は引数 `{name}` を使っていません"
                        ),
                    )
                    .with_label(message!("never used", "未使用"))
                    .with_why(message!(
                        "another variable may be meant in the body",
                        "本体で別の変数と取り違えているかもしれません"
                    ))
                    .with_help(message!("use it, or leave out its name", "使うか、名前を省いてください")),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn parameters_that_are_not_used_are_reported() {
        let reported = |function: &str| messages("D016", "a.glsl", &format!("#version 150 core\n{function}\n")).len();
        assert_eq!(reported("float f(float a, float b) { return a; }"), 1);
        assert_eq!(reported("float f(float a, float b) { return b * a; }"), 0);
        assert_eq!(reported("float f(float, float b) { return b; }"), 0);
        assert_eq!(reported("float f(float a);"), 0);
        assert_eq!(reported("void f(inout float a) { a = 1.0; }"), 0);
    }
}
