//! H032: a constant that is no truth value where one is asked for.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use hosts::HostFile;
use hosts::cpp::tree::{arguments, bare, callee, descendants, span};
use reading::Project;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H032"),
    name: "flag-argument",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

/// The function's argument that is `GL_TRUE` or `GL_FALSE`: its position and what it says.
fn flag(function: &str) -> Option<(usize, &'static str)> {
    Some(match function {
        "glVertexAttribPointer" | "glVertexAttribFormat" => (3, "normalized"),
        "glVertexArrayAttribFormat" => (4, "normalized"),
        _ if function.starts_with("glUniformMatrix") => (2, "transpose"),
        _ if function.starts_with("glProgramUniformMatrix") => (3, "transpose"),
        _ => return None,
    })
}

fn check(host: &HostFile, _: &Project, findings: &mut Findings<'_>) {
    let text = host.file.text();
    let Some(root) = host.root().filter(|_| text.contains("glVertexA") || text.contains("UniformMatrix")) else {
        return;
    };
    for call in descendants(root) {
        let Some((function, _)) = callee(call, &host.file) else { continue };
        let Some((at, says)) = flag(function) else { continue };
        let Some(argument) = arguments(call).get(at).map(|n| bare(*n)) else { continue };
        let given = host.text(argument);
        let constant = argument.kind() == "identifier" && given.starts_with("GL_");
        if !constant || ["GL_TRUE", "GL_FALSE"].contains(&given) {
            continue;
        }
        let place = span(argument);
        findings.push(
            findings
                .at(
                    &host.file,
                    place,
                    message!("`{given}` is given for `{says}`", "`{says}` に `{given}` を渡しています"),
                )
                .with_label(message!("counts as GL_TRUE", "GL_TRUE とみなされます"))
                .with_why(message!(
                    "every number but 0 is true here: integers would be scaled to [0, 1], a matrix would be transposed",
                    "ここでは 0 以外はすべて真です。整数は [0, 1] に縮められ、行列は転置されます"
                ))
                .with_fix(
                    message!("write `GL_FALSE`", "`GL_FALSE` と書く"),
                    Safety::Unsafe,
                    vec![Edit::replace(place, "GL_FALSE")],
                ),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    #[test]
    fn only_truth_values_are_flags() {
        let reported = |call: &str| {
            let found = run(&[Input::new(SourceFile::new("m.cpp", format!("void f() {{ {call} }}")))]);
            found.into_iter().filter(|d| d.code.0 == "H032").map(|d| d.message.to_string()).collect::<Vec<_>>()
        };
        for (call, expected) in [
            ("glVertexAttribPointer(0, 3, GL_FLOAT, GL_FLOAT, 0, 0);", "`GL_FLOAT` is given for `normalized`"),
            ("glVertexArrayAttribFormat(v, 0, 3, GL_FLOAT, GL_INT, 0);", "`GL_INT` is given for `normalized`"),
            ("glUniformMatrix4fv(l, 1, GL_FLOAT, m);", "`GL_FLOAT` is given for `transpose`"),
        ] {
            assert_eq!(reported(call), [expected], "{call}");
        }
        for call in [
            "glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, 0);",
            "glVertexAttribPointer(0, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0, 0);",
            "glVertexAttribPointer(0, 3, GL_FLOAT, normalize ? GL_TRUE : GL_FALSE, 0, 0);",
            "glVertexAttribPointer(0, 3, GL_FLOAT, flag, 0, 0);",
            "glVertexAttribPointer(0, 3, GL_FLOAT, false, 0, 0);",
            "glVertexAttribIPointer(0, 3, GL_INT, 0, 0);",
        ] {
            assert_eq!(reported(call), [""; 0], "{call}");
        }
    }
}
