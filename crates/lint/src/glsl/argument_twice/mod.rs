//! T032: an argument that stands twice where a numbered one is left out.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{ExprId, ExprKind};

use analysis::numeric::{bare, is_simple};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T032"),
    name: "argument-twice",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// A name that ends with a number, apart.
fn numbered(text: &str) -> Option<(&str, u32)> {
    let stem = text.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = text[stem.len()..].parse().ok()?;
    stem.ends_with(|c: char| c.is_alphabetic() || c == '_').then_some((stem, number))
}

/// The argument that stands twice, where the numbers go up by 1 otherwise, with the name that is left out.
fn twice(shader: &Shader, args: &[ExprId]) -> Option<(ExprId, ExprId, String)> {
    let all: Vec<(ExprId, &str, u32)> = args
        .iter()
        .filter(|a| is_simple(shader, **a))
        .filter_map(|a| numbered(shader.text_of(*a)).map(|(stem, number)| (*a, stem, number)))
        .collect();
    let (first, others) = all.split_first().filter(|(first, _)| all.iter().all(|a| a.1 == first.1))?;
    // One of them twice and one of them missing, in a row of at least four.
    let last = others.last().filter(|_| all.len() >= 4)?;
    if usize::try_from(last.2.checked_sub(first.2)?).ok()? + 1 != all.len() {
        return None;
    }
    let mut found = None;
    for (at, (id, stem, number)) in all.iter().enumerate() {
        let wanted = first.2 + u32::try_from(at).ok()?;
        if *number == wanted {
            continue;
        }
        let other = all.iter().find(|o| o.2 == *number && o.0 != *id)?;
        if found.replace((other.0, *id, format!("{stem}{wanted}"))).is_some() {
            return None;
        }
    }
    found
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let words = || shader.tokens().iter().map(|t| shader.file().slice(t.span));
    for (_, expr) in shader.arena().iter().filter(|(_, e)| !e.from_macro) {
        let ExprKind::Call { callee: _, args } = &expr.kind else { continue };
        let Some((first, second, wanted)) = twice(shader, args) else { continue };
        let name = wanted.rsplit('.').next().unwrap_or(&wanted);
        if !words().any(|w| w == name) {
            continue;
        }
        let text = shader.text_of(bare(shader, second));
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(second).span,
                    message!(
                        "`{text}` stands twice in this call, and `{wanted}` is left out",
                        "この呼び出しには `{text}` が二度あり、`{wanted}` がありません"
                    ),
                )
                .with_label(message!("the same once more", "同じ引数"))
                .with_related(&file.file, shader.expr(first).span, message!("the other one", "もう一方"))
                .with_why(message!("the other arguments are numbered one by one", "他の引数には順に番号が付いています"))
                .with_help(message!("pass `{wanted}`, if it is meant", "意図していれば `{wanted}` を渡してください")),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::wgsl::testing::count;

    fn found(args: &str) -> usize {
        count(
            "T032",
            &format!(
                "struct P {{ p0: vec2f, p1: vec2f, p2: vec2f, p3: vec2f }}\n\
                 fn g(a: vec2f, b: vec2f, c: vec2f, d: vec2f) -> vec2f {{ return a + b * c - d; }}\n\
                 fn f(p: P, q0: vec2f, q1: vec2f, q2: vec2f, q3: vec2f) -> vec2f {{ return g({args}); }}\n"
            ),
        )
    }

    #[test]
    fn a_number_that_is_left_out_is_reported() {
        assert_eq!(found("p.p0, p.p1, p.p3, p.p3"), 1);
        assert_eq!(found("q0, q0, q2, q3"), 1);
    }

    #[test]
    fn others_are_not() {
        assert_eq!(found("p.p0, p.p1, p.p2, p.p3"), 0);
        assert_eq!(found("q0, q1, q1, q2"), 0, "the end of a spline");
        assert_eq!(found("q0, q0, q1, q2"), 0);
        assert_eq!(found("q3, q2, q2, q0"), 0, "another order");
        assert_eq!(found("q0, q1, q3 + q3, q3"), 0);
    }
}
