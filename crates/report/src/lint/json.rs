//! `json`: an array for programs.

use serde::Serialize;

use base::diagnostic::{Diagnostic, Safety};
use base::text::{SourceFile, Span};
use lint::by_code;

use super::{Context, Format, to_text};

/// The format.
pub const FORMAT: Format = Format { name: "json", summary: "An array for programs", write };

/// A diagnostic as JSON has it. Lines and columns count from 1, columns in characters; ends are
/// exclusive. Keys may be added later, and are not renamed.
#[derive(Serialize)]
struct JsonDiagnostic<'a> {
    code: &'a str,
    name: Option<&'a str>,
    severity: &'a str,
    #[serde(flatten)]
    place: JsonPlace<'a>,
    message: &'a str,
    label: &'a str,
    related: Vec<JsonLabel<'a>>,
    why: Option<&'a str>,
    help: Option<&'a str>,
    fix: Option<JsonFix<'a>>,
}

#[derive(Serialize)]
struct JsonPlace<'a> {
    file: &'a str,
    line: usize,
    column: usize,
    end_line: usize,
    end_column: usize,
}

#[derive(Serialize)]
struct JsonLabel<'a> {
    #[serde(flatten)]
    place: JsonPlace<'a>,
    message: &'a str,
}

#[derive(Serialize)]
struct JsonFix<'a> {
    title: &'a str,
    safety: &'a str,
    edits: Vec<JsonEdit<'a>>,
}

#[derive(Serialize)]
struct JsonEdit<'a> {
    #[serde(flatten)]
    place: JsonPlace<'a>,
    replacement: &'a str,
}

impl<'a> JsonPlace<'a> {
    fn new(file: &'a SourceFile, span: Span) -> Self {
        let (from, to) = (file.position(span.start), file.position(span.end));
        Self { file: file.name(), line: from.line, column: from.column, end_line: to.line, end_column: to.column }
    }
}

/// All diagnostics as one JSON array, with a line break at the end. Codes of the front end have no
/// name.
fn write(diagnostics: &[Diagnostic], context: &Context) -> String {
    let lang = context.lang;
    let all: Vec<JsonDiagnostic<'_>> = diagnostics
        .iter()
        .map(|d| JsonDiagnostic {
            code: d.code.0,
            name: by_code(d.code.0).map(|r| r.name),
            severity: d.severity.name(),
            place: JsonPlace::new(&d.file, d.span),
            message: d.message.in_lang(lang),
            label: d.label.in_lang(lang),
            related: d
                .related
                .iter()
                .map(|l| JsonLabel { place: JsonPlace::new(&l.file, l.span), message: l.message.in_lang(lang) })
                .collect(),
            why: d.why.as_ref().map(|w| w.in_lang(lang)),
            help: d.help.as_ref().map(|h| h.in_lang(lang)),
            fix: d.fix.as_ref().map(|f| JsonFix {
                title: f.title.in_lang(lang),
                safety: match f.safety {
                    Safety::Safe => "safe",
                    Safety::Unsafe => "unsafe",
                },
                edits: f
                    .edits
                    .iter()
                    .map(|e| JsonEdit { place: JsonPlace::new(&d.file, e.span), replacement: &e.replacement })
                    .collect(),
            }),
        })
        .collect();
    to_text(&all)
}

#[cfg(test)]
mod tests {
    use super::super::testing::sample;
    use super::*;

    #[test]
    fn it_reads_back() {
        let text = write(&[sample()], &Context::default());
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        let d = &value[0];
        assert_eq!((&d["code"], &d["name"]), (&"T001".into(), &"constructor-too-many-args".into()));
        assert_eq!((&d["line"], &d["column"], &d["end_column"]), (&2.into(), &21.into(), &25.into()));
        assert_eq!((&d["fix"]["safety"], &d["fix"]["edits"][0]["replacement"]), (&"unsafe".into(), &"vec4".into()));
        assert_eq!(d["related"][0]["file"], "b.frag");
        assert_eq!(write(&[], &Context::default()), "[]\n");
    }
}
