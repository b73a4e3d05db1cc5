//! What cargo refuses only when a crate is published, or what would then be wrong for everybody who takes it.

use std::path::Path;

use super::{Fault, File, expect_none, file, messages, project};

/// What stands for the owner of the project until there is one.
const UNKNOWN: &str = "OWNER";

/// Files that speak of the stand-in itself: the task that replaces it, and this one.
const ABOUT: [&str; 2] = ["xtask/src/repository.rs", "tests/it/tidy/publish.rs"];

fn manifest(file: &File) -> toml::Table {
    file.text.parse().expect("Cargo.toml is TOML")
}

/// Manifests of what is published: the program, and each crate beside it.
fn published(files: &[File]) -> Vec<&File> {
    let wanted = |path: &str| path == "Cargo.toml" || (path.starts_with("crates/") && path.ends_with("/Cargo.toml"));
    files.iter().filter(|file| wanted(&file.path)).collect()
}

/// Crates of the workspace without the version that a registry finds them by, and manifests that lack a key.
fn incomplete(files: &[File]) -> Vec<Fault> {
    let root = file(files, "Cargo.toml");
    let workspace = manifest(root)["workspace"].clone();
    let version = &workspace["package"]["version"];
    let mut faults = Vec::new();
    for (name, value) in workspace["dependencies"].as_table().expect("a table") {
        let below = value.get("path").and_then(toml::Value::as_str);
        // What is not published has no version: cargo leaves it out of the manifest of a test dependency.
        if below.is_some_and(|path| path.starts_with("crates/")) && value.get("version") != Some(version) {
            faults.push(root.fault(1, format!("`{name}` has a path and not the version {version}")));
        }
    }
    for file in published(files) {
        let package = manifest(file)["package"].clone();
        for key in ["description", "license", "repository", "homepage"] {
            if package.get(key).is_none() {
                faults.push(file.fault(1, format!("there is no `{key}`")));
            }
        }
    }
    faults
}

/// Texts that a crate takes from outside of its folder: its package does not have them.
fn outside(file: &File) -> Vec<Fault> {
    let Some(depth) = depth(&file.path) else { return Vec::new() };
    let mut faults = Vec::new();
    for (at, line) in file.text.lines().enumerate() {
        for call in line.split("include_").skip(1).filter(|rest| rest.starts_with("str!") || rest.starts_with("bytes!"))
        {
            let text = call.split('"').nth(1).unwrap_or_default();
            if text.split('/').take_while(|part| *part == "..").count() > depth {
                faults.push(file.fault(at + 1, format!("`{text}` is not in the package of the crate")));
            }
        }
    }
    faults
}

/// Folders between a file of the program or of a crate and the root of its package; nothing for other files and for tests.
fn depth(path: &str) -> Option<usize> {
    let inside = match path.strip_prefix("crates/") {
        Some(rest) => rest.split_once('/')?.1,
        None => path,
    };
    let is_test = inside.contains("/tests") || inside.ends_with("testing.rs");
    (inside.starts_with("src/") && inside.ends_with(".rs") && !is_test).then(|| inside.matches('/').count())
}

/// Other addresses of the project than Cargo.toml has, and places that name nobody.
fn addresses(files: &[File]) -> Vec<Fault> {
    let root = manifest(file(files, "Cargo.toml"));
    let address = |key: &str| root["workspace"]["package"][key].as_str().unwrap_or_default().to_owned();
    let slug = address("repository").replace("https://github.com/", "");
    let name = slug.rsplit('/').next().unwrap_or_default().to_owned();
    let mut faults = Vec::new();
    if address("homepage") != address("repository") {
        faults.push(file(files, "Cargo.toml").fault(1, "`homepage` and `repository` differ"));
    }
    for file in files.iter().filter(|file| !ABOUT.contains(&file.path.as_str())) {
        for (at, line) in file.text.lines().enumerate() {
            let mut rest = line.replace(&slug, "");
            if let Some(other) = rest.split("github.com/").skip(1).find(|r| r.split('/').nth(1) == Some(name.as_str()))
            {
                faults.push(file.fault(at + 1, format!("`github.com/{other}` is not `github.com/{slug}`")));
                rest.clear();
            }
            if rest.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == UNKNOWN) {
                faults.push(file.fault(at + 1, format!("`{UNKNOWN}` is not part of `{slug}`")));
            }
        }
    }
    faults
}

#[test]
fn every_crate_says_what_a_registry_asks_for() {
    let files = project();
    assert!(published(&files).len() > 15);
    expect_none(&incomplete(&files));
}

#[test]
fn crates_take_their_texts_from_their_own_folder() {
    let files = project();
    expect_none(&files.iter().flat_map(outside).collect::<Vec<_>>());
    // The links that put the others into the packages.
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for link in ["crates/chapter/shaders/expectations.toml", "crates/refdata/refdata.schema.json"] {
        assert!(cfg!(windows) || root.join(link).is_file(), "{link}");
    }
}

#[test]
fn the_address_of_the_project_is_the_same_everywhere() {
    expect_none(&addresses(&project()));
}

#[cfg(test)]
mod planted {
    use super::*;

    const ROOT: &str = "[workspace.package]\nversion = \"1.0.0\"\nrepository = \"https://github.com/acme/tool\"\n\
        homepage = \"https://github.com/acme/tool\"\n[workspace.dependencies]\n\
        a = { path = \"crates/a\", version = \"1.0.0\" }\nb = { path = \"crates/b\" }\n\
        [package]\ndescription = \"d\"\nlicense.workspace = true\nrepository.workspace = true\nhomepage.workspace = true\n";

    #[test]
    fn a_path_without_a_version_and_a_key_that_is_missing_are_reported() {
        let other =
            File::new("crates/a/Cargo.toml", "[package]\ndescription = \"d\"\nlicense = \"x\"\nhomepage = \"y\"\n");
        let faults = incomplete(&[File::new("Cargo.toml", ROOT), other]);
        assert_eq!(messages(&faults), ["`b` has a path and not the version \"1.0.0\"", "there is no `repository`"]);
    }

    #[test]
    fn a_text_from_outside_of_the_package_is_reported() {
        let line = "include_str!(\"../../x.md\")\n";
        assert_eq!(outside(&File::new("crates/a/src/lib.rs", line)).len(), 1);
        assert!(outside(&File::new("crates/a/src/b/mod.rs", line)).is_empty());
        assert!(outside(&File::new("crates/a/src/tests.rs", line)).is_empty());
    }

    #[test]
    fn another_address_and_a_stand_in_are_reported() {
        let of = |text: &str| addresses(&[File::new("Cargo.toml", ROOT), File::new("a.md", text)]).len();
        assert_eq!(of("uses: acme/tool@v1, https://github.com/acme/tool/releases\n"), 0);
        assert_eq!(of("https://github.com/other/tool\n"), 1);
        assert_eq!(of("https://github.com/OWNER/tool\n"), 1);
        assert_eq!(of("uses: OWNER/tool@v1\n"), 1);
        assert_eq!(of("https://github.com/other/library, CODEOWNERS, SET_OWNER\n"), 0);
    }
}
