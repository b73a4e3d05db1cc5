//! Lists of whole numbers of which none stands twice: the vertices of a primitive, the neighbours of a cell.
//!
//! Drawn one by one, few numbers meet often, and a triangle of one vertex has no normal.

use base::value::{Scalar, Shape};

/// Both ends of the numbers of such a list; none where a shape is no list of them, or has no room for so many.
pub(super) fn of(shape: Shape, range: Option<[f64; 2]>) -> Option<[i64; 2]> {
    let [low, high] = range?.map(|end| end as i64);
    let whole = [Scalar::I32, Scalar::U32].contains(&shape.scalar) && shape.element_words() == 1;
    let many = shape.array.map_or(1, i64::from);
    (whole && many > 1 && many <= high - low + 1).then_some([low, high])
}

/// Puts the next number that is free in the place of one that stands there before, from the end of the range on from its start.
pub(super) fn set([low, high]: [i64; 2], words: &mut [u32]) {
    for k in 1..words.len() {
        let (before, rest) = words.split_at_mut(k);
        while before.contains(&rest[0]) {
            // Words of both types wrap alike.
            rest[0] = if rest[0] == high as u32 { low as u32 } else { rest[0].wrapping_add(1) };
        }
    }
}

/// True for words of which none stands twice.
pub(super) fn is(words: &[u32]) -> bool {
    (1..words.len()).all(|k| !words[..k].contains(&words[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_stands_twice_and_none_leaves_the_range() {
        let list = Shape::INT.array_of(4);
        assert_eq!(of(list, Some([-2.0, 1.0])), Some([-2, 1]));
        assert_eq!(of(list, Some([0.0, 2.0])), None);
        assert_eq!((of(Shape::INT, Some([0.0, 8.0])), of(Shape::FLOAT.array_of(4), Some([0.0, 8.0]))), (None, None));
        let mut words = [1_i32, 1, -2, 1].map(i32::cast_unsigned);
        assert!(!is(&words));
        set([-2, 1], &mut words);
        assert_eq!(words.map(u32::cast_signed), [1, -2, -1, 0]);
        assert!(is(&words));
    }
}
