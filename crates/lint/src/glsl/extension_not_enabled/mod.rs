//! V010: something that only an extension brings, or an extension that does not exist.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;

use super::compile::{behind_directives, explained};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V010"),
    name: "extension-not-enabled",
    severity: Severity::Error,
    level: Level::Default,
    summary: "something needs an extension that is not enabled, or one that does not exist",
    page: Page {
        what: "Reports functions and variables that only an extension brings when no `#extension` enables it, and `require` of a name that no vendor can have given to an extension.",
        why: "Compilers refuse the name, and a required extension that is not there is an error.",
        bad: &[Example {
            name: "a.frag",
            text: "#version 120\nuniform sampler2D image;\nvarying vec2 uv;\nvoid main(void)\n{\n  gl_FragColor = texture2DGradARB(image, uv, uv, uv);\n}\n",
        }],
        good: &[Example {
            name: "a.frag",
            text: "#version 120\n#extension GL_ARB_shader_texture_lod : enable\nuniform sampler2D image;\nvarying vec2 uv;\nvoid main(void)\n{\n  gl_FragColor = texture2DGradARB(image, uv, uv, uv);\n}\n",
        }],
        fix: "The extension that is named is enabled behind `#version`. Safe: the text did not compile, and has one reading. For an extension that does not exist there is no fix.",
        references: &["GLSL 4.60 specification, section 3.3 \"Preprocessor\""],
        ja: Japanese {
            summary: "有効になっていない拡張か、存在しない拡張が必要です",
            what: "拡張だけが持つ関数・変数を `#extension` なしに使ったもの、どのベンダーの名前でもない拡張の `require` を報告します。",
            why: "名前はコンパイラに拒否されます。必須の拡張がないこともエラーです。",
            fix: "名前の分かる拡張を `#version` の後で有効にします。元はコンパイルできず読み方も一つなので safe です。存在しない拡張は自動修正しません。",
        },
    },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let found = explained(
        found,
        message!("only an extension has it", "拡張だけが持つ機能です"),
        message!("enable the extension", "拡張を有効にしてください"),
    );
    let name =
        found.message.split_once("needs `").and_then(|(_, rest)| rest.split_once('`')).map(|(n, _)| n.to_owned());
    let Some(name) = name else { return Some(found) };
    let edits = vec![Edit::insert(behind_directives(file), format!("#extension {name} : enable\n"))];
    Some(found.with_fix(message!("enable `{name}`", "`{name}` を有効にする"), Safety::Safe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn the_extension_is_enabled() {
        let text = |e: &str| {
            format!(
                "#version 120\n{e}uniform sampler2D s;\nvoid main() {{ vec2 u = vec2(0.0); gl_FragColor = texture2DGradARB(s, u, u, u); }}\n"
            )
        };
        let want = text("#extension GL_ARB_shader_texture_lod : enable\n");
        assert_eq!(lint("a.frag", &text("")), (vec!["V010"], Some((Safety::Safe, want.clone()))));
        assert!(lint("a.frag", &want).0.is_empty());
        assert_eq!(
            lint("a.vert", "#extension GL_ABCDE_x : require\nvoid main() { gl_Position = vec4(1.0); }\n"),
            (vec!["V010"], None)
        );
        assert!(
            lint("a.vert", "#extension GL_NV_x : require\nvoid main() { gl_Position = vec4(1.0); }\n").0.is_empty()
        );
    }
}
