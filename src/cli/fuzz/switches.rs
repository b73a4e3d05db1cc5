//! Functions that stand behind an `#ifdef` of a name which nothing defines, as their host may: the text is read once more with
//! that name, and what is there then and was not before is run as well.

use std::path::Path;

use super::super::compose::Given;
use super::super::hosts::Hosts;
use super::super::includes::{self, IncludedText};
use base::diagnostic::{Diagnostic, Severity};
use program::Written;
use reading::prelude::Wanted;
use syntax::{Shader, Stage, errors};

/// Names that are tried at most: all together first, and each alone where that leaves something out.
const MOST: usize = 12;

/// The texts of a file with names that its conditions ask for, as far as they compile and have functions that `texts` have not.
pub(super) fn more(
    (path, stage): (&Path, Option<Stage>),
    given: &Given<'_>,
    prelude: &dyn Fn() -> Wanted,
    texts: &[IncludedText],
) -> Vec<IncludedText> {
    let mut names: Vec<String> = Vec::new();
    // What a module in WGSL is put together from holds no directives any more.
    let own = |text: &IncludedText| text.author().map(|file| asked(file.text())).unwrap_or_default();
    for name in texts.iter().flat_map(|text| [asked(text.file.text()), own(text)].concat()) {
        if names.len() < MOST && !names.contains(&name) && given.defines.iter().all(|(own, _)| *own != name) {
            names.push(name);
        }
    }
    if names.is_empty() {
        return Vec::new();
    }
    // A branch for another language needs declarations that the rest does without.
    let plain = includes::read_all(path, given, stage).unwrap_or_default().into_iter();
    let lacks: Vec<usize> = plain.map(|text| text.assuming(given.defines, &mut Hosts::default()).made_up()).collect();
    let mut known: Vec<Vec<String>> = texts.iter().map(|text| functions(text, given.defines)).collect();
    let mut found = Vec::new();
    let alone = names.iter().map(std::slice::from_ref).filter(|_| names.len() > 1);
    for names in std::iter::once(&names[..]).chain(alone) {
        let switches: Vec<(String, String)> = names.iter().map(|name| (name.clone(), "1".to_owned())).collect();
        let all = [given.defines, &switches[..]].concat();
        let with = Given { defines: &all, ..*given };
        let Ok(read) = includes::read_all(path, &with, stage) else { continue };
        for ((text, known), lacks) in read.into_iter().zip(&mut known).zip(&lacks) {
            let text = text.with_prelude(prelude()).assuming(&all, &mut Hosts::default()).switched(&switches, known);
            let now = functions(&text, given.defines).into_iter();
            let fresh: Vec<String> = now.filter(|name| !text.is_assumed(name)).collect();
            if !fresh.is_empty() && text.made_up() <= *lacks && compiles(&text, given.defines) {
                known.extend(fresh);
                found.push(text);
            }
        }
    }
    found
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
    let wrong =
        |d: &Diagnostic| d.severity == Severity::Error && (d.code != errors::MISSING_MAIN || !d.span.is_empty());
    match Written::of(&text.file) {
        Written::Glsl => !text.parsed(defines).diagnostics.iter().any(wrong),
        _ => text.module().is_ok(),
    }
}

/// Names that a text asks to be defined, and does not define: none of the language or of a compiler.
fn asked(text: &str) -> Vec<String> {
    let directives = || text.lines().filter_map(|line| line.trim_start().strip_prefix('#')).map(str::trim_start);
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let word = |text: &str| text.chars().take_while(|c| is_part(*c)).collect::<String>();
    let defined: Vec<String> =
        directives().filter_map(|line| line.strip_prefix("define")).map(|rest| word(rest.trim_start())).collect();
    let mut names = Vec::new();
    for line in directives().filter(|line| !line.starts_with("define")) {
        let line = line.strip_prefix("else").map_or(line, str::trim_start);
        let plain = line.strip_prefix("ifdef").map(|rest| word(rest.trim_start()));
        let inside = line.split("defined").skip(1).map(|rest| word(rest.trim_start_matches([' ', '\t', '('])));
        names.extend(plain.into_iter().chain(inside));
    }
    let of_compiler = |name: &String| name.is_empty() || name.starts_with("GL_") || name.contains("__");
    names.retain(|name| !of_compiler(name) && !defined.contains(name));
    names
}

#[cfg(test)]
mod tests {
    use super::asked;

    #[test]
    fn names_that_a_text_asks_for_and_does_not_define() {
        let text = "#ifdef A\n#elif defined(B) && !defined C\n#endif\n#ifndef D\n#define D\n#endif\n#ifdef D\n#endif\n\
                    #ifdef GL_ES\n#else ifdef E\n  # if defined( F )\n#ifdef __cplusplus\n// ifdef G\n";
        assert_eq!(asked(text), ["A", "B", "C", "E", "F"]);
    }
}
