//! What was measured, beside what is promised.

use std::fmt::Write as _;

use serde_json::{Value, json};

use base::value::F32Bits;
use engine::calibrate::{Behaviour, Standing, State, Tally, Worst, promises};
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
        let _ = writeln!(
            text,
            "{:<12} {:>11}  {:>9}  {:>9}  {:<30} {:>8}  {:<32} promised",
            "operation", "samples", "max ULP", "max abs", "at", "ratio", "verdict"
        );
        for (op, tally) in self.state.measurements() {
            let line = row(op, tally);
            let _ = writeln!(text, "{}", line.trim_end());
        }
        let _ =
            writeln!(text, "\nmax ULP and max abs: where an error is promised, if anywhere; at: arguments of max ULP");
        let _ = writeln!(text, "ratio: largest error as a part of what the text of the specification allows\n");
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
                json!({
                    "operation": op.name(),
                    "exhaustive": self.state.request().sweeps(op),
                    "samples": tally.samples,
                    "undefined": tally.undefined,
                    "flushed": tally.flushed,
                    "all": {"ulp": place(op, &tally.worst_ulp()), "abs": place(op, &tally.worst_abs())},
                    "promised": {"ulp": place(op, &tally.promised_ulp), "abs": place(op, &tally.promised_abs)},
                    "promise": promise.entry(op).to_string(),
                    "ratio": place(op, &tally.ratio),
                    "outside_text": tally.outside_text,
                    "outside_suite": tally.outside_suite,
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

fn row(op: Op, tally: &Tally) -> String {
    let (promise, _) = promises();
    let standing = Standing::of(op, tally);
    let seen = tally.promised_ulp.value() > 0.0 || standing != Standing::NoPromise;
    let (ulp, abs) =
        if seen { (tally.promised_ulp, tally.promised_abs) } else { (tally.worst_ulp(), tally.worst_abs()) };
    let counted = match standing {
        Standing::Inside | Standing::NoPromise => standing.name().to_owned(),
        Standing::InsideSuite => format!("{} ({})", standing.name(), tally.outside_text),
        Standing::Outside => format!("{} ({})", standing.name(), tally.outside_suite),
    };
    format!(
        "{:<12} {:>11}  {:>9}  {:>9}  {:<30} {:>8}  {counted:<32} {}",
        op.name(),
        tally.samples,
        short(ulp.value()),
        short(abs.value()),
        if ulp.value() > 0.0 { arguments(op, &ulp) } else { String::new() },
        short(tally.ratio.value()),
        promise.entry(op)
    )
}

/// Three significant digits.
fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if (0.01..1000.0).contains(&size) => format!("{x:.3}"),
        size if (1000.0..1e7).contains(&size) => format!("{x:.0}"),
        _ => format!("{x:.1e}"),
    }
}

fn arguments(op: Op, worst: &Worst) -> String {
    let shown = worst.at.iter().take(op.arity().unwrap_or(0)).map(|w| F32Bits(*w).to_string());
    shown.collect::<Vec<_>>().join(", ")
}

fn place(op: Op, worst: &Worst) -> Value {
    let value = worst.value();
    let bits = |w: &u32| Value::from(format!("0x{w:08x}"));
    json!({
        "value": if value.is_finite() { json!(value) } else { json!(value.to_string()) },
        "at": worst.at.iter().take(op.arity().unwrap_or(0)).map(bits).collect::<Vec<_>>(),
        "result": bits(&worst.result),
    })
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
