//! A function by itself: structures are taken apart, so that only numbers, vectors, matrices and arrays of them go in
//! and come out.

use naga::{
    AddressSpace, Expression, Function, FunctionArgument, GlobalVariable, Handle, MathFunction, Module, Span,
    Statement, Type, TypeInner,
};

use super::outline::Way;
use super::ports::{Part, Ports, at, parts};
use super::stops::{self, StopStep, Stops};
use crate::capture::{Builder, add_global, shape_of};
use crate::{Port, PortAt, ProgramError};
use base::value::Field;

/// What goes in and comes out, and what is run.
pub(super) struct Alone {
    pub function: Handle<Function>,
    pub inputs: Vec<Port>,
    pub outputs: Vec<Port>,
}

/// Name of what a function gives.
const RETURN: &str = "return";

/// Makes the function of this name ready to be called.
///
/// # Errors
/// [`ProgramError::Internal`] for a module that does not come out valid.
pub(super) fn alone(
    module: &mut Module,
    name: &str,
    ports: &mut Ports<'_>,
    at: base::text::Span,
) -> Result<Alone, ProgramError> {
    let named = |(_, function): &(Handle<Function>, &Function)| function.name.as_deref() == Some(name);
    let found = module.functions.iter().find(named).map(|(handle, _)| handle);
    let handle = found.ok_or_else(|| ProgramError::internal(format!("`{name}` got lost")))?;
    let mut unfed = Vec::new();
    let (handle, stops) = stops::stops(module, handle, &mut unfed)?;
    unfed.iter().for_each(|what| ports.not_fed(what, at));
    let function = module.functions[handle].clone();
    let is_plain = |ty: Handle<Type>| match module.types[ty].inner {
        TypeInner::Pointer { base, space: AddressSpace::Function } => shape_of(module, base).is_some(),
        _ => shape_of(module, ty).is_some(),
    };
    let mut given = function.arguments.iter().map(|argument| argument.ty);
    let plainly = given.all(is_plain) && function.result.as_ref().is_none_or(|result| is_plain(result.ty));
    let flips = ports.text.written.is_compiled() && has_matrices(module, &function);
    if stops.is_none() && plainly && !flips {
        return Ok(plain(module, handle, &function, &ways(&function, name, ports)));
    }
    Ok(around(module, handle, name, stops.as_ref(), ports, at))
}

/// How each argument is passed, where the text says it: a compiler passes values by a pointer as well.
fn ways(function: &Function, name: &str, ports: &Ports<'_>) -> Vec<Option<Way>> {
    let params = ports.text.head(name).map(|head| &head.params);
    let params = params.filter(|params| params.len() == function.arguments.len());
    (0..function.arguments.len()).map(|k| params.map(|params| params[k].way)).collect()
}

/// True for a function that takes or gives a matrix.
fn has_matrices(module: &Module, function: &Function) -> bool {
    fn holds(module: &Module, ty: Handle<Type>) -> bool {
        match &module.types[ty].inner {
            TypeInner::Matrix { .. } => true,
            TypeInner::Pointer { base, .. } | TypeInner::Array { base, .. } => holds(module, *base),
            TypeInner::Struct { members, .. } => members.iter().any(|member| holds(module, member.ty)),
            _ => false,
        }
    }
    let result = function.result.as_ref().map(|result| result.ty);
    function.arguments.iter().map(|argument| argument.ty).chain(result).any(|ty| holds(module, ty))
}

/// The type of a transposed matrix; none for other types.
fn transposed(module: &mut Module, ty: Handle<Type>) -> Option<Handle<Type>> {
    let TypeInner::Matrix { columns, rows, scalar } = module.types[ty].inner else { return None };
    let inner = TypeInner::Matrix { columns: rows, rows: columns, scalar };
    Some(module.types.insert(Type { name: None, inner }, Span::UNDEFINED))
}

fn transpose(b: &mut Builder, arg: Handle<Expression>) -> Handle<Expression> {
    b.compute(Expression::Math { fun: MathFunction::Transpose, arg, arg1: None, arg2: None, arg3: None })
}

/// True for an array of matrices.
fn is_array_of_matrices(module: &Module, ty: Handle<Type>) -> bool {
    let TypeInner::Array { base, .. } = module.types[ty].inner else { return false };
    matches!(module.types[base].inner, TypeInner::Matrix { .. }) || is_array_of_matrices(module, base)
}

fn own_name(argument: &FunctionArgument, k: usize) -> String {
    argument.name.clone().unwrap_or_else(|| format!("argument {}", k + 1))
}

/// Ports of a function as it stands.
fn plain(module: &Module, handle: Handle<Function>, function: &Function, ways: &[Option<Way>]) -> Alone {
    let (mut inputs, mut outputs) = (Vec::new(), Vec::new());
    let port = |name: String, ty, at| {
        let shape = shape_of(module, ty)?;
        Some(Port { field: Field { name, shape }, ty, at, backing: None })
    };
    outputs.extend(function.result.as_ref().and_then(|result| port(RETURN.to_owned(), result.ty, PortAt::Result)));
    for (k, argument) in function.arguments.iter().enumerate() {
        let name = own_name(argument, k);
        let index = k as u32;
        match module.types[argument.ty].inner {
            TypeInner::Pointer { base, .. } => {
                if ways[k].map_or_else(|| !is_out(function, index), |way| way != Way::Out) {
                    inputs.extend(port(name.clone(), base, PortAt::Reference(index)));
                }
                if ways[k] != Some(Way::In) {
                    outputs.extend(port(name, base, PortAt::Reference(index)));
                }
            }
            _ => inputs.extend(port(name, argument.ty, PortAt::Argument(index))),
        }
    }
    Alone { function: handle, inputs, outputs }
}

/// True for a pointer to which the function writes the whole value before it looks at it: what stood there does not
/// matter.
fn is_out(function: &Function, argument: u32) -> bool {
    let expressions = &function.expressions;
    let Some(pointer) = expressions.iter().find(|(_, e)| **e == Expression::FunctionArgument(argument)).map(|(h, _)| h)
    else {
        return false;
    };
    for statement in function.body.iter() {
        match statement {
            Statement::Store { pointer: to, .. } if *to == pointer => return true,
            Statement::Emit(range) => {
                let reads = |handle: Handle<Expression>| match expressions[handle] {
                    Expression::Load { pointer: from } => from == pointer,
                    Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => base == pointer,
                    _ => false,
                };
                if range.clone().any(reads) {
                    return false;
                }
            }
            Statement::Store { .. } => {}
            _ => return false,
        }
    }
    false
}

/// How an argument is passed.
enum Passed {
    /// By its value.
    Value,
    /// As a pointer to this variable.
    Pointer(Handle<Expression>),
}

/// A part of an argument: its path, which argument of the function around it that is, and whether it is transposed.
type Given = (Vec<u32>, usize, bool);

/// An argument of the function: its type, where its parts lie among those of the function around it, how it is passed.
type Whole = (Handle<Type>, Vec<Given>, Passed);

/// A function around it whose arguments are the parts of its arguments, and which keeps what comes out in variables.
///
/// The rows of a matrix of HLSL are the columns of the one in the module. What goes in and comes out is what the author
/// means, with the columns that a matrix has in other languages.
fn around(
    module: &mut Module,
    handle: Handle<Function>,
    name: &str,
    stops: Option<&Stops>,
    ports: &mut Ports<'_>,
    place: base::text::Span,
) -> Alone {
    let function = module.functions[handle].clone();
    let (ways, flips) = (ways(&function, name, ports), ports.text.written.is_compiled());
    let mut b = Builder::new();
    let (mut inputs, mut arguments, mut wholes) = (Vec::new(), Vec::new(), Vec::new());
    let (mut kept, mut outputs) = (Vec::new(), Vec::new());
    for (k, argument) in function.arguments.iter().enumerate() {
        let own = own_name(argument, k);
        let (ty, space) = match module.types[argument.ty].inner {
            TypeInner::Pointer { base, space } => (base, Some(space)),
            _ => (argument.ty, None),
        };
        let (mut found, mut unfed) = (Vec::new(), Vec::new());
        parts(module, ty, (&own, &[]), &mut found, &mut unfed);
        unfed.iter().for_each(|what| ports.not_fed(what, place));
        let mut given = Vec::new();
        for Part { name, path, ty, shape } in found {
            if flips && is_array_of_matrices(module, ty) {
                ports.not_fed(&format!("`{name}`, an array of matrices,"), place);
                continue;
            }
            let flipped = if flips { transposed(module, ty) } else { None };
            let ty = flipped.unwrap_or(ty);
            let shape = shape_of(module, ty).unwrap_or(shape);
            // What is only given back is not fed.
            if ways[k] == Some(Way::Out) {
                continue;
            }
            given.push((path, arguments.len(), flipped.is_some()));
            let at = PortAt::Argument(arguments.len() as u32);
            arguments.push(FunctionArgument { name: Some(format!("sc_{}", arguments.len())), ty, binding: None });
            inputs.push(Port { field: Field { name, shape }, ty, at, backing: None });
        }
        let passed = match space {
            None => Passed::Value,
            Some(AddressSpace::Private) => {
                let global = add_global(module, &own, AddressSpace::Private, None, ty);
                kept.push((own, global, None));
                Passed::Pointer(b.global(global))
            }
            Some(_) => {
                let local = b.local(&own, ty);
                let global = add_global(module, &format!("{own}_after"), AddressSpace::Private, None, ty);
                if ways[k] != Some(Way::In) {
                    kept.push((own, global, Some(local)));
                }
                Passed::Pointer(local)
            }
        };
        wholes.push((ty, given, passed));
    }
    let result = function.result.as_ref().map(|result| result.ty);
    let given: Vec<Handle<Expression>> = (0..arguments.len() as u32).map(|k| b.argument(k)).collect();
    let value = {
        let module = &*module;
        let call = |b: &mut Builder, given: &[Handle<Expression>]| called(b, module, handle, &wholes, given);
        match stops {
            None => call(&mut b, &given),
            Some(stops) => {
                let steps: Vec<StopStep> = arguments.iter().map(|a| StopStep::of_parameter(module, a.ty)).collect();
                stops.run(&mut b, module, (&given, &steps), result, &call)
            }
        }
    };
    let mut leave = |b: &mut Builder,
                     module: &mut Module,
                     ports: &mut Ports<'_>,
                     name: &str,
                     global: Handle<GlobalVariable>| {
        let (mut found, mut unfed) = (Vec::new(), Vec::new());
        parts(module, module.global_variables[global].ty, (name, &[]), &mut found, &mut unfed);
        unfed.iter().for_each(|what| ports.not_fed(what, place));
        for Part { name, path, ty, shape } in found {
            if flips && is_array_of_matrices(module, ty) {
                ports.not_fed(&format!("`{name}`, an array of matrices,"), place);
                continue;
            }
            let Some(flipped) = flips.then(|| transposed(module, ty)).flatten() else {
                outputs.push(Port { field: Field { name, shape }, ty, at: at(module, global, &path), backing: None });
                continue;
            };
            let own = add_global(module, "sc_flipped", AddressSpace::Private, None, flipped);
            let mut from = b.global(global);
            for index in path {
                from = b.member(from, index);
            }
            let value = b.load(from);
            let (value, to) = (transpose(b, value), b.global(own));
            b.store(to, value);
            let shape = shape_of(module, flipped).unwrap_or(shape);
            outputs.push(Port { field: Field { name, shape }, ty: flipped, at: PortAt::Global(own), backing: None });
        }
    };
    if let (Some(ty), Some(value)) = (result, value) {
        let global = add_global(module, "sc_result", AddressSpace::Private, None, ty);
        let pointer = b.global(global);
        b.store(pointer, value);
        leave(&mut b, module, ports, RETURN, global);
    }
    for (name, global, local) in kept {
        if let Some(local) = local {
            let value = b.load(local);
            let pointer = b.global(global);
            b.store(pointer, value);
        }
        leave(&mut b, module, ports, &name, global);
    }
    outputs.extend(stops.and_then(Stops::output));
    b.statement(Statement::Return { value: None });
    let outer = b.finish(name, arguments, None);
    module.functions[handle].name = Some(format!("{name}_body"));
    Alone { function: module.functions.append(outer, Span::UNDEFINED), inputs, outputs }
}

/// Calls the function with what the parts are.
fn called(
    b: &mut Builder,
    module: &Module,
    handle: Handle<Function>,
    wholes: &[Whole],
    given: &[Handle<Expression>],
) -> Option<Handle<Expression>> {
    let mut passed = Vec::new();
    for (ty, parts, way) in wholes {
        let mut own = |k: usize, flipped| if flipped { transpose(b, given[k]) } else { given[k] };
        let parts: Vec<(&[u32], Handle<Expression>)> =
            parts.iter().map(|(path, k, flipped)| (&path[..], own(*k, *flipped))).collect();
        let value = put_together(b, module, *ty, &[], &parts);
        passed.push(match *way {
            Passed::Value => value,
            Passed::Pointer(pointer) => {
                b.store(pointer, value);
                pointer
            }
        });
    }
    let value = module.functions[handle].result.is_some().then(|| b.name(Expression::CallResult(handle)));
    b.statement(Statement::Call { function: handle, arguments: passed, result: value });
    value
}

/// A value made of its parts; zero where nothing is given.
fn put_together(
    b: &mut Builder,
    module: &Module,
    ty: Handle<Type>,
    path: &[u32],
    given: &[(&[u32], Handle<Expression>)],
) -> Handle<Expression> {
    if let Some((_, value)) = given.iter().find(|(own, _)| *own == path) {
        return *value;
    }
    let members: Vec<Handle<Type>> = match &module.types[ty].inner {
        TypeInner::Struct { members, .. } => members.iter().map(|member| member.ty).collect(),
        TypeInner::Array { base, size: naga::ArraySize::Constant(n), .. } => vec![*base; n.get() as usize],
        _ => return b.name(Expression::ZeroValue(ty)),
    };
    let mut components = Vec::new();
    for (k, member) in (0_u32..).zip(members) {
        components.push(put_together(b, module, member, &[path, &[k]].concat(), given));
    }
    b.compute(Expression::Compose { ty, components })
}
