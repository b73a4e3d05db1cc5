//! Large dispatches, judged word by word: devices that err as far as they may, in other orders of their invocations, are
//! not accused, and one that errs farther is.

use std::ops::ControlFlow;

use base::value::Batch;
use engine::adversary::{Adversary, Strategy};
use engine::shard::Shard;
use engine::suite::load;
use engine::suite::run::{FindingKind, Prepared, Report, Sampled, Share, prepare, run, run_part};
use judge::profile::{self, Promises};
use lanes::{Actual, Description, Lane, LaneError, Runner, Stage, embedded};
use program::Kernel;

use crate::binary::root;
use crate::support::request;

/// Kernels with the size in which they are large.
const KERNELS: [(&str, &str); 8] = [
    ("sum", "[N=70001]"),
    ("dot", "[N=4111]"),
    ("scan", "[N=5003]"),
    ("softmax", "[N=1367,ROWS=3]"),
    ("layer_norm", "[N=1367,ROWS=2]"),
    ("blur", "[HEIGHT=2,WIDTH=1033]"),
    ("particles", "[N=1031]"),
    ("skinning", "[N=1031]"),
];

fn kernel(name: &str, size: &str) -> Prepared {
    let loaded = load(&root().join(format!("shaders/kernels/{name}.suite.toml"))).unwrap();
    let suite = loaded.suite.variants().into_iter().find(|suite| suite.name.ends_with(size)).unwrap();
    let prepared = prepare(&suite, &loaded.shader).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(prepared.program.is_large(), "{name}");
    prepared
}

fn judged(prepared: &Prepared, lane: &dyn Lane, promises: Promises, samples: u64) -> Report {
    run(prepared, lane, Stage::Compute, &request(prepared, Some(samples), promises), &mut |_| {}).unwrap()
}

#[test]
fn a_device_that_errs_as_far_as_it_may_in_another_order_is_not_accused() {
    let mut words = 0;
    for (name, size) in KERNELS {
        let prepared = kernel(name, size);
        let mut agreed = 0;
        for (name_of, strategy, rearrange) in [
            ("vulkan-1.4", Strategy::Mixed, true),
            ("vulkan-cts", Strategy::Extreme, true),
            ("wgsl", Strategy::BySite, false),
        ] {
            let profile = profile::by_name(name_of).unwrap();
            let lane = Adversary::lane(profile, Stage::Compute, strategy, 7, rearrange);
            let promises = Promises { text: profile, conformance: None, measured: None };
            let report = judged(&prepared, &lane, promises, 1);
            assert_eq!(report.verdicts.deviated, 0, "{name} {name_of}: {:?}", report.findings);
            agreed += report.verdicts.agreed;
            words += prepared.compute.output.words();
        }
        assert!(agreed > 0, "{name}: nothing is judged");
    }
    assert!(words > 50_000, "{words}");
}

/// A lane whose largest number among the first outputs is off by a part of its value.
struct Off(Box<dyn Lane>, f32);

struct OffRunner(Box<dyn Runner>, f32);

impl Lane for Off {
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        Ok(Box::new(OffRunner(self.0.prepare(kernel, capacity)?, self.1)))
    }
}

impl Runner for OffRunner {
    fn capacity(&self) -> usize {
        self.0.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let actual = self.0.run(batch)?;
        let size = |word: &&u32| f32::from_bits(**word).abs();
        let largest = actual.vertex(0, 0).iter().take(64).max_by(|a, b| size(a).total_cmp(&size(b)));
        let found = *largest.unwrap();
        let off = (f32::from_bits(found) * (1.0 + self.1)).to_bits();
        Ok(actual.altered(|word| if word == found { off } else { word }))
    }
}

#[test]
fn a_device_that_errs_farther_is_accused_and_the_shader_is_not() {
    for (name, size, part) in
        [("sum", "[N=70001]", 1e-3), ("particles", "[N=1031]", 1e-5), ("blur", "WIDTH=1033]", 1e-5)]
    {
        let prepared = kernel(name, size);
        for (part, deviated) in [(0.0, false), (part, true)] {
            let lane = Off(embedded::open().unwrap(), part);
            let report = judged(&prepared, &lane, Promises::of_lane(lane.description()), 1);
            assert_eq!(report.verdicts.deviated > 0, deviated, "{name} {part}: {:?}", report.findings);
            assert_eq!(report.verdicts.shader_deviated, 0, "{name}");
            let told = report.findings.iter().find(|finding| finding.kind == FindingKind::Deviation);
            assert_eq!(told.is_some_and(|found| found.message.starts_with("the lane deviates")), deviated, "{name}");
        }
    }
}

#[test]
fn a_run_that_is_taken_up_again_keeps_what_was_found() {
    let prepared = kernel("sum", "[N=70001]");
    let (right, off) = (embedded::open().unwrap(), Off(embedded::open().unwrap(), 1e-3));
    let request = request(&prepared, Some(2), Promises::of_lane(right.description()));
    let mut kept = None;
    let mut stop = |sampled: &Sampled| {
        kept = Some(sampled.clone());
        ControlFlow::Break(())
    };
    let mut go_on = |_: &Sampled| ControlFlow::Continue(());
    let way = (Stage::Compute, None);
    let share = Share { shard: Shard::WHOLE, resume: None, save: &mut stop, partial: true };
    assert!(run_part(&prepared, &off, way, &request, share, &mut |_| {}).unwrap().is_none());
    // What is left is right.
    let share = Share { shard: Shard::WHOLE, resume: kept, save: &mut go_on, partial: true };
    let report = run_part(&prepared, &*right, way, &request, share, &mut |_| {}).unwrap().unwrap().report();
    assert_eq!((report.verdicts.agreed, report.verdicts.deviated), (1, 1));
    let told = report.findings.iter().find(|finding| finding.kind == FindingKind::Deviation);
    assert!(told.is_some_and(|told| told.message.ends_with("in sample 0")), "{:?}", report.findings);
}
