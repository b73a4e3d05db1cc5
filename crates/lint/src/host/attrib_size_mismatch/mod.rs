//! H007: more components than the attribute has.

use super::HostFile;
use super::attributes::attributes;
use crate::project::Project;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use syntax::types::Type;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H007"),
    name: "attrib-size-mismatch",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for pointer in attributes(host, project) {
        let Some(place) = pointer.arguments.get(1).copied() else { continue };
        let Ok(size) = host.file.slice(place).parse::<usize>() else { continue };
        let ty = &pointer.variable.ty;
        let has = match ty {
            Type::Scalar(_) => 1,
            Type::Vector(_, n) => usize::from(*n),
            Type::Matrix(_, _, rows) => usize::from(*rows),
            Type::Array(..) | Type::Error | Type::Void | Type::Opaque(_) | Type::Struct(_) => continue,
        };
        if (1..=has).contains(&size) {
            continue;
        }
        let (name, ty) = (&pointer.variable.name, ty.to_string());
        findings.push(
            findings
                .at(
                    &host.file,
                    place,
                    message!(
                        "{size} components are given to `{name}`, which is `{ty}`",
                        "`{ty}` の `{name}` に {size} 成分を渡しています"
                    ),
                )
                .with_label(message!("{has} are used", "使われるのは {has} 成分です"))
                .with_related(
                    &pointer.shader.file,
                    pointer.variable.name_span,
                    message!("declared here", "ここで宣言されています"),
                )
                .with_why(message!(
                    "components that the attribute does not have are thrown away, and a size has to be 1 to 4",
                    "頂点属性にない成分は捨てられ、成分数は 1 から 4 でなければなりません"
                ))
                .with_help(message!(
                    "give {has}, or declare the attribute with {size}",
                    "{has} を渡すか、属性を {size} 成分で宣言してください"
                )),
        );
    }
}
