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

/// `gl_ScopeSubgroup`.
const SCOPE_SUBGROUP: u32 = 3;

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
            F::MemoryBarrier if !args.is_empty() => Statement::MemoryBarrier(self.kinds_of_memory(args[1])),
            F::MemoryBarrier | F::GroupMemoryBarrier => Statement::MemoryBarrier(Barrier::all()),
            F::ControlBarrier => {
                let memory = self.kinds_of_memory(args[2]);
                let of_subgroup = self.build.known_number(args[0]) == Some(SCOPE_SUBGROUP);
                Statement::ControlBarrier(if of_subgroup { Barrier::SUB_GROUP } else { memory })
            }
            F::Modf | F::Frexp | F::UaddCarry | F::UsubBorrow | F::UmulExtended | F::ImulExtended => {
                return self.several_values(function, args).map(Some);
            }
            F::InterpolateAtCentroid | F::InterpolateAtSample | F::InterpolateAtOffset => {
                let message = format!("`{function}`: interpolation at another place");
                return Err(self.build.unsupported(span, message, "read the input itself"));
            }
            _ if function.name().starts_with("atomic") => {
                return self.atomic(function, args, span).map(Some);
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

    /// Kinds of memory by the constants of GL_KHR_memory_scope_semantics; all of them where the number is not known.
    fn kinds_of_memory(&self, storage: ExprId) -> Barrier {
        let Some(bits) = self.build.known_number(storage) else { return Barrier::all() };
        let kinds = [(0x40, Barrier::STORAGE), (0x100, Barrier::WORK_GROUP), (0x800, Barrier::TEXTURE)];
        kinds.into_iter().filter(|(bit, _)| bits & bit != 0).fold(Barrier::empty(), |all, (_, kind)| all | kind)
    }

    fn atomic(&mut self, function: F, args: &[ExprId], span: Span) -> Result<Option<Val>> {
        let place = self.target(args[0])?;
        let ty = place.ty.clone();
        // Behind the values may stand a scope, a kind of memory and its order.
        let count = match function {
            F::AtomicLoad => 0,
            F::AtomicCompSwap | F::AtomicCounterCompSwap => 2,
            _ => 1,
        };
        let mut values = Vec::new();
        for &arg in args[1..].iter().take(count) {
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
        match (function, values.as_slice()) {
            (F::AtomicLoad, _) => {
                let e = self.add(Expression::Load { pointer: place.ptr });
                Ok(Some(Val { e, ty }))
            }
            (F::AtomicStore, &[value]) => {
                self.push(Statement::Store { pointer: place.ptr, value });
                Ok(None)
            }
            _ => self.atomic_at(function, place.ptr, &ty, &values, span).map(Some),
        }
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
