//! One function of a shader as a program.

use naga::{Expression, Statement};

use super::function::Fun;
use super::place::Var;
use super::{Build, Expr, Result};
use crate::lower::Role;
use crate::{Entry, Port, PortAt};
use base::text::Span;
use base::value::Field;
use syntax::symbols::{Direction, FunctionId};
use syntax::types::Type;

impl Build<'_> {
    pub(super) fn single(&mut self, name: &str) -> Result<(Entry, Role)> {
        let shader = self.shader;
        let mut found = shader.functions().filter(|(_, f)| f.name.name == name && f.definition.is_some());
        let Some((id, info)) = found.next() else {
            let known: Vec<&str> = shader.functions().map(|(_, f)| f.name.name.as_str()).collect();
            let help = format!("the file defines: {}", known.join(", "));
            return Err(self.incomplete(Span::at(0), &format!("there is no function `{name}`"), &help));
        };
        if let Some((_, other)) = found.next() {
            return Err(self.unsupported(other.name.span, format!("`{name}`, which is overloaded,"), "rename one"));
        }
        // Outputs of a stage are nothing that a function gives back.
        self.ports.outputs.clear();
        self.ports.inputs.clear();
        let mut handle = self.function(id, Vec::new(), info.name.span)?;
        if !self.made.initial.is_empty() || self.leaving.discard.is_some() {
            handle = self.around(handle, id, name)?;
        }
        self.ports.built_ins.clear();
        self.ports.drawn.clear();
        self.ports.built_in_outputs.clear();
        self.ports.inputs.clear();
        self.ports.outputs.clear();
        if info.return_type != Type::Void {
            self.parameter("return", &info.return_type, PortAt::Result, info.name.span, false)?;
        }
        for (k, param) in info.params.iter().enumerate() {
            let Some(ident) = &param.name else {
                return Err(self.unsupported(param.span, "a parameter without name", "give it a name"));
            };
            let k = u32::try_from(k).unwrap_or(0);
            let at = if param.direction == Direction::In { PortAt::Argument(k) } else { PortAt::Reference(k) };
            if param.direction != Direction::Out {
                self.parameter(&ident.name, &param.ty, at.clone(), ident.span, true)?;
            }
            if param.direction != Direction::In {
                self.parameter(&ident.name, &param.ty, at, ident.span, false)?;
            }
        }
        self.discard_output();
        if self.ports.outputs.is_empty() {
            self.ports.unfed.push((format!("`{name}`, which gives nothing back,"), info.name.span));
        }
        Ok((Entry::Function(handle), Role::Function { name: name.to_owned() }))
    }

    fn parameter(&mut self, name: &str, ty: &Type, at: PortAt, span: Span, input: bool) -> Result<()> {
        let Some(shape) = ty.shape() else {
            self.ports.unfed.push((format!("`{name}` of type `{ty}`"), span));
            return Ok(());
        };
        let ty = self.value_type(ty, span)?;
        let port = Port { field: Field { name: name.to_owned(), shape }, ty, at, backing: None };
        if input { &mut self.ports.inputs } else { &mut self.ports.outputs }.push(port);
        Ok(())
    }

    /// A function around another one that sets the variables at file scope first, and gives zeros where
    /// it is discarded.
    fn around(
        &mut self,
        inner: naga::Handle<naga::Function>,
        id: FunctionId,
        name: &str,
    ) -> Result<naga::Handle<naga::Function>> {
        let (arguments, result) = {
            let function = &self.module.functions[inner];
            (function.arguments.clone(), function.result.clone())
        };
        let initial = self.made.initial.clone();
        let mut f = Fun::new(self, Type::Void);
        for (symbol, value) in initial {
            f.at = f.shader.expr(value).span;
            if let Var::Place(place) = f.symbol(symbol, f.at)? {
                let value = f.initial(value, &place.ty)?;
                f.store(&place, &value)?;
            }
        }
        let mut passed = Vec::new();
        for k in 0..arguments.len() {
            // Pointers are passed on as they are.
            passed.push(f.add(Expression::FunctionArgument(u32::try_from(k).unwrap_or(0))));
        }
        let sites = f.build.leaving.sites.get(&inner).copied().unwrap_or(0);
        let value = if sites > 0 {
            f.call_quads(inner, id, sites, &passed)?
        } else {
            f.not_discarded();
            let value = result.is_some().then(|| f.add(Expression::CallResult(inner)));
            f.push(Statement::Call { function: inner, arguments: passed.clone(), result: value });
            value
        };
        let types: Vec<_> = arguments.iter().map(|a| a.ty).collect();
        f.zeros_if_discarded(&passed, &types, result.as_ref().map(|r| r.ty))?;
        f.push(Statement::Return { value });
        let outer = f.finish(name, arguments, result);
        self.module.functions[inner].name = Some(format!("{name}_body"));
        Ok(self.module.functions.append(outer, naga::Span::UNDEFINED))
    }
}

impl Fun<'_, '_> {
    /// Calls a function that comes to derivatives for the members of a quad, each time with its own arguments.
    /// Gives its value for the sample itself.
    fn call_quads(
        &mut self,
        inner: naga::Handle<naga::Function>,
        id: FunctionId,
        sites: u32,
        passed: &[Expr],
    ) -> Result<Option<Expr>> {
        let info = self.shader.function_info(id);
        let span = info.name.span;
        let parameters: Vec<_> = info.params.iter().filter(|p| !p.ty.contains_opaque()).collect();
        let returned = match &info.return_type {
            Type::Void => None,
            ty => Some(self.local("sc_returned", ty)?),
        };
        // What goes in and out is given anew each time.
        let mut before = Vec::new();
        for (param, &pointer) in parameters.iter().zip(passed) {
            before.push(match param.direction {
                Direction::In => Some(pointer),
                Direction::InOut => Some(self.add(Expression::Load { pointer })),
                Direction::Out => None,
            });
        }
        self.run_quads(sites, span, &mut |f, member| {
            let mut number = 0;
            let mut arguments = Vec::new();
            for ((param, &pointer), before) in parameters.iter().zip(passed).zip(&before) {
                let value = match before {
                    Some(before) => Some(f.stepped_parameter(member, *before, &param.ty, &mut number)?),
                    None => None,
                };
                match (param.direction, value) {
                    (Direction::In, Some(value)) => arguments.push(value),
                    (Direction::InOut, Some(value)) => {
                        f.push(Statement::Store { pointer, value });
                        arguments.push(pointer);
                    }
                    (Direction::In | Direction::InOut | Direction::Out, _) => arguments.push(pointer),
                }
            }
            f.not_discarded();
            let result = returned.is_some().then(|| f.add(Expression::CallResult(inner)));
            f.push(Statement::Call { function: inner, arguments, result });
            if let (Some(place), Some(value)) = (&returned, result) {
                f.push(Statement::Store { pointer: place.ptr, value });
            }
            Ok(())
        })?;
        Ok(returned.map(|place| self.add(Expression::Load { pointer: place.ptr })))
    }
}
