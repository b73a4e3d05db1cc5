//! Constant expressions (GLSL 4.60 specification, section 4.3.3) and what the version has.

use super::super::ast::{ExprId, ExprKind, UnaryOp};
use super::super::builtin;
use super::super::errors;
use super::super::interface::Storage;
use super::super::language::{Feature, Since};
use super::super::symbols::{CallTarget, SymbolKind};
use super::super::types::{ArraySize, ScalarType, Type};
use super::Checker;
use base::diagnostic::{Message, message};
use base::text::Span;

impl Checker<'_> {
    /// Tells when the version lacks a feature. The feature is told once.
    pub(super) fn need(&mut self, feature: Feature, span: Span) -> bool {
        if self.language.has(feature) {
            return true;
        }
        if self.reported_features.insert(feature) {
            self.lacks(feature.name(), feature.since(), span);
        }
        false
    }

    /// Tells a literal of a type that only an extension brings, where none is on.
    pub(super) fn need_type(&mut self, scalar: ScalarType, span: Span) {
        let name = scalar.name();
        if let Some(since) = builtin::type_since(name).filter(|since| !self.language.since(*since))
            && self.reported_names.insert(name.to_owned())
        {
            self.lacks(message!("a literal of `{name}`", "`{name}` のリテラル"), since, span);
        }
    }

    /// Tells that something came later than this version.
    pub(super) fn lacks(&mut self, what: Message, since: Since, span: Span) {
        self.language.lacks(self.sink, &what, since, span);
    }

    /// True when the expression is constant by the rules of the language.
    pub(super) fn is_constant(&self, id: ExprId) -> bool {
        self.constant.get(id.index()).copied().unwrap_or(false)
    }

    /// Whether an expression is constant, when its operands are known.
    pub(super) fn constness(&self, id: ExprId) -> bool {
        let expr = self.arena.get(id);
        let all = || expr.children().iter().all(|c| self.is_constant(*c));
        match &expr.kind {
            ExprKind::Literal(_) | ExprKind::Error => true,
            ExprKind::Name(_) => match self.out.names[id.index()] {
                Some(symbol) => self.is_constant_symbol(symbol) || self.is_written_out(expr.span, symbol),
                // It has been told that it is unknown.
                None => true,
            },
            ExprKind::Unary { op: UnaryOp::Increment | UnaryOp::Decrement, .. }
            | ExprKind::Postfix { .. }
            | ExprKind::Assign { .. } => false,
            // A sequence is no constant from 1.20 and ES 3.00 on.
            ExprKind::Comma { .. } => all() && !self.language.at_least(120, 300),
            ExprKind::Method { base, .. } => {
                // An array over the vertices of a patch has as many as the implementation knows.
                let ty = self.type_of(*base);
                ty.index_count().is_some() || ty.is_error() || matches!(ty, Type::Array(_, ArraySize::Unknown))
            }
            ExprKind::Call { callee: _, args: _ } => match &self.out.calls[id.index()] {
                Some(CallTarget::User(_)) => false,
                Some(CallTarget::Builtin(_)) => {
                    let name = match &expr.kind {
                        ExprKind::Call { callee: super::super::ast::Callee::Name(name), .. } => name.name.as_str(),
                        _ => "",
                    };
                    let sampled = name.starts_with("texture")
                        || name.starts_with("shadow")
                        || name.starts_with("texelFetch")
                        || name.starts_with("image")
                        || name.starts_with("atomic")
                        || name.starts_with("interpolate");
                    let noise = name.starts_with("noise") && self.language.number() >= 120;
                    all() && !sampled && !noise && name != "ftransform" && self.language.has(Feature::ConstantCalls)
                }
                Some(CallTarget::Constructor(_)) | None => all(),
            },
            ExprKind::Paren(_)
            | ExprKind::Index { .. }
            | ExprKind::Field { .. }
            | ExprKind::Unary { .. }
            | ExprKind::Binary { .. }
            | ExprKind::Ternary { .. }
            | ExprKind::List(_) => all(),
        }
    }

    /// True for the counter of a loop that three.js writes out before it compiles the text, where it alone is an index: each
    /// `[ i ]` becomes a number then, and nothing else (`unrollLoops` of its `WebGLProgram`).
    fn is_written_out(&self, place: Span, counter: super::super::symbols::SymbolId) -> bool {
        let text = self.sink.file.text();
        let (Some(before), Some(after)) = (text.get(..place.start), text.get(place.end..)) else { return false };
        let is_index = before.trim_end().ends_with('[') && after.trim_start().starts_with(']');
        let Some(declared) = self.out.symbols[counter.index()].span.filter(|_| is_index) else { return false };
        let mut head = text.get(..declared.start).unwrap_or("");
        for word in ["int", "(", "for"] {
            let Some(rest) = head.trim_end().strip_suffix(word) else { return false };
            head = rest;
        }
        let line = head.trim_end().rsplit('\n').next().unwrap_or("");
        let mut words = line.split_whitespace();
        match (words.next(), words.next(), words.next()) {
            (Some("#pragma"), Some("unroll_loop"), None) => true,
            (Some("#pragma"), Some("unroll_loop_start"), None) => after.contains("#pragma unroll_loop_end"),
            _ => false,
        }
    }

    fn is_constant_symbol(&self, symbol: super::super::symbols::SymbolId) -> bool {
        let (id, symbol) = (symbol, &self.out.symbols[symbol.index()]);
        match symbol.kind {
            SymbolKind::Builtin => {
                symbol.name.starts_with("gl_Max")
                    || symbol.name.starts_with("gl_Min")
                    || symbol.name.starts_with("gl_Scope")
                    || symbol.name.starts_with("gl_Semantics")
                    || symbol.name.starts_with("gl_StorageSemantics")
                    || symbol.name == "gl_WorkGroupSize"
            }
            SymbolKind::Global(storage) => storage == Storage::Const,
            SymbolKind::Local => symbol.read_only && !self.run_time.contains(&id),
            SymbolKind::BlockMember(_) | SymbolKind::BlockInstance(_) | SymbolKind::Param(_) => false,
        }
    }

    /// Tells an integer that stands for a `float` in a version without implicit conversions.
    pub(super) fn implicit(&mut self, id: ExprId, given: &Type, wanted: &Type) {
        if self.language.has(Feature::ImplicitConversions) {
            return;
        }
        let integer = given.scalar().is_some_and(ScalarType::is_integer);
        if !integer || wanted.scalar() != Some(ScalarType::Float) {
            return;
        }
        let version = self.language.name();
        let expr = self.arena.get(id);
        let d = self
            .sink
            .start(
                errors::IMPLICIT_FLOAT,
                expr.span,
                message!(
                    "`{given}` does not become `{wanted}` by itself",
                    "`{given}` は `{wanted}` に自動変換されません"
                ),
            )
            .with_label(message!("this is `{given}`", "これは `{given}`"))
            .with_why(message!("{version} has no implicit conversions", "{version} に暗黙の型変換はありません"));
        let literal = matches!(expr.kind, ExprKind::Literal(_)) && !expr.from_macro;
        let d = d.with_help(if literal {
            message!("write it with a decimal point", "小数点を付けてください")
        } else {
            message!("write `{wanted}(…)` around it", "`{wanted}(…)` で囲んでください")
        });
        self.sink.push(d);
    }

    /// Tells a built-in function or variable that this stage or version does not have.
    pub(super) fn absent(&mut self, name: &str, span: Span, why: builtin::Absent) {
        self.out.absent += 1;
        if !self.first_time(name) {
            return;
        }
        match why {
            builtin::Absent::Later(since) => self.lacks(message!("`{name}`", "`{name}` "), since, span),
            builtin::Absent::Stage => {
                let stage = self.stage.name();
                let message = message!(
                    "a {stage} shader does not have `{name}`",
                    "このステージ（{stage}）に `{name}` はありません"
                );
                let label = message!("not in this stage", "このステージにはない");
                self.sink.error(errors::UNKNOWN_NAME, span, message, label);
            }
            builtin::Absent::Removed => {
                let version = self.language.name();
                let profile = if self.language.es() { "" } else { " core" };
                let message = message!(
                    "{version}{profile} does not have `{name}`",
                    "{version}{profile} に `{name}` はありません"
                );
                let d = self.sink.start(errors::UNKNOWN_NAME, span, message);
                let help = match successor(name) {
                    Some(new) => message!("write `{new}`", "`{new}` と書いてください"),
                    None => message!("declare a variable of your own", "自分で変数を宣言してください"),
                };
                self.sink.push(
                    d.with_label(message!("removed from the language", "言語から削除されました")).with_help(help),
                );
            }
        }
    }
}

/// What a function of textures is called since it takes samplers of all kinds: `texture` for `texture2D`, `textureLod` for
/// `textureCubeLod`.
fn successor(name: &str) -> Option<String> {
    let rest = name.strip_prefix("texture").or_else(|| name.strip_prefix("shadow"))?;
    let rest = ["2DRect", "1D", "2D", "3D", "Cube"].iter().find_map(|dim| rest.strip_prefix(dim))?;
    Some(format!("texture{rest}"))
}
