//! Indices, sizes of arrays, literals and swizzles of scalars: what depends on values and versions.

use super::super::ast::{ExprId, ExprKind, Ident, Literal};
use super::super::errors;
use super::super::fold::Const;
use super::super::interface::Storage;
use super::super::language::Feature;
use super::super::types::{ArraySize, ScalarType, Type};
use super::expression::article;
use super::{Checker, SymbolKind};
use base::diagnostic::{Lang, Message, Safety, message};
use base::text::{Edit, Span};

impl Checker<'_> {
    /// The range of a constant index, and where an index must be constant.
    pub(super) fn index_rules(&mut self, base: ExprId, base_ty: &Type, index: ExprId) {
        let span = self.arena.get(index).span;
        let value = self.value_of(index).and_then(Const::as_integer);
        let count = base_ty.index_count();
        let name = match &self.arena.get(base).kind {
            ExprKind::Name(name) => Some(name.clone()),
            ExprKind::Field { field, .. } => Some(field.name.clone()),
            _ => None,
        };
        if let Some(limit) = name.as_deref().and_then(super::places::limit_of)
            && self.beyond_limit(index, limit).is_some_and(|more| more >= 0)
        {
            let message = message!("there is no element `{limit}`", "`{limit}` 番の要素はありません");
            return self.sink.error(errors::INDEX_RANGE, span, message, message!("this index", "この添字"));
        }
        if let Some(value) = value {
            let beyond = count.is_some_and(|n| value >= i64::from(n));
            if value < 0 || beyond {
                let has = match count {
                    Some(n) => {
                        let last = n.saturating_sub(1);
                        message!("the elements are 0 to {last}", "要素は 0 から {last} です")
                    }
                    None => message!("elements are counted from 0", "要素は 0 から数えます"),
                };
                let d = self
                    .sink
                    .start(
                        errors::INDEX_RANGE,
                        span,
                        message!("there is no element {value}", "{value} 番の要素はありません"),
                    )
                    .with_label(message!("this index", "この添字"))
                    .with_why(has)
                    .with_help(message!("use an index inside the range", "範囲内の添字にしてください"));
                self.sink.push(d);
                return;
            }
            if let Type::Array(_, ArraySize::Unsized) = base_ty {
                self.note_index(base, value);
            }
            return;
        }
        if self.is_constant(index) || self.type_of(index).is_error() {
            return;
        }
        match base_ty {
            Type::Array(_, ArraySize::Unsized) if !self.runtime_sized(base) && !self.bound_at_run_time(base) => {
                self.sink.error(
                    errors::ARRAY,
                    span,
                    message!(
                        "an array without a size takes constant indices only",
                        "大きさのない配列の添字は定数に限られます"
                    ),
                    message!("this index varies", "この添字は定数ではありません"),
                );
            }
            Type::Array(element, _)
                // A structure may be indexed for its other members.
                if !matches!(**element, Type::Struct(_)) && element.contains_opaque() && !self.language.has(Feature::OpaqueIndex)
                // The first versions leave it to the driver.
                && self.language.at_least(130, 300) =>
            {
                self.need(Feature::OpaqueIndex, span);
            }
            Type::Array(..) => self.block_index(base, span),
            _ => {}
        }
    }

    /// Before 4.00 an array of uniform blocks takes constant indices.
    fn block_index(&mut self, base: ExprId, span: Span) {
        let Some(symbol) = self.out.names[base.index()] else { return };
        let SymbolKind::BlockInstance(_) = self.out.symbols[symbol.index()].kind else { return };
        let uniform = self.uniform_blocks.contains(&symbol);
        if uniform && !self.language.has(Feature::OpaqueIndex) {
            self.sink.error(
                errors::INDEX,
                span,
                message!("an array of blocks takes constant indices only", "ブロックの配列の添字は定数に限られます"),
                message!("this index varies", "この添字は定数ではありません"),
            );
        }
    }

    /// True for the last member of a storage block: its size is known when the shader runs.
    pub(super) fn runtime_sized(&self, base: ExprId) -> bool {
        let mut at = base;
        loop {
            match &self.arena.get(at).kind {
                ExprKind::Name(_) => {
                    let Some(symbol) = self.out.names[at.index()] else { return true };
                    return self.runtime.contains(&symbol);
                }
                ExprKind::Field { base, .. } | ExprKind::Index { base, .. } => at = *base,
                ExprKind::Paren(inner) => at = *inner,
                _ => return false,
            }
        }
    }

    /// True for an array of resources without a size: how many there are is up to what the host binds
    /// (GL_EXT_nonuniform_qualifier).
    fn bound_at_run_time(&self, base: ExprId) -> bool {
        let kind = self.out.names[base.index()].map(|symbol| self.out.symbols[symbol.index()].kind);
        self.language.enabled("EXT_nonuniform_qualifier")
            && matches!(kind, Some(SymbolKind::Global(Storage::Uniform) | SymbolKind::BlockInstance(_)))
    }

    /// The greatest constant index into an array whose size is not declared yet.
    fn note_index(&mut self, base: ExprId, value: i64) {
        if let ExprKind::Field { field, .. } = &self.arena.get(base).kind {
            self.builtin_limit(&field.name, value + 1, field.span);
        }
        if let Some(symbol) = self.out.names[base.index()] {
            let name = self.out.symbols[symbol.index()].name.clone();
            self.builtin_limit(&name, value + 1, self.arena.get(base).span);
            let most = self.most_index.entry(symbol).or_default();
            *most = (*most).max(value);
        }
    }

    pub(super) fn scalar_swizzle(&mut self, base: ExprId, ty: &Type, result: &Type, field: &Ident) {
        let name = &field.name;
        let text = self.sink.file.slice(self.arena.get(base).span).to_owned();
        let wanted = self.language.wanted(Feature::ScalarSwizzles.since());
        let (en, ja) = (wanted.in_lang(Lang::En).to_owned(), wanted.in_lang(Lang::Ja).to_owned());
        let d = self
            .sink
            .start(
                errors::SCALAR_SWIZZLE,
                field.span,
                message!("`.{name}` is taken of a `{ty}`, a scalar", "スカラ `{ty}` から `.{name}` を取り出しています"),
            )
            .with_label(message!("a scalar has no components", "スカラに成分はありません"))
            .with_why(Message::new(
                format!("only {en} has swizzles of scalars"),
                format!("スカラのスウィズルは {ja} だけにあります"),
            ))
            .with_help(message!("write `{result}({text})`", "`{result}({text})` と書いてください"));
        self.sink.push(d);
    }

    pub(super) fn literal(&mut self, literal: Literal, span: Span, from_macro: bool) {
        match literal {
            Literal::Uint(_) => {
                self.need(Feature::UnsignedIntegers, span);
            }
            Literal::Double(_) => {
                self.need(Feature::Doubles, span);
            }
            Literal::Half(_) => self.need_type(ScalarType::Half, span),
            Literal::Sized(_, ty) => self.need_type(ty, span),
            Literal::Float(_) => {
                let suffix = !from_macro && self.sink.file.slice(span).ends_with(['f', 'F']);
                if suffix && !self.language.has(Feature::FloatSuffix) {
                    let version = self.language.name();
                    let text = self.sink.file.slice(span).to_owned();
                    let d = self
                        .sink
                        .start(
                            errors::FLOAT_SUFFIX,
                            span,
                            message!("{version} has no suffix `f`", "{version} に接尾辞 `f` はありません"),
                        )
                        .with_label(message!("this literal", "このリテラル"))
                        .with_help(message!("write it without the suffix", "接尾辞を除いてください"));
                    let plain = text.trim_end_matches(['f', 'F']);
                    let point = if plain.contains(['.', 'e', 'E']) { "" } else { ".0" };
                    self.sink.push(d.with_fix(
                        message!("remove the suffix", "接尾辞を除く"),
                        Safety::Safe,
                        vec![Edit::replace(span, format!("{plain}{point}"))],
                    ));
                }
            }
            Literal::Bool(_) | Literal::Int(_) => {}
        }
    }

    /// A positive constant integer, as an array size needs it.
    pub(super) fn array_size(&mut self, id: ExprId) -> ArraySize {
        self.expression(id);
        self.size_value(id)
    }

    /// The same for an expression that has its type already.
    pub(super) fn size_value(&mut self, id: ExprId) -> ArraySize {
        let ty = self.type_of(id).clone();
        let value = self.value_of(id).and_then(Const::as_integer);
        let span = self.arena.get(id).span;
        if !ty.is_error() && value.is_some() && !self.is_constant(id) {
            self.sink.error(
                errors::CONSTANT,
                span,
                message!("the size of an array must be constant", "配列の大きさは定数でなければなりません"),
                message!("this size", "この大きさ"),
            );
            return ArraySize::Unknown;
        }
        match value.map(u32::try_from) {
            Some(Ok(n)) if n > 0 => return ArraySize::Known(n),
            Some(_) => {
                self.sink.error(errors::CONSTANT, span, "the size of an array must be positive", "this size");
            }
            None if ty.is_error() => {}
            None if !(ty.is_scalar() && ty.scalar().is_some_and(ScalarType::is_integer)) => {
                let message = format!("the size of an array must be an integer, not {} `{ty}`", article(&ty));
                self.sink.error(errors::CONSTANT, span, message, "this size");
            }
            // Only our folding is too weak.
            None if self.is_constant(id) => {}
            None => {
                let d = self.sink.start(errors::CONSTANT, span, "the size of an array must be constant");
                let d = d.with_label("not known when the shader is compiled");
                self.sink.push(d.with_help("declare it as `const int`"));
            }
        }
        ArraySize::Unknown
    }
}
