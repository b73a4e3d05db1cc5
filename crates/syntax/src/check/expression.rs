//! Types and values of expressions.

use super::super::ast::{BinaryOp, ExprId, ExprKind, Ident, Literal, UnaryOp};
use super::super::builtin;
use super::super::errors;
use super::super::fold::{self, Const};
use super::super::language::Feature;
use super::super::names::nearest;
use super::super::swizzle::SETS;
use super::super::types::{ArraySize, ScalarType, Type};
use super::operator::{self, Misfit};
use super::{Checker, Entry};
use base::diagnostic::{Diagnostic, Message, message};
use base::text::Span;

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
            self.constant[id.index()] = self.constness(id);
        }
    }

    fn one(&mut self, id: ExprId) -> (Type, Option<Const>) {
        let expr = self.arena.get(id);
        match &expr.kind {
            ExprKind::Literal(literal) => {
                self.literal(*literal, expr.span, expr.from_macro);
                let value = match *literal {
                    Literal::Bool(v) => Const::Bool(v),
                    Literal::Int(v) => Const::Int(v),
                    Literal::Uint(v) => Const::Uint(v),
                    Literal::Float(v) => Const::Float(fold::round(v)),
                    Literal::Double(v) => Const::Double(v),
                    Literal::Half(_) => return (Type::Scalar(ScalarType::Half), None),
                    Literal::Sized(_, ty) => return (Type::Scalar(ty), None),
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
                match *op {
                    UnaryOp::Increment | UnaryOp::Decrement if !ty.is_error() => {
                        self.assignable(*operand);
                    }
                    UnaryOp::Complement => {
                        self.need(Feature::BitOperators, *op_span);
                    }
                    _ => {}
                }
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
                if numeric && !ty.is_error() {
                    self.assignable(*operand);
                }
                if !numeric {
                    let op = if *increment { "++" } else { "--" };
                    let message = format!("`{op}` does not take {} `{ty}`", article(&ty));
                    self.sink.error(errors::OPERAND_TYPE, *op_span, message, "takes numbers");
                }
                (if numeric { ty } else { Type::Error }, None)
            }
            ExprKind::Binary { op, op_span, left, right } => {
                let ty = self.binary(*op, *op_span, *left, *right);
                let value = match (self.value_of(*left), self.value_of(*right), ty.is_error()) {
                    (Some(a), Some(b), false) => fold::binary(*op, a, b),
                    _ => None,
                };
                (ty, value)
            }
            ExprKind::Assign { op, op_span, target, value } => (self.assign(*op, *op_span, *target, *value), None),
            ExprKind::Ternary { condition, yes, no } => self.ternary(*condition, *yes, *no),
            ExprKind::Comma { left: _, right } => (self.type_of(*right).clone(), None),
            // The declaration gives a list its type.
            ExprKind::List(_) | ExprKind::Error => (Type::Error, None),
        }
    }

    fn name(&mut self, id: ExprId, name: &str, span: Span) -> (Type, Option<Const>) {
        if let Some(symbol) = self.variable(name) {
            self.out.names[id.index()] = Some(symbol);
            if self.out.symbols[symbol.index()].kind == super::SymbolKind::Builtin
                && let Some(why) = builtin::variable_absent(name, self.stage, &self.language)
                && self.lookup(name).is_none()
            {
                self.absent(name, span, why);
            }
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
        let Some(element) = base_ty.indexed() else {
            let message = format!("{} `{base_ty}` has no elements to index", article(&base_ty));
            self.sink.error(errors::INDEX, self.arena.get(base).span, message, "indexed here");
            return Type::Error;
        };
        if integer {
            self.index_rules(base, &base_ty, index);
        }
        element
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
            Type::Scalar(scalar) => {
                let result = self.swizzle(&ty, *scalar, 1, field);
                if !result.is_error() && !self.language.has(Feature::ScalarSwizzles) {
                    self.scalar_swizzle(base, &ty, &result, field);
                }
                result
            }
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
        let mut problem = None;
        let (a_ty, name) = (format!("{} `{ty}`", article(ty)), &field.name);
        let no_member = || message!("{a_ty} has no member `{name}`", "`{ty}` に `{name}` というメンバはありません");
        let set = SETS.iter().find(|s| field.name.chars().next().is_some_and(|c| s.contains(c)));
        match set {
            None => problem = Some(no_member()),
            Some(set) => {
                for c in field.name.chars() {
                    match set.find(c) {
                        Some(i) if i < usize::from(size) => {}
                        Some(_) => {
                            problem =
                                Some(message!("{a_ty} has no component `{c}`", "`{ty}` に成分 `{c}` はありません"));
                        }
                        None if SETS.iter().any(|s| s.contains(c)) => {
                            problem = Some(message!(
                                "`.{name}` mixes `{set}` with other names of components",
                                "`.{name}` は `{set}` とほかの組の成分名を混ぜています"
                            ));
                        }
                        None => problem = Some(no_member()),
                    }
                    if problem.is_some() {
                        break;
                    }
                }
                if problem.is_none() && field.name.len() > 4 {
                    problem = Some(message!(
                        "`.{name}` takes more than four components",
                        "`.{name}` は五つ以上の成分を取り出しています"
                    ));
                }
            }
        }
        match (problem, u8::try_from(field.name.len())) {
            (None, Ok(n)) => Type::vector(scalar, n),
            (problem, _) => {
                self.sink.error(
                    errors::SWIZZLE,
                    field.span,
                    problem.unwrap_or_default(),
                    message!("not a component of it", "この型の成分ではありません"),
                );
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
            Type::Array(_, size) => {
                self.need(Feature::ArrayLength, method.span);
                if *size == ArraySize::Unsized && !self.runtime_sized(base) {
                    self.sink.error(
                        errors::ARRAY,
                        method.span,
                        message!("this array has no size yet", "この配列の大きさは未定です"),
                        message!("its length is not known", "長さが決まっていません"),
                    );
                }
            }
            Type::Vector(..) | Type::Matrix(..) => {
                self.need(Feature::VectorLength, method.span);
            }
            Type::Error => {}
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

    fn binary(&mut self, op: BinaryOp, op_span: Span, left: ExprId, right: ExprId) -> Type {
        let (l, r) = (self.type_of(left).clone(), self.type_of(right).clone());
        use BinaryOp::{BitAnd, BitOr, BitXor, Equal, NotEqual, Rem, Shl, Shr};
        match operator::binary(op, &l, &r, self.conversions) {
            Ok(ty) => {
                if matches!(op, Rem | Shl | Shr | BitAnd | BitXor | BitOr) {
                    self.need(Feature::BitOperators, op_span);
                }
                if matches!(op, Equal | NotEqual) && (has_array(&l) || has_array(&r)) {
                    self.need(Feature::ArrayValues, op_span);
                    let open = |t: &Type| matches!(t, Type::Array(_, ArraySize::Unsized));
                    if open(&l) || open(&r) {
                        let message =
                            message!("an array without a size cannot be compared", "大きさのない配列は比較できません");
                        self.sink.error(errors::ARRAY, op_span, message, message!("compared here", "ここで比較"));
                    }
                }
                if !matches!(op, Shl | Shr) {
                    self.implicit(left, &l, &r.scalar().map_or(Type::Error, |s| l.with_scalar(s)));
                    self.implicit(right, &r, &l.scalar().map_or(Type::Error, |s| r.with_scalar(s)));
                }
                ty
            }
            Err(misfit) => {
                self.operand_error(op, misfit, &l, &r, op_span);
                Type::Error
            }
        }
    }

    fn operand_error(&mut self, op: BinaryOp, misfit: Misfit, l: &Type, r: &Type, op_span: Span) {
        let text = op.text();
        let message = format!("`{text}` cannot combine {} `{l}` and {} `{r}`", article(l), article(r));
        let label = format!("`{l}` {text} `{r}`");
        let start = |code, message: String| self.sink.start(code, op_span, message).with_label(label.clone());
        let diagnostic = match misfit {
            Misfit::Operands => start(errors::OPERAND_TYPE, message),
            Misfit::Logic => start(errors::OPERAND_TYPE, message).with_help(format!("`{text}` takes two `bool`")),
            Misfit::FloatRemainder => self
                .sink
                .start(
                    errors::FLOAT_REMAINDER,
                    op_span,
                    message!(
                        "`{text}` takes integers, not `{l}` and `{r}`",
                        "`{text}` は整数用です。`{l}` と `{r}` には使えません"
                    ),
                )
                .with_label(message!("`{l}` {text} `{r}`", "`{l}` {text} `{r}`"))
                .with_help(message!("use `mod(a, b)`", "`mod(a, b)` を使ってください")),
            Misfit::MatrixSize => {
                let en = |t: &Type| match t {
                    Type::Matrix(_, c, r) => format!("{c} columns and {r} rows"),
                    other => format!("{} components", other.components().unwrap_or(0)),
                };
                let ja = |t: &Type| match t {
                    Type::Matrix(_, c, r) => format!("{c} 列 {r} 行"),
                    other => format!("{} 成分", other.components().unwrap_or(0)),
                };
                self.sink
                    .start(
                        errors::MATRIX_SIZE,
                        op_span,
                        message!("`{l}` cannot be multiplied by `{r}`", "`{l}` と `{r}` の積は定義されません"),
                    )
                    .with_label(message!("`{l}` {text} `{r}`", "`{l}` {text} `{r}`"))
                    .with_why(Message::new(
                        format!("the left side has {}, the right side {}", en(l), en(r)),
                        format!("左辺は {}、右辺は {} です", ja(l), ja(r)),
                    ))
                    .with_help(message!("make the sizes fit", "大きさを合わせてください"))
            }
            Misfit::VectorRelation => {
                let name = match op {
                    BinaryOp::Less => "lessThan",
                    BinaryOp::Greater => "greaterThan",
                    BinaryOp::LessEqual => "lessThanEqual",
                    _ => "greaterThanEqual",
                };
                self.sink
                    .start(
                        errors::VECTOR_RELATION,
                        op_span,
                        message!(
                            "`{text}` compares scalars, not `{l}` and `{r}`",
                            "`{text}` はスカラの比較です。`{l}` と `{r}` には使えません"
                        ),
                    )
                    .with_label(message!("`{l}` {text} `{r}`", "`{l}` {text} `{r}`"))
                    .with_help(message!(
                        "`{name}(a, b)` compares component by component",
                        "`{name}(a, b)` は成分ごとに比べます"
                    ))
            }
        };
        self.sink.push(diagnostic);
    }

    fn assign(&mut self, op: Option<BinaryOp>, op_span: Span, target: ExprId, value: ExprId) -> Type {
        let target_ty = self.type_of(target).clone();
        if !self.assignable(target) {
            return target_ty;
        }
        let value_ty = match op {
            None => self.type_of(value).clone(),
            Some(op) => self.binary(op, op_span, target, value),
        };
        if !self.conversions.allow(&value_ty, &target_ty) {
            let span = self.arena.get(value).span;
            let message = match &self.arena.get(target).kind {
                ExprKind::Name(name) => message!(
                    "`{value_ty}` cannot be assigned to `{name}`, which is `{target_ty}`",
                    "`{value_ty}` は `{target_ty}` 型の `{name}` に代入できません"
                ),
                _ => message!(
                    "`{value_ty}` cannot be assigned to `{target_ty}`",
                    "`{value_ty}` は `{target_ty}` に代入できません"
                ),
            };
            self.misfit(&value_ty, &target_ty, span, message);
        } else if op.is_none() {
            self.implicit(value, &value_ty, &target_ty);
            // A structure is copied with its arrays in the first version as well, but not in ES.
            if if self.language.es() { has_array(&target_ty) } else { matches!(target_ty, Type::Array(..)) } {
                self.need(Feature::ArrayValues, op_span);
            }
            // Built-in arrays have a size that the implementation knows.
            let builtin = match &self.arena.get(target).kind {
                ExprKind::Name(name) => name.starts_with("gl_"),
                ExprKind::Field { field, .. } => field.name.starts_with("gl_"),
                _ => false,
            };
            if let (Type::Array(_, ArraySize::Unsized), false) = (&target_ty, builtin) {
                let message = message!(
                    "an array without a size cannot be written as a whole",
                    "大きさのない配列の全体には書き込めません"
                );
                self.sink.error(
                    errors::ARRAY,
                    self.arena.get(target).span,
                    message,
                    message!("written here", "ここで書き込み"),
                );
            }
        }
        target_ty
    }

    /// Tells a value of a wrong type: `T003` when the sizes of vectors or scalars differ.
    pub(super) fn misfit(&mut self, given: &Type, wanted: &Type, span: Span, message: Message) {
        let plain = |t: &Type| matches!(t, Type::Scalar(_) | Type::Vector(..));
        let sizes = plain(given)
            && plain(wanted)
            && given.components() != wanted.components()
            && self
                .conversions
                .scalar(given.scalar().unwrap_or(ScalarType::Bool), wanted.scalar().unwrap_or(ScalarType::Bool));
        let label = message!("this is `{given}`", "これは `{given}`");
        if !sizes {
            return self.sink.error(errors::ASSIGN_TYPE, span, message, label);
        }
        let (from, to) = (given.components().unwrap_or(0), wanted.components().unwrap_or(0));
        let word = if from == 1 { "component" } else { "components" };
        let d = self
            .sink
            .start(errors::ASSIGN_SIZE, span, message)
            .with_label(label)
            .with_why(message!(
                "it has {from} {word} where {to} are needed, and none is added or dropped by itself",
                "成分数が {from} と {to} で、自動では補われも捨てられもしません"
            ))
            .with_help(message!("construct or swizzle a `{wanted}`", "`{wanted}` を組み立てるか取り出してください"));
        self.sink.push(d);
    }

    fn ternary(&mut self, condition: ExprId, yes: ExprId, no: ExprId) -> (Type, Option<Const>) {
        self.require_bool(condition, "the condition before `?`");
        let (a, b) = (self.type_of(yes).clone(), self.type_of(no).clone());
        let ty = if a.is_error() || self.conversions.allow(&a, &b) {
            b.clone()
        } else if self.conversions.allow(&b, &a) {
            a.clone()
        } else {
            let message = format!("the two sides of `:` differ: {} `{a}` and {} `{b}`", article(&a), article(&b));
            let span = self.arena.get(no).span;
            self.sink.error(errors::OPERAND_TYPE, span, message, format!("this is {} `{b}`", article(&b)));
            Type::Error
        };
        if !ty.is_error() {
            self.implicit(yes, &a, &ty);
            self.implicit(no, &b, &ty);
            let span = self.arena.get(yes).span;
            if has_array(&ty) {
                self.need(Feature::ArrayValues, span);
            }
            if ty.contains_opaque() {
                let message = message!("`{ty}` cannot be chosen by `?`", "`{ty}` は `?` で選べません");
                self.sink.error(errors::OPERAND_TYPE, span, message, message!("this is `{ty}`", "これは `{ty}`"));
            }
        }
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
}

/// True for an array, and for a structure with one inside.
pub(super) fn has_array(ty: &Type) -> bool {
    match ty {
        Type::Array(..) => true,
        Type::Struct(s) => s.fields.iter().any(|f| has_array(&f.ty)),
        Type::Error | Type::Void | Type::Scalar(_) | Type::Vector(..) | Type::Matrix(..) | Type::Opaque(_) => false,
    }
}

pub(super) fn with_near(diagnostic: Diagnostic, near: Option<String>) -> Diagnostic {
    match near {
        Some(near) => diagnostic.with_help(format!("did you mean `{near}`?")),
        None => diagnostic,
    }
}
