//! Statements, and what they declare.

use super::super::program::{Expression, Form, Kind, Scalar, Statement, Type, Variable};
use super::{KnownVariable, Maker};

/// Rounds of loops.
const ROUNDS: usize = 4;

impl Maker {
    /// The statements of the program itself: between them, in a compute stage, what invocations do together.
    pub(super) fn top(&mut self, count: usize) -> Vec<Statement> {
        let mut all = Vec::new();
        for _ in 0..count {
            self.statement(2, false, &mut all);
            if self.program.form == Form::Compute && self.stream.one_in(2) {
                self.together(&mut all);
            }
        }
        if self.program.form == Form::Compute && !all.iter().any(|s| matches!(s, Statement::Exchange { .. })) {
            self.together(&mut all);
        }
        all
    }

    fn together(&mut self, all: &mut Vec<Statement>) {
        if self.stream.one_in(3) {
            let value = self.expression(&Type::UINT, 2);
            let id = self.declare(Type::UINT, true);
            all.push(Statement::Total { id, value });
        } else {
            let ty = self.value();
            let value = self.expression(&ty, 2);
            let id = self.declare(ty, true);
            all.push(Statement::Exchange { id, value, shift: 1 + self.stream.below(3) as u8 });
        }
    }

    /// The statements of a helper; its result reads what they declare.
    pub(super) fn helper_block(&mut self, count: usize) -> Vec<Statement> {
        let mut all = Vec::new();
        (0..count).for_each(|_| self.statement(1, false, &mut all));
        all
    }

    fn statement(&mut self, depth: usize, rounds: bool, all: &mut Vec<Statement>) {
        let inner = if depth == 0 { 6 } else { 12 };
        match self.stream.below(inner) {
            0 | 1 => self.local(all),
            2 | 3 => self.assign(all),
            4 if rounds => {
                let condition = self.expression(&Type::BOOL, 1);
                all.push(match self.stream.below(2) {
                    0 => Statement::Break { condition },
                    _ => Statement::Continue { condition },
                });
            }
            4 | 5 => self.change(all),
            6 | 7 => {
                let condition = self.expression(&Type::BOOL, 2);
                let (then, otherwise) = (1 + self.stream.below(2), self.stream.below(2));
                let then = self.nested(then, depth - 1, rounds);
                let otherwise = self.nested(otherwise, depth - 1, rounds);
                all.push(Statement::If { condition, then, otherwise });
            }
            8 | 9 => {
                let before = self.scope.len();
                let id = self.declare(Type::INT, false);
                let count = 1 + self.stream.below(2);
                let body = self.nested(count, depth - 1, true);
                self.scope.truncate(before);
                let rounds = 1 + self.stream.below(ROUNDS) as u8;
                all.push(match self.stream.below(2) {
                    0 => Statement::For { id, rounds, body },
                    _ => Statement::Loop { id, rounds, body },
                });
            }
            10 => {
                let selector = self.expression(&Type::INT, 1);
                let selector = self.named("& of int", vec![selector, Expression::int(3)], Type::INT);
                let mut cases = Vec::new();
                let mut number = 0;
                for _ in 0..1 + self.stream.below(2) {
                    let several = 1 + self.stream.below(2) as i32;
                    let numbers = (number..number + several).collect();
                    number += several;
                    let count = 1 + self.stream.below(2);
                    // A way out of the loop would leave the switch alone.
                    cases.push((numbers, self.nested(count, 0, false)));
                }
                let otherwise = self.nested(1, 0, false);
                all.push(Statement::Switch { selector, cases, otherwise });
            }
            _ => self.local(all),
        }
    }

    /// A block inside of a statement.
    fn nested(&mut self, count: usize, depth: usize, rounds: bool) -> Vec<Statement> {
        let before = self.scope.len();
        let mut all = Vec::new();
        (0..count).for_each(|_| self.statement(depth, rounds, &mut all));
        self.scope.truncate(before);
        all
    }

    fn local(&mut self, all: &mut Vec<Statement>) {
        let ty = self.any();
        let value = self.expression(&ty, 2);
        let id = self.declare(ty, true);
        all.push(Statement::Declare { id, value });
    }

    /// What can be written, and a part of it now and then.
    fn place(&mut self) -> Option<Expression> {
        let known: Vec<KnownVariable> = self.scope.iter().filter(|k| k.writable).cloned().collect();
        if known.is_empty() {
            return None;
        }
        let KnownVariable { variable, ty, .. } = known[self.stream.below(known.len())].clone();
        let mut place = Expression::read(variable, ty);
        for _ in 0..2 {
            if self.stream.one_in(3) {
                break;
            }
            place = match place.ty.clone() {
                Type::Structure(index) => {
                    let members = &self.program.structures[index];
                    let at = self.stream.below(members.len());
                    Expression {
                        ty: self.program.structures[index][at].clone(),
                        kind: Kind::Member(Box::new(place), at),
                    }
                }
                Type::Array(of, n) => self.element(&place, *of, n),
                Type::Matrix(n, k) => self.element(&place, Type::Value(Scalar::Float, k), n),
                Type::Value(..) => break,
            };
        }
        Some(place)
    }

    fn assign(&mut self, all: &mut Vec<Statement>) {
        let Some(mut place) = self.place() else { return self.local(all) };
        if let Type::Value(scalar, n) = place.ty
            && n > 1
            && self.stream.one_in(3)
        {
            let at = self.stream.below(usize::from(n)) as u8;
            let one = Type::Value(scalar, 1);
            place = match self.stream.one_in(2) {
                true => self.element(&place, one, n),
                false => Expression { ty: one, kind: Kind::Swizzle(Box::new(place), vec![at]) },
            };
        }
        let value = self.expression(&place.ty.clone(), 2);
        all.push(Statement::Assign { place, value });
    }

    /// A call of a helper that changes a place.
    fn change(&mut self, all: &mut Vec<Statement>) {
        let helpers: Vec<usize> =
            (0..self.program.helpers.len()).filter(|&k| self.program.helpers[k].target.is_some()).collect();
        if helpers.is_empty() {
            return self.local(all);
        }
        let helper = helpers[self.stream.below(helpers.len())];
        let (Some(ty), parameters) =
            (self.program.helpers[helper].target.clone(), self.program.helpers[helper].parameters.clone())
        else {
            return;
        };
        let same: Vec<Variable> = self.scope.iter().filter(|k| k.writable && k.ty == ty).map(|k| k.variable).collect();
        let target = match same.is_empty() {
            true => {
                // A variable of its own; now and then inside of an array.
                let inside = self.stream.one_in(4);
                let whole = if inside { Type::Array(Box::new(ty.clone()), 2) } else { ty.clone() };
                let value = self.expression(&whole, 1);
                let id = self.declare(whole.clone(), true);
                all.push(Statement::Declare { id, value });
                let read = Expression::read(Variable::Local(id), whole);
                if inside { self.element(&read, ty, 2) } else { read }
            }
            false => Expression::read(same[self.stream.below(same.len())], ty),
        };
        let arguments = parameters.iter().map(|ty| self.expression(ty, 1)).collect();
        all.push(Statement::Change { helper, target, arguments });
    }
}
