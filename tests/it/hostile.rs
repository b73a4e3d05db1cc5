//! Names, files and tools of somebody else: what they say stays inside of a line of a report and does nothing to a
//! terminal, no line of a file is shown that is no shader, and a script that was written runs from anywhere.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;

use crate::binary::{Ran, command};

/// What must not begin a line: a command of GitHub Actions.
const PLANTED: &str = "::error::planted";

/// Fails where a text has a control character, or a line that is the planted command.
#[track_caller]
fn is_tame(what: &str, text: &str) {
    let control = text.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\t'));
    assert_eq!(control, None, "{what}:\n{}", text.escape_debug());
    let line = text.lines().find(|line| line.trim_start().starts_with(PLANTED));
    assert_eq!(line, None, "{what}:\n{text}");
}

#[track_caller]
fn tame(folder: &Path, args: &[&str]) -> Ran {
    let ran: Ran = command(folder, "").args(args).output().unwrap().into();
    for text in [&ran.out, &ran.err] {
        is_tame(&args.join(" ").escape_debug().to_string(), text);
    }
    ran
}

const FORMATS: [&str; 6] = ["text", "json", "junit", "sarif", "github", "markdown"];

/// A suite of a function that is not its reference.
fn wrong(folder: &Path, suite: &str, shader: &str) {
    let reported = shader.replace('\n', "\\n").replace('\u{1b}', "\\u001b");
    let toml = format!(
        "suite = \"own\"\nshader = \"{reported}\"\nstage = \"function\"\nentry = \"f\"\nsamples = 64\nreference = \"r.glsl\"\n\
         [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [-2.0, 2.0]\n"
    );
    fs::write(folder.join(suite), toml).unwrap();
    fs::write(folder.join(shader), "float f(float x) { return x * 2.0; } // \u{1b}[31m\n").unwrap();
    fs::write(folder.join("r.glsl"), "float f(float x) { return x * 3.0; }\n").unwrap();
}

#[test]
fn names_of_files_stay_in_their_lines() {
    let folder = tempfile::tempdir().unwrap();
    let suite = format!("a\n{PLANTED}\u{1b}[31m.suite.toml");
    let shader = format!("s\n{PLANTED}\u{1b}[31m.glsl");
    wrong(folder.path(), &suite, &shader);
    for format in FORMATS {
        let ran = tame(folder.path(), &["check", ".", "--lane", "embedded", "--format", format]);
        assert_eq!(ran.code, 1, "{ran:?}");
    }
    let ran = tame(folder.path(), &["check", ".", "--lane", "embedded", "--report-dir", "out"]).expect(1);
    // The command of the report is one that a shell can run.
    let line = ran.out.lines().find_map(|line| line.trim_start().strip_prefix("reproduce  ")).unwrap();
    let program = Path::new(env!("CARGO_BIN_EXE_shadercheck")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut shell = std::process::Command::new("/bin/sh");
    let again: Ran = shell.args(["-c", line]).env("PATH", path).current_dir(folder.path()).output().unwrap().into();
    assert!(again.expect(1).out.contains("the shader deviates from its reference"));
    for file in ["index.html", "summary.md", "annotations.txt", "junit.xml", "report.sarif", "report.json"] {
        is_tame(file, &fs::read_to_string(folder.path().join("out").join(file)).unwrap());
    }
    let broken = format!("b\n{PLANTED}\u{1b}[31m.vert");
    fs::write(folder.path().join(&broken), "#version 330\n#error \u{1b}[32m\nvoid main() { gl_Position = 1; }\n")
        .unwrap();
    for format in ["text", "concise", "json", "sarif", "github"] {
        assert_eq!(tame(folder.path(), &["lint", ".", "--format", format]).code, 1);
    }
    let absent = format!("c\n{PLANTED}.vert");
    for args in [
        vec!["translate", &broken, "--to", "wgsl"],
        vec!["fuzz", &broken],
        vec!["fuzz", &shader],
        vec!["mutate", &suite, "--samples", "64"],
        vec!["init", "--dry-run", "."],
        vec!["translate", &absent, "--to", "wgsl"],
        vec!["lint", &absent],
        vec!["check", &absent],
        vec!["fuzz", &absent],
        vec!["check", &broken],
        vec!["refdata", "describe", &absent],
    ] {
        tame(folder.path(), &args);
    }
}

#[test]
fn values_of_suites_stay_in_their_lines() {
    let folder = tempfile::tempdir().unwrap();
    wrong(folder.path(), "a.suite.toml", "s.glsl");
    let toml = fs::read_to_string(folder.path().join("a.suite.toml")).unwrap();
    let text = "a\\n::error::planted\\u001b[31m";
    for (from, to) in [
        ("shader = \"s.glsl\"", format!("shader = \"{text}\"")),
        ("reference = \"r.glsl\"", format!("reference = \"{text}\"")),
        ("reference = \"r.glsl\"", format!("recorded = \"{text}.csv\"")),
        ("reference = \"r.glsl\"", format!("formula = \"{text}\"")),
        ("suite = \"own\"", format!("suite = \"{text}\"")),
        ("suite = \"own\"", format!("suite = \"own\"\ntitle = \"{text}\"")),
        ("suite = \"own\"", format!("suite = \"own\"\n\"{text}\" = 1")),
        ("suite = \"own\"", format!("suite = \"own\"\ninclude = [\"{text}\"]")),
        ("entry = \"f\"", format!("entry = \"{text}\"")),
        ("names = [\"x\"]", format!("names = [\"x\", \"{text}\"]")),
        ("generator = \"interval\"", format!("generator = \"{text}\"")),
    ] {
        assert!(toml.contains(from), "{from}");
        fs::write(folder.path().join("a.suite.toml"), toml.replace(from, &to)).unwrap();
        for format in FORMATS {
            tame(folder.path(), &["check", "a.suite.toml", "--lane", "embedded", "--format", format]);
        }
    }
}

#[test]
fn what_a_tool_prints_stays_in_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("glslangValidator");
    let path = format!("{}:{}", folder.path().display(), std::env::var("PATH").unwrap());
    let noise = "\\033[31m\\r::error::planted\\007\\033]0;title\\007";
    // It refuses every text, or breaks, in words with control characters; its version has some as well.
    for (answer, code) in [(format!("ERROR: 0:1: bad {noise}"), 2), (format!("{noise}\\n::error::planted"), 9)] {
        let text = format!(
            "#!/bin/sh\ncase \"$*\" in\n*--version*) printf 'Glslang Version: 11:1.0 {noise}\\n' ;;\n\
             *) cat > /dev/null; printf '{answer}\\n'; exit {code} ;;\nesac\n"
        );
        fs::write(&script, text).unwrap();
        fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).unwrap();
        let out = folder.path().join("out");
        let dir = out.to_str().unwrap();
        let base = ["check", "morph", "--samples", "64", "--lane", "vulkan-glslang", "--plain"];
        for more in FORMATS.map(|format| ["--format", format]).into_iter().chain([["--report-dir", dir]]) {
            let ran: Ran =
                command(crate::binary::root(), "").args(base).args(more).env("PATH", &path).output().unwrap().into();
            for text in [&ran.out, &ran.err] {
                is_tame(more[1], text);
            }
            if more[1] == "text" {
                assert!(
                    ran.out.contains("\\u{1b}[31m") || ran.out.contains("\u{fffd}[31m"),
                    "what it said is told: {ran:?}"
                );
            }
        }
        let written = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file());
        let written: Vec<_> = written.collect();
        assert!(!written.is_empty(), "no report was written");
        for file in written {
            is_tame(&file.display().to_string(), &fs::read_to_string(&file).unwrap());
        }
    }
}

/// A folder with a suite in `suite/`, and files beside that folder.
fn project(toml: &str, shader: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("suite")).unwrap();
    for name in ["secret", "secret.key"] {
        fs::write(at(name), "PLANTED:x:0:0\n").unwrap();
    }
    for name in ["shared.glsl", "shared.inc", "suite/near", "suite/near.txt"] {
        fs::write(at(name), "float g(float x) { return x * 2.0; }\n").unwrap();
    }
    symlink(at("secret"), at("suite/link.glsl")).unwrap();
    symlink(at("shared.glsl"), at("suite/good.glsl")).unwrap();
    fs::write(at("suite/s.glsl"), shader).unwrap();
    let rest = "stage = \"function\"\nsamples = 64\n[[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [-2.0, 2.0]\n";
    fs::write(at("suite/a.suite.toml"), format!("suite = \"own\"\n{toml}\n{rest}")).unwrap();
    folder
}

#[test]
fn no_line_of_a_file_elsewhere_is_shown_that_is_no_shader() {
    let own = "float g(float x) { return x * 2.0; }\n";
    for name in ["../secret", "../secret.key", "./../secret", "link.glsl", "/etc/passwd"] {
        for (toml, shader) in [
            (format!("shader = \"{name}\"\nentry = \"g\""), own.to_owned()),
            (format!("shader = \"s.glsl\"\nentry = \"g\"\nreference = \"{name}\""), own.to_owned()),
            (format!("shader = \"s.glsl\"\nentry = \"g\"\nlinked = [\"{name}\"]"), own.to_owned()),
            ("shader = \"s.glsl\"\nentry = \"g\"".to_owned(), format!("#include \"{name}\"\n{own}")),
            (
                "shader = \"s.glsl\"\nentry = \"g\"\ninclude = [\"..\"]".to_owned(),
                format!("#include <{}>\n{own}", name.trim_start_matches("../").trim_start_matches("./../")),
            ),
        ] {
            let folder = project(&toml, &shader);
            for format in FORMATS {
                let args = format!("check suite --lane embedded --format {format}");
                let ran: Ran = command(folder.path(), &args).output().unwrap().into();
                let all = format!("{}{}", ran.out, ran.err);
                assert_ne!(ran.code, 0, "{toml}: {ran:?}");
                assert!(!all.contains("PLANTED:") && !all.contains("root:"), "{toml} {shader}: {all}");
            }
            for args in ["fuzz suite/s.glsl", "translate suite/s.glsl --entry g --to wgsl"] {
                let ran: Ran = command(folder.path(), args).output().unwrap().into();
                let all = format!("{}{}", ran.out, ran.err);
                assert!(!all.contains("PLANTED:") && !all.contains("root:"), "{args} {toml} {shader}: {all}");
            }
        }
    }
}

#[test]
fn shaders_elsewhere_and_files_beside_a_suite_are_read() {
    let own = "float g(float x) { return x * 2.0; }\n";
    for name in ["../shared.glsl", "../shared.inc", "near", "near.txt", "good.glsl"] {
        for (toml, shader) in [
            (format!("shader = \"{name}\"\nentry = \"g\""), own.to_owned()),
            (format!("shader = \"s.glsl\"\nentry = \"g\"\nreference = \"{name}\""), own.to_owned()),
            (
                "shader = \"s.glsl\"\nentry = \"f\"".to_owned(),
                format!("#include \"{name}\"\nfloat f(float x) {{ return g(x); }}\n"),
            ),
        ] {
            let folder = project(&toml, &shader);
            let ran: Ran = command(folder.path(), "check suite --lane embedded").output().unwrap().into();
            assert!(ran.code == 0 && ran.out.contains("ok "), "{toml} {shader}: {ran:?}");
        }
    }
    // A folder that the user names may be anywhere.
    let folder =
        project("shader = \"s.glsl\"\nentry = \"g\"", "#include <near.txt>\nfloat h(float x) { return g(x); }\n");
    fs::create_dir(folder.path().join("sub")).unwrap();
    fs::rename(folder.path().join("suite/s.glsl"), folder.path().join("sub/s.glsl")).unwrap();
    let args = "translate sub/s.glsl --entry h --to wgsl -I suite";
    let ran: Ran = command(folder.path(), args).output().unwrap().into();
    ran.expect(0);
}

#[test]
fn a_script_runs_from_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("some where");
    fs::create_dir(&inner).unwrap();
    wrong(&inner, "a.suite.toml", "s.glsl");
    let args = ["check", "a.suite.toml", "--lane", "embedded", "--report-dir", "../out"];
    Ran::from(command(&inner, "").args(args).output().unwrap()).expect(1);
    let script = folder.path().join("out/own-embedded-compute-1/reproduce.sh");
    let program = Path::new(env!("CARGO_BIN_EXE_shadercheck")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let run = |from: &Path| -> Ran {
        let mut shell = std::process::Command::new("/bin/sh");
        shell.arg(&script).env("PATH", &path).current_dir(from).output().unwrap().into()
    };
    for from in [Path::new("/"), folder.path(), inner.as_path()] {
        let ran = run(from).expect(1);
        assert!(ran.out.contains("the shader deviates from its reference"), "{ran:?}");
    }
    // It is the case that runs, not only some command: a repaired shader passes.
    fs::copy(inner.join("r.glsl"), inner.join("s.glsl")).unwrap();
    run(Path::new("/")).expect(0);
}

#[test]
fn a_reference_without_a_version_gets_the_one_that_fits() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let check = |shader: &str, reference: &str| -> Ran {
        write("s.vert", shader);
        write("r.vert", reference);
        write(
            "a.suite.toml",
            "suite = \"own\"\nshader = \"s.vert\"\nstage = \"vertex\"\nsamples = 64\nreference = \"r.vert\"\n\
             [[inputs]]\nnames = [\"p\"]\ngenerator = \"interval\"\nrange = [-2.0, 2.0]\n",
        );
        command(folder.path(), "check a.suite.toml --lane embedded").output().unwrap().into()
    };
    let modern = "in vec3 p;\nout vec3 q;\nvoid main() { q = p * 2; gl_Position = vec4(p, 1.0f); }\n";
    let old = "attribute vec3 p;\nvarying vec3 q;\nvoid main() { q = p * 2.0; gl_Position = vec4(p, 1.0); }\n";
    let located =
        "layout(location = 0) in vec3 p;\nout vec3 q;\nvoid main() { q = p * 2.0; gl_Position = vec4(p, 1.0); }\n";
    let embedded = "precision mediump float;\nattribute vec3 p;\nvarying vec3 q;\n\
                    void main() { q = p * 2.0; gl_Position = vec4(p, 1.0); }\n";
    for version in ["150", "330 core", "450"] {
        for reference in [modern, old, located, embedded] {
            let ran = check(&format!("#version {version}\n{modern}"), reference);
            assert!(ran.code == 0 && ran.out.contains(" 0 deviated"), "{version} {reference}: {ran:?}");
        }
        // It is compared, and not only read.
        let ran = check(&format!("#version {version}\n{modern}"), &modern.replace("p * 2", "p * 3"));
        assert!(ran.code == 1 && ran.out.contains("deviates from its reference"), "{ran:?}");
    }
    // What no version allows is told, where it stands; a version that is stated is believed.
    let ran = check(&format!("#version 330\n{modern}"), &modern.replace("vec4(p, 1.0f)", "p"));
    assert_ne!(ran.code, 0, "{ran:?}");
    assert!(ran.out.contains("r.vert:3:") || ran.err.contains("r.vert:3:"), "{ran:?}");
    let ran = check(&format!("#version 330\n{modern}"), &format!("#version 110\n{modern}"));
    assert_ne!(ran.code, 0, "{ran:?}");
}
