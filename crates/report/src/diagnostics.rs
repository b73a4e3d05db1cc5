//! Draws diagnostics with excerpts of the text, for people.

use annotate_snippets::{AnnotationKind, Group, Level, Patch, Renderer, Snippet};

use base::diagnostic::{Diagnostic, Fix, Label, Lang, Safety, Severity};
use base::text::{SourceFile, Span};
#[cfg(feature = "lint")]
use lint::with_name;

/// One diagnostic with an excerpt of the text, why it is wrong, and what to do. Ends with a line break.
pub fn text(diagnostic: &Diagnostic, lang: Lang, color: bool) -> String {
    let d = diagnostic;
    let level = match d.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Info => Level::INFO,
    };
    let here: Vec<&Label> = d.related.iter().filter(|l| l.file == d.file).collect();
    let first = here.iter().map(|l| l.span).fold(d.span, Span::to);
    let excerpt = Excerpt::of(&d.file, first);
    let primary = AnnotationKind::Primary.span(excerpt.range(d.span));
    let mut snippet = excerpt.snippet(&d.file).annotation(if d.label.is_empty() {
        primary
    } else {
        primary.label(d.label.in_lang(lang))
    });
    for label in here {
        let context = AnnotationKind::Context.span(excerpt.range(label.span));
        snippet = snippet.annotation(context.label(label.message.in_lang(lang)));
    }
    let mut group =
        Group::with_title(level.primary_title(d.message.in_lang(lang)).id(with_name(d.code.0))).element(snippet);
    for label in d.related.iter().filter(|l| l.file != d.file) {
        let excerpt = Excerpt::of(&label.file, label.span);
        let context = AnnotationKind::Context.span(excerpt.range(label.span)).label(label.message.in_lang(lang));
        group = group.element(excerpt.snippet(&label.file).annotation(context));
    }
    if let Some(why) = &d.why {
        group = group.element(Level::NOTE.message(why.in_lang(lang)));
    }
    if let Some(help) = &d.help {
        group = group.element(Level::HELP.message(help.in_lang(lang)));
    }
    let mut report = vec![group];
    if let Some(fix) = &d.fix {
        report.push(patch(&d.file, fix, lang));
    }
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let mut out = renderer.render(&report);
    out.push('\n');
    out
}

fn patch<'a>(file: &'a SourceFile, fix: &'a Fix, lang: Lang) -> Group<'a> {
    let title = fix.title.in_lang(lang);
    let option = match fix.safety {
        Safety::Safe => "--fix",
        Safety::Unsafe => "--fix --unsafe-fixes",
    };
    let title = match lang {
        Lang::En => format!("{title} (`{option}` does it)"),
        Lang::Ja => format!("{title}（`{option}` で直せます）"),
    };
    let whole = fix.edits.iter().map(|e| e.span).reduce(Span::to).unwrap_or_default();
    let excerpt = Excerpt::of(file, whole);
    let patches = fix.edits.iter().map(|e| Patch::new(excerpt.range(e.span), e.replacement.as_str()));
    // No path: it stands above already.
    let snippet = Snippet::source(excerpt.text).line_start(excerpt.line).patches(patches);
    Group::with_title(Level::HELP.secondary_title(title)).element(snippet)
}

/// The whole lines around a span. Only they are handed to the renderer, so that drawing takes no
/// longer for a long file.
struct Excerpt<'a> {
    text: &'a str,
    line: usize,
    start: usize,
}

impl<'a> Excerpt<'a> {
    fn of(file: &'a SourceFile, span: Span) -> Self {
        let text = file.text();
        let is_break = |c: char| c == '\n' || c == '\r';
        let (start, end) = (floor(text, span.start), floor(text, span.end));
        let from = text[..start].rfind(is_break).map_or(0, |i| i + 1);
        let to = text[end..].find(is_break).map_or(text.len(), |i| end + i);
        Self { text: &text[from..to], line: file.position(from).line, start: from }
    }

    /// A span of the file as a range of the excerpt, cut to what it holds.
    fn range(&self, span: Span) -> std::ops::Range<usize> {
        let inside = |offset: usize| floor(self.text, offset.saturating_sub(self.start));
        inside(span.start)..inside(span.end)
    }

    fn snippet<T: Clone>(&self, file: &'a SourceFile) -> Snippet<'a, T> {
        Snippet::source(self.text).line_start(self.line).path(file.name())
    }
}

/// The border of a character at or before `offset`.
fn floor(text: &str, offset: usize) -> usize {
    let mut offset = offset.min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    offset
}

/// The code of an error as it stands, where no catalogue of rules is at hand.
#[cfg(not(feature = "lint"))]
fn with_name(code: &str) -> String {
    code.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::diagnostic::Code;
    use base::text::Edit;

    fn sample() -> Diagnostic {
        let file = SourceFile::new("側/円柱.vert", "int a;\n/* 頂点   */ vec4 p = vec3(1.0);\nint z;\n");
        let at = file.text().find("vec3").unwrap();
        let span = Span::new(at, at + 4);
        let shader = SourceFile::new("b.frag", "one\ntwo three\n");
        Diagnostic::new(Code("T001"), Severity::Error, &file, span, "too few")
            .with_label("makes a `vec3`")
            .with_related(&shader, Span::new(8, 13), "declared here")
            .with_why("because")
            .with_help("do something")
            .with_fix("construct a `vec4`", Safety::Unsafe, vec![Edit::replace(span, "vec4")])
    }

    #[test]
    fn text_says_what_where_why_and_what_to_do() {
        let text = text(&sample(), Lang::En, false);
        for part in [
            "error[T001 constructor-too-many-args]: too few",
            "側/円柱.vert:2:21",
            "makes a `vec3`",
            "b.frag:2:5",
            "declared here",
            "note: because",
            "help: do something",
            "construct a `vec4` (`--fix --unsafe-fixes` does it)",
            "vec4 p = vec4(1.0)",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        assert!(!text.contains('\u{1b}'), "colour only when asked for");
        assert!(super::text(&sample(), Lang::En, true).contains('\u{1b}'));
    }

    #[test]
    fn the_underline_stands_below_its_text_after_wide_characters() {
        let text = text(&sample(), Lang::En, false);
        let lines: Vec<&str> = text.lines().collect();
        let source = lines.iter().position(|l| l.contains("頂点")).unwrap();
        let columns = |s: &str| s.chars().map(|c| if c > '\u{2e80}' { 2 } else { 1 }).sum::<usize>();
        let wanted = columns(&lines[source][..lines[source].find("vec3").unwrap()]);
        let underline = lines[source + 1];
        assert_eq!(columns(&underline[..underline.find('^').unwrap()]), wanted, "{text}");
        assert_eq!(underline.matches('^').count(), 4, "{text}");
    }

    #[test]
    fn odd_places_do_no_harm() {
        for (source, span) in
            [("", Span::new(0, 0)), ("ab", Span::new(2, 2)), ("頂", Span::new(1, 9)), ("a\r\nb", Span::new(0, 4))]
        {
            let file = SourceFile::new("a", source);
            let d =
                Diagnostic::new(Code("E001"), Severity::Warning, &file, span, "m").with_fix("f", Safety::Safe, vec![]);
            assert!(text(&d, Lang::En, false).contains("warning[E001]"), "{source:?}");
        }
    }
}
