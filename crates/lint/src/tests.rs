//! The listings as printed, and the laws that hold for every fix.

mod conditions;
mod document;
mod embedded;
mod feed;
mod handed;
mod kept;
mod languages;
mod open;
mod prelude;
mod program;
mod script;
mod sections;
mod surroundings;
mod variants;
mod webgpu;

use super::fix::{Outcome, fix, fix_with};
use super::page::tests::NO_PAGES;
use super::rule::{Check, Findings, Level, Rule};
use super::{Input, RULES, Selection, Settings, run, run_rules, run_with};
use base::diagnostic::{Code, Diagnostic, Safety, Severity};
use base::text::{Edit, SourceFile, Span};

macro_rules! file {
    ($folder:literal, $name:literal) => {
        ($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../", $folder, "/", $name)))
    };
}

const PRINTED: &[(&str, &str)] = &[
    file!("fixtures/printed", "cylinder.vert"),
    file!("fixtures/printed", "grid.cpp"),
    file!("fixtures/printed", "hair.cpp"),
    file!("fixtures/printed", "hair.frag"),
    file!("fixtures/printed", "hair.geom"),
    file!("fixtures/printed", "hair.vert"),
    file!("fixtures/printed", "morph.cpp"),
    file!("fixtures/printed", "morph.vert"),
    file!("fixtures/printed", "skinning.vert"),
    file!("fixtures/printed", "sphere.cpp"),
    file!("fixtures/printed", "sphere.vert"),
];

const REPAIRED: &[(&str, &str)] = &[
    file!("shaders/chapter9", "cylinder.vert"),
    file!("shaders/chapter9", "morph.cpp"),
    file!("shaders/chapter9", "morph.vert"),
    file!("shaders/chapter9", "skinning.vert"),
    file!("shaders/chapter9", "sphere.vert"),
    file!("shaders/hair", "hair.cpp"),
    file!("shaders/hair", "hair.frag"),
    file!("shaders/hair", "hair.geom"),
    file!("shaders/hair", "hair.vert"),
];

/// The rule at its level alone.
fn alone(rule: &Rule) -> Settings {
    // Selected by its code, a rule runs whatever its level is.
    Settings { selection: Selection::new(&[rule.code.0.to_owned()], &[]).unwrap(), ..Settings::default() }
}

/// What the rule finds at its level, and the others by default.
pub(super) fn at_its_level(rule: &Rule, inputs: &[Input]) -> Vec<Diagnostic> {
    let mut found = run(inputs);
    found.retain(|d| d.code != rule.code);
    let selection = Selection::default().at(rule.level);
    let own = run_with(inputs, &Settings { selection, ..Settings::default() });
    found.extend(own.into_iter().filter(|d| d.code == rule.code));
    found
}

fn inputs(files: &[(&str, &str)]) -> Vec<Input> {
    files.iter().map(|(name, text)| Input::new(SourceFile::new(*name, *text))).collect()
}

fn text<'t>(files: &[(&str, &'t str)], name: &str) -> &'t str {
    files.iter().find(|(n, _)| *n == name).unwrap().1
}

fn fixed(outcome: &Outcome, name: &str) -> String {
    outcome.files.iter().find(|f| f.after.name() == name).unwrap().after.text().to_owned()
}

#[test]
fn the_printed_defects_are_found_and_nothing_else() {
    let found = run(&inputs(PRINTED));
    let reported: Vec<String> =
        found.iter().map(|d| format!("{} {} {}", d.file.locate(d.span.start), d.code, d.severity.name())).collect();
    assert_eq!(
        reported,
        [
            "cylinder.vert:11:24 N014 info",
            "cylinder.vert:13:23 T001 error", // D1
            "grid.cpp:21:15 H029 error",      // D2
            "hair.cpp:24:30 H030 info",       // L13
            "hair.geom:7:21 G002 info",
            "morph.cpp:18:17 H001 error",  // D4
            "sphere.cpp:22:62 H004 error", // D3
            "sphere.vert:11:14 N014 info",
            "sphere.vert:12:14 N014 info",
        ]
    );
    for d in &found {
        assert!(d.why.is_some() && !d.label.is_empty(), "{} explains itself", d.code);
        assert!(d.fix.is_some() || d.help.is_some(), "{} says what to do", d.code);
    }
}

#[test]
fn the_order_of_the_inputs_does_not_matter_and_a_file_given_twice_is_reported_once() {
    let mut files = inputs(PRINTED);
    let expected = run(&files);
    files.reverse();
    assert_eq!(run(&files), expected);
    files.extend(inputs(PRINTED));
    assert_eq!(run(&files), expected);
}

#[test]
fn files_that_are_context_are_not_reported() {
    let mut files = inputs(PRINTED);
    files.iter_mut().for_each(|f| f.reported = f.file.name() == "sphere.cpp");
    let codes: Vec<&str> = run(&files).iter().map(|d| d.code.0).collect();
    assert_eq!(codes, ["H004"], "the shader is read, and only the host file reported");
    files.retain(|f| f.reported);
    assert!(run(&files).is_empty(), "without the shader nothing is known");
}

#[test]
fn safe_fixes_repair_d1_and_d4() {
    let outcome = fix(&inputs(PRINTED), &Settings::default(), Safety::Safe);
    assert_eq!(outcome.applied, 2);
    assert!(outcome.refused.is_empty());
    assert_eq!(fixed(&outcome, "morph.cpp"), text(REPAIRED, "morph.cpp"));
    assert!(fixed(&outcome, "cylinder.vert").contains("vec4 p = vec4(cos(th), y, sin(th), 1.0);"));
    assert!(fixed(&outcome, "cylinder.vert").contains("6.283185 *"), "the literal is left to unsafe fixes");
    assert_eq!(outcome.fixable(Safety::Unsafe), 6);
}

#[test]
fn unsafe_fixes_give_the_repaired_shaders() {
    let outcome = fix(&inputs(PRINTED), &Settings::default(), Safety::Unsafe);
    for name in ["cylinder.vert", "sphere.vert", "morph.cpp", "hair.geom"] {
        assert_eq!(fixed(&outcome, name), text(REPAIRED, name), "{name}");
    }
    assert!(fixed(&outcome, "sphere.cpp").contains("glGetAttribLocation(program, \"parameter\")"));
    let grid = fixed(&outcome, "grid.cpp");
    assert!(grid.contains("parameter[k][0] =") && grid.contains("parameter[k][1] =") && !grid.contains("attribute["));
    let left: Vec<&str> = outcome.remaining.iter().map(|d| d.code.0).collect();
    assert_eq!(left, ["H030"], "the nodes of the strands are data");
}

#[test]
fn the_repaired_listings_are_clean() {
    let found = run(&inputs(REPAIRED));
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn right_code_is_left_alone() {
    let clean = [
        file!("fixtures/lint/clean", "scene.cpp"),
        file!("fixtures/lint/clean", "scene.frag"),
        file!("fixtures/lint/clean", "scene.vert"),
    ];
    let found = run(&inputs(&clean));
    assert!(found.is_empty(), "{found:#?}");
    // The silence is not for want of looking: one wrong letter is told.
    let typo =
        clean.map(|(name, text)| (name, text.replace("\"gain\"", "\"gian\"").replace("\"normal\"", "\"norml\"")));
    let typo: Vec<(&str, &str)> = typo.iter().map(|(n, t)| (*n, t.as_str())).collect();
    assert_eq!(run(&inputs(&typo)).iter().map(|d| d.code.0).collect::<Vec<_>>(), ["H003", "H004"]);
}

#[test]
fn line_ends_are_kept() {
    let crlf = text(PRINTED, "cylinder.vert").replace('\n', "\r\n");
    let files = [Input::new(SourceFile::new("cylinder.vert", crlf))];
    let outcome = fix(&files, &Settings::default(), Safety::Unsafe);
    assert_eq!(fixed(&outcome, "cylinder.vert"), text(REPAIRED, "cylinder.vert").replace('\n', "\r\n"));
}

#[test]
fn every_fix_leaves_a_text_that_is_clean_and_stays_as_it_is() {
    for rule in RULES {
        let files: Vec<Input> = rule.pages.bad().iter().map(|e| Input::new(SourceFile::new(e.name, e.text))).collect();
        let settings = alone(rule);
        let has_fix = run_with(&files, &settings).iter().any(|d| d.fix.is_some());
        let outcome = fix(&files, &settings, Safety::Unsafe);
        assert_eq!(outcome.applied > 0, has_fix, "{}", rule.code);
        assert!(outcome.refused.is_empty(), "{}: {:?}", rule.code, outcome.refused);
        if has_fix {
            assert!(outcome.remaining.is_empty(), "{}: {:#?}", rule.code, outcome.remaining);
            for (file, good) in outcome
                .files
                .iter()
                .filter_map(|f| rule.pages.good().into_iter().find(|g| g.name == f.after.name()).map(|g| (f, g)))
            {
                assert_eq!(file.after.text(), good.text, "{}: the fix gives the good example", rule.code);
            }
        }
        let after: Vec<Input> = files
            .iter()
            .map(|i| {
                outcome
                    .files
                    .iter()
                    .find(|f| f.after.name() == i.file.name())
                    .map_or(i.clone(), |f| Input::new(f.after.clone()))
            })
            .collect();
        let again = fix(&after, &settings, Safety::Unsafe);
        assert_eq!((again.applied, again.files.len()), (0, 0), "{}", rule.code);
    }
}

#[test]
fn what_is_ignored_is_neither_reported_nor_fixed() {
    let ignore = |codes: &[&str]| Settings {
        selection: Selection::new(&[], &codes.iter().map(|&c| c.to_owned()).collect::<Vec<_>>()).unwrap(),
        ..Settings::default()
    };
    let outcome = fix(&inputs(PRINTED), &ignore(&["T", "H", "N", "G"]), Safety::Unsafe);
    assert!(outcome.files.is_empty());
    let outcome = fix(&inputs(PRINTED), &ignore(&["N014"]), Safety::Unsafe);
    assert!(!outcome.files.iter().any(|f| f.after.name() == "sphere.vert"));
}

#[test]
fn a_text_that_breaks_off_anywhere_does_no_harm() {
    for (name, text) in PRINTED {
        let borders: Vec<usize> = text.char_indices().map(|(at, _)| at).step_by(23).collect();
        for end in borders {
            let mut files = inputs(PRINTED);
            files.retain(|f| f.file.name() != *name);
            files.push(Input::new(SourceFile::new(*name, &text[..end])));
            for d in run(&files) {
                let edits = d.fix.iter().flat_map(|f| &f.edits).map(|e| e.span);
                for span in edits.chain([d.span]) {
                    assert!(d.file.text().get(span.range()).is_some(), "{name} cut at {end}: {d:#?}");
                }
            }
        }
    }
}

#[test]
fn errors_of_the_front_end_stand_in_the_same_list() {
    let text = "#version 150 core\nin vec4 p;\nvoid main(void)\n{\n  float a = 3.1416 * q;\n  gl_Position = p * a\n}\n";
    let found = run(&[Input::new(SourceFile::new("a.vert", text))]);
    let codes: Vec<&str> = found.iter().map(|d| d.code.0).collect();
    assert!(codes.contains(&"N014") && codes.iter().any(|c| c.starts_with('E')), "{found:#?}");
    assert!(found.windows(2).all(|w| w[0].span.start <= w[1].span.start));
    let broken: Vec<&str> = run(&[Input::new(SourceFile::new("a.vert", "#version 150 core\nvoid main( { vec3(1.0"))])
        .iter()
        .map(|d| d.severity.name())
        .collect();
    assert!(broken.contains(&"error"));
}

// Planted rules: the engine's own alarms.

const fn planted(code: &'static str, check: fn(&SourceFile, &mut Findings<'_>)) -> Rule {
    Rule {
        code: Code(code),
        name: "planted-rule",
        severity: Severity::Warning,
        level: Level::Default,
        pages: NO_PAGES,
        check: Check::Text(check),
    }
}

fn swap(file: &SourceFile, findings: &mut Findings<'_>, from: &str, to: &str) {
    for (at, _) in file.text().match_indices(from) {
        let span = Span::new(at, at + from.len());
        let found = findings.at(file, span, format!("{from} at {at}"));
        findings.push(found.with_fix(format!("write {to}"), Safety::Safe, vec![Edit::replace(span, to)]));
    }
}

static TO_B: Rule = planted("Z001", |file, findings| swap(file, findings, "aaa", "bbb"));
static TO_A: Rule = planted("Z002", |file, findings| swap(file, findings, "bbb", "aaa"));
static BREAK: Rule = planted("Z003", |file, findings| swap(file, findings, "good", "{{{"));
static PAIRS: Rule = planted("Z004", |file, findings| {
    let text = file.text();
    for at in (0..text.len()).filter(|&at| text[at..].starts_with("xx")) {
        let span = Span::new(at, at + 2);
        let found = findings.at(file, span, "pair");
        findings.push(found.with_fix("halve", Safety::Safe, vec![Edit::replace(span, "x")]));
    }
});
static OUTSIDE: Rule = planted("Z005", |file, findings| {
    let found = findings.at(file, Span::at(0), "outside");
    findings.push(found.with_fix("cut", Safety::Safe, vec![Edit::delete(Span::new(0, file.text().len() + 9))]));
});

fn plant(text: &str, rules: &[&'static Rule]) -> Outcome {
    fix_with(&[Input::new(SourceFile::new("a.cpp", text))], &Settings::default(), Safety::Safe, rules)
}

#[test]
fn fixes_that_undo_each_other_come_to_an_end() {
    let outcome = plant("int aaa;", &[&TO_B, &TO_A]);
    assert_eq!(outcome.refused.len(), 1, "{:?}", outcome.refused);
    assert!(outcome.refused[0].reason.contains("did not come to an end"));
    assert!(outcome.refused[0].to_string().starts_with("a.cpp:1:5: fix of Z00"));
}

#[test]
fn a_fix_that_breaks_the_text_is_refused_and_others_are_applied() {
    let outcome = plant("int good;\nint aaa;\n", &[&TO_B, &BREAK]);
    assert_eq!(fixed(&outcome, "a.cpp"), "int good;\nint bbb;\n");
    assert_eq!(outcome.applied, 1);
    assert_eq!(outcome.refused.iter().map(|r| r.code).collect::<Vec<_>>(), ["Z003"]);
    assert!(outcome.refused[0].reason.contains("parse"));
    assert_eq!(outcome.remaining.len(), 1, "it is still told");
}

#[test]
fn overlapping_fixes_come_one_after_the_other() {
    let outcome = plant("int xxxxx;", &[&PAIRS]);
    assert_eq!(fixed(&outcome, "a.cpp"), "int x;");
    assert!(outcome.remaining.is_empty() && outcome.refused.is_empty());
}

#[test]
fn an_edit_outside_the_text_is_refused() {
    let outcome = plant("int a;", &[&OUTSIDE]);
    assert!(outcome.files.is_empty() && outcome.refused.len() == 1, "{outcome:?}");
}

#[test]
fn diagnostics_are_sorted_by_place_and_reported_once() {
    let files = [Input::new(SourceFile::new("a.cpp", "int xx; int aaa;"))];
    let found = run_rules(&files, &Settings::default(), &[&TO_B, &PAIRS, &PAIRS]);
    assert_eq!(found.iter().map(|d| (d.code.0, d.span.start)).collect::<Vec<_>>(), [("Z004", 4), ("Z001", 12)]);
}

#[test]
fn what_a_host_puts_in_front_is_no_error() {
    let shader = "#version 330\nuniform mat4 bones[MAX_BONES];\nvoid main() { gl_Position = bones[0][0]; }\n";
    let host = "std::string head = \"#define MAX_BONES \" + std::to_string(n);\n";
    let input = |name: &str, text: &str| Input::new(SourceFile::new(name, text));
    let codes = |files: &[Input]| -> Vec<&str> { run(files).iter().map(|d| d.code.0).collect() };
    assert_eq!(codes(&[input("a.vert", shader)]), [""; 0]);
    assert_eq!(codes(&[input("a.vert", &shader.replace("MAX_BONES", "maxBones"))]), ["E020"]);
    assert_eq!(codes(&[input("a.vert", shader), input("a.cpp", host)]), [""; 0]);
    // In a literal, the shader's own text is no such host.
    let literal = format!("const char* s = R\"({shader})\";");
    assert_eq!(codes(&[input("a.cpp", &literal)]), ["E020"]);
    let joined = "#version 330\n#include \"common.glsl\"\nvoid main() { gl_Position = place(); }\n";
    assert_eq!(codes(&[input("a.vert", joined)]), [""; 0]);
    // A macro of the included text may stand for a declaration, whatever comes behind it.
    let pass = |between: &str| format!("#version 450\n#include \"pass.glsl\"\nPASS\n{between}\nvoid main() {{}}\n");
    assert_eq!(codes(&[input("a.comp", &pass("// Clears all."))]), [""; 0]);
    assert_eq!(codes(&[input("a.comp", &pass("#define FIRST 0"))]), [""; 0]);
    assert_eq!(codes(&[input("a.comp", &pass("// Clears all.").replace("PASS", "uint"))]), ["E001"]);
    assert_eq!(codes(&[input("a.vert", "#version 330\n#defin A\nvoid main() {}\n")]), ["E010"]);
}

#[test]
fn an_error_in_a_body_does_not_hide_what_is_wrong_with_the_interface() {
    let input = |name: &str, text: &str| Input::new(SourceFile::new(name, text));
    let vertex =
        "#version 330\nin vec3 p;\nout vec3 normalEye;\nvoid main() { normalEye = p; gl_Position = vec4(p); }\n";
    let fragment = "#version 330\nin vec3 eyeNormal;\nout vec4 c;\nvoid main() { c = vec4(eyeNormal, 1.0); }\n";
    let codes = |vertex: &str| -> Vec<&str> {
        run(&[input("a.vert", vertex), input("a.frag", fragment)]).iter().map(|d| d.code.0).collect()
    };
    assert_eq!(codes(vertex), ["I001", "T002"]);
    // A text that cannot be read may declare anything.
    assert_eq!(codes(&vertex.replace("vec4(p)", "vec4(p")), ["E001"]);
}

/// Every rule that holds for WGSL has two modules in `fixtures/wgsl`: in one it reports, in its twin it does not.
#[test]
fn every_rule_of_both_languages_reports_in_wgsl_and_leaves_the_twin_alone() {
    let mut wrong = Vec::new();
    for rule in RULES.iter().filter(|r| r.holds_for_wgsl()) {
        let mut counts = ["bad", "good"].map(|twin| {
            let path = format!("{}/../../fixtures/wgsl/{}.{twin}.wgsl", env!("CARGO_MANIFEST_DIR"), rule.code);
            let text = std::fs::read_to_string(&path).unwrap_or_else(|_| panic!("{path} is missing"));
            let settings = Settings { selection: Selection::default().at(Level::Heuristic), ..Settings::default() };
            let found = run_with(&[Input::new(SourceFile::new("a.wgsl", text))], &settings);
            assert!(found.iter().all(|d| !d.code.0.starts_with('E')), "{path}: {found:#?}");
            found.iter().filter(|d| d.code == rule.code).count()
        });
        if counts[0] > 0 {
            counts[0] = 1;
        }
        if counts != [1, 0] {
            wrong.push(format!("{}: {counts:?}", rule.code));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
