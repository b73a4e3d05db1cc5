//! Better formulas for the expressions of a shader: found by rules, proved, measured, and written as edits.
//!
//! ```text
//! function ─ lower ─▶ terms and leaves ─┐
//! domain ─ samples ─▶ points ───────────┴─ search ─▶ candidates ─ proof ─▶ text ─ compare ─▶ proposals
//! ```

mod algebra;
mod devices;
mod halves;
mod lower;
mod places;
mod plot;
mod points;
mod vectors;

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::compare::{self, Compared};
use crate::fuzz::{Domain, Look, Ready, Subject, Trouble, scan, stream_key};
use ::improve::{
    Candidate, Dialect, Improved, LeafText, Losses, Points, Proof, Settings, Term, measure, prove, search, written,
};
use base::text::{Edit, EditList, SourceFile, Span};
use base::value::Batch;
use devices::Devices;
use judge::profile::Profile;
use lanes::Lane;
use places::{Place, places};
use points::Drawer;
use syntax::Shader;
use syntax::real::Reals;

pub use devices::{OnDevice, Source, shipped};
pub use halves::halves;
pub use lower::Leaf;
pub use plot::Plot;
pub use points::InputRange;

/// Points of the search.
const SEARCHED: usize = 512;

/// Points that no search has seen, from which figures come.
const MEASURED: usize = 1 << 12;

/// Nodes of the graph of an expression, where none are asked for.
pub const NODES: usize = 6000;

/// Proposals of an expression.
const PROPOSALS: usize = 3;

/// Bits in the mean that a function has from another formula about vectors, at the least.
const LEAST_GAIN: f64 = 0.25;

/// Characters of a formula beyond which nobody reads it.
const LONGEST: usize = 240;

/// Samples for which the judge derives bounds and lanes run, of those of the proof.
const JUDGED: u64 = 1 << 14;

/// An expression that loses fewer bits than that, in the mean and at worst, is left alone unless it is asked for.
const GOOD: [f64; 2] = [0.75, 3.0];

/// Points at which bounds of devices are derived, and lanes run an expression.
const ON_DEVICES: usize = 1 << 9;

/// A gain of fewer bits in the mean than that is not worth operations of so many times the cost.
const SMALL_GAIN: f64 = 0.5;
const DEAR: f64 = 1.5;

/// Of so many steps to a neighbouring input, one may go the wrong way more.
const REVERSED: u64 = 256;

/// What an improvement is asked for.
pub struct Request<'p> {
    /// Points of the proof.
    pub samples: u64,
    /// Seed of the inputs.
    pub seed: u64,
    /// What bounds of the whole function are derived from.
    pub profile: &'p Profile,
    /// What a proposal must not be worse by.
    pub devices: &'p [&'p Profile],
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lost {
    /// In the mean.
    #[serde(with = "crate::bits")]
    pub mean: f64,
    /// At the worst point.
    #[serde(with = "crate::bits")]
    pub worst: f64,
}

impl Lost {
    fn of(losses: &Losses) -> Self {
        Self { mean: losses.mean(), worst: losses.worst() }
    }
}

/// What came of one expression.
#[derive(Clone, Debug, Serialize, Deserialize)]
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
    #[serde(with = "crate::bits")]
    pub operations: f64,
    /// Points of the search at which it has a value, and those at which it has none.
    pub points: (usize, usize),
    /// The inputs of a point at which it has none.
    #[serde(with = "crate::bits")]
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

/// A formula that is proved to equal the expression, and loses fewer bits.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Proposal {
    /// Its text.
    pub text: String,
    /// The edit of the author's file; it stays where it was made.
    #[serde(skip, default = "no_edit")]
    pub edit: Edit,
    /// The author's file with it.
    pub after: String,
    /// What it loses.
    pub lost: Lost,
    /// What the text and it lose on devices.
    pub devices: Vec<OnDevice>,
    /// What it costs, in additions.
    #[serde(with = "crate::bits")]
    pub operations: f64,
    /// Share of the points at which it loses more than half a bit more than the original, and the one where it is most: its
    /// inputs and both losses.
    #[serde(with = "crate::bits")]
    pub worse: Option<Worse>,
    /// How it was proved.
    #[serde(with = "crate::bits")]
    pub proof: Proof,
    /// Both functions beside each other, by the judge and on lanes.
    pub compared: Compared,
    /// Bits lost over the input that matters most.
    pub plot: Plot,
}

fn no_edit() -> Edit {
    Edit::replace(Span::new(0, 0), "")
}

/// Why nothing is looked for in a function of these [halves].
pub const OF_HALVES: &str = "it has numbers of `f16`, and what formulas lose is measured in binary32";

/// Looks for better formulas in one function of a shader, whose author's file is `file`. `again` reads a changed file in
/// the way of the first and gives its functions of that label.
///
/// # Errors
/// Where a stated range has no end.
pub fn run(
    (shader, file, subject): (&Shader, &SourceFile, &Subject),
    domain: &Domain,
    lanes: &[&dyn Lane],
    request: &Request<'_>,
    again: Again<'_>,
) -> Result<Vec<Report>, String> {
    let reals = Reals::new(shader, &|_, value| value);
    let Ok(ready) = &subject.ready else { return Ok(Vec::new()) };
    let info =
        shader.functions().map(|(_, info)| info).find(|info| shader.file().locate(info.name.span.start) == subject.at);
    let Some(function) = info.and_then(|info| shader.function_syntax(info)) else { return Ok(Vec::new()) };
    let mut reports = Vec::new();
    let mut taken: Vec<Span> = Vec::new();
    let mut without: Vec<(Span, Vec<(String, String)>)> = Vec::new();
    let is_unit = |text: &str| points::is_unit(ready, domain, text);
    let [known, searched] = places(shader, function, &reals, &is_unit);
    for place in known.into_iter().chain(searched) {
        let Some(span) = own_span(shader, file, place.span) else { continue };
        let lines = file.position(span.start).line..=file.position(span.end).line;
        let apart = |other: &Span| other.end <= span.start || span.end <= other.start;
        if request.line.is_some_and(|line| !lines.contains(&line)) || !taken.iter().all(apart) {
            continue;
        }
        let drawer = Drawer::new(ready, domain, stream_key(request.seed, &subject.label), &place.leaves)?;
        let one = One { subject, domain, file, span, place: &place, drawer, request, again, lanes, shader };
        let Some(mut report) = one.report() else { continue };
        if !report.proposals.is_empty() {
            taken.push(span);
        } else if place.known.is_some() {
            // What is known by heart is no better: it is searched for, and the reason told there.
            without.push((span, report.refused));
            continue;
        }
        let inside = without.iter().filter(|(known, _)| span.start <= known.start && known.end <= span.end);
        report.refused.extend(inside.flat_map(|(_, refused)| refused.clone()));
        reports.push(report);
    }
    Ok(reports)
}

/// How a changed file is read.
pub type Again<'a> = &'a dyn Fn(&SourceFile) -> Result<Vec<Subject>, String>;

/// The bytes of the author's file that a place of the parsed text is; none in an included file.
pub fn own_span(shader: &Shader, file: &SourceFile, span: Span) -> Option<Span> {
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
    again: Again<'a>,
    lanes: &'a [&'a dyn Lane],
    shader: &'a Shader,
}

/// A candidate with what it and the text lose at points that the search has not seen.
struct Measured<'a> {
    candidate: &'a Candidate,
    found: &'a Improved,
    losses: [&'a Losses; 2],
    points: &'a Points,
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
        let exact = ::improve::reference(self.meant(), &points).ok()?;
        let losses = Losses::of(&::improve::run(&::improve::folded(&self.place.term), &points), &exact);
        let known =
            Losses(losses.0.iter().zip(&exact).filter(|(_, exact)| exact.is_finite()).map(|(lost, _)| *lost).collect());
        report.lost = Lost::of(&known);
        // A formula about vectors that goes wrong seldom goes wrong badly.
        let good = known.worst() < GOOD[1] || (known.mean() < GOOD[0] && self.place.known.is_none());
        if good && !asked {
            return None;
        }
        let settings = Settings {
            nodes: self.request.nodes,
            time: self.request.time,
            hyperbolic: has_hyperbolic(self.shader)
                && self.request.devices.iter().all(|one| devices::has_hyperbolic(one)),
            ..Settings::default()
        };
        let found = match &self.place.known {
            Some(known) => measure(&self.place.term, &known.meant, &known.others, &points),
            None => search(&self.place.term, &points, &settings),
        };
        match found {
            Ok(found) => {
                let poles = exact.iter().position(|exact| !exact.is_finite());
                report.pole = poles.map(|k| self.named(&points.point(k)));
                self.proposed(&found, &mut report);
            }
            Err(why) => report.failed = Some(why),
        }
        Some(report)
    }

    /// What the expression means in real numbers.
    fn meant(&self) -> &Term {
        self.place.known.as_ref().map_or(&self.place.term, |known| &known.meant)
    }

    fn named(&self, point: &[f32]) -> Vec<(String, f32)> {
        self.place.leaves.iter().map(|leaf| leaf.text.clone()).zip(point.iter().copied()).collect()
    }

    fn proposed(&self, found: &Improved, report: &mut Report) {
        let own = &self.place.term;
        let fresh = Points::new(&self.drawer.draw(1 << 20, MEASURED));
        let Ok(exact) = ::improve::reference(self.meant(), &fresh) else { return };
        let fits: Vec<usize> = (0..exact.len()).filter(|k| exact[*k].abs() <= f64::from(f32::MAX)).collect();
        let fresh = fresh.chosen(&fits);
        let exact: Vec<f64> = fits.iter().map(|k| exact[*k]).collect();
        let losses = |term: &Term| Losses::of(&::improve::run(&::improve::folded(term), &fresh), &exact);
        let original = losses(own);
        report.lost = Lost::of(&original);
        let some: Vec<usize> = (0..fresh.len().min(ON_DEVICES)).collect();
        let (few, few_exact) = (fresh.chosen(&some), &exact[..some.len()]);
        let devices = match found.candidates.is_empty() {
            false => Devices::new(own, (&few, few_exact), self.request.devices, self.lanes),
            true => Err("there is none".to_owned()),
        };
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
            let measured = Measured { candidate, found, losses: [&original, &new], points: &fresh };
            match self.proposal(&measured, &devices, text.clone()) {
                Ok(proposal) => report.proposals.push(proposal),
                Err(why) => report.refused.push((text, why)),
            }
        }
    }

    fn written(&self, candidate: &Candidate, terms: &[Term]) -> String {
        let leaf = |leaf: &Leaf| LeafText { text: leaf.text.clone(), of: leaf.of.clone() };
        let leaves: Vec<LeafText> = self.place.leaves.iter().map(leaf).collect();
        let dialect = if self.shader.wgsl().is_some() { Dialect::Wgsl } else { Dialect::Glsl };
        written(&candidate.split, terms, &leaves, dialect)
    }

    fn proposal(
        &self,
        measured: &Measured<'_>,
        devices: &Result<Devices<'_>, String>,
        text: String,
    ) -> Result<Proposal, String> {
        let Measured { candidate, found, losses: [original, new], points: fresh } = *measured;
        let (before, after) = (Lost::of(original), Lost::of(new));
        if text.len() > LONGEST {
            return Err(format!("it has {} characters, too many to read", text.len()));
        }
        // Figures are those of points that the search has not seen.
        if after.mean >= before.mean || after.worst > before.worst + 1.0 {
            return Err(format!(
                "on other samples it loses {:.1} bits in the mean and {:.1} at worst, where the text loses {:.1} and {:.1}",
                after.mean, after.worst, before.mean, before.worst
            ));
        }
        let gain = before.mean - after.mean;
        if gain < SMALL_GAIN && candidate.operations > DEAR * found.operations {
            return Err(format!(
                "it gains {gain:.1} bits in the mean, and costs {:.0} instead of {:.0}",
                candidate.operations, found.operations
            ));
        }
        let on_devices = devices.as_ref().map_err(Clone::clone)?.beside(&candidate.split, &found.terms)?;
        if let Some(worst) = on_devices.iter().filter(|one| one.is_worse()).max_by(|a, b| a.more().total_cmp(&b.more()))
        {
            return Err(format!("{} it loses {}", worst.shown(), worst.beside()));
        }
        let mut points = self.drawer.special();
        points.extend(self.drawer.draw(1 << 30, self.request.samples as usize));
        let proof = prove(self.meant(), &candidate.split, &found.terms, &Points::new(&points))?;
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
        not_worth(gain, &compared)?;
        keeps_order(&compared)?;
        let worse =
            worse(original, new).map(|(share, k)| (share, self.named(&fresh.point(k)), [original.0[k], new.0[k]]));
        let names: Vec<&str> = self.place.leaves.iter().map(|leaf| leaf.text.as_str()).collect();
        Ok(Proposal {
            text,
            edit,
            after: changed.text().to_owned(),
            lost: after,
            devices: on_devices,
            operations: candidate.operations,
            worse,
            proof,
            compared,
            plot: Plot::new(fresh, &names, [original, new]),
        })
    }

    /// What goes into a formula about vectors may be off by more than it loses itself: then the function has nothing from
    /// another one.
    fn gains(&self, second: &Subject) -> Result<(), String> {
        let (Ok(own), Ok(new), Some(_)) = (&self.subject.ready, &second.ready, &self.place.known) else {
            return Ok(());
        };
        let batch = self.drawer.batch(1 << 21, MEASURED);
        let (before, after) = (lost_by(own, &batch), lost_by(new, &batch));
        if after + LEAST_GAIN < before {
            return Ok(());
        }
        Err(format!(
            "the function loses {before:.1} bits in the mean, and {after:.1} with it: what goes into it is off by more"
        ))
    }

    /// Both functions beside each other, where they are more than the expression.
    fn judged(&self, changed: &SourceFile) -> Result<Compared, String> {
        let all = (self.again)(changed)?;
        let label = &self.subject.label;
        let second = all.iter().find(|one| one.label == *label).ok_or("the changed text does not compile")?;
        let request = compare::Request {
            samples: self.request.samples.min(JUDGED),
            seed: self.request.seed,
            case: None,
            profiles: vec![self.request.profile],
            command: self.request.command.clone(),
            curves: false,
            same_bits: false,
        };
        self.gains(second)?;
        let compared = compare::run([self.subject, second], self.domain, self.lanes, &request)?;
        if let Some(why) = &compared.not_compared {
            return Err(why.clone());
        }
        // A vector of length 1 is off by its rounding, and what that makes of a function is no other meaning.
        let of_units = self.place.known.as_ref().is_some_and(|known| known.meant != self.place.term);
        let values = compared.smallest.as_ref().and_then(|unlike| unlike.values);
        if compared.unlike.1 > 0 && !of_units && values.is_none_or(|[old, _]| !old.is_nan()) {
            let what = compared.smallest.as_ref().map_or_else(String::new, |unlike| format!(": {}", unlike.message));
            return Err(format!("the judge finds that the function means something else{what}"));
        }
        Ok(compared)
    }
}

/// A gain of less than a bit is none where a device may be off by more.
fn not_worth(gain: f64, compared: &Compared) -> Result<(), String> {
    let Some(bounds) = compared.accuracy.first().filter(|_| gain < 1.0) else { return Ok(()) };
    let (tighter, wider) = (bounds.better[1] + bounds.alone[1], bounds.better[0] + bounds.alone[0]);
    let ratio = bounds.median_ratio.map_or(1.0, |ratio| 1.0 / ratio);
    if ratio < 1.1 || wider < 4 * tighter {
        return Ok(());
    }
    Err(format!("it gains {gain:.1} bits in the mean, and the bound of a device is {ratio:.2} times as wide"))
}

/// A function that rises or falls everywhere is to do so in steps too.
fn keeps_order(compared: &Compared) -> Result<(), String> {
    let Some([before, after]) = &compared.resolution else { return Ok(()) };
    if after.reversed <= before.reversed || after.reversed < after.inputs / REVERSED {
        return Ok(());
    }
    Err(format!(
        "{} of {} steps to a neighbouring input go the wrong way, instead of {}",
        after.reversed, after.inputs, before.reversed
    ))
}

/// Bits that a function loses in strict binary32, in the mean of some samples.
fn lost_by(ready: &Ready, batch: &Batch) -> f64 {
    let looks = scan(&ready.executable, &ready.kernel.output.vertex, batch);
    let bits = |look: &Look| match look.trouble {
        None | Some(Trouble::Moved) => (1.0 + look.error * f64::from(1 << 24)).log2().min(::improve::WORST),
        Some(_) => ::improve::WORST,
    };
    looks.iter().map(bits).sum::<f64>() / looks.len().max(1) as f64
}

/// The share of points at which the second loses clearly more, and the one where it is most.
fn worse(original: &Losses, new: &Losses) -> Option<(f64, usize)> {
    let more = |k: &usize| new.0[*k] - original.0[*k];
    let all: Vec<usize> = (0..original.0.len()).filter(|k| more(k) > 0.5).collect();
    let most = all.iter().copied().max_by(|a, b| more(a).total_cmp(&more(b)))?;
    Some((all.len() as f64 / original.0.len().max(1) as f64, most))
}

/// Hyperbolic functions came with GLSL 1.30 and ES 3.00; WGSL has them.
fn has_hyperbolic(shader: &Shader) -> bool {
    shader.wgsl().is_some() || shader.version().number >= 130
}
