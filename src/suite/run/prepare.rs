//! A suite and its shader made ready, whatever the lane.

use std::sync::Arc;

use thiserror::Error;

use crate::diagnostic::Diagnostic;
use crate::glsl;
use crate::lower::Target;
use crate::program::{Kernel, Program, ProgramError};
use crate::property::{Plan, PlanError, Relation, relations};
use crate::suite::{Stage, Suite};
use crate::text::SourceFile;
use crate::verdict::{Oracle, Reference, ReferenceError};

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
    /// The formula does not fit the shader.
    #[error("suite `{suite}`, {shader}: {source}")]
    Reference {
        /// Name of the suite.
        suite: String,
        /// The shader.
        shader: String,
        /// Why.
        source: Box<ReferenceError>,
    },
    /// The inputs of the suite do not fit the shader.
    #[error("suite `{suite}`, {shader}: {source}")]
    Plan {
        /// Name of the suite.
        suite: String,
        /// The shader.
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
    /// The formula, bound to the program.
    pub reference: Reference,
    /// What fills the inputs.
    pub plan: Arc<Plan>,
    /// The relations that the suite names.
    pub relations: Vec<&'static dyn Relation>,
    /// What the program means.
    pub oracle: Oracle,
}

/// Reads, lowers, translates and captures the shader of a suite, and binds formula and inputs to it.
///
/// # Errors
/// [`RunError`]: what does not fit.
pub fn prepare(suite: &Suite, shader: &SourceFile) -> Result<Prepared, RunError> {
    let name = || suite.name.clone();
    let stage = match suite.stage {
        Stage::Vertex => glsl::Stage::Vertex,
        Stage::Geometry => glsl::Stage::Geometry,
        Stage::Function => glsl::Stage::from_path(shader.name()).unwrap_or(glsl::Stage::Library),
    };
    let target = match &suite.entry {
        Some(entry) => Target::Function(entry.clone()),
        None => Target::Stage,
    };
    let captured = |source| match source {
        ProgramError::Source(diagnostics) => RunError::Shader { suite: name(), diagnostics },
        source => RunError::Program { suite: name(), source },
    };
    let program = Program::from_source(shader, stage, |_| Ok(target)).map_err(captured)?;
    let compute = program.compute_kernel().map_err(captured)?;
    let vertex = match suite.stage {
        Stage::Vertex => Some(program.vertex_kernel(&super::finding::components(suite, &program)).map_err(captured)?),
        Stage::Geometry | Stage::Function => None,
    };
    let shader_name = || shader.name().to_owned();
    // The suite file was checked against the registry when it was read.
    let formula = crate::formula::by_name(&suite.formula).ok_or_else(|| RunError::Program {
        suite: name(),
        source: ProgramError::Internal(format!("there is no formula `{}`", suite.formula)),
    })?;
    let reference = Reference::new(formula, &program).map_err(|source| RunError::Reference {
        suite: name(),
        shader: shader_name(),
        source: Box::new(source),
    })?;
    let plan = suite.plan(&compute.invocation, &compute.case).map_err(|source| RunError::Plan {
        suite: name(),
        shader: shader_name(),
        source: Box::new(source),
    })?;
    let oracle = Oracle::new(&program).map_err(|error| RunError::Program {
        suite: name(),
        source: ProgramError::Unsupported { what: error.locate(&program) },
    })?;
    Ok(Prepared {
        oracle,
        relations: suite.relations.iter().filter_map(|r| relations::by_name(r)).collect(),
        suite: suite.clone(),
        shader: shader_name(),
        plan: Arc::new(plan),
        program,
        compute,
        vertex,
        reference,
    })
}
