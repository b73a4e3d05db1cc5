//! From desktop GLSL to the dialect that naga reads, as edits of the author's text.
//!
//! Only the interface is rewritten: the version line, locations, uniforms into blocks, the variables
//! of a geometry stage. Bodies stay as written. Every edit keeps the way back, so that whatever is
//! said about the lowered text can be said about the author's.

mod declaration;
mod geometry;
mod guard;
mod limits;
mod lowered;
mod stage;
mod uniforms;

use base::diagnostic::{Code, Diagnostic, Message, Severity};
use base::text::{EditList, Span};
use syntax::{Shader, Stage};

pub use lowered::{Lowered, Primitives, Role, Variable};

/// A construct that the harness or the translator cannot express.
pub const UNSUPPORTED: Code = Code("E801");
/// The shader lacks something that running it needs.
pub const INCOMPLETE: Code = Code("E802");

/// What to run of a shader.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// The stage itself.
    Stage,
    /// One function.
    Function(String),
}

/// Lowers a shader whose front end found no error.
///
/// # Errors
/// Diagnostics at the author's places: what is not supported ([`UNSUPPORTED`]) and what is missing
/// ([`INCOMPLETE`]).
pub fn lower(shader: &Shader, target: &Target) -> Result<Lowered, Vec<Diagnostic>> {
    let mut work = Work { shader, edits: EditList::new(), preamble: String::new(), diagnostics: Vec::new() };
    guard::check(&mut work);
    limits::check(&mut work);
    let uniforms = uniforms::lower(&mut work);
    let (role, inputs, outputs) = match (target, shader.stage()) {
        (Target::Function(name), _) => {
            if shader.stage() == Stage::Vertex {
                stage::vertex(&mut work);
            }
            stage::function(&mut work, name)
        }
        (Target::Stage, Stage::Vertex) => stage::vertex(&mut work),
        (Target::Stage, Stage::Geometry) => geometry::lower(&mut work),
        (
            Target::Stage,
            Stage::Fragment | Stage::Compute | Stage::TessControl | Stage::TessEvaluation | Stage::Library,
        ) => {
            let message = format!("a {} shader cannot be run as a stage", shader.stage().name());
            work.unsupported(Span::at(0), message, "run one of its functions: `stage = \"function\"` and `entry`");
            (Role::Vertex, Vec::new(), Vec::new())
        }
    };
    work.version();
    if !work.diagnostics.is_empty() {
        work.diagnostics.sort_by_key(|d| d.span.start);
        return Err(work.diagnostics);
    }
    let edited = work.edits.apply(shader.file().text()).map_err(|conflict| {
        // Declarations that share a macro invocation end here: their parts have one and the same place.
        let message = format!("the interface cannot be rewritten in place: {conflict}");
        vec![Diagnostic::new(UNSUPPORTED, Severity::Error, shader.file(), Span::at(0), message)]
    })?;
    let (file, stage, defines) = (shader.file().clone(), shader.stage(), shader.defines().to_vec());
    Ok(Lowered { file, edited, stage, role, inputs, uniforms, outputs, defines })
}

/// A lowering under way.
struct Work<'s> {
    shader: &'s Shader,
    edits: EditList,
    /// Declarations that go behind the version line.
    preamble: String,
    diagnostics: Vec<Diagnostic>,
}

impl Work<'_> {
    fn unsupported(&mut self, span: Span, message: impl Into<Message>, help: &str) {
        let diagnostic =
            Diagnostic::new(UNSUPPORTED, Severity::Error, self.shader.file(), span, message).with_help(help);
        self.diagnostics.push(diagnostic);
    }

    fn incomplete(&mut self, span: Span, message: impl Into<Message>, help: &str) {
        let diagnostic =
            Diagnostic::new(INCOMPLETE, Severity::Error, self.shader.file(), span, message).with_help(help);
        self.diagnostics.push(diagnostic);
    }

    fn slice(&self, span: Span) -> &str {
        self.shader.file().slice(span)
    }

    /// Writes the version line that naga wants, with the preamble behind it.
    fn version(&mut self) {
        use base::text::Edit;
        let text = self.shader.file().text();
        let line = format!("#version 450 core\n{}", self.preamble);
        match self.shader.version().span {
            Some(span) => self.edits.push(Edit::replace(span, line.trim_end())),
            None => {
                // A byte order mark is not GLSL.
                let bom = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
                self.edits.push(Edit::replace(Span::new(0, bom), format!("{}\n", line.trim_end())));
            }
        }
    }
}

impl Primitives {
    /// Vertices of one input primitive.
    pub fn input_vertices(&self) -> u32 {
        self.input.vertices()
    }
}
