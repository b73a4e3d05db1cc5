//! The interpreter against the formulas of the shipped suites.

use base::text::SourceFile;
use base::value::{Batch, Scalar};
use engine::suite::run::{Prepared, prepare};
use engine::suite::{parse, shipped};
use judge::formula::{Args, Emission, Rule};
use judge::profile::Promises;
use judge::verdict::{JudgeContext, judge_batch};
use lanes::{Actual, Api, Marks, Stage};
use program::interp::{self, Binary32, Binary64, Meaning};
use property::Sampler;

const SEED: u64 = 7;

fn prepared(name: &str, edit: impl Fn(&str) -> String) -> Prepared {
    let shipped = engine::suite::find(name).unwrap();
    let suite = parse(&SourceFile::new(shipped.path, shipped.toml)).unwrap();
    prepare(&suite, &SourceFile::new(shipped.shader_name, edit(shipped.shader_text))).unwrap()
}

fn batch(prepared: &Prepared, cases: usize) -> Batch {
    let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
    Sampler::new(prepared.plan.clone(), SEED).batch(0, cases, per_case)
}

fn decode(word: u32, scalar: Scalar) -> f64 {
    match scalar {
        Scalar::F32 => f64::from(f32::from_bits(word)),
        Scalar::I32 => f64::from(word.cast_signed()),
        Scalar::U32 | Scalar::Bool => f64::from(word),
    }
}

/// The inputs of the formula, by name, as numbers; those of one invocation behind each other.
fn inputs(prepared: &Prepared, batch: &Batch, invocation: usize) -> Vec<f64> {
    let mut all = Vec::new();
    for param in prepared.reference.formula().unwrap().inputs {
        let own = (&batch.invocation_record, batch.invocation(invocation));
        let case = (&batch.case_record, batch.case_of(invocation));
        let (record, words) = if own.0.index_of(param.name).is_some() { own } else { case };
        let index = record.index_of(param.name).unwrap();
        let scalar = record.fields()[index].shape.scalar;
        let at = all.len();
        all.extend(words[record.range(index)].iter().map(|&word| decode(word, scalar)));
        // The literals of these shaders are binary32; the formula gets an angle that makes up for it.
        use std::f64::consts::{PI, TAU};
        match (prepared.suite.name.as_str(), param.name) {
            ("sphere", "parameter") => {
                all[at] *= f64::from(TAU as f32) / TAU;
                all[at + 1] *= f64::from(PI as f32) / PI;
            }
            ("cylinder", "parameter") => all[at] *= f64::from(TAU as f32) / TAU,
            _ => {}
        }
    }
    all
}

fn formula(prepared: &Prepared, inputs: &[f64]) -> (Vec<f64>, Vec<u32>) {
    let formula = prepared.reference.formula().unwrap();
    let args = Args::new(formula.inputs, inputs);
    match formula.rule {
        Rule::Pointwise(rule) => {
            let mut words = vec![0.0; formula.outputs.iter().map(|param| param.words()).sum()];
            rule(&args, &mut words);
            (words, Vec::new())
        }
        Rule::Emission(rule) => {
            let mut emission = Emission::default();
            rule(&args, &mut emission);
            (emission.words, emission.strips)
        }
    }
}

/// The words of an invocation in the order of the formula's outputs.
fn outputs(prepared: &Prepared, meaning: &Meaning<f64>, invocation: usize) -> Vec<f64> {
    let record = prepared.program.output_layout().vertex;
    let mut all = Vec::new();
    for vertex in 0..meaning.stored(invocation) {
        for param in prepared.reference.formula().unwrap().outputs {
            let index = record.index_of(param.name).unwrap();
            all.extend(&meaning.vertex(invocation, vertex)[record.range(index)]);
        }
    }
    all
}

/// Σ X·|∂y/∂x| with X the largest input: how much of the inputs' own rounding passes through.
fn sensitivity(prepared: &Prepared, inputs: &[f64], base: &[f64]) -> Vec<f64> {
    let step = 2f64.powi(-24);
    let size = inputs.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut sum = vec![0.0; base.len()];
    let mut moved = inputs.to_vec();
    for k in 0..inputs.len() {
        // Integers are not moved.
        if inputs[k].fract() == 0.0 && prepared.reference.formula().unwrap().inputs[0].name == "part" {
            continue;
        }
        moved[k] = inputs[k] + size * step;
        let (words, _) = formula(prepared, &moved);
        moved[k] = inputs[k];
        for ((sum, y), y0) in sum.iter_mut().zip(&words).zip(base) {
            *sum += (y - y0).abs() / step;
        }
    }
    sum
}

/// Invocations whose meaning is not the formula's value, and the number of all that were compared.
fn deviating(prepared: &Prepared, cases: usize) -> (Vec<String>, usize) {
    let batch = batch(prepared, cases);
    let meaning = interp::run::<Binary64>(&prepared.program, &batch).unwrap();
    assert!(meaning.findings().is_empty(), "{:?}", meaning.findings());
    assert!(meaning.unwritten().is_empty());
    let (mut wrong, mut compared) = (Vec::new(), 0);
    for invocation in 0..batch.invocation_count() {
        let inputs = inputs(prepared, &batch, invocation);
        let (expected, strips) = formula(prepared, &inputs);
        let found = outputs(prepared, &meaning, invocation);
        if expected.iter().any(|y| !y.is_finite()) {
            continue;
        }
        compared += 1;
        assert_eq!(found.len(), expected.len());
        for (vertex, &strip) in strips.iter().enumerate() {
            assert_eq!(meaning.strip(invocation, vertex), strip);
        }
        let mut passed = None;
        for (k, (&found, &expected_word)) in found.iter().zip(&expected).enumerate() {
            let error = (found - expected_word).abs();
            let near = |scale: f64| error <= 1e-12 * scale;
            if !near(expected_word.abs()) {
                let passed = passed.get_or_insert_with(|| sensitivity(prepared, &inputs, &expected));
                if !near(passed[k] + expected_word.abs()) {
                    wrong
                        .push(format!("{invocation}.{k}: {found:e}, formula {expected_word:e}, scale {:e}", passed[k]));
                    break;
                }
            }
        }
    }
    (wrong, compared)
}

#[test]
fn the_meaning_of_every_shipped_shader_is_its_formula() {
    assert_eq!(shipped().count(), 14);
    for suite in shipped() {
        let prepared = prepared(suite.name, str::to_owned);
        let (wrong, compared) = deviating(&prepared, 64);
        assert!(wrong.is_empty(), "{}: {} of {compared}: {}", suite.name, wrong.len(), wrong[0]);
        assert!(compared >= 60, "{}: {compared}", suite.name);
    }
}

#[test]
fn a_wrong_shader_does_not_mean_the_formula() {
    for (name, right, wrong) in [
        ("sphere", "cos(th)", "sin(th)"),
        ("skinning", "p - p0[i];", "p - p1[i];"),
        ("skinning", "i < numberOfBones", "i + 1 < numberOfBones"),
        ("morph", "mix(p0, p1, t)", "mix(p1, p0, t)"),
        ("hair", "0.5;\n  vec4 m1", "0.500001;\n  vec4 m1"),
        ("bone_weight", "d + 1.0", "d + 1.0000002"),
        ("segment_distance", "0.0, 1.0)", "0.0, 1.5)"),
    ] {
        let prepared = prepared(name, |text| {
            assert!(text.contains(right), "{name}");
            text.replacen(right, wrong, 1)
        });
        let (wrong, compared) = deviating(&prepared, 16);
        assert!(!wrong.is_empty(), "{name}: none of {compared}");
    }
}

#[test]
fn vertices_past_the_limit_are_counted_and_not_stored() {
    let prepared = prepared("hair", |text| text.replacen("max_vertices = 5", "max_vertices = 3", 1));
    let meaning = interp::run::<Binary64>(&prepared.program, &batch(&prepared, 2)).unwrap();
    assert_eq!((meaning.emitted(0), meaning.stored(0), meaning.ended_strips(0)), (5, 3, 1));
    assert_eq!((meaning.strip(0, 0), meaning.strip(0, 2)), (0, 0));
}

#[test]
fn an_output_that_is_written_before_the_first_vertex_alone_is_unwritten_behind_it() {
    let prepared = prepared("hair", |text| {
        let line = "v = -normalize(position.xyz);";
        assert!(text.contains(line));
        text.replacen(line, "if (i == 0) v = -normalize(position.xyz);", 1)
    });
    let meaning = interp::run::<Binary64>(&prepared.program, &batch(&prepared, 2)).unwrap();
    let record = prepared.program.output_layout().vertex;
    let v = record.range(record.index_of("v").unwrap());
    for word in 0..record.words() {
        assert!(meaning.is_written(0, 0, word));
        assert_eq!(meaning.is_written(0, 1, word), !v.contains(&word));
    }
}

/// What a lane would have written.
fn actual(prepared: &Prepared, meaning: &Meaning<u32>) -> Actual {
    let layout = prepared.program.output_layout();
    let marks = Marks::random();
    let mut words = Vec::new();
    for invocation in 0..meaning.count() {
        let end = words.len() + layout.words();
        words.push(marks.canary ^ invocation as u32);
        if layout.max_vertices.is_some() {
            words.extend([meaning.emitted(invocation), meaning.ended_strips(invocation)]);
        }
        for vertex in 0..meaning.stored(invocation) {
            if layout.max_vertices.is_some() {
                words.push(meaning.strip(invocation, vertex));
            }
            words.extend(meaning.vertex(invocation, vertex));
        }
        words.resize(end, marks.sentinel);
    }
    Actual::accept(&layout, words, meaning.count(), marks).unwrap()
}

#[test]
fn strict_binary32_keeps_what_its_profile_says_in_every_shipped_suite() {
    for suite in shipped() {
        let prepared = prepared(suite.name, str::to_owned);
        let batch = batch(&prepared, 64);
        let meaning = interp::run::<Binary32>(&prepared.program, &batch).unwrap();
        let actual = actual(&prepared, &meaning);
        let promises = Promises::of_api(Api::Binary32);
        let Prepared { oracle, reference, .. } = &prepared;
        let context = JudgeContext { oracle, reference, promises: &promises, stage: Stage::Compute };
        let verdict = judge_batch(&context, &batch, &actual);
        assert!(verdict.failures.is_empty(), "{}: {:?}", suite.name, verdict.failures[0]);
        let share = verdict.undetermined_count() as f64 / verdict.seen() as f64;
        assert!(verdict.agreed > 60 && share <= prepared.suite.floors.undetermined, "{}: {verdict:?}", suite.name);
        assert!(verdict.max_ulp > 0.0, "{}: not binary32", suite.name);
    }
}

#[test]
#[ignore = "a measurement, for release builds: cargo test --release --test it -- --ignored --nocapture samples_per"]
fn samples_per_second_on_one_core() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for name in ["skinning", "sphere", "hair"] {
        let prepared = prepared(name, str::to_owned);
        let batch = batch(&prepared, (1 << 18) / batch(&prepared, 1).invocation_count());
        let executable = interp::compile(&prepared.program).unwrap();
        let count = batch.invocation_count() as f64;
        let time = |f: &(dyn Fn() + Sync)| {
            let once = || {
                let start = std::time::Instant::now();
                pool.install(f);
                start.elapsed().as_secs_f64()
            };
            (0..5).map(|_| once()).fold(f64::INFINITY, f64::min)
        };
        let wide = time(&|| drop(executable.run::<Binary64>(&batch, interp::FUEL).unwrap()));
        let narrow = time(&|| drop(executable.run::<Binary32>(&batch, interp::FUEL).unwrap()));
        let message =
            format!("{name}: binary64 {:.2} M/s, binary32 {:.2} M/s", count / wide / 1e6, count / narrow / 1e6);
        assert!(wide < count / 1e5, "{message}");
        std::io::Write::write_fmt(&mut std::io::stderr(), format_args!("{message}\n")).unwrap();
    }
}
