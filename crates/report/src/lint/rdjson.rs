//! `rdjson`: the Reviewdog Diagnostic Format, with repairs as suggestions.

use serde_json::{Value, json};

use crate::reviewdog::{range, report, severity};
use base::diagnostic::{Diagnostic, Safety};

use super::{Context, Format};

/// The format.
pub const FORMAT: Format = Format { name: "rdjson", summary: "Reviewdog Diagnostic Format, with repairs", write };

fn write(found: &[Diagnostic], context: &Context) -> String {
    report(found.iter().map(|d| diagnostic(d, context)).collect())
}

fn diagnostic(d: &Diagnostic, context: &Context) -> Value {
    let parts = [Some(&d.message), d.why.as_ref(), d.help.as_ref()];
    let message: Vec<&str> = parts.into_iter().flatten().map(|part| part.in_lang(context.lang)).collect();
    let mut diagnostic = json!({
        "message": message.join("\n"),
        "location": { "path": context.path(d.file.name()), "range": range(&d.file, d.span) },
        "severity": severity(d.severity),
        "code": { "value": d.code.0 },
    });
    // A suggestion is applied with one click and without the warning that an unsafe repair needs. Those that belong
    // together would be offered one by one.
    if let Some(fix) = d.fix.as_ref().filter(|fix| fix.safety == Safety::Safe)
        && let [edit] = &fix.edits[..]
    {
        diagnostic["suggestions"] = json!([{ "range": range(&d.file, edit.span), "text": edit.replacement }]);
    }
    diagnostic
}

#[cfg(test)]
mod tests {
    use super::super::testing::sample;
    use super::*;

    fn first(found: Diagnostic) -> Value {
        let report: Value = serde_json::from_str(&write(&[found], &Context::default())).unwrap();
        assert_eq!(report["source"]["name"], "shadercheck");
        report["diagnostics"][0].clone()
    }

    #[test]
    fn columns_count_bytes_and_ends_are_exclusive() {
        let found = first(sample());
        let (start, end) = (&found["location"]["range"]["start"], &found["location"]["range"]["end"]);
        // Two characters of three bytes stand before it.
        assert_eq!((&start["line"], &start["column"]), (&2.into(), &25.into()));
        assert_eq!((&end["line"], &end["column"]), (&2.into(), &29.into()));
        assert_eq!((&found["severity"], &found["code"]["value"]), (&"ERROR".into(), &"T001".into()));
        assert_eq!(found["message"], "too few, or: 100%\nof it\nbecause\ndo something");
    }

    #[test]
    fn only_a_safe_repair_of_one_place_is_suggested() {
        let unsafe_one = sample();
        assert_eq!(first(unsafe_one.clone())["suggestions"], Value::Null);
        let mut safe = unsafe_one;
        safe.fix.as_mut().unwrap().safety = Safety::Safe;
        assert_eq!(first(safe.clone())["suggestions"][0]["text"], "vec4");
        let fix = safe.fix.as_mut().unwrap();
        fix.edits.push(fix.edits[0].clone());
        assert_eq!(first(safe)["suggestions"], Value::Null);
    }
}
