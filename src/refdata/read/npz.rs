//! Archives of arrays, and single arrays.

use std::io::{Cursor, Read, SeekFrom};

use npyz::{NpyFile, Order, TypeChar};
use zip::ZipArchive;

use super::{Column, Dataset, Load, Numbers, ReadError, Table};
use crate::refdata::document::Document;

fn damaged(error: impl std::fmt::Display) -> ReadError {
    ReadError::Damaged(format!("it is no archive of arrays, cut off or damaged: {error}"))
}

/// Names and bytes of the arrays.
fn members(from: &mut dyn Load) -> Result<Vec<(String, Vec<u8>)>, ReadError> {
    from.seek(SeekFrom::Start(0))?;
    let mut magic = [0; 6];
    let mut read = 0;
    while read < magic.len() {
        match from.read(&mut magic[read..])? {
            0 => break,
            n => read += n,
        }
    }
    from.seek(SeekFrom::Start(0))?;
    if &magic == b"\x93NUMPY" {
        let mut bytes = Vec::new();
        from.read_to_end(&mut bytes)?;
        return Ok(vec![(String::new(), bytes)]);
    }
    let mut archive = ZipArchive::new(from).map_err(damaged)?;
    let mut members = Vec::new();
    for at in 0..archive.len() {
        let mut member = archive.by_index(at).map_err(damaged)?;
        let name = member.name().map_err(damaged)?.trim_end_matches(".npy").to_owned();
        let mut bytes = Vec::new();
        // The check sum of the archive is compared while its member is read.
        member.read_to_end(&mut bytes).map_err(|error| ReadError::Damaged(format!("the array `{name}`: {error}")))?;
        members.push((name, bytes));
    }
    Ok(members)
}

fn column(name: &str, bytes: &[u8]) -> Result<Column, ReadError> {
    let wrong = |why: String| ReadError::Damaged(format!("the array `{name}`: {why}"));
    let file = NpyFile::new(Cursor::new(bytes)).map_err(|error| wrong(error.to_string()))?;
    let shape = file.shape().to_vec();
    let by_column = file.header().order() == Order::Fortran && shape.len() > 1;
    if by_column {
        return Err(wrong("it is stored column by column; write numpy.ascontiguousarray of it".into()));
    }
    let npyz::DType::Plain(plain) = file.dtype() else {
        return Err(wrong("it has records; write one array for each of their members".into()));
    };
    let width = shape.iter().skip(1).product::<u64>() as usize;
    let text = |error: std::io::Error| wrong(error.to_string());
    let numbers = match (plain.type_char(), plain.num_bytes()) {
        (TypeChar::Float, Some(4)) => {
            let list = file.into_vec::<f32>().map_err(text)?;
            Numbers::F4(list.into_iter().map(f32::to_bits).collect())
        }
        (TypeChar::Float, Some(8)) => Numbers::F8(file.into_vec::<f64>().map_err(text)?),
        (TypeChar::Int, Some(4)) => {
            Numbers::Whole(file.into_vec::<i32>().map_err(text)?.into_iter().map(i64::from).collect())
        }
        (TypeChar::Int, Some(8)) => Numbers::Whole(file.into_vec::<i64>().map_err(text)?),
        (TypeChar::Uint, Some(1)) => {
            Numbers::Whole(file.into_vec::<u8>().map_err(text)?.into_iter().map(i64::from).collect())
        }
        (TypeChar::Uint, Some(2)) => {
            Numbers::Whole(file.into_vec::<u16>().map_err(text)?.into_iter().map(i64::from).collect())
        }
        (TypeChar::Uint, Some(4)) => {
            Numbers::Whole(file.into_vec::<u32>().map_err(text)?.into_iter().map(i64::from).collect())
        }
        (TypeChar::Uint, Some(8)) => {
            Numbers::Whole(file.into_vec::<u64>().map_err(text)?.into_iter().map(u64::cast_signed).collect())
        }
        _ => return Err(wrong(format!("numbers of type `{plain}` are not read; float32 and float64 are"))),
    };
    Ok(Column { name: name.to_owned(), width, numbers })
}

pub(super) fn table(from: &mut dyn Load) -> Result<Table, ReadError> {
    let mut table = Table::default();
    for (name, bytes) in members(from)? {
        if name != "provenance" {
            table.columns.push(column(&name, &bytes)?);
        }
    }
    Ok(table)
}

pub(super) fn dataset(from: &mut dyn Load) -> Result<Dataset, ReadError> {
    let members = members(from)?;
    let of = |name: &str| members.iter().find(|(member, _)| member == name).map(|(_, bytes)| bytes);
    let Some(provenance) = of("provenance") else {
        return Err(ReadError::Schema("it has no array `provenance`, which a reference file has".into()));
    };
    let text = NpyFile::new(Cursor::new(provenance)).and_then(NpyFile::into_vec::<u8>).map_err(damaged)?;
    let text = String::from_utf8(text).map_err(|_| ReadError::Schema("its provenance is no text".into()))?;
    let document = Document::read(&text).map_err(ReadError::Schema)?;
    let mut arrays = Vec::new();
    for array in &document.arrays {
        let missing = || ReadError::Damaged(format!("it has no array `{}`", array.name));
        let column = column(&array.name, of(&array.name).ok_or_else(missing)?)?;
        let mut bytes = Vec::with_capacity(column.numbers.len() * array.dtype.bytes());
        (0..column.numbers.len()).for_each(|at| column.numbers.write(at, array.dtype, &mut bytes));
        arrays.push(bytes);
    }
    Ok(Dataset { document, arrays })
}
