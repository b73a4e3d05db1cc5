//! The table of corners: what the tool accepts there is what the table says, and no lane is accused there.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::rc::Rc;

use base::text::SourceFile;
use base::value::Scalar;
use engine::corners::{Case, Corner, Language, Row, rows};
use engine::suite::parse;
use engine::suite::run::{FindingKind, Prepared, Report, Request, RunError, prepare, run};
use judge::profile::{self, Promises};
use judge::verdict::{JudgeContext, Reason, Verdict, judge_each};
use lanes::{Actual, Lane, Marks, Stage};
use property::Sample;
use test_record::not_run;

use crate::binary::root;
use crate::support::{Planted, request};

/// The type of a language for so many numbers.
fn ty(language: Language, (scalar, count): (Scalar, usize)) -> String {
    let (glsl, wgsl, hlsl) = match scalar {
        Scalar::F32 => (["float", "vec"], ["f32", "f"], "float"),
        Scalar::I32 => (["int", "ivec"], ["i32", "i"], "int"),
        Scalar::U32 => (["uint", "uvec"], ["u32", "u"], "uint"),
        Scalar::Bool => (["bool", "bvec"], ["bool", "<bool>"], "bool"),
    };
    match (language, count) {
        (Language::Glsl, 1) => glsl[0].to_owned(),
        (Language::Glsl, _) => format!("{}{count}", glsl[1]),
        (Language::Wgsl, 1) => wgsl[0].to_owned(),
        (Language::Wgsl, _) => format!("vec{count}{}", wgsl[1]),
        (Language::Hlsl, 1) => hlsl.to_owned(),
        (Language::Hlsl, _) => format!("{hlsl}{count}"),
    }
}

const NAMES: [&str; 4] = ["x", "y", "z", "w"];

/// A function of several rows that have the same arguments: `r0`, `r1` and so on are their results.
fn text(language: Language, rows: &[&Row]) -> String {
    let types = rows[0].types();
    let parameters: Vec<(String, &str)> =
        types[1..].iter().zip(NAMES).map(|(t, name)| (ty(language, *t), name)).collect();
    let results =
        rows.iter().enumerate().map(|(k, row)| (k, ty(language, row.types()[0]), row.text(language).unwrap()));
    let mut out = String::new();
    match language {
        Language::Wgsl => {
            let list: Vec<String> = parameters.iter().map(|(t, name)| format!("{name}: {t}")).collect();
            let (mut fields, mut body) = (String::new(), String::new());
            for (k, t, expression) in results {
                let _ = write!(fields, "r{k}: {t}, ");
                let _ = writeln!(body, "    r.r{k} = {expression};");
            }
            let _ = write!(
                out,
                "struct R {{ {fields}}}\nfn f({}) -> R {{\n    var r: R;\n{body}    return r;\n}}\n",
                list.join(", ")
            );
        }
        Language::Glsl | Language::Hlsl => {
            let mut list: Vec<String> = parameters.iter().map(|(t, name)| format!("{t} {name}")).collect();
            let mut body = String::new();
            for (k, t, expression) in results {
                list.push(format!("out {t} r{k}"));
                let _ = writeln!(body, "    r{k} = {expression};");
            }
            if language == Language::Glsl {
                out.push_str("#version 450\n");
                body.insert_str(0, "    uint carry;\n");
            }
            let _ = write!(out, "void f({}) {{\n{body}}}\n", list.join(", "));
        }
    }
    out
}

fn prepared(language: Language, rows: &[&Row]) -> Result<Prepared, RunError> {
    let ending = match language {
        Language::Glsl => "glsl",
        Language::Wgsl => "wgsl",
        Language::Hlsl => "hlsl",
    };
    let mut toml = format!("suite = \"corners\"\nshader = \"f.{ending}\"\nstage = \"function\"\nentry = \"f\"\n");
    for ((scalar, count), name) in rows[0].types()[1..].iter().zip(NAMES) {
        let (generator, range) = match (scalar, count) {
            (Scalar::F32, 1) => ("interval", "[-1.0, 1.0]"),
            (Scalar::F32, _) => ("vector", "[-1.0, 1.0]"),
            (Scalar::Bool, _) => ("index", "[0, 1]"),
            _ => ("index", "[0, 5]"),
        };
        let _ = write!(toml, "[[inputs]]\nnames = [\"{name}\"]\ngenerator = \"{generator}\"\nrange = {range}\n");
    }
    let suite = parse(&SourceFile::new("corners.suite.toml", toml)).unwrap();
    prepare(&suite, &SourceFile::new(format!("f.{ending}"), text(language, rows)))
}

fn sample(prepared: &Prepared, case: &Case) -> Sample {
    let (invocation, of_case) = (prepared.compute.invocation.clone(), prepared.compute.case.clone());
    assert_eq!((invocation.words(), of_case.words()), (case.arguments.len(), 0));
    Sample { invocation: case.arguments.clone(), case: Vec::new(), invocation_record: invocation, case_record: of_case }
}

/// Whether HLSL cannot be read, since no compiler of it is found.
fn lacks_compiler(error: &RunError) -> bool {
    error.to_string().contains("HLSL needs a compiler, and none is found")
}

fn profile_of(language: Language) -> &'static profile::Profile {
    let name = match language {
        Language::Glsl | Language::Hlsl => "glsl-4.60",
        Language::Wgsl => "wgsl",
    };
    profile::by_name(name).unwrap()
}

/// What no lane can be held to, since what stands before it says otherwise, with why.
const NOT_HELD: [(&str, Language, Corner, &str); 8] = [
    (
        "remainder",
        Language::Hlsl,
        Corner::Range,
        "glslang 12 writes OpFMod, which rounds down: upstream/glslang-hlsl-fmod",
    ),
    ("remainder", Language::Hlsl, Corner::Absorption, "the same"),
    ("clamp", Language::Wgsl, Corner::Range, "naga writes FClamp, which is undefined where the ends are exchanged"),
    ("clamp of int", Language::Wgsl, Corner::Range, "naga writes SClamp, which is undefined there as well"),
    ("packSnorm4x8", Language::Wgsl, Corner::Tie, "naga writes PackSnorm4x8, which rounds halves either way"),
    ("packUnorm4x8", Language::Wgsl, Corner::Tie, "naga writes PackUnorm4x8"),
    ("packSnorm2x16", Language::Wgsl, Corner::Tie, "naga writes PackSnorm2x16"),
    ("packUnorm2x16", Language::Wgsl, Corner::Tie, "naga writes PackUnorm2x16"),
];

/// What the judge says of a device that gives these words for these cases.
fn verdicts(prepared: &Prepared, language: Language, given: &[(&Case, u32)]) -> Vec<Verdict> {
    let samples: Vec<Sample> = given.iter().map(|(case, _)| sample(prepared, case)).collect();
    let batch = Sample::batch(&samples);
    let layout = prepared.compute.output.clone();
    let marks = Marks::random();
    let mut words = Vec::new();
    for (invocation, (_, word)) in given.iter().enumerate() {
        words.extend([marks.canary ^ invocation as u32, *word]);
    }
    let actual = Actual::accept(&layout, words, given.len(), marks).unwrap();
    let promises = Promises { text: profile_of(language), conformance: None, measured: None };
    let Prepared { oracle, reference, .. } = prepared;
    let context = JudgeContext { oracle, reference, promises: &promises, stage: Stage::Compute };
    judge_each(&context, &batch, &actual)
}

fn show(words: &[u32], types: &[(Scalar, usize)]) -> String {
    let scalars = types.iter().flat_map(|&(scalar, count)| vec![scalar; count]);
    let one = |(word, scalar): (&u32, Scalar)| match scalar {
        Scalar::F32 => format!("{:?}", f32::from_bits(*word)),
        Scalar::I32 => format!("{}", *word as i32),
        Scalar::U32 | Scalar::Bool => format!("{word:#x}"),
    };
    words.iter().zip(scalars).map(one).collect::<Vec<_>>().join(" ")
}

#[test]
fn what_the_judge_accepts_in_every_corner_is_what_the_table_says() {
    let (mut wrong, mut looked, mut not_held) = (Vec::new(), 0_usize, BTreeSet::new());
    let mut without = None;
    for row in rows() {
        for language in Language::ALL.into_iter().filter(|&language| row.text(language).is_some()) {
            let prepared = match prepared(language, &[row]) {
                Ok(prepared) => prepared,
                Err(error) if lacks_compiler(&error) => {
                    without = Some(error);
                    continue;
                }
                Err(error) => {
                    wrong.push(format!("{language} `{}`: {error}", row.text(language).unwrap()));
                    continue;
                }
            };
            let types = row.types();
            let cases = row.cases(language);
            let mut given: Vec<(Corner, bool, &Case, u32)> = Vec::new();
            for (corner, case) in &cases {
                let (right, others) = case.samples(types[0].0);
                given.extend(right.into_iter().map(|word| (*corner, true, case, word)));
                given.extend(others.into_iter().map(|word| (*corner, false, case, word)));
            }
            let pairs: Vec<(&Case, u32)> = given.iter().map(|&(_, _, case, word)| (case, word)).collect();
            for ((corner, right, case, word), verdict) in given.iter().zip(verdicts(&prepared, language, &pairs)) {
                looked += 1;
                let any = case.values == engine::corners::Values::Any;
                let unsure = matches!(corner, Corner::Subnormal | Corner::SubnormalHalf);
                let fits = match &verdict {
                    Verdict::Agree(_) => *right,
                    Verdict::Undetermined(doubt) => {
                        any || unsure || matches!(doubt.reason, Reason::NoPromise | Reason::Underflow)
                    }
                    Verdict::Deviate(_) => !*right,
                };
                let held = |(name, of, at, _): &&(&str, Language, Corner, &str)| {
                    *name == row.name && *of == language && at == corner
                };
                if let Some(known) = NOT_HELD.iter().position(|entry| held(&entry)) {
                    if !fits {
                        not_held.insert(known);
                    }
                    continue;
                }
                if !fits {
                    let (arguments, word) = (show(&case.arguments, &types[1..]), show(&[*word], &types[..1]));
                    let text = row.text(language).unwrap();
                    let shall = if any {
                        "anything"
                    } else if *right {
                        "right"
                    } else {
                        "wrong"
                    };
                    let says = match verdict {
                        Verdict::Deviate(deviation) => format!("{:?}", deviation.what),
                        other => format!("{other:?}"),
                    };
                    wrong.push(format!(
                        "{language} `{text}`, {}, of {arguments}: {word} is {shall}: {says}",
                        corner.name()
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {looked}\n{}", wrong.len(), wrong.join("\n"));
    if let Some(error) = without {
        not_run(&format!("the corners of HLSL: {error}"));
    } else {
        assert!(looked > 8000, "{looked}");
    }
    // slangc writes OpFRem for HLSL's `fmod`: what is not held there is of glslang alone.
    let required = |&k: &usize| NOT_HELD[k].1 != Language::Hlsl;
    let again: Vec<_> = (0..NOT_HELD.len()).filter(required).filter(|k| !not_held.contains(k)).collect();
    assert!(again.is_empty(), "held again: {again:?}");
}

/// What the judge says of words that are given for a function of WGSL without arguments that count.
fn of_constant(expression: &str, given: f32) -> Verdict {
    let toml = "suite = \"c\"\nshader = \"c.wgsl\"\nstage = \"function\"\nentry = \"f\"\n\
                [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]\n";
    let suite = parse(&SourceFile::new("c.suite.toml", toml)).unwrap();
    let text = format!("fn f(x: f32) -> f32 {{\n    return {expression};\n}}\n");
    let prepared = prepare(&suite, &SourceFile::new("c.wgsl", text)).unwrap();
    let case = Case { arguments: vec![0], values: engine::corners::Values::Any };
    verdicts(&prepared, Language::Wgsl, &[(&case, given.to_bits())]).remove(0)
}

#[test]
fn constants_that_are_not_followed_may_be_anything() {
    for operator in ["%", "+"] {
        let (a, b) = ("vec2<f32>(1.0, 0.3)", "vec2<f32>(0.99999994, 0.3)");
        let folded = format!("(select({a}, vec2<f32>(100.0, 0.3), !vec2<bool>(false, true)) {operator} {b}).x");
        assert!(matches!(of_constant(&folded, 7.629_394_5e-6), Verdict::Undetermined(_)), "{folded}");
    }
    // What is followed is held to what front ends may make of it.
    let of = |given| of_constant("fma(-2.5, asin(1.0), 4.0)", given);
    assert!(matches!(of(0.073_009_014), Verdict::Agree(_)) && matches!(of(0.08), Verdict::Deviate(_)));
}

/// Rows with the same arguments, for a language.
fn groups(language: Language) -> Vec<Vec<&'static Row>> {
    let mut groups: Vec<Vec<&Row>> = Vec::new();
    for row in rows().filter(|row| row.text(language).is_some()) {
        match groups.iter_mut().find(|group| group[0].types()[1..] == row.types()[1..]) {
            Some(group) => group.push(row),
            None => groups.push(vec![row]),
        }
    }
    groups
}

/// What a lane gives for the cases of a group that the table does not allow, and what it is accused of.
fn on_lane(lane: Box<dyn Lane>, prepared: &Prepared, language: Language, group: &[&Row]) -> (Vec<String>, usize) {
    let name = lane.description().name;
    let mut cases: Vec<(usize, Corner, Case)> = Vec::new();
    for (k, row) in group.iter().enumerate() {
        cases.extend(row.cases(language).into_iter().map(|(corner, case)| (k, corner, case)));
    }
    let promises = Promises::of_lane(lane.description());
    let asked = Request {
        replay: cases.iter().map(|(_, _, case)| sample(prepared, case)).collect(),
        replay_only: true,
        ..request(prepared, None, promises)
    };
    let seen: Rc<RefCell<BTreeMap<Vec<u32>, Vec<u32>>>> = Rc::default();
    let keep = Rc::clone(&seen);
    let planted = Planted::new(lane, prepared).with(move |dispatch| {
        for invocation in 0..dispatch.count {
            let arguments = dispatch.batch.invocation(invocation).to_vec();
            let given = dispatch.out(invocation).to_vec();
            keep.borrow_mut().entry(arguments).or_insert(given);
        }
    });
    let mut wrong = Vec::new();
    for stage in prepared.suite.stages(&planted) {
        let report: Report = run(prepared, &planted, stage, &asked, &mut |_| {}).unwrap();
        assert_eq!(report.unsupported, 0, "{name} {language}: {:?}", report.unsupported_because);
        let accuses = |kind| matches!(kind, FindingKind::Deviation | FindingKind::Flaky);
        let accused = report.findings.iter().filter(|finding| accuses(finding.kind));
        wrong.extend(accused.map(|finding| format!("{name} {language}: {}", finding.message)));
    }
    let seen = seen.borrow();
    let mut looked = 0;
    for (k, corner, case) in &cases {
        let row = group[*k];
        let Some(given) = seen.get(&case.arguments) else { continue };
        looked += 1;
        let held = !NOT_HELD.iter().any(|(name, of, at, _)| (*name, *of, *at) == (row.name, language, *corner));
        if held && !case.allows(given[*k], row.types()[0].0) {
            let (arguments, word) =
                (show(&case.arguments, &row.types()[1..]), show(&given[*k..=*k], &row.types()[..1]));
            let text = row.text(language).unwrap();
            wrong.push(format!("{name} {language}: `{text}`, {}, of {arguments} gives {word}", corner.name()));
        }
    }
    (wrong, looked)
}

#[test]
fn every_lane_gives_in_every_corner_what_the_table_says_and_is_not_accused() {
    let mut wrong = Vec::new();
    let mut looked: BTreeMap<(&str, Language), usize> = BTreeMap::new();
    for language in Language::ALL {
        for group in groups(language) {
            let prepared = match prepared(language, &group) {
                Ok(prepared) => prepared,
                Err(error) if lacks_compiler(&error) => {
                    not_run(&format!("the corners of HLSL: {error}"));
                    break;
                }
                Err(error) => panic!("{language}: {error}\n{}", text(language, &group)),
            };
            for lane in crate::built_ins::lanes() {
                let name = lane.description().name;
                // What another front end makes of the text is its own.
                if language != Language::Glsl && matches!(name, "opengl" | "vulkan-glslang") {
                    continue;
                }
                let (found, count) = on_lane(lane, &prepared, language, &group);
                wrong.extend(found);
                *looked.entry((name, language)).or_default() += count;
            }
        }
    }
    assert!(wrong.is_empty(), "{}\n{}", wrong.len(), wrong.join("\n"));
    assert!(looked.values().all(|count| *count > 300), "{looked:?}");
}

/// The page of the book.
fn page() -> String {
    let mut page = String::from(
        "# What specifications say at the edges

Built-in functions, operators and conversions have edges: ties of rounding, subnormal numbers, overflow, arguments outside of a
domain, NaN, zeros, infinities. What a device may give there is not what a calculator gives, and it differs from language to
language. shadercheck has a table of it, `crates/engine/src/corners/table/`. Tests hold its own judgement against each line, and
every lane; a built-in function without a line does not compile. What GLSL becomes in SPIR-V is held to what GLSL says.

## Rules for all functions

",
    );
    for corner in Corner::ALL {
        let rules = Language::ALL.iter().filter_map(|&language| Some((language, corner.rule(language)?)));
        for (k, (_, rule)) in rules.enumerate() {
            let head = if k == 0 { format!("- **{}**: ", corner.name()) } else { "  ".to_owned() };
            let _ = writeln!(page, "{head}{rule}.");
        }
    }
    page.push_str(
        "
## Functions

Arguments stand before `=`, and behind it what is right, with `|` between values that are right alike; `~` is near them, and `any`
whatever comes. Where a line of NaN or infinity is missing, anything is right.

",
    );
    for row in rows() {
        let of = |language: Language| Some(format!("{language} `{}` ({})", row.text(language)?, row.section(language)));
        let texts: Vec<String> = Language::ALL.into_iter().filter_map(of).collect();
        let _ =
            write!(page, "### {}\n\n{}\n\n| Corner | Language | Cases |\n|---|---|---|\n", row.name, texts.join(" · "));
        for cell in row.cells {
            let here = |language: &Language| cell.is_of(*language) && row.text(*language).is_some();
            let languages: Vec<String> =
                Language::ALL.into_iter().filter(here).map(|language| language.to_string()).collect();
            if languages.is_empty() {
                continue;
            }
            let all = languages.len() == texts.len();
            let languages = if all { "all".to_owned() } else { languages.join(", ") };
            let cases: Vec<String> =
                cell.cases.split("; ").map(|case| format!("`{}`", case.replace('|', "\\|"))).collect();
            let _ = writeln!(page, "| {} | {languages} | {} |", cell.corner.name(), cases.join(", "));
        }
        page.push('\n');
    }
    page.trim_end().to_owned() + "\n"
}

#[test]
fn the_page_of_the_book_is_the_table() {
    let file = root().join("docs/book/src/corners.md");
    let wanted = page();
    if std::env::var_os("SHADERCHECK_WRITE_PAGES").is_some() {
        std::fs::write(&file, &wanted).unwrap();
    }
    let found = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(found == wanted, "{} is not the table: run this test with SHADERCHECK_WRITE_PAGES=1", file.display());
}
