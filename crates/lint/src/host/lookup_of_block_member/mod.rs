//! H006: a member of a uniform block set as a plain uniform.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use hosts::cpp::lookup::LookupKind;
use reading::Project;
use reading::program::resolve;
use syntax::interface::Storage;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H006"),
    name: "lookup-of-block-member",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for lookup in host.lookups().iter().filter(|l| l.kind == LookupKind::Uniform) {
        let set = lookup.feeds.uniform || (lookup.wrapped && lookup.sets.is_some());
        let Some(program) = resolve(host, project, &lookup.source).filter(|_| set) else { continue };
        let name = lookup.base_name();
        if program.uniform(name).is_some() {
            continue;
        }
        let block = program.shaders().iter().find_map(|s| {
            let blocks = s.shader.interface().blocks.iter().filter(|b| b.storage == Storage::Uniform);
            let mut named = blocks.filter(|b| {
                let instance = b.instance.as_ref();
                b.name.name == name
                    || instance.is_some_and(|i| i.name == name)
                    || (instance.is_none() && b.members.iter().any(|m| m.name.name == name))
            });
            named.next().map(|b| (s, b))
        });
        let Some((shader, block)) = block else { continue };
        let called = &block.name.name;
        findings.push(
            findings
                .at(
                    &host.file,
                    lookup.literal_span(),
                    message!(
                        "`{name}` belongs to the uniform block `{called}` and has no location",
                        "`{name}` は uniform ブロック `{called}` のもので、位置がありません"
                    ),
                )
                .with_label(message!("gives -1", "-1 になります"))
                .with_related(&shader.file, block.name.span, message!("the block", "このブロック"))
                .with_why(message!(
                    "members of a block get their values from a buffer, and glUniform functions ignore the location -1",
                    "ブロックのメンバの値はバッファから読まれ、glUniform 系の関数は位置 -1 を無視します"
                ))
                .with_help(message!(
                    "write the value to the buffer that is bound to `{called}`",
                    "`{called}` に結び付けたバッファに値を書いてください"
                )),
        );
    }
}
