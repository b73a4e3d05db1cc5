//! The faults of other programs in `upstream/`: each shows as its folder says. One that is gone fails here, so that nothing
//! is worked around for longer than it has to be.

use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Command;

use naga::back::{spv, wgsl};
use naga::front::glsl;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};
use serde::Deserialize;
use test_record::not_run;

use crate::binary::root;
use crate::webgpu::command;

/// `case.toml` of a folder.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    tool: String,
    version: String,
    file: String,
    reader: Reader,
    /// The lane of [`Reader::Lane`].
    lane: Option<String>,
    /// Where it is reported.
    known: Option<String>,
    shows: Shows,
}

/// What reads the text.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Reader {
    NagaGlsl,
    /// naga's reader of WGSL, and then its reader of the SPIR-V that it writes.
    NagaWgslSpirv,
    /// naga's reader of WGSL, and its writer of GLSL 4.50 for the stage `main`.
    NagaWgslGlsl,
    /// glslang, and then naga's reader of SPIR-V.
    GlslangNaga,
    GlslangHlsl,
    /// `shadercheck check` of the suite of the folder, on a lane.
    Lane,
}

/// How the fault shows.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Shows {
    outcome: Outcome,
    /// Texts that are there, in this order.
    contains: Vec<String>,
    #[serde(default)]
    lacks: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Outcome {
    Wgsl,
    Glsl,
    Refused,
    Panic,
    /// Decorations before and after.
    Words,
    Assembly,
    /// What `check` says.
    Report,
}

fn folders() -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join("upstream")).unwrap().map(|entry| entry.unwrap().path());
    let mut folders: Vec<PathBuf> = entries.filter(|path| path.is_dir()).collect();
    folders.sort();
    folders
}

fn case(folder: &Path) -> Case {
    let text = fs::read_to_string(folder.join("case.toml")).unwrap();
    toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
}

fn validated(module: &Module) -> Result<ModuleInfo, String> {
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::all());
    validator.validate(module).map_err(|error| format!("{error:?}"))
}

fn words(module: &Module) -> Result<Vec<u32>, String> {
    let info = validated(module)?;
    spv::write_vec(module, &info, &spv::Options::default(), None).map_err(|error| error.to_string())
}

fn in_glsl(module: &Module) -> Result<String, String> {
    let info = validated(module)?;
    let options = naga::back::glsl::Options { version: naga::back::glsl::Version::Desktop(450), ..Default::default() };
    let entry = &module.entry_points[0];
    let pipeline = naga::back::glsl::PipelineOptions {
        shader_stage: entry.stage,
        entry_point: entry.name.clone(),
        multiview: None,
    };
    let (mut text, policies) = (String::new(), naga::proc::BoundsCheckPolicies::default());
    naga::back::glsl::Writer::new(&mut text, module, &info, &options, &pipeline, policies)
        .and_then(|mut writer| writer.write())
        .map_err(|error| error.to_string())?;
    Ok(text)
}

fn read_spirv(words: &[u32]) -> Result<Module, String> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    naga::front::spv::parse_u8_slice(&bytes, &Default::default()).map_err(|error| format!("{error:?}"))
}

/// Instructions `OpDecorate _ NoContraction`.
fn decorations(words: &[u32]) -> usize {
    const OP_DECORATE: u32 = 71;
    const NO_CONTRACTION: u32 = 42;
    let (mut at, mut count) = (5, 0);
    while let Some(&first) = words.get(at) {
        count += usize::from(first & 0xffff == OP_DECORATE && words.get(at + 2) == Some(&NO_CONTRACTION));
        at += (first >> 16).max(1) as usize;
    }
    count
}

fn glslang(arguments: &[&str], file: &Path) -> Option<String> {
    let output = Command::new("glslangValidator").args(arguments).arg(file).output().ok()?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// What `check` says of the suite beside a file on a lane; nothing where the lane is not there, or its driver has another
/// version.
fn reported(file: &Path, lane: &str, version: &str) -> Option<(Outcome, String)> {
    let lanes = command(root(), "lanes").output().unwrap();
    if !String::from_utf8_lossy(&lanes.stdout).contains(version) {
        return None;
    }
    let suite = file.with_file_name("repro.suite.toml");
    let mut check = command(root(), "check --samples 256");
    check.arg(suite).args(["--lane", lane]);
    let ran = check.output().unwrap();
    let missing = String::from_utf8_lossy(&ran.stderr).contains("is not available");
    // Of a lane that nobody knows here, such as a driver that is not installed, the name is unknown.
    let unknown = ran.status.code() == Some(2);
    (!missing && !unknown).then(|| (Outcome::Report, String::from_utf8_lossy(&ran.stdout).into_owned()))
}

/// What the tool makes of the text; nothing where it is not installed.
fn outcome(reader: Reader, file: &Path) -> Option<(Outcome, String)> {
    let text = fs::read_to_string(file).unwrap();
    let written = |module: &Module| -> Result<String, String> {
        let info = validated(module)?;
        wgsl::write_string(module, &info, wgsl::WriterFlags::empty()).map_err(|error| error.to_string())
    };
    let by_naga = || match reader {
        Reader::NagaGlsl => {
            let stage = match file.extension().and_then(|ending| ending.to_str()) {
                Some("vert") => ShaderStage::Vertex,
                Some("comp") => ShaderStage::Compute,
                _ => ShaderStage::Fragment,
            };
            let read = glsl::Frontend::default().parse(&glsl::Options::from(stage), &text);
            read.map_err(|errors| errors.emit_to_string(&text)).and_then(|module| written(&module))
        }
        Reader::NagaWgslGlsl => in_glsl(&naga::front::wgsl::parse_str(&text).unwrap()),
        _ => {
            let module = naga::front::wgsl::parse_str(&text).unwrap();
            words(&module).and_then(|words| read_spirv(&words)).and_then(|module| written(&module))
        }
    };
    Some(match reader {
        Reader::Lane => {
            let case = case(file.parent().unwrap());
            return reported(file, &case.lane.unwrap(), &case.version);
        }
        Reader::NagaGlsl | Reader::NagaWgslSpirv | Reader::NagaWgslGlsl => {
            match catch_unwind(AssertUnwindSafe(by_naga)) {
                Ok(Ok(text)) if matches!(reader, Reader::NagaWgslGlsl) => (Outcome::Glsl, text),
                Ok(Ok(text)) => (Outcome::Wgsl, text),
                Ok(Err(message)) => (Outcome::Refused, message),
                Err(panic) => {
                    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
                    (Outcome::Panic, text.or(panic.downcast_ref::<String>().cloned()).unwrap_or_default())
                }
            }
        }
        Reader::GlslangNaga => {
            let target = tempfile::tempdir().unwrap();
            let target = target.path().join("repro.spv");
            glslang(&["-V", "-o", target.to_str().unwrap()], file)?;
            let bytes = fs::read(&target).unwrap();
            let before: Vec<u32> = bytes.chunks(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect();
            let after = words(&read_spirv(&before).unwrap()).unwrap();
            (Outcome::Words, format!("NoContraction {} -> {}", decorations(&before), decorations(&after)))
        }
        Reader::GlslangHlsl => {
            let target = tempfile::tempdir().unwrap();
            let target = target.path().join("repro.spv");
            let arguments = ["-D", "-V", "-H", "-S", "frag", "-e", "main", "-o", target.to_str().unwrap()];
            (Outcome::Assembly, glslang(&arguments, file)?)
        }
    })
}

/// Why the fault does not show as it is described.
fn gone(shows: &Shows, (outcome, text): &(Outcome, String)) -> Option<String> {
    if *outcome != shows.outcome {
        return Some(format!("{outcome:?} instead of {:?}:\n{text}", shows.outcome));
    }
    let mut rest = text.as_str();
    for part in &shows.contains {
        let Some((_, behind)) = rest.split_once(part.as_str()) else {
            return Some(format!("`{part}` is not there, or not in this order:\n{text}"));
        };
        rest = behind;
    }
    let there = shows.lacks.iter().find(|part| text.contains(part.as_str()));
    there.map(|part| format!("`{part}` is there:\n{text}"))
}

#[test]
fn every_fault_is_still_there() {
    let mut wrong = Vec::new();
    for folder in folders() {
        let (name, case) = (folder.file_name().unwrap().to_string_lossy().into_owned(), case(&folder));
        match outcome(case.reader, &folder.join(&case.file)) {
            None => not_run(&format!("{name}: {} is not installed", case.tool)),
            Some(found) => wrong.extend(gone(&case.shows, &found).map(|why| format!("{name}: {why}"))),
        }
    }
    assert!(wrong.is_empty(), "gone or changed; see upstream/README.md\n{}", wrong.join("\n"));
}

#[test]
fn a_fault_that_is_gone_is_reported() {
    let folder = root().join("upstream/naga-do-while-continue");
    let case = case(&folder);
    let found = outcome(case.reader, &folder.join(&case.file)).unwrap();
    assert_eq!(gone(&case.shows, &found), None);
    // As the loop will be written once `continue` goes to the condition.
    let mended = (found.0, found.1.replace("loop {", "loop { continuing { break if true; }"));
    assert!(gone(&case.shows, &mended).unwrap().contains("is there"));
    let mended = (found.0, found.1.replace("continue;", ""));
    assert!(gone(&case.shows, &mended).unwrap().contains("is not there"));
    assert!(gone(&case.shows, &(Outcome::Refused, found.1)).unwrap().starts_with("Refused instead of Wgsl"));
}

#[test]
fn folders_name_the_version_that_is_used_and_hold_a_text_to_file() {
    let lock = fs::read_to_string(root().join("Cargo.lock")).unwrap();
    let list = fs::read_to_string(root().join("upstream/README.md")).unwrap();
    let mut seen = BTreeSet::new();
    for folder in folders() {
        let (name, case) = (folder.file_name().unwrap().to_string_lossy().into_owned(), case(&folder));
        let report = fs::read_to_string(folder.join("report.md")).unwrap();
        let repro = fs::read_to_string(folder.join(&case.file)).unwrap();
        assert!(report.contains(repro.trim()), "{name}: the report shows another text than {}", case.file);
        let named = format!("{} {}", case.tool, case.version);
        for part in ["\n## Text to file\n", "**Specification.**", "**Expected.**", "**Actual.**", &named] {
            assert!(report.contains(part), "{name}: the report lacks `{part}`");
        }
        assert!(case.known.is_none_or(|link| report.contains(&link)), "{name}");
        assert!(list.contains(&format!("]({name}/report.md)")), "{name} is not in upstream/README.md");
        if case.tool == "naga" {
            let locked = format!("name = \"naga\"\nversion = \"{}\"\n", case.version);
            assert!(lock.contains(&locked), "{name}: another naga is used; run the tests and write its version");
        }
        seen.insert(case.tool);
    }
    assert!(seen.contains("naga") && seen.len() > 1, "{seen:?}");
}
