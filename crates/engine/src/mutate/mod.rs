//! Mutation testing: small faults are put into a shader one at a time, and its suite is asked to
//! notice them. A suite that lets faults through is weak there: in its domain, its formula or its
//! relations.
//!
//! A mutant is a few edits on the author's text, made from the typed syntax tree, so that it can be
//! shown as a diff and goes the whole way that the shader itself goes. Operators make mutants; each
//! is one file of the folder `operators` and one line of its registry.

mod code;
mod error;
pub mod operators;
mod outcome;
mod run;
#[cfg(test)]
mod testing;

use std::collections::HashSet;

use base::text::{Edit, EditList, SourceFile, Span};
use syntax::Shader;

pub use code::Code;
pub use error::MutateError;
pub use operators::Operator;
pub use outcome::{Kill, Outcome, Score, SuiteResult, Tested};
pub(crate) use run::diff;
pub use run::{Request, run};

/// A fault as an operator proposes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Draft {
    /// Edits on the author's text, at least one.
    pub edits: Vec<Edit>,
    /// What they do, without a full stop: "`+` becomes `-`".
    pub what: String,
    /// Why the mutant means the same as the original, where that is known from its form alone.
    pub identity: Option<&'static str>,
}

impl Draft {
    /// A draft with one edit.
    pub fn new(edit: Edit, what: impl Into<String>) -> Self {
        Self { edits: vec![edit], what: what.into(), identity: None }
    }
}

/// A shader with one fault.
#[derive(Clone, Debug)]
pub struct Mutant {
    /// Name of the operator that made it.
    pub operator: &'static str,
    /// What was done, without a full stop.
    pub what: String,
    /// Where, in the author's text.
    pub span: Span,
    /// The shader with the fault, under the name of the original.
    pub shader: SourceFile,
    /// Why it means the same as the original, where that is known from its form alone.
    pub identity: Option<&'static str>,
}

/// All mutants of the code that `entry` reaches: `main`, or the function that a suite calls. They
/// come operator by operator, in the order of the text; no two have the same text, and none that of
/// the original.
pub fn mutants(shader: &Shader, entry: &str, operators: &[&'static Operator]) -> Vec<Mutant> {
    let code = Code::new(shader, entry);
    let file = shader.file();
    let mut seen = HashSet::from([file.text().to_owned()]);
    let mut mutants = Vec::new();
    for operator in operators {
        let mut drafts = Vec::new();
        (operator.make)(&code, &mut drafts);
        // Of what starts at one place the longest comes first.
        let place = |e: &Edit| (e.span.start, std::cmp::Reverse(e.span.end));
        drafts.sort_by_key(|d| d.edits.iter().map(place).min());
        for Draft { edits, what, identity } in drafts {
            let Some(span) = edits.iter().map(|e| e.span).reduce(Span::to) else { continue };
            // Operators edit parts of one expression that lie beside each other; nested ones would
            // be a defect of the operator, and its tests would find no mutant.
            let Ok(edited) = edits.into_iter().collect::<EditList>().apply(file.text()) else { continue };
            if seen.insert(edited.text.clone()) {
                let shader = SourceFile::new(file.name(), edited.text);
                mutants.push(Mutant { operator: operator.name, what, span, shader, identity });
            }
        }
    }
    mutants
}
