//! From desktop GLSL to the dialect that naga's own reader takes (Vulkan GLSL 4.50), as edits of the author's text.
//!
//! That reader is a front end under test: what it makes of the text is compared with the program, which comes from the
//! syntax tree. Only the interface is rewritten: the version line, locations, uniforms into blocks, the variables of a
//! geometry stage. Bodies stay as written. Every edit keeps the way back, so that a message of naga's stands at the
//! author's place.

mod declaration;
mod geometry;
mod guard;
mod limits;
mod role;
mod stage;
mod uniforms;

use std::collections::HashMap;

use base::text::{Edit, EditList, Edited, Span};
use syntax::{Shader, Stage};

pub use role::{Primitives, Role};

/// What to run of a shader.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// The stage itself.
    Stage,
    /// One function.
    Function(String),
}

/// Where the interface lies, by the author's names. A stage that is bound by a host has all of it.
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// Locations of inputs; `None` where nobody binds them, so that any will do.
    pub inputs: Option<HashMap<String, u32>>,
    /// Locations of outputs; `None` as above.
    pub outputs: Option<HashMap<String, u32>>,
    /// Group and binding of uniforms outside of blocks and of uniform blocks, these by instance or block name.
    pub uniforms: HashMap<String, (u32, u32)>,
}

/// Something that the dialect cannot express, or that naga's reader is known to take in another sense.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// Its place in the author's text.
    pub span: Span,
    /// What it is.
    pub why: String,
}

/// Rewrites the interface of a shader whose front end found no error.
///
/// # Errors
/// What stops it, in the order of the text.
pub fn lower(shader: &Shader, target: &Target, places: &Places) -> Result<Edited, Vec<Refused>> {
    let mut work = Lowering { shader, places, edits: EditList::new(), preamble: String::new(), refused: Vec::new() };
    guard::check(&mut work);
    limits::check(&mut work);
    uniforms::lower(&mut work);
    match (target, shader.stage()) {
        (Target::Function(_), _) => stage::function(&mut work),
        (Target::Stage, Stage::Vertex) => stage::vertex(&mut work),
        (Target::Stage, Stage::Geometry) => geometry::lower(&mut work),
        (
            Target::Stage,
            Stage::Fragment | Stage::Compute | Stage::TessControl | Stage::TessEvaluation | Stage::Library,
        ) => work.refuse(Span::at(0), format!("a {} shader as a stage", shader.stage().name())),
    }
    work.version();
    if !work.refused.is_empty() {
        work.refused.sort_by_key(|refused| refused.span.start);
        return Err(work.refused);
    }
    work.edits.apply(shader.file().text()).map_err(|conflict| {
        // Declarations that share a macro invocation end here: their parts have one and the same place.
        vec![Refused { span: Span::at(0), why: format!("the interface cannot be rewritten in place: {conflict}") }]
    })
}

/// A lowering under way.
struct Lowering<'s> {
    shader: &'s Shader,
    places: &'s Places,
    edits: EditList,
    /// Declarations that go behind the version line.
    preamble: String,
    refused: Vec<Refused>,
}

impl Lowering<'_> {
    fn refuse(&mut self, span: Span, why: impl Into<String>) {
        self.refused.push(Refused { span, why: why.into() });
    }

    fn slice(&self, span: Span) -> &str {
        self.shader.file().slice(span)
    }

    /// Writes the version line that naga wants, with the preamble behind it.
    fn version(&mut self) {
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
