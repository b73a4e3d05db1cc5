//! X002: a suppression that cannot be read.

use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, SourceFile};

use super::{Cause, Fault, Suppressions};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("X002"),
    name: "bad-suppression",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "A comment to shadercheck cannot be read, or names a rule that does not exist",
    page: Page {
        what: "Reports comments that start with `shadercheck:` and are not of the form `ignore[CODE, …] reason` or \
               `ignore-file[CODE, …] reason`: another word, no code in brackets, an open bracket, a code that no \
               rule has, or the name of a rule in place of its code.",
        why: "The comment has no effect, and whoever wrote it believes that it has. Codes are required, so that a \
              comment does not silence what comes later.",
        bad: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin float turn;\nvoid main()\n{\n  float th = 6.283185 * turn; // shadercheck: ignore[N014, N0l4] as in the data sheet\n  gl_Position = vec4(th);\n}\n",
        }],
        good: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin float turn;\nvoid main()\n{\n  float th = 6.283185 * turn; // shadercheck: ignore[N014] as in the data sheet\n  gl_Position = vec4(th);\n}\n",
        }],
        fix: "Writes the code of a rule in place of its name: safe, since it is a comment. There is no fix for the \
              other faults: only the author knows what was meant.",
        references: &["The book of shadercheck, page on lint: suppressions"],
        ja: Japanese {
            summary: "shadercheck へのコメントが読み取れない、または存在しない規則を指定している",
            what: "`shadercheck:` で始まり、`ignore[コード, …] 理由` または `ignore-file[コード, …] 理由` の形になっていない\
                   コメントを報告します。別の単語、角括弧の中のコードがない、括弧が閉じていない、規則にないコード、コードの代わりに\
                   規則の名前が書かれている場合です。",
            why: "このコメントには効果がありませんが、書いた人は効いていると思っています。後から現れる指摘まで隠さないように、\
                  コードの指定は必須です。",
            fix: "規則の名前をコードに書き換えます。コメントの中なので safe です。それ以外の誤りは、意図が作者にしか分からない\
                  ため自動修正はありません。",
        },
    },
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
                "write `ignore[CODE] reason`, or remove the comment",
                "`ignore[コード] 理由` と書くか、コメントを削除します"
            ),
        ),
        Cause::UnknownWord(word) => (
            message!("`{word}` is nothing that shadercheck can be told", "`{word}` という指示はありません"),
            message!(
                "write `ignore[CODE] reason` or `ignore-file[CODE] reason`",
                "`ignore[コード] 理由` または `ignore-file[コード] 理由` と書きます"
            ),
        ),
        Cause::NoCodes(word) => (
            message!(
                "`{word}` names no code, so that nothing is silenced",
                "`{word}` にコードがないため、何も抑止されません"
            ),
            message!(
                "name the codes in brackets: `{word}[N014] reason`",
                "コードを角括弧で指定します: `{word}[N014] 理由`"
            ),
        ),
        Cause::Unclosed => (
            message!("the list of codes is not closed", "コードの一覧が閉じていません"),
            message!("write `]` behind the last code", "最後のコードの後に `]` を書きます"),
        ),
        Cause::UnknownCode { given, nearest } if nearest.is_empty() => (
            message!("no rule has the code `{given}`", "コード `{given}` の規則はありません"),
            message!("`shadercheck explain` lists all codes", "`shadercheck explain` で全てのコードを確認できます"),
        ),
        Cause::UnknownCode { given, nearest } => {
            let nearest = nearest.join(", ");
            (
                message!("no rule has the code `{given}`", "コード `{given}` の規則はありません"),
                message!(
                    "did you mean {nearest}? `shadercheck explain` lists all codes",
                    "{nearest} のことですか？`shadercheck explain` で全てのコードを確認できます"
                ),
            )
        }
        Cause::NameOfRule { given, code } => (
            message!(
                "`{given}` is the name of a rule; its code is {code}",
                "`{given}` は規則の名前で、コードは {code} です"
            ),
            message!("write the code", "コードで指定します"),
        ),
    };
    let found = findings
        .at(file, fault.span, message)
        .with_label(message!("not understood", "解釈できません"))
        .with_why(message!("the comment has no effect here", "ここではコメントの効果がありません"))
        .with_help(help);
    findings.push(match &fault.cause {
        Cause::NameOfRule { code, .. } => found.with_fix(
            message!("write {code}", "{code} と書く"),
            Safety::Safe,
            vec![Edit::replace(fault.span, *code)],
        ),
        Cause::UnknownWord(_) | Cause::NoCodes(_) | Cause::Unclosed | Cause::UnknownCode { .. } => found,
    });
}
