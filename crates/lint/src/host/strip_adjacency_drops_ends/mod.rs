//! H030: strips with adjacency do not draw their first and last segment.

use tree_sitter::Node;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::Project;

use hosts::HostFile;
use hosts::cpp::tree::{arguments, bare, callee, descendants, root_object, span, write};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H030"),
    name: "strip-adjacency-drops-ends",
    severity: Severity::Info,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, _: &Project, findings: &mut Findings<'_>) {
    let Some(root) = host.root() else { return };
    for call in descendants(root) {
        let Some((function, _)) = callee(call, &host.file) else { continue };
        if !matches!(
            function,
            "glDrawArrays" | "glMultiDrawArrays" | "glDrawArraysInstanced" | "glDrawArraysInstancedBaseInstance"
        ) {
            continue;
        }
        let arguments = arguments(call);
        let (Some(&mode), Some(&count)) = (arguments.first(), arguments.get(2)) else { continue };
        let strip = host.text(mode).starts_with("GL_LINE_STRIP_ADJACENCY");
        if call.has_error() || !strip || adds_two(host, root, count) {
            continue;
        }
        let message = if function == "glMultiDrawArrays" {
            message!(
                "the first and the last segment of every strip are not drawn",
                "どの折れ線でも最初と最後の区間が描かれません"
            )
        } else {
            message!(
                "the first and the last segment of the strip are not drawn",
                "折れ線の最初と最後の区間が描かれません"
            )
        };
        findings.push(
            findings
                .at(&host.file, span(mode), message)
                .with_label(message!("m nodes give m - 3 segments", "節点 m 個で m - 3 区間"))
                .with_why(message!(
                    "the first and the last node of a strip with adjacency are only neighbours: of the m - 1 \
                     segments between m nodes, m - 3 are drawn",
                    "隣接頂点つきの折れ線の最初と最後の節点は隣接頂点にすぎません。節点 m 個の間の m - 1 区間のうち、描かれるのは m - 3 区間です"
                ))
                .with_help(message!(
                    "store the first and the last node twice and add 2 to the count, unless the data does that \
                     already",
                    "データがまだそうなっていなければ、最初と最後の節点を二度ずつ格納し、個数に 2 を足してください"
                )),
        );
    }
}

/// True when 2 is added in the count, or in a value that the file gives to the count's variable.
fn adds_two(host: &HostFile, root: Node<'_>, count: Node<'_>) -> bool {
    if has_plus_two(host, count) {
        return true;
    }
    let variable = host.text(root_object(count));
    descendants(root).any(|node| {
        if let Some(write) = write(node) {
            return host.text(root_object(write.target)) == variable && has_plus_two(host, write.value);
        }
        // count.push_back(m + 2)
        node.kind() == "call_expression"
            && node
                .child_by_field_name("function")
                .is_some_and(|f| f.kind() == "field_expression" && host.text(root_object(f)) == variable)
            && arguments(node).iter().any(|a| has_plus_two(host, *a))
    })
}

fn has_plus_two(host: &HostFile, node: Node<'_>) -> bool {
    descendants(node).filter(|n| n.kind() == "binary_expression").any(|n| {
        let plus = n.child_by_field_name("operator").is_some_and(|o| o.kind() == "+");
        let two = ["left", "right"]
            .iter()
            .filter_map(|side| n.child_by_field_name(side))
            .any(|o| host.text(bare(o)).trim_end_matches(['u', 'U', 'l', 'L']) == "2");
        plus && two
    })
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    fn lint(body: &str) -> Vec<(String, String)> {
        let text = format!("void f() {{ {body} }}");
        run(&[Input::new(SourceFile::new("a.cpp", text))])
            .iter()
            .map(|d| (d.code.0.to_owned(), d.file.slice(d.span).to_owned()))
            .collect()
    }

    #[test]
    fn strips_are_reported_at_their_mode() {
        let expected = vec![("H030".to_owned(), "GL_LINE_STRIP_ADJACENCY".to_owned())];
        assert_eq!(lint("glDrawArrays(GL_LINE_STRIP_ADJACENCY, 0, n);"), expected);
        assert_eq!(lint("count[i] = m; glMultiDrawArrays(GL_LINE_STRIP_ADJACENCY, first, count, n);"), expected);
    }

    #[test]
    fn other_modes_and_repeated_ends_are_not() {
        for body in [
            "glDrawArrays(GL_LINES_ADJACENCY, 0, n);",
            "glDrawArrays(GL_LINE_STRIP, 0, n);",
            "glDrawArrays(GL_LINE_STRIP_ADJACENCY, 0, n + 2);",
            "GLsizei k = 2 + m; glDrawArrays(GL_LINE_STRIP_ADJACENCY, 0, k);",
            "count.push_back(m + 2); glMultiDrawArrays(GL_LINE_STRIP_ADJACENCY, first.data(), &count[0], n);",
        ] {
            assert!(lint(body).is_empty(), "{body}");
        }
    }
}
