//! Metamorphic relations: what must hold between outputs whatever the formula's value is.

use super::Sample;

/// What a lane gave for one sample, as binary64 numbers, with how far each may be off.
#[derive(Clone, Debug)]
pub struct Observed {
    /// Number of vertices: 1 for a vertex stage or a function, the emitted count for a geometry stage.
    pub vertices: usize,
    /// Output values; for several vertices, one vertex after the other. `words[vertex * n + k]`.
    pub words: Vec<f64>,
    /// How far each of `words` may be from its true value.
    pub slack: Vec<f64>,
}

/// One equation that a relation claims: `left` equals `right` to within `slack`. An inequality
/// `left <= right` is claimed with `left` set to `max(left, right)`.
#[derive(Clone, Debug)]
pub struct Claim {
    /// What is compared, such as `|p|` or `gl_Position.x`.
    pub what: String,
    /// One side.
    pub left: f64,
    /// The other side.
    pub right: f64,
    /// How far they may be apart, from the slacks of the outputs that went in.
    pub slack: f64,
}

/// A relation between the outputs of related inputs, such as "the ends swapped and t reversed give
/// the same point". It never uses the formula.
///
/// The runner calls [`Relation::inputs`] on a sample, runs these inputs on a
/// lane, and hands all outputs to [`Relation::claims`]. A claim whose sides differ by more than its
/// slack, or that holds a NaN, is a failure.
pub trait Relation: Send + Sync {
    /// Name, as suites write it: lower case with `_`.
    fn name(&self) -> &str;

    /// What it says, as one sentence without a full stop.
    fn statement(&self) -> &str;

    /// The inputs to run. The first is usually the sample itself, possibly simplified (an identity
    /// matrix in place of the projection, say). Empty when the relation says nothing about it.
    fn inputs(&self, sample: &Sample) -> Vec<Sample>;

    /// The equations that must hold. `outputs` has one entry for each of `inputs`, in order.
    fn claims(&self, inputs: &[Sample], outputs: &[Observed], claims: &mut Vec<Claim>);
}
