//! Which module may name what. The tables are the architecture; a row changes together with
//! ARCHITECTURE.md or not at all.

use std::collections::BTreeSet;

use super::paths::{self, Named};
use super::{Fault, File, expect_none, file, messages, project};

/// Modules of `src`, lowest first, with the modules that each may name. Sides of a comparison do not
/// meet below `verdict`: no row before it lists both `formula` and `lane`. Test code may name any
/// module of an earlier row.
const MODULES: &[(&str, &[&str])] = &[
    ("text", &[]),
    ("value", &[]),
    ("math", &[]),
    ("diagnostic", &["text"]),
    ("formula", &[]),
    ("exact", &["math"]),
    ("shard", &[]),
    ("glsl", &["math", "text", "diagnostic", "value"]),
    ("lint", &["glsl", "text", "diagnostic", "value"]),
    ("lower", &["glsl", "text", "diagnostic", "value"]),
    ("program", &["lower", "glsl", "text", "diagnostic", "value"]),
    ("interp", &["program", "math", "text", "value"]),
    ("lane", &["interp", "program", "lower", "glsl", "text", "value"]),
    ("property", &["math", "text", "value"]),
    ("bound", &["property", "lane", "interp", "program", "lower", "glsl", "text", "diagnostic", "math", "value"]),
    ("verdict", &["bound", "property", "formula", "lane", "interp", "program", "text", "diagnostic", "value"]),
    (
        "suite",
        &[
            "verdict",
            "bound",
            "property",
            "lane",
            "interp",
            "formula",
            "program",
            "lower",
            "glsl",
            "text",
            "diagnostic",
            "value",
            "shard",
        ],
    ),
    (
        "fuzz",
        &["verdict", "bound", "property", "lane", "interp", "program", "lower", "glsl", "text", "diagnostic", "value"],
    ),
    (
        "mutate",
        &[
            "suite",
            "verdict",
            "bound",
            "property",
            "lane",
            "program",
            "lower",
            "glsl",
            "text",
            "diagnostic",
            "value",
            "shard",
        ],
    ),
    (
        "refdata",
        &[
            "fuzz", "suite", "verdict", "bound", "property", "lane", "interp", "program", "formula", "exact", "math",
            "value",
        ],
    ),
    (
        "report",
        &[
            "refdata",
            "mutate",
            "fuzz",
            "suite",
            "verdict",
            "property",
            "lane",
            "program",
            "lint",
            "text",
            "diagnostic",
            "value",
        ],
    ),
    (
        "api",
        &[
            "report",
            "suite",
            "verdict",
            "bound",
            "property",
            "lane",
            "program",
            "lower",
            "glsl",
            "text",
            "diagnostic",
            "value",
        ],
    ),
    (
        "cli",
        &[
            "report",
            "refdata",
            "mutate",
            "fuzz",
            "suite",
            "lint",
            "verdict",
            "bound",
            "property",
            "lane",
            "formula",
            "program",
            "lower",
            "glsl",
            "text",
            "diagnostic",
            "value",
            "shard",
        ],
    ),
];

/// Crates, and parts of the standard library, with the places that may name them. A part of the
/// standard library may be named in test code anywhere.
const CONFINED: &[(&str, &[&str])] = &[
    ("wgpu", &["src/lane/vulkan"]),
    ("pollster", &["src/lane/vulkan"]),
    ("khronos_egl", &["src/lane/opengl"]),
    ("glow", &["src/lane/opengl"]),
    ("ash", &["src/lane/native"]),
    ("pulp", &["src/math"]),
    ("naga", &["src/lower", "src/program", "src/interp", "src/lane"]),
    ("tree_sitter", &["src/lint"]),
    ("tree_sitter_cpp", &["src/lint"]),
    ("encoding_rs", &["src/text"]),
    ("chardetng", &["src/text"]),
    ("ignore", &["src/cli"]),
    ("signal_hook", &["src/cli"]),
    ("globset", &["src/cli"]),
    ("libtest_mimic", &["src/api"]),
    ("std::fs", &["src/cli", "src/suite"]),
    ("std::env", &["src/cli", "src/suite"]),
    ("std::process::exit", &[]),
];

/// Modules that may name these crates and no other: what they judge must not reach the formulas, and
/// `math` is a leaf.
/// approx and astro_float are dependencies of tests, and cargo keeps them out of everything else.
const CLOSED: &[(&str, &[&str])] = &[("formula", &["glam", "approx"]), ("math", &["pulp", "astro_float"])];

/// Files of the crate that are not inside a module.
const ROOTS: [&str; 2] = ["src/lib.rs", "src/main.rs"];

/// Names of modules from the crate's root to this file: `src/lint/glsl/mod.rs` is `lint`, `glsl`.
fn modules_of(path: &str) -> Vec<&str> {
    let path = path.strip_prefix("src/").unwrap_or(path);
    path.trim_end_matches(".rs").split('/').filter(|name| !["mod", "lib", "main"].contains(name)).collect()
}

/// The module of the crate that a path leads to from a file `depth` modules deep, if it leaves its own.
fn destination(path: &Named, depth: usize) -> Option<&str> {
    let segments = &path.segments;
    let ups = segments.iter().take_while(|segment| *segment == "super").count();
    let at_root = match segments[0].as_str() {
        "crate" | "shadercheck" => 1,
        "super" if ups >= depth + path.inside => ups,
        _ => return None,
    };
    segments.get(at_root).map(String::as_str)
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

/// Edges between modules that the table does not have.
fn wrong_edges(files: &[File], table: &[(&str, &[&str])]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let test_modules = test_modules(files);
    for file in files.iter().filter(|file| is_source(file) && !ROOTS.contains(&file.path.as_str())) {
        let in_test = is_test_file(file, &test_modules);
        let modules = modules_of(&file.path);
        let own = modules[0];
        let Some(row) = table.iter().position(|(name, _)| *name == own) else {
            faults.push(file.fault(1, format!("the module `{own}` is not in the table of dependencies")));
            continue;
        };
        match paths::named(&file.text) {
            Err(error) => faults.push(file.fault(1, format!("cannot be read as Rust: {error}"))),
            Ok(paths) => faults.extend(paths.iter().filter_map(|path| {
                let other = destination(path, modules.len())?;
                let earlier = || table[..row].iter().any(|(name, _)| *name == other);
                let wrong = other != own && !table[row].1.contains(&other) && !((path.test || in_test) && earlier());
                wrong.then(|| file.fault(path.line, format!("`{own}` must not depend on `{other}`")))
            })),
        }
    }
    faults
}

/// Rows that name a module below them: with none, the table has no cycle.
fn upward_rows(table: &[(&str, &[&str])]) -> Vec<String> {
    let below = |at: usize| table[..at].iter().map(|(name, _)| *name).collect::<BTreeSet<_>>();
    let upward = |(at, (name, uses)): (usize, &(&str, &[&str]))| {
        let below = below(at);
        uses.iter().find(|used| !below.contains(*used)).map(|used| format!("{name} names {used}"))
    };
    table.iter().enumerate().filter_map(upward).collect()
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
                if modules_of(&file.path).first() == Some(module) && crates.contains(root) && !open.contains(&root) {
                    let open = open.join(", ");
                    faults.push(file.fault(path.line, format!("`{module}` imports std, {open} alone, not `{root}`")));
                }
            }
        }
    }
    faults
}

/// The crates that Cargo.toml names, as Rust spells them.
fn crates(manifest: &str) -> BTreeSet<String> {
    let manifest: toml::Table = manifest.parse().expect("Cargo.toml is TOML");
    let sections = ["dependencies", "dev-dependencies"].map(|name| manifest.get(name).and_then(toml::Value::as_table));
    sections.into_iter().flatten().flat_map(toml::Table::keys).map(|name| name.replace('-', "_")).collect()
}

pub(super) fn is_source(file: &File) -> bool {
    file.is_below(&["src"]) && file.path.ends_with(".rs")
}

#[test]
fn edges_point_one_way() {
    expect_none(&wrong_edges(&project(), MODULES));
}

#[test]
fn the_table_of_edges_has_no_cycle() {
    assert_eq!(upward_rows(MODULES), Vec::<String>::new());
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
            File::new("src/lane/vulkan/mod.rs", "mod gpu;\n#[cfg(test)]\nmod tests;\n"),
            File::new("src/lane/vulkan/tests.rs", "use crate::diagnostic::Diagnostic;"),
            File::new("src/lane/vulkan/gpu.rs", "use crate::diagnostic::Diagnostic;"),
        ];
        let faults = wrong_edges(&files, MODULES);
        assert_eq!(messages(&faults).len(), 1, "{:?}", messages(&faults));
        assert!(faults[0].to_string().contains("gpu.rs"));
    }

    fn edges(path: &str, text: &str) -> Vec<String> {
        let faults = wrong_edges(&[File::new(path, text)], MODULES);
        messages(&faults).into_iter().map(String::from).collect()
    }

    fn stray(path: &str, text: &str) -> Vec<String> {
        let crates = crates("[dependencies]\nnaga = '1'\nglam = '1'\n[dev-dependencies]\nglsl-lang = '1'\n");
        let faults = strays(&[File::new(path, text)], &crates);
        messages(&faults).into_iter().map(String::from).collect()
    }

    #[test]
    fn an_upward_import_is_reported() {
        assert_eq!(edges("src/text/edit.rs", "use crate::lint::Rule;"), ["`text` must not depend on `lint`"]);
    }

    #[test]
    fn an_upward_path_in_a_body_is_reported_at_its_line() {
        let faults = wrong_edges(&[File::new("src/lint/mod.rs", "fn f() {\n    crate::lane::all();\n}")], MODULES);
        assert_eq!(faults, [File::new("src/lint/mod.rs", "").fault(2, "`lint` must not depend on `lane`")]);
    }

    #[test]
    fn the_sides_of_a_comparison_do_not_know_each_other() {
        assert_eq!(edges("src/lane/mod.rs", "use crate::formula::Formula;"), ["`lane` must not depend on `formula`"]);
        assert_eq!(edges("src/formula/a.rs", "use crate::value::Batch;"), ["`formula` must not depend on `value`"]);
    }

    #[test]
    fn climbing_with_super_is_seen_through() {
        assert_eq!(
            edges("src/lint/glsl/rule.rs", "use super::super::super::lane::Lane;"),
            ["`lint` must not depend on `lane`"]
        );
        assert!(edges("src/lint/glsl/rule.rs", "use super::super::suppress::Line;").is_empty());
        assert!(edges("src/lint/mod.rs", "mod tests { use super::lane; }").is_empty());
        assert_eq!(edges("src/lint/mod.rs", "mod tests { use super::super::lane; }").len(), 1);
    }

    #[test]
    fn a_downward_import_is_fine() {
        assert!(edges("src/lint/mod.rs", "use crate::{glsl::Shader, lint::Rule, text};").is_empty());
    }

    #[test]
    fn test_code_may_look_sideways_and_never_up() {
        let planted = |other: &str| format!("#[cfg(test)]\nmod tests {{\n    use crate::{other};\n}}");
        assert!(edges("src/property/a.rs", &planted("formula")).is_empty());
        assert_eq!(edges("src/property/a.rs", &planted("verdict")), ["`property` must not depend on `verdict`"]);
    }

    #[test]
    fn a_module_without_a_row_is_reported() {
        assert_eq!(edges("src/extra/mod.rs", ""), ["the module `extra` is not in the table of dependencies"]);
    }

    #[test]
    fn a_row_that_points_upwards_is_reported() {
        assert_eq!(upward_rows(&[("a", &["b"]), ("b", &["a"])]), ["a names b"]);
    }

    #[test]
    fn wgpu_outside_of_its_lane_is_reported() {
        let message = "`wgpu` may be named in src/lane/vulkan alone";
        assert_eq!(stray("src/lane/mod.rs", "use wgpu;"), [message]);
        assert_eq!(stray("src/verdict/mod.rs", "fn f(d: &wgpu::Device) {}"), [message]);
        assert!(stray("src/lane/vulkan/mod.rs", "use wgpu::Device;").is_empty());
    }

    #[test]
    fn naga_in_the_linter_is_reported_in_tests_as_well() {
        assert_eq!(stray("src/lint/mod.rs", "#[cfg(test)] mod tests { use naga::Module; }").len(), 1);
    }

    #[test]
    fn file_access_is_reported_outside_of_tests() {
        assert_eq!(stray("src/report/mod.rs", "use std::{fmt, fs};").len(), 1);
        assert_eq!(stray("src/report/mod.rs", "fn f() { std::env::var(\"A\"); }").len(), 1);
        assert!(stray("src/report/mod.rs", "#[cfg(test)] mod tests { use std::fs; }").is_empty());
        assert!(stray("src/cli/lint.rs", "use std::fs;").is_empty());
    }

    #[test]
    fn leaving_the_process_is_reported() {
        assert_eq!(stray("src/cli/mod.rs", "fn f() { std::process::exit(1) }").len(), 1);
        assert!(stray("src/main.rs", "fn f() { std::process::exit(1) }").is_empty());
    }

    #[test]
    fn formulas_import_std_and_glam_alone() {
        let message = "`formula` imports std, glam, approx alone, not `glsl_lang`";
        assert_eq!(stray("src/formula/curve.rs", "use glam::DVec4;\nuse glsl_lang::ast;"), [message]);
    }
}
