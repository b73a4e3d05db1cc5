//! Bounds of single operations beside what profiles accept of them.

use super::{Model, Tape};
use crate::profile::{Op, Profile, accept, by_name, grid};
use crate::single::{Inputs, kernel, measurable};
use base::value::Batch;
use program::interp::{self, FUEL, Machine, OutputColumn, SLOTS};
use program::lane::Stage;

/// Operations by definitions in which others stand that are defined so as well: what is accepted of those
/// is the interval around an interval, which is wider than what a device can reach.
const NESTED: [Op; 7] = [Op::Asin, Op::Acos, Op::Asinh, Op::Acosh, Op::Atanh, Op::Mod, Op::Fma];

/// Arguments of an operation, ordinary and special ones.
fn arguments(op: Op) -> Vec<Vec<u32>> {
    let inputs = Inputs::new(op);
    let arity = op.arity().unwrap();
    let plain = |k: u32| [0.999_9, -0.75, 1.000_1, 0.5][k as usize % 4] * (1.0 + (k as f32 * 0.37).sin() * 1e-3);
    let near_one = (0..256_u32).map(|k| (0..arity as u32).map(|j| plain(k + 5 * j).to_bits()).collect());
    (0..768).map(|k| inputs.at(k)[..arity].to_vec()).chain(near_one).collect()
}

/// Calls `f` with the arguments, the exact value and the bound of each run of an operation.
fn each_bound(op: Op, profile: &Profile, f: &mut dyn FnMut(&[f64], f64, f64)) {
    let kernel = kernel::in_stage(op, Stage::Compute).unwrap();
    let executable = interp::compile(&kernel.program).unwrap();
    let model = Model::Device { profile, stage: Stage::Compute, rearranged: false };
    let mut machine = Machine::new(&executable, Tape::new(model), FUEL);
    let name = kernel::result_name(Stage::Compute);
    let record = &kernel.output.vertex;
    let word = record.range(record.index_of(name).unwrap()).start;
    let arguments = arguments(op);
    let mut batch = Batch::with_capacity(kernel.invocation.clone(), kernel.case.clone(), 1, arguments.len());
    batch.invocations = arguments.concat();
    for (k, chunk) in arguments.chunks(SLOTS).enumerate() {
        machine.run(&batch, k * SLOTS);
        let OutputColumn::Real(&column) = machine.output(0, word) else { panic!("a number") };
        let bounds = machine.domain().bounds(column, &mut |_| false);
        let values = *machine.domain().values(column);
        for (slot, bits) in chunk.iter().enumerate() {
            let args: Vec<f64> = bits.iter().map(|&bits| f64::from(f32::from_bits(bits))).collect();
            f(&args, values[slot], bounds.bound[slot]);
        }
    }
}

#[test]
fn every_result_that_a_profile_accepts_is_within_the_bound() {
    let mut wrong = Vec::new();
    for name in ["vulkan-1.4", "vulkan-cts", "wgsl", "binary32"] {
        let profile = by_name(name).unwrap();
        for op in measurable().filter(|op| !NESTED.contains(op)) {
            let (mut ratio, mut worst, mut bounded) = (1.0, String::new(), 0);
            each_bound(op, profile, &mut |args, value, bound| {
                if !args.iter().all(|x| x.is_finite()) || !bound.is_finite() || !value.is_finite() {
                    return;
                }
                // A root at 0 is taken in its limit.
                let Ok(accepted) = accept(profile, op, args, Stage::Compute) else {
                    if (op, args) != (Op::Sqrt, &[0.0][..]) && !args.iter().any(|x| x.abs() < grid::MIN_NORMAL) {
                        wrong.push(format!("{name} {op:?} {args:?}: nothing is promised, the bound is {bound:e}"));
                    }
                    return;
                };
                bounded += 1;
                let off = (grid::down(accepted.hi) - value).max(value - grid::up(accepted.lo)).max(0.0);
                let part = off / (bound + 1e-13 * value.abs()).max(1e-300);
                if part > ratio {
                    (ratio, worst) = (part, format!("{args:?} = {value:e}: {accepted:?}, bound {bound:e}"));
                }
            });
            assert!(bounded > 200, "{name} {op:?}: {bounded}");
            if ratio > 1.0 {
                wrong.push(format!("{name} {op:?} {ratio}: {worst}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
