//! Finds the shaders: a package of this crate has them inside, by the link `shaders`; elsewhere they are those of the
//! workspace. A checkout without symbolic links, as Windows has it, needs no link.

use std::env;
use std::path::PathBuf;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let own = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let packaged = own.join("shaders");
    let folder = if packaged.is_dir() { packaged } else { own.join("../../shaders") };
    println!("cargo::rustc-env=SHADERCHECK_SHADERS={}", folder.display());
}
