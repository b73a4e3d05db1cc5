//! How long `shadercheck fuzz` takes: a library of fifty functions, 65,536 samples of each, on every lane
//! that is available, as the command does it.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::fs;
use std::time::Instant;

use engine::suite::run::DEFAULT_SEED;
use shadercheck::cli::fuzz::{FuzzArgs, run};
use shadercheck::cli::inputs::InputArgs;
use shadercheck::cli::reported::Reported;

const LIBRARY: &str = include_str!("library.glsl");
const SAMPLES: u64 = 1 << 16;

fn main() -> anyhow::Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("library.glsl");
    fs::write(&path, LIBRARY)?;
    let args = FuzzArgs {
        files: vec![path],
        samples: SAMPLES,
        input: InputArgs { seed: DEFAULT_SEED, ..InputArgs::default() },
        format: Reported::Json,
        ..FuzzArgs::default()
    };
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let start = Instant::now();
    run(&args, &mut out, &mut err, false)?;
    let seconds = start.elapsed().as_secs_f64();
    let report: serde_json::Value = serde_json::from_slice(&out)?;
    let list = |value: &serde_json::Value| value.as_array().cloned().unwrap_or_default();
    let functions = list(&report["files"][0]["functions"]);
    let ran = functions.iter().filter(|f| f["not_run"].is_null()).count();
    let lanes: Vec<String> =
        list(&report["lanes"]).iter().filter_map(|l| Some(l["name"].as_str()?.to_owned())).collect();
    println!(
        "fuzz: {ran} of {} functions, {SAMPLES} samples each on {}: {seconds:.1} s, {:.2} s a function",
        functions.len(),
        lanes.join(" and "),
        seconds / ran.max(1) as f64
    );
    Ok(())
}
