//! Blocks, files and what they hold.

use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex};

use super::read::{Blocks, Chain, Dataset, InputFormat, ReadError, Sequence, Shared};
use super::write::{Format, Spill, Store};
use super::*;
use ::number::twofold::Real;
use base::text::SourceFile;
use chapter::exact::{Exact, Marks, Words};
use engine::suite::run::{Prepared, prepare};
use engine::suite::{self, shipped};
use judge::profile;

#[path = "../../number/src/twofold/big.rs"]
mod big;
use big::Big;

pub(super) fn prepared(name: &str) -> Prepared {
    let found = suite::find(name).unwrap();
    let suite = suite::parse(&SourceFile::new(found.path, found.toml)).unwrap();
    prepare(&suite, &SourceFile::new(found.shader_name, found.shader_text)).unwrap()
}

/// A file in memory that others can look at.
#[derive(Clone, Default)]
pub(super) struct Memory {
    bytes: Arc<Mutex<Cursor<Vec<u8>>>>,
    /// Bytes after which the disk is full.
    room: Option<usize>,
}

impl Memory {
    fn take(self) -> Vec<u8> {
        self.bytes.lock().unwrap().get_ref().clone()
    }
}

impl Write for Memory {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        let mut bytes = self.bytes.lock().unwrap();
        if self.room.is_some_and(|room| bytes.get_ref().len() + buf.len() > room) {
            return Err(io::Error::from(io::ErrorKind::StorageFull));
        }
        bytes.write(buf)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Memory {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.bytes.lock().unwrap().seek(to)
    }
}

impl Read for Memory {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        self.bytes.lock().unwrap().read(buf)
    }
}

fn spill() -> io::Result<Box<dyn Spill>> {
    Ok(Box::new(Memory::default()))
}

fn written(generator: &Generator<'_>, format: Format, memory: &Memory) -> io::Result<String> {
    let blocks = 0..generator.blocks();
    let store: Box<dyn Store> = Box::new(memory.clone());
    let mut sink = format.sink(&generator.document(&blocks), store, &spill)?;
    produce(generator, blocks, &mut *sink, &Forget, &mut |_| {})
}

pub(super) fn file(suite: &str, profile: Option<&str>, format: Format, samples: u64) -> Vec<u8> {
    let prepared = prepared(suite);
    let profile = profile.map(|name| profile::by_name(name).unwrap());
    let generator = Generator::new(&prepared, profile, samples, 7).unwrap();
    let memory = Memory::default();
    written(&generator, format, &memory).unwrap();
    memory.take()
}

pub(super) fn source(format: Format) -> Option<InputFormat> {
    match format {
        Format::Json => Some(InputFormat::Json),
        Format::Npz => Some(InputFormat::Npz),
        Format::Parquet => Some(InputFormat::Parquet),
        Format::Csv => Some(InputFormat::Csv),
        Format::C => None,
    }
}

pub(super) fn dataset(bytes: &[u8], format: Format) -> Result<Dataset, ReadError> {
    Dataset::read(source(format).unwrap(), &Shared::new(Box::new(Cursor::new(bytes.to_vec()))).unwrap())
}

/// Inputs of one sample, as the arrays of a block have them.
struct Inputs(Vec<f64>);

impl Words<Big> for Inputs {
    fn word(&self, index: usize) -> Big {
        Big::of(self.0[index])
    }
}

fn inputs_of(dataset: &Dataset, formula: &str, sample: usize) -> Inputs {
    let mut words = Vec::new();
    for param in chapter::formula::by_name(formula).unwrap().inputs {
        let arrays = dataset.document.arrays.iter().zip(&dataset.arrays);
        let (array, bytes) = arrays
            .filter(|(array, _)| array.role == Role::Input)
            .find(|(array, _)| array.variable == param.name)
            .unwrap();
        let row = if array.per == Per::Case { sample / dataset.document.per_case as usize } else { sample };
        for b in bytes[row * array.stride()..][..array.stride()].chunks_exact(4) {
            let bits = u32::from_le_bytes(b.try_into().unwrap());
            words.push(match array.dtype {
                WordType::F4 => f64::from(f32::from_bits(bits)),
                _ => f64::from(bits.cast_signed()),
            });
        }
    }
    Inputs(words)
}

/// The expected values of a sample in the order of the formula.
fn expected_of(dataset: &Dataset, sample: usize) -> Vec<f64> {
    let mut arrays = Vec::new();
    let mut vertices = 1;
    for (array, bytes) in dataset.document.arrays.iter().zip(&dataset.arrays) {
        if array.role == Role::Expected {
            let words: Vec<f64> = bytes[sample * array.stride()..][..array.stride()]
                .chunks_exact(8)
                .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
                .collect();
            if dataset.document.suite.stage == "geometry" {
                vertices = array.shape[0];
            }
            arrays.push(words);
        }
    }
    let of_vertex = |v: usize| {
        arrays.iter().flat_map(move |words| {
            let each = words.len() / vertices;
            words[v * each..(v + 1) * each].to_vec()
        })
    };
    (0..vertices).flat_map(of_vertex).collect()
}

/// How far a value is from the exact one, in ULP of binary64 there. What is 2^-90 of the largest term and
/// less is what rounding leaves of zero, also of 400 bits.
fn ulp(value: f64, exact: Big, scale: f64) -> f64 {
    let size = exact.size();
    if size.is_nan() || value.is_nan() {
        return if size.is_nan() && value.is_nan() { 0.0 } else { f64::INFINITY };
    }
    let error = (Big::of(value) - exact).size();
    if error <= scale * 2f64.powi(-90) {
        return 0.0;
    }
    error / (size.next_up() - size).max(5e-324)
}

fn worst(suite: &str, samples: usize, fault: &dyn Fn(f64) -> f64) -> f64 {
    let data = dataset(&file(suite, None, Format::Npz, samples as u64), Format::Npz).unwrap();
    let formula = Exact::by_name(suite).unwrap();
    let mut most = 0.0_f64;
    for sample in 0..samples {
        Big::forget();
        let inputs = inputs_of(&data, suite, sample);
        let mut out = vec![Big::of(0.0); formula.outputs()];
        let _: Marks<Big> = formula.evaluate(&inputs, &mut out);
        let scale = inputs.0.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
        for (value, exact) in expected_of(&data, sample).into_iter().zip(out) {
            most = most.max(ulp(fault(value), exact, scale));
        }
    }
    most
}

#[test]
fn expected_values_are_within_one_ulp_of_four_hundred_bits() {
    for suite in shipped() {
        let samples = if suite.name == "skinning" { 64 } else { 256 };
        let most = worst(suite.name, samples, &|x| x);
        assert!(most <= 1.0, "{}: {most} ULP", suite.name);
        // Values are rounded, not cut off, and the measure sees it.
        assert!(most > 0.25, "{}: {most} ULP", suite.name);
    }
    assert!(worst("sphere", 64, &|x| x.next_up().next_up()) > 1.0, "two ULP are seen");
    assert!(worst("bone_weight", 64, &|x| x * (1.0 + 4.0 * f64::EPSILON)) > 1.0, "four parts in 2^52 are seen");
}

#[test]
fn blocks_do_not_depend_on_what_was_made_before_or_on_threads() {
    let prepared = prepared("skinning");
    let profile = profile::by_name("binary32");
    let generator = Generator::new(&prepared, profile, 70_000, 7).unwrap();
    assert_eq!(generator.blocks(), 2);
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    // The second block alone, and behind the first.
    let second = pool(1).install(|| generator.block(1));
    let both = pool(4).install(|| [generator.block(0), generator.block(1)]);
    assert_eq!(second.arrays, both[1].arrays);
    assert_ne!(both[0].digest, both[1].digest);
    assert_eq!(both[1].rows as u64, 70_000 - generator.block_rows());
    let other = Generator::new(&prepared, profile, 70_000, 8).unwrap();
    assert_ne!(other.block(1).arrays, second.arrays, "another seed gives other samples");
}

#[test]
fn files_are_the_same_whatever_the_number_of_threads() {
    for format in Format::ALL {
        let of = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| file("sphere", Some("binary32"), format, 300))
        };
        assert_eq!(of(1), of(4), "{}", format.name());
    }
}

#[test]
fn the_bytes_are_those_of_every_machine() {
    // A change here is a change of the data: SCHEMA_VERSION and CHANGELOG.md tell of it.
    let golden = [
        ("sphere", "vulkan-1.4", "b6707656beebd525d1a9533e7b721ebd29ef8a13146bbe0894a08134e675eb53"),
        ("skinning", "binary32", "18d7029a684f38e8e7b6ccfecb0bc5e4c25b908003417c7299170b7e83ac4765"),
        ("bone_weight", "vulkan-1.4", "4a9b5bea3d8bc6d3161692b858b7094eaaabc81e34190dea3b7df11f2bc0a312"),
        ("hair", "vulkan-1.4", "9ce03a41cab0759c12567a85295af56dcff2276445e7201fd5ba845274d55eb9"),
    ];
    let found = golden.map(|(suite, profile, _)| {
        let data = dataset(&file(suite, Some(profile), Format::Npz, 1000), Format::Npz).unwrap();
        (suite, profile, data.document.sha256)
    });
    assert_eq!(found, golden.map(|(suite, profile, digest)| (suite, profile, digest.to_owned())));
}

#[test]
fn every_format_reads_back_to_the_same_bytes() {
    for suite in ["sphere", "joints", "skinning", "hair"] {
        let first = dataset(&file(suite, Some("vulkan-1.4"), Format::Npz, 200), Format::Npz).unwrap();
        assert_eq!(first.document.rows, 200);
        for format in [Format::Json, Format::Parquet, Format::Csv] {
            let other = dataset(&file(suite, Some("vulkan-1.4"), format, 200), format).unwrap();
            assert_eq!(other.document, first.document, "{suite} as {}", format.name());
            assert_eq!(other.arrays, first.arrays, "{suite} as {}", format.name());
        }
    }
}

#[test]
fn provenance_tells_where_the_numbers_come_from() {
    let data = dataset(&file("skinning", Some("vulkan-1.4"), Format::Npz, 33), Format::Npz).unwrap();
    let Document { expected, profile, seed, per_case, domain, .. } = &data.document;
    assert_eq!((expected.by.as_str(), expected.formula.as_deref()), ("formula", Some("skinning")));
    assert_eq!(expected.equations, [76, 79, 80, 81]);
    assert_eq!((seed.as_str(), *per_case), ("7", 16));
    assert!(profile.as_ref().is_some_and(|p| p.name == "vulkan-1.4" && !p.revision.is_empty()));
    assert_eq!(domain[0].inputs, ["numberOfBones", "p0", "p1", "blendMatrix"]);
    let cases = data.array("case.blendMatrix").unwrap();
    // Three cases for 33 samples, of eight matrices each.
    assert_eq!((cases.0.shape.as_slice(), cases.1.len()), ([8, 4, 4].as_slice(), 3 * 8 * 16 * 4));
}

#[test]
fn flags_say_what_is_special() {
    let data = dataset(&file("segment_distance", Some("vulkan-1.4"), Format::Npz, 4000), Format::Npz).unwrap();
    let flags = |data: &Dataset| -> Vec<Flags> {
        let bytes = data.array("flags").unwrap().1;
        bytes.chunks_exact(2).map(|b| Flags(u16::from_le_bytes([b[0], b[1]]))).collect()
    };
    let count = |data: &Dataset, flag| flags(data).iter().filter(|flags| flags.has(flag)).count();
    let ends = count(&data, Flag::SegmentEnd);
    assert!((1000..3500).contains(&ends) && count(&data, Flag::Degenerate) > 10, "{ends}");
    let sphere = dataset(&file("sphere", Some("vulkan-1.4"), Format::Npz, 4000), Format::Npz).unwrap();
    // Vulkan promises nothing for sin beyond π, and θ goes up to 2π.
    let unpromised = count(&sphere, Flag::NoPromise);
    assert!((1500..2500).contains(&unpromised), "{unpromised}");
    let bounds = sphere.array("bound.gl_Position").unwrap().1;
    let infinite = bounds.chunks_exact(4).filter(|b| **b == f32::INFINITY.to_le_bytes()).count();
    assert!(infinite > unpromised, "without a promise there is no bound");
    let strict = dataset(&file("sphere", Some("binary32"), Format::Npz, 4000), Format::Npz).unwrap();
    assert_eq!(count(&strict, Flag::NoPromise), 0);
}

#[test]
fn a_full_disk_is_an_error_whenever_it_comes() {
    let prepared = prepared("sphere");
    let generator = Generator::new(&prepared, profile::by_name("binary32"), 100, 7).unwrap();
    for format in Format::ALL {
        let memory = Memory::default();
        written(&generator, format, &memory).unwrap();
        let whole = memory.take().len();
        for room in [0, whole / 2, whole - 1] {
            let full = Memory { room: Some(room), ..Memory::default() };
            let error = written(&generator, format, &full).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::StorageFull, "{} with room for {room}", format.name());
        }
    }
}

#[test]
fn what_was_changed_or_cut_off_is_not_read() {
    for format in [Format::Json, Format::Npz, Format::Parquet, Format::Csv] {
        let bytes = file("sphere", Some("binary32"), format, 100);
        for length in [0, 10, bytes.len() / 2, bytes.len() - 30] {
            let error = dataset(&bytes[..length], format).unwrap_err();
            let reported = !matches!(error, ReadError::Io(_));
            assert!(reported, "{} cut to {length}: {error}", format.name());
        }
    }
    // One digit of one number.
    let text = String::from_utf8(file("sphere", Some("binary32"), Format::Csv, 100)).unwrap();
    let last = text.rfind('.').unwrap() + 1;
    let digit = if &text[last..=last] == "7" { "8" } else { "7" };
    let changed = format!("{}{digit}{}", &text[..last], &text[last + 1..]);
    let error = dataset(changed.as_bytes(), Format::Csv).unwrap_err();
    assert!(matches!(error, ReadError::Digest { .. }), "{error}");
    // The digest of another file.
    let json = String::from_utf8(file("sphere", Some("binary32"), Format::Json, 10)).unwrap();
    let digest = &json[json.find("\"sha256\":\"").unwrap() + 10..][..64];
    let error = dataset(json.replace(digest, &digest.chars().rev().collect::<String>()).as_bytes(), Format::Json);
    assert!(matches!(error.unwrap_err(), ReadError::Digest { .. }));
}

#[test]
fn another_version_of_the_schema_is_refused_by_name() {
    let json = String::from_utf8(file("sphere", Some("binary32"), Format::Json, 10)).unwrap();
    let later = json.replace("\"schema_version\":\"1.1\"", "\"schema_version\":\"2.0\"");
    let error = dataset(later.as_bytes(), Format::Json).unwrap_err().to_string();
    assert!(error.starts_with("its schema has version 2.0, and this program reads 1.1"), "{error}");
    let error = dataset(b"{\"provenance\": {}}", Format::Json).unwrap_err().to_string();
    assert!(error.starts_with("its provenance is no document of schema"), "{error}");
}

#[test]
fn parts_together_are_the_whole_and_faults_of_theirs_are_reported() {
    let prepared = prepared("bone_weight");
    let generator = Generator::new(&prepared, profile::by_name("binary32"), 200_000, 7).unwrap();
    assert_eq!(generator.blocks(), 4);
    let part = |blocks: std::ops::Range<u64>| {
        let memory = Memory::default();
        let mut sink = Format::Npz.sink(&generator.document(&blocks), Box::new(memory.clone()), &spill).unwrap();
        produce(&generator, blocks, &mut *sink, &Forget, &mut |_| {}).unwrap();
        drop(sink);
        memory.take()
    };
    let open = |bytes: &[u8]| Shared::new(Box::new(Cursor::new(bytes.to_vec()))).unwrap();
    let blocks = |bytes: &[u8]| Blocks::open(InputFormat::Npz, &open(bytes));
    let joined = |parts: &[&[u8]]| -> Result<Vec<u8>, ReadError> {
        let name = |(k, bytes): (usize, &&[u8])| (format!("p{k}"), blocks(bytes).unwrap().document().clone());
        let documents: Vec<_> = parts.iter().enumerate().map(name).collect();
        let mut chain = Chain::new(&documents, Box::new(|part| blocks(parts[part])))?;
        let memory = Memory::default();
        let begin = chain.document().without_digest();
        let mut sink = Format::Npz.sink(&begin, Box::new(memory.clone()), &spill).unwrap();
        match copy(&mut chain, Some(&mut *sink), &mut |_| {}) {
            Ok(_) => {}
            Err(CopyError::Read(error)) => return Err(error),
            Err(CopyError::Write(error)) => panic!("{error}"),
        }
        drop(sink);
        Ok(memory.take())
    };
    let whole = part(0..4);
    let (first, second, none, last) = (part(0..1), part(1..3), part(3..3), part(3..4));
    assert!(joined(&[&last, &first, &none, &second]).unwrap() == whole, "joined in another order");
    assert!(joined(&[&part(2..4), &part(0..2)]).unwrap() == whole, "of other parts");
    let reported = |parts: &[&[u8]]| joined(parts).unwrap_err().to_string();
    assert_eq!(reported(&[]), "it holds no reference file");
    assert!(reported(&[&second, &last]).starts_with("samples 0 to 65535 are missing"));
    assert!(reported(&[&first, &last]).starts_with("samples 65536 to 196607 are missing"));
    assert!(reported(&[&first, &second]).starts_with("samples 196608 to 199999 are missing"));
    let twice = reported(&[&first, &second, &second, &last]);
    assert_eq!(twice, "sample 65536 is there twice: in `p1` and in `p2`");
    let generator = Generator::new(&prepared, profile::by_name("binary32"), 200_000, 8).unwrap();
    let memory = Memory::default();
    let mut sink = Format::Npz.sink(&generator.document(&(1..3)), Box::new(memory.clone()), &spill).unwrap();
    produce(&generator, 1..3, &mut *sink, &Forget, &mut |_| {}).unwrap();
    drop(sink);
    let other = reported(&[&first, &memory.take(), &last]);
    assert_eq!(other, "`p0` and `p1` are of different runs: the seed is `7` in one and `8` in the other");
    // A part whose numbers are not those that were written is found when it is read.
    let mut damaged = second.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    assert!(reported(&[&first, &damaged, &last]).starts_with("SHA-256 is "));
}

#[test]
fn json_is_read_block_by_block_and_as_somebody_else_writes_it() {
    let prepared = prepared("bone_weight");
    let generator = Generator::new(&prepared, None, 66_000, 7).unwrap();
    assert_eq!(generator.blocks(), 2);
    let memory = Memory::default();
    written(&generator, Format::Json, &memory).unwrap();
    let bytes = memory.take();
    let known = dataset(&bytes, Format::Json).unwrap();
    assert_eq!(known.document.rows, 66_000);
    // Without blanks and line ends, with another member, and with the members in another order.
    let value: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    let (provenance, blocks) = (value["provenance"].to_string(), value["blocks"].to_string());
    for text in [
        format!("{{\"provenance\":{provenance},\"blocks\":{blocks}}}"),
        format!("\n {{ \"provenance\" : {provenance} , \"blocks\" : {blocks} , \"note\" : \"mine\" }}"),
        format!("{{\"blocks\":{blocks},\"provenance\":{provenance}}}"),
    ] {
        let other = dataset(text.as_bytes(), Format::Json).unwrap();
        assert!(other.arrays == known.arrays && other.document == known.document);
    }
    // Whatever is cut off is told, up to the last bracket.
    for end in [bytes.len() - 2, bytes.len() - 3, bytes.len() - 40, bytes.len() / 2] {
        let error = dataset(&bytes[..end], Format::Json).unwrap_err().to_string();
        assert!(error.contains("cut off"), "{end}: {error}");
    }
    let first = serde_json::json!([value["blocks"][0]]).to_string();
    let short = format!("{{\"provenance\":{provenance},\"blocks\":{first}}}");
    let error = dataset(short.as_bytes(), Format::Json).unwrap_err().to_string();
    assert!(error.starts_with("it has fewer blocks than its provenance says"), "{error}");
    let again = format!(
        "{{\"provenance\":{provenance},\"blocks\":[{},{}]}}",
        &blocks[1..blocks.len() - 1],
        &first[1..first.len() - 1]
    );
    let error = dataset(again.as_bytes(), Format::Json).unwrap_err().to_string();
    assert!(error.starts_with("it has more than the 66000 rows"), "{error}");
}
