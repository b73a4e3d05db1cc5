//! The interpreter: what the functions of a naga module mean, in any domain of numbers.
//!
//! It takes the module itself and no translation of it, and shares nothing with the lanes: what they
//! give can be compared with it. A module is compiled to scalar instructions ([`Executable`]), which a
//! [`Machine`] runs on the columns of [`SLOTS`] invocations at a time. What numbers are is said by a
//! [`Domain`]: [`Binary64`] is the meaning in real numbers, as near as binary64 comes to it,
//! [`Binary32`] what a device gives that rounds every operation correctly and rearranges nothing.
//!
//! ```text
//! naga module ─ compile ─▶ Executable ─ Machine<D> ─▶ columns ─▶ Meaning
//! ```

mod allocate;
mod code;
mod compile;
mod control;
mod domain;
pub mod group;
mod guarded;
mod indexed;
mod integer;
mod lowered;
mod machine;
mod meaning;
mod plain;
pub mod proof;
mod rearrange;
mod results;
mod shape;
mod slots;
#[cfg(test)]
mod tests;
mod undefined;

use std::sync::Arc;

use rayon::prelude::*;
use thiserror::Error;

use crate::lane::interrupt;
use crate::{Place as Found, Port, Program, ReadBack};
use base::value::{Batch, Scalar};

#[cfg(test)]
use compile::shape as compile_shape;

pub use code::{Executable, Guarded, Place, Reached};
pub use compile::{Binding, Subject};
pub use domain::{Binary, Class, Comparison, Domain, FromWords, Site, ToWords, Unary, WordSource};
pub use lowered::Half;
pub use machine::Machine;
pub use meaning::{Finding, Flags, HazardKind, Meaning};
pub use number::half::nearest as halved;
pub use plain::{Binary32, Binary64, Column, Number, Plain, classify, compare, from_words, outside, to_half, to_words};
pub use rearrange::Laws;
pub use results::OutputColumn;
pub use slots::{Mask, SLOTS, Words};
pub use undefined::{Dependence, Undefined};

/// Bits of an output that was never written: a quiet NaN with a payload of its own.
pub const POISON: u32 = 0x7fd5_a3c9;

/// Rounds of loops that one invocation may go through.
pub const FUEL: u32 = 1 << 16;

/// Chunks of a batch that are still run once the process was asked to end.
const LAST_CHUNKS: usize = 16;

/// Why a program has no meaning here.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum InterpError {
    /// A construct that is not interpreted.
    #[error("not interpreted: {what}")]
    Unsupported {
        /// The construct in words about the source.
        what: String,
        /// Its bytes in the text that was parsed.
        span: naga::Span,
    },
    /// The batch is not for this program.
    #[error("the batch has {found} words for each {of}, the program takes {expected}")]
    Batch {
        /// `invocation` or `case`.
        of: &'static str,
        /// Words in the batch.
        found: usize,
        /// Words that the program takes.
        expected: usize,
    },
    /// The process was asked to end before the batch was through.
    #[error("the run was interrupted")]
    Interrupted,
    /// A defect of shadercheck itself.
    #[error("internal error, please report: {0}")]
    Internal(String),
}

impl InterpError {
    fn internal(what: String) -> Self {
        Self::Internal(what)
    }

    /// The message with the place in the author's text, where there is one.
    pub fn locate(&self, program: &Program) -> String {
        match self {
            Self::Unsupported { span, .. } => match source_span(*span) {
                Some(at) => format!("{}: {self}", program.file.locate(at.start)),
                None => format!("{}: {self}", program.file.name()),
            },
            Self::Batch { .. } | Self::Interrupted | Self::Internal(_) => self.to_string(),
        }
    }
}

/// The author's text that a span of the module stands for.
pub fn source_span(span: naga::Span) -> Option<base::text::Span> {
    let range = span.to_range()?;
    Some(base::text::Span::new(range.start, range.end))
}

/// The author's text of a place: the whole call for a built-in function.
pub fn author_span(program: &Program, place: &Place) -> Option<base::text::Span> {
    let Some(expression) = place.expression else { return source_span(place.span) };
    let function = match (place.function, program.entry) {
        (Some(function), _) | (None, crate::Entry::Function(function)) => &program.module.functions[function],
        (None, crate::Entry::Point(index)) => &program.module.entry_points.get(index)?.function,
    };
    crate::probe::expression_span(program, function, expression, place.span)
}

/// Compiles a program.
///
/// # Errors
/// [`InterpError::Unsupported`] for constructs that are not interpreted.
pub fn compile(program: &Program) -> Result<Executable, InterpError> {
    compile_as(program, (false, false))
}

/// Compiles a program for a device on which `mediump` and `lowp` are less than binary32: the sites of their operations
/// say so, and variables of these take numbers of their precision.
///
/// # Errors
/// Those of [`compile`].
pub fn compile_lowered(program: &Program) -> Result<Executable, InterpError> {
    compile_as(program, (true, false))
}

/// Compiles a program that counts the invocations that get to each statement and branch: [`Machine::reached`].
///
/// # Errors
/// Those of [`compile`].
pub fn compile_covered(program: &Program) -> Result<Executable, InterpError> {
    compile_as(program, (false, true))
}

fn compile_as(program: &Program, (lowered, covered): (bool, bool)) -> Result<Executable, InterpError> {
    if let Some(found) = program.unfed.first() {
        let part = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let span = naga::Span::new(part(found.span.start), part(found.span.end));
        return Err(InterpError::Unsupported { what: found.message.to_string(), span });
    }
    if let Some(dispatch) = program.dispatch.as_deref().filter(|dispatch| dispatch.large) {
        let executable = compile_memory(program, &dispatch.host.0, &dispatch.host.1)?;
        let whole = group::Whole::of(program, &executable)?;
        return Ok(Executable { whole: Some(Arc::new(whole)), ..executable });
    }
    let bindings = |ports: &[Port]| ports.iter().map(Binding::from).collect::<Vec<_>>();
    let executable = Executable::compile(&Subject {
        module: &program.module,
        info: &program.info,
        entry: program.entry,
        inputs: &bindings(&program.inputs),
        uniforms: &bindings(&program.uniforms),
        outputs: &bindings(&program.outputs),
        built_ins: &program.built_ins,
        textures: &program.textures,
        max_vertices: program.output_layout().max_vertices,
        shared: &[],
        dispatch: program.dispatch.as_deref().map(|dispatch| dispatch.groups),
        manners: Some(&program.manners),
        lowered,
        covered,
    })?;
    Ok(Executable { written: program.written, ..executable })
}

/// Compiles the compute stage of a program as a dispatch runs it: all that is in buffers, in the memory of a workgroup or
/// given to the whole dispatch is memory.
///
/// # Errors
/// [`InterpError::Unsupported`] for constructs that are not interpreted.
pub fn compile_dispatch(program: &Program) -> Result<Executable, InterpError> {
    compile_memory(program, &program.module, &program.info)
}

/// The same of a module that has the entry point of the program.
fn compile_memory(
    program: &Program,
    module: &naga::Module,
    info: &naga::valid::ModuleInfo,
) -> Result<Executable, InterpError> {
    use naga::AddressSpace as Space;
    let shared: Vec<_> = module
        .global_variables
        .iter()
        .filter(|(_, v)| match v.space {
            Space::WorkGroup | Space::Storage { .. } | Space::Uniform | Space::Immediate => true,
            Space::Handle => matches!(
                module.types[v.ty].inner,
                naga::TypeInner::Image { class: naga::ImageClass::Storage { .. }, .. }
            ),
            _ => false,
        })
        .map(|(handle, _)| handle)
        .collect();
    let built_ins = program.built_ins_of_entry();
    let executable = Executable::compile(&Subject {
        module,
        info,
        entry: program.entry,
        inputs: &[],
        uniforms: &[],
        outputs: &[],
        built_ins: &built_ins,
        textures: &program.textures,
        max_vertices: None,
        shared: &shared,
        dispatch: None,
        manners: Some(&program.manners),
        lowered: false,
        covered: false,
    })?;
    Ok(Executable { written: program.written, ..executable })
}

/// Compiles a translation that was read back.
///
/// # Errors
/// [`InterpError::Unsupported`] for constructs that are not interpreted.
pub fn compile_read_back(back: &ReadBack) -> Result<Executable, InterpError> {
    let bindings = |places: &[Found]| places.iter().map(Binding::from).collect::<Vec<_>>();
    Executable::compile(&Subject {
        module: &back.module,
        info: &back.info,
        entry: back.entry,
        inputs: &bindings(&back.inputs),
        uniforms: &bindings(&back.uniforms),
        outputs: &bindings(&back.outputs),
        built_ins: &back.built_ins,
        textures: &back.textures,
        max_vertices: back.max_vertices,
        shared: &[],
        dispatch: None,
        manners: None,
        lowered: false,
        covered: false,
    })
}

impl From<&Found> for Binding {
    fn from(place: &Found) -> Self {
        Self { name: place.name.clone(), ty: place.ty, at: place.at.clone(), backing: None }
    }
}

impl From<&Port> for Binding {
    fn from(port: &Port) -> Self {
        Self { name: port.field.name.clone(), ty: port.ty, at: port.at.clone(), backing: port.backing }
    }
}

/// Compiles a program and runs it on a batch, on all cores.
///
/// # Errors
/// [`InterpError`]: constructs that are not interpreted, or a batch that is not for this program.
pub fn run<D: Domain + Default>(program: &Program, batch: &Batch) -> Result<Meaning<D::Word>, InterpError> {
    compile(program)?.run::<D>(batch, FUEL)
}

impl Executable {
    /// Runs a batch in a domain, on all cores. Each invocation may go through `fuel` rounds of loops.
    ///
    /// # Errors
    /// [`InterpError::Batch`] when the batch has too few words, [`InterpError::Interrupted`] when the process is asked to
    /// end meanwhile.
    pub fn run<D: Domain + Default>(&self, batch: &Batch, fuel: u32) -> Result<Meaning<D::Word>, InterpError> {
        self.run_with(batch, fuel, D::default)
    }

    /// The same in domains that `domain` makes, one for each thread.
    ///
    /// # Errors
    /// Those of [`Executable::run`].
    pub fn run_with<D: Domain>(
        &self,
        batch: &Batch,
        fuel: u32,
        domain: impl Fn() -> D + Sync + Send,
    ) -> Result<Meaning<D::Word>, InterpError> {
        self.check(batch)?;
        let count = batch.invocation_count();
        let (room, width) = (self.max_vertices.unwrap_or(1) as usize, self.outputs.len());
        let pieces: Option<Vec<Meaning<D::Word>>> = (0..count.div_ceil(SLOTS))
            .into_par_iter()
            .map_init(
                || Machine::new(self, domain(), fuel),
                |machine, chunk| {
                    // A batch of some chunks is done soon, and serves to describe what was found.
                    if chunk >= LAST_CHUNKS && interrupt::asked() {
                        return None;
                    }
                    let first = chunk * SLOTS;
                    let slots = machine.run(batch, first);
                    let given_up = machine.flags()[..slots].iter().any(|flags| flags.has(HazardKind::GivenUp));
                    (!given_up).then(|| piece(machine, first, slots, room, width, self.max_vertices))
                },
            )
            .collect();
        let pieces = pieces.ok_or(InterpError::Interrupted)?;
        let mut all = Meaning {
            vertex_words: width,
            max_vertices: self.max_vertices,
            words: Vec::with_capacity(count * room * width),
            unwritten: Vec::new(),
            emitted: Vec::new(),
            ended: Vec::new(),
            strips: Vec::new(),
            flags: Vec::with_capacity(count),
            findings: Vec::new(),
        };
        for piece in pieces {
            all.words.extend(piece.words);
            all.unwritten.extend(piece.unwritten);
            all.emitted.extend(piece.emitted);
            all.ended.extend(piece.ended);
            all.strips.extend(piece.strips);
            all.flags.extend(piece.flags);
            for finding in piece.findings {
                match all.findings.iter_mut().find(|f| f.kind == finding.kind && f.site == finding.site) {
                    Some(found) => found.count += finding.count,
                    None => all.findings.push(finding),
                }
            }
        }
        all.findings.sort_by_key(|finding| (finding.site, finding.kind));
        Ok(all)
    }

    /// Checks that a batch has the words that are read.
    fn check(&self, batch: &Batch) -> Result<(), InterpError> {
        let (mut invocation, mut case) = (0, 0);
        for fill in &self.fills {
            match fill.source {
                WordSource::Invocation(word) => invocation = invocation.max(word as usize + 1),
                WordSource::Case(word) => case = case.max(word as usize + 1),
            }
        }
        for (of, found, expected) in
            [("invocation", batch.invocation_record.words(), invocation), ("case", batch.case_record.words(), case)]
        {
            if found != expected {
                return Err(InterpError::Batch { of, found, expected });
            }
        }
        Ok(())
    }
}

/// What came out of one chunk.
fn piece<D: Domain>(
    machine: &mut Machine<'_, D>,
    first: usize,
    slots: usize,
    room: usize,
    width: usize,
    max_vertices: Option<u32>,
) -> Meaning<D::Word> {
    let mut piece = Meaning {
        vertex_words: width,
        max_vertices,
        words: vec![D::Word::default(); slots * room * width],
        unwritten: Vec::new(),
        emitted: Vec::new(),
        ended: Vec::new(),
        strips: Vec::new(),
        flags: machine.flags()[..slots].to_vec(),
        findings: machine.take_findings(),
    };
    if max_vertices.is_some() {
        piece.emitted = machine.emitted()[..slots].to_vec();
        piece.ended = machine.ended()[..slots].to_vec();
        piece.strips =
            (0..slots).flat_map(|slot| (0..room).map(move |v| (slot, v))).map(|(l, v)| machine.strip(v)[l]).collect();
    }
    let unwritten = D::exact(POISON, Scalar::F32);
    let stored = |slot: usize, vertex: usize| max_vertices.is_none() || vertex < machine.emitted()[slot] as usize;
    for vertex in 0..room {
        for word in 0..width {
            let column = machine.output(vertex, word);
            for slot in (0..slots).filter(|&slot| stored(slot, vertex)) {
                let value = machine.word(&column, word, slot);
                if value.is_none() {
                    piece.unwritten.push((first + slot, vertex, word));
                }
                piece.words[(slot * room + vertex) * width + word] = value.unwrap_or(unwritten);
            }
        }
    }
    piece.unwritten.sort_unstable();
    piece
}
