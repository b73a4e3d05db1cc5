//! The translations of a suite's shader, and what naga's own GLSL reader makes of it, on samples of the suite.

use super::finding::{self, Finding, FindingKind};
use super::{Part, Prepared, Request};
use crate::activity;
use base::value::Batch;
use judge::verdict::{CompareError, Comparison, Translations, Unread};
use program::Language;
use property::shrink::{self, Domain};
use property::{Sample, Sampler};
use serde::{Deserialize, Serialize};

/// Samples on which translations are compared: they are compiled code, where a fault shows at once.
const SAMPLES: u64 = 2048;
/// Deviating samples that are shrunk; the rest is counted.
const SHRUNK: usize = 4;

/// What one translation of a shader, or naga's reading of it, means.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Translated {
    /// Language of the translation.
    pub language: Language,
    /// Samples on which it means what the shader means.
    pub agreed: u64,
    /// Samples on which it means something else.
    pub deviated: u64,
    /// Samples on which the two differ and the shader has no meaning to keep.
    pub undetermined: u64,
    /// Why it was not compared at all.
    pub unsupported: Option<String>,
}

/// Compares the translations of a suite's shader with the shader, and adds what came of it to a part.
pub fn check(prepared: &Prepared, request: &Request, part: &mut Part) {
    check_with(prepared, &Translations::of(&prepared.program), request, part);
}

/// Compares given translations with the shader, and adds what came of it to a part.
pub fn check_with(prepared: &Prepared, translations: &Translations, request: &Request, part: &mut Part) {
    for (language, why) in translations.unread() {
        match why {
            Unread::Unsupported(why) => unsupported(part, [language], why),
            Unread::Interface(reason) => {
                let message = match language {
                    Language::NagaGlsl => format!("naga's GLSL reader gives the shader another interface: {reason}"),
                    _ => format!("the {language} translation has another interface than the shader: {reason}"),
                };
                add(part, Finding { kind: FindingKind::Translation, message, case: None, count: 0, reproduce: None });
                unsupported(part, [language], reason);
            }
        }
    }
    if let Err(error) = compare(prepared, translations, request, part) {
        unsupported(part, Language::READABLE, &error.to_string());
    }
}

fn unsupported(part: &mut Part, languages: impl IntoIterator<Item = Language>, why: &str) {
    for language in languages {
        let unsupported = Some(why.to_owned());
        part.translations.push(Translated { language, agreed: 0, deviated: 0, undetermined: 0, unsupported });
    }
}

/// Findings stay sorted, worst first.
fn add(part: &mut Part, finding: Finding) {
    part.findings.push(finding);
    part.findings.sort_by_key(|finding| finding.kind);
}

fn compare(
    prepared: &Prepared,
    translations: &Translations,
    request: &Request,
    part: &mut Part,
) -> Result<(), CompareError> {
    let mut batches = Vec::new();
    if !request.replay.is_empty() {
        batches.push(Sample::batch(&request.replay));
    }
    if !request.replay_only && !prepared.plan.makes_samples() && !prepared.rows.is_empty() {
        batches.push(Sample::batch(&prepared.rows[..prepared.rows.len().min(SAMPLES as usize)]));
    } else if !request.replay_only {
        let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
        let cases = request.samples_of(&prepared.suite).min(SAMPLES).div_ceil(per_case as u64);
        batches.push(Sampler::new(prepared.plan.clone(), request.seed).batch(0, cases as usize, per_case));
    }
    let mut all: Vec<(Translated, Vec<Sample>)> = Vec::new();
    for batch in &batches {
        for comparison in translations.compare(batch)? {
            let at =
                all.iter().position(|(reported, _)| reported.language == comparison.language).unwrap_or_else(|| {
                    let language = comparison.language;
                    let none = Translated { language, agreed: 0, deviated: 0, undetermined: 0, unsupported: None };
                    all.push((none, Vec::new()));
                    all.len() - 1
                });
            let (reported, failing) = &mut all[at];
            reported.agreed += comparison.agreed;
            reported.deviated += comparison.deviating.len() as u64;
            reported.undetermined += comparison.undetermined;
            failing.extend(samples(batch, &comparison, SHRUNK - failing.len().min(SHRUNK)));
        }
    }
    for (reported, failing) in all {
        let (language, count) = (reported.language, reported.deviated);
        part.translations.push(reported);
        if !failing.is_empty() {
            fail(prepared, translations, language, failing, count, request, part)?;
        }
    }
    part.translations.sort_by_key(|reported| reported.language);
    Ok(())
}

fn samples(batch: &Batch, comparison: &Comparison, most: usize) -> Vec<Sample> {
    comparison.deviating.iter().take(most).map(|&invocation| Sample::of(batch, invocation)).collect()
}

/// Shrinks deviating samples and reports the simplest.
fn fail(
    prepared: &Prepared,
    translations: &Translations,
    language: Language,
    failing: Vec<Sample>,
    count: u64,
    request: &Request,
    part: &mut Part,
) -> Result<(), CompareError> {
    let mut oracle = |samples: &[Sample]| translations.deviates(language, &Sample::batch(samples));
    let shrunk = if request.replay_only {
        finding::as_given(failing)
    } else {
        activity::shrink(failing, &*prepared.plan, &mut oracle)?
    };
    let size = |sample: &Sample| shrink::complexity(sample, &Domain::simplest(&*prepared.plan, sample));
    let Some(simplest) = shrunk.into_iter().min_by_key(|shrunk| size(&shrunk.sample)) else { return Ok(()) };
    let batch = Sample::batch(std::slice::from_ref(&simplest.sample));
    let compared = translations.compare(&batch)?;
    let deviation = compared.into_iter().find(|c| c.language == language).and_then(|c| c.first);
    let finding = Finding {
        kind: FindingKind::Translation,
        message: deviation.map_or_else(
            // Not to be reached: a shrunk sample deviates.
            || format!("{language}: another meaning than the shader's"),
            |deviation| deviation.to_string(),
        ),
        count,
        reproduce: Some(finding::reproduce(request, part.on(), &simplest.sample)),
        case: Some(finding::case(&prepared.program, &simplest, None)),
    };
    add(part, finding);
    part.failing.push(simplest.sample);
    Ok(())
}
