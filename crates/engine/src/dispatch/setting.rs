//! Whole numbers of uniforms, by their names.

use syntax::words::words;

/// What a whole number of a uniform is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Setting {
    /// Where something begins: 0.
    Zero,
    /// The number of workgroups.
    Groups,
    /// Elements along an axis.
    Along(usize),
    /// All elements.
    All,
    /// A step, a flag, a level: the name does not say.
    Open,
}

/// What a whole number of a uniform is taken for, by its name; `many` where elements lie along several axes.
pub(super) fn setting(name: &str, component: Option<u32>, many: bool) -> Setting {
    let name = name.rsplit('.').next().unwrap_or(name).trim_end_matches("[]");
    let words = words(name);
    let is = |any: &[&str]| words.iter().any(|word| any.contains(&word.as_str()));
    if let Some(component) = component {
        let begins = is(&["offset", "start", "base", "first", "origin"]);
        return if begins { Setting::Zero } else { Setting::Along(component as usize) };
    }
    // A number of elements stays one where its name says from where they are counted as well.
    let begins = is(&["offset", "start", "base", "first", "begin", "origin"]);
    if begins && !words.last().is_some_and(|last| COUNTS.contains(&last.as_str())) {
        Setting::Zero
    } else if is(&["groups", "workgroups", "blocks", "partitions", "tiles"]) {
        Setting::Groups
    } else if is(&["width", "w", "cols", "columns", "nx", "x"]) {
        Setting::Along(0)
    } else if is(&["height", "h", "rows", "ny", "y"]) {
        Setting::Along(1)
    } else if is(&["depth", "layers", "nz", "z"]) {
        Setting::Along(2)
    } else if is(&["stride", "pitch"]) || (many && is(&["size", "dim", "dims", "side", "edge", "n", "m", "k"])) {
        Setting::Along(0)
    } else if is(&COUNTS) {
        Setting::All
    } else {
        Setting::Open
    }
}

/// Words for a number of elements.
const COUNTS: [&str; 18] = [
    "n",
    "num",
    "count",
    "size",
    "len",
    "length",
    "total",
    "elements",
    "items",
    "limit",
    "number",
    "end",
    "cnt",
    "dim",
    "side",
    "particles",
    "vertices",
    "max",
];

/// True for the name of a whole number that tells kinds apart.
pub(super) fn is_tag(name: &str) -> bool {
    let tags = ["flags", "flag", "mask", "level", "kind", "type", "tag"];
    words(name).iter().any(|word| tags.contains(&word.as_str()))
}
