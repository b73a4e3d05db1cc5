//! A program on lanes: what it shows, made smaller as a program and told apart by its cause.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::cause::{self, Event, EventKind};
use super::generate::{Wish, generate};
use super::inputs;
use super::print::{Printed, print};
use super::program::{Expression, Form, Input, Language, Program, Type, Variable};
use super::shrink::{about, shrink};
use super::write::Folder;
use crate::check::{self, Check, One, Suites};
use crate::session::{self, Join, Observer, Reached, Unlike};
use crate::suite::parse;
use crate::suite::run::{DEFAULT_SEED, Peer, Prepared, Report, Request, RunError, prepare};
use base::text::SourceFile;
use lanes::interrupt;

/// Samples of a program.
pub const SAMPLES: u64 = 64;
/// Programs that are tried to make one smaller.
const TRIED: usize = 400;
/// The same where each trial costs the process of a driver.
const TRIED_LOST: usize = 120;
/// What programs are called in their texts.
pub const NAME: &str = "repro";

/// What a run is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// Seed of the programs and of their inputs.
    pub seed: u64,
    /// What programs are to be.
    pub wish: Wish,
    /// Samples of each.
    pub samples: u64,
}

impl Default for Asked {
    fn default() -> Self {
        Self { seed: DEFAULT_SEED, wish: Wish { language: None }, samples: SAMPLES }
    }
}

/// What lanes made of one program.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// What lanes and translators did wrong; empty if nothing.
    pub events: Vec<Event>,
    /// Samples that agree, of all lanes.
    pub agreed: u64,
    /// Samples that were inconclusive.
    pub undetermined: u64,
    /// Samples, by lane.
    pub lanes: BTreeMap<String, u64>,
    /// Why a lane or the front end did not take it.
    pub refused: Vec<(String, String)>,
}

/// Runs a program on lanes; with `kept` among its inputs, by their names.
pub fn trial(
    program: &Program,
    peers: &[Peer<'_>],
    asked: &Asked,
    translations: bool,
    kept: &BTreeMap<String, Vec<u32>>,
) -> Outcome {
    let Printed { file, text, suite } = print(program, NAME);
    let mut outcome = Outcome::default();
    let shader = SourceFile::new(file.as_str(), text);
    let mut parsed = match parse(&SourceFile::new(format!("{NAME}.suite.toml"), suite)) {
        Ok(parsed) => parsed,
        Err(error) => {
            outcome.refused.push(("suite".to_owned(), error.to_string()));
            return outcome;
        }
    };
    parsed.inputs = inputs::groups(&parsed.inputs, kept);
    let prepared = match prepare(&parsed, &shader) {
        Ok(prepared) => prepared,
        Err(error) => {
            let why = match &error {
                RunError::Shader { diagnostics, .. } => diagnostics
                    .first()
                    .map_or_else(|| error.to_string(), |d| format!("{}: {}", d.file.locate(d.span.start), d.message)),
                _ => error.to_string(),
            };
            if let Some(event) = cause::of_panic(&why) {
                outcome.events.push(event);
            }
            outcome.refused.push(("front end".to_owned(), why));
            return outcome;
        }
    };
    let request = |prepared: &Prepared, peer: Peer<'_>| Request {
        samples: Some(asked.samples),
        seed: asked.seed,
        quick: true,
        replay: Vec::new(),
        replay_only: false,
        promises: peer.promises.clone(),
        arguments: format!("{}.suite.toml", prepared.suite.name),
    };
    let one = One { prepared: Arc::new(prepared), request };
    let mut check = Check::new(one, peers.to_vec());
    check.translations = translations;
    let mut watcher = Watcher { outcome };
    let Ok(_) = session::run(&mut check, None, Reached::default(), &mut watcher);
    let mut outcome = watcher.outcome;
    if program.folds() {
        outcome.events.retain(|event| event.kind != EventKind::Translation);
    }
    outcome.events.sort_by(|a, b| (a.kind, &a.on).cmp(&(b.kind, &b.on)));
    outcome
}

struct Watcher {
    outcome: Outcome,
}

impl<S: Suites> Observer<Check<'_, S>> for Watcher {
    fn event(&mut self, event: check::Event<'_>) -> Result<(), S::Error> {
        match event {
            check::Event::Ended(task, Err(error)) => {
                self.outcome.events.push(cause::of_failure(task.peer.name(), &error));
            }
            check::Event::Suite(_, _, parts) => parts.iter().cloned().for_each(|part| self.outcome.add(part.report())),
            check::Event::Prepared(..) | check::Event::Begun(_) | check::Event::Ended(_, Ok(_)) => {}
        }
        Ok(())
    }
}

impl Outcome {
    fn add(&mut self, report: Report) {
        self.agreed += report.verdicts.agreed;
        self.undetermined += report.verdicts.undetermined_count();
        *self.lanes.entry(report.lane.to_owned()).or_default() += report.verdicts.seen();
        if let Some(why) = &report.unsupported_because {
            self.refused.push((report.lane.to_owned(), why.clone()));
            self.events.extend(cause::of_panic(why));
        }
        for translated in &report.translations {
            if let Some(why) = &translated.unsupported {
                self.refused.push((translated.language.to_string(), why.clone()));
                self.events.extend(cause::of_panic(why));
            }
        }
        self.events.extend(report.findings.iter().filter_map(|finding| cause::of_finding(&report, finding)));
    }
}

/// Has lanes run something plain: one that met a panic may say so once more of what comes next.
fn settle(peers: &[Peer<'_>], asked: &Asked) {
    for language in Language::ALL {
        let plain = Program {
            language,
            form: Form::Function,
            structures: Vec::new(),
            helpers: Vec::new(),
            inputs: vec![Input { ty: Type::FLOAT, uniform: false }],
            body: Vec::new(),
            results: vec![Expression::read(Variable::Input(0), Type::FLOAT)],
        };
        let _ = trial(&plain, peers, &Asked { samples: 1, ..*asked }, false, &BTreeMap::new());
    }
}

/// One cause, with the smallest program that shows it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Cause {
    /// What tells it from others.
    pub key: String,
    /// Operations of the smallest program; those that are in every program of the cause.
    pub operations: Vec<String>,
    /// What kind it is.
    pub kind: EventKind,
    /// The lane or translator.
    pub on: String,
    /// Whose fault it is, as far as lanes tell.
    pub blamed: String,
    /// What is wrong, in a sentence.
    pub message: String,
    /// The command that shows the program again.
    pub program: u64,
    /// Programs that show it.
    pub count: u64,
    /// Language of the program.
    pub language: Language,
    /// Form of the program.
    pub form: Form,
    /// Its folder.
    pub folder: Folder,
    /// Size of the program before and after it was made smaller, in statements and nodes.
    pub sizes: (usize, usize),
    /// Programs that were tried for that.
    pub tried: usize,
}

impl Cause {
    /// True where both are one cause: of the same key, or where the operations of one are among those of the other, whose
    /// program could not be made as small.
    fn is_like(&self, other: &Self) -> bool {
        let within = |a: &[String], b: &[String]| !a.is_empty() && a.iter().all(|name| b.contains(name));
        let head = |cause: &Self| (cause.kind, cause.on.clone(), cause.blamed.clone());
        let alike = || within(&self.operations, &other.operations) || within(&other.operations, &self.operations);
        self.key == other.key || (head(self) == head(other) && alike())
    }
}

/// What came of some of the programs of a run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Found {
    /// Programs that ran.
    pub programs: u64,
    /// By language and form.
    pub forms: BTreeMap<String, u64>,
    /// Samples that agree.
    pub agreed: u64,
    /// Samples that were inconclusive.
    pub undetermined: u64,
    /// Programs and samples, by lane.
    pub lanes: BTreeMap<String, (u64, u64)>,
    /// Programs that nothing judged.
    pub vacuous: u64,
    /// Why programs were not run, by who refused them, with how many and the first.
    pub refused: BTreeMap<String, (u64, u64)>,
    /// What is wrong, in the order of the first program of each.
    pub causes: Vec<Cause>,
    /// Causes by what is known of them before a program is made smaller.
    coarse: BTreeMap<String, String>,
}

impl Found {
    /// Runs the program with this number, and adds what came of it. False where the run was interrupted: nothing of the
    /// program is then counted.
    pub fn program(&mut self, index: u64, peers: &[Peer<'_>], asked: &Asked) -> bool {
        let program = generate(asked.seed, index, asked.wish);
        let outcome = trial(&program, peers, asked, true, &BTreeMap::new());
        if interrupt::asked() {
            return false;
        }
        if outcome.events.iter().any(|event| event.kind == EventKind::Panic) {
            settle(peers, asked);
        }
        let mut fresh = Vec::new();
        let mut seen = BTreeSet::new();
        for event in &outcome.events {
            if !seen.insert(event.coarse()) {
                continue;
            }
            match self.coarse.get(&event.coarse()).filter(|_| event.is_sure()).cloned() {
                Some(key) => self.count(&key),
                None => fresh.push(event.clone()),
            }
        }
        // One after the other: what the first shows often is what the others show.
        for event in fresh {
            let Some(cause) = self.look_into(index, &program, peers, asked, &event) else { return false };
            match self.causes.iter_mut().find(|known| known.is_like(&cause)) {
                Some(known) => {
                    self.coarse.insert(event.coarse(), known.key.clone());
                    known.count += 1;
                }
                None => {
                    self.coarse.insert(event.coarse(), cause.key.clone());
                    self.causes.push(cause);
                }
            }
        }
        self.programs += 1;
        *self.forms.entry(format!("{} {}", program.language.name(), program.form.name())).or_default() += 1;
        self.agreed += outcome.agreed;
        self.undetermined += outcome.undetermined;
        self.vacuous += u64::from(outcome.agreed == 0 && outcome.events.is_empty());
        for (lane, samples) in &outcome.lanes {
            let entry = self.lanes.entry(lane.clone()).or_default();
            (entry.0, entry.1) = (entry.0 + 1, entry.1 + samples);
        }
        for (who, why) in outcome.refused {
            let entry = self.refused.entry(format!("{who}: {}", cause::plain(&why))).or_insert((0, index));
            *entry = (entry.0 + 1, entry.1.min(index));
        }
        true
    }

    fn count(&mut self, key: &str) {
        if let Some(known) = self.causes.iter_mut().find(|cause| cause.key == key) {
            known.count += 1;
        }
    }

    /// Makes the program of an event smaller. None where the run was interrupted.
    fn look_into(
        &self,
        index: u64,
        program: &Program,
        peers: &[Peer<'_>],
        asked: &Asked,
        event: &Event,
    ) -> Option<Cause> {
        let translator = event.kind == EventKind::Translation || event.kind == EventKind::Panic;
        let mut only: Vec<Peer<'_>> = peers.iter().filter(|peer| peer.name() == event.on).copied().collect();
        if only.is_empty() {
            // A lane that the fault stops would hide what translators make of the program.
            let quiet = peers.iter().find(|peer| peer.lane.description().executor == "interpreter");
            only.extend(quiet.or(peers.first()));
        }
        // What the lane was given when it failed is given to smaller programs as well, as far as they have the inputs.
        let kept: BTreeMap<String, Vec<u32>> =
            event.inputs.iter().map(|input| (input.plain_name().to_owned(), input.bits.clone())).collect();
        let few = Asked { samples: asked.samples.min(24), ..*asked };
        let budget = if event.kind == EventKind::Lost { TRIED_LOST } else { TRIED };
        let mut shows = |candidate: &Program| {
            !interrupt::asked()
                && trial(candidate, &only, &few, translator, &kept).events.iter().any(|e| e.is_like(event))
        };
        let shrunk = match shows(program) {
            true => shrink(program.clone(), budget, &mut shows),
            // With fewer samples it does not show: it stays as it is.
            false => super::shrink::Shrunk { program: program.clone(), tried: 1 },
        };
        if interrupt::asked() {
            return None;
        }
        // Once more on all lanes: whose fault it is, of the smallest program.
        let last = trial(&shrunk.program, peers, &few, translator, &kept);
        let shown = last.events.iter().find(|e| e.is_like(event)).unwrap_or(event);
        let operations = about(&shrunk.program).join(", ");
        let printed = print(&shrunk.program, NAME);
        Some(Cause {
            key: shown.key(&operations, &shrunk.program),
            operations: about(&shrunk.program).into_iter().map(str::to_owned).collect(),
            kind: shown.kind,
            on: shown.on.clone(),
            blamed: shown.blamed.clone(),
            message: shown.message.clone(),
            program: index,
            count: 1,
            language: program.language,
            form: program.form,
            folder: Folder::of(&printed, shown, &operations),
            sizes: (program.size(), shrunk.program.size()),
            tried: shrunk.tried,
        })
    }

    /// True where something is wrong.
    pub fn fails(&self) -> bool {
        !self.causes.is_empty()
    }
}

impl Join for Found {
    fn join(&mut self, other: Self) -> Result<(), Unlike> {
        self.programs += other.programs;
        self.agreed += other.agreed;
        self.undetermined += other.undetermined;
        self.vacuous += other.vacuous;
        for (form, count) in other.forms {
            *self.forms.entry(form).or_default() += count;
        }
        for (lane, (programs, samples)) in other.lanes {
            let entry = self.lanes.entry(lane).or_default();
            (entry.0, entry.1) = (entry.0 + programs, entry.1 + samples);
        }
        for (why, (count, first)) in other.refused {
            let entry = self.refused.entry(why).or_insert((0, first));
            *entry = (entry.0 + count, entry.1.min(first));
        }
        for cause in other.causes {
            match self.causes.iter_mut().find(|known| known.is_like(&cause)) {
                Some(known) => {
                    let count = known.count + cause.count;
                    if cause.program < known.program {
                        *known = cause;
                    }
                    known.count = count;
                }
                None => self.causes.push(cause),
            }
        }
        self.causes.sort_by(|a, b| (a.program, &a.key).cmp(&(b.program, &b.key)));
        self.coarse.extend(other.coarse);
        Ok(())
    }
}
