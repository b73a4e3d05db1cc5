//! Built-in inputs that the host or the draw decides: every lane gives the stage the value of the sample, or refuses it
//! by name; and a device that gives another one is found.

use base::text::SourceFile;
use base::value::Batch;
use engine::suite::parse;
use engine::suite::run::{FindingKind, Prepared, Report, prepare, run};
use judge::profile::Promises;
use lanes::{Actual, Description, Lane, LaneError, Runner, embedded, native, opengl, vulkan};
use program::Kernel;

use crate::binary::command;
use crate::support::request;

/// Samples of each run.
const SAMPLES: u64 = 512;

/// A suite for a shader, with groups for the inputs that it names beside its numbers.
fn suite(name: &str, text: &str, inputs: &str) -> Prepared {
    let stage = match name.rsplit('.').next() {
        Some("vert") => "vertex",
        Some("geom") => "geometry",
        _ => "fragment",
    };
    let toml = format!("suite = \"numbers\"\nshader = \"{name}\"\nstage = \"{stage}\"\n{inputs}");
    let suite = parse(&SourceFile::new("numbers.suite.toml", toml)).unwrap();
    prepare(&suite, &SourceFile::new(name, text)).unwrap_or_else(|error| panic!("{text}\n{error}"))
}

/// A vertex stage that reads one of them.
fn vertex(version: &str, value: &str) -> Prepared {
    let text = format!(
        "#version {version}\nlayout(location = 0) in vec4 p;\nvoid main() {{ gl_Position = p + vec4({value}); }}\n"
    );
    suite("t.vert", &text, "[[inputs]]\nnames = [\"p\"]\ngenerator = \"interval\"\nrange = [1.0, 2.0]\n")
}

/// The lanes that are always there, and Mesa's.
pub fn lanes() -> Vec<Box<dyn Lane>> {
    let open = |candidate: &lanes::Candidate| {
        (candidate.open)().unwrap_or_else(|missing| panic!("these tests need lane `{}`: {missing}", candidate.name))
    };
    let opengl = opengl::candidates();
    let mut all = vec![embedded::open().unwrap(), vulkan::open().unwrap(), native::open().unwrap()];
    all.extend(opengl.iter().filter(|c| c.name == "opengl").map(open));
    all
}

fn reports(prepared: &Prepared, lane: &dyn Lane) -> Vec<Report> {
    let request = request(prepared, Some(SAMPLES), Promises::of_lane(lane.description()));
    let one = |stage| run(prepared, lane, stage, &request, &mut |_| {}).unwrap_or_else(|error| panic!("{error}"));
    prepared.suite.stages(lane).into_iter().map(one).collect()
}

/// Deviations and what is told as chance.
fn accusations(report: &Report) -> Vec<&str> {
    let accuses = |kind| matches!(kind, FindingKind::Deviation | FindingKind::Flaky | FindingKind::Relation);
    report.findings.iter().filter(|f| accuses(f.kind)).map(|f| f.message.as_str()).collect()
}

/// Where every sample is judged, as `lane/stage`; all others are refused, by one of these names.
#[track_caller]
fn judged(prepared: &Prepared, names: &[&str]) -> Vec<String> {
    let mut all = Vec::new();
    for lane in lanes() {
        for report in reports(prepared, &*lane) {
            let at = format!("{}/{}", report.lane, report.stage);
            assert!(accusations(&report).is_empty(), "{names:?} on {at}: {:?}", report.findings);
            if report.unsupported == 0 {
                assert_eq!(report.judged(), SAMPLES, "{names:?} on {at}: {:?}", report.doubts);
                all.push(at);
                continue;
            }
            let why = report.unsupported_because.unwrap_or_default();
            assert!(
                names.iter().any(|n| why.contains(&format!("`{n}`"))) || why.contains("the driver has"),
                "{at}: {why}"
            );
        }
    }
    all
}

const EVERYWHERE: [&str; 5] =
    ["embedded/compute", "vulkan/compute", "vulkan/vertex", "vulkan-glslang/vertex", "opengl/vertex"];
/// Vulkan's own names are none of OpenGL.
const VULKAN: [&str; 4] = ["embedded/compute", "vulkan/compute", "vulkan/vertex", "vulkan-glslang/vertex"];
/// What wgpu does not set.
const GLSLANG: [&str; 3] = ["embedded/compute", "vulkan/compute", "vulkan-glslang/vertex"];
const COMPUTE: [&str; 2] = ["embedded/compute", "vulkan/compute"];

#[test]
fn numbers_of_the_draw_reach_the_vertex_stage_or_are_refused_by_name() {
    let table: [(&str, &str, &[&str], &[&str]); 9] = [
        ("330", "gl_VertexID", &["gl_VertexID"], &EVERYWHERE),
        ("330", "gl_InstanceID", &["gl_InstanceID"], &EVERYWHERE),
        ("450", "gl_VertexIndex", &["gl_VertexIndex"], &VULKAN),
        ("450", "gl_InstanceIndex", &["gl_InstanceIndex"], &VULKAN),
        ("460", "gl_BaseVertex", &["gl_BaseVertex"], &GLSLANG),
        ("460", "gl_BaseInstance", &["gl_BaseInstance"], &GLSLANG),
        ("460", "gl_DrawID", &["gl_DrawID"], &COMPUTE),
        // Both: of a draw in wgpu, one of them tells where the outputs go.
        (
            "330",
            "gl_VertexID * 64 + gl_InstanceID",
            &["gl_VertexID"],
            &["embedded/compute", "vulkan/compute", "vulkan-glslang/vertex", "opengl/vertex"],
        ),
        ("460", "gl_InstanceIndex + gl_BaseInstance", &["gl_InstanceIndex", "gl_BaseInstance"], &COMPUTE),
    ];
    for (version, value, names, expected) in table {
        let mut found = judged(&vertex(version, value), names);
        let mut expected: Vec<String> = expected.iter().map(|&at| at.to_owned()).collect();
        found.sort();
        expected.sort();
        assert_eq!(found, expected, "{value}");
    }
}

#[test]
fn inputs_of_the_other_stages_are_drawn_as_well() {
    let geometry = "#version 150\nlayout(triangles) in;\nlayout(points, max_vertices = 1) out;\n\
                    void main() { gl_Position = gl_in[0].gl_Position + vec4(gl_PrimitiveIDIn); EmitVertex(); }\n";
    let corners = "[[inputs]]\nnames = [\"gl_Position\"]\ngenerator = \"interval\"\nrange = [1.0, 2.0]\n";
    let primitive = suite("t.geom", geometry, corners);
    assert_eq!(judged(&primitive, &["gl_PrimitiveIDIn"]), COMPUTE);
    for name in ["gl_PrimitiveID", "gl_SampleID", "gl_SampleMaskIn[0]", "gl_Layer", "gl_ViewportIndex"] {
        let text = format!("#version 430\nout vec4 c;\nvoid main() {{ c = vec4(1.0 + float({name})); }}\n");
        assert_eq!(judged(&suite("t.frag", &text, ""), &[]), COMPUTE, "{name}");
    }
    let text =
        "#version 330\nout vec4 c;\nvoid main() { c = vec4(gl_FragCoord.xy + gl_PointCoord, gl_FrontFacing, 1); }\n";
    let inputs = "[[inputs]]\nnames = [\"gl_FragCoord\", \"gl_PointCoord\"]\ngenerator = \"interval\"\nrange = [1.0, 9.0]\n\
                  [[inputs]]\nnames = [\"gl_FrontFacing\"]\ngenerator = \"index\"\nrange = [0, 1]\n";
    assert_eq!(judged(&suite("t.frag", text, inputs), &[]), COMPUTE);
}

#[test]
fn an_array_without_an_element_for_the_number_is_not_indexed() {
    // The first shader of every tutorial of Vulkan: three corners, and no attribute.
    let text = "#version 450\nvec2 at[3] = vec2[](vec2(0.0, -0.5), vec2(0.5, 0.5), vec2(-0.5, 0.5));\n\
                void main() { gl_Position = vec4(at[gl_VertexIndex], 0.0, 1.0); }\n";
    let prepared = suite("t.vert", text, "");
    assert_eq!(prepared.program.largest("gl_VertexIndex"), Some(2));
    let mut found = judged(&prepared, &["gl_VertexIndex"]);
    found.sort();
    let mut all = VULKAN.map(str::to_owned);
    all.sort();
    assert_eq!(found, all);
}

/// A lane whose device counts otherwise: one more.
struct Miscounting(Box<dyn Lane>);

struct MiscountingRunner(Box<dyn Runner>);

impl Lane for Miscounting {
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        Ok(Box::new(MiscountingRunner(self.0.prepare(kernel, capacity)?)))
    }
}

impl Runner for MiscountingRunner {
    fn capacity(&self) -> usize {
        self.0.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let mut batch = batch.clone();
        let record = batch.invocation_record.clone();
        for (k, _) in record.fields().iter().enumerate().filter(|(_, field)| field.name.starts_with("gl_")) {
            for words in batch.invocations.chunks_exact_mut(record.words()) {
                words[record.range(k).start] += 1;
            }
        }
        self.0.run(&batch)
    }
}

#[test]
fn a_device_that_counts_otherwise_is_found_on_every_lane() {
    for (version, name) in [("330", "gl_VertexID"), ("330", "gl_InstanceID"), ("450", "gl_VertexIndex")] {
        let prepared = vertex(version, name);
        for lane in lanes() {
            for report in reports(&prepared, &Miscounting(lane)) {
                let at = format!("{name} on {}/{}", report.lane, report.stage);
                if report.unsupported > 0 {
                    continue;
                }
                let found = report.findings.iter().find(|f| f.kind == FindingKind::Deviation);
                let found = found.unwrap_or_else(|| panic!("{at}: {:?}", report.findings));
                // Shown, shrunk to the first one, and reproduced.
                let case = found.case.as_ref().unwrap();
                let input = case.inputs.iter().find(|input| input.name == format!("int {name}"));
                assert_eq!(input.unwrap_or_else(|| panic!("{at}: {:?}", case.inputs)).bits, [0], "{at}");
                assert!(found.reproduce.as_ref().unwrap().contains(&format!("{name}=00000000")), "{at}");
            }
        }
    }
}

/// Puts the number of the instance in the place of that of the vertex.
fn exchanged(words: &[u32]) -> Vec<u32> {
    const DECORATE: u32 = 4 << 16 | 71;
    const BUILT_IN: u32 = 11;
    let mut words = words.to_vec();
    for at in 0..words.len().saturating_sub(3) {
        if words[at] == DECORATE && words[at + 2] == BUILT_IN && words[at + 3] == 42 {
            words[at + 3] = 43;
        }
    }
    words
}

#[test]
fn a_translator_that_takes_another_number_is_found() {
    let prepared = vertex("330", "gl_VertexID");
    let wrong = native::open_with(exchanged).unwrap();
    let found = reports(&prepared, &*wrong);
    assert!(found.iter().all(|report| !accusations(report).is_empty()) && !found.is_empty());
    let right = native::open_with(<[u32]>::to_vec).unwrap();
    assert!(reports(&prepared, &*right).iter().all(|report| accusations(report).is_empty() && report.judged() > 0));
}

#[test]
fn a_case_is_reproduced_with_its_number() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("id.vert");
    std::fs::write(&file, "#version 330\nin vec4 p;\nvoid main() { gl_Position = p * float(gl_VertexID); }\n").unwrap();
    let mut fuzz = command(folder.path(), "fuzz id.vert --samples 4096 --lane vulkan --lane opengl");
    let ran: crate::binary::Ran = fuzz.output().unwrap().into();
    let out = ran.expect(0).out;
    assert!(out.contains("0 findings") && !out.contains("different outputs"), "{out}");
    // A value of the author's, far from any place in a batch.
    let toml = "suite = \"id\"\nshader = \"id.vert\"\nstage = \"vertex\"\n[[inputs]]\nnames = [\"p\"]\n\
                generator = \"interval\"\nrange = [1.0, 2.0]\n[[inputs]]\nnames = [\"gl_VertexID\"]\ngenerator = \"index\"\n\
                range = [0, 100000]\n";
    std::fs::write(folder.path().join("id.suite.toml"), toml).unwrap();
    let mut check = command(
        folder.path(),
        "check id.suite.toml --lane vulkan --lane opengl --lane opengl-softpipe --lane vulkan-glslang",
    );
    check.args(["--case", "p=3f800000,3f800000,3f800000,3f800000 gl_VertexID=00013880"]);
    let ran: crate::binary::Ran = check.output().unwrap().into();
    assert!(ran.expect(0).out.contains("5 judged, 5 agreed"));
}
