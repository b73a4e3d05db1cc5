//! X001: a suppression that silences nothing.

use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, SourceFile, Span};

use super::{Order, Suppressions};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("X001"),
    name: "unused-suppression",
    severity: Severity::Info,
    level: Level::Default,
    summary: "A comment silences a rule that reports nothing there",
    page: Page {
        what: "Reports codes in `// shadercheck: ignore[…]` and `ignore-file[…]` that silenced no finding. Codes of \
               rules that did not run, because of the level, `--select`, `--ignore` or the configuration, are not \
               reported.",
        why: "What the comment excused has been repaired or has moved. Left in place, it hides the next finding of \
              that rule at this line, which nobody has looked at.",
        bad: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec4 position;\nvoid main()\n{\n  // shadercheck: ignore[N014] digits of the data sheet\n  gl_Position = position;\n}\n",
        }],
        good: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec4 position;\nvoid main()\n{\n  gl_Position = position;\n}\n",
        }],
        fix: "Removes the code from the list, or the comment when no code is left. Unsafe: a run on more files, or \
              with another configuration, may find what the comment is for.",
        references: &["The book of shadercheck, page on lint: suppressions"],
        ja: Japanese {
            summary: "何も報告されない場所で規則を抑止しているコメント",
            what: "`// shadercheck: ignore[…]` と `ignore-file[…]` のコードのうち、どの指摘も抑止しなかったものを報告します。\
                   水準、`--select`、`--ignore`、設定ファイルによって実行されなかった規則のコードは報告しません。",
            why: "コメントの対象だった箇所は、すでに修正されたか移動しています。残しておくと、その行に新しく現れた同じ規則の\
                  指摘が、誰にも確認されないまま隠れてしまいます。",
            fix: "一覧からそのコードを取り除きます。コードが残らない場合はコメントごと削除します。より多くのファイルや別の設定で\
                  実行すると必要なコメントかもしれないので、unsafe の修正です。",
        },
    },
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
    let codes = unused.iter().map(|e| e.code).collect::<Vec<_>>().join(", ");
    let (span, edit, title) = if unused.len() == order.entries.len() {
        (order.span, Edit::delete(order.whole), message!("remove the comment", "コメントを削除する"))
    } else {
        let kept = |e: &&super::Entry| !unused.iter().any(|u| u.code == e.code);
        let list = order.entries.iter().filter(kept).map(|e| e.code).collect::<Vec<_>>().join(", ");
        let last = unused.last().map_or(first.span.end, |e| e.span.end);
        let title = message!("remove {codes} from the list", "一覧から {codes} を取り除く");
        (Span::new(first.span.start, last), Edit::replace(order.list, list), title)
    };
    let found = findings
        .at(file, span, message!("nothing is silenced here by {codes}", "{codes} で抑止される指摘はありません"))
        .with_label(message!("silences nothing", "何も抑止していません"))
        .with_why(message!(
            "a comment that is left behind hides the next finding of the rule at this place",
            "残ったコメントは、この場所に次に現れる同じ規則の指摘を隠してしまいます"
        ))
        .with_fix(title, Safety::Unsafe, vec![edit]);
    findings.push(found);
}
