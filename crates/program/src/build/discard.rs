//! `discard` in the module that is run: the invocation leaves all its functions, its outputs become zeros,
//! and that it was discarded is an output of its own. So every lane gives it, and it is judged like all else.

use naga::{AddressSpace, Expression, GlobalVariable, Handle, Literal, Statement, TypeInner};

use super::function::Fun;
use super::{Build, Expr, Result};
use crate::{Port, PortAt, capture};
use base::text::Span;
use base::value::{Field, Scalar, Shape};
use syntax::types::Type;

/// Name of the output that tells whether the invocation was discarded; no variable can be called so.
pub const DISCARD: &str = "discard";

impl Build<'_> {
    fn discarded(&mut self) -> Handle<GlobalVariable> {
        if let Some(handle) = self.leaving.discard {
            return handle;
        }
        let ty = self.insert(None, TypeInner::Scalar(naga::Scalar::BOOL));
        let handle = capture::add_global(&mut self.module, "sc_discarded", AddressSpace::Private, None, ty);
        self.leaving.discard = Some(handle);
        handle
    }

    /// Adds the output, where the shader discards.
    pub(super) fn discard_output(&mut self) {
        let Some(handle) = self.leaving.discard.filter(|_| self.leaving.discards) else { return };
        let field = Field { name: DISCARD.to_owned(), shape: Shape::vector(Scalar::Bool, 1) };
        let ty = self.module.global_variables[handle].ty;
        self.ports.outputs.push(Port { field, ty, at: PortAt::Global(handle), backing: None });
    }
}

impl Fun<'_, '_> {
    /// `discard`
    pub(super) fn discard(&mut self, span: Span) -> Result<()> {
        self.build.differs = true;
        self.build.leaving.discards = true;
        self.stop(span)
    }

    /// Leaves all functions.
    pub(super) fn stop(&mut self, span: Span) -> Result<()> {
        self.set_discarded(true);
        self.leave(span)
    }

    fn set_discarded(&mut self, value: bool) {
        let handle = self.build.discarded();
        let pointer = self.add(Expression::GlobalVariable(handle));
        let value = self.add(Expression::Literal(Literal::Bool(value)));
        self.push(Statement::Store { pointer, value });
    }

    /// Before anything is run.
    pub(super) fn not_discarded(&mut self) {
        if self.build.leaving.discard.is_some() {
            self.set_discarded(false);
        }
    }

    /// Leaves the function.
    fn leave(&mut self, span: Span) -> Result<()> {
        self.stops = true;
        if self.in_step {
            let what = "a function that discards, called in the step of a loop,";
            self.build.ports.unfed.push((what.to_owned(), span));
            return Ok(());
        }
        let value = match self.result.clone() {
            Type::Void => None,
            ty => {
                let ty = self.build.value_type(&ty, span)?;
                Some(self.add(Expression::ZeroValue(ty)))
            }
        };
        self.push(Statement::Return { value });
        Ok(())
    }

    fn was_discarded(&mut self) -> Option<Expr> {
        let handle = self.build.leaving.discard?;
        let pointer = self.add(Expression::GlobalVariable(handle));
        Some(self.add(Expression::Load { pointer }))
    }

    /// Behind a call of a function that may discard.
    pub(super) fn leave_if_discarded(&mut self, span: Span) -> Result<()> {
        let Some(condition) = self.was_discarded() else { return Ok(()) };
        self.branch(condition, |f| f.leave(span), |_| Ok(()))
    }

    /// The outputs of a stage become zeros.
    pub(super) fn clear_if_discarded(&mut self) -> Result<()> {
        let mut all: Vec<Handle<GlobalVariable>> = self.build.ports.outgoing.iter().map(|o| o.from).collect();
        for port in self.build.ports.outputs.iter().chain(&self.build.ports.built_in_outputs) {
            match port.at {
                PortAt::Global(handle) | PortAt::Member(handle, _) | PortAt::Part { global: handle, .. } => {
                    all.push(handle);
                }
                PortAt::Argument(_)
                | PortAt::Reference(_)
                | PortAt::Arguments { .. }
                | PortAt::Result
                | PortAt::ResultMember(_)
                | PortAt::Vertices { .. } => {}
            }
        }
        all.sort_by_key(|handle| handle.index());
        all.dedup();
        let Some(condition) = self.was_discarded() else { return Ok(()) };
        self.branch(
            condition,
            |f| {
                for handle in all {
                    let ty = f.build.module.global_variables[handle].ty;
                    let pointer = f.add(Expression::GlobalVariable(handle));
                    let value = f.add(Expression::ZeroValue(ty));
                    f.push(Statement::Store { pointer, value });
                }
                Ok(())
            },
            |_| Ok(()),
        )
    }

    /// What a function gives becomes zeros.
    pub(super) fn zeros_if_discarded(
        &mut self,
        arguments: &[Expr],
        types: &[Handle<naga::Type>],
        result: Option<Handle<naga::Type>>,
    ) -> Result<()> {
        let Some(condition) = self.was_discarded() else { return Ok(()) };
        self.branch(
            condition,
            |f| {
                for (&pointer, &ty) in arguments.iter().zip(types) {
                    let TypeInner::Pointer { base, .. } = f.build.module.types[ty].inner else { continue };
                    let value = f.add(Expression::ZeroValue(base));
                    f.push(Statement::Store { pointer, value });
                }
                let value = result.map(|ty| f.add(Expression::ZeroValue(ty)));
                f.push(Statement::Return { value });
                Ok(())
            },
            |_| Ok(()),
        )
    }
}
