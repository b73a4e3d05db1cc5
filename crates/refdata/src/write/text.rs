//! What the writers of texts have in common.

use std::io::{self, BufWriter, Seek, SeekFrom, Write};

use super::Store;
use crate::array::{Array, WordType};
use crate::document::{Document, NO_DIGEST};
use crate::number::{decimal_32, decimal_64};

/// A text that begins with a document whose digest is filled in at the end.
pub(super) struct Text<'s> {
    to: BufWriter<Box<dyn Store + 's>>,
    digest_at: u64,
}

impl<'s> Text<'s> {
    /// Writes `before` and the document in one line, with `after` behind it.
    pub fn new(store: Box<dyn Store + 's>, before: &str, document: &Document, after: &str) -> io::Result<Self> {
        let line = document.line();
        let at = line.rfind(NO_DIGEST).ok_or_else(|| io::Error::other("the document has its digest already"))?;
        let mut to = BufWriter::with_capacity(1 << 16, store);
        write!(to, "{before}{line}{after}")?;
        Ok(Self { to, digest_at: (before.len() + at) as u64 })
    }

    pub fn write(&mut self, text: &str) -> io::Result<()> {
        self.to.write_all(text.as_bytes())
    }

    /// Where bytes go that are no text.
    pub fn raw(&mut self) -> &mut dyn Write {
        &mut self.to
    }

    /// Fills in the digest.
    pub fn finish(&mut self, document: &Document) -> io::Result<()> {
        self.to.seek(SeekFrom::Start(self.digest_at))?;
        self.to.write_all(document.sha256.as_bytes())?;
        self.to.seek(SeekFrom::End(0))?;
        self.to.flush()
    }
}

/// One word of an array.
#[derive(Clone, Copy)]
pub(super) enum Word {
    F4(f32),
    F8(f64),
    I4(i32),
    U4(u32),
    U2(u16),
}

impl Word {
    /// The words of a row.
    pub fn row<'b>(array: &Array, bytes: &'b [u8], row: usize) -> impl Iterator<Item = Self> + use<'b> {
        let kind = array.dtype;
        bytes[row * array.stride()..][..array.stride()].chunks_exact(kind.bytes()).map(move |b| Self::of(kind, b))
    }

    fn of(kind: WordType, b: &[u8]) -> Self {
        let mut eight = [0; 8];
        eight[..b.len()].copy_from_slice(b);
        let bits = u64::from_le_bytes(eight);
        match kind {
            WordType::F4 => Self::F4(f32::from_bits(bits as u32)),
            WordType::F8 => Self::F8(f64::from_bits(bits)),
            WordType::I4 => Self::I4((bits as u32).cast_signed()),
            WordType::U4 => Self::U4(bits as u32),
            WordType::U2 => Self::U2(bits as u16),
        }
    }

    /// The bits in hexadecimal digits.
    pub fn hex(self) -> String {
        match self {
            Self::F4(x) => format!("{:08x}", x.to_bits()),
            Self::F8(x) => format!("{:016x}", x.to_bits()),
            Self::I4(x) => format!("{x:08x}"),
            Self::U4(x) => format!("{x:08x}"),
            Self::U2(x) => format!("{x:04x}"),
        }
    }

    /// The decimal that reads back to the same bits.
    pub fn decimal(self) -> String {
        match self {
            Self::F4(x) => decimal_32(x),
            Self::F8(x) => decimal_64(x),
            Self::I4(x) => x.to_string(),
            Self::U4(x) => x.to_string(),
            Self::U2(x) => x.to_string(),
        }
    }

    /// True for what has a decimal of digits.
    pub fn is_finite(self) -> bool {
        match self {
            Self::F4(x) => x.is_finite(),
            Self::F8(x) => x.is_finite(),
            Self::I4(_) | Self::U4(_) | Self::U2(_) => true,
        }
    }
}
