//! Values that an input takes.

use std::ops::RangeInclusive;
use std::sync::Arc;

use proptest::strategy::Strategy;

use property::Own;
use property::generators::{self, Drawn, Generator, Options};

/// The values that an input takes.
///
/// A range of floats stands for each component of an input of floats; a range of `i32` for whole numbers; a
/// number or an array of them for a value that stays the same. All but a strategy put special values among
/// what they make: the ends, zeros, powers of two and their neighbours.
///
/// ```
/// use shadercheck_test::{Domain, Shader};
///
/// Shader::from_text("fade.glsl", "vec3 fade(vec3 n, float t, int k) { return n * t * float(k); }")
///     .function("fade")
///     .input("n", Domain::direction())
///     .input("t", 0.0..=1.0)
///     .input("k", 2)
///     .lane("embedded")
///     .samples(256)
///     .assert_agrees();
/// ```
#[derive(Clone, Debug)]
pub struct Domain {
    pub(crate) generator: Own<dyn Generator>,
    pub(crate) options: Options,
    /// What is wrong with it, to be told when it is used.
    pub(crate) problem: Option<String>,
}

impl Domain {
    fn named(name: &str, options: Options) -> Self {
        match generators::by_name(name) {
            Some(generator) => Self { generator: Own::Static(generator), options, problem: None },
            // Not to be reached: the names are those of this file.
            None => Self {
                generator: Own::Static(&generators::CONSTANT),
                options,
                problem: Some(format!("there is no generator `{name}`")),
            },
        }
    }

    fn ranged(name: &str, range: RangeInclusive<f64>) -> Self {
        Self::named(name, Options { range: Some([*range.start(), *range.end()]), ..Options::default() })
    }

    /// Points with coordinates in a range; the fourth component, where there is one, is 1.
    pub fn point(range: RangeInclusive<f64>) -> Self {
        Self::ranged("point", range)
    }

    /// Vectors with components in a range; the fourth component, where there is one, is 0.
    pub fn vector(range: RangeInclusive<f64>) -> Self {
        Self::ranged("vector", range)
    }

    /// Vectors of length one; the fourth component, where there is one, is 0.
    pub fn direction() -> Self {
        Self::named("direction", Options::default())
    }

    /// Weights that are not negative and add up to one.
    pub fn simplex() -> Self {
        Self::named("simplex", Options::default())
    }

    /// `mat4`: rotations with shifts.
    pub fn rigid() -> Self {
        Self::named("rigid", Options::default())
    }

    /// `mat4`: affine maps.
    pub fn affine() -> Self {
        Self::named("affine", Options::default())
    }

    /// `mat4`: projections.
    pub fn projection() -> Self {
        Self::named("projection", Options::default())
    }

    /// The same components in every sample.
    pub fn constant(values: impl IntoIterator<Item = f64>) -> Self {
        Self::named("constant", Options { values: values.into_iter().collect(), ..Options::default() })
    }

    /// What proptest draws from a strategy. A failing value is shrunk as the strategy shrinks it.
    ///
    /// ```
    /// use proptest::prelude::*;
    /// use shadercheck_test::{Domain, Shader};
    ///
    /// let even = (-8_i32..8).prop_map(|half| 2 * half);
    /// Shader::from_text("half.glsl", "int halved(int n) { return n / 2; }")
    ///     .function("halved")
    ///     .input("n", Domain::strategy(even))
    ///     .expect("return", |inputs| vec![inputs.number("n") / 2.0])
    ///     .lane("embedded")
    ///     .samples(256)
    ///     .assert_agrees();
    /// ```
    pub fn strategy<S>(strategy: S) -> Self
    where
        S: Strategy + Send + Sync + 'static,
        S::Tree: 'static,
        S::Value: Components,
    {
        let drawn = Drawn::new(strategy, |value: &S::Value| {
            let mut numbers = Vec::new();
            value.components(&mut numbers);
            numbers
        });
        Self { generator: Own::Shared(Arc::new(drawn)), options: Options::default(), problem: None }
    }

    /// How many floats the host feeds to an attribute of a vertex stage; the rest is filled from
    /// (0, 0, 0, 1), as the vertex fetch does.
    #[must_use]
    pub fn components(mut self, components: u8) -> Self {
        if (1..=4).contains(&components) {
            self.options.components = Some(components);
        } else {
            self.problem = Some(format!("{components} components, and an attribute has 1 to 4"));
        }
        self
    }
}

impl From<RangeInclusive<f64>> for Domain {
    fn from(range: RangeInclusive<f64>) -> Self {
        Self::ranged("interval", range)
    }
}

impl From<RangeInclusive<i32>> for Domain {
    fn from(range: RangeInclusive<i32>) -> Self {
        Self::ranged("index", f64::from(*range.start())..=f64::from(*range.end()))
    }
}

impl From<f64> for Domain {
    fn from(value: f64) -> Self {
        Self::constant([value])
    }
}

impl From<i32> for Domain {
    fn from(value: i32) -> Self {
        Self::constant([f64::from(value)])
    }
}

impl From<bool> for Domain {
    fn from(value: bool) -> Self {
        Self::constant([f64::from(u8::from(value))])
    }
}

impl<const N: usize> From<[f64; N]> for Domain {
    fn from(values: [f64; N]) -> Self {
        Self::constant(values)
    }
}

/// What a strategy's values are to a shader: their components as numbers, in the order of GLSL. Matrices
/// come column by column, elements of arrays one after the other, `true` as 1.
pub trait Components {
    /// Adds the components of this value.
    fn components(&self, numbers: &mut Vec<f64>);
}

macro_rules! numbers {
    ($($type:ty)*) => {
        $(impl Components for $type {
            fn components(&self, numbers: &mut Vec<f64>) {
                numbers.push(f64::from(*self));
            }
        })*
    };
}

numbers! { f32 f64 i8 i16 i32 u8 u16 u32 }

impl Components for bool {
    fn components(&self, numbers: &mut Vec<f64>) {
        numbers.push(f64::from(u8::from(*self)));
    }
}

impl<T: Components, const N: usize> Components for [T; N] {
    fn components(&self, numbers: &mut Vec<f64>) {
        self.iter().for_each(|value| value.components(numbers));
    }
}

impl<T: Components> Components for Vec<T> {
    fn components(&self, numbers: &mut Vec<f64>) {
        self.iter().for_each(|value| value.components(numbers));
    }
}

macro_rules! tuples {
    ($(($($name:ident)*))*) => {
        $(impl<$($name: Components),*> Components for ($($name,)*) {
            fn components(&self, numbers: &mut Vec<f64>) {
                #[expect(non_snake_case, reason = "each value bears the name of its type")]
                let ($($name,)*) = self;
                $($name.components(numbers);)*
            }
        })*
    };
}

tuples! { (A) (A B) (A B C) (A B C D) }
