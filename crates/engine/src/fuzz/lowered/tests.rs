//! Functions that are wrong on a phone alone, and their twins.

use super::super::domain::{Domain, Interval, Law, Stated};
use super::super::{FunctionReport, FuzzFindingKind, Request, Severity, run, subjects};
use base::text::SourceFile;
use syntax::{Shader, Stage};

/// What is found in a fragment shader whose varying `v` lies between `-most` and `most`.
fn report(text: &str, most: f64) -> FunctionReport {
    let file = SourceFile::new("a.frag", format!("{text}\n"));
    let parsed = Shader::parse(&file, Stage::Fragment);
    assert!(parsed.diagnostics.is_empty(), "{:#?}", parsed.diagnostics);
    let subject = subjects(&parsed.shader, &|name| name == "main").unwrap().remove(0);
    let ready = subject.ready.as_ref().unwrap_or_else(|why| panic!("{why}"));
    let interval = Interval { low: -most, high: most, open_low: false, open_high: false };
    let stated = [Stated { input: "v".into(), law: Law::Within(interval), at: String::new(), whole_file: true }];
    let domain = Domain::new("main", ready.kernel.invocation.fields(), ready.kernel.case.fields(), &stated);
    let request = Request {
        samples: 4096,
        seed: 1,
        case: None,
        notes: false,
        arbitrary: false,
        strict_integers: false,
        first_lane: false,
        command: "shadercheck fuzz a.frag".into(),
    };
    run(&subject, &domain, &[], &request).unwrap()
}

fn kinds(text: &str, most: f64) -> Vec<FuzzFindingKind> {
    let lowered = [FuzzFindingKind::MediumpOverflow, FuzzFindingKind::MediumpUnderflow, FuzzFindingKind::MediumpDigits];
    let report = report(text, most);
    report.findings.iter().map(|f| f.kind).filter(|kind| lowered.contains(kind)).collect()
}

fn shader(precision: &str, body: &str) -> String {
    format!("precision {precision} float;\nvarying vec2 v;\nvoid main() {{ {body} }}")
}

#[test]
fn a_square_that_overflows_is_found_with_its_smallest_input() {
    let text = |p| shader(p, "gl_FragColor = vec4(v / sqrt(dot(v, v) + 1.0), 0.0, 1.0);");
    let found = report(&text("mediump"), 500.0);
    let finding = found.findings.iter().find(|f| f.kind == FuzzFindingKind::MediumpOverflow).unwrap();
    assert_eq!((finding.severity, finding.place.as_ref().unwrap().text.as_str()), (Severity::Finding, "dot(v, v)"));
    assert!(finding.message.contains("16384"), "{}", finding.message);
    assert!(kinds(&text("highp"), 500.0).is_empty());
    assert!(kinds(&text("mediump"), 60.0).is_empty(), "the range that is stated decides");
}

#[test]
fn an_epsilon_that_is_zero_is_found_where_it_is_divided_by() {
    let text = |eps| shader("mediump", &format!("gl_FragColor = vec4((v.x - v.y) / (abs(v.x - v.y) + {eps}));"));
    let found = kinds(&text("1e-6"), 1.0);
    assert!(!found.is_empty() && found.iter().all(|kind| *kind == FuzzFindingKind::MediumpUnderflow), "{found:?}");
    assert!(kinds(&text("1e-3"), 1.0).is_empty());
}

#[test]
fn a_parity_that_is_lost_is_found() {
    let text = |p| shader(p, "gl_FragColor = vec4(mod(floor(v.x), 2.0));");
    assert_eq!(kinds(&text("mediump"), 8000.0).first(), Some(&FuzzFindingKind::MediumpDigits));
    assert!(kinds(&text("highp"), 8000.0).is_empty());
}

#[test]
fn desktop_text_has_no_precision() {
    let text =
        "#version 330\nin vec2 v;\nout mediump vec4 c;\nvoid main() { c = vec4(v / sqrt(dot(v, v) + 1.0), 0.0, 1.0); }";
    assert!(kinds(text, 500.0).is_empty());
}
