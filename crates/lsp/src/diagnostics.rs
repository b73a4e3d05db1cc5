//! Diagnostics in the types of the protocol.

use base::diagnostic::{Diagnostic, Lang, Severity};
use lint::by_code;
use ls_types::{
    CodeDescription, Diagnostic as Shown, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Location,
    NumberOrString, Uri,
};

use crate::encoding::Encoding;

/// A diagnostic as an editor shows it: message, reason and advice, with its other places. `uri` names files, and
/// `pages` is what the addresses of the rules' pages begin with.
pub fn diagnostic(
    found: &Diagnostic,
    lang: Lang,
    encoding: Encoding,
    uri: &dyn Fn(&str) -> Option<Uri>,
    pages: Option<&str>,
) -> Shown {
    let further = [&found.why, &found.help].into_iter().flatten().map(|m| m.in_lang(lang));
    let message = [found.message.in_lang(lang)].into_iter().chain(further).collect::<Vec<_>>().join("\n");
    let related = found.related.iter().filter_map(|label| {
        let location = Location { uri: uri(label.file.name())?, range: encoding.range(&label.file, label.span) };
        Some(DiagnosticRelatedInformation { location, message: label.message.in_lang(lang).to_owned() })
    });
    let related: Vec<DiagnosticRelatedInformation> = related.collect();
    Shown {
        range: encoding.range(&found.file, found.span),
        severity: Some(match found.severity {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
            Severity::Info => DiagnosticSeverity::INFORMATION,
        }),
        code: Some(NumberOrString::String(found.code.0.to_owned())),
        code_description: pages.and_then(|p| rule_link(p, found.code.0)).map(|href| CodeDescription { href }),
        source: Some("shadercheck".to_owned()),
        message,
        related_information: Some(related).filter(|r| !r.is_empty()),
        tags: tag(found.code.0).map(|tag| vec![tag]),
        data: None,
    }
}

/// The address of a rule's page.
pub fn rule_link(pages: &str, code: &str) -> Option<Uri> {
    let name = by_code(code)?.name;
    format!("{}/{name}.html", pages.trim_end_matches('/')).parse().ok()
}

/// How an editor draws what a rule finds: code that does nothing is dimmed, and what is out of date is struck out.
fn tag(code: &str) -> Option<DiagnosticTag> {
    match by_code(code)?.name {
        "dead-store" | "unused-function" | "unused-parameter" | "unused-uniform" | "unused-variable"
        | "unused-binding" | "unused-suppression" => Some(DiagnosticTag::UNNECESSARY),
        "deprecated-in-profile" | "noise-function" => Some(DiagnosticTag::DEPRECATED),
        _ => None,
    }
}
