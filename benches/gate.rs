//! How fast the gate is: the raw device, `check` of the same number of samples, and one case a
//! dispatch, side by side in one run. Prints times and ratios; ratios are what to quote.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::time::{Duration, Instant};

use base::text::SourceFile;
use chapter::SUITES;
use engine::suite::run::{DEFAULT_SEED, Prepared, Request, prepare, run};
use engine::suite::{self, Suite};
use judge::profile::Promises;
use judge::verdict::{JudgeContext, Judges, judge_batch};
use lanes::{Lane, Stage, vulkan};
use property::Sampler;

/// Samples of the large runs.
const SAMPLES: u64 = 1 << 20;
/// Dispatches of one case that are timed; the time of all samples is scaled from them.
const SINGLE: usize = 512;
/// Repetitions; the fastest counts, since other work on the machine only ever slows a run down.
const REPEAT: usize = 5;

fn main() {
    let lane = match vulkan::open() {
        Ok(lane) => lane,
        Err(missing) => {
            println!("the benchmark needs the lane `vulkan`: {missing}");
            std::process::exit(2);
        }
    };
    println!("{}", lane.description().driver);
    println!("{SAMPLES} samples, fastest of {REPEAT}, times in ms\n");
    println!("suite              inputs       raw     judge     check   check/raw   one a dispatch   batched gain");
    for name in ["sphere", "skinning"] {
        compare(name, lane.as_ref());
    }
    println!();
    println!(
        "suite              judged samples a second of one core, in thousands; without glances; ratio; settled by glances"
    );
    let mut rates: Vec<[f64; 2]> = SUITES.iter().map(|suite| of_one_core(suite.name, lane.as_ref())).collect();
    rates.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let median = rates[rates.len() / 2][0];
    rates.sort_by(|a, b| (a[0] / a[1]).total_cmp(&(b[0] / b[1])));
    let ratio = rates[rates.len() / 2];
    println!("median             {:>8.0}   ratio {:.2}\n", median / 1e3, ratio[0] / ratio[1]);
    quick(lane.as_ref());
    memory(lane.as_ref());
}

fn prepared(name: &str) -> Prepared {
    let shipped = suite::find(name).unwrap_or_else(|e| panic!("{e}"));
    // Without relations: they are further samples, and the raw run has none.
    let parsed = parsed(shipped);
    let suite = Suite { relations: Vec::new(), ..parsed };
    let shader = SourceFile::new(shipped.shader_name, shipped.shader_text);
    prepare(&suite, &shader).unwrap_or_else(|e| panic!("{e}"))
}

fn parsed(shipped: &suite::ShippedSuite) -> Suite {
    suite::parse(&SourceFile::new(shipped.path, shipped.toml)).unwrap_or_else(|e| panic!("{e}"))
}

fn request(samples: u64, promises: &Promises) -> Request {
    Request {
        samples: Some(samples),
        seed: DEFAULT_SEED,
        quick: false,
        replay: Vec::new(),
        replay_only: false,
        arguments: String::new(),
        promises: promises.clone(),
    }
}

fn fastest(mut work: impl FnMut()) -> Duration {
    (0..REPEAT)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed()
        })
        .min()
        .unwrap_or_default()
}

/// Upload, dispatch and readback of ready-made batches, against the whole of `check`: making inputs,
/// the same, the formula, the judge.
fn compare(name: &str, lane: &dyn Lane) {
    let prepared = prepared(name);
    let promises = Promises::of_lane(lane.description());
    let Prepared { oracle, reference, .. } = &prepared;
    let context = JudgeContext { oracle, reference, promises: &promises, stage: Stage::Compute };
    let per_case = prepared.suite.per_case;
    let sampler = Sampler::new(prepared.plan.clone(), DEFAULT_SEED);
    let mut runner = lane.prepare(&prepared.compute, 1 << 17).unwrap_or_else(|e| panic!("{e}"));
    let cases = runner.capacity() / per_case;
    let batches: Vec<_> =
        (0..SAMPLES / (cases * per_case) as u64).map(|k| sampler.batch(k * cases as u64, cases, per_case)).collect();
    let check = |samples: u64| {
        let report = run(&prepared, lane, Stage::Compute, &request(samples, &promises), &mut |_| {});
        let report = report.unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(report.verdicts.deviated, 0, "{name}");
        assert!(report.judged() >= samples * 9 / 10, "{name}");
    };
    // In turn, so that a slow moment of the machine meets both.
    let [mut inputs, mut raw, mut judge, mut checked] = [Duration::MAX; 4];
    for _ in 0..REPEAT {
        let start = Instant::now();
        for k in 0..batches.len() as u64 {
            std::hint::black_box(sampler.batch(k * cases as u64, cases, per_case));
        }
        inputs = inputs.min(start.elapsed());
        let start = Instant::now();
        let actuals: Vec<_> = batches.iter().map(|b| runner.run(b).unwrap_or_else(|e| panic!("{e}"))).collect();
        raw = raw.min(start.elapsed());
        let start = Instant::now();
        for (batch, actual) in batches.iter().zip(&actuals) {
            std::hint::black_box(judge_batch(&context, batch, actual));
        }
        judge = judge.min(start.elapsed());
        let start = Instant::now();
        check(SAMPLES);
        checked = checked.min(start.elapsed());
    }
    let single = {
        let one = sampler.batch(0, SINGLE, 1);
        let samples: Vec<_> = (0..SINGLE)
            .map(|k| {
                let mut batch = one.clone();
                batch.invocations = one.invocation(k).to_vec();
                batch.cases = one.case(k).to_vec();
                batch
            })
            .collect();
        let time = fastest(|| {
            for batch in &samples {
                let actual = runner.run(batch).unwrap_or_else(|e| panic!("{e}"));
                std::hint::black_box(judge_batch(&context, batch, &actual));
            }
        });
        time.mul_f64(SAMPLES as f64 / SINGLE as f64)
    };
    println!(
        "{name:<16} {:>8.1}  {:>8.1}  {:>8.1}  {:>8.1}   {:>8.2}   {:>12.0} ms   {:>9.0} ×",
        ms(inputs),
        ms(raw),
        ms(judge),
        ms(checked),
        checked.as_secs_f64() / raw.as_secs_f64(),
        ms(single),
        single.as_secs_f64() / checked.as_secs_f64()
    );
}

/// Prints how many samples of a suite the judge judges in a second of one core, and how many it would without glances.
fn of_one_core(name: &str, lane: &dyn Lane) -> [f64; 2] {
    let prepared = prepared(name);
    let promises = Promises::of_lane(lane.description());
    let Prepared { oracle, reference, .. } = &prepared;
    let context = JudgeContext { oracle, reference, promises: &promises, stage: Stage::Compute };
    let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |strands| strands.primitives()).max(1);
    let sampler = Sampler::new(prepared.plan.clone(), DEFAULT_SEED);
    let mut runner = lane.prepare(&prepared.compute, 1 << 15).unwrap_or_else(|e| panic!("{e}"));
    let batch = sampler.batch(0, runner.capacity() / per_case, per_case);
    let actual = runner.run(&batch).unwrap_or_else(|e| panic!("{e}"));
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap_or_else(|e| panic!("{e}"));
    // In turn, so that a slow moment of the machine meets both.
    let (mut times, mut glanced) = ([Duration::MAX; 2], [0; 2]);
    for _ in 0..REPEAT {
        let of = [Judges::new(&context), Judges::new(&context).without_glances()];
        let verdicts = [0, 1].map(|k| {
            let start = Instant::now();
            let verdict = one.install(|| of[k].judge(&batch, &actual));
            times[k] = times[k].min(start.elapsed());
            format!("{verdict:?}")
        });
        assert_eq!(verdicts[0], verdicts[1], "{name}: a glance settles what a tape does not");
        glanced = of[0].glanced();
    }
    let rates = times.map(|time| batch.invocation_count() as f64 / time.as_secs_f64());
    // Of all samples: those that were not glanced at any more count as well.
    let settled = 100.0 * glanced[1] as f64 / batch.invocation_count() as f64;
    let [with, without] = rates.map(|rate| rate / 1e3);
    println!("{name:<16}   {with:>8.0}   {without:>8.0}   {:>5.2}   {settled:>5.1} %", with / without);
    rates
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// All suites on all stages, as `check --quick` runs them.
fn quick(lane: &dyn Lane) {
    let promises = Promises::of_lane(lane.description());
    let time = fastest(|| {
        for shipped in SUITES {
            let suite = parsed(shipped);
            let shader = SourceFile::new(shipped.shader_name, shipped.shader_text);
            let prepared = prepare(&suite, &shader).unwrap_or_else(|e| panic!("{e}"));
            let request = Request { samples: None, quick: true, ..request(1, &promises) };
            for stage in [Stage::Compute, Stage::Vertex] {
                if stage == Stage::Compute || prepared.vertex.is_some() {
                    let report = run(&prepared, lane, stage, &request, &mut |_| {});
                    assert!(report.unwrap_or_else(|e| panic!("{e}")).errors().is_empty(), "{}", suite.name);
                }
            }
        }
    });
    println!("check --quick, all suites: {:.2} s", time.as_secs_f64());
}

/// Peak memory after a run of 2^20 samples and after one of 2^23.
fn memory(lane: &dyn Lane) {
    let prepared = prepared("sphere");
    let promises = Promises::of_lane(lane.description());
    let peak = |samples: u64| {
        let report = run(&prepared, lane, Stage::Compute, &request(samples, &promises), &mut |_| {});
        assert_eq!(report.unwrap_or_else(|e| panic!("{e}")).verdicts.deviated, 0);
        std::fs::read_to_string("/proc/self/status").ok().and_then(|s| {
            s.lines()
                .find_map(|l| l.strip_prefix("VmHWM:"))
                .and_then(|v| v.split_whitespace().next()?.parse::<u64>().ok())
        })
    };
    match (peak(SAMPLES), peak(8 * SAMPLES)) {
        (Some(small), Some(large)) => println!(
            "peak memory: {} MiB after {SAMPLES} samples, {} MiB after {} samples",
            small / 1024,
            large / 1024,
            8 * SAMPLES
        ),
        _ => println!("peak memory: not known on this system"),
    }
}
