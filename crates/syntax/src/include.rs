//! `#include`: texts that tools join before a compiler sees them. The joined text knows the file and line
//! of every part.

use std::sync::Arc;

use super::Comment;
use super::errors;
use super::lexer::{CommentStyle, lex_with};
use base::diagnostic::{Diagnostic, Severity};
use base::text::{Assembly, SourceFile, Span};

/// What an `#include` asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The file that asks.
    pub from: SourceFile,
    /// What stands between the quotes or angle brackets.
    pub path: String,
    /// True for `"path"`, which is looked for beside the file that asks first; false for `<path>`. An `#import` is
    /// looked for there however it is written.
    pub quoted: bool,
    /// True for `#import`, which takes a file in once; false for `#include`.
    pub import: bool,
    /// The directive, without its line break.
    pub span: Span,
}

/// A text with its includes.
#[derive(Clone, Debug)]
pub struct Included {
    /// The joined text; the file itself when it includes nothing.
    pub file: SourceFile,
    /// What was asked for and is not there. Its directives stay in the text: whether they count is for the
    /// preprocessor to say.
    pub missing: Vec<Wanted>,
    /// Files that lead back to themselves.
    pub cycles: Vec<Cycle>,
}

/// Files that include each other in a circle.
#[derive(Clone, Debug)]
pub struct Cycle {
    /// The directive that asks for a file which is on the way in already. It is left out of the text.
    pub wanted: Wanted,
    /// Names of the files from that one to the one that asks.
    pub chain: Vec<Arc<str>>,
    /// One of them has a guard, which makes it empty the second time: there is an end.
    pub guarded: bool,
}

impl Cycle {
    /// The error, at the directive.
    pub fn error(&self) -> Diagnostic {
        let chain: Vec<&str> = self.chain.iter().map(|name| &**name).collect();
        let circle = format!("{} → {}", chain.join(" → "), chain.first().copied().unwrap_or_default());
        let (message, help) = match (chain.len(), self.wanted.import) {
            (0 | 1, _) => ("this file takes in itself".to_owned(), "remove this line"),
            (_, true) => (format!("these files take in each other: {circle}"), "move what both need into a third file"),
            (_, false) => (
                format!("these files take in each other: {circle}"),
                "begin each with `#pragma once` or `#ifndef`, or move what both need into a third file",
            ),
        };
        let Wanted { from, span, .. } = &self.wanted;
        Diagnostic::new(errors::IMPORT_CYCLE, Severity::Error, from, *span, message).with_help(help.to_owned())
    }
}

/// Depth of files that include each other.
const DEEPEST: usize = 64;

/// Puts the text of included files in the place of their directives. `find` gives the file that is asked
/// for; its name is how it is told from others. A file that is on the way in already is not put in again:
/// with a guard it would be empty there, and without one it would have no end. One with `#pragma once` is
/// put in once.
pub fn resolve(file: &SourceFile, find: &mut dyn FnMut(&Wanted) -> Option<SourceFile>) -> Included {
    joined(file, find, CommentStyle::C)
}

/// The same for a text that is not GLSL, where hosts have `#import <path>`, `#import "path"` and `#import name` for it
/// as well. An `#import` of anything within a module, such as `#import a::b`, stays. WGSL has no guards: a file that is
/// asked for under no condition is put in once, unless macros are taken back, with which it is read in several ways.
pub fn resolve_plain(file: &SourceFile, find: &mut dyn FnMut(&Wanted) -> Option<SourceFile>) -> Included {
    joined(file, find, CommentStyle::Wgsl)
}

fn joined(file: &SourceFile, find: &mut dyn FnMut(&Wanted) -> Option<SourceFile>, comments: CommentStyle) -> Included {
    let words = directive_words(comments);
    if !words.iter().any(|word| file.text().contains(word)) {
        return Included { file: file.clone(), missing: Vec::new(), cycles: Vec::new() };
    }
    let (open, once, guarded) = (Vec::new(), Vec::new(), Vec::new());
    let (missing, cycles) = (Vec::new(), Vec::new());
    let each_once = matches!(comments, CommentStyle::Wgsl) && !file.text().contains("#undef");
    let assembly = Assembly::new();
    let mut work = Work { find, comments, each_once, assembly, open, once, guarded, missing, cycles };
    let any = work.add(file, false);
    let Work { assembly, missing, cycles, .. } = work;
    let file = if any { assembly.finish(file.name()) } else { file.clone() };
    Included { file, missing, cycles }
}

/// What packs for Minecraft write in the place of `include`.
const MOJ_IMPORT: &str = "moj_import";

/// True for a text in GLSL that may take files in.
pub fn may_include(text: &str) -> bool {
    directive_words(CommentStyle::C).iter().any(|word| text.contains(word))
}

/// True for what stands behind the `#` of a directive that takes a file in.
pub fn takes_in(behind: &str) -> bool {
    let word = behind.trim_start();
    directive_words(CommentStyle::C).iter().any(|taking| word.starts_with(taking))
}

/// Words behind `#` that take a file in.
fn directive_words(comments: CommentStyle) -> &'static [&'static str] {
    match comments {
        CommentStyle::C => &["include", MOJ_IMPORT],
        CommentStyle::Wgsl => &["include", "import"],
    }
}

struct Work<'a> {
    find: &'a mut dyn FnMut(&Wanted) -> Option<SourceFile>,
    comments: CommentStyle,
    /// Whether a file is put in once that is asked for under no condition.
    each_once: bool,
    assembly: Assembly,
    /// Names of the files that are being put in.
    open: Vec<Arc<str>>,
    /// Names of files with `#pragma once`.
    once: Vec<Arc<str>>,
    /// Names of files that begin with a guard of the preprocessor.
    guarded: Vec<Arc<str>>,
    missing: Vec<Wanted>,
    cycles: Vec<Cycle>,
}

impl Work<'_> {
    /// Adds a file, `bare` of its version; true when a directive was replaced.
    fn add(&mut self, file: &SourceFile, bare: bool) -> bool {
        let name: Arc<str> = file.name().into();
        if self.once.contains(&name) {
            return false;
        }
        self.open.push(name.clone());
        if has_guard(file) {
            self.guarded.push(name.clone());
        }
        let mut at = 0;
        let mut any = false;
        for directive in directives(file, self.comments) {
            let (wanted, conditional, bare) = match directive {
                Directive::Include { wanted, conditional, bare } => (wanted, conditional, bare),
                Directive::PragmaOnce => {
                    self.once.push(name.clone());
                    continue;
                }
                Directive::Version(span) => {
                    if bare {
                        self.assembly.copy(file, Span::new(at, span.start));
                        at = span.end;
                    }
                    continue;
                }
            };
            let Some(found) = (self.find)(&wanted) else {
                self.missing.push(wanted);
                continue;
            };
            any = true;
            self.assembly.copy(file, Span::new(at, wanted.span.start));
            at = wanted.span.end;
            if let Some(back) = self.open.iter().position(|open| **open == *found.name()) {
                // A guard makes it empty there.
                if !self.once.contains(&self.open[back]) {
                    let chain = self.open[back..].to_vec();
                    let guarded = chain.iter().any(|name| self.guarded.contains(name));
                    self.cycles.push(Cycle { wanted, chain, guarded });
                }
            } else if self.open.len() < DEEPEST {
                let each_once = self.each_once;
                self.each_once &= !conditional;
                let once = (wanted.import || self.each_once).then(|| found.name().into());
                self.add(&found, bare);
                self.each_once = each_once;
                self.once.extend(once);
            }
        }
        self.assembly.copy(file, Span::new(at, file.text().len()));
        self.open.pop();
        any
    }
}

/// True for a file whose first directive keeps it from being taken in twice.
fn has_guard(file: &SourceFile) -> bool {
    let first = file.text().lines().map(str::trim_start).find_map(|line| line.strip_prefix('#'));
    let first = first.map_or("", str::trim_start);
    first.starts_with("ifndef") || first.starts_with("if !defined") || first.split_whitespace().eq(["pragma", "once"])
}

enum Directive {
    /// What is asked for, whether a condition stands around it, and whether it is put in without its version.
    Include {
        wanted: Wanted,
        conditional: bool,
        bare: bool,
    },
    PragmaOnce,
    Version(Span),
}

/// The directives of a file that matter here.
fn directives(file: &SourceFile, style: CommentStyle) -> Vec<Directive> {
    let comments = lex_with(file.text(), style).comments;
    let mut found = Vec::new();
    let (mut start, mut conditions) = (0, 0_usize);
    for line in file.text().split_inclusive(['\n', '\r']) {
        let span = Span::new(start, start + line.trim_end_matches(['\n', '\r']).len());
        start += line.len();
        let text = file.slice(span);
        let indent = text.len() - text.trim_start().len();
        let Some(rest) = text.trim_start().strip_prefix('#') else { continue };
        if in_comment(&comments, span.start + indent) {
            continue;
        }
        let rest = rest.trim_start();
        let word = directive_words(style).iter().find(|word| rest.starts_with(**word));
        if let Some(word) = word {
            let import = *word == "import";
            let asked = rest[word.len()..].trim_start();
            let Some((inside, quoted)) = path_of(asked, import) else { continue };
            // What the text calls by `name::f` is a module, and no text to be put in.
            if asked.starts_with(inside) && names_a_module(file.text(), inside) {
                continue;
            }
            let span = Span::new(span.start + indent, span.end);
            let (mut path, quoted) = (inside.to_owned(), quoted || import);
            // `<fog.glsl>` and `<minecraft:fog.glsl>` lie in the folder `include` beside those of programs.
            if *word == MOJ_IMPORT && !quoted {
                path = format!("include/{}", path.rsplit_once(':').map_or(&path[..], |(_, path)| path));
            }
            let wanted = Wanted { from: file.clone(), path, quoted, import, span };
            let (conditional, bare) = (conditions > 0, *word == MOJ_IMPORT);
            found.push(Directive::Include { wanted, conditional, bare });
        } else if rest.starts_with("version") {
            found.push(Directive::Version(span));
        } else if rest.starts_with("if") {
            conditions += 1;
        } else if rest.starts_with("endif") {
            conditions = conditions.saturating_sub(1);
        } else if rest.strip_prefix("pragma").is_some_and(|p| p.split_whitespace().next() == Some("once")) {
            found.push(Directive::PragmaOnce);
        }
    }
    found
}

/// The path behind a directive, and whether it stands in double quotes.
fn path_of(text: &str, import: bool) -> Option<(&str, bool)> {
    let (inside, rest, quoted) = match text.chars().next()? {
        '"' => text[1..].split_once('"').map(|(path, rest)| (path, rest, true))?,
        '<' => text[1..].split_once('>').map(|(path, rest)| (path, rest, false))?,
        _ if import => {
            let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
            (&text[..end], &text[end..], false)
        }
        // Some hosts read a path without quotes; a name alone may be a macro.
        _ => {
            let (path, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
            let plain = path.chars().all(|c| c.is_alphanumeric() || "_-./".contains(c));
            if !plain || !path.contains('.') {
                return None;
            }
            (path, rest, true)
        }
    };
    // Something of what the file has, or a name for it, makes it a module.
    let rest = rest.trim_start();
    let module = import && !(rest.is_empty() || rest.starts_with("//") || rest.starts_with("/*"));
    (!module && !inside.is_empty()).then_some((inside, quoted))
}

/// True where a text has `name::` as a word of its own.
fn names_a_module(text: &str, name: &str) -> bool {
    let part = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    text.match_indices(name).any(|(at, _)| text[at + name.len()..].starts_with("::") && !text[..at].ends_with(part))
}

fn in_comment(comments: &[Comment], offset: usize) -> bool {
    comments.iter().any(|c| c.span.contains(offset))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joined(files: &[(&str, &str)]) -> Included {
        let file = |&(name, text): &(&str, &str)| SourceFile::new(name, text);
        resolve(&file(&files[0]), &mut |wanted| files.iter().find(|f| f.0 == wanted.path).map(file))
    }

    #[test]
    fn files_stand_where_they_are_asked_for_and_keep_their_lines() {
        let root = ("a.glsl", "#version 330\n  #include \"b.glsl\"\nfloat f() { return g(); }\n");
        let all = joined(&[
            root,
            ("b.glsl", "// b\n# include <c.glsl>\nfloat g() { return C; }\n"),
            ("c.glsl", "#define C 1.0\n"),
        ]);
        let text = all.file.text();
        assert_eq!(
            text,
            "#version 330\n  // b\n#define C 1.0\n\nfloat g() { return C; }\n\nfloat f() { return g(); }\n"
        );
        assert_eq!(all.file.locate(text.find("float g").unwrap()), "b.glsl:3:1");
        assert_eq!(all.file.locate(text.find("float f").unwrap()), "a.glsl:3:1");
        assert!(all.missing.is_empty());
    }

    #[test]
    fn comments_are_no_directives_and_missing_files_are_reported() {
        let all = joined(&[("a.glsl", "/*\n#include \"b\"\n*/\n// #include \"b\"\n#include \"gone\"\n")]);
        assert_eq!(all.missing.iter().map(|w| w.path.as_str()).collect::<Vec<_>>(), ["gone"]);
        assert!(all.file.text().contains("#include \"gone\""));
    }

    #[test]
    fn imports_take_a_file_in_once_and_leave_modules_alone() {
        let files = [
            ("a", "#import <b>\n#import b\n#import \"b\" // again\n#import \"b\"::f\n#import b::f\nA;\n"),
            ("b", "#import c\nB;\n"),
        ];
        let file = |name: &str| files.iter().find(|f| f.0 == name).map(|f| SourceFile::new(f.0, f.1));
        let all = resolve_plain(&file("a").unwrap(), &mut |wanted| file(&wanted.path));
        assert_eq!(all.file.text().matches("B;").count(), 1);
        assert!(all.file.text().contains("#import \"b\"::f\n#import b::f\nA;"));
        assert_eq!(all.missing.iter().map(|w| w.path.as_str()).collect::<Vec<_>>(), ["c"]);
        assert!(all.cycles.is_empty());
    }

    #[test]
    fn a_circle_is_reported_with_its_files() {
        let circle = |first: &str| {
            let all = joined(&[("a", &format!("{first}#include \"b\"\n")), ("b", "#include \"a\"\n")]);
            all.cycles.iter().map(|c| (c.wanted.from.name().to_owned(), c.chain.join(" "))).collect::<Vec<_>>()
        };
        assert_eq!(circle(""), [("b".to_owned(), "a b".to_owned())]);
        assert_eq!(circle("#pragma once\n"), []);
    }

    #[test]
    fn files_that_include_each_other_end() {
        let a = ("a", "#pragma once\n#include \"b\"\n#include \"b\"\nint a;\n");
        let all = joined(&[a, ("b", "#pragma once\n#include \"a\"\nint b;\n")]);
        assert_eq!(all.file.text().matches("int a;").count(), 1);
        assert_eq!(all.file.text().matches("int b;").count(), 1);
    }
}
