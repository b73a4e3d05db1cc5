//! First suites for shaders that have none: what can be run, domains guessed from names and types, and laws
//! that were seen to hold.

mod inputs;

use std::fmt::Write;

use super::run::of_module as of_module_text;
use super::run::{DEFAULT_SEED, FindingKind, Prepared, Report, Request, RunError, prepare, run};
use super::{Stage, Suite, parse};
use crate::dispatch::{Dispatched, Drafted};
use crate::fuzz::Known;
use base::diagnostic::Diagnostic;
use base::text::SourceFile;
use base::value::{Field, Scalar, Shape};
use judge::profile::Promises;
use lanes::{self, Lane};
use program::lower::Target;
use program::{Program, ProgramError, Written};
use syntax::{self, Shader};

/// Samples on which a new suite is tried.
const SAMPLES: u64 = 2048;
/// Samples that a new suite states, and dispatches of each size.
const DEFAULT_SAMPLES: u64 = 16384;
const DISPATCHES: u64 = 32;
/// Dispatches on which a new suite is tried in each size.
const TRIED: u64 = 8;
/// Samples on which a law has to be checked before it is written down.
const LEAST_CHECKED: u64 = 64;
/// Share of inconclusive samples from which on a suite tests hardly anything.
const NEARLY_ALL: f64 = 0.9;
/// Functions of one file that get a suite.
const MOST_FUNCTIONS: usize = 12;

/// What a suite could be about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// What is run.
    pub stage: Stage,
    /// The function, for [`Stage::Function`].
    pub entry: Option<String>,
}

/// A suite that was written and tried.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The name of the suite.
    pub name: String,
    /// The suite, in TOML, as a file of its own.
    pub text: String,
    /// Inputs that are filled.
    pub inputs: usize,
    /// Laws that held and stand in it.
    pub laws: usize,
    /// What is wrong all the same; the suite tells it in a comment.
    pub complaints: Vec<String>,
}

/// What can be run of a shader: its stage, or its functions. With the number of functions that are left
/// out because there are so many.
pub fn subjects(file: &SourceFile, stage: syntax::Stage) -> (Vec<Subject>, usize) {
    if Written::of(file) != Written::Glsl {
        return of_module(file);
    }
    let whole = |stage| vec![Subject { stage, entry: None }];
    match stage {
        syntax::Stage::Vertex => return (whole(Stage::Vertex), 0),
        syntax::Stage::Geometry => return (whole(Stage::Geometry), 0),
        syntax::Stage::Compute
        | syntax::Stage::Fragment
        | syntax::Stage::TessControl
        | syntax::Stage::TessEvaluation
        | syntax::Stage::Library => {}
    }
    let shader = Shader::parse(file, stage).shader;
    let names: Vec<&str> =
        shader.functions().filter(|(_, f)| f.definition.is_some()).map(|(_, f)| f.name.name.as_str()).collect();
    let single = |name: &&&str| **name != "main" && names.iter().filter(|n| **n == **name).count() == 1;
    let whole = match stage {
        syntax::Stage::Fragment => Some(Stage::Fragment),
        syntax::Stage::Compute => Some(Stage::Compute),
        _ => None,
    };
    let whole = whole.filter(|_| names.contains(&"main")).map(|stage| Subject { stage, entry: None });
    let mut all: Vec<Subject> = names
        .iter()
        .filter(single)
        .map(|name| Subject { stage: Stage::Function, entry: Some((*name).to_owned()) })
        .collect();
    let rest = all.len().saturating_sub(MOST_FUNCTIONS);
    all.truncate(MOST_FUNCTIONS);
    (whole.into_iter().chain(all).collect(), rest)
}

/// The same of a text that is read as a module: its entry points and functions. One that is wrong has a subject all the
/// same, whose draft tells what is wrong.
fn of_module(file: &SourceFile) -> (Vec<Subject>, usize) {
    let Ok(text) = super::read_module(file) else {
        return (vec![Subject { stage: Stage::Vertex, entry: None }], 0);
    };
    let points = text.points();
    let of_stage = |stage| points.iter().filter(|point| point.stage == stage).count();
    let point = |point: &program::Runnable| {
        let stage = match point.stage {
            syntax::Stage::Vertex => Stage::Vertex,
            syntax::Stage::Fragment => Stage::Fragment,
            syntax::Stage::Compute => Stage::Compute,
            _ => return None,
        };
        Some(Subject { stage, entry: (of_stage(point.stage) > 1).then(|| point.name.clone()) })
    };
    let whole: Vec<Subject> = points.iter().filter_map(point).collect();
    let function = |name: String| Subject { stage: Stage::Function, entry: Some(name) };
    let mut all: Vec<Subject> = text.functions().into_iter().map(|found| function(found.name)).collect();
    let rest = all.len().saturating_sub(MOST_FUNCTIONS);
    all.truncate(MOST_FUNCTIONS);
    (whole.into_iter().chain(all).collect(), rest)
}

/// Writes a suite called `name` about a subject of a shader, and tries it on the embedded lane and on
/// `devices`. `shader` is the path that the suite names.
///
/// # Errors
/// Why the subject cannot be run, in a line.
pub fn draft(
    file: &SourceFile,
    stage: syntax::Stage,
    subject: &Subject,
    name: &str,
    shader: &str,
    devices: &[Box<dyn Lane>],
) -> Result<Draft, String> {
    let program = match Written::of(file) {
        Written::Glsl => {
            let target = subject.entry.clone().map_or(Target::Stage, Target::Function);
            Program::from_source(file, stage, |_| Ok(target))
        }
        Written::Wgsl | Written::SpirV | Written::SpirVAssembly | Written::Hlsl | Written::Slang => {
            of_module_text(file, subject.stage, subject.entry.as_deref(), &[])
        }
    }
    .map_err(|error| in_a_line(&error))?;
    let function = subject.entry.as_deref().unwrap_or("main");
    let sketch = |tree: Option<&Shader>| {
        let known = Known::of(tree).map_err(|hint| format!("{}: {}", hint.at, hint.why))?;
        match subject.stage {
            Stage::Compute => of_dispatch(&program, &known, function),
            _ => of_invocations(&program, subject.stage, (&known, function)),
        }
    };
    let Sketch { inputs, groups, candidates } = match Written::of(file) {
        Written::Glsl => sketch(Some(&Shader::parse(file, stage).shader)),
        Written::Wgsl | Written::SpirV | Written::SpirVAssembly | Written::Hlsl | Written::Slang => {
            let module = super::read_module(file).ok();
            sketch(module.as_ref().and_then(|module| module.tree()))
        }
    }?;
    let head = head(subject, name, shader);
    let assemble = |laws: &[String], floors: &str| {
        let mut text = head.clone();
        if !laws.is_empty() {
            text.push_str("# Held on all samples that were tried; keep those that are meant.\nrelations = [\n");
            laws.iter().for_each(|law| {
                let _ = writeln!(text, "    {law},");
            });
            text.push_str("]\n");
        }
        text.push_str(&groups);
        text.push_str(floors);
        text
    };
    let lane = lanes::embedded::open().map_err(|_| "the embedded lane cannot be opened")?;
    let runs = |device: &&dyn Lane| subject.stage != Stage::Compute || device.dispatches();
    // A dispatch takes its time: one device tells what devices leave open.
    let most = if subject.stage == Stage::Compute { 1 } else { usize::MAX };
    let devices: Vec<&dyn Lane> = devices.iter().map(|device| &**device).filter(runs).take(most).collect();
    let all: Vec<String> = candidates.iter().map(|(_, law)| law.clone()).collect();
    // The largest sizes are the last ones, and tell most about laws.
    let last = |text: &str| ready(text, file).and_then(|mut all| all.pop().ok_or_else(|| NO_VARIANT.to_owned().into()));
    let report = match last(&assemble(&all, "")) {
        Ok(prepared) => tried(&prepared, &*lane)?,
        // What is wrong with it is what a first suite is to show.
        Err(Unready::Open(complaints)) => {
            let text = commented(&assemble(&[], ""), &complaints);
            return Ok(Draft { name: name.to_owned(), text, inputs, laws: 0, complaints });
        }
        Err(Unready::Other(why)) => return Err(why),
    };
    let broken: Vec<&str> = report
        .findings
        .iter()
        .filter(|f| matches!(f.kind, FindingKind::Relation | FindingKind::Vacuous))
        .filter_map(|f| f.message.split('`').nth(1))
        .collect();
    // What held wherever it was looked at, and was looked at hardly anywhere, was not seen to hold.
    let seldom = |name: &str| {
        let checked = report.relations.iter().find(|(own, _)| own == name).map_or(0, |(_, checked)| *checked);
        subject.stage != Stage::Compute && checked < LEAST_CHECKED
    };
    let holds = |name: &str| !broken.contains(&name) && !seldom(name);
    let laws: Vec<String> = candidates.into_iter().filter(|(name, _)| holds(name)).map(|(_, law)| law).collect();
    // A device leaves more samples open than the interpreter, which is more exact than is promised.
    let prepared = last(&assemble(&laws, ""))?;
    let on_devices = devices.iter().filter_map(|device| tried(&prepared, *device).ok());
    let reports: Vec<Report> = [report].into_iter().chain(on_devices).collect();
    let open = reports.iter().max_by(|a, b| share(a).total_cmp(&share(b)));
    open.map_or(Ok(()), refuse_vacuous)?;
    let floors = open.map_or_else(String::new, floors);
    let text = assemble(&laws, &floors);
    let mut complaints: Vec<String> = Vec::new();
    match ready(&text, file) {
        Ok(all) => {
            for (k, prepared) in all.iter().enumerate() {
                let mut reports = vec![tried(prepared, &*lane)?];
                // What a device cannot run is told when the suite is run.
                let last = devices.iter().filter(|_| k + 1 == all.len());
                reports.extend(last.filter_map(|device| tried(prepared, *device).ok()));
                complaints.extend(reports.iter().flat_map(Report::errors).map(|finding| finding.message.clone()));
            }
        }
        Err(Unready::Open(open)) => complaints.extend(open),
        Err(Unready::Other(why)) => return Err(why),
    }
    let mut seen = std::collections::HashSet::new();
    // Other sizes show the same with other numbers.
    let apart = |complaint: &String| complaint.replace(|c: char| c.is_ascii_digit(), "");
    complaints.retain(|complaint| seen.insert(apart(complaint)));
    let text = commented(&text, &complaints);
    Ok(Draft { name: name.to_owned(), text, inputs, laws: laws.len(), complaints })
}

/// A suite file with all suites of a shader.
pub fn file(shader: &str, drafts: &[Draft]) -> String {
    if let [alone] = drafts {
        return alone.text.clone();
    }
    let mut text = format!("shader = {shader:?}\n");
    for draft in drafts {
        text.push_str("\n[[suites]]\n");
        for line in draft.text.lines().filter(|line| !line.starts_with("shader = ")) {
            // A header of a table; lists end in lines of their own, and begin behind their key.
            let (brackets, title) = line.split_at(line.len() - line.trim_start_matches('[').len());
            let inside = if brackets.is_empty() { "" } else { "suites." };
            let _ = writeln!(text, "{brackets}{inside}{title}");
        }
    }
    text
}

/// A suite about a shader that has none left: a table without a size.
const NO_VARIANT: &str = "it has no size to be dispatched with";

/// What a first suite says, but for its head and its floors.
struct Sketch {
    /// Inputs that are filled.
    inputs: usize,
    /// How they are filled, and how a compute stage is dispatched.
    groups: String,
    /// Laws that may hold: names in reports, and how a suite states them.
    candidates: Vec<(String, String)>,
}

fn of_invocations(program: &Program, stage: Stage, about: (&Known<'_>, &str)) -> Result<Sketch, String> {
    let (invocation, case) = (program.invocation_record(), program.case_record());
    let outputs = program.output_layout().vertex;
    if outputs.fields().is_empty() {
        return Err("it has no output to look at".to_owned());
    }
    let inputs: Vec<&Field> = case.fields().iter().chain(invocation.fields()).collect();
    if inputs.is_empty() {
        return Err("it takes nothing that could be varied".to_owned());
    }
    let groups = inputs::groups((&inputs, case.fields().len()), program, about);
    Ok(Sketch { inputs: inputs.len(), groups, candidates: laws(stage, &inputs, outputs.fields()) })
}

fn of_dispatch(program: &Program, known: &Known<'_>, function: &str) -> Result<Sketch, String> {
    let dispatched = Dispatched::new(program).ok_or("it is no compute stage")??;
    let used = |field: &Field| known.uses(function, field);
    let Drafted { dispatch, inputs, count, laws } = dispatched.draft(&used).map_err(|error| in_a_line(&error))?;
    Ok(Sketch { inputs: count, groups: dispatch + &inputs, candidates: laws })
}

/// A suite with what is wrong as comments in front of it.
fn commented(text: &str, complaints: &[String]) -> String {
    let first = |complaint: &String| complaint.lines().next().unwrap_or_default().to_owned();
    let lines = complaints.iter().map(first).map(|line| format!("# Found when this was written: {line}\n"));
    lines.chain([text.to_owned()]).collect()
}

/// The first thing that is wrong, in a line.
fn in_a_line(error: &ProgramError) -> String {
    match error {
        ProgramError::Source(diagnostics) => first_of(diagnostics),
        other => other.to_string().lines().next().unwrap_or_default().to_owned(),
    }
}

fn first_of(diagnostics: &[Diagnostic]) -> String {
    diagnostics.first().map_or_else(
        || "it does not compile".to_owned(),
        |d| format!("{}: {}[{}]: {}", d.file.locate(d.span.start), d.severity.name(), d.code, d.message),
    )
}

/// Why a suite is not run.
enum Unready {
    /// Its invocations get in each other's way.
    Open(Vec<String>),
    /// Anything else.
    Other(String),
}

impl From<String> for Unready {
    fn from(why: String) -> Self {
        Self::Other(why)
    }
}

impl From<Unready> for String {
    fn from(unready: Unready) -> Self {
        match unready {
            Unready::Open(found) => found.join("; "),
            Unready::Other(why) => why,
        }
    }
}

/// The suite of a text in each of its sizes, ready to be run.
fn ready(text: &str, shader: &SourceFile) -> Result<Vec<Prepared>, Unready> {
    let suite = parse(&SourceFile::new("the new suite", text)).map_err(|error| error.to_string())?;
    let prepared = |suite: &Suite| {
        prepare(suite, shader).map_err(|error| match error {
            RunError::Shader { diagnostics, .. } => first_of(&diagnostics).into(),
            RunError::Open { found, .. } => Unready::Open(found),
            other => other.to_string().into(),
        })
    };
    suite.variants().iter().map(prepared).collect()
}

fn tried(prepared: &Prepared, lane: &dyn Lane) -> Result<Report, String> {
    let request = Request {
        samples: Some(if prepared.suite.stage == Stage::Compute { TRIED } else { SAMPLES }),
        seed: DEFAULT_SEED,
        quick: false,
        replay: Vec::new(),
        replay_only: false,
        promises: Promises::of_lane(lane.description()),
        arguments: prepared.suite.name.clone(),
    };
    run(prepared, lane, lanes::Stage::Compute, &request, &mut |_| {}).map_err(|error| error.to_string())
}

fn head(subject: &Subject, name: &str, shader: &str) -> String {
    let mut text = format!("suite = {name:?}\nshader = {shader:?}\nstage = {:?}\n", subject.stage.name());
    if let Some(entry) = &subject.entry {
        let _ = writeln!(text, "entry = {entry:?}");
    }
    text.push_str(
        "# What is right? Say it with one of these; until then lanes are held against the shader's own meaning.\n",
    );
    let (reference, recorded, samples) = match subject.stage {
        Stage::Compute => ("file = \"reference.comp\", groups = 1", "values_{N}.npz", DISPATCHES),
        _ => ("file = \"reference.glsl\", function = \"expected\"", "values.csv", DEFAULT_SAMPLES),
    };
    let _ = writeln!(text, "# reference = {{ {reference} }}\n# recorded = {recorded:?}\nsamples = {samples}");
    text
}

/// Laws that may hold, with their names in reports.
fn laws(stage: Stage, inputs: &[&Field], outputs: &[Field]) -> Vec<(String, String)> {
    let mut all = Vec::new();
    for field in outputs {
        let Shape { scalar, columns, rows, .. } = field.shape;
        let name = &field.name;
        if scalar == Scalar::F32 && columns == 1 && rows > 1 {
            all.push((format!("unit({name})"), format!("{{ kind = \"unit\", outputs = [{name:?}] }}")));
        }
        if scalar == Scalar::F32 {
            let law = format!("{{ kind = \"range\", range = [0.0, 1.0], outputs = [{name:?}] }}");
            all.push((format!("range({name})"), law));
        }
    }
    if stage != Stage::Function {
        return all;
    }
    // The laws of a function are about floats.
    if outputs.iter().all(|field| field.shape.scalar != Scalar::F32) {
        return all;
    }
    let floats: Vec<&&Field> = inputs.iter().filter(|f| f.shape.scalar == Scalar::F32).collect();
    for field in &floats {
        for kind in ["odd", "even"] {
            let name = &field.name;
            all.push((format!("{kind}({name})"), format!("{{ kind = {kind:?}, inputs = [{name:?}] }}")));
        }
    }
    for (k, a) in inputs.iter().enumerate() {
        for b in inputs[k + 1..].iter().filter(|b| b.shape == a.shape) {
            let (a, b) = (&a.name, &b.name);
            let law = format!("{{ kind = \"symmetric\", inputs = [{a:?}, {b:?}] }}");
            all.push((format!("symmetric({a}, {b})"), law));
        }
    }
    all
}

/// Share of the samples that decide nothing.
fn share(report: &Report) -> f64 {
    report.verdicts.undetermined_count() as f64 / report.verdicts.seen().max(1) as f64
}

/// Floors that the run reaches, where the usual ones are too high.
fn floors(report: &Report) -> String {
    let share = share(report);
    if share <= 0.04 {
        return String::new();
    }
    // Never all of them: a ceiling that no run could break is none.
    let ceiling = ((share * 1.25 + 0.01).min(0.5 * (1.0 + share)) * 100.0).ceil() / 100.0;
    format!("\n[floors]\nundetermined = {ceiling:?}\nreason = \"{}\"\n", doubt(report))
}

/// What most samples are inconclusive for.
fn doubt(report: &Report) -> String {
    let why = report.doubts.first().map_or_else(|| "not known".to_owned(), ToString::to_string);
    why.split_once(" undetermined, ").map_or(why.as_str(), |(_, why)| why).replace(['"', '\\'], "'")
}

/// A suite that hardly any run could fail is none: most of its samples are inconclusive.
fn refuse_vacuous(report: &Report) -> Result<(), String> {
    let share = share(report);
    if share < NEARLY_ALL || report.errors().iter().any(|finding| finding.kind != FindingKind::Floor) {
        return Ok(());
    }
    Err(format!(
        "{:.0} % of its samples are inconclusive: {}; state what its inputs are in a comment before it, such as \
         `// shadercheck: x in [0, 1]`",
        100.0 * share,
        doubt(report)
    ))
}
