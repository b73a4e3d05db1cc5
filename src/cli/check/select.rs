//! Which suites are meant.

use std::path::{Path, PathBuf};

use anyhow::Context;

use crate::property::regressions::Regression;
use crate::suite::{self, Suite};
use crate::text::SourceFile;

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

/// Ending of a suite file.
const ENDING: &str = ".suite.toml";

/// The suites that the arguments name; all shipped ones without arguments.
pub fn select(arguments: &[String]) -> anyhow::Result<Vec<Selected>> {
    if arguments.is_empty() {
        return suite::shipped().iter().map(shipped).collect();
    }
    let mut selected = Vec::new();
    for argument in arguments {
        let path = Path::new(argument);
        // A shipped suite goes before a file of that name: names are what the manual shows.
        match suite::find(argument) {
            Ok(found) => selected.push(shipped(found)?),
            Err(_) if path.is_dir() => {
                let mut files = Vec::new();
                walk(path, &mut files)?;
                anyhow::ensure!(!files.is_empty(), "`{argument}` holds no suite file (*{ENDING})");
                for file in files {
                    selected.push(from_file(&file)?);
                }
            }
            Err(_) if argument.ends_with(".toml") || path.exists() => selected.push(from_file(path)?),
            Err(_) if argument.contains(['.', '/', '\\']) => {
                anyhow::bail!("there is no file or folder `{argument}`, and suites have no such names")
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

fn from_file(path: &Path) -> anyhow::Result<Selected> {
    let name = path.display().to_string();
    anyhow::ensure!(
        name.ends_with(".toml"),
        "`{name}` is no suite file; to run a shader under a suite, write `check SUITE --shader {name}`"
    );
    let loaded = suite::load(path)?;
    let regressions = suite::regressions_path(path);
    let saved = suite::read_regressions(&regressions)?;
    Ok(Selected { suite: loaded.suite, shader: loaded.shader, argument: name, regressions: Some(regressions), saved })
}

/// Suite files below a folder, sorted. Hidden folders and build folders are left out.
fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    let context = || format!("cannot read the folder `{}`", folder.display());
    let mut entries: Vec<_> =
        std::fs::read_dir(folder).and_then(Iterator::collect::<Result<_, _>>).with_context(context)?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        // A link to a folder is not followed: it may lead back here.
        if entry.file_type().with_context(context)?.is_dir() {
            if !name.starts_with('.') && name != "target" && name != "node_modules" {
                walk(&path, files)?;
            }
        } else if name.ends_with(ENDING) {
            files.push(path);
        }
    }
    Ok(())
}
