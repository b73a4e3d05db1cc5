//! The lane `webgpu`, with Node and the package `webgpu` where they are, and Tint as a validator of the WGSL that is
//! written.
//!
//! Faults are planted by a package that stands in front of the real one: Dawn and Tint as they would be with a defect.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use program::Language;
use serde_json::Value;
use shadercheck::cli::node;
use test_record::not_run;

use crate::binary::{self, Ran, root, say};
use crate::lowering::{UNIFORMS, names, shipped, stage};

/// SwiftShader as Debian installs it.
const SWIFTSHADER: &str = "/usr/lib/chromium/vk_swiftshader_icd.json";

/// The binary, with SwiftShader beside the drivers that are found anyway: Dawn takes no lavapipe before Mesa 25.
pub fn command(folder: &Path, args: &str) -> Command {
    let mut command = binary::command(folder, args);
    if std::env::var_os("VK_ADD_DRIVER_FILES").is_none() && Path::new(SWIFTSHADER).exists() {
        command.env("VK_ADD_DRIVER_FILES", SWIFTSHADER);
    }
    command
}

/// The package, where Node and it are there; else records what is not run.
fn package(what: &str) -> Option<PathBuf> {
    let folder = node::package();
    let there = folder.is_some() && Command::new("node").arg("--version").output().is_ok();
    if !there {
        not_run(&format!(
            "there is no Node or no package `webgpu` (`npm install webgpu`, or NODE_PATH that leads to it): {what}"
        ));
    }
    folder.filter(|_| there)
}

/// What `lanes` says of all lanes, from the project's root.
fn lanes() -> Value {
    Ran::from(command(root(), "lanes --format json").output().unwrap()).expect(0).json()["lanes"].take()
}

fn lane_named<'a>(lanes: &'a Value, name: &str) -> Option<&'a Value> {
    lanes.as_array().unwrap().iter().find(|lane| lane["name"] == name)
}

/// The package, where the lane is available; else records what is not run.
pub fn device(what: &str) -> Option<PathBuf> {
    let folder = package(what)?;
    let lanes = lanes();
    let lane = lane_named(&lanes, "webgpu").expect("the lane is listed");
    if lane["available"] == true {
        return Some(folder);
    }
    not_run(&format!("{}; {}: {what}", lane["why"], lane["remedy"]));
    None
}

/// A folder whose package is the real one with some of it replaced, by these lines of JavaScript.
fn wrapped(real: &Path, lines: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let package = folder.path().join("node_modules/webgpu");
    fs::create_dir_all(&package).unwrap();
    fs::write(package.join("package.json"), r#"{"type": "module", "main": "index.js", "version": "0.0.1"}"#).unwrap();
    let index = format!(
        "import {{ create, globals }} from {:?};\nconst {{ GPUDevice, GPUBuffer, GPUQueue }} = globals;\n{lines}\n\
         export {{ create, globals }};\n",
        format!("file://{}/index.js", real.display())
    );
    fs::write(package.join("index.js"), index).unwrap();
    folder
}

/// Lines of JavaScript in place of what makes a module: `d` describes it, and `old` makes it.
fn on_modules(body: &str) -> String {
    format!(
        "const old = GPUDevice.prototype.createShaderModule;\n\
         GPUDevice.prototype.createShaderModule = function (d) {{\n  {body}\n}};"
    )
}

/// `shadercheck check` with these arguments in a folder whose package is wrapped.
fn check(folder: &Path, args: &str) -> Ran {
    command(folder, &format!("check {args}")).env_remove("NODE_PATH").output().unwrap().into()
}

#[test]
fn without_the_package_the_lane_says_how_to_get_it() {
    let folder = tempfile::tempdir().unwrap();
    let ran = Ran::from(command(folder.path(), "lanes").env_remove("NODE_PATH").output().unwrap()).expect(0);
    assert!(ran.out.contains("webgpu ") && ran.out.contains("run `npm install webgpu` in this folder"), "{}", ran.out);
    // Asked for and absent is an error; not asked for, it is nothing that a run needs.
    let ran = check(folder.path(), "morph --samples 64 --require-lane webgpu").expect(2);
    assert!(ran.err.contains("the required lane `webgpu` is not available"), "{}", ran.err);
    let empty = folder.path().join("node_modules/webgpu");
    fs::create_dir_all(&empty).unwrap();
    fs::write(empty.join("package.json"), "{}").unwrap();
    let ran = check(folder.path(), "morph --samples 64 --lane webgpu");
    assert!(ran.code != 0 && ran.err.contains("webgpu"), "{ran:?}");
}

#[test]
fn shipped_suites_agree_on_dawn() {
    if device("suites on the lane `webgpu`").is_none() {
        return;
    }
    let ran = Ran::from(command(root(), "check sphere hair skinning --quick --lane webgpu").output().unwrap());
    let ran = ran.expect(0);
    assert_eq!(ran.out.matches("webgpu/compute").count() - ran.out.matches(" on webgpu/compute").count(), 3, "{ran:?}");
    // Inputs in uniform buffers are another path through Tint.
    let ran = Ran::from(command(root(), "check morph --quick --sources --lane webgpu").output().unwrap()).expect(0);
    assert!(ran.out.contains("webgpu/uniforms"), "{ran:?}");
}

#[test]
fn a_compiler_that_takes_another_sense_is_blamed() {
    let Some(real) = device("blame of Tint") else { return };
    let folder = wrapped(
        &real,
        &on_modules("return old.call(this, { ...d, code: d.code.replace(/mix\\((\\w+), (\\w+),/, 'mix($2, $1,') });"),
    );
    let ran = check(folder.path(), "morph --samples 256 --format json --lane webgpu --lane vulkan").expect(1);
    let report = ran.json();
    let suites = report["suites"].as_array().unwrap();
    let of = |lane: &'static str| suites.iter().filter(move |suite| suite["lane"] == lane);
    assert!(of("vulkan").all(|suite| suite["findings"].as_array().unwrap().is_empty()), "{}", ran.out);
    let fault = of("webgpu").find_map(|suite| {
        let found = suite["findings"].as_array()?.iter();
        found.map(|finding| &finding["case"]["fault"]).find(|fault| fault.is_object())
    });
    let fault = fault.unwrap_or_else(|| panic!("nobody is blamed: {}", ran.out));
    let said = fault["message"].as_str().unwrap();
    // Beside lavapipe alone, the device of Dawn may be the one that is wrong; with SwiftShader as a lane it is Tint.
    assert!(said.contains("the translator `Tint`"), "{said}");
    if lane_named(&lanes(), "vulkan-swiftshader").is_none() {
        return not_run("SwiftShader is no lane: blame of Tint beside the same device through naga");
    }
    let args = "morph --samples 256 --lane webgpu --lane vulkan --lane vulkan-swiftshader";
    let ran = check(folder.path(), args).expect(1);
    let said = ran.out.split_whitespace().collect::<Vec<_>>().join(" ");
    let words =
        "the translator `Tint`: what went through it deviates on `subzero`, and what went through `naga` is right";
    assert!(said.contains(words), "{}", ran.out);
}

#[test]
fn a_bit_that_flips_on_the_way_back_is_found() {
    let Some(real) = device("flipped bits on the lane `webgpu`") else { return };
    let folder = wrapped(
        &real,
        "const old = GPUBuffer.prototype.getMappedRange;\n\
         GPUBuffer.prototype.getMappedRange = function (...args) {\n  \
           const range = old.apply(this, args);\n  \
           if (this.usage & 1) new Uint32Array(range)[AT] ^= 1 << 22;\n  return range;\n};",
    );
    let index = folder.path().join("node_modules/webgpu/index.js");
    let text = fs::read_to_string(&index).unwrap();
    let with = |at: &str| {
        fs::write(&index, text.replace("AT", at)).unwrap();
        check(folder.path(), "morph --samples 256 --lane webgpu").expect(1)
    };
    // The first output of the first record; and its canary.
    let ran = with("1");
    assert!(ran.out.contains("the lane deviates from the shader"), "{}", ran.out);
    let ran = with("0");
    assert!(ran.out.contains("was not written by this dispatch"), "{}", ran.out);
}

#[test]
fn a_text_that_tint_refuses_and_a_crash_are_findings_and_the_run_goes_on() {
    let Some(real) = device("refusals and crashes on the lane `webgpu`") else { return };
    let refused =
        wrapped(&real, &on_modules("return old.call(this, { ...d, code: d.code.replace(/mix\\(/, 'mixed(') });"));
    let ran = check(refused.path(), "morph joints --samples 64 --lane webgpu --lane embedded").expect(1);
    let said = ran.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("Tint refuses the WGSL of this kernel at "), "{}", ran.out);
    assert!(said.contains("unresolved call target 'mixed'"), "{}", ran.out);
    let words = |ran: &Ran| -> Vec<String> {
        let first = ran.out.lines().filter_map(|line| line.split_whitespace().next());
        first.filter(|word| ["ok", "FAIL"].contains(word)).map(str::to_owned).collect()
    };
    assert_eq!(words(&ran), ["FAIL", "ok", "ok", "ok"], "{}", ran.out);
    // The process dies at the first dispatch of one shader.
    let crashed = wrapped(
        &real,
        &(on_modules("this.dies = /mix\\(/.test(d.code);\n  return old.call(this, d);")
            + "\nconst make = GPUDevice.prototype.createCommandEncoder;\n\
         GPUDevice.prototype.createCommandEncoder = function (...args) {\n  \
           if (this.dies) process.kill(process.pid, 'SIGSEGV');\n  return make.apply(this, args);\n};"),
    );
    let ran = check(crashed.path(), "morph joints --samples 64 --lane webgpu --lane embedded").expect(1);
    assert!(ran.out.contains("was ended by signal 11 (segmentation fault)"), "{}", ran.out);
    assert!(ran.out.contains(", at invocation 0 of 64, with t="), "{}", ran.out);
    assert_eq!(words(&ran), ["FAIL", "ok", "ok", "ok"], "{}", ran.out);
}

/// Tint on texts: an entry for each, empty where it accepts it.
const VALIDATE: &str = r#"
import { readFileSync } from 'node:fs';
const [folder] = process.argv.slice(-1);
const { create, globals } = await import(`file://${folder}/index.js`);
Object.assign(globalThis, globals);
globalThis.keep = create(['backend=null']);
const adapter = await keep.requestAdapter();
const device = await adapter.requestDevice();
const said = [];
for (const code of JSON.parse(readFileSync(0, 'utf8'))) {
  device.pushErrorScope('validation');
  const { messages } = await device.createShaderModule({ code }).getCompilationInfo();
  await device.popErrorScope();
  const errors = messages.filter((message) => message.type === 'error');
  said.push(errors.map((message) => `${message.lineNum}:${message.linePos}: ${message.message}`).join('\n'));
}
console.log(JSON.stringify(said));
device.destroy();
delete globalThis.keep;
"#;

fn tint(package: &Path, texts: &[String]) -> Vec<String> {
    let mut child = Command::new("node")
        .args(["--input-type=module", "-e", VALIDATE, "--"])
        .arg(package)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(serde_json::to_string(texts).unwrap().as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn tint_accepts_every_wgsl_that_is_written() {
    let Some(package) = package("Tint on the WGSL of every shipped shader") else { return };
    let mut all = Vec::new();
    let uniforms = std::iter::once(("uniforms", stage("uniforms.vert", UNIFORMS)));
    for (name, case) in names().into_iter().map(|name| (name, shipped(name))).chain(uniforms) {
        let translation = case.program().translate(Language::Wgsl).unwrap_or_else(|error| panic!("{name}: {error}"));
        all.push((name, String::from_utf8(translation.into_bytes()).unwrap()));
    }
    let texts: Vec<String> = all.iter().map(|(_, text)| text.clone()).collect();
    for ((name, text), said) in all.iter().zip(tint(&package, &texts)) {
        assert_eq!(said, "", "{name}\n{text}");
    }
    // What it would say of one that is wrong.
    let wrong = texts[0].replacen("f32", "f23", 1);
    assert!(tint(&package, &[wrong])[0].contains("f23"));
    say(&format!("Tint: {} translations checked", all.len()));
}
