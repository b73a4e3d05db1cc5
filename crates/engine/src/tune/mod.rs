//! Which declarations of a shader may be `mediump`, and which must be `highp`.
//!
//! ```text
//! declarations ─ highp or mediump for each ─▶ text ─▶ program ─┬─ devices that err as far as they may ─┐
//! domain ─ samples ────────────────────────────────────────────┴─ binary32 ────────────────────────────┴▶ holds, or not
//! ```
//!
//! What is off on all samples in a proof joins those of the search, which goes on until the proof holds.

mod coordinates;
mod declarations;
mod kept;
mod search;
mod tolerance;
mod trial;

use std::convert::Infallible;

use serde::{Deserialize, Serialize};

use crate::InputValue;
use crate::adversary::Strategy;
use crate::fuzz::{Domain, Law, Ready, Shrinking, Subject, Within, decimal, drawn, place, scan, stream_key, subjects};
use base::text::SourceFile;
use base::value::Batch;
use judge::profile::by_name;
use judge::verdict::diagnosis::Place;
use lanes::interrupt;
use property::Sample;
use property::shrink::shrink;
use syntax::Parsed;
use syntax::precision::Precisions;

pub use declarations::{Declaration, wanted, word};
pub use tolerance::{Stated, Tolerance};

use coordinates::{REPEATS, TOLD_APART};
use declarations::Declarations;
use trial::{Devices, Off, Outcome};

/// Samples of the search, before what proofs find joins them.
const SEARCHED: usize = 768;
/// One sample of so many has times and places on the screen as far as they come in programs.
const FAR: usize = 4;
/// Times that a sample of a proof joins the search, before all do.
const ROUNDS: usize = 3;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// Samples of the proof.
    pub samples: u64,
    /// Seed of the inputs and of the devices.
    pub seed: u64,
    /// How far outputs may be off.
    pub stated: Stated,
    /// Width and height of the textures, in texels.
    pub texels: u32,
}

/// An input that shows why a declaration must be `highp`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Shown {
    /// The operation that loses digits or the range, in a sentence.
    pub message: String,
    /// Where digits or the range are lost first.
    pub place: Option<Place>,
    /// The smallest inputs that show it.
    pub inputs: Vec<InputValue>,
    /// The output.
    pub output: String,
    /// Its value in binary32, and on a device.
    #[serde(with = "crate::bits")]
    pub values: [f32; 2],
    /// The error in units of what is allowed.
    #[serde(with = "crate::bits")]
    pub ratio: f64,
}

/// One declaration.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    /// What it is.
    pub declaration: Declaration,
    /// True where it must be `highp`.
    pub high: bool,
    /// The largest error, in units of what is allowed, where it alone is `mediump`; infinite for a lost value.
    #[serde(with = "crate::bits")]
    pub alone: f64,
    /// Part of the samples that are off then, and part of those beside an edge that fall to its other side.
    #[serde(with = "crate::bits")]
    pub alone_off: [f64; 2],
    /// Why it must be `highp`.
    pub shown: Option<Shown>,
    /// It carries a coordinate of textures that have more texels than `mediump` tells apart.
    pub texels: Option<u32>,
    /// It is `highp` since the range of what goes into it is not stated.
    pub kept: bool,
}

/// What came of one function.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Report {
    /// The function.
    pub function: String,
    /// `name:line:column`.
    pub at: String,
    /// Each input, type and name, with what is stated of it, or what it is taken for.
    pub inputs: Vec<(String, String)>,
    /// Each output with what it may be off by.
    pub outputs: Vec<(String, Tolerance)>,
    /// Each declaration.
    pub rows: Vec<Row>,
    /// True where no smaller set of `highp` declarations holds.
    pub smallest: bool,
    /// Samples of the proof, once for each device; those that binary32 itself gives no sound output for are left out.
    pub samples: u64,
    /// Samples that were left out.
    pub left_out: u64,
    /// Samples of the proof at which a decision falls to the other side of an edge.
    pub jumps: u64,
    /// The largest error of the result in the proof, in units of what is allowed.
    #[serde(with = "crate::bits")]
    pub worst: f64,
    /// The same on a device that has binary16 and rounds to the nearest.
    #[serde(with = "crate::bits")]
    pub binary16: f64,
    /// The largest error with `mediump` everywhere, on devices that err as far as they may and with binary16.
    #[serde(with = "crate::bits")]
    pub all_medium: [f64; 2],
    /// The author's file with the precisions; it stays where it was made.
    #[serde(skip, default = "no_file")]
    pub after: SourceFile,
    /// Why even `highp` everywhere does not do: what has a precision that this file does not state.
    pub beyond: Option<Shown>,
}

fn no_file() -> SourceFile {
    SourceFile::new("", "")
}

/// Samples of both, of the first as many as there are between those of the second.
fn together(few: &Batch, many: &Batch) -> Batch {
    let mut samples: Vec<Sample> = Vec::new();
    for k in 0..many.invocation_count() {
        let at = k / FAR;
        if k % FAR == 0 && at < few.invocation_count() {
            samples.push(Sample::of(few, at));
        }
        samples.push(Sample::of(many, k));
    }
    Sample::batch(&samples)
}

impl Report {
    /// Declarations that must become `highp`, and those that may become lower.
    pub fn changes(&self) -> [usize; 2] {
        let count = |high: bool| {
            let differs = |row: &&Row| row.high == high && wanted(row.declaration.now, row.high) != row.declaration.now;
            self.rows.iter().filter(differs).count()
        };
        if self.beyond.is_some() { [0, 0] } else { [count(true), count(false)] }
    }
}

/// One function under way.
struct Tuning<'a> {
    file: &'a SourceFile,
    subject: &'a Subject,
    again: &'a dyn Fn(&SourceFile) -> Parsed,
    declarations: Declarations,
    /// Those that are `highp` since the range of what goes into them is not stated.
    kept: Vec<bool>,
    tolerances: Vec<Tolerance>,
    devices: Devices<'static>,
    /// Desktop GLSL, whose precisions mean nothing to desktops.
    desktop: bool,
    /// Width and height of the textures, in texels.
    texels: u32,
}

/// Tunes one function of a shader, whose parse is `parsed` and whose author's file is `file`. `again` parses a changed
/// file in the way of the first.
///
/// # Errors
/// Where nothing can be tuned, a range has no end, or an output has no format.
pub fn run(
    (parsed, file, subject): (&Parsed, &SourceFile, &Subject),
    domain: &Domain,
    request: &Request,
    again: &dyn Fn(&SourceFile) -> Parsed,
) -> Result<Report, String> {
    let shader = &parsed.shader;
    let ready = subject.ready.as_ref().map_err(|why| why.clone())?;
    bounded(ready, domain)?;
    let here =
        |(_, info): &(_, &syntax::symbols::FunctionInfo)| shader.file().locate(info.name.span.start) == subject.at;
    let (entry, _) = shader.functions().find(here).ok_or("the function is not in this file")?;
    let desktop = !shader.has_precisions();
    if desktop && subject.name != "main" {
        return Err("functions of desktop GLSL are tuned as part of their stage: give the file with `main`".to_owned());
    }
    let declarations = Declarations::of(shader, file, entry, &Precisions::stated(shader));
    if declarations.all.iter().all(|one| one.sampler) {
        return Err("nothing to tune: no declaration in this file holds floating-point numbers".to_owned());
    }
    let record = &ready.kernel.output.vertex;
    let tolerances = request.stated.of(record, ready.program.stage)?;
    let profile = by_name("binary32").ok_or("internal error, please report: there is no profile `binary32`")?;
    let devices = Devices { profile, seed: request.seed };
    let (kept, texels) = (kept::kept(shader, ready, domain, &declarations), request.texels);
    let tuning = Tuning { file, subject, again, declarations, kept, tolerances, devices, desktop, texels };
    let all_high = vec![true; tuning.declarations.all.len()];
    let base = tuning.built(&tuning.declarations.stated(file, &all_high))?;
    let key = stream_key(request.seed, &subject.label);
    let (samples, left_out) = tuning.samples(&base, domain, key, request.samples)?;
    tuning.report(&base, domain, samples, left_out)
}

/// # Errors
/// Where a stated range of an input has no end.
fn bounded(ready: &Ready, domain: &Domain) -> Result<(), String> {
    let kernel = &ready.kernel;
    for (record, inputs) in [(&kernel.invocation, &domain.invocation), (&kernel.case, &domain.case)] {
        for (field, input) in record.fields().iter().zip(inputs) {
            let open = input.interval().filter(|range| !range.low.is_finite() || !range.high.is_finite());
            if let Some(range) = open {
                let name = &field.name;
                return Err(format!(
                    "`{name}` {}: of a range without an end nothing fits `mediump`; state both, such as `--domain '{name}=[0,1000]'`",
                    Law::Within(range)
                ));
            }
        }
    }
    Ok(())
}

impl Tuning<'_> {
    /// The size of the textures whose coordinate a declaration carries, where `mediump` does not tell their texels apart.
    fn texels(&self, k: usize) -> Option<u32> {
        let one = &self.declarations.all[k];
        let apart = self.texels.saturating_mul(if one.repeats { REPEATS } else { 1 });
        (one.coordinate && apart >= TOLD_APART).then_some(self.texels)
    }

    /// The function in a changed file.
    fn built(&self, file: &SourceFile) -> Result<Box<Ready>, String> {
        let parsed = (self.again)(file);
        if let Some(error) = parsed.diagnostics.iter().find(|d| d.severity == base::diagnostic::Severity::Error) {
            let at = error.file.locate(error.span.start);
            return Err(format!("the text with precisions does not compile: {at}: {}", error.message));
        }
        let label = &self.subject.label;
        let wanted = |name: &str| name == label || name == self.subject.name;
        let all = subjects(&parsed.shader, &wanted).map_err(|bad| bad.why)?;
        let found = all.into_iter().find(|one| one.label == *label).ok_or("the changed text has no such function")?;
        let ready = found.ready?;
        Ok(if self.desktop { Box::new(ready.with_stated_precisions(&parsed.shader)) } else { ready })
    }

    /// Samples whose outputs are sound in binary32, and how many are not.
    fn samples(&self, base: &Ready, domain: &Domain, key: u64, count: u64) -> Result<(Batch, u64), String> {
        let constant = base.kernel.invocation.words() + base.kernel.case.words() == 0;
        let count = if constant { 1 } else { count as usize };
        let batch = drawn(base, domain, key, (0, count), !domain.is_stated());
        let batch = match self.far(domain, key, count / FAR)? {
            Some(far) => together(&far, &batch),
            None => batch,
        };
        let looks = scan(&base.executable, &base.kernel.output.vertex, &batch);
        let fine = |look: &crate::fuzz::Look| look.trouble.is_none() && !look.undefined && look.rounds.end();
        let chosen: Vec<usize> = (0..looks.len()).filter(|&k| fine(&looks[k])).collect();
        if chosen.is_empty() {
            return Err("no sample has a sound output in binary32: `shadercheck fuzz` tells why".to_owned());
        }
        let left_out = (looks.len() - chosen.len()) as u64;
        let samples: Vec<Sample> = chosen.into_iter().map(|k| Sample::of(&batch, k)).collect();
        Ok((Sample::batch(&samples), left_out))
    }

    /// Samples with times of an hour and large screens, where something has them.
    fn far(&self, domain: &Domain, key: u64, count: usize) -> Result<Option<Batch>, String> {
        let medium = self.built(&self.declarations.stated(self.file, &vec![false; self.declarations.all.len()]))?;
        let records = (&medium.kernel.invocation, &medium.kernel.case);
        Ok(medium.far.as_ref().filter(|_| count > 0).map(|far| far.batch(records, domain, key, 0, count)))
    }

    fn outcome(&self, ready: &Ready, batch: &Batch, strategies: &[Strategy]) -> Outcome {
        self.devices.run((ready, ready.lowered.as_ref()), &self.tolerances, batch, strategies)
    }

    fn report(&self, base: &Ready, domain: &Domain, samples: Batch, left_out: u64) -> Result<Report, String> {
        let all = &self.declarations.all;
        let record = &base.kernel.output.vertex;
        let taken = base.realistic.taken_for(domain);
        let fields = base.kernel.invocation.fields().iter().chain(base.kernel.case.fields());
        let laws = domain.invocation.iter().chain(&domain.case);
        let inputs = fields.zip(laws).enumerate().map(|(k, (field, input))| {
            let stated: Vec<String> = input.laws.iter().map(ToString::to_string).collect();
            let guessed =
                || format!("not stated; taken for {}", taken.get(k).copied().flatten().unwrap_or("any number"));
            let says = if stated.is_empty() { guessed() } else { stated.join(", ") };
            (format!("{} {}", field.shape, field.name), says)
        });
        let outputs = record.fields().iter().map(|field| field.name.clone()).zip(self.tolerances.iter().copied());
        let searched: Vec<Sample> =
            (0..samples.invocation_count().min(SEARCHED)).map(|k| Sample::of(&samples, k)).collect();
        let mut search = search::Search::new(self, searched);
        let mut report = Report {
            function: self.subject.label.clone(),
            at: self.subject.at.clone(),
            inputs: inputs.collect(),
            outputs: outputs.filter(|(name, _)| name != program::DISCARD).collect(),
            rows: Vec::new(),
            smallest: false,
            samples: 0,
            left_out,
            jumps: 0,
            worst: 0.0,
            binary16: 0.0,
            all_medium: [0.0; 2],
            after: self.file.clone(),
            beyond: None,
        };
        if let Some(off) = self.outcome(base, &samples, &Strategy::ALL).shown() {
            report.beyond = Some(self.shown(base, domain, off));
            return Ok(report);
        }
        let mut found = search.smallest()?;
        for round in 0.. {
            let ready = self.built(&self.declarations.stated(self.file, &found.high))?;
            let proof = self.outcome(&ready, &samples, &Strategy::ALL);
            match proof.shown() {
                None => break,
                Some(_) if interrupt::asked() => return Err("interrupted".to_owned()),
                Some(_) if round > ROUNDS => {
                    return Err("internal error, please report: the search and the proof do not meet".to_owned());
                }
                // How many fall to the other side of an edge is a matter of all.
                Some(_) if round == ROUNDS => {
                    let all = (0..samples.invocation_count()).map(|k| Sample::of(&samples, k));
                    search = search::Search::new(self, all.collect());
                }
                Some(off) => search.add(off.sample.clone()),
            }
            found = search.smallest()?;
        }
        report.smallest = found.smallest;
        for (k, declaration) in all.iter().enumerate() {
            let alone = search.alone(k)?;
            let part = |count: u64| count as f64 / alone.samples.max(1) as f64;
            let (worst, off) = (alone.worst, [part(alone.off), part(alone.jumps)]);
            let mut shown = None;
            if found.high[k] {
                let mut without = found.high.clone();
                without[k] = false;
                let ready = self.built(&self.declarations.stated(self.file, &without))?;
                let outcome = self.outcome(&ready, &search.batch(), &Strategy::ALL);
                shown = outcome.shown().map(|off| self.shown(&ready, domain, off));
            }
            report.rows.push(Row {
                declaration: declaration.clone(),
                high: found.high[k],
                alone: worst,
                alone_off: off,
                shown,
                texels: self.texels(k),
                kept: self.kept[k],
            });
        }
        let medium = self.built(&self.declarations.stated(self.file, &vec![false; all.len()]))?;
        let half =
            |ready: &Ready| self.devices.binary16(ready, ready.lowered.as_ref(), &self.tolerances, &samples).worst;
        report.all_medium = [self.outcome(&medium, &samples, &Strategy::ALL).worst, half(&medium)];
        // What is proved is the text that is written.
        report.after = self.declarations.patch(self.file, &found.high);
        let written = self.built(&report.after)?;
        let proof = self.outcome(&written, &samples, &Strategy::ALL);
        (report.samples, report.jumps, report.worst) = (proof.samples, proof.jumps, proof.worst);
        report.binary16 = half(&written);
        if let Some(off) = proof.shown() {
            // `lowp` of the author's promises less than `mediump`.
            report.beyond = Some(self.shown(&written, domain, off));
            report.after = self.file.clone();
        }
        Ok(report)
    }

    /// An output that is off, with the smallest inputs.
    fn shown(&self, ready: &Ready, domain: &Domain, off: &Off) -> Shown {
        let within = if domain.is_stated() { Within::Laws } else { Within::Realistic(&ready.realistic) };
        let admits = Shrinking { domain, within };
        let look = |sample: &Sample| {
            let outcome = self.outcome(ready, &Sample::batch(std::slice::from_ref(sample)), &[off.strategy]);
            outcome.most.or(outcome.jump)
        };
        let mut oracle = |samples: &[Sample]| -> Result<Vec<bool>, Infallible> {
            let kept = |sample: &Sample| {
                look(sample).is_some_and(|found| found.values[1].is_finite() == off.values[1].is_finite())
            };
            Ok(if interrupt::asked() { Vec::new() } else { samples.iter().map(kept).collect() })
        };
        let shrunk = match shrink(vec![off.sample.clone()], &admits, &mut oracle) {
            Ok(shrunk) => shrunk.into_iter().next().map(|shrunk| shrunk.sample),
            Err(never) => match never {},
        };
        let off = shrunk.and_then(|sample| look(&sample)).unwrap_or_else(|| off.clone());
        let executable = ready.lowered.as_ref().unwrap_or(&ready.executable);
        let place = off.event.and_then(|(_, event)| place(&ready.program, executable, Some(event.site)));
        Shown {
            message: message(&off),
            place,
            inputs: InputValue::all(&off.sample, &ready.program),
            output: ready.kernel.output.vertex.word_name(off.place.1),
            values: off.values,
            ratio: off.ratio,
        }
    }
}

fn message(off: &Off) -> String {
    use crate::fuzz::Harm;
    let shown = |x: f32| decimal(f64::from(x));
    match off.event {
        Some((Harm::Overflow, event)) => {
            format!("{} is {}, beyond the range of `mediump`", event.op, shown(event.value))
        }
        Some((Harm::Underflow, event)) => format!("{} may be taken for 0 by {}", shown(event.value), event.op),
        Some((Harm::Digits, event)) => {
            format!(
                "{} of a number as large as {} is {} instead of {}",
                event.op,
                shown(event.argument),
                shown(event.lowered),
                shown(event.value)
            )
        }
        None => "steps of `mediump` add up".to_owned(),
    }
}
