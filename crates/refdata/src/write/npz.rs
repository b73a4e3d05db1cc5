//! NPZ: an archive of arrays as `numpy.savez` writes it, without compression.
//!
//! All arrays of an archive grow side by side while blocks come. As their sizes are known before, each
//! has its place in the file from the start; libraries for archives write one member after the other, and
//! would need every array a second time. Times of the members are those of 1980, where the format begins.

use std::io::{self, Seek, SeekFrom, Write};

use crc32fast::Hasher;

use super::{Sink, Store};
use crate::document::Document;
use crate::generate::Block;

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

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::{Read, Seek};
    use std::process::Command;

    use npyz::NpyFile;
    use zip::ZipArchive;

    use super::*;
    use crate::array::{Array, Per, Role, WordType};
    use crate::tests::{dataset, file};
    use crate::write::Format;

    /// A document with these arrays, each of a name and bytes of a row.
    fn document(rows: u64, arrays: impl Iterator<Item = (String, usize)>) -> Document {
        let known = dataset(&file("bone_weight", None, Format::Npz, 1), Format::Npz).unwrap().document;
        let array = |(name, words): (String, usize)| Array {
            name,
            role: Role::Nearest,
            variable: String::new(),
            ty: String::new(),
            dtype: WordType::F4,
            per: Per::Sample,
            shape: vec![words],
            components: Vec::new(),
        };
        Document { rows, samples: rows, arrays: arrays.map(array).collect(), ..known }
    }

    /// What Python makes of a file; none, and told so, where it is not there.
    fn python(path: &std::path::Path, program: &str) -> Option<String> {
        let Ok(output) = Command::new("python3").arg("-c").arg(program).arg(path).output() else {
            test_record::not_run("there is no python3: large archives were not read by it");
            return None;
        };
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(String::from_utf8(output.stdout).unwrap())
    }

    /// An archive of 6 GiB, of which holes are not written: its first array is larger than 4 GiB, and the others
    /// begin behind that.
    #[test]
    fn an_archive_beyond_4_gib_is_read_by_others() {
        const ROWS: u64 = 3;
        const WORDS: u64 = 1 << 29;
        let document = document(ROWS, [("large".to_owned(), WORDS as usize), ("small".to_owned(), 2)].into_iter());
        let file = tempfile::NamedTempFile::new().unwrap();
        let mut writer = Npz::new(&document, Box::new(file.reopen().unwrap())).unwrap();
        let small: Vec<u8> = (1..=6_u8).flat_map(|n| f32::from(n).to_le_bytes()).collect();
        writer.append(1, &small).unwrap();
        writer.finish(&document).unwrap();
        assert!(file.as_file().metadata().unwrap().len() > 6 << 30);

        let mut archive = ZipArchive::new(File::open(file.path()).unwrap()).unwrap();
        let large = archive.by_name("large.npy").unwrap();
        assert_eq!(large.size(), 4 * ROWS * WORDS + 128);
        drop(large);
        let mut bytes = Vec::new();
        let mut member = archive.by_name("small.npy").unwrap();
        assert!(member.data_start().unwrap() > u64::from(u32::MAX));
        // The check sum is compared at the end.
        member.read_to_end(&mut bytes).unwrap();
        assert_eq!(NpyFile::new(&bytes[..]).unwrap().into_vec::<f32>().unwrap(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);

        let program = "import sys, zipfile\nz = zipfile.ZipFile(sys.argv[1])\n\
                       print([(i.filename, i.file_size) for i in z.infolist()][:2], len(z.read('small.npy')))\n\
                       print(z.open('large.npy').read(6))";
        if let Some(reported) = python(file.path(), program) {
            let (large, small) = (4 * ROWS * WORDS + 128, bytes.len());
            let list = format!("[('large.npy', {large}), ('small.npy', {small})]");
            assert_eq!(reported, format!("{list} {small}\nb'\\x93NUMPY'\n"));
        }
    }

    #[test]
    fn more_than_65535_arrays_are_read_by_others() {
        const COUNT: usize = 70_000;
        let document = document(1, (0..COUNT).map(|k| (format!("a{k}"), 1)));
        let file = tempfile::NamedTempFile::new().unwrap();
        let mut store = std::io::BufWriter::new(file.reopen().unwrap());
        store.seek(SeekFrom::Start(0)).unwrap();
        let mut writer = Npz::new(&document, Box::new(store)).unwrap();
        for k in 0..COUNT {
            writer.append(k, &(k as f32).to_le_bytes()).unwrap();
        }
        writer.finish(&document).unwrap();
        drop(writer);
        let mut archive = ZipArchive::new(File::open(file.path()).unwrap()).unwrap();
        assert_eq!(archive.len(), COUNT + 1);
        let mut bytes = Vec::new();
        archive.by_name("a69999.npy").unwrap().read_to_end(&mut bytes).unwrap();
        assert_eq!(NpyFile::new(&bytes[..]).unwrap().into_vec::<f32>().unwrap(), [69_999.0]);
        let program = "import sys, zipfile\nz = zipfile.ZipFile(sys.argv[1])\nprint(len(z.namelist()), z.testzip())";
        if let Some(reported) = python(file.path(), program) {
            assert_eq!(reported, "70001 None\n");
        }
    }
}
