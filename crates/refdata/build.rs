//! Finds the schema: a package of this crate has it inside, by the link `refdata.schema.json`; elsewhere it is that of the
//! workspace. A checkout without symbolic links, as Windows has it, needs no link.

use std::env;
use std::path::PathBuf;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let own = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let packaged = own.join("refdata.schema.json");
    let file = if packaged.is_file() { packaged } else { own.join("../../docs/refdata.schema.json") };
    println!("cargo::rustc-env=SHADERCHECK_REFDATA_SCHEMA={}", file.display());
}
