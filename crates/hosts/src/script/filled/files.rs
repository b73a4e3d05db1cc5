//! Files that import each other: what each declares, and where a name that it imports comes from.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use base::text::SourceFile;

use super::syntax::{Node, Reader};
use crate::script::language::Language;
use crate::script::token::{Token, tokens};

/// Files that are read for one.
const MOST: usize = 48;

/// Bytes that are read for one.
const MOST_BYTES: usize = 4 << 20;

/// What files declare under names.
type Known = HashMap<(usize, String), Option<Rc<Node>>>;

/// A name that a file imports: its name where it is declared, or none for all of the file.
pub(super) struct Import {
    pub path: String,
    pub name: Option<String>,
}

/// What an `export { … }` says of a name.
pub(super) struct Export {
    pub name: String,
    pub path: Option<String>,
}

/// Files, and which of them a path means in another one.
pub(super) struct Files {
    files: Vec<SourceFile>,
    links: HashMap<(usize, String), Option<usize>>,
    /// Paths that were asked for and are not read yet.
    wanted: RefCell<Vec<(usize, String)>>,
    /// Files whose declarations were used.
    seen: RefCell<Vec<usize>>,
    /// Declarations that were looked up.
    known: RefCell<Known>,
}

impl Files {
    pub(super) fn new(file: &SourceFile) -> Self {
        Self {
            files: vec![file.clone()],
            links: HashMap::new(),
            wanted: RefCell::default(),
            seen: RefCell::default(),
            known: RefCell::default(),
        }
    }

    pub(super) fn file(&self, file: usize) -> Option<&SourceFile> {
        self.files.get(file)
    }

    /// The text of a file that is no code: `import text from './a.wgsl?raw'`.
    pub(super) fn plain_text(&self, file: usize) -> Option<&SourceFile> {
        self.file(file).filter(|file| Language::of(file.name()) != Some(Language::JavaScript))
    }

    /// The names of files that were used, without the first.
    pub(super) fn used(&self) -> Vec<String> {
        let seen = self.seen.borrow();
        let mut all: Vec<String> = seen.iter().filter_map(|at| Some(self.file(*at)?.name().to_owned())).collect();
        all.sort();
        all.dedup();
        all
    }

    /// The file that a path means; none where it was not read, or is not there.
    pub(super) fn linked(&self, from: usize, path: &str) -> Option<usize> {
        if !path.starts_with('.') {
            return None;
        }
        let known = self.links.get(&(from, path.to_owned()));
        if known.is_none() {
            self.wanted.borrow_mut().push((from, path.to_owned()));
        }
        let found = known.copied().flatten()?;
        self.seen.borrow_mut().push(found);
        Some(found)
    }

    /// Reads what was asked for. False where nothing was.
    pub(super) fn read(&mut self, import: &mut super::Imports<'_>) -> bool {
        let mut wanted = self.wanted.take();
        wanted.sort();
        wanted.dedup();
        let any = !wanted.is_empty();
        for (from, path) in wanted {
            let bytes: usize = self.files.iter().map(|file| file.text().len()).sum();
            let full = self.files.len() >= MOST || bytes > MOST_BYTES;
            let name = self.files[from].name().to_owned();
            let found = if full { None } else { import(&name, path.split('?').next().unwrap_or(&path)) };
            let at = found.map(|found| {
                let known = self.files.iter().position(|file| file.name() == found.name());
                known.unwrap_or_else(|| {
                    self.files.push(found);
                    self.files.len() - 1
                })
            });
            self.links.insert((from, path), at);
        }
        self.seen.take();
        any
    }

    /// What a file declares under a name outside of functions and blocks; none where it is changed later.
    pub(super) fn declared(&self, file: usize, name: &str) -> Option<Rc<Node>> {
        if let Some(known) = self.known.borrow().get(&(file, name.to_owned())) {
            return known.clone();
        }
        let found = self.find(file, name);
        self.known.borrow_mut().insert((file, name.to_owned()), found.clone());
        found
    }

    fn find(&self, file: usize, name: &str) -> Option<Rc<Node>> {
        let file = self.file(file)?;
        if !file.text().contains(name) {
            return None;
        }
        let (tokens, places) = tokens(file.text(), Language::JavaScript);
        let reader = |at: usize| Reader::new(file, &tokens, &places, at);
        let mut depth = 0_usize;
        for (at, token) in tokens.iter().enumerate() {
            match token {
                Token::Mark('(' | '[' | '{') => depth += 1,
                Token::Mark(')' | ']' | '}') => depth = depth.saturating_sub(1),
                Token::Word("const" | "let" | "var") if depth == 0 && is_word(&tokens, at + 1, name) => {
                    return value_behind(&mut reader(at + 2), &tokens)
                        .filter(|_| *token == Token::Word("const") || !is_changed(&tokens, name));
                }
                // `const a = 1, name = 2;`
                Token::Mark(',') if depth == 0 && is_word(&tokens, at + 1, name) && is_set(&tokens, at + 2) => {
                    return value_behind(&mut reader(at + 2), &tokens).filter(|_| !is_changed(&tokens[at + 2..], name));
                }
                Token::Word("function") if depth == 0 && is_word(&tokens, at + 1, name) => {
                    return Some(reader(at).function(at + 2));
                }
                Token::Word("class" | "enum") if depth == 0 && is_word(&tokens, at + 1, name) => {
                    let open = (at + 2..tokens.len()).find(|at| tokens[*at] == Token::Mark('{'))?;
                    return Some(members(&reader, &tokens, open, *token == Token::Word("enum")));
                }
                Token::Word("default")
                    if depth == 0 && name == "default" && is_word(&tokens, at.wrapping_sub(1), "export") =>
                {
                    return Some(reader(at + 1).expression());
                }
                _ => {}
            }
        }
        None
    }

    /// Where a name of a file is imported from.
    pub(super) fn import(&self, file: usize, name: &str) -> Option<Import> {
        let file = self.file(file)?;
        let (tokens, _) = tokens(file.text(), Language::JavaScript);
        for at in (0..tokens.len()).filter(|at| is_word(&tokens, *at, "import")) {
            let Some((end, path)) = path_behind(file, &tokens, at) else { continue };
            let mut in_braces = false;
            for t in at + 1..end {
                match tokens[t] {
                    Token::Mark('{') => in_braces = true,
                    Token::Word(word) if word == name => {
                        let renamed = is_word(&tokens, t - 1, "as");
                        let of_all = renamed && tokens.get(t.wrapping_sub(2)) == Some(&Token::Mark('*'));
                        // `{ b as a }`; `a as b` is called `b` here.
                        if is_word(&tokens, t + 1, "as") && in_braces {
                            continue;
                        }
                        let own = match (of_all, renamed, in_braces) {
                            (true, ..) => None,
                            (_, true, _) => Some(written(&tokens, t - 2)?),
                            (_, _, true) => Some(name.to_owned()),
                            (_, _, false) => Some("default".to_owned()),
                        };
                        return Some(Import { path, name: own });
                    }
                    _ => {}
                }
            }
        }
        None
    }

    /// What an `export { … }` of a file says of a name.
    pub(super) fn exported_as(&self, file: usize, name: &str) -> Option<Export> {
        let file = self.file(file)?;
        let (tokens, _) = tokens(file.text(), Language::JavaScript);
        for at in (0..tokens.len()).filter(|at| is_word(&tokens, *at, "export")) {
            let open = at + 1;
            if tokens.get(open) != Some(&Token::Mark('{')) {
                continue;
            }
            let Some(close) = (open..tokens.len()).find(|t| tokens[*t] == Token::Mark('}')) else { continue };
            let path = if is_word(&tokens, close + 1, "from") { string(file, &tokens, close + 2) } else { None };
            let mut names = (open + 1..close).filter(|t| is_word(&tokens, *t, name) && !is_word(&tokens, *t + 1, "as"));
            if let Some(t) = names.next() {
                let own = if is_word(&tokens, t - 1, "as") { written(&tokens, t - 2)? } else { name.to_owned() };
                return Some(Export { name: own, path });
            }
        }
        None
    }

    /// Files of which a file exports all: `export * from './a'`.
    pub(super) fn passed_on(&self, file: usize) -> Vec<String> {
        let Some(file) = self.file(file).filter(|file| file.text().contains("export *")) else { return Vec::new() };
        let (tokens, _) = tokens(file.text(), Language::JavaScript);
        let star = |at: &usize| is_word(&tokens, *at, "export") && tokens.get(at + 1) == Some(&Token::Mark('*'));
        let all = (0..tokens.len()).filter(star);
        all.filter_map(|at| string(file, &tokens, at + 3).filter(|_| is_word(&tokens, at + 2, "from"))).collect()
    }
}

fn is_word(tokens: &[Token<'_>], at: usize, word: &str) -> bool {
    matches!(tokens.get(at), Some(Token::Word(own)) if *own == word)
}

/// True where a name gets a value.
fn is_set(tokens: &[Token<'_>], at: usize) -> bool {
    matches!(tokens.get(at), Some(Token::Mark('=' | ':')))
}

fn written(tokens: &[Token<'_>], at: usize) -> Option<String> {
    match tokens.get(at)? {
        Token::Word(word) => Some((*word).to_owned()),
        Token::Mark(_) | Token::String { .. } => None,
    }
}

fn string(file: &SourceFile, tokens: &[Token<'_>], at: usize) -> Option<String> {
    match tokens.get(at)? {
        Token::String { inner, .. } => Some(file.slice(*inner).to_owned()),
        Token::Mark(_) | Token::Word(_) => None,
    }
}

/// The `from` of an import, and its path.
fn path_behind(file: &SourceFile, tokens: &[Token<'_>], at: usize) -> Option<(usize, String)> {
    const LONGEST: usize = 400;
    for t in at + 1..tokens.len().min(at + LONGEST) {
        match tokens[t] {
            Token::Word("from") => {
                if let Some(path) = string(file, tokens, t + 1) {
                    return Some((t, path));
                }
            }
            Token::Word(_) | Token::Mark('{' | '}' | ',' | '*') => {}
            Token::Mark(_) | Token::String { .. } => return None,
        }
    }
    None
}

/// The expression behind a name that is declared: `: Type = …`.
pub(super) fn value_behind(reader: &mut Reader<'_, '_>, tokens: &[Token<'_>]) -> Option<Rc<Node>> {
    if tokens.get(reader.at) == Some(&Token::Mark(':')) {
        let mut at = reader.at;
        while let Some(token) = tokens.get(at) {
            match token {
                Token::Mark('(' | '[' | '{') => {
                    at = reader.behind(at);
                    continue;
                }
                Token::Mark('=') if tokens.get(at + 1) == Some(&Token::Mark('>')) => at += 1,
                Token::Mark('=') => break,
                Token::Mark(';' | ')' | ']' | '}') => return None,
                _ => {}
            }
            at += 1;
        }
        reader.at = at;
    }
    (tokens.get(reader.at) == Some(&Token::Mark('='))).then_some(())?;
    reader.at += 1;
    Some(reader.expression())
}

/// True where a variable gets another value than its first.
pub(super) fn is_changed(tokens: &[Token<'_>], name: &str) -> bool {
    let mark = |at: usize| match tokens.get(at) {
        Some(Token::Mark(c)) => *c,
        _ => ' ',
    };
    (0..tokens.len()).filter(|at| is_word(tokens, *at, name)).any(|at| {
        let declared = at.checked_sub(1).is_some_and(|b| ["let", "var"].iter().any(|word| is_word(tokens, b, word)));
        let member = at.checked_sub(1).is_some_and(|b| mark(b) == '.');
        let (first, second) = (mark(at + 1), mark(at + 2));
        let plain = first == '=' && second != '=' && second != '>';
        let joined = "+-*/%|&^".contains(first) && (second == '=' || (second == first && "+-".contains(first)));
        !declared && !member && (plain || joined)
    })
}

/// The members of a class that have values in it, and those of an enumeration.
fn members<'a, 't>(
    reader: &dyn Fn(usize) -> Reader<'a, 't>,
    tokens: &[Token<'_>],
    open: usize,
    counts: bool,
) -> Rc<Node> {
    let end = reader(open).behind(open);
    let mut found: Vec<(String, Rc<Node>)> = Vec::new();
    let (mut at, mut next) = (open + 1, 0.0);
    while at + 1 < end {
        let Some(name) = written(tokens, at) else {
            let opens = matches!(tokens[at], Token::Mark('(' | '[' | '{'));
            at = if opens { reader(at).behind(at) } else { at + 1 };
            continue;
        };
        match tokens.get(at + 1) {
            Some(Token::Mark('(')) => {
                let function = reader(at).function(at + 1);
                let getter = is_word(tokens, at - 1, "get");
                let value = if getter { Rc::new(Node::Call(function, Vec::new())) } else { function };
                found.push((name, value));
                at = reader(at + 1).behind(at + 1);
            }
            Some(Token::Mark('=' | ':')) => {
                let mut own = reader(at + 1);
                let value = value_behind(&mut own, tokens);
                if let Some(Node::Number(number)) = value.as_deref() {
                    next = number + 1.0;
                }
                found.extend(value.map(|value| (name, value)));
                at = own.at.max(at + 2);
            }
            Some(Token::Mark(',' | '}')) if counts => {
                found.push((name, Rc::new(Node::Number(next))));
                next += 1.0;
                at += 1;
            }
            _ => at += 1,
        }
    }
    Rc::new(Node::Object(found))
}
