//! What stands in for a placeholder whose value is not known, for readers that look for faults and run nothing: a name, of
//! the type that a suffix behind it says, or nothing where the placeholder has a line for itself. Of conditions, the first
//! branch is read.

use base::text::{Assembly, SourceFile, Span};

/// What a mark that needs the template engine does to the text around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Begins a part that is read: `{% if a > b %}`, `{% for … %}`, `{{#each …}}`.
    Open,
    /// Begins another branch of a condition.
    Branch,
    /// Ends a part.
    Close,
    /// Leaves nothing: `{% include … %}`.
    Nothing,
    /// Gives text: `{{ n / 4 }}`.
    Text,
}

/// The role of a mark by its first words.
pub(crate) fn role(mark: &str) -> Role {
    let statement = mark.starts_with("{%");
    let inside = mark.trim_matches(['{', '}', '%', '-', '~']).trim_start();
    let word = inside.split(|c: char| !c.is_alphabetic() && c != '#' && c != '/').next().unwrap_or("");
    match word {
        "if" | "for" | "macro" | "block" | "raw" | "filter" if statement => Role::Open,
        "elif" | "elsif" | "elseif" | "else" if statement => Role::Branch,
        word if statement && word.starts_with("end") => Role::Close,
        _ if statement => Role::Nothing,
        word if word.starts_with('#') => Role::Open,
        word if word.starts_with('/') => Role::Close,
        "else" => Role::Branch,
        _ if inside.starts_with(['>', '^', '!']) => Role::Nothing,
        _ => Role::Text,
    }
}

/// The names that stand in, each for one text of a placeholder.
#[derive(Default)]
pub(crate) struct StandIns<'t> {
    /// Text of a placeholder with the type behind it, where there is one.
    names: Vec<(&'t str, Option<&'static str>)>,
}

impl<'t> StandIns<'t> {
    /// Puts something into the place of a mark. Gives the end of what it stands for.
    pub(crate) fn put(&mut self, file: &'t SourceFile, span: Span, out: &mut Assembly) -> usize {
        let text = file.text();
        let start = text[..span.start].rfind(['\n', '\r']).map_or(0, |end| end + 1);
        let end = text[span.end..].find(['\n', '\r']).map_or(text.len(), |end| span.end + end);
        let behind = text[span.end..end].split("//").next().unwrap_or("").trim();
        if text[start..span.start].trim().is_empty() && matches!(behind, "" | ";" | ",") {
            out.replace("", file, span);
            return end.min(span.end + text[span.end..end].find([';', ',']).map_or(0, |at| at + 1));
        }
        let next = |at: usize| text[at..].chars().next();
        let word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
        let suffix = [("u", "u32"), ("i", "i32"), ("f", "f32"), (".", "f32")]
            .into_iter()
            .find(|(suffix, _)| text[span.end..].starts_with(suffix) && !word(next(span.end + 1)));
        let (len, ty) = suffix.map_or((0, None), |(suffix, ty)| (suffix.len(), Some(ty)));
        let key = (text[span.range()].trim_matches(['{', '}', '-', '~', ' ']), ty);
        let index = self.names.iter().position(|known| *known == key).unwrap_or_else(|| {
            self.names.push(key);
            self.names.len() - 1
        });
        let whole = Span::new(span.start, span.end + len);
        out.replace(&name(index), file, whole);
        whole.end
    }

    /// Declares the names whose types are known, behind the text.
    pub(crate) fn declare(&self, file: &SourceFile, out: &mut Assembly) {
        for (index, (_, ty)) in self.names.iter().enumerate() {
            if let Some(ty) = ty {
                out.replace(&format!("\noverride {}: {ty};", name(index)), file, Span::at(file.text().len()));
            }
        }
    }
}

fn name(index: usize) -> String {
    format!("stand_in_{index}")
}
