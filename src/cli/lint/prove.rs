//! `--prove`: how far repairs move what a shader computes. The text before and after is run on the
//! same inputs in strict binary32.

use base::diagnostic::{Lang, message};
use base::text::SourceFile;
use base::value::{Batch, Record, Scalar, ulp_distance};
use hosts::{Language, language_of};
use lanes::{Actual, LaneError, embedded};
use lint::Config;
use lint::fix::FixedFile;
use program::lower::Target;
use program::{Kernel, Program, ProgramError};
use property::Stream;
use property::generators::Range;
use syntax::{Shader, Stage};

/// Inputs of a comparison: sets of uniforms, and invocations with each of them.
const CASES: usize = 256;
const PER_CASE: usize = 16;
/// Range of floating-point inputs when the configuration says nothing.
const RANGE: (f64, f64) = (-2.0, 2.0);
/// One in so many inputs is a special value: an end of the range, a zero, a power of two.
const SPECIAL: usize = 8;
/// Whole numbers are below this: they mostly count or choose.
const WHOLE: usize = 8;

/// How far one output moved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moved {
    /// Name of the output.
    pub output: String,
    /// Invocations in which it differs.
    pub differing: usize,
    /// Largest difference of numbers.
    pub most: f64,
    /// The same in ULP of the value before.
    pub most_ulp: f64,
    /// Components that are NaN or infinite on one side alone.
    pub not_finite: usize,
}

/// What came out for a stage or a function.
#[derive(Clone, Debug, PartialEq)]
pub enum Proof {
    /// Both were run on so many samples.
    Compared {
        /// Samples.
        samples: usize,
        /// Output by output.
        outputs: Vec<Moved>,
        /// Invocations that emit another number of vertices.
        reshaped: usize,
    },
    /// The text before did not compile, so that there is nothing to compare with.
    New,
    /// It could not be run.
    NotRun(String),
}

/// Compares what a file computes before and after; by the name of the function, for function libraries.
/// Host files have nothing to run.
pub fn prove(file: &FixedFile, config: &Config) -> Vec<(Option<String>, Proof)> {
    let Some(Language::Shader(stage)) = language_of(file.before.name()) else { return Vec::new() };
    let parsed = Shader::parse(&file.before, stage);
    if !parsed.diagnostics.is_empty() {
        return vec![(None, Proof::New)];
    }
    match stage {
        Stage::Library => {
            let names = parsed.shader.functions().map(|(_, f)| f.name.name.clone());
            names.map(|name| (Some(name.clone()), compare(file, stage, &Target::Function(name), config))).collect()
        }
        _ => vec![(None, compare(file, stage, &Target::Stage, config))],
    }
}

fn compare(file: &FixedFile, stage: Stage, target: &Target, config: &Config) -> Proof {
    let kernel = |text: &SourceFile| -> Result<Kernel, ProgramError> {
        Program::from_source(text, stage, |_| Ok(target.clone()))?.compute_kernel()
    };
    let (before, after) = match (kernel(&file.before), kernel(&file.after)) {
        (Ok(before), Ok(after)) => (before, after),
        // What only the translator refuses is no text that compiles either.
        (Err(_), Ok(_)) => return Proof::New,
        (_, Err(error)) => return Proof::NotRun(reason(&error)),
    };
    if before.invocation != after.invocation || before.case != after.case || before.output != after.output {
        return Proof::NotRun("the inputs or outputs of the shader change".to_owned());
    }
    let batch = inputs(&before, config);
    match (run(&before, &batch), run(&after, &batch)) {
        (Ok(old), Ok(new)) => judge(&old, &new),
        (Err(error), _) | (_, Err(error)) => Proof::NotRun(error.to_string()),
    }
}

fn reason(error: &ProgramError) -> String {
    match error {
        ProgramError::Source(found) if !found.is_empty() => found[0].message.to_string(),
        error => error.to_string(),
    }
}

fn run(kernel: &Kernel, batch: &Batch) -> Result<Actual, LaneError> {
    let lane = embedded::open().map_err(|error| LaneError::Unsupported(error.to_string()))?;
    lane.prepare(kernel, batch.invocation_count())?.run(batch)
}

/// The same inputs for every run of a shader.
fn inputs(kernel: &Kernel, config: &Config) -> Batch {
    let mut stream = Stream::new(0x5eed);
    let mut batch = Batch::with_capacity(kernel.invocation.clone(), kernel.case.clone(), PER_CASE, CASES);
    for _ in 0..CASES {
        fill(&kernel.case, config, &mut stream, &mut batch.cases);
        (0..PER_CASE).for_each(|_| fill(&kernel.invocation, config, &mut stream, &mut batch.invocations));
    }
    batch
}

fn fill(record: &Record, config: &Config, stream: &mut Stream, words: &mut Vec<u32>) {
    for field in record.fields() {
        let (lo, hi) = config.range_of(&field.name).unwrap_or(RANGE);
        let range = Range::new(lo, hi);
        words.extend((0..field.shape.words()).map(|_| match field.shape.scalar {
            Scalar::F32 if stream.one_in(SPECIAL) => range.special(stream.bits()).to_bits(),
            Scalar::F32 => range.ordinary(stream.bits()).to_bits(),
            Scalar::I32 | Scalar::U32 => stream.below(WHOLE) as u32,
            Scalar::Bool => u32::from(stream.one_in(2)),
        }));
    }
}

fn judge(old: &Actual, new: &Actual) -> Proof {
    let record = &old.layout().vertex;
    let blank = |name: &str| Moved { output: name.to_owned(), ..Moved::default() };
    let mut outputs: Vec<Moved> = record.fields().iter().map(|f| blank(&f.name)).collect();
    let mut reshaped = 0;
    for invocation in 0..old.count() {
        let strips = |a: &Actual| (0..a.stored(invocation)).map(|v| a.strip(invocation, v)).collect::<Vec<_>>();
        if old.emitted(invocation) != new.emitted(invocation) || strips(old) != strips(new) {
            reshaped += 1;
        }
        let vertices = old.stored(invocation).min(new.stored(invocation));
        for (index, moved) in outputs.iter_mut().enumerate() {
            let mut differs = false;
            for vertex in 0..vertices {
                let (a, b) = (old.vertex(invocation, vertex), new.vertex(invocation, vertex));
                for word in record.range(index) {
                    differs |= moved.note(a[word], b[word], record.scalar_of(word));
                }
            }
            moved.differing += usize::from(differs);
        }
    }
    Proof::Compared { samples: old.count(), outputs, reshaped }
}

impl Moved {
    /// Takes a word in; true when its two sides differ. Any NaN is as good as any other.
    fn note(&mut self, old: u32, new: u32, scalar: Scalar) -> bool {
        if old == new {
            return false;
        }
        let (a, b) = match scalar {
            Scalar::F32 => (f32::from_bits(old), f32::from_bits(new)),
            Scalar::I32 | Scalar::U32 | Scalar::Bool => {
                self.most = self.most.max((old as i32).abs_diff(new as i32).into());
                return true;
            }
        };
        if a.is_nan() && b.is_nan() {
            return false;
        }
        if !a.is_finite() || !b.is_finite() {
            self.not_finite += 1;
            return true;
        }
        self.most = self.most.max((f64::from(a) - f64::from(b)).abs());
        self.most_ulp = self.most_ulp.max(ulp_distance(f64::from(a), b));
        true
    }
}

/// The lines that tell of a comparison.
pub fn lines(name: &str, function: Option<&str>, proof: &Proof, lang: Lang) -> Vec<String> {
    let place = function.map_or_else(|| name.to_owned(), |f| format!("{name}: {f}"));
    let reported = match proof {
        Proof::New => vec![message!(
            "{place}: not compared: the text before does not compile",
            "{place}: 修正前のテキストがコンパイルできないため、比較しません"
        )],
        Proof::NotRun(why) => vec![message!("{place}: not compared: {why}", "{place}: 比較できません: {why}")],
        Proof::Compared { samples, outputs, reshaped } => {
            let mut reported: Vec<_> = outputs.iter().map(|moved| line(&place, moved, *samples)).collect();
            if *reshaped > 0 {
                reported.push(message!(
                    "{place}: other vertices or strips in {reshaped} of {samples} samples",
                    "{place}: {samples} サンプル中 {reshaped} で頂点またはストリップが変わります"
                ));
            }
            reported
        }
    };
    reported.iter().map(|t| t.in_lang(lang).to_owned()).collect()
}

fn line(place: &str, moved: &Moved, samples: usize) -> base::diagnostic::Message {
    let Moved { output, differing, most, most_ulp, not_finite } = moved;
    if *differing == 0 {
        return message!(
            "{place}: `{output}` is the same in {samples} samples",
            "{place}: `{output}` は {samples} サンプルで変わりません"
        );
    }
    message!(
        "{place}: `{output}` moves in {differing} of {samples} samples, by {most:.3e} ({most_ulp:.0} ULP) at most; {not_finite} values become finite or cease to be",
        "{place}: `{output}` は {samples} サンプル中 {differing} で変わります。最大の差は {most:.3e} ({most_ulp:.0} ULP)、有限でなくなった、または有限になった値は {not_finite} 個です"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn proof(name: &str, before: &str, after: &str) -> Vec<(Option<String>, Proof)> {
        let file = |text: &str| SourceFile::new(name, format!("#version 150 core\n{text}\n"));
        prove(&FixedFile { before: file(before), after: file(after) }, &Config::default())
    }

    fn vertex(value: &str) -> String {
        format!("in float t;\nuniform vec4 k;\nvoid main() {{ gl_Position = k * {value}; }}")
    }

    fn only(name: &str, before: &str, after: &str) -> Moved {
        match proof(name, before, after).remove(0).1 {
            Proof::Compared { samples, mut outputs, reshaped } => {
                assert_eq!((samples, outputs.len(), reshaped), (CASES * PER_CASE, 1, 0));
                outputs.remove(0)
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_means_the_same_does_not_move() {
        let moved = only("a.vert", &vertex("(t * 2.0)"), &vertex("(2.0 * t)"));
        assert_eq!(moved, Moved { output: "gl_Position".to_owned(), ..Moved::default() });
    }

    #[test]
    fn a_known_difference_has_its_size() {
        let moved = only("a.vert", &vertex("1.0"), &vertex("1.5"));
        assert_eq!((moved.most, moved.not_finite), (1.0, 0), "half of what is at most 2");
        let moved = only("a.vert", &vertex("6.283185"), &vertex("6.28318530717958648"));
        assert!(moved.differing > 3000 && moved.most < 1e-5 && (1.0..9.0).contains(&moved.most_ulp), "{moved:?}");
    }

    #[test]
    fn a_number_that_is_none_is_counted() {
        let moved = only("a.vert", &vertex("sqrt(t)"), &vertex("sqrt(abs(t))"));
        assert!(moved.not_finite > 1000 && moved.most == 0.0, "{moved:?}");
    }

    #[test]
    fn functions_of_a_library_are_compared_one_by_one() {
        let text = |c: &str| format!("float f(float x) {{ return x; }}\nfloat g(float x) {{ return x * {c}; }}");
        let all = proof("lib.glsl", &text("2.0"), &text("3.0"));
        let moved: Vec<_> = all
            .iter()
            .map(|(name, proof)| match proof {
                Proof::Compared { outputs, .. } => (name.as_deref().unwrap(), outputs[0].differing > 0),
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(moved, [("f", false), ("g", true)]);
    }

    #[test]
    fn what_cannot_be_compared_says_why() {
        assert_eq!(proof("a.vert", &vertex("vec3(1.0, 2.0, 3.0, 4.0)"), &vertex("1.0")), [(None, Proof::New)]);
        let renamed = vertex("t").replace('t', "u");
        assert!(matches!(&proof("a.vert", &vertex("t"), &renamed)[0].1, Proof::NotRun(_)));
        assert!(proof("a.cpp", "", "").is_empty());
    }
}
