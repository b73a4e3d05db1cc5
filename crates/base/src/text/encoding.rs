//! Bytes to text and back: UTF-8, Shift_JIS, EUC-JP, UTF-16 with a byte-order mark, and windows-1252, which is
//! ISO 8859-1 with more letters.

use std::fmt;

use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{EUC_JP, EncoderResult, SHIFT_JIS, WINDOWS_1252};
use thiserror::Error;

use super::source::{Position, SourceFile, TextError};

/// How a text is written as bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// UTF-8.
    Utf8,
    /// Shift_JIS as the WHATWG has it, which is code page 932 of Windows.
    ShiftJis,
    /// EUC-JP.
    EucJp,
    /// Windows-1252. Any bytes fit, so that it is tried last, and only by [`decode_western`].
    Windows1252,
    /// UTF-16, low byte first.
    Utf16Le,
    /// UTF-16, high byte first.
    Utf16Be,
}

impl Encoding {
    /// The usual name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Utf8 => "UTF-8",
            Self::ShiftJis => "Shift_JIS",
            Self::EucJp => "EUC-JP",
            Self::Windows1252 => "windows-1252",
            Self::Utf16Le => "UTF-16LE",
            Self::Utf16Be => "UTF-16BE",
        }
    }

    /// The library's table, for encodings that have one.
    fn table(self) -> Option<&'static encoding_rs::Encoding> {
        match self {
            Self::ShiftJis => Some(SHIFT_JIS),
            Self::EucJp => Some(EUC_JP),
            Self::Windows1252 => Some(WINDOWS_1252),
            Self::Utf8 | Self::Utf16Le | Self::Utf16Be => None,
        }
    }

    /// Bytes of the byte-order mark; empty for encodings without one.
    fn mark(self) -> &'static [u8] {
        match self {
            Self::Utf8 => b"\xef\xbb\xbf",
            Self::Utf16Le => b"\xff\xfe",
            Self::Utf16Be => b"\xfe\xff",
            Self::ShiftJis | Self::EucJp | Self::Windows1252 => b"",
        }
    }

    fn decode(self, bytes: &[u8]) -> Option<String> {
        match self {
            Self::Utf8 => std::str::from_utf8(bytes).ok().map(str::to_owned),
            Self::ShiftJis | Self::EucJp | Self::Windows1252 => {
                let text = self.table()?.decode_without_bom_handling_and_without_replacement(bytes)?;
                Some(text.into_owned())
            }
            Self::Utf16Le => utf16(bytes, u16::from_le_bytes),
            Self::Utf16Be => utf16(bytes, u16::from_be_bytes),
        }
    }
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Option<String> {
    let pairs = bytes.chunks_exact(2);
    if !pairs.remainder().is_empty() {
        return None;
    }
    let units: Vec<u16> = pairs.map(|pair| unit([pair[0], pair[1]])).collect();
    String::from_utf16(&units).ok()
}

/// A character that an encoding does not have, or writes as another one.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{name}:{position}: `{character}` cannot be written in {encoding}, the encoding of the file")]
pub struct EncodeError {
    /// Name of the file.
    pub name: String,
    /// Place of the character.
    pub position: Position,
    /// What cannot be written as it is.
    pub character: char,
    /// How characters become bytes in the file.
    pub encoding: Encoding,
}

/// What a file was read as, so that it can be written in the same way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Form {
    /// How characters become bytes in the file.
    pub encoding: Encoding,
    /// True when a byte-order mark stood before the text.
    pub mark: bool,
}

impl Form {
    /// The bytes of a file that holds this text.
    ///
    /// # Errors
    /// [`EncodeError`] for the first character that would not be read back as itself.
    pub fn encode(self, file: &SourceFile) -> Result<Vec<u8>, EncodeError> {
        let text = file.text();
        let mut bytes = if self.mark { self.encoding.mark().to_vec() } else { Vec::new() };
        match self.encoding {
            Encoding::Utf8 => bytes.extend_from_slice(text.as_bytes()),
            Encoding::Utf16Le => text.encode_utf16().for_each(|unit| bytes.extend(unit.to_le_bytes())),
            Encoding::Utf16Be => text.encode_utf16().for_each(|unit| bytes.extend(unit.to_be_bytes())),
            Encoding::ShiftJis | Encoding::EucJp | Encoding::Windows1252 => {
                let mut at = 0;
                for character in text.chars() {
                    let Some(written) = self.written(character) else {
                        let position = file.position(at);
                        let name = file.name().to_owned();
                        return Err(EncodeError { name, position, character, encoding: self.encoding });
                    };
                    bytes.extend(written);
                    at += character.len_utf8();
                }
            }
        }
        Ok(bytes)
    }

    /// The bytes of one character in an encoding with a table; none when it has no place there, or
    /// shares one with another character, as the yen sign does with the backslash.
    fn written(self, character: char) -> Option<Vec<u8>> {
        if character.is_ascii() {
            return Some(vec![character as u8]);
        }
        let mut buffer = [0; 4];
        let text = character.encode_utf8(&mut buffer);
        let mut encoder = self.encoding.table()?.new_encoder();
        let mut bytes = vec![0; 8];
        let (result, _, length) = encoder.encode_from_utf8_without_replacement(text, &mut bytes, true);
        bytes.truncate(length);
        let complete = matches!(result, EncoderResult::InputEmpty);
        (complete && self.encoding.decode(&bytes).as_deref() == Some(&*text)).then_some(bytes)
    }
}

/// A text with what it was read as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decoded {
    /// The text, without its byte-order mark.
    pub file: SourceFile,
    /// How it was written.
    pub form: Form,
    /// True when writing the text in this form gives the same bytes again.
    pub exact: bool,
}

/// Reads the bytes of a file called `name`. A byte-order mark decides; what is UTF-8 is read as that;
/// of Shift_JIS and EUC-JP the one that fits, and when both do, the more likely one.
///
/// # Errors
/// [`TextError::NoEncoding`] when none fits.
pub fn decode(name: &str, bytes: &[u8]) -> Result<Decoded, TextError> {
    let marked = [Encoding::Utf8, Encoding::Utf16Le, Encoding::Utf16Be];
    if let Some(encoding) = marked.into_iter().find(|e| bytes.starts_with(e.mark())) {
        let body = &bytes[encoding.mark().len()..];
        let Some(text) = encoding.decode(body) else { return Err(misfit(name, body, encoding)) };
        return Ok(decoded(name, text, Form { encoding, mark: true }, bytes));
    }
    if let Some(text) = Encoding::Utf8.decode(bytes) {
        return Ok(decoded(name, text, Form { encoding: Encoding::Utf8, mark: false }, bytes));
    }
    let read = |encoding: Encoding| encoding.decode(bytes).map(|text| (encoding, text));
    let chosen = match (read(Encoding::ShiftJis), read(Encoding::EucJp)) {
        (Some(a), Some(b)) => Some(likelier(bytes, a, b)),
        (one, other) => one.or(other),
    };
    match chosen {
        Some((encoding, text)) => Ok(decoded(name, text, Form { encoding, mark: false }, bytes)),
        None => Err(misfit(name, bytes, Encoding::Utf8)),
    }
}

/// As [`decode`]; text that fits nowhere is read as windows-1252, and Latin text that happens to fit a Japanese
/// encoding as well. For source code, of which the compilers read the ASCII and pass over comments in any encoding.
///
/// # Errors
/// [`TextError::NoEncoding`] when none fits, and for bytes that are no text.
pub fn decode_western(name: &str, bytes: &[u8]) -> Result<Decoded, TextError> {
    let read = decode(name, bytes);
    let doubtful = match &read {
        Ok(read) => matches!(read.form.encoding, Encoding::ShiftJis | Encoding::EucJp),
        Err(_) => true,
    };
    let control = |b: &u8| *b < 0x20 && !matches!(b, b'\t' | b'\n' | b'\r' | 0x0b | 0x0c);
    if !doubtful || bytes.iter().any(control) || (read.is_ok() && guess(bytes, None) != WINDOWS_1252) {
        return read;
    }
    let encoding = Encoding::Windows1252;
    match encoding.decode(bytes) {
        Some(text) => Ok(decoded(name, text, Form { encoding, mark: false }, bytes)),
        None => read,
    }
}

/// The likeliest encoding by the frequency of characters.
fn guess(bytes: &[u8], domain: Option<&[u8]>) -> &'static encoding_rs::Encoding {
    let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
    detector.feed(bytes, true);
    detector.guess(domain, Utf8Detection::Deny)
}

fn decoded(name: &str, text: String, form: Form, bytes: &[u8]) -> Decoded {
    let file = SourceFile::new(name, text);
    let exact = form.encode(&file).is_ok_and(|again| again == bytes);
    Decoded { file, form, exact }
}

type Read = (Encoding, String);

/// Of Shift_JIS and EUC-JP, both of which fit, the likelier one by the frequency of characters. Of
/// short texts that is no evidence; then EUC-JP, when Shift_JIS would mean katakana of half width.
fn likelier(bytes: &[u8], shift_jis: Read, euc_jp: Read) -> Read {
    let guess = guess(bytes, Some(b"jp"));
    let half_width = |c: char| ('\u{ff61}'..='\u{ff9f}').contains(&c);
    if guess == EUC_JP || (guess != SHIFT_JIS && shift_jis.1.contains(half_width)) { euc_jp } else { shift_jis }
}

/// The error for bytes that cannot be read: the first that are no UTF-8, or no UTF-16.
fn misfit(name: &str, bytes: &[u8], encoding: Encoding) -> TextError {
    let (text, end) = match encoding {
        Encoding::Utf16Le => utf16_start(bytes, u16::from_le_bytes),
        Encoding::Utf16Be => utf16_start(bytes, u16::from_be_bytes),
        Encoding::Utf8 | Encoding::ShiftJis | Encoding::EucJp | Encoding::Windows1252 => {
            let end = std::str::from_utf8(bytes).err().map_or(bytes.len(), |e| e.valid_up_to());
            (std::str::from_utf8(&bytes[..end]).unwrap_or_default().to_owned(), end)
        }
    };
    let before = SourceFile::new(name, text);
    TextError::NoEncoding {
        name: before.name().to_owned(),
        position: before.position(before.text().len()),
        byte: bytes.get(end).copied().unwrap_or_default(),
    }
}

/// The text before the first unit that is no character, and the number of its bytes.
fn utf16_start(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> (String, usize) {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    let text: String = char::decode_utf16(units).map_while(Result::ok).collect();
    let end = 2 * text.encode_utf16().count();
    (text, end)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "#version 150 core\r\n/* 頂点の位置 */ in vec4 position; // 球面の座標を計算します\r\n";

    fn form(encoding: Encoding, mark: bool) -> Form {
        Form { encoding, mark }
    }

    #[test]
    fn every_encoding_is_recognised_and_written_back_byte_by_byte() {
        let forms = [
            form(Encoding::Utf8, false),
            form(Encoding::Utf8, true),
            form(Encoding::ShiftJis, false),
            form(Encoding::EucJp, false),
            form(Encoding::Utf16Le, true),
            form(Encoding::Utf16Be, true),
        ];
        for form in forms {
            let bytes = form.encode(&SourceFile::new("a.vert", TEXT)).unwrap();
            let read = decode("a.vert", &bytes).unwrap();
            assert_eq!((read.file.text(), read.form, read.exact), (TEXT, form, true));
            assert_eq!(form.encode(&read.file).unwrap(), bytes);
        }
    }

    #[test]
    fn short_comments_are_told_apart() {
        for text in ["// 頂点\n", "// 法線ベクトル\n", "// 球\n", "// 光源の方向と強さ\n", "// テクスチャ座標\n"]
        {
            for encoding in [Encoding::ShiftJis, Encoding::EucJp] {
                let bytes = form(encoding, false).encode(&SourceFile::new("a", text)).unwrap();
                let read = decode("a", &bytes).unwrap();
                assert_eq!((read.form.encoding, read.file.text()), (encoding, text), "{bytes:x?}");
            }
        }
    }

    #[test]
    fn the_known_bytes_of_a_character() {
        let ball = SourceFile::new("a", "球");
        assert_eq!(form(Encoding::ShiftJis, false).encode(&ball).unwrap(), b"\x8b\x85");
        assert_eq!(form(Encoding::EucJp, false).encode(&ball).unwrap(), b"\xb5\xe5");
        assert_eq!(form(Encoding::Utf16Be, true).encode(&ball).unwrap(), b"\xfe\xff\x74\x03");
    }

    #[test]
    fn bytes_that_fit_nowhere_have_their_place() {
        // 0x80 is no character of Shift_JIS, and no first byte of UTF-8 or EUC-JP.
        let error = decode("s.vert", b"in vec4 p;\n// a\xe9 \xff\n").unwrap_err();
        let TextError::NoEncoding { position, byte, .. } = &error else { panic!("{error}") };
        assert_eq!((*position, *byte), (Position { line: 2, column: 5 }, 0xe9));
        assert!(error.to_string().contains("iconv"), "{error}");
    }

    #[test]
    fn broken_utf16_is_refused_at_its_place() {
        let cut = decode("a", b"\xff\xfea\0b\0\n\0c").unwrap_err();
        let TextError::NoEncoding { position, byte, .. } = cut else { panic!("{cut}") };
        assert_eq!((position, byte), (Position { line: 2, column: 1 }, b'c'));
        let lone = decode("a", b"\xfe\xff\0a\xd8\x00\0b").unwrap_err();
        let TextError::NoEncoding { position, byte, .. } = lone else { panic!("{lone}") };
        assert_eq!((position, byte), (Position { line: 1, column: 2 }, 0xd8));
    }

    #[test]
    fn bytes_that_would_change_are_not_exact() {
        // 0xfa54 and 0x81ca are two ways of Shift_JIS to write ￢.
        let read = decode("a", b"// \x8b\x85 \xfa\x54\n").unwrap();
        assert_eq!((read.form.encoding, read.exact), (Encoding::ShiftJis, false));
        assert!(decode("a", b"// \x8b\x85 \x81\xca\n").unwrap().exact);
    }

    #[test]
    fn western_text_is_read_where_it_is_looked_for() {
        let text = b"// f\xfcr gro\xdfe Fl\xe4chen, sch\xf6n\nint a; // \xe9t\xe9\n";
        let read = decode_western("a.cpp", text).unwrap();
        assert_eq!((read.form.encoding, read.exact), (Encoding::Windows1252, true));
        assert!(read.file.text().contains("für große Flächen"));
        assert!(decode_western("a.cpp", b"a\xff\0b").is_err());
        for encoding in [Encoding::ShiftJis, Encoding::EucJp] {
            let bytes = form(encoding, false).encode(&SourceFile::new("a", TEXT)).unwrap();
            assert_eq!(decode_western("a.cpp", &bytes).unwrap().form.encoding, encoding);
        }
    }

    #[test]
    fn a_character_without_a_place_is_refused() {
        let file = SourceFile::new("a.vert", "// 球\n// π ½");
        let error = form(Encoding::ShiftJis, false).encode(&file).unwrap_err();
        assert_eq!((error.position, error.character), (Position { line: 2, column: 6 }, '½'));
        assert!(error.to_string().starts_with("a.vert:2:6: `½` cannot be written in Shift_JIS"), "{error}");
        // It would be read back as a backslash.
        let yen = SourceFile::new("a.vert", "¥");
        assert!(form(Encoding::ShiftJis, false).encode(&yen).is_err());
        assert!(form(Encoding::Utf8, false).encode(&yen).is_ok());
    }
}
