//! A shader as an editor sees it: a file with its includes, a part of a file, or a string of host code.

use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use base::text::{SourceFile, Span};
use hosts::document::printed_shaders;
use hosts::{Language, language_of_file, stage_of};
use lint::Input;
use syntax::include::{Wanted, resolve};
use syntax::{Parsed, Shader, Stage};

use crate::occurrences::{self, Occurrence};

/// A shader, read.
pub(crate) struct Unit {
    /// Its name, as the linter has it.
    pub name: String,
    /// The shader, with what it includes.
    pub shader: Shader,
    /// How many errors the front end found.
    pub errors: usize,
    /// The files that its text comes from.
    pub files: BTreeSet<String>,
    /// Where its names stand.
    occurrences: OnceLock<Vec<Occurrence>>,
}

impl Unit {
    fn new(name: &str, file: &SourceFile, from: BTreeSet<String>, parsed: Parsed) -> Self {
        let mut files = from;
        if !file.is_assembled() {
            files.insert(file.name().to_owned());
        }
        let errors = parsed.diagnostics.len();
        Self { name: name.to_owned(), shader: parsed.shader, errors, files, occurrences: OnceLock::new() }
    }

    /// Its text.
    pub fn file(&self) -> &SourceFile {
        self.shader.file()
    }

    /// The file and place of a span; none for text that stands in no file as it is.
    pub fn place(&self, span: Span) -> Option<(SourceFile, Span)> {
        if self.file().is_assembled() { self.file().copied(span) } else { Some((self.file().clone(), span)) }
    }

    /// The place of a span in this file, if it stands there.
    pub fn place_in(&self, path: &str, span: Span) -> Option<Span> {
        self.place(span).filter(|(file, _)| file.name() == path).map(|(_, span)| span)
    }

    /// Where its names stand, in the order of the text.
    pub fn occurrences(&self) -> &[Occurrence] {
        self.occurrences.get_or_init(|| occurrences::all(&self.shader))
    }

    /// True for a module in WGSL.
    pub fn is_wgsl(&self) -> bool {
        self.shader.wgsl().is_some()
    }
}

/// The shaders of texts that were read before.
#[derive(Default)]
pub struct UnitCache(Mutex<HashMap<String, Read>>);

/// Texts, and the shaders that were read from them.
type Read = (Vec<SourceFile>, Arc<[Arc<Unit>]>);

impl UnitCache {
    /// The shaders in a file; `find` gives the files that it includes.
    pub(crate) fn units(&self, input: &Input, find: &mut dyn FnMut(&Wanted) -> Option<SourceFile>) -> Arc<[Arc<Unit>]> {
        let texts = texts(input, find);
        let name = input.file.name();
        let whole: Vec<SourceFile> = texts.iter().map(|t| t.file.clone()).collect();
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner).get(name).cloned();
        if let Some((before, units)) = known
            && before == whole
        {
            return units;
        }
        let units: Arc<[Arc<Unit>]> = texts.into_iter().map(|t| Arc::new(t.read())).collect();
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned(), (whole, units.clone()));
        units
    }

    /// Forgets files that are gone.
    pub fn retain(&self, keep: impl Fn(&str) -> bool) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).retain(|name, _| keep(name));
    }
}

/// A text before it is read.
struct Text {
    name: String,
    file: SourceFile,
    /// Files that its parts come from.
    from: BTreeSet<String>,
    stage: Option<Stage>,
}

impl Text {
    fn read(self) -> Unit {
        let parsed = match self.stage {
            None => Shader::parse_wgsl(&self.file),
            Some(stage) => Shader::parse_fitting(&self.file, stage, &[], false),
        };
        Unit::new(&self.name, &self.file, self.from, parsed)
    }
}

fn texts(input: &Input, find: &mut dyn FnMut(&Wanted) -> Option<SourceFile>) -> Vec<Text> {
    let file = &input.file;
    let name = file.name().to_owned();
    match language_of_file(file) {
        Some(Language::Wgsl) => vec![Text { name, file: file.clone(), from: BTreeSet::new(), stage: None }],
        Some(Language::Shader(_)) if printed_shaders(file).is_empty() => {
            let Some(stage) = stage_of(file) else { return Vec::new() };
            let mut from = BTreeSet::from([name.clone()]);
            let included = resolve(file, &mut |wanted| {
                let found = find(wanted)?;
                from.insert(found.name().to_owned());
                Some(found)
            });
            vec![Text { name, file: included.file, from, stage: Some(stage) }]
        }
        _ => {
            let printed = printed_shaders(file).into_iter();
            let from = BTreeSet::from([name]);
            let text = |p: hosts::document::Printed| Text {
                name: p.file.name().to_owned(),
                file: p.file,
                from: from.clone(),
                stage: Some(p.stage),
            };
            printed.map(text).collect()
        }
    }
}
