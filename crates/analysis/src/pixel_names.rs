//! What names say of numbers of pixels, and of lengths along lines.

use syntax::words::words;

/// True for the name of a length along a line: of an attribute by its words, of other inputs by what is said of lines alone.
pub fn is_along(name: &str, attribute: bool) -> bool {
    let words = words(name);
    let plain: String = words.concat();
    let said = ["linedistance", "linesofar", "linelength", "arclength", "pathlength", "distancealong", "lengthalong"];
    let word = |word: &String| {
        let word = word.trim_end_matches(|c: char| c.is_ascii_digit());
        ["len", "length", "distance", "dist"].contains(&word)
    };
    said.iter().any(|said| plain.contains(said)) || attribute && words.iter().any(word)
}

/// The power of pixels that the name of a uniform says.
pub fn said(name: &str) -> Option<i32> {
    let words = words(name);
    let plain: String = words.concat();
    let has = |all: &[&str]| all.iter().any(|word| plain.contains(word));
    let of = [
        "screen", "window", "canvas", "stage", "texture", "image", "output", "input", "source", "buffer", "render",
        "display", "view",
    ];
    let steps = [
        "texelsize",
        "pixelsize",
        "onepixel",
        "invsize",
        "sizeinv",
        "invresolution",
        "resolutioninv",
        "rcpframe",
        "inverseresolution",
        "inversesize",
        "texelstep",
        "onetexel",
    ];
    if has(&steps) {
        return Some(-1);
    }
    if has(&["inv", "rcp", "pixel", "texel", "scale", "ratio", "aspect", "point", "offset", "matrix", "min", "max"]) {
        return None;
    }
    let size =
        has(&["resolution", "viewport", "dimensions"]) || has(&["size", "dimension", "width", "height"]) && has(&of);
    size.then_some(1)
}
