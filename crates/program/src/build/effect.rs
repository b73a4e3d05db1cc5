//! Built-in functions that do something: emission, barriers, atomic operations, and those that write
//! through their arguments.

use naga::{AtomicFunction, Barrier, Expression, Statement};

use super::function::{Fun, Val};
use super::{Expr, Result};
use base::text::Span;
use syntax::BuiltinFunction as F;
use syntax::Stage;
use syntax::ast::ExprId;
use syntax::types::{ScalarType, Type};

impl Fun<'_, '_> {
    /// A function with an effect: `None` when it is no such function, else its value.
    pub(super) fn effect(&mut self, function: F, args: &[ExprId], span: Span) -> Result<Option<Option<Val>>> {
        let statement = match function {
            F::EmitVertex | F::EndPrimitive => {
                return self.emit(function == F::EndPrimitive, 0, span).map(|()| Some(None));
            }
            F::EmitStreamVertex | F::EndStreamPrimitive => {
                return self.stream(function, args, span).map(|()| Some(None));
            }
            F::Barrier => Statement::ControlBarrier(Barrier::WORK_GROUP),
            F::MemoryBarrierShared => Statement::MemoryBarrier(Barrier::WORK_GROUP),
            F::MemoryBarrierBuffer => Statement::MemoryBarrier(Barrier::STORAGE),
            F::MemoryBarrierImage => Statement::MemoryBarrier(Barrier::TEXTURE),
            F::MemoryBarrier | F::GroupMemoryBarrier => Statement::MemoryBarrier(Barrier::all()),
            F::Modf | F::Frexp | F::UaddCarry | F::UsubBorrow | F::UmulExtended | F::ImulExtended => {
                return self.several_values(function, args).map(Some);
            }
            F::InterpolateAtCentroid | F::InterpolateAtSample | F::InterpolateAtOffset => {
                let message = format!("`{function}`: interpolation at another place");
                return Err(self.build.unsupported(span, message, "read the input itself"));
            }
            _ if function.name().starts_with("atomic") => {
                return self.atomic(function, args, span).map(|v| Some(Some(v)));
            }
            _ => return Ok(None),
        };
        if matches!(statement, Statement::ControlBarrier(_)) && self.shader.stage() != Stage::Compute {
            let help = "invocations of a patch run one by one here, and know nothing of each other";
            return Err(self.build.unsupported(span, "`barrier` outside of a compute shader", help));
        }
        self.push(statement);
        Ok(Some(None))
    }

    fn atomic(&mut self, function: F, args: &[ExprId], span: Span) -> Result<Val> {
        let place = self.target(args[0])?;
        let ty = place.ty.clone();
        let mut values = Vec::new();
        for &arg in &args[1..] {
            values.push(self.initial(arg, &ty)?.e);
        }
        if !self.build.is_atomic(place.host) {
            let message = format!("`{function}` on this variable");
            return Err(self.build.unsupported(
                span,
                message,
                "use an `int` or `uint` of a block or a shared variable",
            ));
        }
        self.atomic_at(function, place.ptr, &ty, &values, span)
    }

    /// An atomic function on an integer in memory; it gives the value before.
    pub(super) fn atomic_at(
        &mut self,
        function: F,
        pointer: Expr,
        ty: &Type,
        values: &[Expr],
        span: Span,
    ) -> Result<Val> {
        let unknown = || format!("the function `{function}`");
        let (Some(&value), true) = (values.last(), ty.scalar().is_some_and(ScalarType::is_integer)) else {
            return Err(self.build.unsupported(span, unknown(), "write it out"));
        };
        let mut compared = false;
        let fun = match function {
            F::AtomicAdd | F::ImageAtomicAdd | F::AtomicCounterAdd => AtomicFunction::Add,
            F::AtomicCounterSubtract => AtomicFunction::Subtract,
            F::AtomicMin | F::ImageAtomicMin | F::AtomicCounterMin => AtomicFunction::Min,
            F::AtomicMax | F::ImageAtomicMax | F::AtomicCounterMax => AtomicFunction::Max,
            F::AtomicAnd | F::ImageAtomicAnd | F::AtomicCounterAnd => AtomicFunction::And,
            F::AtomicOr | F::ImageAtomicOr | F::AtomicCounterOr => AtomicFunction::InclusiveOr,
            F::AtomicXor | F::ImageAtomicXor | F::AtomicCounterXor => AtomicFunction::ExclusiveOr,
            F::AtomicExchange | F::ImageAtomicExchange | F::AtomicCounterExchange => {
                AtomicFunction::Exchange { compare: None }
            }
            F::AtomicCompSwap | F::ImageAtomicCompSwap | F::AtomicCounterCompSwap if values.len() == 2 => {
                compared = true;
                AtomicFunction::Exchange { compare: Some(values[0]) }
            }
            _ => return Err(self.build.unsupported(span, unknown(), "write it out")),
        };
        let handle = self.ty(ty)?;
        let result_ty = if compared {
            let number = super::types::scalar(ty.scalar().unwrap_or(ScalarType::Uint));
            let structure = naga::PredeclaredType::AtomicCompareExchangeWeakResult(number);
            self.build.module.generate_predeclared_type(structure)
        } else {
            handle
        };
        let result = self.add(Expression::AtomicResult { ty: result_ty, comparison: compared });
        self.push(Statement::Atomic { pointer, fun, value, result: Some(result) });
        let e = if compared { self.add(Expression::AccessIndex { base: result, index: 0 }) } else { result };
        Ok(Val { e, ty: Type::Scalar(ty.scalar().unwrap_or(ScalarType::Uint)) })
    }
}
