//! The programs that a host file makes.

use super::attach::{attached, handed};
use super::index::Index;
use super::program::{ProgramSource, ShaderRef, is_call, one_each, whole};
use super::tree::{ancestors, arguments};
use crate::HostFile;

/// The programs of a host file, and the shaders that it names.
#[derive(Clone, Debug, Default)]
pub struct HostPrograms {
    /// Programs of two stages and more, each stage known.
    pub linked: Vec<Vec<ShaderRef>>,
    /// All shaders that the file names.
    pub named: Vec<ShaderRef>,
}

/// Finds the programs of a file.
pub fn find(host: &HostFile) -> HostPrograms {
    let Some(index) = Index::new(host) else { return HostPrograms::default() };
    let named: Vec<ShaderRef> = index.groups.iter().flat_map(|g| g.names.iter().cloned()).collect();
    let text = host.file.text();
    // Stages of separable programs meet at run time.
    if text.contains("GL_PROGRAM_SEPARABLE") || text.contains("glCreateShaderProgram") {
        return HostPrograms { linked: Vec::new(), named };
    }
    let mut linked: Vec<Vec<ShaderRef>> = index.groups.iter().filter(|g| g.closed).map(|g| g.names.clone()).collect();
    for &call in index.calls.iter().filter(|c| is_call(host, **c, "glLinkProgram")) {
        if let Some(shaders) = arguments(call).first().and_then(|program| attached(&index, call, *program)) {
            linked.push(shaders);
        }
    }
    linked.extend(by_method(&index));
    linked.extend(index.writes.iter().filter_map(|w| handed(&index, w.value)));
    linked.iter_mut().for_each(|p| {
        p.sort_unstable();
        p.dedup();
    });
    linked.retain(|p| p.len() > 1 && one_each(host, p));
    // A file about one program that attaches as many shaders as it names, though which one goes where is
    // not seen.
    let links = index.call_count("glLinkProgram").max(index.call_count("glCreateProgram"));
    if let (true, ProgramSource::Named(all)) = (linked.is_empty() && links == 1, whole(&index))
        && index.call_count("glAttachShader") == all.len()
    {
        linked.push(all);
    }
    linked.sort_unstable();
    linked.dedup();
    HostPrograms { linked, named }
}

/// Programs whose object is given its shaders one by one and then linked, all in one function and
/// without a condition.
fn by_method(index: &Index<'_>) -> Vec<Vec<ShaderRef>> {
    let mut found = Vec::new();
    for &call in &index.calls {
        let Some(function) = call.child_by_field_name("function").filter(|f| f.kind() == "field_expression") else {
            continue;
        };
        let (Some(object), Some(field)) =
            (function.child_by_field_name("argument"), function.child_by_field_name("field"))
        else {
            continue;
        };
        if !["link", "linkProgram", "Link"].contains(&index.host.text(field)) {
            continue;
        }
        let object = index.host.text(object);
        let own = super::tree::enclosing_function(call).map(|f| f.id());
        let groups: Vec<_> = index.groups.iter().filter(|g| g.receiver == Some(object) && g.function == own).collect();
        let links = index.calls.iter().filter(|c| {
            c.child_by_field_name("function").is_some_and(|f| index.host.text(f) == index.host.text(function))
                && super::tree::enclosing_function(**c).map(|f| f.id()) == own
        });
        let conditional =
            ancestors(call).take_while(|n| n.kind() != "function_definition").any(|n| n.kind() == "if_statement");
        if links.count() == 1 && !conditional && groups.iter().all(|g| g.closed) {
            found.push(groups.iter().flat_map(|g| g.names.iter().cloned()).collect());
        }
    }
    found
}
