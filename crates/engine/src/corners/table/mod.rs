//! The rows. `GWH` are GLSL, WGSL and HLSL; arguments stand before `=` or `~`, and what is right behind it.

mod integers;
mod numbers;
mod vectors;

use super::{Cell, Corner, Row};

/// The parts of the table.
pub static TABLES: [&[Row]; 3] = [numbers::ROWS, integers::ROWS, vectors::ROWS];

const fn row(
    name: &'static str,
    texts: [&'static str; 3],
    form: &'static str,
    sections: [&'static str; 3],
    cells: &'static [Cell],
) -> Row {
    Row { name, texts, form, sections, cells }
}

const fn all(corner: Corner, cases: &'static str) -> Cell {
    Cell { corner, languages: "GWH", cases }
}

const fn only(languages: &'static str, corner: Corner, cases: &'static str) -> Cell {
    Cell { corner, languages, cases }
}

/// One text in all languages.
const fn same(text: &'static str) -> [&'static str; 3] {
    [text, text, text]
}

/// A function of one name everywhere, by its section of GLSL.
const fn numeric(section: &'static str) -> [&'static str; 3] {
    [section, "17.5", "intrinsic functions"]
}

const ARITHMETIC: [&str; 3] = ["5.9", "8.7", "operators"];
const COMPARISON: [&str; 3] = ["5.9", "8.8", "operators"];
const BITS: [&str; 3] = ["5.9", "8.9", "operators"];
const INTEGERS: [&str; 3] = ["8.8", "17.5", "intrinsic functions"];
const PACKING: [&str; 3] = ["8.4", "17.9 and 17.10", "intrinsic functions"];
const CONVERSION: [&str; 3] = ["5.4.1", "17.1 and 15.7.6", "Direct3D 11.3, 3.2.2"];
// Shifts of HLSL: by the lower five bits of the amount, as DXIL's `shl`, `lshr` and `ashr` have it.
const GEOMETRY: [&str; 3] = ["8.5", "17.5", "intrinsic functions"];
