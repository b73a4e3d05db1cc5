//! Parts of a data set, what becomes of one that is stopped, and files that cannot be written or are not ours.

use std::fs;
use std::process::Command;

use super::{folder, generate, names};
use crate::binary::{Ran, run_in};

/// A process that is killed when this goes out of scope.
struct Running(std::process::Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_killed_part_goes_on_from_its_last_block() {
    let folder = folder();
    let at = folder.path();
    let args = "refdata generate morph --samples 400000 --profile none";
    let share = format!("{args} --shard 0/1 -o parts");
    let work = at.join("parts/morph/.shard-00000-of-00001.work");
    let blocks = || -> Vec<String> {
        let all = if work.exists() { names(&work) } else { Vec::new() };
        all.into_iter().filter(|name| name.starts_with("block-") && !name.ends_with(".new")).collect()
    };
    let quiet = std::process::Stdio::null;
    let child = crate::binary::command(at, &share).stdout(quiet()).stderr(quiet()).spawn().unwrap();
    let mut running = Running(child);
    let begin = std::time::Instant::now();
    while blocks().len() < 2 {
        assert!(running.0.try_wait().unwrap().is_none(), "it ended before it was killed");
        assert!(begin.elapsed().as_secs() < 300, "no block");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    drop(running);
    let done = blocks();
    assert!(!at.join("parts/morph/shard-00000-of-00001.npz").exists(), "it came to its end");
    // Nothing of it is taken for a part.
    let ran = run_in(at, "merge parts").expect(2);
    assert!(ran.err.contains("no parts of reference data"), "{}", ran.err);
    // One of the blocks did not reach the disk, and is made again.
    let bytes = fs::read(work.join(&done[0])).unwrap();
    fs::write(work.join(&done[0]), &bytes[..bytes.len() / 2]).unwrap();
    let time = |name: &str| fs::metadata(work.join(name)).unwrap().modified().unwrap();
    let before = time(&done[1]);
    // A writer that cannot go on leaves the blocks: what was done is not made again.
    let limited = Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 40000; exec \"$0\" $1", env!("CARGO_BIN_EXE_shadercheck"), &share])
        .current_dir(at)
        .output()
        .unwrap();
    let limited = Ran::from(limited).expect(2);
    assert!(limited.err.contains("cannot write `parts/morph/shard-00000-of-00001.npz`"), "{}", limited.err);
    assert_eq!(time(&done[1]), before, "a block that was there is made again");
    let again = run_in(at, &share).expect(0);
    assert!(again.err.contains("goes on: ") && again.err.contains("of its 7 blocks are there"), "{}", again.err);
    assert_eq!(names(&at.join("parts/morph")), ["shard-00000-of-00001.npz"]);
    run_in(at, &format!("{args} -o whole.npz")).expect(0);
    let whole = fs::read(at.join("whole.npz")).unwrap();
    assert!(fs::read(at.join("parts/morph/shard-00000-of-00001.npz")).unwrap() == whole);
    // A third time there is nothing to do, and another run does not write over it.
    assert!(run_in(at, &share).expect(0).out.contains("(was done before)"));
    let ran = run_in(at, &format!("{share} --seed 9")).expect(2);
    assert!(ran.err.contains("is of another run") && ran.err.contains("the seed is `24301` in one"), "{}", ran.err);
    // What is damaged is told and made again.
    fs::write(at.join("parts/morph/shard-00000-of-00001.npz"), &whole[..whole.len() / 3]).unwrap();
    let ran = run_in(at, &share).expect(0);
    assert!(ran.err.contains("is not used, and made again"), "{}", ran.err);
    assert!(fs::read(at.join("parts/morph/shard-00000-of-00001.npz")).unwrap() == whole);
}

#[test]
fn merged_parts_are_the_file_of_the_run_in_every_format() {
    let folder = folder();
    let at = folder.path();
    let args = "bone_weight --samples 150000 --profile binary32";
    let file = |name: &str| fs::read(at.join(name)).unwrap();
    for format in ["npz", "parquet", "csv"] {
        generate(at, &format!("{args} --format {format} -o whole.{format}")).expect(0);
    }
    for count in [1, 2, 3, 5] {
        for part in (0..count).rev() {
            generate(at, &format!("{args} -o of{count} --shard {part}/{count}")).expect(0);
        }
        for format in ["npz", "parquet", "csv"] {
            run_in(at, &format!("merge of{count} --out joined.{format}")).expect(0);
            assert!(file(&format!("joined.{format}")) == file(&format!("whole.{format}")), "{format} of {count} parts");
        }
    }
    // Parts in another format, and small ones in the rest of them.
    let args = "bone_weight --samples 90000 --profile none";
    generate(at, &format!("{args} --format csv -o c --shard 0/2")).expect(0);
    generate(at, &format!("{args} --format parquet -o c --shard 1/2")).expect(0);
    generate(at, &format!("{args} -o w.npz")).expect(0);
    let listed = run_in(at, "merge c --format json").expect(0).json();
    let digest = generate(at, &format!("{args} --format parquet -o w.parquet")).expect(0).out;
    assert!(digest.contains(listed["datasets"][0]["sha256"].as_str().unwrap()));
    assert_eq!(listed["datasets"][0]["parts"].as_array().unwrap().len(), 2);
    run_in(at, "merge c --out j.npz").expect(0);
    assert!(file("j.npz") == file("w.npz"));
    for (format, ending) in [("json", "json"), ("c", "h")] {
        let args = "sphere hair --samples 50";
        generate(at, &format!("{args} --format {format} -o {format}-whole")).expect(0);
        generate(at, &format!("{args} -o {format}-parts --shard 0/2")).expect(0);
        generate(at, &format!("{args} -o {format}-parts --shard 1/2")).expect(0);
        let ran = run_in(at, &format!("merge {format}-parts --out two.{ending}")).expect(2);
        assert!(ran.err.contains("2 suites do not go into the one file"), "{}", ran.err);
        run_in(at, &format!("merge {format}-parts/sphere --out s.{ending}")).expect(0);
        assert!(file(&format!("s.{ending}")) == file(&format!("{format}-whole/sphere.{ending}")), "{format}");
    }
    run_in(at, "merge c-parts --out both").expect(0);
    assert_eq!(names(&at.join("both")), ["hair.npz", "sphere.npz"]);
    let reported = |args: &str| generate(at, args).expect(2).err;
    assert!(reported("sphere --format c --shard 0/2 -o x").contains("merge DIR --out FILE.h"));
}

#[test]
fn parts_that_are_missing_doubled_or_of_another_run_are_reported() {
    let folder = folder();
    let at = folder.path();
    let args = "bone_weight --samples 200000 --profile none -o p";
    let make = |more: &str, part: u64| generate(at, &format!("{args} --shard {part}/3 {more}")).expect(0);
    (0..3).for_each(|part| drop(make("", part)));
    let part = |number: u64| at.join(format!("p/bone_weight/shard-0000{number}-of-00003.npz"));
    let reported = |expected: &str| {
        let ran = run_in(at, "merge p --out j.npz").expect(2);
        assert!(ran.err.contains(expected), "`{expected}` is not in\n{}", ran.err);
        assert!(!at.join("j.npz").exists() && ran.out.is_empty(), "{}", ran.out);
    };
    let second = fs::read(part(1)).unwrap();
    fs::remove_file(part(1)).unwrap();
    reported("`bone_weight`, without shard 1/3: samples 65536 to 131071 are missing");
    fs::write(part(1), &second).unwrap();
    fs::write(at.join("p/bone_weight/shard-copy.npz"), &second).unwrap();
    reported(
        "sample 65536 is there twice: in `p/bone_weight/shard-00001-of-00003.npz` and in `p/bone_weight/shard-copy.npz`",
    );
    fs::remove_file(at.join("p/bone_weight/shard-copy.npz")).unwrap();
    fs::write(part(1), &second[..second.len() / 2]).unwrap();
    reported("cut off or damaged");
    let mut changed = second.clone();
    changed[second.len() / 2] ^= 8;
    fs::write(part(1), &changed).unwrap();
    reported("SHA-256 is ");
    for (more, expected) in [
        ("--seed 9", "the seed is `24301` in one and `9` in the other"),
        ("--samples 200001", ""),
        ("--profile binary32", "the profile is `none` in one and `binary32"),
    ] {
        fs::remove_file(part(1)).unwrap();
        let args = args.replace("--samples 200000", "").replace("--profile none", "");
        let more = format!(
            "{more} {} {}",
            if more.contains("samples") { "" } else { "--samples 200000" },
            if more.contains("profile") { "" } else { "--profile none" }
        );
        generate(at, &format!("{args} {more} --shard 1/3")).expect(0);
        reported(if expected.is_empty() { "--samples is `200000` in one and `200001` in the other" } else { expected });
    }
    // Of another version of the tool, as its provenance tells.
    fs::remove_file(part(1)).unwrap();
    generate(at, "bone_weight --samples 200000 --profile none --format csv -o q --shard 1/3").expect(0);
    let csv = fs::read_to_string(at.join("q/bone_weight/shard-00001-of-00003.csv")).unwrap();
    let version = format!("\"version\":\"{}\"", env!("CARGO_PKG_VERSION"));
    let older = csv.replacen(&version, "\"version\":\"0.0.1\"", 1);
    assert!(older != csv);
    fs::write(at.join("p/bone_weight/shard-00001-of-00003.csv"), older).unwrap();
    reported("the version of the tool is `");
    let newer = csv.replacen("\"schema_version\":\"1.", "\"schema_version\":\"2.", 1);
    fs::write(at.join("p/bone_weight/shard-00001-of-00003.csv"), newer).unwrap();
    reported("its schema has version 2.1, and this program reads 1.1");
    // Results of other commands in the same folder.
    run_in(at, "check bone_weight --lane embedded --stage compute --samples 8 --shard 0/1 --shard-dir p").expect(0);
    fs::remove_file(at.join("p/bone_weight/shard-00001-of-00003.csv")).unwrap();
    reported("merge them one after the other");
}

/// A disk that is full while a file is written: the system refuses to make it larger.
#[test]
fn a_file_that_cannot_grow_is_an_error_and_nothing_is_left() {
    let folder = folder();
    let at = folder.path();
    let limited = |args: &str| -> Ran {
        let words: Vec<&str> = args.split_whitespace().collect();
        let output = Command::new("sh")
            .args(["-c", "trap '' XFSZ; ulimit -f 100; exec \"$@\"", "sh", env!("CARGO_BIN_EXE_shadercheck")])
            .args(words)
            .current_dir(at)
            .output()
            .unwrap();
        output.into()
    };
    for format in ["npz", "parquet", "csv", "json", "c", "glb"] {
        let (ending, suite) = if format == "c" { ("h", "sphere") } else { (format, "sphere") };
        let ran = limited(&format!("refdata generate {suite} --samples 20000 --format {format} -o big.{ending}"));
        let ran = ran.expect(2);
        assert!(ran.err.contains(&format!("cannot write `big.{ending}`")), "{format}: {}", ran.err);
        assert_eq!(names(at), Vec::<String>::new(), "{format}");
    }
    generate(at, "sphere --samples 20000 --profile binary32 -o s.npz").expect(0);
    let ran = limited("refdata verify s.npz s.npz --verdicts v.csv").expect(2);
    assert!(ran.err.contains("cannot write `v.csv`"), "{}", ran.err);
    assert_eq!(names(at), ["s.npz"]);
    // Nobody reads a report that did not reach its file.
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut command = crate::binary::command(at, "refdata verify s.npz s.npz");
    let status = command.stdout(full).stderr(std::process::Stdio::null()).status().unwrap();
    assert_eq!(status.code(), Some(2));
}

/// Files of NumPy as others write them: bytes in the other order, other types, rows of one number.
#[test]
fn arrays_in_other_types_and_orders_are_read() {
    let folder = folder();
    let at = folder.path();
    generate(at, "bone_weight --samples 300 --profile binary32 --format csv -o ref.csv").expect(0);
    let text = fs::read_to_string(at.join("ref.csv")).unwrap();
    let header = text.lines().nth(1).unwrap();
    let column = header.split(',').position(|name| name == "nearest.return").unwrap();
    let values: Vec<f32> =
        text.lines().skip(2).map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect();
    let npy = |descr: &str, shape: &str, data: Vec<u8>| {
        let mut head = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
        let pad = 63 - (10 + head.len()) % 64;
        head.push_str(&" ".repeat(pad));
        head.push('\n');
        let mut out = b"\x93NUMPY\x01\x00".to_vec();
        out.extend(u16::try_from(head.len()).unwrap().to_le_bytes());
        out.extend(head.bytes());
        out.extend(data);
        fs::write(at.join("mine.npy"), out).unwrap();
    };
    let verify = |status: i32| run_in(at, "refdata verify ref.csv mine.npy").expect(status);
    let bytes = |each: fn(f32) -> Vec<u8>| values.iter().flat_map(|&x| each(x)).collect::<Vec<u8>>();
    npy("<f4", "(300,)", bytes(|x| x.to_le_bytes().to_vec()));
    verify(0);
    // NumPy says so when the most significant byte comes first, and it is read as it is.
    npy(">f4", "(300, 1)", bytes(|x| x.to_be_bytes().to_vec()));
    verify(0);
    npy(">f8", "(300,)", bytes(|x| f64::from(x).to_be_bytes().to_vec()));
    verify(0);
    // Who says otherwise is told.
    npy("<f4", "(300,)", bytes(|x| x.to_be_bytes().to_vec()));
    assert!(verify(1).out.contains("the bytes of the numbers are in the other order"));
    npy("<f4", "(150, 2)", bytes(|x| x.to_le_bytes().to_vec()));
    assert!(verify(2).err.contains("has 2 numbers for each sample, and the reference has 1"));
    npy("<f4", "(299,)", bytes(|x| x.to_le_bytes().to_vec())[4..].to_vec());
    let ran = verify(1);
    assert!(ran.out.contains("1 sample missing, the first is 299"), "{}", ran.out);
    npy("<f4", "(400,)", bytes(|x| x.to_le_bytes().to_vec()));
    assert!(verify(2).err.contains("it has 1200 bytes, and its head says 1600: it is cut off or damaged"));
    npy("<f2", "(600,)", bytes(|x| x.to_le_bytes().to_vec()));
    assert!(verify(2).err.contains("numbers of type `<f2` are not read"));
    let mut with_nan = values.clone();
    with_nan[17] = f32::NAN;
    npy("<f4", "(300,)", with_nan.iter().flat_map(|x| x.to_le_bytes()).collect());
    let ran = verify(1);
    assert!(ran.out.contains("1 element NaN or infinite") && ran.out.contains("sample 17"), "{}", ran.out);
}
