//! Which text a module of a host is made of.

use base::text::Span;

use super::layout::argument_of;
use super::value::{Value, Values};
use crate::script::code::Call;
use crate::script::language::Language;
use crate::script::token::Token;

/// The text of a module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// A file.
    File(String),
    /// A string that begins here.
    String(Span),
}

/// Methods that make a module of a descriptor.
const MAKERS: &[&str] =
    &["create_shader_module", "create_shader_module_unchecked", "create_shader_module_trusted", "createShaderModule"];

/// The text of the module that a value comes to.
pub fn source(values: &Values<'_, '_>, module: &Value) -> Option<Source> {
    let descriptor = argument_of(values, module, MAKERS)?;
    descriptor_source(values, &descriptor)
}

/// True for the name of a method that makes modules.
pub fn is_maker(name: &str) -> bool {
    MAKERS.contains(&name)
}

fn descriptor_source(values: &Values<'_, '_>, descriptor: &Value) -> Option<Source> {
    let code = values.code;
    let descriptor = values.resolve(descriptor)?;
    let range = &descriptor.tokens;
    // `wgpu::include_wgsl!("file.wgsl")`
    if let Some(at) = range.clone().find(|at| code.word(*at) == Some("include_wgsl"))
        && code.is_mark(at + 1, '!')
        && code.other(at + 2) == Some(range.end - 1)
    {
        let (name, _) = code.string(&(at + 3..range.end - 1))?;
        return Some(Source::File(name.to_owned()));
    }
    if code.language != Language::Rust {
        let text = values.field(&descriptor, "code").value()?;
        return self::text(values, &text);
    }
    let source = values.resolve(&values.field(&descriptor, "source").value()?)?;
    let call = values.call(&source.tokens)?;
    let is_wgsl = code.word(call.name) == Some("Wgsl");
    let [only] = code.elements(call.open).try_into().ok().filter(|_| is_wgsl)?;
    text(values, &Value { tokens: only, frame: source.frame })
}

/// The text that an expression is.
fn text(values: &Values<'_, '_>, value: &Value) -> Option<Source> {
    let code = values.code;
    let Some(value) = values.resolve(value) else { return imported(values, value) };
    let range = value.tokens.clone();
    if let Some(Token::String { place, .. }) = code.tokens.get(range.start)
        && range.len() == 1
    {
        return Some(Source::String(*place));
    }
    if let Some(path) = loaded(values, &value) {
        return Some(Source::File(path));
    }
    let at = range.clone().find(|at| code.word(*at) == Some("include_str"))?;
    let whole = at == range.start && code.is_mark(at + 1, '!') && code.other(at + 2) == Some(range.end - 1);
    let (name, _) = code.string(&(at + 3..range.end - 1)).filter(|_| whole)?;
    Some(Source::File(name.to_owned()))
}

/// The file whose text a call gives: `fetch(path).then(r => r.text())`, `(await fetch(path)).text()`,
/// `fs::read_to_string(path)`.
fn loaded(values: &Values<'_, '_>, value: &Value) -> Option<String> {
    let code = values.code;
    let call = values.call(&value.tokens)?;
    let first = |call: Call, value: &Value| {
        let tokens = code.elements(call.open).into_iter().next()?;
        Some(Value { tokens, frame: value.frame.clone() })
    };
    let path = match code.word(call.name)? {
        "read_to_string" => first(call, value)?,
        word @ ("then" | "text") => {
            let gives_text = |given: Value| {
                let mut all = given.tokens;
                all.any(|at| code.is_mark(at, '.') && code.word(at + 1) == Some("text") && code.is_mark(at + 2, '('))
            };
            (word == "text" || first(call, value).is_some_and(gives_text)).then_some(())?;
            let receiver = Value { tokens: value.tokens.start..call.name.checked_sub(1)?, frame: value.frame.clone() };
            let response = values.resolve(&receiver)?;
            let fetch = values.call(&response.tokens).filter(|c| code.word(c.name) == Some("fetch"))?;
            first(fetch, &response)?
        }
        _ => return None,
    };
    let mut path = values.resolve(&path)?;
    if let Some(url) = values.call(&path.tokens).filter(|c| code.word(c.name) == Some("URL")) {
        path = values.resolve(&first(url, &path)?)?;
    }
    let (name, _) = code.string(&path.tokens).filter(|(name, _)| !name.contains(['$', '{']))?;
    let name = name.split('?').next().unwrap_or(name);
    name.ends_with(".wgsl").then(|| name.to_owned())
}

/// The file that a name of JavaScript is imported from.
fn imported(values: &Values<'_, '_>, value: &Value) -> Option<Source> {
    let code = values.code;
    let name = code.word(value.tokens.start).filter(|_| value.tokens.len() == 1)?;
    let mut found = (0..code.tokens.len()).filter(|at| {
        code.word(*at) == Some("import") && code.word(at + 1) == Some(name) && code.word(at + 2) == Some("from")
    });
    let at = found.next().filter(|_| found.next().is_none())?;
    let (path, _) = code.string(&(at + 3..at + 4))?;
    let path = path.split('?').next().unwrap_or(path);
    path.ends_with(".wgsl").then(|| Source::File(path.to_owned()))
}
