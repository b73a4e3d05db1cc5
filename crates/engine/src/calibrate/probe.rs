//! What a device does with subnormal numbers, with products and sums, with the order of the source,
//! and how it rounds.

use base::text::SourceFile;
use base::value::Batch;
use judge::profile::Flush;
use lanes::{Actual, Lane, LaneError, Stage};
use program::lower::Target;
use program::{Kernel, Program, ProgramError};

use super::CalibrateError;
use judge::single::kernel::program;

/// One shader for both stages. The operands come in as attributes, so that no compiler knows them.
const TEXT: &str = "#version 400
layout(location = 0) in vec4 tiny;
layout(location = 1) in vec4 product;
layout(location = 2) in vec4 sums;
layout(location = 3) in vec4 order;
out vec4 results;
out vec4 arguments;
out vec4 fused;
out vec4 rounded;
out vec4 ordered;
void main() {
    float least = tiny.x, half_ = tiny.y, subnormal = tiny.z, big = tiny.w;
    results = vec4(least * half_, least - (least + least * half_), (least / big) * 1.0, least * least);
    arguments = vec4(subnormal * big, subnormal + least, subnormal / half_, subnormal * big - least);
    fused = vec4(fma(product.x, product.y, product.z), product.x * product.y + product.z, 0.0, 0.0);
    rounded = vec4(sums.x + sums.y, sums.x + sums.z, -sums.x - sums.y, (sums.x + sums.w) + sums.z);
    float one = order.x, small = order.y, large = order.z;
    ordered = vec4((one + small) - one, (small + 1.0) + -1.0, (large * 1.2676506e30) * 7.8886091e-31,
        product.x * product.y + product.x * -one);
    gl_Position = vec4(0.0);
}
";

/// How a device treats a product with a sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fusion {
    /// `fma(x, y, z)` has one rounding.
    pub fma: bool,
    /// `x*y + z` has one rounding.
    pub expression: bool,
}

/// Behaviour of one stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Behaviour {
    /// Subnormal results of arithmetic.
    pub results: Flush,
    /// Subnormal arguments of arithmetic.
    pub arguments: Flush,
    /// Products with sums.
    pub fusion: Fusion,
    /// Sums are rounded to nearest, ties to even.
    pub nearest_even: bool,
    /// A sum, a product or a common factor was computed in another order than the source has.
    pub reordered: bool,
}

impl Behaviour {
    /// Results and arguments together.
    pub fn flush(&self) -> Flush {
        if self.results == self.arguments { self.results } else { Flush::May }
    }
}

/// Runs the probe in a stage.
///
/// # Errors
/// [`CalibrateError`] when the lane cannot run it.
pub fn probe(lane: &dyn Lane, stage: Stage) -> Result<Behaviour, CalibrateError> {
    match probe_text(lane, stage, TEXT) {
        // A device without `fma` has one or two roundings where a shader writes a product and a sum.
        Err(CalibrateError::Lane(LaneError::Unsupported(_))) => {
            let text = TEXT.replace("#version 400", "#version 330");
            let text = text.replace("fma(product.x, product.y, product.z)", "product.x * product.y + product.z");
            probe_text(lane, stage, &text)
        }
        other => other,
    }
}

fn probe_text(lane: &dyn Lane, stage: Stage, text: &str) -> Result<Behaviour, CalibrateError> {
    let file = SourceFile::new("calibrate-probe.vert", text);
    let program = program(&file, syntax::Stage::Vertex, &Target::Stage)?;
    let kernel = kernel_of(&program, stage)?;
    let mut batch = Batch::with_capacity(kernel.invocation.clone(), kernel.case.clone(), 1, 1);
    batch.invocations = operands().map(f32::to_bits).to_vec();
    let actual = lane.prepare(&kernel, 1)?.run(&batch)?;
    judge(&ProbeOutputs::new(&actual)?)
}

fn kernel_of(program: &Program, stage: Stage) -> Result<Kernel, ProgramError> {
    match stage {
        Stage::Compute => program.compute_kernel(),
        Stage::Vertex => program.vertex_kernel(&[4, 4, 4, 4]),
        Stage::Geometry => program.geometry_kernel(),
    }
}

/// The four attributes.
fn operands() -> [f32; 16] {
    let least = f32::MIN_POSITIVE;
    let product = 1.0 + 2f32.powi(-12);
    let (gap, half_gap) = (f32::EPSILON, f32::EPSILON / 2.0);
    [
        least,
        0.5,
        least / 2.0,
        4.0,
        // (1 + 2^-12)² − (1 + 2^-11) is 2^-24 in one rounding, and 0 in two.
        product,
        product,
        -(1.0 + 2f32.powi(-11)),
        0.0,
        // Three quarters of a gap and half a gap above 1, and half a gap above the odd 1 + gap.
        1.0,
        0.75 * gap,
        half_gap,
        gap,
        // 1 + 2^-25 is 1, and 2^100·2^100 is infinite, if each is computed before what follows.
        1.0,
        2f32.powi(-25),
        2f32.powi(100),
        0.0,
    ]
}

/// The output vectors.
struct ProbeOutputs {
    results: [f32; 4],
    arguments: [f32; 4],
    fused: [f32; 4],
    rounded: [f32; 4],
    ordered: [f32; 4],
}

impl ProbeOutputs {
    fn new(actual: &Actual) -> Result<Self, CalibrateError> {
        let record = &actual.layout().vertex;
        let words = actual.vertex(0, 0);
        let vector = |name: &str| {
            let at = record.index_of(name).map(|k| record.range(k)).filter(|r| r.len() == 4);
            let at = at.ok_or_else(|| ProgramError::Internal(format!("the probe has no output `{name}`")))?;
            Ok::<_, ProgramError>(std::array::from_fn(|k| f32::from_bits(words[at.start + k])))
        };
        Ok(Self {
            results: vector("results")?,
            arguments: vector("arguments")?,
            fused: vector("fused")?,
            rounded: vector("rounded")?,
            ordered: vector("ordered")?,
        })
    }
}

fn judge(outputs: &ProbeOutputs) -> Result<Behaviour, CalibrateError> {
    let least = f32::MIN_POSITIVE;
    let result = |found: f32, kept: f32| one(found, kept, 0.0, "a subnormal result");
    // The second difference needs both a kept result and a kept argument, and shows neither alone.
    let results = [result(outputs.results[0], least / 2.0)?, result(outputs.results[2], least / 4.0)?];
    let argument = |found: f32, kept: f32, flushed: f32| one(found, kept, flushed, "a subnormal argument");
    let arguments = [
        argument(outputs.arguments[0], 2.0 * least, 0.0)?,
        argument(outputs.arguments[1], 1.5 * least, least)?,
        argument(outputs.arguments[2], least, 0.0)?,
    ];
    let fusion = |found: f32| match found {
        0.0 => Ok(false),
        _ if found == 2f32.powi(-24) => Ok(true),
        other => Err(CalibrateError::Odd { what: "a product with a sum", found: other }),
    };
    // In the order of the source, and rearranged. With one rounding for a product and a sum, a common
    // factor cannot be told from a fused product: then the order counts as not kept.
    let orders = [
        (0.0, 2f32.powi(-25)),
        (0.0, 2f32.powi(-25)),
        (f32::INFINITY, 2f32.powi(100)),
        (2f32.powi(-12), 2f32.powi(-12) + 2f32.powi(-24)),
    ];
    let mut reordered = false;
    for (found, (kept, rearranged)) in outputs.ordered.into_iter().zip(orders) {
        reordered |= !one(found, kept, rearranged, "the order of a sum or product")?;
    }
    let gap = f32::EPSILON;
    Ok(Behaviour {
        reordered,
        results: all(&results),
        arguments: all(&arguments),
        fusion: Fusion { fma: fusion(outputs.fused[0])?, expression: fusion(outputs.fused[1])? },
        nearest_even: outputs.rounded == [1.0 + gap, 1.0, -1.0 - gap, 1.0 + 2.0 * gap],
    })
}

/// True for a kept number or order, false for a changed one.
fn one(found: f32, kept: f32, changed: f32, what: &'static str) -> Result<bool, CalibrateError> {
    if found == kept {
        Ok(true)
    } else if found == changed {
        Ok(false)
    } else {
        Err(CalibrateError::Odd { what, found })
    }
}

fn all(kept: &[bool]) -> Flush {
    match (kept.iter().all(|k| *k), kept.iter().any(|k| *k)) {
        (true, _) => Flush::Never,
        (false, false) => Flush::Must,
        (false, true) => Flush::May,
    }
}

impl From<ProgramError> for CalibrateError {
    fn from(source: ProgramError) -> Self {
        Self::Program(source)
    }
}

impl From<LaneError> for CalibrateError {
    fn from(source: LaneError) -> Self {
        Self::Lane(source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a device gives that keeps subnormal numbers, fuses nothing and rounds to nearest.
    fn plain() -> ProbeOutputs {
        let least = f32::MIN_POSITIVE;
        let gap = f32::EPSILON;
        ProbeOutputs {
            results: [least / 2.0, -least / 2.0, least / 4.0, 0.0],
            arguments: [2.0 * least, 1.5 * least, least, least],
            fused: [0.0; 4],
            rounded: [1.0 + gap, 1.0, -1.0 - gap, 1.0 + 2.0 * gap],
            ordered: [0.0, 0.0, f32::INFINITY, 2f32.powi(-12)],
        }
    }

    #[test]
    fn the_host_is_plain() {
        let [least, half, subnormal, big, x, y, z, _, one, three_quarters, half_gap, gap, _, small, large, _] =
            operands().map(std::hint::black_box);
        let factor = 2f32.powi(100);
        let outputs = ProbeOutputs {
            results: [least * half, 0.0, least / big, 0.0],
            arguments: [subnormal * big, subnormal + least, subnormal / half, 0.0],
            fused: [x.mul_add(y, z), x * y + z, 0.0, 0.0],
            rounded: [one + three_quarters, one + half_gap, -one - three_quarters, (one + gap) + half_gap],
            ordered: [(one + small) - one, (small + 1.0) - 1.0, (large * factor) / factor, x * y + x * -one],
        };
        let behaviour = judge(&outputs).unwrap();
        assert_eq!((behaviour.flush(), behaviour.nearest_even, behaviour.reordered), (Flush::Never, true, false));
        assert_eq!(behaviour.fusion, Fusion { fma: true, expression: false });
    }

    #[test]
    fn each_deviation_from_plain_shows() {
        assert_eq!(judge(&plain()).unwrap().flush(), Flush::Never);
        let mut flushing = plain();
        (flushing.results, flushing.arguments) = ([0.0; 4], [0.0, f32::MIN_POSITIVE, 0.0, 0.0]);
        let behaviour = judge(&flushing).unwrap();
        assert_eq!(
            (behaviour.results, behaviour.arguments, behaviour.flush()),
            (Flush::Must, Flush::Must, Flush::Must)
        );
        let mut by_operation = plain();
        by_operation.results[2] = 0.0;
        assert_eq!(judge(&by_operation).unwrap().results, Flush::May);
        let mut fused = plain();
        fused.fused[1] = 2f32.powi(-24);
        assert_eq!(judge(&fused).unwrap().fusion, Fusion { fma: false, expression: true });
        let mut truncating = plain();
        truncating.rounded[0] = 1.0;
        assert!(!judge(&truncating).unwrap().nearest_even);
        let orders = [2f32.powi(-25), 2f32.powi(-25), 2f32.powi(100), 2f32.powi(-12) + 2f32.powi(-24)];
        for (k, rearranged) in orders.into_iter().enumerate() {
            let mut reordered = plain();
            reordered.ordered[k] = rearranged;
            assert!(judge(&reordered).unwrap().reordered, "{k}");
        }
        assert!(!judge(&plain()).unwrap().reordered);
    }

    #[test]
    fn what_no_device_should_give_is_an_error() {
        let mut odd = plain();
        odd.arguments[0] = 1.0;
        assert!(matches!(judge(&odd), Err(CalibrateError::Odd { what: "a subnormal argument", .. })));
        let mut nan = plain();
        nan.fused[0] = f32::NAN;
        assert!(judge(&nan).is_err());
        let mut lost = plain();
        lost.ordered[3] = 0.0;
        assert!(matches!(judge(&lost), Err(CalibrateError::Odd { what: "the order of a sum or product", .. })));
    }
}
