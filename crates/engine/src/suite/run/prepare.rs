//! A suite and its shader made ready, whatever the lane.

use std::sync::Arc;

use thiserror::Error;

use crate::dispatch::open_meaning;
use crate::suite::record::{self, Interface};
use crate::suite::{
    Asked, Count, Dispatching, Expect, Joined, ReferenceFile, RunTextureError, Stage, Suite, read_module,
};
use base::diagnostic::Diagnostic;
use base::text::SourceFile;
use compose::Options;
use disk::Problem;
use judge::verdict::{Oracle, Recorded, RecordedRow, Reference, ReferenceError};
use lanes::{Lane, Stage as LaneStage, embedded};
use program::lower::Target;
use program::{Chosen, Kernel, ModuleText, Program, ProgramError, Written};
use property::law::LawError;
use property::{Own, Plan, PlanError, Relation, Sample, Sampler};

/// Why a suite cannot be run.
#[derive(Debug, Error)]
pub enum RunError {
    /// The shader is wrong, or cannot be run; the diagnostics say where.
    #[error("{} of suite `{suite}` does not compile", .diagnostics.first().map_or("the shader", |d| d.file.name()))]
    Shader {
        /// Name of the suite.
        suite: String,
        /// What is wrong with it.
        diagnostics: Vec<Diagnostic>,
    },
    /// The program cannot be captured.
    #[error("suite `{suite}`: {source}")]
    Program {
        /// Name of the suite.
        suite: String,
        /// Why.
        source: ProgramError,
    },
    /// Invocations of a dispatch get in each other's way: what comes out depends on which one is first.
    #[error(
        "suite `{suite}`: what the shader gives is open, and nothing is compared: no order of its invocations is \
         promised\n  {}",
        .found.join("\n  ")
    )]
    Open {
        /// Name of the suite.
        suite: String,
        /// Races and barriers, each with its place.
        found: Vec<String>,
    },
    /// The formula does not fit the shader.
    #[error("suite `{suite}`, {shader}: {source}")]
    Reference {
        /// Name of the suite.
        suite: String,
        /// File name of the shader, as the suite names it.
        shader: String,
        /// Why.
        source: Box<ReferenceError>,
    },
    /// The reference shader is wrong, or cannot be run.
    #[error("the reference of suite `{suite}` cannot be used: {source}")]
    ReferenceProgram {
        /// Name of the suite.
        suite: String,
        /// Why.
        source: ProgramError,
    },
    /// Recorded values cannot be read.
    #[error("{}", .problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n"))]
    Recorded {
        /// What is wrong in the file.
        problems: Vec<Problem>,
    },
    /// A law does not fit the shader.
    #[error("suite `{suite}`, {shader}: {source}")]
    Law {
        /// Name of the suite.
        suite: String,
        /// File name of the shader, as the suite names it.
        shader: String,
        /// Why.
        source: LawError,
    },
    /// A texture does not fit the shader.
    #[error("suite `{suite}`: {source}")]
    Texture {
        /// Name of the suite.
        suite: String,
        /// Where and why.
        source: RunTextureError,
    },
    /// The inputs of the suite do not fit the shader.
    #[error("suite `{suite}`, {shader}: {source}")]
    Plan {
        /// Name of the suite.
        suite: String,
        /// File name of the shader, as the suite names it.
        shader: String,
        /// Why.
        source: Box<PlanError>,
    },
}

/// A suite with its program, formula and plan.
pub struct Prepared {
    /// The suite.
    pub suite: Suite,
    /// Name of the shader file.
    pub shader: String,
    /// The program.
    pub program: Program,
    /// Its compute kernel.
    pub compute: Kernel,
    /// Its vertex kernel, for a vertex suite.
    pub vertex: Option<Kernel>,
    /// Its geometry kernel, for a geometry suite.
    pub geometry: Option<Kernel>,
    /// The formula, bound to the program.
    pub reference: Reference,
    /// What fills the inputs.
    pub plan: Arc<Plan>,
    /// The relations that the suite names.
    pub relations: Vec<Own<dyn Relation>>,
    /// Samples that the suite states one by one: the rows of recorded values.
    pub rows: Vec<Sample>,
    /// What the program means.
    pub oracle: Oracle,
    /// The same for lanes on which `mediump` is less than binary32; none where nothing is lower.
    pub lowered: Option<Oracle>,
    /// Samples at its edges, once they were sought.
    pub(super) edges: super::edges::KeptEdges,
    /// What is known of the inputs of its relations, once it was asked for.
    pub(super) known: super::related::KeptKnown,
}

impl Prepared {
    /// What the program means to a lane.
    pub(super) fn oracle_of(&self, lane: &dyn Lane) -> &Oracle {
        self.lowered.as_ref().filter(|_| embedded::lowers(lane)).unwrap_or(&self.oracle)
    }

    /// Whether this is the program for lanes on which `mediump` is less than binary32.
    pub(super) fn is_lowered(&self, oracle: &Oracle) -> bool {
        self.lowered.as_ref().is_some_and(|lowered| std::ptr::eq(lowered, oracle))
    }

    /// The kernel for a stage of a lane; none where the suite is not of that stage.
    pub fn kernel(&self, stage: LaneStage) -> Option<&Kernel> {
        match stage {
            LaneStage::Compute => Some(&self.compute),
            LaneStage::Vertex if self.suite.stage == Stage::Function => Some(&self.compute),
            LaneStage::Vertex => self.vertex.as_ref(),
            LaneStage::Geometry => self.geometry.as_ref(),
        }
    }
}

/// Reads, lowers, translates and captures the shader of a suite, and binds what is expected and inputs to
/// it.
///
/// # Errors
/// [`RunError`]: what does not fit.
pub fn prepare(suite: &Suite, shader: &SourceFile) -> Result<Prepared, RunError> {
    prepare_with(suite, shader, &|program| expected(suite, shader, program))
}

/// Dispatches in which races are looked for before anything is compared.
const PILOT: usize = 16;

/// What is expected of a program, with the samples that this is stated for.
type Expectation = (Reference, Vec<Sample>);

/// The same, with an expectation of the caller's in place of what the suite names.
///
/// # Errors
/// [`RunError`]: what does not fit.
pub fn prepare_with(
    suite: &Suite,
    shader: &SourceFile,
    expected: &dyn Fn(&Program) -> Result<Expectation, RunError>,
) -> Result<Prepared, RunError> {
    let name = || suite.name.clone();
    let captured = |source| match source {
        ProgramError::Source(found) => {
            let diagnostics = found.into_iter().map(|d| suite.includes.explained(d)).collect();
            RunError::Shader { suite: name(), diagnostics }
        }
        source => RunError::Program { suite: name(), source },
    };
    let (mut program, author) = kernel(suite, shader).map_err(captured)?;
    super::super::textures::bind(suite, &mut program, true)
        .map_err(|source| RunError::Texture { suite: name(), source })?;
    let compute = program.compute_kernel().map_err(captured)?;
    let vertex = match suite.stage {
        Stage::Vertex => Some(program.vertex_kernel(&super::finding::components(suite, &program)).map_err(captured)?),
        Stage::Geometry | Stage::Fragment | Stage::Compute | Stage::Function => None,
    };
    let geometry = (suite.stage == Stage::Geometry).then(|| program.geometry_kernel()).transpose().map_err(captured)?;
    let shader_name = || shader.name().to_owned();
    let (reference, rows) = expected(&program)?;
    // Recorded rows are samples enough: a suite need not say how to make others.
    let varied = suite.inputs.iter().any(|group| group.generator.name() != "constant");
    let plan = if !varied && !rows.is_empty() {
        Plan::of_given(compute.invocation.clone(), compute.case.clone())
    } else {
        suite.plan_for(&program, &compute.invocation, &compute.case).map_err(|source| RunError::Plan {
            suite: name(),
            shader: shader_name(),
            source: Box::new(source),
        })?
    };
    let plan = Arc::new(plan);
    if let Some(author) = author {
        let pilot = if program.is_large() { 1 } else { PILOT };
        let batch = if plan.makes_samples() {
            Sampler::new(plan.clone(), super::DEFAULT_SEED).batch(0, pilot.div_ceil(suite.per_case), suite.per_case)
        } else {
            Sample::batch(&rows[..rows.len().min(pilot)])
        };
        let unread = |what| RunError::Program { suite: name(), source: ProgramError::Unsupported { what } };
        let found = open_meaning(&author, &compute, &batch).map_err(unread)?;
        if !found.is_empty() {
            return Err(RunError::Open { suite: name(), found });
        }
    }
    let oracle = Oracle::with_literals(&program, &suite.literals).map_err(|error| RunError::Program {
        suite: name(),
        source: ProgramError::Unsupported { what: error.locate(&program) },
    })?;
    let mut all: Vec<Own<dyn Relation>> =
        suite.relations.iter().filter_map(|r| crate::catalogue::relation(r)).map(Own::Static).collect();
    let range = |input: &str| {
        suite.inputs.iter().find(|g| g.names.iter().any(|n| n == input)).and_then(|group| group.options.range)
    };
    for law in &suite.laws {
        let bound = law.bind(reference.fields(), [&compute.invocation, &compute.case], &range);
        all.push(bound.map_err(|source| RunError::Law { suite: name(), shader: shader_name(), source })?);
    }
    let lowered = program.manners.lower().then(|| Oracle::lowered(&program).ok()).flatten();
    Ok(Prepared {
        oracle,
        lowered,
        edges: super::edges::KeptEdges::default(),
        known: super::related::KeptKnown::default(),
        relations: all,
        rows,
        suite: suite.clone(),
        shader: shader_name(),
        plan,
        program,
        compute,
        vertex,
        geometry,
        reference,
    })
}

/// What a suite tests of its shader; of a compute stage, with the stage before it is dispatched.
fn kernel(suite: &Suite, shader: &SourceFile) -> Result<(Program, Option<Program>), ProgramError> {
    if suite.stage != Stage::Compute {
        return Ok((program(suite, shader, suite.entry.as_deref())?, None));
    }
    let own = Suite { chosen: suite.dispatch.of_shader(&suite.chosen), ..suite.clone() };
    let author = program(&own, shader, suite.entry.as_deref())?;
    Ok((suite.dispatch.apply(author.clone(), &suite.chosen)?, Some(author)))
}

/// What a suite compares its shader with: a function, or another shader of the same stage.
fn other(suite: &Suite, text: &SourceFile, function: Option<&str>, groups: &[Count]) -> Result<Program, ProgramError> {
    match function {
        Some(function) if suite.stage == Stage::Compute => {
            let of_function = Suite { stage: Stage::Function, ..suite.clone() };
            program(&of_function, text, Some(function))
        }
        None if suite.stage == Stage::Compute => {
            let groups = if groups.is_empty() { suite.dispatch.groups.clone() } else { groups.to_vec() };
            // A reference that is written for its sizes gets them as macros.
            let author = program(suite, text, suite.entry.as_deref())?;
            Dispatching { groups, ..suite.dispatch.clone() }.apply(author, &suite.chosen)
        }
        _ => program(suite, text, function.or(suite.entry.as_deref())),
    }
}

/// What a suite runs of a text: its stage, or a function.
fn program(suite: &Suite, shader: &SourceFile, function: Option<&str>) -> Result<Program, ProgramError> {
    if Written::of(shader) != Written::Glsl {
        return of_joined(suite, shader, function);
    }
    let stage = stage_of(suite, shader, function);
    let target = function.map_or(Target::Stage, |name| Target::Function(name.to_owned()));
    let texts: Vec<SourceFile> = std::iter::once(shader).chain(&suite.linked_texts).cloned().collect();
    Program::from_sources(&texts, stage, &suite.chosen, |_| Ok(target))
}

/// The program of a text that is a module, with what it imports.
fn of_joined(suite: &Suite, shader: &SourceFile, function: Option<&str>) -> Result<Program, ProgramError> {
    let options = Options {
        defines: suite.chosen.clone(),
        preludes: suite.with_texts.clone(),
        assign_bindings: suite.assign_bindings,
        ..Options::default()
    };
    let asked = Asked { entry: function.map(str::to_owned), stage: suite.stage.of_text(), ..Asked::default() };
    let joined = Joined::of(shader, &suite.includes.folders, &options, &asked)
        .map_err(|error| ProgramError::Unsupported { what: error.to_string() })?;
    let Some(joined) = joined else { return of_module(shader, suite.stage, function, &suite.chosen) };
    let text = joined.module()?;
    // A value that nobody takes is a mistake in the shader of the suite, and none in its reference.
    let own = shader.name().replace('\\', "/").ends_with(suite.shader.trim_start_matches("./"));
    let values = if own { joined.values(&text, &suite.chosen) } else { text.taken(&suite.chosen) };
    of_text(&text, suite.stage, function, &values)
}

/// The program of a text that is read as a module: one of its functions, or an entry point.
///
/// # Errors
/// As of [`ModuleText::read`] and [`ModuleText::program`].
pub fn of_module(
    shader: &SourceFile,
    stage: Stage,
    name: Option<&str>,
    values: &[(String, String)],
) -> Result<Program, ProgramError> {
    of_text(&read_module(shader)?, stage, name, values)
}

/// The same of a text that is read.
fn of_text(
    text: &ModuleText,
    stage: Stage,
    name: Option<&str>,
    values: &[(String, String)],
) -> Result<Program, ProgramError> {
    if stage == Stage::Geometry {
        let language = text.written().name();
        let what = match text.written().is_compiled() {
            true => format!("a geometry stage in {language}, which is not run; test its vertices by a vertex stage"),
            false => format!("a geometry stage in {language}, which has none"),
        };
        return Err(ProgramError::Unsupported { what });
    }
    let chosen = match name {
        Some(name) if stage == Stage::Function => Chosen::Function(name),
        _ => Chosen::Point { stage: stage.of_text(), name },
    };
    text.program(chosen, values)
}

/// The stage that a text is read for.
fn stage_of(suite: &Suite, shader: &SourceFile, function: Option<&str>) -> syntax::Stage {
    match suite.stage {
        Stage::Vertex if function.is_none() => syntax::Stage::Vertex,
        Stage::Geometry if function.is_none() => syntax::Stage::Geometry,
        Stage::Fragment if function.is_none() => syntax::Stage::Fragment,
        Stage::Compute => syntax::Stage::Compute,
        Stage::Vertex | Stage::Geometry | Stage::Fragment | Stage::Function => {
            syntax::Stage::from_path(shader.name()).unwrap_or(syntax::Stage::Library)
        }
    }
}

/// What a suite says is expected of its program.
fn expected(suite: &Suite, shader: &SourceFile, program: &Program) -> Result<Expectation, RunError> {
    let name = || suite.name.clone();
    let unfit =
        |source| RunError::Reference { suite: name(), shader: shader.name().to_owned(), source: Box::new(source) };
    let unread = |file: &str| RunError::Program {
        suite: name(),
        source: ProgramError::Internal(format!("`{file}` has not been read")),
    };
    match &suite.expect {
        Expect::Formula(formula) => {
            // The suite file was checked against the registry when it was read.
            let formula = crate::catalogue::formula(formula).ok_or_else(|| RunError::Program {
                suite: name(),
                source: ProgramError::Internal(format!("there is no formula `{formula}`")),
            })?;
            Ok((Reference::new(formula, program).map_err(unfit)?, Vec::new()))
        }
        Expect::Reference(ReferenceFile { file, function, output, groups, text, at: _ }) => {
            let text = text.as_ref().ok_or_else(|| unread(file))?;
            let entry = function.as_deref().or(suite.entry.as_deref());
            // Hosts put a version in front of a text, and a suite has no place for one.
            let stage = match suite.stage {
                Stage::Compute if function.is_some() => syntax::Stage::Library,
                _ => stage_of(suite, text, entry),
            };
            let first = || Some(syntax::Shader::parse(shader, stage_of(suite, shader, None)).shader.version().clone());
            let text = &match Written::of(text) {
                Written::Glsl => syntax::fitting(text, stage, &suite.chosen, first),
                Written::Wgsl | Written::SpirV | Written::SpirVAssembly | Written::Hlsl | Written::Slang => {
                    text.clone()
                }
            };
            let mut model = other(suite, text, function.as_deref(), groups).map_err(|source| {
                let source = match source {
                    ProgramError::Source(found) => {
                        ProgramError::Source(found.into_iter().map(|d| suite.includes.explained(d)).collect())
                    }
                    other => other,
                };
                RunError::ReferenceProgram { suite: name(), source }
            })?;
            model = model.run_as(program);
            // A reference may do without some of them.
            super::super::textures::bind(suite, &mut model, false)
                .map_err(|source| RunError::Texture { suite: name(), source })?;
            let by = match function {
                Some(function) => format!("the reference `{function}` of {}", text.name()),
                None => format!("the reference {}", text.name()),
            };
            Ok((Reference::model(&model, &by, output.as_deref(), program).map_err(unfit)?, Vec::new()))
        }
        Expect::Recorded(recorded) => {
            let (invocation, case) = (Arc::new(program.invocation_record()), Arc::new(program.case_record()));
            let output = program.output_layout().vertex;
            let interface = Interface { invocation: &invocation, case: &case, output: &output };
            if recorded.is_arrays() {
                let path = recorded.path_for(&suite.chosen);
                let archive = recorded.archives.iter().find(|(file, _)| *file == path).ok_or_else(|| unread(&path))?;
                let rows = record::rows_of_arrays(recorded, &archive.0, &archive.1, &interface, suite);
                return rows_of(&path, rows, program).map_err(|error| error.into_run_error(&unfit));
            }
            let text = recorded.text.as_ref().ok_or_else(|| unread(&recorded.file))?;
            let rows = record::rows(recorded, text, &interface);
            rows_of(text.name(), rows, program).map_err(|error| error.into_run_error(&unfit))
        }
        Expect::Nothing => Ok((Reference::nothing(program), Vec::new())),
    }
}

/// What can be wrong with recorded values.
enum RowsError {
    File(Vec<Problem>),
    Fit(ReferenceError),
}

impl RowsError {
    fn into_run_error(self, unfit: &dyn Fn(ReferenceError) -> RunError) -> RunError {
        match self {
            Self::File(problems) => RunError::Recorded { problems },
            Self::Fit(error) => unfit(error),
        }
    }
}

fn rows_of(
    name: &str,
    rows: Result<(Vec<String>, Vec<RecordedRow>), Vec<Problem>>,
    program: &Program,
) -> Result<Expectation, RowsError> {
    let (outputs, rows) = rows.map_err(RowsError::File)?;
    let samples = rows.iter().map(|row| row.sample.clone()).collect();
    let by = format!("the record {name}");
    let record = Recorded::new(by, outputs, rows).map_err(RowsError::Fit)?;
    Ok((Reference::recorded(record, program).map_err(RowsError::Fit)?, samples))
}
