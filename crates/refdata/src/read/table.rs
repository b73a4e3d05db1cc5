//! Named columns of numbers.

use std::ops::Range;

use crate::array::WordType;

/// The numbers of a column, each in the type that the file has.
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// binary32, by its bits.
    F4(Vec<u32>),
    /// binary64.
    F8(Vec<f64>),
    /// Whole numbers.
    Whole(Vec<i64>),
}

impl Numbers {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::F4(list) => list.len(),
            Self::F8(list) => list.len(),
            Self::Whole(list) => list.len(),
        }
    }

    /// Some of them; none where there are none.
    pub(super) fn slice(&self, range: Range<usize>) -> Self {
        let range = range.start.min(self.len())..range.end.min(self.len());
        match self {
            Self::F4(list) => Self::F4(list[range].to_vec()),
            Self::F8(list) => Self::F8(list[range].to_vec()),
            Self::Whole(list) => Self::Whole(list[range].to_vec()),
        }
    }

    /// True without a number.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A number as binary64.
    pub fn real(&self, at: usize) -> f64 {
        match self {
            Self::F4(list) => f64::from(f32::from_bits(list[at])),
            Self::F8(list) => list[at],
            Self::Whole(list) => list[at] as f64,
        }
    }

    /// The bits of a number as binary32; of one that is none, those of the nearest.
    pub fn bits(&self, at: usize) -> u32 {
        match self {
            Self::F4(list) => list[at],
            Self::F8(list) => (list[at] as f32).to_bits(),
            Self::Whole(list) => (list[at] as f32).to_bits(),
        }
    }

    /// The low 32 bits of a whole number; `None` for a number that is not whole.
    pub fn whole(&self, at: usize) -> Option<i64> {
        match self {
            Self::Whole(list) => Some(list[at]),
            Self::F4(_) | Self::F8(_) => {
                let x = self.real(at);
                (x.trunc() == x && x.abs() < 9e15).then_some(x as i64)
            }
        }
    }

    /// Writes a number as a word of an array.
    pub(super) fn write(&self, at: usize, kind: WordType, out: &mut Vec<u8>) {
        match kind {
            WordType::F4 => out.extend(self.bits(at).to_le_bytes()),
            WordType::F8 => out.extend(self.real(at).to_le_bytes()),
            WordType::I4 | WordType::U4 => out.extend((self.whole(at).unwrap_or_default() as u32).to_le_bytes()),
            WordType::U2 => out.extend((self.whole(at).unwrap_or_default() as u16).to_le_bytes()),
        }
    }
}

/// A column, or an array of which every row has `width` numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name in the file; empty where the file has none.
    pub name: String,
    /// Numbers of a row.
    pub width: usize,
    /// Row by row.
    pub numbers: Numbers,
}

impl Column {
    /// Number of rows, the same in every column.
    pub fn rows(&self) -> usize {
        self.numbers.len() / self.width.max(1)
    }
}

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The columns, in the order of the file.
    pub columns: Vec<Column>,
}

impl Table {
    /// Some rows; fewer where there are fewer.
    pub fn window(&self, rows: Range<usize>) -> Self {
        let cut = |column: &Column| Column {
            name: column.name.clone(),
            width: column.width,
            numbers: column
                .numbers
                .slice(rows.start.saturating_mul(column.width)..rows.end.saturating_mul(column.width)),
        };
        Self { columns: self.columns.iter().map(cut).collect() }
    }

    /// Adds the rows of a table with the same columns.
    pub(super) fn append(&mut self, more: Self) {
        for (column, more) in self.columns.iter_mut().zip(more.columns) {
            match (&mut column.numbers, more.numbers) {
                (Numbers::F4(list), Numbers::F4(more)) => list.extend(more),
                (Numbers::F8(list), Numbers::F8(more)) => list.extend(more),
                (Numbers::Whole(list), Numbers::Whole(more)) => list.extend(more),
                // The type of a column is that of all of its groups.
                (Numbers::F4(_) | Numbers::F8(_) | Numbers::Whole(_), _) => {}
            }
        }
    }

    /// The column of this name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }
}
