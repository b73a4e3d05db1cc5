//! The same property with inputs from another source: compilers fold constants, and load uniforms,
//! storage and attributes each in a way of its own.

use super::part::{Part, Terms};
use super::trial::{Trial, stage_of, weight};
use super::{Prepared, Request, Share, finding, relate, sampling, undefined};
use base::value::{Batch, Scalar, ulp_distance};
use lanes::{Actual, Lane, LaneError};
use program::InputSource;
use property::{Sample, Sampler};

/// Most samples as constants: each is compiled.
const CONSTANTS: u64 = 64;
/// Fewest samples as constants, of shaders that take long to compile.
const FEW_CONSTANTS: u64 = 8;
/// Expressions that are compiled for these samples.
const COMPILED: usize = 1 << 14;
/// Most samples as uniforms: each is a dispatch.
const UNIFORMS: u64 = 4096;
/// Most samples as attributes of what is no vertex stage.
const ATTRIBUTES: u64 = 16384;
/// Samples for which each relation is checked.
const RELATED: u64 = 96;
/// Samples whose outputs are compared with those of inputs in storage.
const COMPARED: u64 = 256;

/// How outputs differ in bits from those of the same inputs in storage. Within the bounds that is no
/// fault.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Apart {
    /// Samples that were compared.
    pub samples: u64,
    /// Samples with other bits, all NaN being alike.
    pub different: u64,
    /// Largest distance between two numbers, in ULP.
    pub ulp: f64,
    /// The component where that is; empty where there is none.
    pub component: String,
}

/// Runs a part of a suite with inputs from a source, as [`run_part`](super::run_part) does.
pub(super) fn part(
    prepared: &Prepared,
    lane: &dyn Lane,
    source: InputSource,
    request: &Request,
    share: Share<'_>,
    progress: &mut dyn FnMut(u64),
) -> Result<Option<Part>, LaneError> {
    let way = (stage_of(source), Some(source));
    let mut part = match source {
        InputSource::Storage => return super::run_default(prepared, lane, way, request, share, progress),
        InputSource::Attributes if prepared.vertex.is_some() => {
            super::run_default(prepared, lane, way, request, share, progress)?
        }
        InputSource::Attributes | InputSource::Uniforms | InputSource::Constants => {
            other(prepared, lane, source, request, share, progress)?
        }
    };
    if let Some(part) = part.as_mut().filter(|part| part.has_seen()) {
        part.apart = apart(prepared, lane, source, request)?;
    }
    Ok(part)
}

/// Most samples of a source beside those of the usual run.
pub fn most(prepared: &Prepared, source: InputSource) -> u64 {
    match source {
        InputSource::Constants => ((COMPILED / weight(&prepared.program)) as u64).clamp(FEW_CONSTANTS, CONSTANTS),
        InputSource::Uniforms => UNIFORMS,
        InputSource::Attributes => ATTRIBUTES,
        InputSource::Storage => u64::MAX,
    }
}

fn other(
    prepared: &Prepared,
    lane: &dyn Lane,
    source: InputSource,
    request: &Request,
    mut share: Share<'_>,
    progress: &mut dyn FnMut(u64),
) -> Result<Option<Part>, LaneError> {
    let (name, way) = (lane.description().name, (stage_of(source), Some(source)));
    let mut part = Part::new(prepared, name, way, 0);
    let makes_samples = prepared.plan.makes_samples();
    let all = if makes_samples { request.samples_of(&prepared.suite) } else { prepared.rows.len() as u64 };
    let wanted = all.min(most(prepared, source));
    if prepared.compute.output.is_empty() {
        return Ok(Some(Part::new(prepared, name, way, wanted).because(super::NO_OUTPUT.to_owned())));
    }
    let mut trial = match Trial::from_source(prepared, lane, source, &request.promises, wanted as usize) {
        Ok(trial) => trial,
        Err(LaneError::Unsupported(why)) => {
            return Ok(Some(Part::new(prepared, name, way, wanted).because(base::text::printable(&why))));
        }
        Err(error) => return Err(error),
    };
    let given = request.replay.len() as u64;
    part.replayed = given;
    let mut counted = sampling::replay(&mut trial, &request.replay, 0)?;
    if !request.replay_only {
        let rows = &prepared.rows[..prepared.rows.len().min(wanted as usize)];
        counted.join(sampling::replay(&mut trial, rows, given)?);
        if makes_samples {
            let before = given + rows.len() as u64;
            let sampled = sampling::sample(&mut trial, request, (wanted, before), &mut share, progress)?;
            let Some(sampled) = sampled else { return Ok(None) };
            counted.join(sampled);
        }
    }
    // How tight the bounds are is told of the usual run.
    counted.survey = None;
    let related = if source == InputSource::Constants { (wanted / 16).clamp(1, 4) } else { RELATED };
    relate::check(&mut trial, request, related, &mut part)?;
    let shown = [
        finding::deviations(&mut trial, lane, &counted.failing, request, &part)?,
        undefined::findings((prepared, trial.fenced()), &counted.undefined, request, &part),
    ];
    // A handful of samples need not keep the shares of a whole run; but something has to be judged.
    let terms = Terms { least: wanted.min(1), undetermined: 1.0, makes_samples, replay_only: request.replay_only };
    Ok(Some(part.end(counted, (shown, Vec::new()), Some(terms))))
}

/// Compares the outputs with those of the same inputs in storage.
fn apart(
    prepared: &Prepared,
    lane: &dyn Lane,
    source: InputSource,
    request: &Request,
) -> Result<Option<Apart>, LaneError> {
    let count = COMPARED.min(most(prepared, source)).min(request.samples_of(&prepared.suite));
    let samples: Vec<Sample> = if request.replay_only {
        request.replay.clone()
    } else if prepared.plan.makes_samples() {
        let batch = Sampler::new(prepared.plan.clone(), request.seed).batch(0, count as usize, 1);
        (0..batch.invocation_count()).map(|i| Sample::of(&batch, i)).collect()
    } else {
        prepared.rows.iter().take(count as usize).cloned().collect()
    };
    if samples.is_empty() {
        return Ok(None);
    }
    let most = samples.len();
    let mut here = Trial::from_source(prepared, lane, source, &request.promises, most)?;
    let mut storage = Trial::from_source(prepared, lane, InputSource::Storage, &request.promises, here.capacity())?;
    let mut found = Apart::default();
    let size = here.capacity().min(storage.capacity()).max(1);
    for chunk in samples.chunks(size) {
        let batch = Sample::batch(chunk);
        compare(&batch, &here.run(&batch)?, &storage.run(&batch)?, &mut found);
    }
    Ok(Some(found))
}

fn compare(batch: &Batch, here: &Actual, storage: &Actual, found: &mut Apart) {
    let record = &here.layout().vertex;
    for i in (0..batch.invocation_count()).filter(|&i| !here.is_absent(i) && !storage.is_absent(i)) {
        found.samples += 1;
        let shape =
            |a: &Actual| (a.emitted(i), a.ended_strips(i), (0..a.stored(i)).map(|v| a.strip(i, v)).collect::<Vec<_>>());
        let mut different = shape(here) != shape(storage);
        for vertex in 0..here.stored(i).min(storage.stored(i)) {
            for (word, (&a, &b)) in here.vertex(i, vertex).iter().zip(storage.vertex(i, vertex)).enumerate() {
                let float = record.scalar_of(word) == Scalar::F32;
                let nan = |w: u32| float && f32::from_bits(w).is_nan();
                // Words that nobody wrote differ from run to run.
                if a == b || (nan(a) && nan(b)) {
                    continue;
                }
                different = true;
                let ulp = if float {
                    let ulp = ulp_distance(f64::from(f32::from_bits(b)), f32::from_bits(a));
                    if ulp.is_nan() { f64::INFINITY } else { ulp }
                } else {
                    f64::INFINITY
                };
                if ulp > found.ulp {
                    (found.ulp, found.component) = (ulp, record.word_name(word));
                }
            }
        }
        found.different += u64::from(different);
    }
}
