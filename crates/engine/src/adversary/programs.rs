//! Programs on the device.

use super::{Adversary, AdversaryLane, Fault, Strategy};
use base::text::SourceFile;
use base::value::Batch;
use judge::profile::{Op, Profile, accept, by_name, grid, parse};
use lanes::{Lane, LaneError, Stage};
use program::interp::Laws;
use program::lower::Target;
use program::{Kernel, Program};

/// The function `f` of a text.
fn kernel(text: &str) -> Kernel {
    let file = SourceFile::new("f.glsl", format!("#version 450\n{text}\n"));
    let program =
        Program::from_source(&file, syntax::Stage::Library, |_| Ok(Target::Function("f".to_owned()))).unwrap();
    program.compute_kernel().unwrap()
}

/// The first output word of each row of arguments.
fn results(lane: &AdversaryLane, kernel: &Kernel, rows: &[Vec<f32>]) -> Vec<f32> {
    let mut batch = Batch::with_capacity(kernel.invocation.clone(), kernel.case.clone(), 1, rows.len());
    batch.invocations = rows.concat().into_iter().map(f32::to_bits).collect();
    let actual = lane.prepare(kernel, rows.len()).unwrap().run(&batch).unwrap();
    (0..rows.len()).map(|k| f32::from_bits(actual.vertex(k, 0)[0])).collect()
}

fn lane(profile: &Profile, strategy: Strategy, seed: u64) -> AdversaryLane {
    Adversary::lane(profile, Stage::Compute, strategy, seed, false)
}

fn vulkan() -> &'static Profile {
    by_name("vulkan-1.4").unwrap()
}

/// Results of one row with many seeds.
fn over_seeds(profile: &Profile, strategy: Strategy, text: &str, row: &[f32]) -> Vec<f32> {
    let kernel = kernel(text);
    (0..300).map(|seed| results(&lane(profile, strategy, seed), &kernel, &[row.to_vec()])[0]).collect()
}

#[test]
fn a_product_and_a_sum_are_fused_where_that_is_allowed() {
    // (1 + 2^-12)² − (1 + 2^-11) is 2^-24 in one rounding, and 0 or 2^-23 in two.
    let row = [1.0 + 2f32.powi(-12), 1.0 + 2f32.powi(-11)];
    let alone = "name = \"mine\"\nextends = \"vulkan-1.4\"\ncontraction = \"never\"\n";
    let forbidden = parse(&SourceFile::new("p.toml", alone), &|name| by_name(name).cloned()).unwrap();
    for text in [
        "float f(float x, float y) { return x * x - y; }",
        "float f(float x, float y) { float p = x * x; p = p; return -y + p; }",
        "float f(float x, float y) { return -(y - x * x); }",
        "float f(float x, float y) { return -(-(x * x)) - y; }",
        "float f(float x, float y) { return fma(x, x, -y); }",
    ] {
        for (profile, allowed) in [(vulkan(), true), (&forbidden, false)] {
            let found = over_seeds(profile, Strategy::Extreme, text, &row);
            let fused = found.iter().filter(|&&y| y == 2f32.powi(-24)).count();
            let apart = found.iter().filter(|&&y| y == 0.0 || y == 2f32.powi(-23)).count();
            assert_eq!(fused + apart, found.len(), "{text}");
            assert!(apart > 50 && (fused > 50) == allowed && (fused == 0) != allowed, "{text}: {fused}");
        }
    }
}

#[test]
fn a_product_that_a_branch_replaced_is_not_fused() {
    let text = "float f(float x, float y, float s) { float p = x * x; if (s > 0.0) { p = 3.0; } return p - y; }";
    let (x, y) = (1.0 + 2f32.powi(-12), 1.0 + 2f32.powi(-11));
    let kernel = kernel(text);
    let rows: Vec<Vec<f32>> = (0..400).map(|k| vec![x, y, if k % 2 == 0 { 1.0 } else { -1.0 }]).collect();
    let mut fused = [0, 0];
    for seed in 0..50 {
        let found = results(&lane(vulkan(), Strategy::Extreme, seed), &kernel, &rows);
        (0..400).for_each(|k| fused[k % 2] += usize::from(found[k] == 2f32.powi(-24)));
        assert!((0..400).step_by(2).all(|k| (f64::from(found[k]) - (3.0 - f64::from(y))).abs() < 1e-6));
    }
    assert!(fused[0] == 0 && fused[1] > 0, "{fused:?}");
}

#[test]
fn normalize_follows_the_definition_of_the_profile() {
    let text = "float f(float x, float y, float z) { return normalize(vec3(x, y, z)).x; }";
    // 3² + 4² and its parts are exact.
    let row = [3.0, 4.0, 0.0];
    let hull = |name: &str| {
        let found = over_seeds(by_name(name).unwrap(), Strategy::Extreme, text, &row);
        let least = found.iter().copied().fold(f32::INFINITY, f32::min);
        (f64::from(least), f64::from(found.iter().copied().fold(0.0, f32::max)))
    };
    let at = |op, args: &[f64], name| accept(by_name(name).unwrap(), op, args, Stage::Compute).unwrap();
    let scale = at(Op::InverseSqrt, &[25.0], "vulkan-1.4");
    let ends = (grid::down(3.0 * grid::up(scale.lo)), grid::up(3.0 * grid::down(scale.hi)));
    assert_eq!(hull("vulkan-1.4"), ends);
    let length = at(Op::Sqrt, &[25.0], "wgsl");
    let ends = [grid::down(length.hi), grid::up(length.lo)].map(|length| at(Op::Div, &[3.0, length], "wgsl"));
    assert_eq!(hull("wgsl"), (grid::up(ends[0].lo), grid::down(ends[1].hi)));
    assert_eq!(hull("glsl-4.60"), hull("wgsl"));
    assert!(hull("wgsl").1 > hull("vulkan-1.4").1);
}

#[test]
fn a_sample_has_one_result_wherever_it_stands() {
    let text = "float f(float x, float y) { float s = 0.0; for (int i = 0; i < 3; ++i) { if (x > y) s += sin(x) * y; \
                s -= exp(y) / x; } return s; }";
    let kernel = kernel(text);
    let rows: Vec<Vec<f32>> = (0..700).map(|k| vec![0.5 + k as f32 / 700.0, 1.0 + (k % 13) as f32 / 64.0]).collect();
    let reversed: Vec<Vec<f32>> = rows.iter().rev().cloned().collect();
    for strategy in Strategy::ALL {
        let lane = lane(vulkan(), strategy, 3);
        let forth = results(&lane, &kernel, &rows);
        let mut back = results(&lane, &kernel, &reversed);
        back.reverse();
        assert_eq!(forth, back, "{strategy:?}");
        assert_eq!(forth[17], results(&lane, &kernel, &rows[17..18])[0]);
    }
}

#[test]
fn comparisons_may_see_a_subnormal_number_as_zero() {
    let text = "float f(float x) { return x > 0.0 ? 1.0 : 0.0; }";
    let seen = |x: f32| over_seeds(vulkan(), Strategy::Random, text, &[x]).iter().filter(|&&y| y == 1.0).count();
    assert_eq!((seen(1.0), seen(-1.0), seen(f32::MIN_POSITIVE)), (300, 0, 300));
    assert!((100..200).contains(&seen(1e-40)));
}

#[test]
fn functions_without_a_promise_give_anything() {
    let text = "float f(float a, float b, float c, float d) { return determinant(mat2(a, b, c, d)); }";
    let found = over_seeds(vulkan(), Strategy::Random, text, &[1.0, 2.0, 3.0, 4.0]);
    assert!(
        found.iter().any(|y| y.is_nan()) && found.iter().any(|y| *y == -2.0) && found.iter().any(|y| y.abs() > 1e9)
    );
}

#[test]
fn a_planted_fault_shows_in_the_program() {
    let kernel = kernel("float f(float x) { return sin(x); }");
    let rows: Vec<Vec<f32>> = (0..500).map(|k| vec![k as f32 / 250.0]).collect();
    let worst = |lane: &AdversaryLane| {
        let found = results(lane, &kernel, &rows);
        let error = |(row, y): (&Vec<f32>, &f32)| (f64::from(*y) - f64::from(row[0]).sin()).abs();
        rows.iter().zip(&found).map(error).fold(0.0, f64::max)
    };
    let good = lane(vulkan(), Strategy::Extreme, 1);
    let promise = 2f64.powi(-11);
    assert!((0.9 * promise..=promise).contains(&worst(&good)));
    let faulty = worst(&good.clone().with_fault(Fault { op: Op::Sin, factor: 2.0 }));
    assert!((2.0 * promise..2.001 * promise).contains(&faulty));
    assert_eq!(worst(&good.clone().with_fault(Fault { op: Op::Cos, factor: 2.0 })), worst(&good));
}

#[test]
fn rearranged_sums_differ_and_a_profile_can_forbid_them() {
    let text = "float f(float a, float b, float c, float d, float e) { return (a + b + c) * d + e * d; }";
    let kernel = kernel(text);
    let rows: Vec<Vec<f32>> =
        (0..300).map(|k| (1..6).map(|j| ((k * j) as f32 * 0.37).sin() + j as f32).collect()).collect();
    let strict = "name = \"mine\"\nextends = \"vulkan-1.4\"\nrounding = \"nearest-even\"\ncontraction = \"never\"\n";
    let profile = |more: &str| {
        parse(&SourceFile::new("p.toml", format!("{strict}{more}")), &|name| by_name(name).cloned()).unwrap()
    };
    let run = |profile: &Profile, seed, rearrange| {
        let lane = Adversary::lane(profile, Stage::Compute, Strategy::Random, seed, rearrange);
        results(&lane, &kernel, &rows)
    };
    let (free, bound) = (profile(""), profile("rearrangement = \"never\"\n"));
    // With one rounding nothing but the order is left to choose.
    let original = run(&free, 0, false);
    assert!((0..10).any(|seed| run(&free, seed, true) != original));
    assert!((0..10).all(|seed| run(&bound, seed, true) == original));
    let near = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-4;
    assert!((0..10).all(|seed| run(&free, seed, true).iter().zip(&original).all(near)));
    let order = |seed| lane(&bound, Strategy::Random, seed).with_laws(Laws::Order);
    assert!((0..10).any(|seed| results(&order(seed), &kernel, &rows) != original));
}

#[test]
fn a_batch_beyond_the_capacity_is_refused() {
    let kernel = kernel("float f(float x) { return x; }");
    let mut batch = Batch::with_capacity(kernel.invocation.clone(), kernel.case.clone(), 1, 2);
    batch.invocations = vec![0, 0];
    let mut runner = lane(vulkan(), Strategy::Random, 0).prepare(&kernel, 1).unwrap();
    assert!(matches!(runner.run(&batch), Err(LaneError::Unsupported(_))));
    assert_eq!(runner.capacity(), 1);
}
