//! Which values an input takes, guessed from its name, its type, and how the shader uses it: what `init` writes into
//! a first suite, and what `fuzz` takes for realistic.

mod passed;
mod usage;
mod words;

use base::value::{Field, Scalar, Shape};
use property::generators::{self, Options};

pub use passed::Passed;
pub use usage::{Usage, Usages, Uses};
pub use words::{SHARE, TEXTURE_COORDINATES};

/// A guess: a generator, its range where it takes one, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Guess {
    /// Name of the generator.
    pub generator: &'static str,
    /// Both ends for `range`; none for a generator that needs none.
    pub range: Option<[f64; 2]>,
    /// What the input is taken for.
    pub taken_for: &'static str,
    /// Both ends of what the callers of a function give it, where they are known.
    pub passed: Option<[f64; 2]>,
}

/// Where the values of an input come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A parameter of a function, an attribute, or not known.
    Parameter,
    /// Set by the host for all invocations.
    Uniform,
    /// Interpolated between what the stage before wrote.
    Varying,
    /// The place of a fragment on the screen.
    Screen,
}

const fn guess(generator: &'static str, range: Option<[f64; 2]>, taken_for: &'static str) -> Guess {
    Guess { generator, range, taken_for, passed: None }
}

/// What an input is taken for whose ends are values like others: black, the corner of a texture, the first frame.
const CLOSED: [&str; 5] = [words::COLOUR, words::TEXTURE_COORDINATES, words::TIME, words::SHARE, words::ANGLE];

/// The line of a suite file that marks a group of inputs whose values nobody stated.
pub(crate) const GUESSED: &str = "guessed = true # set the range to what programs give, and delete this line\n";

/// What a matrix is taken for that transforms normals.
pub const NORMAL_MATRIX: &str = "a normal matrix";
/// What a matrix of any size is taken for that turns.
pub const ROTATION: &str = "a rotation";
/// What a number is taken for that the host sets.
const SETTING: &str = "a setting";
/// What a place on the screen is called.
pub const SCREEN: &str = "a place on the screen";

/// What a number is taken for that nothing explains.
pub const ANY: &str = "any number";
/// What a matrix is taken for that nothing explains.
const ANY_MATRIX: &str = "any matrix";
const WHOLE: &str = "a small whole number";
/// What a whole number is taken for that holds several numbers.
pub const PACKED: &str = "packed numbers";
/// What a whole number is taken for that is read as a real one.
pub const BITS: &str = "the bits of a number";
const PROJECTION: &str = "a projection";
const COEFFICIENT: &str = "a coefficient";

/// What an input is taken for of which names say little: what it is worth in a program may be something else.
const UNSURE: [&str; 11] =
    [PACKED, BITS, ANY, ANY_MATRIX, WHOLE, PROJECTION, COEFFICIENT, SETTING, words::SHARE, words::SIZE, words::PIXELS];

/// Values that callers pass lie no farther apart where they say more than that a type has ends.
const PASSED: f64 = 65_536.0;

/// Centres of texels that the smallest texture of a run has, and their neighbours two texels away.
const TEXELS: [f64; 2] = [2.5, 5.5];

impl Guess {
    /// The same as far as it comes in a program that runs for an hour on a large screen; none where that is no farther.
    pub fn far(&self) -> Option<Self> {
        let range = match self.taken_for {
            words::TIME => [0.0, 3600.0],
            words::PIXELS => [320.0, 4096.0],
            SCREEN if self.range != Some(TEXELS) => [0.5, 2559.5],
            words::TEXEL => [1.0 / 4096.0, 1.0 / 256.0],
            _ => return None,
        };
        Some(Self { range: Some(range), ..self.clone() })
    }

    /// True where the name says what comes: a colour has several components, and what a host sets for a whole draw is no
    /// place in a texture.
    pub fn is_sure(&self, shape: Shape, uniform: bool) -> bool {
        let scalar = shape.words() == 1;
        let unsure = UNSURE.contains(&self.taken_for) || scalar && self.taken_for == words::COLOUR;
        !(unsure || uniform && self.taken_for == words::TEXTURE_COORDINATES)
    }

    /// The same where those who call the function pass it values between two ends alone. What no name explains has the
    /// values that they pass, if these have ends.
    pub fn passed(self, ends: [f64; 2]) -> Self {
        let [low, high] = ends;
        let guess = Self { passed: Some(ends), ..self };
        let ranged = ["interval", "index"].contains(&guess.generator);
        let Some([from, to]) = guess.range.filter(|_| ranged) else { return guess };
        let has_ends = low.is_finite() && high.is_finite();
        let both = [low.max(from), high.min(to)];
        let open = [ANY, WHOLE, SETTING].contains(&guess.taken_for) && high - low < PASSED;
        let range = if has_ends && (open || both[0] >= both[1]) { [low, high] } else { both };
        if range[0] < range[1] { Self { range: Some(range), ..guess } } else { guess }
    }

    /// True where both ends of the range are values like others.
    pub fn is_closed(&self) -> bool {
        CLOSED.contains(&self.taken_for)
    }
}

/// The values of a number that the draw decides: the vertex, the instance, the primitive.
pub fn number_of_the_draw(most: u32) -> Guess {
    guess("index", Some([0.0, f64::from(most)]), "a number of the draw")
}

/// The values that an input takes, by its name and type alone.
pub fn of(field: &Field, role: Role) -> Guess {
    with_uses(field, role, &Uses::default())
}

/// The values that an input takes.
pub fn with_uses(field: &Field, role: Role, uses: &Uses) -> Guess {
    let shape = field.shape;
    if field.name == "gl_FragCoord" || role == Role::Screen {
        // Inside of the textures of a run, with room for neighbours, where texels are read by the place on the screen.
        let range = if uses.has(Usage::Texels) { TEXELS } else { [0.5, 511.5] };
        return guess("interval", Some(range), SCREEN);
    }
    if shape.scalar == Scalar::F32 && shape.columns > 1 {
        return matrix(&field.name, shape);
    }
    let named = words::candidates(&field.name).into_iter().find(|guess| fits(guess, shape));
    let found = named.or_else(|| by_use(shape, uses)).unwrap_or_else(|| by_type(shape, role));
    let found = narrowed(found, shape, uses);
    match found.range {
        // What a host sets, and something is divided by, is not 0.
        Some([low, high])
            if role == Role::Uniform && found.generator == "interval" && uses.has(Usage::Divisor) && high > DIVISOR =>
        {
            Guess { range: Some([if low < 0.0 { low } else { low.max(DIVISOR) }, high]), ..found }
        }
        _ => found,
    }
}

/// The least that a host sets something to that is divided by.
const DIVISOR: f64 = 1.0 / 64.0;

/// A matrix: what its name says that it maps.
fn matrix(name: &str, shape: Shape) -> Guess {
    let element = shape.element();
    let plain = name.to_ascii_lowercase();
    let words = syntax::words::words(name);
    let has = |parts: &[&str]| parts.iter().any(|part| plain.contains(part));
    let is = |whole: &[&str]| words.iter().any(|word| whole.contains(&word.as_str()));
    let any = || guess("interval", Some([-2.0, 2.0]), ANY_MATRIX);
    if has(&["normal"]) || is(&["nm"]) {
        return if element == Shape::MAT4 {
            guess("affine", Some([-2.0, 2.0]), NORMAL_MATRIX)
        } else if element.columns == element.rows {
            Guess { taken_for: NORMAL_MATRIX, ..any() }
        } else {
            any()
        };
    }
    if element != Shape::MAT4 {
        let turns =
            element.columns == element.rows && (has(&["rot", "tbn", "tangent", "orient", "basis"]) || is(&["r"]));
        return if turns { Guess { taken_for: ROTATION, ..any() } } else { any() };
    }
    let projects =
        has(&["proj", "mvp", "lightspace", "shadow", "clip"]) || is(&["p", "vp", "pv", "pvm", "wvp", "persp"]);
    if projects {
        guess("projection", Some([-2.0, 2.0]), PROJECTION)
    } else if has(&["bone", "joint", "skin"]) {
        guess("rigid", None, "matrices of bones")
    } else if has(&["rot", "orient"]) {
        guess("rigid", None, ROTATION)
    } else if (has(&["view", "camera"]) || is(&["v"])) && !has(&["model", "world"]) {
        guess("rigid", None, "a view")
    } else {
        guess("affine", Some([-2.0, 2.0]), "an affine map")
    }
}

/// What the shader does with an input tells where its name does not.
fn by_use(shape: Shape, uses: &Uses) -> Option<Guess> {
    if shape.scalar != Scalar::F32 {
        if uses.has(Usage::Bits) || uses.has(Usage::Packed) {
            let ends = if shape.scalar == Scalar::U32 {
                [0.0, f64::from(u32::MAX)]
            } else {
                [f64::from(i32::MIN), f64::from(i32::MAX)]
            };
            return Some(guess("index", Some(ends), if uses.has(Usage::Bits) { BITS } else { PACKED }));
        }
        let most = uses.index_below()?;
        return Some(guess("index", Some([0.0, f64::from(most) - 1.0]), "an index"));
    }
    let scalar = shape.words() == 1;
    if uses.has(Usage::Coordinates) {
        Some(guess("interval", Some([0.0, 1.0]), words::TEXTURE_COORDINATES))
    } else if scalar && uses.has(Usage::Exponent) {
        Some(guess("interval", Some([1.0, 8.0]), "an exponent"))
    } else if scalar && uses.has(Usage::Share) {
        Some(guess("interval", Some([0.0, 1.0]), words::SHARE))
    } else {
        None
    }
}

/// A range that lies where the operations are defined that the input goes into.
fn narrowed(found: Guess, shape: Shape, uses: &Uses) -> Guess {
    let Some([low, high]) = found.range.filter(|_| found.generator == "interval") else {
        let below = uses.index_below().filter(|_| found.generator == "index" && shape.scalar != Scalar::F32);
        let range = below
            .map_or(found.range, |most| found.range.map(|[low, high]| [low, high.min(f64::from(most) - 1.0).max(low)]));
        // A whole number that something is divided by says how many there are.
        let counts = uses.has(Usage::Divisor) && found.generator == "index" && shape.scalar != Scalar::F32;
        let range = if counts { range.map(|[low, high]| [low.max(1.0), high.max(1.0)]) } else { range };
        return Guess { range, ..found };
    };
    // From below, far enough from the pole of a logarithm.
    let low = if uses.has(Usage::Positive) { low.max(1.0 / 64.0) } else { low };
    let (low, high) = if uses.has(Usage::Cosine) { (low.max(-1.0), high.min(1.0)) } else { (low, high) };
    // What becomes a whole number is how many there are.
    let counts = uses.has(Usage::Counted) && [words::SIZE, SETTING].contains(&found.taken_for);
    let (low, high) = if counts { (low.max(2.0), high.max(8.0)) } else { (low, high) };
    if low < high { Guess { range: Some([low, high]), ..found } } else { found }
}

fn by_type(shape: Shape, role: Role) -> Guess {
    match shape.scalar {
        Scalar::Bool => guess("index", Some([0.0, 1.0]), "a switch"),
        Scalar::I32 | Scalar::U32 => guess("index", Some([0.0, 3.0]), WHOLE),
        // What a host sets and no name explains is a strength, a speed, a number of times: above 0.
        Scalar::F32 if shape.words() == 1 && role == Role::Uniform => guess("interval", Some([0.0625, 2.0]), SETTING),
        Scalar::F32 => guess("interval", Some([-2.0, 2.0]), ANY),
    }
}

/// True when the generator fills inputs of this shape.
fn fits(guess: &Guess, shape: Shape) -> bool {
    let options = Options { range: guess.range, ..Options::default() };
    generators::by_name(guess.generator).is_some_and(|generator| {
        // Weights that add up to one come several at a time.
        (guess.generator != "simplex" || shape.words() > 1) && generator.check(&[shape], &options).is_ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guessed(name: &str, shape: Shape) -> (&'static str, &'static str) {
        let guess = of(&Field { name: name.into(), shape }, Role::Parameter);
        (guess.generator, guess.taken_for)
    }

    #[test]
    fn names_and_types_tell_what_an_input_is() {
        let vec3 = Shape::vector(Scalar::F32, 3);
        let mat3 = Shape { columns: 3, rows: 3, ..Shape::MAT4 };
        for (name, shape, generator, taken_for) in [
            ("aNormal", vec3, "direction", "a direction"),
            ("u_lightDir", vec3, "direction", "a direction"),
            ("lightColor", vec3, "interval", "a colour"),
            ("dirLight.ambient", vec3, "interval", "a colour"),
            ("pointLights[1].position", vec3, "point", "a point"),
            ("lightdir", vec3, "direction", "a direction"),
            ("Position_worldspace", vec3, "point", "a point"),
            ("N", vec3, "direction", "a direction"),
            ("boneWeights", Shape::VEC4, "simplex", "weights that add up to one"),
            ("weight", Shape::FLOAT, "interval", "any number"),
            ("projection", Shape::MAT4, "projection", "a projection"),
            ("model", Shape::MAT4, "affine", "an affine map"),
            ("viewMatrix", Shape::MAT4, "rigid", "a view"),
            ("modelView", Shape::MAT4, "affine", "an affine map"),
            ("ModelViewProjectionMatrix", Shape::MAT4, "projection", "a projection"),
            ("bones", Shape::MAT4.array_of(4), "rigid", "matrices of bones"),
            ("normalMatrix", mat3, "interval", NORMAL_MATRIX),
            ("TBN", mat3, "interval", ROTATION),
            ("TexCoord", Shape::VEC2, "interval", "texture coordinates"),
            ("theta", Shape::FLOAT, "interval", "an angle"),
            ("NdotL", Shape::FLOAT, "interval", "a cosine"),
            ("gl_Position", Shape::VEC4.array_of(3), "point", "a point"),
            ("count", Shape::INT, "index", "a small whole number"),
            ("params.resolution", Shape::INT, "index", "a number of pixels"),
            ("params.resolution", Shape::VEC2, "interval", "a number of pixels"),
            ("useFog", Shape::vector(Scalar::Bool, 1), "index", "a switch"),
            ("x", Shape::FLOAT, "interval", "any number"),
            // Words inside of words are none.
            ("beta2", Shape::FLOAT, "interval", "a share"),
            ("vnormal", vec3, "direction", "a direction"),
            ("zeta", Shape::FLOAT, "interval", "any number"),
            ("allocation", vec3, "interval", "any number"),
            ("half_vector", vec3, "direction", "a direction"),
            ("u_aspect_ratio", Shape::FLOAT, "interval", "a size"),
        ] {
            assert_eq!(guessed(name, shape), (generator, taken_for), "{name}");
        }
    }

    #[test]
    fn what_a_variable_is_declared_as_is_used_as_the_variable_is() {
        use base::text::SourceFile;
        use syntax::{Shader, Stage};
        let text = "float f(float a, float b) { float x = a; float y = b; y = -y; return log(x) + sqrt(y); }\n";
        let parsed = Shader::parse(&SourceFile::new("a.glsl", text), Stage::Library);
        let usages = Usages::of(&parsed.shader);
        let positive = |name: &str| {
            let (symbol, _) = parsed.shader.symbols().find(|(_, s)| s.name == name).unwrap();
            usages.of_input(symbol, name).has(Usage::Positive)
        };
        assert!(positive("a") && !positive("b"), "`y` is another number by then");
    }

    #[test]
    fn a_whole_number_that_divides_is_not_zero() {
        use base::text::SourceFile;
        use syntax::{Shader, Stage};
        let text = "float f(int i, int n, int k) { return float(i) / float(n) + float(i % k); }\n";
        let parsed = Shader::parse(&SourceFile::new("a.glsl", text), Stage::Library);
        let usages = Usages::of(&parsed.shader);
        let least = |name: &str| {
            let (symbol, _) = parsed.shader.symbols().find(|(_, s)| s.name == name).unwrap();
            let field = Field { name: name.into(), shape: Shape::INT };
            with_uses(&field, Role::Parameter, &usages.of_input(symbol, name)).range.unwrap()[0]
        };
        assert_eq!([least("i"), least("n"), least("k")], [0.0, 1.0, 1.0]);
    }

    #[test]
    fn every_guess_is_a_generator_with_a_range_that_it_takes() {
        for guess in words::all() {
            let fits = [Shape::FLOAT, Shape::VEC4, Shape::MAT4, Shape::INT].into_iter().any(|shape| fits(guess, shape));
            assert!(fits, "{guess:?}");
        }
    }
}
