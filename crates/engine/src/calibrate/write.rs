//! Writes what was measured as a profile.

use std::fmt::Write as _;

use super::probe::Behaviour;
use super::{Standing, State, Tally, Worst, promises};
use judge::profile::{self, BINS, Definition, Flush, Identity, Op, bounds_of_bin, device_name};
use lanes::{Description, Stage};

/// Factor on errors that were measured by samples; a sweep of all arguments needs none.
///
/// Measured on llvmpipe of Mesa 22.3.6: with 2^22 samples, the largest error of all 2^32 arguments was
/// in no binade more than 1.25 times that of the samples for `exp2`, and 1.95 times for `sin`.
pub(super) const MARGIN: f64 = 2.0;

/// What a profile of a device is made of.
pub struct Document<'a> {
    /// The lane that was measured.
    pub lane: &'a Description,
    /// The measurements.
    pub state: &'a State,
    /// What the probe found in the compute stage.
    pub compute: &'a Behaviour,
    /// What it found in the vertex stage; a stage that the lane lacks counts as the other.
    pub vertex: Option<&'a Behaviour>,
    /// Operations that the device computes by a formula, see [`super::confirmed`].
    pub definitions: &'a [(Op, Definition)],
    /// Day of the measurement, such as `2026-01-31`.
    pub date: &'a str,
}

impl Document<'_> {
    /// The profile file.
    pub fn text(&self) -> String {
        let (compute, vertex) = (self.compute, self.vertex.unwrap_or(self.compute));
        let measurements = self.state.measurements();
        // A function may flush its result where arithmetic keeps it. A remainder and a sum of three can
        // look flushed by their own roundings.
        let tells = |op: Op| !matches!(op, Op::Mod | Op::Fma);
        let flushed = measurements.iter().any(|(op, tally)| tells(*op) && tally.flushed > 0);
        let flush = |stage: &Behaviour| match stage.flush() {
            Flush::Never if flushed => Flush::May,
            flush => flush,
        };
        let both = |of: fn(&Behaviour) -> bool| of(compute) && of(vertex);
        let allowance = |never: bool| if never { "never" } else { "allowed" };
        let yes = |b: bool| if b { "one rounding" } else { "two roundings" };
        let rounding = if both(|b| b.nearest_even) { "nearest-even" } else { "either" };
        let request = self.state.request();
        let name = Identity::of(&request.driver)
            .map_or_else(|| device_name(&request.driver).to_owned(), |identity| identity.profile_name());
        let extent = if request.exhaustive { ", all arguments of functions of one" } else { "" };
        let revision =
            format!("{}; measured {} with {} samples an operation{extent}", request.driver, self.date, request.samples);
        let mut text = String::new();
        let mut line = |line: String| {
            // Writing to a text cannot fail.
            let _ = writeln!(text, "{line}");
        };
        line("# Errors of a device, measured. Written by `shadercheck calibrate`.".to_owned());
        line(format!("name = {}", quoted(&name)));
        line(format!("revision = {}", quoted(&revision)));
        line("# What was not measured is as promised; operations on vectors are as their definitions.".to_owned());
        line(format!("extends = {}", quoted(&profile::promises(self.lane.api)[0].name)));
        line(format!("rounding = \"{rounding}\""));
        line("acceptance = \"text\"".to_owned());
        line("# `never` where no probe, in no stage, found the contrary.".to_owned());
        line(format!("contraction = \"{}\"", allowance(both(|b| !b.fusion.expression))));
        line(format!("rearrangement = \"{}\"", allowance(both(|b| !b.reordered))));
        line("\n[subnormals]".to_owned());
        line(format!("compute = \"{}\"", flush(compute).name()));
        line(format!("vertex = \"{}\"", flush(vertex).name()));
        line("\n[device]".to_owned());
        line(format!("lane = {}", quoted(self.lane.name)));
        line(format!("driver = {}", quoted(&request.driver)));
        line(format!("date = {}", quoted(self.date)));
        line(format!("samples = {}", request.samples));
        line(format!("fma = \"{}\"", yes(compute.fusion.fma)));
        line(format!("products_and_sums = \"{}\"", yes(compute.fusion.expression)));
        line(format!("order = \"{}\"", if both(|b| !b.reordered) { "kept" } else { "not kept" }));
        line("\n# A row of `binades`: sign, first and last exponent (-127: zero and subnormal numbers),".to_owned());
        line("# samples, largest error in ULP, largest absolute error, samples by size of error in ULP:".to_owned());
        line("# to 0.5, 1, 2, 4, 8, 16, 64, 256, 1024, 4096, 65536, and above. The operations were".to_owned());
        let has = self.lane.stages.contains(&Stage::Compute);
        line(format!("# measured in the {} stage.", if has { "compute" } else { "vertex" }));
        for (op, tally) in measurements {
            let definition = self.definitions.iter().find(|(of, _)| *of == op).map(|(_, definition)| *definition);
            operation(&mut line, op, tally, request.sweeps(op), definition);
        }
        text
    }
}

fn operation(line: &mut impl FnMut(String), op: Op, tally: &Tally, exhaustive: bool, definition: Option<Definition>) {
    let (promise, _) = promises();
    let at = |worst: &Worst| {
        let words = worst.at.iter().take(op.arity().unwrap_or(0)).map(|w| format!("\"0x{w:08x}\""));
        format!("[{}]", words.collect::<Vec<_>>().join(", "))
    };
    let (ulp, abs) = (tally.worst_ulp(), tally.worst_abs());
    line(format!("\n[operations.{}]", op.name()));
    if let Some(definition) = definition {
        line("# The parts of this formula, as measured, bound all errors that were seen.".to_owned());
        line(format!("definition = {}", quoted(&format!("inherits({})", definition.text()))));
    }
    line(format!("samples = {}", tally.samples));
    line(format!("exhaustive = {exhaustive}"));
    line(format!("margin = {:?}", if exhaustive { 1.0 } else { MARGIN }));
    line(format!("worst_ulp = {:?}", ulp.value()));
    line(format!("worst_ulp_at = {}", at(&ulp)));
    line(format!("worst_abs = {:?}", abs.value()));
    line(format!("worst_abs_at = {}", at(&abs)));
    line(format!("undefined = {}", tally.undefined));
    line(format!("flushed = {}", tally.flushed));
    line(format!("promise = {}", quoted(&promise.entry(op).to_string())));
    line(format!("ratio = {:?}", tally.ratio.value()));
    line(format!("verdict = {}", quoted(Standing::of(op, tally).name())));
    line("binades = [".to_owned());
    for run in runs(tally) {
        let (sign, first) = bounds_of_bin(run.first);
        let (_, last) = bounds_of_bin(run.last);
        let histogram: Vec<String> = run.histogram.iter().map(u64::to_string).collect();
        line(format!(
            "    [{sign}, {first}, {last}, {}, {}, {}, {}],",
            run.samples,
            upward(run.ulp),
            upward(run.abs),
            histogram.join(", ")
        ));
    }
    line("]".to_owned());
}

/// Errors up to this many ULP cannot be told from half an ULP: the references are no better, nor is a
/// function that a device computes in more digits and rounds once.
pub(super) const ROUNDED: f64 = 0.5 + 1.0 / 1_048_576.0;
/// Errors up to this many ULP are bounded by their ULP alone, as good as always, and not by their size.
const FEW_ULP: f64 = 4.0;
/// Factor between errors that are about the same.
const ALIKE: f64 = 1.15;

/// Neighbouring bins of one sign.
struct BinRun {
    first: usize,
    last: usize,
    samples: u64,
    ulp: f64,
    /// The smallest of the largest errors of the bins.
    least: f64,
    abs: f64,
    histogram: [u64; 12],
}

/// Bins with samples. Neighbours that round correctly are one row, and so are those that err by about
/// the same few ULP; bins with a result that is no number have no bound, and no row.
fn runs(tally: &Tally) -> Vec<BinRun> {
    let mut runs: Vec<BinRun> = Vec::new();
    for (k, bin) in tally.bins.iter().enumerate().filter(|(_, b)| b.samples > 0 && b.wild == 0) {
        let (ulp, abs) = (bin.ulp.value(), bin.abs.value());
        let ulp = if ulp <= ROUNDED { ulp.min(0.5) } else { ulp };
        let joins = |run: &&mut BinRun| {
            let one_sign = (run.last < BINS / 2) == (k < BINS / 2);
            // Rounding is correct between binades as well where no key was tried.
            let correct = ulp <= 0.5 && run.ulp <= 0.5;
            let (least, most) = (run.least.min(ulp), run.ulp.max(ulp));
            let alike = run.last + 1 == k && least > 0.5 && most <= FEW_ULP && most <= ALIKE * least;
            one_sign && (correct || alike)
        };
        match runs.last_mut().filter(joins) {
            Some(run) => {
                run.last = k;
                run.samples += bin.samples;
                run.ulp = run.ulp.max(ulp);
                run.least = run.least.min(ulp);
                run.abs = run.abs.max(abs);
                run.histogram.iter_mut().zip(bin.histogram).for_each(|(a, b)| *a += b);
            }
            None => runs.push(BinRun {
                first: k,
                last: k,
                samples: bin.samples,
                ulp,
                least: ulp,
                abs,
                histogram: bin.histogram,
            }),
        }
    }
    runs
}

/// A number that is not below `x` in at most five digits.
fn upward(x: f64) -> String {
    let short = |x: f64| format!("{x:.4e}");
    let near = short(x);
    let reads_back = |text: &str| text.parse::<f64>().unwrap_or(f64::INFINITY);
    // One unit of the last digit further, and no more: half an ULP must not become more than half.
    let unit = near.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    let unit = unit.map_or(0.0, |exponent| 10f64.powi(exponent - 4));
    let kept = if reads_back(&near) >= x { near } else { short(reads_back(&near) + unit) };
    match reads_back(&kept) {
        value if (1e-3..1e7).contains(&value) || value == 0.0 => format!("{value:?}"),
        _ => kept,
    }
}

/// A basic string of TOML.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(quoted, "\\u{:04x}", c as u32);
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_upward_by_less_than_a_unit_of_the_last_digit() {
        for x in [0.5, 0.499_983, 0.499_999_9, 0.1, 1.0 / 3.0, 9.999_96, 1.000_01, 6.789_123e31, 2.5e-45, 3_829.938_7] {
            let written: f64 = upward(x).parse().unwrap();
            assert!(written >= x && written <= x * 1.0001, "{x}: {written}");
            assert!(x > 0.5 || written <= 0.5, "{x}: {written}");
        }
        assert_eq!((upward(0.0).as_str(), upward(0.5).as_str(), upward(0.499_983).as_str()), ("0.0", "0.5", "0.49999"));
    }
}
