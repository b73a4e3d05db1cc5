//! Entry points whose arguments are numbers and vectors, as a host sees them: structures are put together inside.

use naga::{EntryPoint, Expression, Function, FunctionArgument, Handle, Module, Span, Statement, TypeInner};

use crate::capture::Builder;

/// The same for an entry point that takes a structure; any other stays as it is.
pub(crate) fn flat_if_needed(module: &mut Module) {
    let takes = |point: &EntryPoint| point.function.arguments.iter().any(|argument| argument.binding.is_none());
    if module.entry_points.first().is_some_and(takes) {
        flat(module, 0);
    }
}

/// Makes the entry point a function that the new entry point calls, whose arguments have a binding each. Gives the
/// function. Values behind those of the module keep their handles.
pub(crate) fn flat(module: &mut Module, index: usize) -> Handle<Function> {
    let EntryPoint { name, function: inner, .. } = &mut module.entry_points[index];
    let mut inner = std::mem::take(inner);
    let name = name.clone();
    let mut b = Builder::new();
    let mut arguments = Vec::new();
    let mut passed = Vec::new();
    for argument in &mut inner.arguments {
        let mut take = |b: &mut Builder, argument: FunctionArgument| {
            arguments.push(argument);
            b.argument(arguments.len() as u32 - 1)
        };
        passed.push(match &module.types[argument.ty].inner {
            TypeInner::Struct { members, .. } if argument.binding.is_none() => {
                let mut components = Vec::new();
                for member in members {
                    let (name, binding) = (member.name.clone(), member.binding.clone());
                    components.push(take(&mut b, FunctionArgument { name, ty: member.ty, binding }));
                }
                b.compute(Expression::Compose { ty: argument.ty, components })
            }
            _ => take(&mut b, argument.clone()),
        });
        argument.binding = None;
    }
    let result = inner.result.clone();
    if let Some(result) = &mut inner.result {
        result.binding = None;
    }
    if inner.name.is_none() {
        inner.name = Some(name.clone());
    }
    let function = module.functions.append(inner, Span::UNDEFINED);
    let value = result.is_some().then(|| b.name(Expression::CallResult(function)));
    b.statement(Statement::Call { function, arguments: passed, result: value });
    b.statement(Statement::Return { value });
    module.entry_points[index].function = b.finish(&name, arguments, result);
    function
}
