//! `sarif`: the Static Analysis Results Interchange Format 2.1.0 (OASIS), for code scanning.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use crate::sarif::{encoded, level, log};
use base::diagnostic::{Diagnostic, Fix, Lang, Message};
use base::text::{SourceFile, Span, fingerprint};
use lint::{RULES, Rule, front_end_errors};

use super::{Context, Format};

/// The format.
pub const FORMAT: Format = Format { name: "sarif", summary: "SARIF 2.1.0, for code scanning", write };

/// Name of the folder that relative addresses start from.
const ROOT: &str = "SRCROOT";

fn write(found: &[Diagnostic], context: &Context) -> String {
    let rules = descriptors(found, context.lang);
    let index: BTreeMap<&str, usize> =
        rules.iter().enumerate().filter_map(|(at, rule)| Some((rule["id"].as_str()?, at))).collect();
    let mut seen: BTreeMap<(String, &str, u64), usize> = BTreeMap::new();
    let results: Vec<Value> = found
        .iter()
        .map(|d| {
            let line = fingerprint(d.file.line_text(d.file.position(d.span.start).line));
            let nth = seen.entry((d.file.name().to_owned(), d.code.0, line)).or_default();
            *nth += 1;
            result(d, &index, &format!("{line:016x}:{nth}"), context)
        })
        .collect();
    let root = context.root.as_ref().map(|root| json!({ ROOT: { "uri": format!("file://{}/", encoded(root)) } }));
    log(rules, results, root)
}

/// All rules, and those errors of the front end that were found.
fn descriptors(found: &[Diagnostic], lang: Lang) -> Vec<Value> {
    let reported: BTreeSet<&str> = found.iter().map(|d| d.code.0).collect();
    let errors = front_end_errors().filter(|(code, _)| reported.contains(code.0));
    let errors = errors.map(|(code, line)| {
        json!({ "id": code.0, "shortDescription": { "text": line }, "defaultConfiguration": { "level": "error" } })
    });
    RULES.iter().map(|rule| descriptor(rule, lang)).chain(errors).collect()
}

fn descriptor(rule: &Rule, lang: Lang) -> Value {
    let pages = &rule.pages;
    json!({
        "id": rule.code.0,
        "name": rule.name,
        "shortDescription": { "text": pages.summary(lang) },
        "fullDescription": { "text": pages.what(lang) },
        "help": { "text": pages.why(lang), "markdown": pages.markdown(lang) },
        "defaultConfiguration": { "level": level(rule.severity) },
    })
}

fn result(d: &Diagnostic, index: &BTreeMap<&str, usize>, partial: &str, context: &Context) -> Value {
    let words = |reported: &Message| reported.in_lang(context.lang).to_owned();
    let parts = [Some(&d.message), d.why.as_ref(), d.help.as_ref()];
    let message: Vec<String> = parts.into_iter().flatten().map(words).collect();
    let mut result = json!({
        "ruleId": d.code.0,
        "level": level(d.severity),
        "message": { "text": message.join("\n") },
        "locations": [location(&d.file, d.span, Some(&d.label).filter(|l| !l.is_empty()), context)],
        "partialFingerprints": { "shadercheckLine/v1": partial },
    });
    if let Some(at) = index.get(d.code.0) {
        result["ruleIndex"] = json!(at);
    }
    if !d.related.is_empty() {
        let related = d.related.iter().map(|l| location(&l.file, l.span, Some(&l.message), context));
        result["relatedLocations"] = related.collect();
    }
    if let Some(fix) = d.fix.as_ref().filter(|f| !f.edits.is_empty()) {
        result["fixes"] = json!([fixed(&d.file, fix, context)]);
    }
    result
}

fn location(file: &SourceFile, span: Span, message: Option<&Message>, context: &Context) -> Value {
    let mut location = json!({
        "physicalLocation": { "artifactLocation": artifact(file, context), "region": region(file, span) },
    });
    if let Some(message) = message {
        location["message"] = json!({ "text": message.in_lang(context.lang) });
    }
    location
}

fn fixed(file: &SourceFile, fix: &Fix, context: &Context) -> Value {
    let replacements: Vec<Value> = fix
        .edits
        .iter()
        .map(
            |edit| json!({ "deletedRegion": region(file, edit.span), "insertedContent": { "text": edit.replacement } }),
        )
        .collect();
    json!({
        "description": { "text": fix.title.in_lang(context.lang) },
        "artifactChanges": [{ "artifactLocation": artifact(file, context), "replacements": replacements }],
    })
}

/// Lines and columns count from 1, and the end is exclusive.
fn region(file: &SourceFile, span: Span) -> Value {
    let (from, to) = (file.position(span.start), file.position(span.end));
    json!({ "startLine": from.line, "startColumn": from.column, "endLine": to.line, "endColumn": to.column })
}

fn artifact(file: &SourceFile, context: &Context) -> Value {
    let path = context.path(file.name());
    if path.starts_with('/') {
        return json!({ "uri": format!("file://{}", encoded(path)) });
    }
    let mut artifact = json!({ "uri": encoded(path) });
    if context.root.is_some() {
        artifact["uriBaseId"] = json!(ROOT);
    }
    artifact
}

#[cfg(test)]
mod tests {
    use super::super::testing::sample;
    use super::*;

    fn log(found: &[Diagnostic]) -> Value {
        let context = Context { root: Some("/p q".to_owned()), ..Context::default() };
        serde_json::from_str(&write(found, &context)).unwrap()
    }

    #[test]
    fn every_part_stands_where_the_standard_wants_it() {
        let log = log(&[sample()]);
        assert_eq!((&log["version"], &log["runs"][0]["columnKind"]), (&"2.1.0".into(), &"unicodeCodePoints".into()));
        let run = &log["runs"][0];
        assert_eq!(run["originalUriBaseIds"][ROOT]["uri"], "file:///p%20q/");
        let result = &run["results"][0];
        let rule = &run["tool"]["driver"]["rules"][result["ruleIndex"].as_u64().unwrap() as usize];
        assert_eq!((&rule["id"], &rule["id"]), (&result["ruleId"], &"T001".into()));
        assert!(rule["help"]["markdown"].as_str().unwrap().starts_with("# T001"));
        let place = &result["locations"][0]["physicalLocation"];
        assert_eq!(place["artifactLocation"]["uri"], "%E5%81%B4/%E5%86%86%20%E6%9F%B1.vert");
        assert_eq!(place["artifactLocation"]["uriBaseId"], ROOT);
        let region = json!({ "startLine": 2, "startColumn": 21, "endLine": 2, "endColumn": 25 });
        assert_eq!(place["region"], region);
        assert_eq!(result["relatedLocations"][0]["physicalLocation"]["artifactLocation"]["uri"], "b.frag");
        assert_eq!(result["relatedLocations"][0]["message"]["text"], "declared here");
        let change = &result["fixes"][0]["artifactChanges"][0];
        assert_eq!(change["replacements"][0]["deletedRegion"], region);
        assert_eq!(change["replacements"][0]["insertedContent"]["text"], "vec4");
    }

    #[test]
    fn fingerprints_stay_when_lines_move_and_tell_equal_lines_apart() {
        let moved = |text: &str| {
            let mut found = sample();
            let at = text.find("vec3").unwrap();
            found.file = SourceFile::new("a.vert", text);
            found.span = Span::new(at, at + 4);
            found.fix = None;
            found
        };
        let print = |value: &Value, nth: usize| {
            value["runs"][0]["results"][nth]["partialFingerprints"]["shadercheckLine/v1"].as_str().unwrap().to_owned()
        };
        let (old, new, other) = (moved("x = vec3(1);"), moved("\n\n  x =  vec3(1);\n"), moved("y = vec3(1);"));
        assert_eq!(print(&log(std::slice::from_ref(&old)), 0), print(&log(&[new]), 0));
        assert_ne!(print(&log(std::slice::from_ref(&old)), 0), print(&log(&[other]), 0));
        let twice = log(&[old.clone(), old]);
        assert_ne!(print(&twice, 0), print(&twice, 1));
    }

    #[test]
    fn rules_are_unique_and_errors_of_the_front_end_are_among_them() {
        let mut found = sample();
        found.code = front_end_errors().next().unwrap().0;
        let log = log(&[found]);
        let rules = log["runs"][0]["tool"]["driver"]["rules"].as_array().unwrap().clone();
        let ids: BTreeSet<&str> = rules.iter().map(|r| r["id"].as_str().unwrap()).collect();
        assert_eq!((ids.len(), rules.len()), (rules.len(), RULES.len() + 1));
        assert_eq!(log["runs"][0]["results"][0]["ruleIndex"], RULES.len());
    }

    #[test]
    fn files_outside_of_the_root_have_absolute_addresses() {
        let mut found = sample();
        found.file = SourceFile::new("/other/a.vert", found.file.text());
        let place = log(&[found])["runs"][0]["results"][0]["locations"][0]["physicalLocation"].clone();
        assert_eq!(place["artifactLocation"], json!({ "uri": "file:///other/a.vert" }));
    }
}
