//! SARIF reports against the objects of the standard: SARIF 2.1.0 errata 01, section 3, with the properties that
//! each may have, their types, and which it must have.

use serde_json::{Value, json};

use crate::binary::{root, run_in};

/// What a property holds.
#[derive(Clone, Copy)]
enum Holds {
    Text,
    /// A whole number from this one on.
    From(i64),
    OneOf(&'static [&'static str]),
    Object(&'static str),
    List(&'static str),
    /// An object with names of its own.
    Map(&'static str),
    /// An object with texts.
    Texts,
}
use Holds::{From, List, Map, Object, OneOf, Text, Texts};

/// Name of an object, its properties, and those that it must have. Only what is of use here; what is missing
/// from the list counts as an error, so that it gets its line with its type.
type Schema = (&'static str, &'static [(&'static str, Holds)], &'static [&'static str]);

const OBJECTS: &[Schema] = &[
    // 3.13
    ("sarifLog", &[("$schema", Text), ("version", OneOf(&["2.1.0"])), ("runs", List("run"))], &["version", "runs"]),
    // 3.14
    (
        "run",
        &[
            ("tool", Object("tool")),
            ("results", List("result")),
            ("columnKind", OneOf(&["utf16CodeUnits", "unicodeCodePoints"])),
            ("originalUriBaseIds", Map("artifactLocation")),
        ],
        &["tool"],
    ),
    // 3.18, 3.19
    ("tool", &[("driver", Object("toolComponent"))], &["driver"]),
    (
        "toolComponent",
        &[
            ("name", Text),
            ("version", Text),
            ("semanticVersion", Text),
            ("informationUri", Text),
            ("rules", List("reportingDescriptor")),
        ],
        &["name"],
    ),
    // 3.49, 3.50
    (
        "reportingDescriptor",
        &[
            ("id", Text),
            ("name", Text),
            ("shortDescription", Object("multiformatMessageString")),
            ("fullDescription", Object("multiformatMessageString")),
            ("help", Object("multiformatMessageString")),
            ("helpUri", Text),
            ("defaultConfiguration", Object("reportingConfiguration")),
        ],
        &["id"],
    ),
    ("reportingConfiguration", &[("level", OneOf(LEVELS))], &[]),
    // 3.11, 3.12
    ("message", &[("text", Text), ("markdown", Text)], &["text"]),
    ("multiformatMessageString", &[("text", Text), ("markdown", Text)], &["text"]),
    // 3.27
    (
        "result",
        &[
            ("ruleId", Text),
            ("ruleIndex", From(0)),
            ("level", OneOf(LEVELS)),
            ("message", Object("message")),
            ("locations", List("location")),
            ("relatedLocations", List("location")),
            ("partialFingerprints", Texts),
            ("fixes", List("fix")),
        ],
        &["message"],
    ),
    // 3.28 to 3.30, 3.4
    (
        "location",
        &[("id", From(0)), ("physicalLocation", Object("physicalLocation")), ("message", Object("message"))],
        &[],
    ),
    (
        "physicalLocation",
        &[("artifactLocation", Object("artifactLocation")), ("region", Object("region"))],
        &["artifactLocation"],
    ),
    ("artifactLocation", &[("uri", Text), ("uriBaseId", Text)], &[]),
    (
        "region",
        &[("startLine", From(1)), ("startColumn", From(1)), ("endLine", From(1)), ("endColumn", From(1))],
        &["startLine"],
    ),
    // 3.55 to 3.57, 3.3
    ("fix", &[("description", Object("message")), ("artifactChanges", List("artifactChange"))], &["artifactChanges"]),
    (
        "artifactChange",
        &[("artifactLocation", Object("artifactLocation")), ("replacements", List("replacement"))],
        &["artifactLocation", "replacements"],
    ),
    (
        "replacement",
        &[("deletedRegion", Object("region")), ("insertedContent", Object("artifactContent"))],
        &["deletedRegion"],
    ),
    ("artifactContent", &[("text", Text)], &[]),
];

const LEVELS: &[&str] = &["none", "note", "warning", "error"];

/// What is wrong with `value` as this object, each with the way to it.
fn faults(object: &str, value: &Value, way: &str, into: &mut Vec<String>) {
    let Some((_, properties, required)) = OBJECTS.iter().find(|o| o.0 == object) else {
        return into.push(format!("{way}: no object {object}"));
    };
    let Some(fields) = value.as_object() else { return into.push(format!("{way}: no object")) };
    for name in required.iter().filter(|n| !fields.contains_key(**n)) {
        into.push(format!("{way}: lacks {name}"));
    }
    for (name, value) in fields {
        let way = format!("{way}.{name}");
        let Some((_, holds)) = properties.iter().find(|p| p.0 == name) else {
            into.push(format!("{way}: {object} has no such property"));
            continue;
        };
        let good = match holds {
            Text => value.is_string(),
            From(least) => value.as_i64().is_some_and(|n| n >= *least),
            OneOf(all) => value.as_str().is_some_and(|v| all.contains(&v)),
            Texts => value.as_object().is_some_and(|o| o.values().all(Value::is_string)),
            Object(inner) => {
                faults(inner, value, &way, into);
                true
            }
            List(inner) => value.as_array().is_some_and(|list| {
                list.iter().enumerate().for_each(|(i, v)| faults(inner, v, &format!("{way}[{i}]"), into));
                true
            }),
            Map(inner) => value.as_object().is_some_and(|map| {
                map.iter().for_each(|(k, v)| faults(inner, v, &format!("{way}[{k}]"), into));
                true
            }),
        };
        if !good {
            into.push(format!("{way}: {value}"));
        }
    }
}

fn report(args: &str) -> Value {
    let ran = run_in(root(), &format!("lint --lang en --no-config --format sarif {args}")).expect(1);
    serde_json::from_str(&ran.out).unwrap()
}

pub(crate) fn all_faults(log: &Value) -> Vec<String> {
    let mut found = Vec::new();
    faults("sarifLog", log, "log", &mut found);
    found
}

#[test]
fn reports_follow_the_standard() {
    for args in ["fixtures/tour", "fixtures/printed", "fixtures/tour --level heuristic"] {
        let log = report(args);
        assert_eq!(all_faults(&log), [""; 0], "{args}");
        let results = log["runs"][0]["results"].as_array().unwrap();
        assert!(results.iter().any(|r| r.get("fixes").is_some()), "{args}: no fix is checked");
        assert!(results.iter().any(|r| r.get("relatedLocations").is_some()), "{args}: no pair is checked");
        let rules = log["runs"][0]["tool"]["driver"]["rules"].as_array().unwrap();
        for result in results {
            let index = usize::try_from(result["ruleIndex"].as_u64().unwrap()).unwrap();
            assert_eq!(rules[index]["id"], result["ruleId"]);
        }
    }
}

#[test]
fn what_does_not_follow_the_standard_is_noticed() {
    let log = report("fixtures/tour");
    let broken = |change: fn(&mut Value)| {
        let mut log = log.clone();
        change(&mut log["runs"][0]);
        all_faults(&log).len()
    };
    assert_eq!(broken(|_| {}), 0);
    assert_eq!(broken(|run| run["results"][0]["message"] = json!({})), 1);
    assert_eq!(broken(|run| run["results"][0]["level"] = json!("info")), 1);
    assert_eq!(broken(|run| run["results"][0]["line"] = json!(3)), 1);
    assert_eq!(
        broken(|run| run["results"][0]["locations"][0]["physicalLocation"]["region"]["startLine"] = json!(0)),
        1
    );
    assert_eq!(broken(|run| run["tool"] = json!({})), 1);
}
