//! Writes the body of a naga function.

use naga::{
    AddressSpace, Arena, BinaryOperator, Block, Expression, Function, FunctionArgument, FunctionResult, GlobalVariable,
    Handle, Literal, LocalVariable, Module, Range, Scalar, ScalarKind, Span, Statement, Type, TypeInner, VectorSize,
};

/// A function under construction.
pub struct Builder {
    expressions: Arena<Expression>,
    locals: Arena<LocalVariable>,
    body: Vec<Block>,
}

type Expr = Handle<Expression>;

impl Builder {
    /// A function without statements.
    pub fn new() -> Self {
        Self { expressions: Arena::new(), locals: Arena::new(), body: vec![Block::new()] }
    }

    /// Ends the function.
    pub fn finish(mut self, name: &str, arguments: Vec<FunctionArgument>, result: Option<FunctionResult>) -> Function {
        debug_assert_eq!(self.body.len(), 1, "every branch is closed");
        Function {
            name: Some(name.to_owned()),
            arguments,
            result,
            local_variables: self.locals,
            expressions: self.expressions,
            body: self.body.pop().unwrap_or_default(),
            ..Function::default()
        }
    }

    /// Adds a statement.
    pub fn statement(&mut self, statement: Statement) {
        if let Some(block) = self.body.last_mut() {
            block.push(statement, Span::UNDEFINED);
        }
    }

    /// An expression that needs no emission: a literal, a variable, an argument.
    pub fn name(&mut self, expression: Expression) -> Expr {
        self.expressions.append(expression, Span::UNDEFINED)
    }

    /// An expression that is computed here.
    pub fn compute(&mut self, expression: Expression) -> Expr {
        let handle = self.expressions.append(expression, Span::UNDEFINED);
        self.statement(Statement::Emit(Range::new_from_bounds(handle, handle)));
        handle
    }

    /// The value of a `u32` literal.
    pub fn u32(&mut self, value: u32) -> Expr {
        self.name(Expression::Literal(Literal::U32(value)))
    }

    /// An argument of the function.
    pub fn argument(&mut self, index: u32) -> Expr {
        self.name(Expression::FunctionArgument(index))
    }

    /// A pointer to a global variable.
    pub fn global(&mut self, global: Handle<GlobalVariable>) -> Expr {
        self.name(Expression::GlobalVariable(global))
    }

    /// A pointer to a new local variable.
    pub fn local(&mut self, name: &str, ty: Handle<Type>) -> Expr {
        let local = self.locals.append(LocalVariable { name: Some(name.to_owned()), ty, init: None }, Span::UNDEFINED);
        self.name(Expression::LocalVariable(local))
    }

    /// `left op right`.
    pub fn binary(&mut self, op: BinaryOperator, left: Expr, right: Expr) -> Expr {
        self.compute(Expression::Binary { op, left, right })
    }

    /// `base + offset` for indices; no operation for 0.
    pub fn offset(&mut self, base: Expr, offset: u32) -> Expr {
        if offset == 0 {
            return base;
        }
        let offset = self.u32(offset);
        self.binary(BinaryOperator::Add, base, offset)
    }

    /// Member or element `index`.
    pub fn member(&mut self, base: Expr, index: u32) -> Expr {
        self.compute(Expression::AccessIndex { base, index })
    }

    /// Element at a computed index.
    pub fn element(&mut self, base: Expr, index: Expr) -> Expr {
        self.compute(Expression::Access { base, index })
    }

    /// The value behind a pointer.
    pub fn load(&mut self, pointer: Expr) -> Expr {
        self.compute(Expression::Load { pointer })
    }

    /// Writes through a pointer.
    pub fn store(&mut self, pointer: Expr, value: Expr) {
        self.statement(Statement::Store { pointer, value });
    }

    /// The same 32 bits as another kind of scalar.
    pub fn bitcast(&mut self, expr: Expr, kind: ScalarKind) -> Expr {
        self.compute(Expression::As { expr, kind, convert: None })
    }

    /// Runs `body` again and again until what `last` gives is true.
    pub fn repeat(&mut self, body: impl FnOnce(&mut Self), last: impl FnOnce(&mut Self) -> Expr) {
        self.body.push(Block::new());
        body(self);
        let body = self.body.pop().unwrap_or_default();
        self.body.push(Block::new());
        let stop = last(self);
        let continuing = self.body.pop().unwrap_or_default();
        self.statement(Statement::Loop { body, continuing, break_if: Some(stop) });
    }

    /// Runs `inside` when `condition` holds.
    pub fn when(&mut self, condition: Expr, inside: impl FnOnce(&mut Self)) {
        self.body.push(Block::new());
        inside(self);
        let accept = self.body.pop().unwrap_or_default();
        self.statement(Statement::If { condition, accept, reject: Block::new() });
    }
}

/// The types that captured kernels use.
#[derive(Clone, Copy, Debug)]
pub struct Types {
    /// `u32`.
    pub u32: Handle<Type>,
    /// `vec3<u32>`.
    pub uvec3: Handle<Type>,
    /// `vec4<u32>`.
    pub uvec4: Handle<Type>,
    /// `vec4<f32>`.
    pub vec4: Handle<Type>,
    /// `array<u32>`, sized at run time.
    pub words: Handle<Type>,
}

impl Types {
    /// Adds the types to a module.
    pub fn insert(module: &mut Module) -> Self {
        let mut add = |inner| module.types.insert(Type { name: None, inner }, Span::UNDEFINED);
        let u32 = add(TypeInner::Scalar(Scalar::U32));
        Self {
            u32,
            uvec3: add(TypeInner::Vector { size: VectorSize::Tri, scalar: Scalar::U32 }),
            uvec4: add(TypeInner::Vector { size: VectorSize::Quad, scalar: Scalar::U32 }),
            vec4: add(TypeInner::Vector { size: VectorSize::Quad, scalar: Scalar::F32 }),
            words: add(TypeInner::Array { base: u32, size: naga::ArraySize::Dynamic, stride: 4 }),
        }
    }
}

/// Adds a global variable.
pub fn add_global(
    module: &mut Module,
    name: &str,
    space: AddressSpace,
    binding: Option<naga::ResourceBinding>,
    ty: Handle<Type>,
) -> Handle<GlobalVariable> {
    module.global_variables.append(
        GlobalVariable {
            name: Some(name.to_owned()),
            space,
            binding,
            ty,
            init: None,
            memory_decorations: naga::MemoryDecorations::empty(),
        },
        Span::UNDEFINED,
    )
}
