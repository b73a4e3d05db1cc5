//! What the page of the errors of devices shows, for programs: `docs/accuracy.schema.json` says what it is made of.

use anyhow::{Context, Result};
use serde_json::{Map, Value, json};
use toml::Table;

/// What of an operation is taken over as it is, where the profile has it.
const OF_OPERATION: [&str; 12] = [
    "promise",
    "definition",
    "samples",
    "exhaustive",
    "worst_ulp",
    "worst_ulp_at",
    "worst_abs",
    "worst_abs_at",
    "ratio",
    "verdict",
    "undefined",
    "flushed",
];
/// And of a device.
const OF_DEVICE: [&str; 4] = ["lane", "driver", "date", "samples"];

/// The table, of all profiles that name a device.
///
/// # Errors
/// When a profile has no name or no operations.
pub fn table<'a>(profiles: impl Iterator<Item = &'a Table>) -> Result<String> {
    let mut devices = Vec::new();
    for profile in profiles {
        devices.extend(device(profile)?);
    }
    let table = json!({ "schema": "shadercheck-accuracy", "schema_version": "1.0", "devices": devices });
    Ok(format!("{table:#}\n"))
}

fn device(profile: &Table) -> Result<Option<Value>> {
    let Some(device) = profile.get("device").and_then(toml::Value::as_table) else { return Ok(None) };
    let name = profile.get("name").and_then(toml::Value::as_str).context("a profile has no name")?;
    let operations = profile.get("operations").and_then(toml::Value::as_table);
    let operations = operations.with_context(|| format!("the profile `{name}` has no operations"))?;
    // Those that were not measured have a rule in place of a table.
    let measured = operations.iter().filter_map(|(name, value)| Some((name, value.as_table()?)));
    let measured = measured.map(|(name, value)| {
        let mut entry = taken(value, &OF_OPERATION);
        entry.insert("operation".to_owned(), name.as_str().into());
        Value::Object(entry)
    });
    let mut entry = taken(device, &OF_DEVICE);
    entry.insert("name".to_owned(), name.into());
    entry.insert("operations".to_owned(), measured.collect());
    Ok(Some(Value::Object(entry)))
}

fn taken(from: &Table, keys: &[&str]) -> Map<String, Value> {
    keys.iter().filter_map(|key| Some(((*key).to_owned(), value(from.get(*key)?)))).collect()
}

/// A value of TOML. Floats that JSON cannot hold are texts.
fn value(from: &toml::Value) -> Value {
    match from {
        toml::Value::Float(x) if !x.is_finite() => x.to_string().into(),
        toml::Value::Float(x) => (*x).into(),
        toml::Value::Integer(n) => (*n).into(),
        toml::Value::Boolean(b) => (*b).into(),
        toml::Value::Array(list) => list.iter().map(value).collect(),
        other => other.as_str().map_or_else(|| other.to_string(), str::to_owned).into(),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;

    /// What a value breaks of a schema: as much of JSON Schema as this schema uses. A keyword that is not known here fails.
    fn broken(schema: &Value, value: &Value, at: &str) -> Vec<String> {
        let mut found = Vec::new();
        for (key, rule) in schema.as_object().unwrap() {
            let holds = match key.as_str() {
                "$schema" | "$id" | "title" | "description" => true,
                "const" => value == rule,
                "enum" => rule.as_array().unwrap().contains(value),
                "type" => match rule.as_str().unwrap() {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "string" => value.is_string(),
                    "number" => value.is_number(),
                    "integer" => value.is_u64(),
                    "boolean" => value.is_boolean(),
                    other => panic!("type {other}"),
                },
                "required" => rule.as_array().unwrap().iter().all(|name| value.get(name.as_str().unwrap()).is_some()),
                "anyOf" => rule.as_array().unwrap().iter().any(|inner| broken(inner, value, at).is_empty()),
                "additionalProperties" => {
                    assert_eq!(rule, &json!(false));
                    value.as_object().unwrap().keys().all(|name| schema["properties"].get(name).is_some())
                }
                "properties" => {
                    for (name, inner) in rule.as_object().unwrap() {
                        let inner = |v| broken(inner, v, &format!("{at}.{name}"));
                        found.extend(value.get(name).into_iter().flat_map(inner));
                    }
                    true
                }
                "items" => {
                    found.extend(value.as_array().unwrap().iter().flat_map(|v| broken(rule, v, &format!("{at}[]"))));
                    true
                }
                other => panic!("keyword {other}"),
            };
            if !holds {
                found.push(format!("{at}: {key} {rule}"));
            }
        }
        found
    }

    fn schema() -> Value {
        serde_json::from_str(include_str!("../../../docs/accuracy.schema.json")).unwrap()
    }

    fn of(texts: &[&str]) -> Value {
        let profiles: Vec<Table> = texts.iter().map(|text| text.parse().unwrap()).collect();
        serde_json::from_str(&table(profiles.iter()).unwrap()).unwrap()
    }

    #[test]
    fn the_table_of_what_ships_is_valid_and_has_what_the_profiles_have() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/judge/profiles");
        let file = |entry: std::io::Result<fs::DirEntry>| fs::read_to_string(entry.unwrap().path()).unwrap();
        let texts: Vec<String> = fs::read_dir(folder).unwrap().map(file).collect();
        let table = of(&texts.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(broken(&schema(), &table, ""), [""; 0]);
        let devices = table["devices"].as_array().unwrap();
        assert_eq!(devices.len(), texts.iter().filter(|text| text.contains("\n[device]\n")).count());
        let llvmpipe = devices.iter().find(|device| device["name"] == "llvmpipe-22.3.6").unwrap();
        let operations = llvmpipe["operations"].as_array().unwrap();
        let sine = operations.iter().find(|operation| operation["operation"] == "sin").unwrap();
        assert_eq!(sine["promise"], "abs(2^-11) for x in -pi..pi");
        assert!(sine["worst_ulp_at"][0].as_str().is_some_and(|at| at.starts_with("0x")), "{sine}");
    }

    const SMALL: &str = "name = \"a-1\"\n[device]\ndriver = \"a 1\"\n[operations]\nsub = \"rounded\"\n\
        [operations.add]\nworst_ulp = inf\nexhaustive = false\nbinades = []\n";

    #[test]
    fn what_a_profile_lacks_is_absent_and_what_was_not_measured_is_no_operation() {
        let table = of(&[SMALL, "name = \"specification\"\n[operations]\nadd = \"rounded\"\n"]);
        let operation = json!({ "operation": "add", "worst_ulp": "inf", "exhaustive": false });
        let device = json!({ "name": "a-1", "driver": "a 1", "operations": [operation] });
        assert_eq!(table["devices"], json!([device]));
        assert_eq!(broken(&schema(), &table, ""), [""; 0]);
        assert!(device_error("[device]\ndriver = \"a\"\n").contains("has no name"));
        assert!(device_error("name = \"a\"\n[device]\n").contains("`a` has no operations"));
    }

    fn device_error(text: &str) -> String {
        device(&text.parse().unwrap()).unwrap_err().to_string()
    }

    #[test]
    fn the_schema_refuses_what_is_no_such_table() {
        for (from, to) in [
            ("\"a-1\"", "1"),
            ("worst_ulp = inf", "worst_ulp = \"much\""),
            ("exhaustive = false", "exhaustive = \"no\""),
            ("exhaustive = false", "samples = -1"),
            ("exhaustive = false", "worst_ulp_at = [1]"),
        ] {
            let text = SMALL.replacen(from, to, 1);
            let text = if from == "\"a-1\"" { SMALL.to_owned() } else { text };
            let mut table = of(&[&text]);
            if from == "\"a-1\"" {
                table["devices"][0]["name"] = json!(1);
            }
            assert_ne!(broken(&schema(), &table, ""), [""; 0], "{to}");
        }
    }
}
