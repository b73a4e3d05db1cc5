//! G004: a geometry stage emits nothing.

use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;

use super::output_never_written::stores;
use crate::rule::{Check, Findings, Level, Pages, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G004"),
    name: "no-emit-vertex",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let Some(main) = file.shader.function("main") else { return };
    if file.flow().emits != Some(false) || stores(file) {
        return;
    }
    findings.push(
        findings
            .at(
                &file.file,
                main.name.span,
                message!("this geometry shader emits no vertex", "このジオメトリシェーダは頂点を出力しません"),
            )
            .with_label(message!("no `EmitVertex` is reached from here", "ここから `EmitVertex` に到達しない"))
            .with_why(message!(
                "only what is emitted is drawn: the primitive that comes in ends here",
                "描画されるのは出力した頂点だけです。入力されたプリミティブはここで終わります"
            ))
            .with_help(message!(
                "call `EmitVertex()` when the outputs of a vertex are written",
                "頂点の出力変数に書き込んだら `EmitVertex()` を呼んでください"
            )),
    );
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn a_call_that_is_reached_is_enough() {
        let reported = |before: &str, body: &str| {
            let text = format!(
                "#version 430 core\nlayout (points) in;\nlayout (points, max_vertices = 1) out;\n{before}\nvoid main(void)\n{{\n  gl_Position = vec4(0.0);\n  {body}\n}}\n"
            );
            messages("G004", "a.geom", &text).len()
        };
        assert_eq!(reported("", ""), 1);
        assert_eq!(reported("void f() { EmitVertex(); }", ""), 1);
        assert_eq!(reported("void f() { EmitVertex(); }", "f();"), 0);
        assert_eq!(reported("uniform bool b;", "if (b) EmitVertex();"), 0);
        assert_eq!(reported("buffer B { int n; };", "n = 1;"), 0);
    }
}
