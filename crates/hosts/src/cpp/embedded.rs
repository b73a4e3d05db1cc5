//! Shaders in string literals of host files.

use tree_sitter::Node;

use base::text::Span;
use syntax::Stage;

use super::creation::{self, Source};
use super::stringized;
use super::tree::{ancestors, arguments, bare, descendants, span, wrapped, write};
use crate::marks;
use crate::{Body, HostFile, Literal, body};

/// A shader in literals of a host file.
#[derive(Clone, Debug)]
pub struct Embedded {
    /// Name for messages: the file's, `#`, and the variable's or the line.
    pub name: String,
    /// The variable that holds it, with the place of its name; none for a literal in a call.
    pub variable: Option<(String, Span)>,
    /// Its stage.
    pub stage: Stage,
    /// The stage that `glCreateShader` or a function like it is told, with that place.
    pub created_as: Option<(Stage, Span)>,
    /// The text and its places.
    pub literal: Literal,
    /// Place of the literals in the host file.
    pub place: Span,
    /// True when a template fills something in, or other texts are joined to it.
    pub partial: bool,
    /// True for a module in WGSL.
    pub wgsl: bool,
}

impl Embedded {
    /// Where the line of `#version` goes on though it should end: a literal without line break.
    pub fn run_on(&self) -> Option<usize> {
        let text = &self.literal.text;
        let start = text.find("#version")?;
        let line = text[start..].lines().next()?;
        let rest = line["#version".len()..].trim_start();
        let digits = rest.trim_start_matches(|c: char| c.is_ascii_digit());
        let number = line.len() - digits.len();
        let mut end = start + number;
        for profile in ["core", "compatibility", "es"] {
            if let Some(after) = digits.trim_start().strip_prefix(profile) {
                end = start + line.len() - after.len();
            }
        }
        let after = text[end..start + line.len()].trim_start();
        let comment = after.starts_with("//") || after.starts_with("/*");
        (!after.is_empty() && !comment).then_some(start + line.len() - after.len())
    }
}

/// A literal that may be a shader.
pub struct Candidate {
    /// The text and its places.
    pub literal: Literal,
    /// Place in the host file.
    pub place: Span,
    /// The variable that it is written to.
    pub variable: Option<(String, Span)>,
    /// True where the host joins texts of its own to it.
    pub joined: bool,
}

/// All shaders in literals of a file, in the order of the text. A literal that is only a part of a
/// shader, or whose stage cannot be found out, is none.
pub fn find(host: &HostFile) -> Vec<Embedded> {
    let text = host.file.text();
    let is_module = marks::ENTRY_POINTS.iter().any(|mark| text.contains(mark));
    if !text.contains("main") || !(text.contains("#version") || text.contains("gl_") || is_module) {
        return Vec::new();
    }
    let wanted = |text: &str| text.contains("main");
    named(host, &wanted, |Candidate { literal: Literal { text, .. }, joined, .. }| match () {
        () if *joined => None,
        () if is_whole(text) => Some(Whole::Shader),
        () if marks::is_module(text) && !has_placeholder(text) => Some(Whole::Module),
        () => None,
    })
}

/// Parts of shaders in literals of a file that have functions: their host puts a version or other texts in front of them.
pub fn pieces(host: &HostFile) -> Vec<Embedded> {
    let is_piece = |Candidate { literal: Literal { text, .. }, joined, .. }: &Candidate| {
        let other = (is_whole(text) && !joined) || has_placeholder(text) || syntax::is_wgsl(text);
        !other && (marks::has_main(text) || marks::is_part(&marks::without_comments(text)))
    };
    named(host, &|text| text.contains('{'), |candidate| is_piece(candidate).then_some(Whole::No))
}

/// Statements in literals of a file whose function its host writes, each with what it is kept in.
pub fn bodies(host: &HostFile) -> Vec<(Option<String>, Body)> {
    let wanted = |text: &str| text.contains(';') && ["vec", "mat", "gl_", "."].iter().any(|word| text.contains(word));
    let own = candidates(host, &wanted).into_iter().filter(|c| !has_placeholder(&c.literal.text));
    let mut found: Vec<(Option<String>, Body)> = own
        .filter_map(|Candidate { literal, variable, .. }| {
            let called = variable.map(|(name, _)| name);
            let body = Body::of(&literal, called.as_deref().unwrap_or(""))?;
            Some((called, body))
        })
        .collect();
    found.sort_by_key(|(_, body)| body.literal.place());
    found
}

/// What a literal is as it stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Whole {
    /// A stage in GLSL.
    Shader,
    /// A module in WGSL.
    Module,
    /// A part of a stage.
    No,
}

/// Literals that `wanted` may want.
fn candidates(host: &HostFile, wanted: &dyn Fn(&str) -> bool) -> Vec<Candidate> {
    let Some(root) = host.root() else { return Vec::new() };
    let mut candidates = stringized::find(host, root);
    let nodes: Vec<Node<'_>> = descendants(root).filter(|n| is_string(*n)).collect();
    for &node in nodes.iter().filter(|node| wanted(host.text(**node))) {
        let place = span(node);
        let in_other = |c: &Candidate| c.place.start <= place.start && place.end <= c.place.end;
        if !candidates.iter().any(in_other) {
            candidates.extend(candidate(host, node));
        }
    }
    candidates
}

/// Literals that `wanted` may want and `read` knows.
fn named(host: &HostFile, wanted: &dyn Fn(&str) -> bool, read: impl Fn(&Candidate) -> Option<Whole>) -> Vec<Embedded> {
    let Some(root) = host.root() else { return Vec::new() };
    let mut candidates: Vec<(Candidate, Whole)> =
        candidates(host, wanted).into_iter().filter_map(|c| read(&c).map(|whole| (c, whole))).collect();
    candidates.sort_by_key(|(c, _)| c.place);
    let sources: Vec<Source<'_>> = candidates
        .iter()
        .map(|(c, _)| Source { variable: c.variable.as_ref().map(|v| v.0.as_str()), place: c.place })
        .collect();
    let created = creation::stages(host, root, &sources);
    let mut found: Vec<Embedded> = Vec::new();
    for ((candidate, whole), created_as) in candidates.into_iter().zip(created) {
        let Candidate { literal, place, variable, .. } = candidate;
        let (partial, wgsl) = (whole == Whole::No, whole == Whole::Module);
        let by_name = || variable.as_ref().and_then(|v| Stage::of_name(&v.0));
        let said = marks::stage(&literal.text);
        let stage = match said {
            _ if wgsl => Some(Stage::Library),
            Ok(by_contents) => by_contents.or(created_as.map(|c| c.0)).or_else(by_name),
            Err(marks::Mixed) => None,
        };
        // A part of any stage has functions all the same, and so has a text of which nothing tells the stage.
        let is_open = || said.is_ok() && body::is_surely_of_a_shader(&marks::without_comments(&literal.text));
        let part = (partial && (!marks::has_main(&literal.text) || is_open())).then_some(Stage::Library);
        let Some(stage) = stage.or(part) else { continue };
        let line = host.file.position(place.start).line;
        let called = variable.as_ref().map_or_else(|| line.to_string(), |v| v.0.clone());
        let mut name = format!("{}#{called}", host.file.name());
        if found.iter().any(|e| e.name == name) {
            name = format!("{name}:{line}");
        }
        found.push(Embedded { name, variable, stage, created_as, literal, place, partial, wgsl });
    }
    found
}

/// True for the outermost node of a string.
fn is_string(node: Node<'_>) -> bool {
    matches!(node.kind(), "string_literal" | "raw_string_literal" | "concatenated_string")
        && node.parent().is_none_or(|p| !matches!(p.kind(), "concatenated_string" | "preproc_include"))
}

/// The literal as a possible shader, when it is all that its variable or argument holds.
fn candidate(host: &HostFile, node: Node<'_>) -> Option<Candidate> {
    // `"a" NAME "b"` reads as an error: a macro may stand for anything.
    let outside = ["compound_statement", "translation_unit", "function_definition", "field_declaration_list"];
    if ancestors(node).take_while(|n| !outside.contains(&n.kind())).any(|n| n.has_error()) {
        return None;
    }
    let whole = chain(node);
    let (literal, joined) = Literal::joined(&operands(whole), &host.file)?;
    let mut value = converted(host, wrapped(whole));
    let mut parent = value.parent()?;
    if parent.kind() == "initializer_list" {
        // Of `{ a, b }` each element is a string of its own; only one alone is surely a whole text.
        if parent.named_child_count() != 1 {
            return None;
        }
        value = wrapped(parent);
        parent = value.parent()?;
    }
    let variable = match parent.kind() {
        "init_declarator" | "assignment_expression" => {
            let target = write(parent)?.target;
            Some((host.text(target).to_owned(), span(target)))
        }
        "field_initializer" | "return_statement" => None,
        "argument_list" => match parent.parent() {
            // `std::string name("…");`
            Some(declarator) if declarator.kind() == "init_declarator" => {
                let target = write(declarator)?.target;
                Some((host.text(target).to_owned(), span(target)))
            }
            _ => None,
        },
        _ => return None,
    };
    Some(Candidate { literal, place: span(whole), variable, joined })
}

/// The sum of texts that a literal is a part of, or the literal.
fn chain(mut node: Node<'_>) -> Node<'_> {
    while let Some(sum) = wrapped(node).parent().filter(|up| up.kind() == "binary_expression")
        && sum.child_by_field_name("operator").is_some_and(|operator| operator.kind() == "+")
    {
        node = sum;
    }
    node
}

/// What a sum joins, in order.
fn operands(node: Node<'_>) -> Vec<Node<'_>> {
    let (mut found, mut open) = (Vec::new(), vec![bare(node)]);
    while let Some(node) = open.pop() {
        let sides = ["right", "left"].map(|side| node.child_by_field_name(side));
        match (node.kind(), sides) {
            ("binary_expression", [Some(right), Some(left)]) => open.extend([bare(right), bare(left)]),
            _ => found.push(node),
        }
    }
    found
}

/// The outermost call around `node` that only converts it: `std::string("…")`, `QString("…")`.
fn converted<'t>(host: &HostFile, node: Node<'t>) -> Node<'t> {
    let Some(list) = node.parent().filter(|p| p.kind() == "argument_list") else { return node };
    let Some(call) = list.parent().filter(|c| c.kind() == "call_expression") else { return node };
    let Some(function) = call.child_by_field_name("function") else { return node };
    let converts = match function.kind() {
        "identifier" => &["string", "QString", "QByteArray", "QStringLiteral", "strdup"][..],
        "qualified_identifier" => &["string"][..],
        _ => return node,
    };
    let name = function.child_by_field_name("name").unwrap_or(function);
    let text = host.text(name);
    let one = matches!(arguments(call).as_slice(), &[only] if bare(only).id() == bare(node).id());
    if one && converts.contains(&text) { wrapped(call) } else { node }
}

/// True for the text of a whole shader.
fn is_whole(text: &str) -> bool {
    if has_placeholder(text) || !marks::has_main(text) {
        return false;
    }
    match text.find("#version") {
        Some(at) => only_blank(&text[..at]) && !text[at + 1..].contains("#version"),
        // Without a version the text may be the end of a longer one, unless it is surely old, and states what precision it has
        // where it is for OpenGL ES.
        None => {
            let old = ["attribute", "varying", "gl_FragColor", "gl_Vertex", "gl_ModelViewProjectionMatrix"];
            let es = ["precision", "highp", "mediump", "lowp"];
            let of_es = es.iter().any(|w| marks::has_word(text, w));
            let states = text.split(';').any(|part| {
                let mut words = part.split_whitespace().skip_while(|word| *word != "precision");
                words.next().is_some() && words.nth(1) == Some("float")
            });
            old.iter().any(|w| marks::has_word(text, w)) && (!of_es || states)
        }
    }
}

/// True where a host fills something in.
fn has_placeholder(text: &str) -> bool {
    ["%s", "%d", "%i", "%u", "%f", "{{", "${", "@{"].iter().any(|mark| text.contains(mark))
}

fn only_blank(text: &str) -> bool {
    text.lines().map(str::trim).all(|l| l.is_empty() || l.starts_with("//"))
}
