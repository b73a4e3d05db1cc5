//! What a program means for a batch: its outputs, and where it left the range of its types.

use super::domain::Site;

/// Something that a slot came upon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum HazardKind {
    /// An index outside of its array, vector or matrix; the last element was taken.
    Index,
    /// An integer divided by zero: `x / 0` is `x`, `x % 0` is 0.
    DivisionByZero,
    /// A signed sum, difference, product or negation that does not fit; its lower 32 bits were kept.
    Overflow,
    /// A signed quotient that does not fit: −2³¹ / −1.
    Quotient,
    /// `%` with a negative operand; the remainder with the sign of the first one was taken.
    Remainder,
    /// A shift by 32 or more; the lower five bits count.
    Shift,
    /// A real number that does not fit the integer that it was converted to; it was clamped.
    Conversion,
    /// Bits outside of a word; offset and count were cut to it.
    BitField,
    /// A built-in function outside of the arguments that it is defined for.
    Argument,
    /// A variable that was read before it had a value; it was taken as 0.
    Unset,
    /// A function that ended without `return`; its value was taken as 0.
    NoReturn,
    /// Two `out` arguments that are one variable; the last was copied back last.
    Overlap,
    /// Invocations of a workgroup that do not come to a barrier together; all went the way of the first one.
    Divergence,
    /// A loop that ran for longer than the fuel; the slot was stopped.
    Fuel,
    /// The slot was discarded, which is no finding of its own.
    Killed,
    /// The process was asked to end while the slot was in a long loop; it was stopped, and nothing is known of it.
    GivenUp,
}

impl HazardKind {
    /// All of them.
    pub const ALL: [Self; 16] = [
        Self::Index,
        Self::DivisionByZero,
        Self::Overflow,
        Self::Quotient,
        Self::Remainder,
        Self::Shift,
        Self::Conversion,
        Self::BitField,
        Self::Argument,
        Self::Unset,
        Self::NoReturn,
        Self::Overlap,
        Self::Divergence,
        Self::Fuel,
        Self::Killed,
        Self::GivenUp,
    ];

    /// True for operations on whole numbers that WGSL defines for all operands (8.7, 16.1), and GLSL does not. The
    /// interpreter takes what WGSL says.
    pub const fn is_defined_by_wgsl(self) -> bool {
        match self {
            Self::DivisionByZero
            | Self::Quotient
            | Self::Remainder
            | Self::Shift
            | Self::Conversion
            | Self::BitField => true,
            Self::Index
            | Self::Overflow
            | Self::Argument
            | Self::Unset
            | Self::NoReturn
            | Self::Overlap
            | Self::Divergence
            | Self::Fuel
            | Self::Killed
            | Self::GivenUp => false,
        }
    }

    /// True where GLSL leaves the value undefined: the interpreter took one of many.
    pub const fn is_undefined(self) -> bool {
        match self {
            Self::Index
            | Self::DivisionByZero
            | Self::Quotient
            | Self::Remainder
            | Self::Shift
            | Self::Conversion
            | Self::BitField
            | Self::Argument
            | Self::Unset
            | Self::NoReturn
            | Self::Overlap
            | Self::Divergence => true,
            // GLSL 4.60, 4.1.3: sums and products keep their lower 32 bits.
            Self::Overflow | Self::Fuel | Self::Killed | Self::GivenUp => false,
        }
    }
}

/// What one invocation came upon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags(u16);

impl Flags {
    /// True when it came upon this.
    pub fn has(self, kind: HazardKind) -> bool {
        self.0 & Self::bit(kind) != 0
    }

    /// True when it came upon a value that GLSL leaves undefined.
    pub fn is_undefined(self) -> bool {
        const UNDEFINED: u16 = {
            let (mut bits, mut k) = (0, 0);
            while k < HazardKind::ALL.len() {
                bits |= if HazardKind::ALL[k].is_undefined() { Flags::bit(HazardKind::ALL[k]) } else { 0 };
                k += 1;
            }
            bits
        };
        self.0 & UNDEFINED != 0
    }

    /// True when it was stopped in a loop: it ran out of fuel, or was given up.
    pub fn is_stopped(self) -> bool {
        self.has(HazardKind::Fuel) || self.has(HazardKind::GivenUp)
    }

    /// True when it came upon nothing.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub(super) fn set(&mut self, kind: HazardKind) {
        self.0 |= Self::bit(kind);
    }

    const fn bit(kind: HazardKind) -> u16 {
        1 << kind as u16
    }
}

/// A place where some invocations left the range of a type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What they came upon.
    pub kind: HazardKind,
    /// Where; see [`Executable::place`](super::Executable::place).
    pub site: Site,
    /// The first invocation.
    pub invocation: usize,
    /// How often it happened, over all invocations and all rounds of loops.
    pub count: u64,
}

/// Outputs of a batch in one domain.
#[derive(Clone, Debug)]
pub struct Meaning<W> {
    pub(super) vertex_words: usize,
    pub(super) max_vertices: Option<u32>,
    pub(super) words: Vec<W>,
    pub(super) unwritten: Vec<(usize, usize, usize)>,
    pub(super) emitted: Vec<u32>,
    pub(super) ended: Vec<u32>,
    pub(super) strips: Vec<u32>,
    pub(super) flags: Vec<Flags>,
    pub(super) findings: Vec<Finding>,
}

impl<W: Copy> Meaning<W> {
    /// Number of invocations.
    pub fn count(&self) -> usize {
        self.flags.len()
    }

    /// True unless it is that of a geometry stage.
    pub fn is_pointwise(&self) -> bool {
        self.max_vertices.is_none()
    }

    fn room(&self) -> usize {
        self.max_vertices.unwrap_or(1) as usize
    }

    /// Number of vertices that the invocation emitted, those past the limit included; 1 for a
    /// pointwise program.
    pub fn emitted(&self, invocation: usize) -> u32 {
        if self.max_vertices.is_some() { self.emitted[invocation] } else { 1 }
    }

    /// Number of vertices that are stored.
    pub fn stored(&self, invocation: usize) -> usize {
        self.emitted(invocation).min(self.max_vertices.unwrap_or(1)) as usize
    }

    /// Number of times that the invocation ended a strip; 0 for a pointwise program.
    pub fn ended_strips(&self, invocation: usize) -> u32 {
        if self.max_vertices.is_some() { self.ended[invocation] } else { 0 }
    }

    /// Output words of a stored vertex, in the order of the outputs.
    pub fn vertex(&self, invocation: usize, vertex: usize) -> &[W] {
        let at = (invocation * self.room() + vertex) * self.vertex_words;
        &self.words[at..at + self.vertex_words]
    }

    /// Number of the strip of a stored vertex, from 0; 0 for a pointwise program.
    pub fn strip(&self, invocation: usize, vertex: usize) -> u32 {
        if self.max_vertices.is_some() { self.strips[invocation * self.room() + vertex] } else { 0 }
    }

    /// False for an output word that was never written, or computed from one that was not by moving
    /// it alone. Such a word is NaN or the mark's bits.
    pub fn is_written(&self, invocation: usize, vertex: usize, word: usize) -> bool {
        self.unwritten.binary_search(&(invocation, vertex, word)).is_err()
    }

    /// Output words that were never written: invocation, vertex, word; in this order.
    pub fn unwritten(&self) -> &[(usize, usize, usize)] {
        &self.unwritten
    }

    /// What an invocation came upon.
    pub fn flags(&self, invocation: usize) -> Flags {
        self.flags[invocation]
    }

    /// The first invocation that ran out of rounds, which goes on without end.
    pub fn endless(&self) -> Option<usize> {
        self.flags.iter().position(|flags| flags.has(HazardKind::Fuel))
    }

    /// Where invocations left the range of a type, by place.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }
}
