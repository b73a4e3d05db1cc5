//! Shaders of several files on the command line.

use std::fs;
use std::process::Command;

/// Exit status, standard output and standard error of a command on the first of some files.
fn run(files: &[(&str, &str)], args: &[&str]) -> (Option<i32>, String, String) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let output = Command::new(env!("CARGO_BIN_EXE_shadercheck"))
        .current_dir(folder.path())
        .args([&args[..1], &[files[0].0], &args[1..]].concat())
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

const LIGHT: (&str, &str) = (
    "light.wesl",
    "const K = 2.0;\nfn shade(x: f32) -> f32 {\n  @if(HARD) return K / x;\n  @else return K * x;\n}\nfn other() -> f32 { return 1; }\n",
);

#[test]
fn a_function_with_imports_is_translated() {
    let main = ("main.wesl", "import super::light::shade;\nfn f(x: f32) -> f32 { return shade(x) + 1.0; }\n");
    let (status, out, err) = run(&[main, LIGHT], &["translate", "--to", "glsl450", "--entry", "f"]);
    assert_eq!((status, err.as_str()), (Some(0), ""));
    assert!(out.contains("2.0 *") && !out.contains("other"), "{out}");
    let (status, out, err) =
        run(&[main, LIGHT], &["translate", "--to", "glsl450", "--entry", "f", "--define", "HARD=true"]);
    assert_eq!((status, err.as_str()), (Some(0), ""));
    assert!(out.contains("2.0 /"), "{out}");
}

#[test]
fn errors_stand_in_the_file_of_their_author() {
    let main = ("main.wesl", "import super::light::shade;\nfn f(x: f32) -> f32 { return shade(x); }\n");
    let light = ("light.wesl", "// first\nfn shade(x: f32) -> f32 {\n  return x + missing;\n}\n");
    let (status, _, err) = run(&[main, light], &["translate", "--to", "wgsl", "--entry", "f"]);
    assert_eq!(status, Some(1));
    assert!(err.contains("E074") && err.contains("light.wesl:3:14") && err.contains("--with FILE"), "{err}");
    let wrong = ("light.wesl", "// first\nfn shade(x: f32) -> f32 {\n  return x + vec2(1.0);\n}\n");
    let (status, _, err) = run(&[main, wrong], &["translate", "--to", "wgsl", "--entry", "f"]);
    assert_eq!(status, Some(1));
    assert!(err.contains("light.wesl:3:") && !err.contains("main.wesl"), "{err}");
    let gone = ("main.wesl", "import super::light::shad;\nfn f(x: f32) -> f32 { return shad(x); }\n");
    let (status, _, err) = run(&[gone, light], &["translate", "--to", "wgsl", "--entry", "f"]);
    assert_eq!(status, Some(1));
    assert!(err.contains("E070") && err.contains("main.wesl:1:22") && err.contains("did you mean `shade`?"), "{err}");
}

#[test]
fn a_part_of_a_text_takes_what_lies_beside_it_or_is_named() {
    let part = ("part.wgsl", "fn f(x: f32) -> f32 { return x * SCALE; }\n");
    let scale = ("scale.wgsl", "const SCALE = 3.0;\n");
    let (status, out, err) = run(&[part, scale], &["translate", "--to", "glsl450", "--entry", "f"]);
    assert_eq!(status, Some(0), "{err}");
    assert!(err.contains("note: `SCALE` is taken from scale.wgsl") && out.contains("3.0"), "{err}{out}");
    let far = ("far/scale.wgsl", "const SCALE = 4.0;\n");
    let (status, _, err) = run(&[part, far], &["translate", "--to", "glsl450", "--entry", "f"]);
    assert_eq!(status, Some(1));
    assert!(err.contains("E074") && err.contains("part.wgsl:1:34"), "{err}");
    let (status, out, _) =
        run(&[part, far], &["translate", "--to", "glsl450", "--entry", "f", "--with", "far/scale.wgsl"]);
    assert_eq!(status, Some(0));
    assert!(out.contains("4.0"), "{out}");
}

#[test]
fn functions_of_modules_of_naga_oil_are_run() {
    let main = (
        "main.wgsl",
        "#import kit::half::half\nfn f(x: f32) -> f32 {\n#ifdef TWICE\n  return half(half(x));\n#endif\n  return half(x);\n}\n",
    );
    let half = ("kit/half.wgsl", "#define_import_path kit::half\nfn half(x: f32) -> f32 { return x * 0.5; }\n");
    let args = ["fuzz", "--function", "f", "--lane", "embedded", "--samples", "64", "-D", "TWICE=true"];
    let (status, out, err) = run(&[main, half], &args);
    assert_eq!(status, Some(0), "{out}{err}");
    assert!(out.starts_with("ok    f ") && out.contains("48 agreed"), "{out}");
}

#[test]
fn a_suite_chooses_features_of_its_shader() {
    let suite = (
        "main.suite.toml",
        "suite = \"main\"\nshader = \"main.wesl\"\nstage = \"function\"\nentry = \"f\"\nreference = \"true.wgsl\"\n\
         defines = { HARD = [\"true\"] }\n[[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [1.0, 2.0]\n",
    );
    let main = ("main.wesl", "import super::light::shade;\nfn f(x: f32) -> f32 { return shade(x); }\n");
    let truth = ("true.wgsl", "fn f(x: f32) -> f32 { return 2.0 / x; }\n");
    let args = ["check", "--lane", "embedded", "--samples", "256", "--plain"];
    let (status, out, err) = run(&[suite, main, LIGHT, truth], &args);
    assert_eq!(status, Some(0), "{out}{err}");
    let wrong = suite.1.replace("HARD = [\"true\"]", "HARD = [\"false\"]");
    let (status, ..) = run(&[(suite.0, &wrong), main, LIGHT, truth], &args);
    assert_eq!(status, Some(1));
}

const COLOUR: (&str, &str) = ("colour.wesl", "fn tint(x: f32) -> vec4f {\n  let y = x / 0.0;\n  return vec4f(x);\n}\n");

#[test]
fn what_is_linted_knows_what_it_imports() {
    let main = |count: &str| {
        format!(
            "import super::colour::tint;\n@fragment fn main() -> @location(0) vec4f {{\n  return vec4f(tint(1.0){count}, 1.0);\n}}\n"
        )
    };
    let (wrong, right) = (main(""), main(".rgb"));
    let (status, out, _) = run(&[("main.wesl", &wrong), COLOUR], &["lint", "--format", "concise"]);
    assert_eq!(status, Some(1));
    // What another file has is told where that one is linted.
    assert!(out.starts_with("main.wesl:3:10: error[E902]") && out.lines().count() == 1, "{out}");
    let (status, out, _) = run(&[("main.wesl", &right), COLOUR], &["lint", "--format", "concise"]);
    assert_eq!((status, out.as_str()), (Some(0), ""));
    let (_, out, _) = run(&[("main.wesl", &right), COLOUR], &["lint", "colour.wesl", "--format", "concise"]);
    assert!(out.lines().count() == out.matches("colour.wesl:2:").count() && out.contains("N009"), "{out}");
}

#[test]
fn repairs_and_comments_hold_in_a_text_with_imports() {
    let text = "// shadercheck: ignore-file[D006] of the template\nimport super::colour::tint;\n\
                fn f(a: vec2f) -> vec4f {\n  let left = 1.0;\n  return tint(atan(a.y / a.x));\n}\n";
    let (_, out, _) = run(&[("main.wesl", text), COLOUR], &["lint", "--level", "heuristic", "--format", "concise"]);
    assert!(out.contains("main.wesl:5:15") && !out.contains("D006"), "{out}");
    let (_, out, _) =
        run(&[("main.wesl", text), COLOUR], &["lint", "--diff", "--unsafe-fixes", "--level", "heuristic"]);
    assert!(out.contains("+  return tint(atan2(a.y, a.x));") && !out.contains("-import"), "{out}");
}

#[test]
fn what_every_version_of_the_language_refuses_is_told() {
    let wrong = [
        ("fn f(a: f32) -> f32 {\n  let a = 2.0 * a;\n  return a;\n}\n", 2, "redefinition of `a`"),
        (
            "fn f() -> f32 {\n  let length = length(vec2f(1.0));\n  return length(vec2f(length));\n}\n",
            3,
            "cannot be called",
        ),
        ("fn f(a: vec2f) -> f32 {\n  return a.x + a.z;\n}\n", 2, "invalid field accessor `z`"),
        ("struct S { a: f32 }\nfn f(s: S) -> f32 { return s.b; }\n", 2, "invalid field accessor `b`"),
        ("fn f(n: u32) -> i32 {\n  let m: i32 = n;\n  return m;\n}\n", 2, "`u32` does not go into a `i32`"),
        ("fn f() -> f32 {\n  let a = 1.0;\n  a = 2.0;\n  return a;\n}\n", 3, "invalid left-hand side"),
        ("fn f(target: f32) -> f32 {\n  return target;\n}\n", 1, "reserved"),
    ];
    for (text, line, told) in wrong {
        let (status, out, _) = run(&[("a.wgsl", text)], &["lint", "--format", "concise"]);
        let (at, count) = (format!("a.wgsl:{line}:"), out.lines().filter(|l| l.contains("error[")).count());
        assert!(status == Some(1) && out.starts_with(&at) && count == 1 && out.contains(told), "{out}");
    }
    // What a later version may allow, what a host may declare, and what stands under a condition is told on request.
    for text in [
        "fn f(a: vec2f) -> vec2f {\n  var b = a;\n  b.xy = a.yx;\n  return b;\n}\n",
        // naga's evaluation of constants loses the components of a zero value.
        "fn f() -> vec3f {\n  const a = vec4f(vec3f(), 1.0);\n  return a.rgb;\n}\n",
        "@novel fn f(a: f32) -> f32 {\n  return a;\n}\n",
        "fn f(a: f32) -> f32 {\n  return a * GAIN;\n}\n",
        "#ifdef A\nfn f() -> f32 { return 1.0; }\n#endif\n#ifdef B\nfn f() -> f32 { return 2.0; }\n#endif\n",
    ] {
        let (status, out, _) = run(&[("a.wgsl", text)], &["lint", "--format", "concise"]);
        assert!(status == Some(0) && !out.contains("E901"), "{out}");
    }
}

#[test]
fn what_conditions_leave_out_is_no_reason_to_report() {
    let text = "import super::colour::tint;\nfn f(x: f32) -> f32 {\n  let a = x;\n  let b = x;\n  let c = tint(x).x;\n\
                @if(A && !B) return a;\n@if(B && !A)\n  return b;\n@else\n  return x;\n}\n";
    let (_, out, _) = run(&[("main.wesl", text), COLOUR], &["lint", "--format", "concise"]);
    assert!(out.starts_with("main.wesl:5:7: info[D006") && out.lines().count() == 1, "{out}");
    // An error under features that a host may never state is told on request.
    let text = "import super::colour::tint;\nfn f(x: f32) -> f32 {\n  @if(A) return tint(x);\n  @else return x;\n}\n";
    let (status, out, _) = run(&[("main.wesl", text), COLOUR], &["lint", "--format", "concise"]);
    assert_eq!((status, out.as_str()), (Some(0), ""));
    let (_, out, _) = run(&[("main.wesl", text), COLOUR], &["lint", "--level", "strict", "--format", "concise"]);
    assert!(out.contains("main.wesl:3:") && out.contains("E038"), "{out}");
}

#[test]
fn functions_that_stand_alone_are_run_where_others_lack_something() {
    // No declaration of `GAIN` makes this right.
    let text = "fn half(x: f32) -> f32 { return 0.5 * x; }\nfn g(x: f32) -> f32 { return half(x) * (GAIN + true); }\n\
                fn h(x: f32) -> f32 { return g(x); }\n";
    let (status, out, err) = run(&[("part.wgsl", text)], &["fuzz", "--samples", "256", "--lane", "embedded"]);
    assert!(out.contains("half") && out.contains("1 function run, 2 not run"), "{status:?} {out}{err}");
    assert!(out.matches("`GAIN` is declared nowhere").count() == 2, "{out}");
    // Where it lacks nothing, or what it lacks can be an input, all of them are run.
    let right = text.replace(" + true", "");
    let (status, out, _) = run(&[("part.wgsl", &right)], &["fuzz", "--samples", "256", "--lane", "embedded"]);
    assert!(status == Some(0) && out.contains("3 functions run"), "{status:?} {out}");
    let whole = format!("const GAIN = 2.0;\n{right}");
    let (status, out, _) = run(&[("part.wgsl", &whole)], &["fuzz", "--samples", "256", "--lane", "embedded"]);
    assert!(status == Some(0) && out.contains("3 functions run"), "{status:?} {out}");
    // What is wrong beside it is told first.
    let wrong = format!("{text}fn k(x: f32) -> f32 {{ return vec2f(x); }}\n");
    let (status, out, err) = run(&[("part.wgsl", &wrong)], &["fuzz", "--lane", "embedded"]);
    let told = format!("{out}{err}");
    let place = |code: &str| told.find(code).unwrap_or(usize::MAX);
    assert!(status == Some(1) && place("E902") < place("E074") && told.contains("part.wgsl:4:30"), "{told}");
}

#[test]
fn early_drafts_of_the_language_are_read() {
    let old = "[[block]] struct U { scale: f32; };\n[[group(0), binding(0)]] var<uniform> u: U;\nlet a = 2.0;\n\
               fn f(x: f32) -> f32 { return 1.0 / (x * a); }\n";
    let (status, out, err) = run(&[("old.wgsl", old)], &["fuzz", "--lane", "embedded"]);
    let told = format!("{out}{err}");
    assert!(status != Some(2) && told.contains("old.wgsl:1:1: an early draft of WGSL"), "{told}");
    assert!(told.contains("1 function run") && told.contains("old.wgsl:4:"), "{told}");
    let (status, out, err) = run(&[("old.wgsl", old)], &["lint", "--format", "concise"]);
    assert!(status == Some(0) && out.contains("old.wgsl:1:1: info[E076]"), "{out}{err}");
    // What has no equivalent is an error at its place.
    let gone = format!("{old}fn g(x: f32) -> bool {{ return isNan(x); }}\n");
    let (status, out, err) = run(&[("old.wgsl", &gone)], &["fuzz", "--lane", "embedded"]);
    let told = format!("{out}{err}");
    assert!(status == Some(1) && told.contains("E076") && told.contains("old.wgsl:5:31"), "{told}");
}

/// A suite of the function `f` of `part.wgsl`, with more keys.
fn suite(keys: &str) -> String {
    format!(
        "suite = \"part\"\nshader = \"part.wgsl\"\nstage = \"function\"\nentry = \"f\"\nreference = \"right.wgsl\"\n\
         samples = 1024\n{keys}\n[[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [1.0, 2.0]\n"
    )
}

#[test]
fn a_suite_names_what_its_host_puts_before_a_text() {
    let part = ("part.wgsl", "fn f(x: f32) -> f32 { return x * SCALE; }\n");
    let (far, right) =
        (("far/scale.wgsl", "const SCALE = 4.0;\n"), ("right.wgsl", "fn f(x: f32) -> f32 { return 4.0 * x; }\n"));
    let with = suite("with = [\"far/scale.wgsl\"]");
    let check = ["check", "--plain", "--lane", "embedded"];
    let (status, out, err) = run(&[("part.suite.toml", &with), part, far, right], &check);
    assert_eq!(status, Some(0), "{out}{err}");
    let wrong = ("far/scale.wgsl", "const SCALE = 5.0;\n");
    let (status, out, _) = run(&[("part.suite.toml", &with), part, wrong, right], &check);
    assert!(status == Some(1) && out.contains("part.wgsl:1:"), "{out}");
    let (status, _, err) = run(&[("part.suite.toml", &suite("with = [\"gone.wgsl\"]")), part, far, right], &check);
    assert_eq!(status, Some(2), "{err}");
    assert!(err.contains("part.suite.toml:7:10") && err.contains("gone.wgsl"), "{err}");
    let (status, out, err) = run(&[("part.suite.toml", &suite("")), part, far, right], &check);
    assert!(status == Some(1) && out.contains("part.wgsl:1:34"), "{out}{err}");
    // Mutants are put together like the text itself.
    let (status, out, err) =
        run(&[("part.suite.toml", &with), part, far, right], &["mutate", "--lane", "embedded", "--samples", "256"]);
    assert!(status == Some(0) && out.contains("100.0 %"), "{out}{err}");
}

#[test]
fn a_name_that_nothing_declares_is_told_in_a_whole_module() {
    let module = |call: &str, more: &str| {
        format!(
            "@group(0) @binding(0) var t: texture_2d<f32>;\n@group(0) @binding(1) var s: sampler;\n\
             @fragment fn fs(@location(0) uv: vec2f) -> @location(0) vec4f {{\n  return {call};\n}}\n{more}"
        )
    };
    let lint = |text: &str, others: &[(&str, &str)], level: &str| {
        let files: Vec<(&str, &str)> = [("a.wgsl", text)].into_iter().chain(others.iter().copied()).collect();
        let args = ["lint", "--level", level, "--format", "concise"];
        let paths: Vec<&str> = others.iter().map(|(name, _)| *name).collect();
        run(&files, &[&args[..], &paths[..]].concat()).1
    };
    for (call, error) in [
        ("textureSampel(t, s, uv)", "a.wgsl:4:10: error[E021]"),
        ("vec4f(uv, 0.0, brightness)", "a.wgsl:4:25: error[E020]"),
        ("vec4f(shade(uv), 0.0, 1.0)", "a.wgsl:4:16: error[E021]"),
    ] {
        let out = lint(&module(call, ""), &[], "default");
        assert!(out.starts_with(error), "{call}: {out}");
    }
    let out = lint(&module("textureSampel(t, s, uv)", ""), &[], "default");
    assert!(out.contains("`textureSampel` is not declared"), "{out}");
    // The twins: what the text declares, what the language has, and what others may put beside the text.
    assert_eq!(lint(&module("textureSample(t, s, uv)", ""), &[], "default"), "");
    assert_eq!(lint(&module("vec4f(uv, 0.0, gain)", "const gain = 1.0;\n"), &[], "default"), "");
    let piece = "fn other() -> f32 { return brightness; }\n";
    assert_eq!(lint(piece, &[], "default"), "");
    assert!(lint(piece, &[], "strict").contains("E020"));
    let host = ("m.js", "const more = 'const brightness = 0.5;';\n");
    assert_eq!(lint(&module("vec4f(uv, 0.0, brightness)", ""), &[host], "default"), "");
    assert_eq!(lint(&module("vec4f(uv, 0.0, BRIGHTNESS)", ""), &[], "default"), "", "a host puts constants in front");
}

#[test]
fn a_text_of_which_no_resource_has_a_binding_is_read_and_run_as_its_host_has_it() {
    let kernel = |barrier: &str| {
        format!(
            "var<storage> a: array<f32>;\nvar<storage, read_write> b: array<f32>;\nvar<workgroup> w: array<f32, 64>;\n\
             @compute @workgroup_size(64)\nfn main(@builtin(local_invocation_index) i: u32) {{\n  w[i] = a[i];\n\
             {barrier}\n  b[i] = w[63u - i];\n}}\n"
        )
    };
    let (right, wrong) = (kernel("  workgroupBarrier();"), kernel(""));
    let (status, out, _) = run(&[("a.wgsl", &right)], &["lint", "--format", "concise"]);
    assert_eq!((status, out.as_str()), (Some(0), ""));
    let fuzz = |text: &str| run(&[("a.wgsl", text)], &["fuzz", "--lane", "embedded"]);
    let (status, out, err) = fuzz(&wrong);
    assert!(status == Some(1) && out.contains("race") && out.contains("a.wgsl:8:"), "{out}{err}");
    assert!(format!("{out}{err}").contains("no resource has a binding"), "{out}{err}");
    let (status, out, err) = fuzz(&right);
    assert!(status == Some(0) && out.contains("main"), "{out}{err}");
    // Where some have one, the others lack it.
    let some = right.replacen("var<storage>", "@group(0) @binding(0) var<storage>", 1);
    let (status, out, err) = run(&[("a.wgsl", &some)], &["lint", "--format", "concise"]);
    assert!(status == Some(1) && out.contains("Binding"), "{out}{err}");
}

#[test]
fn an_include_is_found_from_each_folder_around_the_file_up_to_this_one() {
    let main = |argument: &str| {
        let text = format!(
            "#version 450\n#extension GL_GOOGLE_include_directive : enable\n#include \"common.glsl\"\n\
             layout(location = 0) out vec4 c;\nvoid main() {{\n  c = vec4(half_of({argument}));\n}}\n"
        );
        let part = ("shader/common.glsl", "float half_of(float x) { return 0.5 * x; }\n");
        run(&[("shader/a/b/c/main.frag", &text), part], &["fuzz", "--lane", "embedded", "--samples", "256"])
    };
    let (status, out, err) = main("3.0");
    assert!(status == Some(0) && out.contains("half_of"), "{out}{err}");
    let (status, out, err) = main("vec2(3.0)");
    let told = format!("{out}{err}");
    assert!(status == Some(1) && told.contains("E022") && told.contains("main.frag:6:12"), "{told}");
}

#[test]
fn a_module_of_an_engine_that_is_not_here_is_not_run() {
    let text =
        "#import engine::view::view\nfn f(x: f32) -> f32 { let w: array<f32, 3> = view.weights; return w[1] * x; }\n";
    let (status, out, err) = run(&[("part.wgsl", text)], &["fuzz", "--lane", "embedded"]);
    assert!(status == Some(2) && out.contains("not run: what it imports is not here"), "{status:?} {out}{err}");
    let view = "#define_import_path engine::view\nstruct View { weights: array<f32, 3> }\n@group(0) @binding(0) var<storage> view: View;\n";
    let (status, out, err) =
        run(&[("part.wgsl", text), ("view.wgsl", view)], &["fuzz", "-I", ".", "--lane", "embedded"]);
    assert!(status == Some(0) && out.contains("1 function run, 0 not run"), "{status:?} {out}{err}");
}
