//! Calls of the shader's own functions, and these functions.

use naga::{AddressSpace, Expression, FunctionArgument, FunctionResult, Handle, Statement, TypeInner};

use super::function::{Fun, Val};
use super::place::{Lvalue, Var};
use super::texture::Opaque;
use super::{Build, Result};
use base::text::Span;
use syntax::ast::ExprId;
use syntax::symbols::{Direction, FunctionId};
use syntax::types::Type;

impl Fun<'_, '_> {
    pub(super) fn user_call(&mut self, function: FunctionId, args: &[ExprId], span: Span) -> Result<Option<Val>> {
        let info = self.shader.function_info(function);
        let opaque = info.params.iter().zip(args).filter(|(param, _)| param.ty.contains_opaque());
        if let Some(index) = opaque.into_iter().find_map(|(_, &arg)| self.computed_index(arg)) {
            return self.choose(&info.return_type, index, &mut |f| f.user_call(function, args, span));
        }
        let mut arguments = Vec::new();
        let mut opaques = Vec::new();
        let mut back: Vec<(Lvalue, Lvalue)> = Vec::new();
        for (param, &arg) in info.params.iter().zip(args) {
            if param.ty.contains_opaque() {
                let Some(opaque) = self.opaque(arg)? else {
                    let span = self.shader.expr(arg).span;
                    return Err(self.build.unsupported(span, "a sampler that is computed", "name a uniform"));
                };
                opaques.push(opaque);
                continue;
            }
            match param.direction {
                Direction::In => arguments.push(self.initial(arg, &param.ty)?.e),
                // Values are copied in before and out behind the call (GLSL 4.60, 6.1.1).
                Direction::Out | Direction::InOut => {
                    let target = self.target(arg)?;
                    let local = self.local("sc_argument", &param.ty)?;
                    if param.direction == Direction::InOut {
                        let value = self.load(&target)?;
                        let value = self.convert(value, &param.ty)?;
                        self.store(&local, &value)?;
                    }
                    arguments.push(local.ptr);
                    back.push((local, target));
                }
            }
        }
        let handle = self.build.function(function, opaques, span)?;
        let sites = self.build.leaving.sites.get(&handle).copied().unwrap_or(0);
        self.before_call(sites, true);
        let returns = info.return_type != Type::Void;
        let result = returns.then(|| self.add(Expression::CallResult(handle)));
        self.push(Statement::Call { function: handle, arguments, result });
        self.before_call(sites, false);
        self.sites = self.sites.saturating_add(sites);
        if sites > 0 && self.in_loop {
            self.build.ports.unfed.push(("a derivative in a loop".to_owned(), span));
        }
        if self.build.leaving.stopping.contains(&handle) {
            self.leave_if_discarded(span)?;
        }
        for (local, target) in back {
            let value = self.load(&local)?;
            let value = self.convert(value, &target.ty)?;
            self.store(&target, &value)?;
        }
        Ok(result.map(|e| Val { e, ty: info.return_type.clone() }))
    }
}

impl Build<'_> {
    /// The function, once for each set of samplers that it is called with.
    pub(super) fn function(
        &mut self,
        id: FunctionId,
        opaques: Vec<Opaque>,
        span: Span,
    ) -> Result<Handle<naga::Function>> {
        let key = (id, opaques.iter().map(|o| o.key.clone()).collect::<Vec<_>>());
        if let Some(&handle) = self.made.functions.get(&key) {
            return Ok(handle);
        }
        let shader = self.shader;
        let info = shader.function_info(id);
        let name = info.name.name.clone();
        if self.made.active.contains(&id) {
            return Err(self.unsupported(span, format!("`{name}`, which calls itself"), "write a loop"));
        }
        let Some(body) = shader.function_syntax(info).and_then(|f| f.body.as_ref()) else {
            let help = "put the text that defines it before this one";
            return Err(self.unsupported(span, format!("`{name}`, which is declared and never defined,"), help));
        };
        self.made.active.push(id);
        let mut f = Fun::new(self, info.return_type.clone());
        f.at = info.name.span;
        let mut arguments = Vec::new();
        let mut opaques = opaques.into_iter();
        for param in &info.params {
            if param.ty.contains_opaque() {
                if let (Some(symbol), Some(opaque)) = (param.symbol, opaques.next()) {
                    f.names.insert(symbol, Var::Opaque(opaque));
                }
                continue;
            }
            let value = f.build.value_type(&param.ty, param.span)?;
            f.at = param.span;
            let index = u32::try_from(arguments.len()).unwrap_or(u32::MAX);
            let by_reference = param.direction != Direction::In;
            let ty = if by_reference {
                f.build.insert(None, TypeInner::Pointer { base: value, space: AddressSpace::Function })
            } else {
                value
            };
            let name = param.name.as_ref().map(|n| n.name.clone());
            arguments.push(FunctionArgument { name: name.clone(), ty, binding: None });
            let Some(symbol) = param.symbol else { continue };
            let argument = f.add(Expression::FunctionArgument(index));
            let var = if by_reference {
                Var::Place(Lvalue { ptr: argument, ty: param.ty.clone(), host: value, swizzle: None })
            } else {
                let value = Val { e: argument, ty: param.ty.clone() };
                let small = matches!(param.ty, Type::Scalar(_) | Type::Vector(..));
                if small && !shader.is_written(symbol) {
                    Var::Value(value)
                } else {
                    let place = f.local(name.as_deref().unwrap_or("sc_argument"), &param.ty)?;
                    f.store(&place, &value)?;
                    Var::Place(place)
                }
            };
            f.names.insert(symbol, var);
        }
        f.statements(&body.statements)?;
        f.at = body.span;
        f.end()?;
        let result = match &info.return_type {
            Type::Void => None,
            ty => Some(FunctionResult { ty: f.build.value_type(ty, info.name.span)?, binding: None }),
        };
        let (stops, sites) = (f.stops, f.sites);
        let function = f.finish(&name, arguments, result);
        let handle = self.module.functions.append(function, super::naga_span(info.name.span));
        if stops {
            self.leaving.stopping.insert(handle);
        }
        if sites > 0 {
            self.leaving.sites.insert(handle, sites);
        }
        self.made.active.pop();
        self.made.functions.insert(key, handle);
        Ok(handle)
    }
}
