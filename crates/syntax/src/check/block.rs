//! Blocks and the layout of a whole stage.

use std::sync::Arc;

use super::super::ast::{
    Declaration, Ident, InterfaceBlock, QualifiedNames, QualifierKind, Qualifiers, StorageQualifier,
};
use super::super::fold::Const;
use super::super::interface::{Block, BlockMember, InputPrimitive, Located, OutputPrimitive, StageLayout, Storage};
use super::super::language::{Feature, NEVER};
use super::super::symbols::SymbolKind;
use super::super::types::{StructField, StructType, Type};
use super::super::vast::too_large;
use super::super::{Stage, builtin, errors};
use super::layouts::Bearer;
use super::{Checker, Entry};
use base::diagnostic::message;
use base::text::Span;

impl Checker<'_> {
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
            Some((
                StorageQualifier::Attribute
                | StorageQualifier::Varying
                | StorageQualifier::Const
                | StorageQualifier::InOut,
                _,
            )) => true,
            Some((StorageQualifier::Shared, _)) => {
                stage != Stage::Compute || !self.language.since((NEVER, NEVER, &["EXT_shared_memory_block"]))
            }
            Some((StorageQualifier::In, _)) => stage == Stage::Vertex,
            Some((StorageQualifier::Out, _)) => stage == Stage::Fragment,
            Some((StorageQualifier::Uniform | StorageQualifier::Buffer, _)) => false,
            None => true,
        };
        if wrong {
            let text = word.map_or("", |w| w.0.text());
            let message = message!("this stage has no `{text}` block", "このステージに `{text}` ブロックはありません");
            self.sink.error(errors::REDECLARATION, name.span, message, message!("this block", "このブロック"));
        }
        if per_vertex {
            self.per_vertex_rules(block, storage);
            return true;
        }
        self.reserved_name(name, false);
        if let Some(first) = self.functions.get(&name.name).and_then(|all| all.first()) {
            let first = self.out.functions[first.index()].name.span;
            self.redefinition(name, Some(first));
        }
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
        let names: Vec<String> =
            block.members.iter().flat_map(|m| m.declarators.iter().map(|d| d.name.name.clone())).collect();
        let instance = block.instance.as_ref().map(|i| i.name.as_str());
        let wanted = match (self.stage, storage) {
            (Stage::Geometry | Stage::TessControl | Stage::TessEvaluation, Storage::In) => Some("gl_in"),
            (Stage::TessControl, Storage::Out) => Some("gl_out"),
            _ => None,
        };
        let why = if self.stage == Stage::Fragment || self.per_vertex.insert(storage, names).is_some() {
            Some(message!(
                "this block is declared once, outside fragment shaders",
                "このブロックの宣言は一度だけで、フラグメントシェーダにはありません"
            ))
        } else if instance != wanted || wanted.is_some() == block.dims.is_empty() {
            Some(match wanted {
                Some(wanted) => message!("it ends with `{wanted}[]`", "`{wanted}[]` で終わる必要があります"),
                None => message!("it has no instance name", "インスタンス名はありません"),
            })
        } else {
            let used = |u: &super::super::symbols::Use| {
                let name = self.out.symbols[u.symbol.index()].name.as_str();
                if storage == Storage::In { name == "gl_in" } else { builtin::in_per_vertex(name) }
            };
            let declared = storage == Storage::Out
                && self.scopes.first().is_some_and(|s| s.entries.keys().any(|n| builtin::in_per_vertex(n)));
            (self.out.uses.iter().any(used) || declared)
                .then(|| message!("its members are used above", "メンバーが上で使われています"))
        };
        if let Some(why) = why.filter(|_| !self.language.is_open()) {
            let message =
                message!("`gl_PerVertex` cannot be declared like this", "`gl_PerVertex` はこのように宣言できません");
            let d = self
                .sink
                .start(errors::REDECLARATION, block.name.span, message)
                .with_label(message!("this block", "このブロック"));
            self.sink.push(d.with_why(why));
        }
    }

    /// Rules of a member of a block.
    fn block_member_rules(
        &mut self,
        member: &Declaration,
        storage: Storage,
        name: &Ident,
        ty: &Type,
        block: &InterfaceBlock,
    ) {
        let opaque = ty.contains_opaque() && !self.language.is_open();
        if opaque {
            let message = message!("a block cannot hold `{ty}`", "ブロックに `{ty}` は入れられません");
            self.sink.error(errors::VARIABLE_TYPE, name.span, message, message!("this member", "このメンバー"));
        }
        self.layout_rules(&member.qualifiers, Bearer::Member(storage), Some(ty));
        if let Some((StorageQualifier::Varying | StorageQualifier::Attribute, span)) = member.qualifiers.storage() {
            self.qualifier(span, message!("a block has `in` and `out`", "ブロックでは `in`・`out` を使います"));
        } else if let Some((word, span)) = member.qualifiers.storage()
            && Storage::of(word, self.stage) != storage
        {
            self.qualifier(span, message!("the block has another storage", "ブロックの記憶域と違います"));
        }
        for q in &member.qualifiers.list {
            if matches!(
                q.kind,
                QualifierKind::Interpolation(_) | QualifierKind::Auxiliary(_) | QualifierKind::Invariant
            ) && !matches!(storage, Storage::In | Storage::Out)
            {
                self.qualifier(q.span, message!("it belongs to inputs and outputs", "入出力に付ける修飾子です"));
            }
        }
        if matches!(storage, Storage::In | Storage::Out) && !opaque {
            let mut all = member.qualifiers.clone();
            all.list.extend(block.qualifiers.list.iter().cloned());
            self.storage_type(ty, storage, &all, name.span);
        }
    }

    /// A member of a block of built-in variables is one of them.
    fn per_vertex_member(&mut self, name: &Ident) {
        const MEMBERS: [&str; 4] = ["gl_Position", "gl_PointSize", "gl_ClipDistance", "gl_CullDistance"];
        let text = name.name.as_str();
        if builtin::variable(text, self.stage, self.vertices).is_some() || MEMBERS.contains(&text) {
            return;
        }
        let message = message!("`gl_PerVertex` has no member `{text}`", "`gl_PerVertex` に `{text}` はありません");
        self.sink.error(errors::REDECLARATION, name.span, message, message!("unknown member", "未知のメンバー"));
    }

    /// Rules of the dimensions of a block, whose type with them is `ty`.
    fn block_array_rules(&mut self, block: &InterfaceBlock, storage: Storage, ty: &Type, builtin_block: bool) {
        if block.dims.len() > 1 {
            self.need(Feature::ArraysOfArrays, block.dims[1].span);
        }
        if let (Storage::Uniform, Some(dim)) = (storage, block.dims.first().filter(|d| d.size.is_none()))
            && (self.language.es() || !self.language.at_least(430, u32::MAX))
            && !self.language.is_open()
        {
            let message =
                message!("an array of uniform blocks needs a size", "uniform ブロックの配列には大きさが必要です");
            self.sink.error(errors::ARRAY, dim.span, message, message!("no size", "大きさがない"));
        }
        if !builtin_block {
            let name = block.instance.as_ref().unwrap_or(&block.name).clone();
            self.patch_array(&name, ty, storage, &block.qualifiers);
        }
        if storage == Storage::In && !builtin_block {
            let name = block.instance.as_ref().unwrap_or(&block.name);
            self.geometry_input(name, ty, name.span);
        }
    }

    pub(super) fn block(&mut self, item: usize, block: &InterfaceBlock, span: Span) {
        let storage = block.qualifiers.storage().map_or(Storage::Uniform, |(s, _)| Storage::of(s, self.stage));
        self.layout_values(&block.qualifiers);
        let read_only = |member: &Qualifiers| {
            let locked = QualifierKind::Memory(super::super::ast::MemoryQualifier::ReadOnly);
            matches!(storage, Storage::In | Storage::Uniform) || member.list.iter().any(|q| q.kind == locked)
        };
        let index = self.out.interface.blocks.len();
        // A type (GL_EXT_buffer_reference), so that its members are no names of the shader and the host binds nothing.
        let reference = block.qualifiers.layout_entry("buffer_reference").is_some();
        let mut members = Vec::new();
        let mut fields: Vec<StructField> = Vec::new();
        let builtin_block = self.block_rules(block, storage);
        if block.members.is_empty() && !self.sink.has(errors::SYNTAX) {
            let message = message!("a block needs a member", "ブロックにはメンバーが必要です");
            self.sink.error(errors::VARIABLE_TYPE, block.body_span, message, message!("empty", "空です"));
        }
        let last = block.members.len().saturating_sub(1);
        for (at, member) in block.members.iter().enumerate() {
            self.member_rules(member, Bearer::Member(storage));
            self.precision_needed(&member.qualifiers, &Type::Error, member.span);
            for (name, ty, declarator) in self.member_types(member) {
                self.limited_size(&name.name, &declarator.dims);
                if !builtin_block {
                    self.reserved_name(&name, false);
                    self.block_member_rules(member, storage, &name, &ty, block);
                } else {
                    self.per_vertex_member(&name);
                }
                if let Some(first) = fields
                    .iter()
                    .find(|f: &&StructField| f.name == name.name && (block.instance.is_some() || reference))
                    .map(|f| f.span)
                {
                    self.redefinition(&name, Some(first));
                }
                let runtime = storage == Storage::Buffer && at == last;
                self.array_rules(&ty, declarator.span, false, runtime || !self.language.es());
                let symbol = if block.instance.is_none() && !reference {
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
        let placed: Vec<(Type, &Qualifiers)> = members.iter().map(|m| (m.ty.clone(), &m.qualifiers)).collect();
        self.offset_rules(block, storage, &placed);
        if reference {
            return;
        }
        if let Some(why) = too_large(&mut fields) {
            self.sink.error(errors::TOO_DEEP, block.name.span, why, "use an array, or fewer levels");
        }
        let base = Type::Struct(Arc::new(StructType { name: block.name.name.clone(), fields, span: block.name.span }));
        let ty = self.dimensions(base, &block.dims);
        self.block_array_rules(block, storage, &ty, builtin_block);
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

    pub(super) fn stage_layout(&mut self, item: usize, names: &QualifiedNames, span: Span) {
        self.layout_values(&names.qualifiers);
        let storage = names.qualifiers.storage().map(|(s, _)| Storage::of(s, self.stage));
        match storage {
            Some(storage) => self.layout_rules(&names.qualifiers, Bearer::Stage(storage), None),
            None => {
                if let Some(span) = names.qualifiers.span()
                    && names.qualifiers.layouts().next().is_some()
                    && !self.language.is_open()
                {
                    self.qualifier(
                        span,
                        message!(
                            "it needs `in`, `out`, `uniform` or `buffer`",
                            "`in`・`out`・`uniform`・`buffer` のいずれかが必要です"
                        ),
                    );
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
                // Of one declaration the last value counts.
                if entry.value.is_some()
                    && qualifiers.layout_entry(&entry.key.name).is_some_and(|e| e.span != entry.span)
                {
                    continue;
                }
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
                                let message = message!(
                                    "a second input primitive, `{key}`",
                                    "二つ目の入力プリミティブ `{key}` です"
                                );
                                self.sink.error(errors::LAYOUT, span, message, message!("second one", "二つ目"));
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
                                let message = message!(
                                    "a second output primitive, `{key}`",
                                    "二つ目の出力プリミティブ `{key}` です"
                                );
                                self.sink.error(errors::LAYOUT, span, message, message!("second one", "二つ目"));
                                continue;
                            }
                            geometry.output = Some(Located { value, span });
                        } else if key == "max_vertices" {
                            geometry.max_vertices = geometry.max_vertices.or(number);
                        }
                    }
                    Some(Storage::Uniform | Storage::Buffer | Storage::Shared | Storage::Const | Storage::Global)
                    | None => {}
                }
            }
        }
    }
}
