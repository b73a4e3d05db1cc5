//! Texts in GLSL that lack declarations, on the command line.

use std::fs;

use crate::binary::{Ran, run_in};

fn fuzz(name: &str, text: &str, arguments: &str) -> Ran {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(name), text).unwrap();
    run_in(folder.path(), &format!("fuzz {name} --lane embedded --samples 4096 {arguments}"))
}

/// A piece of a shader. Its engine declares the camera, the light and a function, in a file that is not there.
const PIECE: &str = "#include \"engine/light.glsl\"\n\
    vec3 shade(vec3 n, float roughness) {\n\
    float d = max(dot(n, sun.direction), 0.0);\n\
    vec3 half_way = normalize(sun.direction + camera.direction);\n\
    return fresnel(half_way).rgb * d / (PI * roughness);\n}\n";

#[test]
fn a_piece_is_run_with_inputs_for_what_it_lacks() {
    let ran = fuzz("piece.glsl", PIECE, "");
    assert!(ran.err.contains("not found, and left out: `#include \"engine/light.glsl\"`"), "{ran:?}");
    assert!(ran.err.contains("`fresnel` as a function that gives `vec3`"), "{ran:?}");
    assert!(ran.err.contains("assumed --define PI=3.14159265358979"), "{ran:?}");
    // The fault is told at its place in the file; what was made up is not tested.
    assert!(ran.out.contains("piece.glsl:4:17: `normalize(sun.direction + camera.direction)`"), "{ran:?}");
    assert!(ran.out.contains("1 function run, 0 not run"), "{ran:?}");
    assert!(!ran.out.contains("does not compile"), "{ran:?}");
    // The repaired twin.
    let right = PIECE.replace("normalize(sun.direction + camera.direction)", "sun.direction + camera.direction");
    let ran = fuzz("piece.glsl", &right, "");
    assert!(!ran.out.contains("piece.glsl:4:"), "{ran:?}");
}

#[test]
fn a_whole_shader_is_run_and_its_names_are_errors() {
    let text =
        "#version 330 core\nin vec3 n;\nout vec4 color;\nvoid main() { color = vec4(normalize(n) * tint, 1.0); }\n";
    let ran = fuzz("whole.frag", text, "").expect(1);
    assert!(ran.out.contains("error[E020]: `tint` is not declared"), "{ran:?}");
    assert!(ran.out.contains("`normalize(n)`: `color.x` has no value"), "{ran:?}");
    assert!(ran.out.contains("1 function run, 0 not run"), "{ran:?}");
    assert!(ran.out.contains("1 file does not compile"), "{ran:?}");
}

#[test]
fn what_is_wrong_otherwise_is_told_and_not_run() {
    let ran = fuzz("piece.glsl", &PIECE.replace("roughness);\n}", "roughness) * mat2(1.0);\n}"), "").expect(1);
    assert!(ran.out.contains("0 functions run, 0 not run"), "{ran:?}");
}
