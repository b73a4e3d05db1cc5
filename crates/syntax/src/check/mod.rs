//! Names, types and the stage interface of a syntax tree. Follows the order of the text, because
//! a name is known from its declaration on (GLSL 4.60 specification, section 4.2).

mod block;
mod call;
mod captured;
mod constant;
mod declaration;
mod declared;
mod expression;
mod functions;
mod index;
mod layouts;
mod lvalue;
mod meeting;
mod offsets;
mod operator;
mod overload;
mod places;
mod statement;
mod uses;

pub(super) use offsets::extent_of;

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::ast::{Arena, ExprId, Ident, ItemKind, Unit};
use super::builtin;
use super::fold::Const;
use super::interface::{InputPrimitive, Interface, Storage};
use super::language::{Feature, Language};
use super::names::{MOST_SLIPS, nearest};
use super::sink::Sink;
use super::symbols::{CallTarget, FunctionId, FunctionInfo, Symbol, SymbolId, SymbolKind, Use};
use super::types::{Conversions, OpaqueType, StructType, Type};
use super::{Lacks, Stage, errors};
use base::text::Span;
use expression::with_near;

/// What the checker finds out, beside diagnostics.
#[derive(Debug, Default)]
pub(crate) struct Checked {
    pub types: Vec<Type>,
    pub values: Vec<Option<Const>>,
    pub names: Vec<Option<SymbolId>>,
    pub calls: Vec<Option<CallTarget>>,
    pub symbols: Vec<Symbol>,
    pub functions: Vec<FunctionInfo>,
    pub uses: Vec<Use>,
    pub interface: Interface,
    /// A name was met that nothing declares.
    pub unknown: bool,
    /// Such names, each once, in the order in which they are met.
    pub lacking: Vec<(String, Lacks)>,
    /// Uses of what the language has, and neither the version nor the stage.
    pub absent: usize,
}

/// What a name in a scope means.
#[derive(Clone, Debug)]
enum Entry {
    Variable(SymbolId),
    Structure(Arc<StructType>),
}

#[derive(Debug, Default)]
struct Scope {
    entries: HashMap<String, Entry>,
}

struct Checker<'a> {
    unit: &'a Unit,
    arena: &'a Arena,
    stage: Stage,
    language: Language,
    conversions: Conversions,
    sink: &'a mut Sink,
    /// Whether each expression is constant by the rules of the language.
    constant: Vec<bool>,
    /// Local constants that get their value when the shader runs.
    run_time: HashSet<SymbolId>,
    /// Features that were told already.
    reported_features: HashSet<Feature>,
    /// Last members of storage blocks without a size, and instances of such blocks.
    runtime: HashSet<SymbolId>,
    /// Instances of uniform blocks.
    uniform_blocks: HashSet<SymbolId>,
    /// Greatest constant index into arrays that have no size yet.
    most_index: HashMap<SymbolId, i64>,
    /// What loops and switches are around the statement at hand.
    around: statement::Around,
    /// Calls of the interlock that stand above.
    met: Vec<String>,
    /// Origin and centre of the pixel of a `gl_FragCoord` that was declared again.
    fragment_origin: Option<[bool; 2]>,
    /// Functions that each function calls, with the place.
    calls: Vec<(FunctionId, FunctionId, Span)>,
    /// Names of blocks, by storage.
    blocks: HashSet<(Storage, String)>,
    /// A default precision for `float` in a fragment shader of GLSL ES stands above.
    float_precision: bool,
    /// Samplers and images that have a default precision by a statement above, or were told to have none.
    opaque_precisions: Vec<OpaqueType>,
    /// A missing one has been told.
    precision_reported: bool,
    /// A `return` was met in the function at hand.
    returned: bool,
    /// Members of the blocks of built-in variables that were declared again.
    per_vertex: HashMap<Storage, Vec<String>>,
    out: Checked,
    scopes: Vec<Scope>,
    functions: HashMap<String, Vec<FunctionId>>,
    builtins: HashMap<String, SymbolId>,
    /// Unknown names that were told already.
    reported_names: HashSet<String>,
    /// Unknown names are not told at all.
    incomplete: bool,
    /// Names of subroutine types.
    subroutines: HashSet<String>,
    /// Vertices of the input primitive of a geometry stage.
    vertices: Option<u32>,
    /// The function whose body is being checked, and what it returns.
    current: Option<(FunctionId, Type)>,
}

/// Checks a whole shader. When it is `incomplete`, unknown names are not told: they may be
/// declared in a file that is not read.
pub(crate) fn check(
    unit: &Unit,
    arena: &Arena,
    stage: Stage,
    language: Language,
    incomplete: bool,
    sink: &mut Sink,
) -> Checked {
    let integers = language.enabled("ARB_gpu_shader5") || language.enabled("MESA_shader_integer_functions");
    let modern = language.at_least(400, u32::MAX) || language.is_open();
    let to_double = language.has(Feature::Doubles);
    let conversions = Conversions { int_to_uint: modern || integers, to_double };
    let n = arena.len();
    let out = Checked {
        types: vec![Type::Error; n],
        values: vec![None; n],
        names: vec![None; n],
        calls: vec![None; n],
        ..Checked::default()
    };
    let mut checker = Checker {
        unit,
        arena,
        stage,
        language,
        conversions,
        sink,
        constant: vec![false; n],
        run_time: HashSet::new(),
        reported_features: HashSet::new(),
        runtime: HashSet::new(),
        uniform_blocks: HashSet::new(),
        most_index: HashMap::new(),
        around: statement::Around::default(),
        met: Vec::new(),
        fragment_origin: None,
        calls: Vec::new(),
        blocks: HashSet::new(),
        float_precision: false,
        opaque_precisions: Vec::new(),
        precision_reported: false,
        returned: false,
        per_vertex: HashMap::new(),
        out,
        scopes: vec![Scope::default()],
        functions: HashMap::new(),
        builtins: HashMap::new(),
        reported_names: HashSet::new(),
        incomplete,
        subroutines: HashSet::new(),
        vertices: None,
        current: None,
    };
    checker.run();
    let mut out = checker.out;
    out.uses.sort_by_key(|u| (u.span.start, u.expr));
    out
}

impl<'a> Checker<'a> {
    fn run(&mut self) {
        self.vertices = self.input_vertices();
        let unit: &'a Unit = self.unit;
        // What could not be read may have declared the names in it.
        for item in unit.items.iter().filter(|i| i.kind == ItemKind::Error) {
            let text = self.sink.file.slice(item.span);
            let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|w| !w.is_empty());
            self.reported_names.extend(words.map(str::to_owned));
        }
        for (index, item) in unit.items.iter().enumerate() {
            self.item(index, item);
        }
        self.recursion();
        self.whole_stage();
        self.whole_interface();
        let broken = unit.items.iter().any(|i| i.kind == ItemKind::Error);
        let has_main = self.out.functions.iter().any(|f| f.name.name == "main" && f.definition.is_some());
        if self.stage != Stage::Library && !has_main && !broken && !self.incomplete {
            let defined = || self.out.functions.iter().filter(|f| f.definition.is_some()).map(|f| &f.name);
            let near = nearest("main", defined().map(|name| name.name.as_str()));
            let near = near.and_then(|near| defined().find(|name| name.name == near)).cloned();
            let message = format!("this {} shader has no function `main`", self.stage.name());
            let place = near.as_ref().map_or(Span::at(0), |near| near.span);
            let diagnostic = self.sink.start(errors::MISSING_MAIN, place, message);
            self.sink.push(match near {
                Some(near) => diagnostic
                    .with_label("the function with the nearest name")
                    .with_help(format!("is `{}` meant to be `main`?", near.name)),
                None => diagnostic
                    .with_label("no `main` in here")
                    .with_help("add `void main() { … }`; a file of functions only is called `NAME.glsl`"),
            });
        }
    }

    /// Vertices of the input primitive; it may be declared behind the inputs that need it.
    fn input_vertices(&self) -> Option<u32> {
        if self.stage != Stage::Geometry {
            return None;
        }
        self.unit.items.iter().find_map(|item| match &item.kind {
            ItemKind::Qualified(q)
                if q.qualifiers.storage().is_some_and(|s| s.0 == super::ast::StorageQualifier::In) =>
            {
                let mut entries = q.qualifiers.layouts().flat_map(|(entries, _)| entries);
                entries
                    .find_map(|e| InputPrimitive::from_name(&e.key.name.to_ascii_lowercase()))
                    .map(InputPrimitive::vertices)
            }
            _ => None,
        })
    }

    fn scoped<T>(&mut self, run: impl FnOnce(&mut Self) -> T) -> T {
        let (precision, opaque) = (self.float_precision, self.opaque_precisions.len());
        self.scopes.push(Scope::default());
        let result = run(self);
        self.scopes.pop();
        self.float_precision = precision;
        self.opaque_precisions.truncate(opaque);
        result
    }

    fn at_file_scope(&self) -> bool {
        self.scopes.len() == 1
    }

    fn type_of(&self, id: ExprId) -> &Type {
        &self.out.types[id.index()]
    }

    fn value_of(&self, id: ExprId) -> Option<Const> {
        self.out.values[id.index()]
    }

    fn lookup(&self, name: &str) -> Option<&Entry> {
        self.scopes.iter().rev().find_map(|s| s.entries.get(name))
    }

    /// The variable of that name: of the shader, or built in.
    fn variable(&mut self, name: &str) -> Option<SymbolId> {
        match self.lookup(name) {
            Some(Entry::Variable(id)) => return Some(*id),
            Some(Entry::Structure(_)) => return None,
            None => {}
        }
        if let Some(members) = self.per_vertex.get(&Storage::Out)
            && builtin::in_per_vertex(name)
            && !members.iter().any(|m| m == name)
            && self.stage != Stage::Fragment
        {
            return None;
        }
        if let Some(id) = self.builtins.get(name) {
            return Some(*id);
        }
        let builtin::Builtin { ty, read_only } = builtin::variable(name, self.stage, self.vertices)?;
        let kind = SymbolKind::Builtin;
        let id = self.add_symbol(Symbol {
            name: name.to_owned(),
            span: None,
            ty,
            kind,
            read_only,
            value: None,
            initializer: None,
        });
        self.builtins.insert(name.to_owned(), id);
        Some(id)
    }

    fn add_symbol(&mut self, symbol: Symbol) -> SymbolId {
        self.out.symbols.push(symbol);
        SymbolId(u32::try_from(self.out.symbols.len() - 1).unwrap_or(u32::MAX))
    }

    /// Adds a variable to the innermost scope.
    fn declare(&mut self, name: &Ident, ty: Type, kind: SymbolKind, read_only: bool, value: Option<Const>) -> SymbolId {
        let builtin = name.name.starts_with("gl_");
        let kind = if builtin { SymbolKind::Builtin } else { kind };
        let merge = match self.scopes.last().and_then(|s| s.entries.get(&name.name)) {
            None => None,
            // A second declaration may give an array its size.
            Some(Entry::Variable(old)) if self.resizes(*old, &ty) || builtin => Some(*old),
            Some(entry) => {
                let first = match entry {
                    Entry::Variable(id) => self.out.symbols[id.index()].span,
                    Entry::Structure(s) => Some(s.span),
                };
                self.redefinition(name, first);
                None
            }
        };
        // A use before the redeclaration of a built-in means the same variable.
        let merge = merge.or_else(|| if builtin { self.builtins.get(&name.name).copied() } else { None });
        if let Some(old) = merge {
            self.resized(old, name, &ty);
            self.out.symbols[old.index()].ty = ty;
            self.scope_insert(&name.name, Entry::Variable(old));
            return old;
        }
        let span = Some(name.span);
        let symbol = Symbol { name: name.name.clone(), span, ty, kind, read_only, value, initializer: None };
        let id = self.add_symbol(symbol);
        self.scope_insert(&name.name, Entry::Variable(id));
        if builtin {
            self.builtins.insert(name.name.clone(), id);
        }
        id
    }

    fn scope_insert(&mut self, name: &str, entry: Entry) {
        if let Some(scope) = self.scopes.last_mut() {
            scope.entries.insert(name.to_owned(), entry);
        }
    }

    fn resizes(&self, old: SymbolId, new: &Type) -> bool {
        use super::types::ArraySize::{Known, Unsized};
        match (&self.out.symbols[old.index()].ty, new) {
            (Type::Array(a, Unsized), Type::Array(b, Known(_) | Unsized)) => a == b && !self.language.es(),
            _ => false,
        }
    }

    fn redefinition(&mut self, name: &Ident, first: Option<Span>) {
        let file = self.sink.file.clone();
        let message = format!("`{}` is declared twice in this scope", name.name);
        let diagnostic = self.sink.start(errors::REDEFINITION, name.span, message).with_label("second declaration");
        self.sink.push(match first {
            Some(span) => diagnostic.with_related(&file, span, "first declaration"),
            None => diagnostic,
        });
    }

    /// True when an unknown name is to be told: once each.
    fn first_time(&mut self, name: &str) -> bool {
        self.out.unknown = true;
        !self.incomplete && self.reported_names.insert(name.to_owned())
    }

    /// The name that was probably meant by an unknown one, among all that are known. Where many are unknown, none of them is a slip, and to seek for
    /// each among all others would take their square.
    pub(super) fn meant<'s>(&'s self, name: &str, known: impl FnOnce(&'s Self) -> Vec<&'s str>) -> Option<String> {
        let few = self.reported_names.len() <= MOST_SLIPS;
        few.then(|| nearest(name, known(self)).map(str::to_owned)).flatten()
    }

    /// Every name that could be meant by an unknown one: the innermost scope first.
    fn known_variables(&self) -> Vec<&str> {
        let mut all: Vec<&str> = Vec::new();
        for scope in self.scopes.iter().rev() {
            let variables = scope.entries.iter().filter(|(_, e)| matches!(e, Entry::Variable(_)));
            let mut names: Vec<&str> = variables.map(|(n, _)| n.as_str()).collect();
            // The map has no order of its own, and suggestions must not change from run to run.
            names.sort_unstable();
            all.append(&mut names);
        }
        for name in builtin::variable_names(self.stage) {
            all.push(name);
        }
        all
    }

    /// Remembers a name that nothing declares; what stands for a name is none.
    fn lack(&mut self, name: &str, what: Lacks) {
        let known = crate::hole::stands_for(name)
            || name == crate::PRINTS
            || self.out.lacking.iter().any(|(known, _)| known == name);
        if !known {
            self.out.lacking.push((name.to_owned(), what));
        }
    }

    fn unknown_name(&mut self, name: &str, span: Span) {
        self.lack(name, Lacks::Value);
        if !self.first_time(name) || crate::hole::stands_for(name) || self.may_be_of_an_extension(name) {
            return;
        }
        let near = self.meant(name, |checker| checker.known_variables());
        let message = format!("`{name}` is not declared");
        let diagnostic = self.sink.start(errors::UNKNOWN_NAME, span, message).with_label("unknown name");
        self.sink.push(self.unknown_help(name, near, diagnostic));
    }

    /// True for a built-in name that an extension may bring of which nothing is known here, and that is no slip.
    fn may_be_of_an_extension(&self, name: &str) -> bool {
        const LETTERS: usize = 2;
        let slip = |known: &str| strsim::damerau_levenshtein(name, known) <= LETTERS;
        self.language.is_open() && name.starts_with("gl_") && !builtin::variable_names(self.stage).any(slip)
    }

    fn unknown_help(
        &self,
        name: &str,
        near: Option<String>,
        diagnostic: base::diagnostic::Diagnostic,
    ) -> base::diagnostic::Diagnostic {
        let elsewhere = [Stage::Vertex, Stage::Geometry, Stage::Fragment, Stage::TessControl, Stage::Compute]
            .into_iter()
            .find(|s| builtin::variable(name, *s, None).is_some());
        match elsewhere {
            Some(stage) => diagnostic.with_why(format!(
                "it belongs to the {} stage, and this is a {} shader",
                stage.name(),
                self.stage.name()
            )),
            None => with_near(diagnostic, near),
        }
    }
}
