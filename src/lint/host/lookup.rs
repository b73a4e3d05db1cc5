//! Look-ups of uniforms and attributes by a name in a string literal.

use tree_sitter::Node;

use crate::text::Span;

use super::HostFile;
use super::feeds::{Feeds, feeds};
use super::index::Index;
use super::program::{ProgramSource, source};
use super::syntax::{arguments, callee, plain_string, span};

/// What is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookupKind {
    /// `glGetUniformLocation(program, "name")`
    Uniform,
    /// `glGetAttribLocation(program, "name")`
    Attribute,
    /// `glBindAttribLocation(program, index, "name")`
    BindAttribute,
}

impl LookupKind {
    /// The function of OpenGL.
    pub fn function(self) -> &'static str {
        match self {
            Self::Uniform => "glGetUniformLocation",
            Self::Attribute => "glGetAttribLocation",
            Self::BindAttribute => "glBindAttribLocation",
        }
    }

    fn of(function: &str) -> Option<Self> {
        [Self::Uniform, Self::Attribute, Self::BindAttribute].into_iter().find(|k| k.function() == function)
    }

    /// Number of arguments; the name is the last one.
    fn arity(self) -> usize {
        match self {
            Self::Uniform | Self::Attribute => 2,
            Self::BindAttribute => 3,
        }
    }
}

/// A look-up with a literal name.
pub struct Lookup {
    /// What is looked up.
    pub kind: LookupKind,
    /// Place of the function's name.
    pub function: Span,
    /// The name as written.
    pub name: String,
    /// Place of the name, without the quotation marks.
    pub name_span: Span,
    /// Where the shaders of its program are named.
    pub source: ProgramSource,
    /// What the location is used for.
    pub feeds: Feeds,
}

impl Lookup {
    /// Place of the name with its quotation marks.
    pub fn literal_span(&self) -> Span {
        Span::new(self.name_span.start - 1, self.name_span.end + 1)
    }

    /// The variable that the name speaks of: `light` of `light[2].position`.
    pub fn base_name(&self) -> &str {
        self.name.split(['.', '[']).next().unwrap_or(&self.name)
    }

    /// True for names that GL reserves; they never have a location.
    pub fn is_reserved(&self) -> bool {
        self.name.starts_with("gl_")
    }
}

/// All look-ups of a file, in the order of the text.
pub fn find(host: &HostFile) -> Vec<Lookup> {
    let Some(index) = Index::new(host) else { return Vec::new() };
    index.calls.iter().filter_map(|&call| lookup(&index, call)).collect()
}

fn lookup<'t>(index: &Index<'t>, call: Node<'t>) -> Option<Lookup> {
    let file = &index.host.file;
    let (function, function_node) = callee(call, file)?;
    let kind = LookupKind::of(function)?;
    let arguments = arguments(call);
    if call.has_error() || arguments.len() != kind.arity() {
        return None;
    }
    let (name, name_span) = plain_string(*arguments.last()?, file)?;
    Some(Lookup {
        kind,
        function: span(function_node),
        name: name.to_owned(),
        name_span,
        source: source(index, call, arguments[0]),
        feeds: feeds(index, call),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::SourceFile;

    #[test]
    fn literal_names_are_found_and_others_are_not() {
        let host = HostFile::new(
            &SourceFile::new(
                "a.cpp",
                r#"void f(const char *n) {
                    GLint a = glGetUniformLocation(p, "light[0].position");
                    GLint b = glGetAttribLocation(this->p, /* 頂点 */ "v");
                    glBindAttribLocation(p, 0, "w");
                    GLint c = glGetUniformLocation(p, n);
                    // glGetUniformLocation(p, "comment");
                    const char *s = "glGetUniformLocation(p, 'x')";
                }"#,
            ),
            true,
        );
        let found: Vec<_> =
            host.lookups().iter().map(|l| (l.kind, l.name.as_str(), l.base_name().to_owned())).collect();
        assert_eq!(
            found,
            [
                (LookupKind::Uniform, "light[0].position", "light".to_owned()),
                (LookupKind::Attribute, "v", "v".to_owned()),
                (LookupKind::BindAttribute, "w", "w".to_owned()),
            ]
        );
    }
}
