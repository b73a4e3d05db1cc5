//! All rules. A rule is one file and one line here.

use super::rule::Rule;
use super::{glsl, host, program, suppress};

/// All rules, sorted by code.
pub const RULES: &[&Rule] = &[
    &glsl::d001::RULE,
    &glsl::d002::RULE,
    &glsl::d003::RULE,
    &glsl::d004::RULE,
    &glsl::d005::RULE,
    &glsl::d006::RULE,
    &glsl::d007::RULE,
    &glsl::d008::RULE,
    &glsl::d009::RULE,
    &glsl::d010::RULE,
    &glsl::d011::RULE,
    &glsl::d015::RULE,
    &glsl::d016::RULE,
    &glsl::d017::RULE,
    &glsl::d018::RULE,
    &glsl::g001::RULE,
    &glsl::g002::RULE,
    &glsl::g003::RULE,
    &glsl::g004::RULE,
    &glsl::g005::RULE,
    &glsl::g006::RULE,
    &glsl::g007::RULE,
    &glsl::g008::RULE,
    &glsl::g009::RULE,
    &glsl::g010::RULE,
    &host::h001::RULE,
    &host::h002::RULE,
    &host::h003::RULE,
    &host::h004::RULE,
    &host::h005::RULE,
    &host::h006::RULE,
    &host::h007::RULE,
    &host::h008::RULE,
    &host::h009::RULE,
    &host::h010::RULE,
    &host::h011::RULE,
    &host::h013::RULE,
    &host::h014::RULE,
    &host::h015::RULE,
    &host::h016::RULE,
    &host::h019::RULE,
    &host::h021::RULE,
    &host::h022::RULE,
    &host::h023::RULE,
    &host::h029::RULE,
    &host::h030::RULE,
    &program::i001::RULE,
    &program::i002::RULE,
    &program::i003::RULE,
    &program::i004::RULE,
    &glsl::i005::RULE,
    &program::i006::RULE,
    &program::i007::RULE,
    &program::i008::RULE,
    &program::i009::RULE,
    &glsl::n001::RULE,
    &glsl::n002::RULE,
    &glsl::n003::RULE,
    &glsl::n004::RULE,
    &glsl::n005::RULE,
    &glsl::n006::RULE,
    &glsl::n007::RULE,
    &glsl::n008::RULE,
    &glsl::n009::RULE,
    &glsl::n010::RULE,
    &glsl::n011::RULE,
    &glsl::n012::RULE,
    &glsl::n013::RULE,
    &glsl::n014::RULE,
    &glsl::n015::RULE,
    &glsl::n018::RULE,
    &glsl::n019::RULE,
    &glsl::n022::RULE,
    &glsl::p001::RULE,
    &glsl::p002::RULE,
    &glsl::p003::RULE,
    &glsl::t001::RULE,
    &glsl::t002::RULE,
    &glsl::t003::RULE,
    &glsl::t004::RULE,
    &glsl::t005::RULE,
    &glsl::t006::RULE,
    &glsl::t007::RULE,
    &glsl::t008::RULE,
    &glsl::t009::RULE,
    &glsl::t010::RULE,
    &glsl::t011::RULE,
    &glsl::t012::RULE,
    &glsl::t013::RULE,
    &glsl::t014::RULE,
    &glsl::t015::RULE,
    &glsl::t016::RULE,
    &glsl::t017::RULE,
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
    &suppress::x001::RULE,
    &suppress::x002::RULE,
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
    use crate::Input;
    use crate::tests::at_its_level;
    use base::diagnostic::Diagnostic;
    use base::text::SourceFile;

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
        let mut wrong = Vec::new();
        for rule in RULES {
            let lint = |files: &[crate::Example]| {
                let inputs: Vec<Input> = files.iter().map(|f| Input::new(SourceFile::new(f.name, f.text))).collect();
                at_its_level(rule, &inputs)
            };
            let told = |found: &[Diagnostic]| -> Vec<String> {
                found.iter().map(|d| format!("{} {}: {}", d.code, d.file.locate(d.span.start), d.message)).collect()
            };
            let bad = lint(rule.page.bad);
            match bad.as_slice() {
                [one] if one.code == rule.code => {
                    let advice = one.fix.as_ref().map(|f| &f.title).or(one.help.as_ref());
                    let words = [Some(&one.message), one.why.as_ref(), advice];
                    let complete = words.iter().all(|w| w.is_some_and(|w| !w.is_empty() && w.is_translated()));
                    let label = one.label.is_empty() || one.label.is_translated();
                    let related = one.related.iter().all(|l| l.message.is_empty() || l.message.is_translated());
                    if one.severity != rule.severity || !complete || !label || !related {
                        wrong.push(format!("{}: words or severity: {one:#?}", rule.code));
                    }
                }
                _ => wrong.push(format!("bad example of {}: {:#?}", rule.code, told(&bad))),
            }
            let good = lint(rule.page.good);
            if !good.is_empty() {
                wrong.push(format!("good example of {}: {:#?}", rule.code, told(&good)));
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
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
