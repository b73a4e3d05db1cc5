//! Shaders that are named together in a host file.

use tree_sitter::Node;

use super::index::taker;
use super::program::ShaderRef;
use super::tree::{ancestors, bare, elements, enclosing_function, plain_string, root_object, span};
use crate::HostFile;
use crate::marks::stage_of_path;

/// Shaders named together: the arguments of one call, or one literal elsewhere.
pub struct Group<'t> {
    /// Offset of the first name.
    pub start: usize,
    /// The shaders.
    pub names: Vec<ShaderRef>,
    /// What takes the list of arguments that they stand in.
    pub taker: Option<&'t str>,
    /// The object whose method takes them.
    pub receiver: Option<&'t str>,
    /// The function in which they stand, as a node.
    pub function: Option<usize>,
    /// True for the arguments of one call that can hold no further shader.
    pub closed: bool,
    /// The list, or the literal.
    node: usize,
}

/// The shaders that string literals and names of shader texts mean; `strings` and `names` are the
/// literals and identifiers of the file.
pub fn groups<'t>(host: &'t HostFile, strings: &[Node<'t>], names: &[Node<'t>]) -> Vec<Group<'t>> {
    let mut groups: Vec<Group<'t>> = Vec::new();
    let files = strings.iter().filter_map(|&literal| {
        let (name, _) = plain_string(literal, &host.file).filter(|(n, _)| is_shader_name(n))?;
        Some((literal, ShaderRef::File(name.to_owned())))
    });
    let texts = strings.iter().chain(names).filter_map(|&node| Some((node, named(host, node)?)));
    let mut all: Vec<(Node<'t>, ShaderRef)> = files.chain(texts).collect();
    all.sort_by_key(|(node, _)| node.start_byte());
    for (literal, shader) in all {
        if ancestors(literal).any(|a| a.kind() == "preproc_include") {
            continue;
        }
        let list = ancestors(literal).find(|a| LISTS.contains(&a.kind()));
        let is_name = NAMES.contains(&literal.kind());
        if is_name && list.is_none_or(|l| l.kind() == "initializer_list" && !initialises(l)) {
            continue;
        }
        let node = list.map_or_else(|| literal.id(), |l| l.id());
        if let Some(group) = groups.iter_mut().find(|g| g.node == node) {
            group.names.push(shader);
            continue;
        }
        groups.push(Group {
            start: span(literal).start,
            names: vec![shader],
            taker: list.and_then(|l| taker(host, l)),
            receiver: list.and_then(|l| receiver(host, l)),
            function: enclosing_function(literal).map(|f| f.id()),
            closed: list
                .is_some_and(|l| l.kind() != "initializer_list" && elements(l).iter().all(|a| is_plain(host, *a))),
            node,
        });
    }
    groups
}

/// Lists that may hold names of shaders; a declaration reads as one of a function where only names are given.
const LISTS: [&str; 3] = ["argument_list", "initializer_list", "parameter_list"];

/// Nodes that are a name.
pub const NAMES: [&str; 3] = ["identifier", "field_identifier", "type_identifier"];

/// True for the list of `T x{a, b}`, of `T{a, b}` and of a member's initialiser.
fn initialises(list: Node<'_>) -> bool {
    let parents = ["init_declarator", "compound_literal_expression", "field_initializer", "field_declaration"];
    list.parent().is_some_and(|p| parents.contains(&p.kind()))
}

/// The shader that a literal is, or that a name means.
fn named(host: &HostFile, node: Node<'_>) -> Option<ShaderRef> {
    let constant = || host.constants().path(host, node).map(|p| ShaderRef::File(p.to_owned()));
    embedded(host, node).or_else(|| NAMES.contains(&node.kind()).then(constant).flatten())
}

/// The shader text that a literal is, or that an identifier names.
fn embedded(host: &HostFile, node: Node<'_>) -> Option<ShaderRef> {
    let all = host.embedded();
    if !NAMES.contains(&node.kind()) {
        let list = ancestors(node).take(4).any(|a| a.kind() == "argument_list");
        let at = all.iter().position(|e| list && e.variable.is_none() && e.place.contains(node.start_byte()))?;
        return Some(ShaderRef::Embedded(at));
    }
    let name = host.text(node);
    let mut meant = all.iter().enumerate().filter(|(_, e)| e.variable.as_ref().is_some_and(|v| v.0 == name));
    match (meant.next(), meant.next()) {
        (Some((i, _)), None) => Some(ShaderRef::Embedded(i)),
        _ => None,
    }
}

/// The object whose method takes a list of arguments.
fn receiver<'t>(host: &'t HostFile, list: Node<'t>) -> Option<&'t str> {
    let function = list.parent()?.child_by_field_name("function")?;
    let object = function.child_by_field_name("argument").filter(|_| function.kind() == "field_expression")?;
    Some(host.text(root_object(object)))
}

/// True for an argument that is a shader's name or text, or that can be none.
fn is_plain(host: &HostFile, argument: Node<'_>) -> bool {
    let mut node = bare(argument);
    if let Some(inner) = node.child_by_field_name("type").filter(|_| node.kind() == "parameter_declaration") {
        node = inner;
    }
    match node.kind() {
        "number_literal" | "true" | "false" | "null" | "string_literal" => true,
        "identifier" | "type_identifier" => {
            let text = host.text(node);
            text == "NULL" || text == "nullptr" || text.starts_with("GL_") || named(host, node).is_some()
        }
        "raw_string_literal" | "concatenated_string" => embedded(host, node).is_some(),
        "qualified_identifier" => super::creation::stage_constant(host.text(node)).is_some(),
        _ => false,
    }
}

/// True for a file name with a shader's ending, in one piece.
pub fn is_shader_name(text: &str) -> bool {
    let file = text.rsplit(['/', '\\']).next().unwrap_or(text);
    let stem = file.split('.').next().unwrap_or("");
    !stem.is_empty()
        && !text.contains(['%', '{', '*', '\n', ' '])
        && stage_of_path(text).is_some()
        && !file.ends_with(".cs")
}
