//! The lists over which tests loop have something in them: a test of each entry of an empty list would pass.

use chapter::{formula, relations};
use engine::{mutate, suite};
use property::generators;

#[test]
fn no_list_over_which_tests_loop_is_empty() {
    let lengths = [
        ("formulas", formula::all().len()),
        ("generators", generators::all().len()),
        ("lanes", lanes::registry().len()),
        ("operators of mutation", mutate::operators::registry().len()),
        ("relations", relations::all().len()),
        ("suites", suite::shipped().count()),
    ];
    assert!(lengths.iter().all(|(_, length)| *length > 3), "{lengths:?}");
}
