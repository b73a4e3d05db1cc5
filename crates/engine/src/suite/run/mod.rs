//! Running a suite on a lane: from a suite and a shader to counted verdicts and findings.

mod bundle;
mod coverage;
mod doubts;
mod edges;
mod finding;
mod gallery;
mod large;
mod part;
mod position;
mod prepare;
mod relate;
mod related;
mod repeat;
mod rounded;
mod sampling;
mod shader_test;
pub mod soundness;
mod sources;
mod summary;
mod survey;
mod translation;
mod trial;
mod undefined;
mod witness;

use std::ops::ControlFlow;

use crate::activity;
use crate::shard::Shard;
use crate::suite::Suite;
use base::text::printable;
use judge::profile::Promises;
use judge::verdict::{BatchVerdict, Survey};
use lanes::{Lane, LaneError, Stage, interrupt};
use program::{InputSource, Kernel};
use property::Sample;

use part::Counted;

pub use bundle::{Bundle, bundles};
pub use coverage::{Coverage, check as coverage};
pub use doubts::Doubtful;
pub use edges::{Asked, Reach, of as edges_of};
pub use finding::{Case, Finding, FindingKind};
pub use gallery::{Axis, Cell, Errors, Gallery, LARGEST, Promised, SMALLEST, Scene, State, Worst, gallery, promised};
pub use large::Budget;
pub use part::Part;
pub use prepare::{Prepared, RunError, of_module, prepare, prepare_with};
pub use relate::Probes;
pub use repeat::Repeated;
pub use sampling::Sampled;
pub use sources::{Apart, most as max_samples};
pub use summary::{
    Against, Entry, Expectation, Known, LaneUsed, Outcome, Standing, Status, Summary, Totals, settle, signal_name,
};
pub use translation::{Translated, check as check_translations, check_with as check_translations_with};
pub use trial::Trial;
pub use trial::stage_of;
pub use witness::{Peer, cross_check};

/// Seed of a run that names none: the same inputs on every machine.
pub const DEFAULT_SEED: u64 = 0x5eed;

/// Why a shader like `void main() { }` is not run.
const NO_OUTPUT: &str = "the shader writes no output";

/// What a run is asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// Samples to judge; `None` for what the suite says.
    pub samples: Option<u64>,
    /// Seed of the inputs.
    pub seed: u64,
    /// A short run: an eighth of the samples.
    pub quick: bool,
    /// Samples that failed before; they run first.
    pub replay: Vec<Sample>,
    /// Only the samples of `replay`.
    pub replay_only: bool,
    /// What the results are held against.
    pub promises: Promises,
    /// The arguments of `shadercheck check` that name the suite and the shader, for reproduction.
    pub arguments: String,
}

impl Request {
    /// Samples of this request for a suite.
    pub fn samples_of(&self, suite: &Suite) -> u64 {
        match self.samples {
            Some(samples) => samples,
            None if self.quick => (suite.samples / 8).max(1),
            None => suite.samples,
        }
    }
}

/// What came out of one suite on one stage of one lane.
#[derive(Clone, Debug)]
pub struct Report {
    /// Name of the suite.
    pub suite: String,
    /// The shader, as it was named.
    pub shader: String,
    /// Name of the lane.
    pub lane: &'static str,
    /// Stage of the lane.
    pub stage: Stage,
    /// Where inputs came from, when the run was asked for a source.
    pub source: Option<InputSource>,
    /// How the outputs differ in bits from those of inputs in storage, for another source.
    pub apart: Option<Apart>,
    /// Verdicts on the samples, replayed ones included.
    pub verdicts: BatchVerdict,
    /// Samples that this lane cannot run.
    pub unsupported: u64,
    /// Why, where that is known.
    pub unsupported_because: Option<String>,
    /// Saved samples that were run before the generated ones.
    pub replayed: u64,
    /// Undetermined samples by reason and place, the most frequent first.
    pub doubts: Vec<Doubtful>,
    /// What samplers were bound to, one line each.
    pub textures: Vec<String>,
    /// Relations: name, samples for which it was checked.
    pub relations: Vec<(String, u64)>,
    /// Which segments of strands are drawn, for a suite with strands.
    pub coverage: Option<Coverage>,
    /// What was reached of the questions that the shader asks; `None` where no samples were made.
    pub reach: Option<Reach>,
    /// What the shader's translations mean, on the first report of a suite; empty on the others.
    pub translations: Vec<Translated>,
    /// What came of running the first samples twice; `None` where that was not done.
    pub repeated: Option<Repeated>,
    /// How much of the suite a run does whose dispatches are large; `None` for others.
    pub budget: Option<Budget>,
    /// How tight the bounds are, for a run on generated samples.
    pub survey: Option<Survey>,
    /// What is wrong, worst first; warnings last.
    pub findings: Vec<Finding>,
    /// Findings that are expected: they do not make the run fail.
    pub known: Vec<Known>,
    /// Failing samples as shrunk, to be saved.
    pub failing: Vec<Sample>,
    /// Samples of relations that hold only where literals stand for the constants that they round.
    pub reread: u64,
}

impl Report {
    /// Samples that got a verdict: they agree or deviate.
    pub fn judged(&self) -> u64 {
        self.verdicts.agreed + self.verdicts.deviated
    }

    /// The findings that make a run fail.
    pub fn errors(&self) -> Vec<&Finding> {
        self.findings.iter().filter(|finding| !finding.kind.is_warning()).collect()
    }

    /// The other findings.
    pub fn warnings(&self) -> Vec<&Finding> {
        self.findings.iter().filter(|finding| finding.kind.is_warning()).collect()
    }
}

impl Report {
    /// A report of nothing.
    pub(super) fn empty(prepared: &Prepared, lane: &'static str, way: Way) -> Self {
        part::Part::new(prepared, lane, way, 0).report()
    }
}

/// A stage of a lane, and where inputs come from when the run is asked for a source.
pub type Way = (Stage, Option<InputSource>);

/// Which part of a run is done, from where, and who is told how far it is.
pub struct Share<'a> {
    /// The part.
    pub shard: Shard,
    /// How far this part was done before.
    pub resume: Option<Sampled>,
    /// Message after each batch; may stop the run.
    pub save: &'a mut dyn FnMut(&Sampled) -> ControlFlow<()>,
    /// True where what was judged until the run is interrupted is of use; a part that is handed over has to be whole.
    pub partial: bool,
}

/// Runs a prepared suite on one stage of a lane. `progress` is told the number of samples done.
///
/// # Errors
/// [`LaneError`] when the lane fails as such: it gives no verdict on anything then.
pub fn run(
    prepared: &Prepared,
    lane: &dyn Lane,
    stage: Stage,
    request: &Request,
    progress: &mut dyn FnMut(u64),
) -> Result<Report, LaneError> {
    whole(prepared, lane, (stage, None), request, progress)
}

/// Runs a prepared suite on a lane with inputs from a source. `progress` is told the number of samples
/// done. Inputs in storage, and the attributes of a vertex stage, are those of [`run`].
///
/// # Errors
/// [`LaneError`] when the lane fails as such: it gives no verdict on anything then.
pub fn run_from(
    prepared: &Prepared,
    lane: &dyn Lane,
    source: InputSource,
    request: &Request,
    progress: &mut dyn FnMut(u64),
) -> Result<Report, LaneError> {
    whole(prepared, lane, (stage_of(source), Some(source)), request, progress)
}

fn whole(
    prepared: &Prepared,
    lane: &dyn Lane,
    way: Way,
    request: &Request,
    progress: &mut dyn FnMut(u64),
) -> Result<Report, LaneError> {
    let mut save = |_: &Sampled| ControlFlow::Continue(());
    let share = Share { shard: Shard::WHOLE, resume: None, save: &mut save, partial: true };
    let part = run_part(prepared, lane, way, request, share, progress)?;
    Ok(part.map_or_else(|| Report::empty(prepared, lane.description().name, way), Part::report))
}

/// Runs one part of the samples of a suite. The first part also does what is done once for a run: samples that
/// failed before, relations, coverage. Gives nothing when `share.save` stopped it.
///
/// # Errors
/// [`LaneError`] when the lane fails as such: it gives no verdict on anything then.
pub fn run_part(
    prepared: &Prepared,
    lane: &dyn Lane,
    way: Way,
    request: &Request,
    share: Share<'_>,
    progress: &mut dyn FnMut(u64),
) -> Result<Option<Part>, LaneError> {
    let on = lane.description().name;
    let _doing = activity::doing(format!("runs the suite `{}` on {on}/{}", prepared.suite.name, way.0));
    match way.1 {
        Some(source) => sources::part(prepared, lane, source, request, share, progress),
        None => run_default(prepared, lane, way, request, share, progress),
    }
}

/// The usual run of a stage, also under the name of a source.
fn run_default(
    prepared: &Prepared,
    lane: &dyn Lane,
    (stage, source): Way,
    request: &Request,
    share: Share<'_>,
    progress: &mut dyn FnMut(u64),
) -> Result<Option<Part>, LaneError> {
    let name = lane.description().name;
    let once = share.shard.is_first();
    let makes_samples = prepared.plan.makes_samples();
    let wanted = if makes_samples { request.samples_of(&prepared.suite) } else { prepared.rows.len() as u64 };
    let unsupported = || Part::new(prepared, name, (stage, source), if once { wanted } else { 0 });
    let Some(kernel) = prepared.kernel(stage) else { return Ok(Some(unsupported())) };
    if kernel.output.is_empty() {
        return Ok(Some(unsupported().because(NO_OUTPUT.to_owned())));
    }
    let mut share = share;
    if prepared.program.is_large() {
        return match large::run(prepared, lane, (kernel, stage), wanted, request, &mut share, progress) {
            Err(LaneError::Unsupported(why)) => Ok(Some(unsupported().because(printable(&why)))),
            other => other,
        };
    }
    match on_kernel(prepared, lane, (kernel, stage, source), (wanted, once), request, share, progress) {
        // Some lanes see only what comes out whether they can run it.
        Err(LaneError::Unsupported(why)) => Ok(Some(unsupported().because(printable(&why)))),
        other => other,
    }
}

fn on_kernel(
    prepared: &Prepared,
    lane: &dyn Lane,
    (kernel, stage, source): (&Kernel, Stage, Option<InputSource>),
    (wanted, once): (u64, bool),
    request: &Request,
    mut share: Share<'_>,
    progress: &mut dyn FnMut(u64),
) -> Result<Option<Part>, LaneError> {
    let name = lane.description().name;
    let makes_samples = prepared.plan.makes_samples();
    let mut trial = trial::Trial::new(prepared, lane, kernel, &request.promises)?.in_stage(stage);
    let mut part = Part::new(prepared, name, (stage, source), 0);
    let mut counted = Counted::default();
    let given = request.replay.len() as u64;
    if once {
        part.replayed = given;
        counted = sampling::replay(&mut trial, &request.replay, 0)?;
    }
    if !request.replay_only {
        if once {
            counted.join(sampling::replay(&mut trial, &prepared.rows, given)?);
        }
        if makes_samples {
            let before = given + prepared.rows.len() as u64;
            let sampled = sampling::sample(&mut trial, request, (wanted, before), &mut share, progress)?;
            let Some(sampled) = sampled else { return Ok(None) };
            counted.join(sampled);
        }
        let whole = !(share.partial && interrupt::asked());
        if makes_samples && once && whole {
            // Behind all samples of the run, the last case of which may be longer than asked for.
            let first = given + prepared.rows.len() as u64 + wanted.next_multiple_of(1 << 20);
            let (deviations, reach) = edges::judge(&mut trial, request, (wanted, first))?;
            counted.join(deviations);
            part.reach = Some(reach);
        }
        if let Some(strands) = prepared.suite.strands.filter(|_| once && whole) {
            part.coverage = Some(coverage::check(&mut trial, strands, request.seed)?);
        }
    }
    if share.partial && interrupt::asked() {
        return Ok(Some(interrupted(&mut trial, lane, (part, counted), request)));
    }
    if once {
        let related = if request.quick { relate::QUICK_SAMPLES } else { relate::SAMPLES };
        relate::check(&mut trial, request, related, &mut part)?;
        repeat::check(&mut trial, request, &mut part)?;
    }
    let rounded = if once { rounded::look(&trial, request, &part)? } else { Vec::new() };
    let _doing = activity::doing("looks into what it found".to_owned());
    let shown = [
        finding::deviations(&mut trial, lane, &counted.failing, request, &part)?,
        undefined::findings((prepared, trial.fenced()), &counted.undefined, request, &part),
    ];
    let suite = &prepared.suite;
    let terms = part::Terms {
        least: suite.floors.judged_of(wanted.min(suite.samples), suite.samples),
        undetermined: suite.floors.undetermined,
        makes_samples,
        replay_only: request.replay_only,
    };
    Ok(Some(part.end(counted, (shown, rounded), Some(terms))))
}

/// What a run found until it was interrupted. Failing samples are reported as they are, and what a whole run has to
/// reach is not asked for.
fn interrupted(
    trial: &mut Trial<'_>,
    lane: &dyn Lane,
    (mut part, counted): (Part, Counted),
    request: &Request,
) -> Part {
    let request = Request { replay_only: true, ..request.clone() };
    let shown = finding::deviations(trial, lane, &counted.failing, &request, &part).unwrap_or_else(|_| {
        let deviated = counted.verdicts.deviated;
        let message = "samples deviate; the run was interrupted before they were looked into".to_owned();
        let kind = FindingKind::Deviation;
        part.findings.push(Finding { kind, message, case: None, count: deviated, reproduce: None });
        Vec::new()
    });
    let shown = [shown, undefined::findings((trial.prepared, trial.fenced()), &counted.undefined, &request, &part)];
    let terms = part::Terms { least: 0, undetermined: 1.0, makes_samples: false, replay_only: true };
    let terms = (counted.verdicts.agreed + counted.verdicts.deviated > 0).then_some(terms);
    part.end(counted, (shown, Vec::new()), terms)
}
