//! A file that several readers share, each at a place of its own.

use std::io::{self, Read, Seek, SeekFrom};
use std::sync::{Arc, Mutex, PoisonError};

use super::Load;

/// One of the readers.
#[derive(Clone)]
pub struct Shared {
    from: Arc<Mutex<Box<dyn Load>>>,
    at: u64,
    length: u64,
}

impl Shared {
    /// The first reader, at the beginning.
    ///
    /// # Errors
    /// When the length of the file is not available.
    pub fn new(mut from: Box<dyn Load>) -> io::Result<Self> {
        let length = from.seek(SeekFrom::End(0))?;
        Ok(Self { from: Arc::new(Mutex::new(from)), at: 0, length })
    }

    /// Another reader, at this place.
    pub(super) fn at(&self, at: u64) -> Self {
        Self { at, ..self.clone() }
    }

    /// Bytes of the file.
    pub(super) fn length(&self) -> u64 {
        self.length
    }
}

impl Read for Shared {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let mut from = self.from.lock().unwrap_or_else(PoisonError::into_inner);
        from.seek(SeekFrom::Start(self.at))?;
        let read = from.read(buf)?;
        self.at += read as u64;
        Ok(read)
    }
}

impl Seek for Shared {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let at = match to {
            SeekFrom::Start(at) => Some(at),
            SeekFrom::End(by) => self.length.checked_add_signed(by),
            SeekFrom::Current(by) => self.at.checked_add_signed(by),
        };
        self.at = at.ok_or_else(|| io::Error::from(io::ErrorKind::InvalidInput))?;
        Ok(self.at)
    }
}
