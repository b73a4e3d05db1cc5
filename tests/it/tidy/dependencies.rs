//! Which crate may depend on what. That edges point one way is Cargo's to hold; what it cannot know is held here: that
//! nothing below the engine needs a driver, a process or a file, and that the content of the chapter is nobody's need.

use std::collections::{BTreeMap, BTreeSet};

use super::paths;
use super::{Fault, File, expect_none, file, messages, project};

/// Crates of the workspace that run in a browser as well: none of them may need what is in [`OUTSIDE`], directly or
/// through another.
const INSIDE: [&str; 12] = [
    "base", "number", "syntax", "compose", "property", "program", "judge", "hosts", "analysis", "reading", "lint",
    "lsp",
];

/// Libraries that open devices, start processes or write files.
const OUTSIDE: [&str; 12] = [
    "wgpu",
    "ash",
    "glow",
    "khronos-egl",
    "pollster",
    "tempfile",
    "signal-hook",
    "indicatif",
    "clap",
    "mimalloc",
    "terminal_size",
    "ignore",
];

/// Crates of the workspace that may depend on the chapter: reference data are made of its formulas and reported, and the
/// program ships its suites. Of the report, `test` takes a feature that leaves it out, see [`LARGE`].
const WITH_CHAPTER: [&str; 4] = ["refdata", "report", "shadercheck", "test"];

/// What a project that tests its shaders under cargo must not have to build: drivers, files of reference data, rewrites
/// and the linter with its readers of host code.
const LARGE: [&str; 8] =
    ["wgpu", "ash", "parquet", "egg", "maud", "tree-sitter-cpp", "shadercheck-lint", "shadercheck-chapter"];

/// Libraries, and parts of the standard library, with the places that may name them. A part of the standard library may
/// be named in test code anywhere.
const CONFINED: &[(&str, &[&str])] = &[
    ("wgpu", &["crates/lanes/src/vulkan"]),
    ("pollster", &["crates/lanes/src/vulkan"]),
    ("khronos_egl", &["crates/lanes/src/opengl"]),
    ("glow", &["crates/lanes/src/opengl"]),
    ("ash", &["crates/lanes/src/native"]),
    ("std::fs", &["src/cli", "crates/disk/src", "crates/engine/src/suite"]),
    ("std::env", &["src/cli", "crates/engine/src/suite"]),
    ("std::process::exit", &[]),
];

/// Folders whose files may name these libraries and no other: what they judge must not reach them.
const CLOSED: &[(&str, &[&str])] = &[("crates/chapter/src/formula", &["glam", "approx", "judge"])];

/// Names of modules from the workspace's root to this file: `crates/lint/src/glsl/mod.rs` is `lint`, `glsl`.
fn modules_of(path: &str) -> Vec<&str> {
    let path = path.strip_prefix("crates/").or_else(|| path.strip_prefix("src/")).unwrap_or(path);
    path.trim_end_matches(".rs").split('/').filter(|name| !["src", "mod", "lib", "main"].contains(name)).collect()
}

/// The dependencies of each crate of the workspace, without those of tests, by the name of its folder.
fn graph(files: &[File]) -> BTreeMap<String, BTreeSet<String>> {
    let of = |file: &File| {
        let name = match file.path.strip_suffix("Cargo.toml")? {
            "" => "shadercheck",
            folder => folder.strip_prefix("crates/")?.trim_end_matches('/'),
        };
        let manifest: toml::Table = file.text.parse().expect("Cargo.toml is TOML");
        let mut names = BTreeSet::new();
        let unix = || manifest.get("target")?.get("cfg(unix)")?.get("dependencies");
        for table in [manifest.get("dependencies"), unix()].into_iter().flatten().filter_map(toml::Value::as_table) {
            names.extend(table.keys().cloned());
        }
        Some((name.to_owned(), names))
    };
    files.iter().filter_map(of).collect()
}

/// Dependencies that a crate must not have, directly or through another crate of the workspace.
fn wrong_dependencies(graph: &BTreeMap<String, BTreeSet<String>>) -> Vec<String> {
    let mut faults = Vec::new();
    for (name, direct) in graph {
        let mut reached = direct.clone();
        let mut open: Vec<&String> = direct.iter().collect();
        while let Some(next) = open.pop() {
            for further in graph.get(next).into_iter().flatten() {
                if reached.insert(further.clone()) {
                    open.push(further);
                }
            }
        }
        if INSIDE.contains(&name.as_str()) {
            let outside = OUTSIDE.iter().filter(|library| reached.contains(**library));
            faults.extend(outside.map(|library| format!("`{name}` must do without `{library}`")));
        }
        if reached.contains("chapter") && !WITH_CHAPTER.contains(&name.as_str()) {
            faults.push(format!("`{name}` must not need the content of the chapter"));
        }
    }
    faults
}

/// Modules that exist in test builds alone: declared `mod name;` under `#[cfg(test)]`.
pub(super) fn test_modules(files: &[File]) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    for file in files.iter().filter(|file| is_source(file)) {
        let lines: Vec<&str> = file.text.lines().map(str::trim).collect();
        for pair in lines.windows(2).filter(|pair| pair[0] == "#[cfg(test)]") {
            let declared = pair[1].trim_start_matches("pub ").strip_prefix("mod ").and_then(|m| m.strip_suffix(';'));
            if let Some(name) = declared {
                found.push(modules_of(&file.path).into_iter().chain([name]).map(str::to_owned).collect());
            }
        }
    }
    found
}

/// True for a file inside one of these modules.
pub(super) fn is_test_file(file: &File, test_modules: &[Vec<String>]) -> bool {
    let own = modules_of(&file.path);
    test_modules.iter().any(|module| own.len() >= module.len() && own.iter().zip(module).all(|(a, b)| a == b))
}

/// Crates and parts of the standard library outside of their places.
fn strays(files: &[File], crates: &BTreeSet<String>) -> Vec<Fault> {
    let mut faults = Vec::new();
    let test_modules = test_modules(files);
    for file in files.iter().filter(|file| is_source(file)) {
        let in_test = is_test_file(file, &test_modules);
        // A file that is not Rust is reported by the check of edges.
        for path in paths::named(&file.text).unwrap_or_default() {
            let name = path.segments.join("::");
            // A single word is a crate only where it is imported; elsewhere it is anyone's variable.
            if path.segments.len() == 1 && !path.import {
                continue;
            }
            for (what, places) in CONFINED {
                let named = name == *what || name.starts_with(&format!("{what}::"));
                let excused = ((path.test || in_test) && what.starts_with("std")) || file.path == "src/main.rs";
                if named && !file.is_below(places) && !excused {
                    let places = if places.is_empty() { "src/main.rs".into() } else { places.join(", ") };
                    faults.push(file.fault(path.line, format!("`{what}` may be named in {places} alone")));
                }
            }
            for (module, open) in CLOSED {
                let root = path.segments[0].as_str();
                if file.is_below(&[module]) && crates.contains(root) && !open.contains(&root) {
                    let open = open.join(", ");
                    faults.push(file.fault(path.line, format!("`{module}` imports std, {open} alone, not `{root}`")));
                }
            }
        }
    }
    faults
}

/// Libraries and crates that any manifest of the workspace names, as Rust spells them.
fn crates(manifest: &str) -> BTreeSet<String> {
    let manifest: toml::Table = manifest.parse().expect("Cargo.toml is TOML");
    let all = manifest.get("workspace").and_then(|w| w.get("dependencies")).and_then(toml::Value::as_table);
    all.into_iter().flat_map(toml::Table::keys).map(|name| name.replace('-', "_")).collect()
}

/// True for Rust of the program and of its crates.
pub(super) fn is_source(file: &File) -> bool {
    let inside = file.is_below(&["src"]) || (file.is_below(&["crates"]) && file.path.contains("/src/"));
    inside && file.path.ends_with(".rs")
}

#[test]
fn nobody_needs_what_it_must_do_without() {
    let files = project();
    let graph = graph(&files);
    assert!(INSIDE.iter().chain(&["lanes", "engine", "chapter"]).all(|name| graph.contains_key(*name)), "{graph:?}");
    assert_eq!(wrong_dependencies(&graph), Vec::<String>::new());
}

/// Those of [`LARGE`] that are built for a crate with these features, as `cargo tree` says.
fn large(of: &str, features: &[&str]) -> Vec<&'static str> {
    let mut cargo = std::process::Command::new(env!("CARGO"));
    cargo.args(["tree", "--locked", "--offline", "--edges", "normal,build", "--prefix", "none", "--package", of]);
    let output = cargo.args(features).current_dir(env!("CARGO_MANIFEST_DIR")).output().expect("cargo runs");
    let tree = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && tree.starts_with(of), "{}", String::from_utf8_lossy(&output.stderr));
    let built: BTreeSet<&str> = tree.lines().filter_map(|line| line.split(' ').next()).collect();
    LARGE.into_iter().filter(|library| built.contains(library)).collect()
}

#[test]
fn tests_under_cargo_build_suites_alone() {
    assert_eq!(large("shadercheck-test", &[]), Vec::<&str>::new());
    assert_eq!(large("shadercheck-test", &["--features", "drivers"]), ["wgpu", "ash"]);
    assert_eq!(large("shadercheck", &[]), LARGE, "the program has all of them");
}

#[test]
fn libraries_and_system_access_stay_in_their_places() {
    let files = project();
    expect_none(&strays(&files, &crates(&file(&files, "Cargo.toml").text)));
}

#[cfg(test)]
mod planted {
    use super::*;

    #[test]
    fn a_file_of_a_test_module_is_test_code_and_its_neighbour_is_not() {
        let files = [
            File::new("crates/judge/src/tape/mod.rs", "mod sweep;\n#[cfg(test)]\nmod tests;\n"),
            File::new("crates/judge/src/tape/tests.rs", "use std::fs::read;"),
            File::new("crates/judge/src/tape/sweep.rs", "use std::fs::read;"),
        ];
        let faults = strays(&files, &crates("[workspace.dependencies]\n"));
        assert_eq!(messages(&faults).len(), 1, "{:?}", messages(&faults));
        assert!(faults[0].to_string().contains("sweep.rs"));
    }

    fn faults(manifests: &[(&str, &str)]) -> Vec<String> {
        let files: Vec<File> = manifests
            .iter()
            .map(|(path, names)| {
                let lines: String = names.split_whitespace().map(|name| format!("{name}.workspace = true\n")).collect();
                File::new(path, &format!("[dependencies]\n{lines}"))
            })
            .collect();
        wrong_dependencies(&graph(&files))
    }

    #[test]
    fn a_driver_below_the_judge_is_reported_however_far_away() {
        let below = ("crates/number/Cargo.toml", "ash");
        let reported = ["`judge` must do without `ash`", "`number` must do without `ash`"];
        assert_eq!(faults(&[("crates/judge/Cargo.toml", "number"), below]), reported);
        assert!(faults(&[("crates/judge/Cargo.toml", "number"), ("crates/lanes/Cargo.toml", "ash")]).is_empty());
    }

    #[test]
    fn an_engine_that_needs_the_chapter_is_reported() {
        let reported = ["`engine` must not need the content of the chapter"];
        assert_eq!(faults(&[("crates/engine/Cargo.toml", "chapter judge")]), reported);
        assert!(
            faults(&[("crates/chapter/Cargo.toml", "engine"), ("crates/refdata/Cargo.toml", "chapter")]).is_empty()
        );
    }

    fn stray(path: &str, text: &str) -> Vec<String> {
        let crates = crates("[workspace.dependencies]\nnaga = '1'\nglam = '1'\nglsl-lang = '1'\n");
        let faults = strays(&[File::new(path, text)], &crates);
        messages(&faults).into_iter().map(String::from).collect()
    }

    #[test]
    fn a_library_outside_of_its_place_is_reported() {
        let message = "`wgpu` may be named in crates/lanes/src/vulkan alone";
        assert_eq!(stray("crates/lanes/src/lib.rs", "use wgpu;"), [message]);
        assert_eq!(stray("crates/judge/src/lib.rs", "fn f(d: &wgpu::Device) {}"), [message]);
        assert!(stray("crates/lanes/src/vulkan/mod.rs", "use wgpu::Device;").is_empty());
    }

    #[test]
    fn system_access_outside_of_its_place_is_reported() {
        assert_eq!(stray("crates/report/src/lib.rs", "use std::{fmt, fs};").len(), 1);
        assert_eq!(stray("crates/report/src/lib.rs", "fn f() { std::env::var(\"A\"); }").len(), 1);
        assert!(stray("crates/report/src/lib.rs", "#[cfg(test)] mod tests { use std::fs; }").is_empty());
        assert!(stray("src/cli/lint.rs", "use std::fs;").is_empty());
        assert_eq!(stray("src/cli/mod.rs", "fn f() { std::process::exit(1) }").len(), 1);
        assert!(stray("src/main.rs", "fn f() { std::process::exit(1) }").is_empty());
    }

    #[test]
    fn a_library_in_a_formula_is_reported() {
        let message = "`crates/chapter/src/formula` imports std, glam, approx, judge alone, not `glsl_lang`";
        assert_eq!(stray("crates/chapter/src/formula/curve.rs", "use glam::DVec4;\nuse glsl_lang::ast;"), [message]);
    }
}
