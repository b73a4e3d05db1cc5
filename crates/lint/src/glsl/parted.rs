//! What rules about uniform control flow share.

use base::diagnostic::{Diagnostic, message};
use syntax::ast::ExprId;

use reading::ShaderFile;

/// A finding about a call, with the condition at which invocations part.
pub fn with_condition(found: Diagnostic, file: &ShaderFile, by: ExprId) -> Diagnostic {
    let at = file.shader.expr(by).span;
    found.with_label(message!("not in uniform control flow", "一様でない制御フロー")).with_related(
        &file.file,
        at,
        message!("not the same for all invocations", "インベケーションごとに異なる"),
    )
}
