//! A floating-point literal moved by one ULP of binary32, both ways: the smallest fault there is. No
//! comparison with a lane shows most of them; one with the formula in binary64 does, where the literal
//! has a part in an output.

use super::becomes;
use super::constant::{literals, text};
use crate::mutate::{Code, Draft};

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for (id, value) in literals(code) {
        // The neighbours of 0 are subnormal: a device may take them for 0.
        if value == 0.0 {
            continue;
        }
        for (kind, other) in [("-1 ULP", value.next_down()), ("+1 ULP", value.next_up())] {
            if other.is_finite() {
                let to = text(other);
                let what = format!("{} ({kind})", becomes(code.shader.text_of(id), &to));
                drafts.push(Draft::new(code.replace(id, to), what));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn a_literal_moves_to_its_neighbours() {
        assert_eq!(
            changes("constant-ulp", "float f(float a) {\n  return a * 0.5 + 0.0;\n}"),
            ["return a * 0.49999997 + 0.0;", "return a * 0.50000006 + 0.0;"]
        );
    }
}
