//! D005: some components of an output are never written.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::flow;
use base::diagnostic::{Code, Diagnostic, Severity, message};
use reading::ShaderFile;
use syntax::Stage;
use syntax::types::Type;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D005"),
    name: "partial-output-write",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for output in &file.flow().outputs {
        let symbol = shader.symbol(output.symbol);
        let missing = output.full & !output.written;
        let matters = shader.stage() == Stage::Fragment || symbol.name == "gl_Position";
        let (true, Type::Vector(..), Some(write)) = (matters && missing != 0, &symbol.ty, output.write) else {
            continue;
        };
        let name = &symbol.name;
        let letters = flow::letters(&symbol.ty, missing).unwrap_or_default();
        let found = findings
            .at(
                &file.file,
                write,
                message!("`{name}.{letters}` is never written", "`{name}.{letters}` に書き込みがありません"),
            )
            .with_label(message!("only a part is written", "一部だけの書き込み"))
            .with_why(message!("a component that is not written is undefined", "書き込まれない成分の値は未定義です"))
            .with_help(message!("write all components of `{name}`", "`{name}` の全成分に書き込んでください"));
        // A frame buffer without blending does without alpha.
        let alpha = shader.stage() == Stage::Fragment && letters == "w";
        findings.push(if alpha { Diagnostic { severity: Severity::Info, ..found } } else { found });
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn missing_components_are_named() {
        let reported = |name: &str, body: &str| {
            let text = format!("#version 150 core\nout vec4 c;\nvoid main(void)\n{{\n  {body}\n}}\n");
            messages("D005", name, &text)
        };
        assert_eq!(reported("a.frag", "c.rgb = vec3(1.0);"), ["`c.w` is never written"]);
        assert_eq!(reported("a.vert", "c = vec4(1.0); gl_Position.xy = c.xy;"), ["`gl_Position.zw` is never written"]);
        for (name, body) in [
            ("a.frag", "c.rgb = vec3(1.0); c.a = 1.0;"),
            ("a.frag", "for (int i = 0; i < 4; ++i) c[i] = 1.0;"),
            ("a.frag", "discard;"),
            ("a.vert", "c.xyz = vec3(1.0); gl_Position = vec4(1.0);"),
        ] {
            assert_eq!(reported(name, body), [""; 0], "{body}");
        }
    }
}
