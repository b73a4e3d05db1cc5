//! Shader files with their includes, for commands that run them.

use std::cell::RefCell;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

use anyhow::Context as _;

use super::compose::Given;
use super::hosts::Hosts;
use super::spared;
use base::diagnostic::{Diagnostic, Severity};
use base::text::{Shown as _, SourceFile};
use compose::LeftOut;
use engine::completion::references::{self, Unfolded};
use engine::completion::{self, Completed, macro_name};
use engine::fuzz::{FunctionReport, FuzzFindingKind};
use engine::suite::{Includes, Joined, read_module};
use hosts::Language;
use program::{ModuleText, ProgramError, Written};
use syntax::{Parsed, Shader, Stage};

/// A file that is run.
pub struct IncludedText {
    /// Its name, as it was given.
    pub name: String,
    /// How a command line names it.
    pub given: String,
    /// Its path.
    pub path: PathBuf,
    /// Its text, with includes.
    pub file: SourceFile,
    /// Its stage.
    pub stage: Stage,
    /// True for one of the shaders of a file that holds others, or other text, as well.
    pub printed: bool,
    /// Where includes were looked for.
    includes: Includes,
    /// What it was put together from, in WGSL.
    joined: Option<Joined>,
    /// What stands for macros that a build may give, and that nothing in it defines.
    completed: Completed,
    /// Names in WGSL that others stand for, and that are slips.
    slips: Vec<Diagnostic>,
    /// What to tell of a version that it does not name.
    version: Option<String>,
    /// What to tell of buffers that it has addresses of.
    addresses: Option<String>,
    /// One buffer stands for several that it writes.
    shares: bool,
    /// What it lacks was looked for.
    looked_for: bool,
    /// Whether a version that it has is one of the text that its host puts in front.
    versioned_by_host: bool,
    /// What to tell of what its host fills in.
    filled: Vec<String>,
    /// Names that stand for what its host fills in.
    made_up: Vec<String>,
    /// Why an error of the text need not be its author's.
    open: Option<String>,
    /// Functions whose findings rest on what is taken for what its host fills in.
    resting: Vec<String>,
    /// Functions that are run elsewhere, for a text that is read once more.
    known: Vec<String>,
    /// Names that its host may define, of one that is read once more with them.
    again: Vec<String>,
}

/// Reads a file and what it includes: `"path"` beside the file that asks and then in the stated folders, `<path>` in
/// these alone; and what a file in WGSL imports.
///
/// # Errors
/// When the file, or one that it includes and that is there, cannot be read.
pub fn read(path: &Path, given: &Given<'_>) -> anyhow::Result<IncludedText> {
    with_includes(&crate::cli::translate::read(path)?, path, given)
}

/// The one shader that a path means, as [`read_all`] finds it: host code and a line of a document hold shaders, and every other
/// file is one.
///
/// # Errors
/// As [`read_all`], and when there are several.
pub fn read_one(path: &Path, given: &Given<'_>) -> anyhow::Result<IncludedText> {
    let is_host = matches!(hosts::language_of(&path.to_string_lossy()), Some(Language::Host | Language::Script));
    if given.stage.is_some() || (path.is_file() && !is_host && !super::document::is_of_statements(path)?) {
        return read(path, given);
    }
    let mut all = texts(path, given, None, super::document::whole)?;
    let lines: Vec<&str> = all.iter().map(|text| text.given.as_str()).collect();
    anyhow::ensure!(lines.len() == 1, "`{}` holds several shaders; name one: {}", path.shown(), lines.join(", "));
    all.pop().with_context(|| format!("`{}` holds no whole shader", path.shown()))
}

/// A text with what it includes, as [`read`].
///
/// # Errors
/// When a file that it includes, and that is there, cannot be read.
pub fn with_includes(file: &SourceFile, path: &Path, given: &Given<'_>) -> anyhow::Result<IncludedText> {
    let (file, filled) = match given.chunks {
        Some(chunks) if file.text().contains("include") => chunks.borrow_mut().put(file, path),
        _ => (file.clone(), Vec::new()),
    };
    let file = &file;
    let mut includes = Includes::new(given.folders.to_vec(), "`-I FOLDER`");
    // A compiler gets a text with its includes, whose places are known so.
    let compiled = if Written::of(file).is_compiled() { Some(includes.resolve(file)?) } else { None };
    let joined = given.joined(compiled.as_ref().unwrap_or(file))?;
    let whole = match &joined {
        Some(joined) => joined.file(file),
        None => includes.resolve(file)?,
    };
    Ok(IncludedText {
        name: file.name().to_owned(),
        given: file.name().to_owned(),
        path: path.to_owned(),
        stage: hosts::stage_of(file).unwrap_or(Stage::Library),
        printed: false,
        file: whole,
        includes,
        joined,
        completed: Completed::default(),
        slips: Vec::new(),
        version: None,
        addresses: None,
        shares: false,
        looked_for: false,
        versioned_by_host: false,
        filled,
        made_up: Vec::new(),
        open: None,
        resting: Vec::new(),
        known: Vec::new(),
        again: Vec::new(),
    })
}

/// The files that a path means: itself, as a shader of `stage` if that is given, or the shaders that it holds.
///
/// # Errors
/// As [`read`], and when a file of host code holds no whole shader.
pub fn read_all(path: &Path, given: &Given<'_>, stage: Option<Stage>) -> anyhow::Result<Vec<IncludedText>> {
    texts(path, given, stage, |printed| printed)
}

fn texts(
    path: &Path,
    given: &Given<'_>,
    stage: Option<Stage>,
    wanted: fn(Vec<hosts::document::Printed>) -> Vec<hosts::document::Printed>,
) -> anyhow::Result<Vec<IncludedText>> {
    if let (Some(stage), true) = (stage, path.is_file()) {
        return Ok(vec![IncludedText { stage, ..read(path, given)? }]);
    }
    if Written::of_path(&path.to_string_lossy()).is_compiled() {
        return Ok(vec![read(path, given)?]);
    }
    let Some(printed) = super::document::shaders(path)? else { return Ok(vec![read(path, given)?]) };
    let text = |shader: hosts::document::Printed| {
        let (name, path) = (shader.file.name().to_owned(), path.to_owned());
        // The name of a shader in host code is no path: its line leads to it.
        let is_file = hosts::language_of(&path.to_string_lossy()).is_some();
        let called = if is_file { format!("{}:{}", path.shown(), shader.lines.start() + 1) } else { name.clone() };
        let whole = with_includes(&shader.file, &path, given)?;
        let filled = [shader.notes, whole.filled.clone()].concat();
        let (made_up, resting) = (shader.made_up, shader.resting);
        let part = || shader.part.then(|| "its host puts it into other texts".to_owned());
        let open = shader.open.or_else(part);
        Ok(IncludedText {
            name,
            given: called,
            path,
            stage: shader.stage,
            printed: true,
            filled,
            made_up,
            open,
            resting,
            ..whole
        })
    };
    wanted(printed).into_iter().map(text).collect()
}

/// A text in GLSL, and one that names no version under one that has what it uses.
pub fn read_glsl(file: &SourceFile, stage: Stage, defines: &[(String, String)]) -> Parsed {
    let parsed = Shader::parse_with(file, stage, defines);
    if parsed.shader.version().span.is_some() {
        return parsed;
    }
    // A text that asks for OpenGL ES is for phones and browsers.
    if let Some(es) = reading::es::reading(&parsed.shader) {
        return es;
    }
    let fitted = syntax::fitting(file, stage, defines, || None);
    if fitted == *file { parsed } else { Shader::parse_with(&fitted, stage, defines) }
}

impl IncludedText {
    /// The author's file, which may hold other shaders or other text as well.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn author(&self) -> anyhow::Result<SourceFile> {
        crate::cli::translate::read(&super::document::file_of(&self.path))
    }

    /// Names that conditions of a module ask for, in all files that it is put together from.
    pub fn features(&self) -> Vec<String> {
        self.joined.as_ref().map_or_else(|| compose::features(&self.file), Joined::features)
    }

    /// The shader; one that names no version under one that has what it uses.
    pub fn parsed(&self, defines: &[(String, String)]) -> Parsed {
        self.parsed_with(defines, &self.completed)
    }

    /// Errors about declarations that the text lacks and for which others stand: those that no host can take away.
    pub fn lacking(&self, defines: &[(String, String)]) -> Vec<Diagnostic> {
        if Written::of(&self.file) != Written::Glsl {
            return self.slips.clone();
        }
        // Who puts a version in front may put more there.
        if self.completed.declared.is_empty() || !self.is_versioned(defines) {
            return Vec::new();
        }
        let Parsed { shader, diagnostics } =
            self.parsed_with(defines, &Completed { declared: Vec::new(), ..self.completed.clone() });
        let errors: Vec<Diagnostic> = diagnostics.into_iter().filter(|d| d.severity == Severity::Error).collect();
        let doubtful = reading::open::doubtful(&shader, &errors, syntax::errors::Around::empty());
        errors.into_iter().zip(doubtful).filter(|(_, doubtful)| !doubtful).map(|(error, _)| error).collect()
    }

    /// The macros of the command line, and those that stand for what a build or a host may give.
    pub fn macros(&self, defines: &[(String, String)]) -> Vec<(String, String)> {
        defines.iter().cloned().chain(self.completed.macros()).collect()
    }

    /// Whether names that the text lacks were looked for, so that those that are left are its host's.
    pub fn is_looked_for(&self) -> bool {
        self.looked_for
    }

    /// Whether the text states a version, so that no host puts anything in front of it.
    pub fn is_versioned(&self, defines: &[(String, String)]) -> bool {
        !self.versioned_by_host && Shader::parse_with(&self.file, self.stage, defines).shader.version().span.is_some()
    }

    /// Errors of a piece that may come of what stands for names which it lacks, of all that were found.
    pub fn made_by_names(&self, errors: &[Diagnostic], defines: &[(String, String)]) -> Vec<bool> {
        if !self.completed.is_partial {
            return vec![false; errors.len()];
        }
        let known = |of: &Diagnostic| (of.code, of.message.to_string(), of.file.locate(of.span.start));
        let plain = self.parsed_with(defines, &Completed::default()).diagnostics;
        let own: HashSet<_> = plain.iter().map(known).collect();
        errors.iter().map(|error| !own.contains(&known(error))).collect()
    }

    fn parsed_with(&self, defines: &[(String, String)], completed: &Completed) -> Parsed {
        let all: Vec<(String, String)> = defines.iter().cloned().chain(completed.macros()).collect();
        let (defines, file) = (&all[..], completed.put(&self.file));
        let parsed = read_glsl(&file, self.stage, defines);
        self.unfolded(&parsed, defines).map_or(parsed, |(unfolded, _)| unfolded)
    }

    /// The text with a buffer for each address of one, if that brings no errors, and what to tell of it.
    fn unfolded(&self, parsed: &Parsed, defines: &[(String, String)]) -> Option<(Parsed, Unfolded)> {
        let errors = |parsed: &Parsed| parsed.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
        let text = references::unfolded(&parsed.shader)?;
        let unfolded = read_glsl(&text.file, self.stage, defines);
        (errors(&unfolded) <= errors(parsed)).then_some((unfolded, text))
    }

    /// What to tell of the version that is taken for a text which names none: a compute shader, or one that asks for OpenGL ES.
    fn assumed_version(&self, defines: &[(String, String)]) -> Option<String> {
        let plain = Shader::parse_with(&self.file, self.stage, defines).shader;
        if let Some(es) = reading::es::reading(&plain) {
            let names: Vec<String> = es.shader.defines().iter().map(|(name, _)| format!("`{name}`")).collect();
            let defined = if names.is_empty() { String::new() } else { format!(" with {} defined", names.join(", ")) };
            return Some(format!("`{}` asks for OpenGL ES: it is read{defined} as a phone reads it", self.name));
        }
        if self.stage != Stage::Compute || plain.version().span.is_some() {
            return None;
        }
        let parsed = self.parsed(defines);
        let version = parsed.shader.version();
        let number = version.span.map(|_| version.number)?;
        Some(format!("`{}` has no `#version`: it is read as GLSL {}.{:02}", self.name, number / 100, number % 100))
    }

    /// A changed text in the place of the author's file, read in the way of the first.
    ///
    /// # Errors
    /// As of [`with_includes`], and where a file of several shaders does not hold this one any more.
    pub fn changed(&self, file: &SourceFile, given: &Given<'_>) -> anyhow::Result<Self> {
        if self.printed {
            let all = super::document::runnable(file, &super::document::file_of(&self.path)).into_iter();
            let same = all.map(|shader| shader.file).find(|shader| shader.name() == self.name);
            let same = same.ok_or_else(|| anyhow::anyhow!("`{}` is not there any more", self.name))?;
            return Ok(Self { stage: self.stage, ..with_includes(&same, &self.path, given)? });
        }
        Ok(Self { stage: self.stage, ..with_includes(file, &self.path, given)? })
    }

    /// The same between the texts that its host puts around it.
    #[must_use]
    pub fn with_prelude(self, wanted: reading::prelude::Wanted) -> Self {
        let (file, stage) = reading::prelude::behind(&self.file, self.stage, wanted);
        let versioned_by_host = file.text() != self.file.text() && !self.is_versioned(&[]);
        Self { file, stage, versioned_by_host, ..self }
    }

    /// The text as a module, for languages that are read as one.
    ///
    /// # Errors
    /// As of [`read_module`], and what is wrong with the files that it is put together from.
    pub fn module(&self) -> Result<ModuleText, ProgramError> {
        self.joined.as_ref().map_or_else(|| read_module(&self.file), Joined::module)
    }

    /// What can be run of a text in WGSL that lacks declarations, and what cannot, as of [`Joined::rest`].
    ///
    /// # Errors
    /// As of [`Joined::rest`].
    pub fn rest(&self) -> Option<Result<(ModuleText, &[LeftOut]), ProgramError>> {
        self.joined.as_ref()?.rest()
    }

    /// Values for the `override` constants of the module, from those that are given.
    pub fn values(&self, text: &ModuleText, defines: &[(String, String)]) -> Vec<(String, String)> {
        let all: Vec<(String, String)> = defines.iter().chain(&self.completed.assumed).cloned().collect();
        self.joined.as_ref().map_or_else(|| all.clone(), |joined| joined.values(text, &all))
    }

    /// The same, where macros that a build or a host may give stand for what host code of the project says, or else for
    /// something plain, if the text holds no errors then. What is taken and assumed is among the [notes](Self::notes).
    #[must_use]
    pub fn assuming(self, defines: &[(String, String)], hosts: &mut Hosts) -> Self {
        if Written::of(&self.file) != Written::Glsl {
            return self.with_declarations(defines);
        }
        let with = |completed: &Completed| self.parsed_with(defines, completed);
        let stated = |name: &str| defines.iter().any(|(known, _)| macro_name(known) == macro_name(name));
        let hosts = RefCell::new(hosts);
        let mut siblings = |names: &[String]| hosts.borrow_mut().siblings(&self.path, names);
        let mut offers = |names: &[String]| {
            let offers = hosts.borrow_mut().offers(&self.path, names);
            offers.into_iter().filter(|offer| !stated(&offer.name)).collect::<Vec<_>>()
        };
        let found = completion::completed(&with, &mut offers, &mut siblings).unwrap_or_default();
        // Of which nothing runs so, what stands for names is of no use.
        let runs = !found.is_partial || spared::runs(&self, &found, defines);
        let completed = if runs { found } else { Completed::default() };
        let version = self.assumed_version(defines);
        // Few texts have addresses, and the others need not be read once more.
        let unfolded = self.file.text().contains("buffer_reference").then(|| {
            let all: Vec<(String, String)> = defines.iter().cloned().chain(completed.macros()).collect();
            self.unfolded(&read_glsl(&completed.put(&self.file), self.stage, &all), &all)
        });
        let (addresses, shares) = match unfolded.flatten() {
            Some((_, Unfolded { note, shares, .. })) => (Some(note), shares),
            None => (None, false),
        };
        Self { completed, version, addresses, shares, looked_for: true, ..self }
    }

    /// The same with what stands for declarations, and values of constants, that a text in WGSL lacks. A slip stays an error.
    fn with_declarations(mut self, defines: &[(String, String)]) -> Self {
        let Some(joined) = &mut self.joined else { return self };
        let mut slips = joined.unknown_names();
        self.completed.declared = joined.complete();
        if !self.completed.declared.is_empty() {
            slips.retain(|error| is_slip(error, &self.made_up));
            // What stands around a piece declares names that are like those of the piece.
            let shader = (!slips.is_empty()).then(|| Shader::parse_wgsl(&self.file).shader);
            if let Some(piece) = shader.filter(|s| s.wgsl().is_none_or(|module| module.entry_points.is_empty())) {
                slips.retain(|error| !reading::open::resembles_global(&piece, error));
            }
            self.slips = slips;
        }
        if Written::of(&self.file) == Written::Wgsl
            && let Ok(text) = joined.module()
        {
            let open = text.valueless().into_iter().filter(|(name, _)| defines.iter().all(|(known, _)| known != name));
            self.completed.assumed = open.map(|(name, value)| (name, value.to_owned())).collect();
        }
        self
    }

    /// True for a name that nobody means to declare, and that is none of those that stand for what a host fills in.
    pub fn is_slip(&self, error: &Diagnostic) -> bool {
        is_slip(error, &self.made_up)
    }

    /// True for a text in WGSL that follows the grammar, and lacks no name that nobody means to declare, nor anything that a
    /// host fills in.
    pub fn is_a_part(&self) -> bool {
        let lacking = self.joined.as_ref().map(Joined::unknown_names).unwrap_or_default();
        let mut told = Shader::parse_wgsl(&self.file).diagnostics.into_iter();
        let is_torn = told.any(|found| found.severity == Severity::Error && syntax::errors::is_of_the_text(found.code));
        self.open.is_none() && !is_torn && !lacking.iter().any(|error| self.is_slip(error))
    }

    /// Why an error of the text need not be its author's: what is not known of it.
    pub fn open(&self) -> Option<&str> {
        self.open.as_deref()
    }

    /// The same with names that its host may define, for the functions alone that are not `known`.
    #[must_use]
    pub fn switched(mut self, switches: &[(String, String)], known: &[String]) -> Self {
        self.completed.assumed.splice(0..0, switches.iter().cloned());
        let again = switches.iter().map(|(name, _)| name.clone()).collect();
        Self { known: known.to_vec(), again, ..self }
    }

    /// Its name above what came of its functions.
    pub fn heading(&self) -> String {
        let Self { name, again, .. } = self;
        if again.is_empty() { name.clone() } else { format!("{name}, with {}", again.join(", ")) }
    }

    /// Declarations that stand for what the text lacks.
    pub fn made_up(&self) -> usize {
        self.completed.declared.len()
    }

    /// True for a function that stands for one that the text lacks, and for one that is run elsewhere.
    pub fn is_assumed(&self, function: &str) -> bool {
        self.completed.is_assumed(function) || self.known.iter().any(|known| known == function)
    }

    /// True for an input that stands for a name which the text lacks.
    pub fn makes_up(&self, input: &str) -> bool {
        self.completed.makes_up(input)
    }

    /// What was found in a function, as far as that may rest on what is assumed: see [`Completed::soften`].
    pub fn softened(&self, mut function: FunctionReport) -> FunctionReport {
        self.completed.soften(&mut function);
        let is_assumed = self.joined.as_ref().is_some_and(Joined::is_assumed) || self.completed.is_sized();
        if is_assumed || self.shares || !self.again.is_empty() || self.resting.contains(&function.function) {
            function.as_warnings();
        }
        if is_assumed {
            function.as_notes(FuzzFindingKind::Index);
        }
        function
    }

    /// Macros that are assumed.
    pub fn assumed(&self) -> &[(String, String)] {
        &self.completed.assumed
    }

    /// What is worth knowing about where parts of the text come from, and about what is assumed.
    pub fn notes(&self) -> Vec<String> {
        let joined = self.joined.as_ref().map(Joined::notes).unwrap_or_default();
        let Completed { assumed, taken, declared, is_partial: _ } = &self.completed;
        let assumed = (!assumed.is_empty()).then(|| completion::assumption_note(assumed));
        let taken = completion::taken_notes(taken);
        let declared = completion::declared_notes(declared);
        let cycles = self.includes.cycles().to_vec();
        cycles
            .into_iter()
            .chain(self.filled.iter().cloned())
            .chain(joined)
            .chain(taken)
            .chain(assumed)
            .chain(declared)
            .chain(self.version.clone())
            .chain(self.addresses.clone())
            .collect()
    }

    /// A diagnostic with what is known about includes that were not found.
    pub fn explained(&self, diagnostic: Diagnostic) -> Diagnostic {
        self.includes.explained(diagnostic)
    }
}

fn is_slip(error: &Diagnostic, made_up: &[String]) -> bool {
    let name = error.file.slice(error.span);
    // Its place may be that of the hole for which it stands.
    let stands_in = name.starts_with("${") || made_up.iter().any(|own| own == name);
    reading::open::is_slip(error) && !is_type_of(name, &error.file) && !stands_in
}

/// True for a name that differs from one of the text by a capital at its start alone: a type, after which a variable is called.
fn is_type_of(name: &str, file: &SourceFile) -> bool {
    let Some(first) = name.chars().next().filter(|first| first.is_uppercase()) else { return false };
    let variable: String = first.to_lowercase().chain(name.chars().skip(1)).collect();
    file.text().split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == variable)
}
