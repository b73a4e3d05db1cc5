//! `#include`: texts that tools join before a compiler sees them. The joined text knows the file and line
//! of every part.

use std::sync::Arc;

use super::{Comment, lexer};
use base::text::{Assembly, SourceFile, Span};

/// What an `#include` asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The file that asks.
    pub from: SourceFile,
    /// What stands between the quotes or angle brackets.
    pub path: String,
    /// True for `"path"`, which is looked for beside the file that asks first; false for `<path>`.
    pub quoted: bool,
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
}

/// Depth of files that include each other.
const DEEPEST: usize = 64;

/// Puts the text of included files in the place of their directives. `find` gives the file that is asked
/// for; its name is how it is told from others. A file that is on the way in already is not put in again:
/// with a guard it would be empty there, and without one it would have no end. One with `#pragma once` is
/// put in once.
pub fn resolve(file: &SourceFile, find: &mut dyn FnMut(&Wanted) -> Option<SourceFile>) -> Included {
    if !file.text().contains("include") {
        return Included { file: file.clone(), missing: Vec::new() };
    }
    let mut work = Work { find, assembly: Assembly::new(), open: Vec::new(), once: Vec::new(), missing: Vec::new() };
    let any = work.add(file);
    let Work { assembly, missing, .. } = work;
    let file = if any { assembly.finish(file.name()) } else { file.clone() };
    Included { file, missing }
}

struct Work<'a> {
    find: &'a mut dyn FnMut(&Wanted) -> Option<SourceFile>,
    assembly: Assembly,
    /// Names of the files that are being put in.
    open: Vec<Arc<str>>,
    /// Names of files with `#pragma once`.
    once: Vec<Arc<str>>,
    missing: Vec<Wanted>,
}

impl Work<'_> {
    /// Adds a file; true when a directive was replaced.
    fn add(&mut self, file: &SourceFile) -> bool {
        let name: Arc<str> = file.name().into();
        if self.once.contains(&name) {
            return false;
        }
        self.open.push(name.clone());
        let mut at = 0;
        let mut any = false;
        for directive in directives(file) {
            let Directive::Include(wanted) = directive else {
                self.once.push(name.clone());
                continue;
            };
            let Some(found) = (self.find)(&wanted) else {
                self.missing.push(wanted);
                continue;
            };
            any = true;
            self.assembly.copy(file, Span::new(at, wanted.span.start));
            at = wanted.span.end;
            if self.open.len() < DEEPEST && !self.open.iter().any(|open| **open == *found.name()) {
                self.add(&found);
            }
        }
        self.assembly.copy(file, Span::new(at, file.text().len()));
        self.open.pop();
        any
    }
}

enum Directive {
    Include(Wanted),
    PragmaOnce,
}

/// The directives of a file that matter here.
fn directives(file: &SourceFile) -> Vec<Directive> {
    let comments = lexer::lex(file.text()).comments;
    let mut found = Vec::new();
    let mut start = 0;
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
        if let Some(path) = rest.strip_prefix("include") {
            let path = path.trim_start();
            let quoted = path.starts_with('"');
            let close = if quoted { '"' } else { '>' };
            let Some((inside, _)) = path.strip_prefix(['"', '<']).and_then(|p| p.split_once(close)) else { continue };
            let span = Span::new(span.start + indent, span.end);
            found.push(Directive::Include(Wanted { from: file.clone(), path: inside.to_owned(), quoted, span }));
        } else if rest.strip_prefix("pragma").is_some_and(|p| p.split_whitespace().next() == Some("once")) {
            found.push(Directive::PragmaOnce);
        }
    }
    found
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
    fn files_that_include_each_other_end() {
        let a = ("a", "#pragma once\n#include \"b\"\n#include \"b\"\nint a;\n");
        let all = joined(&[a, ("b", "#pragma once\n#include \"a\"\nint b;\n")]);
        assert_eq!(all.file.text().matches("int a;").count(), 1);
        assert_eq!(all.file.text().matches("int b;").count(), 1);
    }
}
