//! Every relation on the formulas themselves, in binary64: a formula in the place of a device.

use std::sync::Arc;

use super::all;
use crate::formula;
use crate::formula::testing::{Rng, random_words};
use base::value::{Field, Record, Shape};
use judge::formula::{Args, Emission, Formula, Kind, Param, Rule};
use property::{Observed, Relation, Sample};

/// Slack of outputs in binary64.
const SLACK: f64 = 1e-9;

/// A formula in the place of a device, with a fault before and after it.
pub(super) struct Device {
    pub(super) formula: &'static Formula,
    before: fn(&mut Sample),
    after: fn(&mut [f64]),
}

impl Device {
    fn right(name: &str) -> Self {
        Self { formula: formula::by_name(name).unwrap(), before: |_| (), after: |_| () }
    }

    pub(super) fn after(name: &str, after: fn(&mut [f64])) -> Self {
        Self { after, ..Self::right(name) }
    }

    pub(super) fn before(name: &str, before: fn(&mut Sample)) -> Self {
        Self { before, ..Self::right(name) }
    }

    fn run(&self, sample: &Sample) -> Observed {
        let mut sample = sample.clone();
        (self.before)(&mut sample);
        let words: Vec<f64> = self.formula.inputs.iter().flat_map(|p| sample.get(p.name)).collect();
        let args = Args::new(self.formula.inputs, &words);
        let size: usize = self.formula.outputs.iter().map(Param::words).sum();
        let mut words = vec![f64::NAN; size];
        match self.formula.rule {
            Rule::Pointwise(f) => f(&args, &mut words),
            Rule::Emission(f) => {
                let mut emission = Emission::default();
                f(&args, &mut emission);
                words = emission.words;
            }
        }
        words.chunks_exact_mut(size).for_each(self.after);
        Observed { vertices: words.len() / size, slack: vec![SLACK; words.len()], words }
    }
}

fn shape(param: &Param) -> Shape {
    let element = match param.kind {
        Kind::Float => Shape::FLOAT,
        Kind::Int => Shape::INT,
        Kind::Vec2 => Shape::VEC2,
        Kind::Vec3 => Shape::VEC3,
        Kind::Vec4 => Shape::VEC4,
        Kind::Mat4 => Shape::MAT4,
    };
    param.array.map_or(element, |len| element.array_of(len as u32))
}

/// A sample inside the formula's domain, with coinciding points and values at the ends of their range
/// now and then. Matrices are uniforms, the rest belongs to the invocation.
fn sample(formula: &Formula, rng: &mut Rng) -> Sample {
    let record = |uniform: bool| {
        let params = formula.inputs.iter().filter(|p| (p.kind == Kind::Mat4) == uniform);
        Arc::new(Record::new(params.map(|p| Field { name: p.name.into(), shape: shape(p) }).collect()))
    };
    let (invocation_record, case_record) = (record(false), record(true));
    let (invocation, case) = (vec![0; invocation_record.words()], vec![0; case_record.words()]);
    let mut sample = Sample { invocation_record, case_record, invocation, case };
    let words = random_words(formula, rng);
    let (mut at, mut last) = (0, None);
    for param in formula.inputs {
        let mut values = words[at..at + param.words()].to_vec();
        at += param.words();
        let choice = rng.bits();
        match param.name {
            "numberOfBones" => values[0] = (choice % 8 + 1) as f64,
            "part" => values[0] = (choice % 4) as f64,
            "m0" | "m1" => values[3] = 0.0,
            "bias" | "continuity" | "tension" => values[0] = 2.0 * values[0] - 1.0,
            "c" => values[0] = 1.0 + 63.0 * values[0],
            "s" | "t" | "d" if choice % 8 < 2 => values[0] = (choice % 2) as f64,
            _ => (),
        }
        if param.kind == Kind::Vec4
            && choice.is_multiple_of(8)
            && values.last() == Some(&1.0)
            && let Some(last) = last.replace(values[..4].to_vec())
        {
            values[..4].copy_from_slice(&last);
        }
        sample.set(param.name, &values);
    }
    sample
}

/// How often a relation made a claim and how often one failed.
fn run(relation: &dyn Relation, device: &Device) -> (usize, Vec<String>) {
    let (mut made, mut failed) = (0, Vec::new());
    let mut rng = Rng::new(150);
    for _ in 0..200 {
        let inputs = relation.inputs(&sample(device.formula, &mut rng));
        let outputs: Vec<Observed> = inputs.iter().map(|input| device.run(input)).collect();
        let mut claims = Vec::new();
        relation.claims(&inputs, &outputs, &mut claims);
        made += claims.len();
        for claim in claims {
            assert!(!claim.slack.is_infinite(), "{}: {claim:?}", relation.name());
            let holds = (claim.left - claim.right).abs() <= claim.slack;
            if !holds {
                failed.push(format!("{}: {claim:?}", relation.name()));
            }
        }
    }
    (made, failed)
}

/// Relations that the suite of a formula names.
fn named_by_suite(formula: &str) -> Vec<&'static dyn Relation> {
    let (_, table) = suites().into_iter().find(|(name, _)| name == formula).unwrap();
    let names = table["relations"].as_array().unwrap();
    names.iter().map(|name| super::by_name(name.as_str().unwrap()).unwrap_or_else(|| panic!("{name}"))).collect()
}

/// Names of the suite's relations that the device breaks.
pub(super) fn broken(device: &Device) -> Vec<&'static str> {
    let relations = named_by_suite(device.formula.name);
    relations.into_iter().filter(|r| !run(*r, device).1.is_empty()).map(Relation::name).collect()
}

/// Suite files beside the shaders, by the name of the suite.
fn suites() -> Vec<(String, toml::Table)> {
    let mut suites = Vec::new();
    for folder in ["chapter9", "hair"] {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders").join(folder);
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.to_string_lossy().ends_with(".suite.toml") {
                let table: toml::Table = std::fs::read_to_string(&path).unwrap().parse().unwrap();
                suites.push((table["suite"].as_str().unwrap().to_owned(), table));
            }
        }
    }
    suites.sort_by(|a, b| a.0.cmp(&b.0));
    suites
}

#[test]
fn every_relation_holds_for_the_formulas_and_makes_claims() {
    for formula in formula::all() {
        let device = Device::right(formula.name);
        for relation in named_by_suite(formula.name) {
            let (made, failed) = run(relation, &device);
            assert!(made >= 200, "{} made {made} claims on {}", relation.name(), formula.name);
            assert!(failed.is_empty(), "{}: {:#?}", formula.name, &failed[..failed.len().min(5)]);
        }
    }
}

#[test]
fn every_formula_has_a_suite_that_feeds_all_its_inputs() {
    let names: Vec<_> = suites().into_iter().map(|(name, _)| name).collect();
    for formula in formula::all() {
        assert!(names.iter().any(|name| name == formula.name), "{}", formula.name);
    }
    for (name, table) in suites() {
        let formula = formula::by_name(table["formula"].as_str().unwrap()).unwrap();
        let inputs = table["inputs"].as_array().unwrap();
        let mut fed: Vec<&str> =
            inputs.iter().flat_map(|i| i["names"].as_array().unwrap()).map(|n| n.as_str().unwrap()).collect();
        let mut wanted: Vec<&str> = formula.inputs.iter().map(|p| p.name).collect();
        fed.sort_unstable();
        wanted.sort_unstable();
        assert_eq!(fed, wanted, "{name}");
    }
}

#[test]
fn every_relation_is_named_by_a_suite_and_has_its_own_name() {
    let named: Vec<&str> = formula::all().iter().flat_map(|f| named_by_suite(f.name)).map(Relation::name).collect();
    for (i, relation) in all().iter().enumerate() {
        assert!(named.contains(&relation.name()), "{}", relation.name());
        assert!(all()[..i].iter().all(|r| r.name() != relation.name()), "{}", relation.name());
        assert!(!relation.statement().ends_with('.') && !relation.statement().is_empty());
    }
}

#[test]
fn a_relation_says_nothing_about_inputs_that_it_does_not_know() {
    let weight = sample(formula::by_name("bone_weight").unwrap(), &mut Rng::new(1));
    for relation in all().iter().filter(|r| !r.name().starts_with("weight")) {
        assert!(relation.inputs(&weight).is_empty(), "{}", relation.name());
    }
}

#[test]
fn missing_outputs_fail_and_do_not_panic() {
    for formula in formula::all() {
        for relation in named_by_suite(formula.name) {
            let inputs = relation.inputs(&sample(formula, &mut Rng::new(2)));
            let nothing = Observed { vertices: 0, words: Vec::new(), slack: Vec::new() };
            let mut claims = Vec::new();
            relation.claims(&inputs, &vec![nothing; inputs.len()], &mut claims);
            let fails = !claims.iter().all(|c| (c.left - c.right).abs() <= c.slack);
            // The outer matrix does not know how many vertices there should be.
            assert!(fails || inputs.is_empty() || relation.name() == "projection_last", "{}", relation.name());
        }
    }
}

#[test]
fn nan_is_noticed_in_every_suite() {
    for formula in formula::all() {
        let found = broken(&Device::after(formula.name, |out| out.fill(f64::NAN)));
        assert_eq!(found.len(), named_by_suite(formula.name).len(), "{}: {found:?}", formula.name);
    }
}
