//! Regression files: inputs that failed once, kept beside the suite and replayed first.
//!
//! One case a line: the name of the suite, then each input as `name=` and its 32-bit words in
//! hexadecimal, separated by commas. `#` starts a comment; behind each case it shows the same values
//! in decimal. Many equal words in a row are one with their number: `00000000*97`. Empty lines and comments are the user's and are never touched.
//!
//! ```text
//! morph p0=3f800000,00000000,00000000,3f800000 t=3f000001 # p0=(1.0, 0.0, 0.0, 1.0) t=0.50000006
//! ```

use std::sync::Arc;

use thiserror::Error;

use base::text::SourceFile;
use base::value::{F32Bits, Record, Scalar, Shape};

use super::Sample;
use base::nearest;

/// Equal words in a row from which on their number stands for them.
const LONG: usize = 8;

/// Words of an input at most.
const MOST: usize = 1 << 24;

/// First lines of a new regression file.
const HEADER: &str = "\
# Inputs that made a suite fail. They run before all others; keep this file under version control.
# Each line: suite, then the 32-bit words of every input in hexadecimal. The comment shows the values.
";

/// Inputs that failed once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Regression {
    /// Name of the suite.
    pub suite: String,
    /// Words of each input by name.
    pub inputs: Vec<(String, Vec<u32>)>,
    /// Where the file says it, such as `morph.regressions:4:1`; empty for a new one.
    pub at: String,
}

/// What is wrong in a regression file.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum RegressionError {
    /// A part of a line that is not `name=words`.
    #[error("{at}: expected `name=` and hexadecimal words such as `t=3f000000`, found `{found}`")]
    NotAnInput {
        /// Place.
        at: String,
        /// What stands there.
        found: String,
    },
    /// A word that is not eight hexadecimal digits.
    #[error("{at}: `{found}` is not a 32-bit word in eight hexadecimal digits, such as `3f800000` for 1.0")]
    NotAWord {
        /// Place.
        at: String,
        /// What stands there.
        found: String,
    },
    /// A line with a name and no inputs.
    #[error("{at}: the case of suite `{suite}` has no inputs")]
    NoInputs {
        /// Place.
        at: String,
        /// Name of the suite, as the line has it.
        suite: String,
    },
    /// An input named twice in a line.
    #[error("{at}: input `{name}` is given twice")]
    Twice {
        /// Place.
        at: String,
        /// The input.
        name: String,
    },
    /// An input that the shader does not have.
    #[error("{at}: the shader has no input `{name}`{}", .suggestion.as_ref().map(|s| format!("; did you mean `{s}`?")).unwrap_or_default())]
    NoSuchInput {
        /// Place.
        at: String,
        /// The input.
        name: String,
        /// The input with the most similar name.
        suggestion: Option<String>,
    },
    /// An input of the shader that the line does not give.
    #[error("{at}: input `{name}` ({shape}) of the shader is missing")]
    Missing {
        /// Place.
        at: String,
        /// The input.
        name: String,
        /// Shape of the input in the shader.
        shape: Shape,
    },
    /// A number of words that is not that of the input.
    #[error("{at}: input `{name}` ({shape}) has {wanted} words, not {given}")]
    WrongLength {
        /// Place.
        at: String,
        /// The input.
        name: String,
        /// Shape of the input in the shader.
        shape: Shape,
        /// Words that it has.
        wanted: usize,
        /// Words that the line gives.
        given: usize,
    },
}

impl Regression {
    /// A failing sample, to be kept.
    pub fn new(suite: &str, sample: &Sample) -> Self {
        let mut inputs = Vec::new();
        for (record, words) in sides(sample) {
            for (i, field) in record.fields().iter().enumerate() {
                inputs.push((field.name.clone(), words[record.range(i)].to_vec()));
            }
        }
        Self { suite: suite.to_owned(), inputs, at: String::new() }
    }

    /// The sample, for a shader with these records. The order of the inputs does not count.
    ///
    /// # Errors
    /// Inputs that the shader lacks, that the line lacks, or of another size.
    pub fn to_sample(&self, invocation: &Arc<Record>, case: &Arc<Record>) -> Result<Sample, RegressionError> {
        let at = || self.at.clone();
        let mut sample = Sample {
            invocation_record: invocation.clone(),
            case_record: case.clone(),
            invocation: vec![0; invocation.words()],
            case: vec![0; case.words()],
        };
        let fields = || case.fields().iter().chain(invocation.fields());
        for (name, words) in &self.inputs {
            let Some(field) = fields().find(|f| f.name == *name) else {
                let suggestion = nearest(name, fields().map(|f| f.name.as_str())).map(str::to_owned);
                return Err(RegressionError::NoSuchInput { at: at(), name: name.clone(), suggestion });
            };
            let (wanted, given) = (field.shape.words(), words.len());
            if wanted != given {
                let (name, shape) = (name.clone(), field.shape);
                return Err(RegressionError::WrongLength { at: at(), name, shape, wanted, given });
            }
            if let Some(out) = sample.words_mut(name) {
                out.copy_from_slice(words);
            }
        }
        match fields().find(|f| self.inputs.iter().all(|(name, _)| *name != f.name)) {
            Some(f) => Err(RegressionError::Missing { at: at(), name: f.name.clone(), shape: f.shape }),
            None => Ok(sample),
        }
    }
}

fn sides(sample: &Sample) -> [(&Record, &[u32]); 2] {
    [(&sample.case_record, &sample.case), (&sample.invocation_record, &sample.invocation)]
}

/// Reads a regression file.
///
/// # Errors
/// The first malformed line, with its place.
pub fn parse(file: &SourceFile) -> Result<Vec<Regression>, RegressionError> {
    let mut regressions = Vec::new();
    for line in 1..=file.line_count() {
        let text = file.line_text(line);
        let body = text.split('#').next().unwrap_or_default();
        let place = |part: &str| {
            // `part` is a slice of the line, so that its column can be counted.
            let bytes = part.as_ptr() as usize - text.as_ptr() as usize;
            format!("{}:{line}:{}", file.name(), text[..bytes].chars().count() + 1)
        };
        let mut parts = body.split_whitespace();
        let Some(suite) = parts.next() else { continue };
        let mut inputs: Vec<(String, Vec<u32>)> = Vec::new();
        for part in parts {
            let input = part.split_once('=').filter(|(name, _)| !name.is_empty());
            let Some((name, words)) = input else {
                return Err(RegressionError::NotAnInput { at: place(part), found: part.to_owned() });
            };
            if inputs.iter().any(|(n, _)| n == name) {
                return Err(RegressionError::Twice { at: place(part), name: name.to_owned() });
            }
            let word = |digits: &str| match u32::from_str_radix(digits, 16) {
                Ok(word) if digits.len() == 8 && !digits.starts_with('+') => Ok(word),
                _ => Err(RegressionError::NotAWord { at: place(digits), found: digits.to_owned() }),
            };
            let mut all: Vec<u32> = Vec::new();
            for part in words.split(',') {
                let (digits, count) = match part.split_once('*') {
                    Some((digits, count)) => (digits, count.parse().ok().filter(|n| (1..=MOST).contains(n))),
                    None => (part, Some(1)),
                };
                let not_a_count = || RegressionError::NotAWord { at: place(part), found: part.to_owned() };
                let count = count.filter(|count| count + all.len() <= MOST).ok_or_else(not_a_count)?;
                all.extend(std::iter::repeat_n(word(digits)?, count));
            }
            inputs.push((name.to_owned(), all));
        }
        if inputs.is_empty() {
            return Err(RegressionError::NoInputs { at: place(suite), suite: suite.to_owned() });
        }
        regressions.push(Regression { suite: suite.to_owned(), inputs, at: place(suite) });
    }
    Ok(regressions)
}

/// The text of a regression file with failing samples added. What `existing` holds is kept byte for
/// byte; samples that it holds already are not added again. `existing` is empty for a new file.
///
/// # Errors
/// A malformed line in `existing`: it is for the user to repair, and nothing is written over it.
pub fn append(existing: &SourceFile, suite: &str, samples: &[Sample]) -> Result<String, RegressionError> {
    let mut known = parse(existing)?;
    let mut text = existing.text().to_owned();
    for sample in samples {
        let new = Regression::new(suite, sample);
        let same = |old: &Regression| {
            old.suite == new.suite
                && old.inputs.len() == new.inputs.len()
                && new.inputs.iter().all(|input| old.inputs.contains(input))
        };
        if known.iter().any(same) {
            continue;
        }
        if text.is_empty() {
            text.push_str(HEADER);
        } else if !text.ends_with(['\n', '\r']) {
            text.push('\n');
        }
        text.push_str(&line(suite, sample));
        text.push('\n');
        known.push(new);
    }
    Ok(text)
}

/// One case as a line, without a line break.
fn line(suite: &str, sample: &Sample) -> String {
    let (mut bits, mut comment) = (suite.to_owned(), String::new());
    for (record, words) in sides(sample) {
        for (i, field) in record.fields().iter().enumerate() {
            let words = &words[record.range(i)];
            let runs = |shown: &dyn Fn(u32) -> String| -> Vec<String> {
                let of = |run: &[u32]| match run.len() {
                    LONG.. => vec![format!("{}*{}", shown(run[0]), run.len())],
                    _ => run.iter().map(|&word| shown(word)).collect(),
                };
                words.chunk_by(|a, b| a == b).flat_map(of).collect()
            };
            bits.push_str(&format!(" {}={}", field.name, runs(&|word| format!("{word:08x}")).join(",")));
            let values = runs(&|word| decimal(word, field.shape.scalar));
            let (open, close) = if words.len() == 1 { ("", "") } else { ("(", ")") };
            comment.push_str(&format!(" {}={open}{}{close}", field.name, values.join(", ")));
        }
    }
    format!("{bits} #{comment}")
}

/// The inputs of a sample as `name=words` parts, as a line of a regression file has them.
pub fn inputs_text(sample: &Sample) -> String {
    let line = line("", sample);
    line.split('#').next().unwrap_or_default().trim().to_owned()
}

/// A word as people read it.
pub fn decimal(word: u32, scalar: Scalar) -> String {
    match scalar {
        Scalar::F32 => F32Bits(word).to_string(),
        Scalar::I32 => (word as i32).to_string(),
        Scalar::U32 => word.to_string(),
        Scalar::Bool => (word != 0).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::value::Field;

    fn record(fields: &[(&str, Shape)]) -> Arc<Record> {
        let field = |&(name, shape): &(&str, Shape)| Field { name: name.into(), shape };
        Arc::new(Record::new(fields.iter().map(field).collect()))
    }

    fn sample(t: f32) -> Sample {
        let (invocation, case) = (record(&[("p", Shape::VEC2)]), record(&[("t", Shape::FLOAT), ("n", Shape::INT)]));
        Sample {
            invocation_record: invocation,
            case_record: case,
            invocation: vec![1f32.to_bits(), f32::NAN.to_bits() | 5],
            case: vec![t.to_bits(), -3i32 as u32],
        }
    }

    fn file(text: &str) -> SourceFile {
        SourceFile::new("morph.regressions", text)
    }

    #[test]
    fn samples_read_back_with_all_their_bits() {
        let samples = [sample(0.5), sample(-0.0)];
        let text = append(&file(""), "morph", &samples).unwrap();
        assert!(text.starts_with("# "));
        assert!(text.contains("morph t=3f000000 n=fffffffd p=3f800000,7fc00005 # t=0.5 n=-3 p=(1.0, nan"), "{text}");
        let read = parse(&file(&text)).unwrap();
        let back = |r: &Regression| r.to_sample(&samples[0].invocation_record, &samples[0].case_record).unwrap();
        assert_eq!(read.iter().map(back).collect::<Vec<_>>(), samples);
        assert_eq!(read[1].at, "morph.regressions:4:1");
    }

    #[test]
    fn equal_words_in_a_row_are_one_with_their_number() {
        let record = record(&[("keys", Shape::vector(Scalar::U32, 1).array_of(97))]);
        let mut words = vec![0; 97];
        words[26] = 9;
        let none = Arc::new(Record::new(Vec::new()));
        let sample = Sample {
            invocation_record: record.clone(),
            case_record: none.clone(),
            invocation: words,
            case: Vec::new(),
        };
        assert_eq!(inputs_text(&sample), "keys=00000000*26,00000009,00000000*70");
        let line = line("s", &sample);
        assert!(line.ends_with("# keys=(0*26, 9, 0*70)"), "{line}");
        let read = parse(&file(&line)).unwrap()[0].to_sample(&record, &none).unwrap();
        assert_eq!(read.invocation, sample.invocation);
        for wrong in ["00000000*0", "00000000*x", "00000000*99999999999", "*3"] {
            let error = parse(&file(&format!("s keys={wrong}"))).unwrap_err();
            assert!(matches!(error, RegressionError::NotAWord { .. }), "{wrong}: {error}");
        }
    }

    #[test]
    fn appending_keeps_what_the_user_wrote_and_adds_no_case_twice() {
        let own = "# mine: 球\r\n\r\nother a=00000000";
        let text = append(&file(own), "morph", &[sample(0.5), sample(0.5)]).unwrap();
        assert!(text.starts_with(&format!("{own}\n")));
        assert_eq!(text.lines().count(), 4);
        assert_eq!(append(&file(&text), "morph", &[sample(0.5)]).unwrap(), text);
        // The same inputs under another suite are another case.
        assert_ne!(append(&file(&text), "joints", &[sample(0.5)]).unwrap(), text);
    }

    #[test]
    fn malformed_lines_are_named_by_line_and_column() {
        for (text, message) in [
            ("# ok\nmorph t=3f00", "morph.regressions:2:9: `3f00` is not a 32-bit word"),
            ("morph t=3f000000,+f000000", "morph.regressions:1:18: `+f000000` is not a 32-bit word"),
            ("morph t", "morph.regressions:1:7: expected `name=`"),
            ("morph =3f000000", "morph.regressions:1:7: expected `name=`"),
            ("\n\nmorph # t=3f000000", "morph.regressions:3:1: the case of suite `morph` has no inputs"),
            ("morph t=3f000000 t=3f000000", "morph.regressions:1:18: input `t` is given twice"),
        ] {
            let error = parse(&file(text)).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
            assert_eq!(append(&file(text), "morph", &[sample(1.0)]).unwrap_err().to_string(), error);
        }
    }

    #[test]
    fn inputs_that_do_not_fit_the_shader_are_refused() {
        let s = sample(1.0);
        let read = |text: &str| {
            let regressions = parse(&file(text)).unwrap();
            regressions[0].to_sample(&s.invocation_record, &s.case_record).unwrap_err().to_string()
        };
        assert!(read("m t=00000000 n=00000000").contains("1:1: input `p` (vec2) of the shader is missing"));
        assert!(read("m t=00000000,00000000").contains("input `t` (float) has 1 words, not 2"));
        assert!(read("m T=00000000").contains("no input `T`; did you mean `t`?"));
    }
}
