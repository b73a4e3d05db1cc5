//! What a shader means, without any lane: against its formula, and against another shader.

use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

use super::batch::Failure;
use super::fit::open_samples;
use super::judge::Verdict;
use super::oracle::JudgeContext;
use super::parallel::parts;
use super::second_pass::SecondPass;
use base::value::Batch;
use program::OutputLayout;
use program::interp::{HazardKind, OutputColumn, SLOTS};

/// How far one shader's meaning is from another's.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Movement {
    /// Invocations with an output that means another number.
    pub samples: u64,
    /// Largest distance between outputs, in units of what a lane is allowed there; infinite for
    /// another number of vertices, and where only one of the two has a value.
    #[serde(with = "base::value::exact")]
    pub bounds: f64,
    /// The component that moved by that much, such as `gl_Position.x`; none when no component moved
    /// that has a bound.
    pub component: Option<String>,
}

impl Movement {
    /// Adds what was seen on other invocations.
    pub fn merge(&mut self, later: Self) {
        self.samples += later.samples;
        if later.component.is_some() && (self.component.is_none() || later.bounds > self.bounds) {
            self.bounds = later.bounds;
            self.component = later.component;
        }
    }
}

/// The first invocation in which the shader deviates from the formula. No lane has a say in it.
pub fn shader_deviation(context: &JudgeContext<'_>, layout: &OutputLayout, batch: &Batch) -> Option<Failure> {
    let count = batch.invocation_count();
    let found = AtomicUsize::new(usize::MAX);
    let failures = parts(
        count.div_ceil(SLOTS),
        || (context.oracle.ideal_or_meaning(), SecondPass::new(context)),
        |(machine, second), chunk| {
            let first = chunk * SLOTS;
            if first > found.load(Ordering::Relaxed) {
                return None;
            }
            let open = open_samples(context, machine, batch, first);
            for (invocation, verdict) in open.iter().zip(second.shader(batch, layout, None, &open)) {
                if let Some(Verdict::Deviate(deviation)) = verdict {
                    found.fetch_min(*invocation, Ordering::Relaxed);
                    return Some(Failure { invocation: *invocation, deviation });
                }
            }
            None
        },
    );
    failures.into_iter().flatten().min_by_key(|failure| failure.invocation)
}

/// How far the meaning of `after` is from that of `before`, which is the scale.
pub fn movement(before: &JudgeContext<'_>, after: &JudgeContext<'_>, layout: &OutputLayout, batch: &Batch) -> Movement {
    let count = batch.invocation_count();
    let chunks = parts(
        count.div_ceil(SLOTS),
        || (before.oracle.ideal_or_meaning(), after.oracle.ideal_or_meaning(), before.oracle.tape(before.lenient())),
        |(old, new, tape), chunk| {
            let first = chunk * SLOTS;
            let slots = old.run(batch, first);
            new.run(batch, first);
            let mut movement = Movement::default();
            let mut moved = [false; SLOTS];
            for slot in 0..slots {
                let shape = old.emitted()[slot] != new.emitted()[slot]
                    || (0..old.room()).any(|v| old.is_emitting() && old.strip(v)[slot] != new.strip(v)[slot]);
                if shape || old.flags()[slot].has(HazardKind::Fuel) != new.flags()[slot].has(HazardKind::Fuel) {
                    moved[slot] = true;
                    movement.bounds = f64::INFINITY;
                    movement.component = Some("the number of vertices".to_owned());
                }
            }
            let mut ran = false;
            for vertex in 0..old.room() {
                for word in 0..layout.vertex.words() {
                    let (a, b) = match (old.output(vertex, word), new.output(vertex, word)) {
                        (OutputColumn::Real(a), OutputColumn::Real(b)) => (a.values(), b.values()),
                        (OutputColumn::Word(a), OutputColumn::Word(b)) => {
                            (0..slots).filter(|&slot| a[slot] != b[slot]).for_each(|slot| moved[slot] = true);
                            continue;
                        }
                        _ => continue,
                    };
                    let stored = |slot: usize| !old.is_emitting() || (vertex as u32) < old.emitted()[slot];
                    let far: Vec<usize> =
                        (0..slots).filter(|&slot| stored(slot) && a[slot].to_bits() != b[slot].to_bits()).collect();
                    if far.is_empty() {
                        continue;
                    }
                    if !ran {
                        tape.run(batch, first);
                        ran = true;
                    }
                    let OutputColumn::Real(&column) = tape.output(vertex, word) else { continue };
                    let bounds = tape.domain().bounds(column, &mut |_| false);
                    for slot in far {
                        moved[slot] = true;
                        let part = (a[slot] - b[slot]).abs() / bounds.bound[slot];
                        let part =
                            if part.is_nan() && a[slot].is_nan() != b[slot].is_nan() { f64::INFINITY } else { part };
                        if part > movement.bounds || movement.component.is_none() && part >= 0.0 {
                            movement.bounds = part;
                            movement.component = Some(layout.vertex.word_name(word));
                        }
                    }
                }
            }
            movement.samples = moved[..slots].iter().filter(|moved| **moved).count() as u64;
            movement
        },
    );
    let mut all = Movement::default();
    chunks.into_iter().for_each(|chunk| all.merge(chunk));
    all
}

#[cfg(test)]
mod tests {
    use super::Movement;

    #[test]
    fn the_larger_movement_wins_and_samples_add_up() {
        let moved = |samples, bounds, component: Option<&str>| Movement {
            samples,
            bounds,
            component: component.map(str::to_owned),
        };
        let mut all = moved(1, 0.5, Some("a"));
        all.merge(moved(2, 0.0, None));
        all.merge(moved(3, 0.25, Some("b")));
        assert_eq!(all, moved(6, 0.5, Some("a")));
        all.merge(moved(1, f64::INFINITY, Some("c")));
        assert_eq!(all, moved(7, f64::INFINITY, Some("c")));
    }
}
