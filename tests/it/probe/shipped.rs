//! Probed programs of the shipped suites.

use shadercheck::lane::{Actual, Lane, LaneError};
use shadercheck::program::probe::{Step, What};
use shadercheck::program::{Kernel, Probed};
use shadercheck::property::Sampler;
use shadercheck::suite::run::{Prepared, prepare};
use shadercheck::suite::{find, parse, shipped};
use shadercheck::text::SourceFile;
use shadercheck::value::Batch;

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

/// The float outputs of the vertices that a primitive emitted, from its trace.
fn emitted(probed: &Probed, actual: &Actual, invocation: usize) -> Vec<u32> {
    let trace = trace(probed, actual, invocation);
    assert!(!trace.cut);
    let emits = |step: &&Step<u32>| matches!(probed.points[step.point].what, What::Emitted { .. });
    trace.steps.iter().filter(emits).flat_map(|step| step.values.clone()).collect()
}

fn assert_same_outputs(prepared: &Prepared, probed: &Probed, plain: &Actual, with: &Actual) {
    let name = &prepared.suite.name;
    assert_eq!(plain.count(), with.count());
    let geometry = plain.layout().max_vertices.is_some();
    for invocation in 0..plain.count() {
        if geometry {
            let own: Vec<u32> =
                (0..plain.stored(invocation)).flat_map(|v| plain.vertex(invocation, v).to_vec()).collect();
            assert_eq!(own, emitted(probed, with, invocation), "{name} {invocation}");
        } else {
            let own = plain.vertex(invocation, 0);
            assert_eq!(own, &with.vertex(invocation, 0)[..own.len()], "{name} {invocation}");
        }
    }
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
        assert_same_outputs(&prepared, &probed, &plain, &with);
        for invocation in [0, batch.invocation_count() - 1] {
            let trace = trace(&probed, &with, invocation);
            assert!(!trace.cut && !trace.steps.is_empty(), "{}: {} words", suite.name, trace.words);
        }
    }
}

/// On a driver that reorders nothing, most steps are the same to the bit and the others near.
#[test]
fn a_driver_and_the_embedded_lane_trace_nearly_the_same() {
    let lane = driver();
    for suite in shipped() {
        let prepared = prepared(suite.name);
        let batch = samples(&prepared, 64);
        let probed = prepared.program.probed(WORDS).unwrap();
        let compute = probed.program.compute_kernel().unwrap();
        let mut kernels = vec![compute];
        if prepared.vertex.is_some() {
            let inputs = probed.program.inputs.iter();
            let components: Vec<u8> =
                inputs.map(|p| prepared.suite.components(&p.field.name).unwrap_or(p.field.shape.rows)).collect();
            kernels.push(probed.program.vertex_kernel(&components).unwrap());
        }
        let embedded = run_kernel(&*embedded_lane(), &kernels[0], &batch).unwrap();
        for kernel in &kernels {
            let driven = run_kernel(&*lane, kernel, &batch).unwrap();
            let (mut near, mut all) = (0, 0);
            for invocation in 0..batch.invocation_count() {
                let (a, b) = (trace(&probed, &embedded, invocation), trace(&probed, &driven, invocation));
                assert!(!b.cut);
                for (a, b) in a.steps.iter().zip(&b.steps).take_while(|(a, b)| a.point == b.point) {
                    all += 1;
                    near += usize::from(agree(a, b));
                }
            }
            assert!(all >= batch.invocation_count());
            assert!(near as f64 > 0.97 * f64::from(all as u32), "{}: {near} of {all}", suite.name);
        }
    }
}

fn agree(a: &Step<u32>, b: &Step<u32>) -> bool {
    let number = |&word: &u32| f32::from_bits(word);
    let size = a.values.iter().chain(&a.leaves).map(number).fold(0.0_f32, |m, x| m.max(x.abs()));
    a.values
        .iter()
        .map(number)
        .zip(b.values.iter().map(number))
        .all(|(x, y)| x.to_bits() == y.to_bits() || (x - y).abs() <= 1e-4 * size.max(x.abs()))
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
