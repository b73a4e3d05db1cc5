//! Programs that write down what they compute: on the embedded lane, on a driver and in both domains
//! of the interpreter.

mod faults;
mod shipped;
mod small;

use std::sync::Arc;

use base::text::SourceFile;
use base::value::Batch;
use lanes::{Actual, Lane, embedded, vulkan};
use program::lower::Target;
use program::probe::{Trace, What};
use program::{Probed, Program};
use syntax::Stage;

fn embedded_lane() -> Box<dyn Lane> {
    embedded::open().unwrap()
}

fn driver() -> Box<dyn Lane> {
    vulkan::open().unwrap_or_else(|missing| panic!("these tests need a Vulkan driver: {missing}"))
}

/// The function `f` of a text.
fn function(text: &str) -> Program {
    let file = SourceFile::new("f.glsl", format!("#version 450\n{text}\n"));
    Program::from_source(&file, Stage::Library, |_| Ok(Target::Function("f".to_owned()))).unwrap()
}

/// A batch of invocations without uniforms.
fn batch(program: &Program, invocations: &[f32]) -> Batch {
    Batch {
        invocation_record: Arc::new(program.invocation_record()),
        case_record: Arc::new(program.case_record()),
        per_case: 1,
        invocations: invocations.iter().map(|x| x.to_bits()).collect(),
        cases: Vec::new(),
    }
}

/// Runs the compute kernel of a program.
fn run(lane: &dyn Lane, program: &Program, batch: &Batch) -> Actual {
    let kernel = program.compute_kernel().unwrap();
    lane.prepare(&kernel, batch.invocation_count()).unwrap().run(batch).unwrap()
}

fn trace(probed: &Probed, actual: &Actual, invocation: usize) -> Trace<u32> {
    probed.trace(actual.vertex(invocation, 0)).unwrap()
}

/// Each step as the author's text and its values.
fn read(probed: &Probed, trace: &Trace<u32>) -> Vec<(String, Vec<f32>)> {
    let text = |point: usize| match &probed.points[point].what {
        What::Emitted { output } => format!("emit {output}"),
        What::EndPrimitive => "end".to_owned(),
        What::Operation | What::Comparison => probed.text(&probed.points[point]).to_owned(),
    };
    trace
        .steps
        .iter()
        .map(|step| (text(step.point), step.values.iter().map(|&w| f32::from_bits(w)).collect()))
        .collect()
}
