//! The entry points and functions of a text that is read as a module, each made ready to run or told why it cannot be.

use super::called::{MadeCaller, RETURN, with_caller};
use super::domain::{Law, Stated};
use super::realistic::Realistic;
use super::subject::{BadHint, Hints, Made, Ready, Subject, global, made, numbers, reason};
use super::textured::with_textures;
use super::wrapper::MOST_WORDS;
use crate::dispatch::Dispatched;
use crate::guess::{self, Passed, Role, Usages, Uses};
use base::value::Field;
use program::{Chosen, ModuleText, Port, PortAt, Program, Runnable};
use syntax::symbols::{FunctionInfo, SymbolId};
use syntax::types::Type;
use syntax::{Shader, Stage};

/// What can be run of a module, in the order of the text; what `wanted` wants is made ready, with these values of
/// `override` constants.
///
/// # Errors
/// Comments that state domains in a way that cannot be read.
pub fn subjects_of_module(
    text: &ModuleText,
    values: &[(String, String)],
    wanted: &dyn Fn(&str) -> bool,
) -> Result<Vec<Subject>, BadHint> {
    let mut all: Vec<Runnable> = text.points().into_iter().chain(text.functions()).collect();
    all.sort_by_key(|one| one.span.start);
    // The assertions of tests are nobody's code here.
    let is_own = |one: &Runnable| text.file().origin(one.span).0.name() == compose::ASSERTIONS;
    all.retain(|one| wanted(&one.name) && !is_own(one));
    let known = Known::of(text.tree())?;
    Ok(all.into_iter().map(|one| called(text, values, one.clone(), subject(text, values, one, &known))).collect())
}

/// A function that cannot be fed by itself, as a kernel that calls it; everything else as it is.
fn called(text: &ModuleText, values: &[(String, String)], one: Runnable, alone: Subject) -> Subject {
    if alone.ready.is_ok() || one.stage != Stage::Library {
        return alone;
    }
    if let Some(bound) = with_textures(text, &one.name) {
        return textured(&bound, values, &one, alone);
    }
    let Some(caller) = with_caller(text, &one.name) else { return alone };
    let Some(point) = caller.text.points().into_iter().find(|point| point.name == caller.kernel) else { return alone };
    let Ok(known) = Known::of(caller.text.tree()) else { return alone };
    if caller.alone {
        let ready = ready(&caller.text, values, &point, &|name| caller.own_name(name).to_owned());
        let Ok(ready) = ready.map(|made| readied(made, &one.name, &known)) else { return alone };
        let stated = stated(&ready, &one.name, &known);
        return Subject { ready: Ok(ready), stated, made_up: true, ..alone };
    }
    let as_kernel = subject(&caller.text, values, point, &known);
    if !matches!(as_kernel.dispatch, Some(Ok(_))) {
        return alone;
    }
    Subject { label: alone.label, name: alone.name, at: alone.at, made_up: true, ..as_kernel }
}

/// A function that takes textures, as one that has them bound.
fn textured(bound: &MadeCaller, values: &[(String, String)], one: &Runnable, alone: Subject) -> Subject {
    let Some(function) = bound.text.functions().into_iter().find(|own| own.name == bound.kernel) else { return alone };
    let Ok(known) = Known::of(bound.text.tree()) else { return alone };
    match ready(&bound.text, values, &function, &|name| bound.own_name(name).to_owned()) {
        Ok(made) => {
            let ready = readied(made, &one.name, &known);
            let stated = stated(&ready, &one.name, &known);
            Subject { ready: Ok(ready), stated, ..alone }
        }
        Err(why) => Subject { ready: Err(why), ..alone },
    }
}

/// What a text says of inputs: how they are used, and which domains comments state.
pub(crate) struct Known<'t> {
    tree: Option<&'t Shader>,
    usages: Option<Usages>,
    passed: Passed,
    hints: Option<Hints>,
}

impl<'t> Known<'t> {
    /// Of a text by its tree; nothing is known where there is none.
    ///
    /// # Errors
    /// Comments that state domains in a way that cannot be read.
    pub(crate) fn of(tree: Option<&'t Shader>) -> Result<Self, BadHint> {
        let passed = tree.map(Passed::of).unwrap_or_default();
        Ok(Self { tree, usages: tree.map(Usages::of), passed, hints: tree.map(Hints::read).transpose()? })
    }

    /// The laws that comments state for an input of a function or an entry point.
    pub(crate) fn stated(&self, function: &str, input: &str) -> Vec<Law> {
        let about = self.hints.as_ref().and_then(|hints| Some(hints.about(self.function(function)?)));
        let about = about.into_iter().flatten().filter(|stated| stated.is_about(function, input));
        about.map(|stated| stated.law).collect()
    }

    /// What comments state about a function.
    fn about(&self, function: &str) -> Vec<Stated> {
        let about = self.hints.as_ref().and_then(|hints| Some(hints.about(self.function(function)?)));
        about.unwrap_or_default()
    }

    fn function(&self, name: &str) -> Option<&FunctionInfo> {
        self.tree?.functions().find(|(_, info)| info.name.name == name).map(|(_, info)| info)
    }

    /// The parameter of a function that an input is.
    fn parameter(&self, function: &str, field: &Field) -> Option<SymbolId> {
        let root = field.name.split(['.', '[']).next()?;
        let params = &self.function(function)?.params;
        params.iter().find(|param| param.name.as_ref().is_some_and(|name| name.name == root))?.symbol
    }

    /// How an input is used: a parameter, a member of one that is a structure, or a variable of the module.
    pub(crate) fn uses(&self, function: &str, field: &Field) -> Uses {
        let (Some(tree), Some(usages)) = (self.tree, &self.usages) else { return Uses::default() };
        let root = field.name.split(['.', '[']).next().unwrap_or(&field.name);
        if let Some(symbol) = self.parameter(function, field) {
            return usages.of_input(symbol, &field.name);
        }
        let params = || self.function(function).into_iter().flat_map(|info| &info.params);
        let has = |ty: &Type| matches!(ty, Type::Struct(s) if s.fields.iter().any(|member| member.name == root));
        if let Some(symbol) = params().find(|param| has(&param.ty)).and_then(|param| param.symbol) {
            return usages.of_input(symbol, &format!("in.{}", field.name));
        }
        global(tree, root).map(|(symbol, _)| usages.of_input(symbol, &field.name)).unwrap_or_default()
    }
}

fn subject(text: &ModuleText, values: &[(String, String)], one: Runnable, known: &Known<'_>) -> Subject {
    let at = text.file().locate(one.span.start);
    let dispatch = (one.stage == Stage::Compute).then(|| dispatched(text, values, &one)).flatten();
    let ready = ready(text, values, &one, &str::to_owned).map(|made| readied(made, &one.name, known));
    let stated = ready.as_ref().map_or_else(|_| known.about(&one.name), |ready| stated(ready, &one.name, known));
    let name = one.name.split('(').next().unwrap_or_default().to_owned();
    Subject { label: one.name, name, parameters: one.parameters, at, ready, dispatch, stated, made_up: false }
}

/// A program that can be run, with what its inputs are taken for in a function.
fn readied((program, kernel, executable): Made, function: &str, known: &Known<'_>) -> Box<Ready> {
    let realistic = {
        let guess = |field: &Field| {
            let role = role(&program, field);
            let guess = guess::with_uses(field, role, &known.uses(function, field));
            (known.passed.narrowed(guess, known.parameter(function, field)), role == Role::Varying)
        };
        Realistic::new([&kernel.invocation, &kernel.case], &guess)
    };
    Box::new(Ready { program, kernel, executable, lowered: None, realistic, far: None })
}

/// What is stated of the inputs of a function, by comments and by the draw.
fn stated(ready: &Ready, function: &str, known: &Known<'_>) -> Vec<Stated> {
    let mut stated = known.about(function);
    stated.extend(numbers(ready, &ready.program.ranges, &stated));
    stated
}

fn dispatched(
    text: &ModuleText,
    values: &[(String, String)],
    one: &Runnable,
) -> Option<Result<Box<Dispatched>, String>> {
    let chosen = Chosen::Point { stage: Some(one.stage), name: Some(&one.name) };
    match text.program(chosen, values) {
        Ok(program) => Dispatched::new(&program).map(|ready| ready.map(Box::new)),
        Err(error) => Some(Err(reason(&error))),
    }
}

/// A program that can be run. `named` gives what its inputs and outputs are called.
fn ready(
    text: &ModuleText,
    values: &[(String, String)],
    one: &Runnable,
    named: &dyn Fn(&str) -> String,
) -> Result<Made, String> {
    let chosen = match one.stage {
        Stage::Library => Chosen::Function(&one.name),
        stage => Chosen::Point { stage: Some(stage), name: Some(&one.name) },
    };
    let program = text.program(chosen, values).map_err(|error| reason(&error))?;
    let mut program = program.with_memory_inside().map_err(|error| reason(&error))?;
    let fed = program.inputs.iter_mut().chain(&mut program.uniforms);
    for port in fed.chain(&mut program.outputs) {
        port.field.name = named(&port.field.name);
    }
    for texture in &mut program.textures {
        texture.name = named(&texture.name);
    }
    // What a function gives back is none of its inputs.
    program.inputs.retain(|port| port.field.name.split(['.', '[']).next() != Some(RETURN));
    let ports = program.inputs.iter().chain(&program.uniforms).chain(&program.outputs);
    let words: usize = ports.map(|port| port.field.shape.words()).sum();
    if words > MOST_WORDS {
        return Err(format!("it takes and gives {words} words; {MOST_WORDS} at most are fed"));
    }
    made(program)
}

/// Where the values of an input come from.
fn role(program: &Program, field: &Field) -> Role {
    let named = |port: &&Port| port.field.name == field.name;
    if program.uniforms.iter().any(|port| named(&port)) {
        return Role::Uniform;
    }
    if program.role != program::lower::Role::Fragment {
        return Role::Parameter;
    }
    let place = program.inputs.iter().find(named).and_then(|port| match port.at {
        PortAt::Argument(k) => program.binding_of(k),
        _ => None,
    });
    match place {
        Some(true) => Role::Screen,
        Some(false) => Role::Varying,
        None => Role::Parameter,
    }
}
