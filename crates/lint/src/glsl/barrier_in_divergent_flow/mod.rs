//! K008: a barrier to which not all invocations of a work group come.

use std::collections::BTreeSet;

use super::parted::with_condition;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::{Split, kernels, splits};
use analysis::uniformity::{Parted, parted_barriers};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("K008"),
    name: "barrier-in-divergent-flow",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if super::has_errors(shader) {
        return;
    }
    let mut told = BTreeSet::new();
    for kernel in kernels(shader) {
        if kernel.size == Some([1, 1, 1]) {
            continue;
        }
        let splits = splits(shader, &kernel);
        for Parted { call, by, why, what: _ } in parted_barriers(shader, &kernel, &splits) {
            // Without the size of a group, an axis may have one invocation, which a guard on it does not part. One
            // condition is told once, at the first of its barriers.
            if (kernel.size.is_none() && why.by_dispatch_alone()) || !told.insert(by) {
                continue;
            }
            let apart = match splits.get(&by) {
                Some(Split::Apart(a, b)) => Some((a, b)),
                _ => None,
            };
            // A host may fill its work groups, so that a guard holds for all invocations of each.
            let level = if apart.is_none() && why.by_dispatch_alone() { Level::Strict } else { Level::Default };
            let why = match apart {
                Some((a, b)) => message!(
                    "invocations {a} and {b} of a work group part there, and a barrier waits for all of them",
                    "ワークグループのインベケーション {a} と {b} がそこで分かれますが、バリアは全員を待ちます"
                ),
                None if level == Level::Strict => message!(
                    "a barrier waits for all invocations of the work group; those past the end of the data do not come",
                    "バリアはワークグループの全インベケーションを待ちますが、データの終わりを超えたものは来ません"
                ),
                None => message!(
                    "a barrier waits for all invocations of the work group, and some may not come here",
                    "バリアはワークグループの全インベケーションを待ちますが、ここに来ないものがありえます"
                ),
            };
            let found = findings.at(
                &file.file,
                shader.expr(call).span,
                message!(
                    "this barrier stands where not all invocations come",
                    "このバリアは、全インベケーションの来ない所にあります"
                ),
            );
            findings.push_at(
                level,
                with_condition(found, file, by).with_why(why).with_help(message!(
                    "move it out of the condition; instead of returning early, guard what reads and writes",
                    "条件の外に移してください。早く戻る代わりに、読み書きだけを条件で囲んでください"
                )),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{default_count, strict_count};
    use super::RULE;

    fn text(body: &str) -> String {
        format!(
            "#version 450\nlayout(local_size_x = 64) in;\nlayout(std430, binding = 0) buffer D {{ uint n; uint data[]; }};\n\
             layout(binding = 1) uniform U {{ uint count; }};\nshared uint s[64];\nshared bool done;\nuint last = 0u;\n\
             void wait() {{ barrier(); }}\nbool small(uint k) {{ return k < 5u; }}\n\
             void main()\n{{\n uint i = gl_LocalInvocationID.x;\n {body}\n}}\n"
        )
    }

    /// Findings by default, and at the strict level.
    fn both(body: &str) -> [usize; 2] {
        [default_count(RULE.code, "a.comp", &text(body)), strict_count(RULE.code, "a.comp", &text(body))]
    }

    #[test]
    fn barriers_that_some_do_not_reach_are_reported() {
        for body in [
            "if (i < 32u) barrier();",
            "if (i >= count) return; barrier();",
            "if (data[i] > 3u) { s[i] = 1u; barrier(); }",
            "for (uint k = 0u; k < 8u; k++) { if (data[i] > k) break; barrier(); }",
            "for (uint k = 0u; k < 8u; k++) { if (data[i] > k) continue; barrier(); }",
            "for (uint k = i; k < count; k += 64u) { barrier(); }",
            "if (small(i)) wait();",
            "last = data[i]; if (last == 0u) barrier();",
            "bool out_ = false; if (i == 3u) out_ = true; if (out_) return; barrier();",
            "while (atomicAdd(n, 1u) < 7u) { barrier(); }",
            "switch (data[i]) { case 0u: barrier(); break; default: break; }",
            "if (gl_GlobalInvocationID.x >= count || i > 40u) return; barrier();",
            "if (i >= count) return; barrier(); s[i] = 1u; barrier();",
            "if (i >= data[gl_WorkGroupID.x]) return; barrier();",
        ] {
            assert_eq!(both(body), [1, 1], "{body}");
        }
    }

    #[test]
    fn a_guard_on_the_whole_dispatch_is_reported_on_request() {
        assert_eq!(both("if (gl_GlobalInvocationID.x >= count) return; barrier();"), [0, 1]);
        assert_eq!(both("uint g = gl_WorkGroupID.x * 64u + i; if (g < n) { barrier(); }"), [0, 1]);
    }

    #[test]
    fn those_that_all_reach_are_not() {
        for body in [
            "barrier();",
            "if (count > 4u) barrier();",
            "if (gl_WorkGroupID.x >= count) return; barrier();",
            "if (data[gl_WorkGroupID.x] > 4u) { barrier(); }",
            "if (i == 0u) done = data[0] > 3u; barrier(); if (done) return; barrier();",
            "for (uint k = 32u; k > 0u; k >>= 1) { if (i < k) s[i] += s[i + k]; barrier(); }",
            "if (i >= 64u) return; barrier();",
            "for (uint k = i; k < 256u; k += 64u) { s[i] = data[k]; barrier(); }",
            "for (uint k = 0u; k < count; k++) { if (data[i] > k) continue; s[i] += k; } barrier();",
            "if (i < 32u) { s[i] = 1u; } else { s[i] = 2u; } barrier();",
            "if (count > 3u && n > 2u) barrier();",
            "uint k = i; k = count; if (k > 3u) barrier();",
            "if (i < 3u) memoryBarrierShared();",
            "for (uint k = gl_WorkGroupID.x * count + i; k < n * count + i; k += count) { barrier(); }",
        ] {
            assert_eq!(both(body), [0, 0], "{body}");
        }
        let alone = text("if (i < n) barrier();").replace("local_size_x = 64", "local_size_x = 1");
        assert_eq!(strict_count(RULE.code, "a.comp", &alone), 0, "a group of one waits for nobody");
    }
}
