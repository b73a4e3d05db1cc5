//! N034: an unsigned difference that has wrapped when it is limited.

use std::collections::BTreeSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::symbols::{CallTarget, SymbolId, SymbolKind};
use syntax::types::ScalarType;

use analysis::forms::builtin;
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N034"),
    name: "unsigned-wraps",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// The variable of `x - c`, where the difference is unsigned and nothing but `x` decides whether it wraps.
fn difference(shader: &Shader, id: ExprId) -> Option<SymbolId> {
    let id = bare(shader, id);
    let ExprKind::Binary { op: BinaryOp::Sub, op_span: _, left, right } = shader.expr(id).kind else { return None };
    let unsigned = shader.type_of(id).scalar() == Some(ScalarType::Uint) && shader.type_of(id).is_scalar();
    (unsigned && constant(shader, right).is_some_and(|c| c > 0.0)).then_some(())?;
    let mut left = bare(shader, left);
    while let ExprKind::Field { base, field: _ } = shader.expr(left).kind {
        left = base;
    }
    shader.symbol_of(left)
}

/// Variables that are compared with something, anywhere.
fn compared(shader: &Shader) -> BTreeSet<SymbolId> {
    use BinaryOp as O;
    let mut found = BTreeSet::new();
    for (_, expr) in shader.arena().iter() {
        let condition = match &expr.kind {
            ExprKind::Binary {
                op: O::Less | O::Greater | O::LessEqual | O::GreaterEqual | O::Equal | O::NotEqual,
                left,
                right,
                ..
            } => vec![*left, *right],
            ExprKind::Ternary { condition, .. } => vec![*condition],
            _ => continue,
        };
        for id in condition.into_iter().flat_map(|c| super::walk::expressions(shader, c)) {
            found.extend(shader.symbol_of(id));
        }
    }
    found
}

/// True for a divisor that may be no power of two.
fn goes_round(shader: &Shader, divisor: ExprId) -> bool {
    constant(shader, divisor).is_none_or(|c| c.log2().fract() != 0.0)
}

/// Parameters of which a remainder is taken, as they are, there or in a function that gets them.
fn remainders(shader: &Shader) -> BTreeSet<SymbolId> {
    let of = |expr: &ExprKind| match expr {
        ExprKind::Binary { op: BinaryOp::Rem, op_span: _, left, right } if goes_round(shader, *right) => {
            shader.symbol_of(bare(shader, *left))
        }
        _ => None,
    };
    let own = |symbol: &SymbolId| !shader.is_written(*symbol);
    let mut found: BTreeSet<SymbolId> = shader.arena().iter().filter_map(|(_, e)| of(&e.kind)).filter(own).collect();
    loop {
        let passed = shader.arena().iter().flat_map(|(id, _)| arguments(shader, id, &found));
        let more: BTreeSet<SymbolId> = passed.filter_map(|arg| shader.symbol_of(bare(shader, arg))).collect();
        let is_param = |symbol: &SymbolId| matches!(shader.symbol(*symbol).kind, SymbolKind::Param(_)) && own(symbol);
        let before = found.len();
        found.extend(more.into_iter().filter(is_param));
        if found.len() == before {
            return found;
        }
    }
}

/// What a call passes for some of these parameters.
fn arguments(shader: &Shader, id: ExprId, params: &BTreeSet<SymbolId>) -> Vec<ExprId> {
    let (ExprKind::Call { callee: _, args }, Some(CallTarget::User(function))) =
        (&shader.expr(id).kind, shader.callee(id))
    else {
        return Vec::new();
    };
    let taken = shader.function_info(*function).params.iter().zip(args);
    taken.filter(|(p, _)| p.symbol.is_some_and(|s| params.contains(&s))).map(|(_, arg)| *arg).collect()
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut limited: Vec<(ExprId, bool)> = Vec::new();
    let remainders = remainders(shader);
    for (id, expr) in shader.arena().iter() {
        if let ExprKind::Binary { op: BinaryOp::Rem, op_span: _, left, right } = expr.kind
            && goes_round(shader, right)
        {
            limited.push((left, true));
        }
        if let Some((name, args)) = builtin(shader, id, &["max", "clamp"]) {
            let zero = |a: &ExprId| constant(shader, *a) == Some(0.0);
            match args {
                [x, low] if name == "max" && zero(low) => limited.push((*x, false)),
                [low, x] if name == "max" && zero(low) => limited.push((*x, false)),
                [x, low, _] if zero(low) => limited.push((*x, false)),
                _ => {}
            }
        }
        limited.extend(arguments(shader, id, &remainders).into_iter().map(|arg| (arg, true)));
    }
    if limited.is_empty() {
        return;
    }
    let compared = compared(shader);
    let mut told = BTreeSet::new();
    for (id, remainder) in limited {
        let Some(symbol) = difference(shader, id).filter(|s| !compared.contains(s)) else { continue };
        // Once for each variable: where one wraps, all do.
        if !told.insert(symbol) || shader.expr(id).from_macro {
            continue;
        }
        let text = shader.text_of(bare(shader, id));
        let why = if remainder {
            message!(
                "below 0 it is 2³² less, and the remainder of that is what is meant for powers of two alone",
                "0 を下回ると 2³² を足した値になり、その剰余が意図した値になるのは 2 の累乗の場合だけです"
            )
        } else {
            message!(
                "below 0 it is a large number, which is above 0: the limit has no effect",
                "0 を下回ると大きな数になり 0 より大きいので、この制限は効きません"
            )
        };
        let help = if remainder {
            message!("add the divisor before subtracting", "引く前に除数を足してください")
        } else {
            message!(
                "limit the number before subtracting, or compute with signed numbers",
                "引く前に値を制限するか、符号付きの数で計算してください"
            )
        };
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(id).span,
                    message!(
                        "`{text}` is unsigned and wraps below 0",
                        "`{text}` は符号なしで、0 を下回ると回り込みます"
                    ),
                )
                .with_why(why)
                .with_help(help),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::wgsl::testing::count;

    fn wraps(line: &str) -> usize {
        let text = format!(
            "@group(0) @binding(0) var<uniform> w: u32;\nfn round(x: u32) -> u32 {{ return x % w; }}\n\
             fn far(y: u32) -> u32 {{ return 2u * round(y); }}\n\
             fn f(x: u32, y: i32, g: vec3u) -> u32 {{ {line} }}\n"
        );
        count("N034", &text)
    }

    #[test]
    fn limits_behind_the_wrap_are_reported() {
        assert_eq!(wraps("return (x - 1) % w;"), 1);
        assert_eq!(wraps("return (g.x - 1u) % 48u;"), 1);
        assert_eq!(wraps("return round(x - 1);"), 1);
        assert_eq!(wraps("return far(x - 1);"), 1);
        assert_eq!(wraps("return max(x - 1, 0);"), 1);
        assert_eq!(wraps("return clamp(g.y - 2u, 0u, w);"), 1);
    }

    #[test]
    fn others_are_not() {
        assert_eq!(wraps("return (x + w - 1) % w;"), 0);
        assert_eq!(wraps("return (x - 1) % 64u;"), 0, "a power of two");
        assert_eq!(wraps("if x > 0 { return (x - 1) % w; } return 0;"), 0);
        assert_eq!(wraps("return u32(max(y - 1, 0));"), 0, "signed");
        assert_eq!(wraps("return max(x - 1, 4);"), 0);
        assert_eq!(wraps("return select((x - 1) % w, 0u, x == 0u);"), 0);
    }
}
