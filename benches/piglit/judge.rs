//! Runs a test, and holds its colors against those that are expected.

use lanes::{Lane, LaneError, Stage};
use program::interp::{self, Binary32, Binary64};
use program::{Kernel, contain};

use super::convert::Converted;

/// How far a component of a color may be off: half a step of eight bits and a little, as in a target of
/// that format.
const TOLERANCE: f64 = 0.01;

/// What ran the test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Runner {
    /// The interpreter in binary64.
    Real,
    /// The interpreter in strict binary32.
    Strict,
    /// A device, in the compute stage.
    Compute,
    /// A device, in the vertex stage.
    Vertex,
}

impl Runner {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Real, Self::Strict, Self::Compute, Self::Vertex];
}

/// What became of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// Every color is the expected one.
    Agrees,
    /// Cases whose color is another: number of the case, and the color.
    Disagrees(Vec<(usize, Vec<String>)>),
    /// It does not run there.
    Not(String),
}

/// Runs a test on one runner; a device has to be given for those that need one.
pub fn judge(test: &Converted, runner: Runner, device: Option<&dyn Lane>) -> Option<Found> {
    let found = match runner {
        Runner::Real => contain(|| interpreted::<Binary64>(test, |w| w)),
        Runner::Strict => contain(|| interpreted::<Binary32>(test, |w| f64::from(f32::from_bits(w)))),
        Runner::Compute => {
            let device = device?;
            contain(|| match test.program.compute_kernel() {
                Ok(kernel) => on(test, device, &kernel),
                Err(error) => Found::Not(error.to_string()),
            })
        }
        Runner::Vertex => {
            let device = device.filter(|d| d.description().stages.contains(&Stage::Vertex))?;
            if test.stage != syntax::Stage::Vertex {
                return None;
            }
            contain(|| match test.program.vertex_kernel(&[]) {
                Ok(kernel) => on(test, device, &kernel),
                Err(error) => Found::Not(error.to_string()),
            })
        }
    };
    Some(found.unwrap_or_else(|panic| Found::Not(format!("panic: {panic}"))))
}

fn interpreted<D: interp::Domain + Default>(test: &Converted, number: impl Fn(D::Word) -> f64) -> Found
where
    D::Word: Copy,
{
    let meaning = match interp::run::<D>(&test.program, &test.batch) {
        Ok(meaning) => meaning,
        Err(error) => return Found::Not(error.to_string()),
    };
    let colors = (0..meaning.count()).map(|i| {
        let stored = (0..meaning.stored(i))
            .map(|v| meaning.vertex(i, v)[test.color.clone()].iter().map(|&w| number(w)).collect::<Vec<f64>>());
        stored.collect::<Vec<_>>()
    });
    compared(test, colors)
}

fn on(test: &Converted, device: &dyn Lane, kernel: &Kernel) -> Found {
    let count = test.batch.invocation_count();
    let run = || -> Result<_, LaneError> { device.prepare(kernel, count)?.run(&test.batch) };
    let actual = match run() {
        Ok(actual) => actual,
        Err(error) => return Found::Not(error.to_string()),
    };
    let colors = (0..actual.count()).map(|i| {
        let words = |v| actual.vertex(i, v)[test.color.clone()].iter().map(|&w| f64::from(f32::from_bits(w))).collect();
        (0..actual.stored(i)).map(words).collect::<Vec<Vec<f64>>>()
    });
    compared(test, colors)
}

/// Compares the colors of all vertices of each case.
fn compared(test: &Converted, colors: impl Iterator<Item = Vec<Vec<f64>>>) -> Found {
    let mut other = Vec::new();
    let mut count = 0;
    for (case, (vertices, expected)) in colors.zip(&test.expected).enumerate() {
        count += 1;
        let same = |color: &Vec<f64>| {
            color.len() >= expected.len()
                && color.iter().zip(expected).all(|(got, want)| (got - f64::from(*want)).abs() <= TOLERANCE)
        };
        if vertices.is_empty() || !vertices.iter().all(same) {
            let shown = vertices.first().map(|v| v.iter().map(f64::to_string).collect());
            other.push((case, shown.unwrap_or_default()));
        }
    }
    if count != test.expected.len() {
        return Found::Not(format!("{count} of {} cases came back", test.expected.len()));
    }
    if other.is_empty() { Found::Agrees } else { Found::Disagrees(other) }
}
