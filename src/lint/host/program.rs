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
use super::lookup::Lookup;
use super::syntax::{
    ancestors, callee, declared_name, descendants, enclosing_function, plain_string, root_object, span, write,
};

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

/// The program of a look-up, when it is known.
pub fn program<'p>(host: &HostFile, project: &'p Project, lookup: &Lookup<'_>) -> Option<Program<'p>> {
    let groups = groups(host);
    let from = host.file.name();
    let named = |names: &[&str]| -> Option<Program<'p>> {
        let found: Vec<Option<&ShaderFile>> = names.iter().map(|n| project.shader_named(from, n)).collect();
        let complete = found.iter().all(|s| s.is_some_and(is_plain));
        let shaders: Vec<&ShaderFile> = found.into_iter().flatten().collect();
        (!shaders.is_empty()).then_some(Program { shaders, complete })
    };
    match loader(host, lookup) {
        Loader::Value(value) => {
            let within = |g: &&Group<'_>| span(value).start <= g.start && g.start < span(value).end;
            let names: Vec<&str> = groups.iter().filter(within).flat_map(|g| g.names.iter().copied()).collect();
            if !names.is_empty() {
                return one_each(&names).then(|| named(&names)).flatten();
            }
            // Made from something with a name that is no file: load("phong").
            if descendants(value).any(|n| n.kind().ends_with("string_literal")) {
                return None;
            }
        }
        Loader::Several => return None,
        Loader::Unknown => {}
    }
    // From here on the file as a whole has to be about one program.
    if has_unknown_sources(host) || calls(host, "glCreateProgram") > 1 || calls(host, "glLinkProgram") > 1 {
        return None;
    }
    let mut names: Vec<&str> = groups.iter().flat_map(|g| g.names.iter().copied()).collect();
    names.sort_unstable();
    names.dedup();
    if !names.is_empty() {
        return one_each(&names).then(|| named(&names)).flatten();
    }
    let beside = project.shaders_beside(from);
    let stages: Vec<&str> = beside.iter().map(|s| s.file.name()).collect();
    let complete = beside.iter().all(|s| is_plain(s));
    (!beside.is_empty() && one_each(&stages)).then_some(Program { shaders: beside, complete })
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

fn loader<'t>(host: &'t HostFile, lookup: &Lookup<'t>) -> Loader<'t> {
    let object = root_object(lookup.program);
    let mut variable = host.text(object);
    if variable == "this" {
        variable = host.text(lookup.program);
    }
    let Some(root) = host.root() else { return Loader::Unknown };
    let writes = |scope: Node<'t>| {
        descendants(scope)
            .filter_map(write)
            .filter(|w| host.text(w.target) == variable && !matches!(w.value.kind(), "number_literal" | "null"))
            .collect::<Vec<_>>()
    };
    let function = enclosing_function(lookup.call);
    let mut all = function.map(writes).unwrap_or_default();
    if all.is_empty() {
        if function.is_some_and(|f| has_parameter(host, f, variable)) {
            return Loader::Unknown;
        }
        // A variable that another function declares for itself is not this one.
        all = writes(root);
        all.retain(|w| !(w.declares && enclosing_function(w.target).is_some()));
    }
    let all: Vec<Node<'t>> = all.into_iter().map(|w| w.value).collect();
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
struct Group<'t> {
    start: usize,
    names: Vec<&'t str>,
}

fn groups(host: &HostFile) -> Vec<Group<'_>> {
    let Some(root) = host.root() else { return Vec::new() };
    let mut groups: Vec<(usize, Group<'_>)> = Vec::new();
    for literal in descendants(root).filter(|n| n.kind() == "string_literal") {
        let Some((name, place)) = plain_string(literal, &host.file).filter(|(n, _)| is_shader_name(n)) else {
            continue;
        };
        if ancestors(literal).any(|a| a.kind() == "preproc_include") {
            continue;
        }
        let list = ancestors(literal).find(|a| matches!(a.kind(), "argument_list" | "initializer_list"));
        let id = list.map_or_else(|| literal.id(), |l| l.id());
        match groups.iter_mut().find(|(known, _)| *known == id) {
            Some((_, group)) => group.names.push(name),
            None => groups.push((id, Group { start: place.start, names: vec![name] })),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
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

/// True when the file holds shader text, or puts names of shaders together at run time.
fn has_unknown_sources(host: &HostFile) -> bool {
    let Some(root) = host.root() else { return true };
    descendants(root)
        .filter(|n| matches!(n.kind(), "string_literal" | "raw_string_literal" | "concatenated_string"))
        .map(|n| host.text(n))
        .any(|text| {
            let inner = text.trim_matches('"');
            text.contains("#version")
                || text.contains("gl_Position")
                || text.contains("void main")
                || (!is_shader_name(inner) && [".vert", ".frag", ".geom", ".glsl"].iter().any(|e| inner.ends_with(e)))
        })
}

fn calls(host: &HostFile, function: &str) -> usize {
    host.root().map_or(0, |root| {
        descendants(root).filter(|&n| callee(n, &host.file).is_some_and(|(name, _)| name == function)).count()
    })
}

/// The shader files that a host file names in string literals.
pub fn named_shaders(host: &HostFile) -> Vec<String> {
    groups(host).into_iter().flat_map(|g| g.names).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lint::Input;
    use crate::lint::host::lookup::lookups;
    use crate::text::SourceFile;

    /// Names of the shaders of the first look-up's program, and whether it is complete.
    fn resolve(host: &str, shaders: &[(&str, &str)]) -> Option<(String, bool)> {
        let mut inputs = vec![Input::new(SourceFile::new("m.cpp", host))];
        inputs.extend(shaders.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))));
        let project = Project::new(&inputs);
        let host = project.hosts().next().unwrap();
        let lookups = lookups(host);
        program(host, &project, &lookups[0]).map(|p| (p.names(), p.is_complete()))
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
        assert_eq!(resolve(&host, &all), Some(("a.vert, a.frag".to_owned(), true)));
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
