//! Formats in which findings of the linter are reported. A format is one file and one line of the
//! registry.

mod concise;
mod github;
mod gitlab;
pub mod grouped;
mod json;
mod rdjson;
mod sarif;
mod text;

use serde::Serialize;

use base::diagnostic::{Diagnostic, Lang};

/// A format of reports.
pub struct Format {
    /// Name, as `--format` takes it.
    pub name: &'static str,
    /// What it is for, in a few words.
    pub summary: &'static str,
    /// Writes findings as they are to be printed, with a line break at the end.
    pub write: fn(&[Diagnostic], &Context) -> String,
}

/// All formats; the first is used when nothing is said.
pub const FORMATS: &[&Format] = &[
    &text::FORMAT,
    &concise::FORMAT,
    &json::FORMAT,
    &sarif::FORMAT,
    &github::FORMAT,
    &gitlab::FORMAT,
    &rdjson::FORMAT,
];

/// The format of this name.
pub fn by_name(name: &str) -> Option<&'static Format> {
    FORMATS.iter().copied().find(|f| f.name == name)
}

/// What a report is written with.
#[derive(Clone, Debug, Default)]
pub struct Context {
    /// Language of messages.
    pub lang: Lang,
    /// True for a terminal with colours.
    pub color: bool,
    /// The folder that paths are told from, absolute and with `/`: files below it are told by their
    /// path from it.
    pub root: Option<String>,
}

impl Context {
    /// Path of a file from the root, without `./`; as it is when the file lies elsewhere.
    pub fn path<'n>(&self, name: &'n str) -> &'n str {
        let inside = self.root.as_deref().and_then(|root| name.strip_prefix(root)?.strip_prefix('/'));
        let mut path = inside.unwrap_or(name);
        while let Some(rest) = path.strip_prefix("./") {
            path = rest;
        }
        path
    }
}

/// JSON with a line break at the end.
fn to_text(value: &impl Serialize) -> String {
    // What is written here has texts for keys, and no value that refuses.
    let mut text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.push('\n');
    text
}

#[cfg(test)]
mod testing {
    use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
    use base::text::{Edit, SourceFile, Span};

    /// A finding with everything that one can have, in text with wide characters.
    pub fn sample() -> Diagnostic {
        let file = SourceFile::new("側/円 柱.vert", "int a;\n/* 頂点   */ vec4 p = vec3(1.0);\nint z;\n");
        let at = file.text().find("vec3").unwrap();
        let span = Span::new(at, at + 4);
        let shader = SourceFile::new("b.frag", "one\ntwo three\n");
        Diagnostic::new(Code("T001"), Severity::Error, &file, span, message!("too few, or: 100%\nof it", "足りません"))
            .with_label("makes a `vec3`")
            .with_related(&shader, Span::new(8, 13), "declared here")
            .with_why("because")
            .with_help("do something")
            .with_fix("construct a `vec4`", Safety::Unsafe, vec![Edit::replace(span, "vec4")])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for format in FORMATS {
            assert_eq!(by_name(format.name).unwrap().summary, format.summary, "{}", format.name);
        }
        assert!(by_name("xml").is_none());
    }

    #[test]
    fn paths_are_told_from_the_root() {
        let context = Context { root: Some("/p/q".to_owned()), ..Context::default() };
        assert_eq!(context.path("/p/q/a/b.vert"), "a/b.vert");
        assert_eq!(context.path("/p/qr/b.vert"), "/p/qr/b.vert");
        assert_eq!(context.path("././a.vert"), "a.vert");
        assert_eq!(context.path("../a.vert"), "../a.vert");
    }
}
