//! What reference data are about: a suite, or a function or stage that has none.

use std::sync::Arc;

use super::digest::Digest;
use super::document::{Domain, SuiteSource};
use super::layout;
use base::value::{Batch, Field, Record};
use engine::fuzz;
use engine::suite::Expect;
use engine::suite::run::Prepared;
use judge::verdict::{Oracle, Reference};
use program::Program;
use property::{Sample, Sampler};

/// A function, or the stage of a file, without a suite: its inputs are those that `fuzz` gives it, and what is
/// expected is what it means.
pub struct Bare {
    name: String,
    title: String,
    shader: String,
    stage: &'static str,
    text: String,
    program: Program,
    oracle: Oracle,
    reference: Reference,
    domain: fuzz::Domain,
    records: [Arc<Record>; 2],
    key: String,
}

/// What a file says of a function that has no suite.
pub struct Origin<'a> {
    /// Name of the data set.
    pub name: &'a str,
    /// File name of the shader.
    pub shader: &'a str,
    /// The text of the file.
    pub text: &'a str,
    /// `function`, or the stage whose `main` it is.
    pub stage: &'static str,
}

impl Bare {
    /// Of a function that `fuzz` can run.
    ///
    /// # Errors
    /// Why it cannot be run, or gives no reference data.
    pub fn new(origin: &Origin<'_>, subject: fuzz::Subject, domain: fuzz::Domain) -> Result<Self, String> {
        let fuzz::Subject { label, ready, .. } = subject;
        let fuzz::Ready { program, kernel, .. } = *ready?;
        if let Some(texture) = program.textures.first() {
            return Err(format!(
                "it reads the texture {texture}, and a file with its inputs would not hold it; write a suite with \
                 [[textures]] (`shadercheck init`)"
            ));
        }
        let oracle = Oracle::new(&program).map_err(|error| error.locate(&program))?;
        let what =
            if origin.stage == "function" { format!("`{label}`") } else { format!("the {} stage", origin.stage) };
        Ok(Self {
            name: origin.name.to_owned(),
            title: format!("{what} of {}, without a suite", origin.shader),
            shader: origin.shader.to_owned(),
            stage: origin.stage,
            text: origin.text.to_owned(),
            reference: Reference::nothing(&program),
            oracle,
            domain,
            records: [kernel.invocation.clone(), kernel.case.clone()],
            program,
            key: label,
        })
    }

    /// Name of the suite, or what was given where there is none.
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// What reference data are made of.
#[derive(Clone, Copy)]
pub enum Subject<'a> {
    /// A suite.
    Suite(&'a Prepared),
    /// A function or stage without one.
    Bare(&'a Bare),
}

impl<'a> From<&'a Prepared> for Subject<'a> {
    fn from(prepared: &'a Prepared) -> Self {
        Self::Suite(prepared)
    }
}

impl<'a> From<&'a Bare> for Subject<'a> {
    fn from(bare: &'a Bare) -> Self {
        Self::Bare(bare)
    }
}

impl<'a> Subject<'a> {
    /// Name of the suite, or what was given where there is none.
    pub fn name(self) -> &'a str {
        match self {
            Self::Suite(prepared) => &prepared.suite.name,
            Self::Bare(bare) => &bare.name,
        }
    }

    pub(super) fn program(self) -> &'a Program {
        match self {
            Self::Suite(prepared) => &prepared.program,
            Self::Bare(bare) => &bare.program,
        }
    }

    pub(super) fn oracle(self) -> &'a Oracle {
        match self {
            Self::Suite(prepared) => &prepared.oracle,
            Self::Bare(bare) => &bare.oracle,
        }
    }

    pub(super) fn reference(self) -> &'a Reference {
        match self {
            Self::Suite(prepared) => &prepared.reference,
            Self::Bare(bare) => &bare.reference,
        }
    }

    /// What is expected, as the suite states it.
    pub(super) fn expect(self) -> &'a Expect {
        match self {
            Self::Suite(prepared) => &prepared.suite.expect,
            Self::Bare(_) => &Expect::Nothing,
        }
    }

    /// Layouts of the inputs of an invocation and of a case.
    pub(super) fn records(self) -> [&'a Record; 2] {
        match self {
            Self::Suite(prepared) => [prepared.plan.invocation_record(), prepared.plan.case_record()],
            Self::Bare(bare) => [&bare.records[0], &bare.records[1]],
        }
    }

    /// Invocations that share one set of uniforms.
    pub(super) fn per_case(self) -> usize {
        match self {
            Self::Suite(prepared) if self.given().is_none() => {
                prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1)
            }
            Self::Suite(_) | Self::Bare(_) => 1,
        }
    }

    /// Samples that are stated one by one, and no others.
    pub(super) fn given(self) -> Option<&'a [Sample]> {
        match self {
            Self::Suite(prepared) if matches!(prepared.suite.expect, Expect::Recorded(_)) => Some(&prepared.rows),
            Self::Suite(_) | Self::Bare(_) => None,
        }
    }

    pub(super) fn samples(self, seed: u64) -> Samples<'a> {
        match self {
            Self::Suite(prepared) => match self.given() {
                Some(rows) => Samples::Given(rows),
                None => Samples::Plan(Sampler::new(prepared.plan.clone(), seed)),
            },
            Self::Bare(bare) => Samples::Domain { bare, key: fuzz::stream_key(seed, &bare.key) },
        }
    }

    /// Where it comes from.
    pub(super) fn source(self) -> SuiteSource {
        match self {
            Self::Suite(prepared) => {
                let suite = &prepared.suite;
                SuiteSource {
                    name: suite.name.clone(),
                    title: suite.title.clone(),
                    shader: prepared.shader.rsplit(['/', '\\']).next().unwrap_or_default().to_owned(),
                    stage: suite.stage.name().into(),
                    defines: suite.chosen.clone(),
                    suite_sha256: Digest::of_text(suite.file.text()),
                    shader_sha256: Digest::of_text(prepared.program.file.text()),
                }
            }
            Self::Bare(bare) => SuiteSource {
                name: bare.name.clone(),
                title: bare.title.clone(),
                shader: bare.shader.clone(),
                stage: bare.stage.into(),
                defines: Vec::new(),
                suite_sha256: Digest::of_text(""),
                shader_sha256: Digest::of_text(&bare.text),
            },
        }
    }

    /// What fills its inputs.
    pub(super) fn domain(self) -> Vec<Domain> {
        match self {
            Self::Suite(_) if self.given().is_some() => {
                let names = self.records().iter().flat_map(|r| r.fields()).map(|f: &Field| f.name.clone()).collect();
                vec![plain(names, "recorded", "the inputs of the recorded rows, in their order".into(), None)]
            }
            Self::Suite(prepared) => layout::domain(&prepared.suite),
            Self::Bare(bare) => {
                let sides = [&bare.domain.invocation, &bare.domain.case];
                let all =
                    bare.records.iter().zip(sides).flat_map(|(record, inputs)| record.fields().iter().zip(inputs));
                all.map(|(field, input)| stated(field, input)).collect()
            }
        }
    }
}

fn plain(inputs: Vec<String>, generator: &str, about: String, range: Option<[f64; 2]>) -> Domain {
    Domain { inputs, generator: generator.into(), about, range, values: Vec::new(), components: None }
}

/// What `fuzz` gives an input.
fn stated(field: &Field, input: &fuzz::InputDomain) -> Domain {
    let laws: Vec<String> = input.laws.iter().map(ToString::to_string).collect();
    let about = match laws.is_empty() {
        true => "nothing is stated: ordinary sizes (0, and 1/1024 to 1024 either sign), special values, and now and \
                 then anything finite"
            .to_owned(),
        false => format!("as stated: {}", laws.join(", ")),
    };
    let finite = |i: &fuzz::Interval| i.low.is_finite() && i.high.is_finite();
    plain(vec![field.name.clone()], "fuzz", about, input.interval().filter(finite).map(|i| [i.low, i.high]))
}

/// Where samples come from. A sample depends on the seed and on its number alone.
pub(super) enum Samples<'a> {
    /// The generators of a suite.
    Plan(Sampler),
    /// The rows of a record.
    Given(&'a [Sample]),
    /// What `fuzz` gives a function.
    Domain { bare: &'a Bare, key: u64 },
}

impl Samples<'_> {
    /// These cases.
    pub fn batch(&self, first_case: u64, cases: usize, per_case: usize) -> Batch {
        match self {
            Self::Plan(sampler) => sampler.batch(first_case, cases, per_case),
            Self::Given(rows) => Sample::batch(&rows[first_case as usize..][..cases]),
            Self::Domain { bare, key } => {
                fuzz::batch(&bare.records[0], &bare.records[1], &bare.domain, *key, first_case, cases)
            }
        }
    }
}
