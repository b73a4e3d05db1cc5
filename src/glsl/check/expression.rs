//! Types and values of expressions.

use super::super::ast::{BinaryOp, ExprId, ExprKind, Ident, Literal};
use super::super::errors;
use super::super::fold::{self, Const};
use super::super::names::nearest;
use super::super::types::{ArraySize, ScalarType, Type};
use super::operator::{self, Misfit};
use super::{Checker, Entry};
use crate::diagnostic::{Diagnostic, Safety};
use crate::text::{Edit, Span};

/// `a` or `an` before the name of a type.
pub(super) fn article(ty: &Type) -> &'static str {
    // `image2D`, `int`, `atomic_uint`; `uint` is spoken with a consonant.
    if ty.to_string().starts_with(['i', 'a']) { "an" } else { "a" }
}

impl Checker<'_> {
    /// Types an expression whose value is used, and records what it reads and writes.
    pub(super) fn expression(&mut self, root: ExprId) -> Type {
        self.type_expression(root);
        self.record_uses(root);
        self.type_of(root).clone()
    }

    /// Types an expression and everything below it: operands first, without recursion.
    pub(super) fn type_expression(&mut self, root: ExprId) {
        let mut order = Vec::new();
        let mut todo = vec![root];
        while let Some(id) = todo.pop() {
            order.push(id);
            todo.extend(self.arena.get(id).children());
        }
        for id in order.into_iter().rev() {
            let (ty, value) = self.one(id);
            self.out.types[id.index()] = ty;
            self.out.values[id.index()] = value;
        }
    }

    fn one(&mut self, id: ExprId) -> (Type, Option<Const>) {
        let expr = self.arena.get(id);
        match &expr.kind {
            ExprKind::Literal(literal) => {
                let value = match *literal {
                    Literal::Bool(v) => Const::Bool(v),
                    Literal::Int(v) => Const::Int(v),
                    Literal::Uint(v) => Const::Uint(v),
                    Literal::Float(v) => Const::Float(fold::round(v)),
                    Literal::Double(v) => Const::Double(v),
                };
                (value.ty(), Some(value))
            }
            ExprKind::Name(name) => self.name(id, name, expr.span),
            ExprKind::Paren(inner) => (self.type_of(*inner).clone(), self.value_of(*inner)),
            ExprKind::Index { base, index } => (self.index(*base, *index), None),
            ExprKind::Field { base, field } => (self.field(*base, field), None),
            ExprKind::Method { base, method, args } => self.method(*base, method, args),
            ExprKind::Call { callee, args } => self.call(id, callee, args),
            ExprKind::Unary { op, op_span, operand } => {
                let ty = self.type_of(*operand).clone();
                match operator::unary(*op, &ty) {
                    Ok(ty) => (ty, self.value_of(*operand).and_then(|v| fold::unary(*op, v))),
                    Err(misfit) => {
                        let message = format!("`{}` does not take {} `{ty}`", op.text(), article(&ty));
                        let help = if misfit == Misfit::Logic { "it takes a `bool`" } else { "it takes numbers" };
                        let d = self.sink.start(errors::OPERAND_TYPE, *op_span, message);
                        let label = format!("operand is {} `{ty}`", article(&ty));
                        self.sink.push(d.with_label(label).with_help(help));
                        (Type::Error, None)
                    }
                }
            }
            ExprKind::Postfix { increment, op_span, operand } => {
                let ty = self.type_of(*operand).clone();
                let numeric = ty.is_error() || ty.scalar().is_some_and(|s| s != ScalarType::Bool);
                if !numeric {
                    let op = if *increment { "++" } else { "--" };
                    let message = format!("`{op}` does not take {} `{ty}`", article(&ty));
                    self.sink.error(errors::OPERAND_TYPE, *op_span, message, "takes numbers");
                }
                (if numeric { ty } else { Type::Error }, None)
            }
            ExprKind::Binary { op, op_span, left, right } => {
                let ty = self.binary(*op, *op_span, *left, *right, expr.span);
                let value = match (self.value_of(*left), self.value_of(*right), ty.is_error()) {
                    (Some(a), Some(b), false) => fold::binary(*op, a, b),
                    _ => None,
                };
                (ty, value)
            }
            ExprKind::Assign { op, op_span, target, value } => {
                (self.assign(*op, *op_span, *target, *value, expr.span), None)
            }
            ExprKind::Ternary { condition, yes, no } => self.ternary(*condition, *yes, *no),
            ExprKind::Comma { left: _, right } => (self.type_of(*right).clone(), None),
            // The declaration gives a list its type.
            ExprKind::List(_) | ExprKind::Error => (Type::Error, None),
        }
    }

    fn name(&mut self, id: ExprId, name: &str, span: Span) -> (Type, Option<Const>) {
        if let Some(symbol) = self.variable(name) {
            self.out.names[id.index()] = Some(symbol);
            let symbol = &self.out.symbols[symbol.index()];
            return (symbol.ty.clone(), symbol.value);
        }
        if matches!(self.lookup(name), Some(Entry::Structure(_))) {
            if self.first_time(name) {
                let message = format!("`{name}` is a structure, not a variable");
                self.sink.error(errors::UNKNOWN_NAME, span, message, "a type stands where a value is needed");
            }
        } else {
            self.unknown_name(name, span);
        }
        (Type::Error, None)
    }

    fn index(&mut self, base: ExprId, index: ExprId) -> Type {
        let (base_ty, index_ty) = (self.type_of(base).clone(), self.type_of(index).clone());
        let integer =
            index_ty.is_error() || index_ty.is_scalar() && index_ty.scalar().is_some_and(ScalarType::is_integer);
        if !integer {
            let message = format!("an index must be an integer, not {} `{index_ty}`", article(&index_ty));
            self.sink.error(errors::INDEX, self.arena.get(index).span, message, "this index");
        }
        base_ty.indexed().unwrap_or_else(|| {
            let message = format!("{} `{base_ty}` has no elements to index", article(&base_ty));
            self.sink.error(errors::INDEX, self.arena.get(base).span, message, "indexed here");
            Type::Error
        })
    }

    fn field(&mut self, base: ExprId, field: &Ident) -> Type {
        let ty = self.type_of(base).clone();
        match &ty {
            Type::Error => Type::Error,
            Type::Struct(s) => {
                if let Some(found) = s.fields.iter().find(|f| f.name == field.name) {
                    return found.ty.clone();
                }
                let near = nearest(&field.name, s.fields.iter().map(|f| f.name.as_str())).map(str::to_owned);
                let message = format!("`{}` has no member `{}`", s.name, field.name);
                let d = self.sink.start(errors::UNKNOWN_FIELD, field.span, message).with_label("unknown member");
                self.sink.push(with_near(d, near));
                Type::Error
            }
            Type::Scalar(scalar) => self.swizzle(&ty, *scalar, 1, field),
            Type::Vector(scalar, n) => self.swizzle(&ty, *scalar, *n, field),
            Type::Void | Type::Matrix(..) | Type::Opaque(_) | Type::Array(..) => {
                if ty.is_error() {
                    return Type::Error;
                }
                let message = format!("{} `{ty}` has no member `{}`", article(&ty), field.name);
                let d = self.sink.start(errors::UNKNOWN_FIELD, field.span, message).with_label("unknown member");
                self.sink.push(match &ty {
                    Type::Array(..) if field.name == "length" => d.with_help("write `.length()`"),
                    Type::Array(..) => d.with_help("index it first, as in `[0]`"),
                    _ => d,
                });
                Type::Error
            }
        }
    }

    fn swizzle(&mut self, ty: &Type, scalar: ScalarType, size: u8, field: &Ident) -> Type {
        const SETS: [&str; 3] = ["xyzw", "rgba", "stpq"];
        let mut problem = None;
        let set = SETS.iter().find(|s| field.name.chars().next().is_some_and(|c| s.contains(c)));
        match set {
            None => problem = Some(format!("{} `{ty}` has no member `{}`", article(ty), field.name)),
            Some(set) => {
                for c in field.name.chars() {
                    match set.find(c) {
                        Some(i) if i < usize::from(size) => {}
                        Some(_) => problem = Some(format!("{} `{ty}` has no component `{c}`", article(ty))),
                        None if SETS.iter().any(|s| s.contains(c)) => {
                            problem = Some(format!("`.{}` mixes `{set}` with other names of components", field.name));
                        }
                        None => problem = Some(format!("{} `{ty}` has no member `{}`", article(ty), field.name)),
                    }
                    if problem.is_some() {
                        break;
                    }
                }
                if problem.is_none() && field.name.len() > 4 {
                    problem = Some(format!("`.{}` takes more than four components", field.name));
                }
            }
        }
        match (problem, u8::try_from(field.name.len())) {
            (None, Ok(n)) => Type::vector(scalar, n),
            (problem, _) => {
                self.sink.error(errors::SWIZZLE, field.span, problem.unwrap_or_default(), "not a component of it");
                Type::Error
            }
        }
    }

    fn method(&mut self, base: ExprId, method: &Ident, args: &[ExprId]) -> (Type, Option<Const>) {
        let ty = self.type_of(base).clone();
        if method.name != "length" || !args.is_empty() {
            let message = format!("`.{}()` is no method; there is only `.length()`", method.name);
            self.sink.error(errors::UNKNOWN_FIELD, method.span, message, "unknown method");
            return (Type::Error, None);
        }
        match &ty {
            Type::Array(..) | Type::Vector(..) | Type::Matrix(..) | Type::Error => {}
            Type::Void | Type::Scalar(_) | Type::Opaque(_) | Type::Struct(_) => {
                let message = format!("{} `{ty}` has no `.length()`", article(&ty));
                self.sink.error(
                    errors::UNKNOWN_FIELD,
                    method.span,
                    message,
                    "only arrays, vectors and matrices have it",
                );
            }
        }
        let value = ty.index_count().and_then(|n| i32::try_from(n).ok()).map(Const::Int);
        (Type::INT, value)
    }

    fn binary(&mut self, op: BinaryOp, op_span: Span, left: ExprId, right: ExprId, whole: Span) -> Type {
        let (l, r) = (self.type_of(left).clone(), self.type_of(right).clone());
        match operator::binary(op, &l, &r, self.conversions) {
            Ok(ty) => ty,
            Err(misfit) => {
                self.operand_error(op, misfit, &l, &r, op_span, whole, (left, right));
                Type::Error
            }
        }
    }

    #[expect(clippy::too_many_arguments, reason = "all are parts of one operation, used once")]
    fn operand_error(
        &mut self,
        op: BinaryOp,
        misfit: Misfit,
        l: &Type,
        r: &Type,
        op_span: Span,
        whole: Span,
        operands: (ExprId, ExprId),
    ) {
        let text = op.text();
        let message = format!("`{text}` cannot combine {} `{l}` and {} `{r}`", article(l), article(r));
        let label = format!("`{l}` {text} `{r}`");
        let start = |code, message: String| self.sink.start(code, op_span, message).with_label(label.clone());
        let diagnostic = match misfit {
            Misfit::Operands => start(errors::OPERAND_TYPE, message),
            Misfit::Logic => start(errors::OPERAND_TYPE, message).with_help(format!("`{text}` takes two `bool`")),
            Misfit::FloatRemainder => {
                let d = start(
                    errors::FLOAT_REMAINDER,
                    format!("`%` takes integers, not {} `{l}` and {} `{r}`", article(l), article(r)),
                );
                let (a, b) = (self.arena.get(operands.0), self.arena.get(operands.1));
                // `a %= b` has no one expression to be put in its place.
                if a.from_macro || b.from_macro || op_span.len() > 1 {
                    d.with_help("use `mod(a, b)`")
                } else {
                    let edits = vec![
                        Edit::insert(whole.start, "mod("),
                        Edit::replace(Span::new(a.span.end, b.span.start), ", "),
                        Edit::insert(whole.end, ")"),
                    ];
                    d.with_fix("Use `mod`", Safety::Safe, edits)
                }
            }
            Misfit::MatrixSize => {
                let size = |t: &Type| match t {
                    Type::Matrix(_, c, r) => format!("{c} columns and {r} rows"),
                    other => format!("{} components", other.components().unwrap_or(0)),
                };
                start(errors::MATRIX_SIZE, format!("{} `{l}` cannot be multiplied by {} `{r}`", article(l), article(r)))
                    .with_why(format!("the left side has {}, the right side {}", size(l), size(r)))
            }
            Misfit::VectorRelation => {
                let name = match op {
                    BinaryOp::Less => "lessThan",
                    BinaryOp::Greater => "greaterThan",
                    BinaryOp::LessEqual => "lessThanEqual",
                    _ => "greaterThanEqual",
                };
                start(
                    errors::OPERAND_TYPE,
                    format!("`{text}` compares scalars, not {} `{l}` and {} `{r}`", article(l), article(r)),
                )
                .with_help(format!("`{name}(a, b)` compares component by component"))
            }
        };
        self.sink.push(diagnostic);
    }

    fn assign(&mut self, op: Option<BinaryOp>, op_span: Span, target: ExprId, value: ExprId, whole: Span) -> Type {
        let target_ty = self.type_of(target).clone();
        if !self.assignable(target) {
            return target_ty;
        }
        let value_ty = match op {
            None => self.type_of(value).clone(),
            Some(op) => self.binary(op, op_span, target, value, whole),
        };
        if !self.conversions.allow(&value_ty, &target_ty) {
            let span = self.arena.get(value).span;
            let place = match &self.arena.get(target).kind {
                ExprKind::Name(name) => format!("`{name}`, which is {} `{target_ty}`", article(&target_ty)),
                _ => format!("{} `{target_ty}`", article(&target_ty)),
            };
            let message = format!("{} `{value_ty}` cannot be assigned to {place}", article(&value_ty));
            self.sink.error(errors::ASSIGN_TYPE, span, message, format!("this is {} `{value_ty}`", article(&value_ty)));
        }
        target_ty
    }

    /// True when an expression names a place. Read-only variables count: writing them is told by
    /// a lint rule.
    pub(super) fn assignable(&mut self, target: ExprId) -> bool {
        let mut at = target;
        loop {
            let expr = self.arena.get(at);
            at = match &expr.kind {
                ExprKind::Name(_) | ExprKind::Error => return true,
                ExprKind::Paren(inner) => *inner,
                ExprKind::Index { base, index: _ } => *base,
                ExprKind::Field { base, field } => {
                    if self.type_of(*base).scalar().is_some() && repeats(&field.name) {
                        let message = format!("`.{}` names a component twice and cannot be written", field.name);
                        self.sink.error(errors::SWIZZLE, field.span, message, "written here");
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
                        "only a variable or a part of one can be written",
                        "not a variable",
                    );
                    return false;
                }
            };
        }
    }

    fn ternary(&mut self, condition: ExprId, yes: ExprId, no: ExprId) -> (Type, Option<Const>) {
        self.require_bool(condition, "the condition before `?`");
        let (a, b) = (self.type_of(yes).clone(), self.type_of(no).clone());
        let ty = if a.is_error() || self.conversions.allow(&a, &b) {
            b
        } else if self.conversions.allow(&b, &a) {
            a
        } else {
            let message = format!("the two sides of `:` differ: {} `{a}` and {} `{b}`", article(&a), article(&b));
            let span = self.arena.get(no).span;
            self.sink.error(errors::OPERAND_TYPE, span, message, format!("this is {} `{b}`", article(&b)));
            Type::Error
        };
        let value = match self.value_of(condition) {
            Some(Const::Bool(c)) => self.value_of(if c { yes } else { no }).and_then(|v| fold::convert(v, &ty)),
            _ => None,
        };
        (ty, value)
    }

    /// Tells when an expression is no `bool`.
    pub(super) fn require_bool(&mut self, id: ExprId, what: &str) {
        let ty = self.type_of(id).clone();
        if !ty.is_error() && ty != Type::BOOL {
            let message = format!("{what} must be a `bool`, not {} `{ty}`", article(&ty));
            self.sink.error(
                errors::CONDITION_TYPE,
                self.arena.get(id).span,
                message,
                format!("this is {} `{ty}`", article(&ty)),
            );
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
            None if self.maybe_constant(id) => {}
            None => {
                let d = self.sink.start(errors::CONSTANT, span, "the size of an array must be constant");
                let d = d.with_label("not known when the shader is compiled");
                self.sink.push(d.with_help("declare it as `const int`"));
            }
        }
        ArraySize::Unknown
    }

    /// True when every variable below is constant, so that only our folding may be too weak.
    fn maybe_constant(&self, id: ExprId) -> bool {
        let mut todo = vec![id];
        while let Some(id) = todo.pop() {
            if let Some(symbol) = self.out.names[id.index()] {
                let symbol = &self.out.symbols[symbol.index()];
                let constant = match symbol.kind {
                    super::SymbolKind::Builtin => {
                        symbol.name.starts_with("gl_Max") || symbol.name.starts_with("gl_Min")
                    }
                    super::SymbolKind::Global(storage) => storage == super::super::interface::Storage::Const,
                    super::SymbolKind::Local => symbol.read_only,
                    super::SymbolKind::BlockMember(_)
                    | super::SymbolKind::BlockInstance(_)
                    | super::SymbolKind::Param(_) => false,
                };
                if !constant {
                    return false;
                }
            }
            todo.extend(self.arena.get(id).children());
        }
        true
    }
}

fn repeats(name: &str) -> bool {
    name.char_indices().any(|(i, c)| name[i + c.len_utf8()..].contains(c))
}

/// Adds a suggestion.
pub(super) fn with_near(diagnostic: Diagnostic, near: Option<String>) -> Diagnostic {
    match near {
        Some(near) => diagnostic.with_help(format!("did you mean `{near}`?")),
        None => diagnostic,
    }
}
