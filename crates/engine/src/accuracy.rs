//! How far a device that keeps a profile may be off in a function at worst, and which of its operations bring that about.

use crate::InputValue;
use crate::fuzz::{Domain, Subject, place, stream_key};
use base::value::{Scalar, ulp_at};
use judge::profile::Profile;
use judge::verdict::diagnosis::Place;
use judge::verdict::{ENDLESS, Limiter, Limits, Oracle};
use lanes::Stage;
use program::interp::SLOTS;
use property::Sample;
use rayon::prelude::*;

/// Operations are looked at whose error is more than this part of their size: 1 ULP of binary32.
const LEAST: f64 = f32::EPSILON as f64;

/// Steps from there, each to twice the error: up to errors as large as the value.
const STEPS: i32 = 24;

/// An operation loses bits where it enlarges relative errors of its arguments that often: three bits.
const LOSS: f64 = 8.0;

/// An ULP is taken to be this at least. Devices may flush smaller numbers to zero, which is no loss of digits.
const LEAST_ULP: f64 = f32::MIN_POSITIVE as f64;

/// Bounds up to here are what may be flushed on the way, by as many operations as a shader has.
const FLUSHED: f64 = 1024.0 * LEAST_ULP;

/// Chunks that one machine does at least.
const CHUNKS: usize = 8;

/// What is known of the outputs of a function.
#[derive(Clone, Debug)]
pub struct Accuracy {
    /// Inputs that were looked at.
    pub samples: u64,
    /// Those for which something bounds every output.
    pub bounded: u64,
    /// Where the bound is widest; none where nothing is bounded.
    pub worst: Option<Worst>,
}

/// The inputs at which a device may be farthest off, in ULP.
#[derive(Clone, Debug)]
pub struct Worst {
    /// The inputs.
    pub inputs: Vec<InputValue>,
    /// How far a device may be off there, in ULP of the output's largest component.
    pub ulp: f64,
    /// The operation that enlarges relative errors of its arguments most, and how often; none where each keeps its bits.
    pub loses: Option<(Place, f64)>,
    /// The operation whose own error is the largest part of the bound, and that part.
    pub most: Option<(Place, f64)>,
}

/// An output variable of a sample with the widest bound in ULP: its word and the sample.
#[derive(Clone, Copy)]
struct Widest {
    ulp: f64,
    word: usize,
    sample: usize,
}

/// Looks at `samples` inputs as a program would give them.
///
/// # Errors
/// Why the function cannot be run.
pub fn accuracy(
    subject: &Subject,
    domain: &Domain,
    profile: &Profile,
    samples: usize,
    seed: u64,
) -> Result<Accuracy, String> {
    let ready = subject.ready.as_ref().map_err(Clone::clone)?;
    let oracle = Oracle::new(&ready.program).map_err(|error| error.locate(&ready.program))?.with_fuel(ENDLESS);
    let records = (&ready.kernel.invocation, &ready.kernel.case);
    let constant = records.0.words() + records.1.words() == 0;
    let count = if constant { 1 } else { samples };
    let key = stream_key(seed, &subject.label);
    let batch = ready.realistic.batch(records, domain, key, 0, count);
    let record = &ready.kernel.output.vertex;
    let variables: Vec<_> = (0..record.fields().len()).map(|k| record.range(k)).collect();
    let reals: Vec<_> = variables.into_iter().filter(|range| record.scalar_of(range.start) == Scalar::F32).collect();
    let look = |limiter: &mut Limiter<'_>, limits: &mut Limits, chunk: usize| -> (u64, Option<Widest>) {
        limiter.look(&batch, chunk * SLOTS, limits);
        let (mut bounded, mut widest): (u64, Option<Widest>) = (0, None);
        for slot in (0..limits.slots).filter(|slot| limits.reasons[*slot].is_none()) {
            bounded += 1;
            for range in &reals {
                let at = |word: usize| word * SLOTS + slot;
                let size = range.clone().fold(0.0_f64, |size, word| size.max(limits.values[at(word)].abs()));
                let Some(word) = range.clone().max_by(|a, b| limits.bounds[at(*a)].total_cmp(&limits.bounds[at(*b)]))
                else {
                    continue;
                };
                let ulp = limits.bounds[at(word)] / ulp_at(size).max(LEAST_ULP);
                if widest.is_none_or(|known| ulp > known.ulp) {
                    widest = Some(Widest { ulp, word, sample: chunk * SLOTS + slot });
                }
            }
        }
        (bounded, widest)
    };
    let new = || (Limiter::new(&oracle, profile, Stage::Compute), Limits::default());
    let chunks: Vec<(u64, Option<Widest>)> = (0..batch.invocation_count().div_ceil(SLOTS))
        .into_par_iter()
        .with_min_len(CHUNKS)
        .map_init(new, |(limiter, limits), chunk| look(limiter, limits, chunk))
        .collect();
    let widest = chunks.iter().filter_map(|(_, widest)| *widest).max_by(|a, b| a.ulp.total_cmp(&b.ulp));
    let worst = widest.map(|Widest { ulp, word, sample }| {
        let (mut limiter, mut limits) = new();
        limiter.look(&batch, sample / SLOTS * SLOTS, &mut limits);
        let slot = sample % SLOTS;
        let stands = |site| place(&ready.program, oracle.executable(), site);
        // A weak promise is no loss: `cos` of any number is off by 2⁻¹¹, and loses nothing by itself.
        let passed = (0..STEPS).filter_map(|step| limiter.culprit((0, word), slot, LEAST * 2f64.powi(step)));
        let bound = limits.bounds[word * SLOTS + slot];
        let loses = passed.filter(|(_, condition)| *condition >= LOSS && bound > FLUSHED);
        let loses = loses.max_by(|a, b| a.1.total_cmp(&b.1));
        let most = limiter.shares((0, word), slot, 1).pop();
        Worst {
            inputs: InputValue::all(&Sample::of(&batch, sample), &ready.program),
            ulp,
            loses: loses.and_then(|(cause, condition)| Some((stands(cause.site)?, condition))),
            most: most.and_then(|share| Some((stands(share.site)?, share.share / bound))),
        }
    });
    Ok(Accuracy { samples: batch.invocation_count() as u64, bounded: chunks.iter().map(|(n, _)| n).sum(), worst })
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;
    use syntax::{Shader, Stage as ShaderStage};

    fn worst(body: &str) -> Worst {
        let text = format!("#version 450\n// shadercheck: x in [0.001, 1]\nfloat f(float x)\n{{\n  {body}\n}}\n");
        let parsed = Shader::parse(&SourceFile::new("f.glsl", text), ShaderStage::Library);
        let subjects = crate::fuzz::subjects(&parsed.shader, &|_| true).unwrap();
        let subject = &subjects[0];
        let ready = subject.ready.as_ref().unwrap();
        let fields = (ready.kernel.invocation.fields(), ready.kernel.case.fields());
        let domain = Domain::new("f", fields.0, fields.1, &subject.stated);
        let profile = judge::profile::by_name("vulkan-1.4").unwrap();
        let found = accuracy(subject, &domain, profile, 1 << 10, 7).unwrap();
        assert_eq!(found.bounded, found.samples);
        found.worst.unwrap()
    }

    #[test]
    fn the_operation_that_loses_the_bits_is_named() {
        let found = worst("return 1.0 - cos(x);");
        let (place, condition) = found.loses.clone().unwrap();
        assert_eq!(place.text, "1.0 - cos(x)");
        assert!(condition > 1e3 && found.ulp > 1e4, "{found:?}");
        let (place, part) = found.most.unwrap();
        assert!(place.text == "cos(x)" && part > 0.9 && part <= 1.0, "{place} {part}");
    }

    #[test]
    fn a_zero_that_may_be_flushed_or_is_exact_loses_no_digits() {
        // `floor(x)` is 1 at `x = 1` and 0 elsewhere: each body gives 0 at some inputs, exactly.
        for body in ["return 1.0 - floor(x);", "return 4.0 * floor(x);"] {
            let found = worst(body);
            assert!(found.loses.is_none() && found.ulp < 16.0, "{body}: {found:?}");
        }
    }

    #[test]
    fn sums_of_like_signs_lose_none() {
        let found = worst("return x * x + 2.0 * x;");
        assert!(found.loses.is_none() && found.ulp < 4.0, "{found:?}");
    }
}
