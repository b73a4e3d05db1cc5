//! How often a driver compiles: what it has to compile for every case of a run is slow without its cache, and a driver
//! that is compiling must not look like one that hangs.

use std::fs;
use std::path::Path;

use crate::binary::{Ran, command, root};

/// Files below a folder.
fn files(folder: &Path) -> usize {
    let entries = fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap());
    entries.map(|entry| if entry.file_type().unwrap().is_dir() { files(&entry.path()) } else { 1 }).sum()
}

/// Loops and branches whose number of rounds is a uniform: 16 samples share each of the 32 values.
const CHECK: &str = "check skinning --lane vulkan-glslang --samples 2048 --plain";

#[test]
fn no_case_of_a_run_has_the_driver_compile_again() {
    let folder = tempfile::tempdir().unwrap();
    let ran: Ran = command(root(), CHECK).env("MESA_SHADER_CACHE_DIR", folder.path()).output().unwrap().into();
    let ran = ran.expect(0);
    assert!(ran.out.starts_with("ok    skinning "), "{}", ran.out);
    // 128 cases; one shader for the run itself, and a few for what is looked at beside it.
    let compiled = files(folder.path());
    assert!((1..=24).contains(&compiled), "{compiled} shaders were compiled");
}

#[test]
fn a_run_passes_where_the_driver_keeps_nothing() {
    let mut command = command(root(), CHECK);
    command.env("MESA_SHADER_CACHE_DISABLE", "true").env("MESA_GLSL_CACHE_DISABLE", "true");
    let ran: Ran = command.output().unwrap().into();
    assert!(ran.expect(0).out.starts_with("ok    skinning "));
}
