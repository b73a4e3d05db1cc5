//! What can be run of a piece in which some functions do not compile: the others. A whole shader is refused, unless its host
//! has a hand in what does not compile.

use super::includes::{IncludedText, read_glsl};
use base::diagnostic::{Diagnostic, Severity};
use base::text::{Assembly, SourceFile, Span};
use engine::completion::Completed;
use engine::fuzz::Subject;
use engine::suite::read_module;
use program::{ModuleText, ProgramError, Written};
use syntax::ast::ItemKind;
use syntax::{Parsed, Shader, errors};

/// Rounds in which functions are left out: those with errors, then those that call them, and so on.
const MOST_ROUNDS: usize = 32;

/// The functions of a text that are left out, each with its first error.
#[derive(Default)]
pub(super) struct LeftOut(Vec<(String, Diagnostic)>);

impl LeftOut {
    /// As functions that cannot be run.
    pub fn subjects(self) -> impl Iterator<Item = Subject> {
        self.0.into_iter().map(|(name, error)| {
            let error = error.at_origin();
            Subject {
                label: name.clone(),
                name,
                parameters: Vec::new(),
                at: error.file.locate(error.span.start).to_string(),
                ready: Err(format!("it does not compile: {}", error.message)),
                dispatch: None,
                stated: Vec::new(),
                made_up: false,
            }
        })
    }

    /// The text without the functions in which errors stand; none where one stands elsewhere. Of a text that is `open` other
    /// declarations go as well, and lines that a host reads.
    fn without(&mut self, shader: &Shader, errors: &[Diagnostic], open: bool) -> Option<SourceFile> {
        let file = shader.file();
        let items = shader.unit().items.iter().filter_map(|item| match &item.kind {
            ItemKind::Function(function) if function.body.is_some() => Some((Some(&function.name.name), item.span)),
            _ => open.then_some((None, item.span)),
        });
        let items: Vec<(Option<&String>, Span)> = items.collect();
        let mut gone: Vec<Span> = Vec::new();
        for error in errors {
            let at = error.span.start;
            let own = error.file == *file;
            if open && own && [errors::UNKNOWN_DIRECTIVE, errors::INCLUDE, errors::LATE_VERSION].contains(&error.code) {
                gone.push(line_of(file.text(), at));
                continue;
            }
            let (name, span) = items.iter().find(|(_, span)| own && span.contains(at))?;
            if !gone.contains(span) {
                gone.push(*span);
                self.0.extend(name.map(|name| (name.clone(), error.clone())));
            }
        }
        gone.sort_by_key(|span| (span.start, std::cmp::Reverse(span.end)));
        let mut assembly = Assembly::new();
        let mut from = 0;
        for span in gone.iter().filter(|span| !span.is_empty()) {
            if span.start >= from {
                assembly.copy(file, Span::new(from, span.start));
                from = span.end;
            }
        }
        assembly.copy(file, Span::new(from, file.text().len()));
        (from > 0).then(|| assembly.finish(file.name()))
    }
}

/// The line of a place, without its end.
fn line_of(text: &str, at: usize) -> Span {
    let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
    Span::new(start, text[at..].find('\n').map_or(text.len(), |end| at + end))
}

/// The rest of a piece in GLSL whose errors all stand in functions, and of a text that is `open` in other declarations as
/// well: its host puts something in their place.
pub(super) fn shader(
    source: &IncludedText,
    shader: &Shader,
    errors: &[Diagnostic],
    (defines, open): (&[(String, String)], bool),
) -> Option<(Shader, LeftOut)> {
    // A whole shader that does not compile is refused.
    if !open && shader.function("main").is_some() {
        return None;
    }
    let mut left_out = LeftOut::default();
    let mut rest = left_out.without(shader, errors, open)?;
    for _ in 0..MOST_ROUNDS {
        let Parsed { shader, mut diagnostics } = read_glsl(&rest, source.stage, defines);
        diagnostics.retain(|d| d.severity == Severity::Error && d.code != errors::MISSING_MAIN);
        if diagnostics.is_empty() {
            return Some((shader, left_out));
        }
        rest = left_out.without(&shader, &diagnostics, open)?;
    }
    None
}

/// True for a piece of which some function is right with what stands for names that it lacks.
pub(super) fn runs(source: &IncludedText, found: &Completed, defines: &[(String, String)]) -> bool {
    let all: Vec<(String, String)> = defines.iter().cloned().chain(found.macros()).collect();
    let Parsed { shader: whole, mut diagnostics } = read_glsl(&found.put(&source.file), source.stage, &all);
    diagnostics.retain(|d| d.severity == Severity::Error);
    let rest = shader(source, &whole, &diagnostics, (&all, false));
    rest.is_some_and(|(rest, _)| {
        let mut own = rest.functions().filter(|(_, function)| function.definition.is_some());
        own.any(|(_, function)| !found.is_assumed(&function.name.name))
    })
}

/// The same for a module in WGSL, of which one error is told at a time. A whole one is refused unless it is `open`.
pub(super) fn module(source: &IncludedText, open: bool) -> Option<(ModuleText, LeftOut)> {
    if Written::of(&source.file) != Written::Wgsl {
        return None;
    }
    let mut left_out = LeftOut::default();
    let mut file = source.file.clone();
    for _ in 0..MOST_ROUNDS {
        let tree = Shader::parse_wgsl(&file).shader;
        if !open && tree.wgsl().is_some_and(|module| !module.entry_points.is_empty()) {
            return None;
        }
        match read_module(&file) {
            Ok(text) => return Some((text, left_out)),
            Err(ProgramError::Source(errors)) => file = left_out.without(&tree, &errors, open)?,
            Err(_) => return None,
        }
    }
    None
}
