//! What declarations of several files are called in one text, and the text itself.

use std::collections::{HashMap, HashSet};

use base::text::{Assembly, SourceFile, Span};

use crate::declaration::{Role, Use};
use crate::link::{Item, Linked};
use crate::token::{Kind, behind_template};
use crate::{Composed, Options, Renamed, Undeclared};

/// Writes the text of all that is reached.
pub(crate) fn write(
    root: &SourceFile,
    linked: &Linked,
    paths: &[String],
    options: &Options,
    undeclared: Vec<(Item, Use, Undeclared)>,
) -> Composed {
    let (guessed, notes) = (Vec::new(), Vec::new());
    let Some(first) = linked.modules.first() else {
        return Composed {
            file: root.clone(),
            renamed: Vec::new(),
            guessed,
            undeclared: Vec::new(),
            notes,
            stated: Vec::new(),
            features: Vec::new(),
            rest: None,
            assigned: false,
        };
    };
    let unbound = if options.assign_bindings { unbound(linked) } else { Vec::new() };
    let names = names(linked, paths);
    let renamed = names.iter().map(|(&(module, at), written)| Renamed {
        written: written.clone(),
        name: name_of(linked, (module, at)).unwrap_or_default().to_owned(),
        file: linked.modules[module].author.name().to_owned(),
    });
    let mut renamed: Vec<Renamed> = renamed.collect();
    renamed.sort_by(|a, b| a.written.cmp(&b.written));
    let alone = linked.reached.iter().all(|(module, _)| *module == 0) && renamed.is_empty();
    let alone = alone && linked.reached.len() == first.declarations.len();
    let whole = alone
        && unbound.is_empty()
        && linked.loose.is_empty()
        && linked.modules[0].declarations.iter().all(|d| d.dropped.is_none());
    let mut starts: HashMap<(usize, usize), usize> = HashMap::new();
    let file = if whole { first.file.clone() } else { joined(root, linked, &names, &unbound, &mut starts) };
    let placed = undeclared.into_iter().map(|((module, _), used, undeclared)| {
        let token = linked.modules[module].tokens[used.tokens.start].span;
        let start = if whole { token.start } else { starts.get(&(module, used.tokens.start)).copied().unwrap_or(0) };
        let len = if used.names.len() > 1 { undeclared.name.len() } else { token.len() };
        Undeclared { span: Span::new(start, start + len), ..undeclared }
    });
    let undeclared = placed.collect();
    let assigned = !unbound.is_empty();
    Composed {
        file,
        renamed,
        guessed,
        undeclared,
        notes,
        stated: Vec::new(),
        features: Vec::new(),
        rest: None,
        assigned,
    }
}

fn name_of(linked: &Linked, (module, at): Item) -> Option<&str> {
    linked.modules[module].declarations[at].name.as_ref().map(|(name, _)| name.as_str())
}

/// Declarations that need another name than that of their author.
fn names(linked: &Linked, paths: &[String]) -> HashMap<Item, String> {
    let reached: HashSet<usize> = linked.reached.iter().map(|item| item.0).collect();
    let mut declared: HashMap<&str, HashSet<usize>> = HashMap::new();
    for &item in &linked.reached {
        if let Some(name) = name_of(linked, item) {
            declared.entry(name).or_default().insert(item.0);
        }
    }
    // Modules where a local variable would hide a declaration of another one, which goes by another name there.
    let mut hidden: HashSet<Item> = HashSet::new();
    for &(module, at) in &linked.reached {
        for used in &linked.modules[module].declarations[at].uses {
            let Some(&target) = linked.targets.get(&(module, used.tokens.start)) else { continue };
            let Some(name) = name_of(linked, target) else { continue };
            if used.names[..] != [name.to_owned()] && linked.modules[module].locals.contains(name) {
                hidden.insert(target);
            }
        }
    }
    let mut words: HashSet<&str> = HashSet::new();
    for &module in &reached {
        let module = &linked.modules[module];
        words.extend((0..module.tokens.len()).map(|at| module.word(at)));
    }
    let mut chosen: HashMap<Item, String> = HashMap::new();
    let mut taken: HashSet<String> = HashSet::new();
    for &item in &linked.reached {
        let Some(name) = name_of(linked, item) else { continue };
        let (module, at) = item;
        if linked.modules[module].declarations[at].role == Role::Named {
            continue;
        }
        let others = || reached.iter().filter(move |other| **other != module);
        let declared = module != 0 && declared.get(name).is_some_and(|modules| modules.len() > 1);
        let free = others().any(|&other| {
            let called = linked.free[other].get(name);
            called.is_some_and(|called| *called || !linked.modules[other].locals.contains(name))
        });
        if !(declared || free || hidden.contains(&item)) {
            continue;
        }
        let label: String = paths[module].chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
        let label = label.trim_matches('_').replace("__", "_");
        let label = if label.starts_with(|c: char| c.is_alphabetic()) { label } else { format!("m{module}{label}") };
        let wanted = format!("{label}_{name}");
        let mut new = wanted.clone();
        let mut count = 1;
        while words.contains(new.as_str()) || !taken.insert(new.clone()) {
            count += 1;
            new = format!("{wanted}_{count}");
        }
        chosen.insert(item, new);
    }
    chosen
}

/// Resources without a binding, where none has one.
fn unbound(linked: &Linked) -> Vec<Item> {
    let mut found = Vec::new();
    for &(module, at) in &linked.reached {
        let source = &linked.modules[module];
        let tokens = source.declarations[at].tokens.clone();
        if tokens.clone().any(|at| source.word(at) == "@" && source.word(at + 1) == "binding") {
            return Vec::new();
        }
        let Some((_, name)) = &source.declarations[at].name else { continue };
        let Some(var) = tokens.clone().find(|&at| source.word(at) == "var").filter(|var| var < name) else { continue };
        let space = behind_template(&source.tokens, var + 1);
        let handle = source.tokens.get(var + 1).is_some_and(|token| token.kind != Kind::Less);
        if handle || (var + 1..space).any(|at| matches!(source.word(at), "uniform" | "storage")) {
            found.push((module, at));
        }
    }
    found.sort_unstable();
    found
}

/// The text of several modules. Directives of the language stand first, each once.
fn joined(
    root: &SourceFile,
    linked: &Linked,
    names: &HashMap<Item, String>,
    unbound: &[Item],
    starts: &mut HashMap<(usize, usize), usize>,
) -> SourceFile {
    let mut out = Writer { assembly: Assembly::new(), len: 0 };
    let mut order = linked.reached.clone();
    // Modules in the order in which they were found, declarations as their author has them.
    order.sort_by_key(|&(module, at)| (linked.modules[module].declarations[at].role != Role::Directive, module, at));
    let mut directives: HashSet<String> = HashSet::new();
    for (module, at) in order {
        let (module, source) = (module, &linked.modules[module]);
        let declaration = &source.declarations[at];
        let tokens = declaration.tokens.clone();
        if declaration.role == Role::Directive {
            let text = tokens.clone().map(|at| source.word(at)).collect::<Vec<_>>().join(" ");
            if !directives.insert(text) {
                continue;
            }
        }
        let start = source.tokens[tokens.start].span.start;
        let mut copied = start;
        if let Some(binding) = unbound.iter().position(|item| *item == (module, at)) {
            out.replace(&format!("@group(0) @binding({binding}) "), &source.file, Span::at(start));
        }
        if let Some(dropped) = declaration.dropped {
            let span = source.tokens[dropped].span;
            out.copy(&source.file, Span::new(copied, span.start));
            copied = span.end;
        }
        for used in &declaration.uses {
            let first = source.tokens[used.tokens.start].span;
            let span = first.to(source.tokens[used.tokens.end - 1].span);
            starts.insert((module, used.tokens.start), out.len + span.start.saturating_sub(copied));
            let at = (module, used.tokens.start);
            let target = linked.targets.get(&at);
            let name = |target| names.get(target).map_or(name_of(linked, *target), |name| Some(name.as_str()));
            let Some(new) = target.and_then(name).or_else(|| linked.loose.get(&at).map(String::as_str)) else {
                continue;
            };
            if source.file.slice(span) != new {
                out.copy(&source.file, Span::new(copied, span.start));
                out.replace(new, &source.file, span);
                copied = span.end;
            }
        }
        let end = source.tokens[tokens.end - 1].span.end;
        out.copy(&source.file, Span::new(copied, end));
        out.replace("\n\n", &source.file, Span::at(end));
    }
    out.assembly.finish(root.name())
}

/// An assembly that knows its length.
struct Writer {
    assembly: Assembly,
    len: usize,
}

impl Writer {
    fn copy(&mut self, file: &SourceFile, span: Span) {
        self.assembly.copy(file, span);
        self.len += span.len();
    }

    fn replace(&mut self, text: &str, file: &SourceFile, span: Span) {
        self.assembly.replace(text, file, span);
        self.len += text.len();
    }
}
