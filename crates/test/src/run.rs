//! From a builder to what came of it.

use std::sync::Arc;

use base::diagnostic::Lang;
use base::text::SourceFile;
use engine::check::{Check, Event, One, Suites};
use engine::guess::{self, Role};
use engine::session::{self, Observer, Reached};
use engine::suite::run::{
    Entry, Outcome as Run, Peer, Prepared, Request, RunError, Status, Summary, of_module, prepare, prepare_with, settle,
};
use engine::suite::{Expect, Floors, ReferenceFile, Stage, Suite};
use judge::profile::Promises;
use judge::verdict::{Literals, Reference};
use lanes::{Lane, Wanted};
use program::lower::Target;
use program::{Program, Written};
use property::regressions;
use property::{InputGroup, Own, Sample, generators};

use crate::{Error, Outcome, Shader};

pub(crate) fn check(shader: &Shader) -> Result<Outcome, Error> {
    let suite = suite(shader)?;
    let prepared = if shader.given.is_empty() {
        prepare(&suite, &shader.file)
    } else {
        if shader.reference.is_some() {
            return Err(Error::new("`expect` and `reference` both say what is right; use one of them"));
        }
        prepare_with(&suite, &shader.file, &|program| {
            let given = Reference::given(shader.given.clone(), program);
            Ok((given.map_err(|source| unfit(&suite, source))?, Vec::new()))
        })
    };
    let prepared = prepared.map_err(|error| error_of(&error))?;
    let replay = match &shader.case {
        Some(text) => replay(&prepared, text)?,
        None => Vec::new(),
    };
    let lanes = lanes(&shader.lanes)?;
    let mut entries = on_lanes(prepared, &lanes, |_, lane| Request {
        samples: Some(shader.samples),
        seed: shader.seed,
        quick: false,
        replay: replay.clone(),
        replay_only: shader.case.is_some(),
        promises: Promises::of_lane(lane.description()),
        arguments: String::new(),
    });
    for entry in &mut entries {
        if let Run::Ran(report) = &mut entry.outcome {
            report.findings.iter_mut().for_each(|finding| {
                finding.reproduce = finding.reproduce.as_deref().and_then(again);
            });
        }
    }
    Ok(outcome(entries))
}

fn unfit(suite: &Suite, source: judge::verdict::ReferenceError) -> RunError {
    RunError::Reference { suite: suite.name.clone(), shader: suite.shader.clone(), source: Box::new(source) }
}

/// An error with its diagnostics.
pub(crate) fn error_of(error: &RunError) -> Error {
    match error {
        RunError::Shader { diagnostics, .. } => {
            let all: Vec<String> = diagnostics.iter().map(|d| report::diagnostics::text(d, Lang::En, false)).collect();
            Error::new(format!("it does not compile\n\n{}", all.join("\n")))
        }
        other => Error::new(other.to_string()),
    }
}

fn replay(prepared: &Prepared, text: &str) -> Result<Vec<Sample>, Error> {
    let file = SourceFile::new("case", format!("case {text}"));
    let (invocation, case) = (&prepared.compute.invocation, &prepared.compute.case);
    let wrong = |error: regressions::RegressionError| Error::new(format!("`case`: {error}"));
    let parsed = regressions::parse(&file).map_err(wrong)?;
    parsed.iter().map(|regression| regression.to_sample(invocation, case).map_err(wrong)).collect()
}

/// The lanes that are named; without names every device, and the stand-in where there is none.
pub(crate) fn lanes(names: &[String]) -> Result<Vec<Box<dyn Lane>>, Error> {
    let opened = Wanted::named(names).open().map_err(|unknown| Error::new(unknown.to_string()))?;
    if let (Some((name, missing)), false) = (opened.missing.first(), names.is_empty()) {
        return Err(Error::new(format!("the lane `{name}` is not available: {missing}")));
    }
    if opened.lanes.is_empty() { Err(Error::new("no lane can run here")) } else { Ok(opened.lanes) }
}

/// Runs a suite on every stage of every lane.
pub(crate) fn on_lanes(
    prepared: Prepared,
    lanes: &[Box<dyn Lane>],
    request: impl Fn(&Prepared, &dyn Lane) -> Request,
) -> Vec<Entry> {
    let promises: Vec<Promises> = lanes.iter().map(|lane| Promises::of_lane(lane.description())).collect();
    let peers = lanes.iter().zip(&promises).map(|(lane, promises)| Peer { lane: lane.as_ref(), promises }).collect();
    let one = One {
        prepared: Arc::new(prepared),
        request: |prepared: &Prepared, peer: Peer<'_>| request(prepared, peer.lane),
    };
    let mut collected = Collected(Vec::new());
    let Ok(_) = session::run(&mut Check::new(one, peers), None, Reached::default(), &mut collected);
    collected.0
}

/// The results of one suite.
struct Collected(Vec<Entry>);

impl<S: Suites> Observer<Check<'_, S>> for Collected {
    fn event(&mut self, event: Event<'_>) -> Result<(), S::Error> {
        match event {
            Event::Ended(task, Ok(part)) => self.0.push(task.entry(Run::Ran(Box::new(part.clone().report())))),
            Event::Ended(task, Err(error)) => self.0.push(task.entry(Run::LaneFailed(error.to_string()))),
            Event::Suite(_, _, parts) => settle(&mut self.0, parts.to_vec()),
            Event::Prepared(..) | Event::Begun(_) => {}
        }
        Ok(())
    }
}

/// The case of a command line, as a builder takes it.
fn again(command: &str) -> Option<String> {
    let (_, case) = command.split_once("--case '")?;
    Some(format!("add .case({:?})", case.trim_end_matches('\'')))
}

/// Counts and the report.
pub(crate) fn outcome(entries: Vec<Entry>) -> Outcome {
    let summary = Summary { entries, ..Summary::default() };
    let (totals, passed) = (summary.totals(), summary.status() == Status::Pass);
    let lines = summary.entries.iter().map(|entry| report::check::line(entry, false));
    let mut text: String = lines.collect();
    for at in 0..summary.entries.len() {
        text.push_str(&report::check::finding(&summary.entries, at, false));
    }
    Outcome { judged: totals.judged, undetermined: totals.undetermined, passed, report: text }
}

/// The builder as a suite.
fn suite(shader: &Shader) -> Result<Suite, Error> {
    if shader.stage == Stage::Function && shader.entry.is_none() {
        let message = format!("`{}` is no .vert and no .geom; choose a function with `function`", shader.file.name());
        return Err(Error::new(message));
    }
    let mut inputs = Vec::new();
    for (name, domain) in &shader.inputs {
        if let Some(problem) = &domain.problem {
            return Err(Error::new(format!("input `{name}`: {problem}")));
        }
        inputs.push(InputGroup {
            names: vec![name.clone()],
            generator: domain.generator.clone(),
            options: domain.options.clone(),
            at: format!("input `{name}`"),
        });
    }
    if shader.guess {
        inputs.extend(guessed(shader)?);
    }
    let expect = shader.reference.as_ref().map_or(Expect::Nothing, |other| {
        Expect::Reference(ReferenceFile {
            file: other.file.name().to_owned(),
            function: other.function.clone(),
            output: other.output.clone(),
            groups: Vec::new(),
            text: Some(other.file.clone()),
            at: "reference".to_owned(),
        })
    });
    let floors = Floors { undetermined: shader.undetermined, ..Floors::default_for(shader.samples) };
    Ok(Suite {
        linked: Vec::new(),
        linked_texts: Vec::new(),
        with: Vec::new(),
        with_texts: Vec::new(),
        assign_bindings: false,
        textures: Vec::new(),
        name: shader.entry.clone().unwrap_or_else(|| shader.file.name().to_owned()),
        title: shader.file.name().to_owned(),
        shader: shader.file.name().to_owned(),
        stage: shader.stage,
        entry: shader.entry.clone(),
        entries: Vec::new(),
        expect,
        defines: Vec::new(),
        chosen: shader.defines.clone(),
        samples: shader.samples,
        per_case: 16,
        relations: Vec::new(),
        laws: shader.laws.iter().map(|law| law.0.clone()).collect(),
        inputs,
        guessed: Vec::new(),
        // The share is what counts: as many samples are made as are asked for.
        floors: Floors { judged: 1, ..floors },
        literals: Literals::default(),
        strands: None,
        dispatch: engine::suite::Dispatching::default(),
        includes: shader.includes.clone(),
        file: SourceFile::new("", ""),
    })
}

/// Groups for the inputs that the builder does not name.
fn guessed(shader: &Shader) -> Result<Vec<InputGroup>, Error> {
    let stage = match shader.stage {
        Stage::Vertex => syntax::Stage::Vertex,
        Stage::Geometry => syntax::Stage::Geometry,
        Stage::Fragment => syntax::Stage::Fragment,
        Stage::Compute => syntax::Stage::Compute,
        Stage::Function => syntax::Stage::from_path(shader.file.name()).unwrap_or(syntax::Stage::Library),
    };
    let program = match Written::of(&shader.file) {
        Written::Glsl => {
            let target = shader.entry.clone().map_or(Target::Stage, Target::Function);
            Program::from_source_with(&shader.file, stage, &shader.defines, |_| Ok(target))
        }
        Written::Wgsl | Written::SpirV | Written::SpirVAssembly | Written::Hlsl | Written::Slang => {
            of_module(&shader.file, shader.stage, shader.entry.as_deref(), &shader.defines)
        }
    };
    let program = program.map_err(|error| Error::new(error.to_string()))?;
    let (invocation, case) = (program.invocation_record(), program.case_record());
    let fields = case.fields().iter().chain(invocation.fields());
    let open = fields.filter(|field| shader.inputs.iter().all(|(name, _)| *name != field.name));
    let group = |field: &base::value::Field| {
        let guess = guess::of(field, Role::Parameter);
        let generator = generators::by_name(guess.generator)
            .ok_or_else(|| Error::new(format!("there is no generator `{}`", guess.generator)))?;
        Ok(InputGroup {
            names: vec![field.name.clone()],
            generator: Own::Static(generator),
            options: generators::Options { range: guess.range, ..generators::Options::default() },
            at: format!("input `{}`", field.name),
        })
    };
    open.map(group).collect()
}
