//! Any bytes, read as a file of any stage or as host code: the linter ends, and does not panic.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lint::{Input, run};
use base::text::decode_western;

const NAMES: [&str; 8] = ["a.vert", "a.frag", "a.geom", "a.comp", "a.tesc", "a.tese", "a.glsl", "a.cpp"];

fuzz_target!(|data: &[u8]| {
    let Some((first, bytes)) = data.split_first() else { return };
    let name = NAMES[usize::from(*first) % NAMES.len()];
    if let Ok(read) = decode_western(name, bytes) {
        run(&[Input::new(read.file)]);
    }
});
