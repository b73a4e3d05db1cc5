//! Faults of many kinds, planted between a device and what is accepted from it, and who is blamed for each: an executor,
//! a translator, the memory, chance, or nobody.

use base::text::SourceFile;
use engine::suite::run::{FindingKind, Part, Peer, Prepared, Report, cross_check, prepare};
use engine::suite::{Suite, parse};
use judge::profile::Promises;
use judge::verdict::diagnosis::Fault;
use lanes::{Api, Lane as _, embedded};

use crate::support::{Dispatch, Planted, changed, part, prepared, request};

type Plant = fn(&mut Dispatch<'_>);

/// The first input of an invocation.
fn first(dispatch: &Dispatch<'_>, k: usize) -> f32 {
    f32::from_bits(dispatch.batch.invocation(k)[0])
}

/// Changes the first output in these places, whatever the inputs.
fn places(dispatch: &mut Dispatch<'_>, wrong: impl Fn(usize, usize) -> bool) {
    let count = dispatch.count;
    dispatch.each(|_, k| wrong(k, count), |x| x + 0.75);
}

/// Names of a lane, its executor and its front end.
const LANES: [(&str, &str, &str); 4] =
    [("a", "X", "naga"), ("b", "X", "glslang"), ("c", "Y", "naga"), ("d", "Y", "glslang")];

fn device(prepared: &Prepared, name: &str, plant: Option<Plant>) -> Planted {
    let &(name, executor, front_end) = LANES.iter().find(|lane| lane.0 == name).unwrap();
    let lane = Planted::new(embedded::open().unwrap(), prepared).called(name, executor, front_end, Api::Binary32);
    match plant {
        Some(plant) => lane.with(plant),
        None => lane,
    }
}

/// Runs a suite on some devices, and hears them on what deviates. None for one that fails.
fn reports(prepared: &Prepared, devices: &[Planted]) -> Vec<Option<Report>> {
    let promises: Vec<Promises> = devices.iter().map(|lane| Promises::of_lane(lane.description())).collect();
    let one = |lane: &Planted| {
        let request = request(prepared, Some(512), Promises::of_lane(lane.description()));
        part(prepared, lane, &request).ok()
    };
    let ran: Vec<Option<Part>> = devices.iter().map(one).collect();
    let peers: Vec<Peer<'_>> = devices.iter().zip(&promises).map(|(lane, promises)| Peer { lane, promises }).collect();
    let mut parts: Vec<Part> = ran.iter().flatten().cloned().collect();
    cross_check(prepared, &peers, &mut parts);
    let mut parts = parts.into_iter();
    ran.iter().map(|ran| ran.as_ref().and_then(|_| parts.next()).map(Part::report)).collect()
}

/// Who was blamed on a lane, each once: the kind of fault with its part, or the kind of finding.
fn blamed(report: &Report) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for finding in report.errors() {
        let cross_check = finding.case.as_ref().and_then(|case| case.diagnosis.cross_check.as_ref());
        all.push(match cross_check.map(|cross_check| &cross_check.fault) {
            Some(Fault::Executor { executor, .. }) => format!("executor {executor}"),
            Some(Fault::Translator { front_end, .. }) => format!("translator {front_end}"),
            Some(Fault::Position { executor, .. }) => format!("position {executor}"),
            Some(Fault::Unsteady { .. }) => "chance".to_owned(),
            Some(other) => other.name().to_owned(),
            None if finding.kind == FindingKind::Flaky => "chance".to_owned(),
            None => format!("{:?}: {}", finding.kind, finding.message),
        });
    }
    all.sort();
    all.dedup();
    all
}

/// Faults that follow from the inputs, each on all invocations that have them.
const BY_INPUT: [(&str, Plant); 18] = [
    ("off by a constant", |r| r.each(|_, _| true, |x| x + 0.01)),
    ("off by a factor", |r| r.each(|_, _| true, |x| x * 1.01 + 1e-3)),
    ("the wrong sign", |r| r.each(|_, _| true, |x| -x - 0.5)),
    ("NaN above a half", |r| r.each(|r, k| first(r, k) > 0.5, |_| f32::NAN)),
    ("infinite above a half", |r| r.each(|r, k| first(r, k) > 0.5, |_| f32::INFINITY)),
    ("NaN below zero", |r| r.each(|r, k| first(r, k) < 0.0, |_| f32::NAN)),
    ("few digits", |r| r.each(|_, _| true, |x| f32::from_bits(x.to_bits() & 0xffff_0000 ^ 0x0010_0000))),
    ("clamped to one", |r| r.each(|_, _| true, |x| x.clamp(-0.125, 0.125) + 0.3)),
    ("whole numbers", |r| r.each(|_, _| true, |x| x.round() + 0.4)),
    ("a stuck bit", |r| r.each(|_, _| true, |x| f32::from_bits(x.to_bits() ^ 1 << 21))),
    ("an odd word of input", |r| r.each(|r, k| r.batch.invocation(k)[0] & 1 == 1, |x| x + 0.5)),
    ("a rare input", |r| r.each(|r, k| r.batch.invocation(k)[0] % 32 == 5, |x| x + 0.5)),
    ("a range of inputs", |r| r.each(|r, k| (0.25..0.5).contains(&first(r, k)), |x| x + 0.5)),
    ("two components exchanged", |r| {
        (0..r.count).for_each(|k| r.out(k).swap(0, 1));
        r.each(|_, _| true, |x| x + 0.01);
    }),
    ("the last component", |r| {
        for k in 0..r.count {
            let last = r.out(k).last_mut().unwrap();
            *last = (f32::from_bits(*last) + 0.5).to_bits();
        }
    }),
    ("an output that is not written", |r| {
        let sentinel = r.marks.sentinel;
        (0..r.count).for_each(|k| r.out(k)[1] = sentinel);
    }),
    ("all of them zero", |r| (0..r.count).for_each(|k| r.out(k).fill(0))),
    ("one number for all", |r| (0..r.count).for_each(|k| r.out(k)[2] = 7.5_f32.to_bits())),
];

/// Faults of memory and readback, whatever the inputs.
const BY_PLACE: [(&str, Plant); 15] = [
    ("one word of each readback", |r| places(r, |k, _| k == 200)),
    ("the first word", |r| places(r, |k, _| k == 0)),
    ("the last invocation", |r| places(r, |k, n| k + 1 == n)),
    ("the first group", |r| places(r, |k, _| k < 64)),
    ("the last group", |r| places(r, |k, n| k + 64 >= n)),
    ("the last group of large batches", |r| places(r, |k, n| n > 256 && k + 64 >= n)),
    ("every 64th", |r| places(r, |k, _| k % 64 == 63)),
    ("every 64th from the first", |r| places(r, |k, _| k % 64 == 0)),
    ("one group", |r| places(r, |k, _| (128..192).contains(&k))),
    ("the second half", |r| places(r, |k, n| 2 * k >= n && n > 64)),
    ("the first half", |r| places(r, |k, n| 2 * k < n && n > 64)),
    ("behind a page", |r| places(r, |k, _| k >= 256)),
    ("powers of two", |r| places(r, |k, _| k > 8 && k.is_power_of_two())),
    ("zeros in one group", |r| {
        for k in 192..256.min(r.count) {
            r.out(k).fill(0x4100_0000);
        }
    }),
    ("a bit of one word", |r| {
        if r.count > 300 {
            r.out(300)[3] ^= 1 << 23;
        }
    }),
];

/// Faults that follow from how a batch is made up: each invocation of it is wrong.
const BY_SHAPE: [(&str, Plant); 2] = [
    ("uniforms that are shared", |r| {
        if r.batch.per_case > 1 {
            r.each(|_, _| true, |x| x + 0.5);
        }
    }),
    ("uniforms that are shared, and a range of inputs", |r| {
        if r.batch.per_case > 1 {
            r.each(|r, k| first(r, k) > 1.0, |x| x + 0.5);
        }
    }),
];

/// Faults that come and go.
const BY_CHANCE: [(&str, Plant); 3] = [
    ("every third dispatch", |r| {
        if r.of_lane % 3 == 0 {
            r.each(|_, _| true, |x| x + 0.5);
        }
    }),
    ("once", |r| {
        if r.of_lane == 0 {
            r.each(|_, k| k == 40, |x| x + 0.5);
        }
    }),
    ("another place in each dispatch", |r| {
        let place = r.of_lane * 37 % r.count.max(1);
        r.each(|_, k| k == place, |x| x + 0.5);
    }),
];

/// Faults that were thought of after the judge was made: half precision, other records' words, flushed and saturated
/// numbers, and such as follow from a digest of the inputs.
const OTHERS_BY_INPUT: [(&str, Plant); 12] = [
    ("eleven bits", |r| r.each(|_, _| true, |x| f32::from_bits(x.to_bits() & 0xffff_e000 | 0x0000_1000))),
    ("saturated", |r| r.each(|_, _| true, |x| x.clamp(0.0, 1.0) + 1e-3)),
    ("rounded to sixteenths", |r| r.each(|_, _| true, |x| (x * 16.0).trunc() / 16.0 + 0.01)),
    ("the sign lost", |r| r.each(|_, _| true, |x| x.abs() + 0.001)),
    ("a reciprocal", |r| r.each(|_, _| true, |x| 1.0 / (x + 3.0))),
    ("off by a part in 4096", |r| r.each(|_, _| true, |x| x * (1.0 + 1.0 / 4096.0) + 1e-4)),
    ("a digest of the inputs", |r| {
        r.each(|r, k| r.batch.invocation(k).iter().fold(7_u32, |d, w| d.wrapping_mul(31) ^ w) % 8 == 3, |x| x + 0.125);
    }),
    ("negative inputs alone", |r| r.each(|r, k| first(r, k) < 0.0, |x| x * 0.5 + 0.25)),
    ("bytes exchanged", |r| r.each(|_, _| true, |x| f32::from_bits(x.to_bits().swap_bytes()))),
    ("a component twice", |r| {
        (0..r.count).for_each(|k| {
            let out = r.out(k);
            out[1] = (f32::from_bits(out[0]) + 0.01).to_bits();
        });
    }),
    ("an input in place of an output", |r| {
        (0..r.count).for_each(|k| r.out(k)[0] = (first(r, k) + 1.5).to_bits());
    }),
    ("the largest number", |r| r.each(|r, k| r.batch.invocation(k)[0] % 4 == 1, |_| f32::MAX)),
];

/// The same of memory: words and records that stand where others belong.
const OTHERS_BY_PLACE: [(&str, Plant); 8] = [
    ("the next record in one group", |r| {
        for k in 64..128.min(r.count.saturating_sub(1)) {
            let next = r.out(k + 1).to_vec();
            r.out(k).copy_from_slice(&next);
        }
    }),
    ("two records exchanged", |r| {
        if r.count > 20 {
            let (a, b) = (r.out(10).to_vec(), r.out(20).to_vec());
            r.out(10).copy_from_slice(&b);
            r.out(20).copy_from_slice(&a);
        }
    }),
    ("a word of the next record", |r| {
        for k in 0..r.count.saturating_sub(1) {
            r.out(k)[0] = r.out(k + 1)[0];
        }
    }),
    ("records in reverse in one group", |r| {
        if r.count >= 64 {
            let all: Vec<Vec<u32>> = (0..64).map(|k| r.out(k).to_vec()).collect();
            all.iter().rev().enumerate().for_each(|(k, from)| r.out(k).copy_from_slice(from));
        }
    }),
    ("the first record for a group", |r| {
        let first = r.out(0).to_vec();
        for k in 1..64.min(r.count) {
            r.out(k).copy_from_slice(&first);
        }
    }),
    ("every fifth", |r| places(r, |k, _| k % 5 == 4)),
    ("a quarter", |r| places(r, |k, n| n > 64 && k * 4 >= n * 3)),
    ("ones behind 256", |r| {
        for k in 256..r.count.max(256) {
            r.out(k)[2] = 0xffff_ffff;
        }
    }),
];

/// What invocations do to those beside them, by their inputs.
const BY_NEIGHBOUR: [(&str, Plant); 1] =
    [("the sign of the one beside it", |r| r.each(|r, k| beside(r, k, 2, |x| x < 0.0), |x| x + 0.75))];

/// Whether the first input of some other one in its group is so, and not the same.
fn beside(dispatch: &Dispatch<'_>, k: usize, group: usize, so: fn(f32) -> bool) -> bool {
    let first_of = k / group * group;
    let others = (first_of..(first_of + group).min(dispatch.count)).filter(|&other| other != k);
    others.into_iter().any(|other| {
        let x = first(dispatch, other);
        so(x) && x.to_bits() != first(dispatch, k).to_bits()
    })
}

/// What an earlier dispatch left.
const STALE: [(&str, Plant); 2] = [
    ("a group of the dispatch before", |r| {
        let size = r.layout.words();
        if r.before.len() == r.words.len() && r.count > 96 {
            for k in 64..96 {
                let old = r.before[k * size + r.layout.header_words()..(k + 1) * size].to_vec();
                r.out(k).copy_from_slice(&old);
            }
        }
    }),
    ("a word of the dispatch before", |r| {
        let at = 100 * r.layout.words() + r.layout.header_words();
        if r.before.len() == r.words.len() && r.count > 100 {
            r.words[at] = r.before[at];
        }
    }),
];

/// A third set, thought of after the second was judged rightly.
const THIRD_BY_INPUT: [(&str, Plant); 14] = [
    ("a count of leading zeros", |r| {
        r.each(|r, k| r.batch.invocation(k)[0].leading_zeros() == 2, |x| x + 0.25);
    }),
    ("two inputs in one order", |r| r.each(|r, k| r.batch.invocation(k)[0] < r.batch.invocation(k)[1], |x| x - 0.25)),
    ("two inputs of one sign", |r| {
        r.each(|r, k| (r.batch.invocation(k)[0] ^ r.batch.invocation(k)[1]) >> 31 == 0, |x| x * 1.5 + 0.1);
    }),
    ("an exponent one too small", |r| r.each(|_, _| true, |x| x * 0.5 - 0.01)),
    ("the mantissa inverted", |r| r.each(|_, _| true, |x| f32::from_bits(x.to_bits() ^ 0x007f_ffff))),
    ("numbers read as whole ones", |r| r.each(|_, _| true, |x| x.to_bits() as f32)),
    ("whole numbers read as numbers", |r| r.each(|_, _| true, |x| f32::from_bits(x as i32 as u32 ^ 0x3f00_0000))),
    ("wrapped at a half", |r| r.each(|_, _| true, |x| (x + 0.5).rem_euclid(1.0) - 0.499)),
    ("squared", |r| r.each(|_, _| true, |x| x * x + 1e-3)),
    ("the last output of the first", |r| {
        for k in 0..r.count {
            let out = r.out(k);
            let last = out.len() - 1;
            out[last] = (f32::from_bits(out[0]) - 0.3).to_bits();
        }
    }),
    ("outputs moved by one", |r| {
        (0..r.count).for_each(|k| r.out(k).rotate_left(1));
        r.each(|_, _| true, |x| x + 1e-3);
    }),
    ("large results alone", |r| r.each(|_, _| true, |x| if x.abs() > 0.75 { x * 1.125 } else { x })),
    ("small results are zero", |r| r.each(|_, _| true, |x| if x.abs() < 0.0625 { 0.0 } else { x })),
    ("not a number for a sign", |r| r.each(|_, _| true, |x| if x < 0.0 { f32::NAN } else { x })),
];

/// The same of memory.
const THIRD_BY_PLACE: [(&str, Plant); 8] = [
    ("every thousandth bit", |r| {
        for at in (0..r.words.len() * 32).step_by(9973) {
            let (word, header) = (at / 32, r.layout.header_words());
            if word % r.layout.words() >= header {
                r.words[word] ^= 1 << (at % 32).clamp(20, 30);
            }
        }
    }),
    ("a column of a table of 32", |r| places(r, |k, _| k % 32 == 7)),
    ("a row of a table of 32", |r| places(r, |k, _| (224..256).contains(&k))),
    ("odd groups", |r| places(r, |k, n| n > 64 && k / 64 % 2 == 1)),
    ("twos of a group exchanged", |r| {
        for k in (64..128.min(r.count.saturating_sub(1))).step_by(2) {
            let (a, b) = (r.out(k).to_vec(), r.out(k + 1).to_vec());
            r.out(k).copy_from_slice(&b);
            r.out(k + 1).copy_from_slice(&a);
        }
    }),
    ("a word of the invocation 16 before", |r| {
        for k in (16..r.count).rev() {
            r.out(k)[1] = r.out(k - 16)[1];
        }
    }),
    ("ones in the last record", |r| {
        let last = r.count - 1;
        r.out(last).fill(0x3f80_0000);
    }),
    ("a byte of one word", |r| {
        if r.count > 70 {
            r.out(70)[0] ^= 0x3f00_0000;
        }
    }),
];

/// What is no fault at all: zeros of either sign, and subnormal numbers that are flushed.
const NOBODYS: [(&str, Plant); 2] = [
    ("the sign of zero", |r| r.each(|_, _| true, |x| if x == 0.0 { -x } else { x })),
    ("flushed", |r| r.each(|_, _| true, |x| if x.is_subnormal() { 0.0 } else { x })),
];

/// Which lanes have the fault, and who is to be blamed on each of them.
type Plan = (&'static str, &'static [&'static str], &'static str);

/// The suite with its samples alone: a relation would be looked into for every fault as well.
fn without_relations() -> Prepared {
    changed("morph", |suite| Suite { relations: Vec::new(), ..suite }, str::to_owned)
}

/// A fragment stage that reads a texture.
fn textured() -> Prepared {
    let suite = "suite = \"lit\"\nshader = \"lit.frag\"\nstage = \"fragment\"\nsamples = 512\n\
                 [[inputs]]\nnames = [\"uv\"]\ngenerator = \"interval\"\nrange = [-1.0, 1.0]\n\
                 [[inputs]]\nnames = [\"gain\"]\ngenerator = \"interval\"\nrange = [0.5, 2.0]\n\
                 [floors]\nundetermined = 0.2\nreason = \"coordinates at the edges of texels\"\n";
    let text = "#version 330\nin vec2 uv;\nuniform float gain;\nuniform sampler2D map;\nout vec4 color;\n\
                void main() { color = texture(map, uv) * gain - 0.25; }\n";
    let suite = parse(&SourceFile::new("lit.suite.toml", suite)).unwrap();
    prepare(&suite, &SourceFile::new("lit.frag", text)).unwrap()
}

/// What is blamed wrongly of the faults of a table, in dispatches of at most so many invocations, and how many faults
/// were looked at.
fn wrongly(prepared: &Prepared, table: &[(&str, Plant)], plans: &[Plan], most: usize) -> (Vec<String>, usize) {
    let (mut wrong, mut all) = (Vec::new(), 0);
    for &(name, plant) in table {
        for &(part, faulty, expected) in plans {
            let planted = |name: &str| faulty.contains(&name).then_some(plant);
            let devices: Vec<Planted> =
                LANES.iter().map(|l| device(prepared, l.0, planted(l.0)).in_batches_of(most)).collect();
            let reports = reports(prepared, &devices);
            all += 1;
            let found: Vec<(&str, Vec<String>)> =
                LANES.iter().zip(&reports).map(|(lane, report)| (lane.0, blamed(report.as_ref().unwrap()))).collect();
            let right = |(lane, said): &(&str, Vec<String>)| match faulty.contains(lane) {
                true if !expected.is_empty() => said[..] == [expected.to_owned()],
                _ => said.is_empty(),
            };
            if !found.iter().all(right) {
                wrong.push(format!("{name} in {part}: {found:?}"));
            }
        }
    }
    (wrong, all)
}

/// All faults of a table are blamed on the part that has them.
#[track_caller]
fn rightly(table: &[(&str, Plant)], plans: &[Plan], least: usize) {
    rightly_in(usize::MAX, table, plans, least);
}

/// The same in dispatches of at most so many invocations.
#[track_caller]
fn rightly_in(most: usize, table: &[(&str, Plant)], plans: &[Plan], least: usize) {
    let (wrong, all) = wrongly(&without_relations(), table, plans, most);
    assert!(all >= least, "{all}");
    assert!(wrong.is_empty(), "{} of {all} blamed wrongly:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn a_fault_that_follows_from_inputs_is_blamed_on_the_part_that_has_it() {
    let plans: [Plan; 3] = [
        ("an executor", &["a", "b"], "executor X"),
        ("a translator", &["a", "c"], "translator naga"),
        ("a pair", &["a"], "pair"),
    ];
    rightly(&BY_INPUT, &plans, 54);
    rightly(&BY_SHAPE, &plans, 6);
}

#[test]
fn a_fault_of_a_place_is_blamed_on_the_memory_of_its_executor() {
    let plans: [Plan; 2] = [("one lane", &["a"], "position X"), ("an executor", &["a", "b"], "position X")];
    rightly(&BY_PLACE, &plans, 30);
}

#[test]
fn invocations_that_disturb_each_other_are_told_from_memory_and_from_chance() {
    let plans: [Plan; 2] = [("one lane", &["a"], "neighbours"), ("an executor", &["a", "b"], "neighbours")];
    rightly(&BY_NEIGHBOUR, &plans, 2);
}

#[test]
fn a_fault_that_comes_and_goes_is_chance() {
    rightly(&BY_CHANCE, &[("one lane", &["a"], "chance")], 3);
}

#[test]
fn faults_that_were_thought_of_later_are_blamed_on_the_part_that_has_them() {
    let plans: [Plan; 3] = [
        ("an executor", &["a", "b"], "executor X"),
        ("a translator", &["a", "c"], "translator naga"),
        ("a pair", &["a"], "pair"),
    ];
    rightly(&OTHERS_BY_INPUT, &plans, 36);
    let plans: [Plan; 2] = [("one lane", &["a"], "position X"), ("an executor", &["a", "b"], "position X")];
    rightly(&OTHERS_BY_PLACE, &plans, 16);
    rightly_in(128, &STALE, &plans, 4);
    let plans: [Plan; 2] = [("every lane", &["a", "b", "c", "d"], ""), ("an executor", &["a", "b"], "")];
    let (wrong, _) = wrongly(&without_relations(), &NOBODYS, &plans, usize::MAX);
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn faults_of_a_third_set_are_blamed_on_the_part_that_has_them() {
    let plans: [Plan; 3] = [
        ("an executor", &["a", "b"], "executor X"),
        ("a translator", &["a", "c"], "translator naga"),
        ("a pair", &["a"], "pair"),
    ];
    rightly(&THIRD_BY_INPUT, &plans, 42);
    let plans: [Plan; 2] = [("one lane", &["a"], "position X"), ("an executor", &["a", "b"], "position X")];
    rightly(&THIRD_BY_PLACE, &plans, 16);
}

#[test]
fn faults_in_what_a_fragment_stage_reads_from_textures_are_blamed_on_the_part_that_has_them() {
    let by_input: [Plan; 2] =
        [("an executor", &["a", "b"], "executor X"), ("a translator", &["a", "c"], "translator naga")];
    let by_place: [Plan; 1] = [("one lane", &["a"], "position X")];
    let mut all = Vec::new();
    for (table, plans) in [
        (&BY_INPUT[..], &by_input[..]),
        (&OTHERS_BY_INPUT, &by_input),
        (&THIRD_BY_INPUT, &by_input),
        (&OTHERS_BY_PLACE, &by_place),
        (&THIRD_BY_PLACE, &by_place),
    ] {
        all.push(wrongly(&textured(), table, plans, usize::MAX));
    }
    let (wrong, looked) = all.into_iter().fold((Vec::new(), 0), |(mut wrong, looked), (more, of)| {
        wrong.extend(more);
        (wrong, looked + of)
    });
    assert!(looked > 100, "{looked}");
    assert!(wrong.is_empty(), "{} of {looked} blamed wrongly:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn devices_without_a_fault_are_not_blamed() {
    let still: [(&str, Plant); 2] =
        [("nothing", |_| {}), ("outputs written as they are", |r| r.each(|_, _| true, |x| x))];
    for prepared in [without_relations(), textured()] {
        let (wrong, _) = wrongly(&prepared, &still, &[("every lane", &[], "")], usize::MAX);
        assert!(wrong.is_empty(), "{wrong:?}");
    }
}

#[test]
fn a_fault_of_a_place_is_reported_as_one_and_takes_the_whole_run_to_show() {
    let prepared = prepared("morph");
    let devices = [device(&prepared, "a", Some(BY_PLACE[6].1)), device(&prepared, "d", None)];
    let report = reports(&prepared, &devices).remove(0).unwrap();
    let finding = report.errors()[0];
    let case = finding.case.as_ref().unwrap();
    let fault = case.diagnosis.cross_check.as_ref().unwrap().fault.to_string();
    assert!(
        fault.starts_with(
            "the memory or the readback of the executor `X`, behind `naga`: it depends on the position and not on the \
             inputs: of "
        ) && fault.contains("deviate: 63, 127, ")
            && fault.ends_with("; `Y` is right there"),
        "{fault}"
    );
    assert_eq!(case.diagnosis.position.as_ref().unwrap().invocation % 64, 63);
    let reproduce = finding.reproduce.as_ref().unwrap();
    assert!(reproduce.contains("--seed ") && !reproduce.contains("--case"), "{reproduce}");
}

#[test]
fn a_lane_that_fails_is_evidence_against_its_executor() {
    let prepared = prepared("morph");
    let plant = BY_INPUT[0].1;
    let with = |fails: bool| {
        let failing = device(&prepared, "a", None).crashing();
        let mut devices = vec![device(&prepared, "b", Some(plant))];
        devices.extend(fails.then_some(failing));
        // Another executor behind another front end: what is right shares nothing.
        let mut other = device(&prepared, "d", None);
        other.description.front_end = "Mesa".to_owned();
        devices.push(other);
        blamed(reports(&prepared, &devices)[0].as_ref().unwrap())
    };
    assert_eq!(with(false), ["executor_or_translator"]);
    assert_eq!(with(true), ["executor X"]);
}

#[test]
fn a_witness_that_errs_by_place_does_not_change_who_is_blamed() {
    let prepared = prepared("morph");
    for place in [1, 3, 4] {
        let devices = [
            device(&prepared, "a", Some(BY_PLACE[place].1)),
            device(&prepared, "c", Some(BY_INPUT[0].1)),
            device(&prepared, "d", Some(BY_INPUT[0].1)),
        ];
        let said: Vec<Vec<String>> =
            reports(&prepared, &devices).iter().map(|report| blamed(report.as_ref().unwrap())).collect();
        assert_eq!(said, [["position X"], ["executor Y"], ["executor Y"]], "{}", BY_PLACE[place].0);
    }
}

#[test]
fn relations_name_whose_fault_it_is() {
    // Wrong only where each invocation has uniforms of its own, which is how relations run.
    let prepared = prepared("morph");
    let plant: Plant = |r| {
        if r.batch.per_case == 1 {
            r.each(|r, k| r.batch.invocation(k)[0] % 2 == 0, |x| x + 0.5);
        }
    };
    for (faulty, expected) in [(["a", "b"], "executor X"), (["a", "c"], "translator naga")] {
        let devices: Vec<Planted> =
            LANES.iter().map(|l| device(&prepared, l.0, faulty.contains(&l.0).then_some(plant))).collect();
        for (lane, report) in LANES.iter().zip(reports(&prepared, &devices)) {
            let report = report.unwrap();
            let relations: Vec<_> = report.findings.iter().filter(|f| f.kind == FindingKind::Relation).collect();
            assert_eq!(!relations.is_empty(), faulty.contains(&lane.0), "{}: {:?}", lane.0, report.findings);
            if faulty.contains(&lane.0) {
                assert_eq!(blamed(&report), [expected], "{}", lane.0);
            }
        }
    }
}
