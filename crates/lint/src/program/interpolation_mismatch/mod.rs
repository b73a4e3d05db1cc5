//! I004: an output and its input with different interpolation.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::Project;
use reading::ShaderFile;
use syntax::Stage;

use reading::program::Program;
use reading::program::link::{interpolation, is_built_in, keyword, producer};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I004"),
    name: "interpolation-mismatch",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Program(check),
};

fn check(program: &Program<'_>, _project: &Project, findings: &mut Findings<'_>) {
    for (from, to) in program.links() {
        let old = |s: &ShaderFile| (130..440).contains(&s.shader.version().number);
        if to.shader.stage() != Stage::Fragment || !old(from) || !old(to) {
            continue;
        }
        for input in to.shader.interface().inputs.iter().filter(|v| !is_built_in(&v.name)) {
            let Some(output) = producer(from, to, input) else { continue };
            let (has, had) = (interpolation(&input.qualifiers), interpolation(&output.qualifiers));
            if has == had {
                continue;
            }
            let (name, has, had) = (&output.name, keyword(has), keyword(had));
            let mut found = findings
                .at(
                    &from.file,
                    output.name_span,
                    message!(
                        "`{name}` is `{had}` here, and `{has}` in the fragment stage",
                        "`{name}` はここでは `{had}`、フラグメントシェーダでは `{has}` です"
                    ),
                )
                .with_label(message!("written as `{had}`", "`{had}` として書かれます"))
                .with_related(
                    &to.file,
                    input.name_span,
                    message!("read as `{has}` here", "ここで `{has}` として読まれます"),
                )
                .with_why(message!(
                    "before GLSL 4.40 both have to be the same, or the program does not link",
                    "GLSL 4.40 より前では両方が同じでなければ、プログラムはリンクできません"
                ))
                .with_help(message!("write `{has}` in both stages", "両方のステージに `{has}` と書いてください"));
            if output.siblings == 1 {
                let edit = match (output.qualifiers.interpolation(), output.qualifiers.storage()) {
                    (Some((_, span)), _) => Some(Edit::replace(span, has)),
                    (None, Some((_, span))) => Some(Edit::insert(span.start, format!("{has} "))),
                    (None, None) => None,
                };
                let edits: Vec<Edit> = edit.into_iter().collect();
                found = found.with_fix(message!("write `{has}`", "`{has}` と書く"), Safety::Unsafe, edits);
            }
            findings.push(found);
        }
    }
}
