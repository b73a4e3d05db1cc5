//! Built-in functions that a language or its writer does not have, supplied as functions of the module: `inverse` in MSL
//! and HLSL, `isnan` and `isinf` in WGSL.
//!
//! WGSL lets an implementation take it that no number is NaN or infinite, so that these two look at the bits.

use std::collections::HashMap;

use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{
    Arena, Block, Expression, Function, Handle, MathFunction, Module, Range, RelationalFunction, Scalar, Span,
    Statement, Type, TypeInner, UniqueArena,
};

use super::{Language, ProgramError, validate};

/// The functions, for numbers of 32 bits; each name ends with the components or columns that its argument has.
const TEXT: &str = include_str!("supply.wgsl");

/// Expressions that become calls: the name of the function, and the argument.
type Wanted = HashMap<Handle<Expression>, (String, Handle<Expression>)>;

/// The module with calls in place of what the language lacks; `None` when it lacks nothing.
pub(super) fn supplied(
    module: &Module,
    info: &ModuleInfo,
    language: Language,
) -> Result<Option<(Module, ModuleInfo)>, ProgramError> {
    let of = |function: &Function, info: &FunctionInfo| wanted(module, function, info, language);
    let functions: Vec<Wanted> = module.functions.iter().map(|(handle, f)| of(f, &info[handle])).collect();
    let points = module.entry_points.iter().enumerate();
    let points: Vec<Wanted> = points.map(|(k, p)| of(&p.function, info.get_entry_point(k))).collect();
    let named = |name: &str| functions.iter().chain(&points).any(|w| w.values().any(|(wanted, _)| wanted == name));
    if functions.iter().chain(&points).all(Wanted::is_empty) {
        return Ok(None);
    }
    let source = naga::front::wgsl::parse_str(TEXT)
        .map_err(|error| ProgramError::internal(format!("a function that is supplied: {error}")))?;
    let mut changed = module.clone();
    let mut calls = Calls { supplied: HashMap::new(), moved: HashMap::new() };
    let mut arena = Arena::new();
    for (_, function) in source.functions.iter() {
        let Some(name) = function.name.clone().filter(|name| named(name)) else { continue };
        let function = adopted(function.clone(), &source, &mut changed.types);
        calls.supplied.insert(name, arena.append(function, Span::UNDEFINED));
    }
    // What is called stands before what calls it.
    for ((old, function), wanted) in module.functions.iter().zip(&functions) {
        let mut function = function.clone();
        calls.put(&mut function, wanted);
        calls.moved.insert(old, arena.append(function, module.functions.get_span(old)));
    }
    changed.functions = arena;
    for (point, wanted) in changed.entry_points.iter_mut().zip(&points) {
        calls.put(&mut point.function, wanted);
    }
    let info = validate(&changed)?;
    Ok(Some((changed, info)))
}

fn wanted(module: &Module, function: &Function, info: &FunctionInfo, language: Language) -> Wanted {
    let lacking = |(handle, expression): (Handle<Expression>, &Expression)| {
        let (name, argument) = match (language, expression) {
            (Language::Msl | Language::Hlsl, &Expression::Math { fun: MathFunction::Inverse, arg, .. }) => {
                ("inverse", arg)
            }
            (Language::Wgsl, &Expression::Relational { fun: RelationalFunction::IsNan, argument }) => {
                ("isnan", argument)
            }
            (Language::Wgsl, &Expression::Relational { fun: RelationalFunction::IsInf, argument }) => {
                ("isinf", argument)
            }
            _ => return None,
        };
        let size = match *info[argument].ty.inner_with(&module.types) {
            TypeInner::Matrix { columns, scalar: Scalar::F32, .. } => columns as u8,
            TypeInner::Vector { size, scalar: Scalar::F32 } => size as u8,
            TypeInner::Scalar(Scalar::F32) => 1,
            _ => return None,
        };
        Some((handle, (format!("sc_{name}_{size}"), argument)))
    };
    function.expressions.iter().filter_map(lacking).collect()
}

/// A function of another module, with the types of this one.
fn adopted(mut function: Function, from: &Module, types: &mut UniqueArena<Type>) -> Function {
    let mut own = |ty: &mut Handle<Type>| {
        *ty = types.insert(Type { name: None, inner: from.types[*ty].inner.clone() }, Span::UNDEFINED);
    };
    function.arguments.iter_mut().for_each(|argument| own(&mut argument.ty));
    function.result.iter_mut().for_each(|result| own(&mut result.ty));
    function.local_variables.iter_mut().for_each(|(_, variable)| own(&mut variable.ty));
    for (_, expression) in function.expressions.iter_mut() {
        if let Expression::Compose { ty, .. } | Expression::ZeroValue(ty) = expression {
            own(ty);
        }
    }
    function
}

/// Where functions are now.
struct Calls {
    supplied: HashMap<String, Handle<Function>>,
    moved: HashMap<Handle<Function>, Handle<Function>>,
}

impl Calls {
    fn put(&self, function: &mut Function, wanted: &Wanted) {
        for (handle, expression) in function.expressions.iter_mut() {
            if let Some(callee) = wanted.get(&handle).and_then(|(name, _)| self.supplied.get(name)) {
                *expression = Expression::CallResult(*callee);
            } else if let Expression::CallResult(callee) = expression {
                self.follow(callee);
            }
        }
        self.statements(&mut function.body, wanted);
    }

    fn follow(&self, callee: &mut Handle<Function>) {
        *callee = self.moved.get(callee).copied().unwrap_or(*callee);
    }

    fn statements(&self, block: &mut Block, wanted: &Wanted) {
        let mut changed = Block::new();
        for (mut statement, span) in std::mem::take(block).span_into_iter() {
            match &mut statement {
                Statement::Emit(range) => {
                    self.emit(&mut changed, range.clone(), wanted, span);
                    continue;
                }
                Statement::Call { function, .. } => self.follow(function),
                Statement::Block(inner) => self.statements(inner, wanted),
                Statement::If { accept, reject, .. } => {
                    self.statements(accept, wanted);
                    self.statements(reject, wanted);
                }
                Statement::Loop { body, continuing, .. } => {
                    self.statements(body, wanted);
                    self.statements(continuing, wanted);
                }
                Statement::Switch { cases, .. } => {
                    cases.iter_mut().for_each(|case| self.statements(&mut case.body, wanted));
                }
                _ => {}
            }
            changed.push(statement, span);
        }
        *block = changed;
    }

    /// What is computed up to a call, the call, and what is computed behind it.
    fn emit(&self, block: &mut Block, range: Range<Expression>, wanted: &Wanted, span: Span) {
        for handle in range {
            let call = wanted.get(&handle).and_then(|(name, argument)| Some((*self.supplied.get(name)?, *argument)));
            block.push(
                match call {
                    Some((function, argument)) => {
                        Statement::Call { function, arguments: vec![argument], result: Some(handle) }
                    }
                    None => Statement::Emit(Range::new_from_bounds(handle, handle)),
                },
                span,
            );
        }
    }
}
