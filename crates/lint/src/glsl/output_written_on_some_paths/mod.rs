//! D004: an output is written on some paths only.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Stage;

use super::variable::part;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D004"),
    name: "output-written-on-some-paths",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    report(file, findings, |name| file.shader.stage() == Stage::Fragment || name.starts_with("gl_"));
}

/// Reports the outputs of those names that are written on some paths only.
pub(super) fn report(file: &ShaderFile, findings: &mut Findings<'_>, wanted: impl Fn(&str) -> bool) {
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

    fn reported(body: &str) -> Vec<String> {
        let text = format!(
            "#version 150 core\nin vec4 q;\nuniform int n;\nuniform bool b;\nout vec4 c;\nvoid main(void)\n{{\n  {body}\n}}\n"
        );
        messages("D004", "a.frag", &text)
    }

    #[test]
    fn a_path_without_a_write_is_reported() {
        for body in [
            "if (b) c = q;",
            "if (b) return; c = q;",
            "if (n > 1) c = q; else if (n > 0) { } else c = -q;",
            "c.xyz = q.xyz; if (b) c.w = 1.0;",
        ] {
            assert_eq!(reported(body).len(), 1, "{body}");
        }
        assert_eq!(reported("c.xyz = q.xyz; if (b) c.w = 1.0;"), ["output `c.w` is not written on every path"]);
        assert_eq!(
            reported("c = q; if (b) gl_FragDepth = 0.5;"),
            ["output `gl_FragDepth` is not written on every path"]
        );
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
            assert_eq!(reported(body), [""; 0], "{body}");
        }
    }
}
