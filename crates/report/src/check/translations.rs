//! What a run has to say about translations.

use std::fmt::Write as _;

use serde_json::{Value, json};

use engine::suite::run::{Outcome, Summary, Translated};
use program::Language;

/// Lines for people: in one line the languages that agree, then what is left open. Deviations are
/// findings, and told as such.
pub(super) fn notes(summary: &Summary) -> String {
    let reports = summary.entries.iter().filter_map(|entry| match &entry.outcome {
        Outcome::Ran(report) => Some((report.suite.as_str(), &report.translations[..])),
        Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => None,
    });
    lines(&reports.collect::<Vec<_>>())
}

fn lines(suites: &[(&str, &[Translated])]) -> String {
    // Languages, with samples and suites on which they agree, in the order in which they turn up.
    let mut agreeing: Vec<(Vec<&str>, u64, u64)> = Vec::new();
    let mut open: Vec<Open<'_>> = Vec::new();
    let mut counts: Vec<(&str, u64, u64)> = Vec::new();
    // Texts that naga's GLSL reader refuses, with the first reason.
    let mut refused: Vec<(&str, &str)> = Vec::new();
    for (suite, translations) in suites {
        let mut own: Vec<Open<'_>> = Vec::new();
        for translated in *translations {
            if translated.language == Language::NagaGlsl {
                refused.extend(translated.unsupported.as_deref().map(|why| (*suite, why)));
                continue;
            }
            let language = translated.language.name();
            if let Some(why) = &translated.unsupported {
                Open::add(&mut own, suite, language, What::NotCompared(why), 0);
            }
            if translated.undetermined > 0 {
                Open::add(&mut own, suite, language, What::Differs, translated.undetermined);
            }
            if translated.agreed == 0 || translated.deviated > 0 {
                continue;
            }
            match counts.iter_mut().find(|(known, ..)| *known == language) {
                Some((_, samples, suites)) => (*samples, *suites) = (*samples + translated.agreed, *suites + 1),
                None => counts.push((language, translated.agreed, 1)),
            }
        }
        own.into_iter().for_each(|own| own.join(&mut open));
    }
    for (language, samples, suites) in counts {
        match agreeing.iter_mut().find(|(_, known, of)| (*known, *of) == (samples, suites)) {
            Some((languages, ..)) => languages.push(language),
            None => agreeing.push((vec![language], samples, suites)),
        }
    }
    let mut text = String::new();
    for (languages, samples, suites) in agreeing {
        let many = if suites == 1 { "suite" } else { "suites" };
        let languages = languages.join(", ");
        let _ = writeln!(
            text,
            "note: translations agree with the shader: {languages} ({samples} samples, {suites} {many})"
        );
    }
    open.iter().for_each(|open| text.push_str(&open.line()));
    if let [(_, why), ..] = refused[..] {
        let names: Vec<&str> = refused.iter().map(|(suite, _)| *suite).collect();
        let _ = writeln!(text, "note: {}: naga's reading was not compared: {why}", names.join(", "));
    }
    text
}

/// What is left open of some translations.
#[derive(Clone, Copy, PartialEq, Eq)]
enum What<'a> {
    /// They were not compared, for this reason.
    NotCompared(&'a str),
    /// They differ where the shader has no meaning to keep.
    Differs,
}

/// Suites and languages of which the same is left open.
struct Open<'a> {
    suites: Vec<&'a str>,
    languages: Vec<&'a str>,
    what: What<'a>,
    samples: u64,
}

impl<'a> Open<'a> {
    /// Adds a language of a suite.
    fn add(own: &mut Vec<Self>, suite: &'a str, language: &'a str, what: What<'a>, samples: u64) {
        match own.iter_mut().find(|known| known.what == what) {
            Some(known) => {
                known.languages.push(language);
                known.samples += samples;
            }
            None => own.push(Self { suites: vec![suite], languages: vec![language], what, samples }),
        }
    }

    /// Joins what is the same of the same languages in other suites.
    fn join(self, all: &mut Vec<Self>) {
        match all.iter_mut().find(|known| known.what == self.what && known.languages == self.languages) {
            Some(known) => {
                known.suites.extend(self.suites);
                known.samples += self.samples;
            }
            None => all.push(self),
        }
    }

    fn line(&self) -> String {
        let one = self.languages.len() == 1;
        let (word, verb, were) =
            if one { ("translation", "differs", "was") } else { ("translations", "differ", "were") };
        let what = match self.what {
            What::NotCompared(why) => format!("{were} not compared: {why}"),
            What::Differs => {
                format!("{verb} on {} samples where the shader leaves the range of a type", self.samples)
            }
        };
        format!("note: {}: the {} {word} {what}\n", self.suites.join(", "), self.languages.join(", "))
    }
}

/// The same for programs.
pub(super) fn json(translations: &[Translated]) -> Value {
    let one = |translated: &Translated| {
        json!({
            "language": translated.language.name(),
            "agreed": translated.agreed,
            "deviated": translated.deviated,
            "undetermined": translated.undetermined,
            "unsupported": translated.unsupported,
        })
    };
    translations.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::{json, lines};
    use engine::suite::run::Translated;
    use program::Language;

    fn agrees(language: Language, agreed: u64) -> Translated {
        Translated { language, agreed, deviated: 0, undetermined: 0, unsupported: None }
    }

    #[test]
    fn languages_that_agree_alike_share_a_line() {
        use Language::{Glsl450, SpirV, Wgsl};
        let a = [agrees(SpirV, 10), agrees(Wgsl, 10), agrees(Glsl450, 10)];
        let unsupported = Some("no `mat2` in blocks".to_owned());
        let b = [agrees(SpirV, 5), agrees(Wgsl, 5), Translated { agreed: 0, unsupported, ..agrees(Glsl450, 0) }];
        assert_eq!(
            lines(&[("a", &a), ("b", &b), ("a", &[])]),
            "note: translations agree with the shader: spirv, wgsl (15 samples, 2 suites)\n\
             note: translations agree with the shader: glsl450 (10 samples, 1 suite)\n\
             note: b: the glsl450 translation was not compared: no `mat2` in blocks\n"
        );
    }

    #[test]
    fn what_several_translations_share_is_one_line() {
        use Language::{Glsl450, SpirV, Wgsl};
        let none = |language| Translated { unsupported: Some("discards".to_owned()), ..agrees(language, 0) };
        let all = [none(SpirV), none(Wgsl), none(Glsl450)];
        let line = "note: a, b: the spirv, wgsl, glsl450 translations were not compared: discards\n";
        assert_eq!(lines(&[("a", &all), ("b", &all)]), line);
        // Another language alone is another line.
        assert_eq!(lines(&[("a", &all), ("b", &all[..1])]).lines().count(), 2);
    }

    #[test]
    fn what_nagas_reader_refuses_is_one_line_and_what_it_reads_is_none() {
        use Language::{NagaGlsl, SpirV};
        let why = Some("naga's GLSL reader refuses the text".to_owned());
        let refused = [Translated { unsupported: why, ..agrees(NagaGlsl, 0) }];
        let agree = "note: translations agree with the shader: spirv (5 samples, 1 suite)\n";
        assert_eq!(
            lines(&[("a", &refused), ("b", &[agrees(SpirV, 5), agrees(NagaGlsl, 5)]), ("c", &refused)]),
            format!("{agree}note: a, c: naga's reading was not compared: naga's GLSL reader refuses the text\n")
        );
    }

    #[test]
    fn what_deviates_or_is_open_is_not_said_to_agree() {
        let deviates = Translated { deviated: 1, ..agrees(Language::Wgsl, 9) };
        assert_eq!(lines(&[("a", &[deviates])]), "");
        let open = Translated { undetermined: 3, ..agrees(Language::SpirV, 0) };
        let text = lines(&[("a", &[open])]);
        assert!(text.starts_with("note: a: the spirv translation differs on 3 samples") && !text.contains("agree"));
    }

    #[test]
    fn every_count_is_in_the_json() {
        let one = Translated { deviated: 2, undetermined: 3, ..agrees(Language::Glsl450, 1) };
        let value = json(&[one]);
        assert_eq!(
            value,
            serde_json::json!([
                {"language": "glsl450", "agreed": 1, "deviated": 2, "undetermined": 3, "unsupported": null}
            ])
        );
    }
}
