//! Several texts of one stage, as the linker of OpenGL puts them together: a function that one text declares
//! is defined in another, and variables at file scope with one name are one variable (GLSL 4.60, 4.3).
//!
//! The texts become one, in their order. What an earlier text declares already is left out of the later ones,
//! and macros end with their text. What would mean something else in the joined text is refused.

use std::collections::{BTreeSet, HashMap};

use super::ast::{Callee, Declaration, ExprId, ExprKind, Function, InterfaceBlock, ItemKind, TypeKind};
use super::interface::Storage;
use super::symbols::{CallTarget, FunctionInfo};
use super::types::{ArraySize, Type};
use super::{Parsed, Profile, Shader, Stage, Token, TokenKind, TokenPlace, Version, errors, fitting};
use base::diagnostic::{Code, Diagnostic, Severity};
use base::text::{Assembly, SourceFile, Span};

/// Known behind the first text; no name of GLSL.
const LATER: &str = "#";

/// What an earlier text declares.
struct Seen {
    /// File in which it stands.
    file: String,
    /// What kind of thing it is, with its type.
    what: String,
    /// True for an array that has no size yet.
    open: bool,
    /// Tokens of the initialiser, or of the whole declaration.
    tokens: Option<String>,
}

/// A part of a text that is kept.
enum Kept {
    Copy(Span),
    Text(String, usize),
}

type Problems = Vec<Diagnostic>;

/// One text that means what the texts mean together, attached to one stage; the text itself when there is one.
/// Positions lead back to the files.
///
/// # Errors
/// What is wrong in one of the texts, and what does not go together, at its place.
pub fn link(files: &[SourceFile], stage: Stage, defines: &[(String, String)]) -> Result<SourceFile, Problems> {
    let [first, _, ..] = files else {
        return Ok(files.first().cloned().unwrap_or_else(|| SourceFile::new("", "")));
    };
    let shaders = read(files, stage, defines)?;
    let mut problems = Problems::new();
    check_calls(&shaders, &mut problems);
    let mut seen = HashMap::new();
    let mut assembly = Assembly::new();
    for (k, shader) in shaders.iter().enumerate() {
        let file = shader.file();
        let kept = keep(shader, &mut seen, &mut problems);
        if k > 0 {
            assembly.insert(&between(&shaders[k - 1], defines), file, 0);
        }
        for part in kept {
            match part {
                Kept::Copy(span) => assembly.copy(file, span),
                Kept::Text(text, at) => assembly.insert(&text, file, at),
            }
        }
        if k == 0 {
            // Extensions stand before everything else.
            let rest = std::mem::take(&mut assembly).finish(first.name());
            let head = shader.version().span.map_or(0, |s| s.end);
            assembly.copy(&rest, Span::new(0, head));
            for later in &shaders[1..] {
                for extension in extensions(later) {
                    assembly.insert("\n", later.file(), extension.start);
                    assembly.copy(later.file(), extension);
                }
            }
            assembly.insert("\n", first, head);
            assembly.copy(&rest, Span::new(head, rest.text().len()));
        }
    }
    if problems.is_empty() { Ok(assembly.finish(first.name())) } else { Err(problems) }
}

/// Reads each text by itself. One without `#version` takes that of the others.
fn read(files: &[SourceFile], stage: Stage, defines: &[(String, String)]) -> Result<Vec<Shader>, Problems> {
    let plain: Vec<Parsed> = files.iter().map(|f| Shader::parse_with(f, stage, defines)).collect();
    let stated: Vec<&Shader> = plain.iter().map(|p| &p.shader).filter(|s| s.version().span.is_some()).collect();
    let Some(newest) = stated.iter().max_by_key(|s| s.version().number) else {
        return whole(plain);
    };
    let (number, profile) = (newest.version().number, newest.version().profile);
    let version = Version { number, profile, span: None };
    let es = |s: &Shader| s.version().profile == Profile::Es;
    if let Some(other) = stated.iter().find(|s| es(s) != es(newest)) {
        let span = other.version().span.unwrap_or_default();
        let message = "desktop GLSL and GLSL ES cannot be linked".to_owned();
        return Err(vec![problem(other, errors::REDECLARATION, span, message)]);
    }
    let mut shaders = Vec::new();
    for parsed in &plain {
        let shader = &parsed.shader;
        if shader.version().number == number && shader.version().span.is_some() {
            shaders.push(parsed.clone());
            continue;
        }
        // Every text is read as the joined one will be.
        shaders.push(Shader::parse_with(&fitting::stated(shader, &version), stage, defines));
    }
    whole(shaders)
}

/// The shaders, when no error is found in them.
fn whole(parsed: Vec<Parsed>) -> Result<Vec<Shader>, Problems> {
    let mut errors = Problems::new();
    let mut shaders = Vec::new();
    for one in parsed {
        // `main` and the layout of a geometry stage may stand in another text.
        let elsewhere = [errors::MISSING_LAYOUT, errors::MISSING_MAIN];
        let own = |d: &Diagnostic| d.severity == Severity::Error && !elsewhere.contains(&d.code);
        errors.extend(one.diagnostics.into_iter().filter(own));
        shaders.push(one.shader);
    }
    if errors.is_empty() { Ok(shaders) } else { Err(errors) }
}

fn problem(shader: &Shader, code: Code, span: Span, message: String) -> Diagnostic {
    Diagnostic::new(code, Severity::Error, shader.file(), span, message)
}

fn extensions(shader: &Shader) -> impl Iterator<Item = Span> {
    shader.extensions().iter().map(|e| e.span).filter(|&s| shader.file().slice(s).starts_with('#'))
}

/// Ends the macros of a text; those that are given from outside begin anew.
fn between(shader: &Shader, defines: &[(String, String)]) -> String {
    let directives: Vec<&str> = shader
        .tokens()
        .iter()
        .filter(|t| t.place == TokenPlace::Directive)
        .map(|t| shader.file().slice(t.span))
        .collect();
    let defined = directives.windows(3).filter(|w| w[0] == "#" && w[1] == "define").map(|w| w[2]);
    let own = defined.filter(|n| !n.starts_with("GL_") && !n.starts_with("__")).collect::<BTreeSet<_>>();
    let mut text = "\n".to_owned();
    for name in own {
        text += &format!("#undef {name}\n");
        if let Some((_, value)) = defines.iter().find(|(n, _)| n == name) {
            text += &format!("#define {name} {value}\n");
        }
    }
    text
}

/// Tokens with one blank between them. A macro stands with its definitions: the same name may mean something
/// else in another text.
fn tokens(shader: &Shader, span: Span) -> String {
    let all = shader.tokens();
    let file = shader.file();
    let definition = |name: &str| {
        let is_defined = |w: &[Token]| w[0].place == TokenPlace::Directive && file.slice(w[0].span) == "define";
        let found = all.windows(2).filter(|w| is_defined(w) && file.slice(w[1].span) == name);
        found.filter_map(|w| file.text()[w[1].span.end..].lines().next()).collect::<Vec<_>>().join(";")
    };
    let start = all.partition_point(|t| t.span.start < span.start);
    let inside = all[start..].iter().take_while(|t| t.span.end <= span.end);
    let words = inside.map(|t| {
        let word = file.slice(t.span);
        let meant = if t.kind == TokenKind::Word { definition(word) } else { String::new() };
        if meant.is_empty() { word.to_owned() } else { format!("{word}={meant}") }
    });
    words.collect::<Vec<_>>().join(" ")
}

fn signature(name: &str, info: &FunctionInfo) -> String {
    let params: Vec<String> = info.params.iter().map(|p| format!("{:?} {}", p.direction, p.ty)).collect();
    format!("{name}({})", params.join(", "))
}

/// A call must mean the same function when the functions of the other texts are known too.
fn check_calls(shaders: &[Shader], problems: &mut Problems) {
    let visible = |shader: &Shader, name: &str, n: usize| {
        let same = shader.functions().filter(|(_, f)| f.name.name == name && f.params.len() == n);
        same.map(|(_, f)| signature(name, f)).collect::<BTreeSet<_>>()
    };
    for shader in shaders {
        for (id, expr) in shader.arena().iter() {
            let ExprKind::Call { callee: Callee::Name(name), args } = &expr.kind else { continue };
            if matches!(shader.callee(id), Some(CallTarget::Constructor(_)) | None) {
                continue;
            }
            let own = visible(shader, &name.name, args.len());
            let all: BTreeSet<String> = shaders.iter().flat_map(|s| visible(s, &name.name, args.len())).collect();
            if own != all {
                let message = format!("another text has a `{}` that this one does not declare", name.name);
                let reported = problem(shader, errors::REDECLARATION, name.span, message);
                problems.push(reported.with_help("declare each of them in this text, or rename one"));
                return;
            }
        }
    }
}

/// The parts of a text that stay.
fn keep(shader: &Shader, seen: &mut HashMap<String, Seen>, problems: &mut Problems) -> Vec<Kept> {
    let items = &shader.unit().items;
    let mut cuts: Vec<(Span, Option<String>)> = Vec::new();
    if seen.contains_key(LATER) {
        cuts.extend(shader.version().span.map(|span| (span, None)));
        cuts.extend(extensions(shader).map(|span| (span, None)));
    }
    for (k, item) in items.iter().enumerate() {
        let found = match &item.kind {
            ItemKind::Declaration(declaration) => declaration_cut(shader, declaration, seen, problems),
            ItemKind::Function(function) => function_cut(shader, function, seen),
            ItemKind::Block(block) => block_cut(shader, block, item.span, seen, problems),
            ItemKind::Qualified(names) => {
                let text = tokens(shader, item.span);
                // Names are made invariant where they are declared; a layout is stated once.
                let layout = names.names.is_empty();
                let known = layout && seen.contains_key(&text);
                if layout {
                    seen.insert(
                        text,
                        Seen { file: String::new(), what: "layout".to_owned(), open: false, tokens: None },
                    );
                }
                known.then_some(None)
            }
            ItemKind::Precision(_) | ItemKind::Empty | ItemKind::Error => None,
        };
        let Some(replacement) = found else { continue };
        let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter_map(|j| items.get(j));
        if beside.into_iter().any(|o| o.span.start < item.span.end && item.span.start < o.span.end) {
            let message = "a macro that declares several things again".to_owned();
            problems.push(problem(shader, errors::REDECLARATION, item.span, message).with_help("write them out"));
        }
        cuts.push((item.span, replacement));
    }
    seen.entry(LATER.to_owned()).or_insert(Seen {
        file: String::new(),
        what: String::new(),
        open: false,
        tokens: None,
    });
    cuts.sort_by_key(|(span, _)| span.start);
    let mut kept = Vec::new();
    let mut at = 0;
    for (span, text) in cuts {
        if span.start < at {
            continue;
        }
        kept.push(Kept::Copy(Span::new(at, span.start)));
        if let Some(text) = text {
            kept.push(Kept::Text(text, span.start));
        }
        at = span.end;
    }
    kept.push(Kept::Copy(Span::new(at, shader.file().text().len())));
    kept
}

/// `None` to keep an item, else what stands in its place.
type Cut = Option<Option<String>>;

fn declaration_cut(
    shader: &Shader,
    declaration: &Declaration,
    seen: &mut HashMap<String, Seen>,
    problems: &mut Problems,
) -> Cut {
    let file = shader.file();
    let mut structure = None;
    let mut changed = false;
    if let TypeKind::Struct(specifier) = &declaration.ty.kind
        && let Some(name) = &specifier.name
    {
        let text = tokens(shader, specifier.span);
        match seen.get(&name.name) {
            Some(before) if before.tokens.as_ref() == Some(&text) => {
                structure = Some((specifier.span, name.name.clone()));
                changed = true;
            }
            Some(before) => problems.push(contradicts(shader, name.span, &name.name, "another structure", before)),
            None => {
                let what = "structure".to_owned();
                let entry = Seen { file: file.name().to_owned(), what, open: false, tokens: Some(text) };
                seen.insert(name.name.clone(), entry);
            }
        }
    }
    let mut left = Vec::new();
    for declarator in &declaration.declarators {
        let name = &declarator.name;
        let variable = shader.interface().variables().find(|v| v.name_span == name.span && v.name == name.name);
        let value = declarator.initializer.as_ref().map(|i| initializer(shader, i.value));
        let ty = variable.map_or_else(|| tokens(shader, declaration.ty.span), |v| v.ty.to_string());
        let open = variable.is_some_and(|v| matches!(v.ty, Type::Array(_, ArraySize::Unsized)));
        let storage = variable.map_or(Storage::Global, |v| v.storage);
        let what = format!("{storage:?} {}", if open { ty.replace("[]", "[*]") } else { ty });
        let Some(before) = seen.get_mut(&name.name) else {
            let entry = Seen { file: file.name().to_owned(), what, open, tokens: value };
            seen.insert(name.name.clone(), entry);
            left.push(declarator.span);
            continue;
        };
        if before.file == file.name() {
            // Declared again in one text, as an array that gets its size.
            left.push(declarator.span);
            continue;
        }
        let same_element = |a: &str, b: &str| a.split('[').next() == b.split('[').next();
        if before.what != what && !((before.open || open) && same_element(&before.what, &what)) {
            problems.push(contradicts(shader, name.span, &name.name, &what, before));
        } else if value.is_some() && before.tokens != value {
            let message = format!("`{}` has another initial value in `{}`", name.name, before.file);
            problems.push(problem(shader, errors::REDECLARATION, name.span, message));
        } else if before.open && !open {
            before.open = false;
            before.what = what;
            left.push(declarator.span);
            continue;
        }
        changed = true;
    }
    if !changed {
        return None;
    }
    if left.is_empty() {
        // What is left of `struct S { … } s;` and of `uniform vec3 a;`.
        return Some(None);
    }
    let Some(first) = declaration.declarators.first() else { return Some(None) };
    let head = Span::new(declaration.span.start, first.span.start);
    let mut text = match structure {
        Some((span, name)) => format!(
            "{}{name}{}",
            file.slice(Span::new(head.start, span.start)),
            file.slice(Span::new(span.end, head.end))
        ),
        None => file.slice(head).to_owned(),
    };
    text += &left.iter().map(|&s| file.slice(s)).collect::<Vec<_>>().join(", ");
    text.push(';');
    Some(Some(text))
}

fn initializer(shader: &Shader, value: ExprId) -> String {
    tokens(shader, shader.expr(value).span)
}

fn contradicts(shader: &Shader, span: Span, name: &str, what: &str, before: &Seen) -> Diagnostic {
    let message =
        format!("`{name}` is {} here and {} in `{}`", what.to_lowercase(), before.what.to_lowercase(), before.file);
    problem(shader, errors::REDECLARATION, span, message).with_help("one name is one variable in all texts of a stage")
}

/// A prototype of what is declared already is left out; a second definition stays, and is told.
fn function_cut(shader: &Shader, function: &Function, seen: &mut HashMap<String, Seen>) -> Cut {
    let info = shader.functions().find(|(_, f)| f.name.name == function.name.name && {
        let own = |item: &usize| {
            matches!(&shader.unit().items[*item].kind, ItemKind::Function(g) if g.head_span == function.head_span)
        };
        f.prototypes.iter().chain(&f.definition).any(own)
    });
    let (_, info) = info?;
    let key = format!("function {}", signature(&function.name.name, info));
    let known = seen.contains_key(&key);
    let entry = Seen { file: shader.file().name().to_owned(), what: "function".to_owned(), open: false, tokens: None };
    seen.entry(key).or_insert(entry);
    (known && function.body.is_none()).then_some(None)
}

fn block_cut(
    shader: &Shader,
    block: &InterfaceBlock,
    span: Span,
    seen: &mut HashMap<String, Seen>,
    problems: &mut Problems,
) -> Cut {
    let storage = block.qualifiers.storage().map_or("", |s| s.0.text());
    let key = format!("block {storage} {}", block.name.name);
    let text = tokens(shader, Span::new(block.name.span.start, span.end));
    match seen.get(&key) {
        Some(before) if before.tokens.as_ref() == Some(&text) => Some(None),
        Some(before) => {
            problems.push(contradicts(shader, block.name.span, &block.name.name, "another block", before));
            None
        }
        None => {
            let what = "a block".to_owned();
            seen.insert(key, Seen { file: shader.file().name().to_owned(), what, open: false, tokens: Some(text) });
            None
        }
    }
}
