//! Large dispatches, judged word by word: devices that err as far as they may, in other orders of their invocations, are
//! not accused, and one that errs farther is.

use std::fs;
use std::ops::ControlFlow;

use base::value::Batch;
use engine::adversary::{Adversary, Strategy};
use engine::shard::Shard;
use engine::suite::load_all;
use engine::suite::run::{FindingKind, Prepared, Report, Request, Sampled, Share, prepare, run, run_part};
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
    let loaded = load_all(&root().join(format!("shaders/kernels/{name}.suite.toml"))).unwrap().remove(0);
    let suite = loaded.suite.variants().into_iter().find(|suite| suite.name.ends_with(size)).unwrap();
    let prepared = prepare(&suite, &loaded.shader).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(prepared.program.is_large(), "{name}");
    prepared
}

pub fn judged(prepared: &Prepared, lane: &dyn Lane, promises: Promises, samples: u64) -> Report {
    run(prepared, lane, Stage::Compute, &request(prepared, Some(samples), promises), &mut |_| {}).unwrap()
}

#[test]
fn a_device_that_errs_as_far_as_it_may_in_another_order_is_not_accused() {
    let (mut words, mut related) = (0, 0);
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
            let broken = report.findings.iter().find(|finding| finding.kind == FindingKind::Relation);
            assert!(broken.is_none(), "{name} {name_of}: {broken:?}");
            related += report.relations.iter().map(|(_, checked)| checked).sum::<u64>();
            agreed += report.verdicts.agreed;
            words += prepared.compute.output.words();
        }
        assert!(agreed > 0, "{name}: nothing is judged");
    }
    assert!(words > 50_000, "{words}");
    assert!(related > 10, "{related}");
}

/// A lane is wrong by itself, and a shader whatever the lane.
#[test]
fn a_law_that_is_broken_is_told_with_whose_values_break_it() {
    let broken = |report: &Report| -> Vec<String> {
        let all = report.findings.iter().filter(|finding| finding.kind == FindingKind::Relation);
        all.map(|finding| finding.message.clone()).collect()
    };
    let prepared = kernel("softmax", "[N=1367,ROWS=3]");
    for (part, count) in [(0.0, 0), (0.05, 1)] {
        let lane = Off(embedded::open().unwrap(), part);
        let found = broken(&judged(&prepared, &lane, Promises::of_lane(lane.description()), 2));
        assert_eq!(found.len(), count, "{found:?}");
        assert!(found.iter().all(|found| found.contains("`sums(shares)`") && found.contains("in the lane's values")));
    }
    let (sum, twin) = ("shaders/kernels/sum.suite.toml", "fixtures/kernels/twins/sum_tail.comp");
    let folder = tempfile::tempdir().unwrap();
    // Laws alone.
    let text = fs::read_to_string(root().join(sum)).unwrap();
    let suite: String = text.split_inclusive('\n').filter(|line| !line.starts_with("reference")).collect();
    assert!(!suite.contains("reference"), "{suite}");
    fs::write(folder.path().join("sum.suite.toml"), suite).unwrap();
    for (shader, count) in [("shaders/kernels/sum.comp", 0), (twin, 2)] {
        fs::copy(root().join(shader), folder.path().join("sum.comp")).unwrap();
        let loaded = load_all(&folder.path().join("sum.suite.toml")).unwrap().remove(0);
        let suite = loaded.suite.variants().into_iter().find(|suite| suite.name.ends_with("[N=70001]")).unwrap();
        let prepared = prepare(&suite, &loaded.shader).unwrap();
        let lane = embedded::open().unwrap();
        let found = broken(&judged(&prepared, &*lane, Promises::of_lane(lane.description()), 8));
        assert!((count == 0) == found.is_empty(), "{shader}: {found:?}");
        assert!(found.iter().all(|found| found.contains("in what the shader means")), "{found:?}");
    }
}

/// A sum by atomic functions comes in any order: what that may round to is known, and what is lost is more.
#[test]
fn sums_by_atomic_functions_are_judged() {
    let folder = tempfile::tempdir().unwrap();
    let text = "@group(0) @binding(0) var<storage, read> values: array<f32>;\n\
        @group(0) @binding(1) var<storage, read_write> total: array<atomic<f32>, 1>;\n\
        @compute @workgroup_size(64) fn sum(@builtin(global_invocation_id) id: vec3u) {\n\
        if (id.x < arrayLength(&values)) { atomicAdd(&total[0], values[id.x]); } }\n"
        .to_owned();
    let suite = "suite = \"total\"\nshader = \"total.wgsl\"\nstage = \"compute\"\nsamples = 4\n\
        reference = { file = \"sum.comp\", groups = 1 }\n[dispatch]\ngroups = \"(N + 63) / 64\"\n\
        lengths = { values = \"N\" }\nsizes = { N = [4999] }\n[[inputs]]\nnames = [\"values\"]\n\
        generator = \"array\"\nrange = [-8.0, 8.0]\n[[inputs]]\nnames = [\"total\"]\ngenerator = \"constant\"\n\
        values = [0.0]\n";
    fs::write(folder.path().join("total.suite.toml"), suite).unwrap();
    fs::copy(root().join("shaders/kernels/reference/sum.comp"), folder.path().join("sum.comp")).unwrap();
    // Each subtracts what it should add.
    let lost = text.replace("atomicAdd(", "atomicSub(");
    assert_ne!(lost, text);
    for (text, right) in [(text, true), (lost, false)] {
        fs::write(folder.path().join("total.wgsl"), text).unwrap();
        let loaded = load_all(&folder.path().join("total.suite.toml")).unwrap().remove(0);
        let prepared = prepare(&loaded.suite.variants()[0], &loaded.shader).unwrap();
        assert!(prepared.program.is_large());
        let wgsl = profile::by_name("wgsl").unwrap();
        for seed in [1, 2] {
            let lane = Adversary::lane(wgsl, Stage::Compute, Strategy::Extreme, seed, false);
            let report = judged(&prepared, &lane, Promises { text: wgsl, conformance: None, measured: None }, 4);
            let verdicts = &report.verdicts;
            assert_eq!(
                (verdicts.agreed, verdicts.undetermined_count()),
                (if right { 4 } else { 0 }, 0),
                "{:?}",
                report.findings
            );
        }
        let lane = Off(embedded::open().unwrap(), 1e-2);
        let report = judged(&prepared, &lane, Promises::of_lane(lane.description()), 4);
        assert!(report.verdicts.deviated > 0, "{right}: {:?}", report.findings);
    }
}

#[test]
fn a_run_tells_how_many_samples_it_takes_and_why() {
    let prepared = kernel("sum", "[N=70001]");
    let lane = embedded::open().unwrap();
    let promises = Promises::of_lane(lane.description());
    let of = |samples| {
        let request = Request { quick: false, ..request(&prepared, samples, promises.clone()) };
        run(&prepared, &*lane, Stage::Compute, &request, &mut |_| {}).unwrap()
    };
    let report = of(None);
    let budget = report.budget.as_ref().unwrap();
    assert_eq!((budget.asked, budget.samples), (32, report.judged()));
    assert!(budget.is_short() && budget.rounds.is_some_and(|rounds| rounds * (budget.samples + 1) > budget.limit));
    assert!(budget.to_string().contains("of 32 samples, since one takes"), "{budget}");
    assert!(report.relations.iter().all(|(_, checked)| *checked == budget.related), "{:?}", report.relations);
    let report = of(Some(3));
    let budget = report.budget.unwrap();
    assert_eq!((budget.asked, budget.samples, budget.related), (3, 3, 3));
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
