//! What a host binds beside numbers, and texts that its host has more to say to: each runs, has a fault that is found, and a
//! twin without it.

use std::fs;

use crate::binary::{Ran, run_in};

/// Runs a file with one of two expressions in the place of `FAULT`: one without a value, and one that has one everywhere.
fn both(name: &str, text: &str, arguments: &str) -> [Ran; 2] {
    ["sqrt(-1.0 - x * x)", "sqrt(1.0 + x * x)"].map(|fault| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), text.replace("FAULT", fault)).unwrap();
        run_in(folder.path(), &format!("fuzz {name} --lane embedded --samples 1024 {arguments}"))
    })
}

/// What the run has something else for is not translated.
#[test]
fn what_no_translation_says_is_refused_by_name() {
    for (head, x, said) in [
        ("layout(binding = 0) uniform sampler2D all[];", "texture(all[id], uv).x", "array of samplers"),
        ("layout(binding = 0) uniform usampler2D own;", "float(texture(own, uv).x)", "`texture` of a `usampler2D`"),
        (
            "layout(input_attachment_index = 0, binding = 0) uniform subpassInput own;",
            "subpassLoad(own).x",
            "an input attachment",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.frag"), fragment(head, x).replace("FAULT", "x")).unwrap();
        let ran = run_in(folder.path(), "translate a.frag --to wgsl");
        assert!(ran.code == 1 && ran.err.contains(said), "{ran:?}");
    }
    let folder = tempfile::tempdir().unwrap();
    let samples = fragment("layout(binding = 0) uniform sampler2DMS own;", "texelFetch(own, ivec2(3), 1).x");
    fs::write(folder.path().join("a.frag"), samples.replace("FAULT", "x")).unwrap();
    let ran = run_in(folder.path(), "translate a.frag --to wgsl");
    assert!(ran.code == 0 && ran.out.contains("texture_multisampled_2d<f32>"), "{ran:?}");
}

/// The first has a finding or a warning, the second none, and both run whole.
fn told([wrong, right]: &[Ran; 2], what: &str) {
    for ran in [wrong, right] {
        assert!(ran.out.contains("0 not run") && !ran.out.contains("does not compile"), "{ran:?}");
    }
    assert!(wrong.out.contains(what), "{wrong:?}");
    assert!(right.out.contains("0 findings, 0 warnings") && !right.out.contains(what), "{right:?}");
}

const NO_VALUE: &str = "has no value: sqrt(-";

fn fragment(head: &str, x: &str) -> String {
    format!(
        "#version 450\n#extension GL_EXT_nonuniform_qualifier : require\n{head}\nlayout(location = 0) in vec2 uv;\n\
         layout(location = 1) flat in uint id;\nlayout(location = 0) out float color;\n\
         void main() {{ float x = {x}; color = FAULT; }}\n"
    )
}

#[test]
fn textures_of_an_array_of_any_length_are_chosen_by_a_computed_index() {
    for (head, x) in [
        ("layout(binding = 0) uniform sampler2D all[];", "texture(all[nonuniformEXT(id)], uv).x"),
        ("layout(binding = 0) uniform sampler2D all[4096];", "texture(all[id], uv).x"),
        (
            "layout(binding = 0) uniform texture2D all[];\nlayout(binding = 1) uniform sampler linear;",
            "texture(nonuniformEXT(sampler2D(all[id], linear)), uv).x",
        ),
    ] {
        told(&both("a.frag", &fragment(head, x), ""), NO_VALUE);
    }
}

#[test]
fn an_input_attachment_and_the_samples_of_a_pixel_are_fed() {
    let subpass = "layout(input_attachment_index = 0, binding = 0) uniform";
    for (head, x) in [
        (format!("{subpass} subpassInput own;"), "subpassLoad(own).x"),
        (format!("{subpass} usubpassInput own;"), "float(subpassLoad(own).x & 255u)"),
        (format!("{subpass} subpassInputMS own;"), "subpassLoad(own, 2).x"),
        ("layout(binding = 0) uniform sampler2DMS own;".to_owned(), "texelFetch(own, ivec2(uv * 7.0), int(id)).x"),
    ] {
        told(&both("a.frag", &fragment(&head, x), ""), NO_VALUE);
    }
    // Not every sample holds the same.
    let text = fragment("layout(binding = 0) uniform sampler2DMS own;", "0.0");
    let texel = |sample: u32| format!("texelFetch(own, ivec2(3), {sample}).x");
    let text = text.replace("FAULT", &format!("sqrt({} == {} ? -1.0 : 1.0)", texel(0), texel(1)));
    let [ran, _] = both("a.frag", &text, "");
    assert!(ran.out.contains("0 findings, 0 warnings") && ran.out.contains("0 not run"), "{ran:?}");
}

#[test]
fn texels_of_whole_numbers_are_those_in_which_their_coordinates_lie() {
    let head = "layout(binding = 0) uniform usampler2D own;\nlayout(binding = 1) uniform isampler2DArray layers;";
    let at = "clamp(ivec2(floor(uv * vec2(textureSize(own, 0)))), ivec2(0), textureSize(own, 0) - 1)";
    let text = fragment(head, "float(texture(layers, vec3(uv, 1.0)).x & 7)");
    told(&both("a.frag", &text, ""), NO_VALUE);
    for (right, by) in [(true, "ivec2(0)"), (false, "ivec2(1, 0)")] {
        let same = format!("texture(own, uv) == texelFetch(own, min({at} + {by}, textureSize(own, 0) - 1), 0)");
        let [ran, _] = both("a.frag", &text.replace("FAULT", &format!("sqrt({same} ? 1.0 : -1.0)")), "");
        assert_eq!(ran.out.contains("has no value: sqrt(-1"), !right, "{ran:?}");
    }
}

#[test]
fn a_uniform_of_more_structures_than_are_fed_is_run() {
    let text = "struct Light { at: vec4f, size: f32, }\n@group(0) @binding(0) var<uniform> lights: array<Light, 200>;\n\
        @fragment fn fs(@location(0) uv: vec2f) -> @location(0) f32 { let x = lights[2].size * uv.x; return FAULT; }\n";
    told(&both("a.wgsl", text, ""), NO_VALUE);
    let text = fragment(
        "struct Light { vec4 at; float size; };\nlayout(binding = 0) uniform Lights { Light lights[200]; };",
        "lights[2].size * uv.x + lights[190].size",
    );
    told(&both("a.frag", &text, ""), NO_VALUE);
}

#[test]
fn names_that_a_host_always_defines_are_found_together() {
    let module = "#define_import_path app::lib\n#ifdef PADDED\nconst PAD: f32 = 2.0;\n#endif\n\
        fn depth(z: f32) -> f32 {\n#ifdef PLANE\n    return z;\n#endif\n#ifdef SPACE\n    return z + 1.0;\n#endif\n}\n";
    let text = "#import app::lib\n\
        @fragment fn fs(@location(0) x: f32) -> @location(0) f32 { return app::lib::depth(x) + app::lib::PAD + FAULT; }\n";
    let runs = ["sqrt(-1.0 - x * x)", "sqrt(1.0 + x * x)"].map(|fault| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("lib.wgsl"), module).unwrap();
        fs::write(folder.path().join("a.wgsl"), text.replace("FAULT", fault)).unwrap();
        run_in(folder.path(), "fuzz a.wgsl --lane embedded --samples 1024")
    });
    told(&runs, NO_VALUE);
    // What no name mends stays an error.
    let folder = tempfile::tempdir().unwrap();
    let broken = module.replace("return z;", "return true;").replace("return z + 1.0;", "return true;");
    fs::write(folder.path().join("lib.wgsl"), broken).unwrap();
    let ran = run_in(folder.path(), "fuzz lib.wgsl --lane embedded --samples 1024").expect(1);
    assert!(ran.out.contains("1 file does not compile"), "{ran:?}");
}

#[test]
fn shaders_that_a_host_puts_together_by_sums_and_macros_are_run() {
    let lines = "\"in float x;\\n\"\n    \"out vec4 c;\\n\"\n    \"void main() { c = vec4(FAULT); }\\n\";\n";
    for (head, start) in [
        ("#include <string>\n", "static const std::string fsSrc =\n    version() +\n    "),
        ("#define VERSION_330 shared_version\n", "static const char *fragment_shader = VERSION_330\n    "),
    ] {
        let text = format!("{head}{start}{lines}GLuint f = glCreateShader(GL_FRAGMENT_SHADER);\n");
        told(&both("host.cpp", &text, ""), NO_VALUE);
    }
    // A number in the middle of a line is no text between lines.
    let text = "static const std::string fsSrc = \"const int N = \" + number + \";\\nfloat f(float x) { return FAULT; }\\n\";\n";
    let [ran, _] = both("host.cpp", text, "");
    assert!(ran.code != 0 && !ran.out.contains(NO_VALUE), "{ran:?}");
}

#[test]
fn functions_of_a_host_that_get_a_buffer_read_and_write_it() {
    let kernel = |at: &str| {
        format!(
            "#version 450\nlayout(local_size_x = 64) in;\nlayout(binding = 0) readonly buffer A {{ element from[]; }};\n\
             layout(binding = 1) buffer B {{ element to[]; }};\nlayout(push_constant) uniform P {{ int n; }} p;\n\
             void main() {{ int i = int(gl_GlobalInvocationID.x);\nif (i >= p.n) return;\n\
             store1(to, {at}, load1(from, i) * 2.0); }}\n"
        )
    };
    let folder = tempfile::tempdir().unwrap();
    let run = |at: &str| {
        fs::write(folder.path().join("k.comp"), kernel(at)).unwrap();
        run_in(folder.path(), "fuzz k.comp --lane embedded")
    };
    let (wrong, right) = (run("i / 2"), run("i"));
    assert!(wrong.out.contains("race") && !right.out.contains("race"), "{wrong:?} {right:?}");
    for ran in [&wrong, &right] {
        assert!(ran.err.contains("--define 'load1(from,at)=(from[at])'") && ran.out.contains("0 not run"), "{ran:?}");
    }
}

#[test]
fn what_only_a_host_or_another_reader_decides_is_not_run_and_no_error() {
    let folder = tempfile::tempdir().unwrap();
    for (text, why) in [
        ("fn f() -> f32 {\n    {{ declares_x }}\n    return x;\n}\n", "its host fills in placeholders"),
        (
            "@group(0) @binding(0) var<storage, read_write> data: array<f32>;\n\
             fn add(p: ptr<storage, array<f32>, read_write>, i: u32) { (*p)[i] = (*p)[i] + 1.0; }\n\
             @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) g: vec3u) { add(&data, g.x); }\n",
            "its reader here does not take it",
        ),
    ] {
        fs::write(folder.path().join("a.wgsl"), text).unwrap();
        let ran = run_in(folder.path(), "fuzz a.wgsl --lane embedded --samples 256").expect(2);
        assert!(ran.out.contains(why) && !ran.out.contains("does not compile"), "{ran:?}");
    }
    // A loop that waits for another answer of the host would end there.
    let kernel = |goes_on: &str| {
        format!(
            "#version 450\nlayout(local_size_x = 4) in;\nlayout(binding = 0) buffer B {{ float to[4]; }};\n\
             layout(push_constant) uniform P {{ float start; }} p;\n\
             void main() {{ float sum = 0.0; while ({goes_on}) sum += 1.0; to[gl_LocalInvocationIndex] = sum; }}\n"
        )
    };
    let runs = ["more()", "sum >= 0.0"].map(|goes_on| {
        fs::write(folder.path().join("k.comp"), kernel(goes_on)).unwrap();
        run_in(folder.path(), "fuzz k.comp --lane embedded --samples 1024")
    });
    let endless = "warning: main: this loop does not end";
    assert_eq!(runs.each_ref().map(|ran| ran.out.contains(endless)), [false, true], "{runs:?}");
}

/// Memory behind an address is a buffer like any other: a value that is missing, a race and what orders it, and a list that is
/// walked by its addresses.
#[test]
fn memory_behind_an_address_is_fed_and_watched() {
    let head = "#version 460\n#extension GL_EXT_buffer_reference : require\n";
    let vertex = format!(
        "{head}layout(buffer_reference, std430) readonly buffer Points {{ float x[]; }};\n\
         layout(push_constant) uniform Pushed {{ Points points; }} pushed;\nlayout(location = 0) out float color;\n\
         void main() {{ float x = pushed.points.x[gl_VertexIndex]; gl_Position = vec4(x); color = FAULT; }}\n"
    );
    let ran = both("a.vert", &vertex, "");
    told(&ran, NO_VALUE);
    assert!(ran[0].err.contains("each address of a buffer leads to memory of its own: `Points_points`"), "{ran:?}");
    let kernel = |add: &str| {
        let folder = tempfile::tempdir().unwrap();
        let text = format!(
            "{head}layout(local_size_x = 64) in;\n\
             layout(buffer_reference, std430) buffer Sum {{ uint total; }};\n\
             layout(push_constant) uniform Pushed {{ Sum sum; }};\nvoid main() {{ {add} }}\n"
        );
        fs::write(folder.path().join("a.comp"), text).unwrap();
        run_in(folder.path(), "fuzz a.comp --lane embedded")
    };
    told(&[kernel("sum.total += 1u;"), kernel("atomicAdd(sum.total, 1u);")], "race on `Sum_sum.total`");
    let list = kernel("Sum own = sum; for (int k = 0; k < 4; ++k) { own.total = 1u; own = Sum(uvec2(own.total)); }");
    assert!(list.out.contains("the member `sum`, whose type is one of an extension"), "{list:?}");
}

/// Memory is left as it was where a function or a stage in WGSL returns before it writes.
#[test]
fn memory_that_an_early_return_leaves_alone_has_its_value() {
    let text = "@group(0) @binding(0) var<storage, read_write> line: array<f32>;\n\
                fn delayed(input: f32, at: u32, wet: f32) -> f32 {\n  if (wet < 0.01) { return input; }\n\
                for (var k = 0u; k < 4u; k++) { if (k == at) { let x = line[k]; line[k] = FAULT; return x; } }\n\
                return input;\n}\n\
                @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) id: vec3u) {\n\
                if (id.x >= arrayLength(&line)) { return; }\n  let x = line[id.x];\n  line[id.x] = FAULT;\n}\n";
    told(&both("a.wgsl", text, ""), NO_VALUE);
}

#[test]
fn a_constant_of_zero_that_a_pipeline_sets_is_a_number_of_the_host() {
    let text = "#version 450\nlayout(local_size_x = 64) in;\nlayout(constant_id = 0) const float count = 0.0;\n\
        layout(binding = 0) buffer A { float a[]; };\n\
        void main() { uint i = gl_GlobalInvocationID.x; if (i >= a.length()) return;\n\
        float x = a[i] / count; a[i] = FAULT; }\n";
    let [wrong, right] = both("mean.comp", text, "");
    assert!(wrong.code == 1 && wrong.out.contains(NO_VALUE), "{wrong:?}");
    // Nobody says that it is 0.
    assert!(right.code == 0 && right.out.contains("count"), "{right:?}");
    let fixed = text.replace("const float count = 0.0", "const float count = 4.0");
    let [wrong, right] = both("mean.comp", &fixed, "");
    assert!(wrong.code == 1 && right.code == 0 && !right.out.contains("count"), "{wrong:?} {right:?}");
}

#[test]
fn stages_of_ray_tracing_are_run_with_the_ray_as_input() {
    let head =
        "#version 460\n#extension GL_EXT_ray_tracing : require\nlayout(location = 0) rayPayloadInEXT vec3 color;\n";
    let miss = format!(
        "{head}void main() {{ vec3 d = normalize(gl_WorldRayDirectionEXT + vec3(0.0, 0.0, 4.0)); float x = d.y;\n\
         color = vec3(FAULT); }}\n"
    );
    told(&both("sky.rmiss", &miss, ""), NO_VALUE);
    let hit = format!(
        "{head}hitAttributeEXT vec2 at;\nvoid main() {{ float x = at.x + gl_ObjectToWorldEXT[3].y;\n\
         color = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT + vec3(FAULT); }}\n"
    );
    told(&both("surface.rchit", &hit, ""), NO_VALUE);
    // A stage writes to a part of what the ray carries.
    let part = "#version 460\n#extension GL_EXT_ray_tracing : require\nstruct Hit { vec3 color; float t; };\n\
        layout(location = 0) rayPayloadInEXT Hit info;\n\
        void main() { float x = gl_WorldRayDirectionEXT.y; info.color = vec3(FAULT); }\n";
    told(&both("part.rmiss", part, ""), NO_VALUE);
}

#[test]
fn bits_of_no_number_that_are_written_as_such_are_meant() {
    let text = "fn none() -> f32 { return bitcast<f32>(0x7fc00000u); }\nfn endless() -> f32 { return bitcast<f32>(0x7f800000u); }\n\
        fn f(x: f32) -> f32 { if (x > 5e8) { return none() + endless(); } return FAULT; }\n";
    told(&both("none.wgsl", text, ""), NO_VALUE);
}

#[test]
fn a_list_of_vertices_names_each_of_them_once() {
    let text = "#version 460\n#extension GL_EXT_ray_tracing : require\nlayout(location = 0) rayPayloadInEXT vec3 color;\n\
        layout(binding = 0) readonly buffer V { vec4 at[]; };\nlayout(binding = 1) readonly buffer I { uint list[]; };\n\
        void main() { vec3 a = at[list[0]].xyz; vec3 b = at[list[1]].xyz; vec3 c = at[list[2]].xyz; float x = a.x;\n\
        color = normalize(cross(b - a, c - a)) * FAULT; }\n";
    let [wrong, right] = both("face.rchit", text, "");
    assert!(wrong.code == 1 && wrong.out.contains(NO_VALUE), "{wrong:?}");
    assert!(right.code == 0 && right.out.contains("0 findings"), "{right:?}");
    let same = text.replace("at[list[2]]", "at[list[1]]");
    let [_, right] = both("face.rchit", &same, "");
    assert!(right.code == 1 && right.out.contains("of a zero vector"), "{right:?}");
}

#[test]
fn an_index_in_front_of_an_array_is_outside_of_any_length() {
    let text = "#version 450\nlayout(local_size_x = 64) in;\n\
        layout(std430, binding = 0) buffer A { float a[]; };\nlayout(std430, binding = 1) buffer B { float b[]; };\n\
        uniform int n;\nuniform int pad;\nvoid main() {\n  int i = int(gl_GlobalInvocationID.x);\n  if (i >= n) return;\n  \
        b[i] = a[(i - 1) % n] + a[(i + 1) % n];\n}\n";
    let ran = both("a.comp", text, "");
    for ran in &ran {
        let told = "warning: main: invocation 0 reads `A` at index";
        assert!(ran.out.contains(told) && ran.out.contains("in front of its first element"), "{}{}", ran.out, ran.err);
    }
    for right in [text.replace("(i - 1) % n", "(i - 1 + n) % n"), text.replace("(i - 1) % n", "(i - pad) % n")] {
        for ran in both("a.comp", &right, "") {
            assert!(ran.out.contains("0 findings, 0 warnings"), "{}{}", ran.out, ran.err);
        }
    }
}
