//! Archives of arrays, and single arrays.

use std::io::{self, ErrorKind, Read};

use flate2::read::DeflateDecoder;
use zip::{CompressionMethod, ZipArchive};

use super::blocks::Numbers as Where;
use super::npy::{Head, Plain};
use super::shared::Shared;
use super::windows::Windows;
use super::{Column, MOST_TEXT, Numbers, ReadError, Table, Wanted};
use crate::array::{Array, WordType};
use crate::document::Document;

fn damaged(error: impl std::fmt::Display) -> ReadError {
    ReadError::Damaged(format!("it is no archive of arrays, cut off or damaged: {error}"))
}

/// The bytes of a file in an archive. What is compressed is unpacked as it is read: a few bytes may stand for
/// more than any memory holds.
struct Member {
    from: Box<dyn Read + Send>,
    size: u64,
    left: u64,
    /// The check sum so far and the one in the archive; none for a stored array, which has a digest.
    sum: Option<(crc32fast::Hasher, u32)>,
}

impl Member {
    fn new(from: Box<dyn Read + Send>, size: u64, sum: Option<u32>) -> Self {
        Self { from, size, left: size, sum: sum.map(|sum| (crc32fast::Hasher::new(), sum)) }
    }

    /// At the end: is there more, and is it what was packed?
    fn end(&mut self) -> io::Result<usize> {
        let wrong = |what: &str| Err(io::Error::new(ErrorKind::InvalidData, what.to_owned()));
        let Some((sum, stated)) = self.sum.take() else { return Ok(0) };
        if self.from.read(&mut [0])? > 0 {
            return wrong("it is longer than the archive says");
        }
        if sum.finalize() == stated { Ok(0) } else { wrong("Invalid checksum") }
    }
}

impl Read for Member {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        if buf.is_empty() {
            return Ok(0);
        }
        if self.left == 0 {
            return self.end();
        }
        let wanted = buf.len().min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let read = self.from.read(&mut buf[..wanted])?;
        if let Some((sum, _)) = &mut self.sum {
            sum.update(&buf[..read]);
        }
        self.left -= read as u64;
        Ok(read)
    }
}

/// The files of an archive by their names.
fn members(from: &Shared) -> Result<Vec<(String, Member)>, ReadError> {
    let mut magic = Vec::new();
    from.at(0).take(6).read_to_end(&mut magic)?;
    if magic == b"\x93NUMPY" {
        return Ok(vec![(String::new(), Member::new(Box::new(from.at(0)), from.length(), None))]);
    }
    let mut archive = ZipArchive::new(from.at(0)).map_err(damaged)?;
    let mut members = Vec::new();
    for at in 0..archive.len() {
        let member = archive.by_index(at).map_err(damaged)?;
        let name = member.name().map_err(damaged)?.trim_end_matches(".npy").to_owned();
        let start = member.data_start().ok_or_else(|| damaged(format!("`{name}` has no place in it")))?;
        let packed = from.at(start).take(member.compressed_size());
        let member = match member.compression() {
            CompressionMethod::Stored => {
                let size = member.size().min(from.length().saturating_sub(start));
                Member::new(Box::new(packed), size, (name == "provenance").then(|| member.crc32()))
            }
            CompressionMethod::Deflated => {
                Member::new(Box::new(DeflateDecoder::new(packed)), member.size(), Some(member.crc32()))
            }
            other => return Err(damaged(format!("`{name}` is compressed by {other}; `deflate` is read"))),
        };
        members.push((name, member));
    }
    Ok(members)
}

/// An array of which the head was read.
pub(super) struct Stored {
    name: String,
    from: Member,
    width: usize,
    rows: u64,
    plain: Plain,
}

impl Stored {
    fn open(name: String, mut from: Member) -> Result<Self, ReadError> {
        let wrong = |why: String| ReadError::Damaged(format!("the array `{name}`: {why}"));
        let Head { plain, by_columns, shape } = Head::read(&mut from).map_err(|error| wrong(error.to_string()))?;
        if by_columns && shape.len() > 1 {
            return Err(wrong("it is stored column by column; write numpy.ascontiguousarray of it".into()));
        }
        let Some(plain) = plain else {
            return Err(wrong("it has records; write one array for each of their members".into()));
        };
        let known = matches!((plain.letter, plain.bytes), ('f' | 'i' | 'u', 4 | 8) | ('u', 1 | 2));
        if !known {
            return Err(wrong(format!("numbers of type `{}` are not read; float32 and float64 are", plain.text)));
        }
        let bytes = plain.bytes as u64;
        let product = |from: u64, sizes: &[u64]| sizes.iter().try_fold(from, |all, &n| all.checked_mul(n));
        let wanted = product(bytes, &shape);
        let (found, size) = (from.left, from.size);
        if wanted != Some(found) {
            let reported = wanted.map_or_else(|| "more than any file".to_owned(), |wanted| wanted.to_string());
            return Err(wrong(format!("it has {found} bytes, and its head says {reported}: it is cut off or damaged")));
        }
        let width = shape.get(1..).map_or(Some(1), |rest| product(1, rest)).and_then(|n| usize::try_from(n).ok());
        let width = width.ok_or_else(|| wrong(format!("its shape is that of no array of {size} bytes")))?;
        // A single number is an array of one.
        let rows = shape.first().copied().unwrap_or(1);
        Ok(Self { name, from, width, rows, plain })
    }

    /// The bytes of the next rows; at the end of the array it is seen to be whole.
    fn bytes(&mut self, rows: u64) -> Result<Vec<u8>, ReadError> {
        let rows = self.rows.min(rows);
        self.rows -= rows;
        let count = rows * (self.width * self.plain.bytes) as u64;
        let mut bytes = Vec::new();
        let wrong = |why: String| ReadError::Damaged(format!("the array `{}`: {why}", self.name));
        let end = self.rows == 0;
        let read = (&mut self.from).take(count).read_to_end(&mut bytes);
        let read = read.and_then(|_| if end { self.from.read(&mut [0]) } else { Ok(0) });
        read.map_err(|error| wrong(error.to_string()))?;
        if bytes.len() as u64 == count {
            return Ok(bytes);
        }
        Err(ReadError::Damaged(format!("the array `{}` is cut off", self.name)))
    }

    /// The next rows.
    fn next(&mut self, rows: usize) -> Result<Column, ReadError> {
        let bytes = self.bytes(rows as u64)?;
        Ok(Column { name: self.name.clone(), width: self.width, numbers: numbers(&self.plain, &bytes) })
    }

    /// The next rows as the words of an array of a reference, whatever their type in the file is.
    pub fn words(&mut self, rows: u64, kind: WordType) -> Result<Vec<u8>, ReadError> {
        let bytes = self.bytes(rows)?;
        if self.plain.text == kind.name() {
            return Ok(bytes);
        }
        let numbers = numbers(&self.plain, &bytes);
        let mut words = Vec::with_capacity(numbers.len() * kind.bytes());
        (0..numbers.len()).for_each(|at| numbers.write(at, kind, &mut words));
        Ok(words)
    }
}

/// Bytes as the numbers that they are.
fn numbers(plain: &Plain, bytes: &[u8]) -> Numbers {
    let (big, size) = (plain.big, plain.bytes);
    let whole = |b: &[u8]| -> u64 {
        let join = |n: u64, &byte: &u8| n << 8 | u64::from(byte);
        if big { b.iter().fold(0, join) } else { b.iter().rev().fold(0, join) }
    };
    let words = bytes.chunks_exact(size).map(whole);
    match (plain.letter, size) {
        ('f', 4) => Numbers::F4(words.map(|n| n as u32).collect()),
        ('f', _) => Numbers::F8(words.map(f64::from_bits).collect()),
        ('i', 4) => Numbers::Whole(words.map(|n| i64::from((n as u32).cast_signed())).collect()),
        _ => Numbers::Whole(words.map(u64::cast_signed).collect()),
    }
}

/// All arrays but the provenance, and whether they are read.
struct Arrays(Vec<(Stored, bool)>);

impl Windows for Arrays {
    fn next(&mut self, rows: usize) -> Result<Table, ReadError> {
        let column = |(array, read): &mut (Stored, bool)| match read {
            true => array.next(rows),
            false => Ok(Column::unread(&array.name, array.width)),
        };
        Ok(Table { columns: self.0.iter_mut().map(column).collect::<Result<_, _>>()? })
    }
}

pub(super) fn windows(from: &Shared, wanted: &Wanted) -> Result<Box<dyn Windows>, ReadError> {
    let members = members(from)?.into_iter().filter(|(name, _)| name != "provenance");
    let arrays: Vec<Stored> = members.map(|(name, from)| Stored::open(name, from)).collect::<Result<_, _>>()?;
    let read = wanted.select(arrays.iter().map(|array| (&*array.name, array.width))).map_err(ReadError::Damaged)?;
    Ok(Box::new(Arrays(arrays.into_iter().zip(read).collect())))
}

pub(super) fn opened(from: &Shared) -> Result<(Document, Where), ReadError> {
    let mut members = members(from)?;
    let mut take = |name: &str| {
        let at = members.iter().position(|(member, ..)| member == name)?;
        Some(members.swap_remove(at))
    };
    let Some((name, provenance)) = take("provenance") else {
        return Err(ReadError::Schema("it has no array `provenance`, which a reference file has".into()));
    };
    if provenance.size > MOST_TEXT {
        let size = provenance.size;
        return Err(ReadError::Schema(format!("its provenance has {size} bytes, and at most {MOST_TEXT} are read")));
    }
    let text = Stored::open(name, provenance)?.bytes(u64::MAX)?;
    let text = String::from_utf8(text).map_err(|_| ReadError::Schema("its provenance is no text".into()))?;
    let document = Document::read(&text).map_err(ReadError::Schema)?;
    let mut stored = Vec::new();
    for array in &document.arrays {
        let missing = || ReadError::Damaged(format!("it has no array `{}`", array.name));
        let (name, from) = take(&array.name).ok_or_else(missing)?;
        stored.push(fitting(Stored::open(name, from)?, array, &document)?);
    }
    Ok((document, Where::Arrays(stored)))
}

/// An array that has as many numbers as the document says.
fn fitting(found: Stored, array: &Array, document: &Document) -> Result<Stored, ReadError> {
    let wanted = document.array_rows(array, document.rows);
    if found.rows == wanted && found.width == array.words() {
        return Ok(found);
    }
    Err(ReadError::Damaged(format!(
        "the array `{}` has {} rows of {}, and its provenance says {wanted} of {}: the file is cut off or damaged",
        array.name,
        found.rows,
        found.width,
        array.words()
    )))
}
