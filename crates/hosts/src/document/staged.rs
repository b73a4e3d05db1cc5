//! Files with the stages of a program in GLSL behind `#pragma stage`, as RetroArch and other emulators have them under the
//! ending `.slang`, which they share with the language Slang. What stands in front of the first belongs to each stage.

use base::text::{SourceFile, Span};
use syntax::Stage;

use super::{Document, Listing};
use crate::paths::extension;
use crate::piece::Place;
use crate::{Literal, marks};

/// The stages of such a file; none for one in another language.
pub(super) fn read(file: &SourceFile) -> Option<Document> {
    let text = file.text();
    if !extension(file.name()).eq_ignore_ascii_case("slang") || !text.contains("#version") {
        return None;
    }
    let mut starts: Vec<(usize, usize, Stage)> = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        if let Some(stage) = stage(line) {
            starts.push((at, at + line.len(), stage));
        }
        at += line.len();
    }
    let front = Span::new(0, starts.first()?.0);
    let stated = marks::without_comments(file.slice(front));
    stated.trim_start().starts_with("#version").then_some(())?;
    let ends: Vec<usize> = starts.iter().skip(1).map(|next| next.0).chain([text.len()]).collect();
    let listing = |(order, (&(_, start, stage), end)): (usize, (&(usize, usize, Stage), usize))| {
        let mut literal = Literal::default();
        literal.verbatim_raw(file, front);
        literal.verbatim_raw(file, Span::new(start, end));
        let place = Place { document: file.name().to_owned(), order, section: Vec::new() };
        let name = format!("{} ({})", file.name(), stage.name());
        Listing { name, called: None, literal, stage, partial: false, whole: false, place }
    };
    let shaders = starts.iter().zip(ends).enumerate().map(listing).collect();
    Some(Document { shaders, ..Document::default() })
}

/// The stage that a line begins.
fn stage(line: &str) -> Option<Stage> {
    let mut words = line.trim_start().strip_prefix('#')?.split_whitespace();
    (words.next()? == "pragma" && words.next()? == "stage").then_some(())?;
    Stage::of_word(words.next()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "#version 450\n#define HALF 0.5\n#pragma stage vertex\nvoid main() { gl_Position = vec4(HALF); }\n\
                        #pragma stage fragment\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(HALF); }\n";

    #[test]
    fn stages_have_what_stands_in_front_and_lead_back() {
        let file = SourceFile::new("a.slang", TEXT);
        let document = read(&file).unwrap();
        let stages: Vec<Stage> = document.shaders.iter().map(|s| s.stage).collect();
        assert_eq!(stages, [Stage::Vertex, Stage::Fragment]);
        let fragment = &document.shaders[1].literal;
        assert!(fragment.text.starts_with("#version 450\n#define HALF") && !fragment.text.contains("gl_Position"));
        let at = fragment.text.find("out vec4").unwrap();
        assert_eq!(fragment.to_host(Span::at(at)).start, TEXT.find("out vec4").unwrap());
    }

    #[test]
    fn the_language_slang_is_another() {
        for text in [
            "[shader(\"compute\")]\nvoid main() {}\n",
            "struct A {};\n#pragma stage vertex\n",
            &TEXT.replace("#pragma stage", "#pragma other"),
        ] {
            assert!(read(&SourceFile::new("a.slang", text)).is_none(), "{text}");
        }
        assert!(read(&SourceFile::new("a.glsl", TEXT)).is_none());
    }
}
