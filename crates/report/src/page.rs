//! The page of a rule as Markdown.

use std::fmt::Write;

use base::diagnostic::Lang;
use lint::{Example, Rule};

/// The words of a page in one language.
pub struct Words {
    /// What the rule finds, in one line without a full stop.
    pub summary: &'static str,
    /// What it reports, and where it stays silent.
    pub what: &'static str,
    /// Why that is wrong.
    pub why: &'static str,
    /// What the fix does.
    pub fix: &'static str,
}

/// The words of a rule's page in a language.
pub fn words(rule: &Rule, lang: Lang) -> Words {
    let (page, ja) = (&rule.page, &rule.page.ja);
    match lang {
        Lang::En => Words { summary: rule.summary, what: page.what, why: page.why, fix: page.fix },
        Lang::Ja => Words { summary: ja.summary, what: ja.what, why: ja.why, fix: ja.fix },
    }
}

/// A rule's page as Markdown; `color` makes headings bold on a terminal.
pub fn markdown(rule: &Rule, lang: Lang, color: bool) -> String {
    let (on, off) = if color { ("\u{1b}[1m", "\u{1b}[0m") } else { ("", "") };
    let page = &rule.page;
    let words = words(rule, lang);
    let heading = |en: &'static str, ja: &'static str| if lang == Lang::Ja { ja } else { en };
    let mut out = String::new();
    // Writing into a String does not fail.
    let _ = writeln!(out, "{on}# {} {} ({}){off}\n", rule.code, rule.name, rule.severity.name());
    let _ = writeln!(out, "{}{}\n", words.summary, heading(".", "。"));
    let _ = writeln!(out, "{on}## {}{off}\n\n{}\n", heading("What", "内容"), words.what);
    let _ = writeln!(out, "{on}## {}{off}\n\n{}\n", heading("Why", "理由"), words.why);
    let _ = writeln!(out, "{on}## {}{off}\n", heading("Bad", "悪い例"));
    page.bad.iter().for_each(|e| example(e, &mut out));
    let _ = writeln!(out, "{on}## {}{off}\n", heading("Good", "良い例"));
    page.good.iter().for_each(|e| example(e, &mut out));
    let _ = writeln!(out, "{on}## {}{off}\n\n{}\n", heading("Fix", "修正"), words.fix);
    let _ = writeln!(out, "{on}## {}{off}\n", heading("References", "参考"));
    page.references.iter().for_each(|r| {
        let _ = writeln!(out, "- {r}");
    });
    out
}

fn example(example: &Example, out: &mut String) {
    let language = if example.name.ends_with(".cpp") { "cpp" } else { "glsl" };
    let _ = writeln!(out, "`{}`\n\n```{language}\n{}\n```\n", example.name, example.text.trim_end());
}
