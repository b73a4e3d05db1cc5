//! What was measured, beside what is promised.

use std::fmt::Write as _;

use serde_json::{Value, json};

use base::value::F32Bits;
use engine::calibrate::{Arguments, Behaviour, Standing, State, Tally, Worst, promises};
use judge::profile::Op;
use lanes::Description;

/// All that is printed.
pub struct Report<'a> {
    pub lane: &'a Description,
    pub state: &'a State,
    pub compute: &'a Behaviour,
    pub vertex: Option<&'a Behaviour>,
}

impl Report<'_> {
    /// The table for people.
    pub fn text(&self) -> String {
        let (promise, suite) = promises();
        let mut text = String::new();
        // Writing to a text cannot fail.
        let _ = writeln!(text, "{} ({})", self.lane.name, self.lane.driver);
        let _ =
            writeln!(text, "promise: {} ({}), {} ({})\n", promise.name, promise.revision, suite.name, suite.revision);
        let measurements = self.state.measurements();
        let promises: Vec<String> = measurements.iter().map(|(op, _)| promise.entry(*op).to_string()).collect();
        let width = promises.iter().map(|promise| promise.chars().count()).chain([8]).max().unwrap_or(0);
        let _ = writeln!(
            text,
            "{:<12} {:>11}  {:>9}  {:>9}  {:>8}  {:<11}  {:<32}  {:<width$}  at",
            "operation", "samples", "max ULP", "max abs", "ratio", "figures are", "verdict", "promised"
        );
        for ((op, tally), promise) in measurements.into_iter().zip(promises) {
            let line = row(op, tally, self.counts(op), self.extent(op), &format!("{promise:<width$}"));
            let _ = writeln!(text, "{}", line.trim_end());
        }
        let _ = writeln!(text, "\nmax ULP and max abs: where an error is promised, if anywhere");
        let _ = writeln!(text, "ratio: largest error as a part of what the text of the specification allows");
        let _ = writeln!(
            text,
            "figures are: exhaustive where all arguments were tried; a lower bound where another argument may be off further"
        );
        let _ = writeln!(text, "at: arguments of max ULP; those of max abs and of ratio where they are others\n");
        for (stage, behaviour) in [("compute", Some(self.compute)), ("vertex", self.vertex)] {
            let Some(b) = behaviour else { continue };
            let _ = writeln!(
                text,
                "{stage:<8} subnormal arguments {}, results {}; fma {}; x*y + z {}; sums {}; order of sums and products {}",
                flush(b.arguments.name()),
                flush(b.results.name()),
                fused(b.fusion.fma),
                fused(b.fusion.expression),
                if b.nearest_even { "rounded to nearest even" } else { "not rounded to nearest even" },
                if b.reordered { "not kept" } else { "kept" }
            );
        }
        text
    }

    /// What the figures of an operation are.
    fn extent(&self, op: Op) -> &'static str {
        if self.state.request().sweeps(op) { "exhaustive" } else { "lower bound" }
    }

    /// True where no argument was counted twice. A search computes all results of a binade of which it has seen some.
    fn counts(&self, op: Op) -> bool {
        let request = self.state.request();
        request.sweeps(op) || request.search == 0 || op.arity() != Some(1)
    }

    /// The same for programs. Floats that JSON cannot hold are texts.
    pub fn json(&self) -> Value {
        let (promise, suite) = promises();
        let behaviour = |b: &Behaviour| {
            json!({
                "subnormal_arguments_flushed": b.arguments.name(),
                "subnormal_results_flushed": b.results.name(),
                "fma_fused": b.fusion.fma,
                "products_and_sums_fused": b.fusion.expression,
                "nearest_even": b.nearest_even,
                "reordered": b.reordered,
            })
        };
        let operations: Vec<Value> = self
            .state
            .measurements()
            .into_iter()
            .map(|(op, tally)| {
                let place = |worst: &Worst| place(op, worst, self.extent(op));
                json!({
                    "operation": op.name(),
                    "exhaustive": self.state.request().sweeps(op),
                    "samples": tally.samples,
                    "undefined": tally.undefined,
                    "flushed": tally.flushed,
                    "all": {"ulp": place(&tally.worst_ulp()), "abs": place(&tally.worst_abs())},
                    "promised": {"ulp": place(&tally.promised_ulp), "abs": place(&tally.promised_abs)},
                    "promise": promise.entry(op).to_string(),
                    "ratio": place(&tally.ratio),
                    "outside_text": self.counts(op).then_some(tally.outside_text),
                    "outside_suite": self.counts(op).then_some(tally.outside_suite),
                    "verdict": Standing::of(op, tally).name(),
                })
            })
            .collect();
        json!({
            "lane": self.lane.name,
            "driver": self.lane.driver,
            "promise": {"profile": promise.name, "revision": promise.revision},
            "suite": {"profile": suite.name, "revision": suite.revision},
            "operations": operations,
            "compute": behaviour(self.compute),
            "vertex": self.vertex.map(behaviour),
        })
    }
}

fn row(op: Op, tally: &Tally, counts: bool, extent: &str, promise: &str) -> String {
    let standing = Standing::of(op, tally);
    let seen = tally.promised_ulp.value() > 0.0 || standing != Standing::NoPromise;
    let (ulp, abs) =
        if seen { (tally.promised_ulp, tally.promised_abs) } else { (tally.worst_ulp(), tally.worst_abs()) };
    let counted = match standing {
        standing if !counts => standing.name().to_owned(),
        Standing::Inside | Standing::NoPromise => standing.name().to_owned(),
        Standing::InsideSuite => format!("{} ({})", standing.name(), tally.outside_text),
        Standing::Outside => format!("{} ({})", standing.name(), tally.outside_suite),
    };
    let mut places: Vec<String> = Vec::new();
    for (name, worst) in [("", ulp), ("max abs at ", abs), ("ratio at ", tally.ratio)] {
        let place = arguments(op, &worst.at);
        if worst.value() > 0.0 && !places.iter().any(|known| known.ends_with(&place)) {
            places.push(format!("{name}{place}"));
        }
    }
    format!(
        "{:<12} {:>11}  {:>9}  {:>9}  {:>8}  {extent:<11}  {counted:<32}  {promise}  {}",
        op.name(),
        tally.samples,
        short(ulp.value()),
        short(abs.value()),
        short(tally.ratio.value()),
        places.join("; ")
    )
}

/// Three significant digits.
pub fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if (0.01..1000.0).contains(&size) => format!("{x:.3}"),
        size if (1000.0..1e7).contains(&size) => format!("{x:.0}"),
        _ => format!("{x:.1e}"),
    }
}

/// Arguments as decimal and as hexadecimal floats.
pub fn arguments(op: Op, at: &Arguments) -> String {
    let shown = at.iter().take(op.arity().unwrap_or(0)).map(|word| F32Bits(*word));
    let both = shown.map(|x| match (x.to_string(), x.to_hex_float()) {
        (decimal, hexadecimal) if decimal == hexadecimal => decimal,
        (decimal, hexadecimal) => format!("{decimal} ({hexadecimal})"),
    });
    both.collect::<Vec<_>>().join(", ")
}

fn place(op: Op, worst: &Worst, extent: &str) -> Value {
    let bits = |w: &u32| Value::from(format!("0x{w:08x}"));
    let at = || worst.at.iter().take(op.arity().unwrap_or(0));
    json!({
        "value": float(worst.value()),
        "figure": extent,
        "at": at().map(bits).collect::<Vec<_>>(),
        "at_hex_float": at().map(|w| F32Bits(*w).to_hex_float()).collect::<Vec<_>>(),
        "result": bits(&worst.result),
    })
}

/// A number; as a text where JSON cannot hold it.
pub fn float(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { json!(value.to_string()) }
}

fn flush(name: &str) -> &'static str {
    match name {
        "must" => "flushed",
        "never" => "kept",
        _ => "flushed by some operations",
    }
}

fn fused(one_rounding: bool) -> &'static str {
    if one_rounding { "fused" } else { "not fused" }
}
