//! Laws: what holds between outputs of related inputs, without a formula.

use std::ops::RangeInclusive;

use property::law::{self, LawKind};

/// What holds between outputs of related inputs. It is checked on what the shader means and on the values
/// of each lane.
///
/// ```
/// use shadercheck_test::{Law, Shader};
///
/// Shader::from_text("wave.glsl", "float wave(float x) { return sin(x); }")
///     .function("wave")
///     .input("x", -2.0..=2.0)
///     .law(Law::odd(["x"]))
///     .law(Law::periodic(["x"], std::f64::consts::TAU))
///     .law(Law::range(-1.0..=1.0))
///     .lane("embedded")
///     .samples(256)
///     .assert_agrees();
/// ```
#[derive(Clone, Debug)]
pub struct Law(pub(crate) law::Law);

fn list(names: impl IntoIterator<Item = impl Into<String>>) -> Vec<String> {
    names.into_iter().map(Into::into).collect()
}

impl Law {
    fn of(kind: LawKind) -> Self {
        let at = format!("Law::{}", kind.name());
        Self(law::Law { kind, outputs: Vec::new(), at })
    }

    /// Changing the sign of these inputs changes the sign of the outputs.
    pub fn odd(inputs: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self::of(LawKind::Odd { inputs: list(inputs) })
    }

    /// Changing the sign of these inputs changes nothing.
    pub fn even(inputs: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self::of(LawKind::Even { inputs: list(inputs) })
    }

    /// The period added to every component of these inputs changes nothing.
    pub fn periodic(inputs: impl IntoIterator<Item = impl Into<String>>, period: f64) -> Self {
        Self::of(LawKind::Periodic { inputs: list(inputs), period })
    }

    /// The outputs do not fall where this number among the inputs grows.
    pub fn rising(input: impl Into<String>) -> Self {
        Self::of(LawKind::Monotone { input: input.into(), rising: true })
    }

    /// The outputs do not grow where this number among the inputs grows.
    pub fn falling(input: impl Into<String>) -> Self {
        Self::of(LawKind::Monotone { input: input.into(), rising: false })
    }

    /// Every component of the outputs lies in this range.
    pub fn range(range: RangeInclusive<f64>) -> Self {
        Self::of(LawKind::Range { range: [*range.start(), *range.end()] })
    }

    /// The outputs, vectors of floats, have length one.
    pub fn unit() -> Self {
        Self::of(LawKind::Unit)
    }

    /// Exchanging these inputs changes nothing.
    pub fn symmetric(inputs: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self::of(LawKind::Symmetric { inputs: list(inputs) })
    }

    /// Turning and shifting `points` and turning `directions` among the inputs moves those outputs that
    /// are named in these lists in the same way, and leaves all others as they are.
    pub fn rigid(
        points: impl IntoIterator<Item = impl Into<String>>,
        directions: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        Self::of(LawKind::Rigid { points: list(points), directions: list(directions), mirrored: false })
    }

    /// These inputs times k give outputs times k to the power of `degree`.
    pub fn scales(inputs: impl IntoIterator<Item = impl Into<String>>, degree: i32) -> Self {
        Self::of(LawKind::Scales { inputs: list(inputs), degree })
    }

    /// The order of the elements of these arrays, which move together, changes nothing.
    pub fn unordered(inputs: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self::of(LawKind::Unordered { inputs: list(inputs) })
    }

    /// The first elements of output arrays depend on as many first elements of these arrays alone.
    pub fn prefix(inputs: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self::of(LawKind::Prefix { inputs: list(inputs) })
    }

    /// The outputs are the elements of this array in ascending order.
    pub fn sorts(input: impl Into<String>) -> Self {
        Self::of(LawKind::Sorts { input: input.into(), rising: true })
    }

    /// The elements of each of so many equal rows of the outputs add up to `total`.
    pub fn sums(total: f64, rows: usize) -> Self {
        Self::of(LawKind::Sums { total, rows: rows.max(1) })
    }

    /// The outputs of a sum of these inputs are the sum of the outputs.
    pub fn additive(inputs: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self::of(LawKind::Additive { inputs: list(inputs) })
    }

    /// The law is about these outputs alone; `return` is the value of a function.
    #[must_use]
    pub fn of_outputs(mut self, outputs: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.0.outputs = list(outputs);
        self
    }
}
