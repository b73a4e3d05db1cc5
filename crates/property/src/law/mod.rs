//! Laws: relations that need no more than the names of inputs and outputs, for any shader.
//!
//! Laws are about real numbers, and relate their inputs exactly: a whole turn is 2π, and not the binary32 beside it.
//! Where a period is no number of binary32, what one step to either side changes is left open.

mod arrays;
mod bind;
mod bound;

pub use bind::LawError;

use crate::Own;
use crate::Relation;
use base::value::{Field, Record};

/// A law as a suite states it.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// What is claimed.
    pub kind: LawKind,
    /// Outputs that it is about; empty for all that it can be about.
    pub outputs: Vec<String>,
    /// Where the suite says it, such as `a.suite.toml:9:5`; shown before messages.
    pub at: String,
}

/// What a law claims.
#[derive(Clone, Debug, PartialEq)]
pub enum LawKind {
    /// With the sign of these inputs changed, outputs change their sign.
    Odd {
        /// Names of inputs that change together.
        inputs: Vec<String>,
    },
    /// With the sign of these inputs changed, outputs stay.
    Even {
        /// Names of inputs that change together.
        inputs: Vec<String>,
    },
    /// With the period added to every component of these inputs, outputs stay.
    Periodic {
        /// Names of inputs that change together.
        inputs: Vec<String>,
        /// The period, in real numbers; it need not be a binary32 number.
        period: f64,
    },
    /// Where a number among the inputs grows, outputs do not fall (or do not grow).
    Monotone {
        /// The input: one number.
        input: String,
        /// True when outputs do not fall.
        rising: bool,
    },
    /// Every component of the outputs lies in a range.
    Range {
        /// Ends of the range, which belong to it.
        range: [f64; 2],
    },
    /// Outputs have length one.
    Unit,
    /// Exchanging these inputs changes nothing.
    Symmetric {
        /// The inputs, of one shape.
        inputs: Vec<String>,
    },
    /// Turning and shifting points and turning directions among the inputs turns and shifts those among
    /// the outputs, and leaves all other outputs as they are.
    Rigid {
        /// Inputs and outputs that are points: `vec3`, or `vec4` with w = 1.
        points: Vec<String>,
        /// Inputs and outputs that are directions: `vec3`, or `vec4` with w = 0.
        directions: Vec<String>,
        /// Whether mirror images are among the motions.
        mirrored: bool,
    },
    /// Inputs times k give outputs times k to the power of `degree`.
    Scales {
        /// Names of inputs that change together.
        inputs: Vec<String>,
        /// The power.
        degree: i32,
    },
    /// The order of the elements of these arrays, which move together, changes nothing.
    Unordered {
        /// Names of arrays with so many elements each.
        inputs: Vec<String>,
    },
    /// The first elements of output arrays depend on as many first elements of these arrays alone.
    Prefix {
        /// Names of arrays with so many elements each.
        inputs: Vec<String>,
    },
    /// The output arrays are the elements of an input in order.
    Sorts {
        /// The array.
        input: String,
        /// True for an order in which elements do not fall.
        rising: bool,
    },
    /// The elements of each output array, or of each of its rows, add up to a number.
    Sums {
        /// What they add up to.
        total: f64,
        /// Equal parts of the array.
        rows: usize,
    },
    /// The output of a sum of inputs is the sum of the outputs.
    Additive {
        /// Names of inputs that change together.
        inputs: Vec<String>,
    },
}

impl LawKind {
    /// The names of all kinds, as suites write them.
    pub const NAMES: [&str; 14] = [
        "odd",
        "even",
        "periodic",
        "monotone",
        "range",
        "unit",
        "symmetric",
        "rigid",
        "scales",
        "unordered",
        "prefix",
        "sorts",
        "sums",
        "additive",
    ];

    /// Name, as suites write it.
    pub fn name(&self) -> &'static str {
        let [
            odd,
            even,
            periodic,
            monotone,
            range,
            unit,
            symmetric,
            rigid,
            scales,
            unordered,
            prefix,
            sorts,
            sums,
            additive,
        ] = Self::NAMES;
        match self {
            Self::Odd { .. } => odd,
            Self::Even { .. } => even,
            Self::Periodic { .. } => periodic,
            Self::Monotone { .. } => monotone,
            Self::Range { .. } => range,
            Self::Unit => unit,
            Self::Symmetric { .. } => symmetric,
            Self::Rigid { .. } => rigid,
            Self::Scales { .. } => scales,
            Self::Unordered { .. } => unordered,
            Self::Prefix { .. } => prefix,
            Self::Sorts { .. } => sorts,
            Self::Sums { .. } => sums,
            Self::Additive { .. } => additive,
        }
    }
}

impl Law {
    /// Binds the law to a shader. `seen` are the outputs in the order in which relations see them,
    /// `records` the inputs of an invocation and of a case, and `range` gives the range of an input, where
    /// the suite states one.
    ///
    /// # Errors
    /// [`LawError`]: names that the shader does not have, and shapes that the law is not about.
    pub fn bind(
        &self,
        seen: &[Field],
        records: [&Record; 2],
        range: &dyn Fn(&str) -> Option<[f64; 2]>,
    ) -> Result<Own<dyn Relation>, LawError> {
        bind::bind(self, seen, records, range)
    }
}
