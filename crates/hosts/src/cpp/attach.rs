//! Shaders that are attached to a program object.

use tree_sitter::Node;

use super::creation::{Source, dominating, source_of};
use super::index::{Index, within};
use super::program::{ShaderRef, is_call};
use super::tree::{Write, arguments, bare, elements, enclosing_function, root_object, span};

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

/// A program has at most this many stages, and whatever else it is told.
const MOST: usize = 8;

/// The shaders whose objects a call or a constructor is given: `Program p(&vertex, &fragment)`, `link(list)`. None
/// when they are fewer than two.
pub fn handed<'t>(index: &Index<'t>, value: Node<'t>) -> Option<Vec<ShaderRef>> {
    let list = value.child_by_field_name("arguments").unwrap_or(value);
    if !matches!(list.kind(), "argument_list" | "initializer_list" | "parameter_list") {
        return None;
    }
    let given = elements(list);
    // Tables of anything else are long.
    if index.groups.len() < 2 || !(1..=MOST).contains(&given.len()) {
        return None;
    }
    let mut found = Vec::new();
    for given in given {
        match object(index, given) {
            Some(one) => found.push(one),
            None => found.extend(collected(index, given)?),
        }
    }
    (found.len() > 1).then_some(found)
}

/// The shader of `vertex`, `&vertex`, `*vertex`, `vertex.get()` and `std::move(vertex)`.
fn object<'t>(index: &Index<'t>, given: Node<'t>) -> Option<ShaderRef> {
    let mut node = bare(given);
    if let (Some(_), &[only]) = (node.child_by_field_name("function"), arguments(node).as_slice()) {
        node = bare(only);
    }
    // `Program p(vertex, fragment);` reads as a declaration: its arguments are types.
    let name = index.host.text(root_object(node)).trim_start_matches('*');
    let place = span(given);
    let is_local = |w: &&Write<'t>| w.declares && enclosing_function(w.target).is_some();
    let function = enclosing_function(given);
    let mut all: Vec<Node<'t>> = function.iter().flat_map(|f| index.values(*f, name)).map(|w| w.value).collect();
    if all.is_empty() {
        all = index.values(index.root, name).filter(|w| !is_local(w)).map(|w| w.value).collect();
    }
    match all.as_slice() {
        &[value] if span(value) != place => made(index, value),
        [] => {
            let mut given = index.groups.iter().filter(|g| g.receiver == Some(name)).flat_map(|g| &g.names);
            given.next().filter(|_| given.next().is_none()).cloned()
        }
        _ => None,
    }
}

/// The shaders in a list: those that it is made of and those that are added to it. Nothing for what can be none.
fn collected<'t>(index: &Index<'t>, given: Node<'t>) -> Option<Vec<ShaderRef>> {
    let node = bare(given);
    if node.kind() == "initializer_list" {
        return elements(node).into_iter().map(|e| object(index, e)).collect();
    }
    let host = index.host;
    let name = host.text(node);
    let function = enclosing_function(given)?;
    let mut found = Vec::new();
    for call in index.calls.iter().filter(|c| within(function, **c)) {
        let Some(method) = call.child_by_field_name("function").filter(|f| f.kind() == "field_expression") else {
            continue;
        };
        let adds = method.child_by_field_name("field").is_some_and(|f| ADDING.contains(&host.text(f)));
        if adds && method.child_by_field_name("argument").is_some_and(|a| host.text(a) == name) {
            let &[only] = arguments(*call).as_slice() else { return None };
            found.push(made(index, only).or_else(|| object(index, only))?);
        }
    }
    Some(found)
}

/// Methods that add to a list.
const ADDING: [&str; 5] = ["push_back", "emplace_back", "append", "add", "insert"];

/// The one shader that a call names: `load(GL_VERTEX_SHADER, "a.vert")`.
fn made(index: &Index<'_>, value: Node<'_>) -> Option<ShaderRef> {
    let inside = span(root_object(value)).to(span(value));
    let mut named = index.groups.iter().filter(|g| inside.contains(g.start)).flat_map(|g| &g.names);
    match (named.next(), named.next()) {
        (Some(one), None) => Some(one.clone()),
        _ => None,
    }
}
