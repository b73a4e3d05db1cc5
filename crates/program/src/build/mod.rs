//! From the typed syntax tree to a naga module, without a detour through text: what GLSL of any version
//! means is said in naga's own terms, with the author's places.
//!
//! Functions are built when they are first called, once for each set of samplers that they get.
//! Variables of the interface are private variables that the entry point fills and hands on. What naga
//! cannot express is refused by name, at its place.

mod buffer;
mod builtin;
mod call;
mod chosen;
mod constructor;
mod discard;
mod effect;
mod entry;
mod expression;
mod function;
mod global;
mod image;
mod io;
mod known;
mod limits;
mod lookup;
mod math;
mod operator;
mod patch;
mod place;
pub(crate) mod quad;
mod repack;
mod shared;
mod single;
mod statement;
mod stream;
mod subgroup;
mod texture;
mod types;

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use naga::proc::Layouter;
use naga::{BuiltIn, Expression, Function, GlobalVariable, Handle, Module};

use super::front::{INCOMPLETE, UNSUPPORTED};
use super::memory::Memory;
use super::{Entry, Port, Program, ProgramError, contain, front};
use crate::lower::{Primitives, Role, Target};
use base::diagnostic::{Diagnostic, Severity};
use base::text::Span;
use syntax::ast::ExprId;
use syntax::interface::{InputPrimitive, OutputPrimitive, Storage};
use syntax::real::Reals;
use syntax::symbols::{FunctionId, SymbolId};
use syntax::types::{ArraySize, Type};
use syntax::{Shader, Stage};

pub(crate) use buffer::axes_of_texels;
pub(crate) use math::name_of_each;

pub use discard::DISCARD;
pub(crate) use subgroup::BY_INDEX;

/// A macro with which numbers of 8 bits take in buffers the place of those of 32: naga has none.
pub const WIDE_BYTES: &str = "SHADERCHECK_WIDE_BYTES";

/// A macro with the size of workgroups that a text leaves to its host: `64,1,1`.
pub const WORKGROUP_SIZE: &str = "SHADERCHECK_WORKGROUP_SIZE";

/// The size of workgroups: as the text states it, or as whoever reads the text chose it, or 1.
fn workgroup(shader: &Shader) -> std::result::Result<[u32; 3], ProgramError> {
    let chosen = || shader.defines().iter().find(|(name, _)| name == WORKGROUP_SIZE);
    let (None, Some((_, value))) = (shader.workgroup_size(), chosen()) else {
        return Ok(shader.workgroup_size().unwrap_or([1; 3]));
    };
    let sizes: Option<Vec<u32>> = value.split(',').map(|n| n.trim().parse().ok().filter(|&n| n > 0)).collect();
    sizes.and_then(|sizes| sizes.try_into().ok()).ok_or_else(|| {
        let at = shader.file().text().find("local_size_").unwrap_or(0);
        let what = format!("`{WORKGROUP_SIZE}` is `{value}`; state a size for each of three axes, such as `64,1,1`");
        ProgramError::Source(vec![Diagnostic::new(UNSUPPORTED, Severity::Error, shader.file(), Span::at(at), what)])
    })
}

type Expr = Handle<Expression>;
/// Something that the harness has no way to pass, with its place.
type Unfed = (String, Span);
type Result<T> = std::result::Result<T, Box<Diagnostic>>;

/// A module under construction.
struct Build<'s> {
    shader: &'s Shader,
    module: Module,
    layouter: Layouter,
    /// Values of constant expressions.
    reals: Reals,
    /// True for the module that is run, false for the one that a host gets.
    run: bool,
    /// The two differ.
    differs: bool,
    /// For what no translation says the one that is run has something else.
    stands: Option<Box<Diagnostic>>,
    workgroup: [u32; 3],
    /// Numbers of 8 bits stand in buffers as those of 32.
    wide_bytes: bool,
    /// Types for which that was done.
    widened: Vec<String>,
    made: MadeNames,
    ports: Ports,
    leaving: Leaving,
}

/// What was made of the names of the text.
#[derive(Default)]
struct MadeNames {
    globals: HashMap<SymbolId, global::Global>,
    /// Symbols by place and name of their declaration.
    by_place: HashMap<(usize, String), Vec<SymbolId>>,
    functions: HashMap<(FunctionId, Vec<String>), Handle<Function>>,
    /// Functions being built, to find recursion.
    active: Vec<FunctionId>,
    emission: HashMap<String, Handle<Function>>,
    textures: HashMap<String, texture::Texture>,
    /// Counters, textures and images that are buffers.
    buffers: HashMap<String, buffer::TexelBuffer>,
    /// Built-in variables that the text does not name.
    unnamed: HashMap<String, Handle<GlobalVariable>>,
    /// Initialisers of constants in functions.
    local_constants: HashMap<SymbolId, ExprId>,
    /// Initial values that are computed when the program starts.
    initial: Vec<(SymbolId, ExprId)>,
}

/// What goes into the entry point and comes out of it.
#[derive(Default)]
struct Ports {
    /// What the harness binds.
    bound: Vec<super::Texture>,
    next_binding: u32,
    incoming: Vec<io::Incoming>,
    outgoing: Vec<io::Outgoing>,
    /// Locations that several variables share, and what lies in each.
    shared: shared::Shared,
    in_locations: io::Locations,
    out_locations: io::Locations,
    inputs: Vec<Port>,
    uniforms: Vec<Port>,
    built_in_outputs: Vec<Port>,
    outputs: Vec<Port>,
    built_ins: Vec<(u32, BuiltIn)>,
    /// Numbers of the draw, which stand behind all attributes.
    drawn: Vec<Port>,
    /// Inputs of the stage, which a function alone does not get.
    stage_inputs: Vec<(String, Handle<GlobalVariable>, Span)>,
    /// What the harness has no way to feed or read.
    unfed: Vec<Unfed>,
    /// Storage blocks.
    memory: Vec<Memory>,
}

/// How an invocation leaves all its functions: it is discarded, or stops at a derivative.
#[derive(Default)]
struct Leaving {
    /// Whether it does.
    discard: Option<Handle<GlobalVariable>>,
    /// It can be discarded.
    discards: bool,
    /// What derivatives need.
    quad: Option<quad::Quad>,
    /// Derivatives that each function comes to.
    sites: HashMap<Handle<Function>, u32>,
    /// Functions behind whose calls the invocation may be discarded.
    stopping: HashSet<Handle<Function>>,
}

/// Builds a program out of a shader in which the front end found no error.
pub(super) fn program(shader: &Shader, target: &Target) -> std::result::Result<Program, ProgramError> {
    let reals = Reals::new(shader, &|_, value| value);
    let (mut program, differs) = one(shader, target, true, reals.clone())?;
    if differs && program.role == Role::Fragment && program.untranslatable.is_none() {
        let (host, _) = one(shader, target, false, reals)?;
        program.stage_module = Some(Arc::new((host.module, host.info)));
    }
    Ok(program)
}

/// The module that a host gets of a text that was written from another one. What is constant there is computed as it is
/// written: the other text has the same operations, and folding them here would round once where it rounds often.
pub(super) fn host(shader: &Shader) -> std::result::Result<Module, ProgramError> {
    Ok(one(shader, &Target::Stage, false, Reals::default())?.0.module)
}

/// One of the two modules of a shader, and whether the other one is not the same.
fn one(
    shader: &Shader,
    target: &Target,
    run: bool,
    reals: Reals,
) -> std::result::Result<(Program, bool), ProgramError> {
    let mut build = Build {
        shader,
        module: Module::default(),
        layouter: Layouter::default(),
        reals,
        run,
        differs: false,
        stands: None,
        workgroup: workgroup(shader)?,
        wide_bytes: shader.defines().iter().any(|(name, _)| name == WIDE_BYTES),
        widened: Vec::new(),
        made: MadeNames::default(),
        ports: Ports::default(),
        leaving: Leaving::default(),
    };
    let built = contain(|| build.run(target))
        .map_err(|panic| ProgramError::internal(format!("a module cannot be built: {panic}")))?;
    let (entry, role) = built.map_err(|refused| ProgramError::Source(vec![*refused]))?;
    let Build { module, ports, differs, stands, .. } = build;
    let Ports { inputs, uniforms, outputs, built_ins, mut unfed, bound, stage_inputs, memory, .. } = ports;
    let info = front::validate_text(shader.file(), &module)?;
    if let Entry::Function(function) = entry {
        let read = stage_inputs.into_iter().filter(|(_, handle, _)| !info[function][*handle].is_empty());
        unfed.extend(read.map(|(name, _, span)| (format!("`{name}`, an input of the stage,"), span)));
    }
    let unfed = unfed
        .into_iter()
        .map(|(what, span)| {
            let message = format!("{what} cannot be fed or read");
            let help = "it can be translated; to run it, pass numbers, vectors, matrices and arrays of them";
            Diagnostic::new(UNSUPPORTED, Severity::Error, shader.file(), span, message).with_help(help)
        })
        .collect();
    let textures = used(bound, &info, entry);
    let program = Program {
        module,
        info,
        entry,
        role,
        inputs,
        uniforms,
        outputs,
        built_ins,
        ranges: Vec::new(),
        textures,
        stage_module: None,
        untranslatable: stands,
        unfed,
        memory,
        file: shader.file().clone(),
        stage: shader.stage(),
        written: crate::Written::Glsl,
        defines: shader.defines().to_vec(),
        instrumented: false,
        dispatch: None,
        texts: Vec::new(),
        constants: Arc::default(),
        manners: Arc::new(crate::Manners::of(shader)),
    };
    Ok((program, differs))
}

/// The textures that what is run looks at.
fn used(mut bound: Vec<super::Texture>, info: &naga::valid::ModuleInfo, entry: Entry) -> Vec<super::Texture> {
    let info = match entry {
        Entry::Point(index) => info.get_entry_point(index),
        Entry::Function(function) => &info[function],
    };
    bound.retain(|texture| !info[texture.image].is_empty());
    bound
}

fn naga_span(span: Span) -> naga::Span {
    let part = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    naga::Span::new(part(span.start), part(span.end))
}

impl Build<'_> {
    fn run(&mut self, target: &Target) -> Result<(Entry, Role)> {
        let shader = self.shader;
        self.reserve_locations();
        self.declare()?;
        match (target, shader.stage()) {
            (Target::Function(name), _) => self.single(name),
            (Target::Stage, stage) if stage != Stage::Library => {
                let role = match stage {
                    Stage::Vertex => Role::Vertex,
                    Stage::Fragment => Role::Fragment,
                    Stage::Geometry => Role::Geometry(self.primitives()?),
                    Stage::Compute => Role::Compute,
                    // One invocation is a function over the vertices of a patch.
                    Stage::TessControl | Stage::TessEvaluation | Stage::Library => {
                        Role::Function { name: "main".to_owned() }
                    }
                };
                if matches!(role, Role::Geometry(_)) {
                    self.emission("EmitVertex");
                    self.emission("EndPrimitive");
                }
                let mut mains = shader.functions().filter(|(_, f)| f.name.name == "main" && f.definition.is_some());
                let Some((main, _)) = mains.next() else {
                    return Err(self.incomplete(Span::at(0), "there is no `main`", "write it, or choose a function"));
                };
                self.entry(main)?;
                Ok((Entry::Point(0), role))
            }
            (Target::Stage, stage) => {
                let message = format!("a {} shader as a stage", stage.name());
                Err(self.unsupported(
                    Span::at(0),
                    message,
                    "run one of its functions: `stage = \"function\"` and `entry`",
                ))
            }
        }
    }

    fn primitives(&mut self) -> Result<Primitives> {
        let layout = &self.shader.interface().geometry;
        let (input, output, max) = (layout.input, layout.output, layout.max_vertices);
        if input.is_none() || output.is_none() || max.is_none() {
            // Another text of the stage may have the layout: the module stands, and is not run.
            let what = "a geometry shader without `layout(…) in;` or `layout(…, max_vertices = N) out;`";
            self.ports.unfed.push((what.to_owned(), Span::at(0)));
        }
        // Invocations run one after the other, and all that they emit comes out.
        let most = max.map_or(1, |m| m.value).saturating_mul(layout.invocations.map_or(1, |n| n.value));
        Ok(Primitives {
            input: self.input_primitive(),
            output: output.map_or(OutputPrimitive::TriangleStrip, |o| o.value),
            max_vertices: most,
        })
    }

    /// The primitive that a geometry stage takes: the written one, or the one that its arrays fit.
    fn input_primitive(&self) -> InputPrimitive {
        let interface = self.shader.interface();
        if let Some(input) = interface.geometry.input {
            return input.value;
        }
        let blocks = interface.blocks.iter().filter(|b| b.storage == Storage::In).map(|b| &b.ty);
        let sizes = interface.inputs.iter().map(|v| &v.ty).chain(blocks).find_map(|ty| match ty {
            Type::Array(_, ArraySize::Known(n)) => Some(*n),
            _ => None,
        });
        match sizes {
            Some(1) => InputPrimitive::Points,
            Some(2) => InputPrimitive::Lines,
            Some(4) => InputPrimitive::LinesAdjacency,
            Some(6) => InputPrimitive::TrianglesAdjacency,
            _ => InputPrimitive::Triangles,
        }
    }

    /// A function that capture fills in.
    fn emission(&mut self, name: &str) -> Handle<Function> {
        if let Some(&handle) = self.made.emission.get(name) {
            return handle;
        }
        let mut body = naga::Block::new();
        body.push(naga::Statement::Return { value: None }, naga::Span::UNDEFINED);
        let function = Function { name: Some(name.to_owned()), body, ..Function::default() };
        let handle = self.module.functions.append(function, naga::Span::UNDEFINED);
        self.made.emission.insert(name.to_owned(), handle);
        handle
    }

    fn unsupported(&self, span: Span, what: impl Into<String>, help: &str) -> Box<Diagnostic> {
        let what: String = what.into();
        let message = format!("{what} cannot be expressed by the translator");
        Box::new(Diagnostic::new(UNSUPPORTED, Severity::Error, self.shader.file(), span, message).with_help(help))
    }

    /// Takes something else for what no translation can say; refused in the module that a host gets.
    fn stand_for(&mut self, span: Span, what: impl Into<String>, help: &str) -> Result<()> {
        let refused = self.unsupported(span, what, help);
        if !self.run {
            return Err(refused);
        }
        self.stands.get_or_insert(refused);
        Ok(())
    }

    fn incomplete(&self, span: Span, message: &str, help: &str) -> Box<Diagnostic> {
        Box::new(
            Diagnostic::new(INCOMPLETE, Severity::Error, self.shader.file(), span, message.to_owned()).with_help(help),
        )
    }
}
