//! Other languages under the endings of GLSL.

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
