//! Texts that are read with what they import or include.
//!
//! Rules see the whole text, so that they know the types of what comes from other files and what the functions there do. Each file is
//! the root of a text of its own: what is found in another file of a text is told where that one is the root, and only
//! there.
//!
//! What naga's validator says about a text is passed in by the command line, so that the rules do not depend on naga.

use std::collections::{HashMap, HashSet};
use std::fmt;
use std::sync::Arc;

use base::diagnostic::{Code, Diagnostic, Fix, Severity};
use base::text::{Edit, SourceFile};

use super::project::Project;
use crate::Level;

/// A text with what it imports or includes, and why a reader of the language refuses it.
#[derive(Clone, Debug)]
pub struct Composed {
    /// The text, whose places lead back to the files.
    pub file: SourceFile,
    /// What a reader says, at places of the text; at the strict level what the reader alone may lack.
    pub refused: Vec<(Level, Diagnostic)>,
}

/// Joins a text with what it imports or includes; none where there is nothing to join, or something is missing.
#[derive(Clone)]
pub struct Composer(Arc<Joins>);

/// The text of a file with what it imports.
type Joins = dyn Fn(&SourceFile) -> Option<Composed> + Send + Sync;

impl Composer {
    /// A composer by a function that gives the joined text.
    pub fn new(joins: impl Fn(&SourceFile) -> Option<Composed> + Send + Sync + 'static) -> Self {
        Self(Arc::new(joins))
    }

    /// The text of a file with what it imports.
    pub fn join(&self, file: &SourceFile) -> Option<Composed> {
        (self.0)(file)
    }
}

impl fmt::Debug for Composer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Composer")
    }
}

/// What readers of the language say of texts in which nothing else is wrong: they tell the same once more. Errors of
/// `not_sought` are those that they let through. What is told of a line is not said again.
pub fn add_refused(project: &Project, all: &mut Vec<(Level, Diagnostic)>, not_sought: &[Code]) {
    let mut more: Vec<(Level, Diagnostic)> =
        project.shaders().filter(|s| s.reported).flat_map(|s| s.refused.iter().cloned()).collect();
    to_origin(project, &mut more);
    let line = |d: &Diagnostic| d.file.location(d.span.start).position.map(|position| position.line);
    let errors = || all.iter().map(|(_, d)| d).filter(|d| d.severity == Severity::Error);
    let of_reading = |d: &&Diagnostic| !not_sought.contains(&d.code);
    let unread: HashSet<&str> = errors().filter(of_reading).map(|d| d.file.name()).collect();
    let told: HashSet<(&str, Option<usize>)> = errors().map(|d| (d.file.name(), line(d))).collect();
    more.retain(|(_, d)| !unread.contains(d.file.name()) && !told.contains(&(d.file.name(), line(d))));
    all.extend(more);
}

/// Brings what is told about joined texts to the files of their authors. Of a module that a script puts together, what is
/// found in another file is told there: that one may be the root of none.
pub fn to_origin(project: &Project, all: &mut Vec<(Level, Diagnostic)>) {
    let put_together: HashSet<&str> =
        project.shaders().filter(|s| s.is_put_together()).map(|s| s.file.name()).collect();
    all.retain_mut(|(_, diagnostic)| {
        for label in &mut diagnostic.related {
            (label.file, label.span) = label.file.origin(label.span);
        }
        let joined = diagnostic.file.clone();
        if !joined.is_assembled() {
            return true;
        }
        let (file, span) = joined.origin(diagnostic.span);
        if file.name() != joined.name() && !put_together.contains(joined.name()) {
            return false;
        }
        let edit = |edit: &Edit| {
            let (own, span) = joined.copied(edit.span)?;
            (own.name() == file.name()).then(|| Edit::replace(span, edit.replacement.clone()))
        };
        diagnostic.fix = diagnostic.fix.take().and_then(|fix| {
            let edits = fix.edits.iter().map(edit).collect::<Option<Vec<Edit>>>()?;
            Some(Fix { edits, ..fix })
        });
        (diagnostic.file, diagnostic.span) = (file, span);
        true
    });
}

/// Brings what is told about texts that an engine may write to the templates.
pub fn to_templates(project: &Project, all: &mut [(Level, Diagnostic)]) {
    let templates: HashMap<&str, &SourceFile> =
        project.shaders().filter_map(|s| s.template.as_ref()).map(|file| (file.name(), file)).collect();
    if templates.is_empty() {
        return;
    }
    for (_, diagnostic) in all {
        for label in &mut diagnostic.related {
            if let Some(file) = templates.get(label.file.name()) {
                label.file = (*file).clone();
            }
        }
        if let Some(file) = templates.get(diagnostic.file.name()) {
            diagnostic.file = (*file).clone();
            // A repair of what the engine writes is none of what its author wrote.
            diagnostic.fix = None;
        }
    }
}
