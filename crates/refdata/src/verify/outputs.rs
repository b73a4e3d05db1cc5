//! Which columns of a file are outputs of the reference.

use super::{Element, Side, VerifyError};
use crate::array::{Array, Role, WordType};
use crate::document::Document;
use crate::read::{Numbers, PREFIXES, Table, is_plain};

/// The outputs that were found.
pub(super) struct Outputs<'d> {
    pub found: Vec<Output<'d>>,
    /// Names of those that were not.
    pub missing: Vec<String>,
    pub rows: usize,
}

/// One output: for each of its words the column and the place in its rows.
pub(super) struct Output<'d> {
    pub expected: &'d Array,
    places: Vec<(usize, usize)>,
}

impl<'d> Outputs<'d> {
    pub fn find(document: &'d Document, actual: &Table) -> Result<Self, VerifyError> {
        let expected: Vec<&Array> = document.arrays.iter().filter(|array| array.role == Role::Expected).collect();
        let mut outputs = Self { found: Vec::new(), missing: Vec::new(), rows: 0 };
        let all: usize = expected.iter().map(|array| array.words()).sum();
        let plain: Vec<usize> = (0..actual.columns.len()).filter(|&k| is_plain(&actual.columns[k].name)).collect();
        for (k, &array) in expected.iter().enumerate() {
            let before: usize = expected[..k].iter().map(|array| array.words()).sum();
            match places(array, actual)? {
                Some(places) => outputs.found.push(Output { expected: array, places }),
                // One array for everything: raw numbers, a single .npy, or the only array of an archive.
                None => match plain[..] {
                    [only] if actual.columns[only].width == all => {
                        let places = (0..array.words()).map(|word| (only, before + word)).collect();
                        outputs.found.push(Output { expected: array, places });
                    }
                    [only] if expected.len() == 1 => {
                        let column = &actual.columns[only];
                        return Err(VerifyError::Width { name: named(&column.name), found: column.width, wanted: all });
                    }
                    _ => outputs.missing.push(array.variable.clone()),
                },
            }
        }
        if outputs.found.is_empty() {
            let list = |names: Vec<String>| if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
            let wanted = list(expected.iter().map(|array| format!("`{}`", array.variable)).collect());
            let found = list(actual.columns.iter().map(|column| format!("`{}`", column.name)).collect());
            return Err(VerifyError::NoOutput { wanted, found });
        }
        let mut used = outputs.found.iter().flat_map(|output| output.places.iter().map(|(column, _)| *column));
        let first = used.next().unwrap_or_default();
        let rows = actual.columns[first].rows();
        if let Some(other) = used.find(|&column| actual.columns[column].rows() != rows) {
            let name = |k: usize| named(&actual.columns[k].name);
            let others = actual.columns[other].rows();
            return Err(VerifyError::Rows { name: name(first), rows, other: name(other), others });
        }
        outputs.rows = rows;
        Ok(outputs)
    }
}

fn named(name: &str) -> String {
    if name.is_empty() { "the only array".to_owned() } else { name.to_owned() }
}

/// The places of the words of an output: an array of its name, or a column for each word.
fn places(array: &Array, actual: &Table) -> Result<Option<Vec<(usize, usize)>>, VerifyError> {
    for prefix in PREFIXES {
        let name = format!("{prefix}{}", array.variable);
        let of = |name: &str| actual.columns.iter().position(|column| column.name == name);
        if let Some(column) = of(&name) {
            let width = actual.columns[column].width;
            if width != array.words() {
                return Err(VerifyError::Width { name, found: width, wanted: array.words() });
            }
            return Ok(Some((0..width).map(|word| (column, word)).collect()));
        }
        let words: Option<Vec<(usize, usize)>> =
            array.components.iter().map(|component| Some((of(&format!("{name}{component}"))?, 0))).collect();
        if words.is_some() {
            return Ok(words);
        }
    }
    Ok(None)
}

impl Output<'_> {
    /// Reads a word into an element.
    pub fn read(&self, actual: &Table, row: usize, word: usize, side: &Side<'_>, element: &mut Element) {
        let (column, place) = self.places[word];
        let column = &actual.columns[column];
        let at = row * column.width + place;
        element.actual = column.numbers.real(at);
        element.bits = match (side.kind, &column.numbers) {
            // binary64 numbers that are no binary32 are never the nearest.
            (WordType::F4, Numbers::F8(list)) if !list[at].is_nan() && f64::from(list[at] as f32) != list[at] => {
                !element.nearest
            }
            (WordType::F4, numbers) => numbers.bits(at),
            (_, numbers) => numbers.whole(at).map_or(!element.nearest, |whole| whole as u32),
        };
    }
}
