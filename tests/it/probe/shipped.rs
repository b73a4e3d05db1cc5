//! Probed programs of the shipped suites.

use base::text::SourceFile;
use base::value::Batch;
use engine::suite::run::{Prepared, prepare};
use engine::suite::{find, parse, shipped};
use lanes::{Actual, Lane, LaneError};
use program::probe::{Step, What};
use program::{Kernel, Probed};
use property::Sampler;

use super::{driver, embedded_lane, read, run, trace};

const WORDS: u32 = 2048;

fn prepared(name: &str) -> Prepared {
    let shipped = find(name).unwrap();
    let suite = parse(&SourceFile::new(shipped.path, shipped.toml)).unwrap();
    prepare(&suite, &SourceFile::new(shipped.shader_name, shipped.shader_text)).unwrap()
}

fn samples(prepared: &Prepared, invocations: usize) -> Batch {
    let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
    Sampler::new(prepared.plan.clone(), 7).batch(0, invocations.div_ceil(per_case), per_case)
}

fn run_kernel(lane: &dyn Lane, kernel: &Kernel, batch: &Batch) -> Result<Actual, LaneError> {
    lane.prepare(kernel, batch.invocation_count())?.run(batch)
}

/// The ordinary outputs of an invocation of a probed program; for a geometry stage, what its trace
/// holds of the vertices that were emitted.
fn outputs(probed: &Probed, actual: &Actual, invocation: usize) -> Vec<u32> {
    let trace = trace(probed, actual, invocation);
    assert!(!trace.cut);
    let is_emitted = |step: &&Step<u32>| matches!(probed.points[step.point].what, What::Emitted { .. });
    if probed.points.iter().any(|point| point.what == What::EndPrimitive) {
        return trace.steps.iter().filter(is_emitted).flat_map(|step| step.values.clone()).collect();
    }
    let words = actual.vertex(invocation, 0);
    words[..words.len() - WORDS as usize - 1].to_vec()
}

/// The outputs of an invocation of a program that was not probed.
fn of_vertices(actual: &Actual, invocation: usize) -> Vec<u32> {
    (0..actual.stored(invocation)).flat_map(|vertex| actual.vertex(invocation, vertex).to_vec()).collect()
}

#[test]
fn probing_changes_no_output() {
    for suite in shipped() {
        let prepared = prepared(suite.name);
        let batch = samples(&prepared, 300);
        assert!(batch.invocation_count() >= 300);
        let probed = prepared.program.probed(WORDS).unwrap();
        let lane = embedded_lane();
        let plain = run(&*lane, &prepared.program, &batch);
        let with = run(&*lane, &probed.program, &batch);
        assert_eq!(plain.count(), with.count());
        for invocation in 0..plain.count() {
            let own = of_vertices(&plain, invocation);
            assert!(!own.is_empty());
            assert_eq!(own, outputs(&probed, &with, invocation), "{} {invocation}", suite.name);
        }
        for invocation in [0, batch.invocation_count() - 1] {
            let trace = trace(&probed, &with, invocation);
            assert!(!trace.cut && !trace.steps.is_empty(), "{}: {} words", suite.name, trace.words);
        }
    }
}

/// Steps of the traces of two lanes: all, those that are near, those that are the same to the bit.
fn compare(probed: &Probed, embedded: &Actual, driven: &Actual) -> [usize; 3] {
    let (mut all, mut near, mut same) = (0, 0, 0);
    for invocation in 0..embedded.count() {
        let (a, b) = (trace(probed, embedded, invocation), trace(probed, driven, invocation));
        assert!(!b.cut);
        assert_eq!(a.first_difference(&b, |_, _| true), None, "invocation {invocation} takes another way");
        for (a, b) in a.steps.iter().zip(&b.steps) {
            all += 1;
            near += usize::from(agree(a, b));
            same += usize::from(a == b);
        }
    }
    [all, near, same]
}

/// Near at the scale of everything in the step.
fn agree(a: &Step<u32>, b: &Step<u32>) -> bool {
    let number = |&word: &u32| f32::from_bits(word);
    let size = a.values.iter().chain(&a.leaves).map(number).fold(0.0_f32, |m, x| m.max(x.abs()));
    let pairs = a.values.iter().map(number).zip(b.values.iter().map(number));
    pairs.into_iter().all(|(x, y)| x.to_bits() == y.to_bits() || (x - y).abs() <= 1e-4 * size)
}

#[test]
fn a_driver_and_the_embedded_lane_trace_nearly_the_same() {
    let lane = driver();
    let mut report = Vec::new();
    for suite in shipped() {
        let prepared = prepared(suite.name);
        let batch = samples(&prepared, 64);
        let probed = prepared.program.probed(WORDS).unwrap();
        let mut kernels = vec![probed.program.compute_kernel().unwrap()];
        if prepared.vertex.is_some() {
            let inputs = probed.program.inputs.iter();
            let components: Vec<u8> =
                inputs.map(|p| prepared.suite.components(&p.field.name).unwrap_or(p.field.shape.rows)).collect();
            kernels.push(probed.program.vertex_kernel(&components).unwrap());
        }
        let embedded = run_kernel(&*embedded_lane(), &kernels[0], &batch).unwrap();
        for kernel in &kernels {
            let driven = run_kernel(&*lane, kernel, &batch).unwrap();
            report.push((suite.name, compare(&probed, &embedded, &driven)));
        }
    }
    for (name, [all, near, same]) in &report {
        // Built-in functions differ in their last bits, and what is computed from them.
        assert!(near == all && *same > 0, "{name}: {report:?}");
    }
}

#[test]
fn the_trace_of_a_primitive_spans_its_vertices() {
    let prepared = prepared("hair");
    let batch = samples(&prepared, 8);
    let probed = prepared.program.probed(WORDS).unwrap();
    let actual = run(&*embedded_lane(), &probed.program, &batch);
    let plain = run(&*embedded_lane(), &prepared.program, &batch);
    let steps = read(&probed, &trace(&probed, &actual, 0));
    let count = |text: &str| steps.iter().filter(|(t, _)| t == text).count() as u32;
    assert_eq!((count("emit gl_Position"), count("end")), (plain.emitted(0), plain.ended_strips(0)));
    // What is computed for the second vertex stands behind the first.
    let first = steps.iter().position(|(t, _)| t == "emit gl_Position").unwrap();
    let last = steps.iter().rposition(|(t, _)| t == "emit gl_Position").unwrap();
    assert!(steps[first + 1..last].iter().any(|(t, _)| !t.starts_with("emit")));
}

#[test]
fn every_point_of_a_shipped_shader_has_a_text_and_a_place() {
    for suite in shipped() {
        let prepared = prepared(suite.name);
        let probed = prepared.program.probed(WORDS).unwrap();
        let points = probed.points.iter().filter(|p| p.expression.is_some());
        for point in points {
            let text = probed.text(point);
            assert!(!text.is_empty() && !text.contains(';'), "{}: {point:?} `{text}`", suite.name);
            assert!(probed.locate(point).starts_with(suite.shader_name));
        }
    }
}
