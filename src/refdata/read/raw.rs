//! binary32 numbers and nothing else: all words of the first sample, then those of the second.

use super::{Column, Load, Numbers, ReadError, Table};

/// Order of the bytes of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ByteOrder {
    /// The least significant first.
    #[default]
    Little,
    /// The most significant first.
    Big,
}

pub(super) fn table(from: &mut dyn Load, order: ByteOrder, width: usize) -> Result<Table, ReadError> {
    let mut bytes = Vec::new();
    from.read_to_end(&mut bytes)?;
    let size = 4 * width.max(1);
    if !bytes.len().is_multiple_of(size) {
        return Err(ReadError::Damaged(format!(
            "it has {} bytes, which is no multiple of {size}: a sample has {width} binary32 numbers; it is cut off, \
             or not of these outputs",
            bytes.len()
        )));
    }
    let word = |b: &[u8]| {
        let bytes = [b[0], b[1], b[2], b[3]];
        match order {
            ByteOrder::Little => u32::from_le_bytes(bytes),
            ByteOrder::Big => u32::from_be_bytes(bytes),
        }
    };
    let numbers = Numbers::F4(bytes.chunks_exact(4).map(word).collect());
    Ok(Table { columns: vec![Column { name: String::new(), width, numbers }] })
}
