//! `check --sources`: the same inputs as constants, uniforms, attributes and in storage.

use std::fs;

use judge::profile::Promises;
use serde_json::Value;

use base::text::SourceFile;
use base::value::Batch;
use engine::suite::run::{FindingKind, Prepared, Report, bundles, run_from};
use judge::verdict::Blame;
use lanes::{Lane, vulkan};
use program::lower::Target;
use program::{Form, InputSource, Kernel, Program};

use crate::binary::{Ran, command, run};
use crate::support::{Planted, prepared, request};

fn device() -> Box<dyn Lane> {
    vulkan::open().expect("these tests need a Vulkan driver; `cargo xtask test` installs lavapipe")
}

fn source_of(form: &Form) -> InputSource {
    match form {
        Form::Compute | Form::Geometry | Form::Dispatch { .. } => InputSource::Storage,
        Form::Uniforms => InputSource::Uniforms,
        Form::Constants => InputSource::Constants,
        Form::Vertex { .. } => InputSource::Attributes,
    }
}

/// A lane that is wrong in kernels of one source, and in the shader itself alone.
fn planted(prepared: &Prepared, source: Option<InputSource>) -> Planted {
    let lane = Planted::new(device(), prepared);
    let takes: fn(&Kernel) -> bool = match source {
        None => return lane,
        Some(InputSource::Storage) => |kernel| source_of(&kernel.form) == InputSource::Storage,
        Some(InputSource::Uniforms) => |kernel| source_of(&kernel.form) == InputSource::Uniforms,
        Some(InputSource::Constants) => |kernel| source_of(&kernel.form) == InputSource::Constants,
        Some(InputSource::Attributes) => |kernel| source_of(&kernel.form) == InputSource::Attributes,
    };
    lane.only(takes).with(|dispatch| dispatch.each(|_, _| true, |x| x + 0.01))
}

/// Runs a shipped suite from some sources on a lane that is wrong for one of them.
fn reports(suite: &str, sources: &[InputSource], wrong: Option<InputSource>) -> Vec<Report> {
    let prepared = prepared(suite);
    let lane = planted(&prepared, wrong);
    let request = request(&prepared, Some(128), Promises::of_lane(lane.description()));
    let report = |source| {
        let report = run_from(&prepared, &lane, source, &request, &mut |_| {}).unwrap();
        for bundle in bundles(&prepared, &lane, report.stage, &request.promises, &report).unwrap() {
            assert!(bundle.name.starts_with(&format!("{suite}-vulkan-{}-", source.name())), "{}", bundle.name);
        }
        report
    };
    sources.iter().map(|&source| report(source)).collect()
}

#[test]
fn a_device_without_a_fault_passes_from_every_source() {
    // A vertex stage, a geometry stage and a function.
    for suite in ["sphere", "hair", "hermite"] {
        for report in reports(suite, &InputSource::ALL, None) {
            let source = report.source.unwrap();
            assert!(report.errors().is_empty(), "{suite} {source:?}: {:?}", report.findings);
            let least = if source == InputSource::Constants { 8 } else { 100 };
            assert!(report.judged() >= least && report.unsupported == 0, "{suite} {source:?}: {}", report.judged());
            assert_eq!(report.apart.is_some(), source != InputSource::Storage);
            assert!(report.apart.is_none_or(|apart| apart.samples >= 8));
        }
    }
}

#[test]
fn a_fault_of_one_source_is_blamed_on_the_lane_and_on_that_source() {
    for (suite, wrong) in [
        ("hermite", InputSource::Uniforms),
        ("hermite", InputSource::Constants),
        ("hermite", InputSource::Attributes),
        ("morph", InputSource::Uniforms),
        ("morph", InputSource::Attributes),
        ("hair", InputSource::Uniforms),
    ] {
        for report in reports(suite, &[InputSource::Storage, wrong], Some(wrong)) {
            let source = report.source.unwrap();
            if source != wrong {
                assert!(report.errors().is_empty(), "{suite} {wrong:?} {source:?}: {:?}", report.findings);
                continue;
            }
            let found = report.findings.iter().find(|f| f.kind == FindingKind::Deviation);
            let found = found.unwrap_or_else(|| panic!("{suite} {wrong:?}: {:?}", report.findings));
            let deviation = found.case.as_ref().and_then(|c| c.deviation.as_ref()).unwrap();
            assert_eq!(deviation.blame, Blame::Lane);
            let option = format!(" --sources {} --case ", wrong.name());
            assert!(found.reproduce.as_ref().unwrap().contains(&option), "{found:?}");
            let apart = report.apart.unwrap();
            assert_eq!(apart.different, apart.samples, "{suite} {wrong:?}");
        }
    }
}

#[test]
fn every_source_hands_over_exactly_these_bits() {
    let text = "uvec4 f(float x, ivec3 y, bool z, mat2 m) {\n\
        return uvec4(floatBitsToUint(x), uint(y.z), z ? 1u : 0u, floatBitsToUint(m[1][0]) ^ floatBitsToUint(m[0][1]));\n}\n";
    let file = SourceFile::new("bits.glsl", format!("#version 450\n{text}"));
    let target = |_: &_| Ok(Target::Function("f".to_owned()));
    let program = Program::from_source(&file, syntax::Stage::Library, target).unwrap();
    let words = [
        0x0000_0000_u32,
        0x8000_0000,
        0x3f80_0000,
        0x7f80_0000,
        0xff80_0000,
        0x7fc0_1234,
        0x7f7f_ffff,
        0x0080_0000,
        0x0000_0001,
        0x807f_ffff,
        0x3eaa_aaab,
    ];
    let record = std::sync::Arc::new(program.invocation_record());
    let mut batch = Batch::with_capacity(record, std::sync::Arc::new(program.case_record()), 1, words.len());
    for (k, word) in words.into_iter().enumerate() {
        let k = k as u32;
        batch.invocations.extend([word, 1, 2, 0xffff_fff0 + k, k % 2, 5, word, 0x3f00_0000, 7]);
    }
    let lane = device();
    for source in InputSource::ALL {
        let kernel = program.kernel_from(source, &batch).unwrap();
        let actual = lane.prepare(&kernel, words.len()).unwrap().run(&batch).unwrap();
        for (k, word) in words.into_iter().enumerate() {
            let expected = [word, 0xffff_fff0 + k as u32, k as u32 % 2, 0x3f00_0000 ^ word];
            assert_eq!(actual.vertex(k, 0), expected, "{source:?}, {word:08x}");
        }
    }
}

#[test]
fn inputs_that_do_not_fit_a_source_are_not_supported_there() {
    let folder = tempfile::tempdir().unwrap();
    let shader = "float f(float x[80]) { float s = 0.0; for (int i = 0; i < 80; i++) s += x[i]; return s; }\n";
    let suite = "suite = \"wide\"\nshader = \"f.glsl\"\nstage = \"function\"\nentry = \"f\"\nsamples = 64\n\
        [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]\n";
    fs::write(folder.path().join("f.glsl"), shader).unwrap();
    fs::write(folder.path().join("f.suite.toml"), suite).unwrap();
    let ran: Ran = command(folder.path(), "check . --lane vulkan --sources").output().unwrap().into();
    let ran = ran.expect(0);
    let line = |source: &str| ran.out.lines().find(|l| l.contains(source)).unwrap_or_else(|| panic!("{ran:?}"));
    assert!(line("vulkan/attributes").contains("64 samples not supported on this lane"), "{ran:?}");
    for source in ["vulkan/storage", "vulkan/constants", "vulkan/uniforms"] {
        assert!(line(source).contains("64 judged"), "{ran:?}");
    }
}

#[test]
fn the_report_names_the_source() {
    let ran = run("check hermite --samples 64 --lane vulkan --sources uniforms,constants --format json").expect(0);
    let json: Value = serde_json::from_str(&ran.out).unwrap();
    let suites = json["suites"].as_array().unwrap();
    let sources: Vec<&str> = suites.iter().map(|s| s["source"].as_str().unwrap()).collect();
    assert_eq!(sources, ["uniforms", "constants"]);
    for suite in suites {
        assert_eq!(
            (&suite["judged"], &suite["differs_from_storage"]["samples"]),
            (&64.into(), &64.into()),
            "{suite:#}"
        );
    }
    let ran =
        run("check sphere --shader fixtures/alarms/sphere_swapped.vert --samples 64 --lane vulkan --sources=constants");
    let ran = ran.expect(1);
    let start = "\nsphere on vulkan/compute, inputs as constants: the shader deviates from its formula: ";
    assert!(ran.out.contains(start), "{}", ran.out);
    assert!(ran.out.contains(" --lane vulkan --sources constants --case '"), "{}", ran.out);
    // The interpreter has one way to take inputs.
    let ran = run("check hermite --samples 64 --lane embedded --sources").expect(0);
    assert_eq!(ran.out.matches("samples not supported on this lane").count(), 3, "{}", ran.out);
    let ran = run("check hermite --sources push_constants").expect(2);
    assert!(ran.err.contains("there is no source `push_constants`"), "{}", ran.err);
}
