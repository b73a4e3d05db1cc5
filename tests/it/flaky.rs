//! A lane that gives other bits for the same inputs: told as such, and not shrunk.

use std::cell::Cell;
use std::rc::Rc;

use shadercheck::bound::profile::Rulings;
use shadercheck::lane::{Actual, Description, Lane, LaneError, Marks, Runner, Stage, embedded};
use shadercheck::program::{Kernel, OutputLayout};
use shadercheck::suite::run::{DEFAULT_SEED, Finding, FindingKind, Prepared, Report, Request, prepare, run};
use shadercheck::suite::{find, parse};
use shadercheck::text::SourceFile;
use shadercheck::value::Batch;
use shadercheck::verdict::Blame;

use crate::alarms::{prepared, raw};

/// The interpreter, which changes the first output of some dispatches.
struct Flaky {
    lane: Box<dyn Lane>,
    change: fn(usize, f32) -> f32,
    layout: OutputLayout,
    dispatches: Rc<Cell<usize>>,
}

struct FlakyRunner {
    runner: Box<dyn Runner>,
    change: fn(usize, f32) -> f32,
    layout: OutputLayout,
    dispatches: Rc<Cell<usize>>,
}

impl Lane for Flaky {
    fn description(&self) -> &Description {
        self.lane.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        let (runner, dispatches) = (self.lane.prepare(kernel, capacity)?, Rc::clone(&self.dispatches));
        if kernel.output != self.layout {
            return Ok(runner);
        }
        Ok(Box::new(FlakyRunner { runner, change: self.change, layout: kernel.output.clone(), dispatches }))
    }
}

impl Runner for FlakyRunner {
    fn capacity(&self) -> usize {
        self.runner.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let actual = self.runner.run(batch)?;
        let dispatch = self.dispatches.replace(self.dispatches.get() + 1);
        let marks = Marks::random();
        let mut words = raw(&actual, &self.layout, marks);
        for record in words.chunks_exact_mut(self.layout.words()) {
            let at = self.layout.header_words();
            record[at] = (self.change)(dispatch, f32::from_bits(record[at])).to_bits();
        }
        Actual::accept(&self.layout, words, actual.count(), marks)
    }
}

fn report(prepared: &Prepared, change: fn(usize, f32) -> f32) -> (Report, usize) {
    let dispatches = Rc::new(Cell::new(0));
    let layout = prepared.program.output_layout();
    let lane = Flaky { lane: embedded::open().unwrap(), change, layout, dispatches: Rc::clone(&dispatches) };
    let request = Request {
        samples: Some(512),
        seed: DEFAULT_SEED,
        quick: true,
        replay: Vec::new(),
        replay_only: false,
        rulings: Rulings::of_lane(lane.description()),
        arguments: prepared.suite.name.clone(),
    };
    (run(prepared, &lane, Stage::Compute, &request, &mut |_| {}).unwrap(), dispatches.get())
}

fn of_kind(report: &Report, kind: FindingKind) -> Vec<&Finding> {
    report.findings.iter().filter(|finding| finding.kind == kind).collect()
}

#[test]
fn a_lane_that_repeats_itself_is_not_flaky() {
    let (right, _) = report(&prepared("morph"), |_, x| x);
    assert!(right.findings.is_empty(), "{:?}", right.findings);
    let repeated = right.repeated.unwrap();
    assert_eq!((repeated.samples, repeated.different), (256, 0));
    // What is wrong each time is wrong, and not flaky.
    let (wrong, _) = report(&prepared("morph"), |_, x| x + 0.5);
    assert!(of_kind(&wrong, FindingKind::Flaky).is_empty(), "{:?}", wrong.findings);
    assert!(!of_kind(&wrong, FindingKind::Deviation).is_empty());
}

#[test]
fn outputs_that_change_from_run_to_run_are_told_and_not_shrunk() {
    // The first dispatch is wrong, and from then on every third.
    let (report, dispatches) = report(&prepared("morph"), |k, x| if k % 3 == 0 { x + 0.5 } else { x });
    let flaky = of_kind(&report, FindingKind::Flaky);
    let told =
        flaky.iter().find(|f| f.message.contains(" of 5 runs of the same inputs gave other bits than the first"));
    let told = told.unwrap_or_else(|| panic!("{:?}", report.findings));
    assert!(told.message.starts_with("flaky: ") && told.message.ends_with("the lane is not deterministic"));
    let case = told.case.as_ref().unwrap();
    assert_eq!((case.rounds, case.tried), (0, 0));
    assert!(case.deviation.as_ref().is_none_or(|deviation| deviation.blame == Blame::Lane));
    assert!(told.reproduce.as_ref().unwrap().contains(" --case "));
    assert!(of_kind(&report, FindingKind::Deviation).is_empty(), "{:?}", report.findings);
    assert!(dispatches < 100, "{dispatches} dispatches: something was shrunk");
    assert_eq!(report.verdicts.shader_deviated, 0);
}

#[test]
fn bits_that_change_within_the_bounds_are_found_as_well() {
    // The last bit: every verdict stays as it is.
    let (report, _) = report(&prepared("sphere"), |k, x| f32::from_bits(x.to_bits() ^ (k as u32 & 1)));
    let flaky = of_kind(&report, FindingKind::Flaky);
    let again = " of 256 samples gave other bits when the same batch ran again";
    assert!(flaky.iter().any(|finding| finding.message.contains(again)), "{:?}", report.findings);
    assert_eq!(report.repeated.unwrap().different, 256);
}

#[test]
fn a_wrong_shader_is_found_on_a_flaky_lane_too() {
    let shipped = find("sphere").unwrap();
    let suite = parse(&SourceFile::new(shipped.path, shipped.toml)).unwrap();
    let wrong = shipped.shader_text.replacen("cos(ph)", "cos(th)", 1);
    let prepared = prepare(&suite, &SourceFile::new(shipped.shader_name, wrong)).unwrap();
    let (report, _) = report(&prepared, |k, x| if k % 2 == 0 { x } else { x + 1.0 });
    assert!(!of_kind(&report, FindingKind::Flaky).is_empty(), "{:?}", report.findings);
    let shader = of_kind(&report, FindingKind::Deviation);
    let blamed = |f: &&Finding| f.case.as_ref().and_then(|c| c.deviation.as_ref()).map(|d| d.blame);
    assert!(shader.iter().any(|finding| blamed(finding) == Some(Blame::Shader)), "{:?}", report.findings);
}
