//! What the host code and the pieces of a project may put in front of its shaders.

use std::collections::{HashMap, HashSet};

use base::diagnostic::Diagnostic;
use hosts::HostFile;
use hosts::document::document_of;
use hosts::script::InFront;
use syntax::errors::{self, Around};
use syntax::{Profile, TokenKind};

use super::open;
use super::project::{Project, ShaderFile};

/// Words of what may stand in front of the shaders of a project.
pub struct Fronts {
    /// Words of pieces, each with the piece where one alone has it.
    pieces: HashMap<String, Option<String>>,
    words: InFront,
    /// Those of the scripts of pages, which nothing else uses, by the page.
    pages: HashMap<String, InFront>,
    /// Host code rewrites the names that begin with `gl_`.
    renames: bool,
}

impl Fronts {
    /// Words of pieces, and those of texts that host code writes and that are no whole shader.
    pub fn of(project: &Project) -> Self {
        let (mut pieces, mut names) = (HashMap::new(), HashSet::new());
        let words = |text: &str| -> Vec<String> {
            let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            words.filter(|w| w.len() > 1).map(str::to_owned).collect()
        };
        for (_, shader) in project.shader_files() {
            let is_piece = match shader.shader.wgsl() {
                Some(module) => module.entry_points.is_empty(),
                None => shader.shader.function("main").is_none(),
            };
            if is_piece {
                let shader = &shader.shader;
                let code =
                    shader.tokens().iter().filter(|t| t.kind == TokenKind::Word).map(|t| shader.file().slice(t.span));
                for word in code.flat_map(words) {
                    let piece = pieces.entry(word).or_insert_with(|| Some(shader.file().name().to_owned()));
                    if piece.as_deref() != Some(shader.file().name()) {
                        *piece = None;
                    }
                }
            }
        }
        let (scripts, hosts): (Vec<&HostFile>, Vec<&HostFile>) = project.hosts().partition(|host| host.is_script());
        for host in &hosts {
            let mut at = 0;
            for line in host.file.text().split_inclusive('\n') {
                // What a whole shader in a literal declares is its own.
                if let Some(text) = written(line).filter(|_| !host.embedded().iter().any(|e| e.place.contains(at))) {
                    names.extend(words(text));
                }
                at += line.len();
            }
        }
        let renames =
            scripts.iter().any(|host| rewrites(host.file.text())) || hosts.iter().any(|host| has_aliases(host));
        let mut words = InFront::Words(names);
        let mut pages = HashMap::new();
        for host in scripts {
            match &host.place {
                Some(place) => drop(pages.insert(place.document.clone(), InFront::of(host))),
                None => words.add(InFront::of(host)),
            }
        }
        Self { pieces, words, pages, renames }
    }

    /// True for an error that something in front of a text can take away.
    pub fn concern(error: &Diagnostic) -> bool {
        let stated = open::rests(error).intersects(Around::ENABLED | Around::TYPES);
        open::is_about_a_name(error) || error.code == errors::RESERVED || stated
    }

    /// True where what may stand in front of a shader may take away an error that was found in it.
    pub fn may_take_away(&self, shader: &ShaderFile, error: &Diagnostic) -> bool {
        let word = error.file.slice(error.span);
        let host = shader.origin.as_ref().map(|origin| origin.host.name());
        let page = host.and_then(|name| self.pages.get(document_of(name)));
        let all = || [Some(&self.words), page].into_iter().flatten();
        // What it is called instead has a type of its own.
        if self.renames && word.starts_with("gl_") {
            return true;
        }
        if open::is_about_a_name(error) {
            // A piece that a whole text includes does not declare what is missing in it.
            let (own, _) = error.file.origin(error.span);
            let included = (own.name() != error.file.name()).then_some(own.name());
            let of_piece = self.pieces.get(word).is_some_and(|piece| piece.is_none() || piece.as_deref() != included);
            return of_piece
                || all().any(|words| match words {
                    InFront::Words(words) => words.contains(word),
                    // What is put together goes in front of texts that state no version, and of those of scripts.
                    InFront::Any => host.is_some() || shader.shader.version().span.is_none(),
                });
        }
        if error.code == errors::RESERVED {
            return false;
        }
        let has = |word: &&str| self.pieces.contains_key(*word) || all().any(|words| words.may_have(word));
        let states = || ["version", "extension", "precision"].iter().any(has);
        let version = shader.shader.version();
        // Into a file that states its version a precision goes behind that.
        if error.code == errors::PRECISION && version.span.is_some() && host.is_none() {
            return has(&"precision");
        }
        // No version of OpenGL ES takes what the first does not, but for what an extension brings.
        let stated = if version.profile == Profile::Es { Around::ENABLED } else { Around::ENABLED | Around::TYPES };
        version.span.is_none() && open::rests(error).intersects(stated) && states()
    }
}

/// The part of a line of host code that is GLSL in quotes: a definition or a declaration.
fn written(line: &str) -> Option<&str> {
    let quoted = &line[line.find('"')? + 1..];
    let starts =
        ["#define ", "uniform ", "const ", "in ", "out ", "varying ", "attribute ", "layout", "struct ", "\\n#define "];
    let declares = |start: &&str| quoted.trim_start().starts_with(*start) && quoted.len() > start.len();
    starts.iter().any(declares).then_some(quoted)
}

/// True for host code that has OpenSceneGraph declare variables of its own for those that begin with `gl_`.
fn has_aliases(host: &HostFile) -> bool {
    host.file.text().contains("setUseVertexAttributeAliasing")
}

/// True for host code with the beginning of all names of the language alone: `/\bgl_\w+/`, `'gl_'`.
fn rewrites(text: &str) -> bool {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text.match_indices("gl_").any(|(at, mark)| !text[at + mark.len()..].starts_with(is_part))
}
