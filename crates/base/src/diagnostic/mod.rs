//! Diagnostics as data: code, severity, place, explanation, fix. A leaf of the dependency graph;
//! drawing them is the work of `report`.

mod message;

use std::fmt;

pub use crate::message;
use crate::text::{Edit, Expansion, SourceFile, Span};
pub use message::{Lang, Message};

/// A stable rule code such as `T001`: a family letter and three digits. Codes are never reused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Code(pub &'static str);

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

/// How bad a diagnostic is. Errors and warnings are findings; information is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth knowing; never changes the exit status.
    Info,
    /// Probably wrong.
    Warning,
    /// Wrong.
    Error,
}

impl Severity {
    /// `error`, `warning` or `info`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Info => "info",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// Whether a fix may be applied without asking.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Safety {
    /// The meaning is kept, or the text was invalid and has one sensible reading.
    Safe,
    /// Results may change; needs `--unsafe-fixes`.
    Unsafe,
}

/// A change that repairs what a diagnostic reports, in the file of the diagnostic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// What the fix does, as an imperative sentence without a full stop.
    pub title: Message,
    /// The edits; they do not overlap.
    pub edits: Vec<Edit>,
    /// Whether it may be applied without asking.
    pub safety: Safety,
}

/// A further place that belongs to a diagnostic, possibly in another file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The file of the place.
    pub file: SourceFile,
    /// The place.
    pub span: Span,
    /// What is to be seen there.
    pub message: Message,
}

/// One thing to tell about a text: what is wrong, why, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The rule.
    pub code: Code,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong: one sentence in words about the source, without a full stop.
    pub message: Message,
    /// The file that the text is from, with its name and all its lines.
    pub file: SourceFile,
    /// The place in the file.
    pub span: Span,
    /// What stands at the place, in a few words; shown beside the underlined text.
    pub label: Message,
    /// Other places that the message refers to, such as a declaration.
    pub related: Vec<Label>,
    /// Why it is wrong or what happens.
    pub why: Option<Message>,
    /// What to do when there is no fix, or besides it.
    pub help: Option<Message>,
    /// The repair, when there is one.
    pub fix: Option<Fix>,
}

impl Diagnostic {
    /// A diagnostic with the required parts only.
    pub fn new(code: Code, severity: Severity, file: &SourceFile, span: Span, message: impl Into<Message>) -> Self {
        Self {
            code,
            severity,
            message: message.into().printable(),
            file: file.clone(),
            span,
            label: Message::default(),
            related: Vec::new(),
            why: None,
            help: None,
            fix: None,
        }
    }

    /// The same with the macro that wrote what has this place, and where it is defined.
    #[must_use]
    pub fn in_expansion(mut self) -> Self {
        let Some(Expansion { span: _, name, definition }) = self.file.expansion(self.span).cloned() else {
            return self;
        };
        let en = format!("{} (in the expansion of `{name}`)", self.message);
        // A diagnostic that has been through this is as it should be.
        if self.message.ends_with(&en[self.message.len()..]) {
            return self;
        }
        self.message = if self.message.is_translated() {
            Message::new(en, format!("{}（マクロ `{name}` の展開）", self.message.in_lang(Lang::Ja)))
        } else {
            en.into()
        };
        if let Some(definition) = definition {
            let file = self.file.clone();
            self = self.with_related(&file, definition, message!("the macro is defined here", "マクロの定義"));
        }
        self
    }

    /// The same about the files that an assembled text comes from: one with its includes read, for
    /// example. A repair of such a text is dropped, since it is none of those files.
    #[must_use]
    pub fn at_origin(self) -> Self {
        let mut this = self.in_expansion();
        let (file, span) = this.file.origin(this.span);
        if file != this.file {
            this.fix = None;
            (this.file, this.span) = (file, span);
        }
        for label in &mut this.related {
            (label.file, label.span) = label.file.origin(label.span);
        }
        this
    }

    /// Sets the words beside the underlined text.
    #[must_use]
    pub fn with_label(mut self, label: impl Into<Message>) -> Self {
        self.label = label.into();
        self
    }

    /// Adds a further place.
    #[must_use]
    pub fn with_related(mut self, file: &SourceFile, span: Span, message: impl Into<Message>) -> Self {
        self.related.push(Label { file: file.clone(), span, message: message.into() });
        self
    }

    /// Sets the reason.
    #[must_use]
    pub fn with_why(mut self, why: impl Into<Message>) -> Self {
        self.why = Some(why.into());
        self
    }

    /// Sets the advice.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<Message>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Sets the fix.
    #[must_use]
    pub fn with_fix(mut self, title: impl Into<Message>, safety: Safety, edits: Vec<Edit>) -> Self {
        self.fix = Some(Fix { title: title.into(), edits, safety });
        self
    }
}
