//! What words in names stand for.

use super::{Guess, guess};

pub(super) const COLOUR: &str = "a colour";
/// What texture coordinates are taken for.
pub const TEXTURE_COORDINATES: &str = "texture coordinates";
pub(super) const TIME: &str = "a time";
/// What a number from 0 to 1 is taken for.
pub const SHARE: &str = "a share";
pub(super) const SIZE: &str = "a size";
pub(super) const ANGLE: &str = "an angle";
pub(super) const PIXELS: &str = "a number of pixels";
/// What the step from one texel to the next is taken for.
pub(super) const TEXEL: &str = "the size of a texel";

const DIRECTION: Guess = guess("direction", None, "a direction");

/// Names that are a convention as they stand: in books on lighting a capital letter is a direction.
const LETTERS: [&str; 18] =
    ["N", "L", "V", "H", "R", "T", "B", "I", "n", "l", "h", "nor", "norm", "rd", "wi", "wo", "Vn", "Ng"];

/// Words in names, with what they stand for.
const WORDS: &[(&[&str], Guess)] = &[
    (&["weight", "weights"], guess("simplex", None, "weights that add up to one")),
    (
        &["normal", "normals", "tangent", "bitangent", "binormal", "direction", "dir", "axis", "ray", "forward"],
        DIRECTION,
    ),
    (&["quat", "quaternion", "orientation", "halfvector", "halfvec", "halfway"], DIRECTION),
    (
        &[
            "color",
            "colour",
            "col",
            "rgb",
            "rgba",
            "albedo",
            "diffuse",
            "ambient",
            "specular",
            "tint",
            "emission",
            "emissive",
            "kd",
            "ka",
            "ks",
            "ke",
            "reflectivity",
            "colors",
            "luminance",
            "radiance",
        ],
        guess("interval", Some([0.0, 1.0]), COLOUR),
    ),
    (
        &["uv", "st", "texcoord", "texcoords", "texcoordinate", "coord", "coords", "texture", "tex", "uvs"],
        guess("interval", Some([0.0, 1.0]), TEXTURE_COORDINATES),
    ),
    (
        &["angle", "theta", "phi", "azimuth", "elevation", "yaw", "pitch", "roll"],
        guess("interval", Some([-3.141_592_5, 3.141_592_5]), ANGLE),
    ),
    (&["fov", "fovy"], guess("interval", Some([0.5, 2.0]), "an angle of view")),
    (
        &["shininess", "exponent", "power", "gloss", "glossiness", "hardness"],
        guess("interval", Some([1.0, 64.0]), "an exponent"),
    ),
    (&["dt", "delta", "deltatime", "timestep"], guess("interval", Some([0.004, 0.1]), "a step of time")),
    (&["time", "seconds", "clock"], guess("interval", Some([0.0, 16.0]), TIME)),
    (
        &["costheta", "cos", "ndotl", "ndotv", "ndoth", "vdoth", "hdotv", "ldoth", "nl", "nv", "nh", "vh", "cosine"],
        guess("interval", Some([0.0, 1.0]), "a cosine"),
    ),
    (&["cutoff"], guess("interval", Some([0.5, 1.0]), "the cosine of a cone")),
    (
        &[
            "alpha",
            "opacity",
            "roughness",
            "metallic",
            "metalness",
            "ao",
            "factor",
            "mix",
            "blend",
            "t",
            "ratio",
            "amount",
            "intensity",
            "progress",
            "strength",
            "depth",
            "transparency",
            "occlusion",
            "reflectance",
            // Of optimisers: how much of an average is kept.
            "beta",
            "momentum",
            "decay",
            "dropout",
        ],
        guess("interval", Some([0.0, 1.0]), SHARE),
    ),
    (&["aspectratio"], guess("interval", Some([0.5, 2.0]), SIZE)),
    (&["near", "znear", "start", "mindist"], guess("interval", Some([0.0625, 0.5]), "a near distance")),
    (&["far", "zfar", "end", "maxdist"], guess("interval", Some([4.0, 64.0]), "a far distance")),
    (
        &[
            "resolution",
            "viewport",
            "screensize",
            "windowsize",
            "dimensions",
            "texturesize",
            "outputsize",
            "inputsize",
            "imagesize",
            "canvassize",
            "stagesize",
            "viewsize",
            "buffersize",
        ],
        guess("interval", Some([64.0, 2048.0]), PIXELS),
    ),
    // The same as a whole number.
    (&["resolution", "viewport", "screensize", "windowsize"], guess("index", Some([64.0, 2048.0]), PIXELS)),
    (&["texel", "texelsize", "pixelsize"], guess("interval", Some([0.000_5, 0.02]), TEXEL)),
    (&["ior", "eta"], guess("interval", Some([1.0, 2.5]), "a refractive index")),
    (&["gamma"], guess("interval", Some([1.5, 3.0]), "an exponent of a display")),
    (
        &["constant", "linear", "quadratic", "attenuation", "falloff", "density"],
        guess("interval", Some([0.01, 1.0]), super::COEFFICIENT),
    ),
    (&["bias", "epsilon", "eps"], guess("interval", Some([0.000_1, 0.05]), "a small offset")),
    (&["mouse", "cursor"], guess("interval", Some([0.0, 511.0]), "a place on the screen")),
    (&["sigma", "variance", "stddev", "exposure"], guess("interval", Some([0.25, 4.0]), SIZE)),
    (
        &[
            "scale",
            "size",
            "radius",
            "width",
            "height",
            "length",
            "distance",
            "thickness",
            "frequency",
            "freq",
            "amplitude",
            "speed",
            "wavelength",
            "period",
            "dist",
            "aspect",
            "scaling",
            "mass",
            "spacing",
        ],
        guess("interval", Some([0.125, 4.0]), SIZE),
    ),
    (
        &[
            "position",
            "pos",
            "point",
            "vertex",
            "vert",
            "center",
            "centre",
            "origin",
            "location",
            "eye",
            "camera",
            "positions",
            "points",
        ],
        guess("point", Some([-2.0, 2.0]), "a point"),
    ),
];

/// All guesses of the table.
#[cfg(test)]
pub(super) fn all() -> impl Iterator<Item = &'static Guess> {
    WORDS.iter().map(|(_, guess)| guess)
}

/// What a word stands for.
fn known(word: &str) -> impl Iterator<Item = Guess> {
    WORDS.iter().filter(move |(known, _)| known.contains(&word)).map(|(_, guess)| guess.clone())
}

/// True where two parts of a name are words that stand side by side (`lightdir`) or a word behind a letter that says what
/// kind of variable it is (`vnormal`); `beta` is no `b` with an `eta`, and `allocation` no `al` with a `location`.
fn joins(before: &str, word: &str) -> bool {
    word.len() >= 3
        && match before.len() {
            0 => true,
            1 => KINDS.contains(before),
            n => n >= 3,
        }
}

/// Letters that names of attributes, varyings, uniforms, fragments, inputs, outputs, globals, members and samplers begin with.
const KINDS: &str = "avufiogms";

/// What the words of a name may stand for, the likeliest first: the member before what it is a member of, and the last
/// word before what qualifies it.
pub(super) fn candidates(name: &str) -> Vec<Guess> {
    let last = name.rsplit('.').next().unwrap_or(name);
    if LETTERS.contains(&last) {
        return vec![DIRECTION];
    }
    let lower = last.to_ascii_lowercase();
    // Words without a mark between them: `lightdir`, `texsize`.
    let ends = |word: &str| {
        let longest = WORDS
            .iter()
            .flat_map(|(known, guess)| known.iter().map(move |known| (*known, guess)))
            .filter(|(known, _)| word.strip_suffix(known).is_some_and(|before| joins(before, known)))
            .max_by_key(|(known, _)| known.len());
        longest.map(|(_, guess)| guess.clone())
    };
    let words = syntax::words::words(last);
    let mut all: Vec<Guess> = known(&lower).collect();
    // `outerCutOff`: two words that are one.
    for pair in words.windows(2).rev() {
        all.extend(known(&format!("{}{}", pair[0], pair[1])));
    }
    words.iter().rev().for_each(|word| all.extend(known(word)));
    all.extend(ends(&lower));
    words.iter().rev().for_each(|word| all.extend(ends(word)));
    syntax::words::words(name).iter().rev().for_each(|word| all.extend(known(word)));
    all
}
