//! HLSL and Slang: modules of SPIR-V that a compiler wrote, with the way back to the author's text.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use naga::{AddressSpace, Module};

use super::lines::{At, Goes, Lines, kept, renamed};
use super::outline::{Head, Outline};
use super::{ModuleText, Written, digits, registers, rows, spirv};
use crate::ProgramError;
use crate::capabilities::{instructions, known_to_reader};
use crate::front::UNSUPPORTED;
use base::diagnostic::{Diagnostic, Severity};
use base::text::{Assembly, SourceFile, Span, printable};

/// Beginning of the names that are put behind the author's text.
pub const OWN: &str = "sc_keep";

/// Storage classes of the inputs and outputs of a stage.
const INPUT: u32 = 1;
const OUTPUT: u32 = 3;

/// What is known about a text beside its module.
#[derive(Clone, Debug, Default)]
pub(super) struct Compiled {
    pub outline: Arc<Outline>,
    /// Functions of the text, by the names that they have in the module.
    pub functions: Vec<(String, Span)>,
    /// What entry points call their outputs: by the point, and where the output goes.
    pub outputs: Vec<(String, Goes, String)>,
    /// Modules of the entry points, where the compiler writes one for each.
    pub beside: Vec<ModuleText>,
    /// Functions that are not in the module, with the reason.
    pub left_out: Vec<(String, Span, String)>,
}

impl ModuleText {
    /// Reads the modules that a compiler made of a text: the first has its functions, those behind it have an entry
    /// point each. `left_out` are functions that the compiler did not keep.
    ///
    /// # Errors
    /// As of [`ModuleText::read`].
    pub fn read_compiled(
        file: &SourceFile,
        written: Written,
        modules: &[Vec<u32>],
        outline: Outline,
        left_out: &[(usize, String)],
    ) -> Result<Self, ProgramError> {
        let outline = Arc::new(outline);
        let Some((first, others)) = modules.split_first() else {
            return Err(ProgramError::internal("a compiler gave no module".to_owned()));
        };
        let mut text = one(file, written, first, &outline)?;
        for words in others {
            let other = one(file, written, words, &outline)?;
            text.compiled.outputs.extend(other.compiled.outputs.iter().cloned());
            text.compiled.beside.push(other);
        }
        text.compiled.left_out = left_out
            .iter()
            .filter_map(|(k, why)| outline.functions.get(*k).map(|head| (head.label(&outline), head.span, why.clone())))
            .collect();
        // A compiler may have kept nothing but what is behind the text.
        text.module.entry_points.retain(|point| !point.name.starts_with(OWN));
        Ok(text)
    }

    /// What an entry point calls the output that is bound so.
    pub(super) fn output(&self, point: &str, binding: Option<&naga::Binding>) -> Option<&str> {
        use naga::{Binding, BuiltIn};
        let goes = match *binding? {
            Binding::Location { location, .. } => Goes::Location(location),
            Binding::BuiltIn(BuiltIn::Position { .. }) => Goes::BuiltIn(0),
            Binding::BuiltIn(BuiltIn::PointSize) => Goes::BuiltIn(1),
            Binding::BuiltIn(BuiltIn::SampleMask) => Goes::BuiltIn(20),
            Binding::BuiltIn(BuiltIn::FragDepth) => Goes::BuiltIn(22),
            Binding::BuiltIn(_) => return None,
        };
        let mut all = self.compiled.outputs.iter();
        all.find(|(own, to, _)| own == point && *to == goes).map(|(_, _, name)| name.as_str())
    }

    /// The head of a function, if the text has it.
    pub(super) fn head(&self, name: &str) -> Option<&Head> {
        let outline = &self.compiled.outline;
        outline.functions.iter().find(|head| head.label(outline) == name)
    }
}

fn one(
    author: &SourceFile,
    written: Written,
    words: &[u32],
    outline: &Arc<Outline>,
) -> Result<ModuleText, ProgramError> {
    let words = known_to_reader(words);
    let lines = Lines::of(&words);
    let sources = CompiledSources::new(author, &lines);
    // naga's reader ends its run of expressions at what is for debuggers, and then repeats them.
    let words = kept(&words, &lines.kept);
    let places = lines.places.iter().zip(&lines.kept).filter(|(_, kept)| **kept);
    let places: Vec<Span> =
        places.map(|(at, _)| at.as_ref().and_then(|at| sources.span(at)).unwrap_or_default()).collect();
    let words = rows::rows(&words).map_err(|(k, why)| {
        let span = places.get(k).copied().unwrap_or_default();
        let message = format!("naga's reader of SPIR-V would take this the wrong way: {why}");
        let found = Diagnostic::new(UNSUPPORTED, Severity::Error, &sources.file, span, message);
        ProgramError::Source(vec![found.at_origin()])
    })?;
    let (names, functions) = names(&lines, &sources, outline);
    let words = registers::apart(renamed(&words, &names));
    let file = sources.file.clone();
    // Instructions that were put in have no place; they stand in front of all functions.
    let added = instructions(&words).count().saturating_sub(places.len());
    let places: Vec<Span> = std::iter::repeat_n(Span::default(), added).chain(places).collect();
    let mut module = spirv::read(&file, &words, &places)?;
    unnamed_blocks(&mut module, outline);
    let outputs = outputs(&lines, &names, outline);
    let compiled = Compiled { outline: outline.clone(), functions, outputs, ..Compiled::default() };
    let constants = Arc::new(digits::constants(&file));
    Ok(ModuleText { module, file, written, tree: None, constants, compiled })
}

/// Blocks whose members the author names alone.
fn unnamed_blocks(module: &mut Module, outline: &Outline) {
    for (_, variable) in module.global_variables.iter_mut() {
        let name = variable.name.as_deref().unwrap_or_default();
        let loose = matches!(name, "" | "$Global" | "globalParams") || outline.blocks.iter().any(|block| block == name);
        if variable.space == AddressSpace::Uniform && loose {
            variable.name = Some(String::new());
        }
    }
}

/// Names as the author writes them, and the functions of the text.
fn names(lines: &Lines, sources: &CompiledSources, outline: &Outline) -> (HashMap<u32, String>, Vec<(String, Span)>) {
    let (mut names, mut functions, mut taken) = (HashMap::new(), Vec::new(), HashSet::new());
    let mut all: Vec<(&u32, &Option<At>)> = lines.functions.iter().collect();
    all.sort_by_key(|(id, _)| **id);
    for (id, at) in all {
        let Some(name) = lines.names.get(id) else { continue };
        // glslang: `@main(vf3;f1;`; the entry point around it has the name alone.
        let base = name.trim_start_matches('@').split('(').next().unwrap_or(name);
        let at = at.as_ref().filter(|at| sources.is_author(at));
        let head = at.and_then(|at| sources.head(outline, base, at.line));
        let label = head.map_or_else(|| base.to_owned(), |head| head.label(outline));
        let place = head.map(|head| head.span).or_else(|| at.and_then(|at| sources.span(at)));
        if let Some(span) = place.filter(|span| !base.starts_with("sc_keep") && span.start < sources.length)
            && taken.insert(label.clone())
        {
            functions.push((label.clone(), span));
        }
        names.insert(*id, label);
    }
    for (id, class) in lines.variables.iter().filter(|(_, class)| matches!(**class, INPUT | OUTPUT)) {
        let Some(name) = lines.names.get(id) else { continue };
        let own = name.rsplit('.').next().unwrap_or(name);
        let result = *class == OUTPUT && (own.starts_with("@entryPointOutput") || own.starts_with("entryPointParam"));
        names.insert(*id, if result { "return".to_owned() } else { own.to_owned() });
    }
    (names, functions)
}

/// What entry points call their outputs. What a compiler binds to a built-in value may have no name but the author's.
fn outputs(lines: &Lines, names: &HashMap<u32, String>, outline: &Outline) -> Vec<(String, Goes, String)> {
    let mut found = Vec::new();
    for (point, variables) in &lines.points {
        for id in variables.iter().filter(|id| lines.variables.get(id) == Some(&OUTPUT)) {
            let Some(&goes) = lines.goes.get(id) else { continue };
            let semantics: &[&str] = match goes {
                Goes::BuiltIn(0) => &["SV_POSITION", "POSITION"],
                Goes::BuiltIn(1) => &["PSIZE", "SV_POINTSIZE"],
                Goes::BuiltIn(20) => &["SV_COVERAGE"],
                Goes::BuiltIn(22) => &["SV_DEPTH", "SV_DEPTHGREATEREQUAL", "SV_DEPTHLESSEQUAL", "DEPTH"],
                Goes::BuiltIn(_) | Goes::Location(_) => &[],
            };
            let own = || outline.output(point, semantics).map(str::to_owned);
            let name = own().or_else(|| names.get(id).filter(|name| !name.is_empty()).cloned());
            found.extend(name.map(|name| (point.clone(), goes, name)));
        }
    }
    found
}

/// The author's text and those that the compiler read beside it, one behind the other.
struct CompiledSources {
    file: SourceFile,
    /// Bytes of the author's own.
    length: usize,
    /// Where the others begin.
    others: Vec<(String, SourceFile, usize)>,
}

impl CompiledSources {
    fn new(author: &SourceFile, lines: &Lines) -> Self {
        let length = author.text().len();
        let mut found = Self { file: author.clone(), length, others: Vec::new() };
        let others: Vec<_> = lines.texts.iter().filter(|(name, _)| !is_author(name)).collect();
        if others.is_empty() {
            return found;
        }
        let mut assembly = Assembly::new();
        assembly.copy(author, Span::new(0, length));
        let mut end = length;
        for (name, text) in others {
            assembly.insert("\n", author, length);
            let file = SourceFile::new(short(&printable(name)), text.as_str());
            assembly.copy(&file, Span::new(0, text.len()));
            found.others.push((name.clone(), file, end + 1));
            end += 1 + text.len();
        }
        found.file = assembly.finish(author.name());
        found
    }

    fn is_author(&self, at: &At) -> bool {
        is_author(&at.source)
    }

    /// The place of a line: from its column to the end of the statement.
    fn span(&self, at: &At) -> Option<Span> {
        let (text, base) = match self.others.iter().find(|(name, ..)| *name == at.source) {
            Some((_, file, base)) => (file.text(), *base),
            None if is_author(&at.source) => (&self.file.text()[..self.length], 0),
            None => return None,
        };
        let mut lines = text.split_inclusive('\n').map(|line| (line.as_ptr() as usize - text.as_ptr() as usize, line));
        let (start, line) = lines.nth(at.line - 1)?;
        let indent = line.len() - line.trim_start().len();
        let column = line.char_indices().nth(at.column.saturating_sub(1)).map_or(indent, |(byte, _)| byte).max(indent);
        let rest = line.get(column..)?;
        let end = rest.find(';').or_else(|| rest.find("//")).unwrap_or(rest.len());
        let length = rest[..end].trim_end().len();
        Some(Span::new(base + start + column, base + start + column + length))
    }

    /// The function of this name that begins on a line, or on the last one before it.
    fn head<'o>(&self, outline: &'o Outline, name: &str, line: usize) -> Option<&'o Head> {
        let last = |name: &str| name.rsplit([':', '.']).next().unwrap_or(name).to_owned();
        let text = self.file.text();
        let line_of = |head: &Head| 1 + text[..head.span.start].matches('\n').count();
        let fits = |head: &&Head| last(&head.name) == last(name) && line_of(head) <= line;
        outline.functions.iter().filter(fits).max_by_key(|head| head.span.start)
    }
}

/// True for the name that compilers give to what they read from a pipe.
fn is_author(name: &str) -> bool {
    matches!(name, "<stdin>" | "stdin" | "" | "-")
}

/// A path below the working folder as people name it.
fn short(name: &str) -> String {
    name.trim_start_matches("./").to_owned()
}
