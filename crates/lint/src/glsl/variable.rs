//! What rules on variables share.

use base::diagnostic::Safety;
use base::diagnostic::{Diagnostic, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::Declarator;
use syntax::symbols::{SymbolId, SymbolKind};
use syntax::types::{ScalarType, Type};

use super::walk::declarators;

/// The declarator of a variable that is declared outside parameters, structures and blocks; none when a
/// macro wrote it.
pub fn declarator(file: &ShaderFile, symbol: SymbolId) -> Option<&Declarator> {
    let span = file.shader.symbol(symbol).span?;
    let mut found = None;
    declarators(&file.shader, |d| {
        if d.name.span == span && file.file.slice(span) == d.name.name {
            found = Some(d);
        }
    });
    found
}

/// Zero of a type, as text; none for structures, arrays and opaque types.
pub fn zero(ty: &Type) -> Option<String> {
    let scalar = match ty.scalar()? {
        ScalarType::Bool => "false",
        ScalarType::Int => "0",
        ScalarType::Uint => "0u",
        ScalarType::Float | ScalarType::Double => "0.0",
        sized => return Some(format!("{ty}({})", if sized == ScalarType::Half { "0.0" } else { "0" })),
    };
    Some(if ty.is_scalar() { scalar.to_owned() } else { format!("{ty}({scalar})") })
}

/// Adds the fix that gives a local variable the value zero where it is declared, when that can be.
pub fn with_zero(found: Diagnostic, file: &ShaderFile, symbol: SymbolId) -> Diagnostic {
    let info = file.shader.symbol(symbol);
    let declarator = declarator(file, symbol).filter(|d| d.initializer.is_none() && info.kind == SymbolKind::Local);
    let (Some(declarator), Some(zero)) = (declarator, zero(&info.ty)) else { return found };
    let title = message!("initialise with `{zero}`", "`{zero}` で初期化する");
    let edit = Edit::insert(declarator.span.end, format!(" = {zero}"));
    found.with_fix(title, Safety::Unsafe, vec![edit])
}

/// The variable, with the letters of the components that a mask has when these are not all.
pub fn part(shader: &Shader, symbol: SymbolId, mask: u64) -> String {
    let info = shader.symbol(symbol);
    match analysis::flow::letters(&info.ty, mask) {
        Some(letters) if Some(letters.len()) != info.ty.components() => format!("{}.{letters}", info.name),
        _ => info.name.clone(),
    }
}
