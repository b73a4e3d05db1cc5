//! Texts in the WGSL of 2020 to 2022, brought to the language of today by edits.
//!
//! Before its syntax settled, WGSL had attributes in double brackets, `let` at module scope, members that end with
//! semicolons, and other names for several things. What was only spelled differently is replaced in place, so that
//! every other byte remains its author's. What has no equivalent is reported by name.
//!
//! A text is a draft if its grammar is no longer valid. Only then are constructs that are valid in both languages but
//! mean something else, such as sizes of textures, read as they were meant.

mod attribute;
mod library;
mod shadowed;

use base::diagnostic::{Diagnostic, Safety, Severity};
use base::text::{Assembly, Edit, SourceFile, Span};
use syntax::errors;

use crate::Problems;
use crate::token::{Kind, Token, brackets, tokens};

/// Types and functions that had another name, each with the name of today.
const RENAMED: &[(&str, &str)] = &[
    ("texture_sampled_1d", "texture_1d"),
    ("texture_sampled_2d", "texture_2d"),
    ("texture_sampled_2d_array", "texture_2d_array"),
    ("texture_sampled_3d", "texture_3d"),
    ("texture_sampled_cube", "texture_cube"),
    ("texture_sampled_cube_array", "texture_cube_array"),
    ("smoothStep", "smoothstep"),
];

/// Functions and statements that the language has lost.
const GONE: &[&str] = &["isNan", "isInf", "isFinite", "isNormal", "fallthrough"];

/// A text in the language of today.
pub(crate) struct Current {
    pub file: SourceFile,
    /// That the text is an early draft, with the edits that repair it. None where nothing had to be changed.
    pub note: Option<Diagnostic>,
}

/// Reads a text as WGSL of today.
pub(crate) fn modernise(file: &SourceFile, problems: &mut Problems) -> Current {
    let tokens = tokens(file.text());
    let unchanged = Current { file: file.clone(), note: None };
    if tokens.is_empty() {
        return unchanged;
    }
    let behind = brackets(&tokens);
    let mut pass = Pass {
        file,
        tokens: &tokens,
        behind: &behind,
        problems,
        edits: Vec::new(),
        kinds: Vec::new(),
        strides: Vec::new(),
        overrides: None,
    };
    pass.syntax();
    if pass.edits.is_empty() {
        return unchanged;
    }
    pass.library();
    pass.shadowed();
    pass.finish()
}

/// A layout attribute that has to say what the language says anyway.
struct Stride {
    span: Span,
    /// Bytes from one element to the next.
    bytes: u64,
    /// The type of the elements, as tokens.
    element: std::ops::Range<usize>,
}

struct Pass<'a> {
    file: &'a SourceFile,
    tokens: &'a [Token],
    /// The token behind each bracket.
    behind: &'a [usize],
    problems: &'a mut Problems,
    edits: Vec<Edit>,
    /// What was changed, for the note, in the order of the text.
    kinds: Vec<&'static str>,
    strides: Vec<Stride>,
    /// The token at which `[[override]]` ends: the keyword behind it becomes `override`.
    overrides: Option<usize>,
}

/// What a brace holds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Brace {
    Members,
    Statements,
}

impl Pass<'_> {
    fn word(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", |token| self.file.slice(token.span))
    }

    fn span(&self, from: usize, end: usize) -> Span {
        let last = self.tokens.len() - 1;
        let (first, last) = (self.tokens[from.min(last)].span, self.tokens[end.saturating_sub(1).min(last)].span);
        first.to(last)
    }

    fn change(&mut self, span: Span, to: impl Into<String>, kind: &'static str) {
        self.edits.push(Edit::replace(span, to));
        if !self.kinds.contains(&kind) {
            self.kinds.push(kind);
        }
    }

    fn refuse(&mut self, span: Span, what: &str, help: &str) {
        let message = format!("{what} of early drafts of WGSL has no equivalent");
        self.problems.add(errors::EARLY_DRAFT, self.file, span, message, help);
    }

    /// What the grammar of today does not have: where it stands, the text is a draft.
    fn syntax(&mut self) {
        let mut open: Vec<Brace> = Vec::new();
        let (mut members, mut at) = (false, 0);
        let legacy = (0..self.tokens.len()).any(|at| self.is_double_bracket(at));
        while at < self.tokens.len() {
            if self.is_double_bracket(at) {
                at = self.bracketed(at);
                continue;
            }
            let before = at.checked_sub(1).map_or("", |before| self.word(before)).to_owned();
            let starts = matches!(before.as_str(), "" | ";" | "}") || self.overrides == Some(at);
            let (word, span) = (self.word(at).to_owned(), self.tokens[at].span);
            match word.as_str() {
                "@" => {
                    at = self.single(at);
                    continue;
                }
                "{" => {
                    open.push(if members { Brace::Members } else { Brace::Statements });
                    members = false;
                }
                "}" => {
                    open.pop();
                }
                "struct" if open.is_empty() => members = true,
                ";" if open.last() == Some(&Brace::Members) && before != ";" => {
                    self.change(span, ",", "members end with `,`");
                }
                ";" if open.is_empty() => members = false,
                "elseif" if before == "}" => self.change(span, "else if", "`elseif` is `else if`"),
                "let" | "const" if self.overrides == Some(at) => {
                    self.change(span, "override", "`[[override]]` is `override`");
                }
                "let" if open.is_empty() && starts => {
                    self.change(span, "const", "`let` at module scope is `const`");
                }
                // The drafts that had it in functions had no other word for a value without a variable.
                "const"
                    if legacy && !open.is_empty() && self.tokens.get(at + 1).is_some_and(|t| t.kind == Kind::Word) =>
                {
                    self.change(span, "let", "`const` in a function is `let`");
                }
                "type" if open.is_empty() && starts => self.change(span, "alias", "`type` is `alias`"),
                "->" if self.word(at + 1) == "void" => {
                    self.change(self.span(at, at + 2), "", "a function without a result has no `-> void`");
                }
                "var" if self.word(at + 1) == "<" => self.storage(at),
                "entry_point" if open.is_empty() && starts => {
                    let help = "write `@vertex`, `@fragment` or `@compute` in front of the function";
                    self.refuse(span, "`entry_point`", help);
                }
                _ => self.name(at),
            }
            at += 1;
        }
    }

    fn is_double_bracket(&self, at: usize) -> bool {
        let kind = |at: usize| self.tokens.get(at).map(|token| token.kind);
        kind(at) == Some(Kind::OpenBracket)
            && kind(at + 1) == Some(Kind::OpenBracket)
            && kind(at + 2) == Some(Kind::Word)
            && self.tokens[at].span.end == self.tokens[at + 1].span.start
    }

    /// Names of the library that it no longer has, where the text neither declares nor imports them.
    fn name(&mut self, at: usize) {
        let word = self.word(at);
        let called = self.word(at + 1);
        let renamed = RENAMED.iter().find(|(old, _)| *old == word && matches!(called, "(" | "<"));
        let gone = GONE.iter().find(|gone| **gone == word && matches!(called, "(" | ";"));
        if renamed.is_none() && gone.is_none() || self.is_own(word) {
            return;
        }
        let span = self.tokens[at].span;
        if let Some((_, new)) = renamed {
            self.change(span, *new, "functions and types have their names of today");
        } else if let Some(gone) = gone {
            self.refuse(span, &format!("`{gone}`"), "test it by comparisons, or leave it out");
        }
    }

    /// True for a name that the text gives a meaning of its own, or takes from a file: it is then more than called.
    fn is_own(&self, word: &str) -> bool {
        (0..self.tokens.len()).any(|at| {
            self.word(at) == word
                && (at
                    .checked_sub(1)
                    .is_some_and(|before| matches!(self.word(before), "fn" | "." | "::" | "let" | "var"))
                    || !matches!(self.word(at + 1), "(" | "<" | ";"))
        })
    }

    /// `var<…>` with storage classes that went away.
    fn storage(&mut self, at: usize) {
        let class = self.tokens.get(at + 2).map_or(Span::at(0), |token| token.span);
        match self.word(at + 2) {
            "uniform_constant" | "handle" if self.word(at + 3) == ">" => {
                self.change(self.span(at + 1, at + 4), "", "textures and samplers have no storage class");
            }
            "storage" if self.word(at + 3) == "," && self.word(at + 4) == "write" => {
                self.change(self.tokens[at + 4].span, "read_write", "a buffer that is written can be read");
            }
            "storage_buffer" => self.change(class, "storage", "`storage_buffer` is `storage`"),
            word @ ("in" | "out") => {
                let what = format!("`var<{word}>`");
                let help = "make inputs parameters of the entry point, and outputs its result";
                self.refuse(class, &what, help);
            }
            _ => {}
        }
    }

    fn finish(mut self) -> Current {
        self.edits.sort_by_key(|edit| (edit.span.start, edit.span.end));
        let mut out = Assembly::new();
        let mut at = 0;
        for Edit { span, replacement } in &self.edits {
            out.copy(self.file, Span::new(at, span.start));
            out.replace(replacement, self.file, *span);
            at = span.end;
        }
        out.copy(self.file, Span::new(at, self.file.text().len()));
        let file = out.finish(self.file.name());
        self.check_strides(&file);
        let first = self.edits[0].span;
        let first = if first.is_empty() { first } else { Span::new(first.start, first.start + 1) };
        let note = Diagnostic::new(
            errors::EARLY_DRAFT,
            Severity::Info,
            self.file,
            first,
            "an early draft of WGSL, read as the language of today",
        )
        .with_why(self.kinds.join("; "));
        let selects = (0..self.tokens.len()).find(|&at| self.word(at) == "select" && self.word(at + 1) == "(");
        // Both readings of `select` are sensible.
        let safety = if selects.is_some() { Safety::Unsafe } else { Safety::Safe };
        let note = match selects {
            Some(at) => note.with_related(
                self.file,
                self.tokens[at].span,
                "read as `select(if_false, if_true, condition)`; texts from before August 2021 have the first two the other way round",
            ),
            None => note,
        };
        let note = note.with_fix("write it in WGSL of today", safety, self.edits.clone());
        Current { file, note: Some(note) }
    }
}
