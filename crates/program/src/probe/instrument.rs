//! The stores that are added to a module.

use std::collections::HashMap;

use naga::valid::FunctionInfo;
use naga::{
    AddressSpace, ArraySize, BinaryOperator, Block, Expression, Function, GlobalVariable, Handle, Literal,
    MathFunction, Module, Range, Scalar, Span, Statement, Type, TypeInner,
};

use super::operands::{Leaves, OperandScope, path};
use super::operations::operations;
use super::{Leaf, Point, Probed, TRACE, What, place};
use crate::capture::add_global;
use crate::fuel::{blocks, blocks_mut};
use crate::lower::Role;
use crate::{Entry, Port, PortAt, Program, ProgramError, validate};
use base::value::{Field, Shape};

/// A number that is stored: a value, and the indices that lead from it to the number.
type Number = (Handle<Expression>, Vec<u32>);

/// Where the trace lies.
#[derive(Clone, Copy)]
struct TraceStore {
    trace: Handle<GlobalVariable>,
    traced: Handle<GlobalVariable>,
    words: u32,
}

pub(super) fn probed(program: &Program, words: u32) -> Result<Probed, ProgramError> {
    let mut probed = program.clone();
    let ports = ports(&mut probed.module, words);
    let [PortAt::Global(trace), PortAt::Global(traced)] = [&ports[0].at, &ports[1].at] else {
        return Err(ProgramError::internal("a trace that is no variable".to_owned()));
    };
    let store = TraceStore { trace: *trace, traced: *traced, words };
    let mut points = Vec::new();
    for handle in reachable(program) {
        let (function, info) = parts(program, handle);
        let found = Found::new(program, handle, function, info, &mut points);
        let function = match (handle, program.entry) {
            (Some(handle), _) => &mut probed.module.functions[handle],
            (None, Entry::Point(index)) => &mut probed.module.entry_points[index].function,
            (None, Entry::Function(_)) => continue,
        };
        let body = std::mem::take(&mut function.body);
        function.body = instrumented(body, function, &found, store);
    }
    match program.role {
        Role::Geometry(_) => flatten(&mut probed, &mut points, store)?,
        Role::Vertex | Role::Fragment | Role::Compute | Role::Function { .. } => {
            let function = match program.entry {
                Entry::Point(index) => &mut probed.module.entry_points[index].function,
                Entry::Function(handle) => &mut probed.module.functions[handle],
            };
            let mut writer = TraceWriter { function, body: Block::new() };
            writer.reset(store);
            let mut body = writer.body;
            body.extend_block(std::mem::take(&mut function.body));
            function.body = body;
        }
    }
    probed.outputs.extend(ports);
    probed.instrumented = true;
    probed.info = validate(&probed.module)?;
    Ok(Probed { program: probed, points, words })
}

/// The two outputs, in the order in which the decoder expects them.
fn ports(module: &mut Module, words: u32) -> [Port; 2] {
    let mut add = |inner| module.types.insert(Type { name: None, inner }, Span::UNDEFINED);
    let (f32, u32) = (add(TypeInner::Scalar(Scalar::F32)), add(TypeInner::Scalar(Scalar::U32)));
    let size = std::num::NonZeroU32::new(words).unwrap_or(std::num::NonZeroU32::MIN);
    let array = add(TypeInner::Array { base: f32, size: ArraySize::Constant(size), stride: 4 });
    let mut port = |variable: &str, name: &str, shape, ty| {
        let global = add_global(module, variable, AddressSpace::Private, None, ty);
        Port { field: Field { name: name.to_owned(), shape }, ty, at: PortAt::Global(global), backing: None }
    };
    let count = Shape::vector(base::value::Scalar::U32, 1);
    [port("sc_trace", TRACE, Shape::FLOAT.array_of(words), array), port("sc_traced", "(traced)", count, u32)]
}

fn parts(program: &Program, handle: Option<Handle<Function>>) -> (&Function, &FunctionInfo) {
    match (handle, program.entry) {
        (Some(handle), _) | (None, Entry::Function(handle)) => {
            (&program.module.functions[handle], &program.info[handle])
        }
        (None, Entry::Point(index)) => {
            (&program.module.entry_points[index].function, program.info.get_entry_point(index))
        }
    }
}

/// The functions that the entry may call, callers first; `None` is an entry point.
fn reachable(program: &Program) -> Vec<Option<Handle<Function>>> {
    fn calls(block: &Block, all: &mut Vec<Handle<Function>>) {
        for statement in block.iter() {
            if let Statement::Call { function, .. } = statement {
                all.push(*function);
            }
            blocks(statement).into_iter().for_each(|inner| calls(inner, all));
        }
    }
    let mut found = vec![match program.entry {
        Entry::Point(_) => None,
        Entry::Function(handle) => Some(handle),
    }];
    let mut next = 0;
    while let Some(&handle) = found.get(next) {
        let mut called = Vec::new();
        calls(&parts(program, handle).0.body, &mut called);
        for function in called {
            if !found.contains(&Some(function)) {
                found.push(Some(function));
            }
        }
        next += 1;
    }
    found
}

/// The points of one function, and the numbers that each stores.
struct Found {
    points: HashMap<Handle<Expression>, usize>,
    numbers: HashMap<Handle<Expression>, Vec<Number>>,
}

impl Found {
    fn new(
        program: &Program,
        handle: Option<Handle<Function>>,
        function: &Function,
        info: &FunctionInfo,
        points: &mut Vec<Point>,
    ) -> Self {
        let mut emitted = Vec::new();
        emissions(&function.body, &mut emitted);
        let none = HashMap::new();
        let scope = OperandScope { module: &program.module, function, info, points: &none };
        let traced: Vec<_> = emitted.into_iter().filter(|&(e, _)| is_traced(&scope, e)).collect();
        let own: HashMap<Handle<Expression>, usize> =
            (points.len()..).zip(&traced).map(|(index, &(e, _))| (e, index)).collect();
        let scope = OperandScope { points: &own, ..scope };
        let mut numbers = HashMap::new();
        for (expression, statement) in traced {
            let mut leaves = Leaves::new();
            let (operands, operations) = operations(&scope, expression, &mut leaves);
            let comparison = scope.floats(expression).is_none();
            let values = if comparison { compared(&scope, expression) } else { vec![expression] };
            let mut stored: Vec<Number> = values.iter().flat_map(|&value| components(&scope, value)).collect();
            let components = stored.len() as u32;
            let number = |&(leaf, k): &(Handle<Expression>, u32)| Some((leaf, path(scope.floats(leaf)?, k)));
            stored.extend(leaves.iter().filter_map(number));
            let place = |e| place::span(program, function, e, statement);
            points.push(Point {
                function: handle,
                expression: Some(expression),
                what: if comparison { What::Comparison } else { What::Operation },
                span: place(expression),
                components,
                operands,
                leaves: leaves
                    .into_iter()
                    .map(|(expression, component)| Leaf { expression, component, span: place(expression) })
                    .collect(),
                operations,
            });
            numbers.insert(expression, stored);
        }
        Self { points: own, numbers }
    }
}

/// All expressions that are computed, in the order of the statements.
fn emissions(block: &Block, all: &mut Vec<(Handle<Expression>, Span)>) {
    for (statement, &span) in block.span_iter() {
        if let Statement::Emit(range) = statement {
            all.extend(range.clone().map(|expression| (expression, span)));
        }
        blocks(statement).into_iter().for_each(|inner| emissions(inner, all));
    }
}

/// True for operators and functions that give binary32 numbers, and for comparisons of them.
fn is_traced(scope: &OperandScope<'_>, handle: Handle<Expression>) -> bool {
    let float = scope.floats(handle).is_some();
    match scope.function.expressions[handle] {
        Expression::Unary { .. } | Expression::Math { .. } => float,
        Expression::Binary { left, .. } => float || scope.floats(left).is_some(),
        Expression::As { convert, .. } => float && convert.is_some(),
        Expression::AccessIndex { base, .. } => {
            let parts = |fun| matches!(fun, MathFunction::Modf | MathFunction::Frexp);
            float && matches!(scope.function.expressions[base], Expression::Math { fun, .. } if parts(fun))
        }
        _ => false,
    }
}

fn compared(scope: &OperandScope<'_>, handle: Handle<Expression>) -> Vec<Handle<Expression>> {
    match scope.function.expressions[handle] {
        Expression::Binary { left, right, .. } => vec![left, right],
        _ => Vec::new(),
    }
}

fn components(scope: &OperandScope<'_>, value: Handle<Expression>) -> Vec<Number> {
    let size = scope.floats(value);
    size.map_or_else(Vec::new, |size| (0..size.0 * size.1).map(|k| (value, path(size, k))).collect())
}

/// The same statements, with the stores behind each that computes something traced.
fn instrumented(block: Block, function: &mut Function, found: &Found, store: TraceStore) -> Block {
    let mut body = Block::new();
    for (mut statement, span) in block.span_into_iter() {
        for inner in blocks_mut(&mut statement) {
            *inner = instrumented(std::mem::take(inner), function, found, store);
        }
        let emitted = if let Statement::Emit(range) = &statement { Some(range.clone()) } else { None };
        body.push(statement, span);
        for expression in emitted.into_iter().flatten() {
            if let (Some(&point), Some(numbers)) = (found.points.get(&expression), found.numbers.get(&expression)) {
                let mut writer = TraceWriter { function, body: std::mem::take(&mut body) };
                writer.step(store, point, numbers);
                body = writer.body;
            }
        }
    }
    body
}

/// Turns a geometry stage into a function of one primitive, in which emitting a vertex is a step.
fn flatten(program: &mut Program, points: &mut Vec<Point>, store: TraceStore) -> Result<(), ProgramError> {
    let module = &mut program.module;
    let strange = |what: &str| ProgramError::internal(format!("a geometry stage {what}"));
    let mut main = module.entry_points.pop().ok_or_else(|| strange("without entry point"))?.function;
    if !main.arguments.is_empty() || main.result.is_some() || !module.entry_points.is_empty() {
        return Err(strange("that takes or returns something"));
    }
    main.name = Some("sc_main".to_owned());
    let event = |what, components| Point {
        function: None,
        expression: None,
        what,
        span: None,
        components,
        operands: Vec::new(),
        leaves: Vec::new(),
        operations: Vec::new(),
    };
    let mut emit = Function { name: Some("EmitVertex".to_owned()), ..Function::default() };
    for port in std::mem::take(&mut program.outputs) {
        let shape = port.field.shape;
        let PortAt::Global(global) = port.at else { return Err(strange("with an output that is no variable")) };
        if shape.scalar != base::value::Scalar::F32 {
            continue;
        }
        let mut writer = TraceWriter { body: std::mem::take(&mut emit.body), function: &mut emit };
        let pointer = writer.name(Expression::GlobalVariable(global));
        let value = writer.compute(Expression::Load { pointer });
        let size = (u32::from(shape.columns), u32::from(shape.rows));
        let elements = (0..shape.elements() as u32).map(|k| shape.array.map(|_| k));
        let numbers: Vec<Number> = elements
            .flat_map(|element| {
                let path = move |k| element.into_iter().chain(path(size, k)).collect();
                (0..size.0 * size.1).map(move |k| (value, path(k)))
            })
            .collect();
        writer.step(store, points.len(), &numbers);
        emit.body = writer.body;
        points.push(event(What::Emitted { output: port.field.name }, numbers.len() as u32));
    }
    let mut end = Function { name: Some("EndPrimitive".to_owned()), ..Function::default() };
    let mut writer = TraceWriter { function: &mut end, body: Block::new() };
    writer.step(store, points.len(), &[]);
    end.body = writer.body;
    points.push(event(What::EndPrimitive, 0));
    for function in [emit, end] {
        let named = module.functions.iter().find(|(_, f)| f.name == function.name).map(|(handle, _)| handle);
        // Lowering declares both.
        module.functions[named.ok_or_else(|| strange("that cannot emit"))?] = function;
    }
    let main = module.functions.append(main, Span::UNDEFINED);
    let mut entry = Function { name: Some("sc_primitive".to_owned()), ..Function::default() };
    let mut writer = TraceWriter { function: &mut entry, body: Block::new() };
    writer.reset(store);
    writer.push(Statement::Call { function: main, arguments: Vec::new(), result: None });
    entry.body = writer.body;
    program.entry = Entry::Function(module.functions.append(entry, Span::UNDEFINED));
    program.role = Role::Function { name: "main".to_owned() };
    Ok(())
}

/// Appends statements to a body.
struct TraceWriter<'a> {
    function: &'a mut Function,
    body: Block,
}

impl TraceWriter<'_> {
    fn push(&mut self, statement: Statement) {
        self.body.push(statement, Span::UNDEFINED);
    }

    fn name(&mut self, expression: Expression) -> Handle<Expression> {
        self.function.expressions.append(expression, Span::UNDEFINED)
    }

    fn compute(&mut self, expression: Expression) -> Handle<Expression> {
        let handle = self.name(expression);
        self.push(Statement::Emit(Range::new_from_bounds(handle, handle)));
        handle
    }

    fn u32(&mut self, value: u32) -> Handle<Expression> {
        self.name(Expression::Literal(Literal::U32(value)))
    }

    fn add(&mut self, left: Handle<Expression>, value: u32) -> Handle<Expression> {
        let right = self.u32(value);
        self.compute(Expression::Binary { op: BinaryOperator::Add, left, right })
    }

    /// An empty trace.
    fn reset(&mut self, store: TraceStore) {
        let pointer = self.name(Expression::GlobalVariable(store.traced));
        let value = self.u32(0);
        self.push(Statement::Store { pointer, value });
    }

    /// Appends a step to the trace if all of it fits, and counts its words in any case: once a step
    /// did not fit, none behind it does.
    fn step(&mut self, store: TraceStore, point: usize, numbers: &[Number]) {
        let traced = self.name(Expression::GlobalVariable(store.traced));
        let at = self.compute(Expression::Load { pointer: traced });
        let next = self.add(at, 1 + numbers.len() as u32);
        let right = self.u32(store.words);
        let fits = self.compute(Expression::Binary { op: BinaryOperator::LessEqual, left: next, right });
        let outside = std::mem::take(&mut self.body);
        let trace = self.name(Expression::GlobalVariable(store.trace));
        let number = self.name(Expression::Literal(Literal::F32((point + 1) as f32)));
        let first = self.compute(Expression::Access { base: trace, index: at });
        self.push(Statement::Store { pointer: first, value: number });
        for (k, (value, path)) in (1..).zip(numbers) {
            let mut value = *value;
            for &index in path {
                value = self.compute(Expression::AccessIndex { base: value, index });
            }
            let index = self.add(at, k);
            let pointer = self.compute(Expression::Access { base: trace, index });
            self.push(Statement::Store { pointer, value });
        }
        let accept = std::mem::replace(&mut self.body, outside);
        self.push(Statement::If { condition: fits, accept, reject: Block::new() });
        self.push(Statement::Store { pointer: traced, value: next });
    }
}
