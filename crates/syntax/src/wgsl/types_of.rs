//! Types of expressions, and values of constant ones (WGSL, sections 6.1 and 8).

use super::super::BuiltinFunction as F;
use super::super::ast::{BinaryOp, Callee, ExprId, ExprKind, Ident, Literal, UnaryOp};
use super::super::fold::{self, Const};
use super::super::symbols::{BuiltinCall, CallTarget, Direction};
use super::super::types::{ArraySize, ScalarType, Type};
use super::builtin;
use super::check::{Checker, Entry};
use super::types;
use std::sync::Arc;

/// Expressions and declarations inside of one another that are looked at: what goes deeper has no type.
pub(super) const DEEPEST: u32 = 400;

impl Checker<'_> {
    /// The type of an expression, with all below it.
    pub(super) fn expression(&mut self, id: ExprId) -> Type {
        if self.depth >= DEEPEST {
            return Type::Error;
        }
        self.depth += 1;
        let ty = self.expression_here(id);
        self.depth -= 1;
        ty
    }

    fn expression_here(&mut self, id: ExprId) -> Type {
        let kind = self.arena.get(id).kind.clone();
        let ty = match kind {
            ExprKind::Literal(literal) => self.literal(id, literal),
            ExprKind::Name(name) => self.name(id, &name),
            ExprKind::Paren(inner) => {
                let ty = self.expression(inner);
                self.out.values[id.index()] = self.out.values[inner.index()];
                self.is_abstract[id.index()] = self.is_abstract[inner.index()];
                ty
            }
            ExprKind::Index { base, index } => {
                let of = base;
                let base = self.expression(base);
                self.is_abstract[id.index()] = self.is_abstract[of.index()];
                self.expression(index);
                let value = self.out.values[index.index()].and_then(Const::as_integer);
                if let (Some(value), Some(count)) = (value, base.index_count())
                    && (value < 0 || value >= i64::from(count))
                {
                    self.out.beyond.push((index, value, count));
                }
                base.indexed().unwrap_or(Type::Error)
            }
            ExprKind::Field { base, field } => {
                let of = base;
                let base = self.expression(base);
                self.is_abstract[id.index()] = self.is_abstract[of.index()];
                field_of(&base, &field)
            }
            ExprKind::Call { callee, args } => self.call(id, &callee, &args),
            ExprKind::Unary { op, op_span: _, operand } => {
                let ty = self.expression(operand);
                self.out.values[id.index()] = self.out.values[operand.index()].and_then(|v| fold::unary(op, v));
                self.is_abstract[id.index()] = self.is_abstract[operand.index()];
                if op == UnaryOp::Not && ty.is_error() { Type::Error } else { ty }
            }
            ExprKind::Postfix { increment: _, op_span: _, operand } => self.expression(operand),
            ExprKind::Binary { op, op_span, left, right } => {
                let ty = self.binary(id, op, left, right);
                self.operands_fit(op, op_span, left, right);
                ty
            }
            ExprKind::Assign { op, op_span, target, value } => {
                let ty = self.expression(target);
                self.place_fits(target);
                self.expression(value);
                let shifts = matches!(op, Some(BinaryOp::Shl | BinaryOp::Shr));
                if let (Some(scalar), false) = (ty.scalar(), shifts) {
                    self.adopt(value, scalar);
                }
                match op {
                    None => self.value_fits(&ty, value),
                    Some(op) => self.operands_fit(op, op_span, target, value),
                }
                ty
            }
            ExprKind::Comma { left, right } => {
                self.expression(left);
                self.expression(right)
            }
            ExprKind::Ternary { .. } | ExprKind::Method { .. } | ExprKind::List(_) | ExprKind::Error => Type::Error,
        };
        self.out.types[id.index()] = ty.clone();
        ty
    }

    fn literal(&mut self, id: ExprId, literal: Literal) -> Type {
        let (ty, value) = match literal {
            Literal::Bool(v) => (Type::BOOL, Const::Bool(v)),
            Literal::Int(v) => (Type::INT, Const::Int(v)),
            Literal::Uint(v) => (Type::UINT, Const::Uint(v)),
            Literal::Float(v) | Literal::Double(v) | Literal::Half(v) => (Type::FLOAT, Const::Float(fold::round(v))),
            // The lexer of WGSL makes none.
            Literal::Sized(..) => return Type::Error,
        };
        self.out.values[id.index()] = Some(value);
        let span = self.arena.get(id).span;
        // The digits of a number tell whether it is abstract: what has no suffix.
        self.is_abstract[id.index()] = !matches!(literal, Literal::Bool(_)) && !self.suffixed.contains(&span.start);
        ty
    }

    fn name(&mut self, id: ExprId, name: &str) -> Type {
        match self.lookup(name) {
            Some(Entry::Variable(symbol)) => {
                self.out.names[id.index()] = Some(symbol);
                let info = &self.out.symbols[symbol.index()];
                self.out.values[id.index()] = info.value;
                self.is_abstract[id.index()] = self.abstract_symbols.contains(&symbol);
                info.ty.clone()
            }
            Some(Entry::Hidden(ty)) => ty,
            Some(Entry::Type(_) | Entry::Function(_)) => Type::Error,
            None => {
                self.out.unknown = true;
                Type::Error
            }
        }
    }

    /// Gives an abstract number the component type that its place asks for.
    pub(super) fn adopt(&mut self, id: ExprId, scalar: ScalarType) {
        let at = id.index();
        let from = self.out.types[at].scalar();
        let may = match (from, scalar) {
            (Some(ScalarType::Int), _) => scalar != ScalarType::Bool,
            (Some(from), _) => from == scalar,
            (None, _) => false,
        };
        if !self.is_abstract[at] || !may {
            return;
        }
        self.is_abstract[at] = false;
        let ty = self.out.types[at].with_scalar(scalar);
        self.out.values[at] = self.out.values[at].and_then(|v| fold::convert(v, &ty));
        self.out.types[at] = ty.clone();
        match self.arena.get(id).kind.clone() {
            ExprKind::Paren(inner) => self.adopt(inner, scalar),
            ExprKind::Unary { operand, .. } => self.adopt(operand, scalar),
            // A quotient of integers is cut before it becomes another number.
            ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul, left, right, .. } => {
                self.adopt(left, scalar);
                self.adopt(right, scalar);
            }
            ExprKind::Call { args, .. } => {
                if matches!(self.out.calls[at], Some(CallTarget::Constructor(_))) {
                    self.out.calls[at] = Some(CallTarget::Constructor(ty));
                }
                args.iter().for_each(|a| self.adopt(*a, scalar));
            }
            ExprKind::Ternary { condition: _, yes, no } => {
                self.adopt(yes, scalar);
                self.adopt(no, scalar);
            }
            ExprKind::Literal(Literal::Int(v)) => {
                let literal = match scalar {
                    scalar if scalar.is_floating() => Literal::Float(f64::from(v)),
                    scalar if scalar.is_unsigned() => Literal::Uint(v.cast_unsigned()),
                    _ => Literal::Int(v),
                };
                self.arena.replace(id, ExprKind::Literal(literal));
            }
            _ => {}
        }
    }

    /// Brings abstract operands to the component type of the others; gives that type.
    fn unify(&mut self, all: &[ExprId]) -> Option<ScalarType> {
        let of = |c: &Self, id: &ExprId| c.out.types[id.index()].scalar();
        let concrete = all.iter().filter(|id| !self.is_abstract[id.index()]).find_map(|id| of(self, id));
        // Among abstract ones a float decides.
        let wanted = concrete.or_else(|| all.iter().filter_map(|id| of(self, id)).max())?;
        match concrete {
            Some(_) => all.iter().for_each(|id| self.adopt(*id, wanted)),
            None => {
                for id in all {
                    if of(self, id) == Some(wanted) {
                        continue;
                    }
                    self.adopt(*id, wanted);
                    self.is_abstract[id.index()] = true;
                }
            }
        }
        Some(wanted)
    }

    fn binary(&mut self, id: ExprId, op: BinaryOp, left: ExprId, right: ExprId) -> Type {
        self.expression(left);
        self.expression(right);
        let shift = matches!(op, BinaryOp::Shl | BinaryOp::Shr);
        if !shift {
            self.unify(&[left, right]);
        }
        let both = self.is_abstract[left.index()] && (shift || self.is_abstract[right.index()]);
        let (a, b) = (self.out.types[left.index()].clone(), self.out.types[right.index()].clone());
        let values = self.out.values[left.index()].zip(self.out.values[right.index()]);
        self.out.values[id.index()] = values.and_then(|(l, r)| fold::binary(op, l, r));
        match op {
            BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => Type::BOOL,
            BinaryOp::Less
            | BinaryOp::Greater
            | BinaryOp::LessEqual
            | BinaryOp::GreaterEqual
            | BinaryOp::Equal
            | BinaryOp::NotEqual => match (&a, &b) {
                (Type::Vector(_, n), _) | (_, Type::Vector(_, n)) => Type::Vector(ScalarType::Bool, *n),
                (Type::Scalar(_), _) | (_, Type::Scalar(_)) => Type::BOOL,
                _ => Type::Error,
            },
            BinaryOp::Shl | BinaryOp::Shr => {
                self.is_abstract[id.index()] = both;
                a
            }
            _ => {
                self.is_abstract[id.index()] = both;
                arithmetic(op, &a, &b)
            }
        }
    }

    fn call(&mut self, id: ExprId, callee: &Callee, args: &[ExprId]) -> Type {
        args.iter().for_each(|a| drop(self.expression(*a)));
        match callee {
            Callee::Type(_) => {
                let syntax = self.constructed.get(&id).cloned();
                let Some(syntax) = syntax else { return Type::Error };
                let ty = self.constructor(&syntax, args);
                let open = syntax.args.is_empty() && types::is_generator(&syntax.name.name);
                if open && !args.is_empty() && args.iter().all(|a| self.is_abstract[a.index()]) {
                    self.is_abstract[id.index()] = true;
                    self.out.calls[id.index()] = Some(CallTarget::Constructor(ty.clone()));
                    return ty;
                }
                self.construct(id, ty, args)
            }
            Callee::Name(name) => match self.lookup(&name.name) {
                Some(Entry::Type(ty)) => self.construct(id, ty, args),
                Some(Entry::Function(function)) => {
                    let info = self.out.functions[function.index()].clone();
                    for (arg, param) in args.iter().zip(&info.params) {
                        if let Some(scalar) = param.ty.scalar() {
                            self.adopt(*arg, scalar);
                        }
                    }
                    // The ends that the parser gave to `saturate` are not this function's.
                    if args.len() > info.params.len() && name.name == "saturate" {
                        let callee = Callee::Name(name.clone());
                        let args = args[..info.params.len()].to_vec();
                        self.arena.replace(id, ExprKind::Call { callee, args });
                    }
                    self.out.calls[id.index()] = Some(CallTarget::User(function));
                    if self.arguments_fit(function, args) { info.return_type } else { Type::Error }
                }
                Some(Entry::Variable(_) | Entry::Hidden(_)) => Type::Error,
                None => self.builtin(id, name, args),
            },
        }
    }

    /// The type that a call builds; without a component type it is that of the arguments.
    fn constructor(&mut self, syntax: &super::syntax::TypeSyntax, args: &[ExprId]) -> Type {
        if !syntax.args.is_empty() || types::plain(&syntax.name.name).is_some() || self.is_declared(&syntax.name.name) {
            return self.ty(syntax);
        }
        let scalar = self.unify(args);
        if syntax.name.name == "array" {
            let element = args.first().map_or(Type::Error, |a| self.out.types[a.index()].clone());
            let size = u32::try_from(args.len()).map_or(ArraySize::Unknown, ArraySize::Known);
            return Type::Array(Arc::new(element), size);
        }
        scalar.and_then(|s| types::with_component(&syntax.name.name, s)).unwrap_or(Type::Error)
    }

    fn is_declared(&mut self, name: &str) -> bool {
        self.lookup(name).is_some()
    }

    fn construct(&mut self, id: ExprId, ty: Type, args: &[ExprId]) -> Type {
        match &ty {
            Type::Vector(scalar, _) | Type::Matrix(scalar, ..) => {
                args.iter().for_each(|a| self.adopt(*a, *scalar));
            }
            Type::Struct(s) => {
                for (arg, field) in args.iter().zip(&s.fields) {
                    if let Some(scalar) = field.ty.scalar() {
                        self.adopt(*arg, scalar);
                    }
                }
            }
            Type::Array(element, _) => {
                if let Some(scalar) = element.scalar() {
                    args.iter().for_each(|a| self.adopt(*a, scalar));
                }
            }
            Type::Scalar(_) => {
                if let [arg] = args {
                    let value = self.out.values[arg.index()];
                    self.out.values[id.index()] = value.and_then(|v| fold::convert(v, &ty));
                }
            }
            Type::Error | Type::Void | Type::Opaque(_) => return ty,
        }
        self.out.calls[id.index()] = Some(CallTarget::Constructor(ty.clone()));
        ty
    }

    fn builtin(&mut self, id: ExprId, name: &Ident, args: &[ExprId]) -> Type {
        match (name.name.as_str(), args) {
            ("bitcast", _) => {
                let ty = self.constructed.get(&id).and_then(|t| t.args.first()?.ty.clone());
                return ty.map_or(Type::Error, |ty| self.ty(&ty));
            }
            ("select", [no, yes, condition]) => return self.select(id, *no, *yes, *condition),
            ("saturate", [_, _, _]) => {
                self.unify(args);
                let callee = Callee::Name(Ident { name: "clamp".to_owned(), span: name.span });
                self.arena.replace(id, ExprKind::Call { callee, args: args.to_vec() });
                return self.known(id, F::Clamp, args);
            }
            _ => {}
        }
        if let Some(function) = builtin::of_glsl(&name.name) {
            self.numbers(id, function, args);
            if function.name() != name.name {
                let callee = Callee::Name(Ident { name: function.name().to_owned(), span: name.span });
                self.arena.replace(id, ExprKind::Call { callee, args: args.to_vec() });
            }
            return self.known(id, function, args);
        }
        let types: Vec<Type> = args.iter().map(|a| self.out.types[a.index()].clone()).collect();
        if !builtin::is_builtin(&name.name) {
            self.out.unknown = true;
        }
        builtin::own(&name.name, &types)
    }

    /// Gives abstract arguments of a function of numbers their type.
    fn numbers(&mut self, id: ExprId, function: F, args: &[ExprId]) {
        let mixed = [F::Ldexp, F::BitfieldExtract, F::BitfieldInsert, F::Any, F::All];
        let any = [
            F::Abs,
            F::Min,
            F::Max,
            F::Clamp,
            F::Sign,
            F::Dot,
            F::BitCount,
            F::FindLSB,
            F::FindMSB,
            F::BitfieldReverse,
        ];
        if mixed.contains(&function) {
            return;
        }
        let scalar = self.unify(args);
        // Of numbers that are written out, so is the largest.
        let kept = [F::Abs, F::Min, F::Max, F::Clamp, F::Sign, F::Dot];
        self.is_abstract[id.index()] = kept.contains(&function) && args.iter().all(|a| self.is_abstract[a.index()]);
        if !any.contains(&function) && scalar == Some(ScalarType::Int) && !function.name().starts_with("unpack") {
            args.iter().for_each(|a| self.adopt(*a, ScalarType::Float));
        }
    }

    fn known(&mut self, id: ExprId, function: F, args: &[ExprId]) -> Type {
        let types: Vec<Type> = args.iter().map(|a| self.out.types[a.index()].clone()).collect();
        let values: Option<Vec<Const>> = args.iter().map(|a| self.out.values[a.index()]).collect();
        let scalars = types.iter().all(Type::is_scalar);
        self.out.values[id.index()] = values.filter(|_| scalars).and_then(|v| fold::call(function, &v));
        let directions = vec![Direction::In; args.len()];
        self.out.calls[id.index()] = Some(CallTarget::Builtin(BuiltinCall { function, directions }));
        if types.iter().any(Type::is_error) && !matches!(function, F::Any | F::All | F::Length | F::Distance) {
            return Type::Error;
        }
        builtin::number(function, &types)
    }

    /// `select(no, yes, condition)` is `condition ? yes : no` where the condition is one value.
    fn select(&mut self, id: ExprId, no: ExprId, yes: ExprId, condition: ExprId) -> Type {
        self.unify(&[no, yes]);
        let both = [no, yes].map(|a| self.is_abstract[a.index()]);
        self.is_abstract[id.index()] = both == [true, true];
        let ty = match &self.out.types[no.index()] {
            Type::Error => self.out.types[yes.index()].clone(),
            ty => ty.clone(),
        };
        if self.out.types[condition.index()] == Type::BOOL {
            self.arena.replace(id, ExprKind::Ternary { condition, yes, no });
        }
        ty
    }
}

/// The type of `base.field`.
fn field_of(base: &Type, field: &Ident) -> Type {
    match base {
        Type::Vector(scalar, n) => {
            let letters = if field.name.contains(['r', 'g', 'b', 'a']) { "rgba" } else { "xyzw" };
            let inside = field.name.chars().all(|c| letters.find(c).is_some_and(|i| i < usize::from(*n)));
            match u8::try_from(field.name.len()) {
                Ok(count @ 1..=4) if inside => Type::vector(*scalar, count),
                _ => Type::Error,
            }
        }
        Type::Struct(s) => s.fields.iter().find(|f| f.name == field.name).map_or(Type::Error, |f| f.ty.clone()),
        _ => Type::Error,
    }
}

pub(super) fn arithmetic(op: BinaryOp, a: &Type, b: &Type) -> Type {
    if a.scalar() != b.scalar() {
        return Type::Error;
    }
    match (a, b) {
        (Type::Matrix(s, c, r), Type::Vector(_, n)) if op == BinaryOp::Mul && n == c => Type::vector(*s, *r),
        (Type::Vector(s, n), Type::Matrix(_, c, r)) if op == BinaryOp::Mul && n == r => Type::vector(*s, *c),
        (Type::Matrix(s, k, r), Type::Matrix(_, c, n)) if op == BinaryOp::Mul && n == k => Type::Matrix(*s, *c, *r),
        (Type::Vector(..), Type::Matrix(..)) | (Type::Matrix(..), Type::Vector(..)) => Type::Error,
        (Type::Scalar(_), _) => b.clone(),
        (_, Type::Scalar(_)) => a.clone(),
        _ if a == b => a.clone(),
        _ => Type::Error,
    }
}
