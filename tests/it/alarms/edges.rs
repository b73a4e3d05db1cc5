//! Faults in shaders that show at an edge alone: beside a knot or a branch, at coincident points, for the least and
//! the greatest number of bones, for a zero with a sign.

use engine::suite::run::{self, DEFAULT_SEED, Prepared, Report};
use judge::profile::Promises;
use judge::verdict::{Failure, JudgeContext, shader_deviation};
use lanes::{self, Stage};
use property::{Sample, Sampler};
use rayon::prelude::*;

use crate::support::{changed, prepared, report};

/// Suite, the author's text, and what stands in its place.
type Fault = (&'static str, &'static str, &'static str);

/// Shapes: the end of a skeleton or of a segment, and numbers of bones.
const SEGMENTS: &[Fault] = &[
    (
        "skinning",
        "gl_Position = projectionMatrix * u;",
        "if (numberOfBones == 0) u = vec4(0.0, 0.0, 0.0, 1.0); gl_Position = projectionMatrix * u;",
    ),
    ("skinning", "i < numberOfBones; ++i", "i == 0 || i < numberOfBones; ++i"),
    ("skinning", "i < numberOfBones; ++i", "i < min(numberOfBones, MAXBONES - 1); ++i"),
    (
        "skinning",
        "gl_Position = projectionMatrix * u;",
        "if (numberOfBones == MAXBONES) u *= 1.0001; gl_Position = projectionMatrix * u;",
    ),
    ("skinning", "pow(length(v2) + 1.0, exponent)", "pow(length(v2) + (i == MAXBONES - 1 ? 1.0001 : 1.0), exponent)"),
    (
        "skinning",
        "pow(length(v2) + 1.0, exponent)",
        "pow(length(v2) + (i == numberOfBones - 1 && numberOfBones == MAXBONES ? 1.0001 : 1.0), exponent)",
    ),
    ("skinning", "if (l > 0.0)", "if (l > 1e-10)"),
    ("skinning", "if (l > 0.0)", "if (l >= 1e-11)"),
    ("skinning", "if (l > 0.0)", "if (sqrt(l) > 5e-6)"),
    ("skinning", "if (l > 0.0)", "if (length(v1) > 1e-6)"),
    ("skinning", "if (l > 0.0)", "if (max(abs(v1.x), max(abs(v1.y), abs(v1.z))) > 8e-6)"),
    ("skinning", "float l = dot(v1, v1);", "float l = dot(v1, v1); if (p0[i] == p1[i]) v2 *= 1.001;"),
    (
        "skinning",
        "float l = dot(v1, v1);",
        "float l = dot(v1, v1); if (i > 0 && p0[i] == p0[i - 1] && p1[i] == p1[i - 1]) v2 *= 1.001;",
    ),
    ("skinning", "clamp(dot(v1, v2) / l, 0.0, 1.0)", "clamp(dot(v1, v2) / l, 0.0, 0.9999)"),
    ("skinning", "clamp(dot(v1, v2) / l, 0.0, 1.0)", "clamp(dot(v1, v2) / l, 5e-5, 1.0)"),
    ("skinning", "u += pow", "if (length(v2) == 0.0) v2 = vec4(0.001); u += pow"),
    (
        "skinning",
        "vec4 u = vec4(0.0);",
        "vec4 u = vec4(0.0); if (floatBitsToUint(position.x) == 0x80000000u) u.w = 0.001;",
    ),
    ("segment_distance", "if (l > 0.0)", "if (l > 1e-10)"),
    ("segment_distance", "if (l > 0.0)", "if (l > 1e-13)"),
    ("segment_distance", "clamp(dot(v1, v2) / l, 0.0, 1.0)", "clamp(dot(v1, v2) / l, 0.0, 0.99999)"),
    ("segment_distance", "clamp(dot(v1, v2) / l, 0.0, 1.0)", "clamp(dot(v1, v2) / l, -1e-5, 1.0)"),
    ("segment_distance", "return length(v2);", "if (p == p1) return 0.001; return length(v2);"),
    ("segment_distance", "return length(v2);", "if (p == p0 && p0 != p1) return 0.001; return length(v2);"),
    (
        "segment_distance",
        "return length(v2);",
        "float q = dot(v1, p - p0) / l; if (q > 0.5 && q < 0.5001) return length(v2) * 1.001; return length(v2);",
    ),
    (
        "segment_distance",
        "return length(v2);",
        "float q = dot(v1, p - p0) / l; if (abs(q - 0.25) < 2e-6) return length(v2) * 1.001; return length(v2);",
    ),
    (
        "segment_distance",
        "return length(v2);",
        "float q = dot(v1, p - p0) / l; if (q <= 1.0 && q > 0.99999) return length(v2) + 0.001; return length(v2);",
    ),
    ("segment_distance", "return length(v2);", "return length(v2) < 1e-5 ? 0.0 : length(v2);"),
];

/// Weights, blends and surfaces: the ends of an interval and beside them.
const INTERVALS: &[Fault] = &[
    ("bone_weight", "return pow", "if (d < 1e-6) return 1.0; return pow"),
    ("bone_weight", "return pow", "if (floatBitsToUint(d) == 0x80000000u) return 0.999; return pow"),
    ("bone_weight", "return pow", "if (c > 63.9999) return pow(d + 1.0, -64.0); return pow"),
    ("bone_weight", "return pow", "if (abs(d - 1.0) < 1e-6) return pow(2.0, -c) * 1.0001; return pow"),
    ("bone_weight", "return pow", "if (d > 0.75 && d < 0.75001) return 0.0; return pow"),
    ("bone_weight", "return pow", "if (c == 1.0) return 1.0 / (d + 1.0001); return pow"),
    ("bone_weight", "return pow", "if (d > 2.49999) return 0.0; return pow"),
    (
        "bone_weight",
        "return pow(d + 1.0, -c)",
        "return pow(d + 1.0, -c) + 0.001 * step(0.9, fract(d)) * step(fract(d), 0.900003)",
    ),
    ("morph", "mix(p0, p1, t)", "mix(p0, p1, t == 0.0 ? 0.0001 : t)"),
    ("morph", "mix(p0, p1, t)", "mix(p0, p1, t > 0.99995 ? 1.0 : t)"),
    ("morph", "mix(p0, p1, t)", "mix(p0, p1, t < 3e-6 ? 0.0 : t)"),
    ("morph", "mix(p0, p1, t)", "mix(p0, p1, abs(t - 0.5) < 2e-6 ? 0.5001 : t)"),
    ("morph", "mix(p0, p1, t)", "(p0 == p1 ? p0 * 1.0001 : mix(p0, p1, t))"),
    ("morph", "mix(p0, p1, t)", "mix(p0, p1, t >= 0.3 && t < 0.30001 ? 0.3001 : t)"),
    ("morph", "mix(p0, p1, t)", "mix(p0, p1, t + 0.001 * smoothstep(0.70001, 0.7, t) * smoothstep(0.69999, 0.7, t))"),
    ("morph_targets", "vec4 p = pn;", "vec4 p = pn; if (w[3] < 0.0 && w[3] > -1e-5) p.x += 0.001;"),
    ("morph_targets", "vec4 p = pn;", "vec4 p = pn; if (w[2] == 1.0 && w[1] > 1.4999) p.x += 0.001;"),
    ("morph_targets", "vec4 p = pn;", "vec4 p = pn; if (p2 == p3) p.x += 0.001;"),
    ("sphere", "float r = sin(ph);", "float r = sin(ph); if (parameter.t == 1.0) r = 0.001;"),
    ("sphere", "float r = sin(ph);", "float r = sin(ph); if (parameter.t < 1e-6 && parameter.s > 0.5) r = 0.0;"),
    ("sphere", "float r = sin(ph);", "float r = sin(ph); if (parameter.s > 0.25 && parameter.s < 0.25001) r += 0.001;"),
    ("sphere", "float r = sin(ph);", "float r = sin(ph); if (parameter.s == 1.0 && parameter.t == 0.5) r += 0.001;"),
    (
        "cylinder",
        "float y = parameter.t * 2.0 - 1.0;",
        "float y = parameter.t * 2.0 - 1.0; if (parameter.s > 0.99999) y += 0.001;",
    ),
    (
        "cylinder",
        "float y = parameter.t * 2.0 - 1.0;",
        "float y = parameter.t * 2.0 - 1.0; if (abs(y) < 1e-6 && parameter.t < 0.5) y = -y;",
    ),
    (
        "two_bones",
        "candidate0 = blendMatrix[0] * position;",
        "candidate0 = blendMatrix[0] * position; if (weight.x == weight.y) candidate0.x += 0.001;",
    ),
    (
        "two_bones",
        "candidate0 = blendMatrix[0] * position;",
        "candidate0 = blendMatrix[0] * position; if (weight.y > 0.0 && weight.y < 1e-6) candidate0.x += 0.001;",
    ),
];

/// Curves: knots, equal keys, the ends of the parameters.
const CURVES: &[Fault] = &[
    ("hermite", "vec4 dp = p0 - p1;", "vec4 dp = p0 - p1; if (s > 0.5 && s < 0.50001) dp *= 1.001;"),
    ("hermite", "vec4 dp = p0 - p1;", "vec4 dp = p0 - p1; if (p0 == p1) dp.x = 0.001;"),
    ("hermite", "vec4 dp = p0 - p1;", "vec4 dp = p0 - p1; if (floatBitsToInt(s) < 0) return p1;"),
    ("catmull_rom", "vec4 dp = q1 - q2;", "vec4 dp = q1 - q2; if (s == 1.0) dp.x += 0.001;"),
    ("catmull_rom", "vec4 dp = q1 - q2;", "vec4 dp = q1 - q2; if (s < 5e-6) m0 = vec4(0.0);"),
    ("catmull_rom", "vec4 dp = q1 - q2;", "vec4 dp = q1 - q2; if (q1 == q2) m0 = vec4(0.0);"),
    ("catmull_rom", "vec4 dp = q1 - q2;", "vec4 dp = q1 - q2; if (q0 == q1 && q2 != q3) m0 *= 1.001;"),
    (
        "catmull_rom",
        "vec4 dp = q1 - q2;",
        "vec4 dp = q1 - q2; float d = distance(q1, q2); if (d > 0.0 && d < 1e-5) m0 = vec4(0.0);",
    ),
    ("cardinal", "vec4 dp = q1 - q2;", "vec4 dp = q1 - q2; if (w == 1.0) dp *= 1.001;"),
    ("cardinal", "vec4 dp = q1 - q2;", "vec4 dp = q1 - q2; if (s > 0.99999) dp *= 1.001;"),
    ("cardinal", "vec4 dp = q1 - q2;", "vec4 dp = q1 - q2; if (int(s * 4.0) == 4) dp *= 1.001;"),
    ("cardinal", "vec4 dp = q1 - q2;", "vec4 dp = q1 - q2; if (fract(s * 3.0) < 3e-6 && s > 0.5) dp *= 1.001;"),
    ("kochanek_bartels", "vec4 d0 = q1 - q0;", "vec4 d0 = q1 - q0; if (q2 == q3) d0 *= 1.001;"),
    ("kochanek_bartels", "vec4 d0 = q1 - q0;", "vec4 d0 = q1 - q0; if (tension > 0.99999) d0 *= 1.001;"),
    (
        "kochanek_bartels",
        "vec4 d0 = q1 - q0;",
        "vec4 d0 = q1 - q0; if (continuity == -1.0 && bias == 1.0) d0 += 0.001;",
    ),
    ("kochanek_bartels", "vec4 d0 = q1 - q0;", "vec4 d0 = q1 - q0; if (bias > 0.25 && bias <= 0.250005) d0 *= 1.001;"),
    ("hair", "vec4 dp = q1 - q2;", "vec4 dp = q1 - q2; if (q1 == q2 && q0 != q1) dp.x += 0.001;"),
    ("hair", "vec4 dp = q1 - q2;", "vec4 dp = q1 - q2; if (q0 == q1 && q2 == q3 && q1 != q2) m0 *= 1.001;"),
];

/// A shipped suite with another text in the place of a part of its shader.
fn faulty(&(suite, from, to): &Fault) -> Prepared {
    let text = |text: &str| {
        assert!(text.contains(from), "{suite}: {from}");
        let text = text.replacen(from, to, 1);
        // Bits of numbers came later than the shipped version.
        if to.contains("floatBits") { text.replacen("#version 150", "#version 330", 1) } else { text }
    };
    changed(suite, |suite| suite, text)
}

/// Runs a suite as `check --quick --lane embedded` does.
fn quick(prepared: &Prepared) -> Report {
    let lane = lanes::embedded::open().unwrap();
    report(prepared, lane.as_ref(), None, Promises::of_lane(lane.description()))
}

/// The first deviation of the shader among the samples of a quick run: those at edges, then the others.
fn deviation(prepared: &Prepared) -> Option<Failure> {
    let promises = Promises::of_lane(lanes::embedded::open().unwrap().description());
    let (oracle, reference) = (&prepared.oracle, &prepared.reference);
    let context = JudgeContext { oracle, reference, promises: &promises, stage: Stage::Compute };
    let layout = &prepared.compute.output;
    let edges = Sample::batch(&run::edges_of(prepared, DEFAULT_SEED, 8192).samples);
    shader_deviation(&context, layout, &edges).or_else(|| {
        let batch = Sampler::new(prepared.plan.clone(), DEFAULT_SEED).batch(0, 512, 16);
        shader_deviation(&context, layout, &batch)
    })
}

/// What a quick run does not reach: values of two inputs at once of which no comparison that is met alone leads to the
/// other. Whoever reaches one takes it from this list.
const BEYOND: [&str; 3] = [
    "if (length(v2) == 0.0) v2 = vec4(0.001); u += pow",
    "vec4 dp = q1 - q2; if (int(s * 4.0) == 4) dp *= 1.001;",
    "vec4 d0 = q1 - q0; if (continuity == -1.0 && bias == 1.0) d0 += 0.001;",
];

/// All of these but what is beyond reach are among what a quick run looks at.
fn found(faults: &[Fault]) {
    let alive: Vec<&Fault> = faults.par_iter().filter(|fault| deviation(&faulty(fault)).is_none()).collect();
    let (known, new): (Vec<&Fault>, Vec<&Fault>) = alive.into_iter().partition(|(.., to)| BEYOND.contains(to));
    assert!(new.is_empty(), "{} of {} are not found: {new:#?}", new.len(), faults.len());
    let expected = faults.iter().filter(|(.., to)| BEYOND.contains(to)).count();
    assert_eq!(known.len(), expected, "some of these are found now: {known:#?}");
}

#[test]
fn a_fault_that_shows_at_an_edge_alone_is_reported_with_a_case_as_the_shaders() {
    let report = quick(&faulty(&("skinning", "if (l > 0.0)", "if (l > 1e-10)")));
    assert!(report.verdicts.shader_deviated > 0 && report.verdicts.shader_deviated == report.verdicts.deviated);
    assert_eq!(report.verdicts.agreed, 8192, "none of the ordinary samples shows it");
    assert!(report.findings[0].case.is_some() && report.findings[0].reproduce.is_some());
}

#[test]
fn faults_of_segments_at_their_ends_are_found_in_a_quick_run() {
    found(SEGMENTS);
}

#[test]
fn faults_beside_the_knots_of_an_interval_are_found_in_a_quick_run() {
    found(INTERVALS);
}

#[test]
fn faults_of_curves_at_equal_keys_and_knots_are_found_in_a_quick_run() {
    found(CURVES);
}

/// Branches that mean the same as the shipped text, or nothing that a formula could notice.
const HARMLESS: &[Fault] = &[
    ("skinning", "if (l > 0.0)", "if (l != 0.0)"),
    ("skinning", "if (l > 0.0)", "if (l > 1e-40)"),
    ("segment_distance", "if (l > 0.0)", "if (p0 != p1)"),
    ("bone_weight", "return pow", "if (d < 0.3) return 1.0 / pow(d + 1.0, c); return pow"),
    ("morph", "mix(p0, p1, t)", "(t < 0.3 ? p0 + t * (p1 - p0) : mix(p0, p1, t))"),
    ("sphere", "float r = sin(ph);", "float r = abs(sin(ph)); if (parameter.t == 0.0) r = 0.0;"),
    ("hermite", "vec4 dp = p0 - p1;", "if (s == 0.0) return p0; vec4 dp = p0 - p1;"),
    ("cardinal", "vec4 dp = q1 - q2;", "vec4 dp = q1 - q2; if (floor(s * 4.0) == 4.0) return q2;"),
];

#[test]
fn shaders_that_branch_where_their_formula_does_not_and_mean_the_same_pass() {
    for fault in HARMLESS {
        let report = quick(&faulty(fault));
        assert!(report.errors().is_empty(), "{fault:?}: {:?}", report.errors());
    }
}

#[test]
fn shipped_shaders_come_out_both_ways_wherever_they_compare() {
    for shipped in engine::suite::shipped() {
        let report = quick(&prepared(shipped.name));
        let reach = report.reach.as_ref().unwrap();
        assert!(reach.edges > 0, "{}", shipped.name);
        let one_sided: Vec<String> = reach.one_sided().map(ToString::to_string).collect();
        assert!(one_sided.is_empty(), "{}: {one_sided:?}", shipped.name);
        assert_eq!(reach.edges, reach.agreed + reach.undetermined, "{}", shipped.name);
        // What is at edges is no part of the counts of a run.
        assert_eq!(report.verdicts.seen() % 8192, if shipped.name == "hair" { 3 } else { 0 }, "{}", shipped.name);
    }
}

#[test]
fn a_comparison_that_cannot_come_out_both_ways_is_named() {
    let report = quick(&faulty(&("morph", "mix(p0, p1, t)", "(t > 2.0 ? p0 : mix(p0, p1, t))")));
    let one_sided: Vec<String> = report.reach.unwrap().one_sided().map(ToString::to_string).collect();
    assert_eq!(one_sided.len(), 1, "{one_sided:?}");
    assert!(one_sided[0].starts_with("`t > 2.0` is never true, at morph.vert:"), "{one_sided:?}");
}

#[test]
fn edges_depend_on_the_suite_the_seed_and_the_number_of_samples_alone() {
    let [a, b] = [0, 1].map(|_| run::edges_of(&prepared("segment_distance"), 7, 8192));
    assert_eq!(a.samples, b.samples);
    assert_eq!(a.samples, run::edges_of(&prepared("segment_distance"), 7, 65536).samples);
    assert_ne!(a.samples, run::edges_of(&prepared("segment_distance"), 8, 8192).samples);
}
