//! X001: a suppression that silences nothing.

use crate::registry::with_name;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, SourceFile, Span};

use super::{Order, Suppressions};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("X001"),
    name: "unused-suppression",
    severity: Severity::Info,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::After(check),
};

fn check(suppressions: &Suppressions, findings: &mut Findings<'_>) {
    for comments in &suppressions.files {
        for order in &comments.orders {
            report(&comments.file, order, findings);
        }
    }
}

fn report(file: &SourceFile, order: &Order, findings: &mut Findings<'_>) {
    let unused: Vec<_> = order.entries.iter().filter(|e| e.judged && !e.used).collect();
    let &[first, ..] = unused.as_slice() else { return };
    let rules = unused.iter().map(|e| with_name(e.code)).collect::<Vec<_>>().join(", ");
    let (span, edit, title) = if unused.len() == order.entries.len() {
        (order.span, Edit::delete(order.whole), message!("remove the comment", "コメントを削除する"))
    } else {
        let kept = |e: &&super::Entry| !unused.iter().any(|u| u.code == e.code);
        let written = |e: &super::Entry| file.slice(e.span);
        let list = order.entries.iter().filter(kept).map(written).collect::<Vec<_>>().join(", ");
        let gone = unused.iter().map(|e| written(e)).collect::<Vec<_>>().join(", ");
        let last = unused.last().map_or(first.span.end, |e| e.span.end);
        let title = message!("remove {gone} from the list", "一覧から {gone} を取り除く");
        (Span::new(first.span.start, last), Edit::replace(order.list, list), title)
    };
    let found = findings
        .at(file, span, message!("nothing is silenced here by {rules}", "{rules} で抑止される指摘はありません"))
        .with_label(message!("silences nothing", "何も抑止していません"))
        .with_why(message!(
            "a comment that is left behind hides the next finding of the rule at this place",
            "残ったコメントは、この場所に次に現れる同じ規則の指摘を隠してしまいます"
        ))
        .with_fix(title, Safety::Unsafe, vec![edit]);
    findings.push(found);
}
