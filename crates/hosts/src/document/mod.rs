//! Documents: prose with shaders and host code in blocks, and other files with several shaders. Each listing keeps the way
//! back to the document, so that places and repairs are the document's own.
//!
//! A shader or a host listing may be made of several blocks. What a block lacks to be a whole shader is not reported.

mod asciidoc;
mod blocks;
mod html;
mod join;
mod kind;
mod markdown;
mod staged;
mod tex;

use base::text::{SourceFile, Span};
use syntax::Stage;

use crate::language::{Language, language_of, language_of_file};
use crate::piece::Place;
use crate::script::filled::{Imports, filled};
use crate::sections::sections;
use crate::{Body, Embedded, HostFile, Literal, concerns_shaders, cpp, script};
use blocks::Blocks;

/// Endings of documents that a folder is searched for.
pub const DOCUMENT_EXTENSIONS: &[&str] = &["md", "markdown", "txt", "adoc", "asciidoc", "tex", "html", "htm"];

/// The code of a document.
#[derive(Default)]
pub struct Document {
    /// Shaders, in the order of the text.
    pub shaders: Vec<Listing>,
    /// Host code in C and C++, in the order of the text.
    pub hosts: Vec<Listing>,
    /// The scripts that a page runs, as one text: they share their names.
    pub script: Option<Listing>,
}

/// Blocks of a document that are one text.
pub struct Listing {
    /// Name for messages: the document's and the line of the first block.
    pub name: String,
    /// What the document calls it: a file's name in the line of the fence.
    pub called: Option<String>,
    /// The text and its places.
    pub literal: Literal,
    /// Its stage; that of a library for host code and where nothing says it.
    pub stage: Stage,
    /// True for a text that lacks something: only what is wrong in any context may be told.
    pub partial: bool,
    /// True for a text that scripts of a page take as it is.
    pub whole: bool,
    /// Where it stands among the others.
    pub place: Place,
}

/// How blocks of code are marked.
#[derive(Clone, Copy)]
enum Format {
    Markdown,
    AsciiDoc,
    Tex,
    Html,
}

impl Format {
    fn of(name: &str) -> Self {
        match name.rsplit('.').next().unwrap_or("").to_ascii_lowercase().as_str() {
            "html" | "htm" | "xhtml" => Self::Html,
            "adoc" | "asciidoc" | "asc" => Self::AsciiDoc,
            "tex" | "ltx" | "latex" => Self::Tex,
            _ => Self::Markdown,
        }
    }

    /// What a document with code cannot do without.
    fn marks(self) -> &'static [&'static str] {
        match self {
            Self::Markdown => &["```", "~~~", "<pre", "<script"],
            Self::AsciiDoc => &["----", "....", "```", "[source"],
            Self::Tex => &["{lstlisting}", "erbatim}", "{minted}", "{alltt}"],
            Self::Html => &["<pre", "<script", "<PRE", "<SCRIPT"],
        }
    }
}

impl Document {
    /// Reads a document; none when it holds neither a shader nor host code.
    pub fn read(file: &SourceFile) -> Option<Self> {
        if let Some(document) = staged::read(file) {
            return Some(document);
        }
        let format = Format::of(file.name());
        let text = file.text();
        if !format.marks().iter().any(|m| text.contains(m)) || !(text.contains("glsl") || concerns_shaders(text)) {
            return None;
        }
        let mut blocks = Blocks::new(file);
        match format {
            Format::Markdown => markdown::read(&mut blocks),
            Format::AsciiDoc => asciidoc::read(&mut blocks),
            Format::Tex => tex::read(&mut blocks),
            Format::Html => html::read(&mut blocks, Span::new(0, text.len())),
        }
        let script = blocks.script();
        let document = Self { script, ..join::listings(file, blocks.finish()) };
        (!document.shaders.is_empty() || !document.hosts.is_empty() || document.script.is_some()).then_some(document)
    }
}

/// True for a text that is no shader or host file by its name, and holds blocks of such code.
pub fn is_document(file: &SourceFile) -> bool {
    Document::read(file).is_some()
}

/// A whole shader of a document.
#[derive(Clone, Debug)]
pub struct Printed {
    /// Its text, whose places lead back to the document.
    pub file: SourceFile,
    /// Its stage.
    pub stage: Stage,
    /// The lines of the document that it takes, those around it included.
    pub lines: std::ops::RangeInclusive<usize>,
    /// What to tell of what a host fills in, and is not known.
    pub notes: Vec<String>,
    /// Names in it that stand for values which are not known.
    pub made_up: Vec<String>,
    /// What a host fills in and is not known, so that an error of the text need not be its author's.
    pub open: Option<String>,
    /// True for a string that a host puts into others.
    pub part: bool,
    /// Functions whose findings rest on what is taken for what a host fills in.
    pub resting: Vec<String>,
}

/// As [`printed_shaders`], and the modules in WGSL that a host puts together of templates, for commands that run them. What
/// the file imports is read by `imports`.
pub fn runnable_shaders(file: &SourceFile, imports: &mut Imports<'_>) -> Vec<Printed> {
    let Some(host) = host_of(file) else {
        let all = printed_shaders(file);
        return if all.is_empty() { statements(file).into_iter().collect() } else { all };
    };
    let mut all = in_strings(file, &host);
    let bodies = if host.is_script() { script::bodies(file) } else { cpp::embedded::bodies(&host) };
    let is_body = |e: &Embedded| bodies.iter().any(|(_, body)| body.literal.place() == e.literal.place());
    let piece = |e: &Embedded| Some(Printed { part: true, ..printed(file, &e.name, e.stage, &e.literal)? });
    let pieces = |found: &[Embedded]| -> Vec<Printed> {
        found.iter().filter(|e| e.partial && !is_body(e)).filter_map(piece).collect()
    };
    if !host.is_script() {
        all.extend(pieces(&cpp::embedded::pieces(&host)));
        all.extend(named_bodies(file, &bodies, &all));
        all.sort_by_key(|shader| *shader.lines.start());
        return all;
    }
    let known: Vec<Span> = host.embedded().iter().filter(|e| !e.partial).map(|e| e.place).collect();
    all.extend(pieces(host.embedded()));
    all.extend(named_bodies(file, &bodies, &all));
    all.extend(filled(file, &known, imports).into_iter().map(|filled| {
        let line = |offset: usize| file.position(offset).line;
        let lines = line(filled.place.start).saturating_sub(1)..=line(filled.place.end.saturating_sub(1)) + 1;
        Printed {
            file: filled.text,
            stage: Stage::Library,
            lines,
            notes: filled.notes,
            made_up: filled.made_up,
            open: filled.open,
            part: filled.part,
            resting: filled.resting,
        }
    }));
    all.sort_by_key(|shader| *shader.lines.start());
    all
}

/// Statements that a host puts into functions, each by a name that no other text has.
fn named_bodies(file: &SourceFile, bodies: &[(Option<String>, Body)], others: &[Printed]) -> Vec<Printed> {
    let mut found: Vec<Printed> = Vec::new();
    for (called, body) in bodies {
        let line = body.literal.place().map_or(0, |place| file.position(place.start).line);
        let mut name = format!("{}#{}", file.name(), called.clone().unwrap_or_else(|| line.to_string()));
        if others.iter().chain(&found).any(|known| known.file.name() == name) {
            name = format!("{name}:{line}");
        }
        found.extend(in_function(file, &name, body));
    }
    found
}

/// Statements as a function.
fn in_function(file: &SourceFile, name: &str, body: &Body) -> Option<Printed> {
    let printed = printed(file, name, Stage::Library, &body.literal)?;
    Some(Printed { part: true, notes: body.notes(), ..printed })
}

/// A file of statements that its host puts into a function.
fn statements(file: &SourceFile) -> Option<Printed> {
    let is_glsl = matches!(language_of_file(file), Some(Language::Shader(_)));
    let called = file.name().rsplit(['/', '\\']).next()?.split('.').next()?;
    let whole = is_glsl.then(|| Literal::part(file, Span::new(0, file.text().len())))?;
    in_function(file, file.name(), &Body::of(&whole, called)?)
}

/// The whole shaders in strings of host code.
fn whole_strings(host: &HostFile) -> Vec<(String, Stage, Literal)> {
    // What runs a text knows its language by its name.
    let named = |e: &Embedded| if e.wgsl { format!("{}.wgsl", e.name) } else { e.name.clone() };
    let whole = host.embedded().iter().filter(|e| !e.partial);
    whole.map(|e| (named(e), e.stage, e.literal.clone())).collect()
}

/// The document that a part of it stands in, by the name of the part: that of the document and a line.
pub fn document_of(name: &str) -> &str {
    let is_line = |line: &str| !line.is_empty() && line.bytes().all(|b| b.is_ascii_digit());
    name.rsplit_once(':').filter(|(_, line)| is_line(line)).map_or(name, |(document, _)| document)
}

/// The whole shaders that a file of another kind holds, in the order of the text: the blocks of a document, strings of
/// host code, and the stages of a file that has several. None for a file that is one shader.
pub fn printed_shaders(file: &SourceFile) -> Vec<Printed> {
    let all: Vec<(String, Stage, Literal)> = match language_of(file.name()) {
        Some(Language::Shader(_)) => {
            let named = |stage: Stage| format!("{} ({})", file.name(), stage.name());
            sections(file).into_iter().map(|(stage, literal)| (named(stage), stage, literal)).collect()
        }
        Some(Language::Wgsl) => Vec::new(),
        Some(Language::Host | Language::Script) => {
            return host_of(file).map(|host| in_strings(file, &host)).unwrap_or_default();
        }
        None => {
            let document = Document::read(file).unwrap_or_default();
            // Places in the scripts of a page are those in the page.
            let script = document.script.map(|l| HostFile::script(&SourceFile::new(l.name, l.literal.text), true));
            let strings = script.as_ref().map(whole_strings).unwrap_or_default();
            let shaders = document.shaders.into_iter().filter(|s| !s.partial);
            shaders.map(|s| (s.name, s.stage, s.literal)).chain(strings).collect()
        }
    };
    all.iter().filter_map(|(name, stage, literal)| printed(file, name, *stage, literal)).collect()
}

/// The file as host code, if that is what its name says.
fn host_of(file: &SourceFile) -> Option<HostFile> {
    match language_of(file.name())? {
        Language::Script => Some(HostFile::script(file, true)),
        Language::Host => Some(HostFile::new(file, true)),
        Language::Shader(_) | Language::Wgsl => None,
    }
}

/// The whole shaders in strings of host code, to be run.
fn in_strings(file: &SourceFile, host: &HostFile) -> Vec<Printed> {
    let all = whole_strings(host);
    all.iter().filter_map(|(name, stage, literal)| printed(file, name, *stage, literal)).collect()
}

/// A text that stands in a file, to be run.
fn printed(file: &SourceFile, name: &str, stage: Stage, literal: &Literal) -> Option<Printed> {
    let place = literal.place()?;
    let last = file.position(place.end.saturating_sub(1)).line;
    Some(Printed {
        file: literal.assembled(file, name),
        stage,
        lines: file.position(place.start).line.saturating_sub(1)..=last + 1,
        notes: Vec::new(),
        made_up: Vec::new(),
        open: None,
        part: false,
        resting: Vec::new(),
    })
}
