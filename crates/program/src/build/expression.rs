//! Expressions.

use naga::{BinaryOperator, Expression, Literal as Number, UnaryOperator};

use super::function::{Fun, Val};
use super::{Expr, Result};
use crate::UNSUPPORTED;
use base::diagnostic::{Diagnostic, Severity};
use base::text::Span;
use syntax::ast::{BinaryOp, ExprId, ExprKind, Literal, UnaryOp};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, SymbolKind};
use syntax::types::{ArraySize, ScalarType, Type};
use syntax::{Const, Fit};

impl Fun<'_, '_> {
    /// The value of an expression.
    pub(super) fn expression(&mut self, id: ExprId) -> Result<Val> {
        match self.statement_expression(id)? {
            Some(value) => Ok(value),
            None => Err(self.build.unsupported(
                self.shader.expr(id).span,
                "the value of a function that returns none",
                "call it as a statement",
            )),
        }
    }

    /// The value of an expression; none for a call of a function without one.
    pub(super) fn statement_expression(&mut self, id: ExprId) -> Result<Option<Val>> {
        let expr = self.shader.expr(id);
        let before = std::mem::replace(&mut self.at, expr.span);
        let value = self.evaluate(id, expr.span);
        self.at = before;
        value
    }

    fn evaluate(&mut self, id: ExprId, span: Span) -> Result<Option<Val>> {
        let expr = self.shader.expr(id);
        if !matches!(expr.kind, ExprKind::Literal(_))
            && let Some(value @ (Const::Int(_) | Const::Uint(_) | Const::Bool(_))) = self.shader.fold(id)
        {
            return Ok(Some(self.constant(value)));
        }
        if let Some(value) = self.folded(id)? {
            return Ok(Some(value));
        }
        let value = match &expr.kind {
            ExprKind::Literal(literal) => self.literal(*literal, span)?,
            ExprKind::Name(_) | ExprKind::Index { .. } | ExprKind::Field { .. } => self.read(id)?,
            ExprKind::Paren(inner) => return self.statement_expression(*inner),
            ExprKind::Method { base, .. } => self.length(*base)?,
            ExprKind::Call { args, .. } => return self.call(id, args),
            ExprKind::Unary { op: op @ (UnaryOp::Increment | UnaryOp::Decrement), operand, .. } => {
                self.step(*operand, *op == UnaryOp::Increment)?.1
            }
            ExprKind::Unary { op, operand, .. } => {
                let value = self.expression(*operand)?;
                self.unary(*op, value)?
            }
            ExprKind::Postfix { increment, operand, .. } => self.step(*operand, *increment)?.0,
            ExprKind::Binary { op: op @ (BinaryOp::And | BinaryOp::Or), left, right, .. } => {
                self.short_circuit(*op, *left, *right)?
            }
            ExprKind::Binary { op, left, right, .. } => {
                let left = self.expression(*left)?;
                let right = self.expression(*right)?;
                self.binary(*op, left, right)?
            }
            ExprKind::Assign { op, target, value, .. } => self.assign(*op, *target, *value)?,
            ExprKind::Ternary { condition, yes, no } => return self.ternary(*condition, *yes, *no).map(Some),
            ExprKind::Comma { left, right } => {
                self.statement_expression(*left)?;
                return self.statement_expression(*right);
            }
            ExprKind::List(_) => {
                return Err(self.build.unsupported(span, "an initialiser list here", "write a constructor"));
            }
            ExprKind::Error => return Err(self.build.unsupported(span, "text that could not be read", "correct it")),
        };
        Ok(Some(value))
    }

    /// A constant expression of `float` as the numbers nearest to it, so that no translator folds it; none for what is
    /// none, or written out.
    fn folded(&mut self, id: ExprId) -> Result<Option<Val>> {
        let written =
            matches!(self.shader.expr(id).kind, ExprKind::Literal(_) | ExprKind::Name(_) | ExprKind::Paren(_));
        let Some(real) = self.build.reals.get(id).filter(|_| !written) else { return Ok(None) };
        #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is what is wanted")]
        let numbers: Vec<f32> = real.values().iter().map(|&v| v as f32).collect();
        if real.ty().scalar() != Some(ScalarType::Float) || numbers.iter().any(|v| !v.is_finite()) {
            return Ok(None);
        }
        let ty = real.ty().clone();
        let literals: Vec<Expr> = numbers.into_iter().map(|v| self.add(Expression::Literal(Number::F32(v)))).collect();
        match &ty {
            Type::Matrix(scalar, _, rows) => {
                let column = Type::Vector(*scalar, *rows);
                let columns: Result<Vec<Expr>> = literals
                    .chunks(usize::from(*rows))
                    .map(|part| self.compose(&column, part.to_vec()).map(|column| column.e))
                    .collect();
                self.compose(&ty, columns?).map(Some)
            }
            Type::Vector(..) => self.compose(&ty, literals).map(Some),
            _ => Ok(literals.first().map(|&e| Val { e, ty })),
        }
    }

    fn constant(&mut self, value: Const) -> Val {
        let number = match value {
            Const::Bool(v) => Number::Bool(v),
            Const::Int(v) => Number::I32(v),
            Const::Uint(v) => Number::U32(v),
            Const::Float(v) => Number::F32(v),
            Const::Double(v) => Number::F64(v),
        };
        Val { e: self.add(Expression::Literal(number)), ty: value.ty() }
    }

    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is what a literal of `float` means")]
    fn literal(&mut self, literal: Literal, span: Span) -> Result<Val> {
        let (number, ty) = match literal {
            Literal::Bool(v) => (Number::Bool(v), Type::BOOL),
            Literal::Int(v) => (Number::I32(v), Type::INT),
            Literal::Uint(v) => (Number::U32(v), Type::UINT),
            Literal::Float(v) if (v as f32).is_finite() => (Number::F32(v as f32), Type::FLOAT),
            Literal::Double(v) if v.is_finite() => (Number::F64(v), Type::Scalar(ScalarType::Double)),
            Literal::Half(v) if (v as f32).is_finite() => {
                return Ok(Val { e: self.half(v as f32), ty: Type::Scalar(ScalarType::Half) });
            }
            Literal::Sized(bits, ty) => {
                let number = match ty {
                    ScalarType::Int64 => Number::I64(bits.cast_signed()),
                    ScalarType::Uint64 => Number::U64(bits),
                    ScalarType::Int16 => Number::I32(i32::from(bits as i16)),
                    _ => Number::U32(bits as u32),
                };
                (number, Type::Scalar(ty))
            }
            Literal::Float(_) | Literal::Double(_) | Literal::Half(_) => {
                return Err(self.build.unsupported(span, "a number out of range", "write a smaller number"));
            }
        };
        Ok(Val { e: self.add(Expression::Literal(number)), ty })
    }

    /// The value of an initialiser for a variable of type `want`.
    pub(super) fn initial(&mut self, id: ExprId, want: &Type) -> Result<Val> {
        let expr = self.shader.expr(id);
        let ExprKind::List(items) = &expr.kind else {
            let value = self.expression(id)?;
            return self.convert(value, want);
        };
        // GL_EXT_null_initializer.
        if items.is_empty() {
            let ty = self.ty(want)?;
            return Ok(Val { e: self.add(Expression::ZeroValue(ty)), ty: want.clone() });
        }
        let parts: Vec<Type> = match want {
            Type::Struct(s) => s.fields.iter().map(|f| f.ty.clone()).collect(),
            _ => vec![want.indexed().unwrap_or(Type::Error); items.len()],
        };
        let ty = sized_by(want, items.len());
        let mut components = Vec::new();
        for (&item, part) in items.iter().zip(&parts) {
            components.push(self.initial(item, part)?);
        }
        let ty = inner_sizes(ty, &components);
        self.compose(&ty, components.into_iter().map(|v| v.e).collect())
    }

    /// `++` and `--`: the values before and behind.
    fn step(&mut self, operand: ExprId, up: bool) -> Result<(Val, Val)> {
        let place = self.target(operand)?;
        let before = self.load(&place)?;
        let one = self.all(&before.ty, 1.0)?;
        let after = self.binary(if up { BinaryOp::Add } else { BinaryOp::Sub }, before.clone(), one)?;
        self.store(&place, &after)?;
        Ok((before, after))
    }

    fn assign(&mut self, op: Option<BinaryOp>, target: ExprId, value: ExprId) -> Result<Val> {
        let place = self.target(target)?;
        let value = match op {
            None => self.initial(value, &place.ty)?,
            Some(op) => {
                let right = self.expression(value)?;
                let left = self.load(&place)?;
                let result = self.binary(op, left, right)?;
                self.convert(result, &place.ty)?
            }
        };
        self.store(&place, &value)?;
        Ok(value)
    }

    /// `&&` and `||`: the right side is computed only where it counts.
    fn short_circuit(&mut self, op: BinaryOp, left: ExprId, right: ExprId) -> Result<Val> {
        let left = self.expression(left)?;
        let and = op == BinaryOp::And;
        if self.is_simple(right) {
            let right = self.expression(right)?;
            let op = if and { BinaryOperator::LogicalAnd } else { BinaryOperator::LogicalOr };
            let e = self.add(Expression::Binary { op, left: left.e, right: right.e });
            return Ok(Val { e, ty: Type::BOOL });
        }
        let place = self.spill(&left)?;
        let condition =
            if and { left.e } else { self.add(Expression::Unary { op: UnaryOperator::LogicalNot, expr: left.e }) };
        self.branch(
            condition,
            |f| {
                let right = f.expression(right)?;
                f.store(&place, &right)
            },
            |_| Ok(()),
        )?;
        self.load(&place)
    }

    /// `?:` computes one side alone.
    fn ternary(&mut self, condition: ExprId, yes: ExprId, no: ExprId) -> Result<Val> {
        let ty = self.shader.type_of(yes).clone();
        let other = self.shader.type_of(no).clone();
        let ty = match (ty.scalar(), other.scalar()) {
            (Some(a), Some(b)) => ty.with_scalar(a.max(b)),
            _ => ty,
        };
        let condition = self.expression(condition)?.e;
        if ty == Type::Void {
            let call = |id| move |f: &mut Self| f.statement_expression(id).map(|_| ());
            self.branch(condition, call(yes), call(no))?;
            return Err(self.build.unsupported(self.at, "`?:` without a value", "write an `if`"));
        }
        if ty.components().is_some_and(|_| !matches!(ty, Type::Matrix(..))) && self.is_simple(yes) && self.is_simple(no)
        {
            let (accept, reject) = (self.initial(yes, &ty)?.e, self.initial(no, &ty)?.e);
            return Ok(Val { e: self.add(Expression::Select { condition, accept, reject }), ty });
        }
        let place = self.local("sc_choice", &ty)?;
        let store = |id| {
            let (place, ty) = (place.clone(), ty.clone());
            move |f: &mut Self| {
                let value = f.initial(id, &ty)?;
                f.store(&place, &value)
            }
        };
        self.branch(condition, store(yes), store(no))?;
        self.load(&place)
    }

    /// True when nothing happens and nothing can go wrong: computing it where it is not asked for
    /// makes no difference.
    fn is_simple(&self, id: ExprId) -> bool {
        let expr = self.shader.expr(id);
        let own = match &expr.kind {
            ExprKind::Name(_) => !self.is_memory(id),
            ExprKind::Literal(_) | ExprKind::Paren(_) | ExprKind::Field { .. } | ExprKind::Method { .. } => true,
            ExprKind::Index { index, .. } => self.constant_index(*index).is_some(),
            ExprKind::Unary { op, .. } => !matches!(op, UnaryOp::Increment | UnaryOp::Decrement),
            ExprKind::Binary { op, left, .. } => {
                let whole = self.shader.type_of(*left).scalar().is_some_and(ScalarType::is_integer);
                !(whole && matches!(op, BinaryOp::Div | BinaryOp::Rem))
            }
            ExprKind::Call { .. } => matches!(self.shader.callee(id), Some(CallTarget::Constructor(_))),
            ExprKind::Postfix { .. }
            | ExprKind::Assign { .. }
            | ExprKind::Ternary { .. }
            | ExprKind::Comma { .. }
            | ExprKind::List(_)
            | ExprKind::Error => false,
        };
        own && expr.children().iter().all(|&c| self.is_simple(c))
    }

    /// True for what other invocations may write at the same time: a read that the author does not ask for would race.
    fn is_memory(&self, name: ExprId) -> bool {
        let Some(symbol) = self.shader.symbol_of(name) else { return false };
        match self.shader.symbol(symbol).kind {
            SymbolKind::Global(storage) => matches!(storage, Storage::Shared | Storage::Buffer),
            SymbolKind::BlockMember(block) | SymbolKind::BlockInstance(block) => {
                self.shader.interface().blocks.get(block).is_some_and(|b| b.storage == Storage::Buffer)
            }
            SymbolKind::Builtin | SymbolKind::Param(_) | SymbolKind::Local => false,
        }
    }

    /// Refuses a constructor with arguments left over or missing, where the front end only warns.
    fn check_components(&self, id: ExprId, span: Span) -> Result<()> {
        let Some(constructor) = self.shader.constructor(id) else { return Ok(()) };
        let (ty, needs) = (&constructor.ty, constructor.needs);
        let (given, help) = match constructor.fit {
            Fit::Fits | Fit::Unknown => return Ok(()),
            Fit::TooMany { .. } => {
                let total: usize = constructor.given.iter().flatten().sum();
                (format!("{total} are given"), "run `shadercheck lint`, which explains and repairs it (T001)")
            }
            Fit::TooFew { given } => (format!("only {given} are given"), "give the missing components"),
        };
        let message = format!("`{ty}` takes {needs} components, and {given}");
        let reported = Diagnostic::new(UNSUPPORTED, Severity::Error, self.shader.file(), span, message);
        Err(Box::new(reported.with_help(help)))
    }

    /// A call: a constructor, a function of the shader or a built-in one.
    fn call(&mut self, id: ExprId, args: &[ExprId]) -> Result<Option<Val>> {
        let span = self.shader.expr(id).span;
        match self.shader.callee(id) {
            Some(CallTarget::Constructor(ty)) => {
                self.check_components(id, span)?;
                self.constructor(&ty.clone(), args).map(Some)
            }
            Some(CallTarget::User(function)) => self.user_call(*function, args, span),
            Some(CallTarget::Builtin(call)) => self.builtin(id, call.function, args, span),
            None => Err(self.build.unsupported(span, "a call of something that is no function", "declare it")),
        }
    }

    /// `left == right` for values of any type, as one `bool`.
    pub(super) fn equal(&mut self, left: &Val, right: &Val) -> Result<Expr> {
        let op = BinaryOperator::Equal;
        let parts: Vec<Type> = match &left.ty {
            Type::Vector(..) => {
                let all = self.add(Expression::Binary { op, left: left.e, right: right.e });
                let fun = naga::RelationalFunction::All;
                return Ok(self.add(Expression::Relational { fun, argument: all }));
            }
            Type::Matrix(s, columns, rows) => vec![Type::Vector(*s, *rows); usize::from(*columns)],
            Type::Array(element, ArraySize::Known(n)) => vec![element.as_ref().clone(); *n as usize],
            Type::Struct(s) => s.fields.iter().map(|f| f.ty.clone()).collect(),
            _ => return Ok(self.add(Expression::Binary { op, left: left.e, right: right.e })),
        };
        let mut whole: Option<Expr> = None;
        for (k, ty) in parts.into_iter().enumerate() {
            let k = u32::try_from(k).unwrap_or(0);
            let (l, r) = (self.part(left.e, k), self.part(right.e, k));
            let part = self.equal(&Val { e: l, ty: ty.clone() }, &Val { e: r, ty })?;
            whole = Some(match whole {
                None => part,
                Some(whole) => {
                    self.add(Expression::Binary { op: BinaryOperator::LogicalAnd, left: whole, right: part })
                }
            });
        }
        Ok(whole.unwrap_or_else(|| self.add(Expression::Literal(Number::Bool(true)))))
    }
}

/// An array type with the number of its values.
pub(super) fn sized_by(ty: &Type, count: usize) -> Type {
    match ty {
        Type::Array(element, ArraySize::Unsized) => {
            Type::Array(element.clone(), ArraySize::Known(u32::try_from(count).unwrap_or(u32::MAX)))
        }
        _ => ty.clone(),
    }
}

/// An array of arrays takes the inner sizes that are not written from its values.
pub(super) fn inner_sizes(ty: Type, values: &[Val]) -> Type {
    match (&ty, values.first()) {
        (Type::Array(element, size), Some(first)) if matches!(**element, Type::Array(_, ArraySize::Unsized)) => {
            Type::Array(std::sync::Arc::new(first.ty.clone()), *size)
        }
        _ => ty,
    }
}
