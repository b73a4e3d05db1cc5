//! binary32 numbers and nothing else: all words of the first sample, then those of the second.

use std::io::Read;

use super::shared::Shared;
use super::windows::Windows;
use super::{Column, Numbers, ReadError, Table};

/// Order of the bytes of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ByteOrder {
    /// The least significant first.
    #[default]
    Little,
    /// The most significant first.
    Big,
}

/// Whether so many bytes are whole samples.
fn whole(bytes: u64, width: usize) -> Result<(), ReadError> {
    let size = 4 * width.max(1) as u64;
    if bytes.is_multiple_of(size) {
        return Ok(());
    }
    Err(ReadError::Damaged(format!(
        "it has {bytes} bytes, which is no multiple of {size}: a sample has {width} binary32 numbers; it is cut off, \
         or not of these outputs"
    )))
}

fn of_bytes(bytes: &[u8], order: ByteOrder, width: usize) -> Table {
    let word = |b: &[u8]| {
        let bytes = [b[0], b[1], b[2], b[3]];
        match order {
            ByteOrder::Little => u32::from_le_bytes(bytes),
            ByteOrder::Big => u32::from_be_bytes(bytes),
        }
    };
    let numbers = Numbers::F4(bytes.chunks_exact(4).map(word).collect());
    Table { columns: vec![Column { name: String::new(), width, numbers }] }
}

/// The numbers, some samples at a time.
pub(super) struct Words {
    from: Shared,
    order: ByteOrder,
    width: usize,
}

impl Words {
    pub fn open(from: &Shared, order: ByteOrder, width: usize) -> Result<Self, ReadError> {
        whole(from.length(), width)?;
        Ok(Self { from: from.at(0), order, width })
    }
}

impl Windows for Words {
    fn next(&mut self, rows: usize) -> Result<Table, ReadError> {
        let mut bytes = Vec::new();
        (&mut self.from).take((4 * self.width as u64).saturating_mul(rows as u64)).read_to_end(&mut bytes)?;
        Ok(of_bytes(&bytes, self.order, self.width))
    }
}
