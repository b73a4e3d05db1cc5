//! What is in packages beside the program: the launcher of the npm package, the module of the wheel, and what each says of
//! versions. `cargo xtask package` makes and tries the packages themselves.

use std::fs;
use std::process::Command;

use hosts::document::DOCUMENT_EXTENSIONS;
use hosts::script::SCRIPT_EXTENSIONS;
use hosts::{HOST_EXTENSIONS, SHADER_EXTENSIONS};
use serde_json::Value;
use test_record::not_run;

use crate::binary::{Ran, command, root};

/// A command that starts with a program of the machine, where that has what is needed.
fn there(program: &str, arguments: &[&str]) -> bool {
    Command::new(program).args(arguments).output().is_ok_and(|output| output.status.success())
}

#[test]
fn the_launcher_passes_arguments_output_and_status() {
    if !there("node", &["--version"]) {
        return not_run("no Node.js: the launcher of the npm package");
    }
    let launched = |binary: Option<&str>, arguments: &[&str]| -> Ran {
        let mut command = Command::new("node");
        command.arg(root().join("deploy/npm/shadercheck.js")).args(arguments).current_dir(root());
        command.env_remove("SHADERCHECK_BINARY").envs(binary.map(|binary| ("SHADERCHECK_BINARY", binary)));
        command.output().unwrap().into()
    };
    let own = Some(env!("CARGO_BIN_EXE_shadercheck"));
    let words = ["lint", "fixtures/tour", "--format", "concise", "--lang", "en"];
    let direct: Ran = command(root(), &words.join(" ")).output().unwrap().into();
    assert_eq!(launched(own, &words), direct.expect(1));
    launched(own, &["lint", "no such file"]).expect(2);
    assert!(launched(None, &["--version"]).expect(2).err.contains("install again without --omit=optional"));
    assert!(launched(Some("/nowhere/shadercheck"), &["--version"]).expect(2).err.contains("ENOENT"));
}

const PYTHON: &str = r#"
import sys, numpy as np, shadercheck
data = shadercheck.read("sphere.npz")
expected, bound = data.expected["gl_Position"], data.bound["gl_Position"]
assert expected.shape == (500, 4) and expected.dtype == np.float64, expected.shape
assert data.inputs["parameter"].shape == (500, 2) and data.case("mc").shape == (500, 4, 4)
assert data.within(data.nearest["gl_Position"], "gl_Position").all()
off = expected + 3.0 * np.where(np.isfinite(bound), bound, 0.0) + 1e-6
assert not data.within(off, "gl_Position").all() and not data.within(np.full_like(expected, np.nan), "gl_Position").any()
for wrong, name, part in [(expected[:, :3], "gl_Position", "shape (500, 3), and"), (expected, "colour", "gl_Position")]:
    try:
        data.within(wrong, name)
        sys.exit("an array that does not fit was compared")
    except (KeyError, ValueError) as error:
        assert part in str(error), error
np.savez("other.npz", a=np.zeros(3))
try:
    shadercheck.read("other.npz")
    sys.exit("another file was read")
except ValueError as error:
    assert "no provenance" in str(error), error
"#;

#[test]
fn the_module_of_the_wheel_reads_what_is_written() {
    let python = std::env::var("SHADERCHECK_PYTHON").unwrap_or_else(|_| "python3".into());
    if !there(&python, &["-c", "import numpy"]) {
        return not_run("python3 has no numpy (SHADERCHECK_PYTHON names an interpreter that has): deploy/python");
    }
    let folder = tempfile::tempdir().unwrap();
    let write = "refdata generate sphere --samples 500 --profile vulkan-practice -o sphere.npz";
    let made: Ran = command(folder.path(), write).output().unwrap().into();
    made.expect(0);
    let ran: Ran = Command::new(&python)
        .args(["-c", PYTHON])
        .env("PYTHONPATH", root().join("deploy/python"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .current_dir(folder.path())
        .output()
        .unwrap()
        .into();
    ran.expect(0);
}

#[test]
fn packages_have_the_version_of_the_program() {
    let text = |path: &str| fs::read_to_string(root().join(path)).unwrap();
    let version = env!("CARGO_PKG_VERSION");
    let hooks = text("deploy/pre-commit/pyproject.toml");
    assert!(
        hooks.contains(&format!("\"shadercheck=={version}\"")) && hooks.contains(&format!("version = \"{version}\""))
    );
    assert!(text("deploy/homebrew/shadercheck.rb").contains(&format!("/v{version}.tar.gz")));
    assert!(text("deploy/kubernetes/shards.yaml").contains(&format!("image: shadercheck:{version}\n")));
    let extension: Value = serde_json::from_str(&text("editors/vscode/package.json")).unwrap();
    assert_eq!(extension["version"], version);
    // The wheel takes it from Cargo.toml.
    let wheel: toml::Table = toml::from_str(&text("pyproject.toml")).unwrap();
    assert!(wheel["project"]["dynamic"].as_array().unwrap().iter().any(|key| key.as_str() == Some("version")));
}

#[test]
fn hooks_take_every_file_that_lint_reads() {
    let endings = [SHADER_EXTENSIONS, HOST_EXTENSIONS, SCRIPT_EXTENSIONS, DOCUMENT_EXTENSIONS];
    for name in [".pre-commit-hooks.yaml", "deploy/pre-commit/.pre-commit-hooks.yaml"] {
        let text = fs::read_to_string(root().join(name)).unwrap();
        let (_, pattern) = text.split_once("\\.(").unwrap();
        let named: Vec<&str> = pattern.split_once(")$").unwrap().0.split('|').collect();
        assert_eq!(named, endings.concat(), "{name}");
    }
}

/// The script that the image starts, as a user who is root or not, in a folder of that owner; it gives the command.
#[cfg(unix)]
fn entered(user: &str, owner: &str) -> String {
    use std::os::unix::fs::PermissionsExt;

    let folder = tempfile::tempdir().unwrap();
    for (name, script) in [
        ("id", format!("echo {user}")),
        ("stat", format!("echo {owner}")),
        ("setpriv", "echo setpriv $*".into()),
        ("shadercheck", "echo shadercheck $*".into()),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    }
    let path = format!("{}:{}", folder.path().display(), std::env::var("PATH").unwrap());
    let script = root().join("deploy/container/entry.sh");
    let ran: Ran = Command::new("sh").arg(script).args(["lint", "."]).env("PATH", path).output().unwrap().into();
    ran.expect(0).out.trim().to_owned()
}

#[cfg(unix)]
#[test]
fn the_image_runs_as_the_owner_of_the_folder_and_never_as_root() {
    let rest = "--clear-groups shadercheck lint .";
    assert_eq!(entered("0", "1000:100"), format!("setpriv --reuid 1000 --regid 100 {rest}"));
    assert_eq!(entered("0", "0:0"), format!("setpriv --reuid 65534 --regid 65534 {rest}"));
    assert_eq!(entered("65534", "0:0"), "shadercheck lint .");
}

#[test]
fn the_image_is_built_of_what_its_context_has() {
    let ignored = fs::read_to_string(root().join(".dockerignore")).unwrap();
    assert!(ignored.lines().any(|line| line == "*"), "everything is left out that is not named");
    let taken: Vec<&str> = ignored.lines().filter_map(|line| line.strip_prefix('!')).collect();
    for path in &taken {
        assert!(root().join(path).exists(), "{path}");
    }
    let recipe = fs::read_to_string(root().join("deploy/container/Dockerfile")).unwrap();
    let copied = recipe.lines().filter_map(|line| line.strip_prefix("COPY ")).filter(|line| !line.starts_with("--"));
    for path in copied.flat_map(|line| line.split(' ').take(line.split(' ').count() - 1)).filter(|path| *path != ".") {
        assert!(taken.iter().any(|taken| path.starts_with(taken)), "{path}");
    }
    // The workspace, without which cargo reads no manifest.
    for path in ["Cargo.toml", "Cargo.lock", "build.rs", "src", "crates", "shaders", "tests/record", "xtask", "benches"]
    {
        assert!(taken.contains(&path), "{path}");
    }
}

#[test]
fn archives_are_where_installers_look_for_them() {
    let manifest: toml::Table = toml::from_str(&fs::read_to_string(root().join("Cargo.toml")).unwrap()).unwrap();
    let install = &manifest["package"]["metadata"]["binstall"];
    let place = |target: &str, ending: &str| {
        let url = install["pkg-url"].as_str().unwrap();
        let url = url.replace("{ name }", "shadercheck").replace("{ target }", target);
        url.replace("{ archive-suffix }", ending).rsplit('/').next().unwrap().to_owned()
    };
    // As `cargo xtask package` names them, and as the script of the action downloads them.
    assert_eq!(place("x86_64-unknown-linux-gnu", ".tar.gz"), "shadercheck-x86_64-unknown-linux-gnu.tar.gz");
    let script = fs::read_to_string(root().join("deploy/github/download.sh")).unwrap();
    let release = fs::read_to_string(root().join(".github/workflows/release.yml")).unwrap();
    let targets: Vec<&str> = release.split("target: ").skip(1).filter_map(|rest| rest.split(',').next()).collect();
    assert_eq!(targets.len(), 6, "{targets:?}");
    // musl is a choice, which nobody's machine says.
    for target in targets.iter().filter(|target| !target.contains("windows") && !target.contains("musl")) {
        assert!(script.contains(&format!("target={target} ")), "{target}");
    }
}
