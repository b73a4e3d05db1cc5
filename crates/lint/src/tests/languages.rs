//! Other languages under the endings of GLSL.

use base::diagnostic::Severity;
use base::text::SourceFile;

use crate::Input;

fn input(name: &str, text: &str) -> Input {
    Input::new(SourceFile::new(name, text))
}

#[test]
fn another_language_under_a_shared_ending_is_left_alone() {
    let lint = |name: &str, text: &str| crate::run(&[input(name, text)]);
    assert!(lint("a.vp", "!!ARBvp1.0\nMOV result.position, vertex.position;\nEND\n").is_empty());
    assert!(lint("b.eval", "step 1: evaluate the model\n").is_empty());
    let hlsl = "[numthreads(8, 1, 1)]\nvoid main(uint3 id : SV_DispatchThreadID) { }\n";
    assert!(lint("shaders/hlsl/a.comp", hlsl).is_empty());
    // Who names a file by itself is told what it is.
    assert!(lint("shaders/a.comp", hlsl).is_empty());
    assert_eq!(crate::run(&[input("shaders/a.comp", hlsl).named()]).len(), 1);
    assert_eq!(lint("shaders/hlsl/a.frag", "#version 330\nvoid main() { vec2 a = vec3(1.0); }\n").len(), 1);
    assert_eq!(lint("a.vp", "#version 330\nvoid main() { gl_Position = vec3(1.0); }\n").len(), 1);
    assert_eq!(lint("a.fp", "void main() { gl_FragColor = vec3(1.0); }\n").len(), 1);
}

#[test]
fn a_stage_of_ray_tracing_is_given_its_ray_and_what_it_hit() {
    let text = |read: &str| {
        format!(
            "#version 460\n#extension GL_EXT_ray_tracing : require\nlayout(location = 0) rayPayloadInEXT vec3 color;\n\
             hitAttributeEXT vec2 at;\nvoid main() {{\n  float own;\n  int first = 3 * gl_PrimitiveID;\n\
             color = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT + vec3({read}, first);\n}}\n"
        )
    };
    let codes = |text: &str| -> Vec<&str> {
        let found = crate::run(&[input("a.rchit", text)]);
        found.iter().filter(|d| d.severity != Severity::Info).map(|d| d.code.0).collect()
    };
    assert!(codes(&text("at")).is_empty(), "{:?}", codes(&text("at")));
    assert_eq!(codes(&text("own, at").replace(", first)", ")")), ["D001"]);
}
