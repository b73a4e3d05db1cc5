//! Uniform arrays for languages that cannot state a stride.
//!
//! In std140 the elements of `uniform float w[4]` stand 16 bytes apart. WGSL and MSL have no word for
//! that, and naga writes `array<f32, 4>`, whose elements stand 4 bytes apart: the same buffer would
//! mean other numbers. Here such arrays become arrays of four-component vectors, of which the first
//! components count, and the entry point begins with a copy into private variables of the shader's own types.

use naga::valid::ModuleInfo;
use naga::{
    AddressSpace, ArraySize, Block, Expression, Function, GlobalVariable, Handle, Module, Range, Scalar, Span,
    Statement, StructMember, SwizzleComponent, Type, TypeInner, VectorSize,
};

use super::{ProgramError, validate};

/// A module that means the same where array strides follow from the element type. `None` when the
/// given one does already.
pub(super) fn natural(module: &Module, entry_point: usize) -> Result<Option<(Module, ModuleInfo)>, ProgramError> {
    let mut module = module.clone();
    let mut copies = Vec::new();
    let uniforms: Vec<_> =
        module.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::Uniform).map(|(h, _)| h).collect();
    for global in uniforms {
        if let Some(ty) = padded_block(&mut module, global) {
            let variable = &mut module.global_variables[global];
            let mut buffer = variable.clone();
            buffer.ty = ty;
            *variable = GlobalVariable { space: AddressSpace::Private, binding: None, ..variable.clone() };
            copies.push((module.global_variables.append(buffer, Span::UNDEFINED), global));
        }
    }
    if copies.is_empty() {
        return Ok(None);
    }
    let mut function = std::mem::take(&mut module.entry_points[entry_point].function);
    let mut body = Copies { module: &module, function: &mut function, body: Block::new() };
    for (from, to) in copies {
        body.copy(from, to);
    }
    let mut body = body.body;
    body.extend_block(std::mem::take(&mut function.body));
    function.body = body;
    module.entry_points[entry_point].function = function;
    let info = validate(&module)?;
    Ok(Some((module, info)))
}

/// The scalar and size of elements that stand further apart than their own size.
fn element(module: &Module, ty: Handle<Type>) -> Option<(Scalar, u32, ArraySize)> {
    let TypeInner::Array { base, size, stride } = module.types[ty].inner else { return None };
    let (scalar, components) = match module.types[base].inner {
        TypeInner::Scalar(scalar) => (scalar, 1),
        TypeInner::Vector { size: VectorSize::Bi, scalar } => (scalar, 2),
        _ => return None,
    };
    (stride > components * u32::from(scalar.width)).then_some((scalar, components, size))
}

/// The type of a block in which every such array is padded; `None` when there is none.
fn padded_block(module: &mut Module, global: Handle<GlobalVariable>) -> Option<Handle<Type>> {
    let Type { name, inner: TypeInner::Struct { members, span } } =
        module.types[module.global_variables[global].ty].clone()
    else {
        return None;
    };
    let mut changed = false;
    let mut padded: Vec<StructMember> = members;
    for member in &mut padded {
        let Some((scalar, _, size)) = element(module, member.ty) else { continue };
        let mut add = |inner| module.types.insert(Type { name: None, inner }, Span::UNDEFINED);
        let base = add(TypeInner::Vector { size: VectorSize::Quad, scalar });
        member.ty = add(TypeInner::Array { base, size, stride: 4 * u32::from(scalar.width) });
        changed = true;
    }
    let ty = Type { name: name.map(|n| format!("{n}_padded")), inner: TypeInner::Struct { members: padded, span } };
    changed.then(|| module.types.insert(ty, Span::UNDEFINED))
}

/// Statements that copy blocks, member by member. They stand before all others, so that operands that
/// are appended to the arena of expressions are computed before they are used.
struct Copies<'a> {
    module: &'a Module,
    function: &'a mut Function,
    body: Block,
}

impl Copies<'_> {
    fn copy(&mut self, from: Handle<GlobalVariable>, to: Handle<GlobalVariable>) {
        let module = self.module;
        let TypeInner::Struct { members, .. } = &module.types[module.global_variables[to].ty].inner else { return };
        let from = self.name(Expression::GlobalVariable(from));
        let to = self.name(Expression::GlobalVariable(to));
        for (index, member) in (0..).zip(members) {
            let source = self.compute(Expression::AccessIndex { base: from, index });
            let pointer = self.compute(Expression::AccessIndex { base: to, index });
            let value = match element(module, member.ty) {
                Some((_, components, ArraySize::Constant(count))) => {
                    let elements = (0..count.get()).map(|k| self.element(source, k, components)).collect();
                    self.compute(Expression::Compose { ty: member.ty, components: elements })
                }
                _ => self.compute(Expression::Load { pointer: source }),
            };
            self.body.push(Statement::Store { pointer, value }, Span::UNDEFINED);
        }
    }

    /// The first components of an element of a padded array.
    fn element(&mut self, array: Handle<Expression>, index: u32, components: u32) -> Handle<Expression> {
        let pointer = self.compute(Expression::AccessIndex { base: array, index });
        if components == 1 {
            let pointer = self.compute(Expression::AccessIndex { base: pointer, index: 0 });
            return self.compute(Expression::Load { pointer });
        }
        use SwizzleComponent::{X, Y};
        let vector = self.compute(Expression::Load { pointer });
        self.compute(Expression::Swizzle { size: VectorSize::Bi, vector, pattern: [X, Y, X, Y] })
    }

    fn name(&mut self, expression: Expression) -> Handle<Expression> {
        self.function.expressions.append(expression, Span::UNDEFINED)
    }

    fn compute(&mut self, expression: Expression) -> Handle<Expression> {
        let handle = self.name(expression);
        self.body.push(Statement::Emit(Range::new_from_bounds(handle, handle)), Span::UNDEFINED);
        handle
    }
}
