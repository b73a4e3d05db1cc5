//! Functions that stand behind an `#ifdef` of a name which nothing defines, as their host may: the text is read once more with
//! that name, and what is there then and was not before is run as well.

use std::path::Path;

use super::super::compose::Given;
use super::super::includes::{self, IncludedText};
use super::errors_of;
use program::{ProgramError, Written};
use reading::conditions::{self, Defines};
use syntax::{Shader, Stage};

/// Puts what a text lacks into it, with these macros.
type Complete<'c> = dyn FnMut(IncludedText, &[(String, String)]) -> IncludedText + 'c;

/// The texts of a file, and those with names that its conditions ask for, as far as they compile and have functions that
/// `texts` have not. A text that compiles with such names alone, since its host always defines one of them, is read with
/// them.
pub(super) fn with_more(
    (path, stage): (&Path, Option<Stage>),
    given: &Given<'_>,
    mut texts: Vec<IncludedText>,
    complete: &mut Complete<'_>,
) -> Vec<IncludedText> {
    let mut sets: Vec<Defines> = Vec::new();
    for set in texts.iter().flat_map(|text| switches(text, given.defines)) {
        if !set.is_empty() && !sets.contains(&set) {
            sets.push(set);
        }
    }
    let mut found = Vec::new();
    let mut known: Vec<Vec<String>> = Vec::new();
    let mut broken: Vec<bool> = Vec::new();
    for switches in &sets {
        let all = [given.defines, &switches[..]].concat();
        let Ok(read) = includes::read_all(path, &Given { defines: &all, ..*given }, stage) else { continue };
        if known.is_empty() {
            known = texts.iter().map(|text| functions(text, given.defines)).collect();
            broken = texts.iter().map(|text| !compiles(text, given.defines)).collect();
        }
        for (k, text) in read.into_iter().enumerate().take(texts.len()) {
            if broken[k] {
                let text = complete(text, &all).switched(switches, &[]);
                let now = functions(&text, given.defines);
                // The name of an include guard leaves nothing that could be wrong.
                let whole = !now.is_empty() && known[k].iter().all(|name| now.contains(name));
                if whole && compiles(&text, given.defines) {
                    (texts[k], broken[k], known[k]) = (text, false, now);
                }
                continue;
            }
            let text = complete(text, &all).switched(switches, &known[k]);
            let now = functions(&text, given.defines).into_iter();
            let fresh: Vec<String> = now.filter(|name| !text.is_assumed(name)).collect();
            // A branch for another language needs declarations that the rest does without.
            if !fresh.is_empty() && text.made_up() <= texts[k].made_up() && compiles(&text, given.defines) {
                known[k].extend(fresh);
                found.push(text);
            }
        }
    }
    for (k, text) in texts.iter_mut().enumerate().filter(|(k, _)| broken.get(*k) == Some(&true)) {
        let names: Vec<_> = sets.iter().filter(|set| set.len() == 1).flatten().cloned().collect();
        let mut with = |switches: &[(String, String)]| {
            let all = [given.defines, switches].concat();
            let read = includes::read_all(path, &Given { defines: &all, ..*given }, stage).ok()?;
            Some(complete(read.into_iter().nth(k)?, &all).switched(switches, &[]))
        };
        let mut search = Search { names: &names, defines: given.defines, with: &mut with, left: MOST_READ };
        if let Some(whole) = search.whole(&[], first_error(text, given.defines).as_deref()) {
            *text = whole;
        }
    }
    texts.into_iter().chain(found).collect()
}

/// How often a text is read while names are looked for that belong together, and how many of these there are at most.
const MOST_READ: usize = 64;
const MOST_TOGETHER: usize = 3;

/// Reads the text with such names.
type With<'w> = dyn FnMut(&[(String, String)]) -> Option<IncludedText> + 'w;

/// Looks for names that together make a text compile: what takes away its first error is a step on the way.
struct Search<'s> {
    names: &'s [(String, String)],
    defines: &'s [(String, String)],
    with: &'s mut With<'s>,
    /// Texts that may still be read.
    left: usize,
}

impl Search<'_> {
    fn whole(&mut self, so_far: &[(String, String)], error: Option<&str>) -> Option<IncludedText> {
        let mut steps = Vec::new();
        for name in self.names.iter().filter(|name| !so_far.contains(name)) {
            self.left = self.left.checked_sub(1)?;
            let switches = [so_far, std::slice::from_ref(name)].concat();
            let Some(text) = (self.with)(&switches) else { continue };
            match first_error(&text, self.defines) {
                None if !functions(&text, self.defines).is_empty() => return Some(text),
                None => {}
                Some(other) if Some(&other[..]) != error => steps.push((switches, other)),
                Some(_) => {}
            }
        }
        let deeper = so_far.len() + 1 < MOST_TOGETHER;
        steps.into_iter().filter(|_| deeper).find_map(|(switches, error)| self.whole(&switches, Some(&error)))
    }
}

/// The first thing that is wrong with a text.
fn first_error(text: &IncludedText, defines: &[(String, String)]) -> Option<String> {
    let found = match Written::of(&text.file) {
        Written::Glsl => errors_of(text.parsed(defines).diagnostics),
        _ => match text.module() {
            Ok(_) => Vec::new(),
            Err(ProgramError::Source(found)) => found,
            Err(other) => return Some(other.to_string()),
        },
    };
    found.first().map(|first| first.message.to_string())
}

/// What a host may define beside what it is known to define: all names, and then each by itself.
fn switches(text: &IncludedText, defines: &[(String, String)]) -> Vec<Defines> {
    let is_open = |name: &String| defines.iter().all(|(own, _)| own != name);
    if Written::of(&text.file) == Written::Glsl {
        let mut sets = conditions::definitions(&text.parsed(defines).shader);
        sets.iter_mut().for_each(|set| set.retain(|(name, _)| is_open(name)));
        return sets;
    }
    // What a module is put together from holds no directives any more.
    let names = text.features();
    conditions::all_and_each(&names.into_iter().filter(is_open).collect())
}

/// Names of the functions that a text has.
fn functions(text: &IncludedText, defines: &[(String, String)]) -> Vec<String> {
    let is_glsl = Written::of(&text.file) == Written::Glsl;
    if !is_glsl && let Ok(module) = text.module() {
        return module.points().into_iter().chain(module.functions()).map(|one| one.name).collect();
    }
    let parsed = if is_glsl { text.parsed(defines) } else { Shader::parse_wgsl(&text.file) };
    let own = parsed.shader.functions().filter(|(_, info)| info.definition.is_some());
    own.map(|(_, info)| info.name.name.clone()).collect()
}

fn compiles(text: &IncludedText, defines: &[(String, String)]) -> bool {
    first_error(text, defines).is_none()
}
