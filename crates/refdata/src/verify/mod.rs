//! Anyone's outputs against a reference file: every element with its bound, without a device and without
//! the shader.

mod order;
mod outputs;
mod stream;
#[cfg(test)]
mod tests;

use std::ops::Range;

use thiserror::Error;

use super::array::{Array, Role, WordType};
use super::document::Document;
use super::flags::Flags;
use super::read::{Dataset, Table};

use order::Order;
use outputs::Outputs;
pub use stream::{StreamError, stream};

/// How outputs are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Every element has to be the nearest number, bit for bit.
    pub exact: bool,
    /// Share of the elements that may have nothing that bounds them, from 0 to 1.
    pub max_unbounded: f64,
}

/// Share of elements without a bound, at most, where nobody says otherwise.
pub const MAX_UNBOUNDED: f64 = 0.05;

impl Default for Rule {
    fn default() -> Self {
        Self { exact: false, max_unbounded: MAX_UNBOUNDED }
    }
}

/// Why outputs cannot be compared with a reference at all.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum VerifyError {
    /// No output has a known name.
    #[error("none of the outputs of the reference ({wanted}) is there; there are: {found}")]
    NoOutput {
        /// Names of the reference.
        wanted: String,
        /// Names of the outputs.
        found: String,
    },
    /// Rows of another size.
    #[error("`{name}` has {found} numbers for each sample, and the reference has {wanted}")]
    Width {
        /// The output.
        name: String,
        /// Numbers of a row.
        found: usize,
        /// Words of the reference.
        wanted: usize,
    },
    /// Columns of one file that do not go together.
    #[error("`{name}` has {rows} rows, and `{other}` has {others}")]
    Rows {
        /// A column.
        name: String,
        /// How many rows it has.
        rows: usize,
        /// Another column.
        other: String,
        /// Its rows.
        others: usize,
    },
    /// A reference without bounds.
    #[error("the reference has no bounds, as it was generated with `--profile none`; compare with --exact")]
    NoBounds,
    /// Nothing to compare.
    #[error("the reference has no samples")]
    NoSamples,
}

/// Verdict on one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within its bound, or with `exact` the nearest number.
    Agree,
    /// Farther off than its bound.
    Deviate,
    /// NaN or infinite where a finite number is expected.
    NotFinite,
    /// Nothing bounds it, or it has no value.
    Undetermined,
}

impl Verdict {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Agree => "agree",
            Self::Deviate => "deviate",
            Self::NotFinite => "not_finite",
            Self::Undetermined => "undetermined",
        }
    }
}

/// One element with both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// Number of its sample in the whole data set.
    pub sample: u64,
    /// Name, such as `gl_Position.x`.
    pub component: String,
    /// What is expected.
    pub expected: f64,
    /// The nearest number of the output's type, by its bits.
    pub nearest: u32,
    /// What there is.
    pub actual: f64,
    /// What there is, as a word of the output's type.
    pub bits: u32,
    /// How far it may be off.
    pub bound: f64,
    /// How the two sides compare.
    pub verdict: Verdict,
}

impl Element {
    /// How far it is off.
    pub fn error(&self) -> f64 {
        (self.actual - self.expected).abs()
    }

    /// The error in bounds; infinite for what is no number.
    pub fn ratio(&self) -> f64 {
        let error = self.error();
        let ratio = if error == 0.0 { 0.0 } else { error / self.bound };
        if ratio.is_nan() { f64::INFINITY } else { ratio }
    }
}

/// A case that is shown: an element with the inputs of its sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// The component that is farthest off, with both sides.
    pub element: Element,
    /// What is special about its sample.
    pub flags: Flags,
    /// Inputs: name and bits.
    pub inputs: Vec<(String, WordType, Vec<u32>)>,
}

/// Verdicts on one output, counted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Elements that agree.
    pub agreed: u64,
    /// Elements that deviate.
    pub deviated: u64,
    /// Elements that are NaN or infinite.
    pub not_finite: u64,
    /// Elements that are inconclusive.
    pub undetermined: u64,
}

impl Counts {
    fn add(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Agree => self.agreed += 1,
            Verdict::Deviate => self.deviated += 1,
            Verdict::NotFinite => self.not_finite += 1,
            Verdict::Undetermined => self.undetermined += 1,
        }
    }

    fn merge(&mut self, other: &Self) {
        self.agreed += other.agreed;
        self.deviated += other.deviated;
        self.not_finite += other.not_finite;
        self.undetermined += other.undetermined;
    }
}

/// What is wrong with the outputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Finding {
    /// Elements outside of their bounds.
    Deviate(u64),
    /// Elements that are no finite numbers.
    NotFinite(u64),
    /// An output that is not there.
    MissingOutput(String),
    /// Samples without outputs: how many, and the first.
    MissingSamples(u64, u64),
    /// Outputs without a sample: how many rows, and the first.
    ExtraRows(u64, u64),
    /// Rows that stand elsewhere than in the reference, with the first.
    Misordered(u64, u64),
    /// Rows for samples that another row is for, with the first.
    Repeated(u64, u64),
    /// Rows whose inputs are none of the reference's, with the first.
    OtherInputs(u64, u64),
    /// Elements that nothing bounds, whatever they are: of how many, and in hundredths of a percent how many may be.
    Unbounded(u64, u64, u64),
    /// Nothing was judged.
    NothingJudged,
    /// The bytes of the numbers seem to be in the other order.
    ByteOrder,
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let s = |n: &u64| if *n == 1 { "" } else { "s" };
        match self {
            Self::Deviate(n) => write!(f, "{n} element{} farther off than allowed", s(n)),
            Self::NotFinite(n) => write!(f, "{n} element{} NaN or infinite where a finite number is expected", s(n)),
            Self::MissingOutput(name) => write!(f, "the output `{name}` is missing"),
            Self::MissingSamples(n, first) => write!(f, "{n} sample{} missing, the first is {first}", s(n)),
            Self::ExtraRows(n, first) => {
                write!(f, "{n} row{} without a sample in the reference, the first is row {first}", s(n))
            }
            Self::Misordered(n, first) => {
                write!(f, "{n} row{} in another place than in the reference, the first is row {first}", s(n))
            }
            Self::Repeated(n, first) => {
                write!(f, "{n} row{} for a sample that another row is for, the first is row {first}", s(n))
            }
            Self::OtherInputs(n, first) => {
                write!(f, "{n} row{} with inputs that the reference does not have, the first is row {first}", s(n))
            }
            Self::Unbounded(n, all, most) => write!(
                f,
                "{n} of {all} elements have no bound, more than {} %: any value of theirs passes; take a reference with \
                 bounds for them, or allow more with --max-unbounded",
                *most as f64 / 100.0
            ),
            Self::NothingJudged => f.write_str("nothing was judged: no element has a bound"),
            Self::ByteOrder => {
                f.write_str("the bytes of the numbers are in the other order: with them swapped most elements agree")
            }
        }
    }
}

/// What came out of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Name of the suite.
    pub suite: String,
    /// The profile behind the bounds.
    pub profile: Option<String>,
    /// Samples of the reference.
    pub samples: u64,
    /// Rows of the outputs.
    pub rows: u64,
    /// How rows were matched.
    pub matched: &'static str,
    /// By output.
    pub outputs: Vec<(String, Counts)>,
    /// What is wrong; empty when nothing is.
    pub findings: Vec<Finding>,
    /// The elements that are farthest off in bounds, the worst first; agreeing ones count where none
    /// deviates.
    pub worst: Vec<Worst>,
}

impl Report {
    /// All elements.
    pub fn total(&self) -> Counts {
        let mut total = Counts::default();
        self.outputs.iter().for_each(|(_, counts)| total.merge(counts));
        total
    }
}

/// Worst cases that are kept.
const KEPT: usize = 5;

/// Compares outputs with a reference, both in memory. `each` sees every element, block by block.
///
/// # Errors
/// [`VerifyError`] when there is nothing to compare.
pub fn verify(
    reference: &Dataset,
    actual: &Table,
    rule: Rule,
    each: &mut dyn FnMut(&Element),
) -> Result<Report, VerifyError> {
    let document = &reference.document;
    let mut judge = Judge::new(document, rule)?;
    let outputs = Outputs::find(document, actual)?;
    let order = Order::find(reference, actual, outputs.rows)?;
    let (samples, step) = (order.rows.len(), document.block_rows.max(1) as usize);
    for begin in (0..samples).step_by(step) {
        let span = begin..(begin + step).min(samples);
        judge.look((reference, actual), &outputs, span, &order.rows, each);
    }
    Ok(judge.report(order.by, outputs.rows as u64, order.findings))
}

/// A comparison under way.
struct Judge {
    rule: Rule,
    report: Report,
    missing: Vec<Finding>,
    /// Elements that agree with their bytes swapped, and of these that agree as they are.
    swapped: (u64, u64),
}

impl Judge {
    fn new(document: &Document, rule: Rule) -> Result<Self, VerifyError> {
        if document.rows == 0 {
            return Err(VerifyError::NoSamples);
        }
        let bounded = document.arrays.iter().any(|array| array.role == Role::Bound);
        if !bounded && !rule.exact {
            return Err(VerifyError::NoBounds);
        }
        let report = Report {
            suite: document.suite.name.clone(),
            profile: document.profile.as_ref().map(|p| p.name.clone()),
            samples: document.rows,
            rows: 0,
            matched: "place",
            outputs: Vec::new(),
            findings: Vec::new(),
            worst: Vec::new(),
        };
        Ok(Self { rule, report, missing: Vec::new(), swapped: (0, 0) })
    }

    /// Looks at these samples, whose rows are known.
    fn look(
        &mut self,
        (reference, actual): (&Dataset, &Table),
        outputs: &Outputs<'_>,
        samples: Range<usize>,
        rows: &[Option<usize>],
        each: &mut dyn FnMut(&Element),
    ) {
        let Self { rule, report, missing, swapped } = self;
        if report.outputs.is_empty() {
            let name = |output: &outputs::Output<'_>| (output.expected.variable.clone(), Counts::default());
            report.outputs = outputs.found.iter().map(name).collect();
            *missing = outputs.missing.iter().cloned().map(Finding::MissingOutput).collect();
        }
        let first = reference.document.first;
        let flags = reference.array("flags").map(|(_, bytes)| bytes);
        for (output, (_, counts)) in outputs.found.iter().zip(&mut report.outputs) {
            let side = Side::new(reference, output.expected);
            for sample in samples.clone() {
                let Some(row) = rows[sample] else { continue };
                for word in 0..output.expected.words() {
                    let mut element = side.element(sample, word, first);
                    output.read(actual, row, word, &side, &mut element);
                    element.verdict = judge(&element, &side, *rule);
                    counts.add(element.verdict);
                    if side.kind == WordType::F4 && element.bound.is_finite() && element.expected != 0.0 {
                        let other = f64::from(f32::from_bits(element.bits.swap_bytes()));
                        let near = (other - element.expected).abs() <= element.bound;
                        swapped.0 += u64::from(near);
                        swapped.1 += u64::from(element.verdict == Verdict::Agree);
                    }
                    each(&element);
                    if element.verdict != Verdict::Undetermined {
                        keep(&mut report.worst, element, || {
                            let bits = flags.map_or(0, |f| u16::from_le_bytes([f[2 * sample], f[2 * sample + 1]]));
                            (Flags(bits), inputs(reference, sample))
                        });
                    }
                }
            }
        }
    }

    /// What came out, with what is wrong with the rows.
    fn report(self, matched: &'static str, rows: u64, of_rows: Vec<Finding>) -> Report {
        let Self { rule, report, missing, swapped } = self;
        let mut report = Report { matched, rows, ..report };
        let total = report.total();
        let mut findings = Vec::new();
        findings.extend((total.deviated > 0).then_some(Finding::Deviate(total.deviated)));
        findings.extend((total.not_finite > 0).then_some(Finding::NotFinite(total.not_finite)));
        findings.extend((swapped.0 > 2 * swapped.1 && swapped.0 > 0).then_some(Finding::ByteOrder));
        let judged = total.agreed + total.deviated + total.not_finite;
        findings.extend((judged == 0).then_some(Finding::NothingJudged));
        let (open, most) = (total.undetermined, rule.max_unbounded);
        let beyond = judged > 0 && open as f64 > most * (judged + open) as f64;
        findings.extend(beyond.then_some(Finding::Unbounded(open, judged + open, (most * 1e4).round() as u64)));
        findings.extend(missing);
        findings.extend(of_rows);
        report.findings = findings;
        if total.deviated + total.not_finite > 0 {
            report.worst.retain(|worst| worst.element.verdict != Verdict::Agree);
        }
        report
    }
}

fn judge(element: &Element, side: &Side<'_>, rule: Rule) -> Verdict {
    let Element { expected, actual, bits, nearest, bound, .. } = *element;
    if rule.exact {
        let both_nan = side.kind == WordType::F4 && expected.is_nan() && actual.is_nan();
        return match () {
            () if both_nan || (bits == nearest && !actual.is_nan()) => Verdict::Agree,
            () if expected.is_finite() && !actual.is_finite() => Verdict::NotFinite,
            () => Verdict::Deviate,
        };
    }
    if expected.is_nan() {
        return Verdict::Undetermined;
    }
    // Too large for binary32: infinite is what it becomes.
    let representable = expected.abs() <= f64::from(f32::MAX);
    if !actual.is_finite() && representable {
        return Verdict::NotFinite;
    }
    if !bound.is_finite() {
        return Verdict::Undetermined;
    }
    // Written so that NaN does not agree.
    if element.error() <= bound { Verdict::Agree } else { Verdict::Deviate }
}

/// Keeps an element if it is one of the worst.
fn keep(worst: &mut Vec<Worst>, element: Element, about: impl FnOnce() -> (Flags, Vec<(String, WordType, Vec<u32>)>)) {
    let rank = |element: &Element| (element.verdict != Verdict::Agree, element.ratio());
    let before = |a: (bool, f64), b: (bool, f64)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).is_ge();
    let at = worst.partition_point(|other| before(rank(&other.element), rank(&element)));
    if at < KEPT {
        let (flags, inputs) = about();
        worst.insert(at, Worst { element, flags, inputs });
        worst.truncate(KEPT);
    }
}

/// The inputs of a sample.
fn inputs(reference: &Dataset, sample: usize) -> Vec<(String, WordType, Vec<u32>)> {
    let document = &reference.document;
    let mut all = Vec::new();
    for (array, bytes) in document.arrays.iter().zip(&reference.arrays).filter(|(array, _)| array.role == Role::Input) {
        let row = order::row_of(array, document.per_case, sample);
        let words = bytes[row * array.stride()..][..array.stride()].chunks_exact(4);
        let words = words.map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        all.push((array.variable.clone(), array.dtype, words));
    }
    all
}

/// The arrays of the reference about one output.
struct Side<'d> {
    array: &'d Array,
    kind: WordType,
    expected: &'d [u8],
    nearest: &'d [u8],
    bound: Option<&'d [u8]>,
}

impl<'d> Side<'d> {
    fn new(reference: &'d Dataset, array: &'d Array) -> Self {
        let of = |role: Role| {
            let mut all = reference.document.arrays.iter().zip(&reference.arrays);
            all.find(|(other, _)| other.role == role && other.variable == array.variable)
        };
        let (nearest, kind) = of(Role::Nearest).map_or((&[][..], WordType::F4), |(a, bytes)| (&bytes[..], a.dtype));
        Self {
            array,
            kind,
            expected: of(Role::Expected).map_or(&[], |(_, bytes)| &bytes[..]),
            nearest,
            bound: of(Role::Bound).map(|(_, bytes)| &bytes[..]),
        }
    }

    fn element(&self, sample: usize, word: usize, first: u64) -> Element {
        let at = sample * self.array.words() + word;
        let four = |bytes: &[u8]| {
            let b = bytes.get(4 * at..4 * at + 4).unwrap_or(&[0; 4]);
            u32::from_le_bytes([b[0], b[1], b[2], b[3]])
        };
        let mut eight = [0; 8];
        eight.copy_from_slice(&self.expected[8 * at..8 * at + 8]);
        Element {
            sample: first + sample as u64,
            component: format!("{}{}", self.array.variable, self.array.components[word]),
            expected: f64::from_le_bytes(eight),
            nearest: four(self.nearest),
            actual: f64::NAN,
            bits: 0,
            bound: self.bound.map_or(f64::INFINITY, |bound| f64::from(f32::from_bits(four(bound)))),
            verdict: Verdict::Undetermined,
        }
    }
}
