//! Where the numbers of an expression come from.

use std::collections::HashMap;

use naga::valid::FunctionInfo;
use naga::{Arena, Expression, Function, Handle, Literal, Module, ScalarKind, TypeInner};

use super::OperandSource;

/// Where a number comes from, before leaves are numbered.
#[derive(Clone, Copy, Debug)]
enum OperandOrigin {
    Known(OperandSource),
    Leaf(Handle<Expression>, u32),
}

/// Leaves of one point, each once.
pub(super) type Leaves = Vec<(Handle<Expression>, u32)>;

/// A function with the numbers of its points.
pub(super) struct OperandScope<'a> {
    pub module: &'a Module,
    pub function: &'a Function,
    pub info: &'a FunctionInfo,
    pub points: &'a HashMap<Handle<Expression>, usize>,
}

/// Columns and rows of a scalar, vector or matrix, and whether its components are binary32.
pub(super) fn size(inner: &TypeInner) -> Option<(u32, u32, bool)> {
    let (columns, rows, scalar) = match *inner {
        TypeInner::Scalar(scalar) => (1, 1, scalar),
        TypeInner::Vector { size, scalar } => (1, size as u32, scalar),
        TypeInner::Matrix { columns, rows, scalar } => (columns as u32, rows as u32, scalar),
        _ => return None,
    };
    Some((columns, rows, scalar.kind == ScalarKind::Float && scalar.width == 4))
}

/// Indices that lead from a value of this size to one of its components.
pub(super) fn path((columns, rows): (u32, u32), component: u32) -> Vec<u32> {
    match (columns, rows) {
        (1, 1) => Vec::new(),
        (1, _) => vec![component],
        _ => vec![component / rows, component % rows],
    }
}

impl OperandScope<'_> {
    pub(super) fn inner(&self, handle: Handle<Expression>) -> &TypeInner {
        self.info[handle].ty.inner_with(&self.module.types)
    }

    /// Columns and rows of a value of binary32 numbers.
    pub(super) fn floats(&self, handle: Handle<Expression>) -> Option<(u32, u32)> {
        size(self.inner(handle)).filter(|&(_, _, float)| float).map(|(columns, rows, _)| (columns, rows))
    }

    /// Where the components of a value come from. New leaves are added to `leaves`.
    pub(super) fn sources(&self, handle: Handle<Expression>, leaves: &mut Leaves) -> Vec<OperandSource> {
        let number = |origin| match origin {
            OperandOrigin::Known(source) => source,
            OperandOrigin::Leaf(handle, component) => {
                let leaf = (handle, component);
                OperandSource::Leaf(leaves.iter().position(|&l| l == leaf).unwrap_or_else(|| {
                    leaves.push(leaf);
                    leaves.len() - 1
                }))
            }
        };
        self.origins(handle).into_iter().map(number).collect()
    }

    fn origins(&self, handle: Handle<Expression>) -> Vec<OperandOrigin> {
        let Some((columns, rows, float)) = size(self.inner(handle)) else { return Vec::new() };
        let count = columns * rows;
        if !float {
            return vec![OperandOrigin::Known(OperandSource::Untraced); count as usize];
        }
        if let Some(&point) = self.points.get(&handle) {
            return (0..count)
                .map(|component| OperandOrigin::Known(OperandSource::Point { point, component }))
                .collect();
        }
        match self.function.expressions[handle] {
            Expression::Literal(Literal::F32(value)) => vec![OperandOrigin::Known(OperandSource::Literal(value))],
            Expression::Constant(constant) => {
                let init = self.module.constants[constant].init;
                match constants(self.module, init).filter(|all| all.len() == count as usize) {
                    Some(all) => {
                        all.into_iter().map(|value| OperandOrigin::Known(OperandSource::Literal(value))).collect()
                    }
                    None => leaf(handle, count),
                }
            }
            Expression::ZeroValue(_) => vec![OperandOrigin::Known(OperandSource::Literal(0.0)); count as usize],
            Expression::Compose { ref components, .. } => components.iter().flat_map(|&c| self.origins(c)).collect(),
            Expression::Splat { value, .. } => {
                self.origins(value).first().map_or_else(Vec::new, |&origin| vec![origin; count as usize])
            }
            Expression::Swizzle { size, vector, pattern } => {
                let vector = self.origins(vector);
                pattern[..size as usize].iter().map(|&component| vector[component as usize]).collect()
            }
            Expression::AccessIndex { base, index } if size(self.inner(base)).is_some() => {
                self.origins(base)[(index * count) as usize..][..count as usize].to_vec()
            }
            _ => leaf(handle, count),
        }
    }
}

fn leaf(handle: Handle<Expression>, count: u32) -> Vec<OperandOrigin> {
    (0..count).map(|component| OperandOrigin::Leaf(handle, component)).collect()
}

/// The numbers of a constant expression of the module; `None` for what naga would have computed.
fn constants(module: &Module, handle: Handle<Expression>) -> Option<Vec<f32>> {
    let arena: &Arena<Expression> = &module.global_expressions;
    Some(match arena[handle] {
        Expression::Literal(Literal::F32(value)) => vec![value],
        Expression::Constant(constant) => constants(module, module.constants[constant].init)?,
        Expression::ZeroValue(ty) => {
            let (columns, rows, _) = size(&module.types[ty].inner)?;
            vec![0.0; (columns * rows) as usize]
        }
        Expression::Compose { ref components, .. } => {
            components.iter().map(|&c| constants(module, c)).collect::<Option<Vec<_>>>()?.concat()
        }
        Expression::Splat { size, value } => vec![*constants(module, value)?.first()?; size as usize],
        _ => return None,
    })
}
