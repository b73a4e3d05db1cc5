//! H009: a stride smaller than one element.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use hosts::HostFile;
use hosts::cpp::tree::{arguments, callee, descendants, span};
use reading::Project;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H009"),
    name: "attrib-stride",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, _: &Project, findings: &mut Findings<'_>) {
    let Some(root) = host.root().filter(|_| host.file.text().contains("glVertexAttrib")) else { return };
    for call in descendants(root) {
        let Some((function, _)) = callee(call, &host.file) else { continue };
        let at = match function {
            "glVertexAttribPointer" => 4,
            "glVertexAttribIPointer" => 3,
            _ => continue,
        };
        let all = arguments(call);
        let [_, size, kind, ..] = all.as_slice() else { continue };
        let Some(place) = all.get(at).map(|n| span(*n)) else { continue };
        let number = |s: &str| s.parse::<usize>().ok();
        let (Some(size), Some(stride)) = (number(host.text(*size)), number(host.file.slice(place))) else { continue };
        let Some((bytes, component)) = component(host.text(*kind)) else { continue };
        if stride == 0 || stride >= size * bytes || !(1..=4).contains(&size) {
            continue;
        }
        let needed = size * bytes;
        let title = format!("{stride} * sizeof({component})");
        findings.push(
            findings
                .at(
                    &host.file,
                    place,
                    message!(
                        "a stride of {stride} bytes, but one element has {needed}",
                        "間隔が {stride} バイトですが、一つの要素は {needed} バイトです"
                    ),
                )
                .with_label(message!("counts bytes", "バイト数です"))
                .with_why(message!(
                    "the stride is the distance from one element to the next in bytes; here they overlap",
                    "間隔は要素から次の要素までのバイト数で、ここでは要素が重なります"
                ))
                .with_fix(
                    message!("write `{title}`", "`{title}` と書く"),
                    Safety::Unsafe,
                    vec![Edit::replace(place, title)],
                ),
        );
    }
}

/// Bytes and name of a type of components.
fn component(kind: &str) -> Option<(usize, &'static str)> {
    Some(match kind {
        "GL_BYTE" => (1, "GLbyte"),
        "GL_UNSIGNED_BYTE" => (1, "GLubyte"),
        "GL_SHORT" => (2, "GLshort"),
        "GL_UNSIGNED_SHORT" => (2, "GLushort"),
        "GL_INT" => (4, "GLint"),
        "GL_UNSIGNED_INT" => (4, "GLuint"),
        "GL_FLOAT" => (4, "GLfloat"),
        "GL_DOUBLE" => (8, "GLdouble"),
        _ => return None,
    })
}
