//! Values of a proptest strategy as a generator.

use std::collections::HashMap;
use std::fmt;
use std::sync::{Mutex, MutexGuard, PoisonError};

use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use crate::sample::encode;
use base::value::Shape;

use super::{Generator, Group, Options, Place, RangeRule, Stream, mix};

/// A value tree whose values are numbers.
trait Numbers {
    fn numbers(&self) -> Vec<f64>;
    fn simplify(&mut self) -> bool;
    fn complicate(&mut self) -> bool;
}

struct Mapped<T, F> {
    tree: T,
    numbers: F,
}

impl<T: ValueTree, F: Fn(&T::Value) -> Vec<f64>> Numbers for Mapped<T, F> {
    fn numbers(&self) -> Vec<f64> {
        (self.numbers)(&self.tree.current())
    }

    fn simplify(&mut self) -> bool {
        self.tree.simplify()
    }

    fn complicate(&mut self) -> bool {
        self.tree.complicate()
    }
}

type Grow = dyn Fn(u64) -> Option<Box<dyn Numbers>> + Send + Sync;

/// What proptest draws from a strategy. It shrinks as the strategy does: whatever stands in a sample was
/// drawn, or is a simplification of what was drawn.
pub struct Drawn {
    grow: Box<Grow>,
    /// For words that were drawn: the seed of their tree, and the steps in it.
    known: Mutex<HashMap<Vec<u32>, Steps>>,
}

/// A seed, and for each simplification of its tree that was taken how often it was taken back in part.
#[derive(Clone, Debug)]
struct Steps {
    seed: u64,
    back: Vec<usize>,
}

/// Seeds that are tried when a strategy rejects what it draws.
const TRIES: u64 = 64;
/// Seed of the value that stands for the plainest one, and for one that cannot be drawn.
const FIRST: u64 = 1;

impl Drawn {
    /// Draws from `strategy`; `numbers` gives the components of a value.
    pub fn new<S>(strategy: S, numbers: impl Fn(&S::Value) -> Vec<f64> + Clone + Send + Sync + 'static) -> Self
    where
        S: Strategy + Send + Sync + 'static,
        S::Tree: 'static,
    {
        let grow = move |seed: u64| {
            let mut bytes = [0; 32];
            bytes[..8].copy_from_slice(&seed.to_le_bytes());
            let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
            let mut runner = TestRunner::new_with_rng(Config::default(), rng);
            let tree = strategy.new_tree(&mut runner).ok()?;
            Some(Box::new(Mapped { tree, numbers: numbers.clone() }) as Box<dyn Numbers>)
        };
        Self { grow: Box::new(grow), known: Mutex::default() }
    }

    fn known(&self) -> MutexGuard<'_, HashMap<Vec<u32>, Steps>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Draws with this seed, or one that follows from it where the strategy rejects.
    fn draw(&self, seed: u64) -> Option<(u64, Box<dyn Numbers>)> {
        (0..TRIES).map(|k| if k == 0 { seed } else { mix(seed, k) }).find_map(|seed| Some((seed, (self.grow)(seed)?)))
    }

    fn write(&self, group: &Group, tree: &dyn Numbers, steps: Steps, out: &mut [u32]) {
        let words = words(group, &tree.numbers());
        // A strategy whose values change their length was refused when the first one was looked at.
        if words.len() == out.len() {
            out.copy_from_slice(&words);
            self.known().insert(words, steps);
        }
    }
}

fn words(group: &Group, numbers: &[f64]) -> Vec<u32> {
    numbers.iter().zip(group.scalars()).map(|(&number, &scalar)| encode(number, scalar)).collect()
}

impl fmt::Debug for Drawn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Drawn")
    }
}

impl Generator for Drawn {
    fn name(&self) -> &str {
        "strategy"
    }

    fn about(&self) -> &str {
        "what proptest draws from a strategy"
    }

    fn range(&self) -> RangeRule {
        RangeRule::None
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        let Some((_, tree)) = self.draw(FIRST) else {
            return Err(format!("the strategy rejects all of {TRIES} values"));
        };
        let (wanted, given): (usize, usize) = (shapes.iter().map(|s| s.words()).sum(), tree.numbers().len());
        if wanted == given {
            Ok(())
        } else {
            Err(format!("the strategy gives {given} numbers, and {wanted} are needed"))
        }
    }

    fn fill(&self, group: &Group, place: Place, _stream: &mut Stream, out: &mut [u32]) {
        let seed = mix(place.case_seed, place.invocation as u64);
        if let Some((seed, tree)) = self.draw(seed).or_else(|| self.draw(FIRST)) {
            self.write(group, &*tree, Steps { seed, back: Vec::new() }, out);
        }
    }

    fn admits(&self, _group: &Group, words: &[u32]) -> bool {
        self.known().contains_key(words)
    }

    fn edges(&self, _group: &Group, _base: &[u32]) -> Vec<Vec<u32>> {
        // Only a strategy knows what belongs to it.
        Vec::new()
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        let Some((seed, mut tree)) = self.draw(FIRST) else { return };
        let mut steps = Steps { seed, back: Vec::new() };
        while steps.back.len() < 4096 && tree.simplify() {
            steps.back.push(0);
        }
        self.write(group, &*tree, steps, out);
    }

    fn simpler(&self, group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        let Some(mut steps) = self.known().get(words).cloned() else { return false };
        let Some(mut tree) = (self.grow)(steps.seed) else { return false };
        for &back in &steps.back {
            tree.simplify();
            (0..back).for_each(|_| {
                tree.complicate();
            });
        }
        if !tree.simplify() || !(0..k).all(|_| tree.complicate()) {
            return false;
        }
        steps.back.push(k);
        self.write(group, &*tree, steps, out);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(drawn: &Drawn) -> Group {
        Group::new(drawn, &[Shape::VEC2], Options::default()).unwrap()
    }

    fn pair(value: &(f32, f32)) -> Vec<f64> {
        vec![f64::from(value.0), f64::from(value.1)]
    }

    #[test]
    fn values_come_from_the_strategy_and_are_the_same_again() {
        let drawn = Drawn::new((1.0_f32..2.0, -4.0_f32..-3.0), pair);
        let group = group(&drawn);
        let draw = |case_seed| {
            let mut out = [0; 2];
            drawn.fill(&group, Place { case_seed, invocation: 3, exact: false }, &mut Stream::new(1), &mut out);
            out
        };
        for seed in 0..100 {
            let [x, y] = draw(seed).map(f32::from_bits);
            assert!((1.0..2.0).contains(&x) && (-4.0..-3.0).contains(&y));
            assert_eq!(draw(seed), draw(seed));
            assert!(drawn.admits(&group, &draw(seed)));
        }
        assert_ne!(draw(1), draw(2));
        assert!(!drawn.admits(&group, &[0, 0]), "what was never drawn is none of it");
    }

    #[test]
    fn shrinking_walks_down_the_tree_of_the_strategy() {
        // proptest searches whole numbers by halves; floats it takes to zero or leaves.
        let tenths = (0_i32..10_000).prop_map(|k| k as f32 / 10.0);
        let drawn = Drawn::new((tenths, 0.0_f32..1.0), pair);
        let group = group(&drawn);
        let mut best = [0; 2];
        drawn.fill(&group, Place { case_seed: 9, invocation: 0, exact: false }, &mut Stream::new(1), &mut best);
        let fails = |words: &[u32; 2]| f32::from_bits(words[0]) >= 10.0;
        assert!(fails(&best), "the seed was chosen so");
        'shrink: for _ in 0..100 {
            for k in 0..40 {
                let mut out = best;
                if drawn.simpler(&group, &best, k, &mut out) && out != best && fails(&out) {
                    best = out;
                    continue 'shrink;
                }
            }
            break;
        }
        let [x, y] = best.map(f32::from_bits);
        assert!(x == 10.0 && y == 0.0, "{x} {y}");
    }

    #[test]
    fn strategies_of_another_size_are_refused() {
        let drawn = Drawn::new(0.0_f32..1.0, |x| vec![f64::from(*x)]);
        let error = Group::new(&drawn, &[Shape::VEC2], Options::default()).unwrap_err();
        assert_eq!(error, "the strategy gives 1 numbers, and 2 are needed");
        let nothing = Drawn::new((0.0_f32..1.0).prop_filter("none", |_| false), |x| vec![f64::from(*x)]);
        let error = Group::new(&nothing, &[Shape::FLOAT], Options::default()).unwrap_err();
        assert!(error.contains("rejects all"), "{error}");
    }
}
