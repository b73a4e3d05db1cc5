//! The head of one array: a dictionary as Python writes it. Format: numpy.lib.format, versions 1.0 to 3.0.

use std::io::{self, ErrorKind, Read};

/// Bytes of the head of an array, at most: NumPy reads 10,000.
const HEAD: usize = 1 << 16;

/// What the head of an array says.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Head {
    /// The type of its numbers; none for records.
    pub plain: Option<Plain>,
    /// True for an array that is stored column by column.
    pub by_columns: bool,
    /// Its sizes, the slowest first; none for a single number.
    pub shape: Vec<u64>,
}

/// The type of the numbers of an array, such as `<f4`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Plain {
    /// As it stands in the head.
    pub text: String,
    /// `f` for numbers with a fraction, `i` and `u` for whole ones; others are not read.
    pub letter: char,
    /// Bytes of a number.
    pub bytes: usize,
    /// True where the highest byte comes first.
    pub big: bool,
}

impl Plain {
    fn new(text: String) -> Self {
        let mut chars = text.chars();
        let big = chars.next() == Some('>');
        let letter = chars.next().filter(|_| text.starts_with(['<', '>', '|'])).unwrap_or('?');
        let bytes = chars.as_str().parse().unwrap_or(0);
        Self { text, letter, bytes, big }
    }
}

fn wrong<T>(why: impl Into<String>) -> io::Result<T> {
    Err(io::Error::new(ErrorKind::InvalidData, why.into()))
}

impl Head {
    /// Reads the head of an array, in any version of the format, and not a byte more.
    pub fn read(from: &mut dyn Read) -> io::Result<Self> {
        let mut start = [0; 10];
        from.read_exact(&mut start)?;
        if !start.starts_with(b"\x93NUMPY") || !(1..=3).contains(&start[6]) {
            return wrong("it does not begin as an array of NumPy does, in version 1 to 3");
        }
        let mut length = usize::from(u16::from_le_bytes([start[8], start[9]]));
        if start[6] > 1 {
            let mut high = [0; 2];
            from.read_exact(&mut high)?;
            length |= usize::from(u16::from_le_bytes(high)) << 16;
        }
        if length > HEAD {
            return wrong(format!("its head has {length} bytes, and at most {HEAD} are read"));
        }
        let mut text = vec![0; length];
        from.read_exact(&mut text)?;
        let text = String::from_utf8_lossy(&text);
        Literal(&text).head().map_or_else(|| wrong(format!("its head is not read: {}", text.trim_end())), Ok)
    }
}

/// What is left of a text in Python.
struct Literal<'a>(&'a str);

impl Literal<'_> {
    fn take(&mut self, what: &str) -> Option<()> {
        self.0 = self.0.trim_start().strip_prefix(what)?;
        Some(())
    }

    fn head(&mut self) -> Option<Head> {
        let (mut plain, mut by_columns, mut shape) = (None, None, None);
        self.take("{")?;
        while self.take("}").is_none() {
            let key = self.string()?;
            self.take(":")?;
            match key.as_str() {
                "descr" if self.0.trim_start().starts_with('[') => plain = Some(self.records()?),
                "descr" => plain = Some(Some(Plain::new(self.string()?))),
                "fortran_order" => by_columns = Some(self.boolean()?),
                "shape" => shape = Some(self.sizes()?),
                _ => return None,
            }
            if self.take(",").is_none() && !self.0.trim_start().starts_with('}') {
                return None;
            }
        }
        let whole = self.0.trim().is_empty();
        Some(Head { plain: plain?, by_columns: by_columns?, shape: shape? }).filter(|_| whole)
    }

    fn string(&mut self) -> Option<String> {
        let quote = ["'", "\""].into_iter().find(|quote| self.take(quote).is_some())?;
        let (text, rest) = self.0.split_once(quote)?;
        self.0 = rest;
        Some(text.to_owned())
    }

    fn boolean(&mut self) -> Option<bool> {
        if self.take("True").is_some() { Some(true) } else { self.take("False").map(|()| false) }
    }

    fn sizes(&mut self) -> Option<Vec<u64>> {
        self.take("(")?;
        let mut sizes = Vec::new();
        while self.take(")").is_none() {
            let text = self.0.trim_start();
            let (digits, rest) = text.split_at(text.find(|c: char| !c.is_ascii_digit())?);
            self.0 = rest;
            sizes.push(digits.parse().ok()?);
            // Python 2 wrote long numbers with an L.
            let _ = self.take("L");
            if self.take(",").is_none() && !self.0.trim_start().starts_with(')') {
                return None;
            }
        }
        Some(sizes)
    }

    /// Passes over a list of the members of records, which are not read.
    fn records(&mut self) -> Option<Option<Plain>> {
        let mut depth = 0;
        loop {
            let at = self.0.find(['[', ']', '\'', '"'])?;
            let (_, rest) = self.0.split_at(at);
            if rest.starts_with(['\'', '"']) {
                self.0 = rest;
                self.string()?;
                continue;
            }
            depth += if rest.starts_with('[') { 1 } else { -1 };
            self.0 = &rest[1..];
            if depth == 0 {
                return Some(None);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(version: u8, text: &str) -> Result<Head, String> {
        let mut bytes = b"\x93NUMPY".to_vec();
        bytes.extend([version, 0]);
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(if version > 1 { &[0, 0][..] } else { &[] });
        bytes.extend(text.bytes());
        Head::read(&mut &bytes[..]).map_err(|error| error.to_string())
    }

    #[test]
    fn heads_as_numpy_writes_them_are_read_in_every_version() {
        for version in 1..=3 {
            let head = read(version, "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2), }     \n").unwrap();
            let plain = Plain { text: "<f4".into(), letter: 'f', bytes: 4, big: false };
            assert_eq!(head, Head { plain: Some(plain), by_columns: false, shape: vec![3, 2] });
        }
        let head = read(1, "{\"shape\": (7L,), 'fortran_order' :True,'descr':'>i8'}").unwrap();
        let plain = head.plain.unwrap();
        assert_eq!((plain.letter, plain.bytes, plain.big, head.by_columns, head.shape), ('i', 8, true, true, vec![7]));
        assert!(read(1, "{'descr': '|u1', 'fortran_order': False, 'shape': ()}").unwrap().shape.is_empty());
        let records = "{'descr': [('a]', '<f4', (2,)), ('b', [('c', '<i4')])], 'fortran_order': False, 'shape': (1,)}";
        assert_eq!(read(1, records).unwrap().plain, None);
    }

    #[test]
    fn others_are_errors() {
        for text in [
            "",
            "{",
            "{}",
            "{'descr': '<f4', 'fortran_order': False}",
            "{'descr': '<f4', 'fortran_order': 0, 'shape': (1,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (-1,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1 2)}",
            "{'descr': '<f4' 'fortran_order': False, 'shape': (1,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1,), 'more': 1}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1,)} x",
            "{'descr': [('a', '<f4', 'fortran_order': False, 'shape': (1,)}",
        ] {
            assert!(read(1, text).unwrap_err().starts_with("its head is not read: "), "{text}");
        }
        let usual = "{'descr': '<f4', 'fortran_order': False, 'shape': (1,)}";
        assert!(read(4, usual).unwrap_err().contains("in version 1 to 3"));
        assert!(Head::read(&mut &b"PK\x03\x04......."[..]).is_err());
    }

    #[test]
    fn unknown_types_have_no_letter_that_is_read() {
        for text in ["", "<", "f4", "=f4", "<é4", "<f", "<f-4"] {
            let plain = Plain::new(text.to_owned());
            assert!(plain.letter == '?' || plain.bytes == 0 || plain.letter == 'é', "{plain:?}");
        }
    }
}
