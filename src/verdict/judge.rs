//! Verdicts on single samples.

use std::borrow::Cow;
use std::fmt;

use super::expected::{Expected, Output, Reference};
use super::tolerance::Tolerance;
use crate::lane::Actual;
use crate::value::{F32Bits, Scalar, ulp_at};

/// What the judge says of a sample.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Every output lies within the tolerance.
    Agree {
        /// Largest error, in ULP of the largest component of its variable.
        ulp: f64,
    },
    /// Some output is wrong.
    Deviate(Deviation),
    /// The sample decides nothing.
    Undetermined(Reason),
}

/// Why a sample decides nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Reason {
    /// The formula has no value here.
    Domain,
    /// The inputs' own rounding moves the output by more than 2^-10 of its size.
    IllConditioned,
    /// The value lies in the subnormal range or below, where a device may flush it to zero.
    Underflow,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Domain => "the formula has no value here",
            Self::IllConditioned => "ill-conditioned",
            Self::Underflow => "underflow",
        })
    }
}

/// How a sample deviates.
#[derive(Clone, Debug, PartialEq)]
pub enum Deviation {
    /// A component is off by more than the tolerance, or is NaN.
    Value {
        /// Name of the component, such as `gl_Position.x`.
        component: String,
        /// Vertex, for a geometry stage.
        vertex: Option<usize>,
        /// What the formula says.
        expected: f64,
        /// The word that the lane wrote.
        actual: u32,
        /// Its type.
        scalar: Scalar,
        /// How far it may be off.
        tolerance: f64,
    },
    /// An output was never written on this path.
    NotWritten {
        /// Name of the component.
        component: String,
        /// Vertex, for a geometry stage.
        vertex: Option<usize>,
    },
    /// Another number of vertices than the formula says.
    VertexCount {
        /// What the formula says.
        expected: usize,
        /// What was emitted.
        actual: u32,
    },
    /// A strip begins or goes on where it should not.
    Strip {
        /// Vertex at which the strips part.
        vertex: usize,
        /// True when a strip begins here by the formula.
        begins: bool,
    },
    /// More vertices than `max_vertices`.
    TooManyVertices {
        /// Number of calls of `EmitVertex`.
        emitted: u32,
        /// The declared limit.
        max: u32,
    },
}

impl Deviation {
    /// Distance in ULP at the expected value; infinite for everything that is no number.
    pub fn ulp(&self) -> f64 {
        match self {
            Self::Value { expected, actual, scalar: Scalar::F32, .. } => {
                let distance = crate::value::ulp_distance(*expected, f32::from_bits(*actual));
                if distance.is_nan() { f64::INFINITY } else { distance }
            }
            Self::Value { .. } | Self::NotWritten { .. } | Self::VertexCount { .. } => f64::INFINITY,
            Self::Strip { .. } | Self::TooManyVertices { .. } => f64::INFINITY,
        }
    }
}

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = |vertex: &Option<usize>| vertex.map_or_else(String::new, |v| format!(" of vertex {v}"));
        match self {
            Self::Value { component, vertex, expected, actual, scalar, tolerance } => {
                write!(f, "`{component}`{} is {}, expected {expected:?}", at(vertex), word(*actual, *scalar))?;
                if *scalar == Scalar::F32 {
                    write!(f, " ± {tolerance:.1e}")?;
                }
                Ok(())
            }
            Self::NotWritten { component, vertex } => write!(f, "`{component}`{} is not written", at(vertex)),
            Self::VertexCount { expected, actual } => write!(f, "{actual} vertices emitted, expected {expected}"),
            Self::Strip { vertex, begins: true } => write!(f, "vertex {vertex} does not begin a strip, and should"),
            Self::Strip { vertex, begins: false } => write!(f, "vertex {vertex} begins a strip, and should not"),
            Self::TooManyVertices { emitted, max } => {
                write!(f, "{emitted} vertices emitted, `max_vertices` is {max}; those past it are lost")
            }
        }
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

/// One component on both sides: what the formula says, at which scale, and what the lane wrote.
#[derive(Clone, Copy, Debug)]
pub struct Component {
    /// What the formula says.
    pub expected: f64,
    /// Scale of the tolerance.
    pub scale: f64,
    /// The word that the lane wrote.
    pub actual: u32,
    /// Its type.
    pub scalar: Scalar,
}

/// Judges one component. `Err` holds the tolerance that it misses. NaN never agrees with anything.
///
/// # Errors
/// How far off the component may be, when it is farther off.
pub fn judge_value(component: &Component, tolerance: &Tolerance) -> Result<f64, f64> {
    let Component { expected, scale, actual, scalar } = *component;
    match scalar {
        Scalar::F32 => {
            // An infinite tolerance would let everything pass; the caller looks at the scale first.
            let allowed = if scale.is_finite() { tolerance.at(scale) } else { f64::NAN };
            let error = (f64::from(f32::from_bits(actual)) - expected).abs();
            // Written so that a NaN on either side, in the error or in the scale, does not pass.
            if error <= allowed { Ok(error / ulp_at(scale)) } else { Err(allowed) }
        }
        // Integers and booleans are exact.
        Scalar::I32 if f64::from(actual as i32) == expected => Ok(0.0),
        Scalar::U32 | Scalar::Bool if f64::from(actual) == expected => Ok(0.0),
        Scalar::I32 | Scalar::U32 | Scalar::Bool => Err(0.0),
    }
}

/// Judges one invocation. `inputs` are those from which `expected` was computed.
pub fn judge_sample(
    reference: &Reference,
    inputs: &[f64],
    expected: &Expected,
    actual: &Actual,
    invocation: usize,
    tolerance: &Tolerance,
) -> Verdict {
    let senses = |enough: &mut dyn FnMut(&[f64]) -> bool| Senses {
        sensitivity: Cow::Owned(reference.sensitivity_until(inputs, expected, enough)),
        vectors: reference.vector_size(inputs),
    };
    judge_with(reference, &senses, expected, actual, invocation, tolerance)
}

/// How the inputs of a sample bear on its outputs.
pub(super) struct Senses<'s> {
    /// For each expected word, its sensitivity to the inputs.
    pub sensitivity: Cow<'s, [f64]>,
    /// The largest component of all vectors among the inputs.
    pub vectors: f64,
}

/// Gives the senses of a sample. The search may end as soon as the sums of squares are `enough`.
pub(super) type Sense<'f, 's> = dyn Fn(&mut dyn FnMut(&[f64]) -> bool) -> Senses<'s> + 'f;

/// The same where the sensitivity may be known already; it is only asked for when it is needed.
pub(super) fn judge_with<'s>(
    reference: &Reference,
    senses: &Sense<'_, 's>,
    expected: &Expected,
    actual: &Actual,
    invocation: usize,
    tolerance: &Tolerance,
) -> Verdict {
    if let Some(deviation) = shape(reference, expected, actual, invocation) {
        return Verdict::Deviate(deviation);
    }
    let mut worst = 0.0_f64;
    let mut suspects = Vec::new();
    for vertex in 0..actual.stored(invocation) {
        let words = actual.vertex(invocation, vertex);
        let base = vertex * reference.vertex_words;
        for output in &reference.outputs {
            let values = &expected.words[base + output.expected.start..base + output.expected.end];
            let words = &words[output.actual.clone()];
            let scale = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            if let Some(ulp) = judge_variable(values, words, scale, output.scalar, tolerance) {
                worst = worst.max(ulp);
                continue;
            }
            for (k, (&value, &word)) in values.iter().zip(words).enumerate() {
                let component = Component { expected: value, scale, actual: word, scalar: output.scalar };
                match judge_value(&component, tolerance) {
                    Ok(ulp) => worst = worst.max(ulp),
                    Err(_) => suspects.push((vertex, output, k, component)),
                }
            }
        }
    }
    if suspects.is_empty() {
        return Verdict::Agree { ulp: worst };
    }
    judge_suspects(reference, senses, expected, actual, tolerance, &suspects, worst)
}

/// All components of a variable at once: the largest error in ULP when all of them agree. Most
/// samples end here, so nothing is computed twice.
fn judge_variable(values: &[f64], words: &[u32], scale: f64, scalar: Scalar, tolerance: &Tolerance) -> Option<f64> {
    if scalar != Scalar::F32 || !scale.is_finite() {
        return None;
    }
    let allowed = tolerance.at(scale);
    let mut largest = 0.0_f64;
    for (&value, &word) in values.iter().zip(words) {
        let error = (f64::from(f32::from_bits(word)) - value).abs();
        if error > allowed || error.is_nan() {
            return None;
        }
        largest = largest.max(error);
    }
    Some(largest / ulp_at(scale))
}

type Suspect<'r> = (usize, &'r Output, usize, Component);

/// The costly part: components that miss the tolerance at their own scale get the scale of the
/// inputs.
fn judge_suspects<'s>(
    reference: &Reference,
    senses: &Sense<'_, 's>,
    expected: &Expected,
    actual: &Actual,
    tolerance: &Tolerance,
    suspects: &[Suspect<'_>],
    mut worst: f64,
) -> Verdict {
    if expected.words.iter().any(|v| v.is_nan()) {
        // The formula has no value for some output; the others are judged all the same.
        let judged = suspects.iter().filter(|(.., c)| !c.expected.is_nan() && !c.scale.is_nan());
        if judged.count() == 0 {
            return Verdict::Undetermined(Reason::Domain);
        }
    }
    let at = |vertex: usize, output: &Output, k: usize| vertex * reference.vertex_words + output.expected.start + k;
    // A right sample needs a part of the sensitivity: the search for it ends once all suspects agree.
    let mut all_agree = |squares: &[f64]| {
        suspects.iter().all(|&(vertex, output, k, component)| {
            let scale = component.scale + squares[at(vertex, output, k)].sqrt();
            scale.is_finite() && judge_value(&Component { scale, ..component }, tolerance).is_ok()
        })
    };
    let Senses { sensitivity, vectors } = senses(&mut all_agree);
    let mut undetermined = None;
    for &(vertex, output, k, component) in suspects {
        let name = || component_name(actual, output, k);
        let on = actual.layout().max_vertices.map(|_| vertex);
        if actual.is_unwritten(component.actual) {
            return Verdict::Deviate(Deviation::NotWritten { component: name(), vertex: on });
        }
        if component.expected.is_nan() {
            undetermined = Some(Reason::Domain);
            continue;
        }
        let passed = sensitivity[at(vertex, output, k)];
        let scaled = Component { scale: component.scale + passed, ..component };
        match judge_value(&scaled, tolerance) {
            Ok(_) => {
                worst = worst.max(tolerance.ulp.min((scaled.expected - value(&scaled)).abs() / ulp_at(scaled.scale)))
            }
            Err(_)
                if component.scalar == Scalar::F32
                    && tolerance.is_useless(scaled.scale, component.scale.max(vectors).max(size(&component))) =>
            {
                undetermined = Some(Reason::IllConditioned);
            }
            // Terms of this size may have been flushed to zero on the way.
            // They leave a small value behind, and neither a large one nor a NaN.
            Err(_) if component.scale < FLUSHED && value(&component).abs() < FLUSHED => {
                undetermined = Some(Reason::Underflow);
            }
            Err(_) if !scaled.scale.is_finite() => undetermined = Some(Reason::IllConditioned),
            Err(allowed) => {
                return Verdict::Deviate(Deviation::Value {
                    component: name(),
                    vertex: on,
                    expected: component.expected,
                    actual: component.actual,
                    scalar: component.scalar,
                    tolerance: allowed,
                });
            }
        }
    }
    undetermined.map_or(Verdict::Agree { ulp: worst }, Verdict::Undetermined)
}

/// Below 2^-100 a flushed term (less than 2^-126) may be more than the rounding of the sum.
pub(super) const FLUSHED: f64 = f64::from_bits((1023 - 100) << 52);

/// Size of what the lane wrote; 0 for what is no number. Beside a distance of 0 every tolerance is
/// large, and a tolerance that is small beside the points and beside a wrong value tests it all the same.
fn size(component: &Component) -> f64 {
    let size = value(component).abs();
    if size.is_finite() { size } else { 0.0 }
}

fn value(component: &Component) -> f64 {
    f64::from(f32::from_bits(component.actual))
}

pub(super) fn component_name(actual: &Actual, output: &Output, k: usize) -> String {
    actual.layout().vertex.word_name(output.actual.start + k)
}

/// Compares what is no number: how many vertices, in which strips.
fn shape(reference: &Reference, expected: &Expected, actual: &Actual, invocation: usize) -> Option<Deviation> {
    let max = actual.layout().max_vertices?;
    let emitted = actual.emitted(invocation);
    if emitted > max {
        return Some(Deviation::TooManyVertices { emitted, max });
    }
    let count = expected.words.len() / reference.vertex_words.max(1);
    if emitted as usize != count {
        return Some(Deviation::VertexCount { expected: count, actual: emitted });
    }
    (1..count).find_map(|vertex| {
        let begins = expected.strips[vertex] != expected.strips[vertex - 1];
        let began = actual.strip(invocation, vertex) != actual.strip(invocation, vertex - 1);
        (begins != began).then_some(Deviation::Strip { vertex, begins })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn component(expected: f64, actual: f32) -> Component {
        Component { expected, scale: expected.abs(), actual: actual.to_bits(), scalar: Scalar::F32 }
    }

    const FOUR: Tolerance = Tolerance { ulp: 4.0 };

    #[test]
    fn nan_never_agrees() {
        for (expected, actual) in [(1.0, f32::NAN), (f64::NAN, 1.0), (f64::NAN, f32::NAN), (f64::INFINITY, f32::NAN)] {
            assert!(judge_value(&component(expected, actual), &FOUR).is_err(), "{expected} {actual}");
        }
    }

    #[test]
    fn infinity_is_no_number_either() {
        assert!(judge_value(&component(1.0, f32::INFINITY), &FOUR).is_err());
        assert!(judge_value(&component(f64::INFINITY, f32::INFINITY), &FOUR).is_err());
    }

    #[test]
    fn four_ulp_pass_and_five_do_not() {
        let off = |n: u32| f32::from_bits(1.5_f32.to_bits() + n);
        assert_eq!(judge_value(&component(1.5, off(4)), &FOUR), Ok(4.0));
        assert!(judge_value(&component(1.5, off(5)), &FOUR).is_err());
    }

    #[test]
    fn zeros_of_either_sign_agree_and_a_flushed_subnormal_does() {
        assert!(judge_value(&component(0.0, -0.0), &FOUR).is_ok());
        assert!(judge_value(&component(1e-39, 0.0), &FOUR).is_ok());
        assert!(judge_value(&component(1e-37, 0.0), &FOUR).is_err());
    }

    #[test]
    fn integers_are_exact() {
        let int =
            |expected, actual: i32| Component { expected, scale: 1e9, actual: actual as u32, scalar: Scalar::I32 };
        assert!(judge_value(&int(-3.0, -3), &FOUR).is_ok());
        assert!(judge_value(&int(-3.0, -2), &FOUR).is_err());
    }
}
