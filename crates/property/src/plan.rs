//! A plan: which generator fills which input of a shader.

use std::collections::HashSet;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use thiserror::Error;

use base::value::{Field, Record, Shape};

use super::Sample;
use super::generators::{Generator, Group, Options};
use super::own::Own;
use super::shrink::Domain;
use super::stream::{mix, mix_text};
use base::nearest;

/// Inputs that one generator fills together, as a suite states them.
#[derive(Clone)]
pub struct InputGroup {
    /// Names of the inputs, in the order in which the generator takes them.
    pub names: Vec<String>,
    /// What makes their values.
    pub generator: Own<dyn Generator>,
    /// What the suite says beside that.
    pub options: Options,
    /// Where the suite says it, such as `skinning.suite.toml:14:1`; shown before messages.
    pub at: String,
}

impl fmt::Debug for InputGroup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("InputGroup")
            .field("names", &self.names)
            .field("generator", &self.generator.name())
            .field("options", &self.options)
            .field("at", &self.at)
            .finish()
    }
}

impl InputGroup {
    /// The group with every field in place of a name with `[]`, which stands for each index: `boids[].position`.
    pub fn over<'f>(&self, fields: impl Iterator<Item = &'f Field> + Clone) -> Self {
        let each = |name: &String| -> Vec<String> {
            let parts: Vec<&str> = name.split("[]").collect();
            let found = fields.clone().filter(|field| parts.len() > 1 && has_parts(&field.name, &parts));
            let found: Vec<String> = found.map(|field| field.name.clone()).collect();
            if found.is_empty() { vec![name.clone()] } else { found }
        };
        Self { names: self.names.iter().flat_map(each).collect(), ..self.clone() }
    }
}

/// The name of a field with `[]` for each index into an array of structures, as [`InputGroup::over`] takes it.
pub fn pattern(name: &str) -> String {
    let mut text = String::new();
    let mut inside = false;
    for c in name.chars() {
        inside &= c != ']';
        if !inside {
            text.push(c);
        }
        inside |= c == '[';
    }
    text
}

/// True for a name that consists of these parts with an index between each two.
fn has_parts(name: &str, parts: &[&str]) -> bool {
    let Some(mut rest) = parts.first().and_then(|first| name.strip_prefix(first)) else { return false };
    for part in &parts[1..] {
        let index = rest.strip_prefix('[').and_then(|inside| inside.split_once(']'));
        let Some((digits, behind)) = index else { return false };
        let behind = behind.strip_prefix(part).filter(|_| digits.bytes().all(|digit| digit.is_ascii_digit()));
        let Some(behind) = behind else { return false };
        rest = behind;
    }
    rest.is_empty()
}

/// Why inputs of a suite and inputs of a shader do not fit each other.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum PlanError {
    /// A name that the shader does not have.
    #[error("{at}: the shader has no input `{name}`{}", hint(.suggestion))]
    NoSuchInput {
        /// Where the suite says it.
        at: String,
        /// The name as the suite has it.
        name: String,
        /// The input with the most similar name.
        suggestion: Option<String>,
    },
    /// An input that no group names.
    #[error(
        "nothing fills the input `{name}` ({shape}) of the shader; add an [[inputs]] group with names = [\"{name}\"]"
    )]
    NotFilled {
        /// The input.
        name: String,
        /// Shape that a generator has to fill.
        shape: Shape,
    },
    /// An input that two groups name, or one names twice.
    #[error("{at}: the input `{name}` is filled already")]
    FilledTwice {
        /// Where the suite says it for the second time.
        at: String,
        /// The input.
        name: String,
    },
    /// A group with uniforms and inputs of an invocation.
    #[error(
        "{at}: `{uniform}` is a uniform and `{input}` differs for each invocation; one group cannot fill both, make two groups"
    )]
    BothSides {
        /// Where the suite says it.
        at: String,
        /// A uniform of the group.
        uniform: String,
        /// An input of the invocation.
        input: String,
    },
    /// Shapes or options that the generator refuses.
    #[error("{at}: {message} (inputs: {names})")]
    Unfit {
        /// Where the suite says it.
        at: String,
        /// Names and shapes of the group.
        names: String,
        /// What is wrong.
        message: String,
    },
    /// `components` for a uniform.
    #[error("{at}: `components` says how many floats feed an attribute; `{name}` is a uniform")]
    UniformComponents {
        /// Where the suite says it.
        at: String,
        /// The uniform.
        name: String,
    },
}

fn hint(suggestion: &Option<String>) -> String {
    suggestion.as_ref().map(|s| format!("; did you mean `{s}`?")).unwrap_or_default()
}

/// Number of the case from which samples at edges take their other groups: no run comes that far.
const EDGES: u64 = 1 << 62;
/// Samples from which they take them: few, so that what is at an edge stands out.
const BASES: usize = 4;

/// A group with its place in the records.
#[derive(Debug)]
pub(super) struct Planned {
    pub generator: Own<dyn Generator>,
    pub group: Group,
    /// Where the words lie, neighbours joined, in the order of the names.
    pub spans: Vec<Range<usize>>,
    pub salt: u64,
}

impl Planned {
    /// The words of the group, gathered from a record.
    pub(super) fn gather(&self, record: &[u32]) -> Vec<u32> {
        self.spans.iter().flat_map(|span| record[span.clone()].iter().copied()).collect()
    }

    pub(super) fn scatter(&self, words: &[u32], record: &mut [u32]) {
        let mut at = 0;
        for span in &self.spans {
            record[span.clone()].copy_from_slice(&words[at..at + span.len()]);
            at += span.len();
        }
    }

    fn admits(&self, record: &[u32]) -> bool {
        let words = self.gather(record);
        self.group.fetched().iter().all(|&(word, value)| words[word] == value)
            && self.generator.admits(&self.group, &words)
    }
}

/// Which generator fills which input: everything that samples are made from, but for the seed.
#[derive(Debug)]
pub struct Plan {
    invocation_record: Arc<Record>,
    case_record: Arc<Record>,
    pub(super) invocation: Vec<Planned>,
    pub(super) case: Vec<Planned>,
}

impl Plan {
    /// Fits groups to the inputs of a shader: `invocation` holds attributes, inputs of a primitive or
    /// arguments, `case` the uniforms. Every input has to be filled once.
    ///
    /// # Errors
    /// The first thing that does not fit.
    pub fn new(groups: &[InputGroup], invocation: Arc<Record>, case: Arc<Record>) -> Result<Self, PlanError> {
        let mut plan = Self { invocation_record: invocation, case_record: case, invocation: vec![], case: vec![] };
        let mut filled: HashSet<&str> = HashSet::new();
        for group in groups {
            for name in &group.names {
                if !filled.insert(name) {
                    return Err(PlanError::FilledTwice { at: group.at.clone(), name: name.clone() });
                }
            }
            plan.add(group)?;
        }
        let fields = plan.case_record.fields().iter().chain(plan.invocation_record.fields());
        match fields.into_iter().find(|f| !filled.contains(&*f.name)) {
            Some(field) => Err(PlanError::NotFilled { name: field.name.clone(), shape: field.shape }),
            None => Ok(plan),
        }
    }

    /// A plan that makes no samples of its own: all are given one by one, and whatever they hold is admitted.
    pub fn of_given(invocation: Arc<Record>, case: Arc<Record>) -> Self {
        Self { invocation_record: invocation, case_record: case, invocation: vec![], case: vec![] }
    }

    /// True for a plan that makes samples.
    pub fn makes_samples(&self) -> bool {
        self.groups() > 0 || self.invocation_record.words() + self.case_record.words() == 0
    }

    fn add(&mut self, group: &InputGroup) -> Result<(), PlanError> {
        let at = || group.at.clone();
        let (mut uniform, mut input) = (None, None);
        for name in &group.names {
            if self.invocation_record.index_of(name).is_some() {
                input = Some(name);
            } else if self.case_record.index_of(name).is_some() {
                uniform = Some(name);
            } else {
                let fields = self.case_record.fields().iter().chain(self.invocation_record.fields());
                let suggestion = nearest(name, fields.map(|f| f.name.as_str())).map(str::to_owned);
                return Err(PlanError::NoSuchInput { at: at(), name: name.clone(), suggestion });
            }
        }
        if let (Some(uniform), Some(input)) = (uniform, input) {
            return Err(PlanError::BothSides { at: at(), uniform: uniform.clone(), input: input.clone() });
        }
        if let (Some(uniform), Some(_)) = (uniform, group.options.components) {
            return Err(PlanError::UniformComponents { at: at(), name: uniform.clone() });
        }
        let (record, side) = match uniform {
            Some(_) => (&self.case_record, &mut self.case),
            None => (&self.invocation_record, &mut self.invocation),
        };
        let (mut shapes, mut spans) = (Vec::new(), Vec::<Range<usize>>::new());
        for index in group.names.iter().filter_map(|name| record.index_of(name)) {
            shapes.push(record.fields()[index].shape);
            let span = record.range(index);
            match spans.last_mut() {
                Some(last) if last.end == span.start => last.end = span.end,
                _ => spans.push(span),
            }
        }
        let resolved = Group::new(&*group.generator, &shapes, group.options.clone()).map_err(|message| {
            let names = group.names.iter().zip(&shapes).map(|(name, shape)| format!("{shape} {name}"));
            PlanError::Unfit { at: at(), names: names.collect::<Vec<_>>().join(", "), message }
        })?;
        let salt = group.names.iter().fold(0, |salt, name| mix_text(salt, name));
        side.push(Planned { generator: group.generator.clone(), group: resolved, spans, salt });
        Ok(())
    }

    /// Layout of the inputs of an invocation.
    pub fn invocation_record(&self) -> &Arc<Record> {
        &self.invocation_record
    }

    /// Layout of the uniforms.
    pub fn case_record(&self) -> &Arc<Record> {
        &self.case_record
    }

    /// The sample of invocation `invocation` in case `case`; the same as in every batch that holds it.
    pub fn sample(&self, seed: u64, case: u64, invocation: usize) -> Sample {
        let mut sample = Sample {
            invocation_record: self.invocation_record.clone(),
            case_record: self.case_record.clone(),
            invocation: vec![0; self.invocation_record.words()],
            case: vec![0; self.case_record.words()],
        };
        super::sampler::fill_cases(self, seed, case, &mut sample.case);
        super::sampler::fill_invocations(self, seed, case, invocation, usize::MAX, &mut sample.invocation);
        sample
    }

    /// Samples at the edges of each group, the other groups being ordinary; they depend on the seed alone.
    pub fn edges(&self, seed: u64) -> Vec<Sample> {
        let mut all = Vec::new();
        for (in_case, groups) in [(true, &self.case), (false, &self.invocation)] {
            for planned in groups {
                let ordinary = |nth: usize| self.sample(seed, EDGES + (nth % BASES) as u64, nth % BASES);
                let base = ordinary(all.len());
                let words = planned.gather(if in_case { &base.case } else { &base.invocation });
                for words in planned.generator.edges(&planned.group, &words) {
                    let mut sample = ordinary(all.len());
                    planned.scatter(&words, if in_case { &mut sample.case } else { &mut sample.invocation });
                    all.push(sample);
                }
            }
        }
        all
    }

    fn sides<'a>(&'a self, sample: &'a Sample) -> [(&'a [Planned], &'a [u32]); 2] {
        [(&self.case, &sample.case), (&self.invocation, &sample.invocation)]
    }
}

impl Domain for Plan {
    fn admits(&self, sample: &Sample) -> bool {
        let mut sides = self.sides(sample).into_iter();
        sides.all(|(groups, words)| groups.iter().all(|g| g.admits(words)))
    }

    fn simplest(&self, sample: &Sample) -> Sample {
        let mut simplest = sample.clone();
        for (groups, record) in [(&self.case, &mut simplest.case), (&self.invocation, &mut simplest.invocation)] {
            for planned in groups {
                let mut words = vec![0; planned.group.words()];
                planned.generator.simplest(&planned.group, &mut words);
                planned.group.fetch(&mut words);
                planned.scatter(&words, record);
            }
        }
        simplest
    }

    fn simpler(&self, sample: &Sample, group: usize, k: usize) -> Option<Sample> {
        let in_case = group < self.case.len();
        let planned = if in_case { &self.case[group] } else { &self.invocation[group - self.case.len()] };
        let mut sample = sample.clone();
        let record = if in_case { &mut sample.case } else { &mut sample.invocation };
        let words = planned.gather(record);
        let mut out = words.clone();
        if !planned.generator.simpler(&planned.group, &words, k, &mut out) {
            return None;
        }
        planned.group.fetch(&mut out);
        planned.scatter(&out, record);
        Some(sample)
    }

    fn groups(&self) -> usize {
        self.case.len() + self.invocation.len()
    }
}

/// The seed of a group for a seed of the run.
pub(super) fn key(seed: u64, planned: &Planned) -> u64 {
    mix(seed, planned.salt)
}

#[cfg(test)]
mod tests;
