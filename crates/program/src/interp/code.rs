//! What the machine runs: scalar instructions on registers, in structured blocks.
//!
//! There are two files of registers: real numbers, kept by the domain, and words. A register is one column, a value
//! for each slot. Each scalar of a variable has a register of its own, which is fixed, since calls are expanded in place.

use std::collections::HashSet;
use std::sync::Arc;

pub use super::guarded::Guarded;

use super::domain::{Binary, Class, Comparison, FromWords, Site, ToWords, Unary, WordSource};
use super::group::{Extent, MemoryAccess, MemoryShape, Subgroup};
use super::meaning::HazardKind;
use super::rearrange::Draft;
use crate::Written;
use base::value::Scalar;

/// Number of a register within its file.
pub type Reg = u32;

/// Registers that are given out while compiling, and replaced by a few shared ones at the end.
pub(super) const TEMPORARY: Reg = 1 << 31;

/// A scalar: its type says in which file it lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Register {
    /// Type of the scalar.
    pub scalar: Scalar,
    /// Its register.
    pub reg: Reg,
}

impl Register {
    pub(super) fn file(self) -> File {
        File::of(self.scalar)
    }
}

/// A file of registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum File {
    Real,
    Word,
}

impl File {
    pub(super) fn of(scalar: Scalar) -> Self {
        match scalar {
            Scalar::F32 => Self::Real,
            Scalar::I32 | Scalar::U32 | Scalar::Bool => Self::Word,
        }
    }
}

/// Operations on one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Word1 {
    Not,
    LogicalNot,
    Negate,
    Abs,
    Sign,
    TrailingZeros,
    LeadingZeros,
    Ones,
    Reverse,
    FirstTrailing,
    FirstLeadingSigned,
    FirstLeadingUnsigned,
}

/// Operations on two words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Word2 {
    AddSigned,
    AddUnsigned,
    SubtractSigned,
    SubtractUnsigned,
    MultiplySigned,
    MultiplyUnsigned,
    DivideSigned,
    DivideUnsigned,
    RemainderSigned,
    RemainderUnsigned,
    And,
    Or,
    Xor,
    ShiftLeft,
    ShiftRightSigned,
    ShiftRightUnsigned,
    Equal,
    NotEqual,
    LessSigned,
    LessUnsigned,
    LessEqualSigned,
    LessEqualUnsigned,
    MinSigned,
    MinUnsigned,
    MaxSigned,
    MaxUnsigned,
    /// The index `a` into `b` elements, the last one when it lies outside.
    Index,
}

impl Word2 {
    /// For a question, what it asks and whether its numbers are signed.
    pub(super) fn question(self) -> Option<(Comparison, bool)> {
        Some(match self {
            Self::Equal => (Comparison::Equal, true),
            Self::NotEqual => (Comparison::NotEqual, true),
            Self::LessSigned => (Comparison::Less, true),
            Self::LessUnsigned => (Comparison::Less, false),
            Self::LessEqualSigned => (Comparison::LessEqual, true),
            Self::LessEqualUnsigned => (Comparison::LessEqual, false),
            Self::AddSigned
            | Self::AddUnsigned
            | Self::SubtractSigned
            | Self::SubtractUnsigned
            | Self::MultiplySigned
            | Self::MultiplyUnsigned
            | Self::DivideSigned
            | Self::DivideUnsigned
            | Self::RemainderSigned
            | Self::RemainderUnsigned
            | Self::And
            | Self::Or
            | Self::Xor
            | Self::ShiftLeft
            | Self::ShiftRightSigned
            | Self::ShiftRightUnsigned
            | Self::MinSigned
            | Self::MinUnsigned
            | Self::MaxSigned
            | Self::MaxUnsigned
            | Self::Index => return None,
        })
    }
}

/// Operations on bit fields: (value, offset, count), or (value, new bits, offset, count).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Field {
    ExtractSigned,
    ExtractUnsigned,
    Insert,
}

/// A dynamic index as the program has it: its register, the number of elements, and where it stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stray {
    pub reg: Reg,
    pub len: u32,
    pub site: Site,
}

/// Components that one dynamic index selects.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    /// Where the selected component goes to, or comes from.
    pub one: Register,
    /// The registers among which the index selects.
    pub of: Vec<Reg>,
}

/// A case of a switch.
#[derive(Clone, Debug)]
pub(super) struct Case {
    /// `None` for the default.
    pub value: Option<u32>,
    pub body: Vec<Inst>,
    pub fall_through: bool,
}

#[derive(Clone, Debug)]
pub(super) enum Inst {
    Real1 {
        op: Unary,
        to: Reg,
        a: Reg,
        site: Site,
    },
    Real2 {
        op: Binary,
        to: Reg,
        a: Reg,
        b: Reg,
        site: Site,
    },
    Scale {
        to: Reg,
        a: Reg,
        exponent: Reg,
        site: Site,
    },
    Compare {
        op: Comparison,
        to: Reg,
        a: Reg,
        b: Reg,
        site: Site,
    },
    Classify {
        class: Class,
        to: Reg,
        a: Reg,
        site: Site,
    },
    ToWords {
        op: ToWords,
        to: Reg,
        a: Reg,
        site: Site,
    },
    FromWords {
        op: FromWords,
        to: Reg,
        a: Reg,
        site: Site,
    },
    Word1 {
        op: Word1,
        to: Reg,
        a: Reg,
        site: Site,
    },
    Word2 {
        op: Word2,
        to: Reg,
        a: Reg,
        b: Reg,
        site: Site,
    },
    /// `site` is `None` where the bits lie inside of the word by construction.
    Field {
        op: Field,
        to: Reg,
        args: [Reg; 4],
        site: Option<Site>,
    },
    /// Copies the result of a function, and notes the slots in which it is undefined.
    Guard {
        what: Guarded,
        to: Reg,
        from: Reg,
        args: [Reg; 2],
        site: Site,
    },
    /// The same for `clamp` of integers: its ends.
    GuardWords {
        signed: bool,
        to: Register,
        from: Reg,
        args: [Reg; 2],
        site: Site,
    },
    /// A variable without a value comes to life, with zeros.
    Begin {
        to: Register,
        zero: Reg,
        site: Site,
    },
    /// Notes the slots in which a variable that is read has no value.
    Read {
        from: Register,
        kind: HazardKind,
        site: Site,
    },
    /// A word of a texel, 0 in slots that are not inside.
    Texel {
        table: u32,
        index: Reg,
        channel: u8,
        inside: Option<Reg>,
        to: Reg,
        site: Site,
    },
    Select {
        to: Register,
        condition: Reg,
        accept: Reg,
        reject: Reg,
    },
    /// Copies in all slots: to a temporary, or to a variable that comes to life.
    Copy {
        to: Register,
        from: Reg,
    },
    /// Copies in the slots that are active.
    Store {
        to: Register,
        from: Reg,
    },
    /// Reads the elements at an index, which lies inside. `unset` is the place where one of them may have no value.
    Gather {
        index: Reg,
        choices: Vec<Choice>,
        strays: Vec<Stray>,
        unset: Option<Site>,
    },
    /// Writes the elements at an index, which lies inside, in the slots that are active.
    Scatter {
        index: Reg,
        choices: Vec<Choice>,
        strays: Vec<Stray>,
    },
    If {
        condition: Reg,
        accept: Vec<Inst>,
        reject: Vec<Inst>,
    },
    Switch {
        selector: Reg,
        cases: Vec<Case>,
    },
    Loop {
        body: Vec<Inst>,
        continuing: Vec<Inst>,
        break_if: Option<Reg>,
        site: Site,
    },
    /// A function, expanded in place: `Return` leads to its end.
    Call {
        body: Vec<Inst>,
    },
    /// An `out` argument that is the same place as another, always or where two indices are equal.
    Overlap {
        of: Register,
        equal: Option<[Reg; 2]>,
        site: Site,
    },
    /// Reads memory that invocations share, and with a function in it writes it as well.
    Memory(MemoryAccess),
    /// The number of elements of an array that is as long as its memory, or of texels along an axis.
    Length {
        memory: u32,
        of: Extent,
        to: Reg,
    },
    /// Invocations that have to go the same way: what they decide by.
    Agree {
        first: Reg,
        others: Vec<Reg>,
        site: Site,
    },
    /// Waits for all invocations of the workgroup, or of the subgroup; what they wrote to memories of these kinds is seen
    /// behind it.
    Barrier {
        orders: naga::Barrier,
        site: Site,
    },
    /// Nobody waits; together with the barrier before or behind it, it orders memories of these kinds.
    Fence {
        orders: naga::Barrier,
    },
    /// Invocations of a subgroup see each other's values.
    Subgroup(Subgroup),
    Break,
    Continue,
    Return,
    Kill,
    EmitVertex,
    EndPrimitive,
    /// Counts the slots that get here: at this one of [`Executable::reached`].
    Reach {
        at: u32,
    },
}

/// How an instruction touches a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Touch {
    Read,
    Write,
}

impl Inst {
    /// Calls `f` for each register that the instruction itself touches, blocks inside it left out.
    pub(super) fn registers(&mut self, f: &mut impl FnMut(Touch, File, &mut Reg)) {
        use File::{Real, Word};
        use Touch::{Read, Write};
        match self {
            Self::Real1 { to, a, .. } => {
                f(Read, Real, a);
                f(Write, Real, to);
            }
            Self::Real2 { to, a, b, .. } => {
                f(Read, Real, a);
                f(Read, Real, b);
                f(Write, Real, to);
            }
            Self::Scale { to, a, exponent, .. } => {
                f(Read, Real, a);
                f(Read, Word, exponent);
                f(Write, Real, to);
            }
            Self::Compare { to, a, b, .. } => {
                f(Read, Real, a);
                f(Read, Real, b);
                f(Write, Word, to);
            }
            Self::Classify { to, a, .. } | Self::ToWords { to, a, .. } => {
                f(Read, Real, a);
                f(Write, Word, to);
            }
            Self::FromWords { to, a, .. } => {
                f(Read, Word, a);
                f(Write, Real, to);
            }
            Self::Word1 { to, a, .. } => {
                f(Read, Word, a);
                f(Write, Word, to);
            }
            Self::Word2 { to, a, b, .. } => {
                f(Read, Word, a);
                f(Read, Word, b);
                f(Write, Word, to);
            }
            Self::Field { to, args, .. } => {
                args.iter_mut().for_each(|a| f(Read, Word, a));
                f(Write, Word, to);
            }
            Self::Guard { to, from, args, .. } => {
                f(Read, Real, from);
                args.iter_mut().for_each(|a| f(Read, Real, a));
                f(Write, Real, to);
            }
            Self::GuardWords { to, from, args, .. } => {
                f(Read, Word, from);
                args.iter_mut().for_each(|a| f(Read, Word, a));
                f(Write, Word, &mut to.reg);
            }
            Self::Begin { to, zero, .. } => {
                f(Read, to.file(), zero);
                f(Write, to.file(), &mut to.reg);
            }
            Self::Read { from, .. } => f(Read, from.file(), &mut from.reg),
            Self::Texel { index, inside, to, .. } => {
                f(Read, Word, index);
                inside.iter_mut().for_each(|reg| f(Read, Word, reg));
                f(Write, Word, to);
            }
            Self::Select { to, condition, accept, reject } => {
                f(Read, Word, condition);
                f(Read, to.file(), accept);
                f(Read, to.file(), reject);
                f(Write, to.file(), &mut to.reg);
            }
            Self::Copy { to, from } | Self::Store { to, from } => {
                f(Read, to.file(), from);
                f(Write, to.file(), &mut to.reg);
            }
            Self::Gather { index, choices, strays, .. } => {
                f(Read, Word, index);
                strays.iter_mut().for_each(|stray| f(Read, Word, &mut stray.reg));
                for Choice { one, of } in choices {
                    of.iter_mut().for_each(|reg| f(Read, one.file(), reg));
                    f(Write, one.file(), &mut one.reg);
                }
            }
            Self::Scatter { index, choices, strays } => {
                f(Read, Word, index);
                strays.iter_mut().for_each(|stray| f(Read, Word, &mut stray.reg));
                for Choice { one, of } in choices {
                    of.iter_mut().for_each(|reg| f(Write, one.file(), reg));
                    f(Read, one.file(), &mut one.reg);
                }
            }
            Self::Overlap { of, equal, .. } => {
                equal.iter_mut().flatten().for_each(|index| f(Read, Word, index));
                f(Write, of.file(), &mut of.reg);
            }
            Self::Memory(access) => access.registers(f),
            Self::Agree { first, others, .. } => {
                f(Read, Word, first);
                others.iter_mut().for_each(|reg| f(Read, Word, reg));
            }
            Self::Length { to, .. } => f(Write, Word, to),
            Self::If { condition, .. } => f(Read, Word, condition),
            Self::Switch { selector, .. } => f(Read, Word, selector),
            // The condition at the end of a loop is read inside it.
            Self::Loop { .. } | Self::Call { .. } => {}
            Self::Barrier { .. } | Self::Fence { .. } => {}
            Self::Subgroup(inst) => inst.registers(f),
            Self::Break | Self::Continue | Self::Return | Self::Kill | Self::EmitVertex | Self::EndPrimitive => {}
            Self::Reach { .. } => {}
        }
    }
}

/// A place that slots get to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    /// Its bytes in the text that was parsed: a statement, or of a branch the whole choice.
    pub span: naga::Span,
    /// Of a choice, whether its condition is true or false there.
    pub branch: Option<bool>,
}

/// Where an operation stands in the module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The function; `None` for the entry point itself.
    pub function: Option<naga::Handle<naga::Function>>,
    /// The expression; `None` for a statement.
    pub expression: Option<naga::Handle<naga::Expression>>,
    /// Its bytes in the text that was parsed.
    pub span: naga::Span,
}

/// A column that is filled from the words of a batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fill {
    pub to: Register,
    pub source: WordSource,
    /// What it takes are numbers of binary16.
    pub half: bool,
}

/// A constant in a register.
#[derive(Clone, Copy, Debug)]
pub(super) enum Constant {
    Real { to: Reg, value: f32, site: Option<Site> },
    Word { to: Reg, value: u32 },
}

/// A program ready to run in any domain.
#[derive(Clone, Debug)]
pub struct Executable {
    pub(super) body: Vec<Inst>,
    pub(super) sites: Vec<Place>,
    pub(super) reals: usize,
    pub(super) words: usize,
    pub(super) constants: Vec<Constant>,
    /// Variables that start with zeros.
    pub(super) fills: Vec<Fill>,
    /// Variables that start as never written, unless they are filled.
    pub(super) poisoned: Vec<Register>,
    pub(super) outputs: Vec<Register>,
    /// Registers of variables that come to life without a value, by file.
    pub(super) unset: [HashSet<Reg>; 2],
    pub(super) max_vertices: Option<u32>,
    /// Contents of textures: four words a texel.
    pub(super) tables: Vec<Arc<[u32]>>,
    /// Whose rules tell which operations have a value.
    pub(super) written: Written,
    /// The body before its temporaries share registers.
    pub(super) draft: Arc<Draft>,
    /// Memory that invocations share, in the order of [`Subject::shared`](super::Subject::shared).
    pub(super) memories: Vec<MemoryShape>,
    /// Built-in values of the entry point, with their registers.
    pub(super) numbers: Vec<(naga::BuiltIn, Vec<Register>)>,
    /// How it is run where it is a large dispatch.
    pub(super) whole: Option<Arc<super::group::Whole>>,
    /// Places at which slots are counted.
    pub(super) reached: Vec<Reached>,
}

impl Executable {
    /// Where an operation stands.
    pub fn place(&self, site: Site) -> Place {
        self.sites[site.index()]
    }

    /// Number of sites.
    pub fn site_count(&self) -> usize {
        self.sites.len()
    }

    /// The literals of real numbers, with their sites.
    pub fn literals(&self) -> impl Iterator<Item = (Site, f32)> + '_ {
        self.constants.iter().filter_map(|constant| match *constant {
            Constant::Real { value, site: Some(site), .. } => Some((site, value)),
            Constant::Real { site: None, .. } | Constant::Word { .. } => None,
        })
    }

    /// Types of the output words of one vertex.
    pub fn outputs(&self) -> impl ExactSizeIterator<Item = Scalar> + '_ {
        self.outputs.iter().map(|register| register.scalar)
    }
}
