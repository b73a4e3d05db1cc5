//! N011: limits of `clamp` or edges of `smoothstep` in the wrong order.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::{Observed, Range};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::{Project, ShaderFile};
use syntax::ast::ExprId;

use super::numeric::is_constant;
use analysis::numeric::{BuiltinCall, calls, constant, in_place, is_plain};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N011"),
    name: "clamp-min-gt-max",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

/// The two ends where the first one is always beyond the second one, or equal to it.
fn reversed(observed: &Observed, call: ExprId, lo: usize, hi: usize, equal_too: bool) -> Option<(Range, Range)> {
    observed.visits(call).iter().find_map(|visit| {
        let (a, b) = (visit.operands.get(lo)?, visit.operands.get(hi)?);
        let wrong = |(a, b): &(Range, Range)| a.lo > b.hi || (equal_too && a.lo == b.hi);
        (0..a.parts.len().max(b.parts.len())).filter_map(|i| Some((a.part(i)?, b.part(i)?))).find(wrong)
    })
}

/// `clamp(0.0, 1.0, x)`: a constant between a constant and what was to be limited.
fn mixed_up(file: &ShaderFile, call: &BuiltinCall<'_>, findings: &Findings<'_>) -> Option<Diagnostic> {
    let shader = &file.shader;
    let [first, second, third] = *call.args else { return None };
    let is_constant = |id| is_constant(shader, id);
    if call.name != "clamp" || !is_constant(first) || !is_constant(second) || is_constant(third) {
        return None;
    }
    let (a, b, x) = (shader.text_of(first), shader.text_of(second), shader.text_of(third));
    let (least, greatest) = match (constant(shader, first), constant(shader, second)) {
        (Some(first), Some(second)) if first > second => (b, a),
        _ => (a, b),
    };
    let found = findings
        .at(
            &file.file,
            shader.expr(call.id).span,
            message!(
                "`clamp` limits the constant `{a}`, and not `{x}`",
                "`clamp` が `{x}` ではなく定数 `{a}` を制限しています"
            ),
        )
        .with_label(message!("the value comes first", "値は最初の引数です"))
        .with_why(message!("the arguments are the value, the least and the greatest", "引数は値・下限・上限の順です"))
        .with_help(message!(
            "write `clamp({x}, {least}, {greatest})`",
            "`clamp({x}, {least}, {greatest})` と書いてください"
        ));
    let edits = vec![Edit::replace(shader.expr(call.id).span, format!("clamp({x}, {least}, {greatest})"))];
    let title = message!("put the value first", "値を最初に書く");
    let plain = is_plain(shader, &[call.id, first, second, third]);
    Some(if plain { found.with_fix(title, Safety::Unsafe, edits) } else { found })
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    for call in calls(shader, &["clamp", "smoothstep"]) {
        if let Some(found) = mixed_up(file, &call, findings) {
            findings.push(found);
            continue;
        }
        let smooth = call.name == "smoothstep";
        let (lo, hi) = if smooth { (0, 1) } else { (1, 2) };
        let Some((low, high)) = reversed(&observed, call.id, lo, hi, smooth) else { continue };
        let [first, second, third] = call.args else { continue };
        let equal = low.lo == high.hi && low.hi == low.lo && high.lo == high.hi;
        // WGSL computes `smoothstep` by its formula, which falls where the edges are reversed.
        if smooth && !equal && file.is_wgsl() {
            continue;
        }
        let span = shader.expr(call.args[lo]).span.to(shader.expr(call.args[hi]).span);
        let message = match (smooth, equal) {
            (true, true) => message!("the edges of `smoothstep` are equal", "`smoothstep` の両端が等しい値です"),
            (true, false) => message!("the edges of `smoothstep` are reversed", "`smoothstep` の両端の順序が逆です"),
            (false, _) => {
                message!(
                    "the least value of `clamp` is above the greatest",
                    "`clamp` の下限が上限より大きくなっています"
                )
            }
        };
        let why = if smooth {
            message!(
                "`smoothstep` is undefined unless the first edge is below the second one",
                "第一の端が第二の端より小さくなければ、`smoothstep` は未定義です"
            )
        } else {
            message!("`clamp` is undefined when the limits are reversed", "下限と上限が逆だと `clamp` は未定義です")
        };
        let mut found = findings
            .at(&file.file, span, message)
            .with_label(message!("wrong order", "順序が違います"))
            .with_why(why)
            .with_help(message!("put the smaller one first", "小さいほうを先に書いてください"));
        if is_plain(shader, &[call.id, *first, *second, *third]) && !equal {
            let (a, b, c) = (shader.text_of(*first), shader.text_of(*second), shader.text_of(*third));
            let whole = shader.expr(call.id).span;
            let (title, text) = if smooth {
                (
                    message!("subtract from 1", "1 から引く"),
                    in_place(shader, call.id, format!("1.0 - smoothstep({b}, {a}, {c})")),
                )
            } else {
                (message!("swap the limits", "下限と上限を入れ替える"), format!("clamp({a}, {c}, {b})"))
            };
            found = found.with_fix(title, Safety::Unsafe, vec![Edit::replace(whole, text)]);
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, macro_has_no_fix, rings, silent};
    use super::*;

    #[test]
    fn reversed_ends_are_reported() {
        rings(
            "N011",
            Level::Default,
            &[
                "r = clamp(s, 1.0, 0.0);",
                "r = smoothstep(1.0, 0.5, s);",
                "r = smoothstep(0.5, 0.5, s);",
                "v = smoothstep(vec3(0.5), vec3(0.6, 0.4, 0.7), p);",
                "r = clamp(s, 2.0 + abs(t), 1.0);",
                "float w = 0.1; r = smoothstep(0.5 + w, 0.5 - w, s);",
                "r = clamp(0.0, 1.0, s);",
                "v = clamp(vec3(0.0), vec3(1.0), p);",
            ],
        );
    }

    #[test]
    fn others_are_not() {
        silent(
            "N011",
            Level::Heuristic,
            &[
                "r = clamp(s, 0.0, 1.0);",
                "r = clamp(s, 1.0, 1.0);",
                "r = clamp(s, t, 1.0);",
                "r = clamp(0.5, s, t);",
                "r = clamp(0.5, 0.0, 1.0);",
                "r = smoothstep(t, s, p.x);",
                "r = smoothstep(0.5 - fwidth(s), 0.5 + fwidth(s), s);",
                "r = smoothstep(0.0, declared, s);",
            ],
        );
    }

    #[test]
    fn the_fix_puts_the_smaller_one_first() {
        assert_eq!(fixed("N011", "r = 2.0 * smoothstep(1.0, 0.5, s);"), "r = 2.0 * (1.0 - smoothstep(0.5, 1.0, s));");
        assert_eq!(fixed("N011", "r = clamp(s, 1.0, 0.0);"), "r = clamp(s, 0.0, 1.0);");
        macro_has_no_fix("N011", "clamp(a, 1.0, 0.0)");
    }
}
