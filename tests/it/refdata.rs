//! `shadercheck refdata` as others use it: files, faults in them, and the readers in `examples`.

mod bare;
mod limits;
mod parts;

use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;
use test_record::not_run;

use crate::binary::{Ran, root, run_in};
use crate::schema::conforms;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn generate(folder: &Path, args: &str) -> Ran {
    run_in(folder, &format!("refdata generate {args}"))
}

#[test]
fn a_file_verifies_itself_in_every_format() {
    let folder = folder();
    let at = folder.path();
    for (format, ending) in [("npz", "npz"), ("parquet", "parquet"), ("csv", "csv"), ("json", "json")] {
        generate(at, &format!("sphere --samples 300 --profile binary32 --format {format} -o s.{ending}")).expect(0);
        for (_, other) in [("npz", "npz"), ("csv", "csv")].iter().filter(|(_, o)| at.join(format!("s.{o}")).exists()) {
            let ran = run_in(at, &format!("refdata verify s.{ending} s.{other}")).expect(0);
            assert!(ran.out.contains("pass: 1200 elements judged, 1200 agreed"), "{}", ran.out);
        }
    }
    assert_eq!(names(at), ["s.csv", "s.json", "s.npz", "s.parquet"], "nothing else is left");
}

#[test]
fn one_flipped_bit_in_a_million_numbers_is_found() {
    let folder = folder();
    let at = folder.path();
    generate(at, "bone_weight --samples 1000000 --profile binary32 -o ref.npz").expect(0);
    // Raw numbers: the nearest of each sample, which are an array of the archive without compression.
    let bytes = fs::read(at.join("ref.npz")).unwrap();
    let name = b"nearest.return.npy";
    let header = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len();
    let length = u16::from_le_bytes([bytes[header + 8], bytes[header + 9]]) as usize;
    let start = header + 10 + length;
    let mut raw = bytes[start..start + 4_000_000].to_vec();
    fs::write(at.join("mine.raw"), &raw).unwrap();
    run_in(at, "refdata verify ref.npz mine.raw").expect(0);
    raw[4 * 777_777 + 2] ^= 0x40;
    fs::write(at.join("mine.raw"), &raw).unwrap();
    let ran = run_in(at, "refdata verify ref.npz mine.raw --format json").expect(1);
    let json = ran.json();
    assert_eq!(json["findings"][0], "1 element farther off than allowed");
    assert_eq!((&json["worst"][0]["sample"], &json["worst"][0]["component"]), (&777_777.into(), &"return".into()));
    // The last bit is within the bound of most, and not the nearest number.
    raw[4 * 777_777 + 2] ^= 0x40;
    raw[4 * 123_456] ^= 1;
    fs::write(at.join("mine.raw"), &raw).unwrap();
    run_in(at, "refdata verify ref.npz mine.raw --exact").expect(1);
}

#[test]
fn parts_are_the_run() {
    let folder = folder();
    let at = folder.path();
    generate(at, "morph --samples 200000 --profile none --format parquet -o whole.parquet").expect(0);
    for part in 0..3 {
        generate(at, &format!("morph --samples 200000 --profile none --format parquet -o parts --shard {part}/3"))
            .expect(0);
    }
    assert_eq!(names(&at.join("parts/morph")).len(), 3);
    run_in(at, "refdata verify parts/morph whole.parquet --exact").expect(0);
    fs::remove_file(at.join("parts/morph/shard-00001-of-00003.parquet")).unwrap();
    let ran = run_in(at, "refdata verify parts/morph whole.parquet --exact").expect(2);
    assert!(ran.err.contains("are missing"), "{}", ran.err);
    let ran = generate(at, "morph -o parts --shard 3/3").expect(2);
    assert!(ran.err.contains("there is no shard 3 of 3"), "{}", ran.err);
}

#[test]
fn bad_arguments_are_reported() {
    let folder = folder();
    let at = folder.path();
    let reported = |args: &str| generate(at, args).expect(2).err;
    assert!(reported("sphere --samples 0 -o a.npz").contains("0 is not in 1.."));
    assert!(reported("sphre -o a.npz").contains("did you mean `sphere`?"));
    assert!(reported("sphere --profile vulkan-1.5 -o a.npz").contains("did you mean `vulkan-1.4`?"));
    assert!(reported("sphere -o a.csv").contains("does not end in `.npz`"));
    assert!(reported("sphere cylinder -o a.npz").contains("2 data sets do not go into the one file"));
    assert!(reported("bone_weight --format glb -o a.glb").contains("`bone_weight` is no geometry"));
    assert_eq!(names(at), Vec::<String>::new(), "nothing is written");
}

#[test]
fn where_nothing_can_be_written_nothing_is_left() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("file"), "").unwrap();
    let ran = generate(at, "sphere --samples 10 -o file/a.npz").expect(2);
    assert!(ran.err.contains("cannot write `file/a.npz`"), "{}", ran.err);
    let ran = generate(at, "sphere --samples 10 -o /proc/a.npz").expect(2);
    assert!(ran.err.contains("cannot write `/proc/a.npz`"), "{}", ran.err);
    assert_eq!(names(at), ["file"]);
}

#[test]
fn damaged_references_are_reported() {
    let folder = folder();
    let at = folder.path();
    generate(at, "sphere --samples 100 --profile binary32 -o s.npz").expect(0);
    let bytes = fs::read(at.join("s.npz")).unwrap();
    let verify = || run_in(at, "refdata verify d.npz s.npz").expect(2).err;
    fs::write(at.join("d.npz"), &bytes[..bytes.len() / 2]).unwrap();
    assert!(verify().contains("it is no archive of arrays, cut off or damaged"));
    let mut changed = bytes.clone();
    changed[bytes.len() / 3] ^= 4;
    fs::write(at.join("d.npz"), &changed).unwrap();
    let reported = verify();
    assert!(reported.contains("d.npz`"), "{reported}");
    let csv = "index,gl_Position.x\n0,1.0\n";
    fs::write(at.join("d.csv"), csv).unwrap();
    let reported = run_in(at, "refdata verify d.csv s.npz").expect(2).err;
    assert!(reported.contains("it does not begin with `# ` and the provenance"), "{reported}");
    let reported = run_in(at, "refdata verify s.npz gone.npz").expect(2).err;
    assert!(reported.contains("cannot read `gone.npz`"), "{reported}");
    let reported = run_in(at, "refdata verify s.npz d.txt").expect(2).err;
    assert!(reported.contains("names no format"), "{reported}");
}

#[test]
fn a_suite_without_a_formula_expects_what_its_shader_means() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("tone.glsl"), "float tone(float x) { return x / (1.0 + x); }\n").unwrap();
    let suite = "suite = \"tone\"\nshader = \"tone.glsl\"\nstage = \"function\"\nentry = \"tone\"\n\
                 laws = []\n\n[[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [0.0, 4.0]\n";
    let suite = suite
        .replace("laws = []\n", "relations = [{ kind = \"monotone\", inputs = [\"x\"], direction = \"rising\" }]\n");
    fs::write(at.join("tone.suite.toml"), suite).unwrap();
    generate(at, "tone.suite.toml --samples 64 --profile binary32 --format json -o tone.json").expect(0);
    let text = fs::read_to_string(at.join("tone.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["provenance"]["expected"]["by"], "meaning");
    let arrays = &json["blocks"][0]["arrays"];
    fn strip(bits: &serde_json::Value) -> &str {
        let bits = bits.as_str().unwrap();
        bits.strip_prefix("0x").unwrap_or(bits)
    }
    for row in 0..64 {
        // The decimals are for people: not every reader of JSON takes them to the last bit.
        let bits = |name: &str| u64::from_str_radix(strip(&arrays[name]["bits"][row]), 16).unwrap();
        let x = f64::from(f32::from_bits(u32::try_from(bits("input.x")).unwrap()));
        assert_eq!(f64::from_bits(bits("expected.return")), x / (1.0 + x));
    }
    run_in(at, "refdata verify tone.json tone.json").expect(0);
}

/// The schema's promises, as far as they can be seen without a validator: every member that it requires.
#[test]
fn the_schema_is_that_of_the_files() {
    let folder = folder();
    let at = folder.path();
    generate(at, "joints --samples 20 --format json -o j.json").expect(0);
    let schema = run_in(at, "refdata schema").expect(0).json();
    let file: serde_json::Value = serde_json::from_str(&fs::read_to_string(at.join("j.json")).unwrap()).unwrap();
    let faults = |file: &serde_json::Value| {
        let mut faults = Vec::new();
        conforms(&schema, &schema, file, "", &mut faults);
        faults
    };
    assert_eq!(faults(&file), Vec::<String>::new());
    let mut wrong = file.clone();
    wrong["provenance"]["per_case"] = 0.into();
    wrong["provenance"]["arrays"][0]["role"] = "imput".into();
    wrong["blocks"][0]["arrays"]["flags"]["bits"][0] = "12".into();
    wrong["provenance"].as_object_mut().unwrap().remove("seed");
    assert_eq!(faults(&wrong).len(), 4, "{:?}", faults(&wrong));
}

#[test]
fn the_examples_in_cpp_read_what_is_written() {
    let Some(compiler) = ["c++", "g++", "clang++"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success()))
    else {
        return not_run("there is no C++ compiler (c++, g++, clang++): examples/*.cpp");
    };
    let folder = folder();
    let at = folder.path();
    let build = |source: &str, program: &str| {
        let output = Command::new(compiler)
            .args(["-std=c++17", "-Wall", "-Wextra", "-Werror", "-I", ".", "-o", program])
            .arg(root().join("examples").join(source))
            .current_dir(at)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    let run = |program: &str, args: &[&str]| -> Ran {
        Command::new(at.join(program)).args(args).current_dir(at).output().unwrap().into()
    };
    generate(at, "skinning --samples 200 --profile binary32 --format csv -o s.csv").expect(0);
    build("read_refdata.cpp", "read");
    let ran = run("read", &["s.csv"]).expect(0);
    assert!(ran.out.starts_with("200 samples, 800 elements, "), "{}", ran.out);
    let cut = fs::read_to_string(at.join("s.csv")).unwrap();
    fs::write(at.join("cut.csv"), &cut[..cut.len() - 100]).unwrap();
    run("read", &["cut.csv"]).expect(1);

    generate(at, "bone_weight --samples 500 --format c -o bone_weight.h").expect(0);
    build("use_header.cpp", "use");
    let ran = run("use", &[]).expect(0);
    assert_eq!(ran.out, "500 of 500 samples judged, 0 beyond their bounds\n");
    // A header with uniforms, which a compiler takes as C and as C++.
    generate(at, "skinning hair --samples 40 --format c -o headers").expect(0);
    for (name, language) in [("skinning", "c"), ("skinning", "c++"), ("hair", "c")] {
        let text = format!(
            "#include \"headers/{name}.h\"\nint main(void) {{ return refdata_{name}_cases[1].{}[0][0] != refdata_{name}_cases[1].{}[0][0]; }}\n",
            if name == "hair" { "mc" } else { "modelViewMatrix" },
            if name == "hair" { "mc" } else { "modelViewMatrix" }
        );
        fs::write(at.join("t.c"), text).unwrap();
        let output = Command::new(compiler).args(["-x", language, "t.c", "-o", "t"]).current_dir(at).output().unwrap();
        assert!(output.status.success(), "{name} as {language}: {}", String::from_utf8_lossy(&output.stderr));
        run("t", &[]).expect(0);
    }
}

#[test]
fn the_example_in_python_reads_what_is_written() {
    let python = std::env::var("SHADERCHECK_PYTHON").unwrap_or_else(|_| "python3".into());
    let has = |module: &str| {
        Command::new(&python).args(["-c", &format!("import {module}")]).output().is_ok_and(|o| o.status.success())
    };
    if !has("numpy") {
        return not_run(
            "python3 has no numpy (SHADERCHECK_PYTHON names an interpreter that has): examples/read_refdata.py",
        );
    }
    let folder = folder();
    let at = folder.path();
    let read = |file: &str| -> Ran {
        Command::new(&python)
            .arg(root().join("examples/read_refdata.py"))
            .arg(file)
            .current_dir(at)
            .output()
            .unwrap()
            .into()
    };
    generate(at, "sphere --samples 500 --profile vulkan-1.4 -o s.npz").expect(0);
    let ran = read("s.npz").expect(0);
    assert!(ran.out.contains("elements within their bounds"), "{}", ran.out);
    generate(at, "hair --samples 500 -o h.npz").expect(0);
    read("h.npz").expect(0);
    if !has("pyarrow") {
        return not_run("python3 has no pyarrow: examples/read_refdata.py with Parquet");
    }
    generate(at, "skinning --samples 500 --format parquet -o s.parquet").expect(0);
    read("s.parquet").expect(0);
}
