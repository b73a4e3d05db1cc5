//! Names of shader files in variables, members and macros.

use std::collections::BTreeMap;

use tree_sitter::Node;

use super::group::is_shader_name;
use super::program::has_parameter;
use super::tree::{arguments, bare, descendants, elements, enclosing_function, plain_string, write};
use crate::HostFile;
use crate::language::SHADER_EXTENSIONS;

/// The shader files that variables, members and macros of a file hold.
#[derive(Clone, Debug, Default)]
pub struct Constants {
    by_name: BTreeMap<String, Vec<Constant>>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Constant {
    path: String,
    /// The function that declares it; none for a member, a macro or a variable outside functions.
    function: Option<usize>,
}

impl Constants {
    /// All of a file.
    pub fn of(host: &HostFile) -> Self {
        let mut found = Self::default();
        let text = host.file.text();
        let named = |ending: &&&str| text.match_indices('"').any(|(at, _)| text[..at].ends_with(**ending));
        if SHADER_EXTENSIONS.iter().find(named).is_none() {
            return found;
        }
        for node in host.root().into_iter().flat_map(descendants) {
            let Some((name, path)) = write(node)
                .filter(|_| may_hold_text(host, node))
                .and_then(|w| Some((last(host.text(w.target)), path(host, w.value)?)))
                .or_else(|| defined(host, node))
            else {
                continue;
            };
            // What is set and not declared in a function is a member, or comes from outside.
            let declares = write(node).is_some_and(|w| w.declares);
            let function = enclosing_function(node).filter(|_| declares).map(|f| f.id());
            let all = found.by_name.entry(name.to_owned()).or_default();
            let constant = Constant { path, function };
            if !all.contains(&constant) {
                all.push(constant);
            }
        }
        found
    }

    /// The file that a name means where it is used; none when it may be one of several.
    pub fn path(&self, host: &HostFile, name: Node<'_>) -> Option<&str> {
        let all = self.by_name.get(last(host.text(name)))?;
        let around = enclosing_function(name);
        if around.is_some_and(|f| has_parameter(host, f, host.text(name))) {
            return None;
        }
        let function = around.map(|f| f.id());
        let of = |function: Option<usize>| {
            let mut meant = all.iter().filter(move |c| c.function == function);
            meant.next().map(|c| (c, meant.next().is_none()))
        };
        let own = of(function).or_else(|| of(None));
        own.filter(|(_, only)| *only).map(|(c, _)| c.path.as_str())
    }
}

/// The last part of `this->name`, `Class::name` and `object.name`.
fn last(name: &str) -> &str {
    name.rsplit(['>', ':', '.']).next().unwrap_or(name).trim()
}

/// The macro that a `#define` makes of a shader's name: `#define SHADER "a.vert"`.
fn defined<'t>(host: &'t HostFile, node: Node<'t>) -> Option<(&'t str, String)> {
    if node.kind() != "preproc_def" {
        return None;
    }
    let name = node.child_by_field_name("name")?;
    let value = host.text(node.child_by_field_name("value")?).trim();
    let path = value.strip_prefix('"')?.strip_suffix('"')?;
    (!path.contains('"') && is_shader_name(path)).then(|| (host.text(name), path.to_owned()))
}

/// True for an assignment, and for a declaration of a text: `Shader s("a.vert")` holds none.
fn may_hold_text(host: &HostFile, node: Node<'_>) -> bool {
    const TEXTS: [&str; 6] = ["char", "string", "String", "path", "Path", "auto"];
    let declaration = match node.kind() {
        "assignment_expression" => return true,
        "init_declarator" => node.parent(),
        "field_declaration" => Some(node),
        _ => None,
    };
    let ty = declaration.and_then(|d| d.child_by_field_name("type")).map_or("", |t| host.text(t));
    TEXTS.iter().any(|t| ty.contains(t))
}

/// The one shader's name in a value that is a text: a literal, a sum, or a string made of one.
fn path(host: &HostFile, value: Node<'_>) -> Option<String> {
    let node = bare(value);
    if let Some((text, _)) = plain_string(node, &host.file) {
        return is_shader_name(text).then(|| text.to_owned());
    }
    match node.kind() {
        // The end of a path names the file.
        "binary_expression" => path(host, node.child_by_field_name("right")?),
        "concatenated_string" => path(host, elements(node).into_iter().last()?),
        "argument_list" => match elements(node).as_slice() {
            &[only] => path(host, only),
            _ => None,
        },
        "call_expression" => {
            let made = node.child_by_field_name("function")?;
            let text = ["string", "String", "QString", "path", "string_view"].contains(&last(host.text(made)));
            match arguments(node).as_slice() {
                &[only] if text => path(host, only),
                _ => None,
            }
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;

    #[test]
    fn a_constant_is_a_text_that_names_a_shader() {
        for (text, expected) in [
            ("const char* x = \"a.vert\"; void f() { load(x); }", Some("a.vert")),
            ("#define x \"a.vert\"\nvoid f() { load(x); }", Some("a.vert")),
            ("const std::string x{\"a.vert\"}; void f() { load(x); }", Some("a.vert")),
            ("void f() { std::string x = dir + \"a.vert\"; load(x); }", Some("a.vert")),
            ("void f() { auto x = std::string(\"a.vert\"); load(x); }", Some("a.vert")),
            ("struct S { const char* x = \"a.vert\"; void f() { load(x); } };", Some("a.vert")),
            ("struct S { std::string x; S() : x(\"a.vert\") {} void f() { load(x); } };", None),
            ("void f() { Shader x(\"a.vert\"); load(x); }", None),
            ("void f() { std::string x; x = \"a.vert\"; load(x); }", Some("a.vert")),
            ("const char* x = \"a.vert\"; void f(const char* x) { load(x); }", None),
            ("void f() { GLuint x = load(\"a.vert\"); load(x); }", None),
            ("const char* x = \"a.txt\"; void f() { load(x); }", None),
            ("void g() { auto x = \"b.vert\"; } void f() { load(x); }", None),
            ("#if A\n#define x \"a.vert\"\n#else\n#define x \"b.vert\"\n#endif\nvoid f() { load(x); }", None),
        ] {
            let host = HostFile::new(&SourceFile::new("a.cpp", text), true);
            let used = descendants(host.root().unwrap()).filter(|n| n.kind() == "identifier" && host.text(*n) == "x");
            assert_eq!(Constants::of(&host).path(&host, used.last().unwrap()), expected, "{text}");
        }
    }
}
