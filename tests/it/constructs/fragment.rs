//! Textures, `discard` and derivatives: what a fragment stage has beside the others.

use program::Program;

use super::{built, expect, outputs};

/// A channel of a texel of the program's k-th texture.
fn texel(program: &Program, k: usize, at: [u32; 3], channel: usize) -> f64 {
    let image = &program.textures[k].contents;
    let [width, height, _] = image.size();
    let index = (at[2] * height + at[1]) * width + at[0];
    f64::from(f32::from_bits(image.words()[4 * index as usize + channel]))
}

/// The first number that `expression` gives at `uvw`, beside that of the texel that is meant.
#[track_caller]
fn looks_up(declaration: &str, expression: &str, uvw: [f64; 3], at: [u32; 3]) {
    let text = format!(
        "#version 430\nin vec3 p;\nuniform {declaration};\nout float r;\nvoid main() {{ r = vec4({expression}).x; }}\n"
    );
    let program = built("t.frag", &text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let wanted = texel(&program, 0, at, 0);
    for found in outputs(&program, &uvw, &[]) {
        assert_eq!(found, [wanted], "{expression} at {uvw:?}, wanted texel {at:?}");
    }
}

#[test]
fn coordinates_choose_the_texel_in_which_they_lie() {
    // 16 by 8 texels.
    looks_up("sampler2D t", "texture(t, p.xy)", [0.4, 0.3, 0.0], [6, 2, 0]);
    looks_up("sampler2D t", "texture(t, p.xy)", [-3.0, 9.0, 0.0], [0, 7, 0]);
    looks_up("sampler2D t", "textureLod(t, p.xy, 3.0)", [0.99, 0.01, 0.0], [15, 0, 0]);
    looks_up("sampler2D t", "textureProj(t, p)", [1.0, 0.5, 2.0], [8, 2, 0]);
    looks_up("sampler2D t", "textureOffset(t, p.xy, ivec2(2, -3))", [0.4, 0.3, 0.0], [8, 0, 0]);
    looks_up("sampler2D t", "textureOffset(t, p.xy, ivec3(-3, 2, 1).yx)", [0.4, 0.3, 0.0], [8, 0, 0]);
    looks_up("sampler2D t", "textureOffset(t, p.xy, ivec2(2.5, -3.0))", [0.4, 0.3, 0.0], [8, 0, 0]);
    looks_up("sampler2D t", "textureGrad(t, p.xy, p.xy, p.yz)", [0.4, 0.3, 0.0], [6, 2, 0]);
    looks_up("sampler2D t", "texelFetch(t, ivec2(p.xy), 0)", [3.0, 5.0, 0.0], [3, 5, 0]);
    looks_up("sampler1D t", "texture(t, p.x)", [0.5, 0.0, 0.0], [8, 0, 0]);
    looks_up("sampler3D t", "texture(t, p)", [0.6, 0.6, 0.6], [4, 2, 1]);
    looks_up("sampler2DArray t", "texture(t, p)", [0.1, 0.9, 1.6], [1, 7, 2]);
    looks_up("sampler2DArray t", "texture(t, p)", [0.1, 0.9, 7.0], [1, 7, 2]);
}

#[test]
fn a_texture_and_a_sampler_of_vulkan_are_looked_up_together() {
    let both = "texture2D t;\nuniform sampler s";
    looks_up(both, "texture(sampler2D(t, s), p.xy)", [0.4, 0.3, 0.0], [6, 2, 0]);
    looks_up(both, "textureLod(sampler2D(t, s), p.xy, 0.0)", [0.4, 0.3, 0.0], [6, 2, 0]);
    looks_up(both, "texelFetch(t, ivec2(p.xy), 0)", [3.0, 5.0, 0.0], [3, 5, 0]);
    looks_up("texture3D t", "texelFetch(t, ivec3(p), 0)", [4.0, 2.0, 1.0], [4, 2, 1]);
}

#[test]
fn gathering_takes_the_four_texels_around_a_point() {
    // 0.4 · 16 − ½ = 5.9 and 0.3 · 8 − ½ = 1.9: columns 5 and 6, rows 1 and 2, from the lower left corner on.
    for (component, at) in [("x", [5, 2, 0]), ("y", [6, 2, 0]), ("z", [6, 1, 0]), ("w", [5, 1, 0])] {
        looks_up("sampler2D t", &format!("textureGather(t, p.xy).{component}"), [0.4, 0.3, 0.0], at);
    }
}

#[test]
fn a_direction_chooses_a_face_of_a_cube() {
    // Four by four texels on each face. On +x the coordinates are (−z, −y) over x: (0.75, 0.25) here.
    looks_up("samplerCube t", "texture(t, p)", [2.0, 1.0, -1.0], [3, 1, 0]);
    looks_up("samplerCube t", "texture(t, p)", [-2.0, 1.0, -1.0], [1, 1, 1]);
    looks_up("samplerCube t", "texture(t, p)", [1.0, 2.0, -1.0], [3, 1, 2]);
    looks_up("samplerCube t", "texture(t, p)", [1.0, -2.0, -1.0], [3, 3, 3]);
    looks_up("samplerCube t", "texture(t, p)", [1.0, -0.8, 2.0], [3, 2, 4]);
    looks_up("samplerCube t", "texture(t, p)", [1.0, -0.8, -2.0], [1, 2, 5]);
}

#[test]
fn a_reference_is_compared_with_the_depth() {
    let text = |reference: f64| {
        format!(
            "#version 330\nin vec2 p;\nuniform sampler2DShadow t;\nout float r;\n\
             void main() {{ r = texture(t, vec3(p, {reference:?})); }}\n"
        )
    };
    let program = built("t.frag", &text(0.0)).unwrap();
    let depth = |x: u32| texel(&program, 0, [x, 2, 0], 0);
    let x = (0..16).find(|&x| (0.1..0.9).contains(&depth(x))).unwrap();
    let at = [(f64::from(x) + 0.5) / 16.0, 0.3];
    expect("t.frag", &text(depth(x) - 0.005), &at, &[], &[1.0]);
    expect("t.frag", &text(depth(x) + 0.005), &at, &[], &[0.0]);
    expect("t.frag", &text(-7.0), &at, &[], &[1.0]);
}

#[test]
fn sizes_and_integers() {
    let text = "#version 430\nuniform sampler2DArray a;\nuniform samplerCubeArray b;\nuniform isampler3D c;\n\
                uniform usampler2D d;\nout ivec4 r;\nvoid main() { ivec3 n = textureSize(a, 0);\n\
                r = ivec4(n.x + n.y * n.z, textureSize(b, 0).z + textureQueryLevels(b) * 100,\n\
                texelFetch(c, ivec3(1, 2, 1), 0).x, texelFetch(d, ivec2(9, 3), 0).x); }\n";
    let program = built("t.frag", text).unwrap();
    let word = |name: &str, index: usize| {
        let texture = program.textures.iter().find(|t| t.name == name).unwrap();
        texture.contents.words()[4 * index]
    };
    let c = f64::from(word("c", (4 + 2) * 8 + 1).cast_signed());
    let d = f64::from(word("d", 3 * 16 + 9));
    expect("t.frag", text, &[], &[], &[16.0 + 8.0 * 3.0, 2.0 + 100.0, c, d]);
}

#[test]
fn samplers_are_found_through_functions_structures_and_arrays() {
    let text = "#version 400\nstruct M { sampler2D map; float k; };\nuniform M m;\nuniform sampler2D all[2];\n\
                in vec2 p;\nout vec3 r;\nfloat f(sampler2D s) { return texture(s, p).y; }\n\
                void main() { r = vec3(f(m.map) * m.k, f(all[1]), f(all[0])); }\n";
    let program = built("t.frag", text).unwrap();
    let names: Vec<&str> = program.textures.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(names, ["m.map", "all[1]", "all[0]"]);
    let at = |k| texel(&program, k, [6, 2, 0], 1);
    expect("t.frag", text, &[0.4, 0.3], &[2.0], &[2.0 * at(0), at(1), at(2)]);
}

#[test]
fn a_discarded_fragment_gives_zeros_and_says_so() {
    let text = "#version 330\nin float x;\nout vec2 r;\nfloat g(float a) { if (a > 1.0) discard; return a; }\n\
                float f(float a) { float b = g(a) + 1.0; r.y = 5.0; return b; }\n\
                void main() { r = vec2(1.0); for (int k = 0; k < 3; k++) { r.x += f(x * float(k)); } }\n";
    // k = 0, 1, 2: the sum of x·k + 1 over them, and one more.
    expect("t.frag", text, &[0.25], &[], &[4.75, 5.0, 0.0]);
    expect("t.frag", text, &[0.75], &[], &[0.0, 0.0, 1.0]);
    let program = built("t.frag", text).unwrap();
    assert_eq!(program.outputs.last().unwrap().field.name, "discard");
    // A host gets what the author wrote.
    let host = program.stage_module.as_ref().unwrap();
    assert!(format!("{:?}", host.0.functions).contains("Kill"));
}

#[test]
fn what_the_rasteriser_gives_is_an_input() {
    let text = "#version 330\nin float x;\nout vec4 r;\nvoid main() {\n\
                r = vec4(x, gl_FragCoord.y, gl_FrontFacing ? 2.0 : 3.0, gl_PointCoord.x); }\n";
    let program = built("t.frag", text).unwrap();
    let names: Vec<&str> = program.inputs.iter().map(|p| p.field.name.as_str()).collect();
    assert_eq!(names, ["x", "gl_FragCoord", "gl_FrontFacing", "gl_PointCoord"]);
    expect("t.frag", text, &[1.0, 7.0, 8.0, 0.0, 1.0, 1.0, 0.25, 0.5], &[], &[1.0, 8.0, 2.0, 0.25]);
}

#[test]
fn a_derivative_is_the_difference_to_the_neighbour() {
    // Interpolated numbers in their order: x moves by 1/256 along x and by -3/512 along y, y by 2/256 and 5/512.
    let (dx, dy) = ([1.0 / 256.0, 2.0 / 256.0], [-3.0 / 512.0, 5.0 / 512.0]);
    let head = "#version 330\nin vec2 p;\nflat in float k;\nout vec4 r;\n";
    let body = "r = vec4(dFdx(p.x), dFdy(p.y), fwidth(p.x), dFdx(gl_FragCoord.x) + dFdy(k));";
    let text = format!("{head}void main() {{ {body} }}\n");
    expect(
        "t.frag",
        &text,
        &[0.5, 0.25, 3.0, 9.0, 9.0, 0.0, 1.0],
        &[],
        &[dx[0], dy[1], dx[0].abs() + dy[0].abs(), 1.0],
    );
    // Of a product, through a function that is called twice, and of a derivative.
    let body = "float f(float a) { return dFdx(a * a); }\n\
                void main() { r = vec4(f(p.x), f(p.y), dFdy(dFdx(p.x * p.y)), dFdx(f(p.x))); }\n";
    let square = |a: f64, d: f64| (a + d) * (a + d) - a * a;
    let twice = {
        let f =
            |y: f64| (0.5 + y * dy[0] + dx[0]) * (0.25 + y * dy[1] + dx[1]) - (0.5 + y * dy[0]) * (0.25 + y * dy[1]);
        f(1.0) - f(0.0)
    };
    expect(
        "t.frag",
        &format!("{head}{body}"),
        &[0.5, 0.25, 3.0],
        &[],
        &[square(0.5, dx[0]), square(0.25, dx[1]), twice, 0.0],
    );
}

#[test]
fn a_derivative_that_a_neighbour_does_not_come_to_has_no_value() {
    let text = "#version 330\nin float x;\nout vec2 r;\n\
                void main() { r = vec2(0.0); if (x < 0.5) r.x = dFdx(x); r.y = dFdx(x + x); }\n";
    expect("t.frag", text, &[0.25], &[], &[1.0 / 256.0, 2.0 / 256.0]);
    expect("t.frag", text, &[0.4990234375], &[], &[f64::NAN, 2.0 / 256.0]);
    expect("t.frag", text, &[0.75], &[], &[0.0, 2.0 / 256.0]);
}
