//! Compresses the measured profiles, which are long tables: a sixth of their size in the program.

use std::env;
use std::fs::{self, File};
use std::io::Write;
use std::path::PathBuf;

use flate2::Compression;
use flate2::write::ZlibEncoder;

fn main() -> std::io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=profiles");
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    for entry in fs::read_dir("profiles")? {
        let from = entry?.path();
        if let Some(name) = from.file_name().and_then(|name| name.to_str()).filter(|name| name.ends_with(".toml")) {
            let mut to = ZlibEncoder::new(File::create(out.join(format!("{name}.z")))?, Compression::best());
            to.write_all(&fs::read(&from)?)?;
            to.finish()?;
        }
    }
    Ok(())
}
