//! Batches of samples from a plan and a seed.

use std::sync::Arc;

use rayon::prelude::*;

use base::value::{Batch, Record};

use super::generators::Rows;
use super::plan::{Plan, key};

/// Rows that one thread fills at a time: large enough to hide the cost of handing them out.
const CHUNK: usize = 4096;

/// Makes batches. A sample depends on the seed, the number of its case and its place in the case
/// alone: batches of any size give the same samples.
#[derive(Clone, Debug)]
pub struct Sampler {
    plan: Arc<Plan>,
    seed: u64,
}

impl Sampler {
    /// A sampler for a plan.
    pub fn new(plan: Arc<Plan>, seed: u64) -> Self {
        Self { plan, seed }
    }

    /// Which generator fills which input.
    pub fn plan(&self) -> &Arc<Plan> {
        &self.plan
    }

    /// What the random bits of all samples follow from.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The cases `first_case..first_case + cases` with `per_case` invocations each (at least 1).
    pub fn batch(&self, first_case: u64, cases: usize, per_case: usize) -> Batch {
        let plan = &*self.plan;
        let per_case = per_case.max(1);
        let (case_words, words) = (plan.case_record().words(), plan.invocation_record().words());
        let mut batch = Batch {
            invocation_record: plan.invocation_record().clone(),
            case_record: plan.case_record().clone(),
            per_case,
            invocations: vec![0; words * per_case * cases],
            cases: vec![0; case_words * cases],
        };
        if case_words > 0 {
            batch.cases.par_chunks_mut(CHUNK * case_words).enumerate().for_each(|(i, chunk)| {
                fill_cases(plan, self.seed, first_case.wrapping_add((i * CHUNK) as u64), chunk);
            });
        }
        if words > 0 {
            batch.invocations.par_chunks_mut(CHUNK * words).enumerate().for_each(|(i, chunk)| {
                let row = i * CHUNK;
                let case = first_case.wrapping_add((row / per_case) as u64);
                fill_invocations(plan, self.seed, case, row % per_case, per_case, chunk);
            });
        }
        batch
    }
}

/// Fills whole records of uniforms, the first of them for case `first_case`.
pub(super) fn fill_cases(plan: &Plan, seed: u64, first_case: u64, words: &mut [u32]) {
    let stride = plan.case_record().words();
    for planned in &plan.case {
        let rows = Rows {
            words,
            stride,
            spans: &planned.spans,
            key: key(seed, planned),
            exact_key: seed,
            first_case,
            first_invocation: 0,
            per_case: 1,
        };
        planned.generator.fill_rows(&planned.group, rows);
    }
    halve(plan.case_record(), words);
}

/// Brings numbers of binary16 to the nearest ones of these, in whole records.
fn halve(record: &Record, words: &mut [u32]) {
    let places = record.fields().iter().enumerate().filter(|(_, field)| field.shape.half);
    let places: Vec<usize> = places.flat_map(|(k, _)| record.range(k)).collect();
    if places.is_empty() {
        return;
    }
    for own in words.chunks_mut(record.words()) {
        places.iter().for_each(|&at| own[at] = number::half::nearest(f32::from_bits(own[at])).to_bits());
    }
}

/// Fills whole records of invocations, the first of them for invocation `first_invocation` of `first_case`.
pub(super) fn fill_invocations(
    plan: &Plan,
    seed: u64,
    first_case: u64,
    first_invocation: usize,
    per_case: usize,
    words: &mut [u32],
) {
    let stride = plan.invocation_record().words();
    for planned in &plan.invocation {
        let rows = Rows {
            words,
            stride,
            spans: &planned.spans,
            key: key(seed, planned),
            exact_key: seed,
            first_case,
            first_invocation,
            per_case,
        };
        planned.generator.fill_rows(&planned.group, rows);
    }
    halve(plan.invocation_record(), words);
}

#[cfg(test)]
mod tests {
    use super::super::generators::{Options, by_name};
    use super::super::plan::InputGroup;
    use super::*;
    use base::value::{Field, Record, Shape};

    fn group(names: &[&str], generator: &str, range: Option<[f64; 2]>) -> InputGroup {
        InputGroup {
            names: names.iter().map(|&n| n.to_owned()).collect(),
            generator: crate::Own::Static(by_name(generator).unwrap()),
            options: Options { range, ..Options::default() },
            at: String::new(),
        }
    }

    fn record(fields: &[(&str, Shape)]) -> Arc<Record> {
        let field = |&(name, shape): &(&str, Shape)| Field { name: name.into(), shape };
        Arc::new(Record::new(fields.iter().map(field).collect()))
    }

    fn morph() -> Arc<Plan> {
        let groups = [
            group(&["p1", "p0"], "nodes", None),
            group(&["t"], "interval", Some([0.0, 1.0])),
            group(&["mc"], "projection", None),
        ];
        // The order of the group differs from that of the record, with another input between.
        let invocation = record(&[("p0", Shape::VEC4), ("x", Shape::FLOAT), ("p1", Shape::VEC4)]);
        let mut groups = groups.to_vec();
        groups.push(group(&["x"], "interval", Some([3.0, 4.0])));
        Arc::new(Plan::new(&groups, invocation, record(&[("t", Shape::FLOAT), ("mc", Shape::MAT4)])).unwrap())
    }

    #[test]
    fn samples_do_not_depend_on_the_size_of_the_batch() {
        let sampler = Sampler::new(morph(), 11);
        let whole = sampler.batch(100, 1500, 5);
        assert_eq!(whole.case_count(), 1500);
        let part = sampler.batch(1100, 7, 5);
        assert_eq!(part.cases, whole.cases[1000 * 17..1007 * 17]);
        assert_eq!(part.invocations, whole.invocations[1000 * 5 * 9..1007 * 5 * 9]);
        let one = sampler.plan().sample(11, 1103, 2);
        assert_eq!(one.case, whole.case(1003));
        assert_eq!(one.invocation, whole.invocation(1003 * 5 + 2));
        // A different number of invocations leaves the first ones as they are.
        assert_eq!(sampler.batch(1103, 1, 1).invocations, whole.invocation(1003 * 5));
    }

    #[test]
    fn seeds_cases_and_lanes_give_different_samples() {
        let plan = morph();
        let base = plan.sample(11, 0, 0);
        assert_ne!(plan.sample(12, 0, 0), base);
        assert_ne!(plan.sample(11, 1, 0).case, base.case);
        assert_ne!(plan.sample(11, 0, 1).invocation, base.invocation);
        assert_eq!(plan.sample(11, 0, 1).case, base.case);
    }

    #[test]
    fn names_are_filled_wherever_they_lie() {
        let batch = Sampler::new(morph(), 3).batch(0, 64, 4);
        for i in 0..batch.invocation_count() {
            let words: Vec<f32> = batch.invocation(i).iter().map(|&w| f32::from_bits(w)).collect();
            assert_eq!((words[3], words[8]), (1.0, 1.0));
            assert!((3.0..=4.0).contains(&words[4]));
            assert!(words[..3].iter().all(|w| w.abs() <= 2.0));
        }
    }

    #[test]
    #[ignore = "a measurement, for release builds: cargo test --release --lib -- --ignored --nocapture filling"]
    fn filling_a_million_samples_of_two_floats_takes_at_most_ten_milliseconds_on_one_core() {
        let plan = Plan::new(
            &[group(&["parameter"], "interval", Some([0.0, 1.0]))],
            record(&[("parameter", Shape::VEC2)]),
            record(&[]),
        );
        let plan = plan.unwrap();
        let mut words = vec![0; 2 << 20];
        let mut best = f64::INFINITY;
        for _ in 0..20 {
            let start = std::time::Instant::now();
            fill_invocations(&plan, 1, 0, 0, 16, &mut words);
            best = best.min(start.elapsed().as_secs_f64());
        }
        assert!(best <= 0.010, "{:.2} ms", best * 1e3);
    }
}
