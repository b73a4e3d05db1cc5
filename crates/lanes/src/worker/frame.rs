//! Frames: a message in JSON, and the words behind it as they are.
//!
//! `SCW1`, the length of the message in bytes, the number of words, the CRC-32 of all of it but these sixteen bytes; the
//! message; the words. Numbers are little-endian.

use std::borrow::Cow;
use std::io::{self, Read, Write};

use serde::Serialize;
use serde::de::DeserializeOwned;

const MAGIC: [u8; 4] = *b"SCW1";
/// Bytes of a message, and words behind it, that are believed.
const MOST: u32 = 1 << 26;

/// A message with its words.
#[derive(Debug, PartialEq, Eq)]
pub struct Frame<M> {
    /// What is asked or answered, sent as JSON.
    pub message: M,
    /// The words behind it.
    pub words: Vec<u32>,
}

/// Writes a frame.
///
/// # Errors
/// Those of the writer, and more than fits into a frame.
pub fn write_frame<M: Serialize>(to: &mut dyn Write, message: &M, words: &[&[u32]]) -> io::Result<()> {
    let text = serde_json::to_vec(message)?;
    let count: usize = words.iter().map(|w| w.len()).sum();
    let fits = |n: usize| u32::try_from(n).ok().filter(|n| *n <= MOST);
    let (Some(length), Some(count)) = (fits(text.len()), fits(count)) else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "too much for one message"));
    };
    let mut crc = crc32fast::Hasher::new();
    crc.update(&text);
    let swapped: Vec<Cow<'_, [u32]>> = words.iter().map(|w| little(w)).collect();
    swapped.iter().for_each(|w| crc.update(bytemuck::cast_slice(w)));
    to.write_all(&MAGIC)?;
    for number in [length, count, crc.finalize()] {
        to.write_all(&number.to_le_bytes())?;
    }
    to.write_all(&text)?;
    swapped.iter().try_for_each(|w| to.write_all(bytemuck::cast_slice(w)))
}

/// Words as they are written; most machines have them so.
fn little(words: &[u32]) -> Cow<'_, [u32]> {
    if cfg!(target_endian = "little") {
        return words.into();
    }
    words.iter().map(|word| word.to_le()).collect::<Vec<_>>().into()
}

/// Reads a frame; `None` where the other side has ended between two.
///
/// # Errors
/// Those of the reader, with [`io::ErrorKind::UnexpectedEof`] for a frame that is cut off, and
/// [`io::ErrorKind::InvalidData`] for what is no frame.
pub fn read_frame<M: DeserializeOwned>(from: &mut dyn Read) -> io::Result<Option<Frame<M>>> {
    let wrong = |what: String| io::Error::new(io::ErrorKind::InvalidData, what);
    let mut magic = [0; 4];
    if from.read(&mut magic[..1])? == 0 {
        return Ok(None);
    }
    from.read_exact(&mut magic[1..])?;
    if magic != MAGIC {
        return Err(wrong(format!("`{}` is no start of a message", magic.escape_ascii())));
    }
    let mut number = || -> io::Result<u32> {
        let mut bytes = [0; 4];
        from.read_exact(&mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    };
    let (length, count, sum) = (number()?, number()?, number()?);
    if length > MOST || count > MOST {
        return Err(wrong(format!("a message of {length} bytes and {count} words")));
    }
    let mut text = Vec::new();
    from.take(length.into()).read_to_end(&mut text)?;
    if text.len() < length as usize {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    let mut words = vec![0_u32; count as usize];
    from.read_exact(bytemuck::cast_slice_mut(&mut words))?;
    let mut crc = crc32fast::Hasher::new();
    crc.update(&text);
    crc.update(bytemuck::cast_slice(&words));
    if crc.finalize() != sum {
        return Err(wrong("a message with a wrong check sum".to_owned()));
    }
    if cfg!(target_endian = "big") {
        words.iter_mut().for_each(|word| *word = u32::from_le(*word));
    }
    let message = serde_json::from_slice(&text).map_err(|error| wrong(format!("a message that is none: {error}")))?;
    Ok(Some(Frame { message, words }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written() -> Vec<u8> {
        let mut bytes = Vec::new();
        write_frame(&mut bytes, &"a message".to_owned(), &[&[1, 2], &[0xffff_ffff]]).unwrap();
        bytes
    }

    fn read(bytes: &[u8]) -> io::Result<Option<Frame<String>>> {
        read_frame(&mut { bytes })
    }

    #[test]
    fn a_frame_reads_back() {
        let frame = read(&written()).unwrap().unwrap();
        assert_eq!((frame.message.as_str(), frame.words.as_slice()), ("a message", &[1, 2, 0xffff_ffff][..]));
        assert!(read(&[]).unwrap().is_none());
    }

    #[test]
    fn every_prefix_and_every_changed_byte_is_refused() {
        let bytes = written();
        for end in 1..bytes.len() {
            assert_eq!(read(&bytes[..end]).unwrap_err().kind(), io::ErrorKind::UnexpectedEof, "{end}");
        }
        for at in 0..bytes.len() {
            let mut bytes = bytes.clone();
            bytes[at] ^= 0x10;
            assert!(read(&bytes).is_err(), "{at}");
        }
    }

    #[test]
    fn a_message_of_any_length_is_not_believed() {
        let mut bytes = written();
        bytes[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
        assert_eq!(read(&bytes).unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
