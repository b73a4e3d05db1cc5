//! Expressions of a type, from what is in scope.

use super::super::operations::{OPERATIONS, Operation};
use super::super::program::{Expression, Kind, Language, Scalar, Type, Variable};
use super::Maker;

/// Calls of helpers in one program.
const CALLS: usize = 4;

/// Ordinary literals, ties, and what is lost beside 1.
const FLOATS: [f32; 20] = [
    0.0, 0.5, 1.0, -1.0, 2.0, 0.25, -0.75, 1.5, 3.0, 0.1, 0.7, -0.3, 1e-3, 10.0, 0.0078125, 4.0, 1.75, -2.5, 100.0,
    1e-6,
];
const RARE: [f32; 8] = [-0.0, 1e-20, 1e-38, 16_777_216.0, 0.499_999_97, 0.999_999_94, 65504.0, 1e-9];
const INTS: [i32; 12] = [0, 1, -1, 2, 3, 5, 7, 15, 31, -2, 64, 255];

impl Maker {
    /// An expression of a type, so many levels deep at most.
    pub(super) fn expression(&mut self, ty: &Type, depth: usize) -> Expression {
        if depth == 0 || self.stream.one_in(8) {
            return self.leaf(ty);
        }
        match self.stream.below(10) {
            0 => self.construct(ty, depth - 1),
            1 => self.part(ty).unwrap_or_else(|| self.leaf(ty)),
            2 => self.call(ty, depth - 1).unwrap_or_else(|| self.leaf(ty)),
            3 => self.swizzle(ty, depth - 1).unwrap_or_else(|| self.leaf(ty)),
            _ => self.operation(ty, depth - 1).unwrap_or_else(|| self.construct(ty, depth - 1)),
        }
    }

    /// A variable, a part of one, or a literal.
    pub(super) fn leaf(&mut self, ty: &Type) -> Expression {
        let same: Vec<Variable> = self.scope.iter().filter(|k| k.ty == *ty).map(|k| k.variable).collect();
        if !same.is_empty() && !self.stream.one_in(4) {
            return Expression::read(same[self.stream.below(same.len())], ty.clone());
        }
        if !self.stream.one_in(3)
            && let Some(part) = self.part(ty)
        {
            return part;
        }
        match ty {
            Type::Value(scalar, n) => {
                let words = (0..*n).map(|_| self.word(*scalar)).collect();
                Expression::literal(*scalar, words)
            }
            _ => self.construct(ty, 0),
        }
    }

    fn word(&mut self, scalar: Scalar) -> u32 {
        match scalar {
            Scalar::Float if self.stream.one_in(12) => RARE[self.stream.below(RARE.len())].to_bits(),
            Scalar::Float => FLOATS[self.stream.below(FLOATS.len())].to_bits(),
            Scalar::Int => INTS[self.stream.below(INTS.len())] as u32,
            Scalar::Uint => INTS[self.stream.below(INTS.len())].unsigned_abs(),
            Scalar::Bool => self.stream.below(2) as u32,
        }
    }

    /// A member, element or component of a variable in scope that has this type.
    fn part(&mut self, ty: &Type) -> Option<Expression> {
        let known = self.scope.clone();
        let mut found = Vec::new();
        for known in &known {
            self.parts_of(&Expression::read(known.variable, known.ty.clone()), ty, 2, &mut found);
        }
        if found.is_empty() {
            return None;
        }
        let at = self.stream.below(found.len());
        Some(found.swap_remove(at))
    }

    /// Parts of an expression that have this type, down to some depth; one element stands for all of an array.
    fn parts_of(&mut self, of: &Expression, ty: &Type, depth: usize, found: &mut Vec<Expression>) {
        if depth == 0 {
            return;
        }
        let mut parts = Vec::new();
        match &of.ty {
            Type::Structure(index) => {
                for (k, member) in self.program.structures[*index].clone().into_iter().enumerate() {
                    parts.push(Expression { ty: member, kind: Kind::Member(Box::new(of.clone()), k) });
                }
            }
            Type::Array(element, n) => parts.push(self.element(of, (**element).clone(), *n)),
            Type::Matrix(n, k) => parts.push(self.element(of, Type::Value(Scalar::Float, *k), *n)),
            Type::Value(scalar, n) if *n > 1 => {
                let (one, at) = (Type::Value(*scalar, 1), self.stream.below(usize::from(*n)) as u8);
                // Elements of vectors by a number that is computed are where translators differ.
                if self.stream.one_in(3) {
                    parts.push(self.element(of, one, *n));
                } else {
                    parts.push(Expression { ty: one, kind: Kind::Swizzle(Box::new(of.clone()), vec![at]) });
                }
            }
            Type::Value(..) => {}
        }
        for part in parts {
            self.parts_of(&part, ty, depth - 1, found);
            if part.ty == *ty {
                found.push(part);
            }
        }
    }

    pub(super) fn element(&mut self, of: &Expression, ty: Type, n: u8) -> Expression {
        let index = self.index(n, 0);
        // A place of a variable in scope, most often a counter or an input.
        let known: Vec<Variable> = self.scope.iter().filter(|k| k.ty == Type::INT).map(|k| k.variable).collect();
        let index = match known.is_empty() || self.stream.one_in(2) {
            true => index,
            false => {
                let read = Expression::read(known[self.stream.below(known.len())], Type::INT);
                let mask = if n.is_power_of_two() { n - 1 } else { 1 };
                self.named("& of int", vec![read, Expression::int(i32::from(mask))], Type::INT)
            }
        };
        Expression { ty, kind: Kind::Element(Box::new(of.clone()), Box::new(index)) }
    }

    /// A value from its parts.
    fn construct(&mut self, ty: &Type, depth: usize) -> Expression {
        let parts: Vec<Expression> = match ty {
            Type::Value(scalar, 1) => return self.literal_or(*scalar, depth),
            Type::Value(scalar, n) => {
                let mut left = *n;
                let mut parts = Vec::new();
                while left > 0 {
                    let most = left.min(n - 1).max(1);
                    let size = 1 + self.stream.below(usize::from(most)) as u8;
                    parts.push(self.expression(&Type::Value(*scalar, size), depth.min(1)));
                    left -= size;
                }
                parts
            }
            Type::Matrix(n, k) => {
                (0..*n).map(|_| self.expression(&Type::Value(Scalar::Float, *k), depth.min(1))).collect()
            }
            Type::Array(of, n) => (0..*n).map(|_| self.expression(of, depth.min(1))).collect(),
            Type::Structure(index) => {
                let members = self.program.structures[*index].clone();
                members.iter().map(|member| self.expression(member, depth.min(1))).collect()
            }
        };
        Expression { ty: ty.clone(), kind: Kind::Construct(parts) }
    }

    fn literal_or(&mut self, scalar: Scalar, depth: usize) -> Expression {
        let one = Type::Value(scalar, 1);
        match self.stream.below(2) {
            0 => self.operation(&one, depth).unwrap_or_else(|| self.leaf(&one)),
            _ => Expression::literal(scalar, vec![self.word(scalar)]),
        }
    }

    fn swizzle(&mut self, ty: &Type, depth: usize) -> Option<Expression> {
        let Type::Value(scalar, n) = ty else { return None };
        let from = 2 + self.stream.below(3) as u8;
        let of = self.expression(&Type::Value(*scalar, from), depth);
        let parts = (0..*n).map(|_| self.stream.below(usize::from(from)) as u8).collect();
        Some(Expression { ty: ty.clone(), kind: Kind::Swizzle(Box::new(of), parts) })
    }

    fn call(&mut self, ty: &Type, depth: usize) -> Option<Expression> {
        // Of a helper that is being made, those before it are called.
        let fit: Vec<usize> = (0..self.program.helpers.len())
            .filter(|&k| self.program.helpers[k].target.is_none() && self.program.helpers[k].result.ty == *ty)
            .collect();
        if fit.is_empty() || self.calls >= CALLS {
            return None;
        }
        self.calls += 1;
        let helper = fit[self.stream.below(fit.len())];
        let parameters = self.program.helpers[helper].parameters.clone();
        let arguments = parameters.iter().map(|ty| self.expression(ty, depth.min(1))).collect();
        Some(Expression { ty: ty.clone(), kind: Kind::Call(helper, arguments) })
    }

    /// An operation that gives this type.
    fn operation(&mut self, ty: &Type, depth: usize) -> Option<Expression> {
        let language = self.program.language;
        let fits =
            |row: &Operation| row.guard().is_none() && row.template(language).is_some() && row.giving(ty).is_some();
        let rows: Vec<usize> = (0..OPERATIONS.len()).filter(|&k| fits(&OPERATIONS[k])).collect();
        if rows.is_empty() {
            return None;
        }
        let row = rows[self.stream.below(rows.len())];
        let operation = &OPERATIONS[row];
        let (n, k) = operation.giving(ty)?;
        let sizes: Vec<u8> = operation.sizes.bytes().map(|digit| digit - b'0').collect();
        let n = if n == 0 { sizes[self.stream.below(sizes.len())] } else { n };
        let k = if k == 0 { 2 + self.stream.below(3) as u8 } else { k };
        let mut arguments = Vec::new();
        for (letter, guard) in operation.arguments() {
            let ty = letter.of(n, k);
            let argument = self.expression(&ty, depth);
            arguments.push(match guard {
                Some(sign) => self.guarded(argument, sign),
                None => argument,
            });
        }
        self.vary(&mut arguments, ty, operation);
        Some(Expression { ty: ty.clone(), kind: Kind::Operation(row, arguments) })
    }

    /// WGSL refuses constants whose value it finds to be out of range, so that arithmetic has an argument that it does
    /// not know, where there is one; and equal operands come about now and then.
    fn vary(&mut self, arguments: &mut [Expression], ty: &Type, operation: &Operation) {
        let guards: Vec<Option<u8>> = operation.arguments().map(|(_, guard)| guard).collect();
        let open = guards.get(1).is_some_and(Option::is_none);
        if open && arguments.len() == 2 && arguments[0].ty == arguments[1].ty && self.stream.one_in(16) {
            arguments[1] = arguments[0].clone();
        }
        let risky = |ty: &Type| matches!(ty, Type::Value(Scalar::Int | Scalar::Uint, _));
        let constant = arguments.iter().all(Expression::is_constant);
        let large = arguments.iter().any(is_large);
        let refused = self.in_language(Language::Wgsl) && (large || risky(ty) || operation.name.starts_with("bits"));
        let folded = !self.folds && operation.rounds();
        if constant && (refused || folded) {
            let Some(first) = arguments.first_mut() else { return };
            if let Some(read) = self.unknown(&first.ty.clone()) {
                *first = match guards.first() {
                    Some(Some(sign)) => self.guarded(read, *sign),
                    _ => read,
                };
            }
        }
    }

    /// Something of a type that no compiler knows.
    fn unknown(&mut self, ty: &Type) -> Option<Expression> {
        let same: Vec<Variable> = self.scope.iter().filter(|k| k.ty == *ty).map(|k| k.variable).collect();
        if !same.is_empty() {
            return Some(Expression::read(same[self.stream.below(same.len())], ty.clone()));
        }
        let Type::Value(scalar, n) = ty else { return None };
        let inputs: Vec<(Variable, Type)> = self.scope.iter().map(|k| (k.variable, k.ty.clone())).collect();
        for (variable, of) in inputs {
            let Type::Value(own, size) = of else { continue };
            let read = Expression::read(variable, of.clone());
            let one = match size {
                1 => read,
                _ => Expression { ty: Type::Value(own, 1), kind: Kind::Swizzle(Box::new(read), vec![0]) },
            };
            let to = Type::Value(*scalar, 1);
            let one = match (own, scalar) {
                (own, scalar) if own == *scalar => one,
                (Scalar::Float, Scalar::Int) => {
                    let one = self.guarded(one, b'c');
                    self.named("int of float", vec![one], to)
                }
                (Scalar::Float, Scalar::Uint) => {
                    let one = self.guarded(one, b'C');
                    self.named("uint of float", vec![one], to)
                }
                (Scalar::Int, Scalar::Uint) => self.named("uint of int", vec![one], to),
                (Scalar::Uint, Scalar::Int) => self.named("int of uint", vec![one], to),
                _ => continue,
            };
            let parts = vec![one; usize::from(*n)];
            return Some(match n {
                1 => parts.into_iter().next()?,
                _ => Expression { ty: ty.clone(), kind: Kind::Construct(parts) },
            });
        }
        None
    }

    fn guarded(&mut self, argument: Expression, sign: u8) -> Expression {
        let fit = |row: &Operation| row.guard() == Some(sign) && row.giving(&argument.ty).is_some();
        match OPERATIONS.iter().position(fit) {
            Some(row) => Expression { ty: argument.ty.clone(), kind: Kind::Operation(row, vec![argument]) },
            None => argument,
        }
    }
}

/// True where a literal is so large that what is made of it may overflow.
fn is_large(expression: &Expression) -> bool {
    let mut found = false;
    expression.each(&mut |e| {
        if let (Kind::Literal(words), Type::Value(Scalar::Float, _)) = (&e.kind, &e.ty) {
            found |= words.iter().any(|&word| f32::from_bits(word).abs() >= 100.0);
        }
    });
    found
}
