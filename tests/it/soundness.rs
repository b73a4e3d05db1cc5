//! The judge never accuses a device that keeps its promise, and does accuse one that does not.

use base::text::SourceFile;
use engine::adversary::{Fault, Strategy};
use engine::suite::run::soundness::{Request, Soundness, check, halved};
use engine::suite::run::{Prepared, prepare};
use engine::suite::{load_all, parse, search, shipped};
use judge::profile::{Op, by_name};
use judge::tape::{Glance, Model, Tape};
use judge::verdict::Oracle;
use lanes::Stage;
use program::interp::{self, Binary64, FUEL, Machine, OutputColumn, SLOTS};
use property::Sampler;

/// Samples in total: about 20 s on two cores in the profile of the tests. `cargo xtask soundness` runs more.
const SAMPLES: u64 = 1_000_000;

fn suites(names: &[&str]) -> Vec<Prepared> {
    let wanted = shipped().filter(|suite| names.is_empty() || names.contains(&suite.name));
    let ready = wanted.map(|suite| {
        let parsed = parse(&SourceFile::new(suite.path, suite.toml)).unwrap();
        prepare(&parsed, &SourceFile::new(suite.shader_name, suite.shader_text)).unwrap()
    });
    ready.collect()
}

fn complaints(found: &Soundness) -> String {
    let line = |v: &engine::suite::run::soundness::Violation| {
        let b = v.behaviour;
        let order = if b.rearranges { "rearranged" } else { "in order" };
        format!(
            "{} by {} {} {:?} {order}: `{}`, {} times the bound: {}\n",
            v.suite, b.profile.name, b.stage, b.strategy, v.component, v.ratio, v.deviation
        )
    };
    found.violations.iter().map(line).collect()
}

#[test]
fn no_conforming_device_is_accused() {
    let suites = suites(&[]);
    assert_eq!(suites.len(), 14);
    let mut last = 0;
    let found = check(&suites, &Request::new(SAMPLES, 1), &mut |done| last = done).unwrap();
    assert_eq!(found.violations(), 0, "{}", complaints(&found));
    let (judged, open) = (found.judged(), found.undetermined());
    assert!(judged + open == last && last >= SAMPLES, "{judged} {open} {last}");
    assert!(judged * 10 >= last * 9, "{open} of {last} are inconclusive");
    // Devices that stay far from every bound would show nothing.
    for (k, suite) in suites.iter().enumerate() {
        let used = found.rows.iter().filter(|row| row.suite == k).filter_map(|row| Some(row.used.as_ref()?.part));
        let most = used.fold(0.0, f64::max);
        assert!(most > 0.4, "{}: {most}", suite.suite.name);
    }
    for row in &found.rows {
        // The text alone does not promise the regrouped sums, and they are measured as such.
        let used = row.used.as_ref().map_or(0.0, |used| used.part);
        assert!(used <= 1.0, "{} {:?} {used}", suites[row.suite].suite.name, row.behaviour.strategy);
    }
}

/// The copies of the chapter's shaders in WGSL, with their own suites.
#[test]
fn no_conforming_device_is_accused_by_what_is_written_in_wgsl() {
    let files = search(std::path::Path::new("fixtures/languages")).unwrap();
    let suites: Vec<Prepared> = files
        .iter()
        .map(|path| {
            let loaded = load_all(path).unwrap().remove(0);
            prepare(&loaded.suite, &loaded.shader).unwrap()
        })
        .collect();
    assert_eq!(suites.len(), 14);
    let found = check(&suites, &Request::new(200_000, 9), &mut |_| {}).unwrap();
    assert_eq!(found.violations(), 0, "{}", complaints(&found));
    assert!(found.judged() > 150_000, "{} {}", found.judged(), found.undetermined());
    let mut request = Request::new(50_000, 9);
    request.fault = Some(Fault { op: Op::Sin, factor: 4.0 });
    assert!(check(&suites, &request, &mut |_| {}).unwrap().violations() > 0, "a fault beyond the promise");
}

/// The chapter's suites with `mediump` numbers, and a shader that mixes precisions.
fn halves() -> Vec<Prepared> {
    let chapter = shipped().map(|suite| (suite.path, suite.toml, suite.shader_name, suite.shader_text));
    let all = chapter.chain([("mixed.suite.toml", MIXED_SUITE, "mixed.vert", MIXED)]);
    let ready = all.map(|(path, toml, name, text)| {
        halved(&parse(&SourceFile::new(path, toml)).unwrap(), &SourceFile::new(name, text)).unwrap()
    });
    ready.collect()
}

const MIXED: &str = "#version 310 es
in float x;
in highp float y;
in lowp vec3 colour;
out float sum;
out float squared;
out float wave;
out vec3 shaded;
out float chosen;
out highp float whole;
void main() {
    highp float wide = y * 3.0;
    sum = wide + x;
    squared = (x - 0.5) * (x + 0.5) / (abs(x) + 0.25);
    wave = sin(x) * exp2(-abs(x)) + fract(x);
    shaded = normalize(vec3(x, 0.5, 1.0)) * colour + 0.125;
    chosen = 0.0;
    for (int i = 0; i < 3; ++i) chosen += x > 0.3 ? x * float(i) : mix(x, 0.5, 0.25);
    whole = y * y - wide;
    gl_Position = vec4(sum);
}
";

const MIXED_SUITE: &str = "suite = \"mixed\"
shader = \"mixed.vert\"
stage = \"vertex\"
samples = 4096
relations = [{ kind = \"even\", inputs = [\"y\"], outputs = [\"wave\"] }]
[[inputs]]
names = [\"x\", \"y\"]
generator = \"interval\"
range = [-8.0, 8.0]
[[inputs]]
names = [\"colour\"]
generator = \"interval\"
range = [0.0, 1.0]
";

#[test]
fn no_device_that_keeps_its_promises_of_mediump_is_accused_and_others_are() {
    let mut suites = halves();
    assert_eq!(suites.len(), 15);
    let mut request = Request::new(300_000, 4);
    request.lowered = true;
    let found = check(&suites, &request, &mut |_| {}).unwrap();
    assert_eq!(found.violations(), 0, "{}", complaints(&found));
    let judged_on = |found: &Soundness, k: usize| -> u64 {
        found.rows.iter().filter(|row| row.suite == k).map(|row| row.judged).sum()
    };
    let known = (0..suites.len()).filter(|&k| judged_on(&found, k) > 1000).count();
    assert!(known >= 8 && found.judged() > 50_000, "{known} suites, {} samples", found.judged());
    // A fault beyond the promise of one operation.
    request.samples = 100_000;
    request.fault = Some(Fault { op: Op::Mul, factor: 4.0 });
    let faulty = check(&suites, &request, &mut |_| {}).unwrap();
    assert!(faulty.violations() > 100, "{}", faulty.violations());
    // A bound that is too tight: that of binary32.
    request.fault = None;
    for suite in &mut suites {
        suite.lowered = Some(Oracle::new(&suite.program).unwrap());
    }
    let wrong = check(&suites, &request, &mut |_| {}).unwrap();
    assert!(wrong.violations() > 1000, "{}", wrong.violations());
}

const TINY: &str = "#version 150
in float x;
in float y;
out float twice;
out float minus;
out float large;
out float gone;
out float chosen;
out vec2 sums;
void main() {
    twice = x + x;
    minus = -x;
    large = x * 1e30;
    gone = x * 2.0;
    sums = vec2(x + y + x, x * 3.0 - y);
    chosen = 0.0;
    if (y * 1e30 > 1e-9) chosen = (x * 0.01 + 0.0) * 1e30;
    gl_Position = vec4(0.0);
}
";

const TINY_SUITE: &str = "suite = \"tiny\"
shader = \"tiny.vert\"
stage = \"vertex\"
samples = 4096
relations = [{ kind = \"odd\", inputs = [\"x\", \"y\"] }]
[[inputs]]
names = [\"x\", \"y\"]
generator = \"interval\"
range = [-3e-38, 3e-38]
";

/// A suite whose numbers are about as small as binary32 has them, on their own, in sums, large again, and chosen.
fn tiny() -> Vec<Prepared> {
    let parsed = parse(&SourceFile::new("tiny.suite.toml", TINY_SUITE)).unwrap();
    vec![prepare(&parsed, &SourceFile::new("tiny.vert", TINY)).unwrap()]
}

#[test]
fn flushed_arguments_are_no_fault() {
    let suites = tiny();
    let found = check(&suites, &Request::new(400_000, 3), &mut |_| {}).unwrap();
    assert_eq!(found.violations(), 0, "{}", complaints(&found));
    // Where nothing is flushed, these are numbers like any other.
    let kept = |row: &&engine::suite::run::soundness::Row| row.behaviour.profile.name == "binary32";
    let judged: u64 = found.rows.iter().filter(kept).map(|row| row.judged).sum();
    assert!(judged > 1000, "{judged}");
}

#[test]
fn a_fault_beyond_the_promise_is_found() {
    let mut missed = Vec::new();
    // The least part of the samples for which each is found, in the best of the strategies.
    for (suite, profile, op, factor, least) in [
        ("sphere", "vulkan-1.4", Op::Sin, 2.0, 0.1),
        ("bone_weight", "vulkan-1.4", Op::Pow, 2.0, 0.1),
        // Few samples: the bound adds up what every bone and the sums behind them may do.
        ("skinning", "vulkan-1.4", Op::Pow, 4.0, 0.01),
        ("bone_weight", "binary32", Op::Pow, 4.0, 0.2),
        ("joints", "binary32", Op::Add, 4.0, 0.1),
        // Where the nearest point lies is of second order in the distance.
        ("segment_distance", "binary32", Op::Div, 4.0, 0.001),
    ] {
        let suites = suites(&[suite]);
        let mut request = Request::new(20_000, 7);
        request.profiles = vec![by_name(profile).unwrap()];
        let sound = check(&suites, &request, &mut |_| {}).unwrap();
        assert_eq!(sound.violations(), 0, "{}", complaints(&sound));
        request.fault = Some(Fault { op, factor });
        let found = check(&suites, &request, &mut |_| {}).unwrap();
        let share = |strategy: Strategy| {
            let rows = || found.rows.iter().filter(|row| row.behaviour.strategy == strategy);
            rows().map(|row| row.violations).sum::<u64>() as f64 / rows().map(|row| row.judged).sum::<u64>() as f64
        };
        let shares = Strategy::ALL.map(share);
        let best = shares.into_iter().fold(0.0, f64::max);
        if best < least {
            missed.push(format!("{suite} {profile} {op:?} times {factor}: {shares:?}"));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

const IDIOMS: &str = "#version 150
in vec3 normal;
in vec3 light;
in vec3 eye;
in float depth;
in float shine;
out float specular;
out float halfway;
out float fog;
out float gauss;
out float rim;
out float gamma;
out float rough;
void main() {
    vec3 r = 2.0 * dot(normal, light) * normal - light;
    specular = pow(max(dot(r, eye), 0.0), shine);
    halfway = 0.2 + 0.8 * pow(max(dot(normal, 0.5 * (light + eye)), 0.0), 4.0 * shine);
    fog = 1.0 - exp(-depth * depth);
    gauss = exp2(-depth * depth * 4.0);
    rim = pow(1.0 - clamp(dot(normal, eye), 0.0, 1.0), 3.0);
    gamma = pow(abs(light.x), 1.0 / 2.2);
    rough = max(dot(normal, light), 0.0) * exp(-depth) / (depth + 1.0);
    gl_Position = vec4(0.0);
}
";

const IDIOMS_SUITE: &str = "suite = \"idioms\"
shader = \"idioms.vert\"
stage = \"vertex\"
samples = 4096
relations = [{ kind = \"even\", inputs = [\"normal\"], outputs = [\"specular\"] }]
[[inputs]]
names = [\"normal\", \"light\", \"eye\"]
generator = \"interval\"
range = [-1.0, 1.0]
[[inputs]]
names = [\"depth\"]
generator = \"interval\"
range = [0.0, 30.0]
[[inputs]]
names = [\"shine\"]
generator = \"interval\"
range = [1.0, 128.0]
";

#[test]
fn what_reaches_zero_is_judged_and_no_conforming_device_is_accused() {
    let parsed = parse(&SourceFile::new("idioms.suite.toml", IDIOMS_SUITE)).unwrap();
    let suites = [prepare(&parsed, &SourceFile::new("idioms.vert", IDIOMS)).unwrap()];
    let mut request = Request::new(200_000, 5);
    let found = check(&suites, &request, &mut |_| {}).unwrap();
    assert_eq!(found.violations(), 0, "{}", complaints(&found));
    assert!(found.judged() > found.undetermined(), "{} {}", found.judged(), found.undetermined());
    request.fault = Some(Fault { op: Op::Exp, factor: 4.0 });
    assert!(check(&suites, &request, &mut |_| {}).unwrap().violations() > 0);
}

/// What a device may surely be off by, one number a word, is at most what the tape derives, and both know the same values.
#[test]
fn the_first_look_allows_no_more_than_the_bound() {
    let models = [("vulkan-1.4", false), ("vulkan-cts", true), ("llvmpipe-22.3.6", true)];
    for suite in suites(&[]) {
        let executable = interp::compile(&suite.program).unwrap();
        let batch = Sampler::new(suite.plan.clone(), 11).batch(0, 32, 4);
        let mut plain = Machine::new(&executable, Binary64::default(), FUEL);
        let mut known = 0;
        for (profile, rearranged) in models {
            let profile = by_name(profile).unwrap();
            let tape = || Tape::new(Model::Device { profile, stage: Stage::Compute, rearranged });
            let mut moving = Machine::new(&executable, tape().with_tangents(), FUEL);
            let mut whole = Machine::new(&executable, tape(), FUEL);
            let glance = Glance::new(Model::Device { profile, stage: Stage::Compute, rearranged }, &[]);
            let mut glance = glance.map(|glance| Machine::new(&executable, glance, FUEL));
            for first in (0..batch.invocation_count()).step_by(SLOTS) {
                let slots = moving.run(&batch, first);
                plain.run(&batch, first);
                whole.run(&batch, first);
                if let Some(glance) = &mut glance {
                    glance.run(&batch, first);
                }
                for (vertex, word) in (0..plain.room()).flat_map(|v| (0..plain.width()).map(move |w| (v, w))) {
                    let at = (moving.output(vertex, word), whole.output(vertex, word), plain.output(vertex, word));
                    let (OutputColumn::Real(&a), OutputColumn::Real(&b), OutputColumn::Real(values)) = at else {
                        continue;
                    };
                    let allowed = moving.as_domain().allowance(a);
                    let bounds = whole.domain().bounds(b, &mut |_| false);
                    let meant = moving.as_domain().values(a);
                    for slot in (0..slots).filter(|&slot| vertex < plain.emitted()[slot].max(1) as usize) {
                        let (name, bound) = (&suite.suite.name, bounds.bound[slot]);
                        assert_eq!(meant[slot].to_bits(), values.values()[slot].to_bits(), "{name} {word}");
                        let sound = allowed[slot].is_nan() || (allowed[slot] <= bound && bound.is_finite());
                        assert!(sound, "{name} {}: {:e} of {bound:e}", profile.name, allowed[slot]);
                        known += usize::from(allowed[slot] > 0.25 * bound);
                        if let Some((glance, OutputColumn::Real(&seen))) =
                            glance.as_ref().map(|glance| (glance.as_domain(), glance.output(vertex, word)))
                        {
                            let glanced = glance.allowance(seen)[slot];
                            assert_eq!(glance.values(seen)[slot].to_bits(), meant[slot].to_bits(), "{name} {word}");
                            let sound = glanced.is_nan() || (glanced <= bound && bound.is_finite());
                            assert!(sound, "{name} {}: a glance {glanced:e} of {bound:e}", profile.name);
                        }
                    }
                }
            }
        }
        assert!(known > 100, "{}: {known}", suite.suite.name);
    }
}
