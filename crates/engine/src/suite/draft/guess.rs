//! Which values an input takes, guessed from its name and type.

use base::value::{Field, Scalar, Shape};
use property::generators::{self, Options};

/// A guess: a generator, its range where it takes one, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Guess {
    /// Name of the generator.
    pub generator: &'static str,
    /// Both ends for `range`; none for a generator that needs none.
    pub range: Option<[f64; 2]>,
    /// What the input is taken for.
    pub taken_for: &'static str,
}

const fn guess(generator: &'static str, range: Option<[f64; 2]>, taken_for: &'static str) -> Guess {
    Guess { generator, range, taken_for }
}

/// Words in names, with what they stand for. The first that fits name and type counts.
const WORDS: &[(&[&str], Guess)] = &[
    (
        &["projection", "proj", "mvp", "projmat", "viewprojection"],
        guess("projection", Some([-2.0, 2.0]), "a projection"),
    ),
    (&["bone", "bones", "joint", "joints", "skin"], guess("rigid", None, "matrices of bones")),
    (&["rotation", "rot", "orientation"], guess("rigid", None, "a rotation")),
    (&["weight", "weights"], guess("simplex", None, "weights that add up to one")),
    (
        &["normal", "normals", "tangent", "bitangent", "binormal", "direction", "dir", "axis", "ray"],
        guess("direction", None, "a direction"),
    ),
    (
        &["color", "colour", "col", "rgb", "rgba", "albedo", "diffuse", "ambient", "specular", "tint"],
        guess("interval", Some([0.0, 1.0]), "a colour"),
    ),
    (
        &["uv", "st", "texcoord", "texcoords", "texcoordinate", "coord", "texture", "tex"],
        guess("interval", Some([0.0, 1.0]), "texture coordinates"),
    ),
    (
        &["angle", "theta", "phi", "azimuth", "elevation", "yaw", "pitch", "roll"],
        guess("interval", Some([-3.141_592_5, 3.141_592_5]), "an angle"),
    ),
    (&["shininess", "exponent", "power", "gloss"], guess("interval", Some([1.0, 64.0]), "an exponent")),
    (&["time", "seconds", "clock"], guess("interval", Some([0.0, 16.0]), "a time")),
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
        ],
        guess("interval", Some([0.0, 1.0]), "a share"),
    ),
    (
        &["scale", "size", "radius", "width", "height", "length", "distance", "far", "near", "thickness"],
        guess("interval", Some([0.125, 4.0]), "a size"),
    ),
    (
        &["position", "pos", "point", "vertex", "vert", "center", "centre", "origin", "location", "eye", "camera"],
        guess("point", Some([-2.0, 2.0]), "a point"),
    ),
];

/// The values of a number that the draw decides: the vertex, the instance, the primitive.
pub fn number_of_the_draw(most: u32) -> Guess {
    guess("index", Some([0.0, f64::from(most)]), "a number of the draw")
}

/// The values that an input takes.
pub fn of(field: &Field) -> Guess {
    let words = words(&field.name);
    let named = WORDS.iter().filter(|(known, _)| words.iter().any(|word| known.contains(&word.as_str())));
    let mut named = named.map(|(_, guess)| guess.clone()).filter(|guess| fits(guess, field.shape));
    named.next().unwrap_or_else(|| by_type(field.shape))
}

fn by_type(shape: Shape) -> Guess {
    let element = shape.element();
    match element.scalar {
        Scalar::Bool => guess("index", Some([0.0, 1.0]), "a switch"),
        Scalar::I32 | Scalar::U32 => guess("index", Some([0.0, 3.0]), "a small whole number"),
        Scalar::F32 if element == Shape::MAT4 => guess("affine", Some([-2.0, 2.0]), "an affine map"),
        Scalar::F32 if element.columns > 1 => guess("interval", Some([-2.0, 2.0]), "any matrix"),
        Scalar::F32 => guess("interval", Some([-2.0, 2.0]), "any number"),
    }
}

/// True when the generator fills inputs of this shape.
fn fits(guess: &Guess, shape: Shape) -> bool {
    // A share, a colour or a size in a matrix is none.
    if shape.columns > 1 && guess.generator == "interval" {
        return false;
    }
    let options = Options { range: guess.range, ..Options::default() };
    generators::by_name(guess.generator).is_some_and(|generator| {
        // Weights that add up to one come several at a time.
        (guess.generator != "simplex" || shape.words() > 1) && generator.check(&[shape], &options).is_ok()
    })
}

/// The words of a name in small letters: `u_LightDir` is `u`, `light`, `dir`.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut lower = false;
    for c in name.chars() {
        if !c.is_ascii_alphanumeric() || c.is_ascii_digit() {
            lower = false;
            words.push(String::new());
            continue;
        }
        if words.is_empty() || c.is_ascii_uppercase() && lower {
            words.push(String::new());
        }
        lower = c.is_ascii_lowercase();
        if let Some(word) = words.last_mut() {
            word.push(c.to_ascii_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    // `aPos`, `vNormal`, `gl_Position`: the prefix says nothing, and the whole may be one word.
    words.push(name.to_ascii_lowercase());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guessed(name: &str, shape: Shape) -> (&'static str, &'static str) {
        let guess = of(&Field { name: name.into(), shape });
        (guess.generator, guess.taken_for)
    }

    #[test]
    fn names_and_types_tell_what_an_input_is() {
        let vec3 = Shape::vector(Scalar::F32, 3);
        for (name, shape, generator, taken_for) in [
            ("aNormal", vec3, "direction", "a direction"),
            ("u_lightDir", vec3, "direction", "a direction"),
            ("lightColor", vec3, "interval", "a colour"),
            ("boneWeights", Shape::VEC4, "simplex", "weights that add up to one"),
            ("weight", Shape::FLOAT, "interval", "any number"),
            ("projection", Shape::MAT4, "projection", "a projection"),
            ("model", Shape::MAT4, "affine", "an affine map"),
            ("bones", Shape::MAT4.array_of(4), "rigid", "matrices of bones"),
            ("normalMatrix", Shape { columns: 3, rows: 3, ..Shape::MAT4 }, "interval", "any matrix"),
            ("TexCoord", Shape::VEC2, "interval", "texture coordinates"),
            ("theta", Shape::FLOAT, "interval", "an angle"),
            ("gl_Position", Shape::VEC4.array_of(3), "point", "a point"),
            ("count", Shape::INT, "index", "a small whole number"),
            ("useFog", Shape::vector(Scalar::Bool, 1), "index", "a switch"),
            ("x", Shape::FLOAT, "interval", "any number"),
        ] {
            assert_eq!(guessed(name, shape), (generator, taken_for), "{name}");
        }
    }

    #[test]
    fn every_guess_is_a_generator_with_a_range_that_it_takes() {
        for (_, guess) in WORDS {
            let fits = [Shape::FLOAT, Shape::VEC4, Shape::MAT4].into_iter().any(|shape| fits(guess, shape));
            assert!(fits, "{guess:?}");
        }
    }
}
