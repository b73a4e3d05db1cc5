//! Macros that host code gives to shaders: what its strings and its commands define.
//!
//! ```text
//! defines.append("psc(x)", "(x==0?p.x:x)");            a pair of a name and a value
//! {{"A_TYPE", "float"}, {"D_TYPE", "vec4"}}            several of one build
//! "#define WIDTH 32\n"                                 a line of a text that stands in front
//! glslc -DWIDTH=32 sum.comp                            an option of a compiler
//! ```
//!
//! Values that the host computes are not known, and left out.

mod commands;
mod lines;
mod pairs;
#[cfg(test)]
mod tests;

use base::text::SourceFile;

use crate::script::{HostText, host_texts};

/// A macro that host code defines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostMacro {
    /// Its name, with its parameters where it has some: `load(buffer,at)`.
    pub name: String,
    /// What it stands for.
    pub value: String,
    /// Where the host says so, in bytes.
    pub at: usize,
    /// The statement that says so: those of one statement belong to one build.
    pub statement: usize,
}

/// What a file of host code defines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HostMacros {
    /// Macros in the order of the text.
    pub macros: Vec<HostMacro>,
    /// Names of shader files, with the statements that name them.
    pub shaders: Vec<(usize, String)>,
}

/// Endings of files that commands stand in, beside those of host code.
pub const COMMAND_EXTENSIONS: &[&str] = &["cmake", "sh", "bat", "mk", "txt", "build", "ps1"];

/// Names of files that commands stand in.
pub const COMMAND_FILES: &[&str] = &["Makefile", "makefile", "GNUmakefile", "CMakeLists.txt", "meson.build"];

/// Endings that tell that a word is the name of a shader file.
const SHADERS: [&str; 9] = [".comp", ".glsl", ".wgsl", ".hlsl", ".vert", ".frag", ".geom", ".compute", ".slang"];

/// The longest text of a macro.
const LONGEST: usize = 1 << 12;

/// The macros that a file of host code, or one with commands, defines.
pub fn host_macros(file: &SourceFile) -> HostMacros {
    let mut found = HostMacros::default();
    match host_texts(file) {
        Some(texts) => {
            pairs::read(&texts, &mut found);
            texts.iter().for_each(|text| lines::read(text, &texts, &mut found));
        }
        None => commands::read(file.text(), &mut found),
    }
    found.macros.sort_by_key(|one| one.at);
    found
}

impl HostMacros {
    /// True where a statement names the shader file: by its name, or by its path.
    pub fn names(&self, statement: usize, shader: &str) -> bool {
        let name = shader.rsplit(['/', '\\']).next().unwrap_or(shader);
        self.shaders.iter().any(|(at, file)| *at == statement && file.rsplit(['/', '\\']).next() == Some(name))
    }

    fn add(&mut self, name: &str, value: &str, at: usize, statement: usize) {
        let shader = SHADERS.iter().any(|ending| value.ends_with(ending));
        let plain = value.len() <= LONGEST && !value.contains('\n') && !shader;
        if let Some(name) = heading(name).filter(|_| plain) {
            self.macros.push(HostMacro { name, value: value.trim().to_owned(), at, statement });
        }
    }

    fn note_shader(&mut self, text: &str, statement: usize) {
        let name = text.trim();
        let plain = !name.is_empty() && name.len() < 256 && !name.contains(char::is_whitespace);
        if plain && SHADERS.iter().any(|ending| name.ends_with(ending)) {
            self.shaders.push((statement, name.to_owned()));
        }
    }
}

/// The head of a macro without blanks: `NAME`, or `NAME(a,b)`. None for what is none.
fn heading(text: &str) -> Option<String> {
    let text = text.trim();
    let (name, params) = match text.split_once('(') {
        None => (text, None),
        Some((name, rest)) => (name, Some(rest.strip_suffix(')')?)),
    };
    if !is_name(name) {
        return None;
    }
    let Some(params) = params else { return Some(name.to_owned()) };
    let params: Vec<&str> = params.split(',').map(str::trim).collect();
    let good = params == [""] || params.iter().all(|param| is_name(param));
    good.then(|| format!("{name}({})", params.join(",")))
}

fn is_name(text: &str) -> bool {
    let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && text.chars().all(part)
}

/// A number or another value that a host writes without quotation marks; none for what it computes.
fn plain_value(word: &str) -> Option<&str> {
    if let Some(hex) = word.strip_prefix("0x") {
        let digits = hex.trim_end_matches(['u', 'U', 'l', 'L']);
        return u64::from_str_radix(digits, 16).ok().map(|_| &word[..2 + digits.len()]);
    }
    let digits = word.trim_end_matches(['u', 'U', 'l', 'L', 'f', 'F']);
    let number = word.starts_with(|c: char| c.is_ascii_digit()) && digits.parse::<f64>().is_ok();
    match word {
        "true" => Some("1"),
        "false" => Some("0"),
        _ => number.then_some(digits),
    }
}

/// A string of host code, joined from those side by side.
pub type Text = HostText;
