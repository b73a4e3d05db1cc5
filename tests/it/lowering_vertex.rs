//! Vertex stages of all dialects of desktop GLSL, run on lavapipe as compute and as a vertex stage.
//! Both give the same words, and the values worked out by hand.

use naga::Binding;
use program::Program;

use crate::geometry::{batch, lane, values};
use crate::lowering::stage;

fn program(text: &str) -> Program {
    stage("test.vert", text).program()
}

/// Outputs of all vertices, equal in both kernels. `components` as the host feeds them; all when empty.
fn run(program: &Program, components: &[u8], vertices: &[Vec<f32>], uniforms: &[f32]) -> Vec<Vec<f32>> {
    let batch = batch(program, vertices, uniforms);
    let kernels = [program.compute_kernel().unwrap(), program.vertex_kernel(components).unwrap()];
    let lane = lane();
    let [compute, vertex] = kernels.map(|kernel| {
        let actual = lane.prepare(&kernel, vertices.len()).unwrap().run(&batch).unwrap();
        (0..vertices.len()).map(|v| values(&actual, v, 0)).collect::<Vec<_>>()
    });
    assert_eq!(compute, vertex);
    vertex
}

fn locations(program: &Program) -> Vec<(&str, u32)> {
    let location = |binding: &Option<Binding>| match binding {
        Some(Binding::Location { location, .. }) => *location,
        other => panic!("{other:?}"),
    };
    let arguments = &program.module.entry_points[0].function.arguments;
    arguments.iter().map(|a| (a.name.as_deref().unwrap(), location(&a.binding))).collect()
}

#[test]
fn several_names_in_one_declaration_and_mixed_locations() {
    let program = program(
        "#version 410 core
in vec2 a, b; // 二つ
layout(location = 3) in vec3 c;
in float d /* 高さ */, e;
layout(location = 0) in vec4 f;
out vec2 x, y;
layout(location = 1) out float z;
void main() { x = a + 10.0 * b; y = c.zy; z = d - e; gl_Position = f; }",
    );
    let expected = [("a", 1), ("b", 2), ("c", 3), ("d", 4), ("e", 5), ("f", 0)];
    assert_eq!(locations(&program), expected);
    let vertex = |k: f32| (1..=13).map(|v| k * v as f32).collect::<Vec<_>>();
    let outputs = run(&program, &[], &[vertex(1.), vertex(2.)], &[]);
    // a = (1, 2), b = (3, 4), c = (5, 6, 7), d = 8, e = 9, f = (10 to 13).
    assert_eq!(outputs[0], [10., 11., 12., 13., 31., 42., 7., 6., -1.]);
    assert_eq!(outputs[1], [20., 22., 24., 26., 62., 84., 14., 12., -2.]);
}

#[test]
fn attribute_and_varying_of_old_versions() {
    let program = program(
        "#version 120
attribute vec3 position, normal;
attribute float size;
uniform mat4 mvp;
varying vec3 n;
varying float s;
void main() { n = normal; s = size; gl_Position = mvp * vec4(position, 1.0); }",
    );
    assert_eq!(locations(&program), [("position", 0), ("normal", 1), ("size", 2)]);
    let scale_and_move = [2., 0., 0., 0., 0., 3., 0., 0., 0., 0., 4., 0., 10., 20., 30., 1.];
    let outputs = run(&program, &[], &[vec![1., 1., 1., 4., 5., 6., 7.]], &scale_and_move);
    assert_eq!(outputs, [[12., 23., 34., 1., 4., 5., 6., 7.]]);
}

#[test]
fn integers_are_attributes_and_flat_outputs() {
    let program = program(
        "#version 150
in int part;
in ivec2 pair;
in uint bits;
flat out int doubled;
out ivec2 swapped;
flat out uint shifted;
void main() {
  doubled = 2 * part; swapped = pair.yx; shifted = bits << 4u;
  gl_Position = vec4(float(gl_VertexID), float(gl_VertexID + part), 0.0, 1.0);
}",
    );
    let outputs =
        run(&program, &[], &[vec![-7., 1., -2., 3., 0.], vec![8., -3., 4., 5., 1.], vec![0., 0., 0., 0., 2.]], &[]);
    assert_eq!(outputs[0], [0., -7., 0., 1., -14., -2., 1., 48.]);
    assert_eq!(outputs[1], [1., 9., 0., 1., 16., 4., -3., 80.]);
    assert_eq!(outputs[2], [2., 2., 0., 1., 0., 0., 0., 0.]);
}

#[test]
fn uniform_blocks_with_and_without_a_name() {
    let program = program(
        "#version 150
in vec4 p;
layout(std140) uniform Camera { mat4 view; float near, far; };
uniform Light { vec3 direction; float power; } light;
layout(std140) uniform Sun { vec3 direction; float power; } sun;
uniform float bias = 5.0;
out vec4 l;
void main() {
  l = vec4(light.direction * light.power, sun.power + sun.direction.y);
  gl_Position = view * p + vec4(near, far, bias, 0.0);
}",
    );
    let names: Vec<&str> = program.uniforms.iter().map(|u| u.field.name.as_str()).collect();
    let expected = ["view", "near", "far", "light.direction", "light.power", "sun.direction", "sun.power", "bias"];
    assert_eq!(names, expected);
    let mut uniforms = vec![0., 1., 0., 0., 1., 0., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]; // x and y change places
    uniforms.extend([0.5, 100., 1., 2., 3., 10., 7., 8., 9., 0.25, 1000.]);
    let outputs = run(&program, &[], &[vec![1., 2., 3., 4.]], &uniforms);
    assert_eq!(outputs, [[2.5, 101., 1003., 4., 10., 20., 30., 8.25]]);
}

/// Every word of every uniform, one output a vertex: `gl_VertexID` picks the word.
#[test]
fn uniform_arrays_and_matrices_keep_every_word_in_both_kernels() {
    let declarations = [
        ("float", 1, 1),
        ("vec2", 1, 2),
        ("vec3", 1, 3),
        ("mat3", 3, 3),
        ("mat4", 4, 4),
        ("mat4x3", 4, 3),
        ("mat3x4", 3, 4),
        ("mat2", 2, 2),
        ("mat4x2", 4, 2),
        ("int", 1, 1),
        ("ivec3", 1, 3),
        ("uvec2", 1, 2),
    ];
    for (ty, columns, rows) in declarations {
        for count in [None, Some(3_usize)] {
            let dims = count.map_or(String::new(), |n| format!("[{n}]"));
            let element = |k: usize| if count.is_some() { format!("u[{k}]") } else { "u".to_owned() };
            let mut body = String::new();
            let mut words = 0;
            for k in 0..count.unwrap_or(1) {
                for column in 0..columns {
                    for row in 0..rows {
                        let column = if columns > 1 { format!("[{column}]") } else { String::new() };
                        let row = if rows > 1 { format!("[{row}]") } else { String::new() };
                        body += &format!("if (gl_VertexID == {words}) v = float({}{column}{row});\n", element(k));
                        words += 1;
                    }
                }
            }
            let text = format!(
                "#version 150
uniform float before;
uniform {ty} u{dims}, w; // 前後に別の値
in float unused;
void main() {{ float v = -1.0; {body} gl_Position = vec4(v, before, float(w{}), unused); }}",
                match (columns, rows) {
                    (1, 1) => "",
                    (1, _) => ".x",
                    _ => "[0][0]",
                }
            );
            let program = program(&text);
            let own: Vec<f32> = (0..words).map(|k| (100 + k) as f32).collect();
            let behind: Vec<f32> = (0..columns * rows).map(|k| (500 + k) as f32).collect();
            let uniforms = [&[7.][..], &own, &behind].concat();
            let vertices: Vec<Vec<f32>> = (0..words).map(|k| vec![0.5, k as f32]).collect();
            let outputs = run(&program, &[], &vertices, &uniforms);
            let expected: Vec<Vec<f32>> = own.iter().map(|&v| vec![v, 7., 500., 0.5]).collect();
            assert_eq!(outputs, expected, "{ty}{dims}");
        }
    }
}

#[test]
fn three_floats_feed_a_vec4_and_w_is_1() {
    let program = program("#version 150\nin vec4 p; in vec4 q;\nout vec4 r;\nvoid main() { gl_Position = p; r = q; }");
    // What the host does not feed, the vertex fetch fills: the eights and nines are never read.
    let fed = batch(&program, &[vec![1., 2., 3., 9., 4., 5., 8., 9.]], &[]);
    let kernel = program.vertex_kernel(&[3, 2]).unwrap();
    let actual = lane().prepare(&kernel, 1).unwrap().run(&fed).unwrap();
    assert_eq!(values(&actual, 0, 0), [1., 2., 3., 1., 4., 5., 0., 1.]);
    // With the filled values the compute kernel agrees.
    assert_eq!(
        run(&program, &[3, 2], &[vec![1., 2., 3., 1., 4., 5., 0., 1.]], &[]),
        [[1., 2., 3., 1., 4., 5., 0., 1.]]
    );
}

#[test]
#[should_panic = "assertion `left == right` failed"]
fn kernels_that_differ_are_noticed() {
    // The vertex stage fills w with 1, the compute kernel is fed a 9.
    let program = program("#version 150\nin vec4 p;\nvoid main() { gl_Position = p; }");
    run(&program, &[3], &[vec![1., 2., 3., 9.]], &[]);
}

#[test]
fn a_stage_without_a_position_is_run() {
    let program = program("#version 150\nin vec2 p;\nout vec2 q;\nvoid main() { q = p.yx; }");
    assert_eq!(run(&program, &[], &[vec![1., 2.]], &[]), [[2., 1.]]);
}
