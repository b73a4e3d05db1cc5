//! Findings in words: what is wrong, and what others have in common with it.

use super::finding::FuzzFindingKind;
use super::name::{Named, applied, decimal};
use super::scan::{LIMIT, ROUNDS};
use judge::profile::Op;
use program::{Program, Written};

/// What findings have in common that one change of the shader would mend. `wrote` is what the author wrote there.
pub(super) fn cause(named: &Named, wrote: Option<&str>) -> String {
    let missing = matches!(named.kind, FuzzFindingKind::NoValue | FuzzFindingKind::Infinite | FuzzFindingKind::Lost);
    match named.op {
        Some(Op::Div | Op::Rem | Op::Mod) if missing => "a division by 0".to_owned(),
        Some(op) if missing => match (wrote.and_then(called), op) {
            (Some(name), _) => format!("`{name}` where it has no finite value"),
            (None, Op::Add) => "a sum without a finite value".to_owned(),
            (None, Op::Sub) => "a difference without a finite value".to_owned(),
            (None, Op::Mul) => "a product without a finite value".to_owned(),
            (None, op) => format!("`{}` where it has no finite value", op.name()),
        },
        Some(_) | None => match named.kind {
            FuzzFindingKind::IllConditioned => "digits are lost".to_owned(),
            FuzzFindingKind::ZeroCrossing => "an output crosses zero".to_owned(),
            FuzzFindingKind::Undefined if named.is_angle_of_nothing() => "the angle of a vector of length 0".to_owned(),
            kind => kind.name().replace('_', " "),
        },
    }
}

/// The function of a text that is one call.
fn called(text: &str) -> Option<&str> {
    let (name, rest) = text.split_once('(')?;
    let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let mut depth = 1_usize;
    let end = rest.find(|c| {
        depth = if c == '(' { depth + 1 } else { depth - usize::from(c == ')') };
        depth == 0
    })?;
    (is_name && end + 1 == rest.len()).then_some(name)
}

/// The operation with its arguments; behind what the author wrote, where that is a function which is made of others.
pub fn operation(op: Op, args: &[f64], wrote: Option<&str>) -> String {
    let own = applied(op, args);
    let Some(text) = wrote.filter(|text| text.chars().count() <= LONGEST) else { return own };
    match called(text) {
        Some("normalize") if args.iter().all(|x| *x == 0.0) => format!("`{text}` of a zero vector, {own}"),
        Some(name) if name.to_ascii_lowercase() != op.name() => format!("`{text}`, where {own}"),
        _ => own,
    }
}

/// Characters of what the author wrote that are repeated in a message.
const LONGEST: usize = 48;

/// The largest number of binary16.
const LARGEST_HALF: f64 = 65504.0;

/// What is wrong, in one sentence. `shown` is the name of the output with the closing quote.
pub(super) fn message(named: &Named, shown: &str, wrote: Option<&str>, program: &Program) -> String {
    let op = named.op.map(|op| operation(op, &named.args, wrote));
    let by = |what: &str| op.as_ref().map_or_else(String::new, |op| format!(": {op} {what}"));
    let halves = program.has_halves() && program::interp::halved(named.strict).to_bits() == named.strict.to_bits();
    let (format, digits) = if halves { ("binary16", 11.0) } else { ("binary32", 24.0) };
    // Where binary64 loses the value on the way, it knows no result either.
    let known = named.meaning.is_finite();
    let result = if known { format!("the result is {}, ", decimal(named.meaning)) } else { String::new() };
    let strict = if named.strict.is_nan() { "nan".to_owned() } else { format!("{:?}", named.strict) };
    match named.kind {
        FuzzFindingKind::NoValue if named.value.is_infinite() => format!("`{shown} has no value{}", by("is infinite")),
        FuzzFindingKind::NoValue => format!("`{shown} has no value{}", by("has none")),
        FuzzFindingKind::Infinite => format!("`{shown} is infinite{}", by("is")),
        FuzzFindingKind::Overflow => format!(
            "overflow on the way to `{shown}{}; {result}{format} gives {strict}",
            by(&format!("is too large for {format}"))
        ),
        FuzzFindingKind::Underflow => format!(
            "underflow on the way to `{shown}{}; {result}{format} gives {strict}",
            by(&format!("is too small for {format}"))
        ),
        FuzzFindingKind::Lost if halves && named.strict.is_infinite() && named.value.abs() > LARGEST_HALF => format!(
            "overflow on the way to `{shown}{}; {result}binary16 gives {strict}",
            by("is too large for binary16, which ends at 65504")
        ),
        FuzzFindingKind::Lost => format!(
            "rounding leaves `{shown} without a value{}; {format} gives {strict}",
            by("has no right digit left")
        ),
        FuzzFindingKind::IllConditioned => {
            let lost = (f64::from(named.strict) - named.meaning).abs() / named.meaning.abs();
            let bits = (digits + lost.max(LIMIT * LIMIT).log2()).clamp(0.0, digits);
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
                "ill-conditioned: {op}{many}; `{shown} is {}, {format} gives {strict}: {bits:.0} of {digits:.0} bits are lost",
                decimal(named.meaning)
            )
        }
        FuzzFindingKind::ZeroCrossing => format!(
            "`{shown} crosses zero{}: it is {}, {format} gives {strict}, off by {:.0e}, a few roundings of its usual size; \
             inputs that are off by theirs move it about as far",
            op.as_ref().map_or_else(String::new, |op| format!(" at {op}")),
            decimal(named.meaning),
            (f64::from(named.strict) - named.meaning).abs()
        ),
        FuzzFindingKind::RoundingOrder => match named.pair {
            Some([with, without]) => format!(
                "relies on rounding order: `{shown} is 0 in real numbers and what rounding left of another output; a conforming \
                 device may regroup{}: the error of both grows from {with:.0e} to {without:.0e} at these inputs; {}",
                op.as_ref().map_or_else(String::new, |op| format!(" {op}")),
                precise(program)
            ),
            None => format!(
                "relies on rounding order: `{shown} is 0 in real numbers, {format} gives {strict}, and a conforming device may \
             regroup{}, which leaves nothing of it; {}",
                op.as_ref().map_or_else(String::new, |op| format!(" {op}")),
                precise(program)
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

/// What keeps the order of operations in the language of a text.
fn precise(program: &Program) -> &'static str {
    match program.written {
        Written::Wgsl => "WGSL has nothing that forbids it",
        _ => "add `precise` to what it is computed from",
    }
}

/// The name of a function as a word of a command.
pub(crate) fn word_of(label: &str) -> String {
    let plain = label.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if plain { label.to_owned() } else { format!("'{label}'") }
}

/// A factor, in few digits.
fn short(x: f64) -> String {
    match x {
        x if x < 100.0 => format!("{x:.0}"),
        x if x < 1e7 => format!("{}", format!("{x:.1e}").parse().unwrap_or(x)),
        x => format!("{x:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_is_one_call_names_its_function() {
        assert_eq!(
            [called("normalize(n)"), called("dot(N, (L))"), called("a * f(x)")],
            [Some("normalize"), Some("dot"), None]
        );
        assert_eq!([called("f(x) * g(y)"), called("(a)"), called("f(x")], [None; 3]);
        assert_eq!(
            operation(Op::InverseSqrt, &[0.0], Some("normalize(n)")),
            "`normalize(n)` of a zero vector, inversesqrt(0.0)"
        );
        assert_eq!(operation(Op::Add, &[1.0, -1.0], Some("dot(N, L)")), "`dot(N, L)`, where 1.0 + (-1.0)");
        assert_eq!(operation(Op::Sqrt, &[-1.0], Some("sqrt(x)")), "sqrt(-1.0)");
    }

    #[test]
    fn factors_are_read_without_powers_of_ten() {
        assert_eq!([short(36.84), short(213_456.0), short(3e9)], ["37", "210000", "3.0e9"]);
    }
}
