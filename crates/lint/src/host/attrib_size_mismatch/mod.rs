//! H007: more components than the attribute has.

use super::attributes::attributes;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use base::text::Span;
use hosts::cpp::lookup::LookupKind;
use hosts::{HostFile, ShaderRef};
use reading::program::resolve;
use reading::{Project, ShaderFile};
use syntax::Stage;
use syntax::interface::Variable;
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
        judge(host, findings, place, size, (pointer.shader, pointer.variable));
    }
    for lookup in host.lookups().iter().filter(|l| l.kind == LookupKind::Attribute) {
        let Some(size) = lookup.given else { continue };
        let program = resolve(host, project, &lookup.source);
        let Some(attribute) = program.and_then(|p| p.attribute(&lookup.name)) else { continue };
        judge(host, findings, lookup.literal_span(), size, attribute);
        fewer(host, findings, lookup.literal_span(), size, attribute);
    }
    for field in host.fields() {
        let shaders = (0..host.embedded().len()).filter_map(|i| project.shader_of(host, &ShaderRef::Embedded(i)));
        let vertex = shaders.filter(|s| s.shader.stage() == Stage::Vertex);
        let mut declared = vertex.filter_map(|s| s.shader.interface().input(&field.name).map(|v| (s, v)));
        let (Some(attribute), None) = (declared.next(), declared.next()) else { continue };
        judge(host, findings, field.place, field.size, attribute);
        fewer(host, findings, field.place, field.size, attribute);
    }
}

fn components(ty: &Type) -> Option<usize> {
    match ty {
        Type::Scalar(_) => Some(1),
        Type::Vector(_, n) => Some(usize::from(*n)),
        Type::Matrix(_, _, rows) => Some(usize::from(*rows)),
        Type::Array(..) | Type::Error | Type::Void | Type::Opaque(_) | Type::Struct(_) => None,
    }
}

/// Reports components that are not used.
fn judge(
    host: &HostFile,
    findings: &mut Findings<'_>,
    place: Span,
    size: usize,
    (shader, variable): (&ShaderFile, &Variable),
) {
    let Some(has) = components(&variable.ty).filter(|has| !(1..=*has).contains(&size)) else { return };
    let (name, ty) = (&variable.name, variable.ty.to_string());
    findings.push(
        findings
            .at(
                &host.file,
                place,
                message!(
                    "`{name}` is `{ty}`, and is given {size} components",
                    "`{ty}` の `{name}` に {size} 成分を渡しています"
                ),
            )
            .with_label(message!("{has} are used", "使われるのは {has} 成分です"))
            .with_related(&shader.file, variable.name_span, message!("declared here", "ここで宣言されています"))
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

/// Reports a component that is read and never given: it is 0. A fourth one is 1, as positions need it.
fn fewer(
    host: &HostFile,
    findings: &mut Findings<'_>,
    place: Span,
    size: usize,
    (shader, variable): (&ShaderFile, &Variable),
) {
    let Type::Vector(_, has) = &variable.ty else { return };
    let missing = ["x", "y", "z"].get(size..usize::from(*has).min(3)).unwrap_or_default();
    let text = shader.file.text();
    let reads = |letter: &&&str| {
        shader.shader.uses_of(variable.symbol).any(|u| {
            let swizzle = text[u.span.end..].strip_prefix('.').unwrap_or("");
            let end = swizzle.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(swizzle.len());
            swizzle[..end].contains(**letter)
        })
    };
    let Some(letter) = missing.iter().find(reads) else { return };
    let (name, ty) = (&variable.name, variable.ty.to_string());
    findings.push(
        findings
            .at(
                &host.file,
                place,
                message!(
                    "`{name}.{letter}` is read, and never given: the array of this `{ty}` has size {size}",
                    "`{name}.{letter}` は読まれますが渡されていません。`{ty}` に {size} 成分を渡しています"
                ),
            )
            .with_label(message!("`{letter}` is always 0", "`{letter}` は常に 0 です"))
            .with_related(&shader.file, variable.name_span, message!("declared here", "ここで宣言されています"))
            .with_why(message!(
                "components that an array does not give are 0, and 1 for the fourth",
                "配列が渡さない成分は 0(4 番目は 1)になります"
            ))
            .with_help(message!(
                "give the component, or declare the attribute with {size}",
                "その成分を渡すか、属性を {size} 成分で宣言してください"
            )),
    );
}
