//! The command on files of a temporary folder.

use std::fs;
use std::path::{Path, PathBuf};

use super::*;

const CYLINDER: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/printed/cylinder.vert"));
const REPAIRED: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/chapter9/cylinder.vert"));

struct Ran {
    status: ExitStatus,
    out: String,
    err: String,
}

fn lint(paths: &[PathBuf], change: impl FnOnce(&mut LintArgs)) -> Ran {
    let mut args = LintArgs {
        paths: paths.to_vec(),
        format: Some("concise".to_owned()),
        lang: Some(LangName::En),
        no_config: true,
        ..LintArgs::default()
    };
    change(&mut args);
    let (mut out, mut err) = (Vec::new(), Vec::new());
    // As the command line does with an error.
    let status = run(&args, &mut out, &mut err, false).unwrap_or_else(|error| {
        writeln!(err, "error: {error:#}").unwrap();
        ExitStatus::Error
    });
    Ran { status, out: String::from_utf8(out).unwrap(), err: String::from_utf8(err).unwrap() }
}

fn folder(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    folder
}

fn at(folder: &tempfile::TempDir, name: &str) -> Vec<PathBuf> {
    vec![folder.path().join(name)]
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}

#[test]
fn findings_give_status_1_and_information_alone_does_not() {
    let folder = folder(&[("cylinder.vert", CYLINDER.as_bytes())]);
    let ran = lint(&at(&folder, "cylinder.vert"), |_| {});
    assert_eq!(ran.status, ExitStatus::Findings);
    assert!(ran.out.contains("cylinder.vert:13:23: error[T001 constructor-too-many-args]: "), "{}", ran.out);
    assert!(ran.err.contains("1 file: 1 error, 0 warnings, 1 info"), "{}", ran.err);
    let ran = lint(&at(&folder, "cylinder.vert"), |a| a.ignore = vec!["T001".to_owned()]);
    assert_eq!(ran.status, ExitStatus::Clean);
    assert!(ran.out.contains("info[N014 low-precision-pi]"), "{}", ran.out);
}

#[test]
fn a_bundle_is_read_where_it_is_named() {
    let shader = "const vs = `attribute vec4 p; void main() { gl_Position = p.xyzr; }`;";
    let folder = folder(&[
        ("dist/app.js", format!("{shader} /* {} */", "x".repeat(5000)).as_bytes()),
        ("a.js", shader.as_bytes()),
        // A picture in one line, among code.
        ("b.js", format!("const icon = \"{}\";\n{}{shader}", "x".repeat(6000), "work();\n".repeat(1000)).as_bytes()),
    ]);
    let ran = lint(&at(&folder, ""), |_| {});
    assert!(ran.out.contains("b.js:1002:"), "{}", ran.out);
    assert!(ran.out.contains("a.js:1:") && !ran.out.contains("app.js"), "{}", ran.out);
    assert!(ran.err.contains("app.js: a bundle"), "{}", ran.err);
    let ran = lint(&at(&folder, "dist/app.js"), |_| {});
    assert!(ran.out.contains("app.js:1:") && ran.status == ExitStatus::Findings, "{}", ran.out);
}

#[test]
fn fix_writes_safe_fixes_and_says_what_more_there_is() {
    let folder = folder(&[("cylinder.vert", CYLINDER.as_bytes())]);
    let ran = lint(&at(&folder, "cylinder.vert"), |a| a.fix = true);
    assert_eq!(ran.status, ExitStatus::Clean, "{}", ran.err);
    assert!(ran.err.contains("fixed 1 finding in 1 file"), "{}", ran.err);
    assert!(ran.err.contains("1 finding can be fixed with --fix --unsafe-fixes"), "{}", ran.err);
    let ran = lint(&at(&folder, "cylinder.vert"), |a| (a.fix, a.unsafe_fixes) = (true, true));
    assert_eq!((ran.status, ran.out.as_str()), (ExitStatus::Clean, ""));
    assert_eq!(read(&folder.path().join("cylinder.vert")), REPAIRED);
    let ran = lint(&at(&folder, "cylinder.vert"), |a| (a.fix, a.unsafe_fixes) = (true, true));
    assert!(ran.err.contains("fixed 0 findings in 0 files"), "{}", ran.err);
}

#[test]
fn byte_order_mark_and_line_ends_are_kept() {
    let windows = |text: &str| format!("\u{feff}{}", text.replace('\n', "\r\n"));
    let folder = folder(&[("cylinder.vert", windows(CYLINDER).as_bytes())]);
    let ran = lint(&at(&folder, "cylinder.vert"), |a| (a.fix, a.unsafe_fixes) = (true, true));
    assert_eq!(ran.status, ExitStatus::Clean, "{}{}", ran.out, ran.err);
    assert_eq!(read(&folder.path().join("cylinder.vert")), windows(REPAIRED));
}

#[test]
fn diff_prints_a_patch_and_writes_nothing() {
    let folder = folder(&[("cylinder.vert", CYLINDER.as_bytes())]);
    let ran = lint(&at(&folder, "cylinder.vert"), |a| (a.fix, a.diff) = (true, true));
    assert_eq!(ran.status, ExitStatus::Findings, "the file is as it was");
    let changed: Vec<&str> = ran.out.lines().filter(|l| l.starts_with(['+', '-'])).collect();
    assert_eq!(changed.len(), 4, "{}", ran.out);
    assert!(changed[2].ends_with("vec4 p = vec3(cos(th), y, sin(th), 1.0);"));
    assert!(changed[3].ends_with("vec4 p = vec4(cos(th), y, sin(th), 1.0);"));
    assert_eq!(read(&folder.path().join("cylinder.vert")), CYLINDER);
}

#[test]
fn unsafe_fixes_alone_is_a_usage_error() {
    let folder = folder(&[("cylinder.vert", CYLINDER.as_bytes())]);
    let ran = lint(&at(&folder, "cylinder.vert"), |a| a.unsafe_fixes = true);
    assert_eq!(ran.status, ExitStatus::Error);
    assert!(ran.err.contains("--fix or --diff"), "{}", ran.err);
}

#[test]
fn an_unknown_rule_is_a_usage_error() {
    let folder = folder(&[("cylinder.vert", CYLINDER.as_bytes())]);
    let ran = lint(&at(&folder, "cylinder.vert"), |a| a.select = vec!["T0O1".to_owned()]);
    assert_eq!((ran.status, ran.out.as_str()), (ExitStatus::Error, ""));
    assert!(ran.err.contains("T001"), "{}", ran.err);
}

#[test]
fn what_cannot_be_read_is_named_with_what_to_do() {
    let folder = folder(&[
        ("latin.vert", b"// \xe9t\xe9 \xff\0\nvoid main() {}\n"),
        ("empty.vert", b" \n"),
        ("notes.txt", b"text"),
        ("none/notes.txt", b"text"),
    ]);
    for (name, parts) in [
        ("latin.vert", ["latin.vert:1:4: neither UTF-8", "iconv"]),
        ("empty.vert", ["empty.vert: the file is empty", "name a file"]),
        ("notes.txt", ["notes.txt: neither a shader nor host code", ".vert"]),
        ("none", ["none: no shader", ".vert"]),
        ("gone.vert", ["gone.vert: cannot be read", "check the path"]),
    ] {
        let ran = lint(&at(&folder, name), |_| {});
        assert_eq!((ran.status, ran.out.as_str()), (ExitStatus::Error, ""), "{name}");
        assert!(parts.iter().all(|p| ran.err.contains(p)), "{name}: {}", ran.err);
    }
}

#[test]
fn the_other_files_are_linted_all_the_same() {
    let folder = folder(&[("a.vert", b"// \xff\0\n"), ("cylinder.vert", CYLINDER.as_bytes())]);
    let ran = lint(&[folder.path().to_owned()], |_| {});
    assert_eq!(ran.status, ExitStatus::Error);
    assert!(ran.out.contains("T001") && ran.err.contains("a.vert:1:4"), "{}{}", ran.out, ran.err);
}

#[test]
fn folders_are_searched_and_each_file_is_linted_once() {
    let folder = folder(&[
        ("a/b/cylinder.vert", CYLINDER.as_bytes()),
        ("a/.git/cylinder.vert", CYLINDER.as_bytes()),
        ("a/empty.h", b""),
        ("a/notes.txt", b"vec3(1.0, 2.0, 3.0, 4.0)"),
    ]);
    let paths = [folder.path().to_owned(), folder.path().join("a"), folder.path().join("a/b/cylinder.vert")];
    let ran = lint(&paths, |_| {});
    assert_eq!(ran.out.matches("T001").count(), 1, "{}", ran.out);
    assert!(ran.err.contains("1 file:"), "{}", ran.err);
}

#[test]
fn shaders_that_a_host_file_names_are_read_with_it() {
    let printed =
        |name: &str| fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/printed").join(name)).unwrap();
    let folder = folder(&[("src/morph.cpp", &printed("morph.cpp")), ("src/morph.vert", &printed("morph.vert"))]);
    let ran = lint(&at(&folder, "src/morph.cpp"), |_| {});
    assert!(ran.out.contains("morph.cpp:18:17: error[H001 uniform-lookup-of-attribute]"), "{}", ran.out);
    assert!(ran.err.contains("1 file:"), "context is not counted: {}", ran.err);
}

#[test]
fn json_is_an_array_with_the_rule_s_name() {
    let folder = folder(&[("cylinder.vert", CYLINDER.as_bytes())]);
    let ran =
        lint(&at(&folder, "cylinder.vert"), |a| (a.format, a.select) = (Some("json".to_owned()), vec!["T".to_owned()]));
    let value: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(value.as_array().map(Vec::len), Some(1));
    assert_eq!(value[0]["name"], "constructor-too-many-args");
    assert_eq!((&value[0]["line"], &value[0]["column"]), (&13.into(), &23.into()));
    assert_eq!(value[0]["fix"]["safety"], "safe");
}

#[cfg(unix)]
#[test]
fn a_read_only_file_is_left_alone_and_said_so() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder(&[("cylinder.vert", CYLINDER.as_bytes())]);
    let path = folder.path().join("cylinder.vert");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
    let ran = lint(&at(&folder, "cylinder.vert"), |a| a.fix = true);
    assert_eq!(ran.status, ExitStatus::Error);
    assert!(ran.err.contains("read-only"), "{}", ran.err);
    assert_eq!(read(&path), CYLINDER);
}

#[cfg(unix)]
#[test]
fn a_link_stays_a_link() {
    let folder = folder(&[("real/cylinder.vert", CYLINDER.as_bytes())]);
    let link = folder.path().join("link.vert");
    std::os::unix::fs::symlink("real/cylinder.vert", &link).unwrap();
    lint(std::slice::from_ref(&link), |a| (a.fix, a.unsafe_fixes) = (true, true));
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(read(&folder.path().join("real/cylinder.vert")), REPAIRED);
}

#[test]
fn the_arguments_are_well_formed() {
    use clap::Parser;
    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        lint: LintArgs,
    }
    let cli = Cli::try_parse_from(["lint", "a.vert", "--select", "T,H001", "--format", "json"]).unwrap();
    assert_eq!(cli.lint.select, ["T", "H001"]);
    assert_eq!(cli.lint.format.as_deref(), Some("json"));
    assert!(Cli::try_parse_from(["lint", "a.vert", "--format", "xml"]).is_err());
    let here = Cli::try_parse_from(["lint"]).unwrap();
    assert_eq!(here.lint.paths, [PathBuf::from(".")]);
}

#[test]
fn a_stage_with_another_ending_is_found_by_its_name_and_its_text() {
    let vertex = "#version 410\nlayout(location = 0) in vec3 p;\nvoid main() { gl_Position = vec4(p, 1.0); }\n";
    let geometry = "#version 410\nlayout(points) in;\nlayout(points, max_vertices = 1) out;\nout vec2 uv;\n\
                    void main() { uv = vec2(0.5); gl_Position = gl_in[0].gl_Position; EmitVertex(); }\n";
    let fragment = "#version 410\nin vec2 uv;\nout vec4 c;\nvoid main() { c = vec4(uv, 0.0, 1.0); }\n";
    let host = "void f() { load(\"s/fire.vert\", \"s/fire.frag\", \"s/fire.gem\"); }\n";
    let shaders = [("s/fire.vert", vertex), ("s/fire.frag", fragment)];
    let with = |more: &[(&str, &str)]| {
        let files: Vec<(&str, &[u8])> =
            shaders.iter().chain(more).map(|(name, text)| (*name, text.as_bytes())).collect();
        let folder = folder(&files);
        lint(&at(&folder, ""), |_| {}).out
    };
    assert!(with(&[]).contains("error[I001"), "{}", with(&[]));
    for more in [&[("s/fire.gem", geometry)][..], &[("s/fire.gem", geometry), ("a.cpp", host)]] {
        assert!(!with(more).contains("I001"), "{}", with(more));
    }
    // A text that is no stage stands between nothing.
    assert!(with(&[("s/fire.txt2", "the fire\n")]).contains("error[I001"));
}

#[test]
fn a_file_that_is_named_is_read_as_with_its_project() {
    let shader = "#version 460\nin vec2 uv;\nout vec4 color;\nvoid main() { color = vec4(fbm(uv, 5)); }\n";
    let library = "float fbm(vec2 p, int n) { return fract(dot(p, p) * float(n)); }\n";
    let with = |more: &[(&str, &str)]| {
        let files: Vec<(&str, &[u8])> =
            [("nodes/a.frag", shader)].iter().chain(more).map(|(name, text)| (*name, text.as_bytes())).collect();
        let folder = folder(&files);
        fs::create_dir(folder.path().join(".git")).unwrap();
        lint(&at(&folder, "nodes/a.frag"), |_| {}).out
    };
    assert!(with(&[]).contains("E021"), "{}", with(&[]));
    assert_eq!(with(&[("lib/noise.glsl", library)]), "");
    // A file that has the name and does not put it in front takes nothing away.
    assert!(with(&[("lib/noise.glsl", "float other(float x) { return x; }\n")]).contains("E021"));
}

#[test]
#[cfg(feature = "run")]
fn a_module_in_a_string_is_read_as_one_in_a_file() {
    let text = |value: &str| {
        format!(
            "const code = `\n@fragment\nfn fs() -> @location(0) vec4f {{\n  let gain = 1.0;\n  return vec4f({value}, gain, 0.0, 1.0);\n}}\n`;\n\
             const module = device.createShaderModule({{ code }});\n"
        )
    };
    let told = |text: &str| {
        let folder = folder(&[("a.ts", text.as_bytes())]);
        lint(&at(&folder, ""), |_| {}).out
    };
    let unknown = told(&text("nope"));
    assert!(unknown.contains("a.ts:5:16: error[E020]") && unknown.contains("`nope`"), "{unknown}");
    assert!(told(&text("vec2f(1.0).z")).contains("a.ts:5:"), "{}", told(&text("vec2f(1.0).z")));
    assert_eq!(told(&text("gain")), "");
    // What a constant fills in is known as well; what the program gives is not.
    let filled = text("${SCALE} * nope").replacen("const", "const SCALE = 2.0;\nconst", 1);
    assert!(told(&filled).contains("a.ts:6:") && told(&filled).contains("`nope`"), "{}", told(&filled));
    assert_eq!(told(&text("${scale()} * nope")), "");
}

#[test]
#[cfg(feature = "run")]
fn declarations_that_an_engine_rewrites_are_of_no_language() {
    let told = |word: &str| {
        let text =
            format!("{word} gain: f32;\n@fragment\nfn fs() -> @location(0) vec4f {{ return vec4f({word}.gain); }}\n");
        let folder = folder(&[("a.wgsl", text.as_bytes())]);
        lint(&at(&folder, ""), |_| {}).out
    };
    assert_eq!((told("uniform"), told("varying")), (String::new(), String::new()));
    assert!(told("uniforn").contains("error[E0"), "{}", told("uniforn"));
}

#[test]
fn a_text_in_another_language_is_told_where_it_is_named() {
    let text = "#include \"in.hlsl\"\nOutput main(Input input)\n{\n  Output output = (Output)0;\n  return output;\n}\n";
    let folder = folder(&[("a.vert", text.as_bytes()), ("b.vert", REPAIRED.as_bytes())]);
    assert!(!lint(&at(&folder, ""), |_| {}).out.contains("error"), "{}", lint(&at(&folder, ""), |_| {}).out);
    let named = lint(&at(&folder, "a.vert"), |_| {}).out;
    assert!(named.contains("error[E077]") && named.contains("looks like HLSL"), "{named}");
}
