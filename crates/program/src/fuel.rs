//! A bound on the iterations of a kernel's loops, so that a shader that never ends cannot hang a
//! device.

use naga::{
    AddressSpace, BinaryOperator, Block, Expression, Function, GlobalVariable, Handle, Literal, Range, Span, Statement,
    TypeInner,
};

use super::capture::{Kernel, add_global};
use super::{ProgramError, validate};

impl Kernel {
    /// The kernel with a bound on all loop iterations of one invocation together, `iterations` of
    /// them. An invocation that needs more leaves its loops and writes no record, which a lane
    /// reports as [`crate::lane::LaneError::NotWritten`]. A kernel without loops stays as it is.
    ///
    /// # Errors
    /// [`ProgramError::Internal`] when the validator refuses the result.
    pub fn with_fuel(mut self, iterations: u32) -> Result<Self, ProgramError> {
        if !self.has_loops() {
            return Ok(self);
        }
        let module = &mut self.module;
        let ty = naga::Type { name: None, inner: TypeInner::Scalar(naga::Scalar::U32) };
        let ty = module.types.insert(ty, Span::UNDEFINED);
        let fuel = add_global(module, "sc_fuel", AddressSpace::Private, None, ty);
        let full = module.global_expressions.append(Expression::Literal(Literal::U32(iterations)), Span::UNDEFINED);
        module.global_variables[fuel].init = Some(full);
        for (_, function) in module.functions.iter_mut() {
            let mut body = std::mem::take(&mut function.body);
            burn(&mut body, function, fuel);
            function.body = body;
        }
        for point in &mut module.entry_points {
            let mut body = std::mem::take(&mut point.function.body);
            stop(&mut body, &mut point.function, fuel);
            point.function.body = body;
        }
        self.info = validate(&self.module)?;
        Ok(self)
    }

    /// True when a function of the kernel has a loop.
    pub fn has_loops(&self) -> bool {
        self.module.functions.iter().any(|(_, function)| loops(&function.body))
    }
}

/// The blocks inside a statement.
pub(super) fn blocks(statement: &Statement) -> Vec<&Block> {
    match statement {
        Statement::Block(block) => vec![block],
        Statement::If { accept, reject, .. } => vec![accept, reject],
        Statement::Switch { cases, .. } => cases.iter().map(|c| &c.body).collect(),
        Statement::Loop { body, continuing, .. } => vec![body, continuing],
        // The rest holds no statements.
        _ => Vec::new(),
    }
}

/// The same, to be changed.
pub(super) fn blocks_mut(statement: &mut Statement) -> Vec<&mut Block> {
    match statement {
        Statement::Block(block) => vec![block],
        Statement::If { accept, reject, .. } => vec![accept, reject],
        Statement::Switch { cases, .. } => cases.iter_mut().map(|c| &mut c.body).collect(),
        Statement::Loop { body, continuing, .. } => vec![body, continuing],
        // The rest holds no statements.
        _ => Vec::new(),
    }
}

fn loops(block: &Block) -> bool {
    block.iter().any(|s| matches!(s, Statement::Loop { .. }) || blocks(s).into_iter().any(loops))
}

/// Puts `if (fuel == 0) break; fuel -= 1;` at the head of every loop.
fn burn(block: &mut Block, function: &mut Function, fuel: Handle<GlobalVariable>) {
    for statement in block.iter_mut() {
        for inner in blocks_mut(statement) {
            burn(inner, function, fuel);
        }
        let Statement::Loop { body, .. } = statement else { continue };
        let (mut head, left, empty) = gauge(function, fuel);
        head.push(branch(empty, Statement::Break), Span::UNDEFINED);
        let one = function.expressions.append(Expression::Literal(Literal::U32(1)), Span::UNDEFINED);
        let less = Expression::Binary { op: BinaryOperator::Subtract, left, right: one };
        let less = emitted(function, &mut head, less);
        let pointer = function.expressions.append(Expression::GlobalVariable(fuel), Span::UNDEFINED);
        head.push(Statement::Store { pointer, value: less }, Span::UNDEFINED);
        std::mem::swap(body, &mut head);
        body.extend_block(head);
    }
}

/// Puts `if (fuel == 0) return;` behind every call of an entry point: the record is written after.
fn stop(block: &mut Block, function: &mut Function, fuel: Handle<GlobalVariable>) {
    let old = std::mem::take(block);
    for (mut statement, span) in old.span_into_iter() {
        for inner in blocks_mut(&mut statement) {
            stop(inner, function, fuel);
        }
        let call = matches!(statement, Statement::Call { .. });
        block.push(statement, span);
        if call {
            let (head, _, empty) = gauge(function, fuel);
            block.extend_block(head);
            block.push(branch(empty, Statement::Return { value: None }), Span::UNDEFINED);
        }
    }
}

/// Statements that read the fuel, the value read, and whether it is 0.
fn gauge(function: &mut Function, fuel: Handle<GlobalVariable>) -> (Block, Handle<Expression>, Handle<Expression>) {
    let mut block = Block::new();
    let pointer = function.expressions.append(Expression::GlobalVariable(fuel), Span::UNDEFINED);
    let left = emitted(function, &mut block, Expression::Load { pointer });
    let zero = function.expressions.append(Expression::Literal(Literal::U32(0)), Span::UNDEFINED);
    let empty = Expression::Binary { op: BinaryOperator::Equal, left, right: zero };
    let empty = emitted(function, &mut block, empty);
    (block, left, empty)
}

fn emitted(function: &mut Function, block: &mut Block, expression: Expression) -> Handle<Expression> {
    let handle = function.expressions.append(expression, Span::UNDEFINED);
    block.push(Statement::Emit(Range::new_from_bounds(handle, handle)), Span::UNDEFINED);
    handle
}

fn branch(condition: Handle<Expression>, then: Statement) -> Statement {
    Statement::If { condition, accept: Block::from_vec(vec![then]), reject: Block::new() }
}

#[cfg(test)]
mod tests {
    use crate::lower::Target;
    use crate::{Kernel, Program};
    use base::text::SourceFile;
    use syntax::{Shader, Stage};

    fn kernel(body: &str) -> Kernel {
        let file = SourceFile::new("f.glsl", format!("#version 150 core\nfloat f(float a) {{ {body} return a; }}\n"));
        let parsed = Shader::parse(&file, Stage::Library);
        Program::build(&parsed.shader, &Target::Function("f".into())).unwrap().compute_kernel().unwrap()
    }

    fn text(kernel: &Kernel) -> String {
        let flags = naga::back::wgsl::WriterFlags::empty();
        naga::back::wgsl::write_string(&kernel.module, &kernel.info, flags).unwrap()
    }

    #[test]
    fn every_loop_burns_fuel_and_the_record_waits_for_what_is_left() {
        let plain = kernel("for (int i = 0; i < 3; ) for (;;) a += 1.0;");
        let with = text(&plain.clone().with_fuel(500).unwrap());
        assert_eq!(with.matches("sc_fuel = (").count(), 2, "{with}");
        assert!(with.contains("var<private> sc_fuel: u32 = 500u"), "{with}");
        assert!(!text(&plain).contains("sc_fuel"));
    }

    #[test]
    fn a_kernel_without_loops_stays_as_it_is() {
        let plain = kernel("a += 1.0;");
        assert_eq!(text(&plain.clone().with_fuel(500).unwrap()), text(&plain));
    }
}
