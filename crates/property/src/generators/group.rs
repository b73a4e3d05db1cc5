//! A group of inputs that one generator fills.

use base::value::{Scalar, Shape};

use super::{Generator, Options, Range, RangeRule};

/// A group of inputs with everything that its generator needs.
#[derive(Clone, Debug)]
pub struct Group {
    shapes: Vec<Shape>,
    options: Options,
    range: Range,
    words: usize,
    elements: Vec<std::ops::Range<usize>>,
    scalars: Vec<Scalar>,
    fetched: Vec<(usize, u32)>,
}

impl Group {
    /// A group of these shapes, checked by the generator.
    ///
    /// # Errors
    /// What does not fit, without a place.
    pub fn new(generator: &dyn Generator, shapes: &[Shape], options: Options) -> Result<Self, String> {
        let name = generator.name();
        let given = match (generator.range(), options.range) {
            (RangeRule::None, Some(_)) => return Err(format!("generator `{name}` takes no `range`")),
            (RangeRule::Required, None) => return Err(format!("generator `{name}` needs a `range = [lo, hi]`")),
            (RangeRule::Default(lo, hi), None) => [lo, hi],
            (RangeRule::None, None) => [0.0, 0.0],
            (RangeRule::Required | RangeRule::Default(..), Some(range)) => range,
        };
        if !(given[0] <= given[1] && (given[0] as f32).is_finite() && (given[1] as f32).is_finite()) {
            return Err(format!("range [{}, {}] is not `lo <= hi` in finite binary32 numbers", given[0], given[1]));
        }
        if !options.values.is_empty() && !generator.takes_values() {
            return Err(format!("generator `{name}` takes no `values`"));
        }
        let fetched = fetched(generator, shapes, options.components)?;
        let (mut words, mut elements, mut scalars) = (0, Vec::new(), Vec::new());
        for shape in shapes {
            for _ in 0..shape.elements() {
                elements.push(words..words + shape.element_words());
                words += shape.element_words();
            }
            scalars.resize(words, shape.scalar);
        }
        generator.check(shapes, &options)?;
        let range = Range::new(given[0], given[1]);
        Ok(Self { shapes: shapes.to_vec(), options, range, words, elements, scalars, fetched })
    }

    /// Shapes of the names, in order.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// What the suite says.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// The range, or the generator's own.
    pub fn range(&self) -> &Range {
        &self.range
    }

    /// Words of all names.
    pub fn words(&self) -> usize {
        self.words
    }

    /// Word ranges of all array elements (or whole values) of all names.
    pub fn elements(&self) -> &[std::ops::Range<usize>] {
        &self.elements
    }

    /// Scalar type of each word.
    pub fn scalars(&self) -> &[Scalar] {
        &self.scalars
    }

    /// Words that the vertex fetch fills, with their values.
    pub fn fetched(&self) -> &[(usize, u32)] {
        &self.fetched
    }

    /// True when the vertex fetch fills this word.
    pub fn is_fetched(&self, word: usize) -> bool {
        self.fetched.iter().any(|&(w, _)| w == word)
    }

    /// Writes the words that the vertex fetch fills.
    #[inline]
    pub fn fetch(&self, out: &mut [u32]) {
        for &(word, value) in &self.fetched {
            out[word] = value;
        }
    }

    /// True when a float word lies in the range, or is the fetch's business.
    pub(super) fn word_in_range(&self, words: &[u32], word: usize) -> bool {
        self.range.contains(f32::from_bits(words[word])) || self.is_fetched(word)
    }
}

/// Words that the vertex fetch fills when the host feeds `components` floats for each name.
fn fetched(generator: &dyn Generator, shapes: &[Shape], components: Option<u8>) -> Result<Vec<(usize, u32)>, String> {
    let Some(components) = components else { return Ok(Vec::new()) };
    if !generator.takes_components() {
        return Err(format!("generator `{}` takes no `components`", generator.name()));
    }
    let (mut fetched, mut at) = (Vec::new(), 0);
    for shape in shapes {
        if shape.scalar != Scalar::F32 || shape.columns != 1 || shape.array.is_some() {
            return Err(format!("`components` is for float and vector attributes, not for {shape}"));
        }
        if components == 0 || components > shape.rows {
            return Err(format!("{components} components do not feed a {shape}, which has {}", shape.rows));
        }
        for row in usize::from(components)..usize::from(shape.rows) {
            // The fetch expands a short attribute by (0, 0, 0, 1): OpenGL 3.2, section 2.8.
            fetched.push((at + row, if row == 3 { 1f32.to_bits() } else { 0 }));
        }
        at += shape.words();
    }
    Ok(fetched)
}
