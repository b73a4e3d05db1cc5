//! What only a fragment stage has becomes ordinary code where the module is run, as it does for GLSL: `discard` leaves
//! all functions and sets an output; a derivative is the difference between runs for neighbouring inputs
//! (`crates/program/src/build/quad.rs` says how); and a texture is read at the one level that it has.

use std::collections::HashMap;

use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{
    AddressSpace, Arena, BinaryOperator as B, Binding, Block, BuiltIn, Constant, DerivativeAxis, Expression, Function,
    FunctionArgument, GlobalVariable, Handle, Interpolation, Literal, Module, Range, SampleLevel, Scalar, ShaderStage,
    Span, Statement, Type, TypeInner,
};

use crate::build::quad::{MOST, steps};
use crate::capture::{Builder, add_global};
use crate::fuel::blocks;
use crate::{DISCARD, Port, PortAt, ProgramError, validate};
use base::value::{Field, Shape};

type Expr = Handle<Expression>;

/// The functions that note an operand and give the difference between two of them, for numbers and vectors.
const HELPERS: &str = include_str!("stops.wgsl");

/// How an argument of a member of a quad differs from that of the sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StopStep {
    /// Not at all.
    Same,
    /// It is interpolated, and has so many components.
    Interpolated(u32),
    /// The place of the fragment: whole pixels.
    Pixel,
}

impl StopStep {
    /// Of an input of a stage.
    pub fn of_input(module: &Module, argument: &FunctionArgument, stage: ShaderStage) -> Self {
        match argument.binding {
            Some(Binding::BuiltIn(BuiltIn::Position { .. })) if stage == ShaderStage::Fragment => Self::Pixel,
            Some(Binding::Location { interpolation, .. }) if interpolation != Some(Interpolation::Flat) => {
                Self::of_parameter(module, argument.ty)
            }
            _ => Self::Same,
        }
    }

    /// Of a parameter of a function.
    pub fn of_parameter(module: &Module, ty: Handle<Type>) -> Self {
        match module.types[ty].inner {
            TypeInner::Scalar(Scalar::F32) => Self::Interpolated(1),
            TypeInner::Vector { size, scalar: Scalar::F32 } => Self::Interpolated(size as u32),
            _ => Self::Same,
        }
    }
}

/// What stops the invocations of a module, and how it is run.
pub(super) struct Stops {
    /// Whether the invocation leaves all its functions.
    stopped: Handle<GlobalVariable>,
    /// The author discards.
    pub discards: bool,
    /// Derivatives that a run comes to.
    sites: u32,
    member: Handle<GlobalVariable>,
    pass: Handle<GlobalVariable>,
    at: Handle<GlobalVariable>,
    known: Handle<GlobalVariable>,
    /// Variables that begin anew in each run, with their values.
    begin: Vec<(Handle<GlobalVariable>, Handle<Constant>)>,
    bool_ty: Handle<Type>,
    word_ty: Handle<Type>,
    /// Vectors of two to four numbers.
    vectors: [Handle<Type>; 3],
}

/// What a function comes to.
#[derive(Clone, Copy, Debug, Default)]
struct Comes {
    sites: u32,
    discards: bool,
    /// A derivative in a loop.
    repeated: bool,
}

impl Comes {
    fn stops(self) -> bool {
        self.sites > 0 || self.discards
    }
}

/// Rewrites the functions of a module, of which `own` is run. Gives where it is now, and `None` where nothing stops.
/// What cannot be run is named in `unfed`.
pub(super) fn stops(
    module: &mut Module,
    own: Handle<Function>,
    unfed: &mut Vec<String>,
) -> Result<(Handle<Function>, Option<Stops>), ProgramError> {
    for (_, function) in module.functions.iter_mut() {
        for (_, expression) in function.expressions.iter_mut() {
            if let Expression::ImageSample { level: level @ (SampleLevel::Auto | SampleLevel::Bias(_)), .. } =
                expression
            {
                *level = SampleLevel::Zero;
            }
        }
    }
    let mut comes: HashMap<Handle<Function>, Comes> = HashMap::new();
    // What is called stands before what calls it.
    for (handle, function) in module.functions.iter() {
        let found = found(&function.body, function, &comes, false);
        comes.insert(handle, found);
    }
    let whole = comes.get(&own).copied().unwrap_or_default();
    if !comes.values().any(|comes| comes.stops()) {
        return Ok((own, None));
    }
    if whole.repeated {
        unfed.push("a derivative in a loop".to_owned());
    }
    if whole.sites > MOST {
        unfed.push(format!("a shader with more than {MOST} derivatives"));
    }
    let info = validate(module)?;
    let begin = beginnings(module);
    let helpers = Helpers::adopt(module)?;
    let mut rewriting = Rewriting { helpers: &helpers, comes: &comes, moved: HashMap::new() };
    let mut arena = helpers.arena.clone();
    for (old, _) in module.functions.iter() {
        let rewritten = rewriting.function(old, module, &info);
        let new = arena.append(rewritten, module.functions.get_span(old));
        rewriting.moved.insert(old, new);
    }
    let own = rewriting.moved[&own];
    module.functions = arena;
    let variable = |name: &str| helpers.globals[name];
    let stops = Stops {
        stopped: variable("sc_stopped"),
        discards: whole.discards,
        sites: whole.sites,
        member: variable("sc_member"),
        pass: variable("sc_pass"),
        at: variable("sc_at"),
        known: variable("sc_known"),
        begin,
        bool_ty: helpers.types[0],
        word_ty: helpers.types[1],
        vectors: helpers.vectors,
    };
    Ok((own, Some(stops)))
}

/// Private variables with what they begin as.
fn beginnings(module: &mut Module) -> Vec<(Handle<GlobalVariable>, Handle<Constant>)> {
    let begins = |(handle, variable): (Handle<GlobalVariable>, &GlobalVariable)| {
        let private = variable.space == AddressSpace::Private;
        variable.init.filter(|_| private).map(|init| (handle, variable.ty, init))
    };
    let all: Vec<_> = module.global_variables.iter().filter_map(begins).collect();
    let constant = |(handle, ty, init)| {
        let constant = Constant { name: None, ty, init };
        (handle, module.constants.append(constant, Span::UNDEFINED))
    };
    all.into_iter().map(constant).collect()
}

/// What a block comes to.
fn found(block: &Block, function: &Function, comes: &HashMap<Handle<Function>, Comes>, in_loop: bool) -> Comes {
    let mut all = Comes::default();
    let mut add = |more: Comes| {
        all.sites += more.sites;
        all.discards |= more.discards;
        all.repeated |= more.repeated || (in_loop && more.sites > 0);
    };
    for statement in block.iter() {
        match statement {
            Statement::Kill => add(Comes { discards: true, ..Comes::default() }),
            Statement::Emit(range) => {
                let derivative = |h: &Expr| matches!(function.expressions[*h], Expression::Derivative { .. });
                add(Comes { sites: range.clone().filter(derivative).count() as u32, ..Comes::default() });
            }
            Statement::Call { function, .. } => add(comes.get(function).copied().unwrap_or_default()),
            _ => {}
        }
        let within = in_loop || matches!(statement, Statement::Loop { .. });
        blocks(statement).into_iter().for_each(|inner| add(found(inner, function, comes, within)));
    }
    all
}

/// Functions and variables that a text of our own adds to a module.
struct Helpers {
    arena: Arena<Function>,
    by_name: HashMap<String, Handle<Function>>,
    globals: HashMap<String, Handle<GlobalVariable>>,
    /// `bool` and `u32`.
    types: [Handle<Type>; 2],
    /// Vectors of two to four numbers.
    vectors: [Handle<Type>; 3],
}

impl Helpers {
    fn adopt(module: &mut Module) -> Result<Self, ProgramError> {
        let source = naga::front::wgsl::parse_str(HELPERS)
            .map_err(|error| ProgramError::internal(format!("a function that is supplied: {error}")))?;
        let mut types = HashMap::new();
        for (old, ty) in source.types.iter() {
            let inner = match ty.inner {
                TypeInner::Array { base, size, stride } => TypeInner::Array { base: types[&base], size, stride },
                TypeInner::Pointer { base, space } => TypeInner::Pointer { base: types[&base], space },
                ref other => other.clone(),
            };
            types.insert(old, module.types.insert(Type { name: None, inner }, Span::UNDEFINED));
        }
        let (mut globals, mut variables) = (HashMap::new(), HashMap::new());
        for (old, variable) in source.global_variables.iter() {
            let name = variable.name.clone().unwrap_or_default();
            let new = add_global(module, &name, AddressSpace::Private, None, types[&variable.ty]);
            globals.insert(name, new);
            variables.insert(old, new);
        }
        let (mut arena, mut by_name, mut moved) = (Arena::new(), HashMap::new(), HashMap::new());
        for (old, function) in source.functions.iter() {
            let mut function = function.clone();
            function.arguments.iter_mut().for_each(|argument| argument.ty = types[&argument.ty]);
            function.result.iter_mut().for_each(|result| result.ty = types[&result.ty]);
            function.local_variables.iter_mut().for_each(|(_, variable)| variable.ty = types[&variable.ty]);
            for (_, expression) in function.expressions.iter_mut() {
                match expression {
                    Expression::Compose { ty, .. } | Expression::ZeroValue(ty) => *ty = types[ty],
                    Expression::GlobalVariable(variable) => *variable = variables[variable],
                    Expression::CallResult(callee) => *callee = moved[callee],
                    _ => {}
                }
            }
            follow(&mut function.body, &moved);
            let name = function.name.clone().unwrap_or_default();
            let new = arena.append(function, Span::UNDEFINED);
            by_name.insert(name, new);
            moved.insert(old, new);
        }
        let mut ty = |inner| module.types.insert(Type { name: None, inner }, Span::UNDEFINED);
        let types = [Scalar::BOOL, Scalar::U32].map(|scalar| ty(TypeInner::Scalar(scalar)));
        let vectors = [2, 3, 4].map(|n| ty(TypeInner::Vector { size: size(n), scalar: Scalar::F32 }));
        Ok(Self { arena, by_name, globals, types, vectors })
    }
}

/// Calls go to where functions are now.
fn follow(block: &mut Block, moved: &HashMap<Handle<Function>, Handle<Function>>) {
    for statement in block.iter_mut() {
        if let Statement::Call { function, .. } = statement {
            *function = moved.get(function).copied().unwrap_or(*function);
        }
        crate::fuel::blocks_mut(statement).into_iter().for_each(|inner| follow(inner, moved));
    }
}

struct Rewriting<'a> {
    helpers: &'a Helpers,
    comes: &'a HashMap<Handle<Function>, Comes>,
    moved: HashMap<Handle<Function>, Handle<Function>>,
}

/// A function while it is rewritten.
struct StopWriter<'a> {
    function: Function,
    module: &'a Module,
    info: &'a FunctionInfo,
    /// Derivatives so far.
    sites: u32,
}

impl StopWriter<'_> {
    fn add(&mut self, block: &mut Block, expression: Expression) -> Expr {
        let emitted =
            !matches!(expression, Expression::GlobalVariable(_) | Expression::Literal(_) | Expression::ZeroValue(_));
        let handle = self.function.expressions.append(expression, Span::UNDEFINED);
        if emitted {
            block.push(Statement::Emit(Range::new_from_bounds(handle, handle)), Span::UNDEFINED);
        }
        handle
    }

    fn leave(&mut self, block: &mut Block, span: Span) {
        let zero = self.function.result.as_ref().map(|result| Expression::ZeroValue(result.ty));
        let value = zero.map(|zero| self.function.expressions.append(zero, span));
        block.push(Statement::Return { value }, span);
    }
}

impl Rewriting<'_> {
    fn function(&self, old: Handle<Function>, module: &Module, info: &ModuleInfo) -> Function {
        let function = module.functions[old].clone();
        let mut writer = StopWriter { function, module, info: &info[old], sites: 0 };
        for (_, expression) in writer.function.expressions.iter_mut() {
            if let Expression::CallResult(callee) = expression {
                *callee = self.moved.get(callee).copied().unwrap_or(*callee);
            }
        }
        let body = std::mem::take(&mut writer.function.body);
        let body = self.block(body, &mut writer);
        writer.function.body = body;
        debug_assert_eq!(writer.sites, self.comes[&old].sites, "every derivative is counted once");
        writer.function
    }

    fn block(&self, block: Block, writer: &mut StopWriter<'_>) -> Block {
        let mut body = Block::new();
        for (mut statement, span) in block.span_into_iter() {
            match &mut statement {
                Statement::Kill => {
                    self.stop(&mut body, writer);
                    writer.leave(&mut body, span);
                    continue;
                }
                Statement::Emit(range) => {
                    for handle in range.clone() {
                        self.emit(&mut body, writer, handle, span);
                    }
                    continue;
                }
                Statement::Call { function, .. } => {
                    let comes = self.comes.get(function).copied().unwrap_or_default();
                    *function = self.moved.get(function).copied().unwrap_or(*function);
                    self.before(&mut body, writer, comes.sites, B::Add);
                    body.push(statement, span);
                    self.before(&mut body, writer, comes.sites, B::Subtract);
                    writer.sites += comes.sites;
                    if comes.stops() {
                        self.leave_if_stopped(&mut body, writer, span);
                    }
                    continue;
                }
                other => {
                    for inner in crate::fuel::blocks_mut(other) {
                        *inner = self.block(std::mem::take(inner), writer);
                    }
                }
            }
            body.push(statement, span);
        }
        body
    }

    /// A derivative becomes a call.
    fn emit(&self, body: &mut Block, writer: &mut StopWriter<'_>, handle: Expr, span: Span) {
        let Expression::Derivative { axis, expr, .. } = writer.function.expressions[handle] else {
            body.push(Statement::Emit(Range::new_from_bounds(handle, handle)), span);
            return;
        };
        let axis = match axis {
            DerivativeAxis::X => "x",
            DerivativeAxis::Y => "y",
            DerivativeAxis::Width => "width",
        };
        let size = size_of(writer.module, writer.info, expr);
        let callee = self.helpers.by_name[&format!("sc_{axis}_{size}")];
        writer.function.expressions[handle] = Expression::CallResult(callee);
        let site = writer.add(body, Expression::Literal(Literal::U32(writer.sites)));
        writer.sites += 1;
        let arguments = vec![expr, site];
        body.push(Statement::Call { function: callee, arguments, result: Some(handle) }, span);
        self.leave_if_stopped(body, writer, span);
    }

    fn stop(&self, body: &mut Block, writer: &mut StopWriter<'_>) {
        let pointer = writer.add(body, Expression::GlobalVariable(self.helpers.globals["sc_stopped"]));
        let value = writer.add(body, Expression::Literal(Literal::Bool(true)));
        body.push(Statement::Store { pointer, value }, Span::UNDEFINED);
    }

    fn leave_if_stopped(&self, body: &mut Block, writer: &mut StopWriter<'_>, span: Span) {
        let pointer = writer.add(body, Expression::GlobalVariable(self.helpers.globals["sc_stopped"]));
        let condition = writer.add(body, Expression::Load { pointer });
        let mut accept = Block::new();
        writer.leave(&mut accept, span);
        body.push(Statement::If { condition, accept, reject: Block::new() }, span);
    }

    /// Moves the number of derivatives before the function that runs.
    fn before(&self, body: &mut Block, writer: &mut StopWriter<'_>, sites: u32, op: B) {
        if sites == 0 {
            return;
        }
        let pointer = writer.add(body, Expression::GlobalVariable(self.helpers.globals["sc_at"]));
        let left = writer.add(body, Expression::Load { pointer });
        let right = writer.add(body, Expression::Literal(Literal::U32(writer.sites)));
        let value = writer.add(body, Expression::Binary { op, left, right });
        body.push(Statement::Store { pointer, value }, Span::UNDEFINED);
    }
}

/// Components of an expression.
fn size_of(module: &Module, info: &FunctionInfo, expression: Expr) -> u32 {
    match *info[expression].ty.inner_with(&module.types) {
        TypeInner::Vector { size, .. } => size as u32,
        _ => 1,
    }
}

impl Stops {
    /// The output that tells whether the invocation was discarded.
    pub fn output(&self) -> Option<Port> {
        let field = Field { name: DISCARD.to_owned(), shape: Shape::vector(base::value::Scalar::Bool, 1) };
        let port = Port { field, ty: self.bool_ty, at: PortAt::Global(self.stopped), backing: None };
        self.discards.then_some(port)
    }

    fn set(&self, b: &mut Builder, variable: Handle<GlobalVariable>, value: Expr) {
        let pointer = b.global(variable);
        b.store(pointer, value);
    }

    /// Runs `call` with these arguments; where there are derivatives, for the members of quads before. Gives its value,
    /// zero where it is discarded.
    pub fn run(
        &self,
        b: &mut Builder,
        module: &Module,
        (given, steps): (&[Expr], &[StopStep]),
        result: Option<Handle<Type>>,
        call: &dyn Fn(&mut Builder, &[Expr]) -> Option<Expr>,
    ) -> Option<Expr> {
        let returned = result.map(|ty| (ty, b.local("sc_returned", ty)));
        let once = |b: &mut Builder, given: &[Expr]| {
            let off = b.name(Expression::Literal(Literal::Bool(false)));
            self.set(b, self.stopped, off);
            let value = call(b, given);
            if let (Some((_, place)), Some(value)) = (returned, value) {
                b.store(place, value);
            }
        };
        if self.sites == 0 {
            once(b, given);
        } else {
            self.quads(b, module, given, steps, &once);
        }
        let (ty, place) = returned?;
        let pointer = b.global(self.stopped);
        let condition = b.load(pointer);
        b.when(condition, |b| {
            let zero = b.name(Expression::ZeroValue(ty));
            b.store(place, zero);
        });
        Some(b.load(place))
    }

    fn quads(
        &self,
        b: &mut Builder,
        module: &Module,
        given: &[Expr],
        steps: &[StopStep],
        once: &dyn Fn(&mut Builder, &[Expr]),
    ) {
        let runs = 4 * self.sites.min(MOST);
        let none = b.name(Expression::ZeroValue(module.global_variables[self.known].ty));
        self.set(b, self.known, none);
        let turn = b.local("sc_turn", self.word_ty);
        let zero = b.u32(0);
        b.store(turn, zero);
        b.repeat(
            |b| {
                let number = b.load(turn);
                let (zero, one, three, four) = (b.u32(0), b.u32(1), b.u32(3), b.u32(4));
                let member = b.binary(B::And, number, three);
                self.set(b, self.member, member);
                let pass = b.binary(B::Divide, number, four);
                let pass = b.binary(B::Add, pass, one);
                let (runs, never) = (b.u32(runs), b.u32(u32::MAX));
                let condition = b.binary(B::Less, number, runs);
                let pass = b.compute(Expression::Select { condition, accept: pass, reject: never });
                self.set(b, self.pass, pass);
                self.set(b, self.at, zero);
                for &(variable, constant) in &self.begin {
                    let value = b.name(Expression::Constant(constant));
                    self.set(b, variable, value);
                }
                let moved = self.moved(b, given, steps, member);
                once(b, &moved);
            },
            |b| {
                let number = b.load(turn);
                let (one, runs) = (b.u32(1), b.u32(runs));
                let next = b.binary(B::Add, number, one);
                b.store(turn, next);
                b.binary(B::Greater, next, runs)
            },
        );
    }
}

impl Stops {
    /// The arguments of a member of a quad.
    fn moved(&self, b: &mut Builder, given: &[Expr], all: &[StopStep], member: Expr) -> Vec<Expr> {
        let mut number = 0;
        let mut moved = Vec::new();
        for (&value, step) in given.iter().zip(all) {
            let by: Vec<[f64; 2]> = match *step {
                StopStep::Same => {
                    moved.push(value);
                    continue;
                }
                StopStep::Pixel => vec![[1.0, 0.0], [0.0, 1.0], [0.0; 2], [0.0; 2]],
                StopStep::Interpolated(count) => {
                    let first = number;
                    number += count;
                    (first..number).map(steps).collect()
                }
            };
            let mut value = value;
            for (bit, axis) in [(1, 0), (2, 1)] {
                let mut parts = Vec::new();
                for step in &by {
                    #[expect(clippy::cast_possible_truncation, reason = "steps are powers of two and small multiples")]
                    let step = step[axis] as f32;
                    parts.push(b.name(Expression::Literal(Literal::F32(step))));
                }
                let step = match parts[..] {
                    [one] => one,
                    _ => b.compute(Expression::Compose { ty: self.vectors[parts.len() - 2], components: parts }),
                };
                let away = b.binary(B::Add, value, step);
                let bit = b.u32(bit);
                let (set, zero) = (b.binary(B::And, member, bit), b.u32(0));
                let set = b.binary(B::NotEqual, set, zero);
                let condition = match by.len() {
                    1 => set,
                    n => b.compute(Expression::Splat { size: size(n), value: set }),
                };
                // The sample itself keeps its inputs, without a rounding.
                value = b.compute(Expression::Select { condition, accept: away, reject: value });
            }
            moved.push(value);
        }
        moved
    }
}

fn size(n: usize) -> naga::VectorSize {
    match n {
        2 => naga::VectorSize::Bi,
        3 => naga::VectorSize::Tri,
        _ => naga::VectorSize::Quad,
    }
}
