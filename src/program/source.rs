//! From an author's text to a program, in one step.

use naga::valid::ShaderStages;

use super::{Entry, Program, ProgramError};
use crate::diagnostic::{Diagnostic, Severity};
use crate::glsl::{Shader, Stage, link};
use crate::lower::{Target, lower};
use crate::text::SourceFile;

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
        let by_edits = lower(&parsed.shader, &target).map_err(ProgramError::Source).and_then(Self::new);
        // What edits in place do not make readable to naga is built from the syntax tree.
        let built = by_edits.and_then(Self::by_itself).or_else(|_| Self::build(&parsed.shader, &target));
        match built {
            Ok(program) => {
                let ranges = super::drawn::ranges(&parsed.shader);
                Ok(Self { texts: vec![file.clone()], ranges, ..program })
            }
            Err(ProgramError::Source(found)) => {
                Err(ProgramError::Source(found.into_iter().map(Diagnostic::at_origin).collect()))
            }
            Err(other) => Err(other),
        }
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
