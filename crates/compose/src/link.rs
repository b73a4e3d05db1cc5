//! From the declarations of a file to all that they need, and from there to one text.

use std::collections::{HashMap, HashSet};

use base::diagnostic::{Diagnostic, Severity};
use base::nearest;
use base::text::{SourceFile, Span};
use syntax::errors;

use crate::declaration::{Role, Use};
use crate::features;
use crate::import::{ModulePath, Origin};
use crate::module::Module;
use crate::naming;
use crate::{Composed, Guessed, LeftOut, Library, NAME_ITS_FOLDER, Options, Problems, Rest, Undeclared, predeclared};

/// A declaration: the module, and its number there.
pub(crate) type Item = (usize, usize);

/// Modules that may be read for one text; more is a mistake in a library.
const MOST_MODULES: usize = 4096;

/// The package with the assertions of tests that stand in a shader: ours, whatever lies in a folder, since ours are what the
/// program that runs the tests reads.
pub const ASSERTIONS: &str = "wgsl_test";

/// The module of [`ASSERTIONS`].
fn assertions(path: &ModulePath) -> Option<SourceFile> {
    let is_it = path.origin == Origin::Named && path.names == [ASSERTIONS];
    is_it.then(|| SourceFile::new(ASSERTIONS, include_str!("wgsl_test.wgsl")))
}

/// How the name of the file begins that stands for the package `constants`.
const CONSTANTS: &str = "constants of ";

/// All files of a text, and what of them it needs.
pub(crate) struct Linked {
    pub modules: Vec<Module>,
    /// What goes into the text, in the order in which it was found.
    pub reached: Vec<Item>,
    /// What the name at a token of a module means.
    pub targets: HashMap<(usize, usize), Item>,
    /// Names that a module uses and nothing of ours declares, and whether one of them is called.
    pub free: Vec<HashMap<String, bool>>,
    /// Names in the place of paths that lead nowhere, by the first token of the path.
    pub loose: HashMap<(usize, usize), String>,
}

pub(crate) fn link(
    root: &SourceFile,
    options: &Options,
    library: &mut dyn Library,
    problems: &mut Problems,
) -> Composed {
    let linked = Linked {
        modules: Vec::new(),
        reached: Vec::new(),
        targets: HashMap::new(),
        free: Vec::new(),
        loose: HashMap::new(),
    };
    let mut linker = Linker {
        linked,
        options,
        library,
        problems,
        by_file: HashMap::new(),
        by_path: HashMap::new(),
        paths: Vec::new(),
        preludes: Vec::new(),
        siblings: None,
        guessed: Vec::new(),
        undeclared: Vec::new(),
        notes: Vec::new(),
        arrows: Vec::new(),
        lacking: HashMap::new(),
    };
    linker.run(root);
    let Linker { mut linked, guessed, undeclared, paths, notes, lacking, .. } = linker;
    let composed = naming::write(root, &linked, &paths, options, undeclared);
    let rest = if lacking.is_empty() { None } else { linked.without(lacking) };
    let rest =
        rest.map(|left_out| Rest { file: naming::write(root, &linked, &paths, options, Vec::new()).file, left_out });
    let files = || linked.modules.iter().flat_map(|module| module.included.iter().chain([&module.author]));
    let mentioned = |name: &str| files().any(|file| mentions(file, name));
    let mut asked: Vec<String> = Vec::new();
    for name in files().flat_map(features) {
        if !asked.contains(&name) {
            asked.push(name);
        }
    }
    let stated = options.defines.iter().map(|(name, _)| name).filter(|name| mentioned(name)).cloned().collect();
    Composed { guessed, notes, stated, features: asked, rest, ..composed }
}

impl Linked {
    /// Leaves out what lacks a name, and what needs that: the functions of the first module that go with it, each with
    /// such a name. None where no function is left.
    fn without(&mut self, mut lacking: HashMap<Item, String>) -> Option<Vec<LeftOut>> {
        loop {
            let needs = |item: &Item| {
                let uses = &self.modules[item.0].declarations[item.1].uses;
                uses.iter().find_map(|used| lacking.get(self.targets.get(&(item.0, used.tokens.start))?).cloned())
            };
            let open = self.reached.iter().filter(|item| !lacking.contains_key(item));
            let more: Vec<(Item, String)> = open.filter_map(|item| Some((*item, needs(item)?))).collect();
            if more.is_empty() {
                break;
            }
            lacking.extend(more);
        }
        self.reached.retain(|item| !lacking.contains_key(item));
        let function = |&(module, at): &Item| {
            let (module, declaration) = (&self.modules[module], &self.modules[module].declarations[at]);
            let (name, token) = declaration.name.as_ref()?;
            (module.word(token.checked_sub(1)?) == "fn").then(|| (name.clone(), module.tokens[*token].span))
        };
        if !self.reached.iter().any(|item| item.0 == 0 && function(item).is_some()) {
            return None;
        }
        let mut items: Vec<(Item, String)> = lacking.into_iter().filter(|(item, _)| item.0 == 0).collect();
        items.sort_unstable();
        let left_out = items.into_iter().filter_map(|(item, lacks)| {
            let (name, span) = function(&item)?;
            let (file, span) = self.modules[0].file.origin(span);
            Some(LeftOut { name, at: file.locate(span.start), lacks })
        });
        Some(left_out.collect())
    }
}

/// True where a name stands in a file as a whole word.
fn mentions(file: &SourceFile, name: &str) -> bool {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    file.text()
        .match_indices(name)
        .any(|(at, _)| !file.text()[..at].ends_with(part) && !file.text()[at + name.len()..].starts_with(part))
}

struct Linker<'a> {
    linked: Linked,
    options: &'a Options,
    library: &'a mut dyn Library,
    problems: &'a mut Problems,
    by_file: HashMap<String, usize>,
    by_path: HashMap<(String, ModulePath), Option<usize>>,
    /// The path by which each module was first asked for.
    paths: Vec<String>,
    /// Modules of the files that the host puts before the text.
    preludes: Vec<usize>,
    /// Files that may be parts of the same text; none before they are asked for.
    siblings: Option<Vec<Vec<SourceFile>>>,
    guessed: Vec<Guessed>,
    undeclared: Vec<(Item, Use, Undeclared)>,
    notes: Vec<Diagnostic>,
    /// Directives by which one module imports another, with the place.
    arrows: Vec<(usize, usize, SourceFile, Span)>,
    /// Declarations that use a name that nothing declares.
    lacking: HashMap<Item, String>,
}

/// What a path of names leads to.
enum Found {
    Item(Item),
    /// A module as a whole.
    Module(usize),
    /// The module is there and has no such declaration.
    NoItem(usize, String),
    Nothing,
}

impl Linker<'_> {
    fn run(&mut self, root: &SourceFile) {
        let Some(root) = self.load(root, "") else { return };
        for prelude in &self.options.preludes {
            let prelude = self.load(prelude, "");
            self.preludes.extend(prelude);
        }
        let preludes = self.preludes.clone();
        let module = &self.linked.modules[root];
        if let (true, Some((name, condition))) = (module.declarations.is_empty(), module.left_out.first()) {
            let message = format!("conditions leave out everything: `{name}` stands under {condition}");
            let file = module.author.clone();
            let at = file.text().find(['@', '#']).unwrap_or(0);
            self.problems.add(errors::FRAGMENT, &file, Span::at(at), message, "state a feature with `--define NAME`");
        }
        let declarations = self.linked.modules[root].declarations.len();
        let mut open: Vec<Item> = (0..declarations).rev().map(|at| (root, at)).collect();
        for prelude in preludes {
            let all = self.linked.modules[prelude].declarations.iter().enumerate();
            open.extend(all.filter(|(_, d)| d.role == Role::Directive).map(|(at, _)| (prelude, at)));
        }
        let mut seen: HashSet<Item> = open.iter().copied().collect();
        let mut begun: HashSet<usize> = HashSet::new();
        while let Some(item) = open.pop() {
            self.linked.reached.push(item);
            let mut further = Vec::new();
            if begun.insert(item.0) {
                self.check_imports(item.0);
                let declarations = self.linked.modules[item.0].declarations.iter().enumerate();
                let along = declarations.filter(|(_, d)| matches!(d.role, Role::Directive | Role::Assertion));
                further.extend(along.map(|(at, _)| (item.0, at)));
            }
            let uses = self.linked.modules[item.0].declarations[item.1].uses.clone();
            for used in uses {
                if let Some(target) = self.resolve(item, &used) {
                    self.linked.targets.insert((item.0, used.tokens.start), target);
                    further.push(target);
                }
            }
            further.retain(|item| seen.insert(*item));
            open.extend(further.into_iter().rev());
        }
        self.find_circles();
    }

    /// Reads a file, once.
    fn load(&mut self, file: &SourceFile, path: &str) -> Option<usize> {
        if let Some(&known) = self.by_file.get(file.name()) {
            return Some(known);
        }
        if self.linked.modules.len() >= MOST_MODULES {
            return None;
        }
        let mut module = Module::read(file, &self.options.defines, self.options, self.library, self.problems);
        self.notes.extend(module.draft.take());
        self.notes.append(&mut module.assumed);
        Some(self.add(file, path, module))
    }

    fn add(&mut self, file: &SourceFile, path: &str, module: Module) -> usize {
        let at = self.linked.modules.len();
        let path = module.says.clone().unwrap_or_else(|| path.to_owned());
        self.by_file.insert(file.name().to_owned(), at);
        self.linked.modules.push(module);
        self.linked.free.push(HashMap::new());
        self.paths.push(path);
        at
    }

    /// The module at a path that a module writes.
    fn module(&mut self, from: usize, path: &ModulePath) -> Option<usize> {
        let author = self.linked.modules[from].author.clone();
        let key = (author.name().to_owned(), path.clone());
        if let Some(known) = self.by_path.get(&key) {
            return *known;
        }
        let file = assertions(path).or_else(|| self.library.module(&author, path));
        let file = file.or_else(|| self.constants(&author, path));
        let found = file.and_then(|file| self.load(&file, &path.shown()));
        self.by_path.insert(key, found);
        found
    }

    /// The package `constants` has what is defined with a number (Bevy has it for values that the host computes).
    fn constants(&self, from: &SourceFile, path: &ModulePath) -> Option<SourceFile> {
        if path.origin != Origin::Named || path.names != ["constants"] {
            return None;
        }
        let is_number = |value: &str| value.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit());
        let numbers = self.options.defines.iter().filter(|(_, value)| is_number(value));
        let text: String = numbers.map(|(name, value)| format!("const {name} = {value};\n")).collect();
        Some(SourceFile::new(format!("{CONSTANTS}{}", from.name()), text))
    }

    fn find(&mut self, from: usize, path: &ModulePath) -> Found {
        if let Some((module, name)) = path.split() {
            let inside = self.module(from, &module);
            if let Some(&at) = inside.and_then(|inside| self.linked.modules[inside].names.get(&name)) {
                return Found::Item((inside.unwrap_or(from), at));
            }
            if let Some(whole) = self.module(from, path) {
                return Found::Module(whole);
            }
            return inside.map_or(Found::Nothing, |inside| Found::NoItem(inside, name));
        }
        self.module(from, path).map_or(Found::Nothing, Found::Module)
    }

    /// What a name in a declaration means; none for what the language declares, or the function around it.
    fn resolve(&mut self, item: Item, used: &Use) -> Option<Item> {
        let module = &self.linked.modules[item.0];
        let first = &used.names[0];
        let imported = || module.imports.iter().find(|placed| placed.import.name == *first);
        if let [name] = &used.names[..] {
            if let Some(&at) = module.names.get(name) {
                return Some((item.0, at));
            }
            if let Some(placed) = imported() {
                let (import, file) = (placed.import.clone(), placed.file.clone());
                return match self.find(item.0, &import.path) {
                    Found::Item(target) => Some(target),
                    Found::NoItem(inside, name) if self.is_left_out(inside, &name) => {
                        self.missing(item.0, &import.path, Found::NoItem(inside, name), &file, import.span);
                        None
                    }
                    Found::NoItem(..) | Found::Nothing if self.options.open => self.lacks(item, used, Vec::new()),
                    Found::Module(_) | Found::NoItem(..) | Found::Nothing => None,
                };
            }
            return self.elsewhere(item, used);
        }
        let path = match first.as_str() {
            "package" => ModulePath { origin: Origin::Package, names: used.names[1..].to_vec() },
            "super" => {
                let count = used.names.iter().take_while(|name| *name == "super").count();
                ModulePath { origin: Origin::Super(count), names: used.names[count..].to_vec() }
            }
            _ => match imported() {
                Some(placed) => placed.import.path.join(&used.names[1..]),
                None => ModulePath { origin: Origin::Named, names: used.names.clone() },
            },
        };
        match self.find(item.0, &path) {
            Found::Item(target) => Some(target),
            Found::NoItem(..) | Found::Nothing if self.options.open => self.lacks(item, used, Vec::new()),
            missing => {
                let module = &self.linked.modules[item.0];
                let (first, last) = (module.tokens[used.tokens.start].span, module.tokens[used.tokens.end - 1].span);
                let file = module.file.clone();
                self.missing(item.0, &path, missing, &file, first.to(last));
                None
            }
        }
    }

    /// A name that its file neither declares nor imports: a file that is imported as a whole may have it, one that the
    /// host puts before the text, or one beside it.
    fn elsewhere(&mut self, item: Item, used: &Use) -> Option<Item> {
        let name = used.names[0].clone();
        let module = &self.linked.modules[item.0];
        let local = module.locals.contains(&name) && !used.called;
        let called = self.linked.free[item.0].entry(name.clone()).or_default();
        *called |= used.called;
        if local || predeclared::is_predeclared(&name) {
            return None;
        }
        let whole: Vec<ModulePath> =
            module.imports.iter().filter(|p| p.directive).map(|p| p.import.path.clone()).collect();
        for path in whole {
            if let Found::Module(inside) = self.find(item.0, &path)
                && let Some(&at) = self.linked.modules[inside].names.get(&name)
            {
                self.linked.free[item.0].remove(&name);
                return Some((inside, at));
            }
        }
        let root_and_preludes = [0].into_iter().chain(self.preludes.clone());
        for inside in root_and_preludes.filter(|inside| *inside != item.0) {
            let joined = inside != 0 || self.preludes.contains(&item.0) || self.was_guessed(item.0);
            if let Some(&at) = self.linked.modules[inside].names.get(&name).filter(|_| joined) {
                self.linked.free[item.0].remove(&name);
                return Some((inside, at));
            }
        }
        let candidates = self.candidates(item.0, &name);
        if let [only, ..] = candidates[..]
            && self.alike(&candidates)
        {
            let file = self.linked.modules[only.0].author.name().to_owned();
            let guess = Guessed { name: name.clone(), file };
            if !self.guessed.contains(&guess) {
                self.guessed.push(guess);
            }
            self.linked.free[item.0].remove(&name);
            return Some(only);
        }
        self.lacks(item, used, candidates)
    }

    /// Takes a name for one that nothing declares. A path goes by its last name, where no declaration has that.
    fn lacks(&mut self, item: Item, used: &Use, candidates: Vec<Item>) -> Option<Item> {
        let mut name = used.names.last()?.clone();
        if used.names.len() > 1 {
            let module = &self.linked.modules[item.0];
            if module.names.contains_key(&name) || module.locals.contains(&name) {
                name = used.names.join("_");
            }
            self.linked.loose.insert((item.0, used.tokens.start), name.clone());
        }
        self.lacking.entry(item).or_insert_with(|| name.clone());
        if !self.undeclared.iter().any(|(_, _, u)| u.name == name) {
            let (called, beyond) = (used.called, self.lacks_a_whole_file(item.0));
            let files = candidates.iter().map(|at| self.linked.modules[at.0].author.name().to_owned());
            let left_out = self.linked.modules.iter().flat_map(|module| &module.left_out);
            let condition = left_out.into_iter().find(|(n, _)| *n == name).map(|(_, condition)| condition.clone());
            let undeclared =
                Undeclared { name, span: Span::default(), called, candidates: files.collect(), condition, beyond };
            self.undeclared.push((item, used.clone(), undeclared));
        }
        None
    }

    /// True where a directive imports a module that is not there, and the text does not use its last name: what it declares
    /// is used without it.
    fn lacks_a_whole_file(&mut self, at: usize) -> bool {
        let module = &self.linked.modules[at];
        let used = |name: &str| module.declarations.iter().flat_map(|d| &d.uses).any(|u| u.names[0] == name);
        let whole = module.imports.iter().filter(|p| p.directive && !used(&p.import.name));
        let paths: Vec<ModulePath> = whole.map(|p| p.import.path.clone()).collect();
        paths.iter().any(|path| matches!(self.find(at, path), Found::Nothing | Found::NoItem(..)))
    }

    fn was_guessed(&self, module: usize) -> bool {
        self.guessed.iter().any(|guess| guess.file == self.linked.modules[module].author.name())
    }

    /// Declarations of a name in files beside this one, or else in the nearest folder around that has any.
    fn candidates(&mut self, from: usize, name: &str) -> Vec<Item> {
        if self.siblings.is_none() {
            let root = self.linked.modules[0].author.clone();
            let mut folders = vec![self.library.siblings(&root)];
            folders.extend(self.library.around(&root));
            self.siblings = Some(folders);
        }
        let folders = self.siblings.as_ref().map_or(0, Vec::len);
        let mut all = (0..folders).map(|folder| self.declarations(folder, from, name));
        all.find(|found| !found.is_empty()).unwrap_or_default()
    }

    /// Declarations of a name in the files of one folder.
    fn declarations(&mut self, folder: usize, from: usize, name: &str) -> Vec<Item> {
        let own = self.linked.modules[from].author.name().to_owned();
        let files = self.siblings.iter().flatten().nth(folder).into_iter().flatten();
        let files: Vec<SourceFile> =
            files.filter(|file| file.name() != own && file.text().contains(name)).cloned().collect();
        let mut found = Vec::new();
        for file in files {
            let known = self.by_file.get(file.name()).copied();
            let at = known.unwrap_or_else(|| {
                // What is wrong with a file that nobody named is none of this text's business.
                let mut unread = Problems::default();
                let module = Module::read(&file, &self.options.defines, self.options, self.library, &mut unread);
                self.add(&file, "", module)
            });
            found.extend(self.linked.modules[at].names.get(name).map(|&declaration| (at, declaration)));
        }
        found
    }

    /// True when declarations are the same, word by word.
    fn alike(&self, items: &[Item]) -> bool {
        let words = |&(module, at): &Item| {
            let module = &self.linked.modules[module];
            let tokens = module.declarations[at].tokens.clone();
            tokens.map(|at| module.word(at).to_owned()).collect::<Vec<_>>()
        };
        items.windows(2).all(|pair| words(&pair[0]) == words(&pair[1]))
    }

    /// Tells of imports that lead nowhere, of names that come twice, and of a file that imports itself.
    fn check_imports(&mut self, at: usize) {
        let imports: Vec<_> =
            self.linked.modules[at].imports.iter().map(|p| (p.import.clone(), p.file.clone(), p.directive)).collect();
        let mut names: HashMap<String, ModulePath> = HashMap::new();
        for (import, file, directive) in imports {
            let found = self.find(at, &import.path);
            let module = &self.linked.modules[at];
            let twice = names.insert(import.name.clone(), import.path.clone()).is_some_and(|path| path != import.path);
            // A module is named in front of `::`, where no declaration stands.
            let named = |used: &Use| match found {
                Found::Module(_) => used.names[0] == import.name && used.names.len() > 1,
                _ => used.names[..] == [import.name.clone()],
            };
            let used = module.declarations.iter().flat_map(|d| &d.uses).any(named);
            let there = matches!(found, Found::Item(_) | Found::Module(_));
            let declared = matches!(found, Found::Item(_)) && module.names.contains_key(&import.name);
            if there && used && (twice || declared) {
                let what = if declared { "imported and declared here" } else { "imported twice" };
                let message = format!("`{}` is {what}", import.name);
                let help = format!("give it another name: `as other_{}`", import.name);
                self.problems.add(errors::IMPORTED_TWICE, &file, import.span, message, &help);
            }
            match found {
                Found::Item((inside, _)) | Found::Module(inside) if inside == at => {
                    self.problems.cycle(&file, import.span, &[file.name()]);
                }
                Found::Item((inside, _)) | Found::Module(inside) => {
                    if directive {
                        self.arrows.push((at, inside, file, import.span));
                    }
                }
                // What nobody uses is not missed.
                missing => {
                    let uses = self.linked.modules[at].declarations.iter().flat_map(|d| &d.uses);
                    let used = uses.into_iter().any(|used| used.names[0] == import.name);
                    match missing {
                        Found::NoItem(inside, name) if self.is_left_out(inside, &name) => {}
                        _ if used && self.options.open => {}
                        missing if used => self.missing(at, &import.path, missing, &file, import.span),
                        missing => {
                            let errors = std::mem::take(&mut self.problems.found);
                            self.missing(at, &import.path, missing, &file, import.span);
                            let found = std::mem::replace(&mut self.problems.found, errors);
                            self.notes
                                .extend(found.into_iter().map(|d| Diagnostic { severity: Severity::Warning, ..d }));
                        }
                    }
                }
            }
        }
    }

    fn is_left_out(&self, module: usize, name: &str) -> bool {
        self.linked.modules[module].left_out.iter().any(|(left_out, _)| left_out == name)
    }

    fn missing(&mut self, from: usize, path: &ModulePath, missing: Found, file: &SourceFile, span: Span) {
        let shown = path.shown();
        let (message, help) = match missing {
            Found::NoItem(inside, name) => {
                let module = &self.linked.modules[inside];
                let valueless = module.author.name().starts_with(CONSTANTS);
                let message = match valueless {
                    true => format!("`constants::{name}` has no value"),
                    false => format!("`{}` declares no `{name}`", module.author.name()),
                };
                let left_out = module.left_out.iter().find(|(n, _)| *n == name);
                let help = match (left_out, nearest(&name, module.names.keys().map(String::as_str))) {
                    (Some((_, condition)), _) => {
                        format!("it stands under {condition}, which does not hold: state features with `--define NAME`")
                    }
                    _ if valueless => format!("give its value with `--define {name}=VALUE`"),
                    (None, Some(near)) => format!("did you mean `{near}`?"),
                    (None, None) => "declare it there, or import it from where it is declared".to_owned(),
                };
                (message, help)
            }
            _ => {
                let author = self.linked.modules[from].author.clone();
                let all = self.library.modules(&author);
                let help = match nearest(&shown, all.iter().map(String::as_str)).filter(|near| **near != shown) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => NAME_ITS_FOLDER.to_owned(),
                };
                (format!("no module is found for `{shown}`"), help)
            }
        };
        self.problems.add(errors::IMPORT, file, span, message, &help);
    }

    /// Tells of modules that import each other by directives, which naga_oil refuses.
    fn find_circles(&mut self) {
        let arrows = std::mem::take(&mut self.arrows);
        let mut done: HashSet<usize> = HashSet::new();
        // The way to the module at hand, each with the next of its arrows to follow.
        let mut way: Vec<(usize, usize)> = vec![(0, 0)];
        while let Some((module, next)) = way.last_mut() {
            let Some((_, to, file, span)) = arrows.iter().filter(|a| a.0 == *module).nth(*next) else {
                done.insert(*module);
                way.pop();
                continue;
            };
            *next += 1;
            if let Some(begin) = way.iter().position(|(module, _)| module == to) {
                let names = way[begin..].iter().map(|(module, _)| self.linked.modules[*module].author.name());
                let chain: Vec<String> = names.map(str::to_owned).collect();
                let chain: Vec<&str> = chain.iter().map(String::as_str).collect();
                self.problems.cycle(file, *span, &chain);
                return;
            }
            if !done.contains(to) {
                way.push((*to, 0));
            }
        }
    }
}
