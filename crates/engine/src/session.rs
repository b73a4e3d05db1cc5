//! A run: the units of a job one after the other, as a whole or as one shard of it, until they are done or a signal ends
//! the process. A run is its parts, joined, for every job.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::shard::Shard;
use lanes::interrupt;

/// Why two parts are not of one run.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{0}")]
pub struct Unlike(pub String);

impl Unlike {
    /// For shards that differ in what they ran on, or what they ran.
    ///
    /// # Errors
    /// When the two are not the same.
    pub fn unless(same: bool, how: &str) -> Result<(), Self> {
        if same { Ok(()) } else { Err(Self(format!("the shards {how}"))) }
    }
}

/// What a part of a run found. Joining is associative, and its order does not matter.
pub trait Join: Serialize + DeserializeOwned {
    /// Adds what another part found.
    ///
    /// # Errors
    /// When the two are not of one run after all.
    fn join(&mut self, other: Self) -> Result<(), Unlike>;
}

/// Work that is done unit by unit: a suite, a function, a program.
pub trait Job: Sized {
    /// What is done without a break between two looks at the signals.
    type Unit;
    /// What came of units.
    type Part;
    /// What ends the run before its time.
    type Error;
    /// What a watcher is told besides.
    type Event<'e>;

    /// Whether every shard does its share inside of each unit, which the job knows. Otherwise unit `k` is done by shard
    /// `k` modulo their number.
    const SHARED_WITHIN: bool = false;

    /// The unit of a number, counted from 0; `None` behind the last. Asked for one after the other, also for the units of
    /// other shards and for those that are done: what is wrong with one of them is told by all.
    ///
    /// # Errors
    /// What ends the run.
    fn unit(&mut self, number: u64, at: &mut At<'_, Self>) -> Result<Option<Self::Unit>, Self::Error>;

    /// Does a unit, given with its number, and adds what came of it. Returns early when the process is interrupted: a whole
    /// run keeps what was found until then, a shard forgets it.
    ///
    /// # Errors
    /// What ends the run.
    fn run(&mut self, unit: (u64, Self::Unit), at: &mut At<'_, Self>) -> Result<(), Self::Error>;
}

/// Where a run is, as its job sees it.
pub struct At<'o, J: Job> {
    /// What was found, and what a unit under way needs to go on.
    pub part: J::Part,
    /// Who watches.
    pub observer: &'o mut dyn Observer<J>,
    done: u64,
}

impl<J: Job> At<'_, J> {
    /// Tells that the run can go on from here.
    ///
    /// # Errors
    /// What the observer ends the run with.
    pub fn checkpoint(&mut self) -> Result<(), J::Error> {
        self.observer.checkpoint(self.done, &self.part)
    }
}

/// Who watches a run, and may end it.
pub trait Observer<J: Job> {
    /// Something happened.
    ///
    /// # Errors
    /// What ends the run.
    fn event(&mut self, _: J::Event<'_>) -> Result<(), J::Error> {
        Ok(())
    }

    /// So many steps of the unit are done.
    fn progress(&mut self, _: u64) {}

    /// The run can go on from here, with so many units done.
    ///
    /// # Errors
    /// What ends the run.
    fn checkpoint(&mut self, _: u64, _: &J::Part) -> Result<(), J::Error> {
        Ok(())
    }

    /// A unit ended, also one that was cut short in a whole run.
    ///
    /// # Errors
    /// What ends the run.
    fn end(&mut self, _: &J::Part) -> Result<(), J::Error> {
        Ok(())
    }
}

/// What is seen of jobs that have nothing else to show.
#[derive(Clone, Copy, Debug)]
pub enum Seen<'e> {
    /// A unit begins, or its steps are known.
    Begun {
        /// The unit.
        what: &'e str,
        /// Where it runs.
        on: &'e str,
        /// Its steps; 0 while they are not known.
        steps: u64,
    },
    /// Something is said beside the report, in whole lines.
    Said(&'e str),
}

/// How far a run is.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Reached<P> {
    /// Units that are done, of those that are this shard's.
    pub done: u64,
    /// What they found, and what a unit under way needs to go on.
    pub part: P,
}

impl<P> Reached<P> {
    /// The beginning of a run that has found nothing yet.
    pub fn nothing(part: P) -> Self {
        Self { done: 0, part }
    }
}

/// Runs a job from where it got to, whole or one shard of it. `None` for a shard that a signal ended: it goes on from its
/// last checkpoint. A whole run then gives what was found.
///
/// # Errors
/// What the job or the observer ends the run with.
pub fn run<J: Job>(
    job: &mut J,
    shard: Option<Shard>,
    Reached { done, part }: Reached<J::Part>,
    observer: &mut dyn Observer<J>,
) -> Result<Option<J::Part>, J::Error> {
    let mine = |unit: u64| J::SHARED_WITHIN || shard.is_none_or(|shard| unit % shard.count() == shard.index());
    let mut at = At { part, observer, done };
    let mut own = 0;
    for number in 0.. {
        let Some(unit) = job.unit(number, &mut at)? else { break };
        own += u64::from(mine(number));
        if !mine(number) || own <= at.done {
            continue;
        }
        job.run((number, unit), &mut at)?;
        match (interrupt::asked(), shard) {
            (true, Some(_)) => return Ok(None),
            (true, None) => {
                at.observer.end(&at.part)?;
                break;
            }
            (false, _) => {
                at.done = own;
                at.observer.end(&at.part)?;
                at.checkpoint()?;
            }
        }
    }
    Ok(Some(at.part))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares of numbers; one of which may be wrong.
    #[derive(Default)]
    struct Squares {
        wrong: Option<u64>,
        /// Units that ran.
        ran: u64,
    }

    impl Job for Squares {
        type Unit = u64;
        type Part = Vec<(u64, u64)>;
        type Error = String;
        type Event<'e> = ();

        fn unit(&mut self, number: u64, _: &mut At<'_, Self>) -> Result<Option<u64>, String> {
            if self.wrong == Some(number) { Err("wrong".to_owned()) } else { Ok(Some(number + 1).filter(|k| *k <= 10)) }
        }

        fn run(&mut self, (number, unit): (u64, u64), at: &mut At<'_, Self>) -> Result<(), String> {
            self.ran += 1;
            at.part.push((number, unit * unit));
            Ok(())
        }
    }

    /// Keeps every checkpoint.
    #[derive(Default)]
    struct Kept(Vec<Reached<Vec<(u64, u64)>>>);

    impl Observer<Squares> for Kept {
        fn checkpoint(&mut self, done: u64, part: &Vec<(u64, u64)>) -> Result<(), String> {
            self.0.push(Reached { done, part: part.clone() });
            Ok(())
        }
    }

    #[test]
    fn shards_do_each_unit_once_and_go_on_from_every_checkpoint() {
        for count in [1, 2, 3, 7, 16] {
            let mut all = Vec::new();
            for index in 0..count {
                let (shard, mut kept) = (Some(Shard::new(index, count).unwrap()), Kept::default());
                let found = run(&mut Squares::default(), shard, Reached::default(), &mut kept).unwrap().unwrap();
                for reached in kept.0 {
                    let (mut job, left) = (Squares::default(), found.len() as u64 - reached.done);
                    let again = run(&mut job, shard, reached, &mut Kept::default()).unwrap();
                    assert_eq!((again.as_ref(), job.ran), (Some(&found), left), "{index}/{count}");
                }
                all.extend(found);
            }
            all.sort_unstable();
            let whole = run(&mut Squares::default(), None, Reached::default(), &mut Kept::default());
            assert_eq!(whole.unwrap(), Some(all), "{count} shards");
        }
    }

    #[test]
    fn what_is_wrong_with_one_unit_ends_every_shard() {
        for index in 0..3 {
            let (mut job, shard) = (Squares { wrong: Some(7), ran: 0 }, Shard::new(index, 3).ok());
            let ended = run(&mut job, shard, Reached::default(), &mut Kept::default());
            assert_eq!(ended, Err("wrong".to_owned()), "{index}");
        }
    }
}
