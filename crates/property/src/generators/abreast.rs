//! Ordinary samples, drawn side by side in vectors.
//!
//! Inputs have the same bits for every width of vectors: what is drawn side by side is computed operation by
//! operation as `fill` does one by one, and tests compare the two.

use number::wide;

use super::{EXACT, Generator, Group, Place, Rows, SPECIAL, Stream, mix};

/// Rows that are drawn side by side.
const ABREAST: usize = 16;

/// True where [`fill`] can fill rows: names that lie side by side. Longer groups have few rows, and their words side by
/// side already.
pub fn fits(rows: &Rows<'_>) -> bool {
    matches!(rows.spans, [span] if span.len() <= ABREAST)
}

/// Fills rows of a generator that first draws whether a sample is special, and if not, an ordinary number for each word:
/// the same bits as one by one. Ordinary numbers are drawn for all rows in vectors; rows that are special, or of an exact
/// case, are drawn again. `finish` comes after ordinary numbers.
pub fn fill<G: Generator + ?Sized>(generator: &G, group: &Group, rows: Rows<'_>, finish: impl Fn(&mut [u32])) {
    let Rows { words, stride, spans, key, exact_key, first_case, first_invocation, per_case } = rows;
    let span = spans[0].clone();
    let (range, count) = (*group.range(), group.words());
    let is_exact = |case| mix(exact_key, case).is_multiple_of(EXACT);
    let mut case = first_case;
    let mut place = Place { case_seed: mix(key, case), invocation: first_invocation, exact: is_exact(case) };
    let mut places = [place; ABREAST];
    let (mut keys, mut invocations, mut special) = ([0; ABREAST], [0; ABREAST], [false; ABREAST]);
    let mut drawn = [[0_u32; ABREAST]; ABREAST];
    for part in words.chunks_mut(stride * ABREAST) {
        let rows = part.len() / stride;
        for k in 0..rows {
            places[k] = place;
            (keys[k], invocations[k]) = (place.case_seed, place.invocation as u64);
            place.invocation += 1;
            if place.invocation == per_case {
                case = case.wrapping_add(1);
                place = Place { case_seed: mix(key, case), invocation: 0, exact: is_exact(case) };
            }
        }
        wide(
            #[inline(always)]
            || {
                let mut streams = keys.map(Stream::new);
                for k in 0..ABREAST {
                    streams[k] = Stream::new(mix(keys[k], invocations[k]));
                }
                for k in 0..ABREAST {
                    special[k] = streams[k].one_in(SPECIAL);
                }
                for column in drawn.iter_mut().take(count) {
                    for k in 0..ABREAST {
                        column[k] = range.ordinary(streams[k].bits()).to_bits();
                    }
                }
            },
        );
        for (k, row) in part.chunks_exact_mut(stride).enumerate() {
            let out = &mut row[span.clone()];
            if special[k] || places[k].exact {
                generator.fill(group, places[k], &mut Stream::new(mix(keys[k], invocations[k])), out);
            } else {
                out.iter_mut().zip(&drawn).for_each(|(out, column)| *out = column[k]);
                finish(out);
            }
            group.fetch(out);
        }
    }
}
