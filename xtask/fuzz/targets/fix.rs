//! Any bytes, read as a shader of any stage: what the repairs leave needs no repair.

#![no_main]

use libfuzzer_sys::fuzz_target;
use base::diagnostic::Safety;
use lint::fix::fix;
use lint::{Input, Settings};
use base::text::decode;

const NAMES: [&str; 6] = ["a.vert", "a.frag", "a.geom", "a.comp", "a.tesc", "a.tese"];

fuzz_target!(|data: &[u8]| {
    let Some((first, bytes)) = data.split_first() else { return };
    let name = NAMES[usize::from(*first) % NAMES.len()];
    let Ok(read) = decode(name, bytes) else { return };
    let settings = Settings::default();
    let once = fix(&[Input::new(read.file)], &settings, Safety::Unsafe);
    for file in &once.files {
        let again = fix(&[Input::new(file.after.clone())], &settings, Safety::Unsafe);
        assert!(again.files.is_empty(), "a second pass changes the file again");
    }
});
