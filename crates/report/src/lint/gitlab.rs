//! `gitlab`: Code Quality of GitLab, beside the lines of a merge request.

use crate::gitlab::Issues;
use base::diagnostic::Diagnostic;
use lint::with_name;

use super::{Context, Format};

/// The format.
pub const FORMAT: Format = Format { name: "gitlab", summary: "Code Quality of GitLab, for merge requests", write };

fn write(found: &[Diagnostic], context: &Context) -> String {
    let mut issues = Issues::default();
    for d in found {
        let line = d.file.position(d.span.start).line;
        let (message, place) = (d.message.in_lang(context.lang), d.file.line_text(line));
        let file = context.path(d.file.name());
        issues.add(d.severity, &with_name(d.code.0), message, file, line, place);
    }
    issues.report()
}

#[cfg(test)]
mod tests {
    use super::super::testing::sample;
    use super::*;
    use base::text::{SourceFile, Span};
    use serde_json::Value;

    fn report(found: &[Diagnostic]) -> Value {
        let context = Context { root: Some("/p".to_owned()), ..Context::default() };
        serde_json::from_str(&write(found, &context)).unwrap()
    }

    #[test]
    fn an_issue_has_what_gitlab_requires() {
        let mut found = sample();
        found.file = SourceFile::new("/p/a.vert", found.file.text());
        let issue = &report(&[found])[0];
        assert_eq!(
            (&issue["check_name"], &issue["severity"]),
            (&"T001 constructor-too-many-args".into(), &"major".into())
        );
        assert_eq!((&issue["location"]["path"], &issue["location"]["lines"]["begin"]), (&"a.vert".into(), &2.into()));
        assert_eq!(issue["description"], "too few, or: 100%\nof it");
        assert_eq!(report(&[]), serde_json::json!([]));
    }

    #[test]
    fn fingerprints_stay_when_lines_move_and_are_unique() {
        let print = |text: &str, nth: usize| {
            let at = |k: usize| {
                let mut found = sample();
                let start = text.match_indices("vec3").nth(k).unwrap().0;
                found.file = SourceFile::new("a.vert", text);
                (found.span, found.fix) = (Span::new(start, start + 4), None);
                found
            };
            let all: Vec<Diagnostic> = (0..text.matches("vec3").count()).map(at).collect();
            report(&all)[nth]["fingerprint"].clone()
        };
        assert_eq!(print("x = vec3(1);", 0), print("\n\n  x =   vec3(1);\n", 0));
        assert_ne!(print("x = vec3(1);", 0), print("y = vec3(1);", 0));
        assert_ne!(print("x = vec3(1);\nx = vec3(1);", 0), print("x = vec3(1);\nx = vec3(1);", 1));
    }
}
