//! A place in a batch on which a deviation depends, whatever the inputs.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Where in its batch a sample deviates, while the same inputs are right in other places.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Position {
    /// Index of the invocation.
    pub invocation: usize,
    /// Invocations of the batch.
    pub count: usize,
    /// Invocations that share uniforms.
    pub per_case: usize,
    /// The first few invocations that deviate where all have the same inputs. With none, all are right beside their
    /// like, and what stands beside the sample makes the difference.
    pub wrong: Vec<usize>,
    /// How many deviate.
    pub many: usize,
    /// True where invocations disturb each other: beside its like the sample is right, beside others it is wrong each time,
    /// and what it gives is not that of another place.
    #[serde(default)]
    pub disturbed: bool,
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { invocation, count, wrong, many, disturbed, .. } = self;
        if *disturbed {
            return write!(
                f,
                "invocation {invocation} of {count} deviates each time beside others, and none does where all have the same \
                 inputs"
            );
        }
        if wrong.is_empty() {
            return write!(
                f,
                "invocation {invocation} of {count} deviates beside others, and none where all have the same inputs"
            );
        }
        let named: Vec<String> = wrong.iter().map(usize::to_string).collect();
        let more = if *many > wrong.len() { ", …" } else { "" };
        let deviate = if *many == 1 { "deviates" } else { "deviate" };
        write!(f, "of {count} invocations with the same inputs, {many} {deviate}: {}{more}", named.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_places_are_counted_and_the_first_are_named() {
        let position = |wrong: &[usize], many| {
            Position { invocation: 63, count: 512, per_case: 1, wrong: wrong.to_vec(), many, disturbed: false }
                .to_string()
        };
        assert_eq!(position(&[63], 1), "of 512 invocations with the same inputs, 1 deviates: 63");
        assert_eq!(position(&[63, 127], 8), "of 512 invocations with the same inputs, 8 deviate: 63, 127, …");
        assert!(position(&[], 0).starts_with("invocation 63 of 512 deviates beside others"));
    }
}
