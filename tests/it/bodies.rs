//! Texts of which a host writes the rest: bodies of functions, strings that others include, and what stands in folders around.

use std::fs;

use crate::binary::{Ran, run_in, run_reported};

fn fuzz(files: &[(&str, &str)], arguments: &str) -> Ran {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    run_in(folder.path(), &format!("fuzz {} --lane embedded --samples 2048 {arguments}", files[0].0))
}

/// Bodies of functions whose heads a host writes, and lines that it puts into a function.
const HOST: &str = "export const nodes = [{\n  name: 'fade',\n  inputs: [{ type: 'float', name: 'amount' }],\n  \
    glsl: `vec2 p = uv * 2.0 - 1.0;\n   return vec4(p, 0.0, sqrt(amount - 4096.0));`\n}];\n\
    export const vertexTransform = `\nfloat t = position.y;\nposition.xz *= 1.0 + sqrt(t);\n`;\n\
    export const colour = 'gl_FragColor.w = 0.5 * pow(gl_FragColor.w, 2.0);';\n";

#[test]
fn statements_in_strings_are_bodies_of_functions() {
    let ran = fuzz(&[("nodes.js", HOST)], "");
    assert!(ran.out.contains("3 functions run"), "{ran:?}");
    assert!(ran.err.contains("`amount` as `float`") && ran.err.contains("`uv` as `vec2`"), "{ran:?}");
    // Faults stand at their places in the host code.
    assert!(ran.out.contains("nodes.js:5:24: `sqrt(amount - 4096.0)`"), "{ran:?}");
    assert!(ran.out.contains("nodes.js:9:22"), "{ran:?}");
    // What is written in part had a value before.
    assert!(!ran.out.contains("before it has a value"), "{ran:?}");
    let right = HOST.replace("sqrt(amount - 4096.0)", "amount").replace("sqrt(t)", "t * t");
    let ran = fuzz(&[("nodes.js", &right)], "").expect(0);
    assert!(ran.out.contains("3 functions run, 0 not run") && !ran.out.contains("has no value"), "{ran:?}");
    let text = "const char* tint = \"vec3 c = albedo * light; colour.rgb = c / dot(c, c);\";\n";
    let ran = fuzz(&[("tint.cpp", text)], "");
    assert!(ran.out.contains("1 function run, 0 not run") && ran.out.contains("tint.cpp:1:59"), "{ran:?}");
}

#[test]
fn statements_of_other_languages_are_no_bodies() {
    let text = "const code = `let v = vec3.create(); vec3.add(v, a, b);`;\nconst c = 'float x = 1.0; return x;';\n\
        const d = 'for (int i = 0; i < 4; i++) { sum += a[i]; }';\nconst p = 'A vec3 has three parts; a vec4 has four.';\n\
        const s = 'const v = vec3(1, 2, 3); return v;';\n";
    for name in ["a.js", "a.cpp"] {
        let text =
            if name == "a.cpp" { text.replace(['\'', '`'], "\"").replace("const ", "auto ") } else { text.into() };
        let ran = fuzz(&[(name, &text)], "").expect(2);
        assert!(ran.err.contains("holds no whole shader"), "{ran:?}");
    }
}

#[test]
fn a_file_of_statements_is_the_body_of_a_function() {
    let text = "#ifdef USE_FOG\n  float depth = vFogDepth * fogScale;\n  \
        gl_FragColor.rgb = mix(gl_FragColor.rgb, fogColor, log(depth));\n#endif\n";
    let ran = fuzz(&[("fog_fragment.glsl", text)], "");
    assert!(ran.err.contains("`USE_FOG` is defined"), "{ran:?}");
    assert!(ran.out.contains("fog_fragment         ") && ran.out.contains("1 function run, 0 not run"), "{ran:?}");
    assert!(ran.out.contains("fog_fragment.glsl:3:54: `log(depth)`"), "{ran:?}");
    let ran = fuzz(&[("fog_fragment.glsl", &text.replace("log(depth)", "depth"))], "").expect(0);
    assert!(!ran.out.contains("has no value") && ran.out.contains("1 function run"), "{ran:?}");
    // Its cases are traced as well.
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("fog_fragment.glsl"), text).unwrap();
    let ran = run_in(folder.path(), "fuzz fog_fragment.glsl --lane embedded --samples 2048");
    let line = ran.out.lines().find_map(|line| line.trim().strip_prefix("reproduce  ")).unwrap();
    let traced = run_reported(folder.path(), &line.replacen("fuzz", "trace", 1), &[]);
    assert!(traced.out.contains("log(depth)"), "{traced:?}");
    // A text of declarations stays one, with its errors.
    let ran = fuzz(&[("a.glsl", "vec3 f(vec3 a) { return a }\n")], "").expect(1);
    assert!(ran.out.contains("E001"), "{ran:?}");
}

#[test]
fn what_a_function_writes_in_part_has_a_value_before() {
    let text = "vec4 c;\nvoid fade(float t) {\n  c.w = t;\n}\n";
    let ran = fuzz(&[("a.glsl", text)], "").expect(0);
    assert!(ran.out.contains("1 function run") && !ran.out.contains("before it has a value"), "{ran:?}");
    // Nobody writes to what a stage gives.
    let stage = "#version 330\nout vec4 c;\nin float t;\nvoid main() {\n  c.w = t;\n}\n";
    let ran = fuzz(&[("a.frag", stage)], "");
    assert!(
        ran.out.contains("c.x") || ran.out.contains("before it has a value") || ran.out.contains("not written"),
        "{ran:?}"
    );
}

#[test]
fn a_layout_of_patches_tells_its_stage() {
    let text = "const std::string control = R\"(\nlayout(vertices = 3) out;\nuniform float level;\n\
        void main() {\n  gl_TessLevelOuter[0] = sqrt(level - 4096.0);\n}\n)\";\n";
    let ran = fuzz(&[("a.cpp", text)], "");
    assert!(ran.out.contains("1 function run, 0 not run") && ran.out.contains("a.cpp:5:26"), "{ran:?}");
    let ran = fuzz(&[("a.cpp", &text.replace("level - 4096.0", "level * level"))], "").expect(0);
    assert!(!ran.out.contains("a.cpp:5:"), "{ran:?}");
}

#[test]
fn a_string_whose_stage_nothing_tells_is_run_as_functions() {
    let text = "const char* s = \"in vec2 uv; out vec4 c; void main() { c = vec4(sqrt(uv.x - 4096.0)); }\";\n\
        const char* other = \"void main() { printf(1.0); }\";\n";
    let ran = fuzz(&[("a.cpp", text)], "");
    assert!(ran.out.contains("1 function run, 0 not run") && ran.out.contains("a.cpp:1:"), "{ran:?}");
    let ran = fuzz(&[("a.cpp", &text.replace("sqrt(uv.x - 4096.0)", "uv.x"))], "").expect(0);
    assert!(!ran.out.contains("a.cpp:1:"), "{ran:?}");
}

#[test]
fn names_are_looked_for_in_folders_around_where_no_input_stands_for_them() {
    // No input makes an array of an unknown length of a structure that is taken apart so.
    let part = "@group(0) @binding(0) var<storage, read_write> found: Found;\n\
        @compute @workgroup_size(8)\nfn cs(@builtin(global_invocation_id) id: vec3u) {\n  \
        if id.x >= arrayLength(&found.values) { return; }\n  found.values[id.x] = scaled(found.values[id.x]);\n}\n";
    let common = "struct Found { count: u32, values: array<f32>, }\nfn scaled(x: f32) -> f32 { return x / 0.5; }\n";
    let manifest = ("Cargo.toml", "[package]\nname = \"a\"\n");
    let ran = fuzz(&[("src/a/part.wgsl", part), ("src/b/common.wgsl", common), manifest], "").expect(0);
    assert!(ran.err.contains("`Found` is taken from src/b/common.wgsl"), "{ran:?}");
    let wrong = common.replace("x / 0.5", "sqrt(x - 4096.0)");
    let ran = fuzz(&[("src/a/part.wgsl", part), ("src/b/common.wgsl", &wrong), manifest], "");
    assert!(ran.out.contains("src/b/common.wgsl:2:"), "{ran:?}");
    // Where nothing declares them, that is no error of the text.
    let ran = fuzz(&[("src/a/part.wgsl", part), manifest], "");
    assert!(ran.out.contains("not run") && !ran.out.contains("error["), "{ran:?}");
    // A slip is one.
    let slip = part.replace("id.x >=", "id.x + foundd.count >=");
    let slip =
        format!("struct Found {{ count: u32, values: array<f32>, }}\n{slip}fn scaled(x: f32) -> f32 {{ return x; }}\n");
    let ran = fuzz(&[("src/a/part.wgsl", &slip), manifest], "").expect(1);
    assert!(ran.out.contains("foundd"), "{ran:?}");
}

#[test]
fn a_member_with_a_number_in_brackets_is_a_vector() {
    let text = "#import engine::view::view\n\
        fn scale(x: f32) -> f32 {\n  let vp = view.viewport;\n  return x * sqrt(min(vp[2], vp[3]));\n}\n";
    let ran = fuzz(&[("a.wgsl", text)], "");
    assert!(ran.out.contains("1 function run, 0 not run") && ran.out.contains("a.wgsl:4:14"), "{ran:?}");
    let ran = fuzz(&[("a.wgsl", &text.replace("sqrt(min(vp[2], vp[3]))", "min(vp[2], vp[3])"))], "").expect(0);
    assert!(ran.out.contains("1 function run, 0 not run") && !ran.out.contains("a.wgsl:4:"), "{ran:?}");
}

#[test]
fn the_size_of_a_workgroup_is_one_value_everywhere() {
    let text = "export const sum = (size) => `\n@group(0) @binding(0) var<storage, read_write> data: array<f32>;\n\
        const size: u32 = ${size};\nvar<workgroup> part: array<f32, ${size}>;\n@compute @workgroup_size(${size})\n\
        fn main(@builtin(local_invocation_index) i: u32) {\n  part[i] = data[i];\n  workgroupBarrier();\n  \
        data[i] = part[(i + 1u) % size];\n}\n`;\n";
    let ran = fuzz(&[("a.js", text)], "").expect(0);
    assert!(
        ran.err.contains("`${size}` at a.js:3:19 is taken for 64") && ran.out.contains("1 function run"),
        "{ran:?}"
    );
    let ran = fuzz(&[("a.js", &text.replace("(i + 1u) % size", "i + 1u"))], "");
    assert!(ran.out.contains("outside of its 64 elements"), "{ran:?}");
}

#[test]
fn strings_that_host_code_keeps_are_included_by_their_names() {
    let noise = (
        "lib/noise.ts",
        "export let Noise: string = /* wgsl */`\nfn noise(x: f32) -> f32 { return sqrt(x - 4096.0); }\n`;\n",
    );
    let text = "export let Main = /* wgsl */`\n#include 'Noise'\n@group(0) @binding(0) var<storage, read_write> d: array<f32>;\n\
        @compute @workgroup_size(4)\nfn cs(@builtin(global_invocation_id) id: vec3u) { d[id.x] = noise(d[id.x]); }\n`;\n";
    let manifest = ("package.json", "{}");
    let ran = fuzz(&[("src/main.ts", text), ("src/lib/noise.ts", noise.1), manifest], "");
    assert!(ran.err.contains("`Noise` is taken from src/lib/noise.ts"), "{ran:?}");
    assert!(ran.out.contains("src/lib/noise.ts:2:"), "{ran:?}");
    let right = noise.1.replace("sqrt(x - 4096.0)", "x * 0.5");
    let ran = fuzz(&[("src/main.ts", text), ("src/lib/noise.ts", &right), manifest], "").expect(0);
    assert!(ran.out.contains("2 functions run, 0 not run") && !ran.out.contains("noise.ts:2"), "{ran:?}");
    // An element of an object, and a file of its own.
    let host = "import * as T from 'three';\nT.Chunks[ 'ripple' ] = `\nfloat ripple(float x) { return log(x); }\n`;\n";
    let shader = "#version 300 es\nprecision highp float;\n#include <ripple>\nin float x;\nout vec4 c;\nvoid main() { c = vec4(ripple(x)); }\n";
    let ran = fuzz(&[("shaders/a.frag", shader), ("js/chunks.js", host), manifest], "");
    assert!(ran.out.contains("js/chunks.js:3:") && ran.out.contains("main"), "{ran:?}");
    let ran = fuzz(&[("shaders/a.frag", shader), ("js/chunks.js", &host.replace("ripple'", "other'")), manifest], "");
    assert!(ran.err.contains("not found, and left out: `#include <ripple>`"), "{ran:?}");
}

#[test]
fn words_that_a_string_defines_stand_anywhere() {
    let text = "// shaders\nconst char* defines = R\"(\n#if defined(MOBILE)\n#define ATTRIBUTE attribute\n#define OUTPUT\n\
        #define FRAG_OUT gl_FragColor\n#define LOW lowp\n#else\n#define ATTRIBUTE in\n#define OUTPUT out vec4 fragOut;\n\
        #define FRAG_OUT fragOut\n#define LOW\n#endif\n)\";\nconst char* fragment = R\"(\nATTRIBUTE LOW vec4 v_colour;\nOUTPUT\n\
        void main()\n{\n    FRAG_OUT = sqrt(v_colour - 4096.0);\n}\n)\";\n";
    let ran = fuzz(&[("a.cpp", text)], "");
    assert!(ran.out.contains("1 function run, 0 not run") && ran.out.contains("a.cpp:20:"), "{ran:?}");
    let ran = fuzz(&[("a.cpp", &text.replace("sqrt(v_colour - 4096.0)", "v_colour"))], "").expect(0);
    assert!(ran.out.contains("1 function run, 0 not run") && !ran.out.contains("a.cpp:20:"), "{ran:?}");
}

#[test]
fn memory_that_a_stage_does_without_does_not_stop_it() {
    let text = "#version 450\nstruct View { mat4 m; };\n\
        #define ALL(TYPE, NAME) \\\n  layout(set = 0, binding = 0) buffer Views { View views[]; } views; \\\n  \
        layout(set = 0, binding = 1) uniform samplerCube cubes[]; \\\n  \
        layout(set = 0, binding = 2) uniform Constants { vec4 size; TYPE NAME; };\n\
        struct Process { float roughness; };\nALL(Process, process)\nlayout(location = 0) out vec4 c;\n\
        void main() {\n  c = texture(cubes[0], vec3(1.0)) + vec4(sqrt(process.roughness - 4096.0));\n}\n";
    let ran = fuzz(&[("a.frag", text)], "");
    assert!(ran.out.contains("1 function run, 0 not run") && ran.out.contains("a.frag:11:"), "{ran:?}");
    let ran = fuzz(&[("a.frag", &text.replace("sqrt(process.roughness - 4096.0)", "process.roughness"))], "").expect(0);
    assert!(!ran.out.contains("a.frag:11:"), "{ran:?}");
}
