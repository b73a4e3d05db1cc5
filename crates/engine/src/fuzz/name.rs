//! The second look at samples that are in trouble: which operation brings it about.

use rayon::prelude::*;

use super::scan::{LIMIT, Look, ROUNDS, Trouble};
use super::subject::Ready;
use base::text::Span;
use base::value::Batch;
use judge::profile::{Op, Profile, Promises};
use judge::tape::{Model, Tape};
use judge::verdict::diagnosis::Place;
use lanes::{Api, Stage, interrupt};
use program::Program;
use program::interp::{Binary32, Binary64, Dependence, Executable, Machine, OutputColumn, SLOTS, Site, author_span};
use property::Sample;

use super::crossing::crosses;
use super::finding::FuzzFindingKind;

/// What is known about the trouble of one sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// Kind of the trouble.
    pub kind: FuzzFindingKind,
    /// The operation that brings it about; `None` for an output that was not written and the like.
    pub op: Option<Op>,
    /// The operation in the program.
    pub site: Option<Site>,
    /// Its arguments, exactly.
    pub args: Vec<f64>,
    /// Its value, exactly.
    pub value: f64,
    /// By how much it enlarges a relative error of its arguments.
    pub condition: f64,
    /// The output word: vertex and word.
    pub place: (usize, usize),
    /// What the word means.
    pub meaning: f64,
    /// What strict binary32 gives.
    pub strict: f32,
    /// Why a value is undefined.
    pub why: Option<String>,
    /// The relative errors of another output, with this one added and without.
    pub pair: Option<[f64; 2]>,
}

/// Samples with one name are one finding.
pub type Key = (FuzzFindingKind, Option<Op>, Option<Site>);

impl Named {
    /// Trouble of a kind of which nothing else is known.
    fn blank(kind: FuzzFindingKind, place: (usize, usize)) -> Self {
        Self {
            kind,
            op: None,
            site: None,
            args: Vec::new(),
            value: f64::NAN,
            condition: f64::NAN,
            place,
            meaning: f64::NAN,
            strict: f32::NAN,
            why: None,
            pair: None,
        }
    }

    /// True for a sum that is `part` of its terms at most in real numbers, and in binary32 what roundings left: the error of another sum or product, as
    /// error-free transformations take it (Dekker 1971, Knuth's TwoSum, Kahan's summation).
    fn is_of_roundings(&self, part: f64) -> bool {
        let size = self.args.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        let rest = f64::from(self.strict).abs();
        matches!(self.op, Some(Op::Add | Op::Sub))
            && self.value.abs() <= size * part
            && self.meaning.abs() <= size * part
            && rest > 0.0
            && rest <= size * 2f64.powi(-20)
    }

    /// True for `atan` of two zeros.
    pub fn is_angle_of_nothing(&self) -> bool {
        self.why.as_deref().is_some_and(|why| why.starts_with("`atan` of 0, 0"))
    }

    /// True for a texel outside of a texture of which nothing asks for its size: the host's may be larger than that of the run.
    pub fn is_outside_of_texture(&self, ready: &Ready) -> bool {
        let asks = |text: &str| text.contains("textureSize") || text.contains("textureDimensions");
        let outside =
            self.kind == FuzzFindingKind::Index && self.site.is_some_and(|site| ready.executable.reads_texel(site));
        outside && !asks(ready.program.file.text())
    }

    /// What makes it one finding with others. A pair of outputs is one transformation, and an output crosses zero, however
    /// many operations show it.
    pub fn key(&self) -> Key {
        match self.kind {
            FuzzFindingKind::ZeroCrossing => (self.kind, None, None),
            FuzzFindingKind::RoundingOrder if self.pair.is_some() => (self.kind, None, None),
            _ => (self.kind, self.op, self.site),
        }
    }
}

/// A device that rounds every operation correctly.
fn strict() -> &'static Profile {
    Promises::of_api(Api::Binary32).text
}

/// Names the trouble of samples; `None` where there is none after all: a comparison could go either way,
/// and decides the output. `sizes` are the usual ones of the output words.
pub fn name(ready: &Ready, sizes: &[f64], batch: &Batch, looks: &[(usize, Look)]) -> Vec<Option<Named>> {
    let model = Model::Device { profile: strict(), stage: Stage::Compute, rearranged: false };
    // What does not end says so by itself, and would hold up what does.
    let ending: Vec<&(usize, Look)> = looks.iter().filter(|(_, look)| look.trouble != Some(Trouble::Endless)).collect();
    let chunks: Vec<Vec<Option<Named>>> = ending
        .par_chunks(SLOTS)
        .map_init(
            || {
                let executable = &ready.executable;
                (
                    Machine::new(executable, Tape::new(model), ROUNDS),
                    Machine::new(executable, Binary32::default(), ROUNDS),
                    Machine::new(executable, Binary64::default(), ROUNDS),
                )
            },
            |(tape, narrow, wide), looks| {
                // What has no name is not told, in a run that is told to be incomplete.
                if interrupt::asked() {
                    return vec![None; looks.len()];
                }
                let invocations: Vec<usize> = looks.iter().map(|(invocation, _)| *invocation).collect();
                tape.run_some(batch, &invocations);
                narrow.run_some(batch, &invocations);
                let one = |(slot, (invocation, look)): (usize, &&(usize, Look))| {
                    one(tape, narrow, wide, batch, sizes, (slot, *invocation), look)
                };
                looks.iter().enumerate().map(one).collect()
            },
        )
        .collect();
    let mut named = chunks.into_iter().flatten();
    let each = |(_, look): &(usize, Look)| match look.trouble {
        Some(Trouble::Endless) => Some(Named::blank(FuzzFindingKind::Endless, look.place)),
        _ => named.next().flatten(),
    };
    looks.iter().map(each).collect()
}

fn one(
    tape: &mut Machine<'_, Tape<'_>>,
    narrow: &Machine<'_, Binary32>,
    wide: &mut Machine<'_, Binary64>,
    batch: &Batch,
    sizes: &[f64],
    (slot, invocation): (usize, usize),
    look: &Look,
) -> Option<Named> {
    let trouble = look.trouble?;
    let mut named = Named::blank(FuzzFindingKind::Endless, look.place);
    let plain = |kind| Some(Named { kind, ..named.clone() });
    if let Some(kind) = trouble.of_integers() {
        wide.take_findings();
        wide.run_some(batch, &[invocation]);
        named.site = wide.take_findings().iter().find(|f| f.kind == kind).map(|f| f.site);
        named.kind = of_undefined(trouble);
        return Some(named);
    }
    if matches!(trouble, Trouble::Unset | Trouble::Undefined) {
        let found = wide.dependences(batch, &[invocation], false).pop().flatten()?;
        named.kind = of_undefined(trouble);
        named.site = Some(found.of.site);
        named.why = Some(found.of.why(&found.args));
        return Some(named);
    }
    match trouble {
        Trouble::TooManyVertices => return plain(FuzzFindingKind::TooManyVertices),
        Trouble::NotWritten => return plain(FuzzFindingKind::NotWritten),
        _ => {}
    }
    let (vertex, word) = look.place;
    if tape.domain().given_up(slot).is_some() {
        return long(named, narrow, wide, batch, slot, invocation, trouble);
    }
    let OutputColumn::Real(&column) = tape.output(vertex, word) else { return None };
    named.strict = strictly(narrow, named.place, slot);
    let tape = tape.domain();
    named.meaning = tape.values(column)[slot];
    let undefined = matches!(trouble, Trouble::NoValue | Trouble::Infinite);
    let mut culprit = tape.culprit(column, slot, LIMIT);
    // Where real numbers have no value, binary64 may have lost one on the way; if not, the operation
    // without one is meant.
    if undefined && !culprit.as_ref().is_some_and(|(cause, _)| vanished(cause.op, &cause.args, cause.value)) {
        culprit = tape.culprit(column, slot, f64::INFINITY);
    }
    // Bits of a NaN or an infinity that no operation makes were written as such.
    if undefined && culprit.as_ref().is_none_or(|(cause, _)| cause.op.is_none()) {
        return None;
    }
    let forked = tape.fork(slot).is_some();
    if let Some((cause, condition)) = &culprit {
        (named.op, named.site, named.args, named.value) = (cause.op, cause.site, cause.args.clone(), cause.value);
        named.condition = *condition;
    }
    let value = named.value;
    if trouble == Trouble::Paired {
        let sum = matches!(named.op, Some(Op::Add | Op::Sub | Op::Fma)) && !named.site.is_some_and(Site::is_precise);
        return sum.then_some(Named { kind: FuzzFindingKind::RoundingOrder, pair: Some(look.pair), ..named });
    }
    named.kind = match trouble {
        _ if vanished(named.op, &named.args, value) => FuzzFindingKind::Underflow,
        Trouble::NoValue | Trouble::Infinite if value.is_infinite() && !is_pole(named.op, &named.args) => {
            FuzzFindingKind::TooLarge
        }
        Trouble::NoValue | Trouble::Infinite | Trouble::TooLarge => of_results(trouble),
        _ if value.abs() > f64::from(f32::MAX) => FuzzFindingKind::Overflow,
        _ if value != 0.0 && value.abs() < f64::from(f32::MIN_POSITIVE) => FuzzFindingKind::Underflow,
        _ if forked => return None,
        // Under `precise` an operation is what it is written as, and a difference that is 0 in real numbers is meant.
        Trouble::Moved if named.site.is_some_and(Site::is_precise) && named.is_of_roundings(2f64.powi(-24)) => {
            return None;
        }
        Trouble::Moved if named.is_of_roundings(2f64.powi(-40)) => FuzzFindingKind::RoundingOrder,
        Trouble::Moved if crosses(&named, sizes, wide, &Sample::of(batch, invocation)) => FuzzFindingKind::ZeroCrossing,
        _ => of_results(trouble),
    };
    Some(named)
}

/// Trouble of a sample with a loop too long to be followed: without the operation that brings it about.
fn long(
    mut named: Named,
    narrow: &Machine<'_, Binary32>,
    wide: &mut Machine<'_, Binary64>,
    batch: &Batch,
    slot: usize,
    invocation: usize,
    trouble: Trouble,
) -> Option<Named> {
    let (vertex, word) = named.place;
    wide.run_some(batch, &[invocation]);
    if let OutputColumn::Real(found) = wide.output(vertex, word) {
        named.meaning = found.values()[0];
    }
    named.strict = strictly(narrow, named.place, slot);
    named.kind = of_results(trouble);
    Some(named)
}

/// What strict binary32 gives in a word.
fn strictly(narrow: &Machine<'_, Binary32>, (vertex, word): (usize, usize), slot: usize) -> f32 {
    match narrow.output(vertex, word) {
        OutputColumn::Real(found) => found.values()[slot],
        _ => f32::NAN,
    }
}

/// The name of an operation whose value is undefined, without the output that shows it.
pub fn undefined(because: &Dependence) -> Named {
    let why = Some(because.of.why(&because.args));
    let kind = of_undefined(Trouble::of(because.of.kind));
    Named { site: Some(because.of.site), why, ..Named::blank(kind, (0, 0)) }
}

/// What an undefined value is called.
fn of_undefined(trouble: Trouble) -> FuzzFindingKind {
    match trouble {
        Trouble::Index => FuzzFindingKind::Index,
        Trouble::DivisionByZero => FuzzFindingKind::DivisionByZero,
        Trouble::Shift => FuzzFindingKind::Shift,
        Trouble::Conversion => FuzzFindingKind::Conversion,
        Trouble::Unset => FuzzFindingKind::Unset,
        Trouble::Undefined => FuzzFindingKind::Undefined,
        _ => FuzzFindingKind::IntegerOverflow,
    }
}

/// What trouble is by its result alone.
fn of_results(trouble: Trouble) -> FuzzFindingKind {
    match trouble {
        Trouble::NoValue => FuzzFindingKind::NoValue,
        Trouble::Infinite => FuzzFindingKind::Infinite,
        Trouble::TooLarge => FuzzFindingKind::TooLarge,
        Trouble::Lost => FuzzFindingKind::Lost,
        _ => FuzzFindingKind::IllConditioned,
    }
}

/// True for an operation whose value is too small even for binary64.
fn vanished(op: Option<Op>, args: &[f64], value: f64) -> bool {
    let some = args.iter().all(|x| *x != 0.0 && x.is_finite());
    let can = match op {
        Some(Op::Mul | Op::Div) => some,
        Some(Op::Exp | Op::Exp2) => true,
        Some(Op::Pow) => args.first() != Some(&0.0),
        Some(_) | None => false,
    };
    can && value == 0.0
}

/// True for an operation that is infinite at its arguments, and not merely too large for binary64.
fn is_pole(op: Option<Op>, args: &[f64]) -> bool {
    let zero = |k: usize| args.get(k) == Some(&0.0);
    match op {
        Some(Op::Div | Op::Rem | Op::Mod) => zero(1),
        Some(Op::Log | Op::Log2 | Op::InverseSqrt | Op::Pow) => zero(0),
        Some(Op::Atanh) => true,
        Some(_) | None => false,
    }
}

/// An operation with its arguments, as people write it.
pub fn applied(op: Op, args: &[f64]) -> String {
    let args: Vec<String> = args.iter().map(|&x| decimal(x)).collect();
    let sign = match op {
        Op::Add => " + ",
        Op::Sub => " - ",
        Op::Mul => " * ",
        Op::Div => " / ",
        _ => return format!("{}({})", op.name(), args.join(", ")),
    };
    let grouped: Vec<String> =
        args.into_iter().map(|x| if x.starts_with('-') { format!("({x})") } else { x }).collect();
    grouped.join(sign)
}

/// A number in few enough digits to read, and enough to see what it is near to.
pub fn decimal(x: f64) -> String {
    const DIGITS: usize = 12;
    if x.is_nan() {
        return "nan".to_owned();
    }
    let plain = x == 0.0 || x.is_infinite() || (1e-4..1e7).contains(&x.abs());
    let exact = if plain { format!("{x:?}") } else { format!("{x:e}") };
    if exact.len() <= DIGITS {
        return exact;
    }
    let rounded = format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(x);
    // 0.9999999999999 is not 1.
    if rounded == rounded.round() && plain {
        return exact;
    }
    if plain { format!("{rounded:?}") } else { format!("{rounded:e}") }
}

/// Where a site stands in the author's files, and the text there; none in generated text.
pub fn place(program: &Program, executable: &Executable, site: Option<Site>) -> Option<Place> {
    place_of(program, author_span(program, &executable.place(site?))?)
}

/// Where a span of a program's text stands in the author's files, and the text there; none in generated text.
pub fn place_of(program: &Program, span: Span) -> Option<Place> {
    let file = &program.file;
    let (origin, there) = file.origin(span);
    if there.is_empty() {
        return None;
    }
    let text = origin.slice(there).split_whitespace().collect::<Vec<_>>().join(" ");
    // Spans of expressions leave out brackets at their ends that belong to them.
    let (mut open, mut missing) = (0_usize, 0_usize);
    for c in text.chars() {
        match c {
            '(' => open += 1,
            ')' if open > 0 => open -= 1,
            ')' => missing += 1,
            _ => {}
        }
    }
    let plain = |c: &char| !c.is_whitespace();
    let behind = origin.slice(Span::new(there.end, origin.text().len()));
    let closing = behind.chars().filter(plain).take_while(|&c| c == ')').count();
    let before = origin.slice(Span::new(0, there.start));
    let opening = before.chars().rev().filter(plain).take_while(|&c| c == '(').count();
    let text = format!("{}{text}{}", "(".repeat(missing.min(opening)), ")".repeat(open.min(closing)));
    Some(Place { text, ..Place::of(file, span) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_what_is_near_to_one_is_not_one() {
        let reported = |x| decimal(x);
        assert_eq!(
            [reported(0.5), reported(-0.0), reported(1e-30), reported(f64::NAN)],
            ["0.5", "-0.0", "1e-30", "nan"]
        );
        assert_eq!([reported(1.0 / 3.0), reported(2e30 / 3.0)], ["0.333333333333", "6.66666666667e29"]);
        assert_ne!(reported(1.0 - 1e-14), "1.0");
        assert_eq!(applied(Op::Sub, &[1.0, -2.0]), "1.0 - (-2.0)");
        assert_eq!(applied(Op::Pow, &[0.0, -1.0]), "pow(0.0, -1.0)");
    }

    #[test]
    fn what_vanishes_in_binary64_is_told_from_what_is_zero() {
        assert!(vanished(Some(Op::Exp), &[-1e4], 0.0) && vanished(Some(Op::Mul), &[1e-200, 1e-200], 0.0));
        assert!(!vanished(Some(Op::Mul), &[0.0, 1e-200], 0.0) && !vanished(Some(Op::Sub), &[1.0, 1.0], 0.0));
    }
}
