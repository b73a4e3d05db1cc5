//! Where a deviation comes from: the literal or the operation of a shader, the built-in of a device.
//! What is found is put into words here; nothing here decides whether something is wrong.

mod lane;
mod position;
mod shader;
mod witness;

use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;

use crate::profile::Op;
use base::text::{Location, SourceFile, Span, printable};
use base::value::F32Bits;

pub use lane::{Suspected, lane};
pub use position::Position;
pub use shader::shader;
pub use witness::{CrossCheck, Fault, NONE, Stand, Witness, stand};

/// A place in the author's text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Place {
    /// File, line and column.
    pub at: Location,
    /// The text that stands there; empty where nothing of the author's does.
    pub text: String,
    /// The line of the file in which it begins; empty where nothing of the author's stands.
    pub line: String,
    /// The macro that is used there, where the place is in what it expands to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expansion: Option<String>,
}

impl Place {
    /// The place of a span of a text.
    pub fn of(file: &SourceFile, span: Span) -> Self {
        Self {
            at: file.location(span.start),
            text: file.slice(span).to_owned(),
            line: file.line_at(span.start),
            expansion: file.expansion(span).map(|expansion| expansion.name.to_string()),
        }
    }
}

/// A piece of a text in one line: expressions and uses of macros may go over several.
pub fn in_one_line(text: &str) -> String {
    printable(&text.split_whitespace().collect::<Vec<_>>().join(" "))
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.text.is_empty() {
            write!(f, "`{}` at ", in_one_line(&self.text))?;
        }
        write!(f, "{}", self.at)?;
        self.expansion.as_ref().map_or(Ok(()), |name| write!(f, ", in the expansion of `{name}`"))
    }
}

/// A number that was written with too few digits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShortLiteral {
    /// Where it stands.
    pub place: Place,
    /// What it stands for, such as `2π`.
    pub stands_for: Cow<'static, str>,
    /// How far it is off.
    #[serde(with = "base::value::exact")]
    pub off: f64,
}

/// An operation of the shader that has no value for its arguments.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoValue {
    /// Where it stands.
    pub place: Option<Place>,
    /// The operation.
    pub op: Option<Op>,
    /// Its arguments, exactly.
    #[serde(with = "base::value::exact::list")]
    pub args: Vec<f64>,
}

/// Whose part of a device is to blame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Origin {
    /// A single operation is outside of its promise.
    BuiltIn {
        /// The operation.
        op: Op,
        /// Bits of its operands.
        operands: Vec<u32>,
        /// Bits of the device's result, when the operation was run alone.
        result: u32,
        /// The exact value.
        #[serde(with = "base::value::exact")]
        exact: f64,
        /// The error over the error that is allowed.
        #[serde(with = "base::value::exact")]
        factor: f64,
        /// Name of the profile that allows it.
        profile: String,
        /// Where it stands.
        place: Option<Place>,
    },
    /// Every operation is inside its promise, and the outputs are what another order of sums and
    /// products may give; the device may not choose one.
    Rearrangement,
    /// Every operation is inside its promise, and the outputs are what another order may give of what `precise` keeps as it
    /// is written.
    PreciseLost {
        /// What translates the text for the executor.
        front_end: String,
    },
    /// Every operation is inside its promise, and the outputs are what the shader gives without a rounding: a number becomes
    /// one of fewer digits and a number again, and the compiler leaves both out.
    RoundingLeftOut {
        /// Where it loses digits.
        there: Option<Place>,
        /// Where it becomes a number again; the same place where one operation does both.
        back: Option<Place>,
    },
    /// Every operation is inside its promise, and no order of them explains the outputs.
    Miscompilation,
}

/// The first operation at which a device and the meaning of the shader part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Divergence {
    /// Where it stands.
    pub place: Place,
    /// Its arguments, exactly.
    #[serde(with = "base::value::exact::list")]
    pub args: Vec<f64>,
    /// What it means.
    #[serde(with = "base::value::exact")]
    pub meaning: f64,
    /// How far a device may be off there.
    #[serde(with = "base::value::exact")]
    pub bound: f64,
    /// Bits of what the device has.
    pub actual: u32,
    /// Relative condition number of the operation: by how much it enlarges a relative error of its
    /// arguments.
    #[serde(with = "base::value::exact")]
    pub condition: f64,
    /// True when the device goes another way there, and not only to another value.
    pub path: bool,
}

/// What is known about the origin of a deviation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    /// Literals whose missing digits explain all of it.
    pub literals: Vec<ShortLiteral>,
    /// The operation that has no value.
    pub no_value: Option<NoValue>,
    /// What of the device is to blame.
    pub origin: Option<Origin>,
    /// Where it first shows; `None` when it is gone as soon as intermediate values are looked at.
    pub divergence: Option<Divergence>,
    /// Where the wrong output is computed.
    pub written: Option<Place>,
    /// The relation that the values of the lane break, where it is about one.
    #[serde(default)]
    pub relation: Option<String>,
    /// The place in its batch on which it depends, where that and not the inputs makes it deviate.
    #[serde(default)]
    pub position: Option<Position>,
    /// What the other lanes of the run say; `None` before they were asked, and where no lane has a say.
    #[serde(rename = "hearing")]
    pub cross_check: Option<CrossCheck>,
}

fn list(values: impl Iterator<Item = String>) -> String {
    values.collect::<Vec<_>>().join(", ")
}

impl fmt::Display for ShortLiteral {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` ({}) stands for {}, off by {:.1e}", self.place.text, self.place.at, self.stands_for, self.off)
    }
}

impl fmt::Display for NoValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let op = self.op.map_or("an operation", Op::name);
        write!(f, "{op} of {} has no value", list(self.args.iter().map(|x| format!("{x:?}"))))?;
        self.place.as_ref().map_or(Ok(()), |place| write!(f, ": {place}"))
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BuiltIn { op, operands, result, exact, factor, profile, place } => {
                let operands = list(operands.iter().map(|&bits| format!("{:?}", F32Bits(bits))));
                let result = F32Bits(*result);
                write!(f, "built-in `{}`: of {operands} it gives {result:?} alone, exactly {exact:?}", op.name())?;
                write!(f, "; {factor:.1} times what {profile} allows")?;
                place.as_ref().map_or(Ok(()), |place| write!(f, ": {place}"))
            }
            Self::Rearrangement => {
                f.write_str("rearrangement: every operation alone is right, and sums or products were regrouped")
            }
            Self::PreciseLost { front_end } => {
                f.write_str("`precise` is lost: every operation alone is right, and what it keeps was regrouped")?;
                // Known, and no fault of the driver: see `upstream/naga-precise`.
                if front_end.starts_with("naga") {
                    write!(f, "; {front_end} has no word for it, and tells the driver nothing")?;
                }
                Ok(())
            }
            Self::RoundingLeftOut { there, back } => {
                f.write_str("a rounding is left out: every operation alone is right, and the outputs are those ")?;
                match (there, back) {
                    (Some(there), Some(back)) if there == back => write!(f, "without {there}"),
                    (Some(there), Some(back)) => write!(f, "without the pair of {there} and {back}"),
                    (Some(one), None) | (None, Some(one)) => write!(f, "without the pair at {one}"),
                    (None, None) => f.write_str("without a conversion there and back"),
                }
            }
            Self::Miscompilation => f.write_str(
                "miscompilation: every operation alone is right, and no order of sums and products explains the outputs",
            ),
        }
    }
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, args, meaning, bound, actual, condition, path } = self;
        if *path {
            return write!(f, "{place}: the device goes another way here");
        }
        write!(f, "{place}")?;
        if !args.is_empty() {
            write!(f, " of {}", list(args.iter().map(|x| format!("{x:?}"))))?;
        }
        write!(f, ": device {:?}, meaning {meaning:?} ± {bound:.1e}", F32Bits(*actual))?;
        if condition.is_finite() { write!(f, ", condition number {condition:.1}") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_literal_is_reported_with_its_place_and_what_it_stands_for() {
        let place =
            Place { at: "sphere.vert:12:14".into(), text: "6.283185".into(), line: String::new(), expansion: None };
        let literal = ShortLiteral { place, stands_for: "2π".into(), off: 3.07e-7 };
        assert_eq!(literal.to_string(), "`6.283185` (sphere.vert:12:14) stands for 2π, off by 3.1e-7");
    }

    #[test]
    fn a_built_in_is_reported_with_its_operands_and_by_how_much_it_is_off() {
        let origin = Origin::BuiltIn {
            op: Op::Sin,
            operands: vec![0.5_f32.to_bits()],
            result: 0.25_f32.to_bits(),
            exact: 0.479,
            factor: 2.0,
            profile: "vulkan-1.4".into(),
            place: Some(Place { at: "a.vert:3:5".into(), text: "sin(x)".into(), line: String::new(), expansion: None }),
        };
        assert_eq!(
            origin.to_string(),
            "built-in `sin`: of 0.5 (0x3f000000) it gives 0.25 (0x3e800000) alone, exactly 0.479; 2.0 times what \
             vulkan-1.4 allows: `sin(x)` at a.vert:3:5"
        );
    }
}
