//! From an author's text to a program, in one step.

use std::sync::Arc;

use super::constants::Constants;
use super::{Program, ProgramError, contain};
use crate::lower::Target;
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
    /// Reads a text and builds a program of what `target` chooses of it. Nothing is built when the front end finds an
    /// error.
    ///
    /// # Errors
    /// [`ProgramError::Source`] with diagnostics at the author's places, and whatever `target` or
    /// [`Program::build`] refuses.
    pub fn from_source(
        file: &SourceFile,
        stage: Stage,
        target: impl FnOnce(&Shader) -> Result<Target, ProgramError>,
    ) -> Result<Self, ProgramError> {
        Self::from_source_with(file, stage, &[], target)
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
        defines: &[(String, String)],
        target: impl FnOnce(&Shader) -> Result<Target, ProgramError>,
    ) -> Result<Self, ProgramError> {
        let Parsed { shader, diagnostics } = Shader::parse_with(file, stage, defines);
        // An error of the grammar may have taken more of the text along than it stands at.
        let errors = diagnostics.into_iter().filter(|d| d.severity == Severity::Error);
        let fatal: Vec<Diagnostic> =
            errors.filter(|d| !OF_TYPES.contains(&d.code)).map(Diagnostic::at_origin).collect();
        if !fatal.is_empty() {
            return Err(ProgramError::Source(fatal));
        }
        let target = target(&shader)?;
        let built = contain(|| Self::build(&shader, &target));
        let program = built.unwrap_or_else(|panic| Err(ProgramError::Internal(panic)))?;
        Ok(Self { texts: vec![file.clone()], ..program })
    }

    fn of(shader: Shader, file: &SourceFile, target: &Target) -> Result<Self, ProgramError> {
        let program = Self::build(&shader, target).map_err(|error| match error {
            ProgramError::Source(found) => ProgramError::Source(found.into_iter().map(Diagnostic::at_origin).collect()),
            other => other,
        })?;
        let ranges = super::drawn::ranges(&shader);
        let constants = Arc::new(Constants::new(Arc::new(shader)));
        Ok(Self { texts: vec![file.clone()], ranges, constants, ..program })
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
