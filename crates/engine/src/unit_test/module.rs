//! Tests in WGSL: `@test fn name() { … }`, as the package `wgsl_test` for WESL has them.

use base::text::{Assembly, SourceFile, Span};
use compose::ASSERTIONS;
use syntax::wgsl;

use super::mark::{Marked, UnitTest, WANTED, entry, is_assertion};

/// The words of a text, with their places.
struct Words<'t> {
    file: &'t SourceFile,
    spans: Vec<Span>,
}

impl Words<'_> {
    fn at(&self, k: usize) -> &str {
        self.spans.get(k).map_or("", |span| self.file.slice(*span))
    }

    /// The word behind the bracket that opens at a word; the next one where none opens.
    fn behind(&self, open: usize) -> usize {
        let mut depth = 0_usize;
        for k in open..self.spans.len() {
            match self.at(k) {
                "(" => depth += 1,
                ")" => depth = depth.saturating_sub(1),
                _ => {}
            }
            if depth == 0 {
                return k + 1;
            }
        }
        self.spans.len()
    }

    /// From the first word of a range to its last.
    fn span(&self, from: usize, to: usize) -> Span {
        self.spans[from].to(self.spans[to - 1])
    }
}

/// What is changed in the text.
#[derive(Default)]
struct Changes {
    edits: Vec<(Span, String)>,
    marked: Vec<UnitTest>,
    sites: Vec<Span>,
}

pub(super) fn mark(file: &SourceFile) -> Marked {
    let spans = wgsl::tokens(file.text()).into_iter().map(|token| token.span).collect();
    let words = Words { file, spans };
    let mut changes = Changes::default();
    for k in 0..words.spans.len() {
        if words.at(k) == "@" {
            changes.attribute(&words, k);
        } else if is_assertion(words.at(k)) && words.at(k + 1) == "(" {
            changes.assertion(&words, k);
        }
    }
    let Changes { mut edits, marked, sites } = changes;
    edits.sort_by_key(|(span, _)| span.start);
    let (mut out, mut at) = (Assembly::new(), 0);
    for (span, text) in edits {
        out.copy(file, Span::new(at, span.start));
        out.insert(&text, file, span.start);
        at = span.end;
    }
    let end = file.text().len();
    out.copy(file, Span::new(at, end));
    for test in marked.iter().filter(|test| test.refused.is_none()) {
        let call = &test.function;
        let body = format!("{ASSERTIONS}::wanted = {WANTED}; {call}(); return {ASSERTIONS}::record;");
        let text = format!("\nfn {}({WANTED}: u32) -> {ASSERTIONS}::Record {{ {body} }}\n", test.entry);
        out.insert(&text, file, test.span.start);
    }
    Marked { file: out.finish(file.name()), tests: marked, sites }
}

impl Changes {
    /// Notes a test, and makes memory of a buffer. The attributes themselves are no concern here: composing takes them out.
    fn attribute(&mut self, words: &Words<'_>, at: usize) {
        let attribute = words.at(at + 1);
        let open = words.at(at + 2) == "(";
        let end = if open { words.behind(at + 2) } else { at + 2 };
        // Other attributes may stand before what it is of.
        let mut of = end;
        while words.at(of) == "@" {
            of = if words.at(of + 2) == "(" { words.behind(of + 2) } else { of + 2 };
        }
        match (attribute, words.at(of)) {
            ("buffer", "var") if words.at(of + 1) == "<" => {
                // One invocation runs a test: its memory is as good as a buffer that begins with zeros.
                if let Some(close) = (of + 2..of + 8).find(|&k| words.at(k) == ">") {
                    self.edits.push((words.span(of + 1, close + 1), "<private>".to_owned()));
                }
            }
            ("test" | "snapshot", "fn") => {
                let own = words.at(of + 1).to_owned();
                let stated = (open && end > at + 4).then(|| words.file.slice(words.span(at + 3, end - 1)).to_owned());
                let takes = words.at(of + 3) != ")";
                let refused = match attribute {
                    "snapshot" => Some("it compares an image with a recorded one"),
                    _ => takes.then_some("it takes parameters, and nobody says which"),
                };
                let span = words.spans.get(of + 1).copied().unwrap_or_else(|| words.spans[at]);
                let name = stated.filter(|_| attribute == "test").unwrap_or_else(|| own.clone());
                let entry = entry(self.marked.len());
                let refused = refused.map(str::to_owned);
                self.marked.push(UnitTest { name, entry, function: own, span, refused });
            }
            _ => {}
        }
    }

    /// Numbers a call of an assertion that is a statement.
    fn assertion(&mut self, words: &Words<'_>, at: usize) {
        let text = |k: usize| words.at(k);
        let mut start = at;
        while start >= 2 && text(start - 1).ends_with(':') {
            // `::` is one word or two.
            start -= if text(start - 1) == "::" { 2 } else { 3.min(start) };
        }
        if start == 0 || !matches!(text(start - 1), ";" | "{" | "}") {
            return;
        }
        let number = self.sites.len();
        self.edits.push((Span::at(words.spans[start].start), format!("{ASSERTIONS}::site = {}u; ", number + 1)));
        self.sites.push(words.span(start, words.behind(at + 1)));
    }
}
