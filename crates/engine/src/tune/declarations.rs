//! Declarations of a shader that can have another precision, and the texts that give it to them.

use serde::{Deserialize, Serialize};

use super::coordinates::{Coordinates, coordinates};
use crate::improve::own_span;
use base::text::{Edit, EditList, SourceFile, Span};
use syntax::Shader;
use syntax::ast::{
    Block, Condition, Declaration as Declared, ExprId, ItemKind, Precision, Qualifiers, Stmt, StmtKind, TypeKind,
    TypeSpecifier,
};
use syntax::interface::Storage;
use syntax::precision::Precisions;
use syntax::symbols::{FunctionId, SymbolId, SymbolKind};
use syntax::types::{OpaqueKind, ScalarType, Type};

/// A declaration with one precision for all that it declares.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Declaration {
    /// What it declares: `uniform u_size`, `a, b`, `the result of f`.
    pub what: String,
    /// `name:line:column`.
    pub at: String,
    /// The precision that it has, stated or by default; none where its text has no precisions.
    #[serde(with = "stated")]
    pub now: Option<Precision>,
    /// It carries the coordinate of a texel.
    pub coordinate: bool,
    /// That coordinate is multiplied, or of unknown size: it may repeat the texture.
    pub repeats: bool,
    /// It is a sampler: what is read from it has this precision.
    pub sampler: bool,
    /// Where a word goes that states one: before the type, here and in each prototype.
    #[serde(skip)]
    places: Vec<DeclaredPlace>,
    /// What it declares.
    #[serde(skip)]
    symbols: Vec<SymbolId>,
    /// The function whose result it is.
    #[serde(skip)]
    function: Option<FunctionId>,
    /// Names of members of a structure.
    #[serde(skip)]
    members: Vec<String>,
}

impl Declaration {
    /// True where `highp` is written at it.
    pub(super) fn is_stated_high(&self) -> bool {
        self.now == Some(Precision::High) && self.places.first().is_some_and(|place| place.stated.is_some())
    }

    pub(super) fn symbols(&self) -> &[SymbolId] {
        &self.symbols
    }

    /// Whether it carries a coordinate, and whether that is multiplied.
    fn carried(&self, found: &Coordinates) -> Option<bool> {
        let symbols = self.symbols.iter().filter_map(|symbol| found.symbols.get(symbol));
        let function = self.function.iter().filter_map(|function| found.functions.get(function));
        let members = self.members.iter().filter_map(|member| found.members.get(member));
        symbols.chain(function).chain(members).copied().reduce(|a, b| a || b)
    }
}

#[derive(Clone, Debug, PartialEq)]
struct DeclaredPlace {
    stated: Option<Span>,
    before: usize,
}

/// All that can be changed in a file.
#[derive(Clone, Debug)]
pub struct Declarations {
    /// Each declaration, in the order of the text.
    pub all: Vec<Declaration>,
    /// The word of the last `precision … float;` at file scope, and what it says.
    default: Option<(Span, Precision)>,
    /// Something that is not among these takes the default.
    pinned: bool,
}

/// The word of a precision.
pub fn word(precision: Precision) -> &'static str {
    match precision {
        Precision::Low => "lowp",
        Precision::Medium => "mediump",
        Precision::High => "highp",
    }
}

/// Precisions by their words, where they are written down.
mod stated {
    use super::{Precision, word};
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(precision: &Option<Precision>, to: S) -> Result<S::Ok, S::Error> {
        precision.map(word).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Precision>, D::Error> {
        let Some(stated) = Option::<String>::deserialize(from)? else { return Ok(None) };
        let all = [Precision::Low, Precision::Medium, Precision::High];
        let known = all.into_iter().find(|precision| word(*precision) == stated);
        known.map(Some).ok_or_else(|| D::Error::custom(format!("there is no precision `{stated}`")))
    }
}

impl Declarations {
    /// The declarations that `entry` depends on, of those that stand in the author's file.
    pub fn of(shader: &Shader, file: &SourceFile, entry: FunctionId, precisions: &Precisions) -> Self {
        let reached = shader.reachable(entry);
        let used = shader.used_by(&reached).into_iter().collect();
        let own = Self { all: Vec::new(), default: None, pinned: false };
        let mut finder = DeclarationFinder {
            shader,
            file,
            precisions,
            used,
            own,
            given: Vec::new(),
            returned: Vec::new(),
            function: entry,
        };
        finder.unit(&reached);
        let carried = coordinates(shader, &finder.given, &finder.returned);
        for one in &mut finder.own.all {
            let found = one.carried(&carried);
            (one.coordinate, one.repeats) = (found.is_some(), found == Some(true));
        }
        finder.own.all.sort_by_key(|declaration| declaration.places.first().map(|place| place.before));
        finder.own
    }

    /// The file with `highp` for the chosen and `mediump` for the others, each stated where it is declared. Samplers that
    /// are `lowp` are `mediump`: `lowp` has every colour of 8 bits (GLSL ES 3.00, 4.5.1), which is what they are for.
    pub fn stated(&self, file: &SourceFile, high: &[bool]) -> SourceFile {
        let mut edits = EditList::new();
        for (declaration, high) in self.all.iter().zip(high) {
            let wanted = if *high { Precision::High } else { Precision::Medium };
            declaration.places.iter().for_each(|place| edits.push(place.edit(wanted)));
        }
        applied(file, &edits)
    }

    /// The fewest edits that give the chosen `highp` and leave the others lower.
    pub fn patch(&self, file: &SourceFile, high: &[bool]) -> SourceFile {
        let wanted: Vec<Option<Precision>> =
            self.all.iter().zip(high).map(|(one, high)| wanted(one.now, *high)).collect();
        let needs = |default: Option<Precision>| {
            let differs = |(one, wanted): (&Declaration, &Option<Precision>)| {
                let has = match one.places.first().and_then(|place| place.stated) {
                    Some(_) => one.now,
                    None if default.is_some() && !one.sampler => default,
                    None => one.now,
                };
                has != *wanted
            };
            self.all.iter().zip(&wanted).map(differs).collect::<Vec<bool>>()
        };
        let count = |all: &[bool]| all.iter().filter(|differs| **differs).count();
        let mut chosen = needs(None);
        let mut edits = EditList::new();
        if let Some((span, now)) = self.default.filter(|_| !self.pinned) {
            for other in [Precision::Medium, Precision::High].into_iter().filter(|other| *other != now) {
                let with = needs(Some(other));
                if count(&with) + 1 < count(&chosen) || (count(&with) == 0 && count(&chosen) > 0) {
                    chosen = with;
                    edits = EditList::new();
                    edits.push(Edit::replace(span, word(other)));
                }
            }
        }
        for ((declaration, wanted), _) in self.all.iter().zip(wanted).zip(chosen).filter(|(_, differs)| *differs) {
            let Some(wanted) = wanted else { continue };
            declaration.places.iter().for_each(|place| edits.push(place.edit(wanted)));
        }
        applied(file, &edits)
    }
}

/// What a declaration is to be: what is lower stays as low as it is.
pub fn wanted(now: Option<Precision>, high: bool) -> Option<Precision> {
    match (now, high) {
        (_, true) => Some(Precision::High),
        (Some(Precision::Low), false) => Some(Precision::Low),
        (_, false) => Some(Precision::Medium),
    }
}

fn applied(file: &SourceFile, edits: &EditList) -> SourceFile {
    // Declarations lie beside each other, so that no two edits meet.
    let text = edits.apply(file.text()).map_or_else(|_| file.text().to_owned(), |edited| edited.text);
    SourceFile::new(file.name(), text)
}

impl DeclaredPlace {
    fn edit(&self, precision: Precision) -> Edit {
        match self.stated {
            Some(span) => Edit::replace(span, word(precision)),
            None => Edit::insert(self.before, format!("{} ", word(precision))),
        }
    }
}

struct DeclarationFinder<'a> {
    shader: &'a Shader,
    file: &'a SourceFile,
    precisions: &'a Precisions,
    used: Vec<SymbolId>,
    own: Declarations,
    /// Variables with their initialisers.
    given: Vec<(SymbolId, ExprId)>,
    /// What functions return.
    returned: Vec<(FunctionId, ExprId)>,
    /// The function whose body is looked at.
    function: FunctionId,
}

impl DeclarationFinder<'_> {
    fn unit(&mut self, reached: &[FunctionId]) {
        let shader = self.shader;
        for item in &shader.unit().items {
            match &item.kind {
                ItemKind::Declaration(declaration) => self.declaration(declaration),
                ItemKind::Block(block) => block.members.iter().for_each(|member| self.declaration(member)),
                ItemKind::Precision(statement) if named(&statement.ty) == Some("float") => {
                    let own = own_span(shader, self.file, item.span);
                    let word = own.and_then(|span| {
                        let text = self.file.slice(span);
                        let at = text.find(word(statement.precision))?;
                        Some(Span::new(span.start + at, span.start + at + word(statement.precision).len()))
                    });
                    self.own.pinned |= word.is_none() || self.own.default.is_some();
                    self.own.default = word.map(|word| (word, statement.precision));
                }
                _ => {}
            }
        }
        for &id in reached {
            let info = shader.function_info(id);
            let items: Vec<usize> = info.prototypes.iter().copied().chain(info.definition).collect();
            let heads: Vec<_> = items
                .iter()
                .filter_map(|&item| match &shader.unit().items[item].kind {
                    ItemKind::Function(function) => Some(function),
                    _ => None,
                })
                .collect();
            let Some(definition) = heads.last() else { continue };
            if is_real(&info.return_type) {
                let all = heads.iter().map(|head| (&head.qualifiers, &head.return_type));
                let now = self.precisions.of_result(id);
                let before = self.own.all.len();
                self.add(format!("the result of {}", info.name.name), info.name.span, now, all.collect(), Vec::new());
                self.own.all[before..].iter_mut().for_each(|one| one.function = Some(id));
            }
            for (k, known) in info.params.iter().enumerate().filter(|(_, known)| is_real(&known.ty)) {
                let (Some(symbol), Some(name)) = (known.symbol, &known.name) else { continue };
                let all = heads.iter().filter_map(|head| head.params.get(k));
                let all = all.map(|param| (&param.qualifiers, &param.ty)).collect();
                let now = self.precisions.of_symbol(symbol);
                self.add(format!("{} of {}", name.name, info.name.name), name.span, now, all, vec![symbol]);
            }
            if let Some(body) = &definition.body {
                self.function = id;
                self.block(body);
            }
        }
    }

    fn block(&mut self, block: &Block) {
        block.statements.iter().for_each(|statement| self.statement(statement));
    }

    fn statement(&mut self, statement: &Stmt) {
        match &statement.kind {
            StmtKind::Declaration(declaration) => self.declaration(declaration),
            StmtKind::Block(block) | StmtKind::Switch { body: block, .. } => self.block(block),
            StmtKind::If { then, otherwise, .. } => {
                self.statement(then);
                otherwise.iter().for_each(|other| self.statement(other));
            }
            StmtKind::For { init, condition, body, .. } => {
                self.statement(init);
                self.condition(condition.as_ref());
                self.statement(body);
            }
            StmtKind::While { condition, body } => {
                self.condition(Some(condition));
                self.statement(body);
            }
            StmtKind::DoWhile { body, .. } => self.statement(body),
            StmtKind::Return(Some(value)) => self.returned.push((self.function, *value)),
            // A default inside of a function reaches to the end of its block.
            StmtKind::Precision(_) => self.own.pinned = true,
            _ => {}
        }
    }

    fn condition(&mut self, condition: Option<&Condition>) {
        if let Some(Condition::Declaration(declaration)) = condition {
            self.declaration(declaration);
        }
    }

    fn declaration(&mut self, declaration: &Declared) {
        if let TypeKind::Struct(structure) = &declaration.ty.kind {
            for member in &structure.members {
                let names: Vec<&str> = member.declarators.iter().map(|one| one.name.name.as_str()).collect();
                let of = structure.name.as_ref().map_or("a structure", |name| &name.name);
                let real = named(&member.ty).and_then(Type::from_name).is_some_and(|ty| is_real(&ty));
                if let (true, Some(first)) = (real, member.declarators.first()) {
                    let now = member.qualifiers.precision().map(|(precision, _)| precision);
                    let now = now.or_else(|| self.own.default.map(|(_, default)| default));
                    let all = vec![(&member.qualifiers, &member.ty)];
                    let before = self.own.all.len();
                    self.add(format!("{} of {of}", names.join(", ")), first.name.span, now, all, Vec::new());
                    for one in &mut self.own.all[before..] {
                        one.members = names.iter().map(|name| (*name).to_owned()).collect();
                    }
                }
            }
            return;
        }
        let symbols: Vec<SymbolId> =
            declaration.declarators.iter().filter_map(|one| self.symbol(one.name.span)).collect();
        for one in &declaration.declarators {
            self.given.extend(self.symbol(one.name.span).zip(one.initializer.as_ref().map(|value| value.value)));
        }
        let Some(&first) = symbols.first() else { return };
        if !symbols.iter().any(|symbol| self.used.contains(symbol)) {
            return;
        }
        let symbol = self.shader.symbol(first);
        let now = self.precisions.of_symbol(first);
        if is_sampler(&symbol.ty) {
            // What is stated to be more than `lowp` stays: only its author knows what the texture holds.
            let low = declaration.qualifiers.precision().is_none_or(|(precision, _)| precision == Precision::Low);
            if !low || self.place(&declaration.qualifiers, &declaration.ty).is_none() {
                return;
            }
        } else if !is_real(&symbol.ty) {
            return;
        }
        let names: Vec<&str> = declaration.declarators.iter().map(|one| one.name.name.as_str()).collect();
        let storage = match symbol.kind {
            _ if is_sampler(&symbol.ty) => "sampler ",
            SymbolKind::Global(Storage::Uniform) => "uniform ",
            SymbolKind::Global(Storage::In) => "input ",
            SymbolKind::Global(Storage::Out) => "output ",
            SymbolKind::BlockMember(_) => "member ",
            _ => "",
        };
        let at = declaration.declarators.first().map_or(declaration.span, |one| one.name.span);
        let of = vec![(&declaration.qualifiers, &declaration.ty)];
        self.add(format!("{storage}{}", names.join(", ")), at, now, of, symbols);
    }

    fn symbol(&self, name: Span) -> Option<SymbolId> {
        self.shader.symbols().find(|(_, symbol)| symbol.span == Some(name)).map(|(id, _)| id)
    }

    /// Where the precision of a declaration is written; none where that is in a macro or in another file.
    fn place(&self, qualifiers: &Qualifiers, ty: &TypeSpecifier) -> Option<DeclaredPlace> {
        let own = |span: Span| own_span(self.shader, self.file, span);
        let (written, name) = (own(ty.name_span)?, named(ty)?);
        (self.file.slice(written) == name).then_some(())?;
        let stated = match qualifiers.precision() {
            Some((precision, span)) => Some(own(span).filter(|own| self.file.slice(*own) == word(precision))?),
            None => None,
        };
        Some(DeclaredPlace { stated, before: written.start })
    }

    fn add(
        &mut self,
        what: String,
        at: Span,
        now: Option<Precision>,
        of: Vec<(&Qualifiers, &TypeSpecifier)>,
        symbols: Vec<SymbolId>,
    ) {
        let places: Option<Vec<DeclaredPlace>> = of.iter().map(|(qualifiers, ty)| self.place(qualifiers, ty)).collect();
        let Some(mut places) = places.filter(|places| !places.is_empty()) else {
            self.own.pinned = true;
            return;
        };
        places.dedup();
        let (file, span) = self.shader.file().origin(at);
        let sampler = symbols.iter().any(|symbol| is_sampler(&self.shader.symbol(*symbol).ty));
        let at = file.locate(span.start);
        let (coordinate, repeats, function, members) = (false, false, None, Vec::new());
        self.own.all.push(Declaration {
            what,
            at,
            now,
            coordinate,
            repeats,
            sampler,
            places,
            symbols,
            function,
            members,
        });
    }
}

fn named(ty: &TypeSpecifier) -> Option<&str> {
    match &ty.kind {
        TypeKind::Named(name) => Some(name),
        TypeKind::Struct(_) => None,
    }
}

fn element(mut ty: &Type) -> &Type {
    while let Type::Array(inner, _) = ty {
        ty = inner;
    }
    ty
}

fn is_real(ty: &Type) -> bool {
    element(ty).scalar() == Some(ScalarType::Float)
}

fn is_sampler(ty: &Type) -> bool {
    matches!(element(ty), Type::Opaque(opaque) if opaque.kind == OpaqueKind::Sampler)
}
