//! Files that are small and stand for much: what a reader takes in memory is what the reference states.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Command;

use flate2::Compression;
use flate2::write::DeflateEncoder;

use super::{folder, generate};
use crate::binary::{Ran, run_in};

/// Runs the program with so many MiB of address space.
fn within(at: &Path, mebibytes: u64, args: &str) -> Ran {
    let script = format!("ulimit -v {}; exec \"$0\" {args}", mebibytes << 10);
    let output = Command::new("sh").args(["-c", &script, env!("CARGO_BIN_EXE_shadercheck")]).current_dir(at).output();
    Ran::from(output.unwrap())
}

/// An archive with one array of zeros, compressed: each of `rows` has `width` binary32 numbers.
fn zeros(name: &str, rows: u64, width: u64) -> Vec<u8> {
    let mut head = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({rows}, {width}), }}");
    head.push_str(&" ".repeat(117 - head.len()));
    head.push('\n');
    let mut begin = b"\x93NUMPY\x01\x00".to_vec();
    begin.extend((head.len() as u16).to_le_bytes());
    begin.extend(head.bytes());
    let size = begin.len() as u64 + 4 * rows * width;
    let (mut packed, mut sum) = (DeflateEncoder::new(Vec::new(), Compression::fast()), crc32fast::Hasher::new());
    let mut write = |bytes: &[u8]| {
        sum.update(bytes);
        packed.write_all(bytes).unwrap();
    };
    write(&begin);
    let block = vec![0; 1 << 20];
    let mut left = 4 * rows * width;
    while left > 0 {
        let some = left.min(1 << 20);
        write(&block[..some as usize]);
        left -= some;
    }
    archive(&format!("{name}.npy"), &packed.finish().unwrap(), size as u32, sum.finalize())
}

/// An archive with one member that is compressed already.
fn archive(name: &str, packed: &[u8], size: u32, sum: u32) -> Vec<u8> {
    let mut about = Vec::new();
    about.extend([20, 0, 0, 0, 8, 0, 0, 0, 0, 0]);
    about.extend(sum.to_le_bytes());
    about.extend((packed.len() as u32).to_le_bytes());
    about.extend(size.to_le_bytes());
    about.extend((name.len() as u16).to_le_bytes());
    about.extend([0, 0]);
    let mut bytes = [b"PK\x03\x04", &about[..], name.as_bytes(), packed].concat();
    let begin = bytes.len() as u32;
    bytes.extend([b"PK\x01\x02\x14\x00", &about[..]].concat());
    bytes.extend([0; 14]);
    bytes.extend(name.bytes());
    let length = bytes.len() as u32 - begin;
    bytes.extend(b"PK\x05\x06\x00\x00\x00\x00\x01\x00\x01\x00");
    bytes.extend(length.to_le_bytes());
    bytes.extend(begin.to_le_bytes());
    bytes.extend([0, 0]);
    bytes
}

#[test]
fn an_archive_of_zeros_takes_no_memory() {
    let folder = folder();
    let at = folder.path();
    generate(at, "sphere --samples 300 -o ref.npz").expect(0);
    // 1.2 GB of numbers: rows that the reference does not have, rows that are too wide, and an array nobody asks for.
    let verify = |args: &str| within(at, 700, &format!("refdata verify ref.npz {args}"));
    fs::write(at.join("long.npz"), zeros("gl_Position", 75_000_000, 4)).unwrap();
    let ran = verify("long.npz").expect(1);
    assert!(ran.out.contains("74999700 rows without a sample in the reference"), "{}", ran.out);
    fs::write(at.join("wide.npz"), zeros("gl_Position", 300, 1_000_000)).unwrap();
    let ran = verify("wide.npz").expect(2);
    assert!(
        ran.err.contains("`gl_Position` has 1000000 numbers for each sample, and the reference has 4"),
        "{}",
        ran.err
    );
    fs::write(at.join("other.npz"), zeros("other", 300, 1_000_000)).unwrap();
    verify("other.npz").expect(2);
    let ran = within(at, 700, "refdata verify wide.npz long.npz").expect(2);
    assert!(ran.err.contains("it has no array `provenance`"), "{}", ran.err);
    // The twin: compressed outputs of the right size are read as they were.
    fs::write(at.join("good.npz"), zeros("gl_Position", 300, 4)).unwrap();
    assert!(verify("good.npz").expect(1).out.contains("1200 elements judged"));
    let mut bytes = fs::read(at.join("good.npz")).unwrap();
    let sum = bytes.windows(4).position(|four| four == b"PK\x03\x04").unwrap() + 14;
    bytes[sum] ^= 1;
    let central = bytes.windows(4).rposition(|four| four == b"PK\x01\x02").unwrap() + 16;
    bytes[central] ^= 1;
    fs::write(at.join("damaged.npz"), bytes).unwrap();
    assert!(verify("damaged.npz").expect(2).err.contains("Invalid checksum"));
}

#[test]
fn texts_of_many_numbers_take_little_more_than_their_size() {
    let folder = folder();
    let at = folder.path();
    generate(at, "sphere --samples 300 --format json -o ref.json").expect(0);
    let write = |name: &str, begin: &str, what: &str, end: &str| {
        fs::write(at.join(name), [begin, &what.repeat((12 << 20) / what.len()), end].concat()).unwrap();
    };
    let verify = |args: &str| within(at, 700, &format!("refdata verify ref.json {args}"));
    // Each took many times its 12 MiB: a list of numbers, a list of nothing, and a table of columns alone.
    write("long.json", "{\"other\": [1", ",1", "]}");
    assert!(verify("long.json").expect(2).err.contains("rows, and the reference has 300"));
    write("empty.json", "{\"gl_Position\": [[]", ",[]", "]}");
    verify("empty.json").expect(2);
    write("wide.csv", "a", ",a", "\n");
    let ran = verify("wide.csv").expect(2);
    assert!(ran.err.contains("columns; at most 65536 are read"), "{}", ran.err);
    write("line.csv", "# ", "xx", &"x".repeat(4 << 20));
    assert!(verify("line.csv").expect(2).err.contains("its first line has more than 16777216 bytes"));
    // A block of a reference with more rows than it says.
    let text = fs::read_to_string(at.join("ref.json")).unwrap();
    let bits = text.find("\"bits\"").unwrap();
    let list = bits + text[bits..].find('[').unwrap() + 1;
    let row = "[\"00000000\", \"00000000\"], ";
    fs::write(at.join("rows.json"), [&text[..list], &row.repeat(600_000), &text[list..]].concat()).unwrap();
    let ran = within(at, 700, "refdata verify rows.json ref.json").expect(2);
    assert!(ran.err.contains("of block 0"), "{}", ran.err);
}

#[test]
fn sources_have_a_size_and_includes_an_end() {
    let folder = folder();
    let at = folder.path();
    let begin = "#version 330 core\nout vec4 c;\n";
    let write = |name: &str, text: String| fs::write(at.join(name), text).unwrap();
    write("many.frag", format!("{begin}void main() {{ {} c = vec4(1.0); }}\n", ";".repeat(16 << 20 >> 1)));
    write("large.frag", format!("{begin}//{}\nvoid main() {{ c = vec4(1.0); }}\n", "x".repeat(17 << 20)));
    write("twice.frag", format!("{begin}#include \"i0.glsl\"\nvoid main() {{ c = vec4(1.0); }}\n"));
    (0..40)
        .for_each(|k| write(&format!("i{k}.glsl"), format!("#include \"i{0}.glsl\"\n#include \"i{0}.glsl\"\n", k + 1)));
    write("i40.glsl", "// the end\n".to_owned());
    for (command, tail) in [("translate", "--to wgsl"), ("fuzz", "--lane embedded --samples 64")] {
        let ran = within(at, 4000, &format!("{command} many.frag {tail}"));
        assert!(
            ran.err.contains("more than 1048576 tokens") || ran.out.contains("more than 1048576 tokens"),
            "{ran:?}"
        );
        assert!(matches!(ran.code, 1 | 2), "{command}: {}", ran.code);
        let ran = within(at, 4000, &format!("{command} large.frag {tail}")).expect(2);
        assert!(ran.err.contains("it has more than 16777216 bytes, which no source text needs"), "{}", ran.err);
        let ran = within(at, 4000, &format!("{command} twice.frag {tail}")).expect(2);
        assert!(ran.err.contains("more than 16384 files"), "{}", ran.err);
    }
    fs::write(at.join("few.frag"), format!("{begin}void main() {{ {} c = vec4(1.0); }}\n", ";".repeat(1000))).unwrap();
    run_in(at, "translate few.frag --to wgsl").expect(0);
}

#[test]
fn elements_without_a_bound_are_counted_and_capped() {
    let folder = folder();
    let at = folder.path();
    generate(at, "sphere --samples 20000 --profile vulkan-1.4 -o api.npz").expect(0);
    generate(at, "sphere --samples 20000 -o ref.npz").expect(0);
    // The promise of the API bounds nothing beyond pi: whatever stands there passes, which is a finding.
    let ran = run_in(at, "refdata verify api.npz ref.npz");
    let first = ran.out.lines().next().unwrap_or_default();
    assert!(first.contains("elements without a bound (4"), "{}", ran.out);
    let ran = run_in(at, "refdata verify api.npz api.npz").expect(1);
    assert!(ran.out.contains("elements have no bound, more than 5 %"), "{}", ran.out);
    run_in(at, "refdata verify api.npz api.npz --max-unbounded 50").expect(0);
    let ran = run_in(at, "refdata verify api.npz api.npz --max-unbounded 200").expect(2);
    assert!(ran.err.contains("is no percentage from 0 to 100"), "{}", ran.err);
    // With the default profile every element has one.
    let ran = run_in(at, "refdata verify ref.npz ref.npz --max-unbounded 0").expect(0);
    assert!(ran.out.lines().next().unwrap().contains("bounds of vulkan-practice"), "{}", ran.out);
}

#[test]
fn every_element_of_the_shipped_suites_has_a_bound_by_default() {
    let folder = folder();
    let at = folder.path();
    let suites = "sphere cylinder morph morph_targets joints two_bones segment_distance bone_weight skinning hermite \
                  catmull_rom cardinal kochanek_bartels";
    for suite in suites.split_whitespace() {
        generate(at, &format!("{suite} --samples 5000 -o {suite}.npz")).expect(0);
        run_in(at, &format!("refdata verify {suite}.npz {suite}.npz --max-unbounded 0")).expect(0);
    }
    // A direction of the zero vector has no value, and one next to it no bound that says anything.
    generate(at, "hair --samples 5000 -o hair.npz").expect(0);
    run_in(at, "refdata verify hair.npz hair.npz --max-unbounded 3").expect(0);
}
