//! What may be written (GLSL 4.60 specification, section 5.8).

use super::super::ast::{ExprId, ExprKind, MemoryQualifier, QualifierKind, Qualifiers};
use super::super::interface::Storage;
use super::super::symbols::{SymbolId, SymbolKind};
use super::super::types::Type;
use super::super::{Stage, errors};
use super::Checker;
use base::diagnostic::{Message, message};
use base::text::Span;

impl Checker<'_> {
    /// True when an expression names a place that may be written; tells why not.
    pub(super) fn assignable(&mut self, target: ExprId) -> bool {
        let mut at = target;
        loop {
            let expr = self.arena.get(at);
            at = match &expr.kind {
                ExprKind::Name(_) => return self.writable(at, expr.span),
                ExprKind::Error => return true,
                ExprKind::Paren(inner) => *inner,
                // A reference to a buffer (GL_EXT_buffer_reference) has a type of an extension. What it points to may
                // be written wherever the reference itself is kept.
                ExprKind::Index { base, .. } | ExprKind::Field { base, .. } if self.type_of(*base).is_error() => {
                    return true;
                }
                ExprKind::Index { base, index: _ } => *base,
                ExprKind::Field { base, field } => {
                    let base_ty = self.type_of(*base);
                    if base_ty.scalar().is_some() && repeats(&field.name) {
                        let name = &field.name;
                        let message = message!(
                            "`.{name}` names a component twice and cannot be written",
                            "`.{name}` は同じ成分を二度指すので書き込めません"
                        );
                        self.sink.error(
                            errors::SWIZZLE,
                            field.span,
                            message,
                            message!("written here", "ここで書き込み"),
                        );
                        return false;
                    }
                    if let Type::Struct(s) = base_ty
                        && s.fields.iter().any(|f| f.name == field.name && is_locked(&f.qualifiers))
                    {
                        let name = &field.name;
                        let message = message!("`{name}` is `readonly`", "`{name}` は `readonly` です");
                        self.sink.error(
                            errors::READ_ONLY,
                            field.span,
                            message,
                            message!("written here", "ここで書き込み"),
                        );
                        return false;
                    }
                    *base
                }
                ExprKind::Literal(_)
                | ExprKind::Method { .. }
                | ExprKind::Call { .. }
                | ExprKind::Unary { .. }
                | ExprKind::Postfix { .. }
                | ExprKind::Binary { .. }
                | ExprKind::Assign { .. }
                | ExprKind::Ternary { .. }
                | ExprKind::Comma { .. }
                | ExprKind::List(_) => {
                    let span = self.arena.get(target).span;
                    self.sink.error(
                        errors::NOT_A_PLACE,
                        span,
                        message!(
                            "only a variable or a part of one can be written",
                            "書き込めるのは変数かその一部だけです"
                        ),
                        message!("not a variable", "変数ではありません"),
                    );
                    return false;
                }
            };
        }
    }

    fn writable(&mut self, name: ExprId, span: Span) -> bool {
        let Some(id) = self.out.names[name.index()] else { return true };
        let symbol = &self.out.symbols[id.index()];
        let text = symbol.name.clone();
        if symbol.ty.contains_opaque() && !self.language.bindless() {
            let ty = symbol.ty.to_string();
            let message = message!("`{text}`, a `{ty}`, cannot be written", "`{text}`（`{ty}`）には書き込めません");
            let label = message!("written here", "ここで書き込み");
            self.sink.error(errors::NOT_A_PLACE, span, message, label);
            return false;
        }
        if !symbol.read_only {
            return true;
        }
        let declared = symbol.span;
        let what = self.why_read_only(id);
        let file = self.sink.file.clone();
        let mut d = self
            .sink
            .start(errors::READ_ONLY, span, message!("`{text}` can only be read", "`{text}` は読み取り専用です"))
            .with_label(message!("written here", "ここで書き込み"))
            .with_why(what)
            .with_help(message!("copy it into a local variable first", "先に局所変数へ写してください"));
        if let Some(declared) = declared {
            d = d.with_related(&file, declared, message!("declared here", "宣言はここ"));
        }
        self.sink.push(d);
        false
    }

    fn why_read_only(&self, id: SymbolId) -> Message {
        let input = || match self.stage {
            Stage::Vertex => message!("it is a vertex attribute", "頂点属性だからです"),
            _ => message!("it is an input of the stage", "ステージの入力だからです"),
        };
        match self.out.symbols[id.index()].kind {
            SymbolKind::Global(Storage::In) => input(),
            SymbolKind::Global(Storage::Uniform) => {
                message!("it is a uniform: only the host sets it", "uniform は CPU 側だけが設定します")
            }
            SymbolKind::Global(Storage::Const) | SymbolKind::Local | SymbolKind::Param(_) => {
                message!("it is `const`", "`const` だからです")
            }
            SymbolKind::Builtin => {
                message!("this stage can only read this built-in", "このステージでは読み取り専用の組み込みです")
            }
            SymbolKind::BlockMember(_) | SymbolKind::BlockInstance(_) => message!(
                "its block is an input, a uniform block or `readonly`",
                "入力・uniform・`readonly` のブロックに属しています"
            ),
            SymbolKind::Global(Storage::Out | Storage::Buffer | Storage::Shared | Storage::Global) => {
                message!("it is `readonly`", "`readonly` だからです")
            }
        }
    }
}

fn is_locked(qualifiers: &Qualifiers) -> bool {
    qualifiers.list.iter().any(|q| q.kind == QualifierKind::Memory(MemoryQualifier::ReadOnly))
}

fn repeats(name: &str) -> bool {
    name.char_indices().any(|(i, c)| name[i + c.len_utf8()..].contains(c))
}
