//! Errors of the grammar that no host mends.

use base::diagnostic::Diagnostic;
use syntax::ast::ItemKind;
use syntax::types::Type;
use syntax::{BuiltinFunction, Shader, Token, TokenKind, TokenPlace, errors};

/// True for an error of the grammar in a statement of which every word is known: no macro of a host stands there, and the
/// function around it is read to its end, so that nothing is cut off.
pub(crate) fn is_plain(shader: &Shader, error: &Diagnostic) -> bool {
    let file = shader.file();
    let at = error.span.start;
    let inside = |item: &syntax::ast::Item| {
        let whole = matches!(&item.kind, ItemKind::Function(function) if function.body.is_some());
        whole && item.span.contains(at)
    };
    if error.code != errors::SYNTAX || error.file != *file || !shader.unit().items.iter().any(inside) {
        return false;
    }
    let tokens = shader.tokens();
    let end = tokens.partition_point(|token| token.span.start <= at);
    let ends = |token: &&Token| [";", "{", "}"].contains(&file.slice(token.span));
    let statement = tokens[..end.saturating_sub(1)].iter().rev().take_while(|token| !ends(token));
    let known = |token: &Token| {
        let word = file.slice(token.span);
        let declared = || shader.symbols().any(|(_, symbol)| symbol.name == word);
        let named = || shader.functions().any(|(_, function)| function.name.name == word);
        token.place == TokenPlace::Text
            && !shader.defines().iter().any(|(name, _)| name == word)
            && (token.kind != TokenKind::Word
                || syntax::is_keyword(word)
                || BuiltinFunction::from_name(word).is_some()
                || Type::from_name(word).is_some()
                || declared()
                || named())
    };
    // Words that became keywords late are names in other versions.
    let late = |token: &Token| syntax::is_late_keyword(file.slice(token.span));
    // What is missing is told behind the word before: the one that stands there counts as well.
    let own = tokens[end.saturating_sub(1)..].iter().take(2);
    own.chain(statement).all(|token| known(token) && !late(token))
}
