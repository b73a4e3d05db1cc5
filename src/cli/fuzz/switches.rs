//! Functions that stand behind an `#ifdef` of a name which nothing defines, as their host may: the text is read once more with
//! that name, and what is there then and was not before is run as well.

use std::path::Path;

use super::super::compose::Given;
use super::super::includes::{self, IncludedText};
use super::errors_of;
use program::Written;
use reading::conditions::{self, Defines};
use syntax::{Shader, Stage, errors};

/// Puts what a text lacks into it, with these macros.
type Complete<'c> = dyn FnMut(IncludedText, &[(String, String)]) -> IncludedText + 'c;

/// The texts of a file, and those with names that its conditions ask for, as far as they compile and have functions that
/// `texts` have not. What compiles with such a name alone, since it is a text of the host without it, is read with it.
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
    let mut of_host: Vec<bool> = Vec::new();
    for switches in sets {
        let all = [given.defines, &switches[..]].concat();
        let Ok(read) = includes::read_all(path, &Given { defines: &all, ..*given }, stage) else { continue };
        if known.is_empty() {
            known = texts.iter().map(|text| functions(text, given.defines)).collect();
            of_host = texts.iter().map(|text| is_of_host(text, given.defines)).collect();
        }
        for (k, text) in read.into_iter().enumerate().take(texts.len()) {
            if of_host[k] {
                let text = complete(text, &all).switched(&switches, &[]);
                if compiles(&text, given.defines) {
                    known[k] = functions(&text, given.defines);
                    (texts[k], of_host[k]) = (text, false);
                }
                continue;
            }
            let text = complete(text, &all).switched(&switches, &known[k]);
            let now = functions(&text, given.defines).into_iter();
            let fresh: Vec<String> = now.filter(|name| !text.is_assumed(name)).collect();
            // A branch for another language needs declarations that the rest does without.
            if !fresh.is_empty() && text.made_up() <= texts[k].made_up() && compiles(&text, given.defines) {
                known[k].extend(fresh);
                found.push(text);
            }
        }
    }
    texts.into_iter().chain(found).collect()
}

/// True for a text that is not one of GLSL as its conditions stand: words that the language keeps for itself, such as
/// `typedef`, begin what its grammar does not have.
fn is_of_host(text: &IncludedText, defines: &[(String, String)]) -> bool {
    let found = if Written::of(&text.file) == Written::Glsl { text.parsed(defines).diagnostics } else { Vec::new() };
    let has = |code| found.iter().any(|error| error.code == code);
    has(errors::RESERVED) && has(errors::SYNTAX)
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
    let names = text.author().map(|file| compose::features(&file)).unwrap_or_default();
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
    match Written::of(&text.file) {
        Written::Glsl => errors_of(text.parsed(defines).diagnostics).is_empty(),
        _ => text.module().is_ok(),
    }
}
