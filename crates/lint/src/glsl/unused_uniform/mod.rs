//! D007: a uniform or vertex attribute that nothing uses.

use crate::project::ShaderFile;
use base::diagnostic::{Code, Severity, message};
use syntax::Stage;

use super::unused_variable::hidden_words;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D007"),
    name: "unused-uniform",
    severity: Severity::Info,
    level: Level::Strict,
    summary: "a uniform or vertex attribute is declared and not used",
    page: Page {
        what: "Reports uniforms outside blocks, and inputs of vertex shaders, that no function reached from `main` \
            uses. Members of blocks keep their place in the buffer, and are not reported.",
        why: "The linker drops it: `glGetUniformLocation` and `glGetAttribLocation` give -1 for its name, and what \
            the host sets goes nowhere. Declarations shared by several shaders have the same effect, and do no \
            harm.",
        bad: &[Example {
            name: "light.vert",
            text: "#version 150 core\nin vec4 position;\nuniform mat4 mc;\nuniform \
            mat4 mg;\nvoid main(void)\n{\n  gl_Position = mc * position;\n}\n",
        }],
        good: &[Example {
            name: "light.vert",
            text: "#version 150 core\nin vec4 position;\nuniform mat4 mc;\n\
            uniform mat4 mg;\nvoid main(void)\n{\n  gl_Position = mc * (mg * position);\n}\n",
        }],
        fix: "No fix: what is unused may be what should be used.",
        references: &["OpenGL 3.2 core specification, section 2.11.4 \"Uniform Variables\": active uniforms"],
        ja: Japanese {
            summary: "使われない uniform または頂点属性が宣言されています",
            what: "`main` から呼ばれるどの関数も使わない、ブロックの外の uniform と頂点属性を報告します。ブロックのメンバはバッファの中で場所を占めるので報告しません。",
            why: "リンク時に取り除かれるため、その名前に対して `glGetUniformLocation` や `glGetAttribLocation` は -1 を返し、ホストが設定した値は使われません。複数のシェーダで共有する宣言なら害はありません。",
            fix: "修正はありません。使われていないものが、使うべきものかもしれません。",
        },
    },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !file.is_sound() || shader.stage() == Stage::Library {
        return;
    }
    let hidden = hidden_words(file);
    let flow = file.flow();
    let reached = &flow.reached;
    let interface = shader.interface();
    let attributes: &[_] = if shader.stage() == Stage::Vertex { &interface.inputs } else { &[] };
    for variable in interface.uniforms.iter().chain(attributes) {
        let used = shader.uses_of(variable.symbol).any(|u| match (u.function, reached) {
            (Some(function), Some(reached)) => reached.contains(&function),
            _ => true,
        });
        let (span, name) = (variable.name_span, &variable.name);
        if used || hidden.contains(name.as_str()) || file.file.slice(span) != name {
            continue;
        }
        let uniform = variable.storage != syntax::interface::Storage::In;
        let (en, ja) = if uniform { ("uniform", "uniform") } else { ("attribute", "頂点属性") };
        findings.push(
            findings
                .at(&file.file, span, message!("{en} `{name}` is not used", "{ja} `{name}` は使われていません"))
                .with_label(message!("never used", "未使用"))
                .with_why(message!(
                    "the linker drops it, and a look-up of its location gives -1",
                    "リンク時に取り除かれ、location を問い合わせると -1 になります"
                ))
                .with_help(message!("use `{name}`, or remove it", "`{name}` を使うか、削除してください")),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn inactive_names_are_told() {
        let told = |outer: &str, body: &str| {
            let text = format!(
                "#version 150 core\nin vec4 p;\n{outer}\nvoid main(void)\n{{\n  gl_Position = p;\n  {body}\n}}\n"
            );
            messages("D007", "a.vert", &text)
        };
        assert_eq!(told("uniform mat4 m;", ""), ["uniform `m` is not used"]);
        assert_eq!(told("in vec3 n;", ""), ["attribute `n` is not used"]);
        assert_eq!(told("uniform mat4 m; vec4 f() { return m * p; }", ""), ["uniform `m` is not used"]);
        for (outer, body) in [
            ("uniform mat4 m;", "gl_Position = m * p;"),
            ("uniform mat4 m; vec4 f() { return m * p; }", "gl_Position = f();"),
            ("uniform B { mat4 m; };", ""),
            ("uniform mat4 m;\n#ifdef A\nmat4 a = m;\n#endif", ""),
            ("uniform float k; float g = k;", "gl_Position = p * g;"),
        ] {
            assert_eq!(told(outer, body), [""; 0], "{outer} {body}");
        }
    }
}
