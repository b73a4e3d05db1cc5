//! Samples at the edges of what a shader decides, and what a run reached of its questions.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::part::Counted;
use super::trial::Trial;
use super::{Prepared, Request};
use base::text::Location;
use judge::verdict::diagnosis::in_one_line;
use judge::verdict::{BatchVerdict, Edges, Question, edges, judge_batch};
use lanes::LaneError;
use program::interp::author_span;
use property::Sampler;

/// Ordinary samples among which edges are sought: the first of the run.
const PILOT: u64 = 512;

/// A question of the author's text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Asked {
    /// File, line and column.
    pub at: Option<Location>,
    /// The author's text there.
    pub text: String,
    /// The macro that is used there, where the question is in what it expands to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expansion: Option<String>,
    /// True for a comparison, false for a call of a built-in function.
    pub comparison: bool,
    /// What asks, in a word: `clamp` asks as `max` and as `min`.
    pub operation: String,
    /// Answers of the comparison, or classes of arguments, that some sample had.
    pub met: Vec<String>,
    /// Those that none had. A class of arguments may be impossible, such as a negative square.
    pub missed: Vec<String>,
}

/// What a run reached of the questions of a shader: with its first samples, and with those at the edges.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reach {
    /// Ordinary samples that were watched.
    pub watched: u64,
    /// Samples at edges, which are judged beside those of the run.
    pub edges: u64,
    /// How many of these agree.
    pub agreed: u64,
    /// How many of these the lane leaves undetermined.
    pub undetermined: u64,
    /// Comparisons and calls of built-in functions, in the order of the text.
    pub asked: Vec<Asked>,
}

impl Reach {
    /// Comparisons that came out both ways, and all.
    pub fn comparisons(&self) -> (usize, usize) {
        let comparisons = || self.asked.iter().filter(|asked| asked.comparison);
        (comparisons().filter(|asked| asked.missed.is_empty()).count(), comparisons().count())
    }

    /// Classes of arguments of built-in functions that were met, and all.
    pub fn classes(&self) -> (usize, usize) {
        let calls = || self.asked.iter().filter(|asked| !asked.comparison);
        let met: usize = calls().map(|asked| asked.met.len()).sum();
        (met, met + calls().map(|asked| asked.missed.len()).sum::<usize>())
    }

    /// Comparisons that came out one way alone.
    pub fn one_sided(&self) -> impl Iterator<Item = &Asked> {
        self.asked.iter().filter(|asked| asked.comparison && !asked.missed.is_empty())
    }
}

/// "`l > 0.0` is never false, at FILE:LINE:COLUMN".
impl fmt::Display for Asked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is never {}", in_one_line(&self.text), self.missed.join(" or "))?;
        self.at.as_ref().map_or(Ok(()), |at| write!(f, ", at {at}"))?;
        self.expansion.as_ref().map_or(Ok(()), |name| write!(f, ", in the expansion of `{name}`"))
    }
}

/// The edges of a prepared suite, found once: lanes and stages share them.
#[derive(Default)]
pub struct KeptEdges(Mutex<Option<Kept>>);

/// Edges with the seed and the number of cases that they were found with.
type Kept = ((u64, u64), Arc<Edges>);

impl KeptEdges {
    fn get(&self, key: (u64, u64), find: impl FnOnce() -> Edges) -> Arc<Edges> {
        let mut found = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &*found {
            Some((known, edges)) if *known == key => edges.clone(),
            _ => found.insert((key, Arc::new(find()))).1.clone(),
        }
    }
}

/// Ordinary samples that are watched in a run of `wanted` samples.
fn watched(prepared: &Prepared, wanted: u64) -> (u64, usize) {
    let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
    (wanted.min(PILOT).div_ceil(per_case as u64), per_case)
}

/// The samples at the edges of a prepared suite, for a run of `wanted` samples.
pub fn of(prepared: &Prepared, seed: u64, wanted: u64) -> Arc<Edges> {
    let (cases, per_case) = watched(prepared, wanted);
    prepared.edges.get((seed, cases), || {
        let pilot = Sampler::new(prepared.plan.clone(), seed).batch(0, cases as usize, per_case);
        edges(&prepared.oracle, &*prepared.plan, &pilot, prepared.plan.edges(seed))
    })
}

/// Judges the samples at the edges, which have the numbers from `first` on in the run. Those that agree and those that
/// are undetermined are no part of its counts: most of them lie where a lane may decide either way.
pub(super) fn judge(
    trial: &mut Trial<'_>,
    request: &Request,
    (wanted, first): (u64, u64),
) -> Result<(Counted, Reach), LaneError> {
    let (context, prepared) = (trial.context(), trial.prepared);
    let found = of(prepared, request.seed, wanted);
    let (mut counted, mut all) = (Counted::default(), BatchVerdict::default());
    if !found.samples.is_empty() {
        trial.run_samples(&found.samples, |at, batch, actual| {
            let mut verdict = judge_batch(&context, batch, actual);
            counted.add(prepared, first + at as u64, (batch, actual), verdict.deviations());
            all.merge(verdict);
        })?;
    }
    let (cases, per_case) = watched(prepared, wanted);
    let reach = Reach {
        watched: cases * per_case as u64,
        edges: found.samples.len() as u64,
        agreed: all.agreed,
        undetermined: all.undetermined_count(),
        asked: asked(prepared, &found),
    };
    Ok((counted, reach))
}

/// Questions in the author's words.
fn asked(prepared: &Prepared, found: &Edges) -> Vec<Asked> {
    let (program, executable) = (&prepared.program, prepared.oracle.executable());
    let file = &program.file;
    let mut all: Vec<(Option<base::text::Span>, Question, u16)> = Vec::new();
    for reached in &found.reached {
        let span = author_span(program, &executable.place(reached.site));
        // A function that is called in two places is one text.
        match all.iter_mut().find(|(at, question, _)| (*at, *question) == (span, reached.question)) {
            Some((_, _, met)) => *met |= reached.met,
            None => all.push((span, reached.question, reached.met)),
        }
    }
    all.sort_by_key(|(span, question, _)| (span.map(|span| (span.start, span.end)), *question));
    let reported = all.into_iter().map(|(span, question, met)| {
        let classes = question.classes().iter().enumerate();
        let (met, missed): (Vec<_>, Vec<_>) = classes.partition(|(k, _)| met >> k & 1 == 1);
        let names = |list: Vec<(usize, &&str)>| list.into_iter().map(|(_, name)| (*name).to_owned()).collect();
        Asked {
            at: span.map(|span| file.location(span.start)),
            text: span.map_or_else(String::new, |span| file.slice(span).to_owned()),
            expansion: span.and_then(|span| file.expansion(span)).map(|expansion| expansion.name.to_string()),
            comparison: question.is_comparison(),
            operation: question.name(),
            met: names(met),
            missed: names(missed),
        }
    });
    reported.collect()
}
