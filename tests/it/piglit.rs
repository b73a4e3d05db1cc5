//! The conversion behind `cargo xtask piglit`, on tests of our own.

use lanes::vulkan;

#[path = "../../benches/piglit/mod.rs"]
pub(crate) mod converter;

use converter::convert::{Skipped, convert, tested};
use converter::format::{Section, ShaderTest};
use converter::judge::{Found, Runner, judge};

const VERTEX: &str = "\
[require]
GLSL >= 1.20

[vertex shader]
varying vec4 seen;
uniform vec2 a;
uniform bool twice;
uniform float tolerance;
uniform vec2 expected;
void main()
{
  gl_Position = gl_Vertex;
  vec2 result = twice ? 2.0 * abs(a) : abs(a);
  seen = distance(result, expected) <= tolerance ? vec4(0.0, 1.0, 0.0, 1.0) : vec4(1.0, 0.0, 0.0, 1.0);
}

[fragment shader]
varying vec4 seen;
void main()
{
  gl_FragColor = seen;
}

[test]
clear color 0.0 0.0 1.0 0.0
clear
uniform vec2 a -1.5 0x40000000
uniform int twice 0
uniform vec2 expected 1.5 2.0
uniform float tolerance 1e-05
draw rect ortho 0 0 4 4
uniform int twice 1 # the other way
uniform vec2 expected 3.0 4.0
draw rect ortho 4 0 4 4
probe rect rgba (0, 0, 4, 4) (0.0, 1.0, 0.0, 1.0)
probe rect rgba (4, 0, 4, 4) (0.0, 1.0, 0.0, 1.0)
";

const GEOMETRY: &str = "\
[require]
GLSL >= 1.50

[vertex shader]
in vec4 piglit_vertex;
out vec4 corner;
void main() { corner = piglit_vertex; }

[geometry shader]
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
in vec4 corner[3];
out vec4 seen;
uniform uint a;
uniform uint expected;
void main()
{
  for (int i = 0; i < 3; i++) {
    gl_Position = corner[i];
    seen = (a << 3u) == expected ? vec4(0.0, 1.0, 0.0, 1.0) : vec4(1.0, 0.0, 0.0, 1.0);
    EmitVertex();
  }
}

[fragment shader]
varying vec4 seen;
void main()
{
  gl_FragColor = seen;
}

[test]
uniform uint a 536870912
uniform uint expected 0
draw arrays GL_TRIANGLE_FAN 0 4
probe all rgba 0.0 1.0 0.0 1.0
uniform uint a 5u
uniform uint expected 40
draw arrays GL_TRIANGLE_FAN 0 4
probe rgba 1 0 0.0 1.0 0.0 1.0
";

const FRAGMENT: &str = "\
[require]
GLSL >= 1.10

[vertex shader]
void main() { gl_Position = gl_Vertex; }

[fragment shader]
uniform mat2 a;
uniform mat2 b;
void main()
{
  gl_FragColor = vec4(a == b, 0.0, 0.0, 0.0);
}

[test]
uniform mat2x2 a 1.0 2.0 3.0 4.0
uniform mat2x2 b 1.0 2.0 3.0 4.0
draw rect ortho 0 0 4 4
uniform mat2x2 b 1.0 3.0 2.0 4.0
draw rect ortho 4 0 4 4
probe rect rgba (0, 0, 4, 4) (1.0, 0.0, 0.0, 0.0)
probe rect rgba (4, 0, 4, 4) (0.0, 0.0, 0.0, 0.0)
";

const COMPUTE: &str = "\
[require]
GLSL >= 4.30

[compute shader]
writeonly uniform image2D tex;
layout(local_size_x = 4) in;
uniform int a;
uniform int expected;
void main()
{
  vec4 color = -a == expected ? vec4(0.0, 1.0, 0.0, 1.0) : vec4(1.0, 0.0, 0.0, 1.0);
  ivec2 coord = ivec2(gl_GlobalInvocationID.xy);
  imageStore(tex, coord, color);
}

[test]
texture rgbw 0 (4, 1) GL_RGBA8
uniform int a -7
uniform int expected 7
compute 1 1 1
probe rgb 0 0 0.0 1.0 0.0 1.0
";

/// What each runner says of a test.
fn found(text: &str) -> Vec<(Runner, Found)> {
    let lane = vulkan::open().expect("these tests need a Vulkan driver; `cargo xtask test` installs lavapipe");
    let test = ShaderTest::parse(text).unwrap();
    let converted = convert("own.shader_test", &test).unwrap_or_else(|skipped| panic!("{skipped:?}"));
    Runner::ALL.into_iter().filter_map(|r| Some((r, judge(&converted, r, Some(lane.as_ref()))?))).collect()
}

#[test]
fn tests_of_every_stage_agree_on_every_runner() {
    for (text, section, cases, runners) in [
        (VERTEX, Section::Vertex, 2, 4),
        (GEOMETRY, Section::Geometry, 2, 3),
        (FRAGMENT, Section::Fragment, 2, 3),
        (COMPUTE, Section::Compute, 1, 3),
    ] {
        let test = ShaderTest::parse(text).unwrap();
        assert_eq!((tested(&test), test.cases.len()), (Some(section), cases));
        let found = found(text);
        assert_eq!(found.len(), runners, "{found:?}");
        assert!(found.iter().all(|(_, f)| *f == Found::Agrees), "{section:?}: {found:?}");
    }
}

#[test]
fn a_wrong_expectation_is_a_disagreement_of_that_case_on_every_runner() {
    for (text, from, to, case) in [
        (VERTEX, "expected 3.0 4.0", "expected 3.0 4.0001", 1),
        (GEOMETRY, "expected 40", "expected 41", 1),
        (FRAGMENT, "b 1.0 3.0 2.0 4.0", "b 1.0 2.0 3.0 4.0", 1),
        (COMPUTE, "expected 7", "expected -7", 0),
    ] {
        assert!(text.contains(from));
        for (runner, found) in found(&text.replace(from, to)) {
            let Found::Disagrees(cases) = found else { panic!("{from} on {runner:?}: {found:?}") };
            assert_eq!(cases.iter().map(|(k, _)| *k).collect::<Vec<_>>(), [case], "{from} on {runner:?}");
        }
    }
}

#[test]
fn the_color_of_a_case_is_that_of_the_last_draw_over_its_place() {
    let over = "draw rect ortho 0 0 8 4\nprobe rect rgba (0, 0, 4, 4)";
    let test = ShaderTest::parse(&VERTEX.replacen("probe rect rgba (0, 0, 4, 4)", over, 1)).unwrap();
    assert_eq!(test.cases[0], test.cases[1]);
    assert_eq!(test.cases[0].uniforms["twice"].components, ["1"]);
}

#[test]
fn what_cannot_run_is_reported_and_what_is_not_understood_names_its_line() {
    let skipped = |text: &str| match convert("own.shader_test", &ShaderTest::parse(text).unwrap()) {
        Ok(_) => panic!("it runs"),
        Err(Skipped(why)) => why,
    };
    assert_eq!(skipped(&VERTEX.replace("uniform vec2 a -1.5 0x40000000", "uniform dvec2 a 1 2")), "numbers of 64 bits");
    assert_eq!(skipped(&VERTEX.replace("probe", "#")), "nothing is probed");
    assert!(
        skipped(&VERTEX.replace("uniform vec2 a -1.5 0x40000000", "uniform vec3 a 1 2 3"))
            .contains("`a` of type `vec2`")
    );
    let error = ShaderTest::parse(&VERTEX.replace("clear color", "blend color")).unwrap_err();
    assert!(format!("{error:#}").starts_with("line 25: `blend color 0.0"), "{error:#}");
}
