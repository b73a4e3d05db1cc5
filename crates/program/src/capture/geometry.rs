//! `EmitVertex` and `EndPrimitive` for a geometry stage that runs as compute.
//!
//! They are empty in the program, so that the interpreter can treat them as what they are.

use naga::{AddressSpace, BinaryOperator, Function, GlobalVariable, Handle, Module};

use super::builder::{Builder, add_global};
use super::compute::{Harness, poison};
use super::words::{self, WordsAt};
use crate::lower::Primitives;
use crate::{PortAt, Program, ProgramError};

/// State of the emission of one invocation, in private variables.
pub(super) struct Emission {
    /// Number of vertices emitted so far.
    count: Handle<GlobalVariable>,
    /// Number of strips ended so far.
    strip: Handle<GlobalVariable>,
    /// Index of the first word of the invocation's record.
    record: Handle<GlobalVariable>,
}

impl Emission {
    /// Adds the state and replaces the bodies of `EmitVertex` and `EndPrimitive`, which the
    /// program has empty.
    pub(super) fn insert(
        program: &Program,
        module: &mut Module,
        harness: &Harness,
        primitives: Primitives,
    ) -> Result<Self, ProgramError> {
        let u32 = harness.types.u32;
        let mut private = |name: &str| add_global(module, name, AddressSpace::Private, None, u32);
        let (count, strip, record) = (private("sc_count"), private("sc_strip"), private("sc_record"));
        let this = Self { count, strip, record };

        let emit = this.emit_vertex(program, module, harness, primitives.max_vertices);
        let end = this.end_primitive();
        for (name, function) in [("EmitVertex", emit), ("EndPrimitive", end)] {
            let found = module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(name)).map(|(h, _)| h);
            let Some(handle) = found else {
                return Err(ProgramError::internal(format!("the module has no `{name}`")));
            };
            module.functions[handle] = function;
        }
        Ok(this)
    }

    fn emit_vertex(&self, program: &Program, module: &Module, harness: &Harness, max_vertices: u32) -> Function {
        let layout = program.output_layout();
        let mut b = Builder::new();
        let count_at = b.global(self.count);
        let count = b.load(count_at);
        let max = b.u32(max_vertices);
        let fits = b.binary(BinaryOperator::Less, count, max);
        b.when(fits, |b| {
            let record_at = b.global(self.record);
            let record = b.load(record_at);
            let words = b.u32(layout.vertex_words() as u32);
            let skip = b.binary(BinaryOperator::Multiply, count, words);
            let start = b.binary(BinaryOperator::Add, record, skip);
            let base = b.offset(start, layout.header_words() as u32);
            let out = WordsAt { array: b.global(harness.outputs), base };
            let strip_at = b.global(self.strip);
            let strip = b.load(strip_at);
            let first = b.element(out.array, out.base);
            b.store(first, strip);
            let mut offset = 1;
            for port in &program.outputs {
                if let PortAt::Global(global) = port.at {
                    let pointer = b.global(global);
                    let value = b.load(pointer);
                    words::store(b, module, out, &mut offset, port.ty, value);
                }
            }
        });
        // Vertices past the limit are counted and not stored.
        let next = b.offset(count, 1);
        b.store(count_at, next);
        // Outputs are undefined after EmitVertex (GLSL 4.60, 8.15): whatever is read again shows.
        poison(&mut b, harness, program, module);
        b.finish("EmitVertex", Vec::new(), None)
    }

    fn end_primitive(&self) -> Function {
        let mut b = Builder::new();
        let strip_at = b.global(self.strip);
        let strip = b.load(strip_at);
        let next = b.offset(strip, 1);
        b.store(strip_at, next);
        b.finish("EndPrimitive", Vec::new(), None)
    }

    /// Resets the state for the invocation whose record starts at `record`.
    pub(super) fn begin(&self, b: &mut Builder, record: Handle<naga::Expression>) {
        let zero = b.u32(0);
        for (variable, value) in [(self.count, zero), (self.strip, zero), (self.record, record)] {
            let pointer = b.global(variable);
            b.store(pointer, value);
        }
    }

    /// Stores the counters behind the canary.
    pub(super) fn end(&self, b: &mut Builder, out: WordsAt) {
        for (k, variable) in [(1, self.count), (2, self.strip)] {
            let from = b.global(variable);
            let value = b.load(from);
            let index = b.offset(out.base, k);
            let pointer = b.element(out.array, index);
            b.store(pointer, value);
        }
    }
}
