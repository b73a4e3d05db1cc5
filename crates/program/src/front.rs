//! naga's GLSL front end and validator, contained, with their errors told about the author's text.

use naga::front::glsl;
use naga::valid::{EntryPointError, ExpressionError, FunctionError, ModuleInfo, ValidationError};
use naga::{Handle, Module, ShaderStage, SwitchValue, WithSpan};

use super::{ProgramError, contain, validator};
use crate::lower::Lowered;
use base::diagnostic::{Code, Diagnostic, Severity};
use base::text::Span;
use syntax::Stage;

/// naga's parser refuses the text.
pub const NAGA: Code = Code("E901");
/// naga's validator refuses the module.
pub const VALIDATOR: Code = Code("E902");

pub(super) fn parse(lowered: &Lowered) -> Result<(Module, ModuleInfo), ProgramError> {
    let stage = if lowered.stage == Stage::Vertex { ShaderStage::Vertex } else { ShaderStage::Compute };
    let text = &lowered.edited.text;
    let defines = lowered.defines.iter().cloned().collect();
    let options = glsl::Options { stage, defines };
    let module = contain(|| glsl::Frontend::default().parse(&options, text))
        .map_err(|panic| panicked(lowered, &panic))?
        .map_err(|errors| ProgramError::Source(errors.errors.iter().map(|e| parse_error(lowered, e)).collect()))?;
    let info = validate_lowered(lowered, &module)?;
    Ok((module, info))
}

/// Validates a module whose spans are those of the lowered text.
pub(super) fn validate_lowered(lowered: &Lowered, module: &Module) -> Result<ModuleInfo, ProgramError> {
    contain(|| validator().validate(module).map_err(Box::new))
        .map_err(|panic| panicked(lowered, &panic))?
        .map_err(|error| ProgramError::Source(vec![validation_error(lowered, module, &error)]))
}

fn panicked(lowered: &Lowered, panic: &str) -> ProgramError {
    let diagnostic = diagnostic(lowered, NAGA, None, "the translator fails on this shader".to_owned())
        .with_why(format!("naga stops with `{panic}` and does not say where"))
        .with_help(
            "simplify the constants: known causes are calls in the size of an array, and an element of a constant \
             array in another constant",
        );
    ProgramError::Source(vec![diagnostic])
}

/// A diagnostic at a span of the lowered text.
fn diagnostic(lowered: &Lowered, code: Code, span: Option<naga::Span>, message: String) -> Diagnostic {
    let place = span
        .and_then(naga::Span::to_range)
        .map(|range| lowered.edited.map.span_to_original(Span::new(range.start, range.end)));
    let told = Diagnostic::new(code, Severity::Error, &lowered.file, place.unwrap_or_default(), message);
    if place.is_some() { told } else { told.with_why("the translator does not say where") }
}

fn parse_error(lowered: &Lowered, error: &glsl::Error) -> Diagnostic {
    use glsl::ErrorKind;
    let message = match &error.kind {
        ErrorKind::EndOfFile => "the shader ends in the middle of a construct".to_owned(),
        ErrorKind::InvalidToken(found, _) => {
            format!("the translator does not understand `{}` here", token(lowered, error, found))
        }
        ErrorKind::NotImplemented(what) => format!("the translator does not implement this: {what}"),
        ErrorKind::UnknownVariable(name) => format!("the translator does not know the variable `{name}`"),
        ErrorKind::UnknownType(name) => format!("the translator does not know the type `{name}`"),
        ErrorKind::UnknownField(name) => format!("there is no field or component `{name}`"),
        ErrorKind::UnknownLayoutQualifier(name) => {
            format!("the translator does not know the layout qualifier `{name}`")
        }
        ErrorKind::UnsupportedMatrixWithTwoRowsInStd140 { columns } => {
            format!("the translator cannot express `mat{columns}x2` in a std140 block")
        }
        ErrorKind::SemanticError(text) => semantic(text),
        other => lowercase_first(&other.to_string()),
    };
    diagnostic(lowered, NAGA, Some(error.meta), message)
}

/// The sentences of naga that speak of its own data, in words about the source.
fn semantic(text: &str) -> String {
    if let Some(name) = text.strip_prefix("Unknown function '").and_then(|rest| rest.strip_suffix('\'')) {
        return format!("the translator does not know the function `{name}`");
    }
    let Some(why) = text.strip_prefix("Can't resolve type: ") else { return lowercase_first(text) };
    let index = why.strip_prefix("OutOfBoundsIndex").and_then(|rest| rest.split_once("index: "));
    match index.and_then(|(_, rest)| rest.split(|c: char| !c.is_ascii_digit()).next()) {
        Some(index) => format!("index {index} is out of bounds"),
        None => "the translator cannot give this expression a type".to_owned(),
    }
}

fn token(lowered: &Lowered, error: &glsl::Error, found: &impl std::fmt::Debug) -> String {
    let text = error.meta.to_range().and_then(|range| lowered.edited.text.get(range));
    text.map_or_else(|| format!("{found:?}"), str::to_owned)
}

fn lowercase_first(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |c| c.to_lowercase().chain(chars).collect())
}

fn validation_error(lowered: &Lowered, module: &Module, error: &WithSpan<ValidationError>) -> Diagnostic {
    let inner = error.as_inner();
    let within = match inner {
        ValidationError::Function { handle, source, .. } => Some((&module.functions[*handle], source)),
        ValidationError::EntryPoint { name, stage, source: EntryPointError::Function(source) } => {
            module.entry_points.iter().find(|e| e.name == *name && e.stage == *stage).map(|e| (&e.function, source))
        }
        _ => None,
    };
    let text_of = |function: &naga::Function, handle: Handle<naga::Expression>| {
        let range = function.expressions.get_span(handle).to_range();
        range.and_then(|r| lowered.edited.text.get(r)).unwrap_or("an expression").to_owned()
    };
    let mut span = error.spans().map(|(span, _)| *span).find(|span| span.is_defined());
    let message = match within {
        Some((function, FunctionError::InvalidStoreTypes { pointer, value })) => {
            span = Some(function.expressions.get_span(*value));
            format!("the type of `{}` is not the type of `{}`", text_of(function, *value), text_of(function, *pointer))
        }
        Some((function, FunctionError::Expression { handle, source: ExpressionError::IndexOutOfBounds(_, index) })) => {
            span = Some(function.expressions.get_span(*handle)).filter(|s| s.is_defined()).or(span);
            format!("index {index} is out of bounds")
        }
        Some((function, FunctionError::InvalidReturnType { expression, .. })) => {
            let name = function.name.as_deref().unwrap_or("main");
            match expression {
                Some(value) => {
                    format!("`{}` is not of the type that `{name}` returns", text_of(function, *value))
                }
                None => format!("`{name}` can end without returning a value"),
            }
        }
        Some((_, FunctionError::ConflictingSwitchCase(value))) => {
            let value = match value {
                SwitchValue::I32(value) => value.to_string(),
                SwitchValue::U32(value) => value.to_string(),
                SwitchValue::Default => "default".to_owned(),
            };
            format!("two cases of one `switch` have the label {value}")
        }
        Some((function, FunctionError::Expression { handle, source })) => {
            span = Some(function.expressions.get_span(*handle)).filter(|s| s.is_defined()).or(span);
            format!("`{}` is not valid: {}", text_of(function, *handle), without_handles(&source.to_string()))
        }
        Some((_, source)) => without_handles(&source.to_string()),
        None => {
            let mut text = inner.to_string();
            let mut source = std::error::Error::source(inner);
            while let Some(cause) = source {
                text = format!("{text}: {cause}");
                source = cause.source();
            }
            without_handles(&text)
        }
    };
    diagnostic(lowered, VALIDATOR, span, lowercase_first(&message))
}

/// Removes naga's arena indices (`[21]`), which mean nothing to the author.
fn without_handles(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('[') {
        let digits = rest[at + 1..].find(|c: char| !c.is_ascii_digit()).unwrap_or(0);
        let closes = rest[at + 1 + digits..].starts_with(']');
        out.push_str(rest[..at].trim_end_matches(if digits > 0 && closes { ' ' } else { '\0' }));
        if digits > 0 && closes {
            rest = &rest[at + digits + 2..];
        } else {
            out.push('[');
            rest = &rest[at + 1..];
        }
    }
    out.push_str(rest);
    out
}

#[cfg(test)]
mod tests {
    use super::without_handles;

    #[test]
    fn arena_indices_are_taken_out() {
        assert_eq!(without_handles("The type of [21] does not match [x] in [7]"), "The type of does not match [x] in");
    }
}
