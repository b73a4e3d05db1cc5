//! H040: an object gives values to the uniforms of a program, and leaves one out.

use std::collections::BTreeSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use hosts::marks::has_word;
use hosts::suggest::{list, list_in_japanese};
use reading::Project;
use reading::prelude::{self, Prelude};
use reading::program::Program;
use reading::program::resolve;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H040"),
    name: "uniform-without-value",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for table in host.tables() {
        let Some(program) = resolve(host, project, &table.source).filter(Program::is_complete) else { continue };
        let mut told = BTreeSet::new();
        for (shader, uniform) in
            program.shaders().iter().flat_map(|s| s.shader.interface().uniforms.iter().map(move |u| (s, u)))
        {
            let name = uniform.name.as_str();
            let used = shader.shader.uses_of(uniform.symbol).next().is_some();
            if !used || shader.is_in_front(uniform.name_span) || table.names.contains(name) || !told.insert(name) {
                continue;
            }
            let says = |word: &str| project.hosts().any(|h| h.file.text().contains(word));
            if project.hosts().any(|h| mentions(h, name)) || prelude::sets(name, host_of(&program), says) {
                continue;
            }
            let names: Vec<&str> = table.names.iter().map(String::as_str).collect();
            let (en, ja) = (list(&names), list_in_japanese(&names));
            let found = findings
                .at(&host.file, table.place, message!("`{name}` gets no value", "`{name}` に値が設定されません"))
                .with_label(message!("has {en}", "ここにあるのは {ja} です"))
                .with_related(
                    &shader.file,
                    uniform.name_span,
                    message!("used, and declared here", "使われており、ここで宣言されています"),
                )
                .with_why(message!(
                    "a uniform that nothing sets is zero, or a texture without an image; no error is raised",
                    "設定されない uniform はゼロ、または画像のないテクスチャになり、エラーにはなりません"
                ))
                .with_help(message!("add `{name}` to the object", "`{name}` をこのオブジェクトに加えてください"));
            findings.push_at(if table.nested { Level::Strict } else { RULE.level }, found);
        }
    }
}

/// The host that is known to put its text around one of the stages.
fn host_of(program: &Program<'_>) -> Option<&'static Prelude> {
    program.shaders().iter().find_map(|shader| shader.prelude)
}

/// True when host code says the name outside of its shaders: it may set it.
fn mentions(host: &HostFile, name: &str) -> bool {
    let text = host.file.text();
    if !has_word(text, name) {
        return false;
    }
    let in_shader = |at: usize| host.embedded().iter().any(|e| e.place.contains(at));
    let part = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(name).any(|(at, _)| {
        let (before, behind) = (&text[..at], &text[at + name.len()..]);
        !in_shader(at) && !before.ends_with(part) && !behind.starts_with(part)
    })
}
