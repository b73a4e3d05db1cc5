//! Functions of a project that wrap those of OpenGL which take a name.

use rayon::prelude::*;
use tree_sitter::Node;

use super::lookup::unwrapped;
use super::presets::PRESETS;
use super::tree::{arguments, bare, declared_name, descendants, elements};
use crate::HostFile;
use crate::Setter;
use crate::{Wrapped, Wrapper};

/// Wrappers that call wrappers: a setter that asks another function for the location.
const ROUNDS: usize = 2;

/// The wrappers that a project defines: functions that hand one of their parameters on as the name of a uniform or
/// an attribute. Functions of one name that take it in different places, or for different things, are left out.
pub fn of_project<'p>(hosts: impl Iterator<Item = &'p HostFile>) -> Vec<Wrapper> {
    let asks = |h: &&HostFile| h.concerns_shaders() && ASKING.iter().any(|(name, _)| h.file.text().contains(name));
    let hosts: Vec<&HostFile> = hosts.filter(asks).collect();
    let mut found: Vec<Wrapper> = Vec::new();
    for _ in 0..ROUNDS {
        let new: Vec<Wrapper> = hosts.par_iter().flat_map_iter(|h| defined(h, &found)).collect();
        found.extend(new);
        found.sort_by(|a, b| {
            (&a.function, a.argument, a.kind as u8, &a.sets).cmp(&(&b.function, b.argument, b.kind as u8, &b.sets))
        });
        found.dedup();
    }
    let mut clear: Vec<Wrapper> = Vec::new();
    for same in found.chunk_by(|a, b| a.function == b.function) {
        let first = &same[0];
        let attribute = |w: &Wrapper| w.kind == Wrapped::AttributeLocation;
        if same.iter().any(|w| w.argument != first.argument || attribute(w) != attribute(first)) {
            continue;
        }
        let agreed = same.iter().all(|w| w.sets == first.sets);
        clear.push(Wrapper { sets: first.sets.clone().filter(|_| agreed), ..first.clone() });
    }
    clear
}

/// Functions of OpenGL with a program and a name.
const ASKING: [(&str, Wrapped); 2] =
    [("glGetUniformLocation", Wrapped::UniformLocation), ("glGetAttribLocation", Wrapped::AttributeLocation)];

fn defined(host: &HostFile, known: &[Wrapper]) -> Vec<Wrapper> {
    let functions = host.root().into_iter().flat_map(descendants).filter(|n| n.kind() == "function_definition");
    functions.filter_map(|f| wrapper(host, f, known)).collect()
}

fn wrapper(host: &HostFile, function: Node<'_>, known: &[Wrapper]) -> Option<Wrapper> {
    let head = descendants(function.child_by_field_name("declarator")?).find(|n| n.kind() == "function_declarator")?;
    let name = super::index::last_part(head.child_by_field_name("declarator")?);
    if !matches!(name.kind(), "identifier" | "field_identifier") {
        return None;
    }
    let parameters: Vec<Option<&str>> = elements(head.child_by_field_name("parameters")?)
        .into_iter()
        .map(|p| p.child_by_field_name("declarator").and_then(declared_name).map(|n| host.text(n)))
        .collect();
    let body = function.child_by_field_name("body")?;
    let calls: Vec<Node<'_>> = descendants(body).filter(|n| n.kind() == "call_expression").collect();
    let (kind, argument) = calls.iter().find_map(|call| {
        let called = host.text(super::index::last_part(call.child_by_field_name("function")?));
        let all = arguments(*call);
        let (kind, at) = match ASKING.iter().find(|(function, _)| *function == called) {
            Some((_, kind)) => (*kind, 1),
            None => known
                .iter()
                .find(|w| w.function == called && called != host.text(name))
                .map(|w| (w.kind, w.argument))
                .or_else(|| {
                    PRESETS.iter().find(|p| p.method == called && p.method != host.text(name)).map(|p| (p.kind, 0))
                })?,
        };
        let given = host.text(unwrapped(*all.get(at)?));
        Some((kind, parameters.iter().position(|p| *p == Some(given))?))
    })?;
    let mut setters: Vec<String> = calls
        .iter()
        .filter_map(|c| c.child_by_field_name("function"))
        .filter_map(|f| Setter::of_function(host.text(super::index::last_part(f)))?.type_name())
        .collect();
    setters.sort_unstable();
    setters.dedup();
    let sets = setters.pop().filter(|_| setters.is_empty());
    let kind = if sets.is_some() && kind == Wrapped::UniformLocation { Wrapped::SetUniform } else { kind };
    Some(Wrapper { function: host.text(bare(name)).to_owned(), kind, argument, sets })
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;

    fn found(text: &str) -> Vec<(String, Wrapped, usize, Option<String>)> {
        let host = HostFile::new(&SourceFile::new("shader.h", text), true);
        of_project([&host].into_iter()).into_iter().map(|w| (w.function, w.kind, w.argument, w.sets)).collect()
    }

    #[test]
    fn a_function_that_hands_its_parameter_on_is_a_wrapper() {
        for (text, expected) in [
            (
                "GLint Shader::place(const std::string& n) const { return glGetUniformLocation(id, n.c_str()); }",
                ("place", Wrapped::UniformLocation, 0, None),
            ),
            (
                "class S { void put(const char* n, float x) { glUniform1f(glGetUniformLocation(id, n), x); } };",
                ("put", Wrapped::SetUniform, 0, Some("float")),
            ),
            (
                "void upload(GLuint p, const char *n, M m) { glUniformMatrix4fv(glGetUniformLocation(p, n), 1, 0, m); }",
                ("upload", Wrapped::SetUniform, 1, Some("mat4")),
            ),
            (
                "GLint S::attr(QString n) { return glGetAttribLocation(id, n.toStdString().c_str()); }",
                ("attr", Wrapped::AttributeLocation, 0, None),
            ),
        ] {
            let (name, kind, argument, sets) = expected;
            assert_eq!(found(text), [(name.to_owned(), kind, argument, sets.map(str::to_owned))], "{text}");
        }
    }

    #[test]
    fn a_wrapper_of_a_wrapper_is_one_and_overloads_say_no_type() {
        let text = "int S::at(const char* n) { return glGetUniformLocation(id, n); }\n\
                    void S::put(const char* n, vec3 v) { glUniform3f(at(n), v.x, v.y, v.z); }\n\
                    void S::put(const char* n, float v) { glUniform1f(at(n), v); }";
        let names: Vec<_> = found(text).into_iter().map(|w| (w.0, w.1, w.3)).collect();
        let at = ("at".to_owned(), Wrapped::UniformLocation, None);
        assert_eq!(names, [at, ("put".to_owned(), Wrapped::SetUniform, None)]);
    }

    #[test]
    fn other_functions_are_none() {
        for text in [
            "int S::at(const char* n) { return glGetUniformLocation(id, \"x\"); }",
            "int S::at(const char* n) { std::string m = prefix + n; return glGetUniformLocation(id, m.c_str()); }",
            "int A::at(int i, const char* n) { return glGetUniformLocation(id, n); }\n\
             int B::at(const char* n) { return glGetUniformLocation(id, n); }",
        ] {
            assert!(found(text).is_empty(), "{text}");
        }
    }
}
