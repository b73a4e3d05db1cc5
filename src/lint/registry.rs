//! All rules. A rule is one file and one line here.

use super::rule::Rule;
use super::{glsl, host};

/// All rules, sorted by code.
pub const RULES: &[&Rule] = &[
    &glsl::g002::RULE,
    &glsl::g007::RULE,
    &glsl::g008::RULE,
    &glsl::g009::RULE,
    &host::h001::RULE,
    &host::h002::RULE,
    &host::h003::RULE,
    &host::h004::RULE,
    &host::h029::RULE,
    &host::h030::RULE,
    &glsl::n014::RULE,
    &glsl::t001::RULE,
    &glsl::t002::RULE,
    &glsl::t003::RULE,
    &glsl::t004::RULE,
    &glsl::t008::RULE,
    &glsl::t009::RULE,
    &glsl::t010::RULE,
    &glsl::t012::RULE,
    &glsl::t016::RULE,
    &glsl::t018::RULE,
    &glsl::v001::RULE,
    &glsl::v002::RULE,
    &glsl::v003::RULE,
    &glsl::v004::RULE,
    &glsl::v005::RULE,
    &glsl::v006::RULE,
    &glsl::v007::RULE,
    &glsl::v008::RULE,
    &glsl::v009::RULE,
    &glsl::v010::RULE,
];

/// The rule with this code or name; letters may be small or capital.
pub fn by_code(given: &str) -> Option<&'static Rule> {
    RULES.iter().copied().find(|r| r.code.0.eq_ignore_ascii_case(given) || r.name.eq_ignore_ascii_case(given))
}

/// Up to three codes that look most like `given`, or whose names do.
pub fn nearest_codes(given: &str) -> Vec<&'static str> {
    let mut scored: Vec<(f64, &'static str)> = RULES
        .iter()
        .map(|r| {
            let code = strsim::normalized_damerau_levenshtein(&given.to_ascii_uppercase(), r.code.0);
            let name = strsim::normalized_damerau_levenshtein(&given.to_ascii_lowercase(), r.name);
            (code.max(name), r.code.0)
        })
        .filter(|&(score, _)| score >= 0.5)
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    scored.into_iter().take(3).map(|(_, code)| code).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::lint::{Input, Level, Selection, Settings, run_with};
    use crate::text::SourceFile;

    #[test]
    fn codes_and_names_are_unique_and_sorted() {
        assert!(RULES.windows(2).all(|w| w[0].code < w[1].code));
        let names: BTreeSet<_> = RULES.iter().map(|r| r.name).collect();
        assert_eq!(names.len(), RULES.len());
    }

    #[test]
    fn every_rule_has_all_its_parts() {
        for rule in RULES {
            let code = rule.code.0;
            let digits = code.strip_prefix(|c: char| c.is_ascii_uppercase()).unwrap_or("");
            assert!(digits.len() == 3 && digits.bytes().all(|b| b.is_ascii_digit()), "{code}");
            assert!(rule.name.contains('-'), "{code}: {}", rule.name);
            assert!(rule.name.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "{code}: {}", rule.name);
            for (part, text) in [("summary", rule.summary), ("what", rule.page.what), ("why", rule.page.why)] {
                assert!(text.len() > 20, "{code}: {part} is too short to be one");
            }
            assert!(!rule.summary.ends_with('.') && !rule.summary.contains('\n'), "{code}: summary is one line");
            let fix = rule.page.fix.to_lowercase();
            assert!(["safe", "unsafe", "no fix"].iter().any(|w| fix.contains(w)), "{code}: the fix states its safety");
            let japanese = |text: &str| text.chars().any(|c| ('\u{3040}'..='\u{30ff}').contains(&c));
            let ja = &rule.page.ja;
            for (part, text) in [("summary", ja.summary), ("what", ja.what), ("why", ja.why), ("fix", ja.fix)] {
                assert!(japanese(text), "{code}: {part} in Japanese");
            }
            assert!(!rule.page.references.is_empty(), "{code}: no reference");
            assert!(!rule.page.bad.is_empty() && !rule.page.good.is_empty(), "{code}: no example");
        }
    }

    #[test]
    fn every_bad_example_reports_its_rule_alone_and_every_good_one_is_clean() {
        for rule in RULES {
            let lint = |files: &[crate::lint::Example]| {
                let inputs: Vec<Input> = files.iter().map(|f| Input::new(SourceFile::new(f.name, f.text))).collect();
                // The rule at its level, beside the rules that always run.
                let settings = Settings { selection: Selection::default().at(rule.level), ..Settings::default() };
                let mut found = run_with(&inputs, &settings);
                found.retain(|d| {
                    d.code == rule.code || by_code(d.code.0).is_none_or(|other| other.level == Level::Default)
                });
                found
            };
            let bad = lint(rule.page.bad);
            let codes: Vec<&str> = bad.iter().map(|d| d.code.0).collect();
            assert_eq!(codes, [rule.code.0], "bad example of {}: {bad:#?}", rule.code);
            assert_eq!(bad[0].severity, rule.severity);
            assert!(bad[0].why.is_some(), "{} explains itself", rule.code);
            assert!(bad[0].fix.is_some() || bad[0].help.is_some(), "{} says what to do", rule.code);
            let good = lint(rule.page.good);
            assert!(good.is_empty(), "good example of {}: {good:#?}", rule.code);
        }
    }

    #[test]
    fn rules_are_found_by_code_and_name() {
        assert_eq!(by_code("t001").map(|r| r.code.0), Some("T001"));
        assert_eq!(by_code("low-precision-pi").map(|r| r.code.0), Some("N014"));
        assert!(by_code("T999").is_none());
        assert_eq!(nearest_codes("T01").first(), Some(&"T001"));
        assert!(nearest_codes("zzzzzzzz").is_empty());
    }
}
