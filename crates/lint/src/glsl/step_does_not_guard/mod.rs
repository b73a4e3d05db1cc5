//! N026: a product with `step` that is meant to keep away what it multiplies.

use std::collections::BTreeSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, ItemKind};
use syntax::symbols::{CallTarget, FunctionInfo, SymbolId};
use syntax::types::Type;

use super::walk::expressions;
use analysis::forms::{Forms, builtin, constructed};
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N026"),
    name: "step-does-not-guard",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Functions without a finite value, or without any, for some arguments.
const PARTIAL: [&str; 10] =
    ["sqrt", "inversesqrt", "log", "log2", "pow", "acos", "asin", "normalize", "texelFetch", "imageLoad"];

/// The condition that a factor is: `step(a, b)`, `float(a < b)`.
fn condition(shader: &Shader, id: ExprId) -> Option<Vec<ExprId>> {
    if let Some((_, args)) = builtin(shader, id, &["step"]) {
        return Some(args.to_vec());
    }
    let [one] = constructed(shader, id, &Type::FLOAT)? else { return None };
    let compares = matches!(shader.expr(bare(shader, *one)).kind, ExprKind::Binary { .. });
    (*shader.type_of(*one) == Type::BOOL && compares).then(|| vec![*one])
}

/// What must be inside a domain for an expression to have a value: divisors and arguments.
fn operands(shader: &Shader, root: ExprId) -> Vec<ExprId> {
    let mut found = Vec::new();
    for id in expressions(shader, root) {
        match shader.expr(id).kind {
            ExprKind::Binary { op: BinaryOp::Div, op_span: _, left: _, right } => found.push(right),
            _ => {
                if let Some((name, args)) = builtin(shader, id, &PARTIAL) {
                    let index = usize::from(matches!(name, "texelFetch" | "imageLoad"));
                    found.extend(args.get(index));
                }
            }
        }
    }
    // A value that is kept inside is safe by itself.
    found.retain(|id| {
        constant(shader, *id).is_none() && builtin(shader, *id, &["max", "clamp", "abs", "exp"]).is_none()
    });
    found
}

/// True for a function in whose body something depends on the domain of a parameter.
fn is_partial(shader: &Shader, info: &FunctionInfo) -> bool {
    let Some(ItemKind::Function(f)) = info.definition.and_then(|d| shader.unit().items.get(d)).map(|i| &i.kind) else {
        return false;
    };
    let Some(body) = f.body.as_ref().map(|b| b.span) else { return false };
    shader.arena().iter().any(|(id, expr)| {
        let here = body.contains(expr.span.start);
        here && match expr.kind {
            ExprKind::Binary { op: BinaryOp::Div, op_span: _, left: _, right } => constant(shader, right).is_none(),
            _ => builtin(shader, id, &PARTIAL).is_some(),
        }
    })
}

/// True when a factor has no value where the condition on these variables is false.
fn depends(shader: &Shader, forms: &Forms<'_>, factor: ExprId, on: &BTreeSet<SymbolId>) -> bool {
    let shares = |id: ExprId| !forms.symbols(id).is_disjoint(on);
    let value = forms.value(factor);
    operands(shader, value).into_iter().any(shares)
        || expressions(shader, value).into_iter().any(|id| match (&shader.expr(id).kind, shader.callee(id)) {
            (ExprKind::Call { callee: _, args }, Some(CallTarget::User(function))) => {
                args.iter().any(|a| shares(*a)) && is_partial(shader, shader.function_info(*function))
            }
            _ => false,
        })
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let is_chain =
        |id: ExprId| matches!(shader.expr(id).kind, ExprKind::Binary { op: BinaryOp::Mul | BinaryOp::Div, .. });
    let conditions: Vec<ExprId> =
        shader.arena().iter().map(|(id, _)| id).filter(|id| condition(shader, *id).is_some()).collect();
    if conditions.is_empty() {
        return;
    }
    let forms = Forms::new(shader);
    for id in conditions {
        // The whole product that it is a factor of.
        let Some(product) = forms.around(id).take_while(|p| is_chain(*p)).last() else { continue };
        let (above, below) = forms.factors(product);
        if !above.contains(&id) {
            continue;
        }
        let on: BTreeSet<SymbolId> =
            condition(shader, id).into_iter().flatten().flat_map(|a| forms.symbols(a)).collect();
        let others = above.iter().filter(|f| **f != id);
        let divided = below.iter().any(|d| {
            constant(shader, *d).is_none()
                && !forms.symbols(*d).is_disjoint(&on)
                && builtin(shader, *d, &["max", "clamp"]).is_none()
        });
        if !divided && !others.into_iter().any(|f| depends(shader, &forms, *f, &on)) {
            continue;
        }
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(id).span,
                    message!(
                        "this factor does not keep away what it is multiplied with",
                        "この係数を掛けても、相手の計算は避けられません"
                    ),
                )
                .with_label(message!("0 times infinity or NaN is NaN", "0 に無限大や NaN を掛けても NaN です"))
                .with_why(message!(
                    "the other factor is computed where this one is 0, and may have no value there",
                    "この係数が 0 のところでも相手の係数は計算され、そこでは値がないかもしれません"
                ))
                .with_help(if file.is_wgsl() {
                    message!(
                        "use `if` or `select`, which leave the value away",
                        "値を使わずに済む `if` か `select` を使ってください"
                    )
                } else {
                    message!(
                        "use `if` or `?:`, which leave the value away",
                        "値を使わずに済む `if` か `?:` を使ってください"
                    )
                }),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{lint, rings, shader, silent};
    use super::*;

    #[test]
    fn factors_that_are_computed_all_the_same_are_reported() {
        rings(
            "N026",
            Level::Strict,
            &[
                "r = step(0.0, s) * sqrt(s);",
                "r = 2.0 * log(s) * step(1e-3, s);",
                "r = step(1e-3, s) * t / s;",
                "r = float(s > 0.0) * pow(s, t);",
                "float d = length(p); v = step(0.1, d) * q / d;",
            ],
        );
    }

    #[test]
    fn factors_that_have_a_value_everywhere_are_not() {
        silent(
            "N026",
            Level::Heuristic,
            &[
                "r = step(0.0, s) * sqrt(t);",
                "r = step(0.0, s) * sqrt(max(s, 0.0));",
                "r = step(0.5, s) * s / 2.0;",
                "r = s > 0.0 ? sqrt(s) : 0.0;",
                "r = step(0.0, s) * t;",
            ],
        );
    }

    #[test]
    fn a_call_may_hide_the_operation() {
        let count = |function: &str| {
            let text = shader(function, "r = step(0.0, s) * f(s);");
            lint("N026", Level::Strict, &text).len()
        };
        assert_eq!(count("float f(float x) { return 1.0 / x; }"), 1);
        assert_eq!(count("float f(float x) { return x / 2.0; }"), 0);
    }
}
