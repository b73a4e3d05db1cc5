//! Names, types and values of constants of a module (WGSL, sections 5 to 8). Declarations at module scope may stand in
//! any order, so each is looked at when the first use asks. What does not agree is left without a type and not
//! reported: rules speak of what is known.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::super::ast::{Arena, ExprId, Ident, ItemKind, Qualifiers, Unit};
use super::super::fold::Const;
use super::super::interface::Storage;
use super::super::symbols::{
    CallTarget, Direction, FunctionId, FunctionInfo, ParamInfo, Symbol, SymbolId, SymbolKind, Use,
};
use super::super::types::{ArraySize, ScalarType, StructField, StructType, Type};
use super::super::vast::too_large;
use super::syntax::{DeclarationKind, ModuleItem, TypeSyntax, VariableSyntax};
use super::types;
use base::text::Span;

/// What a name means.
#[derive(Clone, Debug)]
pub(super) enum Entry {
    Variable(SymbolId),
    /// A pointer, or a variable to which one points: what is written through one shows in the other.
    Hidden(Type),
    Type(Type),
    Function(FunctionId),
}

/// What the checker finds out.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub types: Vec<Type>,
    pub values: Vec<Option<Const>>,
    pub names: Vec<Option<SymbolId>>,
    pub calls: Vec<Option<CallTarget>>,
    pub symbols: Vec<Symbol>,
    pub functions: Vec<FunctionInfo>,
    pub uses: Vec<Use>,
    pub unknown: bool,
    /// Constant indices that no element has, with the number of elements.
    pub beyond: Vec<(ExprId, i64, u32)>,
    /// Values that have another type than their place takes.
    pub misfits: Vec<super::misfit::Misfit>,
    /// Structures that are too large to be read, with the reason.
    pub too_large: Vec<(Span, String)>,
    /// Symbols of variables at module scope, by the index of the item.
    pub globals: HashMap<usize, SymbolId>,
    /// Functions by the index of the item.
    pub signatures: HashMap<usize, FunctionId>,
}

pub(super) struct Checker<'a> {
    pub(super) items: &'a [ModuleItem],
    pub(super) locals: &'a HashMap<usize, VariableSyntax>,
    pub(super) constructed: &'a HashMap<ExprId, TypeSyntax>,
    pub(super) addresses: &'a HashSet<ExprId>,
    pub(super) arena: &'a mut Arena,
    pub(super) out: Found,
    /// Literals, and what is made of them alone: their type follows from where they stand.
    pub(super) is_abstract: Vec<bool>,
    pub(super) abstract_symbols: HashSet<SymbolId>,
    pub(super) scopes: Vec<HashMap<String, Entry>>,
    /// Index of each item by its name.
    named: HashMap<&'a str, usize>,
    resolved: HashMap<usize, Option<Entry>>,
    /// Expressions and declarations inside of one another.
    pub(super) depth: u32,
    /// The function whose body is being read.
    pub(super) current: Option<(FunctionId, Type)>,
    /// Places of numbers whose suffix says their type.
    pub(super) suffixed: HashSet<usize>,
    /// Names of that function's variables to which pointers point.
    pub(super) aliased: HashSet<String>,
}

/// Attributes whose arguments are numbers; those of others are words.
const NUMBERS: &[&str] = &["align", "binding", "blend_src", "group", "id", "location", "size", "workgroup_size"];

pub(super) fn name_of(item: &ModuleItem) -> &Ident {
    match item {
        ModuleItem::Struct { name, .. } | ModuleItem::Alias { name, .. } | ModuleItem::Function { name, .. } => name,
        ModuleItem::Variable(v) => &v.name,
    }
}

pub(super) fn check(unit: &Unit, parts: Checker<'_>) -> Found {
    let mut checker = parts;
    for index in 0..checker.items.len() {
        checker.resolve(index);
    }
    for item in checker.items {
        item.attributes().filter(|a| NUMBERS.contains(&a.name.name.as_str())).for_each(|a| {
            a.args.iter().for_each(|arg| drop(checker.root(*arg)));
        });
    }
    for (index, item) in checker.items.iter().enumerate() {
        let ModuleItem::Function { item, .. } = item else { continue };
        let Some(&function) = checker.out.signatures.get(&index) else { continue };
        let Some(ItemKind::Function(syntax)) = unit.items.get(*item).map(|i| &i.kind) else { continue };
        if let Some(body) = &syntax.body {
            checker.body(function, body);
        }
    }
    let mut out = checker.out;
    out.uses.sort_by_key(|u| (u.span.start, u.expr));
    out
}

impl<'a> Checker<'a> {
    pub(super) fn new(
        items: &'a [ModuleItem],
        locals: &'a HashMap<usize, VariableSyntax>,
        constructed: &'a HashMap<ExprId, TypeSyntax>,
        addresses: &'a HashSet<ExprId>,
        arena: &'a mut Arena,
    ) -> Self {
        let n = arena.len();
        let out = Found {
            types: vec![Type::Error; n],
            values: vec![None; n],
            names: vec![None; n],
            calls: vec![None; n],
            ..Found::default()
        };
        // Of two with one name, the first counts: alternatives of an engine.
        let mut named = HashMap::new();
        for (index, item) in items.iter().enumerate() {
            named.entry(name_of(item).name.as_str()).or_insert(index);
        }
        Self {
            items,
            locals,
            constructed,
            addresses,
            arena,
            out,
            is_abstract: vec![false; n],
            abstract_symbols: HashSet::new(),
            scopes: Vec::new(),
            named,
            resolved: HashMap::new(),
            depth: 0,
            current: None,
            suffixed: HashSet::new(),
            aliased: HashSet::new(),
        }
    }

    /// What a name means here.
    pub(super) fn lookup(&mut self, name: &str) -> Option<Entry> {
        if let Some(entry) = self.scopes.iter().rev().find_map(|s| s.get(name)) {
            return Some(entry.clone());
        }
        let index = *self.named.get(name)?;
        self.resolve(index)
    }

    fn resolve(&mut self, index: usize) -> Option<Entry> {
        if let Some(entry) = self.resolved.get(&index) {
            return entry.clone();
        }
        // What is defined by itself has no meaning, nor has what a text makes up to exhaust the stack.
        self.resolved.insert(index, None);
        if self.depth >= super::types_of::DEEPEST {
            return None;
        }
        self.depth += 1;
        // Names in a declaration at module scope mean what they mean there.
        let scopes = std::mem::take(&mut self.scopes);
        let current = self.current.take();
        let items = self.items;
        let entry = match &items[index] {
            ModuleItem::Struct { name, members } => {
                let field = |c: &mut Self, m: &super::syntax::MemberSyntax| StructField {
                    name: m.name.name.clone(),
                    ty: c.ty(&m.ty),
                    span: m.name.span,
                    qualifiers: Qualifiers::default(),
                };
                let mut fields: Vec<StructField> = members.iter().map(|m| field(self, m)).collect();
                self.out.too_large.extend(too_large(&mut fields).map(|why| (name.span, why)));
                Entry::Type(Type::Struct(Arc::new(StructType { name: name.name.clone(), fields, span: name.span })))
            }
            ModuleItem::Alias { name: _, ty } => Entry::Type(self.ty(ty)),
            ModuleItem::Variable(variable) => {
                let symbol = self.global(variable);
                self.out.globals.insert(index, symbol);
                Entry::Variable(symbol)
            }
            ModuleItem::Function { attributes: _, name, params, returns, item } => {
                let mut infos = Vec::new();
                for param in params {
                    let ty = self.ty(&param.ty);
                    let direction = direction(&param.ty);
                    let symbol = self.symbol(&param.name, ty.clone(), SymbolKind::Param(direction));
                    self.out.symbols[symbol.index()].read_only = direction == Direction::In;
                    infos.push(ParamInfo {
                        name: Some(param.name.clone()),
                        ty,
                        direction,
                        symbol: Some(symbol),
                        span: param.name.span.to(param.ty.span),
                    });
                }
                let return_type = returns.as_ref().map_or(Type::Void, |(_, ty)| self.ty(ty));
                let id = FunctionId(u32::try_from(self.out.functions.len()).unwrap_or(u32::MAX));
                self.out.functions.push(FunctionInfo {
                    name: name.clone(),
                    params: infos,
                    return_type,
                    definition: Some(*item),
                    prototypes: Vec::new(),
                });
                self.out.signatures.insert(index, id);
                Entry::Function(id)
            }
        };
        (self.scopes, self.current) = (scopes, current);
        self.depth -= 1;
        self.resolved.insert(index, Some(entry.clone()));
        Some(entry)
    }

    pub(super) fn symbol(&mut self, name: &Ident, ty: Type, kind: SymbolKind) -> SymbolId {
        let id = SymbolId(u32::try_from(self.out.symbols.len()).unwrap_or(u32::MAX));
        self.out.symbols.push(Symbol {
            name: name.name.clone(),
            span: Some(name.span),
            ty,
            kind,
            read_only: false,
            value: None,
            initializer: None,
        });
        id
    }

    /// The type of a variable: as it is written, or that of its initialiser.
    pub(super) fn declared(&mut self, variable: &VariableSyntax) -> (Type, bool) {
        let given = variable.value.map(|v| self.root(v));
        match &variable.ty {
            Some(ty) => {
                let ty = self.ty(ty);
                if let (Some(value), Some(scalar)) = (variable.value, ty.scalar()) {
                    self.adopt(value, scalar);
                    self.value_fits(&ty, value);
                }
                (ty, false)
            }
            None => {
                let is_abstract = variable.value.is_some_and(|v| self.is_abstract[v.index()]);
                (given.unwrap_or(Type::Error), is_abstract && variable.kind == DeclarationKind::Const)
            }
        }
    }

    fn global(&mut self, variable: &VariableSyntax) -> SymbolId {
        let (ty, is_abstract) = self.declared(variable);
        let space = variable.space.first().map_or("", |s| s.name.as_str());
        let storage = match (variable.kind, space) {
            (DeclarationKind::Var, "private" | "function") => Storage::Global,
            (DeclarationKind::Var, "workgroup") => Storage::Shared,
            (DeclarationKind::Var, "storage") => Storage::Buffer,
            // Textures and samplers have no address space; what else has none is of an engine.
            (DeclarationKind::Var | DeclarationKind::Override, _) => Storage::Uniform,
            (DeclarationKind::Let | DeclarationKind::Const, _) => Storage::Const,
        };
        let read_write = variable.space.get(1).is_some_and(|a| a.name != "read");
        let symbol = self.symbol(&variable.name, ty, SymbolKind::Global(storage));
        let value = variable.value.and_then(|v| self.out.values[v.index()]);
        let info = &mut self.out.symbols[symbol.index()];
        info.read_only = match storage {
            Storage::Buffer => !read_write,
            Storage::Global | Storage::Shared => false,
            _ => true,
        };
        if storage == Storage::Const {
            info.value = value;
            info.initializer = variable.value;
        }
        if is_abstract {
            self.abstract_symbols.insert(symbol);
        }
        symbol
    }

    /// The type that a text names; pointers are what they point to.
    pub(super) fn ty(&mut self, syntax: &TypeSyntax) -> Type {
        let name = syntax.name.name.as_str();
        let argument = |n: usize| syntax.args.get(n);
        let inner = |c: &mut Self, n: usize| argument(n).and_then(|a| a.ty.as_ref()).map_or(Type::Error, |ty| c.ty(ty));
        // A declaration of the text hides a predeclared name.
        if syntax.args.is_empty()
            && let Some(entry) = self.lookup(name)
        {
            return match entry {
                Entry::Type(ty) => ty,
                _ => Type::Error,
            };
        }
        match name {
            "array" | "binding_array" => {
                let element = inner(self, 0);
                let size = match argument(1).and_then(|a| a.expr) {
                    None => ArraySize::Unsized,
                    Some(size) => {
                        self.root(size);
                        let value = self.out.values[size.index()].and_then(Const::as_integer);
                        value.and_then(|v| u32::try_from(v).ok()).map_or(ArraySize::Unknown, ArraySize::Known)
                    }
                };
                Type::Array(Arc::new(element), size)
            }
            "atomic" => inner(self, 0),
            "ptr" => inner(self, 1),
            _ if name.starts_with("texture_") || name.starts_with("sampler") => {
                let word = argument(0).and_then(|a| a.ty.as_ref()).map_or("", |t| t.name.name.as_str());
                let texel = match types::scalar(word) {
                    Some(scalar) => scalar,
                    None if word.ends_with("uint") => ScalarType::Uint,
                    None if word.ends_with("sint") => ScalarType::Int,
                    None => ScalarType::Float,
                };
                types::opaque(name, texel).map_or(Type::Error, Type::Opaque)
            }
            _ => match inner(self, 0) {
                Type::Scalar(scalar) => types::with_component(name, scalar).unwrap_or(Type::Error),
                _ => types::plain(name).unwrap_or(Type::Error),
            },
        }
    }
}

/// Which way a parameter carries its value: pointers to what can be written carry it both ways.
fn direction(ty: &TypeSyntax) -> Direction {
    let word = |n: usize| ty.args.get(n).and_then(|a| a.ty.as_ref()).map_or("", |t| t.name.name.as_str());
    match (ty.name.name.as_str(), word(0)) {
        ("ptr", "uniform") => Direction::In,
        ("ptr", "storage") if !word(2).contains("write") => Direction::In,
        ("ptr", _) => Direction::InOut,
        _ => Direction::In,
    }
}
