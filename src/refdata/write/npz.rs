//! NPZ: an archive of arrays as `numpy.savez` writes it, without compression.
//!
//! All arrays of an archive grow side by side while blocks come. As their sizes are known before, each
//! has its place in the file from the start; libraries for archives write one member after the other, and
//! would need every array a second time. Times of the members are those of 1980, where the format begins.

use std::io::{self, Seek, SeekFrom, Write};

use crc32fast::Hasher;

use super::{Sink, Store};
use crate::refdata::document::Document;
use crate::refdata::generate::Block;

/// From this size or offset on, members have their sizes in an extra field.
const LARGE: u64 = 0xffff_ffff;

pub(super) struct Npz<'s> {
    to: Box<dyn Store + 's>,
    members: Vec<Member>,
}

struct Member {
    name: String,
    /// Where its local header begins.
    header_at: u64,
    /// Where its next bytes go.
    next: u64,
    size: u64,
    sum: Hasher,
}

impl Member {
    fn is_large(&self) -> bool {
        self.size >= LARGE
    }

    fn local_header(&self) -> Vec<u8> {
        let mut out = 0x0403_4b50_u32.to_le_bytes().to_vec();
        self.common(&mut out);
        let extra: u16 = if self.is_large() { 20 } else { 0 };
        out.extend(extra.to_le_bytes());
        out.extend(self.name.as_bytes());
        if self.is_large() {
            out.extend([1, 0, 16, 0]);
            out.extend(self.size.to_le_bytes());
            out.extend(self.size.to_le_bytes());
        }
        out
    }

    /// Version, flags, method, time, check sum, sizes, length of the name.
    fn common(&self, out: &mut Vec<u8>) {
        let version: u16 = if self.is_large() || self.header_at >= LARGE { 45 } else { 20 };
        out.extend(version.to_le_bytes());
        out.extend([0, 0, 0, 0]);
        // 0:00 on the first of January 1980
        out.extend([0, 0, 0x21, 0]);
        out.extend(self.sum.clone().finalize().to_le_bytes());
        let size = if self.is_large() { LARGE as u32 } else { self.size as u32 };
        out.extend(size.to_le_bytes());
        out.extend(size.to_le_bytes());
        out.extend((self.name.len() as u16).to_le_bytes());
    }

    fn directory_entry(&self) -> Vec<u8> {
        let mut out = 0x0201_4b50_u32.to_le_bytes().to_vec();
        out.extend(45_u16.to_le_bytes());
        self.common(&mut out);
        let mut extra = Vec::new();
        if self.is_large() {
            extra.extend(self.size.to_le_bytes());
            extra.extend(self.size.to_le_bytes());
        }
        if self.header_at >= LARGE {
            extra.extend(self.header_at.to_le_bytes());
        }
        let length = if extra.is_empty() { 0 } else { extra.len() as u16 + 4 };
        out.extend(length.to_le_bytes());
        // No comment, first disk, no attributes.
        out.extend([0; 10]);
        out.extend(self.header_at.min(LARGE).to_le_bytes()[..4].iter());
        out.extend(self.name.as_bytes());
        if !extra.is_empty() {
            out.extend([1, 0]);
            out.extend((extra.len() as u16).to_le_bytes());
            out.extend(extra);
        }
        out
    }
}

/// What stands before the numbers of an array.
fn npy_header(dtype: &str, shape: &[u64]) -> Vec<u8> {
    let shape: Vec<String> = shape.iter().map(u64::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let mut dict = format!("{{'descr': '{dtype}', 'fortran_order': False, 'shape': ({}{comma}), }}", shape.join(", "));
    // Numbers begin at a multiple of 64 bytes, the text ends with a line end.
    let pad = 63 - (10 + dict.len()) % 64;
    dict.extend(std::iter::repeat_n(' ', pad));
    dict.push('\n');
    let mut out = b"\x93NUMPY\x01\x00".to_vec();
    out.extend((dict.len() as u16).to_le_bytes());
    out.extend(dict.as_bytes());
    out
}

impl<'s> Npz<'s> {
    pub fn new(document: &Document, store: Box<dyn Store + 's>) -> io::Result<Self> {
        let mut writer = Self { to: store, members: Vec::new() };
        let mut at = 0;
        for array in &document.arrays {
            let rows = document.array_rows(array, document.rows);
            let shape: Vec<u64> = [rows].into_iter().chain(array.shape.iter().map(|&n| n as u64)).collect();
            let header = npy_header(array.dtype.name(), &shape);
            let data = rows * array.stride() as u64;
            at = writer.begin(&array.name, &header, data, at)?;
        }
        let text = document.line();
        writer.begin("provenance", &npy_header("|u1", &[text.len() as u64]), text.len() as u64, at)?;
        Ok(writer)
    }

    /// Makes room for a member at `at` and writes the head of its array; gives where it ends.
    fn begin(&mut self, name: &str, header: &[u8], data: u64, at: u64) -> io::Result<u64> {
        let mut member = Member {
            name: format!("{name}.npy"),
            header_at: at,
            next: 0,
            size: header.len() as u64 + data,
            sum: Hasher::new(),
        };
        let begin = at + member.local_header().len() as u64;
        member.next = begin;
        let end = begin + member.size;
        self.members.push(member);
        self.append(self.members.len() - 1, header)?;
        Ok(end)
    }

    fn append(&mut self, member: usize, bytes: &[u8]) -> io::Result<()> {
        let member = &mut self.members[member];
        member.sum.update(bytes);
        self.to.seek(SeekFrom::Start(member.next))?;
        member.next += bytes.len() as u64;
        self.to.write_all(bytes)
    }
}

impl Sink for Npz<'_> {
    fn block(&mut self, block: &Block) -> io::Result<()> {
        for (k, bytes) in block.arrays.iter().enumerate() {
            self.append(k, bytes)?;
        }
        Ok(())
    }

    fn finish(&mut self, document: &Document) -> io::Result<()> {
        self.append(self.members.len() - 1, document.line().as_bytes())?;
        let mut end = 0;
        for member in &self.members {
            self.to.seek(SeekFrom::Start(member.header_at))?;
            self.to.write_all(&member.local_header())?;
            end = member.next;
        }
        let directory: Vec<u8> = self.members.iter().flat_map(Member::directory_entry).collect();
        let count = self.members.len() as u64;
        let mut tail = Vec::new();
        if end >= LARGE || count >= 0xffff {
            tail.extend(0x0606_4b50_u32.to_le_bytes());
            tail.extend(44_u64.to_le_bytes());
            tail.extend([45, 0, 45, 0]);
            tail.extend([0; 8]);
            for number in [count, count, directory.len() as u64, end] {
                tail.extend(number.to_le_bytes());
            }
            tail.extend(0x0706_4b50_u32.to_le_bytes());
            tail.extend([0; 4]);
            tail.extend((end + directory.len() as u64).to_le_bytes());
            tail.extend(1_u32.to_le_bytes());
        }
        tail.extend(0x0605_4b50_u32.to_le_bytes());
        tail.extend([0; 4]);
        for _ in 0..2 {
            tail.extend((count.min(0xffff) as u16).to_le_bytes());
        }
        tail.extend((directory.len() as u32).to_le_bytes());
        tail.extend((end.min(LARGE) as u32).to_le_bytes());
        tail.extend([0; 2]);
        self.to.seek(SeekFrom::Start(end))?;
        self.to.write_all(&directory)?;
        self.to.write_all(&tail)?;
        self.to.flush()
    }
}
