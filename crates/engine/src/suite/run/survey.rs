//! What the survey of a run warns of.

use super::{Finding, FindingKind, Report};
use judge::verdict::Survey;

/// Invocations of the first batch that are surveyed.
pub(super) const MOST: usize = 2048;

/// Adds the warnings of a run's survey to its findings.
pub(super) fn warn(report: &mut Report) {
    let Some(survey) = &report.survey else { return };
    let new: Vec<Finding> = [quality(survey), vacuous_bound(survey)].into_iter().flatten().collect();
    report.findings.extend(new);
}

/// The lane is worse than its device was when it was measured, and keeps what its API promises.
fn quality(survey: &Survey) -> Option<Finding> {
    let (worst, measured) = (survey.worst_beyond.as_ref()?, survey.measured.as_ref()?);
    let vertex = worst.vertex.map_or_else(String::new, |vertex| format!(" of vertex {vertex}"));
    let message = format!(
        "outside measured, inside promise: `{}`{vertex} is off by {:.1e}, and `{}` allows {:.1e}; {} of {} samples are \
         like that",
        worst.component, worst.error, measured.profile, worst.bound, survey.beyond, survey.invocations
    );
    Some(Finding { kind: FindingKind::Quality, message, case: None, count: survey.beyond, reproduce: None })
}

/// The bounds are so wide that hardly anything would be outside. Where every word came as it is in real numbers, the
/// output is one that no rounding touches, and says nothing about bounds.
fn vacuous_bound(survey: &Survey) -> Option<Finding> {
    let tightest = survey.tightest();
    let worst = tightest.worst.as_ref().filter(|worst| worst.error > 0.0 && tightest.is_vacuous())?;
    let remedy = match survey.measured {
        Some(_) => "the profile may be of another device",
        None => "measure the device with `shadercheck calibrate`, and give the profile to --profile",
    };
    let message = format!(
        "bounds by `{}` are too wide to test much: the largest error of {} words is {:.1e} of its bound, at `{}`; {remedy}",
        tightest.profile,
        tightest.words,
        worst.ratio(),
        worst.component
    );
    Some(Finding { kind: FindingKind::VacuousBound, message, case: None, count: 0, reproduce: None })
}
