//! H014: a binding after the program was linked.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};
use hosts::HostFile;
use hosts::cpp::index::Index;
use hosts::cpp::index::within;
use hosts::cpp::program::is_call;
use hosts::cpp::tree::{arguments, bare, enclosing_function, span};
use reading::Project;
use tree_sitter::Node;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H014"),
    name: "bind-after-link",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, _: &Project, findings: &mut Findings<'_>) {
    if !host.file.text().contains("glLinkProgram") {
        return;
    }
    let Some(index) = Index::new(host) else { return };
    let statement = |call: Node<'_>| {
        call.parent().filter(|p| p.kind() == "expression_statement").map(|p| (span(p), p.parent().map(|b| b.id())))
    };
    for &call in &index.calls {
        let bind = ["glBindAttribLocation", "glBindFragDataLocation"].into_iter().find(|f| is_call(host, call, f));
        let (Some(bind), Some((place, block))) = (bind, statement(call)) else { continue };
        let Some(program) = arguments(call).first().map(|a| host.text(bare(*a))) else { continue };
        // A program may be linked by any function: only one that is linked here for good counts.
        let links: Vec<Node<'_>> = index
            .calls
            .iter()
            .copied()
            .filter(|c| {
                is_call(host, *c, "glLinkProgram")
                    && arguments(*c).first().is_some_and(|a| host.text(bare(*a)) == program)
            })
            .collect();
        let (&[link], Some(function)) = (links.as_slice(), enclosing_function(call)) else { continue };
        let Some((link_place, link_block)) = statement(link) else { continue };
        // Another value of the variable would be another program.
        let written = index.writes.iter().any(|w| {
            let between = link_place.end <= w.target.start_byte() && w.target.start_byte() < place.start;
            between && host.text(w.target) == program
        });
        // A function that gets the program may link it.
        let passed = index.calls.iter().any(|c| {
            let later = c.start_byte() > place.start && within(function, *c);
            let open = hosts::cpp::tree::callee(*c, &host.file).is_none_or(|(name, _)| !name.starts_with("gl"));
            later && open && arguments(*c).iter().any(|a| host.text(bare(*a)) == program)
        });
        if link_block != block || link_place.end > place.start || written || passed {
            continue;
        }
        let text = host.file.text();
        let line_start = text[..place.start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[place.end..].find('\n').map_or(text.len(), |i| place.end + i + 1);
        let link_line = text[..link_place.start].rfind('\n').map_or(0, |i| i + 1);
        let alone = text[line_start..line_end].trim() == host.file.slice(place)
            && text[link_line..link_place.start].trim().is_empty();
        let mut found = findings
            .at(
                &host.file,
                span(call),
                message!(
                    "`{bind}` comes after `{program}` is linked",
                    "`{bind}` が `{program}` のリンクより後にあります"
                ),
            )
            .with_label(message!("has no effect", "効果がありません"))
            .with_related(&host.file, span(link), message!("linked here", "ここでリンクされます"))
            .with_why(message!(
                "bindings take effect when the program is linked; this call changes nothing and raises no GL error",
                "指定はリンク時に効きます。この呼び出しは何も変えず、GL エラーにもなりません"
            ))
            .with_help(message!("call it before glLinkProgram", "glLinkProgram の前に呼んでください"));
        if alone {
            let edits = vec![
                Edit::insert(link_line, &text[line_start..line_end]),
                Edit::delete(Span::new(line_start, line_end)),
            ];
            found = found.with_fix(
                message!("move it before glLinkProgram", "glLinkProgram の前に移す"),
                Safety::Unsafe,
                edits,
            );
        }
        findings.push(found);
    }
}
