use super::*;
use base::text::SourceFile;
use judge::profile::{Acceptance, Flush, Op, Profile, accept, by_name, grid, parse};
use lanes::Stage;
use property::Stream;

const SAMPLES: usize = 10_000;

/// Promises that leave room for errors of several gaps, which a half and a double of them tell apart.
fn profiles() -> impl Iterator<Item = &'static Profile> {
    ["vulkan-1.4", "vulkan-cts", "wgsl", "glsl-4.60"].into_iter().filter_map(by_name)
}

fn operations() -> impl Iterator<Item = (Op, usize)> {
    Op::ALL.into_iter().filter_map(|op| Some((op, op.arity()?)))
}

const SPECIAL: [f32; 24] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    2.0,
    3.0,
    -7.5,
    std::f32::consts::PI,
    std::f32::consts::FRAC_PI_2,
    0.999_999_94,
    1.000_000_1,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1e-40,
    -1e-45,
    f32::MAX,
    f32::MIN,
    1e30,
    -16_777_217.0,
    88.7,
    f32::INFINITY,
    f32::NEG_INFINITY,
];

/// A special number, one of any exponent, or one of moderate size, where most functions live.
fn operand(stream: &mut Stream) -> f64 {
    f64::from(match stream.below(8) {
        0 => SPECIAL[stream.below(SPECIAL.len())],
        1 => f32::from_bits(stream.bits() as u32),
        2 | 3 => stream.between(-1.0, 1.0) as f32,
        4 => stream.between(0.0, 2.0) as f32,
        _ => (stream.between(-1.0, 1.0) * 2f64.powi(stream.below(14) as i32 - 6)) as f32,
    })
}

fn operands(op: Op, arity: usize) -> impl Iterator<Item = Vec<f64>> {
    let mut stream = Stream::new(op as u64);
    (0..SAMPLES).map(move |_| (0..arity).map(|_| operand(&mut stream)).collect())
}

fn place(k: usize) -> Place {
    Place { site: k % 97, invocation: (k / 97) as u64 }
}

fn device(profile: &Profile, strategy: Strategy) -> Device {
    Device::new(profile, Stage::Compute, strategy, 42)
}

/// Results of one device, and how many of them the profile accepts, promises nothing for, and refuses.
#[derive(Default)]
struct Tally {
    accepted: usize,
    free: usize,
    refused: Vec<String>,
    /// The largest part of the allowed error that was used.
    reach: f64,
    /// Operands for which there is a number near an end of what is accepted, beside the exact value.
    roomy: usize,
}

fn tally(device: &Device, op: Op, arity: usize) -> Tally {
    let mut tally = Tally::default();
    for (k, args) in operands(op, arity).enumerate() {
        let found = f64::from(device.apply(op, &args, place(k)));
        let Ok(interval) = accept(device.profile(), op, &args, Stage::Compute) else {
            tally.free += 1;
            continue;
        };
        if !interval.contains(found) {
            tally.refused.push(format!("{op:?}{args:?}: {found:e} is not in {interval:?}"));
            continue;
        }
        tally.accepted += 1;
        let exact = op.exact(&args);
        let (below, above) = (exact - interval.lo, interval.hi - exact);
        let ends = [exact - grid::up(interval.lo), grid::down(interval.hi) - exact];
        for ((room, error), end) in [(below, exact - found), (above, found - exact)].into_iter().zip(ends) {
            if room > 0.0 && room.is_finite() {
                tally.reach = tally.reach.max(error / room);
                tally.roomy += usize::from(end >= 0.9 * room);
            }
        }
    }
    tally
}

#[test]
fn every_result_is_accepted_and_the_worst_is_near_the_limit() {
    let mut tame = Vec::new();
    for profile in profiles() {
        for (op, arity) in operations() {
            for strategy in [Strategy::Random, Strategy::Extreme, Strategy::Mixed] {
                let tally = tally(&device(profile, strategy), op, arity);
                let what = format!("{} {op:?} {strategy:?}", profile.name);
                assert!(tally.refused.is_empty(), "{what}: {:?}", &tally.refused[..tally.refused.len().min(3)]);
                assert_eq!(tally.accepted + tally.free, SAMPLES);
                // GLSL promises nothing for angles; everywhere else enough is judged.
                assert!(tally.accepted > SAMPLES / 20 || tally.free == SAMPLES, "{what}: {}", tally.accepted);
                assert!(tally.free < SAMPLES || profile.name == "glsl-4.60", "{what}");
                // Integers are exact but for flushes, which these need luck to meet.
                let rigid = matches!(op, Op::Step | Op::Trunc | Op::RoundEven) || tally.free == SAMPLES;
                if !rigid && (tally.roomy < 10 || tally.reach < 0.9) {
                    tame.push(format!("{what}: {} of {}", tally.reach, tally.roomy));
                }
            }
        }
    }
    assert_eq!(tame, Vec::<String>::new());
}

#[test]
fn a_fault_of_twice_the_promise_is_outside_and_one_of_half_is_not() {
    let mut missed = Vec::new();
    for profile in profiles() {
        let mut keeping = profile.clone();
        keeping.compute = Flush::Never;
        for (op, arity) in operations() {
            let base = device(profile, Strategy::Extreme);
            let with = |factor| base.clone().with_fault(Fault { op, factor });
            let (double, half) = (with(2.0), with(0.5));
            let (mut outside, mut inside, mut errors) = (0, 0, 0);
            for (k, args) in operands(op, arity).enumerate() {
                let accepted = accept(profile, op, &args, Stage::Compute);
                let Ok(interval) = accepted else { continue };
                let exact = op.exact(&args);
                // Away from zero and infinity, where a flush and an overflow widen what is accepted.
                let normal = |x: f64| x.abs() >= 4.0 * grid::MIN_NORMAL && x.abs() < 1e38;
                let room = (interval.hi - exact).max(exact - interval.lo);
                let subnormal = |x: &f64| *x != 0.0 && x.abs() < grid::MIN_NORMAL;
                // A flush on the way widens what is accepted as well.
                let flushes = accept(&keeping, op, &args, Stage::Compute) != accepted;
                if flushes
                    || args.iter().any(subnormal)
                    || !normal(interval.lo)
                    || !normal(interval.hi)
                    || room <= 0.0
                    || interval.contains(0.0)
                {
                    continue;
                }
                errors += 1;
                outside += usize::from(!interval.contains(f64::from(double.apply(op, &args, place(k)))));
                inside += usize::from(interval.contains(f64::from(half.apply(op, &args, place(k)))));
            }
            let what = format!("{} {op:?}: {errors}", profile.name);
            // Half an error may be rounded up to more than a whole one where that is a gap.
            if outside != errors || inside * 2 < errors {
                missed.push(format!("{what}: {outside} outside, {inside} inside"));
            }
            let other =
                base.clone().with_fault(Fault { op: if op == Op::Sin { Op::Cos } else { Op::Sin }, factor: 2.0 });
            let first = operands(op, arity).take(100).enumerate();
            let same = |(k, args): (usize, Vec<f64>)| {
                other.apply(op, &args, place(k)).to_bits() == base.apply(op, &args, place(k)).to_bits()
            };
            let mut first = first;
            assert!(first.all(same), "{what}: a fault of another operation shows");
        }
    }
    assert_eq!(missed, Vec::<String>::new());
}

#[test]
fn strategies_err_to_their_sides_and_differ() {
    let vulkan = by_name("vulkan-1.4").unwrap();
    let all: Vec<Vec<u32>> = Strategy::ALL
        .iter()
        .map(|&strategy| {
            let device = device(vulkan, strategy);
            let inputs = (0..2000_u32).map(|k| 1.0 + f64::from(k) / 2048.0);
            inputs.enumerate().map(|(k, x)| device.apply(Op::Exp2, &[x], place(k)).to_bits()).collect()
        })
        .collect();
    for (k, a) in all.iter().enumerate() {
        for (j, b) in all.iter().enumerate().take(k) {
            assert_ne!(a, b, "{:?} {:?}", Strategy::ALL[k], Strategy::ALL[j]);
        }
    }
    let errors = |strategy, site: &dyn Fn(usize) -> usize| -> Vec<f64> {
        let device = device(vulkan, strategy);
        (0..400_usize)
            .map(|k| {
                let x = 1.0 + k as f64 / 512.0;
                let place = Place { site: site(k), invocation: k as u64 };
                (f64::from(device.apply(Op::Exp2, &[x], place)) - x.exp2()) / x.exp2()
            })
            .collect()
    };
    assert!(errors(Strategy::Upward, &|k| k).iter().all(|&e| e > 0.0));
    assert!(errors(Strategy::Downward, &|k| k).iter().all(|&e| e < 0.0));
    let upward = |strategy, site: &dyn Fn(usize) -> usize| errors(strategy, site).iter().filter(|&&e| e > 0.0).count();
    for strategy in [Strategy::Random, Strategy::Extreme] {
        assert!((150..250).contains(&upward(strategy, &|_| 5)), "{strategy:?}");
    }
    // One place has one side; places differ.
    assert!((0..10).all(|site| matches!(upward(Strategy::BySite, &|_| site), 0 | 400)));
    assert!((150..250).contains(&upward(Strategy::BySite, &|k| k)));
    // Extreme results lie at the ends, random ones in between as well.
    let size = |strategy| errors(strategy, &|_| 5).iter().map(|e| e.abs()).sum::<f64>() / 400.0;
    assert!((0.4..0.65).contains(&(size(Strategy::Random) / size(Strategy::Extreme))));
}

#[test]
fn results_depend_on_seed_and_place_and_repeat() {
    let vulkan = by_name("vulkan-1.4").unwrap();
    let run = |seed, shift: usize| -> Vec<u32> {
        let device = Device::new(vulkan, Stage::Vertex, Strategy::Random, seed);
        (0..100).map(|k| device.apply(Op::Sin, &[k as f64 / 64.0], place(k + shift)).to_bits()).collect()
    };
    assert_eq!(run(1, 0), run(1, 0));
    assert_ne!(run(1, 0), run(2, 0));
    assert_ne!(run(1, 0), run(1, 1));
}

fn profile(subnormals: &str, more: &str) -> Profile {
    let text = format!(
        "name = \"mine\"\nextends = \"vulkan-1.4\"\n{more}\n[subnormals]\ncompute = \"{subnormals}\"\nvertex = \"{subnormals}\"\n"
    );
    parse(&SourceFile::new("p.toml", text), &|name| by_name(name).cloned()).unwrap()
}

#[test]
fn subnormal_numbers_are_flushed_as_the_profile_says() {
    let tiny = 2f64.powi(-130);
    // A result, and an argument with a normal result.
    let counts = |flush: &str| {
        let device = device(&profile(flush, ""), Strategy::Extreme);
        let zeros = |args: [f64; 2]| (0..1000).filter(|&k| device.apply(Op::Mul, &args, place(k)) == 0.0).count();
        (zeros([2f64.powi(-100), 2f64.powi(-30)]), zeros([tiny, 2f64.powi(60)]))
    };
    assert_eq!(counts("must"), (1000, 1000));
    assert_eq!(counts("never"), (0, 0));
    let (results, arguments) = counts("may");
    assert!((400..600).contains(&results) && (400..600).contains(&arguments), "{results} {arguments}");
    assert_eq!((profile("must", "").compute, profile("never", "").vertex), (Flush::Must, Flush::Never));
}

#[test]
fn a_profile_that_rounds_to_nearest_leaves_no_choice_in_sums() {
    let nearest = device(&profile("never", "rounding = \"nearest-even\""), Strategy::Extreme);
    let either = device(&profile("never", ""), Strategy::Extreme);
    let off = |device: &Device| {
        let sums = operands(Op::Add, 2).filter(|args| args.iter().all(|x| x.abs() < 1e30)).enumerate();
        sums.filter(|(k, args)| device.apply(Op::Add, args, place(*k)) != (args[0] + args[1]) as f32).count()
    };
    assert_eq!(off(&nearest), 0);
    assert!(off(&either) > 2000);
}

#[test]
fn conformance_suites_accept_more_and_the_device_takes_it() {
    let [text, suite] = ["vulkan-1.4", "vulkan-cts"].map(|name| by_name(name).unwrap());
    assert_eq!((text.acceptance, suite.acceptance), (Acceptance::Text, Acceptance::Outward));
    let further = (0..1000)
        .filter(|&k| {
            let args = [1.0 + f64::from(k) / 1000.0];
            let [a, b] = [text, suite].map(|p| f64::from(device(p, Strategy::Upward).apply(Op::Exp2, &args, place(0))));
            assert!(a <= b);
            a < b
        })
        .count();
    assert!(further > 900, "{further}");
}

#[test]
fn nothing_promised_means_anything() {
    let glsl = device(by_name("glsl-4.60").unwrap(), Strategy::Mixed);
    let found: Vec<f32> = (0..1000).map(|k| glsl.apply(Op::Sin, &[0.5], place(k))).collect();
    assert!(found.iter().any(|y| y.is_nan()) && found.iter().any(|y| y.abs() > 1e10));
    assert!(found.iter().all(|y| !y.is_nan() || y.to_bits() == f32::NAN.to_bits()));
}

#[test]
fn integers_and_powers_are_converted_to_a_neighbour() {
    let vulkan = by_name("vulkan-1.4").unwrap();
    let found = |strategy, x: f64| {
        let device = device(vulkan, strategy);
        device.apply_to(Op::Convert, &[x], &|args| args[0], place(0))
    };
    let odd = 16_777_217.0;
    assert_eq!((found(Strategy::Downward, odd), found(Strategy::Upward, odd)), (16_777_216.0, 16_777_218.0));
    assert_eq!((found(Strategy::Downward, 77.0), found(Strategy::Upward, 77.0)), (77.0, 77.0));
    let scaled = |strategy, power: i32| {
        device(vulkan, strategy).apply_to(Op::Ldexp, &[1.5], &|args| args[0] * 2f64.powi(power), place(0))
    };
    assert_eq!((scaled(Strategy::Upward, 3), scaled(Strategy::Downward, 3)), (12.0, 12.0));
    assert_eq!((scaled(Strategy::Downward, 200), scaled(Strategy::Upward, 200)), (f32::MAX, f32::INFINITY));
}
