//! The functions of a file, each made ready to run or told why it cannot be.

use super::domain::{Interval, Law, Stated};
use super::hint;
use super::realistic::Realistic;
use super::slice::slice;
use super::wrapper::{self, Wrapped};
use crate::dispatch::{Dispatched, with_host_numbers};
use crate::guess::{self, Guess, Passed, Role, Usages};
use base::diagnostic::Diagnostic;
use base::text::{SourceFile, Span};
use base::value::Field;
use program::interp::{self, Executable};
use program::lower::Target;
use program::{DISCARD, Kernel, Parameter, Program, ProgramError};
use syntax::interface::Storage;
use syntax::precision::Precisions;
use syntax::symbols::{FunctionId, FunctionInfo, SymbolId, SymbolKind};
use syntax::types::Type;
use syntax::{Shader, Stage};

/// A function of a file.
pub struct Subject {
    /// Its name; with the types of its parameters where the file has several of that name.
    pub label: String,
    /// Its name alone.
    pub name: String,
    /// Its parameters; none of a stage or entry point.
    pub parameters: Vec<Parameter>,
    /// `name:line:column` of its name.
    pub at: String,
    /// The function, ready to run, or why it cannot be run.
    pub ready: Result<Box<Ready>, String>,
    /// A compute stage as a whole dispatch, or why it cannot be dispatched; none for anything else.
    pub dispatch: Option<Result<Box<Dispatched>, String>>,
    /// Domains that comments in the file state for it.
    pub stated: Vec<Stated>,
    /// True for a function that is run by a caller that is made up: what is found in it is a warning.
    pub made_up: bool,
}

/// A function that can be run.
pub struct Ready {
    /// The sliced text with the function as its entry.
    pub program: Program,
    /// The program with outputs captured, for lanes.
    pub kernel: Kernel,
    /// What the interpreter runs.
    pub executable: Executable,
    /// The same for a device on which `mediump` is less than binary32; none where nothing is lower.
    pub lowered: Option<Executable>,
    /// What a program would give it.
    pub realistic: Realistic,
    /// The same as far as it comes on phones, where something is lower and that is farther.
    pub far: Option<Realistic>,
}

impl Ready {
    /// The same with the precisions that the text of the stage states, in desktop GLSL too.
    pub(crate) fn with_stated_precisions(self, shader: &Shader) -> Self {
        let mut program = self.program;
        program.manners = std::sync::Arc::new(program::Manners::by(shader, &Precisions::stated(shader)));
        let lowered = lowered(&program);
        Self { program, lowered, ..self }
    }
}

/// A comment that cannot be read, or names no input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadHint {
    /// `name:line:column` of the comment.
    pub at: String,
    /// Why the comment cannot be read or used.
    pub why: String,
}

/// The functions of a shader that have a body, in the order of the text; those that `wanted` wants are
/// made ready.
///
/// # Errors
/// Comments that state domains in a way that cannot be read.
pub fn subjects(shader: &Shader, wanted: &dyn Fn(&str) -> bool) -> Result<Vec<Subject>, BadHint> {
    let hints = Hints::read(shader)?;
    let defined: Vec<(FunctionId, &FunctionInfo)> =
        shader.functions().filter(|(_, f)| f.definition.is_some()).collect();
    let mut subjects = Vec::new();
    let ranges = program::ranges(shader);
    let known = (Usages::of(shader), Passed::of(shader));
    for &(id, info) in &defined {
        let name = &info.name.name;
        let overloaded = defined.iter().filter(|(_, f)| f.name.name == *name).count() > 1;
        let label = if overloaded { signature(info) } else { name.clone() };
        if !wanted(name) && !wanted(&label) {
            continue;
        }
        let at = shader.file().locate(info.name.span.start);
        let mut stated = hints.about(info);
        let dispatch = dispatched(shader, info);
        let ready = ready(shader, id, info).map(|(program, kernel, executable)| {
            let own = realistic(shader, info, &known, &kernel, false);
            let lowered = lowered(&program);
            let far = lowered.as_ref().map(|_| realistic(shader, info, &known, &kernel, true));
            let far = far.filter(|far| !far.far().is_empty());
            Box::new(Ready { program, kernel, executable, lowered, realistic: own, far })
        });
        stated.extend(ready.iter().flat_map(|ready| numbers(ready, &ranges, &stated)).collect::<Vec<_>>());
        let parameters = info.params.iter().map(Parameter::of).collect();
        subjects.push(Subject { label, name: name.clone(), parameters, at, ready, dispatch, stated, made_up: false });
    }
    Ok(subjects)
}

/// The ranges of inputs that are numbers of the draw, where nothing else is stated of them.
pub(super) fn numbers(ready: &Ready, ranges: &[(String, u32)], stated: &[Stated]) -> Vec<Stated> {
    let reads = |name: &str| ready.kernel.invocation.index_of(name).or(ready.kernel.case.index_of(name)).is_some();
    let open = |name: &str| !stated.iter().any(|stated| stated.input == name);
    let within = |(name, most): &(String, u32)| {
        let interval = Interval { low: 0.0, high: f64::from(*most), open_low: false, open_high: false };
        Stated { input: name.clone(), law: Law::Within(interval), at: "the draw".to_owned(), whole_file: true }
    };
    ranges.iter().filter(|(name, _)| reads(name) && open(name)).map(within).collect()
}

/// What the inputs of a function are taken for; as far as they come where `far` says so.
fn realistic(
    shader: &Shader,
    info: &FunctionInfo,
    (usages, passed): &(Usages, Passed),
    kernel: &Kernel,
    far: bool,
) -> Realistic {
    let guess = |field: &Field| {
        let root = field.name.split(['.', '[']).next().unwrap_or(&field.name);
        let param = info.params.iter().find(|param| param.name.as_ref().is_some_and(|name| name.name == root));
        let (symbol, role) = match param.filter(|_| info.name.name != "main") {
            Some(param) => (param.symbol, Role::Parameter),
            None => global(shader, root).map_or((None, Role::Parameter), |(symbol, storage)| {
                let role = match storage {
                    Storage::Uniform => Role::Uniform,
                    Storage::In if shader.stage() == Stage::Fragment => Role::Varying,
                    _ => Role::Parameter,
                };
                (Some(symbol), role)
            }),
        };
        let uses = symbol.map(|symbol| usages.of_input(symbol, &field.name)).unwrap_or_default();
        (passed.narrowed(guess::with_uses(field, role, &uses), symbol), role == Role::Varying)
    };
    let records = [&*kernel.invocation, &*kernel.case];
    if !far {
        return Realistic::new(records, &guess);
    }
    let mut farther = Vec::new();
    for field in records.into_iter().flat_map(|record| record.fields()) {
        if let Some(Guess { taken_for, range: Some([_, most]), .. }) = guess(field).0.far() {
            farther.push(format!("`{}` for {taken_for} of up to {most}", field.name));
        }
    }
    let at_most = |field: &Field| {
        let (near, varying) = guess(field);
        (near.far().unwrap_or(near), varying)
    };
    Realistic::new(records, &at_most).with_far(farther)
}

/// A variable of the interface by its name, or that of its block.
pub(super) fn global(shader: &Shader, name: &str) -> Option<(SymbolId, Storage)> {
    let (id, symbol) = shader
        .symbols()
        .find(|(_, symbol)| symbol.name == name && !matches!(symbol.kind, SymbolKind::Param(_) | SymbolKind::Local))?;
    Some((
        id,
        match symbol.kind {
            SymbolKind::Global(storage) => storage,
            SymbolKind::BlockMember(block) | SymbolKind::BlockInstance(block) => {
                shader.interface().blocks[block].storage
            }
            SymbolKind::Builtin | SymbolKind::Param(_) | SymbolKind::Local => Storage::Global,
        },
    ))
}

/// `name(vec3, float)`
fn signature(info: &FunctionInfo) -> String {
    let types: Vec<String> = info.params.iter().map(|p| p.ty.to_string()).collect();
    format!("{}({})", info.name.name, types.join(", "))
}

/// A program, with outputs captured, and as the interpreter runs it.
pub(super) type Made = (Program, Kernel, Executable);

fn ready(shader: &Shader, id: FunctionId, info: &FunctionInfo) -> Result<Made, String> {
    let main = info.name.name == "main";
    if main && matches!(shader.stage(), Stage::Vertex | Stage::Geometry | Stage::Fragment | Stage::Compute) {
        // The stage as it is; where that cannot be run, the same as an ordinary function.
        // Whole numbers stay: loops of as many rounds as a host may state are dispatched in few sizes, not run by the thousand.
        let stage = stage_of(shader, &[Type::FLOAT]).map_err(|e| reason(&e));
        let with_memory = stage.and_then(|program| program.with_memory_inside().map_err(|e| reason(&e)));
        match with_memory.and_then(made) {
            Ok(ready) => return Ok(ready),
            Err(why) if matches!(shader.stage(), Stage::Geometry | Stage::Compute) => return Err(why),
            // What stops the stage says more than what stops the function.
            Err(why) => return alone(shader, id, info).map_err(|_| why),
        }
    }
    alone(shader, id, info)
}

/// A compute stage as its author wrote it.
fn dispatched(shader: &Shader, info: &FunctionInfo) -> Option<Result<Box<Dispatched>, String>> {
    if info.name.name != "main" || shader.stage() != Stage::Compute {
        return None;
    }
    match stage_of(shader, &[Type::INT, Type::UINT, Type::FLOAT]) {
        Ok(program) => Dispatched::new(&program).map(|ready| ready.map(Box::new)),
        Err(error) => Some(Err(reason(&error))),
    }
}

/// The stage, with specialization constants of some types as numbers of the host where their values hold a place.
fn stage_of(shader: &Shader, types: &[Type]) -> Result<Program, ProgramError> {
    let made =
        |file: &SourceFile| Program::from_source_with(file, shader.stage(), shader.defines(), |_| Ok(Target::Stage));
    let of_host = with_host_numbers(shader, types).and_then(|file| made(&file).ok());
    of_host.map_or_else(|| made(shader.file()), Ok)
}

/// The function in a text of its own.
fn alone(shader: &Shader, id: FunctionId, info: &FunctionInfo) -> Result<Made, String> {
    let Wrapped { file, inputs, outputs } = wrapper::wrap(shader, info, &slice(shader, id))?;
    let target = Target::Function(wrapper::NAME.to_owned());
    let mut program =
        Program::from_source_with(&file, Stage::Library, shader.defines(), |_| Ok(target)).map_err(|e| reason(&e))?;
    // Whether it discards is an output that nobody declares.
    let own = program.outputs.iter().filter(|port| port.field.name != DISCARD).count();
    if (program.inputs.len(), own) != (inputs.len(), outputs.len()) {
        return Err("internal error, please report: its parameters got lost".to_owned());
    }
    program.inputs.iter_mut().zip(inputs).for_each(|(port, name)| port.field.name = name);
    program.outputs.iter_mut().zip(outputs).for_each(|(port, name)| port.field.name = name);
    made(program.with_memory_inside().map_err(|error| reason(&error))?)
}

pub(super) fn made(program: Program) -> Result<Made, String> {
    let kernel = program.compute_kernel().map_err(|e| reason(&e))?;
    if kernel.output.is_empty() {
        return Err("it writes no output".to_owned());
    }
    let executable = interp::compile(&program).map_err(|e| e.locate(&program))?;
    Ok((program, kernel, executable))
}

/// A program as a device runs it on which `mediump` is less than binary32.
fn lowered(program: &Program) -> Option<Executable> {
    if !program.manners.lower() {
        return None;
    }
    interp::compile_lowered(program).ok()
}

/// Why a program cannot be made, in one line with the place in the author's file.
pub(super) fn reason(error: &ProgramError) -> String {
    let first = |found: &[Diagnostic]| {
        let d = found.first()?.clone().at_origin();
        Some(format!("{}: {}", d.file.locate(d.span.start), d.message))
    };
    match error {
        ProgramError::Source(found) => first(found).unwrap_or_else(|| error.to_string()),
        ProgramError::Unsupported { .. } | ProgramError::Internal(_) => error.to_string(),
    }
}

/// Domains that comments state.
pub(super) struct Hints {
    /// Each with the item that it stands before: the function's, or none for a comment before anything
    /// else, which is about the whole file.
    all: Vec<(Option<usize>, Stated)>,
}

impl Hints {
    pub(super) fn read(shader: &Shader) -> Result<Self, BadHint> {
        use syntax::ast::ItemKind;
        let items = &shader.unit().items;
        let mut all = Vec::new();
        for comment in shader.comments() {
            let text = shader.file().slice(comment.span);
            let at = shader.file().locate(comment.span.start);
            let stated = match hint::comment(text, &at) {
                None => continue,
                Some(Ok(stated)) => stated,
                Some(Err(why)) => return Err(BadHint { at, why }),
            };
            // A comment inside of a function, or behind its head, is about that function.
            let inside = items.iter().position(|item| item.span.contains(comment.span.start));
            let after = items.iter().position(|item| item.span.start >= comment.span.end);
            let on_line = |index: &usize| {
                let between = Span::new(items[*index].span.end, comment.span.start);
                !between.is_empty() && !shader.file().slice(between).contains('\n')
            };
            let before = (0..items.len()).rev().find(|&k| items[k].span.end <= comment.span.start).filter(on_line);
            let item = inside.or(before).or(after);
            let function = item.filter(|&k| matches!(items[k].kind, ItemKind::Function(_)));
            all.extend(stated.into_iter().map(|s| (function, Stated { whole_file: function.is_none(), ..s })));
        }
        Ok(Self { all })
    }

    pub(super) fn about(&self, info: &FunctionInfo) -> Vec<Stated> {
        let here =
            |item: &Option<usize>| item.is_none_or(|k| info.definition == Some(k) || info.prototypes.contains(&k));
        self.all.iter().filter(|(item, _)| here(item)).map(|(_, s)| s.clone()).collect()
    }
}
