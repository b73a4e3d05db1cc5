//! H013: a look-up before the program is linked.

use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use hosts::cpp::index::Index;
use hosts::cpp::program::is_call;
use hosts::cpp::tree::{ancestors, arguments, bare, span};
use tree_sitter::Node;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use reading::Project;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H013"),
    name: "lookup-before-link",
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
    for &link in index.calls.iter().filter(|c| is_call(host, **c, "glLinkProgram")) {
        let (Some(block), Some(program)) = (block_of(link), arguments(link).first().map(|a| host.text(bare(*a))))
        else {
            continue;
        };
        let made = index.writes.iter().find(|w| {
            host.text(w.target) == program
                && is_call(host, w.value, "glCreateProgram")
                && block_of(w.target).is_some_and(|b| b.id() == block.id())
        });
        let Some(made) = made.filter(|m| m.target.start_byte() < link.start_byte()) else { continue };
        let linked_before = index.calls.iter().any(|c| {
            let early = c.start_byte() < link.start_byte() && c.start_byte() > made.target.start_byte();
            let links = is_call(host, *c, "glLinkProgram") || is_call(host, *c, "glProgramBinary");
            early && links
        });
        if linked_before {
            continue;
        }
        for &call in &index.calls {
            let looks = is_call(host, call, "glGetUniformLocation") || is_call(host, call, "glGetAttribLocation");
            let between = made.target.start_byte() < call.start_byte() && call.start_byte() < link.start_byte();
            let same = arguments(call).first().is_some_and(|a| host.text(bare(*a)) == program);
            if !(looks && between && same) || block_of(call).is_none_or(|b| b.id() != block.id()) {
                continue;
            }
            findings.push(
                findings
                    .at(
                        &host.file,
                        span(call),
                        message!("`{program}` is not linked yet", "`{program}` はまだリンクされていません"),
                    )
                    .with_label(message!("gives -1", "-1 になります"))
                    .with_related(&host.file, span(link), message!("linked here", "ここでリンクされます"))
                    .with_why(message!(
                        "locations are given when a program is linked; before that the call is GL_INVALID_OPERATION",
                        "位置はリンク時に決まります。その前の呼び出しは GL_INVALID_OPERATION になります"
                    ))
                    .with_help(message!(
                        "ask for the location after glLinkProgram",
                        "glLinkProgram の後で位置を求めてください"
                    )),
            );
        }
    }
}

/// The block that a node stands in directly, not in a loop or condition of it.
fn block_of(node: Node<'_>) -> Option<Node<'_>> {
    ancestors(node).find(|n| {
        matches!(
            n.kind(),
            "compound_statement"
                | "lambda_expression"
                | "if_statement"
                | "for_statement"
                | "while_statement"
                | "case_statement"
        )
    })
}
