//! D004: an output is written on some paths only.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};
use syntax::Stage;

use super::variable::part;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D004"),
    name: "output-written-on-some-paths",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "an output is written on some paths to the end of `main` and not on others",
    page: Page {
        what: "Reports outputs of fragment shaders, and built-in outputs of other stages, that are written in one \
               branch, and on another path to the end of `main` not at all. Other outputs are left to D018. Paths that end in `discard` do not count. Neither does the missing last branch of an `else if` chain, \
               of a comparison with a constant or of a `switch`, nor a loop without a round: these may name all cases.",
        why: "On the other path the output is undefined: it may keep the value of the primitive before, or change \
              from frame to frame.",
        bad: &[Example {
            name: "mask.frag",
            text: "#version 150 core\nin vec2 tc;\nout vec4 color;\nvoid main(void)\n{\n  if (tc.x > 0.5) color = vec4(1.0);\n}\n",
        }],
        good: &[Example {
            name: "mask.frag",
            text: "#version 150 core\nin vec2 tc;\nout vec4 color;\nvoid main(void)\n{\n  color = vec4(0.0);\n  \
                   if (tc.x > 0.5) color = vec4(1.0);\n}\n",
        }],
        fix: "No fix: write a value before the branch, or add the other branch.",
        references: &[
            "GLSL 4.60 specification, section 7.1.5 \"Fragment Shader Special Variables\": gl_FragDepth must be \
             written on all paths",
            "GLSL 1.50 specification, section 4.3.6 \"Outputs\"",
        ],
        ja: Japanese {
            summary: "出力変数に、書き込まれる経路と書き込まれない経路があります",
            what: "ある分岐では書き込まれ、`main` の終わりに至る別の経路では書き込まれない、フラグメントシェーダの出力変数と他のステージの組み込み出力変数を報告します。その他の出力変数は D018 が扱います。`discard` で終わる経路は数えません。`else if` の列や定数との比較や `switch` の書かれていない最後の場合と、1 回も回らないループも、すべての場合を挙げているかもしれないので数えません。",
            why: "書き込まれない経路では出力が未定義です。前のプリミティブの値が残ったり、フレームごとに変わったりします。",
            fix: "修正はありません。分岐の前で値を書き込むか、もう一方の分岐を加えてください。",
        },
    },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    tell(file, findings, |name| file.shader.stage() == Stage::Fragment || name.starts_with("gl_"));
}

/// Reports the outputs of those names that are written on some paths only.
pub(super) fn tell(file: &ShaderFile, findings: &mut Findings<'_>, wanted: impl Fn(&str) -> bool) {
    let shader = &file.shader;
    if shader.stage() == Stage::Geometry {
        return;
    }
    for output in file.flow().outputs.iter().filter(|o| wanted(&shader.symbol(o.symbol).name)) {
        let missing = output.written & !output.surely;
        let (true, Some(write)) = (missing != 0, output.write) else { continue };
        let name = part(shader, output.symbol, missing);
        findings.push(
            findings
                .at(
                    &file.file,
                    write,
                    message!(
                        "output `{name}` is not written on every path",
                        "出力変数 `{name}` に書き込まれない経路があります"
                    ),
                )
                .with_label(message!("written here", "ここで書き込まれる"))
                .with_why(message!(
                    "a path to the end of `main` passes no write, and the output is undefined there",
                    "`main` の終わりまで書き込みのない経路があり、その場合の出力は未定義です"
                ))
                .with_help(message!(
                    "write `{name}` before the branch, or in the other branch too",
                    "分岐の前か、もう一方の分岐でも `{name}` に書き込んでください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn told(body: &str) -> Vec<String> {
        let text = format!(
            "#version 150 core\nin vec4 q;\nuniform int n;\nuniform bool b;\nout vec4 c;\nvoid main(void)\n{{\n  {body}\n}}\n"
        );
        messages("D004", "a.frag", &text)
    }

    #[test]
    fn a_path_without_a_write_is_told() {
        for body in [
            "if (b) c = q;",
            "if (b) return; c = q;",
            "if (n > 1) c = q; else if (n > 0) { } else c = -q;",
            "c.xyz = q.xyz; if (b) c.w = 1.0;",
        ] {
            assert_eq!(told(body).len(), 1, "{body}");
        }
        assert_eq!(told("c.xyz = q.xyz; if (b) c.w = 1.0;"), ["output `c.w` is not written on every path"]);
        assert_eq!(told("c = q; if (b) gl_FragDepth = 0.5;"), ["output `gl_FragDepth` is not written on every path"]);
    }

    #[test]
    fn paths_that_write_or_end_are_not() {
        for body in [
            "if (b) c = q; else c = -q;",
            "if (b) discard; c = q;",
            "if (b) { c = q; return; } c = -q;",
            "if (n == 0) c = q; else if (n == 1) c = -q;",
            "switch (n) { case 0: c = q; break; }",
            "for (int i = 0; i < n; ++i) c = q;",
            "for (int i = 0; i < 4; ++i) c[i] = q[i];",
            "c = q; if (b) c = -q;",
            "c.xyz = q.xyz;",
            "if (true) c = q;",
            "",
        ] {
            assert_eq!(told(body), [""; 0], "{body}");
        }
    }
}
