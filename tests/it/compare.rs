//! `shadercheck compare`: planted differences between languages are found with their smallest input, and the twin without
//! them is equal.

use std::fs;
use std::process::Command;

use serde_json::Value;

use crate::binary::{Ran, root, run_in, run_reported};

fn compared(arguments: &str) -> Ran {
    run_in(&root().join("fixtures/compare"), &format!("compare {arguments} --lane embedded --samples 4096"))
}

fn pair<'r>(report: &'r Value, function: &str) -> &'r Value {
    let named = |pair: &&Value| pair["first"]["function"] == function;
    report["pairs"].as_array().unwrap().iter().find(named).unwrap_or_else(|| panic!("{function}: {report}"))
}

#[test]
fn the_same_functions_in_two_languages_are_equal() {
    let report = compared("functions.glsl functions.wgsl --format json").expect(0).json();
    assert_eq!((&report["status"], report["pairs"].as_array().unwrap().len()), (&"pass".into(), 4));
    for pair in report["pairs"].as_array().unwrap() {
        assert_eq!((&pair["unlike"], &pair["smallest"]), (&0.into(), &Value::Null), "{pair}");
        assert!(
            pair["equal"].as_u64().unwrap() > 4000 && pair["lanes"][0]["samples"].as_u64().unwrap() > 3000,
            "{pair}"
        );
    }
}

#[test]
fn three_slips_are_found_with_their_smallest_input() {
    let report = compared("functions.glsl slips.wgsl --format json").expect(1).json();
    let smallest = |function: &str| {
        let found = &pair(&report, function)["smallest"];
        let values = |input: &Value| {
            input["values"].as_array().unwrap().iter().map(|v| v.as_str().unwrap().to_owned()).collect::<Vec<_>>()
        };
        found["inputs"].as_array().unwrap().iter().flat_map(values).collect::<Vec<String>>()
    };
    // The sign of a remainder, the order of arguments, rows for columns.
    assert_eq!(smallest("wrapAngle"), ["-1.0"]);
    assert_eq!(smallest("heading"), ["1.0", "0.0"]);
    let turn = smallest("turn");
    assert_eq!((turn.len(), turn.iter().filter(|value| *value == "0.0").count()), (12, 8), "{turn:?}");
    assert_eq!(pair(&report, "fade")["unlike"], 0);
    let line = pair(&report, "heading")["smallest"]["reproduce"].as_str().unwrap().to_owned();
    let again = run_reported(&root().join("fixtures/compare"), &line, &["--lane", "embedded"]).expect(1);
    assert!(again.out.contains("1 of 1 samples mean something else"), "{}", again.out);
}

/// The names of the pairs of a report.
fn names(report: &Value) -> Vec<String> {
    let name = |pair: &Value, side: &str| pair[side]["function"].as_str().unwrap().to_owned();
    let pairs = report["pairs"].as_array().unwrap().iter();
    pairs.map(|pair| format!("{} = {}", name(pair, "first"), name(pair, "second"))).collect()
}

#[test]
fn overloads_pointers_and_values_are_paired_and_equal() {
    for (texts, turned) in [("overloads.glsl overloads.wgsl", false), ("overloads.wgsl overloads.glsl", true)] {
        let report = compared(&format!("{texts} --format json")).expect(0).json();
        assert_eq!(report["pairs"].as_array().unwrap().len(), 5, "{texts}: {:?}", names(&report));
        for pair in report["pairs"].as_array().unwrap() {
            assert_eq!((&pair["unlike"], &pair["not_compared"]), (&0.into(), &Value::Null), "{pair}");
            assert!(pair["equal"].as_u64().unwrap() > 4000, "{pair}");
        }
        let alone = report["unpaired"].as_array().unwrap();
        assert_eq!((alone.len(), &alone[0]["function"]), (1, &"smoothed(float, float)".into()), "{alone:?}");
        assert_eq!(alone[0]["text"], if turned { "second" } else { "first" });
        assert!(alone[0]["why"].as_str().unwrap().contains("other parameters"), "{alone:?}");
    }
}

#[test]
fn slips_in_overloads_pointers_and_values_are_found() {
    let report = compared("overloads.glsl overload_slips.wgsl --format json").expect(1).json();
    let unlike: Vec<String> = names(&report)
        .into_iter()
        .zip(report["pairs"].as_array().unwrap())
        .filter(|(_, pair)| pair["unlike"].as_u64().unwrap() > 0)
        .map(|(name, _)| name)
        .collect();
    assert_eq!(unlike, ["smoothed(vec2) = smoothed2", "nearest = nearest", "turned = turned"]);
    let line = pair(&report, "smoothed(vec2)")["smallest"]["reproduce"].as_str().unwrap().to_owned();
    let again = run_reported(&root().join("fixtures/compare"), &line, &["--lane", "embedded"]).expect(1);
    assert!(again.out.contains("1 of 1 samples mean something else"), "{}", again.out);
}

#[test]
fn one_overload_is_chosen_by_its_types_in_the_words_of_any_language() {
    for types in ["vec2", "vec2f", "float2"] {
        let ran = compared(&format!("overloads.glsl overload_slips.wgsl --function smoothed({types}) --format json"));
        assert_eq!(names(&ran.expect(1).json()), ["smoothed(vec2) = smoothed2"]);
    }
    let all = compared("overloads.glsl overloads.wgsl --function smoothed --format json").expect(0).json();
    assert_eq!((names(&all).len(), all["unpaired"].as_array().unwrap().len()), (3, 1));
    let err = compared("overloads.glsl overloads.wgsl --function smoothed(mat2)").expect(2).err;
    assert!(err.contains("no function `smoothed(mat2)`") && err.contains("smoothed(vec2)"), "{err}");
}

#[test]
fn inputs_are_named_as_the_first_text_declares_them() {
    let glsl = compared("functions.glsl slips.wgsl").expect(1).out;
    assert!(glsl.contains("smallest   vec2 v = 1.0, 0.0"), "{glsl}");
    let wgsl = compared("slips.wgsl functions.glsl").expect(1).out;
    assert!(wgsl.contains("smallest   v: vec2f = 1.0, 0.0") && !wgsl.contains("vec2 v"), "{wgsl}");
    let report = compared("slips.wgsl functions.glsl --format json").expect(1).json();
    let input = &pair(&report, "heading")["smallest"]["inputs"][0];
    assert_eq!((&input["name"], &input["declared"]), (&"vec2 v".into(), &"v: vec2f".into()));
}

#[test]
fn the_page_has_charts_of_both_their_difference_and_their_bounds() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("page");
    let ran = compared(&format!("functions.glsl slips.wgsl --report-dir {}", to.display())).expect(1);
    assert!(ran.out.contains("UNLIKE"), "{}", ran.out);
    let page = fs::read_to_string(to.join("index.html")).unwrap();
    for part in
        ["3 of 4 functions mean something else", "wrapAngle", "Smallest inputs that show it", "allowed error, in ULP"]
    {
        assert!(page.contains(part), "{part}");
    }
    // One number, two components, four of twelve, one number: three charts of each.
    assert_eq!(page.matches("<svg ").count(), 3 * (1 + 2 + 4 + 1));
    for over in ["values", "difference", "bounds"] {
        for ending in ["svg", "png"] {
            assert!(to.join(format!("plots/wrapAngle-0-x-{over}.{ending}")).is_file(), "{over}.{ending}");
        }
    }
    let report: Value = serde_json::from_str(&fs::read_to_string(to.join("report.json")).unwrap()).unwrap();
    assert_eq!(report["status"], "fail");
}

/// The chapter's shaders in GLSL, without those whose copies in WGSL are fed otherwise: weights as a vector, a stage of its
/// own for hair.
const CHAPTER: [&str; 11] = [
    "chapter9/bone_weight.glsl",
    "chapter9/cylinder.vert",
    "chapter9/joints.vert",
    "chapter9/morph.vert",
    "chapter9/segment_distance.glsl",
    "chapter9/sphere.vert",
    "chapter9/two_bones.vert",
    "hair/cardinal.glsl",
    "hair/catmull_rom.glsl",
    "hair/hermite.glsl",
    "hair/kochanek_bartels.glsl",
];

#[test]
fn the_chapter_means_the_same_in_both_of_its_languages() {
    for path in CHAPTER {
        let name = path.split(['/', '.']).nth(1).unwrap();
        let texts = format!("shaders/{path} fixtures/languages/{name}.wgsl");
        let ran = run_in(root(), &format!("compare {texts} --lane embedded --samples 256 --format json"));
        let report = ran.expect(0).json();
        let pairs = report["pairs"].as_array().unwrap();
        assert_eq!(pairs.len(), 1, "{path}: {report}");
        assert!(pairs[0]["equal"].as_u64().unwrap() > 128, "{path}: {report}");
    }
}

#[test]
fn a_version_in_git_stands_beside_the_file_of_today() {
    let folder = tempfile::tempdir().unwrap();
    let git = |arguments: &[&str]| {
        let who = ["-c", "user.name=a", "-c", "user.email=a@b.invalid"];
        let done = Command::new("git").args(who).args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(done.status.success(), "{done:?}");
    };
    let write = |body: &str| {
        fs::write(folder.path().join("f.glsl"), format!("float scaled(float x) {{ return {body}; }}\n")).unwrap();
    };
    write("x * 3.0 + 1.0");
    git(&["init", "--quiet"]);
    git(&["add", "f.glsl"]);
    git(&["commit", "--quiet", "-m", "one"]);
    let run = || run_in(folder.path(), "compare HEAD:f.glsl f.glsl --lane embedded --samples 256");
    write("1.0 + x + x * 2.0");
    run().expect(0);
    write("x * 3.0 - 1.0");
    let changed = run().expect(1);
    assert!(changed.out.contains("`return` is 4.0 in the first and 2.0 in the second"), "{}", changed.out);
}

#[test]
fn a_version_is_not_put_together_with_parts_of_today() {
    let folder = tempfile::tempdir().unwrap();
    let git = |arguments: &[&str]| {
        let who = ["-c", "user.name=a", "-c", "user.email=a@b.invalid"];
        let done = Command::new("git").args(who).args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(done.status.success(), "{done:?}");
    };
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    for (ending, text, part, other) in [
        (
            "glsl",
            "#include \"part.glsl\"\nfloat f(float x) { return g(x); }\n",
            "float g(float x) { return x; }\n",
            "float g(float x) { return x + x; }\n",
        ),
        (
            "wgsl",
            "import package::part::g;\nfn f(x: f32) -> f32 { return g(x); }\n",
            "fn g(x: f32) -> f32 { return x; }\n",
            "fn g(x: f32) -> f32 { return x + x; }\n",
        ),
    ] {
        write(&format!("f.{ending}"), text);
        write(&format!("part.{ending}"), part);
        git(&["init", "--quiet"]);
        git(&["add", "."]);
        git(&["commit", "--quiet", "-m", "one"]);
        let run = || run_in(folder.path(), &format!("compare HEAD:f.{ending} f.{ending} --lane embedded --samples 64"));
        run().expect(0);
        write(&format!("part.{ending}"), other);
        let err = run().expect(2).err;
        assert!(err.contains("another one in `HEAD`") && err.contains("git worktree add"), "{err}");
        write(&format!("part.{ending}"), part);
    }
}

#[test]
fn functions_without_a_value_are_not_called_equal() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("f.glsl"), "float f(float x) { return sqrt(-1.0 - x * x); }\n").unwrap();
    let ran = run_in(folder.path(), "compare f.glsl f.glsl --lane embedded --samples 256").expect(2);
    assert!(
        ran.err.contains("nothing could be compared") && ran.out.contains("0 of 256 samples mean the same"),
        "{ran:?}"
    );
    assert!(ran.out.contains("0 compared, 0 unlike, 1 not compared"), "{ran:?}");
}

#[test]
fn what_cannot_be_compared_says_what_to_do() {
    let says = |arguments: &str, code: i32| compared(arguments).expect(code).err;
    let err = says("nosuch:functions.glsl functions.wgsl", 2);
    assert!(err.contains("no file `nosuch:functions.glsl`") && err.contains("git"), "{err}");
    let err = says("functions.glsl functions.wgsl --function heding", 2);
    assert!(err.contains("the first text has no function `heding`") && err.contains("`heading`"), "{err}");
    let err = says("functions.glsl ../../shaders/chapter9/sphere.vert", 2);
    assert!(err.contains("no function in common") && err.contains("--function NAME=OTHER"), "{err}");
    let ran = compared("functions.glsl functions.wgsl --function heading=fade").expect(2);
    assert!(ran.out.contains("not compared") && ran.err.contains("nothing could be compared"), "{ran:?}");
    let err = says("functions.glsl functions.wgsl --profile none", 2);
    assert!(err.contains("needs bounds"), "{err}");
}

#[test]
fn loops_that_do_not_end_are_told_apart_and_hold_nothing_up() {
    let folder = tempfile::tempdir().unwrap();
    let text = |step: &str| {
        format!(
            "fn f(n: i32) -> f32 {{ var a = 0.0; for (var i = 0; i < n; i += {step}) {{ a = a * 0.5 + 1.0; }} return a; }}\n"
        )
    };
    fs::write(folder.path().join("a.wgsl"), text("1")).unwrap();
    fs::write(folder.path().join("b.wgsl"), text("0")).unwrap();
    let compare = |files: &str| {
        run_in(
            folder.path(),
            &format!("compare {files} --format json --lane embedded --samples 4096 --domain n=[0,inf]"),
        )
    };
    // Both go on for as many rounds as `n` says: of huge numbers nothing is known, and they are not among the equal.
    let report = compare("a.wgsl a.wgsl").expect(0).json();
    let same = pair(&report, "f");
    let open = same["undetermined"]["long_loop"].as_u64().unwrap();
    assert!(open > 0 && same["unlike"] == 0, "{same}");
    assert_eq!(same["equal"].as_u64().unwrap() + open, 4096, "{same}");
    // The other one stands still.
    let report = compare("a.wgsl b.wgsl").expect(1).json();
    let message = pair(&report, "f")["smallest"]["message"].as_str().unwrap().to_owned();
    assert_eq!(message, "a loop of the second does not end");
}

/// A folder with twins of which one has three slips, one is equal, and one has no twin.
fn twins() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let from = root().join("fixtures/compare");
    for (name, to) in [
        ("functions.glsl", "glsl/common.glsl"),
        ("slips.wgsl", "wgsl/common.wgsl"),
        ("overloads.glsl", "glsl/over_loads.glsl"),
        ("overloads.wgsl", "wgsl/overloads.wgsl"),
        ("functions.glsl", "glsl/alone.glsl"),
    ] {
        let to = folder.path().join(to);
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        fs::copy(from.join(name), to).unwrap();
    }
    folder
}

#[test]
fn twins_of_two_folders_are_compared_file_by_file() {
    let folder = twins();
    let ran = run_in(folder.path(), "compare glsl wgsl --samples 1024").expect(1);
    assert_eq!(ran.out.matches("UNLIKE").count(), 3, "{}", ran.out);
    for text in
        ["glsl/common.glsl = wgsl/common.wgsl", "no twin of 1 file of the first: glsl/alone.glsl", "6 equal, 3 unlike"]
    {
        assert!(ran.out.contains(text), "{text}: {}", ran.out);
    }
    let report = run_in(folder.path(), "compare glsl wgsl --samples 1024 --format json").expect(1).json();
    assert_eq!(
        (&report["status"], &report["counts"]["unlike"], &report["counts"]["files"]),
        (&"fail".into(), &3.into(), &2.into())
    );
    let line = report["twins"][0]["pairs"][1]["smallest"]["reproduce"].as_str().unwrap().to_owned();
    run_reported(folder.path(), &line, &["--lane", "embedded"]).expect(1);
    let parts: Vec<String> = (0..2).map(|k| format!("compare glsl wgsl --samples 1024 --shard {k}/2")).collect();
    parts.iter().for_each(|part| drop(run_in(folder.path(), part)));
    let merged = run_in(folder.path(), "merge shards --format json").expect(1).json();
    assert_eq!(merged, report);
}

#[test]
fn twins_of_the_configuration_have_exceptions() {
    let folder = twins();
    let missing = run_in(folder.path(), "compare").expect(2).err;
    assert!(missing.contains("[compare]") && missing.contains("pairs"), "{missing}");
    let state = |except: &str| {
        let text =
            format!("[compare]\npairs = [{{ first = \"glsl/**\", second = \"wgsl/*.wgsl\", except = [{except}] }}]\n");
        fs::write(folder.path().join("shadercheck.toml"), text).unwrap();
    };
    state("\"turn\", \"heading\"");
    let ran = run_in(folder.path(), "compare --samples 1024").expect(1);
    assert!(ran.out.contains("1 unlike, 2 known to differ"), "{}", ran.out);
    state("\"turn\", \"heading\", \"wrapAngle\", \"fade\"");
    let ran = run_in(folder.path(), "compare --samples 1024").expect(0);
    assert!(ran.out.contains("is stated to differ (`except`), and does not"), "{}", ran.out);
    fs::write(folder.path().join("wgsl/common.wgsl"), "fn turn( {").unwrap();
    let ran = run_in(folder.path(), "compare --samples 1024").expect(1);
    assert!(ran.out.contains("common.wgsl does not compile: error"), "{}", ran.out);
    fs::write(folder.path().join("shadercheck.toml"), "[compare]\npairs = [{ frist = \"glsl/**\" }]\n").unwrap();
    let wrong = run_in(folder.path(), "compare").expect(2).err;
    assert!(wrong.contains("shadercheck.toml:2:") && wrong.contains("frist"), "{wrong}");
    let none = run_in(folder.path(), "compare 'glsl/*.vert' wgsl").expect(2).err;
    assert!(none.contains("means (0)"), "{none}");
}

#[test]
fn the_smallest_case_is_one_that_devices_cannot_hide_with_the_values_that_the_texts_have() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    // Other digits of π in one, and the remainder of a negative number.
    write("a.glsl", "float f(float x) { return mod(x, 2.0) * 3.14159265; }\n");
    write("b.wgsl", "fn f(x: f32) -> f32 { return (x % 2.0) * 3.1415926535; }\n");
    let report =
        run_in(folder.path(), "compare a.glsl b.wgsl --lane embedded --samples 4096 --format json").expect(1).json();
    let smallest = &report["pairs"][0]["smallest"];
    let number = |key: &str| smallest[key].as_str().unwrap().parse::<f64>().unwrap();
    assert!((number("first") - number("second")).abs() > 1.0, "{smallest}");
    // At a jump, the values are those of this input.
    write("a.glsl", "float m(float x) { return floor(mod(x, 2.0)); }\n");
    write("b.wgsl", "fn m(x: f32) -> f32 { return floor(x % 2.0); }\n");
    let ran = run_in(folder.path(), "compare a.glsl b.wgsl --lane embedded --domain x=[-1,-1] --samples 16").expect(1);
    assert!(ran.out.contains("is 1.0 in the first and -1.0 in the second"), "{}", ran.out);
}

#[test]
fn a_text_that_cannot_be_read_says_why_it_has_no_functions() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.glsl"), "float g(float x) { return x; }\nfloat h(float x) { return x }\n").unwrap();
    fs::write(folder.path().join("b.wgsl"), "fn g(x: f32) -> f32 { return x; }\n").unwrap();
    let ran = run_in(folder.path(), "compare a.glsl b.wgsl --lane embedded");
    assert_ne!(ran.code, 0);
    let said = format!("{}{}", ran.out, ran.err);
    assert!(said.contains("a.glsl:2:"), "{said}");
}

#[test]
fn a_function_that_takes_nothing_is_compared_with_one_that_takes_something() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("a.glsl", "uniform float u;\nfloat f() { return u * 0.0 + 1.0; }\nfloat g() { return u; }\n");
    write("b.wgsl", "fn f() -> f32 { return 1.0; }\nfn g() -> f32 { return 1.0; }\n");
    let report =
        run_in(folder.path(), "compare a.glsl b.wgsl --lane embedded --samples 5000 --format json").expect(1).json();
    assert_eq!((&pair(&report, "f")["unlike"], &pair(&report, "f")["samples"]), (&0.into(), &5000.into()));
    assert!(pair(&report, "g")["unlike"].as_u64().unwrap() > 1000);
}

#[test]
fn functions_that_do_not_compile_are_left_out_with_those_that_call_them() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "a.glsl",
        "float a(float x) { return x * 2.0; }\nfloat b(float x) { return x; }\nfloat c(float x) { return b(x); }\n",
    );
    write(
        "b.wgsl",
        "fn a(x: f32) -> f32 { return x + x; }\nfn b(x: f32) -> f32 { x = 1.0; return x; }\nfn c(x: f32) -> f32 { return b(x); }\n",
    );
    let ran = run_in(folder.path(), "compare a.glsl b.wgsl --lane embedded --samples 256").expect(1);
    assert!(ran.err.contains("b.wgsl:2:") && ran.out.contains("1 compared, 0 unlike, 2 not compared"), "{ran:?}");
    let fuzzed = run_in(folder.path(), "fuzz b.wgsl --lane embedded --samples 64").expect(1);
    assert!(fuzzed.out.contains("ok    a ") && fuzzed.out.contains("b  "), "{fuzzed:?}");
    assert!(fuzzed.out.contains("it does not compile"), "{fuzzed:?}");
}

#[test]
fn what_stands_for_a_missing_name_makes_no_difference() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "a.glsl",
        "float f(float x) { return x * gain; }\nfloat g(float x) { return x * 2.0; }\nuvec2 kept;\nfloat h() { return float(kept.x); }\n",
    );
    write(
        "b.wgsl",
        "const gain = 2.0;\nfn f(x: f32) -> f32 { return x * gain; }\nfn g(x: f32) -> f32 { return x * 3.0; }\n\
         var<private> kept: vec2u;\nfn h() -> f32 { return f32(kept.x); }\n",
    );
    let report =
        run_in(folder.path(), "compare a.glsl b.wgsl --lane embedded --samples 256 --format json").expect(1).json();
    let why = |function: &str| pair(&report, function)["not_compared"].as_str().unwrap_or_default().to_owned();
    assert!(why("f").contains("lacks `gain`"), "{report}");
    assert!(why("h").contains("`kept` is an input of the first"), "{report}");
    assert!(why("g").is_empty() && pair(&report, "g")["unlike"].as_u64().unwrap() > 0, "{report}");
}

#[test]
fn what_differs_is_told_to_services_once_at_its_first_function() {
    let ran = compared("functions.glsl slips.wgsl --format github").expect(1);
    let told: Vec<&str> = ran.out.lines().collect();
    let slip = |line: &&str| {
        line.starts_with("::error file=functions.glsl,line=") && line.contains("title=shadercheck unlike::")
    };
    assert!(told.len() == 3 && told.iter().all(slip), "{}", ran.out);
    assert!(ran.out.contains("reproduce  shadercheck compare functions.glsl slips.wgsl"), "{}", ran.out);
    let folder = twins();
    let ran = run_in(folder.path(), "compare glsl wgsl --samples 4096 --format junit --report-dir out").expect(1);
    assert!(ran.out.contains("type=\"unlike\"") && ran.out.contains("failures=\"3\""), "{}", ran.out);
    let read = |name: &str| fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    let sarif: Value = serde_json::from_str(&read("report.sarif")).unwrap();
    assert_eq!(sarif["runs"][0]["results"].as_array().unwrap().len(), 3);
    assert_eq!(sarif["runs"][0]["results"][0]["ruleId"], "unlike");
    assert!(read("summary.md").starts_with("## shadercheck compare failed"));
    // A part of a run is no report, and what is compared by its bits alone has its own format.
    let refused = run_in(folder.path(), "compare glsl wgsl --format sarif --shard 0/2").expect(2);
    assert!(refused.err.contains("--format is text or json"), "{refused:?}");
}
