//! H008: integer attributes and pointers of floats.

use super::attributes::attributes;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};
use hosts::HostFile;
use reading::Project;
use syntax::types::ScalarType;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H008"),
    name: "attrib-integer-pointer",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    const WHOLE: &[&str] =
        &["GL_BYTE", "GL_UNSIGNED_BYTE", "GL_SHORT", "GL_UNSIGNED_SHORT", "GL_INT", "GL_UNSIGNED_INT"];
    for pointer in attributes(host, project) {
        let Some(scalar) = pointer.variable.ty.scalar() else { continue };
        let wants = matches!(scalar, ScalarType::Int | ScalarType::Uint);
        let gives = pointer.function == "glVertexAttribIPointer";
        if wants == gives || !matches!(pointer.function.as_str(), "glVertexAttribPointer" | "glVertexAttribIPointer") {
            continue;
        }
        let (name, ty, function) = (&pointer.variable.name, pointer.variable.ty.to_string(), &pointer.function);
        let mut found = findings
            .at(&host.file, pointer.place, message!("`{function}` does not fit `{name}`, which is `{ty}`", "`{function}` は `{ty}` の `{name}` に合いません"))
            .with_label(if wants { message!("converts to float", "float に変換されます") } else { message!("gives integers", "整数を渡します") })
            .with_related(&pointer.shader.file, pointer.variable.name_span, message!("declared here", "ここで宣言されています"))
            .with_why(message!(
                "the values of the attribute are undefined when it is of integers and the pointer is not, or the other way round",
                "属性とポインタの一方だけが整数のとき、属性の値は不定です"
            ))
            .with_help(if wants {
                message!("call glVertexAttribIPointer with integer data", "整数のデータを glVertexAttribIPointer で渡してください")
            } else {
                message!("call glVertexAttribPointer", "glVertexAttribPointer を呼んでください")
            });
        let arguments = &pointer.arguments;
        if let (true, [_, _, kind, normalized, stride, _]) = (wants, arguments.as_slice())
            && WHOLE.contains(&host.file.slice(*kind))
        {
            let edits = vec![
                Edit::replace(pointer.place, "glVertexAttribIPointer"),
                Edit::delete(Span::new(normalized.start, stride.start)),
            ];
            found = found.with_fix(
                message!("call `glVertexAttribIPointer`", "`glVertexAttribIPointer` を呼ぶ"),
                Safety::Unsafe,
                edits,
            );
        }
        findings.push(found);
    }
}
