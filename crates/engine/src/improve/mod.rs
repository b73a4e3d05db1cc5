//! Better formulas for the expressions of a shader: found by rules, proved, measured, and written as edits.
//!
//! ```text
//! function ─ lower ─▶ terms and leaves ─┐
//! domain ─ samples ─▶ points ───────────┴─ search ─▶ candidates ─ proof ─▶ text ─ compare ─▶ proposals
//! ```

mod lower;
mod plot;
mod points;

use std::time::Duration;

use crate::compare::{self, Compared};
use crate::fuzz::{Domain, Subject, stream_key, subjects};
use ::improve::{Candidate, Dialect, Improved, Losses, Points, Proof, Settings, Term, prove, search, written};
use base::text::{Edit, EditList, SourceFile, Span};
use judge::profile::Profile;
use lanes::Lane;
use points::Drawer;
use syntax::real::Reals;
use syntax::{Parsed, Shader};

pub use lower::{Leaf, Place, places};
pub use plot::Plot;
pub use points::InputRange;

/// Points of the search.
const SEARCHED: usize = 512;

/// Points that no search has seen, from which figures come.
const MEASURED: usize = 1 << 12;

/// Proposals of an expression.
const PROPOSALS: usize = 3;

/// Samples for which the judge derives bounds and lanes run, of those of the proof.
const JUDGED: u64 = 1 << 14;

/// An expression that loses fewer bits than that, in the mean and at worst, is left alone unless it is asked for.
const GOOD: [f64; 2] = [0.75, 3.0];

/// What an improvement is asked for.
pub struct Request<'p> {
    /// Points of the proof.
    pub samples: u64,
    /// Seed of the inputs.
    pub seed: u64,
    /// What bounds are derived from.
    pub profile: &'p Profile,
    /// Only expressions at this line of the author's file.
    pub line: Option<usize>,
    /// Nodes of the graph and the time that its saturation may take.
    pub nodes: usize,
    /// Seconds for the saturation of the graph of one expression.
    pub time: Duration,
    /// The command line up to the function, for reproduction.
    pub command: String,
}

/// Bits that are lost over the points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lost {
    /// In the mean.
    pub mean: f64,
    /// At worst.
    pub worst: f64,
}

impl Lost {
    fn of(losses: &Losses) -> Self {
        Self { mean: losses.mean(), worst: losses.worst() }
    }
}

/// What came of one expression.
#[derive(Clone, Debug)]
pub struct Report {
    /// The function around it.
    pub function: String,
    /// `name:line:column`.
    pub at: String,
    /// Its text.
    pub text: String,
    /// Its inputs with their ranges.
    pub inputs: Vec<InputRange>,
    /// Local variables that were written out.
    pub inlined: Vec<String>,
    /// What it loses.
    pub lost: Lost,
    /// What it costs, in additions.
    pub operations: f64,
    /// Points of the search at which it has a value, and those at which it has none.
    pub points: (usize, usize),
    /// The inputs of a point at which it has none.
    pub pole: Option<Vec<(String, f32)>>,
    /// Proposals, the best first.
    pub proposals: Vec<Proposal>,
    /// Candidates that were not proposed, with the reason.
    pub refused: Vec<(String, String)>,
    /// Why nothing was looked for.
    pub failed: Option<String>,
}

/// A share of points, one of them by names and values of its inputs, and bits lost there by the original and by another one.
pub type Worse = (f64, Vec<(String, f32)>, [f64; 2]);

/// Another formula.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// Its text.
    pub text: String,
    /// The edit of the author's file.
    pub edit: Edit,
    /// The author's file with it.
    pub after: String,
    /// What it loses.
    pub lost: Lost,
    /// What it costs, in additions.
    pub operations: f64,
    /// Share of the points at which it loses more than half a bit more than the original, and the one where it is most: its
    /// inputs and both losses.
    pub worse: Option<Worse>,
    /// How it was proved.
    pub proof: Proof,
    /// Both functions beside each other, by the judge and on lanes.
    pub compared: Compared,
    /// Bits lost over the input that matters most.
    pub plot: Plot,
}

/// Looks for better formulas in one function of a shader, whose parse is `parsed` and whose author's file is `file`.
/// `again` parses a changed file in the way of the first.
///
/// # Errors
/// Where a stated range has no end.
pub fn run(
    (parsed, file, subject): (&Parsed, &SourceFile, &Subject),
    domain: &Domain,
    lanes: &[&dyn Lane],
    request: &Request<'_>,
    again: &dyn Fn(&SourceFile) -> Parsed,
) -> Result<Vec<Report>, String> {
    let shader = &parsed.shader;
    let reals = Reals::new(shader, &|_, value| value);
    let Ok(ready) = &subject.ready else { return Ok(Vec::new()) };
    let info =
        shader.functions().map(|(_, info)| info).find(|info| shader.file().locate(info.name.span.start) == subject.at);
    let Some(function) = info.and_then(|info| shader.function_syntax(info)) else { return Ok(Vec::new()) };
    let mut reports = Vec::new();
    for place in places(shader, function, &reals) {
        let Some(span) = own_span(shader, file, place.span) else { continue };
        let lines = file.position(span.start).line..=file.position(span.end).line;
        if request.line.is_some_and(|line| !lines.contains(&line)) {
            continue;
        }
        let drawer = Drawer::new(ready, domain, stream_key(request.seed, &subject.label), &place.leaves)?;
        let one = One { subject, domain, file, span, place: &place, drawer, request, again, lanes, shader };
        if let Some(report) = one.report() {
            reports.push(report);
        }
    }
    Ok(reports)
}

/// The bytes of the author's file that a place of the parsed text is; none in an included file.
pub(crate) fn own_span(shader: &Shader, file: &SourceFile, span: Span) -> Option<Span> {
    if shader.file().text() == file.text() {
        return Some(span);
    }
    let (origin, found) = shader.file().copied(span)?;
    (origin.name() == file.name() && file.text().get(found.range()) == Some(shader.file().slice(span))).then_some(found)
}

/// One expression under way.
struct One<'a> {
    subject: &'a Subject,
    domain: &'a Domain,
    file: &'a SourceFile,
    span: Span,
    place: &'a Place,
    drawer: Drawer<'a>,
    request: &'a Request<'a>,
    again: &'a dyn Fn(&SourceFile) -> Parsed,
    lanes: &'a [&'a dyn Lane],
    shader: &'a Shader,
}

impl One<'_> {
    fn report(&self) -> Option<Report> {
        let searched = self.drawer.draw(0, SEARCHED);
        let mut report = Report {
            function: self.subject.label.clone(),
            at: self.file.locate(self.span.start),
            text: self.file.slice(self.span).to_owned(),
            inputs: self.drawer.inputs(&self.place.leaves, &searched),
            inlined: self.place.inlined.clone(),
            lost: Lost::default(),
            operations: 0.0,
            points: (0, 0),
            pole: None,
            proposals: Vec::new(),
            refused: Vec::new(),
            failed: None,
        };
        let points = Points::new(&searched);
        let asked = self.request.line.is_some();
        let exact = ::improve::reference(&self.place.term, &points).ok()?;
        let losses = Losses::of(&::improve::run(&::improve::folded(&self.place.term), &points), &exact);
        let known =
            Losses(losses.0.iter().zip(&exact).filter(|(_, exact)| exact.is_finite()).map(|(lost, _)| *lost).collect());
        report.lost = Lost::of(&known);
        if !asked && (known.mean() < GOOD[0] || known.worst() < GOOD[1]) {
            return None;
        }
        let settings = Settings {
            nodes: self.request.nodes,
            time: self.request.time,
            hyperbolic: has_hyperbolic(self.shader),
            ..Settings::default()
        };
        match search(&self.place.term, &points, &settings) {
            Ok(found) => {
                let poles = exact.iter().position(|exact| !exact.is_finite());
                report.pole = poles.map(|k| self.named(&points.point(k)));
                self.proposed(&found, &mut report);
            }
            Err(why) => report.failed = Some(why),
        }
        Some(report)
    }

    fn named(&self, point: &[f32]) -> Vec<(String, f32)> {
        self.place.leaves.iter().map(|leaf| leaf.text.clone()).zip(point.iter().copied()).collect()
    }

    fn proposed(&self, found: &Improved, report: &mut Report) {
        let own = &self.place.term;
        let fresh = Points::new(&self.drawer.draw(1 << 20, MEASURED));
        let Ok(exact) = ::improve::reference(own, &fresh) else { return };
        let fits: Vec<usize> = (0..exact.len()).filter(|k| exact[*k].abs() <= f64::from(f32::MAX)).collect();
        let fresh = fresh.chosen(&fits);
        let exact: Vec<f64> = fits.iter().map(|k| exact[*k]).collect();
        let losses = |term: &Term| Losses::of(&::improve::run(&::improve::folded(term), &fresh), &exact);
        let original = losses(own);
        report.lost = Lost::of(&original);
        report.operations = found.operations;
        report.points = (found.points.len(), found.without_value);
        for candidate in &found.candidates {
            if report.proposals.len() == PROPOSALS {
                break;
            }
            let columns: Vec<(usize, Losses)> =
                candidate.split.terms().into_iter().map(|term| (term, losses(&found.terms[term]))).collect();
            let of = |k: usize| {
                let chosen = candidate.split.chosen(&fresh, k);
                columns.iter().find(|(term, _)| *term == chosen).map_or(::improve::WORST, |(_, losses)| losses.0[k])
            };
            let new = Losses((0..fresh.len()).map(of).collect());
            let text = self.written(candidate, &found.terms);
            match self.proposal(candidate, found, (&original, &new), &fresh, text.clone()) {
                Ok(proposal) => report.proposals.push(proposal),
                Err(why) => report.refused.push((text, why)),
            }
        }
    }

    fn written(&self, candidate: &Candidate, terms: &[Term]) -> String {
        let leaves: Vec<String> = self.place.leaves.iter().map(|leaf| leaf.text.clone()).collect();
        written(&candidate.split, terms, &leaves, Dialect::Glsl)
    }

    fn proposal(
        &self,
        candidate: &Candidate,
        found: &Improved,
        (original, new): (&Losses, &Losses),
        fresh: &Points,
        text: String,
    ) -> Result<Proposal, String> {
        let (before, after) = (Lost::of(original), Lost::of(new));
        // Figures are those of points that the search has not seen.
        if after.mean >= before.mean || after.worst > before.worst + 1.0 {
            return Err(format!(
                "on other samples it loses {:.1} bits in the mean and {:.1} at worst, where the text loses {:.1} and {:.1}",
                after.mean, after.worst, before.mean, before.worst
            ));
        }
        let mut points = self.drawer.special();
        points.extend(self.drawer.draw(1 << 30, self.request.samples as usize));
        let proof = prove(&self.place.term, &candidate.split, &found.terms, &Points::new(&points))?;
        if !proof.holds() {
            let place = |point: &[f32]| {
                let values = self.named(point);
                values.iter().map(|(name, x)| format!("{name} = {x:?}")).collect::<Vec<_>>().join(", ")
            };
            return Err(match (&proof.unequal, &proof.lost_at) {
                (Some((point, part)), _) => {
                    format!("in real numbers it is something else: at {} by {part:.1e} of its size", place(point))
                }
                (None, Some(point)) => format!("it has no value at {}, where the text has one", place(point)),
                (None, None) => "it is not proved".to_owned(),
            });
        }
        let needs = self.place.is_operand && text.contains([' ', '?']);
        let replacement = if needs { format!("({text})") } else { text.clone() };
        let edit = Edit::replace(self.span, replacement);
        let mut edits = EditList::new();
        edits.push(edit.clone());
        let changed = edits.apply(self.file.text()).map_err(|error| error.to_string())?;
        let changed = SourceFile::new(self.file.name(), changed.text.as_str());
        let compared = self.judged(&changed)?;
        let worse =
            worse(original, new).map(|(share, k)| (share, self.named(&fresh.point(k)), [original.0[k], new.0[k]]));
        let names: Vec<&str> = self.place.leaves.iter().map(|leaf| leaf.text.as_str()).collect();
        Ok(Proposal {
            text,
            edit,
            after: changed.text().to_owned(),
            lost: after,
            operations: candidate.operations,
            worse,
            proof,
            compared,
            plot: Plot::new(fresh, &names, [original, new]),
        })
    }

    /// Both functions beside each other, where they are more than the expression.
    fn judged(&self, changed: &SourceFile) -> Result<Compared, String> {
        let parsed = (self.again)(changed);
        let label = &self.subject.label;
        let all =
            subjects(&parsed.shader, &|name| name == label || name == self.subject.name).map_err(|bad| bad.why)?;
        let second = all.iter().find(|one| one.label == *label).ok_or("the changed text does not compile")?;
        let request = compare::Request {
            samples: self.request.samples.min(JUDGED),
            seed: self.request.seed,
            case: None,
            profiles: vec![self.request.profile],
            command: self.request.command.clone(),
            curves: false,
        };
        let compared = compare::run([self.subject, second], self.domain, self.lanes, &request)?;
        if let Some(why) = &compared.not_compared {
            return Err(why.clone());
        }
        let values = compared.smallest.as_ref().and_then(|unlike| unlike.values);
        if compared.unlike.1 > 0 && values.is_none_or(|[old, _]| !old.is_nan()) {
            let what = compared.smallest.as_ref().map_or_else(String::new, |unlike| format!(": {}", unlike.message));
            return Err(format!("the judge finds that the function means something else{what}"));
        }
        Ok(compared)
    }
}

/// The share of points at which the second loses clearly more, and the one where it is most.
fn worse(original: &Losses, new: &Losses) -> Option<(f64, usize)> {
    let more = |k: &usize| new.0[*k] - original.0[*k];
    let all: Vec<usize> = (0..original.0.len()).filter(|k| more(k) > 0.5).collect();
    let most = all.iter().copied().max_by(|a, b| more(a).total_cmp(&more(b)))?;
    Some((all.len() as f64 / original.0.len().max(1) as f64, most))
}

/// Hyperbolic functions came with GLSL 1.30 and ES 3.00.
fn has_hyperbolic(shader: &Shader) -> bool {
    let version = shader.version();
    version.number >= 130
}
