//! N036: the largest of numbers of any sign, sought from 0.

use std::collections::BTreeSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::plain;
use base::diagnostic::{Code, Severity, message};
use base::text::Span;
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{Callee, ExprId, ExprKind, Literal, StmtKind};
use syntax::symbols::SymbolId;
use syntax::types::Type;
use syntax::words::words;

use super::variable::declarator;
use super::walk::statements;
use analysis::names::has_word;
use analysis::numeric::bare;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N036"),
    name: "extreme-from-zero",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Words for numbers of which a name says nothing more, so that they have any sign; radiance, mass and counts have one.
const PLAIN: [&str; 18] = [
    "input",
    "in",
    "data",
    "src",
    "source",
    "from",
    "value",
    "values",
    "val",
    "x",
    "a",
    "b",
    "tensor",
    "bottom",
    "blob",
    "logits",
    "scores",
    "activations",
];

/// True where the array that a value is read from is called after nothing in particular.
fn is_plain(shader: &Shader, value: ExprId) -> bool {
    let ExprKind::Index { base, .. } = shader.expr(plain(shader, value)).kind else { return false };
    let all = words(shader.text_of(base).trim());
    let said = |word: &String| {
        let word = word.rsplit('.').next().unwrap_or(word).trim_end_matches(|c: char| c.is_ascii_digit());
        word.is_empty() || PLAIN.contains(&word)
    };
    all.iter().flat_map(|word| word.split('.').map(str::to_owned)).collect::<Vec<_>>().iter().all(said)
}

/// True for 0, and for vectors and conversions of nothing else.
fn is_zero(shader: &Shader, id: ExprId) -> bool {
    let id = bare(shader, id);
    match &shader.expr(id).kind {
        ExprKind::Call { args, .. } => !args.is_empty() && args.iter().all(|arg| is_zero(shader, *arg)),
        ExprKind::Literal(Literal::Int(0) | Literal::Uint(0)) => true,
        ExprKind::Literal(Literal::Float(number) | Literal::Double(number) | Literal::Half(number)) => *number == 0.0,
        _ => false,
    }
}

/// `m = max(m, x)`: the variable, the function and `x`.
fn kept(shader: &Shader, id: ExprId) -> Option<(SymbolId, &str, ExprId)> {
    let ExprKind::Assign { op: None, target, value, .. } = shader.expr(id).kind else { return None };
    let symbol = shader.symbol_of(bare(shader, target))?;
    let ExprKind::Call { callee: Callee::Name(name), args } = &shader.expr(bare(shader, value)).kind else {
        return None;
    };
    let [a, b] = args.as_slice() else { return None };
    ["max", "min"].contains(&name.name.as_str()).then_some(())?;
    let own = |id: ExprId| shader.symbol_of(bare(shader, id)) == Some(symbol);
    match (own(*a), own(*b)) {
        (true, false) => Some((symbol, &name.name, *b)),
        (false, true) => Some((symbol, &name.name, *a)),
        _ => None,
    }
}

/// True for an element of memory that others fill with numbers of any sign: floats, as far as the type is known.
fn is_element(shader: &Shader, id: ExprId) -> bool {
    let ExprKind::Index { base, .. } = shader.expr(plain(shader, id)).kind else { return false };
    let global = |symbol: SymbolId| {
        use syntax::symbols::SymbolKind as K;
        matches!(shader.symbol(symbol).kind, K::Global(_) | K::BlockMember(_) | K::BlockInstance(_))
    };
    let float = match shader.type_of(id).scalar() {
        Some(scalar) => scalar.is_floating(),
        None => *shader.type_of(id) == Type::Error,
    };
    float && analysis::entry::root(shader, base).is_some_and(|(symbol, _)| global(symbol))
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut loops: Vec<Span> = Vec::new();
    statements(shader, |stmt| {
        if matches!(stmt.kind, StmtKind::For { .. } | StmtKind::While { .. } | StmtKind::DoWhile { .. }) {
            loops.push(stmt.span);
        }
    });
    if loops.is_empty() {
        return;
    }
    let mut told = BTreeSet::new();
    for (id, expr) in shader.arena().iter() {
        let Some((symbol, name, value)) = kept(shader, id) else { continue };
        let around: Vec<&Span> = loops.iter().filter(|l| l.contains(expr.span.start)).collect();
        let before = |span: Span| !around.is_empty() && around.iter().all(|l| !l.contains(span.start));
        let from_zero = shader.symbol(symbol).span.is_some_and(before)
            && declarator(file, symbol)
                .and_then(|d| d.initializer.as_ref())
                .is_some_and(|initial| is_zero(shader, initial.value));
        // What else it gets before is another number to begin with.
        let begin = around.iter().map(|l| l.start).min().unwrap_or_default();
        let mut writes = shader.uses_of(symbol).filter(|u| u.access.writes());
        let alone = writes.all(|u| shader.expr(u.expr).span.start >= begin);
        let element = is_element(shader, value).then_some(value).or_else(|| {
            shader.symbol_of(bare(shader, value)).and_then(|s| {
                let writes = shader.arena().iter().filter_map(|(_, e)| match e.kind {
                    ExprKind::Assign { op: None, target, value, .. } if shader.symbol_of(target) == Some(s) => {
                        Some(value)
                    }
                    _ => None,
                });
                let initial = declarator(file, s).and_then(|d| d.initializer.as_ref()).map(|i| i.value);
                writes.chain(initial).find(|value| is_element(shader, *value))
            })
        });
        // Sizes of numbers are known to be positive.
        let sizes = has_word(&shader.symbol(symbol).name, &["abs"]) || has_word(shader.text_of(value), &["abs"]);
        let Some(element) = element.filter(|_| !sizes && from_zero && alone && !expr.from_macro) else { continue };
        if !told.insert(symbol) {
            continue;
        }
        let level = if is_plain(shader, element) { Level::Default } else { Level::Strict };
        let variable = &shader.symbol(symbol).name;
        let sign = if name == "max" {
            message!("negative, this gives 0", "負なら、結果は 0 になります")
        } else {
            message!("positive, this gives 0", "正なら、結果は 0 になります")
        };
        findings.push_at(
            level,
            findings
                .at(
                    &file.file,
                    expr.span,
                    message!(
                        "`{variable}` begins with 0, which counts as one of the numbers",
                        "`{variable}` は 0 から始まり、0 も数のうちに入ります"
                    ),
                )
                .with_label(sign)
                .with_why(message!(
                    "`{name}` of numbers that all lie on the other side of 0 is 0, which is none of them",
                    "すべての数が 0 の反対側にあると `{name}` は 0 になり、どの数でもありません"
                ))
                .with_help(message!(
                    "begin with the first number, or with one that is beyond all of them",
                    "最初の数か、すべての数の外側の数から始めてください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{default_count, strict_count};
    use super::*;

    fn count(body: &str) -> usize {
        let text = format!(
            "#version 450\nlayout(local_size_x = 8) in;\nlayout(std430, binding = 0) buffer D {{ float d[]; }};\n\
             layout(std430, binding = 1) buffer U {{ uint u[]; }};\nvoid main()\n{{\n \
             uint i = gl_GlobalInvocationID.x;\n {body}\n}}\n"
        );
        strict_count(RULE.code, "a.comp", &text)
    }

    #[test]
    fn extremes_from_zero_are_reported() {
        assert_eq!(count("float m = 0.0; for (uint k = 0u; k < 9u; ++k) m = max(m, d[i + k]); d[i] = m;"), 1);
        assert_eq!(
            count("float m = 0.0; float v; for (uint k = 0u; k < 9u; ++k) { v = d[i + k]; m = min(v, m); } d[i] = m;"),
            1
        );
    }

    #[test]
    fn names_of_numbers_with_a_sign_are_for_the_strict_level() {
        let text = |name: &str| {
            format!(
                "#version 450\nlayout(local_size_x = 8) in;\nlayout(binding = 0) buffer I {{ float {name}[]; }};\n\
                 void main() {{ float m = 0.0; for (uint k = 0u; k < 9u; ++k) m = max(m, {name}[k]); {name}[9] = m; }}\n"
            )
        };
        let count = |name: &str| {
            (default_count(RULE.code, "a.comp", &text(name)), strict_count(RULE.code, "a.comp", &text(name)))
        };
        assert_eq!((count("input_0_data"), count("x"), count("src1")), ((1, 1), (1, 1), (1, 1)));
        assert_eq!((count("radiance"), count("mass_data")), ((0, 1), (0, 1)));
    }

    #[test]
    fn others_are_not() {
        assert_eq!(count("float m = d[i]; for (uint k = 0u; k < 9u; ++k) m = max(m, d[i + k]); d[i] = m;"), 0);
        assert_eq!(count("float m = 0.0; for (uint k = 0u; k < 9u; ++k) m = max(m, abs(d[i + k])); d[i] = m;"), 0);
        assert_eq!(count("float m = 0.0; m = max(m, d[i]); d[i] = m;"), 0, "a limit");
        assert_eq!(
            count("float absmax = 0.0; for (uint k = 0u; k < 9u; ++k) absmax = max(absmax, d[k]); d[i] = absmax;"),
            0
        );
        assert_eq!(count("uint m = 0u; for (uint k = 0u; k < 9u; ++k) m = max(m, u[i + k]); d[i] = float(m);"), 0);
        assert_eq!(count("float m = 0.0; m = d[0]; for (uint k = 0u; k < 9u; ++k) m = max(m, d[i + k]); d[i] = m;"), 0);
    }
}
