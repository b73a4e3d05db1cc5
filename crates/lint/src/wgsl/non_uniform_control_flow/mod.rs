//! W001: a barrier, a derivative or an operation of a subgroup in non-uniform control flow.

use std::collections::BTreeSet;

use crate::glsl::parted::with_condition;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::uniformity::{Parted, Together, parted};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::wgsl::Module;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W001"),
    name: "non-uniform-control-flow",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Wgsl(check),
};

fn check(file: &ShaderFile, module: &Module, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    // An engine may put what decides into the text.
    if module.varies {
        return;
    }
    let says = |words: &str| file.file.text().contains(words);
    let mut all = BTreeSet::new();
    for entry in &module.entry_points {
        all.extend(parted(shader, module, entry));
    }
    let mut told = BTreeSet::new();
    for Parted { call, by, why: _, what } in all {
        let allowed = match what {
            Together::Barrier => false,
            Together::Derivative => says("derivative_uniformity"),
            // A module that does not enable them is for a compiler with rules of its own.
            Together::Subgroup => says("subgroup_uniformity") || !says("enable subgroups"),
        };
        if allowed || !told.insert(call) {
            continue;
        }
        let span = shader.expr(call).span;
        let text = file.file.slice(span);
        let name = text.split(['(', '<']).next().unwrap_or(text).trim_end();
        let (why, help) = match what {
            Together::Barrier => (
                message!(
                    "a barrier waits for all invocations of the work group, and some do not come here",
                    "バリアはワークグループの全インベケーションを待ちますが、ここに来ないものがあります"
                ),
                message!("move it out of the condition", "条件の外に移してください"),
            ),
            Together::Derivative => (
                message!(
                    "a derivative is the difference to neighbouring pixels, which may be elsewhere",
                    "微分は隣のピクセルとの差ですが、隣は別の所にいるかもしれません"
                ),
                message!(
                    "call it before the condition, or state the level of detail (`textureSampleLevel`)",
                    "条件の前で呼び出すか、詳細度を指定してください（`textureSampleLevel`）"
                ),
            ),
            Together::Subgroup => (
                message!(
                    "what it gives depends on which invocations come here, and browsers refuse the module",
                    "結果は、どのインベケーションがここに来るかで変わります。ブラウザはこのモジュールを拒否します"
                ),
                message!(
                    "call it before the condition, with a neutral value where the condition does not hold, or write \
                     `diagnostic(off, subgroup_uniformity);`",
                    "条件の前で呼び出し、条件の成り立たない所では中立の値を渡すか、\
                     `diagnostic(off, subgroup_uniformity);` を書いてください"
                ),
            ),
        };
        let found = findings.at(
            &file.file,
            span,
            message!(
                "`{name}` stands where not all invocations come",
                "`{name}` が、全インベケーションの来ない所にあります"
            ),
        );
        findings.push(with_condition(found, file, by).with_why(why).with_help(help));
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::count;

    fn fragment(body: &str) -> usize {
        let text = format!(
            "struct U {{ flag: u32, }}\n@group(0) @binding(0) var<uniform> u: U;\n\
             @group(0) @binding(1) var t: texture_2d<f32>;\n@group(0) @binding(2) var s: sampler;\n\
             fn sampled(uv: vec2f) -> vec4f {{ return textureSample(t, s, uv); }}\n\
             @fragment fn main(@location(0) uv: vec2f) -> @location(0) vec4f {{\n var c = vec4f();\n {body}\n return c;\n}}\n"
        );
        count("W001", &text)
    }

    #[test]
    fn derivatives_of_parted_invocations_are_reported() {
        assert_eq!(fragment("if uv.x > 0.5 { c = textureSample(t, s, uv); }"), 1);
        assert_eq!(fragment("if uv.x > 0.5 { return c; } c = sampled(uv);"), 1);
        assert_eq!(fragment("for (var i = 0.0; i < uv.x; i += 1.0) { c += sampled(uv); }"), 1);
        assert_eq!(fragment("let far = uv.x > 0.5; if far && u.flag > 0 { c.x = fwidth(uv.x); }"), 1);
        assert_eq!(fragment("for (var i = 0; i < 4; i++) { c += sampled(uv); if c.x > 1.0 { break; } }"), 1);
    }

    #[test]
    fn those_of_invocations_together_are_not() {
        assert_eq!(fragment("if u.flag > 0 { c = sampled(uv); }"), 0);
        assert_eq!(fragment("if u.flag > 0 { return c; } c = sampled(uv);"), 0);
        assert_eq!(fragment("if uv.x > 0.5 { c.x = 1.0; } c += sampled(uv);"), 0);
        assert_eq!(fragment("if uv.x > 0.5 { c = textureSampleLevel(t, s, uv, 0.0); }"), 0);
        assert_eq!(fragment("for (var i = 0; i < 4; i++) { c += sampled(uv); }"), 0);
        assert_eq!(fragment("for (var i = 0.0; i < uv.x; i += 1.0) { c.x += i; } c += sampled(uv);"), 0);
        assert_eq!(fragment("if uv.x > 0.5 { discard; } c = sampled(uv);"), 0);
        assert_eq!(fragment("switch u.flag { case 0u: { c = sampled(uv); } default { } } c += sampled(uv);"), 0);
    }

    #[test]
    fn barriers_are_held_to_the_work_group() {
        let compute = |body: &str| {
            count(
                "W001",
                &format!(
                    "@group(0) @binding(0) var<storage, read_write> d: array<f32>;\nvar<workgroup> w: array<f32, 64>;\n\
                 @compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32, @builtin(workgroup_id) g: vec3u) {{\n\
                 w[i] = d[i];\n{body}\nd[i] = w[i];\n}}\n"
                ),
            )
        };
        assert_eq!(compute("if i < 32 { workgroupBarrier(); }"), 1);
        assert_eq!(compute("if i >= arrayLength(&d) { return; } workgroupBarrier();"), 1);
        assert_eq!(compute("if g.x < 32 { workgroupBarrier(); }"), 0);
        assert_eq!(
            compute("for (var k = 32u; k > 0; k >>= 1) { if i < k { w[i] += w[i + k]; } workgroupBarrier(); }"),
            0
        );
        // What a function gives that nothing declares may be the same for all; what parts them beside it parts them.
        assert_eq!(compute("if i >= arrayLength(&d) { return; } d[i] = hash(i); workgroupBarrier();"), 1);
        assert_eq!(compute("if hash(i) > 1.0 { workgroupBarrier(); }"), 0);
        assert_eq!(compute("let n = chosen(i, d[i]) + vec2f(hash(i)).x; if n > 1.0 { workgroupBarrier(); }"), 0);
        assert_eq!(compute("var n = i; broadcast(&n); if n > 1u { workgroupBarrier(); }"), 0);
        assert_eq!(compute("let n = workgroupUniformLoad(&w); if n[0] > 1.0 { workgroupBarrier(); }"), 0);
    }
    #[test]
    fn operations_of_subgroups_are_held_to_those_that_enable_them() {
        let compute = |head: &str, body: &str| {
            let text = format!(
                "{head}\n@group(0) @binding(0) var<storage, read_write> d: array<u32>;\n@compute @workgroup_size(64)\n\
                 fn main(@builtin(global_invocation_id) g: vec3u, @builtin(subgroup_size) n: u32) {{\n\
                 var x = d[g.x];\n{body}\nd[g.x] = x;\n}}\n"
            );
            count("W001", &text)
        };
        let enabled = "enable subgroups;";
        assert_eq!(compute(enabled, "if x > 3u { x = subgroupAdd(x); }"), 1);
        assert_eq!(compute(enabled, "if g.x >= arrayLength(&d) { return; } x = subgroupShuffleXor(x, 1u);"), 1);
        assert_eq!(compute(enabled, "if (g.x & 4u) == 0u { x = quadSwapX(x); }"), 1);
        assert_eq!(compute(enabled, "if subgroupElect() { workgroupBarrier(); }"), 1);
        assert_eq!(compute(enabled, "x = subgroupAdd(select(0u, x, x > 3u)); if x > 3u { x = 1u; }"), 0);
        assert_eq!(compute(enabled, "if n > 16u { x = subgroupAdd(x); }"), 0);
        assert_eq!(compute("", "if x > 3u { x = subgroupAdd(x); }"), 0);
        let off = "enable subgroups;\ndiagnostic(off, subgroup_uniformity);";
        assert_eq!(compute(off, "if x > 3u { x = subgroupAdd(x); }"), 0);
    }
}
