//! The suites that ship, as the engine reads them.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use base::text::SourceFile;
use base::value::{Field, Record, Shape};
use engine::suite::{find, load_all, parse, shipped};
use judge::formula::{Formula, Kind, Param};
use property::shrink::Domain;

use crate::formula;

/// Suite files below `shaders/`, relative to it.
fn on_disk(folder: &Path, root: &Path, found: &mut Vec<String>) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            on_disk(&path, root, found);
        } else if path.to_str().is_some_and(|p| p.ends_with(".suite.toml")) {
            let relative = path.strip_prefix(root).unwrap();
            found.push(relative.to_str().unwrap().replace('\\', "/"));
        }
    }
}

#[test]
fn the_shipped_suites_are_those_below_shaders() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders");
    let mut disk = Vec::new();
    on_disk(&root, &root, &mut disk);
    // Kernels are content of their own, which is run by its folder.
    disk.retain(|path| !path.starts_with("kernels/"));
    disk.sort_unstable();
    let mut embedded: Vec<&str> = shipped().map(|s| s.path).collect();
    embedded.sort_unstable();
    assert_eq!(embedded, disk);
    for suite in shipped() {
        assert_eq!(fs::read_to_string(root.join(suite.path)).unwrap(), suite.toml);
    }
}

#[test]
fn every_shipped_suite_is_sound_and_names_its_own_shader() {
    for shipped in shipped() {
        let suite = parse(&SourceFile::new(shipped.path, shipped.toml)).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((suite.name.as_str(), suite.shader.as_str()), (shipped.name, shipped.shader_name));
        assert!(!shipped.shader_text.is_empty());
        assert_eq!(find(shipped.name), Ok(shipped));
    }
}

/// All inputs of a formula as inputs of an invocation.
fn inputs_of(formula: &Formula) -> Arc<Record> {
    let field = |p: &Param| {
        let shape = match p.kind {
            Kind::Float => Shape::FLOAT,
            Kind::Int => Shape::INT,
            Kind::Vec2 => Shape::VEC2,
            Kind::Vec3 => Shape::VEC3,
            Kind::Vec4 => Shape::VEC4,
            Kind::Mat4 => Shape::MAT4,
        };
        Field { name: p.name.into(), shape: p.array.map_or(shape, |len| shape.array_of(len as u32)) }
    };
    Arc::new(Record::new(formula.inputs.iter().map(field).collect()))
}

#[test]
fn every_shipped_suite_fills_the_inputs_of_its_formula() {
    for shipped in shipped() {
        let suite = parse(&SourceFile::new(shipped.path, shipped.toml)).unwrap();
        let formula = formula::by_name(suite.expect.formula().unwrap()).unwrap();
        let plan = suite.plan(&inputs_of(formula), &Arc::default()).unwrap_or_else(|e| panic!("{e}"));
        for invocation in 0..64 {
            let sample = plan.sample(1, 0, invocation);
            assert!(plan.admits(&sample), "{}: {sample:?}", shipped.name);
            assert!(plan.admits(&plan.simplest(&sample)));
        }
    }
}

#[test]
fn a_shipped_suite_is_found_by_name_and_guessed_from_a_slip() {
    assert_eq!(find("sphere").unwrap().shader_name, "sphere.vert");
    assert_eq!(find("sphera").unwrap_err().to_string(), "there is no suite `sphera`; did you mean `sphere`?");
    assert_eq!(find("catmul_rom").unwrap_err().suggestion, Some("catmull_rom"));
}

#[test]
fn a_suite_on_disk_is_read_with_its_shader() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders/chapter9/sphere.suite.toml");
    let loaded = load_all(&root).unwrap().remove(0);
    assert_eq!(loaded.shader.text(), find("sphere").unwrap().shader_text);
    let folder = tempfile::tempdir().unwrap();
    let alone = folder.path().join("sphere.suite.toml");
    fs::write(&alone, find("sphere").unwrap().toml).unwrap();
    let error = load_all(&alone).unwrap_err().to_string();
    assert!(error.contains("sphere.suite.toml:3:11: cannot read the shader `"), "{error}");
}

#[test]
fn an_unknown_suite_is_refused() {
    let error = find("no_such_suite_at_all").unwrap_err();
    assert!(error.to_string().starts_with("there is no suite `no_such_suite_at_all`"));
}
