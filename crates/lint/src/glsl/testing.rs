//! What tests of rules share.

use crate::{Input, Level, Selection, Settings, run, run_with};
use base::diagnostic::{Code, Diagnostic, Safety};
use base::text::{EditList, SourceFile};

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

/// Codes of the findings in a text, and the text with the first of their fixes.
pub type Repaired = (Vec<&'static str>, Option<(Safety, String)>);

/// What all rules find at the default level.
pub fn repaired(name: &str, text: &str) -> Repaired {
    repaired_of(run(&[Input::new(SourceFile::new(name, text))]), text)
}

/// The same for texts in which variables that nothing reads (`D` codes) are beside the point.
pub fn repaired_but_flow(name: &str, text: &str) -> Repaired {
    let mut found = run(&[Input::new(SourceFile::new(name, text))]);
    found.retain(|d| !d.code.0.starts_with('D'));
    repaired_of(found, text)
}

fn repaired_of(found: Vec<Diagnostic>, text: &str) -> Repaired {
    let fix = found.first().and_then(|d| d.fix.clone());
    let fixed = fix.map(|f| (f.safety, f.edits.into_iter().collect::<EditList>().apply(text).unwrap().text));
    (found.iter().map(|d| d.code.0).collect(), fixed)
}

/// How often a rule finds something at the default level.
pub fn default_count(code: Code, name: &str, text: &str) -> usize {
    run(&[Input::new(SourceFile::new(name, text))]).iter().filter(|d| d.code == code).count()
}

/// How often a rule finds something at the strict level.
pub fn strict_count(code: Code, name: &str, text: &str) -> usize {
    let settings = Settings { selection: Selection::default().at(Level::Strict), ..Settings::default() };
    run_with(&[Input::new(SourceFile::new(name, text))], &settings).iter().filter(|d| d.code == code).count()
}
