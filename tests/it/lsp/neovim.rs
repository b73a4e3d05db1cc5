//! Neovim, without a screen, as the client.

use std::fs;
use std::process::Command;

use test_record::not_run;

use crate::binary::{root, run_in, say};

#[test]
fn neovim_repairs_the_tour_and_renames_a_uniform() {
    if Command::new("nvim").arg("--version").output().is_err() {
        return not_run("nvim is not on PATH: the language server was not tested with an editor");
    }
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(root().join("fixtures/tour")).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    let state = tempfile::tempdir().unwrap();
    let output = Command::new("nvim")
        .args(["--headless", "--clean", "-n", "-c"])
        .arg(format!("luafile {}", root().join("tests/it/lsp/nvim.lua").display()))
        .env("SHADERCHECK", env!("CARGO_BIN_EXE_shadercheck"))
        .env("TOUR", folder.path())
        .env("LANG", "C.UTF-8")
        .env("HOME", state.path())
        .env("XDG_STATE_HOME", state.path())
        .output()
        .unwrap();
    let transcript = String::from_utf8_lossy(&output.stdout);
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && transcript.contains("saved"), "{transcript}\n{complaints}");
    say(&transcript);
    let text = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(text("scene.vert").contains("uniform mat4 lens;") && text("scene.cpp").contains("\"lens\""));
    let ran = run_in(folder.path(), "lint --lang en .");
    assert_eq!(ran.code, 0, "{}", ran.out);
}
