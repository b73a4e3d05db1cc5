//! A failing case as files: what another person needs to see it without this program.

use std::fmt::Write;

use serde_json::{Value, json};

use super::finding::{Case, Finding};
use super::shader_test::shader_test;
use super::trial::Trial;
use super::{Prepared, Report};
use judge::profile::Promises;
use judge::verdict::{Deviation, Value as Component};
use lanes::{Actual, Lane, LaneError, Stage};
use program::{ENTRY_POINT, InputSource, Language, Translation, binding};
use property::{Sample, regressions};

/// A failing case as files.
#[derive(Clone, Debug)]
pub struct Bundle {
    /// Name of its folder.
    pub name: String,
    /// Names and contents.
    pub files: Vec<(String, Vec<u8>)>,
}

/// The failing cases of a report as files: the shader and what it was lowered to, SPIR-V, inputs and
/// outputs as bits, the command that runs the case again, a test for piglit's `shader_runner`, and an Amber
/// script where what is run is a compute kernel.
///
/// # Errors
/// [`LaneError`] when the lane fails on a case that it ran before.
pub fn bundles(
    prepared: &Prepared,
    lane: &dyn Lane,
    stage: Stage,
    promises: &Promises,
    report: &Report,
) -> Result<Vec<Bundle>, LaneError> {
    let kernel = prepared.kernel(stage).unwrap_or(&prepared.compute);
    let cases: Vec<(&Finding, &Case)> = report.findings.iter().filter_map(|f| Some((f, f.case.as_ref()?))).collect();
    if cases.is_empty() {
        return Ok(Vec::new());
    }
    let mut trial = match report.source {
        Some(source) => Trial::from_source(prepared, lane, source, promises, 1)?,
        None => Trial::with_capacity(prepared, lane, kernel, promises, 1)?,
    };
    let way = report.source.map_or(stage.name(), InputSource::name);
    let mut all = Vec::new();
    for (k, (finding, case)) in cases.into_iter().enumerate() {
        let sample = sample(prepared, case);
        let actual = trial.run(&Sample::batch(std::slice::from_ref(&sample)))?;
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
        let suite: String = report.suite.chars().map(plain).collect();
        let name = format!("{suite}-{}-{way}-{}", report.lane, k + 1);
        all.push(Bundle { name, files: files(prepared, report, finding, case, &sample, &actual) });
    }
    Ok(all)
}

/// The inputs of a case as a sample.
pub(super) fn sample(prepared: &Prepared, case: &Case) -> Sample {
    let (invocation, cases) = (&prepared.compute.invocation, &prepared.compute.case);
    let mut sample = Sample {
        invocation_record: invocation.clone(),
        case_record: cases.clone(),
        invocation: vec![0; invocation.words()],
        case: vec![0; cases.words()],
    };
    for input in &case.inputs {
        // The type stands before the name.
        let name = input.name.rsplit(' ').next().unwrap_or_default();
        if let Some(words) = sample.words_mut(name) {
            words.copy_from_slice(&input.bits);
        }
    }
    sample
}

fn files(
    prepared: &Prepared,
    report: &Report,
    finding: &Finding,
    case: &Case,
    sample: &Sample,
    actual: &Actual,
) -> Vec<(String, Vec<u8>)> {
    let file = &prepared.program.file;
    let ending = file.name().rsplit(['/', '\\']).next().and_then(|name| name.rsplit_once('.'));
    let ending = ending.map_or("glsl", |(_, ending)| ending);
    let mut files = vec![
        (format!("shader.{ending}"), file.text().as_bytes().to_vec()),
        ("case.json".to_owned(), format!("{:#}\n", described(report, finding, case, actual)).into_bytes()),
    ];
    if let Ok(Translation::Text(text)) = prepared.program.translate(Language::NagaGlsl) {
        files.push((format!("lowered.{ending}"), text.into_bytes()));
    }
    if let Some(command) = &finding.reproduce {
        files.push(("reproduce.sh".to_owned(), format!("#!/bin/sh\n{command}\n").into_bytes()));
    }
    let test = case.deviation.as_ref().and_then(|d| shader_test(prepared, &finding.message, d, sample));
    if let Some(test) = test {
        files.push(("case.shader_test".to_owned(), test.into_bytes()));
    }
    // What a language cannot express has been told by the run; here the file is left out.
    if let Ok(translation) = prepared.program.translate(Language::SpirV) {
        let words = translation.into_bytes();
        if prepared.vertex.is_none() {
            let script = amber(prepared, &finding.message, case.deviation.as_ref(), sample, &words);
            files.push(("case.amber".to_owned(), script.into_bytes()));
        }
        files.push(("shader.spv".to_owned(), words));
    }
    files
}

fn described(report: &Report, finding: &Finding, case: &Case, actual: &Actual) -> Value {
    let record = &actual.layout().vertex;
    let hex = |word: &u32| format!("{word:08x}");
    let inputs: Vec<Value> = case
        .inputs
        .iter()
        .map(|input| json!({ "name": input.name, "bits": input.bits.iter().map(hex).collect::<Vec<_>>(), "values": input.decimal }))
        .collect();
    let mut outputs = Vec::new();
    for vertex in 0..actual.stored(0) {
        for (word, bits) in actual.vertex(0, vertex).iter().enumerate().take(record.words()) {
            let value = regressions::decimal(*bits, record.scalar_of(word));
            let value = if actual.is_unwritten(*bits) { "not written".to_owned() } else { value };
            outputs
                .push(json!({ "vertex": vertex, "name": record.word_name(word), "bits": hex(bits), "value": value }));
        }
    }
    json!({
        "suite": report.suite, "shader": report.shader, "lane": report.lane, "stage": report.stage.name(),
        "source": report.source.map(InputSource::name),
        "message": finding.message, "reproduce": finding.reproduce, "inputs": inputs, "outputs": outputs,
    })
}

/// A script for Amber that runs the kernel on the case, and expects what the shader should give of the
/// component that deviates.
fn amber(prepared: &Prepared, message: &str, deviation: Option<&Deviation>, sample: &Sample, spirv: &[u8]) -> String {
    let mut text = format!("#!amber\n# {}: {message}\n\nSHADER compute kernel SPIRV-HEX\n", prepared.shader);
    for line in spirv.chunks(32) {
        let words = line.chunks_exact(4).map(|b| format!("0x{:08x}", u32::from_le_bytes([b[0], b[1], b[2], b[3]])));
        let _ = writeln!(text, "{}", words.collect::<Vec<_>>().join(" "));
    }
    text.push_str("END\n\n");
    let layout = &prepared.compute.output;
    let mut bound = vec![("params", "uniform", binding::PARAMS), ("outputs", "storage", binding::OUTPUTS)];
    let _ = writeln!(text, "# invocations, invocations of a case, canary, sentinel");
    let _ = writeln!(text, "BUFFER params DATA_TYPE uint32 DATA\n1 1 {CANARY} {SENTINEL}\nEND");
    let _ = writeln!(text, "BUFFER outputs DATA_TYPE float SIZE {} FILL 0.0", layout.words());
    for (name, at, words) in
        [("invocations", binding::INVOCATIONS, &sample.invocation), ("cases", binding::CASES, &sample.case)]
    {
        if !words.is_empty() {
            let list: Vec<String> = words.iter().map(|word| format!("0x{word:08x}")).collect();
            let _ = writeln!(text, "BUFFER {name} DATA_TYPE uint32 DATA\n{}\nEND", list.join(" "));
            bound.push((name, "storage", at));
        }
    }
    let _ = writeln!(text, "\nPIPELINE compute run\n  ATTACH kernel ENTRY_POINT {ENTRY_POINT}");
    for (name, kind, at) in bound {
        let _ = writeln!(text, "  BIND BUFFER {name} AS {kind} DESCRIPTOR_SET 0 BINDING {at}");
    }
    text.push_str("END\n\nRUN run 1 1 1\n");
    if let Some((deviation, value)) = deviation.and_then(|d| Some((d, d.value()?))) {
        text.push_str(&expectation(prepared, deviation, value).unwrap_or_default());
    }
    text
}

/// Any words that tell a record that was written from one that was not.
const CANARY: u32 = 0x1357_9bdf;
const SENTINEL: u32 = 0x7fc0_dead;

fn expectation(prepared: &Prepared, deviation: &Deviation, value: &Component) -> Option<String> {
    if value.scalar != base::value::Scalar::F32 {
        return None;
    }
    let layout = &prepared.compute.output;
    let word = (0..layout.vertex.words()).find(|&word| layout.vertex.word_name(word) == value.component)?;
    let strip = usize::from(layout.max_vertices.is_some());
    let at = layout.header_words() + value.vertex.unwrap_or(0) * layout.vertex_words() + strip + word;
    let (target, bound) =
        (deviation.target(value), value.bound.max(f64::from(f32::EPSILON) * deviation.target(value).abs()));
    let component = &value.component;
    Some(format!("# {component}\nEXPECT outputs IDX {} TOLERANCE {bound:?} EQ {target:?}\n", 4 * at))
}
