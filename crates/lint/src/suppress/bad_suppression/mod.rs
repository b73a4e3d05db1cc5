//! X002: a suppression that cannot be read.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use base::text::SourceFile;

use super::{Cause, Fault, Suppressions};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("X002"),
    name: "bad-suppression",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::After(check),
};

fn check(suppressions: &Suppressions, findings: &mut Findings<'_>) {
    for comments in &suppressions.files {
        for fault in &comments.faults {
            report(&comments.file, fault, findings);
        }
    }
}

fn report(file: &SourceFile, fault: &Fault, findings: &mut Findings<'_>) {
    let (message, help) = match &fault.cause {
        Cause::UnknownWord(word) if word.is_empty() => (
            message!("a comment to shadercheck says nothing", "shadercheck へのコメントに指示がありません"),
            message!(
                "write `ignore[RULE] reason`, or remove the comment",
                "`ignore[規則] 理由` と書くか、コメントを削除します"
            ),
        ),
        Cause::UnknownWord(word) => (
            message!("shadercheck has no instruction `{word}`", "`{word}` という指示はありません"),
            message!(
                "write `ignore[RULE] reason` or `ignore-file[RULE] reason`",
                "`ignore[規則] 理由` または `ignore-file[規則] 理由` と書きます"
            ),
        ),
        Cause::NoCodes(word) => (
            message!(
                "`{word}` names no rule, so that nothing is silenced",
                "`{word}` に規則の指定がないため、何も抑止されません"
            ),
            message!(
                "name the rules in brackets: `{word}[N014] reason`",
                "規則を角括弧で指定します: `{word}[N014] 理由`"
            ),
        ),
        Cause::Unclosed => (
            message!("the list of rules is not closed", "規則の一覧が閉じていません"),
            message!("write `]` after the last rule", "最後の規則の後に `]` を書きます"),
        ),
        Cause::UnknownRule { given, nearest } => {
            let nearest = nearest.join(", ");
            let help = match nearest.as_str() {
                "" => message!(
                    "`shadercheck explain` lists all rules",
                    "`shadercheck explain` で全ての規則を確認できます"
                ),
                _ => message!(
                    "did you mean {nearest}? `shadercheck explain` lists all rules",
                    "{nearest} のことですか？`shadercheck explain` で全ての規則を確認できます"
                ),
            };
            (message!("no rule is called `{given}`", "`{given}` という規則はありません"), help)
        }
    };
    let found = findings
        .at(file, fault.span, message)
        .with_label(message!("not understood", "解釈できません"))
        .with_why(message!("the comment has no effect here", "ここではコメントの効果がありません"))
        .with_help(help);
    findings.push(found);
}
