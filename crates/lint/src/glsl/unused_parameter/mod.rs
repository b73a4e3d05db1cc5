//! D016: a parameter that its function does not use.

use crate::project::ShaderFile;
use base::diagnostic::{Code, Severity, message};

use super::unused_variable::hidden_words;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D016"),
    name: "unused-parameter",
    severity: Severity::Info,
    level: Level::Strict,
    summary: "a parameter is not used in its function",
    page: Page {
        what: "Reports named parameters that the body of their function neither reads nor writes. A parameter \
            without a name says that it is not used, and is not reported.",
        why: "Another variable may be meant, often a global one of a similar name. Many a parameter is kept \
            on purpose, so that functions can be exchanged.",
        bad: &[Example {
            name: "f.frag",
            text: "#version 150 core\nin float x;\nout vec4 color;\nfloat twice(float \
            a, float b) { return a * 2.0; }\nvoid main(void)\n{\n  color = vec4(twice(x, 1.0));\n}\n",
        }],
        good: &[Example {
            name: "f.frag",
            text: "#version 150 core\nin float x;\nout vec4 color;\nfloat twice(float \
            a, float) { return a * 2.0; }\nvoid main(void)\n{\n  color = vec4(twice(x, 1.0));\n}\n",
        }],
        fix: "No fix: removing a parameter changes every call.",
        references: &["GLSL 4.60 specification, section 6.1 \"Function Definitions\""],
        ja: Japanese {
            summary: "関数の中で引数が使われていません",
            what: "関数の本体で読み書きされない、名前のある引数を報告します。名前のない引数は使わないことを示しているので報告しません。",
            why: "よく似た名前の大域変数など、別の変数と取り違えているかもしれません。関数を差し替えられるように、わざと残してある引数もあります。",
            fix: "修正はありません。引数を削除すると、すべての呼び出しを変える必要があります。",
        },
    },
    check: Check::Shader(check),
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
    fn parameters_that_are_not_used_are_told() {
        let told = |function: &str| messages("D016", "a.glsl", &format!("#version 150 core\n{function}\n")).len();
        assert_eq!(told("float f(float a, float b) { return a; }"), 1);
        assert_eq!(told("float f(float a, float b) { return b * a; }"), 0);
        assert_eq!(told("float f(float, float b) { return b; }"), 0);
        assert_eq!(told("float f(float a);"), 0);
        assert_eq!(told("void f(inout float a) { a = 1.0; }"), 0);
    }
}
