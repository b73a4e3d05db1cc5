//! Findings of many files for people: one excerpt for each rule and cause, with the places of the others, and counts.

use std::collections::BTreeMap;
use std::fmt::Write;

use base::diagnostic::{Diagnostic, Lang, Severity, message};
use base::text::counted;
use lint::with_name;

use crate::diagnostics;

use super::Context;

/// Places that are listed below an excerpt.
const MOST_PLACES: usize = 5;

/// Findings of one rule that say the same of other names.
struct Cause<'d> {
    first: &'d Diagnostic,
    others: Vec<&'d Diagnostic>,
}

/// One excerpt for each rule and cause, the worst first, and below it where else it was found. `info` is left out unless
/// it is asked for.
pub fn write(found: &[Diagnostic], info: bool, context: &Context) -> String {
    let shown = found.iter().filter(|d| info || d.severity > Severity::Info);
    let mut causes: Vec<Cause<'_>> = Vec::new();
    let mut known: BTreeMap<(&str, Severity, String), usize> = BTreeMap::new();
    for diagnostic in shown {
        let key = (diagnostic.code.0, diagnostic.severity, without_names(diagnostic.message.in_lang(Lang::En)));
        match known.get(&key) {
            Some(&at) => causes[at].others.push(diagnostic),
            None => {
                known.insert(key, causes.len());
                causes.push(Cause { first: diagnostic, others: Vec::new() });
            }
        }
    }
    // The order of the files stays where two are as bad.
    causes.sort_by_key(|cause| std::cmp::Reverse(cause.first.severity));
    let mut out = String::new();
    for Cause { first, others } in causes {
        // Writing into a String does not fail.
        let text = diagnostics::text(first, context.lang, context.color);
        let _ = writeln!(out, "{}", text.trim_end_matches('\n'));
        also(&mut out, first, &others, context);
        out.push('\n');
    }
    out
}

/// The places of the other findings of a cause, each with the name that it has in the place of the first one's.
fn also(out: &mut String, first: &Diagnostic, others: &[&Diagnostic], context: &Context) {
    let mut label = message!("also at", "他の場所").in_lang(context.lang).to_owned();
    let width = label.chars().map(|c| if c.is_ascii() { 1 } else { 2 }).sum();
    for other in others.iter().take(MOST_PLACES) {
        let [names, of_first] = [other, first].map(|one| one.message.in_lang(context.lang).split('`'));
        let own = names.zip(of_first).skip(1).step_by(2).find(|(name, of_first)| name != of_first);
        let own = own.map_or_else(String::new, |(name, _)| format!(": `{name}`"));
        let _ = writeln!(out, "  {label} {}{own}", other.file.locate(other.span.start));
        label = " ".repeat(width);
    }
    let (more, code) = (others.len().saturating_sub(MOST_PLACES), others.first().map_or("", |other| other.code.0));
    if more > 0 {
        let places = counted(more as u64, "more place");
        let list = message!(
            "and {places}; `--select {code} --format concise` lists them all",
            "ほか {more} 箇所。`--select {code} --format concise` で全部を表示します"
        );
        let _ = writeln!(out, "  {label} {}", list.in_lang(context.lang));
    }
}

/// A message with the names in it left out: what stays says the cause.
fn without_names(message: &str) -> String {
    message.split('`').enumerate().map(|(k, part)| if k % 2 == 0 { part } else { "`" }).collect()
}

/// How often each rule was told, the most frequent first.
pub fn statistics(found: &[Diagnostic]) -> String {
    let mut counts: BTreeMap<(&str, Severity), (usize, usize)> = BTreeMap::new();
    for diagnostic in found {
        let (all, fixable) = counts.entry((diagnostic.code.0, diagnostic.severity)).or_default();
        *all += 1;
        *fixable += usize::from(diagnostic.fix.is_some());
    }
    let mut rows: Vec<_> = counts.into_iter().collect();
    rows.sort_by_key(|((_, severity), (all, _))| (std::cmp::Reverse(*all), std::cmp::Reverse(*severity)));
    rows.iter().fold(String::new(), |mut out, ((code, severity), (all, fixable))| {
        let fixes = if *fixable > 0 { format!("  ({fixable} with a fix)") } else { String::new() };
        let _ = writeln!(out, "{all:>7}  {:<7}  {}{fixes}", severity.name(), with_name(code));
        out
    })
}

#[cfg(test)]
mod tests {
    use base::diagnostic::Code;
    use base::text::{SourceFile, Span};

    use super::*;

    fn finding(file: &str, code: &'static str, severity: Severity, text: &str) -> Diagnostic {
        Diagnostic::new(Code(code), severity, &SourceFile::new(file, "int a;\nint b;\n"), Span::new(11, 12), text)
    }

    #[test]
    fn one_cause_is_one_excerpt_and_a_worse_one_goes_first() {
        let mut found = vec![finding("a.vert", "D006", Severity::Warning, "`a` is not used")];
        found.extend((0..8).map(|k| finding(&format!("b{k}.vert"), "D006", Severity::Warning, "`b` is not used")));
        found.push(finding("a.vert", "T001", Severity::Error, "`c` has 4 components"));
        found.push(finding("a.vert", "T001", Severity::Error, "`c` has no components"));
        found.push(finding("a.vert", "N014", Severity::Info, "`3.14` is rounded"));
        let text = write(&found, false, &Context::default());
        let titles: Vec<&str> = text.lines().filter(|line| line.contains('[')).collect();
        assert_eq!(titles.len(), 3, "{text}");
        assert!(titles[0].starts_with("error[T001") && titles[2].starts_with("warning[D006"), "{text}");
        assert!(text.contains("  also at b0.vert:2:5: `b`\n          b1.vert:2:5: `b`\n"), "{text}");
        assert!(text.contains("and 3 more places; `--select D006 --format concise` lists them all"), "{text}");
        assert!(write(&found, true, &Context::default()).contains("info[N014"));
        let statistics = statistics(&found);
        assert!(statistics.starts_with("      9  warning  D006 unused-variable\n      2  error "), "{statistics}");
    }
}
