//! `shadercheck init`: first suites for a folder of shaders.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;

use super::below;
use crate::cli::status::ExitStatus;
use base::text::{Shown, SourceFile, counted};
use disk::fresh;
use engine::suite::draft::{self, Draft, Subject};
use engine::suite::{self, Suite};
use lanes::{Lane, StandIn, Wanted};
use syntax::Stage;

/// Write a first suite for one shader, or for every shader of a folder that can run
///
/// Existing files are never overwritten.
#[derive(Args, Clone, Debug, Default)]
pub struct InitArgs {
    /// Folders to search for shader files, and shader files
    #[arg(value_name = "PATH", default_value = ".")]
    pub paths: Vec<PathBuf>,
    /// Print the JSON Schema of suite files, for editors, and write nothing
    #[arg(long)]
    pub schema: bool,
    /// Show the files without writing them
    #[arg(long, conflicts_with = "schema")]
    pub dry_run: bool,
}

/// A configuration that changes nothing, to begin with.
const CONFIGURATION: &str = "\
# Configuration of shadercheck for this folder and those below.

[lint]
level = \"default\" # strict tells also what is sometimes meant; heuristic also guesses
# ignore = [\"N014\"]
";

/// The schema of suite files, for editors that complete and check TOML.
const SCHEMA: &str = "suite.schema.json";

/// What a CI job runs.
const SNIPPET: &str = "\
# In the steps of a CI job (mesa-vulkan-drivers has lavapipe; without it the embedded lane is used):
- run: sudo apt-get install -y mesa-vulkan-drivers
- run: shadercheck lint .
- run: shadercheck check . --require-lane vulkan
";

/// Runs the command: what was written goes to `out`, what could not be to `err`.
///
/// # Errors
/// When a file cannot be read or written.
pub fn run(args: &InitArgs, out: &mut dyn Write, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    if args.schema {
        writeln!(out, "{:#}", suite::schema())?;
        return Ok(ExitStatus::Clean);
    }
    let mut places: Vec<Place> = Vec::new();
    for path in &args.paths {
        place(path, &mut places)?;
    }
    let suites: BTreeSet<PathBuf> = places.iter().flat_map(|place| place.suites.iter().cloned()).collect();
    let known: Vec<(PathBuf, Suite)> = suites.iter().flat_map(|path| about(path)).collect();
    let mut names: BTreeSet<String> = known.iter().map(|(_, suite)| suite.name.clone()).collect();
    let devices = Wanted { stand_in: StandIn::Never, ..Wanted::named(&[]) }.open()?.lanes;
    let mut written = 0;
    let shaders = places.iter().flat_map(|place| place.shaders.iter().map(move |(path, stage)| (place, path, stage)));
    for (place, path, stage) in shaders {
        // As paths of shaders are: without a leading `.`.
        let base = place.folder.strip_prefix(".").unwrap_or(&place.folder);
        let file = match super::includes::read(path, &super::compose::Given::default()) {
            Ok(source) => source.file,
            Err(error) => {
                writeln!(err, "left out: {error:#}")?;
                continue;
            }
        };
        let (subjects, rest) = draft::subjects(&file, *stage);
        if subjects.is_empty() {
            writeln!(err, "left out: {}: it has neither a stage nor a function that can be run", path.shown())?;
        }
        let mut wanted = |subject: &Subject| {
            let has = known.iter().any(|(shader, suite)| shader == path && runs(suite, subject));
            if has {
                writeln!(err, "left out: {} has a suite already", label(path, subject))?;
            }
            Ok::<bool, std::io::Error>(!has)
        };
        let mut open = Vec::new();
        for subject in subjects {
            if wanted(&subject)? {
                open.push(subject);
            }
        }
        written += u64::from(of_shader(args, (base, path, *stage, &file), (&open, &devices), &mut names, (out, err))?);
        if rest > 0 {
            writeln!(err, "left out: {rest} more functions of {}", path.shown())?;
        }
    }
    for place in &places {
        configuration(args, &place.folder, out)?;
    }
    writeln!(out, "\n{SNIPPET}")?;
    let folders: Vec<String> = places.iter().map(|place| place.folder.shown().to_string()).collect();
    writeln!(out, "Next: shadercheck check {}", folders.join(" "))?;
    writeln!(out, "`shadercheck explain suite` lists every key of a suite file.")?;
    Ok(if written == 0 && known.is_empty() { ExitStatus::Findings } else { ExitStatus::Clean })
}

/// A folder with the shaders of it that are to get suites, and all of its suites.
struct Place {
    folder: PathBuf,
    shaders: Vec<(PathBuf, Stage)>,
    suites: Vec<PathBuf>,
}

/// Adds a folder, or a shader with its own.
fn place(path: &Path, places: &mut Vec<Place>) -> anyhow::Result<()> {
    let alone = path.is_file();
    anyhow::ensure!(alone || path.is_dir(), "there is no file or folder `{}`", path.shown());
    let folder = match path.parent() {
        Some(folder) if alone && folder.as_os_str().is_empty() => Path::new("."),
        Some(folder) if alone => folder,
        _ => path,
    };
    let (mut shaders, suites) = search(folder)?;
    if alone {
        let named = path.strip_prefix(".").unwrap_or(path);
        shaders.retain(|(path, _)| path == named);
    }
    anyhow::ensure!(!shaders.is_empty(), "{}", below::none_in(path));
    let known = |shader: &(PathBuf, Stage)| places.iter().any(|place| place.shaders.contains(shader));
    shaders.retain(|shader| !known(shader));
    match places.iter_mut().find(|place| place.folder == folder) {
        Some(place) => place.shaders.extend(shaders),
        None => places.push(Place { folder: folder.to_owned(), shaders, suites }),
    }
    Ok(())
}

/// The shaders and the suites of a suite file; none where it cannot be read.
fn about(path: &Path) -> Vec<(PathBuf, Suite)> {
    let all = suite::load_all(path).unwrap_or_default();
    all.into_iter().map(|loaded| (PathBuf::from(loaded.shader.name()), loaded.suite)).collect()
}

fn runs(suite: &Suite, subject: &Subject) -> bool {
    suite.entry == subject.entry || subject.entry.as_ref().is_some_and(|entry| suite.entries.contains(entry))
}

fn label(path: &Path, subject: &Subject) -> String {
    match &subject.entry {
        Some(entry) => format!("`{entry}` of {}", path.shown()),
        None => path.shown().to_string(),
    }
}

/// Writes the suites of a shader into one file beside it. True when there is one.
fn of_shader(
    args: &InitArgs,
    (folder, path, stage, file): (&Path, &Path, Stage, &SourceFile),
    (subjects, devices): (&[Subject], &[Box<dyn Lane>]),
    names: &mut BTreeSet<String>,
    (out, err): (&mut dyn Write, &mut dyn Write),
) -> anyhow::Result<bool> {
    let shader = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let stem = shader.split_once('.').map_or(&shader[..], |(stem, _)| stem);
    let mut drafts: Vec<Draft> = Vec::new();
    for subject in subjects {
        let name = name(&shader, subject, names);
        match draft::draft(file, stage, subject, &name, &shader, devices) {
            Ok(draft) => {
                names.insert(name);
                drafts.push(draft);
            }
            Err(why) => writeln!(err, "left out: {}: {why}", label(path, subject))?,
        }
    }
    if drafts.is_empty() {
        return Ok(false);
    }
    // A file that is there is somebody's.
    let mut target = path.with_file_name(format!("{stem}{}", suite::ENDING));
    let mut number = 2;
    while target.exists() || names.contains(&target.display().to_string()) {
        target = path.with_file_name(format!("{stem}_{number}{}", suite::ENDING));
        number += 1;
    }
    names.insert(target.display().to_string());
    if !args.dry_run {
        let up = path.strip_prefix(folder).unwrap_or(path).components().count().saturating_sub(1);
        let text = format!("#:schema {}{SCHEMA}\n{}", "../".repeat(up), draft::file(&shader, &drafts));
        // Another process may have made the file since it was looked for.
        fresh::create(&target, text.as_bytes()).with_context(|| format!("cannot write `{}`", target.shown()))?;
    }
    let verb = if args.dry_run { "would write" } else { "wrote" };
    writeln!(out, "{verb} {}", target.shown())?;
    for draft in &drafts {
        let (inputs, laws) = (counted(draft.inputs as u64, "input"), counted(draft.laws as u64, "law"));
        writeln!(out, "  {}: {inputs}, {laws}", draft.name)?;
        for complaint in &draft.complaints {
            writeln!(out, "    does not pass: {complaint}")?;
        }
    }
    Ok(true)
}

/// A name for the suite of a subject that none has yet.
fn name(shader: &str, subject: &Subject, names: &BTreeSet<String>) -> String {
    let (stem, ending) = shader.split_once('.').unwrap_or((shader, ""));
    let stem = match &subject.entry {
        Some(entry) if !entry.eq_ignore_ascii_case(stem) => format!("{stem}_{entry}"),
        Some(_) | None => stem.to_owned(),
    };
    let mut name = plain(&stem);
    if names.contains(&name) {
        name = plain(&format!("{stem}_{ending}"));
    }
    let base = name.clone();
    let mut number = 2;
    while names.contains(&name) {
        name = format!("{base}_{number}");
        number += 1;
    }
    name
}

/// A name of a suite: small letters, digits and `_`.
fn plain(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect()
}

/// Writes the configuration, and the schema that suite files name, where they are not there.
fn configuration(args: &InitArgs, root: &Path, out: &mut dyn Write) -> anyhow::Result<()> {
    let schema = format!("{:#}\n", suite::schema());
    for (name, text) in [("shadercheck.toml", CONFIGURATION), (SCHEMA, &schema)] {
        let path = root.join(name);
        let path = path.strip_prefix(".").unwrap_or(&path).to_owned();
        if path.exists() {
            continue;
        }
        if args.dry_run {
            writeln!(out, "would write {}", path.shown())?;
            continue;
        }
        fresh::create(&path, text.as_bytes()).with_context(|| format!("cannot write `{}`", path.shown()))?;
        writeln!(out, "wrote {}", path.shown())?;
    }
    Ok(())
}

/// Shader files with their stages.
type Shaders = Vec<(PathBuf, Stage)>;

/// Shaders with their stages, and suite files, below a folder.
fn search(root: &Path) -> anyhow::Result<(Shaders, Vec<PathBuf>)> {
    let (suites, others): (Vec<_>, Vec<_>) =
        below::files(root)?.into_iter().partition(|path| path.to_string_lossy().ends_with(suite::ENDING));
    let staged = |path: PathBuf| below::stage_of(&path).map(|stage| (path, stage));
    Ok((others.into_iter().filter_map(staged).collect(), suites))
}
