//! One WGSL text from files that import each other, with the way back to each of them.
//!
//! Almost none of an engine's files stands alone. What their hosts do to them before a compiler sees them is done here:
//! the imports and conditions of [WESL](https://github.com/wgsl-tooling-wg/wesl-spec), the modules and directives of
//! naga_oil, `#include`, `#ifdef` and `#define` as in C, and placeholders of template engines. Files are read by the
//! caller, who is asked for them by a [`Library`].
//!
//! The text is cut and joined, and never printed anew: each byte of what comes out is a byte of a file or stands for one,
//! so that whatever is told about it is told about the file. That is why neither the crate `wesl` nor `naga_oil` is used:
//! the first prints its syntax tree and keeps places of declarations at most, the second gives a module that has been
//! through naga's printer several times, where constants have lost the digits that their author wrote.
//!
//! A name is changed only where two files would collide, and then in the whole file, so that local variables still
//! hide what they hid.

mod condition;
mod declaration;
mod draft;
mod features;
mod import;
mod link;
mod module;
mod naming;
mod predeclared;
mod stand_in;
mod template;
mod token;

#[cfg(test)]
mod tests;

use std::collections::{BTreeSet, HashSet};

use base::diagnostic::{Code, Diagnostic, Severity, message};
use base::text::{SourceFile, Span};
pub use features::features;
pub use import::{ModulePath, Origin};
pub use link::ASSERTIONS;
pub use syntax::include::Wanted;
use syntax::{TokenKind, errors};

/// Where files come from.
pub trait Library {
    /// The file that an `#include` asks for, or an `#import` of a file; none where there is none.
    fn include(&mut self, wanted: &Wanted) -> Option<SourceFile>;

    /// The module at a path, asked for by a file; none where there is none. Without names, it is the file of the origin
    /// itself: the root of the package, or the module above.
    fn module(&mut self, from: &SourceFile, path: &ModulePath) -> Option<SourceFile>;

    /// Paths of modules that the file may have meant, for a suggestion.
    fn modules(&mut self, from: &SourceFile) -> Vec<String>;

    /// Files that may be parts of the same text, where the host joins them.
    fn siblings(&mut self, from: &SourceFile) -> Vec<SourceFile>;

    /// Further files that may be, folder by folder outwards; none where nothing is to be guessed.
    fn around(&mut self, _from: &SourceFile) -> Vec<Vec<SourceFile>> {
        Vec::new()
    }
}

/// What is stated from outside.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Names with values: features of WESL, macros, placeholders, and numbers in the package `constants`. An empty
    /// value states the name alone; `false` turns a feature off.
    pub defines: Vec<(String, String)>,
    /// Files that the host puts before the text: what the text does not declare is taken from them.
    pub preludes: Vec<SourceFile>,
    /// Gives resources a group and a binding where none of them has one, as hosts do that assign them.
    pub assign_bindings: bool,
    /// Lets names stand in for placeholders without a value, and reads the first branch of each condition of a template:
    /// for readers that look for faults in a text that nobody runs.
    pub stand_ins: bool,
    /// Assumes no declaration for a name that nothing declares: for readers that tell such names.
    pub assume_nothing: bool,
    /// Leaves placeholders without a value empty where they have a line for themselves, as those of more members and of
    /// padding are. [`compose`] tries it by itself.
    pub empty_lines: bool,
    /// Takes names that are imported from what is not there for undeclared ones, and gives what has no value the one that
    /// its place asks for: for readers that declare what a text lacks.
    pub open: bool,
}

/// A text from several files.
#[derive(Clone, Debug)]
pub struct Composed {
    /// The text, in WGSL. It has the name of the file that was composed, and leads back to the file of each part.
    pub file: SourceFile,
    /// Declarations that bear another name in the text than in their files.
    pub renamed: Vec<Renamed>,
    /// Names that were taken from a file that is no part of the text by what it says.
    pub guessed: Vec<Guessed>,
    /// True when the resources got bindings that their author did not write.
    pub assigned: bool,
    /// Names that neither the text declares nor the language.
    pub undeclared: Vec<Undeclared>,
    /// Worth knowing: imports of what is not there that nothing uses, and files in an early draft of the language.
    pub notes: Vec<Diagnostic>,
    /// Names of [`Options::defines`] that one of the files mentions.
    pub stated: Vec<String>,
    /// Names that conditions of its files ask for.
    pub features: Vec<String>,
    /// The text without what lacks a declaration, where it lacks some and functions are left.
    pub rest: Option<Rest>,
}

/// What stands alone of a text that lacks declarations.
#[derive(Clone, Debug)]
pub struct Rest {
    /// The text.
    pub file: SourceFile,
    /// Functions of the file that go with what is lacking, in the order of the file.
    pub left_out: Vec<LeftOut>,
}

/// A function that needs a name that nothing declares.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Its name.
    pub name: String,
    /// `file:line:column` of its name.
    pub at: String,
    /// The name that it needs.
    pub lacks: String,
}

/// A declaration under another name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Renamed {
    /// Its name in the text.
    pub written: String,
    /// Its name in its file.
    pub name: String,
    /// The name of its file.
    pub file: String,
}

/// A name that is declared in a file beside this one, and nowhere else.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Guessed {
    /// The name.
    pub name: String,
    /// The file that it was taken from.
    pub file: String,
}

/// A name that nothing declares.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undeclared {
    /// The name.
    pub name: String,
    /// Its first use, in the composed text.
    pub span: Span,
    /// True where that use calls it.
    pub called: bool,
    /// Files that declare it, in different ways.
    pub candidates: Vec<String>,
    /// The condition under which it would be declared, as it is written.
    pub condition: Option<String>,
    /// True where a file is imported as a whole that is not there, which may declare it.
    pub beyond: bool,
}

impl Composed {
    /// True where values are taken for names and placeholders that nothing states: what is found rests on them.
    pub fn is_assumed(&self) -> bool {
        self.notes.iter().any(|note| note.code == errors::TEMPLATE)
    }

    /// The name of a declaration as its author writes it; the name itself where it is the author's.
    pub fn authored<'a>(&'a self, written: &'a str) -> &'a str {
        self.renamed.iter().find(|r| r.written == written).map_or(written, |r| &r.name)
    }

    /// One error for each name that nothing declares, at its first use, with the name that was probably meant. What files
    /// beside this one declare, and what a condition leaves out, is named.
    pub fn unknown_names(&self) -> Vec<Diagnostic> {
        let text = self.file.text();
        let missing: HashSet<&str> = self.undeclared.iter().map(|u| u.name.as_str()).collect();
        let words = syntax::wgsl::tokens(text).into_iter().filter(|token| token.kind == TokenKind::Word);
        let own = words
            .map(|token| &text[token.span.range()])
            .filter(|word| !missing.contains(word) && !predeclared::is_keyword(word));
        let mut known: BTreeSet<&str> = own.collect();
        for name in predeclared::types_and_functions() {
            known.insert(name);
        }
        let error = |lacking: &Undeclared| {
            let name = lacking.name.as_str();
            let before = text[..lacking.span.start].trim_end();
            let code = match () {
                () if lacking.called => errors::UNKNOWN_FUNCTION,
                () if before.ends_with([':', '<']) || before.ends_with("->") => errors::UNKNOWN_TYPE,
                () => errors::UNKNOWN_NAME,
            };
            let message = message!("`{name}` is not declared", "`{name}` は宣言されていません");
            let new = Diagnostic::new(code, Severity::Error, &self.file, lacking.span, message)
                .with_label(message!("unknown name", "未知の名前"));
            let others = known.iter().copied().filter(|own| Some(*own) != declares(before));
            let new = match (&lacking.condition, &lacking.candidates[..]) {
                (Some(condition), _) => {
                    new.with_why(message!("it is declared under `{condition}`", "`{condition}` の下で宣言されています"))
                }
                (None, files @ [_, ..]) => {
                    let files = files.join(", ");
                    new.with_why(message!("{files} declare it differently", "{files} の宣言が異なります"))
                }
                (None, []) if lacking.beyond => new.with_why(message!(
                    "a module that is imported as a whole, and is not found, may declare it",
                    "全体がインポートされ、見つからないモジュールが宣言しているかもしれません"
                )),
                (None, []) if self.undeclared.len() > syntax::MOST_SLIPS => new,
                (None, []) => match syntax::nearest(name, others) {
                    Some(near) => new.with_help(message!("did you mean `{near}`?", "`{near}` のことですか")),
                    None => new,
                },
            };
            new.at_origin()
        };
        self.undeclared.iter().map(error).collect()
    }

    /// What to tell where the text lacks declarations: which names, and what to do. None where it lacks none.
    pub fn fragment(&self) -> Option<Diagnostic> {
        let first = self.undeclared.first()?;
        let names: Vec<String> = self.undeclared.iter().map(|u| format!("`{}`", u.name)).collect();
        let (shown, more) = names.split_at(names.len().min(5));
        let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        let verb = if names.len() == 1 { "is" } else { "are" };
        let message = format!("this text is a part of another: {}{more} {verb} declared nowhere", shown.join(", "));
        let help = match (&first.condition, &first.candidates[..]) {
            (Some(condition), _) => {
                format!("`{}` is declared under `{condition}`: state it with `--define`", first.name)
            }
            (None, []) => "name the file that declares it with `--with FILE`".to_owned(),
            (None, several) => {
                format!("choose one of the files that declare it with `--with FILE`: {}", several.join(", "))
            }
        };
        let new = Diagnostic::new(errors::FRAGMENT, Severity::Error, &self.file, first.span, message);
        Some(new.with_label("first used here").with_help(help).at_origin())
    }
}

/// The name that a declaration gives, from its text up to a place in its value: nobody means it there.
fn declares(before: &str) -> Option<&str> {
    let statement = before.rsplit([';', '{', '}']).next()?;
    let (head, _) = statement.split_once('=')?;
    let mut words = head.split(':').next()?.split_whitespace().rev();
    let (name, keyword) = (words.next()?, words.next()?);
    ["const", "override", "let", "var", "var<private>"].contains(&keyword).then_some(name)
}

/// What to do about a file or package that is not there.
pub(crate) const NAME_ITS_FOLDER: &str = "name its folder with `-I FOLDER`";

/// True for errors that files which are not here take away: packages that nobody has named, and names that may stand there.
/// A name that a module which is here does not declare is none of them.
pub fn lack_files(found: &[Diagnostic]) -> bool {
    let of_folder = |error: &Diagnostic| error.help.as_ref().is_some_and(|help| *help == NAME_ITS_FOLDER);
    let gone = |error: &Diagnostic| error.code == errors::IMPORT && of_folder(error);
    found.iter().any(gone) && found.iter().all(|error| error.code == errors::FRAGMENT || gone(error))
}

/// Joins a file and what it imports. A file that needs nothing comes out as it is.
///
/// # Errors
/// Diagnostics at places of the files: what is imported and not there, circles, conditions and placeholders without a
/// value, directives that are not understood.
pub fn compose(root: &SourceFile, options: &Options, library: &mut dyn Library) -> Result<Composed, Vec<Diagnostic>> {
    let mut problems = Problems::default();
    let mut composed = link::link(root, options, library, &mut problems);
    // What stands on lines of its own may be nothing, where the text lacks nothing without it.
    if !options.empty_lines && !problems.found.is_empty() && problems.found.iter().all(is_unstated) {
        let mut left = Problems::default();
        let again = link::link(root, &Options { empty_lines: true, ..options.clone() }, library, &mut left);
        if left.found.is_empty() && again.undeclared.is_empty() && again.file.text().contains("fn ") {
            return Ok(again);
        }
    }
    if !options.stand_ins
        && !options.assume_nothing
        && problems.found.is_empty()
        && let Some((more, notes)) = template::declared(root, &composed)
    {
        let again = link::link(&more, options, library, &mut problems);
        if again.undeclared.len() < composed.undeclared.len() {
            composed = Composed { notes: [again.notes, notes].concat(), ..again };
        }
    }
    if problems.found.is_empty() { Ok(composed) } else { Err(problems.found) }
}

/// What [`Composed::unknown_names`] gives, also where modules that are imported are not there: what an import names is
/// declared by it. Nothing where more is wrong with the files.
pub fn unknown_names(root: &SourceFile, options: &Options, library: &mut dyn Library) -> Vec<Diagnostic> {
    let mut problems = Problems::default();
    let composed = link::link(root, options, library, &mut problems);
    let of_imports = problems.found.iter().all(|problem| problem.code == errors::IMPORT);
    if of_imports { composed.unknown_names() } else { Vec::new() }
}

/// True for a placeholder that has no value.
fn is_unstated(problem: &Diagnostic) -> bool {
    problem.code == errors::TEMPLATE && problem.message.to_string().ends_with("has no value")
}

/// A text in an early draft of WGSL as the language has it today, without its imports, and that it is such a text. None
/// for every other text.
pub fn from_draft(file: &SourceFile) -> Option<(SourceFile, Diagnostic)> {
    let draft::Current { file, note } = draft::modernise(file, &mut Problems::default());
    Some((file, note?))
}

/// What is wrong with the files.
#[derive(Debug, Default)]
pub(crate) struct Problems {
    pub found: Vec<Diagnostic>,
}

/// Nobody reads more than these.
const MOST: usize = 100;

impl Problems {
    pub(crate) fn add(&mut self, code: Code, file: &SourceFile, span: Span, message: impl Into<String>, help: &str) {
        if self.found.len() < MOST {
            let new = Diagnostic::new(code, Severity::Error, file, span, message.into());
            self.take(new.with_help(help.to_owned()));
        }
    }

    /// Takes in what is known already.
    pub(crate) fn take(&mut self, new: Diagnostic) {
        if self.found.len() < MOST {
            let new = new.at_origin();
            // A file that is included several times is read several times.
            if !self.found.contains(&new) {
                self.found.push(new);
            }
        }
    }

    /// Files that lead back to themselves; `chain` begins and ends with neighbours of the place.
    pub(crate) fn cycle(&mut self, file: &SourceFile, span: Span, chain: &[&str]) {
        let (message, help) = match chain {
            [_] => ("this file takes in itself".to_owned(), "remove this line".to_owned()),
            [first, ..] => {
                let circle = format!("{} → {first}", chain.join(" → "));
                (
                    format!("these files take in each other: {circle}"),
                    "move what both need into a third file".to_owned(),
                )
            }
            [] => return,
        };
        self.add(errors::IMPORT_CYCLE, file, span, message, &help);
    }
}
