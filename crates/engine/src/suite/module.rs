//! Texts that are read as modules, with the help of an assembler where they need one.

use super::compiled::{Asked, read_compiled};
use base::diagnostic::{Diagnostic, Severity};
use base::text::{SourceFile, Span};
use lanes::assembler::{self, AssembleError};
use program::{ModuleText, NAGA, ProgramError, Written};

/// Reads a text in WGSL or SPIR-V, or one that a compiler makes SPIR-V of.
///
/// # Errors
/// As of [`ModuleText::read`], and what the assembler says of a text in assembly.
pub fn read_module(file: &SourceFile) -> Result<ModuleText, ProgramError> {
    let written = Written::of(file);
    if written.is_compiled() {
        return read_compiled(file, &[], &[], &Asked::default()).map(|(text, _)| text);
    }
    if written != Written::SpirVAssembly {
        return ModuleText::read(file, written);
    }
    match assembler::assemble(file.text()) {
        Ok(words) => ModuleText::read_assembly(file, &words),
        Err(AssembleError::Refused { line, why }) => {
            let start: usize = file.text().split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
            let length = file.text()[start.min(file.text().len())..].lines().next().map_or(0, str::len);
            let span = Span::new(start, start + length);
            let message = format!("the assembler refuses this: {why}");
            Err(ProgramError::Source(vec![Diagnostic::new(NAGA, Severity::Error, file, span, message)]))
        }
        Err(AssembleError::Failed(why)) => Err(ProgramError::Unsupported { what: format!("{}: {why}", file.name()) }),
    }
}
