//! What tests of rules share.

use crate::diagnostic::Diagnostic;
use crate::lint::{Input, Selection, Settings, run_with};
use crate::text::SourceFile;

/// What one rule finds in a file; the front end must find no error.
pub fn found(code: &str, name: &str, text: &str) -> Vec<Diagnostic> {
    let file = [Input::new(SourceFile::new(name, text))];
    let selection = Selection::new(&[code.to_owned(), "E".to_owned()], &[]).unwrap();
    let found = run_with(&file, &Settings { selection, ..Settings::default() });
    assert!(found.iter().all(|d| d.code.0 == code), "{text}\n{found:#?}");
    for d in &found {
        assert!(d.message.is_translated() && d.why.as_ref().is_some_and(|w| w.is_translated()), "{d:#?}");
        assert!(d.help.as_ref().is_none_or(|h| h.is_translated()) && (d.label.is_translated() || d.label.is_empty()));
    }
    found
}

/// The messages of [`found`].
pub fn messages(code: &str, name: &str, text: &str) -> Vec<String> {
    found(code, name, text).iter().map(|d| d.message.to_string()).collect()
}
