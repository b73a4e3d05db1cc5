//! A glance against tapes: the same values, never more than the bound, and nothing settled that a tape leaves open.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::super::Tape;
use super::super::tests::{THIRD, call, device};
use super::*;
use base::value::Batch;
use program::interp::{Executable, FUEL, Machine, OutputColumn};

/// Bodies of functions of three numbers: every operation of the interpreter, those that inherit from others among them.
const BODIES: [&str; 34] = [
    "return x * y + z;",
    "return (x + y) * (x - z);",
    "return sin(x) * y - cos(x * z);",
    "return pow(abs(x) + 0.5, y) / (1.0 + z * z);",
    "return pow(x * x, y) - pow(abs(z), 2.5);",
    "return sqrt(abs(x * y)) + inversesqrt(z * z + 0.25) * x;",
    "float s = x * y; return s * s - s * z;",
    "return x > y ? exp(x * z) : log2(abs(y) + 1.0);",
    "return mix(x, y, clamp(z, 0.0, 1.0)) - min(x * y, z);",
    "float s = 0.0; for (int i = 0; i < 5; ++i) s = s * x + y; return s / z;",
    "float s = 0.0; for (int i = 0; i < int(abs(x)); ++i) { s += y; if (s > z) break; s = s * 1.25 + x; } return s;",
    "return fract(x * 7.0) + floor(y * z) - mod(x, abs(y) + 0.1);",
    "vec3 v = normalize(vec3(x, y, z)); return dot(v, vec3(z, x, y));",
    "return atan(x, y) + tan(x * 0.5) + smoothstep(0.0, 1.0, z);",
    "return asin(x) + acos(y * 0.5) - atan(z);",
    "return sinh(x) - cosh(y) + tanh(z);",
    "return asinh(x) + acosh(abs(y) + 1.0) - atanh(z * 0.125);",
    "return radians(x) - degrees(y) + sign(z) * trunc(x) + round(y) - ceil(z) + roundEven(x * y);",
    "return step(x, y) - faceforward(vec2(x, y), vec2(y, z), vec2(z, x)).x;",
    "return length(vec3(x, y, z)) - distance(vec2(x, y), vec2(y, z));",
    "return reflect(vec2(x, y), normalize(vec2(y, z + 3.0))).y + refract(vec2(0.6, 0.8), vec2(x, y), 0.5).x;",
    "return exp2(x) - log(abs(y) + 0.25) + exp(-z * z);",
    "return float(int(x)) + float(uint(abs(y))) * z;",
    "return uintBitsToFloat(floatBitsToUint(x) ^ 0x80000000u) * y + intBitsToFloat(floatBitsToInt(z));",
    "mat2 m = mat2(x, y, z, 1.5); vec2 v = m * vec2(y, z) * m; return v.x + v.y + determinant(m);",
    "return inverse(mat2(x, y, z, 1.5))[0].y;",
    "return max(x, 0.0) * min(y, z) + abs(x - y) - -z;",
    "float a[3] = float[3](x, y, z); return a[int(abs(x)) % 3] * a[1] + a[2];",
    "return isnan(x / y) ? z : isinf(y) ? x : y;",
    "float s = x; do { s = s * 0.5 + sin(s); } while (abs(s) > 1.0); return s * y;",
    "return 1.0 / (x - y) + z / (x * x + y * y);",
    "return (x * 1e30) * (y * 1e-30) + z;",
    "return ldexp(x, int(y)) + z;",
    "return 0.1 * x + 0.7 * y - 3.14159265 * z;",
];

const PROFILES: [&str; 4] = ["vulkan-1.4", "wgsl", "glsl-4.60", "binary32"];

/// A batch of calls with arguments of every kind.
fn calls(body: &str, kind: usize) -> (Executable, Batch) {
    let numbers =
        [0.0_f32, -0.0, 1e-40, -1e-19, THIRD, -0.75, 0.99999, 1.0, 2.5, 3.5, -7.25, 1e19, 3e38, f32::NAN, 0.1];
    let (executable, mut batch) = call(&format!("float f(float x, float y, float z) {{ {body} }}"), &[0.0; 3]);
    // Ordinary numbers, so that a chunk is not lost as a whole; every number there is; and some of them among others.
    let ordinary = |k: usize| ((k * 37 + 11) % 101) as f32 / 23.0 - 1.7;
    let arguments = (0..3 * SLOTS).map(|k| match (kind, k % 7) {
        (0, _) => ordinary(k),
        (1, _) | (_, 3) => numbers[(k * (2 * (k % 3) + 3) + k / 7) % numbers.len()],
        _ => ordinary(k),
    });
    batch.invocations = arguments.map(f32::to_bits).collect();
    (executable, Batch { invocation_record: Arc::clone(&batch.invocation_record), ..batch })
}

#[test]
fn a_glance_never_allows_more_than_the_bound_and_has_the_values_of_a_tape() {
    for profile in PROFILES {
        let (mut known, mut looked, mut given_up) = (0, 0, BTreeSet::new());
        for body in BODIES {
            for kind in 0..3 {
                let (executable, batch) = calls(body, kind);
                let model = device(profile, false);
                let Some(glance) = Glance::new(model, &[]) else { panic!("{profile}") };
                let mut glance = Machine::new(&executable, glance, FUEL);
                let mut moving = Machine::new(&executable, Tape::new(model).with_tangents(), FUEL);
                let mut whole = Machine::new(&executable, Tape::new(model), FUEL);
                // A second run finds what the first one left.
                for _ in 0..2 {
                    glance.run(&batch, 0);
                    moving.run(&batch, 0);
                }
                whole.run(&batch, 0);
                let columns = (glance.output(0, 0), moving.output(0, 0), whole.output(0, 0));
                let (OutputColumn::Real(&seen), OutputColumn::Real(&moved), OutputColumn::Real(&column)) = columns
                else {
                    panic!("a real number")
                };
                let domain = glance.as_domain();
                if domain.has_given_up() {
                    given_up.insert(body);
                    continue;
                }
                let (values, of_tape) = (domain.values(seen), moving.as_domain().values(moved));
                let (allowance, of_moving) = (domain.allowance(seen), moving.as_domain().allowance(moved));
                let (open, of_moving_open) = (domain.unpromised(seen), moving.as_domain().unpromised(moved));
                let (own, radii) = (domain.radii_of(domain.id(&seen)), moving.as_domain().radii(moved));
                let bounds = whole.domain().bounds(column, &mut |_| false).bound;
                for slot in 0..SLOTS {
                    let at = format!("{profile} {body} {kind} {slot}");
                    let flags = glance.flags()[slot];
                    assert_eq!(flags.is_undefined(), moving.flags()[slot].is_undefined(), "{at}");
                    assert_eq!(
                        values[slot].to_bits(),
                        of_tape[slot].to_bits(),
                        "{at}: {} {}",
                        values[slot],
                        of_tape[slot]
                    );
                    assert!(!open.has(slot) || of_moving_open.has(slot), "{at}: open");
                    looked += 1;
                    if allowance[slot].is_nan() {
                        continue;
                    }
                    known += 1;
                    assert!(!of_moving[slot].is_nan(), "{at}: a tape knows nothing");
                    assert!(allowance[slot] <= bounds[slot], "{at}: {:e} {:e}", allowance[slot], bounds[slot]);
                    assert!(
                        own[slot] >= radii[slot] || values[slot].is_nan(),
                        "{at}: {:e} {:e}",
                        own[slot],
                        radii[slot]
                    );
                }
            }
        }
        assert!(2 * known > looked, "{profile}: {known} of {looked}");
        assert!(given_up.len() <= 2, "{profile}: {given_up:?}");
    }
}

#[test]
fn sets_of_operations_may_seem_to_meet_and_never_seem_apart() {
    let set = |numbers: &[usize]| {
        let mut set = Sources::default();
        numbers.iter().for_each(|&number| set.insert(number));
        set
    };
    assert!(!set(&[0, 64, 700]).meets(&set(&[1, 65, 701])));
    for number in [0, 63, 64, 1023, 1024, 5000] {
        assert!(set(&[3, number]).meets(&set(&[number, 9])));
        assert!(set(&[3]).or(&set(&[number])).meets(&set(&[number])));
    }
}

/// Of a product of a matrix with a vector that a matrix gave, no component shares an operation with another: nothing cancels.
#[test]
fn errors_that_have_nothing_in_common_do_not_cancel() {
    let body = "mat2 m = mat2(x, y, z, 1.5); vec2 v = mat2(x, z, y, 0.3) * vec2(0.7, x); return (m * v).x;";
    let (executable, batch) = calls(body, 0);
    let model = device("vulkan-1.4", false);
    let mut glance = Machine::new(&executable, Glance::new(model, &[]).unwrap(), FUEL);
    let mut whole = Machine::new(&executable, Tape::new(model), FUEL);
    glance.run(&batch, 0);
    whole.run(&batch, 0);
    let (OutputColumn::Real(&seen), OutputColumn::Real(&column)) = (glance.output(0, 0), whole.output(0, 0)) else {
        panic!("a real number")
    };
    let allowance = glance.as_domain().allowance(seen);
    let bounds = whole.domain().bounds(column, &mut |_| false).bound;
    let mean = (0..SLOTS).map(|slot| allowance[slot] / bounds[slot]).sum::<f64>() / SLOTS as f64;
    assert!(mean > 0.95, "{mean}");
    let moved = glance.as_domain().moved.get(seen.0 as usize);
    let cancelled = (0..SLOTS).filter(|&slot| moved[slot].abs() < 0.5 * bounds[slot]).count();
    assert!(cancelled > 8, "{cancelled}: by one choice of signs for all components some cancel");
}

/// Registers outlive their chunk: what they held before neither widens what comes after nor ties it together.
#[test]
fn a_chunk_is_seen_as_if_it_were_the_first() {
    let body =
        "float a[3] = float[3](x, y, z); float s = a[int(abs(x)) % 3]; if (y > z) s = s * y + a[1]; return s * z;";
    let (executable, batch) = calls(body, 0);
    let (_, wide) = calls(body, 2);
    let model = device("vulkan-1.4", false);
    let seen = |before: usize| {
        let mut machine = Machine::new(&executable, Glance::new(model, &[]).unwrap(), FUEL);
        for _ in 0..before {
            machine.run(&wide, 0);
        }
        machine.run(&batch, 0);
        let OutputColumn::Real(&column) = machine.output(0, 0) else { panic!("a real number") };
        let domain = machine.as_domain();
        let node = domain.nodes[domain.id(&column) as usize];
        (domain.allowance(column).map(f64::to_bits), node.most, node.radius, domain.lost)
    };
    assert_eq!(seen(0), seen(3));
}
