//! A program: a naga module with the interface that the author sees and the way back to the text.

mod build;
mod capabilities;
mod capture;
mod constants;
mod contain;
mod declared;
mod dialect;
mod dispatched;
mod drawn;
mod front;
mod fuel;
pub mod interp;
mod lacks;
pub mod lane;
mod layout;
pub mod lower;
mod manner;
mod memory;
mod parameter;
pub mod probe;
mod read;
mod readback;
mod source;
mod strides;
mod supply;
pub mod texture;
mod translate;

use std::sync::Arc;

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{BuiltIn, GlobalVariable, Handle, Module, Type};
use thiserror::Error;

use crate::lower::Target;
use base::diagnostic::Diagnostic;
use base::text::SourceFile;
use base::value::Field;
use syntax::{Shader, Stage};

pub use crate::lower::{Primitives, Role};
pub use build::{DISCARD, WIDE_BYTES, WORKGROUP_SIZE};
pub use capture::{
    Attribute, BoundBuffer, ENTRY_POINT, Form, InputSource, Kernel, OutputLayout, UniformBlock, UniformPlace,
    WORKGROUP, binding, uniform_blocks,
};
pub use constants::{Constant, Constants, WrittenLiteral};
pub use contain::{Panic, contain, contain_whole};
pub use dispatched::{Dispatch, Dispatched, HostBuffer};
pub use drawn::ranges;
pub use drawn::{Count, Drawn};
pub use front::{COMPILER, INCOMPLETE, NAGA, UNSUPPORTED, VALIDATOR};
pub use manner::{Grade, Manner, Manners};
pub use memory::LENGTH as ELEMENTS_ALONE;
pub use parameter::Parameter;
pub use probe::Probed;
pub use read::{Chosen, Head, ModuleText, OWN, Outline, Param, Runnable, Way, Written, holds_in_any_version, listing};
pub use readback::{Place, ReadBack};
pub use texture::Texture;
pub use translate::{Language, TranslateError, Translation, read_back};

/// What GLSL calls the position of a vertex.
pub const POSITION: &str = "gl_Position";

/// Name of the variable without a value that a function gives at its end where its author returns nothing.
pub const NO_RETURN: &str = "sc_no_return";

/// Why there is no program or kernel.
#[derive(Debug, Error)]
pub enum ProgramError {
    /// The text is wrong; each diagnostic stands at its place in the author's text.
    #[error("{}", summary(.0))]
    Source(Vec<Diagnostic>),
    /// Something that cannot be run here.
    #[error("not supported: {what}")]
    Unsupported {
        /// The construct or limit in words about the source.
        what: String,
    },
    /// A defect of shadercheck itself.
    #[error("internal error, please report: {0}")]
    Internal(String),
}

impl ProgramError {
    pub(crate) fn internal(what: String) -> Self {
        Self::Internal(what)
    }
}

fn summary(diagnostics: &[Diagnostic]) -> String {
    let lines: Vec<String> = diagnostics
        .iter()
        .map(|d| format!("{}: {}[{}]: {}", d.file.locate(d.span.start), d.severity.name(), d.code, d.message))
        .collect();
    lines.join("\n")
}

/// What is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// An entry point, by index.
    Point(usize),
    /// An ordinary function.
    Function(Handle<naga::Function>),
}

/// Where an input or output lies in the module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PortAt {
    /// An argument, by value.
    Argument(u32),
    /// An argument, by reference (`out`, `inout`).
    Reference(u32),
    /// Several arguments, one for each vector of a matrix or array.
    Arguments {
        /// Index of the first of these arguments.
        first: u32,
        /// How many there are.
        count: u32,
    },
    /// The value that the function returns.
    Result,
    /// A member of the structure that the entry point returns.
    ResultMember(u32),
    /// A global variable.
    Global(Handle<GlobalVariable>),
    /// A member of a global structure.
    Member(Handle<GlobalVariable>, u32),
    /// A part of a global variable, further in.
    Part {
        /// The whole variable.
        global: Handle<GlobalVariable>,
        /// Indices of members, elements and columns on the way there.
        path: Vec<u32>,
    },
    /// One member of each element of a global array of structures: `gl_in[].gl_Position`.
    Vertices {
        /// The array.
        global: Handle<GlobalVariable>,
        /// Index of the member.
        member: u32,
        /// Number of elements.
        count: u32,
    },
}

/// An input, uniform or output of a program.
#[derive(Clone, Debug)]
pub struct Port {
    /// Name and shape as the author sees them.
    pub field: Field,
    /// Type in the module. For [`PortAt::Vertices`], the array of the member's type.
    pub ty: Handle<Type>,
    /// Where it lies.
    pub at: PortAt,
    /// The private variable that holds an output of an entry point until it returns.
    pub backing: Option<Handle<GlobalVariable>>,
}

/// A shader that can be run: a validated module and its interface.
#[derive(Clone, Debug)]
pub struct Program {
    /// The module: built from the syntax tree of a text in GLSL, read by naga from others.
    pub module: Module,
    /// What the validator found out about it.
    pub info: ModuleInfo,
    /// What is run.
    pub entry: Entry,
    /// How it is run.
    pub role: Role,
    /// What one invocation takes.
    pub inputs: Vec<Port>,
    /// What one case takes.
    pub uniforms: Vec<Port>,
    /// What one vertex, primitive vertex or call gives.
    pub outputs: Vec<Port>,
    /// Built-in arguments of the entry point that are no inputs, by argument index: those of a compute stage, which is
    /// dispatched alone.
    pub built_ins: Vec<(u32, BuiltIn)>,
    /// Samplers, with what they are bound to when the program is run.
    pub textures: Vec<Texture>,
    /// For a fragment stage, the module as a host gets it, where what is run differs: it discards, takes
    /// derivatives, or leaves the level of detail to them.
    pub stage_module: Option<Arc<(Module, ModuleInfo)>>,
    /// What no translation can say, where a run takes something else for it: such a program is run, and not translated.
    pub untranslatable: Option<Box<Diagnostic>>,
    /// What the harness has no way to feed or read: such a program is translated, and not run.
    pub unfed: Vec<Diagnostic>,
    /// Inputs that are numbers of the draw, with the largest value that is tried where nothing is stated.
    pub ranges: Vec<(String, u32)>,
    /// For a whole dispatch, how it is made.
    pub dispatch: Option<Arc<Dispatched>>,
    /// Storage blocks that are no inputs and outputs yet.
    pub(crate) memory: Vec<memory::Memory>,
    /// The author's text, to which all places belong.
    pub file: SourceFile,
    /// Stage of the text.
    pub stage: Stage,
    /// What the text is written in.
    pub written: Written,
    /// Macros that are given from outside: names and values.
    pub defines: Vec<(String, String)>,
    /// True for a program that gives more than its text says: a trace of its operations, or what its memory holds.
    pub instrumented: bool,
    /// The author's own texts in GLSL, for a lane whose driver reads GLSL itself: several where several are linked into
    /// the stage; none for a program that comes from elsewhere.
    pub texts: Vec<SourceFile>,
    /// Constant expressions of the text, as their author means them.
    pub constants: Arc<Constants>,
    /// The precision of operations, and what is `precise`.
    pub manners: Arc<Manners>,
}

impl Program {
    /// Builds a program out of the syntax tree, in whatever version it is written.
    ///
    /// # Errors
    /// [`ProgramError::Source`] for what naga cannot express, at its place in the author's text.
    pub fn build(shader: &Shader, target: &Target) -> Result<Self, ProgramError> {
        build::program(shader, target)
    }

    /// The arguments of the entry point that are built-in values.
    /// True for a program with numbers of binary16.
    pub fn has_halves(&self) -> bool {
        self.module.types.iter().any(|(_, ty)| ty.inner.scalar() == Some(naga::Scalar::F16))
    }

    /// True for a program whose invocations see values of their subgroup, or ask which of it they are.
    pub fn uses_subgroups(&self) -> bool {
        memory::uses_subgroups(&self.module)
    }

    pub(crate) fn built_ins_of_entry(&self) -> Vec<(u32, BuiltIn)> {
        let Entry::Point(index) = self.entry else { return Vec::new() };
        let arguments = self.module.entry_points.get(index).map_or(&[][..], |point| &point.function.arguments);
        let built_in = |(k, argument): (u32, &naga::FunctionArgument)| match argument.binding {
            Some(naga::Binding::BuiltIn(built_in)) => Some((k, built_in)),
            _ => None,
        };
        (0..).zip(arguments).filter_map(built_in).collect()
    }

    /// Invocations of a workgroup along x, y and z; `None` for what is no compute stage.
    pub fn workgroup_size(&self) -> Option<[u32; 3]> {
        let Entry::Point(index) = self.entry else { return None };
        let point = self.module.entry_points.get(index)?;
        (point.stage == naga::ShaderStage::Compute).then_some(point.workgroup_size)
    }

    /// For an argument of a fragment stage that is interpolated or the place of the fragment: true for the place.
    pub fn binding_of(&self, argument: u32) -> Option<bool> {
        let Entry::Point(index) = self.entry else { return None };
        let arguments = &self.module.entry_points.get(index)?.function.arguments;
        match arguments.get(argument as usize)?.binding.as_ref()? {
            naga::Binding::BuiltIn(BuiltIn::Position { .. }) => Some(true),
            naga::Binding::Location { .. } => Some(false),
            naga::Binding::BuiltIn(_) => None,
        }
    }

    /// The output that is the position of a vertex, by its binding: GLSL names it `gl_Position`, and other languages as
    /// the author does.
    pub fn position(&self) -> Option<&Field> {
        let Entry::Point(index) = self.entry else { return None };
        let result = self.module.entry_points.get(index)?.function.result.as_ref()?;
        let is_position =
            |binding: &Option<naga::Binding>| matches!(binding, Some(naga::Binding::BuiltIn(BuiltIn::Position { .. })));
        let at = match &self.module.types[result.ty].inner {
            naga::TypeInner::Struct { members, .. } if result.binding.is_none() => {
                let member = members.iter().position(|member| is_position(&member.binding))?;
                PortAt::ResultMember(u32::try_from(member).ok()?)
            }
            _ if is_position(&result.binding) => PortAt::Result,
            _ => return None,
        };
        self.outputs.iter().find(|port| port.at == at).map(|port| &port.field)
    }

    /// The place in the record of outputs of the one that a formula or another shader calls `name`.
    pub fn output_called(&self, name: &str) -> Option<usize> {
        let find = |name: &str| self.outputs.iter().position(|port| port.field.name == name);
        let position = || if name == POSITION { find(&self.position()?.name) } else { None };
        find(name).or_else(position)
    }

    /// Refuses a program that takes or gives what the harness cannot pass.
    ///
    /// # Errors
    /// [`ProgramError::Source`] with the places of what cannot be passed.
    pub fn check_fed(&self) -> Result<(), ProgramError> {
        let memory = self.memory.iter().filter(|m| self.uses(m.global)).map(|m| &m.diagnostic);
        let all: Vec<Diagnostic> = self.unfed.iter().chain(memory).cloned().collect();
        if all.is_empty() { Ok(()) } else { Err(ProgramError::Source(all)) }
    }
}

/// Validates a module that a pass of our own made.
pub(crate) fn validate(module: &Module) -> Result<ModuleInfo, ProgramError> {
    contain(|| validator().validate(module).map_err(Box::new))
        .map_err(|panic| ProgramError::internal(format!("naga panicked: {panic}")))?
        .map_err(|error| ProgramError::internal(format!("{:?}", error.into_inner())))
}

pub(crate) fn validator() -> Validator {
    Validator::new(ValidationFlags::all(), Capabilities::all())
}
