//! V010: something that only an extension brings, or an extension that does not exist.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;

use super::compile::{behind_directives, explained};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V010"),
    name: "extension-not-enabled",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
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
