//! Registers of HLSL, which are counted by kind: `t0` and `s0` are two resources. A compiler that keeps the numbers gives
//! both one binding, which no module may have.

use std::collections::{HashMap, HashSet};

use crate::capabilities::{HEADER, instructions};

/// `OpDecorate` with one word behind the decoration.
const DECORATE: u32 = 4 << 16 | 71;
/// Decorations (SPIR-V 1.6, 3.20).
const BINDING: u32 = 33;
const SET: u32 = 34;

/// The module with a binding of its own for each resource. The first of those that share one keeps it, and the others get
/// numbers that are free in their set.
pub(super) fn apart(mut words: Vec<u32>) -> Vec<u32> {
    let mut sets: HashMap<u32, u32> = HashMap::new();
    // By the resource, and where its number stands.
    let mut bound: Vec<(u32, usize)> = Vec::new();
    let mut at = HEADER;
    for instruction in instructions(&words) {
        match *instruction {
            [DECORATE, id, SET, set] => {
                sets.insert(id, set);
            }
            [DECORATE, id, BINDING, _] => bound.push((id, at + 3)),
            _ => {}
        }
        at += instruction.len();
    }
    let place = |id: &u32, number: u32| (sets.get(id).copied().unwrap_or_default(), number);
    let mut given: HashSet<(u32, u32)> = bound.iter().map(|(id, at)| place(id, words[*at])).collect();
    let mut known = HashSet::new();
    for (id, at) in bound {
        if known.insert(place(&id, words[at])) {
            continue;
        }
        if let Some(free) = (0..).find(|&number| given.insert(place(&id, number))) {
            words[at] = free;
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn module(resources: &[(u32, u32, u32)]) -> Vec<u32> {
        let header = [0x0723_0203, 0x1_0300, 0, 9, 0];
        let of = |&(id, set, binding): &(u32, u32, u32)| [DECORATE, id, SET, set, DECORATE, id, BINDING, binding];
        header.into_iter().chain(resources.iter().flat_map(of)).collect()
    }

    #[test]
    fn resources_of_one_number_get_numbers_of_their_own() {
        let shared = module(&[(1, 0, 1), (2, 0, 1), (3, 0, 0), (4, 1, 1), (5, 0, 1)]);
        assert_eq!(apart(shared), module(&[(1, 0, 1), (2, 0, 2), (3, 0, 0), (4, 1, 1), (5, 0, 3)]));
        let right = module(&[(1, 0, 0), (2, 0, 1), (3, 1, 0)]);
        assert_eq!(apart(right.clone()), right);
        assert_eq!(apart(vec![0x0723_0203]), [0x0723_0203], "cut short");
    }
}
