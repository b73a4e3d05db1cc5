//! K010: invocations of a work group index shared memory past its end.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::{Beyond, beyond, kernels};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("K010"),
    name: "index-past-shared-array",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if super::has_errors(shader) {
        return;
    }
    for kernel in kernels(shader) {
        for Beyond { symbol, span, invocation, index, elements } in beyond(shader, &kernel) {
            let name = &shader.symbol(symbol).name;
            findings.push(
                findings
                    .at(
                        &file.file,
                        span,
                        message!(
                            "invocation {invocation} of a work group has the index {index} here, of {elements} elements",
                            "ワークグループのインベケーション {invocation} の添字はここで {index} ですが、要素は {elements} 個です"
                        ),
                    )
                    .with_label(message!("past the end of `{name}`", "`{name}` の範囲外"))
                    .with_why(message!(
                        "the work group has more invocations than the array has elements, and no condition keeps them away",
                        "ワークグループのインベケーションが配列の要素より多く、条件で除かれていません"
                    ))
                    .with_help(message!(
                        "compare the index with the length of the array, or give it an element for each invocation",
                        "添字を配列の長さと比べるか、インベケーションごとの要素を用意してください"
                    )),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::found;
    use crate::wgsl;

    fn glsl(body: &str) -> usize {
        let text = format!(
            "#version 450\nlayout(local_size_x = 32, local_size_y = 6) in;\nlayout(std430, binding = 0) buffer D {{ uint n; uint data[]; }};\n\
             shared uint s[120];\nshared vec4 grid[8][32];\n\
             void main()\n{{\n uint i = gl_LocalInvocationIndex;\n uvec2 at = gl_LocalInvocationID.xy;\n {body}\n}}\n"
        );
        found("K010", "a.comp", &text).len()
    }

    #[test]
    fn indices_past_the_end_are_reported() {
        assert_eq!(glsl("s[i] = data[i];"), 1);
        assert_eq!(glsl("uint k = i + 4u; data[i] = s[k % 121u];"), 1);
        assert_eq!(glsl("if (i < 121u) s[i] = data[i];"), 1);
        assert_eq!(glsl("grid[at.y + 3u][at.x] = vec4(1.0);"), 1);
        assert_eq!(glsl("for (uint k = i; k < 256u; k += 192u) s[k] = 0u;"), 1);
        let text = "var<workgroup> s: array<u32, 60>;\n@compute @workgroup_size(64)\n\
            fn main(@builtin(local_invocation_index) i: u32) { s[i] = 1u; }\n";
        assert_eq!(wgsl::testing::count("K010", text), 1);
    }

    #[test]
    fn guarded_and_unknown_ones_are_not() {
        assert_eq!(glsl("if (i < 120u) s[i] = data[i];"), 0);
        assert_eq!(glsl("if (i >= 120u) return; s[i] = data[i];"), 0);
        assert_eq!(glsl("for (uint k = i; k < 120u; k += 192u) s[k] = 0u;"), 0);
        assert_eq!(glsl("data[i] = i < 120u ? s[i] : 0u;"), 0);
        assert_eq!(glsl("if (i < 120u && s[i] > 3u) data[i] = 1u;"), 0);
        assert_eq!(glsl("if (i < n) s[i] = data[i];"), 0, "data decides");
        assert_eq!(glsl("s[min(i, 119u)] = data[i]; data[i] = s[i % 120u];"), 0);
        assert_eq!(glsl("grid[at.y][at.x] = vec4(1.0);"), 0);
    }
}
