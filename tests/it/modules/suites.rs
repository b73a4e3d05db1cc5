//! The chapter's shaders in WGSL, judged by the formulas that judge those in GLSL.

use std::fs;

use super::{folder, languages};
use crate::binary::{root, run, run_in};

/// Names of the copies.
pub(super) const COPIES: [&str; 14] = [
    "bone_weight",
    "cardinal",
    "catmull_rom",
    "cylinder",
    "hair",
    "hermite",
    "joints",
    "kochanek_bartels",
    "morph",
    "morph_targets",
    "segment_distance",
    "skinning",
    "sphere",
    "two_bones",
];

#[test]
fn every_copy_passes() {
    let ran = run(&format!("check {} --quick --lane embedded --format json", languages().display()));
    let ran = ran.expect(0).json();
    let suites = ran["suites"].as_array().unwrap();
    let names: Vec<&str> = suites.iter().map(|suite| suite["suite"].as_str().unwrap()).collect();
    let wanted: Vec<String> = COPIES.iter().map(|name| format!("{name}_wgsl")).collect();
    assert_eq!(names, wanted);
}

#[test]
fn a_fault_in_a_copy_is_found_at_its_line() {
    let text = |name: &str| fs::read_to_string(root().join(languages()).join(name)).unwrap();
    let shader = text("sphere.wgsl").replace("r * sin(th), 1.0)", "r * cos(th), 1.0)");
    let folder =
        folder(&[("sphere.wgsl", shader.as_bytes()), ("sphere.suite.toml", text("sphere.suite.toml").as_bytes())]);
    let ran = run_in(folder.path(), "check . --quick --lane embedded").expect(1);
    assert!(ran.out.contains("sphere_wgsl") && ran.out.contains("deviates from its formula"), "{}", ran.out);
}

#[test]
fn mutants_of_copies_are_killed() {
    for name in ["sphere", "segment_distance", "two_bones"] {
        let path = languages().join(format!("{name}.suite.toml"));
        let ran = run(&format!("mutate {} --lane embedded --samples 8192 --format json", path.display())).json();
        let score = &ran["score"];
        assert!(score["killed"].as_u64().unwrap() > 10, "{name}: {score}");
        assert_eq!(score["survived"].as_u64(), Some(0), "{name}: {ran:#}");
    }
}
