//! Keeps builds with and without tests from compiling the dependencies twice. A test dependency
//! that turns on one more feature of, say, once_cell gives naga and wgpu a second build, which
//! doubles the first run on a fresh machine.

use std::collections::BTreeMap;

use anyhow::{Result, ensure};

use crate::cargo::cargo;

/// A line for each dependency whose features differ between `cargo build` and `cargo test`, or between `cargo xtask`, which
/// is built first, and `cargo build`.
pub fn compiled_twice() -> Result<Vec<String>> {
    let build = tree(&["--package", "shadercheck", "--edges", "normal"])?;
    // The tests are those of all crates, whose own test dependencies and default features count as well.
    let test = tree(&["--workspace", "--edges", "normal,dev"])?;
    let xtask = tree(&["--package", "xtask", "--edges", "normal"])?;
    Ok([differing(&build, &test), differing(&xtask, &build)].concat())
}

fn tree(of: &[&str]) -> Result<String> {
    let listing = ["tree", "--locked", "--prefix", "none", "--format", "{p} [{f}]"];
    // Procedural macros are built for the host, apart from everything else.
    let output = cargo(listing).args(of).args(["--edges", "no-proc-macro"]).output()?;
    ensure!(output.status.success(), "cargo tree failed: {}", String::from_utf8_lossy(&output.stderr).trim());
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn differing(build: &str, test: &str) -> Vec<String> {
    let (build, test) = (features(build), features(test));
    let twice = build.iter().filter_map(|(package, features)| {
        let other = test.get(package).filter(|other| *other != features)?;
        Some(format!("{package} is built twice: with features {features}, and above that with {other}"))
    });
    twice.collect()
}

/// Features by package and version.
fn features(tree: &str) -> BTreeMap<String, String> {
    let rows = tree.lines().filter_map(|line| line.trim_end_matches(" (*)").split_once(" ["));
    rows.map(|(package, features)| (package.to_owned(), format!("[{features}"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_feature_that_only_tests_turn_on_is_reported() {
        let build = "naga v30.0.1 [std]\nonce_cell v1.21.4 [alloc,std] (*)\n";
        let test = "naga v30.0.1 [std]\nonce_cell v1.21.4 [alloc,default,std]\n\ninsta v1.49.0 [default]\n";
        assert_eq!(
            differing(build, test),
            ["once_cell v1.21.4 is built twice: with features [alloc,std], and above that with [alloc,default,std]"]
        );
    }

    #[test]
    fn a_test_dependency_of_its_own_is_fine() {
        assert!(differing("naga v30.0.1 [std]\n", "naga v30.0.1 [std] (*)\napprox v0.5.1 [std]\n").is_empty());
    }
}
