//! Constructs of every version of GLSL, one small shader each, and what they give: the values are
//! worked out by hand or in Rust, and not by the front end that is tested.

mod dialect;
mod fragment;
mod interface;
mod language;
mod linked;
mod memory;
mod numbers;
mod refused;
mod tessellation;

use std::sync::Arc;

use base::text::SourceFile;
use base::value::{Batch, Record, Scalar};
use program::interp::{self, Binary32, Binary64};
use program::lower::Target;
use program::{Program, ProgramError};
use syntax::{Shader, Stage};

/// Builds a program from the syntax tree.
pub fn built(name: &str, text: &str) -> Result<Program, ProgramError> {
    let stage = Stage::from_path(name).unwrap();
    let parsed = Shader::parse(&SourceFile::new(name, text), stage);
    assert!(parsed.diagnostics.is_empty(), "{name}: {:#?}\n{text}", parsed.diagnostics);
    Program::build(&parsed.shader, &Target::Stage)
}

fn words(record: &Record, values: &[f64]) -> Vec<u32> {
    assert_eq!(values.len(), record.words(), "{:?}", record.fields());
    let scalars = record.fields().iter().flat_map(|f| vec![f.shape.scalar; f.shape.words()]);
    let word = |(&value, scalar): (&f64, Scalar)| match scalar {
        Scalar::F32 => (value as f32).to_bits(),
        Scalar::I32 => (value as i32).cast_unsigned(),
        Scalar::U32 | Scalar::Bool => value as u32,
    };
    values.iter().zip(scalars).map(word).collect()
}

/// All outputs of one invocation, in real numbers and in strict binary32.
pub fn outputs(program: &Program, inputs: &[f64], uniforms: &[f64]) -> [Vec<f64>; 2] {
    let invocation_record = Arc::new(program.invocation_record());
    let case_record = Arc::new(program.case_record());
    let batch = Batch {
        per_case: 1,
        invocations: words(&invocation_record, inputs),
        cases: words(&case_record, uniforms),
        invocation_record,
        case_record,
    };
    let real = interp::run::<Binary64>(program, &batch).unwrap();
    let single = interp::run::<Binary32>(program, &batch).unwrap();
    let scalars: Vec<Scalar> =
        program.outputs.iter().flat_map(|p| vec![p.field.shape.scalar; p.field.shape.words()]).collect();
    let decode = |(&word, scalar): (&u32, &Scalar)| match scalar {
        Scalar::F32 => f64::from(f32::from_bits(word)),
        Scalar::I32 => f64::from(word.cast_signed()),
        Scalar::U32 | Scalar::Bool => f64::from(word),
    };
    let vertices = real.stored(0);
    let mut all = [Vec::new(), Vec::new()];
    for vertex in 0..vertices {
        all[0].extend(real.vertex(0, vertex));
        all[1].extend(single.vertex(0, vertex).iter().zip(&scalars).map(decode));
    }
    all
}

/// What a shader gives, compared with what it should.
#[track_caller]
pub fn expect(name: &str, text: &str, inputs: &[f64], uniforms: &[f64], expected: &[f64]) {
    let program = built(name, text).and_then(Program::with_memory_inside).unwrap_or_else(|e| panic!("{e}\n{text}"));
    for found in outputs(&program, inputs, uniforms) {
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 2e-6 * b.abs().max(1.0) || (a.is_nan() && b.is_nan());
        let agree = found.len() == expected.len() && found.iter().zip(expected).all(near);
        assert!(agree, "{found:?}, expected {expected:?}\n{text}");
    }
}

/// What `body` leaves in `r`, for the inputs x = 3.5, i = -7, u = 5 and v = (1, 2, 3, 4).
#[track_caller]
pub fn gives(globals: &str, body: &str, expected: [f64; 4]) {
    let text = format!(
        "#version 450\nin float x;\nin int i;\nin uint u;\nin vec4 v;\nout vec4 r;\n{globals}\nvoid main() {{\n{body}\n}}\n"
    );
    expect("t.vert", &text, &[3.5, -7.0, 5.0, 1.0, 2.0, 3.0, 4.0], &[], &expected);
}

#[test]
#[should_panic = "expected"]
fn a_wrong_value_is_noticed() {
    gives("", "r = v * 2.0;", [2.0, 4.0, 6.0, 8.001]);
}

#[test]
#[should_panic = "expected"]
fn a_dropped_effect_is_noticed() {
    // One that ran both sides of `&&` would count to 2.
    gives("int n = 0; bool step() { n++; return true; }", "bool b = x < 0.0 && step(); step(); r = vec4(n);", [2.0; 4]);
}
