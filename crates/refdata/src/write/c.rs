//! A header for C99 and C++17: one structure for a case, one for a sample, and two arrays of them. Numbers
//! are hexadecimal, so that a compiler has nothing to round.

use std::io::{self, Seek, SeekFrom, Write};

use super::text::{Text, Word};
use super::{Sink, Spill, Store};
use crate::array::{Array, Per, Role, WordType};
use crate::bytes::Bytes;
use crate::document::Document;
use crate::generate::Block;
use base::value::F32Bits;

pub(super) struct Header<'s> {
    text: Text<'s>,
    /// Cases come block by block like samples, and stand behind them in the file.
    cases: Box<dyn Spill + 's>,
    arrays: Vec<Array>,
    name: String,
    counts: [u64; 2],
}

/// A name that C takes.
fn identifier(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let reserved = ["return", "default", "register", "signed", "auto", "new", "class", "operator", "index"];
    match plain.as_bytes().first() {
        None | Some(b'0'..=b'9') => format!("n{plain}"),
        Some(_) if reserved.contains(&plain.as_str()) => format!("{plain}_"),
        Some(_) => plain,
    }
}

fn member(array: &Array) -> String {
    let role = match array.role {
        Role::Input => return identifier(&array.variable),
        Role::Expected => "expected",
        Role::Nearest => "nearest",
        Role::Bound => "bound",
        Role::Flags => return "flags".to_owned(),
    };
    identifier(&format!("{role}_{}", array.variable))
}

fn type_name(kind: WordType) -> &'static str {
    match kind {
        WordType::F4 => "float",
        WordType::F8 => "double",
        WordType::I4 => "int32_t",
        WordType::U4 => "uint32_t",
        WordType::U2 => "uint16_t",
    }
}

fn structure(text: &mut String, name: &str, arrays: &[&Array], extra: &str) {
    text.push_str(&format!("struct {name} {{\n{extra}"));
    for array in arrays {
        let dimensions: String = array.shape.iter().map(|n| format!("[{n}]")).collect();
        text.push_str(&format!("  {} {}{dimensions};\n", type_name(array.dtype), member(array)));
    }
    text.push_str("};\n\n");
}

fn literal(word: Word) -> String {
    match word {
        Word::F4(x) if x.is_nan() => "NAN".into(),
        Word::F8(x) if x.is_nan() => "NAN".into(),
        Word::F4(x) if x.is_infinite() => if x > 0.0 { "INFINITY" } else { "-INFINITY" }.into(),
        Word::F8(x) if x.is_infinite() => if x > 0.0 { "INFINITY" } else { "-INFINITY" }.into(),
        Word::F4(x) => format!("{}f", F32Bits::from_f32(x).to_hex_float()),
        Word::F8(x) => hex_float(x),
        // The least integer has no literal of its own.
        Word::I4(i32::MIN) => "(-2147483647 - 1)".into(),
        Word::I4(x) => x.to_string(),
        Word::U4(x) => format!("{x}u"),
        Word::U2(x) => format!("{x}u"),
    }
}

/// A finite number as C99 spells it with `%a`, digits of the significand without zeros at the end.
fn hex_float(x: f64) -> String {
    let (bits, sign) = (x.to_bits() & (u64::MAX >> 1), if x.is_sign_negative() { "-" } else { "" });
    let (fraction, exponent) = (bits & ((1 << 52) - 1), (bits >> 52) as i64);
    let (lead, exponent) = match (fraction, exponent) {
        (0, 0) => return format!("{sign}0x0p+0"),
        (_, 0) => (0, -1022),
        (_, e) => (1, e - 1023),
    };
    let digits = format!("{fraction:013x}");
    let digits = digits.trim_end_matches('0');
    let point = if digits.is_empty() { "" } else { "." };
    format!("{sign}0x{lead}{point}{digits}p{exponent:+}")
}

/// The words of a row in braces, one pair for each dimension.
fn braced(words: &[String], shape: &[usize]) -> String {
    match shape {
        [] => words.concat(),
        [_] => format!("{{{}}}", words.join(", ")),
        [_, rest @ ..] => {
            let each: usize = rest.iter().product::<usize>().max(1);
            let parts: Vec<String> = words.chunks(each).map(|part| braced(part, rest)).collect();
            format!("{{{}}}", parts.join(", "))
        }
    }
}

fn row(arrays: &[(&Array, &Bytes)], at: usize, extra: Option<u64>) -> String {
    let mut members: Vec<String> = extra.iter().map(u64::to_string).collect();
    for (array, bytes) in arrays {
        let words: Vec<String> = Word::row(array, bytes, at).map(literal).collect();
        members.push(braced(&words, &array.shape));
    }
    format!("  {{{}}}", members.join(", "))
}

impl<'s> Header<'s> {
    pub fn new(document: &Document, store: Box<dyn Store + 's>, cases: Box<dyn Spill + 's>) -> io::Result<Self> {
        let name = identifier(&format!("refdata_{}", document.suite.name));
        let guard = name.to_uppercase();
        let mut text = Text::new(store, "/* ", document, " */\n")?;
        let arrays = document.arrays.clone();
        let mut head = format!(
            "#ifndef {guard}_H\n#define {guard}_H\n\n#include <math.h>\n#include <stdint.h>\n\n\
             #define {guard}_SAMPLES {}\n#define {guard}_PER_CASE {}\n",
            document.rows, document.per_case
        );
        for flag in &document.flags {
            head.push_str(&format!("#define {guard}_FLAG_{} {}u\n", flag.name.to_uppercase(), flag.bit));
        }
        head.push('\n');
        let of = |per: Per| -> Vec<&Array> { arrays.iter().filter(|array| array.per == per).collect() };
        if !of(Per::Case).is_empty() {
            structure(&mut head, &format!("{name}_case"), &of(Per::Case), "");
        }
        structure(&mut head, &format!("{name}_sample"), &of(Per::Sample), "  uint64_t case_number;\n");
        head.push_str(&format!("static const struct {name}_sample {name}_samples[] = {{\n"));
        text.write(&head)?;
        Ok(Self { text, cases, arrays, name, counts: [0; 2] })
    }
}

impl Sink for Header<'_> {
    fn block(&mut self, block: &Block) -> io::Result<()> {
        let of = |per: Per| -> Vec<(&Array, &Bytes)> {
            self.arrays.iter().zip(&block.arrays).filter(|(array, _)| array.per == per).collect()
        };
        let (samples, cases) = (of(Per::Sample), of(Per::Case));
        for at in 0..block.rows {
            let comma = if self.counts[0] == 0 { "" } else { ",\n" };
            // Cases are counted within this file.
            let case = self.counts[1] + (at / block.per_case) as u64;
            self.text.write(&format!("{comma}{}", row(&samples, at, Some(case))))?;
            self.counts[0] += 1;
        }
        if !cases.is_empty() {
            for at in 0..block.cases {
                let comma = if self.counts[1] + at as u64 == 0 { "" } else { ",\n" };
                self.cases.write_all(format!("{comma}{}", row(&cases, at, None)).as_bytes())?;
            }
        }
        self.counts[1] += block.cases as u64;
        Ok(())
    }

    fn finish(&mut self, document: &Document) -> io::Result<()> {
        self.text.write("\n};\n")?;
        if self.arrays.iter().any(|array| array.per == Per::Case) {
            self.text.write(&format!("\nstatic const struct {0}_case {0}_cases[] = {{\n", self.name))?;
            self.cases.flush()?;
            self.cases.seek(SeekFrom::Start(0))?;
            io::copy(&mut self.cases, &mut self.text.raw())?;
            self.text.write("\n};\n")?;
        }
        self.text.write("\n#endif\n")?;
        self.text.finish(document)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexadecimal_numbers_are_those_of_c() {
        for (x, text) in [(0.0, "0x0p+0"), (-0.0, "-0x0p+0"), (1.5, "0x1.8p+0"), (-0.1, "-0x1.999999999999ap-4")] {
            assert_eq!(hex_float(x), text);
        }
        assert_eq!(hex_float(5e-324), "0x0.0000000000001p-1022");
        assert_eq!(hex_float(f64::MAX), "0x1.fffffffffffffp+1023");
    }

    #[test]
    fn names_are_those_that_c_takes() {
        assert_eq!(
            [identifier("gl_in[0].x"), identifier("return"), identifier("2d")],
            ["gl_in_0__x", "return_", "n2d"]
        );
    }

    #[test]
    fn rows_have_braces_for_each_dimension() {
        let words: Vec<String> = (0..4).map(|n| n.to_string()).collect();
        assert_eq!(braced(&words, &[2, 2]), "{{0, 1}, {2, 3}}");
        assert_eq!((braced(&words[..1], &[]), braced(&words, &[4])), ("0".into(), "{0, 1, 2, 3}".into()));
    }
}
