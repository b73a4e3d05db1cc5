//! D007: a uniform or an input that nothing uses.

use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Stage;

use super::unused_variable::hidden_words;
use crate::rule::{Check, Findings, Level, Pages, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D007"),
    name: "unused-uniform",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
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
    let inputs = interface.inputs.iter().filter(|v| !v.name.starts_with("gl_"));
    for variable in interface.uniforms.iter().chain(inputs) {
        let used = shader.uses_of(variable.symbol).any(|u| match (u.function, reached) {
            (Some(function), Some(reached)) => reached.contains(&function),
            _ => true,
        });
        let (span, name) = (variable.name_span, &variable.name);
        if used || hidden.contains(name.as_str()) || file.file.slice(span) != name {
            continue;
        }
        let uniform = variable.storage != syntax::interface::Storage::In;
        let vertex = shader.stage() == Stage::Vertex;
        let (en, ja) = match (uniform, vertex) {
            (true, _) => ("uniform", "uniform"),
            (false, true) => ("attribute", "頂点属性"),
            (false, false) => ("input", "入力"),
        };
        findings.push(
            findings
                .at(&file.file, span, message!("{en} `{name}` is not used", "{ja} `{name}` は使われていません"))
                .with_label(message!("never used", "未使用"))
                .with_why(if uniform || vertex {
                    message!(
                        "the linker drops it, and a look-up of its location gives -1",
                        "リンク時に取り除かれ、location を問い合わせると -1 になります"
                    )
                } else {
                    message!("what the stage before writes is lost here", "前のステージが書いた値はここで失われます")
                })
                .with_help(message!("use `{name}`, or remove it", "`{name}` を使うか、削除してください")),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn inactive_names_are_reported() {
        let reported = |outer: &str, body: &str| {
            let text = format!(
                "#version 150 core\nin vec4 p;\n{outer}\nvoid main(void)\n{{\n  gl_Position = p;\n  {body}\n}}\n"
            );
            messages("D007", "a.vert", &text)
        };
        assert_eq!(reported("uniform mat4 m;", ""), ["uniform `m` is not used"]);
        assert_eq!(reported("in vec3 n;", ""), ["attribute `n` is not used"]);
        assert_eq!(reported("uniform mat4 m; vec4 f() { return m * p; }", ""), ["uniform `m` is not used"]);
        for (outer, body) in [
            ("uniform mat4 m;", "gl_Position = m * p;"),
            ("uniform mat4 m; vec4 f() { return m * p; }", "gl_Position = f();"),
            ("uniform B { mat4 m; };", ""),
            ("uniform mat4 m;\n#ifdef A\nmat4 a = m;\n#endif", ""),
            ("uniform float k; float g = k;", "gl_Position = p * g;"),
        ] {
            assert_eq!(reported(outer, body), [""; 0], "{outer} {body}");
        }
    }

    #[test]
    fn inputs_of_later_stages_count_too() {
        let text =
            "#version 150 core\nin vec2 t;\nin vec3 n;\nout vec4 c;\nvoid main() { c = vec4(n, gl_FragCoord.x); }\n";
        assert_eq!(messages("D007", "a.frag", text), ["input `t` is not used"]);
    }
}
