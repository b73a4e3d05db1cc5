//! What the rules about compile errors share: the expression that an error is about, and text around it.

use base::diagnostic::{Diagnostic, Message};
use base::text::Span;
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::{SymbolId, SymbolKind};
use syntax::types::Type;

use super::walk::declarators;

/// The widest expression with exactly this place.
pub(super) fn expression_at(shader: &Shader, span: Span) -> Option<ExprId> {
    shader.arena().iter().filter(|(_, e)| e.span == span && !e.from_macro).map(|(id, _)| id).last()
}

/// Type of the variable or target that takes this value as it is.
pub(super) fn destination(shader: &Shader, value: ExprId) -> Option<Type> {
    for (_, expr) in shader.arena().iter() {
        if let ExprKind::Assign { op: None, op_span: _, target, value: assigned } = &expr.kind
            && *assigned == value
        {
            return Some(shader.type_of(*target).clone());
        }
    }
    let mut found = None;
    declarators(shader, |declarator| {
        if declarator.initializer.as_ref().is_some_and(|i| i.value == value) {
            let symbol = shader.symbols().find(|(_, s)| s.span == Some(declarator.name.span));
            found = symbol.map(|(_, s)| s.ty.clone());
        }
    });
    found
}

/// The last component that a value of three components gets: 0 for what is called a direction, else 1.
pub(super) fn fourth(shader: &Shader, value: ExprId) -> &'static str {
    let text = shader.text_of(value).to_lowercase();
    if ["normal", "direction", "dir", "tangent"].iter().any(|w| text.contains(w)) { "0.0" } else { "1.0" }
}

/// True when some token of the text is this word.
pub(super) fn is_word(shader: &Shader, word: &str) -> bool {
    shader.tokens().iter().any(|t| shader.file().slice(t.span) == word)
}

/// A name made of `name` that no token has.
pub(super) fn fresh(shader: &Shader, name: &str) -> String {
    let mut new = format!("{name}_");
    while is_word(shader, &new) || new.contains("__") {
        new = format!("{}x", new.replace("__", "_"));
    }
    new
}

/// True for variables that only this text knows: renaming them changes nothing outside.
pub(super) fn is_private(shader: &Shader, symbol: SymbolId) -> bool {
    use syntax::interface::Storage;
    matches!(
        shader.symbol(symbol).kind,
        SymbolKind::Local | SymbolKind::Param(_) | SymbolKind::Global(Storage::Const | Storage::Global)
    )
}

/// Where a line may be inserted behind `#version` and `#extension`.
pub(super) fn behind_directives(file: &ShaderFile) -> usize {
    let text = file.file.text();
    let ends = file
        .shader
        .extensions()
        .iter()
        .filter(|e| !e.span.is_empty())
        .map(|e| e.span.end)
        .chain(file.shader.version().span.map(|s| s.end));
    let Some(end) = ends.max() else { return 0 };
    text[end..].find('\n').map_or(text.len(), |n| end + n + 1)
}

/// Adds a reason where the front end gave none.
pub(super) fn explained(mut diagnostic: Diagnostic, why: Message, help: Message) -> Diagnostic {
    diagnostic.why.get_or_insert(why);
    if diagnostic.fix.is_none() {
        diagnostic.help.get_or_insert(help);
    }
    diagnostic
}
