//! Rename, across stages, includes and strings of host code. A rename is tried out first: each place must mean the same
//! thing afterwards, and nothing may be wrong that was right.

use std::collections::BTreeMap;
use std::fmt;

use base::text::{Edit, EditList, Span};
use syntax::Shader;

use crate::navigate::Found;
use crate::workspace::{Edits, Place, Workspace};

/// Why something is not renamed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RenameError {
    /// Nothing that has a name of its own stands there.
    Nothing,
    /// The language gives the name.
    BuiltIn(String),
    /// The new name is none.
    NotAName(String),
    /// The new name has a meaning in the language.
    Keyword(String, String),
    /// The new name begins or goes on as only names of the language do.
    Reserved(String),
    /// Something else has the new name, at this place.
    Collides(String, String),
    /// A macro writes the name somewhere.
    InMacro(String),
    /// A text in another encoding is not open.
    Encoding(String, String),
    /// A file outside of the workspace would be changed.
    Outside(String),
}

impl fmt::Display for RenameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => f.write_str("there is no name here that can be changed"),
            Self::BuiltIn(name) => write!(f, "`{name}` is a name of the language"),
            Self::NotAName(name) => write!(f, "`{name}` is no name: use letters, digits and `_`, a letter first"),
            Self::Keyword(name, language) => write!(f, "`{name}` is a keyword or a function of {language}"),
            Self::Reserved(name) => {
                write!(f, "`{name}` is reserved: names begin with `gl_` or have `__` in the language alone")
            }
            Self::Collides(name, place) => {
                write!(f, "`{name}` would no longer mean one thing: it is declared at {place}")
            }
            Self::InMacro(name) => {
                write!(f, "`{name}` would leave a name behind or catch another: it may stand in a macro")
            }
            Self::Encoding(file, encoding) => {
                write!(f, "{file} is {encoding}; open it in the editor first, so that it is saved as it was")
            }
            Self::Outside(file) => write!(f, "{file} lies outside of the workspace"),
        }
    }
}

impl std::error::Error for RenameError {}

impl Workspace {
    /// The name that would be changed at a place.
    ///
    /// # Errors
    /// Where there is none.
    pub fn renamed_at(&self, name: &str, offset: usize) -> Result<Place, RenameError> {
        let touches =
            |f: &&Found| f.place.file.name() == name && f.place.span.start <= offset && offset <= f.place.span.end;
        let found = self.found_at(name, offset);
        if let Some(here) = found.iter().find(touches).filter(|_| found.iter().any(|f| f.declares)) {
            return Ok(here.place.clone());
        }
        let word = self.file(name).map_or("", |file| word_at(file.text(), offset));
        if word.is_empty() { Err(RenameError::Nothing) } else { Err(RenameError::BuiltIn(word.to_owned())) }
    }

    /// The changes that give what stands at a place another name.
    ///
    /// # Errors
    /// Why it is not renamed. Nothing is changed then.
    pub fn rename(&self, name: &str, offset: usize, new: &str) -> Result<Edits, RenameError> {
        self.renamed_at(name, offset)?;
        let found = self.found_at(name, offset);
        let (start, _) = self.meaning_at(name, offset);
        let (family, _) = self.family(start);
        let shaders: Vec<&Shader> = family.iter().map(|(unit, _)| &self.units()[*unit].shader).collect();
        check(new, &shaders)?;
        let mut edits = Edits::new();
        for Found { place, .. } in &found {
            let entry = edits.entry(place.file.name().to_owned());
            entry.or_insert_with(|| (place.file.clone(), Vec::new())).1.push((place.span, new.to_owned()));
        }
        self.try_out(&found, &edits, new, &shaders)?;
        Ok(edits)
    }

    /// Applies the changes to copies of the texts and looks again.
    fn try_out(&self, found: &[Found], edits: &Edits, new: &str, shaders: &[&Shader]) -> Result<(), RenameError> {
        let mut texts = BTreeMap::new();
        let mut wanted: Vec<(String, Span)> = Vec::new();
        let in_macro = || RenameError::InMacro(new.to_owned());
        for (name, (file, changes)) in edits {
            let list: EditList = changes.iter().map(|(span, text)| Edit::replace(*span, text.as_str())).collect();
            let edited = list.apply(file.text()).map_err(|_| in_macro())?;
            for (span, _) in changes {
                let before = changes
                    .iter()
                    .filter(|(s, _)| s.start < span.start)
                    .map(|(s, _)| new.len() as i64 - s.len() as i64)
                    .sum::<i64>();
                let at = usize::try_from(span.start as i64 + before).unwrap_or(span.start);
                wanted.push((name.clone(), Span::new(at, at + new.len())));
            }
            texts.insert(name.clone(), edited.text);
        }
        let after = self.with(&texts);
        let declared = found.iter().position(|f| f.declares).map(|at| {
            let place = &found[at].place;
            let nth = edits[place.file.name()].1.iter().position(|(s, _)| *s == place.span).unwrap_or(0);
            let before: usize =
                edits.iter().take_while(|(n, _)| n.as_str() != place.file.name()).map(|(_, e)| e.1.len()).sum();
            wanted[before + nth].clone()
        });
        let Some((file, span)) = declared else { return Err(RenameError::Nothing) };
        let again = after.found_at(&file, span.start);
        let mut now: Vec<(String, Span)> =
            again.iter().map(|f| (f.place.file.name().to_owned(), f.place.span)).collect();
        now.sort();
        wanted.sort();
        let errors = |w: &Self| -> usize {
            w.units().iter().filter(|u| u.files.iter().any(|f| texts.contains_key(f))).map(|u| u.errors).sum()
        };
        if now == wanted && errors(&after) <= errors(self) {
            return Ok(());
        }
        let other = |shader: &&Shader| {
            let symbol = shader.symbols().find(|(_, s)| s.name == new).and_then(|(_, s)| s.span);
            let function = || shader.function(new).map(|f| f.name.span);
            symbol.or_else(function).map(|span| shader.file().locate(span.start))
        };
        Err(match shaders.iter().find_map(other) {
            Some(place) => RenameError::Collides(new.to_owned(), place),
            None => in_macro(),
        })
    }
}

/// Whether a name may be given in these shaders.
fn check(new: &str, shaders: &[&Shader]) -> Result<(), RenameError> {
    let letters = new.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !letters || !new.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        return Err(RenameError::NotAName(new.to_owned()));
    }
    for shader in shaders {
        if shader.wgsl().is_some() {
            if syntax::wgsl::is_builtin(new) || WGSL_WORDS.contains(&new) {
                return Err(RenameError::Keyword(new.to_owned(), "WGSL".to_owned()));
            }
        } else if shader.offered_words().iter().any(|w| w == new) || syntax::is_builtin_function(shader, new) {
            return Err(RenameError::Keyword(new.to_owned(), shader.version().to_string()));
        }
    }
    if new.starts_with("gl_") || new.contains("__") {
        return Err(RenameError::Reserved(new.to_owned()));
    }
    Ok(())
}

/// Keywords of WGSL, section 15.1, and its predeclared types.
const WGSL_WORDS: &[&str] = &[
    "alias",
    "array",
    "atomic",
    "bool",
    "break",
    "case",
    "const",
    "const_assert",
    "continue",
    "continuing",
    "default",
    "diagnostic",
    "discard",
    "else",
    "enable",
    "f16",
    "f32",
    "false",
    "fn",
    "for",
    "i32",
    "if",
    "let",
    "loop",
    "override",
    "ptr",
    "requires",
    "return",
    "sampler",
    "struct",
    "switch",
    "true",
    "u32",
    "var",
    "vec2",
    "vec3",
    "vec4",
    "while",
];

/// The word at a place.
fn word_at(text: &str, offset: usize) -> &str {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let (before, behind) = text.split_at_checked(offset).unwrap_or((text, ""));
    let start = before.len() - before.chars().rev().take_while(|c| is_word(*c)).map(char::len_utf8).sum::<usize>();
    let end = offset.min(text.len()) + behind.chars().take_while(|c| is_word(*c)).map(char::len_utf8).sum::<usize>();
    text.get(start..end).unwrap_or("")
}
