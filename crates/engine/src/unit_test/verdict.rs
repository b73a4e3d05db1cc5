//! Whether an expectation holds: where it ran, and wherever a conforming device runs it.

use base::text::Span;
use base::value::{ulp_at, ulp_distance};
use judge::trace::TracedReal;
use lanes::LaneName;

/// What is asserted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A condition is true.
    Condition,
    /// Two whole numbers are equal.
    Equal,
    /// Two numbers or vectors are near each other: |a − b| ≤ max(absolute, relative · max(|a|, |b|)), each component.
    Near {
        /// Part of the larger one.
        relative: f64,
        /// At least this.
        absolute: f64,
    },
    /// So many ULP lie between the two at most, each component.
    Ulp(f64),
}

impl Kind {
    /// What the two numbers may be apart, with `slack` on each of them.
    fn allowed(self, actual: f64, expected: f64, slack: f64) -> f64 {
        let larger = (actual.abs().max(expected.abs()) + slack).max(0.0);
        match self {
            Self::Condition | Self::Equal => 0.0,
            Self::Near { relative, absolute } => absolute.max(relative * larger),
            Self::Ulp(most) => most * ulp_at(expected),
        }
    }

    /// True for what a lane gives. NaN is near nothing.
    pub(super) fn holds(self, found: &Found) -> bool {
        let each =
            |near: &dyn Fn(f32, f32) -> bool| found.actual.iter().zip(&found.expected).all(|(&a, &b)| near(a, b));
        match self {
            Self::Condition => found.words[0] != 0,
            Self::Equal => found.words[0] == found.words[1],
            Self::Near { .. } => each(&|a, b| {
                let (a, b) = (f64::from(a), f64::from(b));
                a == b || (a - b).abs() <= self.allowed(a, b, 0.0)
            }),
            Self::Ulp(most) => each(&|a, b| a == b || ulp_distance(f64::from(b), a) <= most),
        }
    }
}

/// What an assertion was given.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// What was computed; empty for conditions and whole numbers.
    pub actual: Vec<f32>,
    /// What it was held against.
    pub expected: Vec<f32>,
    /// Whole numbers: of a condition whether it is true, and otherwise both.
    pub words: [u32; 2],
}

/// An expectation on a lane.
#[derive(Clone, Debug, PartialEq)]
pub struct OnLane {
    /// The lane.
    pub lane: LaneName,
    /// What it gave.
    pub found: Found,
    /// True where the expectation holds there.
    pub holds: bool,
    /// True where it is farther off than a conforming device may be.
    pub deviates: bool,
}

/// What is to be said of an expectation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// It holds, and does so on every conforming device; of `room`, how many times the largest distance fits into the
    /// tolerance.
    Holds {
        /// At least 1; infinite where nothing can be off.
        room: f64,
    },
    /// It does not hold on some lane.
    Fails,
    /// It holds on each lane that ran, and a conforming device may break it.
    MayFail {
        /// The component.
        component: usize,
        /// How far the two may be apart.
        apart: f64,
        /// How far they are allowed to be.
        allowed: f64,
    },
    /// It holds on each lane that ran; a decision on the way may fall either way on a device, so that nothing is known of
    /// others.
    Undecided,
    /// It holds on each lane that ran; nothing is promised of one of the numbers.
    Unpromised,
    /// It holds on each lane that ran; in real numbers one of the numbers has no finite value.
    NoValue,
}

/// An assertion that was reached.
#[derive(Clone, Debug)]
pub struct Expectation {
    /// The call in the author's file; none where it stands in another file.
    pub site: Option<Span>,
    /// What is asserted.
    pub kind: Kind,
    /// On each lane.
    pub lanes: Vec<OnLane>,
    /// What it is in real numbers, with the largest error of a conforming device: actual and expected, each component.
    pub real: Vec<(TracedReal, TracedReal)>,
    /// What is to be said.
    pub verdict: Verdict,
}

impl Expectation {
    /// Holds what lanes gave against the assertion, and the assertion against real numbers.
    pub(super) fn judged(
        (site, kind): (Option<Span>, Kind),
        lanes: Vec<(LaneName, Found)>,
        real: Vec<(TracedReal, TracedReal)>,
        forked: bool,
    ) -> Self {
        let on = |(lane, found): (LaneName, Found)| OnLane {
            lane,
            holds: kind.holds(&found),
            deviates: !forked && !is_allowed(&real, &found),
            found,
        };
        let lanes: Vec<OnLane> = lanes.into_iter().map(on).collect();
        let verdict = match () {
            () if lanes.iter().any(|lane| !lane.holds) => Verdict::Fails,
            () if forked => Verdict::Undecided,
            () => everywhere(kind, &real),
        };
        Self { site, kind, lanes, real, verdict }
    }
}

/// True where no component is farther off than a conforming device may be.
fn is_allowed(real: &[(TracedReal, TracedReal)], found: &Found) -> bool {
    let both = real.iter().zip(found.actual.iter().zip(&found.expected));
    both.into_iter().all(|((actual, expected), (&a, &b))| actual.allows(a) && expected.allows(b))
}

/// Whether an expectation that holds here holds on every conforming device.
fn everywhere(kind: Kind, real: &[(TracedReal, TracedReal)]) -> Verdict {
    let mut room = f64::INFINITY;
    let mut worst: Option<(usize, f64, f64)> = None;
    for (component, (actual, expected)) in real.iter().enumerate() {
        let bound = actual.bound + expected.bound;
        if !actual.value.is_finite() || !expected.value.is_finite() {
            return Verdict::NoValue;
        }
        if !bound.is_finite() {
            return Verdict::Unpromised;
        }
        let apart = (actual.value - expected.value).abs() + bound;
        let allowed = kind.allowed(actual.value, expected.value, -bound);
        if apart > 0.0 && allowed / apart < room {
            room = allowed / apart;
            worst = Some((component, apart, allowed));
        }
    }
    match worst {
        Some((component, apart, allowed)) if room < 1.0 => Verdict::MayFail { component, apart, allowed },
        _ => Verdict::Holds { room },
    }
}
