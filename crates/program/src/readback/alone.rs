//! A stage as something that runs by itself, for a comparison of two modules of one shader.
//!
//! What only a device has becomes an ordinary operation, in the same way on both sides: a derivative becomes a function
//! of its operand, another one for each axis; `discard` sets a flag and leaves the function; storage and shared memory
//! become variables, and nobody waits for others. Two modules that agree so are told apart by nothing but what the
//! device makes of these operations.

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{
    AddressSpace, Block, DerivativeAxis, Expression, Function, GlobalVariable, Handle, Literal, MathFunction, Module,
    ResourceBinding, Scalar, ShaderStage, Span, Statement, Type, TypeInner,
};

use crate::memory::{LENGTH, plain, without_atomics};
use crate::{ProgramError, capture, contain};

/// What a stage has beside its inputs and outputs.
#[derive(Clone, Debug)]
pub(super) struct Alone {
    /// 1 behind a `discard`, else 0.
    pub discarded: Handle<GlobalVariable>,
    /// Storage buffers, with the bindings that they had.
    pub storage: Vec<(Handle<GlobalVariable>, ResourceBinding)>,
}

/// Makes the first entry point of a module run by itself.
pub(super) fn alone(module: &mut Module) -> Result<(Alone, ModuleInfo), ProgramError> {
    let storage = memory(module);
    let word = module.types.insert(Type { name: None, inner: TypeInner::Scalar(Scalar::U32) }, Span::UNDEFINED);
    let discarded = capture::add_global(module, "sc_discarded", AddressSpace::Private, None, word);
    zeroed(module);
    let Module { ref mut functions, ref mut entry_points, .. } = *module;
    let points = entry_points.iter_mut().map(|point| &mut point.function);
    for function in functions.iter_mut().map(|(_, function)| function).chain(points) {
        without_atomics(function)?;
        operations(function);
        let mut body = std::mem::take(&mut function.body);
        statements(&mut body, function, discarded);
        function.body = body;
    }
    if let Some(point) = module.entry_points.first_mut() {
        let mut start = Block::new();
        set(&mut start, &mut point.function, discarded, 0);
        start.extend_block(std::mem::take(&mut point.function.body));
        point.function.body = start;
    }
    // Operations stand in places where those that they replace are told; the rules about places do not matter here.
    let mut validator = Validator::new(ValidationFlags::empty(), Capabilities::all());
    let info = contain(|| validator.validate(module).map_err(Box::new))
        .map_err(|panic| ProgramError::internal(format!("naga panicked: {panic}")))?
        .map_err(|error| ProgramError::internal(format!("{:?}", error.into_inner())))?;
    Ok((Alone { discarded, storage }, info))
}

/// Storage buffers and, in a compute stage, shared memory become variables.
fn memory(module: &mut Module) -> Vec<(Handle<GlobalVariable>, ResourceBinding)> {
    let compute = module.entry_points.first().is_some_and(|point| point.stage == ShaderStage::Compute);
    let mut storage = Vec::new();
    let all: Vec<Handle<GlobalVariable>> = module.global_variables.iter().map(|(handle, _)| handle).collect();
    for handle in all {
        let variable = module.global_variables[handle].clone();
        match (variable.space, variable.binding) {
            (AddressSpace::Storage { .. }, Some(binding))
                if !matches!(module.types[variable.ty].inner, TypeInner::BindingArray { .. }) =>
            {
                storage.push((handle, binding));
            }
            (AddressSpace::WorkGroup, _) if compute => {}
            _ => continue,
        }
        let ty = plain(module, variable.ty);
        module.global_variables[handle] =
            GlobalVariable { space: AddressSpace::Private, binding: None, ty, ..variable };
    }
    storage
}

/// Variables begin as zero, so that an entry point that hands on what a discarded fragment has not written comes upon
/// nothing undefined.
fn zeroed(module: &mut Module) {
    let Module { ref mut global_variables, ref mut global_expressions, .. } = *module;
    for (_, variable) in global_variables.iter_mut().filter(|(_, v)| v.space == AddressSpace::Private) {
        let zero = || global_expressions.append(Expression::ZeroValue(variable.ty), Span::UNDEFINED);
        variable.init = Some(variable.init.unwrap_or_else(zero));
    }
}

fn operations(function: &mut Function) {
    for (_, expression) in function.expressions.iter_mut() {
        match *expression {
            Expression::Derivative { axis, expr, .. } => {
                let fun = match axis {
                    DerivativeAxis::X => MathFunction::Sin,
                    DerivativeAxis::Y => MathFunction::Cos,
                    DerivativeAxis::Width => MathFunction::Atan,
                };
                *expression = Expression::Math { fun, arg: expr, arg1: None, arg2: None, arg3: None };
            }
            Expression::ArrayLength(_) => *expression = Expression::Literal(Literal::U32(LENGTH)),
            _ => {}
        }
    }
}

/// Replaces `discard` and barriers.
fn statements(block: &mut Block, function: &mut Function, discarded: Handle<GlobalVariable>) {
    let mut changed = Block::new();
    for (mut statement, span) in std::mem::take(block).span_into_iter() {
        match &mut statement {
            Statement::Block(inner) => statements(inner, function, discarded),
            Statement::If { accept, reject, .. } => {
                statements(accept, function, discarded);
                statements(reject, function, discarded);
            }
            Statement::Loop { body, continuing, .. } => {
                statements(body, function, discarded);
                statements(continuing, function, discarded);
            }
            Statement::Switch { cases, .. } => {
                for case in cases {
                    statements(&mut case.body, function, discarded);
                }
            }
            Statement::ControlBarrier(_) => continue,
            Statement::Kill => {
                set(&mut changed, function, discarded, 1);
                let zero = function.result.as_ref().map(|result| Expression::ZeroValue(result.ty));
                let value = zero.map(|zero| function.expressions.append(zero, span));
                statement = Statement::Return { value };
            }
            _ => {}
        }
        changed.push(statement, span);
    }
    *block = changed;
}

fn set(block: &mut Block, function: &mut Function, global: Handle<GlobalVariable>, value: u32) {
    let pointer = function.expressions.append(Expression::GlobalVariable(global), Span::UNDEFINED);
    let value = function.expressions.append(Expression::Literal(Literal::U32(value)), Span::UNDEFINED);
    block.push(Statement::Store { pointer, value }, Span::UNDEFINED);
}
