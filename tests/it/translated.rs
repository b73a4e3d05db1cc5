//! Translations against the shaders that they are made from: what is right agrees on every shipped
//! suite, and what is edited into a wrong one is caught.

use std::fmt::Write as _;

use shadercheck::program::{Language, Translation};
use shadercheck::property::Sampler;
use shadercheck::suite::run::Prepared;
use shadercheck::suite::shipped;
use shadercheck::verdict::{Comparison, Translations, Unread};

use crate::alarms::prepared;

const SEED: u64 = 11;

fn compare(prepared: &Prepared, translations: &Translations, cases: usize) -> Vec<Comparison> {
    let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
    translations.compare(&Sampler::new(prepared.plan.clone(), SEED).batch(0, cases, per_case)).unwrap()
}

#[test]
fn every_shipped_shader_means_the_same_in_every_language_that_reads_back() {
    let mut told = String::new();
    for suite in shipped() {
        let prepared = prepared(suite.name);
        let translations = Translations::of(&prepared.program);
        for (language, why) in translations.unread() {
            writeln!(told, "{}: {language}: {why:?}", suite.name).unwrap();
        }
        let compared = compare(&prepared, &translations, 128);
        assert!(compared.len() == 3 || !told.is_empty());
        for one in compared {
            if let Some(first) = one.first {
                writeln!(told, "{}: {first}; {} agree", suite.name, one.agreed).unwrap();
            }
            assert_eq!(one.undetermined, 0, "{}", suite.name);
            assert!(one.agreed >= 128 || !one.deviating.is_empty());
        }
    }
    assert_eq!(told, "");
}
