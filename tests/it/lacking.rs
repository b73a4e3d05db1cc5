//! Texts that lack declarations, on the command line.

use std::fs;

use crate::binary::{Ran, run_in};

fn fuzz(name: &str, text: &str, arguments: &str) -> Ran {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(name), text).unwrap();
    run_in(folder.path(), &format!("fuzz {name} --lane embedded --samples 4096 {arguments}"))
}

/// A piece of a shader. Its engine declares the camera, the light and a function, in a file that is not there.
const PIECE: &str = "#include \"engine/light.glsl\"\n\
    vec3 shade(vec3 n, float roughness) {\n\
    float d = max(dot(n, sun.direction), 0.0);\n\
    vec3 half_way = normalize(sun.direction + camera.direction);\n\
    return fresnel(half_way).rgb * d / (PI * roughness);\n}\n";

#[test]
fn a_piece_is_run_with_inputs_for_what_it_lacks() {
    let ran = fuzz("piece.glsl", PIECE, "");
    assert!(ran.err.contains("not found, and left out: `#include \"engine/light.glsl\"`"), "{ran:?}");
    assert!(ran.err.contains("`fresnel` as a function that gives `vec3`"), "{ran:?}");
    assert!(ran.err.contains("assumed --define PI=3.14159265358979"), "{ran:?}");
    // The fault is told at its place in the file; what was made up is not tested.
    let fault = "`normalize(sun.direction + camera.direction)` of a zero vector";
    assert!(ran.out.contains(&format!("piece.glsl:4:17: `return.x` has no value: {fault}")), "{ran:?}");
    assert!(ran.out.contains("1 function run, 0 not run"), "{ran:?}");
    assert!(!ran.out.contains("does not compile"), "{ran:?}");
    // The repaired twin.
    let right = PIECE.replace("normalize(sun.direction + camera.direction)", "sun.direction + camera.direction");
    let ran = fuzz("piece.glsl", &right, "");
    assert!(!ran.out.contains("piece.glsl:4:"), "{ran:?}");
}

#[test]
fn a_whole_shader_is_run_and_its_names_are_errors() {
    let text =
        "#version 330 core\nin vec3 n;\nout vec4 color;\nvoid main() { color = vec4(normalize(n) * tint, 1.0); }\n";
    let ran = fuzz("whole.frag", text, "").expect(1);
    assert!(ran.out.contains("error[E020]: `tint` is not declared"), "{ran:?}");
    assert!(ran.out.contains("whole.frag:4:28: `color.x` has no value: `normalize(n)` of a zero vector"), "{ran:?}");
    assert!(ran.out.contains("1 function run, 0 not run"), "{ran:?}");
    assert!(ran.out.contains("1 file does not compile"), "{ran:?}");
}

/// An engine of the web keeps modules of WGSL under the endings of stages, and leaves endings out where it joins them.
#[test]
fn a_module_of_wgsl_has_any_ending_of_glsl() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    fs::create_dir(folder.path().join("common")).unwrap();
    write("common/light.wgsl", "struct Light { color: vec3f, }\n");
    let text = "#include \"common/light\"\n@group(0) @binding(0) var<uniform> light: Light;\n\
        @fragment\nfn fs(@location(0) uv: vec2f) -> @location(0) vec4f { return vec4f(light.color * uv.x, 1.0); }\n";
    write("a.fs", text);
    write("b.fs", &text.replace("uv.x", "sqrt(-1.0 - uv.x * uv.x)"));
    write("c.fs", &text.replace("return", "let wrong: f32 = true; return"));
    let ran = run_in(folder.path(), "fuzz a.fs b.fs --lane embedded --samples 256").expect(1);
    assert!(ran.out.contains("b.fs:4:") && !ran.out.contains("a.fs:4:"), "{ran:?}");
    assert!(ran.out.contains("2 functions run, 0 not run"), "{ran:?}");
    let linted = run_in(folder.path(), "lint .").expect(1);
    assert!(linted.out.contains("c.fs:4:") && linted.err.contains("4 files: 1 error"), "{linted:?}");
}

/// A header for the host and its shaders: without the name that its host defines for shaders it is C.
#[test]
fn a_text_that_is_c_without_a_name_is_read_with_it() {
    let header = "#ifndef SHADER_CODE\ntypedef union _vec4 vec4;\n#define BEGIN(X) typedef struct {\n#define END(X) } X;\n#else\n\
        #define BEGIN(X) struct X {\n#define END(X) };\n#endif\nBEGIN(Light)\n    vec4 color;\nEND(Light)\n";
    let main = "layout(set = 0, binding = 0) uniform U { Light light; };\nlayout(location = 0) out vec4 o;\n\
        void main() { o = light.color; }\n";
    let ran = fuzz("a.frag", &format!("#version 450\n{header}{main}"), "").expect(0);
    assert!(ran.err.contains("--define SHADER_CODE=1"), "{ran:?}");
    assert!(ran.out.contains("1 function run, 0 not run"), "{ran:?}");
    // What is no text of a shader with any name is told.
    let ran = fuzz("a.frag", &format!("#version 450\n{}{main}", header.replace("struct X {", "typedef struct {")), "");
    assert!(ran.expect(1).out.contains("error["));
}

/// Parts of shaders in strings of host code, and what a macro of a header is given, which can only be a shader.
#[test]
fn strings_of_a_host_are_run_as_what_they_are() {
    let part = "export const FALLOFF = `\nuniform float uReach;\n\
        float falloff(float q) { return sqrt(-1.0 - q * q) * uReach * ${SCALE}.0; }\n\
        float near(vec3 p) { return dot(p, p) * uReach; }\n`;\n";
    let ran = fuzz("light.ts", part, "");
    assert!(ran.out.contains("ok    near "), "{ran:?}");
    assert!(ran.out.contains("light.ts:3:") && ran.out.contains("sqrt(-"), "{ran:?}");
    let c = "#include \"gpu.h\"\n// The shader.\nstatic const char* halve = CODE(\n  @group(0) @binding(0) var<storage, read_write> a : array<u32>;\n\
        @compute @workgroup_size(8)\n  fn main(@builtin(global_invocation_id) id : vec3<u32>) {\n    a[id.x / 2u] = id.x;\n  }\n);\n";
    let ran = fuzz("halve.c", c, "").expect(1);
    assert!(ran.out.contains("halve.c:7:") && ran.out.contains("race on `a[0]`"), "{ran:?}");
    assert!(
        fuzz("copy.c", &c.replace("a[id.x / 2u] = id.x;", "if (id.x < arrayLength(&a)) { a[id.x] = id.x; }"), "")
            .out
            .contains("ok    main")
    );
    // A call of the host is none.
    let host = "// A shader.\nint main(void) {\n  DRAW(void main(), 3);\n  return RUN(1);\n}\n";
    fuzz("host.c", host, "").expect(2);
}

/// A file that is not there keeps only those functions from running that need it.
#[test]
fn what_needs_no_missing_file_runs() {
    let text = "varying vec3 n;\n#include <common>\nfloat luma(vec3 c) { return dot(c, vec3(0.3, 0.6, 0.1)); }\n\
        void main() { Lit lit = Lit(n, n, 1.0); gl_FragColor = vec4(lit.direct * luma(n), 1.0); }\n";
    let ran = fuzz("a.frag", text, "").expect(0);
    assert!(ran.out.contains("ok    luma ") && ran.out.contains("ok    main "), "{ran:?}");
    // The place of a vertex, in a text that does not say of which stage it is.
    let ran = fuzz("a.glsl", "varying vec3 n;\nfloat luma() { return dot(n, vec3(0.3, 0.6, 0.1)); }\n", "").expect(0);
    assert!(ran.out.contains("ok    luma "), "{ran:?}");
}

/// A pack states its version in a file that all others include.
#[test]
fn a_version_that_an_include_states_late_is_its_hosts_business() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("core.glsl", "#ifdef CORE\n#version 460 core\n#else\n#version 460 compatibility\n#endif\n");
    let main = "in vec2 uv;\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(uv, 0.0, 1.0); }\n";
    write("a.fsh", &format!("#include \"/core.glsl\"\n{main}"));
    let ran = run_in(folder.path(), "fuzz a.fsh --lane embedded --samples 64").expect(0);
    assert!(ran.out.contains("ok    main"), "{ran:?}");
    write("c.fsh", &format!("{main}#version 460\n"));
    assert!(run_in(folder.path(), "fuzz c.fsh --lane embedded --samples 64").expect(1).out.contains("V001"));
}

/// Packs for Minecraft take files in from a folder of their own, each with a version.
#[test]
fn what_a_pack_imports_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path().join("assets/minecraft/shaders");
    fs::create_dir_all(at.join("include")).unwrap();
    fs::create_dir_all(at.join("core")).unwrap();
    fs::write(at.join("include/fog.glsl"), "#version 150\nfloat fog(float q) { return sqrt(-1.0 - q * q); }\n")
        .unwrap();
    let main = |name: &str| {
        format!(
            "#version 150\n#moj_import <{name}>\nin vec2 uv;\nout vec4 c;\nvoid main() {{ c = vec4(fog(uv.x)); }}\n"
        )
    };
    fs::write(at.join("core/a.fsh"), main("fog.glsl")).unwrap();
    fs::write(at.join("core/b.fsh"), main("minecraft:fog.glsl")).unwrap();
    fs::write(at.join("core/c.fsh"), main("light.glsl")).unwrap();
    for name in ["a", "b"] {
        let ran = run_in(
            folder.path(),
            &format!("fuzz assets/minecraft/shaders/core/{name}.fsh --lane embedded --samples 64"),
        );
        assert!(ran.expect(1).out.contains("shaders/include/fog.glsl:2:"), "{name}");
    }
    let ran = run_in(folder.path(), "fuzz assets/minecraft/shaders/core/c.fsh --lane embedded --samples 64");
    assert!(!ran.out.contains("E012") && !ran.out.contains("fog.glsl"), "{ran:?}");
}

/// Lines that a host reads, and a placeholder: what compiles without them is run.
#[test]
fn the_functions_of_a_text_run_that_its_host_has_no_hand_in() {
    let bad = "float bad(float x) { return sqrt(-1.0 - x * x); }\n";
    let ran = fuzz(
        "a.fsh",
        &format!(
            "#version 150\n#moj_import <fog.glsl>\nin vec2 uv;\nout vec4 c;\n{bad}void main() {{ c = linear_fog(vec4(bad(uv.x)), uv); }}\n"
        ),
        "",
    );
    assert!(ran.out.contains("a.fsh:5:") && ran.out.contains("sqrt(-"), "{ran:?}");
    assert!(ran.out.contains(" main  ") && ran.err.contains("`linear_fog`"), "{ran:?}");
    let ran = fuzz(
        "b.glsl",
        &format!("#version 330\nconst int N = ${{COUNT}};\n{bad}float all() {{ return float(N); }}\n"),
        "",
    );
    assert!(ran.out.contains("b.glsl:3:") && ran.out.contains("all                  not run"), "{ran:?}");
    // A whole shader that no host mends is refused.
    let ran = fuzz("c.frag", &format!("#version 330\nout vec4 c;\n{bad}void main() {{ c = vec4(bad(1.0)) }}\n"), "")
        .expect(1);
    assert!(ran.out.contains("0 functions run"), "{ran:?}");
}

/// A text of which its host says the version, and that asks for OpenGL ES, is run in the version that it is read in.
#[test]
fn a_text_without_its_version_that_asks_for_phones_is_run() {
    let text = "layout(location = 0) in vec2 p;\n#if !defined(GL_ES)\nout gl_PerVertex { vec4 gl_Position; };\n#endif\n\
                out vec2 uv;\nvoid main() { uv = p; gl_Position = vec4(p, 0.0, 1.0); }\n";
    let ran = fuzz("a.vert", text, "").expect(0);
    assert!(ran.out.contains("ok    main") && ran.err.contains("it is read as a phone reads it"), "{ran:?}");
}

/// Functions that a host turns on, which are there with a name that nothing defines.
#[test]
fn what_stands_behind_a_switch_is_run_with_it() {
    let text = "float plain(float x) { return x + 1.0; }\n#ifdef WITH_FOG\n\
                float fog(float x) { return sqrt(-1.0 - x * x); }\n#elif defined(WITH_RAIN)\nfloat rain(float x) { return x; }\n#endif\n";
    let ran = fuzz("a.glsl", text, "").expect(0);
    assert_eq!(ran.out.matches("plain ").count(), 1, "{ran:?}");
    assert!(ran.out.contains("\na.glsl, with WITH_FOG, WITH_RAIN\n"), "{ran:?}");
    assert!(ran.out.contains("warning: fog: `return` has no value") && ran.out.contains("ok    rain "), "{ran:?}");
    assert!(ran.out.contains("--define WITH_FOG=1 --define WITH_RAIN=1 --lane embedded --function fog"), "{ran:?}");
    let module = "fn plain(x: f32) -> f32 { return x; }\n#ifdef FOG\nfn fog(x: f32) -> f32 { return sqrt(-1.0 - x * x); }\n#endif\n";
    let ran = fuzz("a.wgsl", module, "").expect(0);
    assert!(ran.out.contains("warning: fog: `return` has no value") && ran.out.contains("ok    plain "), "{ran:?}");
    // What does not compile so is left out, and what is stated is no guess.
    let ran = fuzz(
        "a.glsl",
        "float f(float x) { return x; }\n#ifdef HLSL\nfloat2 g(float2 x) { return mul(x, 2); }\n#endif\n",
        "",
    );
    assert!(!ran.out.contains(" g ") && ran.out.contains("ok    f "), "{ran:?}");
    fuzz("a.glsl", text, "--define WITH_FOG").expect(1);
}

/// Memory and sizes that a function has from its stage.
#[test]
fn a_function_of_a_stage_reads_its_buffers_and_knows_its_workgroup() {
    let text = "#version 450\nlayout(local_size_x = 8) in;\nstruct Light { vec4 at; };\n\
                layout(std430, binding = 0) readonly buffer L { Light lights[]; };\n\
                float of(uint i) { return lights[i].at.x; }\nuint half_() { return gl_WorkGroupSize.x / 2u; }\n\
                float bad(uint i) { return sqrt(-1.0 - lights[i].at.x * lights[i].at.x); }\nvoid main() { }\n";
    let ran = fuzz("a.comp", text, "").expect(1);
    assert!(ran.out.contains("ok    of ") && ran.out.contains("ok    half_ "), "{ran:?}");
    assert!(ran.out.contains("FAIL  bad ") && !ran.out.contains("cannot be fed"), "{ran:?}");
}

#[test]
fn what_is_wrong_otherwise_is_told_and_not_run() {
    let ran = fuzz("piece.glsl", &PIECE.replace("roughness);\n}", "roughness) * mat2(1.0);\n}"), "").expect(2);
    assert!(ran.out.contains("it includes what is not there: piece.glsl:1:1: #include"), "{ran:?}");
}

/// A material. Its engine declares the view and what lights it, in modules that are not there.
const MATERIAL: &str = "#import engine::{view::view, light::{Sun, sun_at}}\n\
    @group(#{MATERIAL_GROUP}) @binding(0) var<uniform> roughness: f32;\n\
    fn shade(n: vec3f) -> vec3f {\n\
    let sun: Sun = sun_at(view.time);\n\
    let half_way = normalize(sun.direction + view.direction);\n\
    return sun.color * max(dot(n, half_way), 0.0) / roughness;\n}\n";

#[test]
fn a_module_is_run_with_inputs_for_what_its_imports_would_bring() {
    let ran = fuzz("material.wgsl", MATERIAL, "").expect(0);
    assert!(ran.err.contains("`view` as a structure") && ran.err.contains("`sun_at` as a function that"), "{ran:?}");
    assert!(ran.err.contains("material.wgsl:2:8: `MATERIAL_GROUP` is taken for 0, a group of bindings"), "{ran:?}");
    // What depends on an input that is made up is no more than a warning.
    assert!(ran.out.contains("warning: shade:") && ran.out.contains("material.wgsl:5:"), "{ran:?}");
    assert!(ran.out.contains("1 function run, 0 not run, 0 findings"), "{ran:?}");
    // The repaired twin.
    let right = MATERIAL.replace("normalize(sun.direction + view.direction)", "sun.direction + view.direction");
    let ran = fuzz("material.wgsl", &right, "").expect(0);
    assert!(!ran.out.contains("material.wgsl:5:"), "{ran:?}");
}

#[test]
fn a_slip_in_a_module_stays_an_error() {
    let text = "fn f(uv: vec2f) -> vec2f { return normalise(uv) + offset; }\n";
    let ran = fuzz("slip.wgsl", text, "").expect(1);
    assert!(ran.out.contains("error[E021]: `normalise` is not declared"), "{ran:?}");
    assert!(ran.out.contains("did you mean `normalize`?") && !ran.out.contains("`offset` is not"), "{ran:?}");
    assert!(ran.out.contains("1 function run") && ran.out.contains("1 file does not compile"), "{ran:?}");
}

#[test]
fn constants_of_a_pipeline_without_a_value_have_a_plain_one() {
    let text = "override width: f32;\noverride tiles: u32;\nfn f(x: f32) -> f32 { return x * width + f32(tiles); }\n";
    let ran = fuzz("pipeline.wgsl", text, "").expect(0);
    assert!(ran.err.contains("assumed --define width=1 --define tiles=64: names that nothing defines"), "{ran:?}");
    let tile = "override w: u32;\noverride h: u32;\n@group(0) @binding(0) var<storage, read_write> o: array<u32>;\n\
                @compute @workgroup_size(w, h) fn main(@builtin(global_invocation_id) id: vec3u) {\n\
                if id.x < arrayLength(&o) && id.y == 0u { o[id.x] = id.x; }\n}\n";
    let ran = fuzz("tile.wgsl", tile, "").expect(0);
    assert!(ran.err.contains("assumed --define w=8 --define h=8"), "{ran:?}");
    let ran = fuzz("pipeline.wgsl", text, "--define width=640").expect(0);
    assert!(ran.err.contains("assumed --define tiles=64: a name that nothing defines"), "{ran:?}");
}

/// A part of a scan, without the kernel that calls it.
const PART: &str = "var<workgroup> row: array<u32, 64>;\n\
    @group(0) @binding(0) var<storage, read_write> o: array<u32>;\n\
    fn reversed(id: u32, local: u32, x: u32) {\n\
    row[local] = x;\n\
    if id >= arrayLength(&o) { return; }\n\
    workgroupBarrier();\n\
    o[id] = row[63u - local];\n}\n";

#[test]
fn a_function_of_a_workgroup_is_run_by_a_kernel_that_is_made_up() {
    let ran = fuzz("part.wgsl", PART, "").expect(0);
    assert!(ran.out.contains("warning: reversed: invocation 1 does not reach this barrier"), "{ran:?}");
    assert!(ran.out.contains("at         part.wgsl:6:1"), "{ran:?}");
    assert!(ran.out.contains("1 function run, 0 not run, 0 findings"), "{ran:?}");
    // The repaired twin, and one that forgets the barrier.
    let guarded = "workgroupBarrier();\nif id >= arrayLength(&o) { return; }\n";
    let right = PART.replace("if id >= arrayLength(&o) { return; }\nworkgroupBarrier();\n", guarded);
    let ran = fuzz("part.wgsl", &right, "").expect(0);
    assert!(ran.out.contains("ok    reversed") && ran.out.contains("0 findings, 0 warnings"), "{ran:?}");
    let ran = fuzz("part.wgsl", &right.replace("workgroupBarrier();\n", ""), "").expect(0);
    assert!(ran.out.contains("warning: reversed: race"), "{ran:?}");
}

/// A step of a sum: its caller hands it the place in the workgroup, whatever the parameter is called.
#[test]
fn what_indexes_memory_of_a_workgroup_is_a_place_in_it() {
    let step = |place: &str| {
        format!(
            "var<workgroup> part: array<f32, 64>;\nfn step(index: u32, stride: u32) {{\n\
             if index < stride {{ part[{place}] += 1.0; }}\nworkgroupBarrier();\n}}\n"
        )
    };
    let ran = fuzz("step.wgsl", &step("index"), "").expect(0);
    assert!(ran.out.contains("0 findings, 0 warnings"), "{ran:?}");
    let ran = fuzz("step.wgsl", &step("index + 64u"), "").expect(0);
    assert!(ran.out.contains("warning: step: invocation 0 writes `part` at index 64, outside"), "{ran:?}");
}

/// A kernel whose host writes a size in front of it.
#[test]
fn what_rests_on_a_size_that_nobody_declares_is_a_warning() {
    let text = |place: &str, barrier: &str| {
        format!(
            "var<workgroup> part: array<f32, BLOCK>;\n@group(0) @binding(0) var<storage, read_write> o: array<f32>;\n\
             @compute @workgroup_size(BLOCK) fn main(@builtin(local_invocation_index) i: u32) {{\n\
             part[i] = o[i];\n{barrier}\no[i] = part[{place}];\n}}\n"
        )
    };
    let sized = |text: &str| format!("const BLOCK = 64u;\n{text}");
    let race = text("i ^ 1u", "");
    let ran = fuzz("sized.wgsl", &race, "").expect(0);
    assert!(ran.err.contains("`BLOCK` is declared nowhere, and is taken for 64"), "{ran:?}");
    assert!(ran.out.contains("warning: main: race on `part["), "{ran:?}");
    let ran = fuzz("sized.wgsl", &sized(&race), "").expect(1);
    assert!(ran.out.contains("main: race on `part[") && !ran.out.contains("warning: main"), "{ran:?}");
    // It may be 128: nobody knows that an index is outside.
    let beyond = text("i + 64u", "workgroupBarrier();");
    let ran = fuzz("sized.wgsl", &beyond, "").expect(0);
    assert!(ran.out.contains("0 findings, 0 warnings"), "{ran:?}");
    let ran = fuzz("sized.wgsl", &sized(&beyond), "").expect(1);
    assert!(ran.out.contains("reads `part` at index 64, outside of its 64 elements"), "{ran:?}");
}

#[test]
fn a_name_in_a_declaration_is_no_slip_of_what_it_declares() {
    let text = |name: &str| {
        format!("const BLOCK_STEP: u32 = {name} / 8u;\nfn f(x: u32) -> u32 {{ return x % BLOCK_STEP; }}\n")
    };
    let ran = fuzz("block.wgsl", &text("BLOCK_SIZE"), "");
    assert!(!ran.out.contains("is not declared"), "{ran:?}");
    // What is around a piece may be called like what it declares; a whole module has nothing around it.
    let near = format!("const BLOCK_SIZES = 64u;\n{}", text("BLOCK_SIZE"));
    let ran = fuzz("block.wgsl", &near, "").expect(0);
    assert!(!ran.out.contains("is not declared") && ran.err.contains("`BLOCK_SIZE`"), "{ran:?}");
    let kernel = "@group(0) @binding(0) var<storage, read_write> o: array<u32, 8>;\n\
        @compute @workgroup_size(8) fn main(@builtin(local_invocation_index) i: u32) { o[i] = f(i); }\n";
    let ran = fuzz("block.wgsl", &format!("{near}{kernel}"), "").expect(1);
    assert!(ran.out.contains("did you mean `BLOCK_SIZES`?"), "{ran:?}");
    // No text around a function declares what is in it.
    let local = "fn f(n: vec3f) -> vec3f { let tangent = n.yzx; return tangnet * strength; }\n";
    let ran = fuzz("local.wgsl", local, "").expect(1);
    assert!(ran.out.contains("did you mean `tangent`?"), "{ran:?}");
}

#[test]
fn functions_of_another_file_of_the_project_are_taken_from_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    file(
        "noise.glsl",
        "float hash(float x) { return fract(sin(x) * 43.5); }\nfloat noise(vec2 p) { return hash(p.x + lacunarity * p.y); }\n",
    );
    file("part.glsl", "float height(vec2 p) { return 1.0 / noise(p); }\n");
    let run = || run_in(folder.path(), "fuzz part.glsl --lane embedded --samples 4096").expect(0);
    let ran = run();
    assert!(ran.err.contains("functions that are missing are taken from noise.glsl"), "{ran:?}");
    assert!(ran.err.contains("`lacunarity` as `float`") && !ran.err.contains("`noise` as"), "{ran:?}");
    // Those of the other file are not tested here, and a fault there is told at its place.
    assert!(ran.out.contains("1 function run, 0 not run") && ran.out.contains("noise.glsl:1:"), "{ran:?}");
    // Two files that define it leave open which one is meant.
    file("other.glsl", "float noise(vec2 p) { return p.x; }\n");
    let ran = run();
    assert!(ran.err.contains("`noise` as a function that gives `float`") && !ran.err.contains("taken from"), "{ran:?}");
}

/// Functions that read and write storage by index, without a kernel that calls them.
const STORED: &str = "struct Body { at: vec3f, mass: f32 }\n\
    @group(0) @binding(0) var<storage, read> bodies: array<Body>;\n\
    @group(0) @binding(1) var<storage, read_write> o: array<f32>;\n\
    fn pull(i: u32, p: vec3f) -> vec3f {\n\
    return normalize(bodies[i].at - p) * bodies[i].mass;\n}\n\
    fn put(slot: i32, x: f32) { o[slot] = x * x + f32(arrayLength(&o)); }\n";

#[test]
fn a_function_that_reads_storage_is_run_alone() {
    let ran = fuzz("stored.wgsl", STORED, "").expect(0);
    assert!(ran.out.contains("2 functions run, 0 not run, 0 findings"), "{ran:?}");
    let fault = "stored.wgsl:5:8: `return.x` has no value: `normalize(bodies[i].at - p)` of a zero vector";
    assert!(ran.out.contains(fault), "{ran:?}");
    // Elements that are there are asked for, and inputs have the names of the function.
    assert!(!ran.out.contains("outside") && !ran.out.contains("_caller"), "{ran:?}");
    let right = STORED.replace("normalize(bodies[i].at - p)", "(bodies[i].at - p)");
    let ran = fuzz("stored.wgsl", &right, "").expect(0);
    assert!(ran.out.contains("2 functions run, 0 not run, 0 findings, 0 warnings"), "{ran:?}");
}

#[test]
fn a_text_that_its_host_makes_whole_is_no_error() {
    // A stage without `main` has functions; what another preprocessor reads is not run, for that reason.
    let ran = fuzz("part.frag", "float f(float x) { return 1.0 / x; }\n", "").expect(0);
    assert!(ran.out.contains("1 function run, 0 not run, 0 findings, 1 warning"), "{ran:?}");
    let marked = "VARYING_ vec3 normal;\nVARYING_ vec2 uv;\nvoid main() { gl_FragColor = vec4(normal * uv.x, 1.0); }\n";
    let ran = fuzz("marked.frag", marked, "").expect(2);
    assert!(ran.out.contains("its host has to make it a whole shader"), "{ran:?}");
    let wrong = "#version 330\nout vec4 c;\nvoid main() { c = vec4(1.0) + vec3(1.0); }\n";
    fuzz("wrong.frag", wrong, "").expect(1);
}

#[test]
fn inputs_keep_the_names_that_their_author_gave_them() {
    let text = "@group(0) @binding(0) var<storage, read> a: array<f32>;\n\
                fn stored(i: u32, result: f32, result_x: f32) -> f32 { return a[i] / (result * result_x); }\n\
                fn plain(returned: f32) -> f32 { return sqrt(returned); }\n";
    let ran = fuzz("names.wgsl", text, "").expect(0);
    assert!(ran.out.contains("2 functions run, 0 not run"), "{ran:?}");
    for name in ["result: f32", "result_x: f32", "returned: f32 = "] {
        assert!(ran.out.contains(name), "{name}: {ran:?}");
    }
}

#[test]
fn functions_of_wgsl_get_textures_and_samplers_that_only_a_caller_has() {
    let text = "@group(0) @binding(0) var tex: texture_2d<f32>;\n@group(0) @binding(1) var smp: sampler;\n\
        fn fetch(t: texture_2d<f32>, p: vec2i) -> f32 { return textureLoad(t, p, 0).r; }\n\
        fn sampled(t: texture_2d<f32>, s: sampler, uv: vec2f) -> vec4f { return textureSample(t, s, uv) * 2.0; }\n\
        fn both(t: texture_2d<f32>, s: sampler, uv: vec2f) -> vec4f { return sampled(t, s, uv); }\n\
        fn wrong(t: texture_2d<f32>, s: sampler, uv: vec2f) -> f32 { return log(textureSampleLevel(t, s, uv, 0.0).r - 2.0); }\n\
        @fragment fn main(@location(0) uv: vec2f) -> @location(0) vec4f { return both(tex, smp, uv); }\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.wgsl"), text).unwrap();
    for lane in ["embedded", "vulkan"] {
        let ran = crate::binary::run_in(folder.path(), &format!("fuzz a.wgsl --samples 256 --lane {lane}")).expect(1);
        for function in ["fetch", "sampled", "both", "main"] {
            let line = ran.out.lines().find(|line| line.contains(&format!("  {function} "))).unwrap();
            assert!(line.starts_with("ok") && line.contains("agreed"), "{lane}: {line}\n{}", ran.out);
        }
        assert!(ran.out.contains("log(-1.") && ran.out.contains("textures of wrong: t: 2D"), "{}", ran.out);
    }
}

#[test]
fn what_is_stated_counts_beside_what_is_taken() {
    let text = "fn f(x: f32) -> f32 {\n  var a: array<f32, #{N}>;\n  a[0] = x;\n#ifdef FANCY\n  return sqrt(a[0] - 9.0);\n\
                #else\n  return a[0];\n#endif\n}\n";
    let ran = fuzz("a.wgsl", text, "--define FANCY=1").expect(0);
    assert!(ran.out.contains("a.wgsl:5:10") && ran.err.contains("`N` is taken for"), "{ran:?}");
    let ran = fuzz("a.wgsl", text, "").expect(0);
    assert!(ran.out.contains("1 function run"), "{ran:?}");
    // What nothing asks for is told.
    let ran = fuzz("a.wgsl", text, "--define FANCI=1");
    assert!(ran.out.contains("there is no `override` constant `FANCI`"), "{ran:?}");
}

#[test]
fn a_module_that_an_engine_rewrites_is_no_error() {
    let text = |word: &str| {
        format!("{word} gain: f32;\n@fragment\nfn fs() -> @location(0) vec4f {{ return vec4f({word}.gain); }}\n")
    };
    let ran = fuzz("a.wgsl", &text("uniform"), "");
    assert!(ran.out.contains("not run: its engine rewrites declarations: a.wgsl:"), "{ran:?}");
    assert!(!ran.out.contains("does not compile"), "{ran:?}");
    let ran = fuzz("a.wgsl", &text("uniforn"), "").expect(1);
    assert!(ran.out.contains("does not compile"), "{ran:?}");
}

/// Fuzzes the whole of a kernel with these lines at its head, and one statement.
fn kernel(head: &str, statement: &str) -> Ran {
    let text = format!(
        "#version 450\n{head}\nlayout(local_size_x = 64) in;\nlayout(std430, binding = 0) buffer B {{ uint r[]; }};\n\
         void main() {{ uint i = gl_GlobalInvocationID.x; if (i < uint(r.length())) {{ {statement} }} }}\n"
    );
    fuzz("kernel.comp", &text, "")
}

#[test]
fn a_macro_that_the_text_asks_for_is_one_that_its_conditions_name() {
    let ran = kernel("#ifndef PHASE\n#error state it\n#endif", "\n#if PHASE == 3\nr[i] = i;\n#endif\n").expect(0);
    assert!(ran.err.contains("assumed --define PHASE=3"), "{ran:?}");
    assert!(ran.out.contains("1 function run, 0 not run"), "{ran:?}");
}

#[test]
fn what_only_prints_does_not_keep_a_kernel_from_running() {
    let head = "#extension GL_EXT_debug_printf : require";
    let ran = kernel(head, "r[i] = i; debugPrintfEXT(\"r %u\", r[i]);").expect(0);
    assert!(ran.out.contains("1 function run, 0 not run") && !ran.err.contains("debugPrintfEXT"), "{ran:?}");
}

#[test]
fn sizes_of_clusters_may_be_signed() {
    let head = "#extension GL_KHR_shader_subgroup_clustered : require";
    let ran = kernel(head, "r[i] = subgroupClusteredAdd(r[i], 16);");
    assert!(ran.out.contains("1 function run, 0 not run"), "{ran:?}");
}

#[test]
fn what_the_linter_leaves_to_the_host_is_no_error_here_either() {
    let text = "#extension GL_EXT_of_tomorrow : require\nvoid f(float x) { memoryBarrier(1, 64); }\n";
    let ran =
        fuzz("scoped.glsl", &format!("#version 460\n{text}float g(float x) {{ return x + 1.0; }}\n"), "").expect(0);
    assert!(ran.out.contains("f ") && ran.out.contains("not run: it does not compile"), "{ran:?}");
    assert!(ran.out.contains("1 function run, 1 not run") && !ran.out.contains("error["), "{ran:?}");
}

#[test]
fn arrays_of_a_fixed_length_hold_data() {
    let text = |length: &str| {
        format!(
            "#version 460\nlayout(local_size_x = 64) in;\nlayout(std430, binding = 0) readonly buffer A {{ uint set[{length}]; }};\n\
             layout(std430, binding = 1) buffer D {{ uint data[64]; }};\nvoid main() {{ uint i = gl_LocalInvocationIndex;\n\
             uint left = set[i]; while (left > 0u) {{ data[i] = 1u; left &= left - 1u; }} }}\n"
        )
    };
    for length in ["64", ""] {
        let ran = fuzz("set.comp", &text(length), "").expect(0);
        assert!(ran.out.contains("1 function run") && !ran.out.contains("nothing is stored"), "{length}: {ran:?}");
    }
}

/// What is wrong with one function of a piece is told, and names that it lacks beside that keep nothing from being run. What no
/// reading of a piece mends is not its error.
#[test]
fn an_error_beside_names_that_are_lacking_leaves_the_rest_to_be_run() {
    let bad = "float bad(float x) { return sqrt(-1.0 - x * x * gain * gain); }\n";
    let ran =
        fuzz("a.glsl", &format!("{bad}float all(vec2 v) {{ float b = v; return b + strength; }}\n"), "").expect(1);
    assert!(ran.out.contains("a.glsl:1:") && ran.out.contains("sqrt(-"), "{ran:?}");
    assert!(ran.out.contains("T003") && !ran.out.contains("is not declared"), "{ran:?}");
    // An error that what stands for `strength` brings is nobody's, and the others run.
    let ran = fuzz("d.glsl", &format!("{bad}float all(vec2 v) {{ return v + strength; }}\n"), "");
    assert!(ran.out.contains("sqrt(-") && ran.out.contains("all                  not run"), "{ran:?}");
    assert!(ran.code == 0 && !ran.out.contains("error["), "{ran:?}");
    let right = bad.replace("-1.0 - ", "1.0 + ");
    let ran = fuzz("b.glsl", &format!("{right}float all(float v) {{ return v + strength; }}\n"), "");
    assert!(ran.code == 0 && ran.out.contains("0 not run, 0 findings"), "{ran:?}");
    // A number that only some compilers read, in one function.
    let ran = fuzz("c.glsl", &format!("{right}float part(Vertex v) {{ return v.x * (1f / 65536.0); }}\n"), "");
    assert!(ran.code == 0 && ran.out.contains("ok    bad") && ran.out.contains("part"), "{ran:?}");
}

#[test]
fn a_text_that_a_prelude_completes_lacks_what_its_host_declares_elsewhere() {
    let text = "void mainImage(out vec4 color, in vec2 at) {\n  vec2 uv = at / max(iResolution.xy, 1.0);\n  \
        vec3 c = palette(uv.x * SPEED);\n  color = vec4(c * hash12(uv), 1.0);\n}\n";
    let ran = fuzz("image.glsl", text, "");
    assert!(ran.code == 0 && ran.out.contains("0 not run, 0 findings"), "{ran:?}");
    let wrong = text.replace("  vec3 c = ", "  vec3 d = uv;\n  vec3 c = ");
    let ran = fuzz("image.glsl", &wrong, "");
    assert!(ran.code == 1 && ran.out.contains("image.glsl:3:"), "{ran:?}");
}

#[test]
fn the_name_of_an_include_guard_is_not_what_a_text_lacks() {
    let text = "#ifndef RANDOM_HLSL\n#define RANDOM_HLSL\nuint mixed(uint a) { return a * 3u; }\n\
        uint pixel() { return declared_nowhere().x; }\n#endif\n";
    let ran = fuzz("random.hlsl", text, "");
    assert!(ran.code != 0 && !ran.err.contains("RANDOM_HLSL=1") && ran.out.contains("does not compile"), "{ran:?}");
}
