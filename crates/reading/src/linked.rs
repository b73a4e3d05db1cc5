//! What belongs together across files, for tools that navigate: the programs that shaders are linked into, and the
//! places at which host code names their variables.

use base::text::{SourceFile, Span};

use super::config::Config;
use hosts::{HostFile, LookupKind};

use super::program::resolve;
use super::project::{Input, Project};

/// The programs of a project and the names that its host code looks up.
#[derive(Clone, Debug, Default)]
pub struct Linked {
    /// Names of the shaders of each program whose stages are known for certain, in the order of the pipeline.
    pub programs: Vec<Vec<String>>,
    /// The names, in the order of files and places.
    pub names: Vec<HostName>,
}

/// A place at which host code names a variable of shaders in a string.
#[derive(Clone, Debug)]
pub struct HostName {
    /// The file.
    pub file: SourceFile,
    /// Place of the variable's name: `light` in `"light[2].position"`. Empty in an empty string.
    pub span: Span,
    /// Place of all that stands between the quotation marks.
    pub whole: Span,
    /// The variable's name.
    pub name: String,
    /// True for an attribute, false for a uniform; none where it may be either.
    pub attribute: Option<bool>,
    /// Names of the shaders of its program; empty where the program is not known.
    pub shaders: Vec<String>,
}

/// Finds what belongs together in a project.
pub fn linked(files: &[Input], config: &Config) -> Linked {
    let project = Project::new(files, config);
    let names = |shaders: &[&super::project::ShaderFile]| shaders.iter().map(|s| s.file.name().to_owned()).collect();
    let programs = project.programs().iter().map(|p| names(p.shaders())).collect();
    let names = project.hosts().flat_map(|host| names_of(host, &project)).collect();
    Linked { programs, names }
}

fn names_of(host: &HostFile, project: &Project) -> Vec<HostName> {
    let name = |lookup: &hosts::Lookup| {
        let base = Span::new(lookup.name_span.start, lookup.name_span.start + lookup.base_name().len());
        // Where host code stands in a document, that is the file.
        let (file, span, whole) = match &host.origin {
            None => (host.file.clone(), base, lookup.name_span),
            Some(o) => (o.host.clone(), o.literal.to_host(base), o.literal.to_host(lookup.name_span)),
        };
        // A name with escapes in it stands otherwise in the text.
        (file.slice(span) == lookup.base_name()).then(|| {
            let program = resolve(host, project, &lookup.source);
            let shaders = program.iter().flat_map(|p| p.shaders()).map(|s| s.file.name().to_owned()).collect();
            let attribute = match lookup.kind {
                LookupKind::Uniform => Some(false),
                LookupKind::Attribute | LookupKind::BindAttribute => Some(true),
                LookupKind::Name => None,
            };
            HostName { file, span, whole, name: lookup.base_name().to_owned(), attribute, shaders }
        })
    };
    host.lookups().iter().filter_map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_host_code_lead_to_the_shaders_of_their_program() {
        let files = [
            ("a.vert", "#version 330 core\nin vec4 p;\nvoid main() { gl_Position = p; }\n"),
            ("a.frag", "#version 330 core\nuniform vec4 tint;\nout vec4 c;\nvoid main() { c = tint; }\n"),
            ("b.frag", "#version 330 core\nuniform vec4 tint;\nout vec4 c;\nvoid main() { c = tint; }\n"),
            ("m.cpp", "void f() { GLuint q = load(\"a.vert\", \"a.frag\"); glGetUniformLocation(q, \"tint[0].x\"); }"),
        ];
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
        let linked = linked(&inputs, &Config::default());
        assert_eq!(linked.programs, [["a.vert", "a.frag"]]);
        let [name] = linked.names.as_slice() else { panic!("{:?}", linked.names) };
        assert_eq!(
            (name.name.as_str(), name.file.slice(name.span), name.file.slice(name.whole)),
            ("tint", "tint", "tint[0].x")
        );
        assert_eq!(
            (name.attribute, name.shaders.as_slice()),
            (Some(false), &["a.vert".to_owned(), "a.frag".to_owned()][..])
        );
    }
}
