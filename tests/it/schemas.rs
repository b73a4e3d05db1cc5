//! The schemas of the files that people write, in the form in which a catalogue of schemas takes them, against what is read:
//! what one of both refuses, the other refuses too.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::binary::{root, run, run_in};
use crate::own::schema::of;

fn schema(name: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(root().join("docs").join(name)).unwrap()).unwrap()
}

/// A schema without what only a catalogue needs.
fn content(mut schema: Value) -> Value {
    for key in ["$schema", "$id", "title", "description"] {
        schema.as_object_mut().unwrap().remove(key);
    }
    schema
}

#[test]
fn every_schema_of_an_input_has_what_a_catalogue_asks_for() {
    for name in ["config", "suite", "expectations"] {
        let schema = schema(&format!("{name}.schema.json"));
        assert_eq!(schema["$schema"], "http://json-schema.org/draft-07/schema#", "{name}");
        assert!(schema["$id"].as_str().is_some_and(|id| id.starts_with("https://") && id.ends_with(".json")), "{name}");
        assert!(schema["title"].is_string() && schema["description"].is_string(), "{name}");
        assert_eq!(undescribed(&schema, name), Vec::<String>::new());
    }
}

/// Keys without a description, which an editor would show as an empty box.
fn undescribed(schema: &Value, at: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (name, property) in schema["properties"].as_object().into_iter().flatten() {
        let at = format!("{at}.{name}");
        found.extend(undescribed(property, &at).into_iter().chain(undescribed(&property["items"], &at)));
        // Bounds of a range, which its name explains.
        if property["description"].is_null() && !["from", "to"].contains(&name.as_str()) {
            found.push(at);
        }
    }
    found
}

#[test]
fn the_schema_of_suites_is_the_one_that_the_program_prints() {
    assert_eq!(content(schema("suite.schema.json")), content(run("init --schema").expect(0).json()));
}

/// A file with every key that is read.
const CONFIG: &str = r#"presets = ["qt"]
[lint]
select = ["T", "N014"]
ignore = ["low-precision-pi"]
level = "strict"
lang = "ja"
[lint.per-file-ignores]
"third_party/**" = ["T"]
[[range]]
name = "shininess"
min = 1
max = 128.0
[[program]]
shaders = ["a.vert"]
hosts = ["main.cpp"]
[[wrapper]]
function = "setMat4"
kind = "set-uniform"
argument = 1
sets = "mat4"
[[variant]]
name = "QUALITY"
values = ["0", "1"]
[compare]
pairs = [{ first = "glsl/**", second = "wgsl/**", except = ["hash"] }]
"#;

const EXPECTATIONS: &str = "[[expected]]\nlane = \"vulkan*\"\ndriver = \"*llvmpipe*\"\n\
    versions = { of = \"Mesa\", from = \"22.3\", before = \"24\" }\nsuite = \"hair*\"\nstage = \"vertex\"\n\
    kind = \"deviation\"\nmessage = \"*gl_Position*\"\nreason = \"a reason\"\nlink = \"https://example.org\"\n\
    always = false\n";

/// Keys of a schema at all depths that `text` does not have.
fn unused(schema: &Value, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (name, property) in schema["properties"].as_object().into_iter().flatten() {
        if !text.contains(name.as_str()) {
            found.push(name.clone());
        }
        found.extend(unused(property, text).into_iter().chain(unused(&property["items"], text)));
    }
    found
}

/// True where the program reads a configuration.
fn config_is_read(folder: &Path, text: &str) -> bool {
    fs::write(folder.join("c.toml"), text).unwrap();
    fs::write(folder.join("a.vert"), "#version 330\nin vec4 p;\nvoid main() { gl_Position = p; }\n").unwrap();
    run_in(folder, "lint a.vert --config c.toml --lang en").code == 0
}

/// True where the program reads expectations.
fn expectations_are_read(folder: &Path, text: &str) -> bool {
    fs::write(folder.join("e.toml"), text).unwrap();
    let ran = run_in(folder, "check sphere --lane embedded --samples 16 --plain --expectations e.toml");
    assert!(ran.code < 2 || ran.err.contains("e.toml:"), "{ran:?}");
    ran.code < 2
}

/// Holds a schema against a reader: on the whole text, and with a change each.
fn held(name: &str, whole: &str, read: fn(&Path, &str) -> bool, changes: &[(&str, &str)]) {
    let (schema, folder) = (schema(name), tempfile::tempdir().unwrap());
    assert_eq!(of(&schema, whole), [""; 0]);
    assert!(read(folder.path(), whole), "{whole}");
    assert_eq!(unused(&schema, whole), [""; 0], "the program reads no such key");
    for (from, to) in changes {
        assert!(whole.contains(from), "{from}");
        let text = whole.replacen(from, to, 1);
        assert_ne!(of(&schema, &text), [""; 0], "the schema takes `{to}`");
        assert!(!read(folder.path(), &text), "the program takes `{to}`");
    }
}

#[test]
fn the_schema_of_configurations_is_what_is_read() {
    held(
        "config.schema.json",
        CONFIG,
        config_is_read,
        &[
            ("presets", "preset"),
            ("\"qt\"", "\"qtt\""),
            ("select", "selct"),
            ("[\"T\", \"N014\"]", "[1]"),
            ("\"strict\"", "\"strikt\""),
            ("\"ja\"", "\"fr\""),
            ("[\"T\"]", "\"T\""),
            ("name = \"shininess\"\n", ""),
            ("min = 1\n", ""),
            ("max = 128.0", "max = \"high\""),
            ("shaders = [\"a.vert\"]", "shaders = []"),
            ("hosts", "host"),
            ("\"set-uniform\"", "\"set-unifrom\""),
            ("\"set-uniform\"", "\"load-program\""),
            ("argument = 1", "argument = -1"),
            ("sets = \"mat4\"", "sets = \"\""),
        ],
    );
}

#[test]
fn the_schema_of_expectations_is_what_is_read() {
    held(
        "expectations.schema.json",
        EXPECTATIONS,
        expectations_are_read,
        &[
            ("[[expected]]", "[[expectd]]"),
            ("lane = \"vulkan*\"\n", ""),
            ("from = \"22.3\", before = \"24\" }", "}"),
            ("of = ", "off = "),
            ("\"vertex\"", "\"vertx\""),
            ("\"deviation\"", "\"range\""),
            ("reason = \"a reason\"\n", ""),
            ("false", "0"),
        ],
    );
}
