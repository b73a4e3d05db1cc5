//! Texts of several files, or that a compiler reads: WGSL with what it imports, HLSL and Slang.

use std::path::PathBuf;

use base::diagnostic::{Diagnostic, Message};
use base::text::{SourceFile, Span};
use compose::{Composed, LeftOut, Options};
use disk::{ComposeError, Modules};
use program::{ModuleText, ProgramError, Written};
use syntax::errors;

use crate::completion::{Stand, wgsl};

use super::compiled::{Asked, read_compiled};

/// A text in WGSL with what it imports, or one that a compiler reads.
pub struct Joined {
    made: JoinedText,
    /// Names that are given, and mean something to a file other than the value of a constant.
    stated: Vec<String>,
    /// What a text in WGSL was to be put together from, where imports are not there or directives have no values.
    lacks: Option<Request>,
    /// The same of a text that lacks names which no file beside it declares.
    wider: Option<Request>,
}

/// A text in WGSL, where what it imports is looked for, and how it is read.
struct Request {
    file: SourceFile,
    folders: Vec<PathBuf>,
    options: Options,
}

enum JoinedText {
    /// A text in WGSL.
    Composed(Result<Composed, Vec<Diagnostic>>),
    /// A text in HLSL or Slang, which is compiled when it is read.
    Compiled { file: SourceFile, folders: Vec<PathBuf>, defines: Vec<(String, String)>, asked: Asked },
}

impl Joined {
    /// The text of a file in WGSL with what it imports, which is looked for around it and in `folders`, or one that a
    /// compiler reads, whose includes are done; none for other languages.
    ///
    /// # Errors
    /// [`ComposeError::Unreadable`] when a file that is there cannot be read. What is wrong in the files is told when the
    /// text is read.
    pub fn of(
        file: &SourceFile,
        folders: &[PathBuf],
        options: &Options,
        asked: &Asked,
    ) -> Result<Option<Self>, ComposeError> {
        if Written::of(file).is_compiled() {
            let (file, folders, defines) = (file.clone(), folders.to_vec(), options.defines.clone());
            let stated = defines.iter().map(|(name, _)| name.clone()).collect();
            return Ok(Some(Self {
                made: JoinedText::Compiled { file, folders, defines, asked: asked.clone() },
                stated,
                lacks: None,
                wider: None,
            }));
        }
        // A text in another language than its ending says is told as such by its reader.
        if Written::of(file) != Written::Wgsl || syntax::other_language(file, syntax::Looks::Wgsl).is_some() {
            return Ok(None);
        }
        let composed = match Modules::new(folders.to_vec()).with_files_below().compose(file, options) {
            Ok(composed) => Ok(composed),
            Err(ComposeError::Wrong(found)) => Err(found),
            Err(error @ ComposeError::Unreadable(..)) => return Err(error),
        };
        let stated = composed.as_ref().map(|composed| composed.stated.clone()).unwrap_or_default();
        let missing = |d: &Diagnostic| [errors::IMPORT, errors::VALUELESS, errors::TEMPLATE].contains(&d.code);
        let request =
            |options: &Options| Request { file: file.clone(), folders: folders.to_vec(), options: options.clone() };
        let lacks = composed.as_ref().is_err_and(|found| found.iter().all(missing));
        let lacks = lacks.then(|| request(&Options { open: true, ..options.clone() }));
        let wider = composed.as_ref().is_ok_and(|text| !text.undeclared.is_empty()).then(|| request(options));
        Ok(Some(Self { made: JoinedText::Composed(composed), stated, lacks, wider }))
    }

    /// Puts declarations behind a text in WGSL for the names that it lacks, and gives them. Where it is wrong with whatever
    /// stands for them, they are looked for in the folders around, which take no part otherwise. Nothing changes where it
    /// lacks none, or is wrong with them as well.
    pub fn complete(&mut self) -> Vec<Stand> {
        let JoinedText::Composed(made) = &self.made else { return Vec::new() };
        let open = self.open();
        let Some(text) = open.as_ref().or(made.as_ref().ok()) else { return Vec::new() };
        let with = |text: &Composed, nothing: bool| {
            let found = wgsl::completed(text).or_else(|| nothing.then(|| (text.file.clone(), Vec::new())));
            let whole =
                |(file, stands)| (Composed { file, undeclared: Vec::new(), rest: None, ..text.clone() }, stands);
            found.map(whole)
        };
        let around = || {
            let text = self.around().filter(|found| found.undeclared.len() < text.undeclared.len())?;
            with(&text, text.undeclared.is_empty())
        };
        let completed = with(text, open.is_some() && text.undeclared.is_empty()).or_else(around);
        let Some((whole, stands)) = completed else { return Vec::new() };
        // What was refused before told of nothing that it takes.
        self.stated.clone_from(&whole.stated);
        self.made = JoinedText::Composed(Ok(whole));
        stands
    }

    /// The text with what files in the folders around declare.
    fn around(&self) -> Option<Composed> {
        let Request { file, folders, options } = self.lacks.as_ref().or(self.wider.as_ref())?;
        Modules::new(folders.clone()).with_files_below().with_files_around().compose(file, options).ok()
    }

    /// The text of a file of which imports are not there or directives have no values.
    fn open(&self) -> Option<Composed> {
        let Request { file, folders, options } = self.lacks.as_ref()?;
        Modules::new(folders.clone()).with_files_below().compose(file, options).ok()
    }

    /// Names that conditions of its files ask for.
    pub fn features(&self) -> Vec<String> {
        match &self.made {
            JoinedText::Composed(Ok(composed)) => composed.features.clone(),
            JoinedText::Composed(Err(_)) => self.open().map(|composed| composed.features).unwrap_or_default(),
            JoinedText::Compiled { file, .. } => compose::features(file),
        }
    }

    /// Errors about names that a text in WGSL lacks and that nobody means to declare.
    pub fn unknown_names(&self) -> Vec<Diagnostic> {
        match &self.made {
            JoinedText::Composed(Ok(composed)) => composed.unknown_names(),
            JoinedText::Composed(Err(_)) | JoinedText::Compiled { .. } => Vec::new(),
        }
    }

    /// The text, or the file itself where something is wrong.
    pub fn file(&self, own: &SourceFile) -> SourceFile {
        match &self.made {
            JoinedText::Composed(composed) => {
                composed.as_ref().map_or_else(|_| own.clone(), |composed| composed.file.clone())
            }
            JoinedText::Compiled { file, .. } => file.clone(),
        }
    }

    /// The text as a module. A text that lacks declarations is told as such, and not as one with errors.
    ///
    /// # Errors
    /// As of [`ModuleText::read`], and what is wrong with the files.
    pub fn module(&self) -> Result<ModuleText, ProgramError> {
        let composed = match &self.made {
            JoinedText::Composed(composed) => composed.as_ref().map_err(|found| ProgramError::Source(found.clone()))?,
            JoinedText::Compiled { file, folders, defines, asked } => {
                return read_compiled(file, folders, defines, asked).map(|(text, _)| text);
            }
        };
        ModuleText::read(&composed.file, Written::Wgsl).map_err(|error| match (error, composed.fragment()) {
            (ProgramError::Source(_), Some(fragment)) => ProgramError::Source(vec![fragment]),
            (error, _) => authored_error(error, composed),
        })
    }

    /// Of a text that lacks declarations: what stands alone, and the functions that do not. None where nothing is lacking,
    /// or nothing is left.
    ///
    /// # Errors
    /// As of [`ModuleText::read`]: what is wrong beside what is lacking.
    pub fn rest(&self) -> Option<Result<(ModuleText, &[LeftOut]), ProgramError>> {
        let JoinedText::Composed(Ok(composed)) = &self.made else { return None };
        let rest = composed.rest.as_ref()?;
        let text = ModuleText::read(&rest.file, Written::Wgsl).map_err(|error| authored_error(error, composed));
        Some(text.map(|text| (text, &rest.left_out[..])))
    }

    /// Values for the `override` constants of a module: those that mean nothing else.
    pub fn values(&self, text: &ModuleText, defines: &[(String, String)]) -> Vec<(String, String)> {
        let constants = text.overrides();
        let is_constant = |name: &str| constants.iter().any(|(constant, _)| constant == name);
        let wanted = |(name, _): &&(String, String)| is_constant(name) || !self.stated.contains(name);
        defines.iter().filter(wanted).cloned().collect()
    }

    /// True where values are taken for names and placeholders that nothing states: what is found rests on them.
    pub fn is_assumed(&self) -> bool {
        matches!(&self.made, JoinedText::Composed(Ok(composed)) if composed.is_assumed())
    }

    /// What is worth knowing: where names come from that the text does not say.
    pub fn notes(&self) -> Vec<String> {
        let composed = match &self.made {
            JoinedText::Composed(Ok(composed)) => composed,
            JoinedText::Composed(Err(_)) => return Vec::new(),
            JoinedText::Compiled { file, asked, .. } => return reader(file, asked),
        };
        let taken = composed.guessed.iter().map(|guess| format!("`{}` is taken from {}", guess.name, guess.file));
        let told = composed.notes.iter().flat_map(|note| {
            let at = |file: &SourceFile, span: Span, text: &str| format!("{}: {text}", file.locate(span.start));
            let note = note.clone().at_origin();
            let related = note.related.iter().map(|label| at(&label.file, label.span, &label.message));
            std::iter::once(at(&note.file, note.span, &note.message)).chain(related).collect::<Vec<_>>()
        });
        let assigned =
            composed.assigned.then(|| "no resource has a binding; a host is taken to assign them".to_owned());
        taken.chain(told).chain(assigned).collect()
    }
}

fn authored_error(error: ProgramError, composed: &Composed) -> ProgramError {
    let ProgramError::Source(found) = error else { return error };
    ProgramError::Source(found.into_iter().map(|found| authored(found, composed)).collect())
}

/// Which compiler reads a text.
fn reader(file: &SourceFile, asked: &Asked) -> Vec<String> {
    let Ok(compiler) = super::compiled::compiler(Written::of(file), asked.compiler.as_deref()) else {
        return Vec::new();
    };
    let version = compiler.version().map_or_else(|_| String::new(), |version| format!(" {version}"));
    vec![format!("{} is read by {}{version}; lanes share its reading", file.name(), compiler.name())]
}

/// A diagnostic with names as their authors write them.
fn authored(diagnostic: Diagnostic, composed: &Composed) -> Diagnostic {
    let plain = |text: &str| {
        let mut text = text.to_owned();
        for renamed in &composed.renamed {
            text = text.replace(&format!("`{}`", renamed.written), &format!("`{}`", renamed.name));
            text = text.replace(&format!("'{}'", renamed.written), &format!("'{}'", renamed.name));
        }
        text
    };
    let (message, label) = (Message::from(plain(&diagnostic.message)), Message::from(plain(&diagnostic.label)));
    Diagnostic { message, label, ..diagnostic }
}
