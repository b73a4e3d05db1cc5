//! The shipped suites on a device that errs as far as it may.

use base::text::SourceFile;
use base::value::Batch;
use engine::adversary::{Adversary, Strategy};
use engine::suite::run::{Prepared, prepare};
use engine::suite::{parse, shipped};
use judge::profile;
use lanes::{Actual, Lane, LaneError, Stage, embedded};
use program::interp::{self, Binary32, Binary64, Laws};
use property::{Sampler, Stream};

const SAMPLES: usize = 2000;

fn suites() -> Vec<Prepared> {
    let ready = shipped().map(|suite| {
        let parsed = parse(&SourceFile::new(suite.path, suite.toml)).unwrap();
        prepare(&parsed, &SourceFile::new(suite.shader_name, suite.shader_text)).unwrap()
    });
    let suites: Vec<Prepared> = ready.collect();
    assert_eq!(suites.len(), 14);
    suites
}

fn batch(prepared: &Prepared) -> Batch {
    let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
    Sampler::new(prepared.plan.clone(), 11).batch(0, SAMPLES.div_ceil(per_case), per_case)
}

fn run(lane: &dyn Lane, prepared: &Prepared, batch: &Batch) -> Result<Actual, LaneError> {
    lane.prepare(&prepared.compute, batch.invocation_count())?.run(batch)
}

/// Invocations for which two lanes wrote different bits.
fn different(a: &Actual, b: &Actual) -> usize {
    let words =
        |actual: &Actual, k| -> Vec<u32> { (0..actual.stored(k)).flat_map(|v| actual.vertex(k, v).to_vec()).collect() };
    (0..a.count()).filter(|&k| words(a, k) != words(b, k)).count()
}

#[test]
fn every_shipped_suite_runs_on_it_and_gets_other_results() {
    let strict = embedded::open().unwrap();
    for prepared in suites() {
        let batch = batch(&prepared);
        let expected = run(&*strict, &prepared, &batch).unwrap();
        for (name, strategy, rearrange) in [
            ("vulkan-1.4", Strategy::Mixed, true),
            ("vulkan-cts", Strategy::BySite, false),
            ("wgsl", Strategy::Extreme, true),
            ("glsl-4.60", Strategy::Random, false),
        ] {
            let profile = profile::by_name(name).unwrap();
            let lane = Adversary::lane(profile, Stage::Vertex, strategy, 5, rearrange);
            let what = format!("{} {name}", prepared.suite.name);
            let found = run(&lane, &prepared, &batch).unwrap_or_else(|error| panic!("{what}: {error}"));
            assert_eq!(found.count(), batch.invocation_count());
            let different = different(&expected, &found);
            assert!(different * 4 > found.count(), "{what}: {different} of {}", found.count());
            let again = run(&lane, &prepared, &batch).unwrap();
            assert_eq!(self::different(&found, &again), 0, "{what}");
        }
    }
}

#[test]
fn rearranged_shaders_mean_the_same() {
    let mut moved = 0;
    for prepared in suites() {
        let batch = batch(&prepared);
        let original = interp::compile(&prepared.program).unwrap();
        let meaning = original.run::<Binary64>(&batch, interp::FUEL).unwrap();
        let strict = original.run::<Binary32>(&batch, interp::FUEL).unwrap();
        for (laws, seed) in [(Laws::Order, 1), (Laws::Distribution, 2), (Laws::Distribution, 3)] {
            let mut stream = Stream::new(seed);
            let rearranged = original.rearranged(laws, &mut |n| stream.below(n));
            let found = rearranged.run::<Binary64>(&batch, interp::FUEL).unwrap();
            let rounded = rearranged.run::<Binary32>(&batch, interp::FUEL).unwrap();
            let (mut far, mut all) = (0, 0);
            for k in 0..meaning.count() {
                assert_eq!(meaning.emitted(k), found.emitted(k));
                for vertex in 0..meaning.stored(k) {
                    let (a, b) = (meaning.vertex(k, vertex), found.vertex(k, vertex));
                    let size = a.iter().fold(1.0_f64, |size, y| size.max(y.abs()));
                    far += a.iter().zip(b).filter(|(a, b)| a.is_finite() && !((*a - *b).abs() <= 1e-9 * size)).count();
                    all += a.len();
                    moved += usize::from(strict.vertex(k, vertex) != rounded.vertex(k, vertex));
                }
            }
            // Inputs can be so large that terms cancel to far less than they are.
            assert!(far * 100 <= all, "{} {laws:?}: {far} of {all}", prepared.suite.name);
        }
    }
    assert!(moved > 1000, "{moved}");
}
