//! `shadercheck init`: suites for shaders that have none.

use std::fs;
use std::path::Path;

use super::folder;
use crate::binary::{Ran, command, run_in};

const VERTEX: &str = "#version 330 core\nlayout(location = 0) in vec3 aPos;\nlayout(location = 1) in vec3 aNormal;\n\
    layout(location = 2) in vec2 aTexCoord;\nuniform mat4 model;\nuniform mat4 view;\nuniform mat4 projection;\n\
    uniform float time;\nout vec3 normal;\nout vec2 uv;\nvoid main() {\n  normal = mat3(model) * aNormal;\n\
    uv = aTexCoord + vec2(0.25 * time, 0.0);\n  gl_Position = projection * view * model * vec4(aPos, 1.0);\n}\n";
const LIBRARY: &str = "float cube(float x) { return x * x * x; }\nfloat mixed(float a, float b, float t) { return a + t * (b - a); }\n\
    float mixed2(float a) { return mixed(a, 1.0, 0.5); }\n\
    vec3 facing(vec3 normal, vec3 dir) { return dot(normal, dir) < 0.0 ? -normal : normal; }\n";

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn check(folder: &Path, args: &str) -> Ran {
    command(folder, &format!("check . --lane embedded {args}")).output().unwrap().into()
}

#[test]
fn what_is_written_passes() {
    let folder = folder(&[("basic.vert", VERTEX), ("lib.glsl", LIBRARY)]);
    let ran = run_in(folder.path(), "init").expect(0);
    let suites = ["basic", "lib_cube", "lib_facing", "lib_mixed", "lib_mixed2"];
    for suite in suites {
        assert!(ran.out.contains(&format!("\n  {suite}: ")), "{}", ran.out);
    }
    assert!(ran.out.contains("wrote basic.suite.toml\n") && ran.out.contains("wrote lib.suite.toml\n"), "{}", ran.out);
    assert!(!ran.out.contains("does not pass"), "{}", ran.out);
    assert!(
        ran.out.contains("wrote shadercheck.toml") && ran.out.contains("shadercheck check . --require-lane vulkan")
    );
    let text = |name: &str| fs::read_to_string(folder.path().join(format!("{name}.suite.toml"))).unwrap();
    let vertex = text("basic");
    for part in [
        "names = [\"projection\"]\ngenerator = \"projection\"",
        "taken for a direction\nnames = [\"aNormal\"]\ngenerator = \"direction\"",
        "taken for texture coordinates\nnames = [\"aTexCoord\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]",
        "taken for a time\nnames = [\"time\"]",
    ] {
        assert!(vertex.contains(part), "{part}\n{vertex}");
    }
    // Laws that hold are found, and no others.
    let library = text("lib");
    let of = |name: &str| library.split("[[suites]]").find(|part| part.contains(&format!("suite = {name:?}"))).unwrap();
    assert!(of("lib_cube").contains("{ kind = \"odd\", inputs = [\"x\"] }"), "{library}");
    assert!(!of("lib_cube").contains("even"), "{library}");
    assert!(of("lib_facing").contains("{ kind = \"unit\", outputs = [\"return\"] }"), "{library}");
    // An editor finds the schema.
    assert!(library.starts_with("#:schema suite.schema.json\nshader = \"lib.glsl\"\n"), "{library}");
    assert!(folder.path().join("suite.schema.json").exists());
    let ran = command(folder.path(), "check lib.suite.toml[lib_cube] --lane embedded").output().unwrap();
    assert!(String::from_utf8_lossy(&ran.stdout).contains("ok    lib_cube "), "{ran:?}");
    let ran = check(folder.path(), "").expect(0);
    assert_eq!(ran.out.lines().filter(|line| line.starts_with("ok ")).count(), suites.len(), "{}", ran.out);
    // And the configuration is one.
    run_in(folder.path(), "lint .").expect(0);
}

#[test]
fn a_fault_that_comes_later_is_noticed_by_the_laws() {
    let folder = folder(&[("lib.glsl", "float cube(float x) { return x * x * x; }\n")]);
    run_in(folder.path(), "init").expect(0);
    fs::write(folder.path().join("lib.glsl"), "float cube(float x) { return x * x * x + 0.001; }\n").unwrap();
    let ran = check(folder.path(), "").expect(1);
    assert!(ran.out.contains("the relation `odd(x)` does not hold"), "{}", ran.out);
}

/// A sum by one workgroup; the wrong twin forgets the barrier behind a step.
fn sum(barrier: &str) -> String {
    format!(
        "@group(0) @binding(0) var<storage, read> values: array<f32>;\n\
         @group(0) @binding(1) var<storage, read_write> sums: array<f32>;\n\
         var<workgroup> part: array<f32, 8>;\n\
         @compute @workgroup_size(8)\n\
         fn main(@builtin(local_invocation_index) k: u32, @builtin(global_invocation_id) id: vec3u,\n\
                 @builtin(workgroup_id) group: vec3u) {{\n\
             part[k] = 0.0;\n\
             if (id.x < arrayLength(&values)) {{ part[k] = values[id.x]; }}\n\
             workgroupBarrier();\n\
             for (var half = 4u; half > 0u; half >>= 1u) {{\n\
                 if (k < half) {{ part[k] += part[k + half]; }}\n\
                 {barrier}\n\
             }}\n\
             if (k == 0u) {{ sums[group.x] = part[0]; }}\n\
         }}\n"
    )
}

#[test]
fn a_compute_stage_gets_a_suite_in_awkward_sizes() {
    let folder = folder(&[("sum.wgsl", &sum("workgroupBarrier();"))]);
    let ran = run_in(folder.path(), "init sum.wgsl").expect(0);
    assert!(ran.out.contains("wrote sum.suite.toml\n  sum: 1 input, 1 law\n"), "{ran:?}");
    assert!(!ran.out.contains("does not pass"), "{ran:?}");
    let suite = fs::read_to_string(folder.path().join("sum.suite.toml")).unwrap();
    for part in [
        "stage = \"compute\"",
        "{ kind = \"additive\", inputs = [\"values\"], outputs = [\"sums\"] }",
        "groups = [\"(N + 7) / 8\"]",
        "lengths = { values = \"N\", sums = \"(N + 7) / 8\" }",
        "sizes = { N = [1, 7, 8, 9] }",
        "names = [\"values\"]\ngenerator = \"array\"",
    ] {
        assert!(suite.contains(part), "{part}\n{suite}");
    }
    let ran = check(folder.path(), "").expect(0);
    assert_eq!(ran.out.lines().filter(|line| line.starts_with("ok ")).count(), 4, "{}", ran.out);
    // A fault that comes later: the kernel forgets what is in the last workgroup.
    let text =
        sum("workgroupBarrier();").replace("id.x < arrayLength(&values)", "id.x < arrayLength(&values) / 8u * 8u");
    fs::write(folder.path().join("sum.wgsl"), text.replace("sums[group.x] = part[0]", "sums[group.x] = part[0] + 1.0"))
        .unwrap();
    let ran = check(folder.path(), "").expect(1);
    assert!(ran.out.contains("the relation `additive(values)` does not hold"), "{}", ran.out);
}

#[test]
fn a_compute_stage_that_races_gets_a_suite_that_says_so() {
    let folder = folder(&[("sum.wgsl", &sum(""))]);
    let ran = run_in(folder.path(), "init sum.wgsl").expect(0);
    assert!(ran.out.contains("does not pass: sum.wgsl:11:") && ran.out.contains("race on `part["), "{ran:?}");
    let suite = fs::read_to_string(folder.path().join("sum.suite.toml")).unwrap();
    assert!(suite.contains("\n# Found when this was written: sum.wgsl:11:"), "{suite}");
    check(folder.path(), "").expect(1);
}

#[test]
fn whole_workgroups_are_drafted_where_nothing_guards_the_last_one() {
    let kernel = |guard: &str| {
        format!(
            "#version 450\nlayout(local_size_x = 8) in;\n\
             layout(std430, binding = 0) readonly buffer A {{ float a[]; }};\n\
             layout(std430, binding = 1) writeonly buffer B {{ float b[]; }};\n\
             void main() {{ uint i = gl_GlobalInvocationID.x; {guard} b[i] = 2.0 * a[i]; }}\n"
        )
    };
    let drafted = |guard: &str| {
        let folder = folder(&[("twice.comp", &kernel(guard))]);
        let ran = run_in(folder.path(), "init twice.comp").expect(0);
        let suite = fs::read_to_string(folder.path().join("twice.suite.toml")).unwrap();
        (ran.out.contains("does not pass"), suite)
    };
    let (wrong, suite) = drafted("");
    assert!(!wrong && suite.contains("sizes = { N = [8, 16] }") && suite.contains("# Nothing keeps away"), "{suite}");
    // A guard that is off by one is a fault, and shows at the sizes that fill no workgroup.
    let (wrong, suite) = drafted("if (i > a.length()) return;");
    assert!(wrong && suite.contains("sizes = { N = [1, 7, 8, 9] }"), "{suite}");
    let (wrong, suite) = drafted("if (i >= a.length()) return;");
    assert!(!wrong && suite.contains("sizes = { N = [1, 7, 8, 9] }"), "{suite}");
}

#[test]
fn structures_indices_and_counts_of_a_compute_stage_are_guessed() {
    let text = "#version 450\nlayout(local_size_x = 4) in;\nstruct Boid { vec2 at; float age; };\n\
        layout(std430, binding = 0) readonly buffer Boids { Boid boids[]; };\n\
        layout(std430, binding = 1) readonly buffer Order { uint order[]; };\n\
        layout(std430, binding = 2) writeonly buffer Ages { float ages[]; };\n\
        layout(std430, binding = 3) buffer Bins { uint bins[3]; };\n\
        layout(std430, binding = 4) readonly buffer Keys { uint keys[]; };\n\
        layout(std140, binding = 5) uniform Params { uint count; float dt; };\n\
        void main() { uint i = gl_GlobalInvocationID.x; if (i >= count) return;\n\
          ages[i] = boids[order[i]].age + dt; atomicAdd(bins[keys[i]], 1u); }\n";
    let folder = folder(&[("boids.comp", text)]);
    let ran = run_in(folder.path(), "init boids.comp").expect(0);
    assert!(!ran.out.contains("does not pass"), "{ran:?}");
    let suite = fs::read_to_string(folder.path().join("boids.suite.toml")).unwrap();
    for part in [
        "names = [\"count\"]\ngenerator = \"constant\"\nvalues = [\"N\"]",
        "names = [\"order\"]\ngenerator = \"permutation\"",
        "names = [\"keys\"]\ngenerator = \"array\"\nrange = [0, 2]",
        "names = [\"bins\"]\ngenerator = \"constant\"\nvalues = [0]",
        "\"boids[].age\"",
    ] {
        assert!(suite.contains(part), "{part}\n{suite}");
    }
    check(folder.path(), "").expect(0);
}

#[test]
fn nothing_is_written_over() {
    let folder = folder(&[
        ("lib.glsl", LIBRARY),
        ("lib.suite.toml", "mine\n"),
        ("shadercheck.toml", "# mine\n"),
        ("other.suite.toml", "suite = \"other\"\nshader = \"lib.glsl\"\nstage = \"function\"\nentry = \"facing\"\n"),
    ]);
    let ran = run_in(folder.path(), "init").expect(0);
    assert!(ran.out.contains("wrote lib_2.suite.toml\n  lib_cube: "), "{}", ran.out);
    assert!(ran.err.contains("left out: `facing` of lib.glsl has a suite already"), "{}", ran.err);
    assert_eq!(fs::read_to_string(folder.path().join("lib.suite.toml")).unwrap(), "mine\n");
    assert_eq!(fs::read_to_string(folder.path().join("shadercheck.toml")).unwrap(), "# mine\n");
    let before = names(folder.path());
    run_in(folder.path(), "init").expect(0);
    assert_eq!(names(folder.path()), before, "a second time nothing is new");
}

#[test]
fn a_dry_run_writes_nothing() {
    let folder = folder(&[("lib.glsl", LIBRARY)]);
    let ran = run_in(folder.path(), "init --dry-run").expect(0);
    assert!(ran.out.contains("would write lib.suite.toml"), "{}", ran.out);
    assert_eq!(names(folder.path()), ["lib.glsl"]);
}

#[test]
fn what_cannot_run_is_reported() {
    let folder = folder(&[
        ("broken.vert", "#version 330\nin vec3 p;\nvoid main() { gl_Position = vec4(q, 1.0); }\n"),
        ("plain.frag", "#version 330\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n"),
        ("none.txt", "no shader"),
        (
            "lit.frag",
            "#version 330\nuniform sampler2D t;\nout vec4 c;\nvec4 look(vec2 uv) { return texture(t, uv); }\nvoid main() { c = look(vec2(0.5)); }\n",
        ),
    ]);
    let ran = run_in(folder.path(), "init").expect(0);
    assert!(ran.err.contains("left out: lit.frag: it takes nothing that could be varied"), "{}", ran.err);
    assert!(ran.err.contains("left out: broken.vert: broken.vert:3:34: error["), "{}", ran.err);
    assert!(ran.err.contains("left out: plain.frag"), "{}", ran.err);
    let left = [
        "broken.vert",
        "lit.frag",
        "lit.suite.toml",
        "none.txt",
        "plain.frag",
        "shadercheck.toml",
        "suite.schema.json",
    ];
    assert_eq!(names(folder.path()), left);
    let empty = tempfile::tempdir().unwrap();
    assert!(run_in(empty.path(), "init").expect(2).err.contains("`.` holds no shader"));
    assert!(run_in(empty.path(), "init gone").expect(2).err.contains("there is no file or folder `gone`"));
}

/// The interpreter keeps more than a device promises: what is written passes on devices too.
#[test]
fn floors_are_those_of_devices() {
    let text = "float at(vec3 p, float time) { return length(p - vec3(sin(time), 0.0, 0.0)) - 0.4; }\n\
        vec3 slope(vec3 p, float time) { const vec2 e = vec2(3e-3, 0.0);\n\
        return normalize(vec3(at(p + e.xyy, time) - at(p - e.xyy, time), at(p + e.yxy, time) - at(p - e.yxy, time),\n\
        at(p + e.yyx, time) - at(p - e.yyx, time))); }\n";
    let folder = folder(&[("ball.glsl", text)]);
    run_in(folder.path(), "init").expect(0);
    let suite = fs::read_to_string(folder.path().join("ball.suite.toml")).unwrap();
    assert!(suite.contains("[suites.floors]\nundetermined = ") && suite.contains("reason = \"no promise"), "{suite}");
    let ran: Ran = command(folder.path(), "check . --lane vulkan").output().unwrap().into();
    ran.expect(0);
}

#[test]
fn a_function_without_the_memory_of_its_stage_gets_a_suite() {
    let shader = "#version 430\nlayout(local_size_x = 1) in;\nlayout(std430, binding = 0) buffer B { float x[]; };\n\
        float half_of(float a) { return 0.5 * a; }\nfloat first(float a) { return a + x[0]; }\n\
        void main() { x[0] = half_of(first(x[1])); }\n";
    let folder = folder(&[("a.comp", shader)]);
    let ran = run_in(folder.path(), "init").expect(0);
    assert!(ran.out.contains("\n  a_half_of: "), "{ran:?}");
    assert!(ran.err.contains("`first` of") && ran.err.contains("memory that is written or read"), "{ran:?}");
}

#[test]
fn what_comes_of_a_guessed_range_is_a_warning_that_names_its_line() {
    let text = "float curve(float c, float k) { return pow(c - 1.0, 2.4) * k; }\n";
    let folder = folder(&[("curve.glsl", text)]);
    let ran = run_in(folder.path(), "init").expect(0);
    assert!(!ran.out.contains("does not pass"), "{}", ran.out);
    let ran = check(folder.path(), "").expect(0);
    let line = "delete `guessed = true`, at ./curve.suite.toml:19:11 (`c`, `k`)";
    assert!(ran.out.contains("warning: curve on embedded/compute: the shader gives an undefined value"), "{}", ran.out);
    assert!(ran.out.contains(line) || ran.out.contains(&line.replace("./", "")), "{}", ran.out);
    // Once somebody states it, it is the shader that is wrong.
    let suite = folder.path().join("curve.suite.toml");
    let stated: String = fs::read_to_string(&suite)
        .unwrap()
        .lines()
        .filter(|line| !line.starts_with("guessed"))
        .map(|l| format!("{l}\n"))
        .collect();
    fs::write(&suite, stated).unwrap();
    let ran = check(folder.path(), "").expect(1);
    assert!(ran.out.contains("curve on embedded/compute: the shader gives an undefined value"), "{}", ran.out);
}

#[test]
fn what_the_text_does_wrong_is_an_error_whatever_is_guessed() {
    let text = "float unset(float c) { float x; return x + c; }\n";
    let suite = "suite = \"unset\"\nshader = \"unset.glsl\"\nstage = \"function\"\nentry = \"unset\"\n\
        [[inputs]]\nnames = [\"c\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]\nguessed = true\n";
    let folder = folder(&[("unset.glsl", text), ("unset.suite.toml", suite)]);
    check(folder.path(), "").expect(1);
}

#[test]
fn a_suite_that_nothing_could_fail_is_not_written() {
    let text = "float never(float d) { return fract(sin(1e5 * d) * 43758.5453); }\n\
        // shadercheck: h in [0, 1]\nfloat stated(float h) { return sqrt(h); }\n";
    let folder = folder(&[("lib.glsl", text)]);
    let ran = run_in(folder.path(), "init").expect(0);
    assert!(
        ran.err.contains("left out: `never` of lib.glsl: ") && ran.err.contains(" % of its samples are inconclusive"),
        "{}",
        ran.err
    );
    // What a comment states is no guess, and a law that was checked at one place was not seen to hold.
    let suite = fs::read_to_string(folder.path().join("lib.suite.toml")).unwrap();
    assert!(
        suite.contains("# stated in the shader\nnames = [\"h\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]\n"),
        "{suite}"
    );
    assert!(!suite.contains("guessed") && !suite.contains("\"odd\""), "{suite}");
}

#[test]
fn several_suites_in_a_file_share_what_stands_at_its_top() {
    let shader = "float twice(float x) { return 2.0 * x; }\nfloat half_of(float x) { return 0.5 * x; }\n";
    let one = |name: &str, more: &str| {
        format!(
            "[[suites]]\nsuite = {name:?}\nentry = {name:?}\n{more}[[suites.inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\n\
             range = [0.0, 1.0]\n"
        )
    };
    let top = "shader = \"f.glsl\"\nstage = \"function\"\nsamples = 256\n";
    let text = format!("{top}{}{}", one("twice", ""), one("half_of", "samples = 64\n"));
    let good = folder(&[("f.glsl", shader), ("f.suite.toml", &text)]);
    let ran = check(good.path(), "").expect(0);
    assert!(ran.out.contains("ok    twice ") && ran.out.contains("(320 samples, 2 suites)"), "{}", ran.out);
    for (text, message) in [
        (format!("{top}{}{}", one("twice", ""), one("twice", "")), "the suite `twice` stands twice in this file"),
        (format!("{top}suites = []\n"), "`suites` is empty"),
        (
            format!("{top}{}", one("twice", "sample = 1\n")),
            "f.suite.toml:7:1: unknown key `sample`; did you mean `samples`?",
        ),
        (format!("{top}suites = [1]\n"), "`suites` is a list of tables [[suites]]"),
    ] {
        let bad = folder(&[("f.glsl", shader), ("f.suite.toml", &text)]);
        let ran = check(bad.path(), "").expect(2);
        assert!(format!("{}{}", ran.out, ran.err).contains(message), "{message}: {ran:?}");
    }
}

#[test]
fn several_shaders_are_named_at_once() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("more")).unwrap();
    for name in ["a.glsl", "b.glsl", "other.glsl", "more/c.glsl"] {
        fs::write(folder.path().join(name), "float f(float x) { return x * x; }\n").unwrap();
    }
    let ran = run_in(folder.path(), "init a.glsl b.glsl ./a.glsl more").expect(0);
    for written in ["wrote a.suite.toml", "wrote b.suite.toml", "wrote more/c.suite.toml"] {
        assert_eq!(ran.out.matches(written).count(), 1, "{written}\n{}", ran.out);
    }
    assert!(!ran.out.contains("other"), "{}", ran.out);
    assert!(ran.out.contains("Next: shadercheck check . more"), "{}", ran.out);
    run_in(folder.path(), "check . --lane embedded --samples 256").expect(0);
    let ran = run_in(folder.path(), "init a.glsl gone.glsl").expect(2);
    assert!(ran.err.contains("there is no file or folder `gone.glsl`"), "{}", ran.err);
}
