//! Calls that give an attribute its array, where the attribute is known.

use base::text::Span;
use reading::program::Program;
use reading::{Project, ShaderFile};
use syntax::interface::Variable;

use hosts::HostFile;
use hosts::cpp::index::Index;
use hosts::cpp::lookup::LookupKind;
use hosts::cpp::program::{ProgramSource, whole};
use hosts::cpp::tree::{arguments, bare, callee, plain_string, span};
use reading::program::resolve;

/// One such call.
pub struct Pointer<'a> {
    /// `glVertexAttribPointer`, `glVertexAttribIPointer` or `glVertexAttribLPointer`.
    pub function: String,
    /// Place of its name.
    pub place: Span,
    /// Its arguments.
    pub arguments: Vec<Span>,
    /// The attribute.
    pub variable: &'a Variable,
    /// The vertex shader.
    pub shader: &'a ShaderFile,
}

fn is_pointer(function: &str) -> bool {
    matches!(function, "glVertexAttribPointer" | "glVertexAttribIPointer" | "glVertexAttribLPointer")
}

/// The calls of a file: those with a location that is looked up by name, and those with a plain number
/// in a file about one program, whose shader or host code gives that number.
pub fn attributes<'a>(host: &'a HostFile, project: &'a Project) -> Vec<Pointer<'a>> {
    if !host.file.text().contains("glVertexAttrib") {
        return Vec::new();
    }
    let mut found = Vec::new();
    for lookup in host.lookups().iter().filter(|l| l.kind == LookupKind::Attribute && !l.partial) {
        let program = resolve(host, project, &lookup.source);
        let Some((shader, variable)) = program.and_then(|p| p.attribute(&lookup.name)) else { continue };
        for user in lookup.users.iter().filter(|u| is_pointer(&u.function) && u.position == 0) {
            let (function, place) = (user.function.clone(), user.function_span);
            found.push(Pointer { function, place, arguments: user.arguments.clone(), variable, shader });
        }
    }
    let Some(index) = Index::new(host) else { return found };
    let source = whole(&index);
    let named = matches!(source, ProgramSource::Named(_));
    let Some(program) = resolve(host, project, &source).filter(|p| named && p.is_complete()) else { return found };
    for &call in &index.calls {
        let Some((function, name)) = callee(call, &host.file).filter(|(f, _)| is_pointer(f)) else { continue };
        let all = arguments(call);
        let Some(number) = all.first().and_then(|a| host.text(bare(*a)).parse::<i64>().ok()) else { continue };
        let Some((shader, variable)) = at(&index, &program, number) else { continue };
        found.push(Pointer {
            function: function.to_owned(),
            place: span(name),
            arguments: all.into_iter().map(span).collect(),
            variable,
            shader,
        });
    }
    found
}

/// The attribute with this number: by its layout, or by `glBindAttribLocation`.
fn at<'p>(index: &Index<'_>, program: &Program<'p>, number: i64) -> Option<(&'p ShaderFile, &'p Variable)> {
    let shader = program.vertex()?;
    let inputs = &shader.shader.interface().inputs;
    let location = |v: &&Variable| {
        let entry = v.qualifiers.layout_entry("location").and_then(|e| e.value);
        entry.and_then(|e| shader.shader.fold(e)).and_then(syntax::Const::as_integer) == Some(number)
    };
    if let Some(variable) = inputs.iter().find(location) {
        return Some((shader, variable));
    }
    let host = index.host;
    let mut bound = index.calls.iter().filter_map(|c| {
        let (function, _) = callee(*c, &host.file)?;
        let all = arguments(*c);
        let name = plain_string(*all.get(2)?, &host.file)?.0;
        let same = host.text(bare(all[1])).parse() == Ok(number);
        (function == "glBindAttribLocation" && same).then_some(name)
    });
    let name = bound.next().filter(|_| bound.next().is_none())?;
    shader.shader.interface().input(name).map(|v| (shader, v))
}
