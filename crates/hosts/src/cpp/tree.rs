//! Small questions to a C++ syntax tree.

use tree_sitter::{Node, TreeCursor};

use base::text::{SourceFile, Span};

use crate::HostFile;

/// Bytes of a node.
pub fn span(node: Node<'_>) -> Span {
    Span::new(node.start_byte(), node.end_byte())
}

/// A node and all below it, parents first, in the order of the text. Needs no stack, so that deep
/// nesting does no harm.
pub fn descendants(root: Node<'_>) -> impl Iterator<Item = Node<'_>> {
    Preorder { cursor: root.walk(), depth: 0, done: false }
}

struct Preorder<'t> {
    cursor: TreeCursor<'t>,
    depth: usize,
    done: bool,
}

impl<'t> Iterator for Preorder<'t> {
    type Item = Node<'t>;

    fn next(&mut self) -> Option<Node<'t>> {
        if self.done {
            return None;
        }
        let node = self.cursor.node();
        if self.cursor.goto_first_child() {
            self.depth += 1;
            return Some(node);
        }
        loop {
            if self.depth == 0 {
                self.done = true;
                break;
            }
            if self.cursor.goto_next_sibling() {
                break;
            }
            self.cursor.goto_parent();
            self.depth -= 1;
        }
        Some(node)
    }
}

/// A node's ancestors, nearest first.
pub fn ancestors(node: Node<'_>) -> impl Iterator<Item = Node<'_>> {
    std::iter::successors(node.parent(), |n| n.parent())
}

/// The body of the innermost function around a node.
pub fn enclosing_function(node: Node<'_>) -> Option<Node<'_>> {
    ancestors(node).find(|n| n.kind() == "function_definition")
}

/// Name of the called function and its node, when the function is called by a plain or a qualified
/// name.
pub fn callee<'t>(call: Node<'t>, file: &'t SourceFile) -> Option<(&'t str, Node<'t>)> {
    if call.kind() != "call_expression" {
        return None;
    }
    let function = call.child_by_field_name("function")?;
    let name = match function.kind() {
        "identifier" => function,
        // `::glUniform1f` and the like.
        "qualified_identifier" => function.child_by_field_name("name").filter(|n| n.kind() == "identifier")?,
        _ => return None,
    };
    Some((file.slice(span(name)), name))
}

/// Arguments of a call, comments left out.
pub fn arguments(call: Node<'_>) -> Vec<Node<'_>> {
    call.child_by_field_name("arguments").map(elements).unwrap_or_default()
}

/// Named children that are not comments.
pub fn elements(list: Node<'_>) -> Vec<Node<'_>> {
    let mut cursor = list.walk();
    list.named_children(&mut cursor).filter(|n| n.kind() != "comment").collect()
}

/// The node without the parentheses, braces and casts around it.
pub fn bare(mut node: Node<'_>) -> Node<'_> {
    loop {
        let inner = match node.kind() {
            // `int a{ 1 };` says the same as `int a = 1;`.
            "parenthesized_expression" | "initializer_list" => match elements(node).as_slice() {
                &[inner] => Some(inner),
                _ => None,
            },
            "cast_expression" => node.child_by_field_name("value"),
            // static_cast<T>(x): a call of a template function with one argument.
            "call_expression"
                if node.child_by_field_name("function").is_some_and(|f| f.kind() == "template_function") =>
            {
                match arguments(node).as_slice() {
                    &[inner] => Some(inner),
                    _ => None,
                }
            }
            _ => None,
        };
        match inner {
            Some(inner) => node = inner,
            None => return node,
        }
    }
}

/// The outermost node that is `node` in parentheses and casts.
pub fn wrapped(mut node: Node<'_>) -> Node<'_> {
    while let Some(parent) = node.parent() {
        // The list of arguments lies between a static_cast and its argument.
        let parent = if parent.kind() == "argument_list" { parent.parent().unwrap_or(parent) } else { parent };
        if parent.id() == node.id() || bare(parent).id() != bare(node).id() {
            break;
        }
        node = parent;
    }
    node
}

/// Contents of a string literal with their place: without prefix, escapes and joined literals, so
/// that the text stands in the file as it is meant.
pub fn plain_string<'t>(node: Node<'t>, file: &'t SourceFile) -> Option<(&'t str, Span)> {
    let node = bare(node);
    let whole = span(node);
    let text = file.slice(whole);
    if node.kind() != "string_literal" || node.has_error() || text.contains('\\') {
        return None;
    }
    let inner = text.strip_prefix('"')?.strip_suffix('"')?;
    Some((inner, Span::new(whole.start + 1, whole.end - 1)))
}

/// The identifier in a declarator: `a` of `*a`, `a[3]`, `&a`, `a = 0`.
pub fn declared_name(declarator: Node<'_>) -> Option<Node<'_>> {
    let mut node = declarator;
    loop {
        match node.kind() {
            "identifier" | "field_identifier" => return Some(node),
            "init_declarator"
            | "pointer_declarator"
            | "array_declarator"
            | "function_declarator"
            | "parenthesized_declarator"
            | "reference_declarator" => {
                node = match node.child_by_field_name("declarator") {
                    Some(inner) => inner,
                    // References and parentheses hold their declarator without a field name.
                    None => elements(node).into_iter().last()?,
                };
            }
            _ => return None,
        }
    }
}

/// The value written and the name written to: an initialisation, or an assignment with `=`.
pub struct Write<'t> {
    /// What is written to.
    pub target: Node<'t>,
    /// The value, without parentheses and casts; an argument list in `T name(a, b);`.
    pub value: Node<'t>,
    /// True for an initialisation.
    pub declares: bool,
}

/// The write that a node is.
pub fn write(node: Node<'_>) -> Option<Write<'_>> {
    match node.kind() {
        "init_declarator" => Some(Write {
            target: declared_name(node)?,
            value: bare(node.child_by_field_name("value")?),
            declares: true,
        }),
        "assignment_expression" => {
            let operator = node.child_by_field_name("operator").map(|o| o.kind());
            let target = node.child_by_field_name("left")?;
            let value = bare(node.child_by_field_name("right")?);
            (operator == Some("=")).then_some(Write { target, value, declares: false })
        }
        // `C::C() : member(a, b)`
        "field_initializer" => match elements(node).as_slice() {
            &[target, value] => Some(Write { target, value: bare(value), declares: false }),
            _ => None,
        },
        "field_declaration" => Some(Write {
            target: declared_name(node.child_by_field_name("declarator")?)?,
            value: bare(node.child_by_field_name("default_value")?),
            declares: false,
        }),
        // `T x(a, b);` in a function reads as the declaration of a function.
        "declaration" => {
            let function = node.child_by_field_name("declarator").filter(|d| d.kind() == "function_declarator")?;
            enclosing_function(node)?;
            let value = function.child_by_field_name("parameters")?;
            let given = elements(value);
            let is_value =
                |p: &Node<'_>| p.kind() == "parameter_declaration" && p.child_by_field_name("declarator").is_none();
            let target = declared_name(function)?;
            (!given.is_empty() && given.iter().all(is_value)).then_some(Write { target, value, declares: true })
        }
        _ => None,
    }
}

/// The array or object that a chain of subscripts, members and calls starts from.
pub fn root_object(node: Node<'_>) -> Node<'_> {
    let mut node = bare(node);
    loop {
        let next = match node.kind() {
            "subscript_expression" | "field_expression" | "pointer_expression" => node.child_by_field_name("argument"),
            "call_expression" => node.child_by_field_name("function").filter(|f| f.kind() == "field_expression"),
            _ => None,
        };
        match next {
            Some(next) => node = bare(next),
            None => return node,
        }
    }
}

/// Names in `#include "name"` lines, those in conditional parts too.
pub fn quoted_includes(host: &HostFile) -> Vec<&str> {
    // One in a comment does no harm, and a look at the lines needs no tree.
    let path = |line: &'_ str| -> Option<(usize, usize)> {
        let rest = line.trim_start().strip_prefix('#')?.trim_start().strip_prefix("include")?;
        let start = line.len() - rest.trim_start().strip_prefix('"')?.len();
        Some((start, start + line[start..].find('"')?))
    };
    host.file.text().lines().filter_map(|line| path(line).map(|(start, end)| &line[start..end])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn host(text: &str) -> HostFile {
        HostFile::new(&SourceFile::new("a.cpp", text), true)
    }

    fn first<'t>(host: &'t HostFile, kind: &str) -> Node<'t> {
        descendants(host.root().unwrap()).find(|n| n.kind() == kind).unwrap()
    }

    #[test]
    fn every_node_is_visited_once() {
        let host = host("int a[2][3]; void f(int &x) { if (x) { a[0][1] = (int)x; } }");
        let root = host.root().unwrap();
        let ids: Vec<usize> = descendants(root).map(|n| n.id()).collect();
        let unique: std::collections::BTreeSet<_> = ids.iter().collect();
        assert_eq!((ids.len(), unique.len()), (root.descendant_count(), ids.len()));
        // A walk from an inner node stays inside it.
        let body = first(&host, "compound_statement");
        assert_eq!(descendants(body).count(), body.descendant_count());
    }

    #[test]
    fn casts_and_parentheses_are_seen_through() {
        for text in ["(f(1))", "(GLint)f(1)", "static_cast<GLint>(f(1))", "GLint(0), ((int)(f(1)))", "{ f(1) }"] {
            let host = host(&format!("void g() {{ x = {text}; }}"));
            let call = descendants(host.root().unwrap())
                .find(|&n| callee(n, &host.file).is_some_and(|(name, _)| name == "f"))
                .unwrap();
            assert_eq!(bare(wrapped(call)).id(), call.id(), "{text}");
        }
    }

    #[test]
    fn only_plain_literals_are_read() {
        for (text, expected) in [
            ("\"mc\"", Some("mc")),
            ("\"頂点\"", Some("頂点")),
            ("\"\"", Some("")),
            ("\"a\\n\"", None),
            ("R\"(a)\"", None),
            ("\"a\" \"b\"", None),
            ("name", None),
        ] {
            let host = host(&format!("void g() {{ f({text}); }}"));
            let argument = arguments(first(&host, "call_expression"))[0];
            assert_eq!(plain_string(argument, &host.file).map(|s| s.0), expected, "{text}");
        }
    }

    #[test]
    fn declarators_give_their_name() {
        for text in ["int a;", "int *a;", "int a[2][3];", "int a = 1;", "int *a[4];"] {
            let host = host(text);
            let declarator = first(&host, "declaration").child_by_field_name("declarator").unwrap();
            assert_eq!(declared_name(declarator).map(|n| host.text(n)), Some("a"), "{text}");
        }
        let host = host("void f(const int (&a)[2]) {}");
        let parameter = first(&host, "parameter_declaration").child_by_field_name("declarator").unwrap();
        assert_eq!(declared_name(parameter).map(|n| host.text(n)), Some("a"));
    }
}
