//! The papers of a package: the bill of materials, and the licences of third parties.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use anyhow::{Result, ensure};
use serde_json::{Value, json};

use super::metadata::Package;

/// The bill of materials: CycloneDX 1.5 as JSON, <https://cyclonedx.org/docs/1.5/json/>.
pub fn bill(packages: &BTreeMap<String, Package>) -> Value {
    let component = |package: &Package, kind: &str| {
        let mut component = json!({
            "type": kind,
            "bom-ref": package.url(),
            "name": package.name,
            "version": package.version,
            "purl": package.url(),
        });
        if let Some(licence) = &package.licence {
            component["licenses"] = json!([{ "expression": expression(licence) }]);
        }
        if let Some(checksum) = &package.checksum {
            component["hashes"] = json!([{ "alg": "SHA-256", "content": checksum }]);
        }
        if let Some(repository) = &package.repository {
            component["externalReferences"] = json!([{ "type": "vcs", "url": repository }]);
        }
        component
    };
    let program = packages.values().find(|package| package.name == "shadercheck");
    let libraries = packages.values().filter(|package| package.name != "shadercheck");
    json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": { "component": program.map(|program| component(program, "application")) },
        "components": libraries.map(|package| component(package, "library")).collect::<Vec<_>>(),
        "dependencies": packages.iter().map(|(url, package)| json!({ "ref": url, "dependsOn": package.needs })).collect::<Vec<_>>(),
    })
}

/// An expression as SPDX has it; older packages separate choices by `/`.
fn expression(licence: &str) -> String {
    licence.split('/').map(str::trim).collect::<Vec<_>>().join(" OR ")
}

/// The licences of third parties: a list of all packages, and each text once.
///
/// # Errors
/// When a package has neither an expression nor a text.
pub fn licences(packages: &BTreeMap<String, Package>) -> Result<String> {
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut list = String::new();
    // Members of the workspace are under the licence of the project.
    let others = packages.values().filter(|package| !package.name.starts_with("shadercheck"));
    for package in others {
        let name = format!("{} {}", package.name, package.version);
        let found = of_folder(&package.folder);
        let licence = package.licence.as_deref().map_or("see its text".to_owned(), expression);
        ensure!(package.licence.is_some() || !found.is_empty(), "{name} names no licence and holds none");
        let missing = if found.is_empty() { "; its archive holds no text" } else { "" };
        let address = package.repository.as_ref().map_or(String::new(), |address| format!(", <{address}>"));
        let _ = writeln!(list, "- {name}: {licence}{missing}{address}");
        if found.is_empty() && !package.authors.is_empty() {
            let _ = writeln!(list, "  by {}", package.authors.join(", "));
        }
        for text in found {
            texts.entry(text).or_default().push(name.clone());
        }
    }
    let mut page = format!(
        "# Licences of third parties\n\nshadercheck is under MIT or Apache-2.0. The program contains these libraries:\n\n{list}"
    );
    for (text, of) in texts {
        let _ = write!(page, "\n## {}\n\n```text\n{}\n```\n", of.join(", "), text.trim_end().replace("```", "'''"));
    }
    Ok(page)
}

/// Texts of licences and notices in a folder.
fn of_folder(folder: &Path) -> Vec<String> {
    let named = |name: &str| {
        let name = name.to_uppercase();
        ["LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE"].iter().any(|start| name.starts_with(start))
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<_> = entries
        .filter(|entry| named(&entry.file_name().to_string_lossy()) && entry.path().is_file())
        .map(|entry| entry.path())
        .collect();
    files.sort();
    let texts = files.iter().filter_map(|file| std::fs::read(file).ok());
    texts.map(|text| String::from_utf8_lossy(&text).replace("\r\n", "\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::super::metadata::tests::sample;
    use super::*;

    #[test]
    fn the_bill_names_the_program_its_libraries_and_what_needs_what() {
        let bill = bill(&sample());
        assert_eq!((&bill["bomFormat"], &bill["specVersion"]), (&"CycloneDX".into(), &"1.5".into()));
        assert_eq!(bill["metadata"]["component"]["purl"], "pkg:cargo/shadercheck@1.0.0");
        let names: Vec<&Value> = bill["components"].as_array().unwrap().iter().map(|c| &c["name"]).collect();
        assert_eq!(names, ["far", "near"]);
        assert_eq!(bill["components"][1]["hashes"][0]["content"], "abc");
        // Each reference is that of a component.
        let references: Vec<&str> =
            bill["dependencies"].as_array().unwrap().iter().map(|d| d["ref"].as_str().unwrap()).collect();
        for need in bill["dependencies"].as_array().unwrap().iter().flat_map(|d| d["dependsOn"].as_array().unwrap()) {
            assert!(references.contains(&need.as_str().unwrap()), "{need}");
        }
    }

    #[test]
    fn a_package_without_any_licence_is_refused_and_equal_texts_come_once() {
        let mut packages = sample();
        let error = licences(&packages).unwrap_err().to_string();
        assert_eq!(error, "far 1.0.0 names no licence and holds none");
        let folder = std::env::temp_dir().join(format!("shadercheck-licences-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("LICENSE-MIT"), "Permission is hereby granted\r\n").unwrap();
        packages.values_mut().for_each(|package| package.folder.clone_from(&folder));
        let page = licences(&packages).unwrap();
        std::fs::remove_dir_all(folder).unwrap();
        assert!(page.contains("- near 1.0.0: MIT\n") && page.contains("- far 1.0.0: see its text\n"), "{page}");
        assert_eq!(page.matches("Permission is hereby granted\n").count(), 1, "{page}");
        assert!(page.contains("\n## far 1.0.0, near 1.0.0\n") && !page.contains("- shadercheck"), "{page}");
    }

    #[test]
    fn old_expressions_are_written_as_today() {
        assert_eq!(expression("MIT/Apache-2.0"), "MIT OR Apache-2.0");
        assert_eq!(expression("Apache-2.0 / MIT"), "Apache-2.0 OR MIT");
    }
}
