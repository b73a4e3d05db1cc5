//! What is not interpreted is refused by name and place.

use super::super::InterpError;
use super::support::{compile, entry_point, wgsl};

fn refused(text: &str) -> (String, String) {
    let (module, info) = wgsl(text);
    match entry_point((&module, &info), &[], &[]) {
        Err(InterpError::Unsupported { what, span }) => {
            (what, span.to_range().map(|range| text[range].to_owned()).unwrap_or_default())
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn constructs_of_other_stages_and_of_workgroups_are_named() {
    for (text, what, at) in [
        (
            "@group(0) @binding(0) var t: texture_2d<f32>; @compute @workgroup_size(1) fn main() { var x = textureLoad(t, vec2(0), 0); }",
            "`t`, to which nothing is bound,",
            "textureLoad",
        ),
        ("@compute @workgroup_size(1) fn main() { workgroupBarrier(); }", "barriers", "workgroupBarrier"),
        (
            "var<workgroup> w: array<f32, 4>; @compute @workgroup_size(1) fn main() { w[0] = 1.0; }",
            "shared variable `w`",
            "w",
        ),
        (
            "@group(0) @binding(0) var<storage, read_write> s: array<f32>; @compute @workgroup_size(1) fn main() { s[0] = 1.0; }",
            "storage buffer `s`",
            "s",
        ),
        ("@fragment fn main() { var x = dpdx(1.0 * f32(3)); }", "derivatives between fragments", "dpdx"),
        ("@compute @workgroup_size(1) fn main() { var x = subgroupAdd(1u); }", "subgroup operations", "subgroupAdd"),
    ] {
        let (found, place) = refused(text);
        assert_eq!(found, what);
        assert!(place.contains(at), "{what}: `{place}`");
    }
}

#[test]
fn wide_numbers_are_named() {
    let error = compile(&wgsl("fn f(x: f32) -> f64 { return f64(x); }")).unwrap_err();
    assert_eq!(error.to_string(), "not interpreted: 64-bit floats");
}
