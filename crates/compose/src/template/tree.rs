//! A template as a tree: texts, values, conditions, loops, and files that are put in.

use base::text::{SourceFile, Span};

use super::{Mark, marks};

/// A part of a template.
pub(super) enum Node {
    /// Text of the author's, as it is.
    Text(Span),
    /// The value of an expression.
    Value(Span, String),
    /// The first branch whose condition holds.
    If(Span, Vec<Branch>),
    /// A body for each element.
    For(Span, Loop),
    /// A name gets a value.
    Set(Span, String, String),
    /// Another file.
    Include(Span, String),
    /// What only the engine of the host knows.
    Refused(Span),
}

/// A branch of a condition.
pub(super) struct Branch {
    /// `None` for the last one.
    pub condition: Option<Condition>,
    pub body: Vec<Node>,
}

/// When a branch is taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Condition {
    pub text: String,
    pub negated: bool,
}

pub(super) struct Loop {
    pub names: Vec<String>,
    pub over: String,
    pub body: Vec<Node>,
}

/// What a mark says.
enum Word {
    If(Condition),
    Elif(Condition),
    Else,
    End,
    For(Vec<String>, String),
    Set(String, String),
    Include(String),
    Value(String),
    Comment,
    Other,
}

/// Something that is not closed, or closes nothing, with what is wrong.
pub(super) type Loose = (Span, &'static str);

/// The tree of a text. None where nothing in it is a template's.
pub(super) fn tree(file: &SourceFile) -> Option<(Vec<Node>, Vec<Loose>)> {
    let marks = marks(file.text(), true);
    if marks.is_empty() {
        return None;
    }
    let mut reader = Reader { file, marks: &marks, next: 0, at: 0, loose: Vec::new() };
    let mut all = Vec::new();
    loop {
        let (nodes, stop) = reader.nodes();
        all.extend(nodes);
        match stop {
            None => break,
            Some((span, Word::End)) => reader.loose.push((span, "nothing ends here")),
            Some((span, Word::Else)) => reader.loose.push((span, "this `else` has no `if` before it")),
            Some((span, _)) => reader.loose.push((span, "this branch has no `if` before it")),
        }
    }
    Some((all, reader.loose))
}

struct Reader<'f> {
    file: &'f SourceFile,
    marks: &'f [Mark],
    next: usize,
    /// Behind the last mark.
    at: usize,
    loose: Vec<Loose>,
}

impl Reader<'_> {
    /// Parts up to the end of the text, or to a mark that ends or goes on with what is around them.
    fn nodes(&mut self) -> (Vec<Node>, Option<(Span, Word)>) {
        let mut all = Vec::new();
        while let Some(mark) = self.marks.get(self.next) {
            let span = mark.span;
            self.next += 1;
            if span.start > self.at {
                all.push(Node::Text(Span::new(self.at, span.start)));
            }
            self.at = self.at.max(span.end);
            match word(self.file.slice(span)) {
                Word::Comment => {}
                Word::Value(text) => all.push(Node::Value(span, text)),
                Word::Set(name, value) => all.push(Node::Set(span, name, value)),
                Word::Include(path) => all.push(Node::Include(span, path)),
                Word::Other => all.push(Node::Refused(span)),
                Word::If(condition) => all.push(self.branches(span, condition)),
                Word::For(names, over) => {
                    let (body, stop) = self.nodes();
                    if !matches!(stop, Some((_, Word::End))) {
                        self.loose.push((span, "this loop is never ended"));
                    }
                    all.push(Node::For(span, Loop { names, over, body }));
                }
                stop @ (Word::Elif(_) | Word::Else | Word::End) => return (all, Some((span, stop))),
            }
        }
        let end = self.file.text().len();
        if end > self.at {
            all.push(Node::Text(Span::new(self.at, end)));
            self.at = end;
        }
        (all, None)
    }

    fn branches(&mut self, span: Span, first: Condition) -> Node {
        let (mut all, mut condition) = (Vec::new(), Some(first));
        loop {
            let (body, stop) = self.nodes();
            all.push(Branch { condition, body });
            condition = match stop {
                Some((_, Word::Elif(next))) => Some(next),
                Some((_, Word::Else)) => None,
                Some((_, Word::End)) => return Node::If(span, all),
                _ => {
                    self.loose.push((span, "this condition is never ended"));
                    return Node::If(span, all);
                }
            };
        }
    }
}

fn word(mark: &str) -> Word {
    let statement = mark.starts_with("{%");
    let inside = mark.trim_matches(['{', '}', '%']).trim_matches(['-', '~', '&']).trim();
    if mark.starts_with("{#") || inside.starts_with('!') {
        return Word::Comment;
    }
    let (first, rest) = inside.split_once(char::is_whitespace).unwrap_or((inside, ""));
    let rest = rest.trim();
    let when = |text: &str, negated: bool| Condition { text: helper(text), negated };
    let quoted = || rest.trim_matches(['"', '\'', ' ']).to_owned();
    match (statement, first) {
        (true, "if") => Word::If(when(rest, false)),
        (true, "elif" | "elsif" | "elseif") => Word::Elif(when(rest, false)),
        (_, "else") if rest.starts_with("if ") => Word::Elif(when(&rest[3..], false)),
        (_, "else") => Word::Else,
        (true, word) if word.starts_with("end") => Word::End,
        (true, "for") => match rest.split_once(" in ") {
            Some((names, over)) => {
                Word::For(names.split(',').map(|n| n.trim().to_owned()).collect(), over.trim().to_owned())
            }
            None => Word::Other,
        },
        (true, "set" | "set_global") => match rest.split_once('=') {
            Some((name, value)) => Word::Set(name.trim().to_owned(), value.trim().to_owned()),
            None => Word::Other,
        },
        (true, "include") if rest.starts_with(['"', '\'']) => Word::Include(quoted()),
        (true, _) => Word::Other,
        (false, "#if") => Word::If(when(rest, false)),
        (false, "#unless") => Word::If(when(rest, true)),
        (false, "#each") => Word::For(vec!["this".to_owned()], rest.to_owned()),
        (false, "include") if rest.starts_with(['"', '\'']) => Word::Include(quoted()),
        (false, ">") => Word::Include(quoted()),
        (false, word) if word.starts_with('/') => Word::End,
        (false, word) if word.starts_with(['#', '^', '>']) => Word::Other,
        (false, _) => Word::Value(inside.to_owned()),
    }
}

/// The helpers of Handlebars that compare, as Jinja writes them: `(eq a "b")`.
fn helper(text: &str) -> String {
    let inside = text.strip_prefix('(').and_then(|t| t.strip_suffix(')')).unwrap_or(text);
    let words: Vec<&str> = inside.split_whitespace().collect();
    let sign = |word: &str| match word {
        "eq" => Some("=="),
        "ne" => Some("!="),
        "gt" => Some(">"),
        "lt" => Some("<"),
        _ => None,
    };
    match words[..] {
        [word, a, b] => sign(word).map_or_else(|| text.to_owned(), |sign| format!("{a} {sign} {b}")),
        _ => text.to_owned(),
    }
}
