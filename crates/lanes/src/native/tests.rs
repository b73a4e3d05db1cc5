//! The author's text on a real driver. Without lavapipe and glslang these tests say so and fail: a gate that skips its
//! device tests proves nothing.

use std::io::Write as _;
use std::process::{Command, Stdio};
use std::sync::Arc;

use super::capture::{self, Capture, Feed};
use super::glslang::{TextStage, Translator};
use super::spirv::Reflection;
use super::{interface, open};
use crate::{Actual, Lane, LaneError};
use base::text::SourceFile;
use base::value::Batch;
use program::Program;
use program::lower::Target;
use syntax::Stage;

const NEEDED: &str = "these tests need lavapipe and glslangValidator; `cargo xtask test` installs them";

fn lane() -> Box<dyn Lane> {
    open().unwrap_or_else(|missing| panic!("{NEEDED}: {missing}"))
}

fn program(name: &str, text: &str) -> Program {
    let stage = Stage::from_path(name).unwrap();
    Program::from_source(&SourceFile::new(name, text), stage, |_| Ok(Target::Stage)).unwrap()
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

fn vertices(text: &str, components: &[u8], per_case: usize, invocations: &[f32], cases: &[f32]) -> Actual {
    let program = program("t.vert", text);
    let batch = batch(&program, per_case, invocations, cases);
    let kernel = program.vertex_kernel(components).unwrap();
    lane().prepare(&kernel, batch.invocation_count()).unwrap().run(&batch).unwrap()
}

fn primitives(text: &str, invocations: &[f32], cases: &[f32]) -> Actual {
    let program = program("t.geom", text);
    let batch = batch(&program, 1, invocations, cases);
    let kernel = program.geometry_kernel().unwrap();
    lane().prepare(&kernel, batch.invocation_count()).unwrap().run(&batch).unwrap()
}

const SCALED: &str = "#version 150 core
in vec4 p;
uniform float s;
uniform vec3 t[2];
uniform mat2 m;
out vec2 q;
void main() { q = m * p.zw; gl_Position = s * p + vec4(t[1], 0.0); }
";

#[test]
fn uniforms_belong_to_their_case_w_is_filled_and_no_position_is_flipped() {
    let points = [1., 2., 3., 1., 4., 5., 6., 1., 1., 2., 3., 1., 4., 5., 6., 1.];
    let identity = [1., 0., 0., 1.];
    let swap = [0., 1., 1., 0.];
    let cases = [&[1., 9., 9., 9., 0., 0., 0.][..], &identity, &[10., 9., 9., 9., 5., 6., 7.], &swap].concat();
    let actual = vertices(SCALED, &[3], 2, &points, &cases);
    assert_eq!(floats(actual.vertex(0, 0)), [1., 2., 3., 1., 3., 1.]);
    assert_eq!(floats(actual.vertex(1, 0)), [4., 5., 6., 1., 6., 1.]);
    assert_eq!(floats(actual.vertex(3, 0)), [45., 56., 67., 10., 1., 6.]);
}

#[test]
fn an_old_text_gets_its_interface_rewritten() {
    let text = "#version 120\nattribute vec4 p;\nuniform mat4 m;\nvarying float d;\n\
                void main() { d = dot(p, p); gl_Position = m * p; }\n";
    let mut cases = [0.0; 16];
    for k in 0..4 {
        cases[5 * k] = 2.0;
    }
    let actual = vertices(text, &[4], 1, &[1., 2., 3., 4.], &cases);
    assert_eq!(floats(actual.vertex(0, 0)), [2., 4., 6., 8., 30.]);
}

#[test]
fn members_of_blocks_and_numbers_of_vertices_are_fed() {
    let text = "#version 330 core
layout(location = 3) in float x;
layout(std140, row_major) uniform Light { vec3 color; mat3 turn; } light;
flat out int number;
out vec3 lit;
void main() { number = gl_VertexID; lit = light.turn * light.color * x; gl_Position = vec4(0.0); }
";
    let turn = [0., 1., 0., 0., 0., 1., 1., 0., 0.];
    let case = [&[2., 3., 5.][..], &turn].concat();
    // Numbers of vertices that no place in the batch has.
    let number = f32::from_bits;
    let fed = [1., number(900), 1., number(4), 7., number(4), 10., number(70_000)];
    let actual = vertices(text, &[1], 2, &fed, &[&case[..], &case[..]].concat());
    let lit = |v: usize| {
        let index = actual.layout().vertex.index_of("lit").unwrap();
        floats(&actual.vertex(v, 0)[actual.layout().vertex.range(index)])
    };
    // Columns (0, 1, 0), (0, 0, 1) and (1, 0, 0).
    assert_eq!((lit(0), lit(3)), (vec![5., 2., 3.], vec![50., 20., 30.]));
    let number = actual.layout().vertex.index_of("number").unwrap();
    let number = actual.layout().vertex.range(number).start;
    assert_eq!((0..4).map(|v| actual.vertex(v, 0)[number]).collect::<Vec<_>>(), [900, 4, 4, 70_000]);
}

#[test]
fn an_output_that_is_not_written_shows() {
    let text =
        "#version 150\nin float x;\nout float q;\nvoid main() { if (x > 0.0) { q = x; } gl_Position = vec4(x); }\n";
    let actual = vertices(text, &[1], 1, &[1.0, -1.0], &[]);
    assert!(!actual.is_unwritten(actual.vertex(0, 0)[4]));
    assert!(actual.is_unwritten(actual.vertex(1, 0)[4]));
}

#[test]
fn what_glslang_refuses_is_reported_in_its_words() {
    let translator = Translator::find().expect(NEEDED);
    let text = "#version 150\nvoid main() {\n  gl_Position = nothing;\n}\n";
    let Err(error) = translator.translate(TextStage::Vertex, text, &[]) else { panic!("it is taken") };
    let reported = "glslang, line 3: 'nothing' : undeclared identifier";
    assert!(matches!(&error, LaneError::Unsupported(what) if what.starts_with(reported)), "{error}");
    let old = "#version 120\nvoid main() { gl_Position = vec4(0.0); }\n";
    assert!(matches!(translator.translate(TextStage::Vertex, old, &[]), Err(LaneError::Unsupported(_))));
}

const STRIPS: &str = "#version 150 core
layout(lines_adjacency) in;
layout(OUTPUT, max_vertices = 7) out;
in float n[];
uniform float last;
out float v;
void main() {
    for (int i = 0; i < 4; i++) {
        v = n[i]; gl_Position = gl_in[i].gl_Position + vec4(0.0, 0.0, 0.0, last); EmitVertex();
        if (i == 2) EndPrimitive();
    }
    EndPrimitive();
    if (last > 0.0) {
        for (int i = 0; i < 3; i++) { v = last; gl_Position = vec4(0.0); EmitVertex(); }
    }
}
";

#[test]
fn emitted_vertices_and_strips_are_those_of_the_shader() {
    // gl_Position and n of four vertices.
    let one: Vec<f32> = (0..20).map(|k| k as f32).collect();
    let two: Vec<f32> = (100..120).map(|k| k as f32).collect();
    for output in ["points", "line_strip", "triangle_strip"] {
        let text = STRIPS.replace("OUTPUT", output);
        let actual = primitives(&text, &[one.clone(), two.clone()].concat(), &[0.0, 8.0]);
        assert_eq!([0, 1].map(|i| actual.emitted(i)), [4, 7], "{output}");
        assert_eq!((0..4).map(|v| actual.strip(0, v)).collect::<Vec<_>>(), [0, 0, 0, 1]);
        assert_eq!((0..7).map(|v| actual.strip(1, v)).collect::<Vec<_>>(), [0, 0, 0, 1, 2, 2, 2]);
        assert_eq!(floats(actual.vertex(0, 1)), [4., 5., 6., 7., 17.]);
        // A strip of one vertex alone gives no primitive, and was emitted all the same.
        assert_eq!(floats(actual.vertex(1, 3)), [112., 113., 114., 123., 119.]);
        assert_eq!(floats(actual.vertex(1, 6)), [0., 0., 0., 0., 8.]);
    }
}

#[test]
fn a_stage_that_emits_nothing_for_some_primitives_keeps_the_others_in_place() {
    let text = "#version 150\nlayout(triangles) in;\nlayout(triangle_strip, max_vertices = 4) out;\nin vec2 a[3];\nout vec2 b;\n\
                void main() { for (int i = 0; i < int(a[0].x); i++) { b = a[1] * float(i); EmitVertex(); } }\n";
    let of = |count: f32| [count, 0.0, count, 1.0, 0.0, 0.0];
    let actual = primitives(text, &[of(0.0), of(3.0), of(2.0), of(0.0), of(4.0)].concat(), &[]);
    assert_eq!((0..5).map(|i| actual.emitted(i)).collect::<Vec<_>>(), [0, 3, 2, 0, 4]);
    assert_eq!(floats(actual.vertex(4, 3)), [12.0, 3.0]);
    assert_eq!(floats(actual.vertex(2, 1)), [2.0, 1.0]);
}

#[test]
fn programs_that_are_not_the_text_are_refused() {
    let program = program("t.vert", SCALED);
    let probed = program.probed(64).unwrap();
    let kernel = probed.program.vertex_kernel(&[4]).unwrap();
    assert!(matches!(lane().prepare(&kernel, 1), Err(LaneError::Unsupported(_))));
}

/// What `spirv-val` says of a module.
fn complaint(words: &[u32]) -> Option<String> {
    let mut child = Command::new("spirv-val")
        .args(["--target-env", "vulkan1.1", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .ok()?;
    child.stdin.take().unwrap().write_all(bytemuck::cast_slice(words)).unwrap();
    let output = child.wait_with_output().unwrap();
    Some(String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned())
}

#[test]
fn what_is_added_keeps_modules_valid() {
    let translator = Translator::find().expect(NEEDED);
    if complaint(&[]).is_none() {
        return test_record::not_run("spirv-val is not on PATH: modules with captures are not validated");
    }
    let strips = STRIPS.replace("OUTPUT", "triangle_strip");
    for (kind, name, text) in [(TextStage::Vertex, "t.vert", SCALED), (TextStage::Geometry, "t.geom", strips.as_str())]
    {
        let words = translator.translate(kind, text, &[]).unwrap();
        let reflection = Reflection::of(&words);
        let outputs = interface::outputs(&reflection, &program(name, text).output_layout().vertex).unwrap();
        let outputs = outputs.into_iter().map(|(captured, _)| captured).collect();
        let mark = (kind == TextStage::Geometry).then(|| interface::free_location(&reflection));
        for (points, feed) in [(false, Feed::Uniform), (true, Feed::Uniform), (false, Feed::Storage)] {
            let outputs = Vec::clone(&outputs);
            let capture = Capture { outputs, words: 6, sentinel: 0x7fc0_1234, mark, points, feed };
            assert_eq!(complaint(&capture::insert(&words, &reflection, &capture)).as_deref(), Some(""), "{name}");
        }
        let mut broken = words.to_vec();
        broken[3] = 1;
        assert_ne!(complaint(&broken).as_deref(), Some(""), "a planted fault");
    }
}
