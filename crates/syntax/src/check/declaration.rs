//! Declarations: types, variables, functions, blocks, and with them the stage interface.

use std::sync::Arc;

use super::super::ast::{
    ArrayDim, Declaration, Declarator, ExprId, ExprKind, Function, Ident, Item, ItemKind, QualifiedNames,
    QualifierKind, Qualifiers, StorageQualifier, StructSpecifier, TypeKind, TypeSpecifier,
};
use super::super::fold::{self, Const};
use super::super::interface::{Storage, Variable};
use super::super::language::Feature;
use super::super::symbols::{Direction, FunctionId, FunctionInfo, ParamInfo, SymbolKind};
use super::super::types::{ArraySize, OpaqueType, StructField, StructType, Type};
use super::super::vast::too_large;
use super::super::{Lacks, Stage, builtin, errors, parser};
use super::expression::with_near;
use super::layouts::Bearer;
use super::{Checker, Entry};
use base::diagnostic::message;
use base::text::Span;

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
                        && self.reported_names.insert(name.clone())
                    {
                        self.lacks(message!("`{name}`", "`{name}` "), since, span);
                        if builtin::is_sized_name(name) {
                            self.lack(name, Lacks::Type);
                        }
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
                    // Vulkan has textures without a sampler, and what earlier subpasses wrote.
                    None if self.language.is_open() && OpaqueType::of_vulkan(name).is_some() => {
                        OpaqueType::of_vulkan(name).map_or(Type::Error, Type::Opaque)
                    }
                    None if builtin::structure_type(name).is_some()
                        && (name == "gl_DepthRangeParameters" || !(self.language.core() || self.language.es())) =>
                    {
                        builtin::structure_type(name).unwrap_or(Type::Error)
                    }
                    // A sampler of Vulkan, which stands for a texture beside it.
                    None if self.language.is_open() && matches!(name.as_str(), "sampler" | "samplerShadow") => {
                        Type::Error
                    }
                    None => {
                        self.lack(name, Lacks::Type);
                        if !self.language.is_open() && self.first_time(name) {
                            let near = self.meant(name, |checker| {
                                let own = checker.scopes.iter().flat_map(|s| s.entries.iter());
                                let own = own.filter(|(_, e)| matches!(e, Entry::Structure(_)));
                                let mut known: Vec<&str> = own.map(|(n, _)| n.as_str()).collect();
                                for name in parser::suggestions() {
                                    known.push(name);
                                }
                                known.sort_unstable();
                                known
                            });
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
    pub(super) fn dimensions(&mut self, base: Type, dims: &[ArrayDim]) -> Type {
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
            let message = message!("a structure needs a member", "構造体にはメンバーが必要です");
            self.sink.error(errors::VARIABLE_TYPE, specifier.span, message, message!("empty", "空です"));
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
                if ty.is_void() {
                    let message = message!("a member cannot be `void`", "メンバーは `void` にできません");
                    self.sink.error(errors::VARIABLE_TYPE, name.span, message, message!("this member", "このメンバー"));
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
        if let Some(why) = too_large(&mut fields) {
            self.sink.error(errors::TOO_DEEP, span, why, "use an array, or fewer levels");
        }
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

    pub(super) fn member_types<'d>(&mut self, member: &'d Declaration) -> Vec<(Ident, Type, &'d Declarator)> {
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
    pub(super) fn member_rules(&mut self, member: &Declaration, bearer: Bearer) {
        self.qualifier_rules(&member.qualifiers);
        let anonymous = matches!(&member.ty.kind, TypeKind::Struct(s) if s.name.is_none());
        if bearer != Bearer::Nothing && matches!(member.ty.kind, TypeKind::Struct(_))
            || anonymous && self.language.number() == 120
        {
            let message = message!("a structure cannot be defined here", "ここで構造体は定義できません");
            self.sink.error(
                errors::VARIABLE_TYPE,
                member.ty.span,
                message,
                message!("define it before", "先に定義してください"),
            );
        }
        if member.declarators.is_empty() {
            let message = message!("a member without a name", "名前のないメンバーです");
            self.sink.error(errors::VARIABLE_TYPE, member.span, message, message!("this member", "このメンバー"));
        }
        if self.language.es() && matches!(member.ty.kind, TypeKind::Struct(_)) {
            let version = self.language.name();
            let message = message!(
                "{version} has no structure defined inside another",
                "{version} では構造体の中で構造体を定義できません"
            );
            self.sink.error(
                errors::VARIABLE_TYPE,
                member.ty.span,
                message,
                message!("define it before", "先に定義してください"),
            );
        }
        for declarator in &member.declarators {
            if let Some(initializer) = &declarator.initializer {
                let message = message!("a member cannot have an initialiser", "メンバーに初期化子は書けません");
                let label = message!("not allowed here", "ここには書けません");
                self.sink.error(errors::INITIALISER, self.arena.get(initializer.value).span, message, label);
            }
        }
        if bearer == Bearer::Nothing {
            for q in &member.qualifiers.list {
                // Images in structures came with handles.
                let image =
                    self.language.bindless() && matches!(q.kind, QualifierKind::Memory(_) | QualifierKind::Layout(_));
                if !matches!(q.kind, QualifierKind::Precision(_)) && !image {
                    self.qualifier(
                        q.span,
                        message!("it does not belong to a member", "構造体のメンバーには付けられません"),
                    );
                }
            }
        }
    }

    /// Types the values of `layout(location = …)`.
    pub(super) fn layout_values(&mut self, qualifiers: &Qualifiers) {
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
            let message =
                message!("`{given}` cannot initialise `{ty} {name}`", "`{given}` で `{ty} {name}` は初期化できません");
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
        if items.is_empty() && self.language.enabled("EXT_null_initializer") {
            self.out.types[id.index()] = ty.clone();
            self.constant[id.index()] = true;
            return ty.clone();
        }
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
            let known = declarator.initializer.as_ref().is_none_or(|initializer| self.is_constant(initializer.value));
            let symbol = self.declare(&declarator.name, ty, SymbolKind::Local, constant, value.filter(|_| constant));
            if constant {
                self.out.symbols[symbol.index()].initializer = declarator.initializer.as_ref().map(|i| i.value);
            }
            if constant && !known {
                self.run_time.insert(symbol);
            }
        }
    }

    fn declarator(&mut self, base: &Type, declarator: &Declarator) -> (Type, Option<Const>) {
        let ty = self.declared_type(base, &declarator.dims);
        if ty.is_void() {
            let message = format!("`{}` cannot be `void`", declarator.name.name);
            self.sink.error(errors::UNKNOWN_TYPE, declarator.name.span, message, "a variable needs a type with values");
            return (Type::Error, None);
        }
        match &declarator.initializer {
            Some(initializer) => self.initializer(&declarator.name, ty, initializer.value),
            None => (ty, None),
        }
    }

    /// An unsized input of a geometry stage has an element for each vertex of the primitive, one of a
    /// tessellation stage for each vertex of the patch.
    pub(super) fn stage_type(&self, ty: Type, storage: Storage) -> Type {
        match (ty, storage, self.vertices) {
            (Type::Array(element, ArraySize::Unsized), Storage::In, Some(n)) if self.stage == Stage::Geometry => {
                Type::Array(element, ArraySize::Known(n))
            }
            (Type::Array(element, ArraySize::Unsized), Storage::In | Storage::Out, _)
                if matches!(self.stage, Stage::TessControl | Stage::TessEvaluation) =>
            {
                Type::Array(element, ArraySize::Unknown)
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
        self.subroutine_variable(qualifiers);
        let base = self.specified_type(&declaration.ty);
        self.precision_needed(qualifiers, &base, declaration.ty.span);
        for (position, declarator) in declaration.declarators.iter().enumerate() {
            let (ty, value) = self.declarator(&base, declarator);
            self.global_rules(declarator, &ty, storage, qualifiers);
            let ty = self.stage_type(ty, storage);
            let value = value.filter(|_| storage == Storage::Const);
            let symbol = self.declare(&declarator.name, ty.clone(), SymbolKind::Global(storage), read_only, value);
            if storage == Storage::Const {
                self.out.symbols[symbol.index()].initializer = declarator.initializer.as_ref().map(|i| i.value);
            }
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
        let again =
            name.name.starts_with("gl_") && self.redeclared_builtin(name, ty, qualifiers.storage().map(|_| storage));
        self.reserved_name(name, again);
        let bearer = if again { Bearer::Builtin } else { Bearer::Variable(storage) };
        self.layout_rules(qualifiers, bearer, Some(ty));
        if again {
            self.limited_size(&name.name, &declarator.dims);
            if name.name == "gl_FragCoord" {
                let origin =
                    ["origin_upper_left", "pixel_center_integer"].map(|k| qualifiers.layout_entry(k).is_some());
                if self.fragment_origin.replace(origin).is_some_and(|old| old != origin) {
                    let message =
                        message!("`gl_FragCoord` has other layouts above", "`gl_FragCoord` の layout が上と違います");
                    self.sink.error(
                        errors::REDECLARATION,
                        name.span,
                        message,
                        message!("second declaration", "二つ目の宣言"),
                    );
                }
            }
            return;
        }
        let per_vertex = matches!(
            (self.stage, storage),
            (Stage::Geometry | Stage::TessControl | Stage::TessEvaluation, Storage::In)
                | (Stage::TessControl, Storage::Out)
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
        self.patch_array(name, ty, storage, qualifiers);
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
        self.subroutine_rules(function, &return_type, &params);
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
                let message = message!("`{name}` never returns a value", "`{name}` は値を一度も返しません");
                let label = message!("has no `return`", "`return` がありません");
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
        let again =
            function.body.is_none() && !old.prototypes.is_empty() && self.language.es() && self.language.number() < 300;
        let constants = |f: &Function| f.params.iter().map(|p| p.qualifiers.is_const()).collect::<Vec<_>>();
        let before = old.prototypes.first().copied().or(old.definition).and_then(|k| self.unit.items.get(k));
        let directions = directions
            && before.is_none_or(|item| match &item.kind {
                ItemKind::Function(f) => constants(f) == constants(function),
                _ => true,
            });
        let twice = (function.body.is_some() && old.definition.is_some()) || !directions || again;
        let differs = old.return_type != *return_type && !old.return_type.is_error() && !return_type.is_error();
        if twice || differs {
            let (first, old_return) = (old.name.span, old.return_type.to_string());
            let message = if differs {
                format!("`{}` returns `{return_type}` here and `{old_return}` before", name.name)
            } else if !directions {
                format!("`{}` has other `in`, `out` and `const` parameters here than before", name.name)
            } else if again {
                format!("`{}` is declared twice, which this version does not allow", name.name)
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
