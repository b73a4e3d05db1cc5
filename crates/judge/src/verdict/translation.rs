//! Whether a translation means what the shader means, and whether naga's own GLSL reader takes the shader so.
//!
//! naga writes the translation; it or our own front end reads it back, and the interpreter runs both modules in
//! binary64 on the same inputs. Reader and interpreter are on both sides, so an error of theirs can hide one of
//! the writer's; what remains is a statement about the text that a user gets. Of [`Language::NagaGlsl`], the author's
//! own text is read, and nothing is written: what differs is naga's reading of it.

use std::fmt;
use std::sync::Arc;

use thiserror::Error;

use base::value::{Batch, Record};
use program::interp::{self, Binary32, Binary64, Executable, FUEL, InterpError, Meaning};
use program::{Constants, Language, Program, ReadBack, TranslateError};

/// How far two outputs may be apart, relative to the largest component of their variable.
///
/// A translator may rearrange nothing. It may write a function that its target lacks as another one
/// (`mod` as `x - y * floor(x / y)`, a vector function component by component), and binary64 rounds
/// either at its own steps: this is 2^12 such roundings, and far below one of binary32. It also lets
/// sums in another order pass, which is no other meaning; lanes tell what that costs in binary32.
const SLACK: f64 = 1.0 / (1_u64 << 40) as f64;

/// The batch is not for the program.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(transparent)]
pub struct CompareError(#[from] InterpError);

/// A program beside its translations, ready to run.
pub struct Translations {
    /// `None` when the interpreter does not know a construct in it; then nothing is compared.
    source: Option<Original>,
    sides: Vec<(Language, Result<Side, Unread>)>,
}

/// The shader itself.
struct Original {
    /// How a stage is bound; a geometry stage and a function take the batch as it is.
    bound: Option<ReadBack>,
    executable: Executable,
    outputs: Arc<Record>,
    constants: Arc<Constants>,
}

/// A translation that runs.
struct Side {
    back: ReadBack,
    executable: Executable,
}

/// Why nothing is known about a translation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unread {
    /// It was not run: the language cannot express the shader, naga does not read it back, or the
    /// interpreter does not know a construct in it.
    Unsupported(String),
    /// It has another interface than the shader, which is a deviation without a sample.
    Interface(String),
}

/// What came of one language on a batch.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Language of the translation.
    pub language: Language,
    /// Invocations that agree.
    pub agreed: u64,
    /// Invocations, by index in the batch, that deviate.
    pub deviating: Vec<usize>,
    /// Invocations that differ where the shader leaves the range of a type, which has no meaning to keep.
    pub undetermined: u64,
    /// The deviation of the invocation with the lowest index.
    pub first: Option<TranslationDeviation>,
}

/// Where a translation and its shader differ.
#[derive(Clone, Debug, PartialEq)]
pub struct TranslationDeviation {
    /// Language of the translation.
    pub language: Language,
    /// Invocation of the batch.
    pub invocation: usize,
    /// What differs.
    pub what: Difference,
}

/// What differs.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// A component.
    Value {
        /// Its name.
        component: String,
        /// Vertex, for a geometry stage.
        vertex: Option<usize>,
        /// Its value in the shader.
        shader: f64,
        /// Its value in the translation; `None` when it is not written there.
        translation: Option<f64>,
    },
    /// Numbers of emitted vertices.
    VertexCount {
        /// In the shader.
        shader: u32,
        /// In the translation.
        translation: u32,
    },
    /// A vertex belongs to another strip.
    Strip {
        /// The vertex.
        vertex: usize,
        /// Its strip in the shader.
        shader: u32,
        /// Its strip in the translation.
        translation: u32,
    },
}

impl fmt::Display for TranslationDeviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.language {
            Language::NagaGlsl => f.write_str("naga's GLSL reader gives the shader another meaning: ")?,
            language => write!(f, "the {language} translation deviates from the shader: ")?,
        }
        match &self.what {
            Difference::Value { component, vertex, shader, translation } => {
                let of = vertex.map_or_else(String::new, |v| format!(" of vertex {v}"));
                match translation {
                    Some(value) => write!(f, "`{component}`{of} is {value:?} there and {shader:?} in the shader"),
                    None => write!(f, "`{component}`{of} is not written there and {shader:?} in the shader"),
                }
            }
            Difference::VertexCount { shader, translation } => {
                write!(f, "it emits {translation} vertices and the shader {shader}")
            }
            Difference::Strip { vertex, shader, translation } => {
                write!(f, "vertex {vertex} is in strip {translation} there and in strip {shader} in the shader")
            }
        }
    }
}

impl Translations {
    /// Translates a program to each language in which suites compare it, and has naga read its text where the text can
    /// be brought into naga's dialect.
    pub fn of(program: &Program) -> Self {
        Self::to(program, &[&Language::READABLE[..], &[Language::NagaGlsl]].concat())
    }

    /// Translates a program to these languages.
    pub fn to(program: &Program, languages: &[Language]) -> Self {
        let back = |&language: &Language| (language, program.retranslate(language));
        Self::new(program, languages.iter().map(back).collect())
    }

    /// A program beside anything that was read back for it.
    pub fn new(program: &Program, translations: Vec<(Language, Result<Option<ReadBack>, TranslateError>)>) -> Self {
        // A text that has no place in naga's dialect says nothing about its reader.
        let is_read =
            |(language, read): &(_, Result<Option<_>, _>)| *language != Language::NagaGlsl || !matches!(read, Ok(None));
        let translations = translations.into_iter().filter(is_read);
        match Original::of(program) {
            Ok(source) => {
                let sides = translations.map(|(language, read)| (language, side(read))).collect();
                Self { source: Some(source), sides }
            }
            Err(why) => {
                let why = Unread::Unsupported(why);
                let written = translations.map(|(language, _)| language).filter(|of| *of != Language::NagaGlsl);
                let sides = written.map(|language| (language, Err(why.clone()))).collect();
                Self { source: None, sides }
            }
        }
    }

    /// Languages that are not compared, and why.
    pub fn unread(&self) -> impl Iterator<Item = (Language, &Unread)> {
        self.sides.iter().filter_map(|(language, side)| Some((*language, side.as_ref().err()?)))
    }

    /// Runs the program and its translations on a batch.
    ///
    /// # Errors
    /// [`CompareError`] when the batch is not for this program.
    pub fn compare(&self, batch: &Batch) -> Result<Vec<Comparison>, CompareError> {
        self.compare_some(batch, |_| true)
    }

    /// For each invocation of a batch, whether the translation to a language deviates.
    ///
    /// # Errors
    /// [`CompareError`] when the batch is not for this program.
    pub fn deviates(&self, language: Language, batch: &Batch) -> Result<Vec<bool>, CompareError> {
        let mut deviates = vec![false; batch.invocation_count()];
        for comparison in self.compare_some(batch, |of| of == language)? {
            comparison.deviating.into_iter().for_each(|invocation| deviates[invocation] = true);
        }
        Ok(deviates)
    }

    fn compare_some(&self, batch: &Batch, wanted: impl Fn(Language) -> bool) -> Result<Vec<Comparison>, CompareError> {
        let Some(source) = &self.source else { return Ok(Vec::new()) };
        let laid = source.bound.as_ref().map(|bound| bound.feed(batch));
        let meaning = source.executable.run_with(laid.as_ref().unwrap_or(batch), FUEL, real)?;
        let readable = self.sides.iter().filter_map(|(language, side)| Some((*language, side.as_ref().ok()?)));
        readable
            .filter(|(language, _)| wanted(*language))
            .map(|(language, side)| source.beside(language, side, batch, &meaning))
            .collect()
    }
}

impl Original {
    /// The shader, ready to run.
    fn of(program: &Program) -> Result<Self, String> {
        let bound = program.bound(Language::SpirV).map_err(|error| error.to_string())?;
        let executable = match &bound {
            Some(bound) => interp::compile_read_back(bound),
            None => interp::compile(program),
        };
        let executable = executable.map_err(|error| error.locate(program))?;
        let outputs = bound.as_ref().map_or_else(|| program.output_layout().vertex, |bound| bound.record.clone());
        Ok(Self { bound, executable, outputs, constants: program.constants.clone() })
    }

    fn beside(
        &self,
        language: Language,
        side: &Side,
        batch: &Batch,
        source: &Meaning<f64>,
    ) -> Result<Comparison, CompareError> {
        let laid = side.back.feed(batch);
        let translation = side.executable.run_with(&laid, FUEL, real)?;
        let mut comparison = Comparison { language, agreed: 0, deviating: Vec::new(), undetermined: 0, first: None };
        let (mut rounded, mut meant) = (None, None);
        for invocation in 0..source.count() {
            let Some(what) = self.difference(source, &translation, invocation) else {
                comparison.agreed += 1;
                continue;
            };
            // Readers fold constants in binary32, which the text leaves to be computed: with every operation rounded
            // to it, both are the same.
            if rounded.is_none() {
                let own = self.bound.as_ref().map(|bound| bound.feed(batch));
                let own = self.executable.run::<Binary32>(own.as_ref().unwrap_or(batch), FUEL)?;
                rounded = Some((own, side.executable.run::<Binary32>(&laid, FUEL)?));
            }
            let mut same = rounded.as_ref().is_some_and(|(own, there)| same_bits(own, there, invocation));
            // A front end may fold constants in steps of its own. The numbers that the author means are the same.
            if language == Language::NagaGlsl && !same {
                if meant.is_none() {
                    let own = self.bound.as_ref().map(|bound| bound.feed(batch));
                    let own = self.meant(&self.executable, own.as_ref().unwrap_or(batch))?;
                    meant = Some((own, self.meant(&side.executable, &laid)?));
                }
                let (own, there) = meant.as_ref().map_or((source, &translation), |(own, there)| (own, there));
                same = self.difference(own, there, invocation).is_none();
            }
            match what {
                _ if same => comparison.agreed += 1,
                // Beyond the range of a type, languages differ in what they promise.
                _ if !source.flags(invocation).is_empty() => comparison.undetermined += 1,
                what => {
                    comparison.deviating.push(invocation);
                    comparison.first.get_or_insert(TranslationDeviation { language, invocation, what });
                }
            }
        }
        Ok(comparison)
    }

    /// The outputs where each literal is the number that the author means by it.
    fn meant(&self, executable: &Executable, batch: &Batch) -> Result<Meaning<f64>, InterpError> {
        let mut numbers = vec![f64::NAN; executable.site_count()];
        for (site, value) in executable.literals() {
            let constant = self.constants.find(None, value).map(|(_, constant)| constant.value());
            numbers[site.index()] = constant.unwrap_or_else(|| f64::from(value));
        }
        let numbers: Arc<[f64]> = numbers.into();
        executable.run_with(batch, FUEL, || Binary64::with_literals(numbers.clone()).stepwise())
    }

    fn difference(&self, source: &Meaning<f64>, translation: &Meaning<f64>, invocation: usize) -> Option<Difference> {
        let (shader, there) = (source.emitted(invocation), translation.emitted(invocation));
        if shader != there {
            return Some(Difference::VertexCount { shader, translation: there });
        }
        let pointwise = source.is_pointwise();
        for vertex in 0..source.stored(invocation) {
            let (shader, there) = (source.strip(invocation, vertex), translation.strip(invocation, vertex));
            if shader != there {
                return Some(Difference::Strip { vertex, shader, translation: there });
            }
            let (own, other) = (source.vertex(invocation, vertex), translation.vertex(invocation, vertex));
            for field in 0..self.outputs.fields().len() {
                let range = self.outputs.range(field);
                let finite = own[range.clone()].iter().filter(|value| value.is_finite());
                let slack = SLACK * finite.fold(0.0_f64, |largest, value| largest.max(value.abs()));
                for word in range {
                    // What the shader does not write may be anything.
                    if !source.is_written(invocation, vertex, word) {
                        continue;
                    }
                    let written = translation.is_written(invocation, vertex, word);
                    if written && agree(own[word], other[word], slack) {
                        continue;
                    }
                    return Some(Difference::Value {
                        component: self.outputs.word_name(word),
                        vertex: (!pointwise).then_some(vertex),
                        shader: own[word],
                        translation: written.then_some(other[word]),
                    });
                }
            }
        }
        None
    }
}

/// The numbers of both sides. What lacks `%` writes it in steps (GLSL's reals), which is no other meaning.
fn real() -> Binary64 {
    Binary64::default().stepwise()
}

/// The same words wherever the shader writes some.
fn same_bits(shader: &Meaning<u32>, translation: &Meaning<u32>, invocation: usize) -> bool {
    let vertex = |k: usize| {
        let (own, there) = (shader.vertex(invocation, k), translation.vertex(invocation, k));
        let same = |word: usize| {
            !shader.is_written(invocation, k, word)
                || translation.is_written(invocation, k, word) && own[word] == there[word]
        };
        shader.strip(invocation, k) == translation.strip(invocation, k) && (0..own.len()).all(same)
    };
    shader.emitted(invocation) == translation.emitted(invocation) && (0..shader.stored(invocation)).all(vertex)
}

/// NaN agrees with NaN: both sides are one program.
fn agree(shader: f64, translation: f64, slack: f64) -> bool {
    shader == translation || (shader.is_nan() && translation.is_nan()) || (shader - translation).abs() <= slack
}

fn side(read: Result<Option<ReadBack>, TranslateError>) -> Result<Side, Unread> {
    // The lines behind the first show a place in a text that nobody has seen.
    let unsupported = |what: String| Unread::Unsupported(what.lines().next().unwrap_or_default().to_owned());
    let back = match read {
        Ok(Some(back)) => back,
        Ok(None) => return Err(unsupported("it is not read back".to_owned())),
        Err(TranslateError::Interface { reason, .. }) => return Err(Unread::Interface(reason)),
        Err(error) => return Err(unsupported(error.to_string())),
    };
    let executable = interp::compile_read_back(&back).map_err(|error| unsupported(error.to_string()))?;
    Ok(Side { back, executable })
}

#[cfg(test)]
mod tests {
    use super::agree;

    #[test]
    fn only_what_a_rewritten_function_explains_is_near() {
        assert!(agree(1.0, 1.0 + f64::EPSILON, super::SLACK));
        assert!(!agree(1.0, 1.0 + f64::from(f32::EPSILON), super::SLACK));
        assert!(!agree(0.0, f64::MIN_POSITIVE, 0.0));
    }

    #[test]
    fn nan_is_nan_and_infinity_has_a_sign() {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        assert!(agree(nan, nan, 0.0) && agree(inf, inf, 0.0) && agree(0.0, -0.0, 0.0));
        assert!(!agree(nan, 1.0, 1.0) && !agree(1.0, nan, 1.0) && !agree(inf, -inf, 1.0) && !agree(inf, 1.0, 1.0));
    }
}
