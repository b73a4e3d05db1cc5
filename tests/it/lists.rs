//! The lists over which tests loop have something in them: a test of each entry of an empty list would pass.

use chapter::{formula, relations};
use engine::{catalogue, mutate, suite};

#[test]
fn no_list_over_which_tests_loop_is_empty() {
    let lengths = [
        ("formulas", formula::all().len()),
        ("generators", catalogue::generators().count()),
        ("lanes", lanes::registry().len()),
        ("operators of mutation", mutate::operators::registry().len()),
        ("relations", relations::all().len()),
        ("suites", suite::shipped().count()),
    ];
    // Fewer than that would be: no crate with content is linked.
    assert!(catalogue::generators().count() > property::generators::all().len());
    assert!(lengths.iter().all(|(_, length)| *length > 3), "{lengths:?}");
}
