//! `shadercheck calibrate` on the Vulkan lane.

use std::path::Path;

use base::text::SourceFile;
use base::value::Batch;
use clap::Parser;
use engine::calibrate::probe;
use judge::profile::{Allowed, Flush, Op, by_name, for_device, parse};
use lanes::{Actual, Description, Lane, LaneError, Marks, Runner, Stage, vulkan};
use program::{Kernel, OutputLayout};
use serde_json::Value;
use shadercheck::cli::calibrate::{CalibrateArgs, run_on};
use shadercheck::cli::status::ExitStatus;
use shadercheck::cli::{Cli, Command};

fn arguments(output: &Path, line: &str) -> CalibrateArgs {
    let words = ["shadercheck", "calibrate", "--format", "json"].into_iter().chain(line.split_whitespace());
    let Command::Calibrate(mut args) = Cli::parse_from(words).command else { panic!("{line} is no calibrate") };
    args.output = Some(output.to_owned());
    args
}

/// Status, report and profile text of a run.
fn calibrate(lane: &dyn Lane, ops: &[Op], line: &str) -> (ExitStatus, Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("device.toml");
    let mut out = Vec::new();
    let status = run_on(&arguments(&output, line), ops, lane, &mut out).unwrap();
    let files: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|f| f.unwrap().file_name()).collect();
    assert_eq!(files, ["device.toml"], "the state of a complete run is removed");
    (status, serde_json::from_slice(&out).unwrap(), std::fs::read_to_string(&output).unwrap())
}

fn operation<'a>(report: &'a Value, name: &str) -> &'a Value {
    let operations = report["operations"].as_array().unwrap();
    operations.iter().find(|op| op["operation"] == name).unwrap()
}

fn number(value: &Value) -> f64 {
    value["value"].as_f64().unwrap_or(f64::INFINITY)
}

#[test]
fn a_short_run_measures_the_vulkan_lane() {
    let lane = vulkan::open().unwrap();
    let ops = [Op::Add, Op::Sqrt, Op::Div, Op::Sin, Op::Exp2, Op::Fract];
    let (status, report, profile) = calibrate(lane.as_ref(), &ops, "--samples 20000");
    assert_eq!(status, ExitStatus::Clean, "{report:#}");
    for name in ["add", "sqrt", "div", "fract"] {
        let ulp = number(&operation(&report, name)["promised"]["ulp"]);
        assert!(ulp > 0.0 && ulp <= 2.5, "{name}: {ulp}");
    }
    let sine = operation(&report, "sin");
    assert!(number(&sine["promised"]["abs"]) <= 2f64.powi(-11));
    let profile = parse(&SourceFile::new("device.toml", profile), &|name| by_name(name).cloned()).unwrap();
    let driver = &lane.description().driver;
    assert_eq!(profile.driver.as_ref(), Some(driver));
    assert!(profile.revision.starts_with(driver.as_str()) && profile.revision.contains("; measured 2"));
    assert!(report["profile"].as_str().unwrap().ends_with("device.toml"));
    // The short run finds about what the long one that ships has found.
    if let Some(shipped) = for_device(driver) {
        assert_eq!(
            (profile.compute, profile.vertex, profile.rounding),
            (shipped.compute, shipped.vertex, shipped.rounding)
        );
        assert_eq!((profile.contraction, profile.rearrangement), (shipped.contraction, shipped.rearrangement));
        assert_eq!(profile.name, shipped.name);
    }
    let allowed = profile.allowed(Op::Sin, &[1.0], 1f64.sin(), Stage::Compute);
    assert!(matches!(allowed, Allowed::Bound(b) if b > 0.0 && b < 2f64.powi(-11)), "{allowed:?}");
}

/// The facts hold for the software driver and need not hold for another device.
#[test]
fn the_software_driver_is_as_known() {
    let lane = vulkan::open().unwrap();
    if !lane.description().driver.starts_with("llvmpipe") {
        return;
    }
    let compute = probe(lane.as_ref(), Stage::Compute).unwrap();
    let vertex = probe(lane.as_ref(), Stage::Vertex).unwrap();
    assert_eq!((compute.flush(), vertex.flush()), (Flush::Never, Flush::Must));
    assert!(!compute.fusion.fma && compute.nearest_even);
    assert!(compute.reordered && vertex.reordered);
    let ops = [Op::Asin, Op::Sqrt, Op::Div];
    let (_, report, _) = calibrate(lane.as_ref(), &ops, "--samples 200000");
    let asin = number(&operation(&report, "asin")["promised"]["abs"]);
    assert!((3.8e-4..4.0e-4).contains(&asin), "{asin}");
    for name in ["sqrt", "div"] {
        assert!(number(&operation(&report, name)["promised"]["ulp"]) <= 0.5, "{name} is correctly rounded");
    }
}

/// A lane that adds twice the promised error to every result of a kernel of one argument.
struct Shifted {
    inner: Box<dyn Lane>,
}

struct ShiftedRunner {
    inner: Box<dyn Runner>,
    layout: OutputLayout,
}

impl Lane for Shifted {
    fn description(&self) -> &Description {
        self.inner.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        let inner = self.inner.prepare(kernel, capacity)?;
        if kernel.invocation.words() != 1 {
            return Ok(inner);
        }
        Ok(Box::new(ShiftedRunner { inner, layout: kernel.output.clone() }))
    }
}

impl Runner for ShiftedRunner {
    fn capacity(&self) -> usize {
        self.inner.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let actual = self.inner.run(batch)?;
        let marks = Marks::random();
        let mut words = Vec::new();
        for k in 0..actual.count() {
            words.push(marks.canary ^ k as u32);
            let shift = 2.0 * 2f32.powi(-11);
            words.extend(actual.vertex(k, 0).iter().map(|w| (f32::from_bits(*w) + shift).to_bits()));
        }
        Actual::accept(&self.layout, words, actual.count(), marks)
    }
}

#[test]
fn a_lane_whose_sine_is_off_by_twice_its_promise_is_outside() {
    let lane = Shifted { inner: vulkan::open().unwrap() };
    let (status, report, _) = calibrate(&lane, &[Op::Sin], "--samples 20000");
    let sine = operation(&report, "sin");
    assert_eq!((status, sine["verdict"].as_str()), (ExitStatus::Findings, Some("outside")));
    assert!((number(&sine["ratio"]) - 2.0).abs() < 0.01, "{sine:#}");
}

#[test]
fn an_unknown_lane_is_refused_with_a_suggestion() {
    let args = CalibrateArgs { lane: Some("vulcan".to_owned()), ..arguments(Path::new("p.toml"), "") };
    let error = shadercheck::cli::calibrate::run(&args, &mut Vec::new(), &mut Vec::new()).unwrap_err();
    assert_eq!(error.to_string(), "there is no lane `vulcan`; did you mean `vulkan`?");
}
