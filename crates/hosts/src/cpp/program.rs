//! Which shaders a look-up speaks of.
//!
//! A program is known in one of these ways: its variable is written once, by a call that names shader
//! files or holds shader texts; its shaders are attached to it here; methods of its object are given
//! them; or the file names at most one shader of each stage altogether; or it names none and shaders of
//! its own name lie beside it, or are printed around it. In all other cases nothing is known, and rules are silent.

use tree_sitter::Node;

use syntax::Stage;

use super::attach::{attached, handed};
use super::group::{Group, is_shader_name};
use super::index::{Index, within};
use super::tree::{
    ancestors, bare, callee, declared_name, descendants, enclosing_function, plain_string, root_object, span,
};
use crate::HostFile;
use crate::marks::stage_of_path;

/// A shader as a host file names it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ShaderRef {
    /// A file, by its path as written.
    File(String),
    /// A text in the host file: its index among [`HostFile::embedded`].
    Embedded(usize),
}

impl ShaderRef {
    /// The stage, as the name or the text says.
    pub fn stage(&self, host: &HostFile) -> Option<Stage> {
        match self {
            Self::File(name) => stage_of_path(name),
            Self::Embedded(index) => host.embedded().get(*index).map(|e| e.stage),
        }
    }
}

/// Where the shaders of a program are named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProgramSource {
    /// In the host file: the stages, one each.
    Named(Vec<ShaderRef>),
    /// Nowhere; the shaders beside the host file may be meant.
    Beside,
    /// Not to be known from this file.
    Unknown,
}

/// Where the shaders of the program in a look-up are named: `call` is the look-up and `program` the
/// expression for its program. What is not known of the program itself is asked of the file as a whole.
pub fn source<'t>(index: &Index<'t>, call: Node<'t>, program: Node<'t>) -> ProgramSource {
    own_source(index, call, program).unwrap_or_else(|| whole(index))
}

/// As [`source`], from what is done with the program itself; none when that says nothing.
pub fn own_source<'t>(index: &Index<'t>, call: Node<'t>, program: Node<'t>) -> Option<ProgramSource> {
    match loader(index, call, program) {
        Loader::Value(value) => {
            let inside = span(pointee(index, value).unwrap_or(value));
            let mut all = index.groups.iter().filter(|g| inside.contains(g.start)).peekable();
            if all.peek().is_some() {
                let names = all.flat_map(|g| g.names.iter().cloned()).collect();
                return Some(if has_piece(index.host, value) {
                    ProgramSource::Unknown
                } else {
                    named(index.host, names)
                });
            }
            if let Some(shaders) = handed(index, value) {
                return Some(named(index.host, shaders));
            }
            // Made from something with a name that is no file: load("phong").
            if descendants(value).any(|n| n.kind().ends_with("string_literal")) {
                return Some(ProgramSource::Unknown);
            }
        }
        Loader::Several => return Some(ProgramSource::Unknown),
        Loader::Unknown => {}
    }
    let shaders = attached(index, call, program).or_else(|| given(index, call, program))?;
    Some(named(index.host, shaders))
}

/// The program of a file that is about one program as a whole, and names all that it loads.
pub fn whole(index: &Index<'_>) -> ProgramSource {
    if loads_unnamed(index)
        || index.unknown_sources
        || index.call_count("glCreateProgram") > 1
        || index.call_count("glLinkProgram") > 1
    {
        return ProgramSource::Unknown;
    }
    let embedded = (0..index.host.embedded().len()).map(ShaderRef::Embedded);
    let names: Vec<ShaderRef> = index.groups.iter().flat_map(|g| g.names.iter().cloned()).chain(embedded).collect();
    if names.is_empty() { ProgramSource::Beside } else { named(index.host, names) }
}

fn named(host: &HostFile, mut names: Vec<ShaderRef>) -> ProgramSource {
    names.sort_unstable();
    names.dedup();
    if one_each(host, &names) { ProgramSource::Named(names) } else { ProgramSource::Unknown }
}

/// True when no stage is named twice and each name says its stage.
pub fn one_each(host: &HostFile, names: &[ShaderRef]) -> bool {
    let stages: Option<Vec<Stage>> = names.iter().map(|n| n.stage(host)).collect();
    stages.is_some_and(|s| distinct(&s))
}

/// True when no stage is there twice.
pub fn distinct(stages: &[Stage]) -> bool {
    stages.iter().enumerate().all(|(i, s)| *s != Stage::Library && !stages[..i].contains(s))
}

/// The shaders that methods of the program's object are given: `prog.compileShader("a.vert")`.
fn given(index: &Index<'_>, call: Node<'_>, program: Node<'_>) -> Option<Vec<ShaderRef>> {
    let object = index.host.text(root_object(program));
    let own = enclosing_function(call).map(|f| f.id());
    let local = enclosing_function(call).is_some_and(|f| index.declarations(f, object) > 0);
    let of = |g: &&Group<'_>| g.receiver == Some(object) && (!local || g.function == own);
    let names: Vec<ShaderRef> = index.groups.iter().filter(of).flat_map(|g| g.names.iter().cloned()).collect();
    (!names.is_empty()).then_some(names)
}

/// True when a function that is given names of shaders is called without them elsewhere.
fn loads_unnamed(index: &Index<'_>) -> bool {
    index.groups.iter().filter_map(|g| g.taker).any(|taker| {
        let calls = index.takers.iter().filter(|t| **t == taker).count();
        let named = index.groups.iter().filter(|g| g.taker == Some(taker)).count();
        calls > named
    })
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
    // What another branch of an `#if` says is not compiled beside the look-up.
    all.retain(|value| !is_other_branch(*value, call) && !is_other_branch(call, *value));
    match all.as_slice() {
        [] => Loader::Unknown,
        &[value] => Loader::Value(value),
        _ => Loader::Several,
    }
}

/// True when a value names a text of GLSL that is no stage: a piece that is put before or into one.
fn has_piece(host: &HostFile, value: Node<'_>) -> bool {
    let names = descendants(value).filter_map(|n| plain_string(n, &host.file));
    names.map(|n| n.0).any(|n| !is_shader_name(n) && Stage::from_path(n) == Some(Stage::Library))
}

/// The value of the one object that a pointer is set to: `p = &shader;`.
fn pointee<'t>(index: &Index<'t>, value: Node<'t>) -> Option<Node<'t>> {
    let value = bare(value);
    let object = value.child_by_field_name("argument").filter(|o| o.kind() == "identifier")?;
    if value.kind() != "pointer_expression" || !index.host.text(value).starts_with('&') {
        return None;
    }
    let mut all = index.values(index.root, index.host.text(object));
    all.next().map(|w| w.value).filter(|_| all.next().is_none())
}

/// True when `one` stands in an `#else` or `#elif` of an `#if` whose other branches hold `other`.
fn is_other_branch(one: Node<'_>, other: Node<'_>) -> bool {
    ancestors(one).filter(|n| matches!(n.kind(), "preproc_else" | "preproc_elif")).any(|branch| {
        let whole = ancestors(branch).find(|n| matches!(n.kind(), "preproc_if" | "preproc_ifdef"));
        !within(branch, other) && whole.is_some_and(|whole| within(whole, other))
    })
}

/// True when a function has a parameter of that name.
pub fn has_parameter(host: &HostFile, function: Node<'_>, name: &str) -> bool {
    let Some(head) = function.child_by_field_name("declarator") else { return false };
    descendants(head)
        .filter(|n| n.kind() == "parameter_declaration")
        .filter_map(|p| p.child_by_field_name("declarator"))
        .filter_map(declared_name)
        .any(|n| host.text(n) == name)
}

/// True when string literals hold shader text that is no known shader, or parts of shaders' names, or
/// macros hold names.
pub fn has_unknown_sources(host: &HostFile, strings: &[Node<'_>], macros: &[&str]) -> bool {
    if macros.iter().flat_map(|m| m.split(['"', ' '])).any(is_shader_name) {
        return true;
    }
    let known = |n: &Node<'_>| host.embedded().iter().any(|e| e.place.contains(n.start_byte()));
    strings.iter().filter(|n| !known(n)).map(|n| host.text(*n)).any(|text| {
        let inner = text.trim_matches('"');
        let is_part = || [".vert", ".frag", ".geom", ".glsl"].iter().any(|e| inner.ends_with(e));
        text.contains("#version")
            || text.contains("gl_Position")
            || text.contains("void main")
            || (!is_shader_name(inner) && is_part())
    })
}

/// True when the call is one of this OpenGL function.
pub fn is_call(host: &HostFile, call: Node<'_>, function: &str) -> bool {
    callee(call, &host.file).is_some_and(|(name, _)| name == function)
}

/// The shader files that a host file names in string literals.
pub fn named_shaders(host: &HostFile) -> Vec<String> {
    let index = if host.concerns_shaders() { Index::new(host) } else { None };
    let groups = index.map(|i| i.groups).unwrap_or_default();
    let file = |r: ShaderRef| match r {
        ShaderRef::File(name) => Some(name),
        ShaderRef::Embedded(_) => None,
    };
    groups.into_iter().flat_map(|g| g.names).filter_map(file).collect()
}
