//! Texts with what they import or include, and what a reader of WGSL says of them.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use base::diagnostic::Diagnostic;
use base::text::SourceFile;
use compose::{Options, features, from_draft};
use disk::Modules;
use hosts::{Language, language_of_file};
use lint::Level;
use reading::{Composed, Composer};
use syntax::errors::EARLY_DRAFT;
use syntax::include;

/// Bytes of a text with what it includes at most: a collection of everything takes too long.
const LONGEST: usize = 1 << 18;

/// What joins texts with the files that they import or include, which are looked for in these folders as well. Where a module
/// of WGSL is missing, its text is linted as it is.
pub fn composer(folders: &[PathBuf]) -> Composer {
    let modules = Mutex::new(Modules::new(folders.to_vec()).with_files_below());
    let folders = folders.to_vec();
    Composer::new(move |file| {
        if language_of_file(file) != Some(Language::Wgsl) {
            return with_includes(file, &folders);
        }
        // A text that was put together of others is read as it stands: every place is one of it.
        let plain = SourceFile::new(file.name(), file.text());
        let (whole, file) = (file, if file.is_assembled() { &plain } else { file });
        let composed = module(file, &modules)?;
        if !whole.is_assembled() {
            return Some(composed);
        }
        let refused = composed.refused.into_iter().map(|(level, d)| (level, Diagnostic { file: whole.clone(), ..d }));
        (composed.file.text() == whole.text()).then(|| Composed { file: whole.clone(), refused: refused.collect() })
    })
}

/// A module with what it imports, and what is said of it.
fn module(file: &SourceFile, modules: &Mutex<Modules>) -> Option<Composed> {
    // With all features on, most of a text is seen. Where they exclude each other, it is read as without any.
    let on: Vec<(String, String)> = features(file).into_iter().map(|name| (name, String::new())).collect();
    let conditions = !on.is_empty();
    let sets = if on.is_empty() { vec![on] } else { vec![on, Vec::new()] };
    // Names that are missing whatever is switched on.
    let mut missing: Option<Vec<Diagnostic>> = None;
    let mut whole = |defines| {
        // Hosts assign bindings where no resource of a text has one.
        let options = Options { defines, assume_nothing: true, assign_bindings: true, ..Options::default() };
        let mut modules = modules.lock().unwrap_or_else(PoisonError::into_inner);
        let mut lacks = match modules.compose(file, &options) {
            Ok(composed) if composed.undeclared.is_empty() => return Some((composed.file, composed.notes)),
            Ok(composed) => composed.unknown_names(),
            Err(_) => modules.unknown_names(file, &options),
        };
        lacks.retain(|d| d.file.name() == file.name());
        if let Some(before) = &missing {
            lacks.retain(|d| before.iter().any(|b| b.span == d.span));
        }
        missing = Some(lacks);
        None
    };
    let draft = |note: Diagnostic| (Level::Default, note);
    let Some((joined, notes)) = sets.into_iter().find_map(&mut whole) else {
        if let Some(composed) = with_stand_ins(modules, file) {
            return Some(composed);
        }
        // What a text lacks does not keep it from being read as the language that it is in.
        if let Some((current, note)) = from_draft(file) {
            return Some(Composed { file: current, refused: vec![draft(note)] });
        }
        let level = if conditions { Level::Strict } else { Level::Default };
        let refused = missing.filter(|lacks| !lacks.is_empty())?.into_iter().map(|error| (level, error)).collect();
        return Some(Composed { file: file.clone(), refused });
    };
    let own = notes.into_iter().filter(|note| note.code == EARLY_DRAFT && note.file.name() == file.name());
    let own: Vec<_> = own.map(draft).collect();
    let mut refused = refused(&joined, own.is_empty() && !conditions && joined.text() == file.text());
    refused.extend(own);
    Some(Composed { file: joined, refused })
}

/// A text in GLSL with the files that it includes, as far as they are there. None for one that includes nothing.
fn with_includes(file: &SourceFile, folders: &[PathBuf]) -> Option<Composed> {
    let own = Path::new(file.name()).parent().unwrap_or(Path::new(""));
    let within: Vec<&Path> = [own].into_iter().chain(folders.iter().map(PathBuf::as_path)).collect();
    let mut left = LONGEST.saturating_sub(file.text().len());
    let mut whole = true;
    let included = include::resolve(file, &mut |wanted| {
        let found = disk::included(wanted, folders, &within).ok().flatten()?;
        let rest = left.checked_sub(found.text().len());
        whole &= rest.is_some();
        left = rest?;
        Some(found)
    });
    // A circle that leads back to this file: the others tell theirs.
    let own = |cycle: &&include::Cycle| cycle.chain.first().is_some_and(|name| **name == *file.name());
    let open = included.cycles.iter().filter(|cycle| !cycle.guarded).filter(own);
    let refused: Vec<_> = open.map(|cycle| (Level::Default, cycle.error())).collect();
    // Where a circle is open, the text ends where a compiler finds no end.
    (whole && included.file.is_assembled()).then_some(Composed { file: included.file, refused })
}

/// A template with names in the place of what its engine fills in. Nothing but its own faults can be found in it: no
/// compiler reads it.
fn with_stand_ins(modules: &Mutex<Modules>, file: &SourceFile) -> Option<Composed> {
    if !["{{", "{%"].iter().any(|mark| file.text().contains(mark)) {
        return None;
    }
    let options = Options { stand_ins: true, ..Options::default() };
    let composed = modules.lock().unwrap_or_else(PoisonError::into_inner).compose(file, &options).ok()?;
    let own = composed.notes.into_iter().filter(|note| note.code == EARLY_DRAFT && note.file.name() == file.name());
    Some(Composed { file: composed.file, refused: own.map(|note| (Level::Default, note)).collect() })
}

/// Why naga refuses a text. It stops at the first error. What its parser does not take may be newer than this parser, but
/// for what no version allows; where a text is no `plain` WGSL of today, not even that is certain: features may exclude
/// each other, drafts allowed more, and a prelude may be a guess.
#[cfg(feature = "run")]
fn refused(file: &SourceFile, plain: bool) -> Vec<(Level, Diagnostic)> {
    use program::{ModuleText, ProgramError, Written, holds_in_any_version};
    let Err(ProgramError::Source(found)) = ModuleText::read(file, Written::Wgsl) else { return Vec::new() };
    let certain = |d: &Diagnostic| d.code == program::VALIDATOR || (plain && holds_in_any_version(d));
    let level = |d: &Diagnostic| if certain(d) { Level::Default } else { Level::Strict };
    found.into_iter().map(|d| (level(&d), d)).collect()
}

/// Without what runs shaders there is no reader but our own.
#[cfg(not(feature = "run"))]
fn refused(_: &SourceFile, _: bool) -> Vec<(Level, Diagnostic)> {
    Vec::new()
}
