//! Suites: a shader, the domain of its inputs, the formula that says what it should compute, and
//! how strictly it is judged. A suite is a TOML file beside its shader.

mod compiled;
mod dispatch;
pub mod draft;
mod error;
mod expect;
pub mod expectations;
mod files;
mod includes;
mod joined;
mod keys;
mod module;
mod parse;
mod record;
pub mod run;
mod shipped;
mod textures;

use std::collections::HashSet;
use std::sync::Arc;

use base::text::SourceFile;
use base::value::{Field, Record, Scalar};
use judge::verdict::Literals;
use lanes::{Lane, Stage as LaneStage};
use program::Program;
use property::generators::{self, Options, Strands};
use property::law::Law;
use property::{InputGroup, Own, Plan, PlanError};

pub use compiled::Asked;
pub use dispatch::{Count, Dispatching};
pub use error::{LoadError, RunTextureError, SuiteError};
pub use expect::{Define, Defines, Expect, RecordedFile, ReferenceFile, combinations};
pub use files::{
    ENDING, Loaded, expectations_path, load_all, read_expectations, read_regressions, read_shader, regressions_path,
    save_regressions, search,
};
pub use includes::Includes;
pub use joined::Joined;
pub use keys::{page, schema};
pub use module::read_module;
pub use parse::{Names, parse, parse_all, parse_with};
pub use record::rows;
pub use shipped::{ShippedSuite, UnknownSuite, find, shipped};
pub use textures::{BoundTexture, Contents};

/// What kind of code a suite tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// A vertex shader: `main` is run for vertices.
    Vertex,
    /// A geometry shader: `main` is run for primitives.
    Geometry,
    /// A fragment shader: `main` is run for interpolated inputs.
    Fragment,
    /// A compute shader: one sample is a whole dispatch.
    Compute,
    /// A single function, called with arguments.
    Function,
}

impl Stage {
    /// The stage of an entry point; none for a function, and for one that modules are not run for.
    pub(crate) fn of_text(self) -> Option<syntax::Stage> {
        match self {
            Self::Vertex => Some(syntax::Stage::Vertex),
            Self::Fragment => Some(syntax::Stage::Fragment),
            Self::Compute => Some(syntax::Stage::Compute),
            Self::Geometry | Self::Function => None,
        }
    }

    /// All stages.
    pub const ALL: [Self; 5] = [Self::Vertex, Self::Geometry, Self::Fragment, Self::Compute, Self::Function];

    /// `vertex`, `geometry`, `fragment`, `compute` or `function`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::Geometry => "geometry",
            Self::Fragment => "fragment",
            Self::Compute => "compute",
            Self::Function => "function",
        }
    }
}

/// What a run must reach so that its success means something.
#[derive(Clone, Debug, PartialEq)]
pub struct Floors {
    /// Samples that have to be judged at least, when all samples of the suite are run.
    pub judged: u64,
    /// Largest share of samples that may stay undetermined, 0 to 1.
    pub undetermined: f64,
    /// Why more than the usual share may; empty for a suite that allows no more.
    pub reason: String,
}

impl Floors {
    /// The floors of a suite that states none.
    pub fn default_for(samples: u64) -> Self {
        let floors = Self { judged: 0, undetermined: parse::UNDETERMINED, reason: String::new() };
        Self { judged: floors.required(samples), ..floors }
    }

    /// Samples that are left when as many are undetermined as may be; at least 1.
    fn required(&self, samples: u64) -> u64 {
        (((1.0 - self.undetermined) * samples as f64).floor() as u64).max(1)
    }

    /// Samples that have to be judged when only `samples` of `of` are run: the same share.
    pub fn judged_of(&self, samples: u64, of: u64) -> u64 {
        let share = u128::from(self.judged) * u128::from(samples) / u128::from(of.max(1));
        u64::try_from(share).unwrap_or(u64::MAX)
    }
}

/// Inputs whose values were guessed from names, types and uses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GuessedInputs {
    /// Their names.
    pub names: Vec<String>,
    /// `file:line:column` of the line to delete once the values are those that programs give.
    pub at: String,
}

/// A suite as its file states it.
#[derive(Clone, Debug)]
pub struct Suite {
    /// Name, as on the command line.
    pub name: String,
    /// What is tested, in a few words.
    pub title: String,
    /// File name of the shader, relative to the suite file.
    pub shader: String,
    /// File names of other texts of the same stage, relative to the suite file.
    pub linked: Vec<String>,
    /// These texts, in order; as many as there are names once the suite is loaded.
    pub linked_texts: Vec<SourceFile>,
    /// File names of texts in WGSL from which the shader takes what it does not declare, relative to the suite file.
    pub with: Vec<String>,
    /// These texts, in order; as many as there are names once the suite is loaded.
    pub with_texts: Vec<SourceFile>,
    /// Whether resources of a text in WGSL get a group and a binding where none of them has one.
    pub assign_bindings: bool,
    /// What kind of code is tested.
    pub stage: Stage,
    /// The function that is called; for the stage `function` alone.
    pub entry: Option<String>,
    /// What gives the expected outputs.
    pub expect: Expect,
    /// Macros with the values that they take: each combination is run.
    pub defines: Vec<Define>,
    /// The macros of this variant of the shader.
    pub chosen: Defines,
    /// Samples of a full run; at least 1.
    pub samples: u64,
    /// Invocations that share one set of uniforms; at least 1.
    pub per_case: usize,
    /// Names of relations that are checked.
    pub relations: Vec<String>,
    /// Laws that are checked.
    pub laws: Vec<Law>,
    /// Functions that are run one after the other, where there are several.
    pub entries: Vec<String>,
    /// What fills the inputs. Of several functions, each takes the groups of its own parameters.
    pub inputs: Vec<InputGroup>,
    /// Inputs whose values nobody stated: `init` guessed them.
    pub guessed: Vec<GuessedInputs>,
    /// What a run must reach.
    pub floors: Floors,
    /// What is made of literals that are known constants in few digits.
    pub literals: Literals,
    /// What samplers are bound to, where the suite says so.
    pub textures: Vec<BoundTexture>,
    /// Strands of which a geometry stage sees windows.
    pub strands: Option<Strands>,
    /// How a compute stage is dispatched.
    pub dispatch: Dispatching,
    /// Where files are looked for that the shader includes.
    pub includes: Includes,
    /// The text of the suite file.
    pub file: SourceFile,
}

impl Suite {
    /// The stages of a lane in which the suite runs. A function has no stage: it runs as compute, or in the vertex stage
    /// of a lane that offers that instead.
    pub fn stages(&self, lane: &dyn Lane) -> Vec<LaneStage> {
        if self.stage == Stage::Compute {
            return if lane.dispatches() { vec![LaneStage::Compute] } else { Vec::new() };
        }
        let runs = |stage: &LaneStage| match stage {
            LaneStage::Compute => true,
            LaneStage::Vertex => {
                self.stage == Stage::Vertex || (self.stage == Stage::Function && lane.calls_functions())
            }
            LaneStage::Geometry => self.stage == Stage::Geometry,
        };
        lane.description().stages.iter().copied().filter(runs).collect()
    }

    /// The suite once for each of its functions and each combination of its macros, under a name that tells
    /// them apart.
    pub fn variants(&self) -> Vec<Self> {
        let entries: Vec<Option<&String>> = match &self.entries[..] {
            [] => vec![None],
            several => several.iter().map(Some).collect(),
        };
        let variant = |entry: Option<&String>, words: Vec<String>, chosen: Defines| {
            let words: Vec<String> = entry.cloned().into_iter().chain(words).collect();
            let name = if words.is_empty() { String::new() } else { format!("[{}]", words.join(",")) };
            let mut inputs = self.inputs.clone();
            self.dispatch.settle(&mut inputs, &chosen);
            Self {
                name: format!("{}{name}", self.name),
                entry: entry.or(self.entry.as_ref()).cloned(),
                defines: Vec::new(),
                chosen,
                inputs,
                ..self.clone()
            }
        };
        let matrix: Vec<Define> = self.defines.iter().chain(&self.dispatch.sizes).cloned().collect();
        let of_entry = |entry: Option<&String>| -> Vec<Self> {
            combinations(&matrix).into_iter().map(|(words, chosen)| variant(entry, words, chosen)).collect()
        };
        entries.into_iter().flat_map(of_entry).collect()
    }

    /// Fits the suite to the inputs of its shader: `invocation` holds attributes, inputs of a
    /// primitive or arguments, `case` the uniforms.
    ///
    /// # Errors
    /// The first input or group that does not fit, with its place in the suite file.
    pub fn plan(&self, invocation: &Arc<Record>, case: &Arc<Record>) -> Result<Plan, PlanError> {
        let known = |name: &String| invocation.index_of(name).or(case.index_of(name)).is_some();
        let groups: Vec<InputGroup> = match self.entries.is_empty() {
            true => self.inputs.clone(),
            // Parameters of the other functions are not missed here.
            false => self.inputs.iter().filter(|group| group.names.iter().any(known)).cloned().collect(),
        };
        Plan::new(&groups, invocation.clone(), case.clone())
    }

    /// The same for a program, whose numbers of the draw have values of their own where the suite says nothing of them.
    ///
    /// # Errors
    /// As of [`Suite::plan`].
    pub fn plan_for(&self, program: &Program, invocation: &Arc<Record>, case: &Arc<Record>) -> Result<Plan, PlanError> {
        let fields = || invocation.fields().iter().chain(case.fields());
        let inputs: Vec<InputGroup> = self.inputs.iter().map(|group| group.over(fields())).collect();
        let names: HashSet<&str> = inputs.iter().flat_map(|group| &group.names).map(String::as_str).collect();
        let stated = |name: &str| names.contains(name);
        let number = |field: &Field| {
            let most = program.largest(&field.name).filter(|_| !stated(&field.name))?;
            Some(InputGroup {
                names: vec![field.name.clone()],
                generator: Own::Static(generators::by_name("index")?),
                options: Options { range: Some([0.0, f64::from(most)]), ..Options::default() },
                at: self.name.clone(),
            })
        };
        // What a buffer holds before it is written must not matter, unless the suite says what that is.
        let before = |field: &Field| {
            let outside = program.dispatch.is_some() && !stated(&field.name);
            let written = || program.outputs.iter().any(|port| port.field.name == field.name);
            let (generator, range) = match field.shape.scalar {
                Scalar::F32 => ("interval", [-1e3, 1e3]),
                Scalar::I32 | Scalar::U32 | Scalar::Bool => ("index", [0.0, 1e3]),
            };
            (outside && written()).then_some(())?;
            Some(InputGroup {
                names: vec![field.name.clone()],
                generator: Own::Static(generators::by_name(generator)?),
                options: Options { range: Some(range), ..Options::default() },
                at: self.name.clone(),
            })
        };
        let numbers = invocation.fields().iter().filter_map(|field| number(field).or_else(|| before(field)));
        let suite = Self { inputs: inputs.iter().cloned().chain(numbers).collect(), ..self.clone() };
        suite.plan(invocation, case)
    }

    /// How many floats the host feeds for an attribute; `None` when the suite does not say, which
    /// means all of them.
    pub fn components(&self, input: &str) -> Option<u8> {
        let group = self.inputs.iter().find(|g| g.names.iter().any(|n| n == input));
        group.and_then(|g| g.options.components)
    }

    /// Cases that hold `samples` invocations: rounded up, at least 1.
    pub fn cases(&self, samples: u64) -> u64 {
        samples.div_ceil(self.per_case.max(1) as u64).max(1)
    }
}

#[cfg(test)]
mod tests;
