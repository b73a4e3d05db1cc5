//! As which stage a shader text is compiled.

use tree_sitter::Node;

use base::text::Span;
use syntax::Stage;

use super::tree::{Write, arguments, bare, callee, descendants, enclosing_function, root_object, span, write};
use crate::HostFile;

/// A text to look for.
pub struct Source<'a> {
    /// The variable that holds it.
    pub variable: Option<&'a str>,
    /// Where the literal stands.
    pub place: Span,
}

/// The stage of `GL_VERTEX_SHADER`, `QOpenGLShader::Vertex` and the like.
pub fn stage_constant(text: &str) -> Option<Stage> {
    let last = text.rsplit("::").next().unwrap_or(text);
    let qt = text.contains("Shader::");
    Some(match last {
        "GL_VERTEX_SHADER" | "GL_VERTEX_SHADER_ARB" => Stage::Vertex,
        "GL_FRAGMENT_SHADER" | "GL_FRAGMENT_SHADER_ARB" => Stage::Fragment,
        "GL_GEOMETRY_SHADER" => Stage::Geometry,
        "GL_TESS_CONTROL_SHADER" => Stage::TessControl,
        "GL_TESS_EVALUATION_SHADER" => Stage::TessEvaluation,
        "GL_COMPUTE_SHADER" => Stage::Compute,
        "Vertex" if qt => Stage::Vertex,
        "Fragment" if qt => Stage::Fragment,
        "Geometry" if qt => Stage::Geometry,
        "TessellationControl" if qt => Stage::TessControl,
        "TessellationEvaluation" if qt => Stage::TessEvaluation,
        "Compute" if qt => Stage::Compute,
        _ => return None,
    })
}

/// For each source the stage that it is compiled as, with the place of the constant; none when it is
/// not found, or when there are two.
pub fn stages(host: &HostFile, root: Node<'_>, sources: &[Source<'_>]) -> Vec<Option<(Stage, Span)>> {
    if sources.is_empty() {
        return Vec::new();
    }
    let writes: Vec<Write<'_>> = descendants(root).filter_map(write).collect();
    let calls: Vec<Node<'_>> = descendants(root).filter(|n| n.kind() == "call_expression").collect();
    let mut found: Vec<Vec<(Stage, Span)>> = vec![Vec::new(); sources.len()];
    for &call in &calls {
        let all = arguments(call);
        let stage = if is(host, call, "glShaderSource") {
            all.first().and_then(|shader| created(host, &writes, *shader))
        } else {
            let mut constants =
                all.iter().filter_map(|a| stage_constant(host.text(bare(*a))).map(|s| (s, span(bare(*a)))));
            constants.next().filter(|_| constants.next().is_none())
        };
        let Some(stage) = stage else { continue };
        let meant: Vec<usize> = all.iter().filter_map(|a| source_of(host, &writes, sources, *a, 4)).collect();
        // With several texts it is not known which one the constant is about.
        if let &[only] = meant.as_slice()
            && let Some(list) = found.get_mut(only)
        {
            list.push(stage);
        }
    }
    found
        .into_iter()
        .map(|all| match all.as_slice() {
            [first, rest @ ..] if rest.iter().all(|r| r.0 == first.0) => Some(*first),
            _ => None,
        })
        .collect()
}

fn is(host: &HostFile, call: Node<'_>, function: &str) -> bool {
    callee(call, &host.file).is_some_and(|(name, _)| name == function)
}

/// The stage of the shader object that an expression means.
fn created(host: &HostFile, writes: &[Write<'_>], shader: Node<'_>) -> Option<(Stage, Span)> {
    let value = dominating(host, writes, shader, host.text(bare(shader)))?.value;
    if !is(host, value, "glCreateShader") {
        return None;
    }
    let constant = bare(*arguments(value).first()?);
    stage_constant(host.text(constant)).map(|s| (s, span(constant)))
}

/// Which source an expression means: its literal, `name`, `&name`, `name.c_str()`, or a variable that
/// was given one of these.
pub fn source_of(
    host: &HostFile,
    writes: &[Write<'_>],
    sources: &[Source<'_>],
    expression: Node<'_>,
    depth: usize,
) -> Option<usize> {
    let mut node = bare(expression);
    if node.kind() == "pointer_expression" {
        node = bare(node.child_by_field_name("argument")?);
    }
    let place = span(node);
    if let Some(i) = sources.iter().position(|s| s.place.start <= place.start && place.end <= s.place.end) {
        return Some(i);
    }
    let object = root_object(node);
    let name = host.text(object);
    let last = dominating(host, writes, node, name);
    if let Some(last) = &last {
        let value = span(last.value);
        let holds = |s: &Source<'_>| value.start <= s.place.start && s.place.end <= value.end;
        if let Some(i) = sources.iter().position(holds) {
            return Some(i);
        }
        let follows = last.value.kind() != "call_expression" || is_text_of(host, last.value);
        return if follows { source_of(host, writes, sources, last.value, depth.checked_sub(1)?) } else { None };
    }
    let mut named = sources.iter().enumerate().filter(|(_, s)| s.variable == Some(name));
    match (named.next(), named.next()) {
        (Some((i, _)), None) => Some(i),
        _ => None,
    }
}

/// True for `name.c_str()` and `name.data()`.
fn is_text_of(host: &HostFile, value: Node<'_>) -> bool {
    let field = value.child_by_field_name("function").and_then(|f| f.child_by_field_name("field"));
    field.is_some_and(|f| ["c_str", "data", "str"].contains(&host.text(f)))
}

/// The last write to `name` before `place` in the same function that is certainly carried out when
/// `place` is reached; none when one that may be carried out comes behind it.
pub fn dominating<'w, 't>(
    host: &HostFile,
    writes: &'w [Write<'t>],
    place: Node<'_>,
    name: &str,
) -> Option<&'w Write<'t>> {
    let function = enclosing_function(place).map(|f| f.id());
    let last = writes
        .iter()
        .filter(|w| w.target.end_byte() <= place.start_byte() && host.text(w.target) == name)
        .rfind(|w| enclosing_function(w.target).map(|f| f.id()) == function)?;
    let block =
        super::tree::ancestors(last.target).find(|n| matches!(n.kind(), "compound_statement" | "translation_unit"))?;
    let direct = super::tree::ancestors(last.target)
        .take_while(|n| n.id() != block.id())
        .all(|n| !matches!(n.kind(), "if_statement" | "for_statement" | "while_statement" | "case_statement"));
    (direct && super::index::within(block, place)).then_some(last)
}
