//! Profiles: how far the result of each operation may lie from its exact value, as data.
//!
//! A profile is the table of a specification, or of a device that was measured. It is read from a
//! TOML file; those of the specifications are in `crates/judge/profiles` and part of the program.

mod accept;
mod device;
pub mod grid;
mod measured;
mod op;
mod promises;
mod read;
mod rule;
mod shipped;

use std::fmt;

use program::lane::Stage;

pub use accept::{Free, Sieve, accept, accept_near, may_promise};
pub use device::{Identity, device_name};
pub use grid::Interval;
pub use measured::{BINS, CLASSES, Measured, Row, Table, bin_of, bounds_of_bin};
pub use op::{Op, Unlisted};
pub use promises::{Promises, promises};
pub use read::{ProfileError, parse};
pub use rule::{Condition, Definition, Piece, Quantity, Rule};
pub use shipped::{by_name, for_device, names};

/// How a correctly rounded result is rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// To one of the two neighbours of the exact value, whichever.
    Either,
    /// To the nearest number, ties to even.
    NearestEven,
}

/// What happens to subnormal numbers that are arguments or results of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flush {
    /// They become zero.
    Must,
    /// They may become zero.
    May,
    /// They stay.
    Never,
}

impl Flush {
    /// `must`, `may` or `never`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Must => "must",
            Self::May => "may",
            Self::Never => "never",
        }
    }
}

/// What is accepted around the exact value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acceptance {
    /// The interval of the text, with real ends.
    Text,
    /// The interval with its ends moved outward to binary32 numbers, as the conformance suites do.
    Outward,
}

/// What a profile says about an operation.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// Rules, the first that covers the arguments counts.
    Promised(Vec<Piece>),
    /// Errors that were measured.
    Measured(Table),
}

/// Numeric behaviour of an API, or of a device.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Name, such as `vulkan-1.4`, or device and version of a measurement, such as `llvmpipe-22.3.6`.
    pub name: String,
    /// The revision of the specification that the tables were taken from, or the driver, the date
    /// and the extent of a measurement.
    pub revision: String,
    /// Device and driver of a measurement, as the lane described them.
    pub driver: Option<String>,
    /// What correctly rounded means.
    pub rounding: Rounding,
    /// Subnormal numbers in compute stages.
    pub compute: Flush,
    /// Subnormal numbers in vertex stages.
    pub vertex: Flush,
    /// Whether a product and a sum may be fused into one operation with one rounding.
    pub contraction: bool,
    /// Whether expressions may be rearranged by associativity and distributivity.
    pub rearrangement: bool,
    /// Whether reference data get a bound from the order of the source where rearrangement leaves none. No promise
    /// of an API says so.
    pub in_order_where_unbounded: bool,
    /// What is accepted around the exact value.
    pub acceptance: Acceptance,
    /// Entries by [`Op`] in the order of [`Op::ALL`]. Always one for each operation.
    entries: Vec<Entry>,
}

/// The error that a profile allows at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Allowed {
    /// At most this far from the exact value, in its unit; infinite where overflow to infinity is
    /// allowed.
    Bound(f64),
    /// As far as the definition goes, or `or` (an absolute error) if that is further.
    Inherited {
        /// The formula to expand.
        definition: Definition,
        /// Allowed in any case; 0 without such a rule.
        or: f64,
    },
    /// Nothing is promised for the operation.
    NoPromise,
    /// Nothing is promised for these arguments.
    OutsideDomain,
}

impl Profile {
    /// True for binary32 as IEEE 754 has it, which the embedded lane keeps: what other APIs leave open is fixed there.
    pub fn is_strict(&self) -> bool {
        self.name == "binary32"
    }

    /// The same without rearrangement.
    #[must_use]
    pub fn in_order(&self) -> Self {
        Self { rearrangement: false, ..self.clone() }
    }

    /// The error that one operation may make, for use in a propagation of errors: the bound holds
    /// in a neighbourhood of the arguments and does not rely on the exact value being a binary32
    /// number. To judge the result of one operation with known arguments, use [`accept`].
    ///
    /// `args` are the arguments and `exact` the value of the operation in real numbers. The result
    /// covers a flushed result; a flushed argument is an error of that argument, see
    /// [`Profile::argument_flush`].
    pub fn allowed(&self, op: Op, args: &[f64], exact: f64, stage: Stage) -> Allowed {
        let pieces = match self.entry(op) {
            Entry::Measured(table) => {
                return match table.definition {
                    Some(definition) => Allowed::Inherited { definition, or: 0.0 },
                    None => self.finish(table.bound(op, args, exact), exact, stage, true),
                };
            }
            Entry::Promised(pieces) => pieces,
        };
        let points: [Interval; 3] = std::array::from_fn(|k| Interval::point(args.get(k).copied().unwrap_or(f64::NAN)));
        let points = &points[..args.len().min(3)];
        let Some(piece) = pieces.iter().find(|p| p.covers(points)) else {
            return Allowed::OutsideDomain;
        };
        let gap = base::value::ulp_at(exact);
        let bound = match piece.rule {
            Rule::Exact => 0.0,
            Rule::Rounded => match self.rounding {
                Rounding::Either => gap,
                Rounding::NearestEven => gap / 2.0,
            },
            Rule::Ulp { constant, slope } => {
                let x = args.first().map_or(0.0, |x| x.abs());
                (constant + slope * x) * gap
            }
            Rule::Absolute(error) => error,
            Rule::Inherited { definition, or } => return Allowed::Inherited { definition, or },
            Rule::NoPromise => return Allowed::NoPromise,
        };
        let on_grid = matches!(piece.rule, Rule::Exact | Rule::Rounded);
        self.finish(Some(bound), exact, stage, on_grid)
    }

    /// Adds what holds for every rule: the outward rounding, flushed results, overflow.
    fn finish(&self, bound: Option<f64>, exact: f64, stage: Stage, on_grid: bool) -> Allowed {
        let Some(mut bound) = bound else { return Allowed::OutsideDomain };
        if self.acceptance == Acceptance::Outward && !on_grid {
            bound += base::value::ulp_at(exact.abs() + bound);
        }
        // Vulkan 1.4, "Denormalized Values": a result counts as subnormal when the exact value does.
        if self.flush(stage) != Flush::Never && exact.abs() - bound < grid::MIN_NORMAL {
            bound = bound.max(exact.abs());
        }
        if exact.abs() + bound > grid::MAX_FINITE {
            bound = f64::INFINITY;
        }
        // An exact value that is no number has no neighbourhood.
        if bound.is_nan() || exact.is_nan() { Allowed::OutsideDomain } else { Allowed::Bound(bound) }
    }

    /// How far a flush moves an argument: its size if it is subnormal and may be flushed, else 0.
    pub fn argument_flush(&self, argument: f64, stage: Stage) -> f64 {
        let subnormal = argument.abs() < grid::MIN_NORMAL;
        if subnormal && self.flush(stage) != Flush::Never { argument.abs() } else { 0.0 }
    }

    /// Subnormal numbers in a stage.
    pub fn flush(&self, stage: Stage) -> Flush {
        match stage {
            Stage::Compute => self.compute,
            // Both are ends of the same pipeline; a device treats them alike.
            Stage::Vertex | Stage::Geometry => self.vertex,
        }
    }

    /// What the profile says about an operation.
    pub fn entry(&self, op: Op) -> &Entry {
        // `Op::ALL` is in the order of the enum, and the constructor fills one entry for each.
        &self.entries[op as usize]
    }
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Promised(pieces) => {
                let parts: Vec<String> = pieces.iter().map(Piece::to_string).collect();
                f.write_str(&parts.join("; else "))
            }
            Self::Measured(table) => {
                write!(f, "{} ULP over {} samples", table.max_ulp(), table.samples)?;
                table.definition.map_or(Ok(()), |d| write!(f, ", by {}", d.text()))
            }
        }
    }
}

#[cfg(test)]
mod tests;
