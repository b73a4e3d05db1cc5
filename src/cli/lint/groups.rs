//! Which configuration holds for which file. Files under one configuration are linted together, with
//! all others as context.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use crate::cli::LangName;
use base::diagnostic::{Diagnostic, Safety};
use base::text::Shown;
use lint::fix::{self, Outcome};
use lint::{Input, Selection, Settings, by_code, run_until, sort};

use super::LintArgs;
use super::config::{self, FILE_NAME, FileConfig};
use super::files::Loaded;
use super::packs;

/// Files under one configuration.
struct Group {
    settings: Settings,
    names: BTreeSet<String>,
    /// Macros that the command line gives to the shaders.
    defines: Vec<(String, String)>,
}

/// All reported files, by their configuration.
pub struct Groups {
    groups: Vec<Group>,
    /// The language that the first configuration asks for.
    pub lang: Option<LangName>,
    /// What a configuration names and is not there.
    pub missing: Vec<String>,
}

impl Groups {
    /// Finds the nearest configuration of each reported file: in its folder or one above. Options of
    /// the command line go before what a configuration says.
    ///
    /// # Errors
    /// What is wrong with an option or a configuration.
    pub fn new(args: &LintArgs, loaded: &mut Loaded) -> anyhow::Result<Self> {
        let mut finder = Finder::default();
        let mut places: BTreeMap<Option<PathBuf>, BTreeMap<String, PathBuf>> = BTreeMap::new();
        for input in loaded.inputs.iter().filter(|i| i.reported) {
            let name = input.file.name();
            let Some(path) = loaded.path(name) else { continue };
            let folder = finder.folder(path);
            let real = folder.join(path.file_name().unwrap_or_default());
            let config = match (&args.config, args.no_config) {
                (_, true) => None,
                (Some(given), false) => Some(given.clone()),
                (None, false) => finder.nearest(&folder),
            };
            places.entry(config).or_default().insert(name.to_owned(), real);
        }
        if places.is_empty() {
            // Options are checked even when there is nothing to lint.
            places.insert(args.config.clone().filter(|_| !args.no_config), BTreeMap::new());
        }
        let mut groups = Self { groups: Vec::new(), lang: None, missing: Vec::new() };
        for (config, files) in places {
            let file = config.as_deref().map(|path| config::read(&shortened(path))).transpose()?.unwrap_or_default();
            groups.lang = groups.lang.or(file.lang);
            let group = groups.group(args, file, files, loaded)?;
            groups.groups.push(group);
        }
        Ok(groups)
    }

    /// No files.
    pub fn none() -> Self {
        Self { groups: Vec::new(), lang: None, missing: Vec::new() }
    }

    fn group(
        &mut self,
        args: &LintArgs,
        mut file: FileConfig,
        files: BTreeMap<String, PathBuf>,
        loaded: &mut Loaded,
    ) -> anyhow::Result<Group> {
        let given = |option: &[String], file: Option<Vec<String>>| {
            if option.is_empty() { file.unwrap_or_default() } else { option.to_vec() }
        };
        let (select, ignore) = (given(&args.select, file.select.take()), given(&args.ignore, file.ignore.take()));
        let level = args.level.or(file.level).unwrap_or_default().level();
        let mut settings = Settings { selection: Selection::new(&select, &ignore)?.at(level), ..Settings::default() };
        for (name, real) in &files {
            let path = real.strip_prefix(&file.folder).unwrap_or(real);
            for pattern in file.per_file.iter().filter(|p| p.matches(path)) {
                settings.per_file.ignore(name, &pattern.rules)?;
            }
        }
        for program in &mut file.config.programs {
            for path in program.shaders.iter_mut().chain(&mut program.hosts) {
                let place = file.folder.join(&*path);
                if !place.is_file() {
                    self.missing.push(format!("{}: named by [[program]], and not there", shortened(&place).shown()));
                }
                *path = loaded.name_of(&shortened(&place));
            }
        }
        settings.config = file.config;
        settings.config.prelude = crate::cli::prelude(args.prelude.as_deref());
        settings.options = !args.no_variants;
        if settings.options {
            settings.config.asked_before = packs::asked_before(&files);
        }
        Ok(Group { settings, names: files.into_keys().collect(), defines: args.define.clone() })
    }

    /// Lints all files.
    pub fn run(&self, inputs: &[Input]) -> Vec<Diagnostic> {
        self.run_on(inputs, |_| true)
    }

    /// Lints the files of these names, with all others as context.
    pub fn run_on(&self, inputs: &[Input], wanted: impl Fn(&str) -> bool) -> Vec<Diagnostic> {
        self.run_until(inputs, wanted, &AtomicBool::new(false)).unwrap_or_default()
    }

    /// The same, unless `stop` becomes true: none then.
    pub fn run_until(
        &self,
        inputs: &[Input],
        wanted: impl Fn(&str) -> bool,
        stop: &AtomicBool,
    ) -> Option<Vec<Diagnostic>> {
        let groups = self.groups.iter().filter(|g| g.names.iter().any(|n| wanted(n)));
        let run = |g: &Group| run_until(&self.inputs_of(g, inputs, &wanted), &g.settings, stop);
        let mut found: Vec<Diagnostic> = groups.map(run).collect::<Option<Vec<_>>>()?.into_iter().flatten().collect();
        sort(&mut found);
        Some(found)
    }

    /// Repairs all files.
    pub fn fix(&self, inputs: &[Input], safety: Safety) -> Outcome {
        self.fix_on(inputs, safety, |_| true)
    }

    /// Repairs the files of these names.
    pub fn fix_on(&self, inputs: &[Input], safety: Safety, wanted: impl Fn(&str) -> bool) -> Outcome {
        let mut whole = Outcome { files: Vec::new(), applied: 0, refused: Vec::new(), remaining: Vec::new() };
        for group in self.groups.iter().filter(|g| g.names.iter().any(|n| wanted(n))) {
            let outcome = fix::fix(&self.inputs_of(group, inputs, &wanted), &group.settings, safety);
            whole.files.extend(outcome.files);
            whole.applied += outcome.applied;
            whole.refused.extend(outcome.refused);
            whole.remaining.extend(outcome.remaining);
        }
        sort(&mut whole.remaining);
        whole
    }

    /// True when findings of this rule are asked for in a reported file.
    pub fn asks(&self, name: &str, code: &str) -> bool {
        let level = by_code(code).map(|r| r.level).unwrap_or_default();
        let group = self.groups.iter().find(|g| g.names.contains(name));
        group.is_some_and(|g| g.settings.keeps(name, code, level))
    }

    /// What the project says about itself, for a reported file.
    pub fn config(&self, name: &str) -> lint::Config {
        let group = self.groups.iter().find(|g| g.names.contains(name));
        group.map(|g| g.settings.config.clone()).unwrap_or_default()
    }

    fn inputs_of(&self, group: &Group, inputs: &[Input], wanted: &impl Fn(&str) -> bool) -> Vec<Input> {
        let own =
            |input: &Input| input.reported && group.names.contains(input.file.name()) && wanted(input.file.name());
        inputs.iter().map(|input| input.with_reported(own(input)).defining(&group.defines)).collect()
    }
}

/// Looks for configurations in folders, each once.
#[derive(Default)]
struct Finder {
    real: BTreeMap<PathBuf, PathBuf>,
    nearest: BTreeMap<PathBuf, Option<PathBuf>>,
}

impl Finder {
    /// The real path of a file's folder.
    fn folder(&mut self, file: &Path) -> PathBuf {
        let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let real = || std::fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
        self.real.entry(folder.to_owned()).or_insert_with(real).clone()
    }

    /// The configuration in a folder or the nearest above it.
    fn nearest(&mut self, folder: &Path) -> Option<PathBuf> {
        if let Some(known) = self.nearest.get(folder) {
            return known.clone();
        }
        let here = folder.join(FILE_NAME);
        let found = if here.is_file() { Some(here) } else { folder.parent().and_then(|up| self.nearest(up)) };
        self.nearest.insert(folder.to_owned(), found.clone());
        found
    }
}

/// A path from the current folder, when it lies below it.
pub fn shortened(path: &Path) -> PathBuf {
    let here = std::env::current_dir().and_then(std::fs::canonicalize);
    match here.ok().and_then(|here| path.strip_prefix(here).ok().map(Path::to_owned)) {
        Some(inside) if !inside.as_os_str().is_empty() => inside,
        Some(_) | None => path.to_owned(),
    }
}
