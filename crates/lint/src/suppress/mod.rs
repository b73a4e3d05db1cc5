//! Comments that silence findings: `// shadercheck: ignore[N014] reason` for a line, and
//! `// shadercheck: ignore-file[N014] reason` for a file. Rules are required, by code or name, so that a
//! comment says what it is for and nothing else is silenced with it.

mod parse;
#[cfg(test)]
mod tests;

// Rules: each in a folder with its name, with its pages.
pub(super) mod bad_suppression;
pub(super) mod unused_suppression;

use base::diagnostic::Diagnostic;
use base::text::{SourceFile, Span};

use super::rule::Rule;
use hosts::Origin;
use hosts::{HostFile, comments};
use reading::{Project, ShaderFile};
use syntax::Shader;

pub(super) use parse::{Cause, Fault};

/// What a comment starts with, behind `//` or `/*`.
const MARK: &str = "shadercheck:";

/// A comment that silences.
#[derive(Clone, Debug)]
pub(super) struct Order {
    pub span: Span,
    /// What is deleted with it: the whole line, or the blanks before it.
    pub whole: Span,
    /// The text between the brackets.
    pub list: Span,
    /// What it silences; not empty.
    pub entries: Vec<Entry>,
    /// The line; none for the whole file.
    line: Option<usize>,
}

/// A code in the list of a comment.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub code: &'static str,
    pub span: Span,
    /// True when it silenced a finding.
    pub used: bool,
    /// True when findings of this code were asked for, so that an unused entry means something.
    pub judged: bool,
}

/// Comments of a file.
#[derive(Clone, Debug)]
pub(super) struct Comments {
    pub file: SourceFile,
    /// Those that silence.
    pub orders: Vec<Order>,
    /// What is wrong with others.
    pub faults: Vec<Fault>,
}

/// The comments of all reported files.
#[derive(Clone, Debug, Default)]
pub(super) struct Suppressions {
    /// File by file; those without such comments are left out.
    pub files: Vec<Comments>,
}

impl Suppressions {
    /// Reads the comments. `rules` are those that can be silenced.
    pub fn of(project: &Project, rules: &[&'static Rule]) -> Self {
        let own = |s: &ShaderFile| s.author.clone().unwrap_or_else(|| s.file.clone());
        let shaders = project.shaders().filter(|s| s.reported && has_mark(&own(s))).map(|s| {
            let spans = |shader: &Shader| shader.comments().iter().map(|c| c.span).collect::<Vec<Span>>();
            let spans = match &s.author {
                Some(author) if s.is_wgsl() => spans(&Shader::parse_wgsl(author).shader),
                Some(author) => spans(&Shader::parse(author, s.shader.stage()).shader),
                None => spans(&s.shader),
            };
            let comments = Comments::of(&own(s), &spans, rules);
            // Findings in a listing are told at its place in the document.
            comments.moved(s.origin.as_ref().filter(|_| s.place.is_some()))
        });
        let hosts = project.hosts().filter(|h| h.reported && has_mark(&h.file)).map(|h: &HostFile| {
            let spans = comments(h);
            Comments::of(&h.file, &spans, rules).moved(h.origin.as_ref())
        });
        Self { files: shaders.chain(hosts).collect() }
    }

    /// True when a comment silences this diagnostic; the comment counts as used then.
    pub fn silences(&mut self, diagnostic: &Diagnostic) -> bool {
        let line = diagnostic.file.position(diagnostic.span.start).line;
        let mut silenced = false;
        // A document has comments in each of its listings.
        let own = self.files.iter_mut().filter(|c| c.file.name() == diagnostic.file.name());
        for order in own.flat_map(|c| &mut c.orders).filter(|o| o.line.is_none_or(|l| l == line)) {
            for entry in order.entries.iter_mut().filter(|e| e.code == diagnostic.code.0) {
                entry.used = true;
                silenced = true;
            }
        }
        silenced
    }

    /// Notes which entries were asked for, by file and code.
    pub fn judge(&mut self, asked: impl Fn(&str, &str) -> bool) {
        for comments in &mut self.files {
            for entry in comments.orders.iter_mut().flat_map(|o| &mut o.entries) {
                entry.judged = asked(comments.file.name(), entry.code);
            }
        }
    }
}

/// Most files have no such comment, and are not searched for one.
fn has_mark(file: &SourceFile) -> bool {
    file.text().contains(MARK)
}

impl Comments {
    fn of(file: &SourceFile, spans: &[Span], rules: &[&'static Rule]) -> Self {
        let (mut orders, mut faults) = (Vec::new(), Vec::new());
        for &span in spans {
            let Some(read) = parse::read(file, span, rules) else { continue };
            faults.extend(read.faults);
            if !read.entries.is_empty() {
                let line = (!read.whole_file).then(|| target(file, span, spans));
                let whole = whole(file, span);
                orders.push(Order { span, whole, list: read.list, entries: read.entries, line });
            }
        }
        Self { file: file.clone(), orders, faults }
    }

    /// The same at the places of the document that the file is a listing of.
    fn moved(mut self, origin: Option<&Origin>) -> Self {
        let Some(Origin { host, literal }) = origin else { return self };
        let to_host = |span: &mut Span| *span = literal.to_host(*span);
        for order in &mut self.orders {
            if let Some(line) = &mut order.line {
                let start = self.file.offset(base::text::Position { line: *line, column: 1 });
                *line = host.position(literal.to_host(Span::at(start)).start).line;
            }
            [&mut order.span, &mut order.whole, &mut order.list].into_iter().for_each(to_host);
            order.entries.iter_mut().for_each(|e| to_host(&mut e.span));
        }
        self.faults.iter_mut().for_each(|f| to_host(&mut f.span));
        self.file = host.clone();
        self
    }
}

/// The line that a comment speaks of: its own when it shares it with code, else the next one that
/// holds more than comments.
fn target(file: &SourceFile, comment: Span, comments: &[Span]) -> usize {
    let own = file.position(comment.start).line;
    let last = file.position(comment.end).line;
    if has_code(file, own, comments) {
        return own;
    }
    // A comment that stands for itself on its lines: stacked comments all speak of the code below.
    (last..=file.line_count()).find(|&line| has_code(file, line, comments)).unwrap_or(last)
}

/// True when a line holds more than blanks and comments.
fn has_code(file: &SourceFile, line: usize, comments: &[Span]) -> bool {
    let start = file.offset(base::text::Position { line, column: 1 });
    let text = file.line_text(line);
    // Comments are in the order of the text; those before the line cannot reach it but by their ends.
    let first = comments.partition_point(|c| c.end <= start);
    let inside = |at: usize| comments[first..].iter().take_while(|c| c.start <= at).any(|c| c.contains(at));
    text.char_indices().any(|(i, c)| !c.is_whitespace() && !inside(start + i))
}

/// What is deleted with a comment: its line when nothing else stands there, else the blanks before it.
fn whole(file: &SourceFile, comment: Span) -> Span {
    let text = file.text();
    let blank = |c: char| c == ' ' || c == '\t';
    let before = text[..comment.start].trim_end_matches(blank).len();
    let behind = &text[comment.end..];
    let rest = behind.trim_start_matches(blank);
    let starts_line = text[..before].is_empty() || text[..before].ends_with(['\n', '\r']);
    let line_break = ["\r\n", "\n", "\r"].iter().find(|b| rest.starts_with(**b)).map_or(0, |b| b.len());
    let ends_line = line_break > 0 || rest.is_empty();
    match (starts_line, ends_line) {
        (true, true) => Span::new(before, comment.end + (behind.len() - rest.len()) + line_break),
        (false, true) => Span::new(before, comment.end),
        // Code follows on the line, and keeps its indentation or its one blank.
        (_, false) => Span::new(comment.start, comment.end + (behind.len() - rest.len())),
    }
}
