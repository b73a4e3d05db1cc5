//! What a glance settles, a tape settles alike: verdicts with and without glances are the same to the bit.

use std::sync::Arc;

use chapter::SUITES;
use engine::adversary::{Adversary, Strategy};
use engine::suite::run::Prepared;
use judge::profile::{Promises, by_name};
use judge::verdict::{JudgeContext, Judges};
use lanes::{Lane, Stage, embedded};
use program::interp::Laws;
use property::Sampler;

use crate::support::replaced;

/// Samples of each suite, shader and lane.
const SAMPLES: usize = 1024;

/// Holds verdicts with glances against those without. Gives the samples that were glanced at, and those that this settled.
fn held(prepared: &Prepared, lane: &dyn Lane, promises: &Promises, stage: Stage) -> [u64; 2] {
    let Prepared { oracle, reference, suite, .. } = prepared;
    let context = JudgeContext { oracle, reference, promises, stage };
    let per_case = suite.strands.map_or(suite.per_case, |strands| strands.primitives()).max(1);
    let batch = Sampler::new(prepared.plan.clone(), 7).batch(0, SAMPLES.div_ceil(per_case), per_case);
    let actual = lane.prepare(&prepared.compute, batch.invocation_count()).unwrap().run(&batch).unwrap();
    let judges = Judges::new(&context);
    let with = judges.judge(&batch, &actual);
    let without = Judges::new(&context).without_glances().judge(&batch, &actual);
    assert_eq!(format!("{with:?}"), format!("{without:?}"), "{} on {}", suite.name, lane.description().name);
    judges.glanced()
}

/// Promises of texts alone, and of one with all that comes behind it.
fn promises() -> Vec<Promises> {
    let of = |text, conformance: Option<&str>, measured: Option<&str>| Promises {
        text: by_name(text).unwrap(),
        conformance: conformance.map(|name| by_name(name).unwrap()),
        measured: measured.map(|name| Arc::new(by_name(name).unwrap().clone())),
    };
    vec![
        of("vulkan-1.4", None, None),
        of("binary32", None, None),
        of("wgsl", None, None),
        of("vulkan-1.4", Some("vulkan-cts"), Some("llvmpipe-22.3.6")),
    ]
}

#[test]
fn verdicts_of_shipped_suites_are_the_same_without_glances() {
    let mut all = [0; 2];
    for suite in SUITES {
        let prepared = replaced(suite.name, "", "");
        for promises in promises() {
            let strict = by_name("binary32").unwrap();
            let lanes: [Box<dyn Lane>; 4] = [
                embedded::open().unwrap(),
                Box::new(Adversary::lane(promises.text, Stage::Compute, Strategy::Mixed, 3, false)),
                Box::new(Adversary::lane(promises.text, Stage::Compute, Strategy::Extreme, 5, false)),
                Box::new(Adversary::lane(strict, Stage::Compute, Strategy::Random, 1, false).with_laws(Laws::Order)),
            ];
            for lane in &lanes {
                let [glanced, settled] = held(&prepared, lane.as_ref(), &promises, Stage::Compute);
                all = [all[0] + glanced, all[1] + settled];
            }
        }
    }
    // The other tests of this file would hold of glances that settle nothing.
    assert!(2 * all[1] > all[0] && all[0] > 100_000, "{all:?}");
}

#[test]
fn verdicts_of_wrong_shaders_are_the_same_without_glances() {
    let embedded = embedded::open().unwrap();
    for (suite, from, to) in [
        ("sphere", "cos(ph)", "cos(th)"),
        ("sphere", "3.14159265358979324", "3.1416"),
        ("skinning", "length(v2) + 1.0", "length(v2) + 1.001"),
        ("skinning", "i < numberOfBones", "i <= numberOfBones"),
        ("cylinder", "cos", "sin"),
        ("catmull_rom", "0.5", "0.51"),
    ] {
        let prepared = replaced(suite, from, to);
        for promises in promises() {
            held(&prepared, &*embedded, &promises, Stage::Compute);
        }
    }
}
