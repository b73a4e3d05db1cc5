//! N009: division by what can be zero.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::{Evidence, Range};
use base::diagnostic::{Code, Severity, message};
use reading::{Project, ShaderFile};
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};

use analysis::forms::{Forms, builtin};
use analysis::numeric::calls;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N009"),
    name: "division-by-zero",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

fn level(divisor: &Range) -> Option<Level> {
    if divisor.shows_zero() {
        return Some(Level::Default);
    }
    let through = divisor.goes_below(0.0, Evidence::Nature) && divisor.goes_above(0.0, Evidence::Nature);
    // `1 + cos(a)`: the end that the function reaches.
    let met = |end: f64, by: Evidence| end == 0.0 && by >= Evidence::Nature;
    let touches = divisor.is_finite() && (met(divisor.lo, divisor.lo_by) || met(divisor.hi, divisor.hi_by));
    ((through || touches) && !divisor.excludes_zero()).then_some(Level::Strict)
}

/// True for the distance of two points, or a product with one: 0 where they meet.
fn is_distance(forms: &Forms<'_>, divisor: ExprId) -> bool {
    forms.factors(forms.value(divisor)).0.into_iter().any(|f| forms.between(f).is_some())
}

/// True for a component of a texel, which is 0 where the image is black or clear.
fn is_texel(shader: &Shader, forms: &Forms<'_>, divisor: ExprId) -> bool {
    let mut id = forms.value(divisor);
    while let ExprKind::Field { base, field: _ } = shader.expr(id).kind {
        id = forms.value(base);
    }
    builtin(shader, id, &["texture", "texture2D", "textureLod", "textureCube", "texelFetch", "imageLoad"]).is_some()
}

/// All divisions: the expression and its divisor.
pub(super) fn divisions(shader: &Shader) -> impl Iterator<Item = (ExprId, ExprId)> {
    let operators = shader.arena().iter().filter_map(|(id, expr)| match expr.kind {
        ExprKind::Binary { op: BinaryOp::Div | BinaryOp::Rem, op_span: _, left: _, right } => Some((id, right)),
        ExprKind::Assign { op: Some(BinaryOp::Div | BinaryOp::Rem), op_span: _, target: _, value } => Some((id, value)),
        _ => None,
    });
    operators.chain(calls(shader, &["mod"]).filter_map(|c| Some((c.id, *c.args.get(1)?))))
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    let mut forms = None;
    for (id, divisor) in divisions(shader) {
        let all = || observed.visits(id).iter().filter_map(|v| v.operands.get(1)).flat_map(|v| &v.parts);
        let mut found = all().filter_map(level).min();
        if found.is_none() && all().any(|r| !r.excludes_zero()) {
            let forms = forms.get_or_insert_with(|| Forms::new(shader));
            let zero = is_distance(forms, divisor) || is_texel(shader, forms, divisor);
            found = zero.then_some(Level::Strict);
        }
        let Some(level) = found else { continue };
        let integer = shader.type_of(divisor).scalar().is_some_and(|s| s.is_integer());
        let why = if integer && file.is_wgsl() {
            message!(
                "an integer divided by 0 gives the dividend, and its remainder is 0",
                "整数を 0 で割ると被除数がそのまま返り、剰余は 0 になります"
            )
        } else if integer {
            message!("an integer divided by 0 is undefined", "整数を 0 で割った結果は未定義です")
        } else {
            message!("the quotient is infinite or NaN, or anything else", "商は無限大か NaN、あるいは別の値になります")
        };
        findings.push_at(
            level,
            findings
                .at(
                    &file.file,
                    shader.expr(divisor).span,
                    message!("this divisor can be 0", "この除数は 0 になりえます"),
                )
                .with_label(message!("0 is possible", "0 になりえます"))
                .with_why(why)
                .with_help(message!(
                    "keep the divisor away from 0, or divide only where it is not 0",
                    "除数が 0 にならないようにするか、0 でないところだけで割ってください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use super::*;

    #[test]
    fn divisors_that_can_be_zero_are_reported() {
        rings(
            "N009",
            Level::Default,
            &[
                "r = 1.0 / max(s, 0.0);",
                "r = s / 0.0;",
                "r = s / declared;",
                "r /= clamp(s, 0.0, 1.0);",
                "v = p / max(q, 0.0);",
                "int i = 7; int j = 0; r = float(i / j);",
                "r = mod(s, 0.0);",
                "for (int i = 0; i < 4; ++i) r += 1.0 / float(i);",
                "for (int i = 0; i < 4; ++i) r += float(7 % i);",
            ],
        );
        rings("N009", Level::Strict, &["r = 1.0 / (1.0 + cos(s));", "r = s / (sin(t) - 1.0);"]);
        rings("N009", Level::Strict, &["r = cos(s) / sin(t);", "r = 1.0 / dot(normalize(p), normalize(q));"]);
        rings(
            "N009",
            Level::Strict,
            &[
                "r = 1.0 / distance(p, q);",
                "vec3 d = q - p; r = s / dot(d, d);",
                "vec3 d = q - p; float l = length(d); r = s / (l * l);",
                "v = (q - p) / length(q - p);",
                "vec4 c = texture(image, p.xy); v = c.rgb / c.a;",
                "v = p / texture(image, p.xy).a;",
            ],
        );
    }

    #[test]
    fn what_an_entry_point_sets_is_not_what_it_began_with() {
        let count = |set: &str| {
            let text = format!(
                "var<private> size: f32 = 0.0;\nfn texel() -> f32 {{ return 3.0 / size; }}\n\
                 @fragment fn shade() -> @location(0) vec4f {{ {set} return vec4f(texel()); }}\n"
            );
            super::super::testing::found("N009", "a.wgsl", &text).len()
        };
        assert_eq!((count("size = 4.0;"), count("")), (0, 1));
    }

    #[test]
    fn others_are_not() {
        silent(
            "N009",
            Level::Heuristic,
            &[
                "r = s / t;",
                "v = p / length(p);",
                "float d = distance(p, q); if (d > 0.0) r = s / d;",
                "vec4 c = texture(image, p.xy); v = c.rgb / max(c.a, 0.01);",
                "vec4 c = texture(image, p.xy); if (c.a > 0.0) v = c.rgb / c.a;",
                "float d = distance(p, q); r = s / (1.0 + d * d);",
                "r = 1.0 / (1.0 + max(s, 0.0));",
                "r = s / max(t, 1e-6);",
                "float d = max(s, 0.0); if (d > 0.0) r = 1.0 / d;",
                "float d = max(s, 0.0); if (d != 0.0) r = 1.0 / d;",
                "float d = max(s, 0.0); r = d == 0.0 ? 0.0 : 1.0 / d;",
                "for (int i = 1; i < 4; ++i) r += 1.0 / float(i);",
                "for (int i = 0; i < 4; ++i) r += float(i) / 4.0;",
                "int n = 0; for (int i = 0; i < 4; ++i) { if (p.x > float(i)) ++n; } if (n > 0) r = 1.0 / float(n);",
                "r = 1.0 / (0.1 + s * s);",
                "float sum = 0.0; for (int i = 0; i < 4; ++i) sum += 1.0; r = 1.0 / sum;",
            ],
        );
    }

    #[test]
    fn a_constant_that_a_host_sets_has_any_value() {
        let text = |id: &str| {
            format!(
                "#version 450\n{id}const int SIZE = 0;\nconst float HALF = 0.5 * float(SIZE);\n\
                 layout(location = 0) out vec4 o;\nvoid main() {{ o = vec4(1.0 / float(SIZE), 1.0 / HALF, 0.0, 1.0); }}\n"
            )
        };
        let count = |id: &str| super::super::testing::default_count(RULE.code, "a.frag", &text(id));
        assert_eq!([count("layout(constant_id = 0) "), count("")], [0, 2]);
    }
}
