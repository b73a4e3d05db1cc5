//! K004: rows as long as there are workgroups, walked along by invocations.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::{Factor, kernels, plain, sum, sums};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;

use analysis::forms::Forms;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("K004"),
    name: "rows-counted-in-workgroups",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let kernels = kernels(shader);
    if kernels.is_empty() {
        return;
    }
    let forms = Forms::new(shader);
    for id in sums(shader) {
        let terms = sum(shader, id);
        for kernel in &kernels {
            let value = |factor: &Factor| plain(shader, forms.value(plain(shader, factor.id)));
            let invocation =
                |f: &Factor| kernel.axis_of(shader, value(f), "global_invocation_id", "gl_GlobalInvocationID");
            let groups = |f: &Factor| kernel.axis_of(shader, value(f), "num_workgroups", "gl_NumWorkGroups");
            let own = terms.iter().find_map(|term| term.only().filter(|_| term.times == 1.0).and_then(invocation));
            let Some((axis, size)) = own.zip(kernel.size).map(|(axis, size)| (axis, f64::from(size[axis]))) else {
                continue;
            };
            let row = terms.iter().find(|term| {
                term.factors.len() == 2
                    && term.factors.iter().any(|f| groups(f) == Some(axis))
                    && term.factors.iter().any(|f| invocation(f).is_some_and(|other| other != axis))
            });
            let Some(row) = row.filter(|row| row.times > 0.0 && row.times < size) else { continue };
            let (text, step) = (shader.text_of(id), row.times);
            let letter = ["x", "y", "z"][axis];
            findings.push(
                findings
                    .at(
                        &file.file,
                        shader.expr(id).span,
                        message!(
                            "invocations of several rows come to the same `{text}`",
                            "`{text}` は複数の行のインベケーションで同じ値になります"
                        ),
                    )
                    .with_why(message!(
                        "a row has {size} invocations for each workgroup along {letter}, and the next row begins after {step}",
                        "一行には {letter} 方向のワークグループごとに {size} 個のインベケーションがあり、次の行は {step} 個後に始まっています"
                    ))
                    .with_help(message!(
                        "multiply the number of workgroups by {size}, the size of one",
                        "ワークグループの数に大きさ {size} を掛けてください"
                    )),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::strict_count;
    use crate::wgsl::testing::count;

    fn module(size: &str, index: &str) -> usize {
        let text = format!(
            "@group(0) @binding(0) var<storage, read_write> d: array<f32>;\n@compute @workgroup_size({size})\n\
             fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) n: vec3u) {{\n  \
             let x = id.x;\n  let groups = n.x;\n  let i = {index};\n  if i < 9u {{ d[i] = 1.0; }}\n}}\n"
        );
        count("K004", &text)
    }

    #[test]
    fn rows_that_overlap_are_reported() {
        assert_eq!(module("16, 16", "x + id.y * groups"), 1);
        assert_eq!(module("16, 16", "id.x + n.x * id.y * 8u"), 1);
        let text = "#version 450\nlayout(local_size_x = 16, local_size_y = 16) in;\n\
            layout(std430, binding = 0) buffer D { float d[]; };\n\
            void main() { d[gl_GlobalInvocationID.y * gl_NumWorkGroups.x + gl_GlobalInvocationID.x] = 1.0; }\n";
        assert_eq!(strict_count(super::RULE.code, "a.comp", text), 1);
    }

    #[test]
    fn rows_as_long_as_they_are_are_not() {
        assert_eq!(module("16, 16", "x + id.y * groups * 16u"), 0);
        assert_eq!(module("1, 16", "x + id.y * groups"), 0);
        assert_eq!(module("16, 16", "x + id.y * 32u"), 0);
    }
}
