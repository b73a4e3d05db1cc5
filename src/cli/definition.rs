//! Macros that are given on the command line.

/// A name and a value of the command line.
pub(super) fn definition(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').unwrap_or((text, "1"));
    let is_name = |name: &str| !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_');
    // A macro may have parameters: `load(buffer,at)=buffer[at]`.
    let (head, params) = name.strip_suffix(')').and_then(|name| name.split_once('(')).unwrap_or((name, ""));
    let named = is_name(head) && (params.is_empty() || params.split(',').all(|param| is_name(param.trim())));
    if named { Ok((name.to_owned(), value.to_owned())) } else { Err("give NAME=VALUE".to_owned()) }
}
