//! D018: a value for the next stage is written on some paths only.

use crate::project::ShaderFile;
use base::diagnostic::{Code, Severity};
use syntax::Stage;

use super::output_written_on_some_paths::tell;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D018"),
    name: "varying-written-on-some-paths",
    severity: Severity::Warning,
    level: Level::Strict,
    summary: "an output for the next stage is written on some paths and not on others",
    page: Page {
        what: "Reports what D004 reports, for the outputs of a shader that another stage reads. The next stage may \
            know by the same condition that the value is not there, and not read it.",
        why: "On the other path the value is undefined, and so is what it is interpolated with.",
        bad: &[Example {
            name: "sky.vert",
            text: "#version 150 core\nin vec4 position;\nuniform bool sky;\nout vec3 \
            ray;\nvoid main(void)\n{\n  if (sky) ray = position.xyz;\n  gl_Position = position;\n}\n",
        }],
        good: &[Example {
            name: "sky.vert",
            text: "#version 150 core\nin vec4 position;\nuniform bool sky;\nout \
            vec3 ray;\nvoid main(void)\n{\n  ray = sky ? position.xyz : vec3(0.0);\n  gl_Position = position;\n\
            }\n",
        }],
        fix: "No fix: write a value before the branch, or add the other branch.",
        references: &["GLSL 1.50 specification, section 4.3.6 \"Outputs\""],
        ja: Japanese {
            summary: "次のステージへの出力に、書き込まれる経路と書き込まれない経路があります",
            what: "D004 と同じことを、別のステージが読む出力変数について報告します。次のステージは、同じ条件から値がないことを知っていて、読まないのかもしれません。",
            why: "書き込まれない経路では値が未定義で、それと補間される値も未定義になります。",
            fix: "修正はありません。分岐の前で値を書き込むか、もう一方の分岐を加えてください。",
        },
    },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    if file.shader.stage() != Stage::Fragment {
        tell(file, findings, |name| !name.starts_with("gl_"));
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn each_output_is_told_by_one_rule() {
        let text = |body: &str| {
            format!("#version 150 core\nin vec4 p;\nuniform bool b;\nout vec3 v;\nvoid main(void)\n{{\n  {body}\n}}\n")
        };
        let told = |body: &str| ["D004", "D018"].map(|code| messages(code, "a.vert", &text(body)).len());
        assert_eq!(told("gl_Position = p; if (b) v = p.xyz;"), [0, 1]);
        assert_eq!(told("if (b) gl_Position = p; v = p.xyz;"), [1, 0]);
        assert_eq!(told("gl_Position = p; if (b) v = p.xyz; else v = -p.xyz;"), [0, 0]);
    }
}
