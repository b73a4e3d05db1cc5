//! Tests in GLSL, which has no attributes: comments that begin with `@test`, with statements behind it.
//!
//! ```glsl
//! // @test white
//! // expectNear(luminance(vec3(1.0)), 1.0);
//! float luminance(vec3 c) { … }
//! ```

use base::text::{Assembly, SourceFile, Span};
use syntax::{Comment, Shader, Stage};

use super::mark::{Marked, UnitTest, WANTED, entry, is_assertion};

/// What the tests call, and where they record.
const ASSERTIONS: &str = include_str!("assertions.glsl");

/// The word that a test begins with.
const TEST: &str = "@test";

pub(super) fn mark(file: &SourceFile, stage: Stage) -> Marked {
    let shader = Shader::parse(file, stage).shader;
    let mut marked = Marked { file: file.clone(), tests: Vec::new(), sites: Vec::new() };
    let (mut out, end) = (Assembly::new(), file.text().len());
    out.copy(file, Span::new(0, end));
    let first = out_of(file, shader.comments());
    for (number, (at, pieces)) in first.into_iter().enumerate() {
        if number == 0 {
            out.insert(&format!("\n{ASSERTIONS}"), file, end);
        }
        let (name, pieces) = named(file, at, pieces);
        let entry = entry(number);
        out.insert(
            &format!("\nsc_Record {entry}(int {WANTED}) {{\nsc_record.count = 0;\nsc_wanted = {WANTED};\n"),
            file,
            at.start,
        );
        for piece in pieces {
            copy(&mut out, file, piece, &mut marked.sites);
            out.insert("\n", file, piece.end);
        }
        out.insert("return sc_record;\n}\n", file, at.start);
        marked.tests.push(UnitTest { name, function: entry.clone(), entry, span: at, refused: None });
    }
    marked.file = out.finish(file.name());
    marked
}

/// The tests of a file: the place of the word, and what stands behind it line by line.
fn out_of(file: &SourceFile, comments: &[Comment]) -> Vec<(Span, Vec<Span>)> {
    let mut found: Vec<(Span, Vec<Span>)> = Vec::new();
    let mut last: Option<usize> = None;
    for comment in comments {
        let inside = match comment.block {
            true => Span::new(comment.span.start + 2, (comment.span.end - 2).max(comment.span.start + 2)),
            false => Span::new(comment.span.start + 2, comment.span.end),
        };
        let mut lines: Vec<Span> = lines(file, inside).map(|line| trimmed(file, line)).collect();
        lines.retain(|line| !line.is_empty());
        // A comment of one line goes on in the next.
        let goes_on = last.is_some_and(|end| {
            let between = &file.text()[end..comment.span.start];
            !comment.block && between.trim().is_empty() && between.matches('\n').count() == 1
        });
        let begins = lines.first().is_some_and(|line| is_test(file.slice(*line)));
        if begins {
            let first = lines[0];
            let at = Span::new(first.start, first.start + TEST.len());
            lines[0] = trimmed(file, Span::new(at.end, first.end));
            found.push((at, lines));
            last = (!comment.block).then_some(comment.span.end);
        } else if goes_on && let Some((_, pieces)) = found.last_mut() {
            pieces.extend(lines);
            last = Some(comment.span.end);
        } else {
            last = None;
        }
    }
    found
}

fn is_test(line: &str) -> bool {
    line.strip_prefix(TEST).is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
}

/// The lines of a place.
fn lines(file: &SourceFile, within: Span) -> impl Iterator<Item = Span> {
    file.slice(within).split_inclusive('\n').scan(within.start, |at, line| {
        let start = *at;
        *at += line.len();
        Some(Span::new(start, *at))
    })
}

/// Without blanks around it, and without the marks that lines of comments begin with.
fn trimmed(file: &SourceFile, line: Span) -> Span {
    let text = file.slice(line);
    let left = text.trim_start_matches(|c: char| c.is_whitespace() || matches!(c, '*' | '!' | '/'));
    let start = line.end - left.len();
    Span::new(start, start + left.trim_end().len())
}

/// The name of a test, which may stand behind the word, and its statements.
fn named(file: &SourceFile, at: Span, mut pieces: Vec<Span>) -> (String, Vec<Span>) {
    let first = pieces.first().map_or("", |piece| file.slice(*piece)).trim_end_matches(':');
    let is_name = !first.is_empty() && !first.contains(['(', ';', '{', '=']);
    let line = format!("line {}", file.position(at.start).line);
    if is_name {
        let name = first.to_owned();
        pieces.remove(0);
        return (name, pieces);
    }
    (line, pieces)
}

/// Copies statements, with the number of each assertion before it.
fn copy(out: &mut Assembly, file: &SourceFile, piece: Span, sites: &mut Vec<Span>) {
    let text = file.slice(piece);
    let mut at = 0;
    for (start, _) in text.match_indices("expect") {
        let before = text[..start].trim_end();
        let word = text[start..].split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
        let begins = before.is_empty() || before.ends_with([';', '{', '}']);
        if !begins || !is_assertion(word) {
            continue;
        }
        out.copy(file, Span::new(piece.start + at, piece.start + start));
        out.insert(&format!("sc_site = {}; ", sites.len() + 1), file, piece.start + start);
        let end = text[start..].find(';').map_or(text.len(), |end| start + end);
        sites.push(Span::new(piece.start + start, piece.start + end));
        at = start;
    }
    out.copy(file, Span::new(piece.start + at, piece.end));
}
