//! One function of a shader as a program.

use naga::{Expression, Statement};

use super::function::Fun;
use super::place::Var;
use super::{Build, Result};
use crate::glsl::symbols::Direction;
use crate::glsl::types::Type;
use crate::lower::Role;
use crate::program::{Entry, Port, PortAt};
use crate::text::Span;
use crate::value::Field;

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
        self.outputs.clear();
        self.inputs.clear();
        let mut handle = self.function(id, Vec::new(), info.name.span)?;
        if !self.initial.is_empty() {
            handle = self.with_initial_values(handle, name)?;
        }
        self.built_ins.clear();
        self.built_in_outputs.clear();
        self.inputs.clear();
        self.outputs.clear();
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
        if self.outputs.is_empty() {
            self.unfed.push((format!("`{name}`, which gives nothing back,"), info.name.span));
        }
        Ok((Entry::Function(handle), Role::Function { name: name.to_owned() }))
    }

    fn parameter(&mut self, name: &str, ty: &Type, at: PortAt, span: Span, input: bool) -> Result<()> {
        let Some(shape) = ty.shape() else {
            self.unfed.push((format!("`{name}` of type `{ty}`"), span));
            return Ok(());
        };
        let ty = self.value_type(ty, span)?;
        let port = Port { field: Field { name: name.to_owned(), shape }, ty, at, backing: None };
        if input { &mut self.inputs } else { &mut self.outputs }.push(port);
        Ok(())
    }

    /// A function around another one that sets the variables at file scope first.
    fn with_initial_values(
        &mut self,
        inner: naga::Handle<naga::Function>,
        name: &str,
    ) -> Result<naga::Handle<naga::Function>> {
        let (arguments, result) = {
            let function = &self.module.functions[inner];
            (function.arguments.clone(), function.result.clone())
        };
        let initial = self.initial.clone();
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
        let value = result.is_some().then(|| f.add(Expression::CallResult(inner)));
        f.push(Statement::Call { function: inner, arguments: passed, result: value });
        f.push(Statement::Return { value });
        let outer = f.finish(name, arguments, result);
        self.module.functions[inner].name = Some(format!("{name}_body"));
        Ok(self.module.functions.append(outer, naga::Span::UNDEFINED))
    }
}
