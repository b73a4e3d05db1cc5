//! The packages that a program is made of, from `cargo metadata`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::cargo::cargo;

/// A package of the program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Package {
    pub name: String,
    pub version: String,
    /// Expression in SPDX; none where only a file says it.
    pub licence: Option<String>,
    pub repository: Option<String>,
    pub authors: Vec<String>,
    /// The folder of its manifest.
    pub folder: PathBuf,
    /// SHA-256 of its archive in the registry; none for members of the workspace.
    pub checksum: Option<String>,
    /// Keys of what it needs.
    pub needs: BTreeSet<String>,
}

impl Package {
    /// Address in the form of package URLs.
    pub fn url(&self) -> String {
        format!("pkg:cargo/{}@{}", self.name, self.version)
    }
}

/// All packages that are part of the program on a platform, by their addresses; development and build dependencies are not.
/// The program itself is `pkg:cargo/shadercheck@…`.
pub fn packages(workspace: &Path, features: &[&str], target: &str) -> Result<BTreeMap<String, Package>> {
    let mut command = cargo(["metadata", "--format-version", "1", "--locked", "--filter-platform", target]);
    command.arg("--manifest-path").arg(workspace.join("Cargo.toml")).args(features);
    let output = command.output().context("cannot start cargo")?;
    ensure!(output.status.success(), "`cargo metadata` failed: {}", String::from_utf8_lossy(&output.stderr).trim());
    let lock = std::fs::read_to_string(workspace.join("Cargo.lock")).context("cannot read Cargo.lock")?;
    of(&serde_json::from_slice(&output.stdout)?, &checksums(&lock))
}

/// SHA-256 of archives in a lock file, by name and version.
fn checksums(lock: &str) -> BTreeMap<(String, String), String> {
    let entry = |text: &str| {
        let value = |key: &str| {
            let (_, rest) = text.split_once(&format!("\n{key} = \""))?;
            Some(rest.split_once('"')?.0.to_owned())
        };
        Some(((value("name")?, value("version")?), value("checksum")?))
    };
    lock.split("[[package]]").filter_map(entry).collect()
}

fn of(metadata: &Value, checksums: &BTreeMap<(String, String), String>) -> Result<BTreeMap<String, Package>> {
    let text = |value: &Value| value.as_str().map(str::to_owned);
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let mut known: BTreeMap<String, Package> = BTreeMap::new();
    for package in list(&metadata["packages"]) {
        let (name, version) = (text(&package["name"]).context("name")?, text(&package["version"]).context("version")?);
        let manifest = PathBuf::from(text(&package["manifest_path"]).context("manifest_path")?);
        let found = Package {
            checksum: checksums.get(&(name.clone(), version.clone())).cloned(),
            licence: text(&package["license"]),
            repository: text(&package["repository"]),
            authors: list(&package["authors"]).iter().filter_map(text).collect(),
            folder: manifest.parent().unwrap_or(Path::new("")).to_owned(),
            needs: BTreeSet::new(),
            name,
            version,
        };
        known.insert(text(&package["id"]).context("id")?, found);
    }
    let mut needs: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for node in list(&metadata["resolve"]["nodes"]) {
        let normal = |dep: &&Value| list(&dep["dep_kinds"]).iter().any(|kind| kind["kind"].is_null());
        let deps = list(&node["deps"]);
        let ids = deps.iter().filter(normal).filter_map(|dep| text(&dep["pkg"]));
        needs.insert(text(&node["id"]).context("id")?, ids.collect());
    }
    let root = known.iter().find(|(_, package)| package.name == "shadercheck").map(|(id, _)| id.clone());
    let (mut open, mut seen) = (vec![root.context("there is no package `shadercheck`")?], BTreeSet::new());
    while let Some(id) = open.pop() {
        if seen.insert(id.clone()) {
            open.extend(needs.get(&id).into_iter().flatten().cloned());
        }
    }
    let mut found = BTreeMap::new();
    for id in &seen {
        let mut package = known.get(id).with_context(|| format!("`{id}` is no package"))?.clone();
        let urls = needs.get(id).into_iter().flatten().filter_map(|need| known.get(need).map(Package::url));
        package.needs = urls.collect();
        found.insert(package.url(), package);
    }
    Ok(found)
}

#[cfg(test)]
pub mod tests {
    use serde_json::json;

    use super::*;

    /// The program with a library that another one needs, and what tests alone need.
    pub fn sample() -> BTreeMap<String, Package> {
        let package = |name: &str, licence: Value| {
            json!({
                "id": name, "name": name, "version": "1.0.0", "license": licence, "authors": ["A. Author"],
                "manifest_path": format!("/registry/{name}/Cargo.toml"), "repository": null,
            })
        };
        let dep = |name: &str, kind: Value| json!({ "pkg": name, "dep_kinds": [{ "kind": kind }] });
        let metadata = json!({
            "packages": [
                package("shadercheck", "MIT OR Apache-2.0".into()), package("near", "MIT".into()),
                package("far", Value::Null), package("test", "MIT".into()), package("build", "MIT".into()),
            ],
            "resolve": { "nodes": [
                { "id": "shadercheck", "deps": [dep("near", Value::Null), dep("test", "dev".into()), dep("build", "build".into())] },
                { "id": "near", "deps": [dep("far", Value::Null)] },
                { "id": "far", "deps": [] }, { "id": "test", "deps": [] }, { "id": "build", "deps": [] },
            ] },
        });
        let lock = "[[package]]\nname = \"near\"\nversion = \"1.0.0\"\nsource = \"r\"\nchecksum = \"abc\"\n";
        of(&metadata, &checksums(lock)).unwrap()
    }

    #[test]
    fn what_is_part_of_the_program_is_found_and_nothing_else() {
        let found = sample();
        let names: Vec<&str> = found.values().map(|package| package.name.as_str()).collect();
        assert_eq!(names, ["far", "near", "shadercheck"]);
        assert_eq!(found["pkg:cargo/near@1.0.0"].checksum.as_deref(), Some("abc"));
        assert_eq!(found["pkg:cargo/far@1.0.0"].checksum, None);
        let needs: Vec<&String> = found["pkg:cargo/shadercheck@1.0.0"].needs.iter().collect();
        assert_eq!(needs[0], "pkg:cargo/build@1.0.0".replace("build", "near").as_str());
        assert_eq!(needs.len(), 1);
    }
}
