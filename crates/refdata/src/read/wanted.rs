//! Which columns of a file are read, and how much of them: what the reference states, and nothing else. A column that
//! nobody asks for may be as wide and as long as its writer likes.

use std::collections::{HashMap, HashSet};

use super::{Column, Numbers};
use crate::array::Role;
use crate::document::Document;

/// What may stand before the name of an output.
pub(crate) const PREFIXES: [&str; 4] = ["", "actual.", "output.", "nearest."];
/// Columns that are no outputs.
const OTHERS: [&str; 2] = ["index", "flags"];
/// Rows that are read beyond twice those of the reference before rows are looked for in memory.
const SPARE: u64 = 1 << 16;
/// Columns of a file, at most.
const COLUMNS: usize = 1 << 16;

/// True for a name that an output may have, whatever it is called in the shader.
pub(crate) fn is_plain(name: &str) -> bool {
    !OTHERS.contains(&name) && !["input.", "case.", "expected.", "bound."].iter().any(|prefix| name.starts_with(prefix))
}

/// What is read of a file.
pub struct Wanted {
    /// Numbers of a row by the name of the column.
    widths: HashMap<String, usize>,
    /// Words of all outputs of a sample, which a file with a single array may have in one.
    words: usize,
    rows: u64,
}

impl Wanted {
    /// Outputs of the samples of a reference, with what tells which sample a row belongs to.
    pub fn outputs(document: &Document) -> Self {
        let mut widths = HashMap::from([("index".to_owned(), 1)]);
        let mut words = 0;
        for array in &document.arrays {
            let names = match array.role {
                Role::Expected => PREFIXES.iter().map(|prefix| format!("{prefix}{}", array.variable)).collect(),
                Role::Input => vec![array.name.clone(), array.variable.clone()],
                Role::Nearest | Role::Bound | Role::Flags => continue,
            };
            words += if array.role == Role::Expected { array.words() } else { 0 };
            for name in names {
                widths.extend(array.components.iter().map(|component| (format!("{name}{component}"), 1)));
                widths.insert(name, array.words());
            }
        }
        Self { widths, words, rows: document.rows }
    }

    /// The columns of a reference file itself.
    pub(super) fn reference(document: &Document) -> Self {
        let columns = document.arrays.iter().flat_map(|array| (0..array.words()).map(|word| (array.column(word), 1)));
        Self { widths: columns.collect(), words: 0, rows: document.rows }
    }

    /// Words of the outputs of a sample.
    pub(super) fn words(&self) -> usize {
        self.words
    }

    /// Rows that are read into memory at a time, at most.
    pub(super) fn most(&self) -> usize {
        usize::try_from(self.rows.saturating_mul(2).saturating_add(SPARE)).unwrap_or(usize::MAX)
    }

    /// Rows of the reference.
    pub(super) fn rows(&self) -> u64 {
        self.rows
    }

    /// For each column with its width, whether it is read.
    ///
    /// # Errors
    /// When there are more columns than any reference has.
    pub(super) fn select<'c>(
        &self,
        columns: impl ExactSizeIterator<Item = (&'c str, usize)> + Clone,
    ) -> Result<Vec<bool>, String> {
        let count = columns.len();
        if count > COLUMNS {
            return Err(format!("it has {count} columns; at most {COLUMNS} are read"));
        }
        let mut plain = columns.clone().map(|(name, _)| is_plain(name));
        let alone = plain.position(|plain| plain).filter(|_| !plain.any(|plain| plain));
        let mut seen = HashSet::new();
        let read = |(at, (name, width)): (usize, (&'c str, usize))| {
            let known = self.widths.get(name).is_some_and(|&wanted| wanted == width);
            // Of two columns with one name the first counts.
            seen.insert(name) && (known || (alone == Some(at) && width == self.words))
        };
        Ok(columns.enumerate().map(read).collect())
    }
}

impl Column {
    /// A column that is not read.
    pub(super) fn unread(name: &str, width: usize) -> Self {
        Self { name: name.to_owned(), width, numbers: Numbers::F4(Vec::new()) }
    }
}
