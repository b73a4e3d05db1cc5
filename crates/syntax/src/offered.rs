//! What the version, the extensions and the stage of a shader offer it: built-in functions with their overloads, built-in
//! variables, types and keywords. For tools that complete and explain.

use super::builtin::{self, Absent, BuiltinFunction};
use super::language::{Language, NEVER};
use super::parser::words;
use super::symbols::Direction;
use super::types::Type;
use super::{Shader, Version};

/// One way to call a built-in function.
#[derive(Clone, Debug, PartialEq)]
pub struct Overload {
    /// Which way each parameter carries its value, and its type.
    pub params: Vec<(Direction, Type)>,
    /// What it returns.
    pub result: Type,
}

/// A built-in variable.
#[derive(Clone, Debug, PartialEq)]
pub struct OfferedVariable {
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub ty: Type,
    /// True when it must not be written.
    pub read_only: bool,
}

/// Since when the language has something.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Availability {
    /// This version and stage have it.
    Here,
    /// Other stages have it.
    OtherStage,
    /// This version does not have it any more.
    Removed,
    /// It came with these versions of desktop GLSL and GLSL ES, or with one of the extensions.
    Later {
        /// The version of desktop GLSL, if any.
        desktop: Option<u32>,
        /// The version of GLSL ES, if any.
        es: Option<u32>,
        /// Names of extensions, with `GL_`.
        extensions: Vec<String>,
    },
}

impl From<Option<Absent>> for Availability {
    fn from(absent: Option<Absent>) -> Self {
        match absent {
            None => Self::Here,
            Some(Absent::Stage) => Self::OtherStage,
            Some(Absent::Removed) => Self::Removed,
            Some(Absent::Later((desktop, es, extensions))) => Self::Later {
                desktop: Some(desktop).filter(|v| *v != NEVER),
                es: Some(es).filter(|v| *v != NEVER),
                extensions: extensions.iter().map(|e| format!("GL_{e}")).collect(),
            },
        }
    }
}

fn language(shader: &Shader) -> Language {
    Language::new(shader.version(), shader.extensions())
}

impl Shader {
    /// The built-in functions that this version and stage have.
    pub fn offered_functions(&self) -> Vec<BuiltinFunction> {
        let language = language(self);
        let here = |f: &&BuiltinFunction| builtin::function_absent(f.name(), self.stage(), &language).is_none();
        let has = |f: &&BuiltinFunction| !builtin::functions(f.name()).is_empty();
        BuiltinFunction::ALL.iter().filter(here).filter(has).copied().collect()
    }

    /// The overloads of a built-in function; those with `double` only where the version has it.
    pub fn overloads(&self, function: BuiltinFunction) -> Vec<Overload> {
        let language = language(self);
        let known = |ty: &Type| builtin::type_since(&ty.to_string()).is_none_or(|since| language.since(since));
        let all = builtin::functions(function.name())
            .iter()
            .map(|s| Overload { params: s.params.clone(), result: s.result.clone() });
        all.filter(|o| known(&o.result) && o.params.iter().all(|(_, ty)| known(ty))).collect()
    }

    /// The built-in variables that this version and stage have.
    pub fn offered_variables(&self) -> Vec<OfferedVariable> {
        let language = language(self);
        let here = |name: &&str| builtin::variable_absent(name, self.stage(), &language).is_none();
        let variable = |name: &'static str| {
            let found = builtin::variable(name, self.stage(), None)?;
            Some(OfferedVariable { name, ty: found.ty, read_only: found.read_only })
        };
        let mut all: Vec<_> = builtin::variable_names(self.stage()).filter(here).filter_map(variable).collect();
        all.sort_by_key(|v| v.name);
        all.dedup_by_key(|v| v.name);
        all
    }

    /// Whether this version and stage have a built-in function or variable, and since when others do.
    pub fn availability(&self, name: &str) -> Availability {
        let language = language(self);
        if name.starts_with("gl_") {
            return builtin::variable_absent(name, self.stage(), &language).into();
        }
        builtin::function_absent(name, self.stage(), &language).into()
    }

    /// The words with a meaning of their own in this version: keywords and names of types.
    pub fn offered_words(&self) -> Vec<String> {
        words::all(&language(self))
    }
}

/// A version as the text of a `#version` line names it.
impl std::fmt::Display for Version {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.profile {
            super::Profile::Es => write!(f, "GLSL ES {}.{:02}", self.number / 100, self.number % 100),
            super::Profile::Core | super::Profile::Compatibility => {
                write!(f, "GLSL {}.{:02}", self.number / 100, self.number % 100)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stage;
    use base::text::SourceFile;

    fn shader(text: &str, stage: Stage) -> Shader {
        Shader::parse(&SourceFile::new("a", text), stage).shader
    }

    #[test]
    fn version_and_stage_decide_what_is_offered() {
        let old = shader("#version 120\n", Stage::Fragment);
        let new = shader("#version 450\n", Stage::Fragment);
        let has = |s: &Shader, name: &str| s.offered_functions().iter().any(|f| f.name() == name);
        assert!(has(&old, "texture2D") && !has(&old, "fma") && has(&new, "fma") && has(&new, "dFdx"));
        assert!(!has(&shader("#version 450\n", Stage::Vertex), "dFdx"));
        let variable = |s: &Shader, name: &str| s.offered_variables().iter().any(|v| v.name == name);
        let es = shader("#version 300 es\n", Stage::Fragment);
        assert!(variable(&old, "gl_FragColor") && !variable(&es, "gl_FragColor") && variable(&es, "gl_FragCoord"));
        assert!(matches!(old.availability("fma"), Availability::Later { desktop: Some(400), .. }));
        let doubles = |s: &Shader| s.overloads(BuiltinFunction::Sqrt).iter().any(|o| o.result.to_string() == "double");
        assert!(doubles(&new) && !doubles(&old));
        let word = |s: &Shader, word: &str| s.offered_words().iter().any(|w| w == word);
        assert!(word(&new, "discard") && word(&new, "dmat3x4") && word(&new, "sampler2DArrayShadow"));
        assert!(!word(&old, "uvec2") && word(&old, "mat3"));
        assert_eq!(old.version().to_string(), "GLSL 1.20");
    }
}
