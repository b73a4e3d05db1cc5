//! Errors of an operation as a device showed them, binade by binade.

use super::{Definition, Op};
use base::value::ulp_at;

/// Upper ends of the classes of a histogram of errors, in ULP; one more class takes the rest.
pub const CLASSES: [f64; 11] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 64.0, 256.0, 1024.0, 4096.0, 65536.0];

/// Keys of the table of a measured operation: what a bound needs, and what people read beside it.
pub(super) const KEYS: [&str; 15] = [
    "definition",
    "samples",
    "exhaustive",
    "margin",
    "worst_ulp",
    "worst_ulp_at",
    "worst_abs",
    "worst_abs_at",
    "promise",
    "ratio",
    "verdict",
    "undefined",
    "flushed",
    "binades",
    "note",
];

/// Number of bins: sign and exponent of a binary32 number.
pub const BINS: usize = 512;

/// The bin of a number: its sign and exponent as a binary32 number, zero with the subnormal numbers.
/// What lies beyond the range counts with the largest numbers, and NaN has no bin.
pub fn bin_of(x: f64) -> Option<usize> {
    // Towards zero, so that a number just below a power of two stays in its binade.
    let near = x as f32;
    let kept = if f64::from(near).abs() > x.abs() { f32::from_bits(near.to_bits() - 1) } else { near };
    (!kept.is_nan()).then_some((kept.to_bits() >> 23) as usize)
}

/// Sign (−1 or 1) and exponent of the numbers of a bin; −127 stands for zero and subnormal numbers.
pub fn bounds_of_bin(bin: usize) -> (i32, i32) {
    (if bin >= BINS / 2 { -1 } else { 1 }, (bin % (BINS / 2)) as i32 - 127)
}

/// How far the arguments of a device may lie from the exact ones, as a part of the key of the table.
const NEAR: f64 = 1.0 / 65536.0;

/// Neighbouring binades of one sign in which an operation errs by the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// First and last bin.
    pub bins: (usize, usize),
    /// How many samples were measured in these binades.
    pub samples: u64,
    /// Largest error in ULP at the exact value.
    pub ulp: f64,
    /// Largest absolute error.
    pub abs: f64,
    /// Samples by class of error.
    pub histogram: [u64; CLASSES.len() + 1],
}

/// What was measured of an operation.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Number of samples.
    pub samples: u64,
    /// True when these are all arguments that there are.
    pub exhaustive: bool,
    /// Factor on errors that accounts for arguments that were not tried; at least 1.
    pub margin: f64,
    /// The formula by which the device was seen to compute the operation. Then the errors of its
    /// parts bound the operation, and the rows are there to be read.
    pub definition: Option<Definition>,
    /// Rows in ascending order of bins.
    pub rows: Vec<Row>,
}

/// A table by name, as a measurement hands it over.
pub type Measured = (Op, Table);

impl Table {
    /// Largest error in ULP.
    pub fn max_ulp(&self) -> f64 {
        self.rows.iter().map(|r| r.ulp).fold(0.0, f64::max)
    }

    /// Largest error to expect at these arguments and in a neighbourhood of [`NEAR`]; `None` where
    /// nothing was measured.
    pub(super) fn bound(&self, op: Op, args: &[f64], exact: f64) -> Option<f64> {
        let key = op.key(args);
        let bin = bin_of(key)?;
        let here = self.bound_of(self.row(bin)?, exact);
        // Next to the end of a binade, the arguments of the device may lie in the next one.
        let near = [key * (1.0 - NEAR), key * (1.0 + NEAR)].into_iter().filter_map(bin_of);
        let rows = near.filter(|near| *near != bin).filter_map(|near| self.row(near));
        Some(rows.fold(here, |bound, row| bound.max(self.bound_of(row, exact))))
    }

    /// True when no result was off by more than one rounding to nearest, and every finite number was
    /// reached: then [`Table::bound`] is half an ULP whatever the arguments.
    pub(crate) fn rounds(&self) -> bool {
        let rounded = self.rows.iter().all(|row| row.ulp <= 0.5) && self.max_ulp() > 0.0;
        let bins = |sign: usize| (sign * BINS / 2, sign * BINS / 2 + BINS / 2 - 2);
        let everywhere = matches!(&self.rows[..], [plus, minus] if plus.bins == bins(0) && minus.bins == bins(1));
        self.definition.is_none() && rounded && everywhere
    }

    fn row(&self, bin: usize) -> Option<&Row> {
        let at = self.rows.partition_point(|r| r.bins.1 < bin);
        self.rows.get(at).filter(|r| r.bins.0 <= bin)
    }

    fn bound_of(&self, row: &Row, exact: f64) -> f64 {
        // A device that rounds correctly wherever it was tried does so by design: the bound is that
        // of the rounding and not the luck of the samples. Where no result of the operation was off,
        // as with the sign and the floor, the operation is exact.
        if row.ulp <= 0.5 {
            return if row.ulp == 0.0 && self.max_ulp() == 0.0 { 0.0 } else { ulp_at(exact) / 2.0 };
        }
        self.margin * (row.ulp * ulp_at(exact)).min(row.abs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: Vec<Row>) -> Table {
        Table { samples: 2, exhaustive: false, margin: 1.5, definition: None, rows }
    }

    fn row(bins: (usize, usize), ulp: f64, abs: f64) -> Row {
        Row { bins, samples: 1, ulp, abs, histogram: [0; 12] }
    }

    #[test]
    fn a_number_just_below_a_power_of_two_stays_in_its_binade() {
        assert_eq!(bin_of(1.0), Some(127));
        assert_eq!(bin_of(1.0 - 1e-12), Some(126));
        assert_eq!(bin_of(-1.0), Some(256 + 127));
        assert_eq!((bin_of(0.0), bin_of(1e-42), bin_of(f64::NAN), bin_of(1e39)), (Some(0), Some(0), None, Some(254)));
        assert_eq!((bounds_of_bin(127), bounds_of_bin(256 + 128), bounds_of_bin(0)), ((1, 0), (-1, 1), (1, -127)));
    }

    #[test]
    fn the_bound_is_that_of_the_binade_of_the_argument() {
        let table = table(vec![row((120, 126), 4.0, 1.0), row((127, 127), 0.5, 1e-3)]);
        let at = |x: f64| table.bound(Op::Sin, &[x], 1.0);
        assert_eq!(at(0.75), Some(1.5 * 4.0 * ulp_at(1.0)));
        assert_eq!(at(1.5), Some(0.5 * ulp_at(1.0)), "no margin on correct rounding");
        assert_eq!(at(2.0), None, "nothing was measured there");
        assert_eq!(at(-0.75), None);
        assert_eq!(at(f64::NAN), None);
    }

    #[test]
    fn correct_rounding_is_half_an_ulp_however_lucky_the_samples_were() {
        let lucky = table(vec![row((120, 126), 0.0, 0.0), row((127, 127), 0.31, 1e-12)]);
        assert_eq!(lucky.bound(Op::Sqrt, &[0.75], 8.0), Some(ulp_at(8.0) / 2.0));
        assert_eq!(lucky.bound(Op::Sqrt, &[1.5], 8.0), Some(ulp_at(8.0) / 2.0), "not the absolute error of the row");
        let exact = table(vec![row((120, 127), 0.0, 0.0)]);
        assert_eq!(exact.bound(Op::Sqrt, &[1.5], 8.0), Some(0.0));
        let off = table(vec![row((127, 127), 0.51, 1.0)]);
        assert_eq!(off.bound(Op::Sqrt, &[1.5], 8.0), Some(1.5 * 0.51 * ulp_at(8.0)));
    }

    #[test]
    fn a_table_rounds_when_it_does_so_for_every_number() {
        let whole = [row((0, 254), 0.5, 1.0), row((256, 510), 0.4, 1.0)];
        let sum = table(whole.to_vec());
        assert!(sum.rounds());
        for args in [[1.0, 2.0], [-1e38, 1e-40], [1e-45, -1e-45]] {
            let exact = f64::abs(args[0] + args[1]);
            assert_eq!(sum.bound(Op::Add, &args, exact), Some(ulp_at(exact) / 2.0));
        }
        assert!(!table(vec![row((0, 254), 0.51, 1.0), whole[1].clone()]).rounds());
        assert!(!table(vec![row((0, 253), 0.5, 1.0), whole[1].clone()]).rounds());
        assert!(!table(vec![whole[0].clone()]).rounds());
        assert!(!table(vec![row((0, 254), 0.0, 0.0), row((256, 510), 0.0, 0.0)]).rounds(), "exact is less");
    }

    #[test]
    fn next_to_the_end_of_a_binade_the_worse_neighbour_counts() {
        let table = table(vec![row((126, 126), 1.0, 1.0), row((127, 127), 8.0, 1.0)]);
        let at = |x: f64| table.bound(Op::Sin, &[x], 1.0).unwrap() / ulp_at(1.0);
        assert_eq!((at(0.75), at(1.0 - 1e-6), at(1.0), at(1.5)), (1.5, 12.0, 12.0, 12.0));
        // An unmeasured neighbour adds nothing, and a measured one is no measurement of this binade.
        assert_eq!(at(2.0 - 1e-6), 12.0);
        assert_eq!(table.bound(Op::Sin, &[2.0], 1.0), None);
    }

    #[test]
    fn the_absolute_error_limits_the_bound_near_zeros_of_the_argument_range() {
        let table = table(vec![row((128, 128), 1e6, 1e-7)]);
        assert_eq!(table.bound(Op::Sin, &[3.0], 0.14), Some(1.5 * 1e-7));
    }
}
