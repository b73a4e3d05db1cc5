//! Semantic tokens: what names mean, and which text the preprocessor leaves out.

use base::text::Span;
use ls_types::{SemanticToken, SemanticTokenModifier, SemanticTokenType, SemanticTokensLegend};
use syntax::TokenPlace;
use syntax::ast::{Callee, ExprKind};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, SymbolKind};

use crate::occurrences::Meaning;
use crate::unit::Unit;
use crate::workspace::Workspace;

const TYPES: [SemanticTokenType; 7] = [
    SemanticTokenType::FUNCTION,
    SemanticTokenType::VARIABLE,
    SemanticTokenType::PARAMETER,
    SemanticTokenType::PROPERTY,
    SemanticTokenType::STRUCT,
    SemanticTokenType::MACRO,
    SemanticTokenType::COMMENT,
];
const FUNCTION: u32 = 0;
const VARIABLE: u32 = 1;
const PARAMETER: u32 = 2;
const PROPERTY: u32 = 3;
const STRUCT: u32 = 4;
const MACRO: u32 = 5;
/// Text that the preprocessor leaves out: editors dim comments.
const COMMENT: u32 = 6;

const MODIFIERS: [SemanticTokenModifier; 4] = [
    SemanticTokenModifier::DECLARATION,
    SemanticTokenModifier::READONLY,
    SemanticTokenModifier::STATIC,
    SemanticTokenModifier::DEFAULT_LIBRARY,
];
const DECLARATION: u32 = 1;
const READONLY: u32 = 2;
/// What stages and hosts share.
const STATIC: u32 = 4;
const DEFAULT_LIBRARY: u32 = 8;

/// The kinds of tokens.
pub fn legend() -> SemanticTokensLegend {
    SemanticTokensLegend { token_types: TYPES.to_vec(), token_modifiers: MODIFIERS.to_vec() }
}

impl Workspace {
    /// The tokens of a file, or of its lines in a range of bytes.
    pub fn semantic_tokens(&self, name: &str, within: Option<Span>) -> Vec<SemanticToken> {
        let Some(file) = self.file(name) else { return Vec::new() };
        let mut all: Vec<(Span, u32, u32)> = Vec::new();
        for unit in self.own_units(name) {
            let own = of_unit(&unit).into_iter();
            all.extend(own.filter_map(|(span, kind, bits)| Some((unit.place_in(name, span)?, kind, bits))));
        }
        all.retain(|(span, _, _)| !span.is_empty() && within.is_none_or(|w| w.touches(*span)));
        all.sort();
        all.dedup_by_key(|(span, _, _)| span.start);
        let (mut line, mut column) = (0, 0);
        let mut tokens = Vec::with_capacity(all.len());
        for (span, token_type, token_modifiers_bitset) in all {
            let at = self.encoding.position(file, span.start);
            let delta_line = at.line - line;
            let delta_start = if delta_line == 0 { at.character.saturating_sub(column) } else { at.character };
            let length = self.encoding.length(file.slice(span));
            tokens.push(SemanticToken { delta_line, delta_start, length, token_type, token_modifiers_bitset });
            (line, column) = (at.line, at.character);
        }
        tokens
    }
}

fn of_unit(unit: &Unit) -> Vec<(Span, u32, u32)> {
    let shader = &unit.shader;
    let mut found = Vec::new();
    for o in unit.occurrences() {
        let declaration = if o.declares { DECLARATION } else { 0 };
        let (kind, bits) = match &o.meaning {
            Meaning::Symbol(id) => {
                let symbol = shader.symbol(*id);
                let read_only = if symbol.read_only { READONLY } else { 0 };
                match symbol.kind {
                    SymbolKind::Builtin => (VARIABLE, DEFAULT_LIBRARY | read_only),
                    SymbolKind::Param(_) => (PARAMETER, read_only),
                    SymbolKind::BlockMember(_) => (PROPERTY, read_only | STATIC),
                    SymbolKind::Global(Storage::Global | Storage::Const) | SymbolKind::Local => (VARIABLE, read_only),
                    SymbolKind::Global(_) | SymbolKind::BlockInstance(_) => (VARIABLE, read_only | STATIC),
                }
            }
            Meaning::Function(_) => (FUNCTION, 0),
            Meaning::Member(..) => (PROPERTY, 0),
            Meaning::Struct(_) | Meaning::Block(_) => (STRUCT, 0),
        };
        found.push((o.span, kind, bits | declaration));
    }
    for (id, expr) in shader.arena().iter().filter(|(_, e)| !e.from_macro) {
        if let (ExprKind::Call { callee: Callee::Name(name), args: _ }, Some(CallTarget::Builtin(_))) =
            (&expr.kind, shader.callee(id))
        {
            found.push((name.span, FUNCTION, DEFAULT_LIBRARY));
        }
    }
    for token in shader.tokens() {
        if token.place == TokenPlace::Inactive {
            found.push((token.span, COMMENT, 0));
        } else if shader.file().expansion(token.span).is_some() {
            found.push((token.span, MACRO, 0));
        }
    }
    found
}
