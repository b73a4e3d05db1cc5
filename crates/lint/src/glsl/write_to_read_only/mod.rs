//! T018: something is written that can only be read.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::interface::Storage;
use syntax::symbols::SymbolKind;
use syntax::types::Type;

use super::compile::fresh;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T018"),
    name: "write-to-read-only",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let Some(first) = shader.uses().iter().find(|u| u.span == found.span) else { return Some(found) };
    let symbol = shader.symbol(first.symbol);
    let input = symbol.kind == SymbolKind::Global(Storage::In) && !matches!(symbol.ty, Type::Array(..));
    let one_function = shader.uses_of(first.symbol).all(|u| u.function == first.function && !u.from_macro);
    // One fix for all writes: that of the first one.
    let is_first = shader.uses_of(first.symbol).find(|u| u.access.writes()).is_some_and(|u| u.span == found.span);
    let body =
        first.function.and_then(|f| shader.function_syntax(shader.function_info(f))).and_then(|f| f.body.as_ref());
    let Some(body) = body.filter(|_| input && one_function && is_first) else { return Some(found) };
    let (name, ty) = (symbol.name.clone(), symbol.ty.to_string());
    let copy = fresh(shader, &name);
    let mut edits = vec![Edit::insert(body.span.start + 1, format!("\n  {ty} {copy} = {name};"))];
    edits.extend(shader.uses_of(first.symbol).map(|u| Edit::replace(u.span, copy.clone())));
    Some(found.with_fix(message!("copy `{name}` into `{copy}`", "`{name}` を `{copy}` に写す"), Safety::Safe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired_but_flow as lint;

    #[test]
    fn an_input_is_copied_first() {
        let text =
            "#version 150\nin vec3 n;\nout vec4 c;\nvoid main() {\n  n = normalize(n);\n  c = vec4(n, 1.0);\n}\n";
        let want = "#version 150\nin vec3 n;\nout vec4 c;\nvoid main() {\n  vec3 n_ = n;\n  n_ = normalize(n_);\n  c = vec4(n_, 1.0);\n}\n";
        assert_eq!(lint("a.frag", text), (vec!["T018"], Some((Safety::Safe, want.to_owned()))));
        assert!(lint("a.frag", want).0.is_empty());
        // A uniform is not copied, and an input that two functions use neither.
        let uniform = "#version 150\nuniform float u;\nout vec4 c;\nvoid main() { u += 1.0; c = vec4(u); }\n";
        assert_eq!(lint("a.frag", uniform), (vec!["T018"], None));
        let shared = "#version 150\nin float n;\nout vec4 c;\nfloat f() { return n; }\nvoid main() { n = 1.0; c = vec4(n, f(), n, n); }\n";
        assert_eq!(lint("a.frag", shared), (vec!["T018"], None));
    }
}
