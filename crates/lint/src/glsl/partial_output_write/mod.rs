//! D005: some components of an output are never written.

use crate::flow;
use crate::project::ShaderFile;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Severity, message};
use syntax::Stage;
use syntax::types::Type;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D005"),
    name: "partial-output-write",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "only some components of a position or a colour are written",
    page: Page {
        what: "Reports `gl_Position` and outputs of fragment shaders of which some components are written and others \
               nowhere. Other outputs are left alone, because the next stage may use only what is written.",
        why: "The rest is undefined. A position is divided by its fourth component; blending and the frame buffer \
              use the alpha of a colour. Where only alpha is missing, this is told as information: a frame buffer \
              without blending does without it.",
        bad: &[Example {
            name: "flat.vert",
            text: "#version 150 core\nin vec2 position;\nvoid main(void)\n{\n  gl_Position.xy = position;\n}\n",
        }],
        good: &[Example {
            name: "flat.vert",
            text: "#version 150 core\nin vec2 position;\nvoid main(void)\n{\n  gl_Position = vec4(position, 0.0, 1.0);\n}\n",
        }],
        fix: "No fix: the missing value is not known.",
        references: &[
            "GLSL 1.50 specification, sections 7.1 \"Vertex Shader Special Variables\" and 4.3.6 \"Outputs\"",
        ],
        ja: Japanese {
            summary: "位置や色の一部の成分だけが書き込まれています",
            what: "`gl_Position` とフラグメントシェーダの出力のうち、一部の成分だけが書き込まれ、残りはどこでも書き込まれないものを報告します。その他の出力は、次のステージが書き込まれた成分だけを使うかもしれないので報告しません。",
            why: "残りの成分は未定義です。位置は第 4 成分で割られ、色のアルファ値はブレンディングやフレームバッファで使われます。アルファ値だけがない場合は、ブレンディングなしなら支障がないので情報として報告します。",
            fix: "修正はありません。欠けている値は分かりません。",
        },
    },
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
        let told = |name: &str, body: &str| {
            let text = format!("#version 150 core\nout vec4 c;\nvoid main(void)\n{{\n  {body}\n}}\n");
            messages("D005", name, &text)
        };
        assert_eq!(told("a.frag", "c.rgb = vec3(1.0);"), ["`c.w` is never written"]);
        assert_eq!(told("a.vert", "c = vec4(1.0); gl_Position.xy = c.xy;"), ["`gl_Position.zw` is never written"]);
        for (name, body) in [
            ("a.frag", "c.rgb = vec3(1.0); c.a = 1.0;"),
            ("a.frag", "for (int i = 0; i < 4; ++i) c[i] = 1.0;"),
            ("a.frag", "discard;"),
            ("a.vert", "c.xyz = vec3(1.0); gl_Position = vec4(1.0);"),
        ] {
            assert_eq!(told(name, body), [""; 0], "{body}");
        }
    }
}
