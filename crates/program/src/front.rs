//! naga's validator, contained, with its errors told about the author's text.

use naga::valid::{
    CallError, EntryPointError, ExpressionError, FunctionError, ModuleInfo, ValidationError, VaryingError,
};
use naga::{Block, BuiltIn, Handle, Module, Statement, SwitchValue, WithSpan};

use super::{ProgramError, contain, validator};
use base::diagnostic::{Code, Diagnostic, Severity};
use base::text::{SourceFile, Span};

/// A construct that the harness or the translator cannot express.
pub const UNSUPPORTED: Code = Code("E801");
/// The shader lacks something that running it needs.
pub const INCOMPLETE: Code = Code("E802");
/// naga's parser of WGSL refuses the text.
pub const NAGA: Code = Code("E901");
/// The compiler of a text in HLSL or Slang refuses it.
pub const COMPILER: Code = Code("E903");
/// naga's validator refuses the module.
pub const VALIDATOR: Code = Code("E902");

/// Validates a module whose spans are those of a text.
///
/// # Errors
/// [`ProgramError::Source`] with the validator's reason at its place.
pub(super) fn validate_text(file: &SourceFile, module: &Module) -> Result<ModuleInfo, ProgramError> {
    contain(|| validator().validate(module).map_err(Box::new))
        .map_err(|panic| ProgramError::internal(format!("naga panicked: {panic}")))?
        .map_err(|error| ProgramError::Source(vec![validation_error(file, module, &error)]))
}

fn diagnostic(file: &SourceFile, span: Option<naga::Span>, message: String) -> Diagnostic {
    let place = span.and_then(naga::Span::to_range).map(|range| Span::new(range.start, range.end));
    let diagnostic = Diagnostic::new(VALIDATOR, Severity::Error, file, place.unwrap_or_default(), message);
    if place.is_some() { diagnostic } else { diagnostic.with_why("the validator does not say where") }
}

fn lowercase_first(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |c| c.to_lowercase().chain(chars).collect())
}

fn validation_error(file: &SourceFile, module: &Module, error: &WithSpan<ValidationError>) -> Diagnostic {
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
        range.and_then(|r| file.text().get(r)).unwrap_or("an expression").to_owned()
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
                Some(value) if function.result.is_none() => {
                    span = Some(function.expressions.get_span(*value)).filter(|s| s.is_defined()).or(span);
                    format!("`{name}` returns a value, and none is declared for it")
                }
                Some(value) => {
                    span = Some(function.expressions.get_span(*value)).filter(|s| s.is_defined()).or(span);
                    format!("`{}` is not of the type that `{name}` returns", text_of(function, *value))
                }
                None => format!("`{name}` can end without returning a value"),
            }
        }
        Some((function, FunctionError::InvalidCall { function: called, error })) => {
            let name = module.functions[*called].name.as_deref().unwrap_or("the function");
            span = call(&function.body, *called).or(span);
            match error {
                CallError::ArgumentCount { required, seen } => {
                    format!("`{name}` takes {required} arguments, and {seen} are given")
                }
                CallError::ArgumentType { index, seen_expression, .. } => {
                    let own = function.expressions.get_span(*seen_expression);
                    span = Some(own).filter(|s| s.is_defined()).or(span);
                    let argument = text_of(function, *seen_expression);
                    format!("argument {} of `{name}` is `{argument}`, which is of another type", index + 1)
                }
                other => format!("the call of `{name}` is not valid: {}", without_handles(&other.to_string())),
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
    // An entry point has its name where its function is; the module keeps no place of it.
    let name = match inner {
        ValidationError::EntryPoint { name, .. } => Some(name.as_str()),
        _ => within.and_then(|(function, _)| function.name.as_deref()),
    };
    let span = span.filter(|span| span.is_defined()).or_else(|| name.and_then(|name| declared(file.text(), name)));
    let found = diagnostic(file, span, lowercase_first(&message));
    if is_of_an_extension(inner) { Diagnostic { code: UNSUPPORTED, ..found } } else { found }
}

/// The name of a function where a text in WGSL declares it.
fn declared(text: &str, name: &str) -> Option<naga::Span> {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    let (at, _) = text.match_indices(name).find(|(at, _)| {
        let before = text[..*at].trim_end();
        before.len() < *at
            && before.strip_suffix("fn").is_some_and(|rest| !rest.ends_with(part))
            && !text[at + name.len()..].starts_with(part)
    })?;
    Some(naga::Span::new(u32::try_from(at).ok()?, u32::try_from(at + name.len()).ok()?))
}

/// True for what is WGSL and not read by naga, or the type of a built-in value that WGSL does not have: both differ between
/// versions of the readers.
fn is_of_an_extension(error: &ValidationError) -> bool {
    // Pointers to buffers and storage textures as parameters, which the language has (`unrestricted_pointer_parameters`).
    if let ValidationError::Function { source, .. } = error {
        return matches!(
            source,
            FunctionError::InvalidArgumentPointerSpace { .. }
                | FunctionError::InvalidImageStore(ExpressionError::ExpectedGlobalVariable)
        );
    }
    let ValidationError::EntryPoint {
        source: EntryPointError::Argument(_, varying) | EntryPointError::Result(varying),
        ..
    } = error
    else {
        return false;
    };
    matches!(varying, VaryingError::InvalidBuiltInType(BuiltIn::ViewIndex, _))
}

/// The place of the first call of a function.
fn call(body: &Block, called: Handle<naga::Function>) -> Option<naga::Span> {
    body.span_iter().find_map(|(statement, span)| match statement {
        Statement::Call { function, .. } if *function == called => Some(*span).filter(|s| s.is_defined()),
        Statement::Block(block) => call(block, called),
        Statement::If { accept, reject, .. } => call(accept, called).or_else(|| call(reject, called)),
        Statement::Switch { cases, .. } => cases.iter().find_map(|case| call(&case.body, called)),
        Statement::Loop { body, continuing, .. } => call(body, called).or_else(|| call(continuing, called)),
        _ => None,
    })
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
    spelled(&out)
}

/// Types as WGSL spells them, in place of how naga prints its own.
fn spelled(text: &str) -> String {
    const SCALARS: [(&str, u8, &str); 10] = [
        ("Bool", 1, "bool"),
        ("Sint", 4, "i32"),
        ("Uint", 4, "u32"),
        ("Float", 4, "f32"),
        ("Float", 2, "f16"),
        ("Float", 8, "f64"),
        ("Sint", 8, "i64"),
        ("Uint", 8, "u64"),
        ("AbstractInt", 8, "AbstractInt"),
        ("AbstractFloat", 8, "AbstractFloat"),
    ];
    const SIZES: [(&str, u8); 3] = [("Bi", 2), ("Tri", 3), ("Quad", 4)];
    let mut out = text.to_owned();
    for (kind, width, name) in SCALARS {
        let scalar = format!("Scalar {{ kind: {kind}, width: {width} }}");
        if !out.contains(&scalar) {
            continue;
        }
        out = out.replace(&format!("Scalar({scalar})"), &format!("`{name}`"));
        for (size, n) in SIZES {
            out = out.replace(&format!("Vector {{ size: {size}, scalar: {scalar} }}"), &format!("`vec{n}<{name}>`"));
            for (columns, c) in SIZES {
                let matrix = format!("Matrix {{ columns: {columns}, rows: {size}, scalar: {scalar} }}");
                out = out.replace(&matrix, &format!("`mat{c}x{n}<{name}>`"));
            }
        }
    }
    if out == text { out } else { out.replace("(of type `", "`").replace("`)", "`") }
}

#[cfg(test)]
mod tests {
    use super::{UNSUPPORTED, VALIDATOR, without_handles};
    use crate::{ModuleText, ProgramError, Written};
    use base::text::SourceFile;

    fn refused(text: &str) -> Vec<(&'static str, String)> {
        match ModuleText::read(&SourceFile::new("a.wgsl", text), Written::Wgsl) {
            Err(ProgramError::Source(found)) => found.iter().map(|d| (d.code.0, d.message.to_string())).collect(),
            _ => Vec::new(),
        }
    }

    #[test]
    fn types_are_spelled_as_the_author_does() {
        let told = refused("fn f(a: vec2<i32>, b: vec2<u32>) -> vec2<bool> { return a < b; }\n");
        let [(code, message)] = told.as_slice() else { panic!("{told:?}") };
        assert_eq!(*code, VALIDATOR.0);
        assert!(message.ends_with("Operation Less can't work with `vec2<i32>` and `vec2<u32>`"), "{message}");
    }

    #[test]
    fn the_type_of_a_built_in_value_of_an_extension_is_no_fault() {
        let entry = |name: &str, ty: &str| {
            let head = format!("@fragment fn main(@builtin({name}) it: {ty})");
            refused(&format!("{head} -> @location(0) vec4<f32> {{ return vec4<f32>(f32(it)); }}\n"))
        };
        assert!(entry("view_index", "u32").is_empty());
        assert!(entry("view_index", "i32").iter().all(|(code, _)| *code == UNSUPPORTED.0));
        assert!(entry("sample_index", "i32").iter().any(|(code, _)| *code == VALIDATOR.0));
    }

    #[test]
    fn what_is_wrong_with_a_function_as_a_whole_is_told_at_its_name() {
        let text = "// main\nfn domain() { }\n@fragment fn main() -> @location(0) vec4<f32> { domain(); }\n";
        let Err(ProgramError::Source(found)) = ModuleText::read(&SourceFile::new("a.wgsl", text), Written::Wgsl) else {
            panic!("it is refused")
        };
        assert_eq!(found[0].file.locate(found[0].span.start), "a.wgsl:3:14");
        assert!(found[0].why.is_none(), "{:?}", found[0]);
    }

    #[test]
    fn arena_indices_are_taken_out() {
        assert_eq!(without_handles("The type of [21] does not match [x] in [7]"), "The type of does not match [x] in");
    }
}
