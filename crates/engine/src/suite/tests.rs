use std::fs;
use std::path::Path;

use super::*;
use base::value::{Field, Shape};

const GOOD: &str = r#"suite = "skinning"
title = "Vertex blending by distance from bones"
shader = "skinning.vert"
stage = "vertex"
formula = "skinning"
samples = 65536
relations = ["equal_bones"]

[[inputs]]
names = ["p0", "p1"]
generator = "rigid"
range = [-2.0, 2]

[[inputs]]
names = ["position"]
generator = "point"
components = 3

[floors]
judged = 60_000
"#;

fn names() -> Names {
    let owned = |names: &[&str]| names.iter().map(|&n| n.to_owned()).collect();
    Names { formulas: owned(&["skinning", "sphere"]), relations: owned(&["equal_bones", "unit_length"]) }
}

fn read(text: &str) -> Result<Suite, SuiteError> {
    parse_with(&SourceFile::new("s.suite.toml", text), &names())
}

/// The messages for the good suite with one piece replaced.
fn broken(from: &str, to: &str) -> String {
    assert_eq!(GOOD.matches(from).count(), 1, "{from}");
    read(&GOOD.replace(from, to)).unwrap_err().to_string()
}

#[test]
fn a_suite_is_read_whole() {
    let suite = read(GOOD).unwrap();
    assert_eq!((suite.name.as_str(), suite.shader.as_str()), ("skinning", "skinning.vert"));
    assert_eq!((suite.stage, suite.samples, suite.per_case), (Stage::Vertex, 65536, 16));
    assert_eq!(suite.floors, Floors { judged: 60_000, undetermined: 0.05, reason: String::new() });
    assert_eq!(suite.inputs.len(), 2);
    assert_eq!(suite.inputs[0].options.range, Some([-2.0, 2.0]));
    assert_eq!(suite.inputs[1].at, "s.suite.toml:15:9");
    assert_eq!((suite.components("position"), suite.components("p0")), (Some(3), None));
    assert_eq!((suite.cases(65536), suite.cases(17), suite.cases(1)), (4096, 2, 1));
    assert_eq!(suite.floors.judged_of(32768, 65536), 30_000);
}

#[test]
fn a_suite_fits_its_shader() {
    let field = |name: &str, shape| Field { name: name.into(), shape };
    let parts = Shape::MAT4.array_of(8);
    let case = Arc::new(Record::new(vec![field("p0", parts), field("p1", parts)]));
    let invocation = Arc::new(Record::new(vec![field("position", Shape::VEC4)]));
    let suite = read(GOOD).unwrap();
    assert_eq!(suite.plan(&invocation, &case).unwrap().sample(1, 2, 3).get("position")[3], 1.0);
    let wrong = suite.plan(&case, &invocation).unwrap_err().to_string();
    assert!(wrong.starts_with("s.suite.toml:15:9: `components`"), "{wrong}");
}

#[test]
fn geometry_and_function_suites_are_read() {
    let text = GOOD.replace("stage = \"vertex\"", "stage = \"geometry\"");
    assert_eq!(read(&text).unwrap().stage, Stage::Geometry);
    let text = GOOD.replace("stage = \"vertex\"", "stage = \"function\"\nentry = \"f\"");
    assert_eq!(read(&text).unwrap().entry.as_deref(), Some("f"));
}

#[test]
fn a_name_of_a_catalogue_that_is_not_linked_says_what_links_it() {
    assert!(super::expect::hint("sphere", [].into_iter()).contains("`use chapter as _;`"));
    assert_eq!(super::expect::hint("spere", ["sphere"].into_iter()), "did you mean `sphere`?");
}

#[test]
fn unknown_words_are_named_with_their_place_and_a_suggestion() {
    for (from, to, message) in [
        ("[floors]", "[floor]", "s.suite.toml:19:2: unknown key `floor`; did you mean `floors`?"),
        ("judged", "jugded", "s.suite.toml:20:1: unknown key `jugded` in [floors]; did you mean `judged`?"),
        ("components = 3", "component = 3", "17:1: unknown key `component` in [[inputs]]; did you mean `components`?"),
        ("title =", "zzz = 1\ntitle =", "2:1: unknown key `zzz`; known keys are suite, title"),
        ("\"point\"", "\"points\"", "16:13: unknown generator `points`; did you mean `point`?"),
        ("\"equal_bones\"", "\"equal_bone\"", "7:14: unknown relation `equal_bone`; did you mean `equal_bones`?"),
        (
            "formula = \"skinning\"",
            "formula = \"skining\"",
            "5:11: unknown formula `skining`; did you mean `skinning`?",
        ),
        ("formula = \"skinning\"", "formula = \"zzz\"", "5:11: unknown formula `zzz`; known: skinning, sphere"),
        ("\"vertex\"", "\"vertx\"", "4:9: unknown stage `vertx`; did you mean `vertex`?"),
    ] {
        let error = broken(from, to);
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn what_a_suite_does_not_say_is_as_usual() {
    let text: String = GOOD[..GOOD.find("[floors]").unwrap()]
        .lines()
        .filter(|line| !["title", "formula", "samples"].iter().any(|key| line.starts_with(key)))
        .map(|line| format!("{line}\n"))
        .collect();
    let suite = read(&text).unwrap();
    assert_eq!((suite.title.as_str(), suite.samples, suite.expect.formula()), ("skinning", 16384, None));
    assert_eq!(suite.floors, Floors { judged: 15564, undetermined: 0.05, reason: String::new() });
    let half = read(&format!("{text}[floors]\nundetermined = 0.5\nreason = \"half is outside\"\n")).unwrap();
    assert_eq!((half.floors.judged, half.floors.undetermined), (8192, 0.5));
}

#[test]
fn columns_count_characters() {
    let text = GOOD.replace("names = [\"position\"]", "names = [\"球\", \"球\"]");
    let error = read(&text).unwrap_err();
    assert_eq!(error.problems[0].at, "s.suite.toml:15:15");
}

#[test]
fn missing_keys_are_named_with_an_example() {
    for line in GOOD.lines().filter(|l| l.contains(" = ")) {
        let optional = ["relations", "components", "range", "title", "formula", "samples", "judged"];
        if optional.iter().any(|optional| line.starts_with(optional)) {
            continue;
        }
        let error = read(&GOOD.replace(&format!("{line}\n"), "")).unwrap_err().to_string();
        let key = line.split(' ').next().unwrap();
        assert!(error.contains(&format!("missing key `{key}`")), "{line}: {error}");
    }
    assert!(broken("\"vertex\"", "\"function\"").contains("missing key `entry`"));
    assert!(broken("\"rigid\"\nrange = [-2.0, 2]", "\"interval\"").contains("9:1: missing key `range` in [[inputs]]"));
}

#[test]
fn values_that_make_no_sense_are_refused() {
    for (from, to, message) in [
        ("samples = 65536", "samples = 0", "6:11: `samples` is 0, which is not from 1 to"),
        ("samples = 65536", "samples = -5", "`samples` is -5"),
        ("samples = 65536", "samples = 1.5", "6:11: `samples` is a whole number, not a value of type float"),
        ("samples = 65536", "samples = 100\nper_case = 0", "7:12: `per_case` is 0"),
        ("samples = 65536", "samples = 100", "`judged` is 60000, but the suite has 100 samples only"),
        ("[floors]", "[tolerance]\nulp = 8\n[floors]", "19:1: a suite states no tolerance: what a lane may be off"),
        ("judged = 60_000", "judged = 6\nundetermined = nan", "`undetermined` is a number"),
        (
            "judged = 60_000",
            "judged = 6\nundetermined = \"1\"",
            "`undetermined` is a number, not a value of type string",
        ),
        ("judged = 60_000", "judged = 6\nundetermined = 0.3", "21:16: `undetermined` is above 0.05; say why"),
        ("[\"position\"]", "[]", "15:9: `names` is empty"),
        ("[\"position\"]", "[\"\"]", "empty text"),
        ("[\"position\"]", "[\"p0\"]", "15:9: the input `p0` is filled already"),
        ("[\"position\"]", "\"position\"", "`names` is a list of texts, not a value of type string"),
        ("range = [-2.0, 2]", "range = [2.0, -2.0]", "12:9: range [2, -2] has its upper end below its lower end"),
        ("range = [-2.0, 2]", "range = [0.0, inf]", "is not finite in binary32"),
        ("range = [-2.0, 2]", "range = [0.0, 1e39]", "is not finite in binary32"),
        ("range = [-2.0, 2]", "range = [1.0]", "12:9: `range` is [lo, hi], two numbers"),
        ("range = [-2.0, 2]", "values = [1.0]", "12:10: generator `rigid` takes no `values`"),
        ("range = [-2.0, 2]", "components = 3", "generator `rigid` takes no `components`"),
        ("components = 3", "components = 5", "`components` is 5, which is not from 1 to 4"),
        ("judged = 60_000", "judged = 6\nundetermined = 1.5", "21:16: `undetermined` is 1.5; a share is from 0 to 1"),
        ("suite = \"skinning\"", "suite = \"Skin ning\"", "1:9: suite name `Skin ning` may hold lower case"),
        ("stage = \"vertex\"", "stage = \"vertex\"\nentry = \"main\"", "5:9: `entry` names a function"),
        ("[floors]", "[strands]\nnodes = 8\nends = \"repeat\"\n[floors]", "19:1: [strands] feed a geometry stage"),
        (
            "[floors]",
            "[strands]\nnodes = 3\nends = \"repaet\"\n[floors]",
            "unknown ends `repaet`; did you mean `repeat`?",
        ),
        ("[[inputs]]\nnames = [\"pos", "inputs = 3\nnames = [\"pos", "not TOML"),
        ("samples = 65536", "samples = ", "s.suite.toml:6:"),
    ] {
        let error = broken(from, to);
        assert!(error.contains(message), "{message}\n{error}");
    }
}

#[test]
fn all_problems_are_reported_in_the_order_of_the_file() {
    let text = GOOD.replace("60_000", "-1").replace("samples", "smaples").replace("\"point\"", "\"pint\"");
    let error = read(&text).unwrap_err();
    let places: Vec<&str> = error.problems.iter().map(|p| p.at.as_str()).collect();
    assert_eq!(places, ["s.suite.toml:6:1", "s.suite.toml:16:13", "s.suite.toml:20:10"]);
    assert_eq!(error.to_string().lines().count(), 3);
}

#[test]
fn an_empty_file_is_no_suite() {
    let error = read("").unwrap_err();
    assert!(error.problems.len() == 3 && error.problems.iter().all(|p| p.at == "s.suite.toml:1:1"));
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.suite.toml");
    let message = |path: &Path| load_all(path).map(|_| ()).unwrap_err().to_string();
    assert!(message(&file).starts_with("cannot read `") && message(&file).contains("s.suite.toml"));
    assert!(message(folder.path()).starts_with("cannot read `"), "a folder");
    fs::write(&file, b"suite = \"\x8b\"").unwrap();
    assert!(message(&file).contains("s.suite.toml:1:10: not UTF-8"));
    fs::write(&file, "").unwrap();
    assert!(message(&file).contains("s.suite.toml:1:1: missing key `suite`"));
}

#[test]
fn regressions_are_saved_beside_the_suite_and_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = regressions_path(&folder.path().join("morph.suite.toml"));
    assert_eq!(path.file_name().unwrap(), "morph.regressions");
    assert!(read_regressions(&path).unwrap().is_empty());
    let record = Arc::new(Record::new(vec![Field { name: "t".into(), shape: Shape::FLOAT }]));
    let none = Arc::new(Record::default());
    let sample = |t: f32| property::Sample {
        invocation_record: record.clone(),
        case_record: none.clone(),
        invocation: vec![t.to_bits()],
        case: vec![],
    };
    save_regressions(&path, "morph", &[sample(0.1)]).unwrap();
    save_regressions(&path, "morph", &[sample(0.1), sample(0.2)]).unwrap();
    let read = read_regressions(&path).unwrap();
    let back: Vec<_> = read.iter().map(|r| r.to_sample(&record, &none).unwrap()).collect();
    assert_eq!(back, [sample(0.1), sample(0.2)]);
    // A file with a mistake is not written over.
    fs::write(&path, "morph t=zz\n").unwrap();
    assert!(save_regressions(&path, "morph", &[sample(0.3)]).unwrap_err().to_string().contains(":1:9: `zz`"));
    assert_eq!(fs::read_to_string(&path).unwrap(), "morph t=zz\n");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    let gone = folder.path().join("gone/x.regressions");
    assert!(save_regressions(&gone, "x", &[sample(0.3)]).unwrap_err().to_string().starts_with("cannot write `"));
}
