//! What builds the program for WebAssembly: the toolchain that runs this, with the target of rustup, or Debian's compiler
//! for the web, which builds the standard library from its sources.
//!
//! The target is WASI: the program keeps its command line, files and clock, and the page gives it files in memory.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail, ensure};

use crate::cargo::{cargo, status};

const TARGET: &str = "wasm32-wasip1";
const RUSTFLAGS: &str = "CARGO_TARGET_WASM32_WASIP1_RUSTFLAGS";
/// Small before fast, and panics end the program: this target has no unwinding.
const PROFILE: &str = "web";
/// Vectors, which every browser has; and a stack, since the interpreter goes deeper than the megabyte that a program has by
/// default.
const FLAGS: &str = "-Ctarget-feature=+simd128 -Clink-arg=-zstack-size=8388608";

const MISSING: &str = "there is no compiler for the web. With rustup: `rustup target add wasm32-wasip1`; tree-sitter, which is \
                       written in C, needs clang and wasi-libc beside it. On Debian: `apt-get install rustc-web cargo-web \
                       rust-web-src clang lld wasi-libc`";

/// Builds the program; gives the file.
pub fn build(folder: &Path, build: &Path, messages: &mut dyn Write) -> Result<PathBuf> {
    let mut command = if has_target("rustc".as_ref()) {
        let mut command = cargo(["build"]);
        command.env(RUSTFLAGS, FLAGS);
        command
    } else if debian() {
        writeln!(messages, "xtask: rustup's target is not installed; Debian's compiler for the web builds all of it")?;
        with_debian(&lacking(folder, build)?)
    } else {
        bail!(MISSING);
    };
    command.args(["--profile", PROFILE, "--target", TARGET, "--locked"]);
    command.args(["--package", "shadercheck", "--bin", "shadercheck", "--no-default-features", "--features", "run"]);
    // clang has another name for the target than cargo.
    command.env("CC_wasm32_wasip1", "clang").env("CFLAGS_wasm32_wasip1", "--target=wasm32-wasi");
    let failed = status(command.env("CARGO_TARGET_DIR", build))?;
    ensure!(failed == 0, "the program cannot be built for the web");
    Ok(build.join(TARGET).join(PROFILE).join("shadercheck.wasm"))
}

fn has_target(rustc: &Path) -> bool {
    let output = Command::new(rustc).args(["--print", "target-libdir", "--target", TARGET]).output();
    output.is_ok_and(|output| Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir())
}

fn debian() -> bool {
    ["/usr/bin/rustc", "/usr/bin/cargo", "/usr/bin/clang", "/usr/lib/rustlib/src/rust/library", "/usr/lib/wasm32-wasi"]
        .iter()
        .all(|path| Path::new(path).exists())
}

/// Debian's cargo with its compiler, linked by clang against Debian's C library.
fn with_debian(lacking: &Path) -> Command {
    let mut command = Command::new("/usr/bin/cargo");
    // Building the standard library is not stable; the compiler and the sources are of one version here.
    command.args(["build", "-Zbuild-std=std,panic_abort"]).env("RUSTC_BOOTSTRAP", "1").env("RUSTC", "/usr/bin/rustc");
    // What the cargo that runs this program tells its children is of another version.
    for name in ["CARGO", "RUSTUP_TOOLCHAIN", "RUSTUP_HOME", "RUSTDOC", "LD_LIBRARY_PATH"] {
        command.env_remove(name);
    }
    let flags = [
        "-Ctarget-feature=+simd128",
        "-Clink-self-contained=no",
        "-Clinker=clang",
        "-Clink-arg=--target=wasm32-wasi",
        "-Clink-arg=-fuse-ld=lld",
        "-Clink-arg=-Wl,-zstack-size=8388608",
    ];
    command.env(RUSTFLAGS, format!("{} -Clink-arg={}", flags.join(" "), lacking.display()));
    command
}

/// Compiles what Debian's C library lacks.
fn lacking(folder: &Path, build: &Path) -> Result<PathBuf> {
    let object = build.join("debian.o");
    let mut clang = Command::new("/usr/bin/clang");
    clang.args(["--target=wasm32-wasi", "-O1", "-c"]).arg(folder.join("debian.c")).arg("-o").arg(&object);
    ensure!(status(&mut clang)? == 0, "clang cannot compile for the web");
    Ok(object)
}
