//! What fills the inputs of a first suite: what comments state, and what names, types and uses tell where nothing is stated.

use std::fmt::Write;

use crate::fuzz::{Interval, Known, Law};
use crate::guess::{self, GUESSED, Guess, Role};
use base::value::{Field, Scalar, Shape};
use program::Program;

/// Part of a range by which an end that is left out is missed: a suite states both ends.
const OFF_THE_END: f64 = 1.0 / (1_u32 << 20) as f64;

/// A group of inputs that are filled alike.
struct InputGroup<'a> {
    uniform: bool,
    names: Vec<&'a str>,
    guess: Guess,
    /// False where the text states what the values are.
    guessed: bool,
}

/// The groups of inputs of a function or an entry point, in TOML: those that are filled alike stand together, uniforms
/// apart from the others.
pub(super) fn groups(
    (inputs, uniforms): (&[&Field], usize),
    program: &Program,
    (known, function): (&Known<'_>, &str),
) -> String {
    let mut groups: Vec<InputGroup<'_>> = Vec::new();
    for (k, field) in inputs.iter().enumerate() {
        let uniform = k < uniforms;
        let (guess, guessed) = match program.largest(&field.name) {
            Some(most) => (guess::number_of_the_draw(most), false),
            None => {
                let role = if uniform { Role::Uniform } else { Role::Parameter };
                let guess = guess::with_uses(field, role, &known.uses(function, field));
                stated(guess, field.shape, &known.stated(function, &field.name))
            }
        };
        // Bones and weights keep laws between the inputs of a group; others only share a range.
        let joins = |g: &&mut InputGroup<'_>| {
            (g.uniform, &g.guess, g.guessed) == (uniform, &guess, guessed)
                && matches!(guess.generator, "interval" | "index" | "point")
        };
        match groups.iter_mut().find(joins) {
            Some(group) => group.names.push(&field.name),
            None => groups.push(InputGroup { uniform, names: vec![&field.name], guess, guessed }),
        }
    }
    let mut text = String::new();
    for InputGroup { names, guess, guessed, .. } in groups {
        let list: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
        let about = if guessed { format!("taken for {}", guess.taken_for) } else { "stated in the shader".to_owned() };
        let _ = write!(text, "\n[[inputs]] # {about}\n");
        let _ = write!(text, "names = [{}]\ngenerator = {:?}\n", list.join(", "), guess.generator);
        if let Some([lo, hi]) = guess.range {
            let _ = writeln!(text, "range = [{lo:?}, {hi:?}]");
        }
        if guessed {
            text.push_str(GUESSED);
        }
    }
    text
}

/// A guess with what is stated of the input, and whether it is still a guess.
fn stated(guess: Guess, shape: Shape, laws: &[Law]) -> (Guess, bool) {
    let interval = laws.iter().find_map(|law| if let Law::Within(interval) = law { Some(*interval) } else { None });
    if let Some(interval) = interval {
        let generator = if shape.scalar == Scalar::F32 && !laws.contains(&Law::Whole) { "interval" } else { "index" };
        // Matrices and weights have generators of their own, which take no range that is stated for components.
        return match within(interval, guess.range) {
            Some(range) => (Guess { generator, range: Some(range), ..guess }, false),
            None => (guess, true),
        };
    }
    let vector = shape.scalar == Scalar::F32 && shape.columns == 1 && shape.words() > 1;
    if vector && laws.contains(&Law::Normalised) {
        return (Guess { generator: "direction", range: None, ..guess }, false);
    }
    if shape == Shape::MAT4 && laws.contains(&Law::Rotation) {
        return (Guess { generator: "rigid", range: None, ..guess }, false);
    }
    (guess, true)
}

/// Both ends of a range as a suite states them; where it has no end, the guess has one, or it goes a little beyond the other.
fn within(interval: Interval, guessed: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let Interval { low, high, open_low, open_high } = interval;
    let [near, far] = guessed.unwrap_or([-2.0, 2.0]);
    let span = (far - near).max(1.0);
    let (low, high) = match (low.is_finite(), high.is_finite()) {
        (true, true) => (low, high),
        (true, false) => (low, if far > low { far } else { low + span }),
        (false, true) => (if near < high { near } else { high - span }, high),
        (false, false) => return None,
    };
    let off = (high - low) * OFF_THE_END;
    Some([if open_low { low + off } else { low }, if open_high { high - off } else { high }])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_that_nobody_stated_are_those_of_the_guess() {
        let above = Interval { low: 0.0, high: f64::INFINITY, open_low: true, open_high: false };
        let [low, high] = within(above, Some([-2.0, 2.0])).unwrap();
        assert!(low > 0.0 && low < 1e-5 && high == 2.0);
        let far = Interval { low: 10.0, high: f64::INFINITY, open_low: false, open_high: false };
        assert_eq!(within(far, Some([-2.0, 2.0])), Some([10.0, 14.0]));
        let whole = Interval { low: 0.0, high: 1.0, open_low: false, open_high: false };
        assert_eq!(within(whole, None), Some([0.0, 1.0]));
    }
}
