//! What a profile says about one operation, and how it is written.

use std::fmt;

use super::grid::Interval;
use base::nearest;

/// The formula that an operation is defined by: its result is at least as accurate as that of the
/// formula, evaluated with the errors that the profile allows for the operations in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "`text` is the definition, and is what a documentation would repeat")]
pub enum Definition {
    SqrtByInverseSqrt,
    SinOverCos,
    AsinByAtan2,
    AcosByAtan2,
    SinhByExp,
    CoshByExp,
    SinhOverCosh,
    AsinhByLog,
    AcoshByLog,
    AtanhByLog,
    PowByExp2,
    FractByFloor,
    ModByFloor,
    RemByTrunc,
    MultiplyAdd,
    RadiansByProduct,
    DegreesByProduct,
    MixByWeights,
    SmoothStepByCubic,
    SumOfProducts,
    LengthByDot,
    DistanceByLength,
    NormalizeByInverseSqrt,
    NormalizeByLength,
    DifferenceOfProducts,
    ReflectByDot,
    RefractByDot,
    FaceForwardByDot,
    MatrixBySums,
}

use Definition::*;

impl Definition {
    /// All of them.
    pub const ALL: [Self; 29] = [
        SqrtByInverseSqrt,
        SinOverCos,
        AsinByAtan2,
        AcosByAtan2,
        SinhByExp,
        CoshByExp,
        SinhOverCosh,
        AsinhByLog,
        AcoshByLog,
        AtanhByLog,
        PowByExp2,
        FractByFloor,
        ModByFloor,
        RemByTrunc,
        MultiplyAdd,
        RadiansByProduct,
        DegreesByProduct,
        MixByWeights,
        SmoothStepByCubic,
        SumOfProducts,
        LengthByDot,
        DistanceByLength,
        NormalizeByInverseSqrt,
        NormalizeByLength,
        DifferenceOfProducts,
        ReflectByDot,
        RefractByDot,
        FaceForwardByDot,
        MatrixBySums,
    ];

    /// The formula, as profiles write it.
    pub fn text(self) -> &'static str {
        match self {
            SqrtByInverseSqrt => "1/inversesqrt(x)",
            SinOverCos => "sin(x)/cos(x)",
            AsinByAtan2 => "atan2(x, sqrt(1 - x*x))",
            AcosByAtan2 => "atan2(sqrt(1 - x*x), x)",
            SinhByExp => "(exp(x) - exp(-x))*0.5",
            CoshByExp => "(exp(x) + exp(-x))*0.5",
            SinhOverCosh => "sinh(x)/cosh(x)",
            AsinhByLog => "log(x + sqrt(x*x + 1))",
            AcoshByLog => "log(x + sqrt(x*x - 1))",
            AtanhByLog => "log((1 + x)/(1 - x))*0.5",
            PowByExp2 => "exp2(y*log2(x))",
            FractByFloor => "x - floor(x)",
            ModByFloor => "x - y*floor(x/y)",
            RemByTrunc => "x - y*trunc(x/y)",
            MultiplyAdd => "x*y + z",
            RadiansByProduct => "x*(pi/180)",
            DegreesByProduct => "x*(180/pi)",
            MixByWeights => "x*(1 - a) + y*a",
            SmoothStepByCubic => "t*t*(3 - 2*t), t = clamp((x - a)/(b - a), 0, 1)",
            SumOfProducts => "sum(x[i]*y[i])",
            LengthByDot => "sqrt(dot(x, x))",
            DistanceByLength => "length(x - y)",
            NormalizeByInverseSqrt => "x*inversesqrt(dot(x, x))",
            NormalizeByLength => "x/length(x)",
            DifferenceOfProducts => "x[i]*y[j] - x[j]*y[i]",
            ReflectByDot => "x - 2*dot(y, x)*y",
            RefractByDot => "z*x - (z*dot(y, x) + sqrt(k))*y, k = 1 - z*z*(1 - dot(y, x)*dot(y, x))",
            FaceForwardByDot => "dot(z, y) < 0 ? x : -x",
            MatrixBySums => "sums of products",
        }
    }
}

/// How far a result may lie from the exact value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// Not at all.
    Exact,
    /// As far as rounding takes it, by the rounding of the profile.
    Rounded,
    /// `constant + slope·|x|` ULP at the exact value.
    Ulp {
        /// ULP at x = 0.
        constant: f64,
        /// ULP for each unit of the first argument's magnitude.
        slope: f64,
    },
    /// This far.
    Absolute(f64),
    /// As far as the definition, or `or` if that is further.
    Inherited {
        /// The formula.
        definition: Definition,
        /// An absolute error that is allowed in any case; 0 without one.
        or: f64,
    },
    /// Any distance.
    NoPromise,
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Exact => f.write_str("exact"),
            Self::Rounded => f.write_str("rounded"),
            Self::Ulp { constant, slope: 0.0 } => write!(f, "ulp({})", WrittenNumber(constant)),
            Self::Ulp { constant, slope } => {
                write!(f, "ulp({} + {}*|x|)", WrittenNumber(constant), WrittenNumber(slope))
            }
            Self::Absolute(error) => write!(f, "abs({})", WrittenNumber(error)),
            Self::Inherited { definition, or: 0.0 } => write!(f, "inherits({})", definition.text()),
            Self::Inherited { definition, or } => {
                write!(f, "abs({}) or inherits({})", WrittenNumber(or), definition.text())
            }
            Self::NoPromise => f.write_str("none"),
        }
    }
}

impl Rule {
    /// Reads a rule as profiles write it; see [`Rule`]'s `Display`.
    ///
    /// # Errors
    /// What is wrong with the text and what it could be.
    pub fn parse(text: &str) -> Result<Self, String> {
        let inside = |name: &str| {
            text.strip_prefix(name).and_then(|t| t.strip_prefix('(')).and_then(|t| t.strip_suffix(')')).map(str::trim)
        };
        match text {
            "exact" => return Ok(Self::Exact),
            "rounded" => return Ok(Self::Rounded),
            "none" => return Ok(Self::NoPromise),
            _ => {}
        }
        if let Some((absolute, inherited)) = text.split_once(" or ") {
            return match (Self::parse(absolute)?, Self::parse(inherited)?) {
                (Self::Absolute(or), Self::Inherited { definition, or: 0.0 }) => Ok(Self::Inherited { definition, or }),
                _ => Err(format!("`{text}` is none of the rules with `or`; write `abs(1e-5) or inherits(…)`")),
            };
        }
        if let Some(size) = inside("ulp") {
            let (constant, slope) = match size.split_once('+') {
                None => (size, "0"),
                Some((constant, slope)) => {
                    let slope = slope.trim().strip_suffix("*|x|");
                    (constant, slope.ok_or_else(|| format!("`{size}` is no size; write `3 + 2*|x|`"))?)
                }
            };
            return Ok(Self::Ulp { constant: size_of(constant)?, slope: size_of(slope)? });
        }
        if let Some(size) = inside("abs") {
            return Ok(Self::Absolute(size_of(size)?));
        }
        if let Some(formula) = inside("inherits") {
            let found = Definition::ALL.into_iter().find(|d| d.text() == formula);
            return found.map(|definition| Self::Inherited { definition, or: 0.0 }).ok_or_else(|| {
                let meant = nearest(formula, Definition::ALL.map(Definition::text));
                let meant = meant.map(|meant| format!("; did you mean `{meant}`?")).unwrap_or_default();
                format!("`{formula}` is not the definition of any operation{meant}")
            });
        }
        let kinds = ["exact", "rounded", "ulp(2.5)", "abs(2^-11)", "inherits(sin(x)/cos(x))", "none"];
        Err(match nearest(text, kinds) {
            Some(meant) => format!("`{text}` is no rule; did you mean one such as `{meant}`?"),
            None => format!("`{text}` is no rule; rules are such as {}", kinds.join(", ")),
        })
    }
}

/// A number in the notation of profiles: powers of two as such.
struct WrittenNumber(f64);

impl fmt::Display for WrittenNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let exponent = self.0.abs().log2();
        if exponent.fract() == 0.0 && exponent.abs() > 4.0 {
            let sign = if self.0 < 0.0 { "-" } else { "" };
            write!(f, "{sign}2^{exponent}")
        } else {
            write!(f, "{}", self.0)
        }
    }
}

/// An allowed error: finite and not negative.
fn size_of(text: &str) -> Result<f64, String> {
    let size = number(text)?;
    if size.is_finite() && size >= 0.0 { Ok(size) } else { Err(format!("`{}` is no size of an error", text.trim())) }
}

/// `2.5`, `-1e-4`, `2^-126`, `pi`, `inf`, each with a sign or without.
fn number(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let (sign, size) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    let value = match size {
        "pi" => Some(std::f64::consts::PI),
        "inf" => Some(f64::INFINITY),
        _ => match size.split_once('^') {
            Some(("2", exponent)) => exponent.parse::<i32>().ok().map(|e| 2f64.powi(e)),
            Some(_) => None,
            None => size.parse::<f64>().ok().filter(|x| x.is_finite() && x.is_sign_positive()),
        },
    };
    value.map(|v| sign * v).ok_or_else(|| format!("`{text}` is no number; write one such as 2.5, 2^-126, pi or inf"))
}

/// A condition on the arguments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// What is limited.
    pub quantity: Quantity,
    /// The range, ends included.
    pub range: Interval,
}

/// What a condition limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The first argument.
    X,
    /// The second argument.
    Y,
    /// The magnitude of the first argument.
    AbsX,
    /// The magnitude of the second argument.
    AbsY,
}

impl Quantity {
    /// All of them, by the key of a profile.
    pub const KEYS: [(&'static str, Self); 4] =
        [("x", Self::X), ("y", Self::Y), ("|x|", Self::AbsX), ("|y|", Self::AbsY)];

    /// Index of the argument.
    fn argument(self) -> usize {
        match self {
            Self::X | Self::AbsX => 0,
            Self::Y | Self::AbsY => 1,
        }
    }

    /// The range of the quantity over a box of arguments; `None` when there is no such argument.
    fn over(self, args: &[Interval]) -> Option<Interval> {
        let arg = *args.get(self.argument())?;
        Some(match self {
            Self::X | Self::Y => arg,
            Self::AbsX | Self::AbsY => Interval { lo: arg.least_magnitude(), hi: arg.magnitude() },
        })
    }
}

impl Condition {
    /// Reads a range such as `-pi..pi`.
    ///
    /// # Errors
    /// What is wrong with the text and what it could be.
    pub fn parse(quantity: Quantity, text: &str) -> Result<Self, String> {
        let (lo, hi) =
            text.split_once("..").ok_or_else(|| format!("`{text}` is no range; write one such as `0.5..2`"))?;
        let (lo, hi) = (number(lo)?, number(hi)?);
        if lo > hi {
            return Err(format!("the range `{text}` is empty; its lower end comes first"));
        }
        Ok(Self { quantity, range: Interval { lo, hi } })
    }
}

/// A rule for a part of the arguments.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The rule.
    pub rule: Rule,
    /// All of these must hold; none for all arguments.
    pub domain: Vec<Condition>,
}

impl Piece {
    /// True when the rule holds for every point of a box of arguments.
    pub fn covers(&self, args: &[Interval]) -> bool {
        self.domain
            .iter()
            .all(|c| c.quantity.over(args).is_some_and(|q| c.range.contains(q.lo) && c.range.contains(q.hi)))
    }

    /// True when the rule may hold for some point of a box of arguments.
    pub fn touches(&self, args: &[Interval]) -> bool {
        self.domain.iter().all(|c| c.quantity.over(args).is_some_and(|q| q.lo <= c.range.hi && c.range.lo <= q.hi))
    }
}

impl fmt::Display for Piece {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.rule)?;
        for (k, condition) in self.domain.iter().enumerate() {
            let key = Quantity::KEYS.iter().find(|(_, q)| *q == condition.quantity).map_or("", |(key, _)| key);
            let Interval { lo, hi } = condition.range;
            let end = |x: f64| {
                if x.abs() == std::f64::consts::PI {
                    format!("{}pi", if x < 0.0 { "-" } else { "" })
                } else {
                    WrittenNumber(x).to_string()
                }
            };
            write!(f, "{}{key} in {}..{}", if k == 0 { " for " } else { ", " }, end(lo), end(hi))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_written_as_they_are_read() {
        for text in ["exact", "rounded", "none", "ulp(2.5)", "ulp(3 + 2*|x|)", "abs(2^-11)", "abs(0.0000681)"] {
            assert_eq!(Rule::parse(text).unwrap().to_string(), text);
        }
        for definition in Definition::ALL {
            let text = format!("inherits({})", definition.text());
            assert_eq!(Rule::parse(&text).unwrap(), Rule::Inherited { definition, or: 0.0 });
            assert_eq!(Rule::parse(&text).unwrap().to_string(), text);
        }
        let text = "abs(0.00001) or inherits(sinh(x)/cosh(x))";
        assert_eq!(Rule::parse(text).unwrap().to_string(), text);
    }

    #[test]
    fn what_is_no_rule_is_refused_with_a_suggestion() {
        for (text, said) in [
            ("ronded", "did you mean one such as `rounded`?"),
            ("ulp(many)", "`many` is no number"),
            ("ulp(-1)", "`-1` is no size of an error"),
            ("ulp(3 + 2*x)", "write `3 + 2*|x|`"),
            ("abs(inf)", "no size of an error"),
            ("inherits(sin(x)/cos(y))", "did you mean `sin(x)/cos(x)`?"),
            ("ulp(1) or exact", "none of the rules with `or`"),
        ] {
            let error = Rule::parse(text).unwrap_err();
            assert!(error.contains(said), "{text}: {error}");
        }
        assert!(Condition::parse(Quantity::X, "2..1").unwrap_err().contains("empty"));
        assert!(Condition::parse(Quantity::X, "0.5").unwrap_err().contains("no range"));
        assert!(Condition::parse(Quantity::X, "0..3^2").is_err());
    }

    #[test]
    fn conditions_hold_on_the_ends_of_their_range() {
        let near = |text| Piece { rule: Rule::Exact, domain: vec![Condition::parse(Quantity::AbsY, text).unwrap()] };
        let piece = near("2^-126..2^126");
        let at = |y: f64| [Interval::point(1.0), Interval::point(y)];
        assert!(piece.covers(&at(-2f64.powi(126))) && piece.covers(&at(2f64.powi(-126))));
        assert!(!piece.covers(&at(2f64.powi(127))) && !piece.covers(&at(0.0)));
        let across = [Interval::point(1.0), Interval { lo: -1.0, hi: 1.0 }];
        assert!(piece.touches(&across) && !piece.covers(&across));
        assert!(!piece.covers(&[Interval::point(1.0)]), "without a second argument the condition cannot hold");
    }
}
