//! Which shaders a look-up speaks of.
//!
//! A program is known in one of three ways: its variable is written once, by a call that names
//! shader files; or the file names at most one shader of each stage altogether; or it names none and
//! shaders of its own name lie beside it. In all other cases nothing is known, and rules are silent.

use tree_sitter::Node;

use crate::glsl::Stage;
use crate::glsl::interface::Variable;
use crate::lint::project::{Project, ShaderFile};

use super::HostFile;
use super::index::{Index, taker};
use super::lookup::Lookup;
use super::syntax::{ancestors, declared_name, descendants, enclosing_function, plain_string, root_object, span};

/// The stages of one program.
pub struct Program<'p> {
    shaders: Vec<&'p ShaderFile>,
    /// True when every stage is there, and nothing but its text decides its interface.
    complete: bool,
}

impl<'p> Program<'p> {
    /// The vertex stage, when its interface is known.
    pub fn vertex(&self) -> Option<&'p ShaderFile> {
        self.shaders.iter().copied().find(|s| s.shader.stage() == Stage::Vertex && is_plain(s))
    }

    /// The declaration of an attribute.
    pub fn attribute(&self, name: &str) -> Option<(&'p ShaderFile, &'p Variable)> {
        let vertex = self.vertex()?;
        vertex.shader.interface().input(name).map(|v| (vertex, v))
    }

    /// The first declaration of a uniform outside blocks.
    pub fn uniform(&self, name: &str) -> Option<(&'p ShaderFile, &'p Variable)> {
        self.shaders.iter().copied().find_map(|s| s.shader.interface().uniform(name).map(|v| (s, v)))
    }

    /// Names of all uniforms outside blocks.
    pub fn uniforms(&self) -> impl Iterator<Item = &'p str> + '_ {
        self.shaders.iter().copied().flat_map(|s| s.shader.interface().uniforms.iter().map(|v| v.name.as_str()))
    }

    /// True when a block, its instance or a member has this name, in any stage.
    pub fn in_block(&self, name: &str) -> bool {
        self.shaders.iter().flat_map(|s| &s.shader.interface().blocks).any(|block| {
            block.name.name == name
                || block.instance.as_ref().is_some_and(|i| i.name == name)
                || block.members.iter().any(|m| m.name.name == name)
        })
    }

    /// True when the interface of all stages is known, a vertex and a fragment stage (or a compute
    /// stage) among them: only then can a uniform be missing.
    pub fn is_complete(&self) -> bool {
        let has = |stage| self.shaders.iter().any(|s| s.shader.stage() == stage);
        self.complete && (has(Stage::Compute) || (has(Stage::Vertex) && has(Stage::Fragment)))
    }

    /// The files, for messages.
    pub fn names(&self) -> String {
        self.shaders.iter().map(|s| s.file.name()).collect::<Vec<_>>().join(", ")
    }
}

fn is_plain(shader: &ShaderFile) -> bool {
    shader.is_sound() && !shader.conditional
}

/// Where the shaders of a program are named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProgramSource {
    /// In the host file: the stages, one file each.
    Named(Vec<String>),
    /// Nowhere; the shaders beside the host file may be meant.
    Beside,
    /// Not to be known from this file.
    Unknown,
}

/// The program of a look-up, when it is known.
pub fn program<'p>(host: &HostFile, project: &'p Project, lookup: &Lookup) -> Option<Program<'p>> {
    let from = host.file.name();
    let found: Vec<Option<&ShaderFile>> = match &lookup.source {
        ProgramSource::Named(names) => names.iter().map(|n| project.shader_named(from, n)).collect(),
        ProgramSource::Beside => {
            let beside = project.shaders_beside(from);
            let names: Vec<&str> = beside.iter().map(|s| s.file.name()).collect();
            if !one_each(&names) {
                return None;
            }
            beside.into_iter().map(Some).collect()
        }
        ProgramSource::Unknown => return None,
    };
    let complete = found.iter().all(|s| s.is_some_and(is_plain));
    let shaders: Vec<&ShaderFile> = found.into_iter().flatten().collect();
    (!shaders.is_empty()).then_some(Program { shaders, complete })
}

/// Where the shaders of the program in a look-up are named.
pub fn source<'t>(index: &Index<'t>, call: Node<'t>, program: Node<'t>) -> ProgramSource {
    let named = |mut names: Vec<&str>| {
        names.sort_unstable();
        names.dedup();
        if one_each(&names) {
            ProgramSource::Named(names.into_iter().map(str::to_owned).collect())
        } else {
            ProgramSource::Unknown
        }
    };
    match loader(index, call, program) {
        Loader::Value(value) => {
            let inside = span(value);
            let names: Vec<&str> = index
                .groups
                .iter()
                .filter(|g| inside.contains(g.start))
                .flat_map(|g| g.names.iter().copied())
                .collect();
            if !names.is_empty() {
                return named(names);
            }
            // Made from something with a name that is no file: load("phong").
            if descendants(value).any(|n| n.kind().ends_with("string_literal")) {
                return ProgramSource::Unknown;
            }
        }
        Loader::Several => return ProgramSource::Unknown,
        Loader::Unknown => {}
    }
    // From here on the file as a whole has to be about one program, and name all that it loads.
    if loads_unnamed(index)
        || index.unknown_sources
        || index.call_count("glCreateProgram") > 1
        || index.call_count("glLinkProgram") > 1
    {
        return ProgramSource::Unknown;
    }
    let names: Vec<&str> = index.groups.iter().flat_map(|g| g.names.iter().copied()).collect();
    if names.is_empty() { ProgramSource::Beside } else { named(names) }
}

/// True when a function that is given names of shaders is called without them elsewhere.
fn loads_unnamed(index: &Index<'_>) -> bool {
    index.groups.iter().filter_map(|g| g.taker).any(|taker| {
        let calls = index.takers.iter().filter(|t| **t == taker).count();
        let named = index.groups.iter().filter(|g| g.taker == Some(taker)).count();
        calls > named
    })
}

/// True when no stage is named twice and each name says its stage.
fn one_each(names: &[&str]) -> bool {
    let stages: Vec<Option<Stage>> = names.iter().map(|n| Stage::from_path(n)).collect();
    stages.iter().enumerate().all(|(i, s)| s.is_some_and(|s| s != Stage::Library) && !stages[..i].contains(s))
}

/// Where the program of a look-up comes from.
enum Loader<'t> {
    /// Its variable is written once, with this value.
    Value(Node<'t>),
    /// It is written more than once.
    Several,
    /// It is not written here: a parameter, a member set elsewhere.
    Unknown,
}

fn loader<'t>(index: &Index<'t>, call: Node<'t>, program: Node<'t>) -> Loader<'t> {
    let host = index.host;
    let mut variable = host.text(root_object(program));
    if variable == "this" {
        variable = host.text(program);
    }
    let function = enclosing_function(call);
    let mut all: Vec<Node<'t>> = function.iter().flat_map(|f| index.values(*f, variable)).map(|w| w.value).collect();
    if all.is_empty() {
        if function.is_some_and(|f| has_parameter(host, f, variable)) {
            return Loader::Unknown;
        }
        // A variable that another function declares for itself is not this one.
        all = index
            .values(index.root, variable)
            .filter(|w| !(w.declares && enclosing_function(w.target).is_some()))
            .map(|w| w.value)
            .collect();
    }
    match all.as_slice() {
        [] => Loader::Unknown,
        &[value] => Loader::Value(value),
        _ => Loader::Several,
    }
}

fn has_parameter(host: &HostFile, function: Node<'_>, name: &str) -> bool {
    let Some(head) = function.child_by_field_name("declarator") else { return false };
    descendants(head)
        .filter(|n| n.kind() == "parameter_declaration")
        .filter_map(|p| p.child_by_field_name("declarator"))
        .filter_map(declared_name)
        .any(|n| host.text(n) == name)
}

/// Shader files named together: the arguments of one call, or one literal elsewhere.
pub struct Group<'t> {
    /// Offset of the first name.
    pub start: usize,
    /// The names.
    pub names: Vec<&'t str>,
    /// What takes the list of arguments that they stand in.
    taker: Option<&'t str>,
    /// The list, or the literal.
    node: usize,
}

/// The shader files that string literals name.
pub fn groups<'t>(host: &'t HostFile, strings: &[Node<'t>]) -> Vec<Group<'t>> {
    let mut groups: Vec<Group<'t>> = Vec::new();
    for &literal in strings {
        let Some((name, place)) = plain_string(literal, &host.file).filter(|(n, _)| is_shader_name(n)) else {
            continue;
        };
        if ancestors(literal).any(|a| a.kind() == "preproc_include") {
            continue;
        }
        let list = ancestors(literal).find(|a| matches!(a.kind(), "argument_list" | "initializer_list"));
        let node = list.map_or_else(|| literal.id(), |l| l.id());
        match groups.iter_mut().find(|g| g.node == node) {
            Some(group) => group.names.push(name),
            None => {
                let taker = list.and_then(|l| taker(host, l));
                groups.push(Group { start: place.start, names: vec![name], taker, node });
            }
        }
    }
    groups
}

/// True for a file name with a shader's ending, in one piece.
fn is_shader_name(text: &str) -> bool {
    let file = text.rsplit(['/', '\\']).next().unwrap_or(text);
    let stem = file.split('.').next().unwrap_or("");
    !stem.is_empty()
        && !text.contains(['%', '{', '*', '\n', ' '])
        && Stage::from_path(text).is_some_and(|s| s != Stage::Library)
        && !file.ends_with(".cs")
}

/// True when string literals hold shader text or parts of shaders' names, or macros hold names.
pub fn has_unknown_sources(host: &HostFile, strings: &[Node<'_>], macros: &[&str]) -> bool {
    if macros.iter().flat_map(|m| m.split(['"', ' '])).any(is_shader_name) {
        return true;
    }
    strings.iter().map(|n| host.text(*n)).any(|text| {
        let inner = text.trim_matches('"');
        let is_part = || [".vert", ".frag", ".geom", ".glsl"].iter().any(|e| inner.ends_with(e));
        text.contains("#version")
            || text.contains("gl_Position")
            || text.contains("void main")
            || (!is_shader_name(inner) && is_part())
    })
}

/// The shader files that a host file names in string literals.
pub fn named_shaders(host: &HostFile) -> Vec<String> {
    let groups = Index::new(host).map(|i| i.groups).unwrap_or_default();
    groups.into_iter().flat_map(|g| g.names).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lint::Input;
    use crate::text::SourceFile;

    /// Names of the shaders of the first look-up's program, and whether it is complete.
    fn resolve(host: &str, shaders: &[(&str, &str)]) -> Option<(String, bool)> {
        let mut inputs = vec![Input::new(SourceFile::new("m.cpp", host))];
        inputs.extend(shaders.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))));
        let project = Project::new(&inputs, &crate::lint::Config::default());
        let host = project.hosts().next().unwrap();
        program(host, &project, &host.lookups()[0]).map(|p| (p.names(), p.is_complete()))
    }

    const V: &str = "#version 150 core\nin vec4 p;\nvoid main() { gl_Position = p; }\n";
    const F: &str = "#version 150 core\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n";
    const LOOK: &str = "glGetAttribLocation(program, \"p\");";

    #[test]
    fn a_program_is_what_its_loader_names() {
        let host = format!(
            "void f() {{ GLuint q = load(\"b.vert\"); GLuint program = load(\"a.vert\", \"a.frag\"); {LOOK} }}"
        );
        let all = [("a.vert", V), ("a.frag", F), ("b.vert", V)];
        assert_eq!(resolve(&host, &all), Some(("a.frag, a.vert".to_owned(), true)));
        assert_eq!(resolve(&host, &[("a.vert", V)]), Some(("a.vert".to_owned(), false)), "a stage is not there");
        assert_eq!(resolve(&host, &[("b.vert", V)]), None, "no stage of it is there");
    }

    #[test]
    fn two_values_of_the_program_are_not_guessed_between() {
        let host = format!("void f() {{ GLuint program = load(\"a.vert\"); program = load(\"b.vert\"); {LOOK} }}");
        assert_eq!(resolve(&host, &[("a.vert", V), ("b.vert", V)]), None);
    }

    #[test]
    fn a_variable_of_another_function_does_not_count() {
        let host = format!(
            "void g() {{ GLuint program = load(\"b.vert\"); }} void f() {{ GLuint program = load(\"a.vert\"); {LOOK} }}"
        );
        assert_eq!(resolve(&host, &[("a.vert", V), ("b.vert", V)]).map(|p| p.0).as_deref(), Some("a.vert"));
    }

    #[test]
    fn a_parameter_is_not_the_variable_of_its_name_elsewhere() {
        let host = format!(
            "void f(GLuint program) {{ {LOOK} }} void g() {{ GLuint program = load(\"a.vert\"); GLuint q = load(\"b.vert\"); }}"
        );
        assert_eq!(resolve(&host, &[("a.vert", V), ("b.vert", V)]), None);
    }

    #[test]
    fn stages_attached_one_by_one_are_one_program_when_each_is_named_once() {
        let host = |second: &str| {
            format!(
                "void f() {{ GLuint program = glCreateProgram(); attach(program, \"a.vert\"); attach(program, \"a.frag\"); {second} {LOOK} }}"
            )
        };
        let all = [("a.vert", V), ("a.frag", F), ("b.vert", V)];
        assert_eq!(resolve(&host(""), &all), Some(("a.frag, a.vert".to_owned(), true)));
        assert_eq!(resolve(&host("attach(other, \"b.vert\");"), &all), None, "two vertex stages");
        assert_eq!(resolve(&host("GLuint o = glCreateProgram();"), &all), None, "two programs");
        assert_eq!(resolve(&host("load(dir + \".vert\");"), &all), None, "a name put together at run time");
        assert_eq!(resolve(&host("source = \"#version 150\";"), &all), None, "shader text of its own");
    }

    #[test]
    fn a_program_with_a_name_of_its_own_is_not_known() {
        let host = format!("void f() {{ GLuint program = load(\"phong\"); {LOOK} }}");
        assert_eq!(resolve(&host, &[("m.vert", V), ("m.frag", F)]), None);
    }

    #[test]
    fn a_loader_that_is_called_without_names_too_makes_the_file_unknown() {
        let host = |first: &str| {
            format!(
                "{first} void f() {{ GLuint program = load(VERT, FRAG); GLuint q = load(\"a.vert\", \"a.frag\"); {LOOK} }}"
            )
        };
        let all = [("a.vert", V), ("a.frag", F)];
        assert_eq!(resolve(&host(""), &all), None);
        let method = format!("void f() {{ x.load(name); y.load(\"a.vert\", \"a.frag\"); {LOOK} }}");
        assert_eq!(resolve(&method, &all), None);
        let object = format!("void f() {{ Shader x(name); Shader y(\"a.vert\", \"a.frag\"); {LOOK} }}");
        assert_eq!(resolve(&object, &all), None);
        let one = format!("void f(GLuint program) {{ Shader y(\"a.vert\", \"a.frag\"); {LOOK} }}");
        assert_eq!(resolve(&one, &all), Some(("a.frag, a.vert".to_owned(), true)));
        let in_macro =
            format!("#define VERT \"b.vert\"\nvoid f(GLuint program) {{ other(VERT); {LOOK} load(\"a.vert\"); }}");
        assert_eq!(resolve(&in_macro, &all), None);
    }

    #[test]
    fn without_names_the_shaders_beside_count() {
        let host = format!("void f() {{ {LOOK} }}");
        assert_eq!(resolve(&host, &[("m.vert", V), ("m.frag", F)]), Some(("m.frag, m.vert".to_owned(), true)));
        assert_eq!(resolve(&host, &[("sub/m.vert", V), ("n.vert", V)]), None);
    }

    #[test]
    fn a_shader_with_conditions_is_not_taken_for_known() {
        let host = format!("void f() {{ GLuint program = load(\"a.vert\", \"a.frag\"); {LOOK} }}");
        let conditional = "#version 150 core\n#ifdef A\nin vec4 q;\n#endif\nvoid main() {}\n";
        assert_eq!(resolve(&host, &[("a.vert", conditional), ("a.frag", F)]).map(|p| p.1), Some(false));
    }
}
