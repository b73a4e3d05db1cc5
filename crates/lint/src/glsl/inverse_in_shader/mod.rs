//! P001: a matrix that the host could invert once.

use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{Callee, ExprId, ExprKind};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, SymbolKind};

use super::walk::expressions;
use crate::rule::{Check, Findings, Level, Pages, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("P001"),
    name: "inverse-in-shader",
    severity: Severity::Info,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !file.is_sound() {
        return;
    }
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Call { callee: Callee::Name(name), args } = &expr.kind else { continue };
        let builtin = matches!(shader.callee(id), Some(CallTarget::Builtin(_)));
        if name.name != "inverse" || !builtin || !args.iter().all(|a| is_uniform(shader, *a)) {
            continue;
        }
        let text = shader.text_of(id);
        findings.push(
            findings
                .at(
                    &file.file,
                    expr.span,
                    message!("`{text}` is the same in every invocation", "`{text}` はどの呼び出しでも同じ値です"),
                )
                .with_label(message!("inverted each time", "毎回計算される逆行列"))
                .with_why(message!(
                    "it depends on uniforms only, and is computed for every vertex or fragment",
                    "uniform だけで決まる値が、頂点やフラグメントごとに計算されます"
                ))
                .with_help(message!(
                    "compute it on the host and pass it as a uniform of its own",
                    "ホストで計算し、別の uniform として渡してください"
                )),
        );
    }
}

/// True when the value is made of uniforms and constants, and of one uniform at least.
fn is_uniform(shader: &Shader, root: ExprId) -> bool {
    let mut any = false;
    let all = expressions(shader, root).into_iter().all(|id| match &shader.expr(id).kind {
        ExprKind::Name(_) => shader.symbol_of(id).is_some_and(|s| {
            let symbol = shader.symbol(s);
            let block = |b: usize| shader.interface().blocks.get(b).is_some_and(|b| b.storage == Storage::Uniform);
            let uniform = match symbol.kind {
                SymbolKind::Global(storage) => storage == Storage::Uniform,
                SymbolKind::BlockMember(b) | SymbolKind::BlockInstance(b) => block(b),
                SymbolKind::Builtin => symbol.name.ends_with("Matrix"),
                SymbolKind::Local | SymbolKind::Param(_) => false,
            };
            any |= uniform;
            uniform || matches!(symbol.kind, SymbolKind::Global(Storage::Const))
        }),
        ExprKind::Call { .. } => !matches!(shader.callee(id), Some(CallTarget::User(_)) | None),
        ExprKind::Assign { .. } | ExprKind::Postfix { .. } | ExprKind::Error => false,
        _ => true,
    });
    all && any
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn inverses_of_uniforms_are_reported() {
        let reported = |statement: &str| {
            let text = format!(
                "#version 150 core\nin vec4 p;\nuniform mat4 a;\nuniform B {{ mat4 b; }};\nuniform C {{ mat4 m[3]; }} c;\nvoid main(void)\n{{\n  mat4 l = a;\n  gl_Position = p;\n  l = {statement};\n}}\n"
            );
            messages("P001", "a.vert", &text).len()
        };
        for statement in
            ["inverse(a)", "transpose(inverse(b))", "inverse(a * b)", "inverse(c.m[1])", "mat4(inverse(mat3(a)))"]
        {
            assert_eq!(reported(statement), 1, "{statement}");
        }
        for statement in
            ["inverse(l)", "inverse(a * p.x)", "inverse(c.m[int(p.x)])", "transpose(a)", "inverse(mat4(1.0))"]
        {
            assert_eq!(reported(statement), 0, "{statement}");
        }
    }
}
