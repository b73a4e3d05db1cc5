//! What an import names: the statement of WESL (its specification, `Imports.md`) and the directive of naga_oil, which
//! have one grammar but for the words at their beginning.

use base::text::{SourceFile, Span};

use crate::token::{Kind, Token};

/// Where a path begins.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Origin {
    /// `package::`, the package of the file that asks.
    Package,
    /// `super::`, the module above, so many times.
    Super(usize),
    /// The name of a package, or of a module that says its own name.
    Named,
    /// A file by its path: `"shaders/noise.wgsl"::f`.
    File(String),
}

/// A path of names, from its origin on.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ModulePath {
    /// Where the path begins.
    pub origin: Origin,
    /// Names of packages, folders and modules, outermost first.
    pub names: Vec<String>,
}

impl ModulePath {
    /// The path as a file writes it.
    pub fn shown(&self) -> String {
        let first = match &self.origin {
            Origin::Package => vec!["package".to_owned()],
            Origin::Super(count) => vec!["super".to_owned(); *count],
            Origin::Named => Vec::new(),
            Origin::File(path) => vec![format!("\"{path}\"")],
        };
        first.iter().chain(&self.names).map(String::as_str).collect::<Vec<_>>().join("::")
    }

    /// The path without its last name, and that name; none for a path of one name.
    pub(crate) fn split(&self) -> Option<(Self, String)> {
        let (last, rest) = self.names.split_last()?;
        let whole = rest.is_empty() && self.origin == Origin::Named;
        (!whole).then(|| (Self { origin: self.origin.clone(), names: rest.to_vec() }, last.clone()))
    }

    /// The path with further names behind it.
    pub(crate) fn join(&self, names: &[String]) -> Self {
        Self { origin: self.origin.clone(), names: self.names.iter().chain(names).cloned().collect() }
    }
}

/// One thing that is brought into a file.
#[derive(Clone, Debug)]
pub(crate) struct Import {
    pub path: ModulePath,
    /// What it is called here.
    pub name: String,
    /// The last name of the path.
    pub span: Span,
}

/// Reads what stands between `import` and the end of the statement. The error says what is expected, and where.
pub(crate) fn imports(file: &SourceFile, tokens: &[Token], end: Span) -> Result<Vec<Import>, (Span, String)> {
    let mut reader = Reader { file, tokens, end, at: 0, found: Vec::new() };
    let (origin, first) = reader.origin()?;
    let path = ModulePath { origin, names: first };
    reader.tree(path)?;
    // naga_oil takes several in one line.
    while reader.eat(Kind::Comma) {
        if reader.at == tokens.len() {
            break;
        }
        let (origin, names) = reader.origin()?;
        reader.tree(ModulePath { origin, names })?;
    }
    match tokens.get(reader.at) {
        None => Ok(reader.found),
        Some(extra) if extra.kind == Kind::Semicolon && reader.at + 1 == tokens.len() => Ok(reader.found),
        Some(extra) => Err((extra.span, format!("`{}` is not expected in an import", file.slice(extra.span)))),
    }
}

/// Braces in braces, at most.
const DEEPEST: usize = 64;

struct Reader<'a> {
    file: &'a SourceFile,
    tokens: &'a [Token],
    end: Span,
    at: usize,
    found: Vec<Import>,
}

type Failure = (Span, String);

impl Reader<'_> {
    fn eat(&mut self, kind: Kind) -> bool {
        let there = self.tokens.get(self.at).is_some_and(|token| token.kind == kind);
        self.at += usize::from(there);
        there
    }

    fn place(&self) -> Span {
        self.tokens.get(self.at).map_or(self.end, |token| token.span)
    }

    fn word(&mut self) -> Result<(String, Span), Failure> {
        let span = self.place();
        if self.eat(Kind::Word) {
            return Ok((self.file.slice(span).to_owned(), span));
        }
        Err((span, "an import names something: `import package::module::item;`".to_owned()))
    }

    /// Where the path begins, and the name that has been read with it.
    fn origin(&mut self) -> Result<(Origin, Vec<String>), Failure> {
        let span = self.place();
        if self.eat(Kind::Quoted) {
            let path = self.file.slice(span).trim_matches('"').to_owned();
            self.eat(Kind::Path);
            return Ok((Origin::File(path), Vec::new()));
        }
        let mut supers = 0;
        while self.file.slice(self.place()) == "super" {
            self.at += 1;
            supers += 1;
            if !self.eat(Kind::Path) {
                return Err((self.place(), "`super` is followed by `::`".to_owned()));
            }
        }
        if supers > 0 {
            return Ok((Origin::Super(supers), Vec::new()));
        }
        if self.file.slice(self.place()) == "package" {
            self.at += 1;
            let followed = self.eat(Kind::Path);
            return if followed {
                Ok((Origin::Package, Vec::new()))
            } else {
                Err((self.place(), "`package` is followed by `::`".to_owned()))
            };
        }
        Ok((Origin::Named, Vec::new()))
    }

    /// A path with what stands at its end, and the same in braces.
    fn tree(&mut self, start: ModulePath) -> Result<(), Failure> {
        // Paths that are open, by the braces around them.
        let mut open: Vec<ModulePath> = Vec::new();
        let mut path = start;
        loop {
            if self.eat(Kind::OpenBrace) {
                if open.len() >= DEEPEST {
                    return Err((self.place(), "this import is nested too deeply".to_owned()));
                }
                open.push(path.clone());
                if !self.closes() {
                    continue;
                }
            } else if matches!((&path.origin, path.names.is_empty()), (Origin::File(_), true)) && self.ends() {
                self.item(path.clone(), self.place())?;
            } else {
                let (name, span) = self.word()?;
                path = path.join(&[name]);
                if self.eat(Kind::Path) {
                    continue;
                }
                self.item(path.clone(), span)?;
            }
            // Behind an item: the next one in these braces, or their end.
            loop {
                let Some(outer) = open.last() else { return Ok(()) };
                path = outer.clone();
                let comma = self.eat(Kind::Comma);
                if self.closes() {
                    self.at += 1;
                    open.pop();
                } else if comma {
                    break;
                } else {
                    return Err((self.place(), "expected `,` or `}` in this import".to_owned()));
                }
            }
        }
    }

    fn closes(&self) -> bool {
        self.tokens.get(self.at).is_some_and(|token| token.kind == Kind::CloseBrace)
    }

    fn ends(&self) -> bool {
        self.tokens.get(self.at).is_none_or(|t| t.kind != Kind::Word || self.file.slice(t.span) == "as")
    }

    fn item(&mut self, path: ModulePath, span: Span) -> Result<(), Failure> {
        let mut name = path.names.last().cloned().unwrap_or_default();
        if self.file.slice(self.place()) == "as" {
            self.at += 1;
            name = self.word()?.0;
        }
        self.found.push(Import { path, name, span });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::token::tokens;

    fn read(text: &str) -> Result<Vec<String>, String> {
        let file = SourceFile::new("a.wesl", text);
        let found = imports(&file, &tokens(text), Span::at(text.len()));
        let shown = |i: Import| format!("{} as {}", i.path.shown(), i.name);
        found.map(|all| all.into_iter().map(shown).collect()).map_err(|(span, why)| format!("{} {why}", span.start))
    }

    #[test]
    fn trees_are_read_to_their_leaves() {
        let all = read("a::{b, c::{d, e as f}, g,};").unwrap();
        assert_eq!(all, ["a::b as b", "a::c::d as d", "a::c::e as f", "a::g as g"]);
        assert_eq!(read("super::super::m::x;").unwrap(), ["super::super::m::x as x"]);
        assert_eq!(read("package::{m::{x}};").unwrap(), ["package::m::x as x"]);
        assert_eq!(read("a::b, c::d as e").unwrap(), ["a::b as b", "c::d as e"]);
        assert_eq!(read("\"s/x.wgsl\"::{f, g}").unwrap(), ["\"s/x.wgsl\"::f as f", "\"s/x.wgsl\"::g as g"]);
        assert_eq!(read("\"s/x.wgsl\" as X").unwrap(), ["\"s/x.wgsl\" as X"]);
    }

    #[test]
    fn what_is_no_import_is_told_with_its_place() {
        assert!(read("a::{b c}").unwrap_err().starts_with("6 expected `,`"));
        assert!(read("a::").unwrap_err().starts_with("3 an import names"));
        assert!(read("package;").unwrap_err().starts_with("7 `package` is followed"));
        assert!(read("a b;").unwrap_err().starts_with("2 `b` is not expected"));
        assert!(read(&"a::{".repeat(100)).unwrap_err().contains("too deeply"));
    }
}
