//! Source texts are read with a limit.

use std::fs;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Bytes of a source text, at most: reading a text takes many times its size.
pub const MOST_BYTES: u64 = 16 << 20;

/// The bytes of a source text: of a shader, a suite file, or what these include.
///
/// # Errors
/// What the system says, and [`ErrorKind::FileTooLarge`].
pub fn read_source(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // A device may have no end, and no size either.
    fs::File::open(path)?.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 <= MOST_BYTES {
        return Ok(bytes);
    }
    let why = format!("it has more than {MOST_BYTES} bytes, which no source text needs");
    Err(std::io::Error::new(ErrorKind::FileTooLarge, why))
}
