//! Which declarations a text lacks: the first ones with which it has no more errors than without.

use base::diagnostic::{Code, Diagnostic, Severity};
use base::text::Span;
use lanes::interrupt;
use syntax::ast::{Callee, Expr, ExprId, ExprKind, Item, ItemKind, TypeKind};
use syntax::errors;
use syntax::symbols::{Symbol, SymbolId, SymbolKind};
use syntax::types::Type;
use syntax::words::words;
use syntax::{Lacks, Parsed, Profile, Shader, Token, TokenKind, TokenPlace};

use super::access::access;
use super::declared::{self, Form, Gives, MADE, Param, Shape, Stand};
use super::{Assumed, Completed, Offers, Parse, Sibling, Siblings, macros, with_macros};

/// Declarations that are assumed at most: a text that lacks more is a small part of another.
const MOST: usize = 96;

/// Files that are put in at most.
const MOST_FILES: usize = 8;

/// Macros that hold nothing at most.
const MOST_EMPTY: usize = 8;

/// Bytes of text that are read at most while types are tried: some seconds.
const MOST_READ: usize = 64 << 20;

/// Elements of an array of which nobody states the size; the larger one where the text asks for more.
const ELEMENTS: [u32; 2] = [16, 256];

/// Types of numbers, the plainest first.
const NUMBERS: [&str; 16] = [
    "float", "vec3", "vec4", "vec2", "mat4", "mat3", "int", "bool", "uint", "ivec2", "ivec3", "ivec4", "uvec4",
    "uvec2", "uvec3", "mat2",
];

/// Types of textures and images.
const TEXTURES: [&str; 16] = [
    "sampler2D",
    "samplerCube",
    "sampler3D",
    "sampler2DShadow",
    "sampler2DArray",
    "sampler2DArrayShadow",
    "samplerCubeShadow",
    "samplerCubeArray",
    "isampler2D",
    "usampler2D",
    "samplerBuffer",
    "isamplerBuffer",
    "usamplerBuffer",
    "sampler2DRect",
    "sampler2DMS",
    "sampler1D",
];

/// Words of names that are matrices, where a number would do as well.
const MATRICES: [&str; 10] =
    ["matrix", "mat", "mvp", "mv", "wvp", "projection", "proj", "modelview", "model", "transform"];

/// A search for declarations.
pub(super) struct Search<'p> {
    parse: &'p Parse<'p>,
    done: Completed,
    precision: &'static str,
    /// The text as it is.
    text: String,
    read: usize,
}

/// True for what may be components of a vector.
pub(super) fn is_swizzle(field: &str) -> bool {
    field.len() <= 4 && syntax::swizzle::SETS.iter().any(|set| field.chars().all(|c| set.contains(c)))
}

/// What stands before the elements and brackets of an expression.
fn root(shader: &Shader, mut id: ExprId) -> (ExprId, bool) {
    let mut indexed = false;
    loop {
        match &shader.expr(id).kind {
            ExprKind::Paren(inner) => id = *inner,
            ExprKind::Index { base, .. } => (id, indexed) = (*base, true),
            _ => return (id, indexed),
        }
    }
}

/// True for a name that gets a value anywhere.
fn is_written(shader: &Shader, name: &str) -> bool {
    let is = |mut id: ExprId| loop {
        match &shader.expr(id).kind {
            ExprKind::Name(own) => break own == name,
            ExprKind::Paren(base) | ExprKind::Index { base, .. } | ExprKind::Field { base, .. } => id = *base,
            _ => break false,
        }
    };
    shader.arena().iter().any(|(_, expr)| matches!(&expr.kind, ExprKind::Assign { target, .. } if is(*target)))
}

/// How a name, or a member, is used.
#[derive(Default)]
struct Asked {
    /// Members that are no components of vectors.
    members: Vec<String>,
    indexed: bool,
}

impl Asked {
    /// Of the expressions that `is` tells.
    fn of(shader: &Shader, is: &dyn Fn(ExprId) -> bool) -> Self {
        let mut asked = Self::default();
        for (id, expr) in shader.arena().iter() {
            match &expr.kind {
                ExprKind::Index { .. } => {
                    let (root, _) = root(shader, id);
                    asked.indexed |= is(root);
                }
                ExprKind::Field { base, field } if !is_swizzle(&field.name) => {
                    let (root, indexed) = root(shader, *base);
                    if is(root) {
                        asked.indexed |= indexed;
                        if !asked.members.contains(&field.name) {
                            asked.members.push(field.name.clone());
                        }
                    }
                }
                _ => {}
            }
        }
        asked
    }
}

impl<'p> Search<'p> {
    pub(super) fn new(parse: &'p Parse<'p>, plain: &Parsed) -> Self {
        let precision = if plain.shader.version().profile == Profile::Es { "highp " } else { "" };
        let text = plain.shader.file().text().to_owned();
        Self { parse, done: Completed::default(), precision, text, read: 0 }
    }

    /// All that stands for what the text lacks.
    pub(super) fn run(mut self, plain: &Parsed, offers: &mut Offers<'_>, siblings: &mut Siblings<'_>) -> Completed {
        self.includes(plain);
        self.siblings(siblings);
        self.empty_macros();
        self.structures();
        let (declared, empty, parse) = (self.done.declared.clone(), self.done.assumed.clone(), self.parse);
        let with = |macros: &Assumed| parse(&with_macros(&[&empty[..], macros].concat(), &declared));
        if let Some(mut found) = macros::names(&with, offers) {
            found.assumed.splice(0..0, empty.iter().cloned());
            self.done = Completed { declared, ..found };
            self.drop_macros();
        }
        self.rest();
        self.done
    }

    /// Puts in other files that define functions which are lacking, if they bring no errors.
    fn siblings(&mut self, siblings: &mut Siblings<'_>) {
        let (mut tried, mut files): (Vec<String>, usize) = (Vec::new(), 0);
        loop {
            let parsed = self.parsed();
            let lacking = parsed.shader.lacking().iter().filter(|(_, what)| *what == Lacks::Function);
            let names: Vec<String> =
                lacking.map(|(name, _)| name.clone()).filter(|name| !tried.contains(name)).collect();
            if names.is_empty() {
                return;
            }
            let before = self.others(&parsed);
            for Sibling { file, functions } in siblings(&names) {
                if files == MOST_FILES {
                    return;
                }
                let now = self.parsed();
                let open = |name: &&String| now.shader.lacking().iter().any(|(lacking, _)| lacking == *name);
                let used: Vec<String> = functions.iter().filter(open).cloned().collect();
                let Some(place) = used.iter().map(|name| self.place(&now.shader, name)).max() else { continue };
                self.add_at(place, file.name(), Form::File(file.clone(), functions));
                let with = self.parsed();
                let left = with.shader.lacking().iter().any(|(name, _)| used.contains(name));
                if left || self.others(&with) > before {
                    self.done.declared.pop();
                } else {
                    files += 1;
                }
            }
            tried.extend(names);
        }
    }

    /// Takes words in capitals that stand where a declaration or a statement is expected for macros that hold nothing.
    fn empty_macros(&mut self) {
        while self.done.assumed.len() < MOST_EMPTY {
            let parsed = self.parsed();
            let word = parsed.diagnostics.iter().find_map(|error| {
                let word = parsed.shader.file().slice(error.span);
                (error.code == errors::SYNTAX && syntax::is_macro(word)).then(|| word.to_owned())
            });
            let before = self.others(&parsed);
            let Some(word) = word.filter(|word| self.done.assumed.iter().all(|(known, _)| known != word)) else {
                return;
            };
            self.done.assumed.push((word, String::new()));
            let parsed = self.parsed();
            if self.others(&parsed) >= before {
                self.done.assumed.pop();
                return;
            }
        }
    }

    /// Drops assumed macros with which the text has more errors than without.
    fn drop_macros(&mut self) {
        let mut k = 0;
        while k < self.done.assumed.len() {
            let with = self.parsed();
            let before = self.others(&with);
            let own = self.done.assumed.remove(k);
            let without = self.parsed();
            if before <= self.others(&without) {
                self.done.assumed.insert(k, own);
                k += 1;
            }
        }
    }

    /// Leaves out lines that ask for files which are not there.
    fn includes(&mut self, plain: &Parsed) {
        for line in includes(plain) {
            let name = plain.shader.file().slice(line).trim().to_owned();
            let before_end = plain.shader.file().text().len() - line.start;
            if self.done.declared.iter().all(|known| known.before_end != before_end) {
                self.add_at(before_end, &name, Form::Include(line.len()));
            }
        }
    }

    fn parsed(&mut self) -> Parsed {
        let parsed = (self.parse)(&self.done);
        self.read += parsed.shader.file().text().len();
        parsed
    }

    fn is_done(&self) -> bool {
        self.done.declared.len() >= MOST || self.read >= MOST_READ || interrupt::asked()
    }

    /// Declares the types that are lacking and of which members are asked for.
    fn structures(&mut self) {
        let parsed = self.parsed();
        for (name, what) in parsed.shader.lacking() {
            if *what == Lacks::Type {
                self.add(&parsed.shader, name, Form::Structure(Vec::new()));
            }
        }
        if self.done.declared.is_empty() {
            return;
        }
        let shader = self.parsed().shader;
        let has_members = |name: &str| {
            let asked = Asked::of(&shader, &|id| matches!(shader.type_of(id), Type::Struct(own) if own.name == name));
            let of_array =
                |id: ExprId| matches!(shader.type_of(id).clone(), Type::Array(ty, _) if ty.to_string() == name);
            !asked.members.is_empty() || !Asked::of(&shader, &of_array).members.is_empty()
        };
        let mut stands = std::mem::take(&mut self.done.declared);
        stands.retain_mut(|stand| {
            if matches!(stand.form, Form::Include(_) | Form::File(..)) {
                return true;
            }
            let made = made_of(&shader, &stand.name);
            let is_made = made.is_some();
            stand.form = Form::Structure(made.unwrap_or_default());
            is_made || has_members(&stand.name)
        });
        self.done.declared = stands;
        self.members();
    }

    /// Declares all that is lacking.
    fn rest(&mut self) {
        loop {
            self.members();
            if self.is_done() {
                return;
            }
            let parsed = self.parsed();
            let known = |name: &str| self.done.declared.iter().any(|stand| stand.name == name);
            // What is written takes what is read, and functions come last, when the types of their arguments are known.
            let rank = |(name, what): &(String, Lacks)| match what {
                Lacks::Type => 0,
                Lacks::Value if !is_written(&parsed.shader, name) => 1,
                Lacks::Value => 2,
                Lacks::Function => 3,
            };
            let open = parsed.shader.lacking().iter().filter(|(name, _)| !known(name));
            let Some((name, what)) = open.min_by_key(|lack| rank(lack)).cloned() else { return };
            self.declare(&parsed, &name, what);
        }
    }

    fn declare(&mut self, parsed: &Parsed, name: &str, what: Lacks) {
        let shader = &parsed.shader;
        match what {
            Lacks::Type => self.add(shader, name, Form::Structure(Vec::new())),
            Lacks::Value => {
                let is = |id: ExprId| matches!(&shader.expr(id).kind, ExprKind::Name(own) if own == name);
                let asked = Asked::of(shader, &is);
                let mut shapes = self.shapes(shader, (name, self.place(shader, name)), &asked);
                let written = is_written(shader, name);
                // Outputs are colours and positions.
                shapes.sort_by_key(|shape| written && shape.ty != "vec4");
                // What a piece writes is what other texts hand on; a stage gives what it writes.
                let storages: &[&str] = match (written, shader.function("main")) {
                    (true, None) => &["", "out"],
                    (true, Some(_)) => &["out", ""],
                    (false, _) => &["uniform"],
                };
                let with =
                    |storage: &'static str| shapes.iter().map(move |shape| Form::Variable(storage, shape.clone()));
                let mut forms: Vec<Form> = storages.iter().copied().flat_map(with).collect();
                let textures: &[&str] = if written || !asked.members.is_empty() { &[] } else { &TEXTURES };
                for ty in textures {
                    let shape = Shape { count: asked.indexed.then_some(ELEMENTS[0]), ..Shape::one(*ty) };
                    forms.push(Form::Variable("uniform", shape));
                }
                self.choose(parsed, name, forms);
            }
            Lacks::Function => {
                let known = |heading: &str| self.done.assumed.iter().any(|(known, _)| known == heading);
                if let Some(access) = access(shader, name).filter(|(heading, _)| !known(heading)) {
                    self.done.assumed.push(access);
                    return;
                }
                let overloads = overloads(shader, name);
                let structures = structures(shader).into_iter().map(Gives::Always);
                let plain = NUMBERS.iter().map(|ty| Gives::Always((*ty).to_owned()));
                let number = |param: &Param| Type::from_name(&param.ty).is_some_and(|ty| ty.scalar().is_some());
                let first = overloads.iter().all(|params| params.first().is_some_and(number)).then_some(Gives::First);
                let void = Gives::Always("void".to_owned());
                let all = first.into_iter().chain(plain).chain(structures).chain([void]);
                let forms = all.map(|gives| Form::Function(overloads.clone(), gives)).collect();
                self.choose(parsed, name, forms);
            }
        }
    }

    /// What a variable or a member may be that is used so.
    fn shapes(&mut self, shader: &Shader, (name, before_end): (&str, usize), asked: &Asked) -> Vec<Shape> {
        let mut types: Vec<String> = Vec::new();
        if asked.members.is_empty() {
            let by_name = words(name).iter().any(|word| MATRICES.contains(&word.as_str()));
            types.extend(by_name.then_some("mat4").into_iter().chain(NUMBERS).map(str::to_owned));
            types.extend(structures(shader));
        } else {
            types.extend(structures(shader).into_iter().filter(|ty| {
                let has = |own: &Stand| match &own.form {
                    Form::Structure(members) => {
                        own.name == *ty
                            && asked.members.iter().all(|asked| members.iter().any(|(name, _)| name == asked))
                    }
                    Form::Variable(..) | Form::Function(..) | Form::Include(_) | Form::File(..) => false,
                };
                let assumed = |own: &Stand| own.name == *ty;
                !self.done.declared.iter().any(assumed) || self.done.declared.iter().any(has)
            }));
            let made = format!("{}{MADE}", name.trim_end_matches('_'));
            if !self.done.declared.iter().any(|stand| stand.name == made) {
                self.add_at(before_end, &made, Form::Structure(Vec::new()));
            }
            types.push(made);
        }
        let one = |count: Option<u32>| types.iter().map(move |ty| Shape { ty: ty.clone(), count });
        let arrays: Vec<Shape> =
            if asked.indexed { ELEMENTS.into_iter().flat_map(|count| one(Some(count))).collect() } else { Vec::new() };
        arrays.into_iter().chain(one(None)).collect()
    }

    fn add(&mut self, shader: &Shader, name: &str, form: Form) {
        self.add_at(self.place(shader, name), name, form);
    }

    /// Where a name has to be declared, in bytes before the end of the text as it is.
    fn place(&self, shader: &Shader, name: &str) -> usize {
        declared::back(&self.done.declared, &self.text, place(shader, name))
    }

    fn add_at(&mut self, before_end: usize, name: &str, form: Form) {
        self.done.declared.push(Stand { name: name.to_owned(), before_end, form, precision: self.precision });
    }

    /// Declares a name as the first of some forms with which the text has no more errors, or the fewest.
    fn choose(&mut self, parsed: &Parsed, name: &str, forms: Vec<Form>) {
        let before = self.others(parsed);
        let Some(first) = forms.first().cloned() else { return };
        self.add(&parsed.shader, name, first);
        let at = self.done.declared.len() - 1;
        self.best(before, forms, &|declared, form| declared[at].form = form);
    }

    /// Sets the first of some options with which the text has no more errors than `before`, or the fewest.
    fn best<T: Clone>(&mut self, before: usize, options: Vec<T>, set: &dyn Fn(&mut [Stand], T)) {
        let mut best: Option<(usize, T)> = None;
        for option in options {
            set(&mut self.done.declared, option.clone());
            let parsed = self.parsed();
            let found = self.others(&parsed);
            if best.as_ref().is_none_or(|(least, _)| found < *least) {
                best = Some((found, option));
            }
            if found <= before || self.is_done() {
                break;
            }
        }
        if let Some((_, option)) = best {
            set(&mut self.done.declared, option);
        }
    }

    /// Errors beside those about names that nothing declares, and about members that assumed structures do not have yet.
    fn others(&self, parsed: &Parsed) -> usize {
        const NAMES: [Code; 3] = [errors::UNKNOWN_NAME, errors::UNKNOWN_FUNCTION, errors::UNKNOWN_TYPE];
        let found = parsed.diagnostics.iter().filter(|d| d.severity == Severity::Error && !NAMES.contains(&d.code));
        found.filter(|d| self.member_at(parsed, d).is_none()).count()
    }

    /// The assumed structure, and its member, that an error says is lacking.
    fn member_at(&self, parsed: &Parsed, error: &Diagnostic) -> Option<(usize, String)> {
        if error.code != errors::UNKNOWN_FIELD {
            return None;
        }
        let shader = &parsed.shader;
        shader.arena().iter().find_map(|(_, expr)| {
            let ExprKind::Field { base, field } = &expr.kind else { return None };
            let Type::Struct(own) = shader.type_of(*base) else { return None };
            let of = self.done.declared.iter().position(|stand| stand.name == own.name)?;
            field.span.touches(error.span).then(|| (of, field.name.clone()))
        })
    }

    /// Declares members of assumed structures that are asked for.
    fn members(&mut self) {
        while !self.is_done() {
            let parsed = self.parsed();
            let shader = &parsed.shader;
            let Some((of, member)) = parsed.diagnostics.iter().find_map(|d| self.member_at(&parsed, d)) else { return };
            let Stand { name: structure, before_end, .. } = self.done.declared[of].clone();
            let is = |id: ExprId| match &shader.expr(id).kind {
                ExprKind::Field { base, field } => {
                    field.name == member && matches!(shader.type_of(*base), Type::Struct(own) if own.name == structure)
                }
                _ => false,
            };
            let asked = Asked::of(shader, &is);
            let before = self.others(&parsed);
            let called = format!("{}_{member}", structure.trim_end_matches('_'));
            let mut shapes = self.shapes(shader, (&called, before_end), &asked);
            if let Form::Structure(members) = &self.done.declared[of].form {
                let mut free: Vec<Shape> = free(members).map(|(_, shape)| shape.clone()).collect();
                free.sort_by_key(|shape| shapes.iter().position(|own| own == shape).unwrap_or(usize::MAX));
                if !free.is_empty() {
                    self.best(before, free, &|declared, shape| call(&mut declared[of].form, &member, &shape));
                    continue;
                }
            }
            if asked.members.is_empty() {
                shapes.extend(TEXTURES.iter().map(|ty| Shape::one(*ty)));
            }
            let Form::Structure(members) = &mut self.done.declared[of].form else { return };
            members.push((member, Shape::one("float")));
            self.best(before, shapes, &|declared, shape| {
                if let Form::Structure(members) = &mut declared[of].form
                    && let Some((_, own)) = members.last_mut()
                {
                    *own = shape;
                }
            });
        }
    }
}

/// Lines that ask for files which are not there, in the words of any preprocessor: `#include`, `@import`.
pub(super) fn includes(plain: &Parsed) -> Vec<Span> {
    let file = plain.shader.file();
    let text = file.text();
    let line = |error: &Diagnostic| {
        let start = text[..error.span.start].rfind('\n').map_or(0, |at| at + 1);
        Span::new(start, text[start..].find('\n').map_or(text.len(), |len| start + len))
    };
    let asks = |line: &Span| {
        let words = file.slice(*line).trim_start().strip_prefix(['#', '@']);
        words.is_some_and(|words| ["include", "import"].iter().any(|word| words.trim_start().starts_with(word)))
    };
    let found = plain.diagnostics.iter().filter(|d| [errors::INCLUDE, errors::TOKEN].contains(&d.code));
    found.map(line).filter(asks).collect()
}

/// Structures that the text declares.
fn structures(shader: &Shader) -> Vec<String> {
    let named = |item: &Item| match &item.kind {
        ItemKind::Declaration(declaration) => match &declaration.ty.kind {
            TypeKind::Struct(own) => own.name.as_ref().map(|name| name.name.clone()),
            TypeKind::Named(_) => None,
        },
        _ => None,
    };
    shader.unit().items.iter().filter_map(named).collect()
}

/// Members that nothing asks for by name.
fn free(members: &[(String, Shape)]) -> impl Iterator<Item = &(String, Shape)> {
    members.iter().enumerate().filter(|(k, (name, _))| *name == unnamed(*k)).map(|(_, member)| member)
}

/// What a member is called that a structure is made with.
fn unnamed(k: usize) -> String {
    format!("member{k}")
}

/// Calls the first member that nothing asks for, and that has this shape, `name`; none else.
fn call(form: &mut Form, name: &str, shape: &Shape) {
    let Form::Structure(members) = form else { return };
    for (k, (own, _)) in members.iter_mut().enumerate().filter(|(_, (own, _))| own == name) {
        *own = unnamed(k);
    }
    let fits = |(k, (own, of)): &(usize, &mut (String, Shape))| *own == unnamed(*k) && of == shape;
    if let Some((_, (own, _))) = members.iter_mut().enumerate().find(fits) {
        name.clone_into(own);
    }
}

/// Members of a structure that is made of several values, by the first place that makes one.
fn made_of(shader: &Shader, name: &str) -> Option<Vec<(String, Shape)>> {
    let made = shader.arena().iter().find_map(|(_, expr)| match &expr.kind {
        ExprKind::Call { callee: Callee::Name(own), args } if own.name == name && args.len() > 1 => Some(args),
        _ => None,
    })?;
    let member = |(k, arg): (usize, &ExprId)| (unnamed(k), Shape::one(param(shader, *arg, 0).ty));
    Some(made.iter().enumerate().map(member).collect())
}

/// The parameters of each overload of a function that is called, by the arguments that it gets.
fn overloads(shader: &Shader, name: &str) -> Vec<Vec<Param>> {
    let mut all: Vec<Vec<Param>> = Vec::new();
    for (_, expr) in shader.arena().iter() {
        let ExprKind::Call { callee: Callee::Name(own), args } = &expr.kind else { continue };
        if own.name != name {
            continue;
        }
        let params: Vec<Param> = args.iter().map(|arg| param(shader, *arg, expr.span.start)).collect();
        match all.iter_mut().find(|known| known.iter().map(|p| &p.ty).eq(params.iter().map(|p| &p.ty))) {
            // What has a value at one of the calls is given.
            Some(known) => known.iter_mut().zip(params).for_each(|(known, param)| known.out &= param.out),
            None => all.push(params),
        }
    }
    all
}

fn param(shader: &Shader, arg: ExprId, call: usize) -> Param {
    let ty = match shader.type_of(arg) {
        Type::Error | Type::Void => "float".to_owned(),
        ty => ty.to_string(),
    };
    let text = shader.file().text();
    let is_empty = |symbol: SymbolId| {
        let Symbol { kind, span, .. } = shader.symbol(symbol);
        let behind = span.map_or("", |span| text[span.end..].trim_start());
        let written = || shader.uses_of(symbol).any(|own| own.access.writes() && own.span.start < call);
        *kind == SymbolKind::Local && behind.starts_with([';', ',']) && !written()
    };
    Param { ty, out: shader.symbol_of(arg).is_some_and(is_empty) }
}

/// Where a name has to be declared, in bytes before the end of the text: behind the item before the one that uses it first.
fn place(shader: &Shader, name: &str) -> usize {
    let file = shader.file();
    let word = |token: &&Token| {
        token.kind == TokenKind::Word && token.place == TokenPlace::Text && file.slice(token.span) == name
    };
    let tokens = shader.tokens().iter().filter(word).map(|token| token.span.start);
    let named = |(_, expr): (ExprId, &Expr)| match &expr.kind {
        ExprKind::Name(own) => (own == name).then_some(expr.span.start),
        ExprKind::Call { callee: Callee::Name(own), .. } => (own.name == name).then_some(expr.span.start),
        _ => None,
    };
    let end = file.text().len();
    let first = tokens.chain(shader.arena().iter().filter_map(named)).min().unwrap_or(end);
    let items = &shader.unit().items;
    let of = items.partition_point(|item| item.span.start <= first).saturating_sub(1);
    let before = of.checked_sub(1).map(|before| items[before].span.end);
    let own = items.get(of).map_or(0, |item| item.span.start);
    end - before.unwrap_or(own).min(end)
}
