//! V003: words that the core profile has replaced.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::{Profile, Stage, TokenPlace};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V003"),
    name: "deprecated-in-profile",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

/// Functions and what they are called now.
const RENAMED: &[(&str, &str)] = &[
    ("texture1D", "texture"),
    ("texture2D", "texture"),
    ("texture3D", "texture"),
    ("textureCube", "texture"),
    ("texture1DProj", "textureProj"),
    ("texture2DProj", "textureProj"),
    ("texture3DProj", "textureProj"),
    ("texture1DLod", "textureLod"),
    ("texture2DLod", "textureLod"),
    ("texture3DLod", "textureLod"),
    ("textureCubeLod", "textureLod"),
];

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let version = shader.version();
    if version.number < 150 || version.profile != Profile::Core || !file.is_sound() {
        return;
    }
    let mut tokens = shader.tokens().iter().filter(|t| t.place == TokenPlace::Text).peekable();
    while let Some(token) = tokens.next() {
        let word = file.file.slice(token.span);
        let called = tokens.peek().is_some_and(|next| file.file.slice(next.span) == "(");
        let own = shader.function(word).is_some() || shader.symbols().any(|(_, s)| s.name == word && s.span.is_some());
        let new = match word {
            "attribute" => Some("in"),
            "varying" => match shader.stage() {
                Stage::Vertex => Some("out"),
                Stage::Fragment => Some("in"),
                _ => None,
            },
            "gl_FragColor" | "gl_FragData" => None,
            // GLSL for Vulkan has types of some of these names (GL_KHR_vulkan_glsl).
            _ => match RENAMED.iter().find(|(old, _)| *old == word && called) {
                Some((_, new)) => Some(*new),
                None => continue,
            },
        };
        if own {
            continue;
        }
        let found = findings
            .at(&file.file, token.span, message!("`{word}` is deprecated", "`{word}` は非推奨です"))
            .with_label(message!("an old word", "古い書き方"))
            .with_why(message!(
                "GLSL 1.30 has replaced it, and strict compilers refuse it",
                "GLSL 1.30 で置き換えられ、厳密なコンパイラは受け付けません"
            ));
        findings.push(match new {
            Some(new) => found.with_fix(
                message!("write `{new}`", "`{new}` と書く"),
                Safety::Safe,
                vec![Edit::replace(token.span, new)],
            ),
            None => found
                .with_help(message!("declare an output of your own with `out`", "`out` で出力変数を宣言してください")),
        });
    }
}

#[cfg(test)]
mod tests {
    use crate::glsl::testing::strict_count;

    /// Findings of this rule at the strict level.
    fn count(name: &str, text: &str) -> usize {
        strict_count(super::RULE.code, name, text)
    }

    #[test]
    fn old_words_count_in_new_versions_only() {
        let text = |v: &str| {
            format!(
                "#version {v}\nuniform sampler2D s;\nvarying vec2 u;\nvoid main() {{ gl_FragColor = texture2D(s, u); }}\n"
            )
        };
        assert_eq!(count("a.frag", &text("150")), 3);
        for old in ["120", "130", "150 compatibility"] {
            assert_eq!(count("a.frag", &text(old)), 0, "{old}");
        }
        // A function of the shader may have the name.
        let own = "#version 150\nout vec4 c;\nvec4 texture2D(vec2 u) { return u.xyxy; }\nvoid main() { c = texture2D(vec2(1.0)); }\n";
        assert_eq!(count("a.frag", own), 0);
        // In GLSL for Vulkan it is a type.
        let separate = "#version 450\nlayout(set = 0, binding = 0) uniform texture2D t;\nlayout(set = 0, binding = 1) uniform sampler s;\n\
            layout(location = 0) out vec4 c;\nvec4 at(texture2D image, vec2 u) { return texture(sampler2D(image, s), u); }\n\
            void main() { c = at(t, vec2(0.5)); }\n";
        assert_eq!(count("a.frag", separate), 0);
    }
}
