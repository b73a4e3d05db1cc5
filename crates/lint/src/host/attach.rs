//! Shaders that are attached to a program object.

use tree_sitter::Node;

use super::creation::{Source, dominating, source_of};
use super::index::{Index, within};
use super::program::{ShaderRef, is_call};
use super::syntax::{arguments, bare, enclosing_function, root_object, span};

/// The shaders that `glAttachShader` adds to the program of a look-up, when each is known.
pub fn attached<'t>(index: &Index<'t>, call: Node<'t>, program: Node<'t>) -> Option<Vec<ShaderRef>> {
    let host = index.host;
    let name = host.text(bare(program));
    let function = enclosing_function(call);
    let local = function.filter(|f| index.declarations(*f, name) > 0);
    // Two programs that go by one name cannot be told apart.
    if index.declarations(index.root, name) > 1 && local.is_none() {
        return None;
    }
    let scope = local.unwrap_or(index.root);
    let attaching: Vec<Vec<Node<'t>>> = index
        .calls
        .iter()
        .filter(|c| within(scope, **c) && is_call(host, **c, "glAttachShader"))
        .map(|c| arguments(*c))
        .filter(|a| a.len() == 2 && host.text(bare(a[0])) == name)
        .collect();
    if attaching.is_empty() {
        return None;
    }
    attaching.iter().map(|arguments| shader(index, arguments[1])).collect()
}

/// The shader that the expression for a shader object means.
fn shader<'t>(index: &Index<'t>, object: Node<'t>) -> Option<ShaderRef> {
    let host = index.host;
    let object = bare(object);
    let value = if object.kind() == "call_expression" {
        object
    } else {
        dominating(host, &index.writes, object, host.text(object))?.value
    };
    if !is_call(host, value, "glCreateShader") {
        return made(index, value);
    }
    let name = host.text(object);
    let function = enclosing_function(object).map(|f| f.id());
    let mut sources = index.calls.iter().filter(|c| {
        is_call(host, **c, "glShaderSource")
            && c.start_byte() > value.end_byte()
            && enclosing_function(**c).map(|f| f.id()) == function
            && arguments(**c).first().is_some_and(|a| host.text(bare(*a)) == name)
            && index.writes.iter().all(|w| {
                host.text(w.target) != name
                    || w.target.start_byte() < value.start_byte()
                    || w.target.start_byte() > c.start_byte()
            })
    });
    let call = *sources.next()?;
    let all = arguments(call);
    let embedded = host.embedded();
    let texts: Vec<Source<'_>> = embedded
        .iter()
        .map(|e| Source { variable: e.variable.as_ref().map(|v| v.0.as_str()), place: e.place })
        .collect();
    if all.len() != 4 || host.text(bare(all[1])) != "1" {
        return None;
    }
    source_of(host, &index.writes, &texts, all[2], 4).map(ShaderRef::Embedded)
}

/// The one shader that a call names: `load(GL_VERTEX_SHADER, "a.vert")`.
fn made(index: &Index<'_>, value: Node<'_>) -> Option<ShaderRef> {
    let inside = span(root_object(value)).to(span(value));
    let mut named = index.groups.iter().filter(|g| inside.contains(g.start)).flat_map(|g| &g.names);
    match (named.next(), named.next()) {
        (Some(one), None) => Some(one.clone()),
        _ => None,
    }
}
