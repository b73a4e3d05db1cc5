//! `@if`, `@elif` and `@else` (the specification of WESL, `ConditionalTranslation.md`): the text without what its
//! features leave out.

use std::collections::HashMap;

use base::text::{Assembly, SourceFile, Span};
use syntax::errors;

use crate::Problems;
use crate::token::{Kind, Token, behind_template, brackets, tokens};

/// A text without conditions.
pub(crate) struct Conditional {
    pub file: SourceFile,
    /// Names that are declared in what was left out, each with the condition that it stands under.
    pub left_out: Vec<(String, String)>,
}

/// Decides all conditions of a text. A feature that nobody states is off, as the compilers of WESL have it.
pub(crate) fn decide(file: &SourceFile, defines: &[(String, String)], problems: &mut Problems) -> Conditional {
    if !["@if", "@elif", "@else"].iter().any(|word| file.text().contains(word)) {
        return Conditional { file: file.clone(), left_out: Vec::new() };
    }
    let tokens = tokens(file.text());
    let behind = brackets(&tokens);
    let (removed, left_out) = (Vec::new(), Vec::new());
    let mut walk =
        Walk { file, tokens: &tokens, behind: &behind, defines, problems, removed, chains: HashMap::new(), left_out };
    walk.run();
    let Walk { removed, left_out, .. } = walk;
    let mut out = Assembly::new();
    let mut at = 0;
    for span in removed {
        out.copy(file, Span::new(at, span.start));
        at = span.end.max(at);
    }
    out.copy(file, Span::new(at, file.text().len()));
    Conditional { file: out.finish(file.name()), left_out }
}

/// What stands in a bracket that is open.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Within {
    /// Declarations of a module.
    Module,
    /// Statements.
    Block,
    /// Members or parameters: what stands between commas.
    List,
    /// Anything else.
    Expression,
}

struct Walk<'a, 'p> {
    file: &'a SourceFile,
    tokens: &'a [Token],
    /// The token behind each bracket.
    behind: &'a [usize],
    defines: &'a [(String, String)],
    problems: &'p mut Problems,
    /// Bytes that are left out, in the order of the text.
    removed: Vec<Span>,
    /// For the token behind something under a condition: whether one of the conditions so far has held, and the first of
    /// them as it is written.
    chains: HashMap<usize, (bool, String)>,
    left_out: Vec<(String, String)>,
}

/// One of the attributes of a declaration that holds a condition.
struct Condition {
    first: usize,
    end: usize,
    word: String,
}

impl Walk<'_, '_> {
    fn kind(&self, at: usize) -> Option<Kind> {
        self.tokens.get(at).map(|token| token.kind)
    }

    fn word(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", |token| self.file.slice(token.span))
    }

    fn run(&mut self) {
        let mut open = vec![Within::Module];
        // Braces around declarations that stay are none of WGSL; they are left out where they close.
        let mut dropped: Vec<usize> = Vec::new();
        let mut at = 0;
        while let Some(kind) = self.kind(at) {
            let within = open.last().copied().unwrap_or(Within::Module);
            match kind {
                Kind::OpenBrace => {
                    let members = at >= 2 && self.word(at - 2) == "struct";
                    open.push(if members { Within::List } else { Within::Block });
                }
                Kind::OpenParen => {
                    let parameters = at >= 2 && self.word(at - 2) == "fn";
                    open.push(if parameters { Within::List } else { Within::Expression });
                }
                Kind::OpenBracket => open.push(Within::Expression),
                Kind::CloseBrace | Kind::CloseParen | Kind::CloseBracket => {
                    if dropped.last() == Some(&at) {
                        dropped.pop();
                        self.removed.push(self.tokens[at].span);
                    }
                    if open.len() > 1 {
                        open.pop();
                    }
                }
                Kind::At if within != Within::Expression => {
                    at = self.attributes(at, within, &mut open, &mut dropped);
                    continue;
                }
                _ => {}
            }
            at += 1;
        }
    }

    /// Decides about what the attributes from `start` on belong to; gives where to go on.
    fn attributes(&mut self, start: usize, within: Within, open: &mut Vec<Within>, dropped: &mut Vec<usize>) -> usize {
        let (mut at, mut conditions) = (start, Vec::new());
        while self.kind(at) == Some(Kind::At) {
            let word = self.word(at + 1).to_owned();
            let bare = matches!(word.as_str(), "else" | "vertex" | "fragment" | "compute" | "must_use" | "invariant");
            let argument = !bare && self.kind(at + 2) == Some(Kind::OpenParen);
            let end = if argument { self.behind[at + 2] } else { at + 2 };
            if matches!(word.as_str(), "if" | "elif" | "else") {
                conditions.push(Condition { first: at, end, word });
            }
            at = end.min(self.tokens.len());
        }
        let Some(condition) = conditions.first() else { return at };
        if let Some(second) = conditions.get(1) {
            let message = format!("`@{}` and `@{}` for one thing", condition.word, second.word);
            let help = "join them: `@if(a && b)`";
            self.problem(second, message, help);
        }
        let chain = self.chains.get(&start).cloned();
        let before = chain.as_ref().map(|(held, _)| *held);
        let holds = match (condition.word.as_str(), before) {
            ("if", _) => self.condition(condition),
            (_, None) => {
                let message = format!("`@{}` without an `@if` right before it", condition.word);
                self.problem(condition, message, "put it behind what the `@if` decides about");
                true
            }
            (_, Some(true)) => false,
            ("elif", Some(false)) => self.condition(condition),
            (_, Some(false)) => true,
        };
        let end = self.node_end(at, within);
        let any = holds || (condition.word != "if" && before == Some(true));
        let last = |end: usize| self.tokens[end.max(1) - 1].span;
        let written = Span::new(self.tokens[condition.first].span.start, last(condition.end).end);
        let mut shown = format!("`{}`", self.file.slice(written));
        let first = chain.filter(|_| condition.word != "if").map_or_else(|| shown.clone(), |(_, first)| first);
        if first != shown {
            shown = format!("{shown} of {first}");
        }
        self.chains.insert(end, (any, first));
        if !holds {
            let name = self.declared(at, end);
            self.left_out.extend(name.into_iter().map(|name| (name, shown.clone())));
            self.removed.push(Span::new(self.tokens[start].span.start, last(end).end));
            return end;
        }
        let (first, behind) = (self.tokens[condition.first].span, last(condition.end));
        self.removed.push(first.to(behind));
        if within == Within::Module && self.kind(at) == Some(Kind::OpenBrace) {
            self.removed.push(self.tokens[at].span);
            if end > at + 1 && self.kind(end - 1) == Some(Kind::CloseBrace) {
                open.push(Within::Module);
                dropped.push(end - 1);
            }
            return at + 1;
        }
        at
    }

    fn problem(&mut self, condition: &Condition, message: String, help: &str) {
        let span = self.tokens[condition.first].span.to(self.tokens[condition.end.max(1) - 1].span);
        self.problems.add(errors::TRANSLATE_TIME, self.file, span, message, help);
    }

    /// The names that a declaration, or each of those in braces, declares in its module.
    fn declared(&self, at: usize, end: usize) -> Vec<String> {
        let mut names = Vec::new();
        let mut depth = 0_usize;
        for at in at..end.min(self.tokens.len()) {
            match self.kind(at) {
                Some(Kind::OpenBrace) => depth += 1,
                Some(Kind::CloseBrace) => depth = depth.saturating_sub(1),
                _ => {}
            }
            if depth <= 1 && matches!(self.word(at), "fn" | "struct" | "const" | "override" | "alias" | "var") {
                let name = behind_template(self.tokens, at + 1);
                if self.kind(name) == Some(Kind::Word) {
                    names.push(self.word(name).to_owned());
                }
            }
        }
        names
    }

    /// The token behind the declaration, statement, member or parameter that begins at `at`.
    fn node_end(&self, at: usize, within: Within) -> usize {
        match within {
            Within::List => list_end(self.tokens, at),
            _ => node_end(self.tokens, self.behind, self.file, at),
        }
    }

    fn condition(&mut self, condition: &Condition) -> bool {
        let inside = condition.first + 3..condition.end.saturating_sub(1).max(condition.first + 3);
        let inside = self.tokens.get(inside).unwrap_or_default();
        let mut reader = Expression { file: self.file, tokens: inside, defines: self.defines, at: 0, depth: 0 };
        let value = reader.either();
        let whole = reader.at == inside.len();
        match value {
            Some(value) if whole => value,
            _ => {
                let message = format!("the condition of this `@{}` cannot be read", condition.word);
                let help = "conditions are features with `!`, `&&`, `||` and parentheses: `@if(shadows && !mobile)`";
                self.problem(condition, message, help);
                false
            }
        }
    }
}

/// The token behind a member or parameter: its comma, or the bracket that closes the list.
fn list_end(tokens: &[Token], start: usize) -> usize {
    let (mut depth, mut angles) = (0_usize, 0_usize);
    for (at, token) in tokens.iter().enumerate().skip(start) {
        match token.kind {
            Kind::OpenBrace | Kind::OpenParen | Kind::OpenBracket => depth += 1,
            Kind::CloseBrace | Kind::CloseParen | Kind::CloseBracket if depth == 0 => return at,
            Kind::CloseBrace | Kind::CloseParen | Kind::CloseBracket => depth -= 1,
            Kind::Less => angles += 1,
            Kind::Greater => angles = angles.saturating_sub(1),
            Kind::Comma if depth == 0 && angles == 0 => return at + 1,
            _ => {}
        }
    }
    tokens.len()
}

/// The token behind a declaration or statement: its semicolon, or its closing brace.
pub(crate) fn node_end(tokens: &[Token], behind: &[usize], file: &SourceFile, start: usize) -> usize {
    let word = |at: usize| tokens.get(at).map_or("", |token| file.slice(token.span));
    let import = word(start) == "import";
    let mut at = start;
    while let Some(token) = tokens.get(at) {
        match token.kind {
            Kind::Semicolon => return at + 1,
            // The end of what stands around.
            Kind::CloseBrace | Kind::CloseParen | Kind::CloseBracket => return at,
            Kind::OpenBrace if !import => {
                let end = behind[at];
                if word(end) != "else" {
                    return end;
                }
                at = end;
            }
            Kind::OpenBrace | Kind::OpenParen | Kind::OpenBracket => {
                at = behind[at];
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    tokens.len()
}

/// Parentheses and `!` in each other, at most.
const DEEPEST: usize = 200;

/// A condition: `a && !(b || c)`.
struct Expression<'a> {
    file: &'a SourceFile,
    tokens: &'a [Token],
    defines: &'a [(String, String)],
    at: usize,
    depth: usize,
}

impl Expression<'_> {
    fn eat(&mut self, kind: Kind) -> bool {
        let there = self.tokens.get(self.at).is_some_and(|token| token.kind == kind);
        self.at += usize::from(there);
        there
    }

    fn either(&mut self) -> Option<bool> {
        let mut value = self.both()?;
        while self.eat(Kind::Or) {
            value |= self.both()?;
        }
        Some(value)
    }

    fn both(&mut self) -> Option<bool> {
        let mut value = self.one()?;
        while self.eat(Kind::And) {
            value &= self.one()?;
        }
        Some(value)
    }

    fn one(&mut self) -> Option<bool> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return None;
        }
        let value = if self.eat(Kind::Not) {
            !self.one()?
        } else if self.eat(Kind::OpenParen) {
            let value = self.either()?;
            self.eat(Kind::CloseParen).then_some(value)?
        } else {
            let token = self.tokens.get(self.at).filter(|token| token.kind == Kind::Word)?;
            self.at += 1;
            match self.file.slice(token.span) {
                "true" => true,
                "false" => false,
                name => self.defines.iter().any(|(defined, value)| defined == name && value != "false"),
            }
        };
        self.depth -= 1;
        Some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decided(text: &str, features: &[&str]) -> (String, Vec<String>) {
        let defines: Vec<_> = features.iter().map(|&f| (f.to_owned(), String::new())).collect();
        let mut problems = Problems::default();
        let file = SourceFile::new("a.wesl", text);
        let out = decide(&file, &defines, &mut problems).file;
        let shown = |d: &base::diagnostic::Diagnostic| format!("{} {}", d.file.locate(d.span.start), d.message);
        (out.text().split_whitespace().collect::<Vec<_>>().join(" "), problems.found.iter().map(shown).collect())
    }

    fn left(text: &str, features: &[&str]) -> String {
        let (text, problems) = decided(text, features);
        assert_eq!(problems, Vec::<String>::new());
        text
    }

    #[test]
    fn declarations_members_parameters_and_statements_are_decided() {
        let text = "@if(A) const a = 1; @elif(B) const b = 1; @else const c = 1;
            struct S { @if(A) x: array<f32, 2>, @else y: f32, @location(0) @if(B) z: f32 }
            fn f(@if(A) p: i32, q: i32) -> i32 { @if(A && !B) { return 1; } @else if q > 0 { return 2; } else { return 3; } @if(B) x = 1; return 4; }";
        assert_eq!(
            left(text, &["A"]),
            "const a = 1; struct S { x: array<f32, 2>, } fn f( p: i32, q: i32) -> i32 { { return 1; } return 4; }"
        );
        assert_eq!(
            left(text, &["B"]),
            "const b = 1; struct S { y: f32, @location(0) z: f32 } \
             fn f( q: i32) -> i32 { if q > 0 { return 2; } else { return 3; } x = 1; return 4; }"
        );
        assert!(left(text, &[]).starts_with("const c = 1;"));
    }

    #[test]
    fn braces_around_declarations_go_with_their_condition() {
        let text = "@if(A) { const a = 1; @if(B) fn f() { @if(C) g(); } } @else { const b = 1; } const z = 1;";
        assert_eq!(left(text, &["A", "B"]), "const a = 1; fn f() { } const z = 1;");
        assert_eq!(left(text, &["C"]), "const b = 1; const z = 1;");
    }

    #[test]
    fn imports_with_braces_are_one_statement() {
        assert_eq!(left("@if(A) import a::{b, c}; @else import d; fn f() {}", &[]), "import d; fn f() {}");
    }

    #[test]
    fn wrong_conditions_are_told_with_their_places() {
        let told = |text| decided(text, &[]).1;
        assert_eq!(told("const a = 1; @else const b = 1;"), ["a.wesl:1:14 `@else` without an `@if` right before it"]);
        assert_eq!(told("@if(A + 1) const b = 1;"), ["a.wesl:1:1 the condition of this `@if` cannot be read"]);
        assert_eq!(told("@if(A) @if(B) const b = 1;"), ["a.wesl:1:8 `@if` and `@if` for one thing"]);
        assert_eq!(told("@if"), ["a.wesl:1:1 the condition of this `@if` cannot be read"]);
        let deep = format!("@if({}A) const b = 1;", "!".repeat(10_000));
        assert_eq!(told(&deep).len(), 1);
    }

    #[test]
    fn ten_thousand_nested_conditions_end() {
        let text = format!("fn f() {{ {} x(); {} }}", "@if(A) { ".repeat(10_000), "}".repeat(10_000));
        assert!(left(&text, &["A"]).contains("x();"));
        assert_eq!(left(&text, &[]), "fn f() { }");
    }
}
