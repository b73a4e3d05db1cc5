//! Verdicts on single samples.

use serde::{Deserialize, Serialize};
use std::fmt;

use super::reference::MEANING;
use crate::tape::{Cause, Why};
use base::value::{F32Bits, Scalar};
use program::interp::FUEL;

/// What the judge says of a sample.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The shader means what the formula says, and the lane is as near to that as was promised.
    Agree(Promise),
    /// Some output is wrong.
    Deviate(Deviation),
    /// The sample is inconclusive.
    Undetermined(Doubt),
}

impl Verdict {
    /// Of two verdicts on a sample the one that weighs more. On later tiers the later one counts.
    pub(super) fn worse(before: Option<Self>, verdict: Self, tier: usize) -> Self {
        let weight = |verdict: &Self| match verdict {
            Self::Agree(_) => 0,
            Self::Undetermined(_) => 1,
            Self::Deviate(_) => 2,
        };
        match before {
            Some(before) if tier == 0 && weight(&before) >= weight(&verdict) => before,
            // The formula has no value: that a lane is right says nothing.
            Some(before @ Self::Undetermined(Doubt { reason: Reason::Domain, .. })) if weight(&verdict) < 2 => before,
            Some(_) | None => verdict,
        }
    }
}

/// By which promise a lane's outputs are right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Promise {
    /// The text of the specification, with operations in the order of the source.
    Text,
    /// What the conformance suite accepts around it.
    Conformance,
    /// The same, with sums and products regrouped as the specification allows.
    Rearranged,
    /// Nothing is promised, and the lane is as this device was measured.
    Measured,
}

impl Promise {
    /// All of them, the strictest first.
    pub const ALL: [Self; 4] = [Self::Text, Self::Conformance, Self::Rearranged, Self::Measured];

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Conformance => "conformance",
            Self::Rearranged => "rearranged",
            Self::Measured => "measured",
        }
    }
}

/// Why a sample is inconclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Reason {
    /// The formula or the shader has no value here.
    Domain,
    /// The API promises nothing for an operation, or for its arguments.
    NoPromise,
    /// What is allowed moves the output by more than 2^-10 of its size.
    IllConditioned,
    /// A comparison could go either way.
    Branch,
    /// A coordinate lies so near to the edge of a texel that a device may take its neighbour.
    TexelEdge,
    /// A loop has more rounds than errors are followed through.
    LongLoop,
    /// The value lies below the normal range of binary32, where a device may flush it to zero.
    Underflow,
    /// The value, or one on the way to it, may be too large for binary32.
    Overflow,
    /// An output depends on a value that the language leaves undefined.
    Undefined,
}

impl Reason {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 9] = [
        Self::Domain,
        Self::NoPromise,
        Self::IllConditioned,
        Self::Branch,
        Self::TexelEdge,
        Self::LongLoop,
        Self::Underflow,
        Self::Overflow,
        Self::Undefined,
    ];

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Domain => "domain",
            Self::NoPromise => "no_promise",
            Self::IllConditioned => "ill_conditioned",
            Self::Branch => "branch",
            Self::TexelEdge => "texel_edge",
            Self::LongLoop => "long_loop",
            Self::Underflow => "underflow",
            Self::Overflow => "overflow",
            Self::Undefined => "undefined",
        }
    }

    /// True when a promise that leaves this open permits what a lane gives: it lies within a bound, only that the
    /// bound is no smaller than the value or has no end.
    pub(super) fn permits(self) -> bool {
        match self {
            Self::IllConditioned | Self::Underflow | Self::Overflow => true,
            Self::Domain | Self::NoPromise | Self::Branch | Self::TexelEdge | Self::LongLoop | Self::Undefined => false,
        }
    }

    /// True when real numbers are fine there and binary32 is not: a weakness of the shader.
    pub fn is_range(self) -> bool {
        match self {
            Self::Underflow | Self::Overflow => true,
            Self::Domain
            | Self::NoPromise
            | Self::IllConditioned
            | Self::Branch
            | Self::TexelEdge
            | Self::LongLoop
            | Self::Undefined => false,
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Domain => "no value",
            Self::NoPromise => "no promise",
            Self::IllConditioned => "ill-conditioned",
            Self::Branch => "a comparison could go either way",
            Self::TexelEdge => "a coordinate at the edge of a texel",
            Self::LongLoop => "a loop too long to be followed",
            Self::Underflow => "underflow",
            Self::Overflow => "overflow",
            Self::Undefined => "an undefined value",
        })
    }
}

/// Why a sample is inconclusive, and the operation that brings it about.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// The reason, as reports count it.
    pub reason: Reason,
    /// The operation, where there is one to name.
    pub cause: Option<Cause>,
}

impl Doubt {
    /// A doubt without an operation to name.
    pub fn of(reason: Reason) -> Self {
        Self { reason, cause: None }
    }

    /// The doubt behind a value or a bound that is not finite.
    pub(super) fn by(cause: Option<Cause>) -> Self {
        let reason = match cause.as_ref().map(|cause| cause.why) {
            Some(Why::Domain) => Reason::Domain,
            Some(Why::NoPromise) => Reason::NoPromise,
            Some(Why::Overflow) => Reason::Overflow,
            Some(Why::Singular) | None => Reason::IllConditioned,
        };
        Self { reason, cause }
    }
}

/// Whose fault a deviation is, as far as a single lane shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Blame {
    /// The shader's own meaning, in real numbers, is not what the formula says.
    Shader,
    /// The lane is farther from the shader's meaning than any conforming device may be.
    Lane,
}

impl Blame {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shader => "shader",
            Self::Lane => "lane",
        }
    }
}

/// A wrong output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// Whose fault it is.
    pub blame: Blame,
    /// The output that is wrong, and how.
    pub what: What,
}

/// How a sample deviates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum What {
    /// A component is farther off than it may be, or is NaN.
    Value(Value),
    /// An output was never written on this path.
    NotWritten {
        /// Name of the component.
        component: String,
        /// Vertex, for a geometry stage.
        vertex: Option<usize>,
    },
    /// Another number of vertices.
    VertexCount {
        /// Vertices that there should be.
        expected: usize,
        /// Vertices that there are.
        actual: u32,
    },
    /// A strip begins or goes on where it should not.
    Strip {
        /// Vertex at which the strips part.
        vertex: usize,
        /// True when a strip should begin here.
        begins: bool,
    },
    /// More vertices than `max_vertices`.
    TooManyVertices {
        /// Number of calls of `EmitVertex`.
        emitted: u32,
        /// The declared limit.
        max: u32,
    },
    /// A loop goes on for longer than any loop may.
    Endless,
}

/// A component that deviates, on all sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Value {
    /// Name of the component, such as `gl_Position.x`.
    pub component: String,
    /// Vertex, for a geometry stage.
    pub vertex: Option<usize>,
    /// What the formula says; `None` for an output that the formula does not give.
    #[serde(with = "base::value::exact::option")]
    pub expected: Option<f64>,
    /// What the shader means in real numbers.
    #[serde(with = "base::value::exact")]
    pub meaning: f64,
    /// The word that the lane wrote.
    pub actual: u32,
    /// As what the word is read: a binary32 number, an integer or a truth value.
    pub scalar: Scalar,
    /// How far the side to blame may be off.
    #[serde(with = "base::value::exact")]
    pub bound: f64,
}

impl Deviation {
    /// The component that deviates.
    pub fn value(&self) -> Option<&Value> {
        match &self.what {
            What::Value(value) => Some(value),
            What::NotWritten { .. }
            | What::VertexCount { .. }
            | What::Strip { .. }
            | What::TooManyVertices { .. }
            | What::Endless => None,
        }
    }

    /// Distance of the lane from where it should be, in ULP; infinite for everything that is no
    /// number.
    pub fn ulp(&self) -> f64 {
        let Some(value) = self.value().filter(|value| value.scalar == Scalar::F32) else { return f64::INFINITY };
        let distance = base::value::ulp_distance(self.target(value), f32::from_bits(value.actual));
        if distance.is_nan() { f64::INFINITY } else { distance }
    }

    /// What the side to blame is compared with.
    pub fn target(&self, value: &Value) -> f64 {
        match self.blame {
            Blame::Shader => value.expected.unwrap_or(value.meaning),
            Blame::Lane => value.meaning,
        }
    }
}

impl Deviation {
    /// The deviation in words; `against` is what the shader is compared with, such as `formula`, or its own `meaning`.
    pub fn message(&self, against: &str) -> String {
        match self.blame {
            Blame::Shader if against == MEANING => format!("the shader is wrong by its own meaning: {self:#}"),
            Blame::Shader => format!("the shader deviates from its {against}: {self:#}"),
            Blame::Lane => self.to_string(),
        }
    }
}

/// With `{:#}`, without the side to blame.
impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.blame {
            _ if f.alternate() => {}
            Blame::Shader => f.write_str("the shader deviates from its formula: ")?,
            Blame::Lane => f.write_str("the lane deviates from the shader: ")?,
        }
        let at = |vertex: &Option<usize>| vertex.map_or_else(String::new, |v| format!(" of vertex {v}"));
        match &self.what {
            What::Value(value) => {
                let Value { component, vertex, meaning, actual, scalar, bound, .. } = value;
                let (found, target) = match self.blame {
                    Blame::Shader => (number(*meaning, *scalar), number(self.target(value), *scalar)),
                    Blame::Lane => (word(*actual, *scalar), number(*meaning, *scalar)),
                };
                write!(f, "`{component}`{} is {found}, expected {target}", at(vertex))?;
                if *scalar == Scalar::F32 && self.blame == Blame::Lane {
                    write!(f, " ± {bound:.1e}")?;
                }
                Ok(())
            }
            What::NotWritten { component, vertex } => write!(f, "`{component}`{} is not written", at(vertex)),
            What::VertexCount { expected, actual } => write!(f, "{actual} vertices emitted, expected {expected}"),
            What::Strip { vertex, begins: true } => write!(f, "vertex {vertex} does not begin a strip, and should"),
            What::Strip { vertex, begins: false } => write!(f, "vertex {vertex} begins a strip, and should not"),
            What::TooManyVertices { emitted, max } => {
                write!(f, "{emitted} vertices emitted, `max_vertices` is {max}; those past it are lost")
            }
            What::Endless => write!(f, "a loop goes on after {FUEL} rounds"),
        }
    }
}

fn number(x: f64, scalar: Scalar) -> String {
    match scalar {
        // Rust writes NaN with capitals, as no shader author does.
        Scalar::F32 if x.is_nan() => "nan".to_owned(),
        Scalar::F32 => format!("{x:?}"),
        Scalar::Bool => (x != 0.0).to_string(),
        Scalar::I32 | Scalar::U32 => format!("{x}"),
    }
}

/// A word in decimal with its bits.
fn word(word: u32, scalar: Scalar) -> String {
    match scalar {
        Scalar::F32 => format!("{:?}", F32Bits(word)),
        Scalar::I32 => (word as i32).to_string(),
        Scalar::U32 => word.to_string(),
        Scalar::Bool => (word != 0).to_string(),
    }
}

/// A word as a number.
pub(super) fn real(word: u32, scalar: Scalar) -> f64 {
    match scalar {
        Scalar::F32 => f64::from(f32::from_bits(word)),
        Scalar::I32 => f64::from(word as i32),
        Scalar::U32 | Scalar::Bool => f64::from(word),
    }
}

/// True when two numbers are no farther apart than `bound`. NaN is near to nothing, whichever side it
/// is on, and an infinite bound says nothing.
pub fn agrees(a: f64, b: f64, bound: f64) -> bool {
    bound.is_finite() && (a == b || (a - b).abs() <= bound)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_never_agrees() {
        for (a, b) in [(1.0, f64::NAN), (f64::NAN, 1.0), (f64::NAN, f64::NAN), (f64::INFINITY, f64::NAN)] {
            assert!(!agrees(a, b, 1e300), "{a} {b}");
        }
        assert!(!agrees(1.0, 1.0, f64::NAN) && !agrees(1.0, 1.0, f64::INFINITY));
    }

    #[test]
    fn the_bound_is_the_limit() {
        assert!(agrees(1.0, 1.25, 0.25) && !agrees(1.0, 1.25, 0.2499));
        assert!(agrees(0.0, -0.0, 0.0), "zeros are one number");
        assert!(agrees(f64::INFINITY, f64::INFINITY, 0.0) && !agrees(f64::INFINITY, f64::NEG_INFINITY, 1e300));
    }

    fn deviation(blame: Blame) -> Deviation {
        let value = Value {
            component: "d".into(),
            vertex: Some(3),
            expected: Some(0.5),
            meaning: 0.75,
            actual: 1.0_f32.to_bits(),
            scalar: Scalar::F32,
            bound: 1e-7,
        };
        Deviation { blame, what: What::Value(value) }
    }

    #[test]
    fn each_side_is_reported_with_what_it_is_compared_with() {
        let shader = deviation(Blame::Shader);
        assert_eq!(shader.to_string(), "the shader deviates from its formula: `d` of vertex 3 is 0.75, expected 0.5");
        let lane = deviation(Blame::Lane);
        assert_eq!(
            lane.to_string(),
            "the lane deviates from the shader: `d` of vertex 3 is 1.0 (0x3f800000), expected 0.75 ± 1.0e-7"
        );
        assert_eq!((shader.ulp(), lane.ulp()), (0.5 * 2f64.powi(24), 0.25 * 2f64.powi(24)));
    }
}
