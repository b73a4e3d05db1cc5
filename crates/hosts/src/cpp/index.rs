//! What rules ask of a host file again and again, gathered in one walk over its tree.

use tree_sitter::Node;

use super::group::{Group, NAMES, groups};
use super::program::has_unknown_sources;
use super::tree::{Write, callee, declared_name, descendants, elements, enclosing_function, span, write};
use crate::HostFile;

/// Writes, calls, declarations and shader names of a file, in the order of the text.
pub struct Index<'t> {
    /// The file.
    pub host: &'t HostFile,
    /// The root of its tree.
    pub root: Node<'t>,
    /// Initialisations and assignments.
    pub writes: Vec<Write<'t>>,
    /// Calls of any kind.
    pub calls: Vec<Node<'t>>,
    /// Names of declared variables and parameters.
    pub declared: Vec<Node<'t>>,
    /// What takes each argument list: the name of a function or method, or of a constructed type.
    pub takers: Vec<&'t str>,
    /// Bodies of macros.
    macros: Vec<&'t str>,
    /// Shader files named in string literals.
    pub groups: Vec<Group<'t>>,
    /// True when the file holds shader text, or puts names of shaders together at run time.
    pub unknown_sources: bool,
}

impl<'t> Index<'t> {
    /// Walks over the tree; none when there is no tree.
    pub fn new(host: &'t HostFile) -> Option<Self> {
        let root = host.root()?;
        let (mut writes, mut calls, mut declared) = (Vec::new(), Vec::new(), Vec::new());
        let (mut takers, mut strings, mut macros) = (Vec::new(), Vec::new(), Vec::new());
        let mut names = Vec::new();
        let texts: Vec<&str> = host.embedded().iter().filter_map(|e| Some(e.variable.as_ref()?.0.as_str())).collect();
        for node in descendants(root).filter(Node::is_named) {
            writes.extend(write(node));
            match node.kind() {
                "call_expression" => calls.push(node),
                "declaration" | "parameter_declaration" => {
                    let mut cursor = node.walk();
                    declared.extend(node.children_by_field_name("declarator", &mut cursor).filter_map(declared_name));
                }
                "argument_list" | "parameter_list" => takers.extend(taker(host, node)),
                kind if NAMES.contains(&kind)
                    && (texts.contains(&host.text(node)) || host.constants().path(host, node).is_some()) =>
                {
                    names.push(node);
                }
                "preproc_arg" => macros.push(host.text(node)),
                "string_literal" | "raw_string_literal" | "concatenated_string" => strings.push(node),
                _ => {}
            }
        }
        let groups = groups(host, &strings, &names);
        let unknown_sources = has_unknown_sources(host, &strings, &macros);
        Some(Self { host, root, writes, calls, declared, takers, macros, groups, unknown_sources })
    }

    /// The writes to `variable` within `scope`, other than plain numbers and null: those only mark
    /// the variable as not yet set.
    pub fn values(&self, scope: Node<'t>, variable: &str) -> impl Iterator<Item = &Write<'t>> {
        self.writes
            .iter()
            .filter(move |w| within(scope, w.target))
            .filter(move |w| own(self.host.text(w.target)) == own(variable) && !is_empty_value(w.value))
    }

    /// Bodies of macros.
    pub fn macros(&self) -> &[&'t str] {
        &self.macros
    }

    /// How often `variable` is declared within `scope`.
    pub fn declarations(&self, scope: Node<'t>, variable: &str) -> usize {
        self.declared.iter().filter(|n| within(scope, **n) && self.host.text(**n) == variable).count()
    }

    /// How often the function of this name is called.
    pub fn call_count(&self, function: &str) -> usize {
        self.calls.iter().filter(|c| callee(**c, &self.host.file).is_some_and(|(name, _)| name == function)).count()
    }
}

/// What takes an argument list: `f` of `f(a)`, `p->f(a)` and `n::f(a)`, `T` of `T x(a)` and `new T(a)`.
pub fn taker<'t>(host: &'t HostFile, list: Node<'t>) -> Option<&'t str> {
    let parent = list.parent()?;
    let name = match parent.kind() {
        "call_expression" => parent.child_by_field_name("function")?,
        "new_expression" => parent.child_by_field_name("type")?,
        "init_declarator" => parent.parent()?.child_by_field_name("type")?,
        // `T x(a);` in a function reads as the declaration of a function x.
        "function_declarator" => {
            let declaration = parent.parent().filter(|d| d.kind() == "declaration")?;
            enclosing_function(declaration)?;
            declaration.child_by_field_name("type")?
        }
        _ => return None,
    };
    Some(host.text(last_part(name)))
}

/// The last name of `a.b`, `a->b` and `a::b`.
pub fn last_part(name: Node<'_>) -> Node<'_> {
    let mut name = name;
    while let Some(last) = name.child_by_field_name("field").or_else(|| name.child_by_field_name("name")) {
        name = last;
    }
    name
}

/// True when `node` lies in `scope`.
pub fn within(scope: Node<'_>, node: Node<'_>) -> bool {
    let (outer, inner) = (span(scope), span(node));
    outer.start <= inner.start && inner.end <= outer.end
}

/// A member without its object, when that is the own one.
fn own(name: &str) -> &str {
    name.strip_prefix("this->").unwrap_or(name)
}

fn is_empty_value(value: Node<'_>) -> bool {
    match value.kind() {
        "argument_list" | "initializer_list" => elements(value).into_iter().all(is_empty_value),
        "number_literal" | "null" => true,
        "unary_expression" => value.child_by_field_name("argument").is_some_and(|a| a.kind() == "number_literal"),
        _ => false,
    }
}
