//! Values that have another type than their place takes (WGSL, sections 6.1.2, 8 and 9): nothing converts but what is
//! written as a number. Only what is surely known is told: half floats are taken for floats, and a value whose type
//! was not found fits everywhere.

use super::super::ast::{BinaryOp, ExprId, ExprKind};
use super::super::errors;
use super::super::fold::Const;
use super::super::symbols::FunctionId;
use super::super::types::{ScalarType, Type};
use super::check::Checker;
use super::syntax::{ModuleItem, TypeSyntax};
use super::types::spelling;
use base::diagnostic::{Code, Message, message};
use base::text::Span;

/// A value that does not fit.
#[derive(Clone, Debug)]
pub(super) struct Misfit {
    pub code: Code,
    pub place: Span,
    pub what: Message,
    pub label: Message,
}

/// True for a type that is known with all of its parts.
fn is_known(ty: &Type) -> bool {
    matches!(ty, Type::Scalar(_) | Type::Vector(..) | Type::Matrix(..))
}

/// A vector of as many components, or a scalar beside a scalar.
fn same_shape(a: &Type, b: &Type) -> bool {
    match (a, b) {
        (Type::Scalar(_), Type::Scalar(_)) => true,
        (Type::Vector(_, n), Type::Vector(_, m)) => n == m,
        _ => false,
    }
}

/// True where an operator takes these operands, of which abstract numbers have become what the others are. `sure` says
/// whether the type of the right one is its last.
fn takes(op: BinaryOp, a: &Type, b: &Type, sure: bool) -> bool {
    let is = |t: &Type, test: fn(ScalarType) -> bool| t.scalar().is_some_and(test);
    match op {
        BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => *a == Type::BOOL && *b == Type::BOOL,
        BinaryOp::BitAnd | BinaryOp::BitXor | BinaryOp::BitOr => {
            let both = a.scalar() == b.scalar() && !is(a, ScalarType::is_floating);
            both && (same_shape(a, b) || a.is_scalar() || b.is_scalar())
        }
        BinaryOp::Shl | BinaryOp::Shr => {
            is(a, ScalarType::is_integer) && is(b, ScalarType::is_integer) && (!sure || is(b, ScalarType::is_unsigned))
        }
        BinaryOp::Less
        | BinaryOp::Greater
        | BinaryOp::LessEqual
        | BinaryOp::GreaterEqual
        | BinaryOp::Equal
        | BinaryOp::NotEqual => a.scalar() == b.scalar() && same_shape(a, b),
        BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Rem => {
            !is(a, |s| s == ScalarType::Bool) && !super::types_of::arithmetic(op, a, b).is_error()
        }
    }
}

impl Checker<'_> {
    fn type_at(&self, id: ExprId) -> &Type {
        &self.out.types[id.index()]
    }

    /// True for a number of which an `i32` has no value, and for what is computed of such numbers: an abstract integer has 64
    /// bits (WGSL, section 6.2.1).
    fn is_wide(&self, id: ExprId) -> bool {
        // The first number that no `u32` has.
        const BEYOND: f32 = 4_294_967_296.0;
        let ty = self.type_at(id);
        let beyond =
            matches!(self.out.values[id.index()], Some(Const::Float(v)) if v.abs() >= BEYOND && v.fract() == 0.0);
        self.is_abstract[id.index()] && (*ty == Type::UINT || (*ty == Type::FLOAT && beyond))
    }

    fn misfit(&mut self, code: Code, place: Span, what: Message, label: Message) {
        self.out.misfits.push(Misfit { code, place, what, label });
    }

    /// Looks at the operands of an operator, which have been brought to one component type where that is possible.
    pub(super) fn operands_fit(&mut self, op: BinaryOp, place: Span, left: ExprId, right: ExprId) {
        let (a, b) = (self.type_at(left), self.type_at(right));
        // Numbers of 64 bits are computed with before any of them has a type of 32.
        let open = self.is_wide(left) || self.is_wide(right);
        if open || !is_known(a) || !is_known(b) || takes(op, a, b, !self.is_abstract[right.index()]) {
            return;
        }
        let (a, b, op) = (spelling(a), spelling(b), op.text());
        let what = message!("`{op}` does not take `{a}` and `{b}`", "`{op}` は `{a}` と `{b}` を被演算子にできません");
        self.misfit(errors::OPERAND_TYPE, place, what, message!("`{a}` {op} `{b}`", "`{a}` {op} `{b}`"));
    }

    /// The types of a value and of the place that it goes to, where the one is no other.
    fn differs(&self, wanted: &Type, value: ExprId) -> Option<(String, String)> {
        let given = self.type_at(value);
        if self.is_wide(value) {
            return None;
        }
        (is_known(wanted) && is_known(given) && wanted != given).then(|| (spelling(wanted), spelling(given)))
    }

    /// Looks at a value that goes into a variable.
    pub(super) fn value_fits(&mut self, wanted: &Type, value: ExprId) {
        let Some((wanted, given)) = self.differs(wanted, value) else { return };
        let what = message!(
            "a value of type `{given}` does not go into a `{wanted}`",
            "`{given}` の値は `{wanted}` に代入できません"
        );
        let place = self.arena.get(value).span;
        self.misfit(errors::ASSIGN_TYPE, place, what, message!("this is `{given}`", "これは `{given}`"));
    }

    /// How a part of a variable of the module is declared; `None` for anything else.
    fn declared_as(&self, id: ExprId) -> Option<&TypeSyntax> {
        match &self.arena.get(id).kind {
            ExprKind::Paren(inner) => self.declared_as(*inner),
            ExprKind::Index { base, .. } => self.declared_as(*base)?.args.first()?.ty.as_ref(),
            ExprKind::Name(own) if !self.scopes.iter().any(|scope| scope.contains_key(own)) => {
                self.items.iter().find_map(|item| match item {
                    ModuleItem::Variable(variable) if variable.name.name == *own => variable.ty.as_ref(),
                    _ => None,
                })
            }
            ExprKind::Field { base, field } => {
                let of = &self.declared_as(*base)?.name.name;
                let members = self.items.iter().find_map(|item| match item {
                    ModuleItem::Struct { name, members } if name.name == *of => Some(members),
                    _ => None,
                });
                members?.iter().find(|member| member.name.name == field.name).map(|member| &member.ty)
            }
            _ => None,
        }
    }

    /// Looks at a place that is written: an atomic is written by a function alone (WGSL, section 6.2.8).
    pub(super) fn place_fits(&mut self, place: ExprId) {
        if self.declared_as(place).is_none_or(|ty| ty.name.name != "atomic") {
            return;
        }
        let span = self.arena.get(place).span;
        let what = message!("an atomic is written by `atomicStore`", "アトミックには `atomicStore` で書き込みます");
        self.misfit(errors::NOT_A_PLACE, span, what, message!("declared `atomic`", "`atomic` と宣言されている"));
    }

    /// Looks at what the current function gives back.
    pub(super) fn result_fits(&mut self, value: ExprId) {
        let Some((_, wanted)) = self.current.clone() else { return };
        let Some((wanted, given)) = self.differs(&wanted, value) else { return };
        let what = message!(
            "the function returns `{wanted}`, and this value is `{given}`",
            "関数は `{wanted}` を返しますが、この値は `{given}` です"
        );
        let place = self.arena.get(value).span;
        self.misfit(errors::RETURN_TYPE, place, what, message!("returned here", "ここで返しています"));
    }

    /// Looks at a condition.
    pub(super) fn condition_fits(&mut self, condition: ExprId) {
        let ty = self.type_at(condition);
        if !is_known(ty) || *ty == Type::BOOL {
            return;
        }
        let ty = spelling(ty);
        let what = message!("a condition is a `bool`, not a `{ty}`", "条件は `bool` です。`{ty}` にはできません");
        let place = self.arena.get(condition).span;
        self.misfit(errors::CONDITION_TYPE, place, what, message!("this is `{ty}`", "これは `{ty}`"));
    }

    /// Looks at the arguments of a call; false where one does not fit, and another function may be meant.
    pub(super) fn arguments_fit(&mut self, function: FunctionId, args: &[ExprId]) -> bool {
        let info = self.out.functions[function.index()].clone();
        let name = &info.name.name;
        for (arg, param) in args.iter().zip(&info.params) {
            let Some((wanted, given)) = self.differs(&param.ty, *arg) else { continue };
            let what = message!(
                "`{name}` takes a `{wanted}` here, not a `{given}`",
                "`{name}` がここで受け取るのは `{wanted}` で、`{given}` ではありません"
            );
            let place = self.arena.get(*arg).span;
            self.misfit(errors::NO_OVERLOAD, place, what, message!("this is `{given}`", "これは `{given}`"));
            return false;
        }
        true
    }
}
