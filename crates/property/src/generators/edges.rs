//! Samples at the edges of inputs: ends of ranges and what lies beside them, zeros with either sign, coincident and
//! nearly coincident points.

use base::value::Scalar;

use super::{Generator, Group, float};

/// Samples of one group.
const MOST: usize = 64;
/// Words that are zero one by one.
const SINGLE: usize = 16;
/// Pairs of elements that are made alike.
const PAIRS: usize = 28;
/// Distances from a knot: far beyond rounding, far below what a range is divided into.
const BESIDE: [f32; 2] = [3e-6, 5e-5];
/// Distance of points that nearly coincide.
const NEAR: f32 = 4e-6;
/// Plainer versions of a sample that are taken.
const PLAIN: usize = 8;

/// Values of a word at which programs often decide something. Those outside of the range are for the caller to leave out.
fn values(group: &Group, scalar: Scalar) -> Vec<u32> {
    let (lo, hi) = (group.range().lo(), group.range().hi());
    match scalar {
        Scalar::F32 => {
            let mut values = vec![-0.0, 0.0, lo, hi, lo.next_up(), hi.next_down(), 1.0, -1.0, 0.5];
            for knot in [lo, hi, 0.0, 1.0, 0.5] {
                values.extend(BESIDE.iter().flat_map(|by| [knot + by, knot - by]));
            }
            values.into_iter().map(f32::to_bits).collect()
        }
        Scalar::I32 | Scalar::U32 | Scalar::Bool => {
            vec![0, 1, lo as i32 as u32, hi as i32 as u32]
        }
    }
}

/// Samples at the edges of a group, made from an ordinary one, `base`. All are admitted.
pub(super) fn of<G: Generator + ?Sized>(generator: &G, group: &Group, base: &[u32]) -> Vec<Vec<u32>> {
    let mut all: Vec<Vec<u32>> = Vec::new();
    let mut offer = |mut words: Vec<u32>| {
        group.fetch(&mut words);
        let new = all.len() < MOST && words != base && !all.contains(&words);
        if new && generator.admits(group, &words) {
            all.push(words);
        }
    };
    let mut plainest = base.to_vec();
    generator.simplest(group, &mut plainest);
    offer(plainest);
    alike(group, base, &mut offer);
    for k in 0..PLAIN {
        let mut out = base.to_vec();
        if !generator.simpler(group, base, k, &mut out) {
            break;
        }
        offer(out);
    }
    corners(group, base, &mut offer);
    let lists: Vec<Vec<u32>> = group.scalars().iter().map(|&scalar| values(group, scalar)).collect();
    let longest = lists.iter().map(Vec::len).max().unwrap_or(0);
    for k in 0..longest {
        for element in group.elements() {
            let mut words = base.to_vec();
            for at in element.clone() {
                words[at] = lists[at].get(k).copied().unwrap_or(words[at]);
            }
            // The fourth component of points is fixed.
            if element.len() == 4 && !generator.admits(group, &words) {
                words[element.start + 3] = base[element.start + 3];
            }
            offer(words);
        }
    }
    for at in 0..base.len().min(SINGLE) {
        let mut words = base.to_vec();
        words[at] = lists[at][0];
        offer(words);
    }
    all
}

/// Each pair of elements (of words, where there is one element) at each pair of four values: the ends of the range, zero
/// and one. The rows are those of an orthogonal array of strength 2 over the field of four elements.
fn corners(group: &Group, base: &[u32], offer: &mut dyn FnMut(Vec<u32>)) {
    let single: Vec<std::ops::Range<usize>> = (0..base.len()).map(|at| at..at + 1).collect();
    let parts: &[std::ops::Range<usize>] = if group.elements().len() == 1 { &single } else { group.elements() };
    if !(2..=8).contains(&parts.len()) || group.scalars().iter().any(|&scalar| scalar != Scalar::F32) {
        return;
    }
    let range = group.range();
    let values = [range.lo(), range.hi(), range.clamp(0.0), range.clamp(1.0)];
    // Products with the two elements beside 0 and 1; sums are exclusive ors.
    let (second, third): ([usize; 4], [usize; 4]) = ([0, 2, 3, 1], [0, 3, 1, 2]);
    for (a, b) in (0..4_usize).flat_map(|a| (0..4_usize).map(move |b| (a, b))) {
        let columns = [a, b, a ^ b, a ^ second[b], a ^ third[b]];
        let mut words = base.to_vec();
        for (k, part) in parts.iter().enumerate() {
            // The fourth component of points is fixed.
            let free = if part.len() == 4 { part.start..part.end - 1 } else { part.clone() };
            words[free].fill(values[columns[k % columns.len()]].to_bits());
        }
        offer(words);
    }
}

/// Elements at one place, and some millionths apart.
fn alike(group: &Group, base: &[u32], offer: &mut dyn FnMut(Vec<u32>)) {
    let elements = group.elements();
    let fits = |i: usize, j: usize| elements[i].len() == elements[j].len();
    let mut words = base.to_vec();
    for element in &elements[1..] {
        if element.len() == elements[0].len() {
            words.copy_within(elements[0].clone(), element.start);
        }
    }
    offer(words);
    let pairs = (0..elements.len()).flat_map(|i| (i + 1..elements.len()).map(move |j| (i, j)));
    for (i, j) in pairs.filter(|&(i, j)| fits(i, j)).take(PAIRS) {
        let mut words = base.to_vec();
        words.copy_within(elements[i].clone(), elements[j].start);
        offer(words.clone());
        let at = elements[j].start + i % elements[j].len().min(3);
        if j == i + 1 && group.scalars()[at] == Scalar::F32 {
            for by in [NEAR, -NEAR] {
                words[at] = (float(base[elements[i].start + at - elements[j].start]) + by).to_bits();
                offer(words.clone());
            }
        }
    }
}
