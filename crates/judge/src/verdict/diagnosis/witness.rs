//! What the other lanes of a run give for a sample on which one deviates, and what follows from that.
//!
//! A lane is an executor behind a front end. Lanes that share both say the same thing twice: what counts is in
//! which groups the sample goes wrong, and not how many lanes there are.
//!
//! A lane speaks by its own verdict; where its API promises too little for one, by whether its word is near the
//! meaning or near the wrong word. Lanes whose front end starts from our module share our reading of the text, and
//! the report says so where it matters. The interpreter has no front end.

use std::collections::BTreeSet;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::Position;
use crate::verdict::judge::{Blame, Deviation, Verdict, real};
use base::value::Scalar;
use program::lane::{Description, LaneName, Stage};

/// What a lane says of the sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Stand {
    /// It gives what the shader means.
    Right,
    /// It deviates as well.
    Wrong,
    /// It crashed, hung, lost its device or wrote nothing.
    Failed,
    /// It gave something that is inconclusive, or could not be asked.
    Open,
}

impl Stand {
    /// All of them, as reports list them.
    pub const ALL: [Self; 4] = [Self::Wrong, Self::Failed, Self::Right, Self::Open];

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Wrong => "deviates",
            Self::Failed => "failed",
            Self::Open => "undecided",
        }
    }
}

/// A lane that was asked for the sample.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Witness {
    /// Name of the lane.
    #[serde(with = "program::lane::known")]
    pub lane: LaneName,
    /// The stage in which it ran.
    pub stage: Stage,
    /// What executes the shader.
    pub executor: String,
    /// What reads the shader.
    pub front_end: String,
    /// What it says.
    pub stand: Stand,
    /// The word that it has for the component that deviates.
    pub word: Option<u32>,
}

impl Witness {
    /// What a lane said.
    pub fn new(lane: &Description, stage: Stage, stand: Stand, word: Option<u32>) -> Self {
        let (executor, front_end) = (lane.executor.clone(), lane.front_end.clone());
        Self { lane: lane.name, stage, executor, front_end, stand, word }
    }
}

/// What a lane says of a sample on which another lane deviates: by its own verdict, and where that is inconclusive
/// (its API may promise less), by whether its word is near to what the shader means or to the wrong one.
pub fn stand(deviation: &Deviation, verdict: &Verdict, word: Option<u32>) -> Stand {
    match verdict {
        Verdict::Agree(_) => return Stand::Right,
        Verdict::Deviate(own) if own.blame == Blame::Lane => return Stand::Wrong,
        // That the shader is wrong as well says nothing about the lane.
        Verdict::Deviate(_) | Verdict::Undetermined(_) => {}
    }
    let Some((value, word)) = deviation.value().zip(word) else { return Stand::Open };
    let (found, wrong) = (real(word, value.scalar), real(value.actual, value.scalar));
    if value.scalar != Scalar::F32 {
        return match found {
            found if found == value.meaning => Stand::Right,
            found if found == wrong => Stand::Wrong,
            _ => Stand::Open,
        };
    }
    let off = (found - value.meaning).abs();
    if off <= value.bound {
        Stand::Right
    } else if word == value.actual || (found - wrong).abs() <= off || (found.is_nan() && wrong.is_nan()) {
        Stand::Wrong
    } else {
        Stand::Open
    }
}

/// All lanes that were asked, and what follows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CrossCheck {
    /// The lane that deviates, then the others.
    pub witnesses: Vec<Witness>,
    /// Whose fault it is.
    pub fault: Fault,
}

/// Whose fault a deviation is, as the lanes of a run show it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// Nothing else ran: one witness cannot tell.
    OneGroup {
        /// What executes the shader, such as a driver.
        executor: String,
        /// What translates the text for the executor.
        front_end: String,
    },
    /// One executor deviates, whatever is in front of it.
    Executor {
        /// What executes the shader, such as a driver.
        executor: String,
        /// Front ends through which it deviates.
        through: Vec<String>,
        /// Executors that are right; with none, only this one ran.
        right: Vec<String>,
    },
    /// What went through one front end deviates, whatever executes it.
    Translator {
        /// What translates the text for the executor.
        front_end: String,
        /// Executors on which it deviates.
        on: Vec<String>,
        /// Front ends that are right; with none, only this one ran.
        right: Vec<String>,
        /// True where all that are right start from the module that the meaning of the shader is taken from.
        own: bool,
    },
    /// Other lanes are right, and none of them shares the executor or the front end.
    Either {
        /// What executes the shader, such as a driver.
        executor: String,
        /// What translates the text for the executor.
        front_end: String,
    },
    /// The executor is right behind another front end, and the front end before another executor.
    Pair {
        /// What executes the shader, such as a driver.
        executor: String,
        /// What translates the text for the executor.
        front_end: String,
    },
    /// It would be so on any device.
    Shader,
    /// The same inputs are right in other places of the batch.
    Position {
        /// What executes the shader, such as a driver.
        executor: String,
        /// Front ends through which it deviates.
        through: Vec<String>,
        /// Executors that are right in the same place.
        right: Vec<String>,
        /// The place.
        position: Position,
    },
    /// Invocations of the executor disturb each other: what a sample gives depends on those that run beside it.
    Neighbours {
        /// What executes the shader, such as a driver.
        executor: String,
        /// Front ends through which it deviates.
        through: Vec<String>,
        /// Executors that are right in the same place.
        right: Vec<String>,
        /// The place.
        position: Position,
    },
    /// The lane that deviates did not when it was asked again.
    Unsteady {
        /// What executes the shader, such as a driver.
        executor: String,
        /// What translates the text for the executor.
        front_end: String,
    },
    /// Every group deviates.
    Everyone {
        /// Number of groups.
        groups: usize,
        /// True when they agree with each other.
        alike: bool,
    },
    /// Some are right and some are not, and neither executors nor front ends tell them apart.
    Mixed {
        /// Groups that deviate, as `executor through front end`.
        wrong: Vec<String>,
        /// Groups that are right.
        right: Vec<String>,
    },
}

/// Front ends that start from the same module as the meaning of the shader: they share the reading of its text. Tint
/// reads the WGSL that naga writes of it.
const OWN: [&str; 3] = ["naga", "Tint", NONE];

/// The front end of an executor that takes the module as it is.
pub const NONE: &str = "none";

impl CrossCheck {
    /// What follows from what lanes say, the first of which is the one that deviates.
    pub fn of(witnesses: Vec<Witness>) -> Self {
        let fault = Fault::of(&witnesses);
        Self { witnesses, fault }
    }

    /// The same for a deviation that depends on the place in a batch, in which all were asked: it is in the memory that
    /// the executor writes or that is read back, but where every executor behind one front end errs there.
    pub fn at(witnesses: Vec<Witness>, position: &Position) -> Self {
        let fault = match (Fault::of(&witnesses), witnesses.first()) {
            // Every place is as wrong: only the shape of the batch matters, and that is for all parts to get right.
            (fault, _) if position.many == position.count => fault,
            (Fault::Translator { front_end, on, right, own }, _) if on.len() > 1 => {
                Fault::Translator { front_end, on, right, own }
            }
            (fault @ Fault::Unsteady { .. }, _) | (fault, None) => fault,
            (_, Some(first)) => {
                let of = |own: bool, stand: Stand, part: fn(&Witness) -> &String| -> Vec<String> {
                    let here = |w: &&Witness| w.stand == stand && (w.executor == first.executor) == own;
                    let names: BTreeSet<&String> = witnesses.iter().filter(here).map(part).collect();
                    names.into_iter().cloned().collect()
                };
                let executor = first.executor.clone();
                let through = of(true, Stand::Wrong, |w| &w.front_end);
                let right = of(false, Stand::Right, |w| &w.executor);
                let position = position.clone();
                match position.disturbed {
                    true => Fault::Neighbours { executor, through, right, position },
                    false => Fault::Position { executor, through, right, position },
                }
            }
        };
        Self { witnesses, fault }
    }

    /// For what the shader's own meaning breaks, whatever runs it.
    pub fn of_the_shader() -> Self {
        Self { witnesses: Vec::new(), fault: Fault::Shader }
    }

    /// Lanes with this stand, as `lane/stage`.
    pub fn with(&self, stand: Stand) -> Vec<String> {
        self.witnesses.iter().filter(|w| w.stand == stand).map(|w| format!("{}/{}", w.lane, w.stage)).collect()
    }
}

/// Executor and front end.
type Group<'w> = (&'w str, &'w str);

impl Fault {
    /// Name in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::OneGroup { .. } => "one_group",
            Self::Executor { .. } => "executor",
            Self::Translator { .. } => "translator",
            Self::Either { .. } => "executor_or_translator",
            Self::Pair { .. } => "pair",
            Self::Shader => "shader",
            Self::Position { .. } => "position",
            Self::Neighbours { .. } => "neighbours",
            Self::Unsteady { .. } => "unsteady",
            Self::Everyone { .. } => "meaning",
            Self::Mixed { .. } => "mixed",
        }
    }

    fn of(witnesses: &[Witness]) -> Self {
        let Some(first) = witnesses.first() else {
            return Self::OneGroup { executor: String::new(), front_end: String::new() };
        };
        let reported = by_stage(witnesses, first.stage);
        if first.stand == Stand::Right {
            let (executor, front_end) = (first.executor.clone(), first.front_end.clone());
            return Self::Unsteady { executor, front_end };
        }
        let groups = |stand: Stand| -> BTreeSet<Group<'_>> {
            reported.iter().filter(|w| w.stand == stand).map(|w| (w.executor.as_str(), w.front_end.as_str())).collect()
        };
        let mut wrong = groups(Stand::Wrong);
        // A lane that failed is evidence against what it shares with the one that deviates.
        wrong.extend(groups(Stand::Failed).into_iter().filter(|group| group.0 == first.executor));
        // A group with two answers has one that is wrong.
        let right: BTreeSet<Group<'_>> = groups(Stand::Right).difference(&wrong).copied().collect();
        let (executor, front_end) = (first.executor.clone(), first.front_end.clone());
        let (executors, right_executors) = (part(&wrong, |g| g.0), part(&right, |g| g.0));
        let (fronts, right_fronts) = (part(&wrong, |g| g.1), part(&right, |g| g.1));
        let owned = |set: &BTreeSet<&str>| set.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        let on_executor =
            || Self::Executor { executor: executor.clone(), through: owned(&fronts), right: owned(&right_executors) };
        let on_translator = || Self::Translator {
            front_end: front_end.clone(),
            on: owned(&executors),
            own: !right_fronts.is_empty() && right_fronts.iter().all(|front| OWN.contains(front)),
            right: owned(&right_fronts),
        };
        if right.is_empty() {
            return match (executors.len(), fronts.len()) {
                (0 | 1, 0 | 1) => Self::OneGroup { executor, front_end },
                (1, _) => on_executor(),
                (_, 1) => on_translator(),
                _ => Self::Everyone { groups: wrong.len(), alike: alike(&reported) },
            };
        }
        let executors_part = executors.is_disjoint(&right_executors);
        let fronts_part = fronts.is_disjoint(&right_fronts);
        let mixed = || {
            let names = |groups: &BTreeSet<Group<'_>>| groups.iter().map(|(e, f)| format!("{e} through {f}")).collect();
            Self::Mixed { wrong: names(&wrong), right: names(&right) }
        };
        match (executors.len(), fronts.len()) {
            (1, 1) => match (executors_part, fronts_part) {
                (true, false) => on_executor(),
                (false, true) => on_translator(),
                (true, true) => Self::Either { executor, front_end },
                (false, false) => Self::Pair { executor, front_end },
            },
            (1, _) if executors_part => on_executor(),
            (_, 1) if fronts_part => on_translator(),
            _ => mixed(),
        }
    }
}

/// Of each lane what it says in the stage of the finding, or in any where it has no such stage.
fn by_stage(witnesses: &[Witness], stage: Stage) -> Vec<&Witness> {
    let here = |lane: LaneName| witnesses.iter().any(|w| w.lane == lane && w.stage == stage && w.stand != Stand::Open);
    witnesses.iter().filter(|w| w.stand != Stand::Open && (w.stage == stage || !here(w.lane))).collect()
}

fn part<'w>(groups: &BTreeSet<Group<'w>>, of: impl Fn(&Group<'w>) -> &'w str) -> BTreeSet<&'w str> {
    groups.iter().map(of).collect()
}

/// True when all that deviate have the same word, or none has one.
fn alike(reported: &[&Witness]) -> bool {
    let mut words = reported.iter().filter(|w| w.stand == Stand::Wrong).map(|w| w.word);
    let first = words.next();
    words.all(|word| Some(word) == first)
}

/// `a`, `b` and `c`.
fn listed(names: &[String]) -> String {
    let ticked: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match &ticked[..] {
        [] => String::new(),
        [one] => one.clone(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

fn are(names: &[String]) -> &'static str {
    if names.len() == 1 { "is" } else { "are" }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OneGroup { executor, front_end } => write!(
                f,
                "`{executor}` or `{front_end}`, or our bound: all that ran is this one executor behind this one front \
                 end, and one witness cannot tell them apart"
            ),
            Self::Executor { executor, through, right } => {
                write!(f, "the executor `{executor}`: it deviates behind {}", listed(through))?;
                match &right[..] {
                    [] => f.write_str("; no other executor ran, so that our own meaning or bound is not ruled out"),
                    right => write!(f, ", and {} {} right", listed(right), are(right)),
                }
            }
            Self::Translator { front_end, on, right, own } => {
                write!(f, "the translator `{front_end}`: what went through it deviates on {}", listed(on))?;
                match &right[..] {
                    [] => f.write_str("; no other front end ran, so that our own meaning or bound is not ruled out"),
                    right if *own => write!(
                        f,
                        ", and what went through {} is right; or our own reading of the text, which these share",
                        listed(right)
                    ),
                    right => write!(f, ", and what went through {} is right", listed(right)),
                }
            }
            Self::Either { executor, front_end } => write!(
                f,
                "the executor `{executor}` or the translator `{front_end}`: the lanes that are right share neither, so \
                 that they cannot be told apart"
            ),
            Self::Pair { executor, front_end } => write!(
                f,
                "the executor `{executor}` with what `{front_end}` makes of the shader: each is right with others"
            ),
            Self::Shader => f.write_str("the shader: it would be so on any device"),
            Self::Position { executor, through, right, position } => {
                write!(
                    f,
                    "the memory or the readback of the executor `{executor}`, behind {}: it depends on the position and \
                     not on the inputs: {position}",
                    listed(through)
                )?;
                match &right[..] {
                    [] => Ok(()),
                    right => write!(f, "; {} {} right there", listed(right), are(right)),
                }
            }
            Self::Neighbours { executor, through, right, position } => {
                write!(
                    f,
                    "the executor `{executor}`, behind {}: its invocations disturb each other, since what one gives depends on \
                     the inputs of those beside it: {position}",
                    listed(through)
                )?;
                match &right[..] {
                    [] => Ok(()),
                    right => write!(f, "; {} {} right there", listed(right), are(right)),
                }
            }
            Self::Unsteady { executor, front_end } => write!(
                f,
                "the lane itself, `{executor}` behind `{front_end}`: asked again for the same inputs in the same place, it \
                 did not deviate"
            ),
            Self::Everyone { groups, alike: true } => write!(
                f,
                "no single lane: {groups} groups of executor and front end agree with each other, and not with what the \
                 shader means; our own meaning or bound is suspect, or the shader leans on unspecified behaviour"
            ),
            Self::Everyone { groups, alike: false } => write!(
                f,
                "no single lane: all {groups} groups of executor and front end deviate, and not alike; the shader leans on \
                 unspecified behaviour, or our bound is too narrow"
            ),
            Self::Mixed { wrong, right } => {
                write!(f, "no single part: {} deviate, {} {} right", listed(wrong), listed(right), are(right))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lanes as `executor/front end`, `!` before those that deviate and `?` before those that are inconclusive.
    fn fault(lanes: &[&str]) -> String {
        Fault::of(&witnesses(lanes)).to_string()
    }

    fn witnesses(lanes: &[&str]) -> Vec<Witness> {
        let one = |(k, lane): (usize, &&str)| {
            let (stand, name) = match lane.split_at(1) {
                ("!", name) => (Stand::Wrong, name),
                ("?", name) => (Stand::Open, name),
                _ => (Stand::Right, *lane),
            };
            let (executor, front_end) = name.split_once('/').unwrap();
            let (executor, front_end) = (executor.to_owned(), front_end.to_owned());
            let lane = program::lane::interned(&format!("lane-{k}"));
            Witness { lane, stage: Stage::Compute, executor, front_end, stand, word: Some(7) }
        };
        lanes.iter().enumerate().map(one).collect()
    }

    #[test]
    fn an_executor_that_is_wrong_behind_two_front_ends_is_to_blame() {
        assert_eq!(
            fault(&["!X/naga", "!X/glslang", "Y/naga"]),
            "the executor `X`: it deviates behind `glslang` and `naga`, and `Y` is right"
        );
        assert_eq!(fault(&["!X/naga", "Y/naga"]), "the executor `X`: it deviates behind `naga`, and `Y` is right");
        assert!(
            fault(&["!X/naga", "!X/Mesa"])
                .ends_with("no other executor ran, so that our own meaning or bound is not ruled out")
        );
    }

    #[test]
    fn a_front_end_that_is_wrong_on_two_executors_is_to_blame() {
        assert_eq!(
            fault(&["!X/Mesa", "!Y/Mesa", "X/naga"]),
            "the translator `Mesa`: what went through it deviates on `X` and `Y`, and what went through `naga` is \
             right; or our own reading of the text, which these share"
        );
        assert_eq!(
            fault(&["!X/naga", "X/glslang"]),
            "the translator `naga`: what went through it deviates on `X`, and what went through `glslang` is right"
        );
    }

    #[test]
    fn lanes_of_one_group_are_one_witness() {
        let one = fault(&["!X/naga"]);
        assert!(one.ends_with("one witness cannot tell them apart"), "{one}");
        assert_eq!(fault(&["!X/naga", "!X/naga", "!X/naga"]), one);
        // Three lanes that are right in one group do not outweigh two groups that are not.
        assert!(fault(&["!X/naga", "!X/glslang", "Y/naga", "Y/naga", "Y/naga"]).starts_with("the executor `X`"));
        // What is inconclusive is no witness.
        assert_eq!(fault(&["!X/naga", "?Y/naga", "?X/Mesa"]), one);
    }

    #[test]
    fn what_lanes_cannot_tell_apart_is_said() {
        assert!(fault(&["!X/naga", "Y/Mesa"]).starts_with("the executor `X` or the translator `naga`: "));
        assert!(fault(&["!X/naga", "X/Mesa", "Y/naga"]).starts_with("the executor `X` with what `naga` makes"));
        let mixed = fault(&["!X/naga", "!Y/Mesa", "X/Mesa", "Y/naga"]);
        assert_eq!(
            mixed,
            "no single part: `X through naga` and `Y through Mesa` deviate, `X through Mesa` and `Y through naga` are right"
        );
    }

    #[test]
    fn when_all_deviate_our_own_side_is_suspect() {
        let all = ["!X/naga", "!Y/Mesa", "!X/Mesa"];
        assert!(fault(&all).contains("3 groups of executor and front end agree with each other"), "{}", fault(&all));
        let mut apart = witnesses(&all);
        apart[1].word = Some(8);
        assert!(Fault::of(&apart).to_string().contains("deviate, and not alike"));
    }

    #[test]
    fn the_stage_of_the_finding_counts_where_a_lane_has_it() {
        let mut all = witnesses(&["!X/naga", "!Y/naga", "Y/naga"]);
        (all[1].lane, all[1].stage) = (all[2].lane, Stage::Vertex);
        assert_eq!(Fault::of(&all).name(), "executor", "in the stage of the finding Y is right");
        all[0].stage = Stage::Vertex;
        assert_eq!(Fault::of(&all).name(), "translator", "and here it is not");
    }
}
