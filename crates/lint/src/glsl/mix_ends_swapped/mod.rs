//! N033: `mix` from the second of two numbered ends to the first.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::ast::ExprKind;

use analysis::numeric::{calls, is_plain};
use syntax::words::words;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N033"),
    name: "mix-ends-swapped",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Pairs of words for the beginning and the end of a path.
const PAIRS: [(&str, &str); 5] =
    [("start", "end"), ("begin", "end"), ("first", "last"), ("from", "to"), ("prev", "next")];

/// True when `a` is named as the end of what `b` is the beginning of: `p1` and `p0`, `colorEnd` and `colorStart`.
fn swapped(a: &str, b: &str) -> bool {
    let numbered = |name: &str| {
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        Some((stem.to_owned(), name[stem.len()..].parse::<u32>().ok()?))
    };
    if let (Some((x, i)), Some((y, k))) = (numbered(a), numbered(b)) {
        return x == y && i == k + 1;
    }
    let (a, b) = (words(a), words(b));
    let differ: Vec<(&String, &String)> = a.iter().zip(&b).filter(|(x, y)| x != y).collect();
    match differ.as_slice() {
        [(x, y)] if a.len() == b.len() => PAIRS.iter().any(|(begin, end)| x == end && y == begin),
        _ => false,
    }
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for call in calls(shader, &["mix"]) {
        let [a, b, t] = call.args else { continue };
        let name = |id| match &shader.expr(id).kind {
            ExprKind::Name(name) => Some(name.as_str()),
            _ => None,
        };
        // A weight that is turned round goes with ends that are.
        let (Some(first), Some(second), Some(_)) = (name(*a), name(*b), name(*t)) else { continue };
        // `x = mix(x, y, b)` replaces x where b is 1.
        let replaces = shader.arena().iter().any(|(_, expr)| match expr.kind {
            ExprKind::Assign { op: None, op_span: _, target, value } => {
                value == call.id && shader.symbol_of(target).is_some_and(|s| shader.symbol_of(*a) == Some(s))
            }
            _ => false,
        });
        if replaces || !swapped(first, second) {
            continue;
        }
        let mut found = findings
            .at(
                &file.file,
                shader.expr(call.id).span,
                message!("this goes from `{first}` to `{second}`", "`{first}` から `{second}` への補間になっています"),
            )
            .with_label(message!("gives `{first}` where the weight is 0", "重みが 0 のとき `{first}` になります"))
            .with_why(message!(
                "`mix(a, b, t)` is `a` at 0 and `b` at 1; by their names, the ends are swapped",
                "`mix(a, b, t)` は 0 で `a`、1 で `b` です。名前によれば両端が逆です"
            ))
            .with_help(message!(
                "swap the ends if that is not meant",
                "意図したものでなければ両端を入れ替えてください"
            ));
        if is_plain(shader, &[call.id, *a, *b]) {
            let edits = vec![
                Edit::replace(shader.expr(*a).span, second.to_owned()),
                Edit::replace(shader.expr(*b).span, first.to_owned()),
            ];
            found = found.with_fix(message!("swap the ends", "両端を入れ替える"), Safety::Unsafe, edits);
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, rings, silent};
    use super::*;

    #[test]
    fn ends_in_the_order_of_their_names_are_meant() {
        rings(
            "N033",
            Level::Strict,
            &[
                "vec3 p0 = p; vec3 p1 = q; v = mix(p1, p0, s);",
                "float fadeStart = s; float fadeEnd = t; r = mix(fadeEnd, fadeStart, s);",
            ],
        );
        silent(
            "N033",
            Level::Heuristic,
            &[
                "vec3 p0 = p; vec3 p1 = q; v = mix(p0, p1, s);",
                "vec3 p0 = p; vec3 p1 = q; v = mix(p1, p0, 1.0 - s);",
                "v = mix(q, p, s);",
                "vec3 p0 = p; vec3 p1 = q; p1 = mix(p1, p0, s); v = p1;",
                "float most1 = s; float most0 = t; r = mix(t, s, most0);",
            ],
        );
        assert!(swapped("a12", "a11") && !swapped("a1", "b0") && !swapped("x", "y"));
    }

    #[test]
    fn the_fix_swaps_them() {
        assert_eq!(
            fixed("N033", "vec3 p0 = p; vec3 p1 = q; v = mix(p1, p0, s);"),
            "vec3 p0 = p; vec3 p1 = q; v = mix(p0, p1, s);"
        );
    }
}
