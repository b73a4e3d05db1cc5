//! H009: a stride smaller than one element.

use super::HostFile;
use super::syntax::{arguments, callee, descendants, span};
use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H009"),
    name: "attrib-stride",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "the stride of a vertex array is smaller than one element",
    page: Page {
        what: "Reports calls of `glVertexAttribPointer` and `glVertexAttribIPointer` whose stride is a plain number other than 0 that is smaller than the bytes of one element. A stride with `sizeof` may be meant and stays silent.",
        why: "The stride counts bytes, not numbers: elements overlap, and most start in the middle of a value.",
        bad: &[Example {
            name: "array.cpp",
            text: "void array()\n{\n  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 6, 0);\n}\n",
        }],
        good: &[Example {
            name: "array.cpp",
            text: "void array()\n{\n  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 6 * sizeof(GLfloat), 0);\n}\n",
        }],
        fix: "Multiplies the number by the size of a component. Unsafe: the array is read in another way.",
        references: &["OpenGL 3.2 core specification, section 2.8 (Vertex Arrays): stride is in basic machine units"],
        ja: Japanese {
            summary: "頂点配列の間隔（stride）が一つの要素より小さいです",
            what: "`glVertexAttribPointer` と `glVertexAttribIPointer` のうち、間隔（stride）が 0 以外のただの数で、一つの要素のバイト数より小さいものを報告します。`sizeof` を使った間隔は意図的かもしれないので報告しません。",
            why: "間隔は個数ではなくバイト数です。要素が重なり、多くは値の途中から読まれます。",
            fix: "数に成分の大きさを掛けます。配列の読み方が変わるので unsafe です。",
        },
    },
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
