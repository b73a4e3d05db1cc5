//! H029: a loop fills an array that is declared nowhere, while the declared one stays empty.

use std::collections::{BTreeMap, BTreeSet};

use tree_sitter::Node;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::Project;

use hosts::HostFile;
use hosts::cpp::tree::{
    ancestors, arguments, bare, callee, declared_name, descendants, enclosing_function, quoted_includes, span, wrapped,
};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H029"),
    name: "filled-array-undeclared",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    let Some(root) = host.root() else { return };
    let functions = descendants(root).filter(|n| n.kind() == "function_definition");
    // Statements at file level, as a book prints them, are the body of a function that is not printed.
    let printed = host.is_fragment().then_some(root);
    for function in functions.chain(printed) {
        let is_printed = function.id() == root.id();
        if !is_printed && (function.has_error() || is_member(function)) {
            continue;
        }
        let empty = empty_arrays(host, function, is_printed);
        let [(array, declared, dims)] = empty.as_slice() else { continue };
        let filled = undeclared_filled(host, root, function);
        let [(name, uses)] = filled.as_slice() else { continue };
        let first = uses[0];
        if dims_of(first) != *dims || !is_unseen(host, project, name, &mut BTreeSet::new()) {
            continue;
        }
        if is_printed && is_declared_elsewhere(host, project, name) {
            continue;
        }
        let Some(place) = base(first) else { continue };
        let edits = uses.iter().filter_map(|&u| base(u)).map(|b| Edit::replace(span(b), *array)).collect();
        findings.push(
            findings
                .at(&host.file, span(place), message!("`{name}` is filled, but the array is declared as `{array}`", "`{name}` に書き込んでいますが、宣言された配列は `{array}` です"))
                .with_label(message!("declared nowhere", "宣言がありません"))
                .with_related(&host.file, span(*declared), message!("`{array}` is declared here and never filled", "`{array}` はここで宣言され、書き込まれていません"))
                .with_why(message!(
                    "`{name}` has no declaration, so that this does not compile, and nothing is ever written to `{array}`",
                    "`{name}` は宣言がないのでコンパイルできず、`{array}` には何も書き込まれません"
                ))
                .with_fix(message!("fill `{array}`", "`{array}` に書き込む"), Safety::Unsafe, edits),
        );
    }
}

/// The nodes of a function; of the root, those outside of all functions.
fn nodes(function: Node<'_>) -> impl Iterator<Item = Node<'_>> {
    let outside = function.parent().is_none();
    descendants(function).filter(move |n| !outside || enclosing_function(*n).is_none())
}

/// True when other host code says the name: a listing may go on where another one stops.
fn is_declared_elsewhere(host: &HostFile, project: &Project, name: &str) -> bool {
    let others =
        project.hosts().filter(|h| h.file.name() != host.file.name() && words(h.file.text()).any(|w| w == name));
    others.filter_map(|h| Some(mentions(h, h.root()?, name))).any(|count| count > 0)
}

/// True for a function of a class: the name may be a member, of a base class too.
fn is_member(function: Node<'_>) -> bool {
    let qualified = function
        .child_by_field_name("declarator")
        .is_some_and(|d| descendants(d).any(|n| n.kind() == "qualified_identifier"));
    qualified || ancestors(function).any(|a| matches!(a.kind(), "class_specifier" | "struct_specifier"))
}

/// Local arrays without initialiser that are only measured with `sizeof` and handed to OpenGL; of a printed
/// listing also those that are not used any more, since it may stop before they are.
fn empty_arrays<'t>(host: &'t HostFile, function: Node<'t>, is_printed: bool) -> Vec<(&'t str, Node<'t>, usize)> {
    nodes(function)
        .filter(|n| n.kind() == "declaration")
        .flat_map(|declaration| {
            let mut cursor = declaration.walk();
            declaration.children_by_field_name("declarator", &mut cursor).collect::<Vec<_>>()
        })
        .filter(|d| d.kind() == "array_declarator")
        .filter_map(|d| Some((d, declared_name(d)?)))
        .filter_map(|(declarator, name)| {
            let text = host.text(name);
            let mut handed = is_printed;
            for node in nodes(function).filter(|n| n.kind() == "identifier" && host.text(*n) == text) {
                if node.id() == name.id() || is_measured(node) {
                    continue;
                }
                if !is_handed_over(host, node) {
                    return None;
                }
                handed = true;
            }
            let dims = descendants(declarator).filter(|n| n.kind() == "array_declarator").count();
            handed.then_some((text, name, dims))
        })
        .collect()
}

fn is_measured(node: Node<'_>) -> bool {
    wrapped(node).parent().is_some_and(|p| p.kind() == "sizeof_expression")
}

/// True for an argument of a GL function that reads its memory.
fn is_handed_over(host: &HostFile, node: Node<'_>) -> bool {
    let argument = wrapped(node);
    let Some(call) = argument.parent().and_then(|list| list.parent()) else { return false };
    callee(call, &host.file).is_some_and(|(name, _)| {
        matches!(name, "glBufferData" | "glBufferSubData" | "glNamedBufferData" | "glNamedBufferSubData")
            || name.ends_with("Pointer")
    }) && arguments(call).iter().any(|a| a.id() == argument.id())
}

/// Names whose elements the function assigns and that nothing in the file declares, each with the
/// outermost subscripts in which it stands.
fn undeclared_filled<'t>(host: &'t HostFile, root: Node<'t>, function: Node<'t>) -> Vec<(&'t str, Vec<Node<'t>>)> {
    let mut filled: BTreeMap<&str, Vec<Node<'t>>> = BTreeMap::new();
    for subscript in nodes(function).filter(|n| n.kind() == "subscript_expression" && is_outermost(*n)) {
        if let Some(name) = base(subscript) {
            filled.entry(host.text(name)).or_default().push(subscript);
        }
    }
    filled.retain(|name, uses| {
        let assigned = uses.iter().all(|u| dims_of(*u) == dims_of(uses[0])) && uses.iter().any(|u| is_assigned(*u));
        // Every place of the name in the file has to be one of these uses.
        assigned && mentions(host, root, name) == uses.len()
    });
    filled.into_iter().collect()
}

fn is_outermost(subscript: Node<'_>) -> bool {
    subscript.parent().is_none_or(|p| p.kind() != "subscript_expression" || !is_first_child(p, subscript))
}

fn is_first_child(parent: Node<'_>, child: Node<'_>) -> bool {
    parent.child_by_field_name("argument").is_some_and(|a| a.id() == child.id())
}

fn is_assigned(subscript: Node<'_>) -> bool {
    subscript.parent().is_some_and(|p| {
        p.kind() == "assignment_expression" && p.child_by_field_name("left").is_some_and(|l| l.id() == subscript.id())
    })
}

/// The identifier that a chain of subscripts starts from.
fn base(subscript: Node<'_>) -> Option<Node<'_>> {
    let mut node = subscript;
    while node.kind() == "subscript_expression" {
        node = bare(node.child_by_field_name("argument")?);
    }
    (node.kind() == "identifier").then_some(node)
}

fn dims_of(subscript: Node<'_>) -> usize {
    let mut node = subscript;
    let mut dims = 0;
    while node.kind() == "subscript_expression" {
        dims += 1;
        match node.child_by_field_name("argument") {
            Some(inner) => node = bare(inner),
            None => break,
        }
    }
    dims
}

/// How often a word stands in the program text of a file: names of any kind, and words in macros.
fn mentions(host: &HostFile, root: Node<'_>, word: &str) -> usize {
    descendants(root)
        .map(|n| match n.kind() {
            "preproc_arg" => words(host.text(n)).filter(|w| *w == word).count(),
            kind if kind.ends_with("identifier") && kind != "qualified_identifier" => usize::from(host.text(n) == word),
            _ => 0,
        })
        .sum()
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
}

/// True when all files that `host` includes with quotation marks are at hand, and none says `name`.
fn is_unseen(host: &HostFile, project: &Project, name: &str, seen: &mut BTreeSet<String>) -> bool {
    quoted_includes(host).into_iter().all(|include| match project.host_named(host.file.name(), include) {
        None => false,
        Some(header) => {
            !seen.insert(header.file.name().to_owned())
                || (words(header.file.text()).all(|w| w != name) && is_unseen(header, project, name, seen))
        }
    })
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    fn lint(files: &[(&str, String)]) -> Vec<String> {
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, t.as_str()))).collect();
        run(&inputs).iter().map(|d| format!("{} {}", d.code, d.file.locate(d.span.start))).collect()
    }

    fn body(before: &str, inside: &str) -> Vec<String> {
        lint(&[("a.cpp", format!("{before}void f() {{ GLfloat a[4]; {inside} glBufferData(T, sizeof a, a, D); }}"))])
    }

    #[test]
    fn the_planted_fault_is_reported() {
        assert_eq!(body("", "b[0] = 1.0f;"), ["H029 a.cpp:1:26"]);
        assert_eq!(body("#include <GL/glew.h>\n", "b[0] = 1.0f; b[1] += b[0];"), ["H029 a.cpp:2:26"]);
    }

    #[test]
    fn a_name_that_may_be_declared_is_left_alone() {
        for before in [
            "extern GLfloat b[4];\n",
            "#include \"gg.h\"\n",
            "#define b c\n",
            "#define ALL GLfloat b[4];\n",
            "struct S { float b[4]; };\n",
            "using n::b;\n",
        ] {
            assert!(body(before, "b[0] = 1.0f;").is_empty(), "{before}");
        }
    }

    #[test]
    fn an_array_that_may_be_filled_is_left_alone() {
        for inside in
            ["fill(a); b[0] = 1;", "a[0] = 1; b[0] = 1;", "float *q = a; b[0] = 1;", "b[0][1] = 1;", "x = b[0];"]
        {
            assert!(body("", inside).is_empty(), "{inside}");
        }
        assert!(body("", "b[0] = 1; c[0] = 1;").is_empty(), "two names come into question");
    }

    #[test]
    fn members_are_left_alone() {
        let text = "GLfloat a[4]; b[0] = 1; glBufferData(T, sizeof a, a, D);";
        assert!(lint(&[("a.cpp", format!("void S::f() {{ {text} }}"))]).is_empty());
        assert!(lint(&[("a.cpp", format!("struct S : B {{ void f() {{ {text} }} }};"))]).is_empty());
    }

    #[test]
    fn a_header_at_hand_is_read() {
        let host =
            "#include \"gg.h\"\nvoid f() { GLfloat a[4]; b[0] = 1; glBufferData(T, sizeof a, a, D); }".to_owned();
        let with = |header: &str| lint(&[("a.cpp", host.clone()), ("gg.h", header.to_owned())]);
        assert_eq!(with("int other;\n").len(), 1);
        assert!(with("extern float b[4];\n").is_empty());
        assert!(with("#include \"more.h\"\n").is_empty(), "a header of the header is not there");
    }
}
