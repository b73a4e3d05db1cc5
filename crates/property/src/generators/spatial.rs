//! What points, vectors and nodes have in common: elements of two to four components, of which the
//! fourth is fixed.

use super::{Generator, Group, Place, Rows, SPECIAL, Stream, abreast, each_row, float};

/// Kinds of special samples in [`fill`].
const KINDS: usize = 6;

/// Writes elements with components in the range and the fourth component `w`.
#[inline]
pub fn fill(group: &Group, w: f32, place: Place, stream: &mut Stream, out: &mut [u32]) {
    if place.exact && stream.bits() & 1 == 0 {
        for word in out.iter_mut() {
            *word = group.range().lattice(stream.bits()).to_bits();
        }
    } else if stream.one_in(SPECIAL) {
        special(group, stream, out);
    } else {
        for word in out.iter_mut() {
            *word = group.range().ordinary(stream.bits()).to_bits();
        }
    }
    set_w(group, w, out);
}

/// Fills rows of a generator whose samples are those of [`fill`].
pub fn fill_rows<G: Generator>(generator: &G, group: &Group, w: f32, rows: Rows<'_>) {
    if abreast::fits(&rows) {
        abreast::fill(generator, group, rows, |out| set_w(group, w, out));
    } else {
        each_row(generator, group, rows);
    }
}

fn special(group: &Group, stream: &mut Stream, out: &mut [u32]) {
    let range = group.range();
    let kind = stream.below(KINDS);
    let first = group.elements()[0].clone();
    for element in group.elements() {
        // The only component that is not zero on an axis, and the value of all on the diagonal.
        let axis = stream.below(element.len().min(3));
        let value = range.ordinary(stream.bits());
        for (i, word) in element.clone().enumerate() {
            out[word] = match kind {
                0 => range.clamp(0.0),
                1 => range.lattice(stream.bits()),
                2 if i == axis => value,
                2 => range.clamp(0.0),
                3 => value,
                4 => range.special(stream.bits()),
                _ if stream.bits() & 1 == 0 => range.lo(),
                _ => range.hi(),
            }
            .to_bits();
        }
    }
    // Half of the diagonal and corner samples have all elements at one place.
    if kind >= 3 && stream.bits() & 1 == 0 {
        for element in &group.elements()[1..] {
            let shared = element.len().min(first.len());
            out.copy_within(first.start..first.start + shared, element.start);
        }
    }
}

/// Sets the fourth component of all elements that have one.
#[inline]
pub fn set_w(group: &Group, w: f32, out: &mut [u32]) {
    for element in group.elements() {
        if element.len() == 4 {
            out[element.start + 3] = w.to_bits();
        }
    }
}

/// Components in the range and the fourth component `w`.
pub fn admits(group: &Group, w: f32, words: &[u32]) -> bool {
    group.elements().iter().all(|element| {
        element.clone().enumerate().all(|(i, word)| match i {
            3 => float(words[word]) == w || group.is_fetched(word),
            _ => group.word_in_range(words, word),
        })
    })
}

/// All elements as near to the origin as the range permits.
pub fn simplest(group: &Group, w: f32, out: &mut [u32]) {
    out.fill(group.range().clamp(0.0).to_bits());
    set_w(group, w, out);
}
