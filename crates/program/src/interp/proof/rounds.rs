//! Loops: those with few known rounds one by one, and the others for any round at once.
//!
//! For any round, what changes by the same number each time is its first value and so many times that number. Of
//! anything else, nothing is known but whether it is the same for all invocations of a workgroup, or that it only
//! becomes smaller.

use std::collections::BTreeSet;

use number::linear::{Constraint, Polynomial, Unknown};

use super::super::code::{Inst, Reg};
use super::super::domain::Site;
use super::formula::Formula;
use super::values::Value;
use super::variables::{Fact, HALF, Interval, Meaning, Scope, WORD, Why};
use super::walk::{Kind, State, Walk, dead, words_written};

/// Rounds of a loop that are gone through one by one.
const MOST_ROUNDS: u32 = 40;

/// Instructions of a loop that is gone through so, at most: beyond these, it is taken for any of its rounds at once.
const MOST_STEPS: usize = 6_000;

/// Times that a loop is gone through to see what of it is the same for a workgroup.
const MOST_TRIES: usize = 5;

/// Loops inside of each other that are followed.
const MOST_NESTED: usize = 6;

/// A variable at the beginning of a round.
struct Head {
    reg: Reg,
    first: Polynomial,
    /// What stands for it while one round is gone through.
    any: Unknown,
    uniform: bool,
}

/// Between which numbers a variable stays, as is seen of one round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Range {
    /// From 0 on, and below 2^31.
    Positive,
    /// What 32 bits hold with a sign.
    Signed,
    /// Any 32 bits.
    Any,
}

impl Range {
    fn interval(self) -> Interval {
        match self {
            Self::Positive => (Some(0), Some(HALF - 1)),
            Self::Signed => (Some(-HALF), Some(HALF - 1)),
            Self::Any => (Some(-HALF), Some(WORD - 1)),
        }
    }
}

/// What one round does to a variable.
enum Change {
    /// It grows by this.
    By(Polynomial),
    /// It is never larger than at first, and not negative.
    Shrinks,
    Unknown,
}

impl<'e> Walk<'e> {
    pub(super) fn repeat(&mut self, body: &'e [Inst], continuing: &'e [Inst], break_if: Option<Reg>, site: Site) {
        if self.frames.iter().filter(|frame| frame.kind == Kind::Loop).count() >= MOST_NESTED {
            self.exhausted = true;
            return;
        }
        let entry = self.state.clone();
        let (noted, barriers) = (self.accesses.len(), self.barriers.len());
        if self.one_by_one(body, continuing, break_if) {
            return;
        }
        self.state = entry;
        self.accesses.truncate(noted);
        self.barriers.truncate(barriers);
        self.any_round(body, continuing, break_if, site);
    }

    /// Goes through a round up to its end. Gives whether the condition at its end is known, and what it is.
    fn round(&mut self, body: &'e [Inst], continuing: &'e [Inst], break_if: Option<Reg>, scope: Scope) -> Formula {
        self.block(body);
        let mut all = self.frames.last_mut().map(|frame| std::mem::take(&mut frame.next)).unwrap_or_default();
        all.push(std::mem::replace(&mut self.state, dead()));
        self.state = self.joined(all, scope);
        self.block(continuing);
        match break_if.filter(|_| self.state.alive) {
            Some(reg) => self.truth(reg),
            None => Formula::Known(false),
        }
    }

    /// Tries to go through all rounds. False where something that is not known decides how many there are.
    fn one_by_one(&mut self, body: &'e [Inst], continuing: &'e [Inst], break_if: Option<Reg>) -> bool {
        let depth = self.frames.len();
        let mut frame = self.frame(Kind::Loop);
        frame.unrolled = true;
        self.frames.push(frame);
        let (mut ended, before) = (false, self.steps);
        for k in 0..=MOST_ROUNDS {
            self.unrolled.push(k);
            let leaves = self.round(body, continuing, break_if, Scope::Invocation);
            self.unrolled.pop();
            if self.undecided || self.exhausted || self.steps - before > MOST_STEPS {
                break;
            }
            let left = self.frames.last().is_some_and(|frame| !frame.left.is_empty());
            match leaves {
                Formula::Known(true) => {
                    ended = true;
                    break;
                }
                Formula::Known(false) if !self.state.alive => {
                    ended = true;
                    break;
                }
                Formula::Known(false) if !left => {}
                _ => break,
            }
        }
        self.undecided = false;
        let frame = self.frames.drain(depth..).next();
        if !ended {
            return self.exhausted;
        }
        let mut all = frame.map(|frame| frame.left).unwrap_or_default();
        all.push(std::mem::replace(&mut self.state, dead()));
        self.state = self.joined(all, Scope::Group);
        true
    }

    fn any_round(&mut self, body: &'e [Inst], continuing: &'e [Inst], break_if: Option<Reg>, site: Site) {
        let entry = self.state.clone();
        let round = self.variables.fresh(Meaning::Round, Scope::Group, (Some(0), Some(WORD)));
        self.variables.get_mut(round).rounds.insert(round);
        let mut changed: Vec<Reg> = Vec::new();
        written(body, &mut changed);
        written(continuing, &mut changed);
        changed.sort_unstable();
        changed.dedup();
        changed.retain(|reg| entry.env.contains_key(reg));
        let firsts: Vec<(Reg, Polynomial)> = changed.into_iter().map(|reg| (reg, self.number(reg))).collect();
        let entry = self.state.clone();
        let mut uniform: BTreeSet<Reg> = firsts.iter().map(|(reg, _)| *reg).collect();
        uniform.retain(|reg| {
            firsts.iter().any(|(own, first)| own == reg && self.variables.scope(first) != Scope::Invocation)
        });
        let mut ranges: Vec<Range> = firsts.iter().map(|(_, first)| self.range(first)).collect();
        let (mut varied, mut changes, mut end_phases) = (false, Vec::new(), None);
        for k in 0..=MOST_TRIES {
            if k == MOST_TRIES {
                uniform.clear();
                ranges.fill(Range::Any);
            }
            let before = (uniform.clone(), ranges.clone(), varied);
            let all = firsts.iter().zip(&ranges);
            let heads: Vec<Head> = all
                .map(|((reg, first), range)| self.head(*reg, first, uniform.contains(reg), *range, (round, site)))
                .collect();
            let last = self.variables.count();
            self.state = entry.clone();
            heads.iter().for_each(|head| self.set(head.reg, Value::Number(Polynomial::unknown(head.any))));
            self.variables.get_mut(round).scope = if varied { Scope::Invocation } else { Scope::Group };
            self.silent += 1;
            let (end, left_varied) = self.pass(body, continuing, break_if, (round, varied));
            self.silent -= 1;
            if self.exhausted || self.undecided {
                return;
            }
            varied |= left_varied;
            if varied {
                uniform.clear();
            }
            end_phases = end.alive.then(|| end.phases.clone());
            let behind = std::mem::replace(&mut self.state, end.clone());
            changes = (heads.iter().zip(&mut ranges))
                .map(|(head, range)| self.change(head, &end, last, (&mut uniform, range)))
                .collect();
            self.state = behind;
            if (uniform.clone(), ranges.clone(), varied) == before {
                break;
            }
        }
        // Now for any round, by what is known of the variables at its beginning.
        self.variables.get_mut(round).scope = if varied { Scope::Invocation } else { Scope::Group };
        let repeats = end_phases.is_some();
        self.state = entry.clone();
        let rounds = Polynomial::unknown(round);
        for (((reg, first), change), range) in firsts.iter().zip(&changes).zip(&ranges) {
            let grown = match change {
                Change::By(step) => step.product(&rounds).map(|all| first.plus(&all)),
                Change::Shrinks | Change::Unknown => None,
            };
            let value = match (grown, repeats) {
                (_, false) => first.clone(),
                (Some(value), _) => value,
                (None, _) => {
                    let head = self.head(*reg, first, uniform.contains(reg) && !varied, *range, (round, site));
                    if matches!(change, Change::Shrinks) {
                        let x = Polynomial::unknown(head.any);
                        let own = self.variables.get_mut(head.any);
                        own.low = Some(0);
                        own.wide = false;
                        own.facts.push(Fact::Is(Constraint::at_most(&x, first)));
                    }
                    Polynomial::unknown(head.any)
                }
            };
            self.set(*reg, Value::Number(value));
        }
        if !repeats {
            self.variables.get_mut(round).high = Some(0);
        }
        self.state.phases = entry.phases.head(end_phases.as_ref(), round);
        let frame_at = self.frames.len();
        let _ = self.pass(body, continuing, break_if, (round, varied));
        debug_assert_eq!(frame_at, self.frames.len(), "a loop leaves as many frames as there were");
    }

    /// Goes through one round of the loop, and leaves it. Gives the end of the round, and whether some invocations may
    /// leave where others do not.
    fn pass(
        &mut self,
        body: &'e [Inst],
        continuing: &'e [Inst],
        break_if: Option<Reg>,
        (round, varied): (Unknown, bool),
    ) -> (State, bool) {
        let mut frame = self.frame(Kind::Loop);
        frame.varied = varied;
        self.frames.push(frame);
        self.rounds.push(round);
        self.open += 1;
        let leaves = self.round(body, continuing, break_if, Scope::Invocation);
        self.open -= 1;
        self.rounds.pop();
        let Some(mut frame) = self.frames.pop() else { return (dead(), varied) };
        frame.varied |= leaves.scope(&self.variables) == Scope::Invocation;
        let mut end = std::mem::replace(&mut self.state, dead());
        if !matches!(leaves, Formula::Known(false)) && end.alive {
            self.state = end.clone();
            self.assume(&leaves, true);
            frame.left.push(std::mem::replace(&mut self.state, end));
            self.assume(&leaves, false);
            end = std::mem::replace(&mut self.state, dead());
        }
        self.state = self.joined(frame.left, if frame.varied { Scope::Invocation } else { Scope::Group });
        self.state.phases = self.state.phases.without(round);
        (end, frame.varied)
    }

    /// Between which numbers a variable may stay, by its first value.
    fn range(&self, first: &Polynomial) -> Range {
        if first.unknowns().any(|unknown| self.variables.get(unknown).wide) {
            return Range::Any;
        }
        let positive = self.variables.interval(first).0.is_some_and(|low| low >= 0);
        if positive { Range::Positive } else { Range::Signed }
    }

    fn head(
        &mut self,
        reg: Reg,
        first: &Polynomial,
        uniform: bool,
        range: Range,
        (round, site): (Unknown, Site),
    ) -> Head {
        let scope = if uniform { Scope::Group } else { Scope::Invocation };
        let any = self.variables.fresh(Meaning::Open(Why::Loop, Some(site)), scope, range.interval());
        self.variables.get_mut(any).rounds.insert(round);
        Head { reg, first: first.clone(), any, uniform }
    }

    /// What a round does to a variable. Leaves it out of those that are the same for a workgroup where it is not.
    fn change(
        &mut self,
        head: &Head,
        end: &State,
        last: Unknown,
        (uniform, range): (&mut BTreeSet<Reg>, &mut Range),
    ) -> Change {
        if !end.alive {
            return Change::Unknown;
        }
        let Some(value) = end.env.get(&head.reg).cloned() else {
            uniform.remove(&head.reg);
            *range = Range::Any;
            return Change::Unknown;
        };
        let value = self.number_of(&value);
        if self.variables.scope(&value) == Scope::Invocation || !head.uniform {
            uniform.remove(&head.reg);
        }
        let by = value.minus(&Polynomial::unknown(head.any));
        // Made before the round: the same in all of them.
        let rounds = self.variables.get(head.any).rounds.clone();
        let old = |unknown: Unknown| unknown < last && self.variables.get(unknown).rounds.is_disjoint(&rounds);
        let steady = by.unknowns().all(old);
        // What was taken for granted of its range has to hold behind the round as well.
        if *range == Range::Positive && !self.is_at_least(&value, 0) {
            *range = Range::Signed;
        }
        if steady {
            return Change::By(by);
        }
        let (low, high) = self.variables.interval(&value);
        if high.is_none_or(|high| high >= HALF) || low.is_none_or(|low| low < -HALF) {
            *range = Range::Any;
        }
        let any = Polynomial::unknown(head.any);
        let mut parts = value.unknowns();
        let one = parts.next().filter(|_| value.terms().count() == 1 && parts.next().is_none());
        let halves = one.is_some_and(|unknown| {
            value == Polynomial::unknown(unknown)
                && self.variables.interval(&head.first).0.is_some_and(|low| low >= 0)
                && self.is_quotient_of(unknown, &any)
        });
        if halves { Change::Shrinks } else { Change::Unknown }
    }

    /// True where an unknown is the quotient of a number, or of what stands for it without a sign, by a constant.
    fn is_quotient_of(&self, unknown: Unknown, of: &Polynomial) -> bool {
        let own = self.variables.get(unknown);
        let [Fact::Is(rest), Fact::Is(_)] = own.facts.as_slice() else { return false };
        // `0 <= of - by * unknown`
        let by = -rest.of.coefficient(&[unknown]);
        if by < 2 {
            return false;
        }
        let whole = rest.of.plus_times(&Polynomial::unknown(unknown), by);
        let left = whole.minus(of);
        left.terms().all(|(product, count)| product.len() == 1 && count.abs() == WORD)
    }
}

/// The word registers that a block writes.
fn written(block: &[Inst], found: &mut Vec<Reg>) {
    super::super::shape::each(block, &mut |inst| found.extend(words_written(inst)));
}
