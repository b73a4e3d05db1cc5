//! Faults of translators: put into the SPIR-V that glslang makes, or into the module that naga reads. Each shows on
//! the lane of that translator, and not on the lane of the other one on the same driver.

use base::text::SourceFile;
use engine::suite::run::{DEFAULT_SEED, Prepared, Report, Request, prepare, run};
use engine::suite::{Suite, parse, shipped};
use judge::profile::Promises;
use judge::verdict::Blame;
use lanes::{Description, Lane, LaneError, Runner, Stage, native, vulkan};
use program::Kernel;

use crate::support::prepared;

/// Instructions of SPIR-V.
const F_ADD: u32 = 129;
const F_SUB: u32 = 131;
const EMIT_VERTEX: u32 = 218;
const END_PRIMITIVE: u32 = 219;

/// The module with each instruction replaced by what `change` gives for its number and its words.
fn changed(words: &[u32], mut change: impl FnMut(u32, &[u32]) -> Vec<u32>) -> Vec<u32> {
    let mut out = words[..5].to_vec();
    let mut at = 5;
    while at < words.len() {
        let length = (words[at] >> 16) as usize;
        out.extend(change(words[at] & 0xffff, &words[at..][..length]));
        at += length;
    }
    out
}

/// Another instruction with the same operands.
fn instead(words: &[u32], opcode: u32) -> Vec<u32> {
    let mut words = words.to_vec();
    words[0] = words[0] & 0xffff_0000 | opcode;
    words
}

fn add_for_subtract(words: &[u32]) -> Vec<u32> {
    changed(words, |opcode, words| if opcode == F_SUB { instead(words, F_ADD) } else { words.to_vec() })
}

fn subtract_for_last_add(words: &[u32]) -> Vec<u32> {
    let mut left = 0;
    changed(words, |opcode, words| {
        left += usize::from(opcode == F_ADD);
        words.to_vec()
    });
    changed(words, |opcode, words| {
        left -= usize::from(opcode == F_ADD);
        if opcode == F_ADD && left == 0 { instead(words, F_SUB) } else { words.to_vec() }
    })
}

fn without(words: &[u32], dropped: u32) -> Vec<u32> {
    let mut first = true;
    changed(words, |opcode, words| {
        let drop = opcode == dropped && std::mem::take(&mut first);
        if drop { Vec::new() } else { words.to_vec() }
    })
}

/// A lane with a wrong translation of naga: every difference is a sum.
struct WrongNaga(Box<dyn Lane>);

impl Lane for WrongNaga {
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        let mut kernel = kernel.clone();
        for (_, function) in kernel.module.functions.iter_mut() {
            for (_, expression) in function.expressions.iter_mut() {
                if let naga::Expression::Binary { op: op @ naga::BinaryOperator::Subtract, .. } = expression {
                    *op = naga::BinaryOperator::Add;
                }
            }
        }
        self.0.prepare(&kernel, capacity)
    }
}

fn glslang(fault: fn(&[u32]) -> Vec<u32>) -> Box<dyn Lane> {
    native::open_with(fault).unwrap_or_else(|missing| {
        panic!("these tests need lavapipe and glslangValidator; `cargo xtask test` installs them: {missing}")
    })
}

fn naga() -> Box<dyn Lane> {
    vulkan::open().unwrap_or_else(|missing| panic!("these tests need a Vulkan driver: {missing}"))
}

fn report(prepared: &Prepared, lane: &dyn Lane, stage: Stage, samples: u64) -> Report {
    let request = Request {
        samples: Some(samples),
        seed: DEFAULT_SEED,
        quick: true,
        replay: Vec::new(),
        replay_only: false,
        promises: Promises::of_lane(lane.description()),
        arguments: prepared.suite.name.clone(),
    };
    run(prepared, lane, stage, &request, &mut |_| {}).unwrap()
}

/// The lane deviates, in a way whose message holds `said`, and is blamed for it.
#[track_caller]
fn rings(report: &Report, said: &str) {
    let messages: Vec<&str> = report.findings.iter().map(|f| f.message.as_str()).collect();
    let blamed = |blame: Blame| {
        let of = |d: &judge::verdict::Deviation| d.blame == blame;
        report.findings.iter().filter(|f| f.case.as_ref().and_then(|c| c.deviation.as_ref()).is_some_and(of)).count()
    };
    assert!(messages.iter().any(|message| message.contains(said)), "{messages:#?}");
    assert!(blamed(Blame::Lane) > 0 && blamed(Blame::Shader) == 0, "{messages:#?}");
}

#[track_caller]
fn passes(report: &Report) {
    assert!(report.findings.is_empty(), "{:?}", report.findings);
    assert!(report.judged() > 400, "{} judged", report.judged());
}

#[test]
fn every_shipped_stage_passes_through_glslang() {
    let lane = glslang(<[u32]>::to_vec);
    let mut stages = 0;
    for shipped in shipped() {
        let prepared = prepared(shipped.name);
        for stage in [Stage::Vertex, Stage::Geometry] {
            if prepared.suite.stages(lane.as_ref()).contains(&stage) {
                passes(&report(&prepared, lane.as_ref(), stage, 512));
                stages += 1;
            }
        }
    }
    assert_eq!(stages, 14, "seven vertex stages, a geometry stage and six functions");
}

#[test]
fn a_wrong_translation_shows_on_the_lane_of_its_translator_alone() {
    let cylinder = prepared("cylinder");
    rings(&report(&cylinder, glslang(add_for_subtract).as_ref(), Stage::Vertex, 512), "`gl_Position.");
    rings(&report(&cylinder, &WrongNaga(naga()), Stage::Vertex, 512), "`gl_Position.");
    passes(&report(&cylinder, glslang(<[u32]>::to_vec).as_ref(), Stage::Vertex, 512));
    passes(&report(&cylinder, naga().as_ref(), Stage::Vertex, 512));
    // Both lanes are one executor with two front ends.
    let (one, other) = (naga(), glslang(<[u32]>::to_vec));
    let (one, other) = (one.description(), other.description());
    assert_eq!(one.executor, other.executor);
    assert_ne!(one.front_end, other.front_end);
}

#[test]
fn a_wrong_geometry_stage_is_found() {
    let hair = prepared("hair");
    rings(&report(&hair, glslang(subtract_for_last_add).as_ref(), Stage::Geometry, 512), "` of vertex ");
    let silent = |words: &[u32]| without(words, EMIT_VERTEX);
    rings(&report(&hair, glslang(silent).as_ref(), Stage::Geometry, 512), "0 vertices emitted, expected 5");
}

/// Two segments, one strip each, whose vertices may be equal.
const SEGMENTS: &str = "#version 150
layout(points) in;
layout(line_strip, max_vertices = 6) out;
in vec2 size[];
out float at;
void main() {
    gl_Position = gl_in[0].gl_Position; at = 0.0; EmitVertex();
    gl_Position = gl_in[0].gl_Position + vec4(size[0].x, 0.0, 0.0, 0.0); at = 0.0; EmitVertex();
    EndPrimitive();
    gl_Position = gl_in[0].gl_Position; at = 0.0; EmitVertex();
    gl_Position = gl_in[0].gl_Position + vec4(0.0, size[0].y, 0.0, 0.0); at = 0.0; EmitVertex();
    gl_Position = gl_in[0].gl_Position; at = 1.0; EmitVertex();
    EndPrimitive();
    gl_Position = gl_in[0].gl_Position; at = 0.0; EmitVertex();
}
";

fn segments() -> Prepared {
    let toml = "suite = \"segments\"\nshader = \"segments.geom\"\nstage = \"geometry\"\nrelations = [{ kind = \"range\", range = [0.0, 1.0], outputs = [\"at\"] }]\n\
                [[inputs]]\nnames = [\"gl_Position\"]\ngenerator = \"interval\"\nrange = [-1.0, 1.0]\n\
                [[inputs]]\nnames = [\"size\"]\ngenerator = \"interval\"\nrange = [0.0, 0.5]\n";
    let suite: Suite = parse(&SourceFile::new("segments.suite.toml", toml)).unwrap();
    prepare(&suite, &SourceFile::new("segments.geom", SEGMENTS)).unwrap()
}

#[test]
fn strips_that_end_elsewhere_are_found_and_equal_vertices_are_no_finding() {
    let segments = segments();
    passes(&report(&segments, glslang(<[u32]>::to_vec).as_ref(), Stage::Geometry, 512));
    let endless = |words: &[u32]| without(words, END_PRIMITIVE);
    rings(&report(&segments, glslang(endless).as_ref(), Stage::Geometry, 512), "does not begin a strip, and should");
}
