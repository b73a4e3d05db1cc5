//! What a text in GLSL lacks, and what stands for it: macros of a build, and declarations of a text that a host puts beside
//! this one.
//!
//! ```text
//! text ─┬─ structures, by the members that are asked for ─┐
//!       ├─ macros, by host code or something plain ───────┼─▶ Completed ─ put ─▶ a text that compiles
//!       └─ variables and functions, by their uses ────────┘
//! ```
//!
//! What a variable holds and a function gives is any value of its type: an input. A type is right when the text has no error
//! with it, and of several, the plainest is taken. Where that brings errors, or leaves names, nothing is completed but a piece
//! of which some functions are right so.

mod access;
mod declared;
mod macros;
pub mod references;
mod search;
#[cfg(test)]
mod tests;
pub mod wgsl;

use std::collections::HashSet;

use base::diagnostic::{self, Code};
use base::text::SourceFile;
use program::{WIDE_BYTES, WORKGROUP_SIZE};
use syntax::Parsed;
use syntax::interface::Storage;

use crate::fuzz::{FunctionReport, FuzzFindingKind, Law};
pub use declared::{Stand, declared_notes};
pub use macros::{Assumed, Offer, Offers, assumption_note, macro_name, taken_notes};
use search::Search;

/// Another file of the project that is no shader by itself.
#[derive(Clone, Debug)]
pub struct Sibling {
    /// The file.
    pub file: SourceFile,
    /// The functions that it defines.
    pub functions: Vec<String>,
}

/// Other files of the project that define functions of these names, the nearest first.
pub type Siblings<'s> = dyn FnMut(&[String]) -> Vec<Sibling> + 's;

/// Reads a text with what stands for names that it lacks.
pub type Parse<'p> = dyn Fn(&Completed) -> Parsed + 'p;

/// What stands for names that nothing in a text defines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Completed {
    /// Macros that are assumed.
    pub assumed: Assumed,
    /// Macros that host code defines.
    pub taken: Vec<Offer>,
    /// Declarations that are assumed.
    pub declared: Vec<Stand>,
    /// The text has errors with them that it may not have with those that are meant.
    pub is_partial: bool,
}

impl Completed {
    /// All macros.
    pub fn macros(&self) -> Assumed {
        let taken = self.taken.iter().map(|offer| (offer.name.clone(), offer.value.clone()));
        taken.chain(self.assumed.iter().cloned()).collect()
    }

    /// True for a function that is assumed: nobody wrote it.
    pub fn is_assumed(&self, function: &str) -> bool {
        self.declared.iter().any(|stand| stand.brings(function))
    }

    /// True where a module lacks names of constants: lengths of arrays may follow from them.
    pub fn is_sized(&self) -> bool {
        self.declared.iter().any(Stand::is_constant)
    }

    /// True for an input, or a part of one, that stands for a name which the text lacks.
    pub fn makes_up(&self, input: &str) -> bool {
        let name = input.split(['.', '[']).next().unwrap_or("");
        self.declared.iter().any(|stand| stand.holds(name))
    }

    /// Takes findings of a function that has assumed inputs for warnings: what a host gives them is not known. What a lane is
    /// blamed for stays.
    pub fn soften(&self, function: &mut FunctionReport) {
        let is_assumed = |(input, _): &(String, Vec<Law>)| self.makes_up(input.rsplit(' ').next().unwrap_or(input));
        // What a dispatch gets is told of no input: any name that stands there may have a say.
        let means = self.assumed.iter().any(|(name, _)| name.contains('('));
        let of_dispatch = function.dispatches > 0 && (means || !self.declared.is_empty());
        if of_dispatch || function.inputs.iter().any(is_assumed) {
            function.as_warnings();
            // A function of the host gives the same at each call here, and leaves no loop that waits for another answer.
            if self.declared.iter().any(Stand::is_function) {
                function.as_notes(FuzzFindingKind::Endless);
            }
        }
    }

    /// The text with all declarations, each in front of the item that uses it first.
    #[must_use]
    pub fn put(&self, file: &SourceFile) -> SourceFile {
        declared::put(&self.declared, file)
    }

    fn is_empty(&self) -> bool {
        self.assumed.is_empty() && self.taken.is_empty() && self.declared.is_empty()
    }
}

/// What stands for the names that a text lacks, which `parse` reads with them: what host code and other files of the project
/// define, or else something plain, or an input; whether numbers of 8 bits in buffers take the place of those of 32; and the
/// size of workgroups that is left to the host. None where nothing is lacking, or the text has errors whatever is tried.
pub fn completed(parse: &Parse<'_>, offers: &mut Offers<'_>, siblings: &mut Siblings<'_>) -> Option<Completed> {
    let mut all = names(parse, offers, siblings).unwrap_or_default();
    let parsed = parse(&all);
    if errors(&parsed) == 0 && has_bytes_in_buffers(&parsed) {
        all.assumed.push((WIDE_BYTES.to_owned(), "1".to_owned()));
    }
    let chosen = parsed.shader.defines().iter().any(|(name, _)| name == WORKGROUP_SIZE);
    if let Some([x, y, z]) = parsed.shader.usual_workgroup_size().filter(|_| errors(&parsed) == 0 && !chosen) {
        all.assumed.push((WORKGROUP_SIZE.to_owned(), format!("{x},{y},{z}")));
    }
    (!all.is_empty()).then_some(all)
}

/// What stands for names that a text lacks, so that it has no errors. Macros are enough for most kernels.
fn names(parse: &Parse<'_>, offers: &mut Offers<'_>, siblings: &mut Siblings<'_>) -> Option<Completed> {
    let plain = parse(&Completed::default());
    // A version that stands elsewhere, or another language, is more than a name.
    let is_whole = plain.shader.lacking().is_empty() && search::includes(&plain).is_empty();
    if is_whole || plain.shader.wgsl().is_some() {
        return None;
    }
    // What is wrong whatever names stand for stays wrong: it is told, and the rest is run.
    let before: HashSet<(Code, String, String)> = wrong(&plain).collect();
    let done = |found: &Completed| {
        let parsed = parse(found);
        let lacks_nothing = parsed.shader.lacking().is_empty() && search::includes(&parsed).is_empty();
        lacks_nothing && wrong(&parsed).all(|error| before.contains(&error))
    };
    if let Some(found) = macros::names(&|macros| parse(&with_macros(macros, &[])), offers).filter(done) {
        return Some(found);
    }
    // A name of host code need not be the one that is meant, nor need a function of another file.
    let mut best: Option<(usize, Completed)> = None;
    let mut search = |offers: &mut Offers<'_>, siblings: &mut Siblings<'_>| {
        let found = Search::new(parse, &plain).run(&plain, offers, siblings);
        if done(&found) {
            return Some(found);
        }
        let left = errors(&parse(&found));
        if best.as_ref().is_none_or(|(most, _)| left < *most) {
            best = Some((left, found));
        }
        None
    };
    search(offers, siblings)
        .or_else(|| search(&mut |_| Vec::new(), siblings))
        .or_else(|| search(&mut |_| Vec::new(), &mut |_| Vec::new()))
        .or_else(|| {
            // Of a piece, the functions run that are right so.
            let is_piece = plain.shader.function("main").is_none();
            best.filter(|(left, _)| is_piece && *left < errors(&plain))
                .map(|(_, found)| Completed { is_partial: true, ..found })
        })
}

fn with_macros(macros: &[(String, String)], declared: &[Stand]) -> Completed {
    Completed { assumed: macros.to_vec(), declared: declared.to_vec(), ..Completed::default() }
}

/// The errors of a text: code, message and place in its file.
fn wrong(parsed: &Parsed) -> impl Iterator<Item = (Code, String, String)> + '_ {
    let errors = parsed.diagnostics.iter().filter(|d| d.severity == diagnostic::Severity::Error);
    errors.map(|d| (d.code, d.message.to_string(), d.file.locate(d.span.start)))
}

/// Errors of a text, and names that it lacks.
fn errors(parsed: &Parsed) -> usize {
    let errors = parsed.diagnostics.iter().filter(|d| d.severity == diagnostic::Severity::Error).count();
    errors + parsed.shader.lacking().len()
}

/// True when numbers of 8 bits lie in buffers.
fn has_bytes_in_buffers(parsed: &Parsed) -> bool {
    let blocks = &parsed.shader.interface().blocks;
    blocks.iter().filter(|block| matches!(block.storage, Storage::Buffer | Storage::Uniform)).any(|block| {
        // A structure that is only declared is in no buffer.
        block.ty.has_scalar(&|scalar| scalar.is_integer() && scalar.bits() == 8)
    })
}
