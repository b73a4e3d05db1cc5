//! Kernels on real drivers of OpenGL. Without one these tests say so and fail: a gate that skips its device tests proves
//! nothing.

use std::rc::Rc;
use std::sync::Arc;

use super::context::Context;
use super::job::{CaptureKind, Inputs, Job, Output};
use super::{Here, OpenGl, Session, ask};
use crate::{Actual, Api, Description, Lane, LaneError};
use base::text::SourceFile;
use base::value::Batch;
use program::lower::Target;
use program::{Kernel, Program};
use syntax::Stage;

fn context() -> Rc<Context> {
    Context::open().expect("these tests need OpenGL by Mesa; `cargo xtask test` installs it")
}

fn lane() -> OpenGl<Here> {
    let description = Description {
        name: "opengl",
        driver: String::new(),
        executor: String::new(),
        front_end: String::new(),
        api: Api::OpenGl,
        stages: Vec::new(),
    };
    OpenGl { description, backend: Here(context()), guarded: true }
}

fn program(name: &str, text: &str) -> Program {
    let file = SourceFile::new(name, text);
    let stage = Stage::from_path(name).unwrap();
    Program::from_source(&file, stage, |_| Ok(Target::Stage)).unwrap()
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

fn floats(words: &[u32]) -> Vec<f32> {
    words.iter().map(|&w| f32::from_bits(w)).collect()
}

/// Runs kernels of a program, each vertex of each invocation as numbers.
fn run(kernel: &Kernel, batch: &Batch) -> Result<Actual, LaneError> {
    lane().prepare(kernel, batch.invocation_count())?.run(batch)
}

#[test]
fn old_text_runs_as_it_stands() {
    let text = "#version 120
attribute vec4 p;
uniform float s;
uniform vec3 t[2];
varying vec2 q;
void main() { q = p.zw; gl_Position = s * p + vec4(t[1], 0.0); }";
    let program = program("old.vert", text);
    let points = [1., 2., 3., 9., 4., 5., 6., 9., 1., 2., 3., 9., 4., 5., 6., 9.];
    let cases = [1., 9., 9., 9., 0., 0., 0., 10., 9., 9., 9., 5., 6., 7.];
    // Three components are fed: the fourth is filled with 1.
    let actual = run(&program.vertex_kernel(&[3]).unwrap(), &batch(&program, 2, &points, &cases)).unwrap();
    assert_eq!(floats(actual.vertex(1, 0)), [4., 5., 6., 1., 6., 1.]);
    assert_eq!(floats(actual.vertex(3, 0)), [45., 56., 67., 10., 6., 1.]);
}

#[test]
fn uniform_blocks_are_filled_where_the_driver_says() {
    let text = "#version 150
layout(std140) uniform A { float a; vec3 b; mat3 m; float c[2]; } one;
layout(std140, row_major) uniform B { mat2x3 n; };
in float x;
out vec4 p;
out vec3 r;
void main() { p = vec4(one.a, one.b.y, one.m[2][1], one.c[1] + x); r = n[1]; gl_Position = vec4(0.0); }";
    let program = program("blocks.vert", text);
    let names: Vec<String> = program.case_record().fields().iter().map(|f| f.name.clone()).collect();
    assert_eq!(names, ["one.a", "one.b", "one.m", "one.c", "n"]);
    let case: Vec<f32> = (1..=21).map(|k| k as f32).collect();
    let other: Vec<f32> = (101..=121).map(|k| k as f32).collect();
    let batch = batch(&program, 1, &[0.5, 0.25], &[case, other].concat());
    let actual = run(&program.vertex_kernel(&[1]).unwrap(), &batch).unwrap();
    let at = |name: &str| program.output_layout().vertex.range(program.output_layout().vertex.index_of(name).unwrap());
    assert_eq!(floats(&actual.vertex(0, 0)[at("p")]), [1., 3., 12., 15.5]);
    assert_eq!(floats(&actual.vertex(1, 0)[at("r")]), [119., 120., 121.]);
}

#[test]
fn truth_values_integers_and_matrices_are_uniforms() {
    let text = "#version 130
uniform bool on;
uniform ivec2 k;
uniform uint u;
uniform mat3x2 m;
in float x;
flat out ivec2 i;
flat out uint n;
out vec2 c;
void main() { i = on ? k : -k; n = u; c = m[2]; gl_Position = vec4(x); }";
    let program = program("kinds.vert", text);
    let mut batch = batch(&program, 1, &[1.0], &[]);
    batch.cases = vec![1, 7, -8_i32 as u32, 0xffff_fff0];
    batch.cases.extend([1., 2., 3., 4., 5., 6.].map(f32::to_bits));
    let actual = run(&program.vertex_kernel(&[1]).unwrap(), &batch).unwrap();
    let layout = program.output_layout().vertex;
    let at = |name: &str| &actual.vertex(0, 0)[layout.range(layout.index_of(name).unwrap())];
    assert_eq!((at("i"), at("n")), (&[7, -8_i32 as u32][..], &[0xffff_fff0][..]));
    assert_eq!(floats(at("c")), [5., 6.]);
}

#[test]
fn samplers_are_bound_to_the_texels_of_the_suite() {
    let text = "#version 130
uniform sampler2D map;
uniform isampler2D whole;
in vec2 uv;
out vec4 c;
flat out int w;
void main() { c = texture(map, uv / vec2(16.0, 8.0)); w = texelFetch(whole, ivec2(uv), 0).x; gl_Position = vec4(0.0); }";
    let program = program("texture.vert", text);
    let batch = batch(&program, 1, &[3.5, 5.5], &[]);
    let actual = run(&program.vertex_kernel(&[2]).unwrap(), &batch).unwrap();
    let texel = |name: &str| {
        let texture = program.textures.iter().find(|t| t.name == name).unwrap();
        texture.contents.words()[4 * (5 * 16 + 3)..][..4].to_vec()
    };
    let layout = program.output_layout().vertex;
    let at = |name: &str| &actual.vertex(0, 0)[layout.range(layout.index_of(name).unwrap())];
    assert_eq!(at("c"), texel("map"));
    assert_eq!(at("w"), &texel("whole")[..1]);
}

#[test]
fn a_text_that_the_driver_refuses_is_reported_at_the_authors_place() {
    let program = program("p.vert", "#version 150\nin vec4 p;\nvoid main() { gl_Position = p; }\n");
    let mut kernel = program.vertex_kernel(&[4]).unwrap();
    let mut altered = (*kernel.program).clone();
    altered.defines = vec![("A".to_owned(), "1".to_owned())];
    altered.texts = vec![SourceFile::new("p.vert", "#version 150\nin vec4 p;\nvoid main() { gl_Position = q; }\n")];
    kernel.program = Arc::new(altered);
    let error = run(&kernel, &batch(&program, 1, &[0.0; 4], &[])).unwrap_err().to_string();
    // A macro of the host stands behind the first line, and counts for nothing.
    assert!(error.contains("p.vert:3:29: error: `q' undeclared"), "{error}");
}

fn geometry(output: &str, max_vertices: u32, body: &str) -> Program {
    let text = format!(
        "#version 150
layout(triangles) in;
layout({output}, max_vertices = {max_vertices}) out;
uniform float s;
in Vertex {{ float n; flat int k; }} point[];
in vec2 uv[];
out float v;
flat out int i;
void main() {{ {body} }}"
    );
    program("stage.geom", &text)
}

/// Two primitives, the second with numbers that are 100 more.
fn run_geometry(program: &Program) -> Result<Actual, LaneError> {
    let record = program.invocation_record();
    let mut words = Vec::new();
    for primitive in 0..2 {
        for field in record.fields() {
            let number = |k: usize| (100 * primitive + k) as u32;
            let of = |k| if field.name == "point.k" { number(k) } else { (number(k) as f32).to_bits() };
            words.extend((0..field.shape.words()).map(of));
        }
    }
    let batch = Batch { invocations: words, ..batch(program, 1, &[], &[1.0, 2.0]) };
    run(&program.geometry_kernel().unwrap(), &batch)
}

const FAN: &str = "for (int j = 0; j < 3; j++) { gl_Position = gl_in[j].gl_Position; v = s * (point[j].n + uv[j].y); i = point[j].k; EmitVertex(); }";

#[test]
fn inputs_reach_their_vertex_whatever_they_are() {
    let program = geometry("line_strip", 3, FAN);
    let actual = run_geometry(&program).unwrap();
    let layout = program.output_layout().vertex;
    let at = |v, name: &str| &actual.vertex(1, v)[layout.range(layout.index_of(name).unwrap())];
    assert_eq!((actual.emitted(1), actual.stored(1)), (3, 3));
    assert_eq!(floats(at(2, "gl_Position")), [108., 109., 110., 111.]);
    // s is 2 there; n of vertex 1 is 101, and uv[1].y is 103.
    assert_eq!(floats(at(1, "v")), [408.]);
    assert_eq!(at(2, "i"), [102]);
}

#[test]
fn strips_of_every_kind_come_back() {
    for (output, body, count, strips) in [
        (
            "points",
            "for (int j = 0; j < 4; j++) { v = float(j); gl_Position = vec4(v); i = j; EmitVertex(); }",
            4,
            [0; 5],
        ),
        (
            "line_strip",
            "for (int j = 0; j < 5; j++) { v = float(j); gl_Position = vec4(v); i = j; EmitVertex(); if (j == 1) EndPrimitive(); }",
            5,
            [0, 0, 1, 1, 1],
        ),
        (
            "triangle_strip",
            "for (int j = 0; j < 5; j++) { v = float(j); gl_Position = vec4(v); i = j; EmitVertex(); }",
            5,
            [0; 5],
        ),
        // Two lines that meet in the same bits.
        (
            "line_strip",
            "for (int j = 0; j < 4; j++) { v = float((j + 1) / 2); gl_Position = vec4(v); i = 0; EmitVertex(); if (j == 1) EndPrimitive(); }",
            4,
            [0, 0, 1, 1, 1],
        ),
    ] {
        let actual = run_geometry(&geometry(output, 8, body)).unwrap();
        assert_eq!(actual.emitted(1), count, "{output}");
        let found: Vec<u32> = (0..actual.stored(1)).map(|v| actual.strip(1, v)).collect();
        assert_eq!(found, strips[..count as usize], "{output}");
        let last = actual.vertex(1, count as usize - 1)[4];
        assert!(f32::from_bits(last) == 4.0 || f32::from_bits(last) == count as f32 - 1.0 || last == 2.0_f32.to_bits());
    }
}

#[test]
fn a_vertex_that_no_primitive_has_is_refused_by_name() {
    let body = "v = 1.0; i = 1; gl_Position = vec4(v); EmitVertex();";
    let error = run_geometry(&geometry("line_strip", 3, body)).unwrap_err();
    assert!(matches!(&error, LaneError::Unsupported(what) if what.contains("in a strip of 1")), "{error}");
}

#[test]
fn emission_past_the_limit_is_counted() {
    let body = "for (int j = 0; j < 9; j++) { v = float(j); i = j; gl_Position = vec4(v); EmitVertex(); }";
    let actual = run_geometry(&geometry("points", 2, body)).unwrap();
    assert_eq!((actual.emitted(0), actual.stored(0)), (9, 2));
}

#[test]
fn what_stands_for_a_number_of_the_draw_is_refused_by_name() {
    let body = "v = float(gl_PrimitiveIDIn); i = 1; gl_Position = vec4(v); EmitVertex();";
    let error = run_geometry(&geometry("points", 1, body)).unwrap_err();
    let said = "`gl_PrimitiveIDIn` cannot be set on this lane, where each primitive is drawn by itself";
    assert_eq!(error, LaneError::Unsupported(said.to_owned()));
}

#[test]
fn a_loop_without_end_does_not_stop_this_process() {
    let text = "#version 150
in float x;
uniform float stop;
void main() { float a = x; while (a < stop) { a *= 0.5; } gl_Position = vec4(a); }";
    let program = program("endless.vert", text);
    let batch = batch(&program, 1, &[1.0, 0.5], &[1.0, 1.0]);
    let error = run(&program.vertex_kernel(&[1]).unwrap(), &batch).unwrap_err();
    assert!(matches!(error, LaneError::Endless { invocation: 1, count: 2, .. }), "{error}");
}

/// Captured words of a job on a driver.
fn captured(job: &Job, inputs: &Inputs<'_>) -> Result<super::Captured, LaneError> {
    let mut ready = super::Ready::new(&context(), job, inputs.count).unwrap();
    Session::run(&mut ready, inputs)
}

#[test]
fn drawn_one_by_one_gives_the_same() {
    let program = geometry("line_strip", 3, FAN);
    let job = ask::job(&program.geometry_kernel().unwrap()).unwrap();
    assert!(matches!(job.stage, CaptureKind::Geometry { output: Output::Lines, max_vertices: 3, .. }));
    let words: Vec<u32> = (0..2 * job.invocation_words as u32).collect();
    let cases = [1.0_f32.to_bits(), 2.0_f32.to_bits()];
    let inputs = |one_by_one| Inputs {
        invocations: &words,
        cases: &cases,
        count: 2,
        per_case: 1,
        sentinel: 0x7fc0_1234,
        one_by_one,
    };
    let all = captured(&job, &inputs(false)).unwrap();
    assert_eq!(all.primitives, [2, 2]);
    assert_eq!(all, captured(&job, &inputs(true)).unwrap());
}
