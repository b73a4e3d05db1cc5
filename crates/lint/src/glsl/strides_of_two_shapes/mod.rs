//! K007: an index with the strides of two shapes.

use std::collections::BTreeSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::{Factor, plain, sum, sums};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::ast::{Callee, ExprId, ExprKind};
use syntax::symbols::CallTarget;
use syntax::{Shader, Stage};

use analysis::forms::Forms;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("K007"),
    name: "strides-of-two-shapes",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Beginnings of names that tell two shapes apart.
const SHAPES: [&str; 8] = ["output", "out", "input", "in", "source", "src", "target", "dst"];

/// Variables that are followed to what they are declared as.
const DEEPEST: u32 = 3;

/// A stride, and the term of the sum that it stands in.
type Stride = (String, usize);

/// The strides of an index, in variables that it is made of as well.
fn strides(shader: &Shader, forms: &Forms<'_>, id: ExprId, depth: u32, term: &mut usize, into: &mut Vec<Stride>) {
    // What is subtracted makes a remainder, as in `i - y * width`.
    for product in sum(shader, id).into_iter().filter(|product| product.times > 0.0) {
        *term += 1;
        // `offset`, and not `2 * width`, which is a stride.
        if let ([only], true) = (product.factors.as_slice(), product.times.abs() == 1.0) {
            let value = forms.value(only.id);
            let number = !matches!(shader.expr(value).kind, ExprKind::Call { .. });
            if value != only.id && number && depth < DEEPEST {
                strides(shader, forms, value, depth + 1, term, into);
            }
            continue;
        }
        for factor in &product.factors {
            into.extend(named(shader, forms, factor).into_iter().map(|name| (name, *term)));
        }
    }
}

/// The names that a factor stands for: its own, or those in a vector of strides of which it is a component.
fn named(shader: &Shader, forms: &Forms<'_>, factor: &Factor) -> Vec<String> {
    let last = |text: &str| text.rsplit('.').next().unwrap_or("").to_owned();
    if let ExprKind::Index { base, .. } = shader.expr(factor.id).kind {
        let vector = forms.value(base);
        let ExprKind::Call { callee: Callee::Type(_), args } = &shader.expr(vector).kind else { return Vec::new() };
        if !matches!(shader.callee(vector), Some(CallTarget::Constructor(_))) {
            return Vec::new();
        }
        let name = |arg: &ExprId| {
            let id = plain(shader, *arg);
            matches!(shader.expr(id).kind, ExprKind::Name(_) | ExprKind::Field { .. }).then(|| last(shader.text_of(id)))
        };
        return args.iter().filter_map(name).collect();
    }
    factor.symbol.map(|_| last(&factor.text)).into_iter().collect()
}

/// True for `outw` and `w`, `in_stride` and `stride`.
fn is_of_other_shape(long: &str, short: &str) -> bool {
    let long = long.to_lowercase();
    let rest = SHAPES.iter().find_map(|shape| long.strip_prefix(shape)).map(|rest| rest.trim_start_matches('_'));
    !short.is_empty() && rest == Some(&short.to_lowercase())
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if shader.wgsl().is_none() && shader.stage() != Stage::Compute {
        return;
    }
    let forms = Forms::new(shader);
    let mut told = BTreeSet::new();
    for id in sums(shader) {
        let mut all = Vec::new();
        strides(shader, &forms, id, 0, &mut 0, &mut all);
        let pair = all.iter().find_map(|(long, at)| {
            let (short, _) = all.iter().find(|(short, other)| other != at && is_of_other_shape(long, short))?;
            // `c * outc` is an array of both.
            let both = all.iter().any(|(name, at)| name == long && all.contains(&(short.clone(), *at)));
            (!both).then_some((long, short))
        });
        let Some((long, short)) = pair else { continue };
        if !told.insert((long.clone(), short.clone())) {
            continue;
        }
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(id).span,
                    message!(
                        "`{long}` and `{short}` are both strides of this index",
                        "この添字の間隔に `{long}` と `{short}` の両方が使われています"
                    ),
                )
                .with_why(message!(
                    "an index leads into one array, and their names say that they belong to two",
                    "添字は一つの配列の中を指しますが、名前からは二つの配列の間隔です"
                ))
                .with_help(message!(
                    "use the strides of the array that is indexed",
                    "添字を付ける配列の間隔を使ってください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::default_count;
    use super::*;

    fn count(body: &str) -> usize {
        let text = format!(
            "#version 450\nlayout(local_size_x = 8, local_size_y = 8) in;\n\
             layout(std430, binding = 0) buffer D {{ float d[]; }};\n\
             layout(binding = 1) uniform P {{ int w, step, outw, outstep; }} p;\n\
             void main()\n{{\n int x = int(gl_GlobalInvocationID.x);\n int y = int(gl_GlobalInvocationID.y);\n \
             int z = int(gl_GlobalInvocationID.z);\n {body}\n}}\n"
        );
        default_count(RULE.code, "a.comp", &text)
    }

    #[test]
    fn strides_of_two_shapes_are_reported() {
        assert_eq!(count("d[z * p.step + y * p.w + z * p.outw + x] = 1.0;"), 1);
        assert_eq!(count("int a = z * p.step + y * p.w + x; int b = a + 2 * p.outstep * z; d[b] = 1.0;"), 1);
        assert_eq!(
            count("ivec3 s = ivec3(1, p.outw, p.outstep); int a = z * p.step + y * p.w; d[a + 3 * s[z]] = 1.0;"),
            1
        );
    }

    #[test]
    fn strides_of_one_shape_are_not() {
        assert_eq!(count("d[z * p.outstep + y * p.outw + x] = d[z * p.step + y * p.w + x];"), 0);
        assert_eq!(count("int a = (z * p.outw + x) * p.w; d[a] = 1.0;"), 0, "a matrix of one by the other");
        assert_eq!(count("d[z * p.w * p.outw + y * p.w + x] = 1.0;"), 0, "an array of both");
        assert_eq!(count("int c = x / p.outw; int r = x - c * p.outw; d[c * p.w + r] = 1.0;"), 0, "a remainder");
        assert_eq!(count("ivec3 s = ivec3(1, p.w, p.step); int a = z * p.step + y * p.w; d[a + 3 * s[z]] = 1.0;"), 0);
    }
}
