//! Declarations: types, variables, functions, blocks, and with them the stage interface.

use std::sync::Arc;

use super::super::ast::{
    ArrayDim, Declaration, Declarator, ExprId, ExprKind, Function, Ident, InterfaceBlock, Item, ItemKind,
    QualifiedNames, QualifierKind, Qualifiers, StorageQualifier, StructSpecifier, TypeKind, TypeSpecifier,
};
use super::super::fold::{self, Const};
use super::super::interface::{
    Block, BlockMember, InputPrimitive, Located, OutputPrimitive, StageLayout, Storage, Variable,
};
use super::super::names::nearest;
use super::super::symbols::{Direction, FunctionId, FunctionInfo, ParamInfo, SymbolKind};
use super::super::types::{ArraySize, StructField, StructType, Type};
use super::super::language::Feature;
use super::super::{Stage, builtin, errors, parser};
use super::expression::with_near;
use super::layouts::Bearer;
use super::{Checker, Entry};
use crate::diagnostic::told;
use crate::text::Span;

impl Checker<'_> {
    pub(super) fn item(&mut self, index: usize, item: &Item) {
        match &item.kind {
            ItemKind::Empty | ItemKind::Error => {}
            ItemKind::Precision(precision) => self.precision_statement(precision),
            ItemKind::Declaration(declaration) => self.global_declaration(index, declaration),
            ItemKind::Function(function) => self.function(index, function),
            ItemKind::Block(block) => self.block(index, block, item.span),
            ItemKind::Qualified(names) if names.names.is_empty() => self.stage_layout(index, names, item.span),
            ItemKind::Qualified(names) => self.qualified_names(names),
        }
    }

    /// `invariant a;`: the names must exist.
    pub(super) fn qualified_names(&mut self, names: &QualifiedNames) {
        for name in &names.names {
            if self.variable(&name.name).is_none() {
                self.unknown_name(&name.name, name.span);
            }
        }
        self.invariant_rules(names);
    }

    /// The type that a specifier names, without dimensions.
    pub(super) fn named_type(&mut self, kind: &TypeKind, span: Span) -> Type {
        match kind {
            TypeKind::Struct(specifier) => self.structure(specifier),
            TypeKind::Named(name) => {
                if let Some(ty) = Type::from_name(name)
                    && self.lookup(name).is_none()
                {
                    if let Some(since) = builtin::type_since(name)
                        && !self.language.since(since)
                        && self.told.insert(name.clone())
                    {
                        self.lacks(told!("`{name}`", "`{name}` "), since, span);
                    }
                    return ty;
                }
                match self.lookup(name) {
                    Some(Entry::Structure(s)) => Type::Struct(Arc::clone(s)),
                    Some(Entry::Variable(_)) => {
                        let message = format!("`{name}` is a variable, not a type");
                        self.sink.error(errors::UNKNOWN_TYPE, span, message, "a type is needed here");
                        Type::Error
                    }
                    // The functions behind a subroutine type are chosen by the host; what they
                    // take and return is not followed.
                    None if self.subroutines.contains(name) => Type::Error,
                    None if builtin::structure_type(name).is_some()
                        && (name == "gl_DepthRangeParameters" || !(self.language.core() || self.language.es())) =>
                    {
                        builtin::structure_type(name).unwrap_or(Type::Error)
                    }
                    None => {
                        if !self.language.is_open() && self.first_time(name) {
                            let mut known: Vec<&str> = parser::suggestions().collect();
                            let own = self.scopes.iter().flat_map(|s| s.entries.iter());
                            known
                                .extend(own.filter(|(_, e)| matches!(e, Entry::Structure(_))).map(|(n, _)| n.as_str()));
                            known.sort_unstable();
                            let near = nearest(name, known).map(str::to_owned);
                            let d =
                                self.sink.start(errors::UNKNOWN_TYPE, span, format!("type `{name}` is not declared"));
                            self.sink.push(with_near(d.with_label("unknown type"), near));
                        }
                        Type::Error
                    }
                }
            }
        }
    }

    /// Puts dimensions around a type, the outermost first.
    fn dimensions(&mut self, base: Type, dims: &[ArrayDim]) -> Type {
        let sizes: Vec<ArraySize> =
            dims.iter().map(|d| d.size.map_or(ArraySize::Unsized, |size| self.array_size(size))).collect();
        sizes.into_iter().rev().fold(base, |ty, size| Type::Array(Arc::new(ty), size))
    }

    fn specified_type(&mut self, ty: &TypeSpecifier) -> Type {
        let base = self.named_type(&ty.kind, ty.name_span);
        self.dimensions(base, &ty.dims)
    }

    /// `float[2] a[3]` is an array of 3 arrays of 2.
    fn declared_type(&mut self, base: &Type, declarator_dims: &[ArrayDim]) -> Type {
        self.dimensions(base.clone(), declarator_dims)
    }

    fn structure(&mut self, specifier: &StructSpecifier) -> Type {
        let mut fields: Vec<StructField> = Vec::new();
        if specifier.members.is_empty() && !self.sink.has(errors::SYNTAX) {
            let message = told!("a structure needs a member", "構造体にはメンバーが必要です");
            self.sink.error(errors::VARIABLE_TYPE, specifier.span, message, told!("empty", "空です"));
        }
        if let Some(name) = &specifier.name {
            self.reserved_name(name, false);
            let known = self.functions.get(&name.name).and_then(|f| f.first()).filter(|_| self.at_file_scope());
            if let Some(first) = known.map(|f| self.out.functions[f.index()].name.span) {
                self.redefinition(name, Some(first));
            } else if self.at_file_scope() && self.blocks.iter().any(|(_, block)| *block == name.name) {
                self.redefinition(name, None);
            }
        }
        for member in &specifier.members {
            self.member_rules(member, Bearer::Nothing);
            for (name, ty, declarator) in self.member_types(member) {
                self.reserved_name(&name, false);
                self.array_rules(&ty, declarator.span, false, false);
                if ty == Type::Void {
                    let message = told!("a member cannot be `void`", "メンバーは `void` にできません");
                    self.sink.error(errors::VARIABLE_TYPE, name.span, message, told!("this member", "このメンバー"));
                }
                if let Some(first) = fields.iter().find(|f| f.name == name.name).map(|f| f.span) {
                    self.redefinition(&name, Some(first));
                }
                fields.push(StructField {
                    name: name.name,
                    ty,
                    span: name.span,
                    qualifiers: member.qualifiers.clone(),
                });
            }
        }
        let name = specifier.name.as_ref().map_or_else(|| "<struct>".to_owned(), |n| n.name.clone());
        let span = specifier.name.as_ref().map_or(specifier.span, |n| n.span);
        let ty = Arc::new(StructType { name, fields, span });
        if let Some(name) = &specifier.name {
            let old = self.scopes.last().and_then(|s| s.entries.get(&name.name)).map(|e| match e {
                Entry::Structure(s) => Some(s.span),
                Entry::Variable(id) => self.out.symbols[id.index()].span,
            });
            if let Some(first) = old {
                self.redefinition(name, first);
            }
            self.scope_insert(&name.name, Entry::Structure(Arc::clone(&ty)));
        }
        Type::Struct(ty)
    }

    fn member_types<'d>(&mut self, member: &'d Declaration) -> Vec<(Ident, Type, &'d Declarator)> {
        self.layout_values(&member.qualifiers);
        let base = self.specified_type(&member.ty);
        let mut all = Vec::new();
        for declarator in &member.declarators {
            let ty = self.declared_type(&base, &declarator.dims);
            all.push((declarator.name.clone(), ty, declarator));
        }
        all
    }

    /// Rules of a member of a structure or block.
    fn member_rules(&mut self, member: &Declaration, bearer: Bearer) {
        self.qualifier_rules(&member.qualifiers);
        let anonymous = matches!(&member.ty.kind, TypeKind::Struct(s) if s.name.is_none());
        if bearer != Bearer::Nothing && matches!(member.ty.kind, TypeKind::Struct(_)) || anonymous && self.language.number() == 120 {
            let message = told!("a structure cannot be defined here", "ここで構造体は定義できません");
            self.sink.error(errors::VARIABLE_TYPE, member.ty.span, message, told!("define it before", "先に定義してください"));
        }
        if member.declarators.is_empty() {
            let message = told!("a member without a name", "名前のないメンバーです");
            self.sink.error(errors::VARIABLE_TYPE, member.span, message, told!("this member", "このメンバー"));
        }
        if self.language.es() && matches!(member.ty.kind, TypeKind::Struct(_)) {
            let version = self.language.name();
            let message = told!("{version} has no structure defined inside another", "{version} では構造体の中で構造体を定義できません");
            self.sink.error(errors::VARIABLE_TYPE, member.ty.span, message, told!("define it before", "先に定義してください"));
        }
        for declarator in &member.declarators {
            if let Some(initializer) = &declarator.initializer {
                let message = told!("a member cannot have an initialiser", "メンバーに初期化子は書けません");
                let label = told!("not allowed here", "ここには書けません");
                self.sink.error(errors::INITIALISER, self.arena.get(initializer.value).span, message, label);
            }
        }
        if bearer == Bearer::Nothing {
            for q in &member.qualifiers.list {
                if !matches!(q.kind, QualifierKind::Precision(_)) {
                    self.qualifier(q.span, told!("it does not belong to a member", "構造体のメンバーには付けられません"));
                }
            }
        }
    }

    /// Types the values of `layout(location = …)`.
    fn layout_values(&mut self, qualifiers: &Qualifiers) {
        for (entries, _) in qualifiers.layouts() {
            for value in entries.iter().filter_map(|e| e.value) {
                self.expression(value);
            }
        }
    }

    /// Checks an initialiser against the declared type; gives the type that the variable gets,
    /// because `float a[] = …` takes the size from the value.
    fn initializer(&mut self, name: &Ident, ty: Type, value: ExprId) -> (Type, Option<Const>) {
        if let ExprKind::List(items) = &self.arena.get(value).kind {
            let ty = self.list(name, &ty, value, items);
            return (ty, None);
        }
        let given = self.expression(value);
        if !self.conversions.allow(&given, &ty) {
            let name = &name.name;
            let message = told!("`{given}` cannot initialise `{ty} {name}`", "`{given}` で `{ty} {name}` は初期化できません");
            self.misfit(&given, &ty, self.arena.get(value).span, message);
            return (ty, None);
        }
        self.implicit(value, &given, &ty);
        let folded = self.value_of(value).and_then(|v| fold::convert(v, &ty));
        let ty = match (&ty, &given) {
            (Type::Array(_, ArraySize::Unsized), Type::Array(..)) => given,
            _ => ty,
        };
        (ty, folded)
    }

    /// An initialiser list, against the type that it builds.
    fn list(&mut self, name: &Ident, ty: &Type, id: ExprId, items: &[ExprId]) -> Type {
        self.need(Feature::InitializerLists, self.arena.get(id).span);
        let count = u32::try_from(items.len()).unwrap_or(u32::MAX);
        let (ty, wanted): (Type, Vec<Type>) = match ty {
            Type::Array(element, ArraySize::Unsized) => {
                let element = element.as_ref().clone();
                (element.clone().array(count), vec![element; items.len()])
            }
            Type::Struct(s) => (ty.clone(), s.fields.iter().map(|f| f.ty.clone()).collect()),
            Type::Error => (Type::Error, vec![Type::Error; items.len()]),
            other => match (other.indexed(), other.index_count()) {
                (Some(element), Some(n)) => (other.clone(), vec![element; usize::try_from(n).unwrap_or(0)]),
                (Some(element), None) => (other.clone(), vec![element; items.len()]),
                (None, _) => {
                    let message = format!("a list cannot initialise `{other} {}`", name.name);
                    self.sink.error(errors::ASSIGN_TYPE, self.arena.get(id).span, message, "this list");
                    (other.clone(), vec![Type::Error; items.len()])
                }
            },
        };
        if wanted.len() != items.len() {
            let message = format!("`{ty}` needs {} values, but the list has {}", wanted.len(), items.len());
            self.sink.error(errors::CONSTRUCTOR, self.arena.get(id).span, message, "this list");
        }
        for (i, item) in items.iter().enumerate() {
            let element = wanted.get(i).cloned().unwrap_or(Type::Error);
            self.initializer(name, element, *item);
        }
        self.out.types[id.index()] = ty.clone();
        self.constant[id.index()] = items.iter().all(|i| self.is_constant(*i));
        ty
    }

    pub(super) fn local_declaration(&mut self, declaration: &Declaration) {
        let constant = declaration.qualifiers.is_const();
        self.layout_values(&declaration.qualifiers);
        self.local_qualifiers(declaration);
        let base = self.specified_type(&declaration.ty);
        self.precision_needed(&declaration.qualifiers, &base, declaration.ty.span);
        for declarator in &declaration.declarators {
            let (ty, value) = self.declarator(&base, declarator);
            self.reserved_name(&declarator.name, false);
            self.precision_type(&declaration.qualifiers, &ty);
            self.array_rules(&ty, declarator.span, declarator.initializer.is_some(), !self.language.es());
            self.storage_type(&ty, Storage::Global, &declaration.qualifiers, declarator.name.span);
            self.initialiser_rules(declarator, Storage::Global, &ty, constant);
            self.declare(&declarator.name, ty, SymbolKind::Local, constant, value.filter(|_| constant));
        }
    }

    fn declarator(&mut self, base: &Type, declarator: &Declarator) -> (Type, Option<Const>) {
        let ty = self.declared_type(base, &declarator.dims);
        if ty == Type::Void {
            let message = format!("`{}` cannot be `void`", declarator.name.name);
            self.sink.error(errors::UNKNOWN_TYPE, declarator.name.span, message, "a variable needs a type with values");
            return (Type::Error, None);
        }
        match &declarator.initializer {
            Some(initializer) => self.initializer(&declarator.name, ty, initializer.value),
            None => (ty, None),
        }
    }

    /// An unsized input of a geometry stage has an element for each vertex of the primitive.
    fn stage_type(&self, ty: Type, storage: Storage) -> Type {
        match (ty, storage, self.vertices) {
            (Type::Array(element, ArraySize::Unsized), Storage::In, Some(n)) if self.stage == Stage::Geometry => {
                Type::Array(element, ArraySize::Known(n))
            }
            (ty, ..) => ty,
        }
    }

    fn global_declaration(&mut self, item: usize, declaration: &Declaration) {
        let qualifiers = &declaration.qualifiers;
        let storage = qualifiers.storage().map_or(Storage::Global, |(s, _)| Storage::of(s, self.stage));
        let read_only = matches!(storage, Storage::In | Storage::Uniform | Storage::Const) || qualifiers.is_const();
        self.layout_values(qualifiers);
        self.qualifier_rules(qualifiers);
        self.storage_rules(qualifiers, storage);
        let base = self.specified_type(&declaration.ty);
        self.precision_needed(qualifiers, &base, declaration.ty.span);
        for (position, declarator) in declaration.declarators.iter().enumerate() {
            let (ty, value) = self.declarator(&base, declarator);
            self.global_rules(declarator, &ty, storage, qualifiers);
            let ty = self.stage_type(ty, storage);
            let value = value.filter(|_| storage == Storage::Const);
            let symbol = self.declare(&declarator.name, ty.clone(), SymbolKind::Global(storage), read_only, value);
            // A redeclared built-in is no part of the user's interface.
            if declarator.name.name.starts_with("gl_") {
                continue;
            }
            let variable = Variable {
                name: declarator.name.name.clone(),
                name_span: declarator.name.span,
                ty,
                storage,
                qualifiers: qualifiers.clone(),
                type_span: declaration.ty.span,
                dims: declarator.dims.clone(),
                initializer: declarator.initializer.as_ref().map(|i| i.value),
                value,
                declaration_span: declaration.span,
                declarator_span: declarator.span,
                item,
                position,
                siblings: declaration.declarators.len(),
                symbol,
            };
            let interface = &mut self.out.interface;
            match storage {
                Storage::In => interface.inputs.push(variable),
                Storage::Out => interface.outputs.push(variable),
                Storage::Uniform | Storage::Buffer => interface.uniforms.push(variable),
                Storage::Const => interface.constants.push(variable),
                Storage::Shared | Storage::Global => interface.globals.push(variable),
            }
        }
    }

    /// Rules of one global variable, as it is declared.
    fn global_rules(&mut self, declarator: &Declarator, ty: &Type, storage: Storage, qualifiers: &Qualifiers) {
        let name = &declarator.name;
        let again = name.name.starts_with("gl_")
            && self.redeclared_builtin(name, ty, qualifiers.storage().map(|_| storage));
        self.reserved_name(name, again);
        let bearer = if again { Bearer::Builtin } else { Bearer::Variable(storage) };
        self.layout_rules(qualifiers, bearer, Some(ty));
        if again {
            return;
        }
        let per_vertex = matches!(
            (self.stage, storage),
            (Stage::Geometry | Stage::TessControl | Stage::TessEvaluation, Storage::In) | (Stage::TessControl, Storage::Out)
        );
        let patch = qualifiers
            .list
            .iter()
            .any(|q| matches!(q.kind, QualifierKind::Auxiliary(super::super::ast::AuxiliaryQualifier::Patch)));
        let own = match ty {
            Type::Array(element, _) if per_vertex && !patch => element.as_ref(),
            other => other,
        };
        if storage == Storage::In {
            self.geometry_input(name, ty, declarator.span);
        }
        if per_vertex && !patch {
            self.array_rules(own, declarator.span, declarator.initializer.is_some(), false);
        } else {
            self.array_rules(ty, declarator.span, declarator.initializer.is_some(), !self.language.es());
        }
        self.storage_type(own, storage, qualifiers, name.span);
        if self.blocks.iter().any(|(_, block)| *block == name.name) {
            self.redefinition(name, None);
        }
        self.precision_type(qualifiers, ty);
        if self.functions.contains_key(&name.name) && self.language.number() != 110 {
            let first = self.functions[&name.name].first().map(|f| self.out.functions[f.index()].name.span);
            self.redefinition(name, first);
        }
        self.initialiser_rules(declarator, storage, ty, qualifiers.is_const());
    }

    /// Rules of a block before its members are declared; true when it redeclares built-in variables.
    fn block_rules(&mut self, block: &InterfaceBlock, storage: Storage) -> bool {
        let name = &block.name;
        let per_vertex = name.name == "gl_PerVertex" && matches!(storage, Storage::In | Storage::Out);
        self.qualifier_rules(&block.qualifiers);
        self.layout_rules(&block.qualifiers, Bearer::Block(storage), None);
        let feature = match storage {
            Storage::In | Storage::Out => Feature::InOutBlocks,
            Storage::Buffer => Feature::StorageBlocks,
            _ => Feature::Blocks,
        };
        self.need(feature, name.span);
        let word = block.qualifiers.storage();
        let stage = self.stage;
        let wrong = match word {
            Some((StorageQualifier::Attribute | StorageQualifier::Varying | StorageQualifier::Const | StorageQualifier::InOut | StorageQualifier::Shared, _)) => true,
            Some((StorageQualifier::In, _)) => stage == Stage::Vertex,
            Some((StorageQualifier::Out, _)) => stage == Stage::Fragment,
            Some((StorageQualifier::Uniform | StorageQualifier::Buffer, _)) => false,
            None => true,
        };
        if wrong {
            let text = word.map_or("", |w| w.0.text());
            let message = told!("this stage has no `{text}` block", "このステージに `{text}` ブロックはありません");
            self.sink.error(errors::REDECLARATION, name.span, message, told!("this block", "このブロック"));
        }
        if per_vertex {
            self.per_vertex_rules(block, storage);
            return true;
        }
        self.reserved_name(name, false);
        if !self.blocks.insert((storage, name.name.clone())) {
            self.redefinition(name, None);
        } else if let Some(entry) = self.scopes.first().and_then(|s| s.entries.get(&name.name)) {
            let first = match entry {
                Entry::Variable(id) => self.out.symbols[id.index()].span,
                Entry::Structure(s) => Some(s.span),
            };
            self.redefinition(name, first);
        }
        if let Some(instance) = &block.instance {
            self.need(Feature::BlockInstances, instance.span);
            self.reserved_name(instance, false);
        }
        false
    }

    /// A block of built-in variables that is declared again.
    fn per_vertex_rules(&mut self, block: &InterfaceBlock, storage: Storage) {
        let names: Vec<String> = block.members.iter().flat_map(|m| m.declarators.iter().map(|d| d.name.name.clone())).collect();
        let instance = block.instance.as_ref().map(|i| i.name.as_str());
        let wanted = match (self.stage, storage) {
            (Stage::Geometry | Stage::TessControl | Stage::TessEvaluation, Storage::In) => Some("gl_in"),
            (Stage::TessControl, Storage::Out) => Some("gl_out"),
            _ => None,
        };
        let why = if self.stage == Stage::Fragment || self.per_vertex.insert(storage, names).is_some() {
            Some(told!("this block is declared once, outside fragment shaders", "このブロックの宣言は一度だけで、フラグメントシェーダにはありません"))
        } else if instance != wanted || wanted.is_some() == block.dims.is_empty() {
            Some(match wanted {
                Some(wanted) => told!("it ends with `{wanted}[]`", "`{wanted}[]` で終わる必要があります"),
                None => told!("it has no instance name", "インスタンス名はありません"),
            })
        } else {
            let used = |u: &super::super::symbols::Use| {
                let name = self.out.symbols[u.symbol.index()].name.as_str();
                if storage == Storage::In { name == "gl_in" } else { builtin::in_per_vertex(name) }
            };
            let declared = storage == Storage::Out
                && self.scopes.first().is_some_and(|s| s.entries.keys().any(|n| builtin::in_per_vertex(n)));
            (self.out.uses.iter().any(used) || declared)
                .then(|| told!("its members are used above", "メンバーが上で使われています"))
        };
        if let Some(why) = why.filter(|_| !self.language.is_open()) {
            let message = told!("`gl_PerVertex` cannot be declared like this", "`gl_PerVertex` はこのように宣言できません");
            let d = self.sink.start(errors::REDECLARATION, block.name.span, message).with_label(told!("this block", "このブロック"));
            self.sink.push(d.with_why(why));
        }
    }

    /// Rules of a member of a block.
    fn block_member_rules(&mut self, member: &Declaration, storage: Storage, name: &Ident, ty: &Type, block: &InterfaceBlock) {
        let opaque = ty.contains_opaque() && !self.language.is_open();
        if opaque {
            let message = told!("a block cannot hold `{ty}`", "ブロックに `{ty}` は入れられません");
            self.sink.error(errors::VARIABLE_TYPE, name.span, message, told!("this member", "このメンバー"));
        }
        self.layout_rules(&member.qualifiers, Bearer::Member(storage), Some(ty));
        if let Some((word, span)) = member.qualifiers.storage()
            && Storage::of(word, self.stage) != storage
        {
            self.qualifier(span, told!("the block has another storage", "ブロックの記憶域と違います"));
        }
        for q in &member.qualifiers.list {
            if matches!(q.kind, QualifierKind::Interpolation(_) | QualifierKind::Auxiliary(_) | QualifierKind::Invariant)
                && !matches!(storage, Storage::In | Storage::Out)
            {
                self.qualifier(q.span, told!("it belongs to inputs and outputs", "入出力に付ける修飾子です"));
            }
        }
        if matches!(storage, Storage::In | Storage::Out) && !opaque {
            let mut all = member.qualifiers.clone();
            all.list.extend(block.qualifiers.list.iter().cloned());
            self.storage_type(ty, storage, &all, name.span);
        }
    }

    fn block(&mut self, item: usize, block: &InterfaceBlock, span: Span) {
        let storage = block.qualifiers.storage().map_or(Storage::Uniform, |(s, _)| Storage::of(s, self.stage));
        self.layout_values(&block.qualifiers);
        let read_only = |member: &Qualifiers| {
            let locked = QualifierKind::Memory(super::super::ast::MemoryQualifier::ReadOnly);
            matches!(storage, Storage::In | Storage::Uniform) || member.list.iter().any(|q| q.kind == locked)
        };
        let index = self.out.interface.blocks.len();
        let mut members = Vec::new();
        let mut fields: Vec<StructField> = Vec::new();
        let builtin_block = self.block_rules(block, storage);
        if block.members.is_empty() && !self.sink.has(errors::SYNTAX) {
            let message = told!("a block needs a member", "ブロックにはメンバーが必要です");
            self.sink.error(errors::VARIABLE_TYPE, block.body_span, message, told!("empty", "空です"));
        }
        let last = block.members.len().saturating_sub(1);
        for (at, member) in block.members.iter().enumerate() {
            self.member_rules(member, Bearer::Member(storage));
            self.precision_needed(&member.qualifiers, &Type::Error, member.span);
            for (name, ty, declarator) in self.member_types(member) {
                if !builtin_block {
                    self.reserved_name(&name, false);
                    self.block_member_rules(member, storage, &name, &ty, block);
                } else if builtin::variable(&name.name, self.stage, self.vertices).is_none()
                    && !matches!(name.name.as_str(), "gl_Position" | "gl_PointSize" | "gl_ClipDistance" | "gl_CullDistance")
                {
                    let text = &name.name;
                    let message = told!("`gl_PerVertex` has no member `{text}`", "`gl_PerVertex` に `{text}` はありません");
                    self.sink.error(errors::REDECLARATION, name.span, message, told!("unknown member", "未知のメンバー"));
                }
                if let Some(first) = fields.iter().find(|f: &&StructField| f.name == name.name && block.instance.is_some()).map(|f| f.span) {
                    self.redefinition(&name, Some(first));
                }
                let runtime = storage == Storage::Buffer && at == last;
                self.array_rules(&ty, declarator.span, false, runtime || !self.language.es());
                let symbol = if block.instance.is_none() {
                    let kind = SymbolKind::BlockMember(index);
                    let locked = read_only(&member.qualifiers) || read_only(&block.qualifiers);
                    let id = self.declare(&name, ty.clone(), kind, locked, None);
                    if storage == Storage::Buffer {
                        self.runtime.insert(id);
                    }
                    Some(id)
                } else {
                    None
                };
                let qualifiers = member.qualifiers.clone();
                let (name_text, span) = (name.name.clone(), name.span);
                fields.push(StructField { name: name_text, ty: ty.clone(), span, qualifiers: qualifiers.clone() });
                members.push(BlockMember {
                    name,
                    ty,
                    qualifiers,
                    type_span: member.ty.span,
                    dims: declarator.dims.clone(),
                    declaration_span: member.span,
                    symbol,
                });
            }
        }
        let base = Type::Struct(Arc::new(StructType { name: block.name.name.clone(), fields, span: block.name.span }));
        let ty = self.dimensions(base, &block.dims);
        if block.dims.len() > 1 {
            self.need(Feature::ArraysOfArrays, block.dims[1].span);
        }
        if storage == Storage::In && !builtin_block {
            let name = block.instance.as_ref().unwrap_or(&block.name);
            self.geometry_input(name, &ty, name.span);
        }
        let ty = self.stage_type(ty, storage);
        let symbol = block.instance.as_ref().map(|name| {
            let kind = SymbolKind::BlockInstance(index);
            let id = self.declare(name, ty.clone(), kind, read_only(&block.qualifiers), None);
            match storage {
                Storage::Buffer => {
                    self.runtime.insert(id);
                }
                Storage::Uniform => {
                    self.uniform_blocks.insert(id);
                }
                _ => {}
            }
            id
        });
        self.out.interface.blocks.push(Block {
            name: block.name.clone(),
            storage,
            qualifiers: block.qualifiers.clone(),
            members,
            instance: block.instance.clone(),
            dims: block.dims.clone(),
            ty,
            symbol,
            span,
            body_span: block.body_span,
            item,
        });
    }

    fn stage_layout(&mut self, item: usize, names: &QualifiedNames, span: Span) {
        self.layout_values(&names.qualifiers);
        let storage = names.qualifiers.storage().map(|(s, _)| Storage::of(s, self.stage));
        match storage {
            Some(storage) => self.layout_rules(&names.qualifiers, Bearer::Stage(storage), None),
            None => {
                if let Some(span) = names.qualifiers.span()
                    && names.qualifiers.layouts().next().is_some()
                {
                    self.qualifier(span, told!("it needs `in`, `out`, `uniform` or `buffer`", "`in`・`out`・`uniform`・`buffer` のいずれかが必要です"));
                }
            }
        }
        let layout = StageLayout { storage, qualifiers: names.qualifiers.clone(), span, item };
        if self.stage == Stage::Geometry {
            self.geometry_layout(storage, &names.qualifiers);
        }
        self.out.interface.stage_layouts.push(layout);
    }

    fn geometry_layout(&mut self, storage: Option<Storage>, qualifiers: &Qualifiers) {
        for (entries, _) in qualifiers.layouts() {
            for entry in entries {
                let key = entry.key.name.to_ascii_lowercase();
                let key = key.as_str();
                let span = entry.span;
                let number = entry.value.and_then(|v| self.value_of(v)).and_then(Const::as_integer);
                let number = number.and_then(|n| u32::try_from(n).ok()).map(|value| Located { value, span });
                if let (None, Some(value), "max_vertices" | "invocations") = (number, entry.value, key)
                    && !self.type_of(value).is_error()
                {
                    let message = format!("`{key}` must be a constant integer");
                    self.sink.error(errors::CONSTANT, self.arena.get(value).span, message, "this value");
                }
                let geometry = &mut self.out.interface.geometry;
                match storage {
                    Some(Storage::In) => {
                        if let Some(value) = InputPrimitive::from_name(&key.to_ascii_lowercase()) {
                            if geometry.input.is_some_and(|old| old.value != value) {
                                let message = told!("a second input primitive, `{key}`", "二つ目の入力プリミティブ `{key}` です");
                                self.sink.error(errors::LAYOUT, span, message, told!("second one", "二つ目"));
                                continue;
                            }
                            geometry.input = Some(Located { value, span });
                        } else if key == "invocations" {
                            geometry.invocations = number;
                        }
                    }
                    Some(Storage::Out) => {
                        self.output_primitive(key, span);
                        let geometry = &mut self.out.interface.geometry;
                        if let Some(value) = OutputPrimitive::from_name(key) {
                            if geometry.output.is_some_and(|old| old.value != value) {
                                let message = told!("a second output primitive, `{key}`", "二つ目の出力プリミティブ `{key}` です");
                                self.sink.error(errors::LAYOUT, span, message, told!("second one", "二つ目"));
                                continue;
                            }
                            geometry.output = Some(Located { value, span });
                        } else if key == "max_vertices" {
                            let differs = |old: Located<u32>| number.is_some_and(|n| n.value != old.value);
                            if geometry.max_vertices.is_some_and(differs) {
                                let message = told!("another `max_vertices` than above", "上と異なる `max_vertices` です");
                                self.sink.error(errors::LAYOUT, span, message, told!("second one", "二つ目"));
                                continue;
                            }
                            geometry.max_vertices = number;
                        }
                    }
                    Some(Storage::Uniform | Storage::Buffer | Storage::Shared | Storage::Const | Storage::Global)
                    | None => {}
                }
            }
        }
    }

    fn function(&mut self, item: usize, function: &Function) {
        let is_type =
            |q: &super::super::ast::Qualifier| matches!(&q.kind, QualifierKind::Subroutine(of) if of.is_empty());
        if function.body.is_none() && function.qualifiers.list.iter().any(is_type) {
            self.subroutines.insert(function.name.name.clone());
        }
        let return_type = self.specified_type(&function.return_type);
        let mut params = Vec::new();
        for param in &function.params {
            let base = self.specified_type(&param.ty);
            let ty = self.declared_type(&base, &param.dims);
            let direction = match param.qualifiers.storage() {
                Some((StorageQualifier::Out, _)) => Direction::Out,
                Some((StorageQualifier::InOut, _)) => Direction::InOut,
                _ => Direction::In,
            };
            params.push(ParamInfo { name: param.name.clone(), ty, direction, symbol: None, span: param.span });
        }
        self.function_rules(function, &return_type, &params);
        let id = self.declare_function(item, function, &return_type, params.clone());
        let Some(body) = &function.body else { return };
        self.scoped(|this| {
            for (i, param) in params.iter().enumerate() {
                let Some(name) = &param.name else { continue };
                let read_only = function.params[i].qualifiers.is_const();
                let kind = SymbolKind::Param(param.direction);
                let symbol = this.declare(name, param.ty.clone(), kind, read_only, None);
                if let Some(known) = this.out.functions[id.index()].params.get_mut(i) {
                    known.symbol = Some(symbol);
                }
            }
            let returns = !matches!(return_type, Type::Void | Type::Error);
            this.current = Some((id, return_type));
            this.returned = false;
            this.statements(body);
            if returns && !this.returned && !this.sink.has(errors::SYNTAX) {
                let name = &function.name.name;
                let message = told!("`{name}` never returns a value", "`{name}` は値を一度も返しません");
                let label = told!("has no `return`", "`return` がありません");
                this.sink.error(errors::RETURN_TYPE, function.name.span, message, label);
            }
            this.current = None;
        });
    }

    fn declare_function(
        &mut self,
        item: usize,
        function: &Function,
        return_type: &Type,
        params: Vec<ParamInfo>,
    ) -> FunctionId {
        let known = self.functions.get(&function.name.name).cloned().unwrap_or_default();
        let same = known.into_iter().find(|id| {
            let old = &self.out.functions[id.index()].params;
            old.len() == params.len() && old.iter().zip(&params).all(|(a, b)| a.ty == b.ty)
        });
        let name = function.name.clone();
        let Some(id) = same else {
            let (definition, prototypes) =
                if function.body.is_some() { (Some(item), Vec::new()) } else { (None, vec![item]) };
            let info = FunctionInfo { name, params, return_type: return_type.clone(), definition, prototypes };
            self.out.functions.push(info);
            let id = FunctionId(u32::try_from(self.out.functions.len() - 1).unwrap_or(u32::MAX));
            self.functions.entry(function.name.name.clone()).or_default().push(id);
            return id;
        };
        let old = &self.out.functions[id.index()];
        let directions = old.params.iter().zip(&params).all(|(a, b)| a.direction == b.direction);
        let twice = (function.body.is_some() && old.definition.is_some()) || !directions;
        let differs = old.return_type != *return_type && !old.return_type.is_error() && !return_type.is_error();
        if twice || differs {
            let (first, old_return) = (old.name.span, old.return_type.to_string());
            let message = if differs {
                format!("`{}` returns `{return_type}` here and `{old_return}` before", name.name)
            } else if !directions {
                format!("`{}` has other `in` and `out` parameters here than before", name.name)
            } else {
                format!("`{}` has two bodies for the same parameters", name.name)
            };
            let file = self.sink.file.clone();
            let d = self.sink.start(errors::REDEFINITION, name.span, message).with_label("second declaration");
            self.sink.push(d.with_related(&file, first, "first declaration"));
        }
        let info = &mut self.out.functions[id.index()];
        if function.body.is_some() {
            info.definition = Some(item);
            info.name = name;
            info.params = params;
        } else {
            info.prototypes.push(item);
        }
        id
    }
}
