//! Findings in words: what is wrong, and what others have in common with it.

use super::finding::FuzzFindingKind;
use super::name::{Named, applied, decimal};
use super::scan::{LIMIT, ROUNDS};
use judge::profile::Op;

/// What findings have in common that one change of the shader would mend.
pub(super) fn cause(named: &Named) -> String {
    let missing = matches!(named.kind, FuzzFindingKind::NoValue | FuzzFindingKind::Infinite | FuzzFindingKind::Lost);
    match named.op {
        Some(Op::Div | Op::Rem | Op::Mod) if missing => "a division by 0".to_owned(),
        Some(op) if missing => format!("`{}` where it has no finite value", op.name()),
        Some(_) | None => match named.kind {
            FuzzFindingKind::IllConditioned => "digits are lost".to_owned(),
            FuzzFindingKind::ZeroCrossing => "an output crosses zero".to_owned(),
            kind => kind.name().replace('_', " "),
        },
    }
}

/// What is wrong, in one sentence. `shown` is the name of the output with the closing quote.
pub(super) fn message(named: &Named, shown: &str) -> String {
    let op = named.op.map(|op| applied(op, &named.args));
    let by = |what: &str| op.as_ref().map_or_else(String::new, |op| format!(": {op} {what}"));
    // Where binary64 loses the value on the way, it knows no result either.
    let known = named.meaning.is_finite();
    let result = if known { format!("the result is {}, ", decimal(named.meaning)) } else { String::new() };
    let strict = if named.strict.is_nan() { "nan".to_owned() } else { format!("{:?}", named.strict) };
    match named.kind {
        FuzzFindingKind::NoValue if named.value.is_infinite() => format!("`{shown} has no value{}", by("is infinite")),
        FuzzFindingKind::NoValue => format!("`{shown} has no value{}", by("has none")),
        FuzzFindingKind::Infinite => format!("`{shown} is infinite{}", by("is")),
        FuzzFindingKind::Overflow => format!(
            "overflow on the way to `{shown}{}; {result}binary32 gives {strict}",
            by("is too large for binary32")
        ),
        FuzzFindingKind::Underflow => format!(
            "underflow on the way to `{shown}{}; {result}binary32 gives {strict}",
            by("is too small for binary32")
        ),
        FuzzFindingKind::Lost => format!(
            "rounding leaves `{shown} without a value{}; binary32 gives {strict}",
            by("has no right digit left")
        ),
        FuzzFindingKind::IllConditioned => {
            let lost = (f64::from(named.strict) - named.meaning).abs() / named.meaning.abs();
            let bits = (24.0 + lost.max(LIMIT * LIMIT).log2()).clamp(0.0, 24.0);
            let many = if named.condition == 0.0 {
                // `floor` and the like: flat on both sides.
                " has a jump beside its argument".to_owned()
            } else if named.condition.is_finite() {
                format!(" enlarges rounding errors {} times", short(named.condition))
            } else {
                " keeps no right digit".to_owned()
            };
            let op = op.as_ref().map_or_else(|| "an operation".to_owned(), Clone::clone);
            format!(
                "ill-conditioned: {op}{many}; `{shown} is {}, binary32 gives {strict}: {bits:.0} of 24 bits are lost",
                decimal(named.meaning)
            )
        }
        FuzzFindingKind::ZeroCrossing => format!(
            "`{shown} crosses zero{}: it is {}, binary32 gives {strict}, off by {:.0e}, a few roundings of its usual size; \
             inputs that are off by theirs move it about as far",
            op.as_ref().map_or_else(String::new, |op| format!(" at {op}")),
            decimal(named.meaning),
            (f64::from(named.strict) - named.meaning).abs()
        ),
        FuzzFindingKind::RoundingOrder => match named.pair {
            Some([with, without]) => format!(
                "relies on rounding order: `{shown} is 0 in real numbers and what rounding left of another output; a conforming \
                 device may regroup{}: the error of both grows from {with:.0e} to {without:.0e} at these inputs; add `precise`",
                op.as_ref().map_or_else(String::new, |op| format!(" {op}"))
            ),
            None => format!(
                "relies on rounding order: `{shown} is 0 in real numbers, binary32 gives {strict}, and a conforming device may \
             regroup{}, which leaves nothing of it; add `precise` to what it is computed from",
                op.as_ref().map_or_else(String::new, |op| format!(" {op}"))
            ),
        },
        FuzzFindingKind::TooLarge => format!("`{shown} is too large for binary32{}", by("is")),
        FuzzFindingKind::NotWritten => format!("`{shown} is not written"),
        FuzzFindingKind::TooManyVertices => {
            "more vertices are emitted than `max_vertices`; those past it are lost".to_owned()
        }
        FuzzFindingKind::Endless => format!("a loop goes on after {ROUNDS} rounds"),
        FuzzFindingKind::Unset | FuzzFindingKind::Undefined => {
            format!("the value is undefined: {}", named.why.as_deref().unwrap_or("the operation leaves its range"))
        }
        FuzzFindingKind::Index => "an index lies outside of its array".to_owned(),
        FuzzFindingKind::DivisionByZero => "an integer is divided by zero".to_owned(),
        FuzzFindingKind::Shift => "a shift by 32 bits or more".to_owned(),
        FuzzFindingKind::Conversion => "a number does not fit the integer that it is converted to".to_owned(),
        FuzzFindingKind::IntegerOverflow => "a signed integer does not fit 32 bits".to_owned(),
        FuzzFindingKind::LaneDeviation
        | FuzzFindingKind::NotDeterministic
        | FuzzFindingKind::Disturbed
        | FuzzFindingKind::LaneFailed
        | FuzzFindingKind::Race
        | FuzzFindingKind::Divergence
        | FuzzFindingKind::SubgroupWidth
        | FuzzFindingKind::Order
        | FuzzFindingKind::MediumpOverflow
        | FuzzFindingKind::MediumpUnderflow
        | FuzzFindingKind::MediumpDigits => named.kind.name().to_owned(),
    }
}

/// A factor, in few digits.
fn short(x: f64) -> String {
    if x < 1e4 { format!("{x:.0}") } else { format!("{x:.1e}") }
}
