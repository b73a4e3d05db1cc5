//! Instructions on memory that invocations share.

use super::super::code::{File, Reg, Register, Touch};
use super::super::domain::Site;

/// An index on the way to a place in memory.
#[derive(Clone, Copy, Debug)]
pub(in crate::interp) struct Step {
    /// The index.
    pub reg: Reg,
    /// Words from one element to the next; of a texel, along the first axis.
    pub stride: u32,
    pub len: Extent,
    pub site: Site,
}

/// A number of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::interp) enum Extent {
    /// Known when the program is compiled.
    Fixed(u32),
    /// As many as the memory has room for.
    Elements,
    /// Texels of an image along an axis.
    Side(usize),
}

/// What is done at a place in memory.
#[derive(Clone, Debug)]
pub(in crate::interp) enum MemoryOp {
    /// Reads: each register with its distance from the place, in words.
    Load(Vec<(Register, u32)>),
    /// Writes.
    Store(Vec<(Register, u32)>),
    /// Reads the value, computes another one with it, and writes that.
    Atomic {
        op: Combine,
        value: Register,
        /// For an exchange under a condition, the value that is expected.
        compare: Option<Reg>,
        /// The value before; and whether it was exchanged.
        before: Option<Register>,
        exchanged: Option<Reg>,
    },
}

/// What an atomic function makes of the old value and the argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::interp) enum Combine {
    Add,
    Subtract,
    And,
    Or,
    Xor,
    Min,
    Max,
    Exchange,
}

/// A load, a store or an atomic function on memory that invocations share.
#[derive(Clone, Debug)]
pub(in crate::interp) struct MemoryAccess {
    pub memory: u32,
    /// Words from its beginning, where all indices are 0.
    pub offset: u32,
    pub steps: Vec<Step>,
    pub op: MemoryOp,
    /// An atomic number is read or written.
    pub atomic: bool,
    pub site: Site,
}

impl MemoryAccess {
    /// Calls `f` for each register that the instruction touches.
    pub(in crate::interp) fn registers(&mut self, f: &mut impl FnMut(Touch, File, &mut Reg)) {
        use Touch::{Read, Write};
        self.steps.iter_mut().for_each(|step| f(Read, File::Word, &mut step.reg));
        match &mut self.op {
            MemoryOp::Load(parts) => parts.iter_mut().for_each(|(to, _)| f(Write, to.file(), &mut to.reg)),
            MemoryOp::Store(parts) => parts.iter_mut().for_each(|(from, _)| f(Read, from.file(), &mut from.reg)),
            MemoryOp::Atomic { value, compare, before, exchanged, .. } => {
                f(Read, value.file(), &mut value.reg);
                compare.iter_mut().for_each(|reg| f(Read, value.file(), reg));
                before.iter_mut().for_each(|to| f(Write, to.file(), &mut to.reg));
                exchanged.iter_mut().for_each(|reg| f(Write, File::Word, reg));
            }
        }
    }
}
