//! A template with its values put in: those that are stated, and those that its places tell.

use std::collections::{BTreeMap, HashSet};

use base::diagnostic::{Diagnostic, Severity};
use base::text::{Assembly, SourceFile, Span};
use minijinja::Value;
use syntax::errors;
use syntax::include::Wanted;

use super::assume::{Assumption, Rank, by_place};
use super::expression::{Engine, Scope, paths, stated};
use super::in_line_comment;
use super::tree::{Condition, Loop, Node, tree};
use crate::{Library, Problems};

/// Files that put in each other, one inside of the other.
const DEEPEST: usize = 16;
/// Parts of a text at most: loops in loops can make any number of them.
const MOST: usize = 1 << 16;

/// A template with its values.
pub(crate) struct Rendered {
    pub file: SourceFile,
    /// What is assumed.
    pub notes: Vec<Diagnostic>,
    /// Texts of branches that are not taken, each with its condition.
    pub left_out: Vec<(String, String)>,
    /// Files that were put in.
    pub included: Vec<SourceFile>,
}

impl Rendered {
    /// A text in which nothing was put in.
    pub(crate) fn of(file: SourceFile) -> Self {
        Self { file, notes: Vec::new(), left_out: Vec::new(), included: Vec::new() }
    }
}

/// Puts values into a text. A text without placeholders stays as it is. What is assumed is told as notes. With `empty`,
/// placeholders without a value are left empty that have a line for themselves.
pub(crate) fn render(
    file: &SourceFile,
    (defines, empty): (&[(String, String)], bool),
    library: &mut dyn Library,
    problems: &mut Problems,
) -> Rendered {
    let Some((nodes, loose)) = tree(file) else { return Rendered::of(file.clone()) };
    for (span, what) in loose {
        problems.add(errors::TEMPLATE, file, span, what, OPEN);
    }
    let mut work = Work {
        defines,
        empty,
        scope: defines.iter().map(|(name, value)| (name.clone(), stated(value))).collect(),
        engine: Engine::default(),
        library,
        problems,
        assumed: BTreeMap::new(),
        local: HashSet::new(),
        told: HashSet::new(),
        notes: Vec::new(),
        left_out: Vec::new(),
        included: Vec::new(),
        out: Assembly::new(),
        parts: 0,
        depth: 0,
    };
    work.look(file, &nodes);
    work.nodes(file, &nodes);
    Rendered { file: work.out.finish(file.name()), notes: work.notes, left_out: work.left_out, included: work.included }
}

const OPEN: &str =
    "conditions are `{% if name %}`, `{% else %}` and `{% endif %}`, or `{{#if name}}`, `{{else}}` and `{{/if}}`";

struct Work<'a> {
    defines: &'a [(String, String)],
    /// Lines of their own are left empty.
    empty: bool,
    scope: Scope,
    engine: Engine,
    library: &'a mut dyn Library,
    problems: &'a mut Problems,
    /// What paths without a value are taken for.
    assumed: BTreeMap<String, (Rank, Assumption)>,
    /// Names that the template itself gives values.
    local: HashSet<String>,
    told: HashSet<String>,
    notes: Vec<Diagnostic>,
    left_out: Vec<(String, String)>,
    included: Vec<SourceFile>,
    out: Assembly,
    parts: usize,
    depth: usize,
}

impl Work<'_> {
    /// Notes what the places of placeholders say of their values, before any is needed.
    fn look(&mut self, file: &SourceFile, nodes: &[Node]) {
        for node in nodes {
            match node {
                Node::Value(span, text) => {
                    let unknown = self.unknown(text);
                    let alone = unknown.len() == 1 && unknown[0].1.len() == text.trim().len();
                    for (path, range) in unknown {
                        // What a loop gives is known when it is gone through.
                        if path.split(['.', '[']).next() == Some("loop") {
                            continue;
                        }
                        let found = match is_list(text, &range) {
                            true => Some((3, list())),
                            false => by_place(file, *span, self.assumed.len()),
                        };
                        // Within an expression it is a number.
                        let Some((rank, found)) = found.filter(|(rank, _)| alone || *rank > 2) else { continue };
                        let known = self.assumed.get(&path).is_some_and(|(known, _)| *known <= rank);
                        if !known {
                            self.assumed.insert(path, (rank, found));
                        }
                    }
                }
                Node::If(_, branches) => branches.iter().for_each(|branch| self.look(file, &branch.body)),
                Node::For(_, of) => {
                    self.local.extend(of.names.iter().cloned());
                    self.look(file, &of.body);
                }
                Node::Set(_, name, _) => drop(self.local.insert(name.clone())),
                Node::Text(_) | Node::Include(..) | Node::Refused(_) => {}
            }
        }
    }

    /// Paths of an expression that nothing states, with their places in it.
    fn unknown(&self, text: &str) -> Vec<(String, std::ops::Range<usize>)> {
        let known = |root: &str| self.scope.contains_key(root);
        let all = paths(text).into_iter().filter(|path| !known(&path.root));
        all.map(|path| (text[path.range.clone()].to_owned(), path.range)).collect()
    }

    fn tell(&mut self, file: &SourceFile, span: Span, key: String, message: String) {
        if self.told.insert(key) {
            let note = Diagnostic::new(errors::TEMPLATE, Severity::Info, file, span, message);
            self.notes.push(note.at_origin());
        }
    }

    /// The expression with values in the place of what nothing states. None where one of these cannot be told.
    fn with_assumptions(
        &mut self,
        file: &SourceFile,
        span: Span,
        text: &str,
        otherwise: Option<&str>,
    ) -> Option<String> {
        let mut out = text.to_owned();
        for (path, range) in self.unknown(text).into_iter().rev() {
            let found = match self.assumed.get(&path) {
                Some((_, found)) => found.clone(),
                None => {
                    let found = match is_list(text, &range) {
                        true => list(),
                        false => Assumption { value: otherwise?.to_owned(), why: "a number" },
                    };
                    self.assumed.insert(path.clone(), (Rank::MAX, found.clone()));
                    found
                }
            };
            let Assumption { value, why } = found;
            let message = format!("`{path}` is taken for {value}, {why}; `--define {path}=VALUE` states another");
            self.tell(file, span, path, message);
            let literal = value.parse::<f64>().is_ok() || value.starts_with('[');
            out.replace_range(range, &if literal { value } else { format!("{value:?}") });
        }
        Some(out)
    }

    fn nodes(&mut self, file: &SourceFile, nodes: &[Node]) {
        for node in nodes {
            self.parts += 1;
            if self.parts > MOST {
                return;
            }
            match node {
                Node::Text(span) => self.out.copy(file, *span),
                Node::Value(span, text) => self.value(file, *span, text),
                Node::Refused(span) => self.refuse(file, *span, "the engine of its host"),
                Node::Include(span, path) => self.include(file, *span, path),
                Node::Set(span, name, text) => {
                    let text = self.with_assumptions(file, *span, text, Some("1")).unwrap_or_default();
                    match self.engine.value(&text, &self.scope) {
                        Ok(value) => drop(self.scope.insert(name.clone(), value)),
                        Err(why) => self.refuse(file, *span, &why),
                    }
                }
                Node::If(span, branches) => {
                    let taken = branches.iter().position(|branch| {
                        branch.condition.as_ref().is_none_or(|condition| self.holds(file, *span, condition))
                    });
                    let others = branches.iter().enumerate().filter(|(k, _)| Some(*k) != taken);
                    for (_, branch) in others {
                        let of = match (&branch.condition, branches.first().and_then(|b| b.condition.as_ref())) {
                            (Some(own), _) => own.text.clone(),
                            (None, Some(first)) => format!("not {}", first.text),
                            (None, None) => String::new(),
                        };
                        self.leave_out(file, &of, &branch.body);
                    }
                    if let Some(taken) = taken {
                        self.nodes(file, &branches[taken].body);
                    }
                }
                Node::For(span, of) => self.repeat(file, *span, of),
            }
        }
    }

    /// Remembers texts of a branch that is not taken, with its condition.
    fn leave_out(&mut self, file: &SourceFile, condition: &str, body: &[Node]) {
        for node in body {
            if let Node::Text(span) = node {
                self.left_out.push((file.slice(*span).to_owned(), condition.to_owned()));
            }
        }
    }

    fn refuse(&mut self, file: &SourceFile, span: Span, why: &str) {
        let shown = file.slice(span).to_owned();
        let help = "give the text as the engine writes it, or state what it needs with `--define NAME=VALUE`";
        self.problems.add(errors::TEMPLATE, file, span, format!("`{shown}` is not read: {why}"), help);
    }

    fn value(&mut self, file: &SourceFile, span: Span, text: &str) {
        if in_line_comment(file.text(), span.start) {
            return self.out.copy(file, span);
        }
        // A name is put in as it is stated; so is one that is none of an expression.
        if let Some((_, value)) = self.defines.iter().find(|(name, _)| name == text) {
            return self.out.replace(value, file, span);
        }
        if let Some((_, found)) = self.assumed.get(text) {
            let Assumption { value, why } = found.clone();
            let message = format!("`{text}` is taken for {value}, {why}; `--define {text}=VALUE` states another");
            self.tell(file, span, text.to_owned(), message);
            return self.out.replace(&value, file, span);
        }
        let missing = self.unknown(text).into_iter().map(|(path, _)| path).find(|p| !self.assumed.contains_key(p));
        if let Some(name) = missing {
            if self.empty && name == text.trim() && has_own_line(file.text(), span) {
                let message = format!("`{name}` is left empty: nothing states it; `--define {name}=VALUE` does");
                return self.tell(file, span, name, message);
            }
            let help = format!("give its value with `--define {name}=VALUE`; an empty value is one");
            let message = format!("the placeholder `{name}` has no value");
            return self.problems.add(errors::TEMPLATE, file, span, message, &help);
        }
        let whole = self.with_assumptions(file, span, text, None).unwrap_or_else(|| text.to_owned());
        match self.engine.value(&whole, &self.scope) {
            Ok(value) => self.out.replace(&written(&value), file, span),
            Err(why) => self.refuse(file, span, &why),
        }
    }

    /// Whether a branch is taken. A name alone that is not stated is off.
    fn holds(&mut self, file: &SourceFile, span: Span, condition: &Condition) -> bool {
        let text = condition.text.as_str();
        let (name, negated) = match text.strip_prefix("not ") {
            Some(rest) => (rest.trim(), !condition.negated),
            None => (text, condition.negated),
        };
        let is_name = |c: char| c.is_alphanumeric() || "_-./".contains(c);
        if name.chars().all(is_name) && !self.scope.contains_key(name.split('.').next().unwrap_or(name)) {
            return negated;
        }
        if let Some((_, value)) = self.defines.iter().find(|(defined, _)| defined == name) {
            return !matches!(value.as_str(), "false" | "0") != negated;
        }
        // What is compared with a text is taken for it.
        if let Some((path, literal)) = text.split_once("==").map(|(a, b)| (a.trim(), b.trim()))
            && literal.starts_with(['"', '\''])
            && self.unknown(path).first().is_some_and(|(found, _)| found == path)
            && !self.assumed.contains_key(path)
        {
            let value = literal.trim_matches(['"', '\'']).to_owned();
            self.assumed.insert(path.to_owned(), (0, Assumption { value, why: "what it is compared with" }));
        }
        let whole = self.with_assumptions(file, span, text, Some("1")).unwrap_or_else(|| text.to_owned());
        match self.engine.value(&whole, &self.scope) {
            Ok(value) => value.is_true() != condition.negated,
            Err(_) => {
                let message = format!("`{text}` is taken to hold: nothing states it");
                self.tell(file, span, text.to_owned(), message);
                true
            }
        }
    }

    fn repeat(&mut self, file: &SourceFile, span: Span, of: &Loop) {
        let whole = self.with_assumptions_in_calls(file, span, &of.over);
        let items: Option<Vec<Value>> =
            self.engine.value(&whole, &self.scope).ok().and_then(|all| all.try_iter().ok().map(Iterator::collect));
        let Some(items) = items else {
            let message = format!("the loop over `{}` is gone through once: nothing states how often", of.over);
            self.tell(file, span, of.over.clone(), message);
            self.round(file, of, None, (0, 1));
            return;
        };
        let count = items.len();
        for (k, item) in items.into_iter().enumerate() {
            self.round(file, of, Some(item), (k, count));
        }
    }

    /// Numbers within `range(…)`: a list that nothing states has no number of elements.
    fn with_assumptions_in_calls(&mut self, file: &SourceFile, span: Span, text: &str) -> String {
        match text.trim_start().starts_with("range") {
            true => self.with_assumptions(file, span, text, Some("2")).unwrap_or_else(|| text.to_owned()),
            false => text.to_owned(),
        }
    }

    fn round(&mut self, file: &SourceFile, of: &Loop, item: Option<Value>, (k, count): (usize, usize)) {
        let before = self.scope.clone();
        let about = minijinja::context! {
            index0 => k, index => k + 1, first => k == 0, last => k + 1 == count, length => count,
        };
        self.scope.insert("loop".to_owned(), about);
        match (item, &of.names[..]) {
            (Some(item), [name]) => drop(self.scope.insert(name.clone(), item)),
            (Some(item), names) => {
                let parts = item.try_iter().into_iter().flatten();
                self.scope.extend(names.iter().cloned().zip(parts));
            }
            (None, _) => {}
        }
        self.nodes(file, &of.body);
        self.scope = before;
    }

    fn include(&mut self, file: &SourceFile, span: Span, path: &str) {
        let wanted = Wanted { from: file.clone(), path: path.to_owned(), quoted: true, import: false, span };
        let found = (self.depth < DEEPEST).then(|| self.library.include(&wanted)).flatten();
        let Some(found) = found else {
            let help = crate::NAME_ITS_FOLDER;
            return self.problems.add(errors::IMPORT, file, span, format!("`{path}` is not found"), help);
        };
        // What is declared twice is an error, so that engines take a file with declarations once.
        let again = self.included.iter().any(|own| own.name() == found.name());
        if again && ["fn ", "struct "].iter().any(|word| found.text().contains(word)) {
            return;
        }
        self.included.push(found.clone());
        let Some((nodes, loose)) = tree(&found) else {
            return self.out.copy(&found, Span::new(0, found.text().len()));
        };
        for (span, what) in loose {
            self.problems.add(errors::TEMPLATE, &found, span, what, OPEN);
        }
        self.look(&found, &nodes);
        self.depth += 1;
        self.nodes(&found, &nodes);
        self.depth -= 1;
    }
}

/// True where nothing else stands on the line.
fn has_own_line(text: &str, span: Span) -> bool {
    let before = text[..span.start].rsplit(['\n', '\r']).next().unwrap_or("");
    let behind = text[span.end..].split(['\n', '\r']).next().unwrap_or("");
    before.trim().is_empty() && behind.trim().is_empty()
}

/// True for a path of whose elements a filter asks.
fn is_list(text: &str, path: &std::ops::Range<usize>) -> bool {
    let Some(filter) = text[path.end..].trim_start().strip_prefix('|') else { return false };
    let name: String = filter.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    matches!(name.as_str(), "first" | "last" | "nth" | "length" | "count" | "join" | "reverse" | "slice" | "sum")
}

fn list() -> Assumption {
    Assumption { value: "[64, 64]".to_owned(), why: "a list" }
}

/// A value as the text takes it: a whole number without a point, which suffixes would not fit.
fn written(value: &Value) -> String {
    let number = f64::try_from(value.clone()).ok().filter(|number| number.fract() == 0.0 && number.abs() < 1e15);
    match number {
        Some(number) if value.is_number() => format!("{number:.0}"),
        _ if value.kind() == minijinja::value::ValueKind::Bool => value.is_true().to_string(),
        _ => value.to_string(),
    }
}
