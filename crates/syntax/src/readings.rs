//! One text read again and again, with lines that define macros set otherwise.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Mutex, PoisonError};

use super::lexer::Pieces;
use super::preprocess::{self, Preprocessed};
use super::sink::Sink;
use super::{Parsed, Setting, Shader, lexed};

/// What compilers are given of texts, as numbers.
#[derive(Debug, Default)]
pub struct Seen(Mutex<HashSet<u64>>);

impl Seen {
    /// Notes what a reading gives to a compiler.
    pub fn add(&self, compiled: u64) {
        self.lock().insert(compiled);
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, HashSet<u64>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Readings of a text.
pub struct Readings<'a> {
    shader: &'a Shader,
    pieces: Pieces,
}

impl<'a> Readings<'a> {
    /// Readings of a shader in GLSL.
    pub fn of(shader: &'a Shader) -> Self {
        Self { shader, pieces: lexed(shader.file()) }
    }

    /// The text with lines as these settings have them, which stand in its order, and a number for what is compiled of it;
    /// none where that has been seen.
    pub fn read(&self, settings: &[Setting], seen: &Seen) -> Option<(u64, Parsed)> {
        let Shader { file, stage, defines, .. } = self.shader;
        let given = (defines.as_slice(), settings);
        let mut sink = Sink::new(file);
        let left = preprocess::run(&self.pieces, given, self.shader.assumed(), &mut sink);
        let compiled = self.compiled(&left, &sink);
        if seen.lock().contains(&compiled) {
            return None;
        }
        Some((compiled, Shader::checked(*stage, given, self.pieces.comments.clone(), left, sink)))
    }

    /// A number for what is compiled.
    fn compiled(&self, left: &Preprocessed, sink: &Sink) -> u64 {
        let mut hasher = DefaultHasher::new();
        sink.codes().for_each(|code| code.0.hash(&mut hasher));
        (self.shader.stage, left.version.number, left.version.profile, left.incomplete).hash(&mut hasher);
        left.extensions.iter().for_each(|e| (&e.name, &e.behavior).hash(&mut hasher));
        left.tokens.iter().for_each(|token| token.text(self.shader.file()).hash(&mut hasher));
        hasher.finish()
    }
}
