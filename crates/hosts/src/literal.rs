//! String literals of C and C++ as the text that they stand for, with the way back to their place.

use tree_sitter::Node;

use base::text::{Assembly, Edit, SourceFile, Span};

use crate::cpp::tree::{elements, span};

/// The text of string literals, with where each byte came from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Literal {
    /// The text, escapes resolved.
    pub text: String,
    pieces: Vec<Piece>,
}

/// Bytes of the text and the bytes of the host file that they come from, in the order of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Piece {
    text: Span,
    host: Span,
    kind: PieceKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PieceKind {
    /// The same bytes, between quotation marks.
    Quoted,
    /// The same bytes in a raw literal, line breaks and quotation marks too.
    Raw,
    /// The same bytes of a shader file.
    File,
    /// The same bytes, in one of several lines that stand behind a margin.
    Line,
    /// The same bytes in a document where some characters are written as references.
    Markup,
    /// The same bytes in the argument of a macro that makes a string of it.
    Argument,
    /// Other bytes: an escape, or text that a macro adds.
    Made,
}

impl Literal {
    /// Reads a string literal, a raw one, or several that stand side by side. None when an escape is
    /// not a plain one, or something else than literals stands between them.
    pub fn of(node: Node<'_>, file: &SourceFile) -> Option<Self> {
        let mut literal = Self::default();
        literal.add(node, file)?;
        Some(literal)
    }

    /// Adds the text of a further literal.
    pub fn add(&mut self, node: Node<'_>, file: &SourceFile) -> Option<()> {
        if node.has_error() {
            return None;
        }
        let place = span(node);
        match node.kind() {
            "string_literal" => self.quoted(file, place),
            "raw_string_literal" => self.raw(file, place),
            "concatenated_string" => elements(node).into_iter().try_for_each(|part| self.add(part, file)),
            _ => None,
        }
    }

    /// Reads literals that a host joins with texts of its own, as in `VERSION "…"` and `header + "…"`, and gives whether there
    /// are such texts. They stand between lines; none where one is a part of a line, as a number is.
    pub fn joined(nodes: &[Node<'_>], file: &SourceFile) -> Option<(Self, bool)> {
        let (mut literal, mut others) = (Self::default(), false);
        let mut parts = Vec::new();
        for &node in nodes {
            match node.kind() {
                "concatenated_string" => parts.extend(elements(node)),
                _ => parts.push(node),
            }
        }
        for (k, &part) in parts.iter().enumerate() {
            if is_literal(part) {
                literal.add(part, file)?;
                continue;
            }
            others = true;
            let begins = k == 0 || !is_literal(parts[k - 1]) || literal.text.ends_with('\n');
            let mut behind = Self::default();
            if let Some(&next) = parts.get(k + 1).filter(|next| is_literal(**next)) {
                behind.add(next, file)?;
            }
            if !begins && !behind.text.is_empty() && !behind.text.starts_with('\n') {
                return None;
            }
        }
        Some((literal, others))
    }

    fn quoted(&mut self, file: &SourceFile, place: Span) -> Option<()> {
        let text = file.slice(place);
        let prefix = if text.starts_with("u8\"") { 3 } else { 1 };
        text.get(..prefix).filter(|p| p.ends_with('"'))?;
        self.escaped(file, Span::new(place.start + prefix, place.end.checked_sub(1)?))
    }

    /// Adds what stands between quotation marks, escapes resolved. None for an escape that is not a plain one.
    pub fn escaped(&mut self, file: &SourceFile, Span { start, end }: Span) -> Option<()> {
        let mut at = start;
        while at < end {
            let rest = file.slice(Span::new(at, end));
            let plain = rest.find('\\').unwrap_or(rest.len());
            self.verbatim(file, Span::new(at, at + plain), PieceKind::Quoted);
            at += plain;
            if at >= end {
                break;
            }
            let rest = &rest[plain..];
            let (made, length) = match rest.as_bytes().get(1)? {
                b'n' => ("\n", 2),
                b't' => ("\t", 2),
                b'r' => ("\r", 2),
                b'"' => ("\"", 2),
                b'\'' => ("'", 2),
                b'`' => ("`", 2),
                b'\\' => ("\\", 2),
                // A line that goes on in the next one.
                b'\n' => ("", 2),
                b'\r' if rest.as_bytes().get(2) == Some(&b'\n') => ("", 3),
                _ => return None,
            };
            self.made(made, Span::new(at, at + length));
            at += length;
        }
        Some(())
    }

    fn raw(&mut self, file: &SourceFile, place: Span) -> Option<()> {
        let text = file.slice(place);
        let open = text.find('(')?;
        let delimiter = text.get(..open)?.split_once('"')?.1.len();
        // `)`, the delimiter and the quotation mark.
        let end = place.end.checked_sub(delimiter + 2)?;
        self.verbatim(file, Span::new(place.start + open + 1, end), PieceKind::Raw);
        Some(())
    }

    /// A part of a file that holds several shaders.
    pub fn part(file: &SourceFile, place: Span) -> Self {
        let mut literal = Self::default();
        literal.verbatim(file, place, PieceKind::File);
        literal
    }

    /// Lines of a document, each without its margin.
    pub fn lines(file: &SourceFile, lines: &[Span]) -> Self {
        let mut joined: Vec<Span> = Vec::new();
        for &line in lines {
            match joined.last_mut().filter(|last| last.end == line.start) {
                Some(last) => last.end = line.end,
                None => joined.push(line),
            }
        }
        let kind = if joined.len() == 1 { PieceKind::File } else { PieceKind::Line };
        let mut literal = Self::default();
        joined.into_iter().for_each(|line| literal.verbatim(file, line, kind));
        literal
    }

    /// Adds text of a document without its references to characters.
    pub fn markup(&mut self, file: &SourceFile, place: Span) {
        self.verbatim(file, place, PieceKind::Markup);
    }

    /// Adds the text of a further block.
    pub fn append(&mut self, other: &Self) {
        let by = self.text.len();
        self.text.push_str(&other.text);
        let moved = |p: &Piece| Piece { text: Span::new(p.text.start + by, p.text.end + by), ..*p };
        self.pieces.extend(other.pieces.iter().map(moved));
    }

    /// The text between two others that stand nowhere.
    pub fn within(&self, before: &str, behind: &str) -> Self {
        let place = self.place().unwrap_or_default();
        let mut literal = Self::default();
        literal.made(before, Span::at(place.start));
        literal.append(self);
        literal.made(behind, Span::at(place.end));
        literal
    }

    /// The text with `front` put in at an offset, and `behind` at its end; both stand nowhere.
    pub fn with_text_at(&self, at: usize, front: &str, behind: &str) -> Self {
        let mut literal = Self::default();
        let mut put = false;
        for piece in &self.pieces {
            let cut = at.clamp(piece.text.start, piece.text.end);
            for text in [Span::new(piece.text.start, cut), Span::new(cut, piece.text.end)] {
                if !put && text.start >= at {
                    let host = offset(piece, text.start);
                    literal.made(front, Span::at(host));
                    put = true;
                }
                if text.is_empty() {
                    continue;
                }
                let start = literal.text.len();
                literal.text.push_str(&self.text[text.range()]);
                let host = if piece.kind == PieceKind::Made {
                    piece.host
                } else {
                    Span::new(offset(piece, text.start), offset(piece, text.end))
                };
                literal.pieces.push(Piece { text: Span::new(start, literal.text.len()), host, ..*piece });
            }
        }
        let end = self.place().unwrap_or_default().end;
        if !put {
            literal.made(front, Span::at(end));
        }
        literal.made(behind, Span::at(end));
        literal
    }

    /// Adds what stands between the marks of a raw string.
    pub fn verbatim_raw(&mut self, file: &SourceFile, place: Span) {
        self.verbatim(file, place, PieceKind::Raw);
    }

    /// Takes out a part of the text: blanks stand for it.
    pub fn blank(&mut self, span: Span) {
        self.text.replace_range(span.range(), &" ".repeat(span.len()));
    }

    /// Place in the host file, from the first to the last character; none without text.
    pub fn place(&self) -> Option<Span> {
        Some(self.pieces.first()?.host.to(self.pieces.last()?.host))
    }

    /// The text as a file of its own, whose places lead back to the host file.
    pub fn assembled(&self, file: &SourceFile, name: &str) -> SourceFile {
        let mut assembly = Assembly::new();
        for piece in &self.pieces {
            match piece.kind {
                PieceKind::Made => {
                    let text = self.text.get(piece.text.range()).unwrap_or("");
                    assembly.insert(text, file, piece.host.start);
                }
                _ => assembly.copy(file, piece.host),
            }
        }
        assembly.finish(name)
    }

    /// True when a line of the text that a place touches holds something that stands nowhere.
    pub fn is_filled_in(&self, place: Span) -> bool {
        let start = self.text[..place.start].rfind('\n').map_or(0, |at| at + 1);
        let end = self.text[place.end..].find('\n').map_or(self.text.len(), |at| place.end + at);
        self.pieces.iter().any(|p| p.kind == PieceKind::Made && p.text.start < end && start < p.text.end)
    }

    /// Adds a further part of such a file.
    pub fn add_part(&mut self, file: &SourceFile, place: Span) {
        self.verbatim(file, place, PieceKind::File);
    }

    /// Adds the argument of a macro that makes a string of it.
    pub fn argument(&mut self, file: &SourceFile, place: Span) {
        self.verbatim(file, place, PieceKind::Argument);
    }

    fn verbatim(&mut self, file: &SourceFile, host: Span, kind: PieceKind) {
        let start = self.text.len();
        self.text.push_str(file.slice(host));
        if self.text.len() > start {
            self.pieces.push(Piece { text: Span::new(start, self.text.len()), host, kind });
        }
    }

    /// Adds text that stands otherwise, or not at all, in the host file.
    pub fn made(&mut self, text: &str, host: Span) {
        let start = self.text.len();
        self.text.push_str(text);
        if !text.is_empty() {
            self.pieces.push(Piece { text: Span::new(start, self.text.len()), host, kind: PieceKind::Made });
        }
    }

    fn piece_at(&self, offset: usize) -> Option<&Piece> {
        let after = self.pieces.partition_point(|p| p.text.end <= offset);
        self.pieces.get(after).or_else(|| self.pieces.last())
    }

    /// The place in the host file of a place in the text.
    pub fn to_host(&self, place: Span) -> Span {
        let Some(first) = self.piece_at(place.start) else { return Span::at(0) };
        let start = offset(first, place.start);
        if place.is_empty() {
            return Span::at(start);
        }
        let Some(last) = self.piece_at(place.end - 1) else { return Span::at(start) };
        let end = if last.kind == PieceKind::Made { last.host.end } else { offset(last, place.end) };
        Span::new(start, end)
    }

    /// The edit of the host file that makes an edit of the text; none when it is not the plain text of
    /// one literal, or when what it writes would have to be escaped.
    pub fn edit(&self, edit: &Edit) -> Option<Edit> {
        let fits = |p: &&Piece| p.text.start <= edit.span.start && edit.span.end <= p.text.end;
        let piece = self.pieces.iter().filter(|p| p.kind != PieceKind::Made).find(fits)?;
        let mut written = edit.replacement.clone();
        let allowed = match piece.kind {
            PieceKind::Quoted => !written.contains(['"', '\\', '\n', '\r']),
            PieceKind::Raw => !written.contains('"'),
            PieceKind::File => true,
            PieceKind::Line => !written.contains(['\n', '\r']),
            PieceKind::Markup => {
                written = written.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
                true
            }
            PieceKind::Argument => {
                !written.contains(['"', '\n', '#'])
                    && written.matches('(').count() == written.matches(')').count()
                    && !written.contains("//")
            }
            PieceKind::Made => false,
        };
        let host = Span::new(offset(piece, edit.span.start), offset(piece, edit.span.end));
        allowed.then(|| Edit::replace(host, written))
    }
}

/// True for a literal, and false for what stands for a text.
fn is_literal(node: Node<'_>) -> bool {
    matches!(node.kind(), "string_literal" | "raw_string_literal")
}

fn offset(piece: &Piece, at: usize) -> usize {
    match piece.kind {
        PieceKind::Made => piece.host.start,
        PieceKind::Quoted
        | PieceKind::Raw
        | PieceKind::File
        | PieceKind::Line
        | PieceKind::Markup
        | PieceKind::Argument => piece.host.start + at.clamp(piece.text.start, piece.text.end) - piece.text.start,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HostFile;
    use crate::cpp::tree::descendants;

    fn read(text: &str) -> Option<(Literal, SourceFile)> {
        let file = SourceFile::new("a.cpp", format!("const char *s = {text};"));
        let host = HostFile::new(&file, true);
        let kinds = ["concatenated_string", "string_literal", "raw_string_literal"];
        let node = descendants(host.root()?).find(|n| kinds.contains(&n.kind()))?;
        Some((Literal::of(node, &file)?, file))
    }

    #[test]
    fn the_text_is_what_the_compiler_makes_of_it() {
        for (text, expected) in [
            (r#""a\n" "b""#, "a\nb"),
            ("\"a\\n\\\nb\"", "a\nb"),
            (r#"R"(x "y" \n)""#, r#"x "y" \n"#),
            (r#"R"glsl(f(a))glsl""#, "f(a)"),
            (r##""#version 150\n" R"(void main() {})""##, "#version 150\nvoid main() {}"),
            (r#""\"\t\\""#, "\"\t\\"),
        ] {
            assert_eq!(read(text).map(|r| r.0.text).as_deref(), Some(expected), "{text}");
        }
        assert!(read(r#""\x41""#).is_none());
    }

    #[test]
    fn every_place_leads_back() {
        let (literal, file) = read("\"ab\\n\"\n  \"頂cd\\n\"").unwrap();
        for word in ["ab", "頂", "cd"] {
            let at = literal.text.find(word).unwrap();
            let place = literal.to_host(Span::new(at, at + word.len()));
            assert_eq!(file.slice(place), word);
            let edit = literal.edit(&Edit::replace(Span::new(at, at + word.len()), "x")).unwrap();
            assert_eq!(edit.span, place);
        }
        let at = literal.text.find('\n').unwrap();
        assert_eq!(file.slice(literal.to_host(Span::new(at, at + 1))), "\\n");
    }

    #[test]
    fn an_edit_over_an_escape_or_with_one_is_refused() {
        let (literal, _) = read(r#""ab\n" "cd""#).unwrap();
        assert!(literal.edit(&Edit::replace(Span::new(1, 3), "x")).is_none());
        assert!(literal.edit(&Edit::replace(Span::new(0, 1), "\n")).is_none());
        assert!(literal.edit(&Edit::insert(2, "x")).is_some());
        let (raw, _) = read("R\"(a\nb)\"").unwrap();
        assert!(raw.edit(&Edit::replace(Span::new(0, 2), "c\n\n")).is_some());
    }
}
