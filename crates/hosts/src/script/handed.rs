//! Whether a text of a shader reaches OpenGL as it stands in host code, and what host code puts in front of texts.
//!
//! A text without a version, or with names that it does not declare, may be one that a library completes. It is whole
//! where the program itself calls the function that takes the text: what it puts in front stands in its own strings.

use std::collections::HashSet;

use base::text::SourceFile;

use super::host_text::{HostText, host_texts};
use super::language::Language;
use crate::{HostFile, concerns_shaders, marks};

/// Whether something in a project gives texts of shaders to OpenGL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Given {
    /// Nothing in sight does.
    Nowhere,
    /// A script or a page does.
    Somewhere,
    /// A script or a page does, and nothing in the project uses a library or is host code of another kind.
    InSight,
}

impl Given {
    /// What the files of a project do.
    pub fn of<'f>(files: impl Iterator<Item = &'f SourceFile> + Clone) -> Self {
        let gives = |file: &SourceFile| Language::of(file.name()).is_some() && gives_to_gl(file.text());
        if !files.clone().any(gives) {
            return Self::Nowhere;
        }
        let mut files = files;
        let in_sight = files.all(|file| match Language::of(file.name()) {
            Some(Language::JavaScript) => imported(file.text()).all(is_of_the_project),
            Some(_) => !gives_to_gl(file.text()),
            None => Language::like_c(file.name()).is_none() || !concerns_shaders(file.text()),
        });
        if in_sight { Self::InSight } else { Self::Somewhere }
    }
}

/// The function of OpenGL that takes the text of a shader, as languages spell it.
const TAKES: [&str; 3] = ["shaderSource", "glShaderSource", "shader_source"];

/// Arguments with a name that do the same, in Python.
const TAKEN_AS: [&str; 2] = ["vertex_shader=", "fragment_shader="];

/// Words that declare names in GLSL.
const DECLARES: [&str; 28] = [
    "uniform",
    "attribute",
    "varying",
    "in",
    "out",
    "inout",
    "const",
    "define",
    "struct",
    "void",
    "bool",
    "int",
    "uint",
    "float",
    "vec2",
    "vec3",
    "vec4",
    "ivec2",
    "ivec3",
    "ivec4",
    "mat2",
    "mat3",
    "mat4",
    "sampler2D",
    "samplerCube",
    "precision",
    "highp",
    "mediump",
];

/// Directives that say how all behind them is read.
const DIRECTIVES: [&str; 3] = ["#define", "#version", "#extension"];

/// True for host code that gives texts to OpenGL itself.
fn gives_to_gl(text: &str) -> bool {
    let called = |word: &str| {
        let mut found = text.match_indices(word);
        found.any(|(at, _)| {
            let before = text[..at].chars().next_back().unwrap_or(' ');
            !before.is_alphanumeric() && before != '_' && text[at + word.len()..].trim_start().starts_with('(')
        })
    };
    TAKES.iter().any(|word| called(word)) || TAKEN_AS.iter().any(|name| text.contains(name))
}

/// True for a script or a page whose shaders reach OpenGL as they stand, but for what its project has in strings: it gives
/// them to OpenGL, or another file of the project does, and no library is known to be used beside.
pub fn hands_on(file: &SourceFile, given: Given) -> bool {
    let (text, gives) = (file.text(), gives_to_gl(file.text()));
    let given_elsewhere = given > Given::Nowhere;
    match Language::of(file.name()) {
        Some(Language::JavaScript) => {
            let mut names = imported(text).peekable();
            // Where a file imports nothing, what takes its texts may be a library that it does not name.
            let known = gives || given == Given::InSight || (given_elsewhere && names.peek().is_some());
            // three.js puts much in front, also where its file is one of the project.
            known && !text.contains("THREE.") && names.all(is_of_the_project)
        }
        Some(Language::Java | Language::Kotlin) => gives || (given_elsewhere && imports_its_own(text)),
        _ => gives,
    }
}

/// True for the name of a module or script that is a file of the project.
fn is_of_the_project(name: &str) -> bool {
    name.starts_with(['.', '/']) && !name.starts_with("//")
}

/// True for a file in Java or Kotlin whose imports are all of its own package or of the platform.
fn imports_its_own(text: &str) -> bool {
    let Some(own) = text.lines().find_map(|line| line.trim().strip_prefix("package ")).map(vendor) else {
        return false;
    };
    let names = text.lines().filter_map(|line| line.trim().strip_prefix("import "));
    let known = |name: &str| PLATFORM.iter().any(|p| name.starts_with(p)) || vendor(name) == own;
    names.map(|name| name.trim_start_matches("static ").trim()).all(known)
}

/// What Android and its languages bring.
const PLATFORM: [&str; 6] = ["android.", "androidx.", "java.", "javax.", "kotlin.", "kotlinx."];

/// The first two parts of the name of a package, which say whose it is.
fn vendor(package: &str) -> String {
    package.trim_end_matches(';').trim().split('.').take(2).collect::<Vec<_>>().join(".")
}

/// The names of modules and scripts that JavaScript, or a page, takes in.
fn imported(text: &str) -> impl Iterator<Item = &str> {
    const BEFORE: [&str; 5] = ["from ", "from", "import ", "import(", "require("];
    let quoted = |at: usize| {
        let rest = &text[at..];
        let quote = rest.chars().next().filter(|c| ['"', '\''].contains(c))?;
        rest[1..].split(quote).next().filter(|name| !name.is_empty() && !name.contains(['\n', ' ']))
    };
    let modules = BEFORE
        .into_iter()
        .flat_map(move |word| text.match_indices(word).filter_map(move |(at, _)| quoted(at + word.len())));
    let scripts = text.match_indices("<script").filter_map(|(at, _)| {
        let tag = text[at..].split('>').next()?;
        let (_, value) = tag.split_once("src=")?;
        let name = value.trim_start_matches(['"', '\'']).split(['"', '\'', ' ']).next()?;
        // A script beside the page is a part of it.
        Some(if name.contains("//") { name } else { "./" })
    });
    modules.chain(scripts)
}

/// What host code puts in front of the texts of others.
pub enum InFront {
    /// These words, in strings that are no whole shader and declare something.
    Words(HashSet<String>),
    /// It puts declarations together: any name.
    Any,
}

impl InFront {
    /// Adds what another file puts in front.
    pub fn add(&mut self, other: Self) {
        match (self, other) {
            (Self::Words(words), Self::Words(more)) => words.extend(more),
            (this, Self::Any) => *this = Self::Any,
            (Self::Any, Self::Words(_)) => {}
        }
    }

    /// True where this word may stand in front of a shader in a string of host code.
    pub fn may_have(&self, word: &str) -> bool {
        match self {
            Self::Words(words) => words.contains(word),
            Self::Any => true,
        }
    }

    /// What the strings of a file say.
    pub fn of(host: &HostFile) -> Self {
        let mut words = HashSet::new();
        for part in host_texts(&host.file).unwrap_or_default() {
            let HostText::String { text, complete, at, .. } = part else { continue };
            // What a whole shader declares is its own.
            if host.embedded().iter().any(|shader| !shader.partial && shader.place.contains(at)) {
                continue;
            }
            if is_built(&text, complete) {
                return Self::Any;
            }
            if !marks::has_main(&text) && declares(&text) {
                words.extend(parts(&text).map(str::to_owned));
            }
        }
        Self::Words(words)
    }
}

fn parts(text: &str) -> impl DoubleEndedIterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// True for declarations of GLSL, and not for a message that has such words.
fn declares(text: &str) -> bool {
    let says = text.contains([';', '{']) && parts(text).any(|word| DECLARES.contains(&word));
    says || DIRECTIVES.iter().any(|directive| text.contains(directive))
}

/// True for the beginning of a declaration that is put together with others: `"uniform " + type`, `uniform ${type} ${name};`.
fn is_built(text: &str, complete: bool) -> bool {
    let all = parts(text).next().is_some() && parts(text).all(|word| DECLARES.contains(&word));
    let begun = all && text.ends_with(' ') && !text.starts_with([' ', '#']);
    let first = || parts(text).next().is_some_and(|word| DECLARES.contains(&word));
    let is_line = || text.trim().lines().count() == 1 && text.contains(';') && !text.trim_start().starts_with('#');
    begun || (!complete && first() && is_line())
}
