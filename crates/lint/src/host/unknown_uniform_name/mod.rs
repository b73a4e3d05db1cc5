//! H003: a uniform is looked up by a name that no stage declares.

use crate::project::Project;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};

use super::HostFile;
use super::lookup::LookupKind;
use super::program::resolve;
use super::suggest::{list, list_in_japanese, nearest};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H003"),
    name: "unknown-uniform-name",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for lookup in host.lookups() {
        if lookup.kind != LookupKind::Uniform || lookup.is_reserved() {
            continue;
        }
        let Some(program) = resolve(host, project, &lookup.source) else { continue };
        let name = lookup.base_name();
        // A block's member has no location either, but its name is known.
        let declared = program.uniform(name).is_some() || program.in_block(name);
        let attribute = program.attribute(name).is_some() && !lookup.wrapped;
        if !program.is_complete() || declared || attribute {
            continue;
        }
        let place = program.names();
        let mut found = findings
            .at(
                &host.file,
                lookup.literal_span(),
                message!("no uniform of {place} is called `{name}`", "{place} に `{name}` という uniform はありません"),
            )
            .with_label(message!("gives -1", "-1 になります"))
            .with_why(message!(
                "glGetUniformLocation gives -1 without a GL error, and glUniform functions ignore the location -1",
                "glGetUniformLocation は GL エラーなしに -1 を返し、glUniform 系の関数は位置 -1 を無視します"
            ));
        if let Some(meant) = nearest(name, program.uniforms()) {
            if let Some((shader, variable)) = program.uniform(meant) {
                found = found.with_related(
                    &shader.file,
                    variable.name_span,
                    message!("`{meant}` is declared here", "`{meant}` はここで宣言されています"),
                );
            }
            let place = Span::new(lookup.name_span.start, lookup.name_span.start + name.len());
            found = found.with_fix(
                message!("write `{meant}`", "`{meant}` と書く"),
                Safety::Unsafe,
                vec![Edit::replace(place, meant)],
            );
        }
        let mut all: Vec<&str> = program.uniforms().collect();
        all.sort_unstable();
        all.dedup();
        findings.push(found.with_help(match all.as_slice() {
            [] => {
                message!(
                    "the program has no uniform outside blocks",
                    "プログラムにはブロックの外の uniform がありません"
                )
            }
            all => {
                let (en, ja) = (list(all), list_in_japanese(all));
                message!("the uniforms are {en}", "uniform は {ja} です")
            }
        }));
    }
}
