//! Generated vectors per second, beside the same formula in NumPy: both write NPZ with inputs, expected values in
//! binary64 and the nearest binary32 to a file that was not there. They run in turn; the ratio is that of the two runs of
//! a round, its median with the least and the largest one. NumPy's runs differ by a factor of two where the system has
//! to find pages for whole arrays, so that the fastest run of each says less than a round.
//!
//! NumPy's side is `fixtures/bench/reference.py`; it runs where `SHADERCHECK_PYTHON`, or else `python3`, has
//! numpy. What is in memory at its end may not be on the disk yet; the program waits for the disk.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Rounds of one row.
const ROUNDS: usize = 7;

fn main() {
    let python = std::env::var("SHADERCHECK_PYTHON").unwrap_or_else(|_| "python3".into());
    let found = Command::new(&python).args(["-c", "import numpy"]).output().is_ok_and(|o| o.status.success());
    if !found {
        println!("refdata: NumPy was not run: `{python}` has no numpy (SHADERCHECK_PYTHON names another)");
    }
    let folder = tempfile::tempdir().expect("a folder for files");
    println!("reference data        samples   vectors/s   numpy/s   ratio  least to largest   with bounds/s");
    let rows = [("sphere", 4_000_000_u64), ("sphere", 16_000_000), ("skinning", 1_000_000), ("skinning", 4_000_000)];
    for (suite, samples) in rows {
        let [mut ours, mut theirs, mut ratios, mut bounded] = [const { Vec::new() }; 4];
        for _ in 0..ROUNDS {
            ours.push(generate(folder.path(), suite, samples, "none"));
            theirs.push(if found { numpy(&python, folder.path(), suite, samples) } else { f64::NAN });
            ratios.push(theirs[theirs.len() - 1] / ours[ours.len() - 1]);
        }
        for _ in 0..3 {
            bounded.push(generate(folder.path(), suite, samples / 8, "vulkan-1.4"));
        }
        let rate = |mut seconds: Vec<f64>, samples: u64| samples as f64 / median(&mut seconds);
        let (ours, theirs, bounded) = (rate(ours, samples), rate(theirs, samples), rate(bounded, samples / 8));
        let ratio = median(&mut ratios);
        let (least, most) = (ratios[0], ratios[ratios.len() - 1]);
        println!(
            "{suite:18} {samples:>10} {ours:>11.0} {theirs:>9.0} {ratio:>7.1}  {least:>5.1} to {most:<8.1} \
             {bounded:>15.0}"
        );
    }
}

/// The median; the numbers are in order then.
fn median(numbers: &mut [f64]) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// Removes a file: to give its pages back to the system takes a tenth of a run, and belongs to none.
fn without(folder: &Path, name: &str) {
    let path = folder.join(name);
    if path.exists() {
        std::fs::remove_file(path).expect("a file can be removed");
    }
}

/// Seconds of a run of the program, from its start to its end.
fn generate(folder: &Path, suite: &str, samples: u64, profile: &str) -> f64 {
    without(folder, "ours.npz");
    let start = Instant::now();
    let status = Command::new(env!("CARGO_BIN_EXE_shadercheck"))
        .args(["refdata", "generate", suite, "--profile", profile, "--output", "ours.npz"])
        .args(["--samples", &samples.to_string()])
        .current_dir(folder)
        .output()
        .expect("the program starts");
    assert!(status.status.success(), "{}", String::from_utf8_lossy(&status.stderr));
    start.elapsed().as_secs_f64()
}

/// Seconds that the script measures for itself: without the start of the interpreter.
fn numpy(python: &str, folder: &Path, suite: &str, samples: u64) -> f64 {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/bench/reference.py");
    without(folder, "theirs.npz");
    let output = Command::new(python)
        .arg(script)
        .args([suite, &samples.to_string(), "theirs.npz"])
        .current_dir(folder)
        .output()
        .expect("the interpreter starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).trim().parse().expect("the script prints seconds")
}
