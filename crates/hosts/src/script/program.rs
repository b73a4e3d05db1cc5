//! Which shaders a program of a script is made of.
//!
//! A program is known by its variable: what it is set to, or what is attached to it, names shader texts of this file
//! or shader files. A file that makes one program of all its shaders is about that one. In all other cases nothing is
//! known.

use std::collections::BTreeSet;
use std::ops::Range;

use base::text::Span;
use syntax::Stage;

use super::code::{Code, Write};
use super::token::Token;
use crate::{Embedded, ProgramSource, ShaderRef};

/// How many variables deep a shader is followed.
const DEPTH: usize = 5;

/// Resolves programs of a file.
pub struct Programs<'t> {
    /// The file.
    pub code: &'t Code<'t>,
    /// Its shader texts.
    pub shaders: &'t [Embedded],
}

impl Programs<'_> {
    /// The program that an expression means where it stands.
    pub fn source(&self, program: &Range<usize>) -> ProgramSource {
        let Some(variable) = self.code.variable(program) else {
            let direct = self.refs(program);
            return if direct.is_empty() { ProgramSource::Unknown } else { self.named(direct) };
        };
        self.of_variable(&variable, program.start)
    }

    /// The program that a variable holds at a token.
    pub fn of_variable(&self, variable: &str, at: usize) -> ProgramSource {
        match self.own(variable, at) {
            Own::Shaders(found) => self.named(found),
            Own::Unknown => ProgramSource::Unknown,
            Own::Nothing => self.whole(),
        }
    }

    /// As [`Programs::of_variable`], from what is done with the variable itself.
    pub fn of_variable_alone(&self, variable: &str, at: usize) -> ProgramSource {
        match self.own(variable, at) {
            Own::Shaders(found) => self.named(found),
            Own::Unknown | Own::Nothing => ProgramSource::Unknown,
        }
    }

    fn own(&self, variable: &str, at: usize) -> Own {
        let writes = match self.writes(variable, at) {
            Some(writes) => writes,
            None => return Own::Unknown,
        };
        let mut found: Vec<BTreeSet<ShaderRef>> = Vec::new();
        for write in &writes {
            // A text of a stage that is not read has names of its own.
            if write.value.clone().any(|at| self.is_unread(at)) {
                return Own::Unknown;
            }
            let mut refs = self.refs(&write.value);
            if refs.is_empty() {
                refs = self.given(variable, write.at, DEPTH);
            }
            // Made from something with a name that is no file: load("phong").
            if refs.is_empty() && write.value.clone().any(|at| matches!(self.code.tokens[at], Token::String { .. })) {
                return Own::Unknown;
            }
            // Empty until it is made.
            let none = write.value.len() == 1
                && matches!(self.code.word(write.value.start), Some("null" | "undefined" | "None" | "0"));
            if !none {
                found.push(refs);
            }
        }
        found.dedup();
        match found.pop() {
            Some(refs) if found.is_empty() && !refs.is_empty() => Own::Shaders(refs),
            Some(_) if found.is_empty() => Own::Nothing,
            Some(_) => Own::Unknown,
            None => Own::Nothing,
        }
    }

    /// True for the text of a shader that is none of those of the file: a mesh shader.
    fn is_unread(&self, at: usize) -> bool {
        let Token::String { place, .. } = self.code.tokens[at] else { return false };
        let text = || self.code.string(&(at..at + 1));
        self.text(at, place).is_none() && text().is_some_and(|(text, _)| text.contains("void main"))
    }

    /// The writes to a variable that may count at a token; none where it is a parameter.
    fn writes(&self, variable: &str, at: usize) -> Option<Vec<&Write>> {
        let all: Vec<&Write> = self.code.writes.iter().filter(|w| w.target == variable).collect();
        for body in self.code.around(at) {
            let inside: Vec<&Write> = all.iter().copied().filter(|w| body.contains(&w.at)).collect();
            if !inside.is_empty() {
                return Some(inside);
            }
            if self.code.has_parameter(&body, variable.split('.').next().unwrap_or(variable)) {
                return None;
            }
        }
        // What another function declares for itself is another variable.
        Some(all.into_iter().filter(|w| !w.declares || self.code.around(w.at).is_empty()).collect())
    }

    /// The shaders that stand in these tokens, or that variables in them hold.
    pub fn refs(&self, range: &Range<usize>) -> BTreeSet<ShaderRef> {
        let mut found = BTreeSet::new();
        self.gather(range, DEPTH, &mut found);
        found
    }

    fn gather(&self, range: &Range<usize>, depth: usize, into: &mut BTreeSet<ShaderRef>) {
        let mut at = range.start;
        while at < range.end {
            match self.code.tokens[at] {
                Token::String { place, .. } => into.extend(self.text(at, place)),
                Token::Word(_) if depth > 0 => {
                    let mut end = at;
                    while self.code.is_mark(end + 1, '.') && self.code.word(end + 2).is_some() && end + 2 < range.end {
                        end += 2;
                    }
                    let is_key = self.code.is_mark(end + 1, ':') && self.code.bracket(end).is_some();
                    if !is_key && let Some((name, _)) = self.code.chain(end) {
                        self.follow(&name, at, depth - 1, into);
                    }
                    at = end;
                }
                Token::Word(_) | Token::Mark(_) => {}
            }
            at += 1;
        }
    }

    /// The shaders that a variable holds.
    fn follow(&self, name: &str, at: usize, depth: usize, into: &mut BTreeSet<ShaderRef>) {
        let outside = |writes: Vec<&Write>| -> Vec<Range<usize>> {
            writes.into_iter().map(|w| w.value.clone()).filter(|value| !value.contains(&at)).collect()
        };
        let values = self.writes(name, at).map(outside).unwrap_or_default();
        if let [value] = values.as_slice() {
            let before = into.len();
            // An object holds more than the shader that is meant.
            if !self.code.is_mark(value.start, '{') {
                self.gather(value, depth, into);
            }
            if into.len() == before {
                into.extend(self.given(name, value.start, depth));
            }
            return;
        }
        // A member of an object that is written as a whole.
        let Some((object, key)) = name.rsplit_once('.') else { return };
        let Some([value]) = self
            .writes(object, at)
            .map(outside)
            .as_deref()
            .and_then(|v| v.first_chunk::<1>().filter(|_| v.len() == 1))
            .cloned()
        else {
            return;
        };
        if self.code.is_mark(value.start, '{')
            && let Some(value) = self.code.property(value.start, key)
        {
            self.gather(&value, depth, into);
        }
    }

    /// The shader that a string is, or that it names.
    fn text(&self, at: usize, place: Span) -> Option<ShaderRef> {
        if let Some(index) = self.shaders.iter().position(|s| s.place.contains(place.start)) {
            return Some(ShaderRef::Embedded(index));
        }
        let (name, _) = self.code.string(&(at..at + 1))?;
        let name = name.split('?').next().unwrap_or(name);
        let is_file =
            crate::cpp::is_shader_name(name) || (name.ends_with(".glsl") && !name.contains(['\n', '*', ' ', '$', '{']));
        is_file.then(|| ShaderRef::File(name.to_owned()))
    }

    /// The shaders that are attached to a variable, or that its methods are given, in the function of a token.
    fn given(&self, variable: &str, at: usize, depth: usize) -> BTreeSet<ShaderRef> {
        let mut found = BTreeSet::new();
        if depth == 0 {
            return found;
        }
        let body = self.code.around(at).into_iter().next();
        for call in self.code.calls().filter(|c| body.as_ref().is_none_or(|b| b.contains(&c.name))) {
            let arguments = self.code.elements(call.open);
            let attaches = matches!(
                self.code.word(call.name),
                Some("attachShader" | "glAttachShader" | "attach_shader" | "AttachShader")
            );
            match arguments.as_slice() {
                [program, shader] if attaches && self.code.variable(program).as_deref() == Some(variable) => {
                    self.gather(shader, depth - 1, &mut found);
                }
                _ if !attaches && self.code.receiver(call).as_deref() == Some(variable) => {
                    arguments.iter().for_each(|a| self.gather(a, depth.min(2) - 1, &mut found));
                }
                _ => {}
            }
        }
        found
    }

    /// The program of a file that makes one of all its shaders.
    fn whole(&self) -> ProgramSource {
        let code = self.code;
        let makes = |at: &usize| {
            matches!(code.word(*at), Some("createProgram" | "glCreateProgram" | "create_program" | "CreateProgram"))
                && code.is_mark(at + 1, '(')
        };
        let mains = code.file.text().matches("void main").count();
        let with_main = self.shaders.iter().filter(|s| s.stage != Stage::Library).count();
        let mut refs: BTreeSet<ShaderRef> = BTreeSet::new();
        for (at, token) in code.tokens.iter().enumerate() {
            if let Token::String { place, .. } = token {
                refs.extend(self.text(at, *place));
            }
        }
        let one = (0..code.tokens.len()).filter(makes).count() <= 1 && mains == with_main;
        if one { self.named(refs) } else { ProgramSource::Unknown }
    }

    /// A vertex and a fragment shader, with at most one of each other stage.
    pub fn named(&self, refs: BTreeSet<ShaderRef>) -> ProgramSource {
        let stage = |r: &ShaderRef| match r {
            ShaderRef::Embedded(index) => self.shaders.get(*index).map(|s| s.stage),
            ShaderRef::File(name) => Stage::from_path(name).filter(|s| *s != Stage::Library),
        };
        let stages: Vec<Option<Stage>> = refs.iter().map(stage).collect();
        let distinct = stages.iter().enumerate().all(|(i, s)| s.is_none() || !stages[..i].contains(s));
        let whole = stages.iter().all(|s| *s != Some(Stage::Library));
        if distinct && whole && refs.len() > 1 {
            ProgramSource::Named(refs.into_iter().collect())
        } else {
            ProgramSource::Unknown
        }
    }
}

/// What is done with a variable itself.
enum Own {
    /// It is made of these.
    Shaders(BTreeSet<ShaderRef>),
    /// Of something that is not known.
    Unknown,
    /// It says nothing.
    Nothing,
}
