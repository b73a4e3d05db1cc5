//! What the `#if` of a text ask, and readings of the text with definitions from outside.

use std::collections::{BTreeSet, HashSet};

use base::text::Span;
use syntax::{Profile, Shader, TokenPlace};

/// Macros with their values.
pub type Defines = Vec<(String, String)>;

/// Names that one text may ask for: each is tried by itself. Of a text that asks for more, little is sure.
pub const MOST_ASKED: usize = 12;

/// Names in the directives of a text.
pub struct Conditions {
    /// Those that `#if`, `#ifdef`, `#ifndef` and `#elif` ask for.
    asked: BTreeSet<String>,
    /// Those that a `#define` sets.
    pub defined: BTreeSet<String>,
}

impl Conditions {
    /// Reads the directives of a text.
    pub fn of(shader: &Shader) -> Self {
        let (mut asked, mut defined) = (BTreeSet::new(), BTreeSet::new());
        for line in shader.file().text().lines() {
            let Some(directive) = line.trim_start().strip_prefix('#') else { continue };
            let mut words = directive.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|w| !w.is_empty());
            match words.next() {
                Some("define") => defined.extend(words.next().map(str::to_owned)),
                Some("if" | "ifdef" | "ifndef" | "elif") => {
                    let name = |w: &&str| !w.starts_with(|c: char| c.is_ascii_digit()) && *w != "defined";
                    asked.extend(words.filter(name).map(str::to_owned));
                }
                _ => {}
            }
        }
        Self { asked, defined }
    }

    /// True for a name that a condition asks for.
    pub fn asks(&self, name: &str) -> bool {
        self.asked.contains(name)
    }

    /// The names that are asked for and that neither the text nor the language defines; macros of extensions, which the
    /// language may define, where these are wanted.
    pub fn undefined(&self, extensions: bool) -> BTreeSet<String> {
        let of_language =
            |name: &str| name.starts_with("__") || (name.starts_with("GL_") && !(extensions && is_extension(name)));
        self.asked.iter().filter(|name| !self.defined.contains(*name) && !of_language(name)).cloned().collect()
    }
}

/// True for the macro of an extension, which is defined where the extension is there.
fn is_extension(name: &str) -> bool {
    let vendors = ["ARB", "EXT", "NV", "AMD", "KHR", "OES", "ARM", "IMG", "QCOM", "INTEL", "MESA", "ATI", "APPLE"];
    vendors.iter().any(|v| name.strip_prefix("GL_").and_then(|n| n.strip_prefix(v)).is_some_and(|n| n.starts_with('_')))
}

/// What a compiler of OpenGL ES and a host for it define, where a text without a version asks for it: `GL_ES`, and names of
/// hosts that say the same, such as `GLES` and `OPENGL_ES`.
pub fn of_es(shader: &Shader) -> Option<Defines> {
    let version = shader.version();
    if shader.wgsl().is_some() || version.span.is_some() || version.profile == Profile::Es {
        return None;
    }
    let Conditions { asked, defined } = Conditions::of(shader);
    let says = |name: &String| (says_es(name) || name == "GL_FRAGMENT_PRECISION_HIGH") && !defined.contains(name);
    let names: Vec<String> = asked.into_iter().filter(says).collect();
    if names.is_empty() {
        return None;
    }
    let of_language = |name: &String| name.starts_with("GL_");
    let own = std::iter::once("GL_ES".to_owned()).chain(names.into_iter().filter(|name| !of_language(name)));
    Some(own.map(|name| (name, "1".to_owned())).collect())
}

/// True for a name that a host for OpenGL ES defines.
fn says_es(name: &str) -> bool {
    const WORDS: [&str; 7] = ["ES", "GLES", "GLES2", "GLES3", "OPENGLES", "ESSL", "GLSLES"];
    let macros = name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
    macros && !is_extension(name) && name.split('_').any(|word| WORDS.contains(&word))
}

/// Each name as `1` by itself, and then all of them where there are several.
pub fn each_and_all(names: &BTreeSet<String>) -> Vec<Defines> {
    let one = |name: &String| (name.clone(), "1".to_owned());
    let mut sets: Vec<Defines> = names.iter().map(|name| vec![one(name)]).collect();
    if names.len() > 1 {
        sets.push(names.iter().map(one).collect());
    }
    sets
}

/// What may be defined from outside without another value in the code: all names, and then each by itself.
pub fn definitions(shader: &Shader) -> Vec<Defines> {
    let code = shader.file().text().lines().filter(|l| !l.trim_start().starts_with('#'));
    let used: HashSet<&str> = code.flat_map(|l| l.split(|c: char| !c.is_ascii_alphanumeric() && c != '_')).collect();
    let mut asked = Conditions::of(shader).undefined(false);
    asked.retain(|name| !used.contains(name.as_str()));
    all_and_each(&asked)
}

/// All names as `1`, and then each by itself.
pub fn all_and_each(names: &BTreeSet<String>) -> Vec<Defines> {
    let mut sets = each_and_all(names);
    if let Some(all) = sets.pop_if(|_| names.len() > 1) {
        sets.truncate(MOST_ASKED);
        sets.insert(0, all);
    }
    sets
}

/// Where a place stands: in text that is compiled, in a directive, or in what is left out.
pub fn place_of(shader: &Shader, span: Span) -> Option<TokenPlace> {
    let tokens = shader.tokens();
    tokens.get(tokens.partition_point(|t| t.span.end <= span.start)).map(|t| t.place)
}
