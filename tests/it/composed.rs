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
    assert!(err.contains("light.wesl:2:") && !err.contains("main.wesl"), "{err}");
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
