//! How the languages of hosts write comments and strings.

use crate::document::document_of;

/// Endings of files in these languages that a folder is searched for.
pub const SCRIPT_EXTENSIONS: &[&str] = &["py", "js", "mjs", "cjs", "jsx", "ts", "mts", "tsx", "java", "kt", "rs"];

/// How a string goes on behind its first quotation mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Escapes count, and the line ends it.
    Line,
    /// Escapes count.
    Escaped,
    /// Escapes count, and `${…}` is filled in.
    Template,
    /// Everything stands for itself.
    Raw,
    /// The same, and `$name` and `${…}` are filled in.
    RawTemplate,
    /// A template of Python, in which single braces are filled in.
    Braces,
    /// One character, or no string at all.
    Character,
}

/// The beginning of a string.
#[derive(Clone, Copy, Debug)]
pub struct Opening<'t> {
    /// Bytes of the prefix and the quotation marks.
    pub length: usize,
    /// What ends it.
    pub close: &'t str,
    /// How it goes on.
    pub form: Form,
}

/// A language whose strings can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// Python.
    Python,
    /// JavaScript and TypeScript.
    JavaScript,
    /// Java.
    Java,
    /// Kotlin.
    Kotlin,
    /// Rust.
    Rust,
    /// C, C++, and what writes strings as they do. Shaders in these are read by the syntax tree of C++.
    C,
}

/// Endings of languages that write strings as C does.
const LIKE_C: &[&str] =
    &["c", "cc", "cpp", "cxx", "h", "hh", "hpp", "hxx", "inl", "m", "mm", "cs", "go", "swift", "zig", "d", "cu"];

impl Language {
    /// The language that a file's name says; JavaScript for the scripts of a page, as they are called by its name and a line.
    pub fn of(name: &str) -> Option<Self> {
        Some(match document_of(name).rsplit_once('.')?.1.to_ascii_lowercase().as_str() {
            "py" => Self::Python,
            "js" | "mjs" | "cjs" | "jsx" | "ts" | "mts" | "tsx" | "html" | "htm" | "xhtml" => Self::JavaScript,
            "java" => Self::Java,
            "kt" => Self::Kotlin,
            "rs" => Self::Rust,
            _ => return None,
        })
    }

    /// C, for a file whose name says a language that writes strings in the same way.
    pub fn like_c(name: &str) -> Option<Self> {
        let ending = name.rsplit_once('.')?.1.to_ascii_lowercase();
        LIKE_C.contains(&ending.as_str()).then_some(Self::C)
    }

    /// What begins a comment that ends with the line.
    pub fn comment(self) -> &'static str {
        if self == Self::Python { "#" } else { "//" }
    }

    /// True when `/*` begins a comment.
    pub fn has_block_comments(self) -> bool {
        self != Self::Python
    }

    /// The string that begins here. `before` is the character in front.
    pub fn opening(self, rest: &str, before: Option<char>) -> Option<Opening<'_>> {
        let in_word = before.is_some_and(|c| c.is_alphanumeric() || c == '_');
        match self {
            Self::Python => python(rest, in_word),
            Self::Rust => rust(rest, in_word),
            Self::JavaScript if rest.starts_with('`') => Some(Opening { length: 1, close: "`", form: Form::Template }),
            Self::JavaScript => quoted(rest, &["\"", "'"]),
            Self::Java if rest.starts_with(TRIPLE) => Some(Opening { length: 3, close: TRIPLE, form: Form::Escaped }),
            Self::Kotlin if rest.starts_with(TRIPLE) => {
                Some(Opening { length: 3, close: TRIPLE, form: Form::RawTemplate })
            }
            Self::C if !in_word && rest.starts_with("R\"") => raw_of_c(rest),
            Self::C if rest.starts_with('`') => Some(Opening { length: 1, close: "`", form: Form::Raw }),
            Self::Java | Self::Kotlin | Self::C if rest.starts_with('\'') => {
                Some(Opening { length: 1, close: "'", form: Form::Character })
            }
            Self::Java | Self::Kotlin | Self::C => quoted(rest, &["\""]),
        }
    }
}

const TRIPLE: &str = "\"\"\"";

fn quoted<'t>(rest: &'t str, marks: &[&str]) -> Option<Opening<'t>> {
    let mark = rest.get(..1).filter(|mark| marks.contains(mark))?;
    Some(Opening { length: 1, close: mark, form: Form::Line })
}

/// `R"tag(…)tag"`
fn raw_of_c(rest: &str) -> Option<Opening<'_>> {
    let open = rest.find('(').filter(|open| *open <= 18)?;
    let tag = &rest[2..open];
    let mut ends = rest.match_indices(')').map(|(at, _)| &rest[at..]);
    let end = ends.find(|end| end[1..].strip_prefix(tag).is_some_and(|end| end.starts_with('"')))?;
    Some(Opening { length: open + 1, close: &end[..tag.len() + 2], form: Form::Raw })
}

fn python(rest: &str, in_word: bool) -> Option<Opening<'_>> {
    let prefix = rest.find(['"', '\'']).filter(|at| *at <= 2)?;
    let letters = rest.get(..prefix)?.to_ascii_lowercase();
    if prefix > 0 && (in_word || !letters.chars().all(|c| "rbuf".contains(c))) {
        return None;
    }
    let marks = &rest[prefix..];
    let long = marks.starts_with(TRIPLE) || marks.starts_with("'''");
    let close = &marks[..if long { 3 } else { 1 }];
    let form = match (letters.contains('f'), letters.contains('r'), long) {
        (true, ..) => Form::Braces,
        (_, true, true) => Form::Raw,
        (_, _, true) => Form::Escaped,
        _ => Form::Line,
    };
    Some(Opening { length: prefix + close.len(), close, form })
}

fn rust(rest: &str, in_word: bool) -> Option<Opening<'_>> {
    if rest.starts_with('"') {
        return Some(Opening { length: 1, close: "\"", form: Form::Escaped });
    }
    if rest.starts_with('\'') {
        return Some(Opening { length: 1, close: "'", form: Form::Character });
    }
    let raw = rest.strip_prefix('r').filter(|_| !in_word)?;
    let hashes = raw.len() - raw.trim_start_matches('#').len();
    raw[hashes..].starts_with('"').then_some(())?;
    const CLOSES: [&str; 5] = ["\"", "\"#", "\"##", "\"###", "\"####"];
    Some(Opening { length: 2 + hashes, close: CLOSES.get(hashes)?, form: Form::Raw })
}
