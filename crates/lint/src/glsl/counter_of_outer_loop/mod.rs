//! D022: a loop within another that shifts by the counter of the outer one, and does not use its own.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use base::text::Span;
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, Stmt, StmtKind};
use syntax::symbols::SymbolId;

use super::walk::{expressions, statements};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D022"),
    name: "counter-of-outer-loop",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// A loop that declares what it counts with.
struct Counting {
    counter: SymbolId,
    whole: Span,
    body: Span,
}

fn counting(shader: &Shader, stmt: &Stmt) -> Option<Counting> {
    let StmtKind::For { init, body, .. } = &stmt.kind else { return None };
    let StmtKind::Declaration(declaration) = &init.kind else { return None };
    let [declarator] = declaration.declarators.as_slice() else { return None };
    let (counter, _) = shader.symbols().find(|(_, s)| s.span == Some(declarator.name.span))?;
    Some(Counting { counter, whole: stmt.span, body: body.span })
}

/// Amounts of the shifts in a text: `i` of `a >> i` and of `a >>= i`.
fn amounts(shader: &Shader, within: Span) -> Vec<ExprId> {
    let amount = |kind: &ExprKind| match *kind {
        ExprKind::Binary { op: BinaryOp::Shl | BinaryOp::Shr, right, .. } => Some(right),
        ExprKind::Assign { op: Some(BinaryOp::Shl | BinaryOp::Shr), value, .. } => Some(value),
        _ => None,
    };
    let stands = |span: Span| within.contains(span.start);
    shader
        .arena()
        .iter()
        .filter(|(_, e)| stands(e.span) && !e.from_macro)
        .filter_map(|(_, e)| amount(&e.kind))
        .collect()
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut loops = Vec::new();
    statements(shader, |stmt| loops.extend(counting(shader, stmt)));
    for inner in &loops {
        if shader.uses_of(inner.counter).any(|u| inner.body.contains(shader.expr(u.expr).span.start)) {
            continue;
        }
        let around: Vec<&Counting> = loops.iter().filter(|outer| outer.body.contains(inner.whole.start)).collect();
        let outer = |amount: &ExprId| {
            let names: Vec<SymbolId> =
                expressions(shader, *amount).into_iter().filter_map(|part| shader.symbol_of(part)).collect();
            let [name] = names[..] else { return None };
            around.iter().find(|outer| outer.counter == name).map(|outer| (*amount, outer.counter))
        };
        let Some((amount, outer)) = amounts(shader, inner.body).iter().find_map(outer) else { continue };
        let (own, other) = (&shader.symbol(inner.counter).name, &shader.symbol(outer).name);
        let mut found = findings
            .at(
                &file.file,
                shader.expr(amount).span,
                message!(
                    "this loop shifts by `{other}` of the loop around it, and does not use its own counter `{own}`",
                    "このループは外側のループの `{other}` だけシフトし、自分のカウンタ `{own}` を使っていません"
                ),
            )
            .with_why(message!(
                "the amount is the same in each round, where a search or a scan halves or doubles its step",
                "シフト量が毎回同じです。探索や走査では、毎回の歩みが半分か倍になるはずです"
            ))
            .with_help(message!("shift by `{own}`", "`{own}` だけシフトしてください"));
        if let Some(span) = shader.symbol(inner.counter).span {
            found =
                found.with_related(&file.file, span, message!("not used in the loop", "ループの中で使われていません"));
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::strict_count;
    use super::*;

    fn count(body: &str) -> usize {
        let text = format!(
            "#version 450\nlayout(local_size_x = 64) in;\nlayout(std430, binding = 0) buffer D {{ uint d[]; }};\n\
             void main()\n{{\n uint n = d[0];\n uint at = 0u;\n for (uint i = gl_LocalInvocationID.x; i < n; i += 64u)\n \
             {{\n  at = 0u;\n  {body}\n  d[i] = at;\n }}\n}}\n"
        );
        strict_count(RULE.code, "a.comp", &text)
    }

    #[test]
    fn shifts_by_the_counter_of_the_outer_loop_are_reported() {
        assert_eq!(count("for (uint j = 0u; j < 6u; ++j) { uint p = at + (32u >> i); if (i >= d[p]) at = p; }"), 1);
        assert_eq!(count("uint s = 64u; for (uint j = 0u; j < 6u; ++j) { s >>= i; if (i >= d[at + s]) at += s; }"), 1);
    }

    #[test]
    fn shifts_by_the_own_counter_or_beside_it_are_not() {
        assert_eq!(count("for (uint j = 0u; j < 6u; ++j) { uint p = at + (32u >> j); if (i >= d[p]) at = p; }"), 0);
        assert_eq!(count("for (uint j = 0u; j < 6u; ++j) { at += d[j] >> i; }"), 0, "both are used");
        assert_eq!(count("for (uint j = 0u; j < 6u; ++j) { at += 2u; } at += 32u >> i;"), 0, "not in the inner loop");
        assert_eq!(count("for (uint j = 0u; j < 6u; ++j) { at = (at >> 1u) + d[i]; }"), 0, "by a constant");
    }

    #[test]
    fn kernels_in_wgsl_are_read_alike() {
        let text = |amount: &str| {
            format!(
                "@group(0) @binding(0) var<storage, read_write> d: array<u32>;\n@compute @workgroup_size(64)\n\
                 fn main(@builtin(local_invocation_id) l: vec3<u32>) {{\n for (var i = l.x; i < d[0]; i += 64u) {{\n  \
                 var at = 0u;\n  for (var j = 0u; j < 6u; j++) {{\n   let p = at + (32u >> {amount});\n   \
                 if i >= d[p] {{ at = p; }}\n  }}\n  d[i] = at;\n }}\n}}\n"
            )
        };
        assert_eq!(strict_count(RULE.code, "a.wgsl", &text("i")), 1);
        assert_eq!(strict_count(RULE.code, "a.wgsl", &text("j")), 0);
    }
}
