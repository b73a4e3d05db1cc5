//! What stands for holes whose values are unknown: what their places ask for.
//!
//! A number of a binding is one that nothing else has, and whatever is an operand is a name that nothing declares: an input.

use std::collections::HashMap;

use base::text::{Assembly, SourceFile, Span};

use super::rests::resting;
use super::values::{OPEN, Open};

/// Characters of a name that is made up.
const LONGEST_NAME: usize = 40;

/// Holes that a note lists.
const LISTED: usize = 6;

/// What a number of invocations along an axis is.
const SIZE: &str = "a size of a workgroup";

/// A text without holes.
pub(super) struct Closed {
    pub file: SourceFile,
    /// What to tell of what is taken.
    pub notes: Vec<String>,
    /// Names that are made up for values.
    pub made_up: Vec<String>,
    /// A hole on whose value the text may depend.
    pub open: Option<String>,
    /// Functions whose findings rest on what is taken.
    pub resting: Vec<String>,
}

/// A hole, and what is around it.
struct Hole<'a> {
    open: &'a Open,
    /// The code in front of it, without comments.
    before: &'a str,
    /// The bracket that it stands in, as an offset of the code in front.
    bracket: Option<usize>,
    /// The text behind it.
    behind: &'a str,
    alone: bool,
}

/// What stands for a hole.
enum Stand {
    /// Nothing, which nobody has to know.
    Silent,
    Nothing,
    /// A text, and what it is.
    Taken(String, &'static str),
    Input(String),
}

/// The text with something for each hole that is left.
pub(super) fn closed(text: &SourceFile, open: &[Open]) -> Closed {
    let code = Code::read(text.text());
    let mut numbers = Numbers::new(text.text());
    let sizes = code.sizes(text.text(), open, &mut numbers);
    let (mut length, mut places, mut told) = (0, Vec::new(), Vec::new());
    let mut out = Assembly::new();
    let (mut at, mut nothing, mut taken, mut inputs, mut made_up) = (0, Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for mark in &code.marks {
        let Some(open) = open.get(mark.number) else { continue };
        let hole = code.hole(text.text(), mark, open);
        out.copy(text, Span::new(at, mark.span.start));
        length += mark.span.start - at;
        let place = || open.file.locate(open.span.start);
        // What gives a workgroup its size has that value everywhere.
        let stand = match sizes.get(&(open.file.name(), &open.written[..])) {
            _ if mark.in_comment => Stand::Silent,
            Some(size) => Stand::Taken(size.to_string(), SIZE),
            None => hole.stand(&mut numbers),
        };
        let mut behind = 0;
        let written = match stand {
            Stand::Silent => " ".to_owned(),
            Stand::Nothing => {
                if hole.bracket.is_some() {
                    places.push(length);
                }
                nothing.push(format!("`${{{}}}` at {}", open.written, place()));
                " ".to_owned()
            }
            Stand::Taken(written, what) => {
                // Which number a resource has changes nothing.
                if !hole.is_place() {
                    places.push(length);
                }
                // One that stands in several places is told once.
                let same = |(expression, value): &(String, String)| *expression == open.written && *value == written;
                if !told.iter().any(same) {
                    told.push((open.written.clone(), written.clone()));
                    taken.push(format!("`${{{}}}` at {} is taken for {written}, {what}", open.written, place()));
                }
                written
            }
            Stand::Input(name) => {
                inputs.push(format!("`${{{}}}` at {} as `{name}`", open.written, place()));
                made_up.push(name.clone());
                behind = hole.swallowed();
                name
            }
        };
        out.replace(&written, text, mark.span);
        length += written.len();
        at = mark.span.end + behind;
    }
    out.copy(text, Span::new(at, text.text().len()));
    let file = out.finish(text.name());
    // A name goes on where the text does: `${WIDTH}u`.
    let words = |name: String| whole_words(file.text(), &name);
    let mut made_up: Vec<String> = made_up.into_iter().flat_map(words).collect();
    made_up.sort();
    made_up.dedup();
    let first = nothing.first().or_else(|| inputs.first()).or_else(|| taken.first());
    let open = first
        .and_then(|first| first.split(" is taken for").next()?.split(" as `").next())
        .map(|first| format!("{first} is not known"));
    let mut notes = Vec::new();
    notes.extend(listed("nothing stands for what is filled in and is not known", nothing));
    notes.extend(taken);
    notes.extend(listed("what is filled in and is not known is taken for inputs of any value", inputs));
    let resting = resting(file.text(), &places);
    Closed { file, notes, made_up, open, resting }
}

fn listed(what: &str, mut all: Vec<String>) -> Option<String> {
    all.dedup();
    let more = all.len().saturating_sub(LISTED);
    let first = all.iter().take(LISTED).map(String::as_str).collect::<Vec<_>>().join(", ");
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    (!all.is_empty()).then(|| format!("{what}: {first}{rest}"))
}

/// Words of a text that begin with a name, or hold it.
fn whole_words(text: &str, name: &str) -> Vec<String> {
    let words = text.split(|c: char| !is_of_name(c));
    words.filter(|word| word.contains(name)).map(str::to_owned).collect()
}

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// A hole in a text.
struct Mark {
    number: usize,
    span: Span,
    in_comment: bool,
    /// Bytes of code in front of it.
    before: usize,
    bracket: Option<usize>,
}

impl Mark {
    /// True for a hole between the parentheses of a size of a workgroup.
    fn is_size(&self, code: &str) -> bool {
        self.bracket.is_some_and(|at| code[..at].trim_end().ends_with("@workgroup_size"))
    }
}

/// A text without its comments, and its holes.
struct Code {
    code: String,
    marks: Vec<Mark>,
}

impl Code {
    fn read(text: &str) -> Self {
        let (mut code, mut marks, mut brackets) = (String::new(), Vec::new(), Vec::<usize>::new());
        let (mut at, mut line, mut depth) = (0, false, 0_usize);
        while let Some(c) = text[at..].chars().next() {
            let rest = &text[at..];
            if c == OPEN.0 {
                let end = rest.find(OPEN.1).map_or(rest.len(), |end| end + OPEN.1.len_utf8());
                let digits = rest[..end].trim_matches([OPEN.0, OPEN.1]);
                marks.push(Mark {
                    number: digits.parse().unwrap_or(usize::MAX),
                    span: Span::new(at, at + end),
                    in_comment: line || depth > 0,
                    before: code.len(),
                    bracket: brackets.last().copied(),
                });
                if !line && depth == 0 {
                    // It stands for something.
                    code.push_str(&rest[..end]);
                }
                at += end;
                continue;
            }
            let mut length = c.len_utf8();
            if line {
                line = c != '\n';
            } else if rest.starts_with("/*") {
                (depth, length) = (depth + 1, 2);
            } else if depth > 0 {
                if rest.starts_with("*/") {
                    (depth, length) = (depth - 1, 2);
                }
            } else if rest.starts_with("//") {
                line = true;
            } else {
                match c {
                    '(' | '[' | '{' => brackets.push(code.len()),
                    ')' | ']' | '}' => drop(brackets.pop()),
                    _ => {}
                }
                code.push(c);
            }
            if c == '\n' && code.ends_with(|last| last != '\n') {
                code.push(c);
            }
            at += length;
        }
        Self { code, marks }
    }

    /// The values of expressions that are the size of a workgroup somewhere: the smallest of those that their places ask for.
    fn sizes<'o>(&self, text: &str, open: &'o [Open], numbers: &mut Numbers) -> HashMap<(&'o str, &'o str), u32> {
        let mut found: HashMap<(&str, &str), u32> = HashMap::new();
        for mark in self.marks.iter().filter(|mark| !mark.in_comment && mark.is_size(&self.code)) {
            let Some(open) = open.get(mark.number) else { continue };
            if let Stand::Taken(size, SIZE) = self.hole(text, mark, open).stand(numbers)
                && let Ok(size) = size.parse()
            {
                let known = found.entry((open.file.name(), &open.written)).or_insert(size);
                *known = size.min(*known);
            }
        }
        found
    }

    fn hole<'a>(&'a self, text: &'a str, mark: &Mark, open: &'a Open) -> Hole<'a> {
        let line = text[..mark.span.start].rsplit('\n').next().unwrap_or("").trim();
        let behind = &text[mark.span.end..];
        let rest = behind.split('\n').next().unwrap_or("").trim();
        let ends = rest.is_empty() || rest == ";" || rest.starts_with("//");
        Hole { open, before: &self.code[..mark.before], bracket: mark.bracket, behind, alone: line.is_empty() && ends }
    }
}

impl Hole<'_> {
    /// True for the number of a binding, a group or a location.
    fn is_place(&self) -> bool {
        let head = self.bracket.map_or("", |at| self.before[..at].trim_end());
        ["@binding", "@group", "@location"].iter().any(|attribute| head.ends_with(attribute))
    }

    fn stand(&self, numbers: &mut Numbers) -> Stand {
        let before = self.before.trim_end();
        let next = self.behind.trim_start().chars().next().unwrap_or(' ');
        let glued = self.before.ends_with(is_of_name) || self.behind.starts_with(is_of_name);
        let list = self.bracket.and_then(|at| Some((self.before[..at].trim_end(), self.before.get(at + 1..)?)));
        let in_list = self.bracket.is_some_and(|at| !self.before[at..].starts_with('{'));
        let within = |attribute: &str| list.is_some_and(|(head, _)| head.ends_with(attribute));
        if within("@binding") {
            return Stand::Taken(numbers.binding().to_string(), "a binding that nothing else has");
        }
        if within("@group") {
            return Stand::Taken(numbers.group(&self.open.written).to_string(), "a group");
        }
        if within("@location") {
            return Stand::Taken(numbers.location(&self.open.written).to_string(), "a location");
        }
        if let (true, Some((_, arguments))) = (within("@workgroup_size"), list) {
            let all = self.behind.split(')').next().unwrap_or("");
            return Stand::Taken(size(arguments, all).to_string(), SIZE);
        }
        // `#if ${SHADOWS}`
        if self.before.rsplit('\n').next().is_some_and(|line| line.trim_start().starts_with('#')) {
            return Stand::Taken("0".to_owned(), "a condition that is not so");
        }
        if glued {
            return Stand::Input(self.name(numbers));
        }
        if let Some((written, what)) = self.word_of_type(before, next) {
            return Stand::Taken(written.to_owned(), what);
        }
        let operand = before.ends_with(|c| "=+-*/%&|^<>,:!~.".contains(c)) && !before.ends_with('>')
            || before.ends_with("->")
            || before.rsplit(|c| !is_of_name(c)).next() == Some("return");
        let in_struct = before.ends_with(',') && !in_list && self.bracket.is_some();
        let label = before.rsplit(['\n', ';', '{', '}']).next().unwrap_or("").trim_start();
        let behind_label = before.ends_with(':') && (label.starts_with("case") || label.starts_with("default"));
        let goes_on = "=.([,+-*/%&|^<>".contains(next);
        if !in_list && (!operand || in_struct || behind_label) && (self.alone || !goes_on) {
            return Stand::Nothing;
        }
        Stand::Input(self.name(numbers))
    }

    /// What stands where a type or a word of one does.
    fn word_of_type(&self, before: &str, next: char) -> Option<(&'static str, &'static str)> {
        const TYPE: &str = "a type";
        // `array<${T}, 4>`
        let angle = before.rfind('<').filter(|at| !before[*at..].contains(['>', ';', '(', '{', '=']));
        if let Some(at) = angle {
            let (head, inside) = (before[..at].trim_end(), &before[at + 1..]);
            let word = head.rsplit(|c: char| !is_of_name(c)).next().unwrap_or("");
            let index = inside.matches(',').count();
            let first = index == 0 && inside.trim().is_empty();
            return match word {
                "var" if index == 1 && inside.contains("storage") => Some(("read_write", "an access")),
                "ptr" if index == 2 => Some(("read_write", "an access")),
                "ptr" if index == 1 => Some(("f32", TYPE)),
                "atomic" if first => Some(("u32", TYPE)),
                "array" if first => Some(("f32", TYPE)),
                word if word.starts_with("texture_storage") => {
                    Some(if first { ("rgba8unorm", "a format") } else { ("write", "an access") })
                }
                word if first && ["vec", "mat", "texture"].iter().any(|kind| word.starts_with(kind)) => {
                    Some(("f32", TYPE))
                }
                _ => None,
            };
        }
        let named = before.strip_suffix(':').is_some_and(|name| {
            let name = name.trim_end();
            let word = name.rsplit(|c: char| !is_of_name(c)).next().unwrap_or("");
            !word.is_empty()
                && word != "default"
                && !name.rsplit(['\n', ';', '{']).next().unwrap_or("").trim().starts_with("case")
        });
        ((named || before.ends_with("->")) && ",;){}=".contains(next)).then_some(("f32", TYPE))
    }

    /// A name for what stands in the hole.
    fn name(&self, numbers: &mut Numbers) -> String {
        numbers.name(&self.open.written, self.before.ends_with(is_of_name))
    }

    /// Bytes behind it that belong to a number and not to a name: `${WIDTH}.0`.
    fn swallowed(&self) -> usize {
        let Some(rest) = self.behind.strip_prefix('.') else { return 0 };
        let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        if digits == 0 { 0 } else { 1 + digits + usize::from(rest[digits..].starts_with('f')) }
    }
}

/// The size of a workgroup along an axis, by what stands in front and behind.
fn size(before: &str, behind: &str) -> u32 {
    let all = format!("{before}?{behind}");
    let open = all.split(',').filter(|one| one.trim() != "1" && !one.trim().is_empty()).count();
    match open {
        0 | 1 => 64,
        2 => 8,
        _ => 4,
    }
}

/// Numbers and names that are taken.
struct Numbers {
    bindings: Vec<u32>,
    groups: Vec<u32>,
    locations: Vec<u32>,
    given: HashMap<(char, String), u32>,
    words: Vec<String>,
    names: HashMap<String, String>,
}

impl Numbers {
    fn new(text: &str) -> Self {
        let of = |attribute: &str| {
            let all = text.match_indices(attribute).filter_map(|(at, _)| {
                let rest = text[at + attribute.len()..].trim_start().strip_prefix('(')?.trim_start();
                rest[..rest.find(|c: char| !c.is_ascii_digit())?].parse().ok()
            });
            all.collect::<Vec<u32>>()
        };
        let words = text.split(|c: char| !is_of_name(c)).filter(|word| !word.is_empty()).map(str::to_owned);
        Self {
            bindings: of("@binding"),
            groups: of("@group"),
            locations: of("@location"),
            given: HashMap::new(),
            words: words.collect(),
            names: HashMap::new(),
        }
    }

    fn binding(&mut self) -> u32 {
        free(&mut self.bindings)
    }

    /// One for each expression.
    fn group(&mut self, written: &str) -> u32 {
        let groups = &mut self.groups;
        *self.given.entry(('g', written.to_owned())).or_insert_with(|| free(groups))
    }

    /// One for each expression: stages name what they share alike.
    fn location(&mut self, written: &str) -> u32 {
        let locations = &mut self.locations;
        *self.given.entry(('l', written.to_owned())).or_insert_with(|| free(locations))
    }

    fn name(&mut self, written: &str, inside: bool) -> String {
        if let Some(known) = self.names.get(written) {
            return known.clone();
        }
        let mut name = String::new();
        for c in written.chars() {
            let c = if c.is_ascii_alphanumeric() { c } else { '_' };
            if !(c == '_' && (name.is_empty() || name.ends_with('_'))) && name.len() < LONGEST_NAME {
                name.push(c);
            }
        }
        let mut name = name.trim_end_matches('_').to_owned();
        if name.is_empty() || (name.starts_with(|c: char| c.is_ascii_digit()) && !inside) {
            name = format!("value_{name}");
        }
        let means = |name: &str| syntax::wgsl::is_builtin(name) || syntax::types::Type::from_name(name).is_some();
        while self.words.contains(&name) || means(&name) {
            name.push_str("_in");
        }
        self.words.push(name.clone());
        self.names.insert(written.to_owned(), name.clone());
        name
    }
}

/// The first number that is not taken; it is taken from now on.
fn free(taken: &mut Vec<u32>) -> u32 {
    let found = (0..).find(|number| !taken.contains(number)).unwrap_or(0);
    taken.push(found);
    found
}
