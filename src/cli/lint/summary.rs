//! What is said when all is done, in both languages.

use base::diagnostic::{Diagnostic, Lang, Safety, Severity, message};
use base::text::counted;
use lint::Input;

/// `1 finding` or `2 findings`.
fn findings(n: usize) -> String {
    plural(n, "finding")
}

/// `1 file` or `2 files`.
fn files(n: usize) -> String {
    plural(n, "file")
}

fn plural(n: usize, word: &str) -> String {
    counted(n as u64, word)
}

/// How many repairs a patch holds.
pub fn would_fix(applied: usize, changed: usize, lang: Lang) -> String {
    let (found, within) = (findings(applied), files(changed));
    let text =
        message!("{found} in {within} would be fixed", "{changed} 個のファイルの {applied} 件の指摘を修正できます");
    text.in_lang(lang).to_owned()
}

/// How many repairs were written.
pub fn fixed(applied: usize, changed: usize, written: usize, lang: Lang) -> String {
    let (found, within, kept) = (findings(applied), files(changed), changed - written);
    let text = if kept == 0 {
        message!("fixed {found} in {within}", "{changed} 個のファイルの {applied} 件の指摘を修正しました")
    } else {
        message!(
            "found a fix for {found} in {within}; {kept} could not be written",
            "{changed} 個のファイルに {applied} 件の修正があります。そのうち {kept} 個は書き込めませんでした"
        )
    };
    text.in_lang(lang).to_owned()
}

/// How many findings a baseline took.
pub fn recorded(count: usize, path: &str, lang: Lang) -> String {
    let found = findings(count);
    message!("{found} recorded in {path}", "{count} 件の指摘を {path} に記録しました").in_lang(lang).to_owned()
}

/// How many findings a baseline knew.
pub fn known(count: usize, lang: Lang) -> String {
    let found = findings(count);
    let verb = if count == 1 { "is" } else { "are" };
    message!("{found} {verb} known from the baseline", "{count} 件の指摘はベースラインにあります")
        .in_lang(lang)
        .to_owned()
}

/// What the baseline knows and is gone.
pub fn stale(rule: &str, file: &str, line: &str, count: usize, lang: Lang) -> String {
    let times = if count == 1 { String::new() } else { format!(" ({count})") };
    let rule = lint::with_name(rule);
    let text = message!(
        "no longer found: {rule} in {file}{times}: {line}",
        "すでに見つからない指摘: {file} の {rule}{times}: {line}"
    );
    text.in_lang(lang).to_owned()
}

/// What to do about entries that are gone.
pub fn prune_hint(lang: Lang) -> String {
    message!("--prune-baseline removes them from the file", "--prune-baseline で記録から取り除けます")
        .in_lang(lang)
        .to_owned()
}

/// Totals, line by line: how much was looked at, what was found, what could be fixed.
pub fn totals(found: &[Diagnostic], inputs: &[Input], lang: Lang) -> Vec<String> {
    let count = |severity| found.iter().filter(|d| d.severity == severity).count();
    let looked_at = inputs.iter().filter(|i| i.reported).count();
    let (errors, warnings, infos) = (count(Severity::Error), count(Severity::Warning), count(Severity::Info));
    let (files, error_words, warning_words) = (files(looked_at), plural(errors, "error"), plural(warnings, "warning"));
    let mut lines = vec![message!(
        "{files}: {error_words}, {warning_words}, {infos} info",
        "{looked_at} 個のファイル: エラー {errors} 件、警告 {warnings} 件、情報 {infos} 件"
    )];
    let fixable = |s| found.iter().filter(|d| d.fix.as_ref().is_some_and(|f| f.safety == s)).count();
    let (safe, risky) = (fixable(Safety::Safe), fixable(Safety::Unsafe));
    if safe > 0 {
        let found = findings(safe);
        lines.push(message!("{found} can be fixed with --fix", "{safe} 件は --fix で修正できます"));
    }
    if risky > 0 && safe > 0 {
        let need = if risky == 1 { "needs" } else { "need" };
        lines.push(message!(
            "{risky} more {need} --fix --unsafe-fixes",
            "さらに {risky} 件は --fix --unsafe-fixes で修正できます"
        ));
    } else if risky > 0 {
        let found = findings(risky);
        lines.push(message!(
            "{found} can be fixed with --fix --unsafe-fixes",
            "{risky} 件は --fix --unsafe-fixes で修正できます"
        ));
    }
    lines.iter().map(|line| line.in_lang(lang).to_owned()).collect()
}

/// Findings from which on a summary names other ways to look at them.
const MANY: usize = 10;

/// What can be asked for next, after findings of a folder.
pub fn next(found: &[Diagnostic], info: bool, lang: Lang) -> Vec<String> {
    let infos = found.iter().filter(|d| d.severity == Severity::Info).count();
    let mut lines = Vec::new();
    if !info && infos > 0 {
        lines.push(message!("`--info` prints the {infos} info as well", "情報 {infos} 件は `--info` で表示します"));
    }
    if found.len() - infos > MANY {
        lines.push(message!(
            "`--statistics` counts by rule; `--write-baseline FILE` records what is there, so that only new findings are reported",
            "`--statistics` は規則ごとの件数、`--write-baseline FILE` は今ある指摘を記録し、以後は新しいものだけを示します"
        ));
    }
    lines.iter().map(|line| line.in_lang(lang).to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_in_both_languages() {
        assert_eq!(fixed(1, 1, 1, Lang::En), "fixed 1 finding in 1 file");
        assert_eq!(fixed(3, 2, 2, Lang::Ja), "2 個のファイルの 3 件の指摘を修正しました");
        assert!(fixed(3, 2, 1, Lang::En).ends_with("1 could not be written"));
        assert_eq!(totals(&[], &[], Lang::En), ["0 files: 0 errors, 0 warnings, 0 info"]);
        assert_eq!(totals(&[], &[], Lang::Ja), ["0 個のファイル: エラー 0 件、警告 0 件、情報 0 件"]);
    }
}
