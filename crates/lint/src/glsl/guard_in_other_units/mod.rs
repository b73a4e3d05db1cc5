//! K003: a guard that counts in other units than the rows that its variable walks along.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::{Bound, Product, bounds, product, sum, sums};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::ast::{ExprId, ExprKind};
use syntax::{Shader, Stage};

use analysis::numeric::bare;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("K003"),
    name: "guard-in-other-units",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if shader.wgsl().is_none() && shader.stage() != Stage::Compute {
        return;
    }
    let bounds = bounds(shader);
    if bounds.is_empty() {
        return;
    }
    let mut told = Vec::new();
    for id in sums(shader) {
        let at = shader.expr(id).span.start;
        let terms = sum(shader, id);
        for step in &terms {
            let Some(variable) = step.only().filter(|_| step.times >= 1.0) else { continue };
            let guards = bounds.iter().filter(|b| b.of.text == variable.text && b.within.contains(at));
            for guard in guards.filter(|guard| !guard.below.factors.is_empty()) {
                // `y * width`, where `x < width` was asked for.
                let row = terms.iter().find(|term| {
                    term.times > 0.0 && term.without(&guard.below.factors).is_some_and(|rest| rest.len() == 1)
                });
                let Some(row) = row else { continue };
                // How many rows the variable reaches over.
                let rows = step.times * guard.below.times / row.times;
                // In `4 * y * width + x`, the rows are as long, and `y` counts four of them.
                let counts_rows = rows < 1.0 && guard.below.times >= 1.0;
                if rows == 1.0 || counts_rows || told.contains(&(guard.condition, variable.text.clone())) {
                    continue;
                }
                told.push((guard.condition, variable.text.clone()));
                let (name, condition, part) = (&variable.text, shader.text_of(guard.condition), 1.0 / rows);
                let (message, why) = if rows > 1.0 {
                    (
                        message!(
                            "`{name}` comes to {rows} rows here: `{condition}` counts in other units",
                            "`{name}` はここで {rows} 行分まで進みます。`{condition}` は別の単位で数えています"
                        ),
                        message!(
                            "invocations past the end of a row work on the rows behind it, and in the last row outside of the array",
                            "行の終わりを超えたインベケーションは次の行に、最後の行では配列の外に触れます"
                        ),
                    )
                } else {
                    (
                        message!(
                            "`{name}` fills 1/{part} of a row here: `{condition}` counts in other units",
                            "`{name}` はここで行の 1/{part} しか進みません。`{condition}` は別の単位で数えています"
                        ),
                        message!(
                            "where one invocation stands for several elements, the rows are shorter in the same measure",
                            "一つのインベケーションが複数の要素を受け持つなら、行の長さも同じ割合で短くなります"
                        ),
                    )
                };
                let found = findings
                    .at(&file.file, shader.expr(id).span, message)
                    .with_related(
                        &file.file,
                        shader.expr(guard.condition).span,
                        message!("what limits `{name}`", "`{name}` を制限する条件"),
                    )
                    .with_why(why)
                    .with_help(message!(
                        "count in the same units in the condition and in the index",
                        "条件と添字で同じ単位を使ってください"
                    ));
                // Half of a row may be meant: the other half is reached from there.
                let whole = || terms.len() == 2 && stands_for_several(shader, guard) && !goes_on(shader, step, row);
                findings.push_at(if rows > 1.0 || whole() { Level::Default } else { Level::Strict }, found);
            }
        }
    }
}

/// True for `4 * x >= width`, which says that an invocation stands for four elements; `x >= width / 4` may leave some out.
fn stands_for_several(shader: &Shader, guard: &Bound) -> bool {
    let ExprKind::Binary { left, right, .. } = shader.expr(bare(shader, guard.condition)).kind else { return false };
    let several = |id: ExprId| {
        let own = product(shader, id);
        own.times > 1.0 && own.only().is_some_and(|only| only.text == guard.of.text)
    };
    several(left) || several(right)
}

/// True where another index goes on from the same row and place: it reaches what this one leaves out.
fn goes_on(shader: &Shader, step: &Product, row: &Product) -> bool {
    sums(shader).into_iter().map(|id| sum(shader, id)).any(|terms| {
        let has = |product: &Product| terms.iter().any(|term| same(term, product));
        terms.len() > 2 && has(step) && has(row)
    })
}

fn same(a: &Product, b: &Product) -> bool {
    let texts = |product: &Product| product.factors.iter().map(|factor| factor.text.clone()).collect::<Vec<_>>();
    a.times == b.times && texts(a) == texts(b)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{default_count, strict_count};
    use super::*;
    use crate::wgsl::testing::count as in_wgsl;

    fn text(body: &str) -> String {
        format!(
            "#version 450\nlayout(local_size_x = 8, local_size_y = 8) in;\n\
             layout(std430, binding = 0) buffer D {{ float data[]; }};\nlayout(binding = 1) uniform P {{ int w, h; }} p;\n\
             void main()\n{{\n int x = int(gl_GlobalInvocationID.x);\n int y = int(gl_GlobalInvocationID.y);\n {body}\n}}\n"
        )
    }

    fn count(body: &str) -> usize {
        strict_count(RULE.code, "a.comp", &text(body))
    }

    #[test]
    fn an_invocation_for_several_elements_does_not_count_as_one() {
        let count = |body: &str| default_count(RULE.code, "a.comp", &text(body));
        assert_eq!(count("if (x * 4 >= p.w) return; data[y * p.w + x] = 1.0;"), 1);
        assert_eq!(count("if (x * 4 >= p.w) return; data[y * p.w / 4 + x] = 1.0;"), 0);
        assert_eq!(count("if (x >= p.w / 2) return; data[y * p.w + x] = 1.0;"), 0, "half of it may be meant");
        assert_eq!(count("if (x * 2 >= p.w) return; data[y * p.w + x] = data[y * p.w + x + p.w / 2];"), 0);
    }

    #[test]
    fn guards_of_elements_for_groups_are_reported() {
        assert_eq!(count("if (x >= p.w || y >= p.h) return; int i = y * p.w + x * 8; data[i] = 1.0;"), 1);
        assert_eq!(count("if (x < p.w && y < p.h) data[y * (p.w / 4) + x] = 1.0;"), 1);
        assert_eq!(count("if (x * 4 >= p.w) return; data[y * p.w + x] = 1.0;"), 1);
        assert_eq!(count("if (x >= p.w) return; data[(y * p.w >> 2) + x] = 1.0;"), 1);
    }

    #[test]
    fn guards_in_the_same_units_are_not() {
        assert_eq!(count("if (x >= p.w || y >= p.h) return; data[y * p.w + x] = 1.0;"), 0);
        assert_eq!(count("if (x * 8 >= p.w) return; int i = y * p.w + x * 8; data[i] = 1.0;"), 0);
        assert_eq!(count("if (x >= p.w / 4) return; data[y * p.w / 4 + x] = 1.0;"), 0);
        assert_eq!(count("if (x >= p.w) return; data[4 * (y * p.w + x)] = data[4 * y * p.w + 4 * x + 1];"), 0);
        assert_eq!(count("if (x >= p.w) return; data[y * p.h + x] = 1.0;"), 0, "another row");
        assert_eq!(count("if (x >= p.w) return; data[(4 * y) * p.w + x] = 1.0;"), 0, "every fourth row");
        assert_eq!(count("if (x >= p.w) return; x = 2 * y; data[y * p.w + 8 * x] = 1.0;"), 0, "another number");
    }

    #[test]
    fn kernels_in_wgsl_are_read() {
        let text = |step: &str| {
            format!(
                "@group(0) @binding(0) var<storage, read_write> d: array<f32>;\n@group(0) @binding(1) var<uniform> w: u32;\n\
                 @compute @workgroup_size(8, 8)\nfn main(@builtin(global_invocation_id) id: vec3u) {{\n  \
                 if id.x >= w {{ return; }}\n  d[id.y * w + {step}] = 1.0;\n}}\n"
            )
        };
        assert_eq!(in_wgsl("K003", &text("4u * id.x")), 1);
        assert_eq!(in_wgsl("K003", &text("id.x")), 0);
    }
}
