//! From the functions of a module to scalar instructions.

mod bits;
mod cast;
mod expression;
mod geometric;
mod image;
mod layout;
mod math;
mod memory;
mod operator;
mod overlap;
mod shared;
mod site;
mod statement;
mod subgroup;
mod texture;
mod together;
mod types;
mod wide;

use std::collections::{HashMap, HashSet};
use std::rc::Rc;
use std::sync::Arc;

use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{AddressSpace, BuiltIn, Expression, Function, GlobalVariable, Handle, LocalVariable, Module, Type};

use super::InterpError;
use super::code::{Constant, Executable, File, Fill, Inst, Reg, Register, Stray, TEMPORARY};
use super::domain::{Site, WordSource};
use super::group::Step;
use super::meaning::HazardKind;
use super::rearrange::Draft;
use crate::Written;
use crate::{Entry, Manners, PortAt, Texture};
use base::value::Scalar;
use layout::RegisterLayout;

/// Where a value of the interface lies.
#[derive(Clone, Debug)]
pub struct Binding {
    /// Name, for messages.
    pub name: String,
    /// Type in the module. For [`PortAt::Vertices`], the array of the member's type.
    pub ty: Handle<Type>,
    /// Where it lies.
    pub at: PortAt,
    /// The private variable that holds an output until the entry point returns.
    pub backing: Option<Handle<GlobalVariable>>,
}

/// What is run, and what goes in and out. Words are laid out in the order of the bindings.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'m> {
    /// The module.
    pub module: &'m Module,
    /// What the validator found out about it.
    pub info: &'m ModuleInfo,
    /// What is run.
    pub entry: Entry,
    /// What one invocation takes.
    pub inputs: &'m [Binding],
    /// What one case takes.
    pub uniforms: &'m [Binding],
    /// What one vertex or call gives.
    pub outputs: &'m [Binding],
    /// Built-in arguments of the entry point, by argument index.
    pub built_ins: &'m [(u32, BuiltIn)],
    /// What images and samplers are bound to.
    pub textures: &'m [Texture],
    /// For a geometry stage, the number of vertices that are stored. Calls of functions named
    /// `EmitVertex` and `EndPrimitive` are then taken for what their names say.
    pub max_vertices: Option<u32>,
    /// Variables in memory that the invocations of a dispatch share: buffers, and the memory of a workgroup.
    pub shared: &'m [Handle<GlobalVariable>],
    /// Workgroups along x, y and z where all invocations of a dispatch are one program, one after the other.
    pub dispatch: Option<[u32; 3]>,
    /// How operations are done; none where all is binary32 and may be rearranged.
    pub manners: Option<&'m Manners>,
    /// Operations of `mediump` and `lowp` are marked as such, and variables of these take numbers of them.
    pub lowered: bool,
    /// Slots are counted at each statement and in each branch.
    pub covered: bool,
}

/// Instructions of one executable: calls are expanded in place, which can grow without measure.
const MAX_INSTRUCTIONS: usize = 1 << 20;

impl Executable {
    /// Compiles a subject.
    ///
    /// # Errors
    /// [`InterpError::Unsupported`] for constructs that are not interpreted, with their place in the
    /// text that was parsed; [`InterpError::Internal`] for a module that contradicts its interface.
    pub fn compile(subject: &Subject<'_>) -> Result<Self, InterpError> {
        Compiler::new(subject).run()
    }
}

/// The memory behind a variable.
#[cfg(test)]
pub(in crate::interp) fn shape(module: &Module, handle: Handle<GlobalVariable>) -> super::group::MemoryShape {
    layout::shape(module, handle).unwrap()
}

/// What an expression stands for.
#[derive(Clone, Debug)]
enum Evaluated {
    Registers(Rc<[Register]>),
    Pointer(Pointer),
    /// A texture, a sampler or a storage image.
    Image(Handle<GlobalVariable>),
}

/// A place in a variable.
#[derive(Clone, Debug)]
struct Pointer {
    /// All scalars of the variable.
    variable: Rc<[Register]>,
    /// Never written while the program runs: its registers can be read at any time.
    constant: bool,
    /// First scalar, where the dynamic indices are 0.
    offset: usize,
    /// Dynamic indices, outermost first.
    indices: Vec<Index>,
    /// Memory that invocations share, where the place lies in it: offset and strides count its words then.
    memory: Option<Memory>,
}

/// Memory that a pointer leads to.
#[derive(Clone, Debug)]
struct Memory {
    index: u32,
    layout: RegisterLayout,
    /// Dynamic indices, outermost first.
    steps: Vec<Step>,
}

/// A dynamic index.
#[derive(Clone, Copy, Debug)]
struct Index {
    /// Word register; inside the range.
    reg: Reg,
    /// Scalars that it steps over.
    stride: usize,
    /// Number of elements.
    len: usize,
    /// The index before it was brought inside.
    stray: Stray,
}

/// A function being expanded.
struct Frame<'m> {
    handle: Option<Handle<Function>>,
    function: &'m Function,
    info: &'m FunctionInfo,
    arguments: Vec<Evaluated>,
    locals: HashMap<Handle<LocalVariable>, Rc<[Register]>>,
    values: HashMap<Handle<Expression>, Evaluated>,
    result: Rc<[Register]>,
    /// Where instructions are added now, for messages.
    span: naga::Span,
}

type ConstantKey = (Option<Site>, File, u32);

struct Compiler<'m> {
    subject: &'m Subject<'m>,
    module: &'m Module,
    code: Vec<Inst>,
    written: usize,
    fixed: (u32, u32),
    temporaries: u32,
    globals: HashMap<Handle<GlobalVariable>, Rc<[Register]>>,
    /// Initial values of global variables, to be stored before everything else.
    initial: Vec<Inst>,
    constants: HashMap<ConstantKey, Reg>,
    executable: Executable,
    sites: HashMap<(Option<Handle<Function>>, Handle<Expression>), Site>,
    /// Sites of literals outside of functions.
    constant_sites: HashMap<Handle<Expression>, Site>,
    /// Registers that are known to hold what a variable holds.
    known: HashMap<(File, Reg), Reg>,
    /// Variables that come to life without a value, and what reading them then is.
    unset: HashMap<(File, Reg), HazardKind>,
    /// Those of them that have one in every slot that gets here.
    assigned: HashSet<(File, Reg)>,
    depth: usize,
    /// Variables of the invocation whose code is written now, where there are several.
    own: HashMap<Handle<GlobalVariable>, Rc<[Register]>>,
    numbers: HashMap<Reg, u32>,
    /// Places of statements, where there are several invocations.
    statements: HashMap<together::Stretch, Site>,
}

impl<'m> Compiler<'m> {
    fn new(subject: &'m Subject<'m>) -> Self {
        Self {
            subject,
            module: subject.module,
            code: Vec::new(),
            written: 0,
            fixed: (0, 0),
            temporaries: TEMPORARY,
            globals: HashMap::new(),
            initial: Vec::new(),
            constants: HashMap::new(),
            executable: Executable {
                body: Vec::new(),
                sites: Vec::new(),
                reals: 0,
                words: 0,
                constants: Vec::new(),
                fills: Vec::new(),
                poisoned: Vec::new(),
                outputs: Vec::new(),
                unset: Default::default(),
                max_vertices: subject.max_vertices,
                tables: subject.textures.iter().map(|t| t.contents.words().clone()).collect(),
                written: Written::Glsl,
                draft: Arc::default(),
                memories: Vec::new(),
                numbers: Vec::new(),
                whole: None,
                reached: Vec::new(),
            },
            sites: HashMap::new(),
            constant_sites: HashMap::new(),
            known: HashMap::new(),
            unset: HashMap::new(),
            assigned: HashSet::new(),
            depth: 0,
            own: HashMap::new(),
            numbers: HashMap::new(),
            statements: HashMap::new(),
        }
    }

    fn run(mut self) -> Result<Executable, InterpError> {
        let (handle, function, info) = match self.subject.entry {
            Entry::Point(index) => {
                let point = self.module.entry_points.get(index);
                let point = point.ok_or_else(|| InterpError::internal(format!("there is no entry point {index}")))?;
                (None, &point.function, self.subject.info.get_entry_point(index))
            }
            Entry::Function(handle) => (Some(handle), &self.module.functions[handle], &self.subject.info[handle]),
        };
        let mut arguments = vec![None; function.arguments.len()];
        let (mut word, mut filled) = (0, Vec::new());
        for (bindings, source) in [
            (self.subject.uniforms, WordSource::Case as fn(u32) -> WordSource),
            (self.subject.inputs, WordSource::Invocation as fn(u32) -> WordSource),
        ] {
            word = 0;
            for binding in bindings {
                let registers = self.place_input(binding, &mut arguments)?;
                let half = types::is_half(self.module, binding.ty);
                for &to in &registers {
                    self.executable.fills.push(Fill { to, source: source(word), half });
                    word += 1;
                }
                filled.extend(registers);
            }
        }
        let _ = word;
        for &(k, built_in) in self.subject.built_ins {
            let registers = self.variable(function.arguments[k as usize].ty, naga::Span::UNDEFINED)?;
            self.executable.numbers.push((built_in, registers.to_vec()));
            arguments[k as usize] = Some(Evaluated::Registers(registers));
        }
        for &handle in self.subject.shared {
            let shape = layout::shape(self.module, handle);
            let span = self.module.global_variables.get_span(handle);
            self.executable.memories.push(shape.map_err(|what| unsupported(what, span))?);
        }
        let result = match &function.result {
            Some(result) => self.variable(result.ty, naga::Span::UNDEFINED)?,
            None => Rc::from([]),
        };
        let mut outputs = Vec::new();
        for binding in self.subject.outputs {
            outputs.extend(self.place_output(binding, &mut arguments, &result, &filled)?);
        }
        self.executable.outputs = outputs;
        let dispatched = self.subject.dispatch.is_some();
        // Each invocation of a dispatch has arguments of its own.
        let arguments: Option<Vec<Evaluated>> = arguments.into_iter().filter(|a| a.is_some() || !dispatched).collect();
        let arguments = arguments
            .ok_or_else(|| InterpError::internal("an argument of the entry point is fed by nothing".to_owned()))?;
        // What is fed, or marked as never written, keeps that.
        let fed = self.executable.fills.iter().map(|fill| fill.to).chain(self.executable.poisoned.iter().copied());
        // What a host does not feed of an interface block may be loaded with the rest of it.
        let blocks = self.subject.inputs.iter().filter_map(|binding| match binding.at {
            PortAt::Vertices { global, .. } => self.globals.get(&global),
            _ => None,
        });
        let own: HashSet<(File, Reg)> =
            fed.chain(blocks.flat_map(|registers| registers.iter().copied())).map(key).collect();
        self.unset.retain(|variable, _| !own.contains(variable));
        let body = match self.subject.dispatch {
            None => self.function(handle, function, info, arguments, result)?,
            Some(groups) => self.dispatch(groups, function, info)?,
        };
        for (file, reg) in self.unset.keys() {
            self.executable.unset[*file as usize].insert(*reg);
        }
        let mut all = std::mem::take(&mut self.initial);
        all.retain(|inst| !matches!(inst, Inst::Copy { to, .. } | Inst::Begin { to, .. } if own.contains(&key(*to))));
        all.push(Inst::Call { body });
        let draft = Draft { body: all, fixed: self.fixed, temporaries: self.temporaries };
        Ok(self.executable.with_body(draft))
    }

    /// The registers that an input fills.
    fn place_input(
        &mut self,
        binding: &Binding,
        arguments: &mut [Option<Evaluated>],
    ) -> Result<Vec<Register>, InterpError> {
        let strange = || InterpError::internal(format!("input `{}` at {:?}", binding.name, binding.at));
        match binding.at {
            PortAt::Argument(k) => {
                let registers = self.variable(binding.ty, naga::Span::UNDEFINED)?;
                *arguments.get_mut(k as usize).ok_or_else(strange)? = Some(Evaluated::Registers(registers.clone()));
                Ok(registers.to_vec())
            }
            PortAt::Reference(k) => {
                let registers = self.variable(binding.ty, naga::Span::UNDEFINED)?;
                let pointer = Pointer {
                    variable: registers.clone(),
                    constant: false,
                    offset: 0,
                    indices: Vec::new(),
                    memory: None,
                };
                *arguments.get_mut(k as usize).ok_or_else(strange)? = Some(Evaluated::Pointer(pointer));
                Ok(registers.to_vec())
            }
            PortAt::Arguments { first, count } => {
                let registers = self.variable(binding.ty, naga::Span::UNDEFINED)?;
                let each = registers.len() / (count as usize).max(1);
                for (k, part) in registers.chunks(each.max(1)).enumerate() {
                    *arguments.get_mut(first as usize + k).ok_or_else(strange)? =
                        Some(Evaluated::Registers(part.into()));
                }
                Ok(registers.to_vec())
            }
            PortAt::Part { global, ref path } => self.part_of(global, path).ok_or_else(strange)?,
            PortAt::Global(global) => Ok(self.global(global)?.to_vec()),
            PortAt::Member(global, member) => {
                let registers = self.global(global)?;
                let inner = &self.module.types[self.module.global_variables[global].ty].inner;
                let (at, len) = types::part(self.module, inner, member).ok_or_else(strange)?;
                Ok(registers[at..at + len].to_vec())
            }
            PortAt::Vertices { global, member, count } => {
                let registers = self.global(global)?;
                let inner = &self.module.types[self.module.global_variables[global].ty].inner;
                let (stride, _) = types::elements(self.module, inner).ok_or_else(strange)?;
                let naga::TypeInner::Array { base, .. } = *inner else { return Err(strange()) };
                let part = types::part(self.module, &self.module.types[base].inner, member);
                let (at, len) = part.ok_or_else(strange)?;
                Ok((0..count as usize).flat_map(|k| registers[k * stride + at..][..len].to_vec()).collect())
            }
            PortAt::Result | PortAt::ResultMember(_) => Err(strange()),
        }
    }

    /// The registers of a part of a global variable.
    fn part_of(&mut self, global: Handle<GlobalVariable>, path: &[u32]) -> Option<Result<Vec<Register>, InterpError>> {
        let registers = match self.global(global) {
            Ok(registers) => registers,
            Err(error) => return Some(Err(error)),
        };
        let mut ty = self.module.global_variables[global].ty;
        let (mut start, mut count) = (0, registers.len());
        for &index in path {
            let inner = &self.module.types[ty].inner;
            let (at, len) = types::part(self.module, inner, index)?;
            (start, count) = (start + at, len);
            ty = match inner {
                naga::TypeInner::Struct { members, .. } => members.get(index as usize)?.ty,
                naga::TypeInner::Array { base, .. } => *base,
                _ => return None,
            };
        }
        Some(Ok(registers[start..start + count].to_vec()))
    }

    /// The registers in which an output lies in the end.
    fn place_output(
        &mut self,
        binding: &Binding,
        arguments: &mut [Option<Evaluated>],
        result: &Rc<[Register]>,
        filled: &[Register],
    ) -> Result<Vec<Register>, InterpError> {
        let strange = || InterpError::internal(format!("output `{}` at {:?}", binding.name, binding.at));
        let (registers, poisoned) = match binding.at {
            PortAt::Result => (result.to_vec(), true),
            PortAt::ResultMember(member) => {
                let function = match self.subject.entry {
                    Entry::Point(index) => &self.module.entry_points[index].function,
                    Entry::Function(handle) => &self.module.functions[handle],
                };
                let ty = function.result.as_ref().ok_or_else(strange)?.ty;
                let part = types::part(self.module, &self.module.types[ty].inner, member);
                let (at, len) = part.ok_or_else(strange)?;
                (result[at..at + len].to_vec(), true)
            }
            PortAt::Reference(k) => {
                let place = arguments.get_mut(k as usize).ok_or_else(strange)?;
                let registers = match place {
                    Some(Evaluated::Pointer(pointer)) => pointer.variable.clone(),
                    Some(Evaluated::Registers(_) | Evaluated::Image(_)) => return Err(strange()),
                    None => {
                        let variable = self.variable(binding.ty, naga::Span::UNDEFINED)?;
                        let pointer = Pointer {
                            variable: variable.clone(),
                            constant: false,
                            offset: 0,
                            indices: Vec::new(),
                            memory: None,
                        };
                        *place = Some(Evaluated::Pointer(pointer));
                        variable
                    }
                };
                (registers.to_vec(), true)
            }
            PortAt::Global(global) => (self.global(global)?.to_vec(), true),
            PortAt::Member(global, member) => (self.part_of(global, &[member]).ok_or_else(strange)??, true),
            PortAt::Part { global, ref path } => (self.part_of(global, path).ok_or_else(strange)??, true),
            PortAt::Argument(_) | PortAt::Arguments { .. } | PortAt::Vertices { .. } => return Err(strange()),
        };
        if let Some(backing) = binding.backing {
            let backing = self.global(backing)?;
            self.executable.poisoned.extend(backing.iter().copied());
        }
        if poisoned {
            self.executable.poisoned.extend(registers.iter().copied().filter(|register| !filled.contains(register)));
        }
        Ok(registers)
    }

    /// The registers of a global variable.
    fn global(&mut self, handle: Handle<GlobalVariable>) -> Result<Rc<[Register]>, InterpError> {
        let variable = &self.module.global_variables[handle];
        let dispatched = self.subject.dispatch.is_some();
        // Each invocation of a dispatch has variables of its own, and shares memory with the others.
        let own = dispatched && variable.space == AddressSpace::Private;
        if let Some(registers) = if own { &self.own } else { &self.globals }.get(&handle) {
            return Ok(registers.clone());
        }
        let span = self.module.global_variables.get_span(handle);
        let name = variable.name.as_deref().unwrap_or("a variable");
        match variable.space {
            AddressSpace::Private | AddressSpace::Function => {}
            AddressSpace::WorkGroup | AddressSpace::Storage { .. } if dispatched => {}
            AddressSpace::Uniform => {
                let fed = self.subject.uniforms.iter().any(|binding| match binding.at {
                    PortAt::Global(global) | PortAt::Member(global, _) | PortAt::Part { global, .. } => {
                        global == handle
                    }
                    _ => false,
                });
                if !fed {
                    return Err(InterpError::internal(format!("uniform `{name}` is fed by nothing")));
                }
            }
            AddressSpace::WorkGroup => return Err(unsupported(format!("shared variable `{name}`"), span)),
            AddressSpace::Storage { .. } => return Err(unsupported(format!("storage buffer `{name}`"), span)),
            AddressSpace::Handle => return Err(unsupported(format!("texture or sampler `{name}`"), span)),
            AddressSpace::Immediate => return Err(unsupported(format!("immediate data `{name}`"), span)),
            AddressSpace::TaskPayload => return Err(unsupported(format!("task payload `{name}`"), span)),
            AddressSpace::RayPayload | AddressSpace::IncomingRayPayload => {
                return Err(unsupported(format!("ray payload `{name}`"), span));
            }
        }
        let registers = self.variable(variable.ty, span)?;
        if own { &mut self.own } else { &mut self.globals }.insert(handle, registers.clone());
        let initial = match variable.init {
            Some(init) => Some(self.constant_expression(init)?),
            None if variable.space == AddressSpace::Private => {
                let site = self.declared(None, span);
                for &to in registers.iter() {
                    let begin = self.begin(to, HazardKind::Unset, site);
                    self.initial.push(begin);
                }
                None
            }
            None => None,
        };
        for (&to, from) in registers.iter().zip(initial.iter().flat_map(|values| values.iter())) {
            self.initial.push(Inst::Copy { to, from: from.reg });
        }
        Ok(registers)
    }

    /// New registers for a variable.
    fn variable(&mut self, ty: Handle<Type>, span: naga::Span) -> Result<Rc<[Register]>, InterpError> {
        let inner = &self.module.types[ty].inner;
        let scalars = types::scalars(self.module, inner).map_err(|what| unsupported(what, span))?;
        let registers: Rc<[Register]> =
            scalars.into_iter().map(|scalar| Register { scalar, reg: self.fixed(File::of(scalar)) }).collect();
        if self.fixed.0.max(self.fixed.1) as usize > 4 * types::MAX_SCALARS {
            return Err(unsupported("shaders with so many variables".to_owned(), span));
        }
        Ok(registers)
    }

    fn fixed(&mut self, file: File) -> Reg {
        let next = match file {
            File::Real => &mut self.fixed.0,
            File::Word => &mut self.fixed.1,
        };
        *next += 1;
        *next - 1
    }

    fn temporary(&mut self) -> Reg {
        self.temporaries += 1;
        self.temporaries - 1
    }

    fn push(&mut self, inst: Inst) {
        self.written += 1;
        self.code.push(inst);
    }

    fn check_size(&self, span: naga::Span) -> Result<(), InterpError> {
        if self.written > MAX_INSTRUCTIONS {
            return Err(unsupported("shaders that grow so large when calls are expanded".to_owned(), span));
        }
        Ok(())
    }

    fn real(&mut self, value: f32, site: Option<Site>) -> Register {
        let reg = match self.constants.get(&(site, File::Real, value.to_bits())) {
            Some(&reg) => reg,
            None => {
                let to = self.fixed(File::Real);
                self.executable.constants.push(Constant::Real { to, value, site });
                self.constants.insert((site, File::Real, value.to_bits()), to);
                to
            }
        };
        Register { scalar: Scalar::F32, reg }
    }

    fn word(&mut self, value: u32, scalar: Scalar) -> Register {
        let reg = match self.constants.get(&(None, File::Word, value)) {
            Some(&reg) => reg,
            None => {
                let to = self.fixed(File::Word);
                self.executable.constants.push(Constant::Word { to, value });
                self.numbers.insert(to, value);
                self.constants.insert((None, File::Word, value), to);
                to
            }
        };
        Register { scalar, reg }
    }

    /// A variable that comes to life without a value: GLSL says nothing about what it holds. WGSL starts variables
    /// with zeros, and so does the interpreter.
    fn begin(&mut self, to: Register, kind: HazardKind, site: Site) -> Inst {
        self.unset.insert(key(to), kind);
        self.assigned.remove(&key(to));
        self.known.remove(&key(to));
        Inst::Begin { to, zero: self.zero(to.scalar).reg, site }
    }

    fn zero(&mut self, scalar: Scalar) -> Register {
        match scalar {
            Scalar::F32 => self.real(0.0, None),
            Scalar::I32 | Scalar::U32 | Scalar::Bool => self.word(0, scalar),
        }
    }
}

fn key(register: Register) -> (File, Reg) {
    (register.file(), register.reg)
}

fn unsupported(what: String, span: naga::Span) -> InterpError {
    InterpError::Unsupported { what, span }
}
