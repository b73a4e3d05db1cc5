//! Blocks that are one text: a shader or a listing of host code that a document cuts into pieces.

use std::collections::BTreeSet;

use base::diagnostic::Code;
use base::text::{SourceFile, Span};
use syntax::{Parsed, Shader, Stage, errors};

use super::blocks::Block;
use super::kind::{Kind, file_name, kind};
use super::{Document, Listing, Place};
use crate::{HostFile, Literal, marks};

/// One block or several.
#[derive(Clone)]
struct Part<'b> {
    literal: Literal,
    first: &'b Block,
    last: &'b Block,
    stage: Option<Stage>,
    called: Option<String>,
    /// True when the code says that something is left out; a comment may say so too.
    elided: bool,
    elided_in_comment: bool,
}

/// The shaders and the host code of a document.
pub fn listings(file: &SourceFile, blocks: Vec<Block>) -> Document {
    let (mut shaders, mut hosts) = (Vec::new(), Vec::new());
    for block in blocks.iter().filter(|b| !is_template(&b.literal.text)) {
        match kind(&block.tag, &block.literal.text) {
            Kind::Shader(stage) => shaders.push(Part::new(block, stage)),
            Kind::Host => hosts.push(Part::new(block, None)),
            Kind::Other => {}
        }
    }
    let whole = |part: &Part<'_>| marks::has_main(&part.literal.text) && depth(&part.literal.text) == 0;
    let shaders = join(shaders, continues, whole).into_iter().filter_map(|p| p.shader(file)).collect();
    let hosts = join(hosts, goes_on, |_| true).into_iter().map(|p| p.host(file)).collect();
    Document { shaders, hosts, script: None }
}

/// True for a text that a tool fills in.
fn is_template(text: &str) -> bool {
    ["{{", "${", "<%", "%s", "%d"].iter().any(|p| text.contains(p))
}

/// Joins parts as long as one goes on in the next; what then makes no sense as a whole stays apart.
fn join<'b>(
    parts: Vec<Part<'b>>,
    continues: fn(&Part<'b>, &Part<'b>) -> bool,
    makes_sense: impl Fn(&Part<'b>) -> bool,
) -> Vec<Part<'b>> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = parts.get(at) {
        let mut joined = first.clone();
        let mut count = 1;
        while let Some(more) = parts.get(at + count).filter(|more| continues(&joined, more)) {
            joined = joined.with(more);
            count += 1;
        }
        if count > 1 && !makes_sense(&joined) {
            (joined, count) = (first.clone(), 1);
        }
        found.push(joined);
        at += count;
    }
    found
}

/// True when a shader goes on in the next block.
fn continues(part: &Part<'_>, more: &Part<'_>) -> bool {
    let differ = matches!((part.stage, more.stage), (Some(a), Some(b)) if a != b);
    if has_version(&more.literal.text) || differ {
        return false;
    }
    if depth(&part.literal.text) > 0 {
        return true;
    }
    if marks::has_main(&part.literal.text) {
        return false;
    }
    let stage = part.stage.or(more.stage).unwrap_or(Stage::Library);
    let read = |p: &Part<'_>| parsed(&p.literal, stage);
    let (joined, before, after) = (read(&part.with(more)), read(part), read(more));
    let fits =
        count(&joined, |code| code == errors::REDEFINITION) == 0 && faults(&joined) <= faults(&before) + faults(&after);
    let names = |p: &Parsed| count(p, errors::is_name);
    fits && (names(&joined) < names(&before) + names(&after) || !marks::has_main(&more.literal.text))
}

/// True when a listing of host code goes on in the next block: in the middle of a function, or as statements
/// of the same section.
fn goes_on(part: &Part<'_>, more: &Part<'_>) -> bool {
    if depth(&part.literal.text) > 0 {
        return true;
    }
    let near = part.last.section == more.first.section && part.last.order + 1 == more.first.order;
    let declared = |p: &Part<'_>| HostFile::new(&SourceFile::new("", p.literal.text.as_str()), true).statements();
    match (near, declared(part), declared(more)) {
        (true, Some(a), Some(b)) => a.is_disjoint(&b),
        _ => false,
    }
}

fn parsed(literal: &Literal, stage: Stage) -> Parsed {
    Shader::parse_fitting(&SourceFile::new("", literal.text.as_str()), stage, &[], false)
}

fn count(parsed: &Parsed, is: impl Fn(Code) -> bool) -> usize {
    parsed.diagnostics.iter().filter(|d| is(d.code)).count()
}

/// Number of places that do not follow the grammar.
fn faults(parsed: &Parsed) -> usize {
    count(parsed, errors::is_of_the_text)
}

fn has_version(text: &str) -> bool {
    text.lines().any(|l| l.trim_start().strip_prefix('#').is_some_and(|r| r.trim_start().starts_with("version")))
}

/// Braces that are open at the end of a text.
fn depth(text: &str) -> usize {
    let (mut depth, mut quote, mut before) = (0_usize, None, ' ');
    for c in marks::without_comments(text).chars() {
        match (quote, c) {
            (None, '{') => depth += 1,
            (None, '}') => depth = depth.saturating_sub(1),
            (None, '"' | '\'') => quote = Some(c),
            (Some(q), c) if (q == c && before != '\\') || c == '\n' => quote = None,
            _ => {}
        }
        before = if before == '\\' { ' ' } else { c };
    }
    depth
}

/// Where dots stand for what is left out, and whether a comment says so.
fn elisions(text: &str) -> (Vec<Span>, bool) {
    const MARKS: [&str; 3] = ["...", "…", "・・・"];
    const WORDS: [&str; 5] = ["略", "omitted", "as before", "rest of the", "unchanged"];
    let code = marks::without_comments(text);
    let blank = |w: &str| code.matches(w).count();
    let in_comment = MARKS.iter().chain(&WORDS).any(|w| text.matches(w).count() > blank(w));
    let mut found = Vec::new();
    let mut at = 0;
    let changes = has_changes(&code);
    for line in text.split_inclusive('\n') {
        // What is new keeps its text, what is gone does not.
        if changes && line.starts_with('-') {
            found.push(Span::new(at, at + line.trim_end().len()));
            at += line.len();
            continue;
        }
        if changes && line.starts_with(['+', '*']) {
            found.push(Span::new(at, at + 1));
        }
        let end = line.find("//").unwrap_or(line.len());
        for mark in MARKS {
            found.extend(line[..end].match_indices(mark).map(|(i, m)| Span::new(at + i, at + i + m.len())));
        }
        at += line.len();
    }
    (found, in_comment)
}

impl<'b> Part<'b> {
    fn new(block: &'b Block, stage: Option<Stage>) -> Self {
        let mut literal = block.literal.clone();
        let (spans, elided_in_comment) = elisions(&literal.text);
        spans.iter().for_each(|span| literal.blank(*span));
        let called = file_name(&block.tag).map(str::to_owned);
        Self { literal, first: block, last: block, stage, called, elided: !spans.is_empty(), elided_in_comment }
    }

    fn with(&self, more: &Self) -> Self {
        let mut joined = self.clone();
        joined.literal.append(&more.literal);
        joined.last = more.last;
        joined.stage = self.stage.or(more.stage);
        joined.elided |= more.elided;
        joined.elided_in_comment |= more.elided_in_comment;
        joined
    }

    /// The part as a shader; none when it follows no grammar.
    fn shader(mut self, file: &SourceFile) -> Option<Listing> {
        let stage = self.stage.or_else(|| stage(&self.literal.text)).unwrap_or(Stage::Library);
        let read = parsed(&self.literal, stage);
        let open = !marks::has_main(&self.literal.text) || depth(&self.literal.text) > 0;
        let lacks = count(&read, errors::is_name) > 0 && (self.elided_in_comment || !self.is_stated());
        let partial = open || self.elided || lacks;
        // A few lines that show a mistake on purpose are no mistake.
        if partial && shows_a_mistake(&self.literal.text) {
            return None;
        }
        if partial && faults(&read) > 0 {
            self.literal = self.literal.within("void _() {\n", "\n}\n");
            if faults(&parsed(&self.literal, stage)) > 0 {
                return None;
            }
        }
        Some(self.listing(file, stage, partial))
    }

    /// True where the document leaves nothing to stand in front of the text.
    fn is_stated(&self) -> bool {
        has_version(&self.literal.text) || (self.first.whole && self.first.place == self.last.place)
    }

    fn host(self, file: &SourceFile) -> Listing {
        let partial = self.elided;
        self.listing(file, Stage::Library, partial)
    }

    fn listing(self, file: &SourceFile, stage: Stage, partial: bool) -> Listing {
        let line = file.position(self.first.place.start).line;
        Listing {
            name: format!("{}:{line}", file.name()),
            called: self.called,
            literal: self.literal,
            stage,
            partial,
            whole: self.first.whole,
            place: Place {
                document: file.name().to_owned(),
                order: self.first.order,
                section: self.first.section.clone(),
            },
        }
    }
}

/// True for a text whose comments say that it is wrong.
fn shows_a_mistake(text: &str) -> bool {
    let lower = text.to_ascii_lowercase();
    let words = ["invalid", "won't compile", "not compile", "illegal", "error", "wrong", "エラー", "間違い"];
    lower.lines().filter_map(|l| l.split_once("//")).any(|(_, comment)| words.iter().any(|w| comment.contains(w)))
}

/// True for a text whose first column tells what has changed, as in a patch. Code has no operators there.
fn has_changes(code: &str) -> bool {
    code.lines().any(|l| l.starts_with(['+', '-', '*']))
}

/// The stage that a text says, by its contents or by its first comment.
fn stage(text: &str) -> Option<Stage> {
    let by_contents = marks::stage(text).ok()?;
    let comment = || text.lines().map(str::trim).find(|l| !l.is_empty()).filter(|l| l.starts_with("//"));
    let by_comment = || comment().and_then(Stage::of_name);
    by_contents.or_else(by_comment).or_else(|| writes_one_colour(text).then_some(Stage::Fragment))
}

/// True for a `main` without a position whose one output is of the type of a colour.
fn writes_one_colour(text: &str) -> bool {
    let code = marks::without_comments(text);
    let outputs: BTreeSet<&str> = code
        .lines()
        .map(|l| l.trim().rsplit_once(") ").map_or(l.trim(), |(_, behind)| behind))
        .filter(|l| l.starts_with("out ") && l.contains(';'))
        .collect();
    let colour =
        |l: &&str| l["out ".len()..].trim_start().starts_with("vec") && (l.contains("vec4 ") || l.contains("vec3 "));
    marks::has_main(&code) && outputs.len() == 1 && outputs.iter().all(colour)
}
