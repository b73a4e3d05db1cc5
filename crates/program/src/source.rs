//! From an author's text to a program, in one step.

use std::sync::Arc;

use naga::valid::ShaderStages;

use super::constants::Constants;
use super::{Entry, Program, ProgramError, contain};
use crate::lower::{Lowered, Target, lower};
use base::diagnostic::{Code, Diagnostic, Severity};
use base::text::SourceFile;
use syntax::{Parsed, Shader, Stage, errors, link};

/// Errors about one expression each, which is refused where a program uses it.
const OF_TYPES: [Code; 13] = [
    errors::UNKNOWN_NAME,
    errors::UNKNOWN_FUNCTION,
    errors::NO_OVERLOAD,
    errors::ASSIGN_TYPE,
    errors::OPERAND_TYPE,
    errors::UNKNOWN_FIELD,
    errors::CONSTRUCTOR,
    errors::TOO_MANY,
    errors::TOO_FEW,
    errors::ASSIGN_SIZE,
    errors::MATRIX_SIZE,
    errors::SCALAR_SWIZZLE,
    errors::SWIZZLE,
];

impl Program {
    /// Reads a text, lowers what `target` chooses of it, and makes a program. Nothing is lowered when
    /// the front end finds an error.
    ///
    /// # Errors
    /// [`ProgramError::Source`] with diagnostics at the author's places, and whatever `target` or
    /// [`Program::new`] refuses.
    pub fn from_source(
        file: &SourceFile,
        stage: Stage,
        target: impl FnOnce(&Shader) -> Result<Target, ProgramError>,
    ) -> Result<Self, ProgramError> {
        Self::from_source_with(file, stage, &[], target)
    }

    /// Refuses a function that discards or takes derivatives, which naga's reader leaves as they are.
    fn by_itself(self) -> Result<Self, ProgramError> {
        if let Entry::Function(function) = self.entry
            && !self.info[function].available_stages.contains(ShaderStages::COMPUTE)
        {
            return Err(ProgramError::Unsupported { what: "a function of a fragment stage".to_owned() });
        }
        Ok(self)
    }

    /// The same with macros that are given from outside: names and values.
    ///
    /// # Errors
    /// As of [`Program::from_source`].
    pub fn from_source_with(
        file: &SourceFile,
        stage: Stage,
        defines: &[(String, String)],
        target: impl FnOnce(&Shader) -> Result<Target, ProgramError>,
    ) -> Result<Self, ProgramError> {
        let parsed = Shader::parse_with(file, stage, defines);
        let errors: Vec<Diagnostic> = parsed
            .diagnostics
            .into_iter()
            .filter(|d| d.severity == Severity::Error)
            .map(Diagnostic::at_origin)
            .collect();
        if !errors.is_empty() {
            return Err(ProgramError::Source(errors));
        }
        let target = target(&parsed.shader)?;
        Self::of(parsed.shader, file, &target)
    }

    /// The program of a text that the language refuses, as far as what is refused is not part of it.
    ///
    /// # Errors
    /// What is refused or cannot be translated in the code that the program uses.
    pub fn from_faulty(
        file: &SourceFile,
        stage: Stage,
        target: impl FnOnce(&Shader) -> Result<Target, ProgramError>,
    ) -> Result<Self, ProgramError> {
        let Parsed { shader, diagnostics } = Shader::parse(file, stage);
        // An error of the grammar may have taken more of the text along than it stands at.
        let errors = diagnostics.into_iter().filter(|d| d.severity == Severity::Error);
        let fatal: Vec<Diagnostic> =
            errors.filter(|d| !OF_TYPES.contains(&d.code)).map(Diagnostic::at_origin).collect();
        if !fatal.is_empty() {
            return Err(ProgramError::Source(fatal));
        }
        let target = target(&shader)?;
        // The syntax tree alone: it has no type for what is refused, and naga's reader takes some of it in another sense.
        let built = contain(|| Self::build(&shader, &target));
        let program = built.unwrap_or_else(|panic| Err(ProgramError::Internal(panic)))?;
        Ok(Self { texts: vec![file.clone()], ..program })
    }

    fn of(shader: Shader, file: &SourceFile, target: &Target) -> Result<Self, ProgramError> {
        let by_edits = || {
            let read = lower(&shader, target).map_err(ProgramError::Source).and_then(Self::new);
            read.and_then(Self::by_itself)
        };
        let from_tree = || Self::build(&shader, target);
        // What edits in place do not make readable to naga is built from the syntax tree. So is what uses macros: to
        // naga's reader, what a macro writes stands in its `#define`.
        let built = if shader.file().has_expansions() {
            from_tree().or_else(|refused| by_edits().map_err(|_| refused))
        } else {
            by_edits().or_else(|_| from_tree())
        };
        match built {
            Ok(program) => {
                let ranges = super::drawn::ranges(&shader);
                let constants = Arc::new(Constants::new(Arc::new(shader)));
                Ok(Self { texts: vec![file.clone()], ranges, constants, ..program })
            }
            Err(ProgramError::Source(found)) => {
                Err(ProgramError::Source(found.into_iter().map(Diagnostic::at_origin).collect()))
            }
            Err(other) => Err(other),
        }
    }

    /// The text with the interface that naga reads, for translators that refuse the author's; none where that is the
    /// same, or cannot be had.
    pub fn rewritten(&self) -> Option<String> {
        let Lowered { file, edited, .. } = &self.lowered;
        if edited.text != file.text() {
            return Some(edited.text.clone());
        }
        // What uses macros was built from the syntax tree, and may be readable all the same.
        let shader = self.constants.shader().filter(|_| file.has_expansions())?;
        lower(shader, &Target::Stage).ok().map(|lowered| lowered.edited.text)
    }

    /// The same with several texts that are linked into one stage.
    ///
    /// # Errors
    /// As of [`Program::from_source`], and what does not go together of the texts.
    pub fn from_sources(
        files: &[SourceFile],
        stage: Stage,
        defines: &[(String, String)],
        target: impl FnOnce(&Shader) -> Result<Target, ProgramError>,
    ) -> Result<Self, ProgramError> {
        let joined = link::link(files, stage, defines).map_err(ProgramError::Source)?;
        let program = Self::from_source_with(&joined, stage, defines, target)?;
        Ok(Self { texts: files.to_vec(), ..program })
    }
}
