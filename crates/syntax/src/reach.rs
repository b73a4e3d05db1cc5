//! What one function needs of a shader: the functions that it can call, and the variables that these use.

use std::collections::BTreeSet;

use super::Shader;
use super::symbols::{CallTarget, FunctionId, SymbolId};
use base::text::Span;

impl Shader {
    /// The functions that can be called from `root`, itself included, and those that initialisers at file
    /// scope call.
    pub fn reachable(&self, root: FunctionId) -> Vec<FunctionId> {
        let body = |f: FunctionId| Some(self.function_syntax(self.function_info(f))?.body.as_ref()?.span);
        let calls: Vec<(Span, FunctionId)> = self
            .arena()
            .iter()
            .filter_map(|(id, e)| match self.callee(id) {
                Some(CallTarget::User(f)) => Some((e.span, *f)),
                Some(CallTarget::Builtin(_) | CallTarget::Constructor(_)) | None => None,
            })
            .collect();
        let bodies: Vec<Span> = self.functions().filter_map(|(f, _)| body(f)).collect();
        let mut found = vec![root];
        for &(_, callee) in calls.iter().filter(|(s, _)| !bodies.iter().any(|b| b.contains(s.start))) {
            if !found.contains(&callee) {
                found.push(callee);
            }
        }
        let mut at = 0;
        while let Some(&function) = found.get(at) {
            if let Some(body) = body(function) {
                for &(span, callee) in &calls {
                    if body.contains(span.start) && !found.contains(&callee) {
                        found.push(callee);
                    }
                }
            }
            at += 1;
        }
        found
    }

    /// Variables that these functions use, and those that initialisers at file scope use.
    pub fn used_by(&self, functions: &[FunctionId]) -> BTreeSet<SymbolId> {
        let counts = |function: Option<FunctionId>| function.is_none_or(|f| functions.contains(&f));
        self.uses().iter().filter(|u| counts(u.function)).map(|u| u.symbol).collect()
    }
}
