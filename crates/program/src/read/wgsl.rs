//! WGSL, read by naga.

use naga::Module;
use naga::front::wgsl::{Frontend, ParseError};

use crate::front::{NAGA, validate_text};
use crate::{ProgramError, contain};
use base::diagnostic::{Diagnostic, Severity};
use base::text::{SourceFile, Span};
use syntax::Token;
use syntax::wgsl::tokens;

/// How deep brackets may stand in each other. The language asks for no more than 127 (WGSL, 2.4), and the reader takes
/// a part of the stack for each.
const DEPTH: usize = 127;

/// How many `else if` may follow each other: the reader takes a part of the stack for each of these as well.
const CHAIN: usize = 500;

/// Reads and validates a text.
pub(super) fn read(file: &SourceFile) -> Result<Module, ProgramError> {
    let text = file.text();
    let all = tokens(text);
    if let Some(span) = too_deep(text, &all) {
        let message = format!("brackets stand more than {DEPTH} deep in each other");
        return Err(wrong(file, span, message, "take the expression apart with `let`"));
    }
    if let Some(span) = long_chain(text, &all) {
        let message = format!("more than {CHAIN} `else if` follow each other");
        return Err(wrong(file, span, message, "use `switch`, or functions that return early"));
    }
    if all.is_empty() {
        return Err(wrong(file, Span::at(0), "the text has no declaration".to_owned(), "write a function"));
    }
    let known = without_subgroups(text, &all);
    let module = contain(|| Frontend::new().parse(known.as_deref().unwrap_or(text))).map_err(|panic| {
        let message = format!("naga's reader fails on this text: {panic}");
        wrong(file, Span::at(0), message, "the fault is the reader's; a smaller text may tell where")
    })?;
    let mut module = module.map_err(|error| ProgramError::Source(vec![refused(file, &error)]))?;
    zeroed(&mut module);
    validate_text(file, &module)?;
    Ok(module)
}

/// The text without the words that enable subgroups: naga has their functions, and refuses the words. Every other byte stays
/// in its place. None where there are no such words.
fn without_subgroups(text: &str, tokens: &[Token]) -> Option<String> {
    let word = |k: usize| tokens.get(k).map_or("", |token| &text[token.span.range()]);
    let mut out = text.to_owned();
    let mut blank = |span: Span| out.replace_range(span.range(), &" ".repeat(span.range().len()));
    let mut any = false;
    for start in (0..tokens.len()).filter(|&k| word(k) == "enable" && (k == 0 || word(k - 1) == ";")) {
        let Some(end) = (start..tokens.len()).find(|&k| word(k) == ";") else { break };
        let names: Vec<usize> = (start + 1..end).filter(|&k| word(k) != ",").collect();
        let Some(&at) = names.iter().find(|&&k| word(k) == "subgroups") else { continue };
        any = true;
        match names.len() {
            1 => blank(Span::new(tokens[start].span.start, tokens[end].span.end)),
            // With the comma behind it, or the one before where it is the last.
            _ if word(at + 1) == "," => blank(Span::new(tokens[at].span.start, tokens[at + 1].span.end)),
            _ => blank(Span::new(tokens[at - 1].span.start, tokens[at].span.end)),
        }
    }
    any.then_some(out)
}

fn wrong(file: &SourceFile, span: Span, message: String, help: &str) -> ProgramError {
    ProgramError::Source(vec![Diagnostic::new(NAGA, Severity::Error, file, span, message).with_help(help)])
}

/// The first bracket that stands too deep.
fn too_deep(text: &str, tokens: &[Token]) -> Option<Span> {
    let mut depth = 0_usize;
    tokens.iter().find_map(|token| {
        match &text[token.span.range()] {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        (depth > DEPTH).then_some(token.span)
    })
}

/// The first `else` of a chain that is too long.
fn long_chain(text: &str, tokens: &[Token]) -> Option<Span> {
    // For each bracket that is open, the length of the chain in it.
    let mut chains = vec![0_usize];
    let word = |k: usize| tokens.get(k).map_or("", |token| &text[token.span.range()]);
    (0..tokens.len()).find_map(|k| {
        match word(k) {
            "(" | "[" | "{" => chains.push(0),
            ")" | "]" => {
                chains.pop();
            }
            "}" => {
                chains.pop();
                if let Some(chain) = chains.last_mut().filter(|_| word(k + 1) != "else") {
                    *chain = 0;
                }
            }
            "else" if word(k + 1) == "if" => {
                let chain = chains.last_mut()?;
                *chain += 1;
                return (*chain > CHAIN).then_some(tokens[k].span);
            }
            _ => {}
        }
        None
    })
}

/// A span of naga in the text.
pub(super) fn span_in(file: &SourceFile, span: naga::Span) -> Option<Span> {
    let range = span.to_range()?;
    (range.end <= file.text().len()).then(|| Span::new(range.start, range.end))
}

/// An error of naga's reader.
fn refused(file: &SourceFile, error: &ParseError) -> Diagnostic {
    let mut labels = error.labels().filter_map(|(span, label)| Some((span_in(file, span)?, label)));
    let (span, label) = labels.next().unwrap_or((Span::at(0), ""));
    let mut found = Diagnostic::new(NAGA, Severity::Error, file, span, error.message().to_owned());
    if !label.is_empty() {
        found = found.with_label(label.to_owned());
    }
    for (span, label) in labels {
        found = found.with_related(file, span, label.to_owned());
    }
    for note in error.notes() {
        found = found.with_why(note.to_owned());
    }
    syntax::other_language(file, syntax::Looks::Wgsl).unwrap_or(found)
}

/// How refusals begin that every version of the language makes: no later one gives such a text a meaning.
const CERTAIN: [&str; 19] = [
    "redefinition of `",
    "declaration of `",
    "the type of `",
    "name `",
    "invalid field accessor `",
    "local declaration cannot be called",
    "entry point cannot be called",
    "function does not return any value",
    "atomic variables cannot be accessed directly",
    "atomic operation is done on a pointer to a non-atomic",
    "cannot take the address of a vector component",
    "the operand of the `*` operator must be a pointer",
    "workgroup size is missing",
    "repeated attribute",
    "A break if is only allowed",
    "type mismatch for reject and accept values",
    "matrix scalar type must be floating-point",
    "struct member alignment must be",
    "unterminated block comment",
];

/// True for a refusal of naga's parser that is no matter of its age: the text has a fault in every version of WGSL.
pub fn holds_in_any_version(refused: &Diagnostic) -> bool {
    let message = refused.message.to_string();
    // Components on the left may be allowed one day, a value that is never a variable will not be.
    let unchanging = message == "invalid left-hand side of assignment" && !refused.related.is_empty();
    refused.code == NAGA && (unchanging || CERTAIN.iter().any(|start| message.starts_with(start)))
}

/// Variables without a value begin as zero (WGSL, 7.2).
fn zeroed(module: &mut Module) {
    let Module { global_variables, global_expressions, functions, entry_points, .. } = module;
    for (_, variable) in global_variables.iter_mut() {
        if variable.space == naga::AddressSpace::Private && variable.init.is_none() {
            let zero = naga::Expression::ZeroValue(variable.ty);
            variable.init = Some(global_expressions.append(zero, naga::Span::UNDEFINED));
        }
    }
    let points = entry_points.iter_mut().map(|point| &mut point.function);
    for function in functions.iter_mut().map(|(_, function)| function).chain(points) {
        for (_, variable) in function.local_variables.iter_mut() {
            let zero = || function.expressions.append(naga::Expression::ZeroValue(variable.ty), naga::Span::UNDEFINED);
            variable.init = Some(variable.init.unwrap_or_else(zero));
        }
    }
}
