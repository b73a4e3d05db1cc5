//! Kernels on a real driver. Without one these tests say so and fail: a gate that skips its device
//! tests proves nothing.

use std::sync::Arc;

use crate::{Lane, vulkan};
use base::text::SourceFile;
use base::value::Batch;
use program::Program;
use program::lower::Target;
use syntax::Stage;

fn lane() -> Box<dyn Lane> {
    vulkan::open().expect("these tests need a Vulkan driver; `cargo xtask test` installs lavapipe")
}

fn program(text: &str, stage: Stage, target: Target) -> Program {
    Program::from_source(&SourceFile::new("test", text), stage, |_| Ok(target)).unwrap()
}

fn batch(program: &Program, per_case: usize, invocations: &[f32], cases: &[f32]) -> Batch {
    Batch {
        invocation_record: Arc::new(program.invocation_record()),
        case_record: Arc::new(program.case_record()),
        per_case,
        invocations: invocations.iter().map(|v| v.to_bits()).collect(),
        cases: cases.iter().map(|v| v.to_bits()).collect(),
    }
}

/// A vertex stage with one attribute, one uniform of its own per case, and two outputs.
fn scaled() -> Program {
    let text = "#version 450 core
layout(std140, binding = 0) uniform A { float s; };
layout(std140, binding = 1) uniform B { vec3 t[2]; };
layout(location = 0) in vec4 p;
layout(location = 0) out vec2 q;
void main() { q = p.zw; gl_Position = s * p + vec4(t[1], 0.0); }";
    program(text, Stage::Vertex, Target::Stage)
}

fn floats(words: &[u32]) -> Vec<f32> {
    words.iter().map(|&w| f32::from_bits(w)).collect()
}

#[test]
fn uniforms_belong_to_their_case_in_both_stages_and_w_is_filled() {
    let program = scaled();
    let lane = lane();
    // Two cases of two vertices; s = 1 and 10; t[1] = (0, 0, 0) and (5, 6, 7).
    let points = [1., 2., 3., 1., 4., 5., 6., 1., 1., 2., 3., 1., 4., 5., 6., 1.];
    let cases = [1., 9., 9., 9., 0., 0., 0., 10., 9., 9., 9., 5., 6., 7.];
    let batch = batch(&program, 2, &points, &cases);
    let kernels = [program.compute_kernel().unwrap(), program.vertex_kernel(&[3]).unwrap()];
    for kernel in kernels {
        let mut runner = lane.prepare(&kernel, 4).unwrap();
        let actual = runner.run(&batch).unwrap();
        assert_eq!(floats(actual.vertex(1, 0)), [4., 5., 6., 1., 6., 1.], "{:?}", kernel.form);
        assert_eq!(floats(actual.vertex(3, 0)), [45., 56., 67., 10., 6., 1.]);
    }
}

#[test]
fn positions_are_not_flipped() {
    // naga can append `gl_Position.yz = vec2(-y, 2z - w)`; captured positions are those of the author.
    let program = scaled();
    let points = [0.25, 0.5, 0.75, 1.0];
    let batch = batch(&program, 1, &points, &[1., 0., 0., 0., 0., 0., 0.]);
    let lane = lane();
    for kernel in [program.compute_kernel().unwrap(), program.vertex_kernel(&[4]).unwrap()] {
        let actual = lane.prepare(&kernel, 1).unwrap().run(&batch).unwrap();
        assert_eq!(floats(&actual.vertex(0, 0)[..4]), points);
    }
}

#[test]
fn an_output_that_is_not_written_shows() {
    let text = "#version 450 core
layout(location = 0) in float x;
layout(location = 0) out float q;
void main() { if (x > 0.0) { q = x; } gl_Position = vec4(x); }";
    let program = program(text, Stage::Vertex, Target::Stage);
    let lane = lane();
    for kernel in [program.compute_kernel().unwrap(), program.vertex_kernel(&[1]).unwrap()] {
        let actual = lane.prepare(&kernel, 2).unwrap().run(&batch(&program, 1, &[1.0, -1.0], &[])).unwrap();
        assert!(!actual.is_unwritten(actual.vertex(0, 0)[4]));
        assert!(actual.is_unwritten(actual.vertex(1, 0)[4]));
    }
}

fn geometry(body: &str, max_vertices: u32) -> Program {
    let text = format!(
        "#version 450 core
layout(triangles) in;
layout(line_strip, max_vertices = {max_vertices}) out;
in float n[];
out float v;
void main() {{ vec4 p = gl_in[0].gl_Position; int k = gl_PrimitiveIDIn; {body} }}"
    );
    program(&text, Stage::Geometry, Target::Stage)
}

fn run_geometry(program: &Program) -> crate::Actual {
    // The number of the primitive stands behind the others.
    let one: Vec<f32> = (0..15).map(|k| k as f32).chain([f32::from_bits(0)]).collect();
    let two: Vec<f32> = (100..115).map(|k| k as f32).chain([f32::from_bits(7)]).collect();
    let kernel = program.compute_kernel().unwrap();
    lane().prepare(&kernel, 2).unwrap().run(&batch(program, 1, &[one, two].concat(), &[])).unwrap()
}

#[test]
fn emitted_vertices_and_strips_are_recorded() {
    let actual = run_geometry(&geometry(
        "for (int i = 0; i < 3; i++) { gl_Position = gl_in[i].gl_Position; v = n[i] + float(gl_PrimitiveIDIn);
         EmitVertex(); if (i == 1) EndPrimitive(); }",
        4,
    ));
    assert_eq!((actual.emitted(1), actual.ended_strips(1)), (3, 1));
    assert_eq!(floats(actual.vertex(0, 2)), [8., 9., 10., 11., 14.]);
    assert_eq!(floats(actual.vertex(1, 1)), [104., 105., 106., 107., 120.]);
    assert_eq!([actual.strip(1, 0), actual.strip(1, 1), actual.strip(1, 2)], [0, 0, 1]);
}

#[test]
fn emission_past_the_limit_is_counted_and_stays_in_bounds() {
    let actual = run_geometry(&geometry(
        "for (int i = 0; i < 9; i++) { v = float(i); gl_Position = vec4(v); EmitVertex(); }",
        2,
    ));
    // Had the first primitive written past its record, the second one's canary would be gone.
    assert_eq!((actual.emitted(0), actual.stored(0), actual.emitted(1)), (9, 2, 9));
    assert_eq!(actual.vertex(0, 1)[4], 1.0_f32.to_bits());
}

#[test]
fn outputs_are_undefined_after_emit_vertex() {
    let actual = run_geometry(&geometry(
        "v = 1.0; gl_Position = vec4(v); EmitVertex(); gl_Position = vec4(2.0); EmitVertex();",
        2,
    ));
    assert!(!actual.is_unwritten(actual.vertex(0, 0)[4]));
    assert!(actual.is_unwritten(actual.vertex(0, 1)[4]));
}

#[test]
fn functions_take_parameters_and_give_results_and_out_parameters() {
    let text = "#version 450 core
float f(vec2 a, out vec3 b, inout float c) { b = vec3(a, c); c = c + 1.0; return a.x * a.y; }";
    let program = program(text, Stage::Library, Target::Function("f".to_owned()));
    let kernel = program.compute_kernel().unwrap();
    let actual = lane().prepare(&kernel, 1).unwrap().run(&batch(&program, 1, &[3., 5., 7.], &[])).unwrap();
    assert_eq!(floats(actual.vertex(0, 0)), [15., 3., 5., 7., 8.]);
}
