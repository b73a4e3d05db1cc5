//! What can be run of a piece in which some functions do not compile: the others. A whole shader is refused.

use super::includes::{IncludedText, read_glsl};
use base::diagnostic::{Diagnostic, Severity};
use base::text::{Assembly, SourceFile, Span};
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

    /// The text without the functions in which errors stand; none where one stands elsewhere.
    fn without(&mut self, shader: &Shader, errors: &[Diagnostic]) -> Option<SourceFile> {
        let file = shader.file();
        let functions = shader.unit().items.iter().filter_map(|item| match &item.kind {
            ItemKind::Function(function) if function.body.is_some() => Some((function.name.name.as_str(), item.span)),
            _ => None,
        });
        let functions: Vec<(&str, Span)> = functions.collect();
        let mut broken = Vec::new();
        for error in errors {
            let at = functions.iter().position(|(_, span)| error.file == *file && span.contains(error.span.start))?;
            if !broken.contains(&at) {
                broken.push(at);
                self.0.push((functions[at].0.to_owned(), error.clone()));
            }
        }
        let mut assembly = Assembly::new();
        let mut from = 0;
        for (k, (_, span)) in functions.iter().enumerate() {
            if broken.contains(&k) {
                assembly.copy(file, Span::new(from, span.start));
                from = span.end;
            }
        }
        assembly.copy(file, Span::new(from, file.text().len()));
        (!broken.is_empty()).then(|| assembly.finish(file.name()))
    }
}

/// The rest of a piece in GLSL whose errors all stand in functions.
pub(super) fn shader(
    source: &IncludedText,
    shader: Shader,
    errors: &[Diagnostic],
    defines: &[(String, String)],
) -> Option<(Shader, LeftOut)> {
    // A whole shader that does not compile is refused.
    if shader.function("main").is_some() {
        return None;
    }
    let mut left_out = LeftOut::default();
    let mut rest = left_out.without(&shader, errors)?;
    for _ in 0..MOST_ROUNDS {
        let Parsed { shader, mut diagnostics } = read_glsl(&rest, source.stage, defines);
        diagnostics.retain(|d| d.severity == Severity::Error && d.code != errors::MISSING_MAIN);
        if diagnostics.is_empty() {
            return Some((shader, left_out));
        }
        rest = left_out.without(&shader, &diagnostics)?;
    }
    None
}

/// The same for a module in WGSL, of which one error is told at a time.
pub(super) fn module(source: &IncludedText) -> Option<(ModuleText, LeftOut)> {
    if Written::of(&source.file) != Written::Wgsl {
        return None;
    }
    let mut left_out = LeftOut::default();
    let mut file = source.file.clone();
    for _ in 0..MOST_ROUNDS {
        let tree = Shader::parse_wgsl(&file).shader;
        if tree.wgsl().is_some_and(|module| !module.entry_points.is_empty()) {
            return None;
        }
        match read_module(&file) {
            Ok(text) => return Some((text, left_out)),
            Err(ProgramError::Source(errors)) => file = left_out.without(&tree, &errors)?,
            Err(_) => return None,
        }
    }
    None
}
