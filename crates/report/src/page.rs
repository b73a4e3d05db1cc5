//! The page of a rule on a terminal.

use base::diagnostic::Lang;
use lint::Rule;

/// A rule's page as Markdown; `color` makes headings bold.
pub fn markdown(rule: &Rule, lang: Lang, color: bool) -> String {
    let page = rule.pages.markdown(lang);
    if !color {
        return page;
    }
    let mut fenced = false;
    let line = |line: &str| {
        fenced ^= line.starts_with("```");
        if line.starts_with('#') && !fenced { format!("\u{1b}[1m{line}\u{1b}[0m\n") } else { format!("{line}\n") }
    };
    page.lines().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lint::RULES;

    #[test]
    fn headings_are_bold_and_directives_of_examples_are_not() {
        let page = markdown(RULES[0], Lang::En, true);
        let title = format!("# {} {} ", RULES[0].code, RULES[0].name);
        assert!(
            page.starts_with(&format!("\u{1b}[1m{title}")) && page.contains("\n\u{1b}[1m## Why\u{1b}[0m\n"),
            "{page}"
        );
        assert!(page.contains("\n#version"), "{page}");
        assert_eq!(page.replace("\u{1b}[1m", "").replace("\u{1b}[0m", ""), markdown(RULES[0], Lang::En, false));
    }
}
