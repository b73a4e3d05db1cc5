//! Archives of arrays, and single arrays.

use std::io::{Cursor, Read};

use npyz::{Endianness, NpyFile, NpyHeader, Order, TypeChar, TypeStr};
use zip::{CompressionMethod, ZipArchive};

use super::blocks::Numbers as Where;
use super::shared::Shared;
use super::windows::Windows;
use super::{Column, Numbers, ReadError, Table};
use crate::refdata::array::Kind;
use crate::refdata::document::Document;

fn damaged(error: impl std::fmt::Display) -> ReadError {
    ReadError::Damaged(format!("it is no archive of arrays, cut off or damaged: {error}"))
}

/// Names of the arrays, where their files begin, and how long these are. What is compressed is unpacked into
/// memory.
fn members(from: &Shared) -> Result<Vec<(String, Shared, u64)>, ReadError> {
    let mut magic = Vec::new();
    from.at(0).take(6).read_to_end(&mut magic)?;
    if magic == b"\x93NUMPY" {
        return Ok(vec![(String::new(), from.at(0), from.length())]);
    }
    let mut archive = ZipArchive::new(from.at(0)).map_err(damaged)?;
    let mut members = Vec::new();
    for at in 0..archive.len() {
        let mut member = archive.by_index(at).map_err(damaged)?;
        let name = member.name().map_err(damaged)?.trim_end_matches(".npy").to_owned();
        let start = member.data_start().filter(|_| member.compression() == CompressionMethod::Stored);
        let size = member.size();
        // What is small is read through the archive, which compares its check sum.
        if let Some(start) = start.filter(|_| name != "provenance") {
            members.push((name, from.at(start), size));
            continue;
        }
        let mut bytes = Vec::new();
        member.read_to_end(&mut bytes).map_err(|error| ReadError::Damaged(format!("the array `{name}`: {error}")))?;
        let size = bytes.len() as u64;
        members.push((name, Shared::new(Box::new(Cursor::new(bytes)))?, size));
    }
    Ok(members)
}

/// An array: where its numbers begin, and what they are.
struct Stored {
    name: String,
    from: Shared,
    width: usize,
    rows: u64,
    plain: TypeStr,
}

impl Stored {
    fn open(name: String, mut from: Shared, size: u64) -> Result<Self, ReadError> {
        let wrong = |why: String| ReadError::Damaged(format!("the array `{name}`: {why}"));
        let begin = from.place();
        let header = NpyHeader::from_reader(&mut from).map_err(|error| wrong(error.to_string()))?;
        let shape = header.shape().to_vec();
        if header.order() == Order::Fortran && shape.len() > 1 {
            return Err(wrong("it is stored column by column; write numpy.ascontiguousarray of it".into()));
        }
        let npyz::DType::Plain(plain) = header.dtype() else {
            return Err(wrong("it has records; write one array for each of their members".into()));
        };
        let known = matches!(
            (plain.type_char(), plain.num_bytes()),
            (TypeChar::Float | TypeChar::Int | TypeChar::Uint, Some(4 | 8)) | (TypeChar::Uint, Some(1 | 2))
        );
        if !known {
            return Err(wrong(format!("numbers of type `{plain}` are not read; float32 and float64 are")));
        }
        let bytes = plain.num_bytes().unwrap_or(0) as u64;
        let wanted = shape.iter().try_fold(bytes, |all, &n| all.checked_mul(n));
        let found = size.saturating_sub(from.place() - begin);
        if wanted != Some(found) || from.place() + found > from.length() {
            let found = found.min(from.length().saturating_sub(from.place()));
            let told = wanted.map_or_else(|| "more than any file".to_owned(), |wanted| wanted.to_string());
            return Err(wrong(format!("it has {found} bytes, and its head says {told}: it is cut off or damaged")));
        }
        let width = shape.iter().skip(1).product::<u64>() as usize;
        // A single number is an array of one.
        let rows = shape.first().copied().unwrap_or(1);
        Ok(Self { name, from, width, rows, plain })
    }

    /// The next rows.
    fn next(&mut self, rows: usize) -> Result<Column, ReadError> {
        let rows = self.rows.min(rows as u64);
        self.rows -= rows;
        let count = rows as usize * self.width * self.plain.num_bytes().unwrap_or(0);
        let bytes = bytes(&mut self.from, count as u64, &self.name)?;
        Ok(Column { name: self.name.clone(), width: self.width, numbers: numbers(&self.plain, &bytes) })
    }

    /// True where the file has the very bytes of the array.
    fn is(&self, kind: Kind) -> bool {
        self.plain.to_string() == kind.name()
    }
}

/// The next bytes of an array.
pub(super) fn bytes(from: &mut Shared, count: u64, name: &str) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    from.take(count).read_to_end(&mut bytes)?;
    if bytes.len() as u64 == count {
        return Ok(bytes);
    }
    Err(ReadError::Damaged(format!("the array `{name}` is cut off")))
}

/// Bytes as the numbers that they are.
fn numbers(plain: &TypeStr, bytes: &[u8]) -> Numbers {
    let big = plain.endianness() == Endianness::Big;
    let size = plain.num_bytes().unwrap_or(1).max(1);
    let whole = |b: &[u8]| -> u64 {
        let join = |n: u64, &byte: &u8| n << 8 | u64::from(byte);
        if big { b.iter().fold(0, join) } else { b.iter().rev().fold(0, join) }
    };
    let words = bytes.chunks_exact(size).map(whole);
    match (plain.type_char(), size) {
        (TypeChar::Float, 4) => Numbers::F4(words.map(|n| n as u32).collect()),
        (TypeChar::Float, _) => Numbers::F8(words.map(f64::from_bits).collect()),
        (TypeChar::Int, 4) => Numbers::Whole(words.map(|n| i64::from((n as u32).cast_signed())).collect()),
        _ => Numbers::Whole(words.map(u64::cast_signed).collect()),
    }
}

/// All arrays but the provenance.
struct Arrays(Vec<Stored>);

impl Windows for Arrays {
    fn next(&mut self, rows: usize) -> Result<Table, ReadError> {
        let columns = self.0.iter_mut().map(|array| array.next(rows)).collect::<Result<_, _>>()?;
        Ok(Table { columns })
    }
}

pub(super) fn windows(from: &Shared) -> Result<Box<dyn Windows>, ReadError> {
    let members = members(from)?.into_iter().filter(|(name, ..)| name != "provenance");
    let arrays = members.map(|(name, from, size)| Stored::open(name, from, size)).collect::<Result<_, _>>()?;
    Ok(Box::new(Arrays(arrays)))
}

pub(super) fn opened(from: &Shared) -> Result<(Document, Where), ReadError> {
    let mut members = members(from)?;
    let mut take = |name: &str| {
        let at = members.iter().position(|(member, ..)| member == name)?;
        Some(members.swap_remove(at))
    };
    let Some((_, provenance, _)) = take("provenance") else {
        return Err(ReadError::Schema("it has no array `provenance`, which a reference file has".into()));
    };
    let text = NpyFile::new(provenance).and_then(NpyFile::into_vec::<u8>).map_err(damaged)?;
    let text = String::from_utf8(text).map_err(|_| ReadError::Schema("its provenance is no text".into()))?;
    let document = Document::read(&text).map_err(ReadError::Schema)?;
    let mut stored = Vec::new();
    for array in &document.arrays {
        let (name, from, size) =
            take(&array.name).ok_or_else(|| ReadError::Damaged(format!("it has no array `{}`", array.name)))?;
        let found = Stored::open(name, from, size)?;
        let wanted = document.array_rows(array, document.rows);
        if found.rows != wanted || found.width != array.words() {
            return Err(ReadError::Damaged(format!(
                "the array `{}` has {} rows of {}, and its provenance says {wanted} of {}: the file is cut off or \
                 damaged",
                array.name,
                found.rows,
                found.width,
                array.words()
            )));
        }
        stored.push(found);
    }
    if document.arrays.iter().zip(&stored).all(|(array, found)| found.is(array.dtype)) {
        return Ok((document, Where::Arrays(stored.into_iter().map(|found| found.from).collect())));
    }
    // Somebody wrote the numbers in other types.
    let mut arrays = Vec::new();
    for (array, mut found) in document.arrays.iter().zip(stored) {
        let column = found.next(usize::MAX)?;
        let mut bytes = Vec::with_capacity(column.numbers.len() * array.dtype.bytes());
        (0..column.numbers.len()).for_each(|at| column.numbers.write(at, array.dtype, &mut bytes));
        arrays.push(bytes);
    }
    Ok((document, Where::Whole(arrays)))
}
