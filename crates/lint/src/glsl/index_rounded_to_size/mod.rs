//! N039: an index that rounds up to the number of elements.

use std::collections::BTreeSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind};
use syntax::symbols::{CallTarget, SymbolId};
use syntax::types::ScalarType;

use super::walk::{declarators, expressions};
use analysis::forms::{Forms, builtin};
use analysis::numeric::constant;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N039"),
    name: "index-rounded-to-size",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Functions that give a number of elements, in both languages.
const SIZES: [&str; 4] = ["textureDimensions", "arrayLength", "textureSize", "imageSize"];

/// The conversion of a number of elements to a float, with no difference in it.
fn is_count(shader: &Shader, forms: &Forms<'_>, id: ExprId) -> bool {
    let id = forms.value(id);
    let (ExprKind::Call { callee: Callee::Type(_), args }, Some(CallTarget::Constructor(ty))) =
        (&shader.expr(id).kind, shader.callee(id))
    else {
        return false;
    };
    let [count] = args.as_slice() else { return false };
    if ty.scalar() != Some(ScalarType::Float) || !shader.type_of(*count).scalar().is_some_and(ScalarType::is_integer) {
        return false;
    }
    let mut all = expressions(shader, *count);
    let mut next = 0;
    while let Some(&id) = all.get(next) {
        next += 1;
        let value = forms.value(id);
        if value != id && !all.contains(&value) {
            all.extend(expressions(shader, value));
        }
    }
    // Functions that WGSL alone has are no built-in functions of the common table.
    let is_size = |id: &ExprId| match &shader.expr(*id).kind {
        ExprKind::Call { callee: Callee::Name(name), args: _ } => {
            SIZES.contains(&name.name.as_str()) && !matches!(shader.callee(*id), Some(CallTarget::User(_)))
        }
        _ => false,
    };
    let less = |id: &ExprId| matches!(shader.expr(*id).kind, ExprKind::Binary { op: BinaryOp::Sub, .. });
    all.iter().any(is_size) && !all.iter().any(less)
}

/// The product with a number of elements that an expression rounds to the nearest or the next integer.
fn rounded(shader: &Shader, forms: &Forms<'_>, id: ExprId) -> Option<ExprId> {
    let (_, args) = builtin(shader, id, &["round", "roundEven", "ceil"])?;
    let product = *args.first()?;
    let (above, below) = forms.factors(forms.value(product));
    // With constants alone, it is a size as well: a share of the elements.
    let is_position = || above.iter().any(|&f| !is_count(shader, forms, f) && !is_number(shader, f));
    (below.is_empty() && above.iter().any(|&f| is_count(shader, forms, f)) && is_position()).then_some(product)
}

/// A constant number, or a vector of them.
fn is_number(shader: &Shader, id: ExprId) -> bool {
    match &shader.expr(id).kind {
        ExprKind::Call { callee: Callee::Type(_), args } => args.iter().all(|&arg| is_number(shader, arg)),
        _ => constant(shader, id).is_some(),
    }
}

/// Variables that something limits: operands of comparisons and of `min` and `clamp`.
fn limited(shader: &Shader) -> BTreeSet<SymbolId> {
    let operands = shader.arena().iter().flat_map(|(id, expr)| match &expr.kind {
        ExprKind::Binary {
            op: BinaryOp::Less | BinaryOp::Greater | BinaryOp::LessEqual | BinaryOp::GreaterEqual,
            op_span: _,
            left,
            right,
        } => vec![*left, *right],
        _ => builtin(shader, id, &["min", "clamp"]).map_or_else(Vec::new, |(_, args)| args.to_vec()),
    });
    operands.flat_map(|id| expressions(shader, id)).filter_map(|id| shader.symbol_of(id)).collect()
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let forms = Forms::new(shader);
    let mut limits = None;
    for (id, expr) in shader.arena().iter().filter(|(_, e)| !e.from_macro) {
        let (ExprKind::Call { callee: Callee::Type(_), args }, Some(CallTarget::Constructor(ty))) =
            (&expr.kind, shader.callee(id))
        else {
            continue;
        };
        let [inner] = args.as_slice() else { continue };
        if !ty.scalar().is_some_and(ScalarType::is_integer) {
            continue;
        }
        let inner = forms.value(*inner);
        let Some(product) = rounded(shader, &forms, inner) else { continue };
        let cut = |e: ExprId| {
            builtin(shader, e, &["min", "clamp"]).is_some()
                || matches!(shader.expr(e).kind, ExprKind::Binary { op: BinaryOp::Rem, .. })
        };
        let limits = limits.get_or_insert_with(|| limited(shader));
        let mut kept = false;
        declarators(shader, |d| {
            let whole = d.initializer.as_ref().is_some_and(|i| shader.expr(i.value).span.contains(expr.span.start));
            kept |=
                whole && shader.symbols().any(|(symbol, s)| s.span == Some(d.name.span) && limits.contains(&symbol));
        });
        if kept || forms.around(id).any(cut) {
            continue;
        }
        let text = shader.text_of(product);
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(product).span,
                    message!(
                        "`{text}` rounds up to the number of elements, which is one past the last",
                        "`{text}` は要素の数まで切り上がり、最後の要素を一つ超えます"
                    ),
                )
                .with_label(message!("up to the number of elements", "要素の数まで"))
                .with_why(message!(
                    "the last element has the number of elements less 1; `round` and `ceil` reach the number itself",
                    "最後の添字は要素数より 1 小さく、`round` と `ceil` は要素数に達します"
                ))
                .with_help(message!(
                    "multiply by the number less 1, or use `floor` and `min`",
                    "要素数から 1 を引いた値を掛けるか、`floor` と `min` を使ってください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::wgsl::testing::count;

    fn found(lines: &str) -> usize {
        count(
            "N039",
            &format!(
                "@group(0) @binding(0) var t: texture_2d<f32>;\nfn f(x: f32) -> vec4f {{\n\
                 let size = textureDimensions(t).xy;\n{lines}\nreturn textureLoad(t, vec2u(i, 0u), 0);\n}}\n"
            ),
        )
    }

    #[test]
    fn indices_that_reach_the_size_are_reported() {
        assert_eq!(found("let i = u32(round(x * f32(size.x)));"), 1);
        assert_eq!(found("let at = x * f32(size.x * size.y);\nlet n = u32(round(at)); let i = n / size.x;"), 1);
        assert_eq!(found("let i = u32(ceil(f32(size.x) * x));"), 1);
    }

    #[test]
    fn indices_inside_are_not() {
        assert_eq!(found("let i = u32(round(x * f32(size.x - 1u)));"), 0);
        assert_eq!(found("let i = u32(x * f32(size.x));"), 0);
        assert_eq!(found("let i = min(u32(round(x * f32(size.x))), size.x - 1u);"), 0);
        assert_eq!(found("var i = u32(round(x * f32(size.x))); i = min(i, size.x - 1u);"), 0);
        assert_eq!(found("let i = u32(round(x * f32(size.x))) % size.x;"), 0);
        assert_eq!(found("let i = u32(round(x * 4.0));"), 0);
        assert_eq!(found("let tile = vec2u(round(vec2(0.25, 0.3333) * vec2f(size)));"), 0);
        assert_eq!(found("let i = vec2u(round(vec2(x, 0.3333) * vec2f(size)));"), 1);
    }
}
