//! What data are asked for: suites, and shaders that have none.

use std::io::Write;
use std::path::Path;

use super::generate::GenerateArgs;
use crate::cli::check::select::{self, Selected};
use crate::cli::compose::Given;
use crate::cli::{fuzz, includes, inputs};
use base::diagnostic::Lang;
use base::text::Shown as _;
use engine::suite::{self, Expect};
use refdata::{Bare, Origin};

use syntax::Stage;

/// Samples of a function without a suite, as of `fuzz`.
pub const SAMPLES: u64 = 1 << 16;

/// One data set.
pub enum Item {
    /// Of a suite.
    Suite(Box<Selected>),
    /// Of a function or stage without one.
    Bare(Box<Bare>),
}

impl Item {
    /// Its name.
    pub fn name(&self) -> &str {
        match self {
            Self::Suite(selected) => &selected.suite.name,
            Self::Bare(bare) => bare.name(),
        }
    }

    /// The formula that it is about, by name.
    pub fn formula(&self) -> &str {
        match self {
            Self::Suite(selected) => match &selected.suite.expect {
                Expect::Formula(name) => name,
                Expect::Reference(_) | Expect::Recorded(_) | Expect::Nothing => &selected.suite.name,
            },
            Self::Bare(bare) => bare.name(),
        }
    }
}

/// What the arguments name, in their order.
///
/// # Errors
/// When a name is unknown, or a file is wrong.
pub fn items(args: &GenerateArgs, err: &mut dyn Write) -> anyhow::Result<Vec<Item>> {
    let stated = inputs::domains(&args.domain)?;
    let mut inputs = fuzz::Inputs::new(&stated);
    let (mut items, mut known, mut bare) = (Vec::new(), Vec::new(), false);
    for argument in &args.suites {
        let path = Path::new(argument);
        let is_shader = path.is_file() && !argument.ends_with(".toml") && suite::find(argument).is_err();
        let selected =
            if is_shader { select::beside(path)? } else { select::select(std::slice::from_ref(argument), false)? };
        // Who names a function or a domain means the shader, not its suites.
        let wants_bare = is_shader && (selected.is_empty() || !args.function.is_empty() || !args.domain.is_empty());
        if wants_bare {
            bare = true;
            items.extend(functions(args, path, &mut inputs, &mut known, err)?);
        } else {
            items.extend(selected.into_iter().map(|selected| Item::Suite(Box::new(selected))));
        }
    }
    anyhow::ensure!(
        bare || (args.function.is_empty() && args.domain.is_empty() && args.include.is_empty()),
        "--function, --domain and --include are about shaders without a suite; a suite says what it runs and on which \
         inputs"
    );
    if bare {
        fuzz::all_known(&args.function, &known)?;
        inputs.all_used()?;
    }
    Ok(items)
}

/// The functions of a shader, or its stage.
fn functions(
    args: &GenerateArgs,
    path: &Path,
    inputs: &mut fuzz::Inputs<'_>,
    known: &mut Vec<String>,
    err: &mut dyn Write,
) -> anyhow::Result<Vec<Item>> {
    let name = path.shown();
    let source = includes::read(path, &Given { folders: &args.include, ..Given::default() })?;
    let before = known.len();
    let (errors, subjects) = fuzz::subjects((&args.function, &[]), &source, known)?;
    for error in &errors {
        err.write_all(report::diagnostics::text(error, Lang::En, false).as_bytes())?;
    }
    anyhow::ensure!(errors.is_empty(), "`{name}` does not compile");
    anyhow::ensure!(
        known.len() > before,
        "`{name}` is no suite file, no suite beside it is about it, and it has no function with a body"
    );
    let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let is_stage = source.stage != Stage::Library;
    let mut items = Vec::new();
    let mut left_out = Vec::new();
    for subject in subjects {
        let label = subject.label.clone();
        let whole = is_stage && label == "main";
        // A stage is a data set as a whole; its functions are only taken when they are asked for.
        if is_stage && !whole && args.function.is_empty() {
            continue;
        }
        let own = if whole { file.clone() } else { format!("{file}.{label}") };
        let point = subject.ready.as_ref().map_or(Stage::Library, |ready| ready.program.stage);
        let stage = match point {
            _ if whole => source.stage.name(),
            Stage::Library => "function",
            stage if source.stage == Stage::Library => stage.name(),
            _ => "function",
        };
        let origin = Origin { name: &own, shader: &file, text: source.file.text(), stage };
        let domain = inputs.domain(&subject)?;
        match Bare::new(&origin, subject, domain) {
            Ok(bare) => items.push(Item::Bare(Box::new(bare))),
            Err(why) => left_out.push(format!("`{label}` of {name}: {why}")),
        }
    }
    anyhow::ensure!(!items.is_empty() || left_out.is_empty(), "nothing can be generated: {}", left_out.join("; "));
    for why in left_out {
        writeln!(err, "left out: {why}")?;
    }
    anyhow::ensure!(
        !items.is_empty() || known.len() > before && !args.function.is_empty(),
        "`{name}` has no `main`; --function names a function of it"
    );
    Ok(items)
}
