//! `shadercheck lint` as it is called: configuration, suppressions, baselines, formats, encodings.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

use crate::binary::{Ran, command, root, run_in};

const LITERAL: &str =
    "#version 150 core\nin float turn;\nvoid main()\n{\n  float th = 6.283185 * turn;\n  gl_Position = vec4(th);\n}\n";
const WRONG: &str = "#version 150 core\nvoid main()\n{\n  gl_Position = vec3(1.0, 2.0, 3.0, 4.0);\n}\n";

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        write(&folder, name, text.as_bytes());
    }
    folder
}

fn write(folder: &TempDir, name: &str, bytes: &[u8]) {
    let path = folder.path().join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

fn read(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(name)).unwrap()
}

/// Runs the linter in English, findings one a line.
fn lint(folder: &Path, args: &str) -> Ran {
    run_in(folder, &format!("lint --lang en {args}"))
}

#[track_caller]
fn codes(ran: &Ran) -> Vec<String> {
    let value: Value = serde_json::from_str(&ran.out).unwrap_or_else(|e| panic!("{e}\n{ran:?}"));
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|d| format!("{} {}", d["file"].as_str().unwrap(), d["code"].as_str().unwrap()))
        .collect()
}

/// A slip in a file that others include: every word is known, so that no macro of a host stands there.
#[test]
fn a_slip_in_a_piece_is_an_error_unless_a_word_of_it_may_be_a_macro() {
    let folder = tempfile::tempdir().unwrap();
    let write = |text: &str| std::fs::write(folder.path().join("a.glsl"), text).unwrap();
    write("float g(float x) { return x; }\nfloat h(float x) { return g(x) }\n");
    let ran = run_in(folder.path(), "lint a.glsl").expect(1);
    assert!(ran.out.contains("error[E001]") && ran.out.contains("a.glsl:2:"), "{ran:?}");
    for right in [
        "float h(float x) { return WEIGHT(x) END }\n",
        "float h(float x) { DECLARE(x) return x; }\n",
        "float h(float x) { return x; }\n",
        "#extension GL_OF_HOST : enable\nfloat h(float sample) { float x = 2.0 * sample; return x; }\n",
    ] {
        write(right);
        run_in(folder.path(), "lint a.glsl").expect(0);
    }
}

#[test]
fn the_nearest_configuration_holds_and_options_go_before_it() {
    let folder = folder(&[
        ("a.vert", LITERAL),
        ("old/a.vert", LITERAL),
        ("old/deep/b.vert", WRONG),
        ("shadercheck.toml", "[lint]\nselect = [\"N\"]\n"),
        ("old/shadercheck.toml", "[lint]\nignore = [\"N014\"]\n"),
    ]);
    let found = |args: &str| codes(&lint(folder.path(), &format!("{args} --format json")));
    assert_eq!(found("."), ["a.vert N014", "old/deep/b.vert T001"]);
    assert_eq!(codes(&lint(&folder.path().join("old/deep"), "b.vert ../a.vert --format json")), ["b.vert T001"]);
    assert_eq!(found(". --ignore T"), ["a.vert N014", "old/a.vert N014"], "in place of the file's list");
    assert_eq!(found("old --no-config"), ["old/a.vert N014", "old/deep/b.vert T001"]);
    assert_eq!(found("old --config shadercheck.toml"), ["old/a.vert N014"]);
}

#[test]
fn rules_are_left_out_for_files_that_match() {
    let folder = folder(&[
        ("third/x/a.vert", LITERAL),
        ("own/a.vert", LITERAL),
        ("own/generated.vert", WRONG),
        ("shadercheck.toml", "[lint.per-file-ignores]\n\"third/**\" = [\"N\"]\n\"generated.*\" = [\"T001\"]\n"),
    ]);
    assert_eq!(codes(&lint(folder.path(), ". --format json")), ["own/a.vert N014"]);
    assert_eq!(codes(&lint(&folder.path().join("third/x"), "a.vert --format json")), Vec::<String>::new());
}

#[test]
fn a_folder_is_told_by_cause_and_its_information_on_request() {
    let folder = folder(&[("a.vert", LITERAL), ("b.vert", WRONG), ("c/d.vert", WRONG), ("c/e.vert", WRONG)]);
    let ran = lint(folder.path(), "").expect(1);
    assert_eq!(ran.out.matches("error[T001").count(), 1, "{}", ran.out);
    assert!(ran.out.contains(" --> b.vert:") && ran.out.contains("\n  also at c/d.vert:"), "{}", ran.out);
    assert!(!ran.out.contains("info[") && ran.err.contains("`--info` prints the 1 info as well"), "{ran:?}");
    assert!(lint(folder.path(), "--info").out.contains("info[N014"));
    // What is named is told whole.
    assert!(lint(folder.path(), "--select N014").out.contains("info[N014"));
    assert!(lint(folder.path(), "a.vert").out.contains("info[N014"));
    assert_eq!(lint(folder.path(), "c/d.vert c/e.vert").out.matches("error[T001").count(), 2);
    let counts = lint(folder.path(), "--statistics").expect(1).out;
    let lines: Vec<Vec<&str>> = counts.lines().map(|line| line.split_whitespace().take(3).collect()).collect();
    assert_eq!(lines, [["3", "error", "T001"], ["1", "info", "N014"]]);
}

#[test]
fn a_rule_goes_by_its_name_wherever_it_goes_by_its_code() {
    let silenced = LITERAL.replace("turn;\n  gl", "turn; // shadercheck: ignore[low-precision-pi] as on paper\n  gl");
    let folder = folder(&[("a.vert", LITERAL), ("b.vert", WRONG), ("c.vert", &silenced)]);
    let found = |args: &str| codes(&lint(folder.path(), &format!(". --format json {args}")));
    let (literal, wrong) = ("a.vert N014", "b.vert T001");
    assert_eq!(found(""), [literal, wrong]);
    for name in ["low-precision-pi", "low_precision_pi", "LOW-Precision-Pi"] {
        assert_eq!(found(&format!("--select {name}")), [literal]);
        assert_eq!(found(&format!("--ignore {name}")), [wrong]);
        write(&folder, "shadercheck.toml", format!("[lint]\nselect = [\"{name}\"]\n").as_bytes());
        assert_eq!(found(""), [literal]);
        write(&folder, "shadercheck.toml", format!("[lint.per-file-ignores]\n\"a.*\" = [\"{name}\"]\n").as_bytes());
        assert_eq!(found(""), [wrong]);
        write(&folder, "shadercheck.toml", b"");
        lint(folder.path(), ". --write-baseline known.json").expect(0);
        write(
            &folder,
            "known.json",
            read(&folder, "known.json").replace("\"N014\"", &format!("\"{name}\"")).as_bytes(),
        );
        assert_eq!(found("--baseline known.json"), Vec::<String>::new());
    }
    for args in [". --select low-precison-pi", ". --ignore low-precison-pi"] {
        let ran = lint(folder.path(), args).expect(2);
        assert!(ran.err.contains("no rule is called `low-precison-pi` (did you mean N014 low-precision-pi"), "{ran:?}");
    }
}

/// A kernel whose wait for the other invocations stands in a macro of another file.
const KERNEL: &str = "#version 450\n#extension GL_GOOGLE_include_directive : enable\n#include \"inc/wait.glsl\"\n\
    layout(local_size_x = 64) in;\nlayout(binding = 0) buffer B { float x[]; };\nshared float s[64];\n\
    void main()\n{\n  uint t = gl_LocalInvocationID.x;\n  s[t] = half_of(x[t]);\n  WAIT;\n  x[t] = s[63u - t];\n}\n";
const WAITS: &str = "#define WAIT memoryBarrierShared(); barrier()\nfloat half_of(float v) { return v * 0.5; }\n";

#[test]
fn rules_see_what_a_shader_includes_and_tell_each_file_its_own() {
    let with = |wait: &str| {
        let folder = folder(&[("pass/k.comp", KERNEL), ("inc/wait.glsl", wait)]);
        (codes(&lint(folder.path(), "pass --format json")), codes(&lint(folder.path(), ". --format json")))
    };
    assert_eq!(with(WAITS), (vec![], vec![]));
    let unset = WAITS.replace("return v * 0.5;", "float h; return v * h;");
    // What is wrong in the other file is told there, once.
    assert_eq!(with(&unset), (vec![], vec!["inc/wait.glsl D001".to_owned()]));
    let forgets = WAITS.replace("; barrier()", "");
    assert_eq!(with(&forgets).0, ["pass/k.comp K001"]);
    // A file that is missing leaves the text as it is: nothing is known of its names.
    let alone = folder(&[("k.comp", KERNEL)]);
    assert!(!codes(&lint(alone.path(), "k.comp --format json")).contains(&"k.comp E020".to_owned()));
}

#[test]
fn a_slip_in_a_directive_of_a_module_is_told() {
    let module = |other: &str, end: &str| {
        format!(
            "@group(0) @binding(0) var<storage, read_write> o: array<f32>;\n#ifdef WIDE\nconst N = 4.0;\n{other}\n\
             const N = 2.0;\n{end}\n@compute @workgroup_size(8) fn main(@builtin(global_invocation_id) id: vec3u) {{\n  \
             if (id.x < arrayLength(&o)) {{\n#ifdef LOW\n    o[id.x] = 0.5;\n#endif\n    o[id.x] += N;\n  }}\n}}\n"
        )
    };
    let found = |text: &str| lint(folder(&[("a.wgsl", text)]).path(), "a.wgsl --format concise").out;
    assert!(found(&module("#els", "#endif")).starts_with("a.wgsl:4:2: error[E010]"));
    assert!(found(&module("#else", "#endifx")).starts_with("a.wgsl:6:2: error[E010]"));
    assert_eq!(found(&module("#else", "#endif")), "");
}

#[test]
fn a_name_that_an_included_file_lacks_is_told_in_it_once() {
    let root = |head: &str| {
        format!(
            "#version 330\n#extension GL_GOOGLE_include_directive : enable\n{head}#include \"lib/tone.glsl\"\n\
             in vec3 light;\nout vec4 c;\nvoid main() {{ c = vec4(tone(light), 1.0); }}\n"
        )
    };
    let tone = "vec3 tone(vec3 x) { return x * exposure / (x + 1.0); }\n";
    let found = |files: &[(&str, &str)]| {
        let folder = folder(&[&[("lib/tone.glsl", tone)], files].concat());
        lint(folder.path(), ". --format concise").out
    };
    let (lacks, has) = (root(""), root("uniform float exposure;\n"));
    let out = found(&[("a.frag", &lacks), ("b.frag", &lacks)]);
    assert!(out.starts_with("lib/tone.glsl:1:32: error[E020]") && out.lines().count() == 1, "{out}");
    // The text that lacks it is named, where others have it.
    let folder = folder(&[("lib/tone.glsl", tone), ("a.frag", &lacks), ("b.frag", &has)]);
    let out = lint(folder.path(), ".").out;
    assert!(out.contains("lib/tone.glsl:1:32") && out.contains("included by `a.frag`"), "{out}");
    // What stands in front of the directive is a declaration like any other.
    for head in ["uniform float exposure;\n", "#define exposure 2.0\n", "const float exposure = 2.0;\n"] {
        assert_eq!(found(&[("a.frag", &root(head))]), "");
    }
    // A text that is no whole may have a declaration around it, and host code may put one in front of the file.
    assert_eq!(
        found(&[("a.frag", &lacks), ("piece.glsl", "#include \"lib/tone.glsl\"\nvec3 f() { return tone(g); }\n")]),
        ""
    );
    assert_eq!(found(&[("a.frag", &lacks), ("load.js", "const text = declared + load('lib/tone.glsl');\n")]), "");
    // The text itself is whole as well.
    let own = has.replace("tone(light)", "tone(light) * gian");
    let out = found(&[("a.frag", &own)]);
    assert!(out.starts_with("a.frag:7:") && out.contains("`gian`") && out.lines().count() == 1, "{out}");
}

#[test]
fn a_wrong_configuration_is_reported_with_its_place() {
    let folder = folder(&[("a.vert", LITERAL), ("shadercheck.toml", "[lint]\nselct = [\"N\"]\nlevel = \"strikt\"\n")]);
    let ran = lint(folder.path(), "a.vert").expect(2);
    assert!(ran.out.is_empty());
    let lines: Vec<&str> = ran.err.lines().collect();
    assert_eq!(lines.len(), 2, "{}", ran.err);
    assert!(lines[0].starts_with("error: shadercheck.toml:2:1: unknown key `selct` in [lint]; did you mean `select`?"));
    assert!(lines[1].starts_with("error: shadercheck.toml:3:9: `level` cannot be `strikt`; did you mean `strict`?"));
    let ran = lint(folder.path(), "a.vert --config none.toml").expect(2);
    assert!(ran.err.contains("none.toml: cannot be read"), "{}", ran.err);
}

#[test]
fn a_program_of_the_configuration_that_is_not_there_is_reported() {
    let text = "[[program]]\nshaders = [\"a.vert\", \"gone.frag\"]\n";
    let folder = folder(&[("s/a.vert", LITERAL), ("s/shadercheck.toml", text)]);
    let ran = lint(folder.path(), "s").expect(0);
    assert!(ran.err.contains("warning: s/gone.frag: named by [[program]], and not there"), "{}", ran.err);
    assert!(!ran.err.contains("a.vert: named"), "{}", ran.err);
}

#[test]
fn the_language_of_the_configuration_and_of_the_option() {
    let folder = folder(&[("a.vert", LITERAL), ("shadercheck.toml", "[lint]\nlang = \"ja\"\n")]);
    let ran = run_in(folder.path(), "lint a.vert").expect(0);
    assert!(ran.err.contains("1 個のファイル: エラー 0 件、警告 0 件、情報 1 件"), "{}", ran.err);
    assert!(lint(folder.path(), "a.vert").expect(0).err.contains("1 file: 0 errors, 0 warnings, 1 info"));
}

#[test]
fn a_baseline_hides_what_it_knows_and_tells_what_is_gone() {
    let folder = folder(&[("s/a.vert", WRONG), ("s/b.vert", LITERAL)]);
    let place = folder.path();
    lint(place, "s").expect(1);
    let ran = lint(place, "s --write-baseline known.json").expect(0);
    assert!(ran.err.contains("2 findings recorded in known.json"), "{}", ran.err);
    let ran = lint(place, "s --baseline known.json").expect(0);
    assert_eq!(ran.out, "");
    assert!(ran.err.contains("2 findings are known from the baseline"), "{}", ran.err);
    // Called from another folder, and with lines moved, it knows the same.
    write(&folder, "s/a.vert", WRONG.replace("void main", "// more\n\nvoid main").as_bytes());
    lint(&place.join("s"), "a.vert --baseline ../known.json").expect(0);
    // A second finding of the same kind is new.
    write(&folder, "s/a.vert", WRONG.replace("4.0);", "4.0);\n  vec4 more = vec3(1.0, 2.0, 3.0, 4.0);").as_bytes());
    let ran = lint(place, "s --baseline known.json --format concise --ignore D006").expect(1);
    assert_eq!(ran.out.lines().count(), 1, "{}", ran.out);
    assert!(ran.out.contains("s/a.vert:5:"), "{}", ran.out);
    // What is repaired is told once it is gone, and pruned when asked for.
    write(&folder, "s/a.vert", WRONG.replace("vec3", "vec4").as_bytes());
    let before = read(&folder, "known.json");
    let ran = lint(place, "s --baseline known.json").expect(0);
    assert!(
        ran.err.contains("no longer found: T001 constructor-too-many-args in s/a.vert: gl_Position = vec3"),
        "{}",
        ran.err
    );
    assert!(ran.err.contains("--prune-baseline"), "{}", ran.err);
    assert_eq!(read(&folder, "known.json"), before);
    let ran = lint(place, "s/b.vert --baseline known.json").expect(0);
    assert!(!ran.err.contains("no longer"), "a file that was not linted: {}", ran.err);
    lint(place, "s --baseline known.json --prune-baseline").expect(0);
    assert!(!read(&folder, "known.json").contains("T001"));
    assert!(!lint(place, "s --baseline known.json").expect(0).err.contains("no longer"));
    // A file that does not exist any more takes its findings with it.
    fs::remove_file(place.join("s/b.vert")).unwrap();
    assert!(lint(place, "s --baseline known.json").expect(0).err.contains("N014 low-precision-pi in s/b.vert"));
    let ran = lint(place, "s/a.vert --write-baseline no/such/known.json").expect(2);
    assert!(ran.err.contains("no/such/known.json: cannot be written"), "{}", ran.err);
    write(&folder, "known.json", b"{}");
    assert!(lint(place, "s --baseline known.json").expect(2).err.contains("--write-baseline"));
}

#[test]
fn a_report_goes_to_a_file_besides() {
    let folder = folder(&[("a.vert", WRONG)]);
    let ran = lint(folder.path(), "a.vert --format sarif --output report.sarif").expect(1);
    assert!(
        ran.out.contains("error[T001 constructor-too-many-args]") && ran.out.contains("a.vert:4:17"),
        "{}",
        ran.out
    );
    let log: Value = serde_json::from_str(&read(&folder, "report.sarif")).unwrap();
    assert_eq!(log["runs"][0]["results"][0]["ruleId"], "T001");
    let place = &log["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"];
    assert_eq!(place["uri"], "a.vert");
    assert!(log["runs"][0]["originalUriBaseIds"]["SRCROOT"]["uri"].as_str().unwrap().starts_with("file:///"));
    let ran = lint(folder.path(), "a.vert --output no/such/folder.json --format json").expect(2);
    assert!(ran.err.contains("no/such/folder.json: cannot be written"), "{}", ran.err);
}

#[test]
fn annotations_of_a_workflow_have_paths_from_the_root() {
    let folder = folder(&[("s/a.vert", WRONG)]);
    let real = fs::canonicalize(folder.path()).unwrap();
    let ran = lint(&real, &format!("{} --format github", real.join("s").display())).expect(1);
    assert!(
        ran.out.starts_with("::error file=s/a.vert,line=4,endLine=4,col=17,endColumn=20,title=T001 "),
        "{}",
        ran.out
    );
    assert_eq!(ran.out.lines().count(), 1, "{}", ran.out);
}

#[test]
fn findings_do_not_fail_a_run_that_asks_for_it_and_errors_do() {
    let folder = folder(&[("a.vert", WRONG)]);
    let ran = lint(folder.path(), "a.vert --exit-zero").expect(0);
    assert!(ran.out.contains("T001"));
    lint(folder.path(), "a.vert gone.vert --exit-zero").expect(2);
    lint(folder.path(), "a.vert --prove --exit-zero").expect(0);
}

#[test]
fn what_git_ignores_is_left_out_unless_it_is_named() {
    let folder = folder(&[
        (".gitignore", "build/\n*.tmp.vert\n"),
        ("a.vert", WRONG),
        ("b.tmp.vert", WRONG),
        ("build/c.vert", WRONG),
        (".hidden/d.vert", WRONG),
    ]);
    assert_eq!(codes(&lint(folder.path(), ". --format json")), ["a.vert T001"]);
    assert_eq!(codes(&lint(folder.path(), "build/c.vert --format json")), ["build/c.vert T001"]);
    assert_eq!(codes(&lint(folder.path(), "build --format json")), ["build/c.vert T001"]);
}

#[test]
fn files_are_repaired_in_their_own_encoding() {
    let text = |number: &str| LITERAL.replace("6.283185", number).replace("{\n", "{ // 頂点の角度を求めます\r\n");
    let fixed = "6.28318530717958648";
    let utf16 = |text: &str, bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(bytes).collect()
    };
    let shift_jis = |text: &str| -> Vec<u8> {
        let comment = b"\x92\xb8\x93\x5f\x82\xcc\x8a\x70\x93\x78\x82\xf0\x8b\x81\x82\xdf\x82\xdc\x82\xb7";
        let (before, after) = text.split_once("頂点の角度を求めます").unwrap();
        [before.as_bytes(), comment, after.as_bytes()].concat()
    };
    let folder = folder(&[]);
    for (name, before, after) in [
        ("a.vert", shift_jis(&text("6.283185")), shift_jis(&text(fixed))),
        ("b.vert", utf16(&text("6.283185"), u16::to_le_bytes), utf16(&text(fixed), u16::to_le_bytes)),
        ("c.vert", utf16(&text("6.283185"), u16::to_be_bytes), utf16(&text(fixed), u16::to_be_bytes)),
    ] {
        write(&folder, name, &before);
        let ran = lint(folder.path(), &format!("{name} --format concise")).expect(0);
        assert!(ran.out.starts_with(&format!("{name}:5:14: info[N014 low-precision-pi]")), "{ran:?}");
        lint(folder.path(), &format!("{name} --fix --unsafe-fixes")).expect(0);
        assert_eq!(fs::read(folder.path().join(name)).unwrap(), after, "{name}");
    }
}

#[test]
fn what_would_not_be_written_back_as_it_was_is_left_alone() {
    // 0xfa54 is one of two ways of Shift_JIS to write ￢: decoding and encoding gives 0x81ca.
    let (before, after) = WRONG.split_once("void").unwrap();
    let bytes = [before.as_bytes(), b"// \x8b\x85 \xfa\x54\nvoid", after.as_bytes()].concat();
    let folder = folder(&[("b.vert", WRONG)]);
    write(&folder, "a.vert", &bytes);
    let ran = lint(folder.path(), "a.vert b.vert --fix --format concise").expect(2);
    assert!(ran.err.contains("a.vert: holds bytes that Shift_JIS has another way to write"), "{}", ran.err);
    assert!(ran.out.contains("a.vert:5:17: error[T001 constructor-too-many-args]"), "it is still told: {}", ran.out);
    assert!(ran.err.contains("1 could not be written"), "{}", ran.err);
    assert_eq!(fs::read(folder.path().join("a.vert")).unwrap(), bytes);
    assert!(read(&folder, "b.vert").contains("vec4(1.0"), "the other is repaired");
}

#[test]
fn other_commands_read_the_same_encodings() {
    let (before, after) = LITERAL.split_once("void").unwrap();
    let bytes = [before.as_bytes(), b"// \x92\xb8\x93\x5f\nvoid", after.as_bytes()].concat();
    let folder = folder(&[]);
    write(&folder, "a.vert", &bytes);
    let ran = run_in(folder.path(), "translate a.vert --to glsl450").expect(0);
    assert!(ran.out.contains("gl_Position"), "{}", ran.out);
}

#[test]
fn a_repair_is_run_before_and_after() {
    let folder = folder(&[("a.vert", LITERAL), ("b.vert", WRONG)]);
    let ran = lint(folder.path(), ". --diff --unsafe-fixes --prove").expect(1);
    assert!(ran.err.contains("a.vert: `gl_Position` moves in ") && ran.err.contains(" ULP) at most"), "{}", ran.err);
    assert!(ran.err.contains("b.vert: not compared: the text before does not compile"), "{}", ran.err);
    assert_eq!(read(&folder, "a.vert"), LITERAL);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let printed = root().join("fixtures/printed");
    let out = |threads: &str| {
        let mut command: Command = command(root(), "lint --lang en --no-config --format json");
        let ran: Ran = command.arg(&printed).env("RAYON_NUM_THREADS", threads).output().unwrap().into();
        ran.expect(1).out
    };
    let one = out("1");
    assert!(one.len() > 1000);
    assert_eq!(one, out("7"));
}

#[test]
fn hooks_call_options_that_exist() {
    let help = run_in(root(), "lint --help").expect(0).out;
    for name in [".pre-commit-hooks.yaml", "deploy/pre-commit/.pre-commit-hooks.yaml"] {
        let text = fs::read_to_string(root().join(name)).unwrap();
        let options: Vec<&str> = text
            .split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'))
            .filter(|w| w.starts_with("--") && w.len() > 2)
            .filter(|w| !["--path", "--locked", "--quiet"].contains(w))
            .collect();
        assert!(!options.is_empty(), "{name}");
        for option in options {
            assert!(help.contains(option), "{name}: {option}");
        }
    }
}

#[test]
fn the_configuration_of_the_book_is_right() {
    let page = fs::read_to_string(root().join("docs/book/src/lint.md")).unwrap();
    let (_, section) = page.split_once("## Configuration").unwrap();
    let (_, block) = section.split_once("```toml\n").unwrap();
    let (text, _) = block.split_once("```").unwrap();
    let files = [
        ("shadercheck.toml", text),
        ("shaders/scene.vert", LITERAL),
        ("shaders/scene.frag", LITERAL),
        ("src/scene.cpp", "int x;\n"),
    ];
    let folder = folder(&files);
    let ran = run_in(folder.path(), "lint shaders/scene.vert").expect(0);
    assert!(!ran.err.contains("error:") && !ran.err.contains("warning:"), "{}", ran.err);
    assert!(ran.out.contains("info[N014 low-precision-pi]"), "{}", ran.out);
}

#[test]
fn the_tour_of_the_book_and_of_the_readme_is_what_the_tool_says() {
    let page = fs::read_to_string(root().join("docs/book/src/lint.md")).unwrap();
    let ran = lint(root(), "fixtures/tour --format concise --no-config").expect(1);
    assert_eq!(ran.out.lines().count(), 10, "{}", ran.out);
    assert!(page.contains(ran.out.trim_end()), "{}", ran.out);
    let japanese = run_in(root(), "lint --lang ja fixtures/tour --format concise --no-config").expect(1);
    for (name, ran) in [("README.md", &ran), ("README.ja.md", &japanese)] {
        let readme = fs::read_to_string(root().join(name)).unwrap();
        let shown: Vec<&str> = readme.lines().filter(|line| line.starts_with("fixtures/tour/")).collect();
        assert!(!shown.is_empty() && shown.iter().all(|line| ran.out.lines().any(|said| said == *line)), "{shown:?}");
    }
}

#[test]
fn mistakes_of_a_host_of_wgpu_are_found_and_its_twin_is_clean() {
    let found = |name: &str| {
        let ran = run_in(root(), &format!("lint --lang en --format json fixtures/webgpu/{name}"));
        let value: Value = serde_json::from_str(&ran.out).unwrap_or_else(|e| panic!("{e}\n{ran:?}"));
        let told = value.as_array().unwrap().iter().map(|d| d["message"].as_str().unwrap().to_owned());
        told.collect::<Vec<String>>()
    };
    assert_eq!(
        found("wrong"),
        [
            "`gravity` is at byte 4 here, and at byte 16 in the shader",
            "`Float32` is read as f32, and `kind` in the shader is of u32",
            "the layout has a read-only storage buffer, and the shader declares a storage buffer that is written",
            "the module has no entry point `color`",
        ]
    );
    assert!(found("right").is_empty());
}

#[test]
fn files_of_glsl_that_take_in_each_other_are_told_and_guarded_ones_are_not() {
    for (guard, status) in [("", 1), ("#pragma once\n", 0), ("#ifndef B\n#define B\n", 0)] {
        let folder = tempfile::tempdir().unwrap();
        let end = if guard.starts_with("#ifndef") { "#endif\n" } else { "" };
        write(&folder, "a.glsl", b"#include \"b.glsl\"\nfloat f(float x) { return g(x) + 1.0; }\n");
        let other = format!("{guard}#include \"a.glsl\"\nfloat g(float x) {{ return 2.0 * x; }}\n{end}");
        write(&folder, "b.glsl", other.as_bytes());
        let ran = lint(folder.path(), "a.glsl --format concise").expect(status);
        let told = ran.out.contains("E071") && ran.out.contains("a.glsl → ");
        assert_eq!(told, status == 1, "{guard}\n{}", ran.out);
    }
}

#[test]
fn what_another_reader_finds_is_told_beside_what_it_does_not_seek() {
    let text = |shift: &str| {
        format!(
            "@group(0) @binding(0) var<storage, read_write> b: array<u32>;\n\
             fn f(v: u32) -> bool {{ return ((v >> {shift}) & 1u) == 1u; }}\n\
             @compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32) {{\n\
             if i > 3u {{ workgroupBarrier(); }}\nif f(i) {{ b[i] = i; }}\n}}\n"
        )
    };
    let folder = folder(&[("a.wgsl", &text("61u")), ("b.wgsl", &text("3u"))]);
    assert_eq!(codes(&lint(folder.path(), ". --format json")), ["a.wgsl E902", "a.wgsl W001", "b.wgsl W001"]);
}

/// What no option of a library changes is told, whatever its version; a file that is missing may overload built-in functions.
#[test]
fn types_that_no_option_mends_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let library = "#if defined NORMAL_MAPPING\nvoid decode(inout vec3 n) { n = n * 2.0 - 1.0; }\n#endif\n\
        vec3 unpacked(in uint data) { uvec4 v = data >> uvec4(0u, 8u, 16u, 24u); return vec3(v.rgb); }\n";
    write("wrong.glsl", library);
    write("right.glsl", &library.replace("data >>", "uvec4(data) >>"));
    write(
        "missing.frag",
        "#version 450\n#include \"light.glsl\"\nlayout(location = 0) in vec4 c;\n\
        layout(location = 0) out vec4 o;\nvoid main() { o = vec4(textureProj(c, c.xy, 1)); }\n",
    );
    write(
        "shadow.csh",
        "#version 430\nlayout(local_size_x = 8) in;\nlayout(r32ui) uniform uimage2D img;\n\
        void main() { uint m = imageLoad(img, ivec2(0)).r; uvec3 v = m >> uvec3(0, 2, 4); imageStore(img, ivec2(0), uvec4(v.x)); }\n",
    );
    write("shell.csh", "#!/bin/csh\nset path = (/usr/bin)\n");
    let ran = run_in(folder.path(), "lint .").expect(1);
    assert!(ran.out.contains("wrong.glsl:4:") && ran.out.contains("shadow.csh:4:"), "{ran:?}");
    assert!(ran.err.contains("2 errors") && !ran.out.contains("shell.csh"), "{ran:?}");
}

/// An entry point of WGSL has any name.
#[test]
fn a_module_with_an_entry_point_is_whole_whatever_that_is_called() {
    let folder = tempfile::tempdir().unwrap();
    let text = "@group(0) @binding(0) var<storage, read_write> a: array<i32>;\n\
        @compute @workgroup_size(8)\nfn reduce(@builtin(global_invocation_id) id: vec3u) { a[id.x] = 2147483647i; }\n";
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("right.wgsl", text);
    write("number.wgsl", &text.replace("2147483647i", "2147483648i"));
    write("brace.wgsl", &text.replace(" }", ""));
    let ran = run_in(folder.path(), "lint .").expect(1);
    assert!(ran.out.contains("error[E003]") && ran.out.contains("error[E001]"), "{ran:?}");
    assert!(ran.err.contains("2 errors") && !ran.out.contains("right.wgsl"), "{ran:?}");
}
