//! The builder.

use std::path::Path;
use std::sync::Arc;

use base::text::SourceFile;
use engine::suite::{self, Includes, Stage};
use judge::verdict::Given;
use program::Written;
use property::Sample;

use crate::{Domain, Error, Inputs, Law, Outcome, run};

/// A shader under test: what is run of it, on which inputs, and what is expected.
///
/// Expectations are in `f64`, and no tolerance is stated: the meaning of the shader in real numbers is
/// compared with them, and every lane with that meaning, within what its API allows. The names of inputs
/// are those of attributes, uniforms and parameters; the name of a function's value is `return`.
///
/// ```
/// use shadercheck_test::Shader;
///
/// Shader::from_text("smooth.glsl", "float smooth3(float t) { return t * t * (3.0 - 2.0 * t); }")
///     .function("smooth3")
///     .input("t", 0.0..=1.0)
///     .expect("return", |inputs| {
///         let t = inputs.number("t");
///         vec![3.0 * t.powi(2) - 2.0 * t.powi(3)]
///     })
///     .lane("embedded")
///     .samples(512)
///     .assert_agrees();
/// ```
///
/// A test fails like any other, with the smallest inputs that show the fault:
///
/// ```should_panic
/// use shadercheck_test::Shader;
///
/// Shader::from_text("smooth.glsl", "float smooth3(float t) { return t * t * (3.0 - 2.1 * t); }")
///     .function("smooth3")
///     .input("t", 0.0..=1.0)
///     .expect("return", |inputs| {
///         let t = inputs.number("t");
///         vec![3.0 * t.powi(2) - 2.0 * t.powi(3)]
///     })
///     .lane("embedded")
///     .assert_agrees();
/// ```
#[derive(Clone, Debug)]
#[must_use = "nothing is run before `check` or `assert_agrees`"]
pub struct Shader {
    pub(crate) file: SourceFile,
    pub(crate) includes: Includes,
    pub(crate) stage: Stage,
    pub(crate) entry: Option<String>,
    pub(crate) defines: Vec<(String, String)>,
    pub(crate) inputs: Vec<(String, Domain)>,
    pub(crate) guess: bool,
    pub(crate) given: Vec<Given>,
    pub(crate) reference: Option<Other>,
    pub(crate) laws: Vec<Law>,
    pub(crate) samples: u64,
    pub(crate) seed: u64,
    pub(crate) lanes: Vec<String>,
    pub(crate) case: Option<String>,
    pub(crate) undetermined: f64,
}

/// Another shader that says what is right.
#[derive(Clone, Debug)]
pub(crate) struct Other {
    pub file: SourceFile,
    pub function: Option<String>,
    pub output: Option<String>,
}

/// Samples that are run when nothing else is said.
const SAMPLES: u64 = 4096;

impl Shader {
    /// A shader by its text. The name stands in messages, and its extension tells the stage, as of a file:
    /// `.vert` and `.geom`; of all others a function is run.
    pub fn from_text(name: impl AsRef<str>, text: impl AsRef<str>) -> Self {
        Self::of(SourceFile::new(name.as_ref(), text.as_ref()))
    }

    /// A shader in a file, in any encoding that `shadercheck` reads, with the files beside it that it includes. A relative path starts at the current
    /// folder, which in tests of cargo is that of the package.
    ///
    /// # Errors
    /// When the file cannot be read, or is no text.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::from_file_with(path, [] as [&Path; 0])
    }

    /// The same with folders in which files are looked for that the shader includes. Those beside the file
    /// that includes them are found without it.
    ///
    /// # Errors
    /// As of [`Shader::from_file`], of included files too.
    pub fn from_file_with<P: AsRef<Path>>(
        path: impl AsRef<Path>,
        include: impl IntoIterator<Item = P>,
    ) -> Result<Self, Error> {
        let folders = include.into_iter().map(|folder| folder.as_ref().to_owned()).collect();
        let mut includes = Includes::new(folders, "`Shader::from_file_with`");
        let file = suite::read_shader(path.as_ref(), &mut includes).map_err(|error| Error::new(error.to_string()))?;
        Ok(Self { includes, ..Self::of(file) })
    }

    fn of(file: SourceFile) -> Self {
        let stage = match syntax::Stage::from_path(file.name()) {
            Some(syntax::Stage::Vertex) => Stage::Vertex,
            Some(syntax::Stage::Geometry) => Stage::Geometry,
            Some(syntax::Stage::Fragment) => Stage::Fragment,
            Some(
                syntax::Stage::Compute
                | syntax::Stage::TessControl
                | syntax::Stage::TessEvaluation
                | syntax::Stage::Library,
            )
            | None => Stage::Function,
        };
        Self {
            file,
            includes: Includes::default(),
            stage,
            entry: None,
            defines: Vec::new(),
            inputs: Vec::new(),
            guess: false,
            given: Vec::new(),
            reference: None,
            laws: Vec::new(),
            samples: SAMPLES,
            seed: suite::run::DEFAULT_SEED,
            lanes: Vec::new(),
            case: None,
            undetermined: 0.05,
        }
    }

    /// Runs one function, with its parameters as inputs.
    pub fn function(mut self, name: impl Into<String>) -> Self {
        self.stage = Stage::Function;
        self.entry = Some(name.into());
        self
    }

    /// Runs the vertex stage, whatever the file is called.
    pub fn vertex(mut self) -> Self {
        self.stage = Stage::Vertex;
        self.entry = None;
        self
    }

    /// Runs the geometry stage, whatever the file is called.
    pub fn geometry(mut self) -> Self {
        self.stage = Stage::Geometry;
        self.entry = None;
        self
    }

    /// Runs the fragment stage, whatever the file is called: as a function of its interpolated inputs. Samplers
    /// are bound to small textures whose texels all differ.
    pub fn fragment(mut self) -> Self {
        self.stage = Stage::Fragment;
        self.entry = None;
        self
    }

    /// Runs the entry point of this name, of a text that has several: WGSL. Its stage is that of the text.
    pub fn entry_point(mut self, name: impl Into<String>) -> Self {
        let name = name.into();
        let points = match Written::of(&self.file) {
            Written::Glsl => Vec::new(),
            Written::Wgsl | Written::SpirV | Written::SpirVAssembly | Written::Hlsl | Written::Slang => {
                suite::read_module(&self.file).map_or_else(|_| Vec::new(), |text| text.points())
            }
        };
        // What cannot be read, or is not there, is told when it is run.
        self.stage = match points.iter().find(|point| point.name == name).map(|point| point.stage) {
            Some(syntax::Stage::Fragment) => Stage::Fragment,
            _ => Stage::Vertex,
        };
        self.entry = Some(name);
        self
    }

    /// Defines a macro, as an option of a compiler does, or the value of an `override` constant of WGSL.
    pub fn define(mut self, name: impl Into<String>, value: impl ToString) -> Self {
        self.defines.push((name.into(), value.to_string()));
        self
    }

    /// The values that an input takes; the last ones that are said count. Every input needs some, unless
    /// [`Shader::guess_inputs`] is asked for.
    pub fn input(mut self, name: impl Into<String>, domain: impl Into<Domain>) -> Self {
        let name = name.into();
        self.inputs.retain(|(known, _)| *known != name);
        self.inputs.push((name, domain.into()));
        self
    }

    /// Guesses the values of all other inputs from their names and types, as `shadercheck init` does:
    /// normals are directions, weights add up to one, colours are from 0 to 1.
    pub fn guess_inputs(mut self) -> Self {
        self.guess = true;
        self
    }

    /// What an output should be: its components as a function of the inputs. NaN stands for an output
    /// without a value, which is inconclusive. Outputs that are not mentioned are compared with the
    /// shader's own meaning alone.
    pub fn expect(
        mut self,
        output: impl Into<String>,
        rule: impl Fn(Inputs<'_>) -> Vec<f64> + Send + Sync + 'static,
    ) -> Self {
        let output = output.into();
        let name = output.clone();
        let rule = move |sample: &Sample, words: &mut [f64]| {
            let values = rule(Inputs { sample });
            let (given, wanted) = (values.len(), words.len());
            assert_eq!(given, wanted, "the expectation of `{name}` gives {given} components, and it has {wanted}");
            words.copy_from_slice(&values);
        };
        self.given.push(Given { output, rule: Arc::new(rule) });
        self
    }

    /// Expects what another shader means: the same stage, or the function of the same name. Inputs and
    /// outputs are found by their names, parameters of functions else by their order.
    pub fn reference(mut self, other: &Self) -> Self {
        self.reference = Some(Other { file: other.file.clone(), function: other.entry.clone(), output: None });
        self
    }

    /// The same for a stage, one output of which is the value of a function.
    pub fn reference_of(mut self, output: impl Into<String>, other: &Self) -> Self {
        self.reference =
            Some(Other { file: other.file.clone(), function: other.entry.clone(), output: Some(output.into()) });
        self
    }

    /// Checks a law.
    pub fn law(mut self, law: Law) -> Self {
        self.laws.push(law);
        self
    }

    /// Samples that are run; 4096 without it.
    pub fn samples(mut self, samples: u64) -> Self {
        self.samples = samples.max(1);
        self
    }

    /// Seed of the inputs: the same seed gives the same inputs everywhere.
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Runs on this lane (`vulkan`, `embedded`), and on others that are named so. Without it, on every
    /// device that is available, and on the embedded lane where there is none.
    pub fn lane(mut self, name: impl Into<String>) -> Self {
        self.lanes.push(name.into());
        self
    }

    /// Share of samples that may be inconclusive; 0.05 without it.
    pub fn undetermined(mut self, share: f64) -> Self {
        self.undetermined = share.clamp(0.0, 1.0);
        self
    }

    /// Runs one case alone, as a report gives it: `x=3f800000`.
    pub fn case(mut self, inputs: impl Into<String>) -> Self {
        self.case = Some(inputs.into());
        self
    }

    /// Runs the check.
    ///
    /// # Errors
    /// [`Error`] when nothing could be checked: the shader does not compile or cannot be run, inputs or
    /// outputs do not fit it, no lane is available.
    pub fn check(&self) -> Result<Outcome, Error> {
        run::check(self)
    }

    /// Runs the check, and panics with the report when something is wrong.
    ///
    /// # Panics
    /// When the shader deviates, a law does not hold, too little was judged, or nothing could be checked.
    #[track_caller]
    pub fn assert_agrees(&self) {
        match self.check() {
            Ok(outcome) => assert!(outcome.passed(), "{} does not agree\n\n{}", self.file.name(), outcome.report()),
            Err(error) => panic!("{} cannot be checked: {error}", self.file.name()),
        }
    }
}
