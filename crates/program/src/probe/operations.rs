//! The scalar operations that an expression stands for.

use naga::{BinaryOperator, Expression, Handle, MathFunction, TypeInner, UnaryOperator};

use super::operands::{Leaves, OperandScope};
use super::{OperandSource, Operation};

/// Operations in order.
#[derive(Default)]
struct List(Vec<Operation>);

impl List {
    fn push(&mut self, name: &'static str, operands: &[OperandSource]) -> OperandSource {
        self.0.push(Operation { name, operands: operands.to_vec(), result: None });
        OperandSource::Operation(self.0.len() - 1)
    }

    /// The sum of products, from the first to the last.
    fn dot(&mut self, pairs: impl IntoIterator<Item = (OperandSource, OperandSource)>) -> Option<OperandSource> {
        let mut sum = None;
        for (a, b) in pairs {
            let term = self.push("mul", &[a, b]);
            sum = Some(match sum {
                None => term,
                Some(sum) => self.push("add", &[sum, term]),
            });
        }
        sum
    }

    fn length(&mut self, x: &[OperandSource]) -> Option<OperandSource> {
        let square = self.dot(x.iter().map(|&x| (x, x)))?;
        Some(self.push("sqrt", &[square]))
    }
}

/// The operands of a traced expression, component by component, and its scalar operations.
pub(super) fn operations(
    scope: &OperandScope<'_>,
    handle: Handle<Expression>,
    leaves: &mut Leaves,
) -> (Vec<Vec<OperandSource>>, Vec<Operation>) {
    let expression = &scope.function.expressions[handle];
    let operands: Vec<Vec<OperandSource>> =
        operands(scope, expression).into_iter().map(|operand| scope.sources(operand, leaves)).collect();
    let mut list = List::default();
    let results = match *expression {
        Expression::Unary { op: UnaryOperator::Negate, .. } => each(&mut list, "neg", &operands),
        Expression::Binary { op, left, right } => binary(scope, &mut list, op, left, right, &operands),
        Expression::Math { fun, .. } => match componentwise(fun) {
            Some(name) => each(&mut list, name, &operands),
            None => formula(&mut list, fun, &operands),
        },
        Expression::As { .. } => each(&mut list, "convert", &operands),
        _ => None,
    };
    for (component, result) in (0..).zip(results.into_iter().flatten()) {
        if let OperandSource::Operation(k) = result {
            list.0[k].result = Some(component);
        }
    }
    (operands, list.0)
}

fn operands(scope: &OperandScope<'_>, expression: &Expression) -> Vec<Handle<Expression>> {
    match *expression {
        Expression::Unary { expr, .. } | Expression::As { expr, .. } => vec![expr],
        Expression::Binary { left, right, .. } => vec![left, right],
        Expression::Math { arg, arg1, arg2, arg3, .. } => [Some(arg), arg1, arg2, arg3].into_iter().flatten().collect(),
        // A part of what `modf` or `frexp` gives.
        Expression::AccessIndex { base, .. } => operands(scope, &scope.function.expressions[base]),
        _ => Vec::new(),
    }
}

/// The same operation for each component; a scalar stands for a vector of it.
fn each(list: &mut List, name: &'static str, operands: &[Vec<OperandSource>]) -> Option<Vec<OperandSource>> {
    let count = operands.iter().map(Vec::len).max()?;
    let at = |k: usize| operands.iter().map(|o| component(o, k)).collect::<Option<Vec<OperandSource>>>();
    (0..count).map(|k| Some(list.push(name, &at(k)?))).collect()
}

fn component(operand: &[OperandSource], k: usize) -> Option<OperandSource> {
    if operand.len() == 1 { operand.first().copied() } else { operand.get(k).copied() }
}

fn binary(
    scope: &OperandScope<'_>,
    list: &mut List,
    op: BinaryOperator,
    left: Handle<Expression>,
    right: Handle<Expression>,
    operands: &[Vec<OperandSource>],
) -> Option<Vec<OperandSource>> {
    let name = match op {
        BinaryOperator::Add => "add",
        BinaryOperator::Subtract => "sub",
        BinaryOperator::Multiply => "mul",
        BinaryOperator::Divide => "div",
        BinaryOperator::Modulo => "rem",
        // Comparisons compute no number.
        _ => return None,
    };
    let (left_type, right_type) = (scope.inner(left), scope.inner(right));
    let matrix = |inner: &TypeInner| match *inner {
        TypeInner::Matrix { columns, rows, .. } => Some((columns as usize, rows as usize)),
        _ => None,
    };
    let vector = |inner: &TypeInner| matches!(inner, TypeInner::Vector { .. });
    let shape = match (matrix(left_type), matrix(right_type)) {
        (Some((inner, rows)), Some((columns, _))) => Some((rows, inner, columns)),
        (Some((columns, rows)), None) if vector(right_type) => Some((rows, columns, 1)),
        (None, Some((columns, rows))) if vector(left_type) => Some((1, rows, columns)),
        _ => None,
    };
    let Some((rows, inner, columns)) = shape.filter(|_| op == BinaryOperator::Multiply) else {
        return each(list, name, operands);
    };
    let [a, b] = operands else { return None };
    (0..rows * columns)
        .map(|k| {
            let (column, row) = (k / rows, k % rows);
            list.dot((0..inner).map(|j| (a[j * rows + row], b[column * inner + j])))
        })
        .collect()
}

/// Functions that are one operation for each component.
fn componentwise(fun: MathFunction) -> Option<&'static str> {
    use MathFunction as Mf;
    Some(match fun {
        Mf::Min => "min",
        Mf::Max => "max",
        Mf::Step => "step",
        Mf::Ldexp => "ldexp",
        Mf::Fma => "fma",
        Mf::Atan => "atan",
        Mf::Atan2 => "atan2",
        Mf::Pow => "pow",
        _ => return crate::build::name_of_each(fun),
    })
}

/// Functions that a formula defines. Those that are not split become one operation on all operands.
fn formula(list: &mut List, fun: MathFunction, operands: &[Vec<OperandSource>]) -> Option<Vec<OperandSource>> {
    let name = match (fun, operands) {
        (MathFunction::Dot, [a, b]) => return Some(vec![list.dot(a.iter().copied().zip(b.iter().copied()))?]),
        (MathFunction::Length, [x]) => return Some(vec![list.length(x)?]),
        (MathFunction::Distance, [..]) => {
            let between = each(list, "sub", operands)?;
            return Some(vec![list.length(&between)?]);
        }
        (MathFunction::Normalize, [x]) => {
            let square = list.dot(x.iter().map(|&x| (x, x)))?;
            let scale = list.push("inversesqrt", &[square]);
            return Some(x.iter().map(|&x| list.push("mul", &[x, scale])).collect());
        }
        (MathFunction::Cross, [a, b]) => {
            let mut term = |i: usize, j: usize| {
                let left = list.push("mul", &[*a.get(i)?, *b.get(j)?]);
                let right = list.push("mul", &[*b.get(i)?, *a.get(j)?]);
                Some(list.push("sub", &[left, right]))
            };
            return [(1, 2), (2, 0), (0, 1)].into_iter().map(|(i, j)| term(i, j)).collect();
        }
        (MathFunction::Clamp, [x, low, high]) => {
            let raised = each(list, "max", &[x.clone(), low.clone()])?;
            return each(list, "min", &[raised, high.clone()]);
        }
        (MathFunction::Mix, [x, y, weight]) => {
            let rest = each(list, "sub", &[vec![OperandSource::Literal(1.0)], weight.clone()])?;
            let from = each(list, "mul", &[x.clone(), rest])?;
            let to = each(list, "mul", &[y.clone(), weight.clone()])?;
            return each(list, "add", &[from, to]);
        }
        (MathFunction::SmoothStep, _) => "smoothstep",
        (MathFunction::Reflect, _) => "reflect",
        (MathFunction::Refract, _) => "refract",
        (MathFunction::FaceForward, _) => "faceforward",
        (MathFunction::Determinant, _) => "determinant",
        (MathFunction::Inverse, _) => "inverse",
        // Exact moves, packed formats, and functions that GLSL has no name for.
        _ => return None,
    };
    list.push(name, &operands.concat());
    None
}
