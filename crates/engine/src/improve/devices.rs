//! What an expression loses on devices: at most, by what specifications promise and by what was measured, and as lanes give it.
//!
//! The rewrites that gain most in binary32 rest on functions that a device makes of others: Mesa has `sinh` as a difference
//! of exponentials, which loses the digits that the rewrite was to keep. So the text and the proposal are both judged as
//! programs of their own.

use serde::{Deserialize, Serialize};

use super::Lost;
use crate::fuzz::{Ready, subjects};
use ::improve::{Dialect, LeafText, Losses, Points, Split, Term, WORST, written};
use base::text::SourceFile;
use base::value::{Batch, ulp_at};
use judge::profile::{Allowed, Op, Profile, by_name, names};
use judge::verdict::{Limiter, Limits, Oracle};
use lanes::{Lane, Stage};
use syntax::Shader;

/// Bits in the mean by which figures of the same formula differ between points.
const ALIKE: f64 = 0.02;

/// Bits that the worst point may lose more.
const WORST_MORE: f64 = 1.0;

/// ULP up to which a hyperbolic function beside 0 counts as one that a device has.
const OWN: f64 = 16.0;

/// Arguments of hyperbolic functions at which one that is made of exponentials has lost digits.
const SMALL: [f64; 2] = [1.0 / 1024.0, 1.0 / 16.0];

/// The promise that every measured device keeps: measurements beside the ends of the range say little elsewhere.
const KEPT: &str = "glsl-4.60";

/// Of so many points, one must have a bound by a measurement.
const KNOWN: usize = 4;

/// What figures are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Source {
    /// The most that a device may lose that keeps a promise.
    Promise,
    /// The most that a device loses by its measured errors.
    Measurement,
    /// What a lane lost.
    Lane,
}

/// Bits lost on a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OnDevice {
    /// The name of a profile or a lane.
    pub name: String,
    /// What the figures are of.
    pub source: Source,
    /// Before and after.
    pub lost: [Lost; 2],
}

impl OnDevice {
    /// True where the proposal loses more.
    pub fn is_worse(&self) -> bool {
        let [before, after] = self.lost;
        after.mean > before.mean + ALIKE || after.worst > before.worst + WORST_MORE
    }

    /// Bits in the mean that the proposal loses more.
    pub(super) fn more(&self) -> f64 {
        self.lost[1].mean - self.lost[0].mean
    }

    /// What both lose, for people.
    pub(super) fn beside(&self) -> String {
        let [before, after] = self.lost;
        format!(
            "{:.1} bits in the mean and {:.1} at worst, where the text loses {:.1} and {:.1}",
            after.mean, after.worst, before.mean, before.worst
        )
    }

    /// What it is, for people.
    pub fn shown(&self) -> String {
        match self.source {
            Source::Promise => format!("at most, by {}", self.name),
            Source::Measurement => format!("at most, on {}", self.name),
            Source::Lane => format!("on the lane {}", self.name),
        }
    }
}

/// The profiles that formulas are judged by where none is asked for: promises of APIs, and all measured devices.
pub fn shipped() -> Vec<&'static Profile> {
    let promised = |name: &str| ["vulkan-1.4", "wgsl", "glsl-4.60"].contains(&name);
    names().filter_map(by_name).filter(|one| promised(&one.name) || one.driver.is_some()).collect()
}

/// Whether a device has hyperbolic functions that keep their digits beside 0.
pub(super) fn has_hyperbolic(profile: &Profile) -> bool {
    type Function = fn(f64) -> f64;
    let functions: [(Op, Function); 4] =
        [(Op::Sinh, f64::sinh), (Op::Tanh, f64::tanh), (Op::Asinh, f64::asinh), (Op::Atanh, f64::atanh)];
    let keeps = |op: Op, x: f64, exact: f64| match profile.allowed(op, &[x], exact, Stage::Compute) {
        Allowed::Bound(bound) => bound <= OWN * ulp_at(exact),
        Allowed::Inherited { .. } | Allowed::NoPromise | Allowed::OutsideDomain => false,
    };
    functions.iter().all(|(op, of)| SMALL.iter().all(|&x| keeps(*op, x, of(x))))
}

/// An expression at its points, with what it loses on devices.
pub(super) struct Devices<'a> {
    profiles: &'a [&'a Profile],
    lanes: &'a [&'a dyn Lane],
    points: &'a Points,
    /// What it is at the points in real numbers.
    exact: &'a [f64],
    before: Vec<Figures>,
}

/// What a formula loses at each point on one device; NaN where nothing bounds it.
type Figures = (String, Source, Losses);

impl<'a> Devices<'a> {
    /// # Errors
    /// When the expression cannot run as a program of its own.
    pub(super) fn new(
        original: &Term,
        (points, exact): (&'a Points, &'a [f64]),
        profiles: &'a [&'a Profile],
        lanes: &'a [&'a dyn Lane],
    ) -> Result<Self, String> {
        let mut devices = Self { profiles, lanes, points, exact, before: Vec::new() };
        devices.before = devices.of(&Split::Term(0), std::slice::from_ref(original))?;
        Ok(devices)
    }

    /// Both on all devices.
    ///
    /// # Errors
    /// When the proposal cannot run as a program of its own.
    pub(super) fn beside(&self, split: &Split, terms: &[Term]) -> Result<Vec<OnDevice>, String> {
        let after = self.of(split, terms)?;
        let both = self.before.iter().filter_map(|(name, source, before)| {
            let (.., after) = after.iter().find(|(other, kind, _)| other == name && kind == source)?;
            Some(OnDevice { name: name.clone(), source: *source, lost: side_by_side(*source, [before, after])? })
        });
        Ok(both.collect())
    }

    fn of(&self, split: &Split, terms: &[Term]) -> Result<Vec<Figures>, String> {
        let ready = ready(split, terms, self.points.width())?;
        let batch = batch(&ready, self.points)?;
        let oracle = Oracle::new(&ready.program).map_err(|error| error.to_string())?;
        let mut all = Vec::new();
        let kept = by_name(KEPT).map(|promise| self.bounded(&oracle, promise, &batch));
        for profile in self.profiles {
            let bounded = self.bounded(&oracle, profile, &batch);
            let (source, losses) = match &kept {
                Some(kept) if profile.driver.is_some() => (Source::Measurement, least(&bounded, kept)),
                _ => (Source::Promise, bounded),
            };
            all.push((profile.name.clone(), source, losses));
        }
        for lane in self.lanes {
            // What a lane cannot run says nothing about the formula.
            let Some(outputs) = on_lane(*lane, &ready, &batch) else { continue };
            let losses = Losses::of(&outputs, self.exact);
            all.push((lane.description().name.to_string(), Source::Lane, losses));
        }
        Ok(all)
    }

    /// The most that a device loses at each point; NaN where nothing bounds it.
    fn bounded(&self, oracle: &Oracle, profile: &Profile, batch: &Batch) -> Losses {
        // What a device that regroups makes of either is the same, so that it says nothing about the choice.
        let profile = profile.in_order();
        let mut limiter = Limiter::new(oracle, &profile, Stage::Compute);
        let (mut limits, mut losses) = (Limits::default(), Vec::with_capacity(self.exact.len()));
        while losses.len() < self.exact.len() {
            limiter.look(batch, losses.len(), &mut limits);
            for slot in 0..limits.slots {
                let exact = self.exact[losses.len()];
                let ulps = (limits.bounds[slot] + (limits.values[slot] - exact).abs()) / ulp_at(exact);
                let known = limits.reasons[slot].is_none() && ulps.is_finite();
                losses.push(if known { (1.0 + ulps).log2().min(WORST) } else { f64::NAN });
            }
            if limits.slots == 0 {
                break;
            }
        }
        Losses(losses)
    }
}

/// The smaller bound of each point; NaN where there is neither.
fn least(a: &Losses, b: &Losses) -> Losses {
    Losses(a.0.iter().zip(&b.0).map(|(a, b)| a.min(*b)).collect())
}

/// What both lose. Where an API promises nothing, all may be lost; where a device was not measured, nothing is known, and a
/// device of which little is known is left out.
fn side_by_side(source: Source, both: [&Losses; 2]) -> Option<[Lost; 2]> {
    let [before, after] = both.map(|losses| &losses.0);
    let all = || before.iter().zip(after);
    let is_known = |(a, b): &(&f64, &f64)| source != Source::Measurement || !(a.is_nan() || b.is_nan());
    let known: Vec<(&f64, &f64)> = all().filter(is_known).collect();
    let worst = |lost: &f64| if lost.is_nan() { WORST } else { *lost };
    let side =
        |of: fn(&(&f64, &f64)) -> f64| Lost::of(&Losses(known.iter().map(of).map(|lost| worst(&lost)).collect()));
    (known.len() * KNOWN >= before.len()).then(|| [side(|both| *both.0), side(|both| *both.1)])
}

/// A formula as a function of its leaves.
fn ready(split: &Split, terms: &[Term], width: usize) -> Result<Box<Ready>, String> {
    let leaves: Vec<LeafText> = (0..width).map(|k| LeafText::from(format!("x{k}"))).collect();
    let parameters: Vec<String> = (0..width).map(|k| format!("float x{k}")).collect();
    let formula = written(split, terms, &leaves, Dialect::Glsl);
    let text = format!("#version 330\nfloat formula({}) {{ return {formula}; }}\n", parameters.join(", "));
    let shader = Shader::parse(&SourceFile::new("formula.glsl", text), syntax::Stage::Library).shader;
    let found = subjects(&shader, &|_| true).map_err(|bad| bad.why)?;
    found.into_iter().next().ok_or_else(|| "the formula has no program".to_owned())?.ready
}

fn batch(ready: &Ready, points: &Points) -> Result<Batch, String> {
    let kernel = &ready.kernel;
    let (record, case) = (kernel.invocation.clone(), kernel.case.clone());
    let mut batch = Batch::with_capacity(record.clone(), case, 1, points.len());
    let words: Vec<Option<usize>> =
        (0..points.width()).map(|k| Some(record.range(record.index_of(&format!("x{k}"))?).start)).collect();
    if record.words() == 0 || kernel.case.words() > 0 {
        return Err("the formula has no inputs".to_owned());
    }
    for at in 0..points.len() {
        let mut own = vec![0; record.words()];
        for (leaf, word) in words.iter().enumerate() {
            if let Some(word) = word {
                own[*word] = points.leaf(leaf as u32)[at].to_bits();
            }
        }
        batch.invocations.extend(own);
    }
    Ok(batch)
}

fn on_lane(lane: &dyn Lane, ready: &Ready, batch: &Batch) -> Option<Vec<f32>> {
    let count = batch.invocation_count();
    let mut runner = lane.prepare(&ready.kernel, count).ok().filter(|runner| runner.capacity() >= count)?;
    let actual = runner.run(batch).ok()?;
    (0..count).map(|k| actual.vertex(k, 0).first().map(|word| f32::from_bits(*word))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::improve::{parse, reference};

    /// Points evenly from one number to another.
    fn even(from: f32, to: f32) -> Vec<f32> {
        (0..256_u16).map(|k| from + (to - from) * f32::from(k) / 256.0).collect()
    }

    /// The profiles that lose more by the second formula, over binades from 2^-20 to 8.
    fn worse(before: &str, after: &str) -> Vec<String> {
        worse_at(before, after, even(-20.0, 3.0).into_iter().map(f32::exp2))
    }

    fn worse_at(before: &str, after: &str, points: impl Iterator<Item = f32>) -> Vec<String> {
        let points = Points::new(&points.map(|x| vec![x]).collect::<Vec<_>>());
        let (before, after) = (parse(before).unwrap(), parse(after).unwrap());
        let exact = reference(&before, &points).unwrap();
        let profiles = shipped();
        let devices = Devices::new(&before, (&points, &exact), &profiles, &[]).unwrap();
        let all = devices.beside(&Split::Term(0), &[after]).unwrap();
        assert!(all.iter().any(|one| one.name.starts_with("llvmpipe")), "{all:?}");
        all.into_iter().filter(OnDevice::is_worse).map(|one| one.name).collect()
    }

    #[test]
    fn a_rewrite_by_a_function_that_mesa_makes_of_others_is_worse_there() {
        let found = worse("(- 1 (exp (neg x0)))", "(* 2 (* (exp (neg (/ x0 2))) (sinh (/ x0 2))))");
        assert!(found.iter().any(|name| name.starts_with("llvmpipe")), "{found:?}");
        let found = worse("(log (+ 1 x0))", "(* 2 (atanh (/ x0 (+ 2 x0))))");
        assert!(found.iter().any(|name| name.starts_with("llvmpipe")), "{found:?}");
    }

    #[test]
    fn a_rewrite_by_arithmetic_is_worse_nowhere() {
        let (roots, quotient) = ("(- (sqrt (+ x0 1)) (sqrt x0))", "(/ 1 (+ (sqrt (+ x0 1)) (sqrt x0)))");
        assert_eq!(worse_at(roots, quotient, even(0.0, 20.0).into_iter().map(f32::exp2)), [""; 0]);
        let (squares, factors) = ("(- (* x0 x0) (* 4 4))", "(* (- x0 4) (+ x0 4))");
        assert_eq!(worse_at(squares, factors, even(3.9, 4.1).into_iter()), [""; 0]);
        // Where nothing cancels, a quotient costs a device more than it saves.
        assert!(worse(roots, quotient).iter().any(|name| name.starts_with("nvidia")));
    }

    #[test]
    fn hyperbolic_functions_are_no_offer_where_they_are_made_of_others() {
        let named = |name: &str| by_name(name).unwrap();
        assert!(has_hyperbolic(named("binary32")));
        for name in ["vulkan-1.4", "wgsl", "llvmpipe-22.3.6"] {
            assert!(!has_hyperbolic(named(name)), "{name}");
        }
    }
}
