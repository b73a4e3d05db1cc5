//! The other side of a question that all samples answer alike: a search from the nearest of them.

use super::watch::Key;
use super::{EdgeSearch, KEPT, SLOTS, rank, ranked, scalar, word, word_mut, words};
use base::value::Scalar;
use property::{Sample, Stream};

/// Questions that are sought at a time; each gets a share of the slots.
const QUESTIONS: usize = 8;
/// Rounds of the search, and how many of them may bring nothing.
const ROUNDS: usize = 20;
const IDLE: usize = 5;
/// Seed of what is tried.
const SEED: u64 = 0x0ed6e;

/// A search under way.
struct Aim {
    key: Key,
    best: Sample,
    gap: f32,
    side: i8,
    /// The word that brought the last sample nearer.
    hot: Option<usize>,
    done: bool,
}

impl EdgeSearch<'_> {
    /// Looks for samples on sides that none is on. Gives those that are.
    pub(super) fn approach(&mut self) -> Vec<Sample> {
        let mut aims = self.aims();
        let mut stream = Stream::new(SEED);
        let mut found = Vec::new();
        let mut idle = 0;
        for _ in 0..ROUNDS {
            aims.retain(|aim| !aim.done);
            if aims.is_empty() || idle == IDLE {
                break;
            }
            let share = SLOTS / aims.len();
            let mut tried = Vec::with_capacity(SLOTS);
            for aim in &aims {
                tried.extend((0..share).map(|_| self.beside(aim, &mut stream)));
            }
            let Some(watch) = self.try_all(&tried) else { break };
            idle += 1;
            for (k, aim) in aims.iter_mut().enumerate() {
                let Some(answers) = watch.answer(aim.key) else { continue };
                for slot in k * share..(k + 1) * share {
                    let (side, gap) = (answers.sides[slot], answers.gaps[slot].abs());
                    let other = (-1..=1).contains(&side) && side != aim.side;
                    if !aim.done && (other || gap < aim.gap) {
                        let new = &tried[slot];
                        aim.hot = (0..words(new)).find(|&at| word(new, at) != word(&aim.best, at));
                        (aim.best, aim.gap, aim.done) = (new.clone(), gap, other);
                        idle = 0;
                    }
                }
            }
            found.extend(aims.iter().filter(|aim| aim.done).map(|aim| aim.best.clone()));
        }
        found.extend(aims.into_iter().filter(|aim| !aim.done).map(|aim| aim.best));
        found
    }

    /// Questions with one side, in which inputs have a say.
    fn aims(&mut self) -> Vec<Aim> {
        let mut aims = Vec::new();
        for (&key, sides) in &mut self.known {
            let moves = sides.moves || sides.met < KEPT;
            let one = sides.on.len() == 1 && moves && !sides.sought;
            let (Some((&side, _)), Some((gap, at))) = (sides.on.first_key_value(), sides.nearest) else { continue };
            if one && side != 0 && aims.len() < QUESTIONS {
                sides.sought = true;
                aims.push(Aim { key, best: self.pool[at].clone(), gap, side, hot: None, done: false });
            }
        }
        aims
    }

    /// A sample of the domain that differs from this one in a word or two.
    fn beside(&self, Aim { best, hot, .. }: &Aim, stream: &mut Stream) -> Sample {
        let (count, hot) = (words(best), *hot);
        let mut sample = best.clone();
        for _ in 0..4 {
            let at = hot.filter(|_| stream.one_in(2)).unwrap_or_else(|| stream.below(count));
            let kind = scalar(best, at);
            let before = word(&sample, at);
            let known = self.values.get(at).filter(|_| stream.one_in(4));
            let value = if let Some(known) = known {
                // An end of a range, a whole number, a zero.
                known[stream.below(known.len())]
            } else if kind == Scalar::F32 {
                let x = f32::from_bits(before);
                let size = 2f64.powi(-(stream.below(26) as i32));
                ((f64::from(x) + f64::from(x).abs().max(0.1) * size * stream.between(-1.0, 1.0)) as f32).to_bits()
            } else {
                ranked(rank(before, kind) + stream.below(3) as i64 - 1, kind)
            };
            *word_mut(&mut sample, at) = value;
            if !self.domain.admits(&sample) {
                *word_mut(&mut sample, at) = before;
            } else if value != before && stream.one_in(2) {
                break;
            }
        }
        sample
    }
}
