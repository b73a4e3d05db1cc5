//! Entry points whose arguments are numbers and vectors, as a host sees them: structures are put together inside.

use naga::{EntryPoint, Expression, Function, FunctionArgument, Handle, Module, Span, Statement, Type, TypeInner};

use super::stops::{StopStep, Stops};
use crate::capture::Builder;

type Expr = Handle<Expression>;

/// An argument of the author's function: its type, and how many of the flat arguments make it, if it is a structure.
type Whole = (Handle<Type>, Option<usize>);

/// Makes an entry point that takes a structure flat; any other stays as it is.
pub(crate) fn flat_if_needed(module: &mut Module) {
    let takes = |point: &EntryPoint| point.function.arguments.iter().any(|argument| argument.binding.is_none());
    if module.entry_points.first().is_some_and(takes) {
        let own = apart(module);
        around(module, own, None);
    }
}

/// Makes the author's function of the only entry point an ordinary one, under the same name.
pub(super) fn apart(module: &mut Module) -> Handle<Function> {
    let EntryPoint { name, function, .. } = &mut module.entry_points[0];
    let mut inner = function.clone();
    inner.name = Some(inner.name.take().unwrap_or_else(|| name.clone()));
    // The entry point keeps its arguments and its result, with their bindings.
    inner.arguments.iter_mut().for_each(|argument| argument.binding = None);
    inner.result.iter_mut().for_each(|result| result.binding = None);
    let (expressions, locals) = (naga::Arena::new(), naga::Arena::new());
    *function = Function { expressions, local_variables: locals, body: naga::Block::new(), ..function.clone() };
    function.named_expressions.clear();
    module.functions.append(inner, Span::UNDEFINED)
}

/// Makes the only entry point a function that calls `own` with what its flat arguments hold.
pub(super) fn around(module: &mut Module, own: Handle<Function>, stops: Option<&Stops>) {
    let EntryPoint { name, function, stage, .. } = &module.entry_points[0];
    let (name, result, stage) = (name.clone(), function.result.clone(), *stage);
    let mut arguments: Vec<FunctionArgument> = Vec::new();
    let mut wholes: Vec<Whole> = Vec::new();
    for argument in &function.arguments {
        match &module.types[argument.ty].inner {
            TypeInner::Struct { members, .. } if argument.binding.is_none() => {
                wholes.push((argument.ty, Some(members.len())));
                arguments.extend(members.iter().map(|member| {
                    let (name, binding) = (member.name.clone(), member.binding.clone());
                    FunctionArgument { name, ty: member.ty, binding }
                }));
            }
            _ => {
                wholes.push((argument.ty, None));
                arguments.push(argument.clone());
            }
        }
    }
    let mut b = Builder::new();
    let given: Vec<Expr> = (0..arguments.len() as u32).map(|k| b.argument(k)).collect();
    let call = |b: &mut Builder, given: &[Expr]| {
        let mut rest = given;
        let mut passed = Vec::new();
        for (ty, count) in &wholes {
            let (own, others) = rest.split_at(count.unwrap_or(1));
            rest = others;
            passed.push(match count {
                Some(_) => b.compute(Expression::Compose { ty: *ty, components: own.to_vec() }),
                None => own[0],
            });
        }
        let value = result.as_ref().map(|_| b.name(Expression::CallResult(own)));
        b.statement(Statement::Call { function: own, arguments: passed, result: value });
        value
    };
    let value = match stops {
        None => call(&mut b, &given),
        Some(stops) => {
            let step = |argument: &FunctionArgument| StopStep::of_input(module, argument, stage);
            let steps: Vec<StopStep> = arguments.iter().map(step).collect();
            let returned = result.as_ref().map(|result| result.ty);
            stops.run(&mut b, module, (&given, &steps), returned, &call)
        }
    };
    b.statement(Statement::Return { value });
    module.entry_points[0].function = b.finish(&name, arguments, result);
}
