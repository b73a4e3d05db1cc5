//! H001: the location of an attribute is asked for as that of a uniform.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::Project;

use hosts::HostFile;
use hosts::cpp::lookup::LookupKind;
use hosts::spelling::spelled;
use reading::program::resolve;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H001"),
    name: "uniform-lookup-of-attribute",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for lookup in host.lookups() {
        if lookup.kind != LookupKind::Uniform || lookup.is_reserved() || lookup.wrapped {
            continue;
        }
        let Some(program) = resolve(host, project, &lookup.source) else { continue };
        let name = lookup.base_name();
        let Some((shader, variable)) = program.attribute(name) else { continue };
        let elsewhere = program.uniform(name).is_some() || program.in_block(name);
        // A printed listing leaves out what it does not speak of.
        let known = program.is_complete() || lookup.feeds.attribute || (host.is_fragment() && !lookup.feeds.uniform);
        if elsewhere || !known {
            continue;
        }
        let safety = if lookup.feeds.only_attribute() { Safety::Safe } else { Safety::Unsafe };
        let right = spelled(host, lookup.function, LookupKind::Attribute.function());
        findings.push(
            findings
                .at(&host.file, lookup.function, message!(
                        "`{name}` is an attribute, but is looked up as a uniform",
                        "`{name}` は頂点属性ですが、uniform として位置を求めています"
                    ))
                .with_label(message!("gives -1 here", "ここでは -1 になります"))
                .with_related(&shader.file, variable.name_span, message!("`{name}` is declared `in` here", "`{name}` はここで `in` と宣言されています"))
                .with_why(message!(
                    "glGetUniformLocation knows no attributes: it gives -1 without a GL error, and the \
                     attribute never gets its array",
                    "glGetUniformLocation は頂点属性を知りません。GL エラーなしに -1 を返し、頂点属性に配列が結び付きません"
                ))
                .with_fix(message!("call `{right}`", "`{right}` を呼ぶ"), safety, vec![Edit::replace(lookup.function, right.as_str())]),
        );
    }
}
