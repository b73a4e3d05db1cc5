//! Declarations of a module, and the names that each of them uses.

use std::collections::HashSet;

use base::text::SourceFile;
use syntax::errors;

use crate::Problems;
use crate::condition::node_end;
use crate::token::{Kind, Token, behind_template};

/// What a declaration is, as far as it counts here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// `enable`, `requires` or `diagnostic`: stands before everything else.
    Directive,
    /// Goes with its module: `const_assert`.
    Assertion,
    /// Keeps its name: an entry point or an `override`.
    Named,
    /// Anything else.
    Ordinary,
}

/// A declaration of a module.
#[derive(Clone, Debug)]
pub(crate) struct Declaration {
    /// Its tokens, attributes included.
    pub tokens: std::ops::Range<usize>,
    /// Its name, and the token of it.
    pub name: Option<(String, usize)>,
    pub role: Role,
    /// Names that it uses, its own among them.
    pub uses: Vec<Use>,
    /// Tokens that WGSL does not have, to be left out.
    pub dropped: Option<usize>,
}

/// A name that is used, with the path before it.
#[derive(Clone, Debug)]
pub(crate) struct Use {
    /// Tokens of the path with the name, without `::` behind it.
    pub tokens: std::ops::Range<usize>,
    /// The names of the path, outermost first.
    pub names: Vec<String>,
    /// A call, which is of no local variable.
    pub called: bool,
}

/// The declarations of a text in their order, and the names that functions declare.
pub(crate) fn declarations(
    file: &SourceFile,
    tokens: &[Token],
    behind: &[usize],
    problems: &mut Problems,
) -> (Vec<Declaration>, HashSet<String>) {
    let reader = Reader { file, tokens, behind };
    let (mut found, mut locals) = (Vec::new(), HashSet::new());
    let mut at = 0;
    while at < tokens.len() {
        let mut end = node_end(tokens, behind, file, at).max(at + 1);
        // A semicolon behind a brace ends nothing.
        while end < tokens.len() && tokens[end].kind == Kind::Semicolon {
            end += 1;
        }
        let declaration = reader.declaration(at, end, problems);
        reader.locals(&declaration, &mut locals);
        found.push(declaration);
        at = end;
    }
    (found, locals)
}

struct Reader<'a> {
    file: &'a SourceFile,
    tokens: &'a [Token],
    behind: &'a [usize],
}

impl Reader<'_> {
    fn kind(&self, at: usize) -> Option<Kind> {
        self.tokens.get(at).map(|token| token.kind)
    }

    fn word(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", |token| self.file.slice(token.span))
    }

    fn declaration(&self, start: usize, end: usize, problems: &mut Problems) -> Declaration {
        let (mut at, mut stage) = (start, false);
        while self.kind(at) == Some(Kind::At) && at < end {
            stage |= matches!(self.word(at + 1), "vertex" | "fragment" | "compute");
            at += 2;
            if self.kind(at) == Some(Kind::OpenParen) {
                at = self.behind[at];
            }
        }
        // naga_oil: a function that others may override.
        let virtual_ = self.word(at) == "virtual" && self.word(at + 1) == "fn";
        let dropped = virtual_.then_some(at);
        at += usize::from(virtual_);
        if self.word(at) == "override" && self.word(at + 1) == "fn" {
            let span = self.tokens[at].span.to(self.tokens[at + 1].span);
            let help = "call the new function by its own name, or compose the text with naga_oil";
            problems.add(errors::IMPORT, self.file, span, "functions that override others are not composed", help);
        }
        let keyword = self.word(at);
        let role = match keyword {
            "enable" | "requires" => Role::Directive,
            "diagnostic" => Role::Directive,
            "const_assert" | "static_assert" => Role::Assertion,
            "override" => Role::Named,
            "fn" if stage => Role::Named,
            _ => Role::Ordinary,
        };
        let name = match keyword {
            "fn" | "struct" | "const" | "let" | "override" | "alias" | "type" => Some(at + 1),
            "var" => Some(behind_template(self.tokens, at + 1)),
            _ => None,
        };
        let name = name.filter(|&at| self.kind(at) == Some(Kind::Word) && at < end);
        let uses = if role == Role::Directive { Vec::new() } else { self.uses(start, end, keyword == "struct") };
        let name = name.map(|at| (self.word(at).to_owned(), at));
        Declaration { tokens: start..end, name, role, uses, dropped }
    }

    fn uses(&self, start: usize, end: usize, members: bool) -> Vec<Use> {
        let mut found = Vec::new();
        let mut at = start;
        while at < end {
            let token = self.tokens[at];
            match token.kind {
                Kind::At => {
                    let enumerants = ["builtin", "interpolate", "diagnostic"].contains(&self.word(at + 1));
                    at += 2;
                    if enumerants && self.kind(at) == Some(Kind::OpenParen) {
                        at = self.behind[at];
                    }
                    continue;
                }
                Kind::Word if self.word(at) == "var" && self.kind(at + 1) == Some(Kind::Less) => {
                    at = behind_template(self.tokens, at + 1).max(at + 1);
                    continue;
                }
                Kind::Word => {
                    let member = at > start && self.kind(at - 1) == Some(Kind::Dot);
                    let declared = members && self.kind(at + 1) == Some(Kind::Colon);
                    let begin = at;
                    let mut names = vec![self.word(at).to_owned()];
                    while self.kind(at + 1) == Some(Kind::Path) && self.kind(at + 2) == Some(Kind::Word) {
                        names.push(self.word(at + 2).to_owned());
                        at += 2;
                    }
                    let called = self.kind(behind_template(self.tokens, at + 1)) == Some(Kind::OpenParen);
                    if !member && !declared {
                        found.push(Use { tokens: begin..at + 1, names, called });
                    }
                }
                _ => {}
            }
            at += 1;
        }
        found
    }

    /// Adds what a function declares: parameters and what `let`, `var` and `const` declare.
    fn locals(&self, declaration: &Declaration, locals: &mut HashSet<String>) {
        let Some((_, name)) = declaration.name.as_ref().filter(|(_, name)| self.word(name - 1) == "fn") else { return };
        let parameters = self.behind.get(name + 1).copied().unwrap_or(*name);
        for at in *name..declaration.tokens.end {
            let parameter = at < parameters && self.kind(at + 1) == Some(Kind::Colon);
            let declared = match self.word(at) {
                "let" | "const" => Some(at + 1),
                "var" => Some(behind_template(self.tokens, at + 1)),
                _ => parameter.then_some(at),
            };
            if let Some(at) = declared.filter(|&at| self.kind(at) == Some(Kind::Word)) {
                locals.insert(self.word(at).to_owned());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::token::{brackets, tokens};

    #[test]
    fn declarations_know_their_names_and_what_they_use() {
        let text = "enable f16; @group(0) @binding(B) var<storage, read> data: array<m::T>;
            struct S { @builtin(position) pos: vec4f, @size(N) c: C };
            @compute @workgroup_size(W) fn main(p: S) { let q = p.c.x; a::b::f(q); for (var i = 0; i < 4; i++) {} }
            const_assert W > 1;";
        let file = SourceFile::new("a.wesl", text);
        let tokens = tokens(text);
        let (found, locals) = declarations(&file, &tokens, &brackets(&tokens), &mut Problems::default());
        let names: Vec<_> = found.iter().map(|d| (d.name.as_ref().map(|n| n.0.as_str()), d.role)).collect();
        let expected = [
            (None, Role::Directive),
            (Some("data"), Role::Ordinary),
            (Some("S"), Role::Ordinary),
            (Some("main"), Role::Named),
            (None, Role::Assertion),
        ];
        assert_eq!(names, expected);
        let used = |at: usize| found[at].uses.iter().map(|u| u.names.join("::")).collect::<Vec<_>>();
        assert_eq!(used(1), ["B", "data", "array", "m::T"]);
        assert_eq!(used(2), ["struct", "S", "vec4f", "N", "C"]);
        assert!(used(3).contains(&"a::b::f".to_owned()) && !used(3).contains(&"c".to_owned()));
        let mut locals: Vec<_> = locals.into_iter().collect();
        locals.sort();
        assert_eq!(locals, ["i", "p", "q"]);
    }
}
