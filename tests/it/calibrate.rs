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
use shadercheck::cli::check::Format;
use shadercheck::cli::status::ExitStatus;
use shadercheck::cli::{Cli, Command};

use crate::binary::run_in;

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

#[test]
fn a_device_that_is_worse_than_a_profile_fails_and_its_twin_passes() {
    let folder = tempfile::tempdir().unwrap();
    let (plain, shifted) = (vulkan::open().unwrap(), Shifted { inner: vulkan::open().unwrap() });
    let ops = [Op::Sin, Op::Add];
    let file = |name: &str| folder.path().join(name);
    let against = |lane: &dyn Lane, then: &str| {
        let mut args = arguments(&file("unused.toml"), &format!("--samples 20000 --against {}", file(then).display()));
        args.output = None;
        let mut out = Vec::new();
        let status = run_on(&args, &ops, lane, &mut out).unwrap();
        let report: Value = serde_json::from_slice(&out).unwrap();
        args.format = Format::Text;
        out.clear();
        assert_eq!(run_on(&args, &ops, lane, &mut out).unwrap(), status);
        (status, report, String::from_utf8(out).unwrap())
    };
    run_on(&arguments(&file("plain.toml"), "--samples 20000"), &ops, plain.as_ref(), &mut Vec::new()).unwrap();
    run_on(&arguments(&file("shifted.toml"), "--samples 20000"), &ops, &shifted, &mut Vec::new()).unwrap();

    for (lane, then) in [(plain.as_ref(), "plain.toml"), (&shifted as &dyn Lane, "shifted.toml")] {
        let (status, report, text) = against(lane, then);
        assert_eq!(status, ExitStatus::Clean, "{text}");
        assert!(text.ends_with(&format!("\nNothing is worse than {} says.\n", file(then).display())), "{text}");
        assert_eq!((&report["against"]["worse"], &report["profile"]), (&Value::Array(vec![]), &Value::Null));
    }
    let (status, report, text) = against(&shifted, "plain.toml");
    assert_eq!(status, ExitStatus::Findings);
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("worse: ")).collect();
    let [line] = lines[..] else { panic!("{text}") };
    assert!(line.starts_with("worse: sin is off by ") && line.contains("plain.toml allows "), "{line}");
    let worse = report["against"]["worse"].as_array().unwrap();
    assert_eq!((worse.len(), &worse[0]["operation"]), (1, &"sin".into()));
    assert!(worse[0]["ulp"].as_f64() > worse[0]["allowed_ulp"].as_f64(), "{report:#}");
    let float = worse[0]["at_hex_float"][0].as_str().unwrap();
    assert!(float.contains("0x") && line.contains(float), "{float} in {line}");
}

#[test]
fn a_profile_that_cannot_be_compared_with_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let measure =
        |words: &str| run_in(folder.path(), &format!("calibrate --lane embedded --builtin add --samples 64 {words}"));
    measure("-o mine.toml").expect(0);
    measure("--against mine.toml").expect(0);
    let files = || std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(files(), 1, "no profile is written without -o");
    let error = |words: &str, said: &str| {
        let ran = measure(words).expect(2);
        assert!(ran.err.contains(said) && ran.out.is_empty(), "{ran:?}");
    };
    error("--against gone.toml", "cannot read the profile `gone.toml`");
    error("--against llvmpip-22.3.6", "did you mean `llvmpipe-22.3.6`?");
    error("--against none", "leaves nothing to compare with");
    error("--against mine.toml -o ./mine.toml", "would replace the profile of --against");
    error("--against mine.toml --shard 0/2", "cannot be used with");
    let text = std::fs::read_to_string(folder.path().join("mine.toml")).unwrap();
    std::fs::write(folder.path().join("mine.toml"), text.replacen("\nsamples = ", "\nsample = ", 1)).unwrap();
    error("--against mine.toml", "mine.toml:");
}

#[test]
fn a_contribution_is_one_profile_that_says_where_it_goes() {
    let folder = tempfile::tempdir().unwrap();
    let ran = run_in(folder.path(), "calibrate --lane embedded --samples 64 --search 0 --contribute").expect(0);
    let name = format!("interpreter-of-shadercheck-{}.toml", env!("CARGO_PKG_VERSION"));
    let files: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|f| f.unwrap().file_name()).collect();
    assert_eq!(files, [name.as_str()]);
    let text = std::fs::read_to_string(folder.path().join(&name)).unwrap();
    parse(&SourceFile::new("contribution", text), &|name| by_name(name).cloned()).unwrap();
    for said in [env!("CARGO_PKG_REPOSITORY"), &format!("crates/judge/profiles/{name}"), "has no version"] {
        assert!(ran.out.contains(said), "{said} is not in {}", ran.out);
    }
    run_in(folder.path(), "calibrate --lane embedded --builtin add --contribute").expect(2);
    let named = "calibrate --lane embedded --samples 64 --search 0 --format json --contribute mine.toml";
    let json = run_in(folder.path(), named).expect(0).json();
    assert_eq!((&json["contribution"]["file"], &json["contribution"]["shipped"]), (&"mine.toml".into(), &Value::Null));
    assert!(folder.path().join("mine.toml").exists());
}

#[test]
fn figures_say_what_they_are_and_where() {
    let folder = tempfile::tempdir().unwrap();
    let measure =
        |words: &str| run_in(folder.path(), &format!("calibrate --lane embedded --builtin {words} -o o.toml"));
    let text = measure("sin,add --samples 1000").expect(0).out;
    let sine = text.lines().find(|line| line.starts_with("sin ")).unwrap();
    assert!(sine.contains(" lower bound ") && sine.contains("0x1."), "{sine}");
    let json = measure("sin,add --samples 1000 --format json").expect(0).json();
    for operation in json["operations"].as_array().unwrap() {
        let figure = &operation["promised"]["ulp"];
        assert_eq!(figure["figure"], "lower bound", "{operation:#}");
        let (bits, float) = (figure["at"][0].as_str().unwrap(), figure["at_hex_float"][0].as_str().unwrap());
        let bits = u32::from_str_radix(bits.trim_start_matches("0x"), 16).unwrap();
        assert_eq!(float, base::value::F32Bits(bits).to_hex_float());
    }
}
