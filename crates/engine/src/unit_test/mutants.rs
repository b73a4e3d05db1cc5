//! Faults that are planted in what tests call, and which of them the tests notice: a tolerance that lets them pass is too wide.

use std::collections::{BTreeMap, HashMap};

use base::text::{SourceFile, Span};
use base::value::ulp_at;
use compose::ASSERTIONS;
use judge::verdict::Movement;
use program::interp::{Binary32, Machine, OutputColumn};
use rayon::prelude::*;
use syntax::Shader;

use super::mark::{OWN, UnitTest, is_assertion};
use super::record::Places;
use super::run::{Ran, found, sample};
use super::verdict::Expectation;
use crate::fuzz::{Ready, Subject};
use crate::mutate::{Kill, Mutant, Operator, Outcome, SuiteResult, Tested, diff, mutants};
use property::Sample;

/// Rounds of loops of a mutant.
const FUEL: u32 = 1 << 14;

/// Makes the functions of these names ready of a text, or says why it cannot be read.
pub type Build<'a> = dyn Fn(&SourceFile, &[String]) -> Result<Vec<Subject>, String> + Sync + 'a;

/// A test that passes.
#[derive(Clone, Copy)]
pub struct Passing<'a> {
    /// The test.
    pub test: &'a UnitTest,
    /// What it expects.
    pub ran: &'a Ran,
}

/// Plants faults in the code that tests call, and gives what became of them, file by file. `shader` is the text with a function
/// for each test; tests themselves stay as they are.
pub fn mutate(
    shader: &Shader,
    tests: &[Passing<'_>],
    operators: &[&'static Operator],
    build: &Build<'_>,
) -> Vec<SuiteResult> {
    let file = shader.file();
    // Each mutant once, with the tests that reach it.
    let mut all: Vec<(Mutant, Vec<usize>)> = Vec::new();
    let mut known: HashMap<String, usize> = HashMap::new();
    for (number, passing) in tests.iter().enumerate() {
        for mutant in mutants(shader, &passing.test.entry, operators) {
            if is_of_a_test(shader, mutant.span, tests) {
                continue;
            }
            let at = *known.entry(mutant.shader.text().to_owned()).or_insert_with(|| {
                all.push((mutant, Vec::new()));
                all.len() - 1
            });
            all[at].1.push(number);
        }
    }
    let one = |(mutant, reaching): &(Mutant, Vec<usize>)| {
        let reaching: Vec<Passing<'_>> = reaching.iter().map(|&number| tests[number]).collect();
        let outcome = outcome(mutant, &reaching, build);
        let (origin, span) = file.origin(mutant.span);
        let at = origin.position(span.start);
        let tested = Tested {
            operator: mutant.operator,
            what: mutant.what.clone(),
            line: at.line,
            column: at.column,
            diff: diff(file, &mutant.shader),
            outcome,
            samples: reaching.iter().map(|passing| passing.ran.expectations.len() as u64).sum(),
        };
        (origin.name().to_owned(), tested)
    };
    let tested: Vec<(String, Tested)> = all.par_iter().map(one).collect();
    let mut by_file: BTreeMap<String, Vec<Tested>> = BTreeMap::new();
    tested.into_iter().for_each(|(file, tested)| by_file.entry(file).or_default().push(tested));
    let samples = tests.iter().map(|passing| passing.ran.expectations.len() as u64).sum();
    let result = |(shader, tested): (String, _)| SuiteResult { suite: shader.clone(), shader, samples, tested };
    by_file.into_iter().map(result).collect()
}

/// True for a place in a test, or in what tests are made of.
fn is_of_a_test(shader: &Shader, span: Span, tests: &[Passing<'_>]) -> bool {
    if shader.file().origin(span).0.name() == ASSERTIONS {
        return true;
    }
    let around = shader.functions().find(|(_, own)| {
        let item = own.definition.and_then(|item| shader.unit().items.get(item));
        item.is_some_and(|item| item.span.touches(span))
    });
    around.is_some_and(|(_, own)| {
        let name = &own.name.name;
        let holds = tests.iter().any(|passing| passing.test.function == *name);
        holds || name.starts_with(OWN) || is_assertion(name)
    })
}

/// What became of a mutant.
fn outcome(mutant: &Mutant, reaching: &[Passing<'_>], build: &Build<'_>) -> Outcome {
    let entries: Vec<String> = reaching.iter().map(|passing| passing.test.entry.clone()).collect();
    let subjects = match build(&mutant.shader, &entries) {
        Ok(subjects) => subjects,
        Err(why) => return Outcome::Invalid(why),
    };
    let mut moved: Option<Movement> = None;
    for passing in reaching {
        let ready = match subjects.iter().find(|own| own.name == passing.test.entry).map(|own| &own.ready) {
            Some(Ok(ready)) => ready,
            Some(Err(why)) => return Outcome::Invalid(why.clone()),
            None => return Outcome::Invalid("a test got lost".to_owned()),
        };
        match noticed(ready, passing, &mut moved) {
            Ok(false) => {}
            Ok(true) => return Outcome::Killed(Kill::Test(passing.test.name.clone())),
            Err(kill) => return Outcome::Killed(kill),
        }
    }
    match (moved, mutant.identity) {
        (Some(moved), _) => Outcome::Survived(moved),
        (None, Some(why)) => Outcome::Equivalent(why.into()),
        (None, None) => Outcome::Unmoved,
    }
}

/// True where a test fails on a mutant. What it computes otherwise, and passes with, goes to `moved`.
fn noticed(ready: &Ready, passing: &Passing<'_>, moved: &mut Option<Movement>) -> Result<bool, Kill> {
    let Some(places) = Places::of(&ready.program.output_layout().vertex) else { return Ok(true) };
    for (k, own) in passing.ran.expectations.iter().enumerate() {
        let mut machine = Machine::new(&ready.executable, Binary32::default(), FUEL);
        machine.run_some(&Sample::batch(&[sample(ready, k)]), &[0]);
        if machine.flags()[0].is_stopped() {
            return Err(Kill::NotFinished);
        }
        let words: Vec<u32> = (0..ready.executable.outputs().count())
            .map(|word| match machine.output(0, word) {
                OutputColumn::Real(column) => column.values()[0].to_bits(),
                OutputColumn::Word(words) => words[0],
            })
            .collect();
        let now = found(&words, &places, own.real.len());
        if words[places.count] as usize != passing.ran.expectations.len() || !own.kind.holds(&now) {
            return Ok(true);
        }
        if let Some(by) = distance(own, &now.actual) {
            let component = Some(passing.test.name.clone());
            let new = Movement { samples: 1, bounds: by, component };
            match moved {
                Some(before) => before.merge(new),
                None => *moved = Some(new),
            }
        }
    }
    Ok(false)
}

/// How far a value is from that of the original, in units of what a device may be off; none where it is the same.
fn distance(own: &Expectation, now: &[f32]) -> Option<f64> {
    let before = &own.lanes.first()?.found.actual;
    let each = before.iter().zip(now).zip(&own.real).map(|((&before, &now), (real, _))| {
        let by = (f64::from(before) - f64::from(now)).abs();
        if by == 0.0 { 0.0 } else { by / real.bound.max(0.5 * ulp_at(f64::from(before))) }
    });
    Some(each.fold(0.0, f64::max)).filter(|by| *by > 0.0)
}
