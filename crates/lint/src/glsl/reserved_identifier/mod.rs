//! V004: a name that the language keeps for itself.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;

use super::compile::{fresh, is_private};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V004"),
    name: "reserved-identifier",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let Some((id, symbol)) = shader.symbols().find(|(_, s)| s.span == Some(found.span)) else { return Some(found) };
    let name = symbol.name.clone();
    if !is_private(shader, id) || shader.uses_of(id).any(|u| u.from_macro) {
        return Some(found);
    }
    let new = match name.strip_prefix("gl_") {
        Some(rest) => fresh(shader, rest),
        None => fresh(shader, &name),
    };
    let mut edits = vec![Edit::replace(found.span, new.clone())];
    edits.extend(shader.uses_of(id).map(|u| Edit::replace(u.span, new.clone())));
    Some(found.with_fix(message!("rename it to `{new}`", "`{new}` に変える"), Safety::Safe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn private_names_are_changed_everywhere() {
        let text = "#version 150\nvoid main() { float input = 1.0; input += input; gl_Position = vec4(input); }\n";
        let (codes, fixed) = lint("a.vert", text);
        assert_eq!(codes, ["V004"]);
        assert_eq!(fixed, Some((Safety::Safe, text.replace("input", "input_"))));
        // A uniform is known to the host.
        assert_eq!(
            lint("a.vert", "#version 150\nuniform float filter;\nvoid main() { gl_Position = vec4(filter); }\n"),
            (vec!["V004"], None)
        );
        assert!(lint("a.vert", "void main() { float filter = 1.0; gl_Position = vec4(filter); }\n").0.is_empty());
    }
}
