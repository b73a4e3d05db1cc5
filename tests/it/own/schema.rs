//! The JSON Schema of suite files: every suite that ships is valid by it, and wrong ones are not.

use std::fs;

use serde_json::{Map, Value, json};

use crate::binary::{root, run};

/// What a value breaks of a schema, with its place: as much of JSON Schema as the schema of suites uses.
/// A keyword that is not known here fails, so that none is passed over.
fn broken(schema: &Value, value: &Value, at: &str) -> Vec<String> {
    let Some(schema) = schema.as_object() else {
        return if schema == &json!(false) { vec![format!("{at}: nothing may stand here")] } else { Vec::new() };
    };
    let mut all = Vec::new();
    let number = |key: &str| schema[key].as_f64().unwrap();
    let list = |key: &str| schema[key].as_array().unwrap();
    let empty = Map::new();
    for key in schema.keys() {
        let holds = match key.as_str() {
            "$schema" | "$id" | "title" | "description" => true,
            "type" => {
                let is = |name: &Value| match name.as_str().unwrap() {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "string" => value.is_string(),
                    "number" => value.is_number(),
                    "integer" => value.is_i64() || value.is_u64(),
                    "boolean" => value.is_boolean(),
                    other => panic!("type {other}"),
                };
                schema[key].as_array().map_or_else(|| is(&schema[key]), |names| names.iter().any(is))
            }
            "const" => value == &schema[key],
            "enum" => list(key).contains(value),
            "minLength" => value.as_str().is_none_or(|text| text.chars().count() as f64 >= number(key)),
            "minimum" => value.as_f64().is_none_or(|x| x >= number(key)),
            "maximum" => value.as_f64().is_none_or(|x| x <= number(key)),
            "minItems" => value.as_array().is_none_or(|items| items.len() as f64 >= number(key)),
            "maxItems" => value.as_array().is_none_or(|items| items.len() as f64 <= number(key)),
            "uniqueItems" => {
                value.as_array().is_none_or(|items| (1..items.len()).all(|k| !items[..k].contains(&items[k])))
            }
            "items" => {
                for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                    all.extend(broken(&schema[key], item, &format!("{at}[{k}]")));
                }
                true
            }
            "properties" => {
                for (name, inner) in schema[key].as_object().unwrap() {
                    all.extend(value.get(name).map_or_else(Vec::new, |v| broken(inner, v, &format!("{at}.{name}"))));
                }
                true
            }
            "additionalProperties" => {
                let known = schema.get("properties").and_then(Value::as_object).unwrap_or(&empty);
                for (name, v) in value.as_object().into_iter().flatten().filter(|(name, _)| !known.contains_key(*name))
                {
                    all.extend(broken(&schema[key], v, &format!("{at}.{name}")));
                }
                true
            }
            "required" => {
                list(key).iter().all(|name| value.get(name.as_str().unwrap()).is_some() || !value.is_object())
            }
            "anyOf" => list(key).iter().any(|inner| broken(inner, value, at).is_empty()),
            "allOf" => {
                list(key).iter().for_each(|inner| all.extend(broken(inner, value, at)));
                true
            }
            "not" => !broken(&schema[key], value, at).is_empty(),
            "if" => {
                let branch = if broken(&schema[key], value, at).is_empty() { "then" } else { "else" };
                all.extend(schema.get(branch).map_or_else(Vec::new, |inner| broken(inner, value, at)));
                true
            }
            // Of patterns, the endings of names alone.
            "pattern" => {
                let pattern = schema[key].as_str().unwrap();
                let endings = pattern.strip_prefix("\\.(").and_then(|rest| rest.strip_suffix(")$"));
                let endings = endings.unwrap_or_else(|| panic!("the pattern `{pattern}` is not known here"));
                let ends = |text: &str| endings.split('|').any(|ending| text.ends_with(&format!(".{ending}")));
                value.as_str().is_none_or(ends)
            }
            "then" | "else" => true,
            other => panic!("the keyword `{other}` is not known here"),
        };
        if !holds {
            all.push(format!("{at}: {key}"));
        }
    }
    all
}

pub(crate) fn of(schema: &Value, text: &str) -> Vec<String> {
    let value: toml::Table = toml::from_str(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    broken(schema, &serde_json::to_value(value).unwrap(), "suite")
}

#[test]
fn every_suite_that_ships_is_valid() {
    let schema = run("init --schema").expect(0).json();
    let mut seen = 0;
    for folder in ["shaders/chapter9", "shaders/hair"] {
        for entry in fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.to_string_lossy().ends_with(".suite.toml") {
                assert_eq!(of(&schema, &fs::read_to_string(&path).unwrap()), [""; 0], "{}", path.display());
                seen += 1;
            }
        }
    }
    assert_eq!(seen, engine::suite::shipped().count());
}

const OWN: &str = "suite = \"own\"\nshader = \"f.glsl\"\nstage = \"function\"\nentry = \"f\"\n\
    relations = [\"weight_range\", { kind = \"odd\", inputs = [\"x\"] }]\n\
    defines = { A = [1, 2], B = true, C = \"x\" }\nreference = { file = \"r.glsl\" }\n\
    [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]\n";

#[test]
fn what_the_reader_refuses_is_not_valid() {
    let schema = run("init --schema").expect(0).json();
    assert_eq!(of(&schema, OWN), [""; 0]);
    for (from, to, at) in [
        ("suite = \"own\"\n", "", "suite: required"),
        ("suite = \"own\"", "suite = 3", "suite.suite: type"),
        ("stage", "stag", "suite.stag: nothing"),
        ("\"function\"", "\"fragmnt\"", "suite.stage: enum"),
        ("entry = \"f\"\n", "", "suite: required"),
        ("\"function\"", "\"vertex\"", "suite: not"),
        ("\"weight_range\"", "\"weight_rang\"", "suite.relations[0]: anyOf"),
        ("kind = \"odd\"", "kind = \"od\"", "suite.relations[1]: anyOf"),
        ("inputs = [\"x\"]", "input = [\"x\"]", "suite.relations[1]: anyOf"),
        ("[1, 2]", "[1, 1]", "suite.defines.A: anyOf"),
        ("{ file = \"r.glsl\" }", "{ fil = \"r.glsl\" }", "suite.reference: anyOf"),
        ("reference = {", "recorded = \"a.csv\"\nreference = {", "suite: not"),
        ("\"interval\"", "\"intervall\"", "suite.inputs[0].generator: enum"),
        ("[0.0, 1.0]", "[0.0]", "suite.inputs[0].range: minItems"),
    ] {
        assert!(OWN.contains(from), "{from}");
        let found = of(&schema, &OWN.replace(from, to));
        assert!(found.iter().any(|f| f.starts_with(at)), "{from} -> {to}: {found:?}");
    }
}

#[test]
fn the_manual_page_is_printed() {
    let ran = run("explain suite").expect(0);
    for part in ["\n[[inputs]]\n", "  recorded: text, or a table [recorded]", "\nKinds of laws\n", "  periodic\n"] {
        assert!(ran.out.contains(part), "{}", ran.out);
    }
}
