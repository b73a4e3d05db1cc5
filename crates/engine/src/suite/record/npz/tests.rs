use std::io::Write;
use std::sync::Arc;

use base::text::SourceFile;
use base::value::Record;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::*;
use crate::suite::{Expect, parse};

const SUITE: &str = "suite = \"s\"\nshader = \"s.comp\"\nstage = \"compute\"\nrecorded = \"s_{N}.npz\"\n\
    [dispatch]\ngroups = 1\nsizes = { N = [3] }\n\
    [[inputs]]\nnames = [\"count\"]\ngenerator = \"constant\"\nvalues = [\"N\"]\n";

/// An array as NumPy writes it.
fn npy(dtype: &str, fortran: &str, shape: &str, bytes: &[u8]) -> Vec<u8> {
    let head = format!("{{'descr': '{dtype}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut all = b"\x93NUMPY\x01\x00".to_vec();
    all.extend((head.len() as u16).to_le_bytes());
    all.extend(head.as_bytes());
    all.extend(bytes);
    all
}

fn floats(shape: &str, numbers: &[f32]) -> Vec<u8> {
    npy("<f4", "False", shape, &numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<_>>())
}

fn archive(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in arrays {
        writer.start_file(format!("{name}.npy"), SimpleFileOptions::default()).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// A kernel with `float values[3]`, `uint keys[2]`, `uint count`, and `float sums[3]`, which it writes.
fn read(arrays: &[(&str, Vec<u8>)]) -> Result<(Vec<String>, Vec<RecordedRow>), String> {
    let field = |name: &str, shape: Shape| Field { name: name.into(), shape };
    let uint = Shape::vector(Scalar::U32, 1);
    let sums = || field("sums", Shape::FLOAT.array_of(3));
    let invocation = vec![field("values", Shape::FLOAT.array_of(3)), field("keys", uint.array_of(2)), sums()];
    let invocation = Arc::new(Record::new(invocation));
    let case = Arc::new(Record::new(vec![field("count", uint)]));
    let output = Record::new(vec![sums()]);
    let interface = Interface { invocation: &invocation, case: &case, output: &output };
    let suite = parse(&SourceFile::new("s.suite.toml", SUITE)).unwrap().variants().remove(0);
    let Expect::Recorded(recorded) = &suite.expect else { panic!("a record") };
    assert_eq!(recorded.path_for(&suite.chosen), "s_3.npz");
    let found = rows_of_arrays(recorded, "s_3.npz", &archive(arrays), &interface, &suite);
    found.map_err(|all| all.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n"))
}

fn keys() -> (&'static str, Vec<u8>) {
    ("keys", npy("<u4", "False", "(2,)", &[7, 0, 0, 0, 9, 0, 0, 0]))
}

#[test]
fn arrays_are_rows() {
    let values = ("values", floats("(2, 3)", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let sums: Vec<u8> = [1.0, 3.0, 6.0, 4.0, 9.0, 15.0_f64].iter().flat_map(|n| n.to_le_bytes()).collect();
    let sums = ("expected.sums", npy("<f8", "False", "(2, 3)", &sums));
    let (outputs, rows) = read(&[values, keys(), sums]).unwrap();
    assert_eq!(outputs, ["sums"]);
    assert_eq!(rows[1].outputs, [4.0, 9.0, 15.0]);
    let sample = &rows[1].sample;
    assert_eq!(sample.invocation[..3], [4.0_f32, 5.0, 6.0].map(f32::to_bits));
    // One input stands for all dispatches, and a constant of the suite need not be recorded.
    assert_eq!((&sample.invocation[3..5], &sample.case[..]), (&[7, 9][..], &[3][..]));
    // What the buffer holds before that is written is no expected value.
    assert_eq!(f32::from_bits(sample.invocation[5]), 777.25);
}

#[test]
fn what_is_wrong_is_told_with_what_to_do() {
    let values = || ("values", floats("(3,)", &[1.0, 2.0, 3.0]));
    let sums = || ("expected.sums", floats("(3,)", &[1.0, 3.0, 6.0]));
    read(&[values(), keys(), sums()]).unwrap();
    for (arrays, told) in [
        (vec![values(), keys()], "no output is recorded; add an array `expected.sums`"),
        (vec![values(), sums()], "the array `keys` of an input is missing; add one of uint32 with the shape [2]"),
        (
            vec![("values", floats("(4,)", &[0.0; 4])), keys(), sums()],
            "the array `values` has the shape [4]; `values` has [3] with N = 3",
        ),
        (
            vec![("values", npy(">f4", "False", "(3,)", &[0; 12])), keys(), sums()],
            "has the highest byte of each number first (`>f4`); write values.astype(\"<f4\")",
        ),
        (
            vec![("values", npy("<f4", "True", "(2, 3)", &[0; 24])), keys(), sums()],
            "is stored column by column; write numpy.ascontiguousarray(values)",
        ),
        (
            vec![("values", npy("<f2", "False", "(3,)", &[0; 6])), keys(), sums()],
            "is of type `<f2`; write values.astype(numpy.float32)",
        ),
        (
            vec![values(), ("keys", npy("<i8", "False", "(2,)", &[0; 16])), sums()],
            "is of type `<i8`; write keys.astype(numpy.int32) or keys.astype(numpy.uint32)",
        ),
        (
            vec![values(), ("keys", floats("(2,)", &[0.5; 2])), sums()],
            "is of type float32, and the shader has `uint[2]`; write keys.astype(numpy.uint32)",
        ),
        (
            vec![values(), ("keys", npy("<i4", "False", "(2,)", &[255; 8])), sums()],
            "holds -1, which `uint[2]` does not",
        ),
        (
            vec![("values", npy("<f8", "False", "(3,)", &0.1_f64.to_le_bytes().repeat(3))), keys(), sums()],
            "holds 0.1, which is no float32; compute the reference for values.astype(numpy.float32)",
        ),
        (
            vec![("values", npy("<f4", "False", "(3,)", &[0; 8])), keys(), sums()],
            "has 8 bytes, and its shape says otherwise: the file is cut off or damaged",
        ),
        (
            vec![values(), keys(), ("expected.sum", floats("(3,)", &[0.0; 3]))],
            "no input or output for the array `expected.sum`",
        ),
        (
            vec![values(), ("input.values", floats("(3,)", &[0.0; 3])), keys(), sums()],
            "that another array gives as well",
        ),
    ] {
        let error = read(&arrays).unwrap_err();
        assert!(error.starts_with("s_3.npz: ") && error.contains(told), "{told}\n{error}");
    }
    let recorded = read(&[("values", vec![1, 2])]).unwrap_err();
    assert!(recorded.contains("the array `values` cannot be read"), "{recorded}");
}
