//! Where the parts of the front end put their diagnostics.

use super::errors;
use base::diagnostic::{Code, Diagnostic, Message, Severity};
use base::text::{Expansion, SourceFile, Span};

/// Collects errors about one file.
#[derive(Debug)]
pub(crate) struct Sink {
    pub file: SourceFile,
    list: Vec<Diagnostic>,
    /// Places whose text is not known, in order and apart: what stands there may be right.
    pub holes: Vec<Span>,
    /// Macros that are expanded, before the file knows them.
    pub expansions: Vec<Expansion>,
}

/// Garbage can give an error at every token; nobody reads more than these.
const MOST: usize = 200;

impl Sink {
    pub(crate) fn new(file: &SourceFile) -> Self {
        Self { file: file.clone(), list: Vec::new(), holes: Vec::new(), expansions: Vec::new() }
    }

    /// Adds an error with words for the place.
    pub(crate) fn error(&mut self, code: Code, span: Span, message: impl Into<Message>, label: impl Into<Message>) {
        let file = self.file.clone();
        self.push(Diagnostic::new(code, Severity::Error, &file, span, message).with_label(label));
    }

    pub(crate) fn push(&mut self, diagnostic: Diagnostic) {
        let unknown = || {
            let before = self.holes.partition_point(|hole| hole.start <= diagnostic.span.end);
            self.holes[..before].iter().rev().take(2).any(|hole| hole.touches(diagnostic.span))
        };
        if self.list.len() < MOST && (diagnostic.code == errors::TOKEN || !unknown()) {
            self.list.push(diagnostic);
        }
    }

    /// Adds places whose text is not known.
    pub(crate) fn fill_in(&mut self, more: impl Iterator<Item = Span>) {
        self.holes.extend(more);
        self.holes.sort_unstable();
        self.holes.dedup_by(|next, last| {
            let one = next.touches(*last);
            *last = if one { last.to(*next) } else { *last };
            one
        });
    }

    /// How many are told.
    pub(crate) fn len(&self) -> usize {
        self.list.len()
    }

    /// Takes back all but the first ones.
    pub(crate) fn truncate(&mut self, len: usize) {
        self.list.truncate(len);
    }

    /// Ends the reading of macros: the file knows where they are expanded from here on.
    pub(crate) fn expanded(&mut self) {
        let expansions = std::mem::take(&mut self.expansions);
        self.file = self.file.clone().with_expansions(expansions);
    }

    /// The codes of what has been found.
    pub(crate) fn codes(&self) -> impl Iterator<Item = Code> {
        self.list.iter().map(|d| d.code)
    }

    /// True when something was told with that code.
    pub(crate) fn has(&self, code: Code) -> bool {
        self.list.iter().any(|d| d.code == code)
    }

    /// A diagnostic to be completed and pushed.
    pub(crate) fn start(&self, code: Code, span: Span, message: impl Into<Message>) -> Diagnostic {
        Diagnostic::new(code, Severity::Error, &self.file, span, message)
    }

    /// All diagnostics in the order of the text. Where reading ended at a limit, the first of these alone: what is not read lacks whatever
    /// would follow from it.
    pub(crate) fn finish(mut self) -> Vec<Diagnostic> {
        self.list.sort_by_key(|d| d.span.start);
        if let Some(limit) = self.list.iter().position(|d| d.code == errors::TOO_DEEP) {
            self.list = vec![self.list.swap_remove(limit)];
        }
        self.list
    }
}
