//! What one part of a run found, in a form that can be written down and joined with the other parts. A whole run
//! is the one part that covers everything: both are told by the same code.
//!
//! Counts and the first few failing samples decide what is reported. Joining them is commutative because ties are
//! broken by the number of the sample. Each part shrinks its own first failing samples, among which are the first few
//! of the run.

use serde::{Deserialize, Serialize};

use super::finding::{self, Finding};
use super::{
    Apart, Budget, Coverage, Doubtful, Prepared, Reach, Repeated, Report, Request, Translated, Way, doubts, repeat,
    survey,
};
use judge::verdict::{BatchVerdict, Deviation, Reason, Survey};
use lanes::{Actual, LaneName, Stage};
use program::InputSource;
use property::{Plan, Sample};

/// Failing samples that are shrunk; the rest is counted.
pub(super) const SHRUNK: usize = 8;

/// What one part of a run found of a suite on a stage of a lane.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Part {
    /// Name of the suite.
    pub suite: String,
    /// The shader, as it was named.
    pub shader: String,
    /// Name of the lane.
    #[serde(with = "lanes::known")]
    pub lane: LaneName,
    /// Stage of the lane.
    pub stage: Stage,
    /// Where inputs came from, when the run was asked for a source; such a run has no shards.
    #[serde(skip)]
    pub source: Option<InputSource>,
    /// How the outputs differ in bits from those of inputs in storage, for another source.
    #[serde(skip)]
    pub(super) apart: Option<Apart>,
    counted: Counted,
    unsupported: u64,
    #[serde(default)]
    unsupported_because: Option<String>,
    pub(super) replayed: u64,
    /// What is looked at once for a run, by its first part.
    pub(super) relations: Vec<(String, u64)>,
    pub(super) coverage: Option<Coverage>,
    #[serde(default)]
    pub(super) reach: Option<Reach>,
    pub(super) translations: Vec<Translated>,
    pub(super) repeated: Option<Repeated>,
    #[serde(default)]
    pub(super) budget: Option<Budget>,
    pub(super) findings: Vec<Finding>,
    /// Failing samples, shrunk.
    shown: Vec<Shown>,
    /// Samples that depend on undefined values, shrunk.
    #[serde(default)]
    undefined: Vec<Shown>,
    /// Literals that round a constant, to be told where samples are right with the constant alone.
    #[serde(default)]
    rounded: Vec<Finding>,
    /// Samples of relations that hold with these constants alone.
    #[serde(default)]
    pub(super) reread: u64,
    /// None where the lane cannot run the suite.
    terms: Option<Terms>,
    /// What is bound to samplers.
    textures: Vec<String>,
    /// Failing samples of `findings`, to be saved; they stay where they were found.
    #[serde(skip)]
    pub(super) failing: Vec<Sample>,
}

/// What the suite asks of a whole run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Terms {
    /// Samples that have to be judged.
    pub least: u64,
    /// Share of the samples that may be undetermined.
    #[serde(with = "base::value::exact")]
    pub undetermined: f64,
    /// Whether samples are generated at all.
    pub makes_samples: bool,
    /// Only samples that were given.
    pub replay_only: bool,
}

/// Verdicts, counted, with what is needed to tell them. Samples are numbered over the whole run, those that
/// were given first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Counted {
    pub(super) verdicts: BatchVerdict,
    /// By place, in the order of the first sample of each.
    pub(super) doubts: Vec<Doubted>,
    /// The first few failing samples.
    pub(super) failing: Vec<Failing>,
    /// The first few samples with an output that depends on an undefined value.
    #[serde(default)]
    pub(super) undefined: Vec<Failing>,
    /// The survey of the first samples of the run.
    pub(super) survey: Option<Survey>,
    /// Of large dispatches, the first that deviates, with its number.
    #[serde(default)]
    pub(super) deviation: Option<(u64, Deviation)>,
}

/// Undetermined samples, with the number of the first of them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Doubted {
    pub first: u64,
    pub doubtful: Doubtful,
}

/// A failing sample by its number and words.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Failing {
    pub number: u64,
    pub invocation: Vec<u32>,
    pub case: Vec<u32>,
    /// What it gave, see [`repeat::print`].
    pub print: u64,
    /// Its index in the batch in which it failed, with the invocations of the batch and those that share uniforms.
    #[serde(default)]
    pub at: usize,
    #[serde(default)]
    pub count: usize,
    #[serde(default)]
    pub per_case: usize,
}

/// A failing sample, shrunk.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Shown {
    /// Number of the sample that it was shrunk from.
    pub number: u64,
    /// Deviations that are alike are told once; none for what is told in any case.
    pub alike: Option<String>,
    /// Words of the shrunk sample.
    pub words: Vec<u32>,
    pub finding: Finding,
    #[serde(skip)]
    pub sample: Option<Sample>,
}

impl Failing {
    /// The sample, for a plan whose records it was made by.
    pub(super) fn sample(&self, plan: &Plan) -> Sample {
        Sample {
            invocation_record: plan.invocation_record().clone(),
            case_record: plan.case_record().clone(),
            invocation: self.invocation.clone(),
            case: self.case.clone(),
        }
    }
}

impl Counted {
    /// Adds the verdicts on a batch whose first sample has the number `first`.
    pub(super) fn add(
        &mut self,
        prepared: &Prepared,
        first: u64,
        (batch, actual): (&base::value::Batch, &Actual),
        mut verdict: BatchVerdict,
    ) {
        for doubts in std::mem::take(&mut verdict.doubts) {
            let first = first + doubts.first as u64;
            self.doubt(Doubted { first, doubtful: doubts::doubtful(prepared, &doubts) });
        }
        for failure in std::mem::take(&mut verdict.failures) {
            if self.failing.len() < SHRUNK {
                let Sample { invocation, case, .. } = Sample::of(batch, failure.invocation);
                let (number, print) = (first + failure.invocation as u64, repeat::print(actual, failure.invocation));
                let (at, count, per_case) = (failure.invocation, batch.invocation_count(), batch.per_case);
                self.failing.push(Failing { number, invocation, case, print, at, count, per_case });
            }
        }
        for invocation in std::mem::take(&mut verdict.undefined) {
            if self.undefined.len() < SHRUNK {
                let Sample { invocation: words, case, .. } = Sample::of(batch, invocation);
                let (number, at) = (first + invocation as u64, invocation);
                let (count, per_case) = (batch.invocation_count(), batch.per_case);
                self.undefined.push(Failing { number, invocation: words, case, print: 0, at, count, per_case });
            }
        }
        self.verdicts.merge(verdict);
        self.sort();
    }

    fn doubt(&mut self, new: Doubted) {
        let place = |d: &Doubtful| (d.reason, d.op, d.at.clone(), d.text.clone(), d.expansion.clone());
        match self.doubts.iter_mut().find(|old| place(&old.doubtful) == place(&new.doubtful)) {
            Some(old) => {
                old.doubtful.count += new.doubtful.count;
                if new.first < old.first {
                    (old.first, old.doubtful.args) = (new.first, new.doubtful.args);
                }
            }
            None => self.doubts.push(new),
        }
    }

    /// Adds what other samples gave, whichever come first.
    pub(super) fn join(&mut self, other: Self) {
        let Self { verdicts, doubts, failing, undefined, survey, deviation } = other;
        let first = self.deviation.take().into_iter().chain(deviation);
        self.deviation = first.min_by_key(|(number, _)| *number);
        self.undefined.extend(undefined);
        self.verdicts.merge(verdicts);
        doubts.into_iter().for_each(|doubts| self.doubt(doubts));
        self.failing.extend(failing);
        self.survey = self.survey.take().or(survey);
        self.sort();
    }

    fn sort(&mut self) {
        self.doubts.sort_by_key(|doubts| doubts.first);
        for failing in [&mut self.failing, &mut self.undefined] {
            failing.sort_by_key(|failing| failing.number);
            failing.truncate(SHRUNK);
        }
    }
}

impl Part {
    /// Samples that agree or deviate.
    pub fn judged(&self) -> u64 {
        self.counted.verdicts.agreed + self.counted.verdicts.deviated
    }

    /// A part that has found nothing yet.
    pub(super) fn new(prepared: &Prepared, lane: LaneName, (stage, source): Way, unsupported: u64) -> Self {
        Self {
            suite: prepared.suite.name.clone(),
            shader: prepared.shader.clone(),
            lane,
            stage,
            source,
            apart: None,
            counted: Counted::default(),
            unsupported,
            unsupported_because: None,
            replayed: 0,
            relations: Vec::new(),
            coverage: None,
            reach: None,
            translations: Vec::new(),
            repeated: None,
            budget: None,
            findings: Vec::new(),
            shown: Vec::new(),
            undefined: Vec::new(),
            rounded: Vec::new(),
            reread: 0,
            terms: None,
            textures: prepared.program.textures.iter().map(ToString::to_string).collect(),
            failing: Vec::new(),
        }
    }

    /// The lane and the way in which it was run.
    pub(super) fn on(&self) -> (LaneName, Way) {
        (self.lane, (self.stage, self.source))
    }

    /// Whether any sample was looked at.
    pub(super) fn has_seen(&self) -> bool {
        self.counted.verdicts.seen() > 0
    }

    /// Says why samples are not supported.
    pub(super) fn because(self, why: String) -> Self {
        Self { unsupported_because: Some(why), ..self }
    }

    /// The part once its samples are through: their verdicts, those that are shown with the literals that round
    /// constants, and what the suite asks of the whole run.
    pub(super) fn end(
        self,
        counted: Counted,
        (shown, rounded): ([Vec<Shown>; 2], Vec<Finding>),
        terms: Option<Terms>,
    ) -> Self {
        let [shown, undefined] = shown;
        Self { counted, shown, undefined, rounded, terms, ..self }
    }

    /// Compares the shader's translations as well, which is done once for a suite.
    pub fn check_translations(&mut self, prepared: &Prepared, request: &Request) {
        // A lane runs the author's module; the translations of a dispatch are compared at the sizes at which it is small.
        if !prepared.program.is_large() {
            super::check_translations(prepared, request, self);
        }
    }

    /// True for a part of the same suite on the same stage of the same lane.
    pub fn is_like(&self, other: &Self) -> bool {
        (&self.suite, &self.shader, self.lane, self.stage) == (&other.suite, &other.shader, other.lane, other.stage)
    }

    /// Adds another part. The result does not depend on the order in which parts are joined.
    pub fn join(&mut self, other: Self) {
        let Self { counted, unsupported, replayed, relations, coverage, translations, findings, budget, .. } = other;
        let Self { shown, undefined, terms, failing, repeated, unsupported_because, reach, rounded, reread, .. } =
            other;
        self.rounded.extend(rounded);
        self.reread += reread;
        // The least of the reasons, so that the order of parts makes no difference.
        let reasons = self.unsupported_because.take().into_iter().chain(unsupported_because);
        self.unsupported_because = reasons.min();
        self.counted.join(counted);
        self.unsupported += unsupported;
        self.replayed += replayed;
        self.relations.extend(relations);
        self.coverage = self.coverage.take().or(coverage);
        self.reach = self.reach.take().or(reach);
        self.translations.extend(translations);
        self.repeated = self.repeated.or(repeated);
        self.budget = self.budget.take().or(budget);
        self.findings.extend(findings);
        self.failing.extend(failing);
        self.shown.extend(shown);
        self.terms = self.terms.take().or(terms);
        // A whole run shrinks the first few failing samples, whatever came of them.
        self.undefined.extend(undefined);
        for (shown, failing) in
            [(&mut self.shown, &self.counted.failing), (&mut self.undefined, &self.counted.undefined)]
        {
            let last = failing.last().map_or(0, |failing| failing.number);
            shown.retain(|shown| shown.number <= last);
            shown.sort_by_key(|shown| shown.number);
        }
    }

    /// The failing samples that are shown, with what is known about them.
    pub(super) fn shown_mut(&mut self) -> impl Iterator<Item = &mut Finding> {
        self.shown.iter_mut().map(|shown| &mut shown.finding).chain(&mut self.findings)
    }

    /// What a run found whose parts are all joined.
    pub fn report(self) -> Report {
        let Self { counted, relations, coverage, translations, mut failing, .. } = self;
        let Counted { verdicts, doubts, survey, .. } = counted;
        let undefined = verdicts.undetermined[Reason::Undefined as usize];
        let all = [(self.shown, verdicts.deviated), (self.undefined, undefined)];
        let mut doubts: Vec<Doubtful> = doubts.into_iter().map(|doubts| doubts.doubtful).collect();
        doubts.sort_by_key(|doubtful| std::cmp::Reverse(doubtful.count));
        let mut findings = self.findings;
        let mut reported: Vec<(String, Vec<u32>)> = Vec::new();
        for (shown, count) in all {
            for Shown { alike, words, mut finding, sample, .. } in shown {
                if let Some(alike) = alike {
                    if reported.iter().any(|(known, same)| *known == alike || *same == words) {
                        continue;
                    }
                    reported.push((alike, words));
                    finding.count = count;
                    failing.extend(sample);
                }
                findings.push(finding);
            }
            // Another sample tells of another operation.
            reported.clear();
        }
        let mut report = Report {
            suite: self.suite,
            shader: self.shader,
            lane: self.lane,
            stage: self.stage,
            source: self.source,
            apart: self.apart,
            verdicts,
            unsupported: self.unsupported,
            unsupported_because: self.unsupported_because,
            replayed: self.replayed,
            doubts,
            textures: self.textures,
            relations,
            coverage,
            reach: self.reach,
            translations,
            repeated: self.repeated,
            budget: self.budget,
            survey,
            findings,
            known: Vec::new(),
            failing,
            reread: self.reread,
        };
        let reread = report.verdicts.reread + report.reread;
        if reread > 0 {
            report.findings.extend(self.rounded.into_iter().map(|one| Finding { count: reread, ..one }));
        }
        if let Some(terms) = &self.terms {
            finding::ranges(&mut report);
            finding::shortfalls(terms, &mut report);
            survey::warn(&mut report);
        }
        report.findings.sort_by_key(|f| f.kind);
        report
    }
}
