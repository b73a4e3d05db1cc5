//! W001: a barrier or a derivative in non-uniform control flow.

use std::collections::BTreeSet;

use crate::glsl::parted::with_condition;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::uniformity::{Parted, parted};
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
    let allowed = file.file.text().contains("derivative_uniformity");
    let mut all = BTreeSet::new();
    for entry in &module.entry_points {
        all.extend(parted(shader, module, entry));
    }
    let mut told = BTreeSet::new();
    for Parted { call, by, why: _, barrier } in all {
        if (allowed && !barrier) || !told.insert(call) {
            continue;
        }
        let span = shader.expr(call).span;
        let text = file.file.slice(span);
        let name = text.split('(').next().unwrap_or(text).trim_end();
        let why = if barrier {
            message!(
                "a barrier waits for all invocations of the work group, and some do not come here",
                "バリアはワークグループの全インベケーションを待ちますが、ここに来ないものがあります"
            )
        } else {
            message!(
                "a derivative is the difference to neighbouring pixels, which may be elsewhere",
                "微分は隣のピクセルとの差ですが、隣は別の所にいるかもしれません"
            )
        };
        let help = if barrier {
            message!("move it out of the condition", "条件の外に移してください")
        } else {
            message!(
                "call it before the condition, or state the level of detail (`textureSampleLevel`)",
                "条件の前で呼び出すか、詳細度を指定してください（`textureSampleLevel`）"
            )
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
}
