use super::super::testing::found;
use crate::wgsl;

/// How often the rule speaks of a kernel in GLSL with this body.
fn glsl(body: &str) -> usize {
    let text = format!(
        "#version 430\nlayout(local_size_x = 64) in;\nlayout(std430, binding = 0) buffer D {{ uint n; uint data[]; }};\n\
         shared uint s[64];\nshared uint one;\nshared vec4 v[64];\n\
         uint before(uint k) {{ return s[k - 1u]; }}\n\
         void main()\n{{\n uint i = gl_LocalInvocationID.x;\n {body}\n}}\n"
    );
    found("K001", "a.comp", &text).len()
}

/// The same for WGSL.
fn wgsl(body: &str) -> usize {
    let text = format!(
        "@group(0) @binding(0) var<storage, read_write> data: array<u32>;\nvar<workgroup> s: array<u32, 64>;\n\
         var<workgroup> one: u32;\nvar<workgroup> h: array<atomic<u32>, 64>;\n\
         @compute @workgroup_size(64) fn main(@builtin(local_invocation_id) id: vec3u, @builtin(workgroup_id) g: vec3u) {{\n\
         let i = id.x;\n{body}\n}}\n"
    );
    wgsl::testing::count("K001", &text)
}

#[test]
fn reads_of_what_others_write_are_reported() {
    assert_eq!(glsl("s[i] = data[i]; data[i] = s[63u - i];"), 1);
    assert_eq!(glsl("s[i] = data[i]; if (i > 0u) data[i] = s[i - 1u];"), 1);
    assert_eq!(glsl("s[i] = data[i]; data[i] = s[0];"), 1);
    assert_eq!(glsl("if (i == 0u) one = data[0]; data[i] = one;"), 1);
    assert_eq!(glsl("s[i] = data[i]; data[i] = before(i);"), 1);
    assert_eq!(glsl("s[i] = data[i]; data[i] = s[data[i + 64u]];"), 1);
    assert_eq!(glsl("s[i] = data[i]; if (n > 4u) { barrier(); } data[i] = s[i ^ 1u];"), 1, "a way without it");
    assert_eq!(wgsl("if (i == 0) { one = data[0]; } data[i] = one;"), 1);
    assert_eq!(wgsl("atomicStore(&h[i], 0u); atomicAdd(&h[data[i]], 1u);"), 1);
}

#[test]
fn writes_to_what_others_read_are_reported() {
    let round = "for (uint k = 0u; k < n; k++) { s[i] = data[k]; barrier(); data[i] += s[63u - i]; }";
    assert_eq!(glsl(round), 1, "the next round");
    assert_eq!(glsl("s[i] = 1u; barrier(); s[i] += s[i ^ 1u];"), 1);
    assert_eq!(glsl("for (uint d = 32u; d > 0u; d >>= 1u) { if (i < d) s[i] += s[i + d]; }"), 1, "no barrier at all");
    let scan = "for (var d = 1u; d < 64u; d <<= 1u) { workgroupBarrier(); var t = 0u; if (i >= d) { t = s[i - d]; } s[i] += t; }";
    assert_eq!(wgsl(scan), 1);
}

#[test]
fn barriers_and_own_elements_are_in_order() {
    assert_eq!(glsl("s[i] = data[i]; barrier(); data[i] = s[63u - i];"), 0);
    assert_eq!(glsl("s[i] = data[i]; s[i] += 1u; data[i] = s[i];"), 0);
    let stack = |stride: u32| {
        format!("uint at = {stride}u * (i % 8u); if (i < 8u) {{ s[at] = 1u; uint k = data[i]; data[i] = s[at + k]; }}")
    };
    assert_eq!((glsl(&stack(8)), glsl(&stack(1))), (0, 1), "a part of the array for each, or neighbours");
    assert_eq!(glsl("v[i].x = 1.0; data[i] = uint(v[63u - i].y);"), 0, "another component");
    assert_eq!(glsl("s[2u * (i / 2u)] = 1u; data[i] = s[2u * (i / 2u)];"), 0, "all write the same");
    let tree =
        "s[i] = data[i]; barrier(); for (uint d = 32u; d > 0u; d >>= 1u) { if (i < d) s[i] += s[i + d]; barrier(); }";
    assert_eq!(glsl(tree), 0);
    let scan = "s[i] = data[i]; barrier(); for (uint d = 1u; d < 64u; d *= 2u) { uint t = 0u; if (i >= d) t = s[i - d]; \
                barrier(); s[i] += t; barrier(); } data[i] = s[i ^ 1u];";
    assert_eq!(glsl(scan), 0);
    let round = "for (uint k = 0u; k < n; k++) { s[i] = data[k]; barrier(); data[i] += s[63u - i]; barrier(); }";
    assert_eq!(glsl(round), 0);
}

/// A step of a sum as a function, whose guard compares the place in the dispatch.
#[test]
fn guards_on_the_place_in_the_dispatch_are_known_in_the_first_group() {
    let step = |guard: &str| {
        let text = format!(
            "@group(0) @binding(0) var<storage, read_write> data: array<u32>;\nvar<workgroup> s: array<u32, 64>;\n\
             fn step(i: u32, d: u32) {{ if ({guard}) {{ s[i] += s[i + d]; }} workgroupBarrier(); }}\n\
             @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {{\n\
             s[id.x] = data[id.x];\nworkgroupBarrier();\nstep(id.x, 32u);\nstep(id.x, 16u);\ndata[id.x] = s[0];\n}}\n"
        );
        wgsl::testing::count("K001", &text)
    };
    assert_eq!(step("i < d"), 0);
    assert_eq!(step("i < 2u * d"), 1, "the upper half reads what the lower half of it writes");
}

#[test]
fn one_invocation_does_not_meet_itself() {
    let sorts = |guard: &str| {
        glsl(&format!(
            "s[i] = data[i]; barrier(); if ({guard}) {{ for (uint k = 0u; k < 4u; k++) {{ uint m = k; uint most = s[k];\n\
             for (uint j = k + 1u; j < 64u; j++) if (s[j] > most) {{ most = s[j]; m = j; }}\n\
             if (m != k) {{ uint t = s[k]; s[k] = s[m]; s[m] = t; }} data[k] = s[k]; }} }}"
        ))
    };
    assert_eq!(sorts("i == 0u"), 0);
    assert_eq!(sorts("i < 2u"), 2, "who reads, and who writes");
}

#[test]
fn what_excludes_each_other_is_in_order() {
    assert_eq!(glsl("if (n > 4u) { s[i] = 1u; } else { data[i] = s[63u - i]; }"), 0);
    assert_eq!(glsl("uint m = n; if (m > 4u) s[i] = 1u; if (m > 4u) barrier(); if (m > 4u) data[i] = s[i ^ 1u];"), 0);
    assert_eq!(glsl("if (n > 4u) { s[i] = 1u; return; } data[i] = s[63u - i];"), 0);
    assert_eq!(wgsl("if (i == 0) { one = data[0]; } let all = workgroupUniformLoad(&one); data[i] = all;"), 0);
    assert_eq!(wgsl("atomicStore(&h[i], 0u); workgroupBarrier(); atomicAdd(&h[data[i]], 1u);"), 0);
    let inside = "s[i] = 1u; for (uint k = 0u; k < n; k++) { barrier(); data[k] += 1u; } data[i] = s[i ^ 1u];";
    assert_eq!(glsl(inside), 0, "the loop is there to be run");
    let late = "for (var k = 0u; k < data[g.x]; k++) { workgroupBarrier(); data[i] += s[i ^ 1u]; workgroupBarrier(); s[i] = k; }";
    assert_eq!(wgsl(late), 0, "the barrier of the next round");
}
