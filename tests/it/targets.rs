//! Every option that names a file to write, with targets of every kind.

use std::fs;
use std::io::Write;
use std::os::unix::fs::{FileTypeExt, MetadataExt, symlink};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::binary::{command, run_in};

const VERT: &str = "#version 330 core\nin vec3 p;\nvoid main() { gl_Position = vec4(p, 1.0); }\n";
const SUITE: &str = "suite = \"cube\"\ntitle = \"cube\"\nshader = \"cube.glsl\"\nstage = \"function\"\nentry = \"cube\"\n\n\
    [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [-2.0, 2.0]\n";

/// Options with `OUT` for the target, and the exit status.
const WRITERS: [(&str, i32); 9] = [
    ("translate a.vert --to wgsl -o OUT", 0),
    ("lint a.vert --format json -o OUT", 0),
    ("lint a.vert --write-baseline OUT", 0),
    ("refdata generate ./cube.suite.toml --samples 9 -o OUT", 0),
    ("refdata generate ./cube.suite.toml --samples 9 --format csv -o OUT", 0),
    ("refdata generate sphere --samples 9 --format glb -o OUT", 0),
    ("refdata verify cube.npz cube.f32 --verdicts OUT", 1),
    ("merge parts --out OUT", 0),
    ("calibrate --lane embedded --builtin add --samples 64 -o OUT", 0),
];

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &[u8]| fs::write(folder.path().join(name), text).unwrap();
    write("a.vert", VERT.as_bytes());
    write("cube.suite.toml", SUITE.as_bytes());
    write("cube.glsl", b"float cube(float x) { return x * x * x; }\n");
    write("cube.f32", &[0; 36]);
    run_in(folder.path(), "refdata generate ./cube.suite.toml --samples 9 -o cube.npz").expect(0);
    run_in(folder.path(), "refdata generate ./cube.suite.toml --samples 9 --shard 0/1 -o parts").expect(0);
    folder
}

fn run(at: &Path, writer: &str, target: &str) -> crate::binary::Ran {
    run_in(at, &writer.replace("OUT", target))
}

/// What a writer puts into a regular file.
fn expected(at: &Path, (writer, code): (&str, i32)) -> Vec<u8> {
    // The formats of reference data go by the ending where there is one.
    let ending = if writer.contains("csv ") {
        "csv"
    } else if writer.contains("glb") {
        "glb"
    } else {
        "npz"
    };
    let name = format!("regular.{ending}");
    run(at, writer, &name).expect(code);
    let bytes = fs::read(at.join(&name)).unwrap();
    fs::remove_file(at.join(&name)).unwrap();
    assert!(!bytes.is_empty(), "{writer}");
    bytes
}

#[test]
fn devices_stay_devices() {
    let folder = folder();
    let at = folder.path();
    // As root with a copy: a fault would replace the machine's own device.
    let made = Command::new("mknod").args(["null", "c", "1", "3"]).current_dir(at).status().is_ok_and(|s| s.success());
    let device = if made && fs::write(at.join("null"), "x").is_ok() { at.join("null") } else { "/dev/null".into() };
    symlink(&device, at.join("link")).unwrap();
    let before = fs::metadata(&device).unwrap();
    let files = || fs::read_dir(at).unwrap().count();
    for (writer, code) in WRITERS {
        let entries = files();
        for target in [device.to_str().unwrap(), "link"] {
            run(at, writer, target).expect(code);
            let after = fs::metadata(&device).unwrap();
            assert!(after.file_type().is_char_device(), "{writer} to {target}");
            assert_eq!((after.ino(), after.mode()), (before.ino(), before.mode()), "{writer} to {target}");
        }
        assert_eq!(files(), entries, "{writer}");
    }
}

#[test]
fn pipes_links_and_files_get_the_same_bytes() {
    let folder = folder();
    let at = folder.path();
    assert!(Command::new("mkfifo").arg("pipe").current_dir(at).status().unwrap().success());
    for (writer, code) in WRITERS {
        let expected = expected(at, (writer, code));
        let reader = std::thread::spawn({
            let pipe = at.join("pipe");
            move || fs::read(pipe).unwrap()
        });
        run(at, writer, "pipe").expect(code);
        // Both name the time of the day or the file.
        let exact = !writer.starts_with("calibrate");
        let read = reader.join().unwrap();
        assert!(!read.is_empty() && (!exact || read == expected), "{writer}");
        assert!(fs::metadata(at.join("pipe")).unwrap().file_type().is_fifo(), "{writer}");
        // A link to a file that is there, in another folder.
        fs::create_dir_all(at.join("sub")).unwrap();
        let name = if writer.contains("csv ") {
            "t.csv"
        } else if writer.contains("glb") {
            "t.glb"
        } else {
            "t.npz"
        };
        fs::write(at.join("sub").join(name), "old").unwrap();
        symlink(Path::new("sub").join(name), at.join(name)).unwrap();
        run(at, writer, name).expect(code);
        assert!(fs::symlink_metadata(at.join(name)).unwrap().is_symlink(), "{writer}");
        let read = fs::read(at.join("sub").join(name)).unwrap();
        assert!(read != b"old" && (!exact || read == expected), "{writer}");
        fs::remove_file(at.join(name)).unwrap();
    }
}

#[test]
fn standard_output_by_its_name_is_written_to() {
    let folder = folder();
    let at = folder.path();
    let writer = "translate a.vert --to wgsl -o";
    let expected = String::from_utf8(expected(at, ("translate a.vert --to wgsl -o OUT", 0))).unwrap();
    for name in ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
        if name.starts_with("/proc") && !Path::new(name).exists() {
            continue;
        }
        // A pipe, and a file that holds something already.
        assert_eq!(run_in(at, &format!("{writer} {name}")).expect(0).out, expected, "{name}");
        let mut log = fs::File::create(at.join("log")).unwrap();
        log.write_all(b"before\n").unwrap();
        let run = command(at, &format!("{writer} {name}")).stdout(log.try_clone().unwrap()).status().unwrap();
        assert!(run.success());
        log.write_all(b"after\n").unwrap();
        assert_eq!(fs::read_to_string(at.join("log")).unwrap(), format!("before\n{expected}after\n"), "{name}");
    }
    let ran = command(at, &format!("{writer} /dev/stderr")).stdout(Stdio::null()).output().unwrap();
    assert_eq!(String::from_utf8(ran.stderr).unwrap(), expected);
}

#[test]
fn what_cannot_be_written_is_reported_with_its_reason() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let at = folder.path();
    fs::create_dir(at.join("folder.npz")).unwrap();
    fs::write(at.join("kept.npz"), "kept").unwrap();
    fs::set_permissions(at.join("kept.npz"), fs::Permissions::from_mode(0o444)).unwrap();
    for (writer, _) in WRITERS.into_iter().filter(|(writer, _)| !writer.contains("--format")) {
        let ran = run(at, writer, "kept.npz").expect(2);
        assert!(ran.err.contains("it is read-only; make it writable first"), "{writer}\n{}", ran.err);
        assert!(ran.err.contains("kept.npz"), "{writer}\n{}", ran.err);
        if !writer.starts_with("refdata generate") && !writer.starts_with("merge") {
            let ran = run(at, writer, "folder.npz").expect(2);
            assert!(ran.err.contains("it is a folder; name a file in it"), "{writer}\n{}", ran.err);
        }
    }
    assert_eq!(fs::read(at.join("kept.npz")).unwrap(), b"kept");
}
