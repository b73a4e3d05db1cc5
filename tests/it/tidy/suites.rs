//! Every shader in `shaders` is judged by a suite, and every suite has its shader.

use std::collections::BTreeSet;

use super::{Fault, File, expect_none, messages, project};

const SHADERS: [&str; 6] = [".vert", ".geom", ".frag", ".comp", ".glsl", ".wgsl"];

/// Shaders that complete a program whose other stage is judged, each with its reason.
const COMPANIONS: &[(&str, &str)] = &[
    ("shaders/hair/hair.vert", "hands its input through to the geometry stage, which the suite `hair` judges"),
    ("shaders/hair/hair.frag", "shades what the geometry stage emits; a fragment stage writes no vertices"),
];

fn unmatched(files: &[File], companions: &[(&str, &str)]) -> Vec<Fault> {
    let below = || files.iter().filter(|file| file.is_below(&["shaders"]));
    let mut faults = Vec::new();
    let mut judged = BTreeSet::new();
    for suite in below().filter(|file| file.path.ends_with(".suite.toml")) {
        judged.extend(reference_of(suite));
        match shader_of(suite) {
            Ok(shader) if files.iter().any(|file| file.path == shader) => {
                judged.insert(shader);
            }
            Ok(shader) => faults.push(suite.fault(1, format!("its shader {shader} does not exist"))),
            Err(message) => faults.push(suite.fault(1, message)),
        }
    }
    let gone = |path: &str| below().next().is_some() && !files.iter().any(|file| file.path == path);
    let stale = companions.iter().filter(|(path, _)| gone(path));
    faults.extend(stale.map(|(path, _)| File::new(path, "").fault(1, "a companion that does not exist")));
    for shader in below().filter(|file| SHADERS.iter().any(|extension| file.path.ends_with(extension))) {
        let companion = companions.iter().any(|(path, _)| *path == shader.path);
        match (judged.contains(&shader.path), companion) {
            (false, false) => faults.push(shader.fault(1, "no suite judges this shader")),
            (true, true) => faults.push(shader.fault(1, "a companion that has a suite of its own")),
            (true, false) | (false, true) => {}
        }
    }
    faults
}

/// The path of the shader that a suite names, which is relative to the suite.
fn shader_of(suite: &File) -> Result<String, String> {
    let table: toml::Table = suite.text.parse().map_err(|error: toml::de::Error| error.message().to_owned())?;
    let shader = table.get("shader").and_then(toml::Value::as_str).ok_or("it has no key `shader`")?;
    let folder = suite.path.rsplit_once('/').map_or("", |(folder, _)| folder);
    Ok(format!("{folder}/{shader}"))
}

/// The path of the shader that says what is right, where a suite names one.
fn reference_of(suite: &File) -> Option<String> {
    let table: toml::Table = suite.text.parse().ok()?;
    let reference = table.get("reference")?;
    let file = reference.as_str().or_else(|| reference.get("file")?.as_str())?;
    let folder = suite.path.rsplit_once('/').map_or("", |(folder, _)| folder);
    Some(format!("{folder}/{file}"))
}

#[test]
fn every_shader_has_a_suite_and_every_suite_a_shader() {
    expect_none(&unmatched(&project(), COMPANIONS));
}

#[cfg(test)]
mod planted {
    use super::*;

    fn said(files: &[(&str, &str)], companions: &[(&str, &str)]) -> Vec<String> {
        let files: Vec<File> = files.iter().map(|(path, text)| File::new(path, text)).collect();
        messages(&unmatched(&files, companions)).into_iter().map(String::from).collect()
    }

    const SUITE: (&str, &str) = ("shaders/a/sphere.suite.toml", "shader = 'sphere.vert'");

    #[test]
    fn a_pair_is_fine_and_so_is_a_companion() {
        let files = [SUITE, ("shaders/a/sphere.vert", ""), ("shaders/a/sphere.frag", ""), ("shaders/a/host.cpp", "")];
        assert!(said(&files, &[("shaders/a/sphere.frag", "no vertices")]).is_empty());
    }

    #[test]
    fn a_shader_without_a_suite_is_reported() {
        let files = [SUITE, ("shaders/a/sphere.vert", ""), ("shaders/b/sphere.vert", "")];
        assert_eq!(said(&files, &[]), ["no suite judges this shader"]);
    }

    #[test]
    fn a_suite_without_a_shader_is_reported() {
        assert_eq!(said(&[SUITE], &[]), ["its shader shaders/a/sphere.vert does not exist"]);
        assert_eq!(said(&[(SUITE.0, "stage = 'vertex'")], &[]), ["it has no key `shader`"]);
        assert_eq!(said(&[(SUITE.0, "shader = ")], &[]).len(), 1);
    }

    #[test]
    fn a_companion_with_a_suite_is_reported() {
        let files = [SUITE, ("shaders/a/sphere.vert", "")];
        assert_eq!(said(&files, &[("shaders/a/sphere.vert", "")]), ["a companion that has a suite of its own"]);
    }

    #[test]
    fn a_companion_that_does_not_exist_is_reported() {
        let files = [SUITE, ("shaders/a/sphere.vert", "")];
        assert_eq!(said(&files, &[("shaders/a/gone.vert", "")]), ["a companion that does not exist"]);
    }
}
