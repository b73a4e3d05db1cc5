//! Branches out of a loop from inside of a switch, which SPIR-V has and naga's reader takes for the end of the switch.
//!
//! `slangc` puts the body of each loop into a switch without cases, whose end is where `continue` goes. Where nothing else
//! goes there, the switch does nothing and is taken away, so that what leaves the loop leaves a loop.

use std::collections::{HashMap, HashSet};

use base::text::Span;

use crate::capabilities::instructions;

const FUNCTION_END: u32 = 56;
const LOOP_MERGE: u32 = 246;
const SELECTION_MERGE: u32 = 247;
const LABEL: u32 = 248;
const BRANCH: u32 = 249;
const BRANCH_CONDITIONAL: u32 = 250;
const SWITCH: u32 = 251;

/// Words in front of the instructions.
const HEADER: usize = 5;

fn code(instruction: &[u32]) -> u32 {
    instruction[0] & 0xffff
}

/// The labels to which an instruction branches. Literals of a switch may be among them.
fn targets(instruction: &[u32]) -> &[u32] {
    let from = match code(instruction) {
        BRANCH => 1..2,
        BRANCH_CONDITIONAL => 2..4,
        SWITCH => 2..instruction.len(),
        _ => 0..0,
    };
    instruction.get(from).unwrap_or_default()
}

/// The module without switches that do nothing, with the places of the instructions that are left.
///
/// # Errors
/// The number of a switch out of which a loop is left.
pub fn taken_away(words: &[u32], places: &[Span]) -> Result<(Vec<u32>, Vec<Span>), usize> {
    let all: Vec<&[u32]> = instructions(words).collect();
    let mut uses: HashMap<u32, usize> = HashMap::new();
    all.iter().flat_map(|i| targets(i)).for_each(|label| *uses.entry(*label).or_default() += 1);
    let mut dropped = HashSet::new();
    let mut ends: HashSet<u32> = HashSet::new();
    for (at, pair) in all.windows(2).enumerate() {
        match code(pair[0]) {
            FUNCTION_END => ends.clear(),
            LOOP_MERGE => ends.extend(pair[0].get(1)),
            _ => {}
        }
        let (SELECTION_MERGE, SWITCH, Some(merge)) = (code(pair[0]), code(pair[1]), pair[0].get(1)) else { continue };
        if pair[1].len() == 3 && uses.get(merge) == Some(&1) && pair[1][2] != *merge {
            dropped.insert(at);
            continue;
        }
        let is_end = |i: &&&[u32]| code(i) == LABEL && i.get(1) == Some(merge);
        let inside = all[at + 2..].iter().take_while(|i| !is_end(i) && code(i) != FUNCTION_END);
        // A switch that ends its loop goes to one label with both.
        if inside.flat_map(|i| targets(i)).any(|label| label != merge && ends.contains(label)) {
            return Err(at + 1);
        }
    }
    let mut out = words.get(..HEADER).unwrap_or(words).to_vec();
    let mut left = Vec::new();
    for (at, instruction) in all.iter().enumerate().filter(|(at, _)| !dropped.contains(at)) {
        match at.checked_sub(1).is_some_and(|before| dropped.contains(&before)) {
            true => out.extend([2 << 16 | BRANCH, instruction[2]]),
            false => out.extend_from_slice(instruction),
        }
        left.extend(places.get(at));
    }
    Ok((out, left))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn module(instructions: &[&[u32]]) -> Vec<u32> {
        let mut words = vec![0x0723_0203, 0x0001_0300, 0, 99, 0];
        for i in instructions {
            words.push((u32::try_from(i.len()).unwrap() << 16) | i[0]);
            words.extend(&i[1..]);
        }
        words
    }

    /// The body of a loop whose merge is 20: a switch to 11 with the merge 12, out of which 11 branches as told.
    fn looped(inside: &[&[u32]]) -> Vec<u32> {
        let mut all: Vec<&[u32]> = vec![&[LABEL, 10], &[LOOP_MERGE, 20, 13, 0], &[BRANCH, 14], &[LABEL, 14]];
        all.extend::<[&[u32]; 3]>([&[SELECTION_MERGE, 12, 0], &[SWITCH, 5, 11], &[LABEL, 11]]);
        all.extend_from_slice(inside);
        all.extend::<[&[u32]; 4]>([&[LABEL, 12], &[BRANCH, 13], &[LABEL, 20], &[FUNCTION_END]]);
        module(&all)
    }

    #[test]
    fn a_switch_that_does_nothing_is_taken_away() {
        let words = looped(&[&[BRANCH_CONDITIONAL, 6, 15, 20], &[LABEL, 15], &[BRANCH, 12]]);
        let places = vec![Span::at(1); instructions(&words).count()];
        let (out, left) = taken_away(&words, &places).unwrap();
        assert!(instructions(&out).all(|i| ![SWITCH, SELECTION_MERGE].contains(&code(i))));
        assert_eq!(left.len(), instructions(&out).count());
        assert!(instructions(&out).any(|i| i == [2 << 16 | BRANCH, 11]));
    }

    #[test]
    fn a_loop_that_is_left_out_of_another_switch_is_refused() {
        let twice = looped(&[
            &[BRANCH_CONDITIONAL, 6, 15, 20],
            &[LABEL, 15],
            &[BRANCH_CONDITIONAL, 7, 12, 16],
            &[LABEL, 16],
            &[BRANCH, 12],
        ]);
        assert_eq!(taken_away(&twice, &[]), Err(5));
    }

    #[test]
    fn other_switches_stay() {
        let words = looped(&[&[BRANCH_CONDITIONAL, 6, 12, 16], &[LABEL, 16], &[BRANCH, 12]]);
        assert_eq!(taken_away(&words, &[]).unwrap().0, words);
    }
}
