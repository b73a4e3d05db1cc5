//! Programs that write down what they compute: every result of an arithmetic operation or built-in
//! function, in the order of execution.
//!
//! [`Program::probed`] adds stores to the module, and two outputs behind the program's own: an array
//! of words, and the number of words that were to be written. Compute and vertex kernels capture them
//! on any lane, and the interpreter runs the same module in any domain of numbers. [`Probed::trace`]
//! decodes them. A kernel writes the trace straight to its record.
//!
//! Stores that are added keep a compiler from optimisations, and can change the last bits of a device's
//! results. Whether the difference that is looked for is still there must be told from the ordinary
//! outputs of the same run. One that is gone comes from an optimisation across operations, and from
//! none of them alone.

mod instrument;
mod operands;
mod operations;
mod place;
mod trace;

use naga::{Expression, Handle};

use super::{Program, ProgramError};
use base::text::Span;

pub use place::span as expression_span;
pub use trace::{Applied, Step, Trace, TraceError, TraceWord};

/// Most words of a trace: more places than the interpreter indexes in one variable.
pub const MAX_WORDS: u32 = 1 << 12;

/// Name of the output that holds the words of a trace; no author can give it.
pub(super) const TRACE: &str = "(trace)";

/// What a step of a trace stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum What {
    /// An operator or built-in function; the values are its result.
    Operation,
    /// A comparison of real numbers; the values are the two operands, the left one first.
    Comparison,
    /// An output at the time of `EmitVertex`; the values are those of the output.
    Emitted {
        /// Name of the output.
        output: String,
    },
    /// `EndPrimitive`; there are no values.
    EndPrimitive,
}

/// One number that an operation takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OperandSource {
    /// A component of the last value of another point.
    Point {
        /// Index of the point.
        point: usize,
        /// Component, matrices column by column.
        component: u32,
    },
    /// A leaf of the same point, by index: an input, or what was read from a variable or returned by
    /// a call.
    Leaf(usize),
    /// A constant.
    Literal(f32),
    /// The result of an earlier operation of the same point, by index.
    Operation(usize),
    /// An integer or boolean, which is not traced.
    Untraced,
}

/// A number that comes from outside of the traced expressions. Its value stands in each step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaf {
    /// The expression, in the function of its point.
    pub expression: Handle<Expression>,
    /// Component, matrices column by column.
    pub component: u32,
    /// The author's text of the expression, where it has one.
    pub span: Option<Span>,
}

/// A scalar operation that a point stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct Operation {
    /// Name as profiles list it, such as `add`, `sin` or `inversesqrt`; of the whole function, such
    /// as `refract`, where it is not split.
    pub name: &'static str,
    /// What it takes, in order.
    pub operands: Vec<OperandSource>,
    /// The component of the point's value that is its result; `None` for an intermediate value that
    /// is not seen, and for a function that is not split.
    pub result: Option<u32>,
}

/// An expression whose values are traced.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The function in the module of the program that was probed; `None` for its entry point.
    pub function: Option<Handle<naga::Function>>,
    /// The expression there; `None` for [`What::Emitted`] and [`What::EndPrimitive`].
    pub expression: Option<Handle<Expression>>,
    /// What its steps stand for.
    pub what: What,
    /// The author's text.
    pub span: Option<Span>,
    /// Number of values of a step.
    pub components: u32,
    /// Where the operands come from: for each operand, its components.
    pub operands: Vec<Vec<OperandSource>>,
    /// Numbers from outside, with their values in each step.
    pub leaves: Vec<Leaf>,
    /// The scalar operations that it stands for, in the order of the formula by which the
    /// specification defines it. A device may use another formula.
    pub operations: Vec<Operation>,
}

impl Point {
    /// Words of a step: its number, the values, the leaves.
    fn words(&self) -> u32 {
        1 + self.components + self.leaves.len() as u32
    }
}

/// A program with its trace.
///
/// A geometry stage becomes a function of one primitive: there is one trace for each, in which the
/// float outputs of each emitted vertex stand as steps of their own ([`What::Emitted`]). An output
/// that the shader leaves out for a vertex has there what it was given before.
#[derive(Clone, Debug)]
pub struct Probed {
    /// The program. Its outputs are those of the program that was probed, none for a geometry stage,
    /// and two more: the words of the trace, and their number.
    pub program: Program,
    /// Expressions that are traced.
    pub points: Vec<Point>,
    /// Words that a trace has room for.
    pub words: u32,
}

impl Probed {
    /// The author's text of a point; empty where nothing of the author's stands for it.
    pub fn text(&self, point: &Point) -> &str {
        point.span.map_or("", |span| self.program.file.slice(span))
    }

    /// File, line and column of a point; the file alone where no place is known.
    pub fn locate(&self, point: &Point) -> String {
        let file = &self.program.file;
        point.span.map_or_else(|| file.name().to_owned(), |span| file.locate(span.start))
    }
}

impl Program {
    /// This program with a trace of at most `words` words. Loops and calls are traced as often as
    /// they run; a step that does not fit ends the trace, which then says that it was cut.
    ///
    /// # Errors
    /// [`ProgramError::Unsupported`] for 0 words or more than [`MAX_WORDS`].
    pub fn probed(&self, words: u32) -> Result<Probed, ProgramError> {
        if words == 0 || words > MAX_WORDS {
            let what = format!("a trace of {words} words; it can have 1 to {MAX_WORDS}");
            return Err(ProgramError::Unsupported { what });
        }
        instrument::probed(self, words)
    }
}
