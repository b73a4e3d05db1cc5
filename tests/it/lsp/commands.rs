//! Commands of lenses: each runs to its end, shows what it found at its places and as a view, and is silent on a twin.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

use super::client::Client;

const LIBRARY: &str = "#version 450\n// shadercheck: x in [0.001, 1]\nfloat lost(float x)\n{\n  return 1.0 - cos(x);\n}\n\n// shadercheck: x in [0, 1]\nfloat kept(float x)\n{\n  return x * x + 2.0 * x;\n}\n";
const FRAGMENT: &str = "#version 450\nlayout(location = 0) in vec3 tone;\nlayout(location = 0) out vec4 color;\nvoid main()\n{\n  color = vec4(tone * 0.5, 1.0);\n}\n";

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lib.glsl"), LIBRARY).unwrap();
    fs::write(folder.path().join("a.frag"), FRAGMENT).unwrap();
    folder
}

/// Runs a command to its end; gives its answer and the text of its view.
fn run(client: &mut Client, command: &str, arguments: &Value) -> (Value, String) {
    let id = client.begin("workspace/executeCommand", json!({ "command": command, "arguments": arguments }));
    let begun = client.until(|m| m["method"] == "$/progress" && m["params"]["value"]["kind"] == "begin");
    assert_eq!(begun["params"]["value"]["cancellable"], true);
    let answer = client.answer(id).unwrap_or_else(|why| panic!("{command}: {why}"));
    let shown = answer["view"].as_str().unwrap().strip_prefix("file://").unwrap().to_owned();
    let text = fs::read_to_string(&shown).unwrap();
    assert_eq!(answer["output"], text.as_str());
    (answer, text)
}

/// Messages of a command's diagnostics of a file.
fn found(client: &Client, name: &str, source: &str) -> Vec<Value> {
    let shown = client.shown.get(&client.uri(name)).cloned().unwrap_or_default();
    shown.into_iter().filter(|d| d["source"] == source).collect()
}

fn git(folder: &Path, args: &[&str]) {
    let status = Command::new("git")
        .args(["-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false"])
        .args(args)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(status.status.success(), "{}", String::from_utf8_lossy(&status.stderr));
}

#[test]
fn fuzzing_shows_its_findings_in_the_text_until_the_text_changes() {
    let folder = folder();
    let wrong = LIBRARY.replace("return 1.0 - cos(x);", "return sqrt(x - 2.0);");
    fs::write(folder.path().join("lib.glsl"), &wrong).unwrap();
    let mut client = Client::new(folder.path());
    client.open("lib.glsl");
    client.until_found("lib.glsl", &[]);
    let uri = client.uri("lib.glsl");
    let (answer, text) = run(&mut client, "shadercheck.fuzz", &json!([uri, "lost"]));
    assert_eq!(answer["status"], 1, "{text}");
    let shown = found(&client, "lib.glsl", "shadercheck fuzz");
    assert!(shown.len() == 1 && shown[0]["message"].as_str().unwrap().contains("has no value"), "{shown:?}");
    assert_eq!(shown[0]["range"]["start"], json!({ "line": 4, "character": 9 }));
    assert!(text.contains("# Fuzzed: `lost`") && text.contains("--case"), "{text}");
    // A run of the twin takes away what the last one showed, and adds nothing.
    let (answer, _) = run(&mut client, "shadercheck.fuzz", &json!([uri, "kept"]));
    assert_eq!(answer["status"], 0);
    assert_eq!(found(&client, "lib.glsl", "shadercheck fuzz"), Vec::<Value>::new());
    run(&mut client, "shadercheck.fuzz", &json!([uri, "lost"]));
    assert_eq!(found(&client, "lib.glsl", "shadercheck fuzz").len(), 1);
    client.change("lib.glsl", 2, [4, 20, 4, 21], "+");
    client.until(|m| m["params"]["version"] == 2);
    assert_eq!(found(&client, "lib.glsl", "shadercheck fuzz"), Vec::<Value>::new());
    // What is not saved is not what was run.
    let (_, text) = run(&mut client, "shadercheck.fuzz", &json!([uri, "lost"]));
    assert!(text.contains("has no value"), "{text}");
    assert_eq!(found(&client, "lib.glsl", "shadercheck fuzz"), Vec::<Value>::new());
    assert_eq!(client.end(), Some(0));
}

#[test]
fn an_expression_is_improved_by_a_repair_that_is_offered() {
    let folder = folder();
    let mut client = Client::new(folder.path());
    client.open("lib.glsl");
    client.until_found("lib.glsl", &[]);
    let uri = client.uri("lib.glsl");
    let (_, text) = run(&mut client, "shadercheck.improve", &json!([uri, "lost"]));
    let shown = found(&client, "lib.glsl", "shadercheck improve");
    assert!(shown.len() == 1 && text.contains("loses") && text.contains("proved at"), "{shown:?}\n{text}");
    let context = json!({ "diagnostics": shown });
    let params = json!({ "textDocument": { "uri": uri }, "range": shown[0]["range"], "context": context });
    let actions = client.ask("textDocument/codeAction", params).unwrap();
    let action = actions.as_array().unwrap().iter().find(|a| a["title"].as_str().unwrap().starts_with("Write"));
    let edit = &action.unwrap()["edit"]["changes"][&uri][0];
    assert_eq!(edit["range"]["start"], json!({ "line": 4, "character": 9 }));
    assert!(edit["newText"].as_str().unwrap().contains("sin("), "{edit}");
    let (_, text) = run(&mut client, "shadercheck.improve", &json!([uri, "kept"]));
    assert!(text.contains("Nothing better was found") && found(&client, "lib.glsl", "shadercheck improve").is_empty());
    // One line is looked at however little it loses.
    let (_, text) = run(&mut client, "shadercheck.improve", &json!([uri, null, 5]));
    assert!(text.contains("`1.0 - cos(x)`"), "{text}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_function_is_compared_with_the_last_commit() {
    let folder = folder();
    git(folder.path(), &["init", "-q"]);
    git(folder.path(), &["add", "."]);
    git(folder.path(), &["commit", "-qm", "first"]);
    fs::write(folder.path().join("lib.glsl"), LIBRARY.replace("2.0 * x", "2.5 * x")).unwrap();
    let mut client = Client::new(folder.path());
    client.open("lib.glsl");
    client.until_found("lib.glsl", &[]);
    let uri = client.uri("lib.glsl");
    let (answer, text) = run(&mut client, "shadercheck.compare", &json!([uri, "kept"]));
    let shown = found(&client, "lib.glsl", "shadercheck compare");
    assert!(answer["status"] == 1 && shown.len() == 1, "{text}\n{shown:?}");
    assert_eq!(shown[0]["range"]["start"], json!({ "line": 8, "character": 6 }));
    let (answer, text) = run(&mut client, "shadercheck.compare", &json!([uri, "lost"]));
    assert!(answer["status"] == 0 && text.contains("0 do not") && text.contains("ULP"), "{text}");
    assert_eq!(found(&client, "lib.glsl", "shadercheck compare"), Vec::<Value>::new());
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_suite_is_checked() {
    let folder = folder();
    let suites = crate::binary::root().join("shaders/hair");
    for entry in fs::read_dir(&suites).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
        }
    }
    let suite = "kochanek_bartels.suite.toml";
    let mut client = Client::new(folder.path());
    let uri = client.uri(suite);
    let (answer, text) = run(&mut client, "shadercheck.check", &json!([uri]));
    assert!(answer["status"] == 0 && text.contains("# Checked: pass") && text.contains(" 0 deviated"), "{text}");
    // The shader of the suite, with a fault.
    let shader = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().path());
    let shader = shader.filter(|p| p.extension().is_some_and(|e| e == "glsl")).find(|p| {
        fs::read_to_string(folder.path().join(suite)).unwrap().contains(p.file_name().unwrap().to_str().unwrap())
    });
    let shader = shader.unwrap();
    let text = fs::read_to_string(&shader).unwrap();
    let faulty = text.replacen("0.5", "0.25", 1);
    assert_ne!(faulty, text);
    fs::write(&shader, faulty).unwrap();
    let (answer, text) = run(&mut client, "shadercheck.check", &json!([uri]));
    assert!(answer["status"] == 1 && text.contains("# Checked: fail") && text.contains("again"), "{text}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_translation_is_shown_in_each_language() {
    let folder = folder();
    let mut client = Client::new(folder.path());
    client.open("a.frag");
    let uri = client.uri("a.frag");
    let lenses = client.ask("textDocument/codeLens", json!({ "textDocument": { "uri": uri } })).unwrap();
    for (to, part, ending) in [
        ("spirv", "OpEntryPoint", "spvasm"),
        ("wgsl", "@fragment", "wgsl"),
        ("hlsl", "SV_Target", "hlsl"),
        ("msl", "#include <metal_stdlib>", "metal"),
    ] {
        let is_offered = |l: &Value| l["command"]["arguments"] == json!([uri, to]);
        assert!(lenses.as_array().unwrap().iter().any(is_offered), "{to}: {lenses}");
        let (answer, text) = run(&mut client, "shadercheck.translate", &json!([uri, to]));
        assert!(text.contains(part), "{to}: {text}");
        assert!(answer["view"].as_str().unwrap().ends_with(ending));
    }
    let broken = FRAGMENT.replace("vec4(tone", "vec4(tune");
    fs::write(folder.path().join("a.frag"), broken).unwrap();
    let (answer, text) = run(&mut client, "shadercheck.translate", &json!([uri, "wgsl"]));
    assert!(answer["status"] == 1 && text.contains("tune"), "{text}");
    // The folder of the views goes with the server.
    let view = answer["view"].as_str().unwrap().strip_prefix("file://").unwrap().to_owned();
    assert!(Path::new(&view).exists());
    assert_eq!(client.end(), Some(0));
    assert!(!Path::new(&view).parent().unwrap().exists());
}

#[test]
fn a_client_that_can_show_a_file_is_asked_to() {
    let folder = folder();
    let mut client = Client::new(folder.path());
    let uri = client.uri("a.frag");
    let params = json!({ "command": "shadercheck.translate", "arguments": [uri, "wgsl"] });
    let id = client.begin("workspace/executeCommand", params);
    let asked = client.until(|m| m["method"] == "window/showDocument");
    assert!(asked["params"]["uri"].as_str().unwrap().ends_with(".wgsl"), "{asked}");
    assert!(client.answer(id).is_ok());
}

#[test]
fn a_hover_tells_how_far_a_device_may_be_off_and_which_operation_loses_the_bits() {
    let folder = folder();
    let mut client = Client::new(folder.path());
    client.open("lib.glsl");
    let mut hover = |line, column| {
        let params = client.at("lib.glsl", line, column);
        let hover = client.ask("textDocument/hover", params).unwrap();
        hover["contents"]["value"].as_str().unwrap_or("").to_owned()
    };
    // On `-`: the difference.
    let text = hover(4, 13);
    assert!(
        text.contains("at worst, at `float x") && text.contains("`1.0 - cos(x)` (line 5) loses the bits"),
        "{text}"
    );
    assert!(text.contains("% of it is the error of `cos(x)` (line 5)"), "{text}");
    // On the name of the function.
    assert!(hover(2, 7).contains("loses the bits"));
    // Nothing is lost before.
    let text = hover(4, 16);
    assert!(text.contains("at worst, at `float x") && !text.contains("loses the bits"), "{text}");
    for (line, column) in [(10, 16), (8, 7)] {
        let text = hover(line, column);
        assert!(text.contains("at worst, at `float x") && !text.contains("loses the bits"), "{text}");
    }
}

#[test]
fn a_hover_tells_numbers_of_wgsl_and_of_entry_points() {
    let folder = folder();
    let text = "// shadercheck: x in [0.001, 1]\nfn lost(x: f32) -> f32 {\n  let near = 1.0 - cos(x);\n  return near;\n}\n\n\
                @fragment\nfn tone(@location(0) uv: vec2<f32>) -> @location(0) vec4<f32> {\n  \
                let half = uv * 0.5 + uv;\n  if (half.x > 0.5) {\n    return vec4<f32>(half, half);\n  }\n  \
                return vec4<f32>(half, 0.0, 1.0);\n}\n\n\
                @compute @workgroup_size(1)\nfn nothing() {\n  let kept = 2.0 * exp(0.5);\n}\n";
    fs::write(folder.path().join("tone.wgsl"), text).unwrap();
    let mut client = Client::new(folder.path());
    client.open("tone.wgsl");
    let mut hover = |line, column| {
        let params = client.at("tone.wgsl", line, column);
        let hover = client.ask("textDocument/hover", params).unwrap();
        hover["contents"]["value"].as_str().unwrap_or("").to_owned()
    };
    let text = hover(2, 17);
    assert!(text.contains("at worst, at `") && text.contains("`1.0 - cos(x)` (line 3) loses the bits"), "{text}");
    assert!(hover(1, 4).contains("loses the bits"));
    // Values of the pipeline are inputs as parameters are.
    for (line, column) in [(8, 22), (10, 12)] {
        let text = hover(line, column);
        assert!(text.contains("at worst, at `") && !text.contains("loses the bits"), "{text}");
    }
    // The way out comes first, and a literal is no result.
    let text = hover(17, 17);
    assert!(text.contains("a conforming device"), "{text}");
    assert!(!hover(17, 14).contains("a conforming device"));
}
