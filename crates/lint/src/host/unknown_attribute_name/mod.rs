//! H004: an attribute is looked up by a name that the vertex stage does not declare.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::Project;

use hosts::HostFile;
use hosts::cpp::lookup::LookupKind;
use hosts::suggest::{list, list_in_japanese, nearest};
use reading::program::resolve;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H004"),
    name: "unknown-attribute-name",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    let all = host.lookups();
    for lookup in all {
        if matches!(lookup.kind, LookupKind::Uniform | LookupKind::Name) || lookup.is_reserved() {
            continue;
        }
        let Some(program) = resolve(host, project, &lookup.source) else { continue };
        let Some(vertex) = program.vertex() else { continue };
        let interface = vertex.shader.interface();
        let name = lookup.base_name();
        if interface.input(name).is_some() || program.uniform(name).is_some() || program.in_block(name) {
            continue;
        }
        let taken = |v: &str| all.iter().any(|l| l.kind != LookupKind::Uniform && l.base_name() == v);
        let names: Vec<&str> = interface.inputs.iter().map(|v| v.name.as_str()).collect();
        let free: Vec<&str> = names.iter().copied().filter(|n| !taken(n)).collect();
        let near = nearest(name, free.iter().copied());
        if lookup.kind == LookupKind::BindAttribute && near.is_none() {
            continue;
        }
        let only = if names.len() == 1 { free.first().copied() } else { None };
        let place = vertex.file.name();
        let label = if lookup.kind == LookupKind::Attribute {
            lookup.missing.label()
        } else {
            message!("binds nothing", "何にも結び付きません")
        };
        let mut found = findings
            .at(&host.file, lookup.literal_span(), message!("no attribute of {place} is called `{name}`", "{place} に `{name}` という頂点属性はありません"))
            .with_label(label)
            .with_why(lookup.missing.why().unwrap_or_else(|| match lookup.kind {
                LookupKind::BindAttribute => message!(
                    "glBindAttribLocation of a name that is no attribute has no effect",
                    "頂点属性でない名前の glBindAttribLocation は効果がありません"
                ),
                LookupKind::Attribute | LookupKind::Uniform | LookupKind::Name => message!(
                    "glGetAttribLocation gives -1 without a GL error, and glVertexAttribPointer refuses the location -1",
                    "glGetAttribLocation は GL エラーなしに -1 を返し、glVertexAttribPointer は位置 -1 を受け付けません"
                ),
            }))
            .with_help(match names.as_slice() {
                [] => message!("{place} has no attribute", "{place} に頂点属性はありません"),
                [one] => message!("the only attribute is `{one}`", "頂点属性は `{one}` だけです"),
                all => {
                    let (en, ja) = (list(all), list_in_japanese(all));
                    message!("the attributes are {en}", "頂点属性は {ja} です")
                }
            });
        if let Some(meant) = near.or(only) {
            if let Some(variable) = interface.input(meant) {
                found = found.with_related(
                    &vertex.file,
                    variable.name_span,
                    message!("`{meant}` is declared here", "`{meant}` はここで宣言されています"),
                );
            }
            let edit = Edit::replace(lookup.name_span, meant);
            found = found.with_fix(message!("write `{meant}`", "`{meant}` と書く"), Safety::Unsafe, vec![edit]);
        }
        findings.push(found);
    }
}
