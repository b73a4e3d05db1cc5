//! The report for programs. Keys may be added, and are never renamed.

use serde_json::{Value, json};

use engine::suite::run::{
    Budget, Case, Doubtful, Entry, Expectation, Finding, LaneUsed, Outcome, Repeated, RunError, Standing, Status,
    Summary,
};
use judge::verdict::diagnosis::{Diagnosis, Origin, Place, Stand, Witness};
use judge::verdict::{Promise, Reason};
use lanes::Stage;
use program::InputSource;

/// The whole run as one JSON object, with a line break.
pub fn json(summary: &Summary) -> String {
    let status = match summary.status() {
        Status::Pass => "pass",
        Status::Fail | Status::Broken => "fail",
    };
    let totals = summary.totals();
    let lanes: Vec<Value> =
        summary.lanes.iter().flat_map(|used| used.description.stages.iter().map(|stage| lane(used, *stage))).collect();
    let unavailable: Vec<Value> = summary
        .unavailable
        .iter()
        .map(|(name, why)| json!({"name": name, "why": why.why, "remedy": why.remedy}))
        .collect();
    let mut value = json!({
        "status": status,
        "seed": summary.seed,
        "lanes": lanes,
        "unavailable": unavailable,
        "suites": summary.entries.iter().map(entry).collect::<Vec<_>>(),
        "totals": {
            "judged": totals.judged,
            "agreed": totals.agreed,
            "deviated": totals.deviated,
            "undetermined": totals.undetermined,
            "unsupported": totals.unsupported,
            "known_failures": summary.known().len(),
        },
        "stale_expectations": summary.stale,
    });
    let shortcomings: Vec<Value> =
        summary.shortcomings().into_iter().map(|(lane, why)| json!({"lane": lane, "message": why})).collect();
    if !shortcomings.is_empty() {
        value["incomplete"] = shortcomings.into();
    }
    format!("{value:#}\n")
}

fn lane(used: &LaneUsed, stage: Stage) -> Value {
    let LaneUsed { description: lane, against } = used;
    json!({
        "name": lane.name,
        "stage": stage.name(),
        "driver": lane.driver,
        "executor": lane.executor,
        "front_end": lane.front_end,
        "api": lane.api.name(),
        "promise": against.promise,
        "conformance": against.conformance,
        "measured": against.measured,
    })
}

fn entry(entry: &Entry) -> Value {
    let (lane, stage) = entry.on.map_or((None, None), |(lane, stage)| (Some(lane), Some(stage.name())));
    let mut value = json!({
        "suite": entry.suite,
        "shader": entry.shader,
        "lane": lane,
        "stage": stage,
        "source": null,
        "judged": 0,
        "agreed": 0,
        "deviated": 0,
        "undetermined": 0,
        "unsupported": 0,
        "max_ulp": null,
        "findings": [],
        "known": [],
    });
    match &entry.outcome {
        Outcome::Ran(report) => {
            value["source"] = report.source.map(InputSource::name).into();
            if let Some(apart) = &report.apart {
                // JSON has no infinity: words that are no numbers have no distance.
                value["differs_from_storage"] = json!({
                    "samples": apart.samples,
                    "different": apart.different,
                    "max_ulp": apart.ulp.is_finite().then_some(apart.ulp),
                    "component": apart.component,
                });
            }
            value["judged"] = report.judged().into();
            value["agreed"] = report.verdicts.agreed.into();
            value["deviated"] = report.verdicts.deviated.into();
            value["undetermined"] = report.verdicts.undetermined_count().into();
            value["unsupported"] = report.unsupported.into();
            value["replayed"] = report.replayed.into();
            if report.verdicts.agreed > 0 {
                value["max_ulp"] = report.verdicts.max_ulp.into();
            }
            value["undetermined_by"] = undetermined_by(&report.verdicts.undetermined);
            let promises = Promise::ALL.iter().zip(report.verdicts.agreed_by);
            value["agreed_by"] = promises.map(|(promise, n)| (promise.name().to_owned(), Value::from(n))).collect();
            value["shader_deviated"] = report.verdicts.shader_deviated.into();
            value["doubts"] = report.doubts.iter().map(doubtful).collect();
            value["relations"] = report.relations.iter().map(|(name, n)| json!({"name": name, "checked": n})).collect();
            value["textures"] = report.textures.clone().into();
            if report.verdicts.faded > 0 {
                value["faded"] = report.verdicts.faded.into();
            }
            if let Some(coverage) = &report.coverage {
                value["coverage"] = json!({
                    "nodes": coverage.nodes,
                    "segments": coverage.drawn.len(),
                    "drawn": coverage.drawn,
                });
            }
            value["reach"] = report.reach.as_ref().map(super::reach::json).into();
            value["translations"] = super::translations::json(&report.translations);
            value["survey"] = report.survey.as_ref().map(super::survey::json).into();
            if let Some(why) = entry.not_run() {
                value["not_run"] = why.into();
            }
            if entry.standing() == Standing::Weak {
                value["weak"] = true.into();
            }
            value["findings"] = report.findings.iter().map(finding).collect();
            value["known"] = report.known.iter().map(|k| known(finding(&k.finding), &k.expectation)).collect();
            if let Some(Repeated { samples, different }) = report.repeated {
                value["repeated"] = json!({"samples": samples, "different": different});
            }
            if let Some(Budget { asked, samples, rounds, limit, related }) = &report.budget {
                value["budget"] = json!({
                    "asked": asked,
                    "samples": samples,
                    "rounds": rounds,
                    "limit": limit,
                    "related": related,
                });
            }
        }
        Outcome::Refused(RunError::Shader { diagnostics, .. }) => {
            value["findings"] = diagnostics
                .iter()
                .map(|d| {
                    let at = d.file.position(d.span.start);
                    json!({
                        "kind": "compile",
                        "severity": "error",
                        "code": d.code.0,
                        "message": &*d.message,
                        "file": d.file.name(),
                        "line": at.line,
                        "column": at.column,
                    })
                })
                .collect();
        }
        Outcome::Refused(error) => {
            value["findings"] = json!([{"kind": "configuration", "severity": "error", "message": error.to_string()}]);
        }
        Outcome::KnownFailure { message, expectation } => {
            let finding = json!({"kind": "lane", "severity": "error", "message": message});
            value["known"] = json!([known(finding, expectation)]);
        }
        Outcome::LaneFailed(message) => {
            value["findings"] = json!([{"kind": "lane", "severity": "error", "message": message}]);
        }
    }
    value
}

/// A finding that is expected.
fn known(mut finding: Value, expectation: &Expectation) -> Value {
    let Expectation { at, reason, link } = expectation;
    finding["expected"] = json!({"at": at, "reason": reason, "link": link});
    finding
}

fn finding(finding: &Finding) -> Value {
    json!({
        "kind": finding.kind.name(),
        "severity": if finding.kind.is_warning() { "warning" } else { "error" },
        "message": finding.message,
        "samples": finding.count,
        "case": finding.case.as_ref().map(case),
        "reproduce": finding.reproduce,
    })
}

fn case(case: &Case) -> Value {
    let inputs: Vec<Value> = case
        .inputs
        .iter()
        .map(|input| {
            let bits: Vec<String> = input.bits.iter().map(|b| format!("0x{b:08x}")).collect();
            json!({"name": input.name, "declared": input.shown(), "bits": bits, "decimal": input.decimal})
        })
        .collect();
    let mut value = json!({"inputs": inputs, "rounds": case.rounds, "candidates": case.tried});
    diagnosis(&mut value, &case.diagnosis);
    if let Some(deviation) = &case.deviation {
        value["blame"] = deviation.blame.name().into();
    }
    if let Some((deviation, found)) = case.deviation.as_ref().and_then(|d| Some((d, d.value()?))) {
        value["component"] = found.component.clone().into();
        value["vertex"] = found.vertex.map_or(Value::Null, Value::from);
        // JSON has no NaN: it becomes null.
        value["expected"] = deviation.target(found).into();
        value["meaning"] = found.meaning.into();
        value["actual_bits"] = format!("0x{:08x}", found.actual).into();
        value["actual"] = f64::from(f32::from_bits(found.actual)).into();
        value["bound"] = found.bound.into();
        value["ulp"] = deviation.ulp().into();
    }
    value
}

/// Adds the macro that is used at a place, where one is.
pub(super) fn expanded(place: &mut Value, name: Option<&str>) {
    if let Some(name) = name {
        place["macro"] = name.into();
    }
}

fn doubtful(doubtful: &Doubtful) -> Value {
    let mut value = json!({
        "reason": doubtful.reason.name(),
        "operation": doubtful.op.map(|op| op.name()),
        "at": doubtful.at,
        "text": doubtful.text,
        "args": doubtful.args,
        "samples": doubtful.count,
    });
    expanded(&mut value, doubtful.expansion.as_deref());
    value
}

/// Adds what is known about the origin of a deviation, where anything is.
fn diagnosis(value: &mut Value, diagnosis: &Diagnosis) {
    let Diagnosis { literals, no_value, origin, divergence, written, relation: _, position, cross_check } = diagnosis;
    let place = |place: &Place| {
        let mut value = json!({"at": place.at, "text": place.text});
        expanded(&mut value, place.expansion.as_deref());
        value
    };
    if !literals.is_empty() {
        let literal = |l: &judge::verdict::diagnosis::ShortLiteral| json!({"place": place(&l.place), "stands_for": l.stands_for, "off": l.off, "message": l.to_string()});
        value["literals"] = literals.iter().map(literal).collect();
    }
    if let Some(no_value) = no_value {
        value["no_value"] = json!({
            "operation": no_value.op.map(|op| op.name()),
            "place": no_value.place.as_ref().map(place),
            "args": no_value.args,
            "message": no_value.to_string(),
        });
    }
    if let Some(origin) = origin {
        let (kind, operation) = match origin {
            Origin::BuiltIn { op, .. } => ("built-in", Some(op.name())),
            Origin::Rearrangement => ("rearrangement", None),
            Origin::PreciseLost { .. } => ("precise-lost", None),
            Origin::RoundingLeftOut { .. } => ("rounding-left-out", None),
            Origin::Miscompilation => ("miscompilation", None),
        };
        value["origin"] = json!({"kind": kind, "operation": operation, "message": origin.to_string()});
    }
    if let Some(written) = written {
        value["computed_at"] = place(written);
    }
    if let Some(position) = position {
        value["position"] = json!({
            "invocation": position.invocation,
            "invocations": position.count,
            "wrong": position.many,
            "message": position.to_string(),
        });
    }
    if let Some(cross_check) = cross_check {
        let witness = |w: &Witness| {
            json!({
                "lane": w.lane,
                "stage": w.stage.name(),
                "executor": w.executor,
                "front_end": w.front_end,
                "stand": w.stand.name(),
                "agrees": match w.stand {
                    Stand::Right => Some(true),
                    Stand::Wrong => Some(false),
                    Stand::Failed | Stand::Open => None,
                },
                "actual_bits": w.word.map(|word| format!("0x{word:08x}")),
            })
        };
        value["fault"] = json!({"kind": cross_check.fault.name(), "message": cross_check.fault.to_string()});
        value["witnesses"] = cross_check.witnesses.iter().map(witness).collect();
    }
    if let Some(divergence) = divergence {
        value["first_divergence"] = json!({
            "place": place(&divergence.place),
            "args": divergence.args,
            "meaning": divergence.meaning,
            "bound": divergence.bound,
            "actual_bits": format!("0x{:08x}", divergence.actual),
            "condition": divergence.condition,
            "path": divergence.path,
            "message": divergence.to_string(),
        });
    }
}

/// Numbers of undetermined samples by reason, in the order of [`Reason::ALL`]. Undefined values are named where there
/// are some.
pub(crate) fn undetermined_by(undetermined: &[u64]) -> Value {
    let reasons = Reason::ALL.iter().zip(undetermined);
    let reported = reasons.filter(|(reason, n)| **reason != Reason::Undefined || **n > 0);
    reported.map(|(reason, n)| (reason.name().to_owned(), Value::from(*n))).collect()
}
