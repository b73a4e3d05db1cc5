//! Which suites are meant.

use std::path::{Path, PathBuf};

use anyhow::Context;

use base::text::{Shown, SourceFile, printable};
use engine::suite::{self, Suite};
use property::regressions::Regression;

/// A suite that is to be run.
pub struct Selected {
    /// The suite.
    pub suite: Suite,
    /// Its shader.
    pub shader: SourceFile,
    /// How the command line names it.
    pub argument: String,
    /// Where failing cases are saved; nowhere for a shipped suite.
    pub regressions: Option<PathBuf>,
    /// Cases that failed before.
    pub saved: Vec<Regression>,
}

/// The suites that the arguments name, after those that ship where these are wanted; without either, those of the current
/// folder.
pub fn select(arguments: &[String], all_shipped: bool) -> anyhow::Result<Vec<Selected>> {
    let mut selected = Vec::new();
    if all_shipped {
        selected = suite::shipped().map(shipped).collect::<anyhow::Result<Vec<_>>>()?;
    }
    let here = [".".to_owned()];
    let arguments = if arguments.is_empty() && !all_shipped { &here } else { arguments };
    for argument in arguments {
        let path = Path::new(argument);
        // A shipped suite goes before a file of that name: names are what the manual shows.
        match suite::find(argument) {
            Ok(found) => selected.push(shipped(found)?),
            Err(_) if path.is_dir() => {
                let files = suite::search(path)?;
                anyhow::ensure!(
                    !files.is_empty(),
                    "`{0}` holds no suite file (*{1}); `shadercheck init {0}` writes first suites for its shaders, `shadercheck \
                     fuzz {0}` runs shaders without any, and --shipped runs the suites that come with shadercheck",
                    path.shown(),
                    suite::ENDING
                );
                for file in files {
                    selected.extend(from_file(&file)?);
                }
            }
            Err(_) if variant(argument).is_some() && !path.exists() => {
                if let Some((file, wanted)) = variant(argument) {
                    selected.push(one_variant(Path::new(file), wanted)?);
                }
            }
            Err(_) if argument.ends_with(".toml") || path.exists() => selected.extend(from_file(path)?),
            Err(_) if argument.contains(['.', '/', '\\']) => {
                anyhow::bail!("there is no file or folder `{}`, and suites have no such names", printable(argument))
            }
            Err(unknown) => return Err(unknown.into()),
        }
    }
    Ok(selected)
}

fn shipped(suite: &suite::ShippedSuite) -> anyhow::Result<Selected> {
    let file = SourceFile::new(format!("shaders/{}", suite.path), suite.toml);
    let folder = suite.path.rsplit_once('/').map_or("", |(folder, _)| folder);
    Ok(Selected {
        suite: suite::parse(&file)?,
        shader: SourceFile::new(format!("shaders/{folder}/{}", suite.shader_name), suite.shader_text),
        argument: suite.name.to_owned(),
        regressions: None,
        saved: Vec::new(),
    })
}

/// The suite of a file, once for each combination of its macros.
fn from_file(path: &Path) -> anyhow::Result<Vec<Selected>> {
    let name = path.display().to_string();
    if !name.ends_with(".toml") {
        return of_shader(path);
    }
    let all = suite::load_all(path)?;
    let regressions = suite::regressions_path(path);
    let saved = suite::read_regressions(&regressions)?;
    let alone = all.len() == 1;
    let of_one = |loaded: suite::Loaded| {
        let whole = loaded.suite.name.clone();
        let variants = loaded.suite.variants();
        let several = variants.len() > 1;
        let selected = |suite: Suite| {
            let variant = suite.name.strip_prefix(&whole).filter(|_| several).unwrap_or_default();
            let argument = if alone { format!("{name}{variant}") } else { format!("{name}[{}]", suite.name) };
            let (regressions, saved) = (Some(regressions.clone()), saved.clone());
            Selected { suite, shader: loaded.shader.clone(), argument, regressions, saved }
        };
        variants.into_iter().map(selected).collect::<Vec<_>>()
    };
    Ok(all.into_iter().flat_map(of_one).collect())
}

/// The suites beside a shader that are about it.
fn of_shader(path: &Path) -> anyhow::Result<Vec<Selected>> {
    let name = path.shown();
    let selected = beside(path)?;
    anyhow::ensure!(
        !selected.is_empty(),
        "`{name}` is no suite file, and no suite beside it is about it; to run a shader under a suite, write \
         `check SUITE --shader {name}`; `shadercheck init` writes a first suite"
    );
    Ok(selected)
}

/// True for a folder without a suite file, and for a shader with none beside it that is about it.
pub fn is_without_suites(path: &Path) -> bool {
    if path.is_dir() {
        return suite::search(path).is_ok_and(|files| files.is_empty());
    }
    path.extension().is_none_or(|ending| ending != "toml") && beside(path).is_ok_and(|suites| suites.is_empty())
}

/// The suites beside a shader that are about it, which may be none.
///
/// # Errors
/// When there is no such file, or the folder cannot be searched.
pub fn beside(path: &Path) -> anyhow::Result<Vec<Selected>> {
    anyhow::ensure!(path.exists(), "cannot read `{}`: there is no such file", path.shown());
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut selected = Vec::new();
    for file in suite::search(folder)? {
        // A suite that cannot be read is told when its own file or folder is asked for.
        if let Ok(all) = suite::load_all(&file)
            && all.iter().any(|loaded| same_file(Path::new(loaded.shader.name()), path))
        {
            let about = |one: &Selected| same_file(Path::new(one.shader.name()), path);
            selected.extend(from_file(&file)?.into_iter().filter(about));
        }
    }
    Ok(selected)
}

fn same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

/// One variant of a suite file, `skin.suite.toml[BONES=4]`, or one suite of several, `tone.suite.toml[tone_hue]`.
fn variant(argument: &str) -> Option<(&str, &str)> {
    let at = argument.rfind(".toml[").filter(|_| argument.ends_with(']'))? + ".toml".len();
    Some(argument.split_at(at))
}

fn one_variant(path: &Path, wanted: &str) -> anyhow::Result<Selected> {
    let all = from_file(path)?;
    let names: Vec<String> = all.iter().map(|s| s.argument.clone()).collect();
    all.into_iter()
        .find(|selected| selected.suite.name.ends_with(wanted) || selected.argument.ends_with(wanted))
        .with_context(|| format!("`{}` has no variant `{wanted}`; there are {}", path.shown(), names.join(", ")))
}
