//! What an editor shows and does while texts change.

use std::path::Path;
use std::time::Duration;

use serde_json::{Value, json};
use tempfile::TempDir;

use super::client::Client;

const VERTEX: &str = "#version 330 core\nuniform mat4 view;\nlayout(location = 0) in vec4 place;\nout vec3 tone;\nvoid main()\n{\n  tone = place.xyz;\n  gl_Position = view * place;\n}\n";
const FRAGMENT: &str = "#version 330 core\nuniform vec4 tint;\nin vec3 tone;\nout vec4 color;\nvoid main()\n{\n  color = tint * vec4(tone, 1.0);\n}\n";
const HOST: &str = "void draw()\n{\n  GLuint p = load(\"a.vert\", \"a.frag\");\n  glUniform4f(glGetUniformLocation(p, \"tint\"), 1, 1, 1, 1);\n  glUniformMatrix4fv(glGetUniformLocation(p, \"view\"), 1, GL_FALSE, view);\n}\n";

pub fn workspace() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("a.vert", VERTEX), ("a.frag", FRAGMENT), ("main.cpp", HOST)] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// A text after the edits of a file in an answer.
fn edited(edit: &Value, uri: &str, text: &str) -> String {
    let mut edits = edit["changes"][uri].as_array().unwrap().clone();
    let at = |p: &Value| {
        let line = p["line"].as_u64().unwrap() as usize;
        let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
        start + p["character"].as_u64().unwrap() as usize
    };
    edits.sort_by_key(|e| std::cmp::Reverse(at(&e["range"]["start"])));
    let mut text = text.to_owned();
    for e in edits {
        let (from, to) = (at(&e["range"]["start"]), at(&e["range"]["end"]));
        text.replace_range(from..to, e["newText"].as_str().unwrap());
    }
    text
}

#[test]
fn an_edited_shader_changes_what_is_found_in_its_host_and_back() {
    let folder = workspace();
    let mut client = Client::new(folder.path());
    client.open("a.frag");
    client.open("main.cpp");
    client.until_found("main.cpp", &[]);
    // Nothing is saved.
    client.change("a.frag", 2, [1, 13, 1, 17], "tone2");
    client.change("a.frag", 3, [6, 10, 6, 14], "tone2");
    client.until_found("main.cpp", &["H003"]);
    client.change("main.cpp", 2, [3, 39, 3, 43], "tone2");
    client.until_found("main.cpp", &[]);
    assert_eq!(std::fs::read_to_string(folder.path().join("a.frag")).unwrap(), FRAGMENT);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn after_fast_typing_what_is_shown_is_what_the_command_finds() {
    let folder = workspace();
    let mut client = Client::new(folder.path());
    client.open("a.frag");
    client.until_found("a.frag", &[]);
    // Runs over all files begin in the pauses, and the next key stops them.
    let (mut version, mut text) = (1, FRAGMENT.to_owned());
    for pause in [0, 505, 520, 0, 540, 560] {
        for letter in ["x", "y", "z"] {
            version += 1;
            client.change("a.frag", version, [1, 17, 1, 17], letter);
            text = text.replacen("tint", &format!("tint{letter}"), 1);
        }
        std::thread::sleep(Duration::from_millis(pause));
    }
    let uri = client.uri("a.frag");
    client.until(|m| m["params"]["uri"] == uri.as_str() && m["params"]["version"] == version);
    client.until_found("main.cpp", &["H003"]);
    // Nothing that was found before comes behind it.
    std::thread::sleep(Duration::from_secs(2));
    client.ask("workspace/symbol", json!({ "query": "" })).unwrap();
    let copy = workspace();
    std::fs::write(copy.path().join("a.frag"), &text).unwrap();
    let ran = crate::binary::run_in(copy.path(), "lint --lang en --format json .").json();
    let expected = |name: &str| -> Vec<Value> {
        let found = ran.as_array().unwrap().iter();
        found.filter(|d| d["file"].as_str().unwrap().ends_with(name)).map(|d| d["code"].clone()).collect()
    };
    for name in ["a.vert", "a.frag", "main.cpp"] {
        let shown = client.shown.get(&client.uri(name)).into_iter().flatten().map(|d| d["code"].clone());
        assert_eq!(shown.collect::<Vec<_>>(), expected(name), "{name}: {ran:#}");
    }
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_repair_is_offered_and_leaves_nothing_to_find() {
    let folder = workspace();
    let wrong = FRAGMENT.replace("vec4(tone, 1.0)", "vec4(tone, 1.0, 2.0)");
    std::fs::write(folder.path().join("a.frag"), &wrong).unwrap();
    let mut client = Client::new(folder.path());
    client.open("a.frag");
    client.until_found("a.frag", &["T001"]);
    let uri = client.uri("a.frag");
    let range = json!({ "start": { "line": 6, "character": 17 }, "end": { "line": 6, "character": 17 } });
    let params = json!({ "textDocument": { "uri": uri }, "range": range, "context": { "diagnostics": [] } });
    let actions = client.ask("textDocument/codeAction", params).unwrap();
    let titles: Vec<&str> = actions.as_array().unwrap().iter().map(|a| a["title"].as_str().unwrap()).collect();
    assert!(titles.contains(&"Ignore T001 on this line"), "{titles:?}");
    for action in actions.as_array().unwrap() {
        let after = edited(&action["edit"], &uri, &wrong);
        std::fs::write(folder.path().join("a.frag"), after).unwrap();
        let ran = crate::binary::run_in(folder.path(), "lint --lang en .");
        assert_eq!(ran.code, 0, "{}: {}", action["title"], ran.out);
    }
}

#[test]
fn a_rename_goes_through_stages_and_strings() {
    let folder = workspace();
    let mut client = Client::new(folder.path());
    client.open("a.vert");
    for (file, place, new, files) in [
        ("a.vert", [1, 14], "camera", &["a.vert", "main.cpp"][..]),
        ("main.cpp", [3, 41], "hue", &["a.frag", "main.cpp"]),
        ("a.vert", [3, 10], "shade", &["a.frag", "a.vert"]),
        ("a.vert", [6, 10], "corner", &["a.vert"]),
    ] {
        let edit = client.rename(file, place, new).unwrap();
        let mut named: Vec<String> = edit["changes"].as_object().unwrap().keys().cloned().collect();
        named.sort();
        assert_eq!(named, files.iter().map(|f| client.uri(f)).collect::<Vec<_>>(), "{new}");
        let copy = workspace();
        for name in files {
            let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
            std::fs::write(copy.path().join(name), edited(&edit, &client.uri(name), &text)).unwrap();
        }
        let ran = crate::binary::run_in(copy.path(), "lint --lang en .");
        assert_eq!(ran.code, 0, "{new}: {}", ran.out);
    }
}

#[test]
fn a_rename_that_would_break_something_is_refused_with_the_reason() {
    let folder = workspace();
    let mut client = Client::new(folder.path());
    client.open("a.vert");
    for (place, new, part) in [
        ([1, 14], "uniform", "keyword or a function of GLSL 3.30"),
        ([1, 14], "mat3", "keyword"),
        ([1, 14], "normalize", "keyword"),
        ([1, 14], "place", "declared at"),
        ([1, 14], "gl_x", "reserved"),
        ([1, 14], "a b", "no name"),
        ([1, 14], "", "no name"),
        ([7, 4], "x", "name of the language"),
        ([5, 0], "x", "no name here"),
    ] {
        let refused = client.rename("a.vert", place, new).unwrap_err();
        assert!(refused.contains(part), "{new}: {refused}");
    }
}

#[test]
fn columns_count_in_the_encoding_that_was_agreed_on() {
    let folder = workspace();
    let text = FRAGMENT.replace("  color =", "/* 𝒗é */ color =");
    std::fs::write(folder.path().join("a.frag"), &text).unwrap();
    for (offered, agreed, column) in [(&["utf-16"][..], "utf-16", 18), (&["utf-16", "utf-8"], "utf-8", 21)] {
        let mut client = Client::with(folder.path(), &json!({}), offered);
        assert_eq!(client.server["capabilities"]["positionEncoding"], agreed);
        client.open("a.frag");
        let params = client.at("a.frag", 6, column);
        let hover = client.ask("textDocument/hover", params).unwrap();
        assert!(hover["contents"]["value"].as_str().unwrap().contains("uniform vec4 tint"), "{hover}");
        assert!(hover["contents"]["value"].as_str().unwrap().contains("main.cpp:4"), "{hover}");
    }
}

#[test]
fn every_request_that_is_announced_is_answered() {
    let folder = workspace();
    let mut client = Client::new(folder.path());
    client.open("a.vert");
    let document = json!({ "textDocument": { "uri": client.uri("a.vert") } });
    let whole = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 99, "character": 0 } });
    let at = client.at("a.vert", 7, 17);
    let with = |base: &Value, key: &str, value: Value| {
        let mut params = base.clone();
        params[key] = value;
        params
    };
    let some = |answer: Value| answer.as_array().map_or(!answer.is_null(), |a| !a.is_empty());
    for (method, params) in [
        ("textDocument/definition", at.clone()),
        ("textDocument/declaration", at.clone()),
        ("textDocument/references", with(&at, "context", json!({ "includeDeclaration": true }))),
        ("textDocument/documentHighlight", at.clone()),
        ("textDocument/prepareRename", at.clone()),
        ("textDocument/completion", at.clone()),
        ("textDocument/documentSymbol", document.clone()),
        ("textDocument/foldingRange", document.clone()),
        ("textDocument/semanticTokens/full", document.clone()),
        ("textDocument/semanticTokens/range", with(&document, "range", whole)),
        ("textDocument/selectionRange", with(&document, "positions", json!([{ "line": 7, "character": 17 }]))),
        ("workspace/symbol", json!({ "query": "vw" })),
    ] {
        let answer = client.ask(method, params).unwrap_or_else(|e| panic!("{method}: {e}"));
        assert!(some(answer.clone()), "{method}: {answer}");
    }
    assert!(client.ask("textDocument/unheardOf", document).unwrap_err().contains("unheardOf"));
}

#[test]
fn completion_knows_components_members_and_names_in_host_strings() {
    let folder = workspace();
    let mut client = Client::new(folder.path());
    client.open("a.frag");
    client.open("main.cpp");
    let labels = |client: &mut Client, file: &str, line, column| -> Vec<String> {
        let params = client.at(file, line, column);
        let items = client.ask("textDocument/completion", params).unwrap();
        items.as_array().unwrap().iter().map(|i| i["label"].as_str().unwrap().to_owned()).collect()
    };
    let has = |labels: &[String], label: &str| labels.iter().any(|l| l == label);
    client.change("a.frag", 2, [6, 33, 6, 33], "\n  tone.");
    let found = labels(&mut client, "a.frag", 7, 7);
    assert!(has(&found, "xyz") && has(&found, "r") && !has(&found, "w"), "{found:?}");
    let found = labels(&mut client, "main.cpp", 3, 39);
    assert!(has(&found, "tint") && has(&found, "view") && !has(&found, "place"), "{found:?}");
    let found = labels(&mut client, "a.frag", 6, 10);
    assert!(has(&found, "tint") && has(&found, "gl_FragCoord") && has(&found, "mix") && !has(&found, "gl_Vertex"));
}

#[test]
fn offsets_are_told_of_what_lies_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let text = "struct Lamp {\n  place: vec3f,\n  power: f32,\n  tint: vec3f,\n}\nstruct Out {\n  @builtin(position) p: vec4f,\n  @location(0) tone: vec3f,\n}\n@group(0) @binding(0) var<uniform> lamp: Lamp;\n@vertex fn vs() -> Out {\n  return Out(vec4f(lamp.place, lamp.power), lamp.tint);\n}\n";
    std::fs::write(folder.path().join("a.wgsl"), text).unwrap();
    let mut client = Client::new(folder.path());
    client.open("a.wgsl");
    let range = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 13, "character": 0 } });
    let params = json!({ "textDocument": { "uri": client.uri("a.wgsl") }, "range": range });
    let hints = client.ask("textDocument/inlayHint", params).unwrap();
    let labels: Vec<String> =
        hints.as_array().unwrap().iter().map(|h| h["label"].as_str().unwrap().to_owned()).collect();
    assert_eq!(labels, ["offset 0", "offset 12", "offset 16"], "and none of what goes from stage to stage");
}

/// True when a folder holds what it held.
pub fn unchanged(folder: &Path) -> bool {
    [("a.vert", VERTEX), ("a.frag", FRAGMENT), ("main.cpp", HOST)]
        .iter()
        .all(|(name, text)| std::fs::read_to_string(folder.join(name)).is_ok_and(|t| t == *text))
}
